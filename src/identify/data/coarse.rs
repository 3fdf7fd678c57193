//! Readings that are far off their poses, further than errors of a machine: what was mixed up is told by the nominal
//! machine alone, before any fit.

use super::change::{AND, Change, ChangeNames, LENGTHS, SAME, Scope};
use super::change::{axes, is_reachable, lags, reposed, tools};
use super::measurement::Measurement;
use super::station::{self, Sight};
use super::tracker::InstrumentFrame;
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::identify::thresholds::{
    COARSE_BLOCK, COARSE_ROWS, MAX_ALTERNATIVES, MAX_COARSE_ALIKE, MIN_COARSE_GAIN, MIN_COARSE_MM, MIN_COARSE_POINTS,
};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine};
use crate::units::significant;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Readings that tell where the functional point is.
pub(super) struct Coarse<'a> {
    machine: &'a Machine,
    /// The machine with each of its tools.
    machines: &'a [Machine],
    sights: CoarseSights<'a>,
    /// Rows that are looked at.
    rows: Vec<Measurement>,
    /// Their indices among all rows.
    at: Vec<usize>,
    /// Number of rows that follow each other in the file.
    block: usize,
}

/// Kinds of such readings.
pub(super) enum CoarseSights<'a> {
    /// Places in the frame of an instrument (mm), one of each row.
    Frame(&'a [Vector3<f64>]),
    /// Distances from stations: of each row the index of its station, the distance (mm), and the run whose constant is
    /// missing.
    Stations(&'a [StationSight]),
    /// Balls that do not move: of each row the index of its ball.
    Balls(&'a [usize]),
}

/// A distance from a station.
pub(super) struct StationSight {
    pub station: usize,
    pub value: f64,
    pub run: Option<usize>,
}

/// Titles of the coordinates in the frame of an instrument.
const COORDINATES: [&str; 3] = ["tracker.x", "tracker.y", "tracker.z"];

/// A reading at a nominal place.
struct Seen {
    /// Row of the reading.
    row: usize,
    /// Row of the pose.
    posed: usize,
    /// mm, workpiece frame.
    point: Vector3<f64>,
}

/// A change of the poses, a change of the readings, or two.
type Changes = Vec<Change>;

impl<'a> Coarse<'a> {
    /// Prepares rows, `row` each by its index; `machines` is the machine with each of its tools.
    pub fn new(
        machine: &'a Machine,
        machines: &'a [Machine],
        count: usize,
        row: &dyn Fn(usize) -> Measurement,
        sights: CoarseSights<'a>,
    ) -> Self {
        let is_whole = count <= COARSE_ROWS;
        let block = if is_whole { count } else { COARSE_BLOCK };
        let step = if is_whole { block } else { block * count.div_ceil(COARSE_ROWS) };
        let at: Vec<usize> = (0..count).filter(|i| i % step.max(1) < block).collect();
        let rows = at.iter().map(|i| row(*i)).collect();
        Self { machine, machines, sights, rows, at, block }
    }

    /// Returns a refusal of readings that are far off their poses if a change of the data, or two, bring them back.
    pub fn explained(&self, name: &str, place: Option<Place>) -> Option<Diagnostic> {
        // Balls beside poses of the rotary axes alone are a plan, and no readings.
        let is_plan = matches!(self.sights, CoarseSights::Balls(_)) && !self.moves_along();
        let points = self.points(&[]).filter(|_| !is_plan)?;
        let (before, size) = (self.misfit(&points, &[])?, spread(&points));
        if before < MIN_COARSE_MM {
            return None;
        }
        let [singles, pairs] = self.candidates();
        let by_far = |(left, _): &(f64, Vec<Changes>)| left * MIN_COARSE_GAIN < before;
        let single = self.best(size, &singles).filter(by_far);
        let is_enough = single.as_ref().is_some_and(|(left, _)| *left < MIN_COARSE_MM);
        let pair = if is_enough { None } else { self.best(size, &pairs).filter(by_far) };
        let (left, alike) = pair.or(single)?;
        let no_row = |_: usize| String::new();
        let names = ChangeNames { machine: self.machine, instrument: &no_row, row: &no_row, components: COORDINATES };
        let words = |changes: &Changes| changes.iter().map(|change| change.words(&names)).collect::<Vec<_>>().join(AND);
        let others: String = alike.iter().skip(1).map(|other| format!("; or with {}", words(other))).collect();
        let remedies: Vec<&str> = alike.first()?.iter().map(Change::remedy).collect();
        let [left, before] = [left, before].map(|mm| significant(mm, 3));
        let message = format!(
            "the readings are suspect: {name}: with {} they are {left} mm off their poses instead of {before} (RMS)",
            words(alike.first()?)
        );
        Some(Diagnostic::new(codes::E0543, message).at(place, "").help(format!("{}{others}", remedies.join("; "))))
    }

    /// True if a linear axis is at different positions.
    fn moves_along(&self) -> bool {
        let moves = |i: usize| self.rows.iter().any(|row| row.pose[i] != self.rows[0].pose[i]);
        let axes = self.machine.axes().iter().enumerate();
        axes.filter(|(_, axis)| axis.kind == AxisKind::Linear).any(|(i, _)| moves(i))
    }

    /// Returns single changes and pairs of them.
    fn candidates(&self) -> [Vec<Changes>; 2] {
        let mut poses = Vec::new();
        // Balls agree the better the smaller the poses are.
        let has_units = !matches!(self.sights, CoarseSights::Balls(_));
        axes(&mut poses, self.machine, has_units);
        tools(&mut poses, self.machines.len(), &[Scope::All], &self.rows);
        poses.extend(lags());
        if let CoarseSights::Stations(sights) = self.sights {
            // A whole pose late.
            let stations = sights.iter().map(|sight| sight.station).max().map_or(0, |last| last as isize + 1);
            poses.extend([-stations, stations].into_iter().filter(|lag| lag.abs() > 2).map(Change::Rows));
        }
        let mut values = Vec::new();
        let scaled = |factor| Change::Values { from: SAME, factor, scope: Scope::All };
        if has_units {
            values.extend(LENGTHS.iter().map(|(factor, _)| scaled([*factor; 3])));
        }
        if matches!(self.sights, CoarseSights::Frame(_)) {
            values.push(Change::Hand);
            for (k, (factor, _)) in (0..3).flat_map(|k| LENGTHS.iter().map(move |unit| (k, unit))) {
                let mut one = [1.0; 3];
                one[k] = *factor;
                values.push(scaled(one));
            }
        }
        let both = |(i, first): (usize, &Change)| {
            let seconds = poses[i + 1..].iter().chain(&values);
            seconds.map(|second| vec![first.clone(), second.clone()]).collect::<Vec<_>>()
        };
        let pairs = poses.iter().enumerate().flat_map(both).collect();
        let singles = poses.iter().chain(&values).map(|change| vec![change.clone()]).collect();
        [singles, pairs]
    }

    /// Returns what the best changes leave (mm, RMS), with them and those that leave as little; `size` is how far the
    /// points are spread as the data have it.
    fn best(&self, size: f64, list: &[Changes]) -> Option<(f64, Vec<Changes>)> {
        let judge = |changes: &Changes| {
            let points = self.points(changes)?;
            // Points that are closer together are off by less, whatever is wrong.
            Some(self.misfit(&points, changes)? * (size / spread(&points)).max(1.0))
        };
        let mut found: Vec<(f64, &Changes)> =
            list.par_iter().filter_map(|changes| judge(changes).map(|left| (left, changes))).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = found.first()?.0;
        let alike = found.iter().take_while(|(left, _)| *left <= MAX_COARSE_ALIKE * least).take(1 + MAX_ALTERNATIVES);
        Some((least, alike.map(|(_, changes)| (*changes).clone()).collect()))
    }

    /// Returns the nominal places of the functional point of rows at changed poses; `None` if more of them than before
    /// are beyond a travel.
    fn points(&self, changes: &[Change]) -> Option<Vec<Seen>> {
        let mut points = Vec::with_capacity(self.rows.len());
        let is_beyond = |m: &Measurement| !is_reachable(&self.machines[m.tool], m);
        let (mut beyond, mut before) = (0, 0);
        for row in 0..self.rows.len() {
            let block = row - row % self.block;
            let neighbours = &self.rows[block..(block + self.block).min(self.rows.len())];
            let Some(m) = reposed(changes, neighbours, row - block) else { continue };
            beyond += usize::from(is_beyond(&m));
            before += usize::from(is_beyond(&self.rows[row]));
            let lag: isize = changes.iter().map(|change| if let Change::Rows(lag) = change { *lag } else { 0 }).sum();
            let posed = self.at[row].saturating_add_signed(lag);
            let point = NominalPose::in_part(&self.machines[m.tool], &m.pose).pose.translation;
            points.push(Seen { row: self.at[row], posed, point });
        }
        (beyond <= before && points.len() >= MIN_COARSE_POINTS).then_some(points)
    }

    /// Returns what the nominal places leave of the readings (mm, RMS).
    fn misfit(&self, points: &[Seen], changes: &[Change]) -> Option<f64> {
        match self.sights {
            CoarseSights::Frame(measured) => {
                let nominal: Vec<Vector3<f64>> = points.iter().map(|seen| seen.point).collect();
                let changed: Vec<Vector3<f64>> =
                    points.iter().map(|seen| changed(measured[seen.row], changes)).collect();
                (nominal.len() > 3).then(|| InstrumentFrame::best(&nominal, &changed).1)
            }
            CoarseSights::Stations(sights) => of_stations(points, sights, changes),
            CoarseSights::Balls(balls) => of_balls(points, &|row| balls[row]),
        }
    }
}

/// Returns how far points are spread about their mean (mm, RMS).
fn spread(points: &[Seen]) -> f64 {
    of_balls(points, &|_| 0).unwrap_or_default()
}

/// Returns changed coordinates, or a changed length in the first of them.
fn changed(value: Vector3<f64>, changes: &[Change]) -> Vector3<f64> {
    changes.iter().fold(value, |v, change| match change {
        Change::Values { from, factor, .. } => Vector3::from_fn(|k, _| factor[k] * v[from[k]]),
        Change::Hand => Vector3::new(-v.x, v.y, v.z),
        _ => v,
    })
}

fn of_stations(points: &[Seen], sights: &[StationSight], changes: &[Change]) -> Option<f64> {
    let mut groups: Vec<Vec<Sight>> = Vec::new();
    for Seen { row, posed, point } in points {
        let StationSight { station, run, .. } = sights[*posed];
        let value = sights[*row].value;
        groups.resize_with(groups.len().max(station + 1), Vec::new);
        let value = changed(Vector3::new(value, 0.0, 0.0), changes).x;
        groups[station].push(Sight { point: *point, value, run });
    }
    let (mut squares, mut count) = (0.0, 0_usize);
    for group in groups.iter().filter(|group| !group.is_empty()) {
        let at = station::place(group).ok()?;
        let off = |sight: &Sight| (sight.point - at).norm() - sight.value;
        let runs = group.iter().filter_map(|sight| sight.run).max().map_or(0, |last| last + 1);
        let constant = |run: usize| {
            let own: Vec<f64> = group.iter().filter(|sight| sight.run == Some(run)).map(off).collect();
            own.iter().sum::<f64>() / own.len().max(1) as f64
        };
        let constants: Vec<f64> = (0..runs).map(constant).collect();
        let rest = |sight: &Sight| off(sight) - sight.run.map_or(0.0, |run| constants[run]);
        squares += group.iter().map(rest).map(|x| x * x).sum::<f64>();
        count += group.len();
    }
    (count > 0).then(|| libm::sqrt(squares / count as f64))
}

/// Returns how far the points of each ball are from their mean (mm, RMS).
fn of_balls(points: &[Seen], ball: &dyn Fn(usize) -> usize) -> Option<f64> {
    let count = points.iter().map(|seen| ball(seen.row)).max()? + 1;
    let mut sums = vec![(Vector3::zeros(), 0.0); count];
    for Seen { row, point, .. } in points {
        let sum = &mut sums[ball(*row)];
        *sum = (sum.0 + point, sum.1 + 1.0);
    }
    let off = |Seen { row, point, .. }: &Seen| {
        let (sum, count) = sums[ball(*row)];
        (point - sum / count).norm_squared()
    };
    Some(libm::sqrt(points.iter().map(off).sum::<f64>() / points.len() as f64))
}
