//! Tables on top of tables: a machine measured with tables in force needs the old ones plus the new.

use super::curves::straight;
use super::{AxisErrorCurve, CorrectionTable, CorrectionTables};

/// Look-up of the first table's correction at the nodes of the second, over the same axes, node by node; true if
/// approached in reverse.
pub type LookUp<'a> = dyn Fn(&CorrectionTable, &CorrectionTable, bool) -> Vec<f64> + 'a;

impl CorrectionTables {
    /// Returns these tables plus others, on the nodes of these; tables that only the others have are kept. The values
    /// of the others between their nodes come from `at`. Curves of one axis stand in one block, on the same nodes.
    pub fn plus(mut self, others: &Self, at: &LookUp) -> Self {
        for other in &others.tables {
            let same = |t: &&mut CorrectionTable| (&t.axes, &t.corrected) == (&other.axes, &other.corrected);
            let Some(table) = self.tables.iter_mut().find(same) else {
                self.tables.push(other.clone());
                continue;
            };
            let sum = |table: &CorrectionTable, reverse: bool| -> Vec<f64> {
                let values = if reverse { table.reverse.as_ref().unwrap_or(&table.values) } else { &table.values };
                values.iter().zip(at(other, table, reverse)).map(|(v, o)| v + o).collect()
            };
            let reverse = (table.reverse.is_some() || other.reverse.is_some()).then(|| sum(table, true));
            table.values = sum(table, false);
            table.reverse = reverse;
            table.factors.extend(other.factors.clone());
        }
        for other in &others.errors {
            match self.errors.iter_mut().find(|curve| curve.error == other.error) {
                Some(curve) if curve.positions.is_empty() => curve.values[0] += other.value(0.0, false),
                Some(curve) => add(curve, other),
                None => {
                    let same =
                        |curve: &&AxisErrorCurve| curve.error.axis == other.error.axis && !curve.positions.is_empty();
                    let beside = self.errors.iter().find(same).filter(|_| !other.positions.is_empty());
                    let curve = beside.map_or_else(|| other.clone(), |beside| other.resample(&beside.positions));
                    self.errors.push(curve);
                }
            }
        }
        self.merge()
    }
}

fn add(curve: &mut AxisErrorCurve, other: &AxisErrorCurve) {
    curve.values.iter_mut().zip(&curve.positions).for_each(|(value, q)| *value += other.value(*q, false));
}

/// Positions and more of them, rising; none if that makes too many.
fn union(positions: &[f64], more: &[f64], max: usize) -> Option<Vec<f64>> {
    let mut all = [positions, more].concat();
    all.sort_by(f64::total_cmp);
    all.dedup();
    (all.len() > positions.len() && all.len() <= max).then_some(all)
}

impl CorrectionTable {
    /// Puts points into a table over one axis without changing what it adds, if it then has at max `max` points.
    pub fn add_points(&mut self, more: &[f64], max: usize) {
        let Some(nodes) = union(&self.nodes[0], more, max) else { return };
        for values in std::iter::once(&mut self.values).chain(&mut self.reverse) {
            *values = nodes.iter().map(|q| straight(&self.nodes[0], values, *q)).collect();
        }
        self.nodes = vec![nodes];
    }
}

impl AxisErrorCurve {
    /// The same for a curve; a constant has no points.
    pub fn add_points(&mut self, more: &[f64], max: usize) {
        if self.positions.is_empty() {
            return;
        }
        let Some(positions) = union(&self.positions, more, max) else { return };
        *self = self.resample(&positions);
    }

    /// The curve on other positions, straight between its own.
    fn resample(&self, positions: &[f64]) -> Self {
        let values = positions.iter().map(|q| straight(&self.positions, &self.values, *q)).collect();
        Self { error: self.error.clone(), positions: positions.to_vec(), values }
    }
}
