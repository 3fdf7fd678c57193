//! `abbe budget`: tolerances to the volumetric error.

use super::poses::{check, pose_at};
use super::progress::Progress;
use super::session::Session;
use super::tolerances::ToleranceArgs;
use super::view::{axes_json, axes_text, table};
use super::write::{Kind, write_picture};
use super::{Format, Outcome, load};
use crate::analysis::budget::{
    Bound, Budget, Contribution, PERCENTS, Percentile, Request, Statistic, Totals, budget, budget_poses, known,
};
use crate::machine::{ErrorId, Machine};
use crate::report::{Bar, ParetoPicture, Picture, WaterfallPicture};
use crate::units::{angle, length, significant};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The machine file; errors with a `tolerance` are budgeted.
    machine: PathBuf,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    /// How many random poses, besides the corners of the volume.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    poses: u32,
    /// How many machines are drawn.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    samples: u32,
    /// The contributions at this pose too, mm and deg; axes left out are at 0.
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true)]
    at: Option<String>,
    /// How many contributions to list.
    #[arg(long, value_name = "K", default_value_t = 12)]
    top: usize,
    /// Which of the machine's tools.
    #[arg(long)]
    tool: Option<String>,
    /// Draw what each error does at its bound, and what they add up to (SVG, or PNG by the file's ending).
    #[arg(long, value_name = "FILE")]
    pareto: Option<PathBuf>,
    /// Draw how the budget is used up, tolerance by tolerance (SVG, or PNG by the file's ending).
    #[arg(long, value_name = "FILE")]
    waterfall: Option<PathBuf>,
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.tool.as_deref())?;
    let at = match &args.at {
        Some(text) => Some(pose_at(&machine, text).or_else(|message| session.usage(&message))?),
        None => None,
    };
    check(session, &machine, at.as_slice())?;
    let (bounds, source) = args.tolerances.bounds(session, &machine)?;
    let draws = args.tolerances.draws();
    let poses = budget_poses(&machine, args.poses as usize, args.tolerances.seed);
    let samples = args.samples as usize;
    let request = Request {
        machine: &machine,
        bounds: &bounds,
        poses: &poses,
        at: at.as_deref(),
        draws: &draws,
        samples,
        statistic: args.tolerances.statistic(),
    };
    let progress = Progress::new(2 * samples, session.is_quiet());
    let budget = budget(request, &|count| progress.add(count));
    drop(progress);
    let report = Report { args, machine: &machine, bounds: &bounds, source, poses: poses.len(), at, budget };
    for (path, picture) in [(&args.pareto, report.pareto()), (&args.waterfall, report.waterfall())] {
        if let Some(path) = path {
            let kind = Kind::of(path).unwrap_or(Kind::Svg);
            write_picture(path, &picture, kind, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
        }
    }
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

/// What is printed.
struct Report<'a> {
    args: &'a Args,
    machine: &'a Machine,
    bounds: &'a [Bound],
    source: Option<String>,
    poses: usize,
    at: Option<Vec<f64>>,
    budget: Budget,
}

/// In um or urad.
fn tolerance(bound: &Bound) -> f64 {
    bound.tolerance * if bound.error.direction.is_rotation() { 1e6 } else { 1e3 }
}

fn unit(error: &ErrorId) -> &'static str {
    if error.direction.is_rotation() { "urad" } else { "um" }
}

fn short(value: f64) -> String {
    significant(value, 4)
}

