//! `abbe compile`: the compensation files of a controller, with their certificate.

use crate::cli::Outcome;
use crate::cli::arguments::{InstalledArg, help};
use crate::cli::how::SetArgs;
use crate::cli::output::certificate::CertificateView;
use crate::cli::output::session::Session;
use crate::cli::store::archive;
use crate::cli::store::file_set::{self, NewSet};
use crate::cli::store::write;
use abbe::options::Limits;
use abbe::sets::target_writes;
use abbe::{CompileOptions, MachineFile};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[arg(long, value_name = "NAME", required = true, help = help::TARGET,
        long_help = "The controller; `abbe targets` lists them. Kinematic parameters and tables for what they leave: \
            both targets, each with its --target or as A+B")]
    target: Vec<String>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "Folder for the files")]
    out: PathBuf,
    /// Write files of a format or a sign that is known from memory only.
    #[arg(long)]
    accept_unverified: bool,
    /// Replace the set of another target or machine in --out.
    #[arg(long)]
    replace: bool,
    /// Archive the set that this run replaces in the folder of a record, outside of --out.
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    installed: InstalledArg,
    /// INI file of LinuxCNC: the pole zone of a generated module is chosen by the limits of its drives.
    #[arg(long, value_name = "FILE")]
    ini: Option<PathBuf>,
    /// Kinematic parameters: no other tables are in force than those of --installed.
    #[arg(long)]
    nothing_else: bool,
    /// Raise the limits on corrections: length, angle, slope.
    #[arg(long, value_name = "1 mm, 5 mrad, 0.01", value_parser = Limits::parse)]
    max_correction: Option<Limits>,
    /// Axes that span a lattice [default: all]. The others are at 0 in its nodes.
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    lattice: Vec<String>,
    /// Maximum number of lattice nodes (1 or more) [default: what the controller takes].
    #[arg(long, value_name = "N", default_value_t = usize::MAX, hide_default_value = true)]
    nodes: usize,
}

impl Args {
    fn targets(&self) -> Vec<String> {
        self.target.iter().flat_map(|name| name.split('+')).map(str::to_owned).collect()
    }

    fn options(&self) -> CompileOptions {
        CompileOptions {
            target: self.target.first().cloned().unwrap_or_default(),
            compensation: self.set.how.options(),
            poses: self.set.poses.poses,
            seed: self.set.seed.seed,
            accept_unverified: self.accept_unverified,
            installed: self.installed.installed.clone(),
            max_change_mm: self.installed.max_change,
            ini: self.ini.clone(),
            nothing_else: self.nothing_else,
            out: Some(self.out.clone()),
            work: self.set.certified_work(),
            max_correction: self.max_correction.unwrap_or_default(),
            lattice: self.lattice.clone(),
            max_nodes: self.nodes,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.set.tool.name())?;
    // Refusals come before the work.
    write::refuse_no_folder(&args.out).or_else(|refusal| session.refuse(refusal))?;
    if let Some(record) = &args.record {
        write::refuse_no_folder(record).or_else(|refusal| session.refuse(refusal))?;
        archive::refuse_inside(session, record, &args.out)?;
    }
    if let Some(installed) = &args.installed.installed {
        file_set::check(session, installed)?;
    }
    if args.targets().len() > 1 {
        return compose(session, args, &file);
    }
    let set = session.take(abbe::compile(&file, &args.options(), session.run()))?;
    archive(session, args)?;
    let compensation = args.set.how.options();
    let writes = |target: &str, name: &str| target_writes(&compensation, target, name, session.run());
    let other = args.replace;
    let of = |files, lock| NewSet { files, lock, read: &session.files, writes: &writes, other };
    let restore: Vec<_> = set.restore.iter().map(|one| (one.folder.as_str(), of(&one.files, &one.lock))).collect();
    match of(&set.files, &set.lock).write_above(&args.out, &restore) {
        Ok(warnings) => warnings.into_iter().for_each(|warning| session.diagnostics.push(warning)),
        Err(refusal) => return session.refuse(refusal),
    }
    CertificateView { report: &set.certificate, folder: &args.out }.print(session)
}

/// Archives the set that is there, once the new one is known to compile.
fn archive(session: &mut Session, args: &Args) -> Outcome {
    args.record.as_ref().map_or(Ok(()), |record| archive::keep(session, record, &args.out))
}

/// Writes the sets of two targets and what takes them back into subfolders, then the manifest over both.
fn compose(session: &mut Session, args: &Args, file: &MachineFile) -> Outcome {
    let set = session.take(abbe::compile_composed(file, &args.targets(), &args.options(), session.run()))?;
    archive(session, args)?;
    let compensation = args.set.how.options();
    let writes = |target: &str, name: &str| target_writes(&compensation, target, name, session.run());
    let of = |files, lock| NewSet { files, lock, read: &session.files, writes: &writes, other: args.replace };
    let parts = set.parts.iter().chain(&set.restore);
    let parts: Vec<_> = parts.map(|one| (one.folder.as_str(), of(&one.files, &one.lock))).collect();
    match of(&[], &set.lock).write_above(&args.out, &parts) {
        Ok(warnings) => warnings.into_iter().for_each(|warning| session.diagnostics.push(warning)),
        Err(refusal) => return session.refuse(refusal),
    }
    CertificateView { report: &set.certificate, folder: &args.out }.print(session)
}
