//! Indices of the planning grid.

use haltline::grid::{ring, slot};

const SIZE: usize = 300;

fn indices(fault: usize) {
    let low: i32 = kani::any();
    kani::assume(low >= -1_000_000_000 && low <= 1_000_000_000);
    let start = ring(low, SIZE);
    assert!(start < SIZE);
    let (a, b): (i32, i32) = (kani::any(), kani::any());
    kani::assume(a >= -1_000_000_000 && a <= 1_000_000_300);
    kani::assume(b >= -1_000_000_000 && b <= 1_000_000_300);
    let (at, other) = (slot(a, low, start, SIZE), slot(b, low, start, SIZE));
    kani::cover!(at.is_some() && other.is_some() && a != b);
    kani::cover!(at.is_none());
    assert!(at.is_some() == (a >= low && i64::from(a) < i64::from(low) + 300));
    if let (Some(at), Some(other)) = (at, other) {
        assert!(at + fault < SIZE && other < SIZE);
        assert!((at == other) == (a == b));
    }
}

/// A cell of the map has a place of its own inside the arrays, and no other cell has one; every
/// index and window within ±10⁹, 300 cells.
#[kani::proof]
fn cells_have_places_of_their_own() {
    indices(0);
}

#[kani::proof]
#[kani::should_panic]
fn cells_have_places_of_their_own_twin() {
    indices(1);
}
