//! Layouts of an exported table.

/// Layout of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableForm {
    /// A column for each error.
    Wide,
    /// A row for each reading, the error's name in a column.
    Tidy,
    /// A column for each run of one error.
    Runs,
    /// A column for each channel of a six-degree instrument.
    Channels,
    /// The columns that a file of the user's names.
    Mapped,
    /// The text file of a laser program, its sections ending in `::`.
    LaserText,
    /// Entries `NAME[target,run]=value`.
    Entries,
    /// Blocks by error, `[EXX]`, as exchanged with controllers.
    Blocks,
}

impl TableForm {
    /// Returns its name for people.
    pub fn word(self) -> &'static str {
        match self {
            Self::Wide => "one column for each error",
            Self::Tidy => "one row for each reading",
            Self::Runs => "one column for each run",
            Self::Channels => "one column for each channel",
            Self::Mapped => "columns as mapped",
            Self::LaserText => "text file of a laser program",
            Self::Entries => "one entry for each reading",
            Self::Blocks => "one block for each error",
        }
    }
}
