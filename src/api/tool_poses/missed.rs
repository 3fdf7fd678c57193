//! Tool poses that a machine does not reach: which axis, by how much, at which row; and the travel that a work needs.

use crate::analysis::{Miss, Needs, Unreachable, direction_gap, excess};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Machine, Travel};
use crate::units::significant;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::collections::HashMap;

/// A tool pose that a machine does not reach.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
}

/// An axis that would have to leave its travel.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BeyondTravel {
    /// Name of the axis.
    pub axis: String,
    /// Distance from the nearer end of its travel: negative below the lower end.
    pub by: f64,
    /// `mm` or `deg`.
    pub unit: &'static str,
}

/// The travel that a work needs of an axis, and the travel that it has.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
    pub(super) fn new(
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
        Self { line, feature, why: miss.why, beyond, off_deg, off_mm: miss.off_mm }
    }

    /// Returns what is missing in words, such as `Z 84 mm below its travel`.
    pub fn words(&self) -> String {
        let axis = |b: &BeyondTravel| {
            let side = if b.by < 0.0 { "below" } else { "above" };
            format!("{} {} {} {side} its travel", b.axis, significant(b.by.abs(), 4), b.unit)
        };
        match (self.why, self.off_deg, self.off_mm) {
            (Unreachable::Travel, ..) if !self.beyond.is_empty() => {
                self.beyond.iter().map(axis).collect::<Vec<_>>().join(", ")
            }
            (_, Some(deg), _) if deg > 0.0 => format!("tool axis off by {} deg", significant(deg, 4)),
            (_, _, Some(mm)) => format!("place off by {} mm", significant(mm, 4)),
            (why, ..) => why.words().to_owned(),
        }
    }
}

/// The angles between directions and the nearest ones in which a machine can hold its tool: each direction is sought
/// once, however many rows have it.
pub(super) struct DirectionGaps(HashMap<[u64; 3], f64>);

impl DirectionGaps {
    /// Finds the angles of these directions.
    pub(super) fn new(machine: &Machine, directions: impl Iterator<Item = Vector3<f64>>) -> Self {
        let distinct: HashMap<_, _> = directions.map(|direction| (Self::key(&direction), direction)).collect();
        let gap = |(key, direction)| (key, direction_gap(machine, &direction).to_degrees());
        Self(distinct.into_par_iter().map(gap).collect())
    }

    fn key(direction: &Vector3<f64>) -> [u64; 3] {
        [0, 1, 2].map(|k| direction[k].to_bits())
    }

    /// Returns the angle of one of them, deg.
    pub(super) fn degrees(&self, direction: &Vector3<f64>) -> f64 {
        self.0.get(&Self::key(direction)).copied().unwrap_or(0.0)
    }
}

/// Rows that lack the same, with the largest amount.
struct Lack {
    what: String,
    rows: usize,
    amount: f64,
    unit: &'static str,
    end: String,
}

impl Lack {
    /// `Z short by up to 84 mm below -400 mm (150 rows)`.
    fn words(&self) -> String {
        let Self { what, rows, amount, unit, end } = self;
        let up_to = if *rows > 1 { "up to " } else { "" };
        let rows = if *rows == 1 { "1 row".to_owned() } else { format!("{rows} rows") };
        match (*amount > 0.0, end.is_empty()) {
            (true, _) => format!("{what} by {up_to}{} {unit}{end} ({rows})", significant(*amount, 4)),
            _ => format!("{what} ({rows})"),
        }
    }
}

/// Returns what the rows lack, axis by axis in the order of the chain.
fn lacks(machine: &Machine, missed: &[MissedToolPose]) -> Vec<Lack> {
    let mut lacks: Vec<Lack> = Vec::new();
    let mut add = |what: String, amount: f64, unit: &'static str, end: String| match lacks
        .iter_mut()
        .find(|lack| lack.what == what && lack.end == end)
    {
        Some(lack) => (lack.rows, lack.amount) = (lack.rows + 1, lack.amount.max(amount)),
        None => lacks.push(Lack { what, rows: 1, amount, unit, end }),
    };
    for miss in missed {
        match (miss.off_deg, miss.off_mm) {
            _ if !miss.beyond.is_empty() => {
                for b in &miss.beyond {
                    add(format!("{} short", b.axis), b.by.abs(), b.unit, end(machine, b));
                }
            }
            (Some(deg), _) => add("tool axis off".to_owned(), deg, "deg", String::new()),
            (_, Some(mm)) => add("place off".to_owned(), mm, "mm", String::new()),
            _ => add(miss.why.words().to_owned(), 0.0, "", String::new()),
        }
    }
    lacks.sort_by_key(|lack| std::cmp::Reverse(lack.rows));
    lacks
}

/// ` below -400 mm`.
fn end(machine: &Machine, beyond: &BeyondTravel) -> String {
    let travel = machine.axis_index(&beyond.axis).map(|i| machine.axes()[i].travel);
    let (side, at) = match travel {
        Some(Travel::Range(min, _)) if beyond.by < 0.0 => ("below", min),
        Some(Travel::Range(_, max)) => ("above", max),
        _ => return String::new(),
    };
    format!(" {side} {} {}", significant(at, 7), beyond.unit)
}

/// The warning, or refusal if they are all, about the rows that a machine does not reach.
pub(super) fn told(machine: &Machine, missed: &[MissedToolPose], asked: usize) -> Diagnostic {
    let name = shown(machine.name());
    let lacks = lacks(machine, missed).iter().map(Lack::words).collect::<Vec<_>>().join(", ");
    if missed.len() == asked {
        let message = format!("`{name}` reaches none of the {asked} tool poses: {lacks}");
        let help = "tips count from the workpiece origin, in the workpiece frame: check that origin, the tool \
         and the travels";
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
