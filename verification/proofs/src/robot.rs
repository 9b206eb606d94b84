//! A configuration of which only limits and kinematics matter, with any values.

use haltline::config::{
    Config, Footprint, Kinematics, Limits, MemoryRules, Ramps, Timing, Tolerances, ZoneMargins,
};
use haltline::time::Duration;
use haltline::units::{
    Acceleration, AngularAcceleration, AngularSpeed, Curvature, Length, Ppm, Speed,
};

/// A magnitude: zero or more.
pub(crate) fn magnitude(most: i32) -> i32 {
    let value = kani::any();
    kani::assume(value >= 0 && value <= most);
    value
}

/// Any limits a checked configuration may have.
pub(crate) fn any_limits() -> Limits {
    Limits {
        speed_forward: Speed::from_um_per_s(magnitude(20_000_000)),
        speed_reverse: Speed::from_um_per_s(magnitude(20_000_000)),
        angular_speed: AngularSpeed::from_urad_per_s(magnitude(20_000_000)),
        acceleration: Acceleration::from_um_per_s2(kani::any()),
        braking: Acceleration::from_um_per_s2(kani::any()),
        angular_acceleration: AngularAcceleration::from_urad_per_s2(kani::any()),
        angular_braking: AngularAcceleration::from_urad_per_s2(kani::any()),
        ramps: Ramps::Together,
    }
}

/// Either kind of drive.
pub(crate) fn any_kinematics() -> Kinematics {
    if kani::any() {
        Kinematics::Differential
    } else {
        Kinematics::Ackermann {
            curvature_max: Curvature::from_urad_per_m(magnitude(i32::MAX)),
            curvature_tolerance: Curvature::ZERO,
            steering_sweep: Duration::ZERO,
        }
    }
}

/// The rest is fixed: nothing here reads it.
pub(crate) fn config(kinematics: Kinematics, limits: Limits) -> Config<1> {
    let none = Duration::ZERO;
    Config {
        footprint: Footprint::default(),
        kinematics,
        limits,
        timing: Timing {
            period: none,
            jitter: none,
            actuation_latency: none,
            scan_age_max: none,
            odometry_age_max: none,
            command_age_max: none,
            rest: none,
            clear: none,
            tracking_window: none,
        },
        tolerances: Tolerances {
            speed: Speed::from_um_per_s(magnitude(1_000_000)),
            angular_speed: AngularSpeed::from_urad_per_s(magnitude(1_000_000)),
            tracking: Length::ZERO,
            odometry_linear: Ppm::ZERO,
            odometry_angular: Ppm::ZERO,
            rest_speed: Speed::ZERO,
            rest_angular_speed: AngularSpeed::ZERO,
            follow_speed: Speed::ZERO,
            follow_angular_speed: AngularSpeed::ZERO,
        },
        zone: ZoneMargins::default(),
        scanners: [None],
        memory: MemoryRules {
            clear_after_scans: 1,
            age_max: none,
            clear_at_start: Length::ZERO,
            skirt: Length::ZERO,
            body_width_min: Length::ZERO,
        },
        obstacle_speed: Speed::ZERO,
        host_death: None,
    }
}
