//! Checks on the kernel as it is built, not as it is written.
//!
//! [`image`] links a release image of the kernel function by function and finds
//! out whether a panic is reachable; the image has no allocator, so it cannot
//! allocate. Proof harnesses, ledger and seeded faults come with the issue
//! *Proofs*.

pub mod enumerate;
pub mod faults;
pub mod image;
pub mod measure;
pub mod prove;
pub mod timing;
