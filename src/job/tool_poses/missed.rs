//! Tool poses that a machine does not reach: which axis, by how much, at which row; and the travel that a work needs.

use crate::analysis::{Miss, Needs, Unreachable, direction_gap, excess};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Machine, Travel};
use crate::units::significant;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::collections::HashMap;

/// A tool pose that a machine does not reach.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MissedToolPose {
    /// Line of the file, from 1.
    pub line: usize,
    /// Name of the feature to which it belongs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feature: Option<String>,
    /// The reason.
    pub why: Unreachable,
    /// The axes that would leave their travel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub beyond: Vec<BeyondTravel>,
    /// Angle between the tool axis and the nearest direction in which the machine can hold its tool, deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_deg: Option<f64>,
    /// Distance of the place from those that the axes span, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_mm: Option<f64>,
    /// True if no pose was found, without a proof that there is none.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub not_proved: bool,
}

/// An axis that would have to leave its travel.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct BeyondTravel {
    /// Name of the axis.
    pub axis: String,
    /// Distance from the nearer end of its travel: negative below the lower end.
    pub by: f64,
    /// `mm` or `deg`.
    pub unit: &'static str,
}

/// The travel that a work needs of an axis, and the travel that it has.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct NeededTravel {
    /// Name of the axis.
    pub axis: String,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// Smallest and largest position over the tool poses that are reached, or would be with longer travels.
    pub needs: [f64; 2],
    /// Ends of the travel; none of a continuous axis.
    pub has: Option<[f64; 2]>,
    /// Length by which the travel is too short at its lower and its upper end.
    pub short: [f64; 2],
}

impl MissedToolPose {
    /// Returns a miss at a line, with its feature; `off_deg` is the gap of a direction that cannot be held.
    pub(crate) fn new(
        machine: &Machine,
        (line, feature): (usize, Option<String>),
        miss: &Miss,
        off_deg: Option<f64>,
    ) -> Self {
        let of_axis = |axis: usize, by: f64| {
            let axis = &machine.axes()[axis];
            BeyondTravel { axis: axis.name.to_string(), by, unit: axis.unit() }
        };
        let pose = miss.beyond.as_deref().unwrap_or_default();
        let beyond = excess(machine.axes(), pose).into_iter().map(|e| of_axis(e.axis, e.by)).collect();
        Self { line, feature, why: miss.why, beyond, off_deg, off_mm: miss.off_mm, not_proved: !miss.is_proved }
    }

    /// Returns what is missing in words, such as `Z 84 mm below its travel`.
    pub fn words(&self) -> String {
        let open = if self.not_proved { " (not proved)" } else { "" };
        let axis = |b: &BeyondTravel| {
            let side = if b.by < 0.0 { "below" } else { "above" };
            format!("{} {} {} {side} its travel", b.axis, significant(b.by.abs(), 4), b.unit)
        };
        let lack = match (self.why, self.off_deg, self.off_mm) {
            (Unreachable::Travel, ..) if !self.beyond.is_empty() => {
                self.beyond.iter().map(axis).collect::<Vec<_>>().join(", ")
            }
            (_, Some(deg), _) if deg > 0.0 => format!("tool axis off by {} deg", significant(deg, 4)),
            (_, _, Some(mm)) => format!("place off by {} mm", significant(mm, 4)),
            (why, ..) => why.words().to_owned(),
        };
        lack + open
    }
}

/// The angles between directions and the nearest ones in which a machine can hold its tool: each direction is sought
/// once, however many rows have it.
pub(crate) struct DirectionGaps(HashMap<[u64; 3], f64>);

impl DirectionGaps {
    /// Finds the angles of these directions.
    pub(crate) fn new(machine: &Machine, directions: impl Iterator<Item = Vector3<f64>>) -> Self {
        let distinct: HashMap<_, _> = directions.map(|direction| (Self::key(&direction), direction)).collect();
        let gap = |(key, direction)| (key, direction_gap(machine, &direction).to_degrees());
        Self(distinct.into_par_iter().map(gap).collect())
    }

    fn key(direction: &Vector3<f64>) -> [u64; 3] {
        [0, 1, 2].map(|k| direction[k].to_bits())
    }

    /// Returns the angle of one of them, deg.
    pub(crate) fn degrees(&self, direction: &Vector3<f64>) -> f64 {
        self.0.get(&Self::key(direction)).copied().unwrap_or(0.0)
    }
}

/// Tool poses that lack the same, with the largest amount.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Lack {
    /// The reason.
    pub why: Unreachable,
    /// Name of the axis that would leave its travel; none for the other reasons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// The end of its travel, mm or deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
    /// True if it would have to go above that end, false below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub above: Option<bool>,
    /// Number of tool poses; one that several axes stop counts for each of them.
    pub tool_poses: usize,
    /// Largest amount, in `unit`; none where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up_to: Option<f64>,
    /// `mm` or `deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
}

