//! Sets of two targets on one controller: kinematic parameters, and tables for what they leave. A subfolder for each
//! target, one manifest over both.

use super::certificate::{CertificateReport, CertificateScope, CertificateStep, figures_without_unheld};
use super::compile::{CompileOptions, refuse_unverified};
use super::second::SecondOptions;
use super::set_part::ComposedPart;
use crate::compensation::CorrectionTables;
use crate::controller::{KinematicsModule, Lock, ModuleField, RenderedFile};
use crate::file_set::composition::{self, ComposedRequest, Composition, beside, compose, find, split, targets};
use crate::file_set::module_set::InForce;
use crate::file_set::options::CompensationOptions;
use crate::file_set::restore::{self, Restored};
use crate::file_set::verdict;
use crate::job::machine_file::{MachineFile, bounded_only};
use crate::machine::{Machine, OperatingPoint};
use crate::run::{Call, Count, Hashed, Refused, Reply, Run};
use std::path::Path;

/// A set of two targets in memory, with its certificate.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ComposedSet {
    /// The parts, kinematic parameters first.
    #[serde(skip)]
    pub parts: Vec<ComposedPart>,
    /// The manifest over both, to be written last as `abbe.lock.json`.
    #[serde(skip)]
    pub lock: Lock,
    /// The set that takes this one back, with its parts first.
    #[serde(skip)]
    pub restore: Vec<ComposedPart>,
    /// Residual after the controller has applied both.
    #[serde(flatten)]
    pub certificate: CertificateReport,
}

/// Compiles a machine to kinematic parameters and to tables for what they leave.
///
/// Fails like [`compile`](super::compile()), and if the targets are not one of kinematic parameters and one of tables:
/// two sets for the same errors would correct them twice.
pub fn compile_composed(
    file: &MachineFile,
    targets: &[String],
    options: &CompileOptions,
    run: Run,
) -> Reply<ComposedSet> {
    Call::answer(run, file.sources(), |call| {
        call.check_counts(&[Count::Poses(options.poses)])?;
        call.extend(bounded_only(file));
        let how = &options.compensation;
        let targets = split(call, targets, how)?;
        refuse_unverified(call, &targets.0, options.accept_unverified)?;
        refuse_unverified(call, &targets.1, options.accept_unverified)?;
        let scope = options.scope(call, file)?;
        options.refuse_ini(call, &targets.0)?;
        let request = ComposedRequest {
            compensation: how,
            in_force: options.in_force(),
            max_correction: options.max_correction,
            lattice: &options.lattice,
            max_nodes: options.max_nodes,
        };
        let (composition, [of_first, of_second]) = compose(call, file, targets.0, targets.1, request)?;
        let mut certificate = certificate(call, &composition, file, &scope)?;
        certificate.restore = Some(Restored::of(&composition.target, options.installed.is_some()));
        let (parts, lock) = in_parts(file, &composition, how, [of_first, of_second]);
        let restore = restore(call, file, &composition, how)?;
        Ok(ComposedSet { parts, lock, restore, certificate })
    })
}

/// Returns the sets of both targets, and the manifest over them.
fn in_parts(
    file: &MachineFile,
    composition: &Composition,
    how: &CompensationOptions,
    [of_first, of_second]: [Vec<RenderedFile>; 2],
) -> (Vec<ComposedPart>, Lock) {
    let first = ComposedPart::of_target(file, &composition.target, how.module_words(), of_first);
    let beside = [how.words(), vec![beside(&first.lock)]].concat();
    let second = ComposedPart::of_target(file, &composition.tables_target, beside, of_second);
    let parts = vec![first, second];
    let hashed = |part: &ComposedPart| Hashed::new(part.folder.clone(), part.lock.to_text().as_bytes());
    let mut lock = Lock::new(&composition.name(), file, how.words(), file.inputs(), Vec::new());
    lock.parts = parts.iter().map(hashed).collect();
    (parts, lock)
}

/// Returns the set that takes a composed set back: both parts, then the manifest over them.
fn restore(
    call: &mut Call,
    file: &MachineFile,
    composition: &Composition,
    how: &CompensationOptions,
) -> Result<Vec<ComposedPart>, Refused> {
    let Composition { target, parameters, tables_target, tables, before, .. } = composition;
    let module = KinematicsModule::KinematicParameters(parameters.clone());
    let first = restore::of_module(call, file, target, &module, &CorrectionTables::default())?;
    let second = restore::of_tables(call, file, tables_target, tables, before.as_ref())?;
    let (parts, lock) = in_parts(file, composition, how, [first, second]);
    let above = ComposedPart { folder: String::new(), files: Vec::new(), lock }.of_restore();
    Ok(parts.into_iter().map(ComposedPart::below_restore).chain([above]).collect())
}

/// The certificate of both, with its steps.
fn certificate(
    call: &mut Call,
    composition: &Composition,
    file: &MachineFile,
    scope: &CertificateScope,
) -> Result<CertificateReport, Refused> {
    let (certificate, first) = composition.certify(file, scope.depth, call)?;
    let tables = composition.tables_under_test();
    let module = KinematicsModule::KinematicParameters(composition.parameters.clone());
    let (both, field) = (composition.both(), tables.beside(file, &module));
    let report = CertificateReport::new(file, &both, certificate, &field, scope, composition.files.clone());
    let mut report = report.with_module(file, &module, tables);
    let alone = ModuleField::new(file, &module);
    let first = figures_without_unheld(file, &alone, scope).unwrap_or(first);
    call.extend(verdict::worse_together(&first, &report.compensated));
    let step = |target: String, compensated| CertificateStep { target, compensated };
    report.steps =
        vec![step(composition.target.manifest.target.clone(), first), step(both.manifest.target, report.compensated)];
    Ok(report)
}

pub(super) fn verify_composed(
    call: &mut Call,
    file: &MachineFile,
    folder: &Path,
    how: &CompensationOptions,
    in_force: InForce<'_>,
    scope: &CertificateScope,
    second: &SecondOptions,
) -> Result<CertificateReport, Refused> {
    let (target, tables_target) = targets(call, folder, how)?;
    let before = composition::load_installed(call, file, &target, &tables_target, how, in_force)?;
    let (before, old_tables) = before.unzip();
    let composition = find(call, file, folder, how, before, old_tables)?;
    composition.warn(call, file, folder);
    let mut report = certificate(call, &composition, file, scope)?;
    let tables = composition.tables_under_test();
    let module = KinematicsModule::KinematicParameters(composition.parameters.clone());
    let added = |machine: &Machine, at: &OperatingPoint<'_>| tables.beside(machine, &module).addition(at);
    report.second = second.judge(call, file, scope.depth.seed, &added)?;
    Ok(report)
}
