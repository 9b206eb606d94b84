//! Broken adapters. Each wraps a good one and does one thing that has been done in earnest.

use haltline::decision::Decision;
use haltline::input::{Motion, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::{AngularSpeed, Curvature, Speed};

use crate::drive::{Drive, DriveError, Feedback, State};

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// Sends a motion as soon as it is asked, connected or not.
    MovesAtOnce,
    /// Repeats the last decision for ever.
    NeverExpires,
    /// Ends an expired decision with a zero instead of a ramp.
    StopsSuddenly,
    /// Ramps the speed and forgets the turn.
    RampsSpeedOnly,
    /// Says again what it said last, once it can speak again.
    RepeatsOld,
    /// Once it has driven it believes that it may drive.
    IgnoresGaps,
    /// Limits speed and turn each for itself.
    CutsApart,
    /// Left is right.
    Mirrored,
    /// Takes radians for degrees, or millimetres for centimetres.
    WrongScale,
    /// Reports the motion with the wrong sign.
    FeedbackMirrored,
    /// Takes any bytes for a reason to move.
    TrustsNoise,
}

/// Every twin with the check that must catch it, by name.
pub const TWINS: &[(Twin, &str)] = &[
    (Twin::MovesAtOnce, "no motion before handshake and enable"),
    (
        Twin::NeverExpires,
        "stop on the wire within one period, as a ramp on the same curvature",
    ),
    (
        Twin::StopsSuddenly,
        "stop on the wire within one period, as a ramp on the same curvature",
    ),
    (
        Twin::RampsSpeedOnly,
        "stop on the wire within one period, as a ramp on the same curvature",
    ),
    (
        Twin::RepeatsOld,
        "zero first after gaps, pauses, reconnections and reboots",
    ),
    (
        Twin::IgnoresGaps,
        "zero first after gaps, pauses, reconnections and reboots",
    ),
    (Twin::CutsApart, "saturation keeps the curvature"),
    (Twin::Mirrored, "sign and scale over the whole range"),
    (Twin::WrongScale, "sign and scale over the whole range"),
    (
        Twin::FeedbackMirrored,
        "feedback has the sign and scale of the motion",
    ),
    (Twin::TrustsNoise, "hostile bytes never move the robot"),
];

pub(super) fn wrap(twin: Twin, drive: Box<dyn Drive>, raw: Vec<u8>) -> Box<dyn Drive> {
    Box::new(Broken {
        twin,
        drive,
        raw,
        inject: Vec::new(),
        last: None,
        asked: Instant::from_us(0),
        ramp: None,
        driven: false,
    })
}

struct Broken {
    twin: Twin,
    drive: Box<dyn Drive>,
    raw: Vec<u8>,
    /// Bytes that go out before the good ones.
    inject: Vec<u8>,
    last: Option<Decision>,
    asked: Instant,
    ramp: Option<Instant>,
    driven: bool,
}

/// The motion with speed and turn changed.
fn changed(decision: &Decision, speed: impl Fn(i32) -> i32, turn: impl Fn(i32) -> i32) -> Decision {
    let setpoint = match decision.setpoint {
        Motion::Twist(twist) => Motion::Twist(Twist {
            linear: Speed::from_um_per_s(speed(twist.linear.as_um_per_s())),
            angular: AngularSpeed::from_urad_per_s(turn(twist.angular.as_urad_per_s())),
        }),
        Motion::Arc { linear, curvature } => Motion::Arc {
            linear: Speed::from_um_per_s(speed(linear.as_um_per_s())),
            curvature: Curvature::from_urad_per_m(turn(curvature.as_urad_per_m())),
        },
    };
    Decision {
        setpoint,
        ..*decision
    }
}

impl Broken {
    fn moves(decision: &Decision) -> bool {
        match decision.setpoint {
            Motion::Twist(twist) => twist != Twist::default(),
            Motion::Arc { linear, .. } => linear != Speed::ZERO,
        }
    }

