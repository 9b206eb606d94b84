//! Distances by `parry2d` and by hand, against an optimiser that knows nothing of corners and edges: the distance of
//! two rectangles is the least of a quadratic program, solved by `clarabel`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver as _, NonnegativeConeT,
    SecondOrderConeT, SolverStatus, SupportedConeT,
};
use haltline_spec::draw::Draw;
use haltline_spec::exact;
use haltline_spec::plane::{Body, Form, Outline, Pose};

const CASES: usize = if cfg!(debug_assertions) { 300 } else { 4000 };
/// Agreement with the solver, m.
const SOLVER_M: f64 = 1e-9;
/// Agreement of both geometries, m.
const GEOMETRY_M: f64 = 1e-9;

/// A rectangle as the optimiser sees it: `|axis . (x - centre)| <= half`.
struct Slabs {
    centre: [f64; 2],
    axes: [[f64; 2]; 2],
    half: [f64; 2],
}

fn slabs(pose: Pose, centre: [f64; 2], half: [f64; 2]) -> Slabs {
    let (sin, cos) = pose.theta_rad.sin_cos();
    Slabs {
        centre: pose.place(centre),
        axes: [[cos, sin], [-sin, cos]],
        half,
    }
}

/// Least `t` with `|x - y| <= t`, `x` in one, `y` in the other; variables `x, y, t`.
fn solved(one: &Slabs, two: &Slabs) -> f64 {
    let mut rows: Vec<[f64; 5]> = Vec::new();
    let mut b = Vec::new();
    for (slabs, at) in [(one, 0), (two, 2)] {
        for (axis, half) in slabs.axes.iter().zip(slabs.half) {
            let middle = axis[0] * slabs.centre[0] + axis[1] * slabs.centre[1];
            for sign in [1.0, -1.0] {
                let mut row = [0.0; 5];
                (row[at], row[at + 1]) = (sign * axis[0], sign * axis[1]);
                rows.push(row);
                b.push(half + sign * middle);
            }
        }
    }
    // The cone's rows: s = (t, x - y).
    rows.extend([
        [0.0, 0.0, 0.0, 0.0, -1.0],
        [-1.0, 0.0, 1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, 1.0, 0.0],
    ]);
    b.extend([0.0; 3]);
    let cones = [NonnegativeConeT(8), SecondOrderConeT(3)];
    let x = minimum(&[0.0, 0.0, 0.0, 0.0, 1.0], &rows, &b, &cones);
    x[4]
}

fn minimum(q: &[f64; 5], rows: &[[f64; 5]], b: &[f64], cones: &[SupportedConeT<f64>]) -> Vec<f64> {
    let a = CscMatrix::from(rows);
    let settings: DefaultSettings<f64> = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-12)
        .tol_gap_rel(1e-12)
        .tol_feas(1e-12)
        .max_iter(200)
        .build()
        .unwrap();
    let mut solver =
        DefaultSolver::new(&CscMatrix::zeros((5, 5)), q, &a, b, cones, settings).unwrap();
    solver.solve();
    let status = solver.solution.status;
    let usable = [
        SolverStatus::Solved,
        SolverStatus::AlmostSolved,
        SolverStatus::InsufficientProgress,
    ];
    assert!(usable.contains(&status), "{status:?}");
    solver.solution.x.clone()
}

struct Case {
    outline: Outline,
    robot: Pose,
    other: Pose,
    half: [f64; 2],
}

/// Half of the cases on a raster of quarter turns and tenths of a metre: edges touch and coincide.
fn case(draw: &mut Draw) -> Case {
    let raster = draw.chance(0.5);
    let mut length = |low: f64, high: f64| {
        let value = draw.between(low, high);
        if raster {
            (value * 10.0).round() / 10.0
        } else {
            value
        }
    };
    let outline = Outline {
        front_m: length(0.1, 0.7),
        rear_m: length(0.1, 0.7),
        left_m: length(0.1, 0.5),
        right_m: length(0.1, 0.5),
    };
    let half = [length(0.1, 0.5), length(0.1, 0.5)];
    let mut pose = || (length(-1.2, 1.2), length(-1.2, 1.2));
    let (robot, other) = (pose(), pose());
    let mut heading = || {
        let turn = draw.between(-3.0, 3.0);
        if raster {
            turn.round() * std::f64::consts::FRAC_PI_2
        } else {
            turn
        }
    };
    Case {
        outline,
        robot: Pose::new(robot.0, robot.1, heading()),
        other: Pose::new(other.0, other.1, heading()),
        half,
    }
}

