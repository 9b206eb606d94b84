//! A configuration that passed every check, with the constants derived from it once.

use crate::arith::{div_up, magnitude, sqrt_up};
use crate::config::{Config, HostDeath, Kinematics, Ramps, Scanner};
use crate::geometry::rect::Rect;
use crate::guard::hull::VERTICES_MAX;
use crate::guard::memory::MemoryModel;
use crate::guard::plan::Dynamics;
use crate::guard::seen::COVER_MM;
use crate::guard::sweep::JOIN_MAX_MM;
use crate::guard::tube::{TubeParameters, eighths_up};
use crate::time::Duration;
use crate::units::Length;

/// Why a configuration is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum ConfigError {
    /// A footprint edge is negative, or the footprint has no area, or it is larger than 4 m.
    Footprint,
    /// A speed limit is negative or above 20 m/s or 20 rad/s.
    SpeedLimit,
    /// An acceleration or deceleration is zero.
    Acceleration,
    /// A drive that ramps v and ω together cannot follow set points that accelerate faster than
    /// it surely brakes: the ramp to rest would lag behind them.
    Ramps,
    /// The control period is zero, or period, jitter, latency or the ages exceed 10 s.
    Timing,
    /// Latency, odometry age and steering sweep hold more control periods than the hull has room for.
    Pipeline,
    /// A tolerance is negative or implausibly large.
    Tolerance,
    /// A margin of the critical zone is negative.
    Zone,
    /// There is no scanner.
    NoScanner,
    /// Scanner `0`: no beams, more beams than the kernel has room for, or beams that overlap.
    ScannerBeams(usize),
    /// Scanner `0`: ranges, error or mounting position out of bounds.
    ScannerRange(usize),
    /// The memory rules are impossible (zero clearing scans, negative lengths).
    Memory,
    /// The obstacle speed is negative or above 20 m/s.
    ObstacleSpeed,
    /// The Ackermann curvature limits are not positive.
    Curvature,
}

/// A checked configuration.
#[derive(Clone, Copy, Debug)]
pub struct KernelConfig<const S: usize> {
    config: Config<S>,
    tube: TubeParameters,
    memory: MemoryModel,
}

impl<const S: usize> KernelConfig<S> {
    /// Checks `config` for a kernel with room for `beams_max` beams per scanner.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn new(config: Config<S>, beams_max: usize) -> Result<Self, ConfigError> {
        check_robot(&config)?;
        check_timing(&config)?;
        let mut any = false;
        for (index, scanner) in config.scanners.iter().enumerate() {
            if let Some(scanner) = scanner {
                check_scanner(index, scanner, beams_max)?;
                any = true;
            }
        }
        if !any {
            return Err(ConfigError::NoScanner);
        }
        Ok(Self {
            tube: tube_parameters(&config),
            memory: memory_model(&config),
            config,
        })
    }

    /// The plain configuration.
    #[must_use]
    pub const fn config(&self) -> &Config<S> {
        &self.config
    }

    /// What the tube needs.
    #[must_use]
    pub const fn tube(&self) -> &TubeParameters {
        &self.tube
    }

    /// How points age.
    #[must_use]
    pub const fn memory(&self) -> &MemoryModel {
        &self.memory
    }

    /// Time from the odometry stamp, `odometry_age` ago, during which any motion of the hull
    /// may be followed, µs.
    #[must_use]
    pub fn reaction_us(&self, odometry_age: Duration) -> u64 {
        let timing = &self.config.timing;
        let tick = timing.period.plus(timing.jitter);
        //= spec/guard.md#guard-12
        //# With host death covered, the tube MUST contain every trajectory in which the drive goes on until its
        //# watchdog time has passed since it received the last decision and then brakes by itself.
        let silence = self
            .config
            .host_death
            .map_or(Duration::ZERO, |death| death.watchdog);
        //= spec/guard.md#guard-04
        //# The hold time of a tube MUST be at least the age of the odometry sample plus control period, jitter and
        //# actuation latency, counted from the odometry stamp, at whose pose the tube starts.
        odometry_age
            .plus(timing.actuation_latency)
            .plus(tick.max(silence))
            .as_us()
    }

    /// How long ago a command may have been sent and still determine the motion, before the
    /// odometry stamp.
    #[must_use]
    pub fn pipeline(&self) -> Duration {
        let sweep = match self.config.kinematics {
            Kinematics::Differential => Duration::ZERO,
            Kinematics::Ackermann { steering_sweep, .. } => steering_sweep,
        };
        self.config.timing.actuation_latency.plus(sweep)
    }
}

fn within(value: i32, most: i32) -> bool {
    (0..=most).contains(&value)
}

