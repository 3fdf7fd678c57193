//! What a controller adds at single positions, with which a test of a real controller compares.

use super::compensation::table_set::FoundTables;
use super::machine_file::MachineFile;
use super::run::{Answer, Call, Refused, Run};
use super::verify::{VerifyOptions, opened, tables};
use crate::controller::{Replay, assigned_letters};
use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes};
use crate::machine::{Approach, Machine};
use crate::syntax::read_text;
use crate::units::number;
use std::path::Path;

/// A position at which a table is read.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ReplayPosition {
    /// Number of the joint in the controller's order, from 0.
    pub joint: usize,
    /// Direction of approach: forward or reverse.
    pub approach: Approach,
    /// Position of the joint, mm or deg; all other axes stand at 0.
    pub position: f64,
}

impl ReplayPosition {
    /// Reads positions for joints of a machine from a CSV file with the columns joint, direction, position; further
    /// columns are left alone.
    ///
    /// Fails for another header, and for a line that is no such position.
    pub fn list(machine: &Machine, path: &Path, run: Run<'_>) -> Result<Answer<Vec<Self>>, Diagnostics> {
        Call::answer(run, &Sources::default(), |call| listed(call, machine, path))
    }

    fn of_line(line: &str) -> Option<Self> {
        let mut cells = line.split(',');
        let joint = cells.next()?.trim().parse().ok()?;
        let approach = match cells.next()?.trim() {
            "forward" => Approach::Forward,
            "reverse" => Approach::Reverse,
            _ => return None,
        };
        Some(Self { joint, approach, position: number(cells.next()?).ok()? })
    }
}

fn listed(call: &mut Call<'_>, machine: &Machine, path: &Path) -> Result<Vec<ReplayPosition>, Refused> {
    let read = read_text(path, None, call.run.files, &mut call.diagnostics);
    let (_, text) = read.ok_or(Refused)?;
    let mut lines = text.lines();
    if !lines.next().unwrap_or_default().replace(' ', "").starts_with("joint,direction,position") {
        let message = format!("`{}` does not begin with the header joint,direction,position", path.display());
        let help = "further columns may follow; one position a line";
        return call.refuse(Diagnostic::new(codes::E0802, message).help(help));
    }
    let mut positions = Vec::new();
    for line in lines {
        let Some(at) = ReplayPosition::of_line(line).filter(|at| at.joint < machine.axes().len()) else {
            let message = format!("`{}`: `{line}` is not joint,direction,position", path.display());
            let help = "write a joint of this machine, forward or reverse, and a number";
            return call.refuse(Diagnostic::new(codes::E0802, message).help(help));
        };
        positions.push(at);
    }
    Ok(positions)
}

/// Returns what the controller adds to the joint at each position, mm or deg.
///
/// Fails like [`verify`](super::verify()), and for a kinematics module, which has no tables that hold for a joint
/// alone.
pub fn replay(
    file: &MachineFile,
    folder: &Path,
    positions: &[ReplayPosition],
    options: &VerifyOptions,
    run: Run,
) -> Result<Answer<Vec<f64>>, Diagnostics> {
    Call::answer(run, file.sources(), |call| {
        let set = opened(call, file, folder, options)?;
        if set.target.manifest.kinematics().is_some() {
            return call.usage("--replay: a kinematics module has no tables that hold for a joint alone");
        }
        let (FoundTables { target, tables, .. }, _) = tables(call, file, folder, set, options)?;
        let replay = Replay::new(file, &target, &tables);
        let letters = assigned_letters(file, target.manifest.axis_letters.as_ref(), None).unwrap_or_default();
        positions.iter().map(|at| added(call, file, &replay, &letters, at)).collect()
    })
}

fn added(
    call: &mut Call,
    file: &MachineFile,
    replay: &Replay,
    letters: &[(usize, String)],
    at: &ReplayPosition,
) -> Result<f64, Refused> {
    let Some((axis, _)) = letters.get(at.joint) else {
        let message = format!("the machine has no joint {}", at.joint);
        return call.refuse(
            Diagnostic::new(codes::E0802, message).help("joints are numbered from 0 in the controller's order"),
        );
    };
    let mut command = vec![0.0; file.axes().len()];
    command[*axis] = at.position;
    Ok(replay.added(&command, at.approach)[*axis])
}
