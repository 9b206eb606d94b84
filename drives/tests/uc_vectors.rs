//! The vectors of the control board's fact sheet, and what hostile bytes may do to the decoders.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline_drives::uc::command::{Command, DriveLevel, Request, SteeringLevel, integer};
use haltline_drives::uc::daq::{self, DaqError, Encoding, Group, Type, crc16};
use haltline_drives::uc::error;
use haltline_drives::uc::line::{Deframer, Kind, LineError, LineReader, Message};
use haltline_drives::uc::reply::{self, Mode};
use proptest::prelude::*;

fn messages(bytes: &[u8]) -> Vec<Result<Message, LineError>> {
    let mut deframer = Deframer::default();
    bytes
        .iter()
        .filter_map(|byte| deframer.push(*byte))
        .collect()
}

fn text(line: &[u8]) -> String {
    String::from_utf8(line.to_vec()).unwrap()
}

#[test]
fn commands_are_the_lines_of_the_sheet() {
    let forward = |level| Command::Drive(DriveLevel::forward(level).unwrap());
    let cases = [
        (forward(300), "!DRV F 300  300\n"),
        (forward(-500), "!DRV F -500  -500\n"),
        (
            Command::Drive(DriveLevel::reverse(120).unwrap()),
            "!DRV B 120  120\n",
        ),
        (
            Command::Steer(SteeringLevel::new(-200).unwrap()),
            "!STEER -200  -200\n",
        ),
        (Command::SetDeadMan(200), "!DRV ~DMS=200\n"),
        (Command::GetDeadMan, "?DRV ~DMS\n"),
        (Command::GetSession, "?SID\n"),
        (Command::SetSession(4_000_000_000), "!SID 4000000000\n"),
        (Command::StreamStart, "!DAQ START\n"),
        (Command::StreamStop, "!DAQ STOP\n"),
    ];
    for (command, line) in cases {
        assert_eq!(text(command.encode().as_slice()), line);
    }
    // As the sheet prints them, with one space: the same to a board.
    for (line, number, at) in [("!DRV F 300 300", 300, 2), ("!STEER -200 -200", -200, 1)] {
        let request = Request::parse(line.as_bytes()).unwrap();
        assert_eq!(request.checked_number(at), Ok(number));
    }
}

/// No flipped bit and no lost byte makes another number: two that differ are refused.
#[test]
fn a_spoiled_set_point_never_carries_another_number() {
    let accepted = |line: &[u8]| -> Option<i32> {
        let request = Request::parse(line.strip_suffix(b"\n")?).ok()?;
        let sets = request.is(0, "DRV") || request.is(0, "STEER");
        let at = if request.is(0, "DRV") { 2 } else { 1 };
        request.word(at + 1).filter(|_| sets)?;
        request.checked_number(at).ok()
    };
    // Numbers without their check: a word went missing.
    let alone = |line: &[u8], words: usize| -> Option<String> {
        let text = String::from_utf8_lossy(line).into_owned();
        let found: Vec<&str> = text.split_ascii_whitespace().collect();
        (found.len() < words).then(|| found[found.len() - 1].to_owned())
    };
    for level in [-500, -1, 0, 1, 11, 300, 1000] {
        let level_f = DriveLevel::forward(level).unwrap();
        let steer = Command::Steer(SteeringLevel::new(level).unwrap());
        for (command, words) in [(Command::Drive(level_f), 4), (steer, 3)] {
            let good = command.encode().as_slice().to_vec();
            for at in 0..good.len() - 1 {
                let mut lost = good.clone();
                lost.remove(at);
                let flipped = (0..8).map(|bit| {
                    let mut line = good.clone();
                    line[at] ^= 1 << bit;
                    line
                });
                for line in flipped
                    .chain([lost])
                    .filter(|line| !line.contains(&10) || line.ends_with(b"\n"))
                {
                    assert!(accepted(&line).is_none_or(|number| number == i32::from(level)));
                    // And no word goes missing that would leave a number without its check.
                    let name = line.starts_with(b"!DRV F ") || line.starts_with(b"!STEER ");
                    let alone = alone(&line, words).filter(|_| name);
                    assert!(alone.is_none_or(|number| number == level.to_string()));
                }
            }
        }
    }
}

#[test]
fn no_level_outside_the_board_s_ranges_can_be_made() {
    for level in i16::MIN..=i16::MAX {
        assert_eq!(
            DriveLevel::forward(level).is_some(),
            (-500..=1000).contains(&level)
        );
        assert_eq!(
            DriveLevel::reverse(level).is_some(),
            (0..=500).contains(&level)
        );
        assert_eq!(
            SteeringLevel::new(level).is_some(),
            (-1000..=1000).contains(&level)
        );
    }
    // A negative forward value is a brake and no thrust backwards.
    let brake = DriveLevel::forward(-300).unwrap();
    assert_eq!((brake.thrust(), brake.brake()), (0, 300));
    let back = DriveLevel::reverse(300).unwrap();
    assert_eq!((back.thrust(), back.brake()), (-300, 0));
}

