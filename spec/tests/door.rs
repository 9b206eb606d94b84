//! Rules that show at the kernel's door: one robot in a room, ticks and decisions, nothing inside.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

#[path = "../../kernel/tests/common/mod.rs"]
mod room;

use haltline::config::{Config, HostDeath, MaskRect};
use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::{Beam, Inputs, Motion, Reading};
use haltline::time::{Duration, Instant};
use haltline::units::{Acceleration, AngularAcceleration, Length, Speed};
use room::{Robot, Room, config, m};

fn speed(decision: &Decision) -> i32 {
    match decision.setpoint {
        Motion::Twist(twist) => twist.linear.as_um_per_s(),
        other => panic!("a differential drive gets twists: {other:?}"),
    }
}

/// Drives for a while and then sees one beam straight ahead as `seen`.
fn ahead(config: Config<1>, seen: Beam) -> Decision {
    let mut room = Room::new((-3.0, 6.0), (-2.0, 2.0), config);
    let _ = room.start();
    let driving = room.tick(Some((0.3, 0.0)), false);
    assert_eq!(driving.action, Action::Pass, "{driving:?}");
    let mut beams = room.beams();
    beams[270] = seen;
    room.told(&beams, 20_000, Some((0.3, 0.0)), false)
}

/// Only what lies in the mask is the robot itself.
//= spec/zone.md#zone-03
//= type=test
//# A return MUST NOT be dropped as a part of the robot unless it lies in a self-mask of the scanner that saw it.
#[test]
fn a_return_is_part_of_the_robot_only_inside_a_mask() {
    let masked = |y_min: f64, y_max: f64| {
        let mut config = config();
        config.scanners[0].as_mut().unwrap().masks[0] = Some(MaskRect {
            x_min: m(0.55),
            x_max: m(0.62),
            y_min: m(y_min),
            y_max: m(y_max),
        });
        // 80 mm before the scanner, 7 mm before the front edge: in the zone.
        ahead(config, Beam::Hit(80))
    };
    assert_eq!(masked(-0.03, 0.03).action, Action::Pass);
    for beside in [(0.01, 0.03), (-0.03, -0.01)] {
        assert_eq!(masked(beside.0, beside.1).reason, Reason::CriticalZone);
    }
    assert_eq!(ahead(config(), Beam::Hit(80)).reason, Reason::CriticalZone);
}

/// Too near is a return at the minimum range, 20 mm before the scanner.
//= spec/input.md#input-02
//= type=test
//# A too-near beam MUST count as a return at the minimum range of its scanner.
#[test]
fn a_too_near_beam_is_an_obstacle() {
    let decision = ahead(config(), Beam::TooNear);
    assert_eq!(decision.action, Action::ProtectiveStop, "{decision:?}");
    assert_eq!(decision.reason, Reason::CriticalZone);
    assert_eq!(ahead(config(), Beam::Hit(5_000)).action, Action::Pass);
}

/// What is too near may stand before the minimum range, even where that lies far beyond the zone.
#[test]
fn a_too_near_beam_stops_whatever_the_minimum_range() {
    let mut blind = config();
    blind.scanners[0].as_mut().unwrap().range_min = m(1.5);
    let decision = ahead(blind, Beam::TooNear);
    assert_eq!(decision.action, Action::ProtectiveStop, "{decision:?}");
    assert_eq!(decision.reason, Reason::CriticalZone);
    assert_eq!(ahead(blind, Beam::Hit(5_000)).action, Action::Pass);
}

