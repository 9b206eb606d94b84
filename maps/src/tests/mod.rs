//! Round trips, the conventions of `map_server`, and hostile files.

mod files;
mod hostile;
mod meaning;

use crate::Map;
use haltline::grid::Occupancy;
use proptest::prelude::*;

fn any_occupancy() -> impl Strategy<Value = Occupancy> {
    prop::sample::select(&[Occupancy::Free, Occupancy::Occupied, Occupancy::Unknown][..])
}

prop_compose! {
    fn any_map()(width in 1_usize..30, height in 1_usize..30)(
        cells in prop::collection::vec(any_occupancy(), width * height),
        resolution_m in 0.01..1.0,
        origin in [-2000.0..2000.0, -2000.0..2000.0, -3.1..3.1],
        width in Just(width),
        height in Just(height),
    ) -> Map {
        Map { width, height, resolution_m, origin, cells }
    }
}
