//! `report`: one self-contained HTML page for a design review.

use super::mailed;
use super::report_options::ReportOptions;
use crate::analysis::budget::most_samples;
use crate::analysis::figure_bands::field_bands;
use crate::analysis::reference::ReferencedField;
use crate::analysis::{MAX_POSES, MapFailure, View, map};
use crate::api;
use crate::api::bounded::{AddingBounds, DrawnBounds};
use crate::api::budget::{BudgetBounds, BudgetOptions, BudgetResult, BudgetWork, budget_of};
use crate::api::budgets::{DrawnMachines, budgets};
use crate::api::certificate::without_unheld;
use crate::api::compare_figures::{removed, set_ups};
use crate::api::map_result::{MapOptions, MapPoses, MapResult};
use crate::api::sources::all_words;
use crate::controller::Depth;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::{Bare, Field, Frame, Order, Poses, Random, worst};
use crate::file_set::effect::named_effect;
use crate::job::characteristics::DrawnRequest;
use crate::job::job_file::Job;
use crate::job::limit::LimitVerdict;
use crate::job::machine_file::{MachineFile, order_of, sources_of};
use crate::job::over::Over;
use crate::job::reference::{Reference, SetUp};
use crate::job::round_features::{RoundFeature, drawn_round_features, round_features};
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Machine, Pose};
use crate::report::page::{
    ComparisonData, EngineFile, Instruments, MachineData, MachineInput, Page, PageData, Pictures, RenderedPage,
    TargetResult, colours,
};
use crate::run::{Advance, Call, Cancelled, Count, Refused, Reply, Run, finite};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Content of a page: what its workbench starts with, and numbers and pictures of its appendices. The default shows no
/// machine.
#[derive(Debug, Clone)]
pub struct Report {
    data: PageData,
    pictures: Vec<Pictures>,
    start: Value,
}

impl Default for Report {
    fn default() -> Self {
        let abbe = env!("CARGO_PKG_VERSION");
        let data = PageData { abbe, machines: Vec::new(), comparison: None, colours: colours() };
        Self { data, pictures: Vec::new(), start: Value::Null }
    }
}

impl Report {
    /// Returns the page. With the library as WebAssembly it answers what-ifs by itself, without it only shows; of
    /// several variants it holds the first, and the others while it stays small enough for mail.
    ///
    /// Fails if a number has no JSON.
    pub fn page(&self, engines: &[EngineFile]) -> Result<RenderedPage, Diagnostic> {
        let page = Page { data: &self.data, pictures: &self.pictures, start: &self.start, engines };
        page.html().map_err(|why| Diagnostic::new(codes::E0632, format!("the page cannot be rendered: {why}")))
    }

    /// Returns the start of the page's workbench.
    #[cfg(test)]
    pub(crate) fn start(&self) -> &Value {
        &self.start
    }
}

/// Computes a page about machines; several are compared on the tool poses of the first.
///
/// Fails for targets and classes that are not there, and where [`compile`](crate::api::compile()) fails for a target.
pub fn report(files: &[MachineFile], options: &ReportOptions, run: Run) -> Reply<Report> {
    Call::answer_of(run, &sources_of(files), |call| {
        let report = options.job_paths().with_tools(call, files, |call, files| build(call, files, options))?;
        call.extend(finite::refusal(&report.data));
        Ok(report)
    })
}

