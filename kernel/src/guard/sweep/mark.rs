//! Which space a scan has looked at: its visible polygon on the window of cells.

use super::{Sweep, SweepRules};
use crate::config::Scanner;
use crate::guard::seen::{CELLS, CellPoint, Rows, Seen, flip_left_of_edge};
use crate::input::Beam;

impl<const B: usize> Sweep<B> {
    /// Marks every cell in `seen` whose centre this scan looked at.
    ///
    /// # Bound
    /// O(beams + rows crossed by the polygon's edges).
    /// # Source
    /// MEMORY-06: visibility is per beam; between two beams the nearer range counts unless
    /// both returns bound one surface.
    pub fn mark_seen(&self, scanner: &Scanner, rules: SweepRules, seen: &mut Seen) {
        let mut rows: Rows = [0; CELLS];
        let start = seen.cell_point(self.point_at(0, 0));
        let mut pen = start;
        let mut line = |rows: &mut Rows, to: CellPoint| {
            flip_left_of_edge(rows, pen, to);
            pen = to;
        };
        for index in 1..self.count {
            let (before, here) = (index.saturating_sub(1), index);
            let (mut first, mut second) = (
                self.clear_mm(scanner, rules, before),
                self.clear_mm(scanner, rules, here),
            );
            if first.abs_diff(second) > rules.join_mm.unsigned_abs() || first == 0 || second == 0 {
                first = first.min(second);
                second = first;
            }
            line(&mut rows, seen.cell_point(self.point_at(before, first)));
            line(&mut rows, seen.cell_point(self.point_at(here, second)));
        }
        let last = self.point_at(self.count.saturating_sub(1), 0);
        line(&mut rows, seen.cell_point(last));
        line(&mut rows, start);
        //= spec/memory.md#memory-06
        //# A cell MUST be unknown unless its centre was inside the visible region of a usable scan or the area
        //# cleared at start.
        seen.mark(&rows);
    }

    /// Up to which range beam `index` found nothing, mm.
    fn clear_mm(&self, scanner: &Scanner, rules: SweepRules, index: usize) -> i32 {
        let millimetres = |um: i32| um.div_euclid(1000);
        let clear = match self.beams.get(index) {
            Some(Beam::Hit(range)) => i32::from(*range)
                .saturating_sub(millimetres(scanner.error.as_um()).saturating_add(1)),
            //= spec/input.md#input-04
            //# A no-return beam MUST NOT make space known beyond the `no_return_clear` distance of its scanner.
            Some(Beam::NoReturn) => millimetres(scanner.no_return_clear.as_um()),
            //= spec/input.md#input-03
            //# The ray of an invalid beam MUST leave the space it crosses unknown.
            _ => 0,
        };
        clear.max(0).min(rules.clear_max_mm)
    }
}
