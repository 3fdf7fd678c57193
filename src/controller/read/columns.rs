//! Lines of numbers between blanks and nothing else: the table of one axis.

use super::{Fault, ReadContext, number};
use crate::compensation::CorrectionTable;
use crate::controller::emit::{StoredColumn, StoredPosition};
use crate::controller::manifest::TableColumn;
use crate::machine::AxisKind;

/// Three numbers need a quarter of it; LinuxCNC's buffer takes no more and reads the rest as a line of its own.
const MAX_LINE: usize = 254;

pub(super) fn own_axis(reading: &ReadContext, columns: &[TableColumn], text: &str) -> Result<CorrectionTable, Fault> {
    let axis = reading.axis.unwrap_or(0);
    let max = reading.target.manifest.mechanism.own_axis.as_ref().map_or(usize::MAX, |own| own.table.max_points);
    let mut table = CorrectionTable::curve(axis, Vec::new(), axis, Vec::new());
    let mut reverse = Vec::new();
    for (line, cells) in text.lines().enumerate() {
        let at = |message: String| Fault { line, message };
        for (column, value) in columns.iter().zip(point(columns, line, cells)?) {
            match column {
                TableColumn::Position => table.nodes[0].push(value),
                TableColumn::Forward => table.values.push(value),
                TableColumn::Reverse => reverse.push(value),
            }
        }
        if line >= max {
            return Err(at(format!("more than {max} points: the controller would drop this one")));
        }
        if let [.., before, last] = table.nodes[0][..]
            && last <= before
        {
            return Err(at("the positions do not rise: the controller would drop this line".to_owned()));
        }
    }
    if table.is_empty() {
        return Err(Fault::new(0, "the table is empty"));
    }
    table.reverse = columns.contains(&TableColumn::Reverse).then_some(reverse);
    let kind = reading.machine.axes()[axis].kind;
    Ok(in_millimetres(reading, table, kind))
}

/// Converts stored numbers to positions and corrections.
fn in_millimetres(reading: &ReadContext, mut table: CorrectionTable, kind: AxisKind) -> CorrectionTable {
    let Some(own) = reading.target.manifest.mechanism.own_axis.as_ref() else { return table };
    let rules = &own.table;
    let (place, column) = (StoredPosition { rules, kind }, StoredColumn::new(rules, kind));
    table.nodes[0].iter_mut().for_each(|q| *q = place.position(*q));
    let nodes = table.nodes[0].clone();
    let unit = reading.units[usize::from(kind == AxisKind::Rotary)];
    for values in std::iter::once(&mut table.values).chain(&mut table.reverse) {
        values.iter_mut().zip(&nodes).for_each(|(c, q)| *c = column.correction(*c, Some(*q)) * unit);
    }
    table.nodes[0].iter_mut().for_each(|q| *q *= unit);
    table
}

fn point(columns: &[TableColumn], number_of_line: usize, line: &str) -> Result<Vec<f64>, Fault> {
    let fault = |message: String| Fault::new(number_of_line, message);
    if line.len() > MAX_LINE {
        return Err(fault(format!("{} characters in a line: the controller would cut it in pieces", line.len())));
    }
    let cells: Vec<&str> = line.split_ascii_whitespace().collect();
    if cells.len() != columns.len() {
        let (found, wanted) = (cells.len(), columns.len());
        return Err(fault(format!("{found} numbers instead of {wanted}: the controller would stop reading here")));
    }
    cells.into_iter().map(|cell| number(cell).map_err(|bad| fault(bad.into()))).collect()
}
