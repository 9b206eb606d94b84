//! The every-beam rule against a slow intersection of every beam with every cell, in floats.

use super::world::{Map, Sighting, middle, pose, rules, sample, scanner, sighting};
use crate::grid::{CellIndex, Echo, GridRules, LogOdds, Occupancy, SensorModel, UpdateRule};
use crate::input::{Beam, Pose};
use proptest::prelude::*;

/// Integers and floats may differ by this in the plane, metres.
const TIE_M: f64 = 3e-5;

/// What a cell may be: the range of its evidence, and whether it may have none.
struct Said {
    least: i8,
    most: i8,
    nothing: bool,
    hit_surely: bool,
    hit_perhaps: bool,
}

fn transcription(sighting: &Sighting, model: &SensorModel, cell: CellIndex) -> Said {
    let mut said = Said {
        least: i8::MIN,
        most: i8::MIN,
        nothing: true,
        hit_surely: false,
        hit_perhaps: false,
    };
    let (sx, sy) = sighting.scanner_m();
    let (x, y) = (middle(cell.column()) - sx, middle(cell.row()) - sy);
    let mut lowest = i8::MAX;
    for (direction, echo) in sighting.echoes() {
        let Some(echo) = echo else { continue };
        let (sin, cos) = direction.sin_cos();
        let reach = f64::from(reach_um(model, echo)) * 1e-6;
        if let Echo::Hit { range_um } = echo {
            let range = f64::from(range_um) * 1e-6;
            let off = (range * cos - x).abs().max((range * sin - y).abs());
            said.hit_surely |= off < 0.05 - TIE_M;
            said.hit_perhaps |= off < 0.05 + TIE_M;
        }
        if !crosses((x, y), (cos, sin), reach + TIE_M, 0.05 + TIE_M) {
            continue;
        }
        let along_um = ((x * cos + y * sin) * 1e6) as i64;
        let evidences = [-12, 0, 12].map(|off| model.evidence(along_um + off, echo));
        let known = evidences.iter().flatten().map(|value| value.as_counts());
        let Some(most) = known.clone().max() else {
            continue;
        };
        let least = known.min().unwrap_or(most);
        said.most = said.most.max(most);
        lowest = lowest.min(least);
        let surely = evidences.iter().all(Option::is_some)
            && crosses((x, y), (cos, sin), reach - TIE_M, 0.05 - TIE_M);
        if surely {
            said.nothing = false;
            said.least = said.least.max(least);
        }
    }
    if said.nothing {
        said.least = lowest;
    }
    said
}

fn reach_um(model: &SensorModel, echo: Echo) -> u32 {
    match echo {
        Echo::Clear { range_um } => range_um,
        Echo::Hit { range_um } => range_um + model.delta_3.as_um().unsigned_abs(),
    }
}

