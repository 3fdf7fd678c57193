//! A machine, compiled: the choice of the kernel, and batches of poses through it.

use super::batch::{Batch, Columns, Output, Slices};
use super::chain::CompiledChain;
use super::exact::ExactModel;
use super::first::FirstOrder;
use super::lanes::run;
use super::pass::{Pass, PoseKernel};
use super::second::SecondOrder;
use super::width::Width;
use crate::evaluate::deviation::{Deviation, Frame, Order, command_deviation, evaluate};
use crate::lower::NominalPose;
use crate::machine::{Approach, Machine};

/// Axes that kernels have room for; longer chains go through the general algebra.
pub const MAX_AXES: usize = 16;

/// Poses that one thread does at a time, at least.
const BLOCK: usize = 4096;

/// Of a larger batch that many pieces are made, so that threads end together; but none is of more blocks than this.
const MIN_TASKS: usize = 64;
const MAX_BLOCKS: usize = 8;

/// A machine compiled for an order and a side of approach. Deviations are those of the workpiece frame.
#[derive(Debug, Clone)]
pub struct CompiledModel {
    pub(super) machine: Machine,
    order: Order,
    approach: Approach,
    pub(super) width: Width,
    /// `None` if the chain cannot be compiled.
    pub(super) chain: Option<CompiledChain>,
    pub(super) kernel: OrderKernel,
}

#[derive(Debug, Clone)]
pub enum OrderKernel {
    First(FirstOrder),
    Second(SecondOrder),
    Exact(Box<ExactModel>),
    /// Pose by pose over the general algebra.
    General,
}

impl CompiledModel {
    /// Compiles. The machine is copied: a plan stands alone.
    pub fn new(machine: &Machine, order: Order, approach: Approach) -> Self {
        let chain = CompiledChain::new(machine, approach).filter(|chain| chain.joints.len() <= MAX_AXES);
        let kernel = chain.as_ref().and_then(|chain| match order {
            Order::Degree(0 | 1) => FirstOrder::new(chain).map(OrderKernel::First),
            Order::Degree(2) => SecondOrder::new(chain.clone()).map(OrderKernel::Second),
            Order::Degree(_) => None,
            Order::Exact => ExactModel::new(chain.clone()).map(|exact| OrderKernel::Exact(Box::new(exact))),
        });
        let kernel = kernel.unwrap_or(OrderKernel::General);
        Self { machine: machine.clone(), order, approach, width: Width::widest(), chain, kernel }
    }

    /// The same plan with narrower vectors; one that the processor has not is the scalar one.
    #[must_use]
    pub fn with_width(mut self, width: Width) -> Self {
        self.width = width;
        self
    }

    /// The machine.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The order.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The side of approach.
    pub fn approach(&self) -> Approach {
        self.approach
    }

    /// Does it run on vectors (rather than pose by pose over the general algebra)?
    pub fn is_compiled(&self) -> bool {
        !matches!(self.kernel, OrderKernel::General)
    }

    /// Deviations at a batch of poses, on this thread. As many as fit into `out` are computed.
    pub fn deviations(&self, poses: &Batch<'_>, out: Output<'_>) {
        self.block(Slices { axes: poses.axes(), added: &[], whole: out.len() }, out);
    }

    /// The same on all threads of rayon's pool.
    pub fn deviations_parallel(&self, poses: &Batch<'_>, out: Output<'_>) {
        let whole = poses.len().min(out.len());
        let task = (whole / MIN_TASKS).clamp(BLOCK, MAX_BLOCKS * BLOCK).next_multiple_of(BLOCK);
        self.parallel(poses, out, task, whole);
    }

    fn parallel(&self, poses: &Batch<'_>, out: Output<'_>, task: usize, whole: usize) {
        let count = poses.len().min(out.len());
        if count <= task {
            return self.block(Slices { axes: poses.axes(), added: &[], whole }, out);
        }
        let half = (count / 2).next_multiple_of(task);
        let ((low, high), (low_out, high_out)) = (poses.split_at(half), out.split_at(half));
        rayon::join(|| self.parallel(&low, low_out, task, whole), || self.parallel(&high, high_out, task, whole));
    }

    /// Exact deviations of commands, `added` to the positions, from where the nominal machine would be without: what is left
    /// of a correction. `None` unless the order is exact.
    pub fn commanded(&self, poses: &Batch<'_>, added: &Batch<'_>, out: Output<'_>) -> Option<()> {
        let fits = self.order == Order::Exact && added.len() == poses.len() && added.axes().len() == poses.axes().len();
        fits.then(|| self.block(Slices { axes: poses.axes(), added: added.axes(), whole: out.len() }, out))
    }

    /// Deviation at one pose.
    pub fn deviation(&self, pose: &[f64]) -> Deviation {
        let mut numbers = [0.0; 6];
        let [a, b, c, d, e, f] = numbers.each_mut().map(std::slice::from_mut);
        let columns: Vec<&[f64]> = pose.iter().map(std::slice::from_ref).collect();
        self.block(
            Slices { axes: &columns, added: &[], whole: 1 },
            Output { position: [a, b, c], rotation: [d, e, f] },
        );
        let [a, b, c, d, e, f] = numbers;
        Deviation { position: [a, b, c].into(), rotation: [d, e, f].into() }
    }

    fn block(&self, poses: Slices<'_>, mut out: Output<'_>) {
        let mut uncovered = Vec::new();
        let pass = (self.width, poses, &mut uncovered);
        match &self.kernel {
            OrderKernel::First(task) => run_padded(task, pass, out.reborrow()),
            OrderKernel::Second(task) => run_padded(task, pass, out.reborrow()),
            OrderKernel::Exact(task) => run_padded(task.as_ref(), pass, out.reborrow()),
            OrderKernel::General => uncovered.extend(0..out.len()),
        }
        uncovered.sort_unstable();
        uncovered.dedup();
        for index in uncovered {
            let pose: Vec<f64> = poses.axes.iter().map(|column| column[index]).collect();
            let deviation = if poses.added.is_empty() {
                self.general(&pose)
            } else {
                let command: Vec<f64> = pose.iter().zip(poses.added).map(|(q, column)| q + column[index]).collect();
                command_deviation(&self.machine, &NominalPose::at(&self.machine, &pose).pose, &command, self.approach)
            };
            out.put(index, &deviation);
        }
    }

    /// Over the general algebra.
    fn general(&self, pose: &[f64]) -> Deviation {
        evaluate(&self.machine, pose, self.order, self.approach, Frame::Workpiece).deviation
    }
}

/// Over all poses that there is room for; fewer than a vector are padded with the last of them.
fn run_padded<T: PoseKernel>(
    kernel: &T,
    (width, poses, uncovered): (Width, Slices<'_>, &mut Vec<usize>),
    mut out: Output<'_>,
) {
    let (count, lanes) = (out.len(), width.lanes());
    if count == 0 || count >= lanes {
        return run(width, Pass { kernel, poses, out, uncovered });
    }
    let padded = |columns: &[&[f64]]| -> Vec<Vec<f64>> {
        columns.iter().map(|q| (0..lanes).map(|i| q[i.min(count - 1)]).collect()).collect()
    };
    let (axes, added, mut columns) = (padded(poses.axes), padded(poses.added), Columns::new(lanes));
    let [axes, added] = [&axes, &added].map(|columns| columns.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let poses = Slices { axes: &axes, added: &added, whole: lanes };
    run(width, Pass { kernel, poses, out: columns.output(lanes), uncovered });
    uncovered.retain(|index| *index < count);
    (0..count).for_each(|index| out.put(index, &columns.get(index)));
}
