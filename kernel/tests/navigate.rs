//! The navigator through its door: it drives to goals in a room, stops where nothing leads on, and says why.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation
)]

mod common;

use common::{Room, config, m};
use haltline::Navigator;
use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::{Inputs, Motion, Pose, Reading, Scan};
use haltline::kernel::navigate::{
    Blocked, Destination, Localiser, Navigation, Obstruction, Planning, Progress, ProgressRules,
    Route, VIA_MAX, Via,
};
use haltline::marker::{
    FilterRules, Frame, Health, MarkerEkf, MarkerFilter, Pose2, Prediction, Sighting, SightingNoise,
};
use haltline::time::{Duration, Instant};
use haltline::units::BinaryAngle;

type Pilot = Navigator<1, 541, 1024>;

struct Drive {
    room: Room,
    pilot: Box<Pilot>,
    refused: u32,
}

fn um(metres: f64) -> i64 {
    (metres * 1e6).round() as i64
}

fn goal(x: f64, y: f64) -> Destination {
    Destination {
        x_um: um(x),
        y_um: um(y),
        tolerance: m(0.15),
        heading: None,
        heading_tolerance: 0,
    }
}

fn via(x: f64, y: f64) -> Via {
    Via {
        x_um: um(x),
        y_um: um(y),
        tolerance: m(0.2),
    }
}

fn order(stamp: Instant, via: &[Via], goal: Destination) -> Route<'_> {
    Route {
        stamp,
        id: 1,
        via,
        goal,
        ..Route::default()
    }
}

impl Drive {
    /// In a room of 20 m x 8 m, released and at rest.
    fn new() -> Self {
        Self::with(Planning::default())
    }

    fn with(planning: Planning) -> Self {
        let mut drive = Self {
            room: Room::new((-3.0, 17.0), (-4.0, 4.0), config()),
            pilot: Box::new(Pilot::new(config(), planning).unwrap()),
            refused: 0,
        };
        for _ in 0..10 {
            let _ = drive.tick(None, false);
        }
        let decision = drive.tick(None, true).decision;
        assert_eq!(decision.status, StopStatus::Running, "{decision:?}");
        drive
    }

    fn tick(&mut self, route: Option<&Route<'_>>, reset: bool) -> Navigation {
        let beams = self.room.beams();
        let scans = [Reading::Value(Scan {
            scanner: 0,
            stamp: Instant::from_us(self.room.now_us - 20_000),
            beams: &beams,
        })];
        let inputs = Inputs {
            scans: &scans,
            odometry: Reading::Value(self.room.odometry()),
            reset: reset.then(|| self.room.now()),
            ..Inputs::default()
        };
        self.step(&inputs, route)
    }

    fn step(&mut self, inputs: &Inputs<'_>, route: Option<&Route<'_>>) -> Navigation {
        let answer = self.pilot.step(inputs, route, self.room.now());
        let Motion::Twist(twist) = answer.decision.setpoint else {
            panic!("a differential drive gets twists");
        };
        self.refused += u32::from(answer.refused);
        self.room.execute(twist);
        answer
    }

    /// Follows `route` until it arrives or has stood for two seconds.
    fn follow(&mut self, route: &Route<'_>) -> Navigation {
        let mut standing = 0;
        for _ in 0..3_000 {
            let answer = self.tick(Some(route), false);
            standing = if self.room.twist == [0.0, 0.0] {
                standing + 1
            } else {
                0
            };
            if standing > 50 {
                return answer;
            }
        }
        panic!("still moving after 3000 ticks at {:?}", self.room.pose);
    }
}

fn set_point(decision: &Decision) -> (i32, i32) {
    match decision.setpoint {
        Motion::Twist(twist) => (twist.linear.as_um_per_s(), twist.angular.as_urad_per_s()),
        Motion::Arc { .. } => panic!("a differential drive gets twists"),
    }
}

//= spec/navigate.md#nav-09
//= type=test
//# Via points MUST be passed in their order, all of them before the destination counts as reached.
#[test]
fn drives_through_via_points_and_turns_to_its_heading() {
    let mut drive = Drive::new();
    let stamp = drive.room.now();
    let mut end = goal(8.0, -1.0);
    end.heading = Some(BinaryAngle::from_counts(1 << 30));
    end.heading_tolerance = 1 << 26;
    let via = [via(3.0, 1.5), via(5.0, -1.0)];
    let answer = drive.follow(&order(stamp, &via, end));
    assert_eq!(answer.progress, Progress::Arrived, "{:?}", drive.room.pose);
    let [x, y, heading] = drive.room.pose;
    assert!((x - 8.0).hypot(y + 1.0) < 0.16, "{x} {y}");
    assert!((heading.to_degrees() - 90.0).abs() < 6.0, "{heading}");
    assert_eq!(
        drive.refused, 0,
        "the guard refuses nothing in an empty room"
    );
}

