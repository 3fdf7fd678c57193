//! Assignment of corrections to tables: from a machine and a target's mechanisms.
//!
//! 1. A controller with the model gets the error curves, and nothing else.
//! 2. A lattice over the requested axes holds everything, and is the only table.
//! 3. Otherwise rotary axes get their own tables from their own error. The residual of the functional point goes to the
//!    linear axes: own and cross tables, then planes or a lattice over fixed axes for their residual
//!    ([`super::sum`]). Tables without effect are not written.

use super::batch::correct_all_from;
use super::curves::{error_curves, straight};
use super::nodes::{AxisCurves, ColumnValues, interval, rolling};
use super::product::{self, TABLES_OF_A_PRODUCT};
use super::sum::{Demand, Filler, Traits};
use super::{
    Correction, CorrectionTable, CorrectionTables, Directions, Encoding, Factors, Fit, LatticeRequest, LatticeRules,
    Mechanisms, OwnAxisRules, PlaneGrid, PlaneRules, Reference, Scope, Spacing, TableRules, lattice, own_axis_table,
};
use crate::evaluate::{CompiledModel, Order};
use crate::machine::{Approach, AxisKind, Direction, ErrorTerm, Machine, OperatingPoint, Pose};
use crate::units::Interval;

/// Fills the tables of the mechanisms and rounds them to their increments.
pub fn tables(machine: &Machine, mechanisms: &Mechanisms, request: &LatticeRequest) -> CorrectionTables {
    let mut tables = fill(machine, mechanisms, request);
    let scales = tables.tables.iter().filter(|table| mechanisms.is_scale(table));
    tables.scales = scales.filter_map(|t| Some((t.axes[0], mechanisms.scale_in_force(machine, t.axes[0])?))).collect();
    for table in &mut tables.tables {
        if let Some(rules) = mechanisms.rules(table).filter(|rules| rules.reference == Reference::Zero) {
            vanish_at_reference(table, rules.directions == Directions::Backlash);
        }
    }
    mechanisms.round(machine, &mut tables);
    for table in tables.tables.iter_mut().filter(|table| !mechanisms.is_product(table)) {
        let modulo = mechanisms.rules(table).is_some_and(|rules| rules.modulo);
        for place in (0..table.axes.len().min(2)).filter(|_| modulo) {
            if machine.is_continuous(table.axes[place]) {
                close(table, place);
            }
        }
    }
    tables.merge()
}

fn fill(machine: &Machine, mechanisms: &Mechanisms, request: &LatticeRequest) -> CorrectionTables {
    if let Some(rules) = &mechanisms.error_curves {
        return CorrectionTables { errors: error_curves(machine, rules), ..CorrectionTables::default() };
    }
    if let Some(rules) = mechanisms.lattice.as_ref().filter(|rules| rules.inputs.is_empty()) {
        return CorrectionTables { tables: vec![lattice(machine, rules, request)], ..CorrectionTables::default() };
    }
    Planner { machine, mechanisms }.tables()
}

/// Makes a table zero at position 0, between points too, or at the end nearest to it. The difference between reverse
/// and forward stays, unless the controller has a number for it there that cannot be negative.
pub(super) fn vanish_at_reference(table: &mut CorrectionTable, positive_backlash: bool) {
    let width = table.corrected.len();
    let nearest = |nodes: &Vec<f64>| {
        nodes.iter().enumerate().min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(i, _)| i)
    };
    let node = table.nodes.iter().fold(0, |number, nodes| number * nodes.len() + nearest(nodes));
    let at: Vec<f64> = match (&table.nodes[..], width) {
        ([nodes], 1) => vec![straight(nodes, &table.values, 0.0)],
        _ => table.values[node * width..(node + 1) * width].to_vec(),
    };
    for values in std::iter::once(&mut table.values).chain(&mut table.reverse) {
        values.iter_mut().enumerate().for_each(|(i, c)| *c -= at[i % width]);
    }
    if let Some(reverse) = table.reverse.as_mut().filter(|_| positive_backlash) {
        reverse[node] = reverse[node].min(0.0);
    }
}

