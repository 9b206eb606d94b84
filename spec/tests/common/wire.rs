//! Between the oracle's plain numbers and the kernel's types.

use haltline::convert;
use haltline::input::{Beam, Motion};
use haltline_spec::motion::Twist;
use haltline_spec::plant::SetPoint;
use haltline_spec::world::Ray;

/// A sweep as a driver would hand it over.
pub fn encode(rays: &[Ray]) -> Vec<Beam> {
    let limit = |metres: f64| convert::length(metres, convert::Round::Up).unwrap();
    rays.iter()
        .map(|ray| {
            let range = ray.range_m.map_or(f32::INFINITY, |range_m| range_m as f32);
            convert::beam(
                range,
                convert::BeamEncoding::Rep117,
                limit(0.02),
                limit(12.0),
            )
        })
        .collect()
}

/// A decision's set point in plain numbers.
pub fn decode(motion: Motion) -> SetPoint {
    match motion {
        Motion::Twist(twist) => SetPoint::Twist(Twist::new(
            f64::from(twist.linear.as_um_per_s()) * 1e-6,
            f64::from(twist.angular.as_urad_per_s()) * 1e-6,
        )),
        Motion::Arc { linear, curvature } => SetPoint::Arc {
            v_mps: f64::from(linear.as_um_per_s()) * 1e-6,
            curvature_per_m: f64::from(curvature.as_urad_per_m()) * 1e-6,
        },
    }
}
