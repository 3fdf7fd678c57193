//! Tool poses from a file, as the work of a machine: the functional point in the workpiece frame with the
//! direction of the tool axis, or with positions of the rotary axes; or poses of the machine's axes.
//!
//! `columns` reads CSV, `apt` APT CL data. Rows that a machine cannot reach are left out, counted, and told with what
//! they lack (`missed`).

mod apt;
pub(crate) mod columns;
mod missed;

use super::path::{DeviationStep, LargestStep, PathResult};
use super::placement::Placement;
use super::poses::{PoseRow, check, other_units, rows_of_file};
use crate::analysis::zone::SurfacePoint;
use crate::analysis::{
    Miss, Needs, PathEvents, ToolPose, Unreachable, UnreachableCount, Work, path_events, place, rest, solve, tool_pose,
};
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::lower::into_part;
use crate::machine::{AxisKind, Machine, Pose};
use crate::run::{Call, Refused};
use crate::syntax::sheet::{cells, read_named_sheet, separator};
use crate::units::significant;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

use missed::DirectionGaps;
pub use missed::{BeyondTravel, Lack, MissedToolPose, NeededTravel};
pub(crate) use missed::{Lacks, needed_travel};

/// Largest number of tool poses of a file.
const MAX_TOOL_POSES: usize = 1_000_000;

/// Direction of the tool.
#[derive(Debug, Clone)]
enum Aim {
    /// Unit vector from the tip to the holder, workpiece frame.
    Axis(Vector3<f64>),
    /// The machine's rotary axes as given (deg), all others at 0.
    Rotary(Pose),
    /// The positions of all axes of the machine that read the file, with the unit vector that they give.
    Axes { pose: Pose, direction: Vector3<f64> },
}

#[derive(Debug, Clone)]
struct Row {
    /// Place of the row in the file.
    place: Place,
    /// 1-based.
    line: usize,
    tip: Vector3<f64>,
    aim: Aim,
    /// Turn of the tool about its axis, rad.
    spin_rad: Option<f64>,
    /// Name of the feature to which the row belongs.
    feature: Option<String>,
    /// Normal of the surface, a unit vector out of the material, workpiece frame.
    normal: Option<Vector3<f64>>,
}

impl Row {
    /// Returns the place and the normal of the surface, unturned workpiece frame.
    fn surface_point(&self, machine: &Machine) -> SurfacePoint {
        let turned = machine.workpiece_rotation();
        let unturned = |v: Vector3<f64>| turned.map_or(v, |rotation| rotation * v);
        SurfacePoint { place: unturned(self.tip), normal: self.normal.map(unturned) }
    }

    /// Returns the tip and the positions of the rotary axes, if the row gives these.
    fn rotary(&self) -> Option<(&Vector3<f64>, &Pose)> {
        match &self.aim {
            Aim::Rotary(pose) => Some((&self.tip, pose)),
            Aim::Axis(_) | Aim::Axes { .. } => None,
        }
    }

    /// Returns the row of a pose of the axes of a machine.
    fn of_axes(machine: &Machine, PoseRow { place, line, pose }: PoseRow) -> Self {
        let ToolPose { tip, direction, spin_rad } = tool_pose(machine, &pose);
        Self { place, line, tip, aim: Aim::Axes { pose, direction }, spin_rad, feature: None, normal: None }
    }

    /// Returns the positions of all axes, if the row gives these.
    fn axes(&self) -> Option<&Pose> {
        match &self.aim {
            Aim::Axes { pose, .. } => Some(pose),
            Aim::Axis(_) | Aim::Rotary(_) => None,
        }
    }

