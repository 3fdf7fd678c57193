//! `abbe report`: one self-contained HTML page for a design review.

use crate::cli::how::SetArgs;
use crate::cli::output::session::Session;
use crate::cli::output::view::{ApproachArg, order};
use crate::cli::store::write::{refuse_outputs, write_whole};
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::{Exit, Format, Outcome, watch};
use abbe::options::{Delivery, Order};
use abbe::results::{RenderedPage, Report};
use abbe::{ReportOptions, report};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; with several, they are compared on the tool poses of the first.
    #[arg(required = true, num_args = 1..=8)]
    pub machines: Vec<PathBuf>,
    /// The page to write.
    #[arg(long, value_name = "FILE.html", required_unless_present = "watch")]
    pub out: Option<PathBuf>,
    /// Take statistics and comparison at these tool poses in the workpiece frame instead of random poses: CSV with
    /// columns X, Y, Z and I, J, K or rotary axes, or APT CL data.
    #[arg(long, value_name = "FILE")]
    tool_poses: Option<PathBuf>,
    /// A controller whose compensation and certificate are to be shown; may be given several times.
    #[arg(long, value_name = "NAME")]
    pub target: Vec<String>,
    /// Serve the page on 127.0.0.1 and refresh it whenever the machine file, or a file it names, is saved.
    #[arg(long)]
    pub watch: bool,
    /// The port of `--watch` [default: any that is free].
    #[arg(long, requires = "watch", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// 1 to 6, or `exact` (the default, unless the conventions' preset names an order).
    #[arg(long, value_parser = order)]
    order: Option<Order>,
    /// Direction of approach where forward and reverse curves were given.
    #[arg(long, value_enum, default_value = "mean")]
    direction: ApproachArg,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    /// Number of machines to draw for a budget, which is shown where errors are bounded.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    samples: u32,
    #[command(flatten)]
    options: SetArgs,
}

impl Args {
    fn options(&self) -> ReportOptions {
        ReportOptions {
            targets: self.target.clone(),
            compensation: self.options.how.options(),
            poses: self.options.poses as usize,
            tool_poses: self.tool_poses.clone(),
            seed: self.options.seed,
            order: self.order,
            approach: self.direction.into(),
            tolerances: self.tolerances.options(),
            samples: self.samples as usize,
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
        machines.push(session.load(path, args.options.tool.as_deref())?);
    }
    let answer = report(&machines, &args.options(), session.run());
    session.take(answer)
}
