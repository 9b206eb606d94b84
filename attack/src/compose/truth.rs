//! The true robot: as bad as the assumptions allow, or worse where one is to be broken.

use super::{fault, inside, push, put};
use crate::genes::{Dice, Genes};
use crate::setting::Setting;
use core::f64::consts::PI;
use haltline_robots::Ramps;
use haltline_scenarios::file::fault::FaultKind;
use toml::Table;

/// Sensor, odometry and drive within the assumptions; mostly at their edge.
pub(super) fn within(setting: &Setting, dice: &mut Dice, genes: &mut Genes<'_>, table: &mut Table) {
    let worst = dice.chance(0.6);
    sensor(setting, worst, dice, genes, table);
    odometry(setting, worst, dice, genes, table);
    drive(setting, worst, dice, genes, table);
}

/// The least error bound of all scanners.
fn sensor_error_m(setting: &Setting) -> f64 {
    let scanners = &setting.truth.values.scanners;
    let errors = scanners.iter().map(haltline_robots::Scanner::error_m);
    errors.fold(f64::INFINITY, f64::min)
}

/// Rounded towards zero to a tenth of a millimetre, so that a bound stays one.
fn down(value: f64) -> f64 {
    (value * 1e4).trunc() / 1e4
}

fn sensor(
    setting: &Setting,
    worst: bool,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    let error_m = sensor_error_m(setting);
    let part = genes.between(-1.0, 1.0);
    let bias_m = down(error_m * if worst { 1.0 } else { part });
    let lossy = dice.chance(0.2);
    let lost = genes.between(0.0, 0.3);
    let Some(sensor) = inside(table, "sensor") else {
        return;
    };
    put(sensor, "bias_m", bias_m);
    put(
        sensor,
        "noise_sigma_m",
        down((error_m - bias_m.abs()) / 3.0),
    );
    if lossy {
        let most = setting.truth.values.scanners.iter();
        let most = most.map(|s| s.invalid_fraction_max).fold(1.0, f64::min);
        put(sensor, "dropout_fraction", down(lost * most));
    }
}

fn odometry(
    setting: &Setting,
    worst: bool,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    let tolerances = &setting.truth.values.tolerances;
    let parts = [genes.between(-1.0, 1.0), genes.between(-1.0, 1.0)];
    let signs = [dice.sign(), dice.sign()];
    let [linear, angular] = if worst { signs } else { parts };
    let Some(odometry) = inside(table, "odometry") else {
        return;
    };
    put(
        odometry,
        "error_m_per_m",
        down(tolerances.odometry_m_per_m * linear),
    );
    put(
        odometry,
        "error_rad_per_rad",
        down(tolerances.odometry_rad_per_rad * angular),
    );
}

fn drive(
    setting: &Setting,
    worst: bool,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    let values = &setting.truth.values;
    let allowed_s = values.timing.actuation_latency_s;
    let part = genes.between(0.0, 1.0);
    let latency_s = whole_steps(allowed_s * if worst { 1.0 } else { part });
    let harder = genes.between(1.0, 3.0);
    let separate = values.limits.ramps == Ramps::Separate;
    let skids = dice.chance(0.5);
    let (from_s, for_s, angle) = (
        genes.between(0.6, super::TIMEOUT_S),
        genes.between(0.05, 0.6),
        genes.between(-PI, PI),
    );
    let Some(drive) = inside(table, "drive") else {
        return;
    };
    put(drive, "latency_s", latency_s);
    put(
        drive,
        "lag_s",
        down((allowed_s - latency_s) * if worst { 1.0 } else { part }),
    );
    if !worst {
        let limits = &values.limits;
        // Rounded up: brakes as sure as stated or surer.
        let up = |v: f64| (v * 1e4).ceil() / 1e4;
        put(drive, "braking_mps2", up(limits.braking_mps2 * harder));
        put(
            drive,
            "angular_braking_radps2",
            up(limits.angular_braking_radps2 * harder),
        );
    }
    if separate {
        put(drive, "separate_ramps", true);
    }
    if skids && values.tolerances.tracking_m > 0.0 {
        put(
            drive,
            "skid",
            skid(from_s, for_s, angle, values.tolerances.tracking_m),
        );
    }
}

fn skid(from_s: f64, for_s: f64, angle: f64, far_m: f64) -> Table {
    let mut skid = Table::new();
    put(&mut skid, "from_s", from_s);
    put(&mut skid, "for_s", for_s);
    put(&mut skid, "ahead_m", down(far_m * angle.cos()));
    put(&mut skid, "left_m", down(far_m * angle.sin()));
    skid
}

/// Whole dynamics steps of the simulator, rounded down, seconds.
fn whole_steps(time_s: f64) -> f64 {
    (time_s * 100.0 + 1e-9).floor() / 100.0
}

