//! Conversion of a function of the position to a curve of the language.
//!
//! The forms are tried from the simplest on: the old curve (or its negative), a polynomial, harmonics, a table at the
//! positions of the old tables. The first that equals the function at all test positions is taken; if there is none,
//! the nearest, with its residual reported.

use super::{ComponentErrors, ROUNDING, TINY};
use crate::machine::{
    Approach, Axis, AxisKind, ComponentError, Curve, Direction, ErrorTerm, Knots, Travel, sin_cos_degrees,
};
use crate::units::Interval;

/// Highest degree of a polynomial that is tried: units count to the ninth power.
const DEGREE: usize = 8;
/// A product of errors has the orders of both; of more than three it is nothing.
const MORE_ORDERS: usize = 6;
/// Highest order of the language.
const ORDERS: usize = 720;
/// Lines of a table, and how often a gap may be halved, when a tolerance allows for it.
const LINES: usize = 4000;
const HALVINGS: u32 = 7;
/// Fractions of an interval at which a curve is compared.
const BETWEEN: [f64; 4] = [0.13, 0.37, 0.5, 0.81];
/// Fraction of the allowed difference that one curve may use.
const TOLERANCE_FRACTION: f64 = 0.05;

/// The term of one error, and how far it is off (mm or rad).
pub fn shape(
    errors: &ComponentErrors<'_>,
    old: &[Option<ErrorTerm>; 6],
    direction: Direction,
    axis: &Axis,
    within: f64,
) -> (Option<ErrorTerm>, f64) {
    let known = &old[direction.index()];
    if errors.keeps_numbers() && !errors.is_mirrored() {
        return (known.clone(), 0.0);
    }
    if let Some(ErrorTerm::Tolerance(_)) = known {
        return (known.clone(), 0.0);
    }
    let scale = if direction.is_rotation() { 1e-3 } else { 1.0 };
    let target = ConvertedForm {
        errors,
        old,
        direction,
        axis,
        nothing: TINY[usize::from(direction.is_rotation())],
        enough: TOLERANCE_FRACTION * within * scale,
        finer: within > ROUNDING,
    };
    let apart = old.iter().flatten().any(|t| matches!(t, ErrorTerm::Component(ComponentError::Bidirectional { .. })));
    if !apart {
        let (curve, size) = target.curve(Approach::Mean);
        return (term_unless_zero(ComponentError::Single(curve), known.is_some()), size);
    }
    let ((forward, a), (reverse, b)) = (target.curve(Approach::Forward), target.curve(Approach::Reverse));
    let both = if forward == reverse {
        ComponentError::Single(forward)
    } else {
        ComponentError::Bidirectional { forward, reverse }
    };
    (term_unless_zero(both, known.is_some()), a.max(b))
}

/// An error that is nothing, and was not given, stays away.
fn term_unless_zero(component: ComponentError, known: bool) -> Option<ErrorTerm> {
    let nothing = |curve: &Curve| match curve {
        Curve::Polynomial(c) => c.iter().all(|c| *c == 0.0),
        Curve::Harmonics(c) => c.iter().all(|(c, s)| *c == 0.0 && *s == 0.0),
        Curve::Linear(_) | Curve::Cubic(..) | Curve::BSpline(_) => false,
    };
    (known || !component.curves().all(nothing)).then_some(ErrorTerm::Component(component))
}

/// The function that a curve is wanted for.
struct ConvertedForm<'a> {
    errors: &'a ComponentErrors<'a>,
    old: &'a [Option<ErrorTerm>; 6],
    direction: Direction,
    axis: &'a Axis,
    nothing: f64,
    enough: f64,
    /// True if tables may get more points.
    finer: bool,
}

