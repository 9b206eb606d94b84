//! Combinations that no single key can refuse.

use core::ops::Range;

use super::fault::{FaultEntry, FaultKind};
use super::{Motion, Proposer, ProposerKind, Scenario, Step, SweepAxis};

/// Where and what: the caller adds the file.
pub(super) type Complaint = (Option<Range<usize>>, String);

/// Everything that does not fit together.
pub(super) fn check(scenario: &Scenario) -> Result<(), Complaint> {
    check_proposer(scenario)?;
    check_naked(scenario)?;
    for wall in &scenario.wall {
        if wall.get_ref().from_m == wall.get_ref().to_m {
            let message = "the wall has no length; write a to_m that differs from from_m";
            return Err((Some(wall.span()), message.to_owned()));
        }
    }
    for fault in &scenario.fault {
        check_fault(fault.get_ref()).map_err(|message| (Some(fault.span()), message))?;
    }
    for motion in motions(scenario) {
        check_motion(motion.get_ref()).map_err(|message| (Some(motion.span()), message))?;
    }
    for axis in &scenario.sweep {
        check_axis(axis.get_ref()).map_err(|message| (Some(axis.span()), message))?;
    }
    if let Some(latency) = scenario.drive.latency_s {
        let steps = latency.get() * 100.0;
        if (steps - libm::round(steps)).abs() > 1e-9 {
            let message = format!(
                "drive.latency_s = {} is no whole number of dynamics steps; write a multiple of 0.01",
                latency.get()
            );
            return Err((None, message));
        }
    }
    check_expect(scenario)
}

fn check_expect(scenario: &Scenario) -> Result<(), Complaint> {
    let expect = &scenario.expect;
    if let Some(stopped) = &expect.stopped_before
        && stopped.clearance_m.is_none()
        && stopped.x_m.is_none()
        && stopped.y_m.is_none()
    {
        let message =
            "stopped_before says nothing; write clearance_m, x_m or y_m into it".to_owned();
        return Err((None, message));
    }
    let says_something = expect.reached.is_some()
        || expect.stopped_before.is_some()
        || expect.blocked.is_some()
        || !expect.reasons.is_empty()
        || expect.stop_within_s.is_some()
        || expect.travelled_min_m.is_some()
        || expect.turned_min_rad.is_some()
        || expect.turned_max_deg.is_some()
        || expect.travelled_max_m.is_some()
        || expect.arrived.is_some()
        || expect.blocked_reason.is_some()
        || expect.refused_max.is_some()
        || !expect.assumptions_broken.is_empty();
    if !says_something {
        let message = "[expect] asks for nothing; write reached, stopped_before, blocked, reasons, \
                       stop_within_s, travelled_min_m, travelled_max_m, turned_min_rad, turned_max_deg, \
                       arrived, blocked_reason, refused_max or assumptions_broken";
        return Err((None, message.to_owned()));
    }
    if expect.reached == Some(true) && scenario.goal.is_none() {
        return Err((
            None,
            "reached = true without a goal; write a [goal] table".to_owned(),
        ));
    }
    Ok(())
}

fn check_proposer(scenario: &Scenario) -> Result<(), Complaint> {
    let proposer = scenario.proposer.get_ref();
    let complaint = match proposer.kind {
        ProposerKind::Reckless if scenario.goal.is_none() => {
            "the reckless proposer needs somewhere to go; write a [goal] table"
        }
        ProposerKind::Reckless if proposer.speed_mps.is_none() => {
            "the reckless proposer needs speed_mps"
        }
        ProposerKind::Script if proposer.step.is_empty() => {
            "a script needs at least one [[proposer.step]]"
        }
        ProposerKind::Script if proposer.speed_mps.is_some() => {
            "speed_mps belongs to the reckless proposer; write linear_mps into the steps"
        }
        ProposerKind::Navigate if scenario.goal.is_none() => {
            "navigate needs somewhere to go; write a [goal] table"
        }
        ProposerKind::Navigate
            if proposer.speed_mps.is_some() || proposer.heading_gain_per_s.is_some() =>
        {
            "navigate chooses its speed itself; lower limits.speed_forward_mps in [robot_values], or \
             write speed_mps into [naked] for the reckless twin"
        }
        kind if kind != ProposerKind::Script && !proposer.step.is_empty() => {
            "steps belong to a script; write kind = \"script\""
        }
        kind if kind != ProposerKind::Navigate && has_way(proposer) => {
            "via_m and [proposer.navigate] belong to navigate; write kind = \"navigate\""
        }
        _ => {
            check_navigate(scenario)?;
            return check_steps(&proposer.step);
        }
    };
    Err((Some(scenario.proposer.span()), complaint.to_owned()))
}

const fn has_way(proposer: &Proposer) -> bool {
    proposer.via_m.is_some() || proposer.navigate.is_some()
}

