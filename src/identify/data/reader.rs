//! From a file of measurements to rows: cells to numbers, then what needs the other rows of a run.

use super::coarse::{Coarse, CoarseSights, StationSight};
use super::columns::{Content, LengthKind, MeasurementColumn, RowForm, columns, pose_columns};
use super::draft::{Draft, PointPoses, runs, weight};
use super::failure::RowFailure;
use super::measurement::{
    DistanceEnd, InstrumentUnknown, Measurement, MeasurementSet, Reading, SetExtent, TurnKind, lever,
};
use super::station::{self, StationFailure};
use super::touches::{Touch, TouchUnknowns};
use super::tracker::{self, InstrumentFrame, PointColumns};
use super::turns::{self, SeenTurn};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, codes, did_you_mean, shown};
use crate::evaluate::Frame;
use crate::identify::lists::index_of;
use crate::identify::thresholds::MIN_LENGTH_MM;
use crate::job::poses::other_units;
use crate::lower::NominalPose;
use crate::machine::{Approach, Machine};
use crate::syntax::Files;
use crate::syntax::sheet::{self, Decimals, SheetLine, read_sheet};
use crate::units::{FARTHEST, counted};
use nalgebra::Vector3;
use std::path::{Path, PathBuf};

/// Mistakes after which the rest of a file is of the same kind.
const MAX_MISTAKES: usize = 5;
/// Least length of a direction.
const MIN_NORMAL: f64 = 1e-9;
/// Maximum number of names that a warning lists.
const MAX_LISTED: usize = 5;
/// Reads files of measurements of one machine, and collects rows and unknowns.
struct MeasurementReader<'a> {
    machine: &'a Machine,
    machines: Vec<Machine>,
    frame: Frame,
    is_plan: bool,
    /// Name of the file in the names of unknowns; empty if there is only one.
    file: String,
    form: RowForm,
    data: MeasurementSet,
    poses: Option<PointPoses>,
    /// True if a file has points by name.
    has_points: bool,
}

/// Frame and poses of readings, which their own columns do not state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadingContext {
    /// Frame of deviations.
    pub frame: Frame,
    /// The table of the poses at which points of a tracker were measured.
    pub axis_poses: Option<PathBuf>,
    /// True if the rows are readings that could be taken: their cells are empty, and count as read.
    pub is_plan: bool,
}

