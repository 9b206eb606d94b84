//! Swept outlines against poses that are looked at one by one.

use crate::room::{Room, config};
use crate::{driving, speed, with_beams};
use haltline::decision::{Action, Reason};
use haltline::input::Beam;

const FRONT: f64 = 0.6;
const SIDE: f64 = 0.42;

/// #740, #5329: footprints are checked along their outline, so a cell of 50 mm inside vanishes.
#[test]
fn a_return_inside_the_footprint_stops() {
    // 0.2 m behind the scanner on the right: beam 0 looks to -135 degrees.
    let point: [f64; 2] = [0.527 - 0.141, -0.141];
    let outline = (FRONT - point[0].abs()).min(SIDE - point[1].abs());
    assert!(outline > 0.05, "no cell of the outline holds it");
    let mut room = driving(0.5);
    let mut beams = room.beams();
    beams[0] = Beam::Hit(200);
    let decision = with_beams(&mut room, &beams, 0.5);
    assert_eq!(decision.reason, Reason::CriticalZone, "{decision:?}");
}

/// #4355: the projection left out time zero: what touches already was not seen.
#[test]
fn what_stands_before_the_bumper_now_stops() {
    let mut room = driving(0.5);
    let mut beams = room.beams();
    beams[270] = Beam::Hit(80);
    let decision = with_beams(&mut room, &beams, 0.5);
    assert_eq!(decision.reason, Reason::CriticalZone, "{decision:?}");
}

/// #3171: pure rotation was not projected.
#[test]
fn turning_on_the_spot_between_walls_is_refused() {
    let wall = 0.55;
    assert!(FRONT.hypot(SIDE) > wall, "the corners do not fit past");
    let mut room = Room::new((-3.0, 6.0), (-wall, wall), config());
    let _ = room.start();
    for _ in 0..100 {
        let _ = room.tick(Some((0.0, 0.8)), false);
        let (sin, cos) = room.pose[2].sin_cos();
        let farthest = FRONT * sin.abs() + SIDE * cos.abs();
        assert!(farthest < wall, "a corner is at {farthest} m");
    }
    // The naive robot would have turned by this much.
    let naive: f64 = 0.8 * 100.0 * 0.04;
    assert!(naive > 1.0 && room.pose[2].abs() < 0.3);
}

/// Approach mode projects the commanded speed, not the measured one, and has no braking model.
#[test]
fn the_measured_speed_counts() {
    let mut room = driving(0.8);
    room.x.1 = room.pose[0] + FRONT + 0.5;
    let (commanded, measured, braking, gap_m): (f64, f64, f64, f64) = (0.05, 0.8, 0.5, 0.5);
    assert!(
        commanded * 1.2 < gap_m,
        "1.2 s at the commanded speed end before the wall"
    );
    assert!(
        measured * measured / (2.0 * braking) > gap_m,
        "braking does not"
    );
    let decision = room.tick(Some((0.05, 0.0)), false);
    assert!(decision.action >= Action::Brake, "{decision:?}");
}

/// #6273, #3313 ask for zones that grow with the measured speed.
#[test]
fn the_distance_kept_grows_with_the_speed() {
    let kept = |v: f64| {
        let mut room = driving(v);
        room.x.1 = room.pose[0] + FRONT + 4.0;
        loop {
            let clearance = room.x.1 - room.pose[0] - FRONT;
            assert!(clearance > 0.0, "touched at {v} m/s");
            let decision = room.tick(Some((v, 0.0)), false);
            if speed(&decision) < v - 0.02 {
                return clearance;
            }
        }
    };
    let (slow, fast) = (kept(0.3), kept(0.9));
    // Braking paths are 0.09 m and 0.81 m.
    assert!(fast - slow > 0.81 - 0.09, "{slow} {fast}");
}

/// Whether the footprint holds a point when the robot has driven `turned` along a left arc of radius 1 m.
fn holds(turned: f64, point: [f64; 2]) -> bool {
    let (sin, cos) = turned.sin_cos();
    let [dx, dy] = [point[0] - sin, point[1] - (1.0 - cos)];
    let [x, y] = [dx * cos + dy * sin, dy * cos - dx * sin];
    x.abs() <= FRONT && y.abs() <= SIDE
}

/// #570: poses 0.5 m apart clip the corners between them.
#[test]
fn a_pole_between_two_sampled_poses_is_seen() {
    // The outer front corner runs on a circle around (0, 1); the pole stands 0.12 rad along it.
    let bearing = f64::atan2(-1.0 - SIDE, FRONT) + 0.12;
    let pole = [1.52 * bearing.cos(), 1.0 + 1.52 * bearing.sin()];
    let coarse = (0..4).any(|step| holds(0.5 * f64::from(step), pole));
    let fine = (0..2_000).any(|step| holds(0.001 * f64::from(step), pole));
    assert!(
        !coarse && fine,
        "poses 0.5 m apart miss it, the sweep does not"
    );
    let mut room = Room::new((-9.0, 9.0), (-9.0, 9.0), config());
    let _ = room.start();
    for _ in 0..60 {
        let decision = room.tick(Some((0.4, 0.4)), false);
        assert_eq!(decision.action, Action::Pass, "{decision:?}");
    }
    let mut beams = room.beams();
    let seen = [pole[0] - 0.527, pole[1]];
    let beam = (seen[1].atan2(seen[0]).to_degrees() + 135.0) * 2.0;
    beams[beam.round() as usize] = Beam::Hit((seen[0].hypot(seen[1]) * 1e3) as u16);
    let stamp = haltline::time::Instant::from_us(room.now_us - 20_000);
    let scans = [haltline::input::Reading::Value(haltline::input::Scan {
        scanner: 0,
        stamp,
        beams: &beams,
    })];
    let inputs = haltline::input::Inputs {
        scans: &scans,
        odometry: haltline::input::Reading::Value(room.odometry()),
        command: room.command(0.4, 0.4),
        ..haltline::input::Inputs::default()
    };
    let decision = room.step(&inputs);
    assert!(decision.action >= Action::Slow, "{decision:?}");
}