fn build(call: &mut Call, files: &[MachineFile], options: &ReportOptions) -> Result<Report, Refused> {
    call.check_counts(&[Count::Machines(options.samples), Count::Poses(options.poses)])?;
    if options.axis_poses.is_some() && files.len() > 1 {
        return call.usage("poses of the axes are of one machine: `abbe compare` takes them for several");
    }
    let subjects: Vec<Subject<'_>> =
        files.iter().map(|file| Subject::one_of(call, files, file, options)).collect::<Result<_, _>>()?;
    let read = subjects.iter().filter_map(|subject| Some(subject.work.as_ref()?.1["file"].as_str()?.to_owned()));
    let stated = options.job.iter().map(|path| path.display().to_string());
    let job_files: BTreeSet<String> = stated.chain(read).collect();
    let given: Vec<MachineInput<'_>> = subjects.iter().map(|subject| subject.input(options)).collect();
    let mut report = Report::default();
    let job = subjects.first().and_then(|first| first.job.as_ref());
    if let ([first, others @ ..], None, None) = (files, &options.job, &options.tool_poses) {
        call.extend(options.job_paths().displaced_jobs(first, others));
    }
    report.data.comparison = comparison(call, (files, job), options, &given)?;
    let drawn = call.stage("poses", given.iter().map(|given| given.poses.0).sum(), |advance| {
        let all = given.iter().enumerate().map(|(i, given)| draw(i + 1, given, advance)).collect::<Result<Vec<_>, _>>();
        if let Err(MapFailure::Cancelled) = all { Err(Cancelled) } else { Ok(all) }
    })?;
    let Ok(drawn) = drawn else { return call.usage(format!("a report takes {MAX_POSES} poses at most")) };
    (report.data.machines, report.pictures) = drawn.into_iter().unzip();
    report.start = mailed::start(call, files, options, &job_files);
    Ok(report)
}

/// Content of the page for a machine.
fn draw(number: usize, given: &MachineInput<'_>, advance: Advance<'_>) -> Result<(MachineData, Pictures), MapFailure> {
    let view = View { conditions: given.conditions, frame: Frame::Workpiece };
    if let Some(bounded) = given.budget() {
        let data = MachineData::of_bounds(number, given, bounded);
        advance(given.poses.0)?;
        let pictures = Pictures::new(given, &data);
        return Ok((data, pictures));
    }
    let (bare, poses) = (Bare { machine: given.machine, order: given.order }, given.sample());
    let set_up = given.removed.map(|of| ReferencedField::new(&bare, of, given.order, given.conditions));
    let field: &dyn Field = set_up.as_ref().map_or(&bare, |field| field);
    let map = map(field, &poses, view, advance)?;
    // As `map` does by default.
    let besides = worst(&map.deviations, MapOptions::default().worst);
    let intervals =
        field_bands(field, &poses, map.statistics, &besides, given.conditions, given.poses.1, given.removed);
    let data = MachineData::new(number, given, &map).with_uncertainty(given, json!(intervals));
    let pictures = Pictures::new(given, &data);
    Ok((data, pictures))
}

/// A machine with all that was found out about it.
struct Subject<'a> {
    file: &'a MachineFile,
    written: Vec<TargetResult>,
    warnings: Vec<String>,
    /// Each error in words, by its name.
    words: Value,
    instruments: Instruments,
    budget: Option<BudgetResult>,
    /// What bounds add to the measured errors; null where they add nothing.
    bounds_add: Value,
    /// The tool poses of the file that the machine reaches, and what the page says of them.
    work: Option<(Vec<Pose>, Value)>,
    /// The features among them that are round.
    round: Vec<RoundFeature>,
    job: Option<Job>,
    set_up: SetUp,
    over: Over,
}

impl<'a> Subject<'a> {
    /// The subject of one of the files; with several, what is found names the file.
    fn one_of(
        call: &mut Call,
        files: &[MachineFile],
        file: &'a MachineFile,
        options: &ReportOptions,
    ) -> Result<Self, Refused> {
        match files {
            [_] => Self::of(call, file, options),
            _ => call.about(file.path(), |call| Self::of(call, file, options)),
        }
    }

