//! The table of codes.

/// One code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CodeInfo {
    /// Such as `E0203`.
    pub code: &'static str,
    /// A few words.
    pub title: &'static str,
    /// What `abbe explain CODE` prints.
    pub explanation: &'static str,
}

/// All codes.
pub const CODES: &[CodeInfo] = &[];

/// What is known of a code.
pub fn info(code: &str) -> Option<&'static CodeInfo> {
    CODES.iter().find(|c| c.code.eq_ignore_ascii_case(code))
}
