//! Feeds a data set to the kernel's marker filter in the order of time.

use crate::failure::Failure;
use haltline::marker::{
    FRAME_MAX, FilterRules, Frame, FrameVerdict, Health, Increment, MarkerEkf, MarkerFilter,
    OdometryNoise, Pose2, Prediction, Sighting, SightingNoise, Verdict,
};
use haltline::time::{Duration, Instant};
use haltline_logs::mrclam::{Command, DataSet, Measurement, ROBOTS};
use serde::Serialize;
use std::time::Instant as WallClock;

/// Room for more landmarks than the data sets have; none is known beforehand.
pub type Filter = MarkerEkf<32, 1>;

/// A command holds at most this long; in a longer gap nobody knows what the robot did, s.
const HOLD_S: f64 = 1.0;
/// Standard deviation of a range: this, m, plus [`RANGE_PART`] of it.
const RANGE_SIGMA_M: f64 = 0.05;
/// See [`RANGE_SIGMA_M`].
const RANGE_PART: f64 = 0.04;
/// Standard deviation of a bearing, rad.
const BEARING_SIGMA_RAD: f64 = 0.03;

/// What became of the measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// All of them.
    pub measurements: usize,
    /// Of barcodes that nobody wears.
    pub unknown_barcodes: usize,
    /// Of other robots, which move.
    #[serde(rename = "other_robots")]
    pub robots: usize,
    /// Ranges or bearings that cannot be.
    pub malformed: usize,
    /// Corrected the state.
    pub fused: usize,
    /// Began a landmark.
    pub added: usize,
    /// Outside the gate.
    pub gated: usize,
    /// Outside the gate once too often: the landmark was dropped.
    pub removed: usize,
    /// The rest: ambiguous, postponed, or a second frame between two odometry samples.
    pub unused: usize,
    /// Times a pose was taken over from sightings that agree.
    pub relocated: usize,
    /// Odometry samples after more than a second of silence.
    pub odometry_gaps: usize,
}

/// The estimate after an odometry sample and the frames that follow it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Unix time, s.
    pub time_s: f64,
    /// Estimated pose.
    pub pose: Pose2,
    /// By odometry alone.
    pub dead_reckoning: Pose2,
}

/// A whole drive.
pub struct Course {
    /// One per odometry sample.
    pub samples: Vec<Sample>,
    /// What became of the measurements.
    pub counts: Counts,
    /// The filter at the end.
    pub filter: Box<Filter>,
    /// Wall time of each correction, µs.
    pub wall_us: Vec<f64>,
    /// Whether the filter was lost at the end.
    pub lost: bool,
}

/// Runs the filter from the true start; the landmarks are unknown.
///
/// # Errors
/// The start pose cannot be used.
pub fn drive(data: &DataSet, start: Pose2, tick: impl Fn()) -> Result<Course, Failure> {
    let filter = Filter::new(rules(), start, [1e-6, 1e-6, 1e-6]).map_err(|error| {
        Failure::input(format!("the first true pose cannot be used: {error:?}"))
    })?;
    let mut course = Course {
        samples: Vec::with_capacity(data.commands.len()),
        counts: Counts {
            measurements: data.measurements.len(),
            ..Counts::default()
        },
        filter: Box::new(filter),
        wall_us: Vec::new(),
        lost: false,
    };
    let begin_s = data.commands[0].time_s;
    let mut waiting = data.measurements.iter().peekable();
    // What was seen before the first odometry has no pose to belong to.
    while waiting.next_if(|seen| seen.time_s < begin_s).is_some() {
        course.counts.unused += 1;
    }
    let mut reckoned = start;
    let mut before: Option<&Command> = None;
    for (index, command) in data.commands.iter().enumerate() {
        let moved = before.map_or_else(Increment::default, |held| course.moved(held, command));
        reckoned = reckoned.then(&Pose2::new(moved.forward_m, moved.left_m, moved.turn_rad));
        let predicted = course
            .filter
            .predict(stamp(command.time_s, begin_s), &moved);
        if predicted == Prediction::Reordered {
            // Two commands of one moment: the later one holds.
            before = Some(command);
            continue;
        }
        let until_s = data
            .commands
            .get(index + 1)
            .map_or(f64::INFINITY, |next| next.time_s);
        while let Some(first) = waiting.next_if(|seen| seen.time_s < until_s) {
            let mut frame = vec![*first];
            while let Some(more) = waiting.next_if(|seen| seen.time_s <= first.time_s) {
                frame.push(*more);
            }
            course.see(data, &frame, begin_s);
        }
        course.samples.push(Sample {
            time_s: command.time_s,
            pose: course.filter.pose(),
            dead_reckoning: reckoned,
        });
        before = Some(command);
        tick();
    }
    course.lost = matches!(course.filter.health(), Health::Lost(_));
    Ok(course)
}

