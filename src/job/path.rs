//! Events of tool poses as one path, by the lines of their file.

use crate::analysis::budget::{DrawnStep, Percentile, rank};
use crate::analysis::{AxisMotion, PathEvents, PoleCrossing, Rewind};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::Deviation;
use crate::machine::Machine;
use crate::units::{significant, with_interval};
use indexmap::IndexMap;
use std::collections::BTreeMap;

/// Events of a path on a machine.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PathResult {
    /// The steps in which the tool has to leave the path, in their order.
    pub rewinds: Vec<PathRewind>,
    /// The passages near the line of a rotary axis, axis by axis.
    pub pole_crossings: Vec<PathPole>,
    /// The motion of each axis.
    pub axes: Vec<PathAxis>,
    /// The largest change of the position deviation from one row to the next, in a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation_step: Option<DeviationStep>,
}

/// The largest change of the position deviation from one row to the next that is in reach, rewinds apart: the step that
/// it leaves in the part.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct DeviationStep {
    /// Length of the change, um, workpiece frame; of machines drawn between bounds the one that 95 % do not exceed.
    pub um: f64,
    /// The interval in which it lies, um; none where it is not drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_um: Option<[f64; 2]>,
    /// True if machines are drawn between bounds.
    pub drawn: bool,
    /// Lines of the file before and after it; of machines drawn in the one whose step that is.
    pub lines: [usize; 2],
}

/// The largest step of the deviation by index of the pose before it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LargestStep {
    /// Length of the change, mm.
    pub mm: f64,
    /// The interval in which it lies, mm; none where it is not drawn.
    pub interval_mm: Option<[f64; 2]>,
    /// True if machines are drawn between bounds.
    pub drawn: bool,
    /// Index of the pose before it among those that are reached.
    pub pose: usize,
}

impl LargestStep {
    /// Returns the largest step between deviations (mm) at poses, from those with these indices to the next.
    pub(crate) fn of_values(deviations: &[Deviation], steps: &[usize]) -> Option<Self> {
        let length = |i: usize| (deviations[i + 1].position - deviations[i].position).norm();
        let all = steps.iter().map(|i| Self { mm: length(*i), interval_mm: None, drawn: false, pose: *i });
        all.reduce(|largest, step| if step.mm > largest.mm { step } else { largest })
    }

    /// Returns the 95 % value of the largest steps of machines drawn, with the step of the machine that has it.
    pub(crate) fn of_machines(mut drawn: Vec<DrawnStep>) -> Option<Self> {
        drawn.sort_by(|a, b| a.length.total_cmp(&b.length));
        let lengths: Vec<f64> = drawn.iter().map(|step| step.length).collect();
        let DrawnStep { length: mm, pose } = *drawn.get(rank(lengths.len(), 95).checked_sub(1)?)?;
        let Percentile { low, high, .. } = Percentile::of(&lengths, 95);
        Some(Self { mm, interval_mm: low.zip(high).map(|(low, high)| [low, high]), drawn: true, pose })
    }
}

/// A step in which the tool has to leave the path.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PathRewind {
    /// Lines of the file before and after it.
    pub lines: [usize; 2],
    /// Motions of the rotary axes, deg.
    pub turns_deg: IndexMap<String, f64>,
}

/// A passage near the line of a rotary axis.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PathPole {
    /// Name of the rotary axis.
    pub axis: String,
    /// Lines of the file before and after it.
    pub lines: [usize; 2],
    /// The line after the step that comes nearest.
    pub nearest_line: usize,
    /// Least angle between the tool and the axis, deg.
    pub nearest_deg: f64,
    /// Angle by which the axis turns meanwhile, deg.
    pub turn_deg: f64,
    /// Largest turn of the axis per motion of the tip, deg/mm; none if the axis turns while the tip stands.
    pub deg_per_mm: Option<f64>,
}

/// The motion of an axis along a path.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PathAxis {
    /// Its name.
    pub axis: String,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// Sum of its motions, rewinds among them.
    pub motion: f64,
    /// Its largest motion from one row to the next, rewinds apart.
    pub largest_step: f64,
    /// The line after that step; none if it does not move.
    pub largest_step_line: Option<usize>,
    /// Lines of the file at which it reverses.
    pub reversals: Vec<usize>,
}

