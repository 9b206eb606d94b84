//! The table of a benchmark: one row for each world, and what they amount to.

use crate::failure::Failure;
use console::style;
use haltline_scenarios::barn::{TIMEOUT_S, World};
use haltline_scenarios::result::RunResult;
use serde::Serialize;
use std::fmt::Write as _;

/// What became of one world.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Stem of its file.
    pub world: String,
    /// Within 1 m of the goal in time, without contact.
    pub success: bool,
    /// Contacts while the robot moved.
    pub contacts: usize,
    /// Objections of the monitors.
    pub violations: u64,
    /// When the run ended, seconds.
    pub time_s: f64,
    /// The benchmark's score.
    pub score: f64,
    /// Least distance to a cylinder while the robot moved, metres.
    pub clearance_m: Option<f64>,
    /// Way of the rotation centre, metres.
    pub travelled_m: f64,
    /// Angle turned in all, degrees.
    pub turned_deg: f64,
    /// Candidates of the planner that the guard refused.
    pub refused: u64,
    /// Why it did not get there, and where it stands.
    pub why: String,
}

/// All worlds.
#[derive(Clone, Debug, Serialize)]
pub struct Table {
    /// Bound of the range error that the kernel was told, metres.
    pub sensor_bound_m: f64,
    /// The worlds in the order of their names.
    pub rows: Vec<Row>,
}

impl Row {
    /// Row of a run.
    #[must_use]
    pub fn new(world: &World, run: &RunResult) -> Self {
        let contacts = run.moving_contacts();
        let success = run.reached && contacts == 0;
        Self {
            world: world.name.clone(),
            success,
            contacts,
            violations: run.violation_count(),
            time_s: run.time_s,
            score: world.score(success, run.time_s),
            clearance_m: run.min_clearance_moving_m,
            travelled_m: run.travelled_m,
            turned_deg: run.turned_rad.to_degrees(),
            refused: run.navigation.as_ref().map_or(0, |n| n.refused),
            why: if success { String::new() } else { why(run) },
        }
    }

    fn result(&self) -> &'static str {
        match (self.contacts, self.success) {
            (0, true) => "reached",
            (0, false) => "not reached",
            _ => "CONTACT",
        }
    }
}

/// Why a run did not reach its goal, and where it stands.
fn why(run: &RunResult) -> String {
    if let Some(contact) = run.contacts.iter().find(|contact| contact.robot_moving) {
        return format!("touched {} at {:.1} s", contact.body, contact.t_s);
    }
    let place = run.samples.last().map_or_else(String::new, |sample| {
        let pose = sample.pose;
        format!(
            " at ({:.2}, {:.2}, {:.2} rad)",
            pose.x_m, pose.y_m, pose.theta_rad
        )
    });
    let end = run.navigation.as_ref().map(|navigation| &navigation.end);
    let reason = match end.map(|end| (end.kind.as_str(), &end.reason, end.since_s)) {
        Some(("blocked", Some(reason), since)) => {
            let since = since.map_or_else(String::new, |since| format!(" since {since:.0} s"));
            format!("blocked: {reason}{since}")
        }
        Some((kind, _, _)) if run.time_s >= TIMEOUT_S => format!("time is up while {kind}"),
        Some((kind, _, _)) => kind.to_owned(),
        None => String::new(),
    };
    format!("{reason}{place}")
}

impl Table {
    /// No contact, and no monitor objected.
    #[must_use]
    pub fn is_safe(&self) -> bool {
        let safe = |row: &Row| row.contacts == 0 && row.violations == 0;
        self.rows.iter().all(safe)
    }

    /// Prints table and summary.
    pub fn print(&self) {
        say!(
            "{}",
            style(
                "world        result        time s   score  clearance mm  turned deg  refused  why"
            )
            .bold()
        );
        for row in &self.rows {
            let clearance = row
                .clearance_m
                .map_or_else(|| "-".to_owned(), |m| format!("{:.0}", m * 1e3));
            let result = format!("{:<12}", row.result());
            let result = if row.success {
                style(result).green()
            } else {
                style(result).red()
            };
            say!(
                "{:<12} {result} {:>7.1} {:>7.3} {:>13} {:>11.0} {:>8}  {}",
                row.world,
                row.time_s,
                row.score,
                clearance,
                row.turned_deg,
                row.refused,
                row.why
            );
        }
        say!("\n{}", self.summary());
    }

    /// What the rows amount to, in one line.
    #[must_use]
    pub fn summary(&self) -> String {
        let reached: Vec<&Row> = self.rows.iter().filter(|row| row.success).collect();
        let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
        let time_s = mean(reached.iter().map(|row| row.time_s).sum(), reached.len());
        let score = mean(self.rows.iter().map(|row| row.score).sum(), self.rows.len());
        let least = self.rows.iter().filter_map(|row| row.clearance_m);
        let least = least.reduce(f64::min).unwrap_or(0.0);
        let contacts: usize = self.rows.iter().map(|row| row.contacts).sum();
        let violations: u64 = self.rows.iter().map(|row| row.violations).sum();
        let refused: u64 = self.rows.iter().map(|row| row.refused).sum();
        format!(
            "{} of {} reached (sensor bound {:.0} mm), {contacts} contacts, {violations} objections of monitors, \
             mean time {time_s:.1} s of those reached, mean score {score:.3}, least clearance {:.0} mm, \
             {refused} candidates refused by the guard",
            reached.len(),
            self.rows.len(),
            self.sensor_bound_m * 1e3,
            least * 1e3
        )
    }

    /// The rows as CSV.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = String::from(
            "world,success,contacts,violations,time_s,score,clearance_m,travelled_m,turned_deg,refused,why\n",
        );
        for row in &self.rows {
            let clearance = row
                .clearance_m
                .map_or_else(String::new, |m| format!("{m:.6}"));
            let _ = writeln!(
                out,
                "{},{},{},{},{:.2},{:.6},{clearance},{:.3},{:.1},{},\"{}\"",
                row.world,
                row.success,
                row.contacts,
                row.violations,
                row.time_s,
                row.score,
                row.travelled_m,
                row.turned_deg,
                row.refused,
                row.why.replace('"', "'")
            );
        }
        out
    }

    /// The same as JSON.
    ///
    /// # Errors
    /// A number that JSON cannot hold.
    pub fn json(&self) -> Result<String, Failure> {
        serde_json::to_string_pretty(self)
            .map_err(|error| Failure::not_checkable(format!("barn.json: {error}")))
    }
}
