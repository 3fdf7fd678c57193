//! The exact rigid-body model of a machine, from sections 3 and 4 of the theory.
//!
//! Every factor is a motion of space in machine coordinates at the zero pose; a factor that acts about
//! a point is moved there and back by translations. No closed form of a product is used anywhere.

use super::matrix::{
    M4, ONE, V3, V6, apply, combine, cross, elementary, exp, inverse, minus, mul, norm, plus, product, translation,
    transposed, turn, twist,
};

/// The conventions of a machine; `false` is the default of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conventions {
    /// `location: carried_body` instead of `axis_only`.
    pub carried_body: bool,
    /// `linear: before` instead of `after`.
    pub before: bool,
    /// `rotary: rotating` instead of `stationary`.
    pub rotating: bool,
    /// `workpiece_axes: direct` instead of `iso841`.
    pub direct: bool,
    /// `errors_are: body` instead of `tool_relative`.
    pub body: bool,
    /// `location_order: real` instead of `nilpotent`. The exact model does not know the difference.
    pub real: bool,
    /// `joints: linearised` instead of `orthogonal`.
    pub linearised: bool,
}

/// One axis of the walk from workpiece to tool.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its name in the file.
    pub name: String,
    /// Rotary or linear.
    pub rotary: bool,
    /// True on the workpiece side of the bed.
    pub workpiece: bool,
    /// `sense` of this axis, where it differs from the convention of the machine.
    pub direct: Option<bool>,
    /// Direction, of any length.
    pub direction: V3,
    /// A point on the axis, or the one about which a linear axis' angular errors turn.
    pub origin: V3,
    /// Location errors in mm and rad.
    pub location: V6,
}

/// A machine.
#[derive(Clone, Debug, Default)]
pub struct Machine {
    /// Conventions of its errors.
    pub conventions: Conventions,
    /// Its axes from workpiece to tool.
    pub walk: Vec<Axis>,
    /// Location errors of the spindle.
    pub spindle: Option<V6>,
    /// The gauge point of the spindle.
    pub gauge: V3,
    /// The tip of the tool from the gauge point.
    pub offset: V3,
    /// The origin of the workpiece.
    pub workpiece_origin: V3,
    /// Angles (deg) by which the coordinates of the part are turned about X, then Y, then Z of the machine.
    pub workpiece_rotation: V3,
    /// Displacement of the tip by clamping the tool.
    pub tool_setup: V3,
    /// Displacement of the workpiece by clamping it.
    pub workpiece_setup: V6,
}

/// The frame of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// The workpiece's.
    Workpiece,
    /// The bed's.
    Machine,
    /// The tool's.
    Tool,
}

/// One axis' position (mm, rad) and component errors (mm, rad).
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// The programmed position.
    pub position: f64,
    /// The six component errors there.
    pub errors: V6,
}

/// Answer of the program at a pose.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Ideal position of the tip from the workpiece origin.
    pub nominal: V3,
    /// Actual minus nominal position of the tip.
    pub deviation: V3,
    /// Actual minus nominal orientation.
    pub rotation: V3,
    /// The volumetric error matrix.
    pub e_ve: M4,
}

/// Place of the tool, in the workpiece frame before its rotation.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// Its tip from the workpiece origin.
    pub tip: V3,
    /// Rotation; with linearised joints no rotation matrix.
    pub rotation: M4,
}

impl Held {
    /// The direction of its axis; with linearised joints not of length 1.
    pub fn axis(&self) -> V3 {
        turn(&self.rotation, [0.0, 0.0, 1.0])
    }
}

impl Machine {
    /// Returns the place of the tool of the actual machine, then of the nominal one.
    pub fn holds(&self, states: &[State]) -> [Held; 2] {
        let tip = plus(self.gauge, self.offset);
        let held = |walk: M4, tip: V3| Held {
            tip: minus(apply(&walk, tip), self.workpiece_origin),
            rotation: rotation_of(&walk),
        };
        [held(self.real(states), plus(tip, self.tool_setup)), held(self.ideal(states, |_| true), tip)]
    }

