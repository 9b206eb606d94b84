//! The scenes that both benchmark programs measure.

use crate::common;
use haltline::checked::KernelConfig;
use haltline::config::Config;
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::memory::{Arrival, Memory};
use haltline::guard::{Scene, Verdict, certify};
use haltline::input::{Beam, Inputs, Reading, Scan, Twist};
use haltline::odometry::{LocalPose, Odometer};
use haltline::time::Instant;
use haltline::units::{AngularSpeed, Curvature, Speed};

type Known = Memory<1, 541, 1000>;

/// A motion to be judged against a filled memory.
pub struct Setup {
    config: KernelConfig<1>,
    memory: Box<Known>,
    hull: Hull,
}

/// Ranges of a scan by beam, millimetres; zero is an unusable beam.
fn beams(mut range: impl FnMut(usize) -> u16) -> Vec<Beam> {
    (0..541)
        .map(|beam| match range(beam) {
            0 => Beam::Invalid,
            range => Beam::Hit(range),
        })
        .collect()
}

/// A corridor 3 m wide with some unevenness.
fn corridor(beam: usize) -> u16 {
    let bearing = (beam as f64 * 0.5 - 135.0).to_radians();
    let range = (1.5 / bearing.sin().abs().max(0.1)).min(15.0);
    (range * 1000.0) as u16 + (beam % 7) as u16
}

/// Points beside a left turn: inside the tube's bounding box, outside the tube.
fn inner_corner(beam: usize, layer: usize) -> u16 {
    let bearing = (beam as f64 * 0.5 - 135.0).to_radians();
    if !(0.15..2.0).contains(&bearing) || layer > 13 {
        return 0;
    }
    // Beside the turning robot's left side; each layer lies before the last, so that it
    // occludes instead of confirming or refuting it.
    let offset = 0.95 - 0.025 * layer as f64;
    match offset / bearing.sin() {
        range if range < 1.6 => (range * 1000.0) as u16,
        _ => 0,
    }
}

impl Setup {
    /// `typical`: a corridor, 1000 points remembered beyond its walls. `crowded`: every
    /// point near the tube of a sharp turn.
    pub fn named(name: &str) -> Self {
        if name == "crowded" {
            Self::new(common::config(), 1000, true)
        } else {
            Self::remembering(1000)
        }
    }

    /// The corridor with `count` remembered points.
    pub fn remembering(count: usize) -> Self {
        Self::new(common::config(), count, false)
    }

    fn new(config: Config<1>, count: usize, crowded: bool) -> Self {
        let config = KernelConfig::new(config, 541).unwrap();
        let mut memory: Box<Known> = Box::default();
        let mut layer = 0;
        while memory.remembered().len() < count && layer < 14 {
            let wanted = count - memory.remembered().len();
            let mut left = wanted;
            let mut take = |range: u16| {
                let room = left > 0 && range > 0;
                left -= usize::from(room);
                if room { range } else { 0 }
            };
            let hits = beams(|beam| match crowded {
                true => take(inner_corner(beam, layer)),
                false if beam < wanted => 3_000 - 40 * layer as u16,
                false => 0,
            });
            accept(&mut memory, &config, &hits, 2 * layer as u64);
            // Blind scans confirm and refute nothing: everything is remembered.
            accept(&mut memory, &config, &beams(|_| 0), 2 * layer as u64 + 1);
            layer += 1;
        }
        let last = beams(|beam| match crowded {
            true => inner_corner(beam, 13),
            false => corridor(beam),
        });
        accept(&mut memory, &config, &last, 1_000);
        // The last scan may confirm a few of them.
        assert!(memory.remembered().len() * 100 >= count * 95);
        let mut setup = Self {
            config,
            memory,
            hull: hull(if crowded {
                (500_000, 700_000)
            } else {
                (600_000, 60_000)
            }),
        };
        setup.memory.seen.mark(&[u128::MAX; 128]);
        setup.refresh();
        setup
    }

    /// Brings all points to the newest pose.
    pub fn refresh(&mut self) {
        let now = Instant::from_us(1_020_000);
        self.memory.refresh(
            self.config.memory(),
            LocalPose::default(),
            now,
            Odometer::default(),
        );
    }

    /// Judges the motion.
    pub fn certify(&self) -> Verdict {
        let scene = Scene {
            memory: &*self.memory,
            model: self.config.memory(),
            pose: LocalPose::default(),
            stamp: Instant::from_us(1_020_000),
            odometer: Odometer::default(),
            excuse: None,
        };
        certify(self.config.tube(), &self.hull, 142_000, &scene)
    }
}

/// One tick waiting to be run.
pub struct Tick {
    room: Box<common::Room>,
    beams: Vec<Beam>,
}

impl Tick {
    /// A robot that drives along a corridor.
    pub fn corridor() -> Self {
        let mut room = common::Room::new((-6.0, 6.0), (-1.5, 1.5), common::config());
        let _ = room.start();
        for _ in 0..40 {
            let _ = room.tick(Some((0.6, 0.06)), false);
        }
        Self {
            beams: room.beams(),
            room: Box::new(room),
        }
    }

    /// Rings of returns that close in on a driving robot: each hides the one before, so that
    /// the store fills up, and the last lies within the tube's bounding box.
    pub fn closing_in() -> Self {
        let Self { mut room, .. } = Self::corridor();
        for ring in [2_400, 1_900, 1_500] {
            let beams = beams(|beam| ring + (beam % 5) as u16);
            let now = room.now();
            let scans = [Reading::Value(Scan {
                scanner: 0,
                stamp: Instant::from_us(room.now_us - 20_000),
                beams: &beams,
            })];
            let inputs = Inputs {
                scans: &scans,
                odometry: Reading::Value(room.odometry()),
                command: room.command(0.6, 0.5),
                emergency_stop: false,
                reset: None,
            };
            let _ = room.step(&inputs);
            assert!(room.now() > now);
        }
        assert!(room.kernel.memory().remembered().len() > 900);
        Self {
            beams: beams(|beam| 1_100 + (beam % 5) as u16),
            room,
        }
    }

    /// Runs it.
    pub fn run(mut self) -> haltline::decision::Decision {
        let scans = [Reading::Value(Scan {
            scanner: 0,
            stamp: Instant::from_us(self.room.now_us - 20_000),
            beams: &self.beams,
        })];
        let inputs = Inputs {
            scans: &scans,
            odometry: Reading::Value(self.room.odometry()),
            command: self.room.command(0.6, 0.06),
            emergency_stop: false,
            reset: None,
        };
        let now = self.room.now();
        self.room.kernel.step(&inputs, now)
    }
}

fn accept(memory: &mut Known, config: &KernelConfig<1>, beams: &[Beam], tick: u64) {
    let scanner = common::scanner();
    let arrival = Arrival {
        scanner: 0,
        setup: &scanner,
        beams,
        stamp: Instant::from_us(1_000 * tick),
        poses: (LocalPose::default(), LocalPose::default()),
    };
    memory.accept(config.memory(), arrival, Odometer::default());
}

fn hull((v, w): (i32, i32)) -> Hull {
    let mut hull = Hull::default();
    for percent in [90, 95, 100] {
        hull.push(Vertex {
            twist: Twist {
                linear: Speed::from_um_per_s(v / 100 * percent),
                angular: AngularSpeed::from_urad_per_s(w / 100 * percent),
            },
            curvature: Curvature::ZERO,
        });
    }
    hull
}
