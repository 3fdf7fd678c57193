//! Content of the page for a machine, as it is embedded: units are in the keys, lengths are mm or um, angles deg or
//! urad.

use super::comparison::ComparisonData;
use super::field::FieldData;
use super::given::{MachineInput, TargetResult};
use crate::analysis::budget::{BoundedDeviation, Coverage};
use crate::analysis::reference::ReferencedField;
use crate::analysis::{ErrorStatistics, LocationSet, Map, Status, body_diagonals, error_statistics, levers, rest};
use crate::controller::CompensationDegree;
use crate::evaluate::{Bare, Field, Frame, Order, Statistics, Summary, worst};
use crate::job::over::Over;
use crate::machine::{
    Approach, Axis, ErrorId, ErrorTerm, Machine, OperatingConditions, ResidualForm, Travel, axis_positions,
};
use crate::report::pictures::{Bar, ParetoPicture, Picture};
use crate::report::text::BudgetFigures;
use serde::Serialize;
use serde_json::{Value, json};

/// Everything the page shows.
#[derive(Debug, Clone, Serialize)]
pub struct PageData {
    /// Version of the program.
    pub abbe: &'static str,
    /// The machines, in their order.
    pub machines: Vec<MachineData>,
    /// Two or more of them side by side.
    pub comparison: Option<ComparisonData>,
    /// Colours of the scale, from none to the largest deviation.
    pub colours: Vec<String>,
}

/// One machine.
#[derive(Debug, Clone, Serialize)]
pub struct MachineData {
    /// `m1`, `m2` ...: unique in the page.
    pub id: String,
    name: String,
    file: String,
    chain: String,
    tool: Value,
    workpiece_origin_mm: [f64; 3],
    workpiece_rotation_deg: [f64; 3],
    order: String,
    /// Poses and reference of statistics, worst poses, features and single errors.
    over: Over,
    /// The same in words.
    over_line: String,
    direction: Approach,
    poses: usize,
    seed: u64,
    axes: Vec<Value>,
    conventions: Value,
    provenance: Vec<(String, String)>,
    warnings: Vec<String>,
    /// What each error is, in words by its name.
    words: Value,
    locations: Vec<Value>,
    statistics: Value,
    /// What the bounds lead to, where nothing is measured: then the statistics are of the 95 % value. Null otherwise.
    bounds: Value,
    /// What bounds add to the measured errors; null where they add nothing.
    bounds_add: Value,
    /// Intervals of the statistics by the uncertainty of the errors, forms of the axes, and type B; null without.
    uncertainty: Value,
    /// Number of component errors that are bounded.
    bounded_components: usize,
    /// The file of tool poses, its features and what is out of reach; null without.
    work: Value,
    worst: Vec<Value>,
    /// Number of the first poses that `error_statistics` uses.
    source_poses: usize,
    sources: Vec<Value>,
    diagonals: Vec<Value>,
    instruments: Value,
    budget: Value,
    /// Which of the errors that act have a value, a bound, or neither; null without a budget.
    coverage: Value,
    certificates: Vec<Value>,
    field: FieldData,
}

/// Number of the worst poses that are named.
const WORST: usize = 5;

/// Maximum number of poses for the effect of each error alone: all errors at all poses are held at once.
const SOURCE_POSES: usize = 10_000;

const DIAGONAL_STEPS: usize = 20;

