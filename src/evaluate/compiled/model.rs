//! A machine, compiled: the choice of the kernel, and batches of poses through it.

use super::batch::{Batch, Columns, Output, Slices};
use super::chain::CompiledChain;
use super::exact::ExactModel;
use super::first::FirstOrder;
use super::lanes::run;
use super::pass::{Pass, PoseKernel};
use super::second::SecondOrder;
use super::width::Width;
use crate::evaluate::deviation::{Order, command_deviation, unturned_deviation};
use crate::evaluate::terms::Deviation;
use crate::lower::NominalPose;
use crate::machine::{Machine, OperatingConditions};

/// Maximum number of axes of a kernel; longer chains go through the general algebra.
pub const MAX_AXES: usize = 16;

/// Minimum number of poses of a task for one thread.
const BLOCK: usize = 4096;

/// Minimum number of tasks of a large batch, so that all threads end together.
const MIN_TASKS: usize = 64;

/// Maximum number of [`BLOCK`]s of a task.
const MAX_BLOCKS: usize = 8;

/// A machine compiled for an order and operating conditions. Deviations are actual minus nominal (mm, rad), workpiece
/// frame.
#[derive(Debug, Clone)]
pub struct CompiledModel {
    pub(super) machine: Machine,
    order: Order,
    conditions: OperatingConditions,
    pub(super) width: Width,
    /// `None` if the chain cannot be compiled.
    pub(super) chain: Option<CompiledChain>,
    pub(super) kernel: OrderKernel,
}

/// The kernel of an order.
#[derive(Debug, Clone)]
pub enum OrderKernel {
    First(FirstOrder),
    Second(SecondOrder),
    Exact(Box<ExactModel>),
    /// Pose by pose over the general algebra.
    General,
}

impl CompiledModel {
    /// Compiles a machine, which is copied. A machine that cannot be compiled runs through the general algebra: this
    /// never fails.
    pub fn new(machine: &Machine, order: Order, conditions: impl Into<OperatingConditions>) -> Self {
        let conditions = conditions.into();
        let chain = CompiledChain::new(machine, conditions).filter(|chain| chain.joints.len() <= MAX_AXES);
        let kernel = chain.as_ref().and_then(|chain| match order {
            Order::Degree(0 | 1) => FirstOrder::new(chain).map(OrderKernel::First),
            Order::Degree(2) => SecondOrder::new(chain.clone()).map(OrderKernel::Second),
            Order::Degree(_) => None,
            Order::Exact => ExactModel::new(chain.clone()).map(|exact| OrderKernel::Exact(Box::new(exact))),
        });
        let kernel = kernel.unwrap_or(OrderKernel::General);
        Self { machine: machine.clone(), order, conditions, width: Width::widest(), chain, kernel }
    }

    /// Returns the model with vectors of this width; a width that the processor lacks runs as [`Width::Scalar`].
    #[must_use]
    pub fn with_width(mut self, width: Width) -> Self {
        self.width = width;
        self
    }

    /// Returns the machine.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Returns the order.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Returns the operating conditions.
    pub fn conditions(&self) -> OperatingConditions {
        self.conditions
    }

    /// True if poses run on vectors rather than one by one through the general algebra.
    pub fn is_compiled(&self) -> bool {
        !matches!(self.kernel, OrderKernel::General)
    }

    /// Computes the deviations at the first `out.len()` poses (mm, deg) on this thread; `poses` holds at least as many.
    pub fn deviations(&self, poses: &Batch<'_>, out: Output<'_>) {
        self.block(Slices { axes: poses.axes(), added: &[], whole: out.len() }, out);
    }

    /// Computes the deviations at as many poses as both `poses` and `out` hold, on all threads of rayon's pool; the
    /// same bits as [`Self::deviations`].
    pub fn deviations_parallel(&self, poses: &Batch<'_>, out: Output<'_>) {
        let whole = poses.len().min(out.len());
        self.piece_parallel(poses, out, whole);
    }

    /// Computes a piece of a batch of `whole` poses as [`Self::deviations_parallel`] computes it as part of the batch:
    /// deviations of a large one are stored past the caches.
    pub fn piece_parallel(&self, poses: &Batch<'_>, out: Output<'_>, whole: usize) {
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

    /// Computes the residual of a correction: the position of the actual machine at the commands `poses + added` (mm,
    /// deg) minus that of the nominal machine at `poses`. Returns `None` unless the order is exact and `added` has the
    /// shape of `poses`.
    pub fn commanded(&self, poses: &Batch<'_>, added: &Batch<'_>, out: Output<'_>) -> Option<()> {
        let fits = self.order == Order::Exact && added.len() == poses.len() && added.axes().len() == poses.axes().len();
        fits.then(|| self.block(Slices { axes: poses.axes(), added: added.axes(), whole: out.len() }, out))
    }

    /// Returns the deviation at one pose (mm, deg).
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
        let (width, all) = (self.width, out.reborrow());
        match &self.kernel {
            OrderKernel::First(kernel) => {
                run_padded(width, Pass { kernel, poses, out: all, uncovered: &mut uncovered })
            }
            OrderKernel::Second(kernel) => {
                run_padded(width, Pass { kernel, poses, out: all, uncovered: &mut uncovered })
            }
            OrderKernel::Exact(kernel) => {
                run_padded(width, Pass { kernel: kernel.as_ref(), poses, out: all, uncovered: &mut uncovered });
            }
            OrderKernel::General => uncovered.extend(0..all.len()),
        }
        uncovered.sort_unstable();
        uncovered.dedup();
        for index in uncovered {
            let pose: Vec<f64> = poses.axes.iter().map(|column| column[index]).collect();
            let deviation = if poses.added.is_empty() {
                self.general(&pose)
            } else {
                let command: Vec<f64> = pose.iter().zip(poses.added).map(|(q, column)| q + column[index]).collect();
                command_deviation(
                    &self.machine,
                    &NominalPose::at(&self.machine, &pose).pose,
                    &self.conditions.at_pose(&command),
                )
            };
            out.put(index, &deviation);
        }
    }

    /// Returns the deviation over the general algebra.
    fn general(&self, pose: &[f64]) -> Deviation {
        unturned_deviation(&self.machine, &self.conditions.at_pose(pose), self.order)
    }
}

/// Runs a pass; poses fewer than a vector holds are padded with copies of the last.
fn run_padded<T: PoseKernel>(width: Width, pass: Pass<'_, '_, T>) {
    let (count, lanes) = (pass.out.len(), width.lanes());
    if count == 0 || count >= lanes {
        return run(width, pass);
    }
    let Pass { kernel, poses, mut out, uncovered } = pass;
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
