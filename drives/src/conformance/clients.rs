//! Both emulators under a client that says anything, at any time, in any pieces.
//!
//! What the drives' safety rests on must not be a promise of the emulators' that a strange client can break: speeds
//! within the robot's own limits, and rest once the client is silent.

use haltline::time::{Duration, Instant};

use super::attack::{Broken, demand};
use crate::arcos::Packet;
use crate::emulator::{Car, CarModel, OutOfOrder, Robot, Seekur, SeekurModel};

/// What a strange client meets.
struct Case {
    name: &'static str,
    robot: Box<dyn Robot>,
    /// The same robot, to which every byte comes alone.
    piecewise: Box<dyn Robot>,
    /// Highest speed, m/s, and turn rate, rad/s, that the robot's sheet allows.
    limits: [f64; 2],
    /// Said before the client falls silent, so that the robot's watchdog is armed.
    last_words: &'static [u8],
    /// Time from the last byte to rest by the sheet.
    silence: Duration,
}

/// Lines to the control board; `#` stands for a number of the script's.
const LINES: [&str; 17] = [
    "!DRV F # #",
    "!DRV F #",
    "!DRV B #",
    "!DRV D #",
    "!DRV F",
    "!DRV OFF",
    "!DRV",
    "!DRV ~DMS=#",
    "!DRV ~DMS=4294967295",
    "!STEER # #",
    "!STEER -99999999999",
    "?DRV ~DMS",
    "!DAQ GRP 1 GZ HALL_CNT ~TS=# ~ENC=B64 ~CRC",
    "!DAQ GRP 2 _TICS ~TS=18446744073709551615",
    "!DAQ START",
    "?DAQ GET GZ VDBAT",
    "!SID #",
];

/// Commands that move the robot or change how it moves: VEL, RVEL, ROTATE, VEL2, SETV, SETA, SETRV, SETRA, ENABLE,
/// STOP, E_STOP, CLOSE.
const COMMANDS: [u8; 12] = [11, 21, 9, 32, 6, 5, 10, 23, 4, 29, 55, 2];

/// The script in parts of four bytes: what happens, and three bytes with which it happens. Judged are the robots' speeds
/// at any time, rest at the end, that neither a number is lost nor more is said than was asked for, and that
/// bytes mean the same however they are cut.
///
/// Returns how many parts found a robot in motion.
///
/// # Errors
/// The property that does not hold.
pub fn emulators(script: &[u8], seekur: SeekurModel, car: CarModel) -> Result<usize, Broken> {
    let start = Instant::from_us(1_000_000);
    let out_of_order = match script.first().map_or(0, |byte| byte >> 3) % 3 {
        0 => OutOfOrder::Restart,
        1 => OutOfOrder::Ignore,
        _ => OutOfOrder::Adopt,
    };
    let seekur = SeekurModel {
        out_of_order,
        ..seekur
    };
    let cases = [
        Case {
            name: "Seekur Jr",
            robot: Box::new(Seekur::new(seekur, start)),
            piecewise: Box::new(Seekur::new(seekur, start)),
            limits: [1.2, 80_f64.to_radians()],
            last_words: b"",
            // Watchdog, and the softest way to brake that no client can change: 1.2 m/s at 0.4 m/s2, motors off.
            silence: Duration::from_ms(2000 + 3000 + 10),
        },
        Case {
            name: "model car",
            robot: Box::new(Car::new(car, start)),
            piecewise: Box::new(Car::new(car, start)),
            // The fastest level's steady speed, and that with the wheels turned to their stops.
            limits: [1.88, 1.88 * 0.45_f64.tan() / 0.25],
            last_words: b"\n!DRV ~DMS=300\n",
            // Dead-man switch, then coasting at 0.3 m/s2.
            silence: Duration::from_ms(300 + 6300 + 10),
        },
    ];
    let mut moving = 0;
    for mut case in cases {
        let mut now = start;
        for part in script.chunks(4).take(128) {
            case.part(part, &mut now)?;
            moving += usize::from(case.moves());
        }
        case.falls_silent(now)?;
    }
    Ok(moving)
}

