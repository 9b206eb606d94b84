//! The marker filter: finite, wrapped, symmetric and positive whatever it is told, and where the case is small enough
//! the same as a dense filter written out here.

use crate::script::{Script, noise};
use crate::{Judged, Property, demand};
use haltline::marker::{
    FilterRules, Frame, FrameVerdict, Increment, MarkerEkf, MarkerFilter, Pose2, Prediction,
    Sighting, SightingNoise, Verdict,
};
use haltline::time::{Duration, Instant};
use std::f64::consts::PI;

pub const EKF: Property = Property {
    name: "ekf",
    judge: |bytes| judge(bytes, |_| {}),
    twins: &[
        ("asymmetric", |bytes| {
            judge(bytes, |seen| seen.covariance[0][1] += 1e-3)
        }),
        ("one per cent too sure", |bytes| {
            judge(bytes, |seen| {
                seen.covariance = seen.covariance.map(|row| row.map(|value| value * 0.99));
            })
        }),
        ("a heading that is not wrapped", |bytes| {
            judge(bytes, |seen| seen.pose.heading_rad += 2.0 * PI)
        }),
        ("a millimetre aside", |bytes| {
            judge(bytes, |seen| seen.pose.y_m += 1e-3)
        }),
        ("not positive", |bytes| {
            judge(bytes, |seen| seen.covariance[1][1] = -1e-9)
        }),
    ],
    draw: noise::<20, 600>,
    cases: 8000,
};

type Filter = MarkerEkf<4, 4>;
type Matrix = [[f64; 3]; 3];
/// Farthest place and largest variance at which two ways of counting agree.
const SANE: f64 = 50.0;

/// What a filter says of the robot.
#[derive(Clone, Copy)]
struct Seen {
    pose: Pose2,
    covariance: Matrix,
}

fn seen(filter: &Filter) -> Seen {
    Seen {
        pose: filter.pose(),
        covariance: filter.pose_covariance(),
    }
}

fn judge(bytes: &[u8], change: fn(&mut Seen)) -> Judged {
    let mut script = Script::new(bytes);
    let rules = FilterRules {
        learn: script.flag(),
        ..FilterRules::default()
    };
    let start = Pose2::new(
        script.between(-9.0, 9.0),
        script.between(-9.0, 9.0),
        script.between(-3.0, 3.0),
    );
    let mut variance = || script.between(1e-5, 0.5);
    let variances = [variance(), variance(), variance()];
    let filter = Filter::new(rules, start, variances);
    let mut filter = Box::new(filter.map_err(|error| format!("{error:?}"))?);
    for id in 0..4 {
        let pose = Pose2::new(
            script.between(-9.0, 9.0),
            script.between(-9.0, 9.0),
            script.between(-3.0, 3.0),
        );
        let _ = filter.add_mapped(id, pose);
    }
    let mut stamp = Instant::from_us(1_000_000);
    // Of the last motion that was believed.
    let mut newest = stamp;
    let mut judged = 0;
    while !script.is_over() {
        let before = seen(&filter);
        let (mut after, expected) = match script.byte() {
            ..112 => {
                stamp = stamp.plus(Duration::from_ms(script.count(0, 40) as u64));
                predict(&mut script, &mut filter, stamp, &mut newest, &before)
            }
            112..240 => correct(&mut script, &mut filter, newest, &before)?,
            _ => {
                let pose = Pose2::new(script.any(), script.any(), script.any());
                let placed = filter.place(pose, [script.any(), script.any(), script.any()]);
                let expected = placed.is_err().then_some(before);
                (seen(&filter), expected)
            }
        };
        change(&mut after);
        sound(&after)?;
        if let Some(expected) = expected {
            alike(&after, &expected)?;
            judged += 1;
        }
        markers(&filter)?;
    }
    Ok(judged)
}

