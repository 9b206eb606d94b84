//! The checks, but for hostile bytes.

use haltline::time::{Duration, Instant};

use super::Failure;
use super::bench::Bench;
use super::rig::Rig;
use super::taps::Told;
use super::twins::Twin;

pub(super) type Outcome = Result<String, Failure>;

pub(super) fn fail(requirement: &'static str, seen: String) -> Failure {
    Failure { requirement, seen }
}

/// Gaining more than this, m/s, is speeding up: 10 ms of the motor.
const SPEEDS_UP: f64 = 5e-3;
/// Slower than this counts as standing: m/s.
const STANDS: f64 = 2e-3;

pub(super) fn moves(told: &Told, is_arc: bool) -> bool {
    told.linear.abs() > 1e-9 || (!is_arc && told.turn.abs() > 1e-9)
}

fn cruising(bench: &dyn Bench) -> (f64, f64) {
    let [v_max, _, turn_max] = bench.limits();
    let (v, turn): (f64, f64) = if bench.is_arc() {
        (0.5, 0.8)
    } else {
        (0.6, 0.3)
    };
    (v.min(0.9 * v_max), turn.min(0.9 * turn_max))
}

/// Says that the adapter did not come to drive at all.
pub(super) fn started(rig: &mut Rig, bench: &dyn Bench) -> Result<(f64, f64), Failure> {
    let (v, turn) = cruising(bench);
    if rig.cruise(v, turn) {
        Ok((v, turn))
    } else {
        Err(fail(
            "DRIVE-01",
            format!("never came to drive: {:?}", rig.faults.last()),
        ))
    }
}

pub(super) fn start(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let (v, turn) = cruising(bench);
    let still = |rig: &Rig, when: &str| -> Result<(), Failure> {
        match rig.told.iter().find(|told| moves(told, bench.is_arc())) {
            None => Ok(()),
            Some(told) => Err(fail("DRIVE-01", format!("{when}: {told:?}"))),
        }
    };
    // The robot is mute; the operator enables, the planner wants to go.
    let mut rig = Rig::new(bench, twin);
    rig.to_host = false;
    for _ in 0..30 {
        rig.drive.enable(rig.now);
        rig.decide(v, turn, Duration::from_ms(100));
    }
    still(&rig, "mute robot")?;
    // It answers for so many milliseconds and then no more: the handshake breaks anywhere.
    for cut_ms in (0..400).step_by(7) {
        let mut rig = Rig::new(bench, twin);
        rig.decide(v, turn, Duration::from_ms(cut_ms));
        rig.to_host = false;
        rig.drive.enable(rig.now);
        rig.decide(v, turn, Duration::from_ms(700));
        still(&rig, "broken handshake")?;
    }
    // Everything answers, nobody enables.
    let mut rig = Rig::new(bench, twin);
    rig.decide(v, turn, Duration::from_ms(4000));
    still(&rig, "never enabled")?;
    Ok(format!(
        "58 broken handshakes, {} set points heard, all zero",
        rig.told.len()
    ))
}

pub(super) fn stop(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let mut rig = Rig::new(bench, twin);
    let (v, turn) = started(&mut rig, bench)?;
    decided_stop(&mut rig, bench, v, turn)?;
    let mut rig = Rig::new(bench, twin);
    started(&mut rig, bench)?;
    let rest_s = silent_stop(&mut rig, bench, v, turn)?;
    Ok(format!(
        "a stop decision is on the wire within its period; silence ramps to zero in {rest_s:.3} s"
    ))
}

/// The kernel's own ramp is followed set point by set point.
fn decided_stop(rig: &mut Rig, bench: &dyn Bench, v: f64, turn: f64) -> Result<(), Failure> {
    let [v_quantum, turn_quantum] = bench.quantum();
    for part in (0..10).rev() {
        let part = f64::from(part) / 10.0;
        let (v, turn) = (v * part, if bench.is_arc() { turn } else { turn * part });
        let before = rig.now;
        rig.decide(v, turn, bench.period());
        let Some(told) = rig.told_since(before).last().copied() else {
            return Err(fail("DRIVE-04", "nothing said within a period".to_owned()));
        };
        // A braking car is told to brake: less than asked, never more.
        let low = if bench.is_arc() {
            0.0
        } else {
            v - v_quantum - 1e-9
        };
        let fits = told.linear >= low
            && told.linear <= v + v_quantum + 1e-9
            && (told.turn - turn).abs() <= turn_quantum + 1e-9;
        if !fits {
            return Err(fail(
                "DRIVE-04",
                format!("decided {v} {turn}, said {told:?}"),
            ));
        }
    }
    Ok(())
}

