//! Plane geometry in integers: angles, poses, and the one test whether something touches a rectangle.
//!
//! Knows nothing of robots, time or sensors.

pub mod frame;
pub mod rect;
pub mod trig;
