//! `abbe compile`: the compensation files of a target, with their certificate.

use super::certificate_output::{Shown, warnings};
use super::files::Disk;
use super::session::Session;
use super::{Outcome, Stop, file_set, kinematics, load, verify, write};
use crate::compensation::{Fit, Goal, LatticeRequest, Scope, Stored, Tables, resampled};
use crate::diagnostic::{Diagnostic, shown};
use crate::machine::{AxisKind, Machine};
use crate::target::{
    Certificate, Depth, Effect, Hashed, Judged, Limits, Lock, NAMES, ReadBack, RenderedFile, Target, certify,
    certify_kinematics, is_plain_name,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug, clap::Args)]
pub(super) struct Args {
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

/// Options that `compile` and `verify` share.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub how: How,
    /// Which of the machine's tools.
    #[arg(long)]
    pub tool: Option<String>,
    /// Poses of the certificate.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub poses: u32,
    /// Seed of the certificate's poses.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// How a machine is compensated.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct How {
    /// What is corrected: the position (a lattice's default), or the position and the direction of the tool axis (a kinematics module's).
    #[arg(long, value_enum)]
    correct: Option<GoalArg>,
    /// With which axes; linear by default for the position, all for the pose.
    #[arg(long, value_enum)]
    with: Option<WithArg>,
    /// A folder with targets of your own.
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    /// What stored numbers mean, where the manual does not say it; by default what `abbe targets` says.
    #[arg(long, value_enum)]
    pub stored: Option<StoredArg>,
    /// Leave out tables of one kind that the controller would have: product, plane, cross_axis, own_axis.
    #[arg(long, value_name = "KIND")]
    without: Vec<String>,
    /// What own-axis tables are made for: the axis's own error at its origin, or the deviation of the functional point.
    #[arg(long, value_enum)]
    fit: Option<FitArg>,
}

/// What own-axis tables are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum FitArg {
    Axis,
    FunctionalPoint,
}

/// The meaning of stored numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum StoredArg {
    /// Added to the command.
    Correction,
    /// Actual minus nominal; the controller subtracts it.
    Error,
}

impl StoredArg {
    fn word(self) -> &'static str {
        match self {
            Self::Correction => "stored correction",
            Self::Error => "stored error",
        }
    }

    /// What the manifest of a set says.
    pub(super) fn of(options: &[String]) -> Option<Self> {
        [Self::Correction, Self::Error].into_iter().find(|arg| options.iter().any(|o| o == arg.word()))
    }
}

/// What is corrected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum GoalArg {
    Position,
    Pose,
}

/// Which axes correct.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum WithArg {
    Linear,
    All,
}

/// Below this sine of the angle from a singular pose the rotary axes' correction is bounded: lattice
/// cells are about 15 deg wide, and what changes faster than that cannot be interpolated.
const LATTICE_DAMPING: f64 = 0.15;

impl Options {
    /// What the tables leave, at the poses asked for.
    pub(super) fn certificate(&self, machine: &Machine, judged: Judged) -> Certificate {
        certify(machine, judged, self.how.scope(), self.poses as usize, self.seed)
    }
}

impl How {
    pub(super) fn scope(&self) -> Scope {
        let (goal, usual) = match self.correct.unwrap_or(GoalArg::Position) {
            GoalArg::Position => (Goal::Position, WithArg::Linear),
            GoalArg::Pose => (Goal::Pose, WithArg::All),
        };
        Scope { goal, rotary: self.with.unwrap_or(usual) == WithArg::All, damping: LATTICE_DAMPING }
    }

    /// Does a kinematics module correct the direction of the tool axis too?
    pub(super) fn orientation(&self) -> bool {
        self.correct != Some(GoalArg::Position) && self.with != Some(WithArg::Linear)
    }

