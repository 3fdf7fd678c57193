//! State files of `enumerate`. A state file is always whole: it is written beside and renamed, once a second or less
//! often.

use super::write::replace_whole;
use abbe::Diagnostic;
use abbe::options::StudyFile;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Minimum time between two writes.
const PACE: Duration = Duration::from_secs(1);

/// A write of a large file waits for at least so many times as long as the last one took.
const REST: u32 = 10;

pub(crate) struct StateFile<'a> {
    path: &'a Path,
    next: Mutex<Instant>,
}

impl<'a> StateFile<'a> {
    pub(crate) fn new(path: &'a Path) -> Self {
        Self { path, next: Mutex::new(Instant::now()) }
    }
}

impl StudyFile for StateFile<'_> {
    fn keep(&self, text: &dyn Fn() -> String, last: bool) -> Result<(), Diagnostic> {
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        let begin = Instant::now();
        if last || begin >= *next {
            replace_whole(self.path, text().as_bytes())?;
            *next = Instant::now() + PACE.max(begin.elapsed() * REST);
        }
        Ok(())
    }
}
