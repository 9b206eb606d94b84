//! Sightings that are wrong in the ways that cameras get markers wrong.

use super::camera::SightErrors;
use super::chance::Chance;
use super::places::Marker;
use crate::math::{Pose, wrap};
use haltline::marker::Sighting;

/// What a sighting really is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Label {
    /// As good as its noise says.
    Good,
    /// 1 to 2 m off.
    Displaced,
    /// Turned by 117°, what an ambiguous square does.
    Flipped,
    /// Another marker's id was read.
    WrongId,
    /// A thing that is no marker shows the id of one in sight.
    Duplicate,
}

/// How often sightings go wrong, each a probability per good sighting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outliers {
    /// [`Label::Displaced`].
    pub displaced: f64,
    /// [`Label::Flipped`].
    pub flipped: f64,
    /// [`Label::WrongId`].
    pub wrong_id: f64,
    /// [`Label::Duplicate`]: one more sighting beside the good one.
    pub duplicate: f64,
}

/// The turn of an ambiguous pose, rad.
const FLIP_RAD: f64 = 2.042_035_224_833_366;

impl Outliers {
    /// What the camera reports of one detected marker.
    pub fn report(
        &self,
        robot: &Pose,
        marker: &Marker,
        all: &[Marker],
        errors: &SightErrors,
        chance: &mut Chance,
    ) -> Vec<(Sighting, Label)> {
        let good = errors.sighting(robot, marker, chance);
        let die = chance.unit();
        let [displaced, flipped, wrong_id, duplicate] =
            [self.displaced, self.flipped, self.wrong_id, self.duplicate];
        if die < displaced {
            vec![(displace(good, chance), Label::Displaced)]
        } else if die < displaced + flipped {
            let turn = if chance.unit() < 0.5 {
                FLIP_RAD
            } else {
                -FLIP_RAD
            };
            let heading_rad = good.heading_rad.map(|heading| wrap(heading + turn));
            let flipped = Sighting {
                heading_rad,
                ..good
            };
            vec![(flipped, Label::Flipped)]
        } else if die < displaced + flipped + wrong_id {
            let others: Vec<u16> = all
                .iter()
                .map(|m| m.id)
                .filter(|id| *id != marker.id)
                .collect();
            // One in four reads an id that does not hang anywhere.
            let id = match others.get(chance.index(others.len())) {
                Some(id) if chance.unit() < 0.75 => *id,
                _ => 900 + marker.id % 100,
            };
            vec![(Sighting { id, ..good }, Label::WrongId)]
        } else if die < displaced + flipped + wrong_id + duplicate {
            let twin = displace(good, chance);
            vec![(twin, Label::Duplicate), (good, Label::Good)]
        } else {
            vec![(good, Label::Good)]
        }
    }
}

fn displace(good: Sighting, chance: &mut Chance) -> Sighting {
    let (away, direction) = (
        chance.between(1.0, 2.0),
        chance.between(0.0, core::f64::consts::TAU),
    );
    Sighting {
        x_m: good.x_m + away * libm::cos(direction),
        y_m: good.y_m + away * libm::sin(direction),
        ..good
    }
}
