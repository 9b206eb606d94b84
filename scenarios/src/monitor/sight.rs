//! What the beams have shown of each body: when, where, and whether one has looked past that place since.

use haltline_robots::{Robot, Scanner};

use super::usable::{beam_invalid, returned, too_near};
use super::{Tick, covers};
use crate::math::{Pose, microseconds, seconds};
use crate::sensor::{RawScan, beam_time_us};

/// Returns of a body that are kept at most; more of them say nothing new.
const KEPT: usize = 50_000;

/// What is known of one body.
#[derive(Clone, Debug, Default)]
struct Seen {
    /// When the scan began in which a valid beam last returned it.
    at_s: Option<f64>,
    /// Where that scan's beams returned it, in the world, metres.
    places_m: Vec<[f64; 2]>,
    /// A later beam went through one of these places: memory may have taken the body for gone.
    passed: bool,
    /// Whether all its returns are to be kept, since the operator vouched for a place where it stands.
    vouched: bool,
    /// These returns, in the world, metres.
    returns_m: Vec<[f64; 2]>,
}

/// All bodies, as the newest scans show them.
pub(super) struct Sight {
    bodies: Vec<Seen>,
    moves: Vec<bool>,
    /// Bodies that the newest scan of each scanner returned.
    newest: Vec<Vec<usize>>,
}

/// A body at the tick that accepted the manoeuvre being executed.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    /// For how long before it was last returned; none: never.
    pub(super) age_s: Option<f64>,
    /// Whether the newest scans show it.
    pub(super) in_sight: bool,
    /// Whether a beam has looked past the place where it was returned last.
    pub(super) passed: bool,
    /// How many of its returns were kept by then.
    returns: usize,
}

impl Sight {
    pub(super) fn new(moves: &[bool], scanners: usize) -> Self {
        Self {
            bodies: vec![Seen::default(); moves.len()],
            moves: moves.to_vec(),
            newest: vec![Vec::new(); scanners],
        }
    }

    /// Keeps the returns of these bodies from now on.
    pub(super) fn vouched(&mut self, bodies: &[usize]) {
        for body in bodies {
            if let Some(seen) = self.bodies.get_mut(*body) {
                seen.vouched = true;
            }
        }
    }

    /// Takes in a usable scan.
    pub(super) fn take(&mut self, robot: &Robot, tick: &Tick<'_>, scan: &RawScan) {
        let Some(scanner) = robot.values.scanners.get(scan.scanner) else {
            return;
        };
        let view = View {
            scanner,
            tick,
            scan,
        };
        let shown: Vec<usize> = scan.bodies.iter().flatten().copied().collect();
        for (index, seen) in self.bodies.iter_mut().enumerate() {
            let can_move = self.moves.get(index).copied().unwrap_or(false);
            if !shown.contains(&index) {
                seen.passed |= can_move && seen.places_m.iter().any(|place| view.passes(*place));
                continue;
            }
            seen.at_s = Some(seconds(scan.begun_us));
            if can_move || seen.vouched {
                let places_m: Vec<[f64; 2]> = view.returns_of(index).collect();
                if seen.vouched && seen.returns_m.len() < KEPT {
                    seen.returns_m.extend(&places_m);
                }
                (seen.places_m, seen.passed) = (places_m, false);
            }
        }
        if let Some(newest) = self.newest.get_mut(scan.scanner) {
            *newest = shown;
        }
    }

    /// What is known of each body at `t_s`.
    pub(super) fn known(&self, t_s: f64) -> Vec<Known> {
        let known = self.bodies.iter().enumerate().map(|(index, seen)| Known {
            age_s: seen.at_s.map(|at_s| t_s - at_s),
            in_sight: self.newest.iter().any(|shown| shown.contains(&index)),
            passed: seen.passed,
            returns: seen.returns_m.len(),
        });
        known.collect()
    }

    /// Whether the part of a body that the robot touches had been returned since the operator vouched for its place.
    pub(super) fn shown(&self, robot: &Robot, body: usize, known: &Known, pose: &Pose) -> bool {
        let Some(seen) = self.bodies.get(body) else {
            return false;
        };
        let mut returns = seen.returns_m.iter().take(known.returns);
        returns.any(|place| covers(robot, pose.apply_inverse(*place), 0.0))
    }
}

/// A scan and where it was taken.
struct View<'a> {
    scanner: &'a Scanner,
    tick: &'a Tick<'a>,
    scan: &'a RawScan,
}

impl View<'_> {
    /// Pose of the scanner when it measured a beam, looking along it.
    fn along(&self, beam: usize) -> Pose {
        let (scanner, scan) = (self.scanner, self.scan);
        let sweep_us = microseconds(scanner.scan_time_s);
        let at_us = beam_time_us(scan.begun_us, sweep_us, beam, scan.ranges_m.len());
        let heading = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
        let mount = Pose::new(scanner.x_m, scanner.y_m, heading);
        (self.tick.pose_at)(at_us).then(mount)
    }

    fn returns_of(&self, body: usize) -> impl Iterator<Item = [f64; 2]> {
        let beams = self.scan.ranges_m.iter().zip(&self.scan.bodies).enumerate();
        beams.filter_map(move |(beam, (range, shown))| {
            let range_m = returned(self.scanner, *range).filter(|_| *shown == Some(body))?;
            Some(self.along(beam).apply([range_m, 0.0]))
        })
    }

    /// Whether a beam went through a place and came back from beyond it, or validly from nowhere.
    fn passes(&self, place: [f64; 2]) -> bool {
        let count = self.scan.ranges_m.len();
        // Which beam it is depends on when that was measured: begin with the middle one.
        let mut beam = count / 2;
        for _ in 0..3 {
            let [ahead, left] = self.along(beam).apply_inverse(place);
            let off = libm::atan2(left, ahead) / self.scanner.increment_rad();
            let next = beam as f64 + off.round();
            if next < 0.0 || next >= count as f64 {
                return false;
            }
            beam = next as usize;
        }
        let Some(range) = self.scan.ranges_m.get(beam) else {
            return false;
        };
        if too_near(self.scanner, *range) {
            return false;
        }
        let [ahead, _] = self.along(beam).apply_inverse(place);
        match returned(self.scanner, *range) {
            Some(range_m) => range_m > ahead,
            None => !beam_invalid(self.scanner, *range) && ahead < self.scanner.no_return_clear_m,
        }
    }
}
