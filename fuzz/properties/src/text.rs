//! Text parsers: what they take they understood, what they refuse they name by line; and texts worth trying.

use crate::{Judged, Property, demand};
use haltline_pilots::marker_map::{self, HEADER, MapEntry, MapError};
use haltline_scenarios::barn::{Options, World};
use haltline_scenarios::file::{self, ScenarioError};
use haltline_spec::draw::Draw;

/// Whether a refusal points into the text and says something.
pub fn points_into(text: &str, line: usize, message: &str) -> Result<(), String> {
    let last = text.lines().count() + 1;
    demand(line <= last && !message.trim().is_empty(), || {
        format!("line {line} of {last}: `{message}`")
    })
}

const ODD: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "1e400",
    "-1",
    "0",
    "-0.0",
    "1e-320",
    "65536",
    "4294967296",
    "18446744073709551616",
    "0x10",
    "1_000",
    "",
    " ",
    ",",
    "\"",
    "[",
    "]",
    "=",
    "#",
    "\u{feff}",
    "\r\n",
    "ä",
];

/// A text with a few things wrong with it, often none.
pub fn spoiled(draw: &mut Draw, text: &str) -> Vec<u8> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..draw.index(4) {
        let (at, other) = (draw.index(lines.len()), draw.index(lines.len()));
        match draw.index(7) {
            0 if lines.len() > 1 => {
                lines.remove(at);
            }
            1 => lines.insert(at, lines[other].clone()),
            2 => lines.swap(at, other),
            3 => lines[at] = swapped(draw, &lines[at]),
            4 => {
                let kept = draw.index(lines[at].len() + 1);
                lines[at] = lines[at].chars().take(kept).collect();
            }
            _ => lines[at] = other_number(draw, &lines[at]),
        }
    }
    let mut bytes = lines.join("\n").into_bytes();
    if draw.chance(0.1) {
        let at = draw.index(bytes.len());
        bytes.truncate(at);
    } else if draw.chance(0.8) {
        bytes.push(b'\n');
    }
    bytes
}

/// A word replaced by an odd one.
fn swapped(draw: &mut Draw, line: &str) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    let at = draw.index(words.len());
    words[at] = ODD[draw.index(ODD.len())];
    words.join(" ")
}

/// A number changed to one of another size.
fn other_number(draw: &mut Draw, line: &str) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let starts: Vec<usize> = line
        .char_indices()
        .filter(|(at, c)| c.is_ascii_digit() && !line[..*at].ends_with(is_part))
        .map(|(at, _)| at)
        .collect();
    let Some(&start) = starts.get(draw.index(starts.len())) else {
        return line.to_owned();
    };
    let tail = &line[start..];
    let end = start + tail.find(|c| !is_part(c)).unwrap_or(tail.len());
    let new = if draw.chance(0.3) {
        ODD[draw.index(ODD.len())].to_owned()
    } else {
        let size = 10_f64.powi(draw.index(7) as i32 - 3);
        format!("{:.4}", draw.between(-1.0, 1.0) * size)
    };
    format!("{}{new}{}", &line[..start], &line[end..])
}

/// The text that some bytes stand for, if they are one.
pub fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}

/// Lines with anything but comments on them.
pub fn filled(text: &str) -> usize {
    let bare = |line: &str| !line.trim().is_empty() && !line.trim().starts_with('#');
    text.lines().filter(|line| bare(line)).count()
}

pub const MARKER_MAP: Property = Property {
    name: "marker_map",
    judge: |bytes| map(bytes, marker_map::parse),
    twins: &[
        ("a line lost", |bytes| {
            map(bytes, |text| {
                let mut entries = marker_map::parse(text)?;
                entries.pop();
                Ok(entries)
            })
        }),
        ("degrees for radians", |bytes| {
            map(bytes, |text| {
                let mut entries = marker_map::parse(text)?;
                for entry in &mut entries {
                    entry.pose.heading_rad = entry.pose.heading_rad.to_degrees();
                }
                Ok(entries)
            })
        }),
    ],
    draw: |draw| {
        spoiled(
            draw,
            "id,x_m,y_m,heading_deg\n# west\n0,1.5,-2,-90\n7,0,1e1,180\n1023, 3.25, 4, 0\n12,-7,8,33.5",
        )
    },
    cases: 8000,
};

