//! Progress on standard error: only on a terminal, and only for work that lasts over a second. What long work will
//! cost is said anywhere.

use super::view::folded;
use abbe::{Cancelled, Monitor};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Duration of a stage before its progress is shown.
const PATIENCE: Duration = Duration::from_secs(1);

/// Updates per second.
const PACE: u8 = 10;

/// Line of a stage whose number of steps is known.
const KNOWN: &str = "{msg}: {percent} % of {len}, {eta} remaining";

/// Line of a stage whose number of steps is not known.
const UNKNOWN: &str = "{msg}: {pos} in {elapsed}";

/// The progress of the stages of a call, one after the other.
pub(crate) struct StageProgress {
    quiet: bool,
    visible: bool,
    stage: Mutex<Option<ProgressBar>>,
    /// The last announcement, which is not repeated.
    said: Mutex<String>,
}

impl StageProgress {
    /// Starts the display; `quiet` prints nothing.
    pub(crate) fn new(quiet: bool) -> Self {
        let visible = !quiet && std::io::stderr().is_terminal();
        Self { quiet, visible, stage: Mutex::new(None), said: Mutex::default() }
    }

    fn stage(&self) -> MutexGuard<'_, Option<ProgressBar>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns a display of `total` steps (0: not known) of a phase. It is hidden, and clears its line when it is dropped.
fn hidden_bar(phase: &str, total: usize) -> ProgressBar {
    let length = (total > 0).then_some(total as u64);
    let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::hidden()).with_finish(ProgressFinish::AndClear);
    let bar = bar.with_message(phase.to_owned());
    match ProgressStyle::with_template(if total > 0 { KNOWN } else { UNKNOWN }) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

impl Monitor for StageProgress {
    fn announce(&self, cost: &str) {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.quiet && *said != cost {
            // Who cannot be told is not told.
            let _ = write!(std::io::stderr(), "{}", folded(cost));
            cost.clone_into(&mut said);
        }
    }

    fn begin(&self, phase: &str, total: usize) {
        *self.stage() = self.visible.then(|| hidden_bar(phase, total));
    }

    fn advance(&self, steps: usize) -> Result<(), Cancelled> {
        let Some(bar) = self.stage().clone() else { return Ok(()) };
        bar.inc(steps as u64);
        if bar.is_hidden() && bar.elapsed() >= PATIENCE {
            bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(PACE));
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
    fn both_lines_are_templates_and_steps_are_counted() {
        assert!([KNOWN, UNKNOWN].iter().all(|line| ProgressStyle::with_template(line).is_ok()));
        let bar = hidden_bar("poses", 4);
        bar.inc(1);
        assert_eq!((bar.position(), bar.length(), bar.is_hidden()), (1, Some(4), true));
        assert_eq!((bar.message().as_str(), hidden_bar("poses", 0).length()), ("poses", None));
    }
}