impl Report<'_> {
    /// Bounds by how much the 95 % value hangs on them.
    fn order(&self) -> Vec<usize> {
        let effect = |i: &usize| self.budget.position.tighten[*i].effect;
        let mut order: Vec<usize> = (0..self.bounds.len()).collect();
        order.sort_by(|a, b| effect(b).total_cmp(&effect(a)).then(a.cmp(b)));
        order
    }

    fn totals(&self, totals: &Totals) -> serde_json::Value {
        let percentiles: serde_json::Map<_, _> = PERCENTS
            .iter()
            .map(|p| totals.percentile(*p))
            .map(|p| (format!("p{}", p.percent), json!({"value": p.value, "low": p.low, "high": p.high})))
            .collect();
        json!({
            "worst_case": totals.worst_case, "rss": totals.rss, "mean_of_both": totals.mean_of_both(),
            "worst_case_at": axes_json(self.machine, &totals.worst_pose), "rss_at": axes_json(self.machine, &totals.rss_pose),
            "monte_carlo": {
                "mean": totals.mean.0, "mean_sigma": totals.mean.1, "p95": totals.percentile(95).value,
                "percentiles": percentiles,
            },
        })
    }

    fn contributions(&self, list: &[Contribution]) -> Vec<serde_json::Value> {
        let one = |c: &Contribution| json!({"error": self.bounds[c.bound].error, "share": c.share, "um": c.um});
        list.iter().map(one).collect()
    }

    fn json(&self) -> serde_json::Value {
        let tighten = |i: usize| {
            let (bound, t) = (&self.bounds[i], self.budget.position.tighten[i]);
            let per = 1.0 / tolerance(bound);
            json!({
                "error": bound.error, "tolerance": tolerance(bound), "unit": unit(&bound.error), "of_class": bound.of_class,
                "um_per_unit": t.effect * per, "sigma": t.sigma * per, "um_of_p95": t.effect, "um_of_p95_sigma": t.sigma,
            })
        };
        let mut json = json!({
            "machine": self.machine.name(), "chain": self.machine.chain().to_string(), "frame": "workpiece", "order": "1",
            "class": self.args.tolerances.class, "class_source": self.source, "left_out": known(self.machine),
            "poses": self.poses, "samples": self.args.samples, "seed": self.args.tolerances.seed,
            "distribution": self.args.tolerances.distribution(), "statistic": self.args.tolerances.statistic(),
            "position_um": self.totals(&self.budget.position), "rotation_urad": self.totals(&self.budget.rotation),
            "contributions": self.contributions(&self.budget.worst),
            "contributions_on_average": self.contributions(&self.budget.average),
            "tighten": self.order().into_iter().map(tighten).collect::<Vec<_>>(),
        });
        if let (Some(object), Some(pose), Some(list)) = (json.as_object_mut(), &self.at, &self.budget.at) {
            let at = json!({"axes": axes_json(self.machine, pose), "contributions": self.contributions(list)});
            let _ = object.insert("at".to_owned(), at);
        }
        json
    }

    /// One line for each error.
    fn csv(&self) -> String {
        let um = |list: &[Contribution], i: usize| list.iter().find(|c| c.bound == i).map_or(0.0, |c| c.um);
        let mut csv =
            "error,tolerance,unit,at worst [um],on average [um],of the 95 % value [um],sigma [um],um per unit\n"
                .to_owned();
        for i in self.order() {
            let (bound, t) = (&self.bounds[i], self.budget.position.tighten[i]);
            csv += &format!(
                "{},{},{},{},{},{},{},{}\n",
                bound.error,
                tolerance(bound),
                unit(&bound.error),
                um(&self.budget.worst, i),
                um(&self.budget.average, i),
                t.effect + 0.0,
                t.sigma,
                t.effect / tolerance(bound) + 0.0
            );
        }
        csv
    }

    fn text(&self) -> String {
        let what = match self.args.tolerances.statistic() {
            Statistic::Max => "largest deviation over the poses",
            Statistic::P95 => "95 % deviation over the poses",
        };
        let own = self.bounds.iter().filter(|bound| !bound.of_class).count();
        let mut text = format!("{}, {}\n", self.machine.name(), self.machine.chain());
        text += &format!("{} errors bounded: {own} by the machine file", self.bounds.len());
        if let (Some(class), Some(source)) = (&self.args.tolerances.class, &self.source) {
            text += &format!(", {} by class {class} ({source})", self.bounds.len() - own);
        }
        text += &match known(self.machine) {
            0 => "\n".to_owned(),
            n => format!("; {n} errors with values are left out\n"),
        };
        text += &format!(
            "{} poses; {} machines drawn, {} distribution, seed {}; counted is the {what} of each\n",
            self.poses,
            self.args.samples,
            self.args.tolerances.distribution().name(),
            self.args.tolerances.seed
        );
        text += &self.totals_table();
        text += &format!("Worst case at {}\n", axes_text(self.machine, &self.budget.position.worst_pose));
        text += &format!("RSS largest at {}\n", axes_text(self.machine, &self.budget.position.rss_pose));
        text += &self.pareto_table();
        text + &self.tighten_table()
    }

    fn totals_table(&self) -> String {
        let mut rows =
            table(&["", "worst case", "RSS", "mean of both", "Monte Carlo: mean", "median", "90 %", "95 %", "99 %"]);
        let interval = |p: Percentile| {
            let end = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 3));
            format!("{} ({}..{})", short(p.value), end(p.low), end(p.high))
        };
        for (name, t) in [("position, um", &self.budget.position), ("rotation, urad", &self.budget.rotation)] {
            let head = [name.to_owned(), short(t.worst_case), short(t.rss), short(t.mean_of_both()), short(t.mean.0)];
            let _ = rows.add_row(head.into_iter().chain(PERCENTS.map(|p| interval(t.percentile(p)))));
        }
        format!("{rows}\nIn brackets: 95 % confidence by the number of machines drawn; - where they are too few.\n")
    }

    fn pareto_table(&self) -> String {
        let b = &self.budget;
        let mut header = vec!["error", "tolerance", "at worst, um", "share", "on average, um"];
        if b.at.is_some() {
            header.push("at the pose, um");
        }
        let mut rows = table(&header);
        let um =
            |list: &[Contribution], i: usize| list.iter().find(|c| c.bound == i).map_or(String::new(), |c| short(c.um));
        for c in b.worst.iter().take(self.args.top) {
            let mut row = vec![
                self.bounds[c.bound].error.to_string(),
                bound_text(&self.bounds[c.bound]),
                short(c.um),
                format!("{:.1} %", 100.0 * c.share),
                um(&b.average, c.bound),
            ];
            row.extend(b.at.iter().map(|list| um(list, c.bound)));
            let _ = rows.add_row(row);
        }
        format!("\nEach error at its bound, where the RSS is largest (share of the sum of squares):\n{rows}\n")
    }

    fn tighten_table(&self) -> String {
        let mut rows = table(&["tighten first", "tolerance", "um per um or urad", "10 % tighter wins, um"]);
        for i in self.order().into_iter().take(self.args.top) {
            let (bound, t) = (&self.bounds[i], self.budget.position.tighten[i]);
            let per = 1.0 / tolerance(bound);
            let _ = rows.add_row([
                bound.error.to_string(),
                bound_text(bound),
                format!("{} ± {}", significant(t.effect * per, 3), significant(t.sigma * per, 2)),
                format!("{} ± {}", significant(t.effect * 0.1, 3), significant(t.sigma * 0.1, 2)),
            ]);
        }
        format!("\nBy the derivative of the 95 % value of the drawn machines (± its standard error):\n{rows}\n")
    }

    fn pareto(&self) -> Picture {
        let bar = |c: &Contribution| Bar { label: self.bounds[c.bound].error.to_string(), value: c.um };
        ParetoPicture {
            title: self.machine.name().to_owned(),
            subtitle: format!("Each error at its bound, at {}", self.rounded(&self.budget.position.rss_pose)),
            quantity: "position deviation in µm".to_owned(),
            bars: self.budget.worst.iter().take(self.args.top.max(1)).map(bar).collect(),
            total: self.budget.worst.iter().map(|c| c.um * c.um).sum::<f64>(),
        }
        .picture()
    }

    /// A pose with the digits a picture has room for.
    fn rounded(&self, pose: &[f64]) -> String {
        let axes = self.machine.axes().iter().zip(pose);
        axes.map(|(axis, q)| format!("{} {}", axis.name, significant(*q, 4))).collect::<Vec<_>>().join(", ")
            + " (mm, deg)"
    }

    fn waterfall(&self) -> Picture {
        let order = self.order();
        let top = self.args.top.max(1);
        let part = |i: &usize| self.budget.position.tighten[*i].effect;
        let mut bars: Vec<Bar> =
            order.iter().take(top).map(|i| Bar { label: self.bounds[*i].error.to_string(), value: part(i) }).collect();
        if order.len() > top {
            let label = format!("{} others", order.len() - top);
            bars.push(Bar { label, value: order.iter().skip(top).map(part).sum() });
        }
        let p = &self.budget.position;
        WaterfallPicture {
            title: self.machine.name().to_owned(),
            subtitle: format!("What each tolerance has of the 95 % value of {} drawn machines", self.args.samples),
            quantity: "position deviation in µm".to_owned(),
            bars,
            marks: vec![
                ("95 %".to_owned(), p.percentile(95).value),
                ("RSS".to_owned(), p.rss),
                ("mean of both".to_owned(), p.mean_of_both()),
                ("worst case".to_owned(), p.worst_case),
            ],
        }
        .picture()
    }
}

fn bound_text(bound: &Bound) -> String {
    let value = if bound.error.direction.is_rotation() { angle(bound.tolerance) } else { length(bound.tolerance) };
    format!("± {value}")
}
