//! The last touches to a chosen sequence: whole turns of endless and long axes, and the turn of a free axis spread over
//! the rows at which it is free.

use super::steps::{ChosenPose, Steps};
use crate::analysis::inverse::{CandidateSearch, is_wound};
use crate::machine::{Machine, Pose, Travel};
use std::ops::Range;

/// A position beyond its bounds by less (mm, deg) is within them.
const ROUNDING: f64 = 1e-9;

/// Settles the poses of a path.
pub fn settle(machine: &Machine, steps: &Steps<'_>, search: &CandidateSearch<'_>, path: &mut [ChosenPose]) {
    let wound: Vec<usize> = (0..machine.axes().len()).filter(|axis| is_wound(&machine.axes()[*axis])).collect();
    for k in 1..path.len() {
        for axis in &wound {
            path[k].pose[*axis] = path[k - 1].pose[*axis] + steps.by(*axis, &path[k - 1].pose, &path[k].pose);
        }
    }
    for run in free_runs(path) {
        spread(search, path, run);
    }
    for axis in wound {
        fit_turns(path, axis, machine.axes()[axis].travel);
    }
}

/// Returns the longest runs of rows at which the same axis is free.
fn free_runs(path: &[ChosenPose]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut from = 0;
    while from < path.len() {
        let to = from + path[from..].iter().take_while(|of| of.free == path[from].free).count();
        if path[from].free.is_some() {
            runs.push(from..to);
        }
        from = to;
    }
    runs
}

/// Spreads the turn of a free axis from the row before a run to that after it evenly over the run; at the start of a
/// path the axis stands where it is needed first. Left as it is where the sequence has a reason to turn otherwise.
fn spread(search: &CandidateSearch<'_>, path: &mut [ChosenPose], run: Range<usize>) {
    let (Some(axis), Some(after)) = (path[run.start].free, path.get(run.end)) else { return };
    let exit = after.pose[axis];
    let entry = if run.start == 0 { exit } else { path[run.start - 1].pose[axis] };
    let between = entry.min(exit) - ROUNDING..=entry.max(exit) + ROUNDING;
    if run.start > 0 && !run.clone().all(|k| between.contains(&path[k].pose[axis])) {
        return;
    }
    let steps = (run.len() + 1) as f64;
    let settled = |(k, of): (usize, &ChosenPose)| {
        let mut pose = of.pose.clone();
        pose[axis] = entry + (exit - entry) * ((k + 1) as f64 / steps);
        search.completed(&of.target, pose)
    };
    if let Some(poses) = path[run.clone()].iter().enumerate().map(settled).collect::<Option<Vec<Pose>>>() {
        path[run].iter_mut().zip(poses).for_each(|(of, pose)| of.pose = pose);
    }
}

/// Shifts an axis by whole turns into a travel (deg), if it has ends. Where the whole path does not fit, each part is
/// as long as the travel allows; between two parts the axis rewinds.
fn fit_turns(path: &mut [ChosenPose], axis: usize, travel: Travel) {
    let Travel::Range(min, max) = travel else { return };
    let shifts = |low: f64, high: f64| {
        let [first, last] = [((min - low) / 360.0 - ROUNDING).ceil(), ((max - high) / 360.0 + ROUNDING).floor()];
        (first <= last).then(|| 0.0_f64.clamp(first, last))
    };
    let mut from = 0;
    while from < path.len() {
        let (mut low, mut high) = (path[from].pose[axis], path[from].pose[axis]);
        let mut shift = shifts(low, high);
        let mut to = from + 1;
        while to < path.len() {
            let q = path[to].pose[axis];
            let Some(wider) = shifts(low.min(q), high.max(q)) else { break };
            (low, high, shift) = (low.min(q), high.max(q), Some(wider));
            to += 1;
        }
        let by = 360.0 * shift.unwrap_or(0.0);
        path[from..to].iter_mut().for_each(|of| of.pose[axis] = (of.pose[axis] + by).clamp(min, max));
        from = to;
    }
}
