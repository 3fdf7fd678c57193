//! The kernels of the compiled evaluator by themselves, for whoever works on them: `cargo bench --bench kernels` in
//! this package. Ratios to other programs are the business of `benches/run`, which takes turns.

#![allow(clippy::unwrap_used)]

use abbe::analysis::{SurveyTask, View, survey};
use abbe::diagnostic::Diagnostics;
use abbe::evaluate::{Columns, CompiledField, CompiledModel, Nodes, Order, PoseColumns, Poses, Random, Width};
use abbe::machine::{Approach, Machine};
use abbe::syntax::Disk;
use divan::Bencher;
use divan::counter::ItemsCount;
use std::path::Path;

/// Poses of a sample: they stay in the cache, so that kernels are measured and not the memory.
const POSES: usize = 1 << 12;
const ORDERS: [Order; 3] = [Order::Degree(1), Order::Degree(2), Order::Exact];
const WIDTHS: [Width; 6] = Width::ALL;

fn main() {
    divan::main();
}

fn trunnion() -> Machine {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../configs/trunnion.yaml"));
    let mut diagnostics = Diagnostics::default();
    let document = abbe::syntax::load(path, &Disk, &mut diagnostics).unwrap();
    abbe::machine::resolve(&document, &Disk, &mut diagnostics).unwrap()
}

/// Every order at every width that this processor has.
fn kernels() -> Vec<(Order, Width)> {
    let widths = || WIDTHS.into_iter().filter(|width| width.is_supported());
    ORDERS.into_iter().flat_map(|order| widths().map(move |width| (order, width))).collect()
}

#[divan::bench(args = kernels())]
fn scattered(bencher: Bencher, (order, width): (Order, Width)) {
    let machine = trunnion();
    let plan = CompiledModel::new(&machine, order, Approach::Mean).with_width(width);
    let mut poses = PoseColumns::new(machine.axes().len());
    Poses::Random(Random::of(&machine, POSES, 7)).fill(0..POSES, &mut poses);
    let mut out = Columns::new(POSES);
    bencher.counter(ItemsCount::new(POSES)).bench_local(|| plan.deviations(&poses.batch(), out.output(POSES)));
}

#[divan::bench(args = kernels())]
fn grid(bencher: Bencher, (order, width): (Order, Width)) {
    let machine = trunnion();
    let model = CompiledModel::new(&machine, order, Approach::Mean).with_width(width);
    let grid = model.grid(&Nodes::of(&machine)).unwrap();
    let nodes = POSES / grid.line() * grid.line();
    let mut out = Columns::new(nodes);
    bencher.counter(ItemsCount::new(nodes)).bench_local(|| grid.fill(grid.lines() / 3, out.output(nodes)));
}

#[divan::bench(args = ORDERS)]
fn statistics(bencher: Bencher, order: Order) {
    let machine = trunnion();
    let (field, poses) = (CompiledField::new(&machine, order), Poses::Nodes(Nodes::of(&machine)));
    let task = SurveyTask { field: &field, poses: &poses, view: View::default(), worst: 5 };
    bencher.counter(ItemsCount::new(poses.len())).bench_local(|| survey(task, &|_| Ok(())));
}

#[divan::bench(args = ORDERS)]
fn compilation(bencher: Bencher, order: Order) {
    let machine = trunnion();
    bencher.bench_local(|| CompiledModel::new(&machine, order, Approach::Mean));
}
