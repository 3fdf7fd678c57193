//! Refusal of a request to fit.

use crate::diagnostic::{Diagnostic, codes};

pub(crate) type Refusal = Box<Diagnostic>;

/// Returns the diagnostic of a request that cannot be fitted.
pub(super) fn refusal(message: String, help: impl Into<String>) -> Refusal {
    Box::new(Diagnostic::new(codes::E0502, message).help(help))
}
