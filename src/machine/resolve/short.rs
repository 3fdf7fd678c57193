//! Curves that stop short of the travel: the last value holds beyond, or the last slope goes on.

use super::beyond::{Beyond, ShortCurve};
use super::context::Context;
use super::curve_of::CurveOf;
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::machine::{AxisKind, AxisName, Knots, Travel};
use crate::syntax::{Document, Scalar, TravelEntry};
use crate::units::{self, significant};
use std::collections::BTreeMap;

/// Part of the measured range up to which a curve goes on beyond either end. Laser interferometers stop a few
/// millimetres short of the ends, for overrun and fixtures; more than a tenth is a part of the axis that nobody
/// measured.
const MOST_BEYOND: f64 = 0.1;
/// Rounding of that part.
const ROUNDING: f64 = 1e-9;

/// Returns the course of a curve beyond its points, notes it if there is anything beyond, and refuses a curve that
/// leaves too much of the travel.
pub fn beyond(
    context: &mut Context,
    of: &CurveOf<'_>,
    knots: &Knots,
    place: Option<Place>,
    stated: Option<Beyond>,
) -> Option<Beyond> {
    let &CurveOf { error, kind, axis, .. } = of;
    let Some(Travel::Range(min, max)) = axis.travel else { return Some(Beyond::Hold) };
    let measured = (*knots.positions().first()?, *knots.positions().last()?);
    let (first, last) = measured;
    if first <= min && last >= max {
        return Some(Beyond::Hold);
    }
    let stated = stated.or(axis.beyond);
    let (beyond, most) = (stated.unwrap_or(Beyond::Hold), MOST_BEYOND * (last - first));
    let travel_place = context.document.places.value(&axis.travel_entry());
    if beyond != Beyond::Refuse && (first - min).max(max - last) <= most * (1.0 + ROUNDING) {
        let (error, travel) = (error.clone(), (min, max));
        let is_stated = stated.is_some();
        let short = ShortCurve { error, kind, measured, travel, beyond, is_stated, place, travel_place };
        if !context.short.contains(&short) {
            context.short.push(short);
        }
        return Some(beyond);
    }
    let unit = kind.unit();
    let message = format!(
        "`{}` is given from {first} to {last} {unit}, but axis `{}` travels from {min} to {max} {unit}",
        error, error.axis
    );
    let of_other = travels(context.document)
        .find(|(name, (low, high))| *name != error.axis.as_str() && (low - first).abs() + (high - last).abs() < 1e-6);
    let of_other = of_other.filter(|_| kind == AxisKind::Linear).map(|(other, _)| {
        let letters = error.to_string();
        let meant = letters.strip_suffix(error.axis.as_str()).unwrap_or_default();
        format!("that is the travel of `{other}`: is it `{meant}{other}`?")
    });
    let help = if let Some(help) = of_other {
        help
    } else if kind == AxisKind::Linear && last > first && 1e3 * (last - first) <= max - min {
        "each point is [position, value]: are the two exchanged, or positions in metres?".to_owned()
    } else if beyond == Beyond::Refuse {
        "measure the rest or shorten the travel; nothing is extrapolated".to_owned()
    } else {
        format!(
            "measure the rest or shorten the travel; at most {most} {unit}, a tenth, go on beyond either end",
            most = significant(most, 6)
        )
    };
    let refusal = Diagnostic::new(codes::E0409, message).at(place, "").at(travel_place, "the travel");
    context.diagnostics.push(refusal.help(help));
    None
}

/// The stated travels in mm of axes with two ends, by name.
fn travels(document: &Document) -> impl Iterator<Item = (&str, (f64, f64))> {
    let mm = |end: &Scalar| match end {
        Scalar::Number(mm) => Some(*mm),
        Scalar::Text(text) => units::number(text).ok().or_else(|| Some(units::quantity(text).ok()?.value)),
    };
    document.axes.iter().filter_map(move |(name, entry)| match entry.as_ref()?.travel.as_ref()? {
        TravelEntry::Range(ends) => match &ends[..] {
            [min, max] => Some((name.as_str(), (mm(min)?, mm(max)?))),
            _ => None,
        },
        TravelEntry::Word(_) => None,
    })
}

/// Warns of curves that go on beyond their points where the file does not say so, once for curves of one range, and
/// narrows the measured ranges of axes to those of curves whose slope goes on.
pub fn report(context: &mut Context, measured: &mut BTreeMap<AxisName, (f64, f64)>) {
    let all = std::mem::take(&mut context.short);
    for short in all.iter().filter(|short| short.beyond == Beyond::Slope) {
        let range = measured.entry(short.error.axis.clone()).or_insert(short.measured);
        *range = (range.0.max(short.measured.0), range.1.min(short.measured.1));
    }
    let alike = |a: &ShortCurve, b: &ShortCurve| {
        a.error.axis == b.error.axis && (a.measured, a.travel, a.is_stated) == (b.measured, b.travel, b.is_stated)
    };
    for (i, short) in all.iter().enumerate().filter(|(_, short)| !short.is_stated) {
        if all[..i].iter().any(|other| alike(other, short)) {
            continue;
        }
        let mut names: Vec<String> =
            all.iter().filter(|other| alike(other, short)).map(|other| format!("`{}`", other.error)).collect();
        names.dedup();
        let ((first, last), (min, max), unit) = (short.measured, short.travel, short.kind.unit());
        let (verb, hold) =
            if names.len() == 1 { ("is", "it holds its last value") } else { ("are", "they hold their last values") };
        let message = format!(
            "{} {verb} given from {first} to {last} {unit} of a travel from {min} to {max} {unit}: {hold} beyond",
            names.join(", ")
        );
        let help = "say so by `beyond: hold` beside the curve or the axis; `slope` goes on straight, `refuse` does not";
        let warning = Diagnostic::new(codes::W0412, message).at(short.place.clone(), "");
        context.diagnostics.push(warning.at(short.travel_place.clone(), "the travel").help(help));
    }
}