//= spec/navigate.md#nav-10
//= type=test
//# While nothing leads on, the navigator MUST report why, the point that decided if one did, and since when.
#[test]
fn a_goal_behind_the_wall_is_blocked_with_point_and_time() {
    let mut drive = Drive::new();
    let began = drive.room.now();
    let answer = drive.follow(&order(began, &[], goal(20.0, 0.0)));
    // The planner finds no way, or the guard refuses what it finds: before a wall both happen.
    let Progress::Blocked(Blocked {
        reason: Obstruction::NoWay | Obstruction::Guard(_),
        point: Some(point),
        since,
    }) = answer.progress
    else {
        panic!("{answer:?}")
    };
    let [x, _, heading] = drive.room.pose;
    let (sin, cos) = heading.sin_cos();
    let ahead = x + (cos * f64::from(point.x_mm) - sin * f64::from(point.y_mm)) * 1e-3;
    assert!(
        (ahead - 17.0).abs() < 0.05,
        "the point lies on the wall: {ahead}"
    );
    assert!(since > began && since < drive.room.now(), "{since:?}");
    assert!(
        drive.room.pose[0] > 14.5 && drive.room.pose[0] < 16.4,
        "{:?}",
        drive.room.pose
    );
    assert!(matches!(
        answer.decision.reason,
        Reason::PathBlocked | Reason::GuardBlocked
    ));
}

#[test]
fn a_goal_in_the_wall_is_reported_as_occupied() {
    let mut drive = Drive::new();
    let stamp = drive.room.now();
    let answer = drive.follow(&order(stamp, &[], goal(17.0, 0.0)));
    let Progress::Blocked(blocked) = answer.progress else {
        panic!("{answer:?}")
    };
    assert_eq!(blocked.reason, Obstruction::GoalOccupied);
}

#[test]
fn without_a_route_it_is_a_shield() {
    let mut drive = Drive::new();
    let command = drive.room.command(0.3, 0.0);
    let inputs = Inputs {
        odometry: Reading::Value(drive.room.odometry()),
        command,
        ..Inputs::default()
    };
    let answer = drive.step(&inputs, None);
    assert_eq!(answer.progress, Progress::Idle);
    assert_eq!(answer.decision.action, Action::Pass);
    assert!(set_point(&answer.decision).0 > 0);
    let silent = drive.tick(None, false);
    assert_eq!(
        silent.decision.reason,
        Reason::None,
        "the command is not stale yet"
    );
}

//= spec/navigate.md#nav-06
//= type=test
//# A tick without a route MUST NOT follow the route of an earlier tick.
#[test]
fn a_route_that_is_held_back_stops_the_robot() {
    let mut drive = Drive::new();
    let stamp = drive.room.now();
    let route = order(stamp, &[], goal(8.0, 0.0));
    for _ in 0..20 {
        let _ = drive.tick(Some(&route), false);
    }
    assert!(drive.room.twist[0] > 0.2);
    let answer = drive.tick(None, false);
    assert_eq!(answer.decision.action, Action::Brake);
    assert_eq!(answer.decision.reason, Reason::CommandMissing);
}

//= spec/navigate.md#nav-08
//= type=test
//# A route together with a command in one tick MUST stop the robot.
#[test]
fn a_route_and_a_command_contradict_each_other() {
    let mut drive = Drive::new();
    let route = order(drive.room.now(), &[], goal(8.0, 0.0));
    let inputs = Inputs {
        odometry: Reading::Value(drive.room.odometry()),
        command: drive.room.command(0.3, 0.0),
        ..Inputs::default()
    };
    let answer = drive.step(&inputs, Some(&route));
    assert_eq!(answer.decision.action, Action::Brake);
    assert_eq!(answer.decision.reason, Reason::CommandMalformed);
    assert_eq!(answer.progress, Progress::Held);
}

#[test]
fn impossible_and_future_routes_are_refused() {
    let mut drive = Drive::new();
    let now = drive.room.now();
    let mut end = goal(8.0, 0.0);
    end.tolerance = m(0.0);
    let answer = drive.tick(Some(&order(now, &[], end)), false);
    assert_eq!(answer.decision.reason, Reason::CommandMalformed);
    let later = now.plus(Duration::from_ms(10_000));
    let answer = drive.tick(Some(&order(later, &[], goal(8.0, 0.0))), false);
    assert_eq!(answer.decision.reason, Reason::CommandFuture);
}

