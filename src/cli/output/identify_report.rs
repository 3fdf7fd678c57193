//! The result of `abbe identify` as text and CSV.

use super::view::{keep_words, table};
use abbe::results::{
    BentError, FittedParameter, FormOfAxis, IdentifyResult, RepeatedReadings, ResidualGroup, ResidualTest,
    SharedUncertainty,
};
use abbe::text::{counted, significant, with_sigma};

/// Coverage factor (95 %) of 29 degrees of freedom; larger ones are printed.
const USUAL_COVERAGE: f64 = 2.045;
/// Motions (um, urad) up to this are rounding.
const MAX_ROUNDING: f64 = 1e-3;
/// Lines of one kind in the text; JSON has all.
const MAX_LINES: usize = 10;

fn estimates(result: &IdentifyResult) -> impl Iterator<Item = &FittedParameter> {
    result.parameters.iter().chain(&result.instruments)
}

pub(crate) fn csv(result: &IdentifyResult) -> String {
    let row = |p: &FittedParameter| {
        let sigma = p.sigma.map_or_else(String::new, |s| s.to_string());
        let type_a = p.type_a.map_or_else(String::new, |s| s.to_string());
        format!("{},{},{sigma},{},{type_a},{},{}", p.name, p.value, p.unit, p.lack_of_fit, p.type_b)
    };
    std::iter::once("name,value,sigma,unit,type_a,lack_of_fit,type_b".to_owned())
        .chain(estimates(result).map(row))
        .collect::<Vec<_>>()
        .join("\n")
}

pub(crate) fn text(result: &IdentifyResult) -> String {
    let mut rows = table(&["parameter", "value", "1 sigma", "unit"]);
    for p in estimates(result) {
        let none = if result.degrees_of_freedom > 0 { "free" } else { "unknown" };
        // The value of a direction that the prior holds is rounding.
        let value = Some(p.value).filter(|v| v.abs() >= 1e-6).unwrap_or(0.0);
        let [value, sigma] =
            p.sigma.map_or_else(|| [significant(value, 5), none.to_owned()], |sigma| with_sigma(value, sigma));
        let _ = rows.add_row([p.name.clone(), value, sigma, p.unit.clone()]);
    }
    keep_words(&mut rows);
    let mut text = abbe::headlines::identify(result);
    text += &format!("{}: fitted to {}\n{rows}\n{}", result.machine, counted(result.points, "point"), fit(result));
    text += &residuals(result);
    text += &groups(result);
    text += &shared_uncertainties(result);
    text += &prediction(result);
    text += &weak_directions(result);
    text += &outliers(result);
    text + &datum(result)
}

/// Deviations below a nanometre are rounding.
fn um(value: f64) -> String {
    if 0.0 < value && value < MAX_ROUNDING { format!("below {MAX_ROUNDING}") } else { significant(value, 4) }
}

fn fit(r: &IdentifyResult) -> String {
    let scatter = match &r.scatter[..] {
        [] => format!("; {} per reading", r.reading_scatter),
        list => {
            let words: Vec<&str> = list.iter().map(|scatter| scatter.words.as_str()).collect();
            format!("\nscatter    per reading {}", words.join(", "))
        }
    };
    let known = r.known.iter().map(|k| format!("{} to {} {}", k.name, significant(k.sigma, 3), k.unit));
    let known: Vec<String> = known.collect();
    let and_known =
        if known.is_empty() { String::new() } else { format!(" and {}", counted(known.len(), "known value")) };
    let known = if known.is_empty() { String::new() } else { format!("known      {}\n", known.join(", ")) };
    known
        + &format!(
            "rank       {} from {}{}, {} well determined, condition {}, observability {}\n\
         rms        {} um before, {} um after{scatter}\n\
         orders     first {} um, second {} um, higher {} um; first alone leaves {} um, with the second {} um\n",
            abbe::headlines::rank(r.rank_first_order, r.rank, r.unknowns),
            counted(r.rows, "reading"),
            and_known,
            r.well_determined,
            significant(r.condition, 3),
            significant(r.observability, 3),
            um(r.rms_um.before),
            um(r.rms_um.after),
            um(r.orders_um.first),
            um(r.orders_um.second),
            um(r.orders_um.higher),
            um(r.orders_um.left_by_first),
            um(r.orders_um.left_by_second),
        )
}

