//! What an adapter promises: decisions in, feedback out, time as an argument, no blocking.
//!
//! An adapter is a state machine between a caller, who has the clock and the link, and a wire. It
//! is handed what arrived and asked what to send. It refuses to turn anything into a motion but a
//! decision that is in force, on a link that was shaken hands on, to a drive that says it is
//! enabled.

use core::fmt;

use haltline::convert;
use haltline::decision::Decision;
use haltline::input::{Odometry, Reading};
use haltline::time::Instant;

use crate::uc::command::Command;

/// A drive behind a byte stream.
///
/// Call [`Drive::receive`] with whatever arrived, [`Drive::send`] once per control period with the
/// kernel's decision, [`Drive::tick`] as often as convenient (every few milliseconds), and write
/// what [`Drive::outgoing`] gives.
pub trait Drive {
    /// Takes bytes from the wire, however they were split or joined.
    fn receive(&mut self, bytes: &[u8], now: Instant);

    /// Takes the decision of this control period and puts its set point, or a safer one, on the
    /// wire.
    ///
    /// # Errors
    /// The set point is not what is sent: the drive is not ready, or it cannot follow the motion.
    /// What is sent instead is a stop.
    fn send(&mut self, decision: &Decision, now: Instant) -> Result<(), DriveError>;

    /// Lets time pass: handshake, keep-alive, and the stop when no decision is in force.
    fn tick(&mut self, now: Instant);

    /// Copies bytes for the wire into `out` and returns how many; call again until it is 0.
    fn outgoing(&mut self, out: &mut [u8], now: Instant) -> usize;

    /// The newest feedback, once.
    fn feedback(&mut self) -> Option<Feedback>;

    /// How far the adapter is.
    fn state(&self) -> State;

    /// Something went wrong since the last call; the newest if it was more than one thing.
    fn fault(&mut self) -> Option<DriveError>;

    /// The operator wants the motors on; without effect before the handshake is through.
    fn enable(&mut self, now: Instant);

    /// The link is gone or new: everything starts again, and nothing old is sent.
    fn reconnected(&mut self, now: Instant);

    /// Ends the drive: ramps down, switches the motors off and says good-bye.
    fn shut_down(&mut self, now: Instant);
}

/// How far an adapter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Shaking hands; no motion command has been sent.
    Connecting,
    /// The drive answers; its motors are off.
    Disabled,
    /// Motors are on; zero is sent until a decision asks for rest.
    Holding,
    /// Decisions are sent.
    Driving,
    /// Ramping down for good.
    Closing,
    /// Nothing more is sent.
    Closed,
}

/// What the drive says of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feedback {
    /// When it was measured, on the host's clock.
    pub stamp: Instant,
    /// Pose in the odometry frame of the adapter, metres and radians.
    pub pose: [f64; 3],
    /// Speed and turn rate, m/s and rad/s, left positive.
    pub twist: [f64; 2],
    /// Battery, volts.
    pub battery_v: Option<f64>,
    /// Charge, percent.
    pub charge_percent: Option<u8>,
    /// Front and rear bumper segments that touch something.
    pub bumpers: [u8; 2],
}

impl Feedback {
    /// The feedback as the kernel takes it.
    #[must_use]
    pub fn odometry(&self) -> Reading<Odometry> {
        convert::odometry(self.stamp, self.pose, self.twist, None)
    }
}

/// Something that went wrong, with the frame it was seen in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveError {
    /// Where.
    pub frame: Frame,
    /// What.
    pub fault: Fault,
}