    fn of(call: &mut Call, file: &'a MachineFile, options: &ReportOptions) -> Result<Self, Refused> {
        let seen = call.diagnostics.count();
        let settings = (&options.tolerances, options.samples, options.seed);
        let bounded = DrawnBounds::of(call, file, settings)?;
        let targets = if bounded.is_some() { &[][..] } else { &options.targets };
        if targets.len() < options.targets.len() {
            call.warn(nothing_to_compensate(file));
        }
        call.check()?;
        let job = options.job_paths().read(call, file)?;
        let reached = job.as_ref().map(|job| job.poses.reached(call, file)).transpose()?;
        let poses: Vec<Pose> = match &reached {
            Some(reached) => reached.poses.clone(),
            None if options.reference.is_none() && file.unheld().is_empty() => Vec::new(),
            None => Poses::Random(Random::of(file, options.poses, options.seed)).iter().collect(),
        };
        let set_up = Job::set_up(job.as_ref(), call, file, options.reference.as_ref(), &poses)?;
        set_up.refuse_minimum_zone(call, "a report")?;
        let over = Over::work(file, &set_up.reference, reached.as_ref(), options.poses);
        let mut written = Vec::new();
        for name in targets {
            written.extend(compensate(call, file, name, options)?);
        }
        let budget = own_budget(call, file, options, job.as_ref().is_some_and(Job::has_part))?;
        let map = job.as_ref().map(|_| map_of_job(call, file, options, bounded.is_some())).transpose()?;
        let round = match job.as_ref().zip(reached.as_ref()) {
            Some((job, reached)) => round(call, file, (job, reached), options, (bounded.as_ref(), &set_up))?,
            None => Vec::new(),
        };
        let work = reached.as_ref().zip(map.as_ref()).map(|(reached, map)| {
            let budget = budget.as_ref().filter(|_| bounded.is_none());
            (reached.poses.clone(), JobWork { reached, map, round: &round, budget }.json())
        });
        let (tolerances, samples, seed) = settings;
        let bounds_add = match map {
            Some(map) => map.bounds_add,
            None => AddingBounds { machine: file, tolerances, samples, seed, work: None, reference: set_up.removed() }
                .added(call)?,
        };
        let bounds_add = json!(bounds_add);
        let found = file.warnings().iter().chain(call.diagnostics.iter().skip(seen));
        let warnings = found.map(Diagnostic::to_string).collect();
        let instruments = if bounded.is_some() { Instruments::none(file) } else { Instruments::new(file) };
        let words = json!(all_words(file));
        Ok(Self { file, written, warnings, words, instruments, budget, bounds_add, work, round, job, set_up, over })
    }

    fn input(&self, options: &ReportOptions) -> MachineInput<'_> {
        MachineInput {
            machine: self.file,
            file: self.file.path(),
            order: order_of(self.file, options.order),
            conditions: options.approach.into(),
            poses: (self.work.as_ref().map_or(options.poses, |(poses, _)| poses.len()), options.seed),
            work: self.work.as_ref().map(|(poses, work)| (poses.as_slice(), work)),
            round: &self.round,
            removed: self.set_up.removed(),
            over: &self.over,
            written: &self.written,
            warnings: &self.warnings,
            words: &self.words,
            instruments: &self.instruments,
            budget: self.budget.as_ref().map(|result| &result.budget),
            coverage: self.budget.as_ref().map(|result| &result.coverage),
            bounds_add: &self.bounds_add,
            type_b: self.file.identify.as_ref().map_or(&[], |section| section.type_b.as_slice()),
        }
    }
}

/// The job of a machine, as `map` finds it.
struct JobWork<'a> {
    reached: &'a ReachedToolPoses,
    map: &'a MapResult,
    round: &'a [RoundFeature],
    /// The budget of the errors with values and of the bounds beside them, where both act.
    budget: Option<&'a BudgetResult>,
}

