//! The algorithm of the generated module, in own arithmetic: nominal inverse kinematics, and the chord form of
//! Newton's iteration for the erroneous machine.
//!
//! For a nominal command q the command q + c has the tip, and as far as the axes can the orientation, that
//! the nominal machine has at q. The total x of the corrections solves `x = S (J x + missing)`, with J of the
//! nominal machine at q and S its bounded inverse ([`Hold`](super::hold::Hold)).

use super::data::{ModuleModel, ModuleWords, WORLD};
use super::nominal::{BodyPlace, Setting, from_roll_pitch_yaw, rotation_vector};
use crate::algebra::Htm;
use nalgebra::{DVector, Vector3, Vector6};

/// Coordinates X Y Z A B C U V W, mm and deg.
pub type World = [f64; WORLD.len()];

/// Steps after which the iteration has failed; it contracts by the size of the errors.
const MAX_STEPS: usize = 16;

/// A linear step (mm) and a rotary step (rad) that are rounding.
const SMALL: (f64, f64) = (1e-9, 1e-12);

/// Steps, and the longest of them (arms, rad), of the path to a pose of the tool.
const MAX_STEP: (usize, f64) = (48, 0.3);

/// Distances within which the nominal tool has reached its pose, mm and rad.
const THERE: (f64, f64) = (1e-10, 1e-12);

impl ModuleModel {
    /// The command that the module gives for a pose, from the joints where they are; `None` if it reports
    /// a failure.
    pub fn command(&self, setting: &Setting, world: &World, joints: &[f64]) -> Option<Vec<f64>> {
        let nominal = self.nominal(setting, world, joints)?;
        self.corrected_command(setting, &nominal)
    }

    /// The nominal command with all of its correction.
    pub fn corrected_command(&self, setting: &Setting, nominal: &[f64]) -> Option<Vec<f64>> {
        let place = self.place(setting, nominal);
        let hold = self.hold(&place, setting)?;
        let (mut command, mut made) = (nominal.to_vec(), DVector::zeros(nominal.len()));
        for _ in 0..MAX_STEPS {
            let real = self.real(setting, &command);
            let total = hold.total(&made, &self.missing(&place, &real), setting);
            let (mut largest, mut widest) = (0.0_f64, 0.0_f64);
            for (i, joint) in self.joints.iter().enumerate() {
                let step = total[i] - made[i];
                if joint.rotary {
                    command[i] += step.to_degrees();
                    widest = widest.max(step.abs());
                } else {
                    command[i] += step;
                    largest = largest.max(step.abs());
                }
            }
            made = total;
            if largest < SMALL.0 && widest < SMALL.1 {
                return Some(command);
            }
        }
        None
    }

    /// Difference from the actual tool to the nominal one: the tip, and the rotation that this machine can make.
    fn missing(&self, place: &BodyPlace, real: &Htm<f64>) -> Vector6<f64> {
        let p = place.tip - real.translation;
        let t = match self.words {
            ModuleWords::Pose => skew(place, real),
            ModuleWords::Tip | ModuleWords::Axes => real.linear.column(2).cross(&place.axis()),
        };
        Vector6::new(p[0], p[1], p[2], t[0], t[1], t[2])
    }

    /// Nominal inverse kinematics.
    pub(super) fn nominal(&self, setting: &Setting, world: &World, joints: &[f64]) -> Option<Vec<f64>> {
        let start = self.joints.iter().zip(joints).map(|(joint, q)| joint.letter.map_or(*q, |letter| world[letter]));
        let mut command: Vec<f64> = start.collect();
        let wanted = Vector3::new(world[0], world[1], world[2]) + self.tip(setting);
        match self.words {
            ModuleWords::Axes => Some(command),
            ModuleWords::Pose => {
                let linear = from_roll_pitch_yaw(&[world[3], world[4], world[5]]);
                self.joints_reaching(setting, &Htm { linear, translation: wanted }, command)
            }
            ModuleWords::Tip => {
                let solved = |i: &usize| self.joints[*i].letter.is_none();
                (0..command.len()).filter(solved).for_each(|i| command[i] = 0.0);
                let place = self.place(setting, &command);
                let hold = self.hold(&place, &Setting { orientation: false, ..*setting })?;
                let p = wanted - place.tip;
                let missing = Vector6::new(p[0], p[1], p[2], 0.0, 0.0, 0.0);
                let ways =
                    hold.total(&DVector::zeros(command.len()), &missing, &Setting { orientation: false, ..*setting });
                (0..command.len()).filter(solved).for_each(|i| command[i] = ways[i]);
                Some(command)
            }
        }
    }

    /// The joints at which the nominal tool has a pose, from near ones.
    fn joints_reaching(&self, setting: &Setting, wanted: &Htm<f64>, start: Vec<f64>) -> Option<Vec<f64>> {
        let (mut command, mut distance) = (start.clone(), None);
        let unit: Vec<f64> = self.joints.iter().map(|j| if j.rotary { 1f64.to_degrees() } else { self.arm }).collect();
        let whole = Setting { orientation: true, ..*setting };
        for _ in 0..MAX_STEP.0 {
            let place = self.place(setting, &command);
            let p = wanted.translation - place.tip;
            let t = rotation_vector(&(wanted.linear * place.rotation.transpose()));
            let distance = *distance.get_or_insert(p.norm() / self.arm + t.norm());
            if p.norm() < THERE.0 && t.norm() < THERE.1 {
                // Joints that move this much further than the tool have passed a singular pose.
                let moved = (0..command.len()).map(|i| (command[i] - start[i]).abs() / unit[i]).fold(0.0, f64::max);
                return (moved * self.damping <= distance + SMALL.1).then_some(command);
            }
            let missing = Vector6::new(p[0], p[1], p[2], t[0], t[1], t[2]);
            let step = self.hold(&place, &whole)?.total(&DVector::zeros(command.len()), &missing, &whole);
            let turns = |i: usize| if self.joints[i].rotary { step[i] } else { step[i] / self.arm };
            let longest = (0..command.len()).map(|i| turns(i).abs()).fold(0.0, f64::max);
            let part = if longest > MAX_STEP.1 { MAX_STEP.1 / longest } else { 1.0 };
            (0..command.len()).for_each(|i| command[i] += part * turns(i) * unit[i]);
        }
        None
    }
}

/// The rotation from the real tool to the nominal one, as far as it is small; with linearised joints there is no other.
fn skew(place: &BodyPlace, real: &Htm<f64>) -> Vector3<f64> {
    let m = place.rotation * real.linear.transpose();
    Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]) * 0.5
}
