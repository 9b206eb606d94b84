//! The thesis' filters with dense matrices: EKF, UKF, and one step of each.
//!
//! For comparison only. It keeps the kernel filter's time, gate and frame rules, but refuses
//! nothing else: no recovery, no removal, no bound on the markers, and it allocates.
//!
//! # Source
//! Loh 2018, 3.15, 3.16, algorithms 3.1 and 3.2, appendix A.1 (weights corrected); the mixture
//! is the thesis' suggestion at the end of 3.2.2.

mod frame;
mod moments;
mod sigma;

pub use sigma::{Spread, Weights};

use haltline::marker::{
    Cycle, FilterRules, Frame, FrameReport, FrameVerdict, Health, Increment, MarkerEstimate,
    MarkerFilter, Pose2, Prediction, Record, Verdict,
};
use haltline::time::Instant;
use moments::Measurement;
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
