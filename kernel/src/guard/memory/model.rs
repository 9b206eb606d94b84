//! How known points age: odometry drifts, obstacles move.

use crate::arith::mul_micro_up;
use crate::odometry::Odometer;
use crate::time::{Duration, Instant};

/// How points age.
#[derive(Clone, Copy, Debug, Default)]
pub struct MemoryModel {
    /// Scans that must look past a point before it is forgotten.
    pub clear_after_scans: u8,
    /// Age at which points and space become unknown.
    pub age_max: Duration,
    /// Position error per distance, ppm.
    pub drift_linear_ppm: u64,
    /// Heading error per angle, ppm.
    pub drift_angular_ppm: u64,
    /// Obstacles' speed bound, µm/s.
    pub obstacle_speed: u64,
    /// Largest point error of any scanner, µm.
    pub sensor_um: u64,
    /// Neighbouring returns up to this far apart bound one surface, mm.
    pub join_mm: i32,
    /// Bodies at least this wide are seen, µm.
    pub body_width_um: u64,
}

/// Error of a point seen earlier, split by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Staleness {
    /// Position error of the odometry since, µm.
    pub drift_um: u64,
    /// Heading error of the odometry since, µrad.
    pub turn_urad: u64,
    /// Own motion of the obstacle since, µm.
    pub moved_um: u64,
}

impl MemoryModel {
    /// Errors of a point last seen at `stamp` and `then`, at `now` and `odometer`.
    #[must_use]
    pub fn staleness(
        &self,
        stamp: Instant,
        then: Odometer,
        now: Instant,
        odometer: Odometer,
    ) -> Staleness {
        let travelled = odometer.travelled_um.saturating_sub(then.travelled_um);
        let turned = odometer.turned_urad.saturating_sub(then.turned_urad);
        let age = now.since(stamp).unwrap_or_default().as_us();
        Staleness {
            //= spec/memory.md#memory-04
            //# The error of a remembered hit MUST grow by at least the odometry error over the distance driven and
            //# the angle turned since it was seen.
            drift_um: mul_micro_up(self.drift_linear_ppm, travelled),
            turn_urad: mul_micro_up(self.drift_angular_ppm, turned),
            moved_um: mul_micro_up(self.obstacle_speed, age),
        }
    }
}
