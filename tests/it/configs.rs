//! The machines in configs/, for tests that go through all of them.

use abbe::machine::Machine;
use std::path::{Path, PathBuf};

/// The folder.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("configs")
}

/// A machine by its path in the folder.
pub fn machine(name: &str) -> Machine {
    crate::loaded::machine(&folder().join(name))
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
