//! Which checks a composed claim rests on; the argument that joins them is written in
//! `verification/README.md` and `spec/model.md`.

/// One step of a written argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// What the step says.
    pub says: &'static str,
    /// Names of checks; one that ends in `::` stands for every check of that module.
    pub pieces: &'static [&'static str],
}

/// The pieces of GUARD: no accepted tube contains a known point.
pub const GUARD: [Step; 5] = [
    Step {
        says: "touching means inside",
        pieces: &[
            "lemma::composition",
            "lemma::obstacle_growth",
            "lemma::beam_gap",
            "lemma::hull_interval",
            "lemma::spread_step",
            "lemma::sampling",
            "lemma::latest_time",
            "lemma::rounding_budget",
            "lemma::rotation",
            "lemma::recurrence",
            "lemma::chord",
            "intervals::sine_below",
        ],
    },
    Step {
        says: "the code has these terms",
        pieces: &["tube::", "braking::", "angles::", "hull::"],
    },
    Step {
        says: "inside means refused",
        pieces: &["rect::", "guard::", "shapes::", "geometry::"],
    },
    Step {
        says: "refusing is safe",
        pieces: &[
            "lemma::brake_now_stays",
            "lemma::brake_again_stays",
            "lemma::braking_induction",
            "lemma::ramp_at_rest",
        ],
    },
    Step {
        says: "stopping stops",
        pieces: &["stop::", "watch::", "kernel::"],
    },
];

/// Whether a check is a piece of one of the steps.
#[must_use]
pub fn is_piece(steps: &[Step], id: &str) -> bool {
    steps
        .iter()
        .flat_map(|step| step.pieces)
        .any(|piece| stands_for(piece, id))
}

/// Whether a name in a step stands for this check.
fn stands_for(piece: &str, id: &str) -> bool {
    piece == id || (piece.ends_with("::") && id.starts_with(piece))
}

/// Names in the steps for which there is no check among `known`.
#[must_use]
pub fn unknown_pieces(steps: &[Step], known: &[&str]) -> Vec<&'static str> {
    steps
        .iter()
        .flat_map(|step| step.pieces.iter().copied())
        .filter(|piece| !known.iter().any(|id| stands_for(piece, id)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove::check::checks;
    use crate::prove::command::checkout;

    #[test]
    fn every_piece_is_a_check_and_stands_in_the_written_argument() {
        let root = checkout();
        let all = checks(&root).unwrap();
        let known: Vec<&str> = all.iter().map(|check| check.entry.id.as_str()).collect();
        assert_eq!(unknown_pieces(&GUARD, &known), Vec::<&str>::new());
        let argument = std::fs::read_to_string(root.join("verification/README.md")).unwrap();
        for piece in GUARD.iter().flat_map(|step| step.pieces) {
            let name = piece.strip_prefix("lemma::").unwrap_or(piece);
            assert!(argument.contains(name), "README.md does not name {piece}");
        }
        for step in GUARD {
            let says = step.says;
            assert!(argument.to_lowercase().contains(says), "README.md: {says}");
        }
    }

    #[test]
    fn a_module_stands_for_its_checks_and_for_no_other() {
        assert!(is_piece(&GUARD, "guard::a_point_before_hides_nothing"));
        assert!(is_piece(&GUARD, "lemma::chord"));
        assert!(!is_piece(&GUARD, "lemma::host_death") && !is_piece(&GUARD, "grid::cells"));
        assert_eq!(unknown_pieces(&GUARD[..1], &["lemma::chord"]).len(), 11);
    }
}
