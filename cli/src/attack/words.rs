//! What an attack says to people.

use crate::report::words::count;
use console::style;
use haltline_attack::record::Record;
use std::path::Path;

/// Rate and worst robustness, for the progress line.
pub(super) fn rate(record: &Record, seconds: f64) -> String {
    format!(
        "{} runs, {:.1} per second, {} violations, worst robustness {}",
        record.runs,
        record.runs as f64 / seconds.max(1e-3),
        record.violations.len(),
        robustness(record)
    )
}

fn robustness(record: &Record) -> String {
    match record.worst_robustness {
        None => "none yet".to_owned(),
        Some(distance) if distance >= 0.0 => format!("{:.1} mm", distance * 1e3),
        Some(speed) => format!("{speed:.3}"),
    }
}

/// How near each invariant that has a distance came to a violation.
fn nearest(record: &Record) -> String {
    let mut words = vec![format!("CLAIM {}", robustness(record))];
    for (invariant, margin) in &record.margins {
        words.push(match invariant.as_str() {
            "ZONE" => format!("ZONE {:.1} mm", margin * 1e3),
            "LIMIT" => format!("LIMIT {margin:.3} m/s or rad/s"),
            _ => format!("{invariant} {:.1} ms", margin * 1e3),
        });
    }
    words.join(", ")
}

/// The whole campaign.
pub(super) fn summary(record: &Record, out: &Path) {
    let campaign = &record.campaign;
    let could = record.runs - record.refused;
    say!(
        "\n{}  {} by {}, seed {}",
        style(&campaign.robot).bold(),
        count(usize::try_from(record.runs).unwrap_or(usize::MAX), "run"),
        campaign.strategy,
        campaign.seed
    );
    for (key, value) in &campaign.values {
        say!("  not the shipped robot: {key} = {value}");
    }
    for (key, value) in &campaign.told {
        say!("  the kernel is told {key} = {value}, which is not true");
    }
    say!(
        "  {} ticks judged, {:.0} % with an accepted motion",
        record.ticks,
        100.0 * record.moving as f64 / (record.ticks.max(1)) as f64
    );
    say!(
        "  without the guard {} of {} runs touched something in motion",
        record.naked_touched,
        record.naked_runs
    );
    say!(
        "  {} of {could} runs ended in a contact of which the claim does not speak (CAVEATS.md); {} could not be run",
        record.excused,
        record.refused
    );
    for (why, count) in &record.excuses {
        say!("    {count}: {why}");
    }
    if !campaign.breaking {
        say!("  nearest to a violation: {}", nearest(record));
    }
    for (id, find) in &record.broken {
        let from = find.severity.map_or(String::new(), |severity| {
            format!(" from {severity:.2} times what is assumed on")
        });
        say!(
            "  {} {id}: contact{from} ({}): {}",
            style("assumption broken").yellow(),
            find.words,
            out.join(&find.file).display()
        );
    }
    if record.violations.is_empty() {
        let told = "searched, no claim violated";
        say!("\n  {} ({could} runs)", style(told).green().bold());
    }
    for find in &record.violations {
        let file = out.join(&find.file);
        say!(
            "\n  {} {}: {}\n    {}",
            style("claim violated").red().bold(),
            find.what,
            find.words,
            file.display()
        );
    }
}
