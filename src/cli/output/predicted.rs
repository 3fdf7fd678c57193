//! The result of `abbe identify --predict` as text and CSV.

use super::view::{folded, table};
use abbe::results::{JudgedReading, PredictedReadings, SetUpValue};
use abbe::text::{counted, significant};

/// Number of readings that are listed.
const LISTED: usize = 5;

pub(crate) fn text(of: &PredictedReadings) -> String {
    let mut text = abbe::headlines::predict(of);
    let exact = if of.has_predicted_uncertainty { "" } else { "; the prediction counts as exact" };
    text += &folded(&format!("{}, {}{exact}", of.machine, counted(of.readings.len(), "reading")));
    let mut rows = table(&["readings", "rows", "measured RMS", "predicted RMS", "left RMS", "unit", "|E_n| <= 1"]);
    for kind in &of.kinds {
        let [measured, predicted, left] = [kind.measured, kind.predicted, kind.left].map(|rms| significant(rms, 4));
        let within = format!("{:.1} %", 100.0 * kind.within);
        let (places, unit) = (kind.places.to_string(), kind.unit.to_owned());
        let _ = rows.add_row([kind.kind.to_owned(), places, measured, predicted, left, unit, within]);
    }
    text += &format!("{rows}\n");
    text += &folded(&format!(
        "At most 1 is |E_n| for {:.1} %; {:.1} % are expected, of 1000 good campaigns 995 have {:.1} % or more",
        100.0 * of.within,
        100.0 * of.within_expected,
        100.0 * of.within_least
    ));
    if let Some(seen) = &of.errors_seen {
        let [amount, u] = [seen.amount, seen.expanded_uncertainty].map(|x| significant(x, 3));
        text += &folded(&format!("Of the errors of the file the readings see {amount} ± {u} (k = 2; 1: all of them)"));
    }
    if !of.set_up.is_empty() {
        let one = |of: &SetUpValue| format!("{} {} {}", of.name, significant(of.value, 3), of.unit);
        let list: Vec<String> = of.set_up.iter().map(one).collect();
        text += &folded(&format!("Set-up by the readings: {}", list.join(", ")));
    }
    text + &worst(&of.readings)
}

/// The readings with the largest E_n.
fn worst(readings: &[JudgedReading]) -> String {
    let mut judged: Vec<(&JudgedReading, f64)> =
        readings.iter().filter_map(|reading| Some((reading, reading.e_n?))).collect();
    judged.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
    let mut rows = table(&["largest |E_n|", "component", "measured", "predicted", "unit", "E_n"]);
    for (reading, e_n) in judged.iter().take(LISTED) {
        let [measured, predicted, e_n] =
            [significant(reading.measured, 4), significant(reading.predicted, 4), significant(*e_n, 3)];
        let component = (reading.component + 1).to_string();
        let _ = rows.add_row([reading.place.clone(), component, measured, predicted, reading.unit.to_owned(), e_n]);
    }
    if judged.is_empty() { String::new() } else { format!("{rows}\n") }
}

/// One line for each reading.
pub(crate) fn csv(of: &PredictedReadings) -> String {
    let mut csv = "place,component,measured,predicted,left,unit,U measured,U predicted,E_n\n".to_owned();
    for r in &of.readings {
        let e_n = r.e_n.map_or_else(String::new, |e_n| e_n.to_string());
        csv += &format!(
            "{},{},{},{},{},{},{},{},{e_n}\n",
            r.place,
            r.component + 1,
            r.measured + 0.0,
            r.predicted + 0.0,
            r.measured - r.predicted + 0.0,
            r.unit,
            r.measured_u,
            r.predicted_u
        );
    }
    csv
}
