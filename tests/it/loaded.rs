//! Machine files as the library reads them.

use abbe::diagnostic::{Diagnostics, Rendering, render};
use abbe::machine::Machine;
use abbe::syntax::Disk;
use std::path::Path;

/// Returns the machine of a file; panics with its diagnostics.
pub fn machine(path: &Path) -> Machine {
    let mut diagnostics = Diagnostics::default();
    let document = abbe::syntax::load(path, &Disk, &mut diagnostics);
    let machine = document.and_then(|d| abbe::machine::resolve(&d, &Disk, &mut diagnostics));
    machine.unwrap_or_else(|| panic!("{}", render(&diagnostics, Rendering::default())))
}
