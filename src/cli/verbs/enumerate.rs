//! `abbe enumerate`: all arrangements of the axes on the two sides of the bed, ranked on the same work.

use crate::cli::output::ranking;
use crate::cli::output::session::Session;
use crate::cli::store::study_file::StateFile;
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::{Format, Outcome};
use abbe::options::{JudgedBy, StudyFile};
use abbe::results::{EnumerateResult, StudyProgress};
use abbe::{EnumerateOptions, enumerate};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; its axes are placed anew, its volume is the work.
    machine: PathBuf,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    /// Seed of poses and errors.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Criterion of the arrangements [default: budget, if any error is bounded].
    #[arg(long, value_enum)]
    by: Option<ByArg>,
    /// Only arrangements for which this holds, such as `C before A`, `Y carries A`, `at most 2 on table`;
    /// may be given again.
    #[arg(long, value_name = "RULE")]
    require: Vec<String>,
    /// Maximum number of axes that carry the workpiece.
    #[arg(long, value_name = "N")]
    max_table: Option<usize>,
    /// Number of the machine's rotary axes taken at a time, every choice of them [default: all].
    #[arg(long, value_name = "N")]
    rotary: Option<usize>,
    /// Number of tool poses.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    poses: u32,
    /// The work: tool poses in the workpiece frame, APT CL data or a table with columns X, Y, Z and I, J, K or rotary
    /// axes.
    #[arg(long, value_name = "FILE", conflicts_with = "poses")]
    tool_poses: Option<PathBuf>,
    /// Give linear axes the travel that the work needs, whatever the file says, and tell it for every arrangement.
    #[arg(long)]
    size: bool,
    /// Number of machines drawn of every arrangement for the budget.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    samples: u32,
    /// Maximum number of machines drawn of an arrangement that could be among the first [default: 8 times --samples].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    max_samples: Option<u32>,
    /// Draw more machines until the first K ranks are told apart.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    first: u32,
    /// Rank what reaches at least this share of the tool poses, in percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 50.0)]
    reach: f64,
    /// Number of arrangements listed as text.
    #[arg(long, value_name = "K", default_value_t = 20)]
    top: usize,
    /// Keep results here; what is there already is not computed again.
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Compute only this part of the walks of one round, into the state file.
    #[arg(long, value_name = "I/N", requires = "state")]
    shard: Option<String>,
    /// Put the first round together from state files, and go on from there.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    merge: Vec<PathBuf>,
    /// Tool of the machine, by name [default: the first].
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

impl Args {
    fn options(&self, shard: Option<(usize, usize)>) -> EnumerateOptions {
        let by = |by: ByArg| match by {
            ByArg::Budget => JudgedBy::Budget,
            ByArg::Errors => JudgedBy::Errors,
        };
        EnumerateOptions {
            tolerances: self.tolerances.options(),
            seed: self.seed,
            by: self.by.map(by),
            require: self.require.clone(),
            max_table: self.max_table,
            rotary: self.rotary,
            poses: self.poses as usize,
            tool_poses: self.tool_poses.clone(),
            size: self.size,
            samples: self.samples as usize,
            max_samples: self.max_samples.map(|limit| limit as usize),
            first: self.first as usize,
            reach_percent: self.reach,
            state: self.state.clone(),
            shard,
            merge: self.merge.clone(),
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let part = match args.shard.as_deref() {
        None => None,
        Some(text) => match shard(text) {
            None => return session.usage(&format!("`--shard {text}` is not a part such as `2/3`")),
            part => part,
        },
    };
    let machine = session.load(&args.machine, args.tool.as_deref())?;
    let file = args.state.as_deref().map(StateFile::new);
    let file = file.as_ref().map(|file| file as &dyn StudyFile);
    let answer = enumerate(&machine, &args.options(part), file, session.run());
    let result = session.take(answer)?;
    let ranked = match &result {
        EnumerateResult::Part(progress) => return part_done(session, progress),
        EnumerateResult::Ranked(ranked) => ranked,
    };
    match session.format() {
        Format::Json => session.print_json(json!(ranked)),
        Format::Csv => session.print(&ranking::csv(ranked)),
        Format::Text => session.print(&ranking::text(ranked, args.top)),
    }
    Ok(())
}

/// `2/3`: the second of three parts.
fn shard(text: &str) -> Option<(usize, usize)> {
    let (i, n) = text.split_once('/')?;
    let (i, n) = (i.parse().ok()?, n.parse().ok()?);
    (1..=n).contains(&i).then_some((i, n))
}

fn part_done(session: &Session, progress: &StudyProgress) -> Outcome {
    let StudyProgress { state, round, walks_done, walks } = progress;
    match session.format() {
        Format::Json => session.print_json(json!(progress)),
        _ => session.print(&format!(
            "{walks_done} of {walks} walks of round {round} are done and kept in {state}; put the parts together with \
             `--merge`\n"
        )),
    }
    Ok(())
}
