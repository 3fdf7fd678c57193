//! Files of a target read back into tables. Whatever the controller would swallow in silence or
//! misread (comments, blank lines, commas, unsorted lines, NaN, too many points) is refused here
//! with its place.

use super::Target;
use super::manifest::{Column, FileSpec, Layout, Per};
use crate::compensation::{Capability, Lattice, OwnAxisTable, Tables};
use crate::diagnostic::{Diagnostic, Diagnostics, Place};
use crate::machine::Machine;
use crate::units;

/// A file found on disk: its plain name and its text.
pub type ReadBack = (String, String);

impl Target {
    /// Names of the files that carry tables for this machine.
    pub fn table_files(&self, machine: &Machine) -> Vec<String> {
        let with_layout = self.manifest.files.iter().filter(|spec| spec.layout.is_some());
        with_layout.flat_map(|spec| self.names(machine, spec).into_iter().map(|(_, name)| name)).collect()
    }

    fn names(&self, machine: &Machine, spec: &FileSpec) -> Vec<(usize, String)> {
        match spec.per {
            Per::Axis => self.axis_files(machine, spec).unwrap_or_default(),
            Per::Machine => vec![(0, spec.path.clone())],
        }
    }

    /// Reads the tables out of files with these names. Diagnostics: E0704 and its place.
    pub fn read(&self, machine: &Machine, files: &[ReadBack], diagnostics: &mut Diagnostics) -> Option<Tables> {
        let mut own_axis = Vec::new();
        for spec in &self.manifest.files {
            let Some(layout) = &spec.layout else { continue };
            for (axis, name) in self.names(machine, spec) {
                let Some((_, text)) = files.iter().find(|(known, _)| *known == name) else {
                    diagnostics.push(missing(&name));
                    continue;
                };
                let read = match layout {
                    Layout::Columns { columns } => self.own_axis(axis, columns, text).map(|table| {
                        own_axis.push(table);
                        None
                    }),
                    Layout::CsvLattice => lattice(machine, text).map(Some),
                    Layout::CArrays | Layout::HalConstants => continue,
                };
                match read {
                    Ok(Some(lattice)) => return Some(Tables::Lattice(lattice)),
                    Ok(None) => {}
                    Err(fault) => {
                        let source = diagnostics.sources.add(&*name, &**text);
                        diagnostics.push(fault.diagnostic(&name, text, source));
                    }
                }
            }
        }
        own_axis.sort_by_key(|table| table.axis);
        (!diagnostics.refused() && !own_axis.is_empty()).then_some(Tables::OwnAxis(own_axis))
    }

    fn own_axis(&self, axis: usize, columns: &[Column], text: &str) -> Result<OwnAxisTable, Fault> {
        let most = match self.manifest.capability() {
            Capability::OwnAxis(own) => own.max_points,
            Capability::Lattice(_) | Capability::Kinematics => usize::MAX,
        };
        let mut table = OwnAxisTable { axis, positions: Vec::new(), forward: Vec::new(), reverse: Vec::new() };
        for (number, line) in text.lines().enumerate() {
            let at = |message: String| Fault { line: number, message };
            point(&mut table, columns, line).map_err(at)?;
            if number >= most {
                return Err(at(format!("more than {most} points: the controller would drop this one")));
            }
            if let [.., before, last] = table.positions[..]
                && last <= before
            {
                return Err(at("the positions do not rise: the controller would drop this line".to_owned()));
            }
        }
        if table.positions.is_empty() {
            return Err(Fault { line: 0, message: "the table is empty".to_owned() });
        }
        if !columns.contains(&Column::Reverse) {
            table.reverse.clone_from(&table.forward);
        }
        Ok(table)
    }
}

/// A number of a compensation file: nothing there is beyond a kilometre or a thousand turns.
fn stored(cell: &str) -> Result<f64, String> {
    const LARGEST: f64 = 1e6;
    let value = units::number(cell).map_err(|failure| failure.to_string())?;
    if value.abs() <= LARGEST {
        Ok(value)
    } else {
        Err(format!("`{}` is no position or correction of a machine", cell.trim()))
    }
}

/// Adds the point on a line, or says what is wrong with the line.
fn point(table: &mut OwnAxisTable, columns: &[Column], line: &str) -> Result<(), String> {
    if line.len() > LONGEST_LINE {
        return Err(format!("{} characters in a line: the controller would cut it in pieces", line.len()));
    }
    let cells: Vec<&str> = line.split_ascii_whitespace().collect();
    if cells.len() != columns.len() {
        let (found, wanted) = (cells.len(), columns.len());
        return Err(format!("{found} numbers instead of {wanted}: the controller would stop reading here"));
    }
    for (cell, column) in cells.iter().zip(columns) {
        let value = stored(cell)?;
        match column {
            Column::Position => table.positions.push(value),
            Column::Forward => table.forward.push(value),
            Column::Reverse => table.reverse.push(value),
        }
    }
    Ok(())
}

