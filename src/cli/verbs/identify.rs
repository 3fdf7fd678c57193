//! `abbe identify`: measurements to error parameters, and a fitted machine file.

use crate::cli::output::identify_report::Report;
use crate::cli::output::session::Session;
use crate::cli::output::{identify_remarks as remarks, monomials, pictures, plan, view};
use crate::cli::store::files::Recorded;
use crate::cli::store::write;
use crate::cli::{Exit, Format, Outcome, load, poses};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::Order;
use crate::identify::randomness;
use crate::identify::repeats;
use crate::identify::{
    DistanceEnd, Measurement, MeasurementSet, Model, Parameter, Reading, Residuals, Solution, fitted_file, held_out,
    moore_penrose, overruled, parameters, read_measurements, slope_bounds, solve, unused,
};
use crate::machine::{self, Machine};
use crate::syntax::IdentifyEntry;
use crate::units::{self, counted};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Measurements: CSV with a column per axis and `dx [um]`, `dy [um]`, `dz [um]`, or lengths, ball readings,
    /// lines, single errors (docs/identification.md).
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
    frame: view::FrameArg,
    /// The model: `exact`, or of order 1 or 2 of the dual numbers.
    #[arg(long, value_name = "N|exact", default_value = "exact", value_parser = order)]
    order: Order,
    /// How: all components at once on the model itself, or the papers' way, each for itself on the monomials.
    #[arg(long, value_enum, default_value = "joint")]
    method: Method,
    /// Draw prediction and data over the planes of the linear axes, as SVG files in this folder.
    #[arg(long, value_name = "DIR")]
    svg: Option<PathBuf>,
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

/// Ways to solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// One weighted least-squares problem, Levenberg-Marquardt.
    Joint,
    /// Holub and others 2015: monomials of order 2, component by component, pseudo-inverse.
    MoorePenrose,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let files = Recorded::default();
    let (machine, section) = load::with_identify(session, &args.machine, args.tool.as_deref(), &files)?;
    let wanted = overruled(&machine, section.unwrap_or_default(), &args.fit, &args.fixed);
    let own = match parameters(&machine, &wanted) {
        Ok(parameters) => parameters,
        Err(refusal) => return session.refuse(*refusal),
    };
    let bounds = match slope_bounds(&machine, &wanted, &own) {
        Ok(bounds) => bounds,
        Err(refusal) => return session.refuse(*refusal),
    };
    // A list on the command line takes what it needs of the section.
    if args.fit.is_empty() {
        remarks::unused(session, &unused(&machine, &wanted, &own));
    }
    if let Some(count) = args.plan {
        let model = Model::new(&machine, &own);
        return plan::run(session, &model, usize::from(count), args.noise, args.seed);
    }
    let mut data = measurements(session, &machine, args, &files)?;
    remarks::left_out(session, &machine, &data.leave_out(&own));
    let MeasurementSet { rows: data, nuisances } = data;
    // Before the work, not after it.
    write::refuse_outputs(&args.out, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    args.svg.iter().try_for_each(|folder| write::refuse_no_folder(folder)).or_else(|d| session.refuse(d))?;
    let unknowns: Vec<Parameter> = own.into_iter().chain(nuisances.into_iter().map(Parameter::from)).collect();
    if args.method == Method::Joint {
        enough(session, &data, &unknowns)?;
    }
    let model = Model::new(&machine, &unknowns).bounded(&bounds).to_order(args.order);
    if args.method == Method::MoorePenrose {
        return papers_way(session, args, &model, &data);
    }
    let found = solve(&model, &data, args.robust);
    let folds = args.folds.map(usize::from);
    let solution = Solution::of(&found, &unknowns);
    let theta = solution.theta();
    let report = Report {
        machine: &machine,
        unknowns: &unknowns,
        own: model.own(),
        data: &data,
        residuals: Residuals::of(&model, &data, &theta),
        randomness: randomness(&data, &model.residuals(&data, &theta), &found.weights),
        solution,
        held_out: folds.and_then(|folds| held_out(&model, &data, folds, args.robust)),
        repeats: repeats(&data),
        fit: &found,
    };
    remarks::all(session, &report);
    if let Some(out) = &args.out {
        remarks::written(session, &report);
        write_machine(session, &report, &wanted, &provenance(&report, &wanted, args, &files), out)?;
    }
    if let Some(folder) = &args.svg {
        pictures::write(session, &model, &data, &theta, folder)?;
    }
    match session.format() {
        Format::Json => session.print_json(report.json(session)),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text(session)),
    }
    session.checked()
}