    /// Returns the tool pose, as the nominal `machine` holds it if the row gives positions of its rotary axes.
    fn tool_pose(&self, machine: &Machine) -> ToolPose {
        let direction = match &self.aim {
            Aim::Axis(direction) | Aim::Axes { direction, .. } => *direction,
            Aim::Rotary(pose) => tool_pose(machine, pose).direction,
        };
        ToolPose { spin_rad: self.spin_rad, ..ToolPose::new(self.tip, direction) }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct ToolPoses {
    file: String,
    rows: Vec<Row>,
    /// True for CL data.
    is_cl: bool,
    /// True if the rows are one continuous path.
    is_path: bool,
}

/// Tool poses of a file that a machine reaches.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ReachedToolPoses {
    /// Name of the file.
    pub file: String,
    /// True if the file has poses of the axes.
    #[serde(skip)]
    pub of_axes: bool,
    /// Number of tool poses in the file.
    pub asked: usize,
    /// Number of tool poses that the machine reaches.
    pub reached: usize,
    /// Number of the others, by reason.
    pub unreachable: UnreachableCount,
    /// The others, row by row.
    pub rows: Vec<MissedToolPose>,
    /// The travel that the tool poses need, axis by axis.
    pub travel: Vec<NeededTravel>,
    /// Events of the path, if they are one.
    #[serde(skip)]
    pub path: Option<PathResult>,
    /// The poses of the machine (mm, deg), in the order of the rows.
    #[serde(skip)]
    pub(crate) poses: Vec<Pose>,
    /// Lines of these poses in the file, from 1, with their features.
    #[serde(skip)]
    pub(crate) lines: Vec<(usize, Option<String>)>,
    /// The points of the surface there, unturned workpiece frame.
    #[serde(skip)]
    pub(crate) surface: Vec<SurfacePoint>,
}

impl ReachedToolPoses {
    /// Returns the events of the path at each pose in words, empty at a pose without; none of single poses.
    pub(crate) fn events(&self) -> Vec<String> {
        let lines = || self.lines.iter().map(|(line, _)| *line);
        self.path.as_ref().map_or_else(Vec::new, |path| path.words_at(lines()))
    }
}

/// The place of a row of a file.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub(crate) struct RowTip {
    /// Line of the file, from 1.
    line: usize,
    /// Functional point from the workpiece origin, mm, workpiece frame.
    tip_mm: [f64; 3],
}

/// Reads a file as single tool poses; rotary columns are those of `machine`.
pub(crate) fn read(call: &mut Call<'_>, machine: &Machine, path: &Path) -> Result<ToolPoses, Refused> {
    read_named(call, machine, path, None)
}

/// Reads the same; `named` is where a job names the file.
pub(crate) fn read_named(
    call: &mut Call<'_>,
    machine: &Machine,
    path: &Path,
    named: Option<Place>,
) -> Result<ToolPoses, Refused> {
    let sheet = read_named_sheet(path, named, call.run.files, &mut call.diagnostics).ok_or(Refused)?;
    let is_cl = apt::is_cl_data(&sheet);
    let rows = if is_cl { apt::rows(&sheet) } else { columns::rows(machine, &sheet) };
    if let (Ok(rows), Some(header)) = (&rows, sheet.each_line().next()) {
        let header_cells = cells(&header.text, separator(&header.text));
        let rotary = rows.iter().filter_map(|row| row.rotary().map(|(_, pose)| pose));
        call.extend(other_units(machine, &header_cells, rotary, &Some(header.place)));
        call.extend(reversed(rows));
        if !is_cl {
            call.extend(metres(machine, rows, &header_cells));
            call.extend(undirected(machine, rows, &header_cells));
        }
    }
    match rows {
        Ok(rows) => Ok(ToolPoses { file: path.display().to_string(), rows, is_cl, is_path: false }),
        Err(refusal) => call.refuse(refusal),
    }
}

/// Reads a file of poses of the axes of `machine` as single tool poses.
pub(crate) fn read_axes(call: &mut Call<'_>, machine: &Machine, path: &Path) -> Result<ToolPoses, Refused> {
    let rows = rows_of_file(call, machine, path)?.into_iter().map(|row| Row::of_axes(machine, row)).collect();
    Ok(ToolPoses { file: path.display().to_string(), rows, is_cl: false, is_path: false })
}

/// Asks about tips of a part that all lie within a millimetre or two of its origin.
fn metres(machine: &Machine, rows: &[Row], header: &[String]) -> Option<Diagnostic> {
    let is_bare = ["X", "Y", "Z"].iter().all(|name| header.iter().any(|cell| cell.eq_ignore_ascii_case(name)));
    let farthest = rows.iter().fold(0.0_f64, |farthest, row| farthest.max(row.tip.amax()));
    let linear = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear);
    let longest =
        linear.map(|axis| axis.travel.interval()).fold(0.0, |longest, (min, max)| f64::max(longest, max - min));
    if !is_bare || rows.len() < 2 || farthest >= METRES || farthest <= 0.0 || longest < 50.0 * METRES {
        return None;
    }
    let farthest = significant(farthest, 3);
    let message = format!("no tip is farther than {farthest} mm from the origin of the part: are these metres?");
    let help = "say `X [m]` or `X [mm]` in the header";
    Some(Diagnostic::new(codes::W0804, message).at(Some(rows[0].place.clone()), "").help(help))
}

