//! Uncertainty of the values of errors as independent parts, each of which moves errors by known amounts together.

use super::{
    Axis, AxisName, ComponentError, Curve, Direction, ErrorFamily, ErrorId, ErrorTerm, Grid, JointErrors,
    JointUncertainty, Knots, Machine, ResidualForm, SetUp, Travel, UnheldMotion,
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
        let forms = parts.forms.iter().flat_map(|form| self.form_parts(form));
        let mut all: Vec<UncertainPart> = joint.chain(alone).chain(forms).collect();
        // Where nothing is said of uncertainty there are no intervals to widen.
        if !all.is_empty() {
            all.extend((0..self.axes().len()).flat_map(|i| self.parts_beyond(i)));
        }
        all
    }

    /// Returns the errors with a value of which the file states no uncertainty.
    pub fn errors_taken_as_exact(&self) -> Vec<ErrorId> {
        let has_value = |term: &ErrorTerm| match term {
            ErrorTerm::Constant(value) => *value != 0.0,
            ErrorTerm::Component(_) => true,
            ErrorTerm::Tolerance(_) => false,
        };
        let is_stated = |error: &ErrorId| {
            self.uncertainty(error).is_some_and(|half| half > 0.0)
                || self.parts().covariance.iter().any(|part| part.moves(error))
        };
        let all = self.errors().filter(|(error, term)| has_value(term) && !is_stated(error));
        all.map(|(error, _)| error).collect()
    }

    /// Returns the uncertainty of the curves of an axis beyond their points, one part for each end of an error: the
    /// curve may rise or fall as steeply as it does anywhere between them, any slope up to there being as likely.
    fn parts_beyond(&self, i: usize) -> Vec<UncertainPart> {
        let (axis, errors) = (&self.axes()[i], Arc::new(self.axis_errors(i).clone()));
        let Travel::Range(min, max) = axis.travel else { return Vec::new() };
        let stated = self.parts().measured.get(&axis.name).copied();
        let part = |(direction, curve): (Direction, &Curve)| {
            let knots = curve.knots().filter(|_| !matches!(curve, Curve::BSpline(_)));
            let (q, v) = knots.map_or((&[][..], &[][..]), |knots| (knots.positions(), knots.values()));
            // A last slope that goes on has its last point at the end of the travel, and the one before at that of the
            // measured range.
            let range = stated.filter(|range| q.len() > 2 && (q[1] == range.0 || q[q.len() - 2] == range.1));
            let low = range.map(|range| range.0).filter(|low| q[1] == *low).or(q.first().copied());
            let high = range.map(|range| range.1).filter(|high| q[q.len() - 2] == *high).or(q.last().copied());
            let chords = q.windows(2).zip(v.windows(2));
            let steepest = chords.map(|(q, v)| ((v[1] - v[0]) / (q[1] - q[0])).abs()).fold(0.0, f64::max);
            let end = |from: f64, to: f64| {
                let size = steepest * (to - from).abs() / libm::sqrt(3.0);
                let mut points = [(from, 0.0), (to, size)];
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                let id = ErrorId { axis: axis.name.clone(), family: ErrorFamily::Component, direction };
                let curve = Knots::new(&points, None).ok().map(Curve::Linear);
                curve.filter(|_| size > 0.0).map(|curve| UncertainPart::Form(id, curve, Arc::clone(&errors)))
            };
            let low = low.filter(|low| *low > min).and_then(|low| end(low, min));
            low.into_iter().chain(high.filter(|high| *high < max).and_then(|high| end(high, max))).collect::<Vec<_>>()
        };
        errors.curves().flat_map(part).collect()
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

    /// Returns the range (mm, deg) in which the curves of an axis were measured, if it is less than the travel: what
    /// the file states of fits, and where all curves through points have points.
    pub fn measured_range(&self, axis: &AxisName) -> Option<(f64, f64)> {
        let stated = self.parts().measured.get(axis).copied();
        let short = self.axis_index(axis.as_str()).into_iter().flat_map(|i| {
            let (min, max) = self.axes()[i].travel.interval();
            let short = move |domain: &(f64, f64)| domain.0 > min || domain.1 < max;
            self.axis_errors(i).curves().filter_map(|(_, curve)| curve.domain()).filter(short)
        });
        let both = |a: (f64, f64), b: (f64, f64)| (a.0.max(b.0), a.1.min(b.1));
        stated.into_iter().chain(short).reduce(both).filter(|(low, high)| low < high)
    }

    /// Returns the intervals (mm, deg) of the volume, axis by axis, without what lies beyond the measured ranges.
    pub fn measured_volume(&self) -> Vec<(f64, f64)> {
        let within = |(axis, grid): (&Axis, &Grid)| {
            let (low, high) = self.measured_range(&axis.name).unwrap_or((grid.min, grid.max));
            let (min, max) = (grid.min.max(low), grid.max.min(high));
            if min < max { (min, max) } else { (grid.min, grid.max) }
        };
        self.axes().iter().zip(self.volume()).map(within).collect()
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
