//! One frame's correction: judge all of its sightings at the same prior, absorb those that
//! fit, learn new markers, and keep account of what did not fit.

use super::POSITION_MAX_M;
use super::ekf::MarkerEkf;
use super::linear::{Ldl, Matrix, Vector, ZERO, sandwich, subtract, sum, times};
use super::model;
use super::pose::{Pose2, wrap};
use super::sighting::{FRAME_MAX, Frame, FrameReport, FrameVerdict, Record, Sighting, Verdict};
use super::state::{Row, StateVector};

/// A sighting compared with the prior, its numbers made independent of each other.
#[derive(Clone, Copy, Debug)]
struct Judged {
    slot: Option<usize>,
    rows: [Row; 3],
    innovation: Vector,
    used: usize,
}

/// A frame moved to the moment of the last odometry.
pub(super) struct Moved<'a> {
    pub(super) frame: &'a Frame<'a>,
    carry: Pose2,
}

impl Moved<'_> {
    pub(super) fn sightings(&self) -> impl Iterator<Item = (usize, &Sighting)> {
        self.frame.sightings.iter().take(FRAME_MAX).enumerate()
    }

    pub(super) fn seen(&self, sighting: &Sighting) -> Pose2 {
        self.carry.then(&sighting.seen())
    }

    pub(super) fn noise(&self, sighting: &Sighting) -> Matrix {
        let noise = sighting.noise.matrix(sighting.heading_rad.is_some());
        sandwich(&self.carry.rotation(), &noise)
    }
}

impl<const N: usize, const M: usize> MarkerEkf<N, M> {
    pub(super) fn correct_frame(&mut self, frame: &Frame<'_>) -> FrameReport {
        let verdict = self.cycle.admit(frame, self.rules.frame_age);
        let mut report = FrameReport::new(frame, verdict);
        if verdict != FrameVerdict::Used {
            return report;
        }
        let Some(carry) = self.cycle.carry(frame.stamp) else {
            return report;
        };
        let moved = Moved { frame, carry };
        self.turn_free(&moved);
        let mut judged = [None; FRAME_MAX];
        //= spec/ekf.md#ekf-06
        //# The sightings of one frame MUST be judged and linearised at the same prior, so that their order is
        //# irrelevant.
        for ((index, sighting), place) in moved.sightings().zip(&mut judged) {
            let (record, fits) = self.judge(&moved, sighting);
            report.set(index, record);
            *place = fits;
        }
        single_out(&mut report, &mut judged);
        if report.records().all(|r| r.verdict == Verdict::Malformed) {
            return report;
        }
        self.cycle.corrected(frame);
        self.absorb(&judged);
        self.account(&moved, &mut report);
        if !self.robot.is_within(POSITION_MAX_M) {
            self.recovery.strayed(frame.stamp);
        }
        self.learn(&moved, &mut report);
        report
    }

    /// Landmarks without a heading that show one now, where they are expected: it may be any.
    fn turn_free(&mut self, moved: &Moved<'_>) {
        for (_, sighting) in moved.sightings() {
            let marker = self.known(sighting.id).and_then(|(_, slot)| slot);
            let bare = |slot: &usize| self.markers().get(*slot).is_some_and(|m| !m.oriented);
            let (Some(slot), Some(_)) = (marker.filter(bare), sighting.heading_rad) else {
                continue;
            };
            let place = Sighting {
                heading_rad: None,
                ..*sighting
            };
            if let (true, (_, Some(_))) = (sighting.is_usable(), self.judge(moved, &place)) {
                self.free_heading(slot);
            }
        }
    }

