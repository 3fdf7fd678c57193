//! The joint covariance of errors: independent parts, each written like the errors themselves.

use super::context::{Context, dotted};
use super::errors::{Errors, named, once, term};
use super::parts::setup_at;
use super::uses::JointNames;
use crate::diagnostic::codes;
use crate::machine::JointUncertainty;
use crate::syntax::{CovarianceEntry, below, keys};

/// Reads the section `covariance`.
pub fn covariance(context: &mut Context<'_>, known: &JointNames<'_>) -> Vec<JointUncertainty> {
    let document = context.document;
    let section = keys(["covariance"]);
    let (count, most) = (document.covariance.len(), JointUncertainty::MOST);
    if count > most {
        let message = format!("`covariance` has {count} parts; {most} are read at most");
        context.at_key(codes::E0202, &section, message, "leave out the parts that change no printed digit");
        return Vec::new();
    }
    document.covariance.iter().enumerate().map(|(i, entry)| part(context, known, i, entry)).collect()
}

fn part(context: &mut Context<'_>, known: &JointNames<'_>, index: usize, entry: &CovarianceEntry) -> JointUncertainty {
    let here = below(&keys(["covariance"]), index);
    let mut errors = Errors::default();
    for (name, entry) in &entry.errors {
        let at = below(&below(&here, "errors"), name);
        let place = context.document.places.key(&at);
        let Some(spelling) = named(context, name, known, place.clone()) else { continue };
        if entry.tolerance.is_some() || entry.uncertainty.is_some() {
            let message = format!("`{}` is itself an uncertainty", dotted(&at));
            context.at_key(codes::E0209, &at, message, "write one standard uncertainty as a value or a curve");
            continue;
        }
        if once(context, &mut errors, &spelling.error, place) {
            let term = term(context, &spelling, entry, known, &at);
            errors.put(&spelling.error, term);
        }
    }
    let setup = entry.setup.as_ref().map(|setup| setup_at(context, setup, &below(&here, "setup")));
    JointUncertainty { errors: errors.joints, setup: setup.unwrap_or_default() }
}
