//! Tolerances for a goal as text: for `budget`.

use super::view::table;
use crate::cli::verbs::budget::bound_text;
use abbe::results::{Binding, Percentile, ToleranceGoal};
use abbe::text::significant;

/// A table of old and new tolerances, largest part of the 95 % value first.
pub(crate) fn text(of: &ToleranceGoal, top: usize) -> String {
    let found = &of.cheapest;
    let mut text = format!(
        "\nCheapest tolerances for a 95 % value of {} um; the cost is the sum of weight / tolerance{} (um, urad)\n",
        significant(of.goal_um, 6),
        if of.power == 1.0 { String::new() } else { format!("^{}", significant(of.power, 4)) }
    );
    let mut rows = table(&["error", "old", "new", "bound by", "of the 95 % value, um", "cost, old", "cost, new"]);
    for new in of.tolerances.iter().take(top) {
        let _ = rows.add_row([
            new.old.to_string(),
            bound_text(&new.old),
            bound_text(&new.new),
            binding(new.binding).to_owned(),
            significant(new.part_um, 3),
            significant(new.cost[0], 3),
            significant(new.cost[1], 3),
        ]);
    }
    text += &format!("{rows}\n");
    if of.tolerances.len() > top {
        let more = of.tolerances.len() - top;
        text += &format!("... and {more} more (`--top {}`, or `--format csv`)\n", of.tolerances.len());
    }
    text += &format!("Cost {} before, {} now", significant(found.cost[0], 4), significant(found.cost[1], 4));
    text += &match found.cost_per_um {
        Some(price) => format!(
            "; the next micrometre less costs {} ({} %)\n",
            significant(price, 3),
            significant(100.0 * price / found.cost[1], 3)
        ),
        None => "; every tolerance is at a limit\n".to_owned(),
    };
    text += &format!(
        "95 % value before {}, now {} um, by {} machines that the search has not seen\n",
        interval(found.before),
        interval(found.proof),
        of.proof_samples
    );
    if found.staying_um > 0.0 {
        let um = significant(found.staying_um, 4);
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
