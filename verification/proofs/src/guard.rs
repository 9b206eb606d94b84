//! The inner loop of the guard: points against samples.
//!
//! The samples here are not turned, so that their products are cheap; that turning a point is exact
//! and within its stated rounding is shown apart (`enumerate`, `lemma::rotation`). Everything else
//! of the loop is the shipped code: joining, the bounding box, the own inflation of a point, which
//! sample blocks.

use haltline::geometry::frame::{PointMm, Rotation};
use haltline::geometry::rect::Rect;
use haltline::guard::check::{CloudPoint, first_blocked};
use haltline::guard::tube::{Sample, Swept};

fn any_cloud_point() -> CloudPoint {
    CloudPoint {
        x_mm: kani::any(),
        y_mm: kani::any(),
        extra_mm: kani::any(),
        joined: kani::any(),
    }
}

/// A sample whose grown footprint stays within 3 m, as the tube's own limit says.
fn any_sample() -> Sample {
    let edge = || {
        let value: i32 = kani::any();
        kani::assume(value >= 0 && value <= 24_000);
        value
    };
    let place = || {
        let value: i32 = kani::any();
        kani::assume(value >= -32_000 && value <= 32_000);
        value
    };
    Sample::from_parts(
        PointMm {
            x: place(),
            y: place(),
        },
        Rotation::default(),
        Rect {
            front: edge(),
            rear: edge(),
            left: edge(),
            right: edge(),
        },
    )
}

/// For the twins: a counterexample at one sample is enough.
fn one_sample() -> Sample {
    let rect = Rect {
        front: 4_000,
        rear: 4_000,
        left: 3_000,
        right: 3_000,
    };
    Sample::from_parts(PointMm::default(), Rotation::default(), rect)
}

/// Whether the point lies inside the sample grown by its own inflation, in eighths of a millimetre.
fn is_inside(sample: &Sample, point: &CloudPoint, extra_mm: u16, wrong: i64) -> bool {
    let grow = i64::from(extra_mm) * 8 + wrong;
    let (x, y) = place(sample, point);
    x <= i64::from(sample.rect().front) + grow
        && -x <= i64::from(sample.rect().rear) + grow
        && y <= i64::from(sample.rect().left) + grow
        && -y <= i64::from(sample.rect().right) + grow
}

fn place(sample: &Sample, point: &CloudPoint) -> (i64, i64) {
    let offset = |mm: i16, centre: i32| i64::from(mm) * 8 - i64::from(centre);
    (
        offset(point.x_mm, sample.centre().x),
        offset(point.y_mm, sample.centre().y),
    )
}

/// A bounding box that contains the samples, as the tube computes it.
fn bounds_of(samples: &[Sample]) -> Rect {
    let mut out = Rect {
        front: i32::MIN,
        rear: i32::MIN,
        left: i32::MIN,
        right: i32::MIN,
    };
    for sample in samples {
        let (centre, rect) = (sample.centre(), sample.rect());
        out.front = out.front.max(((centre.x + rect.front) >> 3) + 2);
        out.rear = out.rear.max(((rect.rear - centre.x) >> 3) + 2);
        out.left = out.left.max(((centre.y + rect.left) >> 3) + 2);
        out.right = out.right.max(((rect.right - centre.y) >> 3) + 2);
    }
    out
}

fn swept(samples: &[Sample]) -> Swept<'_> {
    Swept {
        samples,
        bounds: bounds_of(samples),
        start: Sample::default(),
        nominal_from: 0,
    }
}

fn known_point_blocks(sample: Sample, wrong: i64) {
    let point = any_cloud_point();
    kani::assume(point.extra_mm <= 1_200);
    let samples = [sample];
    let tube = swept(&samples);
    let inside = is_inside(&sample, &point, point.extra_mm, wrong);
    let touch = first_blocked(&tube, Rect::default(), &[point], None);
    kani::cover!(inside && point.extra_mm > 100);
    kani::cover!(touch.is_none());
    assert!(!inside || touch.is_some());
}

/// A known point inside an inflated sample is reported: every point, own inflation up to 1.2 m,
/// every sample that is not turned.
//= spec/guard.md#guard-01
//= type=proof
//# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its
//# tube.
//= spec/guard.md#guard-06
//= type=proof
//# Every sample MUST be inflated by no less than the sum of sensor error, beam gap, odometry
//# error, obstacle motion, tracking error, sampling, spread and rounding as derived in the model.
#[kani::proof]
#[kani::unwind(4)]
#[kani::solver(cadical)]
fn a_known_point_in_a_sample_blocks() {
    known_point_blocks(any_sample(), 0);
}

