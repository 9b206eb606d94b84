//! The scanner's telegrams: the manual's example, cut, spoiled and hostile ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::time::Instant;
use haltline_drives::cola::{
    ClockMap, Deframer, Header, TelegramError, decode_scan, frame_into, header_text,
};
use proptest::prelude::*;

/// Worked example of the telegram listing.
const EXAMPLE: &str = "sRA LMDscandata 1 1 89A27F 0 0 343 347 27477BA9 2747813B 0 0 7 0 0 1388 168 \
                       0 1 DIST1 3F800000 00000000 186A0 1388 15 8A1 8A5 8AB 8AC 8A6 8AC 8B6 8C8 8C2 \
                       8C9 8CB 8C4 8E4 8E1 8EB 8E0 8F5 908 8FC 907 906 0 0 0 0 0 0";

fn telegrams(bytes: &[u8]) -> Vec<Result<String, TelegramError>> {
    let mut deframer = Deframer::default();
    let mut found = Vec::new();
    for byte in bytes {
        if let Some(telegram) = deframer.push(*byte) {
            found.push(telegram.map(str::to_owned));
        }
    }
    found
}

fn framed(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    frame_into(text, |part| bytes.extend_from_slice(part));
    bytes
}

#[test]
fn the_example_of_the_manual_is_read() {
    let scan = decode_scan(EXAMPLE).unwrap();
    let header = Header {
        status: 0,
        telegrams: 0x343,
        scans: 0x347,
        start_us: 0x2747_7BA9,
        sent_us: 0x2747_813B,
        frequency_chz: 5000,
        start_angle: 100_000,
        step: 5000,
        count: 21,
    };
    assert_eq!(scan.header, header);
    assert_eq!(scan.ranges_mm[..3], [0x8A1, 0x8A5, 0x8AB]);
    assert_eq!(scan.ranges_mm[20..22], [0x906, 0]);
    let mut text = String::new();
    header_text(&header, false, &mut text).unwrap();
    assert!(EXAMPLE.starts_with(&text), "{text}");
    let streamed = EXAMPLE.replace("sRA", "sSN").replace("186A0", "FFF92230");
    assert_eq!(decode_scan(&streamed).unwrap().header.start_angle, -450_000);
}

#[test]
fn encoders_are_read_over() {
    let with = EXAMPLE.replace(" 168 0 1 DIST1", " 168 1 0 3E8 1 DIST1");
    assert_eq!(decode_scan(&with), decode_scan(EXAMPLE));
}

#[test]
fn a_telegram_cut_anywhere_within_its_ranges_is_no_scan() {
    let words: Vec<_> = EXAMPLE.split(' ').collect();
    let whole = words.len() - 6;
    for cut in 0..=whole {
        assert!(
            decode_scan(&words[..cut].join(" ")).is_none(),
            "{cut} words"
        );
    }
    assert!(decode_scan(&words[..=whole].join(" ")).is_some());
}

#[test]
fn another_scale_channel_or_number_is_refused() {
    for (from, to) in [
        ("3F800000", "40000000"),
        ("DIST1", "RSSI1"),
        (" 15 8A1", " FFFF 8A1"),
        ("8A5", "-8A5"),
        ("8A5", "18A51"),
        ("8A5", "8G5"),
        ("sRA", "sFA"),
    ] {
        assert!(decode_scan(&EXAMPLE.replace(from, to)).is_none(), "{to}");
    }
}

#[test]
fn telegrams_are_found_in_a_spoiled_stream() {
    let mut bytes = b"noise\x03".to_vec();
    bytes.extend(b"\x02sEA LMDscan");
    bytes.extend(framed("sEA LMDscandata 1"));
    bytes.extend(b"\x02");
    bytes.extend(vec![b'A'; 9000]);
    bytes.push(3);
    bytes.extend(b"\x02\xff\x03");
    bytes.extend(framed(EXAMPLE));
    let found = telegrams(&bytes);
    assert_eq!(
        found,
        [
            Err(TelegramError::CutShort),
            Ok("sEA LMDscandata 1".to_owned()),
            Err(TelegramError::TooLong),
            Err(TelegramError::NotText),
            Ok(EXAMPLE.to_owned()),
        ]
    );
}

#[test]
fn stamps_come_from_the_fastest_telegram_and_never_from_the_future() {
    let mut clock = ClockMap::default();
    let mut device: u32 = u32::MAX - 100_000; // wraps on the way
    let mut host = 7_000_000_u64;
    for index in 0..500_u64 {
        let delay = if index % 7 == 3 {
            200
        } else {
            200 + (index * 7919) % 5000
        };
        let start = device.wrapping_sub(15_000);
        let stamp = clock
            .map(start, device, Instant::from_us(host + delay))
            .unwrap();
        assert!(stamp.as_us() <= host + delay);
        if index > 10 {
            assert_eq!(stamp.as_us(), host + 200 - 15_000, "telegram {index}");
        }
        device = device.wrapping_add(20_000);
        host += 20_000;
    }
    assert_eq!(
        clock.map(device.wrapping_add(5), device, Instant::from_us(host)),
        None
    );
    // A restart forgets the old offset.
    let stamp = clock
        .map(1_000, 16_000, Instant::from_us(host + 50_000))
        .unwrap();
    assert_eq!(stamp.as_us(), host + 50_000 - 15_000);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn hostile_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let mut all = bytes;
        all.extend(framed(EXAMPLE));
        let found = telegrams(&all);
        prop_assert_eq!(found.last(), Some(&Ok(EXAMPLE.to_owned())));
        for text in found.into_iter().flatten() {
            let _ = decode_scan(&text);
        }
    }

    #[test]
    fn spoiled_words_never_panic(index in 0_usize..52, word in "[ -~]{0,12}") {
        let mut words: Vec<_> = EXAMPLE.split(' ').collect();
        let index = index % words.len();
        words[index] = &word;
        let _ = decode_scan(&words.join(" "));
    }

    #[test]
    fn any_clock_is_survived(times in prop::collection::vec((any::<u32>(), any::<u32>(), any::<u64>()), 0..50)) {
        let mut clock = ClockMap::default();
        for (event, sent, now) in times {
            let now = Instant::from_us(now);
            if let Some(stamp) = clock.map(event, sent, now) {
                prop_assert!(stamp <= now);
            }
        }
    }
}
