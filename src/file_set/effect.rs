//! ControllerEffect of a set of files on a machine: of one that `compile` would write, or of one found in a folder.

use super::composition::{self, Composition, compose_named};
use super::found_set::find_set;
use super::module_set::{self, ModuleRequest};
use super::options::CompensationOptions;
use super::table_set::{self, FoundTables, TableRequest};
use super::verdict;
use crate::controller::{
    Certificate, ControllerEffect, ControllerTarget, Depth, TablesUnderTest, certify, certify_kinematics,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;
use crate::run::{Call, Refused};
use std::path::Path;

/// Returns the effect of a target on a machine by the files that `compile` would write. Nothing is written.
fn render_effect(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    options: &CompensationOptions,
) -> Result<ControllerEffect, Refused> {
    if target.manifest.kinematics().is_some() {
        let set = module_set::render(call, machine, target, ModuleRequest::plain(options.orientation()))?;
        return Ok(ControllerEffect::Module(Box::new(set.module), set.beside));
    }
    let request = TableRequest::plain(options.scope());
    Ok(ControllerEffect::CorrectionTables(table_set::render(call, machine, target, &request, None)?.tables))
}

/// The files that `compile` would write for a target, or for two.
enum NamedSet {
    One(Box<ControllerTarget>, ControllerEffect),
    Both(Box<Composition>),
}

/// Returns those of a target by its name, or of two whose names are joined by a plus sign: kinematic parameters and
/// tables for what they leave.
fn named_set(
    call: &mut Call,
    machine: &Machine,
    name: &str,
    options: &CompensationOptions,
) -> Result<NamedSet, Refused> {
    let names: Vec<String> = name.split('+').map(str::to_owned).collect();
    if names.len() > 1 {
        return Ok(NamedSet::Both(Box::new(compose_named(call, machine, &names, options)?)));
    }
    let target = options.target(call, name)?;
    let effect = render_effect(call, machine, &target, options)?;
    Ok(NamedSet::One(Box::new(target), effect))
}

/// Returns the effect of a target by its name, or of two as `A+B`, without a certificate.
pub(crate) fn uncertified_effect(
    call: &mut Call,
    machine: &Machine,
    name: &str,
    options: &CompensationOptions,
) -> Result<(ControllerTarget, ControllerEffect), Refused> {
    Ok(match named_set(call, machine, name, options)? {
        NamedSet::One(target, effect) => (*target, effect),
        NamedSet::Both(set) => (set.both(), set.effect().0),
    })
}

/// Returns the same with the certificate.
pub(crate) fn named_effect(
    call: &mut Call,
    machine: &Machine,
    name: &str,
    options: &CompensationOptions,
    depth: Depth,
) -> Result<(ControllerTarget, ControllerEffect, Certificate), Refused> {
    if !cfg!(feature = "controllers") {
        let refusal = Diagnostic::new(codes::E0701, "this build of the library has no controllers");
        return call.refuse(refusal.help("ask the program: abbe map MACHINE --target NAME, or abbe workbench MACHINE"));
    }
    let (target, effect) = match named_set(call, machine, name, options)? {
        NamedSet::One(target, effect) => (*target, effect),
        NamedSet::Both(set) => {
            let (certificate, _) = set.certify(machine, depth, call)?;
            return Ok((set.both(), set.effect().0, certificate));
        }
    };
    let certificate = match &effect {
        ControllerEffect::Module(module, beside) => certify_kinematics(machine, &target, module, beside, depth),
        ControllerEffect::CorrectionTables(tables) => {
            let judged = TablesUnderTest { target: &target, tables, installed: None };
            certify(machine, judged, options.scope(), depth.poses, depth.seed)
        }
    };
    call.extend(verdict::warnings(&certificate));
    call.check()?;
    Ok((target, effect, certificate))
}

/// Returns the effect of the set in a folder, of whatever target it is.
pub(crate) fn effect_in(
    call: &mut Call,
    machine: &Machine,
    folder: &Path,
    options: &CompensationOptions,
) -> Result<(ControllerTarget, ControllerEffect), Refused> {
    if composition::is_composed(folder, call) {
        return composition::find_composed(call, machine, folder, options);
    }
    let set = find_set(call, machine, folder, None, options)?;
    call.check()?;
    if set.target.manifest.kinematics().is_none() {
        let FoundTables { target, tables, .. } = table_set::tables_of(call, machine, folder, set)?;
        return Ok((target, ControllerEffect::CorrectionTables(tables)));
    }
    let request = ModuleRequest::plain(set.options.orientation());
    let (module, beside) = module_set::find(call, machine, &set.target, folder, request, &set.files)?;
    Ok((set.target, ControllerEffect::Module(Box::new(module), beside)))
}
