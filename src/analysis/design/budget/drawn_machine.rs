//! A drawn machine as a machine with values, for what needs more than its deviations: the files of a control.

use super::bounds::Bound;
use super::draw::{Draws, NODES};
use crate::machine::{ComponentError, Curve, ErrorFamily, ErrorTerm, JointErrors, Knots, Machine, Travel};

/// Returns the machine that a sample draws between bounds: these errors have values, and no others.
pub fn drawn_machine(machine: &Machine, bounds: &[Bound], draws: &Draws, sample: usize) -> Machine {
    let joints = machine.axes().len() + usize::from(machine.chain().spindle().is_some());
    let errors = (0..joints).map(|joint| {
        let axis = machine.axes().get(joint);
        let name = axis.map(|axis| &axis.name).or(machine.chain().spindle());
        let own: Vec<&Bound> = bounds.iter().filter(|bound| Some(&bound.error.axis) == name).collect();
        let location = constants(&own, draws, sample);
        let component = axis.map_or_else(Default::default, |axis| curves(&own, draws, sample, axis.travel));
        JointErrors { location, component }
    });
    machine.with_errors(errors.collect())
}

fn constants(bounds: &[&Bound], draws: &Draws, sample: usize) -> [Option<ErrorTerm>; 6] {
    let mut sums = [None; 6];
    for bound in bounds.iter().filter(|bound| bound.error.family == ErrorFamily::Location) {
        let value = bound.tolerance * draws.constant(&bound.stream(), sample);
        for (sum, part) in sums.iter_mut().zip(bound.letters()).filter(|(_, part)| *part != 0.0) {
            *sum = Some(sum.unwrap_or(0.0) + part * value);
        }
    }
    sums.map(|sum| sum.map(ErrorTerm::Constant))
}

fn curves(bounds: &[&Bound], draws: &Draws, sample: usize, travel: Travel) -> [Option<ErrorTerm>; 6] {
    let ((min, max), closed) = (travel.interval(), travel == Travel::Continuous);
    let mut sums: [Option<[f64; NODES]>; 6] = [None; 6];
    for bound in bounds.iter().filter(|bound| bound.error.family == ErrorFamily::Component) {
        let values = draws.curve(&bound.stream(), sample, closed);
        for (sum, part) in sums.iter_mut().zip(bound.letters()).filter(|(_, part)| *part != 0.0) {
            let sum = sum.get_or_insert([0.0; NODES]);
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += part * bound.tolerance * value);
        }
    }
    let last = NODES - 1;
    let curve = |mut values: [f64; NODES]| {
        if closed {
            values[last] = values[0];
        }
        let at = |m: usize| if m == last { max } else { min + (max - min) * (m as f64 / last as f64) };
        let points: Vec<(f64, f64)> = values.iter().enumerate().map(|(m, value)| (at(m), *value)).collect();
        // An axis that does not move has one position.
        let knots = Knots::new(&points, closed.then_some(max - min)).or_else(|_| Knots::new(&points[..1], None));
        knots.ok().map(|knots| ErrorTerm::Component(ComponentError::Single(Curve::Linear(knots))))
    };
    sums.map(|sum| sum.and_then(curve))
}
