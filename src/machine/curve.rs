//! Error curves: a component error as a function of the programmed position of its axis.
//!
//! Argument in mm or deg as programmed, value in mm or rad. A lookup is total: beyond its ends a
//! table holds the end value, because a corrected command may pass the end of the travel by the
//! correction. Positions a *user* gives are checked against [`Curve::domain`] before any lookup.

use super::CurveArgument;
use super::bspline::BSpline;
use super::knots::Knots;

/// The form of a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// Straight lines between knots.
    Linear(Knots),
    /// Natural cubic spline (periodic on continuous axes); second derivatives at the knots.
    Cubic(Knots, Vec<f64>),
    /// A sum of B-splines.
    BSpline(Box<BSpline>),
    /// Coefficients by rising power of the position (mm or deg).
    Polynomial(Vec<f64>),
    /// (cosine, sine) by rising order; order 0 is the constant. Argument in degrees.
    Harmonics(Vec<(f64, f64)>),
}

impl Curve {
    /// Returns a cubic spline through the knots.
    pub fn cubic(knots: Knots) -> Self {
        let second = second_derivatives(&knots);
        Self::Cubic(knots, second)
    }

    /// Value at a programmed position (mm or deg); held at the ends of a table.
    pub fn value<'a>(&self, at: impl Into<CurveArgument<'a>>) -> f64 {
        let position = at.into().position;
        match self {
            Self::Linear(knots) => knots.linear(position),
            Self::Cubic(knots, second) => knots.cubic(second, position),
            Self::BSpline(spline) => spline.value(position),
            Self::Polynomial(c) => c.iter().rev().fold(0.0, |sum, c| sum * position + c),
            Self::Harmonics(orders) => harmonics(orders, position),
        }
    }

    /// Returns the curve that goes on straight from its ends to these positions (mm, deg), a natural spline as one;
    /// `None` of a curve that is not through points.
    pub fn continued(&self, min: f64, max: f64) -> Option<Self> {
        let (knots, bend, is_cubic) = match self {
            Self::Linear(knots) => (knots, vec![0.0; knots.values.len()], false),
            Self::Cubic(knots, second) => (knots, second.clone(), true),
            _ => return None,
        };
        let (q, v, last) = (&knots.positions, &knots.values, knots.values.len().checked_sub(1)?);
        let chord = |i: usize| (q[i] - q[i - 1], (v[i] - v[i - 1]) / (q[i] - q[i - 1]));
        let ((first_step, first_slope), (last_step, last_slope)) = (last > 0).then(|| (chord(1), chord(last)))?;
        let start = first_slope - first_step / 6.0 * (2.0 * bend[0] + bend[1]);
        let end = last_slope + last_step / 6.0 * (bend[last - 1] + 2.0 * bend[last]);
        let mut points: Vec<(f64, f64)> = q.iter().copied().zip(v.iter().copied()).collect();
        if min < q[0] {
            points.insert(0, (min, v[0] + start * (min - q[0])));
        }
        if max > q[last] {
            points.push((max, v[last] + end * (max - q[last])));
        }
        let knots = Knots::new(&points, None).ok()?;
        Some(if is_cubic { Self::cubic(knots) } else { Self::Linear(knots) })
    }

    /// Returns the interval in which the curve is defined; `None` if everywhere.
    pub fn domain(&self) -> Option<(f64, f64)> {
        let knots = self.knots().filter(|k| k.period.is_none())?;
        knots.positions.first().copied().zip(knots.positions.last().copied())
    }

    /// Returns the points between which it is one polynomial, if there are any.
    pub fn knots(&self) -> Option<&Knots> {
        match self {
            Self::Linear(knots) | Self::Cubic(knots, _) => Some(knots),
            Self::BSpline(spline) => Some(spline.breaks()),
            Self::Polynomial(_) | Self::Harmonics(_) => None,
        }
    }
}

fn harmonics(orders: &[(f64, f64)], degrees: f64) -> f64 {
    let terms = orders.iter().enumerate().map(|(k, (cosine, sine))| {
        let (s, c) = sin_cos_degrees(k as f64 * degrees);
        cosine * c + sine * s
    });
    terms.sum()
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    let quarter = libm::round(turn / 90.0);
    let rest = (turn - quarter * 90.0).to_radians();
    let (s, c) = libm::sincos(rest);
    match quarter as u8 % 4 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Second derivatives of the natural (or, with a period, the periodic) cubic spline.
fn second_derivatives(knots: &Knots) -> Vec<f64> {
    let n = knots.positions.len();
    if n < 3 {
        return vec![0.0; n];
    }
    let h: Vec<f64> = knots.positions.windows(2).map(|w| w[1] - w[0]).collect();
    let slope: Vec<f64> = knots.values.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    if knots.period.is_some() { periodic_spline(&h, &slope) } else { natural_spline(&h, &slope) }
}

fn natural_spline(h: &[f64], slope: &[f64]) -> Vec<f64> {
    let rows: Vec<[f64; 4]> =
        (1..h.len()).map(|i| [h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i], 6.0 * (slope[i] - slope[i - 1])]).collect();
    let mut second = vec![0.0];
    second.extend(tridiagonal(&rows));
    second.push(0.0);
    second
}

