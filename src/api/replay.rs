//! Corrections of a controller at single positions, with which a test of a real controller compares.

use super::verify::{VerifyOptions, open, tables};
use crate::controller::{AssignedAxis, Replay, axis_letters, by_number};
use crate::diagnostic::{Diagnostic, Sources, codes, shown};
use crate::file_set::table_set::FoundTables;
use crate::job::machine_file::MachineFile;
use crate::machine::Approach;
use crate::run::{Call, Refused, Reply, Run};
use crate::syntax::read_text;
use crate::units::{FARTHEST, number};
use std::path::Path;

/// A position at which a table is read.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ReplayPosition {
    /// The joint: the controller's letter for it, its name in the machine file, or its number from 0 in the order in
    /// which the controller counts its letters.
    pub joint: String,
    /// Direction of approach: forward or reverse.
    pub approach: Approach,
    /// Position of the joint, mm or deg; all other axes are at 0.
    pub position: f64,
}

impl ReplayPosition {
    /// Reads positions of joints from a CSV file with the columns joint (or axis), direction, position;
    /// further columns are ignored.
    ///
    /// Fails for another header, and for a line without such a position.
    pub fn list(path: &Path, run: Run) -> Reply<Vec<Self>> {
        Call::answer(run, &Sources::default(), |call| list_positions(call, path))
    }

    /// Reads a line with as many cells as the header has columns.
    fn of_line(line: &str, columns: usize) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let [joint, approach, position, ..] = cells[..] else { return None };
        let approach = match approach.trim() {
            "forward" => Approach::Forward,
            "reverse" => Approach::Reverse,
            _ => return None,
        };
        let position = number(position).ok().filter(|position| position.abs() <= FARTHEST)?;
        (cells.len() == columns).then(|| Self { joint: joint.trim().to_owned(), approach, position })
    }
}

fn list_positions(call: &mut Call, path: &Path) -> Result<Vec<ReplayPosition>, Refused> {
    let read = read_text(path, None, call.run.files, &mut call.diagnostics);
    let (_, text) = read.ok_or(Refused)?;
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default().replace(' ', "");
    if !["joint", "axis"].iter().any(|joint| header.starts_with(&format!("{joint},direction,position"))) {
        let message = format!("`{}` does not begin with the header joint,direction,position", path.display());
        let help = "further columns may follow; one position a line";
        return call.refuse(Diagnostic::new(codes::E0802, message).help(help));
    }
    let columns = header.split(',').count();
    let mut positions = Vec::new();
    for (number, line) in (2..).zip(lines) {
        let Some(at) = ReplayPosition::of_line(line, columns) else {
            let (path, line) = (path.display(), shown(line));
            let message = format!("`{path}`, line {number}: `{line}` is not joint,direction,position");
            let help = format!(
                "write the letter of a joint of this machine, forward or reverse, and a number with a point up to \
                 {FARTHEST:e} mm or deg, in as many cells as the header has"
            );
            return call.refuse(Diagnostic::new(codes::E0802, message).help(help));
        };
        positions.push(at);
    }
    Ok(positions)
}

/// Returns the correction of the controller for the joint at each position, mm or deg.
///
/// Fails like [`verify`](super::verify()), and for a kinematics module: it has no tables that hold for a joint alone.
pub fn replay(
    file: &MachineFile,
    folder: &Path,
    positions: &[ReplayPosition],
    options: &VerifyOptions,
    run: Run,
) -> Reply<Vec<f64>> {
    Call::answer(run, file.sources(), |call| {
        let set = open(call, file, folder, options)?;
        if set.target.manifest.kinematics().is_some() {
            return call.usage("--replay: a kinematics module has no tables that hold for a joint alone");
        }
        let (FoundTables { target, tables, .. }, _) = tables(call, file, folder, set, options)?;
        let replay = Replay::new(file, &target, &tables);
        let letters = axis_letters(file, target.manifest.axis_letters.as_ref(), None).unwrap_or_default();
        positions.iter().map(|at| correction_at(call, file, &replay, &letters, at)).collect()
    })
}

fn correction_at(
    call: &mut Call,
    file: &MachineFile,
    replay: &Replay,
    letters: &[AssignedAxis],
    at: &ReplayPosition,
) -> Result<f64, Refused> {
    let by_letter = letters.iter().find(|known| known.letter == at.joint);
    let by_name = || letters.iter().find(|known| file.axes()[known.axis].name.as_str() == at.joint);
    let by_number = || by_number(letters, at.joint.parse::<usize>().ok()?.checked_add(1)?);
    let Some(AssignedAxis { axis, .. }) = by_letter.or_else(by_name).or_else(by_number) else {
        let joint = |known: &AssignedAxis| format!("{} ({})", known.letter, known.number - 1);
        let known: Vec<String> = letters.iter().map(joint).collect();
        let message = format!("the machine has no joint `{}`", shown(&at.joint));
        let help = format!("the controller's letters, and their numbers, are {}", known.join(", "));
        return call.refuse(Diagnostic::new(codes::E0802, message).help(help));
    };
    let mut command = vec![0.0; file.axes().len()];
    command[*axis] = at.position;
    Ok(replay.addition(&at.approach.at_pose(&command))[*axis])
}