    /// What is written into the manifest of a set.
    fn words(&self) -> Vec<String> {
        let scope = self.scope();
        let goal = if scope.goal == Goal::Pose { "pose" } else { "position" };
        let mut words =
            vec![format!("correct {goal}"), format!("with {} axes", if scope.rotary { "all" } else { "linear" })];
        words.extend(self.stored.map(|stored| stored.word().to_owned()));
        words.extend(self.without.iter().map(|kind| format!("without {kind}")));
        words.extend(self.fit.map(|fit| match fit {
            FitArg::Axis => "fit axis".to_owned(),
            FitArg::FunctionalPoint => "fit functional-point".to_owned(),
        }));
        words
    }

    /// Names of the folders of targets of one's own.
    pub(super) fn own_targets(&self) -> Vec<String> {
        let entries = self.templates.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
        let with_manifest = entries.filter(|entry| entry.path().join("target.yaml").is_file());
        let mut names: Vec<String> = with_manifest.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.retain(|name| is_plain_name(name));
        names.sort();
        names
    }

    /// The target of a name, its stored numbers meaning what is asked for.
    pub(super) fn target(&self, session: &mut Session, name: &str, stored: Option<StoredArg>) -> Result<Target, Stop> {
        if let Some(folder) = self.templates.as_deref().filter(|_| is_plain_name(name)) {
            refuse_links(session, &folder.join(name))?;
        }
        let target = Target::find(name, self.templates.as_deref(), &Disk, &mut session.diagnostics);
        let mut target = target.ok_or(Stop::Refused)?;
        match stored.or(self.stored) {
            Some(StoredArg::Correction) => target.manifest.mechanism.store(Stored::Correction),
            Some(StoredArg::Error) => target.manifest.mechanism.store(Stored::Error),
            None => {}
        }
        for kind in &self.without {
            if !target.manifest.mechanism.leave_out(kind) {
                return session.usage(&format!(
                    "--without: the target `{name}` has no tables `{}`, or none besides",
                    kind.escape_debug()
                ));
            }
        }
        match self.fit {
            Some(FitArg::Axis) => target.manifest.mechanism.fit(Fit::Axis),
            Some(FitArg::FunctionalPoint) => target.manifest.mechanism.fit(Fit::FunctionalPoint),
            None => {}
        }
        Ok(target)
    }
}

/// A link in a target's folder would carry a file from anywhere into the set.
fn refuse_links(session: &mut Session, folder: &Path) -> Outcome {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut links = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_symlink()));
    let Some(link) = links.next() else { return Ok(()) };
    let message = format!("`{}` is a link", shown(&link.path().display().to_string()));
    session.refuse(Diagnostic::new("E0703", message).help("copy the file: a target's folder holds its own files"))
}

/// Indices of the axes that span a lattice: those named, in the order of the chain, or all.
fn lattice_axes(session: &Session, machine: &Machine, named: &[String]) -> Result<Vec<usize>, Stop> {
    let all = 0..machine.axes().len();
    if let Some(unknown) = named.iter().find(|name| machine.axis_index(name).is_none()) {
        return session.usage(&format!("--lattice: the chain has no axis `{}`", unknown.escape_debug()));
    }
    if let Some((_, twice)) = named.iter().enumerate().find(|(i, name)| named[..*i].contains(name)) {
        return session.usage(&format!("--lattice: `{}` is there twice", twice.escape_debug()));
    }
    let wanted = |axis: &usize| named.is_empty() || named.iter().any(|name| machine.axis_index(name) == Some(*axis));
    Ok(all.filter(wanted).collect())
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.options.tool.as_deref())?;
    load::warn_bounded(session, &machine);
    write::refuse_no_folder(&args.out).or_else(|refusal| session.refuse(refusal))?;
    let inputs = inputs(session);
    let target = args.options.how.target(session, &args.target, None)?;
    refuse_unverified(session, &target, args.accept_unverified)?;
    if target.manifest.kinematics().is_some() {
        return kinematics::compile(session, args, &machine, &target, inputs);
    }
    let installed = verify::installed(session, &machine, &target, &args.options, args.installed.as_deref())?;
    let limits = args.max_correction.unwrap_or_default();
    let lattice = (&args.lattice[..], args.nodes);
    let made = made(session, &machine, &target, lattice, args.options.how.scope(), limits, installed.as_ref())?;
    let Made { rendered, tables } = made;
    let judged = Judged { target: &target, tables: &tables, installed: installed.as_ref() };
    let certificate = args.options.certificate(&machine, judged);
    target.unplaced(&machine).into_iter().for_each(|warning| session.diagnostics.push(warning));
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    let files = rendered.iter().map(|file| Hashed::new(&file.name, &file.bytes)).collect();
    let lock = Lock::new(&args.target, &machine, args.options.how.words(), inputs, files);
    if let Err(refusal) = file_set::write(&args.out, &rendered, &lock) {
        return session.refuse(refusal);
    }
    let names = rendered.iter().map(|file| file.name.clone()).collect();
    Shown { machine: &machine, target: &target, certificate: &certificate, files: names, folder: &args.out }
        .print(session);
    Ok(())
}

