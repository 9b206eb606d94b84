//! Consecutive moments with the same verdict, told as one event.

use super::drive::Moment;
use super::shadow::Judged;
use crate::report::words;
use serde::Serialize;

/// Consecutive moments at which the guard objected for the same reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// Index of the first moment.
    #[serde(skip)]
    pub first: usize,
    /// Time of the first moment, seconds.
    pub from_s: f64,
    /// Time of the last moment, seconds.
    pub until_s: f64,
    /// Number of moments.
    pub ticks: usize,
    /// What the guard would have done.
    pub action: String,
    /// Why.
    pub reason: String,
    /// Why the tube was refused, if the guard said so.
    pub refusal: Option<String>,
    /// The point that decided first, in the frame of the first row, metres.
    pub point_m: Option<[f64; 2]>,
    /// Distance of that point from the rotation centre, metres.
    pub distance_m: Option<f64>,
    /// Recorded speed at the first moment, m/s.
    pub speed_mps: f64,
    /// Least speed factor over the event, 0 to 1.
    pub factor: f64,
}

impl Event {
    /// Whether the guard would have braked or stopped, not only slowed.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        self.action != "slow"
    }

    /// The event in one short line.
    #[must_use]
    pub fn sentence(&self) -> String {
        let why = self.refusal.as_ref().unwrap_or(&self.reason);
        let place = self
            .distance_m
            .map_or(String::new(), |d| format!(" at {d:.1} m"));
        format!(
            "{:5.1} s  {}: {}{place}",
            self.from_s,
            words::reason(&self.action),
            words::reason(why)
        )
    }
}

/// All events, in order of time; moments that passed belong to none.
#[must_use]
pub fn events(moments: &[Moment], judged: &[Judged]) -> Vec<Event> {
    let mut events: Vec<Event> = Vec::new();
    let mut open = false;
    for (index, (moment, verdict)) in moments.iter().zip(judged).enumerate() {
        if verdict.action == "pass" {
            open = false;
            continue;
        }
        if let Some(last) = events.last_mut().filter(|last| {
            open && last.action == verdict.action
                && last.reason == verdict.reason
                && last.refusal == verdict.refusal
        }) {
            last.until_s = moment.t_s;
            last.ticks += 1;
            last.factor = last.factor.min(verdict.factor);
        } else {
            events.push(first_of(index, moment, verdict));
        }
        open = true;
    }
    events
}

fn first_of(index: usize, moment: &Moment, verdict: &Judged) -> Event {
    let distance = |[x, y]: [f64; 2]| (x - moment.pose[0]).hypot(y - moment.pose[1]);
    Event {
        first: index,
        from_s: moment.t_s,
        until_s: moment.t_s,
        ticks: 1,
        action: verdict.action.clone(),
        reason: verdict.reason.clone(),
        refusal: verdict.refusal.clone(),
        point_m: verdict.point_m,
        distance_m: verdict.point_m.map(distance),
        speed_mps: moment.speed[0],
        factor: verdict.factor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_are_one_event_and_a_pass_parts_them() {
        let actions = ["pass", "slow", "slow", "brake", "pass", "brake"];
        let moments: Vec<Moment> = (0..actions.len())
            .map(|i| Moment {
                t_s: i as f64,
                pose: [0.0; 3],
                told: [1.0, 0.0],
                row: Some(i),
                speed: [1.0, 0.0],
                wanted: [1.0, 0.0],
                returns_m: vec![],
                seen_m: vec![],
            })
            .collect();
        let judged: Vec<Judged> = actions
            .iter()
            .map(|action| Judged {
                action: (*action).into(),
                point_m: Some([3.0, 4.0]),
                ..Judged::default()
            })
            .collect();
        let found = events(&moments, &judged);
        let spans: Vec<_> = found.iter().map(|e| (e.first, e.ticks)).collect();
        assert_eq!(spans, vec![(1, 2), (3, 1), (5, 1)]);
        assert!((found[0].distance_m.unwrap_or_default() - 5.0).abs() < 1e-12);
        assert!(!found[0].is_stop() && found[1].is_stop());
    }
}
