//! What can be built: rules on arrangements that hold unless a machine's own file breaks them. The arrangement of the
//! file obeys all of them.

use super::arrangement::Walk;
use crate::machine::{AxisKind, Branch, Machine};

/// Axes that a table carries at most: each more adds a bearing and a drive to the mass that all below it move.
const MAX_BELOW_PART: usize = 4;
/// Rotary axes in a head at most: cables, oil and the drive of the spindle go through each of them.
const MAX_ROTARY_IN_HEAD: usize = 2;

/// The rules in words, in the order of [`buildable`]'s counts.
pub const BUILDABLE_RULES: [&str; 3] = [
    "no linear axis above a rotary one on the table",
    "at most four axes below the part",
    "at most two rotary axes in the head",
];

/// Returns the arrangements that can be built, and how many each rule excludes; one that breaks several counts for the
/// first. A rule that the machine itself breaks is as wide as the machine needs.
pub fn buildable(machine: &Machine, walks: Vec<Walk>) -> (Vec<Walk>, [usize; 3]) {
    let mut excluded = [0; 3];
    let own: Vec<usize> = (0..machine.axes().len()).collect();
    let is_table = |axis: &usize| machine.axes()[*axis].branch == Branch::Workpiece;
    let own_table = own.iter().filter(|axis| is_table(axis)).count();
    let allowed = above(machine, &own[..own_table]);
    let max_below = own_table.max(MAX_BELOW_PART);
    let max_rotary = rotary(machine, &own[own_table..]).max(MAX_ROTARY_IN_HEAD);
    let breaks = |axes: &[usize], table: usize| {
        let on_table = above(machine, &axes[..table]);
        let broken = [
            on_table.iter().any(|pair| !allowed.contains(pair)),
            table > max_below,
            rotary(machine, &axes[table..]) > max_rotary,
        ];
        broken.iter().position(|broken| *broken)
    };
    let mut left = Vec::new();
    for walk in walks {
        let mut tables = walk.tables.clone();
        tables.retain(|table| {
            let rule = breaks(&walk.axes, *table);
            rule.into_iter().for_each(|rule| excluded[rule] += 1);
            rule.is_none()
        });
        if !tables.is_empty() {
            left.push(Walk { tables, ..walk });
        }
    }
    (left, excluded)
}

/// A linear axis that a rotary one carries.
type LinearAboveRotary = (usize, usize);

/// Returns the linear axes of a table, listed from the workpiece on, each with the rotary ones that carry it.
fn above(machine: &Machine, table: &[usize]) -> Vec<LinearAboveRotary> {
    let kind = |axis: usize| machine.axes()[axis].kind;
    let linear = table.iter().enumerate().filter(|(_, axis)| kind(**axis) == AxisKind::Linear);
    let carried = |(place, axis): (usize, &usize)| {
        let (axis, below) = (*axis, &table[place + 1..]);
        let rotary: Vec<usize> = below.iter().copied().filter(|other| kind(*other) == AxisKind::Rotary).collect();
        rotary.into_iter().map(move |other| (axis, other))
    };
    linear.flat_map(carried).collect()
}

fn rotary(machine: &Machine, axes: &[usize]) -> usize {
    axes.iter().filter(|axis| machine.axes()[**axis].kind == AxisKind::Rotary).count()
}
