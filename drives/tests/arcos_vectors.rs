//! The byte vectors of the ARCOS fact sheet, and what hostile bytes may do to the decoders.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::time::{Duration, Instant};
use haltline_drives::arcos::command::{number, vel2_sides};
use haltline_drives::arcos::config::{Config, text};
use haltline_drives::arcos::frame::checksum;
use haltline_drives::arcos::server::{self, Gyro, Identity, Message};
use haltline_drives::arcos::sip::{Bumpers, Flags, Tail, Unwrap};
use haltline_drives::arcos::{Argument, Command, Deframer, FrameError, Packet, Sip};
use proptest::prelude::*;

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
    digits
        .chunks(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

fn packets(bytes: &[u8]) -> Vec<Result<Packet, FrameError>> {
    let mut deframer = Deframer::default();
    let now = Instant::from_us(1);
    bytes
        .iter()
        .filter_map(|byte| deframer.push(*byte, now))
        .collect()
}

/// Command, bytes on the wire: manuals and a run of an independent client library.
fn vectors() -> Vec<(Command<'static>, &'static str)> {
    use number as n;
    vec![
        (Command::bare(n::PULSE), "fafb03000000"),
        (Command::bare(n::SYNC1), "fafb03010001"),
        (Command::bare(n::SYNC2), "fafb03020002"),
        (Command::int(n::OPEN, 1), "fafb06013b0100023b"),
        (Command::int(n::CONFIG, 1), "fafb06123b0100133b"),
        (Command::int(n::ENABLE, 1), "fafb06043b0100053b"),
        (Command::int(n::CLOSE, 1), "fafb06023b0100033b"),
        (Command::int(n::VEL, 500), "fafb060b3bf401ff3c"),
        (Command::int(n::VEL, -500), "fafb060b1bf401ff1c"),
        (Command::int(n::RVEL, 15), "fafb06153b0f00243b"),
        (Command::int(n::RVEL, -15), "fafb06151b0f00241b"),
        (Command::bare(n::STOP), "fafb031d001d"),
        (Command::bare(n::E_STOP), "fafb03370037"),
        (Command::int(n::SETV, 1200), "fafb06063bb004b63f"),
        (Command::int(n::SETRV, 80), "fafb060a3b50005a3b"),
        (Command::int(n::SETA, -500), "fafb06051bf401f91c"),
        (Command::int(n::JOYDRIVE, 1), "fafb062f3b0100303b"),
        (Command::vel2(25, -25), "fafb06203be7190754"),
        (Command::vel2(-25, 25), "fafb06201be7180733"),
    ]
}

#[test]
fn commands_are_the_bytes_of_the_sheet_both_ways() {
    for (command, bytes) in vectors() {
        let bytes = hex(bytes);
        let packet = command.encode().unwrap();
        assert_eq!(packet.to_bytes().as_slice(), bytes, "{command:?}");
        assert_eq!(packets(&bytes), [Ok(packet)]);
        assert_eq!(Command::decode(&packet), Some(command));
    }
}

#[test]
fn vel2_sides_come_back_with_their_signs() {
    for left in i8::MIN..=i8::MAX {
        for right in i8::MIN..=i8::MAX {
            let packet = Command::vel2(left, right).encode().unwrap();
            let decoded = Command::decode(&packet).unwrap();
            let Argument::Int(value) = decoded.argument else {
                panic!("{decoded:?}");
            };
            assert_eq!(vel2_sides(value), Some((left, right)));
        }
    }
}

#[test]
fn texts_of_a_command_are_counted() {
    let command = Command {
        number: 3,
        argument: Argument::Text(&[1, 2, 3]),
    };
    let packet = command.encode().unwrap();
    assert_eq!(packet.data(), [0x2B, 3, 1, 2, 3]);
    assert_eq!(Command::decode(&packet), Some(command));
    assert!(Command::int(11, 65_536).encode().is_none());
    assert!(Packet::new(1, &[0; 195]).is_none());
    assert!(Packet::new(1, &[0; 194]).is_some());
}

#[test]
fn checksum_is_big_endian_words_and_a_lone_byte() {
    assert_eq!(checksum(&[]), 0);
    assert_eq!(checksum(&[0x1d]), 0x1d);
    assert_eq!(checksum(&[0x0b, 0x3b, 0xf4, 0x01]), 0xff3c);
    assert_eq!(checksum(&[0xff, 0xff, 0x00, 0x02, 0x01]), 0x0000);
}

/// Recorded from a simulated Seekur Jr at rest: 36 bytes with the id, no time and no further flags.
const IDLE: &str = "320000 0000 0000 0000 0000 82 0000 0000 1f00 00 00 00 00 00 ff ff 8200 00 \
                    0000 0000 0000 81 00";

#[test]
fn the_recorded_sip_is_read_field_by_field() {
    let body = hex(IDLE);
    assert_eq!(body.len(), 36);
    let packet = Packet::new(body[0], &body[1..]).unwrap();
    let sip = Sip::decode(&packet).unwrap();
    assert_eq!(sip.battery_decivolts, 130);
    assert_eq!(sip.flags, Flags(0x1f));
    assert_eq!(sip.ports, [0, 0, 0, 0xff, 0xff]);
    assert_eq!(sip.tail.battery_decivolts, Some(130));
    assert_eq!(sip.tail.temperature_c, Some(-127));
    assert_eq!(sip.tail.charge_percent, Some(0));
    assert_eq!((sip.tail.clock_us, sip.tail.flags3), (None, None));
    assert!(!sip.moving);
    assert_eq!(sip.encode(), Some(packet));
}

fn full() -> Sip {
    let mut sonars = [None; 16];
    sonars[0] = Some((3, 1234));
    sonars[1] = Some((7, 5000));
    Sip {
        moving: true,
        x: 0x7fff,
        y: 0x8001,
        heading: -1024,
        left: -250,
        right: 300,
        battery_decivolts: 255,
        bumpers: Bumpers(0b1000_0001_0001_0110),
        control: -5,
        flags: Flags(0x61),
        compass: 90,
        sonars,
        ports: [1, 2, 3, 4, 5],
        tail: Tail {
            battery_decivolts: Some(265),
            charge_state: Some(-1),
            rotation_decidegps: Some(-123),
            faults: Some(2),
            lateral_mmps: Some(-1),
            temperature_c: Some(-20),
            charge_percent: Some(87),
            clock_us: Some(4_000_000_000),
            flags3: Some(9),
        },
    }
}

#[test]
fn every_tail_length_is_read_up_to_its_last_whole_field() {
    let whole = full().encode().unwrap();
    assert_eq!(Sip::decode(&whole), Some(full()));
    let ends = [0, 2, 3, 5, 7, 9, 10, 11, 15, 19];
    let required = whole.data().len() - 19;
    for cut in 0..=whole.data().len() {
        let packet = Packet::new(0x33, &whole.data()[..cut]).unwrap();
        let sip = Sip::decode(&packet);
        if cut < required {
            assert_eq!(sip, None, "a required field is missing at {cut}");
            continue;
        }
        let tail = sip.unwrap().tail;
        let present = [
            tail.battery_decivolts.is_some(),
            tail.charge_state.is_some(),
            tail.rotation_decidegps.is_some(),
            tail.faults.is_some(),
            tail.lateral_mmps.is_some(),
            tail.temperature_c.is_some(),
            tail.charge_percent.is_some(),
            tail.clock_us.is_some(),
            tail.flags3.is_some(),
        ];
        let expected = ends[1..]
            .iter()
            .filter(|end| required + **end <= cut)
            .count();
        assert_eq!(present.iter().filter(|p| **p).count(), expected, "at {cut}");
        assert!(present.iter().take(expected).all(|p| *p));
    }
}

#[test]
fn bumpers_and_stalls_are_told_apart() {
    let bumpers = full().bumpers;
    assert!(!bumpers.left_stall());
    assert!(bumpers.right_stall());
    assert_eq!(bumpers.rear(), 0b000_1011);
    assert_eq!(bumpers.front(), 0b100_0000);
    assert!(
        full()
            .flags
            .has(Flags::MOTORS | Flags::STOP_BUTTON | Flags::E_STALL)
    );
}

#[test]
fn positions_are_followed_over_the_wrap_in_both_directions() {
    // Every start, steps up to the limit, counters of 15 and of 16 bits.
    for start in (0..=u16::MAX).step_by(97) {
        for step in [-4095, -2000, -1, 0, 1, 17, 2000, 4095] {
            let mut unwrap = Unwrap::default();
            assert_eq!(unwrap.step(start), 0);
            let next = (i32::from(start) + step).rem_euclid(0x1_0000) as u16;
            assert_eq!(unwrap.step(next), step, "16 bit from {start}");
            let mut unwrap = Unwrap::default();
            unwrap.step(start & 0x7fff);
            assert_eq!(unwrap.step(next & 0x7fff), step, "15 bit from {start}");
            assert_eq!(unwrap.total, i64::from(step));
        }
    }
}

#[test]
fn the_handshake_names_the_robot() {
    let packet = Packet::new(2, b"AMRISim\0Pioneer\0seekurjr\0").unwrap();
    let identity = Identity::decode(&packet).unwrap();
    assert_eq!(identity.subclass.as_slice(), b"seekurjr");
    assert_eq!(identity.encode(), Some(packet));
    assert!(Identity::decode(&Packet::new(2, b"AMRISim\0Pioneer").unwrap()).is_none());
}

#[test]
fn configuration_may_end_anywhere() {
    let config = Config {
        class: text(b"Pioneer"),
        subclass: text(b"seekurjr"),
        serial: text(b"1"),
        rotation_top_degps: Some(80),
        speed_top_mmps: Some(1200),
        rotation_acceleration_top_degps2: Some(300),
        acceleration_top_mmps2: Some(2000),
        sip_cycle_ms: Some(100),
        watchdog_ms: Some(2000),
        rotation_max_degps: Some(80),
        speed_max_mmps: Some(1200),
        rotation_acceleration_degps2: Some(60),
        rotation_deceleration_degps2: Some(61),
        acceleration_mmps2: Some(500),
        deceleration_mmps2: Some(501),
        front_bumpers: Some(4),
        rear_bumpers: Some(5),
        has_gyro: Some(true),
        low_battery_decivolts: Some(220),
        low_charge_percent: Some(10),
    };
    let packet = config.encode().unwrap();
    assert_eq!(Config::decode(&packet), Some(config));
    let names = b"Pioneer\0seekurjr\x001\0".len();
    for cut in 0..packet.data().len() {
        let part = Packet::new(0x20, &packet.data()[..cut]).unwrap();
        match Config::decode(&part) {
            None => assert!(cut < names),
            Some(read) => {
                assert!(cut >= names);
                assert!(read.watchdog_ms.is_none_or(|ms| ms == 2000), "at {cut}");
                assert!(read.low_charge_percent.is_none(), "at {cut}");
            }
        }
    }
}

/// Offsets counted by hand from the list of fields, with the names of the sheet.
#[test]
fn the_watchdog_stands_where_the_list_says() {
    let mut data = b"a\0b\0c\0".to_vec();
    data.extend([0; 1 + 2 * 5]); // unused, five words
    data.push(0); // empty name
    data.extend([25, 0, 0]); // SipCycle, HostBaud, Aux1Baud
    data.extend([0; 2 + 2 + 1]); // gripper, front sonar, rear sonar
    data.extend(220_u16.to_le_bytes()); // LowBattery
    data.extend([0; 2]); // RevCount
    data.extend(1500_u16.to_le_bytes()); // Watchdog
    let config = Config::decode(&Packet::new(0x20, &data).unwrap()).unwrap();
    assert_eq!(config.sip_cycle_ms, Some(25));
    assert_eq!(config.low_battery_decivolts, Some(220));
    assert_eq!(config.watchdog_ms, Some(1500));
    assert_eq!(config.rotation_max_degps, None);
}

/// Every field of the sheet's list in its order, each word with a value of its own.
#[test]
fn every_field_of_the_configuration_stands_where_the_list_says() {
    let mut data = b"Pioneer\0seekurjr\0no7\0".to_vec();
    let words = |data: &mut Vec<u8>, values: &[u16]| {
        data.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    };
    data.push(99); // unused
    words(&mut data, &[101, 102, 103, 104, 105]); // RotVelTop TransVelTop RotAccTop TransAccTop PwmMax
    data.extend(b"Jr\0");
    data.extend([20, 2, 3]); // SipCycle HostBaud Aux1Baud
    words(&mut data, &[106, 107]); // HasGripper FrontSonar
    data.push(4); // RearSonar
    words(&mut data, &[108, 109, 110]); // LowBattery RevCount Watchdog
    data.push(5); // P2Mpacs
    words(&mut data, &[111, 112, 113, 114]); // StallVal StallCount JoyVel JoyRotVel
    words(&mut data, &[115, 116, 117, 118, 119, 120, 121]); // RotVelMax TransVelMax RotAcc RotDecel RotKp Kv Ki
    words(&mut data, &[122, 123, 124, 125, 126]); // TransAcc TransDecel TransKp Kv Ki
    data.extend([6, 7, 8, 9, 2, 1]); // FrontBumps RearBumps Charger SonarCycle AutoBaud HasGyro
    words(&mut data, &[127]); // DriftFactor
    data.extend([10, 11]); // Aux2Baud Aux3Baud
    words(&mut data, &[128, 129]); // TicksMM ShutdownVoltage
    data.extend(b"3.1\0");
    words(&mut data, &[130, 131]); // GyroCW GyroCCW
    data.push(12); // KinematicsDelay
    words(&mut data, &[132, 133, 134, 135, 136, 137]); // LatVelTop .. LatDecel ChargeThreshold
    data.push(13); // PDBPort
    words(&mut data, &[138]); // GyroRateLimit
    data.push(14); // HighTempShutdown
    words(&mut data, &[139]); // PowerBits
    data.push(2); // BatteryType
    words(&mut data, &[140, 141]); // LowSOC ShutdownSOC
    data.extend(b"boot\0");
    data.extend([0; 6]); // ConfigFlags GyroFW
    let config = Config::decode(&Packet::new(0x20, &data).unwrap()).unwrap();
    let wanted = Config {
        class: text(b"Pioneer"),
        subclass: text(b"seekurjr"),
        serial: text(b"no7"),
        rotation_top_degps: Some(101),
        speed_top_mmps: Some(102),
        rotation_acceleration_top_degps2: Some(103),
        acceleration_top_mmps2: Some(104),
        sip_cycle_ms: Some(20),
        low_battery_decivolts: Some(108),
        watchdog_ms: Some(110),
        rotation_max_degps: Some(115),
        speed_max_mmps: Some(116),
        rotation_acceleration_degps2: Some(117),
        rotation_deceleration_degps2: Some(118),
        acceleration_mmps2: Some(122),
        deceleration_mmps2: Some(123),
        front_bumpers: Some(6),
        rear_bumpers: Some(7),
        has_gyro: Some(true),
        low_charge_percent: Some(140),
    };
    assert_eq!(config, wanted);
}

#[test]
fn other_packets_are_read_or_refused_whole() {
    let gyro = Packet::new(0x98, &[2, 0, 2, 30, 10, 2, 31]).unwrap();
    let Some(Message::Gyro(read)) = server::decode(&gyro) else {
        panic!("a gyro packet");
    };
    assert_eq!(read.rates[..3], [Some(512), Some(522), None]);
    assert!(server::decode(&Packet::new(0x98, &[2, 0, 2, 30]).unwrap()).is_none());
    // Clockwise is above the value at rest and negative in degrees.
    assert!(Gyro::degrees_per_second(522.0, 512.0, 1.626) < -9.0);
    let stick = Packet::new(0xF8, &[1, 0, 0xff, 3, 0, 2, 0, 4]).unwrap();
    let Some(Message::Joystick(stick)) = server::decode(&stick) else {
        panic!("a joystick packet");
    };
    assert_eq!((stick.x, stick.y, stick.throttle), (1023, 512, 1024));
    let battery = Packet::new(0xFA, &[1, 5, 1, 2, 3, 87, 80]).unwrap();
    let Some(Message::Battery(cells)) = server::decode(&battery) else {
        panic!("a battery packet");
    };
    assert_eq!(cells[0].unwrap().charge_percent, [87, 80]);
    assert!(server::decode(&Packet::new(0xFA, &[200, 255]).unwrap()).is_none());
    let ticks = Packet::new(0x90, &[255, 255, 255, 255, 1, 0, 0, 0]).unwrap();
    assert!(matches!(server::decode(&ticks), Some(Message::Encoders(e)) if e.left == -1));
}

#[test]
fn a_packet_that_stops_in_the_middle_does_not_eat_the_next() {
    let mut deframer = Deframer::default();
    let t0 = Instant::from_us(1000);
    for byte in hex("fafb060b3bf4") {
        assert_eq!(deframer.push(byte, t0), None);
    }
    let later = t0.plus(Duration::from_ms(101));
    let results: Vec<_> = hex("fafb031d001d")
        .iter()
        .filter_map(|byte| deframer.push(*byte, later))
        .collect();
    assert_eq!(results[0], Err(FrameError::TimedOut));
    assert_eq!(results[1].unwrap().id(), number::STOP);
    assert_eq!(results.len(), 2);
}

#[test]
fn doubled_header_bytes_and_bad_lengths_are_survived() {
    let stop = "fafb031d001d";
    for noise in [
        "fa",
        "fafa",
        "fafb00",
        "fafb02",
        "fb",
        "fafb03ff00",
        "0000fa",
    ] {
        let found = packets(&hex(&format!("{noise}{stop}")));
        if noise == "fafb03ff00" {
            // It announces one byte more than there is and takes the next header with it.
            assert_eq!(found[0], Err(FrameError::Checksum(0xff)));
        } else {
            let good: Vec<_> = found.iter().filter(|p| p.is_ok()).collect();
            assert_eq!(good.len(), 1, "after {noise}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// However a stream is cut into reads, the same packets come out.
    #[test]
    fn split_and_joined_streams_give_the_same_packets(values in prop::collection::vec(-2000_i32..2000, 1..8)) {
        let mut bytes = Vec::new();
        for value in &values {
            bytes.extend_from_slice(Command::int(number::VEL, *value).encode().unwrap().to_bytes().as_slice());
        }
        let found = packets(&bytes);
        prop_assert_eq!(found.len(), values.len());
        for (packet, value) in found.iter().zip(&values) {
            let packet = packet.unwrap();
            prop_assert_eq!(Command::decode(&packet), Some(Command::int(number::VEL, *value)));
        }
    }

    /// A packet with one bit flipped is refused or lost; it never becomes another motion.
    #[test]
    fn one_flipped_bit_never_makes_another_motion(value in -1200_i32..1200, bit in 0_usize..72) {
        let good = Command::int(number::VEL, value).encode().unwrap().to_bytes();
        let mut bytes = good.as_slice().to_vec();
        bytes[bit / 8] ^= 1 << (bit % 8);
        for packet in packets(&bytes).into_iter().flatten() {
            let command = Command::decode(&packet);
            let moved = matches!(command, Some(Command { number: number::VEL | number::RVEL | number::VEL2, .. }));
            prop_assert!(!moved, "{:?}", command);
        }
    }

    /// Any bytes at all: no panic, and what is accepted has a right checksum.
    #[test]
    fn hostile_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        for packet in packets(&bytes).into_iter().flatten() {
            let _ = (Sip::decode(&packet), Config::decode(&packet), Command::decode(&packet));
            let _ = (server::decode(&packet), Identity::decode(&packet));
            let wire = packet.to_bytes();
            prop_assert!(bytes.windows(wire.as_slice().len()).any(|w| w == wire.as_slice()));
        }
    }

    /// Hostile content behind a right checksum.
    #[test]
    fn hostile_content_is_survived(id in any::<u8>(), data in prop::collection::vec(any::<u8>(), 0..194)) {
        let packet = Packet::new(id, &data).unwrap();
        let _ = (Sip::decode(&packet), Config::decode(&packet), Command::decode(&packet));
        let _ = (server::decode(&packet), Identity::decode(&packet));
        prop_assert_eq!(packets(packet.to_bytes().as_slice()), [Ok(packet)]);
    }

    /// After any noise a stream is back in step within one longest packet.
    #[test]
    fn noise_costs_at_most_one_longest_packet(noise in prop::collection::vec(any::<u8>(), 0..300)) {
        let stop = Command::bare(number::STOP).encode().unwrap();
        let mut bytes = noise;
        // 255 announced bytes at most can be swallowed: 43 packets of 6 bytes.
        for _ in 0..45 {
            bytes.extend_from_slice(stop.to_bytes().as_slice());
        }
        prop_assert_eq!(packets(&bytes).pop(), Some(Ok(stop)));
    }
}
