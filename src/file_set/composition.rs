//! Sets of two targets on one controller: kinematic parameters, and tables for what they leave. A subfolder for each
//! target, one manifest over both.

use super::differences::{warn_edited, warn_other_inputs, warn_other_tool};
use super::folder::Folder;
use super::module_set::{self, InForce, ModuleRequest};
use super::options::CompensationOptions;
use super::table_set::{self, TableRequest};
use super::{found_set, verdict};
use crate::compensation::{CorrectionTables, Scope};
use crate::controller::{
    Certificate, ControllerEffect, ControllerTarget, Depth, Figures, KinematicsModule, LOCK_NAME, Limits, Lock, NAMES,
    Parameters, RenderedFile, TablesUnderTest, certify_sets,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::job::machine_file::MachineFile;
use crate::machine::Machine;
use crate::run::{Call, Refused, sha256};
use std::path::Path;

/// Both parts as the controller reads them.
pub(crate) struct Composition {
    pub target: ControllerTarget,
    pub parameters: Parameters,
    pub tables_target: ControllerTarget,
    /// The machine that the tables are for: its nominal geometry is that of the parameters.
    pub rest: Machine,
    pub tables: CorrectionTables,
    /// The tables that were in force when the machine was measured.
    pub before: Option<CorrectionTables>,
    /// Goal of the tables, and the axes that correct.
    scope: Scope,
    /// Names of the files, with their subfolders.
    pub files: Vec<String>,
}

/// What a composed set is compiled by.
#[derive(Clone, Copy)]
pub(crate) struct ComposedRequest<'a> {
    pub compensation: &'a CompensationOptions,
    /// The files that were in force when the machine was measured.
    pub in_force: InForce<'a>,
    pub max_correction: Limits,
    /// Names of the axes that span a lattice; all if empty.
    pub lattice: &'a [String],
    /// Maximum number of lattice nodes.
    pub max_nodes: usize,
}

/// Returns the parameters and the tables for what they leave, as the controller reads them, and the files of both.
pub(crate) fn compose(
    call: &mut Call,
    machine: &Machine,
    target: ControllerTarget,
    mut tables_target: ControllerTarget,
    request: ComposedRequest<'_>,
) -> Result<(Composition, [Vec<RenderedFile>; 2]), Refused> {
    let how = request.compensation;
    let installed = load_installed(call, machine, &target, &tables_target, how, request.in_force)?;
    let (before, installed) = installed.unzip();
    let of_module = ModuleRequest { limits: request.max_correction, before, ..ModuleRequest::plain(how.orientation()) };
    let module = module_set::render(call, machine, &target, of_module)?;
    let Some(parameters) = module.module.parameters().cloned() else { return Err(Refused) };
    let rest = remaining(call, machine, &parameters)?;
    let of_tables = TableRequest {
        lattice: request.lattice,
        max_nodes: request.max_nodes,
        scope: how.scope(),
        limits: request.max_correction,
    };
    let whole = everything(how).target(call, &tables_target.manifest.target)?;
    let over = installed.as_ref().map(|installed| (installed, &whole));
    let rendered = table_set::render(call, &rest, &tables_target, &of_tables, over)?;
    if over.is_some() {
        tables_target = whole;
    }
    let names = |target: &ControllerTarget, files: &[RenderedFile]| {
        files.iter().map(|file| format!("{}/{}", target.manifest.target, file.name)).collect::<Vec<_>>()
    };
    let files = [names(&target, &module.rendered), names(&tables_target, &rendered.rendered)].concat();
    let tables = rendered.tables;
    let scope = how.scope();
    let composition = Composition { target, parameters, tables_target, rest, tables, before: installed, files, scope };
    Ok((composition, [module.rendered, rendered.rendered]))
}

/// Composes two targets as `compile` does without further options.
pub(super) fn compose_named(
    call: &mut Call,
    machine: &Machine,
    targets: &[String],
    options: &CompensationOptions,
) -> Result<Composition, Refused> {
    let targets = split(call, targets, options)?;
    let request = ComposedRequest {
        compensation: options,
        in_force: InForce::default(),
        max_correction: Limits::default(),
        lattice: &[],
        max_nodes: usize::MAX,
    };
    Ok(compose(call, machine, targets.0, targets.1, request)?.0)
}

/// The word by which tables name the parameters that they are beside.
pub(crate) fn beside(lock: &Lock) -> String {
    let hashes: Vec<&str> = lock.files.iter().map(|file| file.sha256.as_str()).collect();
    format!("{BESIDE}{} {}", lock.target, sha256(hashes.concat().as_bytes()))
}

const BESIDE: &str = "beside ";

/// True if tables are for what kinematic parameters leave.
pub(crate) fn is_beside(lock: &Lock) -> bool {
    lock.options.iter().any(|option| option.starts_with(BESIDE))
}

