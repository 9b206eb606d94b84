//! What the robot says of itself.

use haltline::time::Instant;

use super::Seekur;
use crate::arcos::Sip;
use crate::arcos::config::{Config, text};
use crate::arcos::sip::{Bumpers, Flags, RADIANS_PER_COUNT, Tail};

impl Seekur {
    pub(super) fn config(&self) -> Config {
        Config {
            class: text(b"Pioneer"),
            subclass: text(b"seekurjr"),
            serial: text(b"emulated"),
            rotation_top_degps: Some(80),
            speed_top_mmps: Some(1200),
            rotation_acceleration_top_degps2: Some(300),
            acceleration_top_mmps2: Some(2000),
            sip_cycle_ms: Some(self.model.sip_cycle_ms),
            watchdog_ms: Some(self.model.watchdog_ms),
            rotation_max_degps: Some(80),
            speed_max_mmps: Some(1200),
            rotation_acceleration_degps2: Some(57),
            rotation_deceleration_degps2: Some(57),
            acceleration_mmps2: Some(500),
            deceleration_mmps2: Some((self.model.braking[0] * 1e3) as u16),
            front_bumpers: Some(4),
            rear_bumpers: Some(4),
            has_gyro: Some(true),
            low_battery_decivolts: Some(220),
            low_charge_percent: Some(10),
        }
    }

    pub(super) fn sip(&self, now: Instant) -> Sip {
        let count = |metres: f64| (metres * 1e3).round() as i64 as u16 & 0x7FFF;
        let heading = (self.counted[2] / RADIANS_PER_COUNT).round() as i64;
        let half = self.wheels[1] / 0.0056;
        let side = |mmps: f64| mmps.round() as i16;
        let moving = self.wheels.iter().any(|value| value.abs() > 1e-3);
        Sip {
            moving,
            x: count(self.counted[0]),
            y: count(self.counted[1]),
            heading: heading.rem_euclid(4096) as i16,
            left: side(self.wheels[0] * 1e3 - half),
            right: side(self.wheels[0] * 1e3 + half),
            battery_decivolts: 255,
            bumpers: Bumpers(if self.bumper { 1 << 9 } else { 0 }),
            flags: Flags(u16::from(self.motors)),
            tail: Tail {
                battery_decivolts: Some(262),
                charge_state: Some(0),
                rotation_decidegps: Some((self.wheels[1].to_degrees() * 10.0).round() as i16),
                faults: Some(0),
                lateral_mmps: Some(0),
                temperature_c: Some(-127),
                charge_percent: Some(87),
                clock_us: Some(now.as_us() as u32),
                flags3: None,
            },
            ..Sip::default()
        }
    }
}
