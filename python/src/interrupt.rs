//! Long calls: they run on a pool without the interpreter's lock, and Ctrl-C ends them.

use crate::pools::pool;
use abbe::{Cancellation, Cancelled, Monitor};
use pyo3::panic::PanicException;
use pyo3::prelude::*;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often a waiting call looks for signals.
const PATIENCE: Duration = Duration::from_millis(50);

/// What a waiting call knows of the progress of its job, and the flag that ends it.
#[derive(Clone, Default)]
pub struct Progress {
    cancellation: Cancellation,
    steps: Arc<Mutex<Steps>>,
}

/// The stage of a job.
#[derive(Clone, Default)]
struct Steps {
    phase: String,
    done: usize,
    total: usize,
    told: bool,
}

impl Progress {
    fn steps(&self) -> MutexGuard<'_, Steps> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls back with phase, steps done and their number, if they changed.
    fn tell(&self, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let Some(callback) = callback else { return Ok(()) };
        let mut steps = self.steps();
        if steps.told || steps.phase.is_empty() {
            return Ok(());
        }
        steps.told = true;
        let Steps { phase, done, total, .. } = steps.clone();
        drop(steps);
        Python::attach(|py| callback.call1(py, (phase, done, total)).map(drop))
    }
}

impl Monitor for Progress {
    fn begin(&self, phase: &str, total: usize) {
        *self.steps() = Steps { phase: phase.to_owned(), done: 0, total, told: false };
    }

    fn advance(&self, count: usize) -> Result<(), Cancelled> {
        if count > 0 {
            let mut steps = self.steps();
            (steps.done, steps.told) = (steps.done + count, false);
        }
        self.cancellation.advance(count)
    }
}

/// Runs a job on a pool of threads. Ctrl-C ends the call at once; the job ends when it next reports progress.
pub fn run_owned<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    callback: Option<Py<PyAny>>,
    job: impl FnOnce(&Progress) -> T + Send + 'static,
) -> PyResult<T> {
    let progress = Progress::default();
    let (sender, receiver) = channel();
    let inner = progress.clone();
    // Nobody waits any more after an interrupt.
    pool(threads)?.spawn(move || drop(sender.send(job(&inner))));
    py.detach(move || wait(&receiver, &progress.cancellation, true, &|| progress.tell(callback.as_ref())))
}

/// Runs a job that borrows, and waits for its end: Ctrl-C is passed on, and the job looks for it.
pub fn run_borrowed<T: Send>(
    py: Python<'_>,
    threads: usize,
    job: impl FnOnce(&Cancellation) -> T + Send,
) -> PyResult<T> {
    let (pool, cancellation) = (pool(threads)?, Cancellation::default());
    py.detach(|| {
        let (sender, receiver) = channel();
        pool.in_place_scope(|scope| {
            scope.spawn(|_| drop(sender.send(job(&cancellation))));
            wait(&receiver, &cancellation, false, &|| Ok(()))
        })
    })
}

/// Waits for the end of a job; after an interrupt only if the job is not to be left alone.
/// `tell` hears of the progress between two looks for signals, and at the end.
fn wait<T>(
    receiver: &Receiver<T>,
    cancellation: &Cancellation,
    leave: bool,
    tell: &dyn Fn() -> PyResult<()>,
) -> PyResult<T> {
    let mut interrupt = Ok(());
    loop {
        match receiver.recv_timeout(PATIENCE) {
            Ok(ended) => return interrupt.and_then(|()| tell()).map(|()| ended),
            Err(RecvTimeoutError::Disconnected) => {
                interrupt?;
                return Err(PanicException::new_err("the job broke off"));
            }
            Err(RecvTimeoutError::Timeout) if interrupt.is_ok() => {
                interrupt = Python::attach(|py| py.check_signals()).and_then(|()| tell());
                if let Err(interrupt) = &interrupt {
                    cancellation.ask();
                    if leave {
                        return Err(Python::attach(|py| interrupt.clone_ref(py)));
                    }
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}
