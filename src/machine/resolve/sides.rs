//! Geometry of each axis on either side of the bed, and the side for which the file states it.

use super::axes::{AxisDraft, block_entry};
use super::chain::side_in;
use super::context::Context;
use super::found_errors::Errors;
use super::names::parse_error_name;
use super::positions::{NamedPoint, PositionDraft, block_key, line_to_write};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{
    Axis, AxisGeometry, AxisKind, AxisName, Branch, ErrorFamily, ErrorId, ErrorTerm, Geometry, Machine, MachineParts,
    Position, ReferencePoint, SideGeometry, Sides, Tool, Unstated,
};
use crate::syntax::keys;
use crate::units::significant;

/// Returns the geometry of every axis that could be understood.
pub fn geometry(
    context: &Context,
    declared: &[AxisDraft],
    errors: &mut Errors,
    tool: &Tool,
    workpiece: Option<&PositionDraft>,
) -> Geometry {
    let settled = |position: Option<&PositionDraft>| {
        position.map_or_else(|| Position::absolute([0.0; 3]), |position| position.resolve_points(tool))
    };
    let both = |draft: &AxisDraft| {
        let mut other_side = errors.other_side.remove(&draft.name);
        let mut side = |branch: Branch| {
            let of = draft.on(branch);
            Some(SideGeometry {
                direction: of.direction?,
                origin: settled(of.origin.as_ref()),
                travel: of.travel?,
                stated: is_stated(context, draft, branch),
                origin_written: of.origin.is_some(),
                errors: other_side.take_if(|(side, _)| *side == branch).map(|(_, errors)| errors),
            })
        };
        let (tool, workpiece) = (side(Branch::Tool)?, side(Branch::Workpiece)?);
        Some((draft.name.clone(), AxisGeometry { tool, workpiece }))
    };
    Geometry { axes: declared.iter().filter_map(both).collect(), workpiece: settled(workpiece) }
}

/// True if the file states the geometry for the side: in the block of the side; by the plain keys beside the block of
/// the other side; or by the plain keys alone, if the file that wrote them has the axis on this side.
fn is_stated(context: &Context, draft: &AxisDraft, branch: Branch) -> bool {
    let [here, there] = [branch, branch.opposite()].map(|side| draft.block(side).origin.is_some());
    let (plain, name) = (draft.plain.origin.is_some(), draft.name.as_str());
    let home = || context.document.chains.of(name).find_map(|chain| side_in(chain, name));
    here || (plain && there) || (!there && home() == Some(branch))
}

/// Warns of axes that stand on a side for which the file states no geometry, and of a workpiece that an axis on the
/// other side would have to carry.
pub fn warn(context: &mut Context, machine: &Machine) {
    let (tip, gauge) = (machine.tool().tip, machine.tool().gauge);
    let refused = |entry: &[String]| context.document.places.is_marred(entry);
    let chain_refused = refused(&keys(["chain"])) || refused(&keys(["branches"]));
    let lost = |axis: &Axis| chain_refused || refused(&keys(["axes", axis.name.as_str()]));
    let unstated: Vec<_> =
        machine.unstated(|_| false).into_iter().filter(|(index, _)| !lost(&machine.axes()[*index])).collect();
    for (index, why) in unstated {
        let axis = &machine.axes()[index];
        let arm = significant(distance(axis.origin, tip), 4);
        let origin = axis.origin.map(|x| significant(x, 7)).join(", ");
        let message = format!(
            "the geometry of axis `{}` is not stated where it carries the {}: {}; its origin [{origin}] is {arm} mm \
             from the tip",
            axis.name,
            body(axis.branch),
            reason(&why)
        );
        let from = match axis.branch {
            Branch::Tool => NamedPoint { name: "gauge", point: gauge },
            Branch::Workpiece if matches!(machine.geometry().workpiece.from, ReferencePoint::Bed) => {
                NamedPoint { name: "workpiece", point: machine.workpiece() }
            }
            Branch::Workpiece => NamedPoint { name: "bed", point: [0.0; 3] },
        };
        let line = line_to_write(&axis.name, axis.branch, axis.origin, from);
        let help = format!("write under `axes` where it lies on this side; `{line}` is where it lies now");
        let places = &context.document.places;
        let (own, chain) = (places.key(&keys(["axes", axis.name.as_str()])), chain_place(context));
        let warning = Diagnostic::new(codes::W0404, message).at(own, "").at(chain, "the chain");
        context.diagnostics.push(warning.help(help));
    }
    let own = machine.without_origin(|_| false);
    for index in machine.without_origin_in_file() {
        let has = if own.contains(&index) { "has angular errors" } else { CLASS_ANGLES };
        let place = context.document.places.key(&keys(["axes", machine.axes()[index].name.as_str()]));
        context.diagnostics.push(no_origin(machine, index, has).at(place, ""));
    }
    if let Some(axis) = machine.unstated_workpiece().filter(|_| !chain_refused) {
        let message = format!("the workpiece lies at axis `{axis}`, which does not carry it");
        let place = context.document.places.value(&keys(["workpiece", "origin"]));
        let warning = Diagnostic::new(codes::W0404, message).at(place, "").at(chain_place(context), "the chain");
        context
            .diagnostics
            .push(warning.help("give the workpiece an origin from an axis that carries it, or from bed"));
    }
}

