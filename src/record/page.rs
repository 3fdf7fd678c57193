//! The record of a calibration as one page for print: no script, nothing loaded, the same bytes every time.

use super::RecordData;
use crate::machine::Machine;
use crate::report::axis_curves;
use crate::report::page::source_hash;
use crate::units::significant;
use minijinja::value::Serde as ViaSerde;
use minijinja::{AutoEscape, Environment, UndefinedBehavior, Value, context};

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

/// Returns an environment of templates in which text is escaped for HTML and XML.
pub(crate) fn environment() -> Result<Environment<'static>, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let syntax = minijinja::syntax::SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?;
    environment.set_syntax(syntax);
    environment.add_filter("digits", digits);
    Ok(environment)
}

/// Returns the page.
///
/// Fails if the template does not render.
pub fn record_page(data: &RecordData, pictures: &RecordPictures) -> Result<String, minijinja::Error> {
    let mut environment = environment()?;
    environment.add_template("record.html", TEMPLATE)?;
    let page = context! {
        r => Value::from(ViaSerde(data)), pictures => Value::from(ViaSerde(pictures)), style => STYLE,
        policy => format!("default-src 'none'; style-src {}; base-uri 'none'; form-action 'none'", source_hash(STYLE)),
        unverified => crate::standards::NOT_VERIFIED,
    };
    environment.get_template("record.html")?.render(page)
}

/// A number with at most so many significant digits and a real minus; a dash if there is none.
fn digits(value: Value, digits: usize) -> Result<String, minijinja::Error> {
    if value.is_undefined() || value.is_none() {
        return Ok("–".to_owned());
    }
    Ok(significant(f64::try_from(value)?, digits).replace('-', "−"))
}