#[test]
fn messages_come_with_and_without_stx_and_newlines() {
    let bytes = b"\x02:F 300\x03\n:OFF\x03\x02'ERR(513)\x03\r\n\x02#1:806 | 4561 | 4075\x03:ok\x03";
    let found: Vec<_> = messages(bytes).into_iter().map(Result::unwrap).collect();
    let shape: Vec<_> = found.iter().map(|m| (m.kind, m.text())).collect();
    assert_eq!(
        shape,
        [
            (Kind::Answer, "F 300"),
            (Kind::Answer, "OFF"),
            (Kind::Display, "ERR(513)"),
            (Kind::Data, "1:806 | 4561 | 4075"),
            (Kind::Answer, "ok"),
        ]
    );
}

#[test]
fn bad_messages_are_named() {
    assert_eq!(messages(b"F 300\x03"), [Err(LineError::UnknownKind(b'F'))]);
    assert_eq!(
        messages(b"\x02:F 3\x02:ok\x03")[0],
        Err(LineError::CutShort)
    );
    assert_eq!(messages(b":F \xff\x03"), [Err(LineError::NotText)]);
    let mut long = vec![b':'; 600];
    long.push(3);
    long.extend(b":ok\x03");
    let found = messages(&long);
    assert_eq!(found[0], Err(LineError::TooLong));
    assert_eq!(found[1].unwrap().text(), "ok");
}

#[test]
fn answers_of_the_sheet_are_read() {
    let state = |text| reply::drive_state(text).unwrap();
    assert_eq!(state("F 300").drive, Some((Mode::Forward, 300)));
    assert_eq!(state("B 12").drive, Some((Mode::Reverse, 12)));
    assert_eq!(state("D -186").drive, Some((Mode::Direct, -186)));
    assert_eq!(state("OFF").drive, Some((Mode::Off, 0)));
    assert_eq!(state("OFF ~DMS=1000").dead_man_ms, Some(1000));
    assert_eq!(state("~DMS=200").dead_man_ms, Some(200));
    assert_eq!(state("~DMS=200").drive, None);
    for bad in [
        "", "ok", "F", "F x", "F +3", "F 3.5", "F 1 B 2", "~DMS=", "~DMS=-1", "G 3",
    ] {
        assert_eq!(reply::drive_state(bad), None, "{bad}");
    }
    assert_eq!(reply::error_code("ERR(266)"), Some(266));
    assert_eq!(reply::error_code("ERR(269):numbers differ"), Some(269));
    assert_eq!(reply::error_code("ERR"), Some(1));
    assert_eq!(reply::error_code("F 300"), None);
    assert_eq!(reply::number("-200"), Some(-200));
    assert_eq!(reply::session("0"), Some(0));
    assert_eq!(reply::session("-1"), None);
}

#[test]
fn the_board_s_view_of_a_line() {
    let request = Request::parse(b"!drv F  300 ~dms=200 300").unwrap();
    assert!(request.set && request.is(0, "DRV") && request.is(1, "f"));
    assert_eq!(request.option("DMS"), Some(Some("200")));
    assert_eq!(request.checked_number(2), Ok(300));
    let code = |line: &[u8]| Request::parse(line).unwrap().checked_number(2);
    assert_eq!(code(b"!DRV F 300 301"), Err(error::CORRUPTED));
    assert_eq!(code(b"!DRV F +300"), Err(error::PARSE));
    assert_eq!(code(b"!DRV F 3.0"), Err(error::PARSE));
    assert_eq!(code(b"!DRV F"), Err(error::WRONG_USAGE));
    assert_eq!(Request::parse(b"DRV F"), Err(error::WRONG_START));
    assert_eq!(integer("-12"), Some(-12));
    let mut reader = LineReader::default();
    let line: Vec<_> = b"?SID\n".iter().filter_map(|b| reader.push(*b)).collect();
    assert_eq!(line[0].unwrap().as_slice(), b"?SID");
}

const US: [Type; 3] = [Type::U16, Type::U16, Type::U16];

fn group(encoding: Encoding, crc: bool) -> Group<'static> {
    Group {
        types: &US,
        encoding,
        crc,
    }
}

#[test]
fn the_documented_data_messages_are_read_in_all_encodings() {
    assert_eq!(crc16(&[0x26, 0x03, 0xD1, 0x11, 0xEB, 0x0F]), 0xCF68);
    assert_eq!(crc16(b"123456789"), 0x29B1);
    let wanted = [Some(806), Some(4561), Some(4075)];
    let cases = [
        ("1:806 | 4561 | 4075", 1, group(Encoding::Ascii, false)),
        ("2:2603D111EB0F", 2, group(Encoding::Hex, false)),
        ("3:2603D111EB0F68CF", 3, group(Encoding::Hex, true)),
        ("4:JgPREesP", 4, group(Encoding::Base64, false)),
        ("5:JgPREesPaM8", 5, group(Encoding::Base64, true)),
    ];
    for (message, number, group) in cases {
        let (n, payload) = daq::split(message).unwrap();
        assert_eq!(n, number);
        let values = group.decode(payload).unwrap();
        assert_eq!(values[..3], wanted, "{message}");
        assert_eq!(
            group.encode(&values).unwrap().as_slice(),
            payload.as_bytes()
        );
    }
}

