//! `verify`: files replayed as the controller would, and the residual.

use super::certificate::{CertificateReport, CertificateScope, CertifiedWork};
use super::compose;
use super::second::SecondOptions;
use crate::controller::{ControllerEffect, Depth, Lock, ReadBack, TablesUnderTest, certify, certify_kinematics};
use crate::diagnostic::{Diagnostic, codes};
use crate::file_set::differences::{warn_edited, warn_other_inputs, warn_other_tool};
use crate::file_set::folder::Folder;
use crate::file_set::found_set::{FoundSet, find_set};
use crate::file_set::module_set::{self, InForce, ModuleRequest};
use crate::file_set::options::CompensationOptions;
use crate::file_set::table_set::{self, FoundTables};
use crate::file_set::{composition, verdict};
use crate::job::machine_file::MachineFile;
use crate::machine::{Machine, OperatingPoint};
use crate::run::{Call, Count, Refused, Reply, Run};
use std::path::{Path, PathBuf};

/// Options of [`verify`] and [`replay`](super::replay()).
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct VerifyOptions {
    /// Name of the controller; by default the one that the folder's manifest or its files name.
    pub target: Option<String>,
    /// Options of the compensation.
    pub compensation: CompensationOptions,
    /// Number of poses of the certificate.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// Folder with the files that were in force when the machine was measured: the files judged here replace them.
    pub installed: Option<PathBuf>,
    /// Largest distance of an axis in force from that of the machine file, mm; 1 mm if none is stated.
    #[serde(rename = "max_change")]
    pub max_change_mm: Option<f64>,
    /// A job over which the certificate has figures besides those over the volume.
    #[serde(flatten)]
    pub work: CertifiedWork,
    /// Readings of the machine that was driven with the set.
    #[serde(flatten)]
    pub second: SecondOptions,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        let (compensation, work) = (CompensationOptions::default(), CertifiedWork::default());
        let second = SecondOptions::default();
        Self { target: None, compensation, poses: 2000, seed: 1, installed: None, max_change_mm: None, work, second }
    }
}

impl VerifyOptions {
    fn in_force(&self) -> InForce<'_> {
        InForce { folder: self.installed.as_deref(), max_change_mm: self.max_change_mm }
    }
}

/// Returns the manifest of the set in a folder; `None` if there is none that abbe wrote.
pub fn set_manifest(folder: &Path, run: Run) -> Option<Lock> {
    Folder::new(folder, run.files).lock()
}

/// Reads the files in a folder back, replays them as the controller would, and returns the residual.
///
/// Fails if the folder holds no set of a known target, or one that the controller would misread.
pub fn verify(file: &MachineFile, folder: &Path, options: &VerifyOptions, run: Run) -> Reply<CertificateReport> {
    let report_of = |call: &mut Call<'_>, file: &MachineFile| {
        call.check_counts(&[Count::Poses(options.poses)])?;
        let scope = options.work.scope(call, file, Depth { poses: options.poses, seed: options.seed })?;
        if composition::is_composed(folder, call) {
            let (how, in_force) = (&options.compensation, options.in_force());
            return compose::verify_composed(call, file, folder, how, in_force, &scope, &options.second);
        }
        let set = open(call, file, folder, options)?;
        if set.target.manifest.kinematics().is_some() {
            return module(call, file, folder, &set, options, &scope);
        }
        let how = set.options.clone();
        let (found, installed) = tables(call, file, folder, set, options)?;
        let FoundTables { target, tables, files } = found;
        let judged = TablesUnderTest { target: &target, tables: &tables, installed: installed.as_ref() };
        let certificate = certify(file, judged, how.scope(), options.poses, options.seed);
        call.extend(verdict::warnings(&certificate));
        call.check()?;
        let mut report = CertificateReport::new(file, &target, certificate, &judged.field(file), &scope, files);
        let added = |machine: &Machine, at: &OperatingPoint<'_>| judged.field(machine).replay.addition(at);
        report.second = options.second.judge(call, file, scope.depth.seed, &added)?;
        Ok(report)
    };
    Call::answer(run, file.sources(), |call| options.work.job_paths().with_tool(call, file, report_of))
}

/// Finds the set in the folder, and warns of differences from its manifest.
pub(crate) fn open(
    call: &mut Call,
    file: &MachineFile,
    path: &Path,
    options: &VerifyOptions,
) -> Result<FoundSet, Refused> {
    let folder = Folder::new(path, call.run.files);
    let lock = folder.lock();
    if lock.as_ref().is_some_and(composition::is_beside) {
        let message = format!("the tables in `{}` are for what kinematic parameters beside them leave", path.display());
        let help = "name the folder above, whose manifest lists both";
        return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    warn_other_inputs(call, file, lock.as_ref());
    let set = find_set(call, file, path, options.target.as_deref(), &options.compensation)?;
    call.check()?;
    warn_edited(call, &folder, lock.as_ref());
    if set.target.manifest.kinematics().is_none() {
        warn_other_tool(call, file, &set.target, lock.as_ref());
    }
    Ok(set)
}

/// Reads the tables of a set, and those that were installed before.
pub(crate) fn tables(
    call: &mut Call,
    file: &MachineFile,
    folder: &Path,
    set: FoundSet,
    options: &VerifyOptions,
) -> Result<(FoundTables, Option<crate::compensation::CorrectionTables>), Refused> {
    let found = table_set::tables_of(call, file, folder, set)?;
    let installed =
        table_set::load_installed(call, file, &found.target, &options.compensation, options.installed.as_deref())?;
    call.check()?;
    Ok((found, installed))
}

fn module(
    call: &mut Call,
    file: &MachineFile,
    folder: &Path,
    set: &FoundSet,
    options: &VerifyOptions,
    scope: &CertificateScope,
) -> Result<CertificateReport, Refused> {
    let (target, texts) = (&set.target, &set.files);
    let how = &set.options;
    let before = module_set::load_installed(call, file, target, how, options.in_force())?;
    let request = ModuleRequest { before, ..ModuleRequest::plain(how.orientation()) };
    let (module, beside) = module_set::find(call, file, target, folder, request, texts)?;
    let certificate = certify_kinematics(file, target, &module, &beside, scope.depth);
    call.extend(verdict::warnings(&certificate));
    call.check()?;
    let code = target.code_files();
    let names = texts.iter().filter(|text| !code.contains(&text.name)).map(|text: &ReadBack| text.found.clone());
    let names = names.collect();
    let (alone, none) = (module.clone(), crate::compensation::CorrectionTables::default());
    let tables = TablesUnderTest { target, tables: &none, installed: None };
    let effect = ControllerEffect::Module(Box::new(module), beside);
    let report = CertificateReport::new(file, target, certificate, &*effect.field(file, target), scope, names);
    let added = |machine: &Machine, at: &OperatingPoint<'_>| effect.addition(machine, target)(at);
    let mut report = report.with_module(file, &alone, tables);
    report.second = options.second.judge(call, file, scope.depth.seed, &added)?;
    Ok(report)
}
