//! Integer quantities of the safety core.
//!
//! Every value that crosses a module boundary is one of these newtypes. They
//! refuse to know floats: [`crate::convert`] is the only place that does.

/// Defines a transparent integer quantity with its unit in the constructor name.
macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident($repr:ty), $from:ident, $to:ident, $unit:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name($repr);

        impl $name {
            /// Zero.
            pub const ZERO: Self = Self(0);

            #[doc = concat!("From a count of ", $unit, ".")]
            #[must_use]
            pub const fn $from(value: $repr) -> Self {
                Self(value)
            }

            #[doc = concat!("As a count of ", $unit, ".")]
            #[must_use]
            pub const fn $to(self) -> $repr {
                self.0
            }
        }
    };
}

quantity!(
    /// Length in micrometres (±2147 m).
    Length(i32), from_um, as_um, "micrometres"
);
quantity!(
    /// Linear speed in micrometres per second, positive forward (REP 103).
    Speed(i32), from_um_per_s, as_um_per_s, "micrometres per second"
);
quantity!(
    /// Angular speed in microradians per second, positive counter-clockwise.
    AngularSpeed(i32), from_urad_per_s, as_urad_per_s, "microradians per second"
);
quantity!(
    /// Magnitude of a linear acceleration in micrometres per second squared.
    Acceleration(u32), from_um_per_s2, as_um_per_s2, "micrometres per second squared"
);
quantity!(
    /// Magnitude of an angular acceleration in microradians per second squared.
    AngularAcceleration(u32), from_urad_per_s2, as_urad_per_s2, "microradians per second squared"
);
quantity!(
    /// Path curvature in microradians per metre (10⁻⁶/m), positive to the left.
    Curvature(i32), from_urad_per_m, as_urad_per_m, "microradians per metre"
);
quantity!(
    /// Dimensionless ratio in parts per million.
    Ppm(u32), from_ppm, as_ppm, "parts per million"
);

impl Length {
    /// From whole millimetres; saturates at the ends of the range (±2147 m).
    #[must_use]
    pub const fn from_mm(mm: i32) -> Self {
        Self(mm.saturating_mul(1000))
    }
}

/// Angle as a fraction of a full turn: 2³² counts are one turn, and addition wraps.
///
/// The resolution is 1.5 nrad, so headings accumulate without visible rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BinaryAngle(u32);

impl BinaryAngle {
    /// Zero angle.
    pub const ZERO: Self = Self(0);

    /// From counts of 2⁻³² turn.
    #[must_use]
    pub const fn from_counts(counts: u32) -> Self {
        Self(counts)
    }

    /// As counts of 2⁻³² turn.
    #[must_use]
    pub const fn as_counts(self) -> u32 {
        self.0
    }

    /// Sum of two angles; wraps at the full turn, which is what angles do.
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// Signed shortest rotation from `other` to `self`, in counts of 2⁻³² turn.
    ///
    /// Half a turn maps to `i32::MIN`.
    #[must_use]
    pub const fn minus(self, other: Self) -> i32 {
        self.0.wrapping_sub(other.0).cast_signed()
    }
}
