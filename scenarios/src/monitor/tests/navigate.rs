//! Where the kernel drives itself, the operator's order stands for the command.

use super::*;

#[test]
fn latch_fires_on_an_order_from_before_the_release() {
    let robot = robot();
    let drive = |order_us: u64| {
        let mut bench = Bench::running(&robot);
        bench.tick(decision(Action::Pass, 0.01), move |inputs| {
            (inputs.command, inputs.order_us) = (None, Some(order_us));
        });
        bench.fired()
    };
    let released = Bench::running(&robot).now_us;
    assert_eq!(
        drive(1_000_000),
        ["LATCH"],
        "the order is older than the release"
    );
    assert!(drive(released).is_empty());
}

#[test]
fn limit_leaves_braking_at_the_destination_to_the_brakes() {
    let robot = robot();
    let stops = |wants_rest: bool| {
        let mut bench = Bench::running(&robot);
        let order = bench.now_us;
        for v in [0.01, 0.02, 0.03, 0.04, 0.05, 0.0] {
            let mut decision = decision(Action::Pass, v);
            decision.wants_rest = wants_rest && v == 0.0;
            bench.tick(decision, move |inputs| {
                (inputs.command, inputs.order_us) = (None, Some(order));
            });
        }
        bench.fired()
    };
    assert_eq!(stops(false), ["LIMIT"]);
    assert!(stops(true).is_empty());
}

#[test]
fn order_that_is_no_longer_handed_in_goes_stale() {
    let robot = robot();
    let mut bench = Bench::running(&robot);
    let order = bench.now_us;
    for tick in 0..8 {
        bench.tick(decision(Action::Pass, 0.01), move |inputs| {
            (inputs.command, inputs.order_us) = (None, (tick < 2).then_some(order));
        });
    }
    // 200 ms after the last tick that handed it in.
    assert!(bench.fired().contains(&"FRESH".to_owned()));
}
