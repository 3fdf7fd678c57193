//! `abbe compare`: machines side by side on the same tool poses.

use crate::cli::Outcome;
use crate::cli::arguments::{
    AxisPosesArg, JobArg, MaxSamplesArg, PosesArg, ReferenceArg, SamplesArg, SeedArg, ToolPosesArg, TopArg, ViewArgs,
};
use crate::cli::output::session::Session;
use crate::cli::output::view::{
    STATISTICS, errors_more, numbers, path_text, reach_text, statistics_rows, table, table_of_machines,
};
use crate::cli::output::{bands, bounded, budgets};
use crate::cli::tolerances::ToleranceArgs;
use abbe::results::{
    BoundedDeviation, CompareResult, ComparedBudget, ComparedMachine, Difference, OverKind, Statistics,
};
use abbe::text::{cell, fold, significant};
use abbe::{CompareOptions, compare, headlines};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(mut_arg("tool_poses", |option| option.conflicts_with("poses")))]
#[command(mut_arg("job", |option| option.conflicts_with_all(["poses", "tool_poses"])))]
#[command(mut_arg("axis_poses", |option| option.conflicts_with_all(["poses", "tool_poses", "job"])))]
pub(crate) struct Args {
    /// Two or more machine files; differences are to the first, and tool poses are drawn from its volume.
    #[arg(required = true, num_args = 2..)]
    machines: Vec<PathBuf>,
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
    seed: SeedArg,
    #[command(flatten)]
    top: TopArg,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    #[command(flatten)]
    samples: SamplesArg,
    #[command(flatten)]
    max_samples: MaxSamplesArg,
    #[command(flatten)]
    view: ViewArgs,
}

