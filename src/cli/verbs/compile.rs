//! `abbe compile`: the compensation files of a target, with their certificate.

use crate::cli::how::Options;
use crate::cli::module_set;
use crate::cli::module_set::Module;
use crate::cli::output::certificate::{CertificateView, warnings};
use crate::cli::output::session::Session;
use crate::cli::store::{file_set, write};
use crate::cli::table_set;
use crate::cli::table_set::RenderedTables;
use crate::cli::{Outcome, load};
use crate::controller::{
    Certificate, ControllerTarget, Hashed, JudgedTables, Limits, Lock, NAMES, RenderedFile, certify_kinematics,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The controller; `abbe targets` lists them.
    #[arg(long)]
    pub target: String,
    /// Folder for the files.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Write files of a format or a sign that is known from memory only.
    #[arg(long)]
    accept_unverified: bool,
    #[command(flatten)]
    pub options: Options,
    /// The compensation files that were in force when the machine was measured: what is written is old plus new.
    #[arg(long, value_name = "DIR")]
    installed: Option<PathBuf>,
    /// Raise the limits on corrections: length, angle, slope.
    #[arg(long, value_name = "1 mm, 5 mrad, 0.01", value_parser = Limits::parse)]
    pub max_correction: Option<Limits>,
    /// Axes that span a lattice; all by default. The others stand at 0 in its nodes.
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    lattice: Vec<String>,
    /// At most so many nodes of a lattice.
    #[arg(long, value_name = "N", default_value_t = usize::MAX, hide_default_value = true)]
    nodes: usize,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.options.tool.as_deref())?;
    load::warn_bounded(session, &machine);
    write::refuse_no_folder(&args.out).or_else(|refusal| session.refuse(refusal))?;
    let inputs = file_set::inputs(session);
    let target = args.options.how.target(session, &args.target, None)?;
    refuse_unverified(session, &target, args.accept_unverified)?;
    if target.manifest.kinematics().is_some() {
        return module(session, args, &machine, &target, inputs);
    }
    let installed = table_set::installed(session, &machine, &target, &args.options, args.installed.as_deref())?;
    let limits = args.max_correction.unwrap_or_default();
    let lattice = (&args.lattice[..], args.nodes);
    let made =
        table_set::made(session, &machine, &target, lattice, args.options.how.scope(), limits, installed.as_ref())?;
    let RenderedTables { rendered, tables } = made;
    let judged = JudgedTables { target: &target, tables: &tables, installed: installed.as_ref() };
    let certificate = args.options.certificate(&machine, judged);
    target.unplaced(&machine).into_iter().for_each(|warning| session.diagnostics.push(warning));
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    Set { rendered, words: args.options.how.words(), inputs }.write(session, args, (&machine, &target), &certificate)
}

/// A set of files, with what its manifest says of it.
struct Set {
    rendered: Vec<RenderedFile>,
    words: Vec<String>,
    inputs: Vec<Hashed>,
}

impl Set {
    /// Writes it with its manifest, and shows its certificate.
    fn write(
        self,
        session: &mut Session,
        args: &Args,
        (machine, target): (&Machine, &ControllerTarget),
        certificate: &Certificate,
    ) -> Outcome {
        let Self { rendered, words, inputs } = self;
        let files = rendered.iter().map(|file| Hashed::new(&file.name, &file.bytes)).collect();
        let lock = Lock::new(&args.target, machine, words, inputs, files);
        file_set::write(&args.out, &rendered, &lock).or_else(|refusal| session.refuse(refusal))?;
        let files = rendered.into_iter().map(|file| file.name).collect();
        CertificateView { machine, target, certificate, files, folder: &args.out }.print(session);
        Ok(())
    }
}

/// The files of a kinematics module.
fn module(
    session: &mut Session,
    args: &Args,
    machine: &Machine,
    target: &ControllerTarget,
    inputs: Vec<Hashed>,
) -> Outcome {
    module_set::refuse_installed(session, args.installed.is_some())?;
    let orientation = args.options.how.orientation();
    let limits = args.max_correction.unwrap_or_default();
    let Module { rendered, carried, beside } = module_set::made(session, machine, target, orientation, limits)?;
    let certificate = certify_kinematics(machine, target, (&carried, &beside), args.options.depth());
    limits.exceeded_by(&certificate).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    let goal = if orientation { "correct pose" } else { "correct position" };
    Set { rendered, words: vec![goal.to_owned()], inputs }.write(session, args, (machine, target), &certificate)
}

/// What rests on memory alone is written only for those who say that they know. A folder of one's own
/// needs no such word: who wrote its manifest knows.
fn refuse_unverified(session: &mut Session, target: &ControllerTarget, accepted: bool) -> Outcome {
    let name = &target.manifest.target;
    if accepted || !target.manifest.unverified() || !NAMES.contains(&&**name) {
        return Ok(());
    }
    let message = format!("the format of `{name}` is known from memory only: {}", target.manifest.caution());
    let help = "`abbe explain TARGET` says what is sure; to write the files all the same: --accept-unverified";
    session.refuse(Diagnostic::new(codes::E0710, message).help(help))
}
