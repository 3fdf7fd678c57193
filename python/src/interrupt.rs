//! Long calls: they run on a pool without the interpreter's lock, and Ctrl-C ends them.

use crate::pools::pool;
use abbe::{Cancellation, Cancelled};
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// How often a waiting call looks for signals.
const PATIENCE: Duration = Duration::from_millis(50);

type Ended<T> = Result<T, Box<dyn Any + Send>>;

/// Runs a job on a pool of threads. Ctrl-C ends the call at once; the job ends when it next reports progress.
pub fn run_owned<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    job: impl FnOnce(&Cancellation) -> T + Send + 'static,
) -> PyResult<T> {
    let cancellation = Cancellation::default();
    let (sender, receiver) = channel();
    let inner = cancellation.clone();
    pool(threads)?.spawn(move || {
        let ended = catch_unwind(AssertUnwindSafe(|| job(&inner)));
        // Nobody waits any more after an interrupt.
        drop(sender.send(ended));
    });
    let ended = py.detach(move || wait(&receiver, &cancellation, true));
    finished(ended)
}

/// Runs a job that borrows, and waits for its end: Ctrl-C is passed on, and the job looks for it.
pub fn run_borrowed<T: Send>(
    py: Python<'_>,
    threads: usize,
    job: impl FnOnce(&Cancellation) -> T + Send,
) -> PyResult<T> {
    let (pool, cancellation) = (pool(threads)?, Cancellation::default());
    let ended = py.detach(|| {
        let (sender, receiver) = channel();
        pool.in_place_scope(|scope| {
            scope.spawn(|_| drop(sender.send(catch_unwind(AssertUnwindSafe(|| job(&cancellation))))));
            wait(&receiver, &cancellation, false)
        })
    });
    finished(ended)
}

fn finished<T>(ended: PyResult<Ended<T>>) -> PyResult<T> {
    ended?.map_or_else(|payload| resume_unwind(payload), Ok)
}

/// Waits for the end of a job; after an interrupt only if the job is not to be left alone.
fn wait<T>(receiver: &Receiver<Ended<T>>, cancellation: &Cancellation, leave: bool) -> PyResult<Ended<T>> {
    let mut interrupt = Ok(());
    loop {
        match receiver.recv_timeout(PATIENCE) {
            Ok(ended) => return interrupt.map(|()| ended),
            Err(RecvTimeoutError::Disconnected) => return interrupt.map(|()| Err(Box::new(Cancelled) as _)),
            Err(RecvTimeoutError::Timeout) if interrupt.is_ok() => {
                interrupt = Python::attach(|py| py.check_signals());
                if interrupt.is_err() {
                    cancellation.ask();
                    if leave {
                        return interrupt.map(|()| Err(Box::new(Cancelled) as _));
                    }
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}