fn check_robot<const S: usize>(config: &Config<S>) -> Result<(), ConfigError> {
    let outline = &config.footprint;
    let edges = [outline.front, outline.rear, outline.left, outline.right];
    let sum = |a: Length, b: Length| a.as_um().saturating_add(b.as_um());
    if !edges.iter().all(|edge| within(edge.as_um(), 2_000_000))
        || sum(outline.front, outline.rear) == 0
        || sum(outline.left, outline.right) == 0
    {
        return Err(ConfigError::Footprint);
    }
    let limits = &config.limits;
    let speeds = [
        limits.speed_forward.as_um_per_s(),
        limits.speed_reverse.as_um_per_s(),
        limits.angular_speed.as_urad_per_s(),
    ];
    if !speeds.iter().all(|&speed| within(speed, 20_000_000)) {
        return Err(ConfigError::SpeedLimit);
    }
    if limits.acceleration.as_um_per_s2() == 0
        || limits.braking.as_um_per_s2() == 0
        || limits.angular_acceleration.as_urad_per_s2() == 0
        || limits.angular_braking.as_urad_per_s2() == 0
        || config.host_death.is_some_and(|death| {
            death.braking.as_um_per_s2() == 0 || death.angular_braking.as_urad_per_s2() == 0
        })
    {
        return Err(ConfigError::Acceleration);
    }
    if limits.acceleration.as_um_per_s2() > limits.braking.as_um_per_s2()
        || limits.angular_acceleration.as_urad_per_s2() > limits.angular_braking.as_urad_per_s2()
    {
        return Err(ConfigError::Ramps);
    }
    if let Kinematics::Ackermann {
        curvature_max,
        curvature_tolerance,
        ..
    } = config.kinematics
        && (curvature_max.as_urad_per_m() <= 0 || curvature_tolerance.as_urad_per_m() < 0)
    {
        return Err(ConfigError::Curvature);
    }
    if !within(config.obstacle_speed.as_um_per_s(), 20_000_000) {
        return Err(ConfigError::ObstacleSpeed);
    }
    let zone = &config.zone;
    if !within(zone.front.as_um(), 2_000_000) || !within(zone.side.as_um(), 2_000_000) {
        return Err(ConfigError::Zone);
    }
    check_tolerances(config)
}

fn check_tolerances<const S: usize>(config: &Config<S>) -> Result<(), ConfigError> {
    let bounds = &config.tolerances;
    let values = [
        bounds.speed.as_um_per_s(),
        bounds.angular_speed.as_urad_per_s(),
        bounds.tracking.as_um(),
        bounds.rest_speed.as_um_per_s(),
        bounds.rest_angular_speed.as_urad_per_s(),
        bounds.follow_speed.as_um_per_s(),
        bounds.follow_angular_speed.as_urad_per_s(),
    ];
    let ratios = [bounds.odometry_linear, bounds.odometry_angular];
    if !values.iter().all(|&value| within(value, 2_000_000))
        || !ratios.iter().all(|ratio| ratio.as_ppm() <= 1_000_000)
    {
        return Err(ConfigError::Tolerance);
    }
    let memory = &config.memory;
    if memory.clear_after_scans == 0
        || memory.age_max == Duration::ZERO
        || !within(memory.clear_at_start.as_um(), 10_000_000)
        || !within(memory.skirt.as_um(), 1_000_000)
        || !within(memory.body_width_min.as_um(), 1_000_000)
    {
        return Err(ConfigError::Memory);
    }
    Ok(())
}

fn check_timing<const S: usize>(config: &Config<S>) -> Result<(), ConfigError> {
    let timing = &config.timing;
    let most = Duration::from_ms(10_000);
    let spans = [
        timing.jitter,
        timing.actuation_latency,
        timing.scan_age_max,
        timing.odometry_age_max,
        timing.command_age_max,
        timing.rest,
        timing.clear,
        timing.tracking_window,
    ];
    if timing.period == Duration::ZERO
        || timing.period > most
        || spans.iter().any(|&span| span > most)
    {
        return Err(ConfigError::Timing);
    }
    let sweep = match config.kinematics {
        Kinematics::Differential => Duration::ZERO,
        Kinematics::Ackermann { steering_sweep, .. } => steering_sweep,
    };
    let window = timing
        .odometry_age_max
        .plus(timing.actuation_latency)
        .plus(sweep)
        .as_us();
    // Measured, the last before the window, the new one, the unknown past, and rounding.
    let needed = div_up(window, timing.period.as_us()).saturating_add(6);
    if needed > VERTICES_MAX as u64 {
        return Err(ConfigError::Pipeline);
    }
    Ok(())
}