/// A table over a turn ends with the values with which it begins.
fn close(table: &mut CorrectionTable, place: usize) {
    let stride: usize = table.nodes[place + 1..].iter().map(Vec::len).product();
    let (count, width) = (table.nodes[place].len(), table.corrected.len());
    let last = (0..table.len()).filter(|node| node / stride % count == count - 1);
    let pairs: Vec<(usize, usize)> = last.map(|node| (node, node - stride * (count - 1))).collect();
    for values in std::iter::once(&mut table.values).chain(&mut table.reverse) {
        for (last, first) in &pairs {
            (0..width).for_each(|i| values[last * width + i] = values[first * width + i]);
        }
    }
}

/// Returns the corrections of own-axis tables at an operating point, straight lines between their nodes.
pub(super) fn own_axis_addition(tables: &[CorrectionTable], at: &OperatingPoint<'_>) -> Vec<f64> {
    let mut added = vec![0.0; at.axes.len()];
    for table in tables {
        let (nodes, axis) = (&table.nodes[0], table.axes[0]);
        let q = at.axes[axis].clamp(nodes[0], nodes[nodes.len() - 1]);
        let high = nodes.partition_point(|node| *node <= q).clamp(1, nodes.len().max(2) - 1).min(nodes.len() - 1);
        let low = high.saturating_sub(1);
        let fraction = if high > low { (q - nodes[low]) / (nodes[high] - nodes[low]) } else { 0.0 };
        let between = |values: &[f64]| values[low] * (1.0 - fraction) + values[high] * fraction;
        let reverse = table.reverse.as_ref().unwrap_or(&table.values);
        added[axis] += match at.conditions.approach {
            Approach::Forward => between(&table.values),
            Approach::Reverse => between(reverse),
            Approach::Mean => 0.5 * (between(&table.values) + between(reverse)),
        };
    }
    added
}

/// Returns corrections of all axes at poses with the own-error tables in force: the linear axes correct their residual.
fn corrections_beside(plan: &CompiledModel, own: &[CorrectionTable], poses: &[Pose]) -> Vec<Vec<f64>> {
    let start = |pose: &Pose| Correction(own_axis_addition(own, &plan.conditions().at_pose(pose)));
    let all = correct_all_from(plan, poses, poses.iter().map(start).collect(), Scope::POSITION);
    // The plan is exact: there is always an answer.
    all.unwrap_or_default().into_iter().map(|corrected| corrected.correction.0).collect()
}

/// Layout of a table over several axes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum GridShape {
    Plane(PlaneGrid),
    Product,
    Lattice,
}

pub(super) struct Planner<'a> {
    pub machine: &'a Machine,
    pub mechanisms: &'a Mechanisms,
}

