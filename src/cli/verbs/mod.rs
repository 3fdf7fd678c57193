//! One file a verb: its arguments, its work, its output.

pub(super) mod budget;
pub(super) mod check;
pub(super) mod classify;
pub(super) mod compare;
pub(super) mod compile;
pub(super) mod convert;
pub(super) mod diff;
pub(super) mod enumerate;
pub(super) mod equations;
pub(super) mod eval;
pub(super) mod explain;
pub(super) mod figures;
pub(super) mod identify;
pub(super) mod import;
pub(super) mod init;
pub(super) mod instrument;
pub(super) mod locate;
pub(super) mod man;
pub(super) mod map;
pub(super) mod reach;
pub(super) mod record;
pub(super) mod report;
pub(super) mod show;
pub(super) mod targets;
pub(super) mod verify;
pub(super) mod workbench;
