//! A-START: what the operator vouches for at a reset, and what stands there all the same.

use super::Engine;
use crate::assumption::{Broken, START};
use crate::math::{Pose, seconds};
use crate::sensor::{RawScan, beam_time_us};

/// A true return.
struct Return {
    body: usize,
    /// In the world, metres.
    at_m: [f64; 2],
    /// How far it may be off, metres.
    error_m: f64,
}

impl Engine<'_> {
    /// Notes whom the operator's word does not fit, and returns them.
    ///
    /// It is given for a disc, but no farther than the nearest return of the newest scans less their error: any part of
    /// a body inside that disc breaks A-START. It is given for the skirt around the footprint, too: a body breaks it
    /// that reaches into the skirt with a part that no beam returned.
    pub(super) fn vouch(&mut self, t_us: u64) -> Vec<usize> {
        let mut bodies = Vec::new();
        let (pose, t_s) = (self.pose(), seconds(t_us));
        let memory = &self.robot.values.memory;
        let returns: Vec<Return> = self
            .newest
            .iter()
            .flatten()
            .flat_map(|scan| self.returns(scan))
            .collect();
        let away = |[x, y]: [f64; 2]| libm::hypot(x - pose.x, y - pose.y);
        let free = returns.iter().map(|one| away(one.at_m) - one.error_m);
        let (skirt_m, radius_m) = (memory.skirt_m, free.fold(memory.clear_at_start_m, f64::min));
        let is_seen = |body: usize| {
            let mut its = returns.iter().filter(|one| one.body == body);
            its.any(|one| self.judge.distance_to(one.at_m, &pose) < skirt_m + one.error_m)
        };
        let from_centre = self
            .judge
            .distances_from(&self.world, [pose.x, pose.y], t_s);
        let distances = from_centre.into_iter().zip(self.distances(t_us));
        for (index, (body, (centre_m, footprint_m))) in
            self.world.bodies().iter().zip(distances).enumerate()
        {
            let what = if body.invisible {
                continue;
            } else if centre_m < radius_m {
                format!(
                    "{centre_m:.3} m from the rotation centre at the reset, inside the vouched {radius_m:.3} m"
                )
            } else if footprint_m < skirt_m && !is_seen(index) {
                format!(
                    "{footprint_m:.3} m from the footprint at the reset, unseen, in the vouched skirt of {skirt_m:.3} m"
                )
            } else {
                continue;
            };
            bodies.push(index);
            self.broken.push(Broken {
                id: START,
                what: format!("{} stands {what}", body.name),
                body: Some(index),
                from_s: t_s,
            });
        }
        bodies
    }

    /// Where the beams of a scan came back from.
    fn returns(&self, scan: &RawScan) -> Vec<Return> {
        let Some(scanner) = self.robot.values.scanners.get(scan.scanner) else {
            return Vec::new();
        };
        let sweep_us = self.sensors.sweep_us(scan.scanner);
        let count = scan.ranges_m.len();
        let beams = scan.ranges_m.iter().zip(&scan.bodies).enumerate();
        let returned = beams.filter_map(|(beam, (range, body))| {
            let valid = range.is_finite() && *range > 0.0;
            let at_us = beam_time_us(scan.begun_us, sweep_us, beam, count);
            let heading = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
            let mount = Pose::new(scanner.x_m, scanner.y_m, heading);
            Some(Return {
                body: body.filter(|_| valid)?,
                at_m: self
                    .pose_at(at_us)
                    .then(mount)
                    .apply([f64::from(*range), 0.0]),
                error_m: scanner.error_m(),
            })
        });
        returned.collect()
    }
}
