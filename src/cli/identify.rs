//! `abbe identify`: measurements to error parameters, and a fitted machine file.

use super::files::Disk;
use super::session::Session;
use super::{Format, Outcome, Stop, load, plan, poses, write};
use crate::diagnostic::Diagnostic;
use crate::identify::{
    Estimate, Fit, Measurement, Model, Parameter, Residuals, Solution, fit, fitted_file, held_out, parameters,
    read_measurements, repeatability, robust_fit,
};
use crate::machine::{self, Machine};
use crate::syntax::IdentifyEntry;
use crate::units::{self, significant};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Measurements: CSV with a column per axis and any of `dx [um]`, `dy [um]`, `dz [um]`.
    #[arg(long, value_name = "FILE", num_args = 1.., required_unless_present = "plan")]
    data: Vec<PathBuf>,
    /// What to fit: `location`, `tool`, `workpiece`, `spindle`, `linear`, error names, `EXX:poly3` (default: the
    /// section `identify` of the machine file).
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fit: Vec<String>,
    /// What keeps its value although a group names it.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fixed: Vec<String>,
    /// Where to write the fitted machine.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Frame in which the deviations were measured.
    #[arg(long, value_enum, default_value = "workpiece")]
    frame: super::eval::FrameArg,
    /// Let measurements that stand out count less (Huber weights).
    #[arg(long)]
    robust: bool,
    /// Check the prediction: leave out every measurement once, in this many parts.
    #[arg(long, value_name = "PARTS", value_parser = clap::value_parser!(u16).range(2..))]
    folds: Option<u16>,
    /// Propose so many poses to measure, and say how well they will tell the parameters. Nothing is fitted.
    #[arg(long, value_name = "POSES", conflicts_with_all = ["data", "out", "folds", "robust"],
          value_parser = clap::value_parser!(u16).range(1..=1000))]
    plan: Option<u16>,
    /// Standard deviation of a reading to plan with.
    #[arg(long, value_name = "LENGTH", default_value = "1 um", value_parser = noise)]
    noise: f64,
    /// Seed of the poses to choose from.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Which of the machine's tools was in use where the data name none.
    #[arg(long)]
    tool: Option<String>,
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let (machine, section) = load::with_identify(session, &args.machine, args.tool.as_deref())?;
    let wanted = request(args, section);
    let parameters = match parameters(&machine, &wanted) {
        Ok(parameters) => parameters,
        Err(refusal) => return session.refuse(*refusal),
    };
    if let Some(count) = args.plan {
        let model = Model::new(&machine, &parameters, args.frame.into());
        return plan::run(session, &model, usize::from(count), args.noise, args.seed);
    }
    let data = measurements(session, &machine, &args.data)?;
    enough(session, &data, &parameters)?;
    let model = Model::new(&machine, &parameters, args.frame.into());
    let found = if args.robust {
        robust_fit(&model, &data)
    } else {
        fit(&model, &data, data.iter().map(|m| m.weight).collect(), None)
    };
    let folds = args.folds.map(usize::from);
    let solution = Solution::of(&found, &parameters);
    let report = Report {
        machine: &machine,
        parameters: &parameters,
        data: &data,
        residuals: Residuals::of(&model, &data, &solution.theta()),
        solution,
        held_out: folds.and_then(|folds| held_out(&model, &data, folds, args.robust)),
        repeatability: repeatability(&data),
        fit: &found,
    };
    remarks(session, &report);
    if let Some(out) = &args.out {
        write_machine(session, &report, args, out)?;
    }
    match session.format() {
        Format::Json => session.print_json(report.json(session)),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text(session)),
    }
    session.checked()
}

/// A length above zero, such as `2 um`.
fn noise(text: &str) -> Result<f64, String> {
    let length = units::quantity(text).map_err(|failure| failure.to_string())?.as_length();
    length.filter(|mm| *mm > 0.0).ok_or_else(|| "write a length above zero, such as `2 um`".to_owned())
}

/// The command line goes before the machine file.
fn request(args: &Args, section: Option<IdentifyEntry>) -> IdentifyEntry {
    let mut request = section.unwrap_or_default();
    if !args.fit.is_empty() {
        request.fit = args.fit.clone();
    }
    request.fixed.extend(args.fixed.iter().cloned());
    request
}

