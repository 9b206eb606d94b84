//! From a structure and genes to the text of a scenario.

mod fault;
mod motion;
mod truth;
mod world;

use crate::genes::{Dice, Genes};
use crate::setting::Setting;
use toml::{Table, Value};

/// What the scenario is about: which bodies stand where, and who drives how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Something in the way.
    Ahead,
    /// Something that comes at the robot.
    Mover,
    /// Turns on the spot beside bodies.
    Spot,
    /// A gap between two bodies.
    Gap,
    /// Bodies close beside the way.
    Beside,
    /// The same, and a turn when they are behind.
    Past,
    /// Bodies anywhere.
    Clutter,
}

const FAMILIES: [Family; 7] = [
    Family::Ahead,
    Family::Mover,
    Family::Spot,
    Family::Gap,
    Family::Beside,
    Family::Past,
    Family::Clutter,
];

/// A composed scenario.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scenario file.
    pub text: String,
    /// What it is about.
    pub family: Family,
    /// The assumption it breaks.
    pub broken: Option<Broken>,
}

/// An assumption that a scenario breaks on purpose.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Id of the assumption.
    pub id: String,
    /// Its id, and by which fault of the catalogue if by one.
    pub name: String,
    /// How far: times what is assumed where that is a number, else the size of the fault; none where it has no size.
    pub severity: Option<f64>,
}

/// How long a run lasts, seconds.
const TIMEOUT_S: f64 = 8.0;

/// How many genes a structure reads.
#[must_use]
pub fn dimension(setting: &Setting, structure: u64) -> usize {
    let mut genes = Genes::new(&[]);
    let _ = tables(setting, structure, &mut genes, None);
    genes.count()
}

/// The scenario of a structure and its genes. A given `severity` replaces how far an assumption is broken.
#[must_use]
pub fn compose(setting: &Setting, structure: u64, genes: &[f64], severity: Option<f64>) -> Plan {
    let (table, family, broken) = tables(setting, structure, &mut Genes::new(genes), severity);
    // A table of plain values always has a text.
    let text = toml::to_string(&table).unwrap_or_default();
    Plan {
        text,
        family,
        broken,
    }
}

type Tables = (Table, Family, Option<Broken>);

fn tables(
    setting: &Setting,
    structure: u64,
    genes: &mut Genes<'_>,
    severity: Option<f64>,
) -> Tables {
    let mut dice = Dice::new(structure);
    let family = FAMILIES.get(dice.index(FAMILIES.len())).copied();
    let family = family.unwrap_or(Family::Clutter);
    let mut table = Table::new();
    let breach = setting.breaking.then(|| truth::Breach::draw(&mut dice));
    let factor = breach.map(|_| {
        let drawn = genes.between(1.05, 6.0);
        severity.unwrap_or(drawn)
    });
    let moving = family == Family::Mover || breach == Some(truth::Breach::Obstacle);
    let moving = moving || dice.chance(0.2);
    let speed = genes.between(0.1, 1.6);
    let speed = if moving { speed } else { 0.0 };
    put(&mut table, "title", "Found by search");
    put(&mut table, "requirements", vec![Value::from("GUARD-01")]);
    put(&mut table, "robot", setting.name.as_str());
    put(&mut table, "obstacle_speed_mps", speed);
    put(&mut table, "seed", (structure % 1_000_000) as i64);
    put(&mut table, "timeout_s", TIMEOUT_S);
    if !setting.values.is_empty() {
        let values = setting.values.clone().into_iter().collect::<Table>();
        put(&mut table, "robot_values", values);
    }
    if !setting.told.is_empty() {
        let told = setting.told.clone().into_iter().collect::<Table>();
        put(&mut table, "told", told);
    }
    let scene = world::Scene {
        family,
        speed_mps: speed,
        faster: factor.filter(|_| breach == Some(truth::Breach::Obstacle)),
        invisible: breach == Some(truth::Breach::Visible),
        thinner: factor.filter(|_| breach == Some(truth::Breach::Width)),
    };
    world::bodies(setting, &scene, &mut dice, genes, &mut table);
    motion::proposer(setting, family, &mut dice, genes, &mut table);
    truth::within(setting, &mut dice, genes, &mut table);
    if let (Some(breach), Some(factor)) = (breach, factor) {
        breach.put(setting, factor, genes, &mut table);
    } else if setting.told.is_empty() && dice.chance(0.3) {
        // Where a lie is to be found, faults would only stop the robot.
        fault::harmless(&mut dice, genes, &mut table);
    }
    let broken = breach.zip(factor).map(|(breach, severity)| Broken {
        id: breach.id().to_owned(),
        name: breach.name(),
        severity: Some(severity).filter(|_| breach.has_size()),
    });
    expectations(&mut table, broken.as_ref());
    (table, family, broken)
}

/// Nothing is expected that could hide a contact.
fn expectations(table: &mut Table, broken: Option<&Broken>) {
    let mut expect = Table::new();
    put(&mut expect, "travelled_max_m", 1000.0);
    if let Some(broken) = broken {
        put(&mut expect, "contact", "may");
        put(
            &mut expect,
            "assumptions_broken",
            vec![Value::from(broken.id.as_str())],
        );
    }
    put(table, "expect", expect);
    let mut naked = Table::new();
    put(&mut naked, "must_touch", false);
    put(
        &mut naked,
        "reason",
        "found by search; run with --naked to see",
    );
    put(table, "naked", naked);
}

/// Puts a value into a table.
fn put(table: &mut Table, key: &str, value: impl Into<Value>) {
    table.insert(key.to_owned(), value.into());
}

/// A table inside a table, made if there is none.
fn inside<'t>(table: &'t mut Table, key: &str) -> Option<&'t mut Table> {
    table
        .entry(key)
        .or_insert_with(|| Value::Table(Table::new()))
        .as_table_mut()
}

/// Adds an element to a list of tables, made if there is none.
fn push(table: &mut Table, key: &str, element: Table) {
    let list = table.entry(key).or_insert_with(|| Value::Array(Vec::new()));
    if let Some(list) = list.as_array_mut() {
        list.push(Value::Table(element));
    }
}

#[cfg(test)]
mod tests;
