//! The result of `abbe identify --plan` as text.

use super::view::{folded, table};
use abbe::headlines::rank;
use abbe::results::{ExpectedPrediction, MeasurementPlan};
use abbe::text::{counted, significant};

pub(crate) fn text(plan: &MeasurementPlan) -> String {
    let mut rows = table(&["parameter", "1 sigma expected", "unit"]);
    for p in &plan.parameters {
        let sigma = p.sigma.map_or_else(|| "free".to_owned(), |sigma| significant(sigma, 2));
        let _ = rows.add_row([p.name.clone(), sigma, p.unit.clone()]);
    }
    let poses = plan.poses.len();
    let of_lines = if poses == plan.readings { String::new() } else { format!(" ({})", counted(poses, "pose")) };
    let mut text = abbe::headlines::plan(plan);
    text += &format!(
        "{} of {} readings to choose from{of_lines}, {} um each; `--format csv` writes a file of measurements to be \
         filled in\n{}\n{rows}\n",
        plan.readings,
        plan.candidates,
        significant(plan.noise_um, 3),
        plan.csv
    );
    let rank = rank(plan.rank_first_order, plan.rank, plan.unknowns);
    text += &format!("rank       {rank}, {} well determined\n", plan.well_determined);
    text += &prediction(&plan.prediction);
    plan.free.iter().for_each(|words| text += &format!("free       {words}\n"));
    plan.below_noise.iter().for_each(|words| text += &format!("below noise {words}\n"));
    text
}

/// The uncertainty over the volume, and where it is largest.
fn prediction(of: &ExpectedPrediction) -> String {
    let at = of.at.iter().map(|(axis, q)| format!("{axis} = {}", significant(*q, 4))).collect::<Vec<_>>().join(", ");
    match (of.largest_um, &of.combination) {
        (Some(um), _) => folded(&format!("predicts   the volume with u = {} um at most, at {at}", significant(um, 3))),
        (None, Some(words)) => folded(&format!("predicts   nothing of the volume: {words} is free")),
        (None, None) => "predicts   no uncertainty of the volume: no reading is to spare\n".to_owned(),
    }
}