impl MachineData {
    /// Computes everything about a machine.
    pub fn new(number: usize, given: &MachineInput<'_>, map: &Map) -> Self {
        let machine = given.machine;
        let bare = Bare { machine, order: given.order };
        let (order, conditions) = (given.order, given.conditions);
        let set_up = given.removed.map(|removed| ReferencedField::new(&bare, removed, order, conditions));
        let field: &dyn Field = set_up.as_ref().map_or(&bare, |field| field);
        let poses = given.sample();
        let bad = worst(&map.deviations, WORST);
        let worst_pose = bad.first().map_or_else(|| rest(machine), |i| poses.get(*i));
        let few = (given.poses.0.min(SOURCE_POSES), given.poses.1);
        let few_poses = MachineInput { poses: few, ..*given }.sample();
        let named = |i: &usize| {
            let d = &map.deviations[*i];
            json!({"axes": axis_positions(machine, &poses.get(*i)), "deviation_um": scale(d.position, 1e3),
                "length_um": d.position.norm() * 1e3, "rotation_urad": scale(d.rotation, 1e6)})
        };
        Self {
            statistics: statistics(&map.statistics),
            worst: bad.iter().map(named).collect(),
            source_poses: few.0,
            sources: error_statistics(field, &few_poses, &conditions.at_pose(&worst_pose), given.removed)
                .iter()
                .map(source)
                .collect(),
            diagonals: diagonals(&bare, given.conditions),
            certificates: given.written.iter().map(|written| certificate(machine, written)).collect(),
            ..Self::describe(number, given, FieldData::new(given))
        }
    }

    /// Computes everything about a machine of which nothing is measured.
    pub fn of_bounds(number: usize, given: &MachineInput<'_>, bounded: &BudgetFigures) -> Self {
        let (machine, poses) = (given.machine, given.sample());
        let found = given.at(bounded, &poses, Frame::Workpiece, given.removed);
        let figures = MachineInput::figures(bounded, &found);
        let p95 = |i: &usize| found.poses[*i].position.p95;
        let mut order: Vec<usize> = (0..found.poses.len()).collect();
        order.sort_by(|a, b| p95(b).total_cmp(&p95(a)).then(a.cmp(b)));
        let named = |i: &usize| {
            let BoundedDeviation { position, rotation } = found.poses[*i];
            json!({"axes": axis_positions(machine, &poses.get(*i)), "p95_um": position.p95 * 1e3,
                "rss_um": position.rss * 1e3, "p95_urad": rotation.p95 * 1e6, "rss_urad": rotation.rss * 1e6})
        };
        Self {
            statistics: statistics(&figures.statistics(poses.len())),
            bounds: json!(figures),
            worst: order.iter().take(WORST).map(named).collect(),
            ..Self::describe(number, given, FieldData::of_bounds(given, bounded))
        }
    }

    /// The same with intervals of the statistics, and what the file states of their origin.
    pub fn with_uncertainty(self, given: &MachineInput<'_>, intervals: Value) -> Self {
        let machine = given.machine;
        let form = |form: &ResidualForm| {
            let unit = machine.axis_index(form.axis.as_str()).map_or("mm", |i| machine.axes()[i].unit());
            json!({"axis": form.axis.as_str(), "size_um": form.mean_size(false) * 1e3,
                "rotation_urad": form.mean_size(true) * 1e6,
                "length": form.length, "unit": unit})
        };
        let forms: Vec<Value> = machine.forms().iter().map(form).collect();
        if intervals.is_null() {
            return self;
        }
        let uncertainty = json!({"intervals": intervals, "forms": forms, "type_b": given.type_b});
        Self { uncertainty, ..self }
    }

    /// Returns the data that do not depend on deviations.
    fn describe(number: usize, given: &MachineInput<'_>, field: FieldData) -> Self {
        let machine = given.machine;
        Self {
            id: format!("m{number}"),
            name: machine.name().to_owned(),
            file: given.file.to_owned(),
            chain: machine.chain().to_string(),
            tool: tool(machine),
            workpiece_origin_mm: machine.workpiece(),
            workpiece_rotation_deg: machine.workpiece_angles(),
            order: if given.budget().is_some() { "first order".to_owned() } else { order_word(given.order) },
            over: given.over.clone(),
            over_line: given.over.line(),
            direction: given.conditions.approach,
            poses: given.poses.0,
            seed: given.poses.1,
            axes: axes(machine),
            conventions: json!(machine.conventions()),
            provenance: machine.provenance().entries.clone(),
            warnings: given.warnings.to_vec(),
            words: given.words.clone(),
            locations: locations(machine, given.budget()),
            statistics: Value::Null,
            bounds: Value::Null,
            bounds_add: given.bounds_add.clone(),
            uncertainty: Value::Null,
            bounded_components: given.budget.map_or(0, component_bounds),
            work: given.work.map_or(Value::Null, |(_, work)| work.clone()),
            worst: Vec::new(),
            source_poses: 0,
            sources: Vec::new(),
            diagonals: Vec::new(),
            instruments: given.instruments.json(machine),
            budget: json!(given.budget),
            coverage: given.coverage.map_or(Value::Null, coverage),
            certificates: Vec::new(),
            field,
        }
    }
}

