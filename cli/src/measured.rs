//! Coverage and mutants of the safety core: figures kept with the sources, compared with the kernel compiled in.
//!
//! They are shown, and no claim rests on them: a line that ran may be wrong.

use crate::provenance::MEASURED;
pub use haltline_verification::measure::Standing;

/// The figures as they stood when this command was built.
#[must_use]
pub fn standing() -> Standing {
    serde_json::from_str(MEASURED).unwrap_or_default()
}

/// One sentence for each measurement.
#[must_use]
pub fn sentences(standing: &Standing) -> Vec<String> {
    vec![coverage(standing), mutants(standing)]
}

fn coverage(standing: &Standing) -> String {
    let Some(figures) = &standing.measured.coverage else {
        return "coverage: never measured".to_owned();
    };
    let ([lines, all], [regions, all_regions]) = (figures.lines, figures.regions);
    format!(
        "coverage: tests run {lines} of {all} lines and {regions} of {all_regions} regions of the safety core, {}",
        origin(
            &figures.source_sha256,
            &figures.tool,
            standing.coverage_fresh
        )
    )
}

fn mutants(standing: &Standing) -> String {
    let Some(figures) = &standing.measured.mutants else {
        return "mutants: never tried".to_owned();
    };
    let [tried, all] = figures.tried;
    let viable = tried - figures.unviable;
    let noticed = figures.caught + figures.timed_out;
    let [number, count] = figures.shard;
    format!(
        "mutants: tests notice {noticed} of {viable} changes that compile; {tried} of {all} tried (shard {number} of {count}), {}",
        origin(
            &figures.source_sha256,
            &figures.tool,
            standing.mutants_fresh
        )
    )
}

fn origin(hash: &str, tool: &str, fresh: bool) -> String {
    let stale = if fresh {
        "fresh"
    } else {
        "stale: the safety core has changed since"
    };
    format!(
        "measured on source hash {}, {stale} ({tool})",
        hash.get(..12).unwrap_or(hash)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use haltline_verification::measure::{Coverage, Measured, Mutants};
    use std::collections::BTreeMap;

    fn figures(fresh: bool) -> Standing {
        Standing {
            measured: Measured {
                coverage: Some(Coverage {
                    source_sha256: "ab".repeat(32),
                    tool: "cargo-llvm-cov 1.2.3".to_owned(),
                    lines: [90, 100],
                    regions: [7, 9],
                    files: BTreeMap::new(),
                }),
                mutants: Some(Mutants {
                    source_sha256: "cd".repeat(32),
                    tool: "cargo-mutants 4.5.6".to_owned(),
                    shard: [3, 25],
                    tried: [12, 300],
                    caught: 8,
                    timed_out: 1,
                    unviable: 2,
                    missed: vec!["x".to_owned()],
                }),
            },
            coverage_fresh: fresh,
            mutants_fresh: false,
        }
    }

    #[test]
    fn figures_say_what_they_are_of() {
        let said = sentences(&figures(true));
        assert!(
            said[0].contains("90 of 100 lines") && said[0].contains("fresh (cargo-llvm-cov 1.2.3)")
        );
        assert!(said[1].contains("9 of 10 changes that compile; 12 of 300 tried (shard 3 of 25)"));
        assert!(
            said[1].contains("stale") && said[1].contains("cdcdcdcd"),
            "{said:?}"
        );
        assert!(sentences(&figures(false))[0].contains("stale"));
        assert_eq!(sentences(&Standing::default())[1], "mutants: never tried");
    }
}
