//! The bench procedure: what to drive to measure a robot file's assumptions, and what follows.
//!
//! The robot stands in the middle of a free, flat floor with somebody at its stop button: nothing
//! guards these motions. Every figure comes with its sample and is given as a bound on the safe
//! side, mean and three standard deviations of at least five runs, as the line to paste into the
//! robot file. What cannot be measured here (the true path) is said to be so.

mod fit;
mod live;

use std::fmt;

use haltline_robots::Robot;

pub use fit::{Ramp, Spread, ramp};
pub use live::Live;

/// Repetitions of each manoeuvre.
pub const RUNS: usize = 5;

/// One feedback of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When it was measured, seconds on the host's clock.
    pub at_s: f64,
    /// Pose, metres and radians.
    pub pose: [f64; 3],
    /// Speed and turn rate, m/s and rad/s.
    pub twist: [f64; 2],
}

/// A robot that can be measured.
pub trait Platform {
    /// Sends this set point every period for `span_s`; what was fed back meanwhile.
    ///
    /// # Errors
    /// The drive does not obey; says why.
    fn drive(&mut self, linear: f64, turn: f64, span_s: f64) -> Result<Vec<Sample>, String>;

    /// Says nothing for `span_s` and listens.
    fn silence(&mut self, span_s: f64) -> Vec<Sample>;

    /// Brings the drive back to obeying, at rest.
    ///
    /// # Errors
    /// It does not come back.
    fn recover(&mut self) -> Result<(), String>;

    /// Now, seconds on the clock of the samples.
    fn now_s(&self) -> f64;
}

/// One measured figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Table and key of the robot file.
    pub key: &'static str,
    /// The value to write: the bound, rounded to the safe side.
    pub value: f64,
    /// What it was bounded from.
    pub spread: Spread,
    /// What the robot file says today.
    pub assumed: f64,
    /// Whether the file's value is on the safe side of the bound.
    pub holds: bool,
}

impl fmt::Display for Figure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.key.rsplit('.').next().unwrap_or(self.key);
        let Spread {
            mean,
            deviation,
            count,
        } = self.spread;
        write!(
            out,
            "{name} = {:.3}  # measured: n = {count}, mean {mean:.4}, s {deviation:.4}, bound 3 s",
            self.value
        )?;
        if !self.holds {
            write!(
                out,
                "; the file's {:.3} is NOT on the safe side",
                self.assumed
            )?;
        }
        Ok(())
    }
}

/// Which way is safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Safe {
    /// Decelerations: the smaller value.
    Less,
    /// Times: the larger value.
    More,
}

fn figure(key: &'static str, values: &[f64], assumed: f64, safe: Safe) -> Option<Figure> {
    let spread = Spread::of(values)?;
    let (value, holds) = match safe {
        Safe::Less => {
            let value = ((spread.mean - 3.0 * spread.deviation) * 1e3).floor() * 1e-3;
            (value.max(0.0), assumed <= value)
        }
        Safe::More => {
            let value = ((spread.mean + 3.0 * spread.deviation) * 1e3).ceil() * 1e-3;
            (value, assumed >= value)
        }
    };
    Some(Figure {
        key,
        value,
        spread,
        assumed,
        holds,
    })
}

/// What was measured, and what could not be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Figures in the order of the procedure.
    pub figures: Vec<Figure>,
    /// Manoeuvres that gave nothing, and what remains to be done by hand.
    pub notes: Vec<String>,
}

/// Values of each run, by what they are.
#[derive(Default)]
struct Runs {
    latency: Vec<f64>,
    braking: Vec<f64>,
    angular: Vec<f64>,
    watchdog: Vec<f64>,
    silent: Vec<f64>,
}

