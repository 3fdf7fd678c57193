//! `abbe budget`: tolerances to the volumetric error.

use crate::cli::Outcome;
use crate::cli::arguments::{
    self, AxisPosesArg, JobArg, PartsArgs, PictureFile, PosesArg, ReferenceArg, SamplesArg, SeedArg, ToolArg,
    ToolPosesArg, TopArg, help, svg,
};
use crate::cli::output::budget_text::{
    TOTALS_NOTE, coverage_line, short, tolerance_text, totals, totals_row, values_text,
};
use crate::cli::output::session::Session;
use crate::cli::output::view::{axes_text, path_text, reach_text, table, tool_poses_text};
use crate::cli::output::{characteristics, tolerance_goal};
use crate::cli::store::write::{refuse_outputs, replace_whole};
use crate::cli::tolerances::ToleranceArgs;
use abbe::options::Statistic;
use abbe::results::{BoundedContribution, BudgetResult, DrawnMachineFigures, FittedBudget, Tightening, ZoneBudget};
use abbe::text::{Reason, significant, with_sigma, within};
use abbe::{BudgetOptions, MachineFile, budget, budget_part};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(mut_arg("tool_poses", |option| option.conflicts_with("poses")))]
#[command(mut_arg("job", |option| option.conflicts_with_all(["poses", "tool_poses"])))]
#[command(mut_arg("axis_poses", |option| option.conflicts_with_all(["poses", "tool_poses", "job"])))]
#[command(mut_arg("poses", |option| option.default_value("500")))]
#[command(mut_arg("state", |option| option.requires("shard").conflicts_with_all(["merge", "goal"])))]
#[command(mut_arg("shard", |option| option.conflicts_with_all(["merge", "at", "goal", "pareto", "waterfall"])))]
pub(crate) struct Args {
    /// The machine file; errors with a `tolerance` are budgeted.
    machine: PathBuf,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    #[command(flatten)]
    seed: SeedArg,
    #[command(flatten)]
    poses: PosesArg,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[command(flatten)]
    axis_poses: AxisPosesArg,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    reference: ReferenceArg,
    #[command(flatten)]
    samples: SamplesArg,
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true, help = help::AT,
        long_help = "The contributions at this pose too, mm and deg; axes left out are at 0")]
    at: Option<String>,
    /// Seek the cheapest tolerances for this 95 % value of the position, such as "30 um" (above 0).
    #[arg(long, value_name = "LENGTH", value_parser = goal)]
    goal: Option<f64>,
    /// The cost of tolerances, a YAML file [default: the sum of present / new - 1: a tolerance halved counts 1].
    #[arg(long, value_name = "FILE", requires = "goal")]
    cost: Option<PathBuf>,
    /// Let tolerances become coarser than they are, which lowers the cost.
    #[arg(long, requires = "goal")]
    loosen: bool,
    #[command(flatten)]
    parts: PartsArgs,
    #[command(flatten)]
    top: TopArg,
    #[command(flatten)]
    tool: ToolArg,
    /// Draw what each error does at its bound, and what they add up to, as SVG unless the file ends in .png.
    #[arg(long, value_name = "FILE", value_parser = svg)]
    pareto: Option<PictureFile>,
    /// Draw how the budget is used up, tolerance by tolerance, as SVG unless the file ends in .png.
    #[arg(long, value_name = "FILE", value_parser = svg)]
    waterfall: Option<PictureFile>,
}

impl Args {
    fn options(&self) -> BudgetOptions {
        BudgetOptions {
            tolerances: self.tolerances.options(),
            seed: self.seed.seed,
            poses: self.poses.poses,
            tool_poses: self.tool_poses.tool_poses.clone(),
            axis_poses: self.axis_poses.axis_poses.clone(),
            reference: self.reference.reference.clone(),
            path: self.job.path,
            samples: self.samples.samples,
            job: self.job.job.clone(),
            at: self.at.clone(),
            goal_mm: self.goal,
            cost: self.cost.clone(),
            loosen: self.loosen,
            shard: self.parts.shard,
            merge: self.parts.merge.clone(),
        }
    }
}

