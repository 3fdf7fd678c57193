//! Tables of every error alone, laid out as those of a set; their effect is judged elsewhere.

use super::curves::curves_like;
use super::jacobian::Jacobian;
use super::plan::{Planner, own_axis_addition, vanish_at_reference};
use super::sum::{Demand, Filler};
use super::{
    Correction, CorrectionTable, CorrectionTables, Directions, LatticeCells, Mechanisms, Reference, Scope,
    SingleErrorTables, SingleErrors, own_axis_table,
};
use crate::evaluate::error_by_error;
use crate::machine::{Approach, AxisKind, ErrorId, ErrorTerm, Machine, OperatingPoint, Pose};
use rayon::prelude::*;

/// A set whose layout single errors get.
#[derive(Debug, Clone, Copy)]
pub struct SetLayout<'a> {
    /// Mechanisms of its controller.
    pub mechanisms: &'a Mechanisms,
    /// Its tables.
    pub tables: &'a CorrectionTables,
    /// Goal and axes of the correction.
    pub scope: Scope,
    /// Nodes of its lattice over any axes that are to be filled; none of another set.
    pub lattice_nodes: &'a [usize],
}

/// Fills tables for every error with a value alone, to first order.
pub fn single_errors(machine: &Machine, layout: SetLayout) -> SingleErrors {
    if let Some(lattice) = layout.mechanisms.free_lattice(layout.tables) {
        return SingleErrors::Lattice(lattice_cells(machine, lattice, &layout));
    }
    let all = match &layout.tables.tables[..] {
        [] if !layout.tables.errors.is_empty() => model_curves(machine, layout.tables),
        _ => single_error_tables(machine, layout.mechanisms, layout.tables),
    };
    SingleErrors::Tables(all)
}

/// Errors with a value (tolerances have none), with their numbers among all.
fn valued_errors(machine: &Machine) -> Vec<(usize, ErrorId)> {
    let all = machine.errors().enumerate();
    all.filter(|(_, (_, term))| !matches!(term, ErrorTerm::Tolerance(_))).map(|(i, (id, _))| (i, id)).collect()
}

fn model_curves(machine: &Machine, tables: &CorrectionTables) -> Vec<SingleErrorTables> {
    let alone = |(_, error): (usize, ErrorId)| {
        let errors = curves_like(&machine.filtered(|id| *id == error), &tables.errors);
        SingleErrorTables { error, tables: CorrectionTables { errors, ..CorrectionTables::default() } }
    };
    valued_errors(machine).into_iter().map(alone).collect()
}

/// Corrections of every error alone at some nodes of a lattice.
fn lattice_cells(machine: &Machine, lattice: &CorrectionTable, layout: &SetLayout) -> LatticeCells {
    // Without rotary columns the rotary axes were not corrected.
    let rotary = lattice.corrected.iter().any(|axis| machine.axes()[*axis].kind == AxisKind::Rotary);
    let scope = Scope { rotary, ..layout.scope };
    let none = Correction::none(machine);
    let row = |node: &usize| -> Vec<Vec<f64>> {
        let pose = lattice.pose(machine, *node);
        let jacobian = Jacobian::at(machine, &pose);
        let step = |deviation| jacobian.correction(&deviation, &none, scope).0;
        let picked = |all: Vec<f64>| lattice.corrected.iter().map(|axis| all[*axis]).collect();
        let each = error_by_error(machine, &Approach::Mean.at_pose(&pose)).into_iter();
        each.map(|(_, deviation)| picked(step(deviation))).collect()
    };
    let rows: Vec<Vec<Vec<f64>>> = layout.lattice_nodes.par_iter().map(row).collect();
    let values = |index: usize| rows.iter().flat_map(|row| row[index].iter().copied()).collect();
    let errors = valued_errors(machine).into_iter().map(|(index, error)| (error, values(index))).collect();
    LatticeCells { nodes: layout.lattice_nodes.to_vec(), errors }
}

/// The tables of single errors, each for a machine with this error alone, to first order: laid out as
/// the given ones.
fn single_error_tables(
    machine: &Machine,
    mechanisms: &Mechanisms,
    tables: &CorrectionTables,
) -> Vec<SingleErrorTables> {
    let ids: Vec<ErrorId> = machine.errors().map(|(id, _)| id).collect();
    let planner = Planner { machine, mechanisms };
    let (own, mut sums): (Vec<_>, Vec<_>) = tables.tables.iter().cloned().partition(|t| planner.is_by_own_error(t));
    // In the order of filling: planes take the residual of tables over one axis.
    sums.sort_by_key(|table| table.axes.len());
    let alone: Vec<Vec<CorrectionTable>> = ids
        .iter()
        .map(|id| {
            let machine = machine.filtered(|other| other == id);
            let rules = own.first().and_then(|table| mechanisms.rules(table));
            let has = |table: &CorrectionTable| own.iter().any(|t| t.axes == table.axes);
            rules.map_or_else(Vec::new, |rules| {
                let axes = 0..machine.axes().len();
                let all = axes.map(|axis| own_axis_table(&machine, axis, rules, None));
                all.filter(has).collect()
            })
        })
        .collect();
    let linear = |at: OperatingPoint<'_>| -> Vec<Vec<f64>> {
        let jacobian = Jacobian::at(machine, at.axes);
        let each = error_by_error(machine, &at).into_iter().zip(&alone);
        each.map(|((_, mut deviation), own)| {
            let turned = Correction(own_axis_addition(own, &at));
            deviation.position += jacobian.displacement(&turned);
            jacobian.correction(&deviation, &Correction::none(machine), Scope::POSITION).0
        })
        .collect()
    };
    let mean = |poses: &[Pose]| poses.iter().map(|pose| linear(Approach::Mean.at_pose(pose)).concat()).collect();
    let two_sided: Vec<bool> =
        machine.axes().iter().map(|axis| machine.filtered(|id| id.axis == axis.name).is_bidirectional()).collect();
    let half_at = |pose: &Pose, axis: usize| {
        let name = &machine.axes()[axis].name;
        if !two_sided[axis] {
            return vec![0.0; pose.len() * ids.len()];
        }
        let (forward, reverse) = (linear(Approach::Forward.at_pose(pose)), linear(Approach::Reverse.at_pose(pose)));
        let both = ids.iter().zip(forward.iter().zip(&reverse));
        both.flat_map(|(id, (f, r))| {
            let fraction = if id.axis == *name { 0.5 } else { 0.0 };
            f.iter().zip(r).map(move |(f, r)| fraction * (f - r)).collect::<Vec<_>>()
        })
        .collect()
    };
    let half = |poses: &[Pose], axis: usize| poses.iter().map(|pose| half_at(pose, axis)).collect();
    let mut sets = Filler::new(machine, Demand { mean: &mean, half: &half }).fill(&sums, &planner.traits(&sums));
    sets.resize_with(ids.len(), CorrectionTables::default);
    sets.iter_mut().zip(alone).for_each(|(set, own)| set.tables.extend(own));
    for table in sets.iter_mut().flat_map(|set| &mut set.tables) {
        if let Some(rules) = mechanisms.rules(table).filter(|rules| rules.reference == Reference::Zero) {
            vanish_at_reference(table, rules.directions == Directions::Backlash);
        }
    }
    let mut sets: Vec<Option<CorrectionTables>> = sets.into_iter().map(Some).collect();
    let alone = |(i, error): (usize, ErrorId)| SingleErrorTables { error, tables: sets[i].take().unwrap_or_default() };
    valued_errors(machine).into_iter().map(alone).collect()
}