/// Asks about a part with an underside and without directions of the tool: it stands as at the zero pose in all rows.
fn undirected(machine: &Machine, rows: &[Row], header: &[String]) -> Option<Diagnostic> {
    let mut rotary = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary).map(|axis| axis.name.as_str());
    let is_said = |name: &str| header.iter().any(|cell| cell.trim().to_uppercase().starts_with(name));
    if rotary.clone().next().is_none() || is_said("I") || rotary.any(is_said) {
        return None;
    }
    let axis = into_part(machine, Vector3::from(machine.tool().direction));
    let aside = rows.iter().find(|row| row.normal.is_some_and(|normal| normal.dot(&axis) < -OBLIQUE))?;
    let message =
        "the surface has an underside, and no row a direction of the tool: it stands as at the zero pose in all";
    let help = "give I, J, K, from the tip to the spindle, or rotary axes; for one set-up, `0,0,1` in every row";
    Some(Diagnostic::new(codes::W0855, message).at(Some(aside.place.clone()), "").help(help))
}

/// A part whose tips are all within this of its origin, mm, is as a rule in metres.
const METRES: f64 = 2.0;
/// Cosine of the angle between tool axis and normal from which on a row tells from which side the tool comes.
const OBLIQUE: f64 = 0.2;

/// Asks about tool axes that all point into the material: from the holder to the tip.
fn reversed(rows: &[Row]) -> Option<Diagnostic> {
    let axis = |row: &Row| match row.aim {
        Aim::Axis(axis) => Some(axis),
        Aim::Rotary(_) | Aim::Axes { .. } => None,
    };
    let has_normals = rows.iter().any(|row| row.normal.is_some());
    let up = |row: &Row| if has_normals { row.normal } else { Some(Vector3::z()) };
    // A tool along its surface, as one that mills with its flank, says nothing.
    let told = rows.iter().filter_map(|row| Some((row, axis(row)?.dot(&up(row)?))));
    let told: Vec<(&Row, f64)> = told.filter(|(_, cosine)| cosine.abs() > OBLIQUE).collect();
    let (first, _) = told.first()?;
    if told.iter().any(|(_, cosine)| *cosine > 0.0) {
        return None;
    }
    let against = if has_normals { "against the normals of the surface" } else { "against Z of the part" };
    let message = format!("the tool axis I, J, K points {against} in every row that tells: is it reversed?");
    let help = "I, J, K point from the tip to the spindle: change their signs, if the tool is not below the part";
    Some(Diagnostic::new(codes::W0855, message).at(Some(first.place.clone()), "").help(help))
}

impl ReachedToolPoses {
    /// Returns the steps of a path: the index of each pose whose next one is that of the next row, rewinds apart.
    pub(crate) fn path_steps(&self, path: &PathResult) -> Vec<usize> {
        let missed: BTreeSet<usize> = self.rows.iter().map(|row| row.line).collect();
        let rewound: BTreeSet<usize> = path.rewinds.iter().map(|of| of.lines[1]).collect();
        let is_step = |i: &usize| {
            let [from, to] = [self.lines[*i].0, self.lines[*i + 1].0];
            !rewound.contains(&to) && missed.range(from..to).next().is_none()
        };
        (0..self.lines.len().saturating_sub(1)).filter(is_step).collect()
    }