//= spec/navigate.md#nav-07
//= type=test
//# A route ordered before or at the last release of a latched stop MUST NOT be followed.
#[test]
fn an_emergency_stop_voids_the_route_and_a_protective_stop_does_not() {
    let mut drive = Drive::new();
    let stamp = drive.room.now();
    let route = order(stamp, &[], goal(12.0, 0.0));
    for _ in 0..20 {
        let _ = drive.tick(Some(&route), false);
    }
    // Half a second without scans: a protective stop, then the way goes on.
    for _ in 0..15 {
        let inputs = Inputs {
            odometry: Reading::Value(drive.room.odometry()),
            ..Inputs::default()
        };
        let _ = drive.step(&inputs, Some(&route));
    }
    let held = drive.tick(Some(&route), false);
    assert_eq!(held.decision.status, StopStatus::Protective);
    assert_eq!(held.progress, Progress::Held);
    for _ in 0..60 {
        let _ = drive.tick(Some(&route), false);
    }
    assert!(drive.room.twist[0] > 0.1, "released by rule");
    let inputs = Inputs {
        odometry: Reading::Value(drive.room.odometry()),
        emergency_stop: true,
        ..Inputs::default()
    };
    let _ = drive.step(&inputs, Some(&route));
    for _ in 0..60 {
        let _ = drive.tick(Some(&route), false);
    }
    let _ = drive.tick(Some(&route), true);
    let old = drive.tick(Some(&route), false);
    assert_eq!(old.decision.status, StopStatus::Running);
    assert_eq!(old.decision.reason, Reason::CommandMissing, "an old order");
    let fresh = order(drive.room.now(), &[], goal(12.0, 0.0));
    let answer = drive.tick(Some(&fresh), false);
    assert!(set_point(&answer.decision).0 > 0, "{answer:?}");
}

//= spec/navigate.md#nav-11
//= type=test
//# A robot that moves for the given time without coming nearer to its next target MUST stop until it gets another route.
#[test]
fn moving_without_coming_nearer_ends_the_route_until_another() {
    // Coming nearer by less than 100 m does not count here, so any way gives up.
    let planning = Planning {
        progress: ProgressRules {
            distance_m: 100.0,
            time: Duration::from_ms(2_000),
        },
        ..Planning::default()
    };
    let mut drive = Drive::with(planning);
    let stamp = drive.room.now();
    let mut route = order(stamp, &[], goal(12.0, 0.0));
    let answer = drive.follow(&route);
    let Progress::Blocked(blocked) = answer.progress else {
        panic!("{answer:?}")
    };
    assert_eq!(blocked.reason, Obstruction::NoProgress);
    assert!(drive.room.pose[0] < 3.0);
    route.id = 2;
    let answer = drive.tick(Some(&route), false);
    assert!(
        set_point(&answer.decision).0 > 0,
        "another route starts afresh"
    );
}

#[test]
fn a_route_with_too_many_via_points_is_refused_whole() {
    let mut drive = Drive::new();
    let ordered = drive.room.now();
    let vias = vec![via(2.0, 0.0); VIA_MAX + 1];
    let long = order(ordered, &vias, goal(3.0, 0.0));
    let answer = drive.tick(Some(&long), false);
    assert_eq!(answer.decision.reason, Reason::CommandMalformed);
    let longest = order(ordered, &vias[1..], goal(3.0, 0.0));
    let answer = drive.tick(Some(&longest), false);
    assert_ne!(answer.decision.reason, Reason::CommandMalformed);
}

#[test]
fn planning_that_makes_no_sense_is_refused() {
    let mut planning = Planning::default();
    planning.tuning.comfort = f64::NAN;
    assert!(Pilot::new(config(), planning).is_err());
    planning = Planning::default();
    planning.progress.time = Duration::ZERO;
    assert!(Pilot::new(config(), planning).is_err());
}

/// A quarter turn to the left, counts of 2^-32 turn.
const QUARTER: u32 = 1 << 30;

//= spec/navigate.md#nav-13
//= type=test
//# A route MUST be followed at the robot's pose in the frame of the route.
#[test]
fn a_route_in_a_map_leads_to_the_same_place() {
    let mut plain = Drive::new();
    let points = [via(2.0, 0.5)];
    let here = order(plain.room.now(), &points, goal(4.0, -0.5));
    let _ = plain.follow(&here);
    // The odometry frame lies at (10, -3) in the map, turned left: (x, y) is (10 - y, -3 + x) there.
    let mut mapped = Drive::new();
    let points = [via(9.5, -1.0)];
    let there = Route {
        odometry_frame: Pose {
            x_um: um(10.0),
            y_um: um(-3.0),
            heading: BinaryAngle::from_counts(QUARTER),
        },
        ..order(mapped.room.now(), &points, goal(10.5, 1.0))
    };
    let answer = mapped.follow(&there);
    assert_eq!(answer.progress, Progress::Arrived);
    let off = |axis: usize| (plain.room.pose[axis] - mapped.room.pose[axis]).abs();
    assert!(off(0) < 0.01 && off(1) < 0.01, "{:?}", mapped.room.pose);
    assert!(
        (mapped.room.pose[0] - 4.0).abs() < 0.2,
        "{:?}",
        mapped.room.pose
    );
}

