//! Compiles for a controller of one's own: a folder with a manifest and templates, and no Rust.

#![allow(clippy::print_stdout, reason = "an example prints")]

use abbe::options::CompensationOptions;
use abbe::{CompileOptions, Diagnostics, LoadOptions, Run};

/// The folder `docs/examples/northmill` describes the controller (docs/adding-a-target.md).
pub fn main() -> Result<(), Diagnostics> {
    let run = Run::on_disk();
    let machine = abbe::load("configs/trunnion.yaml", &LoadOptions::default(), run)?;
    let compensation =
        CompensationOptions { templates: Some("docs/examples".into()), ..CompensationOptions::default() };
    let options = CompileOptions { target: "northmill".to_owned(), compensation, ..CompileOptions::default() };
    let set = abbe::compile(&machine, &options, run)?;
    for file in &set.files {
        println!("--- {}\n{}", file.name, String::from_utf8_lossy(&file.bytes));
    }
    Ok(())
}
