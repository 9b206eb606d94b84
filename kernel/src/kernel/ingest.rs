//! Taking in odometry, scans and commands; everything doubtful becomes a hazard.

use super::{Channel, Kernel, Worst};
use crate::arith::magnitude;
use crate::config::Scanner;
use crate::decision::Reason;
use crate::geometry::rect::Rect;
use crate::guard::memory::Arrival;
use crate::guard::tube::eighths_up;
use crate::input::{Beam, Command, Odometry, Reading, Scan};
use crate::time::Instant;
use crate::watch::{self, Order};

/// A scan that repeats bit by bit after the robot has driven or turned this far is frozen.
const FROZEN_TRAVEL_UM: u64 = 60_000;
const FROZEN_TURN_URAD: u64 = 60_000;

impl<const S: usize, const B: usize, const M: usize> Kernel<S, B, M> {
    pub(super) fn take_odometry(
        &mut self,
        reading: &Reading<Odometry>,
        now: Instant,
        hazard: &mut Worst,
    ) {
        let odometry = match reading {
            Reading::Absent => return,
            //= spec/input.md#input-10
            //# A malformed value MUST stop or brake the robot in the same tick.
            Reading::Malformed => return hazard.add(Reason::OdometryMalformed),
            Reading::Value(odometry) => *odometry,
        };
        let newest = self.track.newest().copied();
        match watch::order(odometry.stamp, newest.map(|odometry| odometry.stamp), now) {
            Order::Future => return hazard.add(Reason::OdometryFuture),
            Order::Older => return hazard.add(Reason::OdometryReordered),
            Order::Same => return,
            Order::Newer => {}
        }
        let fault = newest
            .and_then(|before| watch::odometry_fault(self.config.config(), &before, &odometry));
        if let Some(reason) = fault {
            hazard.add(reason);
        }
        //= spec/memory.md#memory-11
        //# A reset MUST forget what was known when the odometry is no longer continuous.
        if fault == Some(Reason::OdometryJump) {
            // Remembered places have lost their relation to the robot.
            self.memory.clear();
            self.forget_scans();
            self.track.restart(odometry);
        } else if let Some(shift) = self.track.push(odometry) {
            self.memory.reanchor(shift);
            // A rare moment; the robot brakes if it still needed the excuse.
            self.leaving = None;
        }
        self.note_rest(&odometry);
    }

    fn forget_scans(&mut self) {
        for channel in &mut self.channels {
            channel.accepted = None;
            channel.pending = false;
        }
    }

    fn note_rest(&mut self, odometry: &Odometry) {
        let bounds = &self.config.config().tolerances;
        let rests = magnitude(odometry.twist.linear.as_um_per_s())
            <= magnitude(bounds.rest_speed.as_um_per_s())
            && magnitude(odometry.twist.angular.as_urad_per_s())
                <= magnitude(bounds.rest_angular_speed.as_urad_per_s());
        self.resting_since = match (rests, self.resting_since) {
            (false, _) => None,
            (true, None) => Some(odometry.stamp),
            (true, since) => since,
        };
    }

    /// Whether the robot has rested for the rest time and is told to.
    //= spec/latch.md#latch-09
    //# The robot MUST count as resting only after its measured twist has been within the rest tolerances for the
    //# whole rest time.
    pub(super) fn is_at_rest(&self) -> bool {
        let timing = &self.config.config().timing;
        let (Some(since), Some(newest)) = (self.resting_since, self.track.newest()) else {
            return false;
        };
        let measured = newest.stamp.since(since);
        //= spec/latch.md#latch-10
        //# The robot MUST NOT count as resting until nothing but standstill has been sent for the actuation latency and
        //# the rest time.
        // Between two samples nobody measures: a drive that is late may have moved there.
        let span = timing.actuation_latency.plus(timing.rest);
        measured.is_some_and(|span| span >= timing.rest)
            && self.pipeline.has_stood(newest.stamp, span)
    }

