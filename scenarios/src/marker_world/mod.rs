//! A world of fiducial markers for the localisation filter: paths, cameras, odometry, outliers.
//!
//! It knows nothing of lasers, drives or the guard. Truth is in closed form; every error is
//! drawn from a seeded stream and labelled, so that a run can say which of the sightings that a
//! filter rejected were good. The filter is only ever called through
//! [`haltline::marker::MarkerFilter`].

mod camera;
mod chance;
mod outlier;
mod path;
mod places;
mod run;
pub mod score;
mod setups;

pub use camera::{Camera, SightErrors};
pub use chance::Chance;
pub use outlier::{Label, Outliers};
pub use path::{Leg, Path};
pub use places::{Marker, corridor, field, ring, thesis_marker};
pub use run::{FrameSample, Setup, Slip, StepSample, Trace, planar, run};
pub use setups::{
    corridor_setup, field_setup, filter_rules, idealised, loop_setup, realistic, roomy_setup,
};
