//! A lattice of corrections with named columns: as CSV, as JSON.

use super::{Fault, number};
use crate::compensation::CorrectionTable;
use crate::machine::Machine;
use crate::units;

/// A lattice in CSV: header of `X [mm]` and `dX [mm]` columns, rows in lattice order.
pub(super) fn csv(machine: &Machine, text: &str) -> Result<CorrectionTable, Fault> {
    let mut lines = text.lines().enumerate();
    let (_, header) = lines.next().ok_or(Fault { line: 0, message: "the file is empty".to_owned() })?;
    let (axes, corrected) = lattice_columns(machine, header)?;
    let width = axes.len() + corrected.len();
    let mut positions: Vec<Vec<f64>> = vec![Vec::new(); axes.len()];
    let mut values = Vec::new();
    let mut rows = 0;
    let (mut before, mut row) = (Vec::with_capacity(width), Vec::with_capacity(width));
    for (at, line) in lines {
        let fault = |message: String| Fault { line: at, message };
        row.clear();
        for cell in line.split(',') {
            row.push(number(cell).map_err(|bad| fault(bad.into()))?);
        }
        if row.len() != width {
            return Err(fault(format!("{} cells under {width} columns", row.len())));
        }
        let (node, corrections) = row.split_at(axes.len());
        in_order(&before, node, &mut positions).map_err(|disorder| fault(disorder.to_string()))?;
        before.clear();
        before.extend_from_slice(node);
        values.extend_from_slice(corrections);
        rows += 1;
    }
    if rows == 0 {
        return Err(Fault { line: 0, message: "there are no rows under the header".to_owned() });
    }
    let lattice = CorrectionTable { axes, nodes: positions, corrected, values, reverse: None, factors: Vec::new() };
    if rows == lattice.len() {
        Ok(lattice)
    } else {
        Err(Fault { line: 0, message: format!("{rows} rows do not fill a lattice of {} nodes", lattice.len()) })
    }
}

/// The reason why rows are no lattice.
#[derive(Debug, thiserror::Error)]
enum Disorder {
    #[error("the rows are not in the order of the lattice, the last axis fastest")]
    Rows,
    #[error("the position {0} is none of the lattice's")]
    Position(f64),
}

/// Rows come in lattice order, the last axis fastest: each node after the one before, and no position
/// that an axis passed by. As many such rows as the lattice has nodes are the lattice.
fn in_order(before: &[f64], node: &[f64], positions: &mut [Vec<f64>]) -> Result<(), Disorder> {
    let rises = node.iter().zip(before).find(|(new, old)| new != old).is_none_or(|(new, old)| new > old);
    if !rises || node == before {
        return Err(Disorder::Rows);
    }
    for (nodes, value) in positions.iter_mut().zip(node) {
        if nodes.last().is_none_or(|last| value > last) {
            nodes.push(*value);
        } else if !nodes.contains(value) {
            return Err(Disorder::Position(*value));
        }
    }
    Ok(())
}

/// Indices of the axes that span it and of those that are corrected.
fn lattice_columns(machine: &Machine, header: &str) -> Result<(Vec<usize>, Vec<usize>), Fault> {
    let fault = |message: String| Fault::new(0, message);
    let (mut axes, mut corrected) = (Vec::new(), Vec::new());
    for cell in header.split(',') {
        let (name, unit) = units::header(cell);
        let position = machine.axis_index(name);
        let axis = position
            .or_else(|| machine.axis_index(name.strip_prefix('d')?))
            .ok_or_else(|| fault(format!("unknown column `{name}`")))?;
        if unit != Some(machine.axes()[axis].unit()) {
            return Err(fault(format!("column `{name}` must be in {}", machine.axes()[axis].unit())));
        }
        let list = if position.is_some() { &mut axes } else { &mut corrected };
        if list.contains(&axis) {
            return Err(fault(format!("column `{name}` is there twice")));
        }
        list.push(axis);
        if position.is_some() && !corrected.is_empty() {
            return Err(fault(format!("column `{name}`: all positions come before all corrections")));
        }
    }
    if axes.is_empty() || corrected.is_empty() {
        Err(fault("no columns of positions or of corrections".to_owned()))
    } else {
        Ok((axes, corrected))
    }
}

/// The same as JSON: `{"columns": ["X [mm]", "dX [mm]"], "rows": [[0, 0.001], ...]}` with any other keys.
pub(super) fn json(machine: &Machine, text: &str) -> Result<CorrectionTable, Fault> {
    #[derive(serde::Deserialize)]
    struct LatticeGrid {
        columns: Vec<String>,
        rows: Vec<Vec<f64>>,
    }
    let grid: LatticeGrid = serde_json::from_str(text)
        .map_err(|failure| Fault { line: failure.line().saturating_sub(1), message: failure.to_string() })?;
    let mut csv = grid.columns.join(",") + "\n";
    for row in grid.rows {
        csv.push_str(&row.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        csv.push('\n');
    }
    // Lines of the CSV are not those of the file.
    self::csv(machine, &csv).map_err(|fault| Fault { line: 0, ..fault })
}
