//! A YAML file to a mapping with places: what is not YAML, or not part of the language, is refused here.

use super::files::Files;
use super::index::index;
use super::nulls::refuse_unknown;
use super::places::Places;
use super::read::read_text;
use super::tree;
use crate::diagnostic::{Diagnostic, Diagnostics, Place, codes, shown};
use serde_json::Value as Schema;
use serde_yaml::{Mapping, Value};
use std::path::Path;

/// A mapping as a file writes it.
pub(super) struct WrittenMapping {
    pub map: Mapping,
    pub places: Places,
}

/// The form of a file.
pub(super) struct FileForm<'a> {
    /// The schema of its mapping, and that in which references are followed.
    pub schemas: [&'a Schema; 2],
    /// The refusal of a text that is no mapping.
    pub empty: Diagnostic,
}

/// Reads a file; `named` is where another file names it.
pub(super) fn read_mapping(
    path: &Path,
    named: Option<Place>,
    form: FileForm<'_>,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<WrittenMapping> {
    let (source, text) = read_text(path, named, files, diagnostics)?;
    let mut places = Places::default();
    places.add_file(source, path);
    index(&text, source, &mut places, diagnostics)?;
    let start = || Some(Place { source, range: 0..0 });
    match tree::parse(&text) {
        Ok(Value::Mapping(map)) => {
            refuse_unknown(&map, form.schemas, &mut places, diagnostics);
            Some(WrittenMapping { map, places })
        }
        Ok(_) => {
            diagnostics.push(form.empty.at(start(), ""));
            None
        }
        Err(failure) => {
            let at = failure
                .location()
                .map(|l| Place { source, range: l.index().min(text.len())..l.index().min(text.len()) });
            let help = "the text is not YAML here; look for a missing quote, bracket or space after `:`";
            let message = format!("not YAML: {}", shown(&failure.to_string()));
            diagnostics.push(Diagnostic::new(codes::E0105, message).at(at.or_else(start), "").help(help));
            None
        }
    }
}
