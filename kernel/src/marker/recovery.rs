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
/// New markers wait for this long after a rejection.
const DOUBT: Duration = Duration::from_ms(500);

/// Whether the pose is to be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Health {
    /// Sightings and odometry agree, or there are none.
    Tracking,
    /// Every sighting of a known marker has been rejected since this moment, or the pose has left
    /// the filter's range.
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
    /// Whether it is of the map given beforehand. Also of pairs of positions: what they share
    /// with learned markers is in their covariance but cannot be tied to one of them.
    pub(super) mapped: bool,
    /// Where the robot is, if the sighting is right.
    pub(super) pose: Pose2,
    /// Its covariance.
    pub(super) covariance: Matrix,
}

/// A rejected position-only sighting, waiting for another marker's to make a pose of both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bearing {
    /// The marker.
    pub(super) id: u16,
    /// Where it hangs, in the frame of the map.
    pub(super) marker: Pose2,
    /// Where it was seen, in the robot frame of now.
    pub(super) seen: Pose2,
    /// Variance of both together, per axis, m².
    pub(super) variance_m2: f64,
}

/// Two markers nearer to each other than this say too little about the heading, m.
const BASELINE_MIN_M: f64 = 0.5;
/// Distances between two markers, known and seen, agree within so many sigmas.
const BASELINE_SIGMAS: f64 = 3.0;

impl Bearing {
    /// The robot's pose from two markers, if their distance is as it should be.
    fn with(&self, other: &Self) -> Option<Claim> {
        let towards = |a: &Pose2, b: &Pose2| (b.x_m - a.x_m, b.y_m - a.y_m);
        let (known, seen) = (
            towards(&self.marker, &other.marker),
            towards(&self.seen, &other.seen),
        );
        let baseline_m = libm::hypot(known.0, known.1);
        let variance = self.variance_m2 + other.variance_m2;
        let apart_m = (libm::hypot(seen.0, seen.1) - baseline_m).abs();
        if self.id == other.id
            || baseline_m < BASELINE_MIN_M
            || apart_m > BASELINE_SIGMAS * libm::sqrt(variance)
        {
            return None;
        }
        let heading_rad = libm::atan2(known.1, known.0) - libm::atan2(seen.1, seen.0);
        let turned = Pose2::new(0.0, 0.0, heading_rad).then(&other.seen);
        let (x, y) = (turned.x_m, turned.y_m);
        let heading_rad2 = variance / (baseline_m * baseline_m);
        let lever = [[1.0, 0.0, y], [0.0, 1.0, -x], [0.0, 0.0, 1.0]];
        let own = [other.variance_m2, other.variance_m2, heading_rad2];
        Some(Claim {
            id: other.id,
            mapped: true,
            pose: Pose2::new(
                other.marker.x_m - x,
                other.marker.y_m - y,
                wrap(heading_rad),
            ),
            covariance: sandwich(&lever, &diagonal(own)),
        })
    }
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
    bearing: Option<Bearing>,
    lost: bool,
}

impl Recovery {
    pub(super) fn health(&self) -> Health {
        match self.first {
            Some(since) if self.lost => Health::Lost(since),
            _ => Health::Tracking,
        }
    }

    /// Whether the pose is in doubt: known markers are being rejected, or were until just now.
    pub(super) fn in_doubt(&self, now: Instant) -> bool {
        let since = self.last.map(|last| now.since(last).unwrap_or_default());
        self.lost || since.is_some_and(|since| since <= DOUBT)
    }

    /// Whether nothing was rejected since the last sighting that fitted.
    pub(super) const fn is_clear(&self) -> bool {
        self.first.is_none()
    }

    /// A sighting fitted.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// A correction took the pose out of the filter's range: no odometry moves it any more.
    pub(super) fn strayed(&mut self, stamp: Instant) {
        self.first.get_or_insert(stamp);
        self.last = Some(stamp);
        self.lost = true;
    }

    /// The challenger moves as the robot does, and what was seen moves the other way.
    pub(super) fn moved(&mut self, increment: &Increment, noise: Vector) {
        if let Some(bearing) = &mut self.bearing {
            bearing.seen = increment.as_pose().sees(&bearing.seen);
            bearing.variance_m2 += noise[0] + noise[1];
        }
        if let Some(challenger) = &mut self.challenger {
            let spread = model::motion_noise(&challenger.pose, increment);
            let (pose, jacobian) = model::moved(&challenger.pose, increment);
            let noise = sandwich(&spread, &diagonal(noise));
            challenger.pose = pose;
            challenger.covariance = sum(&sandwich(&jacobian, &challenger.covariance), &noise);
        }
    }

    /// A frame had nothing but rejections.
    ///
    /// A run of them ends when none arrives for twice as long as it takes to be lost: in a place
    /// without markers there may be single outliers.
    pub(super) fn rejected(&mut self, stamp: Instant, lost_after: Duration) {
        let pause = self.last.and_then(|last| stamp.since(last));
        let end = lost_after.plus(lost_after);
        if !self.lost && pause.is_some_and(|pause| pause > end) {
            self.clear();
        }
        let first = *self.first.get_or_insert(stamp);
        self.last = Some(self.last.map_or(stamp, |last| last.max(stamp)));
        self.count = self.count.saturating_add(1);
        let span = stamp.since(first).unwrap_or_default();
        //= spec/ekf.md#ekf-09
        //# The filter MUST say that it is lost when every sighting of a known marker was rejected for `lost_after`.
        self.lost |= self.count >= RUN_MIN && span >= lost_after;
    }

    /// A rejected position-only sighting; with the one before it, it may say where the robot is.
    pub(super) fn pair(&mut self, bearing: Bearing) -> Option<Claim> {
        let before = self.bearing.replace(bearing)?;
        before.with(&bearing)
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
        //= spec/ekf.md#ekf-10
        //# The filter MUST take another pose over only when at least eight rejected sightings, carried along by
        //# odometry, agree on it, and these are of more than one marker or the filter is lost.
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
