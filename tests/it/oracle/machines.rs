//! Random machines of every topology, as data for the oracle; `yaml` writes them for the program.

use super::curves::{Curve, Error, Points, Travel};
use super::matrix::V6;
use super::random::Random;
use super::rigid::{Answer, Axis, Conventions, Frame, Held, Machine, State};

/// A machine with its error curves.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Geometry, conventions and location errors.
    pub rigid: Machine,
    /// The rest of each axis, in the order of the walk.
    pub axes: Vec<Extra>,
    /// Written as two branches instead of a chain.
    pub branches: bool,
}

/// Data of an axis beside its place in the rigid machine.
#[derive(Clone, Debug)]
pub struct Extra {
    /// Both ends, or a continuous axis.
    pub travel: Option<[f64; 2]>,
    /// Component errors in the order X Y Z A B C.
    pub errors: [Option<Error>; 6],
}

/// Positions of the axes in the order of the walk, in mm and deg.
pub type Pose = Vec<f64>;

impl Sample {
    /// Returns a random machine whose errors are about `size` rad, and `size` times a metre (at most some mm).
    pub fn random(random: &mut Random, conventions: Conventions, size: f64) -> Self {
        let count = 3 + random.below(4);
        let mut names = names(random, count);
        random.shuffle(&mut names);
        let on_workpiece = random.below(count + 1);
        let walk: Vec<_> =
            names.iter().enumerate().map(|(i, name)| axis(random, name, i < on_workpiece, size)).collect();
        let axes = walk.iter().map(|axis| extra(random, axis, size)).collect();
        let spindle = random.chance(0.4).then(|| six(random, size));
        let rigid = Machine {
            conventions,
            walk,
            spindle,
            gauge: random.vector(200.0),
            offset: tool(random),
            workpiece_origin: random.vector(300.0),
            workpiece_rotation: [0.0; 3],
            tool_setup: if random.chance(0.4) { random.vector(amplitude(0, size)) } else { [0.0; 3] },
            workpiece_setup: if random.chance(0.4) { six(random, size) } else { [0.0; 6] },
        };
        Self { branches: spindle.is_none() && random.chance(0.3), rigid, axes }
    }

    /// The same machine with component errors and set-up times one factor, location errors times another.
    pub fn scaled(&self, component: f64, location: f64) -> Self {
        let mut other = self.clone();
        for (axis, extra) in other.rigid.walk.iter_mut().zip(&mut other.axes) {
            axis.location = axis.location.map(|e| e * location);
            for error in extra.errors.iter_mut().flatten() {
                *error = error.scaled(component);
            }
        }
        other.rigid.spindle = self.rigid.spindle.map(|six| six.map(|e| e * location));
        other.rigid.tool_setup = self.rigid.tool_setup.map(|e| e * component);
        other.rigid.workpiece_setup = self.rigid.workpiece_setup.map(|e| e * component);
        other
    }

    /// Random poses within the travels; a tenth of the positions are zero.
    pub fn poses(&self, random: &mut Random, count: usize) -> Vec<Pose> {
        let mut position = |extra: &Extra| {
            // Continuous axes are tested beyond a turn in both directions.
            let [low, high] = extra.travel.unwrap_or([-500.0, 800.0]);
            if random.chance(0.1) { 0.0 } else { random.between(low, high) }
        };
        (0..count).map(|_| self.axes.iter().map(&mut position).collect()).collect()
    }

    /// The oracle's answer.
    pub fn evaluate(&self, pose: &Pose, travel: Travel, frame: Frame) -> Answer {
        self.rigid.evaluate(&self.states(pose, travel), frame)
    }

    /// Returns the place of the tool at a command, with and without errors.
    pub fn holds(&self, command: &Pose, travel: Travel) -> [Held; 2] {
        self.rigid.holds(&self.states(command, travel))
    }

    fn states(&self, pose: &Pose, travel: Travel) -> Vec<State> {
        let state = |((axis, extra), &position): ((&Axis, &Extra), &f64)| State {
            position: if axis.rotary { position.to_radians() } else { position },
            errors: std::array::from_fn(|k| extra.errors[k].as_ref().map_or(0.0, |e| e.at(position, travel))),
        };
        self.rigid.walk.iter().zip(&self.axes).zip(pose).map(state).collect()
    }
}

/// Every combination of the five conventions that change the order of factors or their sense.
pub fn combinations() -> impl Iterator<Item = Conventions> {
    (0..32).map(|bits: u32| Conventions {
        carried_body: bits & 1 != 0,
        before: bits & 2 != 0,
        rotating: bits & 4 != 0,
        direct: bits & 8 != 0,
        body: bits & 16 != 0,
        ..Conventions::default()
    })
}

