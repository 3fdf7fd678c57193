//! Error curves as parameters: a basis of functions of the axis position, one parameter each.

use super::parameter::{BasisFunction, Parameter, source};
use super::refusal::{Refusal, refusal};
use crate::diagnostic::shown;
use crate::machine::{
    Approach, AxisKind, BSpline, BSplineFailure, ComponentError, Curve, ErrorId, ErrorTerm, Knots, Machine, Travel,
};
use crate::syntax::Scalar;
use crate::units;
use nalgebra::{DMatrix, DVector};

pub(super) const MAX_POWER: u8 = 20;

/// An error and the direction of approach its curve is for.
struct CurveRequest<'a> {
    machine: &'a Machine,
    error: &'a ErrorId,
    axis: usize,
    approach: Approach,
}

/// Returns the parameters of a component error in a form such as `poly3`; none: the usual one of the axis.
pub(crate) fn parameters(
    machine: &Machine,
    error: &ErrorId,
    form: Option<&str>,
    knots: Option<&[Scalar]>,
    approach: Approach,
) -> Result<Vec<Parameter>, Refusal> {
    let axis = machine.axis_index(error.axis.as_str()).unwrap_or_default();
    let of = CurveRequest { machine, error, axis, approach };
    let usual = if machine.axes()[axis].kind == AxisKind::Linear { "poly3" } else { "fourier2" };
    let form = form.unwrap_or(usual);
    let (form, degree) = match form.split_once('/') {
        Some((bare, degree)) if bare.starts_with("bspline") => (bare, degree.parse::<u8>().unwrap_or(0)),
        _ => (form, 3),
    };
    let cut = form.find(|c: char| c.is_ascii_digit()).unwrap_or(form.len());
    if knots.is_some() && cut < form.len() && ["spline", "bspline", "blocks"].contains(&&form[..cut]) {
        let message = format!("`{error}:{}` has even knots, and `knots` are given", shown(form));
        return Err(refusal(message, format!("write `{error}:{}` for the knots given", &form[..cut])));
    }
    let (family, order) = (&form[..cut], form[cut..].parse::<u8>().ok().filter(|n| (1..=50).contains(n)));
    match (family, order) {
        ("poly", Some(order)) if order <= MAX_POWER => of.polynomial(order),
        ("fourier", Some(order)) => of.fourier(order),
        ("spline", Some(count)) => of.at_knots(&of.even(usize::from(count.max(2)))?, true),
        ("bspline", Some(count)) => of.bspline(&of.even(usize::from(count.max(2)))?, degree),
        ("blocks", Some(count)) => of.at_knots(&of.even(usize::from(count) + usize::from(!of.is_continuous()))?, false),
        ("spline" | "blocks" | "bspline", None) if cut == form.len() => match knots {
            Some(knots) if family == "bspline" => of.bspline(&of.given_knots(knots)?, degree),
            Some(knots) => of.at_knots(&of.given_knots(knots)?, family == "spline"),
            None => {
                let help = format!("write `{family}8`, or `knots: {{ {error}: [...] }}` in the section `identify`");
                Err(refusal(format!("`{error}:{family}` has no knots"), help))
            }
        },
        _ => {
            let message = format!("`{}` is not a basis", shown(form));
            let help = "write poly3 (powers 0 to 3; at most 20), fourier2 (orders 0 to 2), spline8 or bspline8 (8 \
             knots; at most 50), \
                        or blocks4 (4 blocks); a knot is fitted with its curve, whose others may be `--fixed`";
            Err(refusal(message, help))
        }
    }
}

/// Returns a bare, finite number.
pub(crate) fn plain(scalar: &Scalar) -> Option<f64> {
    match scalar {
        Scalar::Number(value) => value.is_finite().then_some(*value),
        Scalar::Text(text) => units::number(text).ok(),
    }
}