/// A wall that appears brakes the robot in the same tick, the ramp ends at exactly
/// zero, and the verdict names the point.
//= spec/brake.md#brake-01
//= type=test
//# When no motion is accepted, the kernel MUST send a braking set point in the same tick.
//= spec/brake.md#brake-07
//= type=test
//# A braking manoeuvre that is not replaced by an accepted motion MUST end with a set point of exactly zero.
//= spec/guard.md#guard-20
//= type=test
//# Every verdict MUST carry the inflation of the deciding sample, term by term, and the point or cell that decided.
#[test]
fn what_cannot_be_certified_brakes_at_once_and_to_zero() {
    let mut room = Room::new((-3.0, 20.0), (-2.0, 2.0), config());
    let _ = room.start();
    let mut before = 0;
    for _ in 0..60 {
        before = speed(&room.tick(Some((0.8, 0.0)), false));
    }
    assert!(before > 500_000, "{before} um/s");
    // The braking path is 0.8^2 / (2 * 0.5) = 0.64 m.
    room.x.1 = room.pose[0] + 0.6 + 0.7;
    let wall_mm = (room.x.1 - room.pose[0]) * 1e3;
    let first = room.tick(Some((0.8, 0.0)), false);
    assert_eq!(first.action, Action::Brake, "{first:?}");
    assert_eq!(first.reason, Reason::GuardBlocked);
    let verdict = first.verdict.expect("a verdict");
    let point = verdict.point.expect("a point");
    assert!(
        (f64::from(point.x_mm) - wall_mm).abs() < 40.0,
        "{point:?}, wall at {wall_mm} mm"
    );
    let budget = verdict.budget;
    for term in [
        budget.sensor,
        budget.tracking,
        budget.sampling,
        budget.rounding,
        budget.spread,
    ] {
        assert!(term.as_um() > 0, "{budget:?}");
    }
    let mut last = speed(&first);
    assert!(last < before, "{last} um/s after {before} um/s");
    for _ in 0..80 {
        let decision = room.tick(None, false);
        assert!(speed(&decision) <= last, "{decision:?}");
        last = speed(&decision);
    }
    assert_eq!(last, 0);
    assert!(room.pose[0] + 0.6 < room.x.1, "touched at {:?}", room.pose);
}

/// A reset before the rest time is over does nothing.
//= spec/latch.md#latch-09
//= type=test
//# The robot MUST count as resting only after its measured twist has been within the rest tolerances for the whole
//# rest time.
#[test]
fn rest_is_the_whole_rest_time() {
    // A drive that reacts at once, so that LATCH-10 has nothing to say.
    let mut config = config();
    config.timing.actuation_latency = Duration::ZERO;
    let mut room = Room::new((-3.0, 20.0), (-2.0, 2.0), config);
    let _ = room.start();
    for _ in 0..20 {
        let _ = room.tick(Some((0.5, 0.0)), false);
    }
    let inputs = Inputs {
        emergency_stop: true,
        ..Inputs::default()
    };
    assert_eq!(room.step(&inputs).status, StopStatus::Latched);
    let (mut resting, mut moved) = (0, 0);
    for _ in 0..200 {
        let rests = room.twist == [0.0, 0.0];
        let decision = room.tick(None, true);
        (resting, moved) = if rests {
            (resting + 1, moved)
        } else {
            (0, moved + 1)
        };
        if decision.status != StopStatus::Latched {
            break;
        }
    }
    assert!(moved > 5, "the robot was not moving");
    // 200 ms of rest at 40 ms a tick: the sixth sample at rest closes the fifth span.
    assert_eq!(resting, 6);
}

/// The emergency stop comes while a motion is on its way to a drive that still shows rest.
//= spec/latch.md#latch-10
//= type=test
//# The robot MUST NOT count as resting until nothing but standstill has been sent for the actuation latency and the
//# rest time.
#[test]
fn what_is_on_its_way_is_no_rest() {
    let mut room = Room::new((-3.0, 20.0), (-2.0, 2.0), config());
    let _ = room.start();
    for _ in 0..20 {
        let _ = room.tick(None, false);
    }
    assert!(speed(&room.tick(Some((0.5, 0.0)), false)) > 0);
    // The drive is late: nothing has moved yet.
    (room.pose, room.twist) = ([0.0; 3], [0.0; 2]);
    let odometry = Reading::Value(room.odometry());
    let inputs = Inputs {
        emergency_stop: true,
        odometry,
        ..Inputs::default()
    };
    let stopped = room.step(&inputs);
    assert_eq!((stopped.status, speed(&stopped)), (StopStatus::Latched, 0));
    let released = (1..50).find(|_| room.tick(None, true).status != StopStatus::Latched);
    // 100 ms of latency and 200 ms of rest at 40 ms a tick.
    assert_eq!(released, Some(8));
}

