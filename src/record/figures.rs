//! The figures in JSON documents of `import` and `figures`, by name, with their uncertainty: what a record prints.

use super::{Line, RecordedFigure};
use crate::report::RunPanel;
use crate::report::positioning::{DrawnRuns, MeasuredTarget, drawn_runs};
use serde_json::Value;

/// Maximum number of figures of a document that a record prints.
const MAX_FIGURES: usize = 500;
/// Maximum number of errors and of targets of which a record draws the runs.
const MAX_PANELS: usize = 24;
const MAX_TARGETS: usize = 10_000;
/// Largest position and value of runs that are drawn.
const MAX_DRAWN: f64 = 1e9;
const UNITS: [&str; 3] = ["um", "urad", "um/m"];
/// Coverage factor of an expanded uncertainty.
const COVERAGE: f64 = 2.0;

/// Figures of `import`: the key, and the name.
const POSITIONING: [(&str, &str); 6] = [
    ("E", "systematic deviation E"),
    ("M", "mean deviation M"),
    ("B", "reversal B"),
    ("mean_B", "mean reversal"),
    ("R", "repeatability R"),
    ("A", "accuracy A"),
];
/// Figures of a circle: the key, the name, and the key of its uncertainty.
const CIRCLE: [(&str, &str, &str); 8] = [
    ("/circular_deviation_um/counter_clockwise", "circular deviation G, counter-clockwise", "G"),
    ("/circular_deviation_um/clockwise", "circular deviation G, clockwise", "G"),
    ("/bidirectional_um", "circular deviation G(b)", "G"),
    ("/mean_radial_um", "mean radial deviation D", "D"),
    ("/radial_max_min_um/counter_clockwise/0", "radial deviation F, counter-clockwise, largest", "F"),
    ("/radial_max_min_um/counter_clockwise/1", "radial deviation F, counter-clockwise, smallest", "F"),
    ("/radial_max_min_um/clockwise/0", "radial deviation F, clockwise, largest", "F"),
    ("/radial_max_min_um/clockwise/1", "radial deviation F, clockwise, smallest", "F"),
];
/// Causes of a circle: key, name, unit; each has a value and a standard uncertainty.
const CAUSES: [(&str, &str, &str); 5] = [
    ("/causes/squareness_urad", "squareness", "urad"),
    ("/causes/scale_mismatch_um_per_m", "scale mismatch", "um/m"),
    ("/causes/reversal_um/0", "reversal of the first direction", "um"),
    ("/causes/reversal_um/1", "reversal of the second direction", "um"),
    ("/causes/servo_um", "servo mismatch", "um"),
];
/// Figures of a motion of an axis of rotation.
const ROTATION: [(&str, &str); 5] = [
    ("total", "total"),
    ("synchronous", "synchronous"),
    ("asynchronous", "asynchronous"),
    ("once", "once a turn"),
    ("synchronous_with_once", "synchronous with once a turn"),
];
const DRIFT: [(&str, &str); 4] = [
    ("range", "range"),
    ("first_hour", "range of the first 60 min"),
    ("largest_in_an_hour", "largest range in 60 min"),
    ("change", "last minus first"),
];
const DIAGONAL: [(&str, &str); 4] = [("e_um", "E"), ("b_um", "B"), ("r_um", "repeatability R"), ("a_um", "accuracy A")];

/// Returns the figures of a document; none of another verb's.
pub(crate) fn figures_in(document: &Value) -> Vec<RecordedFigure> {
    let list = |key: &str| document[key].as_array().map_or(&[][..], Vec::as_slice);
    let mut figures = match document["test"].as_str() {
        Some("circle") => circle(document),
        Some("rotation") => each(list("motions"), "motion", &ROTATION),
        Some("drift") => each(list("drifts"), "drift", &DRIFT),
        Some("diagonals") => {
            let whole = [("e_d_um", "E_d"), ("b_d_um", "B_d")].map(|(key, name)| one(name, &document[key], "um", None));
            whole.into_iter().flatten().chain(each(list("diagonals"), "diagonal", &DIAGONAL)).collect()
        }
        _ => list("errors").iter().flat_map(positioning).collect(),
    };
    figures.truncate(MAX_FIGURES);
    figures
}

/// Sentences on the uncertainties of a document: which contributors they have and lack.
pub(crate) fn contributors_in(document: &Value) -> Vec<Line> {
    let words = |of: &Value| {
        let list = of.as_array()?.iter().filter_map(Value::as_str).take(MAX_FIGURES).collect::<Vec<_>>();
        (!list.is_empty()).then(|| list.join(", "))
    };
    let sentence = |name: &str, of: &Value| {
        let text = match (words(&of["has"]), words(&of["lacks"])) {
            (Some(has), Some(lacks)) => format!("U of {name} has {has}; it lacks {lacks}, and is not complete"),
            _ => format!("U of {name} does not state its contributors"),
        };
        Line::try_from(text).ok()
    };
    let errors = document["errors"].as_array().map_or(&[][..], Vec::as_slice).iter().take(MAX_FIGURES);
    let with_u = errors.filter(|error| error["U"].is_object());
    let positioning = with_u.filter_map(|error| sentence(error["error"].as_str()?, &error["contributors"]));
    let circle = (document["test"] == "circle" && document["U"].is_object())
        .then(|| sentence("G, D and F", &document["U"]["contributors"]));
    positioning.chain(circle.flatten()).collect()
}