fn measurements(session: &mut Session, machine: &Machine, paths: &[PathBuf]) -> Result<Vec<Measurement>, Stop> {
    let mut data = Vec::new();
    for path in paths {
        data.extend(read_measurements(path, machine, &Disk, &mut session.diagnostics).unwrap_or_default());
    }
    session.checked()?;
    let at: Vec<machine::Pose> = data.iter().map(|m| m.pose.clone()).collect();
    poses::check(session, machine, &at)?;
    Ok(data)
}

fn enough(session: &mut Session, data: &[Measurement], parameters: &[Parameter]) -> Outcome {
    let readings: usize = data.iter().map(Measurement::readings).sum();
    if readings >= parameters.len() {
        return Ok(());
    }
    let message = format!("{readings} readings cannot determine {} parameters", parameters.len());
    session.refuse(Diagnostic::new("E0503", message).help("measure more poses, or fit less"))
}

/// What the numbers alone do not say.
fn remarks(session: &mut Session, report: &Report<'_>) {
    if !report.fit.settled {
        let message = format!("the fit has not settled after {} steps", report.fit.steps);
        let help = "fix what the data hardly see, or fit less at once";
        session.diagnostics.push(Diagnostic::new("W0501", message).help(help));
    }
    // Beyond the 99.9 % point of the ratio for all but the fewest repeats.
    if let Some((sigma, _)) = report.repeatability.filter(|(s, f)| *f >= 5 && report.solution.sigma > 2.0 * s) {
        let message = format!(
            "what is left ({} um per reading) is far above the scatter of repeated poses ({} um)",
            significant(report.solution.sigma * 1e3, 3),
            significant(sigma * 1e3, 3)
        );
        let help = "the fitted errors do not explain the data: fit more of them, or look at the outliers";
        session.diagnostics.push(Diagnostic::new("W0502", message).help(help));
    }
}

/// Writes the fitted machine, if it is one that the program itself would take.
fn write_machine(session: &mut Session, report: &Report<'_>, args: &Args, out: &Path) -> Outcome {
    let text = fitted_file(report.machine, report.parameters, &report.solution.theta(), &report.provenance(args));
    if let Err(why) = load::own(&text) {
        let message = format!("the fitted machine is refused: {why}");
        let help = "some parameters ran away because the data hardly see them: fix those, or fit less";
        return session.refuse(Diagnostic::new("E0504", message).help(help));
    }
    match write::write_whole(out, text.as_bytes()) {
        Ok(()) => Ok(()),
        Err(refusal) => session.refuse(refusal),
    }
}

/// What is printed.
struct Report<'a> {
    machine: &'a Machine,
    parameters: &'a [Parameter],
    data: &'a [Measurement],
    solution: Solution,
    residuals: Residuals,
    held_out: Option<f64>,
    repeatability: Option<(f64, usize)>,
    fit: &'a Fit,
}

fn um(mm: f64) -> f64 {
    mm * 1e3
}

