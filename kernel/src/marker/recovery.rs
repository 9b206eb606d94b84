//! When the filter is lost, and from which sightings it finds itself again.
//!
//! It refuses to believe a single sighting: a pose is taken over only when several sightings,
//! carried along by odometry, agree on it; and while not yet lost only if they are of more
//! than one marker, because one that hangs elsewhere now agrees with itself.

use super::linear::{
    IDENTITY, Ldl, Matrix, Vector, apply, diagonal, difference, sandwich, subtract, sum,
};
use super::model;
use super::pose::{Increment, Pose2, wrap};
use crate::time::{Duration, Instant};

/// Sightings that must agree before a pose is taken over.
pub const SUPPORT: u8 = 8;
/// Rejections before a run of them counts; below it there may be single outliers.
const RUN_MIN: u16 = 5;
/// A run of rejections ends when none arrives for this long.
const PAUSE: Duration = Duration::from_ms(500);

/// Whether the pose is to be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Health {
    /// Sightings and odometry agree, or there are none.
    Tracking,
    /// Every sighting of a known marker has been rejected since this moment.
    Lost(Instant),
}

/// A pose that rejected sightings speak for.
#[derive(Clone, Copy, Debug)]
struct Challenger {
    pose: Pose2,
    covariance: Matrix,
    support: u8,
    /// The first marker that spoke for it, and whether another one does.
    first: u16,
    several: bool,
    /// Whether all that spoke for it are of the map given beforehand.
    mapped: bool,
}

/// What a rejected sighting says.
pub(super) struct Claim {
    /// The marker.
    pub(super) id: u16,
    /// Whether it is of the map given beforehand.
    pub(super) mapped: bool,
    /// Where the robot is, if the sighting is right.
    pub(super) pose: Pose2,
    /// Its covariance.
    pub(super) covariance: Matrix,
}

/// A pose to be taken over.
pub(super) enum Takeover {
    /// The mean of all sightings that agree, independent of every marker in the state.
    Mean(Pose2, Matrix),
    /// The one that the last sighting claims, with the error of its marker.
    Last,
}

/// The run of rejections since the last sighting that fitted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recovery {
    first: Option<Instant>,
    last: Option<Instant>,
    count: u16,
    challenger: Option<Challenger>,
    lost: bool,
}

impl Recovery {
    pub(super) fn health(&self) -> Health {
        match self.first {
            Some(since) if self.lost => Health::Lost(since),
            _ => Health::Tracking,
        }
    }

    /// Whether the pose is in doubt: known markers are being rejected.
    pub(super) const fn in_doubt(&self) -> bool {
        self.first.is_some()
    }

    /// A sighting fitted.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// The challenger moves as the robot does.
    pub(super) fn moved(&mut self, increment: &Increment, noise: Vector) {
        if let Some(challenger) = &mut self.challenger {
            let spread = model::motion_noise(&challenger.pose, increment);
            let (pose, jacobian) = model::moved(&challenger.pose, increment);
            let noise = sandwich(&spread, &diagonal(noise));
            challenger.pose = pose;
            challenger.covariance = sum(&sandwich(&jacobian, &challenger.covariance), &noise);
        }
    }

    /// A frame had nothing but rejections.
    pub(super) fn rejected(&mut self, stamp: Instant, lost_after: Duration) {
        let pause = self.last.and_then(|last| stamp.since(last));
        if !self.lost && pause.is_some_and(|pause| pause > PAUSE) {
            self.clear();
        }
        let first = *self.first.get_or_insert(stamp);
        self.last = Some(self.last.map_or(stamp, |last| last.max(stamp)));
        self.count = self.count.saturating_add(1);
        let span = stamp.since(first).unwrap_or_default();
        self.lost |= self.count >= RUN_MIN && span >= lost_after;
    }

    /// A rejected sighting speaks for another pose; what is now to be taken over, if anything.
    ///
    /// - `gate`: largest squared Mahalanobis distance of sightings that agree
    pub(super) fn challenge(&mut self, claim: &Claim, gate: f64) -> Option<Takeover> {
        let challenger = match &mut self.challenger {
            Some(challenger) if challenger.support > 0 => challenger,
            other => {
                *other = Some(Challenger::new(claim));
                return None;
            }
        };
        if !challenger.agrees(claim, gate) {
            // Outliers wear a wrong challenger down, and an outlier never outlives the truth.
            challenger.support = challenger.support.min(SUPPORT).saturating_sub(1);
            return None;
        }
        let enough = challenger.support >= SUPPORT && (self.lost || challenger.several);
        enough.then_some(if challenger.mapped {
            Takeover::Mean(challenger.pose, challenger.covariance)
        } else {
            Takeover::Last
        })
    }
}

impl Challenger {
    const fn new(claim: &Claim) -> Self {
        Self {
            pose: claim.pose,
            covariance: claim.covariance,
            support: 1,
            first: claim.id,
            several: false,
            mapped: claim.mapped,
        }
    }

    /// Compares, and if they agree takes the mean weighted by the covariances.
    fn agrees(&mut self, claim: &Claim, gate: f64) -> bool {
        let [x, y, heading] = subtract(claim.pose.as_vector(), self.pose.as_vector());
        let apart = [x, y, wrap(heading)];
        let spread = Ldl::of(&sum(&self.covariance, &claim.covariance));
        if spread.distance(apart) > gate {
            return false;
        }
        let gain = self.covariance.map(|row| spread.solve(row));
        self.pose = self.pose.corrected(apply(&gain, apart));
        let rest = difference(&IDENTITY, &gain);
        self.covariance = sum(
            &sandwich(&rest, &self.covariance),
            &sandwich(&gain, &claim.covariance),
        );
        self.support = self.support.saturating_add(1);
        self.several |= claim.id != self.first;
        self.mapped &= claim.mapped;
        true
    }
}
