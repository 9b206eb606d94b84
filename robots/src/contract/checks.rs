//! The checks, one function each.

use super::tables::{known_ahead, obstructs, slowest_mps, space_ahead_m};
use super::timing::{host_death, scan_in_time, tracking_window_spans_latency};
use super::tubes::{Tubes, hold_s};
use super::{Check, Finding, blind, holds_if};
use crate::{Kinematics, Robot};

/// All checks in the order of the certificate.
pub(super) fn all(robot: &Robot, tubes: &dyn Tubes) -> Vec<Check> {
    let mut checks = vec![
        stop_within_view(robot, tubes),
        stop_in_the_open(robot, tubes),
        turn_within_view(robot, tubes),
        reverse_within_view(robot),
    ];
    checks.extend(robot.values.scanners.iter().map(|s| scan_in_time(robot, s)));
    checks.push(tracking_window_spans_latency(robot));
    checks.push(zone_inside_inflation(robot, tubes));
    checks.push(zone_in_view(robot));
    checks.push(host_death(robot));
    checks
}

fn stop_within_view(robot: &Robot, tubes: &dyn Tubes) -> Check {
    let speed = robot.values.limits.speed_forward_mps;
    let (bound, by) = known_ahead(robot);
    let lower = "lower speed_forward_mps to the top speed of the table";
    let (finding, value, sentence) = match tubes.straight(robot, speed) {
        None => {
            let sentence = format!(
                "The guard refuses {speed:.2} m/s whatever it sees, because the tube is longer or wider \
                 than it can check; {lower}."
            );
            (Finding::Fails, f64::INFINITY, sentence)
        }
        Some(reserve) => {
            let path = reserve.reaction_m + reserve.braking_m;
            let value = path + reserve.inflation_m();
            let needs = format!(
                "At {speed:.2} m/s the robot stops within {path:.2} m and needs {value:.2} m ahead of its \
                 front edge"
            );
            match obstructs(robot, &reserve) {
                None => {
                    let sentence = format!("{needs}; bodies are known up to {bound:.2} m ({by}).");
                    (Finding::Holds, value, sentence)
                }
                Some(obstacle) => {
                    let sentence = format!(
                        "{needs}, but bodies are known up to {bound:.2} m and space up to {:.2} m \
                         ({obstacle}); {lower}.",
                        space_ahead_m(robot)
                    );
                    (Finding::Fails, value, sentence)
                }
            }
        }
    };
    Check {
        id: "C-STOP",
        title: "Stopping distance at top speed against what the scanners know",
        finding,
        value,
        bound,
        unit: "m",
        sentence,
    }
}

fn stop_in_the_open(robot: &Robot, tubes: &dyn Tubes) -> Check {
    let v = &robot.values;
    let ahead = v
        .scanners
        .iter()
        .filter(|s| s.sees(s.x_m + s.range_max_m * 0.5, s.y_m));
    let clear = ahead.map(|s| s.x_m + s.no_return_clear_m - v.footprint.front_m);
    let bound = clear.fold(0.0, f64::max);
    // Sensor and obstacle terms do not count against unknown space.
    let needed = tubes.straight(robot, v.limits.speed_forward_mps);
    let value = needed.map_or(f64::INFINITY, |r| {
        r.reaction_m + r.braking_m + r.inflation_m()
    });
    let enough = value <= bound;
    Check {
        id: "C-OPEN",
        title: "Stopping distance against what a beam without return clears",
        finding: if enough {
            Finding::Holds
        } else {
            Finding::NotCovered
        },
        value,
        bound,
        unit: "m",
        sentence: if enough {
            format!(
                "Where nothing returns, {bound:.2} m ahead count as free (assumption no_return_clear_m); \
                 that is enough for top speed."
            )
        } else {
            format!(
                "Where nothing returns, {bound:.2} m ahead count as free: in the open, beyond the range of \
                 the scanners, the robot slows down or waits. Top speed is for places with walls."
            )
        },
    }
}

