//! The residual that a record promises of an installed set: the interval of its certificate, and the reversal that was
//! measured and is not in the model behind the certificate.

use super::data::{PromisedResidual, UnheldReversal};
use super::decisions::Figures;
use crate::job::machine_file::MachineFile;
use crate::machine::{ComponentError, ErrorFamily, ErrorId, ErrorTerm, Machine, parse_error_name};
use serde_json::Value;

/// Coverage factor of an expanded uncertainty.
const COVERAGE: f64 = 2.0;

/// Returns the residual that a certificate of `verify` allows to promise; `None` if it is none.
pub(crate) fn promised(file: &MachineFile, figures: &[Figures], verify: &Value) -> Option<PromisedResidual> {
    let number = |pointer: &str| verify.pointer(pointer).and_then(Value::as_f64);
    let end = |i: usize| number(&format!("/uncertainty/compensated/position_um/p95/{i}"));
    let interval_um = end(0).zip(end(1)).map(|(low, high)| [low, high]);
    let unheld = unheld(file, figures);
    let mut sums = [0.0; 3];
    for (id, reversal) in &unheld {
        sums[id.direction.index()] += reversal.um;
    }
    let together = sums.iter().fold(0.0, |all, sum| libm::hypot(all, *sum));
    Some(PromisedResidual {
        model_um: number("/compensated/position_um/p95")?,
        interval_um,
        type_b: file.identify.as_ref().map(|of| of.type_b.clone()).unwrap_or_default(),
        reversals: unheld.into_iter().map(|(_, reversal)| reversal).collect(),
        within_um: interval_um.map(|[_, high]| high + together),
    })
}

/// The largest reversal of each linear component error that the machine gives no curve for each direction.
fn unheld(machine: &Machine, figures: &[Figures]) -> Vec<(ErrorId, UnheldReversal)> {
    let mut all: Vec<(ErrorId, UnheldReversal)> = Vec::new();
    for (error, um, file) in figures.iter().flat_map(measured) {
        let Some(id) = parse_error_name(&error).filter(|id| id.family == ErrorFamily::Component) else { continue };
        let both = |term: &ErrorTerm| matches!(term, ErrorTerm::Component(ComponentError::Bidirectional { .. }));
        if id.direction.index() > 2 || machine.errors().any(|(given, term)| given == id && both(term)) {
            continue;
        }
        match all.iter_mut().find(|(known, _)| *known == id) {
            Some((_, known)) if known.um >= um => {}
            Some((_, known)) => (known.um, known.file) = (um, file.to_owned()),
            None => all.push((id, UnheldReversal { error, um, file: file.to_owned() })),
        }
    }
    all
}

/// Reversals (um) in a document of `import` or of a circle, each with its uncertainty added.
fn measured(of: &Figures) -> Vec<(String, f64, &str)> {
    let document = &of.document;
    if document["test"] == "circle" {
        let plane = document["plane"].as_str().unwrap_or_default();
        let reversal = |(i, axis): (usize, char)| {
            let cause = &document["causes"]["reversal_um"][i];
            let um = cause["value"].as_f64()?.abs() + COVERAGE * cause["sigma"].as_f64().unwrap_or(0.0);
            Some((format!("E{axis}{axis}"), um, of.file.as_str()))
        };
        return plane.chars().enumerate().filter_map(reversal).collect();
    }
    let errors = document["errors"].as_array().filter(|_| document["test"].is_null());
    let reversal = |error: &Value| {
        let um = error["B"].as_f64()? + error["U"]["B"].as_f64().unwrap_or(0.0);
        (error["unit"] == "um").then_some((error["error"].as_str()?.to_owned(), um, of.file.as_str()))
    };
    errors.into_iter().flatten().filter_map(reversal).collect()
}