    /// The last decision once more, changed, as if it were new.
    fn again(&mut self, now: Instant, change: impl Fn(&Decision, Duration) -> Decision) {
        let Some(last) = self.last else { return };
        if now <= last.expires {
            self.ramp = None;
            return;
        }
        let since = *self.ramp.get_or_insert(now);
        let mut decision = change(&last, now.since(since).unwrap_or_default());
        decision.expires = now.plus(Duration::from_ms(30));
        let _ = self.drive.send(&decision, now);
    }

    fn expire(&mut self, now: Instant) {
        match self.twin {
            Twin::NeverExpires => self.again(now, |last, _| *last),
            Twin::StopsSuddenly => self.again(now, |last, _| changed(last, |_| 0, |_| 0)),
            Twin::RampsSpeedOnly => self.again(now, |last, span| {
                let lost = i32::try_from(span.as_us() / 2).unwrap_or(i32::MAX);
                changed(last, |v| (v - lost).max(0), |turn| turn / 4 * 5)
            }),
            _ => {}
        }
    }
}

impl Drive for Broken {
    fn receive(&mut self, bytes: &[u8], now: Instant) {
        if self.twin == Twin::TrustsNoise && bytes.contains(&0x5A) {
            self.inject.extend_from_slice(&self.raw);
        }
        self.drive.receive(bytes, now);
    }

    fn send(&mut self, decision: &Decision, now: Instant) -> Result<(), DriveError> {
        if self.twin == Twin::MovesAtOnce && Self::moves(decision) {
            self.inject.extend_from_slice(&self.raw);
        }
        let late = now
            .since(self.asked)
            .is_some_and(|gap| gap > Duration::from_ms(150));
        if self.twin == Twin::RepeatsOld && late && self.last.is_some() {
            self.inject.extend_from_slice(&self.raw);
        }
        self.driven |= self.drive.state() == State::Driving;
        let resumes = self.driven && self.drive.state() != State::Driving;
        if self.twin == Twin::IgnoresGaps && resumes && Self::moves(decision) {
            self.inject.extend_from_slice(&self.raw);
        }
        self.asked = now;
        self.last = Some(*decision);
        let wrong = match self.twin {
            Twin::CutsApart => changed(
                decision,
                |v| v.clamp(-800_000, 800_000) / 2,
                |turn| turn.clamp(-900_000, 900_000),
            ),
            Twin::Mirrored => changed(decision, |v| v, |turn| -turn),
            Twin::WrongScale => changed(decision, |v| v / 10, |turn| turn),
            _ => *decision,
        };
        self.drive.send(&wrong, now)
    }

    fn tick(&mut self, now: Instant) {
        self.expire(now);
        self.drive.tick(now);
    }

    fn outgoing(&mut self, out: &mut [u8], now: Instant) -> usize {
        if self.inject.is_empty() {
            return self.drive.outgoing(out, now);
        }
        let count = self.inject.len().min(out.len());
        for (to, from) in out.iter_mut().zip(self.inject.drain(..count)) {
            *to = from;
        }
        count
    }

    fn feedback(&mut self) -> Option<Feedback> {
        let mut feedback = self.drive.feedback()?;
        if self.twin == Twin::FeedbackMirrored {
            feedback.twist[1] = -feedback.twist[1];
        }
        Some(feedback)
    }

    fn state(&self) -> State {
        self.drive.state()
    }

    fn fault(&mut self) -> Option<DriveError> {
        self.drive.fault()
    }

    fn enable(&mut self, now: Instant) {
        self.drive.enable(now);
    }

    fn reconnected(&mut self, now: Instant) {
        if self.twin == Twin::RepeatsOld {
            self.inject.extend_from_slice(&self.raw);
        }
        self.drive.reconnected(now);
    }

    fn shut_down(&mut self, now: Instant) {
        self.drive.shut_down(now);
    }
}
