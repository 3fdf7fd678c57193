//! Budgets of several machines on the same work: for `compare`.

use super::budget_text::{TOTALS_NOTE, totals, totals_row, values_text};
use super::ranking::difference;
use super::view::{errors_more, table_of_machines};
use abbe::results::{ComparedBudget, ComparedBudgets, ComparedVerdict, MachineVerdict, Verdict, WithheldVerdict};
use abbe::text::{significant, with_sigma};

/// Two tables: totals, and the part of each tolerance in the 95 % value.
pub(crate) fn text(of: &ComparedBudgets, verdicts: &[MachineVerdict], top: usize) -> String {
    let mut rows = Vec::new();
    for (i, budget) in of.machines.iter().enumerate() {
        rows.push(totals_row(&format!("{} position, um", i + 1), &budget.position_um));
        rows.push(totals_row("  rotation, urad", &budget.rotation_urad));
    }
    let rows = totals(rows);
    let named = |budget: &ComparedBudget| budget.class.as_deref().unwrap_or("none").to_owned();
    let class = match (&of.drawing.class, &of.drawing.class_source) {
        (Some(name), Some(source)) => format!(", class {name} ({source})"),
        _ if of.machines.iter().all(|budget| budget.class.is_none()) => String::new(),
        _ => format!(", classes {}", of.machines.iter().map(named).collect::<Vec<_>>().join(" and ")),
    };
    let values = |(i, budget): (usize, &ComparedBudget)| {
        let lines = values_text(budget.left_out, budget.with_values);
        lines.lines().map(|line| format!("{i}: {line}\n")).collect::<String>()
    };
    let values: String = (1..).zip(&of.machines).map(values).collect();
    let counts: Vec<String> = of.machines.iter().map(|budget| budget.errors.to_string()).collect();
    format!(
        "\nBudgets on the same tool poses: {} errors bounded{class}; {} machines drawn, {} \
         distribution\n{values}{rows}\n{TOTALS_NOTE}\n{}{}",
        counts.join(" and "),
        of.drawing.samples,
        of.drawing.distribution.name(),
        versus_first(of, verdicts),
        tolerances(of, top)
    )
}

/// The differences of the 95 % values, with what can be said of them.
fn versus_first(of: &ComparedBudgets, verdicts: &[MachineVerdict]) -> String {
    let line = |(i, versus): (usize, &ComparedVerdict)| {
        let below = verdicts.get(i).filter(|_| versus.withheld.is_none());
        let words = match (versus.verdict, &versus.withheld) {
            _ if below.is_some_and(|of| of.reason.is_some()) => "no verdict, as stated below".to_owned(),
            (Some(drawn), _) if below.is_some_and(|of| of.verdict.is_some_and(|verdict| verdict != drawn)) => {
                format!("{} but for the uncertainty of values, see below", drawn.words())
            }
            (Some(Verdict::NotToldApart), _) => {
                format!("not told apart with {} machines (`--max-samples`)", of.drawing.samples)
            }
            (Some(verdict), _) => verdict.words().to_owned(),
            (None, withheld) => format!("no verdict{}", withheld.as_ref().map(reason).unwrap_or_default()),
        };
        let alike = versus.minus_first_alike.map_or_else(String::new, |alike| {
            format!("\n  with the other machine's bounds for what one lacks {} um", difference(alike))
        });
        format!("95 % value of the position, {} - 1: {} um, {words}{alike}\n", i + 2, difference(versus.minus_first))
    };
    of.versus_first_p95_um.iter().enumerate().map(line).collect()
}

/// The reason why there is no verdict, with the difference that like bounds would give and the names of what is
/// missing.
fn reason(of: &WithheldVerdict) -> String {
    let [other, class] = of.minus_first_if_filled.map(difference);
    let names = |number: &str, missing: &[String]| {
        if missing.is_empty() { String::new() } else { format!("\n  missing in {number}: {}", missing.join(", ")) }
    };
    format!(
        ": {}\n  with the other machine's bounds for them {other} um, with those of class {} too {class} um{}{}",
        of.reason,
        of.class,
        names("1", &of.missing_first),
        names("this one", &of.missing)
    )
}

fn tolerances(of: &ComparedBudgets, top: usize) -> String {
    if top == 0 {
        return String::new();
    }
    let mut rows = table_of_machines("of the 95 % value, um", of.machines.len());
    for e in of.contributions.iter().take(top) {
        let part = |(um, sigma): (&Option<f64>, &Option<f64>)| {
            let both = um.zip(*sigma);
            both.map_or("-".to_owned(), |(um, sigma)| with_sigma(um, sigma).join(" ± "))
        };
        let parts = e.um_of_p95.iter().zip(&e.um_of_p95_sigma).map(part);
        let minus = e.minus_first.iter().skip(1).map(|um| significant(*um, 3));
        let _ = rows.add_row(std::iter::once(e.error.clone()).chain(parts).chain(minus));
    }
    let more = errors_more(of.contributions.len(), top);
    format!(
        "\nWhat each tolerance has of the 95 % value of the drawn machines (± standard error); the parts add up to \
         it:\n{rows}\n{more}"
    )
}
