//! New tables on top of those that are installed on the machine.

use crate::compensation::{AxisErrorCurve, CorrectionTable, CorrectionTables, Crowded, LatticeRequest, Spacing, round};
use crate::controller::manifest::ControllerTarget;
use crate::controller::replay::Replay;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{Approach, AxisKind, Machine};
use crate::units::significant;

impl ControllerTarget {
    /// Returns the tables for a machine whose errors were measured with other tables in force: the old plus the new,
    /// rounded like any tables of the target. `planner` is the target with the mechanisms that new tables may use. New
    /// tables for which the controller has no room beside the old ones are left out: W0708.
    pub fn tables_over(
        &self,
        planner: &Self,
        machine: &Machine,
        request: &LatticeRequest,
        installed: &CorrectionTables,
    ) -> (CorrectionTables, Vec<Diagnostic>) {
        let mut fresh = planner.tables(machine, request);
        self.add_installed_points(&mut fresh, installed);
        let mut left_out = Vec::new();
        loop {
            let sum = self.sum(machine, &fresh, installed);
            let crowded = self.manifest.mechanism.excess(&sum);
            let Some(weakest) = crowded.and_then(|crowded| self.weakest(&fresh, installed, crowded)) else {
                return (sum, left_out);
            };
            left_out.push(no_room(machine, &fresh.tables.remove(weakest)));
        }
    }

    /// Returns the index of the new table with the least effect among those that take the room that is lacking: tables
    /// over several axes first, then over one. Tables on top of an old one of the same kind take none, products aside.
    fn weakest(&self, fresh: &CorrectionTables, installed: &CorrectionTables, crowded: Crowded) -> Option<usize> {
        let mechanisms = &self.manifest.mechanism;
        let takes_room = |table: &&CorrectionTable| {
            let there =
                installed.tables.iter().any(|old| (&old.axes, &old.corrected) == (&table.axes, &table.corrected));
            crowded.concerns(mechanisms, table) && (!there || mechanisms.is_product(table))
        };
        let strength = |table: &CorrectionTable| table.values.iter().map(|x| x * x).sum::<f64>() / table.len() as f64;
        let candidates = fresh.tables.iter().enumerate().filter(|(_, table)| takes_room(table));
        let order = |(_, a): &(usize, &CorrectionTable), (_, b): &(usize, &CorrectionTable)| {
            (a.axes.len() == 1).cmp(&(b.axes.len() == 1)).then(strength(a).total_cmp(&strength(b)))
        };
        candidates.min_by(order).map(|(index, _)| index)
    }

    /// Old plus new, rounded.
    fn sum(&self, machine: &Machine, fresh: &CorrectionTables, installed: &CorrectionTables) -> CorrectionTables {
        let at = |old: &CorrectionTable, new: &CorrectionTable, reverse: bool| -> Vec<f64> {
            let alone = alone(old);
            let replay = Replay::new(machine, self, &alone);
            at_nodes(machine, (&replay, old), new, if reverse { Approach::Reverse } else { Approach::Forward })
        };
        let mut sum = fresh.clone().plus(installed, &at);
        self.manifest.mechanism.round(machine, &mut sum);
        sum.merge()
    }

    /// Where points are free, gives the new tables the points of the old ones besides their own, as far as there is
    /// room.
    fn add_installed_points(&self, fresh: &mut CorrectionTables, installed: &CorrectionTables) {
        let mechanisms = &self.manifest.mechanism;
        for table in fresh.tables.iter_mut().filter(|table| table.axes.len() == 1) {
            let rules = mechanisms.rules(table).filter(|rules| rules.spacing == Spacing::Free);
            let old =
                installed.tables.iter().find(|old| (&old.axes, &old.corrected) == (&table.axes, &table.corrected));
            if let (Some(rules), Some(old)) = (rules, old) {
                table.add_points(&old.nodes[0], rules.max_points);
            }
        }
        let Some(rules) = mechanisms.error_curves.as_ref().filter(|rules| rules.spacing == Spacing::Free) else {
            return;
        };
        for curve in &mut fresh.errors {
            let of_axis = |old: &&AxisErrorCurve| old.error.axis == curve.error.axis;
            let old: Vec<f64> = installed.errors.iter().filter(of_axis).flat_map(|old| old.positions.clone()).collect();
            curve.add_points(&old, rules.max_points);
        }
    }

