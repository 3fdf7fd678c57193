//! Tables whose points are numbered through: increments from a reference point on, and tables that roll over.

use super::assemble::Assembly;
use super::{Fault, number};
use crate::compensation::{CorrectionTable, Directions, TableRules};
use crate::controller::emit::{StoredColumn, StoredPosition};
use std::ops::RangeInclusive;

impl Assembly<'_> {
    fn need_index(&self, name: &str) -> Result<usize, Fault> {
        self.whole(name)?.ok_or_else(|| self.fault(format!("there is no `{name}`")))
    }

    /// Differences between neighbours, numbered through: zero at the reference number. For travel in the negative
    /// direction there may be as many more, which begin with a value of their own at the reference point.
    pub fn incremental(&self, mut table: CorrectionTable, rules: &TableRules) -> Result<CorrectionTable, Fault> {
        let axis = table.axes[0];
        let (kind, turns) = (self.kind(table.corrected[0]), self.reading.machine.is_continuous(axis));
        let (reference, first, last) =
            (self.need_index("reference")?, self.need_index("first")?, self.need_index("last_number")?);
        // Over a turn the farthest point in - is the reference point itself, and repeats the value of the last one.
        let repeated = turns && first == reference;
        let lowest = if repeated { first } else { first.wrapping_sub(1) };
        if first > last || last - first + 2 > rules.max_points || (first == 0 && !repeated) {
            return Err(self.fault(format!("the controller has no points {first} to {last}")));
        }
        if !(lowest..=last).contains(&reference) {
            return Err(self.fault("the reference point is none of the points"));
        }
        let zero = reference - lowest;
        let forward = self.sums(rules, first..=last, repeated, turns)?;
        self.check_turn((last - reference.min(last)) as f64, turns)?;
        let switch = self.field("bits").is_some_and(|(bits, _)| bits.ends_with('1'));
        let two_sided = self.field("two_sided").is_some() || switch;
        let told = ["first_reverse", "reverse_at_reference"].map(|name| self.field(name).is_some());
        // An archive has the parameters whether they are used or not.
        let unused = self.record.archive && !two_sided;
        if !unused && told.iter().any(|told| *told != two_sided) {
            return Err(self.fault(
                "points for the negative direction, their value at the reference point, and the switch that makes \
                 the controller use them: some of these are there and some are not",
            ));
        }
        let first_reverse = if unused { None } else { self.whole("first_reverse")? };
        let reverse = match first_reverse {
            None => None,
            Some(start) => Some(self.sums(rules, start..=start + (last - first), repeated, turns)?),
        };
        let ranges = [Some(first), first_reverse];
        let ours = |n: usize| ranges.iter().flatten().any(|start| (*start..=start + (last - first)).contains(&n));
        let strange = self.record.points.iter().find(|(index, _)| !ours(index[0]));
        if let Some((index, _)) = strange.filter(|_| !self.record.archive) {
            return Err(self.fault(format!("point {} is outside {first} to {last}", index[0])));
        }
        let (place, column) = (StoredPosition { rules, kind: self.kind(axis) }, StoredColumn::new(rules, kind));
        let step = self.need_number("step")?;
        if step <= 0.0 {
            let line = self.field("step").map_or(0, |(_, line)| *line);
            return Err(Fault::new(line, format!("an interval of {step} is none")));
        }
        let position = |n: usize| place.position((n as f64 - reference as f64) * step);
        let correction = |sums: &[f64], start: f64| -> Vec<f64> {
            sums.iter().map(|s| column.correction(s - sums[zero] + start, None)).collect()
        };
        table.nodes = vec![(lowest..=last).map(position).collect()];
        table.values = correction(&forward, 0.0);
        let start = self.number("reverse_at_reference")?.unwrap_or(0.0);
        table.reverse = reverse.map(|sums| correction(&sums, start));
        Ok(table)
    }

    /// Checks the length of a turn against that of the points (steps of it) that an axis without end has.
    fn check_turn(&self, steps: f64, turns: bool) -> Result<(), Fault> {
        let Some((_, line)) = self.field("turn").filter(|_| turns) else { return Ok(()) };
        if self.need_number("turn")? == steps * self.need_number("step")? {
            return Ok(());
        }
        Err(Fault::new(*line, "the points do not fill a turn: the controller would repeat them elsewhere"))
    }

    /// Sums of the increments of points with these numbers, zero before the first.
    fn sums(
        &self,
        rules: &TableRules,
        numbers: RangeInclusive<usize>,
        repeated: bool,
        turns: bool,
    ) -> Result<Vec<f64>, Fault> {
        let (first, last) = numbers.into_inner();
        let times = self.number("magnification")?.unwrap_or(1.0);
        let increment = |n: usize| {
            let missing = || self.fault(format!("point {n} is missing: the controller would keep what it had there"));
            let (text, line) =
                self.record.points.get(&[n, 0, 0]).and_then(|fields| fields.get("increment")).ok_or_else(missing)?;
            let stored = number(text).map_err(|message| Fault::new(*line, message))?;
            if libm::trunc(stored) != stored || rules.largest.is_some_and(|max| stored.abs() > max) {
                return Err(Fault::new(*line, format!("`{stored}` is no increment that the controller stores")));
            }
            Ok(stored * times)
        };
        if repeated && increment(first)? != increment(last)? {
            return Err(
                self.fault(format!("points {first} and {last} are the same position but hold different values"))
            );
        }
        let mut sums = vec![0.0];
        for n in first + usize::from(repeated)..=last {
            let sum = sums[sums.len() - 1] + increment(n)?;
            sums.push(sum);
        }
        if turns && sums[0] != sums[sums.len() - 1] {
            return Err(
                self.fault("the increments of a turn do not sum to zero: the axis would drift away with every turn")
            );
        }
        Ok(sums)
    }

    /// Entries from one step behind 0 on, of a plane line by line; entries beyond the travel hold negative positions.
    pub fn unroll(&self, mut table: CorrectionTable, rules: &TableRules) -> Result<CorrectionTable, Fault> {
        let column = StoredColumn::new(rules, self.kind(table.corrected[0]));
        let counts = self.counts(table.axes.len())?;
        let entries = self.entries(&counts)?;
        let cells = |c: f64| column.correction(c, None);
        match counts[..] {
            [count] => {
                let around = self.around(table.axes[0], count, "length", rules)?;
                table.values = around.iter().map(|(_, e)| cells(entries[*e])).collect();
                table.nodes = vec![around.into_iter().map(|(q, _)| q).collect()];
            }
            [count, rows] => {
                let line = self.around(table.axes[0], count, "length", rules)?;
                let column = self.around(table.axes[1], rows, "length_2", rules)?;
                let cell = |i: usize, j: usize| cells(entries[j * (count + 1) + i]);
                table.values = line.iter().flat_map(|(_, i)| column.iter().map(move |(_, j)| cell(*i, *j))).collect();
                table.nodes = [line, column].map(|nodes| nodes.into_iter().map(|(q, _)| q).collect()).to_vec();
            }
            _ => return Err(self.fault(format!("the controller has no table over {} axes", counts.len()))),
        }
        self.check(&table, rules)?;
        Ok(table)
    }

    /// Correction removed when an axis is approached in reverse: a constant, and a table of the differences from it.
    /// None if there is nothing.
    pub fn reversal(&self) -> Result<Option<CorrectionTable>, Fault> {
        let Some((word, line)) = self.field("reversal") else { return Ok(None) };
        let axis = self.reading.by_number(word);
        let axis = axis.ok_or_else(|| Fault::new(*line, format!("the machine has no axis `{word}`")))?;
        let table = CorrectionTable::curve(axis, Vec::new(), axis, Vec::new());
        let rules =
            self.reading.target.manifest.mechanism.rules(&table).filter(|rules| rules.directions.is_bidirectional());
        let rules = rules.ok_or_else(|| self.fault("the controller has no table of this kind"))?;
        let constant = self.number("constant")?.unwrap_or(0.0);
        if constant < 0.0 && rules.directions == Directions::Backlash {
            return Err(self.fault("a backlash constant cannot be negative"));
        }
        let column = StoredColumn::new(rules, self.kind(axis));
        let taken = |stored: f64| 0.0 - column.correction(stored + constant, None);
        let (nodes, reverse): (Vec<f64>, Vec<f64>) = if self.field("length").is_some() {
            let counts = self.counts(1)?;
            let entries = self.entries(&counts)?;
            let around = self.around(axis, counts[0], "length", rules)?;
            around.into_iter().map(|(q, e)| (q, taken(entries[e]))).unzip()
        } else {
            let (min, max) = self.reading.machine.axes()[axis].travel.interval();
            [min, max].map(|q| (q, taken(0.0))).into_iter().unzip()
        };
        let values = vec![0.0; nodes.len()];
        Ok((constant != 0.0 || reverse.iter().any(|c| *c != 0.0))
            .then(|| CorrectionTable { reverse: Some(reverse), ..CorrectionTable::curve(axis, nodes, axis, values) }))
    }

    /// Steps over each axis.
    fn counts(&self, axes: usize) -> Result<Vec<usize>, Fault> {
        let found: usize = self.record.rows.iter().map(|(row, _)| row.len()).sum();
        let said = ["count", "count_2"].into_iter().take(axes).map(|name| self.whole(name));
        let counts: Vec<Option<usize>> = said.collect::<Result<_, _>>()?;
        let counts: Vec<usize> = counts.into_iter().map(|count| count.unwrap_or(found)).collect();
        let wanted = counts.iter().fold(1, |product: usize, count| product.saturating_mul(count + 1)) - 1;
        let wanted = if axes == 1 { counts[0] } else { wanted };
        let max = self.reading.target.manifest.mechanism.iter().map(|(_, rules)| rules.max_points).max();
        if found != wanted || counts.iter().any(|count| *count < 2) || max.is_some_and(|max| wanted > 2 * max) {
            return Err(self.fault(format!("{found} entries, and the file states {wanted}")));
        }
        Ok(counts)
    }

    /// Whole numbers, that of position 0 before them; those one round on are the same.
    fn entries(&self, counts: &[usize]) -> Result<Vec<f64>, Fault> {
        let mut entries = vec![0.0];
        for (row, line) in &self.record.rows {
            for entry in row {
                if libm::trunc(*entry) != *entry {
                    return Err(Fault::new(*line, format!("`{entry}` is no whole number")));
                }
                entries.push(*entry);
            }
        }
        let jumps = match *counts {
            [_] => entries[entries.len() - 1] != 0.0,
            [count, rows] => {
                let at = |i: usize, j: usize| entries[j * (count + 1) + i];
                (0..=rows).any(|j| at(count, j) != at(0, j)) || (0..=count).any(|i| at(i, rows) != at(i, 0))
            }
            _ => false,
        };
        if jumps {
            let message = "the last entry is not 0, the value at position 0, or a line or column does not end as it \
             begins: the controller would jump there";
            return Err(self.fault(message));
        }
        Ok(entries)
    }

    /// Positions of the entries over an axis with their numbers, rising. A turn has its first one at its end too.
    fn around(&self, axis: usize, count: usize, length: &str, rules: &TableRules) -> Result<Vec<(f64, usize)>, Fault> {
        let place = StoredPosition { rules, kind: self.kind(axis) };
        let length = self.need_number(length)?;
        let step = length / count as f64;
        let turns = self.reading.machine.is_continuous(axis);
        let (_, max) = self.reading.machine.axes()[axis].travel.interval();
        let at = |e: usize| {
            let stored = e as f64 * step;
            let beyond = !turns && place.position(stored) > max.max(0.0) + 0.999 * place.position(step);
            (place.position(if beyond { stored - length } else { stored }), e)
        };
        let mut all: Vec<(f64, usize)> = (0..count).map(at).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        if turns {
            all.push((place.position(length), 0));
        }
        Ok(all)
    }
}