fn goal(text: &str) -> Result<f64, Reason> {
    arguments::length(
        text,
        |mm| mm > 0.0 && mm <= 10.0,
        "the goal is a length above 0 and up to 10 mm, such as `30 um`",
    )
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.tool.name())?;
    PictureFile::refuse(session, args.pareto.iter().chain(&args.waterfall))?;
    if let (Some(_), Some(state)) = (args.parts.shard, &args.parts.state) {
        return part(session, args, &file, state);
    }
    let result = session.take(budget(&file, &args.options(), session.run()))?;
    let top = args.top.top;
    for (file, picture) in [(&args.pareto, result.pareto(top)), (&args.waterfall, result.waterfall(top))] {
        if let Some(file) = file {
            file.write(&picture, session)?;
        }
    }
    let report = BudgetText { args, file: &file, result: &result };
    session.show(&result, || report.csv(), || report.text())
}

/// Draws a part of the machines into its state file, unless they are there.
fn part(session: &mut Session, args: &Args, file: &MachineFile, state: &PathBuf) -> Outcome {
    refuse_outputs([state], &session.files).or_else(|refusal| session.refuse(refusal))?;
    let options = BudgetOptions { merge: vec![state.clone()], ..args.options() };
    let part = session.take(budget_part(file, &options, session.run()))?;
    replace_whole(state, part.to_text().as_bytes()).or_else(|refusal| session.refuse(refusal))?;
    let (drawn, samples, name) = (part.count(), part.samples, state.display().to_string());
    let text = || {
        format!("{drawn} of {samples} machines are drawn and kept in {name}; put the parts together with `--merge`\n")
    };
    session.show(&json!({"state": name, "drawn": drawn, "samples": samples}), text, text)
}

/// The printed budget.
struct BudgetText<'a> {
    args: &'a Args,
    file: &'a MachineFile,
    result: &'a BudgetResult,
}

