//! Meaning of a program's words on a machine, by the abilities of its axes, with the joint and the letter of each.
//!
//! - Three linear axes that span the room hold the **tip**: X Y Z of the program are its place.
//! - Otherwise, where six axes move the tool in all six degrees of freedom (robots), X Y Z and A B C are its **pose**.
//! - Otherwise (lathes, two-axis machines, SCARA) every word is the position of its **axis**.
//!
//! Further axes have words of their own.

use super::data::{ModuleJoint, ModuleModel, ModuleWords, WORLD};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::random_poses;
use crate::machine::{Axis, AxisKind, Machine, Pose};
use nalgebra::{Matrix3, Matrix6, SVector, Vector3, Vector6};

/// Poses over the volume at which the abilities of the axes are tested.
const POSES: usize = 32;

const SEED: u64 = 0;

impl ModuleModel {
    /// The numbers of a machine. Refusals: E0752.
    pub fn of(machine: &Machine, damping: f64, orientation: bool) -> Result<Self, Diagnostic> {
        let mut model = Self::geometry(machine, damping, orientation);
        let topology = Topology::of(machine, &model)?;
        (model.words, model.arm) = (topology.words, topology.arm);
        for (index, joint) in model.joints.iter_mut().enumerate() {
            joint.letter = topology.letters[index];
            joint.number = topology.numbers[index];
            joint.solved = topology.solved[index];
        }
        Ok(model)
    }
}

/// The words of a machine's programs.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// Their meaning.
    pub words: ModuleWords,
    /// For each axis of the walk, true if it is solved (or, where words are axes, corrected) to hold the tip.
    pub solved: Vec<bool>,
    /// The coordinate of its own, if it has one.
    pub letters: Vec<Option<usize>>,
    /// The controller's joint.
    pub numbers: Vec<usize>,
    /// The root mean square distance (mm) of the tip from the rotary axes: the length at which rotations and
    /// translations are weighed against each other.
    pub arm: f64,
}

impl Topology {
    /// Finds them from the geometry of a model. Refusals: E0752.
    pub fn of(machine: &Machine, model: &ModuleModel) -> Result<Self, Diagnostic> {
        // The sine of an angle: directions closer to each other, or to a plane, count as one.
        let flat = model.damping;
        let poses = random_poses(machine, POSES, SEED);
        let arm = arm(model, &poses);
        let linear = linear_by_letter(machine);
        let (words, solved) = match spanning(machine, &linear) {
            Some(three) => (ModuleWords::Tip, three),
            None => match six(model, &poses, arm, flat) {
                Some(six) => (ModuleWords::Pose, six),
                None => (ModuleWords::Axes, independent(machine, &linear, flat)),
            },
        };
        let count = machine.axes().len();
        let letters = letters(machine, words, &solved)?;
        let mut order: Vec<usize> = (0..count).collect();
        let rank = |axis: &usize| match letters[*axis] {
            Some(letter) => (1, letter),
            None => (0, solved.iter().position(|s| s == axis).unwrap_or(count)),
        };
        order.sort_by_key(rank);
        let mut numbers = vec![0; count];
        order.iter().enumerate().for_each(|(number, axis)| numbers[*axis] = number);
        let solved = (0..count).map(|axis| solved.contains(&axis)).collect();
        Ok(Self { words, solved, letters, numbers, arm })
    }
}

/// Returns the warnings for a programmer: W0601, W0760, W0761.
pub fn warnings(machine: &Machine, model: &ModuleModel) -> Vec<Diagnostic> {
    let mut all = Vec::new();
    if model.words == ModuleWords::Axes {
        let message =
            "the axes cannot bring the tool everywhere: words of the program are positions of axes, not of the tip";
        all.push(
            Diagnostic::new(codes::W0760, message)
                .help("the axes that are there correct what they can move; the certificate states the residual"),
        );
    }
    for (axis, joint) in machine.axes().iter().zip(&model.joints) {
        let Some(letter) = joint.letter.and_then(|letter| WORLD.get(letter..=letter)) else { continue };
        if joint.rotary && "UVW".contains(letter) {
            let message = format!("the rotary axis `{}` has the letter {letter}: A, B and C are taken", axis.name);
            let help = format!("program degrees with {letter} in G21 only; G20 would multiply them by 25.4");
            all.push(Diagnostic::new(codes::W0761, message).help(help));
        } else if axis.name.as_str() != letter {
            let message = format!("axis `{}` is written as `{letter}`: the controller has no such letter", axis.name);
            all.push(Diagnostic::new(codes::W0601, message));
        }
    }
    all
}

/// Linear axes: X, Y, Z, then free names along the walk, then U, V, W.
fn linear_by_letter(machine: &Machine) -> Vec<usize> {
    let axes = machine.axes();
    let mut linear: Vec<usize> = (0..axes.len()).filter(|i| axes[*i].kind == AxisKind::Linear).collect();
    let rank = |axis: &Axis| match "XYZUVW".find(axis.name.as_str()).filter(|_| axis.name.as_str().len() == 1) {
        Some(letter) if letter < 3 => letter,
        Some(letter) => letter + 1,
        None => 3,
    };
    linear.sort_by_key(|i| rank(&axes[*i]));
    linear
}

/// Below this determinant three linear axes do not span the room.
pub const FLAT: f64 = 1e-6;

/// The first three that span the room with all axes at 0.
fn spanning(machine: &Machine, linear: &[usize]) -> Option<Vec<usize>> {
    let way = |i: usize| Vector3::from(machine.axes()[linear[i]].direction);
    let triples = (0..linear.len()).flat_map(|a| (a + 1..linear.len()).map(move |b| (a, b)));
    let mut triples = triples.flat_map(|(a, b)| (b + 1..linear.len()).map(move |c| [a, b, c]));
    let found = triples.find(|t| Matrix3::from_columns(&t.map(way)).determinant().abs() > FLAT)?;
    Some(found.map(|i| linear[i]).to_vec())
}