    /// Returns tables whose scales are those in force once they are loaded: a new one replaces them.
    pub fn with_scales_in_force(&self, tables: CorrectionTables) -> CorrectionTables {
        let mechanisms = &self.manifest.mechanism;
        let (lines, others): (Vec<_>, Vec<_>) = tables.tables.into_iter().partition(|table| mechanisms.is_scale(table));
        let now = |(axis, before): (usize, f64)| {
            let line = lines.iter().find(|line| line.axes[0] == axis);
            let own = mechanisms.own_axis.as_ref().and_then(|own| Some((own.scale?, own.table.increment)));
            let now = line.zip(own).map(|(line, (scale, increment))| {
                round(scale.stored(before, line.slope_of_line()), increment.correction_decimals)
            });
            (axis, now.unwrap_or(before))
        };
        let scales = tables.scales.into_iter().map(now).collect();
        CorrectionTables { tables: others, scales, ..CorrectionTables::default() }
    }

    /// Warns of installed points that fall between the points of the new tables: W0704.
    pub fn resampling_losses(
        &self,
        machine: &Machine,
        tables: &CorrectionTables,
        installed: &CorrectionTables,
    ) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        for old in &installed.tables {
            let same = |new: &&CorrectionTable| (&new.axes, &new.corrected) == (&old.axes, &old.corrected);
            if let Some(new) = tables.tables.iter().find(same) {
                all.extend(self.table_loss(machine, new, old));
            }
        }
        for old in &installed.errors {
            let new = tables.errors.iter().find(|new| new.error == old.error && !new.positions.is_empty());
            all.extend(new.and_then(|new| curve_loss(new, old)));
        }
        all
    }

    fn table_loss(&self, machine: &Machine, new: &CorrectionTable, old: &CorrectionTable) -> Option<Diagnostic> {
        let rules = self.manifest.mechanism.rules(old)?;
        let sides = [Approach::Forward, Approach::Reverse];
        let before = alone(old);
        let was = Replay::new(machine, self, &before);
        let [values, reverse] = sides.map(|side| at_nodes(machine, (&was, old), new, side));
        let resampled = CorrectionTable { values, reverse: Some(reverse), ..new.clone() };
        let after = alone(&resampled);
        let is = Replay::new(machine, self, &after);
        // Both are straight between the points of either; those of the new one agree.
        let places = (0..old.len()).map(|node| old.node(node)).filter(|place| {
            place.iter().zip(&new.nodes).all(|(q, nodes)| (nodes[0]..=nodes[nodes.len() - 1]).contains(q))
        });
        let gap = |place: &Vec<f64>| {
            let both = sides.map(|side| {
                let was = table_addition(machine, (&was, old), place, side);
                let is = table_addition(machine, (&is, &resampled), place, side);
                was.iter().zip(&is).map(|(a, b)| (a - b).abs()).collect::<Vec<f64>>()
            });
            both.concat()
        };
        let columns = old.corrected.len();
        let mut lost = vec![0.0; columns];
        for row in places.map(|place| gap(&place)) {
            row.iter().enumerate().for_each(|(i, x)| lost[i % columns] = f64::max(lost[i % columns], *x));
        }
        let (axis, max) = old.corrected.iter().zip(lost).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let kind = machine.axes()[*axis].kind;
        if max <= 2.0 * rules.increment.half_correction(kind).max(SMALL) {
            return None;
        }
        let name = |axis: &usize| machine.axes()[*axis].name.as_str();
        let over: Vec<&str> = old.axes.iter().map(name).collect();
        let unit = if kind == AxisKind::Linear { "um" } else { "mdeg" };
        let found = loss(&format!("`{}` over {}", name(axis), over.join(" and ")), max * 1e3, unit);
        Some(if old.axes.len() > 1 { found.help(steps_of(machine, old)) } else { found })
    }
}

