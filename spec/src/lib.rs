//! The requirements of Haltline, and reference models to judge the kernel by.
//!
//! Two things live here. [`requirements`] reads the Markdown files of this
//! directory. The other modules are the *oracle*: slow, plain `f64` code that
//! draws single motions a robot may make under the assumptions of
//! `spec/assumptions.md` and looks whether one of them touches a body. It
//! shares no computation with the kernel and never names its types.

pub mod draw;
pub mod exact;
pub mod motion;
pub mod plane;
pub mod plant;
pub mod requirements;
pub mod world;