/// Finite, wrapped, symmetric, positive.
fn sound(seen: &Seen) -> Result<(), String> {
    let pose = &seen.pose;
    let finite = pose.x_m.is_finite() && pose.y_m.is_finite();
    demand(
        finite && pose.heading_rad > -PI && pose.heading_rad <= PI,
        || format!("{pose:?}"),
    )?;
    positive(&seen.covariance)
}

fn positive(covariance: &Matrix) -> Result<(), String> {
    let says = |what: &str| format!("{what}: {covariance:?}");
    let finite = covariance.iter().flatten().all(|value| value.is_finite());
    demand(finite, || says("not finite"))?;
    let sigma: [f64; 3] = std::array::from_fn(|axis| covariance[axis][axis].sqrt());
    demand(sigma.iter().all(|sigma| *sigma >= 0.0), || {
        says("a negative variance")
    })?;
    let mut r = [[0.0; 3]; 3];
    for (row, sigma_row) in sigma.iter().enumerate() {
        for (column, sigma_column) in sigma.iter().enumerate() {
            let scale = sigma_row * sigma_column;
            let skew = (covariance[row][column] - covariance[column][row]).abs();
            demand(skew <= 1e-9 * scale, || says("not symmetric"))?;
            r[row][column] = if scale > 0.0 {
                covariance[row][column] / scale
            } else {
                0.0
            };
            demand(r[row][column].abs() <= 1.0 + 1e-9, || says("not positive"))?;
        }
    }
    let [a, b, c] = [r[0][1], r[0][2], r[1][2]];
    let determinant = 1.0 + 2.0 * a * b * c - a * a - b * b - c * c;
    demand(determinant >= -1e-9, || says("not positive"))
}

fn markers(filter: &Filter) -> Result<(), String> {
    for id in (0..12).filter(|id| *id >= 4) {
        if let Some(marker) = filter.marker(id) {
            let heading = marker.pose.heading_rad;
            let finite = marker.pose.x_m.is_finite() && marker.pose.y_m.is_finite();
            demand(finite && heading.abs() <= PI, || {
                format!("marker {id}: {marker:?}")
            })?;
            positive(&marker.covariance).map_err(|why| format!("marker {id}: {why}"))?;
        }
    }
    Ok(())
}

