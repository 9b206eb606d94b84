//! One screen while driving; a log of changes where there is no screen.

use super::state;
use console::Term;
use haltline_drives::control::Tick;
use haltline_drives::drive::Fault;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A fault that stays is said again after this.
const AGAIN: Duration = Duration::from_secs(5);
/// How often the screen is drawn, and a line written where nothing changes.
const SCREEN: Duration = Duration::from_millis(200);
const LOG: Duration = Duration::from_secs(1);

/// Messages that wait for a reader; more are lost. A terminal that is held (Ctrl-S) or a pipe that
/// nobody empties must not hold the loop that drives a robot.
const WAITING: usize = 64;

/// Something to be written.
enum Message {
    /// Takes the place of the screen before.
    Screen(String),
    /// A line of the log.
    Line(String),
    /// A line on standard error.
    Note(String),
}

/// What the operator sees.
pub struct Status {
    out: Printer,
    is_term: bool,
    width: usize,
    drawn: Option<Instant>,
    before: String,
    /// What the operator can do was said.
    hinted: bool,
    /// What was wrong last with drive and scanner, and when.
    faults: [Option<(String, Instant)>; 2],
}

impl Status {
    /// Nothing shown yet.
    pub fn new() -> Self {
        let term = Term::stdout();
        Self {
            is_term: term.is_term(),
            // A line that wraps would count as one and leave the rest behind.
            width: usize::from(term.size().1).max(20) - 1,
            out: Printer::new(print),
            drawn: None,
            before: String::new(),
            hinted: false,
            faults: [None, None],
        }
    }

    /// Shows a tick. Whoever reads may have gone: the robot is more important.
    pub fn tick(&mut self, tick: &Tick<'_>) {
        // That it is not ready yet shows in its state.
        let of_drive = tick.fault.filter(|error| error.fault != Fault::NotReady);
        let news = [
            of_drive.map(|fault| fault.to_string()),
            tick.scan_fault.map(|fault| fault.to_string()),
        ];
        for (index, news) in news.into_iter().enumerate() {
            let Some(text) = news else { continue };
            let known = self.faults[index].as_ref();
            if !self.is_term
                && known.is_none_or(|(known, at)| *known != text || at.elapsed() > AGAIN)
            {
                self.say(&text);
            }
            self.faults[index] = Some((text, Instant::now()));
        }
        if self.is_term {
            self.screen(tick);
        } else {
            self.log(tick);
        }
    }

    fn is_due(&self, span: Duration) -> bool {
        self.drawn.is_none_or(|drawn| drawn.elapsed() >= span)
    }

    fn screen(&mut self, tick: &Tick<'_>) {
        if !self.is_due(SCREEN) {
            return;
        }
        let mut text = tick.to_string();
        for (who, fault) in ["drive", "scanner"].iter().zip(&self.faults) {
            if let Some((fault, at)) = fault {
                text += &format!(
                    "last fault of the {who}, {} s ago: {fault}\n",
                    at.elapsed().as_secs()
                );
            }
        }
        if let Some(hint) = hint(tick) {
            text += &format!("{hint}\n");
        }
        text += "Ctrl-C stops and ends\n";
        let cut = |line: &str| line.chars().take(self.width).collect::<String>() + "\n";
        self.out
            .put(Message::Screen(text.lines().map(cut).collect()));
        self.drawn = Some(Instant::now());
    }

    fn log(&mut self, tick: &Tick<'_>) {
        let decision = &tick.decision;
        let route = tick
            .said
            .as_ref()
            .map_or("", |said| said.progress.kind.as_str());
        let now = format!(
            "{} {:?} {:?} {:?} {route}",
            state(tick.state),
            decision.status,
            decision.action,
            decision.reason
        );
        let hint = hint(tick);
        if let Some(hint) = hint.as_ref().filter(|_| !self.hinted) {
            self.say(hint);
        }
        self.hinted = hint.is_some();
        if now == self.before && !self.is_due(LOG) {
            return;
        }
        let [x, y, theta] = tick.feedback.pose;
        let [v, w] = tick.feedback.twist;
        self.out.put(Message::Line(format!(
            "{:9.3} s  ({x:+.3}, {y:+.3}) m {:+.1} deg  {v:+.3} m/s {w:+.3} rad/s  {now}",
            tick.now.as_us() as f64 * 1e-6,
            theta.to_degrees()
        )));
        self.before = now;
        self.drawn = Some(Instant::now());
    }

    /// A message of its own line.
    pub fn say(&mut self, message: &str) {
        self.out.put(Message::Note(message.to_owned()));
    }

    /// Waits until all of it is written; the last screen stays.
    pub fn end(self) {
        self.out.end();
    }
}

/// Writes in a thread of its own.
struct Printer {
    sender: SyncSender<Message>,
    thread: JoinHandle<()>,
}

impl Printer {
    fn new(print: impl FnOnce(&Receiver<Message>) + Send + 'static) -> Self {
        let (sender, receiver) = sync_channel(WAITING);
        let thread = std::thread::spawn(move || print(&receiver));
        Self { sender, thread }
    }

    /// Never waits: what there is no room for is lost.
    fn put(&self, message: Message) {
        let _ = self.sender.try_send(message);
    }

    fn end(self) {
        drop(self.sender);
        let _ = self.thread.join();
    }
}

fn print(messages: &Receiver<Message>) {
    let term = Term::stdout();
    // Lines of the screen drawn last.
    let mut lines = 0;
    for message in messages {
        match message {
            Message::Screen(text) => {
                let _ = term.clear_last_lines(lines);
                let _ = term.write_str(&text);
                lines = text.lines().count();
            }
            Message::Line(text) => say!("{text}"),
            Message::Note(text) => {
                eprintln!("{text}");
                lines = 0;
            }
        }
    }
}

/// What the operator can do, when everything waits for that.
fn hint(tick: &Tick<'_>) -> Option<String> {
    tick.waits_for_operator().then(|| {
        format!(
            "stopped until the operator resets: look around the robot, then write reset and Enter, \
             or kill -USR1 {}",
            std::process::id()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A terminal that takes nothing: whoever drives goes on all the same.
    #[test]
    fn a_reader_who_does_not_read_holds_nobody() {
        let (reads, told) = sync_channel(1);
        let printer = Printer::new(move |messages: &Receiver<Message>| {
            let _ = told.recv();
            assert_eq!(messages.iter().count(), WAITING, "the rest is lost");
        });
        for _ in 0..100 * WAITING {
            printer.put(Message::Line(String::new()));
        }
        assert!(reads.send(()).is_ok());
        drop(printer.sender);
        assert!(printer.thread.join().is_ok());
    }
}
