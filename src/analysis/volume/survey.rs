//! Surveys: statistics of a field over any number of poses, without keeping the deviations.

use super::map::{View, into_frame};
use crate::evaluate::{
    Batch, Columns, CompiledGrid, CompiledModel, Deviation, Field, PoseColumns, Poses, Statistics, Tally,
};
use crate::machine::Pose;
use crate::run::{Advance, Cancelled};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Maximum number of poses of a survey; more take hours.
pub const MAX_SURVEYED: usize = 1_000_000_000;

/// Poses of a block, the unit in which sums are formed. Its poses and deviations stay in the second cache.
const BLOCK: usize = 1 << 12;

/// Statistics and the worst poses. Quantiles are within [`Tally::QUANTILE_ERROR`] of the exact ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Statistics of the deviations.
    pub statistics: Statistics,
    /// The worst poses by index with their deviations (mm, rad), largest first.
    pub worst: Vec<(usize, Deviation)>,
}

/// The request for a survey.
#[derive(Clone, Copy)]
pub struct SurveyTask<'a> {
    /// The field; its compiled model evaluates grids if it has one.
    pub field: &'a dyn Field,
    /// The poses.
    pub poses: &'a Poses,
    /// Operating conditions, and frame of the deviations.
    pub view: View,
    /// Number of worst poses to keep.
    pub worst: usize,
}

/// Consecutive poses of a survey with their deviations.
#[derive(Clone, Copy)]
pub struct SurveyBlock<'a> {
    /// Index of the first pose.
    pub first: usize,
    poses: &'a Batch<'a>,
    columns: &'a Columns,
    len: usize,
}

impl SurveyBlock<'_> {
    /// Returns the poses (mm, deg) with their deviations (mm, rad).
    pub fn rows(&self) -> impl Iterator<Item = (Pose, Deviation)> {
        (0..self.len).map(|i| (self.poses.pose(i), self.columns.get(i)))
    }
}

/// Returns the survey of a field. Memory does not grow with the number of poses, and no bit depends on the number of
/// threads. Calls `progress` with the number of poses done since its last call.
pub fn survey(task: SurveyTask<'_>, progress: Advance<'_>) -> Result<Survey, Cancelled> {
    let run = SurveyState::new(task, progress, false);
    // A thread takes the next block when it has finished one: none waits for another, and each has one tally.
    let (next, count) = (AtomicUsize::new(0), run.blocks());
    (0..rayon::current_num_threads().min(count)).into_par_iter().with_max_len(1).try_for_each(|_| {
        let mut worker = run.worker();
        loop {
            let block = next.fetch_add(1, Ordering::Relaxed);
            if block >= count {
                break;
            }
            let _ = run.block(&mut worker, block)?;
        }
        run.dismiss(worker);
        Ok(())
    })?;
    Ok(run.finish())
}

/// Returns the survey of a field, and calls `make` with every block, on any thread, and `sink` with the results in the
/// order of the poses. Returns `None` as soon as `sink` returns false.
pub fn survey_with_rows<T: Send>(
    task: SurveyTask<'_>,
    make: &(dyn Fn(SurveyBlock<'_>) -> T + Sync),
    sink: &mut dyn FnMut(T) -> bool,
    progress: Advance<'_>,
) -> Result<Option<Survey>, Cancelled> {
    let run = SurveyState::new(task, progress, true);
    let round = 8 * rayon::current_num_threads();
    for start in (0..run.blocks()).step_by(round) {
        let blocks = start..(start + round).min(run.blocks());
        let one = |block: usize| {
            let mut worker = run.worker();
            let range = run.block(&mut worker, block)?;
            let (first, len) = (range.start, range.len());
            let made = make(SurveyBlock { first, poses: &worker.poses.batch(), columns: &worker.columns, len });
            run.dismiss(worker);
            Ok(made)
        };
        let done: Vec<T> = blocks.into_par_iter().map(one).collect::<Result<_, Cancelled>>()?;
        for made in done {
            if !sink(made) {
                return Ok(None);
            }
        }
    }
    Ok(Some(run.finish()))
}

struct SurveyState<'a> {
    task: SurveyTask<'a>,
    count: usize,
    /// Poses of a block: of a grid whole lines.
    block: usize,
    grid: Option<CompiledGrid>,
    frames: Option<CompiledModel>,
    /// True if positions are computed; a grid has its own.
    positions: bool,
    progress: Advance<'a>,
    /// Idle workers, for reuse: setting one up costs as much as a block.
    idle: Mutex<Vec<Worker>>,
}

/// Buffers and tally of a thread.
struct Worker {
    tally: Tally,
    poses: PoseColumns,
    columns: Columns,
}

impl<'a> SurveyState<'a> {
    fn new(task: SurveyTask<'a>, progress: Advance<'a>, rows: bool) -> Self {
        let grid = match task.poses {
            Poses::Nodes(nodes) => task.field.compiled_model(task.view.conditions).and_then(|model| model.grid(nodes)),
            _ => None,
        };
        let grid = grid.filter(|grid| grid.line() > 1);
        let block = grid.as_ref().map_or(BLOCK, |grid| (BLOCK / grid.line()).max(1) * grid.line());
        let frames = super::map::frames(task.field, task.view.frame);
        let positions = rows || grid.is_none() || frames.is_some();
        Self { task, count: task.poses.len(), block, grid, frames, positions, progress, idle: Mutex::default() }
    }

    fn blocks(&self) -> usize {
        self.count.div_ceil(self.block)
    }

    fn worker(&self) -> Worker {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| Worker {
            tally: Tally::new(self.task.worst),
            poses: PoseColumns::new(self.task.field.machine().axes().len()),
            columns: Columns::new(self.block.min(self.count)),
        })
    }

    fn dismiss(&self, worker: Worker) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(worker);
    }

    fn finish(self) -> Survey {
        let workers = self.idle.into_inner().unwrap_or_else(PoisonError::into_inner);
        let tallies = workers.into_iter().map(|worker| worker.tally);
        let tally = tallies.reduce(Tally::merge).unwrap_or_else(|| Tally::new(self.task.worst));
        Survey { statistics: tally.statistics(), worst: tally.worst() }
    }

    /// Adds a block to a worker's tally; returns the indices of its poses.
    fn block(&self, worker: &mut Worker, block: usize) -> Result<Range<usize>, Cancelled> {
        let Worker { tally, poses, columns } = worker;
        let range = block * self.block..((block + 1) * self.block).min(self.count);
        let len = range.len();
        if self.positions {
            self.task.poses.fill(range.clone(), poses);
        }
        match &self.grid {
            Some(grid) => grid.fill(range.start / grid.line(), columns.output(len)),
            None => self.task.field.deviations(&poses.batch(), self.task.view.conditions, columns.output(len)),
        }
        into_frame(self.frames.as_ref(), self.task.view.frame, &poses.batch(), columns.output(len));
        tally.add(range.start, columns, len);
        (self.progress)(len)?;
        Ok(range)
    }
}
