//! `haltline replay --format mrclam` on small logs with known truth.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{expect_exit, folder, haltline, stderr, stdout};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A small generator: the logs must be the same on every machine.
struct Chance(u64);

impl Chance {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / 9_007_199_254_740_992.0
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// What the log holds besides a clean drive.
#[derive(Clone, Copy, Default)]
struct Extras {
    /// Seconds without odometry and measurements, twice.
    gap: bool,
    /// Every tenth range is far off, every twentieth barcode is nobody's, robots are seen.
    dirt: bool,
}

/// 15 landmarks round a room of 9 m by 6 m, an oval drive of 120 s at 10 Hz.
fn generate(name: &str, extras: Extras) -> PathBuf {
    let out = folder(name);
    let mut chance = Chance(0x9E37_79B9_7F4A_7C15);
    let landmarks: Vec<[f64; 2]> = (0..15)
        .map(|at| {
            let angle = f64::from(at) / 15.0 * std::f64::consts::TAU;
            [4.5 * angle.cos(), 3.0 * angle.sin()]
        })
        .collect();
    let mut barcodes = String::from("# Subject # Barcode\n");
    let mut truth_of_landmarks = String::from("# Subject  x  y  std x  std y\n");
    for subject in 1..=20 {
        let _ = writeln!(barcodes, "{subject}   {}", 100 + 7 * subject);
        if subject > 5 {
            let [x, y] = landmarks[subject - 6];
            let _ = writeln!(truth_of_landmarks, "{subject} {x:.4} {y:.4} 0.001 0.001");
        }
    }
    let (mut odometry, mut measured, mut truth) = (
        String::from("# Time  v  w\n"),
        String::from("# Time  barcode  range  bearing\n"),
        String::from("# Time  x  y  theta\n"),
    );
    let (mut x, mut y, mut theta) = (0.0, -1.8, 0.0_f64);
    let mut phase = 0;
    for step in 0..1200 {
        let time = 1_248_272_272.841 + f64::from(step) * 0.1;
        // An oval: straights of 3 m, half circles of 1.8 m radius.
        let turning = phase % 237 >= 100;
        let (v, w) = (0.3, if turning { 0.3 / 1.31 } else { 0.0 });
        let silent = extras.gap && ((300..330).contains(&step) || (800..812).contains(&step));
        let _ = writeln!(truth, "{time:.3} {x:.5} {y:.5} {theta:.5}");
        phase += i32::from(!silent);
        // Commanded is not driven: 3 % too long, a constant pull to one side.
        let told_v = 1.03 * v + 0.02 * chance.normal();
        let told_w = w + 0.004 + 0.02 * chance.normal();
        if !silent {
            let _ = writeln!(odometry, "{time:.3}  {told_v:.4}   {told_w:.4}");
        }
        if step % 3 == 0 && !silent {
            see(
                &mut measured,
                [time, x, y, theta],
                &landmarks,
                extras.dirt,
                &mut chance,
            );
        }
        // In a gap the robot stands still.
        let (v, w) = if silent { (0.0, 0.0) } else { (v, w) };
        let half = w * 0.05;
        x += 0.1 * v * (theta + half).cos();
        y += 0.1 * v * (theta + half).sin();
        theta += w * 0.1;
    }
    for (file, text) in [
        ("Barcodes.dat", &barcodes),
        ("Landmark_Groundtruth.dat", &truth_of_landmarks),
        ("Robot2_Odometry.dat", &odometry),
        ("Robot2_Measurement.dat", &measured),
        ("Robot2_Groundtruth.dat", &truth),
    ] {
        std::fs::write(out.join(file), text).expect("written");
    }
    out
}

/// Landmarks within 4 m and 60° of ahead.
fn see(
    log: &mut String,
    [time, x, y, theta]: [f64; 4],
    landmarks: &[[f64; 2]],
    dirt: bool,
    chance: &mut Chance,
) {
    for (index, landmark) in landmarks.iter().enumerate() {
        let (dx, dy) = (landmark[0] - x, landmark[1] - y);
        let range = dx.hypot(dy);
        let bearing = (dy.atan2(dx) - theta + 0.02 * chance.normal()).sin_cos();
        let bearing = bearing.0.atan2(bearing.1);
        if range > 4.0 || bearing.abs() > 1.05 {
            continue;
        }
        let far_off = dirt && chance.unit() < 0.1;
        let error = if far_off {
            1.0 + chance.unit()
        } else {
            0.03 * range * chance.normal()
        };
        let nobody = dirt && chance.unit() < 0.05;
        let barcode = if nobody { 9999 } else { 100 + 7 * (index + 6) };
        let _ = writeln!(
            log,
            "{time:.3}    {barcode}  {:.3} {bearing:.3}",
            range + error
        );
    }
    if dirt && chance.unit() < 0.2 {
        // Another robot, which is no landmark.
        let _ = writeln!(
            log,
            "{time:.3} 107 {:.3} {:.3}",
            1.0 + chance.unit(),
            chance.unit() - 0.5
        );
    }
}

fn replay(data: &Path) -> serde_json::Value {
    let out = data.join("out");
    let (data, out_text) = (data.display().to_string(), out.display().to_string());
    let output = haltline(&[
        "replay", "--format", "mrclam", &data, "--robot", "2", "--out", &out_text,
    ]);
    expect_exit(&output, 0);
    println!("{}", stdout(&output));
    let text = std::fs::read_to_string(out.join("mrclam.json")).expect("mrclam.json");
    serde_json::from_str(&text).expect("an object")
}

fn number(summary: &serde_json::Value, path: &str) -> f64 {
    summary
        .pointer(path)
        .and_then(serde_json::Value::as_f64)
        .expect(path)
}

#[test]
fn a_clean_drive_is_tracked_and_all_landmarks_are_found() {
    let summary = replay(&generate("mrclam_clean", Extras::default()));
    assert!(
        number(&summary, "/trajectory_aligned/rms_m") < 0.05,
        "{summary}"
    );
    assert!(
        number(&summary, "/trajectory_raw/rms_m") < 0.10,
        "{summary}"
    );
    // One range of 4 m is good to 0.12 m.
    assert!(
        number(&summary, "/landmarks_aligned/max_m") < 0.12,
        "{summary}"
    );
    assert_eq!(
        number(&summary, "/landmarks_found").to_bits(),
        15.0_f64.to_bits()
    );
    // Odometry alone is much worse, or the test shows nothing.
    let alone = number(&summary, "/dead_reckoning_aligned/rms_m");
    assert!(
        alone > 3.0 * number(&summary, "/trajectory_aligned/rms_m"),
        "{summary}"
    );
    assert_eq!(summary["lost_at_the_end"], false);
}

#[test]
fn dirt_is_counted_and_gated() {
    let dirty = Extras {
        gap: true,
        dirt: true,
    };
    let summary = replay(&generate("mrclam_dirty", dirty));
    assert!(
        number(&summary, "/trajectory_aligned/rms_m") < 0.10,
        "{summary}"
    );
    assert!(
        number(&summary, "/landmarks_aligned/rms_m") < 0.15,
        "{summary}"
    );
    assert_eq!(
        number(&summary, "/landmarks_found").to_bits(),
        15.0_f64.to_bits()
    );
    let seen = number(&summary, "/measurements");
    assert!(
        number(&summary, "/unknown_barcodes") > 0.02 * seen,
        "{summary}"
    );
    assert!(number(&summary, "/other_robots") > 20.0, "{summary}");
    let gated = number(&summary, "/gated") + number(&summary, "/removed");
    assert!(gated > 0.05 * seen && gated < 0.15 * seen, "{summary}");
    assert_eq!(
        number(&summary, "/odometry_gaps").to_bits(),
        2.0_f64.to_bits()
    );
    let sum: f64 = [
        "unknown_barcodes",
        "other_robots",
        "malformed",
        "fused",
        "added",
        "gated",
        "removed",
        "unused",
    ]
    .iter()
    .map(|key| number(&summary, &format!("/{key}")))
    .sum();
    assert!(
        (sum - seen).abs() < 0.5,
        "every measurement is accounted for: {summary}"
    );
}

fn refused(data: &Path, robot: &str) -> String {
    let data = data.display().to_string();
    let output = haltline(&["replay", "--format", "mrclam", &data, "--robot", robot]);
    expect_exit(&output, 2);
    stderr(&output)
}

#[test]
fn bad_input_is_named_with_file_and_line() {
    let data = generate("mrclam_bad", Extras::default());
    for (file, bad, part) in [
        (
            "Robot2_Measurement.dat",
            "# c\n1.0 114 2.0\n",
            ":2: 3 values, expected 4",
        ),
        (
            "Robot2_Measurement.dat",
            "1.0 114 far 0.1\n",
            ":1: `far` is not a number",
        ),
        (
            "Robot2_Measurement.dat",
            "1.0 114 2 0\n0.5 114 2 0\n",
            ":2: time 0.5 s is before",
        ),
        (
            "Robot2_Measurement.dat",
            "1.0 -3 nan 0\n",
            ":1: `nan` is not a number",
        ),
        (
            "Robot2_Measurement.dat",
            "1.0 -3 2 0\n",
            ":1: barcode -3: write a whole number",
        ),
        (
            "Robot2_Measurement.dat",
            "# nothing\n",
            ":1: 0 rows, needs at least 1",
        ),
        (
            "Robot2_Odometry.dat",
            "1.0 0.1 0\n2.0 1e300 0\n",
            ":2: 1e300 m/s",
        ),
        (
            "Robot2_Odometry.dat",
            "1.0 0.1 7\n",
            ":1: 0.1 m/s and 7.0 rad/s",
        ),
        (
            "Robot2_Groundtruth.dat",
            "1.0 0 0 0\n2.0 1e9 0 0\n",
            ":2: a pose beyond 1000000 m",
        ),
        (
            "Barcodes.dat",
            "6 1.5\n",
            ":1: barcode 1.5: write a whole number",
        ),
        (
            "Barcodes.dat",
            "70000 5\n",
            ":1: subject 70000: write a whole number below 1024",
        ),
        (
            "Barcodes.dat",
            "6 5\n7 5\n",
            ":2: barcode 5 is that of subject 6 already",
        ),
        (
            "Landmark_Groundtruth.dat",
            "6 0 0 0 0\n6 1 0 0 0\n",
            ":2: landmark 6 stands above already",
        ),
    ] {
        let path = data.join(file);
        let good = std::fs::read_to_string(&path).expect("read");
        std::fs::write(&path, bad).expect("written");
        let said = refused(&data, "2");
        std::fs::write(&path, good).expect("written");
        assert!(said.contains(&format!("{file}{part}")), "{said}");
    }
    assert!(refused(&data, "9").contains("robot's number, 1 to 5"));
    assert!(refused(&data, "3").contains("Robot3_Odometry.dat: cannot be read"));
    assert!(refused(Path::new("no/such"), "1").contains("not a folder"));
}
