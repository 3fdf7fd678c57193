//! From lines of rotary axes that were found to the location errors that place them there.

use super::parameters::Parameters;
use super::transformation::Transformation;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{Direction, ErrorFamily, ErrorId, Machine, MovedLine};
use nalgebra::Vector3;

/// Steps of the search for location errors; each leaves their products of the step before.
const STEPS: usize = 6;

/// Largest difference of a line that the errors found may leave: mm, and sine of an angle.
const CLOSED: f64 = 1e-9;

/// Displacement (mm, rad) by which a number shows that it depends on an error; above any increment.
const PROBE: f64 = 0.1;

/// Six location errors of each line in the order of the walk, and the turn of the tool axis (mm, rad).
struct Located {
    lines: Vec<(usize, [f64; 6])>,
    tool: Vector3<f64>,
}

impl Transformation {
    /// Returns the location errors (mm, rad) that place the rotary axes of a machine on these lines, and its spindle
    /// along this tool axis if the chain has one: all that are not 0 by the geometry. Location errors of the machine
    /// do not count. Refusal: E0751, of a machine or lines that location errors do not lead to.
    pub fn location_errors(&self, machine: &Machine) -> Result<Vec<(ErrorId, f64)>, Diagnostic> {
        let mut found = Located::none(&Self::nominal(machine)?);
        for _ in 0..STEPS {
            let step = self.from(&Self::actual(&found.on(machine)?)?, machine)?;
            found.add(&step);
        }
        let left = self.from(&Self::actual(&found.on(machine)?)?, machine)?;
        if !left.numbers().all(|x| x.abs() <= CLOSED) {
            return Err(unreached_diagnostic());
        }
        Ok(found.errors(machine))
    }

    /// The motion from other lines to these: shifts across the nominal lines, and turns.
    fn from(&self, other: &Self, machine: &Machine) -> Result<Located, Diagnostic> {
        let nominal = Self::nominal(machine)?;
        let all = |of: &Self| of.table.iter().chain(&of.head).cloned().collect::<Vec<_>>();
        let lines = all(&nominal).into_iter().zip(all(self)).zip(all(other)).map(|((nominal, own), other)| {
            let foot = |point: Vector3<f64>, along: Vector3<f64>| point + along * along.dot(&(nominal.point - point));
            let shift = foot(own.point, own.direction) - foot(other.point, other.direction);
            let across = shift - nominal.direction * nominal.direction.dot(&shift);
            let turn = other.direction.cross(&own.direction);
            let turn = turn - nominal.direction * nominal.direction.dot(&turn);
            (nominal.axis, [across[0], across[1], across[2], turn[0], turn[1], turn[2]])
        });
        Ok(Located { lines: lines.collect(), tool: other.tool.cross(&self.tool) })
    }
}

fn unreached_diagnostic() -> Diagnostic {
    Diagnostic::new(codes::E0751, "no location errors of this machine lead to the lines of the rotary axes").help(
        "check points and directions; under conventions that displace bodies, `abbe convert` writes the machine \
               with `location: axis_only`",
    )
}

impl Located {
    fn none(nominal: &Transformation) -> Self {
        let lines = nominal.table.iter().chain(&nominal.head).map(|line| (line.axis, [0.0; 6]));
        Self { lines: lines.collect(), tool: Vector3::zeros() }
    }

    fn add(&mut self, step: &Self) {
        for ((_, six), (_, more)) in self.lines.iter_mut().zip(&step.lines) {
            six.iter_mut().zip(more).for_each(|(x, more)| *x += more);
        }
        self.tool += step.tool;
    }

    fn numbers(&self) -> impl Iterator<Item = f64> {
        self.lines.iter().flat_map(|(_, six)| *six).chain(self.tool.iter().copied())
    }

    /// The machine with these location errors of rotary axes and spindle, nominal otherwise.
    fn on(&self, machine: &Machine) -> Result<Machine, Diagnostic> {
        let nominal = Transformation::nominal(machine)?;
        let moved = self.lines.iter().map(|(axis, location)| {
            let of = &machine.axes()[*axis];
            MovedLine { axis: *axis, direction: of.direction, origin: of.origin, location: *location }
        });
        let moved: Vec<MovedLine> = moved.collect();
        let tip = machine.tool().tip;
        let bare = machine.filtered(|id| id.family == ErrorFamily::Component);
        let turn = self.tool;
        Ok(bare.with_lines(&moved, nominal.tool.into(), tip, [0.0, 0.0, 0.0, turn[0], turn[1], turn[2]]))
    }

    fn errors(&self, machine: &Machine) -> Vec<(ErrorId, f64)> {
        let named = |axis: &crate::machine::AxisName, k: usize| ErrorId {
            axis: axis.clone(),
            family: ErrorFamily::Location,
            direction: Direction::ALL[k],
        };
        let across = |axis: usize, k: usize| machine.axes()[axis].direction[k % 3].abs() < 1.0 - CLOSED;
        let lines = self.lines.iter().flat_map(|(axis, six)| {
            let name = &machine.axes()[*axis].name;
            let letters = (0..6).filter(|k| across(*axis, *k));
            letters.map(|k| (named(name, k), six[k])).collect::<Vec<_>>()
        });
        let spindle = machine.chain().spindle().into_iter().flat_map(|name| {
            let letters = (0..3).filter(|k| machine.tool().direction[*k].abs() < 1.0 - CLOSED);
            letters.map(|k| (named(name, k + 3), self.tool[k])).collect::<Vec<_>>()
        });
        lines.chain(spindle).collect()
    }
}

impl Parameters {
    /// True if a location error changes some number. Refusal: E0751.
    pub fn tells(&self, machine: &Machine, id: &ErrorId) -> Result<bool, Diagnostic> {
        let mut one = Located::none(&Transformation::nominal(machine)?);
        let k = id.direction.index();
        match machine.axis_index(id.axis.as_str()) {
            Some(axis) => one.lines.iter_mut().filter(|line| line.0 == axis).for_each(|line| line.1[k] = PROBE),
            None => one.tool[k % 3] = PROBE,
        }
        let displaced = Transformation::actual(&one.on(machine)?)?;
        Ok(self.differs(&displaced))
    }
}
