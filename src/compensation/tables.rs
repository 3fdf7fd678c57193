//! Compensation tables: corrections in mm (linear axes) and deg (rotary axes), as programmed, and
//! error curves for controllers that compute the correction themselves.

use super::increment::Increment;
use crate::machine::{AxisKind, ErrorId, Machine};

/// The factors of a product: at the nodes of the first and of the second axis that span a table.
pub type Factors = [Vec<f64>; 2];

/// Corrections on a lattice of positions: of one axis a curve, of two a plane, of any number a lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrectionTable {
    /// Indices of the axes that span it.
    pub axes: Vec<usize>,
    /// Strictly rising nodes of each of them (mm or deg).
    pub nodes: Vec<Vec<f64>>,
    /// Indices of the axes that are corrected.
    pub corrected: Vec<usize>,
    /// Corrections, node by node (last axis fastest), in the order of `corrected`.
    pub values: Vec<f64>,
    /// The same approached with falling position; absent if the direction makes no difference. `values`
    /// then hold for rising position. Only tables over one axis have it.
    pub reverse: Option<Vec<f64>>,
    /// The products as which the controller is given a table over two axes, if it multiplies tables: then the values
    /// are twice their sum.
    pub factors: Vec<Factors>,
}

/// An error as a function of its axis's position, for a controller with the ISO 230-1 model.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisErrorCurve {
    /// The error.
    pub error: ErrorId,
    /// Strictly rising positions (mm or deg); none for a location error.
    pub positions: Vec<f64>,
    /// The error (mm or rad) at each of them; one value for a location error.
    pub values: Vec<f64>,
}

/// Content of a target's files: the controller adds the corrections of its tables and those that its model makes of the
/// error curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CorrectionTables {
    /// Tables of corrections.
    pub tables: Vec<CorrectionTable>,
    /// Curves of errors.
    pub errors: Vec<AxisErrorCurve>,
    /// Factors of what the model's corrections add to an axis, where the controller is told to turn it round (-1) or to
    /// leave it (0).
    pub senses: Vec<(usize, f64)>,
    /// Scales of drives in force, by axis, against which lines of an axis over itself count.
    pub scales: Vec<(usize, f64)>,
}

impl CorrectionTables {
    /// True if every number in them is finite.
    pub fn is_finite(&self) -> bool {
        let finite = |numbers: &Vec<f64>| numbers.iter().all(|x| x.is_finite());
        let table =
            |table: &CorrectionTable| table.nodes.iter().chain([&table.values]).chain(&table.reverse).all(finite);
        self.tables.iter().all(table)
            && self.errors.iter().all(|curve| finite(&curve.positions) && finite(&curve.values))
    }
}

/// The tables of one error alone.
#[derive(Debug, Clone, PartialEq)]
pub struct SingleErrorTables {
    /// The error.
    pub error: ErrorId,
    /// Its tables.
    pub tables: CorrectionTables,
}

/// Corrections of single errors at some nodes of a lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeCells {
    /// Numbers of the nodes, rising.
    pub nodes: Vec<usize>,
    /// Corrections by every error alone, node by node in the order of the lattice's `corrected`.
    pub errors: Vec<(ErrorId, Vec<f64>)>,
}

/// Tables or curves of a target for every error with a value, each alone.
#[derive(Debug, Clone, PartialEq)]
pub enum SingleErrors {
    /// Tables laid out as those of the set.
    Tables(Vec<SingleErrorTables>),
    /// Parts of the set's lattice.
    Lattice(LatticeCells),
}

impl CorrectionTable {
    /// A table over one axis that corrects another, or the same.
    pub fn curve(axis: usize, positions: Vec<f64>, corrected: usize, values: Vec<f64>) -> Self {
        Self {
            axes: vec![axis],
            nodes: vec![positions],
            corrected: vec![corrected],
            values,
            reverse: None,
            factors: Vec::new(),
        }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.iter().map(Vec::len).product()
    }

