//! Output of the program: text, files and pictures, and the run with its diagnostics.

pub(super) mod bands;
pub(super) mod bounded;
pub(super) mod budget_text;
pub(super) mod budgets;
pub(super) mod certificate;
pub(super) mod characteristics;
pub(super) mod identify_report;
pub(super) mod map_output;
pub(super) mod monomials;
pub(super) mod pictures;
pub(super) mod placement;
pub(super) mod plan;
pub(super) mod predicted;
pub(super) mod progress;
pub(super) mod ranking;
pub(super) mod session;
pub(super) mod tolerance_goal;
pub(super) mod touch_report;
pub(super) mod view;
