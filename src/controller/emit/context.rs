//! The variables of templates for a set of tables: everything rounded and as text.

use super::number::{decimal_text, push_decimal};
use super::stored::{StoredColumn, StoredPosition, differences};
use crate::compensation::{
    AxisErrorCurve, CorrectionTable, CorrectionTables, Directions, Encoding, Spacing, TABLES_OF_A_PRODUCT, TableRules,
};
use crate::controller::manifest::{AssignedAxis, ControllerTarget, FileLayout, OutsideTable};
use crate::machine::{AxisKind, Branch, ErrorId, Location, Machine, Tool};
use minijinja::{Value, context};
use std::sync::Arc;

/// Returns the direction from the gauge point to the tip; against its axis for a tool without length.
pub(in crate::controller) fn tool_direction(tool: &Tool) -> [f64; 3] {
    let way: [f64; 3] = std::array::from_fn(|i| tool.tip[i] - tool.gauge[i]);
    let length = libm::sqrt(way.iter().map(|x| x * x).sum());
    if length > 0.0 { way.map(|x| x / length) } else { tool.direction.map(|x| 0.0 - x) }
}

/// The axes, tables and numbers of a set in the controller's words.
#[derive(Clone, Copy)]
pub(crate) struct TableWords<'a> {
    pub target: &'a ControllerTarget,
    pub machine: &'a Machine,
    pub tables: &'a Arc<CorrectionTables>,
    /// The axes in the controller's order.
    pub letters: &'a [AssignedAxis],
}

/// A table with its directions in the controller, and their numbers.
struct DirectedTable {
    /// 0 for both directions at once, else 1 and -1.
    direction: i32,
    number: usize,
}