/// Reads files of measurements; whatever is wrong with one is reported, and it adds nothing.
pub fn read_measurements(
    paths: &[impl AsRef<Path>],
    machine: &Machine,
    context: &ReadingContext,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> MeasurementSet {
    let with = |name: &str| machine.with_tool(name).unwrap_or_else(|| machine.clone());
    let machines = machine.tools().iter().map(|tool| with(&tool.name)).collect();
    let mut reader = MeasurementReader {
        machine,
        machines,
        frame: context.frame,
        is_plan: context.is_plan,
        file: String::new(),
        form: RowForm::Position,
        data: MeasurementSet::default(),
        poses: None,
        has_points: false,
    };
    if let Some(path) = &context.axis_poses {
        let Some(poses) = reader.read_poses(path, files, diagnostics) else { return reader.data };
        reader.poses = Some(poses);
    }
    for path in paths {
        let stem = path.as_ref().file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        reader.file = if paths.len() > 1 { format!("{}/", shown(&stem)) } else { String::new() };
        reader.read(path.as_ref(), files, diagnostics);
    }
    if reader.poses.is_some() && !reader.has_points && !diagnostics.is_refused() {
        let message = "no file of measurements has points by name, whose poses are given".to_owned();
        diagnostics.push(points_refusal(message, None));
    }
    reader.data
}

const COLUMNS: &str = "a measurement file has a column for each axis (mm, deg), and `dx [um]`, `dy [um]`, `dz [um]`, \
    or another kind of reading: `rel.dx [um]`, `ball`, `feature`, `tracker.x [mm]`, `length [mm]`, \
    `displacement [mm]`, `dl [um]`, `along [um]`, `da [urad]`, `level.a [um/m]`, `EXX [um]`; optionally \
    `tool`, `run`, `approach`, `weight` or `u [um]`";
const POINTS: &str = "an export of points has columns such as `point`, `X [mm]`, `Y [mm]`, `Z [mm]`; `--axis-poses \
    FILE` has their poses: a column for each axis, and `point`, or a row for each point in their order";
const ROWS: &str =
    "correct the row, or leave it out; of several readings in a row those that were not taken stay empty";

fn refusal(code: codes::Code, message: String, place: Option<Place>) -> Diagnostic {
    let help = match code {
        codes::E0505 => {
            "give its approximate place, from the workpiece origin, in columns `station.x [mm]`, `station.y [mm]`, \
             `station.z [mm]`"
        }
        codes::E0506 => {
            "leave the row out, or correct its pose: a length has a direction only between different points"
        }
        codes::E0507 => {
            "a line needs at least two poses in different places, and every run of a laser is a `run` of its own"
        }
        _ => COLUMNS,
    };
    Diagnostic::new(code, message).at(place, "").help(help)
}

fn points_refusal(message: String, place: Option<Place>) -> Diagnostic {
    Diagnostic::new(codes::E0501, message).at(place, "").help(POINTS)
}

impl MeasurementReader<'_> {
    fn read(&mut self, path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) {
        let Some(sheet) = read_sheet(path, files, diagnostics) else { return };
        let mut lines = sheet.each_line().peekable();
        let Some(header) = lines.next() else {
            let name = shown(&path.display().to_string());
            diagnostics.push(refusal(codes::E0501, format!("the file `{name}` is empty"), None));
            return;
        };
        let separator = sheet::separator(&header.text);
        let (columns, form) = match columns(self.machine, &header.text, separator) {
            Ok(found) => found,
            Err(failure) => {
                let lines = sheet.lines();
                match tracker::recognise(&lines) {
                    Some(points) => self.read_points(&points, &lines, diagnostics),
                    None => diagnostics.push(refusal(codes::E0501, failure.to_string(), Some(header.place.clone()))),
                }
                return;
            }
        };
        self.form = form;
        if lines.peek().is_none() {
            let message = "the file has a header and no measurements".to_owned();
            diagnostics.push(refusal(codes::E0501, message, Some(header.place.clone())));
        }
        let (before, from) = (self.data.extent(), self.data.rows.len());
        let drafts = self.body(&columns, lines, separator, diagnostics);
        self.add(before, drafts, diagnostics);
        let read = self.data.rows.get(from..).unwrap_or_default().iter().map(|row| &row.pose);
        let warned = other_units(self.machine, &sheet::cells(&header.text, separator), read, &Some(header.place));
        warned.into_iter().for_each(|warning| diagnostics.push(warning));
    }

    /// Takes the rows of a file, all or none.
    fn add(&mut self, before: SetExtent, drafts: Option<Vec<Draft>>, diagnostics: &mut Diagnostics) {
        let added =
            drafts.is_some_and(|drafts| self.rows(drafts).map_err(|refused| diagnostics.push(*refused)).is_ok());
        if !added {
            self.data.truncate(before);
        }
    }

    /// Reads the poses of points: a table as for readings, which has none.
    fn read_poses(&mut self, path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<PointPoses> {
        let sheet = read_sheet(path, files, diagnostics)?;
        let mut lines = sheet.each_line().peekable();
        let header = lines.next().filter(|_| lines.peek().is_some());
        let Some(header) = header else {
            diagnostics.push(refusal(codes::E0501, "the table of poses is empty".to_owned(), Some(sheet.start())));
            return None;
        };
        let separator = sheet::separator(&header.text);
        let columns = match pose_columns(self.machine, &header.text, separator) {
            Ok(columns) => columns,
            Err(failure) => {
                diagnostics.push(points_refusal(failure.to_string(), Some(header.place.clone())));
                return None;
            }
        };
        let drafts = self.body(&columns, lines, separator, diagnostics)?;
        let has_names = columns.iter().any(|column| column.content == Content::Point);
        let mut names = std::collections::BTreeSet::new();
        for draft in &drafts {
            let mut refuse = |message: String| diagnostics.push(points_refusal(message, Some(draft.row.place.clone())));
            if draft.row.readings() > 0 || !draft.errors.is_empty() {
                refuse("a table of poses has no readings".to_owned());
                return None;
            }
            if has_names && !names.insert(&draft.point) {
                refuse(format!("the point `{}` has two poses", shown(&draft.point)));
                return None;
            }
        }
        Some(PointPoses { drafts, has_names })
    }

    fn read_points(&mut self, columns: &PointColumns, lines: &[SheetLine], diagnostics: &mut Diagnostics) {
        let first = lines.first().map(|line| line.place.clone());
        let mut refuse = |message: String, place: Option<Place>| diagnostics.push(points_refusal(message, place));
        let Some(poses) = &self.poses else {
            return refuse("these are points by name, without the poses at which they were measured".to_owned(), first);
        };
        let points = match columns.points(lines) {
            Ok(points) => points,
            Err(failure) => return refuse(failure.to_string(), failure.place()),
        };
        let drafts = match poses.of(points) {
            Ok((drafts, unknown)) => {
                let (columns, points) = (&columns.left_out, &unknown);
                for (names, what, code) in [(columns, "column", codes::W0511), (points, "point", codes::W0504)] {
                    left_out(names, what, code, &first).into_iter().for_each(|one| diagnostics.push(one));
                }
                drafts
            }
            Err(failure) => return refuse(failure.to_string(), first),
        };
        self.has_points = true;
        self.form = RowForm::Position;
        let before = self.data.extent();
        self.add(before, Some(drafts), diagnostics);
    }

    /// Reads the rows of a file. Those that stand for themselves are added at once: there may be millions. Returns
    /// those that wait for the others of their run; `None` after a mistake.
    fn body(
        &mut self,
        columns: &[MeasurementColumn],
        lines: impl Iterator<Item = SheetLine>,
        separator: char,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Draft>> {
        let (mut drafts, mut mistakes, mut decimals) = (Vec::new(), 0, Decimals::default());
        let has_turns = columns.iter().any(|column| matches!(column.content, Content::Turn(..)));
        for line in lines {
            match self.draft(columns, &line, separator, &mut decimals) {
                Ok(draft) if self.form == RowForm::Deviation && !has_turns => self.data.rows.push(draft.row),
                Ok(draft) if self.form == RowForm::Error => self.errors(draft),
                Ok(draft) => drafts.push(draft),
                Err(failure) if mistakes < MAX_MISTAKES => {
                    mistakes += 1;
                    let refusal = Diagnostic::new(codes::E0501, failure.to_string());
                    diagnostics.push(refusal.at(Some(line.place.clone()), "").help(ROWS));
                }
                Err(_) => break,
            }
        }
        (mistakes == 0).then_some(drafts)
    }

    fn blank(&self, place: Place) -> Draft {
        let tool = self.machine.tools().iter().position(|tool| tool.name == self.machine.tool().name);
        let reading = Reading::Deviation { values: [None; 3], frame: self.frame, zero: [None; 3] };
        let nowhere = vec![0.0; self.machine.axes().len()];
        let row = Measurement { tool: tool.unwrap_or_default(), ..Measurement::new(nowhere, reading, place) };
        Draft {
            row,
            to: None,
            length: None,
            along: 0.0,
            errors: Vec::new(),
            angles: None,
            station: None,
            at: [None; 3],
            known: None,
            ball: String::new(),
            feature: String::new(),
            normal: [0.0; 3],
            tracker: [None; 3],
            turn: [None; 3],
            point: String::new(),
        }
    }

    fn draft(
        &self,
        columns: &[MeasurementColumn],
        line: &SheetLine,
        separator: char,
        decimals: &mut Decimals,
    ) -> Result<Draft, RowFailure> {
        let mut cells = sheet::cells(&line.text, separator);
        sheet::drop_empty(&mut cells, columns.len());
        if cells.len() != columns.len() {
            return Err(RowFailure::Cells(cells.len(), columns.len()));
        }
        let mut number = |cell: &str| {
            decimals.note(cell, separator).map_err(RowFailure::Decimals)?;
            let empty = |failure| if cell.is_empty() { RowFailure::EmptyCell } else { RowFailure::Number(failure) };
            sheet::number(cell, separator).map_err(empty)
        };
        let mut draft = self.blank(line.place.clone());
        let mut to: Vec<(usize, f64)> = Vec::new();
        let mut values = [None; 3];
        for (cell, MeasurementColumn { content, factor }) in cells.iter().zip(columns) {
            let mut scaled = || Ok(number(cell)? * factor);
            if self.is_plan && content.is_reading() {
                if !cell.is_empty() {
                    return Err(RowFailure::ReadingInPlan(cell.clone()));
                }
                draft.plan(content, &mut values);
                continue;
            }
            match *content {
                Content::Axis(axis) => draft.row.pose[axis] = scaled()?,
                Content::To(axis) => to.push((axis, scaled()?)),
                // Not measured.
                Content::Deviation(_)
                | Content::Relative(_)
                | Content::Turn(..)
                | Content::Error(..)
                | Content::Tool
                    if cell.is_empty() => {}
                Content::Turn(_, k) => draft.turn[k] = Some(turns::small(scaled()?, cell)?),
                Content::Deviation(k) | Content::Relative(k) => values[k] = Some(near(scaled()?, cell)?),
                Content::Error(source, approach) => {
                    draft.errors.push((source, approach.unwrap_or_default(), near(scaled()?, cell)?));
                }
                Content::Ball => draft.ball = cell.clone(),
                Content::Feature => draft.feature = cell.clone(),
                Content::Normal(k) => draft.normal[k] = near(number(cell)?, cell)?,
                Content::Beyond => draft.along = near(scaled()?, cell)?,
                Content::Tracker(k) => draft.tracker[k] = Some(near(scaled()?, cell)?),
                Content::Point => draft.point = cell.clone(),
                Content::Length(kind @ LengthKind::Whole) => {
                    let length = positive(number(cell)?, cell, "length")? * factor;
                    draft.length = Some((kind, near(length, cell)?));
                }
                Content::Length(kind) => draft.length = Some((kind, near(scaled()?, cell)?)),
                Content::Along => draft.along = near(scaled()?, cell)?,
                Content::Station => draft.station = Some(cell.clone()),
                Content::PlaceUncertainty(_) => {
                    draft.known = Some(positive(number(cell)?, cell, "uncertainty")? * factor);
                }
                Content::StationAt(k) | Content::BallAt(k) => draft.at[k] = Some(near(scaled()?, cell)?),
                Content::Tool => draft.row.tool = tool_index(self.machine, cell)?,
                Content::Weight => draft.row.weight = weight(positive(number(cell)?, cell, "weight")?, cell)?,
                Content::Uncertainty(quantity) => {
                    draft.uncertain(quantity, positive(number(cell)?, cell, "uncertainty")? * factor, cell)?;
                }
                Content::Run => draft.row.run = Some(cell.clone()),
                Content::Approach => draft.row.approach = approach(cell)?,
            }
        }
        draft.row.reading = Reading::Deviation { values, frame: self.frame, zero: [None; 3] };
        if !to.is_empty() {
            let mut pose = draft.row.pose.clone();
            to.into_iter().for_each(|(axis, q)| pose[axis] = q);
            draft.to = Some(pose);
        }
        if self.form == RowForm::Touch && Vector3::from(draft.normal).norm() < MIN_NORMAL {
            return Err(RowFailure::NoNormal);
        }
        let nothing = match self.form {
            RowForm::Deviation | RowForm::Relative | RowForm::Turn(_) => {
                draft.row.readings() == 0 && draft.turn == [None; 3]
            }
            RowForm::Error => draft.errors.is_empty(),
            _ => false,
        };
        if nothing { Err(RowFailure::NoReading) } else { Ok(draft) }
    }

    /// Returns the nominal functional point of a row, from the workpiece origin.
    fn nominal(&self, row: &Measurement, pose: &[f64]) -> Vector3<f64> {
        NominalPose::in_part(&self.machines[row.tool], pose).pose.translation
    }

    fn rows(&mut self, drafts: Vec<Draft>) -> Result<(), Box<Diagnostic>> {
        let (before, has_turns) = (self.data.rows.len(), drafts.iter().any(|draft| draft.turn != [None; 3]));
        self.turns(&drafts);
        let read = |draft: &Draft| draft.row.readings() > 0;
        match self.form {
            RowForm::Error | RowForm::Turn(_) => {}
            RowForm::Deviation => self.data.rows.extend(drafts.into_iter().filter(read).map(|draft| draft.row)),
            RowForm::Relative if has_turns => self.relative(drafts.into_iter().filter(read).collect()),
            RowForm::Relative => self.relative(drafts),
            RowForm::Ball => self.balls(drafts)?,
            RowForm::Along => self.lines(drafts)?,
            RowForm::Touch => self.touches(drafts),
            RowForm::Position => self.positions(drafts)?,
            RowForm::Distance if drafts.iter().any(|draft| draft.to.is_some()) => self.pairs(drafts)?,
            RowForm::Distance => self.stations(drafts)?,
        }
        if has_turns {
            // Position and rotation of a row stand together.
            self.data.rows[before..].sort_by_key(|row| row.place.range.start);
        }
        Ok(())
    }

    /// Adds orientations. Beside deviations they are in the frame of these.
    fn turns(&mut self, drafts: &[Draft]) {
        let (of, frame) = match self.form {
            RowForm::Turn(TurnKind::Axis) => (TurnKind::Axis, Frame::Tool),
            RowForm::Turn(of @ (TurnKind::Level | TurnKind::Collimator)) => (of, Frame::Machine),
            _ => (TurnKind::Rotation, self.frame),
        };
        let (machines, tools) = (&self.machines, self.machine.tools());
        let seen = |draft: &Draft| SeenTurn {
            machine: &machines[draft.row.tool],
            row: Measurement { weight: draft.angles.unwrap_or(draft.row.weight), ..draft.row.clone() },
            values: draft.turn,
            tool: NominalPose::in_part(&machines[draft.row.tool], &draft.row.pose),
        };
        let read = drafts.iter().filter(|draft| draft.turn != [None; 3]);
        let runs = runs(read.cloned().collect(), |_| String::new());
        let name = format!("{}{}", self.file, of.label());
        let runs = runs.into_iter().map(|(run, drafts)| (run, drafts.iter().map(seen).collect())).collect();
        let of_tool = |tool: usize| if tools.len() > 1 { format!(" {}", tools[tool].name) } else { String::new() };
        turns::add(&mut self.data, of, frame, self.form != RowForm::Deviation, &name, runs, &of_tool);
    }

    fn errors(&mut self, draft: Draft) {
        for (source, approach, value) in draft.errors {
            let approach = if approach == Approach::Mean { draft.row.approach } else { approach };
            let reading = Reading::Error { value: value * lever(source.direction), source };
            let own = if source.direction.is_rotation() { draft.angles } else { None };
            let weight = own.unwrap_or(draft.row.weight);
            self.data.rows.push(Measurement { reading, approach, weight, ..draft.row.clone() });
        }
    }

    /// Adds readings relative to the first of their run, whose deviation is an unknown of the run.
    fn relative(&mut self, drafts: Vec<Draft>) {
        for (run, drafts) in runs(drafts, |_| String::new()) {
            let name = format!("{}first{}", self.file, run);
            let read = std::array::from_fn(|k| drafts.iter().any(|draft| draft.row.reading_mask()[k]));
            let first = self.data.unknown_components(&name, read);
            for mut draft in drafts {
                if let Reading::Deviation { zero, .. } = &mut draft.row.reading {
                    *zero = first;
                }
                self.data.rows.push(draft.row);
            }
        }
    }

    /// Adds readings of a ball on the workpiece that the functional point was brought to: the actual point is the same
    /// in all poses of a run.
    fn balls(&mut self, drafts: Vec<Draft>) -> Result<(), Box<Diagnostic>> {
        let mut names = Vec::new();
        let balls: Vec<usize> =
            drafts.iter().map(|d| index_of(&mut names, (d.ball.clone(), d.row.run.clone()))).collect();
        let name = format!("{}balls", self.file);
        let mixed_up = self.mixed_up(&name, &drafts.iter().collect::<Vec<_>>(), CoarseSights::Balls(&balls));
        mixed_up.map_or(Ok(()), Err)?;
        for (run, drafts) in runs(drafts, |draft| draft.ball.clone()) {
            let zero = self.data.unknown_components(&format!("{}ball{run}", self.file), [true; 3]);
            let Some(head) = drafts.first() else { continue };
            if drafts.iter().any(|draft| draft.at != head.at || draft.known != head.known) {
                let message = format!("the ball{run} has two places, or two uncertainties: give it two names");
                return Err(Box::new(refusal(codes::E0501, message, Some(head.row.place.clone()))));
            }
            let first = match head.at {
                [Some(x), Some(y), Some(z)] => Vector3::new(x, y, z),
                _ => self.nominal(&head.row, &head.row.pose),
            };
            if let Some(index) = zero[0] {
                self.data.know_point(index, head.known);
                (0..3).for_each(|k| self.data.nuisances[index + k].base = first[k]);
            }
            for mut draft in drafts {
                let off = first - self.nominal(&draft.row, &draft.row.pose);
                let values = [Some(off.x), Some(off.y), Some(off.z)];
                draft.row.reading = Reading::Deviation { values, frame: Frame::Workpiece, zero };
                self.data.rows.push(draft.row);
            }
        }
        Ok(())
    }

    /// Returns a refusal of readings that something mixed up explains, where they are far off their poses.
    fn mixed_up(&self, name: &str, drafts: &[&Draft], sights: CoarseSights<'_>) -> Option<Box<Diagnostic>> {
        let row = |i: usize| drafts[i].row.clone();
        let coarse = Coarse::new(self.machine, &self.machines, drafts.len(), &row, sights);
        let place = drafts.first().map(|draft| draft.row.place.clone());
        if self.is_plan { None } else { coarse.explained(name, place).map(Box::new) }
    }

    /// Adds positions in the frame of an instrument, whose displacement and rotation are six unknowns of the run.
    fn positions(&mut self, drafts: Vec<Draft>) -> Result<(), Box<Diagnostic>> {
        for (run, drafts) in runs(drafts, |_| String::new()) {
            let nominal: Vec<Vector3<f64>> = drafts.iter().map(|d| self.nominal(&d.row, &d.row.pose)).collect();
            let read = |draft: &Draft| Vector3::from(draft.tracker.map(Option::unwrap_or_default));
            let measured = if self.is_plan { nominal.clone() } else { drafts.iter().map(read).collect() };
            let name = format!("{}tracker{run}", self.file);
            let fitted = InstrumentFrame::fit(&nominal, &measured).map_err(|failure| {
                let place = drafts.first().map(|draft| draft.row.place.clone());
                let mixed_up = self.mixed_up(&name, &drafts.iter().collect::<Vec<_>>(), CoarseSights::Frame(&measured));
                let message = format!("{name}: {failure}");
                let plain = || Diagnostic::new(codes::E0501, message).at(place, "").help(failure.help());
                mixed_up.unwrap_or_else(|| Box::new(plain()))
            })?;
            let frame = self.data.unknown_frame(&name);
            for ((mut draft, nominal), measured) in drafts.into_iter().zip(nominal).zip(measured) {
                let value = fitted.in_workpiece(&measured) - nominal;
                draft.row.reading = Reading::Position { value, about: fitted.about, frame };
                self.data.rows.push(draft.row);
            }
        }
        Ok(())
    }

    /// Returns the line of a run goes from its first pose to the one farthest from it.
    fn lines(&mut self, drafts: Vec<Draft>) -> Result<(), Box<Diagnostic>> {
        for (run, drafts) in runs(drafts, |_| String::new()) {
            let points: Vec<Vector3<f64>> = drafts.iter().map(|d| self.nominal(&d.row, &d.row.pose)).collect();
            let from = |p: &Vector3<f64>| points.first().map_or_else(Vector3::zeros, |first| p - first);
            let far = points
                .iter()
                .map(from)
                .fold(Vector3::zeros(), |a: Vector3<f64>, b| if b.norm() > a.norm() { b } else { a });
            if far.norm() < MIN_LENGTH_MM {
                let message = format!("the poses of this run{run} are in one place: they have no line");
                return Err(Box::new(refusal(codes::E0507, message, drafts.first().map(|d| d.row.place.clone()))));
            }
            let zero = self.data.unknown(format!("{}zero{run}", self.file), 0.0);
            for mut draft in drafts {
                draft.row.reading = Reading::Along {
                    value: draft.along,
                    direction: far.normalize(),
                    less: vec![(zero, 1.0)],
                    is_touch: false,
                };
                self.data.rows.push(draft.row);
            }
        }
        Ok(())
    }

    /// Adds touches of features.
    fn touches(&mut self, drafts: Vec<Draft>) {
        let touch = |draft: &Draft| {
            let nominal = NominalPose::in_part(&self.machines[draft.row.tool], &draft.row.pose);
            let normal = Vector3::from(draft.normal).normalize();
            let in_tool = nominal.pose.linear.transpose() * normal;
            Touch { point: nominal.pose.translation, normal, in_tool, tool: draft.row.tool }
        };
        let is_ball = drafts.iter().any(|draft| !draft.ball.is_empty());
        let word = if is_ball { "ball" } else { "feature" };
        let groups = runs(drafts, |draft| if is_ball { draft.ball.clone() } else { draft.feature.clone() });
        let (mut features, mut list): (Vec<(String, Vec<usize>)>, Vec<Draft>) = (Vec::new(), Vec::new());
        for (name, drafts) in groups {
            features.push((format!("{}{word}{name}", self.file), (list.len()..list.len() + drafts.len()).collect()));
            list.extend(drafts);
        }
        let touches: Vec<Touch> = list.iter().map(touch).collect();
        let (tools, file) = (self.machine.tools(), &self.file);
        let of_tool = |tool: usize| if tools.len() > 1 { format!(" {}", tools[tool].name) } else { String::new() };
        let found = TouchUnknowns::of(&touches, &features, is_ball, &of_tool);
        let first = self.data.nuisances.len();
        let named = found.list.into_iter().map(|unknown| match unknown.name.starts_with("touch") {
            true => InstrumentUnknown { name: format!("{file}{}", unknown.name), ..unknown },
            false => unknown,
        });
        self.data.nuisances.extend(named);
        for (((mut draft, touch), shares), nominal) in
            list.into_iter().zip(touches).zip(found.shares).zip(found.nominal)
        {
            let less = shares.into_iter().map(|(index, share)| (first + index, share)).collect();
            // The actual point is where feature and probe have it: as much as the nominal one is off, it deviates.
            let value = draft.along - nominal;
            draft.row.reading = Reading::Along { value, direction: touch.normal, less, is_touch: true };
            self.data.rows.push(draft.row);
        }
    }

    /// Adds distances between two poses of the functional point.
    fn pairs(&mut self, drafts: Vec<Draft>) -> Result<(), Box<Diagnostic>> {
        for (run, drafts) in runs(drafts, |_| String::new()) {
            let mut lengths = Vec::new();
            for draft in &drafts {
                let to = draft.to.as_ref().unwrap_or(&draft.row.pose);
                let way = self.nominal(&draft.row, to) - self.nominal(&draft.row, &draft.row.pose);
                lengths.push(long_enough(way.norm(), &draft.row)?);
            }
            let zero = self.constant(&run, &drafts, &lengths);
            for (draft, nominal) in drafts.into_iter().zip(lengths) {
                let from = DistanceEnd::Pose(draft.to.clone().unwrap_or_default());
                self.push_distance(draft, nominal, from, zero);
            }
        }
        Ok(())
    }

    /// Adds distances from stations, whose coordinates are unknowns.
    fn stations(&mut self, drafts: Vec<Draft>) -> Result<(), Box<Diagnostic>> {
        let mut groups: Vec<(String, Vec<Draft>)> = Vec::new();
        for draft in drafts {
            let name = draft.station.clone().unwrap_or_default();
            match groups.iter_mut().find(|(known, _)| *known == name) {
                Some((_, group)) => group.push(draft),
                None => groups.push((name, vec![draft])),
            }
        }
        self.sights_mixed_up(&groups)?;
        for (name, drafts) in groups {
            let label = if name.is_empty() { "station".to_owned() } else { format!("station {}", shown(&name)) };
            let place = drafts.first().map(|draft| draft.row.place.clone());
            let at = self
                .place(&drafts)
                .map_err(|failure| Box::new(refusal(codes::E0505, format!("{label}: {failure}"), place)))?;
            let first = self.data.unknown_point(&format!("{}{label}", self.file), at);
            self.data.know_point(first, drafts.first().and_then(|draft| draft.known));
            for (run, drafts) in runs(drafts, |_| String::new()) {
                let distance = |draft: &Draft| (self.nominal(&draft.row, &draft.row.pose) - at).norm();
                let nominal: Vec<f64> = drafts.iter().map(distance).collect();
                for (draft, length) in drafts.iter().zip(&nominal) {
                    long_enough(*length, &draft.row)?;
                }
                let zero = self.constant(&format!(" {label}{run}"), &drafts, &nominal);
                for (draft, nominal) in drafts.into_iter().zip(nominal) {
                    self.push_distance(draft, nominal, DistanceEnd::Station(first), zero);
                }
            }
        }
        Ok(())
    }

    /// Refuses distances from stations that something mixed up explains, where they are far off their poses.
    fn sights_mixed_up(&self, groups: &[(String, Vec<Draft>)]) -> Result<(), Box<Diagnostic>> {
        let mut runs: Vec<Option<&String>> = Vec::new();
        let (mut rows, mut sights) = (Vec::new(), Vec::new());
        let mut all: Vec<(usize, &Draft)> =
            groups.iter().enumerate().flat_map(|(k, group)| group.1.iter().map(move |d| (k, d))).collect();
        all.sort_by_key(|(_, draft)| draft.row.place.range.start);
        for (station, draft) in all {
            let Some((kind, value)) = draft.length else { return Ok(()) };
            let run = match kind {
                LengthKind::Whole => None,
                LengthKind::Displacement => Some(index_of(&mut runs, draft.row.run.as_ref())),
                LengthKind::FromNominal => return Ok(()),
            };
            rows.push(draft);
            sights.push(StationSight { station, value, run });
        }
        let name = format!("{}lengths", self.file);
        self.mixed_up(&name, &rows, CoarseSights::Stations(&sights)).map_or(Ok(()), Err)
    }

    /// Returns the approximate place of a station: from the file, or by its own distances.
    fn place(&self, drafts: &[Draft]) -> Result<Vector3<f64>, StationFailure> {
        let Some(first) = drafts.first() else { return Ok(Vector3::zeros()) };
        if let [Some(x), Some(y), Some(z)] = first.at {
            if drafts.iter().any(|draft| draft.at != first.at || draft.known != first.known) {
                return Err(StationFailure::TwoPlaces);
            }
            return Ok(Vector3::new(x, y, z));
        }
        if self.is_plan {
            return Err(StationFailure::Planned);
        }
        let mut names: Vec<Option<&String>> = Vec::new();
        let rows = drafts.iter().map(|draft| {
            let run = draft.row.run.as_ref();
            let index = index_of(&mut names, run);
            let (length, value) = draft.length.unwrap_or((LengthKind::Whole, 0.0));
            let point = self.nominal(&draft.row, &draft.row.pose);
            station::Sight { point, value, run: (length == LengthKind::Displacement).then_some(index) }
        });
        let rows: Vec<station::Sight> = rows.collect();
        station::place(&rows)
    }

    /// Returns the unknown constant of displacements.
    fn constant(&mut self, run: &str, drafts: &[Draft], nominal: &[f64]) -> Option<usize> {
        let first = drafts.first().and_then(|draft| draft.length)?;
        if first.0 != LengthKind::Displacement {
            return None;
        }
        let off = drafts.iter().zip(nominal).map(|(d, n)| n - d.length.map_or(0.0, |(_, value)| value));
        let start = off.sum::<f64>() / drafts.len().max(1) as f64;
        Some(self.data.unknown(format!("{}constant{run}", self.file), start))
    }

    fn push_distance(&mut self, draft: Draft, nominal: f64, from: DistanceEnd, zero: Option<usize>) {
        let (kind, value) = draft.length.unwrap_or((LengthKind::Whole, 0.0));
        let value = if kind == LengthKind::FromNominal { nominal + value } else { value };
        self.data.rows.push(Measurement { reading: Reading::Distance { value, from, zero }, ..draft.row });
    }
}

/// Returns a warning of columns or points that are not used.
fn left_out(names: &[String], what: &str, code: codes::Code, place: &Option<Place>) -> Option<Diagnostic> {
    let list: Vec<String> = names.iter().take(MAX_LISTED).map(|name| format!("`{}`", shown(name))).collect();
    let more = if names.len() > MAX_LISTED { " ..." } else { "" };
    let message = format!("{} left out: {}{more}", counted(names.len(), what), list.join(", "));
    (!names.is_empty()).then(|| Diagnostic::new(code, message).at(place.clone(), "").help(POINTS))
}

fn long_enough(length: f64, row: &Measurement) -> Result<f64, Box<Diagnostic>> {
    if length >= MIN_LENGTH_MM {
        return Ok(length);
    }
    let message = format!("the two ends of this length are {} mm apart", crate::units::significant(length, 3));
    Err(Box::new(refusal(codes::E0506, message, Some(row.place.clone()))))
}

/// Refuses a length (mm) or coordinate that nobody can measure.
fn near(value: f64, cell: &str) -> Result<f64, RowFailure> {
    if value.abs() <= FARTHEST { Ok(value) } else { Err(RowFailure::Far(cell.to_owned())) }
}

fn positive(value: f64, cell: &str, quantity: &'static str) -> Result<f64, RowFailure> {
    let good = value > 0.0 && value.is_finite();
    if good { Ok(value) } else { Err(RowFailure::NotPositive(quantity, cell.to_owned())) }
}

fn approach(cell: &str) -> Result<Approach, RowFailure> {
    match cell {
        "" | "mean" => Ok(Approach::Mean),
        "+" | "forward" => Ok(Approach::Forward),
        "-" | "reverse" => Ok(Approach::Reverse),
        _ => Err(RowFailure::NotApproach(cell.to_owned())),
    }
}

fn tool_index(machine: &Machine, name: &str) -> Result<usize, RowFailure> {
    let known: Vec<&str> = machine.tools().iter().map(|tool| tool.name.as_str()).collect();
    let found = known.iter().position(|known| *known == name);
    found.ok_or_else(|| RowFailure::NoTool(name.to_owned(), did_you_mean(name, &known)))
}