    /// Compares one sighting with the prior; what is returned beside the record may be fused.
    fn judge(&self, moved: &Moved<'_>, sighting: &Sighting) -> (Record, Option<Judged>) {
        //= spec/ekf.md#ekf-04
        //# A sighting or an odometry sample that is not finite, out of range or without a proper noise MUST be
        //# recorded as malformed and leave the state as it is.
        if !sighting.is_usable() {
            return (Record::unjudged(sighting, Verdict::Malformed), None);
        }
        let Some((marker, slot)) = self.known(sighting.id) else {
            return (Record::unjudged(sighting, Verdict::Unknown), None);
        };
        let oriented = sighting.heading_rad.is_some();
        let expected = self.robot.sees(&marker);
        let seen = moved.seen(sighting);
        let apart = subtract(seen.as_vector(), expected.as_vector());
        let turn = if oriented { wrap(apart[2]) } else { 0.0 };
        let innovation = [apart[0], apart[1], turn];
        let noise = moved.noise(sighting);
        let rows = self.rows(&marker, slot, oriented);
        let covariance = sum(&self.covariance.spread(slot, &rows), &noise);
        let nis = Ldl::of(&covariance).distance(innovation);
        let gate = if oriented {
            self.rules.gate_pose
        } else {
            self.rules.gate_position
        };
        let judged = Judged::new(slot, rows, innovation, &noise, oriented);
        //= spec/ekf.md#ekf-05
        //# A sighting whose NIS exceeds the gate MUST NOT change the state.
        let (verdict, fits) = if nis <= gate {
            (Verdict::Fused, Some(judged))
        } else {
            (Verdict::Gated, None)
        };
        let mut covariance = covariance;
        if !oriented {
            covariance[2][2] = 0.0;
        }
        //= spec/ekf.md#ekf-13
        //# Every sighting of a used frame MUST leave a record with its innovation, the innovation's covariance, its
        //# NIS and the verdict.
        let record = Record::judged(sighting, innovation, covariance, nis, verdict);
        (record, fits)
    }

    /// Corrects the state by all that fits; the order is irrelevant but for rounding.
    fn absorb(&mut self, judged: &[Option<Judged>; FRAME_MAX]) {
        let mut correction = StateVector::ZERO;
        let mut gain = StateVector::ZERO;
        for sighting in judged.iter().flatten() {
            let numbers = sighting.rows.iter().zip(sighting.innovation);
            for (row, innovation) in numbers.take(sighting.used) {
                let rest = innovation - correction.product(row, sighting.slot);
                self.covariance.absorb(sighting.slot, row, &mut gain);
                correction.add_scaled(&gain, rest);
            }
        }
        self.robot = self.anchor.corrected(&self.robot, correction.robot);
        let len = self.covariance.len();
        let markers = self.markers.iter_mut().zip(&correction.markers);
        for (marker, correction) in markers.take(len) {
            marker.pose = marker.anchor.corrected(&marker.pose, *correction);
        }
    }

    /// The rows of H for one sighting; zero where nothing is measured or nothing estimated.
    fn rows(&self, marker: &Pose2, slot: Option<usize>, oriented: bool) -> [Row; 3] {
        let jacobians = model::sighting(&self.robot, marker);
        let by_robot = times(&jacobians.robot, &self.anchor.error_of(&self.robot));
        let by_marker = slot.map(|slot| times(&jacobians.marker, &self.marker_error(slot)));
        let blank = Row {
            robot: [0.0; 3],
            marker: [0.0; 3],
            variance: 0.0,
        };
        let mut rows = [blank; 3];
        let measured = if oriented { 3 } else { 2 };
        let blocks = by_robot.iter().zip(by_marker.unwrap_or(ZERO));
        for (row, (robot, marker)) in rows.iter_mut().zip(blocks).take(measured) {
            row.robot = *robot;
            row.marker = marker;
        }
        rows
    }
}

impl Judged {
    fn new(
        slot: Option<usize>,
        rows: [Row; 3],
        innovation: Vector,
        noise: &Matrix,
        oriented: bool,
    ) -> Self {
        let factor = Ldl::of(noise);
        let [l10, l20, l21] = factor.below;
        let [first, second, third] = rows;
        let second = second.minus(&first, l10);
        let third = third.minus(&first, l20).minus(&second, l21);
        let mut rows = [first, second, third];
        for (row, variance) in rows.iter_mut().zip(factor.pivots) {
            row.variance = variance;
        }
        Self {
            slot,
            rows,
            innovation: factor.forward(innovation),
            used: if oriented { 3 } else { 2 },
        }
    }
}

/// Of sightings with the same id at most one can be right: the only one inside the gate.
fn single_out(report: &mut FrameReport, judged: &mut [Option<Judged>; FRAME_MAX]) {
    for index in 0..FRAME_MAX {
        let Some(&Record { id, verdict, .. }) = report.record(index) else {
            continue;
        };
        let twin = |other: &Record| other.id == id && other.verdict == verdict;
        let same = report.records().filter(|other| twin(other)).count();
        let candidate = matches!(verdict, Verdict::Fused | Verdict::Unknown);
        if candidate && same > 1 {
            for at in 0..FRAME_MAX {
                if report.record(at).is_some_and(&twin) {
                    report.set_verdict(at, Verdict::Ambiguous);
                    if let Some(place) = judged.get_mut(at) {
                        *place = None;
                    }
                }
            }
        }
    }
}