impl ConvertedForm<'_> {
    fn value(&self, position: f64, approach: Approach) -> f64 {
        self.errors.six(position, approach.into())[self.direction.index()]
    }

    fn curve(&self, approach: Approach) -> (Curve, f64) {
        let knots = self.knots();
        let looked: Vec<(f64, f64)> = looks(&knots).into_iter().map(|q| (q, self.value(q, approach))).collect();
        let off = |curve: &Curve| looked.iter().map(|(q, v)| (curve.value(*q) - v).abs()).fold(0.0, f64::max);
        let mut best: Option<(Curve, f64)> = None;
        for curve in self.simple(approach) {
            let size = off(&curve);
            if size <= self.nothing {
                return (curve, 0.0);
            }
            if best.as_ref().is_none_or(|(_, min)| size < *min) {
                best = Some((curve, size));
            }
        }
        let tables = self.tables(&knots, approach);
        tables
            .into_iter()
            .chain(best)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((Curve::Polynomial(vec![0.0]), f64::INFINITY))
    }

    /// Curves without a table of their own.
    fn simple(&self, approach: Approach) -> impl Iterator<Item = Curve> {
        let (low, high) = self.axis.travel.interval();
        let (turning, ends) = (self.axis.kind == AxisKind::Rotary, self.axis.travel != Travel::Continuous);
        let power = move |degree: usize| polynomial(|q| self.value(q, approach), Interval::new(low, high), degree);
        let series = move |order: usize| harmonics(|q| self.value(q, approach), order, self.nothing * 1e-2);
        let highest = (self.highest_order() + MORE_ORDERS).min(ORDERS);
        // Over a short travel a polynomial passes for a harmonic: the straight ones come first, then harmonics.
        let straight = if turning { 1 } else { DEGREE };
        self.familiar(approach)
            .into_iter()
            .chain((0..=straight).filter(move |_| ends).map(power))
            .chain((0..=highest).filter(move |_| turning).map(series))
            .chain((straight + 1..=DEGREE).filter(move |_| ends).map(power))
    }

    /// The old curve of this error and its negative, mirrored where the axis is.
    fn familiar(&self, approach: Approach) -> Vec<Curve> {
        let Some(ErrorTerm::Component(component)) = &self.old[self.direction.index()] else { return Vec::new() };
        let curve = match component {
            ComponentError::Single(curve) => curve,
            ComponentError::Bidirectional { forward, reverse } => {
                if (approach == Approach::Forward) != self.errors.is_mirrored() { forward } else { reverse }
            }
        };
        let sense = if self.errors.is_mirrored() { -1.0 } else { 1.0 };
        [1.0, -1.0].into_iter().filter_map(|sign| with_sign(curve, sign, sense)).collect()
    }

    fn highest_order(&self) -> usize {
        let order = |curve: &Curve| if let Curve::Harmonics(list) = curve { list.len() } else { 0 };
        self.curves().map(order).max().unwrap_or(0)
    }

    fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.old.iter().flatten().flat_map(|term| {
            let component = if let ErrorTerm::Component(component) = term { Some(component) } else { None };
            component.into_iter().flat_map(ComponentError::curves)
        })
    }

    /// Positions of all tables of the axis, within all of them; without a table, a few over the travel.
    fn knots(&self) -> Vec<f64> {
        let sense = if self.errors.is_mirrored() { -1.0 } else { 1.0 };
        let positions = |knots: &Knots| knots.positions().iter().map(|q| q * sense).collect::<Vec<f64>>();
        let tables: Vec<Vec<f64>> = self.curves().filter_map(Curve::knots).map(positions).collect();
        let (low, high) = self.axis.travel.interval();
        if tables.is_empty() {
            return sort(even(low, high).collect());
        }
        let all = tables.iter().flatten().copied();
        if self.axis.travel == Travel::Continuous {
            return sort(all.map(|q| q.rem_euclid(360.0)).chain([low, high]).collect());
        }
        // Beyond its end a table holds its value: the innermost ends count.
        let min = |table: &Vec<f64>| table.iter().copied().fold(f64::INFINITY, f64::min);
        let max = |table: &Vec<f64>| table.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let first = tables.iter().map(min).fold(f64::NEG_INFINITY, f64::max);
        let last = tables.iter().map(max).fold(f64::INFINITY, f64::min);
        sort(all.filter(|q| (first..=last).contains(q)).chain([first, last]).collect())
    }

    /// Tables through the function, with finer steps as long as that is allowed and helps.
    fn tables(&self, knots: &[f64], approach: Approach) -> Vec<(Curve, f64)> {
        let mut all: Vec<(Curve, f64)> = Vec::new();
        let period = (self.axis.travel == Travel::Continuous).then_some(360.0);
        for halvings in 0..=if self.finer { HALVINGS } else { 0 } {
            let fine = halve(knots, halvings);
            if fine.len() > LINES || fine.len() < 2 {
                break;
            }
            let mut points: Vec<(f64, f64)> = fine.iter().map(|q| (*q, self.value(*q, approach))).collect();
            if period.is_some() {
                let first = points[0].1;
                points.iter_mut().rev().take(1).for_each(|p| p.1 = first);
            }
            let Ok(table) = Knots::new(&points, period) else { break };
            let looked: Vec<(f64, f64)> = looks(&fine).into_iter().map(|q| (q, self.value(q, approach))).collect();
            for curve in [Curve::Linear(table.clone()), Curve::cubic(table)] {
                let size = looked.iter().map(|(q, v)| (curve.value(*q) - v).abs()).fold(0.0, f64::max);
                if size <= self.nothing {
                    return vec![(curve, 0.0)];
                }
                let done = size <= self.enough;
                all.push((curve, size));
                if done {
                    return all.split_off(all.len() - 1);
                }
            }
        }
        all
    }
}

