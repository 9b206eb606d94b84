//! The drive adapters' own properties: bytes on the wire decode or are dropped, and never move a robot at rest.

use crate::script::noise;
use crate::{Draw, Property};
use haltline_drives::arcos::frame::checksum;
use haltline_drives::cola::decode_scan;
use haltline_drives::conformance::Twin;
use haltline_drives::conformance::{attack, clients};
use haltline_drives::emulator::{CarModel, SeekurModel};
use haltline_drives::uc::reply::error_code;

pub const ARCOS: Property = Property {
    name: "arcos",
    judge: |bytes| attack::arcos(bytes, checksum).map(|()| 1),
    twins: &[("a checksum off by one", |bytes| {
        attack::arcos(bytes, |body| checksum(body).wrapping_add(1)).map(|()| 1)
    })],
    draw: |draw| begun(draw, &[b"", b"\xFA\xFB", b"\x32", b"\x33", b"\x20"]),
    cases: 4000,
};

pub const UC: Property = Property {
    name: "uc",
    judge: |bytes| attack::uc(bytes, error_code).map(|()| 1),
    twins: &[("an error that is a state", |bytes| {
        attack::uc(bytes, |text| text.starts_with('D').then_some(1)).map(|()| 1)
    })],
    draw: |draw| {
        begun(
            draw,
            &[
                b"",
                b"\x02:",
                b"\x02#1:",
                b"ERR(",
                b"F 300 ~DMS=",
                b"D 300",
                b"\x02:D 300\x03",
            ],
        )
    },
    cases: 4000,
};

pub const COLA: Property = Property {
    name: "cola",
    judge: |bytes| attack::cola(bytes, decode_scan).map(|()| 1),
    twins: &[("a scan with more ranges than it says", |bytes| {
        attack::cola(bytes, |text| {
            let mut scan = decode_scan(text)?;
            scan.header.count = u16::MAX;
            Some(scan)
        })
        .map(|()| 1)
    })],
    draw: |draw| {
        let mut bytes = b"\x02sSN LMDscandata 1 1 89A27F 0 0 343 347 27477BA9 2747813B 0 0 7 0 0 1388 168 0 1 DIST1 \
              3F800000 00000000 FFF92230 1388 3 7D0 7D1 7D2 0 0 0 0 0 0\x03"
            .to_vec();
        for _ in 0..draw.index(4) {
            let at = draw.index(bytes.len());
            bytes[at] = b"0123456789ABCDEF \x02\x03"[draw.index(19)];
        }
        bytes
    },
    cases: 4000,
};

pub const ADAPTERS: Property = Property {
    name: "adapters",
    judge: |bytes| attack::adapters(bytes, None).map(|()| 1),
    twins: &[("trusts noise", |bytes| {
        attack::adapters(bytes, Some(Twin::TrustsNoise)).map(|()| 1)
    })],
    draw: noise::<10, 250>,
    cases: 1500,
};

pub const EMULATORS: Property = Property {
    name: "emulators",
    judge: |bytes| clients::emulators(bytes, SeekurModel::default(), CarModel::default()),
    twins: &[
        ("a watchdog that only warns", |bytes| {
            let seekur = SeekurModel {
                ignores_watchdog: true,
                ..SeekurModel::default()
            };
            clients::emulators(bytes, seekur, CarModel::default())
        }),
        ("a dead-man switch without effect", |bytes| {
            let car = CarModel {
                ignores_dead_man: true,
                ..CarModel::default()
            };
            clients::emulators(bytes, SeekurModel::default(), car)
        }),
        ("turns faster than its limit", |bytes| {
            let seekur = SeekurModel {
                skid: 1.2,
                ..SeekurModel::default()
            };
            clients::emulators(bytes, seekur, CarModel::default())
        }),
    ],
    draw: noise::<8, 256>,
    cases: 600,
};

/// One of the beginnings, then anything.
fn begun(draw: &mut Draw, starts: &[&[u8]]) -> Vec<u8> {
    let start = starts[draw.index(starts.len())];
    [start, &noise::<0, 200>(draw)].concat()
}
