//! A navigation safety kernel: `no_std`, allocation-free, bounded-time, without `unsafe`.
#![no_std]

pub mod config;
pub mod convert;
pub mod decision;
pub mod guard;
pub mod input;
pub mod time;
pub mod units;
