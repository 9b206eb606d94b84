//! The filter: the robot and the markers it has met, in one state.

use super::anchor::Anchor;
use super::cycle::Cycle;
use super::factor::{Factor, HEADING_UNKNOWN_RAD2, close_gap};
use super::index::{Index, Place};
use super::linear::{IDENTITY, Matrix, diagonal, sandwich, times};
use super::model;
use super::pose::{Increment, Pose2};
use super::recovery::{Health, Recovery};
use super::rules::{FilterError, FilterRules};
use super::sighting::{Frame, FrameReport, NOISE_MAX, NOISE_MIN};
use super::{MarkerEstimate, MarkerFilter, POSITION_MAX_M, Prediction};
use crate::time::Instant;

/// Longest motion between two odometry samples that is believed, m.
pub const INCREMENT_MAX_M: f64 = 10.0;
/// Largest turn between two odometry samples that is believed, rad.
pub const INCREMENT_MAX_RAD: f64 = core::f64::consts::TAU;

/// EKF SLAM on markers: at most `N` in the state, `M` in the map given beforehand.
///
/// About `72 N² + 144 N + 24 M` bytes and 4 kB: box it or place it in a `static` where the stack is
/// small. Nothing here needs a stack frame that grows faster than `N`.
#[derive(Clone, Debug)]
pub struct MarkerEkf<const N: usize, const M: usize> {
    pub(super) rules: FilterRules,
    pub(super) robot: Pose2,
    pub(super) anchor: Anchor,
    /// Of the errors as the anchors count them.
    pub(super) covariance: Factor<N>,
    /// As many as `covariance` has, in the same order.
    pub(super) markers: [Learned; N],
    pub(super) index: Index<M>,
    pub(super) cycle: Cycle,
    pub(super) recovery: Recovery,
}

/// A marker in the state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Learned {
    pub(super) id: u16,
    pub(super) pose: Pose2,
    pub(super) anchor: Anchor,
    /// Whether its heading was ever seen.
    pub(super) oriented: bool,
    /// Sightings fused, the first included; saturates.
    pub(super) sightings: u16,
    /// Sightings rejected since the last fused one, while others fitted.
    pub(super) contradictions: u8,
    pub(super) seen: Instant,
}

impl<const N: usize, const M: usize> MarkerEkf<N, M> {
    /// A filter that knows no marker yet.
    ///
    /// - `start`: where the robot is, in the frame of the map
    /// - `variances`: of x, y (m²) and heading (rad²); each within
    ///   [`NOISE_MIN`]..=[`NOISE_MAX`]
    ///
    /// # Errors
    /// What [`FilterRules::check`] refuses, a bad pose or a bad variance.
    pub fn new(rules: FilterRules, start: Pose2, variances: [f64; 3]) -> Result<Self, FilterError> {
        rules.check()?;
        let robot = checked(&start)?;
        Ok(Self {
            rules,
            robot,
            anchor: Anchor::at(&robot),
            covariance: Factor::new(&start_covariance(variances)?),
            markers: [Learned::default(); N],
            index: Index::new(),
            cycle: Cycle::default(),
            recovery: Recovery::default(),
        })
    }

    /// Enters a marker whose pose is known exactly, in the frame of the map.
    ///
    /// # Errors
    /// An id or a pose that cannot be, an id that is known already, no room left.
    pub fn add_mapped(&mut self, id: u16, pose: Pose2) -> Result<(), FilterError> {
        self.index.add_mapped(id, checked(&pose)?)
    }

    /// Places the robot anew, by somebody who knows; learned markers stay as they are.
    ///
    /// # Errors
    /// A bad pose or a bad variance; the filter is unchanged.
    pub fn place(&mut self, pose: Pose2, variances: [f64; 3]) -> Result<(), FilterError> {
        let robot = checked(&pose)?;
        let covariance = start_covariance(variances)?;
        self.robot = robot;
        self.anchor = Anchor::at(&robot);
        self.covariance.tie_robot(None, &covariance, &covariance);
        self.recovery.clear();
        Ok(())
    }

    /// The rules.
    #[must_use]
    pub const fn rules(&self) -> &FilterRules {
        &self.rules
    }

