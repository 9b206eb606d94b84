//! Faults of scans: their ranges, their beams, their stamps, their way to the host.

use super::{Faults, due};
use crate::file::fault::FaultKind;
use crate::sensor::{RawScan, lost_range, no_return};

impl Faults {
    /// What reaches the kernel of the scans that arrived by `t_us`.
    pub fn scans(&mut self, t_us: u64, arrived: Vec<RawScan>) -> Vec<RawScan> {
        let mut out = Vec::new();
        for mut scan in arrived {
            self.spoil_ranges(t_us, &mut scan);
            self.distort_ranges(t_us, &mut scan);
            self.spoil_sectors(t_us, &mut scan);
            self.mirror(t_us, &mut scan);
            if self.active(FaultKind::ScanShort, t_us).is_some() {
                let half = scan.ranges_m.len() / 2;
                scan.ranges_m.truncate(half);
                scan.bodies.truncate(half);
            }
            self.freeze(t_us, &mut scan);
            self.stamp(t_us, &mut scan);
            let before = self.scan_before.insert(scan.scanner, scan.clone());
            if self.active(FaultKind::ScanMissing, t_us).is_some() {
                continue;
            }
            if let Some(offset) = self.offset_us(FaultKind::ScanLate, t_us) {
                self.late_scans.push((t_us + offset, scan));
                continue;
            }
            if self.active(FaultKind::ScanDuplicated, t_us).is_some() {
                out.push(scan.clone());
            }
            out.push(scan);
            if self.active(FaultKind::ScanReordered, t_us).is_some() {
                out.extend(before);
            }
        }
        out.extend(due(&mut self.late_scans, t_us));
        out
    }

    fn stamp(&mut self, t_us: u64, scan: &mut RawScan) {
        if self.active(FaultKind::ScanWrapped, t_us).is_some() {
            scan.stamp_us &= 0xFFFF_FFFF;
        }
        if let Some(offset) = self.offset_us(FaultKind::ScanFuture, t_us) {
            scan.stamp_us += offset;
        }
        if let Some(offset) = self.offset_us(FaultKind::ScanPast, t_us) {
            scan.stamp_us = scan.stamp_us.saturating_sub(offset);
        }
        if let Some(offset) = self.offset_us(FaultKind::ScanJitter, t_us) {
            let error = (self.noise.symmetric() * offset as f64) as i64;
            scan.stamp_us = scan.stamp_us.saturating_add_signed(error);
        }
    }

    fn spoil_ranges(&mut self, t_us: u64, scan: &mut RawScan) {
        let scanner = self.scanners.get(scan.scanner);
        let silence = scanner.map_or(0.0, |scanner| no_return(scanner.encoding));
        let spoilers = [
            (FaultKind::RangesNan, f32::NAN),
            (FaultKind::RangesInfinite, f32::INFINITY),
            (FaultKind::RangesZero, 0.0),
            (FaultKind::RangesNegative, -1.0),
            (FaultKind::BeamsLost, silence),
        ];
        for (kind, value) in spoilers {
            let Some(part) = self
                .active(kind, t_us)
                .map(|entry| entry.fraction.map_or(1.0, |f| f.get()))
            else {
                continue;
            };
            for (range, body) in scan.ranges_m.iter_mut().zip(&mut scan.bodies) {
                if self.noise.unit() < part {
                    *range = value;
                    *body = None;
                }
            }
        }
    }

    /// Wrong, but a range: of beams that came back.
    fn distort_ranges(&self, t_us: u64, scan: &mut RawScan) {
        let length = |kind| {
            let entry = self.active(kind, t_us)?;
            Some(entry.range_m?.get() as f32)
        };
        let scaled = self.active(FaultKind::RangesScaled, t_us);
        let factor = scaled.and_then(|entry| entry.factor);
        let factor = factor.map(|factor| factor.get() as f32);
        let step = length(FaultKind::RangesQuantised);
        let most = length(FaultKind::RangesSaturated);
        let ranges = scan.ranges_m.iter_mut();
        for range in ranges.filter(|range| range.is_finite() && **range > 0.0) {
            if let Some(factor) = factor {
                *range *= factor;
            }
            if let Some(step) = step {
                *range = libm::roundf(*range / step).max(1.0) * step;
            }
            if let Some(most) = most {
                *range = range.min(most);
            }
        }
    }

    fn spoil_sectors(&self, t_us: u64, scan: &mut RawScan) {
        let Some(scanner) = self.scanners.get(scan.scanner) else {
            return;
        };
        for kind in [FaultKind::SectorLost, FaultKind::SectorSpoofed] {
            let Some(entry) = self.active(kind, t_us) else {
                continue;
            };
            let Some(sector) = entry.sector_deg else {
                continue;
            };
            let value = entry.range_m.map(|range| range.get() as f32);
            let value = value.unwrap_or_else(|| lost_range(scanner.encoding));
            let [from, to] = sector.map(|bound| bound.get().to_radians());
            let full = core::f64::consts::TAU;
            let beams = scan.ranges_m.iter_mut().zip(&mut scan.bodies);
            for (beam, (range, body)) in beams.enumerate() {
                let bearing = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
                if (bearing - from).rem_euclid(full) <= (to - from).rem_euclid(full) {
                    *range = value;
                    *body = None;
                }
            }
        }
    }

    /// Beams that are taken for others; a turned scanner casts elsewhere ([`crate::sensor`]).
    fn mirror(&self, t_us: u64, scan: &mut RawScan) {
        if self.active(FaultKind::ScanMirrored, t_us).is_some() {
            scan.ranges_m.reverse();
            scan.bodies.reverse();
        }
    }

    fn freeze(&mut self, t_us: u64, scan: &mut RawScan) {
        if self.active(FaultKind::ScanFrozen, t_us).is_some() {
            let held = self
                .frozen
                .entry(scan.scanner)
                .or_insert_with(|| scan.ranges_m.clone());
            scan.ranges_m.clone_from(held);
            scan.bodies.fill(None);
        } else {
            self.frozen.remove(&scan.scanner);
        }
    }
}
