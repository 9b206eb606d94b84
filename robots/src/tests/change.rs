//! Changed values pass the same rules as the file, and say what they replaced.

use crate::{Change, ChangeError, Robot};

fn seekur_with(changes: &[(&str, &str)]) -> Result<(Robot, Vec<Change>), ChangeError> {
    let robot = Robot::embedded("seekur_jr").unwrap();
    let mut changes: Vec<_> = changes.iter().map(|(k, v)| Change::new(k, v)).collect();
    robot
        .with_changes(&mut changes)
        .map(|robot| (robot, changes))
}

#[test]
fn values_replace_those_of_the_file() {
    let (robot, changes) = seekur_with(&[
        ("scanner.0.error_systematic_m", "0.002"),
        ("scanner.0.error_sigma_m", "0.001"),
        ("tolerances.tracking_m", "0.005"),
    ])
    .unwrap();
    assert!((robot.values.scanners[0].error_m() - 0.005).abs() < 1e-12);
    assert!((robot.values.tolerances.tracking_m - 0.005).abs() < 1e-12);
    assert_eq!(changes[0].before, "0.030");
    assert_eq!(changes[2].before, "0.020");
    assert!(changes[0].differs());
    let mut same = Change::new("tolerances.tracking_m", "0.02");
    same.before = "0.020".to_owned();
    assert!(!same.differs());
    // The kernel's integers follow.
    assert_ne!(robot.config, Robot::embedded("seekur_jr").unwrap().config);
}

#[test]
fn unknown_keys_and_whole_tables_are_refused() {
    for key in [
        "tolerances.tracking",
        "scanner.1.beams",
        "scanner.0",
        "limits",
        "",
        "scanner",
    ] {
        let error = seekur_with(&[("limits.braking_mps2", "0.6"), (key, "0.5")]).unwrap_err();
        assert_eq!(error.index, Some(1), "{key}: {}", error.message);
        assert!(error.message.contains("has no key"), "{}", error.message);
    }
}

#[test]
fn bounds_and_rules_hold_for_changed_values() {
    let error = seekur_with(&[("limits.braking_mps2", "-0.5")]).unwrap_err();
    assert_eq!(error.index, Some(0));
    assert!(
        error.message.contains("`braking_mps2` cannot be -0.5"),
        "{}",
        error.message
    );
    let error = seekur_with(&[
        ("tolerances.tracking_m", "0.01"),
        ("timing.jitter_s", "0.05"),
    ]);
    let error = error.unwrap_err();
    assert_eq!(error.index, Some(1), "{}", error.message);
    // The rule blames another key than the changed one.
    let error = seekur_with(&[("limits.speed_forward_mps", "0.004")]).unwrap_err();
    assert_eq!(error.index, None);
    assert!(error.message.contains("rest"), "{}", error.message);
}
