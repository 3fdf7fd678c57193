//! `compile`: the files of a controller, with their certificate.

use super::certificate::{CertificateReport, CertificateScope, CertifiedWork};
use super::set_part::ComposedPart;
use crate::compensation::{CorrectionTables, ModuleContent};
use crate::controller::{
    Certificate, ControllerTarget, Depth, Level, Limits, Lock, Manifest, NAMES, RenderedFile, TablesUnderTest, certify,
    certify_kinematics,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::Field;
use crate::file_set::found_set;
use crate::file_set::module_set::{self, InForce, ModuleRequest};
use crate::file_set::options::CompensationOptions;
use crate::file_set::restore::{self, Restored};
use crate::file_set::table_set::{self, TableRequest};
use crate::file_set::verdict;
use crate::job::machine_file::{MachineFile, bounded_only};
use crate::run::{Call, Count, Hashed, Refused, Reply, Run};
use crate::syntax::read_text;
use std::path::PathBuf;
use std::sync::Arc;

/// Options of [`compile`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct CompileOptions {
    /// Name of the controller's folder, such as `linuxcnc`.
    pub target: String,
    /// Options of the compensation.
    pub compensation: CompensationOptions,
    /// Number of poses of the certificate.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// True if a format or a sign that is known from memory only may be written.
    pub accept_unverified: bool,
    /// Folder with the files that were in force when the machine was measured: the new files are old plus new.
    pub installed: Option<PathBuf>,
    /// Largest distance of an axis in force from that of the machine file, mm; 1 mm if none is stated.
    #[serde(rename = "max_change")]
    pub max_change_mm: Option<f64>,
    /// INI file of LinuxCNC: the pole zone of a generated module is chosen by the limits of its drives.
    pub ini: Option<PathBuf>,
    /// True if nothing else than kinematic parameters, or nothing but `installed`, corrects the machine: tables in
    /// `out` are not in force.
    pub nothing_else: bool,
    /// The folder that the files are for, which is searched for tables that kinematic parameters would add to.
    pub out: Option<PathBuf>,
    /// A job over which the certificate has figures besides those over the volume.
    #[serde(flatten)]
    pub work: CertifiedWork,
    /// Limits on corrections.
    pub max_correction: Limits,
    /// Names of the axes that span a lattice; all if empty. The others are at 0 in its nodes.
    pub lattice: Vec<String>,
    /// Maximum number of lattice nodes.
    pub max_nodes: usize,
}

impl Default for CompileOptions {
    fn default() -> Self {
        Self {
            target: String::new(),
            compensation: CompensationOptions::default(),
            poses: 2000,
            seed: 1,
            accept_unverified: false,
            installed: None,
            max_change_mm: None,
            ini: None,
            nothing_else: false,
            out: None,
            work: CertifiedWork::default(),
            max_correction: Limits::default(),
            lattice: Vec::new(),
            max_nodes: usize::MAX,
        }
    }
}

/// A set of files in memory, with its certificate.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct CompiledSet {
    /// The files, without the manifest.
    #[serde(skip)]
    pub files: Vec<RenderedFile>,
    /// The manifest of the set, to be written last as `abbe.lock.json`.
    #[serde(skip)]
    pub lock: Lock,
    /// The set that takes this one back, in a subfolder.
    #[serde(skip)]
    pub restore: Vec<ComposedPart>,
    /// Residual after the controller has applied the files.
    #[serde(flatten)]
    pub certificate: CertificateReport,
}

