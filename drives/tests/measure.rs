//! The bench procedure finds what the emulated robots really do, and says when a file promises more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::time::Duration;
use haltline_drives::conformance::{Bench, CarBench, Rig, SeekurBench};
use haltline_drives::measure::{self, Platform, Sample, Spread, ramp};
use haltline_drives::seekur::Wheels;
use haltline_robots::Robot;

/// The suite's rig, in virtual time.
struct Virtual(Rig);

fn ms(span_s: f64) -> u64 {
    (span_s * 1e3).round() as u64
}

impl Virtual {
    fn sample(&mut self, samples: &mut Vec<Sample>) {
        if let Some(feedback) = self.0.feedback.take() {
            samples.push(Sample {
                at_s: feedback.stamp.as_us() as f64 * 1e-6,
                pose: feedback.pose,
                twist: feedback.twist,
            });
        }
    }
}

impl Platform for Virtual {
    fn drive(&mut self, linear: f64, turn: f64, span_s: f64) -> Result<Vec<Sample>, String> {
        let mut samples = Vec::new();
        for _ in 0..ms(span_s) {
            self.0.decide(linear, turn, Duration::from_ms(1));
            self.sample(&mut samples);
        }
        Ok(samples)
    }

    fn silence(&mut self, span_s: f64) -> Vec<Sample> {
        let mut samples = Vec::new();
        for _ in 0..ms(span_s) {
            self.0.listen(Duration::from_ms(1));
            self.sample(&mut samples);
        }
        samples
    }

    fn recover(&mut self) -> Result<(), String> {
        if !self.0.start() {
            return Err("never drives".to_owned());
        }
        self.0.decide(0.0, 0.0, Duration::from_ms(2500));
        Ok(())
    }

    fn now_s(&self) -> f64 {
        self.0.now.as_us() as f64 * 1e-6
    }
}

fn figures(bench: &dyn Bench, robot: &str, speed: f64) -> measure::Outcome {
    let robot = Robot::embedded(robot).unwrap();
    let outcome = measure::run(&robot, &mut Virtual(Rig::new(bench, None)), speed).unwrap();
    for figure in &outcome.figures {
        println!("{}: {figure}", bench.name());
    }
    for note in &outcome.notes {
        println!("{}: {note}", bench.name());
    }
    outcome
}

fn value(outcome: &measure::Outcome, key: &str) -> f64 {
    let figure = outcome.figures.iter().find(|figure| figure.key == key);
    figure
        .unwrap_or_else(|| panic!("no {key} in {outcome:?}"))
        .value
}

#[test]
fn the_emulated_seekur_jr_is_measured_as_it_is() {
    let bench = SeekurBench {
        wheels: Wheels::VelRvel,
        skid: 1.0,
    };
    let outcome = figures(&bench, "seekur_jr", 0.6);
    let near = |key: &str, truth: f64, slack: f64| {
        let value = value(&outcome, key);
        assert!(
            (value - truth).abs() <= slack,
            "{key} = {value}, truth {truth}"
        );
    };
    near("limits.braking_mps2", 0.5, 0.03);
    // The adapter has set 58 deg/s2, the next whole degree.
    near("limits.angular_braking_radps2", 58_f64.to_radians(), 0.06);
    near("host_death.watchdog_s", 2.0, 0.1);
    near("host_death.braking_mps2", 0.5, 0.03);
    assert!(value(&outcome, "timing.actuation_latency_s") < 0.1);
    assert!(outcome.notes.iter().any(|note| note.contains("tracking_m")));
}

#[test]
fn the_emulated_car_is_measured_as_it_is() {
    let outcome = figures(&CarBench { stx: true }, "pses_car", 0.6);
    assert!((value(&outcome, "host_death.watchdog_s") - 0.2).abs() < 0.15);
    assert!((value(&outcome, "host_death.braking_mps2") - 0.3).abs() < 0.06);
    assert!(
        !outcome
            .figures
            .iter()
            .any(|figure| figure.key.contains("angular"))
    );
}

