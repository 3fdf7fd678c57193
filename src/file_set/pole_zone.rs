//! The width of a module's pole zone by the limits of the drives, as the controller's INI file states them.
//!
//! Within the zone rotary corrections are bounded; the narrower it is, the steeper they are beside the pole. The
//! narrowest zone is taken at which no joint is asked for more than its limits while a rotary axis of the program turns
//! as fast as it may.

use crate::controller::{DriveDemand, KinematicsModule, ModuleModel, WORLD, drive_demands};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Axis, AxisKind, Machine};
use crate::units::significant;

/// Sine of the widest zone: beyond 11.5 deg little would be left of the direction's correction.
const WIDEST: f64 = 0.2;

/// Halvings of the ratio between the widest zone and the narrowest: to 2 %.
const HALVINGS: usize = 7;

/// Part of a limit that a turn may ask: the linear words of a program move too.
const SHARE: f64 = 0.8;

/// Part of an acceleration that a turn may ask in the widest zone: one that asks more by the lever of the tip alone is
/// taken as slower, since no zone would help.
const LEVER_SHARE: f64 = 0.5;

/// The limits of a joint's drive.
#[derive(Debug, Clone, Copy, PartialEq)]
struct JointLimits {
    /// The largest rate, mm/s or deg/s.
    rate: f64,
    /// The largest acceleration, mm/s^2 or deg/s^2.
    acceleration: f64,
}

/// The limits of an INI file, in the order of the walk.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DriveLimits {
    joints: Vec<JointLimits>,
    /// The speeds at which a program may turn the rotary axes, deg/s.
    turns: Vec<Option<f64>>,
}

impl DriveLimits {
    /// Reads `[JOINT_n]`, `[AXIS_L]` and `[TRAJ]`. Refused (E0755): what is missing, or no number.
    pub(crate) fn read(machine: &Machine, module: &KinematicsModule, text: &str) -> Result<Self, Diagnostic> {
        let KinematicsModule::FullModel(ModuleModel { joints: model, .. }) = module else {
            return Err(unfit("only a generated module has a zone that limits decide".to_owned()));
        };
        let ini = Ini(text);
        if ini.get("TRAJ", "LINEAR_UNITS").is_some_and(|unit| !["mm", "metric"].contains(&unit)) {
            return Err(unfit("[TRAJ] LINEAR_UNITS is not mm, and the module counts in mm".to_owned()));
        }
        let mut joints = Vec::new();
        let mut turns = Vec::new();
        for (joint, axis) in model.iter().zip(machine.axes()) {
            let section = format!("JOINT_{}", joint.number);
            let limit = |key: &str| {
                let found = ini.positive(&section, key)?;
                found.ok_or_else(|| unfit(format!("[{section}] {key} is missing: the joint of `{}`", axis.name)))
            };
            joints.push(JointLimits { rate: limit("MAX_VELOCITY")?, acceleration: limit("MAX_ACCELERATION")? });
            let letter = joint.letter.and_then(|index| WORLD.chars().nth(index));
            let Some(letter) = letter.filter(|_| axis.kind == AxisKind::Rotary) else {
                turns.push(None);
                continue;
            };
            let own = ini.positive(&format!("AXIS_{letter}"), "MAX_VELOCITY")?;
            let of_all = ini.positive("TRAJ", "MAX_ANGULAR_VELOCITY")?;
            let speed = own.into_iter().chain(of_all).reduce(f64::min);
            let missing = || unfit(format!("[AXIS_{letter}] MAX_VELOCITY is missing: axis `{}`", axis.name));
            turns.push(Some(speed.ok_or_else(missing)?));
        }
        Ok(Self { joints, turns })
    }

    /// Returns the largest speed of a rotary axis at which no joint is asked for more than its share of a rate and a
    /// part of its acceleration.
    fn speed(&self, machine: &Machine, demands: &[DriveDemand], turning: &str, part: f64) -> f64 {
        let of = demands.iter().filter(|of| of.turning == turning);
        of.filter_map(|of| Some((of, self.of(machine, &of.joint)?))).fold(f64::INFINITY, |speed, (of, limits)| {
            let by_rate = SHARE * limits.rate / of.rate;
            let by_acceleration = (part * limits.acceleration / of.acceleration).sqrt();
            speed.min(by_rate).min(by_acceleration)
        })
    }