    /// Ids of the markers in the state, oldest first.
    pub fn learned(&self) -> impl Iterator<Item = u16> + '_ {
        self.markers().iter().map(|marker| marker.id)
    }

    pub(super) fn markers(&self) -> &[Learned] {
        self.markers
            .get(..self.covariance.len())
            .unwrap_or_default()
    }

    /// Where a marker is, and its slot if it is in the state.
    pub(super) fn known(&self, id: u16) -> Option<(Pose2, Option<usize>)> {
        match self.index.place(id) {
            Place::Unknown => None,
            Place::Mapped(at) => Some((*self.index.mapped(at)?, None)),
            Place::Learned(slot) => Some((self.markers().get(slot)?.pose, Some(slot))),
        }
    }

    /// Covariance of a marker's [x, y, heading].
    pub(super) fn marker_covariance(&self, slot: usize) -> Matrix {
        let counted = self.covariance.marker_covariance(slot);
        sandwich(&self.marker_error(slot), &counted)
    }

    /// The derivative of a marker's [x, y, heading] by its error as it is counted.
    pub(super) fn marker_error(&self, slot: usize) -> Matrix {
        let marker = self.markers().get(slot);
        marker.map_or(IDENTITY, |marker| marker.anchor.error_of(&marker.pose))
    }

    /// The heading of a marker may be any; its place stays as it is.
    pub(super) fn free_heading(&mut self, slot: usize) {
        if let Some(marker) = self.markers.get_mut(slot) {
            marker.oriented = true;
            let turn = marker.anchor.counted(&marker.pose).map(|row| row[2]);
            self.covariance.loosen(slot, turn, HEADING_UNKNOWN_RAD2);
        }
    }

    /// Takes the marker at `slot` out of the state.
    pub(super) fn remove(&mut self, slot: usize) {
        let Some(gone) = self.markers().get(slot).map(|marker| marker.id) else {
            return;
        };
        self.index.set_learned(gone, None);
        self.covariance.remove(slot);
        close_gap(&mut self.markers, slot);
        let stay = self.markers.iter().enumerate().take(self.covariance.len());
        for (slot, marker) in stay {
            self.index.set_learned(marker.id, Some(slot));
        }
    }
}

impl<const N: usize, const M: usize> MarkerFilter for MarkerEkf<N, M> {
    /// # Bound
    /// O(markers).
    fn predict(&mut self, stamp: Instant, increment: &Increment) -> Prediction {
        if !self.cycle.is_news(stamp) {
            return Prediction::Reordered;
        }
        let usable = increment.as_pose().is_within(INCREMENT_MAX_M)
            && increment.turn_rad.abs() <= INCREMENT_MAX_RAD;
        let (after, jacobian) = model::moved(&self.robot, increment);
        if !usable || !after.is_within(POSITION_MAX_M) {
            return Prediction::Malformed;
        }
        let noise = self.rules.odometry.of(increment);
        let spread = model::motion_noise(&self.robot, increment);
        self.anchor.follow(&self.robot, &after);
        let spread = times(&self.anchor.counted(&after), &spread);
        self.covariance
            .moved(&jacobian, &sandwich(&spread, &diagonal(noise)));
        self.robot = after;
        self.recovery.moved(increment, noise);
        self.cycle.begin(stamp, increment);
        Prediction::Done
    }

    /// # Bound
    /// O(sightings × markers²), at most [`super::FRAME_MAX`] sightings.
    fn correct(&mut self, frame: &Frame<'_>) -> FrameReport {
        self.correct_frame(frame)
    }

    fn pose(&self) -> Pose2 {
        self.robot
    }

    fn pose_covariance(&self) -> Matrix {
        let error = self.anchor.error_of(&self.robot);
        sandwich(&error, &self.covariance.robot_covariance())
    }

    fn marker(&self, id: u16) -> Option<MarkerEstimate> {
        let (pose, slot) = self.known(id)?;
        let marker = slot.and_then(|slot| self.markers().get(slot));
        Some(MarkerEstimate {
            pose,
            covariance: slot.map_or(super::linear::ZERO, |slot| self.marker_covariance(slot)),
            oriented: marker.is_none_or(|marker| marker.oriented),
            sightings: marker.map_or(0, |marker| marker.sightings),
        })
    }

    fn health(&self) -> Health {
        self.recovery.health()
    }
}

/// The same pose with its heading in (−π, π].
fn checked(pose: &Pose2) -> Result<Pose2, FilterError> {
    if pose.is_within(POSITION_MAX_M) && pose.heading_rad.abs() <= POSITION_MAX_M {
        Ok(pose.corrected([0.0; 3]))
    } else {
        Err(FilterError::Pose)
    }
}

fn start_covariance(variances: [f64; 3]) -> Result<Matrix, FilterError> {
    let range = NOISE_MIN..=NOISE_MAX;
    if variances.iter().all(|variance| range.contains(variance)) {
        Ok(diagonal(variances))
    } else {
        Err(FilterError::Variance)
    }
}