/// Three numbers need a quarter of it; LinuxCNC's buffer takes no more and reads the rest as a line of its own.
const LONGEST_LINE: usize = 254;

/// What is wrong with a line (counted from 0).
struct Fault {
    line: usize,
    message: String,
}

impl Fault {
    fn diagnostic(&self, name: &str, text: &str, source: crate::diagnostic::SourceId) -> Diagnostic {
        at_line(self.line, &self.message, name, text, source)
    }
}

/// What is wrong with a line (counted from 0) of a file.
pub(super) fn at_line(
    line: usize,
    message: &str,
    name: &str,
    text: &str,
    source: crate::diagnostic::SourceId,
) -> Diagnostic {
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let length = text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    let place = Place { source, range: start..start + length };
    Diagnostic::new("E0704", format!("`{name}`: {message}"))
        .at(Some(place), "")
        .help("compile the file set again; do not edit compensation files by hand")
}

fn missing(name: &str) -> Diagnostic {
    Diagnostic::new("E0705", format!("the file `{name}` is missing"))
        .help("a set of compensation files is only whole with all of them")
}

/// A lattice in CSV: header of `X [mm]` and `dX [mm]` columns, rows in lattice order.
fn lattice(machine: &Machine, text: &str) -> Result<Lattice, Fault> {
    let mut lines = text.lines().enumerate();
    let (_, header) = lines.next().ok_or(Fault { line: 0, message: "the file is empty".to_owned() })?;
    let (axes, corrected) = lattice_columns(machine, header).map_err(|message| Fault { line: 0, message })?;
    let width = axes.len() + corrected.len();
    let mut positions: Vec<Vec<f64>> = vec![Vec::new(); axes.len()];
    let mut values = Vec::new();
    let mut rows = 0;
    let (mut before, mut row) = (Vec::with_capacity(width), Vec::with_capacity(width));
    for (number, line) in lines {
        let fault = |message: String| Fault { line: number, message };
        row.clear();
        for cell in line.split(',') {
            row.push(stored(cell).map_err(fault)?);
        }
        if row.len() != width {
            return Err(fault(format!("{} cells under {width} columns", row.len())));
        }
        let (node, corrections) = row.split_at(axes.len());
        in_order(&before, node, &mut positions).map_err(fault)?;
        before.clear();
        before.extend_from_slice(node);
        values.extend_from_slice(corrections);
        rows += 1;
    }
    if rows == 0 {
        return Err(Fault { line: 0, message: "there are no rows under the header".to_owned() });
    }
    let lattice = Lattice { axes, nodes: positions, corrected, values };
    if rows == lattice.len() {
        Ok(lattice)
    } else {
        Err(Fault { line: 0, message: format!("{rows} rows do not fill a lattice of {} nodes", lattice.len()) })
    }
}

/// Rows come in lattice order, the last axis fastest: each node after the one before, and no position
/// that an axis passed by. As many such rows as the lattice has nodes are the lattice.
fn in_order(before: &[f64], node: &[f64], positions: &mut [Vec<f64>]) -> Result<(), String> {
    let rises = node.iter().zip(before).find(|(new, old)| new != old).is_none_or(|(new, old)| new > old);
    if !rises || node == before {
        return Err("the rows are not in the order of the lattice, the last axis fastest".to_owned());
    }
    for (nodes, value) in positions.iter_mut().zip(node) {
        if nodes.last().is_none_or(|last| value > last) {
            nodes.push(*value);
        } else if !nodes.contains(value) {
            return Err(format!("the position {value} is none of the lattice's"));
        }
    }
    Ok(())
}

fn lattice_columns(machine: &Machine, header: &str) -> Result<(Vec<usize>, Vec<usize>), String> {
    let (mut axes, mut corrected) = (Vec::new(), Vec::new());
    for cell in header.split(',') {
        let (name, unit) = units::header(cell);
        let position = machine.axis_index(name);
        let axis = position
            .or_else(|| machine.axis_index(name.strip_prefix('d')?))
            .ok_or_else(|| format!("unknown column `{name}`"))?;
        if unit != Some(machine.axes()[axis].unit()) {
            return Err(format!("column `{name}` must be in {}", machine.axes()[axis].unit()));
        }
        let list = if position.is_some() { &mut axes } else { &mut corrected };
        if list.contains(&axis) {
            return Err(format!("column `{name}` is there twice"));
        }
        list.push(axis);
        if position.is_some() && !corrected.is_empty() {
            return Err(format!("column `{name}`: all positions stand before all corrections"));
        }
    }
    if axes.is_empty() || corrected.is_empty() {
        Err("no columns of positions or of corrections".to_owned())
    } else {
        Ok((axes, corrected))
    }
}