fn check_scanner(index: usize, scanner: &Scanner, beams_max: usize) -> Result<(), ConfigError> {
    let beams = u64::from(scanner.beams);
    let span = u64::from(scanner.increment.unsigned_abs()).saturating_mul(beams.saturating_sub(1));
    if beams < 2
        || usize::from(scanner.beams) > beams_max
        || scanner.increment == 0
        || span >= 1 << 32
    {
        return Err(ConfigError::ScannerBeams(index));
    }
    let mount = scanner
        .x
        .as_um()
        .saturating_abs()
        .saturating_add(scanner.y.as_um().saturating_abs());
    if !within(scanner.range_min.as_um(), 10_000_000)
        || scanner.range_max.as_um() <= scanner.range_min.as_um()
        || !within(scanner.range_max.as_um(), 65_000_000)
        || !within(scanner.error.as_um(), 1_000_000)
        || !within(scanner.no_return_clear.as_um(), 65_000_000)
        || mount.div_euclid(1000) >= COVER_MM / 2
        || scanner.scan_duration > Duration::from_ms(1000)
    {
        return Err(ConfigError::ScannerRange(index));
    }
    Ok(())
}

fn tube_parameters<const S: usize>(config: &Config<S>) -> TubeParameters {
    let edge = |length: Length| magnitude(length.as_um());
    let outline = &config.footprint;
    let (x, y) = (
        edge(outline.front).max(edge(outline.rear)),
        edge(outline.left).max(edge(outline.right)),
    );
    let corner = sqrt_up(x.saturating_mul(x).saturating_add(y.saturating_mul(y)));
    TubeParameters {
        dynamics: dynamics(config, corner),
        footprint: Rect {
            front: eighths_up(edge(outline.front)),
            rear: eighths_up(edge(outline.rear)),
            left: eighths_up(edge(outline.left)),
            right: eighths_up(edge(outline.right)),
        },
        tracking_um: edge(config.tolerances.tracking),
        obstacle_speed: magnitude(config.obstacle_speed.as_um_per_s()),
    }
}

fn dynamics<const S: usize>(config: &Config<S>, corner: u64) -> Dynamics {
    let limits = &config.limits;
    let weakest = |own: u32, silent: fn(&HostDeath) -> u32| {
        u64::from(
            config
                .host_death
                .as_ref()
                .map_or(own, |death| own.min(silent(death))),
        )
    };
    let (steered, curvature_tolerance) = match config.kinematics {
        Kinematics::Differential => (false, 0),
        Kinematics::Ackermann {
            curvature_tolerance,
            ..
        } => (true, curvature_tolerance.as_urad_per_m()),
    };
    Dynamics {
        braking: weakest(limits.braking.as_um_per_s2(), |death| {
            death.braking.as_um_per_s2()
        }),
        angular_braking: if steered {
            // The wheels hold the arc: the turn rate falls with the speed.
            u64::MAX
        } else {
            weakest(limits.angular_braking.as_urad_per_s2(), |death| {
                death.angular_braking.as_urad_per_s2()
            })
        },
        separate_ramps: limits.ramps == Ramps::Separate || config.host_death.is_some(),
        steered,
        curvature_tolerance,
        speed_tolerance: magnitude(config.tolerances.speed.as_um_per_s()),
        turn_tolerance: magnitude(config.tolerances.angular_speed.as_urad_per_s()),
        corner,
    }
}

fn memory_model<const S: usize>(config: &Config<S>) -> MemoryModel {
    let outline = &config.footprint;
    let length = outline.front.as_um().saturating_add(outline.rear.as_um());
    let width = outline.left.as_um().saturating_add(outline.right.as_um());
    let speed = magnitude(config.obstacle_speed.as_um_per_s());
    // A moving body whose ball has grown to a metre is nowhere in particular: unknown.
    let moved_away = 1_000_000_000_000_u64.checked_div(speed).unwrap_or(u64::MAX);
    MemoryModel {
        clear_after_scans: config.memory.clear_after_scans,
        age_max: Duration::from_us(config.memory.age_max.as_us().min(moved_away)),
        drift_linear_ppm: u64::from(config.tolerances.odometry_linear.as_ppm()),
        drift_angular_ppm: u64::from(config.tolerances.odometry_angular.as_ppm()),
        obstacle_speed: speed,
        sensor_um: config
            .scanners
            .iter()
            .flatten()
            .map(|scanner| magnitude(scanner.error.as_um()))
            .max()
            .unwrap_or(0),
        body_width_um: magnitude(config.memory.body_width_min.as_um()),
        join_mm: length.min(width).div_euclid(1000).min(JOIN_MAX_MM),
    }
}