/// Names that are conventional (X, A, ...) and free ones.
fn names(random: &mut Random, count: usize) -> Vec<String> {
    let mut letters: Vec<String> = "XYZUVWABC".chars().map(String::from).collect();
    random.shuffle(&mut letters);
    let free = (1..=6).map(|i| format!("J{i}"));
    let mut names: Vec<_> = letters.into_iter().take(4).chain(free).collect();
    random.shuffle(&mut names);
    names.truncate(count);
    names
}

fn axis(random: &mut Random, name: &str, workpiece: bool, size: f64) -> Axis {
    let letter = "XYZUVWABC".find(name);
    let rotary = letter.map_or(random.chance(0.5), |i| i >= 6);
    let direction = match letter {
        Some(i) if random.chance(0.5) => std::array::from_fn(|k| if k == i % 3 { 1.0 } else { 0.0 }),
        _ => random.vector(2.0),
    };
    Axis {
        name: name.into(),
        rotary,
        workpiece,
        direct: (workpiece && random.chance(0.2)).then(|| random.chance(0.5)),
        direction,
        origin: random.vector(400.0),
        location: if random.chance(0.7) { six(random, size) } else { [0.0; 6] },
    }
}

fn extra(random: &mut Random, axis: &Axis, size: f64) -> Extra {
    let travel = match axis.rotary {
        true if random.chance(0.5) => None,
        true => Some([-random.between(20.0, 130.0), random.between(20.0, 130.0)]),
        false => Some([-random.between(50.0, 500.0), random.between(50.0, 500.0)]),
    };
    let errors = std::array::from_fn(|k| random.chance(0.6).then(|| error(random, axis, travel, amplitude(k, size))));
    Extra { travel, errors }
}

fn error(random: &mut Random, axis: &Axis, travel: Option<[f64; 2]>, size: f64) -> Error {
    let forward = curve(random, axis, travel, size);
    Error { forward, reverse: random.chance(0.25).then(|| curve(random, axis, travel, size)) }
}

fn curve(random: &mut Random, axis: &Axis, travel: Option<[f64; 2]>, size: f64) -> Curve {
    let reach = travel.map_or(180.0, |[low, high]| f64::max(-low, high));
    match random.below(5) {
        0 => Curve::Constant(random.around(size)),
        // Polynomials do not close after a turn, harmonics have no period on a linear axis.
        1 if travel.is_some() => {
            let degree = 1 + random.below(3) as i32;
            Curve::Polynomial((0..=degree).map(|k| random.around(size) / reach.powi(k)).collect())
        }
        2 if axis.rotary => {
            let term = |k| (k, random.around(size), if k == 0 { 0.0 } else { random.around(size) });
            Curve::Harmonics([0, 1, 2, 5].map(term).to_vec())
        }
        _ => Curve::Points(points(random, travel, size)),
    }
}

/// A table at unequal steps that reaches a little beyond the travel.
fn points(random: &mut Random, travel: Option<[f64; 2]>, size: f64) -> Points {
    let [low, high] = travel.map_or([0.0, 360.0], |[low, high]| [low - 1.0, high + 1.0]);
    let steps = 2 + random.below(8);
    let inner = |i: usize, jitter: f64| low + (high - low) * (i as f64 + jitter) / steps as f64;
    let mut at: Vec<f64> = (0..=steps).map(|i| inner(i, random.around(0.4))).collect();
    (at[0], at[steps]) = (low, high);
    let mut values: Vec<f64> = at.iter().map(|_| random.around(size)).collect();
    if travel.is_none() {
        values[steps] = values[0];
    }
    Points { at, values, cubic: random.chance(0.5), periodic: travel.is_none(), file: random.chance(0.2) }
}

/// Six errors: translations in mm, rotations in rad.
fn six(random: &mut Random, size: f64) -> V6 {
    std::array::from_fn(|k| random.around(amplitude(k, size)))
}

/// The amplitude of a component: lengths go with a metre, but the program refuses curves over 10 mm.
fn amplitude(component: usize, size: f64) -> f64 {
    if component < 3 { (1000.0 * size).min(1.0) } else { size }
}

/// Half of the tools are a length along Z, the others any vector.
fn tool(random: &mut Random) -> [f64; 3] {
    if random.chance(0.5) { [0.0, 0.0, -random.between(20.0, 300.0)] } else { random.vector(200.0) }
}
