//! Tolerances for a goal as text: for `budget`.

use super::budget_text::tolerance_text;
use super::view::table;
use abbe::results::{Binding, GoalTolerance, Percentile, ToleranceGoal};
use abbe::text::{significant, within};

/// Tables of the tolerances that become finer, largest part of the 95 % value first, and of those that become coarser.
pub(crate) fn text(of: &ToleranceGoal, top: usize) -> String {
    let law = match of.cost.power {
        None => "weight x (present / new - 1)".to_owned(),
        Some(1.0) => "weight / tolerance (um, urad)".to_owned(),
        Some(power) => format!("weight / tolerance^{} (um, urad)", significant(power, 4)),
    };
    let mut text =
        format!("\nCheapest tolerances for a 95 % value of {} um; each costs {law}\n", significant(of.goal_um, 6));
    let (changed, kept): (Vec<&GoalTolerance>, _) = of.tolerances.iter().partition(|of| of.new != of.old);
    let (finer, coarser): (Vec<_>, Vec<_>) = changed.into_iter().partition(|of| of.new < of.old);
    if finer.is_empty() {
        text += "No tolerance has to become finer\n";
    } else {
        text += &rows("tighten", &finer, top);
    }
    if !coarser.is_empty() {
        text += &format!("\nCoarser than now:\n{}", rows("loosen", &coarser, top));
    }
    let held = kept.iter().filter(|of| of.binds == Binding::Held).count();
    if !kept.is_empty() {
        text += &format!("{} stay as they are, {held} of them held\n", kept.len());
    }
    let (before, after) = (significant(of.cost.before, 4), significant(of.cost.after, 4));
    text += &match of.cost.power {
        None => format!("Cost {after} {}", of.cost.unit),
        Some(_) => format!("Cost {before} before, {after} now, {}", of.cost.unit),
    };
    text += &match of.cost.per_um {
        Some(price) => format!("; the next micrometre less costs {}\n", significant(price, 3)),
        None => "; every tolerance is at a limit\n".to_owned(),
    };
    text += &format!(
        "95 % value before {} um,\nnow {} um by {} machines that the search has not seen\n",
        interval(of.before_um),
        interval(of.proof_um),
        of.proof_samples
    );
    if of.staying_um > 0.0 {
        let um = significant(of.staying_um, 4);
        text += &format!("The errors that have values and no bound stay: {um} um by themselves\n");
    }
    text
}

fn rows(title: &str, list: &[&GoalTolerance], top: usize) -> String {
    let mut rows = table(&[title, "old", "new", "bound by", "of the 95 %, um", "cost"]);
    for new in list.iter().take(top) {
        let _ = rows.add_row([
            new.error.clone(),
            tolerance_text(new.old, new.unit),
            tolerance_text(new.new, new.unit),
            binding(new.binds).to_owned(),
            significant(new.um_of_p95, 3),
            significant(new.cost_after - new.cost_before, 3),
        ]);
    }
    let more = match list.len() > top {
        true => format!("... and {} more (`--top {}`, or `--format csv`)\n", list.len() - top, list.len()),
        false => String::new(),
    };
    format!("{rows}\n{more}")
}

fn interval(p: Percentile) -> String {
    within(p.value, p.low, p.high)
}

/// The constraint that fixes a tolerance, in words.
pub(crate) fn binding(of: Binding) -> &'static str {
    match of {
        Binding::Goal => "goal",
        Binding::Finest => "finest",
        Binding::Coarsest => "coarsest",
        Binding::Present => "present",
        Binding::Held => "held",
    }
}