fn coverage(of: &Coverage) -> Value {
    json!({"valued": of.valued, "bounded": of.bounded, "missing": of.missing, "acting": of.acting()})
}

fn component_bounds(budget: &BudgetFigures) -> usize {
    budget.bounds.iter().filter(|bound| !bound.error.is_location()).count()
}

fn statistics(of: &Statistics) -> Value {
    json!({"position_um": of.position_um, "rotation_urad": of.rotation_urad,
        "rotation_arcsec": arcsec(&of.rotation_urad)})
}

impl MachineData {
    /// Returns the errors with the largest effect alone, and their sum; `None` without errors.
    pub fn pareto(&self, top: usize) -> Option<Picture> {
        let bar = |s: &Value| Some(Bar { label: s["error"].as_str()?.to_owned(), value: s["p95_um"].as_f64()? });
        let bars: Vec<Bar> = self.sources.iter().filter_map(bar).collect();
        let total = bars.iter().map(|b| b.value * b.value).sum();
        let picture = ParetoPicture {
            title: self.name.clone(),
            subtitle: "Each error alone, as the file gives it: 95 % of the poses lie below".to_owned(),
            quantity: "position deviation in µm".to_owned(),
            bars: bars.into_iter().take(top).collect(),
            total,
        };
        (total > 0.0).then(|| picture.picture())
    }
}

/// Adding zero turns -0 into 0.
fn scale(v: nalgebra::Vector3<f64>, factor: f64) -> [f64; 3] {
    v.map(|x| x * factor + 0.0).into()
}

fn order_word(order: Order) -> String {
    match order {
        Order::Exact => "exact model".to_owned(),
        Order::Degree(n) => format!("model of order {n}"),
    }
}

fn arcsec(urad: &Summary) -> Value {
    let of = |x: f64| (x * 1e-6).to_degrees() * 3600.0;
    json!({"max": of(urad.max), "mean": of(urad.mean), "rms": of(urad.rms), "p95": of(urad.p95),
        "range": urad.range.map(of)})
}

fn tool(machine: &Machine) -> Value {
    let tool = machine.tool();
    json!({"name": tool.name, "gauge_mm": tool.gauge, "tip_mm": tool.tip})
}

fn axes(machine: &Machine) -> Vec<Value> {
    let of = |((axis, lever), grid): ((&Axis, _), &crate::machine::Grid)| {
        let lever: crate::analysis::Lever = lever;
        let (min, max) = axis.travel.interval();
        json!({"name": axis.name.as_str(), "kind": axis.kind, "side": axis.branch, "sense": axis.sense,
            "direction": axis.direction, "origin_mm": axis.origin, "travel": [min, max],
            "continuous": axis.travel == Travel::Continuous, "unit": axis.unit(), "volume": [grid.min, grid.max],
            "arm_at_zero_mm": lever.at_zero, "arm_longest_mm": lever.longest})
    };
    machine.axes().iter().zip(levers(machine)).zip(machine.volume()).map(of).collect()
}