impl Case {
    fn by_parry(&self) -> f64 {
        Body::rectangle(self.other, self.half[0], self.half[1])
            .distance_m(&self.outline, self.robot)
            .unwrap()
    }

    fn by_hand(&self) -> f64 {
        let mine = self
            .outline
            .corners()
            .map(|corner| self.robot.place(corner));
        let centre = [self.other.x_m, self.other.y_m];
        let other = exact::corners(centre, self.other.theta_rad, self.half);
        exact::outline_to_outline(&mine, &other)
    }

    /// The robot's slabs, `grown` on every side.
    fn robot_slabs(&self, grown: f64) -> Slabs {
        let o = &self.outline;
        let centre = [(o.front_m - o.rear_m) / 2.0, (o.left_m - o.right_m) / 2.0];
        let half = [
            (o.front_m + o.rear_m) / 2.0 + grown,
            (o.left_m + o.right_m) / 2.0 + grown,
        ];
        slabs(self.robot, centre, half)
    }

    fn solved(&self, grown: f64) -> f64 {
        solved(
            &self.robot_slabs(grown),
            &slabs(self.other, [0.0; 2], self.half),
        )
    }

    /// The other rectangle shrunk to its centre.
    fn point_solved(&self) -> f64 {
        solved(
            &self.robot_slabs(0.0),
            &slabs(self.other, [0.0; 2], [0.0; 2]),
        )
    }
}

#[test]
fn rectangles_and_points_are_as_far_apart_as_the_optimiser_says() {
    let mut draw = Draw::new(62);
    let (mut worst, mut apart, mut overlapping) = (0.0_f64, 0.0_f64, 0);
    for number in 0..CASES {
        let case = case(&mut draw);
        let (parry, hand, solved) = (case.by_parry(), case.by_hand(), case.solved(0.0));
        apart = apart.max((parry - hand).abs());
        worst = worst.max((hand - solved).abs());
        assert!(
            (parry - hand).abs() <= GEOMETRY_M,
            "case {number}: parry {parry}, by hand {hand}"
        );
        assert!(
            (hand - solved).abs() <= SOLVER_M,
            "case {number}: by hand {hand}, solved {solved}"
        );
        let centre = [case.other.x_m, case.other.y_m];
        let point = case.outline.distance_m(case.robot.enter(centre));
        let solved = case.point_solved();
        worst = worst.max((point - solved).abs());
        assert!(
            (point - solved).abs() <= SOLVER_M,
            "case {number}: point {point}, solved {solved}"
        );
        overlapping += usize::from(hand <= 0.0);
    }
    println!(
        "{CASES} pairs of rectangles and points, {overlapping} overlapping: parry and by hand differ by at most \
         {apart:.1e} m, from the optimiser by at most {worst:.1e} m"
    );
    assert!(overlapping * 10 > CASES && overlapping * 10 < CASES * 9);
}

#[test]
fn false_twin_that_is_a_micrometre_larger_is_found() {
    let mut draw = Draw::new(62);
    let found = (0..CASES).find(|_| {
        let case = case(&mut draw);
        (case.by_hand() - case.solved(1e-6)).abs() > SOLVER_M
    });
    println!("a micrometre found by case {found:?}");
    assert!(found.is_some());
}

#[test]
fn discs_are_rectangles_of_no_size_grown() {
    let mut draw = Draw::new(63);
    for _ in 0..CASES {
        let case = case(&mut draw);
        let radius_m = case.half[0];
        let disc = Body {
            form: Form::Disc { radius_m },
            pose: case.other,
        };
        let parry = disc.distance_m(&case.outline, case.robot).unwrap();
        let solved = (case.point_solved() - radius_m).max(0.0);
        assert!((parry - solved).abs() <= SOLVER_M, "{parry} {solved}");
    }
}
