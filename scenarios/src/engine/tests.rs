//! The engine against hand values, and with controllers that deserve to be caught.

use super::*;
use crate::batch::{run_case, run_one};
use crate::result::Outcome;
use crate::testing::{PassThrough, ROOM, case, robot, scenario};

fn monitor(result: &RunResult, id: &str) -> u64 {
    let found = result.monitors.iter().find(|m| m.id == id);
    found.expect("every monitor reports").violation_count
}

#[test]
fn naked_run_touches_when_arithmetic_says_so() {
    let run = run(&scenario(ROOM), &robot(), None);
    let contact = run.result.contacts.first().expect("it drives into the box");
    assert!(contact.robot_moving);
    assert_eq!(contact.body, "target");
    // Released at 0.4 s, ramp 1 s for 0.25 m, then 2.15 m at 0.5 m/s, and a delay of
    // 60 ms latency and 20 ms lag. The ramp starts with its first step at 0.4 s.
    let expected = 0.4 + 1.0 + 2.15 / 0.5 + 0.08;
    assert!(
        (contact.t_s - expected).abs() < 0.05,
        "{} {expected}",
        contact.t_s
    );
    assert!(run.result.monitors.is_empty());
}

#[test]
fn same_scenario_same_bytes() {
    let short = ROOM
        .replace("timeout_s = 10.0", "timeout_s = 4.0")
        .replace("center_m = [3.25, 0.0]", "center_m = [1.75, 0.0]");
    let case = case(&short);
    let twice: Vec<_> = (0..2).filter_map(|_| run_one(&case, true)).collect();
    assert!(twice[0].trace == twice[1].trace, "the traces differ");
    assert!(twice[0].result == twice[1].result, "the results differ");
    let other = short.replace("seed = 5", "seed = 6");
    let different = run_one(&crate::testing::case(&other), true).expect("it runs");
    assert_ne!(
        twice[0].trace, different.trace,
        "the seed reaches the noise"
    );
}

#[test]
fn trace_has_a_line_for_every_step() {
    let text = ROOM.replace("timeout_s = 10.0", "timeout_s = 1.0");
    let run = run(&scenario(&text), &robot(), None);
    assert_eq!(run.trace.lines().count(), 101);
    assert!(run.trace.starts_with("{\"t_s\":0.000,\"x_m\":0.000000"));
    let last = run.trace.lines().last().unwrap_or_default();
    assert!(last.starts_with("{\"t_s\":1.000,"), "{last}");
}

#[test]
fn kernel_stops_before_the_box_and_its_twin_does_not() {
    let run = run_case(&case(ROOM)).expect("the kernel takes the robot");
    let judgement = &run.result.judgement;
    assert_eq!(
        judgement.outcome,
        Outcome::Pass,
        "{:?}",
        judgement.sentences
    );
    assert_eq!(run.result.guarded.moving_contacts(), 0);
    assert!(run.result.guarded.travelled_m > 1.5);
    assert!(run.naked_trace.is_some());
}

#[test]
fn controller_that_passes_everything_is_caught_by_the_claim() {
    let run = run(
        &scenario(ROOM),
        &robot(),
        Some(Box::<PassThrough>::default()),
    );
    assert_eq!(run.result.moving_contacts(), 1);
    assert!(monitor(&run.result, "CLAIM") > 0);
    assert!(monitor(&run.result, "ZONE") > 0);
    // It jumps to 0.5 m/s in one tick.
    assert!(monitor(&run.result, "LIMIT") > 0);
}

#[test]
fn broken_assumption_explains_a_contact_and_is_named() {
    let text = format!("{ROOM}\n[drive]\nbraking_mps2 = 0.01\n");
    let run = run(
        &scenario(&text),
        &robot(),
        Some(Box::<PassThrough>::default()),
    );
    assert_eq!(run.result.moving_contacts(), 1);
    assert_eq!(monitor(&run.result, "CLAIM"), 0);
    assert_eq!(run.result.assumptions_broken[0].id, "A-BRAKE");
}

#[test]
fn invisible_body_excuses_only_itself() {
    let text = ROOM.replace(
        "size_m = [0.5, 1.0]\n",
        "size_m = [0.5, 1.0]\n\n[[circle]]\nname = \"vase\"\ncenter_m = [-2.0, 0.0]\nradius_m = 0.1\n\
         material = \"invisible\"\n",
    );
    let run = run(
        &scenario(&text),
        &robot(),
        Some(Box::<PassThrough>::default()),
    );
    assert!(monitor(&run.result, "CLAIM") > 0, "the box was visible");
}

