//! Pools of threads, one for each number of threads asked for.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// By process too: threads do not survive a fork.
type Key = (u32, usize);

static POOLS: Mutex<Option<HashMap<Key, Arc<ThreadPool>>>> = Mutex::new(None);

/// As large as the main thread's: models recurse along the chain.
const STACK_BYTES: usize = 8 << 20;

/// Returns the pool of so many threads; 0 asks for `RAYON_NUM_THREADS`, or one for each processor.
pub fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let pools = pools.get_or_insert_default();
    let key = (std::process::id(), threads);
    if let Some(pool) = pools.get(&key) {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK_BYTES)
        // Whoever waits for a job that broke off notices, and the process goes on.
        .panic_handler(|_| ())
        .build();
    let pool = Arc::new(built.map_err(|failure| PyRuntimeError::new_err(format!("no threads: {failure}")))?);
    pools.insert(key, Arc::clone(&pool));
    Ok(pool)
}
