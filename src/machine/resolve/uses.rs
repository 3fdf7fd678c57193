//! The sections `algebra` and `identify`: the error names and words in them are checked. `identify`
//! stays in the document for a later stage.

use super::context::{Context, dotted_path};
use super::joint_names::{JointNames, find_error};
use super::names::Spelling;
use crate::diagnostic::{codes, shown};
use crate::machine::algebra::{AlgebraChoice, Vanishing, vanishing as element};
use crate::machine::{Direction, basis_of_term, parse_error_name};
use crate::syntax::{AlgebraEntry, GeneratorsEntry, Keys, Scalar, below, keys};

/// Words for groups of what a fit determines.
pub const FITTED_GROUPS: [&str; 9] =
    ["location", "needed", "tool", "tools", "tools-by-run", "workpiece", "workpiece-by-run", "spindle", "linear"];
/// Families of basis functions, each with its order behind it.
const BASES: [&str; 5] = ["poly", "fourier", "spline", "bspline", "blocks"];

/// Returns the section `algebra`.
pub fn algebra(context: &mut Context, known: &JointNames<'_>) -> Option<AlgebraChoice> {
    let entry = context.document.algebra.as_ref()?;
    let at = keys(["algebra"]);
    let without = AlgebraEntry { vanish: Vec::new(), ..entry.clone() };
    match AlgebraChoice::new(&without) {
        // Names of errors are judged one by one below.
        Err(refusal) if refusal.code != codes::E0405 => {
            let wrong = below(&at, if refusal.code == codes::E0210 { "generators" } else { "degree" });
            context.at_value(refusal.code, &wrong, refusal.message, refusal.help.unwrap_or_default());
        }
        _ => {}
    }
    let names = generators(context, known, entry, &below(&at, "generators"));
    for (i, monomial) in entry.vanish.iter().enumerate() {
        vanishing(context, known, monomial, &names, &below(&below(&at, "vanish"), i));
    }
    AlgebraChoice::new(entry).ok()
}

/// Checks the errors of groups; names that generators have besides those of errors.
fn generators<'a>(context: &mut Context, known: &JointNames<'a>, entry: &'a AlgebraEntry, at: &Keys) -> Vec<&'a str> {
    match &entry.generators {
        Some(GeneratorsEntry::Groups(map)) => {
            for (group, errors) in map {
                let list = below(at, group);
                errors.iter().enumerate().for_each(|(i, name)| known.error(context, name, &below(&list, i)));
            }
            map.keys().map(String::as_str).collect()
        }
        Some(GeneratorsEntry::Word(word)) if word == "per-axis" => known.names(),
        _ => Vec::new(),
    }
}

/// `EXX*EYX`, `EXX^2`: names of errors or generators with powers.
fn vanishing(context: &mut Context, known: &JointNames<'_>, monomial: &str, names: &[&str], at: &Keys) {
    let factors = element(monomial).map(|element| match element {
        Vanishing::Monomial(factors) => factors,
        Vanishing::Relation(relation) => relation.left.into_iter().chain(relation.right).collect(),
    });
    match factors {
        Err(refusal) => context.at_value(refusal.code, at, refusal.message, refusal.help.unwrap_or_default()),
        Ok(factors) => {
            let numbered = |name: &str| name.strip_prefix('x').is_some_and(|k| k.parse::<u16>().is_ok_and(|k| k > 0));
            for (name, _) in factors.iter().filter(|(name, _)| !names.contains(&name.as_str()) && !numbered(name)) {
                known.error(context, name, at);
            }
        }
    }
}

