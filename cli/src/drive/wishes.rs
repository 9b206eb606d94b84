//! Standard input: `reset` of the operator, and in shield mode somebody's commands.

use haltline::time::Instant;
use haltline_drives::clock::Clock;
use haltline_drives::control::Wish;
use std::io::BufRead;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The newest command, read by a thread of its own: the loop must not wait for anybody.
pub struct Wishes {
    newest: Arc<Mutex<Wish>>,
}

impl Wishes {
    /// Starts to read; `reset` is set by the line of that name.
    ///
    /// - `shield`: lines are commands, and their end is the end of the drive
    pub fn read(clock: Clock, reset: Arc<AtomicBool>, shield: bool) -> Self {
        let newest = Arc::new(Mutex::new(Wish::Nothing));
        let shared = Arc::clone(&newest);
        std::thread::spawn(move || {
            let put = |wish| *shared.lock().unwrap_or_else(PoisonError::into_inner) = wish;
            for (number, line) in std::io::stdin().lock().lines().enumerate() {
                let Ok(line) = line else { break };
                if line.trim() == "reset" {
                    reset.store(true, Ordering::Relaxed);
                    continue;
                }
                let understood = match wish(&line, clock.now()) {
                    _ if !shield => Err(format!("{line:?}: write reset, or nothing")),
                    understood => understood,
                };
                match understood {
                    Ok(wish) => put(wish),
                    Err(message) => {
                        // A command that nobody understands is none: the kernel stops for it.
                        put(Wish::Nothing);
                        eprintln!("standard input:{}: {message}", number + 1);
                    }
                }
            }
            if shield {
                put(Wish::End);
            }
        });
        Self { newest }
    }

    /// What is wanted now; the kernel judges its age.
    pub fn newest(&self) -> Wish {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A line as a command taken at `now`.
fn wish(line: &str, now: Instant) -> Result<Wish, String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let numbers: Result<Vec<f64>, _> = words.iter().map(|word| word.parse()).collect();
    match numbers.as_deref() {
        Ok([v, turn]) => Ok(Wish::Motion(now, [*v, *turn])),
        _ => Err(format!(
            "{line:?} is no command; write m/s and rad/s (a steered robot: 1/m), such as 0.4 0.1"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_commands_or_errors() {
        let now = Instant::from_us(5);
        assert_eq!(wish(" 0.5  -0.1 ", now), Ok(Wish::Motion(now, [0.5, -0.1])));
        for bad in ["", "0.5", "a b", "1 2 3", "0,5 1"] {
            assert!(wish(bad, now).is_err(), "{bad}");
        }
        // Not a number is the kernel's to refuse.
        assert!(matches!(wish("nan 0", now), Ok(Wish::Motion(_, [v, _])) if v.is_nan()));
    }
}
