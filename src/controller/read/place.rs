//! The axis of a file whose table does not name it: from files that assign it, from its own first lines, from its
//! positions.

use super::{Fault, ReadBack};
use crate::controller::manifest::{AssignedAxis, ControllerTarget, FileLayout, Index, by_number};
use crate::machine::Machine;

pub(super) struct AxisFile {
    /// The file's name as it is written there, without folders.
    pub file: String,
    /// The axis, by its index.
    pub axis: usize,
}

/// Returns the assignments of a file. A fault: its settings make the controller read the files differently.
pub(super) fn axis_files(index: &Index, letters: &[AssignedAxis], text: &str) -> Result<Vec<AxisFile>, Fault> {
    match index {
        Index::Sections { prefix, key, with } => sections(prefix, key, with, letters, text),
        Index::Columns { header } => Ok(columns(header, letters, text)),
    }
}

/// `[PREFIXn]`, n counted from 0, then `KEY = FILE`.
fn sections(
    prefix: &str,
    key: &str,
    with: &std::collections::BTreeMap<String, String>,
    letters: &[AssignedAxis],
    text: &str,
) -> Result<Vec<AxisFile>, Fault> {
    let mut all = Vec::new();
    let mut lines = text.lines().enumerate().peekable();
    while let Some((_, line)) = lines.next() {
        let section = line.trim().strip_prefix('[').and_then(|l| l.strip_prefix(prefix)?.split_once(']'));
        let axis = section.and_then(|(n, _)| by_number(letters, n.parse::<usize>().ok()?.checked_add(1)?));
        let Some(axis) = axis.map(|known| known.axis) else { continue };
        let mut said: Vec<(usize, &str, &str)> = Vec::new();
        while let Some((number, line)) = lines.next_if(|(_, line)| !line.trim().starts_with('[')) {
            let setting = line.split_once('=').filter(|_| !line.trim().starts_with(['#', ';']));
            said.extend(setting.map(|(name, value)| (number, name.trim(), value.trim())));
        }
        let Some((number, _, file)) = said.iter().find(|(_, name, _)| name == &key) else { continue };
        for (name, wanted) in with {
            let value = said.iter().find(|(_, known, _)| known == name).map(|(number, _, value)| (*number, *value));
            if value.is_none_or(|(_, value)| value != wanted) {
                let (line, value) = value.unwrap_or((*number, "not there"));
                let message = format!("`{name}` is {value}: only tables under `{name} = {wanted}` are read here");
                return Err(Fault::new(line, message));
            }
        }
        all.push(AxisFile { file: base(file).to_owned(), axis });
    }
    Ok(all)
}

/// A line with a header before the letters of axes, then lines with a file under each letter.
fn columns(header: &str, letters: &[AssignedAxis], text: &str) -> Vec<AxisFile> {
    let mut rows = text.lines().map(str::split_whitespace).map(Iterator::collect::<Vec<_>>);
    let head: Vec<&str> = header.split_whitespace().collect();
    let Some(names) = rows.find(|row| row.starts_with(&head)) else { return Vec::new() };
    let axis = |column: usize| {
        let letter = names.get(column)?;
        letters.iter().find(|known| known.letter == *letter).map(|known| known.axis)
    };
    let under = |row: Vec<&str>| {
        let files = row.iter().enumerate().skip(head.len()).filter(|(_, file)| **file != "-");
        files.filter_map(|(column, file)| Some(AxisFile { file: base(file).to_owned(), axis: axis(column)? })).collect()
    };
    rows.flat_map(|row| -> Vec<AxisFile> { under(row) }).collect()
}

fn base(path: &str) -> &str {
    path.trim_matches('"').rsplit(['/', '\\']).next().unwrap_or(path)
}

/// The axis whose file, as the target names it, is named in the first line around the columns, and which line that is.
pub(super) fn by_frame(layout: &FileLayout, names: &[(Option<usize>, String)], text: &str) -> Option<(usize, usize)> {
    let FileLayout::AxisColumns { frame, .. } = layout else { return None };
    let said = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with(&*frame.comment);
    let (line, first) = text.lines().enumerate().find(|(_, line)| said(line))?;
    let words: Vec<&str> = first.split([' ', '.', '\t']).collect();
    let stem = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    let mut named = names.iter().filter(|(_, name)| words.contains(&&*stem(name)));
    match (named.next(), named.next()) {
        (Some((axis, _)), None) => axis.map(|axis| (line, axis)),
        _ => None,
    }
}

/// True if positions span the travel of an axis from end to end, as tables do.
pub(super) fn spans(target: &ControllerTarget, machine: &Machine, axis: usize, positions: &[f64]) -> bool {
    let continuous = target.manifest.mechanism.iter().next().map_or((0.0, 360.0), |(_, rules)| rules.continuous);
    let (min, max) = if machine.is_continuous(axis) { continuous } else { machine.axes()[axis].travel.interval() };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-3;
    matches!(positions, [first, .., last] if near(*first, min) && near(*last, max))
}

/// Files that are assigned otherwise than by their names, or read otherwise than here.
pub(super) fn index_fault(
    target: &ControllerTarget,
    letters: &[AssignedAxis],
    files: &[ReadBack],
) -> Option<(usize, Fault)> {
    let indices = target.manifest.files.iter().filter_map(|spec| Some((spec, spec.index.as_ref()?)));
    indices.into_iter().find_map(|(spec, index)| {
        let at = files.iter().position(|file| file.name == spec.path)?;
        axis_files(index, letters, &files[at].text).err().map(|fault| (at, fault))
    })
}
