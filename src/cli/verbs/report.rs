//! `abbe report`: one self-contained HTML page for a design review.

use crate::analysis::budget::{Bound, Budget, Request, budget, budget_poses};
use crate::analysis::map;
use crate::analysis::{Plane, View, rest, space_axes};
use crate::cli::how::SetArgs;
use crate::cli::output::budgets::{Drawn, budgets};
use crate::cli::output::progress::Progress;
use crate::cli::output::session::Session;
use crate::cli::output::view::{ApproachArg, order};
use crate::cli::set_effect;
use crate::cli::store::write::{refuse_input, refuse_outputs, write_whole};
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::{Exit, Format, Outcome, load, watch};
use crate::controller::Depth;
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Bare, Field, Frame, Order};
use crate::machine::Machine;
use crate::report::page::{
    ComparisonData, Data, Given, Instruments, MachineData, Page, Pictures, Rendered, Served, Written, colours,
};
use crate::report::{BudgetReport, Drawing, Drawn as Way, PlanePicture, Shown, axis_curves, chain_picture};
use crate::syntax::Disk;
use crate::syntax::Files;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; with several, they are compared on the tool poses of the first.
    #[arg(required = true, num_args = 1..=8)]
    pub machines: Vec<PathBuf>,
    /// The page to write.
    #[arg(long, value_name = "FILE.html", required_unless_present = "watch")]
    pub out: Option<PathBuf>,
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
    /// How many machines are drawn for a budget, which is shown where errors are bounded.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    samples: u32,
    #[command(flatten)]
    options: SetArgs,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if args.watch {
        return watch::run(session, args);
    }
    refuse_outputs(&args.out, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    let built = build(session, args, &Disk)?;
    let page = built.page(Served::Alone, None).or_else(|d| session.refuse(d))?;
    write(session, args, &page)?;
    let (out, bytes) = (args.out.as_deref().unwrap_or(Path::new("")), page.text.len());
    match session.format() {
        Format::Json => session.print_json(json!({"page": out.display().to_string(), "bytes": bytes})),
        _ => session.print(&format!("{}: {} kB, self-contained", out.display(), bytes.div_ceil(1000))),
    }
    Ok(())
}

