//! Numbers that refuse what makes no sense while the file is read, so the error knows its line.

use serde::{Deserialize, Deserializer, de::Error};

macro_rules! checked {
    ($(#[$doc:meta])* $name:ident, $ok:expr, $want:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// The number.
            #[must_use]
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let value = f64::deserialize(deserializer)?;
                let ok: fn(f64) -> bool = $ok;
                if ok(value) {
                    Ok(Self(value))
                } else {
                    Err(D::Error::custom(format!("{value} is not {}", $want)))
                }
            }
        }
    };
}

checked!(
    /// Finite and small enough to be meant.
    Number, |v| v.abs() <= 1e6, "a finite number; write one between -1e6 and 1e6"
);
checked!(
    /// Above zero.
    Positive, |v| v > 0.0 && v <= 1e6, "above zero; write a number such as 0.5"
);
checked!(
    /// Zero or above.
    NonNegative, |v| (0.0..=1e6).contains(&v), "zero or above; write a number such as 0.5"
);
checked!(
    /// From 0 to 1.
    Fraction, |v| (0.0..=1.0).contains(&v), "a part of one; write a number from 0 to 1"
);

/// A point or vector.
pub type Pair = [Number; 2];

/// Plain floats of a pair.
#[must_use]
pub const fn floats(pair: Pair) -> [f64; 2] {
    [pair[0].get(), pair[1].get()]
}
