//! Directions among parameters, in words: the null space, and directions below noise.

use super::model::Parameter;
use crate::identify::thresholds::*;
use crate::units::significant;
use nalgebra::{DMatrix, DVector};

/// The parameters of a direction, with their displacements.
type DirectionParts = Vec<(usize, f64)>;

/// Returns the reduced echelon form of a basis (columns), in which few parameters take part in each direction.
pub(super) fn reduced_echelon(basis: &DMatrix<f64>) -> Vec<DVector<f64>> {
    let mut rows: Vec<DVector<f64>> = basis.column_iter().map(|column| column.into_owned()).collect();
    for k in 0..rows.len() {
        let size = |row: &DVector<f64>| row[pivot(row)].abs();
        let best =
            (k..rows.len()).fold(k, |best, i| if size(&rows[i]) > TIE_RATIO * size(&rows[best]) { i } else { best });
        rows.swap(k, best);
        let pivot = pivot(&rows[k]);
        if rows[k][pivot] == 0.0 {
            continue;
        }
        let row = &rows[k] / rows[k][pivot];
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[pivot];
            if i == k { other.copy_from(&row) } else { *other -= &row * factor }
        }
    }
    rows.sort_by_key(|row| (main_parts(row).len(), pivot(row)));
    rows
}

/// Returns the index of the largest entry; the first of equals, so that rounding does not choose.
fn pivot(row: &DVector<f64>) -> usize {
    (0..row.len()).fold(0, |p, j| if row[j].abs() > TIE_RATIO * row[p].abs() { j } else { p })
}

/// Returns the parameters of a null-space direction.
pub(super) fn main_parts(row: &DVector<f64>) -> DirectionParts {
    parts_above(row, MIN_NULL_PART_SHARE)
}

/// Returns the parameters above a share of the largest.
fn parts_above(row: &DVector<f64>, share: f64) -> DirectionParts {
    let largest = row.iter().map(|x| x.abs()).fold(0.0, f64::max);
    row.iter().copied().enumerate().filter(|(_, x)| x.abs() > share * largest && *x != 0.0).collect()
}

/// Joins names: `EX0C, tool.X and workpiece.X`.
pub(super) fn join_names(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [init @ .., last] => format!("{} and {last}", init.join(", ")),
    }
}

fn names<'a>(direction: &DirectionParts, parameters: &'a [Parameter]) -> Vec<&'a str> {
    direction.iter().map(|(j, _)| parameters[*j].name.as_str()).collect()
}

/// Describes a null-space direction in a sentence of at most `most` parts.
pub(super) fn describe_null(direction: &DirectionParts, parameters: &[Parameter], most: usize) -> String {
    if let [(j, _)] = direction[..] {
        return format!("{} has no effect on these data", parameters[j].name);
    }
    let first = direction.first().map_or(1.0, |(j, x)| parameters[*j].in_unit(x / parameters[*j].size));
    let amount = |(j, x): &(usize, f64)| parameters[*j].in_unit(x / parameters[*j].size) / first;
    let curves = direction.chunk_by(|(i, _), (j, _)| parameters[*i].curve().0 == parameters[*j].curve().0);
    let (mut names, mut parts) = (Vec::new(), Vec::new());
    for knots in curves {
        match describe_knots(knots, &amount, parameters) {
            Some(part) => {
                names.push(parameters[knots[0].0].curve().0);
                parts.push(part);
            }
            None => {
                let part = |k: &(usize, f64)| {
                    format!("{} {} {}", parameters[k.0].name, with_sign(amount(k)), parameters[k.0].unit)
                };
                names.extend(knots.iter().map(|(j, _)| parameters[*j].name.as_str()));
                parts.extend(knots.iter().map(part));
            }
        }
    }
    let more = shorten(&mut parts, &mut names, most);
    let names = join_names(&names.into_iter().chain(more.as_deref()).collect::<Vec<_>>());
    match &parts[..] {
        [one] => format!("{one} changes nothing"),
        _ => format!("{} cannot be separated: together {} change nothing", names, parts.join(", ")),
    }
}

