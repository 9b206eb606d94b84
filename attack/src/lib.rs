//! Attacks the guard: composes worlds, motions, drives at the edge of what is assumed, and faults; searches for a
//! scenario in which the robot breaks its claim; shrinks what it finds to a file that a person can read and
//! `haltline run` replays to the bit.
//!
//! A scenario is made from a *structure* (which bodies, whose motion, what goes wrong: drawn from a seed) and *genes*
//! (all lengths, speeds and times: numbers from 0 to 1, which an optimiser moves). Only its text is ever run, so
//! that what is written is what was tried. Judges are the simulator's: exact distances and the monitors, no code of
//! the kernel.

pub mod campaign;
pub mod compose;
pub mod genes;
pub mod hostile;
pub mod record;
pub mod search;
pub mod setting;
pub mod shrink;
pub mod trial;