/// Whether the beam from the origin meets the square of this half edge around `middle`.
fn crosses(middle: (f64, f64), direction: (f64, f64), reach: f64, half: f64) -> bool {
    let slab = |middle: f64, direction: f64| -> (f64, f64) {
        if direction.abs() < 1e-12 {
            return if middle.abs() <= half {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else {
                (f64::INFINITY, f64::NEG_INFINITY)
            };
        }
        let (a, b) = ((middle - half) / direction, (middle + half) / direction);
        (a.min(b), a.max(b))
    };
    let (x, y) = (slab(middle.0, direction.0), slab(middle.1, direction.1));
    x.0.max(y.0).max(0.0) <= x.1.min(y.1).min(reach)
}

/// Cells where the map disagrees, and where the transcription itself is undecided.
fn compare(sighting: &Sighting, said_of: &Sighting) -> (usize, usize) {
    let mut map: Map = sighting.map(UpdateRule::EveryBeam);
    sighting.enter(&mut map);
    let rules = *map.rules();
    let hit = rules.model.occupied.max(rules.occupied_from).as_counts();
    let (mut wrong, mut undecided) = (0, 0);
    for cell in map.cells() {
        let said = transcription(said_of, &rules.model, cell);
        let ours = map.log_odds(cell).map_or(0, LogOdds::as_counts);
        let by_hit = said.hit_perhaps && ours == hit;
        let by_crossing = !said.hit_surely
            && ((said.nothing && ours == 0) || (said.least <= ours && ours <= said.most));
        wrong += usize::from(!(by_hit || by_crossing));
        let one_value = if said.nothing {
            said.most == i8::MIN
        } else {
            said.least == said.most
        };
        let decided = said.hit_surely || (one_value && !said.hit_perhaps);
        undecided += usize::from(!decided);
    }
    (wrong, undecided)
}

/// A scanner that turns the other way and reports its beams in the opposite order.
fn reversed(sighting: &Sighting) -> Sighting {
    let mut other = sighting.clone();
    let steps = sighting.beams.len() as u32 - 1;
    let span = sighting
        .scanner
        .increment
        .cast_unsigned()
        .wrapping_mul(steps);
    other.scanner.first_beam = crate::units::BinaryAngle::from_counts(
        sighting.scanner.first_beam.as_counts().wrapping_add(span),
    );
    other.scanner.increment = -sighting.scanner.increment;
    other.beams.reverse();
    other
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn equals_the_transcription(sighting in sighting()) {
        let (wrong, undecided) = compare(&sighting, &sighting);
        prop_assert_eq!(wrong, 0);
        prop_assert!(undecided < 60, "{} of 1920 undecided", undecided);
    }

    /// Whatever the map held before and whatever the other beams saw.
    #[test]
    fn no_hit_is_ever_lost(sighting in sighting(), before in any::<[i8; 32]>()) {
        let mut map = sighting.map(UpdateRule::EveryBeam);
        for (cell, value) in map.cells().zip(before.iter().cycle()) {
            map.set(cell, LogOdds::from_counts(*value));
        }
        sighting.enter(&mut map);
        let model = map.rules().model;
        for cell in map.cells() {
            if transcription(&sighting, &model, cell).hit_surely {
                prop_assert_eq!(map.occupancy(cell), Occupancy::Occupied);
            }
        }
    }

    #[test]
    fn the_order_of_beams_is_irrelevant(sighting in sighting(), nearest: bool) {
        let rule = if nearest { UpdateRule::NearestBeam } else { UpdateRule::EveryBeam };
        let (mut map, mut other) = (sighting.map(rule), sighting.map(rule));
        sighting.enter(&mut map);
        reversed(&sighting).enter(&mut other);
        for cell in map.cells() {
            prop_assert_eq!(map.log_odds(cell), other.log_odds(cell));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn cells_stay_within_their_clamps(sightings in prop::collection::vec(sighting(), 1..12)) {
        for rule in [UpdateRule::EveryBeam, UpdateRule::NearestBeam] {
            let mut map = Map::new(rules(rule), sightings[0].origin).unwrap();
            for (round, sighting) in sightings.iter().cycle().take(40).enumerate() {
                let at = Pose { x_um: sightings[0].pose.x_um + round as i64 * 7001, ..sightings[0].pose };
                map.update(&at, &sighting.scanner, &sighting.beams).unwrap();
            }
            let GridRules { floor, ceiling, .. } = *map.rules();
            for cell in map.cells() {
                let value = map.log_odds(cell).unwrap();
                prop_assert!(floor <= value && value <= ceiling);
            }
        }
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

/// A thin pole, hit by one of three beams through its cell; the other two look past it.
//= spec/grid.md#grid-02
//= type=test
//# With the every-beam rule, the cell of a hit MUST be occupied after the scan.
#[test]
fn the_nearest_beam_rule_loses_a_pole_that_every_beam_keeps() {
    let seen = |update| {
        let mut map = Map::new(rules(update), Pose::default()).unwrap();
        let fan = scanner(3, -0.01, 0.01);
        let beams = [Beam::Hit(3000), Beam::Hit(3000), Beam::Hit(2030)];
        for _ in 0..10 {
            map.update(&pose(1.05, 1.05, 0.0), &fan, &beams).unwrap();
        }
        map.occupancy(CellIndex::new(30, 10))
    };
    assert_eq!(seen(UpdateRule::NearestBeam), Occupancy::Free);
    assert_eq!(seen(UpdateRule::EveryBeam), Occupancy::Occupied);
}
