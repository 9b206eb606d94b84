//! Three by three blocks in plain `f64`, with indices known at compile time.
//!
//! It refuses to divide by a pivot below [`PIVOT_MIN`]: it takes the bound instead, so that a
//! factor has a positive diagonal whatever it is made from. Nor does it believe in correlations
//! beyond one, which rounding makes: no variance of a factor exceeds the one it was made from.

/// A column [x, y, heading].
pub(super) type Vector = [f64; 3];
/// Rows of a block.
pub(super) type Matrix = [Vector; 3];

pub(super) const ZERO: Matrix = [[0.0; 3]; 3];
pub(super) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Least variance that any part of a state keeps, m² or rad²: (10 nm)².
pub(super) const PIVOT_MIN: f64 = 1e-16;

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `m v`.
pub(super) fn apply(m: &Matrix, v: Vector) -> Vector {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

/// `a bᵀ`.
pub(super) fn times_transposed(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| apply(b, row))
}

pub(super) fn transposed(m: &Matrix) -> Matrix {
    [
        [m[0][0], m[1][0], m[2][0]],
        [m[0][1], m[1][1], m[2][1]],
        [m[0][2], m[1][2], m[2][2]],
    ]
}

/// `a b`.
pub(super) fn times(a: &Matrix, b: &Matrix) -> Matrix {
    times_transposed(a, &transposed(b))
}

/// `a c aᵀ` for a symmetric `c`.
pub(super) fn sandwich(a: &Matrix, c: &Matrix) -> Matrix {
    symmetric(&times_transposed(&times_transposed(a, c), a))
}

fn symmetric(m: &Matrix) -> Matrix {
    let (a, b, c) = (m[1][0], m[2][0], m[2][1]);
    [[m[0][0], a, b], [a, m[1][1], c], [b, c, m[2][2]]]
}

pub(super) fn sum(a: &Matrix, b: &Matrix) -> Matrix {
    [add(a[0], b[0]), add(a[1], b[1]), add(a[2], b[2])]
}

pub(super) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `m − k`, block by block.
pub(super) fn difference(m: &Matrix, k: &Matrix) -> Matrix {
    [
        subtract(m[0], k[0]),
        subtract(m[1], k[1]),
        subtract(m[2], k[2]),
    ]
}

pub(super) fn diagonal(v: Vector) -> Matrix {
    [[v[0], 0.0, 0.0], [0.0, v[1], 0.0], [0.0, 0.0, v[2]]]
}

/// `covariance / pivot`, but at most what explains the whole `variance`.
fn slope(covariance: f64, pivot: f64, variance: f64) -> f64 {
    let slope = covariance / pivot;
    if slope * slope * pivot <= variance {
        slope
    } else {
        libm::copysign(libm::sqrt(variance.max(0.0) / pivot), covariance)
    }
}

/// `L D Lᵀ` with a unit lower triangle `L` and a positive diagonal `D`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ldl {
    /// Entries (1,0), (2,0), (2,1) of `L`.
    pub(super) below: Vector,
    /// The diagonal of `D`.
    pub(super) pivots: Vector,
}

impl Ldl {
    /// Factor of a symmetric matrix, of which only the lower triangle is read.
    pub(super) fn of(m: &Matrix) -> Self {
        let d0 = m[0][0].max(PIVOT_MIN);
        let l10 = slope(m[1][0], d0, m[1][1]);
        let l20 = slope(m[2][0], d0, m[2][2]);
        let d1 = (m[1][1] - l10 * l10 * d0).max(PIVOT_MIN);
        let rest = m[2][2] - l20 * l20 * d0;
        let l21 = slope(m[2][1] - l20 * l10 * d0, d1, rest);
        let d2 = (rest - l21 * l21 * d1).max(PIVOT_MIN);
        Self {
            below: [l10, l20, l21],
            pivots: [d0, d1, d2],
        }
    }

    /// The columns of `L`.
    pub(super) const fn columns(&self) -> Matrix {
        let [l10, l20, l21] = self.below;
        [[1.0, l10, l20], [0.0, 1.0, l21], [0.0, 0.0, 1.0]]
    }

    /// The product `L D Lᵀ`.
    pub(super) fn matrix(&self) -> Matrix {
        sandwich(&transposed(&self.columns()), &diagonal(self.pivots))
    }

    /// `L⁻¹ v`.
    pub(super) fn forward(&self, v: Vector) -> Vector {
        let [l10, l20, l21] = self.below;
        let y1 = v[1] - l10 * v[0];
        [v[0], y1, v[2] - l20 * v[0] - l21 * y1]
    }

    /// `(L D Lᵀ)⁻¹ v`.
    pub(super) fn solve(&self, v: Vector) -> Vector {
        let [l10, l20, l21] = self.below;
        let y = self.forward(v);
        let z2 = y[2] / self.pivots[2];
        let z1 = y[1] / self.pivots[1] - l21 * z2;
        [y[0] / self.pivots[0] - l10 * z1 - l20 * z2, z1, z2]
    }

    /// `vᵀ (L D Lᵀ)⁻¹ v`.
    pub(super) fn distance(&self, v: Vector) -> f64 {
        let y = self.forward(v);
        y[0] * y[0] / self.pivots[0] + y[1] * y[1] / self.pivots[1] + y[2] * y[2] / self.pivots[2]
    }
}