impl TableWords<'_> {
    fn kind(&self, axis: usize) -> AxisKind {
        self.machine.axes()[axis].kind
    }

    fn axis_assignment(&self, axis: usize) -> Option<&AssignedAxis> {
        self.letters.iter().find(|known| known.axis == axis)
    }

    /// Number of an axis from 1.
    fn number(&self, axis: usize) -> usize {
        self.axis_assignment(axis).map_or(axis + 1, |known| known.number)
    }

    fn letter(&self, axis: usize) -> &str {
        self.axis_assignment(axis).map_or("", |known| &known.letter)
    }

    fn rules(&self, table: &CorrectionTable) -> Option<&TableRules> {
        self.target.manifest.mechanism.rules(table)
    }

    /// True if a table belongs to a mechanism, or none is named.
    pub fn is_of(&self, table: &CorrectionTable, mechanism: Option<&str>) -> bool {
        mechanism.is_none_or(|name| self.target.manifest.mechanism.name_of(table) == Some(name))
    }

    /// True if there is a table of a mechanism.
    pub fn any(&self, mechanism: &str) -> bool {
        self.tables.tables.iter().any(|table| self.is_of(table, Some(mechanism)))
    }

    /// Points of the table in which an axis corrects itself.
    pub fn own_points(&self, axis: usize) -> Value {
        let own = self.tables.tables.iter().find(|table| table.is_own_axis() && table.axes[0] == axis);
        let points = own.and_then(|table| Some(self.points(table, self.rules(table)?, 0)));
        points.unwrap_or_else(|| Value::from(Vec::<Value>::new()))
    }

    /// The chain as ISG and others write it: axes from workpiece to tool, and how many carry the workpiece;
    /// geometry for controllers with the model (mm).
    pub fn chain(&self) -> Value {
        let axes = self.machine.axes();
        let number = |x: f64| decimal_text(x, 6);
        let rotary = axes.iter().enumerate().filter(|(_, a)| a.kind == AxisKind::Rotary);
        let lines: Vec<Value> = rotary
            .map(|(i, a)| {
                let (origin, direction) = (a.origin.map(number), a.direction.map(number));
                context! { name => a.name.as_str(), origin, direction, number => self.number(i) }
            })
            .collect();
        let tool = self.machine.tool();
        context! {
            letters => axes.iter().map(|a| a.name.as_str()).collect::<String>(),
            workpiece_axes => axes.iter().filter(|a| a.branch == Branch::Workpiece).count(),
            axis_only => self.machine.conventions().location == Location::AxisOnly,
            rotary => lines,
            tip => tool.tip.map(number), gauge => tool.gauge.map(number),
            tool_direction => tool_direction(tool).map(number),
        }
    }

    /// Tables that `keep` accepts, numbered among all.
    pub fn tables(&self, keep: impl Fn(&CorrectionTable) -> bool) -> Value {
        let mut number = 0;
        let mut seen = Vec::new();
        for table in &self.tables.tables {
            let apart = self.rules(table).is_some_and(|rules| rules.directions == Directions::TwoTables);
            let directed = direction_entries(table, number, apart);
            // Two directions have two numbers even where they hold the same.
            number += if apart && table.factors.is_empty() { directed.len() } else { table.count(apart) };
            if keep(table)
                && let Some(rules) = self.rules(table)
            {
                seen.push(self.table(table, rules, &directed));
            }
        }
        seen.into()
    }

    fn table(&self, table: &CorrectionTable, rules: &TableRules, tables: &[DirectedTable]) -> Value {
        let (input, output) = (table.axes[0], table.corrected[0]);
        let kind = match (table.axes.len(), table.is_own_axis()) {
            (1, true) => "own",
            (1, false) => "cross",
            _ if !table.factors.is_empty() => "product",
            (2, _) if table.corrected.len() == 1 => "plane",
            _ => "lattice",
        };
        let inputs: Vec<Value> = (0..table.axes.len()).map(|i| self.input(table, rules, i)).collect();
        let first = inputs[0].clone();
        let outputs: Vec<Value> = table.corrected.iter().map(|axis| self.axis(*axis)).collect();
        let points = if table.axes.len() == 1 { self.points(table, rules, 0) } else { Value::UNDEFINED };
        let directed: Vec<Value> = tables
            .iter()
            .map(|one| {
                let points = self.points(table, rules, one.direction);
                context! { direction => one.direction, number => one.number, points }
            })
            .collect();
        context! {
            kind, inputs, outputs, points, ways => directed,
            number => tables[0].number,
            bidirectional => table.reverse.is_some(),
            input => self.letter(input), output => self.letter(output),
            input_number => self.number(input), output_number => self.number(output),
            cells => if table.axes.len() > 1 { self.cells(table, rules) } else { Value::UNDEFINED },
            rows => if table.axes.len() == 2 { self.matrix(table, rules) } else { Value::UNDEFINED },
            slope => self.slope(table, rules),
            scale => self.scale(table).map(|[now, _]| now),
            scale_before => self.scale(table).map(|[_, before]| before),
            magnification => decimal_text(rules.magnification_of(self.machine, table), 0),
            rolled => if self.rolls(rules) { self.roll(table, rules) } else { Value::UNDEFINED },
            factors => self.factors(table, rules, tables[0].number),
            ..first
        }
    }

    fn axis(&self, axis: usize) -> Value {
        let this = &self.machine.axes()[axis];
        let number = self.number(axis);
        context! { letter => self.letter(axis), name => this.name.as_str(), joint => number - 1, number,
        unit => this.unit() }
    }

    fn input(&self, table: &CorrectionTable, rules: &TableRules, i: usize) -> Value {
        let (axis, nodes) = (table.axes[i], &table.nodes[i]);
        let place = StoredPosition { rules, kind: self.kind(axis) };
        let text = |q: f64| decimal_text(place.stored(q), place.decimals());
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        let step = if nodes.len() > 1 { nodes[1] - nodes[0] } else { 0.0 };
        let zero = nodes.iter().enumerate().min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(i, _)| i);
        context! {
            count => nodes.len(), last => nodes.len() - 1, intervals => nodes.len() - 1,
            min => text(first), max => text(last), step => text(step), length => text(last - first),
            modulo => i32::from(rules.modulo && self.machine.is_continuous(axis)),
            zero,
            ..self.axis(axis)
        }
    }

    /// Points of a table over one axis; with a direction, only its values.
    fn points(&self, table: &CorrectionTable, rules: &TableRules, direction: i32) -> Value {
        let column = StoredColumn::new(rules, self.kind(table.corrected[0]));
        let place = StoredPosition { rules, kind: self.kind(table.axes[0]) };
        let own = |i: usize| table.is_own_axis().then(|| table.nodes[0][i]);
        let reverse = table.reverse.as_ref().unwrap_or(&table.values);
        let stored = |values: &[f64]| -> Vec<f64> {
            values.iter().enumerate().map(|(i, c)| column.to_stored(*c, own(i))).collect()
        };
        let (forward, reverse) = (stored(&table.values), stored(reverse));
        let told = if direction < 0 { &reverse } else { &forward };
        let steps =
            if rules.encoding == Encoding::Difference { [vec![0.0], differences(told)].concat() } else { Vec::new() };
        let number = |x: f64| decimal_text(x, column.decimals());
        let point = |i: usize| {
            context! {
                index => i,
                position => decimal_text(place.stored(table.nodes[0][i]), place.decimals()),
                value => number(told[i]),
                forward => number(forward[i]), reverse => number(reverse[i]),
                reversal => number(reverse[i] - forward[i]),
                step => steps.get(i).map(|x| number(*x)),
            }
        };
        (0..table.nodes[0].len()).map(point).collect()
    }

    fn value(&self, table: &CorrectionTable, rules: &TableRules, node: usize, column: usize, times: f64) -> String {
        let axis = table.corrected[column];
        let own = table.axes.iter().position(|a| *a == axis).map(|i| table.node(node)[i]);
        let cell = StoredColumn { times, ..StoredColumn::new(rules, self.kind(axis)) };
        decimal_text(cell.to_stored(table.values[node * table.corrected.len() + column], own), cell.decimals())
    }

    /// Nodes of a table over several axes, the last axis fastest.
    fn cells(&self, table: &CorrectionTable, rules: &TableRules) -> Value {
        let index = |mut number: usize| {
            let mut index = vec![0; table.nodes.len()];
            for (slot, nodes) in index.iter_mut().zip(&table.nodes).rev() {
                *slot = number % nodes.len();
                number /= nodes.len();
            }
            index
        };
        let times = rules.magnification_of(self.machine, table);
        let cell = |node: usize| {
            let place = |(axis, q): (&usize, f64)| {
                let place = StoredPosition { rules, kind: self.kind(*axis) };
                decimal_text(place.stored(q), place.decimals())
            };
            let positions: Vec<String> = table.axes.iter().zip(table.node(node)).map(place).collect();
            let values: Vec<String> =
                (0..table.corrected.len()).map(|c| self.value(table, rules, node, c, times)).collect();
            context! { number => node, index => index(node), positions, values }
        };
        (0..table.len()).map(cell).collect()
    }

    /// A table over two axes: a row for every node of the second.
    fn matrix(&self, table: &CorrectionTable, rules: &TableRules) -> Value {
        let (width, rows) = (table.nodes[0].len(), table.nodes[1].len());
        let times = rules.magnification_of(self.machine, table);
        let row = |j: usize| (0..width).map(|i| self.value(table, rules, i * rows + j, 0, times)).collect::<Vec<_>>();
        (0..rows).map(|j| Value::from(row(j))).collect()
    }

    /// The factors of products, with numbers from one on and the number (from 1) of the table by which each is
    /// multiplied, 0 for none: f times g, then -f times -g. The sense of the stored number goes with the first.
    fn factors(&self, table: &CorrectionTable, rules: &TableRules, number: usize) -> Value {
        let column = StoredColumn::new(rules, self.kind(table.corrected[0]));
        let factor = |k: usize, place: usize, sign: f64| {
            let number = number + TABLES_OF_A_PRODUCT * k + place + if sign < 0.0 { 2 } else { 0 };
            let stored = |c: f64| sign * if place == 0 { column.to_stored(c, None) } else { column.weight(c) };
            let point = |(index, c): (usize, &f64)| {
                context! { index, value => decimal_text(stored(*c), column.decimals()) }
            };
            let points: Vec<Value> = table.factors[k][place].iter().enumerate().map(point).collect();
            let times = if place == 0 { number + 2 } else { 0 };
            let input = table.axes[place];
            context! {
                number, times, points,
                input => self.letter(input), input_number => self.number(input),
                output => self.letter(table.corrected[0]), output_number => self.number(table.corrected[0]),
                ..self.input(table, rules, place)
            }
        };
        let product = |k: usize| [(0, 1.0), (1, 1.0), (0, -1.0), (1, -1.0)].map(|(place, sign)| factor(k, place, sign));
        (0..table.factors.len()).flat_map(product).collect()
    }

    fn rolls(&self, rules: &TableRules) -> bool {
        rules.spacing == Spacing::Anchored || self.target.manifest.controller.outside == OutsideTable::RollOver
    }

    /// Values from position 0 on, those of negative positions after the last, and again that of 0; of a plane line by
    /// line. The entries begin one step behind 0, so that the first value is omitted. A table over whole turns does
    /// without its last node.
    fn roll(&self, table: &CorrectionTable, rules: &TableRules) -> Value {
        let column = StoredColumn::new(rules, self.kind(table.corrected[0]));
        let number = |x: f64| decimal_text(x, column.decimals());
        let around: Vec<Vec<usize>> = (0..table.axes.len()).map(|place| self.around(table, place)).collect();
        let node = |indices: &[usize]| indices.iter().zip(&table.nodes).fold(0, |n, (i, nodes)| n * nodes.len() + i);
        let order: Vec<usize> = match &around[..] {
            [line] => line.clone(),
            [line, rows, ..] => {
                rows.iter().flat_map(|j| line.iter().map(|i| node(&[*i, *j])).collect::<Vec<_>>()).collect()
            }
            [] => Vec::new(),
        };
        let stored = |node: usize| column.to_stored(table.values[node], None);
        let entries: Vec<String> = order.iter().skip(1).map(|node| number(stored(*node))).collect();
        let lengths: Vec<String> = (0..table.axes.len())
            .map(|place| {
                let cell = StoredPosition { rules, kind: self.kind(table.axes[place]) };
                let step = cell.stored(table.nodes[place][1] - table.nodes[place][0]);
                decimal_text(step * (around[place].len() - 1) as f64, cell.decimals())
            })
            .collect();
        // Correction removed when approaching in reverse: a constant at 0, and the difference from it elsewhere.
        let lost = |node: usize| {
            table.reverse.as_ref().map_or(0.0, |reverse| stored(node) - column.to_stored(reverse[node], None))
        };
        let constant = order.first().map_or(0.0, |node| lost(*node));
        let lost_entries: Vec<String> = order.iter().skip(1).map(|node| number(lost(*node) - constant)).collect();
        context! {
            count => around[0].len() - 1, count_2 => around.get(1).map(|rows| rows.len() - 1),
            length => lengths[0].clone(), length_2 => lengths.get(1),
            entries, lost => number(constant), lost_entries,
        }
    }

    /// Indices of the nodes over one axis in the order of a table that rolls over, from position 0 to it again.
    fn around(&self, table: &CorrectionTable, place: usize) -> Vec<usize> {
        let nodes = &table.nodes[place];
        let count = nodes.len() - usize::from(self.machine.is_continuous(table.axes[place]));
        let zero = nodes.iter().position(|q| *q >= 0.0).unwrap_or(0);
        (zero..count).chain(0..=zero).collect()
    }

    /// The value of a line through position 0 at its far node.
    fn slope(&self, table: &CorrectionTable, rules: &TableRules) -> Option<String> {
        let column = StoredColumn::new(rules, self.kind(table.corrected[0]));
        let last = *table.values.last()?;
        (rules.spacing == Spacing::Line).then(|| decimal_text(column.to_stored(last, None), column.decimals()))
    }

    /// The scale of a drive, and the one in force before.
    fn scale(&self, table: &CorrectionTable) -> Option<[String; 2]> {
        let own = self.target.manifest.mechanism.own_axis.as_ref()?;
        let (_, in_force) = self.tables.scales.iter().find(|(axis, _)| table.axes[0] == *axis)?;
        let now = own.scale.filter(|_| table.is_own_axis())?.stored(*in_force, table.slope_of_line());
        // The one before as it is known: what takes it back must be what was there.
        Some([decimal_text(now, own.table.increment.correction_decimals), in_force.to_string()])
    }

    /// Curves of errors: the constants, and a block for every axis.
    pub fn errors(&self) -> Value {
        let Some(rules) = &self.target.manifest.mechanism.error_curves else { return Value::UNDEFINED };
        let number = |curve: &AxisErrorCurve, i: usize| {
            let kind = if curve.error.direction.is_rotation() { AxisKind::Rotary } else { AxisKind::Linear };
            let column = StoredColumn::new(rules, kind);
            decimal_text(curve.values[i] * rules.increment.correction_scale.of(kind), column.decimals())
        };
        let all = &self.tables.errors;
        let constants: Vec<Value> = all
            .iter()
            .filter(|c| c.positions.is_empty())
            .map(|c| context! { name => short(&c.error), value => number(c, 0) })
            .collect();
        let block = |axis: usize| {
            let curves: Vec<&AxisErrorCurve> = all
                .iter()
                .filter(|c| !c.positions.is_empty() && c.error.axis == self.machine.axes()[axis].name)
                .collect();
            let place = StoredPosition { rules, kind: self.kind(axis) };
            let row = |i: usize, q: f64| {
                context! {
                    position => decimal_text(place.stored(q), place.decimals()),
                    values => curves.iter().map(|c| number(c, i)).collect::<Vec<_>>(),
                }
            };
            let first = curves.first()?;
            let rows: Vec<Value> = first.positions.iter().enumerate().map(|(i, q)| row(i, *q)).collect();
            let names: Vec<String> = curves.iter().map(|c| c.error.to_string()).collect();
            Some(context! { axis => self.machine.axes()[axis].name.as_str(), names, rows })
        };
        let blocks: Vec<Value> = (0..self.machine.axes().len()).filter_map(block).collect();
        context! { constants, blocks }
    }

    /// The header of a lattice as CSV, and its rows.
    pub fn lattice(&self) -> Option<(Vec<String>, Value)> {
        let table = self.tables.tables.first()?;
        let csv = |layout: &FileLayout| matches!(layout, FileLayout::CsvLattice | FileLayout::JsonLattice);
        if !self.target.manifest.files.iter().filter_map(|f| f.layout.as_ref()).any(csv) {
            return None;
        }
        let column = |prefix: &str, axis: &usize| {
            let axis = &self.machine.axes()[*axis];
            format!("{prefix}{} [{}]", axis.name, axis.unit())
        };
        let positions = table.axes.iter().map(|axis| column("", axis));
        let columns = positions.chain(table.corrected.iter().map(|axis| column("d", axis))).collect();
        Some((columns, self.rows()))
    }

    /// Rows of a lattice, formatted on demand: a lattice is never in memory as text twice.
    fn rows(&self) -> Value {
        let Some(rules) = self.tables.tables.first().and_then(|table| self.rules(table)) else {
            return Value::UNDEFINED;
        };
        let decimals = [rules.increment.position_decimals, rules.increment.correction_decimals];
        Value::make_object_iterable(Arc::clone(self.tables), move |tables| match tables.tables.first() {
            Some(table) => Box::new((0..table.len()).map(move |i| Value::from(row(table, i, decimals)))),
            None => Box::new(std::iter::empty()),
        })
    }
}

/// One entry for both directions, or one for each: with a number of its own if they have separate tables.
fn direction_entries(table: &CorrectionTable, number: usize, apart: bool) -> Vec<DirectedTable> {
    if table.reverse.is_none() {
        return vec![DirectedTable { direction: 0, number }];
    }
    vec![DirectedTable { direction: 1, number }, DirectedTable { direction: -1, number: number + usize::from(apart) }]
}

/// A location error without its first letter: `C0Y`.
fn short(error: &ErrorId) -> String {
    error.to_string().trim_start_matches('E').to_owned()
}

fn row(lattice: &CorrectionTable, number: usize, [position, correction]: [u8; 2]) -> String {
    let width = lattice.corrected.len();
    let mut text = String::with_capacity(128);
    let mut cell = |value: f64, decimals: u8| {
        if !text.is_empty() {
            text.push(',');
        }
        push_decimal(&mut text, value, decimals);
    };
    lattice.node(number).into_iter().for_each(|q| cell(q, position));
    lattice.values[number * width..(number + 1) * width].iter().for_each(|c| cell(*c, correction));
    text
}