impl BudgetText<'_> {
    /// One line for each error.
    fn csv(&self) -> String {
        let goal = self.result.goal.as_ref();
        let mut csv =
            "error,tolerance,unit,at worst [um],on average [um],of the 95 % value [um],sigma [um],um per unit"
                .to_owned();
        csv += if goal.is_some() { ",new tolerance,binds\n" } else { "\n" };
        for t in &self.result.budget.tighten {
            let new = goal.and_then(|goal| goal.tolerances.iter().find(|new| new.error == t.error));
            csv += &format!(
                "{},{},{},{},{},{},{},{}{}\n",
                t.error,
                t.tolerance,
                t.unit,
                t.at_worst_um.unwrap_or(0.0),
                t.average_um.unwrap_or(0.0),
                t.um_of_p95 + 0.0,
                t.um_of_p95_sigma,
                t.um_of_p95 / t.tolerance + 0.0,
                new.map_or(String::new(), |of| format!(",{},{}", of.new, tolerance_goal::binding(of.binds)))
            );
        }
        csv
    }

    fn text(&self) -> String {
        let budget = &self.result.budget;
        let what = match budget.drawing.statistic {
            Statistic::Max => "largest deviation over the poses",
            Statistic::P95 => "95 % deviation over the poses",
        };
        let own = budget.tighten.iter().filter(|bound| !bound.of_class).count();
        let mut text = abbe::headlines::budget(self.result);
        text += &format!("{}, {}\n{}", self.file.name(), self.file.chain(), self.result.over.text());
        text += &match self.result.from {
            Some(_) => format!("{own} errors with values, none bounded: each within ± its largest at these poses"),
            None => format!("{} errors bounded: {own} by the machine file", budget.tighten.len()),
        };
        if let (Some(class), Some(source)) = (&budget.drawing.class, &budget.drawing.class_source) {
            text += &format!(", {} by class {class} ({source})", budget.tighten.len() - own);
        }
        text += "\n";
        let left_out = if self.result.from.is_some() { 0 } else { budget.left_out };
        text += &values_text(left_out, budget.with_values);
        let coverage = coverage_line(&self.result.coverage).filter(|_| self.result.from.is_none());
        text += &coverage.map_or_else(String::new, |line| line + "\n");
        text += &format!(
            "{} {}; {} machines drawn, {} distribution, seed {}; counted is the {what} of each\n",
            budget.poses,
            self.result.tool_poses.as_ref().map_or_else(|| "poses".to_owned(), tool_poses_text),
            self.args.samples.samples,
            budget.drawing.distribution.name(),
            self.args.seed.seed
        );
        if let Some(reached) = &self.result.tool_poses {
            text += &reach_text(&reached.rows, &reached.travel);
            text += &self.result.path.as_ref().map_or_else(String::new, path_text);
        }
        text += &self.totals_table();
        text += &self.result.best_fit.as_ref().map_or(String::new(), best_fit_text);
        text += &self.result.minimum_zone.as_ref().map_or(String::new(), zone_text);
        text += &format!("Worst case at {}\n", axes_text(self.file, budget.position_um.worst_case_at.values()));
        text += &format!("RSS largest at {}\n", axes_text(self.file, budget.position_um.rss_at.values()));
        text += &characteristics::text(&self.result.characteristics);
        text += &self.pareto_table();
        text += &self.tighten_table();
        let goal =
            self.result.goal.as_ref().map_or(String::new(), |goal| tolerance_goal::text(goal, self.args.top.top));
        text + &self.directions() + &goal
    }

    /// The directions of the bounds, where their names do not say them.
    fn directions(&self) -> String {
        let mut text = String::new();
        let bounds = &self.result.budget.tighten;
        if bounds.iter().any(|bound| bound.by_letter) {
            text += "Tolerances by letter are boxes in machine coordinates: they do not turn with the machine.\n";
        }
        if bounds.iter().any(|bound| bound.error.contains(' ')) {
            text += "along, across: directions of the axis itself, which no letter names.\n";
        }
        text
    }

    fn totals_table(&self) -> String {
        let budget = &self.result.budget;
        let both = [("position, um", &budget.position_um), ("rotation, urad", &budget.rotation_urad)];
        format!("{}\n{TOTALS_NOTE}\n", totals(both.map(|(name, t)| totals_row(name, t)).to_vec()))
    }

    fn pareto_table(&self) -> String {
        let (budget, at) = (&self.result.budget, self.result.at.as_ref().map(|at| &at.contributions));
        let mut header = vec!["error", "tolerance", "at worst, um", "share", "on average, um"];
        if at.is_some() {
            header.push("at the pose, um");
        }
        let mut rows = table(&header);
        let um = |list: &[BoundedContribution], error: &str| {
            list.iter().find(|c| c.error == error).map_or(String::new(), |c| short(c.um))
        };
        let tolerance =
            |error: &str| budget.tighten.iter().find(|t| t.error == error).map_or(String::new(), bound_text);
        for c in budget.contributions.iter().take(self.args.top.top) {
            let mut row = vec![
                c.error.clone(),
                tolerance(&c.error),
                short(c.um),
                format!("{:.1} %", 100.0 * c.share),
                um(&budget.contributions_on_average, &c.error),
            ];
            row.extend(at.iter().map(|list| um(list, &c.error)));
            let _ = rows.add_row(row);
        }
        format!("\nEach error at its bound, where the RSS is largest (share of the sum of squares):\n{rows}\n")
    }

    fn tighten_table(&self) -> String {
        let mut rows = table(&["tighten first", "tolerance", "um per um or urad", "10 % tighter wins, um"]);
        for t in self.result.budget.tighten.iter().take(self.args.top.top) {
            let _ = rows.add_row([
                t.error.clone(),
                bound_text(t),
                with_sigma(t.um_per_unit, t.sigma).join(" ± "),
                with_sigma(t.um_of_p95 * 0.1, t.um_of_p95_sigma * 0.1).join(" ± "),
            ]);
        }
        format!("\nBy the derivative of the 95 % value of the drawn machines (± its standard error):\n{rows}\n")
    }
}

/// The figures without the best fit, and whether the same tolerance comes first there.
fn best_fit_text(of: &FittedBudget) -> String {
    let p95 = significant(of.position_um.monte_carlo.p95, 4);
    let first = if of.agrees {
        format!("the same error comes first, {}", of.tighten_first)
    } else {
        format!("what to tighten first depends on the reference: here {}, so state one", of.tighten_first)
    };
    format!("With the best fit of the part taken out: 95 % of the machines within {p95} um; {first}\n")
}

/// The machines drawn without the minimum zone, and what the other figures are without.
fn zone_text(of: &ZoneBudget) -> String {
    let text = |of: &DrawnMachineFigures, unit: &str| {
        let (low, high) = of.percentiles.get("p95").map_or((None, None), |of| (of.low, of.high));
        format!("{} {unit}", within(of.p95, low, high))
    };
    format!(
        "With the minimum zone of each machine taken out: 95 % of them within {} and {}\n\
         It has no worst case, RSS, shares or first to tighten: in all other figures the least squares are taken \
         out.\n",
        text(&of.position_um, "um"),
        text(&of.rotation_urad, "urad")
    )
}

fn bound_text(of: &Tightening) -> String {
    tolerance_text(of.tolerance, of.unit)
}