#[kani::proof]
#[kani::unwind(4)]
#[kani::should_panic]
fn a_known_point_in_a_sample_blocks_twin() {
    known_point_blocks(one_sample(), 8);
}

fn second_point_blocks(sample: Sample, wrong: i64) {
    let (before, point) = (any_cloud_point(), any_cloud_point());
    kani::assume(before.extra_mm <= 1_200 && point.extra_mm <= 1_200);
    // Neighbours are joined only within the join limit; 3 mm are rounding.
    let apart = |a: i16, b: i16| i32::from(a).abs_diff(i32::from(b)) > 1_503;
    kani::assume(
        !before.joined || !(apart(before.x_mm, point.x_mm) || apart(before.y_mm, point.y_mm)),
    );
    let samples = [sample];
    let inside = is_inside(&sample, &point, point.extra_mm, wrong);
    let blocked = first_blocked(&swept(&samples), Rect::default(), &[before, point], None);
    kani::cover!(inside && before.joined);
    kani::cover!(blocked.is_none());
    assert!(!inside || blocked.is_some());
}

/// A known point blocks whatever point stands before it in the scan, joined with it or not;
/// every pair of points, joined ones at most 1.5 m apart, every sample that is not turned.
//= spec/guard.md#guard-01
//= type=proof
//# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its
//# tube.
//= spec/guard.md#guard-17
//= type=proof
//# A refused motion MUST NOT become accepted by adding a known point, by turning a known cell
//# into an unknown one or by enlarging an error bound.
#[kani::proof]
#[kani::unwind(4)]
#[kani::solver(cadical)]
fn a_point_before_hides_nothing() {
    second_point_blocks(any_sample(), 0);
}

#[kani::proof]
#[kani::should_panic]
fn a_point_before_hides_nothing_twin() {
    second_point_blocks(one_sample(), 8);
}

fn second_sample_blocks(first: Sample, second: Sample, wrong: i64) {
    let point = any_cloud_point();
    kani::assume(point.extra_mm <= 1_200);
    let samples = [first, second];
    let inside = is_inside(&second, &point, point.extra_mm, wrong);
    kani::cover!(inside);
    let blocked = first_blocked(&swept(&samples), Rect::default(), &[point], None);
    assert!(!inside || blocked.is_some());
}

/// A known point in a later sample blocks whatever sample stands before it; every point and every
/// two samples that are not turned.
//= spec/guard.md#guard-01
//= type=proof
//# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its
//# tube.
#[kani::proof]
#[kani::unwind(4)]
#[kani::solver(cadical)]
fn a_sample_before_hides_nothing() {
    second_sample_blocks(any_sample(), any_sample(), 0);
}

#[kani::proof]
#[kani::should_panic]
fn a_sample_before_hides_nothing_twin() {
    second_sample_blocks(one_sample(), one_sample(), 8);
}

fn wide_point_blocks(least: u16) {
    let mut point = any_cloud_point();
    kani::assume(point.extra_mm > least);
    point.x_mm = 0;
    point.y_mm = 0;
    let samples = [any_sample()];
    let blocked = first_blocked(&swept(&samples), Rect::default(), &[point], None);
    kani::cover!(point.extra_mm == u16::MAX);
    // The bounding box of a sample within 3 m of the origin is within reach of such a point.
    kani::assume(samples[0].centre() == PointMm::default());
    assert!(blocked == Some((0, 0)));
}

/// A point whose own inflation is beyond the cap blocks at once; every inflation above it.
//= spec/guard.md#guard-18
//= type=proof
//# The guard MUST refuse a motion whose tube needs more samples, a longer path or larger
//# coordinates than it can represent.
#[kani::proof]
#[kani::unwind(4)]
#[kani::solver(cadical)]
fn a_point_beyond_the_cap_blocks() {
    wide_point_blocks(1_200);
}

#[kani::proof]
#[kani::should_panic]
fn a_point_beyond_the_cap_blocks_twin() {
    twin_of_wide();
}

/// The twin says that such a point never blocks.
fn twin_of_wide() {
    let mut point = any_cloud_point();
    kani::assume(point.extra_mm > 1_200);
    point.x_mm = 0;
    point.y_mm = 0;
    let samples = [one_sample()];
    assert!(first_blocked(&swept(&samples), Rect::default(), &[point], None).is_none());
}
