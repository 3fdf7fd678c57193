//! `abbe identify`: measurements to error parameters, and a fitted machine file.

use crate::cli::Outcome;
use crate::cli::arguments::{FrameOption, NoiseArg, OrderArg, ProbeArgs, SeedArg, ToolArg, counts, help, length};
use crate::cli::output::session::Session;
use crate::cli::output::{identify_report, monomials, pictures, plan, predicted};
use crate::cli::store::write;
use abbe::options::{FitAcceptance, FitRange, Order, PlanInstrument, ProbeSizes};
use abbe::text::Reason;
use abbe::{IdentifyOptions, PlanOptions, PredictOptions, fit_monomials, identify, plan_measurements, predict};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[arg(long, value_name = "FILE", num_args = 1.., required_unless_present_any = ["plan", "predict"],
        help = help::DATA)]
    data: Vec<PathBuf>,
    #[arg(long, value_name = "FILE", help = help::AXIS_POSES, conflicts_with = "plan",
        long_help = "Poses at which the points of a laser tracker's export were measured: a column for each axis, and \
                     `point`, or a row for each point in their order")]
    axis_poses: Option<PathBuf>,
    /// Parameters to fit: `needed` (location errors that the chain needs), `location`, `tool`, `tools`, `tools-by-run`,
    /// `workpiece`, `workpiece-by-run`, `spindle`, `linear`, error names, `EXX:poly3` [default: the section `identify`
    /// of the machine file, else `needed`].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fit: Vec<String>,
    /// Parameters that keep their value although a group names them.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fixed: Vec<String>,
    /// A value known before the data, with its standard uncertainty: `ball b1 50 um`, `EC0Y 5 urad`, `constant S = 150
    /// mm 1 um`, `distance b1 b2 = 50 mm 20 um` (between two balls or stations); `file`: what the machine file states.
    /// May be repeated.
    #[arg(long, value_name = "PRIOR")]
    prior: Vec<String>,
    #[arg(long, value_name = "UNCERTAINTY", conflicts_with = "plan", help = help::TYPE_B)]
    type_b: Vec<String>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "Write the fitted machine to this file")]
    out: Option<PathBuf>,
    /// Judge the fit over the volume of the file, or over the range in which axes with fitted curves were measured.
    /// That becomes the `volume` of the fitted machine.
    #[arg(long, value_enum, default_value = "travel", conflicts_with = "plan")]
    range: Range,
    #[arg(long, value_enum, value_name = "WORDS", value_delimiter = ',', requires = "out", help = help::ACCEPT)]
    accept: Vec<FitAcceptance>,
    #[arg(long, requires = "out", hide = true)]
    accept_undetermined: bool,
    #[command(flatten)]
    frame: FrameOption,
    #[command(flatten)]
    order: OrderArg,
    /// Method: all components at once on the model itself, or as in the papers, each for itself on the monomials.
    #[arg(long, value_enum, default_value = "joint")]
    method: Method,
    /// Say how well the machine file predicts these readings: nothing is fitted but the set-up.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = [
        "data", "plan", "out", "fit", "fixed", "prior", "folds", "robust", "range", "order", "method", "pictures"])]
    predict: Vec<PathBuf>,
    /// Draw prediction and data over the planes of the linear axes, as SVG files in this folder.
    #[arg(long, value_name = "DIR", alias = "svg")]
    pictures: Option<PathBuf>,
    /// Let measurements that stand out count less (Huber weights).
    #[arg(long)]
    robust: bool,
    /// Check the prediction: leave out every measurement once, in this many parts (2 to 65535) [default: no check].
    #[arg(long, value_name = "PARTS", value_parser = counts(2..=65_535))]
    folds: Option<usize>,
    /// Propose N readings to take (1 to 1000), with the uncertainty that the parameters will have. They are poses, of a
    /// laser lines, out of `--data`, whose cells of readings are empty, or of an instrument. Nothing is fitted
    /// [default: fit].
    #[arg(long, value_name = "N", conflicts_with_all = ["out", "folds", "robust"], value_parser = counts(1..=1000))]
    plan: Option<usize>,
    /// Plan only as many of the readings as predict the volume with this largest standard uncertainty (above 0), such
    /// as `1 um` [default: all of them].
    #[arg(long, value_name = "LENGTH", requires = "plan", value_parser = until)]
    until: Option<f64>,
    /// The instrument of a plan: three components anywhere or along lines of axes, balls on the table, a tracker, a
    /// laser along lines, or a touch probe at balls.
    #[arg(long, value_enum, default_value = "points", requires = "plan", conflicts_with = "data")]
    instrument: PlanInstrument,
    /// R-test or touch probe of a plan: a pose at which the functional point is at a ball on the table, other axes in
    /// the middle or at 0. May be repeated [default: one ball, three quarters along the axes].
    #[arg(long, value_name = "X=100,Y=50", requires = "plan")]
    ball: Vec<String>,
    /// Ranges of axes to which the readings of a plan are confined, mm and deg.
    #[arg(long, value_name = "A=-60..60,C=0..180", requires = "plan", conflicts_with = "data")]
    ranges: Option<String>,
    #[command(flatten)]
    probe: ProbeArgs,
    #[command(flatten)]
    noise: NoiseArg,
    #[command(flatten)]
    seed: SeedArg,
    #[command(flatten)]
    tool: ToolArg,
}

