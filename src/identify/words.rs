//! Directions among parameters, in words: what changes nothing, and what the noise drowns.

use super::model::Parameter;
use crate::units::significant;
use nalgebra::{DMatrix, DVector};

/// Parameters below this share of the largest in a direction that the noise drowns are not named.
const NAMED: f64 = 0.02;
/// Parameters below this share of the largest in a direction that changes nothing are not named: amounts are printed to
/// three digits, so that their rounding changes the readings by more than what is left out.
const PRINTED: f64 = 2e-4;
/// Knots off a straight line by less than this share of the ends are on it: amounts are printed to three digits.
const STRAIGHT: f64 = 5e-3;
/// Parameters below this share of what a direction does to the readings are not named.
const HEARD: f64 = 0.1;

/// A direction: parameters and how much of each (unit size 1).
type Direction = Vec<(usize, f64)>;

/// A basis of a subspace (columns) in which few parameters take part in each direction: reduced echelon form.
pub(super) fn echelon(basis: &DMatrix<f64>) -> Vec<DVector<f64>> {
    let mut rows: Vec<DVector<f64>> = basis.column_iter().map(|column| column.into_owned()).collect();
    for k in 0..rows.len() {
        let size = |row: &DVector<f64>| row[largest(row)].abs();
        let best =
            (k..rows.len()).fold(k, |best, i| if size(&rows[i]) > 1.0001 * size(&rows[best]) { i } else { best });
        rows.swap(k, best);
        let pivot = largest(&rows[k]);
        if rows[k][pivot] == 0.0 {
            continue;
        }
        let row = &rows[k] / rows[k][pivot];
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[pivot];
            if i == k { other.copy_from(&row) } else { *other -= &row * factor }
        }
    }
    rows.sort_by_key(|row| (named(row).len(), largest(row)));
    rows
}

/// Among equals the first: which of two equal parts is larger must not depend on rounding.
fn largest(row: &DVector<f64>) -> usize {
    (0..row.len()).fold(0, |p, j| if row[j].abs() > 1.0001 * row[p].abs() { j } else { p })
}

/// The parameters of a direction that changes nothing.
pub(super) fn named(row: &DVector<f64>) -> Direction {
    above(row, PRINTED)
}

/// The parameters above a share of the largest.
fn above(row: &DVector<f64>, share: f64) -> Direction {
    let largest = row.iter().map(|x| x.abs()).fold(0.0, f64::max);
    row.iter().copied().enumerate().filter(|(_, x)| x.abs() > share * largest && *x != 0.0).collect()
}

/// `EX0C, tool.X and workpiece.X`.
pub(super) fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [init @ .., last] => format!("{} and {last}", init.join(", ")),
    }
}

fn names<'a>(direction: &Direction, parameters: &'a [Parameter]) -> Vec<&'a str> {
    direction.iter().map(|(j, _)| parameters[*j].name.as_str()).collect()
}

/// A direction that changes nothing, in words; of so many parts at most.
pub(super) fn inseparable(direction: &Direction, parameters: &[Parameter], most: usize) -> String {
    if let [(j, _)] = direction[..] {
        return format!("{} has no effect on these data", parameters[j].name);
    }
    let first = direction.first().map_or(1.0, |(j, x)| parameters[*j].shown(x / parameters[*j].size));
    let amount = |(j, x): &(usize, f64)| parameters[*j].shown(x / parameters[*j].size) / first;
    let curves = direction.chunk_by(|(i, _), (j, _)| parameters[*i].curve().0 == parameters[*j].curve().0);
    let (mut names, mut parts) = (Vec::new(), Vec::new());
    for knots in curves {
        match shape(knots, &amount, parameters) {
            Some(part) => {
                names.push(parameters[knots[0].0].curve().0);
                parts.push(part);
            }
            None => {
                let part = |k: &(usize, f64)| {
                    format!("{} {} {}", parameters[k.0].name, signed(amount(k)), parameters[k.0].unit)
                };
                names.extend(knots.iter().map(|(j, _)| parameters[*j].name.as_str()));
                parts.extend(knots.iter().map(part));
            }
        }
    }
    let more = format!("{} more", parts.len().saturating_sub(most));
    if parts.len() > most {
        names.truncate(most);
        parts.truncate(most);
        names.push(&more);
        parts.push("...".to_owned());
    }
    match &parts[..] {
        [one] => format!("{one} changes nothing"),
        _ => format!("{} cannot be separated: together {} change nothing", list(&names), parts.join(", ")),
    }
}