/// The section `identify`.
pub fn identify(context: &mut Context, known: &JointNames<'_>) {
    let Some(entry) = &context.document.identify else { return };
    let knotted = |name: &str| entry.knots.keys().any(|key| parse_error_name(key) == parse_error_name(name));
    for (key, list) in [("fit", &entry.fit), ("fixed", &entry.fixed)] {
        for (i, text) in list.iter().enumerate() {
            let at = below(&keys(["identify", key]), i);
            let (name, form) = text.split_once(':').map_or((text.as_str(), None), |(n, f)| (n, Some(f)));
            // A parameter as the report names it: `workpiece.X`, `EXX:x^0`. What is fixed may also be a knot.
            let fixed = key == "fixed";
            let is_basis = |form: &&str| !fixed && basis_of_term(form.trim()).is_none();
            if let Some(form) = form.filter(is_basis) {
                basis(context, form, knotted(without_direction(name)), &at);
            }
            let own = entry.parameters.contains_key(name) || is_setup(name);
            if !FITTED_GROUPS.contains(&name) && !own {
                fit(context, known, without_direction(name), &at);
            }
        }
    }
    if let Some(plausible) = &entry.plausible {
        for (key, limit, direction) in
            [("length", &plausible.length, Direction::X), ("angle", &plausible.angle, Direction::A)]
        {
            let at = keys(["identify", "plausible", key]);
            let _ = limit.as_ref().and_then(|limit| context.error_value(limit, direction, &at));
        }
    }
    for (name, form) in &entry.basis {
        let at = keys(["identify", "basis", name]);
        let place = context.document.places.key(&at);
        let _ = find_error(context, name, known, place);
        basis(context, form, knotted(name), &at);
    }
    let leaders = entry.tied.iter().flat_map(|(name, leaders)| {
        std::iter::once((keys(["identify", "tied", name]), name))
            .chain(leaders.keys().map(move |leader| (keys(["identify", "tied", name, leader]), leader)))
    });
    let moved = entry.parameters.iter().flat_map(|(name, errors)| {
        errors.keys().map(move |error| (keys(["identify", "parameters", name, error]), error))
    });
    let knots = entry.knots.keys().map(|name| (keys(["identify", "knots", name]), name));
    for (at, name) in leaders.chain(moved).chain(knots).collect::<Vec<_>>() {
        let place = context.document.places.key(&at);
        let _ = find_error(context, name, known, place);
    }
    for (name, bound) in &entry.slopes {
        slope(context, known, name, bound);
    }
}

/// Checks the bound on the slope of an error. Whether the error is fitted as a curve is judged by the fit.
fn slope(context: &mut Context, known: &JointNames<'_>, name: &str, bound: &Scalar) {
    let at = keys(["identify", "slopes", name]);
    let place = context.document.places.key(&at);
    let Some(Spelling { error, .. }) = find_error(context, name, known, place) else { return };
    let Some(kind) = known.axis(&error.axis).and_then(|axis| axis.kind).filter(|_| !error.is_location()) else {
        return;
    };
    if context.coefficient(bound, error.direction, kind, 1, &at).is_some_and(|slope| slope <= 0.0) {
        let message = format!("`{}` is not above zero", dotted_path(&at));
        context.at_value(codes::E0213, &at, message, "write the standard deviation of the slope, such as 20 um/m");
    }
}

/// `tool.X`, `tool long.X`, `workpiece.A`: one set-up error.
fn is_setup(name: &str) -> bool {
    let Some((whole, letter)) = name.rsplit_once('.') else { return false };
    let of_tool = whole == "tool" || whole.starts_with("tool ");
    (of_tool && ["X", "Y", "Z"].contains(&letter))
        || (whole == "workpiece" && ["X", "Y", "Z", "A", "B", "C"].contains(&letter))
}

/// Returns an error's name without the direction of approach that may stand behind it.
fn without_direction(name: &str) -> &str {
    ["+-", "+", "-"].iter().find_map(|sign| name.strip_suffix(sign)).unwrap_or(name).trim()
}

/// A word near a group is meant as one.
fn fit(context: &mut Context, known: &JointNames<'_>, name: &str, at: &Keys) {
    match crate::diagnostic::nearest(name, FITTED_GROUPS) {
        Some(near) => {
            let message = format!("`{}` is neither an error nor a group", shown(name));
            context.at_value(codes::E0405, at, message, format!("did you mean `{near}`?"));
        }
        None => known.error(context, name, at),
    }
}

/// Checks `poly3`, `fourier2`, `spline8`, `bspline8`, `bspline8/2`, `blocks4`; splines and `blocks` alone where `knots`
/// has some.
fn basis(context: &mut Context, form: &str, knotted: bool, at: &Keys) {
    let bare = match form.trim().rsplit_once('/') {
        Some((bare, "1" | "2" | "3")) if bare.starts_with("bspline") => bare,
        _ => form.trim(),
    };
    if knotted && ["spline", "bspline", "blocks"].contains(&bare) {
        return;
    }
    let order = BASES.iter().find_map(|family| bare.strip_prefix(family));
    if !order.and_then(|o| o.parse::<u8>().ok()).is_some_and(|o| (1..=50).contains(&o)) {
        let message = format!("`{}` is not a basis", shown(form));
        context.at_value(
            codes::E0215,
            at,
            message,
            "write poly3 (powers 0 to 3), fourier2 (orders 0 to 2), spline8 or bspline8 (8 knots), \
             or blocks4 (4 blocks)",
        );
    }
}
