//! Readings of orientations: six-degree probes, levels, autocollimators, telescopes. The frame of the instrument is
//! turned a little, for every run in another way, and its target sits a little askew on each tool: rotations that are
//! unknown, as far as the readings feel them and tell them apart.

use super::failure::RowFailure;
use super::measurement::{LEVER_MM, Measurement, MeasurementSet, Reading, TurnKind};
use super::touches::{Columns, beside_features};
use crate::evaluate::Frame;
use crate::identify::thresholds::MAX_TURN_RAD;
use crate::lower::NominalPose;
use crate::machine::Machine;
use nalgebra::{DVector, Matrix3, Vector3};

/// A row with an orientation.
pub(super) struct SeenTurn<'m> {
    /// The machine with its tool.
    pub machine: &'m Machine,
    pub row: Measurement,
    /// Components read (rad).
    pub values: [Option<f64>; 3],
    /// The nominal pose of the tool.
    pub tool: NominalPose,
}

/// Returns the rotation from the workpiece frame, that of the part, to another.
pub(crate) fn rotation_to(frame: Frame, nominal: &NominalPose) -> Matrix3<f64> {
    match frame {
        Frame::Workpiece => Matrix3::identity(),
        Frame::Machine => nominal.r_work,
        Frame::Tool => nominal.pose.linear.transpose(),
    }
}

/// Returns what small rotations about three directions (columns, workpiece frame) add to an orientation as it is read,
/// to first order.
pub(crate) fn turn_effects(
    machine: &Machine,
    of: TurnKind,
    frame: Frame,
    nominal: &NominalPose,
    about: &Matrix3<f64>,
) -> Matrix3<f64> {
    let axis = tool_axis(machine, nominal);
    rotation_to(frame, nominal) * if of == TurnKind::Axis { -axis.cross_matrix() * about } else { *about }
}

/// Returns the nominal direction of the tool's axis, workpiece frame.
pub(crate) fn tool_axis(machine: &Machine, nominal: &NominalPose) -> Vector3<f64> {
    nominal.pose.linear * Vector3::from(machine.tool().direction)
}

/// Refuses an angle (rad) that is no small difference.
pub(super) fn small(value: f64, cell: &str) -> Result<f64, RowFailure> {
    if value.abs() <= MAX_TURN_RAD { Ok(value) } else { Err(RowFailure::LargeRotation(cell.to_owned())) }
}

/// Adds rows by run, with their unknowns. `turns` says if the frame of the instrument is turned in an unknown way.
pub(super) fn add(
    data: &mut MeasurementSet,
    of: TurnKind,
    frame: Frame,
    turns: bool,
    name: &str,
    runs: Vec<(String, Vec<SeenTurn<'_>>)>,
    tool_name: &dyn Fn(usize) -> String,
) {
    let all: Vec<&SeenTurn<'_>> = runs.iter().flat_map(|(_, rows)| rows).collect();
    let effect = |seen: &SeenTurn<'_>, about: &Matrix3<f64>, k: usize| -> [f64; 3] {
        let column = turn_effects(seen.machine, of, frame, &seen.tool, about).column(k).into_owned();
        std::array::from_fn(|i| if seen.values[i].is_some() { column[i] } else { 0.0 })
    };
    let (mut spans, mut members, mut turned) = (Vec::new(), Vec::new(), Vec::new());
    let mut first = 0;
    for (run, rows) in &runs {
        let mut span = Columns::default();
        let own = |k: usize| rows.iter().flat_map(move |seen| effect(seen, &Matrix3::identity(), k));
        let mut felt = |k: usize| turns && span.add(&DVector::from_iterator(3 * rows.len(), own(k)));
        let found: [bool; 3] = std::array::from_fn(&mut felt);
        turned.push(std::array::from_fn(|k| found[k].then(|| data.unknown_angle(&format!("{name}{run}"), k))));
        spans.push(span);
        members.push((first..first + 3 * rows.len()).collect::<Vec<usize>>());
        first += 3 * rows.len();
    }
    let mut tools: Vec<usize> = all.iter().map(|seen| seen.row.tool).collect();
    tools.sort_unstable();
    tools.dedup();
    let (mut taken, mut mounted) = (Columns::default(), std::collections::BTreeMap::new());
    for tool in tools {
        let own = |k: usize| {
            let of_tool = move |seen: &&SeenTurn<'_>| match seen.row.tool == tool {
                true => effect(seen, &seen.tool.pose.linear, k),
                false => [0.0; 3],
            };
            DVector::from_iterator(first, all.iter().flat_map(of_tool))
        };
        let mut felt = |k: usize| taken.add(&beside_features(&own(k), members.iter(), &spans));
        let found: [bool; 3] = std::array::from_fn(&mut felt);
        let name = format!("{name} mount{}", tool_name(tool));
        let unknowns: [Option<usize>; 3] = std::array::from_fn(|k| found[k].then(|| data.unknown_angle(&name, k)));
        let _ = mounted.insert(tool, unknowns);
    }
    for ((_, rows), turned) in runs.into_iter().zip(turned) {
        for SeenTurn { row, values, .. } in rows {
            let angle = libm::sqrt(values.iter().flatten().map(|x| x * x).sum::<f64>());
            // The skew part of a rotation by a vector of this length.
            let shrunk = if of == TurnKind::Rotation && angle > 0.0 { libm::sin(angle) / angle } else { 1.0 };
            let mounted = mounted.get(&row.tool).copied().unwrap_or_default();
            let values = values.map(|value| value.map(|x| x * shrunk * LEVER_MM));
            data.rows.push(Measurement { reading: Reading::Turn { values, of, frame, turned, mounted }, ..row });
        }
    }
}
