//! The library as WebAssembly, where a package of the program brought it along.

use abbe::options::EngineFile;
use abbe::{Disk, Files};

/// Folder of the engines, beside that of the program: `/usr/share/abbe` of a Debian package, `share/abbe` of a virtual
/// environment.
const FOLDER: &str = "share/abbe";

/// Variants that a package may hold, the one first that every page gets.
const VARIANTS: [&str; 2] = ["plain", "relaxed"];

/// Limit for a compressed engine, bytes.
const LIMIT: u64 = 4 << 20;

/// Returns the engines of the package that this program is from; none for a program by itself.
pub(crate) fn engines() -> Vec<EngineFile> {
    let program = std::env::current_exe().unwrap_or_default();
    let Some(folder) = program.parent().and_then(|bin| Some(bin.parent()?.join(FOLDER))) else { return Vec::new() };
    let engine = |variant: &str| {
        let gzip = Disk.read_at_most(&folder.join(format!("engine-{variant}.wasm.gz")), LIMIT).ok()?;
        Some(EngineFile { variant: variant.to_owned(), gzip })
    };
    VARIANTS.into_iter().filter_map(engine).collect()
}