/// No more decisions: a ramp on the same curvature, begun within one period of the expiry.
fn silent_stop(rig: &mut Rig, bench: &dyn Bench, v: f64, turn: f64) -> Result<f64, Failure> {
    let [v_quantum, turn_quantum] = bench.quantum();
    let [b, beta] = bench.braking();
    let ramp_s = if bench.is_arc() {
        v / b
    } else {
        (v / b).max(turn.abs() / beta)
    };
    rig.idle(Duration::from_ms(6000));
    let expiry = rig.expires;
    let seconds = |at: Instant| at.since(expiry).unwrap_or_default().as_us() as f64 * 1e-6;
    let mut rested = None;
    for told in rig.told_since(expiry.plus(bench.period())) {
        let s = seconds(told.at);
        // Two packets 5 ms apart and 2 ms of rhythm: said late by at most 20 ms.
        let ideal = |s: f64| v * (1.0 - s / ramp_s).max(0.0);
        let (latest, earliest) = (ideal(s - 0.02) + v_quantum, ideal(s) - v_quantum);
        // A car that is faster than its ramp is braked, but the ramp stays a ramp.
        let brakes = told.brake > 0 && (told.brake <= 400 || ideal(s) < 0.1);
        if told.linear > latest || (told.linear < earliest && !brakes) {
            return Err(fail(
                "DRIVE-05",
                format!("{s:.3} s after the expiry: {told:?}"),
            ));
        }
        let wanted = if bench.is_arc() {
            turn
        } else {
            told.linear * turn / v
        };
        let slack = turn_quantum + v_quantum * (turn / v).abs() + 1e-6;
        if !brakes && (told.turn - wanted).abs() > slack {
            return Err(fail(
                "DRIVE-05",
                format!("leaves its curvature at {s:.3} s: {told:?}"),
            ));
        }
        if !moves(told, bench.is_arc()) {
            rested = rested.or(Some(s));
        }
    }
    let Some(rest_s) = rested else {
        return Err(fail("DRIVE-05", "never said zero".to_owned()));
    };
    let truth = rig.robot.truth();
    if truth.twist[0].abs() > STANDS {
        return Err(fail("DRIVE-05", format!("still moves: {truth:?}")));
    }
    Ok(rest_s)
}

/// What happens in the middle of a motion.
type Incident = fn(&mut Rig, &dyn Bench);

pub(super) fn zero_first(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let incidents: [(&str, Incident); 8] = [
        ("link cut both ways", |rig, bench| {
            cut(rig, bench, true, true)
        }),
        ("link cut to the host", |rig, bench| {
            cut(rig, bench, false, true)
        }),
        ("host paused", |rig, bench| {
            rig.pause(bench.watchdog().plus(Duration::from_ms(500)));
        }),
        ("reconnected", |rig, _| rig.drive.reconnected(rig.now)),
        ("another host takes over", |rig, bench| {
            // The one before left its set point behind; its robot has stopped by itself.
            rig.pause(bench.watchdog().plus(Duration::from_ms(3000)));
            rig.drive = bench.drive(rig.now);
        }),
        ("robot restarted", |rig, _| rig.robot.reboot(rig.now)),
        ("bumped", |rig, _| {
            rig.robot.bump(true);
            rig.idle(Duration::from_ms(60));
            rig.robot.bump(false);
        }),
        ("stop button", |rig, _| {
            rig.robot.press_stop(true);
            rig.idle(Duration::from_ms(60));
            rig.robot.press_stop(false);
        }),
    ];
    let mut kinds = 0;
    for (name, incident) in incidents {
        if matches!(name, "bumped" | "stop button") && bench.is_arc() {
            continue; // the car has neither
        }
        kinds += 1;
        let mut rig = Rig::new(bench, twin);
        let (v, turn) = started(&mut rig, bench)?;
        incident(&mut rig, bench);
        after(&mut rig, bench, name, v, turn)?;
    }
    Ok(format!(
        "{kinds} kinds of interruption: zero first, motion only after a decision for rest"
    ))
}

fn cut(rig: &mut Rig, bench: &dyn Bench, robot: bool, host: bool) {
    let (v, turn) = cruising(bench);
    (rig.to_robot, rig.to_host) = (!robot, !host);
    rig.decide(v, turn, bench.watchdog().plus(Duration::from_ms(500)));
    (rig.to_robot, rig.to_host) = (true, true);
}

/// The planner insists; nothing but zero may be said until it asks for rest.
fn after(rig: &mut Rig, bench: &dyn Bench, name: &str, v: f64, turn: f64) -> Result<(), Failure> {
    // Until a restart shows, set points go to a robot that does not obey them.
    let grace = if name == "robot restarted" {
        bench.notices_restart()
    } else {
        Duration::ZERO
    };
    let since = rig.now.plus(grace);
    let speed = rig.robot.truth().twist[0];
    for _ in 0..300 {
        rig.drive.enable(rig.now);
        rig.decide(v, turn, Duration::from_ms(10));
        let now = rig.robot.truth().twist[0];
        if now > speed + SPEEDS_UP {
            return Err(fail(
                "DRIVE-02",
                format!("{name}: speeds up from {speed} to {now}"),
            ));
        }
    }
    if let Some(told) = rig
        .told_since(since)
        .find(|told| moves(told, bench.is_arc()))
    {
        return Err(fail("DRIVE-02", format!("{name}: {told:?}")));
    }
    // And it is no dead end.
    if !rig.start() {
        return Err(fail("DRIVE-03", format!("{name}: never drives again")));
    }
    rig.decide(v, turn, Duration::from_ms(500));
    if rig.robot.truth().twist[0] < 0.05 {
        return Err(fail("DRIVE-03", format!("{name}: does not drive again")));
    }
    Ok(())
}
