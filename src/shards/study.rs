//! Files of the results of a study of arrangements: read, kept while walks are computed, put together.

use super::journal::{parse, to_text};
use crate::analysis::enumerate::{Journal, RoundRecord, RoundStep};
use crate::diagnostic::{Diagnostic, Reason, codes};
use crate::run::{Call, Refused};
use crate::syntax::ReadFailure;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Keeps the results of a study while it is computed.
pub trait StudyFile: Sync {
    /// The results have grown. `text` returns all of them, as the file holds them; `last` is true at the end of the
    /// study. Called for one result at a time, from any thread; may skip results that are not the last.
    ///
    /// A failure ends the study.
    fn keep(&self, text: &dyn Fn() -> String, last: bool) -> Result<(), Diagnostic>;
}

/// Results as they come in, and their file.
pub(crate) struct Keeper<'a> {
    file: Option<&'a dyn StudyFile>,
    state: Mutex<State>,
    failed: AtomicBool,
}

struct State {
    journal: Journal,
    failure: Option<Diagnostic>,
}

impl<'a> Keeper<'a> {
    pub(crate) fn new(journal: Journal, file: Option<&'a dyn StudyFile>) -> Self {
        Self { file, state: Mutex::new(State { journal, failure: None }), failed: AtomicBool::new(false) }
    }

    /// True if the file could not be written: there is no point in going on.
    pub(crate) fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    pub(crate) fn keep(&self, at: RoundStep, records: Vec<RoundRecord>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = state.journal.done.insert(at, records);
        self.write(&mut state, false);
    }

    fn write(&self, state: &mut State, last: bool) {
        let Some(file) = self.file.filter(|_| state.failure.is_none()) else { return };
        let journal = &state.journal;
        if let Err(refusal) = file.keep(&|| to_text(journal), last) {
            state.failure = Some(refusal);
            self.failed.store(true, Ordering::Relaxed);
        }
    }

    /// Brings the file up to date.
    pub(crate) fn finish(self) -> Result<Journal, Diagnostic> {
        self.write(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner), true);
        let State { journal, failure } = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        failure.map_or(Ok(journal), Err)
    }
}

/// Fails with the reason for which these are no records of a walk of the study.
pub(crate) type CheckRecords<'a> = &'a dyn Fn(RoundStep, &[RoundRecord]) -> Result<(), Reason>;

/// Returns the part of the study that a file holds; nothing without the file.
pub(crate) fn begin(
    call: &mut Call<'_>,
    path: Option<&Path>,
    empty: Journal,
    check: CheckRecords<'_>,
) -> Result<Journal, Refused> {
    match path {
        Some(path) if call.run.files.read(path) != Err(ReadFailure::NotFound) => {
            of_study(call, path, &empty, check).or_else(|refusal| call.refuse(refusal))
        }
        _ => Ok(empty),
    }
}

fn of_study(call: &Call<'_>, path: &Path, empty: &Journal, check: CheckRecords<'_>) -> Result<Journal, Diagnostic> {
    let name = path.display();
    let foreign = |message: String| {
        Diagnostic::new(codes::E0610, message).help("name another file, or remove this one; it is unchanged")
    };
    let text = match call.run.files.read(path).map(String::from_utf8) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => return Err(foreign(format!("`{name}` is not a state file: not UTF-8"))),
        Err(failure) => return Err(foreign(format!("`{name}` cannot be read: {}", why(&failure)))),
    };
    let journal = parse(&text)
        .map_err(|failure| foreign(format!("`{name}` is not a state file: line {}: {}", failure.line, failure.why)))?;
    if (&journal.fingerprint, journal.steps) != (&empty.fingerprint, empty.steps) {
        let message =
            format!("`{name}` belongs to another study: the machine file, an option or the program has changed");
        return Err(foreign(message));
    }
    journal
        .done
        .iter()
        .try_for_each(|(at, records)| check(*at, records))
        .map_err(|why| foreign(format!("`{name}` is not of this study: {why}")))?;
    Ok(journal)
}

/// Returns the reason why a file of results cannot be read.
pub(crate) fn why(failure: &ReadFailure) -> String {
    match failure {
        ReadFailure::NotFound => "there is no such file".to_owned(),
        ReadFailure::Denied => "permission denied".to_owned(),
        ReadFailure::NotAFile(what) => format!("it is {what}"),
        ReadFailure::TooLarge(size, limit) => format!("it has {size} bytes, {limit} are read at most"),
        ReadFailure::Outside(root) => {
            format!("it is outside `{}`, to which --confined limits this run", root.display())
        }
        ReadFailure::Other(text) => text.clone(),
    }
}

/// Returns the results with those of other files.
pub(crate) fn merge(
    call: &mut Call<'_>,
    paths: &[PathBuf],
    whole: Journal,
    check: CheckRecords<'_>,
) -> Result<Journal, Refused> {
    together(call, paths, whole, check).or_else(|refusal| call.refuse(refusal))
}

fn together(
    call: &Call<'_>,
    paths: &[PathBuf],
    mut whole: Journal,
    check: CheckRecords<'_>,
) -> Result<Journal, Diagnostic> {
    for path in paths {
        let part = of_study(call, path, &whole, check)?;
        for (at, records) in part.done {
            if whole.done.get(&at).is_some_and(|there| *there != records) {
                let message =
                    format!("`{}` has other results for walk {} than a part before it", path.display(), at.step);
                let help = "one of them was changed or made by another build: compute the parts again";
                return Err(Diagnostic::new(codes::E0611, message).help(help));
            }
            let _ = whole.done.insert(at, records);
        }
    }
    Ok(whole)
}

/// Returns the refusal of parts that lack walks of the first round.
pub(crate) fn incomplete(missing: usize, walks: usize) -> Diagnostic {
    let message = format!("the parts lack {missing} of {walks} walks");
    let help = "name all parts; a part that was interrupted is finished by running it again with its state file";
    Diagnostic::new(codes::E0611, message).help(help)
}
