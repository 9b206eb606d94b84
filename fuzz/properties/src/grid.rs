//! The planning grid against plain geometry in floats: who may change which cell, and that no hit is lost.

use crate::script::{Script, noise};
use crate::{Judged, Property, demand};
use haltline::config::{MASKS_MAX, Scanner};
use haltline::grid::{CellIndex, GridRules, LogOdds, OccupancyGrid, RollingGrid, UpdateRule};
use haltline::input::{Beam, Pose};
use haltline::time::Duration;
use haltline::units::{BinaryAngle, Length, Ppm};
use std::f64::consts::TAU;

pub const GRID: Property = Property {
    name: "grid",
    judge: |bytes| judge(bytes, |_, _| {}),
    twins: &[
        ("a hit is lost", |bytes| {
            judge(bytes, |map, case| {
                if let Some(cell) = case.hits().find_map(|hit| cell_of(hit, 0.0)) {
                    map.set(cell, LogOdds::from_counts(-20));
                }
            })
        }),
        ("a cell no beam crossed turns free", |bytes| {
            judge(bytes, |map, case| {
                if let Some(cell) = map.cells().find(|cell| !case.crosses(*cell, TOLERANCE_M)) {
                    map.set(cell, LogOdds::from_counts(-20));
                }
            })
        }),
        ("a cell far from any hit turns occupied", |bytes| {
            judge(bytes, |map, case| {
                if let Some(cell) = map.cells().find(|cell| !case.is_near_hit(*cell)) {
                    map.set(cell, LogOdds::from_counts(60));
                }
            })
        }),
    ],
    draw: noise::<40, 400>,
    cases: 3000,
};

const SIDE: usize = 48;
type Map = OccupancyGrid<SIDE, SIDE>;
/// Edge of a cell, m.
const CELL_M: f64 = 0.1;
/// Table sines and whole micrometres at the farthest hit, generously, m.
const TOLERANCE_M: f64 = 4e-3;
/// Evidence ends so far behind a hit, and begins so far before it (`SensorModel::default`), m.
const BEHIND_M: f64 = 0.2;
const BEFORE_M: f64 = 0.05;

/// One scan, and where its rays run in the frame of the grid.
struct Case {
    pose: Pose,
    scanner: Scanner,
    beams: Vec<Beam>,
    from: [f64; 2],
    /// Direction, end, whether something is there.
    rays: Vec<(f64, f64, bool)>,
}

/// Where the grid lies.
fn origin(script: &mut Script<'_>) -> Pose {
    Pose {
        x_um: (script.between(-50.0, 50.0) * 1e6) as i64,
        y_um: (script.between(-50.0, 50.0) * 1e6) as i64,
        heading: BinaryAngle::from_counts(script.bits() as u32),
    }
}

fn scanner(script: &mut Script<'_>) -> Scanner {
    let beams = script.count(1, 90) as u16;
    let most = (u32::MAX / u32::from(beams)).min(1 << 26);
    let increment = script.between(1e5, f64::from(most)) as i32;
    Scanner {
        x: Length::from_mm(script.between(-600.0, 600.0) as i32),
        y: Length::from_mm(script.between(-600.0, 600.0) as i32),
        first_beam: BinaryAngle::from_counts(script.bits() as u32),
        increment: if script.flag() { increment } else { -increment },
        beams,
        scan_duration: Duration::from_ms(20),
        range_min: Length::from_mm(100),
        range_max: Length::from_mm(20_000),
        error: Length::from_mm(10),
        no_return_clear: Length::from_mm(script.count(0, 3000) as i32),
        invalid_max: Ppm::from_ppm(1_000_000),
        invalid_gap_max: u32::MAX,
        masks: [None; MASKS_MAX],
    }
}

fn radians(angle: BinaryAngle) -> f64 {
    f64::from(angle.as_counts()) / 4_294_967_296.0 * TAU
}