impl JobWork<'_> {
    /// Returns what the page says of it.
    fn json(&self) -> Value {
        let Self { reached, map, round, budget } = self;
        let profile = |RoundFeature { feature, profile, drawn, .. }: &RoundFeature| {
            json!({"feature": feature, "radius_mm": profile.radius, "height_mm": profile.height,
                "points": profile.points.len(), "minimum_zone_um": profile.minimum_zone * 1e3,
                "least_squares_um": profile.least_squares * 1e3, "drawn": drawn})
        };
        json!({"file": reached.file, "asked": reached.asked, "reached": reached.reached, "travel": reached.travel,
            "features": map.features, "characteristics": map.characteristics,
            "drawn": budget.map(|of| &of.characteristics), "path": map.path,
            "limit": map.limit, "limit_words": map.limit.as_ref().map(LimitVerdict::words),
            "round": round.iter().map(profile).collect::<Vec<_>>()})
    }
}

/// Returns the map of the job of a machine that [`map`](crate::api::map()) would give.
fn map_of_job(
    call: &mut Call,
    machine: &MachineFile,
    options: &ReportOptions,
    is_bounded: bool,
) -> Result<MapResult, Refused> {
    let ReportOptions { path, order, seed, approach, samples, .. } = *options;
    let poses = match (&options.job, &options.tool_poses, &options.axis_poses) {
        (Some(job), ..) => MapPoses::Job(job.clone()),
        (None, Some(tool_poses), _) => MapPoses::ToolPoses(tool_poses.clone()),
        (None, None, Some(axis_poses)) => MapPoses::AxisPoses(axis_poses.clone()),
        (None, None, None) => MapPoses::Grid,
    };
    let (reference, tolerances) = (options.reference.clone(), options.tolerances.clone());
    let order = order.filter(|_| !is_bounded);
    let options =
        MapOptions { poses, path, order, seed, approach, samples, reference, tolerances, ..MapOptions::default() };
    answer_within(call, |run| api::map(machine, &options, run))
}