/// The target of kinematic parameters and that of tables, in whatever order they are named.
pub(crate) fn split(
    call: &mut Call,
    names: &[String],
    options: &CompensationOptions,
) -> Result<(ControllerTarget, ControllerTarget), Refused> {
    let plain = CompensationOptions { templates: options.templates.clone(), ..CompensationOptions::default() };
    let mut found = Vec::new();
    for name in names {
        found.push(plain.target(call, name)?);
    }
    let (mut parameters, mut tables) = (Vec::new(), Vec::new());
    for target in found {
        match of_parameters(&target) {
            Some(true) => parameters.push(target),
            None => tables.push(target),
            Some(false) => {
                let message = format!("`{}` replaces the controller's kinematics", target.manifest.target);
                let help = "a kinematics module is compiled alone; it holds what tables would";
                return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
            }
        }
    }
    if let ([target], [beside]) = (&parameters[..], &tables[..]) {
        // The options are the tables'.
        let beside = options.target(call, &beside.manifest.target)?;
        return Ok((target.clone(), beside));
    }
    let message = format!("{} would correct the same errors twice", names.join(" and "));
    let help = "name one target of kinematic parameters, such as sinumerik-traori, and one of tables for what they \
                leave, such as sinumerik-cec";
    call.refuse(Diagnostic::new(codes::E0711, message).help(help))
}

/// True if a target writes kinematic parameters, false if it replaces the kinematics, `None` if it writes tables.
fn of_parameters(target: &ControllerTarget) -> Option<bool> {
    target.manifest.kinematics().map(|own| !own.machines.is_empty())
}

/// Returns the built-in targets of one control that go together: parameters and tables. Names of targets begin with
/// that of the control.
pub(crate) fn pairs() -> Vec<[&'static str; 2]> {
    let control = |name: &'static str| name.split_once('-').map_or(name, |(control, _)| control);
    let kinds: Vec<(&str, Option<bool>)> =
        NAMES.iter().filter_map(|name| Some((*name, of_parameters(&ControllerTarget::builtin(name)?)))).collect();
    let of_kind = |kind: Option<bool>| kinds.iter().filter(move |of| of.1 == kind).map(|of| of.0);
    let beside = |first| of_kind(None).filter(move |of| control(of) == control(first)).map(move |of| [first, of]);
    of_kind(Some(true)).flat_map(beside).collect()
}

/// The machine that parameters leave to tables.
fn remaining(call: &mut Call, machine: &Machine, parameters: &Parameters) -> Result<Machine, Refused> {
    match parameters.remaining(machine) {
        Ok(rest) => Ok(rest),
        Err(refusal) => call.refuse(refusal),
    }
}

fn join(first: &ControllerTarget, second: &ControllerTarget) -> String {
    format!("{}+{}", first.manifest.target, second.manifest.target)
}

/// The targets of the composed set in a folder: parameters, then tables.
pub(crate) fn targets(
    call: &mut Call,
    path: &Path,
    options: &CompensationOptions,
) -> Result<(ControllerTarget, ControllerTarget), Refused> {
    let lock = Folder::new(path, call.run.files).lock();
    let names: Vec<String> = lock.iter().flat_map(|lock| &lock.parts).map(|part| part.name.clone()).collect();
    split(call, &names, options)
}

impl Composition {
    pub(crate) fn name(&self) -> String {
        join(&self.target, &self.tables_target)
    }

    /// Both targets as one: what neither can correct, and the sign tests of both.
    pub(crate) fn both(&self) -> ControllerTarget {
        let (first, second) = (&self.target.manifest, &self.tables_target.manifest);
        let mut both = self.tables_target.clone();
        both.manifest.target = self.name();
        both.manifest.title = format!("{}; {}", first.title, second.title);
        both.manifest.sign_test =
            format!("{}: {} {}: {}", first.target, first.sign_test.trim(), second.target, second.sign_test.trim());
        both.manifest.trial = first.trial.clone();
        both
    }

    pub(crate) fn tables_under_test(&self) -> TablesUnderTest<'_> {
        TablesUnderTest { target: &self.tables_target, tables: &self.tables, installed: self.before.as_ref() }
    }

    /// Certifies both together. Returns the figures after the parameters alone beside the certificate.
    pub(crate) fn certify(
        &self,
        machine: &Machine,
        depth: Depth,
        call: &mut Call,
    ) -> Result<(Certificate, Figures), Refused> {
        let sets = ((&self.target, &self.parameters), self.tables_under_test());
        let found = certify_sets(machine, &self.rest, sets, self.scope, depth);
        call.extend(verdict::warnings(&found.0));
        call.check()?;
        Ok(found)
    }

    /// Warns of files that are no longer as the manifests state them, and of another machine or tool than theirs.
    pub(crate) fn warn(&self, call: &mut Call, file: &MachineFile, path: &Path) {
        let above = Folder::new(path, call.run.files).lock();
        warn_other_inputs(call, file, above.as_ref());
        warn_other_tool(call, file, &self.tables_target, above.as_ref());
        for target in [&self.target, &self.tables_target] {
            let name = &target.manifest.target;
            let folder_path = path.join(name);
            let folder = Folder::new(&folder_path, call.run.files);
            let own = folder.lock();
            warn_edited(call, &folder, own.as_ref());
            let listed = above.iter().flat_map(|lock| &lock.parts).find(|part| part.name == *name);
            let same = |own: &Lock| listed.is_some_and(|part| part.sha256 == sha256(own.to_text().as_bytes()));
            if own.is_some_and(|own| !same(&own)) {
                let message = format!("`{}` holds another set than the manifest above it lists", folder_path.display());
                call.warn(Diagnostic::new(codes::W0701, message).help("compile both together again"));
            }
        }
    }

    /// The effect of both, and the target whose tables it has.
    pub(super) fn effect(&self) -> (ControllerEffect, ControllerTarget) {
        let module = KinematicsModule::KinematicParameters(self.parameters.clone());
        (ControllerEffect::Module(Box::new(module), self.tables.clone()), self.tables_target.clone())
    }
}

