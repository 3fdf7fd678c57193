//! The record of a calibration as one page for print: no script, nothing loaded, the same bytes every time.

use super::RecordData;
use crate::machine::Machine;
use crate::report::axis_curves;
use crate::report::page::{environment, source_hash};
use minijinja::value::Serde as ViaSerde;
use minijinja::{Value, context};

const TEMPLATE: &str = include_str!("record.html.j2");
const STYLE: &str = include_str!("style.css");

/// Pictures of a record: a heading and SVG text each.
pub type RecordPictures = Vec<(String, String)>;

/// Returns the curves of every axis that has some, as found and as left.
pub fn record_pictures(found: &Machine, left: Option<&Machine>) -> RecordPictures {
    let of = |state: &'static str, machine: &Machine| -> RecordPictures {
        let axes = machine.axes().iter().enumerate();
        let drawn = axes.filter_map(|(i, axis)| {
            Some((format!("Component errors of {}, as {state}", axis.name), axis_curves(machine, i)?.svg()))
        });
        drawn.collect()
    };
    let left = left.map_or_else(RecordPictures::new, |left| of("left", left));
    of("found", found).into_iter().chain(left).collect()
}

/// Returns the page.
///
/// Fails if the template does not render.
pub fn record_page(data: &RecordData, pictures: &RecordPictures) -> Result<String, minijinja::Error> {
    let page = context! {
        r => Value::from(ViaSerde(data)), pictures => Value::from(ViaSerde(pictures)), style => STYLE,
        policy => format!("default-src 'none'; style-src {}; base-uri 'none'; form-action 'none'", source_hash(STYLE)),
        unverified => crate::standards::NOT_VERIFIED,
    };
    environment()?.template_from_str(TEMPLATE)?.render(page)
}
