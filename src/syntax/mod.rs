//! Text to what the file says, with places. Nothing is judged here beyond form.
//!
//! [`load`] reads as the list of its passes: bytes to text, guard and index of places, YAML to a
//! tree, `extends` merged, then section by section into the typed [`Document`].

mod causes;
pub mod dialogue;
mod disk;
mod document;
mod entry;
mod error_words;
mod extends;
mod files;
mod forms;
mod geometry;
mod index;
mod job_document;
mod job_text;
mod layer;
mod mapping;
mod matrix_file;
mod nulls;
mod places;
mod read;
mod scalar;
mod schema;
mod schema_errors;
mod schema_forms;
pub mod sheet;
mod table;
mod term;
mod tolerance;
mod tree;
mod yaml;

pub use disk::Disk;
pub use document::{
    AlgebraEntry, AxisEntry, ControllerEntry, ConventionsEntry, CovarianceEntry, DatumEntry, DatumLine, DatumZero,
    Document, FormEntry, GeneratorsEntry, IdentifyEntry, MeshEntry, PlausibleEntry, SetUpEntry, SquarenessSite,
    ToolEntry, VolumeAxis,
};
pub(crate) use error_words::{component_words, location_words};
pub use files::{EntryKind, Files, FolderEntry, MemoryFiles, ReadFailure};
pub use geometry::{PositionEntry, RelativeEntry, SideEntry, TravelEntry, WrittenChain, WrittenChains};
pub use job_document::read_job;
pub use job_text::JobText;
pub(crate) use job_text::TOOL_POSES;
pub use matrix_file::{MatrixFailure, MatrixFile, matrix_file};
pub use places::{Keys, below, keys};
pub(crate) use read::unreadable;
pub use read::{read_table_text, read_text};
pub use scalar::Scalar;
pub use schema::schema;
pub use table::{ColumnDirection, CsvColumn, CsvTable, read_table};
pub use term::{BSplineEntry, CurveEntry, TermEntry};
pub use tolerance::{BoundEntry, ClassEntry, FigureEntry, FrameEntry};
pub use yaml::{YamlFailure, from_yaml};

use crate::diagnostic::Diagnostics;
use std::path::Path;

/// Reads a machine file and what it extends. `None` only if there is nothing to go on with: a
/// document with refused entries is returned without them, so that later stages find the rest.
pub fn load(path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Document> {
    let layer = extends::layers(path, files, diagnostics)?;
    Some(Document::from_layer(layer, diagnostics))
}