fn turn_within_view(robot: &Robot, tubes: &dyn Tubes) -> Check {
    let v = &robot.values;
    let title = "Area swept by turning on the spot against the area in view";
    let check = |finding, value, sentence| Check {
        id: "C-TURN",
        title,
        finding,
        value,
        bound: 0.0,
        unit: "part out of view",
        sentence,
    };
    if v.kinematics != Kinematics::Differential {
        return check(
            Finding::Holds,
            0.0,
            "The robot does not turn on the spot.".to_owned(),
        );
    }
    let Some(reserve) = tubes.on_the_spot(robot, v.limits.angular_speed_radps) else {
        let rate = v.limits.angular_speed_radps;
        let sentence = format!(
            "The guard refuses {rate:.2} rad/s on the spot whatever it sees; lower angular_speed_radps."
        );
        return check(Finding::Fails, 1.0, sentence);
    };
    let blind = blind::of_disc(robot, v.footprint.radius_m() + reserve.inflation_m());
    let passing_s = v.footprint.length_m() / v.limits.speed_forward_mps;
    let remembered = v.memory.age_max_s >= passing_s;
    let share = blind * 100.0;
    let sentence = if blind <= 0.0 {
        "All that turning on the spot sweeps is in view.".to_owned()
    } else if remembered {
        format!(
            "{share:.0} % of what turning on the spot sweeps is out of view: the guard turns only where \
             memory still holds it as free, at most {:.0} s after it was seen, less where \
             bodies move.",
            v.memory.age_max_s
        )
    } else {
        format!(
            "{share:.0} % of what turning on the spot sweeps is out of view, and memory forgets within \
             {:.1} s, before the robot has driven its own length ({passing_s:.1} s): it could never \
             turn; raise age_max_s or add a scanner.",
            v.memory.age_max_s
        )
    };
    check(holds_if(blind <= 0.0 || remembered), blind, sentence)
}

fn reverse_within_view(robot: &Robot) -> Check {
    let limits = robot.values.limits;
    let speed = limits.speed_reverse_mps;
    let watched = crate::rules::watches_rear(&robot.values);
    let sentence = if speed <= 0.0 {
        "Reverse is forbidden.".to_owned()
    } else if watched {
        format!("Reverse at {speed:.2} m/s looks where it goes: the rear is in view.")
    } else {
        format!(
            "Nobody looks behind: reverse at up to {speed:.2} m/s only into space remembered as free \
             (reverse_into_memory)."
        )
    };
    Check {
        id: "C-REVERSE",
        title: "Reverse against the area in view",
        finding: holds_if(speed <= 0.0 || watched || limits.reverse_into_memory),
        value: speed,
        bound: speed,
        unit: "m/s",
        sentence,
    }
}

/// Speed that a margin alone can stop: `v T + v²/(2 b) = margin`.
fn speed_stopped_within(robot: &Robot, margin_m: f64) -> f64 {
    let (hold, b) = (hold_s(robot), robot.values.limits.braking_mps2);
    b * ((hold * hold + 2.0 * margin_m / b).sqrt() - hold)
}

fn zone_inside_inflation(robot: &Robot, tubes: &dyn Tubes) -> Check {
    let zone = robot.values.zone;
    let value = zone.front_m.max(zone.side_m);
    let creeping = tubes.straight(robot, slowest_mps(robot));
    let bound = creeping.as_ref().map_or(0.0, super::Reserve::inflation_m);
    let alone = speed_stopped_within(robot, zone.front_m);
    let fits = value <= bound;
    Check {
        id: "C-ZONE",
        title: "Critical zone against the distance the guard keeps",
        finding: holds_if(fits),
        value,
        bound,
        unit: "m",
        sentence: if fits {
            format!(
                "The guard keeps at least {bound:.3} m from what it knows, more than the zone's {value:.3} m: \
                 a motion it accepts in the clear ends outside the zone. Alone, the front zone stops the \
                 robot from {alone:.2} m/s; above that it is the guard that stops in time."
            )
        } else {
            format!(
                "The guard lets bodies as near as {bound:.3} m, inside the zone's {value:.3} m: motions \
                 that it accepts would end in a protective stop; lower zone.front_m and zone.side_m."
            )
        },
    }
}

fn zone_in_view(robot: &Robot) -> Check {
    let blind = blind::of_zone(robot);
    let whole = blind <= 0.0;
    Check {
        id: "C-ZONE-VIEW",
        title: "Critical zone against the area in view",
        finding: if whole {
            Finding::Holds
        } else {
            Finding::NotCovered
        },
        value: blind,
        bound: 0.0,
        unit: "part out of view",
        sentence: if whole {
            "The whole critical zone is in view.".to_owned()
        } else {
            format!(
                "{:.0} % of the critical zone is out of view: what comes up there is not noticed. The \
                 claim covers bodies that a beam returned or that memory holds.",
                blind * 100.0
            )
        },
    }
}