/// Returns what is left of groups of readings that stand out.
fn groups(r: &IdentifyResult) -> String {
    let out: Vec<&ResidualGroup> = r.residuals.iter().filter(|group| group.stands_out).collect();
    if out.is_empty() {
        return String::new();
    }
    let mut rows = table(&["left of", "readings", "rms", "unit"]);
    for ResidualGroup { of, readings, rms_um, .. } in out.into_iter().take(MAX_LINES) {
        let _ = rows.add_row([of.clone(), readings.to_string(), significant(*rms_um, 3), "um".to_owned()]);
    }
    format!("{rows}\n")
}

fn residuals(r: &IdentifyResult) -> String {
    let mut text = String::new();
    if r.kinds.len() > 1 {
        let parts = r.kinds.iter().map(|kind| format!("{} of {} {}", kind.words, kind.rows, kind.kind));
        text += &format!("kinds      {}\n", parts.collect::<Vec<_>>().join(", "));
    }
    for ResidualTest { of, normality, runs, lag1, .. } in &r.residual_tests {
        let [normality, runs, lag1] = [normality, runs, lag1].map(|x| significant(*x, 2));
        text += &format!(
            "noise      {of}: normal p = {normality}, signs by chance p = {runs}, correlation with the one before \
             {lag1}\n"
        );
    }
    if let Some((smallest, largest)) = r.coverage.filter(|(_, largest)| *largest > USUAL_COVERAGE) {
        let [smallest, largest] = [smallest, largest].map(|reach| significant(reach, 4));
        let reach = if smallest == largest { largest } else { format!("{smallest} to {largest}") };
        text += &format!("intervals  95 % reach {reach} sigma\n");
    }
    if let Some(held_out) = r.rms_um.held_out {
        text += &format!("held out   {} um on points that were not used\n", um(held_out));
    }
    for RepeatedReadings { of, sigma_um, degrees_of_freedom } in &r.repeats {
        let of = if r.kinds.len() > 1 { format!(" of {of}") } else { String::new() };
        let size = um(*sigma_um);
        text += &format!(
            "repeated   {size} um per reading{of} where a pose was measured again ({degrees_of_freedom} times)\n"
        );
    }
    text
}

/// Returns the line on a bent error; the fit leaves `rms_um`.
fn bend(bent: &BentError, rms_um: f64) -> String {
    let BentError { error, bend, unit, rms_ratio, fit } = bent;
    let remedy = fit.as_ref().map_or("`linear` holds it straight".to_owned(), |word| format!("try {word}"));
    let [before, after] = [rms_um, rms_um * rms_ratio].map(|rms| significant(rms, 3));
    format!("bend       {error}: {} {unit} of bend; {remedy} (rms {before} to {after} um)\n", significant(*bend, 2))
}

/// Returns three sizes in words, such as `0.9/1.2/0.8 um`: one if they are alike, `None` of none.
fn sizes(three: [f64; 3], unit: &str) -> Option<String> {
    let mut words: Vec<String> = three.iter().map(|size| significant(*size, 2)).collect();
    words.dedup();
    three.iter().any(|size| *size > 0.0).then(|| format!("{} {unit}", words.join("/")))
}

/// Returns the lines on what readings share: the form of the axes beside the curves, and uncertainties of type B.
fn shared_uncertainties(r: &IdentifyResult) -> String {
    let mut text = String::new();
    if let Some(lack) = r.lack_of_fit.as_ref().filter(|lack| !lack.forms.is_empty()) {
        let form = |f: &FormOfAxis| {
            let sizes: Vec<String> =
                [sizes(f.sizes_um, "um"), sizes(f.rotations_urad, "urad")].into_iter().flatten().collect();
            format!("{} {} over {} {}", f.axis, sizes.join(" and "), significant(f.length, 2), f.unit)
        };
        let forms: Vec<String> = lack.forms.iter().map(form).collect();
        text += &format!(
            "form       beside the curves, probability {}: {}\n",
            significant(lack.probability, 3),
            forms.join(", ")
        );
        if !lack.tied.is_empty() {
            text += &format!("           sizes tied to those of the others: {}\n", lack.tied.join(", "));
        }
    }
    r.lack_of_fit.iter().flat_map(|lack| &lack.bends).for_each(|bent| text += &bend(bent, r.rms_um.after));
    let one = |u: &SharedUncertainty| match (u.scale_um_per_m, u.offset_um) {
        (Some(scale), _) => format!("{} {} um/m", u.name, significant(scale, 3)),
        (_, offset) => format!("{} {} um", u.name, significant(offset.unwrap_or_default(), 3)),
    };
    if !r.type_b.is_empty() {
        text += &format!("type B     {}\n", r.type_b.iter().map(one).collect::<Vec<_>>().join(", "));
    }
    text
}

