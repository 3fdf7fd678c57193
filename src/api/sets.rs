//! A set of compensation files in a folder, for programs that write and replace sets.

pub use super::verify::set_manifest;
pub use crate::controller::{Hashed, LOCK_NAME, Lock, MAX_FILE_BYTES, RenderedFile, is_plain_name, sha256};
