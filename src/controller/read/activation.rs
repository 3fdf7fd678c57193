//! The tables that files put in force, and their axes. A table that no such file names corrects nothing.

/// The tables, senses and units that a file puts in force.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Activation {
    /// The files that act.
    pub files: Vec<ActiveFile>,
    /// The mm of a unit of length in tables of linear axes, and the deg of a unit of angle in those of rotary axes.
    pub units: [f64; 2],
    /// Factors of the corrections of axes.
    pub senses: Vec<(usize, f64)>,
    /// The number of rows for which the controller has room, and the line that says so.
    pub room: Option<(usize, usize)>,
}

/// A file that acts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ActiveFile {
    /// Its name as it is written there, without folders.
    pub file: String,
    /// The axis over which it is looked up, by its index; none if it is for the machine.
    pub axis: Option<usize>,
    /// The line that names it.
    pub line: usize,
}

impl Activation {
    pub fn of(files: Vec<ActiveFile>) -> Self {
        Self { files, units: [1.0; 2], senses: Vec::new(), room: None }
    }

    /// True if both put the same in force, wherever it is written.
    pub fn same(&self, other: &Self) -> bool {
        let bare = |all: &Self| {
            let files = all.files.iter().map(|file| ActiveFile { line: 0, ..file.clone() }).collect();
            let room = all.room.map(|(rows, _)| (rows, 0));
            Self { files, room, ..all.clone() }
        };
        bare(self) == bare(other)
    }
}

/// The name of a file without its folders.
pub(super) fn base(path: &str) -> &str {
    path.trim_matches('"').rsplit(['/', '\\']).next().unwrap_or(path)
}
