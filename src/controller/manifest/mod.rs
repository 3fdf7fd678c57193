//! What a controller is: its manifest, and the folder that holds it.

pub(super) mod description;
pub(super) mod library;
