//! Integration tests.

mod bad_input;
mod diagnostics;
mod eval_exact;
mod eval_order;
mod golden_signs;
mod language;
mod linuxcnc_kinematics;
mod oracle;
mod paper_2015;
mod published;
mod reconfigure;
mod schema;
mod tidy;
