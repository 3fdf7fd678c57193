//! Every form of an error curve.

use super::beyond::Beyond;
use super::context::Context;
use super::curve_of::CurveOf;
use super::names::{in_other_letters, readings};
use super::short::beyond;
use crate::diagnostic::{Diagnostic, Place, codes, did_you_mean, shown};
use crate::machine::{AxisKind, BSpline, BSplineFailure, ComponentError, Curve, Knots, KnotsFailure, Travel};
use crate::syntax::{BSplineEntry, ColumnDirection, CsvColumn, CsvTable, CurveEntry, Keys, Scalar, below};
use crate::units::Dimension;
use std::rc::Rc;

/// Highest order of a harmonic, highest power of a polynomial.
const ORDERS: usize = 720;
const POWERS: usize = 20;
/// Rounding of positions (mm, deg).
const SLACK: f64 = 1e-9;

/// Returns a component error from one entry; a table may give it both directions.
pub fn component(context: &mut Context, of: &CurveOf<'_>, entry: &CurveEntry, at: &Keys) -> Option<ComponentError> {
    if let Some(path) = &entry.table {
        let here = below(at, "table");
        let (between, table) = (between(context, entry, at), context.table(&here, path));
        let named = context.document.places.value(&here);
        return from_table(context, of, &table?, between?, named);
    }
    curve(context, of, entry, at).map(ComponentError::Single)
}

/// Returns a curve of one direction.
pub fn one_way(
    context: &mut Context,
    of: &CurveOf<'_>,
    entry: &CurveEntry,
    at: &Keys,
    direction: ColumnDirection,
) -> Option<Curve> {
    let component = component(context, of, entry, at)?;
    Some(match (component, direction) {
        (ComponentError::Single(curve), _) => curve,
        (ComponentError::Bidirectional { forward, .. }, ColumnDirection::Forward) => forward,
        (ComponentError::Bidirectional { reverse, .. }, ColumnDirection::Reverse) => reverse,
    })
}

/// The course of a curve between its points and beyond them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Between {
    cubic: bool,
    beyond: Option<Beyond>,
}

fn between(context: &mut Context, entry: &CurveEntry, at: &Keys) -> Option<Between> {
    let beyond = context.beyond(entry.beyond.as_ref(), at);
    match entry.interpolation.as_deref() {
        None | Some("linear") => Some(Between { cubic: false, beyond }),
        Some("cubic") => Some(Between { cubic: true, beyond }),
        Some(other) => {
            let help = did_you_mean(other, &["linear", "cubic"]);
            let message = format!("`{}` is not a choice for `interpolation`", shown(other));
            context.at_value(codes::E0210, &below(at, "interpolation"), message, help);
            None
        }
    }
}

fn curve(context: &mut Context, of: &CurveOf<'_>, entry: &CurveEntry, at: &Keys) -> Option<Curve> {
    if let Some(points) = &entry.points {
        let between = between(context, entry, at);
        return from_points(context, of, points, between?, &below(at, "points"));
    }
    refuse_without_points(context, entry, at);
    if let Some(coefficients) = &entry.polynomial {
        return polynomial(context, of, coefficients, &below(at, "polynomial"));
    }
    if let Some(orders) = &entry.harmonics {
        return harmonics(context, of, orders, &below(at, "harmonics"));
    }
    if let Some(entry) = &entry.bspline {
        return bspline(context, of, entry, &below(at, "bspline"));
    }
    let value = context.error_value(entry.value.as_ref()?, of.error.direction, &context.value_of(at))? * of.sign();
    Some(if of.continuous() { Curve::Harmonics(vec![(value, 0.0)]) } else { Curve::Polynomial(vec![value]) })
}

/// Refuses keys that say how points are joined where there are none.
pub fn refuse_without_points(context: &mut Context, entry: &CurveEntry, at: &Keys) {
    let keys = [
        ("interpolation", "interpolate", entry.interpolation.is_some()),
        ("beyond", "continue", entry.beyond.is_some()),
    ];
    for (key, act, _) in keys.into_iter().filter(|(_, _, is_there)| *is_there) {
        let (message, help) =
            (format!("`{key}` has nothing to {act} here"), format!("`{key}` belongs to `table` or `points`"));
        context.at_key(codes::E0209, &below(at, key), message, help);
    }
}

