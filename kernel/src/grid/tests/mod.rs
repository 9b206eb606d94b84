//! The grid against slow transcriptions of what it promises.

mod corners;
mod every_beam;
mod map;
mod nearest_beam;
mod rolling;
mod total;
mod world;
