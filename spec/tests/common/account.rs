//! The claim, held against every accepted step and against the plant itself.

use super::claim::{Contact, Sighting, Step};
use super::run::{COURSES, Loop, Truth};
use haltline::decision::Decision;
use haltline_spec::plane::Pose;
use haltline_spec::world::Mover;

impl Loop<'_> {
    /// Whether the plant itself touches something while it moves; the episode ends there.
    pub(super) fn judge(&mut self, now_us: u64) {
        let t_s = now_us as f64 * 1e-6;
        let outline = self.episode.outline();
        for (index, mover) in self.world.iter().enumerate() {
            let body = mover.at(t_s);
            if body.distance_m(&outline, self.plant.pose) > Some(0.0) || self.over {
                continue;
            }
            self.over = true;
            if self.plant.is_at_rest() {
                continue;
            }
            let vouched = self.vouched.iter().find(|sighting| sighting.index == index);
            if vouched.is_some_and(|sighting| self.is_hit(sighting, mover, t_s)) {
                self.report
                    .crashes
                    .push(format!("t={t_s:.3} body {index} {body:?}"));
            } else {
                self.report.unseen += 1;
            }
        }
    }

    /// Whether the part of a body that the claim is about touches the plant.
    fn is_hit(&self, sighting: &Sighting, mover: &Mover, t_s: f64) -> bool {
        let mut moved = sighting.clone();
        for (place, seen_s) in &mut moved.surface {
            for (coordinate, speed) in place.iter_mut().zip(mover.velocity_mps) {
                *coordinate += speed * (t_s - *seen_s);
            }
            *seen_s = t_s;
        }
        let outline = self.episode.outline();
        moved.gap_m(&outline, self.plant.pose, t_s, self.episode.obstacle_mps) <= 0.0
    }

    pub(super) fn check_claim(
        &mut self,
        decision: &Decision,
        now_us: u64,
        stamp_us: u64,
        truth: &Truth,
    ) {
        let allowance_m = decision.verdict.map_or(0.0, |verdict| {
            f64::from(verdict.budget.total().as_um()) * 1e-6
        }) + 0.01;
        self.excuse(allowance_m, stamp_us, truth);
        let sightings: Vec<Sighting> = self
            .sightings
            .iter()
            .flatten()
            .filter(|sighting| !self.excused[sighting.index])
            .cloned()
            .collect();
        self.vouched.clone_from(&sightings);
        self.report.accepted += 1;
        if !self.report.accepted.is_multiple_of(self.episode.tube_every) {
            return;
        }
        self.report.judged += 1;
        let mut step = Step {
            stamp_s: stamp_us as f64 * 1e-6,
            now_s: now_us as f64 * 1e-6,
            pose: truth.pose,
            measured: truth.measured,
            log: self.log.clone(),
            sightings,
        };
        self.report.courses += COURSES;
        if let Some(contact) = step.first_contact(self.episode, COURSES, &mut self.draw) {
            self.report
                .contacts
                .push(describe(&step, decision, contact));
        }
        step.sightings = self
            .sightings
            .iter()
            .flatten()
            .filter(|sighting| self.excused[sighting.index])
            .cloned()
            .collect();
        let excused = step.first_contact(self.episode, COURSES, &mut self.draw);
        self.report.excused_contacts += usize::from(excused.is_some());
    }

    /// The claim excuses what lies inside the inflation of the place where the robot rested, until
    /// the robot has left all of it (GUARD-19).
    fn excuse(&mut self, allowance_m: f64, stamp_us: u64, truth: &Truth) {
        let outline = self.episode.outline();
        let rest = truth.measured.v_mps.abs() <= self.episode.tol_v_mps + 0.005
            && truth.measured.omega_radps.abs() <= self.episode.tol_omega_radps + 0.005;
        // Where bodies may move nothing is excused.
        if rest && self.episode.obstacle_mps <= 0.0 {
            self.rested = Some((truth.pose, allowance_m));
        }
        self.excused.fill(false);
        let Some((rested, rested_m)) = self.rested else {
            return;
        };
        for sighting in self.sightings.iter().flatten() {
            let age_s = stamp_us as f64 * 1e-6 - sighting.t_s;
            let roam_m = self.episode.obstacle_mps * age_s.max(0.0);
            let near = |pose: Pose, within_m: f64| {
                sighting
                    .body
                    .distance_m(&outline, pose)
                    .is_none_or(|distance_m| distance_m <= within_m + roam_m)
            };
            self.excused[sighting.index] = near(rested, rested_m) && near(truth.pose, allowance_m);
        }
        if !rest && !self.excused.contains(&true) {
            self.rested = None;
        }
        self.report.excused += self.excused.iter().filter(|&&e| e).count();
    }
}

fn describe(step: &Step, decision: &Decision, contact: Contact) -> String {
    format!(
        "t={:.3} v={:.3} w={:.3} body {} depth {:.4} after {:.3}: {:?} {:?} {:?} budget {:?}",
        step.now_s,
        step.measured.v_mps,
        step.measured.omega_radps,
        contact.body,
        contact.depth_m,
        contact.after_s,
        decision.action,
        decision.setpoint,
        step.sightings
            .iter()
            .find(|s| s.index == contact.body)
            .map(|s| (
                step.pose.enter([s.body.pose.x_m, s.body.pose.y_m]),
                s.body.form,
                step.stamp_s - s.t_s
            )),
        decision
            .verdict
            .map(|v| (v.budget, v.stopping_path, v.stopping_time)),
    )
}
