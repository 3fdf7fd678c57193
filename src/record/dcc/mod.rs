//! A digital calibration certificate: DCC 3.2.1 with D-SI 2.1.0, both of PTB. Text and order of the elements are in
//! `certificate.xml.j2`; the numbers go through [`QuantityTable::check`], for the schema checks neither units nor
//! lengths of lists.

mod quantity;

pub use quantity::{ListFault, QuantityList, QuantityTable, is_unit};

use super::{ErrorCurve, RecordData, RecordedCovariance, RecordedFigure, StateValue};
use crate::report::page::environment;
use crate::standards::{Conformity, NOT_VERIFIED};
use crate::units::significant;
use minijinja::value::Serde as ViaSerde;
use minijinja::{Value, context};
use quantity::WrittenList;

const TEMPLATE: &str = include_str!("certificate.xml.j2");

type WrittenTables = Vec<(String, Vec<WrittenList>)>;

/// Digits of a number.
const DIGITS: usize = 9;

const POSITION: &str = "basic_nominalValue";
const ERROR: &str = "basic_measurementError";

/// Reason why a certificate cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum DccFault {
    /// A table that is none.
    #[error(transparent)]
    List(ListFault),
    /// The template does not render.
    #[error(transparent)]
    Template(minijinja::Error),
}

/// Returns the certificate of a record.
///
/// Fails if a list has a unit that D-SI does not have, another length than its neighbours, or a number that cannot be
/// written.
pub fn certificate(data: &RecordData) -> Result<String, DccFault> {
    let states = [("found", "As found"), ("left", "As left")].map(|(state, name)| (state, name, tables(data, state)));
    let mut written: Vec<(&str, &str, WrittenTables)> = Vec::new();
    for (state, name, tables) in states {
        tables.iter().try_for_each(QuantityTable::check).map_err(DccFault::List)?;
        let tables = tables.iter().map(|table| (table.name.clone(), table.lists()));
        written.push((state, name, tables.collect()));
    }
    let figures = figures(data);
    figures.iter().try_for_each(QuantityTable::check).map_err(DccFault::List)?;
    written.push(("figures", "Figures", figures.iter().map(|table| (table.name.clone(), table.lists())).collect()));
    written.retain(|(_, _, tables)| !tables.is_empty());
    let temperatures = temperatures(data)?;
    let covariances: Vec<WrittenCovariance> = data.covariances.iter().map(WrittenCovariance::of).collect();
    let decisions: Vec<&str> = data.decisions.iter().map(|decision| conformity(decision.decision)).collect();
    let render = || {
        let context = context! {
            r => Value::from(ViaSerde(data)), states => Value::from(ViaSerde(&written)), decisions, temperatures,
            covariances => Value::from(ViaSerde(&covariances)),
            unverified => NOT_VERIFIED,
        };
        environment()?.template_from_str(TEMPLATE)?.render(context)
    };
    render().map_err(DccFault::Template)
}

/// A list of values with their covariance, as the certificate writes it.
#[derive(serde::Serialize)]
struct WrittenCovariance {
    state: &'static str,
    labels: String,
    values: String,
    units: String,
    /// Columns of elements, each a value and its unit.
    columns: Vec<Vec<(String, String)>>,
    factor: String,
}

impl WrittenCovariance {
    fn of(of: &RecordedCovariance) -> Self {
        let words = |word: &dyn Fn(usize) -> String| (0..of.errors.len()).map(word).collect::<Vec<_>>().join(" ");
        let label = |i: usize| match of.errors[i].position {
            None => of.errors[i].error.clone(),
            Some(position) => format!("{}({})", of.errors[i].error, significant(position, DIGITS)),
        };
        let element = |(i, j): (usize, usize)| {
            let product = format!("{}{}", unit(of.errors[i].unit), unit(of.errors[j].unit));
            (significant(of.covariance[i][j], DIGITS), product)
        };
        let column = |j: usize| (0..of.errors.len()).map(|i| element((i, j))).collect();
        Self {
            state: of.state,
            labels: words(&label),
            values: words(&|i| significant(of.errors[i].value, DIGITS)),
            units: words(&|i| unit(of.errors[i].unit).to_owned()),
            columns: (0..of.errors.len()).map(column).collect(),
            factor: significant(coverage_factor(of.errors.len()), 6),
        }
    }
}

/// The factor with which an ellipsoid of so many dimensions holds 95 %: root of the quantile of chi-squared, where its
/// distribution (the series of the incomplete gamma function) is 0.95.
fn coverage_factor(dimensions: usize) -> f64 {
    let a = dimensions as f64 / 2.0;
    let probability = |factor: f64| {
        let x = factor * factor / 2.0;
        let mut term = libm::exp(a * libm::log(x) - x - libm::lgamma(a + 1.0));
        let mut sum = 0.0;
        for k in 1..1000 {
            sum += term;
            term *= x / (a + f64::from(k));
        }
        sum
    };
    let (mut low, mut high) = (1.0, 2.0 + 2.0 * libm::sqrt(dimensions as f64));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if probability(middle) < 0.95 { low = middle } else { high = middle }
    }
    high
}

