//! Any inputs at all through the kernel's door: limits, expiry, stops and the latch hold, and twice the same is twice
//! the same answer.

use crate::closed_loop::run::EPOCH_US;
use crate::guard;
use crate::script::{Script, noise};
use crate::{Judged, Property, demand};
use haltline::Kernel;
use haltline::config::Config;
use haltline::convert;
use haltline::decision::{Action, Decision, StopStatus};
use haltline::input::{Beam, Command, Inputs, Motion, Odometry, Reading, Scan};
use haltline::time::{Duration, Instant};
use haltline::units::{AngularSpeed, Curvature, Speed};

pub const INPUTS: Property = Property {
    name: "inputs",
    judge: |bytes| judge(bytes, |_, decision| decision),
    twins: &[
        ("a set point beyond the limit", |bytes| {
            judge(bytes, |_, mut decision| {
                if let Motion::Twist(twist) = &mut decision.setpoint
                    && decision.action == Action::Pass
                {
                    twist.linear = Speed::from_um_per_s(twist.linear.as_um_per_s() * 40);
                }
                decision
            })
        }),
        ("an hour to live", |bytes| {
            judge(bytes, |_, mut decision| {
                decision.expires = decision.expires.plus(Duration::from_ms(3_600_000));
                decision
            })
        }),
        ("running in spite of the line", |bytes| {
            judge(bytes, |_, mut decision| {
                decision.status = StopStatus::Running;
                decision
            })
        }),
        ("accepts while stopped", |bytes| {
            judge(bytes, |before, mut decision| {
                if decision.status != StopStatus::Running && before.verdict.is_some() {
                    decision = *before;
                    decision.status = StopStatus::Protective;
                }
                decision
            })
        }),
    ],
    draw: noise::<60, 400>,
    cases: 3000,
};

const BEAMS: usize = 180;
type Small = Kernel<2, BEAMS, 64>;
/// Changes an answer, given the one before.
type Change = fn(&Decision, Decision) -> Decision;

/// What the inputs are made of: mostly a quiet world and a robot that does as it is told.
struct World {
    now_us: u64,
    pose: [f64; 3],
    twist: [f64; 2],
    ticks: u64,
}

fn judge(bytes: &[u8], change: Change) -> Judged {
    let mut script = Script::new(bytes);
    let mut episode = guard::episode(&mut script);
    episode.beams = BEAMS;
    let config = episode.config();
    let kernel = Small::new(config).map_err(|error| format!("refused: {error:?}"))?;
    let mut kernel = Box::new(kernel);
    let mut world = World {
        now_us: EPOCH_US,
        pose: [0.0; 3],
        twist: [0.0; 2],
        ticks: 0,
    };
    let mut before: Option<Decision> = None;
    let (mut accepted, mut tail) = (0, 12);
    while tail > 0 {
        tail -= usize::from(script.is_over());
        let tick = world.tick(&mut script, &config);
        let scans = [tick.scan.as_reading()];
        let inputs = Inputs {
            scans: &scans[..usize::from(tick.has_scan)],
            odometry: tick.odometry,
            command: tick.command,
            emergency_stop: tick.emergency_stop,
            reset: tick.reset,
        };
        let mut twice = world.ticks.is_multiple_of(8).then(|| kernel.clone());
        let decision = kernel.step(&inputs, tick.now);
        if let Some(again) = twice.as_mut().map(|kernel| kernel.step(&inputs, tick.now)) {
            demand(again == decision, || {
                format!("{decision:?}, then {again:?}")
            })?;
        }
        let decision = before.map_or(decision, |before| change(&before, decision));
        check(&config, &inputs, tick.now, before.as_ref(), &decision)?;
        accepted += usize::from(is_accepted(&decision));
        world.follow(&decision, config.timing.period);
        before = Some(decision);
    }
    Ok(accepted)
}

const fn is_accepted(decision: &Decision) -> bool {
    matches!(decision.action, Action::Pass | Action::Slow) && decision.verdict.is_some()
}

