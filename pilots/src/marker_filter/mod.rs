//! The thesis' filters with dense matrices: EKF, UKF, and one step of each.
//!
//! For comparison only. It keeps the kernel filter's time, gate and frame rules, but refuses
//! nothing else: no recovery, no removal, no bound on the markers, and it allocates.
//!
//! # Source
//! Loh 2018, 3.15, 3.16, algorithms 3.1 and 3.2, appendix A.1 (weights corrected); the mixture
//! is the thesis' suggestion at the end of 3.2.2.

mod moments;
mod sigma;

pub use sigma::{Spread, Weights};

use haltline::marker::{
    Cycle, FRAME_MAX, FilterRules, Frame, FrameReport, FrameVerdict, Health, Increment,
    MarkerEstimate, MarkerFilter, Pose2, Prediction, Record, Sighting, Verdict, wrap,
};
use haltline::time::Instant;
use moments::{Measurement, Moments, Target};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// How a nonlinear function is passed by a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// By its derivative: EKF.
    Linear,
    /// By sigma points: UKF.
    Unscented(Spread),
}

/// What a new marker is correlated with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Augmentation {
    /// With the robot that placed it, and through it with everything.
    Full,
    /// With nothing: Loh 3.19 as printed. Overconfident; for a test that shows it.
    Printed,
}

/// Which filter to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Passing the motion.
    pub prediction: Rule,
    /// Passing a frame's sightings.
    pub correction: Rule,
    /// Entering new markers.
    pub augmentation: Augmentation,
}

impl Method {
    /// The textbook EKF.
    pub const EKF: Self = Self {
        prediction: Rule::Linear,
        correction: Rule::Linear,
        augmentation: Augmentation::Full,
    };
    /// The thesis' UKF.
    pub const UKF: Self = Self {
        prediction: Rule::Unscented(Spread::THESIS),
        correction: Rule::Unscented(Spread::THESIS),
        augmentation: Augmentation::Full,
    };
    /// Predicts as the UKF and corrects as the EKF.
    pub const MIXED: Self = Self {
        correction: Rule::Linear,
        ..Self::UKF
    };
}

/// A marker filter with dense matrices of any size.
#[derive(Clone, Debug)]
pub struct DenseFilter {
    method: Method,
    rules: FilterRules,
    cycle: Cycle,
    /// [robot, marker, marker, ...], three numbers each.
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Ids of the markers in the state, with the number of sightings fused.
    learned: Vec<(u16, u16)>,
    mapped: Vec<(u16, Pose2)>,
}

/// A sighting moved to the moment of the last odometry.
struct Seen {
    pose: Vector3<f64>,
    noise: Matrix3<f64>,
}

impl DenseFilter {
    /// A filter at `start`, with these variances of x, y (m²) and heading (rad²).
    #[must_use]
    pub fn new(method: Method, rules: FilterRules, start: Pose2, variances: [f64; 3]) -> Self {
        Self {
            method,
            rules,
            cycle: Cycle::default(),
            mean: DVector::from_row_slice(vector(&start).as_slice()),
            covariance: DMatrix::from_diagonal(&DVector::from_row_slice(&variances)),
            learned: Vec::new(),
            mapped: Vec::new(),
        }
    }

    /// Enters a marker whose pose is known exactly; a second entry of an id is ignored.
    pub fn add_mapped(&mut self, id: u16, pose: Pose2) {
        self.mapped.push((id, pose));
    }

    fn learned_at(&self, id: u16) -> Option<usize> {
        let slot = self.learned.iter().position(|(known, _)| *known == id)?;
        Some(3 + 3 * slot)
    }

    fn mapped_at(&self, id: u16) -> Option<Pose2> {
        let found = self.mapped.iter().find(|(known, _)| *known == id)?;
        Some(found.1)
    }

    fn block(&self, at: usize) -> Vector3<f64> {
        self.mean.fixed_rows::<3>(at).into_owned()
    }

    fn moved(&self, carry: &Pose2, sighting: &Sighting) -> Seen {
        let heading = sighting.heading_rad.unwrap_or_default();
        let pose = carry.then(&Pose2::new(sighting.x_m, sighting.y_m, heading));
        let turn = rotation(carry.heading_rad);
        let n = sighting.noise;
        let r = Matrix3::new(
            n.xx_m2,
            n.xy_m2,
            0.0,
            n.xy_m2,
            n.yy_m2,
            0.0,
            0.0,
            0.0,
            n.heading_rad2,
        );
        Seen {
            pose: vector(&pose),
            noise: turn * r * turn.transpose(),
        }
    }

