//! `abbe enumerate`: all arrangements of the axes on the two sides of the bed, ranked on the same work.

use crate::analysis::Work;
use crate::analysis::budget::known;
use crate::analysis::enumerate::{Journal, Judge, MAX_ARRANGEMENTS, Rule, Study, TooMany, Walk, ranked, walks};
use crate::cli::output::progress::Progress;
use crate::cli::output::ranking::{By, Report, Setting};
use crate::cli::output::session::Session;
use crate::cli::store::journal::{Keeper, merged, shard};
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::tool_poses;
use crate::cli::tool_poses::Reached;
use crate::cli::{Exit, Format, Outcome, load};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{AxisKind, AxisName, Machine};
use rayon::prelude::*;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; its axes are placed anew, its volume is the work.
    machine: PathBuf,
    #[command(flatten)]
    pub(crate) tolerances: ToleranceArgs,
    /// Seed of poses and errors.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// What arrangements are judged by [default: budget, if any error is bounded].
    #[arg(long, value_enum)]
    by: Option<ByArg>,
    /// Only arrangements for which this holds, such as `C before A`, `Y carries A`, `at most 2 on table`;
    /// may be given again.
    #[arg(long, value_name = "RULE")]
    require: Vec<String>,
    /// At most so many axes carry the workpiece.
    #[arg(long, value_name = "N")]
    max_table: Option<usize>,
    /// So many of the machine's rotary axes at a time, every choice of them [default: all].
    #[arg(long, value_name = "N")]
    rotary: Option<usize>,
    /// How many tool poses.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    poses: u32,
    /// The work: tool poses in the workpiece frame, a CSV file with columns X, Y, Z and I, J, K or rotary axes.
    #[arg(long, value_name = "FILE", conflicts_with = "poses")]
    tool_poses: Option<PathBuf>,
    /// How many machines are drawn for the budget.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub(crate) samples: u32,
    /// Rank what reaches at least this share of the tool poses, in percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 50.0)]
    pub(crate) reach: f64,
    /// How many to list as text.
    #[arg(long, value_name = "K", default_value_t = 20)]
    pub(crate) top: usize,
    /// Keep results here; what is there already is not computed again.
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Compute only this part of the walks, into the state file.
    #[arg(long, value_name = "I/N", requires = "state")]
    shard: Option<String>,
    /// Put state files together instead of computing.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["state", "shard"])]
    merge: Vec<PathBuf>,
    /// Which of the machine's tools.
    #[arg(long)]
    tool: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ByArg {
    /// Errors drawn between tolerances.
    Budget,
    /// The errors that have values.
    Errors,
}

/// Poses times samples: as many figures are kept of the file's own arrangement.
const MAX_DRAWS: u64 = 20_000_000;

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let part = match args.shard.as_deref().map(shard) {
        Some(Ok(part)) => Some(part),
        Some(Err(message)) => return session.usage(&message),
        None => None,
    };
    if !(0.0..=100.0).contains(&args.reach) {
        return session.usage("`--reach` is a share in percent, 0 to 100");
    }
    let machine = load::machine(session, &args.machine, args.tool.as_deref())?;
    let rotary = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary).count();
    if args.rotary.is_some_and(|wanted| wanted > rotary) {
        return session.usage(&format!("`--rotary` is at most {rotary}: so many rotary axes has the machine"));
    }
    if args.tool_poses.is_none() {
        draws(session, args.poses.into(), args.samples.into())?;
    }
    let rules = rules(session, args, &machine)?;
    let walks = listed(session, args, &machine, &rules)?;
    let (judge, source) = judge(session, args, &machine)?;
    let (work, reached) = work(session, args, &machine)?;
    if let (Judge::Budget { samples, .. }, true) = (&judge, args.tool_poses.is_some()) {
        draws(session, work.len() as u64, *samples as u64)?;
    }
    let journal = Journal::new(fingerprint(args, &machine, &judge, &rules, &work), walks.len());
    let setting = Setting { args, machine: &machine, by: by(&judge), source, reached };
    let journal = if args.merge.is_empty() {
        let mut keeper = Keeper::new(session, args.state.as_deref(), journal)?;
        compute(session, &setting, (walks, judge, &work), part, &mut keeper)?;
        keeper.into_journal()
    } else {
        merged(session, &args.merge, journal)?
    };
    if !journal.is_complete() {
        return part_done(session, args, &journal);
    }
    let rows = journal.rows();
    let work = rows.iter().map(|row| row.reached + row.unreachable.total).max().unwrap_or(0);
    let report = Report { setting, work, ranking: ranked(rows, work, args.reach / 100.0) };
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

/// Refuses more draws than are kept.
fn draws(session: &mut Session, poses: u64, samples: u64) -> Outcome {
    let draws = poses * samples;
    if draws <= MAX_DRAWS {
        return Ok(());
    }
    let message = format!("{poses} poses and {samples} samples are {draws} drawn poses; {MAX_DRAWS} are kept at most");
    session.refuse(Diagnostic::new(codes::E0606, message).help("take fewer poses or `--samples`"))
}