/// Compiles a machine to the files of a controller. The files are read back and replayed as the controller would;
/// nothing is written.
///
/// Fails if the target is unknown or has nothing for this machine, if a correction exceeds the limits, if the files do
/// not read back as the intended set, and if an option does not fit.
pub fn compile(file: &MachineFile, options: &CompileOptions, run: Run) -> Reply<CompiledSet> {
    let set_of = |call: &mut Call<'_>, file: &MachineFile| {
        call.check_counts(&[Count::Poses(options.poses)])?;
        call.extend(bounded_only(file));
        let target = options.compensation.target(call, &options.target)?;
        warn_inches(call, file, &target);
        refuse_unverified(call, &target, options.accept_unverified)?;
        let scope = options.scope(call, file)?;
        options.refuse_ini(call, &target)?;
        if let Some(mechanism) = target.manifest.kinematics() {
            if !mechanism.machines.is_empty() && !options.nothing_else {
                refuse_tables(call, file, options)?;
            }
            return module(call, file, &target, options, &scope);
        }
        tables(call, file, &target, options, &scope)
    };
    Call::answer(run, file.sources(), |call| options.work.job_paths().with_tool(call, file, set_of))
}

impl CompileOptions {
    pub(crate) fn in_force(&self) -> InForce<'_> {
        InForce { folder: self.installed.as_deref(), max_change_mm: self.max_change_mm }
    }

    /// Only a generated module has a zone that limits of drives decide.
    pub(crate) fn refuse_ini(&self, call: &mut Call<'_>, target: &ControllerTarget) -> Result<(), Refused> {
        let fits = target.manifest.kinematics().is_some_and(|of| of.carries == ModuleContent::FullModel);
        if self.ini.is_none() || fits {
            return Ok(());
        }
        let name = &target.manifest.target;
        call.usage(format!("--ini: `{name}` has no pole zone of its own; limits of drives are for linuxcnc-kins"))
    }

    fn ini_text(&self, call: &mut Call<'_>) -> Result<Option<Arc<str>>, Refused> {
        let Some(path) = &self.ini else { return Ok(None) };
        let read = read_text(path, None, call.run.files, &mut call.diagnostics);
        read.map(|(_, text)| Some(text)).ok_or(Refused)
    }

    /// Returns the poses by which the certificate judges.
    pub(crate) fn scope(&self, call: &mut Call<'_>, file: &MachineFile) -> Result<CertificateScope, Refused> {
        self.work.scope(call, file, Depth { poses: self.poses, seed: self.seed })
    }
}

fn tables(
    call: &mut Call,
    file: &MachineFile,
    target: &ControllerTarget,
    options: &CompileOptions,
    scope: &CertificateScope,
) -> Result<CompiledSet, Refused> {
    let how = &options.compensation;
    let installed = table_set::load_installed(call, file, target, how, options.installed.as_deref())?;
    let request = TableRequest {
        lattice: &options.lattice,
        max_nodes: options.max_nodes,
        scope: how.scope(),
        limits: options.max_correction,
    };
    let whole = CompensationOptions { without: Vec::new(), ..how.clone() };
    let mut whole = whole.target(call, &options.target)?;
    let mut target = target.clone();
    for target in [&mut target, &mut whole] {
        table_set::take_scales(call, file, target, installed.as_ref())?;
    }
    let over = installed.as_ref().map(|installed| (installed, &whole));
    let set = table_set::render(call, file, &target, &request, over)?;
    let target = over.map_or(&target, |(_, whole)| whole);
    let judged = TablesUnderTest { target, tables: &set.tables, installed: installed.as_ref() };
    let certificate = certify(file, judged, how.scope(), options.poses, options.seed);
    call.extend(verdict::warnings(&certificate));
    call.check()?;
    let restored = restore::of_tables(call, file, target, &set.tables, installed.as_ref())?;
    let mut compiled = assemble(file, target, how.words(), set.rendered, certificate, &judged.field(file), scope);
    compiled.add_restore(file, target, restored, installed.is_some());
    Ok(compiled)
}

