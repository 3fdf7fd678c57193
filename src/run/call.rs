//! The frame of a call: access to files, progress, diagnostics.

use super::finite;
use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes};
use crate::syntax::{Disk, Files, MemoryFiles};
use std::cell::Cell;
use std::convert::Infallible;
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Hears of the progress of a long job, and may cancel it. All methods do nothing by default.
pub trait Monitor: Sync {
    /// Hears in words what a long stage will cost, before it begins.
    fn announce(&self, _cost: &str) {}
    /// A stage of `total` steps begins; 0 if nobody knows how many there will be. `phase` says what its steps are:
    /// `poses`, `machines drawn`.
    fn begin(&self, _phase: &str, _total: usize) {}
    /// `steps` more of them are done; of 0 steps the job only asks whether to go on. May be called from several
    /// threads.
    ///
    /// A failure cancels the job: it leaves nothing behind, and its [`Diagnostics`] are
    /// [`is_cancelled`](Diagnostics::is_cancelled).
    fn advance(&self, _steps: usize) -> Result<(), Cancelled> {
        Ok(())
    }
    fn end(&self) {}
}

/// What a long loop reports its steps to; a failure ends it.
pub type Advance<'a, F = Cancelled> = &'a (dyn Fn(usize) -> Result<(), F> + Sync);

/// Hears of steps and never cancels.
pub fn unheard(_steps: usize) -> Result<(), Infallible> {
    Ok(())
}

/// A flag that cancels a job when it next reports progress. Clones share it.
#[derive(Debug, Clone, Default)]
pub struct Cancellation(Arc<AtomicBool>);

/// The job is cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

impl Cancellation {
    /// True if the job is to end.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Has the job end.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Monitor for Cancellation {
    fn advance(&self, _steps: usize) -> Result<(), Cancelled> {
        if self.is_asked() { Err(Cancelled) } else { Ok(()) }
    }
}

struct Silent;

impl Monitor for Silent {}

/// The surroundings of a call. The default has no files and reports no progress.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// Access to files.
    pub files: &'a dyn Files,
    /// Receiver of progress.
    pub monitor: &'a dyn Monitor,
    /// True if a warning refuses the input.
    pub deny_warnings: bool,
}

impl Run<'static> {
    /// Reads files from the disk.
    pub fn on_disk() -> Self {
        Self { files: &Disk, monitor: &Silent, deny_warnings: false }
    }
}

impl<'a> Run<'a> {
    /// Reads files through `files`.
    pub fn with(files: &'a dyn Files) -> Self {
        Self { files, monitor: &Silent, deny_warnings: false }
    }
}

impl Default for Run<'_> {
    fn default() -> Self {
        static NO_FILES: MemoryFiles = MemoryFiles::new();
        Self { files: &NO_FILES, monitor: &Silent, deny_warnings: false }
    }
}

/// What a function of the library returns: the answer with its warnings, or what refuses the input.
pub type Reply<T> = Result<Answer<T>, Diagnostics>;

/// A value, and the warnings that were found on the way to it.
#[derive(Debug, Clone)]
pub struct Answer<T> {
    /// The value.
    pub value: T,
    /// The warnings, with the sources of their places.
    pub warnings: Diagnostics,
}

impl<T> Deref for Answer<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// The input is refused; the reasons are among the call's diagnostics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Refused;

/// A count that a caller gives.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Count {
    /// Poses that are held or drawn.
    Poses(usize),
    /// Machines that are drawn where errors are bounded.
    Machines(usize),
    /// The same until they are told apart.
    MaxMachines(usize),
    /// Readings of an instrument along a path.
    Points(usize),
}

pub(crate) struct Call<'a> {
    pub run: Run<'a>,
    /// Everything found wrong so far.
    pub diagnostics: Diagnostics,
    /// True if the monitor has cancelled a stage.
    cancelled: Cell<bool>,
}

impl<'a> Call<'a> {
    /// Makes a call: `job` collects diagnostics, and its value is returned with the warnings if nothing refuses it.
    /// `sources` are the files that places of its diagnostics may point into.
    /// A value with a number that is not finite is refused: E0542.
    pub fn answer<T: serde::Serialize>(
        run: Run<'a>,
        sources: &Sources,
        job: impl FnOnce(&mut Self) -> Result<T, Refused>,
    ) -> Reply<T> {
        Self::answer_of(run, sources, |call| {
            let value = job(call)?;
            call.extend(finite::refusal(&value));
            Ok(value)
        })
    }