impl Args {
    fn options(&self) -> CompareOptions {
        CompareOptions {
            poses: self.poses.poses,
            tool_poses: self.tool_poses.tool_poses.clone(),
            axis_poses: self.axis_poses.axis_poses.clone(),
            reference: self.reference.reference.clone(),
            path: self.job.path,
            job: self.job.job.clone(),
            seed: self.seed.seed,
            tolerances: self.tolerances.options(),
            samples: self.samples.samples,
            max_samples: self.max_samples.max_samples,
            order: self.view.order.order,
            approach: self.view.direction.direction,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let mut files = Vec::new();
    for path in &args.machines {
        files.push(session.load_one_of(path, args.view.tool.name())?);
    }
    let result = session.take(compare(&files, &args.options(), session.run()))?;
    session.show(&result, || csv(&result), || text(args, &result))
}

/// Columns of a deviation, and of what bounds lead to.
const DEVIATION: &str = "dx [um],dy [um],dz [um],wx [urad],wy [urad],wz [urad]";
const BOUNDED: &str = "position_rss [um],position_p95 [um],rotation_rss [urad],rotation_p95 [urad]";
const MINUS_FIRST: &str = "minus_first_position_rss [um],minus_first_position_p95 [um],\
                           minus_first_rotation_rss [urad],minus_first_rotation_p95 [urad]";

/// One line for each tool pose and machine. Cells of a kind that a machine does not have are empty.
fn csv(result: &CompareResult) -> String {
    let drawn = result.machines.iter().find_map(|machine| machine.bounds.as_ref()).map(|of| &of.figures.drawing);
    let measured = result.machines.iter().any(|machine| machine.bounds.is_none());
    let head = [
        Some("pose,file,x [mm],y [mm],z [mm],i,j,k"),
        measured.then_some(DEVIATION),
        drawn.map(|_| BOUNDED),
        drawn.map(|_| MINUS_FIRST),
        drawn.map(|_| "from,samples,seed"),
        result.over.path.then_some("event"),
    ];
    let mut csv = head.into_iter().flatten().collect::<Vec<_>>().join(",") + "\n";
    for (pose, row) in result.rows.iter().enumerate() {
        for (i, machine) in result.machines.iter().enumerate() {
            let place = numbers([row.tip_mm, row.direction].into_iter().flatten());
            let mut cells = vec![pose.to_string(), cell(&machine.file), place];
            let bounded = row.bounded[i].map(bound_columns);
            if measured {
                let deviation = &row.deviations[i];
                let (um, urad) = (deviation.position_mm.map(|x| x * 1e3), deviation.rotation_rad.map(|x| x * 1e6));
                let six = bounded.is_none().then(|| numbers([um, urad].into_iter().flatten()));
                cells.push(six.unwrap_or_else(|| ",".repeat(5)));
            }
            if let Some(drawn) = drawn {
                let first = row.bounded[0].map(bound_columns);
                let minus = bounded.zip(first).map(|(own, first)| std::array::from_fn(|k| own[k] - first[k]));
                cells.extend(
                    [bounded, minus].map(|four| four.map_or_else(|| ",".repeat(3), |four: [f64; 4]| numbers(four))),
                );
                let source = format!("bounds,{},{}", drawn.samples, drawn.seed);
                cells.push(bounded.map_or_else(|| "errors,,".to_owned(), |_| source));
            }
            cells.extend(row.events.get(i).cloned());
            csv.push_str(&(cells.join(",") + "\n"));
        }
    }
    csv
}

/// In the order of the columns, um and urad.
fn bound_columns(of: BoundedDeviation) -> [f64; 4] {
    let (p, r) = (of.position, of.rotation);
    [p.rss * 1e3, p.p95 * 1e3, r.rss * 1e6, r.p95 * 1e6]
}

/// The rows of statistics of a machine.
fn machine_rows(name: &str, machine: &ComparedMachine, poses: usize) -> Vec<Vec<String>> {
    match &machine.bounds {
        Some(of) => bounded::rows(name, poses, &of.figures),
        None => statistics_rows(name, &machine.statistics(poses)).to_vec(),
    }
}

/// The rows of the differences of a machine to the first; none where of only one of the two nothing is measured.
fn minus_rows(name: &str, machine: &ComparedMachine, poses: usize) -> Vec<Vec<String>> {
    let Some(Difference { position_um, rotation_urad }) = machine.minus_first else { return Vec::new() };
    let difference = Statistics { poses, position_um, rotation_urad };
    match machine.bounds.as_ref().and_then(|of| of.rss_minus_first) {
        Some(rss) => bounded::difference_rows(name, &difference, &rss),
        None => statistics_rows(name, &difference).to_vec(),
    }
}

/// Source of the figures of machines of which nothing is measured.
fn sources(result: &CompareResult) -> String {
    let of = |(i, machine): (usize, &ComparedMachine)| match (&machine.bounds, &machine.bounds_add) {
        (Some(of), _) => format!("  {}  nothing is measured. {}\n", i + 1, bounded::source(&of.figures)),
        (None, Some(of)) => format!("  {}  {}", i + 1, bounded::bounded_contribution(of)),
        (None, None) => String::new(),
    };
    let list: String = result.machines.iter().enumerate().map(of).collect();
    let bounds = result.machines.iter().any(|machine| machine.bounds.is_some());
    if bounds { format!("{list}{}\n", bounded::ROWS_NOTE) } else { list }
}

fn text(args: &Args, result: &CompareResult) -> String {
    let mut text = headlines::compare(result).lines().map(fold).collect::<String>() + &bounds_sources(result);
    text += &format!(
        "{}{} tool poses in the workpiece frame, {}; {} reached by all\n",
        result.over.text(),
        result.asked,
        match (result.over.kind, args.tool_poses.tool_poses.as_ref().or(args.job.job.as_ref())) {
            (OverKind::Volume, _) => format!("drawn from the volume of {}", result.machines[0].machine),
            (OverKind::Job, Some(path)) => format!("of {}", path.display()),
            (OverKind::AxisPoses, _) => format!("of the poses of the axes of {}", result.machines[0].machine),
            (OverKind::Job, None) => format!("of the job of {}", result.machines[0].file),
        },
        result.poses
    );
    for (i, side) in result.machines.iter().enumerate() {
        let (number, missed) = (i + 1, side.unreachable);
        text.push_str(&format!("  {number}  {} ({}), {}: unreachable {missed}\n", side.machine, side.file, side.chain));
    }
    text.push_str(&sources(result));
    let mut rows = table(&STATISTICS);
    for (i, side) in result.machines.iter().enumerate() {
        let _ = rows.add_rows(machine_rows(&(i + 1).to_string(), side, result.poses));
    }
    for (i, side) in result.machines.iter().enumerate().skip(1) {
        let _ = rows.add_rows(minus_rows(&format!("{} - 1", i + 1), side, result.poses));
    }
    let mut reach = String::new();
    for (i, side) in result.machines.iter().enumerate() {
        if let (Some(missed), Some(travel)) = (&side.missed, &side.travel) {
            reach.push_str(&format!("Machine {}, {}:\n{}", i + 1, side.file, reach_text(missed, travel)));
            reach.push_str(&side.path.as_ref().map_or_else(String::new, path_text));
        }
    }
    let budgets = result.budgets.as_ref().map_or(String::new(), |of| budgets::text(of, &result.verdicts, args.top.top));
    let errors = one_by_one(result, args.top.top);
    let reach = uncertainty(result) + &reach;
    let best_fit = best_fit(result);
    format!("{text}{rows}\n{reach}{errors}{budgets}{best_fit}Negative differences: less error than machine 1.\n")
}

/// The figures without the best fit of each machine.
fn best_fit(result: &CompareResult) -> String {
    let Some(of) = &result.best_fit else { return String::new() };
    let mut rows = table(&["best fit, um", "95 % of poses", "max", "budget, 95 %"]);
    for (i, machine) in of.machines.iter().enumerate() {
        let budget = machine.budget_p95_um.map_or("-".to_owned(), |um| significant(um, 4));
        let [p95, max] = [machine.position_um.p95, machine.position_um.max].map(|um| significant(um, 4));
        let _ = rows.add_row([(i + 1).to_string(), p95, max, budget]);
    }
    format!("{rows}\n")
}

/// Where the bounds of each machine come from.
fn bounds_sources(result: &CompareResult) -> String {
    let Some(budgets) = &result.budgets else { return String::new() };
    let of = |budget: &ComparedBudget| {
        let own = budget.errors - budget.errors_by_class;
        match &budget.class {
            Some(class) if own == 0 => format!("all {} by class {class}", budget.errors),
            Some(class) => format!("{own} by its file, {} by class {class}", budget.errors_by_class),
            None if budget.unbounded > 0 => {
                format!("{own} by its file, {} with neither value nor bound", budget.unbounded)
            }
            None => format!("all {own} by its file"),
        }
    };
    let list: Vec<String> = (1..).zip(&budgets.machines).map(|(i, budget)| format!("{i}: {}", of(budget))).collect();
    fold(&format!("Bounds of machine {}.", list.join("; of ")))
}

/// Intervals of the figures and of their differences, and whether these are more than that.
fn uncertainty(result: &CompareResult) -> String {
    let of = || result.machines.iter().enumerate().filter_map(|(i, side)| Some((i, side.uncertainty.as_ref()?)));
    let own = of().map(|(i, bands)| ((i + 1).to_string(), &bands.own));
    let minus = of().skip(1).map(|(i, bands)| (format!("{} - 1", i + 1), &bands.minus_first));
    let mut text = bands::text(&own.chain(minus).collect::<Vec<_>>());
    for (i, bands) in of().skip(1) {
        let verdict = if bands.told_apart { "is more than" } else { "is WITHIN" };
        text += &format!("The difference {} - 1 of the 95 % position deviation {verdict} its uncertainty.\n", i + 1);
    }
    text
}

/// Errors with the largest effect in any of the machines.
fn one_by_one(result: &CompareResult, top: usize) -> String {
    let errors = &result.contributions;
    if errors.is_empty() || top == 0 {
        return String::new();
    }
    let mut rows = table_of_machines("alone, 95 %, um", result.machines.len());
    for e in errors.iter().take(top) {
        let own = e.um.iter().map(|um| um.map_or("-".to_owned(), |um| significant(um, 4)));
        let minus = e.minus_first.iter().skip(1).map(|um| significant(*um, 4));
        let _ = rows.add_row(std::iter::once(e.error.clone()).chain(own).chain(minus));
    }
    let more = errors_more(errors.len(), top);
    format!("{rows}\n{more}")
}