/// A drive that does not follow stops the robot when the tracking window is over.
//= spec/input.md#input-13
//= type=test
//# The kernel MUST stop when the measured twist has left the hull of the recent set points by more than the follow
//# tolerances for the tracking window.
#[test]
fn a_drive_that_does_not_follow_is_noticed() {
    let mut room = Room::new((-3.0, 20.0), (-2.0, 2.0), config());
    let _ = room.start();
    let mut noticed = None;
    for tick in 0..60 {
        let decision = room.tick(Some((0.8, 0.0)), false);
        room.twist = [0.0, 0.0];
        room.pose = [0.0; 3];
        if decision.reason == Reason::DriveMismatch {
            assert_eq!(decision.action, Action::ProtectiveStop);
            noticed = Some(tick);
            break;
        }
    }
    let tick = noticed.expect("never noticed");
    // The set point passes the follow tolerance at 0.15 m/s, in the eighth tick; window and latency are 0.5 s.
    assert!((12..=30).contains(&tick), "noticed in tick {tick}");
}

fn host_death(braking_um_per_s2: u32) -> HostDeath {
    HostDeath {
        watchdog: Duration::from_ms(100),
        braking: Acceleration::from_um_per_s2(braking_um_per_s2),
        angular_braking: AngularAcceleration::from_urad_per_s2(1_000_000),
    }
}

/// What cannot be is refused before the first tick.
//= spec/input.md#input-14
//= type=test
//# A configuration that contains an impossible combination MUST be refused before the first tick.
#[test]
fn impossible_configurations_are_refused() {
    type Change = fn(&mut Config<1>);
    let impossible: [(&str, Change); 10] = [
        ("no brake", |c| {
            c.limits.braking = Acceleration::from_um_per_s2(0)
        }),
        ("no period", |c| c.timing.period = Duration::ZERO),
        ("no body", |c| c.footprint.front = Length::from_mm(-700)),
        ("no beams", |c| c.scanners[0].as_mut().unwrap().beams = 0),
        ("more beams than the kernel holds", |c| {
            c.scanners[0].as_mut().unwrap().beams = 600;
        }),
        ("ranges upside down", |c| {
            c.scanners[0].as_mut().unwrap().range_max = Length::from_mm(10);
        }),
        ("a negative speed limit", |c| {
            c.limits.speed_forward = Speed::from_um_per_s(-1);
        }),
        ("no scanner", |c| c.scanners[0] = None),
        ("no brake on a turn", |c| {
            c.limits.angular_braking = AngularAcceleration::from_urad_per_s2(0);
        }),
        ("a silent drive that coasts for ever", |c| {
            c.host_death = Some(host_death(0));
        }),
    ];
    assert!(Robot::new(config()).is_ok());
    let mut covered = config();
    covered.host_death = Some(host_death(500_000));
    assert!(Robot::new(covered).is_ok());
    for (what, change) in impossible {
        let mut changed = config();
        change(&mut changed);
        assert!(Robot::new(changed).is_err(), "{what} was accepted");
    }
}

