//! The errors of one joint: six location and six component errors, any of them absent.

use super::{Approach, AxisName, Curve, CurveArgument, Direction, ErrorFamily, ErrorId};

/// A component error: a curve, or one for each direction of approach.
#[derive(Debug, Clone, PartialEq)]
pub enum ComponentError {
    /// The same in both directions.
    Single(Curve),
    /// Measured in both directions.
    Bidirectional {
        /// Approached with rising position.
        forward: Curve,
        /// Approached with falling position.
        reverse: Curve,
    },
}

impl ComponentError {
    /// Value (mm or rad) where its axis stands.
    pub fn value(&self, at: &CurveArgument<'_>) -> f64 {
        match (self, at.at.conditions.approach) {
            (Self::Single(curve), _) => curve.value(at),
            (Self::Bidirectional { forward, .. }, Approach::Forward) => forward.value(at),
            (Self::Bidirectional { reverse, .. }, Approach::Reverse) => reverse.value(at),
            (Self::Bidirectional { forward, reverse }, Approach::Mean) => 0.5 * (forward.value(at) + reverse.value(at)),
        }
    }

    /// Returns its one or two curves.
    pub fn curves(&self) -> impl Iterator<Item = &Curve> {
        let (first, second) = match self {
            Self::Single(curve) => (curve, None),
            Self::Bidirectional { forward, reverse } => (forward, Some(reverse)),
        };
        std::iter::once(first).chain(second)
    }
}

/// The value of one error as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorTerm {
    /// A location error's value (mm or rad).
    Constant(f64),
    /// A component error.
    Component(ComponentError),
    /// Not known, only bounded (mm or rad): for budgets; zero in every evaluation.
    Tolerance(f64),
}

impl ErrorTerm {
    /// Value (mm or rad); a tolerance counts as zero.
    pub fn value(&self, at: &CurveArgument<'_>) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Component(component) => component.value(at),
            Self::Tolerance(_) => 0.0,
        }
    }
}

/// The errors of one axis or spindle, indexed by [`Direction::index`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointErrors {
    /// Location errors, constants.
    pub location: [Option<ErrorTerm>; 6],
    /// Component errors, functions of the position.
    pub component: [Option<ErrorTerm>; 6],
}

impl JointErrors {
    /// Returns the six errors of a family.
    pub fn six(&self, family: ErrorFamily) -> &[Option<ErrorTerm>; 6] {
        match family {
            ErrorFamily::Location => &self.location,
            ErrorFamily::Component => &self.component,
        }
    }

    /// Returns the six errors of a family, to be changed.
    pub fn six_mut(&mut self, family: ErrorFamily) -> &mut [Option<ErrorTerm>; 6] {
        match family {
            ErrorFamily::Location => &mut self.location,
            ErrorFamily::Component => &mut self.component,
        }
    }

    /// Returns the six location errors (mm, rad).
    pub fn location_values(&self) -> [f64; 6] {
        std::array::from_fn(|i| self.location[i].as_ref().map_or(0.0, |t| t.value(&0.0.into())))
    }

    /// Returns the six component errors where the axis stands (mm, rad).
    pub fn component_values(&self, at: &CurveArgument<'_>) -> [f64; 6] {
        std::array::from_fn(|i| self.component[i].as_ref().map_or(0.0, |t| t.value(at)))
    }

    /// Replaces the location errors by these (mm, rad), those of 0 by none.
    pub(in crate::machine) fn set_location(&mut self, location: [f64; 6]) {
        self.location = location.map(|value| (value != 0.0).then_some(ErrorTerm::Constant(value)));
    }

    /// Keeps the errors of the joint of this name that `keep` accepts.
    pub(in crate::machine) fn retain(&mut self, joint: &AxisName, keep: &impl Fn(&ErrorId) -> bool) {
        for family in ErrorFamily::ALL {
            for direction in Direction::ALL {
                let id = ErrorId { axis: joint.clone(), family, direction };
                let slot = &mut self.six_mut(family)[direction.index()];
                *slot = slot.take().filter(|_| keep(&id));
            }
        }
    }

    /// Returns the curves of the component errors with their directions, one or two of each.
    pub fn curves(&self) -> impl Iterator<Item = (Direction, &Curve)> {
        self.iter()
            .filter_map(move |(_, direction, term)| {
                let ErrorTerm::Component(component) = term else { return None };
                Some(component.curves().map(move |curve| (direction, curve)))
            })
            .flatten()
    }

    /// True if an angular component error is given.
    pub fn tilts(&self) -> bool {
        self.component[3..].iter().any(Option::is_some)
    }

    /// Returns the terms that are given, with family and direction.
    pub fn iter(&self) -> impl Iterator<Item = (ErrorFamily, Direction, &ErrorTerm)> {
        ErrorFamily::ALL.into_iter().flat_map(move |family| {
            let six = self.six(family);
            Direction::ALL.into_iter().filter_map(move |d| six[d.index()].as_ref().map(|t| (family, d, t)))
        })
    }
}
