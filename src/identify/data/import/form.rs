//! Layouts of an exported table.

/// How a table is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableForm {
    /// A column for each error.
    Wide,
    /// A row for each reading, the error's name in a column.
    Tidy,
    /// A column for each run of one error.
    Runs,
}

impl TableForm {
    /// Its name for people.
    pub fn word(self) -> &'static str {
        match self {
            Self::Wide => "one column for each error",
            Self::Tidy => "one row for each reading",
            Self::Runs => "one column for each run",
        }
    }
}
