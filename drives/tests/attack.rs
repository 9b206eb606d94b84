//! The emulators under any client. The properties of decoders and adapters are tested with the fuzz targets (`fuzz/`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline_drives::conformance::attack;
use proptest::prelude::*;

/// Real lines and packets, cut, joined and mixed with anything.
fn client() -> impl Strategy<Value = Vec<u8>> {
    let part = prop_oneof![
        prop::sample::select(vec![
            &b"\xFA\xFB\x03\x00\x00\x00"[..],
            b"\xFA\xFB\x03\x01\x00\x01",
            b"\xFA\xFB\x03\x02\x00\x02",
            b"\xFA\xFB\x06\x04\x3B\x01\x00\x05\x3B",
            b"\xFA\xFB\x06\x0B\x3B\xF4\x01\xFF\x3C",
            b"\xFA\xFB\xFF",
            b"!DRV F 1000 1000\n",
            b"!DRV D -500\n",
            b"!DRV F\n",
            b"!STEER -99999999999\n",
            b"!DRV ~DMS=4294967295\n",
            b"!DAQ GRP 1 GZ HALL_CNT ~TS=0 ~ENC=B64 ~CRC\n",
            b"!DAQ GRP 2 _TICS ~TS=99999999999999999999\n",
            b"!DAQ GRP 3 _TICS ~TS=18446744073709551615\n",
            b"!DAQ START\n",
            b"?DAQ GET GZ VDBAT\n",
            b"\n\n",
        ])
        .prop_map(<[u8]>::to_vec),
        prop::collection::vec(any::<u8>(), 0..40),
    ];
    prop::collection::vec(part, 0..30).prop_map(|parts| parts.concat())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn emulators_survive_any_client(bytes in client()) {
        prop_assert_eq!(attack::emulators(&bytes), Ok(()));
    }
}