/// Commands say what was wanted, not what was done: generous noise.
fn rules() -> FilterRules {
    FilterRules {
        odometry: OdometryNoise {
            along_m2_per_m: 2e-3,
            across_m2_per_m: 2e-4,
            heading_rad2_per_m: 5e-3,
            heading_rad2_per_rad: 1e-2,
            position_m2_per_sample: 1e-8,
            heading_rad2_per_sample: 1e-8,
        },
        frame_age: Duration::from_ms(1000),
        ..FilterRules::default()
    }
}

/// Log time as kernel time; an hour is added so that nothing lies before the origin.
fn stamp(time_s: f64, begin_s: f64) -> Instant {
    let us = ((time_s - begin_s + 3600.0) * 1e6).round().max(0.0);
    Instant::from_us(us as u64)
}

impl Course {
    /// Motion from one command to the next.
    fn moved(&mut self, held: &Command, next: &Command) -> Increment {
        let span_s = next.time_s - held.time_s;
        if span_s > HOLD_S {
            self.counts.odometry_gaps += 1;
            self.doubt(held, span_s);
        }
        let span_s = span_s.min(HOLD_S);
        Increment::arc(held.speed_mps * span_s, held.turn_radps * span_s)
    }

    /// Nobody knows what the robot did in a gap: anything up to what it did before.
    fn doubt(&mut self, held: &Command, span_s: f64) {
        let way_m2 = (held.speed_mps.abs().max(0.1) * span_s).powi(2);
        let turn_rad2 = (held.turn_radps.abs().max(0.1) * span_s).powi(2);
        let [[x, ..], [_, y, _], [.., turn]] = self.filter.pose_covariance();
        let grown = [x + way_m2, y + way_m2, turn + turn_rad2].map(|v| v.min(1e3));
        // A pose that the filter holds itself is one that it takes.
        let placed = self.filter.place(self.filter.pose(), grown);
        debug_assert!(placed.is_ok());
    }

    /// Measurements of one moment as one frame.
    fn see(&mut self, data: &DataSet, measurements: &[Measurement], begin_s: f64) {
        let sightings: Vec<Sighting> = measurements
            .iter()
            .filter_map(|measurement| self.sighting(data, measurement))
            .collect();
        let stamp = stamp(measurements[0].time_s, begin_s);
        for part in sightings.chunks(FRAME_MAX) {
            let start = WallClock::now();
            let report = self.filter.correct(&Frame {
                camera: 0,
                stamp,
                sightings: part,
            });
            self.wall_us.push(start.elapsed().as_secs_f64() * 1e6);
            let counts = &mut self.counts;
            counts.relocated += usize::from(report.relocated);
            if report.verdict != FrameVerdict::Used {
                counts.unused += part.len();
            }
            for record in report.records() {
                *match record.verdict {
                    Verdict::Fused => &mut counts.fused,
                    Verdict::Added => &mut counts.added,
                    Verdict::Gated => &mut counts.gated,
                    Verdict::Removed => &mut counts.removed,
                    Verdict::Malformed => &mut counts.malformed,
                    Verdict::Ambiguous | Verdict::Unknown | Verdict::Postponed | Verdict::Full => {
                        &mut counts.unused
                    }
                } += 1;
            }
        }
    }

    /// A landmark's position in the robot frame; `None`, and counted, for everything else.
    fn sighting(&mut self, data: &DataSet, measurement: &Measurement) -> Option<Sighting> {
        let Some(subject) = data.subjects.get(&measurement.barcode) else {
            self.counts.unknown_barcodes += 1;
            return None;
        };
        if *subject <= ROBOTS {
            self.counts.robots += 1;
            return None;
        }
        let (range, bearing) = (measurement.range_m, measurement.bearing_rad);
        let (sin, cos) = bearing.sin_cos();
        let (x_m, y_m) = (range * cos, range * sin);
        let range_sigma_m = RANGE_SIGMA_M + RANGE_PART * range.abs();
        let noise = SightingNoise::range_bearing(x_m, y_m, range_sigma_m, BEARING_SIGMA_RAD);
        if range <= 0.0 {
            self.counts.malformed += 1;
            return None;
        }
        Some(Sighting::position(*subject, x_m, y_m, noise))
    }
}