/// The fit on the monomials, which gives no machine.
fn papers_way(session: &mut Session, args: &Args, model: &Model<'_>, data: &[Measurement]) -> Outcome {
    if args.out.is_some() || args.svg.is_some() || args.robust || args.folds.is_some() {
        return session.usage(
            "`--method moore-penrose` gives coefficients of monomials, no machine: no --out, --svg, --robust, --folds",
        );
    }
    if model.own() > MAX_FACTORS {
        let message = format!("{} parameters have too many products for the papers' way", model.own());
        let help = format!("at most {MAX_FACTORS}; the joint fit takes more");
        return session.refuse(Diagnostic::new(codes::E0508, message).help(help));
    }
    let Some(components) = moore_penrose(model, data) else {
        let help = "leave the other files out, or use the joint fit";
        return session
            .refuse(Diagnostic::new(codes::E0510, "the papers' way takes deviations dx, dy, dz only").help(help));
    };
    match session.format() {
        Format::Json => session.print_json(monomials::json(&components)),
        Format::Csv => session.print(&monomials::csv(&components)),
        Format::Text => session.print(&monomials::text(model.machines().first().map_or("", |m| m.name()), &components)),
    }
    session.checked()
}

/// Most parameters whose products are unknowns.
const MAX_FACTORS: usize = 24;

/// The orders that can be fitted.
fn order(text: &str) -> Result<Order, String> {
    match text {
        "exact" => Ok(Order::Exact),
        "1" => Ok(Order::Degree(1)),
        "2" => Ok(Order::Degree(2)),
        _ => Err("write 1, 2 or exact".to_owned()),
    }
}

/// A length above zero, such as `2 um`.
fn noise(text: &str) -> Result<f64, String> {
    let length = units::quantity(text).map_err(|failure| failure.to_string())?.as_length();
    length.filter(|mm| *mm > 0.0).ok_or_else(|| "write a length above zero, such as `2 um`".to_owned())
}

fn measurements(
    session: &mut Session,
    machine: &Machine,
    args: &Args,
    files: &Recorded,
) -> Result<MeasurementSet, Exit> {
    let data = read_measurements(&args.data, machine, args.frame.into(), files, &mut session.diagnostics);
    session.checked()?;
    refuse_copies(session, &args.data, files)?;
    let other = |m: &Measurement| match &m.reading {
        Reading::Distance { from: DistanceEnd::Pose(to), .. } => Some(to.clone()),
        _ => None,
    };
    let at: Vec<machine::Pose> =
        data.rows.iter().flat_map(|m| std::iter::once(m.pose.clone()).chain(other(m))).collect();
    poses::check(session, machine, &at)?;
    Ok(data)
}

/// Most unknowns of a fit: time grows with their third power.
const MAX_UNKNOWNS: usize = 500;

fn enough(session: &mut Session, data: &[Measurement], unknowns: &[Parameter]) -> Outcome {
    let readings: usize = data.iter().map(Measurement::readings).sum();
    let instruments = unknowns.iter().filter(|p| p.is_nuisance()).count();
    if unknowns.len() > MAX_UNKNOWNS {
        let message = format!("{} unknowns, {instruments} of them of instruments, are too many", unknowns.len());
        let help = "at most 500: fit less, or take runs of the same set-up together under one name";
        return session.refuse(Diagnostic::new(codes::E0508, message).help(help));
    }
    if readings >= unknowns.len() {
        return Ok(());
    }
    let also = if instruments > 0 {
        format!(" and {} of the instruments", counted(instruments, "unknown"))
    } else {
        String::new()
    };
    let own = counted(unknowns.len() - instruments, "parameter");
    let message = format!("{} cannot determine {own}{also}", counted(readings, "reading"));
    session.refuse(Diagnostic::new(codes::E0503, message).help("measure more poses, or fit less"))
}

