//! Builds tables from the fields of a file, as the controller would.

use super::lines::{Fields, TableFields};
use super::products::{TableEntry, multiply};
use super::{Fault, ReadContext, number};
use crate::compensation::{
    AxisErrorCurve, CorrectionTable, CorrectionTables, DriveScale, Encoding, PlaneGrid, TableRules,
};
use crate::controller::emit::{StoredColumn, StoredPosition};
use crate::machine::{AxisKind, Direction, parse_error_name};

/// Tables and error curves of all records. Fields before the first named record hold for all.
pub(super) fn tables(reading: &ReadContext, records: &[TableFields]) -> Result<CorrectionTables, Fault> {
    let named = records.iter().any(|record| !record.name.is_empty());
    let common = records.iter().find(|record| named && record.name.is_empty());
    let mut all = CorrectionTables::default();
    let mut read: Vec<TableEntry> = Vec::new();
    for record in records.iter().filter(|record| !named || !record.name.is_empty()) {
        let assembly = Assembly { reading, record, common: common.map(|c| &c.fields) };
        if record.archive && record.fields.contains_key("ignored") {
            // Another section of an archive.
        } else if let Some(scaled) = assembly.scale()? {
            all.scales.push((scaled.axis, scaled.in_force));
            read.extend(scaled.table.map(|table| TableEntry { table, times: 0, record }));
        } else if assembly.number("slope")? == Some(0.0) {
            // A line without a slope adds nothing, whether the machine has its axes or not.
        } else if reading.target.manifest.mechanism.error_curves.is_some() {
            all.errors.push(assembly.error()?);
        } else if assembly.field("reversal").is_some() {
            read.extend(assembly.reversal()?.map(|table| TableEntry { table, times: 0, record }));
        } else {
            let times = assembly.whole("times")?.unwrap_or(0);
            read.push(TableEntry { table: assembly.table()?, times, record });
        }
    }
    all.tables = multiply(reading, read)?;
    Ok(all)
}

/// The scale of a drive that a file sets.
struct DriveLine {
    axis: usize,
    /// The number in force before.
    in_force: f64,
    /// The change; none of a control's own archive.
    table: Option<CorrectionTable>,
}

/// Endings of the names of fields, dimension by dimension.
const SUFFIXES: [&str; 3] = ["", "_2", "_3"];

/// A record that becomes a table.
pub(super) struct Assembly<'a> {
    pub reading: &'a ReadContext<'a>,
    pub record: &'a TableFields,
    pub common: Option<&'a Fields>,
}