fn module(
    call: &mut Call,
    file: &MachineFile,
    target: &ControllerTarget,
    options: &CompileOptions,
    scope: &CertificateScope,
) -> Result<CompiledSet, Refused> {
    let before = module_set::load_installed(call, file, target, &options.compensation, options.in_force())?;
    let orientation = options.compensation.orientation();
    let limits = options.max_correction;
    let ini = options.ini_text(call)?;
    let set = module_set::render(call, file, target, ModuleRequest { orientation, limits, before, ini })?;
    let certificate = certify_kinematics(file, target, &set.module, &set.beside, scope.depth);
    call.extend(limits.module_excesses(&certificate));
    call.extend(verdict::warnings(&certificate));
    call.check()?;
    let restored = restore::of_module(call, file, target, &set.module, &set.beside)?;
    let beside = |tables| TablesUnderTest { target, tables, installed: None };
    let field = beside(&set.beside).beside(file, &set.module);
    let mut words = options.compensation.module_words();
    words.extend(
        set.module.pole_zone_deg().filter(|_| options.ini.is_some()).map(|deg| format!("pole zone {deg:.4} deg")),
    );
    let mut compiled = assemble(file, target, words, set.rendered, certificate, &field, scope);
    let none = CorrectionTables::default();
    compiled.certificate = compiled.certificate.with_module(file, &set.module, beside(&none));
    compiled.add_restore(file, target, restored, options.installed.is_some());
    Ok(compiled)
}

impl CompiledSet {
    /// Adds the set that takes this one back.
    fn add_restore(
        &mut self,
        file: &MachineFile,
        target: &ControllerTarget,
        restored: Vec<RenderedFile>,
        installed: bool,
    ) {
        let part = ComposedPart::of_target(file, target, self.lock.options.clone(), restored);
        self.restore = vec![part.of_restore()];
        self.certificate.restore = Some(Restored::of(target, installed));
    }
}

fn assemble(
    file: &MachineFile,
    target: &ControllerTarget,
    words: Vec<String>,
    files: Vec<RenderedFile>,
    certificate: Certificate,
    field: &dyn Field,
    scope: &CertificateScope,
) -> CompiledSet {
    let hashes = files.iter().map(|file| Hashed::new(&file.name, &file.bytes)).collect();
    let lock = Lock::new(&target.manifest.target, file, words, file.inputs(), hashes);
    let names = files.iter().map(|file| file.name.clone()).collect();
    let certificate = CertificateReport::new(file, target, certificate, field, scope, names);
    CompiledSet { certificate, files, lock, restore: Vec::new() }
}

/// Warns of a machine that counts in inches: a controller's files have mm.
fn warn_inches(call: &mut Call, file: &MachineFile, target: &ControllerTarget) {
    let Manifest { target: name, certainty, .. } = &target.manifest;
    if file.in_inches && certainty.syntax.level != Level::OwnFormat {
        let message = format!("the machine file has travels in inches, and the numbers in files of `{name}` are mm");
        let help = "load them only where the control counts in mm: in inches it would move 25.4 times as far";
        call.warn(Diagnostic::new(codes::W0719, message).help(help));
    }
}

/// Kinematic parameters on top of tables for the same errors would correct them twice.
fn refuse_tables(call: &mut Call, file: &MachineFile, options: &CompileOptions) -> Result<(), Refused> {
    let Some(out) = &options.out else { return Ok(()) };
    let Some(tables) = found_set::tables_there(call, file, out, &options.compensation)? else { return Ok(()) };
    let name = &options.target;
    let message = format!(
        "`{}` holds tables of `{tables}`: if they are in force, `{name}` would correct their location errors again",
        out.display()
    );
    let help = format!(
        "compile both: --target {name} --target {tables} --installed DIR; if they are not in force: --nothing-else"
    );
    call.refuse(Diagnostic::new(codes::E0754, message).help(help))
}

/// A format that rests on memory alone is written only for those who accept it. A folder of one's own needs no such
/// option: who wrote its manifest knows.
pub(crate) fn refuse_unverified(call: &mut Call, target: &ControllerTarget, accepted: bool) -> Result<(), Refused> {
    let name = &target.manifest.target;
    if accepted || !target.manifest.rests_on_memory() || !NAMES.contains(&&**name) {
        return Ok(());
    }
    let message = format!("the format of `{name}` is known from memory only: {}", target.manifest.caution());
    let help = "`abbe explain TARGET` states what is sure; to write the files all the same: --accept-unverified";
    call.refuse(Diagnostic::new(codes::E0710, message).help(help))
}
