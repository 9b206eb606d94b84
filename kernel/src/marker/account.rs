//! After a correction: who was contradicted, whether the pose is in doubt, what is new.

use super::POSITION_MAX_M;
use super::correct::Moved;
use super::ekf::{Learned, MarkerEkf};
use super::linear::{IDENTITY, Matrix, ZERO, sandwich, sum};
use super::model;
use super::pose::Pose2;
use super::recovery::{Bearing, Claim, Takeover};
use super::sighting::{FrameReport, Sighting, Verdict};
use crate::time::{Duration, Instant};

/// Variance of a heading that was never seen, rad²: any.
const HEADING_UNKNOWN_RAD2: f64 = 10.0;
/// A marker seen less often than this is tentative.
const TENTATIVE: u16 = 3;
/// A tentative marker makes room for a new one when it was not seen for this long.
const FORGET_TENTATIVE: Duration = Duration::from_ms(5000);

impl<const N: usize, const M: usize> MarkerEkf<N, M> {
    /// Keeps account of fits and misfits: contradicted markers, a pose in doubt.
    pub(super) fn account(&mut self, moved: &Moved<'_>, report: &mut FrameReport) {
        let stamp = moved.frame.stamp;
        let fused = report.count(Verdict::Fused) > 0;
        let trusted = fused || !self.recovery.in_doubt(stamp);
        if fused {
            self.recovery.clear();
        } else if report.count(Verdict::Gated) > 0 {
            self.recovery.rejected(stamp, self.rules.lost_after);
        }
        for (index, sighting) in moved.sightings() {
            let verdict = report.record(index).map(|record| record.verdict);
            match verdict {
                Some(Verdict::Fused) => self.confirm(sighting, stamp),
                Some(Verdict::Gated) if trusted && self.contradict(sighting.id) => {
                    report.set_verdict(index, Verdict::Removed);
                }
                Some(Verdict::Gated) if !fused && !report.relocated => {
                    report.relocated = self.challenge(moved, sighting);
                }
                _ => {}
            }
        }
    }

    fn learned_mut(&mut self, id: u16) -> Option<&mut Learned> {
        let (_, slot) = self.known(id)?;
        self.markers.get_mut(slot?)
    }

    fn confirm(&mut self, sighting: &Sighting, stamp: Instant) {
        if let Some(marker) = self.learned_mut(sighting.id) {
            marker.sightings = marker.sightings.saturating_add(1);
            marker.contradictions = 0;
            marker.oriented |= sighting.heading_rad.is_some();
            marker.seen = stamp;
        }
    }

    /// Counts a contradiction; true if it was one too many and the marker is gone.
    fn contradict(&mut self, id: u16) -> bool {
        let limit = self.rules.contradictions;
        let Some(marker) = self.learned_mut(id) else {
            return false;
        };
        marker.contradictions = marker.contradictions.saturating_add(1);
        let tentative = marker.sightings < TENTATIVE;
        let limit = if tentative { limit.min(3) } else { limit };
        let gone = marker.contradictions >= limit;
        if let (true, Some((_, Some(slot)))) = (gone, self.known(id)) {
            self.remove(slot);
        }
        gone
    }

    /// Lets a rejected sighting speak for another pose; true if the robot was placed there.
    fn challenge(&mut self, moved: &Moved<'_>, sighting: &Sighting) -> bool {
        let Some((marker, slot)) = self.known(sighting.id) else {
            return false;
        };
        let oriented = slot
            .and_then(|slot| self.markers().get(slot))
            .is_none_or(|m| m.oriented);
        let spread = slot.map_or(ZERO, |slot| self.covariance.marker_covariance(slot));
        if sighting.heading_rad.is_none() || !oriented {
            return self.challenge_by_position(moved, sighting, &marker, &spread);
        }
        let (pose, jacobians) = model::located(&marker, &moved.seen(sighting));
        let noise = sandwich(&jacobians.robot, &moved.noise(sighting));
        let claim = Claim {
            id: sighting.id,
            mapped: slot.is_none(),
            pose,
            covariance: sum(&noise, &sandwich(&jacobians.marker, &spread)),
        };
        match self.claim(&claim) {
            None => return false,
            Some(Takeover::Mean(pose, covariance)) => self.put(pose, &covariance),
            Some(Takeover::Last) => {
                self.robot = pose;
                self.covariance.tie_robot(slot, &jacobians.marker, &noise);
            }
        }
        self.recovery.clear();
        true
    }