/// What a target does to a machine by the files that `compile` would write, and the certificate over so many
/// poses; nothing is written.
pub(super) fn effect(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    how: &How,
    (poses, seed): (usize, u64),
) -> Result<(Effect, Certificate), Stop> {
    let (effect, certificate) = if target.manifest.kinematics().is_some() {
        let module = kinematics::made(session, machine, target, how.orientation(), Limits::default())?;
        let (carried, beside) = (module.carried, module.beside);
        let certificate = certify_kinematics(machine, target, (&carried, &beside), Depth { poses, seed });
        (Effect::Module(Box::new(carried), beside), certificate)
    } else {
        let limits = Limits::default();
        let tables = made(session, machine, target, (&[], usize::MAX), how.scope(), limits, None)?.tables;
        let judged = Judged { target, tables: &tables, installed: None };
        let certificate = certify(machine, judged, how.scope(), poses, seed);
        (Effect::Tables(tables), certificate)
    };
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    Ok((effect, certificate))
}

/// A set of files before it is written, and the tables that the controller reads from it.
struct Made {
    rendered: Vec<RenderedFile>,
    tables: Tables,
}

/// Fills the tables of a target, renders its files and reads them back as `verify` would. A lattice is
/// given by the names of its axes (none: all) and the largest number of its nodes; what is filled goes on top
/// of what is installed.
fn made(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    (lattice, max_nodes): (&[String], usize),
    scope: Scope,
    limits: Limits,
    installed: Option<&Tables>,
) -> Result<Made, Stop> {
    if let Some(refusal) = target.refusal(machine) {
        return session.refuse(refusal);
    }
    let axes = lattice_axes(session, machine, lattice)?;
    let request = LatticeRequest { axes, max_nodes, scope };
    refuse_impossible_lattice(session, machine, target, &request)?;
    let tables = Arc::new(match installed {
        Some(installed) => target.tables_over(machine, &request, installed),
        None => target.tables(machine, &request),
    });
    warn_left_out(session, machine, target, &tables);
    let losses = installed.map(|old| target.resampling_losses(machine, &tables, old)).unwrap_or_default();
    losses.into_iter().for_each(|warning| session.diagnostics.push(warning));
    limits.exceeded(machine, &tables).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    target.violations(machine, &tables).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    session.checked()?;
    let rendered = target.render(machine, &tables, &mut session.diagnostics).ok_or(Stop::Refused)?;
    session.checked()?;
    let tables = read_back(session, machine, target, &rendered, &tables)?;
    Ok(Made { rendered, tables })
}

/// What rests on memory alone is written only for those who say that they know. A folder of one's own
/// needs no such word: who wrote its manifest knows.
fn refuse_unverified(session: &mut Session, target: &Target, accepted: bool) -> Outcome {
    let name = &target.manifest.target;
    if accepted || !target.manifest.unverified() || !NAMES.contains(&&**name) {
        return Ok(());
    }
    let message = format!("the format of `{name}` is known from memory only: {}", target.manifest.caution());
    let help = "`abbe explain TARGET` says what is sure; to write the files all the same: --accept-unverified";
    session.refuse(Diagnostic::new("E0710", message).help(help))
}