impl Planner<'_> {
    pub fn tables(&self) -> CorrectionTables {
        let own = self.own_error_tables();
        let alone: Vec<Machine> =
            self.machine.axes().iter().map(|axis| self.machine.filtered(|id| id.axis == axis.name)).collect();
        let exact = |machine: &Machine, approach| CompiledModel::new(machine, Order::Exact, approach);
        let plan = exact(self.machine, Approach::Mean);
        let mean = |poses: &[Pose]| corrections_beside(&plan, &own, poses);
        let both_models = |machine: &Machine| {
            machine
                .is_bidirectional()
                .then(|| [Approach::Forward, Approach::Reverse].map(|approach| exact(machine, approach)))
        };
        let both: Vec<Option<[CompiledModel; 2]>> = alone.iter().map(both_models).collect();
        let half = |poses: &[Pose], axis: usize| {
            let Some([forward, reverse]) = &both[axis] else { return vec![vec![0.0; both.len()]; poses.len()] };
            let (forward, reverse) = (corrections_beside(forward, &[], poses), corrections_beside(reverse, &[], poses));
            let half = |(f, r): (Vec<f64>, Vec<f64>)| f.iter().zip(&r).map(|(f, r)| 0.5 * (f - r)).collect();
            forward.into_iter().zip(reverse).map(half).collect()
        };
        let mut filler = Filler::new(self.machine, Demand { mean: &mean, half: &half });
        let mut sets =
            |layout: &[CorrectionTable]| filler.fill(layout, &self.traits(layout)).pop().unwrap_or_default().tables;
        let mut layout = self.choose_tables(sets(&self.curve_layout()), &own);
        layout.iter_mut().for_each(|table| self.refine(table));
        if let Some(rules) = &self.mechanisms.plane {
            let trial = sets(&[layout.clone(), self.planes(rules)].concat());
            let planes: Vec<CorrectionTable> = trial.into_iter().filter(|t| t.axes.len() == 2).collect();
            let chosen = self.limit(planes, &rules.table, self.room(&[&own, &layout]));
            let shape = GridShape::Plane(rules.grid);
            layout.extend(chosen.iter().map(|t| self.grid(&t.axes, t.corrected.clone(), &rules.table, shape, false)));
        }
        if let Some(rules) = &self.mechanisms.product {
            let trial = [layout.clone(), self.product_planes(rules)].concat();
            let planes = sets(&trial).into_iter().filter(|t| t.axes.len() == 2).collect();
            layout.extend(self.products(planes, rules, self.room(&[&own, &layout])));
        }
        if let Some(rules) = &self.mechanisms.lattice {
            layout.extend(self.fixed_lattice(rules));
        }
        let mut tables = sets(&layout);
        tables.extend(own.iter().cloned());
        self.complete(&mut tables);
        CorrectionTables { tables, ..CorrectionTables::default() }
    }

    pub fn traits(&self, layout: &[CorrectionTable]) -> Vec<Traits> {
        let of = |table: &CorrectionTable| {
            let rules = self.mechanisms.rules(table);
            let straight = rules.is_some_and(|rules| rules.spacing == Spacing::Line);
            // A trial of products has no factors yet: it holds all of the plane.
            let products = self.mechanisms.is_product(table).then_some(match table.factors.len() {
                0 => usize::MAX,
                count => count,
            });
            Traits {
                straight,
                products,
                constant: !straight && rules.is_some_and(|rules| rules.reference == Reference::Any),
            }
        };
        layout.iter().map(of).collect()
    }

    /// True if a table comes from its axis's own error: tables of rotary axes do, and of linear ones if the target
    /// states so.
    pub fn is_by_own_error(&self, table: &CorrectionTable) -> bool {
        let by_axis = self.mechanisms.own_rules().is_some_and(|rules| rules.fit == Fit::Axis);
        table.is_own_axis() && (by_axis || self.machine.axes()[table.axes[0]].kind == AxisKind::Rotary)
    }

    fn own_error_tables(&self) -> Vec<CorrectionTable> {
        // A scale is a line over the volume, of linear axes.
        let rules = self.mechanisms.own_rules().filter(|_| self.mechanisms.scale().is_none());
        let Some(rules) = rules else { return Vec::new() };
        let alone = self.mechanisms.cross_axis.is_none() && self.mechanisms.plane.is_none();
        let kinds: &[AxisKind] =
            if rules.fit == Fit::Axis { &[AxisKind::Linear, AxisKind::Rotary] } else { &[AxisKind::Rotary] };
        let shared = |axis: usize| self.mechanisms.own_axis.is_none().then(|| self.positions(axis, rules));
        let wanted = |axis: &usize| kinds.contains(&self.machine.axes()[*axis].kind);
        let axes = (0..self.machine.axes().len()).filter(wanted);
        // Own and cross tables over the same axis have the same points: one list may hold both.
        let tables = axes.map(|axis| {
            let table = own_axis_table(self.machine, axis, rules, shared(axis));
            let mut fine = table.clone();
            self.refine(&mut fine);
            let finer = fine.nodes != table.nodes;
            if finer { own_axis_table(self.machine, axis, rules, fine.nodes.pop()) } else { table }
        });
        // A controller with own-axis tables alone has one for every axis.
        tables.filter(|table| (alone && rules.fit == Fit::Axis) || self.counts(table)).collect()
    }

    /// Where numbers are differences, takes the largest interval with which none is above a unit: a control that gives
    /// them as pulses leaves most of a pulse between two points, and shorter intervals leave as much.
    fn refine(&self, table: &mut CorrectionTable) {
        let Some(rules) = self.mechanisms.rules(table).filter(|rules| rules.encoding == Encoding::Difference) else {
            return;
        };
        let kind = self.machine.axes()[table.corrected[0]].kind;
        let unit = 2.0 * rules.increment.half_correction(kind);
        let values = std::iter::once(&table.values).chain(&table.reverse);
        let steps = values.flat_map(|values| values.windows(2)).map(|w| (w[1] - w[0]).abs() / unit);
        let intervals = table.nodes[0].len() - 1;
        let most = (rules.max_points.min(rules.max_points_per_axis) - 3) / intervals.max(1);
        // A hundredth of a unit is rounding of the fit.
        let wanted = libm::ceil(steps.fold(0.0, f64::max) - 0.01).max(1.0) as usize;
        let [first, last] = [table.nodes[0][0], table.nodes[0][intervals]];
        let step = |parts: usize| (last - first) / (intervals * parts) as f64;
        let whole = |parts: &usize| {
            let increments = step(*parts) / rules.increment.min_position(self.machine.axes()[table.axes[0]].kind);
            (increments - libm::round(increments)).abs() < 1e-6
        };
        let parts = (wanted..=most).find(whole).or_else(|| (1..=most).rev().find(whole)).unwrap_or(1);
        let nodes = (0..=intervals * parts).map(|i| first + i as f64 * step(parts));
        let nodes = rules.increment.distinct(nodes, self.machine.axes()[table.axes[0]].kind);
        let at =
            |values: &Vec<f64>| -> Vec<f64> { nodes.iter().map(|q| straight(&table.nodes[0], values, *q)).collect() };
        let (values, reverse) = (at(&table.values), table.reverse.as_ref().map(at));
        *table = CorrectionTable { nodes: vec![nodes], values, reverse, ..table.clone() };
    }

    /// Tables of zeros for axes without any where the controller wants one for each.
    fn complete(&self, tables: &mut Vec<CorrectionTable>) {
        let Some(rules) = self.mechanisms.own_axis.as_ref().filter(|rules| rules.every_axis) else { return };
        for axis in 0..self.machine.axes().len() {
            if !tables.iter().any(|table| table.is_own_axis() && table.axes[0] == axis) {
                let range = interval(self.machine, axis, &rules.table);
                tables.push(CorrectionTable::curve(axis, vec![range.min, range.max], axis, vec![0.0; 2]));
            }
        }
    }

    /// True if anything but zeros is stored.
    fn counts(&self, table: &CorrectionTable) -> bool {
        let Some(rules) = self.mechanisms.rules(table) else { return false };
        let width = table.corrected.len();
        let all = table.values.chunks(width).chain(table.reverse.iter().flat_map(|r| r.chunks(width)));
        all.flat_map(|row| row.iter().zip(&table.corrected))
            .any(|(c, axis)| c.abs() > rules.increment.half_correction(self.machine.axes()[*axis].kind))
    }

    fn curve_layout(&self) -> Vec<CorrectionTable> {
        let linear = |axis: &usize| self.machine.axes()[*axis].kind == AxisKind::Linear;
        let axes = 0..self.machine.axes().len();
        let outputs: Vec<usize> = axes.clone().filter(linear).collect();
        let pairs = axes.flat_map(|input| outputs.iter().map(move |output| (input, *output)));
        pairs.filter_map(|(input, output)| self.curve(input, output)).collect()
    }

    fn curve(&self, input: usize, output: usize) -> Option<CorrectionTable> {
        let own = input == output;
        if own && self.mechanisms.scale().is_some() {
            self.mechanisms.scale_in_force(self.machine, input)?;
        }
        let cross = self.mechanisms.cross_axis.as_ref();
        let (rules, by_cross) = if own {
            let rules = self.mechanisms.own_rules().filter(|rules| rules.fit == Fit::FunctionalPoint)?;
            (rules, self.mechanisms.own_axis.is_none())
        } else {
            (&cross?.table, true)
        };
        let axes = self.machine.axes();
        let name = |axis: usize| axes[axis].name.as_str();
        let pairs = cross.filter(|_| by_cross).map_or(&[][..], |cross| &cross.pairs);
        let listed = |[i, o]: &[String; 2]| (i.as_str(), o.as_str()) == (name(input), name(output));
        if !pairs.is_empty() && !pairs.iter().any(listed) {
            return None;
        }
        let table = CorrectionTable::curve(input, self.positions(input, rules), output, Vec::new());
        Some(CorrectionTable {
            reverse: (rules.directions.is_bidirectional() && self.machine.is_bidirectional()).then(Vec::new),
            ..table
        })
    }

    /// Nodes over an axis for the deviation of the functional point. Free points are at the knots of all its curves, or
    /// where straight lines have the smallest residual of those.
    fn positions(&self, axis: usize, rules: &TableRules) -> Vec<f64> {
        let any = |_: Direction| true;
        let values = |q: f64| self.machine.component_values(axis, &q.into()).to_vec();
        let sines = self.machine.axes()[axis].kind == AxisKind::Rotary;
        AxisCurves { machine: self.machine, axis, counts: &any, sines }
            .positions(rules, &ColumnValues { value: &values, stored: &|x| x })
    }

    /// Returns the number of the controller's tables that remain beside those that are taken.
    fn room(&self, taken: &[&[CorrectionTable]]) -> usize {
        let count: usize =
            taken.iter().flat_map(|tables| tables.iter()).map(|table| self.mechanisms.count(table)).sum();
        self.mechanisms.tables.map_or(usize::MAX, |all| all.saturating_sub(count))
    }

    /// Those of the filled tables that do something, as many as the rules allow, beside tables that are there already.
    fn choose_tables(&self, tables: Vec<CorrectionTable>, there: &[CorrectionTable]) -> Vec<CorrectionTable> {
        let own = self.mechanisms.own_axis.is_some();
        let (own, cross): (Vec<_>, Vec<_>) = tables.into_iter().partition(|t| own && t.is_own_axis());
        let limit = |tables: Vec<CorrectionTable>, rules: Option<&TableRules>, room: usize| {
            rules.map_or_else(Vec::new, |rules| self.limit(tables, rules, room))
        };
        let own_rules = self.mechanisms.own_axis.as_ref().map(|own| &own.table);
        let cross_rules = self.mechanisms.cross_axis.as_ref().map(|cross| &cross.table);
        let mut all = limit(own, own_rules, self.room(&[there]));
        let cross = limit(cross, cross_rules, self.room(&[there, &all]));
        all.extend(cross);
        all
    }

    fn limit(&self, tables: Vec<CorrectionTable>, rules: &TableRules, mut room: usize) -> Vec<CorrectionTable> {
        let mut ranked: Vec<(f64, CorrectionTable)> =
            tables.into_iter().filter(|t| self.counts(t)).map(|t| (strength(&t), t)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut taken: Vec<CorrectionTable> = Vec::new();
        for (_, table) in ranked {
            let same_output = taken.iter().filter(|t| t.corrected == table.corrected).count();
            let count = self.mechanisms.count(&table);
            if taken.len() < rules.max_tables && same_output < rules.max_tables_per_output && count <= room {
                room -= count;
                taken.push(table);
            }
        }
        taken.sort_by(|a, b| (&a.corrected, &a.axes).cmp(&(&b.corrected, &b.axes)));
        taken
    }

    /// Tables for the strongest products of the given planes, as many as there is room for.
    fn products(&self, planes: Vec<CorrectionTable>, rules: &TableRules, room: usize) -> Vec<CorrectionTable> {
        // Below a tenth of a micrometre a product is not worth its tables.
        const WORTH: f64 = 1e-4;
        const MAX_PARTS: usize = 4;
        let of = |(i, plane): (usize, &CorrectionTable)| {
            let parts = product::parts(&plane.values, plane.nodes[1].len(), MAX_PARTS, WORTH);
            parts.into_iter().map(move |part| (product::strength(&part), i)).collect::<Vec<_>>()
        };
        let mut ranked: Vec<(f64, usize)> = planes.iter().enumerate().flat_map(of).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate((room / TABLES_OF_A_PRODUCT).min(rules.max_tables));
        let table = |(i, plane): (usize, &CorrectionTable)| {
            let count = ranked.iter().filter(|(_, plane)| *plane == i).count();
            let layout = (count > 0)
                .then(|| self.grid(&plane.axes, plane.corrected.clone(), rules, GridShape::Product, false))?;
            Some(CorrectionTable { factors: vec![Factors::default(); count], ..layout })
        };
        planes.iter().enumerate().filter_map(table).collect()
    }

    /// A coarse plane over every two of the axes that the rules allow, for every linear axis that they name.
    fn planes(&self, rules: &PlaneRules) -> Vec<CorrectionTable> {
        let axes = self.machine.axes();
        let listed =
            |axis: usize, names: &[String]| names.is_empty() || names.iter().any(|n| n == axes[axis].name.as_str());
        let fit = |axis: &usize| {
            (rules.rotary_inputs || axes[*axis].kind == AxisKind::Linear) && listed(*axis, &rules.inputs)
        };
        let inputs: Vec<usize> = (0..axes.len()).filter(fit).collect();
        let outputs: Vec<usize> = self.linear_axes().filter(|axis| listed(*axis, &rules.outputs)).collect();
        let first = |a: usize, b: usize| (rules.inputs.is_empty(), a < b, axes[a].name < axes[b].name);
        let pairs = inputs.iter().flat_map(|a| inputs.iter().map(move |b| [*a, *b]));
        let pairs = pairs.filter(|[a, b]| matches!(first(*a, *b), (true, true, _) | (false, _, true)));
        self.trials(pairs, &outputs, &rules.table, GridShape::Plane(rules.grid))
    }

    /// A coarse plane over every two axes for every linear axis, to be written as products.
    fn product_planes(&self, rules: &TableRules) -> Vec<CorrectionTable> {
        let count = self.machine.axes().len();
        let outputs: Vec<usize> = self.linear_axes().collect();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        self.trials(pairs, &outputs, rules, GridShape::Product)
    }

    fn linear_axes(&self) -> impl Iterator<Item = usize> {
        (0..self.machine.axes().len()).filter(|axis| self.machine.axes()[*axis].kind == AxisKind::Linear)
    }

    fn trials(
        &self,
        pairs: impl Iterator<Item = [usize; 2]>,
        outputs: &[usize],
        rules: &TableRules,
        shape: GridShape,
    ) -> Vec<CorrectionTable> {
        pairs
            .flat_map(|pair| outputs.iter().map(move |o| (pair, *o)))
            .map(|(pair, o)| self.grid(&pair, vec![o], rules, shape, true))
            .collect()
    }

    /// A table over several axes without values.
    fn grid(
        &self,
        axes: &[usize],
        corrected: Vec<usize>,
        rules: &TableRules,
        shape: GridShape,
        coarse: bool,
    ) -> CorrectionTable {
        // Products and tables that roll over do with 15 deg, and with 60 deg for a trial.
        let product = shape == GridShape::Product;
        let same_count = shape == GridShape::Plane(PlaneGrid::SameCount);
        let turning = same_count || product;
        let (coarse_count, fine) = match (axes.len() > 2, turning) {
            (true, _) => (5, 11),
            (false, false) => (5, 21),
            (false, true) => (7, 25),
        };
        let max_count = libm::floor(libm::pow(rules.max_points as f64, 1.0 / axes.len() as f64) + 1e-9) as usize;
        let max_count = max_count.min(if coarse { coarse_count } else { fine });
        let few = TableRules { max_points: max_count.min(rules.max_points_per_axis), ..rules.clone() };
        let ranges: Vec<Interval> = axes.iter().map(|axis| interval(self.machine, *axis, rules)).collect();
        let step = ranges.iter().map(|range| range.span() / (few.max_points - 1) as f64).fold(0.0, f64::max);
        let nodes = axes.iter().zip(ranges).map(|(axis, range)| {
            let kind = self.machine.axes()[*axis].kind;
            if same_count {
                let turns = self.machine.is_continuous(*axis);
                return rules.increment.distinct(rolling(range, few.max_points - 1, turns, rules, kind), kind);
            }
            let min_step = rules.increment.min_position(kind);
            let intervals = match (product && !coarse, kind) {
                (true, AxisKind::Linear) => PRODUCT_INTERVALS,
                (true, AxisKind::Rotary) => libm::ceil(range.span() / PRODUCT_ANGLE - 1e-9).max(2.0) as usize,
                (false, _) => usize::MAX,
            };
            let intervals = intervals.min(few.max_points - 1) as f64;
            let step = if shape == GridShape::Plane(PlaneGrid::SameStep) { step } else { range.span() / intervals };
            let step = min_step * libm::ceil(step / min_step - 1e-6);
            let count = (libm::ceil(range.span() / step - 1e-9).max(1.0) as usize + 1).min(few.max_points);
            let start = rules.increment.position(range.min, kind);
            rules.increment.distinct((0..count).map(|i| start + i as f64 * step), kind)
        });
        CorrectionTable {
            axes: axes.to_vec(),
            nodes: nodes.collect(),
            corrected,
            values: Vec::new(),
            reverse: None,
            factors: Vec::new(),
        }
    }

    /// A lattice over the axes that the rules name.
    fn fixed_lattice(&self, rules: &LatticeRules) -> Option<CorrectionTable> {
        let axes: Option<Vec<usize>> = rules.inputs.iter().map(|name| self.machine.axis_index(name)).collect();
        let named: Vec<usize> = rules.outputs.iter().filter_map(|name| self.machine.axis_index(name)).collect();
        let all = if rules.outputs.is_empty() { (0..self.machine.axes().len()).collect() } else { named };
        let linear = |axis: &usize| self.machine.axes()[*axis].kind == AxisKind::Linear;
        let corrected: Vec<usize> = all.into_iter().filter(linear).collect();
        Some(self.grid(&axes?, corrected, &rules.table, GridShape::Lattice, false))
            .filter(|table| !table.corrected.is_empty())
    }
}

