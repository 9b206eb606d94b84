//! The chosen faults: each margin, sign, comparison and rule that somebody may get wrong.

use super::Fault;

/// A fault in a file of the kernel, and a part of the name of the proof that must catch it.
const fn fault(
    file: &'static str,
    from: &'static str,
    to: &'static str,
    check: &'static str,
) -> Fault {
    Fault {
        file,
        from,
        to,
        check,
    }
}

/// Chosen by hand.
pub(super) const CHOSEN: [Fault; 58] = [
    fault(
        "geometry/rect.rs",
        "point.x <= self.front",
        "point.x < self.front",
        "rect::a_point_inside",
    ),
    fault(
        "geometry/rect.rs",
        "front: self.front.saturating_add(margin)",
        "front: self.front.saturating_sub(margin)",
        "rect::a_larger_margin",
    ),
    fault(
        "geometry/rect.rs",
        "if self.contains(a) || self.contains(b) {\n            return true;",
        "if self.contains(a) || self.contains(b) {\n            return false;",
        "shapes::segment_touches",
    ),
    fault(
        "geometry/rect.rs",
        "corners.iter().all(|&area| area > 0)",
        "corners.iter().all(|&area| area >= 0)",
        "shapes::segment_touches",
    ),
    fault(
        "geometry/frame.rs",
        "product.saturating_add(1 << 29) >> 30",
        "product >> 30",
        "geometry::products",
    ),
    fault(
        "geometry/frame.rs",
        "cos: cos.saturating_add(1 << 14) >> 15",
        "cos: cos >> 14",
        "angles::rotation_fits",
    ),
    fault(
        "geometry/trig.rs",
        "magnitude.saturating_neg()\n",
        "magnitude\n",
        "angles::sine",
    ),
    fault(
        "arith.rs",
        "Some(_) => quotient.saturating_add(1)",
        "Some(_) => quotient",
        "braking::division",
    ),
    fault(
        "arith.rs",
        "root.saturating_add(1)",
        "root",
        "braking::root",
    ),
    fault(
        "time.rs",
        "match self.0.checked_sub(earlier.0) {",
        "match Some(self.0.wrapping_sub(earlier.0)) {",
        "watch::time_never",
    ),
    fault(
        "watch.rs",
        "is_none_or(|age| age > age_max)",
        "is_none_or(|age| age < age_max)",
        "watch::old_and_future",
    ),
    fault(
        "watch.rs",
        "now.since(stamp).is_none_or(",
        "now.since(stamp).is_some_and(",
        "watch::old_and_future",
    ),
    fault(
        "watch.rs",
        "if stamp < newest => Order::Older",
        "if stamp > newest => Order::Older",
        "watch::only_a_later",
    ),
    fault(
        "stop/mod.rs",
        "            mode: Mode::Latched,\n            since: events.now,",
        "            mode: Mode::Protective,\n            since: events.now,",
        "stop::a_pulled_line",
    ),
    fault(
        "stop/mod.rs",
        "fresh && newer && events.at_rest",
        "fresh && newer",
        "stop::a_latch_holds",
    ),
    fault(
        "stop/mod.rs",
        "stamp > state.since",
        "stamp >= state.since",
        "stop::a_latch_holds",
    ),
    fault(
        "stop/mod.rs",
        "        released: now,",
        "        released: Instant::from_us(0),",
        "stop::a_release",
    ),
    fault(
        "stop/mod.rs",
        "clear >= times.clear",
        "clear <= times.clear",
        "stop::a_protective",
    ),
    fault(
        "window.rs",
        "v <= limits.speed_forward.as_um_per_s()",
        "true",
        "window::admissible_lies",
    ),
    fault(
        "window.rs",
        "if v < 0 && limits.speed_reverse == Speed::ZERO",
        "if v > 0 && limits.speed_reverse == Speed::ZERO",
        "window::reverse",
    ),
    fault(
        "guard/memory/mod.rs",
        "Sight::Unclear => Some(0)",
        "Sight::Unclear => Some(misses)",
        "memory::a_point_goes",
    ),
    fault(
        "guard/memory/mod.rs",
        "Some(misses.saturating_add(1)).filter",
        "Some(misses.saturating_add(2)).filter",
        "memory::a_point_goes",
    ),
    fault(
        "guard/seen.rs",
        "let forgotten = age >= age_max.as_us();",
        "let forgotten = age > age_max.as_us();",
        "seen::old_space",
    ),
    fault(
        "guard/hull.rs",
        "None => self.overflow = true",
        "None => self.overflow = false",
        "hull::an_incomplete",
    ),
    fault(
        "guard/hull.rs",
        "let below = low.saturating_add(1).saturating_sub(w);",
        "let below = low.saturating_sub(w).saturating_sub(9);",
        "braking::hull_residual",
    ),
    fault(
        "guard/plan.rs",
        "path: mul_micro_up(speed, add(reaction, stop.div_ceil(2))),",
        "path: mul_micro_up(speed, stop.div_ceil(2)),",
        "braking::stopping",
    ),
    fault(
        "guard/plan.rs",
        "mul_micro_up(self.turn_tolerance, self.latest),",
        "0,",
        "tube::every_term",
    ),
    fault(
        "guard/plan.rs",
        "curvature_spread: bend_difference(interval, nominal),",
        "curvature_spread: 0,",
        "tube::every_term",
    ),
    fault(
        "guard/plan.rs",
        "add(root, offset)",
        "root",
        "tube::every_term",
    ),
    fault(
        "guard/tube.rs",
        "let moving = mul_micro_up(parameters.obstacle_speed, latest);",
        "let moving = 0;",
        "tube::every_term",
    ),
    fault(
        "guard/tube.rs",
        "[moving, rounding, self.tracking_um, self.sampling_um]",
        "[moving, rounding, self.sampling_um]",
        "tube::every_term",
    ),
    fault(
        "guard/tube.rs",
        "[moving, rounding, self.tracking_um, self.sampling_um]",
        "[moving, rounding, self.tracking_um]",
        "tube::every_term",
    ),
    fault(
        "guard/tube.rs",
        "const ROUNDING_UM: u64 = 3_000;",
        "const ROUNDING_UM: u64 = 2_000;",
        "tube::every_term",
    ),
    fault(
        "guard/check.rs",
        "let extra = point.extra_mm.max(start.extra_mm);",
        "let extra = point.extra_mm.min(start.extra_mm);",
        "guard::a_point_before",
    ),
    fault(
        "geometry/frame.rs",
        "            || offset.y.unsigned_abs() > VIEW_MM",
        "            && offset.y.unsigned_abs() > VIEW_MM",
        "geometry::far_points",
    ),
    fault(
        "units.rs",
        "self.0.wrapping_sub(other.0)",
        "other.0.wrapping_sub(self.0)",
        "geometry::angles_wrap",
    ),
    fault(
        "odometry.rs",
        ".saturating_mul(6_283_186)",
        ".saturating_mul(6_283_184)",
        "angles::turns",
    ),
    fault(
        "guard/tube.rs",
        ".saturating_mul(341_782_638)",
        ".saturating_mul(341_782_000)",
        "angles::half_turn",
    ),
    fault(
        "geometry/trig.rs",
        "(1_u32 << 31).wrapping_sub(quadrant)",
        "(1_u32 << 30).wrapping_sub(quadrant)",
        "angles::bearing",
    ),
    fault(
        "convert.rs",
        "if !(value > -EXACT && value < EXACT) {",
        "if value <= -EXACT {",
        "convert::rounding",
    ),
    fault(
        "convert.rs",
        "Round::Up if back < shifted",
        "Round::Up if back > shifted",
        "convert::rounding",
    ),
    fault(
        "convert.rs",
        "um < i64::from(range_min.as_um())",
        "um > i64::from(range_min.as_um())",
        "convert::every_range",
    ),
    fault(
        "kernel/ingest.rs",
        "watch::is_stale(newest.stamp, now, timing.odometry_age_max),",
        "false,",
        "kernel::every",
    ),
    fault(
        "kernel/ingest.rs",
        "Order::Future => return hazard.add(Reason::OdometryFuture),",
        "Order::Future => return,",
        "kernel::every",
    ),
    fault(
        "kernel/mod.rs",
        "elapsed > timing.period.plus(timing.jitter),",
        "false,",
        "kernel::every",
    ),
    fault(
        "kernel/motion.rs",
        "if command.stamp <= self.stop.released {",
        "if false {",
        "kernel::every",
    ),
    fault(
        "kernel/ingest.rs",
        "Order::Newer if ends > now =>",
        "Order::Newer if scan.stamp > now =>",
        "test -p haltline-spec --release --test tick",
    ),
    fault(
        "kernel/motion.rs",
        "for sent in self.pipeline.since(since) {",
        "for sent in self.pipeline.since(since).take(0) {",
        "test -p haltline-spec --release --test guard",
    ),
    fault(
        "guard/memory/cloud.rs",
        "            .saturating_add(u64::from(gap_mm));",
        "            .saturating_add(u64::from(gap_mm) * 0);",
        "test -p haltline --lib guard::memory",
    ),
    fault(
        "pipeline.rs",
        "self.stopped.is_none_or(stood)",
        "(self.stopped.is_none_or(stood) || true)",
        "test -p haltline-spec --release --test door",
    ),
    // Small changes of shard 1/35 (`mutants`) that no test had noticed.
    fault(
        "checked.rs",
        "if beams < 2\n",
        "if beams <= 2\n",
        "test -p haltline-spec --release --test configurations",
    ),
    fault(
        "guard/mod.rs",
        "    let tube = Tube::new(parameters, hull, reaction_us).ok()?;\n    let nearest",
        "    return None;\n    let tube = Tube::new(parameters, hull, reaction_us).ok()?;\n    let nearest",
        "test -p haltline-spec --release --test memory beside",
    ),
    fault(
        "odometry.rs",
        "(later.stamp == time).then",
        "(later.stamp != time).then",
        "test -p haltline --release --test edges",
    ),
    fault(
        "geometry/frame.rs",
        "offset.x.unsigned_abs() > VIEW_MM.unsigned_abs()",
        "offset.x.unsigned_abs() == VIEW_MM.unsigned_abs()",
        "test -p haltline --release --test edges",
    ),
    fault(
        "guard/plan.rs",
        "            constant_spread: mul_micro_up(speed, latest),\n",
        "",
        "test -p haltline --release --test edges",
    ),
    fault(
        "guard/seen.rs",
        "(FOLLOW_CELLS + 1) * CELL_MM",
        "(FOLLOW_CELLS - 1) * CELL_MM",
        "test -p haltline --release --test edges",
    ),
    // Two of these again: the attacker must find them without being told where to look.
    fault(
        "kernel/motion.rs",
        "for sent in self.pipeline.since(since) {",
        "for sent in self.pipeline.since(since).take(0) {",
        "test --release -p haltline-attack --test finds commands_are_long -- --ignored",
    ),
    fault(
        "guard/memory/cloud.rs",
        "            .saturating_add(u64::from(gap_mm));",
        "            .saturating_add(u64::from(gap_mm) * 0);",
        "test --release -p haltline-attack --test finds beams_are_far -- --ignored",
    ),
];
