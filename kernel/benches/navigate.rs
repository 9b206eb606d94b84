//! Wall-clock benchmarks of a full tick that drives to a goal (`cargo bench -p haltline --bench navigate`).
//!
//! A full tick takes in a scan and odometry, plans and has the plan judged. Read the times as ratios within one run.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Room, config, m};
use divan::{Bencher, black_box};
use haltline::Navigator;
use haltline::input::{Beam, Inputs, Motion, Reading, Scan};
use haltline::kernel::navigate::{Destination, Navigation, Planning, Route};
use haltline::time::{Duration, Instant};

type Pilot = Navigator<1, 541, 1024>;

fn main() {
    divan::main();
}

#[derive(Clone)]
struct Tick {
    pilot: Box<Pilot>,
    beams: Vec<Beam>,
    inputs: Inputs<'static>,
    ordered: Instant,
    now: Instant,
}

impl Tick {
    /// A robot that has driven for two seconds between walls at ±`half_width`, 12 m long.
    fn in_corridor(half_width: f64) -> Self {
        let mut room = Room::new((-6.0, 6.0), (-half_width, half_width), config());
        let pilot = Box::new(Pilot::new(config(), Planning::default()).unwrap());
        let mut tick = Self {
            pilot,
            beams: Vec::new(),
            inputs: Inputs::default(),
            ordered: Instant::default(),
            now: room.now(),
        };
        for number in 0..62 {
            tick.take(&room);
            tick.inputs.reset = (number == 10).then_some(tick.now);
            if number == 11 {
                tick.ordered = tick.now;
            }
            if let Motion::Twist(twist) = tick.run(number >= 11).decision.setpoint {
                room.execute(twist);
            }
        }
        assert!(room.twist.first().is_some_and(|speed| *speed > 0.5));
        tick.take(&room);
        tick.inputs.reset = None;
        tick
    }

    fn take(&mut self, room: &Room) {
        self.beams = room.beams();
        self.inputs.odometry = Reading::Value(room.odometry());
        self.now = room.now();
    }

    fn run(&mut self, drives: bool) -> Navigation {
        let scans = [Reading::Value(Scan {
            scanner: 0,
            stamp: self.now.minus(Duration::from_ms(20)),
            beams: &self.beams,
        })];
        let inputs = Inputs {
            scans: &scans,
            ..self.inputs
        };
        let route = Route {
            stamp: self.ordered,
            id: 1,
            via: &[],
            goal: Destination {
                x_um: 5_000_000,
                y_um: 200_000,
                tolerance: m(0.2),
                heading: None,
                heading_tolerance: 0,
            },
            ..Route::default()
        };
        self.pilot.step(&inputs, drives.then_some(&route), self.now)
    }
}

/// Scan, odometry and route in, decision out.
#[divan::bench(args = [1.1, 1.5, 4.0])]
fn tick(bencher: Bencher<'_, '_>, half_width_m: f64) {
    let tick = Tick::in_corridor(half_width_m);
    bencher
        .with_inputs(|| tick.clone())
        .bench_local_values(|mut tick| {
            let answer = tick.run(true);
            black_box((answer, tick))
        });
}
