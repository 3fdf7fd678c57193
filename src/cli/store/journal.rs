//! State files of `enumerate`: read, kept while walks are computed, put together. A state file is
//! always whole: it is written beside and renamed, at most once a second.

use super::write::write_whole;
use crate::analysis::enumerate::{Journal, Row};
use crate::cli::Exit;
use crate::cli::output::session::Session;
use crate::diagnostic::{Diagnostic, codes};
use crate::syntax::Disk;
use crate::syntax::{Files, ReadFailure};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two writes.
const PACE: Duration = Duration::from_secs(1);

/// `2/3`: the second of three parts.
pub(crate) fn shard(text: &str) -> Result<(usize, usize), String> {
    let parsed = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    let inside = |(i, n): &(usize, usize)| (1..=*n).contains(i);
    parsed.filter(inside).ok_or_else(|| format!("`--shard {text}` is not a part such as `2/3`"))
}

/// Results as they come in, and their file.
pub(crate) struct Keeper<'a> {
    path: Option<&'a Path>,
    state: Mutex<State>,
    failed: AtomicBool,
}

struct State {
    journal: Journal,
    next: Instant,
    failure: Option<Diagnostic>,
}

impl<'a> Keeper<'a> {
    /// With what the state file has of the study already.
    pub(crate) fn new(session: &mut Session, path: Option<&'a Path>, empty: Journal) -> Result<Self, Exit> {
        let journal = match path {
            Some(path) if path.symlink_metadata().is_ok() => of_study(session, path, &empty)?,
            _ => empty,
        };
        let state = State { journal, next: Instant::now(), failure: None };
        Ok(Self { path, state: Mutex::new(state), failed: AtomicBool::new(false) })
    }

    /// Is this walk done?
    pub(crate) fn has(&self, step: usize) -> bool {
        self.state.lock().is_ok_and(|state| state.journal.done.contains_key(&step))
    }

    /// Could the file not be written? Then there is no point in going on.
    pub(crate) fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// A walk is done.
    pub(crate) fn keep(&self, step: usize, rows: Vec<Row>) {
        let Ok(mut state) = self.state.lock() else { return };
        let _ = state.journal.done.insert(step, rows);
        if Instant::now() >= state.next {
            self.write(&mut state);
            state.next = Instant::now() + PACE;
        }
    }

    fn write(&self, state: &mut State) {
        let Some(path) = self.path else { return };
        if let Err(diagnostic) = write_whole(path, state.journal.to_text().as_bytes()) {
            state.failure = Some(diagnostic);
            self.failed.store(true, Ordering::Relaxed);
        }
    }

    /// Everything is done: the file is brought up to date.
    pub(crate) fn finish(&mut self) -> Result<(), Diagnostic> {
        let Ok(mut state) = self.state.lock() else { return Ok(()) };
        if state.failure.is_none() {
            self.write(&mut state);
        }
        state.failure.take().map_or(Ok(()), Err)
    }

    pub(crate) fn into_journal(self) -> Journal {
        self.state.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).journal
    }
}

/// A file's results, if they are of this study.
fn of_study(session: &mut Session, path: &Path, empty: &Journal) -> Result<Journal, Exit> {
    let name = path.display();
    let help = "name another file, or remove this one; it is left as it is";
    let text = match Disk.read(path).map(String::from_utf8) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => {
            return session
                .refuse(Diagnostic::new(codes::E0610, format!("`{name}` is not a state file: not UTF-8")).help(help));
        }
        Err(failure) => {
            return session.refuse(
                Diagnostic::new(codes::E0610, format!("`{name}` cannot be read: {}", why(&failure))).help(help),
            );
        }
    };
    let journal = match Journal::parse(&text) {
        Ok(journal) => journal,
        Err(failure) => {
            let message = format!("`{name}` is not a state file: line {}: {}", failure.line, failure.why);
            return session.refuse(Diagnostic::new(codes::E0610, message).help(help));
        }
    };
    if (&journal.fingerprint, journal.steps) != (&empty.fingerprint, empty.steps) {
        let message =
            format!("`{name}` belongs to another study: the machine file, an option or the program has changed");
        return session.refuse(Diagnostic::new(codes::E0610, message).help(help));
    }
    Ok(journal)
}

fn why(failure: &ReadFailure) -> String {
    match failure {
        ReadFailure::NotFound => "there is no such file".to_owned(),
        ReadFailure::Denied => "permission denied".to_owned(),
        ReadFailure::NotAFile(what) => format!("it is {what}"),
        ReadFailure::TooLarge(size, limit) => format!("it has {size} bytes, {limit} are read at most"),
        ReadFailure::Other(text) => text.clone(),
    }
}

/// All parts of a study together.
pub(crate) fn merged(session: &mut Session, paths: &[PathBuf], mut whole: Journal) -> Result<Journal, Exit> {
    for path in paths {
        let part = of_study(session, path, &whole)?;
        for (step, rows) in part.done {
            let differs = whole.done.get(&step).is_some_and(|there| *there != rows);
            if differs {
                let message = format!("`{}` has other results for walk {step} than a part before it", path.display());
                let help = "one of them was changed or made by another build: compute the parts again";
                return session.refuse(Diagnostic::new(codes::E0611, message).help(help));
            }
            let _ = whole.done.insert(step, rows);
        }
    }
    if !whole.is_complete() {
        let missing = whole.steps - whole.done.len();
        let message = format!("the parts lack {missing} of {} walks", whole.steps);
        let help = "name all parts; a part that was interrupted is finished by running it again with its state file";
        return session.refuse(Diagnostic::new(codes::E0611, message).help(help));
    }
    Ok(whole)
}