    fn of(&self, machine: &Machine, axis: &str) -> Option<JointLimits> {
        let index = machine.axes().iter().position(|known| known.name.as_str() == axis)?;
        self.joints.get(index).copied()
    }
}

/// Returns the module with the narrowest zone that the drives can follow, and a warning (W0763) for each rotary axis
/// that the limits let turn faster than they follow all the same.
pub(crate) fn fit_pole_zone(
    machine: &Machine,
    module: KinematicsModule,
    limits: &DriveLimits,
) -> (KinematicsModule, Vec<Diagnostic>) {
    let turns = || machine.axes().iter().zip(&limits.turns).filter_map(|(axis, turn)| Some((axis, (*turn)?)));
    let demands = |sine: f64| drive_demands(machine, &module.clone().with_damping(sine));
    let fitted = match module.damping() {
        Some(narrowest) if narrowest < WIDEST && module.pole_zone_deg().is_some() => {
            let least = demands(WIDEST);
            let wanted: Vec<(&str, f64)> = turns()
                .map(|(axis, turn)| {
                    let name = axis.name.as_str();
                    (name, turn.min(limits.speed(machine, &least, name, LEVER_SHARE)))
                })
                .collect();
            let follows = |sine: f64| {
                let asked = demands(sine);
                wanted.iter().all(|(name, speed)| limits.speed(machine, &asked, name, SHARE) >= *speed)
            };
            module.clone().with_damping(narrowest_of(narrowest, follows))
        }
        _ => module.clone(),
    };
    let asked = drive_demands(machine, &fitted);
    let warning = |(axis, turn): (&Axis, f64)| {
        let name = axis.name.as_str();
        let follows = limits.speed(machine, &asked, name, SHARE);
        (follows < turn).then(|| {
            let message = format!(
                "the INI file lets `{name}` turn at {} deg/s, and the drives follow it up to {} deg/s",
                significant(turn, 3),
                significant(follows, 3)
            );
            let help =
                "lower its [AXIS_] MAX_VELOCITY; the certificate states what a turn asks of each joint, and where";
            Diagnostic::new(codes::W0763, message).help(help)
        })
    };
    let warnings = turns().filter_map(warning).collect();
    (fitted, warnings)
}

/// The narrowest zone that is followed, between one and the widest.
fn narrowest_of(narrowest: f64, follows: impl Fn(f64) -> bool) -> f64 {
    if follows(narrowest) {
        return narrowest;
    }
    let (mut low, mut high) = (narrowest, WIDEST);
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if follows(middle) { high = middle } else { low = middle }
    }
    high
}

/// The refusal of an INI file.
fn unfit(reason: String) -> Diagnostic {
    let help = "give the INI file that LinuxCNC runs with; lines behind #INCLUDE are not followed";
    Diagnostic::new(codes::E0755, format!("--ini: {reason}")).help(help)
}

/// The text of an INI file. Of sections and keys that are there twice the controller takes the first.
struct Ini<'a>(&'a str);

impl<'a> Ini<'a> {
    fn get(&self, section: &str, key: &str) -> Option<&'a str> {
        let named = |line: &str| line.strip_prefix('[').and_then(|rest| rest.split_once(']')).map(|of| of.0.to_owned());
        let lines = || self.0.lines().map(str::trim).filter(|line| !line.starts_with(['#', ';']));
        let after = lines().skip_while(|line| named(line).as_deref() != Some(section)).skip(1);
        let mut pairs = after.take_while(|line| !line.starts_with('[')).filter_map(|line| line.split_once('='));
        let (_, value) = pairs.find(|(found, _)| found.trim() == key)?;
        Some(value.trim())
    }

    /// Returns a number above zero; none if the key is missing.
    fn positive(&self, section: &str, key: &str) -> Result<Option<f64>, Diagnostic> {
        let Some(text) = self.get(section, key) else { return Ok(None) };
        let plain = text.split(['#', ';']).next().unwrap_or_default().trim();
        let value = plain.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
        value.map(Some).ok_or_else(|| unfit(format!("[{section}] {key} is no number above 0: `{}`", shown(text))))
    }
}
