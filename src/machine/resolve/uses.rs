//! The sections `algebra` and `identify`: they stay in the document for later stages; here the
//! error names and words in them are checked.

use super::axes::Declared;
use super::context::Context;
use super::errors::named;
use crate::diagnostic::{did_you_mean, shown};
use crate::machine::AxisName;
use crate::syntax::{GeneratorsEntry, Keys, below, keys};

/// Highest degree of the algebra.
const DEGREE: u8 = 6;
/// Groups that may be fitted.
const GROUPS: [&str; 5] = ["location", "tool", "workpiece", "spindle", "linear"];
/// Families of basis functions, each with its order behind it.
const BASES: [&str; 3] = ["poly", "fourier", "spline"];

/// Which errors there may be.
pub struct Known<'a> {
    pub declared: &'a [Declared],
    pub spindle: Option<&'a AxisName>,
}

impl Known<'_> {
    /// The axis of this name, if it is declared.
    pub fn axis(&self, name: &AxisName) -> Option<&Declared> {
        self.declared.iter().find(|d| d.name == *name)
    }

    /// Reports a name that is none.
    fn error(&self, context: &mut Context<'_>, name: &str, at: &Keys) {
        let place = context.document.places.value(at);
        let _ = named(context, name, self, place);
    }
}

/// The section `algebra`.
pub fn algebra(context: &mut Context<'_>, known: &Known<'_>) {
    let Some(entry) = &context.document.algebra else { return };
    let at = keys(["algebra"]);
    if let Some(degree) = entry.degree.filter(|d| !(1..=DEGREE).contains(d)) {
        let message = format!("an algebra of degree {degree}");
        context.at_value("E0215", &below(&at, "degree"), message, format!("write 1 to {DEGREE}"));
    }
    let here = below(&at, "generators");
    let mut groups: Vec<&str> = Vec::new();
    match &entry.generators {
        Some(GeneratorsEntry::Word(word)) => {
            let words = ["per-error", "per-axis", "single"];
            if !words.contains(&word.as_str()) {
                let message = format!("`{}` is not a choice for `generators`", shown(word));
                context.at_value("E0210", &here, message, did_you_mean(word, &words));
            }
        }
        Some(GeneratorsEntry::Groups(map)) => {
            groups = map.keys().map(String::as_str).collect();
            for (group, names) in map {
                let list = below(&here, group);
                names.iter().enumerate().for_each(|(i, name)| known.error(context, name, &below(&list, i)));
            }
        }
        None => {}
    }
    for (i, monomial) in entry.vanish.iter().enumerate() {
        vanishing(context, known, monomial, &groups, &below(&below(&at, "vanish"), i));
    }
}

/// `EXX*EYX`, `EXX^2`: names of errors or groups with powers.
fn vanishing(context: &mut Context<'_>, known: &Known<'_>, monomial: &str, groups: &[&str], at: &Keys) {
    for factor in monomial.split('*') {
        let (name, power) = factor.trim().split_once('^').unwrap_or((factor.trim(), "1"));
        if name.trim().is_empty() || !power.trim().parse::<u8>().is_ok_and(|p| (1..=DEGREE).contains(&p)) {
            let message = format!("`{}` is not a monomial", shown(monomial));
            return context.at_value(
                "E0215",
                at,
                message,
                "write names with `*` and `^`, such as `EXX*EYX` or `EXX^2`",
            );
        }
        if !groups.contains(&name.trim()) {
            known.error(context, name.trim(), at);
        }
    }
}

/// The section `identify`.
pub fn identify(context: &mut Context<'_>, known: &Known<'_>) {
    let Some(entry) = &context.document.identify else { return };
    for (key, list) in [("fit", &entry.fit), ("fixed", &entry.fixed)] {
        for (i, text) in list.iter().enumerate() {
            let at = below(&keys(["identify", key]), i);
            let (name, form) = text.split_once(':').map_or((text.as_str(), None), |(n, f)| (n, Some(f)));
            if let Some(form) = form {
                basis(context, form, &at);
            }
            if !GROUPS.contains(&name) {
                fit(context, known, name, &at);
            }
        }
    }
    for (name, form) in &entry.basis {
        let at = keys(["identify", "basis", name]);
        let place = context.document.places.key(&at);
        let _ = named(context, name, known, place);
        basis(context, form, &at);
    }
}

/// A word near a group is meant as one.
fn fit(context: &mut Context<'_>, known: &Known<'_>, name: &str, at: &Keys) {
    match crate::diagnostic::nearest(name, GROUPS) {
        Some(near) => {
            let message = format!("`{}` is neither an error nor a group", shown(name));
            context.at_value("E0405", at, message, format!("did you mean `{near}`?"));
        }
        None => known.error(context, name, at),
    }
}

/// `poly3`, `fourier2`, `spline8`.
fn basis(context: &mut Context<'_>, form: &str, at: &Keys) {
    let order = BASES.iter().find_map(|family| form.trim().strip_prefix(family));
    if !order.and_then(|o| o.parse::<u8>().ok()).is_some_and(|o| (1..=50).contains(&o)) {
        let message = format!("`{}` is not a basis", shown(form));
        context.at_value(
            "E0215",
            at,
            message,
            "write poly3 (powers 0 to 3), fourier2 (orders 0 to 2) or spline8 (8 knots)",
        );
    }
}
