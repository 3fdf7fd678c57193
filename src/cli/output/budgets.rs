//! Budgets of several machines on the same work: for `compare` and for the comparison of `report`.

use super::progress::Progress;
use super::session::Session;
use super::view::table;
use crate::analysis::budget::{Bound, BoundedError, Budget, Request, budget, side_by_side};
use crate::cli::Exit;
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::verbs::budget::{TOTALS, TOTALS_NOTE, totals_row};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Machine, Pose};
use crate::report::{BudgetReport, Drawing, budgets_json};
use crate::units::significant;
use serde_json::Value;

/// How machines are drawn.
#[derive(Clone, Copy)]
pub(crate) struct Drawn<'a> {
    pub tolerances: &'a ToleranceArgs,
    pub samples: usize,
    pub seed: u64,
}

/// One budget for each machine, and what they have of each error.
pub(crate) struct Budgets {
    bounds: Vec<Vec<Bound>>,
    budgets: Vec<Budget>,
    errors: Vec<BoundedError>,
    poses: usize,
    drawing: Drawing,
}

/// The budgets, each at the machine's own poses of the same work; none if not every machine has one.
pub(crate) fn budgets(
    session: &mut Session,
    sides: &[(&Machine, Vec<Pose>)],
    drawn: Drawn<'_>,
) -> Result<Option<Budgets>, Exit> {
    let mut all = Vec::new();
    let mut source = None;
    for (machine, _) in sides {
        let (bounds, of) = drawn.tolerances.bounds_if_any(session, machine)?;
        source = of.or(source);
        all.push(bounds);
    }
    let without: Vec<String> = sides
        .iter()
        .zip(&all)
        .filter(|(_, b)| b.is_empty())
        .map(|((m, _), _)| format!("`{}`", shown(m.name())))
        .collect();
    if without.len() == sides.len() || sides.iter().any(|(_, poses)| poses.is_empty()) {
        return Ok(None);
    }
    if !without.is_empty() {
        let message = format!("budgets are not compared: {} bounds no error", without.join(" and "));
        let help = "write tolerances into every file, or take those of a class: `--class production`";
        session.diagnostics.push(Diagnostic::new(codes::W0607, message).help(help));
        session.checked()?;
        return Ok(None);
    }
    let draws = drawn.tolerances.draws(drawn.seed);
    let progress = Progress::new(2 * drawn.samples * sides.len(), session.is_quiet());
    let one = |((machine, poses), bounds): (&(&Machine, Vec<Pose>), &Vec<Bound>)| {
        let statistic = drawn.tolerances.statistic();
        let request = Request { machine, bounds, poses, at: None, draws: &draws, samples: drawn.samples, statistic };
        budget(request, &|count| progress.add(count))
    };
    let list: Vec<Budget> = sides.iter().zip(&all).map(one).collect();
    let pairs: Vec<(&[Bound], &Budget)> = all.iter().map(Vec::as_slice).zip(&list).collect();
    Ok(Some(Budgets {
        errors: side_by_side(&pairs),
        bounds: all,
        budgets: list,
        poses: sides.first().map_or(0, |(_, poses)| poses.len()),
        drawing: drawn.tolerances.drawing(source, drawn.samples, drawn.seed),
    }))
}

impl Budgets {
    /// As `compare --format json` and the page have it.
    pub(crate) fn json<'m>(&'m self, machines: impl IntoIterator<Item = &'m Machine>) -> Value {
        let (poses, drawing) = (self.poses, &self.drawing);
        let sides = machines.into_iter().zip(self.bounds.iter().zip(&self.budgets));
        let report = |(machine, (bounds, budget)): (&'m Machine, (&'m Vec<Bound>, &'m Budget))| BudgetReport {
            machine,
            bounds,
            budget,
            poses,
            drawing,
        };
        let reports: Vec<BudgetReport<'_>> = sides.map(report).collect();
        let mut json = budgets_json(&reports, &self.errors);
        if let Some(object) = json.as_object_mut() {
            object.extend(drawing.json());
        }
        json
    }

    /// Two tables: totals, and what each tolerance has of the 95 % value.
    pub(crate) fn text(&self, top: usize) -> String {
        let mut rows = table(&TOTALS);
        for (i, budget) in self.budgets.iter().enumerate() {
            let _ = rows.add_row(totals_row(&format!("{} position, um", i + 1), &budget.position));
            let _ = rows.add_row(totals_row("  rotation, urad", &budget.rotation));
        }
        let class =
            self.drawing.class.as_ref().map_or(String::new(), |(name, source)| format!(", class {name} ({source})"));
        let counts: Vec<String> = self.bounds.iter().map(|bounds| bounds.len().to_string()).collect();
        format!(
            "\nBudgets on the same tool poses: {} errors bounded{class}; {} machines drawn, {} distribution\n{rows}\n{TOTALS_NOTE}\n{}",
            counts.join(" and "),
            self.drawing.samples,
            self.drawing.distribution.name(),
            self.tolerances(top)
        )
    }

    fn tolerances(&self, top: usize) -> String {
        if top == 0 {
            return String::new();
        }
        let count = self.budgets.len();
        let columns = (1..=count).map(|i| i.to_string()).chain((2..=count).map(|i| format!("{i} - 1")));
        let header: Vec<String> = std::iter::once("of the 95 % value, um".to_owned()).chain(columns).collect();
        let mut rows = table(&header.iter().map(String::as_str).collect::<Vec<_>>());
        for e in self.errors.iter().take(top) {
            let part = |p: &Option<crate::analysis::budget::BudgetPart>| {
                p.map_or("-".to_owned(), |p| {
                    format!("{} ± {}", significant(p.of_p95.effect, 3), significant(p.of_p95.sigma, 2))
                })
            };
            let minus = (1..count).map(|i| significant(e.minus_first(i), 3));
            let _ = rows.add_row(std::iter::once(e.error.to_string()).chain(e.parts.iter().map(part)).chain(minus));
        }
        let more = match self.errors.len().saturating_sub(top) {
            0 => String::new(),
            n => format!("... and {n} errors more (`--top {}`, or `--format json`)\n", self.errors.len()),
        };
        format!(
            "\nWhat each tolerance has of the 95 % value of the drawn machines (± standard error); the parts add up to it:\n{rows}\n{more}"
        )
    }
}
