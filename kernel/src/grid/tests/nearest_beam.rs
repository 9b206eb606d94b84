//! The nearest-beam rule against Alg. 3.3 as it stands: every cell, every beam, in floats.

use super::world::{Map, Sighting, middle, sample, sighting};
use crate::grid::{CellIndex, Echo, LogOdds, SensorModel, UpdateRule};
use core::f64::consts::{PI, TAU};
use proptest::prelude::*;
use std::vec::Vec;

/// Two beams may be taken for equally near within this, radians: what the bearing is off by.
const TIE_RAD: f64 = 4e-6;
/// Two distances may be taken for equal within this, µm.
const TIE_UM: i64 = 12;

/// Everything that floats and integers may say about a cell: counts, zero for nothing.
fn transcription(sighting: &Sighting, model: &SensorModel, cell: CellIndex) -> Vec<i8> {
    let scanner = sighting.scanner_m();
    let x = middle(cell.column()) - scanner.0;
    let y = middle(cell.row()) - scanner.1;
    let (distance, bearing) = (x.hypot(y), y.atan2(x));
    let echoes = sighting.echoes();
    let deviation = |direction: f64| ((direction - bearing + PI).rem_euclid(TAU) - PI).abs();
    let nearest = echoes
        .iter()
        .map(|beam| deviation(beam.0))
        .fold(f64::INFINITY, f64::min);
    let half = f64::from(sighting.scanner.increment.unsigned_abs()) / 4_294_967_296.0 * PI;
    let tie = TIE_RAD + 2e-5 / distance.max(1e-6);
    let mut said = Vec::new();
    if nearest > half - tie {
        said.push(0);
    }
    if nearest > half + tie {
        return said;
    }
    for (_, echo) in echoes
        .iter()
        .filter(|beam| deviation(beam.0) <= nearest + tie)
    {
        said.extend(evidences(model, (distance * 1e6) as i64, *echo));
    }
    said
}

fn evidences(model: &SensorModel, distance_um: i64, echo: Option<Echo>) -> [i8; 3] {
    [-TIE_UM, 0, TIE_UM].map(|off| {
        let evidence = echo.and_then(|echo| model.evidence(distance_um + off, echo));
        evidence.unwrap_or_default().as_counts()
    })
}

/// Cells where the map disagrees, and where the transcription itself is undecided.
fn compare(sighting: &Sighting, said_of: &Sighting) -> (usize, usize) {
    let mut map: Map = sighting.map(UpdateRule::NearestBeam);
    sighting.enter(&mut map);
    let model = map.rules().model;
    let (mut wrong, mut undecided) = (0, 0);
    for cell in map.cells() {
        let said = transcription(said_of, &model, cell);
        let ours = map.log_odds(cell).map_or(0, LogOdds::as_counts);
        wrong += usize::from(!said.contains(&ours));
        undecided += usize::from(said.iter().any(|other| *other != said[0]));
    }
    (wrong, undecided)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn equals_the_transcription(sighting in sighting()) {
        let (wrong, undecided) = compare(&sighting, &sighting);
        prop_assert_eq!(wrong, 0);
        // Rounding excuses next to nothing.
        prop_assert!(undecided < 20, "{} of 1920 undecided", undecided);
    }
}

/// The comparison must see a scan that is moved by a millimetre each way.
#[test]
fn a_slightly_different_scan_is_told_apart() {
    let told_apart = sample(100)
        .iter()
        .filter(|sighting| {
            let mut other = (*sighting).clone();
            other.pose.x_um += 1000;
            other.pose.y_um += 1000;
            compare(sighting, &other).0 > 0
        })
        .count();
    // The others look off the map, or hardly at all.
    assert!(told_apart > 60, "{told_apart} of 100");
}
