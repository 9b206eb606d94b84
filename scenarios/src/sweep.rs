//! All combinations of a sweep's axes.

use toml::Value;

use crate::file::SweepAxis;

/// One combination: a label for its name, and what to put where.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Combination {
    /// Words of the axes, joined by `-`.
    pub label: String,
    /// Dotted paths and values.
    pub settings: Vec<(String, Value)>,
}

/// The product of all axes, the last one fastest.
#[must_use]
pub fn combinations(axes: &[&SweepAxis]) -> Vec<Combination> {
    axes.iter().fold(vec![Combination::default()], |all, axis| {
        all.iter()
            .flat_map(|so_far| points(axis).into_iter().map(|point| join(so_far, &point)))
            .collect()
    })
}

fn join(left: &Combination, right: &Combination) -> Combination {
    let label = if left.label.is_empty() {
        right.label.clone()
    } else {
        format!("{}-{}", left.label, right.label)
    };
    let settings = left
        .settings
        .iter()
        .chain(&right.settings)
        .cloned()
        .collect();
    Combination { label, settings }
}

fn points(axis: &SweepAxis) -> Vec<Combination> {
    let (Some(path), Some(from), Some(to), Some(count)) =
        (&axis.path, axis.from, axis.to, axis.count)
    else {
        return axis
            .values
            .iter()
            .map(|value| Combination {
                label: format!("{}_{}", axis.name, value.label),
                settings: value.set.clone().into_iter().collect(),
            })
            .collect();
    };
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count)
        .map(|index| {
            let part = index as f64 / last;
            let value = from.get() + (to.get() - from.get()) * part;
            Combination {
                label: format!("{}_{index:02}", axis.name),
                settings: vec![(path.clone(), Value::Float(value))],
            }
        })
        .collect()
}