#[test]
fn body_that_runs_into_a_resting_robot_is_not_held_against_it() {
    let text = ROOM
        .replace("linear_mps = 0.5", "linear_mps = 0.0")
        .replace(
            "size_m = [0.5, 1.0]\n",
            "size_m = [0.5, 1.0]\nmotion = { velocity_mps = [-1.0, 0.0], from_s = 1.0 }\n",
        );
    let run = run(
        &scenario(&text),
        &robot(),
        Some(Box::<PassThrough>::default()),
    );
    assert_eq!(run.result.contacts.len(), 1);
    assert_eq!(run.result.moving_contacts(), 0);
    assert_eq!(monitor(&run.result, "CLAIM"), 0);
    let contact = &run.result.contacts[0];
    // 3.0 m to the box's face, 0.6 m to the front edge: 2.4 m at 1 m/s from 1 s on.
    assert!((contact.t_s - 3.4).abs() < 0.011, "{}", contact.t_s);
}

#[test]
fn adapter_stops_at_the_expiry_while_the_kernel_pauses() {
    let fault = "\n[[fault]]\nkind = \"host_pause\"\nfrom_s = 3.0\n";
    let paused = run(
        &scenario(&format!("{ROOM}{fault}")),
        &robot(),
        Some(Box::<PassThrough>::default()),
    );
    assert!(paused.result.at_rest && paused.result.contacts.is_empty());
    let deaf = format!("{ROOM}{fault}\n[drive]\nhonours_expiry = false\nsilence = \"none\"\n");
    let deaf = run(
        &scenario(&deaf),
        &robot(),
        Some(Box::<PassThrough>::default()),
    );
    assert_eq!(deaf.result.moving_contacts(), 1);
    assert_eq!(deaf.result.assumptions_broken[0].id, "A-WATCHDOG");
}

#[test]
fn pose_between_steps_is_interpolated() {
    let scenario = scenario(ROOM);
    let robot = robot();
    let mut engine = Engine::new(&scenario, &robot);
    engine.history = vec![Pose::new(0.0, 0.0, 0.0), Pose::new(0.01, 0.0, 0.002)];
    let half = engine.pose_at(5_000);
    assert!((half.x - 0.005).abs() < 1e-12 && (half.theta - 0.001).abs() < 1e-12);
    assert_eq!(engine.pose_at(10_000), engine.history[1]);
}

#[test]
fn only_what_reaches_into_the_vouched_disc_breaks_the_start() {
    let named = |disc: &str| {
        let text = format!("{ROOM}\n[[circle]]\nradius_m = 0.1\n{disc}\n")
            .replace("timeout_s = 10.0", "timeout_s = 1.0");
        let controller = Some(Box::<PassThrough>::default() as Box<dyn Controller>);
        let result = run(&scenario(&text), &robot(), controller).result;
        let ids = result.assumptions_broken.into_iter().map(|b| b.id);
        ids.collect::<Vec<_>>()
    };
    // Behind the robot, where no beam looks: 0.8 m away, then 1.1 m.
    assert_eq!(named("center_m = [-0.9, 0.0]"), ["A-START"]);
    assert!(named("center_m = [-1.2, 0.0]").is_empty());
    // Ahead, 0.8 m away and seen: the word ends before it.
    assert!(named("center_m = [0.9, 0.0]").is_empty());
}

#[test]
fn an_unseen_body_in_the_skirt_breaks_the_start() {
    // A box in view ends the operator's word at half a metre; what stands behind a rear corner lies farther than that
    // from the rotation centre, but not from the footprint.
    let named = |y_m: f64| {
        let near = "\n[[box]]\ncenter_m = [0.8, 0.0]\nsize_m = [0.1, 0.1]\n";
        let text = format!("{ROOM}{near}\n[[circle]]\nradius_m = 0.1\ncenter_m = [-0.6, {y_m}]\n")
            .replace("timeout_s = 10.0", "timeout_s = 1.0");
        let controller = Some(Box::<PassThrough>::default() as Box<dyn Controller>);
        let result = run(&scenario(&text), &robot(), controller).result;
        let broken = result.assumptions_broken.into_iter();
        broken
            .map(|b| format!("{} {}", b.id, b.what))
            .collect::<Vec<_>>()
    };
    let [broken] = &named(-0.56)[..] else {
        panic!("{:?}", named(-0.56));
    };
    assert!(
        broken.contains("A-START circle 0") && broken.contains("skirt"),
        "{broken}"
    );
    assert!(named(-0.58).is_empty(), "{:?}", named(-0.58));
    // A wall along the side is returned beside the scanner, within the skirt: nothing about it is hidden.
    let wall = "\n[[box]]\ncenter_m = [0.0, -0.56]\nsize_m = [1.4, 0.2]\n";
    let text = format!("{ROOM}{wall}").replace("timeout_s = 10.0", "timeout_s = 1.0");
    let controller = Some(Box::<PassThrough>::default() as Box<dyn Controller>);
    let broken = run(&scenario(&text), &robot(), controller)
        .result
        .assumptions_broken;
    assert!(
        broken.iter().all(|one| !one.what.contains("skirt")),
        "{broken:?}"
    );
}
