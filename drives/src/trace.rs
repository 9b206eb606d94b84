//! A drive as a log that `haltline replay` reads: one row for each scan that was used.

use std::io::{self, Write};

use haltline_robots::Scanner as Mount;

use crate::control::Tick;

/// Writes rows of time, odometry increment and ranges (CSV, two header lines).
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
        let now_s = tick.now.as_us() as f64 * 1e-6;
        let start_s = *self.start_s.get_or_insert_with(|| {
            self.pose = tick.feedback.pose;
            now_s
        });
        let [x, y, theta] = self.pose;
        let [x1, y1, theta1] = tick.feedback.pose;
        let (sin, cos) = theta.sin_cos();
        let (dx, dy) = (x1 - x, y1 - y);
        let turn = (theta1 - theta + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        write!(
            self.out,
            "{:.4},{:.5},{:.5},{turn:.6}",
            now_s - start_s,
            cos * dx + sin * dy,
            cos * dy - sin * dx,
        )?;
        for range in &scan.ranges_m {
            write!(self.out, ",{range:.3}")?;
        }
        writeln!(self.out)?;
        self.pose = tick.feedback.pose;
        Ok(())
    }
}