    pub(super) fn take_scan(
        &mut self,
        reading: &Reading<Scan<'_>>,
        now: Instant,
        hazard: &mut Worst,
    ) {
        let scan = match reading {
            Reading::Absent => return,
            Reading::Malformed => return hazard.add(Reason::ScanMalformed),
            Reading::Value(scan) => scan,
        };
        let setup = self.config.config().scanners.get(scan.scanner).copied();
        let Some(Some(setup)) = setup else {
            return hazard.add(Reason::ScanMalformed);
        };
        let zone = self.zone();
        let Some(channel) = self.channels.get_mut(scan.scanner) else {
            return hazard.add(Reason::ScanMalformed);
        };
        let ends = scan.stamp.plus(setup.scan_duration);
        match watch::order(scan.stamp, channel.newest, now) {
            Order::Future => return hazard.add(Reason::ScanFuture),
            Order::Older => return hazard.add(Reason::ScanReordered),
            Order::Same => return,
            Order::Newer if ends > now => return hazard.add(Reason::ScanFuture),
            Order::Newer => {}
        }
        if !watch::beams_usable(&setup, scan.beams) {
            return hazard.add(Reason::ScanMalformed);
        }
        //= spec/zone.md#zone-01
        //# A return of a new scan in the critical zone MUST start a protective stop in the tick that receives the
        //# scan.
        hazard.add_if(
            watch::returns_from_zone(&setup, scan.beams, zone),
            Reason::CriticalZone,
        );
        channel.newest = Some(scan.stamp);
        channel.note_content(scan.beams, self.track.odometer());
        channel.hold(scan.beams, scan.stamp);
        if self.accept(scan.scanner, &setup, scan.beams, scan.stamp)
            && let Some(channel) = self.channels.get_mut(scan.scanner)
        {
            channel.pending = false;
        }
    }

    /// Places a scan in memory if the odometry covers it.
    fn accept(&mut self, scanner: usize, setup: &Scanner, beams: &[Beam], stamp: Instant) -> bool {
        let start = self.track.pose_at(stamp);
        let end = self.track.pose_at(stamp.plus(setup.scan_duration));
        let (Some(start), Some(end)) = (start, end) else {
            return false;
        };
        let arrival = Arrival {
            scanner,
            setup,
            beams,
            stamp,
            poses: (start, end),
        };
        self.memory
            .accept(self.config.memory(), arrival, self.track.odometer());
        if let Some(channel) = self.channels.get_mut(scanner) {
            channel.accepted = Some(stamp);
        }
        true
    }

    /// Takes in scans that waited for the odometry.
    pub(super) fn settle_pending(&mut self) {
        for scanner in 0..S {
            let Some(Some(setup)) = self.config.config().scanners.get(scanner).copied() else {
                continue;
            };
            let Some(channel) = self.channels.get(scanner) else {
                continue;
            };
            let Some(stamp) = channel.beams_stamp.filter(|_| channel.pending) else {
                continue;
            };
            let beams = channel.beams;
            let count = usize::from(setup.beams).min(B);
            let placed = self.accept(scanner, &setup, beams.get(..count).unwrap_or(&[]), stamp);
            if let (true, Some(channel)) = (placed, self.channels.get_mut(scanner)) {
                channel.pending = false;
            }
        }
    }

    /// Keeps the newest usable command; anything unusable silences the channel until a newer one.
    pub(super) fn take_command(&mut self, reading: &Reading<Command>, now: Instant) {
        let command = match reading {
            Reading::Absent => return,
            Reading::Malformed => {
                self.command = None;
                self.command_fault = Some(Reason::CommandMalformed);
                return;
            }
            Reading::Value(command) => *command,
        };
        match watch::order(command.stamp, self.command_stamp, now) {
            Order::Future => {
                self.command = None;
                self.command_fault = Some(Reason::CommandFuture);
            }
            Order::Older => {
                self.command = None;
                self.command_fault = Some(Reason::CommandReordered);
            }
            // The same command again says nothing new, not even that it is still wanted.
            Order::Same => {}
            Order::Newer => {
                self.command = Some(command);
                self.command_stamp = Some(command.stamp);
                self.command_fault = None;
            }
        }
    }

    /// Brings all known points and all known space to the pose of the newest odometry.
    pub(super) fn refresh_memory(&mut self) {
        let (Some(pose), Some(newest)) = (self.track.pose(), self.track.newest()) else {
            return;
        };
        let (stamp, odometer) = (newest.stamp, self.track.odometer());
        self.memory.age(self.config.memory(), stamp, odometer);
        self.memory.occupy(pose, self.config.tube().footprint);
        self.memory
            .refresh(self.config.memory(), pose, stamp, odometer);
    }

