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
    Positive, |v| v > 0.0 && v <= 1e6, "above zero and at most 1e6; write a number such as 0.5"
);
checked!(
    /// Zero or above.
    NonNegative, |v| (0.0..=1e6).contains(&v), "zero or above and at most 1e6; write a number such as 0.5"
);
checked!(
    /// From 0 to 1.
    Fraction, |v| (0.0..=1.0).contains(&v), "a part of one; write a number from 0 to 1"
);

checked!(
    /// How long data or commands are on their way.
    Delay, |v| (0.0..=10.0).contains(&v), "a delay; write seconds from 0 to 10"
);
checked!(
    /// How long a run may take.
    Timeout, |v| v > 0.0 && v <= 3600.0, "a time limit; write seconds above 0, at most 3600"
);

/// An array that must have as many numbers as it needs: the reader itself drops surplus ones.
#[derive(Deserialize)]
#[serde(transparent)]
struct Exact<T, const N: usize>(
    #[serde(
        deserialize_with = "exactly",
        bound(deserialize = "T: Deserialize<'de>")
    )]
    [T; N],
);

/// An array of exactly `N`.
pub(super) fn exactly<'de, D, T, const N: usize>(deserializer: D) -> Result<[T; N], D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    let list = Vec::<T>::deserialize(deserializer)?;
    let given = list.len();
    list.try_into()
        .map_err(|_| D::Error::custom(format!("{given} values stand here; write exactly {N}")))
}

/// An array of exactly `N` for a key that may be left out.
pub(super) fn perhaps<'de, D, T, const N: usize>(
    deserializer: D,
) -> Result<Option<[T; N]>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    exactly(deserializer).map(Some)
}

/// A list of points for a key that may be left out, each of exactly `N`.
pub(super) fn points<'de, D, const N: usize>(
    deserializer: D,
) -> Result<Option<Vec<[Number; N]>>, D::Error>
where
    D: Deserializer<'de>,
{
    let list = Vec::<Exact<Number, N>>::deserialize(deserializer)?;
    Ok(Some(list.into_iter().map(|Exact(point)| point).collect()))
}

/// Time windows that end after they begin.
pub(super) fn windows<'de, D>(deserializer: D) -> Result<Vec<[NonNegative; 2]>, D::Error>
where
    D: Deserializer<'de>,
{
    let list = Vec::<Exact<NonNegative, 2>>::deserialize(deserializer)?;
    let list: Vec<_> = list.into_iter().map(|Exact(window)| window).collect();
    match list.iter().find(|[from, until]| until <= from) {
        Some([from, until]) => Err(D::Error::custom(format!(
            "the window from {} to {} never is; write [from_s, until_s] with until_s after from_s",
            from.get(),
            until.get()
        ))),
        None => Ok(list),
    }
}

/// A point or vector.
pub type Pair = [Number; 2];

/// Plain floats of a pair.
#[must_use]
pub const fn floats(pair: Pair) -> [f64; 2] {
    [pair[0].get(), pair[1].get()]
}
