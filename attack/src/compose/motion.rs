//! Who drives, and how.

use super::{Family, push, put};
use crate::genes::{Dice, Genes, rounded};
use crate::setting::Setting;
use haltline_robots::Kinematics;
use toml::{Table, Value};

/// A reckless driver, a script, or the kernel's own navigator.
pub(super) fn proposer(
    setting: &Setting,
    family: Family,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
    table: &mut Table,
) {
    let limits = &setting.truth.values.limits;
    let mut proposer = Table::new();
    let scripted = matches!(family, Family::Spot | Family::Past);
    let draw = if scripted { 1.0 } else { dice.unit() };
    if draw < 0.1 {
        goal(genes, table);
        put(&mut proposer, "kind", "navigate");
    } else if draw < 0.55 {
        goal(genes, table);
        put(&mut proposer, "kind", "reckless");
        let fastest = limits.speed_forward_mps;
        put(
            &mut proposer,
            "speed_mps",
            genes.between(0.2 * fastest, fastest),
        );
    } else {
        put(&mut proposer, "kind", "script");
        // Quick changes of mind keep commands in flight that ask for something else.
        let quick = family != Family::Past && dice.chance(0.3);
        let count = match family {
            Family::Past => 2 + dice.index(2),
            _ if quick => 6 + dice.index(6),
            _ => 1 + dice.index(4),
        };
        let mut until_s = 0.0;
        for index in 0..count {
            until_s += match quick {
                true => genes.between(0.08, 0.8),
                false => genes.between(0.3, 4.0),
            };
            push(
                &mut proposer,
                "step",
                step(setting, family, index, until_s, dice, genes),
            );
        }
    }
    put(table, "proposer", proposer);
}

fn goal(genes: &mut Genes<'_>, table: &mut Table) {
    let mut goal = Table::new();
    let place = [genes.between(3.0, 5.5), genes.between(-1.5, 1.5)];
    put(&mut goal, "position_m", place.map(Value::from).to_vec());
    put(&mut goal, "radius_m", 0.2);
    put(table, "goal", goal);
}

fn step(
    setting: &Setting,
    family: Family,
    index: usize,
    until_s: f64,
    dice: &mut Dice,
    genes: &mut Genes<'_>,
) -> Table {
    let values = &setting.truth.values;
    let limits = &values.limits;
    let spot = family == Family::Spot && (index.is_multiple_of(2) || dice.chance(0.5));
    // Past it first, then turn beside what is out of sight.
    let spot = spot || (family == Family::Past && index > 0);
    let still = spot && values.kinematics == Kinematics::Differential;
    let linear = genes.between(-limits.speed_reverse_mps, limits.speed_forward_mps);
    let mut step = Table::new();
    put(&mut step, "until_s", rounded(until_s));
    put(&mut step, "linear_mps", if still { 0.0 } else { linear });
    match values.kinematics {
        Kinematics::Differential => {
            let most = limits.angular_speed_radps;
            let straight = !still && (family == Family::Past || dice.chance(0.3));
            let turn = genes.between(-most, most);
            put(
                &mut step,
                "angular_radps",
                if straight { 0.0 } else { turn },
            );
        }
        Kinematics::Ackermann(steering) => {
            let most = 1.0 / steering.turning_radius_m;
            put(&mut step, "curvature_per_m", genes.between(-most, most));
        }
    }
    step
}