/// Draws the runs of a document of `import`: means and bands of 2 s. `None` of documents without runs.
pub(crate) fn runs_in(document: &Value) -> Option<String> {
    let errors = document["errors"].as_array().filter(|_| document["test"].is_null())?;
    let axis = Line::try_from(document["axis"].as_str()?.to_owned()).ok()?;
    let panels: Vec<RunPanel> = errors.iter().filter_map(panel).take(MAX_PANELS).collect();
    let slope_unit = errors.first().and_then(|error| error["slope_unit"].as_str());
    let subtitle = "means and bands of 2 s of the runs";
    (!panels.is_empty()).then(|| drawn_runs(axis.as_str(), subtitle, slope_unit, &panels).svg())
}

/// The runs of one error, if they can be drawn: a document may be written by hand.
fn panel(of: &Value) -> Option<RunPanel> {
    let error = Line::try_from(of["error"].as_str()?.to_owned()).ok()?;
    let unit = of["unit"].as_str().filter(|unit| UNITS[..2].contains(unit))?;
    let targets: Vec<MeasuredTarget> = serde_json::from_value(of["at_targets"].clone()).ok()?;
    let drawn = |target: &MeasuredTarget| {
        let read = [target.forward, target.reverse, target.unknown].into_iter().flatten();
        let values = read.flat_map(|at| [at.mean, at.s.unwrap_or(0.0)]);
        values.chain([target.position]).all(|x| x.abs() <= MAX_DRAWN)
    };
    let figures = ["E", "B", "R", "A"].map(|key| of[key].as_f64());
    let runs = DrawnRuns { error: error.as_str(), unit, figures, targets: &targets, readings: &[] };
    ((2..=MAX_TARGETS).contains(&targets.len()) && targets.iter().all(drawn)).then(|| runs.panel())
}

/// A figure, if it is one: a document may be written by hand.
fn one(name: impl Into<String>, value: &Value, unit: &str, expanded: Option<f64>) -> Option<RecordedFigure> {
    let figure = Line::try_from(name.into()).ok()?;
    let unit = UNITS.into_iter().find(|known| *known == unit)?;
    let expanded_uncertainty = expanded.filter(|u| *u >= 0.0);
    Some(RecordedFigure { figure, value: value.as_f64()?, expanded_uncertainty, unit })
}

/// Figures of one error after ISO 230-2.
fn positioning(of: &Value) -> Vec<RecordedFigure> {
    let (Some(error), Some(unit)) = (of["error"].as_str(), of["unit"].as_str()) else { return Vec::new() };
    let both = POSITIONING
        .iter()
        .filter_map(|(key, name)| one(format!("{error}: {name}"), &of[*key], unit, of["U"][*key].as_f64()));
    let ways = ["forward", "reverse"].into_iter().flat_map(|way| {
        let figure = move |key: &str| {
            one(format!("{error}: {key} {way}"), &of["one_way"][way][key], unit, of["U"][key].as_f64())
        };
        ["E", "R", "A"].into_iter().filter_map(figure)
    });
    both.chain(ways).collect()
}

fn circle(document: &Value) -> Vec<RecordedFigure> {
    let plane = document["plane"].as_str().unwrap_or("circle");
    let at = |pointer: &str| document.pointer(pointer).unwrap_or(&Value::Null);
    let figures = CIRCLE
        .iter()
        .filter_map(|(key, name, u)| one(format!("{plane}: {name}"), at(key), "um", document["U"][*u].as_f64()));
    let causes = CAUSES.iter().filter_map(|(key, name, unit)| {
        let cause = at(key);
        one(format!("{plane}: {name}"), &cause["value"], unit, cause["sigma"].as_f64().map(|s| COVERAGE * s))
    });
    let spikes = at("/causes/turning_points").as_array().map_or(&[][..], Vec::as_slice).iter().filter_map(|point| {
        let (axis, end) = (point["axis"].as_str()?, point["end"].as_str()?);
        let height = &point["spike"]["height_um"];
        let expanded = height["sigma"].as_f64().map(|s| COVERAGE * s);
        one(format!("{plane}: reversal spike {axis}{end}"), &height["value"], "um", expanded)
    });
    figures.chain(causes).chain(spikes).collect()
}

/// Figures of each entry of a list, named by a key.
fn each(list: &[Value], by: &str, figures: &[(&str, &str)]) -> Vec<RecordedFigure> {
    let of = |entry: &Value| {
        let named = entry[by].as_str().unwrap_or_default();
        let unit = entry["unit"].as_str().unwrap_or("um");
        let figure = |(key, name): &(&str, &str)| one(format!("{named}: {name}"), &entry[*key], unit, None);
        figures.iter().filter_map(figure).collect::<Vec<_>>()
    };
    list.iter().flat_map(of).collect()
}