/// Ways to solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// One weighted least-squares problem, Levenberg-Marquardt.
    Joint,
    /// Holub and others 2015: monomials of order 2, component by component, pseudo-inverse.
    MoorePenrose,
}

/// Parts of the volume over which a fit is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Range {
    /// The volume of the machine file.
    Travel,
    /// What was measured.
    Measured,
}

impl Args {
    fn options(&self) -> IdentifyOptions {
        IdentifyOptions {
            data: self.data.clone(),
            fit: self.fit.clone(),
            fixed: self.fixed.clone(),
            priors: self.prior.clone(),
            type_b: self.type_b.clone(),
            frame: self.frame.frame,
            axis_poses: self.axis_poses.clone(),
            order: self.order.order,
            robust: self.robust,
            folds: self.folds,
            range: match self.range {
                Range::Travel => FitRange::Travel,
                Range::Measured => FitRange::Measured,
            },
            machine_file: self.out.is_some(),
            noise_mm: self.noise.noise,
            accept: self.accept.clone(),
            accept_undetermined: self.accept_undetermined,
            pictures: self.pictures.is_some(),
            ..IdentifyOptions::default()
        }
    }

    fn predict_options(&self) -> PredictOptions {
        PredictOptions {
            data: self.predict.clone(),
            frame: self.frame.frame,
            axis_poses: self.axis_poses.clone(),
            type_b: self.type_b.clone(),
            noise_mm: self.noise.noise,
            seed: self.seed.seed,
            ..PredictOptions::default()
        }
    }

    fn plan_options(&self, poses: usize) -> PlanOptions {
        PlanOptions {
            poses,
            instrument: self.instrument,
            balls: self.ball.clone(),
            probe: self.probe.sizes(),
            ranges: self.ranges.clone(),
            candidates: self.data.first().cloned(),
            fit: self.fit.clone(),
            fixed: self.fixed.clone(),
            priors: self.prior.clone(),
            noise_mm: self.noise.noise.unwrap_or(1e-3),
            seed: self.seed.seed,
            until_mm: self.until,
        }
    }
}

/// A length above zero and up to 1 m.
fn until(text: &str) -> Result<f64, Reason> {
    length(text, |mm| mm > 0.0 && mm <= 1000.0, "write a length above zero and up to 1 m, such as `1 um`")
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if matches!(args.order.order, Some(Order::Degree(3..))) {
        return session.usage("a model is fitted with `--order exact`, `--order 1` or `--order 2`");
    }
    let file = session.load(&args.machine, args.tool.name())?;
    if let Some(poses) = args.plan {
        if args.data.len() > 1 {
            return session.usage("a plan chooses from one file of readings");
        }
        let plan = session.take(plan_measurements(&file, &args.plan_options(poses), session.run()))?;
        return session.show(&plan, || plan.csv.clone(), || plan::text(&plan));
    }
    if !args.predict.is_empty() {
        let result = session.take(predict(&file, &args.predict_options(), session.run()))?;
        return session.show(&result, || predicted::csv(&result), || predicted::text(&result));
    }
    if args.probe.sizes() != ProbeSizes::default() {
        return session.usage("sizes of balls and probe are of a plan: `--plan N --instrument touch`");
    }
    refuse_outputs(session, args)?;
    if args.method == Method::MoorePenrose {
        let fit = session.take(fit_monomials(&file, &args.options(), session.run()))?;
        if let Some(folder) = &args.pictures {
            pictures::write(session, &fit.pictures, folder)?;
        }
        return session.show(&fit, || monomials::csv(&fit), || monomials::text(&fit));
    }
    let result = session.take(identify(&file, &args.options(), session.run()))?;
    if let (Some(out), Some(text)) = (&args.out, &result.machine_file) {
        write::write_whole(out, text.as_bytes(), &session.files).or_else(|refusal| session.refuse(refusal))?;
    }
    if let Some(folder) = &args.pictures {
        pictures::write(session, &result.pictures, folder)?;
    }
    session.show(&result, || identify_report::csv(&result), || identify_report::text(&result))
}

/// Refuses outputs before the work, not after it.
fn refuse_outputs(session: &mut Session, args: &Args) -> Outcome {
    let folders = || args.pictures.iter().try_for_each(|folder| write::refuse_no_folder(folder));
    write::refuse_outputs(&args.out, &session.files).and_then(|()| folders()).or_else(|refusal| session.refuse(refusal))
}
