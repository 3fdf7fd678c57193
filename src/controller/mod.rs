//! Targets: a controller is a folder in `templates/` (a manifest and minijinja templates), not code.
//!
//! 1. [`ControllerTarget::find`] reads the manifest, from the binary or from a folder of the user's;
//! 2. [`ControllerTarget::tables`] fills the tables of the controller's mechanisms and rounds them;
//! 3. [`ControllerTarget::render`] writes the files (as bytes: nothing here touches the disk);
//! 4. [`ControllerTarget::read`] reads such files back, refusing what the controller would misread;
//! 5. [`Replay`] computes the controller's corrections from them, in its own arithmetic;
//! 6. [`certify`] compares the machine with and without them on poses that are not table points.
//!
//! Targets without tables, which replace the controller's kinematics, have their own passes in `kinematics`.
//!
//! The rooms import one another in this order only: manifest, replay, emit, read, kinematics,
//! certificate, single_errors.

mod certificate;
mod emit;
mod kinematics;
mod manifest;
mod read;
mod replay;
mod single_errors;

pub use certificate::{
    BallCheck, Certificate, CompensationDegree, ControllerEffect, Depth, DriveDemand, Figures, Judgement,
    ProgrammingFigures, ROUNDING_UM, RaisedFigure, SingleErrorResidual, Strongest, TablesUnderTest, ToolDirection,
    ZeroShift, figures, judge_by, micro,
};
pub(crate) use certificate::{ball_checks, drive_demands, raised_figures};
pub use emit::{LOCK_NAME, Limits, Lock, MAX_FILE_BYTES, ProgramManifest, ProgramWords, RenderedFile};
pub(crate) use kinematics::{FoundLine, WORLD, found_lines};
pub use kinematics::{
    KinematicsModule, MIN_READING_MM, ModuleField, ModuleModel, NumberChange, Parameters, RotaryLine, SignTrial,
    SignTrials, Transformation,
};
pub use manifest::{
    AssignedAxis, Certainty, Controller, ControllerTarget, Level, Manifest, NAMES, TemplateLimit, TemplateWatch,
    axis_letters, by_number, is_plain_name, unknown_target,
};
pub use read::{IndexFile, ReadBack, RecognisedSet, recognise};
pub use replay::Replay;
pub use single_errors::{certify, certify_kinematics, certify_sets};
