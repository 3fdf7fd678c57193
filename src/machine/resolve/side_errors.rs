//! Errors that hold on one side of the bed: `on_tool: { errors }`, `on_workpiece: { errors }`. They replace those of
//! the same name under `errors`; curves cover the travel of their side.

use super::axes::{AxisDraft, block_entry};
use super::context::{Context, dotted_path};
use super::errors::{ErrorScope, once, plain, put_term};
use super::found_errors::Errors;
use super::joint_names::{JointNames, find_error};
use super::positions::block_key;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{AxisName, Branch, ErrorId, JointErrors, Sides};
use crate::syntax::{below, keys};
use std::collections::{BTreeMap, BTreeSet};

/// Returns all error terms of the file and its tables, of each axis for the side on which it stands; beside them those
/// of axes that differ on the other side.
pub fn errors(context: &mut Context, known: &JointNames<'_>, sides: &Sides) -> Errors {
    let blocks = Branch::BOTH.map(|branch| blocks(context, known, branch));
    let block = |branch: Branch| &blocks[usize::from(branch == Branch::Workpiece)];
    let of = |axis: &AxisName, other: bool| {
        let own = sides.get(axis).copied().unwrap_or(Branch::Workpiece);
        if other { own.opposite() } else { own }
    };
    let replaced = |other: bool| -> BTreeSet<ErrorId> {
        let on_side = |branch: Branch| block(branch).places.keys().filter(move |e| of(&e.axis, other) == branch);
        Branch::BOTH.into_iter().flat_map(on_side).cloned().collect()
    };
    let mut errors = plain(context, known, &ErrorScope { replaced: &replaced(false), axes: None });
    spelled_alike(context, known, &blocks);
    let differing: BTreeSet<AxisName> = known
        .declared
        .iter()
        .filter(|axis| {
            let travels = Branch::BOTH.map(|branch| axis.on(branch).travel);
            let replaces = |of: &Errors| of.places.keys().any(|error| error.axis == axis.name);
            travels[0] != travels[1] || blocks.iter().any(replaces)
        })
        .map(|axis| axis.name.clone())
        .collect();
    if !differing.is_empty() {
        let found = context.diagnostics.count();
        let standing = |axis: &AxisDraft| axis.standing_on(of(&axis.name, true));
        let declared: Vec<AxisDraft> = known.declared.iter().map(standing).collect();
        let there = JointNames { declared: &declared, spindle: known.spindle };
        let scope = ErrorScope { replaced: &replaced(true), axes: Some(&differing) };
        let mut other = plain(context, &there, &scope);
        context.diagnostics.forget_repeats(found);
        differing.iter().for_each(|axis| other.take(block(of(axis, true)), axis));
        differing.iter().for_each(|axis| errors.take(block(of(axis, false)), axis));
        for axis in differing {
            let joint = other.joints.remove(&axis).unwrap_or_default();
            if errors.joints.get(&axis).unwrap_or(&JointErrors::default()) != &joint {
                let branch = of(&axis, true);
                let _ = errors.other_side.insert(axis, (branch, joint));
            }
        }
    }
    errors
}

impl Errors {
    fn take(&mut self, block: &Errors, axis: &AxisName) {
        for (error, place) in block.places.iter().filter(|(error, _)| error.axis == *axis) {
            let joint = block.joints.get(axis);
            let term = joint.and_then(|joint| joint.six(error.family)[error.direction.index()].clone());
            self.put(error, term);
            self.places.insert(error.clone(), place.clone());
            self.uncertainty.remove(error);
        }
        let uncertainty = block.uncertainty.iter().filter(|(error, _)| error.axis == *axis);
        self.uncertainty.extend(uncertainty.map(|(error, value)| (error.clone(), *value)));
    }
}

fn blocks(context: &mut Context, known: &JointNames<'_>, branch: Branch) -> Errors {
    let document = context.document;
    let declared: Vec<AxisDraft> = known.declared.iter().map(|axis| axis.standing_on(branch)).collect();
    let there = JointNames { declared: &declared, spindle: known.spindle };
    let mut errors = Errors::default();
    for axis in known.declared {
        let name = axis.name.as_str();
        let entry = document.axes.get(name).and_then(Option::as_ref).and_then(|entry| block_entry(entry, branch));
        for (written, entry) in entry.iter().flat_map(|block| &block.errors) {
            let at = keys(["axes", name, block_key(branch), "errors", written]);
            let place = document.places.key(&at);
            let Some(spelling) = find_error(context, written, &there, place.clone()) else { continue };
            if spelling.error.axis != axis.name {
                let message = format!("`{}` is not an error of axis `{name}`", spelling.error);
                let help = format!("a block of axis `{name}` holds its own errors; move it to the axis it belongs to");
                context.at_key(codes::E0415, &at, message, help);
            } else if once(context, &mut errors, &spelling.error, place) {
                put_term(context, &mut errors, &spelling, entry, &there, &at);
            }
        }
    }
    errors
}

/// A variant displaces an error of its base by the same spelling; under another one, which of them holds would be a
/// matter of order.
fn spelled_alike(context: &mut Context, known: &JointNames<'_>, blocks: &[Errors; 2]) {
    let document = context.document;
    let mut plain: BTreeMap<ErrorId, &String> = BTreeMap::new();
    for name in document.errors.keys() {
        let found = context.diagnostics.count();
        let spelling = find_error(context, name, known, document.places.key(&keys(["errors", name])));
        context.diagnostics.forget_repeats(found);
        plain.extend(spelling.map(|spelling| (spelling.error, name)));
    }
    for (branch, errors) in Branch::BOTH.into_iter().zip(blocks) {
        for (error, place) in &errors.places {
            let Some(name) = plain.get(error) else { continue };
            let written = keys(["axes", error.axis.as_str(), block_key(branch), "errors"]);
            let other = document.places.key(&keys(["errors", name]));
            let apart = place.as_ref().zip(other.as_ref()).is_some_and(|(a, b)| a.source != b.source);
            if apart && !document.places.has(&below(&written, name)) {
                let message =
                    format!("`{error}` is spelled differently under `{}` of the other file", dotted_path(&written));
                let refusal =
                    Diagnostic::new(codes::E0407, message).at(other, "").at(place.clone(), "the other spelling");
                context.diagnostics.push(refusal.help("spell it alike in both files"));
            }
        }
    }
}
