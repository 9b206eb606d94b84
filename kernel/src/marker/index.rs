//! Where a marker is kept: a table over all ids, and the map of markers known beforehand.
//!
//! It refuses ids that do not exist and entries that are there already.

use super::pose::Pose2;
use super::rules::FilterError;
use super::sighting::IDS;

/// Bit of an index entry that says "in the state".
const LEARNED: u16 = 0x8000;

/// Where a marker is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Nowhere.
    Unknown,
    /// In the map given beforehand, at this place of it.
    Mapped(usize),
    /// In the state, in this slot.
    Learned(usize),
}

/// Two bytes per id, and the poses of up to `M` mapped markers.
#[derive(Clone, Debug)]
pub(super) struct Index<const M: usize> {
    places: [u16; IDS],
    mapped: [Pose2; M],
    len: usize,
}

impl<const M: usize> Index<M> {
    pub(super) const fn new() -> Self {
        Self {
            places: [0; IDS],
            mapped: [Pose2::new(0.0, 0.0, 0.0); M],
            len: 0,
        }
    }

    /// # Bound
    /// O(1).
    pub(super) fn place(&self, id: u16) -> Place {
        match self.places.get(usize::from(id)).copied() {
            None | Some(0) => Place::Unknown,
            Some(entry) if entry & LEARNED != 0 => Place::Learned(usize::from(entry ^ LEARNED)),
            Some(entry) => Place::Mapped(usize::from(entry).saturating_sub(1)),
        }
    }

    pub(super) fn mapped(&self, at: usize) -> Option<&Pose2> {
        self.mapped.get(..self.len)?.get(at)
    }

    pub(super) fn add_mapped(&mut self, id: u16, pose: Pose2) -> Result<(), FilterError> {
        let entry = self
            .places
            .get_mut(usize::from(id))
            .ok_or(FilterError::Id)?;
        if *entry != 0 {
            return Err(FilterError::Duplicate);
        }
        let place = self.mapped.get_mut(self.len).ok_or(FilterError::Full)?;
        let number = self.len.saturating_add(1);
        let number = u16::try_from(number).map_err(|_| FilterError::Full)?;
        *place = pose;
        *entry = number & !LEARNED;
        self.len = usize::from(number);
        Ok(())
    }

    /// Says that a marker is in the state, or with `None` that it no longer is.
    pub(super) fn set_learned(&mut self, id: u16, slot: Option<usize>) {
        let slot = slot.and_then(|slot| u16::try_from(slot).ok());
        if let Some(entry) = self.places.get_mut(usize::from(id)) {
            *entry = slot.map_or(0, |slot| slot | LEARNED);
        }
    }
}
