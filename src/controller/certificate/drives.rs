//! The demand of a kinematics module on the drives of the joints: one rotary axis of the program turns, and the tip of
//! the tool stands on the part.
//!
//! Rates and accelerations are per deg/s of that axis and per its square, by differences of the commands along the
//! turn. Near a pole they are those of the corrections, and narrow: the steps are a fraction of the zone in which
//! rotary corrections are bounded.

use crate::controller::kinematics::{KinematicsModule, TurnCommand};
use crate::machine::{Axis, AxisKind, AxisPositions, Machine, Pose};
use rayon::prelude::*;

/// The largest demand on the drive of a joint while a rotary axis turns.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct DriveDemand {
    /// The rotary axis of the program.
    pub turning: String,
    /// The axis of the joint that moves with it.
    pub joint: String,
    /// Its largest rate per deg/s, mm/s or deg/s.
    pub rate: f64,
    /// The positions of the program at which it has that rate.
    pub rate_at: AxisPositions,
    /// Its largest acceleration per (deg/s)^2, mm/s^2 or deg/s^2.
    pub acceleration: f64,
    /// The positions of the program at which it has that acceleration.
    pub acceleration_at: AxisPositions,
    /// The largest acceleration that the machine without errors needs, in the same unit.
    pub ideal_acceleration: f64,
}

/// Places of the linear axes, as fractions of their travels by turns: each second corner of the volume.
const CORNERS: [[f64; 3]; 4] = [[0.1, 0.1, 0.1], [0.9, 0.1, 0.9], [0.1, 0.9, 0.9], [0.9, 0.9, 0.1]];

/// Places of other rotary axes, spread over their travels or a turn.
const OTHERS: usize = 8;

/// Largest number of places of all rotary axes from which one is turned.
const MAX_OTHERS: usize = 64;

/// Steps over the travel of the turning axis.
const COARSE: u32 = 12;

/// Steps to either side of a pole, and the last of them in widths of its zone.
const FINE: (i32, f64) = (12, 1.2);

/// Step of the differences, deg: the turn of a servo cycle of 1 ms at 40 deg/s. A kink of a curve counts by it.
const STEP_DEG: f64 = 0.04;

/// A rate per deg/s, or an acceleration, that is rounding.
const NOTHING: f64 = 1e-7;

/// Largest rates and accelerations that were met, with their poses.
#[derive(Debug, Clone, Default)]
struct Largest {
    rate: f64,
    rate_at: Pose,
    acceleration: f64,
    acceleration_at: Pose,
    ideal: f64,
}

impl Largest {
    fn or(self, other: Self) -> Self {
        let (rate, rate_at) =
            if other.rate > self.rate { (other.rate, other.rate_at) } else { (self.rate, self.rate_at) };
        let (acceleration, acceleration_at) = if other.acceleration > self.acceleration {
            (other.acceleration, other.acceleration_at)
        } else {
            (self.acceleration, self.acceleration_at)
        };
        Self { rate, rate_at, acceleration, acceleration_at, ideal: self.ideal.max(other.ideal) }
    }
}

/// Returns the demand on every joint that each rotary axis moves, over the volume and through the poles.
pub(crate) fn drive_demands(machine: &Machine, module: &KinematicsModule) -> Vec<DriveDemand> {
    let axes = machine.axes();
    let rotary: Vec<usize> = (0..axes.len()).filter(|i| axes[*i].kind == AxisKind::Rotary).collect();
    if !module.keeps_the_tip() {
        return Vec::new();
    }
    let named = |pose: &Pose| -> AxisPositions {
        axes.iter().map(|axis| axis.name.to_string()).zip(pose.iter().copied()).collect()
    };
    let of = |turning: &usize| {
        let starts = starts(machine, *turning, &rotary);
        let found: Vec<Vec<Largest>> = starts.par_iter().map(|pose| along(machine, module, pose, *turning)).collect();
        let none = vec![Largest::default(); axes.len()];
        // In the order of the places: the first of equal ones stands.
        let join = |a: Vec<Largest>, b: Vec<Largest>| a.into_iter().zip(b).map(|(a, b)| a.or(b)).collect();
        let largest: Vec<Largest> = found.into_iter().fold(none, join);
        let moving = largest.into_iter().enumerate();
        let moving = moving.filter(|(joint, of)| joint != turning && of.rate.max(of.acceleration) > NOTHING);
        let demand = |(joint, of): (usize, Largest)| DriveDemand {
            turning: axes[*turning].name.to_string(),
            joint: axes[joint].name.to_string(),
            rate: of.rate,
            rate_at: named(&of.rate_at),
            acceleration: of.acceleration,
            acceleration_at: named(&of.acceleration_at),
            ideal_acceleration: of.ideal,
        };
        moving.map(demand).collect::<Vec<_>>()
    };
    rotary.iter().flat_map(of).collect()
}

