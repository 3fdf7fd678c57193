//! `abbe enumerate`: all arrangements of the axes on the two sides of the bed, ranked on the same work.

use crate::cli::Outcome;
use crate::cli::arguments::{
    JobArg, MaxSamplesArg, PartsArgs, PosesArg, ReferenceArg, SamplesArg, SeedArg, ToolArg, ToolPosesArg, TopArg,
    percent,
};
use crate::cli::output::ranking;
use crate::cli::output::session::Session;
use crate::cli::store::study_file::StateFile;
use crate::cli::store::write::refuse_outputs;
use crate::cli::tolerances::ToleranceArgs;
use abbe::options::{JudgedBy, StudyFile};
use abbe::results::{EnumerateResult, StudyProgress};
use abbe::{EnumerateOptions, enumerate};
use std::path::PathBuf;

/// An answer to a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum YesNo {
    Yes,
    No,
}

#[derive(Debug, clap::Args)]
#[command(mut_arg("tool_poses", |option| option.conflicts_with("poses")))]
#[command(mut_arg("job", |option| option.conflicts_with_all(["poses", "tool_poses"])))]
#[command(mut_arg("poses", |option| option.default_value("500")))]
#[command(mut_arg("samples", |option| option.default_value("200")))]
pub(crate) struct Args {
    /// The machine file; its axes are placed anew, its volume is the work.
    machine: PathBuf,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    #[command(flatten)]
    seed: SeedArg,
    /// Criterion of the arrangements [default: budget, if any error is bounded].
    #[arg(long, value_enum)]
    by: Option<JudgedBy>,
    /// Only arrangements for which this holds, such as `C before A`, `Y carries A`, `at most 2 on table`;
    /// may be given again.
    #[arg(long, value_name = "RULE")]
    require: Vec<String>,
    /// Leave out what is hardly built, unless the file has it: linear above rotary on the table, five axes below the
    /// part, three rotary in the head.
    #[arg(long, value_enum, default_value_t = YesNo::Yes)]
    buildable: YesNo,
    /// Maximum number of axes that carry the workpiece (0 or more) [default: all].
    #[arg(long, value_name = "N")]
    max_table: Option<usize>,
    /// Number of the machine's rotary axes taken at a time, every choice of them (0 or more) [default: all].
    #[arg(long, value_name = "N")]
    rotary: Option<usize>,
    #[command(flatten)]
    poses: PosesArg,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    reference: ReferenceArg,
    /// Give linear axes the travel that the work needs, whatever the file says, and tell it for every arrangement.
    #[arg(long)]
    size: bool,
    #[command(flatten)]
    samples: SamplesArg,
    #[command(flatten)]
    max_samples: MaxSamplesArg,
    /// Draw more machines until the first K ranks are told apart (1 to 1000).
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    first: u32,
    /// List by its figure what misses tool poses but reaches this share of them, in percent (0 to 100).
    #[arg(long, value_name = "PERCENT", default_value_t = 50.0, value_parser = percent)]
    reach: f64,
    #[command(flatten)]
    top: TopArg,
    #[command(flatten)]
    parts: PartsArgs,
    #[command(flatten)]
    tool: ToolArg,
}

impl Args {
    fn options(&self) -> EnumerateOptions {
        EnumerateOptions {
            tolerances: self.tolerances.options(),
            seed: self.seed.seed,
            by: self.by,
            require: self.require.clone(),
            buildable: self.buildable == YesNo::Yes,
            max_table: self.max_table,
            rotary: self.rotary,
            poses: self.poses.poses,
            tool_poses: self.tool_poses.tool_poses.clone(),
            job: self.job.job.clone(),
            path: self.job.path,
            reference: self.reference.reference.clone(),
            size: self.size,
            samples: self.samples.samples,
            max_samples: self.max_samples.max_samples,
            first: self.first as usize,
            reach_percent: self.reach,
            state: self.parts.state.clone(),
            shard: self.parts.shard,
            merge: self.parts.merge.clone(),
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = session.load(&args.machine, args.tool.name())?;
    refuse_outputs(&args.parts.state, &session.files).or_else(|d| session.refuse(d))?;
    let file = args.parts.state.as_deref().map(StateFile::new);
    let file = file.as_ref().map(|file| file as &dyn StudyFile);
    let result = session.take(enumerate(&machine, &args.options(), file, session.run()))?;
    let ranked = match &result {
        EnumerateResult::Part(progress) => return print_progress(session, progress),
        EnumerateResult::Ranked(ranked) => ranked,
    };
    session.show(ranked, || ranking::csv(ranked), || ranking::text(ranked, args.top.top))
}

fn print_progress(session: &Session, progress: &StudyProgress) -> Outcome {
    let StudyProgress { state, round, walks_done, walks } = progress;
    let text = || {
        format!(
            "{walks_done} of {walks} walks of round {round} are done and kept in {state}; put the parts together with \
             `--merge`\n"
        )
    };
    session.show(progress, text, text)
}