/// Returns uncertainty lines on the uncertainty of the prediction over the volume.
fn prediction(r: &IdentifyResult) -> String {
    let p = &r.prediction;
    let at: Vec<String> = p.at.iter().map(|(axis, q)| format!("{axis}={}", significant(*q, 4))).collect();
    let (at, deviation) = (at.join(", "), um(p.deviation_um));
    let mut text = match (p.largest_um, &p.combination) {
        (Some(size), _) => {
            let held = if p.held { "" } else { ": not held by the data" };
            format!("prediction u = {} um at most, at {at}{held}", significant(size, 3))
        }
        (None, Some(words)) => format!("prediction u is infinite, at {at} for one: {words}, but that deviation"),
        (None, None) => "prediction u is unknown: no residual degrees of freedom".to_owned(),
    };
    text += &format!(
        "\n           of deviations up to {deviation} um over the volume, less a rigid motion of the workpiece frame\n"
    );
    if !r.invariances.is_empty() {
        let motions = r.invariances.join(", ");
        text += &format!("motions    no reading notices a rigid motion of the whole machine {motions}\n");
    }
    text
}

fn weak_directions(r: &IdentifyResult) -> String {
    let mut text = String::new();
    r.free.iter().for_each(|words| text += &format!("free       {words}\n"));
    // Names of curves would be those of their coefficients.
    let told: Vec<&str> = r.parameters.iter().filter(|p| p.sigma.is_some()).map(|p| p.name.as_str()).collect();
    if !r.free.is_empty() && !told.is_empty() && told.iter().all(|name| !name.contains([':', ' '])) {
        text += &format!("           `--fit {}` fits what these data tell\n", told.join(","));
    }
    if !r.noise_hides_values {
        return text;
    }
    r.below_noise.iter().take(MAX_LINES).for_each(|words| text += &format!("below noise {words}\n"));
    if r.below_noise.len() > MAX_LINES {
        text += &format!("           and {} more combinations (--format json)\n", r.below_noise.len() - MAX_LINES);
    }
    text
}

/// Returns the datum, and all errors of the axes in it.
fn datum(r: &IdentifyResult) -> String {
    let Some(datum) = &r.datum else { return String::new() };
    let list = |values: &[f64; 3]| values.map(|x| significant(x, 3)).join(", ");
    let mut text = format!("datum      {} conditions", datum.conditions);
    if datum.translation_um.iter().chain(&datum.rotation_urad).any(|x| x.abs() > MAX_ROUNDING) {
        let (translation, rotation) = (list(&datum.translation_um), list(&datum.rotation_urad));
        text += &format!("; taken out of the errors: the whole moved by {translation} um, turned by {rotation} urad");
    }
    if !datum.measured.is_empty() {
        let range = |(axis, [from, to]): (&String, &[f64; 2])| {
            format!("{axis} from {} to {}", significant(*from, 4), significant(*to, 4))
        };
        let ranges: Vec<String> = datum.measured.iter().map(range).collect();
        text += &format!("\n           formed over what was measured, less than the travel: {}", ranges.join(", "));
    }
    let mut rows = table(&["error", "smallest", "largest", "1 sigma", "unit"]);
    for e in &r.errors {
        let sigma = e.sigma.map_or_else(|| "free".to_owned(), |s| significant(s, 2));
        let cells = [significant(e.smallest, 4), significant(e.largest, 4), sigma, e.unit.clone()];
        let _ = rows.add_row([e.error.clone()].into_iter().chain(cells));
    }
    text + &format!("\n{rows}\n")
}

fn outliers(r: &IdentifyResult) -> String {
    let mut text = String::new();
    for outlier in r.outliers.iter().take(MAX_LINES) {
        let (size, sigmas) = (um(outlier.residual_um), significant(outlier.deviations, 3));
        text += &format!("outlier    {}: {size} um, {sigmas} sigma\n", outlier.place);
    }
    if r.outliers.len() > MAX_LINES {
        text += &format!("           and {} more\n", r.outliers.len() - MAX_LINES);
    }
    text
}
