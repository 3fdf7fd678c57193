//! A digital calibration certificate: DCC 3.2.1 with D-SI 2.1.0, both of PTB. Text and order of the elements are in
//! `certificate.xml.j2`; the numbers go through [`QuantityTable::check`], for the schema checks neither units nor
//! lengths of lists.

mod quantity;

pub use quantity::{ListFault, QuantityList, QuantityTable, is_unit};

use super::{ErrorCurve, RecordData, RecordedFigure, StateValue};
use crate::report::page::environment;
use crate::standards::{Conformity, NOT_VERIFIED};
use minijinja::value::Serde as ViaSerde;
use minijinja::{Value, context};
use quantity::WrittenList;

const TEMPLATE: &str = include_str!("certificate.xml.j2");

type WrittenTables = Vec<(String, Vec<WrittenList>)>;

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
    let decisions: Vec<&str> = data.decisions.iter().map(|decision| conformity(decision.decision)).collect();
    let render = || {
        let context = context! {
            r => Value::from(ViaSerde(data)), states => Value::from(ViaSerde(&written)), decisions, temperatures,
            unverified => NOT_VERIFIED,
        };
        environment()?.template_from_str(TEMPLATE)?.render(context)
    };
    render().map_err(DccFault::Template)
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

/// The tables of a state: location errors, a row each, then a table for every curve. Bounds are not measured.
fn tables(data: &RecordData, state: &str) -> Vec<QuantityTable> {
    let curves: Vec<&ErrorCurve> = data.curves.iter().filter(|curve| curve.state == state).collect();
    let alone = data.errors.iter().filter_map(|row| {
        let value = if state == "found" { row.found } else { row.left.filter(|_| data.as_left.is_some()) }?;
        let curve = curves.iter().any(|curve| curve.error == row.error);
        (!curve && !value.bounded).then(|| single(&row.error, &row.unit, value))
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