/// The remedy where the nodes of a lattice are those of the volume.
fn steps_of(machine: &Machine, old: &CorrectionTable) -> String {
    let step = |(axis, nodes): (&usize, &Vec<f64>)| {
        let (axis, count) = (&machine.axes()[*axis], nodes.len().checked_sub(1).filter(|count| *count > 0)?);
        let step = significant((nodes[count] - nodes[0]) / count as f64, 9);
        Some(format!("{}: {{ step: {step} {} }}", axis.name, axis.unit()))
    };
    let steps: Vec<String> = old.axes.iter().zip(&old.nodes).filter_map(step).collect();
    format!("measure without the old tables, or take their nodes: `volume: {{ {} }}`", steps.join(", "))
}

fn no_room(machine: &Machine, table: &CorrectionTable) -> Diagnostic {
    let names = |axes: &[usize]| {
        let names: Vec<&str> = axes.iter().map(|axis| machine.axes()[*axis].name.as_str()).collect();
        names.join(" and ")
    };
    let message = format!(
        "no table corrects {} over {}: the controller has no room for it beside the installed ones",
        names(&table.corrected),
        names(&table.axes)
    );
    Diagnostic::new(codes::W0708, message)
        .help("the certificate counts without it; measure without the installed tables and compile without --installed")
}

/// A loss (mm, deg) below which nothing is reported.
const SMALL: f64 = 5e-6;

fn loss(what: &str, max: f64, unit: &str) -> Diagnostic {
    let message = format!(
        "{what}: the installed table has points where the new one has none, up to {} {unit} of it are lost",
        significant(max, 3)
    );
    Diagnostic::new(codes::W0704, message)
        .help("measure without the old tables, or give the curves points where the old tables have them")
}

fn curve_loss(new: &AxisErrorCurve, old: &AxisErrorCurve) -> Option<Diagnostic> {
    let values = new.positions.iter().map(|q| old.value(*q, false)).collect();
    let resampled = AxisErrorCurve { values, ..new.clone() };
    let range = new.positions[0]..=new.positions[new.positions.len() - 1];
    let within = old.positions.iter().filter(|q| range.contains(q));
    let max = within.map(|q| (old.value(*q, false) - resampled.value(*q, false)).abs()).fold(0.0, f64::max);
    let (scale, unit, threshold) =
        if old.error.direction.is_rotation() { (1e6, "urad", 1e-7) } else { (1e3, "um", 2.0 * SMALL) };
    (max > threshold).then(|| loss(&format!("`{}`", old.error), max * scale, unit))
}

fn alone(table: &CorrectionTable) -> CorrectionTables {
    CorrectionTables { tables: vec![table.clone()], ..CorrectionTables::default() }
}

/// A table, and the replay of it alone.
type Loaded<'a> = (&'a Replay<'a>, &'a CorrectionTable);

/// Returns the motions that a table adds at the nodes of another one, node by node.
fn at_nodes(machine: &Machine, old: Loaded, new: &CorrectionTable, approach: Approach) -> Vec<f64> {
    (0..new.len()).flat_map(|node| table_addition(machine, old, &new.node(node), approach)).collect()
}

/// Returns the motions that a table adds at a position of each of its axes.
fn table_addition(machine: &Machine, (replay, table): Loaded, positions: &[f64], approach: Approach) -> Vec<f64> {
    let mut pose = vec![0.0; machine.axes().len()];
    table.axes.iter().zip(positions).for_each(|(axis, q)| pose[*axis] = *q);
    let added = replay.addition(&approach.at_pose(&pose));
    table.corrected.iter().map(|axis| added[*axis]).collect()
}
