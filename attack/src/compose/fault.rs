//! Faults from the catalogue: those that break no assumption, and those that are to break one.

use super::{push, put};
use crate::genes::{Dice, Genes, rounded};
use haltline_scenarios::catalogue::{CATALOGUE, How};
use haltline_scenarios::file::fault::FaultKind;
use toml::{Table, Value};

/// Kinds of the catalogue that break an assumption, with its id, or those that break none.
pub(super) fn kinds(breaking: bool) -> Vec<(FaultKind, &'static str)> {
    let mut kinds = Vec::new();
    for fault in CATALOGUE {
        if let How::Kind(kind) = fault.how
            && fault.breaks.is_some() == breaking
            && !kinds.iter().any(|(known, _)| *known == kind)
            && (breaking || !sometimes_breaks(kind))
            // Not drawn: campaigns stay comparable with those made before it was known to break nothing.
            && kind != FaultKind::CommandFuture
        {
            kinds.push((kind, fault.breaks.unwrap_or("")));
        }
    }
    kinds
}

/// Whether a kind breaks an assumption of some robot.
fn sometimes_breaks(kind: FaultKind) -> bool {
    let of_kind = CATALOGUE
        .iter()
        .filter(|fault| fault.how == How::Kind(kind));
    of_kind.into_iter().any(|fault| fault.breaks.is_some())
}

/// Adds one that breaks no assumption: the kernel must cope with it.
pub(super) fn harmless(dice: &mut Dice, genes: &mut Genes<'_>, table: &mut Table) {
    let kinds = kinds(false);
    let Some((kind, _)) = kinds.get(dice.index(kinds.len())) else {
        return;
    };
    add(*kind, genes.between(0.05, 6.0), genes, table);
}

/// Whether [`add`] makes something of its `size`.
pub(super) fn has_size(kind: FaultKind) -> bool {
    kind.needs_offset()
        || kind.needs_factor()
        || matches!(
            kind,
            FaultKind::RangesQuantised | FaultKind::ScanRotated | FaultKind::OdometryJump
        )
}

/// Adds a fault of a kind; the larger `size`, the worse.
pub(super) fn add(kind: FaultKind, size: f64, genes: &mut Genes<'_>, table: &mut Table) {
    let from_s = genes.between(0.5, 6.0);
    let for_s = genes.between(0.2, 4.0);
    let places = [
        genes.between(-135.0, 135.0),
        genes.between(2.0, 60.0),
        genes.between(0.3, 12.0),
    ];
    let more = genes.between(0.05, 1.0);
    // Commands of a planner cannot go wrong where the kernel drives itself.
    let proposer = table.get("proposer").and_then(|p| p.get("kind"));
    if proposer.and_then(Value::as_str) == Some("navigate") && kind.hits_commands() {
        return;
    }
    let mut fault = Table::new();
    put(&mut fault, "kind", kind.name());
    put(&mut fault, "from_s", from_s);
    if kind != FaultKind::HostDeath {
        put(&mut fault, "until_s", rounded(from_s + for_s));
    }
    if kind.needs_offset() {
        put(&mut fault, "offset_s", rounded(0.05 * size));
    }
    if kind.takes_fraction() {
        put(&mut fault, "fraction", more);
    }
    if kind.needs_range() {
        let range_m = match kind {
            FaultKind::RangesQuantised => 0.1 * size,
            _ => places[2],
        };
        put(&mut fault, "range_m", rounded(range_m));
    }
    if kind.needs_sector() {
        let sector = [places[0], places[0] + places[1]];
        put(&mut fault, "sector_deg", sector.map(Value::from).to_vec());
    }
    if kind.needs_factor() {
        put(&mut fault, "factor", rounded(1.0 + 0.05 * size));
    }
    if kind == FaultKind::ScanRotated {
        put(&mut fault, "turn_deg", rounded(3.0 * size));
    }
    if kind == FaultKind::OdometryJump {
        put(&mut fault, "jump_m", rounded(0.05 * size));
    }
    push(table, "fault", fault);
}
