//! Names that must be those of the specification or of the kernel: a typo is no failed run.

use haltline::decision::Reason;
use haltline::guard::Refusal;
use haltline::kernel::navigate::Obstruction;
use serde::{Deserialize, Deserializer, de::Error};

/// All reasons of the kernel, in its order.
const REASONS: [Reason; 32] = [
    Reason::None,
    Reason::GuardLimited,
    Reason::GuardBlocked,
    Reason::PathBlocked,
    Reason::LimitExceeded,
    Reason::ReverseNotAllowed,
    Reason::EmptyWindow,
    Reason::CommandMissing,
    Reason::CommandStale,
    Reason::CommandFuture,
    Reason::CommandReordered,
    Reason::CommandMalformed,
    Reason::WaitingForRelease,
    Reason::CriticalZone,
    Reason::ScanMissing,
    Reason::ScanStale,
    Reason::ScanFuture,
    Reason::ScanReordered,
    Reason::ScanMalformed,
    Reason::ScanFrozen,
    Reason::OdometryMissing,
    Reason::OdometryStale,
    Reason::OdometryFuture,
    Reason::OdometryReordered,
    Reason::OdometryMalformed,
    Reason::OdometryJump,
    Reason::OdometryInconsistent,
    Reason::DriveMismatch,
    Reason::TickLate,
    Reason::TimeReversed,
    Reason::Startup,
    Reason::EmergencyStopLine,
];

/// Ids of requirements.
pub(super) fn requirements<'de, D>(deserializer: D) -> Result<Vec<String>, D::Error>
where
    D: Deserializer<'de>,
{
    let all = haltline_spec::requirements::requirements();
    let known: Vec<_> = all.into_iter().map(|found| found.id.to_owned()).collect();
    checked(deserializer, "requirement", &known)
}

/// Ids of assumptions.
pub(super) fn assumptions<'de, D>(deserializer: D) -> Result<Vec<String>, D::Error>
where
    D: Deserializer<'de>,
{
    let all = haltline_spec::requirements::assumptions();
    let known: Vec<_> = all.into_iter().map(|found| found.id.to_owned()).collect();
    checked(deserializer, "assumption", &known)
}

/// Reasons as the kernel names them.
pub(super) fn reasons<'de, D>(deserializer: D) -> Result<Vec<String>, D::Error>
where
    D: Deserializer<'de>,
{
    let known: Vec<_> = REASONS.iter().map(|reason| format!("{reason:?}")).collect();
    checked(deserializer, "reason", &known)
}

/// Why the kernel's navigator cannot go on; a reason of the guard has `Guard` before its name.
const OBSTRUCTIONS: [Obstruction; 7] = [
    Obstruction::NoWay,
    Obstruction::GoalOccupied,
    Obstruction::NoProgress,
    Obstruction::Guard(Refusal::KnownPoint),
    Obstruction::Guard(Refusal::UnknownSpace),
    Obstruction::Guard(Refusal::MixedMotion),
    Obstruction::Guard(Refusal::TooLong),
];

/// One of the reasons for being blocked.
pub(super) fn blocked_reason<'de, D>(deserializer: D) -> Result<Option<String>, D::Error>
where
    D: Deserializer<'de>,
{
    let name = String::deserialize(deserializer)?;
    let known = OBSTRUCTIONS.map(crate::pilot::reason);
    if known.contains(&name) {
        return Ok(Some(name));
    }
    Err(D::Error::custom(format!(
        "the kernel is never blocked by `{name}`; write one of {}",
        known.join(", ")
    )))
}

fn checked<'de, D>(deserializer: D, what: &str, known: &[String]) -> Result<Vec<String>, D::Error>
where
    D: Deserializer<'de>,
{
    let names = Vec::<String>::deserialize(deserializer)?;
    match names.iter().find(|name| !known.contains(name)) {
        Some(name) => {
            let family = |id: &str| id.split_once('-').map(|(family, _)| family.to_owned());
            let alike = |id: &&String| family(id) == family(name);
            let near: Vec<_> = known.iter().filter(alike).map(String::as_str).collect();
            let near = if near.is_empty() {
                known.join(", ")
            } else {
                near.join(", ")
            };
            Err(D::Error::custom(format!(
                "there is no {what} `{name}`; write one of {near}"
            )))
        }
        None => Ok(names),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obstructions_are_complete() {
        for obstruction in OBSTRUCTIONS {
            // A new one does not compile until it is listed above.
            match obstruction {
                Obstruction::NoWay | Obstruction::GoalOccupied | Obstruction::NoProgress => {}
                Obstruction::Guard(
                    Refusal::KnownPoint
                    | Refusal::UnknownSpace
                    | Refusal::MixedMotion
                    | Refusal::TooLong,
                ) => {}
            }
        }
        let names: std::collections::BTreeSet<_> =
            OBSTRUCTIONS.map(crate::pilot::reason).into_iter().collect();
        assert_eq!(names.len(), OBSTRUCTIONS.len());
    }

    #[test]
    fn reasons_are_complete_and_in_the_kernels_order() {
        for (index, reason) in REASONS.iter().enumerate() {
            assert_eq!(*reason as usize, index, "{reason:?}");
        }
        assert_eq!(REASONS.last(), Some(&Reason::EmergencyStopLine));
    }
}
