//! The kernel's own rules, in the words of the robot file.
//!
//! Most of them cannot fire after the rules of this crate; they are the kernel's last word.

use haltline::ConfigError;

/// Path of the offending value, what is wrong and what to write.
pub(crate) fn of_kernel(error: ConfigError) -> (String, String, String) {
    let plain = |path: &str| (path.to_owned(), OUT_OF_BOUNDS.to_owned(), NEARER.to_owned());
    match error {
        ConfigError::Footprint => plain("footprint"),
        ConfigError::SpeedLimit | ConfigError::Acceleration => plain("limits"),
        ConfigError::Timing => plain("timing"),
        ConfigError::Tolerance => plain("tolerances"),
        ConfigError::Zone => plain("zone"),
        ConfigError::Memory => plain("memory"),
        ConfigError::ObstacleSpeed => plain("obstacles.speed_mps"),
        ConfigError::Curvature => plain("steering"),
        ConfigError::NoScanner => plain(""),
        ConfigError::Ramps => (
            "limits".to_owned(),
            "commands may accelerate faster than the robot surely brakes: it could not follow the ramp to rest"
                .to_owned(),
            "lower acceleration_mps2 to at most braking_mps2, and angular_acceleration_radps2 to at \
             most angular_braking_radps2"
                .to_owned(),
        ),
        ConfigError::Pipeline => (
            "timing.period_s".to_owned(),
            "more commands are in flight than the kernel can hold".to_owned(),
            "raise period_s or lower odometry_age_max_s, actuation_latency_s or the steering's sweep_s"
                .to_owned(),
        ),
        ConfigError::ScannerBeams(index) | ConfigError::ScannerRange(index) => (
            format!("scanner[{index}]"),
            "the kernel refuses this scanner: beams, ranges, error or place are out of bounds".to_owned(),
            "its place must lie within 1.8 m of the rotation centre (sum of x_m and y_m), its error \
             bound below 1 m, and its beams must not overlap"
                .to_owned(),
        ),
    }
}

const OUT_OF_BOUNDS: &str = "the kernel refuses these values: one is out of its bounds";
const NEARER: &str = "write values nearer to those of a real robot";