/// The location errors that the chain needs, then those given besides.
fn locations(machine: &Machine, bounded: Option<&BudgetFigures>) -> Vec<Value> {
    let set = LocationSet::of(machine);
    let value = |id: &ErrorId| {
        let term = machine.errors().find(|(known, _)| known == id).map(|(_, term)| term.clone());
        let (factor, unit) = if id.direction.is_rotation() { (1e6, "µrad") } else { (1e3, "µm") };
        match term {
            Some(ErrorTerm::Constant(value)) => (json!(value * factor), json!(null), unit),
            Some(ErrorTerm::Tolerance(bound)) => (json!(null), json!(bound * factor), unit),
            _ => {
                let bound = bounded.and_then(|of| of.bounds.iter().find(|bound| bound.error == *id));
                (json!(null), json!(bound.map(|bound| bound.tolerance * factor)), unit)
            }
        }
    };
    let row = |id: &ErrorId, status: &str| {
        let (value, tolerance, unit) = value(id);
        let factor = id.direction.micro().0;
        let uncertainty = machine.uncertainty(id).map(|half| half * factor);
        json!({"error": id, "status": status, "value": value, "uncertainty": uncertainty, "tolerance": tolerance,
            "unit": unit})
    };
    let is_bounded = |id: &ErrorId| bounded.is_some_and(|of| of.bounds.iter().any(|bound| bound.error == *id));
    let word = |id: &ErrorId, status: Status| match status {
        Status::Given => "given",
        Status::Bounded if bounded.is_some() => "only bounded",
        Status::Bounded => "only bounded by a tolerance: zero here",
        Status::Covered => "implied by the others",
        Status::Missing if is_bounded(id) => "not in the file by name: bounded otherwise",
        Status::Missing => "missing: taken as zero",
    };
    let needed = set.members.iter().map(|(id, status)| row(id, word(id, *status)));
    needed.chain(set.besides.iter().map(|id| row(id, "given besides"))).collect()
}

fn source(source: &ErrorStatistics) -> Value {
    json!({"error": source.error, "kind": if source.error.is_location() { "location" } else { "component" },
        "p95_um": source.position.p95, "max_um": source.position.max, "mean_um": source.position.mean,
        "p95_urad": source.rotation.p95, "at_worst_um": source.along + 0.0})
}

fn diagonals(bare: &Bare<'_>, conditions: OperatingConditions) -> Vec<Value> {
    let machine = bare.machine;
    let of = |d: &crate::analysis::DiagonalRun| {
        let deviations: Vec<f64> = d.deviations.iter().map(|x| x * 1e3 + 0.0).collect();
        json!({"name": d.name, "from": axis_positions(machine, &d.ends[0]), "to": axis_positions(machine, &d.ends[1]),
            "length_mm": d.length, "range_um": d.range() * 1e3, "end_um": deviations.last(),
                "deviations_um": deviations})
    };
    body_diagonals(bare, &conditions.at_pose(&rest(machine)), DIAGONAL_STEPS).iter().map(of).collect()
}

fn certificate(machine: &Machine, written: &TargetResult) -> Value {
    let TargetResult { target, certificate, .. } = written;
    let manifest = &target.manifest;
    let certainty = |c: &crate::controller::Certainty| json!({"level": c.level.word(), "source": c.source});
    let mut errors: Vec<_> = certificate.errors.iter().collect();
    errors.sort_by(|a, b| b.residual_um.total_cmp(&a.residual_um));
    let error = |e: &&crate::controller::SingleErrorResidual| {
        json!({"error": e.error, "handled": degree(e.degree),
        "alone_um": e.alone_um, "left_um": e.residual_um})
    };
    let by_axis = |values: &[f64]| {
        let entry =
            |(axis, c): (&Axis, &f64)| json!({"axis": axis.name.as_str(), "unit": axis.unit(), "added": c + 0.0});
        machine.axes().iter().zip(values).map(entry).collect::<Vec<_>>()
    };
    json!({
        "target": manifest.target, "title": manifest.title, "expresses": manifest.expresses, "cannot": manifest.cannot,
        "syntax": certainty(&manifest.certainty.syntax),
        "sign": certainty(&manifest.certainty.sign),
        "frame": manifest.certainty.frame.as_ref().map(certainty),
        "poses": certificate.poses, "direction": certificate.approach,
        "uncompensated": certificate.uncompensated, "compensated": certificate.compensated,
        "errors": errors.iter().map(error).collect::<Vec<_>>(),
        "home": machine.home().is_some(),
        "at_reference": {"forward": by_axis(&certificate.at_reference[0]),
            "reverse": by_axis(&certificate.at_reference[1])},
    })
}

fn degree(degree: CompensationDegree) -> &'static str {
    match degree {
        CompensationDegree::Fully => "fully",
        CompensationDegree::Partly => "partly",
        CompensationDegree::No => "no",
    }
}
