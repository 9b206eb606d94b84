//! The navigator in full: planner, guard and stop logic drive a robot along a drawn route through a drawn world.

use crate::closed_loop::episode::{Episode, Lie};
use crate::closed_loop::report::Report;
use crate::closed_loop::rules;
use crate::closed_loop::wire::decode;
use crate::guard;
use crate::script::{Script, noise};
use crate::vehicle::{News, Vehicle};
use crate::{Judged, Property, demand};
use haltline::Navigator;
use haltline::decision::{Action, StopStatus};
use haltline::input::{Inputs, Reading, Scan};
use haltline::kernel::navigate::{Destination, Navigation, Planning, Progress, Route, Via};
use haltline::time::Instant;
use haltline::units::{BinaryAngle, Length};
use haltline_spec::motion::Twist;
use haltline_spec::plane::Pose;
use haltline_spec::plant::SetPoint;

pub const NAVIGATE: Property = Property {
    name: "navigate",
    judge: |bytes| judge(bytes, Lie::None),
    twins: &[
        ("a smaller footprint", |bytes| judge(bytes, Lie::Footprint)),
        ("arrives a metre too early", |bytes| {
            judge(bytes, Lie::Drift)
        }),
    ],
    draw: noise::<60, 200>,
    cases: 80,
};

type Pilot = Navigator<2, 400, 600>;

/// Where to go, as numbers.
struct Order {
    via: Vec<Via>,
    goal: Destination,
}

fn order(script: &mut Script<'_>) -> Order {
    let mut place = || {
        let (x, y) = (script.between(-4.0, 4.0), script.between(-4.0, 4.0));
        ((x * 1e6) as i64, (y * 1e6) as i64)
    };
    let all = [place(), place(), place()];
    let via = all[1..].iter().map(|&(x_um, y_um)| Via {
        x_um,
        y_um,
        tolerance: Length::from_mm(250),
    });
    let via = via.take(script.count(0, 2)).collect();
    let heading = script
        .flag()
        .then(|| BinaryAngle::from_counts(u32::from(script.word()) << 16));
    Order {
        via,
        goal: Destination {
            x_um: all[0].0,
            y_um: all[0].1,
            tolerance: Length::from_mm(150),
            heading,
            heading_tolerance: 1 << 27,
        },
    }
}

fn episode(script: &mut Script<'_>, lie: Lie) -> Episode {
    let mut episode = guard::episode(script);
    episode.obstacle_mps = 0.0;
    episode.steered &= lie == Lie::None;
    episode.scan_ms = 5;
    if lie == Lie::Footprint {
        episode.lie = lie;
        episode.tol_v_mps = 0.0;
        episode.tol_omega_radps = 0.0;
        episode.tracking_m = 0.0;
        episode.sensor_m = 0.0;
        episode.latency_ms = 0;
    }
    episode
}

fn judge(bytes: &[u8], lie: Lie) -> Judged {
    let mut script = Script::new(bytes);
    let episode = episode(&mut script, lie);
    let world = guard::world(&mut script, &episode);
    let order = order(&mut script);
    let mut vehicle = Vehicle::new(&episode, world);
    let pilot = Pilot::new(episode.config(), Planning::default());
    let mut pilot = Box::new(pilot.map_err(|error| format!("refused: {error:?}"))?);
    let mut status = StopStatus::Latched;
    let mut since = None;
    let mut report = Report::default();
    let mut log = vec![(-9.0, still(&episode))];
    let mut accepted = 0;
    for _ in 0..60 + 2 * bytes.len().min(120) {
        if let Some(body) = vehicle.drive() {
            return Err(format!("touched {body}"));
        }
        let news = vehicle.look();
        let since = *since.get_or_insert(news.now);
        // A route is void until the latch has been released before it was ordered.
        let stamp = if status == StopStatus::Running {
            news.now.max(since)
        } else {
            since
        };
        let answer = tick(&mut pilot, &order, &news, stamp, status);
        status = answer.decision.status;
        let set_point = decode(answer.decision.setpoint);
        rules::check(
            &episode,
            &log,
            set_point,
            &answer.decision,
            vehicle.now_us,
            &mut report,
        );
        log.push((vehicle.now_us as f64 * 1e-6, set_point));
        vehicle.obey(set_point);
        arrived(&answer, &order, news.place, lie)?;
        let moves = answer.decision.verdict.is_some()
            && matches!(answer.decision.action, Action::Pass | Action::Slow);
        accepted += usize::from(moves);
        if let Some(first) = report.faults.first() {
            return Err(first.clone());
        }
    }
    Ok(accepted)
}

fn tick(
    pilot: &mut Pilot,
    order: &Order,
    news: &News,
    stamp: Instant,
    status: StopStatus,
) -> Navigation {
    let scans = [Reading::Value(Scan {
        scanner: 0,
        stamp: news.stamp,
        beams: &news.beams,
    })];
    let inputs = Inputs {
        scans: &scans,
        odometry: news.odometry,
        reset: (status == StopStatus::Latched).then_some(news.now),
        ..Inputs::default()
    };
    let route = Route {
        stamp,
        id: 1,
        via: &order.via,
        goal: order.goal,
        ..Route::default()
    };
    pilot.step(&inputs, Some(&route), news.now)
}

/// Who says it has arrived stands where it should, with the heading it should have.
fn arrived(answer: &Navigation, order: &Order, place: Pose, lie: Lie) -> Result<(), String> {
    if answer.progress != Progress::Arrived {
        return Ok(());
    }
    let goal = &order.goal;
    let early_m = if lie == Lie::Drift { 1.0 } else { 0.0 };
    let far_m = (goal.x_um as f64 * 1e-6 - place.x_m).hypot(goal.y_um as f64 * 1e-6 - place.y_m);
    demand(far_m + early_m <= 0.151, || {
        format!("arrived {far_m} m from the goal")
    })?;
    let Some(heading) = goal.heading else {
        return Ok(());
    };
    let wanted = f64::from(heading.as_counts()) / 4_294_967_296.0 * std::f64::consts::TAU;
    let off = (wanted - place.theta_rad)
        .sin()
        .atan2((wanted - place.theta_rad).cos());
    demand(off.abs() <= std::f64::consts::TAU / 32.0 + 1e-3, || {
        format!("arrived turned by {off} rad")
    })
}

const fn still(episode: &Episode) -> SetPoint {
    if episode.steered {
        SetPoint::Arc {
            v_mps: 0.0,
            curvature_per_m: 0.0,
        }
    } else {
        SetPoint::Twist(Twist::new(0.0, 0.0))
    }
}
