//! The hull of motions.

use haltline::guard::Refusal;
use haltline::guard::hull::{Hull, VERTICES_MAX, Vertex};
use haltline::guard::plan::{Dynamics, Plan};
use haltline::input::Twist;
use haltline::units::{AngularSpeed, Curvature, Speed};

fn any_vertex() -> Vertex {
    Vertex {
        twist: Twist {
            linear: Speed::from_um_per_s(kani::any()),
            angular: AngularSpeed::from_urad_per_s(kani::any()),
        },
        curvature: Curvature::from_urad_per_m(kani::any()),
    }
}

fn overflow_is_refused(fault: bool) {
    let mut hull = Hull::default();
    for _ in 0..VERTICES_MAX {
        hull.push(Vertex::default());
    }
    assert!(hull.is_complete());
    let marked: bool = kani::any();
    if marked {
        hull.mark_incomplete();
    } else {
        hull.push(any_vertex());
    }
    kani::cover!(marked);
    kani::cover!(!marked);
    assert!(!hull.is_complete() && !fault);
    assert!(Plan::new(&Dynamics::default(), &hull, kani::any()) == Err(Refusal::TooLong));
}

/// A hull in which a motion found no room is refused, whatever the motion.
//= spec/guard.md#guard-03
//= type=proof
//# The hull of a motion MUST contain the measured twist, every set point sent after the odometry
//# stamp minus the actuation latency, the last set point sent before that moment, and the set
//# point to be sent.
//= spec/guard.md#guard-18
//= type=proof
//# The guard MUST refuse a motion whose tube needs more samples, a longer path or larger
//# coordinates than it can represent.
#[kani::proof]
#[kani::unwind(43)]
fn an_incomplete_hull_is_refused() {
    overflow_is_refused(false);
}

#[kani::proof]
#[kani::unwind(43)]
#[kani::should_panic]
fn an_incomplete_hull_is_refused_twin() {
    overflow_is_refused(true);
}

fn ranges_contain(fault: u64) {
    let vertices = [any_vertex(), any_vertex(), any_vertex()];
    let mut hull = Hull::default();
    for vertex in vertices {
        hull.push(vertex);
    }
    let (slowest, fastest) = hull.speed_range();
    let wheels = hull.wheel_interval();
    let turn = hull.turn_max();
    kani::cover!(turn > 5 && slowest < 0);
    for vertex in vertices {
        let v = vertex.twist.linear.as_um_per_s();
        let w = vertex.twist.angular.as_urad_per_s();
        assert!(slowest <= v && v <= fastest);
        assert!(u64::from(w.unsigned_abs()) + fault <= turn);
        let bend = vertex.curvature.as_urad_per_m();
        assert!(wheels.low <= bend && bend <= wheels.high);
    }
}

/// The hull's ranges of speed, turn rate and wheel curvature contain every motion put in; every
/// three motions.
//= spec/guard.md#guard-03
//= type=proof
//# The hull of a motion MUST contain the measured twist, every set point sent after the odometry
//# stamp minus the actuation latency, the last set point sent before that moment, and the set
//# point to be sent.
//= spec/guard.md#guard-13
//= type=proof
//# The curvature interval of an Ackermann tube MUST contain every wheel angle the steering can
//# have at any moment of the tube, widened by the curvature tolerance.
#[kani::proof]
#[kani::unwind(5)]
#[kani::solver(cadical)]
fn ranges_contain_every_motion() {
    ranges_contain(0);
}

#[kani::proof]
#[kani::unwind(5)]
#[kani::should_panic]
fn ranges_contain_every_motion_twin() {
    ranges_contain(1);
}
