//! What a shard of an attack leaves: any file is read or refused, and joined or refused, in bounded time.

use crate::text::{spoiled, text};
use crate::{Judged, Property, demand};
use haltline_attack::record::Record;

pub const RECORD: Property = Property {
    name: "record",
    judge: |bytes| judge(bytes, |one, two| one.join(two)),
    twins: &[
        ("a shard counted twice", |bytes| {
            judge(bytes, |one, two| {
                one.runs = one.runs.saturating_add(two.runs);
                one.shards.extend(two.shards);
                Ok(())
            })
        }),
        ("other campaigns joined", |bytes| {
            judge(bytes, |one, mut two| {
                two.campaign = one.campaign.clone();
                one.join(two)
            })
        }),
    ],
    draw: |draw| spoiled(draw, EXAMPLE),
    cases: 8000,
};

const EXAMPLE: &str = r#"{
"campaign": {"robot": "seekur_jr", "robot_sha256": "00ff", "program": "haltline 0.1.0", "strategy": "search",
"seed": 7, "breaking": true, "values": {"limits.speed_forward_mps": "0.5"}, "told": {}},
"shards": [
[0, 2, 10],
[1, 4, 3]
],
"runs": 100,
"refused": 1,
"excused": 0, "ticks": 9000,
"moving": 800, "naked_runs": 3, "naked_touched": 2,
"worst_robustness": 0.0125,
"margins": {"ZONE": 0.5, "FRESH": 0.02},
"violations": [],
"broken": {"A-BRAKE": {"search": 3, "what": "A-BRAKE", "words": "brakes", "robustness": -0.01, "severity": 2.5,
"file": "a.toml", "trace_sha256": "11"}}
}"#;

type Join = fn(&mut Record, Record) -> Result<(), String>;

/// Whether two shards share one of their searches, by looking at all of the smaller where that is few.
fn share([first, step, count]: [u64; 3], [other, every, others]: [u64; 3]) -> Option<bool> {
    let wide = |value: u64| u128::from(value);
    if count > 10_000 {
        return None;
    }
    let within = |number: u128| {
        let ahead = number.checked_sub(wide(other));
        ahead.is_some_and(|ahead| {
            ahead.is_multiple_of(wide(every.max(1))) && ahead / wide(every.max(1)) < wide(others)
        })
    };
    Some((0..wide(count)).any(|k| within(wide(first) + k * wide(step.max(1)))))
}

fn judge(bytes: &[u8], join: Join) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let Ok(record) = serde_json::from_str::<Record>(text) else {
        return Ok(0);
    };
    let written = serde_json::to_string(&record).map_err(|error| error.to_string())?;
    let again: Record =
        serde_json::from_str(&written).map_err(|error| format!("{error}: {written}"))?;
    demand(
        again.campaign == record.campaign && again.shards == record.shards,
        || format!("read back as {again:?}"),
    )?;
    let mut other = record.clone();
    other.campaign.seed ^= 1;
    demand(join(&mut record.clone(), other).is_err(), || {
        "joined two campaigns".to_owned()
    })?;
    // The same searches once more, or shifted by one: shared ones must be refused.
    for shift in [0, 1] {
        let mut other = record.clone();
        for shard in &mut other.shards {
            shard[0] = shard[0].wrapping_add(shift);
        }
        let pairs = record
            .shards
            .iter()
            .flat_map(|one| other.shards.iter().map(move |two| share(*one, *two)));
        let shared: Option<Vec<bool>> = pairs.collect();
        let joined = join(&mut record.clone(), other).is_ok();
        if let Some(shared) = shared {
            demand(joined != shared.contains(&true), || {
                format!("joined: {joined}, {:?} shifted by {shift}", record.shards)
            })?;
        }
    }
    Ok(1)
}
