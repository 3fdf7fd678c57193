//! Long calls: they run on a pool without the interpreter's lock, and Ctrl-C ends them.

use crate::pools::pool;
use abbe::Cancellation;
use pyo3::panic::PanicException;
use pyo3::prelude::*;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// How often a waiting call looks for signals.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs a job on a pool of threads. Ctrl-C ends the call at once; the job ends when it next reports progress.
pub fn run_owned<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    job: impl FnOnce(&Cancellation) -> T + Send + 'static,
) -> PyResult<T> {
    let cancellation = Cancellation::default();
    let (sender, receiver) = channel();
    let inner = cancellation.clone();
    // Nobody waits any more after an interrupt.
    pool(threads)?.spawn(move || drop(sender.send(job(&inner))));
    py.detach(move || wait(&receiver, &cancellation, true))
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
            wait(&receiver, &cancellation, false)
        })
    })
}

/// Waits for the end of a job; after an interrupt only if the job is not to be left alone.
fn wait<T>(receiver: &Receiver<T>, cancellation: &Cancellation, leave: bool) -> PyResult<T> {
    let mut interrupt = Ok(());
    loop {
        match receiver.recv_timeout(PATIENCE) {
            Ok(ended) => return interrupt.map(|()| ended),
            Err(RecvTimeoutError::Disconnected) => {
                interrupt?;
                return Err(PanicException::new_err("the job broke off"));
            }
            Err(RecvTimeoutError::Timeout) if interrupt.is_ok() => {
                interrupt = Python::attach(|py| py.check_signals());
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
