//! `haltline attack`: a campaign, its counterexamples, its record.

mod merge;
mod words;

use crate::args::{AttackArgs, AttackCommand, AttackStrategy};
use crate::failure::{Exit, Failure, prepare, write_file, write_whole};
use crate::library;
use crate::provenance::sha256;
use haltline_attack::campaign::{Orders, Progress, Shrunk, campaign};
use haltline_attack::record::{Campaign, Find, Record};
use haltline_attack::search::Strategy;
use haltline_attack::setting::Setting;
use haltline_attack::trial::Verdict;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Searches and tells what came of it.
///
/// # Errors
/// The robot or a value is unusable, or the output cannot be written.
pub fn attack(args: &AttackArgs) -> Result<Exit, Failure> {
    if let Some(AttackCommand::Merge { folders, out }) = &args.merge {
        return merge::merge(folders, out);
    }
    let Some(path) = &args.robot else {
        return Err(Failure::input("name a robot file"));
    };
    let robot = library::robot(path)?;
    let setting = Setting::new(
        robot,
        values(&args.set)?,
        values(&args.told)?,
        args.breaking,
    )
    .map_err(Failure::input)?;
    prepare(&args.out)?;
    let replay = replay_arguments(path, &setting);
    let mut record = Record {
        campaign: named(&setting, args),
        ..Record::default()
    };
    let orders = orders(args);
    let bar = bar();
    let started = Instant::now();
    let mut failed = Ok(());
    let mut nearest: Option<(f64, String)> = None;
    let made = campaign(&setting, &orders, |progress| {
        record.add(progress.done);
        if let Some((robustness, text)) = &progress.done.worst
            && nearest.as_ref().is_none_or(|(least, _)| robustness < least)
        {
            nearest = Some((*robustness, text.clone()));
        }
        if let Some(find) = &progress.find
            && failed.is_ok()
        {
            failed = keep(&mut record, progress, find, (&args.out, &replay), &bar);
        }
        bar.set_message(words::rate(&record, started.elapsed().as_secs_f64()));
        bar.tick();
    });
    bar.finish_and_clear();
    failed?;
    if let Some((robustness, text)) = nearest {
        let path = args.out.join("nearest.toml");
        let head = format!(
            "# The scenario of the campaign that came nearest: robustness {robustness:.4}\n\n"
        );
        write_file(&path, format!("{head}{text}").as_bytes())?;
    }
    record.shards = vec![[orders.shard[0], orders.shard[1], made]];
    finish(&record, &args.out)
}

/// Writes the record, prints the summary.
fn finish(record: &Record, out: &Path) -> Result<Exit, Failure> {
    let text = serde_json::to_string_pretty(record)
        .map_err(|error| Failure::not_checkable(format!("attack.json: {error}")))?;
    let path = out.join("attack.json");
    write_whole(&path, text.as_bytes())?;
    words::summary(record, out);
    say!("wrote {}", path.display());
    if record.moving == 0 && record.violations.is_empty() && record.broken.is_empty() {
        return Err(Failure::input(
            "no motion was ever accepted, so nothing was tried: look at --set and --told, or at the robot file with \
             `haltline certify`",
        ));
    }
    Ok(if record.violations.is_empty() {
        Exit::Holds
    } else {
        Exit::ClaimFailed
    })
}

/// Keeps a find: its file, its entry.
fn keep(
    record: &mut Record,
    progress: &Progress<'_>,
    find: &Shrunk,
    (out, replay): (&Path, &str),
    bar: &ProgressBar,
) -> Result<(), Failure> {
    let (breaks, what, words) = match &find.trial.verdict {
        Verdict::Violated {
            invariant, what, ..
        } => (false, invariant.clone(), what.clone()),
        Verdict::Broken { id, what } => {
            let name = find.broken.clone().unwrap_or_else(|| id.clone());
            (true, name, what.clone())
        }
        _ => return Ok(()),
    };
    let stem = if breaks {
        what.to_lowercase().replace(['-', ' '], "_")
    } else {
        "counterexample".to_owned()
    };
    let file = format!("{stem}_{}.toml", progress.number);
    let entry = Find {
        search: progress.number,
        what: what.clone(),
        words: words.clone(),
        robustness: find.trial.robustness,
        severity: find.severity,
        file: file.clone(),
        trace_sha256: sha256(find.trial.trace.as_bytes()),
    };
    if record.find(entry, breaks) {
        let path = out.join(&file);
        let command = format!("haltline run {}{replay}", path.display());
        write_file(&path, find.file(&command).as_bytes())?;
        bar.suspend(|| say!("{what}: {words}\n  {command}"));
    }
    Ok(())
}

/// What `haltline run` needs beyond the scenario.
fn replay_arguments(path: &Path, setting: &Setting) -> String {
    let shipped = library::robot_by_name(&setting.name);
    if shipped.is_ok_and(|robot| robot.text == setting.robot.text) {
        String::new()
    } else {
        format!(" --robot {}", path.display())
    }
}

fn values(given: &[(String, String)]) -> Result<BTreeMap<String, toml::Value>, Failure> {
    let read = |(key, value): &(String, String)| {
        let parsed = format!("v = {value}").parse::<toml::Table>();
        let value = parsed.ok().and_then(|mut table| table.remove("v"));
        value.map(|value| (key.clone(), value)).ok_or_else(|| {
            Failure::input(format!(
                "{key}: the value is no TOML; write a number such as 0.1, true, or \"text\""
            ))
        })
    };
    given.iter().map(read).collect()
}

const fn orders(args: &AttackArgs) -> Orders {
    Orders {
        strategy: match args.strategy {
            AttackStrategy::Random => Strategy::Random,
            AttackStrategy::Search => Strategy::Search,
        },
        seed: args.seed,
        shard: args.shard,
        budget: args.budget,
        keep_going: args.keep_going || args.breaking,
    }
}

fn named(setting: &Setting, args: &AttackArgs) -> Campaign {
    let words = |values: &BTreeMap<String, toml::Value>| {
        let pairs = values.iter();
        pairs
            .map(|(key, value)| (key.clone(), value.to_string()))
            .collect()
    };
    Campaign {
        robot: setting.name.clone(),
        robot_sha256: sha256(setting.robot.text.as_bytes()),
        program: format!("haltline {}", env!("CARGO_PKG_VERSION")),
        strategy: format!("{:?}", args.strategy).to_lowercase(),
        seed: args.seed,
        breaking: args.breaking,
        values: words(&setting.values),
        told: words(&setting.told),
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    bar.set_draw_target(ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(std::time::Duration::from_millis(200));
    bar.set_message("first searches");
    bar
}
