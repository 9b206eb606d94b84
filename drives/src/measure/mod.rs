//! The bench procedure: what to drive to measure a robot file's assumptions, and what follows.
//!
//! The robot stands in the middle of a free, flat floor with somebody at its stop button: nothing
//! guards these motions. Every figure comes with its sample and is given as a bound on the safe
//! side, as the line to paste into the robot file: a tolerance bound that holds for 95 % of all runs
//! with 95 % confidence if they scatter normally. What cannot be measured here (the true path) is
//! said to be so.

mod fit;
mod live;

use std::fmt;

use haltline_robots::Robot;

use crate::seekur::{SkidFit, skid_factor};

pub use fit::{Ramp, Spread, ramp};
pub use live::Live;

/// Repetitions of each manoeuvre.
pub const RUNS: usize = 5;
/// Standard deviations between the mean of [`RUNS`] normal values and a bound that 95 % of all values
/// keep, with 95 % confidence: the one-sided tolerance factor for n = 5 (noncentral t; tabled in ISO
/// 16269-6).
const TOLERANCE_FACTOR: f64 = 4.203;

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
            "{name} = {:.3}  # measured: n = {count}, mean {mean:.4}, s {deviation:.4}; 95 % of runs at 95 % confidence",
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
            let value = ((spread.mean - TOLERANCE_FACTOR * spread.deviation) * 1e3).floor() * 1e-3;
            (value.max(0.0), assumed <= value)
        }
        Safe::More => {
            let value = ((spread.mean + TOLERANCE_FACTOR * spread.deviation) * 1e3).ceil() * 1e-3;
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
            Some(figure) if values.len() == RUNS => outcome.figures.push(figure),
            _ if steered && key.contains("angular") => {}
            _ => outcome.notes.push(format!(
                "{key}: only {} of {RUNS} runs showed it; not measured",
                values.len()
            )),
        }
    }
    outcome.notes.push(
        "tolerances.tracking_m: not measured; odometry cannot see its own error. Drive a circle of 4 m \
         (echo \"0.4 0.2\" to drive --shield) five times over chalk marks of the wheels; the line to \
         paste is tracking_m = the largest distance between the marks and the drawn circle"
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

/// Turns on the spot by about this much to each side, rad of the wheels.
const SKID_TURN_RAD: f64 = 4.0 * core::f64::consts::PI;

/// The skid factor of a robot that turns by its wheels, from a driven turn to each side.
///
/// - `rate_radps`: turn rate of the turns
/// - `ask`: the true turn in radians, left positive, when the wheels told this much; `None` ends it
///
/// # Errors
/// The drive does not obey, or the turns contradict each other; says why.
pub fn skid(
    platform: &mut dyn Platform,
    rate_radps: f64,
    mut ask: impl FnMut(f64) -> Option<f64>,
) -> Result<Option<SkidFit>, String> {
    let mut turns = Vec::new();
    for rate in [rate_radps, -rate_radps] {
        platform.recover()?;
        let mut samples = platform.drive(0.0, rate, SKID_TURN_RAD / rate_radps)?;
        samples.extend(platform.drive(0.0, 0.0, 3.0)?);
        let told = turned(&samples);
        let Some(real) = ask(told) else {
            return Ok(None);
        };
        turns.push((told, real));
    }
    let fit = skid_factor(&turns).ok_or_else(|| {
        format!("the turns {turns:.2?} (told, true; rad) make no skid factor from 0.05 to 1.05")
    })?;
    Ok(Some(fit))
}

/// Sum of all turns between samples, rad.
fn turned(samples: &[Sample]) -> f64 {
    use core::f64::consts::{PI, TAU};
    let step = |pair: &[Sample]| match pair {
        [before, after] => (after.pose[2] - before.pose[2] + PI).rem_euclid(TAU) - PI,
        _ => 0.0,
    };
    samples.windows(2).map(step).sum()
}
