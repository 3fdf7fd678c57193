//! Uncertainty of the values of errors as independent parts, each of which moves errors by known amounts together.

use super::{
    Axis, AxisName, ComponentError, Curve, Direction, ErrorFamily, ErrorId, ErrorTerm, JointErrors, JointUncertainty,
    Machine, ResidualForm, SetUp, UnheldMotion,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The origin of an independent part. Two machines whose files state the same part share its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub enum UncertainPart {
    /// A part of the joint uncertainty.
    Joint(JointUncertainty),
    /// An error that states its own, with its values and its standard uncertainty (mm, rad).
    Alone(ErrorId, ErrorTerm, f64),
    /// A mode of the form of an axis: one standard deviation of an error, beside these errors of the axis.
    Form(ErrorId, Curve, Arc<JointErrors>),
}

impl Machine {
    /// Returns the independent parts of the uncertainty of its errors. The uncertainty that an error states for itself
    /// is common to its whole curve; it counts where no joint part moves the error.
    pub fn uncertain_parts(&self) -> Vec<UncertainPart> {
        let parts = self.parts();
        let joint = parts.covariance.iter().cloned().map(UncertainPart::Joint);
        let alone = self.errors().filter_map(|(error, term)| {
            let half = self.uncertainty(&error).filter(|half| *half > 0.0)?;
            let known = matches!(term, ErrorTerm::Tolerance(_)) || parts.covariance.iter().any(|p| p.moves(&error));
            (!known).then(|| UncertainPart::Alone(error, term.clone(), half / 2.0))
        });
        joint.chain(alone).chain(parts.forms.iter().flat_map(|form| self.form_parts(form))).collect()
    }

    fn form_parts(&self, form: &ResidualForm) -> Vec<UncertainPart> {
        let Some(i) = self.axes().iter().position(|axis| axis.name == form.axis) else { return Vec::new() };
        let (axis, errors) = (&self.axes()[i], Arc::new(self.axis_errors(i).clone()));
        let error =
            |direction: Direction| ErrorId { axis: form.axis.clone(), family: ErrorFamily::Component, direction };
        let parts = |direction: &Direction| {
            let part = |mode| UncertainPart::Form(error(*direction), mode, Arc::clone(&errors));
            form.modes(axis, *direction).into_iter().map(part).collect::<Vec<_>>()
        };
        Direction::ALL.iter().flat_map(parts).collect()
    }

    /// Returns rigid motions of the workpiece frame that the data behind the errors do not hold.
    pub fn unheld(&self) -> &[UnheldMotion] {
        &self.parts().unheld
    }

    /// Returns the range (mm, deg) in which the curves of an axis were measured, if it is less than the travel.
    pub fn measured_range(&self, axis: &AxisName) -> Option<(f64, f64)> {
        self.parts().measured.get(axis).copied()
    }

    /// Returns the range (mm, deg) in which the curves of an axis are judged: where they were measured, if the volume
    /// lies there, or else the travel.
    pub fn judged_range(&self, axis: &Axis) -> (f64, f64) {
        let volume = self.axis_index(axis.name.as_str()).map(|i| self.volume()[i]);
        let holds = |(min, max): &(f64, f64)| volume.is_some_and(|volume| *min <= volume.min && volume.max <= *max);
        self.measured_range(&axis.name).filter(holds).unwrap_or_else(|| axis.travel.interval())
    }

    /// Returns the axes that a pose (mm, deg) takes beyond the range in which their curves were measured.
    pub fn beyond_measured<'a>(&'a self, pose: &'a [f64]) -> impl Iterator<Item = &'a Axis> {
        let is_beyond = |axis: &Axis, q: f64| {
            self.measured_range(&axis.name).is_some_and(|(min, max)| {
                let rounding = 1e-9 * (max - min);
                q < min - rounding || q > max + rounding
            })
        };
        self.axes().iter().zip(pose).filter(move |(axis, q)| is_beyond(axis, **q)).map(|(axis, _)| axis)
    }

    /// Returns the same machine with curves that were measured in these ranges (mm, deg) of its axes, in their order,
    /// and a volume that ends there; an axis without a range, or whose volume is elsewhere, keeps its own.
    pub fn with_volume_within(&self, ranges: &[Option<(f64, f64)>]) -> Self {
        let mut parts = self.parts().clone();
        for ((grid, axis), range) in parts.volume.iter_mut().zip(&parts.axes).zip(ranges) {
            let Some((low, high)) = range else { continue };
            let (min, max) = (grid.min.max(*low), grid.max.min(*high));
            if min < max {
                (grid.min, grid.max) = (min, max);
            }
            let _ = parts.measured.insert(axis.name.clone(), (*low, *high));
        }
        self.with_parts(parts)
    }

    /// Returns the machine without what is known of the uncertainty of its errors.
    pub fn without_uncertainty(&self) -> Self {
        let mut parts = self.parts().clone();
        parts.covariance.clear();
        parts.forms.clear();
        self.with_parts(parts)
    }

    /// Returns the machine whose only errors are one standard uncertainty of a part: its deviation to first order is
    /// what the part does to that of this machine.
    pub fn moved_by(&self, part: &UncertainPart) -> Self {
        let mut parts = self.parts().clone();
        let names: Vec<AxisName> =
            parts.axes.iter().map(|axis| axis.name.clone()).chain(parts.chain.spindle().cloned()).collect();
        let one = |error: &ErrorId, term: ErrorTerm| {
            let mut errors = JointErrors::default();
            errors.six_mut(error.family)[error.direction.index()] = Some(term);
            (BTreeMap::from([(error.axis.clone(), errors)]), SetUp::default())
        };
        let curve = |curve: Curve| ErrorTerm::Component(ComponentError::Single(curve));
        let (amounts, setup) = match part {
            UncertainPart::Joint(joint) => (joint.errors.clone(), joint.setup),
            UncertainPart::Form(error, mode, _) => one(error, curve(mode.clone())),
            UncertainPart::Alone(error, _, sigma) => match error.family {
                ErrorFamily::Location => one(error, ErrorTerm::Constant(*sigma)),
                ErrorFamily::Component => one(error, curve(Curve::Polynomial(vec![*sigma]))),
            },
        };
        parts.errors = names.iter().map(|name| amounts.get(name).cloned().unwrap_or_default()).collect();
        parts.setup = setup;
        self.with_parts(parts)
    }
}
