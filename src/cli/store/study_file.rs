//! State files of `enumerate`. A state file is always whole: it is written beside and renamed, once a second or less
//! often.

use super::write::replace_whole;
use abbe::Diagnostic;
use abbe::options::StudyFile;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two writes.
const PACE: Duration = Duration::from_secs(1);

/// A state file.
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
        if last || Instant::now() >= *next {
            replace_whole(self.path, text().as_bytes())?;
            *next = Instant::now() + PACE;
        }
        Ok(())
    }
}
