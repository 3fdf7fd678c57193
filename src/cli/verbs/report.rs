//! `abbe report`: one self-contained HTML page for a design review.

use crate::cli::arguments::{AxisPosesArg, DirectionArg, OrderArg, SamplesArg, help};
use crate::cli::how::SetArgs;
use crate::cli::output::session::Session;
use crate::cli::output::view::folded;
use crate::cli::store::engine;
use crate::cli::store::write::{refuse_outputs, write_whole};
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::verbs::workbench;
use crate::cli::{Exit, Format, Outcome};
use abbe::results::Report;
use abbe::{ReportOptions, report};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(mut_arg("axis_poses", |option| option.conflicts_with_all(["tool_poses", "job"])))]
pub(crate) struct Args {
    /// The machine file; with several, they are compared on the tool poses of the first.
    #[arg(required = true, num_args = 1..=8)]
    pub machines: Vec<PathBuf>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "The page to write",
        required_unless_present = "watch")]
    pub out: Option<PathBuf>,
    #[arg(long, value_name = "NAME", help = help::TARGET,
        long_help = "A controller whose compensation and certificate are to be shown; may be given several times. \
            Kinematic parameters and tables for what they leave, step by step: A+B")]
    pub target: Vec<String>,
    /// Open the workbench instead, which follows the machine file and the files that it names.
    #[arg(long, conflicts_with = "out")]
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
    axis_poses: AxisPosesArg,
    #[command(flatten)]
    options: SetArgs,
}

impl Args {
    fn options(&self) -> ReportOptions {
        ReportOptions {
            targets: self.target.clone(),
            compensation: self.options.how.options(),
            poses: self.options.poses.poses,
            tool_poses: self.options.tool_poses.tool_poses.clone(),
            axis_poses: self.axis_poses.axis_poses.clone(),
            job: self.options.job.job.clone(),
            path: self.options.job.path,
            reference: self.options.reference.reference.clone(),
            seed: self.options.seed.seed,
            order: self.order.order,
            approach: self.direction.direction,
            tolerances: self.tolerances.options(),
            samples: self.samples.samples,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if args.watch {
        let [machine] = &args.machines[..] else {
            return session.usage("the workbench holds one machine: give one file with --watch");
        };
        if args.options() != ReportOptions::default() || args.options.tool.name().is_some() {
            return session.usage("with --watch the page has the options: only --port goes with it");
        }
        return workbench::open(session, machine, workbench::PartAsked::default(), args.port);
    }
    let ending = args.out.as_ref().and_then(|out| out.extension()?.to_str()).map(str::to_lowercase);
    if let Some(ending) = ending.filter(|of| ["pdf", "docx", "pptx"].contains(&of.as_str())) {
        return session
            .usage(&format!("a report is a page of HTML, not .{ending}: name it .html; a browser prints it as PDF"));
    }
    refuse_outputs(&args.out, &session.files).or_else(|d| session.refuse(d))?;
    let report = compute(session, args)?;
    let page = report.page(&engine::engines()).or_else(|d| session.refuse(d))?;
    let (out, bytes) = (args.out.as_deref().unwrap_or(Path::new("")), page.text.len());
    write_whole(out, page.text.as_bytes(), &session.files).or_else(|d| session.refuse(d))?;
    match session.format() {
        Format::Json => {
            session.print_json(json!({"page": out.display().to_string(), "bytes": bytes, "engines": page.variants}));
        }
        _ => {
            let size = bytes.div_ceil(1000);
            session.print(&folded(&format!("{}: {size} kB, self-contained{}", out.display(), answers(&page.variants))));
        }
    }
    Ok(())
}

/// Words for what the page can do without the program.
fn answers(variants: &[String]) -> String {
    match variants {
        [] => "; it shows this state only, for this program was not packaged with WebAssembly".to_owned(),
        _ => format!("; it answers what-ifs by itself (WebAssembly: {})", variants.join(", ")),
    }
}

/// Reads the machines and computes the content of the page.
fn compute(session: &mut Session, args: &Args) -> Result<Report, Exit> {
    let mut machines = Vec::new();
    for path in &args.machines {
        let tool = args.options.tool.name();
        let several = args.machines.len() > 1;
        machines.push(if several { session.load_one_of(path, tool) } else { session.load(path, tool) }?);
    }
    session.take(report(&machines, &args.options(), session.run()))
}