impl Mechanisms {
    /// Returns the axes whose scale would be corrected if the value in force were known, with the correction in mm over
    /// their travel.
    pub fn unknown_scales(&self, machine: &Machine) -> Vec<(usize, f64)> {
        let Some(own) = self.own_axis.as_ref().filter(|own| own.scale.is_some()) else { return Vec::new() };
        let unknown = |axis: &usize| self.scale_in_force(machine, *axis).is_none();
        let axes: Vec<usize> = (0..machine.axes().len()).filter(unknown).collect();
        let in_force = axes.iter().map(|axis| (machine.axes()[*axis].name.to_string(), 1.0)).collect();
        let trial = Self { own_axis: Some(OwnAxisRules { in_force, ..own.clone() }), ..Self::default() };
        let lines = Planner { machine, mechanisms: &trial }.tables().tables;
        let over = |table: &CorrectionTable| {
            let (min, max) = machine.axes()[table.axes[0]].travel.interval();
            (table.axes[0], table.slope_of_line() * (max - min))
        };
        lines.iter().map(over).collect()
    }
}

/// Intervals of a factor over a linear axis: it is an angle or a lever arm, smoother than tables over one axis.
const PRODUCT_INTERVALS: usize = 12;

/// Step of a factor over a rotary axis, deg: the straight line leaves a hundredth of a sine.
const PRODUCT_ANGLE: f64 = 15.0;

