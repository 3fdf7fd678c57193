//! The description of a controller:
//!
//! 1. its manifest ([`Manifest`]), checked ([`soundness`]);
//! 2. the folder that holds it, in the binary or of the user's ([`ControllerTarget`]);
//! 3. the letters that it has for the axes of a machine ([`assigned_letters`]).

mod description;
mod letters;
mod library;
mod soundness;

pub use description::{
    Arithmetic, AxisLetters, Certainty, Column, Controller, Edge, FileSpec, Frame, Index, Layout, LineSpec, Lookup,
    Manifest, OutsideTable, Per,
};
pub use letters::{AssignedAxis, assigned_letters, by_number};
pub(super) use library::path_fits;
pub use library::{ControllerTarget, NAMES, TemplateLimit, TemplateWatch, is_plain_name};
