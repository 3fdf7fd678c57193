//! A diagnostic, the files that it points into, and everything found wrong so far.

use super::codes::Code;
use super::shown::shown;
use std::ops::Range;
use std::sync::Arc;

/// The effect of a diagnostic on the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The run goes on.
    Warning,
    /// The input is refused.
    Refusal,
}

/// A file read in this run; index into [`Sources`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(pub(crate) usize);

/// A place: bytes `range` of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub source: SourceId,
    /// Bytes of its text.
    pub range: Range<usize>,
}

/// A place with its remark (may be empty).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The place.
    pub place: Place,
    /// The remark.
    pub text: String,
}

/// One thing that is wrong. As text it is one line, without its place.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{code}: {message}")]
pub struct Diagnostic {
    /// Stable code such as `E0203`; `abbe explain CODE` prints its long text.
    pub code: Code,
    /// Refusal or warning.
    pub severity: Severity,
    /// The fault, in terms of the field, with value and unit.
    pub message: String,
    /// Its places; the first is the primary one. Empty if there is no file.
    pub labels: Vec<Label>,
    /// The remedy.
    pub help: Option<String>,
}

impl Diagnostic {
    /// A refusal (codes `E....`) or a warning (codes `W....`), by the code's first letter.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        let severity = if code.is_warning() { Severity::Warning } else { Severity::Refusal };
        Self { code, severity, message: message.into(), labels: Vec::new(), help: None }
    }

    /// Adds a place.
    #[must_use]
    pub fn at(mut self, place: Option<Place>, text: impl Into<String>) -> Self {
        self.labels.extend(place.map(|place| Label { place, text: text.into() }));
        self
    }

    /// Adds the help line.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// The reason for which a text or a file is refused, in words: a failure that a caller states in a diagnostic.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Reason(String);

impl Reason {
    /// A reason in these words.
    pub fn new(why: impl std::fmt::Display) -> Self {
        Self(why.to_string())
    }
}

/// The files read in this run: name as the user would write it, and text.
#[derive(Debug, Default, Clone)]
pub struct Sources(Vec<(String, Arc<str>)>);

impl Sources {
    /// Keeps a file's text for rendering.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> SourceId {
        self.0.push((name.into(), text.into()));
        SourceId(self.0.len() - 1)
    }

    /// Keeps a file unless it is there.
    fn keep(&mut self, name: String, text: Arc<str>) -> SourceId {
        let known = self.0.iter().position(|known| known.0 == name && known.1 == text);
        SourceId(known.unwrap_or_else(|| {
            self.0.push((name, text));
            self.0.len() - 1
        }))
    }

    /// Keeps other files unless they are there, and returns their numbers here, in their order.
    pub(crate) fn keep_all(&mut self, others: &Self) -> Vec<SourceId> {
        others.0.iter().map(|(name, text)| self.keep(name.clone(), Arc::clone(text))).collect()
    }

    /// Name of a file.
    pub fn name(&self, id: SourceId) -> &str {
        self.0.get(id.0).map_or("", |s| &s.0)
    }

    /// Text of a file.
    pub fn text(&self, id: SourceId) -> &str {
        self.0.get(id.0).map_or("", |s| &s.1)
    }

    /// Name and text of every file, in the order read.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(name, text)| (name.as_str(), &**text))
    }

    /// Returns the 1-based line and column (in characters) of a place's start.
    pub fn line_column(&self, place: &Place) -> (usize, usize) {
        let text = self.text(place.source);
        let start = place.range.start.min(text.len());
        let before = text.get(..start).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// Everything found wrong so far, with the files it is about.
#[derive(Debug, Default, Clone)]
pub struct Diagnostics {
    /// The files.
    pub sources: Sources,
    pub(super) list: Vec<Diagnostic>,
    /// The number of refusals and of warnings that were found and not kept.
    pub(super) more: [usize; 2],
    pub(super) cancelled: bool,
}

/// Maximum number of refusals kept, and of warnings: nobody reads more, and a hostile file has millions.
const MAX_KEPT: usize = 100;

impl Diagnostics {
    /// Returns none so far, about files read before.
    pub fn about(sources: Sources) -> Self {
        Self { sources, ..Self::default() }
    }

    /// Takes over those of another run, with their files.
    pub fn absorb(&mut self, other: Diagnostics) {
        let moved = self.sources.keep_all(&other.sources);
        for mut diagnostic in other.list {
            for label in &mut diagnostic.labels {
                label.place.source = moved.get(label.place.source.0).copied().unwrap_or(label.place.source);
            }
            self.push(diagnostic);
        }
        self.more.iter_mut().zip(other.more).for_each(|(all, more)| *all += more);
        self.cancelled |= other.cancelled;
    }

    /// True if the job was cancelled: then nothing need be wrong.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled
    }

    /// Returns what a cancelled job ends with: nothing found wrong.
    pub(crate) fn cancellation(sources: Sources) -> Self {
        Self { cancelled: true, ..Self::about(sources) }
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds one. Beyond 100 refusals and 100 warnings they are only counted.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        let severity = diagnostic.severity;
        if self.list.iter().filter(|kept| kept.severity == severity).count() < MAX_KEPT {
            self.list.push(diagnostic);
        } else {
            self.more[usize::from(severity == Severity::Warning)] += 1;
        }
    }

    /// The number of those that were found and not kept: refusals, then warnings.
    pub fn more(&self) -> [usize; 2] {
        self.more
    }

    /// Those that are kept, in the order found.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter()
    }

    /// The number of those found so far.
    pub fn count(&self) -> usize {
        self.list.len() + self.more[0] + self.more[1]
    }

    /// Drops those found after the first `count` that repeat an earlier one.
    pub fn forget_repeats(&mut self, count: usize) {
        for i in (count..self.list.len()).rev() {
            if self.list[..i].contains(&self.list[i]) {
                self.list.remove(i);
            }
        }
    }

    /// Puts a file's name in front of the messages of those found after the first `count` that have no place in it:
    /// where several machines are at work, each says of which it is.
    pub fn name_file(&mut self, count: usize, file: &str) {
        let Self { sources, list, .. } = self;
        for diagnostic in list.iter_mut().skip(count) {
            let has_place = diagnostic.labels.iter().any(|label| sources.name(label.place.source) == file);
            if !has_place && !diagnostic.message.contains(file) {
                diagnostic.message = format!("{}: {}", shown(file), diagnostic.message);
            }
        }
    }

    /// True if the input is refused.
    pub fn is_refused(&self) -> bool {
        self.more[0] > 0 || self.list.iter().any(|d| d.severity == Severity::Refusal)
    }

    /// The number of warnings.
    pub fn warnings(&self) -> usize {
        self.list.iter().filter(|d| d.severity == Severity::Warning).count() + self.more[1]
    }

    /// Turns every warning into a refusal (`--deny warnings`).
    pub fn deny_warnings(&mut self) {
        self.list.iter_mut().for_each(|d| d.severity = Severity::Refusal);
        self.more = [self.more[0] + self.more[1], 0];
    }
}

impl std::error::Error for Diagnostics {}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self { list: vec![diagnostic], ..Self::default() }
    }
}