/// The tool poses of the file, or random ones over the machine's volume.
fn work(session: &mut Session, args: &Args, machine: &Machine) -> Result<(Work, Option<Reached>), Exit> {
    let Some(path) = &args.tool_poses else {
        return Ok((Work::random(machine, args.poses as usize, args.seed), None));
    };
    let file = tool_poses::read(session, machine, path)?;
    let reached = file.reached(session, machine)?;
    Ok((Work::Listed(file.list(machine)), Some(reached)))
}

fn rules(session: &mut Session, args: &Args, machine: &Machine) -> Result<Vec<Rule>, Exit> {
    let names: Vec<&AxisName> = machine.axes().iter().map(|axis| &axis.name).collect();
    let sugar = args.max_table.map(|n| format!("at most {n} on table"));
    let mut rules = Vec::new();
    for text in args.require.iter().chain(&sugar) {
        match Rule::parse(text, &names) {
            Ok(rule) => rules.push(rule),
            Err(why) => {
                let help =
                    "write `X before Y`, `X carries Y`, `X on table`, `at most 2 on table`, or one of them after `not`";
                return session.refuse(Diagnostic::new(codes::E0608, shown(&why.to_string())).help(help));
            }
        }
    }
    Ok(rules)
}

fn listed(session: &mut Session, args: &Args, machine: &Machine, rules: &[Rule]) -> Result<Vec<Walk>, Exit> {
    let message = match walks(machine, args.rotary, rules) {
        Ok(list) if list.is_empty() => {
            let help = "take one of the rules back";
            let message = "the rules leave no arrangement";
            return session.refuse(Diagnostic::new(codes::E0609, message).help(help));
        }
        Ok(list) => return Ok(list),
        Err(TooMany::Before(usize::MAX)) => "the axes have more arrangements than can be counted".to_owned(),
        Err(TooMany::Before(count)) => format!("the axes have {count} arrangements before any is excluded"),
        Err(TooMany::After(count)) => format!("{count} arrangements are left"),
    };
    let help = "exclude what you would not build (`--require`, `--max-table`), take fewer rotary axes (`--rotary 2`), or take axes out of the chain";
    session
        .refuse(Diagnostic::new(codes::E0607, format!("{message}; {MAX_ARRANGEMENTS} are listed at most")).help(help))
}

fn judge(session: &mut Session, args: &Args, machine: &Machine) -> Result<(Judge, Option<String>), Exit> {
    let bounded = args.tolerances.class.is_some() || machine.errors().count() > known(machine);
    let by = args.by.unwrap_or(if bounded { ByArg::Budget } else { ByArg::Errors });
    if by == ByArg::Errors {
        return Ok((Judge::Errors, None));
    }
    let (bounds, source) = args.tolerances.bounds(session, machine)?;
    Ok((Judge::Budget { bounds, draws: args.tolerances.draws(args.seed), samples: args.samples as usize }, source))
}

fn by(judge: &Judge) -> By {
    match judge {
        Judge::Errors => By::Errors,
        Judge::Budget { bounds, .. } => By::Budget(bounds.clone()),
    }
}

/// What results depend on: everything resolved, and every option that changes a number.
fn fingerprint(args: &Args, machine: &Machine, judge: &Judge, rules: &[Rule], work: &Work) -> String {
    let rules: Vec<String> = rules.iter().map(Rule::to_string).collect();
    let bounds = match judge {
        Judge::Budget { bounds, samples, .. } => format!("{bounds:?} {samples} {:?}", args.tolerances.distribution()),
        Judge::Errors => "errors".to_owned(),
    };
    let options = (args.rotary, args.poses, args.seed, args.tolerances.statistic());
    let listed = if args.tool_poses.is_some() { format!(" {work:?}") } else { String::new() };
    let text = format!("{} {machine:?} {rules:?} {bounds} {options:?}{listed}", env!("CARGO_PKG_VERSION"));
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Walk by walk what is not there yet, kept every now and then.
fn compute(
    session: &mut Session,
    setting: &Setting<'_>,
    (walks, judge, work): (Vec<Walk>, Judge, &Work),
    part: Option<(usize, usize)>,
    keeper: &mut Keeper,
) -> Outcome {
    let args = setting.args;
    let mine = |step: &usize| part.is_none_or(|(i, n)| step % n == i - 1);
    let todo: Vec<usize> = (0..walks.len()).filter(mine).filter(|step| !keeper.has(*step)).collect();
    if !todo.is_empty() {
        let study = Study::new(setting.machine, walks, judge, args.tolerances.statistic(), work);
        let progress = Progress::new(todo.len(), session.is_quiet());
        todo.into_par_iter().for_each(|step| {
            if !keeper.has_failed() {
                keeper.keep(step, study.step(step));
                progress.add(1);
            }
        });
    }
    keeper.finish().or_else(|d| session.refuse(d))
}

fn part_done(session: &mut Session, args: &Args, journal: &Journal) -> Outcome {
    let state = args.state.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let (done, steps) = (journal.done.len(), journal.steps);
    match session.format() {
        Format::Json => session.print_json(json!({"state": state, "walks_done": done, "walks": steps})),
        _ => session.print(&format!(
            "{done} of {steps} walks are done and kept in {state}; put the parts together with `--merge`\n"
        )),
    }
    Ok(())
}