impl Case {
    fn part(&mut self, part: &[u8], now: &mut Instant) -> Result<(), Broken> {
        let [what, one, two, three] =
            [0, 1, 2, 3].map(|index| part.get(index).copied().unwrap_or(0));
        match what & 7 {
            0 => self.hears(&[one, two, three], *now),
            1 => {
                let number = COMMANDS[usize::from(one) % COMMANDS.len()];
                self.hears(&packet(number, [two, three]), *now);
            }
            2 => {
                let number = i16::from_le_bytes([two, three]) % 1100;
                let line = LINES[usize::from(one) % LINES.len()];
                let line = line.replace('#', &number.to_string());
                self.hears(format!("{line}\n").as_bytes(), *now);
            }
            3 => {
                for number in [0, 1, 2, 1] {
                    self.hears(&packet(number, [0; 2]), *now);
                }
                self.hears(&packet(4, [1, 0]), *now);
            }
            4 => self.happens(one, *now),
            _ => {
                *now = now.plus(Duration::from_ms(u64::from(one) * 4));
                self.robot.step(*now);
                self.piecewise.step(*now);
            }
        }
        self.judge()
    }

    fn hears(&mut self, bytes: &[u8], now: Instant) {
        self.robot.receive(bytes, now);
        for byte in bytes {
            self.piecewise.receive(&[*byte], now);
        }
    }

    /// What happens to robots besides being spoken to.
    fn happens(&mut self, what: u8, now: Instant) {
        for robot in [&mut self.robot, &mut self.piecewise] {
            match what % 6 {
                0 => robot.reboot(now),
                1 => robot.reopened(),
                2 => robot.bump(what & 8 == 0),
                3 => robot.press_stop(true),
                4 => robot.press_stop(false),
                _ => robot.step(now),
            }
        }
    }

    fn moves(&self) -> bool {
        self.robot.truth().twist.iter().any(|rate| *rate != 0.0)
    }

    fn judge(&mut self) -> Result<(), Broken> {
        let name = self.name;
        let [whole, pieces] = [&mut self.robot, &mut self.piecewise].map(|robot| robot.outgoing());
        demand(
            whole.len() < 100_000,
            &format!("{name}: it says what it must and no more"),
        )?;
        demand(
            whole == pieces,
            &format!("{name}: its answers depend on where the bytes were cut"),
        )?;
        let truth = self.robot.truth();
        demand(
            truth == self.piecewise.truth(),
            &format!("{name}: its motion depends on where the bytes were cut"),
        )?;
        let finite = truth.pose.iter().all(|value| value.is_finite());
        demand(finite, &format!("{name}: {truth:?}"))?;
        let mut rates = truth.twist.iter().zip(self.limits);
        demand(
            rates.all(|(rate, limit)| rate.abs() <= limit + 1e-9),
            &format!("{name}: faster than {:?}: {truth:?}", self.limits),
        )
    }

    fn falls_silent(&mut self, mut now: Instant) -> Result<(), Broken> {
        self.hears(self.last_words, now);
        let until = now.plus(self.silence);
        while now < until {
            now = now.plus(Duration::from_ms(100));
            self.robot.step(now);
            self.piecewise.step(now);
            self.judge()?;
        }
        let truth = self.robot.truth();
        demand(
            truth.twist.iter().all(|rate| rate.abs() < 1e-9),
            &format!(
                "{}: its client is silent and it moves: {truth:?}",
                self.name
            ),
        )
    }
}

/// A client's packet with a number in sign and magnitude.
fn packet(number: u8, value: [u8; 2]) -> Vec<u8> {
    let value = i16::from_le_bytes(value);
    let sign = if value < 0 { 0x1B } else { 0x3B };
    let [low, high] = value.unsigned_abs().to_le_bytes();
    let packet = Packet::new(number, &[sign, low, high]);
    packet.map_or_else(Vec::new, |packet| packet.to_bytes().as_slice().to_vec())
}
