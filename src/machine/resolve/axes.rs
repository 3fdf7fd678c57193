//! Axes: kind, direction, origin, travel.

use super::context::{Context, dotted};
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::{AxisKind, AxisName, Sense, Travel};
use crate::syntax::{AxisEntry, Keys, Scalar, TravelEntry, below, keys};

/// An axis as far as its entry could be understood; it may be outside the chain.
#[derive(Debug, Clone)]
pub struct AxisDraft {
    pub name: AxisName,
    pub kind: Option<AxisKind>,
    pub direction: Option<[f64; 3]>,
    pub origin: Option<[f64; 3]>,
    pub travel: Option<Travel>,
    pub sense: Option<Sense>,
}

/// All axes that are declared.
pub fn axes(context: &mut Context<'_>) -> Vec<AxisDraft> {
    let document = context.document;
    document.axes.iter().filter_map(|(name, entry)| axis(context, name, entry.as_ref())).collect()
}

fn axis(context: &mut Context<'_>, name: &str, entry: Option<&AxisEntry>) -> Option<AxisDraft> {
    let at = keys(["axes", name]);
    let Some(name) = AxisName::new(name) else {
        let help = "a name is a capital letter, then up to seven capitals or digits: X, C1, J6";
        context.at_key(codes::E0306, &at, format!("`{}` is not the name of an axis", shown(name)), help);
        return None;
    };
    let unknown =
        AxisDraft { name: name.clone(), kind: None, direction: None, origin: None, travel: None, sense: None };
    let Some(entry) = entry else { return Some(unknown) };
    let kind = kind(context, &name, entry, &at);
    let travel = kind.and_then(|kind| travel(context, &name, kind, entry, &at));
    let sense = match &entry.sense {
        Some(word) => context.choice::<Sense>(word, &below(&at, "sense"), &["iso841", "direct"]),
        None => None,
    };
    let origin = match &entry.origin {
        Some(list) => context.vector(list, &below(&at, "origin")),
        None => Some([0.0; 3]),
    };
    let direction = direction(context, &name, entry, &at);
    Some(AxisDraft { kind, direction, origin, travel, sense, ..unknown })
}

/// The meaning of a letter (with digits after it): X, Y, Z, U, V, W, P, Q, R are linear, A, B, C rotary.
fn by_letter(name: &AxisName) -> Option<(AxisKind, [f64; 3])> {
    let mut chars = name.as_str().chars();
    let letter = chars.next()?;
    if !chars.all(|c| c.is_ascii_digit()) {
        return None;
    }
    let unit = |i: usize| std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
    let linear = ["XUP", "YVQ", "ZWR"].iter().position(|group| group.contains(letter));
    let rotary = ['A', 'B', 'C'].iter().position(|l| *l == letter);
    linear.map(|i| (AxisKind::Linear, unit(i))).or(rotary.map(|i| (AxisKind::Rotary, unit(i))))
}

fn kind(context: &mut Context<'_>, name: &AxisName, entry: &AxisEntry, at: &Keys) -> Option<AxisKind> {
    if let Some(word) = &entry.kind {
        let here = below(at, "kind");
        return match word.as_str() {
            "linear" => Some(AxisKind::Linear),
            "rotary" => Some(AxisKind::Rotary),
            _ => {
                let help = did_you_mean(word, &["linear", "rotary"]);
                context.at_value(codes::E0210, &here, format!("`{}` is not a kind of axis", shown(word)), help);
                None
            }
        };
    }
    let kind = by_letter(name).map(|d| d.0);
    if kind.is_none() && !context.document.places.is_marred(&below(at, "kind")) {
        let help = "add `kind: linear` or `kind: rotary`, and a `direction`";
        context.at_key(codes::E0401, at, format!("axis `{name}` has no default kind and direction"), help);
    }
    kind
}

