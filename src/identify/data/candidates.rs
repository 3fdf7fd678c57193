//! Readings that an instrument could take, as a table in the form in which they are read back once they are measured:
//! the cells of the readings are empty.

use super::measurement::{Measurement, Reading};
use crate::analysis::instrument::within;
use crate::analysis::touch_route::{ProbeSizes, TouchScene};
use crate::analysis::{Unreachable, place};
use crate::evaluate::random_poses;
use crate::identify::thresholds::{PLAN_CANDIDATES, PLAN_LINE_POINTS, PLAN_LINES, PLAN_TOUCH_POSES};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, Pose};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// The instrument for which readings are planned.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum PlanInstrument {
    /// Anything that reads three components of the deviation at any pose.
    #[default]
    Points,
    /// The same at points along lines of the linear axes, others at an end or in the middle, rotary axes at rest.
    Lines,
    /// A nest of sensors, or a probe, at balls on the table while rotary axes turn and linear axes follow.
    RTest,
    /// A laser tracker or a camera, which stands anywhere.
    Tracker,
    /// An interferometer along lines of the linear axes and along diagonals, rotary axes at rest; a line is one of the
    /// readings that are planned.
    Laser,
    /// A touch probe at balls on the table, in poses of the rotary axes in which it reaches them with a clear shaft.
    Touch,
}

impl PlanInstrument {
    /// Returns the table of what it could read within the volume. `balls` are the poses (mm, deg) at which the
    /// functional point is at a ball, `probe` is what touches them. Fails if the linear axes hold the point at none of
    /// them; a probe that reaches no ball with a clear shaft leaves the head alone.
    pub fn table(
        self,
        machine: &Machine,
        balls: &[Pose],
        probe: &ProbeSizes,
        seed: u64,
    ) -> Result<String, Unreachable> {
        let table = CandidateTable::new(machine);
        Ok(match self {
            Self::Points => table.of_points("dx [um],dy [um],dz [um]", seed),
            Self::Lines => table.of_axis_lines(),
            Self::Tracker => table.of_points("tracker.x [mm],tracker.y [mm],tracker.z [mm]", seed),
            Self::RTest => table.at_balls(balls, seed)?,
            Self::Laser => table.of_lines(seed),
            Self::Touch => table.of_touches(probe, balls, seed),
        })
    }
}

struct CandidateTable<'a> {
    machine: &'a Machine,
    has_tools: bool,
    titles: String,
}

