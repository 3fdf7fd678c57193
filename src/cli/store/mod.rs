//! Files: reading, writing whole or not at all, sets of compensation files and journals.

pub(super) mod commit;
pub(super) mod file_set;
pub(crate) mod files;
pub(crate) mod limited;
pub(super) mod study_file;
pub(super) mod write;
