//! Plausibility limits on corrections: a file that moves a machine further is refused unless the
//! person raises the limit.

use crate::compensation::{CorrectionTable, CorrectionTables};
use crate::diagnostic::{Diagnostic, Reason, codes};
use crate::machine::{AxisKind, Machine};
use crate::units::{self, Dimension, significant};

/// Largest corrections that are not refused.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Limits {
    /// Limit for a linear axis, mm.
    #[serde(rename = "length")]
    pub length_mm: f64,
    /// Limit for a rotary axis, rad.
    #[serde(rename = "angle")]
    pub angle_rad: f64,
    /// Change of a correction per change of its own axis's position (mm/mm, deg/deg).
    pub slope: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { length_mm: 1.0, angle_rad: 5e-3, slope: 0.01 }
    }
}

impl Limits {
    /// The largest limits that may be asked for: those of a study, which writes no files that anybody loads.
    pub const LARGEST: Self = Self { length_mm: 100.0, angle_rad: 0.1, slope: 1.0 };

    /// Parses text such as `2 mm, 10 mrad, 0.05`; an omitted limit keeps its default.
    pub fn parse(text: &str) -> Result<Self, Reason> {
        let mut limits = Self::default();
        let mut seen = [false; 3];
        for part in text.split(',').map(str::trim) {
            let (kind, value, slot, largest) = match units::quantity(part) {
                Ok(q) if q.dimension == Dimension::LENGTH => {
                    (0, q.value, &mut limits.length_mm, Self::LARGEST.length_mm)
                }
                Ok(q) if q.dimension == Dimension::ANGLE => {
                    (1, q.value, &mut limits.angle_rad, Self::LARGEST.angle_rad)
                }
                Ok(_) => return Err(Reason::new(format!("`{part}` is neither a length nor an angle"))),
                Err(units::Failure::NoUnit(_)) => {
                    (2, units::number(part).map_err(Reason::new)?, &mut limits.slope, Self::LARGEST.slope)
                }
                Err(failure) => return Err(Reason::new(failure)),
            };
            if std::mem::replace(&mut seen[kind], true) {
                return Err(Reason::new(format!("`{part}`: one length, one angle, one slope without a unit")));
            }
            if !(value > 0.0 && value <= largest) {
                return Err(Reason::new(format!("`{part}` is not a limit: at most 100 mm, 100 mrad, 1")));
            }
            *slot = value;
        }
        Ok(limits)
    }

    /// Returns a refusal for every limit that the tables exceed.
    pub fn excesses(&self, machine: &Machine, tables: &CorrectionTables) -> Vec<Diagnostic> {
        let tables = &over_travel(machine, tables);
        let [linear, rotary] = tables.largest(machine);
        let name = |axis: usize| machine.axes()[axis].name.as_str();
        let length = linear.filter(|(_, c)| c.abs() > self.length_mm).map(|(axis, c)| {
            refusal(format!(
                "a correction of {} mm for `{}` is above the limit of {} mm",
                significant(c, 4),
                name(axis),
                self.length_mm
            ))
        });
        let angle = rotary.filter(|(_, c)| c.to_radians().abs() > self.angle_rad).map(|(axis, c)| {
            let mrad = |rad: f64| significant(rad * 1e3, 4);
            refusal(format!(
                "a correction of {} mrad for `{}` is above the limit of {} mrad",
                mrad(c.to_radians()),
                name(axis),
                mrad(self.angle_rad)
            ))
        });
        let slope = steepest(machine, tables).filter(|(_, slope)| *slope > self.slope).map(|(axis, slope)| {
            refusal(format!(
                "the corrections of `{}` change by {} per unit of its travel, above the limit of {}",
                name(axis),
                significant(slope, 3),
                self.slope
            ))
        });
        length.into_iter().chain(angle).chain(slope).collect()
    }
}

pub(in crate::controller) const RAISE_LIMIT: &str = "check the error values and their units; if they are right, \
     raise the limit: --max-correction \"2 mm, 10 mrad, 0.05\"";

fn refusal(message: String) -> Diagnostic {
    Diagnostic::new(codes::E0602, message).help(RAISE_LIMIT)
}

/// Returns tables whose straight lines end with the travel: a factor of a controller is stored as a line over 1000 mm,
/// which says nothing of the motion that it makes.
fn over_travel(machine: &Machine, tables: &CorrectionTables) -> CorrectionTables {
    let mut over = tables.clone();
    for table in over.tables.iter_mut().filter(|table| table.axes.len() == 1 && table.len() == 2) {
        let [first, last] = [table.nodes[0][0], table.nodes[0][1]];
        let (min, max) = machine.axes()[table.axes[0]].travel.interval();
        let width = table.corrected.len();
        for values in std::iter::once(&mut table.values).chain(&mut table.reverse) {
            for column in 0..width {
                let [start, end] = [values[column], values[width + column]];
                let at = |q: f64| start + (end - start) * (q - first) / (last - first);
                (values[column], values[width + column]) = (at(min), at(max));
            }
        }
        table.nodes[0] = vec![min, max];
    }
    over
}

/// Returns the steepest correction of an axis along its own travel.
fn steepest(machine: &Machine, tables: &CorrectionTables) -> Option<(usize, f64)> {
    let linear = |axis: usize| machine.axes()[axis].kind == AxisKind::Linear;
    let of = |table: &CorrectionTable| {
        let along = table.corrected.iter().filter(|axis| table.is_own_axis() || linear(**axis));
        along.map(|axis| (*axis, slope(table, *axis))).collect::<Vec<_>>()
    };
    tables.tables.iter().flat_map(of).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the steepest correction of an axis in a table along that axis's own nodes.
fn slope(table: &CorrectionTable, axis: usize) -> f64 {
    let Some(place) = table.axes.iter().position(|a| *a == axis) else { return 0.0 };
    let Some(column) = table.corrected.iter().position(|a| *a == axis) else { return 0.0 };
    let all = std::iter::once(&table.values).chain(&table.reverse);
    all.map(|values| steepest_along(table, values, place, column)).fold(0.0, f64::max)
}

/// Returns the largest change of a column per change of the position between neighbours along one axis.
pub(crate) fn steepest_along(table: &CorrectionTable, values: &[f64], place: usize, column: usize) -> f64 {
    let stride: usize = table.nodes[place + 1..].iter().map(Vec::len).product();
    let nodes = &table.nodes[place];
    let value = |node: usize| values[node * table.corrected.len() + column];
    let inner = (0..table.len()).filter(|node| node / stride % nodes.len() + 1 < nodes.len());
    inner
        .map(|node| {
            let at = node / stride % nodes.len();
            ((value(node + stride) - value(node)) / (nodes[at + 1] - nodes[at])).abs()
        })
        .fold(0.0, f64::max)
}