fn turned([x, y]: [f64; 2], by: f64) -> [f64; 2] {
    let (sin, cos) = by.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

impl Case {
    fn new(script: &mut Script<'_>, origin: &Pose) -> Self {
        let [ahead, aside] = [script.between(-3.0, 7.0), script.between(-3.0, 7.0)];
        let [x, y] = turned([ahead, aside], radians(origin.heading));
        let pose = Pose {
            x_um: origin.x_um + (x * 1e6) as i64,
            y_um: origin.y_um + (y * 1e6) as i64,
            heading: BinaryAngle::from_counts(script.bits() as u32),
        };
        let scanner = scanner(script);
        let beam = |script: &mut Script<'_>| match script.byte() % 8 {
            0 => Beam::Invalid,
            1 => Beam::TooNear,
            2 => Beam::NoReturn,
            _ => Beam::Hit((script.word() >> 3).max(1)),
        };
        let beams: Vec<Beam> = (0..scanner.beams).map(|_| beam(script)).collect();
        let mut case = Self {
            pose,
            scanner,
            beams,
            from: [0.0; 2],
            rays: Vec::new(),
        };
        case.trace(origin);
        case
    }

    /// The rays in the frame of the grid, from what was put in alone.
    fn trace(&mut self, origin: &Pose) {
        let (scanner, turn) = (&self.scanner, radians(origin.heading));
        let heading = radians(self.pose.heading) - turn;
        let [dx, dy] =
            [self.pose.x_um - origin.x_um, self.pose.y_um - origin.y_um].map(|um| um as f64 * 1e-6);
        let [x, y] = turned([dx, dy], -turn);
        let mount = [scanner.x, scanner.y].map(|at| f64::from(at.as_um()) * 1e-6);
        let [mx, my] = turned(mount, heading);
        self.from = [x + mx, y + my];
        let first = radians(scanner.first_beam) + heading;
        let step = f64::from(scanner.increment) / 4_294_967_296.0 * TAU;
        let length = |length: Length| f64::from(length.as_um()) * 1e-6;
        let rays = self.beams.iter().enumerate().filter_map(|(index, beam)| {
            let angle = first + step * index as f64;
            match beam {
                Beam::Hit(mm) => Some((angle, f64::from(*mm) * 1e-3, true)),
                Beam::TooNear => Some((angle, length(scanner.range_min), true)),
                Beam::NoReturn => Some((angle, length(scanner.no_return_clear), false)),
                Beam::Invalid => None,
            }
        });
        self.rays = rays.collect();
    }

    fn at(&self, angle: f64, range: f64) -> [f64; 2] {
        let [x, y] = self.from;
        [x + range * angle.cos(), y + range * angle.sin()]
    }

    fn hits(&self) -> impl Iterator<Item = [f64; 2]> {
        let hits = self.rays.iter().filter(|ray| ray.2);
        hits.map(|&(angle, range, _)| self.at(angle, range))
    }

    /// Whether some ray comes within `margin` of the cell before its evidence ends.
    fn crosses(&self, cell: CellIndex, margin: f64) -> bool {
        self.rays.iter().any(|&(angle, range, hit)| {
            let end = range + if hit { BEHIND_M } else { 0.0 };
            meets(cell, margin, self.from, self.at(angle, end))
        })
    }

    /// Whether some hit may speak for the cell: near the end of a ray, a diagonal to spare.
    fn is_near_hit(&self, cell: CellIndex) -> bool {
        let spare = CELL_M * 1.5;
        self.rays
            .iter()
            .filter(|ray| ray.2)
            .any(|&(angle, range, _)| {
                let from = self.at(angle, (range - BEFORE_M - spare).max(0.0));
                let to = self.at(angle, range + BEHIND_M + spare);
                meets(cell, TOLERANCE_M, from, to)
            })
    }
}

/// Whether a segment meets the square of a cell grown by `margin` (slabs).
fn meets(cell: CellIndex, margin: f64, from: [f64; 2], to: [f64; 2]) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (axis, index) in [cell.column(), cell.row()].into_iter().enumerate() {
        let low = f64::from(index) * CELL_M - margin - from[axis];
        let high = low + CELL_M + 2.0 * margin;
        let way = to[axis] - from[axis];
        if way.abs() < 1e-12 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        enter = enter.max((low / way).min(high / way));
        leave = leave.min((low / way).max(high / way));
    }
    enter <= leave
}

/// The cell of a point that lies at least `inside` from its borders.
fn cell_of([x, y]: [f64; 2], inside: f64) -> Option<CellIndex> {
    let (column, row) = ((x / CELL_M).floor(), (y / CELL_M).floor());
    let off = |value: f64, index: f64| value - index * CELL_M;
    let clear = [off(x, column), off(y, row)]
        .iter()
        .all(|off| *off >= inside && *off <= CELL_M - inside);
    clear.then(|| CellIndex::new(column as i32, row as i32))
}

