//! A drive as a log that `haltline replay` reads: one row for each scan that was used.

use std::io::{self, Write};

use haltline_robots::Scanner as Mount;

use crate::control::Tick;

/// Writes rows of time, odometry increment and ranges (CSV, two header lines), each for the beginning
/// of its sweep.
pub struct Trace<W: Write> {
    out: W,
    start_s: Option<f64>,
    pose: [f64; 3],
}

impl<W: Write> Trace<W> {
    /// Writes the header of this scanner.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn new(mut out: W, mount: &Mount) -> io::Result<Self> {
        writeln!(
            out,
            "# beams {} aperture_rad {:.6} right_to_left 1 max_range_m {:.2} sensor_x_m {:.3} \
             sensor_y_m {:.3} sensor_yaw_rad {:.4} sigma_m {:.3}",
            mount.beams,
            mount.field_of_view_rad,
            mount.range_max_m,
            mount.x_m,
            mount.y_m,
            mount.yaw_rad,
            mount.error_sigma_m,
        )?;
        writeln!(out, "# t_s,dx_m,dy_m,dtheta_rad,range_m...  (0 = invalid)")?;
        Ok(Self {
            out,
            start_s: None,
            pose: [0.0; 3],
        })
    }

    /// Appends the newest scan of a tick, if it had one.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn tick(&mut self, tick: &Tick<'_>) -> io::Result<()> {
        let Some(scan) = tick.inputs.scans.last() else {
            return Ok(());
        };
        // Where it was when the sweep began: the feedback is older or newer by some milliseconds.
        let scan_s = scan.stamp_us as f64 * 1e-6;
        let since_s = scan_s - tick.feedback.stamp.as_us() as f64 * 1e-6;
        let pose = moved(tick.feedback.pose, tick.feedback.twist, since_s);
        let start_s = *self.start_s.get_or_insert_with(|| {
            self.pose = pose;
            scan_s
        });
        let [x, y, theta] = self.pose;
        let [x1, y1, theta1] = pose;
        let (sin, cos) = theta.sin_cos();
        let (dx, dy) = (x1 - x, y1 - y);
        let turn = (theta1 - theta + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        write!(
            self.out,
            "{:.4},{:.5},{:.5},{turn:.6}",
            scan_s - start_s,
            cos * dx + sin * dy,
            cos * dy - sin * dx,
        )?;
        for range in &scan.ranges_m {
            write!(self.out, ",{range:.3}")?;
        }
        writeln!(self.out)?;
        self.pose = pose;
        Ok(())
    }
}

/// The pose `span_s` later (or earlier) at this twist.
fn moved([x, y, theta]: [f64; 3], [v, w]: [f64; 2], span_s: f64) -> [f64; 3] {
    let along = theta + w * span_s / 2.0;
    [
        x + v * span_s * along.cos(),
        y + v * span_s * along.sin(),
        theta + w * span_s,
    ]
}
