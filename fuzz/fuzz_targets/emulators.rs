//! Any bytes against the property `emulators` of `haltline_fuzz_properties`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| haltline_fuzz_properties::fuzz("emulators", bytes));