/// Returns the answer of a call about files that this one has read: its warnings are among those of this one.
fn answer_within<T>(call: &mut Call, ask: impl FnOnce(Run<'_>) -> Reply<T>) -> Result<T, Refused> {
    match ask(Run { deny_warnings: false, ..call.run }) {
        Ok(answer) => Ok(answer.value),
        Err(refusal) => {
            call.go_on()?;
            call.take(Err(refusal))
        }
    }
}

/// The warning for a machine of which nothing is measured, and a target.
fn nothing_to_compensate(file: &MachineFile) -> Diagnostic {
    let message = format!("nothing of `{}` is measured: no compensation of it is shown", shown(file.path()));
    Diagnostic::new(codes::W0802, message).help("give values for measured errors, or omit `--target`")
}

/// Returns the effect of the files that `compile` would write for a target, and their certificate; of two targets
/// joined by a plus sign after the parameters, and after both.
fn compensate(
    call: &mut Call,
    machine: &Machine,
    name: &str,
    options: &ReportOptions,
) -> Result<Vec<TargetResult>, Refused> {
    let (how, depth) = (&options.compensation, Depth { poses: options.poses, seed: options.seed });
    let (target, effect, certificate) = named_effect(call, machine, name, how, depth)?;
    let (certificate, _) = without_unheld(machine, certificate, &*effect.field(machine, &target), depth);
    let parameters = target.manifest.target.split_once('+').map(|(first, _)| first.to_owned());
    let mut steps = Vec::new();
    if let Some(first) = parameters {
        steps.extend(compensate(call, machine, &first, options)?);
    }
    steps.push(TargetResult { target, effect, certificate });
    Ok(steps)
}

/// Returns the profiles of the round features of a job: by the errors with values, or where none has one, in machines
/// drawn between bounds.
fn round(
    call: &Call,
    machine: &Machine,
    (job, reached): (&Job, &ReachedToolPoses),
    options: &ReportOptions,
    (bounded, set_up): (Option<&DrawnBounds>, &SetUp),
) -> Result<Vec<RoundFeature>, Refused> {
    if let Some(drawn) = bounded {
        let (bounds, removed, draws) = (drawn.bounds.as_slice(), set_up.removed(), &drawn.draws());
        let samples = options.samples;
        let of = DrawnRequest { machine, bounds, removed, draws, samples, values: None };
        return drawn_round_features(call, of, reached, &job.features);
    }
    let bare = Bare { machine, order: order_of(machine, options.order) };
    let conditions = options.approach.into();
    let referenced = set_up.field(&bare, bare.order, conditions);
    let field: &dyn Field = referenced.as_ref().map_or(&bare, |field| field);
    Ok(round_features(field, conditions, reached, &job.features))
}

/// Returns the budget that [`budget`](crate::api::budget()) would give over the same poses and reference as the other
/// figures; `None` if no error is bounded.
fn own_budget(
    call: &mut Call,
    machine: &MachineFile,
    options: &ReportOptions,
    has_part: bool,
) -> Result<Option<BudgetResult>, Refused> {
    let ReportOptions { samples, seed, poses, path, .. } = *options;
    let bounded = options.tolerances.bounds_if_any(call, machine)?;
    if bounded.0.is_empty() {
        return Ok(None);
    }
    let (tolerances, tool_poses) = (options.tolerances.clone(), options.tool_poses.clone());
    // Of a volume the page shows one reference.
    let reference = options.reference.clone().or_else(|| (!has_part).then(Reference::default));
    let of =
        BudgetOptions { tolerances, samples, seed, poses, path, tool_poses, reference, ..BudgetOptions::default() };
    let of = BudgetOptions { job: options.job.clone(), axis_poses: options.axis_poses.clone(), ..of };
    let (list, class) = bounded;
    let bounds = BudgetBounds { list, class, are_values: false };
    let ask = |call: &mut Call| {
        let work = BudgetWork::of(call, machine, &of)?;
        budget_of(call, machine, &of, None, work, bounds)
    };
    answer_within(call, |run| Call::answer(run, machine.sources(), ask)).map(Some)
}

/// Several machines on the same work, with their budgets where all have one.
fn comparison(
    call: &mut Call,
    (machines, job): (&[MachineFile], Option<&Job>),
    options: &ReportOptions,
    given: &[MachineInput<'_>],
) -> Result<Option<ComparisonData>, Refused> {
    let work = machines.first().and_then(|first| Some(job?.poses.work(first)));
    let Some((comparison, sides)) = ComparisonData::work(given, work) else { return Ok(None) };
    if comparison.common.is_empty() {
        let over = given[0].over;
        return Ok(Some(ComparisonData::new(given, &comparison, &sides, Value::Null, over, &vec![None; sides.len()])));
    }
    let (set_ups, _) = set_ups(call, machines, &sides, options.reference.as_ref(), job)?;
    let (references, orders) = (removed(&set_ups), given.iter().map(|of| of.order).collect::<Vec<Order>>());
    let bare: Vec<Bare<'_>> = given.iter().map(|of| Bare { machine: of.machine, order: of.order }).collect();
    let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
    let comparison = comparison.without(&fields, &references, &orders, options.approach.into());
    let (samples, seed) = (options.samples, options.seed);
    let names: Vec<&str> = given.iter().map(|given| given.file).collect();
    let (tolerances, files, max_samples) = (&options.tolerances, &*names, most_samples(samples));
    let drawn = DrawnMachines { tolerances, files, samples, max_samples, seed, references: &references };
    let budgets = budgets(call, &sides, drawn)?;
    let json = budgets.map_or(Value::Null, |budgets| json!(budgets));
    let first = machines.first().map_or(given[0].machine, |file| file);
    let counts = [comparison.asked, comparison.common.len()];
    let over = Over::common(first, &set_ups[0].reference, job.map(|job| &job.poses), counts);
    Ok(Some(ComparisonData::new(given, &comparison, &sides, json, &over, &references)))
}