    /// One sighting as a measurement of the state; `None` for markers nobody knows.
    fn measurement(&self, sighting: &Sighting, seen: &Seen) -> Option<Measurement> {
        let marker = match self.learned_at(sighting.id) {
            Some(at) => Target::Learned(at),
            None => Target::Mapped(self.mapped_at(sighting.id)?),
        };
        Some(Measurement {
            marker,
            seen: seen.pose,
            noise: seen.noise,
            numbers: if sighting.heading_rad.is_some() { 3 } else { 2 },
        })
    }

    fn judge(&self, sighting: &Sighting, measurement: &Measurement) -> Record {
        let single = [*measurement];
        let moments = self.expected(&single);
        let innovation = moments.innovation(&single);
        let solved = moments.spread.clone().lu().solve(&innovation);
        let nis = solved.map_or(f64::INFINITY, |solved| innovation.dot(&solved));
        let gate = if measurement.numbers == 3 {
            self.rules.gate_pose
        } else {
            self.rules.gate_position
        };
        let verdict = if nis <= gate {
            Verdict::Fused
        } else {
            Verdict::Gated
        };
        let mut record = Record::unjudged(sighting, verdict);
        for row in 0..measurement.numbers {
            record.innovation[row] = innovation[row];
            for column in 0..measurement.numbers {
                record.covariance[row][column] = moments.spread[(row, column)];
            }
        }
        Record { nis, ..record }
    }

    fn expected(&self, measurements: &[Measurement]) -> Moments {
        match self.method.correction {
            Rule::Linear => Moments::linear(&self.mean, &self.covariance, measurements),
            Rule::Unscented(spread) => {
                Moments::unscented(spread, &self.mean, &self.covariance, measurements)
            }
        }
    }

    /// Corrects by all measurements at once; false if the result were not positive.
    fn absorb(&mut self, measurements: &[Measurement]) -> bool {
        if measurements.is_empty() {
            return true;
        }
        let moments = self.expected(measurements);
        let innovation = moments.innovation(measurements);
        let Some(inverse) = moments.spread.clone().try_inverse() else {
            return false;
        };
        let gain = &moments.cross * inverse;
        let less = &self.covariance - &gain * &moments.spread * gain.transpose();
        let covariance = (&less + less.transpose()) * 0.5;
        if covariance.clone().cholesky().is_none() {
            return false;
        }
        self.covariance = covariance;
        self.mean += gain * innovation;
        self.wrap_headings();
        true
    }

    fn wrap_headings(&mut self) {
        for at in (2..self.mean.len()).step_by(3) {
            self.mean[at] = wrap(self.mean[at]);
        }
    }

    fn append(&mut self, sighting: &Sighting, seen: &Seen) {
        let n = self.mean.len();
        let robot = pose(&self.block(0));
        let placed = robot.then(&pose(&seen.pose));
        let (dx, dy) = (placed.x_m - robot.x_m, placed.y_m - robot.y_m);
        let by_robot = Matrix3::new(1.0, 0.0, -dy, 0.0, 1.0, dx, 0.0, 0.0, 1.0);
        let turn = rotation(robot.heading_rad);
        let mut noise = seen.noise;
        if sighting.heading_rad.is_none() {
            noise[(2, 2)] = 10.0;
        }
        let mut grow = DMatrix::zeros(n + 3, n);
        grow.view_mut((0, 0), (n, n)).fill_with_identity();
        if self.method.augmentation == Augmentation::Full {
            grow.view_mut((n, 0), (3, 3)).copy_from(&by_robot);
        }
        let mut covariance = &grow * &self.covariance * grow.transpose();
        let mut own = covariance.view_mut((n, n), (3, 3));
        own += turn * noise * turn.transpose();
        self.covariance = covariance;
        let all = self
            .mean
            .iter()
            .chain(vector(&placed).iter())
            .copied()
            .collect();
        self.mean = DVector::from_vec(all);
        self.learned.push((sighting.id, 1));
    }

    /// Judges a frame's sightings at the prior; of several with one id at most one is taken.
    fn judge_all(&self, frame: &Frame<'_>, report: &mut FrameReport) -> Vec<(usize, Measurement)> {
        let carry = self.cycle.carry(frame.stamp);
        let mut fits = Vec::new();
        for (index, sighting) in frame.sightings.iter().take(FRAME_MAX).enumerate() {
            let seen = self.moved(&carry, sighting);
            let Some(measurement) = self.measurement(sighting, &seen) else {
                report.set(index, Record::unjudged(sighting, Verdict::Unknown));
                continue;
            };
            let record = self.judge(sighting, &measurement);
            report.set(index, record);
            if record.verdict == Verdict::Fused {
                fits.push((index, measurement));
            }
        }
        fits
    }

