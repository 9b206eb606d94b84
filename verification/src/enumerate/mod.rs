//! Enumerations: every case of a stated domain, run on the compiled kernel.

use crate::prove::native::Enumeration;

/// All enumerations.
#[must_use]
pub fn all() -> Vec<Enumeration> {
    Vec::new()
}