impl CurveRequest<'_> {
    fn is_continuous(&self) -> bool {
        self.machine.axes()[self.axis].travel == Travel::Continuous
    }

    /// Returns the curve that the file gives, if it gives one for this direction.
    fn file_curve(&self) -> Option<&Curve> {
        self.machine.errors().find(|(known, _)| known == self.error).and_then(|(_, term)| match (term, self.approach) {
            (ErrorTerm::Component(ComponentError::Single(curve)), _) => Some(curve),
            (ErrorTerm::Component(ComponentError::Bidirectional { forward, .. }), Approach::Forward) => Some(forward),
            (ErrorTerm::Component(ComponentError::Bidirectional { reverse, .. }), Approach::Reverse) => Some(reverse),
            _ => None,
        })
    }

    fn parameter(&self, label: &str, basis: BasisFunction, start: f64) -> Parameter {
        let sign = match self.approach {
            Approach::Mean => "",
            Approach::Forward => "+",
            Approach::Reverse => "-",
        };
        let name = format!("{}{sign}:{label}", self.error);
        let mut parameter = Parameter::single(self.machine, name, source(self.machine, self.error), basis, start);
        parameter.terms.iter_mut().for_each(|term| term.approach = self.approach);
        parameter
    }

    fn polynomial(&self, order: u8) -> Result<Vec<Parameter>, Refusal> {
        if self.machine.is_continuous(self.axis) {
            let help = format!("use `{}:fourier{order}`", self.error);
            let message = format!("`{}`: a polynomial on an axis without ends is not periodic", self.error);
            return Err(refusal(message, help));
        }
        let known = match self.file_curve() {
            Some(Curve::Polynomial(known)) => known.clone(),
            _ => Vec::new(),
        };
        let start = |k: u8| known.get(usize::from(k)).copied().unwrap_or(0.0);
        Ok((0..=order).map(|k| self.parameter(&format!("x^{k}"), BasisFunction::Power(k), start(k))).collect())
    }

    fn fourier(&self, order: u8) -> Result<Vec<Parameter>, Refusal> {
        if self.machine.axes()[self.axis].kind == AxisKind::Linear {
            let message = format!("`{}`: harmonics are of one turn, axis `{}` is linear", self.error, self.error.axis);
            return Err(refusal(message, "use poly, spline or blocks"));
        }
        let known = match self.file_curve() {
            Some(Curve::Harmonics(known)) => known.clone(),
            _ => Vec::new(),
        };
        let at = |k: u8| known.get(usize::from(k)).copied().unwrap_or_default();
        let one = |k: u8| {
            let cosine = self.parameter(&format!("cos{k}"), BasisFunction::Cosine(k), at(k).0);
            let sine = self.parameter(&format!("sin{k}"), BasisFunction::Sine(k), at(k).1);
            if k == 0 { vec![cosine] } else { vec![cosine, sine] }
        };
        Ok((0..=order).flat_map(one).collect())
    }

    /// Returns even knots over the travel, both ends among them; over a turn, `count` knots and the end of the turn.
    fn even(&self, count: usize) -> Result<Vec<f64>, Refusal> {
        let (min, max) = self.machine.axes()[self.axis].travel.interval();
        let intervals = if self.is_continuous() { count } else { count - 1 };
        let position = |i: usize| if i == intervals { max } else { min + (max - min) * i as f64 / intervals as f64 };
        Ok((0..=intervals).map(position).collect())
    }

    /// Returns the knots of the file, with the ends of the travel.
    fn given_knots(&self, list: &[Scalar]) -> Result<Vec<f64>, Refusal> {
        let axis = &self.machine.axes()[self.axis];
        let (min, max) = axis.travel.interval();
        let help = format!("positions of `{}` in {} that rise, inside {min} to {max}", self.error.axis, axis.unit());
        let position = |scalar: &Scalar| {
            let quantity = || units::quantity(&scalar.to_string()).ok();
            plain(scalar).or_else(|| match axis.kind {
                AxisKind::Linear => quantity()?.as_length(),
                AxisKind::Rotary => quantity()?.as_angle().map(f64::to_degrees),
            })
        };
        let mut knots = Vec::new();
        for scalar in list {
            match position(scalar).filter(|q| (min..=max).contains(q)) {
                Some(q) if knots.last().is_none_or(|last| *last < q) => knots.push(q),
                _ => return Err(refusal(format!("`{}`: the knot `{scalar}` is refused", self.error), help)),
            }
        }
        if knots.first().is_none_or(|first| *first > min) {
            knots.insert(0, min);
        }
        if knots.last().is_none_or(|last| *last < max) {
            knots.push(max);
        }
        Ok(knots)
    }

    /// Returns a parameter for the value at each knot: a natural (or periodic) cubic spline, or straight lines, through
    /// them. On an axis without ends the last knot is the first again.
    fn at_knots(&self, knots: &[f64], smooth: bool) -> Result<Vec<Parameter>, Refusal> {
        let turn = self.is_continuous();
        let count = knots.len() - usize::from(turn);
        let one = |k: usize| {
            let value = |i: usize| f64::from(u8::from(i == k || (turn && k == 0 && i == count)));
            let points: Vec<(f64, f64)> = knots.iter().enumerate().map(|(i, q)| (*q, value(i))).collect();
            let failed =
                |_| refusal(format!("`{}`: the travel has no room for {count} knots", self.error), "take fewer knots");
            let knots_of = Knots::new(&points, turn.then_some(360.0)).map_err(failed)?;
            let curve = if smooth { Curve::cubic(knots_of) } else { Curve::Linear(knots_of) };
            let label = format!("{}{}", units::significant(knots[k], 6), self.machine.axes()[self.axis].unit());
            let start = self.file_curve().map_or(0.0, |known| known.value(knots[k]));
            Ok(self.parameter(&label, BasisFunction::Spline(curve), start))
        };
        (0..count).map(one).collect()
    }

    /// Returns a parameter for each coefficient of a B-spline, named after the centre of its function.
    fn bspline(&self, knots: &[f64], degree: u8) -> Result<Vec<Parameter>, Refusal> {
        let (period, degree) = (self.is_continuous().then_some(360.0), usize::from(degree));
        let zeros = vec![0.0; BSpline::count(degree, knots.len(), period.is_some())];
        let failed = |failure| match failure {
            BSplineFailure::Degree => (format!("`{}`: a B-spline of this degree", self.error), "degrees are 1 to 3"),
            _ => (format!("`{}`: the travel has no room for {} knots", self.error, knots.len()), "take fewer knots"),
        };
        let blank = BSpline::new(degree, knots, &zeros, period).map_err(|failure| {
            let (message, help) = failed(failure);
            refusal(message, help)
        })?;
        let sites = blank.sites();
        let count = sites.len();
        let function = |k: usize| blank.with_coefficients((0..count).map(|i| f64::from(u8::from(i == k))));
        let functions: Vec<BSpline> = (0..count).map(function).collect();
        let start = self.file_curve().and_then(|known| {
            let values = DVector::from_fn(count, |i, _| known.value(sites[i]));
            DMatrix::from_fn(count, count, |i, k| functions[k].value(sites[i])).lu().solve(&values)
        });
        let unit = self.machine.axes()[self.axis].unit();
        let one = |(k, function): (usize, BSpline)| {
            let label = format!("b@{}{unit}", units::significant(sites[k], 6));
            let start = start.as_ref().map_or(0.0, |start| start[k]);
            self.parameter(&label, BasisFunction::Spline(Curve::BSpline(Box::new(function))), start)
        };
        Ok(functions.into_iter().enumerate().map(one).collect())
    }
}
