//! The distilled CSV: `kind,x_m,y_m` in each line, cylinders and path points.

use super::{CYLINDER_RADIUS_M, World, path};
use crate::file::ScenarioError;

const HEADER: &str = "kind,x_m,y_m";
/// No world is larger, metres.
const FARTHEST_M: f64 = 100.0;

struct Reader<'a> {
    file: &'a str,
}

impl Reader<'_> {
    /// A complaint at a line and column, both from 1.
    fn at(&self, line: usize, column: usize, message: String) -> ScenarioError {
        ScenarioError {
            file: self.file.to_owned(),
            line,
            column,
            message,
        }
    }

    fn row<'t>(&self, line: usize, text: &'t str) -> Result<(&'t str, [f64; 2]), ScenarioError> {
        let fields: Vec<&str> = text.split(',').collect();
        let [kind, x, y] = fields.as_slice() else {
            let message = format!(
                "{} values stand here; write kind, x and y, such as `cylinder,-0.0750,0.0750`",
                fields.len()
            );
            return Err(self.at(line, 1, message));
        };
        let x_column = kind.chars().count() + 2;
        let y_column = x_column + x.chars().count() + 1;
        let x_m = self.number(line, x_column, x)?;
        let y_m = self.number(line, y_column, y)?;
        Ok((kind, [x_m, y_m]))
    }

    fn number(&self, line: usize, column: usize, text: &str) -> Result<f64, ScenarioError> {
        let number = text.trim().parse::<f64>().ok();
        number
            .filter(|value| value.abs() <= FARTHEST_M)
            .ok_or_else(|| {
                let message = format!(
                    "`{}` is no place; write metres from -{FARTHEST_M} to {FARTHEST_M}",
                    text.trim()
                );
                self.at(line, column, message)
            })
    }
}

pub(super) fn parse(text: &str, file: &str, stem: &str) -> Result<World, ScenarioError> {
    let reader = Reader { file };
    let mut lines = text
        .lines()
        .zip(1..)
        .map(|(line, number)| (number, line.trim_end()));
    match lines.next() {
        Some((_, HEADER)) => {}
        _ => {
            let message = format!("this is no world of BARN; the first line must be `{HEADER}`");
            return Err(reader.at(1, 1, message));
        }
    }
    let mut world = World {
        name: stem.to_owned(),
        cylinders_m: Vec::new(),
        path_m: Vec::new(),
    };
    let mut path_lines = Vec::new();
    for (line, text) in lines.filter(|(_, text)| !text.is_empty()) {
        let (kind, place) = reader.row(line, text)?;
        match kind.trim() {
            "cylinder" => world.cylinders_m.push(place),
            "path" => {
                world.path_m.push(place);
                path_lines.push(line);
            }
            other => {
                let message = format!("`{other}` is no kind of row; write cylinder or path");
                return Err(reader.at(line, 1, message));
            }
        }
    }
    if world.cylinders_m.is_empty() || world.path_m.is_empty() {
        let message = "a world needs at least one cylinder and one path row".to_owned();
        return Err(ScenarioError::whole(file, message));
    }
    check_frames(&reader, &world, &path_lines)?;
    Ok(world)
}

/// A path through cylinders means that the two are not in the same frame.
fn check_frames(reader: &Reader<'_>, world: &World, lines: &[usize]) -> Result<(), ScenarioError> {
    let bad = world
        .path_m
        .iter()
        .position(|point| path::clearance_m(world, *point, *point) <= 0.0);
    let Some((index, line)) = bad.and_then(|index| Some((index, *lines.get(index)?))) else {
        return Ok(());
    };
    let [x, y] = world.path_m.get(index).copied().unwrap_or_default();
    let message = format!(
        "the path runs through a cylinder (radius {CYLINDER_RADIUS_M} m) at ({x}, {y}): path and cylinders \
         are not in the same frame; export both from the same version of the benchmark"
    );
    Err(reader.at(line, 1, message))
}