/// Mean square of a table's values about their mean.
fn strength(table: &CorrectionTable) -> f64 {
    let count = table.values.len().max(1) as f64;
    let mean = table.values.iter().sum::<f64>() / count;
    table.values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count
}

/// Returns what a machine lacks for a target, in words; none if it lacks nothing.
pub fn lacking(machine: &Machine, mechanisms: &Mechanisms) -> Option<String> {
    let missing = |rules: &LatticeRules| {
        rules.inputs.iter().chain(&rules.outputs).find(|name| machine.axis_index(name).is_none()).cloned()
    };
    if let Some(name) = mechanisms.lattice.as_ref().and_then(missing) {
        return Some(format!("its tables are for the axis `{name}`, which the chain does not have"));
    }
    if mechanisms.error_curves.is_some() {
        let letters = |kind: AxisKind| if kind == AxisKind::Linear { "XYZ" } else { "ABC" };
        let odd =
            machine.axes().iter().find(|a| a.name.as_str().len() > 1 || !letters(a.kind).contains(a.name.as_str()));
        if let Some(axis) = odd {
            return Some(format!(
                "its model knows the linear axes X Y Z and the rotary axes A B C, not `{}`",
                axis.name
            ));
        }
        if let Some(letter) = ["X", "Y", "Z"].into_iter().find(|name| machine.axis_index(name).is_none()) {
            return Some(format!("its model needs the three linear axes X Y Z; the chain has no `{letter}`"));
        }
    }
    let known = machine.errors().any(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_)));
    let scaled = mechanisms.own_axis.as_ref().is_some_and(|own| own.scale.is_some() && own.in_force.is_empty());
    let alone = mechanisms.iter().count() == 1 + usize::from(scaled);
    let lines = mechanisms.cross_axis.as_ref().filter(|rules| !rules.pairs.is_empty() && alone);
    let pair = |[a, b]: &[String; 2]| machine.axis_index(a).is_some() && machine.axis_index(b).is_some();
    match lines {
        Some(rules) if known && !rules.pairs.iter().any(pair) => {
            Some("it corrects the squareness of X, Y and Z, and the chain has no two of them".to_owned())
        }
        _ => None,
    }
}
