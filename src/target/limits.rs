//! Plausibility limits on corrections: a file that moves a machine further is refused unless the
//! person raises the limit.

use crate::compensation::{Lattice, Tables};
use crate::diagnostic::Diagnostic;
use crate::machine::{AxisKind, Machine};
use crate::units::{self, Dimension, significant};

/// Largest corrections that are not refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Of a linear axis, mm.
    pub length: f64,
    /// Of a rotary axis, rad.
    pub angle: f64,
    /// Change of a correction per change of its own axis's position (mm/mm, deg/deg).
    pub slope: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { length: 1.0, angle: 5e-3, slope: 0.01 }
    }
}

impl Limits {
    /// From text such as `2 mm, 10 mrad, 0.05`; what is left out keeps its default.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut limits = Self::default();
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let slot = match units::quantity(part) {
                Ok(quantity) if quantity.dimension == Dimension::LENGTH => (&mut limits.length, quantity.value),
                Ok(quantity) if quantity.dimension == Dimension::ANGLE => (&mut limits.angle, quantity.value),
                Ok(_) => return Err(format!("`{part}` is neither a length nor an angle")),
                Err(units::Failure::NoUnit(_)) => (&mut limits.slope, units::number(part).map_err(|f| f.to_string())?),
                Err(failure) => return Err(failure.to_string()),
            };
            if slot.1 <= 0.0 {
                return Err(format!("`{part}` is not above zero"));
            }
            *slot.0 = slot.1;
        }
        Ok(limits)
    }

    /// Every limit that the tables exceed.
    pub fn exceeded(&self, machine: &Machine, tables: &Tables) -> Vec<Diagnostic> {
        let [linear, rotary] = tables.largest(machine);
        let name = |axis: usize| machine.axes()[axis].name.as_str();
        let length = linear.filter(|(_, c)| c.abs() > self.length).map(|(axis, c)| {
            refusal(format!(
                "a correction of {} mm for `{}` is above the limit of {} mm",
                significant(c, 4),
                name(axis),
                self.length
            ))
        });
        let angle = rotary.filter(|(_, c)| c.to_radians().abs() > self.angle).map(|(axis, c)| {
            let mrad = |rad: f64| significant(rad * 1e3, 4);
            refusal(format!(
                "a correction of {} mrad for `{}` is above the limit of {} mrad",
                mrad(c.to_radians()),
                name(axis),
                mrad(self.angle)
            ))
        });
        let slope = steepest(machine, tables).filter(|(_, slope)| *slope > self.slope).map(|(axis, slope)| {
            refusal(format!(
                "the corrections of `{}` change by {} per unit of its way, above the limit of {}",
                name(axis),
                significant(slope, 3),
                self.slope
            ))
        });
        length.into_iter().chain(angle).chain(slope).collect()
    }
}

fn refusal(message: String) -> Diagnostic {
    Diagnostic::new("E0602", message)
        .help("check the error values and their units; if they are right, raise the limit: --max-correction \"2 mm, 10 mrad, 0.05\"")
}

/// The steepest correction of an axis along its own travel.
fn steepest(machine: &Machine, tables: &Tables) -> Option<(usize, f64)> {
    let mut slopes: Vec<(usize, f64)> = Vec::new();
    match tables {
        Tables::OwnAxis(all) => {
            for table in all {
                slopes.push((table.axis, slope(&table.positions, &table.forward)));
                slopes.push((table.axis, slope(&table.positions, &table.reverse)));
            }
        }
        Tables::Lattice(lattice) => {
            let linear = |axis: &&usize| machine.axes()[**axis].kind == AxisKind::Linear;
            slopes.extend(lattice.corrected.iter().filter(linear).map(|axis| (*axis, lattice_slope(lattice, *axis))));
        }
    }
    slopes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))
}

fn slope(positions: &[f64], values: &[f64]) -> f64 {
    let steps = positions.windows(2).zip(values.windows(2));
    steps.map(|(q, c)| ((c[1] - c[0]) / (q[1] - q[0])).abs()).fold(0.0, f64::max)
}

fn lattice_slope(lattice: &Lattice, axis: usize) -> f64 {
    let Some(place) = lattice.axes.iter().position(|a| *a == axis) else { return 0.0 };
    let Some(column) = lattice.corrected.iter().position(|a| *a == axis) else { return 0.0 };
    let stride: usize = lattice.nodes[place + 1..].iter().map(Vec::len).product();
    let nodes = &lattice.nodes[place];
    let value = |node: usize| lattice.values[node * lattice.corrected.len() + column];
    let inner = (0..lattice.len()).filter(|node| node / stride % nodes.len() + 1 < nodes.len());
    inner
        .map(|node| {
            let at = node / stride % nodes.len();
            ((value(node + stride) - value(node)) / (nodes[at + 1] - nodes[at])).abs()
        })
        .fold(0.0, f64::max)
}
