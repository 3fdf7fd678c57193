//! Targets: a controller is a folder in `templates/` (a manifest and minijinja templates), not code.
//!
//! 1. [`Target::find`] reads the manifest, from the binary or from a folder of the user's;
//! 2. [`Target::tables`] fills what the controller's mechanism can hold and rounds it;
//! 3. [`Target::render`] writes the files (as bytes: nothing here touches the disk);
//! 4. [`Target::read`] reads such files back, refusing what the controller would misread;
//! 5. [`Replay`] does what the controller does with them, in its own arithmetic;
//! 6. [`certify`] compares the machine with and without them on poses that are not table points.
//!
//! Targets without tables, which replace the controller's kinematics, have their own passes in `kinematics`.

mod certificate;
mod context;
mod effect;
mod fill;
mod installed;
mod kinematics;
mod library;
mod limits;
mod lock;
mod manifest;
mod read;
mod render;
mod replay;
mod stored;
mod timed;

pub use certificate::{Certificate, ErrorLeft, Figures, Handled, Judged, ROUNDING_UM, Raised, Shifted, certify};
pub use effect::Effect;
pub use kinematics::{Carried, Depth, Driven, Model, Setting, Words, World, certify_kinematics};
pub use library::{NAMES, Target, is_plain_name};
pub use limits::Limits;
pub use lock::{Hashed, LOCK_NAME, Lock, sha256};
pub use manifest::{Certainty, Controller, FileSpec, Layout, Level, Manifest};
pub use read::{Found, ReadBack, Recognised, recognise};
pub use render::{LARGEST_FILE, RenderedFile, assigned_letters};
pub use replay::{Compensated, Replay};
