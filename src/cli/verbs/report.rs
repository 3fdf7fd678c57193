//! `abbe report`: one self-contained HTML page for a design review.

use crate::cli::arguments::{DirectionArg, OrderArg, SamplesArg, ToolPosesArg, help};
use crate::cli::how::SetArgs;
use crate::cli::output::session::Session;
use crate::cli::store::write::{refuse_outputs, write_whole};
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::{Exit, Format, Outcome, watch};
use abbe::options::Delivery;
use abbe::results::{RenderedPage, Report};
use abbe::{ReportOptions, report};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; with several, they are compared on the tool poses of the first.
    #[arg(required = true, num_args = 1..=8)]
    pub machines: Vec<PathBuf>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "The page to write",
        required_unless_present = "watch")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[arg(long, value_name = "NAME", help = help::TARGET,
        long_help = "A controller whose compensation and certificate are to be shown; may be given several times. \
            Kinematic parameters and tables for what they leave, step by step: A+B")]
    pub target: Vec<String>,
    /// Serve the page on 127.0.0.1 and refresh it whenever the machine file, or a file it names, is saved.
    #[arg(long)]
    pub watch: bool,
    /// Port on 127.0.0.1 (0 to 65535) [default: any that is free].
    #[arg(long, requires = "watch", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    #[command(flatten)]
    order: OrderArg,
    #[command(flatten)]
    direction: DirectionArg,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    #[command(flatten)]
    samples: SamplesArg,
    #[command(flatten)]
    options: SetArgs,
}

impl Args {
    fn options(&self) -> ReportOptions {
        ReportOptions {
            targets: self.target.clone(),
            compensation: self.options.how.options(),
            poses: self.options.poses.count(),
            tool_poses: self.tool_poses.path().cloned(),
            seed: self.options.seed.seed,
            order: self.order.order,
            approach: self.direction.approach(),
            tolerances: self.tolerances.options(),
            samples: self.samples.count(),
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if args.watch {
        return watch::run(session, args);
    }
    refuse_outputs(&args.out, &session.files).or_else(|d| session.refuse(d))?;
    let report = compute(session, args)?;
    let page = report.page(Delivery::Alone, None).or_else(|d| session.refuse(d))?;
    write(session, args, &page)?;
    let (out, bytes) = (args.out.as_deref().unwrap_or(Path::new("")), page.text.len());
    match session.format() {
        Format::Json => session.print_json(json!({"page": out.display().to_string(), "bytes": bytes})),
        _ => session.print(&format!("{}: {} kB, self-contained", out.display(), bytes.div_ceil(1000))),
    }
    Ok(())
}

/// Writes the page where it was asked for.
pub(crate) fn write(session: &mut Session, args: &Args, page: &RenderedPage) -> Outcome {
    let Some(out) = &args.out else { return Ok(()) };
    write_whole(out, page.text.as_bytes(), &session.files).or_else(|d| session.refuse(d))
}

/// Reads the machines and computes the content of the page.
pub(crate) fn compute(session: &mut Session, args: &Args) -> Result<Report, Exit> {
    let mut machines = Vec::new();
    for path in &args.machines {
        let tool = args.options.tool.name();
        let several = args.machines.len() > 1;
        machines.push(if several { session.load_one_of(path, tool) } else { session.load(path, tool) }?);
    }
    let answer = report(&machines, &args.options(), session.run());
    session.take(answer)
}
