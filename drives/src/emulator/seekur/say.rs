//! What the robot says of itself, field after field as the sheet lists them.

use haltline::time::Instant;

use super::Seekur;
use super::wire::Data;

/// Flags of the standard packet.
const MOTORS: i64 = 1;
const STOP_BUTTON: i64 = 1 << 5;
const E_STALL: i64 = 1 << 6;

impl Seekur {
    /// Echo of SYNC2: name, class, subclass.
    pub(super) fn identity(&self) -> Vec<u8> {
        let mut data = Data::default();
        data.text("Haltline").text("Pioneer").text("seekurjr");
        data.packet(2)
    }

    pub(super) fn config(&self) -> Vec<u8> {
        let mut data = Data::default();
        data.text("Pioneer").text("seekurjr").text("emulated");
        data.byte(0).words(&[80, 1200, 300, 2000, 1000]); // RotVelTop .. PwmMax
        data.text("Haltline").byte(self.model.sip_cycle_ms);
        data.byte(2).byte(0); // HostBaud, Aux1Baud
        data.words(&[0, 0]).byte(0); // HasGripper, FrontSonar, RearSonar
        data.words(&[220, 32_550, i64::from(self.model.watchdog_ms)]); // LowBattery, RevCount
        data.byte(1).words(&[200, 100, 500, 50]); // P2Mpacs, StallVal .. JoyRotVel
        data.words(&[80, 1200, 57, 57, 40, 20, 0]); // RotVelMax .. RotKi
        data.words(&[500, (self.model.braking[0] * 1e3) as i64, 40, 30, 0]); // TransAcc .. TransKi
        data.byte(4).byte(4).byte(0).byte(0).byte(0).byte(1); // FrontBumps .. HasGyro
        data.word(0).byte(0).byte(0).words(&[138, 210]); // DriftFactor .. ShutdownVoltage
        data.text("1.0").words(&[0, 0]).byte(0); // firmware, GyroCW, GyroCCW, KinematicsDelay
        data.words(&[0, 0, 0, 0, 0, 260]).byte(0); // lateral limits, ChargeThreshold, PDBPort
        data.word(0).byte(60).word(0).byte(2); // GyroRateLimit .. BatteryType
        data.words(&[10, 5]).text("boot"); // LowSOC, ShutdownSOC, bootloader version
        data.packet(0x20)
    }

    pub(super) fn sip(&self, now: Instant) -> Vec<u8> {
        let count = |metres: f64| (metres * 1e3).round() as i64 % 0x8000;
        let heading = (self.counted[2] * 4096.0 / std::f64::consts::TAU).round() as i64;
        // Half the difference of both sides, mm/s: DiffConvFactor 0.0056.
        let half = self.wheels[1] / 0.0056;
        let side = |mmps: f64| mmps.round() as i64;
        let moving = self.wheels.iter().any(|value| value.abs() > 1e-3);
        let mut flags = if self.motors { MOTORS } else { 0 };
        if self.button {
            flags |= STOP_BUTTON;
        }
        if self.stalled {
            flags |= E_STALL;
        }
        let mut data = Data::default();
        data.words(&[count(self.counted[0]).rem_euclid(0x8000)]);
        data.words(&[count(self.counted[1]).rem_euclid(0x8000)]);
        data.words(&[heading.rem_euclid(4096)]);
        data.words(&[
            side(self.wheels[0] * 1e3 - half),
            side(self.wheels[0] * 1e3 + half),
        ]);
        data.byte(255); // a battery of 26 V does not fit
        data.word(if self.bumper { 1 << 9 } else { 0 });
        data.words(&[0, flags]).byte(0).byte(0); // CONTROL, FLAGS, COMPASS, no sonar
        data.byte(0).byte(0).byte(0).byte(0).byte(0); // gripper, ports
        data.word(262).byte(0); // BATTERYX10, not charging
        data.word((self.wheels[1].to_degrees() * 10.0).round() as i64); // ROTVEL
        data.words(&[0, 0]).byte(0x81).byte(87); // faults, LATVEL, -127 deg C, 87 %
        if self.model.tells_time {
            let clock_us = now.since(self.booted).unwrap_or_default().as_us() as i64;
            data.words(&[clock_us, clock_us / 65_536]);
        }
        data.packet(if moving { 0x33 } else { 0x32 })
    }
}