/// Writes the fitted machine, if it is one that the program itself would take.
fn write_machine(
    session: &mut Session,
    report: &Report<'_>,
    wanted: &IdentifyEntry,
    provenance: &[(String, String)],
    out: &Path,
) -> Outcome {
    let own = &report.unknowns[..report.own];
    let text = fitted_file(report.machine, own, &report.solution, provenance, wanted);
    if let Err(why) = load::own(&text) {
        let message = format!("the fitted machine is refused: {why}");
        let help = "some parameters ran away because the data hardly see them: fix those, or fit less";
        return session.refuse(Diagnostic::new(codes::E0504, message).help(help));
    }
    match write::write_whole(out, text.as_bytes()) {
        Ok(()) => Ok(()),
        Err(refusal) => session.refuse(refusal),
    }
}

/// Files with the same contents would count twice.
fn refuse_copies(session: &mut Session, list: &[PathBuf], files: &Recorded) -> Outcome {
    let mut met: BTreeMap<Option<String>, &PathBuf> = BTreeMap::new();
    for file in list {
        if let Some(known) = met.insert(files.hash(file), file) {
            let names = [known, file].map(|path| shown(&path.display().to_string()));
            let message = format!("`{}` and `{}` hold the same readings, which would count twice", names[0], names[1]);
            return session.refuse(Diagnostic::new(codes::E0501, message).help("name every file once"));
        }
    }
    Ok(())
}

/// Digits of a hash that are told.
const DIGITS: usize = 16;
/// Most files of data that are named one by one.
const MAX_NAMED: usize = 20;
/// Longest entry of a provenance that says what was fitted, in characters.
const ENTRY: usize = 180;

/// Where the numbers of the fitted file come from. No date: the same input gives the same bytes.
fn provenance(report: &Report<'_>, wanted: &IdentifyEntry, args: &Args, files: &Recorded) -> Vec<(String, String)> {
    let hashed = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let hash: String = files.hash(path).unwrap_or_default().chars().take(DIGITS).collect();
        format!("{} (sha256 {hash}...)", shown(&name))
    };
    let order = match args.order {
        Order::Degree(n) => format!("order {n}"),
        Order::Exact => "exact".to_owned(),
    };
    let robust = if args.robust { "robust " } else { "" };
    let frame = view::frame_text(args.frame.into());
    let fixed = if wanted.fixed.is_empty() { String::new() } else { format!("; fixed {}", wanted.fixed.join(", ")) };
    let list = wanted.fit.join(", ");
    let how = format!("{robust}least squares on the {order} model, readings in the {frame} frame; fit {list}{fixed}");
    let mut entries = vec![
        ("by".to_owned(), format!("abbe {}", env!("CARGO_PKG_VERSION"))),
        ("machine".to_owned(), hashed(&args.machine)),
    ];
    for (k, file) in args.data.iter().take(MAX_NAMED).enumerate() {
        entries.push((if k > 0 { format!("from.{}", k + 1) } else { "from".to_owned() }, hashed(file)));
    }
    entries.push(("how".to_owned(), how.chars().take(ENTRY).collect()));
    entries.push(("fit".to_owned(), report.in_short()));
    // A machine that was fitted before keeps what was said then.
    let known = |key: &str| report.machine.provenance().entries.iter().any(|(known, _)| known == key);
    let ending = |n: usize| if n > 1 { format!("-{n}") } else { String::new() };
    let time = (1..).find(|n| !known(&format!("identified-by{}", ending(*n)))).map_or_else(String::new, ending);
    entries.into_iter().map(|(key, value)| (format!("identified-{key}{time}"), value)).collect()
}