    /// The answer at a pose, `states` in the order of the walk.
    pub fn evaluate(&self, states: &[State], frame: Frame) -> Answer {
        let ideal = self.ideal(states, |_| true);
        let real = self.real(states);
        let tip = plus(self.gauge, self.offset);
        let real_tip = plus(tip, self.tool_setup);
        let (there, back) = (translation(self.workpiece_origin), inverse(&translation(self.workpiece_origin)));
        let (nominal, actual) = (mul(&back, &ideal), mul(&back, &real));
        let turned = mul(&rotation_of(&real), &transposed(&rotation_of(&ideal)));
        let in_frame = |v| self.express(states, &ideal, frame, v);
        let part = mul(&there, &self.part());
        let tool_to_workpiece = |walk: &M4, tip| product(&[inverse(&translation(tip)), inverse(walk), part]);
        Answer {
            nominal: in_frame(apply(&nominal, tip)),
            deviation: in_frame(minus(apply(&actual, real_tip), apply(&nominal, tip))),
            rotation: in_frame(if self.conventions.linearised { skew(&turned) } else { log(&turned) }),
            e_ve: combine(&tool_to_workpiece(&real, real_tip), -1.0, &tool_to_workpiece(&ideal, tip)),
        }
    }

    /// The ideal walk over the axes that `which` selects.
    fn ideal(&self, states: &[State], which: impl Fn(&Axis) -> bool) -> M4 {
        let used = self.walk.iter().zip(states).filter(|(axis, _)| which(axis));
        used.fold(ONE, |walk, (axis, state)| mul(&walk, &self.motion(axis, state.position)))
    }

    /// The real walk, from the clamped workpiece to the tool.
    fn real(&self, states: &[State]) -> M4 {
        // A clamped workpiece lies displaced about its origin, so the tool is seen displaced in the opposite direction.
        let clamped = about(self.workpiece_origin, &self.displacement(self.workpiece_setup));
        let walk = self
            .walk
            .iter()
            .zip(states)
            .fold(inverse(&clamped), |walk, (axis, state)| mul(&walk, &self.joint(axis, state)));
        match self.spindle {
            Some(location) => mul(&walk, &about(self.gauge, &self.displacement(location))),
            None => walk,
        }
    }

    /// The relative motion of tool and workpiece that an axis makes, with all its errors.
    fn joint(&self, axis: &Axis, state: &State) -> M4 {
        let Conventions { carried_body, before, rotating, body, .. } = self.conventions;
        let motion = self.motion(axis, state.position);
        let mut error = about(axis.origin, &self.displacement(state.errors));
        let mut location = about(axis.origin, &self.displacement(axis.location));
        if axis.workpiece && body {
            error = inverse(&error);
            if carried_body {
                location = inverse(&location);
            }
        }
        let moves_along = if axis.rotary { rotating } else { !before };
        // Written from the bed outwards; the workpiece half of the walk is read in reverse.
        let mut outwards = Vec::new();
        if carried_body {
            outwards.push(location);
        }
        let located = if carried_body { motion } else { product(&[location, motion, inverse(&location)]) };
        outwards.extend(if moves_along { [located, error] } else { [error, located] });
        if axis.workpiece {
            outwards.reverse();
        }
        product(&outwards)
    }

    /// The ideal relative motion of tool and workpiece that an axis makes.
    fn motion(&self, axis: &Axis, position: f64) -> M4 {
        let direct = axis.workpiece && axis.direct.unwrap_or(self.conventions.direct);
        let q = if direct { -position } else { position };
        let u = axis.direction.map(|c| c / norm(axis.direction));
        let v = if axis.rotary { cross(axis.origin, u) } else { u };
        let w = if axis.rotary { u } else { [0.0; 3] };
        exp(&twist([v[0], v[1], v[2], w[0], w[1], w[2]].map(|c| c * q)))
    }

    /// The small displacement by six errors: translation after rotation.
    fn displacement(&self, e: V6) -> M4 {
        let hat = twist([0.0, 0.0, 0.0, e[3], e[4], e[5]]);
        let rotation = if self.conventions.linearised { combine(&ONE, 1.0, &hat) } else { exp(&hat) };
        mul(&translation([e[0], e[1], e[2]]), &rotation)
    }

    /// The rotation of the part's coordinates into machine directions at the zero pose.
    pub fn part(&self) -> M4 {
        let [a, b, c] = self.workpiece_rotation.map(f64::to_radians);
        product(&[elementary(2, c), elementary(1, b), elementary(0, a)])
    }

    /// A vector of the workpiece frame before its rotation in a frame.
    fn express(&self, states: &[State], ideal: &M4, frame: Frame, v: V3) -> V3 {
        match frame {
            Frame::Workpiece => turn(&transposed(&self.part()), v),
            Frame::Machine => turn(&inverse(&rotation_of(&self.ideal(states, |axis| axis.workpiece))), v),
            Frame::Tool => turn(&inverse(&rotation_of(ideal)), v),
        }
    }
}

/// A motion made about a point instead of the machine zero.
fn about(point: V3, motion: &M4) -> M4 {
    product(&[translation(point), *motion, inverse(&translation(point))])
}

/// A motion without its translation.
fn rotation_of(m: &M4) -> M4 {
    std::array::from_fn(|r| std::array::from_fn(|c| if c < 3 { m[r][c] } else { ONE[r][c] }))
}