type ParseMap = fn(&str) -> Result<Vec<MapEntry>, MapError>;

fn map(bytes: &[u8], parse: ParseMap) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let entries = match parse(text) {
        Ok(entries) => entries,
        Err(error) => return points_into(text, error.line, &error.message).map(|()| 0),
    };
    let plain = text.trim_start_matches('\u{feff}');
    let first = plain.lines().map(str::trim).find(|line| filled(line) > 0);
    let header = first.is_some_and(|line| line.replace(' ', "") == HEADER);
    let lines = filled(plain) - usize::from(header);
    demand(entries.len() == lines, || {
        format!("{lines} lines, {} entries", entries.len())
    })?;
    for (index, entry) in entries.iter().enumerate() {
        let twice = entries[..index].iter().any(|other| other.id == entry.id);
        let turn = entry.pose.heading_rad.abs() <= std::f64::consts::TAU + 1e-9;
        let near = entry.pose.x_m.abs() <= 1e6 && entry.pose.y_m.abs() <= 1e6;
        demand(!twice && entry.id < 1024 && turn && near, || {
            format!("took {entry:?}")
        })?;
    }
    let again = parse(&marker_map::write(&entries));
    demand(
        again.is_ok_and(|again| again.len() == entries.len()),
        || "cannot be read back".to_owned(),
    )?;
    Ok(entries.len())
}

pub const BARN: Property = Property {
    name: "barn",
    judge: |bytes| world(bytes, World::parse),
    twins: &[
        ("a cylinder lost", |bytes| {
            world(bytes, |text, file, stem| {
                let mut world = World::parse(text, file, stem)?;
                world.cylinders_m.pop();
                Ok(world)
            })
        }),
        ("a place that is none", |bytes| {
            world(bytes, |text, file, stem| {
                let mut world = World::parse(text, file, stem)?;
                world.path_m[0][0] = f64::NAN;
                Ok(world)
            })
        }),
    ],
    draw: |draw| {
        spoiled(
            draw,
            "kind,x_m,y_m\ncylinder,-2.6,5\ncylinder,-1.4,5\ncylinder,-2.6,6.5\ncylinder,-1.4,6.5\n\
             path,-2,4\npath,-2,5\npath,-1.95,6.5\npath,-2,12",
        )
    },
    cases: 5000,
};

type ParseWorld = fn(&str, &str, &str) -> Result<World, ScenarioError>;

fn world(bytes: &[u8], parse: ParseWorld) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let world = match parse(text, "w.csv", "world_7") {
        Ok(world) => world,
        Err(error) => return points_into(text, error.line, &error.message).map(|()| 0),
    };
    let lines = text
        .lines()
        .filter(|line| !line.trim_end().is_empty())
        .count()
        - 1;
    let rows = world.cylinders_m.len() + world.path_m.len();
    demand(rows == lines, || format!("{lines} rows, took {rows}"))?;
    let places = world.cylinders_m.iter().chain(&world.path_m).flatten();
    demand(places.clone().all(|at| at.abs() <= 100.0), || {
        format!("{world:?}")
    })?;
    demand(world.optimal_time_s().is_finite(), || format!("{world:?}"))?;
    let scenario = world.scenario_text(&Options::default());
    let read = file::parse(&scenario, "w.toml", "world_7");
    demand(read.as_ref().is_ok_and(|all| all.len() == 1), || {
        let why = read.err().map(|error| error.to_string());
        format!("its scenario is refused: {why:?}\n{scenario}")
    })?;
    Ok(rows)
}
