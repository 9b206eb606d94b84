//! The step towards a slowed motion: on the same curvature, and never beyond the dynamic window.

use haltline::config::Config;
use haltline::guard::hull::Vertex;
use haltline::input::Twist;
use haltline::time::Duration;
use haltline::units::{Acceleration, AngularAcceleration, AngularSpeed, Curvature, Speed};
use haltline::window::{FACTORS_PERMILLE, admissible, towards};

use super::kernel::config;
use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/window.rs";

pub(super) fn all() -> [Enumeration; 2] {
    [
        Enumeration {
            id: "window::slowing_keeps_the_curvature",
            means: Means::Enumerated,
            claim: "From rest or from a motion of the same curvature, the step towards a slowed motion keeps that curvature to the rounding of its numbers.",
            requirements: &["LIMIT-08"],
            domain: "61 curvatures to 3 /m, 101 speeds of the motion before to 0.5 m/s, 10 factors of 50 wanted speeds, 2 sets of accelerations",
            file: FILE,
            run: keeps,
        },
        Enumeration {
            id: "window::a_step_is_admissible",
            means: Means::Enumerated,
            claim: "The step towards any motion within the limits lies in the dynamic window around the motion before.",
            requirements: &["LIMIT-04"],
            domain: "51 x 41 motions before by 51 x 41 wanted ones within the limits, 2 sets of accelerations, steps of 1, 7 and 40 ms",
            file: FILE,
            run: reachable,
        },
    ]
}

fn drive(soft: bool) -> Config<1> {
    let mut drive = config();
    drive.limits.speed_reverse = drive.limits.speed_forward;
    if soft {
        drive.limits.acceleration = Acceleration::from_um_per_s2(300_000);
        drive.limits.angular_acceleration = AngularAcceleration::from_urad_per_s2(700_000);
    }
    drive
}

fn motion(v_um_per_s: i32, w_urad_per_s: i32) -> Vertex {
    Vertex {
        twist: Twist {
            linear: Speed::from_um_per_s(v_um_per_s),
            angular: AngularSpeed::from_urad_per_s(w_urad_per_s),
        },
        curvature: Curvature::ZERO,
    }
}

fn numbers(vertex: Vertex) -> (i64, i64) {
    let twist = vertex.twist;
    (
        i64::from(twist.linear.as_um_per_s()),
        i64::from(twist.angular.as_urad_per_s()),
    )
}

fn keeps(twin: bool) -> Result<u64, String> {
    let exact = i64::from(!twin);
    let drives = [drive(false), drive(true)];
    parallel(0..61 * 101 * 50 * 10 * 2, |index| {
        let kappa_milli = (index % 61) as i32 * 100 - 3_000;
        let turn = |v: i32| v / 1_000 * kappa_milli;
        let before = (index / 61 % 101) as i32 * 5_000;
        let wanted = (index / 6_161 % 50 + 1) as i32 * 10_000;
        if turn(before).abs() > 1_000_000 || turn(wanted).abs() > 1_000_000 {
            return Ok(());
        }
        let factor = FACTORS_PERMILLE[(index / 308_050 % 10) as usize];
        let drive = &drives[(index / 3_080_500) as usize];
        let step = Duration::from_ms(40);
        let next = towards(
            drive,
            motion(before, turn(before)),
            motion(wanted, turn(wanted)),
            factor,
            step,
        );
        let (v, w) = numbers(next);
        // Each number is off by at most one count, from scaling, and one from the step.
        let off = (w * 1_000 - v * i64::from(kappa_milli)).abs();
        let most = 2 * exact * (1_000 + i64::from(kappa_milli.abs()));
        (off <= most).then_some(()).ok_or_else(|| {
            format!("{before} um/s to {wanted} by {factor} at {kappa_milli}: {v} {w}")
        })
    })
}

fn reachable(twin: bool) -> Result<u64, String> {
    let drives = [drive(false), drive(true)];
    parallel(0..51 * 41 * 51 * 41 * 2 * 3, |index| {
        let speed = |number: u64| ((number % 51) as i32 - 25) * 20_000;
        let turn = |number: u64| ((number % 41) as i32 - 20) * 50_000;
        let before = motion(speed(index), turn(index / 51));
        let wanted = motion(speed(index / 2_091), turn(index / 106_641));
        let drive = &drives[(index / 4_372_281 % 2) as usize];
        let step = Duration::from_ms([1, 7, 40][(index / 8_744_562) as usize]);
        let next = towards(drive, before, wanted, 1000, step);
        let judged = if twin {
            Duration::from_us(step.as_us() / 2)
        } else {
            step
        };
        admissible(drive, before, next, judged)
            .then_some(())
            .ok_or_else(|| format!("{:?} to {:?}: {:?}", before.twist, wanted.twist, next.twist))
    })
}
