//! Characteristics of features as text, for `map` and `budget`.

use super::view::table;
use abbe::results::{CharacteristicResult, DrawnCharacteristic};
use abbe::text::{ends, shown, significant, within};

/// The table of the characteristics by values or by machines drawn, and the errors that make them; empty without.
pub(crate) fn text(list: &[CharacteristicResult]) -> String {
    let drawn = list.iter().any(|of| of.drawn.is_some());
    if list.is_empty() {
        return String::new();
    }
    let (head, columns) = if drawn {
        ("Features over the machines drawn, um (in brackets: 95 % confidence):", ["median", "95 %", "holds, %"])
    } else {
        ("Features by the errors with values, um:", ["value", "LS", "holds"])
    };
    let mut rows = table(&["feature", "characteristic", "tol.", columns[0], columns[1], columns[2]]);
    for of in list {
        let tolerance = of.tolerance_um.map_or("-".to_owned(), short);
        let values = of.drawn.as_ref().map_or_else(|| valued(of), |drawn| drawn_cells(drawn, of.unreached > 0));
        let [a, b, c] = values;
        let name = format!("{}{}", shown(&of.feature), if of.unreached > 0 { " *" } else { "" });
        let _ = rows.add_row([name, kind(of), tolerance, a, b, c]);
    }
    let errors: String = list.iter().map(errors).collect();
    let lacks: String = list.iter().map(lacks).collect();
    let note = if drawn {
        "Errors that make the 95 % value:"
    } else {
        "Errors that make the value (in brackets: 95 % by their uncertainty, um):"
    };
    format!("{head}\n{rows}\n{lacks}{}", if errors.is_empty() { errors } else { format!("{note}\n{errors}") })
}

/// Values below this (um) are rounding.
const ROUNDING: f64 = 1e-4;

fn short(um: f64) -> String {
    significant(if um < ROUNDING { 0.0 } else { um }, 4)
}

/// `perpendicularity to base`.
fn kind(of: &CharacteristicResult) -> String {
    let datum = of.datum.as_ref().map_or(String::new(), |datum| format!(" to {}", shown(datum)));
    format!("{}{datum}", of.kind.name())
}

fn valued(of: &CharacteristicResult) -> [String; 3] {
    let cell = |um: Option<f64>| um.map_or("-".to_owned(), short);
    let holds = match (of.holds, of.value_um.and(of.tolerance_um)) {
        (Some(true), _) => "yes",
        (Some(false), _) => "no",
        (None, Some(_)) => "not decided",
        (None, None) => "-",
    };
    [cell(of.value_um), cell(of.least_squares_um), holds.to_owned()]
}

fn drawn_cells(of: &DrawnCharacteristic, at_most: bool) -> [String; 3] {
    let p95 = within(of.p95_um.value, of.p95_um.low, of.p95_um.high);
    let percent = |x: f64| significant(100.0 * x, 3);
    let least = if at_most { "at most " } else { "" };
    let holds = of.holds.map_or("-".to_owned(), |of| {
        format!("{least}{} ({}..{})", percent(of.value), percent(of.low), percent(of.high))
    });
    [short(of.median_um), p95, holds]
}

fn errors(of: &CharacteristicResult) -> String {
    let value = of.value_um.or_else(|| Some(of.drawn.as_ref()?.p95_um.value));
    if of.errors.is_empty() || value.is_none_or(|um| um < ROUNDING) {
        return String::new();
    }
    let list = of.errors.iter().map(|part| format!("{} {:.0} %", part.error, 100.0 * part.share));
    let interval = of.interval_um.map_or(String::new(), |[low, high]| {
        let [low, high] = ends(low, high);
        format!(" ({low}..{high})")
    });
    format!("  {} {}{interval}: {}\n", shown(&of.feature), kind(of), list.collect::<Vec<_>>().join(", "))
}

fn lacks(of: &CharacteristicResult) -> String {
    let reach =
        if of.unreached > 0 { format!("* {} of its points are out of reach; ", of.unreached) } else { String::new() };
    let lacks = of.lacks.clone().unwrap_or_default();
    match reach.is_empty() && lacks.is_empty() {
        true => String::new(),
        false => format!("  {} {}: {}\n", shown(&of.feature), kind(of), (reach + &lacks).trim_end_matches("; ")),
    }
}
