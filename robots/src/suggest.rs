//! What the writer of an unknown name may have meant.

/// "write `x`" if a known name is near, else the list of names.
pub(crate) fn suggestion(unknown: &str, known: &[&str]) -> String {
    let stem = |name: &str| {
        name.rsplit_once('_')
            .map_or(name.len(), |(stem, _)| stem.len())
    };
    let same_stem = known
        .iter()
        .find(|name| unknown.get(..stem(unknown)) == name.get(..stem(name)) && name.contains('_'));
    if let Some(name) = same_stem {
        return format!("write `{name}`: the unit is part of the key");
    }
    let near = known
        .iter()
        .map(|name| (distance(unknown, name), *name))
        .min()
        .filter(|(distance, name)| distance * 3 <= name.len().max(3));
    match near {
        Some((_, name)) => format!("write `{name}` or remove it"),
        None => format!("remove it or write one of: {}", known.join(", ")),
    }
}

/// Levenshtein distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut next = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let replace = row.get(j).copied().unwrap_or(0) + usize::from(x != *y);
            let delete = row.get(j + 1).copied().unwrap_or(0) + 1;
            let insert = next.get(j).copied().unwrap_or(0) + 1;
            next.push(replace.min(delete).min(insert));
        }
        row = next;
    }
    row.last().copied().unwrap_or(0)
}
