//! Commands of a module while one rotary axis of the program turns and the tip of the tool stands on the part.

use super::driven::{ideal_tip, programmed_block, world};
use super::{KinematicsModule, ModuleModel, ModuleWords, Parameters};
use crate::machine::{Machine, Pose};
use nalgebra::Vector3;

/// Commands at a position of a turn, mm and deg.
#[derive(Debug, Clone)]
pub struct TurnCommand {
    /// Those of the module.
    pub command: Pose,
    /// Those of the machine without errors: the positions of the program.
    pub ideal: Pose,
}

/// Angle between the positions at which a pole is looked for, deg.
const POLE_SCAN_DEG: f64 = 5.0;

/// Angle to which a pole is found, deg.
const POLE_DEG: f64 = 1e-6;

impl KinematicsModule {
    /// True if the module keeps the tip where a program has it while rotary axes turn.
    pub fn keeps_the_tip(&self) -> bool {
        match self {
            Self::FullModel(model) => model.words == ModuleWords::Tip,
            Self::LinearMap(_) => false,
            Self::KinematicParameters(_) => true,
        }
    }

    /// Returns the angle from a pole below which rotary corrections are bounded, deg; `None` if the module has no such
    /// zone of its own.
    pub fn pole_zone_deg(&self) -> Option<f64> {
        match self {
            Self::FullModel(model) if model.words == ModuleWords::Tip && model.orientation => {
                Some(libm::asin(model.damping).to_degrees())
            }
            _ => None,
        }
    }

    /// Returns the sine of that angle of a full model, whether it has such a zone or not.
    pub(crate) fn damping(&self) -> Option<f64> {
        match self {
            Self::FullModel(model) => Some(model.damping),
            Self::LinearMap(_) | Self::KinematicParameters(_) => None,
        }
    }

    /// Returns the same with another zone, by the sine of its angle.
    #[must_use]
    pub(crate) fn with_damping(self, damping: f64) -> Self {
        match self {
            Self::FullModel(model) => Self::FullModel(ModuleModel { damping, ..model }),
            other => other,
        }
    }

    /// Returns the commands with an axis at a position and the tip where it is on the part at `start`; `None` if the
    /// module stops. The words of parameters are the rotary axes.
    pub fn command_of_turn(&self, machine: &Machine, start: &Pose, turning: usize, angle: f64) -> Option<TurnCommand> {
        let mut pose = start.clone();
        pose[turning] = angle;
        match self {
            Self::FullModel(model) => {
                let setting = model.setting();
                let world = world(machine, model, &ideal_tip(machine, start), &pose);
                let ideal = model.nominal(&setting, &world, &pose)?;
                Some(TurnCommand { command: model.corrected_command(&setting, &ideal)?, ideal })
            }
            Self::LinearMap(_) => None,
            Self::KinematicParameters(parameters) => {
                let mut block = programmed_block(machine, false, start);
                block.axes = &pose;
                let command = parameters.transformation().command(&block);
                Some(TurnCommand { command, ideal: parameters.nominal.command(&block) })
            }
        }
    }

    /// Returns the positions of an axis at which the tool stands along another rotary axis, deg, within an interval.
    pub fn poles(&self, start: &Pose, turning: usize, [min, max]: [f64; 2]) -> Vec<f64> {
        let (Self::FullModel(model), Some(_)) = (self, self.pole_zone_deg()) else { return Vec::new() };
        let at = |angle: f64| model.pole_distance(start, turning, angle);
        let count = libm::ceil((max - min) / POLE_SCAN_DEG) as i32;
        let scan: Vec<f64> = (0..=count).map(|k| min + (max - min) * f64::from(k) / f64::from(count.max(1))).collect();
        let crossing = |pair: &[f64]| {
            let (mut low, mut high) = (pair[0], pair[1]);
            let (first, last) = (at(low)?, at(high)?);
            if last == 0.0 && high == max {
                return Some(high);
            }
            if first * last > 0.0 || last == 0.0 {
                return None;
            }
            while high - low > POLE_DEG {
                let middle = 0.5 * (low + high);
                if at(middle)? * first > 0.0 { low = middle } else { high = middle }
            }
            Some(0.5 * (low + high))
        };
        scan.windows(2).filter_map(crossing).collect()
    }
}

impl ModuleModel {
    /// Returns the sine of the angle between two planes: those of the tool axis with each of both rotary axes; 0 at a
    /// pole, with its sign. `None` for other than two rotary axes.
    fn pole_distance(&self, start: &Pose, turning: usize, angle: f64) -> Option<f64> {
        let mut pose = start.clone();
        pose[turning] = angle;
        let place = self.place(&self.setting(), &pose);
        let turns: Vec<&Vector3<f64>> =
            (0..pose.len()).filter(|i| self.joints[*i].rotary).map(|i| &place.turn[i]).collect();
        match turns[..] {
            [one, other] => Some(place.axis().dot(&one.cross(other))),
            _ => None,
        }
    }
}

impl Parameters {
    /// Returns the positions of all axes with one at an angle and the tip where it is on the part at `first`, and the
    /// cosine of the tilt of the tool against the part from there (mm, deg).
    pub fn turned_about_tip(&self, machine: &Machine, first: &Pose, axis: usize, angle: f64) -> (Pose, f64) {
        let mut pose = first.clone();
        pose[axis] = angle;
        let mut block = programmed_block(machine, false, first);
        block.axes = &pose;
        let second = self.nominal.command(&block);
        let [one, other] = [first, &second].map(|pose| programmed_block(machine, true, pose).vector);
        let cosine = one.zip(other).map_or(1.0, |(one, other)| one.dot(&other));
        (second, cosine)
    }
}