impl<'a> CandidateTable<'a> {
    fn new(machine: &'a Machine) -> Self {
        let titles: Vec<String> =
            machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit())).collect();
        let has_tools = machine.tools().len() > 1;
        Self { machine, has_tools, titles: titles.join(",") + if has_tools { ",tool" } else { "" } }
    }

    fn row(&self, machine: &Machine, pose: &[f64], decimals: i32) -> String {
        let mut cells: Vec<String> = pose
            .iter()
            .zip(machine.volume())
            .map(|(q, of)| rounded(*q, decimals, [of.min, of.max]).to_string())
            .collect();
        cells.extend(self.has_tools.then(|| machine.tool().name.clone()));
        cells.join(",")
    }

    /// Three readings at random poses with each tool.
    fn of_points(&self, readings: &str, seed: u64) -> String {
        self.of_poses(readings, 2, |tool, machine| {
            random_poses(machine, PLAN_CANDIDATES, seed.wrapping_add(tool as u64))
        })
    }

    /// Three readings at poses with each tool, rounded to decimals; none twice.
    fn of_poses(&self, readings: &str, decimals: i32, of: impl Fn(usize, &Machine) -> Vec<Pose>) -> String {
        let mut text = format!("{},{readings}\n", self.titles);
        let mut met = BTreeSet::new();
        for (tool, named) in self.machine.tools().iter().enumerate() {
            let Some(machine) = self.machine.with_tool(&named.name) else { continue };
            for pose in of(tool, &machine) {
                let row = self.row(&machine, &pose, decimals);
                if !met.contains(&row) {
                    text += &format!("{row},,,\n");
                    let _ = met.insert(row);
                }
            }
        }
        text
    }

    /// Returns the linear axes that move within the volume.
    fn linear(&self) -> Vec<usize> {
        let volume = self.machine.volume();
        let moves = |i: &usize| self.machine.axes()[*i].kind == AxisKind::Linear && volume[*i].max > volume[*i].min;
        (0..volume.len()).filter(moves).collect()
    }

    /// Points along each linear axis, the others at an end or in the middle: each by itself, of more than three all
    /// alike.
    fn of_axis_lines(&self) -> String {
        let (linear, rest, volume) = (self.linear(), within(self.machine, 0.5), self.machine.volume());
        let at = |axis: usize, share: f64| volume[axis].min + share * (volume[axis].max - volume[axis].min);
        let places = |others: &[usize]| -> Vec<Pose> {
            let each = |k: usize, i: usize| if linear.len() > 3 { k } else { k / 3_usize.pow(i as u32) % 3 };
            let count = if linear.len() > 3 { 3 } else { 3_usize.pow(others.len() as u32) };
            let place = |k: usize| {
                let mut pose = rest.clone();
                others.iter().enumerate().for_each(|(i, axis)| pose[*axis] = at(*axis, each(k, i) as f64 / 2.0));
                pose
            };
            (0..count).map(place).collect()
        };
        let mut poses = Vec::new();
        for axis in &linear {
            let others: Vec<usize> = linear.iter().copied().filter(|other| other != axis).collect();
            for from in places(&others) {
                for step in 0..PLAN_LINE_POINTS {
                    let mut pose = from.clone();
                    pose[*axis] = at(*axis, step as f64 / (PLAN_LINE_POINTS - 1) as f64);
                    poses.push(pose);
                }
            }
        }
        self.of_poses("dx [um],dy [um],dz [um]", 4, |_, _| poses.clone())
    }

    /// Balls on the table, each a run that begins where the ball is given.
    fn at_balls(&self, balls: &[Pose], seed: u64) -> Result<String, Unreachable> {
        let mut text = format!(
            "# each run: readings less the first, in the directions of the machine: abbe identify --frame machine\n\
             run,{},rel.dx [um],rel.dy [um],rel.dz [um]\n",
            self.titles
        );
        let turns = random_poses(self.machine, PLAN_CANDIDATES, seed);
        for (number, at) in balls.iter().enumerate() {
            let tip = NominalPose::in_part(self.machine, at).pose.translation;
            let turned = |turn: &Pose| {
                let of = |((axis, at), turn): ((&crate::machine::Axis, &f64), &f64)| match axis.kind {
                    AxisKind::Rotary => *turn,
                    AxisKind::Linear => *at,
                };
                let pose: Pose = self.machine.axes().iter().zip(at).zip(turn).map(of).collect();
                place(self.machine, &tip, &pose).map_err(|miss| miss.why)
            };
            let mut poses = vec![at.clone()];
            let mut failure = None;
            for found in turns.iter().map(turned) {
                match found {
                    Ok(pose) => poses.push(pose),
                    Err(why) => failure = Some(why),
                }
            }
            if let ([_], Some(why)) = (&poses[..], failure) {
                return Err(why);
            }
            poses
                .iter()
                .for_each(|pose| text += &format!("ball {},{},,,\n", number + 1, self.row(self.machine, pose, 4)));
        }
        Ok(text)
    }

    /// Balls in poses of the rotary axes in whole degrees, pose by pose: the axes with the stylus in the middle of the
    /// ball, as they are logged.
    fn of_touches(&self, sizes: &ProbeSizes, balls: &[Pose], seed: u64) -> String {
        let machine = self.machine;
        // As they are written: `measure` asks the same of them.
        let written = |x: f64| libm::round(x * 1e4) / 1e4 + 0.0;
        let place = |at: &Pose| NominalPose::in_part(machine, at).pose.translation.map(written);
        let placed = sizes.balls(balls.iter().map(place).collect());
        let whole = |(q, of): (&f64, &crate::machine::Grid)| {
            let within = [of.min, of.max];
            rounded(rounded(*q, 0, within), 4, within)
        };
        let turns: Vec<Pose> = random_poses(machine, PLAN_TOUCH_POSES, seed)
            .iter()
            .map(|turn| turn.iter().zip(machine.volume()).map(whole).collect())
            .collect();
        let sets: Vec<(&Pose, usize)> =
            turns.iter().flat_map(|turn| (0..balls.len()).map(move |ball| (turn, ball))).collect();
        let scene = TouchScene::of(machine, &placed, sizes.stylus).ok();
        let middle = |(turn, ball): &(&Pose, usize)| scene.as_ref()?.touchable(*ball, turn);
        let found: Vec<Option<Pose>> = sets.par_iter().map(middle).collect();
        let mut text = format!("ball,ball.x [mm],ball.y [mm],ball.z [mm],{}\n", self.titles);
        for ((_, ball), middle) in sets.iter().zip(found) {
            let Some(middle) = middle else { continue };
            let [x, y, z] = <[f64; 3]>::from(placed.centres[*ball]);
            text += &format!("b{},{x},{y},{z},{}\n", ball + 1, self.row(machine, &middle, 4));
        }
        text
    }

    /// Lines along each linear axis at random places of the others, and along the diagonals.
    fn of_lines(&self, seed: u64) -> String {
        let (machine, rest) = (self.machine, within(self.machine, 0.5));
        let (volume, linear) = (machine.volume(), self.linear());
        let mut lines: Vec<(String, Pose, Pose)> = Vec::new();
        for (k, axis) in linear.iter().enumerate() {
            let places = random_poses(machine, PLAN_LINES, seed.wrapping_add(k as u64));
            for (number, other) in places.iter().enumerate() {
                let mut from = rest.clone();
                linear.iter().for_each(|i| from[*i] = other[*i]);
                let mut to = from.clone();
                (from[*axis], to[*axis]) = (volume[*axis].min, volume[*axis].max);
                lines.push((format!("{} {}", machine.axes()[*axis].name, number + 1), from, to));
            }
        }
        let (first, senses) = (&linear[..linear.len().min(3)], 1 << linear.len().clamp(1, 3) >> 1);
        for sense in 0..if first.len() > 1 { senses } else { 0 } {
            let (mut from, mut to) = (rest.clone(), rest.clone());
            for (k, i) in first.iter().enumerate() {
                let [low, high] = [volume[*i].min, volume[*i].max];
                (from[*i], to[*i]) = if sense >> k & 1 == 0 { (low, high) } else { (high, low) };
            }
            lines.push((format!("diagonal {}", sense + 1), from, to));
        }
        let mut text = format!("run,{},along [um]\n", self.titles);
        for (name, from, to) in &lines {
            for step in 0..PLAN_LINE_POINTS {
                let share = step as f64 / (PLAN_LINE_POINTS - 1) as f64;
                let pose: Pose = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
                text += &format!("{name},{},\n", self.row(machine, &pose, 4));
            }
        }
        text
    }
}

/// A position that a person can type in, never `-0`; as it is where rounding leaves the volume.
fn rounded(q: f64, decimals: i32, [min, max]: [f64; 2]) -> f64 {
    let scale = libm::pow(10.0, f64::from(decimals));
    let near = (q * scale).round() / scale + 0.0;
    if (min..=max).contains(&near) { near } else { q }
}

/// Returns the indices of readings that are taken together: those of a row of the file, and of a line.
pub(crate) fn taken_together(data: &[Measurement]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, reading) in data.iter().enumerate() {
        let belongs = |last: &Measurement| match (&last.reading, &reading.reading) {
            (Reading::Along { less: a, is_touch: false, .. }, Reading::Along { less: b, .. }) => a == b,
            _ => last.place == reading.place && !reading.place.range.is_empty(),
        };
        match groups.last_mut() {
            Some(group) if belongs(&data[i - 1]) => group.push(i),
            _ => groups.push(vec![i]),
        }
    }
    groups
}