/// Returns places of all axes but the turning one: corners of the linear axes, other rotary axes around.
fn starts(machine: &Machine, turning: usize, rotary: &[usize]) -> Vec<Pose> {
    let axes = machine.axes();
    let corner = |fractions: [f64; 3]| -> Pose {
        let mut fractions = fractions.into_iter().cycle();
        let of = |axis: &Axis| {
            let (min, max) = axis.travel.interval();
            match axis.kind {
                AxisKind::Linear => min + (max - min) * fractions.next().unwrap_or(0.5),
                AxisKind::Rotary => 0.0_f64.clamp(min, max),
            }
        };
        axes.iter().map(of).collect()
    };
    let mut all: Vec<Pose> = CORNERS.map(corner).to_vec();
    for other in rotary.iter().filter(|other| **other != turning) {
        let (min, max) = turn_of(&axes[*other]);
        let places: Vec<f64> = (0..OTHERS).map(|k| min + (max - min) * k as f64 / OTHERS as f64).collect();
        if all.len() * places.len() > CORNERS.len() * MAX_OTHERS {
            continue;
        }
        let at = |pose: &Pose, q: f64| {
            let mut pose = pose.clone();
            pose[*other] = q;
            pose
        };
        all = all.iter().flat_map(|pose| places.iter().map(|q| at(pose, *q)).collect::<Vec<_>>()).collect();
    }
    all
}

/// The travel of a rotary axis, or a turn of it.
fn turn_of(axis: &Axis) -> (f64, f64) {
    let (min, max) = axis.travel.interval();
    if max - min >= 360.0 { (-180.0, 180.0) } else { (min, max) }
}

/// Returns the largest demands of all joints while an axis turns through its travel, the tip standing on the part.
fn along(machine: &Machine, module: &KinematicsModule, start: &Pose, turning: usize) -> Vec<Largest> {
    let (min, max) = turn_of(&machine.axes()[turning]);
    let coarse = (0..=COARSE).map(|k| min + (max - min) * f64::from(k) / f64::from(COARSE));
    let step = module.pole_zone_deg().unwrap_or(0.0) * FINE.1 / f64::from(FINE.0);
    let poles = module.poles(start, turning, [min, max]).into_iter();
    let fine = poles.flat_map(|pole| (-FINE.0..=FINE.0).map(move |k| pole + step * f64::from(k)));
    let angles = coarse.chain(fine).filter(|q| (min + STEP_DEG..=max - STEP_DEG).contains(q));
    let mut largest = vec![Largest::default(); start.len()];
    for angle in angles {
        let turned = [-STEP_DEG, 0.0, STEP_DEG].map(|by| module.command_of_turn(machine, start, turning, angle + by));
        let [Some(before), Some(at), Some(after)] = turned else { continue };
        if machine.beyond_travel(&at.ideal).next().is_some() {
            continue;
        }
        let bend = |of: fn(&TurnCommand) -> &Pose, joint: usize| {
            ((of(&after)[joint] - 2.0 * of(&at)[joint] + of(&before)[joint]) / (STEP_DEG * STEP_DEG)).abs()
        };
        for (joint, found) in largest.iter_mut().enumerate() {
            let here = Largest {
                rate: ((after.command[joint] - before.command[joint]) / (2.0 * STEP_DEG)).abs(),
                rate_at: at.ideal.clone(),
                acceleration: bend(|of| &of.command, joint),
                acceleration_at: at.ideal.clone(),
                ideal: bend(|of| &of.ideal, joint),
            };
            *found = std::mem::take(found).or(here);
        }
    }
    largest
}