fn polynomial(context: &mut Context, of: &CurveOf<'_>, list: &[Scalar], at: &Keys) -> Option<Curve> {
    if of.continuous() {
        let help = "axis without ends: use `harmonics`, or a table over [0 deg, 360 deg]";
        context.at_key(codes::E0408, at, format!("a polynomial for `{}` is not periodic", of.error), help);
        return None;
    }
    if list.is_empty() || list.len() > POWERS + 1 {
        let message = format!("a polynomial of {} coefficients", list.len());
        context.at_value(codes::E0408, at, message, format!("write 1 to {} coefficients, by rising power", POWERS + 1));
        return None;
    }
    let coefficients: Vec<Option<f64>> = list
        .iter()
        .enumerate()
        .map(|(k, scalar)| context.coefficient(scalar, of.error.direction, of.kind, k as i8, &below(at, k)))
        .collect();
    let coefficients = coefficients.into_iter().map(|c| Some(c? * of.sign())).collect::<Option<_>>()?;
    Some(Curve::Polynomial(coefficients))
}

fn harmonics(
    context: &mut Context,
    of: &CurveOf<'_>,
    orders: &indexmap::IndexMap<String, Vec<Scalar>>,
    at: &Keys,
) -> Option<Curve> {
    if of.kind == AxisKind::Linear {
        let help = "use `points` or a table; harmonics are of one turn of a rotary axis";
        context.at_key(codes::E0408, at, format!("axis `{}` is linear: it has no harmonics", of.error.axis), help);
        return None;
    }
    let mut list: Vec<(f64, f64)> = Vec::new();
    let mut whole = true;
    for (key, pair) in orders {
        let here = below(at, key);
        match harmonic(context, of, key, pair, &here) {
            Some((order, pair)) => {
                list.resize(list.len().max(order + 1), (0.0, 0.0));
                list[order] = pair;
            }
            None => whole = false,
        }
    }
    if list.is_empty() && whole {
        context.at_value(
            codes::E0408,
            at,
            "no harmonics are given",
            "write { 1: [2 urad, -1 urad] }: cosine and sine by order",
        );
        return None;
    }
    whole.then_some(Curve::Harmonics(list))
}

fn harmonic(
    context: &mut Context,
    of: &CurveOf<'_>,
    key: &str,
    pair: &[Scalar],
    at: &Keys,
) -> Option<(usize, (f64, f64))> {
    let order = key.parse::<usize>().ok().filter(|order| *order <= ORDERS);
    let (Some(order), [cosine, sine]) = (order, pair) else {
        let message = format!("`{}` is not a harmonic", shown(key));
        context.at_key(codes::E0408, at, message, format!("write ORDER: [cosine, sine], orders 0 to {ORDERS}"));
        return None;
    };
    let cosine = context.error_value(cosine, of.error.direction, &below(at, 0));
    let sine = context.error_value(sine, of.error.direction, &below(at, 1));
    let (cosine, sine) = (cosine? * of.sign(), sine? * of.sign());
    if order == 0 && sine != 0.0 {
        context.at_value(
            codes::E0408,
            &below(at, 1),
            "the sine of order 0 is not zero",
            "order 0 is the constant: [1 urad, 0 urad]",
        );
        return None;
    }
    Some((order, (cosine, sine)))
}

