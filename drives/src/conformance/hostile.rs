//! Bytes that no robot should send: random, spoiled, cut, repeated, oversized.

use haltline::time::Duration;

use super::Failure;
use super::bench::Bench;
use super::checks::{fail, moves, started};
use super::rig::{Random, Rig, Spoiler};
use super::twins::Twin;

const NONSENSE: &str = "well-framed nonsense";

const SPOILERS: [(&str, Spoiler); 6] = [
    ("random bytes between packets", |random, mut bytes| {
        let count = random.below(12);
        bytes.extend((0..count).map(|_| random.next() as u8));
        bytes
    }),
    ("flipped bits", |random, mut bytes| {
        if let Some(byte) = bytes.get_mut(random.below(40)) {
            *byte ^= 1 << random.below(8);
        }
        bytes
    }),
    ("lost bytes", |random, mut bytes| {
        bytes.retain(|_| random.below(30) != 0);
        bytes
    }),
    ("packets twice", |random, bytes| {
        if random.below(4) == 0 {
            bytes.repeat(2)
        } else {
            bytes
        }
    }),
    ("endless packets", |random, mut bytes| {
        // Beginnings of all three kinds, and what follows is too long for any.
        let starts: [&[u8]; 3] = [b"\xFA\xFB\xFF", b"\x02:", b"\x02#1:"];
        if random.below(20) == 0 {
            bytes.extend_from_slice(starts[random.below(3)]);
            bytes.extend(std::iter::repeat_n(b'A', random.below(600)));
        }
        bytes
    }),
    (NONSENSE, |random, mut bytes| {
        if random.below(10) == 0 {
            let data: Vec<u8> = (0..random.below(60)).map(|_| random.next() as u8).collect();
            if let Some(packet) = crate::arcos::Packet::new(random.next() as u8, &data) {
                bytes.extend_from_slice(packet.to_bytes().as_slice());
            }
            let answers: [&[u8]; 4] = [b"\x02:F 900\x03", b":4711\x03", b"#1:FFFF\x03", b":ok\x03"];
            bytes.extend_from_slice(answers[random.below(4)]);
        }
        bytes
    }),
];

pub(super) fn bytes(bench: &dyn Bench, twin: Option<Twin>) -> Result<String, Failure> {
    let mut rounds = 0;
    for (name, spoiler) in SPOILERS {
        for seed in 1..=6 {
            rounds += 1;
            at_rest(bench, twin, name, spoiler, seed)?;
            in_motion(bench, twin, name, spoiler, seed)?;
            // Whoever frames his nonsense well towards the robot commands it.
            if name != NONSENSE {
                towards_robot(bench, twin, name, spoiler, seed)?;
            }
        }
    }
    Ok(format!(
        "{rounds} spoiled streams at rest, as many in motion, and all but well-framed ones towards the robot"
    ))
}

/// The robot hears spoiled bytes: it must not move at rest, nor faster than was decided.
fn towards_robot(
    bench: &dyn Bench,
    twin: Option<Twin>,
    name: &str,
    spoiler: Spoiler,
    seed: u64,
) -> Result<(), Failure> {
    let mut rig = Rig::new(bench, twin);
    rig.random = Random::new(seed);
    rig.spoil_said = Some(spoiler);
    for _ in 0..40 {
        rig.drive.enable(rig.now);
        rig.decide(0.0, 0.0, Duration::from_ms(100));
    }
    if rig.fastest.iter().any(|rate| *rate > 1e-9) {
        let seen = format!("{name} towards the robot, at rest: {:?}", rig.fastest);
        return Err(fail("DRIVE-09", seen));
    }
    let mut rig = Rig::new(bench, twin);
    let (v, turn) = started(&mut rig, bench)?;
    rig.random = Random::new(seed);
    rig.spoil_said = Some(spoiler);
    rig.fastest = [0.0; 2];
    rig.decide(v, turn, Duration::from_ms(2000));
    if rig.fastest[0] > v + 0.03 || rig.robot.truth().twist[0] < -0.03 {
        let seen = format!("{name} towards the robot, in motion: {:?}", rig.fastest);
        return Err(fail("DRIVE-09", seen));
    }
    rig.spoil_said = None;
    rig.decide(0.0, 0.0, Duration::from_ms(3000));
    if !rig.start() {
        return Err(fail("DRIVE-09", format!("{name}: never drives again")));
    }
    Ok(())
}

/// From the first byte on, and with rest decided: nothing but zero may be said.
fn at_rest(
    bench: &dyn Bench,
    twin: Option<Twin>,
    name: &str,
    spoiler: Spoiler,
    seed: u64,
) -> Result<(), Failure> {
    let mut rig = Rig::new(bench, twin);
    rig.random = Random::new(seed);
    rig.spoil = Some(spoiler);
    for _ in 0..40 {
        rig.drive.enable(rig.now);
        rig.decide(0.0, 0.0, Duration::from_ms(100));
    }
    match rig.told.iter().find(|told| moves(told, bench.is_arc())) {
        None => Ok(()),
        Some(told) => Err(fail("DRIVE-09", format!("{name}, at rest: {told:?}"))),
    }
}

/// In motion: never more than was decided, and a robot that can be heard again drives again.
fn in_motion(
    bench: &dyn Bench,
    twin: Option<Twin>,
    name: &str,
    spoiler: Spoiler,
    seed: u64,
) -> Result<(), Failure> {
    let mut rig = Rig::new(bench, twin);
    let (v, turn) = started(&mut rig, bench)?;
    rig.random = Random::new(seed);
    rig.spoil = Some(spoiler);
    let since = rig.now;
    rig.decide(v, turn, Duration::from_ms(2000));
    let [v_quantum, turn_quantum] = bench.quantum();
    let over = rig.told_since(since).find(|told| {
        told.linear > v + v_quantum || told.turn > turn + turn_quantum || told.linear < 0.0
    });
    if let Some(told) = over {
        return Err(fail("DRIVE-09", format!("{name}, in motion: {told:?}")));
    }
    rig.spoil = None;
    rig.decide(0.0, 0.0, Duration::from_ms(3000));
    if !rig.start() {
        return Err(fail("DRIVE-09", format!("{name}: never drives again")));
    }
    Ok(())
}
