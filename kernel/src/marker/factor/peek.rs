//! What only tests may look at: single entries of the covariance, and the pivots.

use super::Factor;

impl<const N: usize> Factor<N> {
    /// `P` between two numbers of the state; block 0 is the robot, 1.. the markers.
    pub(in crate::marker) fn entry(&self, a: (usize, usize), b: (usize, usize)) -> f64 {
        let at = |(block, part): (usize, usize), j: usize, c: usize| match block.checked_sub(1) {
            Some(marker) => self.columns[j][c][marker][part],
            None => self.robot_rows[j][c][part],
        };
        let markers = (0..self.len).flat_map(|j| (0..3).map(move |c| (j, c)));
        let explained: f64 = markers
            .map(|(j, c)| at(a, j, c) * at(b, j, c) * self.pivots[j][c])
            .sum();
        let own = if a.0 == 0 && b.0 == 0 {
            self.robot.matrix()[a.1][b.1]
        } else {
            0.0
        };
        explained + own
    }

    /// Every pivot, and whether all that is stored is finite.
    pub(in crate::marker) fn pivots(&self) -> (std::vec::Vec<f64>, bool) {
        let markers = self.pivots.iter().take(self.len).flatten();
        let pivots = markers.chain(&self.robot.pivots).copied().collect();
        let rows = self.robot_rows.iter().take(self.len).flatten().flatten();
        let columns = self.columns.iter().take(self.len).flatten();
        let below = columns.flat_map(|column| column.iter().take(self.len).flatten());
        let mut all = rows.chain(below).chain(&self.robot.below);
        (pivots, all.all(|entry| entry.is_finite()))
    }
}