/// The word of the schema for a decision. Where nothing is proven neither a pass nor a failure is stated.
fn conformity(decision: Conformity) -> &'static str {
    match decision {
        Conformity::Conform => "pass",
        Conformity::NotConform => "fail",
        Conformity::Undecided => "noPass",
    }
}

/// Unit of D-SI of a unit of the record.
fn unit(name: &str) -> &'static str {
    match name {
        "um" => r"\micro\metre",
        "urad" => r"\micro\radian",
        "mm" => r"\milli\metre",
        "deg" => r"\degree",
        "degC" => r"\degreecelsius",
        "um/m" => r"\micro\metre\metre\tothe{-1}",
        _ => "",
    }
}

/// The tables of a state: location errors, a row each, then a table for every curve. Bounds and zeros of a datum are
/// not measured.
fn tables(data: &RecordData, state: &str) -> Vec<QuantityTable> {
    let curves: Vec<&ErrorCurve> = data.curves.iter().filter(|curve| curve.state == state).collect();
    let alone = data.errors.iter().filter_map(|row| {
        let value = if state == "found" { row.found } else { row.left.filter(|_| data.as_left.is_some()) }?;
        let curve = curves.iter().any(|curve| curve.error == row.error);
        (!curve && !value.bounded && !value.held).then(|| single(&row.error, &row.unit, value))
    });
    alone.chain(curves.iter().map(|curve| of_curve(curve))).collect()
}

fn single(error: &str, of: &str, value: StateValue) -> QuantityTable {
    let expanded = value.expanded_uncertainty.into_iter().collect();
    let list =
        QuantityList { name: error.to_owned(), ref_type: ERROR, unit: unit(of), values: vec![value.value], expanded };
    QuantityTable { name: error.to_owned(), lists: vec![list] }
}

fn of_curve(curve: &ErrorCurve) -> QuantityTable {
    let expanded = curve.expanded_uncertainty.map_or_else(Vec::new, |u| vec![u; curve.positions.len()]);
    let list = |name: String, ref_type, of: &str, values: &[f64], expanded: Vec<f64>| QuantityList {
        name,
        ref_type,
        unit: unit(of),
        values: values.to_vec(),
        expanded,
    };
    let positions = list(curve.axis.clone(), POSITION, curve.position_unit, &curve.positions, Vec::new());
    let error = |name, values| list(name, ERROR, curve.unit, values, expanded.clone());
    let lists = match &curve.reverse {
        None => vec![positions, error(curve.error.clone(), &curve.forward)],
        Some(reverse) => vec![
            positions,
            error(format!("{}, rising position", curve.error), &curve.forward),
            error(format!("{}, falling position", curve.error), reverse),
        ],
    };
    QuantityTable { name: curve.error.clone(), lists }
}

fn figures(data: &RecordData) -> Vec<QuantityTable> {
    let of = |(file, figure): (&str, &RecordedFigure)| QuantityTable {
        name: format!("{figure}, {file}", figure = figure.figure),
        lists: vec![QuantityList {
            name: figure.figure.to_string(),
            ref_type: "basic_measuredValue",
            unit: unit(figure.unit),
            values: vec![figure.value],
            expanded: figure.expanded_uncertainty.into_iter().collect(),
        }],
    };
    let all = data.figures.iter().flat_map(|of| of.values.iter().map(|figure| (of.copy.file.as_str(), figure)));
    all.map(of).collect()
}

fn temperatures(data: &RecordData) -> Result<Value, DccFault> {
    let of = |temperature: &super::Temperature| QuantityTable {
        name: temperature.name.to_string(),
        lists: vec![QuantityList {
            name: temperature.name.to_string(),
            ref_type: "basic_measuredValue",
            unit: unit("degC"),
            values: vec![temperature.deg_c],
            expanded: temperature.expanded_uncertainty_k.into_iter().collect(),
        }],
    };
    let tables: Vec<QuantityTable> = data.temperatures.iter().map(of).collect();
    tables.iter().try_for_each(QuantityTable::check).map_err(DccFault::List)?;
    let written: WrittenTables = tables.iter().map(|table| (table.name.clone(), table.lists())).collect();
    Ok(Value::from(ViaSerde(&written)))
}

#[cfg(test)]
mod tests {
    use super::coverage_factor;

    /// Quantiles of chi-squared at 95 %, of tables: 3.841, 5.991, 7.815, 18.307, 124.342.
    #[test]
    fn factors_are_those_of_tables() {
        for (dimensions, quantile) in [(1, 3.841), (2, 5.991), (3, 7.815), (10, 18.307), (100, 124.342)] {
            let found = coverage_factor(dimensions);
            assert!((found * found - quantile).abs() < 1e-3, "{dimensions}: {}", found * found);
        }
    }
}