fn bspline(context: &mut Context, of: &CurveOf<'_>, entry: &BSplineEntry, at: &Keys) -> Option<Curve> {
    let (at_knots, at_coefficients) = (below(at, "knots"), below(at, "coefficients"));
    let knots: Vec<Option<f64>> = entry
        .knots
        .iter()
        .enumerate()
        .map(|(i, scalar)| context.position(scalar, of.kind, &below(&at_knots, i)))
        .collect();
    let coefficients: Vec<Option<f64>> = entry
        .coefficients
        .iter()
        .enumerate()
        .map(|(i, scalar)| context.error_value(scalar, of.error.direction, &below(&at_coefficients, i)))
        .collect();
    let coefficients = coefficients.into_iter().map(|c| Some(c? * of.sign())).collect::<Option<Vec<f64>>>()?;
    let pairs = knots.into_iter().map(|q| Some((q?, 0.0))).collect::<Option<_>>()?;
    let breaks: Vec<f64> = snap(pairs, of.axis.travel).into_iter().map(|pair| pair.0).collect();
    let degree = usize::from(entry.degree.unwrap_or(3));
    let place = |at: &Keys| context.document.places.value(at);
    match BSpline::new(degree, &breaks, &coefficients, of.continuous().then_some(360.0)) {
        Ok(spline) => {
            let _ = beyond(context, of, spline.breaks(), place(&at_knots), Some(Beyond::Refuse))?;
            Some(Curve::BSpline(Box::new(spline)))
        }
        Err(failure) => {
            let (message, place, help) = match failure {
                BSplineFailure::Degree => {
                    let help = "1 is straight between the knots, 3 (the default) is cubic";
                    (format!("a B-spline of degree {degree}"), place(&below(at, "degree")), help.to_owned())
                }
                BSplineFailure::Count(count) => {
                    let message = format!("`{}` has {} coefficients", of.error, coefficients.len());
                    let help = format!("{} knots and degree {degree} take {count}", breaks.len());
                    (message, place(&at_coefficients), help)
                }
                BSplineFailure::Breaks(failure) => {
                    let pairs: Vec<(f64, f64)> = breaks.iter().map(|q| (*q, 0.0)).collect();
                    let (message, at, help) = explain(&failure, of, &pairs, &|i| place(&below(&at_knots, i)));
                    (message, at.or(place(&at_knots)), help.to_owned())
                }
            };
            context.diagnostics.push(Diagnostic::new(codes::E0410, message).at(place, "").help(help));
            None
        }
    }
}

fn from_points(
    context: &mut Context,
    of: &CurveOf<'_>,
    points: &[Vec<Scalar>],
    between: Between,
    at: &Keys,
) -> Option<Curve> {
    let mut pairs = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let here = below(at, i);
        let [position, value] = &point[..] else {
            let help =
                if point.len() > 2 { "write [250 mm, 1.2 um], with decimal points" } else { "write [250 mm, 1.2 um]" };
            context.at_value(codes::E0410, &here, "a point has a position and a value", help);
            continue;
        };
        let position = context.position(position, of.kind, &below(&here, 0));
        let value = context.error_value(value, of.error.direction, &below(&here, 1));
        pairs.extend(position.zip(value));
    }
    if pairs.len() < points.len() {
        return None;
    }
    let places: Vec<Option<Place>> = (0..points.len()).map(|i| context.document.places.value(&below(at, i))).collect();
    knots(context, of, pairs, between, context.document.places.value(at), &|i| places.get(i).cloned().flatten())
}

/// Columns of the error in a table, both directions if they are apart.
pub fn from_table(
    context: &mut Context,
    of: &CurveOf<'_>,
    table: &Rc<CsvTable>,
    between: Between,
    named: Option<Place>,
) -> Option<ComponentError> {
    let positions = positions(context, of, table, &named)?;
    let column = |direction| table.columns[1..].iter().find(|c| c.direction == direction && carries(c, of));
    let forward = column(Some(ColumnDirection::Forward));
    let reverse = column(Some(ColumnDirection::Reverse));
    let mut curve = |column| from_column(context, of, table, &positions, column, between);
    match (column(None), forward, reverse) {
        (Some(both), None, None) => curve(both).map(ComponentError::Single),
        (None, Some(forward), Some(reverse)) => {
            let (forward, reverse) = (curve(forward), curve(reverse));
            Some(ComponentError::Bidirectional { forward: forward?, reverse: reverse? })
        }
        (None, None, None) => {
            missing(context, of, table, named);
            None
        }
        (Some(both), Some(other), _) | (Some(both), _, Some(other)) => {
            let refusal =
                Diagnostic::new(codes::E0407, format!("the table gives `{}` with and without direction", of.error));
            let refusal = refusal.at(Some(other.place.clone()), "").at(Some(both.place.clone()), "also given here");
            context.diagnostics.push(refusal.help("keep either the one column or the pair `+` and `-`"));
            None
        }
        (None, Some(one), None) | (None, None, Some(one)) => {
            let refusal = Diagnostic::new(codes::E0114, format!("`{}` is measured in one direction only", of.error));
            let help = "add the other direction's column, or drop the sign if the value holds for both";
            context.diagnostics.push(refusal.at(Some(one.place.clone()), "").help(help));
            None
        }
    }
}