pub(crate) fn is_composed(folder: &Path, call: &Call) -> bool {
    Folder::new(folder, call.run.files).lock().is_some_and(|lock| !lock.parts.is_empty())
}

/// What is in force is there, whatever new tables are to be without.
fn everything(options: &CompensationOptions) -> CompensationOptions {
    CompensationOptions { without: Vec::new(), ..options.clone() }
}

/// The parameters and the tables that were in force when the machine was measured.
pub(crate) fn load_installed(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    tables_target: &ControllerTarget,
    options: &CompensationOptions,
    in_force: InForce<'_>,
) -> Result<Option<(Vec<f64>, CorrectionTables)>, Refused> {
    let Some(folder) = in_force.folder else { return Ok(None) };
    let shown = folder.display().to_string();
    if !is_composed(folder, call) {
        let message = format!("`{shown}` holds no set of two targets");
        let help = "name the folder above the subfolders of both; what only one of them had is compiled with that one";
        return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    let old = call.about(&shown, |call| find(call, machine, folder, &everything(options), None, None))?;
    let (before, now) = (old.name(), join(target, tables_target));
    if before != now {
        let message = format!("the files in `{shown}` are of `{before}`, not of `{now}`");
        let help = "only sets of the same targets can be written on top of each other";
        return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    let module = KinematicsModule::KinematicParameters(old.parameters.clone());
    module_set::judge(call, machine, target, &module, old.parameters.values(), in_force)?;
    Ok(Some((old.parameters.values().to_vec(), old.tables)))
}

/// Reads both parts of the composed set in a folder.
pub(crate) fn find(
    call: &mut Call,
    machine: &Machine,
    path: &Path,
    options: &CompensationOptions,
    before: Option<Vec<f64>>,
    old_tables: Option<CorrectionTables>,
) -> Result<Composition, Refused> {
    let (target, tables_target) = targets(call, path, options)?;
    let (of_first, of_second) = (path.join(&target.manifest.target), path.join(&tables_target.manifest.target));
    let locks = [&of_first, &of_second].map(|folder| Folder::new(folder, call.run.files).lock());
    if let [Some(first), Some(second)] = &locks
        && !second.options.contains(&beside(first))
    {
        let message = format!(
            "the tables in `{}` are not for what the parameters in `{}` leave: the same errors would be corrected \
             twice, or not at all",
            of_second.display(),
            of_first.display()
        );
        let help = format!(
            "compile both together, or judge one of the subfolders alone; {LOCK_NAME} of the tables \
                            names the parameters that they are beside"
        );
        return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    let named = Some(target.manifest.target.as_str());
    let set = found_set::find_set(call, machine, &of_first, named, options)?;
    let of_parameters: Vec<String> =
        set.files.iter().map(|file| format!("{}/{}", target.manifest.target, file.found)).collect();
    let request = ModuleRequest { before, ..ModuleRequest::plain(set.options.orientation()) };
    let (module, _) = module_set::find(call, machine, &target, &of_first, request, &set.files)?;
    let Some(parameters) = module.parameters().cloned() else { return Err(Refused) };
    let rest = remaining(call, machine, &parameters)?;
    let named = Some(tables_target.manifest.target.as_str());
    let set = found_set::find_set(call, &rest, &of_second, named, options)?;
    let scope = set.options.scope();
    let found = table_set::tables_of(call, &rest, &of_second, set)?;
    call.check()?;
    let of_tables = found.files.iter().map(|file| format!("{}/{file}", tables_target.manifest.target));
    let files = of_parameters.into_iter().chain(of_tables).collect();
    Ok(Composition { target, parameters, tables_target, rest, tables: found.tables, before: old_tables, files, scope })
}

/// The effect of the composed set in a folder, and the target whose tables it has.
pub(crate) fn find_composed(
    call: &mut Call,
    machine: &Machine,
    folder: &Path,
    options: &CompensationOptions,
) -> Result<(ControllerTarget, ControllerEffect), Refused> {
    let (effect, target) = find(call, machine, folder, options, None, None)?.effect();
    Ok((target, effect))
}
