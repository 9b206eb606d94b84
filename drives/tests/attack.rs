//! The fuzz targets' properties on drawn bytes; the targets themselves are in `fuzz/`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline_drives::conformance::attack;
use proptest::prelude::*;

/// Bytes that begin like something.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let starts = prop::sample::select(vec![
        &b""[..],
        b"\xFA\xFB",
        b"\x32",
        b"\x33",
        b"\x20",
        b"\x02:",
        b"\x02#1:",
        b"ERR(",
        b"F 300 ~DMS=",
        b"\x02sSN LMDscandata 1 1 89A27F 0 0 343 347 27477BA9 2747813B 0 0 7 0 0 1388 168 0 1 DIST1 ",
    ]);
    let rest = prop::collection::vec(any::<u8>(), 0..300);
    (starts, rest).prop_map(|(start, rest)| [start, &rest].concat())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn decoders_keep_their_properties(bytes in bytes()) {
        prop_assert_eq!(attack::arcos(&bytes), Ok(()));
        prop_assert_eq!(attack::uc(&bytes), Ok(()));
        prop_assert_eq!(attack::cola(&bytes), Ok(()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn adapters_never_move_on_scripts(script in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert_eq!(attack::adapters(&script), Ok(()));
    }
}