fn carries(column: &CsvColumn, of: &CurveOf<'_>) -> bool {
    readings(&column.name).iter().any(|r| r.error == *of.error)
}

fn missing(context: &mut Context, of: &CurveOf<'_>, table: &CsvTable, named: Option<Place>) {
    let header = table.columns.first().map(|c| c.place.clone());
    let names: Vec<&str> = table.columns[1..].iter().map(|c| c.name.as_str()).collect();
    let help =
        format!("its columns are {}", names.iter().map(|n| format!("`{}`", shown(n))).collect::<Vec<_>>().join(", "));
    let refusal = Diagnostic::new(codes::E0114, format!("the table has no column `{}`", of.error));
    let header = header.filter(|h| named.as_ref().is_none_or(|n| n.source != h.source));
    context.diagnostics.push(refusal.at(named, "named here").at(header, "the table's header").help(help));
}

/// Returns the first column, in mm or deg.
fn positions(context: &mut Context, of: &CurveOf<'_>, table: &CsvTable, named: &Option<Place>) -> Option<Vec<f64>> {
    let first = table.columns.first()?;
    if first.name != of.error.axis.as_str() {
        let message = format!("the table's first column is `{}`, not the axis `{}`", shown(&first.name), of.error.axis);
        let help = format!("`{}` is a function of the position of `{}`", of.error, of.error.axis);
        let refusal =
            Diagnostic::new(codes::E0114, message).at(Some(first.place.clone()), "").at(named.clone(), "named here");
        context.diagnostics.push(refusal.help(help));
        return None;
    }
    let (wanted, unit) = match of.kind {
        AxisKind::Linear => (Dimension::LENGTH, "mm"),
        AxisKind::Rotary => (Dimension::ANGLE, "deg"),
    };
    let (written, factor, dimension) = &first.unit;
    if *dimension != wanted {
        let message = format!("the positions of axis `{}` are in `{}`", of.error.axis, shown(written));
        let refusal = Diagnostic::new(codes::E0205, message).at(Some(first.place.clone()), "");
        context.diagnostics.push(refusal.help(format!("they must be in {unit}")));
        return None;
    }
    let degrees = matches!(written.as_str(), "deg" | "°");
    let scale = |v: &f64| {
        if degrees {
            *v
        } else if of.kind == AxisKind::Rotary {
            (v * factor).to_degrees()
        } else {
            v * factor
        }
    };
    Some(first.values.iter().map(scale).collect())
}

fn from_column(
    context: &mut Context,
    of: &CurveOf<'_>,
    table: &CsvTable,
    positions: &[f64],
    column: &CsvColumn,
    between: Between,
) -> Option<Curve> {
    let (written, factor, dimension) = &column.unit;
    let rotation = of.error.direction.is_rotation();
    let fits = if rotation {
        [Dimension::ANGLE, Dimension::RATIO].contains(dimension)
    } else {
        *dimension == Dimension::LENGTH
    };
    if !fits {
        let wanted = if rotation { "an angle" } else { "a length" };
        let message = format!("`{}` is in `{}`, but {wanted} belongs here", of.error, shown(written));
        let help = if rotation { "write [urad] or [arcsec]" } else { "write [um] or [mm]" };
        let help = in_other_letters(&column.name).unwrap_or_else(|| help.to_owned());
        context.diagnostics.push(Diagnostic::new(codes::E0205, message).at(Some(column.place.clone()), "").help(help));
        return None;
    }
    let negated = readings(&column.name).iter().any(|r| r.error == *of.error && r.negated) != of.negated;
    let sign = if negated { -1.0 } else { 1.0 };
    let pairs = positions.iter().zip(&column.values).map(|(p, v)| (*p, v * factor * sign)).collect();
    knots(context, of, pairs, between, Some(column.place.clone()), &|i| table.rows.get(i).cloned())
}

