//! An input of the fuzzer as files in memory.

use abbe::MemoryFiles;
use std::path::Path;

/// Begins a line that names the next file.
const MARK: &[u8] = b"=== ";

/// Maximum number of files.
const MAX_FILES: usize = 16;

/// The text of an input up to its first line `=== NAME`, and the files that such lines begin.
pub struct Case<'a> {
    /// The text before the first mark.
    pub main: &'a [u8],
    /// Names and contents of the files.
    pub files: Vec<(String, &'a [u8])>,
}

impl<'a> Case<'a> {
    /// Splits an input.
    pub fn of(bytes: &'a [u8]) -> Self {
        let mut marks = marks(bytes);
        marks.truncate(MAX_FILES);
        let ends = marks.iter().skip(1).map(|(at, ..)| *at).chain([bytes.len()]);
        let file = |((_, name, begin), end): (&(usize, String, usize), usize)| (name.clone(), &bytes[*begin..end]);
        let files = marks.iter().zip(ends).map(file).collect();
        Self { main: &bytes[..marks.first().map_or(bytes.len(), |(at, ..)| *at)], files }
    }

    /// Splits the first line off the text before the first mark.
    pub fn head(&self) -> (&'a str, &'a [u8]) {
        let end = self.main.iter().position(|byte| *byte == b'\n').unwrap_or(self.main.len());
        let line = std::str::from_utf8(&self.main[..end]).unwrap_or_default().trim_end();
        (line, self.main.get(end + 1..).unwrap_or_default())
    }

    /// Returns the named files in a folder; an empty path for no folder.
    pub fn files_in(&self, folder: &Path) -> MemoryFiles {
        let file = |all: MemoryFiles, (name, bytes): &(String, &[u8])| all.with(folder.join(name), *bytes);
        self.files.iter().fold(MemoryFiles::new(), file)
    }
}

/// Returns begin of the line, name, and begin of the content for each mark.
fn marks(bytes: &[u8]) -> Vec<(usize, String, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let end = at + line.len();
        if let Some(name) = line.strip_prefix(MARK).and_then(|name| std::str::from_utf8(name).ok()) {
            found.push((at, name.trim().to_owned(), end));
        }
        at = end;
    }
    found
}

/// Joins a text and files to an input.
pub fn joined<'a>(main: &str, files: impl IntoIterator<Item = (&'a str, &'a [u8])>) -> Vec<u8> {
    let mut bytes = main.as_bytes().to_vec();
    for (name, content) in files {
        if !bytes.is_empty() && !bytes.ends_with(b"\n") {
            bytes.push(b'\n');
        }
        bytes.extend([MARK, name.as_bytes(), b"\n", content].concat());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_joined_and_split() {
        let files = [("a.csv", b"1,2\n".as_slice()), ("b/c.csv", b"\xff\n=== ")];
        let bytes = joined("main\ntext", files);
        let case = Case::of(&bytes);
        assert_eq!(case.head(), ("main", b"text\n".as_slice()));
        let names: Vec<_> = case.files.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
        assert_eq!(names[0], files[0]);
        assert_eq!(names[1].0, "b/c.csv");
    }
}
