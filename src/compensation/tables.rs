//! Compensation tables: corrections in mm (linear axes) and deg (rotary axes), as programmed.

use crate::machine::{AxisKind, Machine};

/// Corrections of one axis as a function of its own position.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnAxisTable {
    /// Index of the axis.
    pub axis: usize,
    /// Strictly rising positions (mm or deg).
    pub positions: Vec<f64>,
    /// Correction approaching with rising position.
    pub forward: Vec<f64>,
    /// Correction approaching with falling position.
    pub reverse: Vec<f64>,
}

/// Corrections on a lattice of poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Indices of the axes that span it.
    pub axes: Vec<usize>,
    /// Strictly rising nodes of each of them (mm or deg).
    pub nodes: Vec<Vec<f64>>,
    /// Indices of the axes that are corrected.
    pub corrected: Vec<usize>,
    /// Corrections, node by node (last axis fastest), in the order of `corrected`.
    pub values: Vec<f64>,
}

/// The strongest entry of tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Strongest {
    /// Index of the axis that is corrected.
    pub axis: usize,
    /// Where: axes with their positions (mm or deg).
    pub at: Vec<(usize, f64)>,
    /// What is added (mm or deg).
    pub value: f64,
}

/// What a target's files hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Tables {
    /// One table for each axis.
    OwnAxis(Vec<OwnAxisTable>),
    /// A lattice.
    Lattice(Lattice),
}

/// Least increment of stored values: mm for positions and corrections of linear axes, deg for rotary.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Increment {
    /// Decimals of a position.
    pub position_decimals: u8,
    /// Decimals of a correction.
    pub correction_decimals: u8,
}

impl Increment {
    /// Positions as they will be stored; those that fall together are one.
    pub(super) fn distinct(self, positions: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut stored: Vec<f64> = positions.into_iter().map(|q| round(q, self.position_decimals)).collect();
        stored.dedup();
        stored
    }

    /// Half a last place of a correction (mm or deg).
    pub fn half_correction(self) -> f64 {
        0.5 * libm::pow(10.0, -f64::from(self.correction_decimals))
    }
}

impl Lattice {
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.iter().map(Vec::len).product()
    }

    /// Has it no nodes?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Positions of the axes that span it at the node with this number (last axis fastest).
    pub fn node(&self, mut number: usize) -> Vec<f64> {
        let mut positions = vec![0.0; self.nodes.len()];
        for (slot, nodes) in positions.iter_mut().zip(&self.nodes).rev() {
            *slot = nodes[number % nodes.len()];
            number /= nodes.len();
        }
        positions
    }

    /// Full pose at a node; axes that do not span the lattice stand at 0.
    pub fn pose(&self, machine: &Machine, number: usize) -> Vec<f64> {
        let mut pose = vec![0.0; machine.axes().len()];
        for (axis, position) in self.axes.iter().zip(self.node(number)) {
            pose[*axis] = position;
        }
        pose
    }
}

impl Tables {
    /// Rounds every stored number to the increment of the format.
    pub fn quantise(&mut self, increment: Increment) {
        let position =
            |values: &mut Vec<f64>| values.iter_mut().for_each(|x| *x = round(*x, increment.position_decimals));
        let correction =
            |values: &mut Vec<f64>| values.iter_mut().for_each(|x| *x = round(*x, increment.correction_decimals));
        match self {
            Self::OwnAxis(tables) => tables.iter_mut().for_each(|table| {
                position(&mut table.positions);
                correction(&mut table.forward);
                correction(&mut table.reverse);
            }),
            Self::Lattice(lattice) => {
                lattice.nodes.iter_mut().for_each(position);
                correction(&mut lattice.values);
            }
        }
    }

    /// Largest correction of the linear axes (mm) and of the rotary axes (deg), with the axis.
    pub fn largest(&self, machine: &Machine) -> [Option<(usize, f64)>; 2] {
        [AxisKind::Linear, AxisKind::Rotary].map(|kind| {
            let of_kind = self.corrections().filter(|(axis, _)| machine.axes()[*axis].kind == kind);
            of_kind.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        })
    }

    /// The largest correction of a linear axis (of any axis if there is none), and where it stands.
    pub fn strongest(&self, machine: &Machine) -> Option<Strongest> {
        let [linear, rotary] = self.largest(machine);
        let (axis, value) = linear.or(rotary).filter(|(_, value)| *value != 0.0)?;
        let at = match self {
            Self::OwnAxis(tables) => tables.iter().filter(|t| t.axis == axis).find_map(|t| {
                let same = |i: &usize| t.forward[*i] == value || t.reverse[*i] == value;
                (0..t.positions.len()).find(same).map(|i| vec![(axis, t.positions[i])])
            })?,
            Self::Lattice(lattice) => {
                let column = lattice.corrected.iter().position(|a| *a == axis)?;
                let width = lattice.corrected.len();
                let node = (0..lattice.len()).find(|node| lattice.values[node * width + column] == value)?;
                lattice.axes.iter().copied().zip(lattice.node(node)).collect()
            }
        };
        Some(Strongest { axis, at, value })
    }

    /// Every stored correction with its axis.
    fn corrections(&self) -> Box<dyn Iterator<Item = (usize, f64)> + '_> {
        match self {
            Self::OwnAxis(tables) => Box::new(
                tables.iter().flat_map(|t| t.forward.iter().chain(&t.reverse).map(move |value| (t.axis, *value))),
            ),
            Self::Lattice(lattice) => Box::new(
                lattice
                    .values
                    .iter()
                    .enumerate()
                    .map(|(i, value)| (lattice.corrected[i % lattice.corrected.len()], *value)),
            ),
        }
    }
}

/// To the nearest multiple of the last decimal; the result prints exactly with that many decimals.
fn round(value: f64, decimals: u8) -> f64 {
    let scale = libm::pow(10.0, f64::from(decimals));
    libm::round(value * scale) / scale + 0.0
}
