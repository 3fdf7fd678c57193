//! Compiles a machine to LinuxCNC's tables in memory, and prints the residual.

#![allow(clippy::print_stdout, reason = "an example prints")]

use abbe::{CompileOptions, Diagnostics, LoadOptions, Run};

/// Files are read from the disk; nothing is written.
pub fn main() -> Result<(), Diagnostics> {
    let run = Run::on_disk();
    let machine = abbe::load("configs/trunnion.yaml", &LoadOptions::default(), run)?;
    let options = CompileOptions { target: "linuxcnc".to_owned(), ..CompileOptions::default() };
    let set = abbe::compile(&machine, &options, run)?;
    for file in &set.files {
        println!("{}: {} bytes", file.name, file.bytes.len());
    }
    let [before, after] = [set.certificate.uncompensated, set.certificate.compensated].map(|f| f.position_um);
    println!("95 % of the deviations are below {:.2} um, {:.2} um without the tables", after.p95, before.p95);
    Ok(())
}