fn judge(bytes: &[u8], change: fn(&mut Map, &Case)) -> Judged {
    let mut script = Script::new(bytes);
    let update = script.one_of([
        UpdateRule::EveryBeam,
        UpdateRule::EveryBeam,
        UpdateRule::NearestBeam,
    ]);
    let rules = GridRules {
        update,
        ..GridRules::default()
    };
    let origin = origin(&mut script);
    let map = Map::new(rules, origin).map_err(|error| error.to_string())?;
    let mut map = Box::new(map);
    let mut judged = 0;
    for _ in 0..6 {
        let case = Case::new(&mut script, &origin);
        let before = map.clone();
        if script.chance(16) {
            refuse(&mut script, &mut map, &before, &case)?;
        }
        let entered = map.update(&case.pose, &case.scanner, &case.beams);
        demand(entered.is_ok(), || format!("refused: {entered:?}"))?;
        change(&mut map, &case);
        check(&rules, &before, &map, &case)?;
        judged += case.rays.len();
        if script.is_over() {
            break;
        }
    }
    rolls(&mut script, rules)?;
    Ok(judged)
}

/// What is refused changes nothing.
fn refuse(script: &mut Script<'_>, map: &mut Map, before: &Map, case: &Case) -> Result<(), String> {
    let far = Pose {
        x_um: if script.flag() { 1 << 50 } else { -(1 << 50) },
        ..case.pose
    };
    let short = &case.beams[1..];
    let answers = [
        map.update(&case.pose, &case.scanner, short),
        map.update(&far, &case.scanner, &case.beams),
    ];
    demand(answers.iter().all(Result::is_err), || {
        format!("{answers:?}")
    })?;
    let same = map
        .cells()
        .all(|cell| map.log_odds(cell) == before.log_odds(cell));
    demand(same, || "a refused scan changed the grid".to_owned())
}

fn check(rules: &GridRules, before: &Map, map: &Map, case: &Case) -> Result<(), String> {
    for cell in map.cells() {
        let (Some(old), Some(new)) = (before.log_odds(cell), map.log_odds(cell)) else {
            return Err(format!("{cell:?} has no value"));
        };
        demand(new >= rules.floor && new <= rules.ceiling, || {
            format!("{cell:?} is {new:?}")
        })?;
        // The nearest beam of a cell need not cross it.
        let beside = match rules.update {
            UpdateRule::EveryBeam => TOLERANCE_M,
            UpdateRule::NearestBeam => continue,
        };
        demand(new >= old || case.crosses(cell, beside), || {
            format!("{cell:?} fell from {old:?} to {new:?}, no beam crosses it")
        })?;
        demand(new <= old || case.is_near_hit(cell), || {
            format!("{cell:?} rose from {old:?} to {new:?}, no hit is near it")
        })?;
    }
    if rules.update == UpdateRule::NearestBeam {
        return Ok(());
    }
    for hit in case.hits() {
        let known = cell_of(hit, TOLERANCE_M).and_then(|cell| map.log_odds(cell));
        demand(
            known.is_none_or(|value| value >= rules.occupied_from),
            || format!("the hit at {hit:?} is lost: {known:?}"),
        )?;
    }
    Ok(())
}

/// A window that follows the robot keeps what stays in it and forgets the rest.
fn rolls(script: &mut Script<'_>, rules: GridRules) -> Result<(), String> {
    let grid = RollingGrid::<16, 16>::new(rules).map_err(|error| error.to_string())?;
    let mut grid = Box::new(grid);
    let case = Case::new(script, &Pose::default());
    let _ = grid.update(&case.pose, &case.scanner, &case.beams);
    for _ in 0..3 {
        let before = grid.clone();
        let to = Pose {
            x_um: case.pose.x_um + (script.between(-3.0, 3.0) * 1e6) as i64,
            y_um: case.pose.y_um + (script.between(-3.0, 3.0) * 1e6) as i64,
            ..Pose::default()
        };
        let moved = grid.follow(&to);
        demand(moved.is_ok(), || format!("{moved:?}"))?;
        for cell in grid.grid().cells() {
            let expected = before.grid().log_odds(cell).unwrap_or(LogOdds::PRIOR);
            let found = grid.grid().log_odds(cell);
            demand(found == Some(expected), || {
                format!("{cell:?}: {expected:?} became {found:?} on the way")
            })?;
        }
    }
    Ok(())
}
