//! Targets: a controller is a folder in `templates/` (a manifest and minijinja templates), not code.
//!
//! 1. [`ControllerTarget::find`] reads the manifest, from the binary or from a folder of the user's;
//! 2. [`ControllerTarget::tables`] fills what the controller's mechanism can hold and rounds it;
//! 3. [`ControllerTarget::render`] writes the files (as bytes: nothing here touches the disk);
//! 4. [`ControllerTarget::read`] reads such files back, refusing what the controller would misread;
//! 5. [`Replay`] does what the controller does with them, in its own arithmetic;
//! 6. [`certify`] compares the machine with and without them on poses that are not table points.
//!
//! Targets without tables, which replace the controller's kinematics, have their own passes in `kinematics`.

mod certificate;
mod emit;
mod kinematics;
mod manifest;
mod read;
mod replay;

pub use certificate::depth::Depth;
pub use certificate::figures::{Figures, ROUNDING_UM, RaisedFigure, micro};
pub use certificate::single_error::{ErrorLeft, Handled};
pub use certificate::tables::JudgedTables;
pub use certificate::{Certificate, ZeroShift};
pub use emit::limits::Limits;
pub use emit::lock::{Hashed, LOCK_NAME, Lock, sha256};
pub use emit::render::{MAX_FILE_BYTES, RenderedFile, assigned_letters};
pub use emit::single_errors::certify;
pub use kinematics::{KinematicsModule, Model, ModuleField, ModuleWords, Setting, World, certify_kinematics};
pub use manifest::description::{Certainty, Controller, FileSpec, Layout, Level, Manifest};
pub use manifest::library::{ControllerTarget, NAMES, is_plain_name};
pub use read::{Found, ReadBack, RecognisedSet, recognise};
pub use replay::effect::Effect;
pub use replay::tables::{Compensated, Replay};
