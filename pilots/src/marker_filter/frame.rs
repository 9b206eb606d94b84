//! One frame with dense matrices: judged at the prior, absorbed at once, new markers appended.

use super::moments::{Measurement, Moments, Target};
use super::{Augmentation, DenseFilter, Rule, pose, rotation, vector};
use haltline::marker::{FRAME_MAX, Frame, FrameReport, Pose2, Record, Sighting, Verdict, wrap};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// A sighting moved to the moment of the last odometry.
struct Seen {
    pose: Vector3<f64>,
    noise: Matrix3<f64>,
}

impl DenseFilter {
    fn moved(&self, carry: &Pose2, sighting: &Sighting) -> Seen {
        let heading = sighting.heading_rad.unwrap_or_default();
        let pose = carry.then(&Pose2::new(sighting.x_m, sighting.y_m, heading));
        let turn = rotation(carry.heading_rad);
        let r = Matrix3::from(sighting.noise.matrix(true));
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
    pub(super) fn absorb(&mut self, measurements: &[Measurement]) -> bool {
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

    pub(super) fn wrap_headings(&mut self) {
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
    pub(super) fn judge_all(
        &self,
        frame: &Frame<'_>,
        report: &mut FrameReport,
    ) -> Vec<(usize, Measurement)> {
        // Admitted, so there is one.
        let carry = self.cycle.carry(frame.stamp).unwrap_or_default();
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
    pub(super) fn single_out(
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

    pub(super) fn learn(&mut self, frame: &Frame<'_>, report: &mut FrameReport) {
        // Admitted, so there is one.
        let carry = self.cycle.carry(frame.stamp).unwrap_or_default();
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