    /// True if it has no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True if one axis corrects itself.
    pub fn is_own_axis(&self) -> bool {
        self.axes.len() == 1 && self.axes == self.corrected
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

    /// Full pose at a node; axes that do not span the table are at 0.
    pub fn pose(&self, machine: &Machine, number: usize) -> Vec<f64> {
        let mut pose = vec![0.0; machine.axes().len()];
        for (axis, position) in self.axes.iter().zip(self.node(number)) {
            pose[*axis] = position;
        }
        pose
    }

    /// Every stored correction with its node and its axis.
    fn corrections(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let width = self.corrected.len();
        let all = std::iter::once(&self.values).chain(&self.reverse);
        all.flat_map(move |values| {
            values.iter().enumerate().map(move |(i, value)| (i / width, self.corrected[i % width], *value))
        })
    }
}

impl CorrectionTables {
    /// Rounds every stored number to the increments that `of` gives for a table.
    pub fn quantise<'a>(&mut self, machine: &Machine, of: impl Fn(&CorrectionTable) -> Option<&'a Increment>) {
        let kind = |axis: usize| machine.axes()[axis].kind;
        for table in &mut self.tables {
            let Some(increment) = of(table).copied() else { continue };
            for (axis, nodes) in table.axes.iter().zip(&mut table.nodes) {
                nodes.iter_mut().for_each(|q| *q = increment.position(*q, kind(*axis)));
            }
            let width = table.corrected.len();
            for values in std::iter::once(&mut table.values).chain(&mut table.reverse) {
                let each = values.iter_mut().enumerate();
                each.for_each(|(i, c)| *c = increment.correction(*c, kind(table.corrected[i % width])));
            }
        }
    }

    /// Merges tables: equal values in both directions need no second column; several tables over the same nodes for the
    /// same axes become one. Sets that add the same to every command then are equal.
    pub fn merge(self) -> Self {
        let mut tables: Vec<CorrectionTable> = Vec::new();
        for table in self.tables {
            let same = |t: &&mut CorrectionTable| {
                (&t.axes, &t.nodes, &t.corrected) == (&table.axes, &table.nodes, &table.corrected)
            };
            let Some(known) = tables.iter_mut().find(same) else {
                tables.push(table);
                continue;
            };
            if known.reverse.is_some() || table.reverse.is_some() {
                let mut reverse = known.reverse.take().unwrap_or_else(|| known.values.clone());
                add(&mut reverse, table.reverse.as_ref().unwrap_or(&table.values));
                known.reverse = Some(reverse);
            }
            add(&mut known.values, &table.values);
            known.factors.extend(table.factors);
        }
        tables.iter_mut().for_each(|t| t.reverse = t.reverse.take().filter(|reverse| *reverse != t.values));
        tables.sort_by(|a, b| (&a.corrected, &a.axes).cmp(&(&b.corrected, &b.axes)));
        let mut errors = self.errors;
        errors.sort_by(|a, b| a.error.cmp(&b.error));
        Self { tables, errors, ..self }
    }

    /// Do both add the same to every command? Tables of zeros count for nothing.
    pub fn same_effect(&self, other: &Self) -> bool {
        let zero = |t: &CorrectionTable| t.values.iter().chain(t.reverse.iter().flatten()).all(|c| *c == 0.0);
        let some = |all: &Self| {
            let kept = all.tables.iter().filter(|t| !zero(t)).cloned();
            Self {
                tables: kept.map(|table| CorrectionTable { factors: Vec::new(), ..table }).collect(),
                errors: all.errors.clone(),
                senses: all.senses.clone(),
                scales: Vec::new(),
            }
            .merge()
        };
        some(self) == some(other)
    }

    /// Largest correction of the linear axes (mm) and of the rotary axes (deg), with the axis.
    pub fn largest(&self, machine: &Machine) -> [Option<(usize, f64)>; 2] {
        [AxisKind::Linear, AxisKind::Rotary].map(|kind| {
            let all = self.tables.iter().flat_map(CorrectionTable::corrections).map(|(_, axis, value)| (axis, value));
            let of_kind = all.filter(|(axis, _)| machine.axes()[*axis].kind == kind);
            of_kind.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        })
    }
}

fn add(sum: &mut [f64], more: &[f64]) {
    sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
}