/// Drives the whole procedure; the robot needs about `2 × v² / b + v × watchdog` of free floor ahead.
///
/// - `speed_mps`: cruising speed of the manoeuvres; turn in place at the same share of the limit
///
/// # Errors
/// The drive does not obey at all.
pub fn run(robot: &Robot, platform: &mut dyn Platform, speed_mps: f64) -> Result<Outcome, String> {
    let steered = matches!(
        robot.values.kinematics,
        haltline_robots::Kinematics::Ackermann(_)
    );
    let silent_s = robot.values.host_death.watchdog_s;
    let mut runs = Runs::default();
    for _ in 0..RUNS {
        platform.recover()?;
        braking(platform, speed_mps, &mut runs)?;
        if !steered {
            turning(
                platform,
                robot.values.limits.angular_speed_radps / 3.0,
                &mut runs,
            )?;
        }
        silence(platform, speed_mps, silent_s, &mut runs)?;
    }
    Ok(judge(robot, &runs, steered))
}

/// Figures of all runs against the robot file.
fn judge(robot: &Robot, runs: &Runs, steered: bool) -> Outcome {
    let mut outcome = Outcome::default();
    let limits = &robot.values.limits;
    let quiet = &robot.values.host_death;
    let wanted = [
        (
            "timing.actuation_latency_s",
            &runs.latency,
            robot.values.timing.actuation_latency_s,
            Safe::More,
        ),
        (
            "limits.braking_mps2",
            &runs.braking,
            limits.braking_mps2,
            Safe::Less,
        ),
        (
            "limits.angular_braking_radps2",
            &runs.angular,
            limits.angular_braking_radps2,
            Safe::Less,
        ),
        (
            "host_death.watchdog_s",
            &runs.watchdog,
            quiet.watchdog_s,
            Safe::More,
        ),
        (
            "host_death.braking_mps2",
            &runs.silent,
            quiet.braking_mps2,
            Safe::Less,
        ),
    ];
    for (key, values, assumed, safe) in wanted {
        match figure(key, values, assumed, safe) {
            Some(figure) if values.len() >= RUNS => outcome.figures.push(figure),
            _ if steered && key.contains("angular") => {}
            _ => outcome.notes.push(format!(
                "{key}: only {} of {RUNS} runs showed it; not measured",
                values.len()
            )),
        }
    }
    outcome.notes.push(
        "tolerances.tracking_m: drive a marked circle and measure where the wheels went; \
         odometry cannot see its own error"
            .to_owned(),
    );
    outcome
}

/// Up to speed, which gives the latency, and a set point of zero, which gives the brakes.
fn braking(platform: &mut dyn Platform, speed: f64, runs: &mut Runs) -> Result<(), String> {
    let started_s = platform.now_s();
    let mut samples = platform.drive(speed, 0.0, 2.5)?;
    if let Some(up) = ramp(&samples, 0, 0.0, speed) {
        runs.latency.push((up.begin_s - started_s).max(0.0));
    }
    samples.clear();
    samples.extend(platform.drive(0.0, 0.0, 3.0)?);
    if let Some(down) = ramp(&samples, 0, speed, 0.0) {
        runs.braking.push(down.rate.abs());
    }
    Ok(())
}

fn turning(platform: &mut dyn Platform, rate: f64, runs: &mut Runs) -> Result<(), String> {
    platform.drive(0.0, rate, 2.0)?;
    let samples = platform.drive(0.0, 0.0, 2.0)?;
    if let Some(down) = ramp(&samples, 1, rate, 0.0) {
        runs.angular.push(down.rate.abs());
    }
    Ok(())
}

/// Up to speed and then not a word: when the robot notices, and how it stops.
fn silence(
    platform: &mut dyn Platform,
    speed: f64,
    watchdog_s: f64,
    runs: &mut Runs,
) -> Result<(), String> {
    platform.drive(speed, 0.0, 2.5)?;
    let quiet_s = platform.now_s();
    let samples = platform.silence(watchdog_s * 2.0 + 4.0);
    if let Some(down) = ramp(&samples, 0, speed, 0.0) {
        runs.watchdog.push((down.begin_s - quiet_s).max(0.0));
        runs.silent.push(down.rate.abs());
    }
    platform.recover()
}