/// One tick's inputs; owns its beams.
struct Tick {
    now: Instant,
    has_scan: bool,
    scan: OwnScan,
    odometry: Reading<Odometry>,
    command: Reading<Command>,
    emergency_stop: bool,
    reset: Option<Instant>,
}

struct OwnScan {
    scanner: usize,
    stamp: Instant,
    beams: Vec<Beam>,
    malformed: bool,
}

impl OwnScan {
    fn as_reading(&self) -> Reading<Scan<'_>> {
        if self.malformed {
            return Reading::Malformed;
        }
        Reading::Value(Scan {
            scanner: self.scanner,
            stamp: self.stamp,
            beams: &self.beams,
        })
    }
}

impl World {
    fn tick(&mut self, script: &mut Script<'_>, config: &Config<2>) -> Tick {
        self.ticks += 1;
        self.now_us += config.timing.period.as_us();
        if script.chance(4) {
            let jump = script.bits() >> script.count(20, 63);
            self.now_us = if script.flag() {
                self.now_us.saturating_sub(jump)
            } else {
                self.now_us.saturating_add(jump)
            };
        }
        let now = Instant::from_us(self.now_us);
        Tick {
            now,
            has_scan: !script.chance(8),
            scan: self.scan(script, config),
            odometry: self.odometry(script),
            command: self.command(script),
            emergency_stop: script.chance(2),
            reset: (!script.chance(64)).then(|| self.stamp(script, 0)),
        }
    }

    /// A stamp: mostly `late_us` ago, sometimes any.
    fn stamp(&self, script: &mut Script<'_>, late_us: u64) -> Instant {
        Instant::from_us(match script.byte() {
            255 => script.bits(),
            254 => self
                .now_us
                .saturating_add(script.bits() >> script.count(20, 63)),
            253 => self
                .now_us
                .saturating_sub(script.bits() >> script.count(20, 63)),
            _ => self.now_us.saturating_sub(late_us),
        })
    }

    fn scan(&self, script: &mut Script<'_>, config: &Config<2>) -> OwnScan {
        let scanner = config.scanners[0].as_ref();
        let sweep = scanner.map_or(0, |scanner| scanner.scan_duration.as_us());
        let mut beams = vec![Beam::NoReturn; BEAMS];
        // Nothing tells two blank scans apart.
        beams[(self.ticks % BEAMS as u64) as usize] = Beam::Hit(6000);
        for _ in 0..script.count(0, 3) {
            let (from, many) = (script.count(0, BEAMS), script.count(0, 40));
            let beam = match script.byte() % 5 {
                0 => Beam::Invalid,
                1 => Beam::TooNear,
                2 => Beam::NoReturn,
                _ => Beam::Hit(script.word() / 8),
            };
            beams
                .iter_mut()
                .skip(from)
                .take(many)
                .for_each(|at| *at = beam);
        }
        if script.chance(3) {
            beams.truncate(script.count(0, BEAMS));
        }
        OwnScan {
            scanner: if script.chance(3) {
                script.count(0, 5)
            } else {
                0
            },
            stamp: self.stamp(script, sweep + 1000),
            beams,
            malformed: script.chance(3),
        }
    }

    fn odometry(&self, script: &mut Script<'_>) -> Reading<Odometry> {
        let stamp = self.stamp(script, 500);
        match script.byte() {
            255 => Reading::Absent,
            254 => convert::odometry(
                stamp,
                [script.any(), script.any(), script.any()],
                [script.any(), script.any()],
                None,
            ),
            253 => Reading::Value(Odometry {
                stamp,
                pose: haltline::input::Pose {
                    x_um: script.bits().cast_signed(),
                    y_um: script.bits().cast_signed(),
                    ..Default::default()
                },
                ..Odometry::default()
            }),
            _ => convert::odometry(stamp, self.pose, self.twist, None),
        }
    }

