//! The pool of threads. A system may give fewer than there are processors, or none (`pids.max`, little address space):
//! then there are fewer, down to the one that is there.

use rayon::{ThreadBuilder, ThreadPoolBuilder};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Starts the pool, in the thread that does the run. The results are the same with any number of threads.
pub(super) fn start() {
    let wanted = std::thread::available_parallelism().map_or(1, usize::from);
    let wanted = std::env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok()).filter(|n| *n > 0).unwrap_or(wanted);
    // Threads that are there already: once the pool has begun to start its own, it cannot do with fewer.
    let mut waiting: Vec<Sender<ThreadBuilder>> = Vec::new();
    while waiting.len() < wanted {
        let (sender, receiver): (_, Receiver<ThreadBuilder>) = channel();
        let work = move || receiver.into_iter().for_each(ThreadBuilder::run);
        let Ok(_) = std::thread::Builder::new().spawn(work) else { break };
        waiting.push(sender);
    }
    let count = waiting.len();
    // Of a second pool in the process nothing comes: the first stays.
    let _ = if count == 0 {
        ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()
    } else {
        let hand_over = move |thread: ThreadBuilder| {
            let gone = || std::io::Error::other("the thread is gone");
            waiting.pop().ok_or_else(gone)?.send(thread).map_err(|_| gone())
        };
        ThreadPoolBuilder::new().num_threads(count).spawn_handler(hand_over).build_global()
    };
}