    /// The same for a position-only sighting: it takes two of different markers to say a pose.
    fn challenge_by_position(
        &mut self,
        moved: &Moved<'_>,
        sighting: &Sighting,
        marker: &Pose2,
        spread: &Matrix,
    ) -> bool {
        let noise = moved.noise(sighting);
        let claim = self.recovery.pair(Bearing {
            id: sighting.id,
            marker: *marker,
            seen: moved.seen(sighting),
            // Half a trace is a mean; the whole one is on the safe side.
            variance_m2: noise[0][0] + noise[1][1] + spread[0][0] + spread[1][1],
        });
        let taken = claim.as_ref().and_then(|claim| self.claim(claim));
        let Some(Takeover::Mean(pose, covariance)) = taken else {
            return false;
        };
        self.put(pose, &covariance);
        self.recovery.clear();
        true
    }

    fn claim(&mut self, claim: &Claim) -> Option<Takeover> {
        if !claim.pose.is_within(POSITION_MAX_M) {
            return None;
        }
        self.recovery.challenge(claim, self.rules.gate_pose)
    }

    /// Places the robot, independent of every marker.
    fn put(&mut self, pose: Pose2, covariance: &Matrix) {
        if pose.is_within(POSITION_MAX_M) {
            self.robot = pose;
            self.covariance.tie_robot(None, &IDENTITY, covariance);
        }
    }

    /// Takes markers that nobody knows into the state.
    pub(super) fn learn(&mut self, moved: &Moved<'_>, report: &mut FrameReport) {
        let doubt = self.recovery.in_doubt(moved.frame.stamp);
        for (index, sighting) in moved.sightings() {
            let verdict = report.record(index).map(|record| record.verdict);
            if verdict != Some(Verdict::Unknown) || !self.rules.learn {
                continue;
            }
            let verdict = if doubt {
                Verdict::Postponed
            } else if self.add(moved, sighting) {
                Verdict::Added
            } else {
                Verdict::Full
            };
            report.set_verdict(index, verdict);
        }
    }

    /// Appends one marker; false when there is no room.
    ///
    /// # Source
    /// Loh 3.17 to 3.19, the last corrected.
    fn add(&mut self, moved: &Moved<'_>, sighting: &Sighting) -> bool {
        let stamp = moved.frame.stamp;
        self.make_room(stamp);
        let seen = moved.seen(sighting);
        let pose = self.robot.then(&seen);
        let oriented = sighting.heading_rad.is_some();
        let mut noise = moved.noise(sighting);
        if !oriented {
            noise[2][2] = HEADING_UNKNOWN_RAD2;
        }
        let jacobians = model::placed(&self.robot, &seen);
        let noise = sandwich(&jacobians.marker, &noise);
        let Some(slot) = self.covariance.append(&jacobians.robot, &noise) else {
            return false;
        };
        if let Some(place) = self.markers.get_mut(slot) {
            *place = Learned {
                id: sighting.id,
                pose,
                oriented,
                sightings: 1,
                contradictions: 0,
                seen: stamp,
            };
        }
        self.index.set_learned(sighting.id, Some(slot));
        true
    }

    /// When full: the tentative marker that was not seen for longest goes, if there is one.
    fn make_room(&mut self, now: Instant) {
        if self.covariance.len() < N {
            return;
        }
        let markers = self.markers().iter().enumerate();
        let old = markers.filter(|(_, marker)| {
            let away = now.since(marker.seen);
            marker.sightings < TENTATIVE && away.is_some_and(|away| away > FORGET_TENTATIVE)
        });
        if let Some((slot, _)) = old.min_by_key(|(_, marker)| marker.seen) {
            self.remove(slot);
        }
    }
}
