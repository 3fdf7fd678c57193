//! Progress on standard error: only on a terminal, and only for work that lasts over a second.

use abbe::{Cancelled, Monitor};
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Silence before the first word.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between two words.
const PACE: Duration = Duration::from_millis(100);

/// Progress of a long computation.
pub(crate) struct Progress {
    total: usize,
    visible: bool,
    begun: Instant,
    state: Mutex<State>,
}

struct State {
    done: usize,
    next: Instant,
    shown: bool,
}

impl Progress {
    /// Starts at 0 of `total` steps (0: not known); `quiet` prints nothing.
    pub(crate) fn new(total: usize, quiet: bool) -> Self {
        let begun = Instant::now();
        let state = State { done: 0, next: begun + PATIENCE, shown: false };
        Self { total, begun, visible: !quiet && std::io::stderr().is_terminal(), state: Mutex::new(state) }
    }

    /// Adds `count` finished steps.
    pub(crate) fn add(&self, count: usize) {
        if !self.visible {
            return;
        }
        let Ok(mut state) = self.state.lock() else { return };
        state.done += count;
        let now = Instant::now();
        if now >= state.next {
            state.next = now + PACE;
            state.shown = true;
            let _ = write!(std::io::stderr(), "\r{}\x1b[K", words(now - self.begun, state.done, self.total));
        }
    }
}

/// What is said of a stage; of one whose length is not known, what is done.
fn words(elapsed: Duration, done: usize, total: usize) -> String {
    if total == 0 {
        return format!("{done} steps in {} s", elapsed.as_secs());
    }
    format!("{:3} % of {total}, {} remaining", 100 * done / total, remaining(elapsed, done, total))
}

/// Estimate of the remaining time at the pace so far: `45 s`, `12 min`, `3.5 h`.
fn remaining(elapsed: Duration, done: usize, total: usize) -> String {
    let seconds = elapsed.as_secs_f64() * (total.saturating_sub(done)) as f64 / done.max(1) as f64;
    match seconds {
        s if s < 90.0 => format!("{} s", s.ceil()),
        s if s < 5400.0 => format!("{} min", (s / 60.0).ceil()),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Clears the line: further output begins on an empty one.
impl Drop for Progress {
    fn drop(&mut self) {
        if self.state.get_mut().is_ok_and(|state| state.shown) {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}

/// The progress of the stages of a call, one after the other.
pub(crate) struct ProgressBar {
    quiet: bool,
    stage: Mutex<Option<Arc<Progress>>>,
}

impl ProgressBar {
    /// Starts the display; `quiet` prints nothing.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, stage: Mutex::new(None) }
    }

    fn stage(&self) -> MutexGuard<'_, Option<Arc<Progress>>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Monitor for ProgressBar {
    fn begin(&self, total: usize) {
        *self.stage() = Some(Arc::new(Progress::new(total, self.quiet)));
    }

    fn advance(&self, steps: usize) -> Result<(), Cancelled> {
        let stage = self.stage().clone();
        if let Some(stage) = stage.filter(|_| steps > 0) {
            stage.add(steps);
        }
        Ok(())
    }

    fn end(&self) {
        *self.stage() = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_per_step_as_what_is_done() {
        let left = |seconds, done, total| remaining(Duration::from_secs(seconds), done, total);
        assert_eq!(
            [left(10, 1, 4), left(60, 1, 11), left(3600, 1, 3), left(5, 7, 7)],
            ["30 s", "10 min", "2.0 h", "0 s"]
        );
        assert_eq!(left(1, 0, 5), "5 s");
        let said = |done, total| words(Duration::from_secs(10), done, total);
        assert_eq!([said(1, 4), said(7000, 0)], [" 25 % of 4, 30 s remaining", "7000 steps in 10 s"]);
    }
}