/// Linear axes none of which is made of those before it.
fn independent(machine: &Machine, linear: &[usize], flat: f64) -> Vec<usize> {
    let (mut found, mut base): (Vec<usize>, Vec<Vector3<f64>>) = (Vec::new(), Vec::new());
    for axis in linear {
        let rest = across(Vector3::from(machine.axes()[*axis].direction), &base);
        if rest.norm() > flat {
            base.push(rest.normalize());
            found.push(*axis);
        }
    }
    found
}

/// Returns the part of a vector that is orthogonal to orthonormal ones.
fn across<const N: usize>(vector: SVector<f64, N>, base: &[SVector<f64, N>]) -> SVector<f64, N> {
    base.iter().fold(vector, |rest, unit| rest - unit * unit.dot(&rest))
}

/// Six axes that move the tool in all degrees of freedom at some pose of the volume, those next to the tool first; in
/// the order of the walk.
fn six(model: &ModuleModel, poses: &[Pose], arm: f64, flat: f64) -> Option<Vec<usize>> {
    if model.joints.len() < 6 {
        return None;
    }
    let choice = |pose: &Pose| {
        let columns = columns(model, pose, arm);
        let (mut chosen, mut base): (Vec<usize>, Vec<Vector6<f64>>) = (Vec::new(), Vec::new());
        for axis in (0..columns.len()).rev() {
            let rest = across(columns[axis], &base);
            if base.len() < 6 && rest.norm() > flat {
                base.push(rest.normalize());
                chosen.push(axis);
            }
        }
        chosen.reverse();
        let six: [usize; 6] = chosen.try_into().ok()?;
        let weakest = Matrix6::from_columns(&six.map(|i| columns[i])).try_inverse()?.norm().recip();
        (weakest > flat).then_some((weakest, six))
    };
    let best = poses.iter().filter_map(choice).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(best.1.to_vec())
}

/// Motion of the tool per unit of each axis: the tip's in arms, then the rotation.
fn columns(model: &ModuleModel, pose: &Pose, arm: f64) -> Vec<Vector6<f64>> {
    let place = model.place(&model.setting(), pose);
    let column = |((joint, lever), turn): ((&ModuleJoint, &Vector3<f64>), &Vector3<f64>)| {
        let way = if joint.rotary { lever / arm } else { *lever };
        Vector6::new(way[0], way[1], way[2], turn[0], turn[1], turn[2])
    };
    model.joints.iter().zip(&place.lever).zip(&place.turn).map(column).collect()
}

/// Smallest arm, mm.
const SHORTEST: f64 = 1.0;

fn arm(model: &ModuleModel, poses: &[Pose]) -> f64 {
    let levers = |pose: &Pose| {
        let place = model.place(&model.setting(), pose);
        let rotary = model.joints.iter().zip(place.lever).filter(|(joint, _)| joint.rotary);
        rotary.map(|(_, lever)| lever.norm_squared()).collect::<Vec<_>>()
    };
    let squares: Vec<f64> = poses.iter().flat_map(levers).collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    // Whole millimetres: it is no more than a weight.
    libm::round(libm::sqrt(mean)).max(SHORTEST)
}

/// Coordinates of the axes that are programmed themselves: their own letters, then whatever is free.
fn letters(machine: &Machine, words: ModuleWords, solved: &[usize]) -> Result<Vec<Option<usize>>, Diagnostic> {
    let free = match words {
        ModuleWords::Tip => "ABCUVW",
        ModuleWords::Pose => "UVW",
        ModuleWords::Axes => WORLD,
    };
    let axes = machine.axes();
    let programmed: Vec<usize> =
        (0..axes.len()).filter(|i| words == ModuleWords::Axes || !solved.contains(i)).collect();
    let usual = |axis: &Axis| if axis.kind == AxisKind::Linear { "XYZUVW" } else { "ABC" };
    let mut letters = vec![None; axes.len()];
    let mut taken = String::new();
    let own = |axis: &Axis, name: char| axis.name.as_str() == name.to_string();
    type Fits<'a> = &'a dyn Fn(&Axis, char) -> bool;
    let rounds: [Fits<'_>; 3] =
        [&|axis, c| own(axis, c) && usual(axis).contains(c), &|axis, c| usual(axis).contains(c), &|axis, c| {
            axis.kind == AxisKind::Rotary && "UVW".contains(c)
        }];
    for fits in rounds {
        for i in &programmed {
            let letter = free.chars().find(|c| fits(&axes[*i], *c) && !taken.contains(*c));
            if let (None, Some(letter)) = (letters[*i], letter) {
                taken.push(letter);
                letters[*i] = WORLD.find(letter);
            }
        }
    }
    match programmed.iter().find(|i| letters[**i].is_none()) {
        Some(i) => Err(no_letter(&axes[*i], words)),
        None => Ok(letters),
    }
}

fn no_letter(axis: &Axis, words: ModuleWords) -> Diagnostic {
    let taken = match words {
        ModuleWords::Tip => "X, Y and Z are the tip; ",
        ModuleWords::Pose => "X, Y, Z, A, B and C are the pose of the tool; ",
        ModuleWords::Axes => "",
    };
    let message = format!("the controller has no free letter for axis `{}`", axis.name);
    Diagnostic::new(codes::E0752, message).help(format!(
        "{taken}linear axes have the letters X Y Z U V W, rotary ones A B C, then U V W; take an axis out of the chain"
    ))
}
