//! The first pass over the YAML text of a machine file or a job file: duplicate keys, which serde_yaml swallows, what
//! is not part of the language, and where every entry stands.

use super::causes::{YamlCause, yaml_cause};
use super::places::{Keys, Places, Spot};
use super::yaml::{YamlFailure, guard};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, SourceId, codes};
use saphyr_parser::{Event, Parser, Span, StrInput, Tag};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Fills `places`; `None` if the text must not be read any further.
pub fn index(text: &str, source: SourceId, places: &mut Places, diagnostics: &mut Diagnostics) -> Option<()> {
    let mut indexer = Indexer {
        source,
        offsets: text.char_indices().map(|(i, _)| i).chain([text.len()]).collect(),
        places,
        frames: Vec::new(),
        keys: Vec::new(),
        documents: 0,
        duplicates: Vec::new(),
    };
    let outcome = match guard(text) {
        Err(failure) if failure.is_limit => Err(indexer.limit(&failure)),
        _ => indexer.run(text),
    };
    let duplicates = std::mem::take(&mut indexer.duplicates);
    duplicates.into_iter().for_each(|d| diagnostics.push(d));
    outcome.map_err(|refusal| diagnostics.push(*refusal)).ok()
}

type Refusal = Box<Diagnostic>;

/// A mapping or list that is not finished.
struct OpenNode {
    start: usize,
    /// End of the last entry: block collections have no end of their own.
    last: usize,
    kind: NodeKind,
}

enum NodeKind {
    /// Keys so far, and the key that waits for its value.
    Map(BTreeMap<String, Place>, Option<(String, Place)>),
    /// Members so far.
    List(usize),
}

struct Indexer<'a> {
    source: SourceId,
    /// Character index -> byte index.
    offsets: Vec<usize>,
    places: &'a mut Places,
    frames: Vec<OpenNode>,
    keys: Keys,
    documents: usize,
    duplicates: Vec<Diagnostic>,
}

