//! `abbe eval`: deviation and E_VE at poses.

use crate::cli::Outcome;
use crate::cli::arguments::{AlgebraArg, FrameOption, JobArg, ReferenceArg, ViewArgs, help};
use crate::cli::output::session::Session;
use crate::cli::output::view::{folded, frame_text, keep_words, length, numbers, path_text, table};
use abbe::options::Approach;
use abbe::results::{
    AlgebraResult, AxisPositions, ErrorEffect, EvalResult, InversePole, MonomialPart, Neglected, Over, PoseResult,
};
use abbe::text::significant;
use abbe::{EvalOptions, MachineFile, eval};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(mut_arg("job", |option| option.conflicts_with_all(["at", "axis_poses"])))]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true, help = help::AT,
        long_help = "A pose, mm and deg; axes left out are at 0. May be repeated")]
    at: Vec<String>,
    #[arg(long, value_name = "FILE", alias = "poses", help = help::AXIS_POSES)]
    axis_poses: Option<PathBuf>,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    reference: ReferenceArg,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    algebra: AlgebraArg,
    /// Add the motions of the axes that undo the errors, by Newton over the algebra.
    #[arg(long, requires = "algebra")]
    inverse: bool,
    /// Add the effect of 1 um or 1 urad of every error (workpiece frame).
    #[arg(long)]
    sensitivity: bool,
    /// Add the effect of pairs of errors, and the error of order 1.
    #[arg(long, requires = "sensitivity")]
    interactions: bool,
    #[command(flatten)]
    frame: FrameOption,
}

