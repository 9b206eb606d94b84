//! What kernel and guard object to at one moment.

use super::drive::{Moment, rests};
use super::shadow::{Judged, Shadow, in_world};
use crate::picture::view::transform;
use crate::report::words;
use haltline::convert::{self, Round};
use haltline::decision::{Action, Decision, Reason};
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::{Scene, Verdict, certify};
use haltline::input::Twist;
use haltline::time::Duration;
use haltline::units::Curvature;
use haltline::window::FACTORS_PERMILLE;
use haltline_robots::Robot;
/// What the stop logic objects to in this tick.
///
/// That the drive does not follow, and that an earlier stop has not been released yet, says nothing
/// about a robot that does not obey.
pub fn hazard(
    kernel: &Shadow,
    decision: &Decision,
    moment: &Moment,
    robot: &Robot,
) -> Option<Judged> {
    let stops = decision.action >= Action::ProtectiveStop;
    let of_the_shadow = matches!(
        decision.reason,
        Reason::DriveMismatch | Reason::WaitingForRelease | Reason::Startup
    );
    let nearest = nearest_to_footprint(kernel, robot);
    let in_zone = nearest.is_some_and(|(_, inside)| inside);
    let reason = match (stops, of_the_shadow, in_zone) {
        (true, false, _) => decision.reason,
        // Hidden behind the shadow's own objections, but there all the same.
        (_, _, true) => Reason::CriticalZone,
        _ => return None,
    };
    let point = nearest
        .filter(|_| reason == Reason::CriticalZone)
        .map(|(point, _)| transform(moment.pose, point));
    Some(Judged {
        action: "protective_stop".to_owned(),
        reason: words::snake(&format!("{reason:?}")),
        point_m: point,
        ..Judged::default()
    })
}

/// Asks the guard about the recorded motion, then about slower ones of the same curvature.
///
/// The hull is that of a robot that was told what it did: the motion measured now, the one told a
/// tick ago, and the one that came next.
pub fn ask_guard(kernel: &Shadow, moment: &Moment) -> Judged {
    let (config, track) = (kernel.config(), kernel.track());
    let (Some(odometry), Some(pose)) = (track.newest(), track.pose()) else {
        return Judged::default();
    };
    let scene = Scene {
        memory: kernel.memory(),
        model: config.memory(),
        pose,
        stamp: odometry.stamp,
        odometer: track.odometer(),
        excuse: (rests(moment.told)).then(haltline::guard::check::Excuse::default),
    };
    let mut refused: Option<Verdict> = None;
    if rests(moment.wanted) {
        // To stand still needs no certificate.
        return passed(1000);
    }
    for factor_permille in FACTORS_PERMILLE {
        let hull = hull_at(moment, factor_permille);
        let reaction_us = config.reaction_us(Duration::ZERO);
        let verdict = certify(config.tube(), &hull, reaction_us, &scene);
        if verdict.refusal.is_none() {
            return passed(factor_permille);
        }
        refused.get_or_insert(verdict);
    }
    blocked(moment, refused)
}

/// What the robot may be doing if the wanted motion is slowed by a factor.
fn hull_at(moment: &Moment, factor_permille: u16) -> Hull {
    let factor = f64::from(factor_permille) / 1e3;
    let slower = moment.wanted.map(|value| value * factor);
    let mut hull = Hull::default();
    for [linear, angular] in [moment.speed, moment.told, slower] {
        hull.push(Vertex {
            twist: Twist {
                linear: convert::speed(linear, Round::Nearest).unwrap_or_default(),
                angular: convert::angular_speed(angular, Round::Nearest).unwrap_or_default(),
            },
            curvature: Curvature::ZERO,
        });
    }
    hull
}

/// Nothing on the list was accepted; the fastest motion's refusal is the one to tell.
fn blocked(moment: &Moment, refused: Option<Verdict>) -> Judged {
    let refusal = refused.and_then(|verdict| verdict.refusal);
    Judged {
        action: "brake".to_owned(),
        reason: "guard_blocked".to_owned(),
        refusal: refusal.map(|refusal| words::snake(&format!("{refusal:?}"))),
        point_m: refused
            .and_then(|verdict| verdict.point)
            .map(|point| in_world(moment.pose, point.x_mm, point.y_mm)),
        ..Judged::default()
    }
}

fn passed(factor_permille: u16) -> Judged {
    let (action, reason) = match factor_permille {
        1000 => ("pass", "none"),
        _ => ("slow", "guard_limited"),
    };
    Judged {
        action: action.to_owned(),
        reason: reason.to_owned(),
        factor: f64::from(factor_permille) / 1e3,
        ..Judged::default()
    }
}

/// The known point nearest to the footprint in the body frame, and whether it lies in the critical zone.
fn nearest_to_footprint(kernel: &Shadow, robot: &Robot) -> Option<([f64; 2], bool)> {
    let (body, zone) = (&robot.values.footprint, &robot.values.zone);
    let outside = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
    kernel
        .memory()
        .clouds()
        .flatten()
        .map(|p| [f64::from(p.x_mm) / 1e3, f64::from(p.y_mm) / 1e3])
        .map(|[x, y]| {
            let gap = outside(x, -body.rear_m, body.front_m).hypot(outside(
                y,
                -body.right_m,
                body.left_m,
            ));
            (gap, [x, y])
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, [x, y])| {
            let inside = outside(x, -body.rear_m - zone.side_m, body.front_m + zone.front_m).max(
                outside(y, -body.right_m - zone.side_m, body.left_m + zone.side_m),
            ) <= 0.0;
            ([x, y], inside)
        })
}
