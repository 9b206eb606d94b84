//! Untrusted autonomy: what may be wrong without making a motion unsafe.
//!
//! * [`marker_filter`]: the thesis' UKF, a dense EKF, and mixtures of the two, behind the same
//!   trait as the kernel's filter.
//! * [`marker_map`]: maps of markers as CSV files.

pub mod marker_filter;
pub mod marker_map;