#[test]
fn error_values_are_no_values() {
    let ascii = group(Encoding::Ascii, false);
    for text in [
        "[---] | 1 | 2",
        "[mfault] | 1 | 2",
        "65535 | 1 | 2",
        "65531 | 1 | 2",
    ] {
        assert_eq!(
            ascii.decode(text).unwrap()[..3],
            [None, Some(1), Some(2)],
            "{text}"
        );
    }
    assert_eq!(ascii.decode("65530 | 1 | 2").unwrap()[0], Some(65530));
    let hex = group(Encoding::Hex, false);
    assert_eq!(
        hex.decode("FCFF01000200").unwrap()[..3],
        [None, Some(1), Some(2)]
    );
    let signed = Group {
        types: &[Type::I16],
        encoding: Encoding::Hex,
        crc: false,
    };
    assert_eq!(signed.decode("FF7F").unwrap()[0], None);
    assert_eq!(signed.decode("0080").unwrap()[0], Some(-32768));
}

#[test]
fn bad_data_messages_are_refused_whole() {
    assert_eq!(daq::split("806 | 4561"), Err(DaqError::Group));
    assert_eq!(daq::split("20:1"), Err(DaqError::Group));
    let crc = group(Encoding::Hex, true);
    assert_eq!(crc.decode("2603D111EB0F68CE"), Err(DaqError::Crc));
    assert_eq!(crc.decode("2603D111EB0F"), Err(DaqError::Crc));
    assert_eq!(crc.decode("2603D111EB0F68C"), Err(DaqError::Encoding));
    assert_eq!(crc.decode(""), Err(DaqError::Count));
    let ascii = group(Encoding::Ascii, false);
    // Numbers that the type cannot hold.
    for text in [
        "-5 | 1 | 2",
        "65536 | 1 | 2",
        "+5 | 1 | 2",
        "99999999999 | 1 | 2",
    ] {
        assert_eq!(ascii.decode(text), Err(DaqError::Encoding), "{text}");
    }
    // Older firmware puts a second mark before binary data.
    assert_eq!(daq::split("#3:26"), Ok((3, "26")));
    assert_eq!(ascii.decode("1 | 2"), Err(DaqError::Count));
    assert_eq!(ascii.decode("1 | 2 | 3 | 4"), Err(DaqError::Count));
    assert_eq!(ascii.decode("1 | 2 | x"), Err(DaqError::Encoding));
    assert_eq!(
        group(Encoding::Base64, false).decode("JgPRE"),
        Err(DaqError::Encoding)
    );
    assert_eq!(
        group(Encoding::Base64, false).decode("JgPRE*sP"),
        Err(DaqError::Encoding)
    );
}

/// Every single-bit error of the documented frames with CRC is noticed.
#[test]
fn every_flipped_bit_under_a_crc_is_noticed() {
    let crc = group(Encoding::Hex, true);
    let good = b"2603D111EB0F68CF";
    for byte in 0..good.len() {
        for bit in 0..8 {
            let mut bad = good.to_vec();
            bad[byte] ^= 1 << bit;
            let Ok(bad) = String::from_utf8(bad) else {
                continue;
            };
            // Lower case is the same number.
            if bad.eq_ignore_ascii_case("2603D111EB0F68CF") {
                continue;
            }
            assert!(crc.decode(&bad).is_err(), "{bad}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Any bytes: no panic, nothing grows, and the next good message is read.
    #[test]
    fn hostile_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..700)) {
        let mut all = bytes.clone();
        all.extend(b"\x02:ok\x03");
        let found = messages(&all);
        let last = found.last().copied().unwrap().unwrap();
        prop_assert_eq!(last.text(), "ok");
        for message in found.into_iter().flatten() {
            let text = message.text();
            let _ = (reply::drive_state(text), reply::error_code(text), reply::number(text));
            let _ = (daq::split(text), Request::parse(text.as_bytes()));
            for encoding in [Encoding::Ascii, Encoding::Hex, Encoding::Base64] {
                let _ = group(encoding, true).decode(text);
            }
        }
        let _ = Request::parse(&bytes);
        let mut reader = LineReader::default();
        for byte in &bytes {
            let _ = reader.push(*byte);
        }
    }

    #[test]
    fn values_round_trip_in_every_encoding(a in 0_i64..65531, b in -32768_i64..32763, c in 0_i64..251, d in 0_i64..4_294_967_291) {
        let types = [Type::U16, Type::I16, Type::U8, Type::U32];
        for (encoding, crc) in [(Encoding::Ascii, false), (Encoding::Hex, true), (Encoding::Base64, true), (Encoding::Base64, false)] {
            let group = Group { types: &types, encoding, crc };
            let mut values = daq::Values::default();
            values[..4].copy_from_slice(&[Some(a), Some(b), Some(c), Some(d)]);
            let payload = group.encode(&values).unwrap();
            let read = group.decode(std::str::from_utf8(payload.as_slice()).unwrap());
            prop_assert_eq!(read, Ok(values));
        }
    }
}