/// Sixteen even steps.
fn even(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..=16).map(move |i| if i == 16 { high } else { low + (high - low) * f64::from(i) / 16.0 })
}

/// Rising; positions nearer than rounding are one.
fn sort(mut list: Vec<f64>) -> Vec<f64> {
    list.sort_by(f64::total_cmp);
    list.dedup_by(|b, a| *b - *a < 1e-9);
    list
}

fn halve(knots: &[f64], times: u32) -> Vec<f64> {
    let parts = 1_u32 << times;
    let between =
        |w: &[f64]| (0..parts).map(|i| w[0] + (w[1] - w[0]) * f64::from(i) / f64::from(parts)).collect::<Vec<_>>();
    knots.windows(2).flat_map(between).chain(knots.last().copied()).collect()
}

/// Positions at which a curve is compared with the function.
fn looks(knots: &[f64]) -> Vec<f64> {
    let between = knots.windows(2).flat_map(|w| BETWEEN.map(|fraction| w[0] + (w[1] - w[0]) * fraction));
    between.chain(knots.iter().copied()).collect()
}

/// `sign * curve(sense * q)`.
fn with_sign(curve: &Curve, sign: f64, sense: f64) -> Option<Curve> {
    let turned = |knots: &Knots| {
        let mut points: Vec<(f64, f64)> =
            knots.positions().iter().zip(knots.values()).map(|(q, v)| (sense * q, sign * v)).collect();
        if sense < 0.0 {
            points.reverse();
        }
        Knots::new(&points, knots.period()).ok()
    };
    Some(match curve {
        Curve::Linear(knots) => Curve::Linear(turned(knots)?),
        Curve::Cubic(knots, _) => Curve::cubic(turned(knots)?),
        Curve::BSpline(spline) if sense < 0.0 => Curve::BSpline(Box::new(spline.mirrored(sign)?)),
        Curve::BSpline(spline) => {
            Curve::BSpline(Box::new(spline.with_coefficients(spline.coefficients().iter().map(|c| sign * c))))
        }
        Curve::Polynomial(c) => {
            let mut power = sign;
            let next = |c: &f64| {
                let value = c * power;
                power *= sense;
                value
            };
            Curve::Polynomial(c.iter().map(next).collect())
        }
        Curve::Harmonics(c) => Curve::Harmonics(c.iter().map(|(c, s)| (sign * c, sign * sense * s)).collect()),
    })
}

/// Through Chebyshev's points of the interval.
fn polynomial(f: impl Fn(f64) -> f64, range: Interval, degree: usize) -> Curve {
    let Interval { min: low, max: high } = range;
    let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).max(f64::MIN_POSITIVE));
    let nodes: Vec<f64> =
        (0..=degree).map(|k| sin_cos_degrees(90.0 * (2 * k + 1) as f64 / (degree + 1) as f64).1).collect();
    let mut differences: Vec<f64> = nodes.iter().map(|t| f(middle + half * t)).collect();
    for order in 1..=degree {
        for k in (order..=degree).rev() {
            differences[k] = (differences[k] - differences[k - 1]) / (nodes[k] - nodes[k - order]);
        }
    }
    // Horner over (t - node), t = (q - middle) / half.
    let mut c = vec![0.0; degree + 1];
    for k in (0..=degree).rev() {
        let shift = middle + half * nodes[k];
        for power in (0..=degree).rev() {
            let below = if power > 0 { c[power - 1] } else { 0.0 };
            c[power] = (below - shift * c[power]) / half;
        }
        c[0] += differences[k];
    }
    Curve::Polynomial(c)
}

/// The discrete Fourier series up to an order.
fn harmonics(f: impl Fn(f64) -> f64, order: usize, nothing: f64) -> Curve {
    let count = 2 * order + 2;
    let samples: Vec<f64> = (0..count).map(|i| f(360.0 * i as f64 / count as f64)).collect();
    let sum = |k: usize| {
        let turn = |i: usize| sin_cos_degrees(360.0 * ((i * k) % count) as f64 / count as f64);
        let (c, s) = samples.iter().enumerate().fold((0.0, 0.0), |(c, s), (i, v)| {
            let (sine, cosine) = turn(i);
            (c + v * cosine, s + v * sine)
        });
        let scale = if k == 0 { 1.0 } else { 2.0 } / count as f64;
        let clean = |x: f64| if x.abs() <= nothing { 0.0 } else { x };
        (clean(c * scale), if k == 0 { 0.0 } else { clean(s * scale) })
    };
    Curve::Harmonics((0..=order).map(sum).collect())
}
