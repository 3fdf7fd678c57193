//! Progress on standard error: only on a terminal, and only for what lasts over a second.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Silence before the first word.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between two words.
const PACE: Duration = Duration::from_millis(100);

/// How far a long computation has come.
pub(super) struct Progress {
    total: usize,
    visible: bool,
    state: Mutex<State>,
}

struct State {
    done: usize,
    next: Instant,
    shown: bool,
}

impl Progress {
    /// Of so many steps; `quiet` says nothing whatever happens.
    pub(super) fn new(total: usize, quiet: bool) -> Self {
        let state = State { done: 0, next: Instant::now() + PATIENCE, shown: false };
        Self { total, visible: !quiet && std::io::stderr().is_terminal(), state: Mutex::new(state) }
    }

    /// So many more are done.
    pub(super) fn add(&self, count: usize) {
        if !self.visible {
            return;
        }
        let Ok(mut state) = self.state.lock() else { return };
        state.done += count;
        let now = Instant::now();
        if now >= state.next {
            state.next = now + PACE;
            state.shown = true;
            let percent = 100 * state.done / self.total.max(1);
            let _ = write!(std::io::stderr(), "\r{percent:3} % of {}", self.total);
        }
    }
}

/// The line is taken back: what follows on the terminal begins on a clean one.
impl Drop for Progress {
    fn drop(&mut self) {
        if self.state.get_mut().is_ok_and(|state| state.shown) {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}
