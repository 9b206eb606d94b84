//! Robot and scenario files: what is taken is rounded to the safe side, what is refused is named by line.

use crate::text::{points_into, spoiled, text};
use crate::{Judged, Property, demand};
use haltline::checked::KernelConfig;
use haltline::units::Speed;
use haltline_robots::{BEAMS, EMBEDDED, Robot, RobotError};
use haltline_scenarios::equip::equip;
use haltline_scenarios::file::{self, Scenario, ScenarioError};

pub const ROBOT: Property = Property {
    name: "robot",
    judge: |bytes| robot(bytes, Robot::parse),
    twins: &[
        ("a millimetre a second faster", |bytes| {
            robot(bytes, |text, file| {
                let mut robot = Robot::parse(text, file)?;
                let speed = robot.config.limits.speed_forward.as_um_per_s();
                robot.config.limits.speed_forward = Speed::from_um_per_s(speed + 1000);
                Ok(robot)
            })
        }),
        ("a footprint rounded inward", |bytes| {
            robot(bytes, |text, file| {
                let mut robot = Robot::parse(text, file)?;
                let front = robot.config.footprint.front.as_um();
                robot.config.footprint.front = haltline::units::Length::from_um(front - 2);
                Ok(robot)
            })
        }),
        ("errors beyond the file", |bytes| {
            robot(bytes, |text, file| {
                Robot::parse(text, file).map_err(|mut error| {
                    error.line += 1000;
                    error
                })
            })
        }),
    ],
    draw: |draw| {
        let (_, text) = EMBEDDED[draw.index(EMBEDDED.len())];
        spoiled(draw, text)
    },
    cases: 4000,
};

type ParseRobot = fn(&str, &str) -> Result<Robot, RobotError>;

fn robot(bytes: &[u8], parse: ParseRobot) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let robot = match parse(text, "r.toml") {
        Ok(robot) => robot,
        Err(error) => {
            demand(
                error.line >= 1 && error.column >= 1 && error.file == "r.toml",
                || format!("{error:?}"),
            )?;
            demand(!error.advice.is_empty(), || format!("no advice: {error}"))?;
            return points_into(text, error.line, &error.problem).map(|()| 0);
        }
    };
    let (values, config) = (&robot.values, &robot.config);
    demand(KernelConfig::new(*config, BEAMS).is_ok(), || {
        "the kernel refuses it".to_owned()
    })?;
    // Never smaller than written, and by no more than the unit.
    let up = |name: &str, written: f64, kept: i32| {
        let off = f64::from(kept) - written * 1e6;
        demand((-1e-3..=2.0).contains(&off), || {
            format!("{name}: {written} became {kept}")
        })
    };
    let down = |name: &str, written: f64, kept: u32| {
        let off = written * 1e6 - f64::from(kept);
        demand((-1e-3..=2.0).contains(&off), || {
            format!("{name}: {written} became {kept}")
        })
    };
    up(
        "front",
        values.footprint.front_m,
        config.footprint.front.as_um(),
    )?;
    up(
        "rear",
        values.footprint.rear_m,
        config.footprint.rear.as_um(),
    )?;
    up(
        "left",
        values.footprint.left_m,
        config.footprint.left.as_um(),
    )?;
    up(
        "right",
        values.footprint.right_m,
        config.footprint.right.as_um(),
    )?;
    up(
        "speed tolerance",
        values.tolerances.speed_mps,
        config.tolerances.speed.as_um_per_s(),
    )?;
    up(
        "tracking",
        values.tolerances.tracking_m,
        config.tolerances.tracking.as_um(),
    )?;
    up(
        "obstacles",
        values.obstacle_speed_mps,
        config.obstacle_speed.as_um_per_s(),
    )?;
    let speed = config.limits.speed_forward.as_um_per_s();
    down(
        "speed",
        values.limits.speed_forward_mps,
        u32::try_from(speed).unwrap_or(u32::MAX),
    )?;
    down(
        "braking",
        values.limits.braking_mps2,
        config.limits.braking.as_um_per_s2(),
    )?;
    for (written, kept) in values.scanners.iter().zip(config.scanners.iter().flatten()) {
        up("sensor error", written.error_m(), kept.error.as_um())?;
        demand(kept.beams == written.beams, || {
            format!("{} beams", kept.beams)
        })?;
    }
    let latency = values.timing.actuation_latency_s * 1e6;
    let kept = config.timing.actuation_latency.as_us() as f64;
    demand(kept >= latency - 1e-3, || {
        format!("latency {latency} became {kept}")
    })?;
    Ok(1)
}

pub const SCENARIO: Property = Property {
    name: "scenario",
    judge: |bytes| scenario(bytes, file::parse),
    twins: &[
        ("the same name twice", |bytes| {
            scenario(bytes, |text, file, stem| {
                let mut all = file::parse(text, file, stem)?;
                all.extend(all.first().cloned());
                Ok(all)
            })
        }),
        ("errors beyond the file", |bytes| {
            scenario(bytes, |text, file, stem| {
                file::parse(text, file, stem).map_err(|mut error| {
                    error.line += 1000;
                    error
                })
            })
        }),
    ],
    draw: |draw| {
        let all = [
            include_str!("../../../scenarios/files/crossing.toml"),
            include_str!("../../../scenarios/files/chair_legs.toml"),
            include_str!("../../../scenarios/files/broken_slip.toml"),
            include_str!("../../../scenarios/files/navigate_passages.toml"),
            include_str!("../../../scenarios/files/input_ranges_nan.toml"),
            include_str!("../../../scenarios/files/host_death_covered.toml"),
            include_str!("../../../scenarios/files/car_reverse.toml"),
        ];
        let text = all[draw.index(all.len())];
        spoiled(draw, text)
    },
    cases: 4000,
};

type ParseScenario = fn(&str, &str, &str) -> Result<Vec<Scenario>, ScenarioError>;

fn scenario(bytes: &[u8], parse: ParseScenario) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let all = match parse(text, "s.toml", "s") {
        Ok(all) => all,
        Err(error) => return points_into(text, error.line, &error.message).map(|()| 0),
    };
    for (index, one) in all.iter().enumerate() {
        demand(one.name.starts_with('s') && one.group == "s", || {
            format!("named {}", one.name)
        })?;
        let twice = all[..index].iter().any(|other| other.name == one.name);
        demand(!twice, || format!("{} twice", one.name))?;
    }
    // What was read meets its robot, or is refused with a place.
    if let Some(one) = all.into_iter().next()
        && let Ok(robot) = Robot::embedded(&one.robot)
        && let Err(error) = equip(one, &robot)
    {
        points_into(text, error.line, &error.message)?;
    }
    Ok(1)
}
