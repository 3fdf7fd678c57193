//! The machines in configs/, for tests that go through all of them.

use abbe::cli::files::Disk;
use abbe::diagnostic::{Diagnostics, Rendering, render};
use abbe::machine::{self, Machine};
use abbe::syntax;
use std::path::{Path, PathBuf};

/// The folder.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("configs")
}

/// A machine by its path in the folder.
pub fn machine(name: &str) -> Machine {
    let mut diagnostics = Diagnostics::default();
    let document = syntax::load(&folder().join(name), &Disk, &mut diagnostics);
    let machine = document.and_then(|document| machine::resolve(&document, &Disk, &mut diagnostics));
    machine.unwrap_or_else(|| panic!("{}", render(&diagnostics, Rendering::default())))
}

/// Names of all machine files, sorted.
pub fn names() -> Vec<String> {
    let mut names = Vec::new();
    for sub in ["", "variants/", "papers/"] {
        for entry in std::fs::read_dir(folder().join(sub)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if name.ends_with(".yaml") {
                names.push(format!("{sub}{name}"));
            }
        }
    }
    names.sort();
    assert!(names.len() >= 16, "configs/ is not complete: {names:?}");
    names
}

/// Every machine, with its name.
pub fn all() -> Vec<(String, Machine)> {
    names().into_iter().map(|name| (name.clone(), machine(&name))).collect()
}
