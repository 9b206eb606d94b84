//! After a correction: who was contradicted, whether the pose is in doubt, what is new.

use super::POSITION_MAX_M;
use super::anchor::Anchor;
use super::correct::Moved;
use super::ekf::{Learned, MarkerEkf};
use super::linear::{IDENTITY, Matrix, ZERO, sandwich, sum, times};
use super::model;
use super::pose::Pose2;
use super::recovery::{Bearing, Claim, Takeover};
use super::sighting::{FrameReport, NOISE_MIN, Record, Sighting, Verdict};
use crate::time::{Duration, Instant};

/// A marker seen less often than this is tentative.
const TENTATIVE: u16 = 3;
/// A tentative marker makes room for a new one when it was not seen for this long.
const FORGET_TENTATIVE: Duration = Duration::from_ms(5000);

impl<const N: usize, const M: usize> MarkerEkf<N, M> {
    /// Keeps account of fits and misfits: contradicted markers, a pose in doubt.
    pub(super) fn account(&mut self, moved: &Moved<'_>, report: &mut FrameReport) {
        let stamp = moved.frame.stamp;
        let fused = report.count(Verdict::Fused) > 0;
        // Others fit now, or did when something was seen last.
        let trusted = fused || self.recovery.is_clear();
        let doubts = |r: &Record| r.verdict == Verdict::Gated && !self.is_tentative(r.id);
        if fused {
            self.recovery.clear();
        } else if report.records().any(doubts) {
            self.recovery.rejected(stamp, self.rules.lost_after);
        }
        for (index, sighting) in moved.sightings() {
            match report.record(index).map(|record| record.verdict) {
                Some(Verdict::Fused) => self.confirm(sighting, stamp),
                // Of several sightings with one id any may be the wrong one: none of them speaks.
                Some(Verdict::Gated) if is_alone(report, sighting.id) => {
                    let tentative = self.is_tentative(sighting.id);
                    if (trusted || tentative) && self.contradict(sighting.id) {
                        report.set_verdict(index, Verdict::Removed);
                    } else if !fused && !tentative && !report.relocated {
                        report.relocated = self.challenge(moved, sighting);
                    }
                }
                _ => {}
            }
        }
    }

    /// Whether a marker is in the state, but was seen too seldom to say anything about the robot.
    fn is_tentative(&self, id: u16) -> bool {
        let slot = self.known(id).and_then(|(_, slot)| slot);
        let marker = slot.and_then(|slot| self.markers().get(slot));
        marker.is_some_and(|marker| marker.sightings < TENTATIVE)
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

    /// Counts a contradiction, at most one per frame; true if it was one too many and the marker is gone.
    fn contradict(&mut self, id: u16) -> bool {
        let limit = self.rules.contradictions;
        let Some(marker) = self.learned_mut(id) else {
            return false;
        };
        marker.contradictions = marker.contradictions.saturating_add(1);
        let tentative = marker.sightings < TENTATIVE;
        let limit = if tentative { limit.min(3) } else { limit };
        //= spec/ekf.md#ekf-12
        //# A marker in the state MUST be taken out when its sightings are rejected repeatedly while those of others
        //# fit.
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
        let spread = slot.map_or(ZERO, |slot| self.marker_covariance(slot));
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
                let error = slot.map_or(IDENTITY, |slot| self.marker_error(slot));
                let by_marker = times(&jacobians.marker, &error);
                self.robot = pose;
                self.anchor = Anchor::at(&pose);
                self.covariance.tie_robot(slot, &by_marker, &noise);
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
            self.anchor = Anchor::at(&pose);
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
            // Its heading is an axis that hangs in the map and turns with it.
            noise[2][2] = NOISE_MIN;
        }
        let jacobians = model::placed(&self.robot, &seen);
        let by_robot = times(&jacobians.robot, &self.anchor.error_of(&self.robot));
        let noise = sandwich(&jacobians.marker, &noise);
        //= spec/ekf.md#ekf-03
        //# A corrected state and its covariance MUST equal those of the same filter with dense matrices, which keeps
        //# every cross-covariance, up to rounding.
        let Some(slot) = self.covariance.append(&by_robot, &noise) else {
            return false;
        };
        if let Some(place) = self.markers.get_mut(slot) {
            *place = Learned {
                id: sighting.id,
                pose,
                anchor: Anchor::at(&pose),
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
    //= spec/ekf.md#ekf-11
    //# When the state is full, a new marker MUST be refused unless a tentative one that was not seen for five seconds
    //# can make room.
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

/// Whether an id was read once in a frame, malformed sightings aside.
fn is_alone(report: &FrameReport, id: u16) -> bool {
    let mut same = report
        .records()
        .filter(|record| record.id == id && record.verdict != Verdict::Malformed);
    same.next().is_some() && same.next().is_none()
}