impl Args {
    fn options(&self) -> EvalOptions {
        EvalOptions {
            at: self.at.clone(),
            poses: Vec::new(),
            pose_file: self.axis_poses.clone(),
            job: self.job.job.clone(),
            reference: self.reference.reference.clone(),
            path: self.job.path,
            order: self.view.order.order,
            approach: self.view.direction.direction,
            frame: self.frame.frame,
            algebra: self.algebra.algebra.clone(),
            inverse: self.inverse,
            sensitivity: self.sensitivity,
            interactions: self.interactions,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.view.tool.name())?;
    let result = session.take(eval(&file, &args.options(), session.run()))?;
    session.show(&result, || csv(&file, &result), || text(&result))
}

fn csv(file: &MachineFile, result: &EvalResult) -> String {
    let axes = file.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
    let names = ["x [mm]", "y [mm]", "z [mm]", "dx [mm]", "dy [mm]", "dz [mm]", "wx [rad]", "wy [rad]", "wz [rad]"];
    let normal = result.poses.iter().any(|pose| pose.along_normal.is_some()).then(|| "dn [mm]".to_owned());
    let stated = result.poses.iter().any(|pose| pose.uncertainty.is_some());
    let expanded = names[3..].iter().map(|name| format!("U {name}")).take(if stated { 6 } else { 0 });
    let effects = effect_names(result);
    let asked = extra_columns(file, result, &effects);
    let event = (!result.events.is_empty()).then(|| "event".to_owned());
    let stated_columns = axes.chain(names.map(str::to_owned)).chain(normal).chain(expanded);
    let header: Vec<String> = stated_columns.chain(asked).chain(event).collect();
    let line = |(i, pose): (usize, &PoseResult)| {
        let vectors = [pose.nominal, pose.deviation, pose.rotation];
        let expanded = pose.uncertainty.iter().flat_map(|u| [u.deviation, u.rotation]);
        let undone = pose.inverse.iter().flat_map(AxisPositions::values).copied();
        let own: BTreeMap<&str, &ErrorEffect> =
            effects_of(pose).map(|effect| (effect.error.as_str(), effect)).collect();
        // Pairs without an effect at a pose are not listed there.
        let six = |name: &&str| own.get(name).map_or([[0.0; 3]; 2], |effect| [effect.deviation, effect.rotation]);
        let stated = vectors.into_iter().flatten().chain(pose.along_normal).chain(expanded.flatten());
        let all = pose.axes.values().copied().chain(stated).chain(undone).chain(effects.iter().flat_map(six).flatten());
        let event = result.events.get(i).map_or_else(String::new, |event| format!(",{event}"));
        numbers(all) + &event
    };
    let lines: Vec<String> =
        std::iter::once(header.join(",")).chain(result.poses.iter().enumerate().map(line)).collect();
    lines.join("\n")
}

/// The columns of what poses have where it is asked for: motions that undo the errors, effects of errors and of pairs.
fn extra_columns(file: &MachineFile, result: &EvalResult, effects: &[&str]) -> Vec<String> {
    let unit = |name: &String| file.axis_index(name).map_or("mm", |i| file.axes()[i].unit());
    let inverse = result.poses.first().and_then(|pose| pose.inverse.as_ref());
    let undone = inverse.into_iter().flat_map(AxisPositions::keys).map(|name| format!("undo {name} [{}]", unit(name)));
    let rotations: BTreeSet<String> =
        file.errors().filter(|(id, _)| id.direction.is_rotation()).map(|(id, _)| id.to_string()).collect();
    let per = |error: &str| if rotations.contains(error) { "/rad" } else { "/mm" };
    let six = |name: &&str| {
        let per: String = name.split('*').map(per).collect();
        let [mm, rad] = [("d", "mm"), ("w", "rad")]
            .map(|(letter, unit)| ["x", "y", "z"].map(|k| format!("{letter}{k}/{name} [{unit}{per}]")));
        mm.into_iter().chain(rad)
    };
    undone.chain(effects.iter().flat_map(six)).collect()
}

/// Names of the errors and of the pairs that have an effect at a pose, each once.
fn effect_names(result: &EvalResult) -> Vec<&str> {
    let mut known = BTreeSet::new();
    let all = result.poses.iter().flat_map(effects_of).map(|effect| effect.error.as_str());
    all.filter(|name| known.insert(*name)).collect()
}

/// The effects of errors and of pairs of errors, where they are asked for.
fn effects_of(pose: &PoseResult) -> impl Iterator<Item = &ErrorEffect> {
    pose.sensitivity.iter().chain(&pose.interactions).flatten()
}

fn text(result: &EvalResult) -> String {
    let units = ["dx um", "dy um", "dz um", "|d| um", "wx urad", "wy urad", "wz urad"];
    let normal = result.poses.iter().any(|pose| pose.along_normal.is_some()).then_some("along normal um");
    let axes: Vec<&str> =
        result.poses.first().into_iter().flat_map(|pose| pose.axes.keys().map(String::as_str)).collect();
    let mut table = table(&axes.into_iter().chain(units).chain(normal).collect::<Vec<_>>());
    for pose in &result.poses {
        let (position, rotation) = pose.uncertainty.map_or((None, None), |u| (Some(u.deviation), Some(u.rotation)));
        let distance = significant(length(&pose.deviation) * 1e3, 5);
        let cells = pose.axes.values().map(|q| significant(*q, 9)).chain(micro(pose.deviation, position, 1e3));
        let along = pose.along_normal.map(|mm| significant(mm * 1e3, 5));
        let cells = cells.chain([distance]).chain(micro(pose.rotation, rotation, 1e6)).chain(along);
        let _ = table.add_row(cells.collect::<Vec<_>>());
    }
    keep_words(&mut table);
    format!(
        "{}: deviation of the functional point, actual minus nominal, {} frame, order {}{}{}{}\n{}{}{table}\n{}{}",
        result.machine,
        frame_text(result.frame),
        result.order,
        match result.direction {
            Approach::Mean => "",
            Approach::Forward => ", approached forward",
            Approach::Reverse => ", approached in reverse",
        },
        match result.tool.as_str() {
            "" => String::new(),
            name => format!(", tool {name}"),
        },
        if result.poses.iter().any(|pose| pose.uncertainty.is_some()) { ", U (k = 2) behind \u{b1}" } else { "" },
        result.algebra.as_ref().map_or_else(String::new, quotient),
        result.over.as_ref().map_or_else(String::new, Over::text),
        result.poses.iter().filter_map(|pose| pose.inverse.as_ref()).map(displacements).collect::<String>()
            + &poles(result),
        parts(result)
            + &beyond_measured(result)
            + &effects(result)
            + &result.path.as_ref().map_or_else(String::new, path_text)
    )
}

/// The poles at which displacements hold the position alone.
fn poles(result: &EvalResult) -> String {
    let one = |(number, pole): (usize, &InversePole)| {
        let [x, y, z] = pole.unreachable.map(|x| significant(x, 4));
        folded(&format!(
            "pose {number} is at a pole: the linear axes hold the point, `{}` is free, and the tool cannot be turned \
             into ({x}, {y}, {z})",
            pole.free
        ))
    };
    (1..).zip(&result.poses).filter_map(|(number, pose)| Some(one((number, pose.inverse_pole.as_ref()?)))).collect()
}

/// Number of monomials that text output lists.
const SHOWN_MONOMIALS: usize = 60;

/// The Groebner basis of relations, and the basis of the quotient; empty without relations.
fn quotient(algebra: &AlgebraResult) -> String {
    if algebra.groebner_basis.is_empty() {
        return String::new();
    }
    let name = |(k, name): (usize, &String)| format!("x{} {name}", k + 1);
    let generators = algebra.generators.iter().enumerate().map(name).collect::<Vec<_>>().join(", ");
    let monomials = algebra.monomials.iter().take(SHOWN_MONOMIALS).cloned().collect::<Vec<_>>().join(", ");
    let rest = match algebra.monomials.len().saturating_sub(SHOWN_MONOMIALS) {
        0 => String::new(),
        rest => format!(", ... and {rest} more: `--format json`"),
    };
    format!(
        "Groebner basis, graded reverse lexicographic, of generators {generators}:\n  {}\nBasis of the quotient: \
         {monomials}{rest}\n",
        algebra.groebner_basis.join("\n  ")
    )
}

/// The poses beyond what was measured, in words; empty without.
fn beyond_measured(result: &EvalResult) -> String {
    let one = |(i, pose): (usize, &PoseResult)| {
        (!pose.beyond_measured.is_empty()).then(|| format!("pose {} ({})", i + 1, pose.beyond_measured.join(", ")))
    };
    let all: Vec<String> = result.poses.iter().enumerate().filter_map(one).collect();
    if all.is_empty() { String::new() } else { format!("Beyond what was measured: {}\n", all.join(", ")) }
}

/// Components times a factor, with their expanded uncertainty where it is stated: `12.3 +- 0.8`.
fn micro(v: [f64; 3], uncertainty: Option<[f64; 3]>, factor: f64) -> [String; 3] {
    std::array::from_fn(|k| {
        let value = significant(v[k] * factor, 5);
        uncertainty.map_or(value.clone(), |u| format!("{value} \u{b1} {}", significant(u[k] * factor, 2)))
    })
}

fn displacements(by: &AxisPositions) -> String {
    let axis = |(axis, by): (&String, &f64)| format!("{axis} {}", significant(*by, 6));
    format!("To undo the errors, move by (mm, deg): {}\n", by.iter().map(axis).collect::<Vec<_>>().join(", "))
}

fn effects(result: &EvalResult) -> String {
    let mut text = String::new();
    for (number, pose) in result.poses.iter().enumerate() {
        let Some(first) = &pose.sensitivity else { continue };
        text.push_str(&format!("Pose {}: effect of 1 um or 1 urad of each error\n", number + 1));
        text.push_str(&format!("{}\n", first_table(first)));
        if let Some(second) = &pose.interactions {
            let table = second_table(second);
            text.push_str(&format!("Largest interactions, with the errors as they are\n{table}\n"));
        }
    }
    result.neglected.map_or(text.clone(), |neglected| format!("{text}{}\n", sentence(&neglected)))
}

/// Poses of which the text lists parts.
const SHOWN_POSES: usize = 8;

/// Degrees, where there are several, and the largest monomials of an algebra.
fn parts(result: &EvalResult) -> String {
    let mut text = String::new();
    let several = |pose: &PoseResult| pose.degrees.as_ref().is_some_and(|degrees| degrees.len() > 1);
    for (number, pose) in result.poses.iter().enumerate().filter(|(_, pose)| several(pose)).take(SHOWN_POSES) {
        let degrees = pose.degrees.iter().flatten();
        let by_degree = degrees.map(|part| (part.degree.to_string(), part.deviation, part.rotation));
        text.push_str(&format!("Pose {}: parts by degree\n{}\n", number + 1, parts_table("degree", by_degree)));
        let mut list: Vec<&MonomialPart> = pose.coefficients.iter().flatten().collect();
        if list.len() > pose.degrees.iter().flatten().count() {
            list.sort_by(|a, b| length(&b.deviation).total_cmp(&length(&a.deviation)));
            let count = list.len();
            let largest = list.into_iter().take(SHOWN);
            let table =
                parts_table("monomial", largest.map(|p| (p.monomial.replace('*', " * "), p.deviation, p.rotation)));
            text.push_str(&format!("Pose {}: largest of {count} monomials\n{table}\n", number + 1));
        }
    }
    let rest = result.poses.iter().filter(|pose| several(pose)).count().saturating_sub(SHOWN_POSES);
    text + &if rest == 0 { String::new() } else { format!("... and {rest} more poses: `--format json`\n") }
}

/// A part, which may be small by any power: `1.23e-10`.
fn part(micro: f64) -> String {
    if micro == 0.0 || micro.abs() >= 1e-3 { significant(micro, 5) } else { format!("{micro:.2e}") }
}

fn parts_table(name: &str, parts: impl Iterator<Item = (String, [f64; 3], [f64; 3])>) -> comfy_table::Table {
    let mut table = table(&[name, "dx um", "dy um", "dz um", "wx urad", "wy urad", "wz urad"]);
    for (name, deviation, rotation) in parts {
        let cells = deviation.iter().map(|mm| part(mm * 1e3)).chain(rotation.iter().map(|rad| part(rad * 1e6)));
        let _ = table.add_row(std::iter::once(name).chain(cells).collect::<Vec<_>>());
    }
    table
}

/// `order 1 is good to 3 nm on this machine`.
fn sentence(neglected: &Neglected) -> String {
    format!(
        "order 1 is good to {} nm and {} nrad on this machine (all interactions of second degree with one sign, \
         at the worst of these poses and {} of its volume)",
        significant(neglected.position_mm * 1e6, 2),
        significant(neglected.rotation_rad * 1e9, 2),
        EvalResult::BOUND_POSES
    )
}

fn first_table(effects: &[ErrorEffect]) -> comfy_table::Table {
    let mut table = table(&["error", "dx um", "dy um", "dz um", "wx urad", "wy urad", "wz urad"]);
    for effect in effects {
        // mm per rad are nm per urad: 1e-3 um.
        let angle = effect.rotation != [0.0; 3];
        let scale = if angle { 1e-3 } else { 1.0 };
        let cells = effect.deviation.iter().map(|x| significant(x * scale, 5));
        let cells = cells.chain(effect.rotation.iter().map(|x| significant(*x, 5)));
        let _ = table.add_row(std::iter::once(effect.error.clone()).chain(cells).collect::<Vec<_>>());
    }
    table
}

/// Number of interactions that text output lists.
const SHOWN: usize = 12;

fn second_table(effects: &[ErrorEffect]) -> comfy_table::Table {
    let mut table = table(&["errors", "dx nm", "dy nm", "dz nm"]);
    let size = |e: &ErrorEffect| length(&e.deviation) * e.value.abs();
    let mut order: Vec<&ErrorEffect> = effects.iter().filter(|e| size(e) > 0.0).collect();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    for effect in order.into_iter().take(SHOWN) {
        let cells = effect.deviation.iter().map(|x| significant(x * effect.value * 1e6 + 0.0, 4));
        let _ = table.add_row(std::iter::once(effect.error.replace('*', " * ")).chain(cells).collect::<Vec<_>>());
    }
    table
}
