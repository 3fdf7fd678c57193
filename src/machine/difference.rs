//! Two machines against each other: what differs, in the field's words, and the first with one of the differences.

use super::{Approach, Axis, AxisName, Branch, Direction, ErrorFamily, ErrorId, ErrorTerm, Grid, JointErrors, Machine};

/// A property in which two machines differ.
#[derive(Debug, Clone, PartialEq)]
pub enum MachineProperty {
    /// Order and sides of the axes. An axis that only the second has comes without errors; one that only the first has
    /// goes with its errors.
    Chain,
    /// Direction of an axis.
    Direction(AxisName),
    /// Origin of an axis.
    Origin(AxisName),
    /// Sense of a workpiece-side axis.
    Sense(AxisName),
    /// Travel of an axis; no deviation depends on it.
    Travel(AxisName),
    /// Letter and number of an axis in the controller; no deviation depends on them.
    Controller(AxisName),
    /// The position at which the control homes an axis.
    Home(AxisName),
    /// Gauge point, functional point and direction of the tool in use.
    Tool,
    /// Origin and rotation of the workpiece.
    Workpiece,
    /// Conventions of the errors.
    Conventions,
    /// Set-up errors.
    SetUp,
    /// The class that bounds what the file does not; no deviation depends on it.
    Class,
    /// Bounds along and across axes and of squareness; no deviation depends on them.
    Tolerances,
    /// An error.
    Error(ErrorId),
}

/// Sizes of an error that two machines do not share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSizes {
    /// The value of the largest size in the first and in the second, mm or rad: of a bounded error the bound; `None`
    /// where the error is not given.
    pub sizes: [Option<f64>; 2],
    /// True if the error is only bounded, in the first and in the second.
    pub bounded: [bool; 2],
    /// Largest absolute difference over the volume, mm or rad.
    pub largest: f64,
}

/// Positions at which curves are compared, evenly over the volume of the axis.
const SAMPLES: u32 = 400;

impl Machine {
    /// Returns the properties that differ from another machine: the chain first, then geometry, conventions and errors
    /// in the order of the other's walk. Geometry and errors are those of this machine on the other's chain: they went
    /// with the side.
    pub fn differences(&self, other: &Self) -> Vec<MachineProperty> {
        let Some(moved) = self.on_chain_of(other) else { return vec![MachineProperty::Chain] };
        let chain = (self.chain().to_string() != other.chain().to_string()).then_some(MachineProperty::Chain);
        let axes = moved.axes().iter().zip(other.axes()).flat_map(|(a, b)| axis_differences(a, b));
        let placed = |machine: &Self| (machine.workpiece(), machine.workpiece_angles());
        let held = |machine: &Self| (machine.tool().gauge, machine.tool().tip, machine.tool().direction);
        let rest = [
            (held(&moved) != held(other), MachineProperty::Tool),
            (placed(&moved) != placed(other), MachineProperty::Workpiece),
            (moved.conventions() != other.conventions(), MachineProperty::Conventions),
            (moved.setup() != other.setup(), MachineProperty::SetUp),
            (moved.class() != other.class(), MachineProperty::Class),
            (moved.tolerances() != other.tolerances(), MachineProperty::Tolerances),
        ];
        let rest = rest.into_iter().filter_map(|(differs, property)| differs.then_some(property));
        let errors = errors_of_both(&moved, other).into_iter().map(MachineProperty::Error);
        chain.into_iter().chain(axes).chain(rest).chain(errors).collect()
    }

    /// This machine with one property of another, on the other's chain. `None` if the chains cannot be told apart from
    /// the rest, for an axis of one name moves in the two in different ways.
    pub fn with_property_of(&self, other: &Self, property: &MachineProperty) -> Option<Self> {
        let moved = self.on_chain_of(other)?;
        let mut parts = moved.parts().clone();
        let theirs = |name: &AxisName| other.axes().iter().find(|axis| axis.name == *name);
        match property {
            MachineProperty::Chain => {}
            MachineProperty::Direction(name)
            | MachineProperty::Origin(name)
            | MachineProperty::Sense(name)
            | MachineProperty::Travel(name)
            | MachineProperty::Controller(name)
            | MachineProperty::Home(name) => {
                let axis = parts.axes.iter_mut().find(|axis| axis.name == *name)?;
                take(axis, theirs(name)?, property);
            }
            MachineProperty::Tool => parts.tools[moved.tool_index()] = other.tool().clone(),
            MachineProperty::Workpiece => {
                (parts.workpiece, parts.workpiece_rotation) = (other.workpiece(), other.workpiece_angles());
            }
            MachineProperty::Conventions => parts.conventions = *other.conventions(),
            MachineProperty::SetUp => parts.setup = *other.setup(),
            MachineProperty::Class => parts.class = other.class().cloned(),
            MachineProperty::Tolerances => parts.tolerances = other.tolerances().clone(),
            MachineProperty::Error(id) => {
                let joint = moved.joint_index(&id.axis)?;
                let term = other.joint_index(&id.axis).and_then(|j| other.joint_term(j, id)).cloned();
                parts.errors[joint].six_mut(id.family)[id.direction.index()] = term;
            }
        }
        Some(moved.with_parts(parts))
    }