impl Indexer<'_> {
    fn run(&mut self, text: &str) -> Result<(), Refusal> {
        let mut parser = Parser::new(StrInput::new(text));
        while let Some(next) = parser.next_event() {
            let (event, span) = next.map_err(|failure| {
                let at = self.byte(failure.marker().index());
                let unknown = || YamlCause {
                    message: failure.info().to_owned(),
                    range: at..at,
                    help: "the text is not YAML here; look for a missing quote, bracket or space after `:`".to_owned(),
                };
                let YamlCause { message, range, help } = yaml_cause(text, at).unwrap_or_else(unknown);
                let place = Place { source: self.source, range };
                let refusal = Diagnostic::new(codes::E0105, format!("not YAML: {message}"));
                Box::new(refusal.at(Some(place), "").help(help))
            })?;
            self.event(event, self.range(span))?;
        }
        Ok(())
    }

    fn event(&mut self, event: Event<'_>, place: Place) -> Result<(), Refusal> {
        match event {
            Event::DocumentStart(_) => {
                self.documents += 1;
                if self.documents > 1 {
                    return Err(refusal("a second document", place, "keep one machine or one job in a file"));
                }
            }
            Event::Scalar(text, _, _, tag) => {
                tagless(tag, &place)?;
                self.scalar(&text, place)?;
            }
            Event::SequenceStart(_, tag) => {
                tagless(tag, &place)?;
                self.open(NodeKind::List(0), place)?;
            }
            Event::MappingStart(_, tag) => {
                tagless(tag, &place)?;
                self.open(NodeKind::Map(BTreeMap::new(), None), place)?;
            }
            Event::SequenceEnd | Event::MappingEnd => self.close(place),
            Event::Alias(_) => self.alias(place)?,
            Event::StreamStart | Event::StreamEnd | Event::DocumentEnd | Event::Nothing => {}
        }
        Ok(())
    }

    fn byte(&self, character: usize) -> usize {
        self.offsets.get(character).or(self.offsets.last()).copied().unwrap_or(0)
    }

    fn range(&self, span: Span) -> Place {
        let range = self.byte(span.start.index())..self.byte(span.end.index());
        Place { source: self.source, range }
    }

    /// True if the next node is a key.
    fn expects_key(&self) -> bool {
        matches!(self.frames.last(), Some(OpenNode { kind: NodeKind::Map(_, None), .. }))
    }

    fn scalar(&mut self, text: &str, place: Place) -> Result<(), Refusal> {
        if self.expects_key() {
            return self.key(text, place);
        }
        self.enter();
        self.leave(place);
        Ok(())
    }

    fn key(&mut self, text: &str, place: Place) -> Result<(), Refusal> {
        if text == "<<" {
            return Err(refusal("a merge key `<<`", place, "write the entries out, or use `extends: base.yaml`"));
        }
        if let Some(OpenNode { kind: NodeKind::Map(seen, waiting), .. }) = self.frames.last_mut() {
            if let Some(first) = seen.get(text) {
                self.duplicates.push(duplicate(text, &place, first));
            } else {
                seen.insert(text.to_owned(), place.clone());
            }
            *waiting = Some((text.to_owned(), place));
        }
        Ok(())
    }

    /// Steps down to the entry that begins.
    fn enter(&mut self) {
        match self.frames.last().map(|f| &f.kind) {
            Some(NodeKind::Map(_, Some((key, _)))) => self.keys.push(key.clone()),
            Some(NodeKind::List(index)) => self.keys.push(index.to_string()),
            _ => {}
        }
    }

    /// Records the entry that ends and steps up.
    fn leave(&mut self, place: Place) {
        let keys = self.keys.clone();
        let mut key = None;
        if let Some(frame) = self.frames.last_mut() {
            frame.last = place.range.end;
            match &mut frame.kind {
                NodeKind::Map(_, waiting) => key = waiting.take().map(|(_, place)| place),
                NodeKind::List(index) => *index += 1,
            }
            self.keys.pop();
        }
        self.places.insert(keys, Spot { key, value: place });
    }

    fn open(&mut self, kind: NodeKind, place: Place) -> Result<(), Refusal> {
        if self.expects_key() {
            return Err(refusal("a list or mapping as a key", place, "keys are plain words"));
        }
        self.enter();
        self.frames.push(OpenNode { start: place.range.start, last: place.range.end, kind });
        Ok(())
    }

    fn close(&mut self, end: Place) {
        let Some(frame) = self.frames.pop() else { return };
        let end = if end.range.is_empty() { frame.last } else { end.range.end };
        let range = frame.start..end.max(frame.start);
        self.leave(Place { source: self.source, range });
    }

    fn alias(&mut self, place: Place) -> Result<(), Refusal> {
        if self.expects_key() {
            return Err(refusal("an alias as a key", place, "keys are plain words"));
        }
        self.enter();
        self.leave(place);
        Ok(())
    }

    fn limit(&self, failure: &YamlFailure) -> Refusal {
        let at = self.byte(failure.character.unwrap_or(0));
        let help = "a machine file is small; put measured data into CSV tables";
        Box::new(
            Diagnostic::new(codes::E0106, format!("the file exceeds the parser's limits: {failure}"))
                .at(Some(Place { source: self.source, range: at..at + 1 }), "")
                .help(help),
        )
    }
}

fn tagless(tag: Option<Cow<'_, Tag>>, place: &Place) -> Result<(), Refusal> {
    match tag {
        Some(_) => Err(refusal("a YAML tag", place.clone(), "remove the `!...`; put text in quotes")),
        None => Ok(()),
    }
}

fn refusal(what: &str, place: Place, help: &str) -> Refusal {
    Box::new(
        Diagnostic::new(codes::E0108, format!("{what} is not part of the machine language"))
            .at(Some(place), "")
            .help(help),
    )
}

fn duplicate(key: &str, again: &Place, first: &Place) -> Diagnostic {
    Diagnostic::new(codes::E0107, format!("the key `{key}` occurs twice"))
        .at(Some(again.clone()), "again here")
        .at(Some(first.clone()), "first here")
        .help("keep one of them")
}
