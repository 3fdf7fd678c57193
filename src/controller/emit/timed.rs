//! The time of templates of one's own: fuel bounds their steps, not what a step costs.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Processor time that the templates of a set may take together: many times what the largest set needs.
const MOST: Duration = Duration::from_secs(10);

/// How often the time is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// Room for the recursion that the engine allows.
const STACK: usize = 16 << 20;

/// Microseconds that the templates of the set have taken so far.
static SPENT: AtomicU64 = AtomicU64::new(0);

/// A template that was given up goes on in its thread until the program ends: no other is begun.
const GIVEN_UP: u64 = u64::MAX;

/// A new set begins.
pub(crate) fn afresh() {
    if SPENT.load(Ordering::Relaxed) != GIVEN_UP {
        SPENT.store(0, Ordering::Relaxed);
    }
}

/// Does the work of a template, if it does not take too long.
pub(crate) fn within<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, String> + Send + 'static,
) -> Result<T, String> {
    let late = || Err(format!("its templates ran for more than {} s of processor time", MOST.as_secs()));
    let spent = SPENT.load(Ordering::Relaxed);
    let Some(left) = MOST.checked_sub(Duration::from_micros(spent)) else { return late() };
    let (sender, receiver) = channel();
    let start = clock();
    let work = move || drop(sender.send(work()));
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(work);
    worker.map_err(|failure| format!("there is no thread for a template: {failure}"))?;
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(result) => {
                let taken = u64::try_from(clock().saturating_sub(start).as_micros()).unwrap_or(GIVEN_UP);
                SPENT.store(spent.saturating_add(taken), Ordering::Relaxed);
                return result;
            }
            Err(RecvTimeoutError::Disconnected) => return Err("the template engine broke off".to_owned()),
            Err(RecvTimeoutError::Timeout) if clock().saturating_sub(start) > left => {
                SPENT.store(GIVEN_UP, Ordering::Relaxed);
                return late();
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Processor time of the program: waiting for a busy machine does not count.
#[cfg(unix)]
fn clock() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ProcessCPUTime)).unwrap_or_default()
}

/// Time since the first look, where processor time is not known.
#[cfg(not(unix))]
fn clock() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}