/// Describes the amounts at neighbouring knots of a curve as one: the same throughout, or along a straight line. `None`
/// if they are on no line, or so few that they may as well be listed.
fn describe_knots(
    knots: &[(usize, f64)],
    amount: &impl Fn(&(usize, f64)) -> f64,
    parameters: &[Parameter],
) -> Option<String> {
    let ([(i, _), .., (j, _)], true) = (knots, knots.len() > 2) else { return None };
    let (curve, from) = parameters[*i].curve();
    let (from, to, unit) = (from?, parameters[*j].curve().1?, &parameters[*i].unit);
    let (first, last) = (amount(&knots[0]), amount(&knots[knots.len() - 1]));
    let all = parameters.iter().filter(|p| p.curve().0 == curve).count() == knots.len();
    let ends = (knot_position(from)?, knot_position(to)?);
    let largest = first.abs().max(last.abs());
    let on_line = |k: &(usize, f64)| {
        let at = parameters[k.0].curve().1.and_then(knot_position)?;
        let line = first + (last - first) * (at - ends.0) / (ends.1 - ends.0);
        Some((amount(k) - line).abs() <= MAX_STRAIGHT_SHARE * largest)
    };
    if !knots.iter().all(|k| on_line(k) == Some(true)) {
        return None;
    }
    if all && (last - first).abs() <= MAX_STRAIGHT_SHARE * largest {
        return Some(format!("{curve} {} {unit} throughout", with_sign(first)));
    }
    Some(format!("{curve} {} {unit} at {from} to {} {unit} at {to}", with_sign(first), with_sign(last)))
}

/// Reads the position of a knot: `b@125mm` or `125mm`.
fn knot_position(knot: &str) -> Option<f64> {
    knot.trim_start_matches("b@").trim_end_matches(char::is_alphabetic).parse().ok()
}

fn with_sign(value: f64) -> String {
    let text = significant(value, 3);
    if text.starts_with('-') { text } else { format!("+{text}") }
}

/// Cuts parts and names to `max` each. Returns the words for the others, if there are any.
fn shorten(parts: &mut Vec<String>, names: &mut Vec<&str>, max: usize) -> Option<String> {
    let others = parts.len().checked_sub(max).filter(|others| *others > 0)?;
    names.truncate(max);
    parts.truncate(max);
    parts.push("...".to_owned());
    Some(format!("{others} more"))
}

/// Maximum number of parameters named of a direction below noise: those with the largest part.
const MAX_NAMED: usize = 6;
/// Describes directions below noise. `spreads` are one standard deviation along each, by displacements; `scale` are the
/// columns' scales in these units; the null space (reduced) is taken out of them.
pub(super) fn describe_weak(
    spreads: &[DVector<f64>],
    scale: &DVector<f64>,
    null: &[DVector<f64>],
    parameters: &[Parameter],
) -> Vec<String> {
    spreads.iter().map(|spread| describe_weak_direction(&reduce_by_null(spread, null), scale, parameters)).collect()
}

/// Takes the pivots of null-space directions out of a direction.
fn reduce_by_null(direction: &DVector<f64>, null: &[DVector<f64>]) -> DVector<f64> {
    null.iter().fold(direction.clone(), |rest, row| {
        let pivot = pivot(row);
        &rest - row * (rest[pivot] / row[pivot])
    })
}

fn describe_weak_direction(spread: &DVector<f64>, scale: &DVector<f64>, parameters: &[Parameter]) -> String {
    let effect = spread.component_mul(scale);
    let visible = effect.norm() * MIN_WEAK_EFFECT_SHARE;
    let mut direction: DirectionParts =
        parts_above(spread, MIN_WEAK_PART_SHARE).into_iter().filter(|(j, _)| effect[*j].abs() > visible).collect();
    direction.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let most = direction.first().map_or(0.0, |(_, x)| x.abs());
    let share = if most > IMPLAUSIBLE_DISPLACEMENT_MM { IMPLAUSIBLE_DISPLACEMENT_MM / most } else { 1.0 };
    let amount = |(j, x): &(usize, f64)| {
        let p = &parameters[*j];
        format!("{} {}", with_sign(p.in_unit(x * share / p.size)), p.unit)
    };
    let hides = "of what the noise (one standard deviation) hides";
    if let [alone] = &direction[..] {
        let (name, amount) = (&parameters[alone.0].name, amount(alone));
        return match share < 1.0 {
            true => format!("{name} is hardly known: {amount} is {} {hides}", significant(share, 2)),
            false => format!("{name} is hardly known: the noise (one standard deviation) cannot be told from {amount}"),
        };
    }
    let mut parts: Vec<String> =
        direction.iter().map(|part| format!("{} {}", parameters[part.0].name, amount(part))).collect();
    let mut names = names(&direction, parameters);
    let more = shorten(&mut parts, &mut names, MAX_NAMED);
    let names = join_names(&names.into_iter().chain(more.as_deref()).collect::<Vec<_>>());
    let parts = parts.join(", ");
    if share < 1.0 {
        return format!("{names} are only known together: {parts} are {} {hides}", significant(share, 2));
    }
    format!("{names} are only known together: the noise (one standard deviation) cannot be told from {parts}")
}
