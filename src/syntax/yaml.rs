//! The one way from YAML to values. libyaml inside serde_yaml takes quadratic time on deep nesting and writes aliases
//! out, so a text is measured before it is parsed.

use saphyr_parser::{Event, Parser, Span, StrInput};
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

const DEPTH: usize = 64;
/// Most entries, aliases counted as what they stand for.
const NODES: usize = 200_000;
const ALIASES: usize = 1_000;

/// The reason why a text is not parsed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct YamlFailure {
    /// In words.
    pub message: String,
    /// Line from 1, if it is known.
    pub line: Option<usize>,
    /// Index of the character, if it is known.
    pub(super) character: Option<usize>,
    /// True if the text is deeper or larger than is parsed.
    pub(super) is_limit: bool,
}

/// Parses a text of tolerable depth and size.
pub fn from_yaml<T: DeserializeOwned>(text: &str) -> Result<T, YamlFailure> {
    guard(text)?;
    serde_yaml::from_str(text).map_err(|failure| YamlFailure {
        message: failure.to_string(),
        line: failure.location().map(|at| at.line()),
        character: None,
        is_limit: false,
    })
}

/// Measures a text without building anything of it. Fails beyond the limits, and where the text is not YAML.
pub(super) fn guard(text: &str) -> Result<(), YamlFailure> {
    let mut parser = Parser::new(StrInput::new(text));
    let mut size = YamlSize::default();
    while let Some(next) = parser.next_event() {
        let (event, span) = next.map_err(|failure| YamlFailure {
            message: failure.info().to_owned(),
            line: Some(failure.marker().line()),
            character: Some(failure.marker().index()),
            is_limit: false,
        })?;
        size.event(&event).map_err(|what| beyond(&what, span))?;
    }
    Ok(())
}

fn beyond(what: &Excess, span: Span) -> YamlFailure {
    YamlFailure {
        message: what.to_string(),
        line: Some(span.start.line()),
        character: Some(span.start.index()),
        is_limit: true,
    }
}

#[derive(Debug, thiserror::Error)]
enum Excess {
    #[error("nested deeper than {DEPTH} levels")]
    Depth,
    #[error("more than {NODES} entries, aliases written out")]
    Nodes,
    #[error("more than {ALIASES} aliases")]
    Aliases,
    #[error("an alias inside its own anchor")]
    Circle,
}

#[derive(Default)]
struct YamlSize {
    nodes: usize,
    aliases: usize,
    /// Lists and mappings that are not finished: anchor, and the nodes before them.
    open: Vec<(usize, usize)>,
    /// Nodes of what anchors stand for.
    anchors: BTreeMap<usize, usize>,
}

impl YamlSize {
    fn event(&mut self, event: &Event<'_>) -> Result<(), Excess> {
        match event {
            Event::Scalar(_, _, anchor, _) => {
                if *anchor != 0 {
                    let _ = self.anchors.insert(*anchor, 1);
                }
                self.add(1)
            }
            Event::SequenceStart(anchor, _) | Event::MappingStart(anchor, _) => {
                if self.open.len() >= DEPTH {
                    return Err(Excess::Depth);
                }
                self.open.push((*anchor, self.nodes));
                self.add(1)
            }
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some((anchor, before)) = self.open.pop().filter(|(anchor, _)| *anchor != 0) {
                    let _ = self.anchors.insert(anchor, self.nodes - before);
                }
                Ok(())
            }
            Event::Alias(anchor) => {
                self.aliases += 1;
                if self.aliases > ALIASES {
                    return Err(Excess::Aliases);
                }
                let nodes = self.anchors.get(anchor).copied().ok_or(Excess::Circle)?;
                self.add(nodes)
            }
            _ => Ok(()),
        }
    }

    fn add(&mut self, nodes: usize) -> Result<(), Excess> {
        self.nodes = self.nodes.saturating_add(nodes);
        if self.nodes > NODES { Err(Excess::Nodes) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_deep_or_too_large_is_not_parsed() {
        let fails = |text: &str| from_yaml::<serde_yaml::Value>(text).unwrap_err();
        for open in ["[", "{a: ", "- ", "? "] {
            let _ = fails(&open.repeat(100_000));
        }
        assert!(fails(&"- ".repeat(DEPTH + 1)).is_limit);
        let levels: String = ('b'..='t').map(|c| format!("{c}: &{c} [*{0}, *{0}]\n", (c as u8 - 1) as char)).collect();
        assert!(fails(&format!("a: &a [x, x]\n{levels}")).is_limit);
        assert!(fails(&"- x\n".repeat(NODES + 1)).is_limit);
        let failure = fails("a: 1\nb: ]");
        assert_eq!((failure.is_limit, failure.line), (false, Some(2)));
    }
}