    /// Takes back what has a twin in the same frame.
    fn single_out(
        frame: &Frame<'_>,
        report: &mut FrameReport,
        fits: &mut Vec<(usize, Measurement)>,
    ) {
        let candidates: Vec<(usize, u16)> = report
            .records()
            .enumerate()
            .filter(|(_, r)| matches!(r.verdict, Verdict::Fused | Verdict::Unknown))
            .map(|(index, r)| (index, r.id))
            .collect();
        for (index, id) in &candidates {
            if candidates.iter().filter(|(_, other)| other == id).count() > 1 {
                report.set(
                    *index,
                    Record::unjudged(&frame.sightings[*index], Verdict::Ambiguous),
                );
                fits.retain(|(fit, _)| fit != index);
            }
        }
    }

    fn learn(&mut self, frame: &Frame<'_>, report: &mut FrameReport) {
        let carry = self.cycle.carry(frame.stamp);
        for (index, sighting) in frame.sightings.iter().take(FRAME_MAX).enumerate() {
            let verdict = report.record(index).map(|record| record.verdict);
            if verdict == Some(Verdict::Unknown) && self.rules.learn {
                let seen = self.moved(&carry, sighting);
                self.append(sighting, &seen);
                report.set(index, Record::unjudged(sighting, Verdict::Added));
            }
        }
    }
}

impl MarkerFilter for DenseFilter {
    fn predict(&mut self, stamp: Instant, increment: &Increment) -> Prediction {
        if !self.cycle.is_news(stamp) {
            return Prediction::Reordered;
        }
        let variances = moments::odometry_variances(&self.rules.odometry, increment);
        let (mean, covariance) = match self.method.prediction {
            Rule::Linear => moments::move_linear(&self.mean, &self.covariance, increment),
            Rule::Unscented(spread) => {
                moments::move_unscented(spread, &self.mean, &self.covariance, increment)
            }
        };
        let heading = self.mean[2];
        self.mean = mean;
        self.covariance = covariance;
        let mut own = self.covariance.view_mut((0, 0), (3, 3));
        own += moments::odometry_noise(heading, increment, variances);
        self.wrap_headings();
        self.cycle.begin(stamp, increment);
        Prediction::Done
    }

    fn correct(&mut self, frame: &Frame<'_>) -> FrameReport {
        let verdict = self.cycle.admit(frame, self.rules.frame_age);
        let mut report = FrameReport::new(frame, verdict);
        if verdict != FrameVerdict::Used {
            return report;
        }
        self.cycle.corrected(frame);
        let mut fits = self.judge_all(frame, &mut report);
        Self::single_out(frame, &mut report, &mut fits);
        let measurements: Vec<Measurement> = fits.iter().map(|(_, fit)| *fit).collect();
        if self.absorb(&measurements) {
            for (index, _) in &fits {
                let id = frame.sightings[*index].id;
                if let Some((_, count)) = self.learned.iter_mut().find(|(known, _)| *known == id) {
                    *count = count.saturating_add(1);
                }
            }
        } else {
            for (index, _) in &fits {
                report.set(
                    *index,
                    Record::unjudged(&frame.sightings[*index], Verdict::Malformed),
                );
            }
        }
        self.learn(frame, &mut report);
        report
    }

    fn pose(&self) -> Pose2 {
        pose(&self.block(0))
    }

    fn pose_covariance(&self) -> [[f64; 3]; 3] {
        block_of(&self.covariance, 0)
    }

    fn marker(&self, id: u16) -> Option<MarkerEstimate> {
        if let Some(pose) = self.mapped_at(id) {
            return Some(MarkerEstimate {
                pose,
                covariance: [[0.0; 3]; 3],
                oriented: true,
                sightings: 0,
            });
        }
        let at = self.learned_at(id)?;
        let (_, sightings) = self.learned[at / 3 - 1];
        Some(MarkerEstimate {
            pose: pose(&self.block(at)),
            covariance: block_of(&self.covariance, at),
            oriented: true,
            sightings,
        })
    }

    fn health(&self) -> Health {
        Health::Tracking
    }
}

fn block_of(matrix: &DMatrix<f64>, at: usize) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(at + row, at + column)]))
}

pub(crate) fn vector(pose: &Pose2) -> Vector3<f64> {
    Vector3::new(pose.x_m, pose.y_m, pose.heading_rad)
}

pub(crate) fn pose(v: &Vector3<f64>) -> Pose2 {
    Pose2::new(v[0], v[1], v[2])
}

pub(crate) fn rotation(heading_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = heading_rad.sin_cos();
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}
