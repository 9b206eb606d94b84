//! A robot on a link, driven without a guard for as long as it is measured.

use std::io::{self, Write};
use std::time::Duration as Wall;

use haltline::convert;
use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::Reading;
use haltline::time::{Duration, Instant};

use super::{Platform, Sample};
use crate::clock::Clock;
use crate::drive::{Drive, State};
use crate::link::Link;

/// How long a drive may take to come to obey.
const PATIENCE: Duration = Duration::from_ms(15_000);

/// Adapter, link and clock.
pub struct Live {
    drive: Box<dyn Drive>,
    link: Box<dyn Link>,
    clock: Clock,
    period: Duration,
    steered: bool,
    unsent: Vec<u8>,
    log: Option<Box<dyn Write>>,
}

impl Live {
    /// A platform that sends a set point every `period`.
    #[must_use]
    pub fn new(
        drive: Box<dyn Drive>,
        link: Box<dyn Link>,
        clock: Clock,
        period: Duration,
        steered: bool,
    ) -> Self {
        Self {
            drive,
            link,
            clock,
            period,
            steered,
            unsent: Vec::new(),
            log: None,
        }
    }

    /// Writes what is told and fed back to `out`, a line for each feedback (CSV).
    ///
    /// # Errors
    /// Those of `out`.
    pub fn log_to(&mut self, mut out: Box<dyn Write>) -> io::Result<()> {
        writeln!(
            out,
            "# t_s,told_mps,told_turn,x_m,y_m,theta_rad,v_mps,w_radps  (told: - where nothing is said)"
        )?;
        self.log = Some(out);
        Ok(())
    }

    fn note(&mut self, sample: &Sample, told: Option<[f64; 2]>) -> io::Result<()> {
        let Some(out) = &mut self.log else {
            return Ok(());
        };
        let told = told.map_or("-,-".to_owned(), |[v, turn]| format!("{v:.4},{turn:.4}"));
        let [x, y, theta] = sample.pose;
        let [v, w] = sample.twist;
        let at_s = sample.at_s;
        writeln!(
            out,
            "{at_s:.4},{told},{x:.4},{y:.4},{theta:.5},{v:.4},{w:.5}"
        )
    }

    fn decision(&self, linear: f64, turn: f64, now: Instant) -> Option<Decision> {
        let command = if self.steered {
            convert::arc_command(now, linear, turn)
        } else {
            convert::twist_command(now, linear, turn)
        };
        let Reading::Value(command) = command else {
            return None;
        };
        Some(Decision {
            action: Action::Pass,
            setpoint: command.motion,
            reason: Reason::None,
            status: StopStatus::Running,
            expires: now.plus(self.period).plus(self.period),
            verdict: None,
            factor_permille: 1000,
        })
    }

    /// Serves the wire for `span`; `speak` is what is said every period, if anything.
    fn serve(&mut self, span: Duration, speak: Option<[f64; 2]>) -> Result<Vec<Sample>, String> {
        let mut samples = Vec::new();
        let start = self.clock.now();
        let (end, mut due) = (start.plus(span), start);
        while self.clock.now() < end {
            let now = self.clock.now();
            let mut heard = Vec::new();
            self.link
                .read(&mut heard)
                .map_err(|error| error.to_string())?;
            self.drive.receive(&heard, now);
            if let Some(feedback) = self.drive.feedback() {
                let sample = Sample {
                    at_s: seconds(feedback.stamp),
                    pose: feedback.pose,
                    twist: feedback.twist,
                };
                self.note(&sample, speak)
                    .map_err(|error| format!("the log: {error}"))?;
                samples.push(sample);
            }
            if let Some([linear, turn]) = speak {
                if now >= due {
                    due = now.plus(self.period);
                    if let Some(decision) = self.decision(linear, turn, now) {
                        // A refusal shows in the samples, which then do not move.
                        let _ = self.drive.send(&decision, now);
                    }
                }
                self.drive.tick(now);
                self.write(now)?;
            }
            std::thread::sleep(Wall::from_millis(1));
        }
        Ok(samples)
    }

    fn write(&mut self, now: Instant) -> Result<(), String> {
        let mut room = [0; 512];
        let count = self.drive.outgoing(&mut room, now);
        self.unsent
            .extend_from_slice(room.get(..count).unwrap_or_default());
        let written = self
            .link
            .write(&self.unsent)
            .map_err(|error| error.to_string())?;
        self.unsent.drain(..written);
        Ok(())
    }
}

fn seconds(at: Instant) -> f64 {
    at.as_us() as f64 * 1e-6
}

impl Platform for Live {
    fn drive(&mut self, linear: f64, turn: f64, span_s: f64) -> Result<Vec<Sample>, String> {
        let span = convert::duration(span_s, convert::Round::Nearest).unwrap_or_default();
        self.serve(span, Some([linear, turn]))
    }

    fn silence(&mut self, span_s: f64) -> Vec<Sample> {
        let span = convert::duration(span_s, convert::Round::Nearest).unwrap_or_default();
        self.serve(span, None).unwrap_or_default()
    }

    fn recover(&mut self) -> Result<(), String> {
        let start = self.clock.now();
        let mut newest = None;
        while self.clock.now().since(start).unwrap_or_default() < PATIENCE {
            let samples = self.serve(Duration::from_ms(50), Some([0.0, 0.0]))?;
            newest = samples.last().copied().or(newest);
            let now = self.clock.now();
            let rests = newest.is_some_and(|sample| sample.twist.iter().all(|v| v.abs() < 5e-3));
            match self.drive.state() {
                State::Disabled => self.drive.enable(now),
                State::Driving if rests => return Ok(()),
                _ => {}
            }
        }
        let fault = self
            .drive
            .fault()
            .map_or(String::new(), |fault| format!(": {fault}"));
        Err(format!("the drive does not come to obey{fault}"))
    }

    fn now_s(&self) -> f64 {
        seconds(self.clock.now())
    }
}
