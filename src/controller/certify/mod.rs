//! From a set to its certificate: fills the tables, or makes the modules, of every error alone, and hands them to the
//! [`certificate`](super::certificate), which computes none itself.

mod module;
mod tables;

pub use module::certify_kinematics;
pub use tables::certify;
