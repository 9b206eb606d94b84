//! Scenarios that can hurt a guarded robot, and the judges that say whether they did.
//!
//! A scenario file describes a world, a robot, a drive and what goes wrong. The engine runs it
//! with the guard and without (the *naked twin*, which must touch); contacts are judged by exact
//! geometry at every dynamics step, and monitors watch every tick. Nothing here shares code with
//! the kernel's geometry: the kernel is only ever called through its public door.

pub mod assumption;
pub mod barn;
pub mod batch;
pub mod catalogue;
pub mod contact;
pub mod controller;
pub mod drive;
pub mod engine;
pub mod equip;
pub mod faults;
pub mod file;
pub mod marker_world;
pub mod math;
pub mod monitor;
pub mod navigation;
pub mod noise;
pub mod odometry;
pub mod pilot;
pub mod populate;
pub mod proposer;
pub mod raycast;
pub mod result;
pub mod sensor;
pub mod skid;
pub mod sweep;
pub mod trace;
pub mod verdict;
pub mod world;

#[cfg(test)]
mod testing;
