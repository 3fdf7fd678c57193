//! Files: reading, writing whole or not at all, sets of compensation files, records and journals.

pub(super) mod archive;
pub(super) mod commit;
pub(crate) mod engine;
pub(super) mod file_set;
pub(crate) mod files;
pub(crate) mod limited;
pub(super) mod study_file;
pub(super) mod tree;
pub(super) mod write;
