//! Bodies: where they stand and how they move.

use super::{Family, push, put};
use crate::genes::{Dice, Genes, rounded};
use crate::setting::Setting;
use core::f64::consts::PI;
use toml::{Table, Value};

/// What is asked of the bodies.
pub(super) struct Scene {
    pub family: Family,
    /// Bound of obstacle speed; zero: nothing moves.
    pub speed_mps: f64,
    /// Times the bound at which moving bodies move, where A-OBSTACLE is broken.
    pub faster: Option<f64>,
    /// Whether the bodies are made of glass.
    pub invisible: bool,
    /// Times by which the bodies are too thin, where A-WIDTH is broken.
    pub thinner: Option<f64>,
}

/// A room and the bodies in it.
pub(super) fn bodies(
    setting: &Setting,
    scene: &Scene,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    room(setting, table);
    if scene.family == Family::Gap {
        return gap(setting, scene, dice, genes, table);
    }
    let count = match scene.family {
        Family::Ahead | Family::Mover => 1 + dice.index(2),
        Family::Spot | Family::Beside | Family::Past => 1 + dice.index(3),
        _ => 2 + dice.index(4),
    };
    for index in 0..count {
        let at = place(setting, scene.family, dice, genes);
        let moves = scene.speed_mps > 0.0 && (index == 0 || dice.chance(0.5));
        body(setting, scene, at, moves, dice, genes, table);
    }
}

/// Walls around everything, so that beams come back.
fn room(setting: &Setting, table: &mut Table) {
    let ranges = setting.truth.values.scanners.iter().map(|s| s.range_max_m);
    let half = rounded(ranges.fold(8.0, f64::min).min(8.0) * 0.75);
    for [from, to] in [
        [[-half, -half], [half, -half]],
        [[half, -half], [half, half]],
        [[half, half], [-half, half]],
        [[-half, half], [-half, -half]],
    ] {
        let mut wall = Table::new();
        put(&mut wall, "from_m", from.map(Value::from).to_vec());
        put(&mut wall, "to_m", to.map(Value::from).to_vec());
        push(table, "wall", wall);
    }
}

/// Where a body stands, with the robot at the origin heading along x.
fn place(setting: &Setting, family: Family, dice: &mut Dice, genes: &mut Genes<'_>) -> [f64; 2] {
    let outline = &setting.truth.values.footprint;
    let radius = outline.radius_m();
    let half = outline.width_m() / 2.0;
    match family {
        Family::Ahead | Family::Gap => [
            outline.front_m + genes.between(0.5, 3.5),
            genes.between(-half - 0.3, half + 0.3),
        ],
        Family::Beside | Family::Past => [
            genes.between(0.6, 4.0),
            dice.sign() * (half + genes.between(0.1, 0.7)),
        ],
        Family::Spot => polar(
            genes.between(radius + 0.1, radius + 0.8),
            genes.between(-PI, PI),
        ),
        Family::Mover => polar(genes.between(radius + 0.8, 5.0), genes.between(-2.2, 2.2)),
        Family::Clutter => polar(genes.between(radius + 0.2, 4.5), genes.between(-PI, PI)),
    }
}

fn polar(distance: f64, angle: f64) -> [f64; 2] {
    [distance * angle.cos(), distance * angle.sin()]
}

fn body(
    setting: &Setting,
    scene: &Scene,
    [x, y]: [f64; 2],
    moves: bool,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    let least = setting.truth.values.memory.body_width_min_m.max(0.02);
    let (long, wide) = (genes.between(least, 0.6), genes.between(least, 0.4));
    let wide = scene.thinner.map_or(wide, |times| least / times);
    let round = dice.chance(0.4);
    let heading_deg = genes.between(-90.0, 90.0);
    let mut body = Table::new();
    put(&mut body, "center_m", pair([x, y]));
    if round {
        // Rounding to a thousandth must not make it thinner than is assumed.
        let least = if scene.thinner.is_some() {
            0.0
        } else {
            (least / 2.0 * 1e3).ceil() / 1e3
        };
        put(&mut body, "radius_m", fine(wide / 2.0).max(least));
    } else {
        put(
            &mut body,
            "size_m",
            vec![Value::from(long), Value::from(fine(wide))],
        );
        put(&mut body, "heading_deg", heading_deg);
    }
    if scene.invisible {
        put(&mut body, "material", "invisible");
    }
    if moves {
        let towards = (-y).atan2(-x) + genes.between(-1.2, 1.2);
        let speed = scene.speed_mps * scene.faster.unwrap_or(1.0);
        // Rounded towards zero: the bound is a bound.
        let down = |v: f64| (v * 1e3).trunc() / 1e3;
        let velocity = [down(speed * towards.cos()), down(speed * towards.sin())];
        let mut motion = Table::new();
        put(
            &mut motion,
            "velocity_mps",
            velocity.map(Value::from).to_vec(),
        );
        put(&mut motion, "from_s", genes.between(0.0, 4.0));
        put(&mut motion, "for_s", genes.between(0.5, 8.0));
        put(&mut body, "motion", motion);
    }
    push(table, if round { "circle" } else { "box" }, body);
}

/// Two boxes with a gap that the robot may or may not fit through.
fn gap(
    setting: &Setting,
    scene: &Scene,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    let outline = &setting.truth.values.footprint;
    let x = outline.front_m + genes.between(0.6, 3.0);
    let width = outline.width_m() + genes.between(-0.1, 0.7);
    let middle = genes.between(-0.3, 0.3);
    let least = setting.truth.values.memory.body_width_min_m.max(0.1);
    let deep = genes.between(least, least.max(1.5));
    for side in [1.0, -1.0] {
        let long = genes.between(0.2, 1.0);
        let mut body = Table::new();
        put(
            &mut body,
            "center_m",
            pair([x, middle + side * (width + long) / 2.0]),
        );
        let deep = scene.thinner.map_or(deep, |times| {
            setting.truth.values.memory.body_width_min_m / times
        });
        put(
            &mut body,
            "size_m",
            vec![Value::from(fine(deep)), Value::from(long)],
        );
        if scene.invisible {
            put(&mut body, "material", "invisible");
        }
        if scene.speed_mps > 0.0 && dice.chance(0.7) {
            let speed = rounded(scene.speed_mps * scene.faster.unwrap_or(1.0));
            let mut motion = Table::new();
            put(&mut motion, "velocity_mps", pair([0.0, -side * speed]));
            put(&mut motion, "from_s", genes.between(0.0, 4.0));
            put(&mut motion, "for_s", genes.between(0.1, 2.0));
            put(&mut body, "motion", motion);
        }
        push(table, "box", body);
    }
}

fn pair(point: [f64; 2]) -> Vec<Value> {
    point.map(|v| Value::from(rounded(v))).to_vec()
}

/// To a tenth of a millimetre, for thin things.
fn fine(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
