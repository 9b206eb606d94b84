//! Every door of the kernel as a C symbol, linked one by one to see whether a panic is reachable.
//!
//! The panic handler calls a function that does not exist: an image that links
//! contains no reachable panic. There is no allocator, so an image that builds
//! does not allocate either.
#![no_std]

use haltline::config::{Config, Scanner};
use haltline::convert::{self, BeamEncoding};
use haltline::decision::Decision;
use haltline::guard::hull::Hull;
use haltline::guard::tube::{Tube, TubeParameters};
use haltline::input::{Beam, Command, Inputs, Odometry, Pose, Reading, Scan};
use haltline::kernel::navigate::{Localiser, Navigation, Planning, Route};
use haltline::marker::{
    FilterRules, Frame, FrameReport, Increment, MarkerEkf, MarkerFilter, Pose2, Prediction,
};
use haltline::stop::{StopEvents, StopState, StopTimes};
use haltline::time::Instant;
use haltline::units::Length;

/// The capacities of the shipped command line tool.
type Kernel = haltline::Kernel<4, 1100, 1024>;
type Navigator = haltline::Navigator<4, 1100, 1024>;
type Grid = haltline::grid::RollingGrid<160, 160>;
type Filter = MarkerEkf<20, 1024>;

unsafe extern "C" {
    fn __panic_reached() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: the symbol does not exist; code that needs it does not link.
    unsafe { __panic_reached() }
}

/// Kernel::new.
#[unsafe(no_mangle)]
pub extern "C" fn image_new(config: &Config<4>, out: &mut Option<Kernel>) -> bool {
    *out = Kernel::new(*config).ok();
    out.is_some()
}

/// Kernel::step with one scan.
#[unsafe(no_mangle)]
#[allow(improper_ctypes_definitions)]
pub extern "C" fn image_step(
    kernel: &mut Kernel,
    scan: &Reading<Scan<'_>>,
    odometry: &Reading<Odometry>,
    command: &Reading<Command>,
    flags: u32,
    now: u64,
    out: &mut Decision,
) {
    let scans = [*scan];
    let inputs = Inputs {
        scans: &scans,
        odometry: *odometry,
        command: *command,
        emergency_stop: flags & 1 != 0,
        reset: (flags & 2 != 0).then(|| Instant::from_us(now)),
    };
    *out = kernel.step(&inputs, Instant::from_us(now));
}

/// Navigator::new.
#[unsafe(no_mangle)]
pub extern "C" fn image_navigator(
    config: &Config<4>,
    planning: &Planning,
    out: &mut Option<Navigator>,
) -> bool {
    *out = Navigator::new(*config, *planning).ok();
    out.is_some()
}

/// Navigator::step with one scan and a route: planner and guard.
#[unsafe(no_mangle)]
#[allow(improper_ctypes_definitions)]
pub extern "C" fn image_navigate(
    navigator: &mut Navigator,
    scan: &Reading<Scan<'_>>,
    odometry: &Reading<Odometry>,
    route: &Route<'_>,
    flags: u32,
    now: u64,
    out: &mut Navigation,
) {
    let scans = [*scan];
    let inputs = Inputs {
        scans: &scans,
        odometry: *odometry,
        emergency_stop: flags & 1 != 0,
        reset: (flags & 2 != 0).then(|| Instant::from_us(now)),
        ..Inputs::default()
    };
    let route = (flags & 4 != 0).then_some(route);
    *out = navigator.step(&inputs, route, Instant::from_us(now));
}

/// RollingGrid::update.
#[unsafe(no_mangle)]
#[allow(improper_ctypes_definitions)]
pub extern "C" fn image_grid(
    grid: &mut Grid,
    pose: &Pose,
    scanner: &Scanner,
    beams: &&[Beam],
) -> bool {
    grid.update(pose, scanner, beams).is_ok()
}

/// MarkerEkf::new.
#[unsafe(no_mangle)]
pub extern "C" fn image_filter(
    rules: &FilterRules,
    start: &Pose2,
    variances: &[f64; 3],
    out: &mut Option<Filter>,
) -> bool {
    *out = Filter::new(*rules, *start, *variances).ok();
    out.is_some()
}

/// MarkerEkf::predict.
#[unsafe(no_mangle)]
pub extern "C" fn image_predict(
    filter: &mut Filter,
    increment: &Increment,
    now: u64,
    out: &mut Prediction,
) {
    *out = filter.predict(Instant::from_us(now), increment);
}

/// MarkerEkf::correct.
#[unsafe(no_mangle)]
#[allow(improper_ctypes_definitions)]
pub extern "C" fn image_correct(filter: &mut Filter, frame: &Frame<'_>, out: &mut FrameReport) {
    *out = filter.correct(frame);
}

/// Localiser: odometry, a frame, and where the odometry frame lies.
#[unsafe(no_mangle)]
#[allow(improper_ctypes_definitions)]
pub extern "C" fn image_localise(
    localiser: &mut Localiser<Filter>,
    odometry: &Odometry,
    frame: &Frame<'_>,
    out: &mut Option<Pose>,
) -> bool {
    let done = localiser.odometry(odometry) == Prediction::Done;
    let _ = localiser.frame(frame);
    *out = localiser.odometry_frame(odometry.stamp);
    done
}

/// Tube::new.
#[unsafe(no_mangle)]
pub extern "C" fn image_tube(parameters: &TubeParameters, hull: &Hull, reaction_us: u64) -> usize {
    Tube::new(parameters, hull, reaction_us).map_or(0, |tube| tube.samples().len())
}

/// stop::next.
#[unsafe(no_mangle)]
pub extern "C" fn image_stop(state: &mut StopState, events: &StopEvents, times: &StopTimes) {
    *state = haltline::stop::next(*state, events, *times);
}

/// The float conversions.
#[unsafe(no_mangle)]
pub extern "C" fn image_convert(
    values: &[f64; 6],
    stamp: u64,
    odometry: &mut Reading<Odometry>,
    command: &mut Reading<Command>,
) {
    let [x, y, theta, v, w, k] = *values;
    let stamp = Instant::from_us(stamp);
    *odometry = convert::odometry(stamp, [x, y, theta], [v, w], Some(k));
    *command = if k > 0.0 {
        convert::twist_command(stamp, v, w)
    } else {
        convert::arc_command(stamp, v, k)
    };
}

/// Decoding a beam.
#[unsafe(no_mangle)]
pub extern "C" fn image_beam(range_m: f32, encoding: u8, min: i32, max: i32, out: &mut Beam) {
    let encoding = match encoding {
        0 => BeamEncoding::Rep117,
        1 => BeamEncoding::ZeroIsNone,
        _ => BeamEncoding::ZeroIsInvalid,
    };
    *out = convert::beam(
        range_m,
        encoding,
        Length::from_um(min),
        Length::from_um(max),
    );
}

/// The negative control: an index that may be out of range.
#[cfg(feature = "planted-panic")]
#[unsafe(no_mangle)]
pub extern "C" fn image_planted(values: &[u8; 4], index: usize) -> u8 {
    values[index]
}
