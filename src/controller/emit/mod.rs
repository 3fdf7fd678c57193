//! From a machine to files:
//!
//! 1. tables are filled and rounded ([`fill`]), over those that are [`installed`];
//! 2. they are checked against [`Limits`];
//! 3. templates write them ([`render`]), from the values of a set ([`context`]) and its numbers as they are [`stored`];
//! 4. measuring programs are written likewise ([`program`]);
//! 5. a [`Lock`] lists the files of a set.

mod ascii;
mod context;
mod fill;
mod installed;
mod limits;
mod lock;
mod number;
mod program;
mod render;
mod restored;
mod stored;

pub(super) use context::tool_direction;
pub use limits::Limits;
pub(super) use limits::RAISE_LIMIT;
pub use lock::{LOCK_NAME, Lock};
pub use number::{decimal_text, exact};
pub use program::{ProgramManifest, ProgramWords};
pub use render::{MAX_FILE_BYTES, RenderedFile};
pub use stored::{StoredColumn, StoredPosition};