impl PathResult {
    /// Returns the events of a path on a machine; `lines` are those of its rows.
    pub(crate) fn new(machine: &Machine, events: &PathEvents, lines: &[usize]) -> Self {
        let name = |axis: usize| machine.axes()[axis].name.to_string();
        // Adding zero turns -0 into 0.
        let rewind = |of: &Rewind| PathRewind {
            lines: of.rows.map(|row| lines[row]),
            turns_deg: of.turns.iter().map(|(axis, deg)| (name(*axis), deg + 0.0)).collect(),
        };
        let pole = |of: &PoleCrossing| PathPole {
            axis: name(of.axis),
            lines: of.rows.map(|row| lines[row]),
            nearest_line: lines[of.nearest_row],
            nearest_deg: of.nearest_deg,
            turn_deg: of.turn_deg,
            deg_per_mm: of.deg_per_mm,
        };
        let axis = |(axis, of): (usize, &AxisMotion)| PathAxis {
            axis: name(axis),
            unit: machine.axes()[axis].unit(),
            motion: of.sum,
            largest_step: of.largest,
            largest_step_line: of.largest_row.map(|row| lines[row]),
            reversals: of.reversals.iter().map(|row| lines[*row]).collect(),
        };
        Self {
            rewinds: events.rewinds.iter().map(rewind).collect(),
            pole_crossings: events.poles.iter().map(pole).collect(),
            axes: events.axes.iter().enumerate().map(axis).collect(),
            deviation_step: None,
        }
    }

    /// Returns the warning about rewinds, if there are any.
    pub(crate) fn warning(&self, machine: &Machine) -> Option<Diagnostic> {
        let first = self.rewinds.first()?;
        let name = shown(machine.name());
        let plural = if self.rewinds.len() == 1 { "" } else { "s" };
        let message = format!(
            "`{name}` cannot cut the path without {} rewind{plural}, the first between lines {} and {}: {}",
            self.rewinds.len(),
            first.lines[0],
            first.lines[1],
            first.words(),
        );
        let help = "the tool leaves the part there; `path` of `--format json` lists all. More travel, another `place` \
                    of the part, or `--path no` for single poses";
        Some(Diagnostic::new(codes::W0851, message).help(help))
    }

    /// Returns the events at lines of the file in words; empty at a line without.
    pub(crate) fn words_at(&self, lines: impl IntoIterator<Item = usize>) -> Vec<String> {
        let words = self.words_by_line();
        lines.into_iter().map(|line| words.get(&line).cloned().unwrap_or_default()).collect()
    }

    /// Returns the events at each line of the file in words, such as `rewind` or `pole of C; reversal of X Y`.
    pub(crate) fn words_by_line(&self) -> BTreeMap<usize, String> {
        let mut words: BTreeMap<usize, Vec<String>> = BTreeMap::new();
        for rewind in &self.rewinds {
            words.entry(rewind.lines[1]).or_default().push("rewind".to_owned());
        }
        for pole in &self.pole_crossings {
            words.entry(pole.nearest_line).or_default().push(format!("pole of {}", pole.axis));
        }
        let mut reversals: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
        for axis in &self.axes {
            axis.reversals.iter().for_each(|line| reversals.entry(*line).or_default().push(&axis.axis));
        }
        for (line, axes) in reversals {
            words.entry(line).or_default().push(format!("reversal of {}", axes.join(" ")));
        }
        words.into_iter().map(|(line, words)| (line, words.join("; "))).collect()
    }
}

impl DeviationStep {
    /// Returns it in words, such as `Largest step between rows: 2.01 um, lines 17 to 18`.
    pub fn words(&self) -> String {
        let [from, to] = self.lines;
        let um = with_interval(self.um, self.interval_um);
        if !self.drawn {
            return format!("Largest step between rows: {um} um, lines {from} to {to}");
        }
        format!("Largest step between rows: 95 % of the machines within {um} um, there in lines {from} to {to}")
    }
}

impl PathRewind {
    /// Returns the turns in words, such as `C by -180 deg, A by 50 deg`.
    pub fn words(&self) -> String {
        let turn = |(axis, deg): (&String, &f64)| format!("{axis} by {} deg", significant(*deg, 4));
        self.turns_deg.iter().map(turn).collect::<Vec<_>>().join(", ")
    }
}