fn direction(context: &mut Context<'_>, name: &AxisName, entry: &AxisEntry, at: &Keys) -> Option<[f64; 3]> {
    let here = below(at, "direction");
    let Some(list) = &entry.direction else {
        let default = by_letter(name);
        let word = entry.kind.as_deref().unwrap_or("");
        let agrees = default.filter(|(kind, _)| word.is_empty() || (*kind == AxisKind::Linear) == (word == "linear"));
        if agrees.is_none() && entry.kind.is_some() && !context.document.places.is_marred(&here) {
            let help = "add its unit vector in machine coordinates, such as `direction: [0, 0, 1]`";
            context.at_key(codes::E0401, at, format!("axis `{name}` has no `direction`"), help);
        }
        return agrees.map(|d| d.1);
    };
    let numbers: Vec<f64> =
        list.iter().filter_map(|s| if let Scalar::Number(n) = s { Some(*n) } else { None }).collect();
    let help = "write three plain numbers, not all zero: [0, 1, 1] is 45 deg between Y and Z";
    if list.len() != 3 || numbers.len() != 3 || !numbers.iter().all(|n| n.is_finite()) {
        context.at_value(
            codes::E0402,
            &here,
            format!("the direction of axis `{name}` is not three plain numbers"),
            help,
        );
        return None;
    }
    let largest = numbers.iter().fold(0.0_f64, |m, n| m.max(n.abs()));
    if largest == 0.0 {
        context.at_value(codes::E0402, &here, format!("the direction of axis `{name}` is zero"), help);
        return None;
    }
    // Scaled first: squares of 1e200 overflow, of 1e-200 vanish.
    let scaled = [numbers[0] / largest, numbers[1] / largest, numbers[2] / largest];
    let norm = scaled.iter().map(|n| n * n).sum::<f64>().sqrt();
    Some(scaled.map(|n| n / norm))
}

fn travel(context: &mut Context<'_>, name: &AxisName, kind: AxisKind, entry: &AxisEntry, at: &Keys) -> Option<Travel> {
    let here = below(at, "travel");
    match &entry.travel {
        None => {
            if !context.document.places.is_marred(at) {
                let help = match kind {
                    AxisKind::Linear => "add `travel: [0 mm, 500 mm]`",
                    AxisKind::Rotary => "add `travel: [-120 deg, 30 deg]` or `travel: continuous`",
                };
                context.at_key(codes::E0203, at, format!("axis `{name}` has no `travel`"), help);
            }
            None
        }
        Some(TravelEntry::Word(word)) if word == "continuous" && kind == AxisKind::Rotary => Some(Travel::Continuous),
        Some(TravelEntry::Word(word)) => {
            let help = if word == "continuous" {
                "a linear axis has two ends: [0 mm, 500 mm]"
            } else {
                "write [min, max] or continuous"
            };
            let message = format!("`{}` is not a travel of axis `{name}`", shown(word));
            context.at_value(codes::E0403, &here, message, help);
            None
        }
        Some(TravelEntry::Range(list)) => {
            let (min, max) = context.interval(list, kind, &here)?;
            Some(Travel::Range(min, max))
        }
    }
}

impl Context<'_> {
    /// `[min, max]`, rising.
    pub fn interval(&mut self, list: &[Scalar], kind: AxisKind, at: &Keys) -> Option<(f64, f64)> {
        let unit = if kind == AxisKind::Linear { "mm" } else { "deg" };
        let [min, max] = list else {
            let message = format!("`{}` has {} numbers, an interval has two", dotted(at), list.len());
            self.at_value(codes::E0403, at, message, format!("write [min, max] in {unit}"));
            return None;
        };
        let (min, max) = (self.position(min, kind, &below(at, 0)), self.position(max, kind, &below(at, 1)));
        let (min, max) = (min?, max?);
        if min >= max {
            let (what, help) = if min == max {
                ("is empty", format!("write [min, max] with max above min, in {unit}"))
            } else {
                ("runs backwards", format!("write the smaller end first: [{max} {unit}, {min} {unit}]"))
            };
            let message = format!("`{}` {what}: from {min} {unit} to {max} {unit}", dotted(at));
            self.at_value(codes::E0403, at, message, help);
            return None;
        }
        Some((min, max))
    }

    /// A word that stands for a choice.
    pub fn choice<T: serde::de::DeserializeOwned>(&mut self, word: &str, at: &Keys, words: &[&str]) -> Option<T> {
        let name = at.last().map_or("", String::as_str);
        let value = words.contains(&word).then(|| T::deserialize(serde_yaml::Value::from(word)).ok()).flatten();
        if value.is_none() {
            let help = did_you_mean(word, words);
            self.at_value(codes::E0210, at, format!("`{}` is not a choice for `{name}`", shown(word)), help);
        }
        value
    }
}
