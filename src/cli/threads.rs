//! The pool of threads. A system may have no threads to give (`pids.max`, little address space): then the run does with
//! the one that is there.

use rayon::{ThreadBuilder, ThreadPoolBuilder};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

/// Starts the pool with so many threads, in the thread that does the run. The results are the same with any number.
pub(super) fn start(jobs: Option<u16>) {
    let pool = match waiting(thread_count(jobs)).filter(|threads| !threads.is_empty()) {
        // Once the pool has begun to start threads of its own, it cannot do without one that fails to start.
        Some(mut waiting) => {
            let count = waiting.len();
            let hand_over = move |thread: ThreadBuilder| {
                let gone = || std::io::Error::other("the thread is gone");
                waiting.pop().ok_or_else(gone)?.0.send(thread).map_err(|_| gone())
            };
            ThreadPoolBuilder::new().num_threads(count).spawn_handler(hand_over).build_global()
        }
        None => ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global(),
    };
    // A process has one pool: the first stays.
    drop(pool);
}

/// Returns the number of threads: what the option or rayon's variable asks for, or that of the processors.
fn thread_count(jobs: Option<u16>) -> usize {
    let variable = || std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok());
    let named = jobs.map(usize::from).or_else(variable);
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    named.filter(|number| *number > 0).unwrap_or_else(processors).min(affordable())
}

/// Address space that a thread takes: its stack, and what the allocator sets aside for it.
#[cfg(unix)]
const BYTES_OF_THREAD: u64 = 66 << 20;

/// Returns the number of threads that a fourth of the address space holds. Threads that take all of it leave no room
/// for the run: then the next allocation, of any size, ends the program.
#[cfg(unix)]
fn affordable() -> usize {
    use rustix::process::{Resource, getrlimit};
    let limit = getrlimit(Resource::As).current;
    limit.map_or(usize::MAX, |bytes| usize::try_from(bytes / 4 / BYTES_OF_THREAD).unwrap_or(usize::MAX))
}

#[cfg(not(unix))]
fn affordable() -> usize {
    usize::MAX
}

type Waiting = (Sender<ThreadBuilder>, JoinHandle<()>);

/// Returns threads, all that are wanted or none: with a part of them nothing may be left for the rest of the run.
fn waiting(wanted: usize) -> Option<Vec<Waiting>> {
    let mut threads: Vec<Waiting> = Vec::new();
    for _ in 0..wanted {
        let (sender, receiver): (_, Receiver<ThreadBuilder>) = channel();
        let work = move || receiver.into_iter().for_each(ThreadBuilder::run);
        match std::thread::Builder::new().spawn(work) {
            Ok(handle) => threads.push((sender, handle)),
            Err(_) => {
                for (sender, handle) in threads {
                    drop(sender);
                    let _ = handle.join();
                }
                return None;
            }
        }
    }
    Some(threads)
}