/// The compiler refuses unsafe code in the kernel.
//= spec/time.md#time-03
//= type=test
//# The kernel MUST contain no unsafe code.
#[test]
fn the_kernel_forbids_unsafe_code() {
    let workspace = include_str!("../../Cargo.toml");
    assert!(
        workspace
            .lines()
            .any(|line| line == "unsafe_code = \"forbid\"")
    );
    let kernel = include_str!("../../kernel/Cargo.toml");
    let lints = kernel.split("[lints").nth(1).unwrap();
    assert!(
        lints.starts_with("]\nworkspace = true") || lints.contains("unsafe_code = \"forbid\""),
        "{lints}"
    );
}

/// Top speed in an empty world whose beams never return, and the points that limited it.
fn into_the_open(clear_m: f64) -> (f64, Vec<i16>) {
    let mut config = config();
    config.scanners[0].as_mut().unwrap().no_return_clear = m(clear_m);
    let mut room = Room::new((-3.0, 20.0), (-2.0, 2.0), config);
    let (mut top, mut points) = (0.0_f64, Vec::new());
    for tick in 0..120 {
        let decision = room.told(&[Beam::NoReturn; 541], 20_000, Some((1.2, 0.0)), tick == 10);
        top = top.max(f64::from(speed(&decision)) * 1e-6);
        let verdict = decision.verdict.filter(|verdict| verdict.refusal.is_some());
        points.extend(
            verdict
                .and_then(|verdict| verdict.point)
                .map(|point| point.x_mm),
        );
    }
    (top, points)
}

/// Without returns the robot goes no faster than it can stop in what they clear.
//= spec/input.md#input-04
//= type=test
//# A no-return beam MUST NOT make space known beyond the `no_return_clear` distance of its scanner.
#[test]
fn silence_of_the_scanner_clears_no_more_than_stated() {
    let (near, points) = into_the_open(1.5);
    let (far, _) = into_the_open(4.0);
    // Latency, one period and braking, from the front edge 73 mm before the scanner.
    let path = near * 0.14 + near * near / (2.0 * 0.5);
    assert!(path <= 1.5 - 0.073, "{near} m/s needs {path} m");
    assert!(near > 0.1 && far > near, "{near} m/s, then {far} m/s");
    assert!(
        !points.is_empty() && points.iter().all(|x| (400..3_000).contains(x)),
        "{points:?}"
    );
}

//= spec/guard.md#guard-21
//= type=test
//# Every rounding in the computation of a tube MUST enlarge the tube or be covered by the rounding term of its budget.
#[test]
fn ranges_are_kept_to_the_nearest_millimetre() {
    use haltline::convert::{BeamEncoding, beam};
    // The budget has half a millimetre for it.
    for tenths in 200..190_000_u32 {
        let range = f64::from(tenths) * 1e-4;
        let found = beam(range as f32, BeamEncoding::Rep117, m(0.02), m(20.0));
        let Beam::Hit(mm) = found else {
            panic!("{range} m: {found:?}");
        };
        assert!(
            (f64::from(mm) - range * 1e3).abs() <= 0.503,
            "{range} m: {mm}"
        );
    }
}

//= spec/guard.md#guard-16
//= type=test
//# Every beam MUST be moved from the robot's pose at its own beam time to the start pose of the tube, its odometry error
//# over that interval being part of its inflation.
#[test]
fn the_track_knows_where_the_robot_was_at_every_moment_it_covers() {
    let mut track = haltline::odometry::Track::default();
    for step in 0..100_u64 {
        let at = |t: u64| i64::try_from(t * t).unwrap();
        let mut sample = haltline::input::Odometry {
            stamp: Instant::from_us(1_000 * step),
            ..Default::default()
        };
        sample.pose.x_um = at(step) * 10;
        let _ = track.push(sample);
        for back in 1..step.min(30) {
            let then = track
                .pose_at(Instant::from_us(1_000 * (step - back) + 500))
                .unwrap();
            let middle = i64::midpoint(at(step - back), at(step - back + 1)) * 10;
            assert!((i64::from(then.x_um) - middle).abs() <= 10, "{step} {back}");
        }
    }
}
