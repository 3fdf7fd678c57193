//! `abbe verify`: replay files as the controller would and certify what they leave.

use crate::api::{Approach, Diagnostic, MachineFile, ReplayPosition, VerifyOptions, codes, number, set_manifest};
use crate::cli::how::SetArgs;
use crate::cli::output::certificate::CertificateView;
use crate::cli::output::session::Session;
use crate::cli::store::file_set;
use crate::cli::{Exit, Outcome};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The folder with the compensation files.
    folder: PathBuf,
    /// The controller, if the folder has no manifest that says it.
    #[arg(long)]
    target: Option<String>,
    /// Instead of a certificate: what the controller adds at positions from a CSV file with the
    /// columns joint, direction, position (further columns are left alone), as CSV.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    /// The compensation files that were in force when the machine was measured: what is judged here replaces them.
    #[arg(long, value_name = "DIR")]
    installed: Option<PathBuf>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    for folder in std::iter::once(&args.folder).chain(&args.installed) {
        file_set::settle(session, folder)?;
    }
    // The tables hold for the tool they were made for.
    let made_for = set_manifest(&args.folder, session.run()).map(|lock| lock.tool).filter(|name| !name.is_empty());
    let file = session.load(&args.machine, args.set.tool.clone().or(made_for).as_deref())?;
    let options = VerifyOptions {
        target: args.target.clone(),
        compensation: args.set.how.options(),
        poses: args.set.poses as usize,
        seed: args.set.seed,
        installed: args.installed.clone(),
    };
    if let Some(path) = &args.replay {
        return replay(session, &file, &args.folder, path, &options);
    }
    let answer = crate::api::verify(&file, &args.folder, &options, session.run());
    let report = session.take(answer)?;
    CertificateView { report: &report, folder: &args.folder }.print(session);
    Ok(())
}

/// Prints the replay at single positions, with which a test of a real controller compares.
fn replay(session: &mut Session, file: &MachineFile, folder: &Path, path: &Path, options: &VerifyOptions) -> Outcome {
    let positions = positions(session, file, path)?;
    let answer = crate::api::replay(file, folder, &positions, options, session.run());
    let added = session.take(answer)?;
    let mut out = String::from("joint,direction,position,correction\n");
    for (at, added) in positions.iter().zip(added) {
        let direction = if at.approach == Approach::Forward { "forward" } else { "reverse" };
        out.push_str(&format!("{},{direction},{},{added}\n", at.joint, at.position));
    }
    session.print(&out);
    Ok(())
}

fn positions(session: &mut Session, file: &MachineFile, path: &Path) -> Result<Vec<ReplayPosition>, Exit> {
    let text = session.read(path)?;
    let mut lines = text.lines();
    if !lines.next().unwrap_or_default().replace(' ', "").starts_with("joint,direction,position") {
        let message = format!("`{}` does not begin with the header joint,direction,position", path.display());
        let help = "further columns may follow; one position a line";
        return session.refuse(Diagnostic::new(codes::E0802, message).help(help));
    }
    let mut positions = Vec::new();
    for line in lines {
        match position(line).filter(|at| at.joint < file.axes().len()) {
            Some(at) => positions.push(at),
            None => {
                let message = format!("`{}`: `{line}` is not joint,direction,position", path.display());
                let help = "write a joint of this machine, forward or reverse, and a number";
                return session.refuse(Diagnostic::new(codes::E0802, message).help(help));
            }
        }
    }
    Ok(positions)
}

fn position(line: &str) -> Option<ReplayPosition> {
    let mut cells = line.split(',');
    let joint = cells.next()?.trim().parse().ok()?;
    let approach = match cells.next()?.trim() {
        "forward" => Approach::Forward,
        "reverse" => Approach::Reverse,
        _ => return None,
    };
    Some(ReplayPosition { joint, approach, position: number(cells.next()?).ok()? })
}