/// A driven turn to each side, the true turn from outside: the factor comes back.
#[test]
fn the_skid_factor_is_measured_by_turning() {
    for skid in [0.55, 0.8, 1.0] {
        let wheels = Wheels::VelRvel;
        // The robot skids, and nobody has told its adapter.
        let mut rig = Rig::new(&SeekurBench { wheels, skid: 1.0 }, None);
        rig.robot = SeekurBench { wheels, skid }.robot(rig.now);
        let platform = std::cell::RefCell::new(Virtual(rig));
        let mut before = 0.0;
        let mut told = Vec::new();
        let fit = {
            let mut shared = Shared(&platform);
            measure::skid(&mut shared, 0.4, |wheels| {
                let truth = platform.borrow().0.robot.truth().pose[2];
                told.push(wheels);
                let turned = truth - before;
                before = truth;
                Some(turned)
            })
        };
        let fit = fit.unwrap().unwrap();
        assert!((fit.factor - skid).abs() < 0.005, "{skid}: {fit:?}");
        assert!(told[0] > 12.0 && told[1] < -12.0, "{told:?}");
    }
}

/// A platform that is looked at while it is measured.
struct Shared<'a>(&'a std::cell::RefCell<Virtual>);

impl Platform for Shared<'_> {
    fn drive(&mut self, linear: f64, turn: f64, span_s: f64) -> Result<Vec<Sample>, String> {
        self.0.borrow_mut().drive(linear, turn, span_s)
    }

    fn silence(&mut self, span_s: f64) -> Vec<Sample> {
        self.0.borrow_mut().silence(span_s)
    }

    fn recover(&mut self) -> Result<(), String> {
        self.0.borrow_mut().recover()
    }

    fn now_s(&self) -> f64 {
        self.0.borrow().now_s()
    }
}

#[test]
fn a_file_that_promises_more_than_the_robot_does_is_told_so() {
    let bench = SeekurBench {
        wheels: Wheels::VelRvel,
        skid: 1.0,
    };
    let (_, text) = haltline_robots::EMBEDDED
        .iter()
        .find(|(name, _)| *name == "seekur_jr")
        .unwrap();
    let bold = text.replacen("braking_mps2 = 0.5 ", "braking_mps2 = 0.9 ", 1);
    let robot = Robot::parse(&bold, "bold.toml").unwrap();
    let outcome = measure::run(&robot, &mut Virtual(Rig::new(&bench, None)), 0.6).unwrap();
    let braking = outcome
        .figures
        .iter()
        .find(|f| f.key == "limits.braking_mps2")
        .unwrap();
    assert!(!braking.holds);
    assert!(
        braking.to_string().contains("NOT on the safe side"),
        "{braking}"
    );
}

#[test]
fn ramps_are_fitted_where_they_are_straight() {
    let samples: Vec<Sample> = (0..200)
        .map(|index| {
            let at_s = f64::from(index) * 0.02;
            let v = (0.8 - 0.5 * (at_s - 0.7)).clamp(0.0, 0.8);
            Sample {
                at_s,
                pose: [0.0; 3],
                twist: [v, 0.0],
            }
        })
        .collect();
    let fit = ramp(&samples, 0, 0.8, 0.0).unwrap();
    assert!(
        (fit.begin_s - 0.7).abs() < 1e-9 && (fit.rate + 0.5).abs() < 1e-9,
        "{fit:?}"
    );
    assert!(
        ramp(&samples, 1, 0.8, 0.0).is_some_and(|fit| fit.samples == 0)
            || ramp(&samples, 1, 0.8, 0.0).is_none()
    );
    assert!(ramp(&samples[..40], 0, 0.8, 0.0).is_none(), "not complete");
    let spread = Spread::of(&[1.0, 2.0, 3.0]).unwrap();
    assert!((spread.mean - 2.0).abs() < 1e-12 && (spread.deviation - 1.0).abs() < 1e-12);
    assert!(Spread::of(&[1.0]).is_none());
}
