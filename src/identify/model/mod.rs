//! The model of the measurements: its parameters, what they predict, and what is known of them before.

pub(super) mod curves;
pub(super) mod monomials;
pub(super) mod parameter;
pub(super) mod prediction;
pub(super) mod prior;
pub(super) mod request;
