//! A simulated SICK LMS1xx: looks into a world and speaks CoLa ASCII.

use std::f64::consts::FRAC_PI_2;

use haltline::time::{Duration, Instant};
use haltline_robots::Scanner as Mount;
use haltline_scenarios::math::Pose;
use haltline_scenarios::raycast::{Ray, cast};
use haltline_scenarios::world::World;

use super::Truth;
use crate::cola::{self, Deframer, Header, frame_into, header_text};

/// Farther returns are too faint.
const SIGHT_M: f64 = 50.0;

/// The scanner of an emulated robot.
pub struct Scanner {
    mount: Mount,
    period: Duration,
    next: Instant,
    started: Instant,
    deframer: Deframer,
    streaming: bool,
    scans: u16,
    out: Vec<u8>,
}

impl Scanner {
    /// A scanner mounted and timed as the robot file says, switched on at `now`.
    #[must_use]
    pub fn new(mount: Mount, now: Instant) -> Self {
        let period_us = (1e6 / mount.rate_hz.max(1.0)) as u64;
        Self {
            mount,
            period: Duration::from_us(period_us),
            next: now,
            started: now,
            deframer: Deframer::default(),
            streaming: false,
            scans: 0,
            out: Vec::new(),
        }
    }

    /// Takes bytes from a host.
    pub fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let Some(Ok(text)) = self.deframer.push(*byte) else {
                continue;
            };
            let answer = match text {
                cola::STREAM_START | cola::STREAM_STOP => {
                    self.streaming = text == cola::STREAM_START;
                    text.replacen("sEN", "sEA", 1)
                }
                // Log-in, configuration, start of measurement: understood as done.
                _ if text.starts_with("sMN ") => {
                    format!("sAN {} 1", text.split(' ').nth(1).unwrap_or_default())
                }
                _ => "sFA 1".to_owned(),
            };
            frame_into(&answer, |part| self.out.extend_from_slice(part));
        }
    }

    /// The host is gone: nothing is streamed to the next one until it asks.
    pub fn disconnected(&mut self) {
        self.streaming = false;
        self.deframer = Deframer::default();
    }

    /// Looks around if a sweep is due at `now`; the sweep began one scan time earlier.
    pub fn step(&mut self, world: &World, truth: &Truth, now: Instant, time_s: f64) {
        if now < self.next {
            return;
        }
        self.next = now.plus(self.period);
        self.scans = self.scans.wrapping_add(1);
        if !self.streaming {
            return;
        }
        let sweep_us = (self.mount.scan_time_s * 1e6) as u64;
        let micros = |at: Instant| at.since(self.started).unwrap_or_default().as_us() as u32;
        let step_rad = self.mount.beam_angle_rad();
        let tenthousandth = |rad: f64| (rad.to_degrees() * 1e4).round();
        let header = Header {
            status: 0,
            telegrams: self.scans,
            scans: self.scans,
            start_us: micros(now.minus(Duration::from_us(sweep_us))),
            sent_us: micros(now),
            frequency_chz: (self.mount.rate_hz * 100.0) as u32,
            start_angle: tenthousandth(FRAC_PI_2 - self.mount.field_of_view_rad / 2.0) as i32,
            step: tenthousandth(step_rad) as u16,
            count: self.mount.beams,
        };
        let mut text = String::with_capacity(4096);
        if header_text(&header, true, &mut text).is_err() {
            return;
        }
        for beam in 0..self.mount.beams {
            let range_mm = self.range_mm(world, truth, beam, time_s);
            text.push_str(&format!(" {range_mm:X}"));
        }
        text.push_str(" 0 0 0 0 0 0");
        frame_into(&text, |part| self.out.extend_from_slice(part));
    }

    /// Range of one beam, mm, each from where the robot was at that beam's time; 0 without a return.
    fn range_mm(&self, world: &World, truth: &Truth, beam: u16, time_s: f64) -> u16 {
        let mount = &self.mount;
        let last = f64::from(mount.beams.saturating_sub(1).max(1));
        let back_s = mount.scan_time_s * (1.0 - f64::from(beam) / last);
        let [x, y, theta] = truth.pose;
        let [v, omega] = truth.twist;
        let then = theta - omega * back_s;
        let robot = Pose::new(
            x - v * back_s * (theta - omega * back_s / 2.0).cos(),
            y - v * back_s * (theta - omega * back_s / 2.0).sin(),
            then,
        );
        let origin = robot.then(Pose::new(mount.x_m, mount.y_m, 0.0));
        let bearing = mount.first_beam_rad() + f64::from(beam) * mount.increment_rad();
        let ray = Ray::new([origin.x, origin.y], origin.theta + bearing);
        // What is beyond the stated range is measured all the same; the host knows its limit.
        match cast(world, time_s - back_s, &ray, SIGHT_M) {
            Some(hit) if hit.range >= mount.range_min_m => (hit.range * 1e3).round() as u16,
            _ => 0,
        }
    }

    /// Bytes for the host since the last call.
    pub fn outgoing(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.out)
    }
}