/// Amounts of neighbouring knots of a curve as one: the same throughout, or along a straight line from one to another.
/// `None` of others, and of so few that they may as well be listed.
fn shape(knots: &[(usize, f64)], amount: &impl Fn(&(usize, f64)) -> f64, parameters: &[Parameter]) -> Option<String> {
    let ([(i, _), .., (j, _)], true) = (knots, knots.len() > 2) else { return None };
    let (curve, from) = parameters[*i].curve();
    let (from, to, unit) = (from?, parameters[*j].curve().1?, &parameters[*i].unit);
    let (first, last) = (amount(&knots[0]), amount(&knots[knots.len() - 1]));
    let all = parameters.iter().filter(|p| p.curve().0 == curve).count() == knots.len();
    let ends = (position(from)?, position(to)?);
    let largest = first.abs().max(last.abs());
    let on_line = |k: &(usize, f64)| {
        let at = parameters[k.0].curve().1.and_then(position)?;
        let line = first + (last - first) * (at - ends.0) / (ends.1 - ends.0);
        Some((amount(k) - line).abs() <= STRAIGHT * largest)
    };
    if !knots.iter().all(|k| on_line(k) == Some(true)) {
        return None;
    }
    if all && (last - first).abs() <= STRAIGHT * largest {
        return Some(format!("{curve} {} {unit} throughout", signed(first)));
    }
    Some(format!("{curve} {} {unit} at {from} to {} {unit} at {to}", signed(first), signed(last)))
}

/// The position of a knot, `b@125mm` or `125mm`.
fn position(knot: &str) -> Option<f64> {
    knot.trim_start_matches("b@").trim_end_matches(char::is_alphabetic).parse().ok()
}

fn signed(value: f64) -> String {
    let text = significant(value, 3);
    if text.starts_with('-') { text } else { format!("+{text}") }
}

/// Parameters named of a direction that the noise drowns: those with the largest part.
const MAX_NAMED: usize = 6;
/// A displacement of points (mm) above which an error is implausible for a machine: smaller parts are named.
const LARGE: f64 = 1.0;

/// The directions within the rank whose uncertainty is beyond use, each with what it amounts to: one standard deviation
/// along each, in units of displacement, and the columns' `scale` in these units. What changes nothing (`null`,
/// reduced) is
/// taken out of them.
pub(super) fn drowned(
    spreads: &[DVector<f64>],
    scale: &DVector<f64>,
    null: &[DVector<f64>],
    parameters: &[Parameter],
) -> Vec<String> {
    spreads.iter().map(|spread| hidden(&without(spread, null), scale, parameters)).collect()
}

/// A direction without the leading parameters of those that change nothing.
fn without(direction: &DVector<f64>, null: &[DVector<f64>]) -> DVector<f64> {
    null.iter().fold(direction.clone(), |rest, row| {
        let pivot = largest(row);
        &rest - row * (rest[pivot] / row[pivot])
    })
}

fn hidden(spread: &DVector<f64>, scale: &DVector<f64>, parameters: &[Parameter]) -> String {
    let effect = spread.component_mul(scale);
    let heard = effect.norm() * HEARD;
    let mut direction: Direction = above(spread, NAMED).into_iter().filter(|(j, _)| effect[*j].abs() > heard).collect();
    direction.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let most = direction.first().map_or(0.0, |(_, x)| x.abs());
    let share = if most > LARGE { LARGE / most } else { 1.0 };
    let amount = |(j, x): &(usize, f64)| {
        let p = &parameters[*j];
        format!("{} {}", signed(p.shown(x * share / p.size)), p.unit)
    };
    let hides = "of what the noise (one standard deviation) hides";
    if let [alone] = &direction[..] {
        let (name, amount) = (&parameters[alone.0].name, amount(alone));
        return match share < 1.0 {
            true => format!("{name} is hardly known: {amount} is {} {hides}", significant(share, 2)),
            false => format!("{name} is hardly known: the noise (one standard deviation) cannot be told from {amount}"),
        };
    }
    let others = direction.split_off(direction.len().min(MAX_NAMED)).len();
    let mut parts: Vec<String> =
        direction.iter().map(|part| format!("{} {}", parameters[part.0].name, amount(part))).collect();
    let mut names = names(&direction, parameters);
    let more = format!("{others} more");
    if others > 0 {
        names.push(&more);
        parts.push("...".to_owned());
    }
    let (parts, names) = (parts.join(", "), list(&names));
    if share < 1.0 {
        return format!("{names} are only known together: {parts} are {} {hides}", significant(share, 2));
    }
    format!("{names} are only known together: the noise (one standard deviation) cannot be told from {parts}")
}
