//! Anybody's bytes against `attack::uc`.
#![no_main]

use haltline_drives::conformance::attack;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    assert_eq!(attack::uc(bytes), Ok(()));
});