/// What only makes sense if the kernel drives itself, and what does not then.
fn check_navigate(scenario: &Scenario) -> Result<(), Complaint> {
    if scenario.proposer.get_ref().kind == ProposerKind::Navigate {
        let of_commands = scenario
            .fault
            .iter()
            .find(|f| f.get_ref().kind.hits_commands());
        return of_commands.map_or(Ok(()), |fault| {
            let message = "nobody sends commands where the kernel drives itself, so nothing goes wrong \
                           with them; remove the fault";
            Err((Some(fault.span()), message.to_owned()))
        });
    }
    let expect = &scenario.expect;
    if expect.arrived.is_some() || expect.blocked_reason.is_some() || expect.refused_max.is_some() {
        let message = "arrived, blocked_reason and refused_max are answers of the kernel's planner; \
                       write kind = \"navigate\" or remove them";
        return Err((None, message.to_owned()));
    }
    match &scenario.naked {
        Some(naked) if naked.get_ref().path.is_some() || naked.get_ref().speed_mps.is_some() => {
            let message = "path and speed_mps in [naked] are for the twin of a navigate scenario; \
                           elsewhere the twin follows the proposer";
            Err((Some(naked.span()), message.to_owned()))
        }
        _ => Ok(()),
    }
}

fn check_steps(steps: &[toml::Spanned<Step>]) -> Result<(), Complaint> {
    let mut before_s = 0.0;
    for spanned in steps {
        let step = spanned.get_ref();
        if step.angular_radps.is_some() && step.curvature_per_m.is_some() {
            let message = "a step turns by angular_radps or by curvature_per_m; write one of them";
            return Err((Some(spanned.span()), message.to_owned()));
        }
        let until_s = step.until_s.get();
        if until_s <= before_s {
            let message = format!(
                "the step never runs: until_s = {until_s} is not after {before_s}, the end of the \
                 step before; write times that rise"
            );
            return Err((Some(spanned.span()), message));
        }
        before_s = until_s;
    }
    Ok(())
}

fn check_naked(scenario: &Scenario) -> Result<(), Complaint> {
    let Some(naked) = &scenario.naked else {
        return Ok(());
    };
    if !naked.get_ref().must_touch && naked.get_ref().reason.is_none() {
        let message = "naked.must_touch = false needs a reason, such as reason = \"not a contact \
                       scenario: the command never comes\"";
        return Err((Some(naked.span()), message.to_owned()));
    }
    Ok(())
}

fn check_fault(fault: &FaultEntry) -> Result<(), String> {
    let kind = fault.kind;
    let keys = [
        ("offset_s", kind.needs_offset(), fault.offset_s.is_some()),
        ("range_m", kind.needs_range(), fault.range_m.is_some()),
        (
            "sector_deg",
            kind.needs_sector(),
            fault.sector_deg.is_some(),
        ),
        ("factor", kind.needs_factor(), fault.factor.is_some()),
        (
            "turn_deg",
            kind == FaultKind::ScanRotated,
            fault.turn_deg.is_some(),
        ),
    ];
    if let Some((key, needed, _)) = keys.iter().find(|(_, needed, given)| needed != given) {
        let verb = if *needed { "needs" } else { "does not take" };
        return Err(format!("{kind:?} {verb} {key}"));
    }
    if fault.fraction.is_some() && !kind.takes_fraction() {
        return Err(format!("{kind:?} does not take fraction"));
    }
    let jumps = fault.jump_m.is_some() || fault.jump_deg.is_some();
    if jumps != (kind == FaultKind::OdometryJump) {
        return Err("jump_m and jump_deg belong to odometry_jump, which needs one of them".into());
    }
    if fault.until_s.is_some_and(|until| until <= fault.from_s) {
        return Err("until_s must be after from_s".into());
    }
    Ok(())
}

fn motions(scenario: &Scenario) -> impl Iterator<Item = &toml::Spanned<Motion>> {
    let walls = scenario.wall.iter().map(|body| &body.get_ref().motion);
    let boxes = scenario.boxes.iter().map(|body| &body.get_ref().motion);
    let circles = scenario.circle.iter().map(|body| &body.get_ref().motion);
    walls.chain(boxes).chain(circles).flatten()
}

fn check_motion(motion: &Motion) -> Result<(), String> {
    let kinds = usize::from(motion.velocity_mps.is_some())
        + usize::from(motion.turn_radps.is_some())
        + usize::from(motion.way_points.is_some());
    if kinds != 1 {
        return Err("write exactly one of velocity_mps, turn_radps or way_points".into());
    }
    if motion.turn_radps.is_some() != motion.pivot_m.is_some() {
        return Err("turn_radps and pivot_m go together".into());
    }
    if motion.from_s.is_some() && motion.when_robot_passes_x_m.is_some() {
        return Err("write either from_s or when_robot_passes_x_m".into());
    }
    if motion.delay_s.is_some() && motion.when_robot_passes_x_m.is_none() {
        return Err("delay_s counts from when_robot_passes_x_m; else write from_s".into());
    }
    if let Some(points) = &motion.way_points {
        let rising = points
            .windows(2)
            .all(|pair| matches!(pair, [a, b] if a[0] < b[0]));
        if points.is_empty() || !rising {
            return Err("way_points need times that rise from one to the next".into());
        }
    }
    Ok(())
}

fn check_axis(axis: &SweepAxis) -> Result<(), String> {
    let ranged = [
        axis.path.is_some(),
        axis.from.is_some(),
        axis.to.is_some(),
        axis.count.is_some(),
    ];
    let all = ranged.iter().all(|given| *given);
    let any = ranged.iter().any(|given| *given);
    if all == axis.values.is_empty() && any == all && axis.count != Some(0) {
        Ok(())
    } else {
        Err(
            "a sweep axis is either path, from, to and count (at least 1), or [[sweep.values]]"
                .into(),
        )
    }
}