    /// Returns the events of the path with the largest step of the deviation; `None` without a path. `largest` returns
    /// it among steps from poses by index, `None` without steps.
    pub(crate) fn path_with_step(
        &self,
        largest: impl FnOnce(&[usize]) -> Result<Option<LargestStep>, Refused>,
    ) -> Result<Option<PathResult>, Refused> {
        let Some(path) = &self.path else { return Ok(None) };
        let steps = self.path_steps(path);
        let found = if steps.is_empty() { None } else { largest(&steps)? };
        let of = |step: LargestStep| DeviationStep {
            um: step.mm * 1e3,
            interval_um: step.interval_mm.map(|ends| ends.map(|mm| mm * 1e3)),
            drawn: step.drawn,
            lines: [step.pose, step.pose + 1].map(|pose| self.lines[pose].0),
        };
        Ok(Some(PathResult { deviation_step: found.map(of), ..path.clone() }))
    }
}

impl ToolPoses {
    /// Returns the same rows as one path, or as single tool poses; by default CL data are a path.
    pub(crate) fn along(self, path: Option<bool>) -> Self {
        Self { is_path: path.unwrap_or(self.is_cl), ..self }
    }

    /// Returns the tool poses as a work, as the nominal `machine` holds them if the file gives positions of its rotary
    /// axes; of poses of its axes, these.
    pub(crate) fn work(&self, machine: &Machine) -> Work {
        if let Some(poses) = self.axes() {
            return Work::OfAxes { poses: poses.into_iter().cloned().collect(), is_path: self.is_path };
        }
        Work::listed(self.list(machine), self.is_path)
    }

    /// Returns the poses of the axes, if the file has these.
    fn axes(&self) -> Option<Vec<&Pose>> {
        self.rows.iter().map(Row::axes).collect()
    }

    /// True if the file has poses of the axes.
    pub(crate) fn are_axes(&self) -> bool {
        self.rows.iter().all(|row| row.axes().is_some())
    }

    /// Returns the line of each row.
    pub(crate) fn lines(&self) -> Vec<usize> {
        self.rows.iter().map(|row| row.line).collect()
    }

    /// Brings tool poses of a part into the workpiece frame, in which it lies at a place.
    pub(crate) fn put(&mut self, place: &Placement) {
        for row in &mut self.rows {
            row.tip = place.point(row.tip);
            if let Aim::Axis(axis) | Aim::Axes { direction: axis, .. } = &mut row.aim {
                *axis = place.direction(*axis);
            }
            row.normal = row.normal.map(|normal| place.direction(normal));
        }
    }

    /// Returns the place of every row, reached or not.
    pub(crate) fn row_tips(&self) -> Vec<RowTip> {
        self.rows.iter().map(|row| RowTip { line: row.line, tip_mm: row.tip.into() }).collect()
    }

    /// Returns the tips of all rows, mm, workpiece frame.
    pub(crate) fn tips(&self) -> Vec<[f64; 3]> {
        self.rows.iter().map(|row| row.tip.into()).collect()
    }

    /// Returns poses of the tool, as the nominal `machine` holds it; the file may give positions of its rotary axes.
    pub(crate) fn list(&self, machine: &Machine) -> Vec<ToolPose> {
        self.rows.iter().map(|row| row.tool_pose(machine)).collect()
    }

    fn found(&self, machine: &Machine) -> Vec<Result<Pose, Miss>> {
        if let Some(poses) = self.axes() {
            return poses.into_iter().cloned().map(Ok).collect();
        }
        // The header decides: all rows give positions of rotary axes, or none does.
        let Some(rows) = self.rows.iter().map(Row::rotary).collect::<Option<Vec<_>>>() else {
            return solve(machine, &self.list(machine), self.is_path);
        };
        let at_rest = rest(machine);
        rows.into_par_iter().map(|(tip, rotary)| placed(machine, tip, rotary, &at_rest)).collect()
    }

    /// Returns the poses of a machine for all rows that it reaches. Reports the others; refuses a file without a
    /// reachable row.
    pub(crate) fn reached(&self, call: &mut Call<'_>, machine: &Machine) -> Result<ReachedToolPoses, Refused> {
        let reached = self.examine(machine);
        self.say(call, machine, &reached.rows)?;
        call.extend(reached.path.as_ref().and_then(|path| path.warning(machine)));
        check(call, machine, &reached.poses)?;
        Ok(reached)
    }