/// An assumption to break.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Breach {
    /// Brakes weaker than stated.
    Brake,
    /// A drive that reacts later than stated.
    Latency,
    /// Ranges that err by more than stated.
    Sensor,
    /// Skids farther than stated.
    Tracking,
    /// Odometry that errs by more than stated.
    Odometry,
    /// Bodies faster than stated.
    Obstacle,
    /// Bodies that no beam comes back from.
    Visible,
    /// Bodies thinner than stated.
    Width,
    /// A kernel that pauses while nobody heeds the expiry of its decision.
    Watchdog,
    /// A fault of the catalogue, which breaks the assumption of this id.
    Fault(FaultKind, &'static str),
}

const BREACHES: [Breach; 9] = [
    Breach::Brake,
    Breach::Latency,
    Breach::Sensor,
    Breach::Tracking,
    Breach::Odometry,
    Breach::Obstacle,
    Breach::Visible,
    Breach::Width,
    Breach::Watchdog,
];

impl Breach {
    pub(super) fn draw(dice: &mut Dice) -> Self {
        let faults = fault::kinds(true);
        let drawn = dice.index(BREACHES.len() + faults.len());
        match BREACHES.get(drawn) {
            Some(breach) => *breach,
            None => {
                let fault = faults.get(drawn - BREACHES.len());
                fault.map_or(Self::Brake, |(kind, id)| Self::Fault(*kind, id))
            }
        }
    }

    /// What it is called in a campaign's record.
    pub(super) fn name(self) -> String {
        match self {
            Self::Fault(kind, id) => format!("{id} by {}", kind.name()),
            _ => self.id().to_owned(),
        }
    }

    /// Whether it can be broken by more or by less.
    pub(super) fn has_size(self) -> bool {
        match self {
            Self::Visible => false,
            Self::Fault(kind, _) => fault::has_size(kind),
            _ => true,
        }
    }

    /// Id in `spec/assumptions.md`.
    pub(super) const fn id(self) -> &'static str {
        match self {
            Self::Brake => "A-BRAKE",
            Self::Latency => "A-LATENCY",
            Self::Sensor => "A-SENSOR",
            Self::Tracking => "A-TRACKING",
            Self::Odometry => "A-ODOMETRY",
            Self::Obstacle => "A-OBSTACLE",
            Self::Visible => "A-VISIBLE",
            Self::Width => "A-WIDTH",
            Self::Watchdog => "A-WATCHDOG",
            Self::Fault(_, id) => id,
        }
    }

    /// Makes the true robot worse than assumed by `factor`; bodies are broken where they are made.
    pub(super) fn put(
        self,
        setting: &Setting,
        factor: f64,
        genes: &mut Genes<'_>,
        table: &mut Table,
    ) {
        if let Self::Fault(kind, _) = self {
            return fault::add(kind, factor, genes, table);
        }
        let values = &setting.truth.values;
        let limits = &values.limits;
        let Some(drive) = inside(table, "drive") else {
            return;
        };
        match self {
            Self::Brake => {
                put(drive, "braking_mps2", limits.braking_mps2 / factor);
                put(
                    drive,
                    "angular_braking_radps2",
                    limits.angular_braking_radps2 / factor,
                );
            }
            Self::Latency => {
                let late_s = values.timing.actuation_latency_s * factor;
                put(drive, "latency_s", (late_s * 100.0).ceil() / 100.0);
            }
            Self::Tracking => {
                let from_s = drive.get("skid").and_then(|s| s.get("from_s")?.as_float());
                let far_m = values.tolerances.tracking_m * factor;
                put(drive, "skid", skid(from_s.unwrap_or(2.0), 0.3, 0.4, far_m));
            }
            Self::Sensor => {
                let error_m = sensor_error_m(setting) * factor;
                if let Some(sensor) = inside(table, "sensor") {
                    put(sensor, "bias_m", error_m);
                    put(sensor, "noise_sigma_m", 0.0);
                }
            }
            Self::Odometry => {
                let errors = [
                    values.tolerances.odometry_m_per_m,
                    values.tolerances.odometry_rad_per_rad,
                ];
                if let Some(odometry) = inside(table, "odometry") {
                    put(odometry, "error_m_per_m", -errors[0] * factor);
                    put(odometry, "error_rad_per_rad", -errors[1] * factor);
                }
            }
            Self::Watchdog => {
                put(drive, "honours_expiry", false);
                let mut pause = Table::new();
                put(&mut pause, "kind", "host_pause");
                put(&mut pause, "from_s", 2.0);
                put(&mut pause, "until_s", 2.0 + 0.2 * factor);
                push(table, "fault", pause);
            }
            Self::Obstacle | Self::Visible | Self::Width | Self::Fault(..) => {}
        }
    }
}