/// A lattice has two nodes on every axis at the least, and something to correct.
fn refuse_impossible_lattice(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    request: &LatticeRequest,
) -> Outcome {
    let free = target.manifest.mechanism.lattice.as_ref().filter(|rules| rules.inputs.is_empty());
    let Some(rules) = free else { return Ok(()) };
    let most = request.max_nodes.min(rules.max_points);
    let least = 2_usize.checked_pow(u32::try_from(request.axes.len()).unwrap_or(u32::MAX)).unwrap_or(usize::MAX);
    if least > most {
        let message = format!("a lattice over {} axes has more than {most} nodes at the least", request.axes.len());
        let help = "span it over fewer axes with --lattice X,Y,Z, or allow more with --nodes";
        return session.refuse(Diagnostic::new("E0603", message).help(help));
    }
    let linear = machine.axes().iter().any(|axis| axis.kind == AxisKind::Linear);
    let able = linear || (request.scope.rotary && rules.corrects_rotary);
    if !able {
        let message = "the machine has no linear axis to correct the position with";
        let help = "let the rotary axes correct: --with all, or --correct pose";
        return session.refuse(Diagnostic::new("E0603", message).help(help));
    }
    Ok(())
}

/// What does not go into the tables: points beyond the format's limit, travel beyond the volume.
fn warn_left_out(session: &mut Session, machine: &Machine, target: &Target, tables: &Tables) {
    if let Some(rules) = target.manifest.mechanism.own_axis.as_ref().filter(|rules| rules.fit == Fit::Axis) {
        for (axis, points) in resampled(machine, rules) {
            let (name, most) = (&machine.axes()[axis].name, rules.max_points);
            let message =
                format!("the curves of `{name}` have {points} points, the format holds {most}: they were resampled");
            let help = "thin the curve out yourself if certain points matter";
            session.diagnostics.push(Diagnostic::new("W0604", message).help(help));
        }
    }
    let free = target.manifest.mechanism.lattice.as_ref().is_some_and(|rules| rules.inputs.is_empty());
    let Some(lattice) = tables.tables.first().filter(|_| free) else { return };
    for axis in &lattice.axes {
        let (this, grid) = (&machine.axes()[*axis], machine.volume()[*axis]);
        let (min, max) = this.travel.interval();
        let within = grid.max - grid.min < (max - min) * (1.0 - 1e-9);
        if within {
            let message = format!(
                "the lattice covers `{}` from {} to {} {}, its travel is larger: outside the value at the end is held",
                this.name,
                grid.min,
                grid.max,
                this.unit()
            );
            let help = "leave the bounds out of `volume:` to cover the whole travel";
            session.diagnostics.push(Diagnostic::new("W0605", message).help(help));
        }
    }
}

/// Every file read so far, by name, with its hash.
pub(super) fn inputs(session: &Session) -> Vec<Hashed> {
    let sources = session.diagnostics.sources.iter();
    let plain = |name: &str| Path::new(name).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    sources.map(|(name, text)| Hashed::new(plain(name), text.as_bytes())).collect()
}

/// Reads the rendered bytes back as `verify` would, and insists that they are the tables we meant.
fn read_back(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    files: &[RenderedFile],
    meant: &Tables,
) -> Result<Tables, Stop> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let wanted = [target.table_files(machine), target.index_files()].concat();
    let texts: Vec<_> = files.iter().filter(|file| wanted.contains(&file.name)).map(text).collect();
    let read = target.read(machine, &texts, &mut session.diagnostics);
    session.checked()?;
    // Nothing to compensate may mean no files of tables.
    let tables = target.table_files(machine);
    let none = !files.iter().any(|file| tables.contains(&file.name));
    match read.or_else(|| none.then(Tables::default)) {
        Some(read) if read.same_effect(meant) => Ok(read),
        _ => session.refuse(
            Diagnostic::new(
                "E0707",
                format!("the files of target `{}` do not read back as what was to be written", target.manifest.target),
            )
            .help("its templates do not write what its manifest says; nothing was written"),
        ),
    }
}
