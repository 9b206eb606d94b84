//! The checks, one function each.

use super::tables::{known_ahead, obstructs, slowest_mps, space_ahead_m};
use super::tubes::{Tubes, hold_s};
use super::{Check, Finding, blind};
use crate::{Kinematics, Robot, Silence};

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

fn holds_if(condition: bool) -> Finding {
    if condition {
        Finding::Holds
    } else {
        Finding::Fails
    }
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

fn scan_in_time(robot: &Robot, scanner: &crate::Scanner) -> Check {
    let bound = robot.values.timing.scan_age_max_s;
    let value = scanner.scan_time_s + 1.0 / scanner.rate_hz;
    let (name, ms) = (&scanner.name, |s: f64| s * 1000.0);
    Check {
        id: "C-SCAN-AGE",
        title: "Age of a scan when the next one is due against the age limit",
        finding: holds_if(value < bound),
        value,
        bound,
        unit: "s",
        sentence: if value < bound {
            format!(
                "A scan of {name} is {:.0} ms old when the next is complete; the limit of {:.0} ms leaves \
                 {:.0} ms for transport.",
                ms(value),
                ms(bound),
                ms(bound - value)
            )
        } else {
            format!(
                "A scan of {name} is {:.0} ms old when the next is complete, beyond the limit of {:.0} ms: \
                 the robot would stop between scans; raise scan_age_max_s.",
                ms(value),
                ms(bound)
            )
        },
    }
}

fn tracking_window_spans_latency(robot: &Robot) -> Check {
    let t = robot.values.timing;
    let value = t.actuation_latency_s + t.odometry_age_max_s + t.period_s;
    let bound = t.tracking_window_s;
    let comparison = if value <= bound {
        "fits into"
    } else {
        "does not fit into: a healthy drive would be stopped; raise tracking_window_s beyond it, not"
    };
    Check {
        id: "C-TRACKING",
        title: "Latency of the drive against the window in which it must follow",
        finding: holds_if(value <= bound),
        value,
        bound,
        unit: "s",
        sentence: format!(
            "From a command to its echo in the odometry it may take {:.0} ms, which {comparison} the \
             window of {:.0} ms.",
            value * 1000.0,
            bound * 1000.0
        ),
    }
}

/// Speed that a margin alone can stop: `v T + v²/(2 b) = margin`.
fn speed_stopped_within(robot: &Robot, margin_m: f64) -> f64 {
    let (hold, b) = (hold_s(robot), robot.values.limits.braking_mps2);
    b * ((hold * hold + 2.0 * margin_m / b).sqrt() - hold)
}

fn zone_inside_inflation(robot: &Robot, tubes: &dyn Tubes) -> Check {
    let (zone, width) = (robot.values.zone, robot.values.footprint.width_m());
    let creeping = tubes.straight(robot, slowest_mps(robot));
    let bound = creeping.as_ref().map_or(0.0, super::Reserve::inflation_m);
    let alone = speed_stopped_within(robot, zone.front_m);
    let fits = zone.side_m <= bound;
    Check {
        id: "C-ZONE",
        title: "Critical zone against the guard's own distance",
        finding: holds_if(fits),
        value: zone.side_m,
        bound,
        unit: "m",
        sentence: if fits {
            format!(
                "The guard keeps at least {bound:.3} m at the sides, more than the zone's {:.3} m, so a \
                 motion it accepts never ends in the zone. Alone, the front zone stops the robot from \
                 {alone:.2} m/s; above that it is the guard that stops in time.",
                zone.side_m
            )
        } else {
            format!(
                "The guard lets bodies as near as {bound:.3} m, inside the zone's {:.3} m: the robot would \
                 stop in gaps of {:.2} m that it could pass; lower zone.side_m.",
                zone.side_m,
                width + 2.0 * zone.side_m
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

fn host_death(robot: &Robot) -> Check {
    let (h, limits) = (robot.values.host_death, robot.values.limits);
    let v = limits.speed_forward_mps;
    let value = v * h.watchdog_s + v * v / (2.0 * h.braking_mps2);
    let (bound, by) = known_ahead(robot);
    let does = match h.behaviour {
        Silence::Coast => "coasts",
        Silence::Brake => "brakes",
    };
    let distance = format!(
        "If the host dies at {v:.2} m/s the drive goes on for {:.2} s, then {does}: {value:.2} m",
        h.watchdog_s
    );
    let (finding, sentence) = if !h.cover_host_death {
        (
            Finding::NotCovered,
            format!("Host failure: not covered. {distance}."),
        )
    } else if value <= bound {
        let sentence = format!("{distance}; the guard keeps that room. Host failure: covered.");
        (Finding::Holds, sentence)
    } else {
        let sentence = format!(
            "{distance}, more than the {bound:.2} m known ahead ({by}); lower speed_forward_mps or \
             watchdog_s, or write cover_host_death = false."
        );
        (Finding::Fails, sentence)
    };
    Check {
        id: "C-HOST",
        title: "Distance after the death of the host",
        finding,
        value,
        bound,
        unit: "m",
        sentence,
    }
}