/// The frame an error was seen in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// A packet from an ARCOS server, by its type.
    ArcosServer(u8),
    /// A command to an ARCOS server, by its number.
    ArcosCommand(u8),
    /// Bytes between packets or messages.
    Stream,
    /// The answer of the control board to this command.
    Answer(Command),
    /// A message of the control board nobody asked for.
    Display,
    /// A data group of the control board, by its number.
    Group(u8),
    /// The decision of the kernel.
    Decision,
}

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A checksum does not fit, or it ended in the middle.
    Damaged,
    /// Longer than any valid one.
    TooLong,
    /// Well framed, but its content is not what its type says.
    Unreadable,
    /// Valid, but not now, or not the answer to this.
    Unexpected,
    /// The drive refused it with this code.
    Refused(u16),
    /// No answer came in time.
    NoAnswer,
    /// The drive has been silent for too long; motion is withheld.
    Silent,
    /// Nothing was sent for so long that the drive may have stopped by itself.
    Gap,
    /// The drive restarted.
    Reboot,
    /// The drive's dead-man time is not the wanted one (both in ms; 0 is off, 65535 not told).
    DeadMan {
        /// As the robot file says, at most.
        wanted_ms: u16,
        /// As the drive says.
        found_ms: u16,
    },
    /// The drive says that its motors are off.
    MotorsOff,
    /// The STOP button is pressed.
    StopButton,
    /// A bumper touches something.
    Bumper,
    /// A wheel is stalled.
    Stalled,
    /// The decision's kind of motion is not this drive's.
    WrongMotion,
    /// The wheels cannot be turned as far as the curvature asks.
    OutOfReach,
    /// The adapter is not ready to drive.
    NotReady,
    /// The decision had expired when it was handed over.
    Expired,
    /// Its feedback reports a motion that the drive cannot make.
    Impossible,
}

impl fmt::Display for DriveError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.frame {
            Frame::ArcosServer(id) => write!(out, "ARCOS packet 0x{id:02X}: ")?,
            Frame::ArcosCommand(number) => write!(out, "ARCOS command {number}: ")?,
            // Nobody has said anything: there are no bytes to speak of.
            Frame::Stream if self.fault == Fault::NoAnswer => {
                return write!(
                    out,
                    "nobody answers; is this the robot's port, at the right speed, and is it on?"
                );
            }
            Frame::Stream => write!(out, "stream of bytes: ")?,
            Frame::Answer(command) => {
                let line = command.encode();
                let text = core::str::from_utf8(line.as_slice()).unwrap_or_default();
                write!(out, "answer to {}: ", text.trim_end())?;
            }
            Frame::Display => write!(out, "message of the control board: ")?,
            Frame::Group(number) => write!(out, "data group {number}: ")?,
            Frame::Decision => write!(out, "decision: ")?,
        }
        match self.fault {
            Fault::Damaged => write!(out, "damaged"),
            Fault::TooLong => write!(out, "too long"),
            Fault::Unreadable => write!(out, "content does not fit its type"),
            Fault::Unexpected => write!(out, "not expected here"),
            Fault::Refused(code) => write!(out, "refused with error {code}"),
            Fault::NoAnswer => write!(out, "no answer in time"),
            Fault::Silent => write!(out, "the drive is silent; motion is withheld"),
            Fault::Gap => write!(out, "nothing was sent for too long; motion is withheld"),
            Fault::Reboot => write!(out, "the drive restarted; motion is withheld"),
            Fault::DeadMan {
                wanted_ms,
                found_ms,
            } => write!(
                out,
                "dead-man time is {found_ms} ms, the robot file allows {wanted_ms} ms at most"
            ),
            Fault::MotorsOff => write!(out, "motors are off"),
            Fault::StopButton => write!(out, "STOP button is pressed"),
            Fault::Bumper => write!(out, "a bumper touches something"),
            Fault::Stalled => write!(out, "a wheel is stalled"),
            Fault::WrongMotion => write!(out, "not a motion of this kind of drive"),
            Fault::OutOfReach => write!(out, "curvature is beyond the steering"),
            Fault::NotReady => write!(out, "the drive is not ready; zero is sent"),
            Fault::Expired => write!(out, "expired before it was handed over"),
            Fault::Impossible => write!(out, "reports a motion the drive cannot make"),
        }
    }
}

impl core::error::Error for DriveError {}

impl DriveError {
    pub(crate) const fn new(frame: Frame, fault: Fault) -> Self {
        Self { frame, fault }
    }
}
