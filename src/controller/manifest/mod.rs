//! The description of a controller:
//!
//! 1. its manifest ([`Manifest`]), checked ([`soundness`]);
//! 2. the folder that holds it, in the binary or of the user's ([`ControllerTarget`]);
//! 3. the letters that it has for the axes of a machine ([`axis_letters`]).

mod description;
mod forms;
mod letters;
mod library;
mod soundness;

pub use description::{
    Arithmetic, AxisLetters, Certainty, Controller, FileLayout, FileSpec, Interpolation, Level, LookupPosition,
    Manifest, OutsideTable, Per, TableColumn,
};
pub use forms::{ArchiveForm, Edge, Index, JointOrder, KindSetting, LineSpec, TextFrame, UnitSetting};
pub use letters::{AssignedAxis, axis_letters, by_number};
pub(super) use library::path_fits;
pub use library::{ControllerTarget, NAMES, TemplateLimit, TemplateWatch, is_plain_name, unknown_target};
