//! Stops among faults: whatever is lost, late, early, cut or repeated, no motion is accepted that must not be.
//!
//! The bytes say which fault of the catalogue comes when; the judge is the monitor of `spec/tests`, written from the
//! requirements alone.

use crate::closed_loop::episode::{Lie, Style};
use crate::closed_loop::faults::{self, Fault, Injector};
use crate::closed_loop::monitor::Monitor;
use crate::closed_loop::run::run_with;
use crate::closed_loop::tamper::{Raw, Scene, Tamper};
use crate::guard;
use crate::script::{Script, noise};
use crate::{Judged, Property};
use haltline_spec::draw::Draw;

pub const STOPS: Property = Property {
    name: "stops",
    judge: |bytes| judge(bytes, Lie::None),
    twins: &[
        ("scans ten times as old", |bytes| judge(bytes, Lie::ScanAge)),
        ("odometry five times as old", |bytes| {
            judge(bytes, Lie::OdometryAge)
        }),
        ("a second of jitter", |bytes| judge(bytes, Lie::Jitter)),
        ("any part of the beams", |bytes| {
            judge(bytes, Lie::InvalidFraction)
        }),
        ("no clear time", |bytes| judge(bytes, Lie::Clear)),
        ("rest while moving", |bytes| judge(bytes, Lie::Rest)),
    ],
    draw: noise::<60, 300>,
    cases: 200,
};

struct Faults<'a, 'b> {
    script: &'a mut Script<'b>,
    /// Something was not merely lost or late but false: for contacts after that the claim does not speak.
    lied: bool,
    injector: Injector,
    monitor: Monitor<'a>,
}

impl Tamper for Faults<'_, '_> {
    fn pause_us(&mut self, _draw: &mut Draw) -> u64 {
        self.injector.active = match self.injector.active {
            Some((fault, left)) if left > 1 => Some((fault, left - 1)),
            _ if self.script.chance(20) => {
                let fault = self.script.one_of(faults::ALL);
                let ticks = match fault {
                    // One tick with the clock set back is a fault, more are none to the kernel's own clock.
                    Fault::Pause | Fault::OdometryJump | Fault::TimeReverse => 1,
                    Fault::ScanFrozen => 40,
                    _ => self.script.count(1, 16),
                };
                Some((fault, ticks))
            }
            _ => None,
        };
        self.lied |= matches!(
            self.injector.active,
            Some((Fault::ScanFrozen | Fault::OdometryJump | Fault::Pause, _))
        );
        match self.injector.active {
            Some((Fault::Pause, _)) => 120_000,
            _ => 0,
        }
    }

    fn alter(&mut self, raw: &mut Raw, draw: &mut Draw) {
        self.injector.alter(raw, draw);
    }

    fn judge(&mut self, scene: &Scene<'_>) -> Option<String> {
        self.monitor.judge(scene)
    }
}

fn judge(bytes: &[u8], lie: Lie) -> Judged {
    let mut script = Script::new(bytes);
    let mut episode = guard::episode(&mut script);
    episode.lie = lie;
    episode.obstacle_mps = 0.0;
    episode.style = script.one_of([Style::Reckless, Style::Wander, Style::Spot]);
    episode.steered &= lie != Lie::OdometryAge && episode.style != Style::Spot;
    let seconds = (50 + 2 * bytes.len().min(120)) as f64 * episode.period_ms as f64 * 1e-3;
    let mut faults = Faults {
        lied: false,
        injector: Injector::default(),
        monitor: Monitor::new(&episode),
        script: &mut script,
    };
    let report = run_with(&episode, seconds, &mut faults);
    let crash = report.crashes.first().filter(|_| !faults.lied);
    let broken = report.faults.first().or(crash);
    broken.map_or(Ok(report.accepted), |first| Err(first.clone()))
}