impl Lack {
    /// Returns what is lacked in words, such as `Z short by up to 84 mm below -400 mm (150 rows)`; `noun` is what is
    /// counted.
    pub fn words(&self, noun: &str) -> String {
        let what = match (&self.axis, self.why, self.up_to) {
            (Some(axis), ..) => format!("{axis} short"),
            (_, Unreachable::Direction, Some(_)) => "tool axis off".to_owned(),
            (_, _, Some(_)) => "place off".to_owned(),
            (_, why, None) => why.words().to_owned(),
        };
        let unit = self.unit.unwrap_or_default();
        let amount = self.up_to.filter(|amount| *amount > 0.0).map_or_else(String::new, |amount| {
            let up_to = if self.tool_poses > 1 { "up to " } else { "" };
            let side = if self.above == Some(true) { "above" } else { "below" };
            let end = self.end.map_or_else(String::new, |end| format!(" {side} {} {unit}", significant(end, 7)));
            format!(" by {up_to}{} {unit}{end}", significant(amount, 4))
        });
        let plural = if self.tool_poses == 1 { "" } else { "s" };
        format!("{what}{amount} ({} {noun}{plural})", self.tool_poses)
    }

    /// True if another one counts the same.
    fn is_like(&self, other: &Self) -> bool {
        let key = |lack: &Self| (lack.why, lack.axis.clone(), lack.above, lack.up_to.is_some());
        key(self) == key(other)
    }
}

/// What tool poses lack, counted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lacks(Vec<Lack>);

impl Lacks {
    pub(crate) fn take(&mut self, machine: &Machine, miss: &MissedToolPose) {
        let plain = |up_to: Option<f64>, unit: Option<&'static str>| Lack {
            why: miss.why,
            axis: None,
            end: None,
            above: None,
            tool_poses: 1,
            up_to,
            unit,
        };
        match (miss.off_deg, miss.off_mm) {
            _ if !miss.beyond.is_empty() => miss.beyond.iter().for_each(|b| {
                let (above, end) = end(machine, b);
                let (axis, unit) = (Some(b.axis.clone()), Some(b.unit));
                self.add(Lack { axis, end, above: Some(above), ..plain(Some(b.by.abs()), unit) });
            }),
            (Some(deg), _) => self.add(plain(Some(deg), Some("deg"))),
            (_, Some(mm)) => self.add(plain(Some(mm), Some("mm"))),
            _ => self.add(plain(None, None)),
        }
    }

    fn add(&mut self, more: Lack) {
        match self.0.iter_mut().find(|lack| lack.is_like(&more)) {
            Some(lack) => {
                lack.tool_poses += more.tool_poses;
                lack.up_to = lack.up_to.zip(more.up_to).map(|(a, b)| a.max(b));
            }
            None => self.0.push(more),
        }
    }

    /// Adds those of others.
    pub(crate) fn merge(&mut self, others: Self) {
        others.0.into_iter().for_each(|lack| self.add(lack));
    }

    /// Returns them, the most frequent first; equal ones in the order in which they came.
    pub(crate) fn most_first(mut self) -> Vec<Lack> {
        self.0.sort_by_key(|lack| std::cmp::Reverse(lack.tool_poses));
        self.0
    }
}

/// True if a position is above the travel of its axis, and the end that it is beyond (mm or deg).
fn end(machine: &Machine, beyond: &BeyondTravel) -> (bool, Option<f64>) {
    let above = beyond.by > 0.0;
    let end = machine.axis_index(&beyond.axis).and_then(|i| match machine.axes()[i].travel {
        Travel::Range(min, max) => Some(if above { max } else { min }),
        Travel::Continuous => None,
    });
    (above, end)
}

/// The warning, or refusal if they are all, about the rows that a machine does not reach.
pub(crate) fn told(machine: &Machine, missed: &[MissedToolPose], asked: usize) -> Diagnostic {
    let name = shown(machine.name());
    let mut lacks = Lacks::default();
    missed.iter().for_each(|miss| lacks.take(machine, miss));
    let lacks = lacks.most_first().iter().map(|lack| lack.words("row")).collect::<Vec<_>>().join(", ");
    if missed.len() == asked {
        let message = format!("`{name}` reaches none of the {asked} tool poses: {lacks}");
        let help = "tips count from the workpiece origin, in the workpiece frame: check that origin, the tool, the \
                    travels and `place` of a job; `reach --place` tries others";
        return Diagnostic::new(codes::E0613, message).help(help);
    }
    let message = format!("`{name}` does not reach {} of {asked} tool poses: {lacks}", missed.len());
    Diagnostic::new(codes::W0608, message).help("they are left out; `--format json` lists them row by row")
}

/// Returns the needs of a work beside the travels of the machine; empty if no tool pose counts.
pub(crate) fn needed_travel(machine: &Machine, needs: &Needs) -> Vec<NeededTravel> {
    let short = needs.short(machine.axes());
    let of = |((axis, (min, max)), short): ((&crate::machine::Axis, &(f64, f64)), [f64; 2])| NeededTravel {
        axis: axis.name.to_string(),
        unit: axis.unit(),
        // Adding zero turns -0 into 0.
        needs: [min + 0.0, max + 0.0],
        has: match axis.travel {
            Travel::Range(min, max) => Some([min, max]),
            Travel::Continuous => None,
        },
        short,
    };
    machine.axes().iter().zip(&needs.ranges).zip(short).map(of).collect()
}