fn alike(found: &Seen, expected: &Seen) -> Result<(), String> {
    let poses = (&found.pose, &expected.pose);
    let turn = poses.0.heading_rad - poses.1.heading_rad;
    let near = poses.0.distance_m(poses.1) <= 1e-7 && turn.sin().abs() <= 1e-7 && turn.cos() > 0.0;
    demand(near, || format!("{:?} should be {:?}", poses.0, poses.1))?;
    for row in 0..3 {
        for column in 0..3 {
            let (one, two) = (
                found.covariance[row][column],
                expected.covariance[row][column],
            );
            let scale =
                (expected.covariance[row][row] * expected.covariance[column][column]).sqrt();
            demand((one - two).abs() <= 1e-5 * scale + 1e-13, || {
                format!("{:?} should be {:?}", found.covariance, expected.covariance)
            })?;
        }
    }
    Ok(())
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn sum(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

/// `a b aᵀ`.
fn around(a: &Matrix, b: &Matrix) -> Matrix {
    product(&product(a, b), &transposed(a))
}

/// Whether numbers are of a size at which two ways of counting agree.
fn is_sane(seen: &Seen) -> bool {
    let far = seen.pose.x_m.abs().max(seen.pose.y_m.abs());
    let wide = (0..3).map(|axis| seen.covariance[axis][axis]);
    // A heading that could be any is cut at a bound of the filter's own.
    seen.covariance[2][2] <= 3.0
        && far <= SANE
        && wide.clone().all(|v| v <= SANE)
        && wide.clone().all(|v| v >= 1e-9)
}

/// A motion, and what a dense filter makes of it.
fn predict(
    script: &mut Script<'_>,
    filter: &mut Filter,
    stamp: Instant,
    newest: &mut Instant,
    before: &Seen,
) -> (Seen, Option<Seen>) {
    let usual = !script.chance(24);
    let increment = if usual {
        Increment::arc(script.between(-0.2, 0.5), script.between(-0.5, 0.5))
    } else {
        Increment {
            forward_m: script.any(),
            left_m: script.any(),
            turn_rad: script.any(),
        }
    };
    let done = filter.predict(stamp, &increment);
    let after = seen(filter);
    if done != Prediction::Done {
        return (after, Some(*before));
    }
    *newest = stamp;
    if !usual || !is_sane(before) {
        return (after, None);
    }
    let (sin, cos) = before.pose.heading_rad.sin_cos();
    let (ahead, left) = (increment.forward_m, increment.left_m);
    let (dx, dy) = (cos * ahead - sin * left, sin * ahead + cos * left);
    let f = [[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]];
    let g = [
        [cos, -sin, -dy / 2.0],
        [sin, cos, dx / 2.0],
        [0.0, 0.0, 1.0],
    ];
    let noise = &filter.rules().odometry;
    let way = ahead.hypot(left);
    let mut q = [[0.0; 3]; 3];
    q[0][0] = noise.along_m2_per_m * way + noise.position_m2_per_sample;
    q[1][1] = noise.across_m2_per_m * way + noise.position_m2_per_sample;
    q[2][2] = noise.heading_rad2_per_m * way
        + noise.heading_rad2_per_rad * increment.turn_rad.abs()
        + noise.heading_rad2_per_sample;
    let pose = &before.pose;
    let expected = Seen {
        pose: Pose2::new(
            pose.x_m + dx,
            pose.y_m + dy,
            pose.heading_rad + increment.turn_rad,
        ),
        covariance: sum(&around(&f, &before.covariance), &around(&g, &q)),
    };
    (after, Some(expected))
}

fn sighting(script: &mut Script<'_>, robot: &Pose2, filter: &Filter) -> Sighting {
    let id = script.count(0, 11) as u16;
    let noise = SightingNoise::isotropic(script.between(0.01, 0.3), script.between(0.01, 0.3));
    if script.chance(24) {
        let noise = SightingNoise {
            xx_m2: script.any(),
            xy_m2: script.any(),
            yy_m2: script.any(),
            heading_rad2: script.any(),
        };
        return Sighting::pose(
            script.word(),
            Pose2::new(script.any(), script.any(), script.any()),
            noise,
        );
    }
    let place = filter.marker(id).map_or_else(
        || {
            Pose2::new(
                script.between(-5.0, 5.0),
                script.between(-5.0, 5.0),
                script.between(-3.0, 3.0),
            )
        },
        |marker| marker.pose,
    );
    let true_one = robot.sees(&place);
    let off = script.extreme(0.0, 0.4);
    let seen = Pose2::new(
        true_one.x_m + off * script.between(-1.0, 1.0),
        true_one.y_m + off * script.between(-1.0, 1.0),
        true_one.heading_rad + off * script.between(-1.0, 1.0),
    );
    if script.chance(64) {
        Sighting::position(id, seen.x_m, seen.y_m, noise)
    } else {
        Sighting::pose(id, seen, noise)
    }
}

/// A frame; with a single mapped marker in it, what a dense filter makes of it.
fn correct(
    script: &mut Script<'_>,
    filter: &mut Filter,
    newest: Instant,
    before: &Seen,
) -> Result<(Seen, Option<Seen>), String> {
    let count = if script.flag() {
        1
    } else {
        script.count(0, 18)
    };
    let sightings: Vec<Sighting> = (0..count)
        .map(|_| sighting(script, &before.pose, filter))
        .collect();
    let late = if script.flag() {
        0
    } else {
        script.count(0, 150) as u64
    };
    let frame = Frame {
        camera: script.byte() % 3,
        stamp: newest.minus(Duration::from_ms(late)),
        sightings: &sightings,
    };
    let mapped = sightings.first().and_then(|one| filter.marker(one.id));
    let report = filter.correct(&frame);
    let after = seen(filter);
    for record in report.records() {
        let gate = if record.degrees_of_freedom == 3 {
            filter.rules().gate_pose
        } else {
            filter.rules().gate_position
        };
        demand(
            record.verdict != Verdict::Fused || record.nis <= gate,
            || format!("{record:?}"),
        )?;
        demand(
            record.verdict != Verdict::Gated || record.nis > gate,
            || format!("{record:?}"),
        )?;
        demand(record.nis.is_finite(), || format!("{record:?}"))?;
    }
    if report.verdict != FrameVerdict::Used {
        return Ok((after, Some(*before)));
    }
    // Of the heading alone: where the robot is may be less sure once it turns out to be turned otherwise.
    let heading = |seen: &Seen| seen.covariance[2][2];
    if !report.relocated && is_sane(before) {
        demand(heading(&after) <= heading(before) * (1.0 + 1e-9), || {
            format!(
                "learned nothing: {:?} to {:?}",
                before.covariance, after.covariance
            )
        })?;
    }
    let (Some(one), Some(marker), [_]) = (sightings.first(), mapped, &sightings[..]) else {
        return Ok((after, None));
    };
    let single =
        late == 0 && usize::from(one.id) < 4 && one.heading_rad.is_some() && is_sane(before);
    let fused = report
        .record(0)
        .is_some_and(|record| record.verdict == Verdict::Fused);
    let expected = (single && fused && !report.relocated).then(|| dense(before, &marker.pose, one));
    Ok((after, expected.flatten()))
}

/// The textbook update by one pose sighting of a marker whose pose is known.
fn dense(before: &Seen, marker: &Pose2, seen: &Sighting) -> Option<Seen> {
    let pose = &before.pose;
    let (sin, cos) = pose.heading_rad.sin_cos();
    let (dx, dy) = (marker.x_m - pose.x_m, marker.y_m - pose.y_m);
    let expected = [cos * dx + sin * dy, cos * dy - sin * dx];
    let h = [
        [-cos, -sin, expected[1]],
        [sin, -cos, -expected[0]],
        [0.0, 0.0, -1.0],
    ];
    let noise = seen.noise.matrix(true);
    let s = sum(&around(&h, &before.covariance), &noise);
    let gain = product(&product(&before.covariance, &transposed(&h)), &inverse(&s)?);
    let turn = seen.heading_rad? - (marker.heading_rad - pose.heading_rad);
    let rest = [
        seen.x_m - expected[0],
        seen.y_m - expected[1],
        turn.sin().atan2(turn.cos()),
    ];
    let step: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| gain[i][k] * rest[k]).sum());
    // Filters that count their errors differently agree in the pose to first order only: small steps are compared.
    if step[2].abs() > 1e-5 || step[0].hypot(step[1]) > 1e-4 {
        return None;
    }
    let kh = product(&gain, &h);
    let keep: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - kh[i][j]));
    let updated = sum(&around(&keep, &before.covariance), &around(&gain, &noise));
    // An error that is a motion of the plane moves a robot that was moved by the update: what is not known of
    // the heading is not known of the way of the step either (spec/ekf.md).
    let moved = [[1.0, 0.0, -step[1]], [0.0, 1.0, step[0]], [0.0, 0.0, 1.0]];
    Some(Seen {
        pose: Pose2::new(
            pose.x_m + step[0],
            pose.y_m + step[1],
            pose.heading_rad + step[2],
        ),
        covariance: around(&moved, &updated),
    })
}

fn inverse(a: &Matrix) -> Option<Matrix> {
    let minor = |i: usize, j: usize| {
        let (r, c) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        a[r[0]][c[0]] * a[r[1]][c[1]] - a[r[0]][c[1]] * a[r[1]][c[0]]
    };
    let determinant: f64 = (0..3).map(|j| a[0][j] * minor(0, j)).sum();
    (determinant.abs() > 1e-200)
        .then(|| std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant)))
}
