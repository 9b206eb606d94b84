//! A skid: for a while the robot goes elsewhere than its wheels.

use crate::file::{Scenario, Skid};
use crate::math::{Pose, seconds};

/// What is left of a scenario's skid.
#[derive(Clone, Copy, Debug)]
pub struct Slide {
    skid: Option<Skid>,
    /// Part that is done, from 0 to 1.
    done: f64,
}

impl Slide {
    /// The scenario's skid, not begun.
    #[must_use]
    pub const fn new(scenario: &Scenario) -> Self {
        Self {
            skid: scenario.drive.skid,
            done: 0.0,
        }
    }

    /// Displacement in the robot's frame during a step of `dt_s` from `t_us`; only what moves skids.
    pub fn step(&mut self, t_us: u64, dt_s: f64, moving: bool) -> Pose {
        let Some(skid) = self
            .skid
            .filter(|skid| moving && seconds(t_us) >= skid.from_s.get())
        else {
            return Pose::default();
        };
        let part = (dt_s / skid.for_s.get()).min(1.0 - self.done);
        self.done += part;
        Pose::new(skid.ahead_m.get() * part, skid.left_m.get() * part, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{ROOM, scenario};

    #[test]
    fn slides_all_the_way_once_and_only_while_moving() {
        let skid = "\n[drive.skid]\nfrom_s = 1.0\nfor_s = 0.05\nahead_m = 0.02\nleft_m = -0.01\n";
        let mut slide = Slide::new(&scenario(&format!("{ROOM}{skid}")));
        let mut slid = Pose::default();
        for t_us in (0..2_000_000).step_by(10_000) {
            let moving = t_us > 1_500_000;
            let step = slide.step(t_us, 0.01, moving);
            assert!(moving || step == Pose::default());
            slid = Pose::new(slid.x + step.x, slid.y + step.y, 0.0);
        }
        assert!((slid.x - 0.02).abs() < 1e-12 && (slid.y + 0.01).abs() < 1e-12);
    }
}
