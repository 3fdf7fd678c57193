//! A field over any number of poses: statistics without keeping the deviations.

use super::map::{View, into_frame};
use crate::evaluate::{
    Batch, Columns, CompiledGrid, CompiledModel, Deviation, Field, Frame, PoseColumns, Poses, Statistics, Tally,
};
use crate::machine::Pose;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// More poses than this take hours.
pub const MAX_SURVEYED: usize = 1_000_000_000;

/// Poses of a block: the unit in which sums are formed. Its poses and deviations stay in the second cache.
const BLOCK: usize = 1 << 12;

/// Statistics and the worst poses. Quantiles are within [`Tally::QUANTILE_ERROR`] of the exact ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// What the deviations come to.
    pub statistics: Statistics,
    /// The worst poses by number with their deviations (mm, rad), largest first.
    pub worst: Vec<(usize, Deviation)>,
}

/// What is to be surveyed.
#[derive(Clone, Copy)]
pub struct SurveyTask<'a> {
    /// The field; its plan does the work if it has one.
    pub field: &'a dyn Field,
    /// Where.
    pub poses: &'a Poses,
    /// From which side, and in which frame.
    pub view: View,
    /// How many of the worst poses to keep.
    pub worst: usize,
}

/// Consecutive poses of a survey with their deviations.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    /// Index of the first.
    pub first: usize,
    poses: &'a Batch<'a>,
    columns: &'a Columns,
    len: usize,
}

impl Block<'_> {
    /// The poses (mm, deg) with their deviations (mm, rad).
    pub fn rows(&self) -> impl Iterator<Item = (Pose, Deviation)> {
        (0..self.len).map(|i| (self.poses.pose(i), self.columns.get(i)))
    }
}

/// Surveys a field. Memory does not grow with the number of poses, and no bit depends on the number of threads.
/// `progress` is told how many poses were done.
pub fn survey(task: SurveyTask<'_>, progress: &(dyn Fn(usize) + Sync)) -> Survey {
    let run = Run::new(task, progress, false);
    // Every thread takes the next block when it is done with one: none waits for another, and each has one tally.
    let (next, count) = (AtomicUsize::new(0), run.blocks());
    (0..rayon::current_num_threads().min(count)).into_par_iter().with_max_len(1).for_each(|_| {
        let mut worker = run.worker();
        loop {
            let block = next.fetch_add(1, Ordering::Relaxed);
            if block >= count {
                break;
            }
            run.block(&mut worker, block);
        }
        run.dismiss(worker);
    });
    run.finished()
}

/// The same, with something made of every block, on any thread; `sink` takes these in the order of the poses.
/// `None` if it has had enough.
pub fn survey_with_rows<T: Send>(
    task: SurveyTask<'_>,
    make: &(dyn Fn(Block<'_>) -> T + Sync),
    sink: &mut dyn FnMut(T) -> bool,
    progress: &(dyn Fn(usize) + Sync),
) -> Option<Survey> {
    let run = Run::new(task, progress, true);
    let round = 8 * rayon::current_num_threads();
    for start in (0..run.blocks()).step_by(round) {
        let blocks = start..(start + round).min(run.blocks());
        let one = |block: usize| {
            let mut worker = run.worker();
            let range = run.block(&mut worker, block);
            let (first, len) = (range.start, range.len());
            let made = make(Block { first, poses: &worker.poses.batch(), columns: &worker.columns, len });
            run.dismiss(worker);
            made
        };
        let done: Vec<T> = blocks.into_par_iter().map(one).collect();
        for made in done {
            if !sink(made) {
                return None;
            }
        }
    }
    Some(run.finished())
}

/// What all threads share.
struct Run<'a> {
    task: SurveyTask<'a>,
    count: usize,
    /// Poses of a block: of a grid whole lines.
    block: usize,
    grid: Option<CompiledGrid>,
    frames: Option<CompiledModel>,
    /// Are the positions of the poses needed? A grid knows its own.
    positions: bool,
    progress: &'a (dyn Fn(usize) + Sync),
    /// Workers that have nothing to do: as many as there are threads, for setting one up costs as much as a block.
    idle: Mutex<Vec<Worker>>,
}

/// What does one block after the other.
struct Worker {
    /// Of all its blocks.
    tally: Tally,
    poses: PoseColumns,
    columns: Columns,
}

impl<'a> Run<'a> {
    fn new(task: SurveyTask<'a>, progress: &'a (dyn Fn(usize) + Sync), rows: bool) -> Self {
        let grid = match task.poses {
            Poses::Nodes(nodes) => task.field.compiled_model(task.view.approach).and_then(|model| model.grid(nodes)),
            _ => None,
        };
        let grid = grid.filter(|grid| grid.line() > 1);
        let block = grid.as_ref().map_or(BLOCK, |grid| (BLOCK / grid.line()).max(1) * grid.line());
        let frames = (task.view.frame != Frame::Workpiece).then(|| super::map::frames(task.field));
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

    /// All tallies in one.
    fn finished(self) -> Survey {
        let workers = self.idle.into_inner().unwrap_or_else(PoisonError::into_inner);
        let tallies = workers.into_iter().map(|worker| worker.tally);
        let tally = tallies.reduce(Tally::merged).unwrap_or_else(|| Tally::new(self.task.worst));
        Survey { statistics: tally.statistics(), worst: tally.worst() }
    }

    /// One block more; returns which poses it has.
    fn block(&self, worker: &mut Worker, block: usize) -> Range<usize> {
        let Worker { tally, poses, columns } = worker;
        let range = block * self.block..((block + 1) * self.block).min(self.count);
        let len = range.len();
        if self.positions {
            self.task.poses.fill(range.clone(), poses);
        }
        match &self.grid {
            Some(grid) => grid.fill(range.start / grid.line(), columns.output(len)),
            None => self.task.field.deviations(&poses.batch(), self.task.view.approach, columns.output(len)),
        }
        into_frame(self.frames.as_ref(), self.task.view.frame, &poses.batch(), columns.output(len));
        tally.add(range.start, columns, len);
        (self.progress)(len);
        range
    }
}