impl Report<'_> {
    fn rows(&self) -> usize {
        self.fit.reduced.rows
    }

    fn estimates(&self) -> impl Iterator<Item = (&Parameter, &Estimate)> {
        self.parameters.iter().zip(&self.solution.estimates)
    }

    /// Where the numbers of the fitted file come from. No date: the same input gives the same bytes.
    fn provenance(&self, args: &Args) -> Vec<(String, String)> {
        let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let tame = |text: String| crate::diagnostic::shown(&text).chars().take(180).collect::<String>();
        let files: Vec<String> = args.data.iter().map(name).collect();
        let fit = format!(
            "rank {} of {} parameters from {} readings; rms {} um before, {} um after",
            self.solution.rank,
            self.parameters.len(),
            self.rows(),
            significant(um(self.residuals.before), 5),
            significant(um(self.residuals.after), 5)
        );
        vec![
            ("identified-by".to_owned(), format!("abbe {}", env!("CARGO_PKG_VERSION"))),
            ("identified-from".to_owned(), tame(files.join(", "))),
            ("identified-fit".to_owned(), fit),
        ]
        .into_iter()
        .filter(|(key, _)| !self.machine.provenance().entries.iter().any(|(known, _)| known == key))
        .collect()
    }

    fn json(&self, session: &Session) -> serde_json::Value {
        let parameter = |(p, e): (&Parameter, &Estimate)| json!({"name": p.name, "value": p.shown(e.value) + 0.0, "sigma": e.sigma.map(|s| p.shown(s)), "unit": p.unit});
        let outlier = |o: &crate::identify::Outlier| json!({"place": self.place(session, o.row), "residual_um": um(o.residual), "deviations": o.deviations});
        let (s, r) = (&self.solution, &self.residuals);
        json!({
            "rows": self.rows(), "points": self.data.len(),
            "parameters": self.estimates().map(parameter).collect::<Vec<_>>(),
            "rank": s.rank, "unknowns": self.parameters.len(), "well_determined": s.well_determined,
            "null_space": s.null_space, "drowned": s.drowned, "condition": s.condition,
            "singular_values": s.singular_values,
            "rms_um": {"before": um(r.before), "after": um(r.after), "held_out": self.held_out.map(um)},
            "sigma_um": um(s.sigma), "degrees_of_freedom": s.freedom,
            "repeatability_um": self.repeatability.map(|(s, _)| um(s)),
            "orders_um": {"first": um(r.parts[0]), "second": um(r.parts[1]), "higher": um(r.parts[2]),
                          "left_by_first": um(r.left[0]), "left_by_second": um(r.left[1])},
            "outliers": r.outliers.iter().map(outlier).collect::<Vec<_>>(),
            "steps": self.fit.steps, "settled": self.fit.settled,
        })
    }

    fn place(&self, session: &Session, row: usize) -> String {
        let place = &self.data[row].place;
        let sources = &session.diagnostics.sources;
        format!("{}:{}", sources.name(place.source), sources.line_column(place).0)
    }

    fn csv(&self) -> String {
        let row = |(p, e): (&Parameter, &Estimate)| {
            let sigma = e.sigma.map_or_else(String::new, |s| p.shown(s).to_string());
            format!("{},{},{sigma},{}", p.name, p.shown(e.value) + 0.0, p.unit)
        };
        std::iter::once("name,value,sigma,unit".to_owned())
            .chain(self.estimates().map(row))
            .collect::<Vec<_>>()
            .join("\n")
    }

    fn text(&self, session: &Session) -> String {
        let mut table = comfy_table::Table::new();
        let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
        let _ = table.set_header(["parameter", "value", "1 sigma", "unit"]);
        for (p, e) in self.estimates() {
            let sigma = e.sigma.map_or_else(|| "free".to_owned(), |s| significant(p.shown(s), 2));
            let _ = table.add_row([p.name.clone(), significant(p.shown(e.value), 5), sigma, p.unit.clone()]);
        }
        format!("{}: fitted to {} points\n{table}\n{}", self.machine.name(), self.data.len(), self.summary(session))
    }

    fn summary(&self, session: &Session) -> String {
        let (s, r) = (&self.solution, &self.residuals);
        let n = |mm: f64| significant(um(mm), 5);
        let mut text = format!(
            "rank       {} of {} unknowns from {} readings, {} well determined, condition {}\n\
             rms        {} um before, {} um after; {} um per reading\n\
             orders     first {} um, second {} um, higher {} um; first alone leaves {} um, with the second {} um\n",
            s.rank,
            self.parameters.len(),
            self.rows(),
            s.well_determined,
            significant(s.condition, 3),
            n(r.before),
            n(r.after),
            n(s.sigma),
            n(r.parts[0]),
            n(r.parts[1]),
            n(r.parts[2]),
            n(r.left[0]),
            n(r.left[1]),
        );
        if let Some(held_out) = self.held_out {
            text += &format!("held out   {} um on points that were not used\n", n(held_out));
        }
        if let Some((sigma, freedom)) = self.repeatability {
            text +=
                &format!("repeated   {} um per reading where a pose was measured again ({freedom} times)\n", n(sigma));
        }
        s.null_space.iter().for_each(|words| text += &format!("free       {words}\n"));
        s.drowned.iter().for_each(|words| text += &format!("drowned    {words}\n"));
        for outlier in r.outliers.iter().take(10) {
            let size = significant(outlier.deviations, 3);
            text +=
                &format!("outlier    {}: {} um, {size} sigma\n", self.place(session, outlier.row), n(outlier.residual));
        }
        if r.outliers.len() > 10 {
            text += &format!("           and {} more\n", r.outliers.len() - 10);
        }
        text
    }
}