/// Writes the page where it was asked for.
pub(crate) fn write(session: &mut Session, args: &Args, page: &Rendered) -> Outcome {
    let Some(out) = &args.out else { return Ok(()) };
    refuse_input(out, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    write_whole(out, page.text.as_bytes()).or_else(|d| session.refuse(d))
}

/// All that a page shows.
pub(crate) struct Built {
    data: Data,
    pictures: Vec<Pictures>,
}

impl Built {
    /// A page without machines: there was none yet that is not refused.
    pub(crate) fn new(data: Data) -> Self {
        Self { data, pictures: Vec::new() }
    }

    /// The page, perhaps with what is wrong with the file as it is now.
    pub(crate) fn page(&self, served: Served, problem: Option<&str>) -> Result<Rendered, Diagnostic> {
        let page = Page { data: &self.data, pictures: &self.pictures, served, problem };
        page.html().map_err(|why| Diagnostic::new(codes::E0632, format!("the page cannot be rendered: {why}")))
    }
}

/// Reads the machines through `files` and computes what the page shows.
pub(crate) fn build(session: &mut Session, args: &Args, files: &dyn Files) -> Result<Built, Exit> {
    let mut machines = Vec::new();
    for path in &args.machines {
        let seen = session.diagnostics.iter().count();
        let machine = load::machine_through(session, path, args.options.tool.as_deref(), files)?;
        load::warn_bounded(session, &machine);
        let written =
            args.target.iter().map(|name| compensation(session, args, &machine, name)).collect::<Result<_, _>>()?;
        let warnings = session.diagnostics.iter().skip(seen).map(|d| format!("{}: {}", d.code, d.message)).collect();
        let (budget, instruments) = (budgeted(session, args, &machine)?, Instruments::new(&machine));
        machines.push(Subject { machine, file: path.display().to_string(), written, warnings, budget, instruments });
    }
    let given: Vec<Given<'_>> = machines.iter().map(|subject| subject.given(args)).collect();
    let progress = Progress::new(given.len() * args.options.poses as usize, session.is_quiet());
    let done = |count| progress.add(count);
    let comparison = comparison(session, args, &given)?;
    let data = Data { abbe: env!("CARGO_PKG_VERSION"), machines: Vec::new(), comparison, colours: colours() };
    let mut built = Built::new(data);
    for (i, given) in given.iter().enumerate() {
        let view = View { approach: given.approach, frame: Frame::Workpiece };
        let field = Bare { machine: given.machine, order: given.order };
        // Never more poses than a map takes: the option's range sees to that.
        let Ok(map) = map(&field, &given.sample(), view, &done) else { continue };
        let data = MachineData::new(i + 1, given, &map);
        built.pictures.push(pictures(given, &data));
        built.data.machines.push(data);
    }
    Ok(built)
}

/// A machine with all that was found out about it.
struct Subject {
    machine: Machine,
    file: String,
    written: Vec<Written>,
    warnings: Vec<String>,
    instruments: Instruments,
    budget: Option<Budgeted>,
}

/// A budget with what it is of.
struct Budgeted {
    bounds: Vec<Bound>,
    budget: Budget,
    poses: usize,
    drawing: Drawing,
}

/// Poses of a budget besides the corners of the volume: as many as `budget` takes.
const BUDGET_POSES: usize = 500;

/// What `budget` would say, if any error is bounded.
fn budgeted(session: &mut Session, args: &Args, machine: &Machine) -> Result<Option<Budgeted>, Exit> {
    let (bounds, source) = args.tolerances.bounds_if_any(session, machine)?;
    if bounds.is_empty() {
        return Ok(None);
    }
    let (samples, seed) = (args.samples as usize, args.options.seed);
    let (poses, draws) = (budget_poses(machine, BUDGET_POSES, seed), args.tolerances.draws(seed));
    let statistic = args.tolerances.statistic();
    let request = Request { machine, bounds: &bounds, poses: &poses, at: None, draws: &draws, samples, statistic };
    let progress = Progress::new(2 * samples, session.is_quiet());
    let budget = budget(request, &|count| progress.add(count));
    let drawing = args.tolerances.drawing(source, samples, seed);
    Ok(Some(Budgeted { budget, poses: poses.len(), drawing, bounds }))
}

/// Several machines on the same work, with their budgets where all have one.
fn comparison(session: &mut Session, args: &Args, given: &[Given<'_>]) -> Result<Option<ComparisonData>, Exit> {
    let Some(work) = ComparisonData::work(given) else { return Ok(None) };
    let drawn = Drawn { tolerances: &args.tolerances, samples: args.samples as usize, seed: args.options.seed };
    let budgets = budgets(session, &work.1, drawn)?;
    let json = budgets.map_or(Value::Null, |budgets| json!(budgets));
    Ok(Some(ComparisonData::new(given, &work, json)))
}

impl Subject {
    fn given(&self, args: &Args) -> Given<'_> {
        let default = self.machine.conventions().default_order.map_or(Order::Exact, Order::Degree);
        Given {
            machine: &self.machine,
            file: &self.file,
            order: args.order.unwrap_or(default),
            approach: args.direction.into(),
            poses: (args.options.poses as usize, args.options.seed),
            written: &self.written,
            warnings: &self.warnings,
            instruments: &self.instruments,
            budget: self.budget.as_ref().map(|b| BudgetReport {
                machine: &self.machine,
                bounds: &b.bounds,
                budget: &b.budget,
                poses: b.poses,
                drawing: &b.drawing,
            }),
        }
    }
}

/// What `compile` would write for a target, and its certificate.
fn compensation(session: &mut Session, args: &Args, machine: &Machine, name: &str) -> Result<Written, Exit> {
    let depth = Depth { poses: args.options.poses as usize, seed: args.options.seed };
    let (target, effect, certificate) = set_effect::compiled(session, machine, name, &args.options.how, depth)?;
    Ok(Written { target, effect, certificate })
}

/// Intervals along the longer side of a plane.
const PLANE_NODES: f64 = 48.0;

/// Bars of a chart.
const BARS: usize = 14;

fn pictures(given: &Given<'_>, data: &MachineData) -> Pictures {
    let machine = given.machine;
    let curves = (0..machine.axes().len())
        .filter_map(|axis| Some((machine.axes()[axis].name.to_string(), axis_curves(machine, axis)?.svg())));
    let axes = space_axes(machine);
    let pairs = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(a, b)| Some([*axes.get(a)?, *axes.get(b)?]));
    Pictures {
        chain: chain_picture(machine).svg(),
        curves: curves.collect(),
        planes: pairs.map(|axes| plane(given, axes)).collect(),
        pareto: data.pareto(BARS).map_or_else(String::new, |picture| picture.svg()),
        instruments: given.instruments.pictures(machine),
        budget: given.budget.iter().flat_map(|b| [b.pareto(BARS).svg(), b.waterfall(BARS).svg()]).collect(),
    }
}

/// A plane as a map and as a grid, and after each compensation with the same colours.
fn plane(given: &Given<'_>, axes: [usize; 2]) -> (String, Vec<String>) {
    let Given { machine, order, approach, .. } = *given;
    let view = View { approach, frame: Frame::Workpiece };
    let spans = axes.map(|i| machine.volume()[i].max - machine.volume()[i].min);
    let longest = spans[0].max(spans[1]);
    let counts = spans.map(|span| 1 + (PLANE_NODES * span / longest).round().max(2.0) as usize);
    let of = |field: &dyn Field| Plane::of(field, axes, &rest(machine), counts, view);
    let bare = of(&Bare { machine, order });
    let (state, like) = if given.written.is_empty() { ("", None) } else { ("uncompensated", Some(&bare)) };
    let picture =
        PlanePicture { machine, plane: &bare, view, order, shown: Shown::Length, drawn: Way::Colours, state, like };
    let mut svgs = vec![picture.svg(), PlanePicture { drawn: Way::Grid, ..picture }.svg()];
    for written in given.written {
        let after = of(&*written.effect.field(machine, &written.target));
        let state = format!("after {}", written.target.manifest.target);
        for drawn in [Way::Colours, Way::Grid] {
            svgs.push(PlanePicture { plane: &after, drawn, state: &state, like: Some(&bare), ..picture }.svg());
        }
    }
    let names = axes.map(|i| machine.axes()[i].name.to_string());
    (format!("{}-{} plane", names[0], names[1]), svgs)
}
