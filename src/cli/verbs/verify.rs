//! `abbe verify`: replay files as the controller would and certify the residual.

use crate::cli::Outcome;
use crate::cli::arguments::{FrameOption, InstalledArg, NoiseArg, help};
use crate::cli::how::SetArgs;
use crate::cli::output::certificate::CertificateView;
use crate::cli::output::session::Session;
use crate::cli::store::file_set;
use abbe::options::{Approach, ReplayPosition, SecondOptions};
use abbe::sets::set_manifest;
use abbe::{MachineFile, VerifyOptions};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The folder with the compensation files.
    folder: PathBuf,
    #[arg(long, value_name = "NAME", help = help::TARGET,
        long_help = "The controller, if no manifest in the folder names it; `abbe targets` lists them")]
    target: Option<String>,
    /// Print what the controller adds at positions, as CSV, instead of a certificate. The CSV file has the columns
    /// joint, direction, position; further columns are ignored. A joint is the controller's letter, the name in the
    /// machine file, or a number from 0 in the controller's order.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    installed: InstalledArg,
    #[command(flatten)]
    second: SecondArgs,
}

/// Readings of the machine that was driven with the set.
#[derive(Debug, clap::Args)]
struct SecondArgs {
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "replay", help = help::DATA)]
    data: Vec<PathBuf>,
    #[arg(long, value_name = "FILE", requires = "data", help = help::AXIS_POSES)]
    axis_poses: Option<PathBuf>,
    #[arg(long, value_name = "UNCERTAINTY", requires = "data", help = help::TYPE_B)]
    type_b: Vec<String>,
    #[command(flatten)]
    frame: FrameOption,
    #[command(flatten)]
    noise: NoiseArg,
}

impl SecondArgs {
    fn options(&self) -> SecondOptions {
        SecondOptions {
            data: self.data.clone(),
            frame: self.frame.frame,
            axis_poses: self.axis_poses.clone(),
            type_b: self.type_b.clone(),
            noise_mm: self.noise.noise,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    for folder in std::iter::once(&args.folder).chain(&args.installed.installed) {
        file_set::check(session, folder)?;
    }
    // The tables hold for the tool they were made for.
    let made_for = set_manifest(&args.folder, session.run()).map(|lock| lock.tool).filter(|name| !name.is_empty());
    let file = session.load(&args.machine, args.set.tool.name().or(made_for.as_deref()))?;
    let options = VerifyOptions {
        target: args.target.clone(),
        compensation: args.set.how.options(),
        poses: args.set.poses.poses,
        seed: args.set.seed.seed,
        installed: args.installed.installed.clone(),
        max_change_mm: args.installed.max_change,
        work: args.set.certified_work(),
        second: args.second.options(),
    };
    if let Some(path) = &args.replay {
        return replay(session, &file, &args.folder, path, &options);
    }
    let report = session.take(abbe::verify(&file, &args.folder, &options, session.run()))?;
    let warning = abbe::sets::restore_warning(&args.folder, session.run());
    warning.into_iter().for_each(|warning| session.diagnostics.push(warning));
    CertificateView { report: &report, folder: &args.folder }.print(session)
}

/// Prints the replay at single positions, with which a test of a real controller compares.
fn replay(session: &mut Session, file: &MachineFile, folder: &Path, path: &Path, options: &VerifyOptions) -> Outcome {
    let positions = session.take(ReplayPosition::list(path, session.run()))?;
    let added = session.take(abbe::replay(file, folder, &positions, options, session.run()))?;
    let mut out = String::from("joint,direction,position,correction\n");
    for (at, added) in positions.iter().zip(added) {
        let direction = if at.approach == Approach::Forward { "forward" } else { "reverse" };
        out.push_str(&format!("{},{direction},{},{added}\n", at.joint, at.position));
    }
    session.print(&out);
    Ok(())
}