impl Assembly<'_> {
    pub fn field(&self, name: &str) -> Option<&(String, usize)> {
        self.record.fields.get(name).or_else(|| self.common?.get(name))
    }

    pub fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::new(self.record.line, message)
    }

    /// Returns a number of the record; none if it has no such field.
    pub fn number(&self, name: &str) -> Result<Option<f64>, Fault> {
        let Some((text, line)) = self.field(name) else { return Ok(None) };
        number(text).map(Some).map_err(|message| Fault::new(*line, message))
    }

    pub fn need_number(&self, name: &str) -> Result<f64, Fault> {
        self.number(name)?.ok_or_else(|| self.fault(format!("there is no `{name}` for this table")))
    }

    /// Returns a whole number of the record; none if it has no such field.
    pub fn whole(&self, name: &str) -> Result<Option<usize>, Fault> {
        let Some(value) = self.number(name)? else { return Ok(None) };
        let (_, line) = self.field(name).map_or((String::new(), 0), Clone::clone);
        if (0.0..1e7).contains(&value) && libm::trunc(value) == value {
            Ok(Some(value as usize))
        } else {
            Err(Fault::new(line, format!("`{name}` is no whole number of points")))
        }
    }

    fn axes(&self, role: &str) -> Result<Vec<usize>, Fault> {
        let mut axes = Vec::new();
        for suffix in SUFFIXES {
            let letter = self.field(&format!("{role}{suffix}"));
            let by_number = self.field(&format!("{role}{suffix}_number"));
            let (axis, line, word) = match (letter, by_number) {
                (Some((word, line)), _) if word == "self" => (self.own()?, *line, word),
                (Some((word, line)), _) => (self.reading.by_letter(word), *line, word),
                (None, Some((word, line))) => (self.reading.by_number(word), *line, word),
                (None, None) => break,
            };
            let axis = axis.ok_or_else(|| Fault::new(line, format!("the machine has no axis `{word}`")))?;
            if axes.contains(&axis) {
                return Err(Fault::new(line, format!("the axis `{word}` is there twice")));
            }
            axes.push(axis);
        }
        if axes.is_empty() { Err(self.fault(format!("there is no {role} axis for this table"))) } else { Ok(axes) }
    }

    /// Returns the axis to which the file belongs, by its content or by its name.
    pub fn own(&self) -> Result<Option<usize>, Fault> {
        let said = self.field("axis_number").map(|(word, line)| (self.reading.by_number(word), word, *line));
        match (said, self.reading.axis) {
            (Some((Some(said), word, line)), Some(named)) if said != named => {
                Err(Fault::new(line, format!("the axis number {word} is not that of the axis in the file's name")))
            }
            (Some((said, ..)), named) => Ok(said.or(named)),
            (None, named) => Ok(named),
        }
    }

    fn table(&self) -> Result<CorrectionTable, Fault> {
        let (axes, corrected) = (self.axes("input")?, self.axes("output")?);
        let mut table = CorrectionTable {
            axes,
            nodes: Vec::new(),
            corrected,
            values: Vec::new(),
            reverse: None,
            factors: Vec::new(),
        };
        let rules = self.reading.target.manifest.mechanism.rules(&table);
        let rules = rules.ok_or_else(|| self.fault("the controller has no table of this kind"))?;
        if let Some((_, line)) = self.field("slope") {
            return self.line(table, rules, *line);
        }
        if rules.encoding == Encoding::Difference {
            return self.incremental(table, rules);
        }
        if self.field("length").is_some() {
            return self.unroll(table, rules);
        }
        for (place, suffix) in SUFFIXES.iter().enumerate().take(table.axes.len()) {
            let nodes = self.nodes(&table, place, suffix, rules)?;
            table.nodes.push(nodes);
        }
        self.check(&table, rules)?;
        self.values(&mut table, rules)?;
        self.check_direction(&mut table)?;
        self.check_ends(&table)?;
        Ok(table)
    }

    /// A line through position 0.
    fn line(&self, mut table: CorrectionTable, rules: &TableRules, line: usize) -> Result<CorrectionTable, Fault> {
        let kind = self.kind(table.corrected[0]);
        let slope = self.need_number("slope")? * 1000.0 / self.number("over")?.unwrap_or(1000.0);
        if rules.largest.is_some_and(|max| slope.abs() > max) {
            return Err(Fault::new(line, "the controller would refuse this factor"));
        }
        let far = StoredColumn::new(rules, kind).correction(slope, None);
        table.nodes = vec![vec![0.0, 1000.0]];
        table.values = vec![0.0, far];
        Ok(table)
    }

    /// Reads the scale of a drive: the line of an axis over itself, against the number before it.
    /// In the control's own archive the number is the one in force.
    fn scale(&self) -> Result<Option<DriveLine>, Fault> {
        let number = |name: &str| {
            let Some(value) = self.number(name)? else { return Ok(None) };
            let [least, most] = DriveScale::RANGE;
            let line = self.field(name).map_or(0, |(_, line)| *line);
            let sound = (least..=most).contains(&value);
            sound.then_some(Some(value)).ok_or_else(|| Fault::new(line, format!("`{value}` is no scale of a drive")))
        };
        let mechanisms = &self.reading.target.manifest.mechanism;
        let (now, before) = (number("scale")?, number("scale_before")?);
        let Some((own, scale)) = mechanisms.own_axis.as_ref().zip(mechanisms.scale()) else { return Ok(None) };
        if (now, before) == (None, None) {
            return Ok(None);
        }
        let axis = self.axes("input")?[0];
        match (now, before) {
            (Some(in_force), None) if self.record.archive => Ok(Some(DriveLine { axis, in_force, table: None })),
            (Some(now), Some(in_force)) => {
                let mut table = CorrectionTable::curve(axis, vec![0.0, 1000.0], axis, Vec::new());
                table.set_slope_of_line(scale.slope(in_force, now));
                self.check(&table, &own.table)?;
                Ok(Some(DriveLine { axis, in_force, table: Some(table) }))
            }
            (Some(_), None) => Err(self.fault(
                "the number before this one is not there, in the comment that would take it back: nothing says what \
                 the line changes",
            )),
            _ => Err(self.fault("the number that takes this one's place is not there")),
        }
    }

    pub fn kind(&self, axis: usize) -> AxisKind {
        self.reading.machine.axes()[axis].kind
    }

    /// Nodes of one dimension: as listed, or from a start and a step.
    fn nodes(
        &self,
        table: &CorrectionTable,
        place: usize,
        suffix: &str,
        rules: &TableRules,
    ) -> Result<Vec<f64>, Fault> {
        let place_of = StoredPosition { rules, kind: self.kind(table.axes[place]) };
        let key = format!("position{suffix}");
        if self.record.points.values().any(|fields| fields.contains_key(&key)) {
            let listed = self.record.points.iter().map(|(index, fields)| {
                let (text, line) =
                    fields.get(&key).ok_or_else(|| self.fault(format!("point {} has no position", index[0])))?;
                number(text).map(|q| place_of.position(q)).map_err(|message| Fault::new(*line, message))
            });
            return listed.collect();
        }
        let min = self.need_number(&format!("min{suffix}"))?;
        let mechanisms = &self.reading.target.manifest.mechanism;
        let same_step = mechanisms.name_of(table) == Some("plane")
            && mechanisms.plane.as_ref().is_some_and(|plane| plane.grid == PlaneGrid::SameStep);
        let step = if same_step { self.need_number("step")? } else { self.need_number(&format!("step{suffix}"))? };
        let count = self.count(place, suffix)?;
        let nodes: Vec<f64> = (0..count).map(|i| place_of.position(min + i as f64 * step)).collect();
        if let (Some(max), Some(last)) = (self.number(&format!("max{suffix}"))?, nodes.last()) {
            let line = self.field(&format!("max{suffix}")).map_or(0, |(_, line)| *line);
            if (place_of.position(max) - last).abs() > 0.5 * rules.increment.min_position(place_of.kind) {
                return Err(Fault::new(
                    line,
                    format!("the last point is at {last}, not at {max}: values and step do not fit together"),
                ));
            }
        }
        Ok(nodes)
    }

    /// Returns the number of nodes of a dimension.
    fn count(&self, place: usize, suffix: &str) -> Result<usize, Fault> {
        let said = match (self.whole(&format!("count{suffix}"))?, self.whole(&format!("last{suffix}"))?) {
            (Some(count), _) => Some(count),
            (None, Some(last)) => Some(last + 1),
            (None, None) => None,
        };
        let found = match (place, self.record.rows.first()) {
            (0, Some((row, _))) => row.len(),
            (1, Some(_)) => self.record.rows.len(),
            _ => self.record.points.keys().map(|index| index[place] + 1).max().unwrap_or(0),
        };
        match said {
            Some(count) if found > count => Err(self.fault(format!("{found} points, and the file states {count}"))),
            Some(count) => Ok(count),
            None => Ok(found),
        }
    }

    /// Rising nodes, no more than the controller takes.
    pub fn check(&self, table: &CorrectionTable, rules: &TableRules) -> Result<(), Fault> {
        if table.nodes.iter().any(|nodes| nodes.is_empty()) {
            return Err(self.fault("the table is empty"));
        }
        if table.nodes.iter().any(|nodes| nodes.windows(2).any(|w| w[1] <= w[0])) {
            return Err(self.fault("the positions do not rise"));
        }
        let points = table.nodes.iter().fold(1, |product: usize, nodes| product.saturating_mul(nodes.len()));
        if points > rules.max_points || table.nodes.iter().any(|nodes| nodes.len() > rules.max_points_per_axis) {
            let max = rules.max_points.min(rules.max_points_per_axis);
            return Err(self.fault(format!("{points} points are more than the controller has room for ({max})")));
        }
        Ok(())
    }

    fn values(&self, table: &mut CorrectionTable, rules: &TableRules) -> Result<(), Fault> {
        if !self.record.rows.is_empty() {
            return self.rows(table, rules);
        }
        let outputs = table.corrected.len();
        let (mut values, mut reverse) = (Vec::new(), Vec::new());
        let bidirectional = self.record.points.values().any(|fields| fields.contains_key("reverse"));
        for node in 0..table.len() {
            let index = index_of(table, node);
            let listed = self.record.points.get(&index);
            let fields = listed.ok_or_else(|| {
                self.fault(format!(
                    "point {} is missing: the controller would keep what it had there",
                    index_text(&index, table.axes.len())
                ))
            })?;
            for output in 0..outputs {
                let named = bidirectional || fields.contains_key("forward");
                let key = if named { "forward".to_owned() } else { format!("value{}", SUFFIXES[output.min(2)]) };
                values.push(self.value(table, rules, fields, node, output, &key)?);
            }
            if bidirectional {
                reverse.push(self.value(table, rules, fields, node, 0, "reverse")?);
            }
        }
        table.values = values;
        table.reverse = bidirectional.then_some(reverse);
        Ok(())
    }

    fn value(
        &self,
        table: &CorrectionTable,
        rules: &TableRules,
        fields: &Fields,
        node: usize,
        output: usize,
        key: &str,
    ) -> Result<f64, Fault> {
        let missing = || self.fault(format!("point {node} has no {key}"));
        let (text, line) = fields.get(key).ok_or_else(missing)?;
        let stored = number(text).map_err(|message| Fault::new(*line, message))?;
        self.correction(table, rules, node, output, stored, *line)
    }

    fn correction(
        &self,
        table: &CorrectionTable,
        rules: &TableRules,
        node: usize,
        output: usize,
        stored: f64,
        line: usize,
    ) -> Result<f64, Fault> {
        if rules.largest.is_some_and(|max| stored.abs() > max) {
            return Err(Fault::new(line, format!("`{stored}` is beyond what the controller stores")));
        }
        let axis = table.corrected[output];
        let own = table.axes.iter().position(|a| *a == axis).map(|place| table.node(node)[place]);
        let times = self.magnification(rules)?;
        Ok(StoredColumn { times, ..StoredColumn::new(rules, self.kind(axis)) }.correction(stored, own))
    }

    /// Factor by which the controller multiplies the numbers of a lattice.
    fn magnification(&self, rules: &TableRules) -> Result<f64, Fault> {
        let times = self.whole("magnification")?.unwrap_or(1);
        let max = match rules.encoding {
            Encoding::Magnified(max) => usize::try_from(max).unwrap_or(usize::MAX),
            Encoding::Plain | Encoding::Difference => 1,
        };
        if (1..=max).contains(&times) {
            Ok(times as f64)
        } else {
            let line = self.field("magnification").map_or(0, |(_, line)| *line);
            Err(Fault::new(line, format!("the magnification is a whole number from 1 to {max}")))
        }
    }

    /// A line of numbers for each node of the second axis.
    fn rows(&self, table: &mut CorrectionTable, rules: &TableRules) -> Result<(), Fault> {
        let (width, height) = (table.nodes[0].len(), table.nodes.get(1).map_or(1, Vec::len));
        if self.record.rows.len() != height {
            return Err(self.fault(format!("{} lines of numbers instead of {height}", self.record.rows.len())));
        }
        let mut values = vec![0.0; table.len()];
        for (j, (row, line)) in self.record.rows.iter().enumerate() {
            if row.len() != width {
                return Err(Fault::new(*line, format!("{} numbers instead of {width}", row.len())));
            }
            for (i, stored) in row.iter().enumerate() {
                let node = i * height + j;
                values[node] = self.correction(table, rules, node, 0, *stored, *line)?;
            }
        }
        table.values = values;
        Ok(())
    }

    /// A table for one direction of approach adds nothing in the other.
    fn check_direction(&self, table: &mut CorrectionTable) -> Result<(), Fault> {
        let count = table.values.len();
        let none = || vec![0.0; count];
        let Some((word, line)) = self.field("direction") else { return Ok(()) };
        let reverse = match &**word {
            "0" => return Ok(()),
            "1" => none(),
            "-1" => std::mem::replace(&mut table.values, none()),
            _ => return Err(Fault::new(*line, "the direction is 0, 1 or -1")),
        };
        if table.reverse.replace(reverse).is_some() {
            return Err(Fault::new(*line, "a table with both directions has no direction of its own"));
        }
        Ok(())
    }

    /// The ends of a table that repeats itself agree.
    fn check_ends(&self, table: &CorrectionTable) -> Result<(), Fault> {
        let Some((word, line)) = self.field("modulo") else { return Ok(()) };
        let differ = std::iter::once(&table.values).chain(&table.reverse).any(|v| v.first() != v.last());
        match &**word {
            "0" => Ok(()),
            "1" if differ => {
                Err(Fault::new(*line, "the first and the last value differ: the controller would jump there"))
            }
            "1" => Ok(()),
            _ => Err(Fault::new(*line, "a table repeats itself (1) or does not (0)")),
        }
    }

    /// A curve or constant of an error by its ISO name.
    fn error(&self) -> Result<AxisErrorCurve, Fault> {
        let unknown = || self.fault(format!("`{}` is no error of this machine's axes", self.record.name));
        let error = parse_error_name(&self.record.name).ok_or_else(unknown)?;
        let axis = self.reading.machine.axis_index(error.axis.as_str()).ok_or_else(unknown)?;
        let rules = self.reading.target.manifest.mechanism.error_curves.as_ref().ok_or_else(unknown)?;
        if error.is_location() {
            let value = error_value(rules, error.direction, self.need_number("constant")?);
            return Ok(AxisErrorCurve { error, positions: Vec::new(), values: vec![value] });
        }
        let place = StoredPosition { rules, kind: self.kind(axis) };
        let mut curve = AxisErrorCurve { error, positions: Vec::new(), values: Vec::new() };
        for fields in self.record.points.values() {
            let part = |key: &str| {
                let (text, line) = fields.get(key).ok_or_else(|| self.fault("a point without position or value"))?;
                Ok((number(text).map_err(|message| Fault::new(*line, message))?, *line))
            };
            let ((position, line), (value, _)) = (part("position")?, part("value")?);
            let position = place.position(position);
            if curve.positions.last().is_some_and(|last| position <= *last) {
                return Err(Fault::new(line, "the positions do not rise"));
            }
            curve.positions.push(position);
            curve.values.push(error_value(rules, curve.error.direction, value));
        }
        if curve.positions.is_empty() || curve.positions.len() > rules.max_points {
            return Err(self.fault(format!("{} points: from 1 to {}", curve.positions.len(), rules.max_points)));
        }
        Ok(curve)
    }
}

/// An error (mm or rad) from a stored number.
pub(super) fn error_value(rules: &TableRules, direction: Direction, stored: f64) -> f64 {
    let kind = if direction.is_rotation() { AxisKind::Rotary } else { AxisKind::Linear };
    rules.increment.error(stored / rules.increment.correction_scale.of(kind), direction)
}

/// The index of a node, dimension by dimension.
fn index_of(table: &CorrectionTable, mut number: usize) -> [usize; 3] {
    let mut index = [0; 3];
    for (place, nodes) in table.nodes.iter().enumerate().rev() {
        index[place.min(2)] = number % nodes.len();
        number /= nodes.len();
    }
    index
}

fn index_text(index: &[usize; 3], places: usize) -> String {
    index[..places.min(3)].iter().map(usize::to_string).collect::<Vec<_>>().join(",")
}