    fn command(&self, script: &mut Script<'_>) -> Reading<Command> {
        let stamp = self.stamp(script, 500);
        match script.byte() {
            255 => Reading::Absent,
            254 => Reading::Malformed,
            253 => convert::twist_command(stamp, script.any(), script.any()),
            252 => convert::arc_command(stamp, script.any(), script.any()),
            251 => Reading::Value(Command {
                stamp,
                motion: Motion::Arc {
                    linear: Speed::from_um_per_s(script.bits() as i32),
                    curvature: Curvature::from_urad_per_m(script.bits() as i32),
                },
            }),
            250 => Reading::Value(Command {
                stamp,
                motion: Motion::Twist(haltline::input::Twist {
                    linear: Speed::from_um_per_s(script.bits() as i32),
                    angular: AngularSpeed::from_urad_per_s(script.bits() as i32),
                }),
            }),
            byte if byte & 1 == 0 => convert::twist_command(stamp, 0.2, 0.1),
            _ => convert::arc_command(stamp, 0.2, 0.1),
        }
    }

    fn follow(&mut self, decision: &Decision, period: Duration) {
        let [v, w] = speeds(decision);
        self.twist = [v, w];
        let (dt, [x, y, theta]) = (period.as_us() as f64 * 1e-6, self.pose);
        self.pose = [
            x + v * dt * theta.cos(),
            y + v * dt * theta.sin(),
            theta + w * dt,
        ];
    }
}

fn speeds(decision: &Decision) -> [f64; 2] {
    let micro = |value: i32| f64::from(value) * 1e-6;
    match decision.setpoint {
        Motion::Twist(twist) => [
            micro(twist.linear.as_um_per_s()),
            micro(twist.angular.as_urad_per_s()),
        ],
        Motion::Arc { linear, curvature } => {
            let v = micro(linear.as_um_per_s());
            [v, v * micro(curvature.as_urad_per_m())]
        }
    }
}

/// Rounding of set points, generously.
const EPS: f64 = 1e-5;

fn check(
    config: &Config<2>,
    inputs: &Inputs<'_>,
    now: Instant,
    before: Option<&Decision>,
    decision: &Decision,
) -> Result<(), String> {
    let must = |holds: bool, id: &str| {
        demand(holds, || {
            format!("{id}: {decision:?} after {before:?}, {now:?}")
        })
    };
    let (limits, timing) = (&config.limits, &config.timing);
    let [v, w] = speeds(decision);
    let [v_max, v_min] = [limits.speed_forward, limits.speed_reverse]
        .map(|speed| f64::from(speed.as_um_per_s()) * 1e-6);
    must(v <= v_max + EPS && v >= -v_min - EPS, "LIMIT-01")?;
    let turn = f64::from(limits.angular_speed.as_urad_per_s()) * 1e-6;
    let steered = matches!(decision.setpoint, Motion::Arc { .. });
    must(steered || w.abs() <= turn + EPS, "LIMIT-02")?;
    let life = timing.period.plus(timing.jitter);
    must(decision.expires <= now.plus(life), "SILENT-01")?;
    let stopped = decision.status != StopStatus::Running;
    must(
        stopped == (decision.action >= Action::ProtectiveStop),
        "LATCH-08",
    )?;
    if let Some(verdict) = decision.verdict {
        let refused = verdict.refusal.is_some();
        must(!(is_accepted(decision) && refused), "GUARD-01")?;
    }
    must(
        !inputs.emergency_stop || decision.status == StopStatus::Latched,
        "LATCH-02",
    )?;
    let Some(before) = before else {
        return must(decision.status == StopStatus::Latched, "LATCH-01");
    };
    let left = before.status == StopStatus::Latched && !(decision.status == StopStatus::Latched);
    let reset = inputs.reset.is_some_and(|stamp| stamp <= now);
    must(
        !left || (reset && decision.status == StopStatus::Running),
        "LATCH-03",
    )?;
    if decision.action >= Action::Brake {
        let [v_old, w_old] = speeds(before);
        let grows = v.abs() > v_old.abs() + EPS || w.abs() > w_old.abs() + EPS;
        must(!grows, "LATCH-07")?;
    }
    Ok(())
}
