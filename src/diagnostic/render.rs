//! Diagnostics to text, as rustc prints them: code, place, the line, help.

use super::{Diagnostic, Diagnostics, Label, Severity};
use crate::units::fold_beside;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::ops::Range;

/// Options of rendering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rendering {
    /// True for ANSI colours.
    pub color: bool,
    /// True for lines of 80 columns: messages and help are folded, lines of files cut about the place.
    pub folded: bool,
}

/// Longest piece of a line that is shown; files without line breaks exist.
const WIDEST_LINE: usize = 400;

/// All diagnostics as text, each followed by an empty line; empty if there are none.
pub fn render(diagnostics: &Diagnostics, rendering: Rendering) -> String {
    let renderer = if rendering.color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.term_width(if rendering.folded { FOLDED_SOURCE } else { 160 });
    let one = |d: &Diagnostic| renderer.render(&[group(diagnostics, d, rendering.folded)]) + "\n\n";
    let mut text: String = diagnostics.iter().take(MAX_SHOWN).map(one).collect();
    let more = diagnostics.count().saturating_sub(MAX_SHOWN);
    if more > 0 {
        text.push_str(&format!("and {more} more\n\n"));
    }
    text
}

/// The first of them: those that follow are of the same kind as a rule.
const MAX_SHOWN: usize = 50;

/// Columns of a line of a file where text is folded: the number of the line and what is left out stand beside it.
const FOLDED_SOURCE: usize = 70;

/// Columns in front of a message: `refused[E0604]: `; in front of help are fewer.
const TAKEN: usize = 16;

/// Longest underlined part of a line where lines are cut: what begins there is seen, what ends it seldom matters.
const MAX_UNDERLINED: usize = 48;

/// Longest label beside its excerpt.
const MAX_LABEL: usize = 32;

/// One line for the end of the run: `2 mistakes, 1 warning`; empty if there are none.
pub fn summary(diagnostics: &Diagnostics) -> String {
    let warnings = diagnostics.warnings();
    let refusals = diagnostics.count() - warnings;
    let count = |n: usize, one: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{n} {one}s")),
    };
    let parts: Vec<_> = [count(refusals, "mistake"), count(warnings, "warning")].into_iter().flatten().collect();
    parts.join(", ")
}

/// "error" means a geometric error in this crate, hence the level's own name.
fn level(severity: Severity) -> Level<'static> {
    match severity {
        Severity::Refusal => Level::ERROR.with_name("refused"),
        Severity::Warning => Level::WARNING,
    }
}

fn group<'a>(diagnostics: &'a Diagnostics, diagnostic: &'a Diagnostic, folded: bool) -> Group<'a> {
    let text = |text: &'a str| if folded { Cow::Owned(fold_beside(text, TAKEN)) } else { Cow::Borrowed(text) };
    let title = level(diagnostic.severity).primary_title(text(&diagnostic.message)).id(diagnostic.code.id);
    let mut group = Group::with_title(title);
    for (source, labels) in by_source(&diagnostic.labels) {
        group = group.element(snippet(diagnostics, source, &labels, folded));
    }
    for label in diagnostic.labels.iter().filter(|label| folded && is_long(label)) {
        group = group.element(Level::NOTE.message(text(&label.text)));
    }
    match &diagnostic.help {
        Some(help) => group.element(Level::HELP.message(text(help))),
        None => group,
    }
}

/// True for a label that stands in lines of its own where text is folded: beside its excerpt it would be too wide.
fn is_long(label: &Label) -> bool {
    label.text.chars().count() > MAX_LABEL
}

/// Labels together by file, in the order of the files' first labels; the very first is the primary one.
fn by_source(labels: &[Label]) -> Vec<(super::SourceId, Vec<(bool, &Label)>)> {
    let mut files: Vec<(super::SourceId, Vec<(bool, &Label)>)> = Vec::new();
    for (i, label) in labels.iter().enumerate() {
        match files.iter_mut().find(|(source, _)| *source == label.place.source) {
            Some((_, list)) => list.push((i == 0, label)),
            None => files.push((label.place.source, vec![(i == 0, label)])),
        }
    }
    files
}

/// Hands over only the lines from the first to the last label: files may be large.
fn snippet<'a>(
    diagnostics: &'a Diagnostics,
    source: super::SourceId,
    labels: &[(bool, &'a Label)],
    folded: bool,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let text = diagnostics.sources.text(source);
    let most = if folded { MAX_UNDERLINED } else { usize::MAX };
    let ranges: Vec<Range<usize>> = labels.iter().map(|(_, l)| sound(text, &l.place.range, most)).collect();
    let window = window(text, &ranges);
    let line = text[..window.start].matches('\n').count() + 1;
    let shown = &text[window.clone()];
    let annotations = labels.iter().zip(ranges).map(|((primary, label), range)| {
        let kind = if *primary { AnnotationKind::Primary } else { AnnotationKind::Context };
        let within = |at: usize| at.clamp(window.start, window.end) - window.start;
        let annotation = kind.span(within(range.start)..within(range.end));
        if label.text.is_empty() || folded && is_long(label) { annotation } else { annotation.label(&label.text) }
    });
    Snippet::source(shown).line_start(line).path(diagnostics.sources.name(source)).annotations(annotations)
}

/// A range within the text, on character boundaries, that ends with its first line or `most` bytes from its start.
fn sound(text: &str, range: &Range<usize>, most: usize) -> Range<usize> {
    let floor = |at: usize| (0..=at.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
    let start = floor(range.start);
    let end = floor(range.end.min(start.saturating_add(most))).max(start);
    let first_line = text[start..end].find(['\n', '\r']).map_or(end, |i| start + i);
    start..first_line
}

/// Returns the range from the start of the first labelled line to the end of the last one.
fn window(text: &str, ranges: &[Range<usize>]) -> Range<usize> {
    let first = ranges.iter().map(|r| r.start).min().unwrap_or(0);
    let last = ranges.iter().map(|r| r.end).max().unwrap_or(0);
    let start = text[..first].rfind('\n').map_or(0, |i| i + 1);
    let end = text[last..].find('\n').map_or(text.len(), |i| last + i);
    let floor = |at: usize| (0..=at).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
    let start = if first - start > WIDEST_LINE { floor(first - WIDEST_LINE) } else { start };
    let end = if end - last > WIDEST_LINE { floor(last + WIDEST_LINE) } else { end };
    start..end
}

/// All of them as the program prints them, with the places in their files.
impl std::fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(render(self, Rendering::default()).trim_end())
    }
}