/// Points to a curve that covers the travel.
fn knots(
    context: &mut Context,
    of: &CurveOf<'_>,
    pairs: Vec<(f64, f64)>,
    between: Between,
    place: Option<Place>,
    row: &dyn Fn(usize) -> Option<Place>,
) -> Option<Curve> {
    let period = of.continuous().then_some(360.0);
    let pairs = snap(pairs, of.axis.travel);
    match Knots::new(&pairs, period) {
        Ok(knots) => {
            let beyond = beyond(context, of, &knots, place, between.beyond)?;
            let curve = if between.cubic { Curve::cubic(knots) } else { Curve::Linear(knots) };
            let on = ends(of.axis.travel).filter(|_| beyond == Beyond::Slope);
            Some(on.and_then(|(min, max)| curve.continued(min, max)).unwrap_or(curve))
        }
        Err(failure) => {
            let (message, at, help) = explain(&failure, of, &pairs, row);
            context.diagnostics.push(Diagnostic::new(codes::E0410, message).at(at.or(place), "").help(help));
            None
        }
    }
}

fn ends(travel: Option<Travel>) -> Option<(f64, f64)> {
    match travel {
        Some(Travel::Range(min, max)) => Some((min, max)),
        _ => None,
    }
}

/// Ends that miss those of the travel only by rounding (deg to rad and back) are put there; on a continuous axis ends
/// whose values differ only by rounding become one.
fn snap(mut pairs: Vec<(f64, f64)>, travel: Option<Travel>) -> Vec<(f64, f64)> {
    let Some(first) = pairs.first().map(|p| p.0) else { return pairs };
    let (min, max) = ends(travel).unwrap_or((first, first + 360.0));
    let snap = |end: &mut f64, to: f64| *end = if (*end - to).abs() <= SLACK { to } else { *end };
    pairs.first_mut().into_iter().for_each(|p| snap(&mut p.0, min));
    pairs.last_mut().into_iter().for_each(|p| snap(&mut p.0, max));
    // 0.969 um and 969 nm are one value, whatever their last bits say.
    if let (Some((_, start)), Some((_, end)), None) = (pairs.first().copied(), pairs.last_mut(), ends(travel))
        && (*end - start).abs() <= SLACK * start.abs()
    {
        *end = start;
    }
    pairs
}

fn explain(
    failure: &KnotsFailure,
    of: &CurveOf<'_>,
    pairs: &[(f64, f64)],
    row: &dyn Fn(usize) -> Option<Place>,
) -> (String, Option<Place>, &'static str) {
    let ends = pairs.first().zip(pairs.last());
    let (first, last) = ends.map_or(((0.0, 0.0), (0.0, 0.0)), |(a, b)| (*a, *b));
    let (name, unit) = (of.error, of.kind.unit());
    match failure {
        KnotsFailure::Empty => (format!("`{name}` has no points"), None, "write at least one [position, value]"),
        KnotsFailure::NotIncreasing(i) => (
            format!("the positions of `{name}` do not rise here"),
            row(*i),
            "sort the points by position, each position once",
        ),
        KnotsFailure::TooNear(i) => (
            format!("two positions of `{name}` are nearer than {:e} {unit}", Knots::NEAREST),
            row(*i),
            "leave one of them out",
        ),
        KnotsFailure::TooFar(i) => (
            format!("`{name}` is given at {:e} {unit}, which no machine reaches", pairs.get(*i).map_or(0.0, |p| p.0)),
            row(*i),
            "check the unit of the positions",
        ),
        KnotsFailure::NotOnePeriod => (
            format!("`{name}` goes from {} to {} deg, which is not one turn", first.0, last.0),
            row(pairs.len().saturating_sub(1)),
            "an axis without ends needs its curve from 0 to 360 deg",
        ),
        KnotsFailure::EndsDiffer => (
            format!("`{name}` does not close: its values at {} and {} deg differ", first.0, last.0),
            row(pairs.len().saturating_sub(1)),
            "0 and 360 deg are the same position: write the same value at both",
        ),
        KnotsFailure::NotFinite(i) => (format!("a point of `{name}` is not finite"), row(*i), "write finite numbers"),
    }
}
