//! The skid factor of a skid-steered robot, from turns that were driven and measured.

/// A skid factor and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkidFit {
    /// True turn for each turn of the wheels, in (0, 1].
    pub factor: f64,
    /// Standard error of the factor; 0 for a single turn, which tells nothing of it.
    pub standard_error: f64,
    /// Turns used.
    pub turns: usize,
}

/// Least-squares factor through the origin from pairs of (wheel turn, true turn) in radians.
///
/// Turn at least a full circle each time, to both sides, and take the true turn from the scanner
/// or a mark on the floor. `None` if there is no turn of at least half a radian, a number is not
/// finite, the signs disagree, or the factor is not in (0.05, 1.05]; what is above 1 is taken for an error
/// of measurement and counts as 1.
/// # Source
/// Loh 2018, ch. 2: omega = xi (w_r - w_l) / 2 * d / L.
#[must_use]
pub fn skid_factor(turns: &[(f64, f64)]) -> Option<SkidFit> {
    let usable = |turn: &&(f64, f64)| turn.0.abs() >= 0.5 && turn.1.is_finite();
    let used = turns.iter().filter(usable);
    let count = used.clone().count();
    let same_sign = used.clone().all(|(wheel, real)| wheel * real > 0.0);
    if count == 0 || count < turns.len() || !same_sign {
        return None;
    }
    let square: f64 = used.clone().map(|(wheel, _)| wheel * wheel).sum();
    let product: f64 = used.clone().map(|(wheel, real)| wheel * real).sum();
    let factor = product / square;
    let rest: f64 = used
        .map(|(wheel, real)| (real - factor * wheel) * (real - factor * wheel))
        .sum();
    let freedom = count.saturating_sub(1);
    let standard_error = if freedom == 0 {
        0.0
    } else {
        libm::sqrt(rest / freedom as f64 / square)
    };
    (factor > 0.05 && factor <= 1.05).then_some(SkidFit {
        factor: factor.min(1.0),
        standard_error,
        turns: count,
    })
}