    /// Returns the difference of an error of two machines, over the volume of the first.
    pub fn error_sizes(&self, other: &Self, id: &ErrorId) -> ErrorSizes {
        let machines = [self, other];
        let terms = machines.map(|machine| machine.joint_index(&id.axis).and_then(|j| machine.joint_term(j, id)));
        let positions = self.positions_of(&id.axis);
        let values = |term: Option<&ErrorTerm>| match term {
            Some(ErrorTerm::Tolerance(bound)) => vec![*bound; 2 * positions.len()],
            term => samples(term, &positions),
        };
        let [first, second] = terms.map(values);
        let extreme = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| if v.abs() > m.abs() { *v } else { m });
        let apart: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a - b).collect();
        ErrorSizes {
            sizes: [terms[0].map(|_| extreme(&first)), terms[1].map(|_| extreme(&second))],
            bounded: terms.map(|term| matches!(term, Some(ErrorTerm::Tolerance(_)))),
            largest: extreme(&apart).abs(),
        }
    }

    /// Returns the axes of this machine on the chain of another, with the geometry that goes with their sides. Axes
    /// that only the other has come without errors. `None` if an axis of one name turns in one and travels in the
    /// other.
    fn on_chain_of(&self, other: &Self) -> Option<Self> {
        let kind = |axis: &Axis| self.axis_index(axis.name.as_str()).map(|i| self.axes()[i].kind == axis.kind);
        if other.axes().iter().any(|axis| kind(axis) == Some(false)) {
            return None;
        }
        let common: Vec<(AxisName, Branch)> = other
            .axes()
            .iter()
            .filter(|axis| kind(axis).is_some())
            .map(|axis| (axis.name.clone(), axis.branch))
            .collect();
        let moved = self.rearranged(&common)?;
        let mut parts = moved.parts().clone();
        (parts.chain, parts.axes, parts.errors, parts.volume) = (other.chain().clone(), vec![], vec![], vec![]);
        for (axis, grid) in other.axes().iter().zip(other.volume()) {
            let (axis, grid, errors): (&Axis, &Grid, JointErrors) = match moved.axis_index(axis.name.as_str()) {
                Some(i) => (&moved.axes()[i], &moved.volume()[i], moved.axis_errors(i).clone()),
                None => (axis, grid, JointErrors::default()),
            };
            parts.axes.push(axis.clone());
            parts.volume.push(*grid);
            parts.errors.push(errors);
        }
        parts.errors.extend(other.chain().spindle().map(|_| moved.spindle_errors().cloned().unwrap_or_default()));
        Some(moved.with_parts(parts))
    }

    fn joint_index(&self, name: &AxisName) -> Option<usize> {
        let spindle = || (self.chain().spindle() == Some(name)).then_some(self.axes().len());
        self.axis_index(name.as_str()).or_else(spindle)
    }

    fn joint_term(&self, joint: usize, id: &ErrorId) -> Option<&ErrorTerm> {
        self.parts().errors.get(joint)?.six(id.family)[id.direction.index()].as_ref()
    }

    /// Positions over the volume of an axis; one of a spindle.
    fn positions_of(&self, axis: &AxisName) -> Vec<f64> {
        let Some(grid) = self.axis_index(axis.as_str()).map(|i| self.volume()[i]) else { return vec![0.0] };
        let at = |i: u32| grid.min + (grid.max - grid.min) * f64::from(i) / f64::from(SAMPLES);
        (0..=SAMPLES).map(at).collect()
    }
}

fn axis_differences(a: &Axis, b: &Axis) -> Vec<MachineProperty> {
    let name = || b.name.clone();
    let all = [
        (a.direction != b.direction, MachineProperty::Direction(name())),
        (a.origin != b.origin, MachineProperty::Origin(name())),
        (a.sign() != b.sign(), MachineProperty::Sense(name())),
        (a.travel != b.travel, MachineProperty::Travel(name())),
        (a.controller != b.controller, MachineProperty::Controller(name())),
        (a.home != b.home, MachineProperty::Home(name())),
    ];
    all.into_iter().filter_map(|(differs, property)| differs.then_some(property)).collect()
}

fn take(axis: &mut Axis, theirs: &Axis, property: &MachineProperty) {
    match property {
        MachineProperty::Direction(_) => axis.direction = theirs.direction,
        MachineProperty::Origin(_) => axis.origin = theirs.origin,
        MachineProperty::Sense(_) => axis.sense = theirs.sense,
        MachineProperty::Controller(_) => axis.controller = theirs.controller,
        MachineProperty::Home(_) => axis.home = theirs.home,
        _ => axis.travel = theirs.travel,
    }
}

/// Errors whose terms are not the same, joint by joint in the order of the second.
fn errors_of_both(a: &Machine, b: &Machine) -> Vec<ErrorId> {
    let names = b.axes().iter().map(|axis| &axis.name).chain(b.chain().spindle());
    let mut ids = Vec::new();
    for (joint, axis) in names.enumerate() {
        for family in ErrorFamily::ALL {
            for direction in Direction::ALL {
                let id = ErrorId { axis: axis.clone(), family, direction };
                if a.joint_term(joint, &id) != b.joint_term(joint, &id) {
                    ids.push(id);
                }
            }
        }
    }
    ids
}

/// Values at positions, approached from both sides; zero without a term, and where its curves are not defined.
fn samples(term: Option<&ErrorTerm>, positions: &[f64]) -> Vec<f64> {
    let defined = |position: f64| match term {
        Some(ErrorTerm::Component(component)) => {
            let inside = |d: (f64, f64)| (d.0..=d.1).contains(&position);
            component.curves().filter_map(super::Curve::domain).all(inside)
        }
        _ => true,
    };
    let value = |approach: Approach| {
        move |position: &f64| match term {
            Some(term) if defined(*position) => term.value(&approach.at_position(*position)),
            _ => 0.0,
        }
    };
    let forward = positions.iter().map(value(Approach::Forward));
    forward.chain(positions.iter().map(value(Approach::Reverse))).collect()
}
