//! Runs kernels of the compiled evaluator for `check.py`: `abbe-instructions MACHINE.yaml POSES [KERNEL ORDER WIDTH]`.
//! POSES holds columns of doubles, one per axis. Prints the widest vectors of this processor. Without a kernel everything
//! is read and nothing is evaluated.

use abbe_instructions::diagnostic::Diagnostics;
use abbe_instructions::evaluate::{Batch, Columns, CompiledModel, Nodes, Order, Width};
use abbe_instructions::machine::{Approach, Machine, resolve};
use abbe_instructions::syntax::{Disk, load};
use std::path::Path;

fn machine(path: &str) -> Option<Machine> {
    let mut diagnostics = Diagnostics::default();
    let document = load(Path::new(path), &Disk, &mut diagnostics)?;
    resolve(&document, &Disk, &mut diagnostics)
}

fn doubles(path: &str) -> std::io::Result<Vec<f64>> {
    let bytes = std::fs::read(path)?;
    Ok(bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect())
}

/// Evaluates all poses, or as many whole lines of the grid from a third of it on.
fn evaluate(machine: &Machine, numbers: &[f64], [kernel, order, width]: [&str; 3], out: &mut Columns) -> Option<()> {
    let len = numbers.len() / machine.axes().len();
    let order = order.parse().map_or(Order::Exact, Order::Degree);
    let width = match width {
        "fused" => Width::Fused,
        "avx2" => Width::Avx2,
        _ => return None,
    };
    let model = CompiledModel::new(machine, order, Approach::Mean).with_width(width);
    match kernel {
        "batch" => model.deviations(&Batch::new(numbers.chunks_exact(len).collect(), len)?, out.output(len)),
        "grid" => {
            let grid = model.grid(&Nodes::of(machine))?;
            grid.fill(grid.lines() / 3, out.output(len / grid.line() * grid.line()));
        }
        _ => return None,
    }
    Some(())
}

fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let run = |machine_file: &str, poses: &str, task: &[&str]| {
        let (machine, numbers) = (machine(machine_file)?, doubles(poses).ok()?);
        let mut out = Columns::new(numbers.len() / machine.axes().len());
        match *task {
            [] => Some(()),
            [kernel, order, width] => evaluate(&machine, &numbers, [kernel, order, width], &mut out),
            _ => None,
        }
    };
    let done = match &words[..] {
        [machine_file, poses, task @ ..] => run(machine_file, poses, task),
        _ => None,
    };
    println!("{:?}", Width::widest());
    if done.is_some() { std::process::ExitCode::SUCCESS } else { std::process::ExitCode::FAILURE }
}