/// The vector of the skew part of a matrix.
fn skew(m: &M4) -> V3 {
    [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]].map(|c| c / 2.0)
}

/// The rotation vector of a rotation by less than half a turn.
fn log(m: &M4) -> V3 {
    let axis = skew(m);
    let (sine, cosine) = (norm(axis), (m[0][0] + m[1][1] + m[2][2] - 1.0) / 2.0);
    let stretch = if sine > 0.0 { sine.atan2(cosine) / sine } else { 1.0 };
    axis.map(|c| c * stretch)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain from single letters; a prime marks the workpiece side.
    fn machine(chain: &str) -> Machine {
        let axis = |word: &str| {
            let letter = word.chars().next().unwrap();
            let index = "XYZABC".find(letter).unwrap();
            let mut direction = [0.0; 3];
            direction[index % 3] = 1.0;
            let (name, workpiece) = (letter.to_string(), word.ends_with('\''));
            Axis { name, rotary: index > 2, workpiece, direct: None, direction, origin: [0.0; 3], location: [0.0; 6] }
        };
        Machine { walk: chain.split(' ').map(axis).collect(), ..Machine::default() }
    }

    fn at(position: f64) -> State {
        State { position, ..State::default() }
    }

    fn close(a: V3, b: V3, tolerance: f64) {
        assert!(norm(minus(a, b)) <= tolerance, "{a:?} is not {b:?}");
    }

    #[test]
    fn squareness_has_the_sign_of_the_standard() {
        for chain in ["X Y Z", "X Y' Z"] {
            let mut machine = machine(chain);
            machine.walk[1].location[5] = 10e-6;
            let answer = machine.evaluate(&[at(0.0), at(500.0), at(0.0)], Frame::Workpiece);
            // 500 mm are shortened by the cosine of 10 urad.
            close(answer.deviation, [-500.0 * 10e-6_f64.sin(), 500.0 * (10e-6_f64.cos() - 1.0), 0.0], 1e-13);
        }
    }

    #[test]
    fn an_eccentric_table_shows_twice_its_offset_after_half_a_turn() {
        let mut machine = machine("C'");
        machine.walk[0].location[0] = 0.01;
        let states = [at(std::f64::consts::PI)];
        close(machine.evaluate(&states, Frame::Workpiece).deviation, [0.02, 0.0, 0.0], 1e-15);
        close(machine.evaluate(&states, Frame::Machine).deviation, [-0.02, 0.0, 0.0], 1e-15);
        close(machine.evaluate(&[at(0.0)], Frame::Workpiece).deviation, [0.0; 3], 0.0);
    }

    #[test]
    fn the_volumetric_error_holds_the_deviation_to_first_order() {
        let mut machine = machine("C' A' Y X Z B");
        (machine.gauge, machine.offset, machine.workpiece_origin) =
            ([10.0, 0.0, 5.0], [3.0, 0.0, -120.0], [40.0, 7.0, -90.0]);
        let state =
            |i: usize| State { position: 0.3 + i as f64, errors: std::array::from_fn(|k| 1e-7 * (k + 2 * i) as f64) };
        let states: Vec<_> = (0..6).map(state).collect();
        let answer = machine.evaluate(&states, Frame::Workpiece);
        let ideal = machine.ideal(&states, |_| true);
        let expected = minus(cross(answer.rotation, answer.nominal), answer.deviation);
        let expected = turn(&transposed(&rotation_of(&ideal)), expected);
        let column = std::array::from_fn(|r| answer.e_ve[r][3]);
        assert!(norm(answer.deviation) > 1e-4, "no error to speak of: {:?}", answer.deviation);
        // Squares of a few urad over 200 mm.
        close(column, expected, 1e-8);
    }

    #[test]
    fn a_displaced_workpiece_and_tool_are_seen_as_one_would_expect() {
        let mut machine = machine("X Y Z");
        machine.workpiece_origin = [100.0, 0.0, 0.0];
        machine.tool_setup = [0.0, 0.0, 0.003];
        machine.workpiece_setup = [0.010, 0.0, 0.0, 0.0, 0.0, 20e-6];
        let answer = machine.evaluate(&[at(600.0), at(0.0), at(0.0)], Frame::Workpiece);
        close(answer.nominal, [500.0, 0.0, 0.0], 0.0);
        // The workpiece moved by +10 um and turned by +20 urad: the tool is 10 um short and 10 um to its right.
        close(answer.deviation, [-0.010, -0.010, 0.003], 3e-7);
        close(answer.rotation, [0.0, 0.0, -20e-6], 1e-18);
    }
}
