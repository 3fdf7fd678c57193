//! Tolerances for a goal as text: for `budget`.

use super::budget_text::tolerance_text;
use super::view::table;
use abbe::results::{Binding, Percentile, ToleranceGoal};
use abbe::text::significant;

/// A table of old and new tolerances, largest part of the 95 % value first.
pub(crate) fn text(of: &ToleranceGoal, top: usize) -> String {
    let mut text = format!(
        "\nCheapest tolerances for a 95 % value of {} um; the cost is the sum of weight / tolerance{} (um, urad)\n",
        significant(of.goal_um, 6),
        if of.cost.power == 1.0 { String::new() } else { format!("^{}", significant(of.cost.power, 4)) }
    );
    let mut rows = table(&["error", "old", "new", "bound by", "of the 95 % value, um", "cost, old", "cost, new"]);
    for new in of.tolerances.iter().take(top) {
        let _ = rows.add_row([
            new.error.clone(),
            tolerance_text(new.old, new.unit),
            tolerance_text(new.new, new.unit),
            binding(new.binds).to_owned(),
            significant(new.um_of_p95, 3),
            significant(new.cost_before, 3),
            significant(new.cost_after, 3),
        ]);
    }
    text += &format!("{rows}\n");
    if of.tolerances.len() > top {
        let more = of.tolerances.len() - top;
        text += &format!("... and {more} more (`--top {}`, or `--format csv`)\n", of.tolerances.len());
    }
    text += &format!("Cost {} before, {} now", significant(of.cost.before, 4), significant(of.cost.after, 4));
    text += &match of.cost.per_um {
        Some(price) => format!(
            "; the next micrometre less costs {} ({} %)\n",
            significant(price, 3),
            significant(100.0 * price / of.cost.after, 3)
        ),
        None => "; every tolerance is at a limit\n".to_owned(),
    };
    text += &format!(
        "95 % value before {}, now {} um, by {} machines that the search has not seen\n",
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

fn interval(p: Percentile) -> String {
    let end = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 4));
    format!("{} ({}..{})", significant(p.value, 4), end(p.low), end(p.high))
}

/// The constraint that fixes a tolerance, in words.
pub(crate) fn binding(of: Binding) -> &'static str {
    match of {
        Binding::Goal => "goal",
        Binding::Finest => "finest",
        Binding::Coarsest => "coarsest",
    }
}
