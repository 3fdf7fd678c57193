//! Time of a fit, beside NumPy's least squares on the same matrix: `cargo bench --bench identify`, with `python3` and
//! NumPy in reach (or `NUMPY=path/to/python`).

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use abbe::algebra::linear::Triangle;
use abbe::diagnostic::Diagnostics;
use abbe::evaluate::{Frame, Order, evaluate, random_poses};
use abbe::identify::{FitModel, Measurement, Parameter, Reading, Solution, fit, parameters};
use abbe::machine::{self, Approach, Machine};
use abbe::syntax::Disk;
use abbe::syntax::{self, IdentifyEntry};
use std::time::Instant;

const RUNS: usize = 5;

fn machine(name: &str) -> Machine {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name);
    let mut diagnostics = Diagnostics::default();
    let document = syntax::load(&path, &Disk, &mut diagnostics);
    document.and_then(|d| machine::resolve(&d, &Disk, &mut diagnostics)).unwrap()
}

fn wanted(machine: &Machine, words: &[&str]) -> Vec<Parameter> {
    let fit = words.iter().map(|w| (*w).to_owned()).collect();
    parameters(machine, &IdentifyEntry { fit, ..IdentifyEntry::default() }).unwrap()
}

/// Returns readings of the machine of the file at random poses, with a noise of about 1 um.
fn data(machine: &Machine, count: usize) -> Vec<Measurement> {
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 3.5e-3
    };
    let place = abbe::diagnostic::Place { source: Diagnostics::default().sources.add("bench", ""), range: 0..0 };
    let one = |pose: Vec<f64>| {
        let d = evaluate(machine, &Approach::Mean.at_pose(&pose), Order::Exact, Frame::Workpiece).deviation.position;
        let values = [Some(d.x + noise()), Some(d.y + noise()), Some(d.z + noise())];
        let reading = Reading::Deviation { values, frame: Frame::Workpiece, zero: [None; 3] };
        Measurement::new(pose, reading, place.clone())
    };
    random_poses(machine, count, 7).into_iter().map(one).collect()
}

/// Shortest and median of some runs, in ms.
fn timed<T>(mut f: impl FnMut() -> T) -> (f64, f64) {
    let one = |_| {
        let start = Instant::now();
        std::hint::black_box(f());
        start.elapsed().as_secs_f64() * 1e3
    };
    let mut times: Vec<f64> = (0..RUNS).map(one).collect();
    times.sort_by(f64::total_cmp);
    (times[0], times[RUNS / 2])
}

fn said(what: &str, (best, median): (f64, f64)) {
    println!("{what:<64} {best:>9.2} ms best, {median:>9.2} ms median of {RUNS}");
}

fn fits(name: &str, machine: &Machine, words: &[&str], poses: usize) {
    let unknowns = wanted(machine, words);
    let rows = data(machine, poses);
    let model = FitModel::new(machine, &unknowns);
    let weights = vec![1.0; rows.len()];
    let whole = || {
        let found = fit(&model, &rows, weights.clone());
        (Solution::of(&found, &unknowns), found.steps)
    };
    let (solution, steps) = whole();
    println!(
        "{name}: {} readings, {} parameters, rank {}, condition {:.0}, {steps} steps",
        3 * poses,
        unknowns.len(),
        solution.rank,
        solution.condition
    );
    said("  fit, rank, uncertainties", timed(whole));
    let theta = solution.theta();
    said("  triangle of all rows at one place", timed(|| model.triangle(&rows, &weights, &theta)));
}

/// A plain matrix, to compare with NumPy on the same numbers.
fn matrix(rows: usize, columns: usize) -> Vec<f64> {
    let mut state = 42_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..rows * (columns + 1)).map(|_| next()).collect()
}

fn compared(rows: usize, columns: usize) {
    let width = columns + 1;
    let values = matrix(rows, columns);
    println!("least squares on one matrix, {rows} x {columns}, streamed, one thread");
    let triangle = || {
        let mut triangle = Triangle::new(columns);
        values.chunks(width).for_each(|row| triangle.extend(1).copy_from_slice(row));
        triangle.finish()
    };
    said("  triangle (blockwise QR)", timed(triangle));
    let reduced = triangle();
    let x = reduced.r.solve_upper_triangular(&reduced.right).unwrap();
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("matrix.f64");
    std::fs::write(&path, values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
    let python = std::env::var("NUMPY").unwrap_or_else(|_| "python3".to_owned());
    let script = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/lstsq.py");
    let arguments = [path.to_str().unwrap(), &rows.to_string(), &width.to_string(), &RUNS.to_string()];
    let output = std::process::Command::new(python).arg(script).args(arguments).output();
    let output = output.unwrap_or_else(|failure| panic!("python3: {failure}"));
    if !output.status.success() {
        println!(
            "  NumPy: not compared ({})",
            String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default()
        );
        return;
    }
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let (report, solution) = text.split_once("x\n").unwrap();
    print!("{report}");
    let theirs = solution.lines().map(|line| line.parse::<f64>().unwrap());
    let gap = theirs.zip(x.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("  largest difference of the solutions: {gap:.1e}");
}

fn main() {
    let vmc = machine("vmc-cframe-754.yaml");
    fits(
        "18 parameters",
        &vmc,
        &["EXX:poly2", "EYY:poly2", "EZZ:poly2", "EYX:poly4", "EC0Y", "EB0Z", "EA0Z", "ECX:poly2"],
        360,
    );
    let all = ["X", "Y", "Z"].map(|axis| ["X", "Y", "Z", "A", "B", "C"].map(|d| format!("E{d}{axis}")));
    let curves: Vec<String> = all.iter().flatten().map(|name| format!("{name}:spline6")).collect();
    let words: Vec<&str> = curves.iter().map(String::as_str).collect();
    fits("all curves of three axes", &vmc, &words, 33_334);
    let trunnion = machine("trunnion.yaml");
    let free: Vec<String> =
        ["EXX:spline13", "EYY:spline13", "EZZ:spline13", "ECC:fourier10", "EAA:spline9", "EC0Y", "EB0Z", "EA0Z"]
            .into_iter()
            .map(str::to_owned)
            .chain(["EX0C", "EY0C", "EA0C", "EB0C", "EY0A", "EZ0A", "EB0A", "EC0A"].map(str::to_owned))
            .chain(["EZX:spline9", "EZY:spline9"].map(str::to_owned))
            .collect();
    let words: Vec<&str> = free.iter().map(String::as_str).collect();
    fits("five axes", &trunnion, &words, 33_334);
    compared(100_000, 100);
}