/// Cyclic system by the Sherman-Morrison formula: two tridiagonal solutions.
fn periodic_spline(h: &[f64], slope: &[f64]) -> Vec<f64> {
    let n = h.len();
    let before = |i: usize| (i + n - 1) % n;
    let mut rows: Vec<[f64; 4]> = (0..n)
        .map(|i| [h[before(i)], 2.0 * (h[before(i)] + h[i]), h[i], 6.0 * (slope[i] - slope[before(i)])])
        .collect();
    let corner = h[n - 1];
    let gamma = -rows[0][1];
    rows[0][1] -= gamma;
    rows[n - 1][1] -= corner * corner / gamma;
    let base = tridiagonal(&rows);
    for (i, row) in rows.iter_mut().enumerate() {
        row[3] = if i == 0 {
            gamma
        } else if i == n - 1 {
            corner
        } else {
            0.0
        };
    }
    let side = tridiagonal(&rows);
    let factor = (base[0] + corner * base[n - 1] / gamma) / (1.0 + side[0] + corner * side[n - 1] / gamma);
    let mut second: Vec<f64> = base.iter().zip(&side).map(|(b, s)| b - factor * s).collect();
    second.push(second[0]);
    second
}

/// Solves rows (below, diagonal, above, right side); diagonally dominant, so no pivoting.
fn tridiagonal(rows: &[[f64; 4]]) -> Vec<f64> {
    let mut above = vec![0.0; rows.len()];
    let mut right = vec![0.0; rows.len()];
    for (i, [below, diagonal, up, value]) in rows.iter().enumerate() {
        let (above_before, right_before) = if i == 0 { (0.0, 0.0) } else { (above[i - 1], right[i - 1]) };
        let pivot = diagonal - below * above_before;
        above[i] = up / pivot;
        right[i] = (value - if i == 0 { 0.0 } else { below * right_before }) / pivot;
    }
    for i in (0..rows.len().saturating_sub(1)).rev() {
        right[i] -= above[i] * right[i + 1];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::KnotsFailure;

    fn knots(points: &[(f64, f64)], period: Option<f64>) -> Knots {
        Knots::new(points, period).unwrap()
    }

    #[test]
    fn degrees_are_exact_at_quarter_turns() {
        assert_eq!(sin_cos_degrees(90.0), (1.0, 0.0));
        assert_eq!(sin_cos_degrees(-90.0), (-1.0, 0.0));
        assert_eq!(sin_cos_degrees(540.0), (0.0, -1.0));
        let (s, c) = sin_cos_degrees(30.0);
        assert!((s - 0.5).abs() < 1e-16 && (c - 0.75_f64.sqrt()).abs() < 2e-16);
    }

    #[test]
    fn tables_interpolate_hold_and_wrap() {
        let open = Curve::Linear(knots(&[(0.0, 0.0), (10.0, 2.0)], None));
        assert_eq!((open.value(5.0), open.value(-1.0), open.value(11.0)), (1.0, 0.0, 2.0));
        assert_eq!(open.domain(), Some((0.0, 10.0)));
        let turn = Curve::Linear(knots(&[(0.0, 0.0), (90.0, 2.0), (360.0, 0.0)], Some(360.0)));
        assert_eq!((turn.value(405.0), turn.value(-315.0)), (1.0, 1.0));
        assert_eq!(turn.domain(), None);
    }

    #[test]
    fn a_natural_spline_reproduces_its_closed_form() {
        // Through (0,0),(1,1),(2,0) the natural spline is 1.5 x - 0.5 x^3 on [0,1].
        let spline = Curve::cubic(knots(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)], None));
        for x in [0.0, 0.25, 0.5, 1.0] {
            assert!((spline.value(x) - (1.5 * x - 0.5 * x * x * x)).abs() < 1e-15);
        }
    }

    #[test]
    fn a_periodic_spline_of_a_cosine_is_smooth_across_the_seam() {
        let points: Vec<_> = (0..=24).map(|i| (f64::from(i) * 15.0, sin_cos_degrees(f64::from(i) * 15.0).1)).collect();
        let spline = Curve::cubic(knots(&points, Some(360.0)));
        for x in [-7.5, 0.0, 3.0, 352.0, 360.0, 363.0] {
            assert!((spline.value(x) - sin_cos_degrees(x).1).abs() < 2e-5, "at {x}");
        }
    }

    #[test]
    fn bad_points_are_refused() {
        assert_eq!(Knots::new(&[], None), Err(KnotsFailure::Empty));
        assert_eq!(Knots::new(&[(0.0, 0.0), (0.0, 1.0)], None), Err(KnotsFailure::NotIncreasing(1)));
        assert_eq!(Knots::new(&[(0.0, 0.0), (350.0, 0.0)], Some(360.0)), Err(KnotsFailure::NotOnePeriod));
        assert_eq!(Knots::new(&[(0.0, 0.0), (360.0, 1.0)], Some(360.0)), Err(KnotsFailure::EndsDiffer));
    }
}