fn localiser() -> Localiser<MarkerEkf<4, 24>> {
    let start = Pose2::new(1.0, 2.0, 0.5);
    let mut filter = MarkerEkf::new(FilterRules::default(), start, [1e-4, 1e-4, 1e-5]).unwrap();
    filter.add_mapped(3, Pose2::new(4.0, 2.0, 3.0)).unwrap();
    Localiser::new(filter)
}

//= spec/navigate.md#nav-14
//= type=test
//# While the filter is lost, or has not taken the newest odometry, the localiser MUST NOT give a frame.
#[test]
fn a_lost_or_late_filter_gives_no_frame() {
    let mut localiser = localiser();
    let room = Room::new((-3.0, 17.0), (-4.0, 4.0), config());
    let mut sample = room.odometry();
    assert_eq!(
        localiser.odometry_frame(sample.stamp),
        None,
        "no odometry yet"
    );
    assert_eq!(localiser.odometry(&sample), Prediction::Done);
    let frame = localiser.odometry_frame(sample.stamp).unwrap();
    assert_eq!((frame.x_um, frame.y_um), (um(1.0), um(2.0)));
    let later = sample.stamp.plus(Duration::from_ms(40));
    assert_eq!(
        localiser.odometry_frame(later),
        None,
        "odometry it has not seen"
    );
    // A jump that no robot makes is refused, and so is everything after it.
    sample.stamp = later;
    sample.pose.x_um += um(500.0);
    assert_eq!(localiser.odometry(&sample), Prediction::Malformed);
    assert_eq!(localiser.odometry_frame(later), None);
    sample.pose.x_um -= um(500.0);
    let mut found = Health::Tracking;
    for tick in 1..60_u64 {
        sample.stamp = later.plus(Duration::from_ms(40 * tick));
        assert_eq!(localiser.odometry(&sample), Prediction::Done);
        let given = localiser.odometry_frame(sample.stamp);
        assert_eq!(given.is_some(), found == Health::Tracking, "tick {tick}");
        // The known marker where it cannot be, and each time elsewhere.
        let off = tick as f64 * 0.05;
        let seen = Pose2::new(1.0 + off, -2.0 + 2.0 * off, -1.0 + off);
        let noise = SightingNoise::isotropic(0.02, 0.02);
        let sightings = [Sighting::pose(3, seen, noise)];
        let _ = localiser.frame(&Frame {
            camera: 0,
            stamp: sample.stamp,
            sightings: &sightings,
        });
        found = localiser.filter().health();
    }
    assert_ne!(found, Health::Tracking, "it must get lost");
}

//= spec/navigate.md#nav-01
//= type=test
//# Every set point of the navigator that is not a braking one MUST be certified by the guard in the same tick.
//= spec/navigate.md#nav-05
//= type=test
//# When the guard refuses a candidate, the next ones MUST be tried in their order, at most eight in all, and the robot brakes when none is left.
#[test]
fn the_guard_decides_on_every_candidate() {
    let (mut certified, mut after_refusal, mut none_left) = (0, 0, 0);
    for (x, y) in [(20.0, 0.0), (16.0, 6.0), (-6.0, 1.0), (8.0, -3.4)] {
        let mut drive = Drive::new();
        let stamp = drive.room.now();
        let mut before = (0_i32, 0_i32);
        for _ in 0..600 {
            let answer = drive.tick(Some(&order(stamp, &[], goal(x, y))), false);
            let decision = &answer.decision;
            let set = set_point(decision);
            assert!(answer.refused <= 8, "{answer:?}");
            match decision.verdict {
                Some(verdict) if verdict.refusal.is_none() => {
                    certified += 1;
                    after_refusal += usize::from(answer.refused > 0);
                }
                // Refused, or nothing was asked for: a braking set point.
                other => {
                    assert!(set.0.abs() <= before.0.abs() && set.1.abs() <= before.1.abs());
                    assert!(decision.action >= Action::Brake || answer.refused == 0);
                    none_left += usize::from(other.is_some());
                }
            }
            before = set;
        }
    }
    println!("{certified} certified, {after_refusal} after a refusal, {none_left} with none left");
    assert!(certified > 500 && after_refusal > 0 && none_left > 0);
}
