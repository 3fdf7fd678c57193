//! Certificates of whole sets: tables and modules for single errors are filled here and handed to the certificate,
//! which fills nothing.

mod composed;
mod module;
mod tables;

pub use composed::certify_sets;
pub use module::certify_kinematics;
pub use tables::certify;