    /// Ages, missing channels, frozen scans, the critical zone, and whether the drive follows.
    pub(super) fn watch(&self, now: Instant, hazard: &mut Worst) {
        let config = self.config.config();
        let timing = &config.timing;
        for (channel, setup) in self.channels.iter().zip(&config.scanners) {
            if setup.is_none() {
                continue;
            }
            match channel.accepted {
                //= spec/fresh.md#fresh-06
                //# The kernel MUST stop while any configured scanner, or the odometry, has never delivered a usable
                //# value.
                None => hazard.add(Reason::ScanMissing),
                //= spec/fresh.md#fresh-01
                //# The kernel MUST stop while the newest usable scan of any configured scanner is older than
                //# `scan_age_max`.
                Some(stamp) => hazard.add_if(
                    watch::is_stale(stamp, now, timing.scan_age_max),
                    Reason::ScanStale,
                ),
            }
            hazard.add_if(channel.frozen, Reason::ScanFrozen);
        }
        let Some(newest) = self.track.newest() else {
            return hazard.add(Reason::OdometryMissing);
        };
        //= spec/fresh.md#fresh-02
        //# The kernel MUST stop while the newest usable odometry is older than `odometry_age_max`.
        hazard.add_if(
            watch::is_stale(newest.stamp, now, timing.odometry_age_max),
            Reason::OdometryStale,
        );
        let since = newest
            .stamp
            .minus(timing.tracking_window)
            .minus(timing.actuation_latency);
        //= spec/input.md#input-13
        //# The kernel MUST stop when the measured twist has left the hull of the recent set points by more than the
        //# follow tolerances for the tracking window.
        hazard.add_if(
            !self
                .pipeline
                .explains(newest.twist, since, &config.tolerances),
            Reason::DriveMismatch,
        );
        hazard.add_if(self.point_in_zone(), Reason::CriticalZone);
    }

    /// The critical zone in the body frame, mm, outward.
    //= spec/zone.md#zone-02
    //# The critical zone MUST be the footprint grown by the front margin ahead of the front edge and by the side
    //# margin on every other side.
    fn zone(&self) -> Rect {
        let config = self.config.config();
        let um = |length: crate::units::Length| magnitude(length.as_um());
        let outline = &config.footprint;
        let mm = |edge: u64, margin: u64| eighths_up(edge.saturating_add(margin)) >> 3;
        Rect {
            front: mm(um(outline.front), um(config.zone.front)),
            rear: mm(um(outline.rear), um(config.zone.side)),
            left: mm(um(outline.left), um(config.zone.side)),
            right: mm(um(outline.right), um(config.zone.side)),
        }
    }

    /// Whether a known point lies in the critical zone, also one that no scan shows.
    fn point_in_zone(&self) -> bool {
        let zone = self.zone();
        self.memory.clouds().flatten().any(|point| {
            zone.contains(crate::geometry::frame::PointMm {
                x: i32::from(point.x_mm),
                y: i32::from(point.y_mm),
            })
        })
    }
}

impl<const B: usize> Channel<B> {
    /// Compares a scan with its predecessor: real scanners never repeat themselves while moving.
    fn note_content(&mut self, beams: &[Beam], odometer: crate::odometry::Odometer) {
        let fingerprint = watch::fingerprint(beams);
        if fingerprint != self.fingerprint || !watch::has_returns(beams) {
            self.fingerprint = fingerprint;
            self.fingerprint_since = odometer;
            self.frozen = false;
            return;
        }
        let travelled = odometer
            .travelled_um
            .saturating_sub(self.fingerprint_since.travelled_um);
        let turned = odometer
            .turned_urad
            .saturating_sub(self.fingerprint_since.turned_urad);
        //= spec/fresh.md#fresh-07
        //# The kernel MUST stop when scans repeat bit by bit although the robot moves.
        self.frozen |= travelled > FROZEN_TRAVEL_UM || turned > FROZEN_TURN_URAD;
    }

    /// Keeps a scan until the odometry covers it; a newer one replaces it.
    fn hold(&mut self, beams: &[Beam], stamp: Instant) {
        for (slot, &beam) in self.beams.iter_mut().zip(beams) {
            *slot = beam;
        }
        self.beams_stamp = Some(stamp);
        self.pending = true;
    }
}