    /// The same for a value whose numbers are checked elsewhere: a machine, or content that is checked before.
    pub fn answer_of<T>(
        run: Run<'a>,
        sources: &Sources,
        job: impl FnOnce(&mut Self) -> Result<T, Refused>,
    ) -> Reply<T> {
        let mut call = Self { run, diagnostics: Diagnostics::about(sources.clone()), cancelled: Cell::new(false) };
        let value = job(&mut call);
        match (value, call.check()) {
            (Ok(value), Ok(())) => Ok(Answer { value, warnings: call.diagnostics }),
            // What a cancelled job found is about half of an answer.
            _ if call.cancelled.get() => Err(Diagnostics::cancellation(sources.clone())),
            _ => Err(call.diagnostics),
        }
    }

    /// Adds a warning.
    pub fn warn(&mut self, warning: Diagnostic) {
        self.diagnostics.push(warning);
    }

    /// Does a job about one of several files: what it finds names the file.
    pub fn about<T>(&mut self, file: &str, job: impl FnOnce(&mut Self) -> T) -> T {
        let count = self.diagnostics.count();
        let value = job(self);
        self.diagnostics.name_file(count, file);
        self.diagnostics.forget_repeats(count);
        value
    }

    /// Adds warnings, or refusals that the next [`Self::check`] stops at.
    pub fn extend(&mut self, list: impl IntoIterator<Item = Diagnostic>) {
        list.into_iter().for_each(|diagnostic| self.diagnostics.push(diagnostic));
    }

    /// Adds a refusal and stops.
    pub fn refuse<T>(&mut self, refusal: Diagnostic) -> Result<T, Refused> {
        self.diagnostics.push(refusal);
        Err(Refused)
    }

    /// Refuses options that make no sense for this machine or together.
    pub fn usage<T>(&mut self, message: impl Into<String>) -> Result<T, Refused> {
        self.refuse(Diagnostic::new(codes::E0818, message))
    }

    /// Refuses counts beyond what the program takes: a caller may pass on any number.
    pub fn check_counts(&mut self, counts: &[Count]) -> Result<(), Refused> {
        let counts = counts.iter().map(|count| match *count {
            Count::Poses(count) => ("poses", count, 1..=1_000_000),
            Count::Machines(count) => ("machines to draw", count, 2..=100_000),
            Count::MaxMachines(count) => ("machines to draw at most", count, 2..=800_000),
            Count::Points(count) => ("points", count, 3..=100_000),
        });
        let mut beyond = counts.into_iter().filter(|(_, count, range)| !range.contains(count));
        let Some((what, count, range)) = beyond.next() else { return Ok(()) };
        self.usage(format!("{count} {what}: {} to {} are taken", range.start(), range.end()))
    }

    /// Stops if anything so far refuses the input, or warns where warnings are denied.
    pub fn check(&mut self) -> Result<(), Refused> {
        if self.run.deny_warnings && self.diagnostics.warnings() > 0 {
            self.diagnostics.deny_warnings();
        }
        if self.diagnostics.is_refused() { Err(Refused) } else { Ok(()) }
    }

    /// Takes over the warnings or the refusal of another call.
    pub fn take<T>(&mut self, answer: Reply<T>) -> Result<T, Refused> {
        match answer {
            Ok(answer) => {
                self.diagnostics.absorb(answer.warnings);
                Ok(answer.value)
            }
            Err(refusal) => {
                self.diagnostics.absorb(refusal);
                Err(Refused)
            }
        }
    }

    /// Ends the call if it is cancelled.
    pub fn go_on(&self) -> Result<(), Refused> {
        self.run.monitor.advance(0).map_err(|Cancelled| {
            self.cancelled.set(true);
            Refused
        })
    }

    /// Says what a long stage will cost.
    pub fn announce(&self, cost: &str) {
        self.run.monitor.announce(cost);
    }

    /// Reports a stage of `total` steps, which `phase` names, while `job` runs; ends the call if it is cancelled.
    pub fn stage<T>(
        &self,
        phase: &str,
        total: usize,
        job: impl FnOnce(Advance<'_>) -> Result<T, Cancelled>,
    ) -> Result<T, Refused> {
        let monitor = self.run.monitor;
        monitor.begin(phase, total);
        let value = monitor.advance(0).and_then(|()| job(&|steps| monitor.advance(steps)));
        monitor.end();
        value.map_err(|Cancelled| {
            self.cancelled.set(true);
            Refused
        })
    }
}