/// Why an axis without an origin is warned of if the file bounds its angles by a class alone.
pub const CLASS_ANGLES: &str = "has angles bounded by the class";

/// Returns the warning of an axis whose angular errors turn about machine zero for want of an origin; a rotary one
/// turns about it, too.
pub fn no_origin(machine: &Machine, index: usize, why: &str) -> Diagnostic {
    let Axis { name, kind, direction, origin, .. } = &machine.axes()[index];
    let tip = machine.tool().tip;
    if *kind == AxisKind::Linear {
        let arm = significant(distance(*origin, tip), 4);
        let message = format!(
            "axis `{name}` {why} and no `origin`: they turn about machine zero, {arm} mm from the tip at the zero pose"
        );
        let line = format!("{name}: {{ origin: {{ from: gauge, at: [0, 0, 250] }} }}");
        return Diagnostic::new(codes::W0405, message).help(format!(
            "write the point about which the carriage turns, such as `{line}`; `origin: [0, 0, 0]` keeps machine zero"
        ));
    }
    let along: f64 = (0..3).map(|i| (tip[i] - origin[i]) * direction[i]).sum();
    let foot = std::array::from_fn(|i| origin[i] + along * direction[i]);
    let arm = significant(distance(foot, tip), 4);
    let message = format!(
        "axis `{name}` {why} and no `origin`: its line goes through machine zero, {arm} mm from the tip at the zero \
         pose"
    );
    Diagnostic::new(codes::W0405, message).help(format!(
        "write a point of its line under `axes`, such as `{name}: {{ origin: [250, 225, -350] }}`; `origin: [0, 0, 0]` \
         keeps machine zero"
    ))
}

/// Warns of measured curves and location values of a bearing that a variant takes to the other side of the bed: there
/// it is another bearing.
pub fn warn_carried(context: &mut Context, parts: &MachineParts, errors: &Errors) {
    let chain_file = chain_place(context).map(|place| place.source);
    let sides: Sides = parts.axes.iter().map(|axis| (axis.name.clone(), axis.branch)).collect();
    // An axis whose geometry is not stated is warned of as a whole.
    let stated = |axis: &Axis| parts.geometry.unstated(&axis.name, &sides).is_none();
    let bearings = parts.axes.iter().zip(&parts.errors);
    for (axis, joint) in bearings.filter(|(axis, _)| axis.kind == AxisKind::Rotary && stated(axis)) {
        let name = axis.name.as_str();
        let home = context.document.chains.of(name).find_map(|chain| side_in(chain, name));
        if home.is_none_or(|home| home == axis.branch) {
            continue;
        }
        let document = context.document;
        let entry = document.axes.get(name).and_then(Option::as_ref);
        let block = entry.and_then(|entry| block_entry(entry, axis.branch));
        let in_block = |error: &ErrorId| {
            block.is_some_and(|b| b.errors.keys().any(|key| parse_error_name(key).as_ref() == Some(error)))
        };
        let place = |error: &ErrorId| errors.places.get(error).cloned().flatten();
        let carried = joint.iter().filter(|(family, _, term)| match (family, term) {
            (_, ErrorTerm::Tolerance(_)) => false,
            (ErrorFamily::Component, _) => true,
            (ErrorFamily::Location, term) => **term != ErrorTerm::Constant(0.0),
        });
        let of_other_file = |error: &ErrorId| place(error).is_some_and(|place| Some(place.source) != chain_file);
        let carried: Vec<ErrorId> = carried
            .map(|(family, direction, _)| ErrorId { axis: axis.name.clone(), family, direction })
            .filter(|error| of_other_file(error) && !in_block(error))
            .collect();
        let Some(first) = carried.first() else { continue };
        let names: Vec<String> = carried.iter().map(|error| format!("`{error}`")).collect();
        let message = format!(
            "{} of axis `{name}` {} measured where it carries the {}; here it carries the {}",
            names.join(", "),
            if carried.len() == 1 { "was" } else { "were" },
            body(axis.branch.opposite()),
            body(axis.branch)
        );
        let block = block_key(axis.branch);
        let help = format!(
            "they are carried over as they stand; state those of this side: `{name}: {{ {block}: {{ errors: {{ \
             {first}: ... }} }} }}`"
        );
        let warning = Diagnostic::new(codes::W0408, message).at(place(first), "").at(chain_place(context), "the chain");
        context.diagnostics.push(warning.help(help));
    }
}

fn chain_place(context: &Context) -> Option<crate::diagnostic::Place> {
    let places = &context.document.places;
    let written = if context.document.chain.is_some() { "chain" } else { "branches" };
    places.value(&keys([written]))
}

fn body(branch: Branch) -> &'static str {
    if branch == Branch::Tool { "tool" } else { "workpiece" }
}

fn reason(why: &Unstated) -> String {
    match why {
        Unstated::Side(Branch::Tool) => "the file gives it for the workpiece side alone".to_owned(),
        Unstated::Side(Branch::Workpiece) => "the file gives it for the tool side alone".to_owned(),
        Unstated::Reference(other) => format!("it is relative to axis `{other}`, which is not on this side"),
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

/// Returns the side of each axis of a chain.
pub fn sides(walk: &[(&AxisName, Branch)]) -> Sides {
    walk.iter().map(|(name, branch)| ((*name).clone(), *branch)).collect()
}
