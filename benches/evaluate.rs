//! Samples of the compiled evaluator, on request: `evaluate MACHINE.yaml POSES` reads the names of samples from
//! standard input, one a line, runs each once, and answers with nanoseconds per pose. `benches/run` asks for them in
//! turn with those of other programs, so that ratios are of the same minute. POSES holds columns of doubles, one per
//! axis.

#![allow(
    clippy::needless_range_loop,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    missing_docs
)]

mod naive;

use abbe::analysis::{SurveyTask, View, survey};
use abbe::diagnostic::Diagnostics;
use abbe::evaluate::{Batch, Columns, CompiledField, CompiledModel, Field, Nodes, Order, Poses, Width};
use abbe::machine::{Approach, Machine};
use abbe::syntax::Disk;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

fn machine(path: &Path) -> Machine {
    let mut diagnostics = Diagnostics::default();
    let document = abbe::syntax::load(path, &Disk, &mut diagnostics).expect("a machine file");
    abbe::machine::resolve(&document, &Disk, &mut diagnostics).expect("a machine")
}

fn doubles(path: &Path) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap();
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

/// Everything samples need, made once.
struct Bench {
    machine: Machine,
    numbers: Vec<f64>,
    len: usize,
    out: Columns,
    copy: Columns,
}

impl Bench {
    fn new(machine_file: &str, poses: &str) -> Self {
        let machine = machine(Path::new(machine_file));
        let numbers = doubles(Path::new(poses));
        let len = numbers.len() / machine.axes().len();
        Self { machine, len, numbers, out: Columns::new(len), copy: Columns::new(len) }
    }

    /// Nanoseconds per pose of the sample with this name.
    fn sample(&mut self, name: &str) -> Option<f64> {
        let words: Vec<&str> = name.split(' ').collect();
        let batch = Batch::new(self.numbers.chunks_exact(self.len).collect(), self.len).unwrap();
        let len = self.len;
        let clock = |count: usize, run: &mut dyn FnMut()| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e9 / count as f64
        };
        match words[..] {
            ["copy"] => Some(clock(len, &mut || copy(&mut self.copy, std::hint::black_box(&self.out)))),
            ["batch", order, width, threads] => {
                let plan = plan(&self.machine, order, width);
                let out = self.out.output(len);
                Some(match threads {
                    "1" => clock(len, &mut once(|| plan.deviations(&batch, out))),
                    _ => clock(len, &mut once(|| plan.deviations_parallel(&batch, out))),
                })
            }
            ["grid", order, width, threads] => {
                let plan = plan(&self.machine, order, width);
                let grid = plan.grid(&Nodes::of(&self.machine)).unwrap();
                let nodes = len.min(grid.lines().saturating_mul(grid.line())) / grid.line() * grid.line();
                let first = grid.lines() / 3;
                let first = first.min(grid.lines() - nodes / grid.line());
                let out = self.out.output(nodes);
                Some(match threads {
                    "1" => clock(nodes, &mut once(|| grid.fill(first, out))),
                    _ => clock(nodes, &mut once(|| grid.fill_parallel(first, out))),
                })
            }
            ["survey", order, threads] => {
                let order = order.parse().map_or(Order::Exact, Order::Degree);
                let field = CompiledField::new(&self.machine, order);
                let poses = Poses::Nodes(Nodes::of(&self.machine));
                let view = View::default();
                // As with batches: the plan is compiled and the threads exist before the clock starts.
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.parse().ok()?).build().unwrap();
                let _ = (field.compiled_model(view.conditions), pool.broadcast(|_| ()));
                let task = SurveyTask { field: &field, poses: &poses, view, worst: 5 };
                Some(clock(poses.len(), &mut || drop(pool.install(|| survey(task, &|_| Ok(()))))))
            }
            ["general", order] => {
                let plan = plan(&self.machine, order, "widest");
                let few = 4096.min(len);
                Some(clock(few, &mut || (0..few).for_each(|i| naive::general(&plan, &batch.pose(i), &mut self.out, i))))
            }
            ["naive"] => {
                let chain = naive::Chain::new(&self.machine);
                let few = (1 << 17).min(len);
                Some(clock(few, &mut || chain.run(&batch, &mut self.out, few)))
            }
            ["dump", path] => {
                let columns = self.out.position.iter().chain(&self.out.rotation);
                let bytes: Vec<u8> = columns.flatten().flat_map(|x| x.to_le_bytes()).collect();
                std::fs::write(path, bytes).unwrap();
                Some(0.0)
            }
            _ => None,
        }
    }
}

/// Copies into existing memory: `clone_from` of a derived `Clone` would ask for new pages.
fn copy(to: &mut Columns, from: &Columns) {
    let from = from.position.iter().chain(&from.rotation);
    to.position.iter_mut().chain(&mut to.rotation).zip(from).for_each(|(to, from)| to.copy_from_slice(from));
}

/// A closure that is called once, as one that might be called again.
fn once(run: impl FnOnce()) -> impl FnMut() {
    let mut run = Some(run);
    move || run.take().expect("called once")()
}

fn plan(machine: &Machine, order: &str, width: &str) -> CompiledModel {
    let order = order.parse().map_or(Order::Exact, Order::Degree);
    let width = match width {
        "scalar" => Width::Scalar,
        "fused" => Width::Fused,
        "avx2" => Width::Avx2,
        "avx512" => Width::Avx512,
        "neon" => Width::Neon,
        _ => Width::widest(),
    };
    CompiledModel::new(machine, order, Approach::Mean).with_width(width)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let [machine, poses] = &arguments[..] else {
        println!("samples on request: evaluate MACHINE.yaml POSES; see benches/run");
        return;
    };
    let mut bench = Bench::new(machine, poses);
    println!("ready {:?} {}", Width::widest(), bench.len);
    for line in std::io::stdin().lock().lines() {
        match bench.sample(line.unwrap().trim()) {
            Some(time) => println!("{time}"),
            None => println!("unknown"),
        }
        std::io::stdout().flush().unwrap();
    }
}