    /// Returns the poses of a machine for all rows that it reaches, of which there may be none.
    pub(crate) fn examine(&self, machine: &Machine) -> ReachedToolPoses {
        let found = self.found(machine);
        let travel = needed_travel(machine, &Needs::of(found.iter().map(Result::as_ref)));
        let missed: Vec<_> =
            found.iter().enumerate().filter_map(|(i, pose)| Some((i, pose.as_ref().err()?.clone()))).collect();
        let rows = self.missed(machine, &missed);
        let path = self.events(machine, &found).map(|events| PathResult::new(machine, &events, &self.lines()));
        let name = |row: &Row| (row.line, row.feature.clone());
        let lines = self.rows.iter().zip(&found).filter(|(_, pose)| pose.is_ok()).map(|(row, _)| name(row)).collect();
        let held = self.rows.iter().zip(&found).filter(|(_, pose)| pose.is_ok());
        let surface = held.map(|(row, _)| row.surface_point(machine)).collect();
        let poses: Vec<Pose> = found.into_iter().filter_map(Result::ok).collect();
        let unreachable = UnreachableCount::count(missed.iter().map(|(_, miss)| miss));
        let (file, asked, reached) = (self.file.clone(), self.rows.len(), poses.len());
        let of_axes = self.are_axes();
        ReachedToolPoses { file, of_axes, asked, reached, unreachable, rows, travel, path, poses, lines, surface }
    }

    /// Returns the events of the rows on a machine that takes them by these poses, if they are one path.
    fn events(&self, machine: &Machine, found: &[Result<Pose, Miss>]) -> Option<PathEvents> {
        self.is_path.then(|| path_events(machine, &self.list(machine), found))
    }

    /// Returns the pose of a machine for each row, `None` where it is out of reach, and the number of rewinds of a
    /// path.
    pub(crate) fn solved(&self, machine: &Machine) -> (Vec<Option<Pose>>, Option<usize>) {
        let found = self.found(machine);
        let rewinds = self.events(machine, &found).map(|events| events.rewinds.len());
        (found.into_iter().map(Result::ok).collect(), rewinds)
    }

    /// True if the rows give positions of rotary axes.
    pub(crate) fn gives_rotary(&self) -> bool {
        self.rows.iter().any(|row| row.rotary().is_some())
    }

    /// True if the rows are one path.
    pub(crate) fn is_path(&self) -> bool {
        self.is_path
    }

    /// Returns the lines of rows that were missed, with what they lack.
    pub(crate) fn missed(&self, machine: &Machine, missed: &[(usize, Miss)]) -> Vec<MissedToolPose> {
        let aim = |(i, miss): &(usize, Miss)| match &self.rows[*i].aim {
            Aim::Axis(direction) if miss.why == Unreachable::Direction => Some(*direction),
            _ => None,
        };
        let gaps = DirectionGaps::new(machine, missed.iter().filter_map(aim));
        let of = |at: &(usize, Miss)| {
            let row = &self.rows[at.0];
            let off_deg = aim(at).map(|direction| gaps.degrees(&direction));
            MissedToolPose::new(machine, (row.line, row.feature.clone()), &at.1, off_deg)
        };
        missed.iter().map(of).collect()
    }

    /// Reports the rows that a machine does not reach, in one warning; all of them are refused.
    pub(crate) fn say(&self, call: &mut Call<'_>, machine: &Machine, missed: &[MissedToolPose]) -> Result<(), Refused> {
        if let Some(first) = missed.first() {
            let told = missed::told(machine, missed, self.rows.len());
            let place = self.rows.iter().find(|row| row.line == first.line).map(|row| row.place.clone());
            let told = told.at(place, format!("the first of them: {}", first.words()));
            if missed.len() == self.rows.len() {
                return call.refuse(told);
            }
            call.warn(told);
        }
        call.check()
    }
}

/// Returns the pose for a tip (mm) with the rotary axes as given (deg).
fn placed(machine: &Machine, tip: &Vector3<f64>, rotary: &[f64], at_rest: &[f64]) -> Result<Pose, Miss> {
    let start = machine.axes().iter().zip(rotary).zip(at_rest);
    let pose: Pose =
        start.map(|((axis, turned), rest)| if axis.kind == AxisKind::Rotary { *turned } else { *rest }).collect();
    let placed = place(machine, tip, &pose)?;
    if machine.beyond_travel(&placed).next().is_some() { Err(Miss::travel(placed)) } else { Ok(placed) }
}

fn wrong(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0817, message)
}
