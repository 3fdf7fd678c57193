//! B-splines: polynomials between breaks, joined as smoothly as their degree allows, as a sum of functions of small
//! support (de Boor, A Practical Guide to Splines, 1978). Open ones have knots of full multiplicity at both ends, so
//! that the first and the last coefficient are the values there; periodic ones continue on the other side.

use super::knots::{Knots, KnotsFailure};

const DEGREE: usize = 3;

/// A B-spline curve.
#[derive(Debug, Clone, PartialEq)]
pub struct BSpline {
    degree: usize,
    /// Breaks with the values there.
    breaks: Knots,
    /// The knots: `degree` more than the breaks on either side.
    knots: Vec<f64>,
    /// One for each interval, and `degree` more: on a periodic spline the first ones again.
    coefficients: Vec<f64>,
}

/// The reason for which a B-spline cannot be built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BSplineFailure {
    /// The degree is not 1 to 3.
    Degree,
    /// The number of coefficients is wrong; this one is needed.
    Count(usize),
    /// The breaks are none, or a coefficient is not finite.
    Breaks(KnotsFailure),
}

impl BSpline {
    /// Returns the number of coefficients of a B-spline with this number of breaks.
    pub fn count(degree: usize, breaks: usize, periodic: bool) -> usize {
        breaks.saturating_sub(1) + if periodic { 0 } else { degree }
    }

    /// Checks and keeps: breaks rise, and with a `period` cover one.
    pub fn new(
        degree: usize,
        breaks: &[f64],
        coefficients: &[f64],
        period: Option<f64>,
    ) -> Result<Self, BSplineFailure> {
        if !(1..=DEGREE).contains(&degree) {
            return Err(BSplineFailure::Degree);
        }
        let flat: Vec<(f64, f64)> = breaks.iter().map(|q| (*q, 0.0)).collect();
        let blank = Knots::new(&flat, period).map_err(BSplineFailure::Breaks)?;
        let count = Self::count(degree, breaks.len(), period.is_some());
        if breaks.len() < 2 || coefficients.len() != count {
            return Err(BSplineFailure::Count(count.max(degree + 1)));
        }
        if let Some(i) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(BSplineFailure::Breaks(KnotsFailure::NotFinite(i)));
        }
        let intervals = breaks.len() - 1;
        let knots = extend_breaks(breaks, degree, period);
        let coefficients = (0..intervals + degree).map(|i| coefficients[i % count]).collect();
        let mut spline = Self { degree, breaks: blank, knots, coefficients };
        let values: Vec<f64> = breaks.iter().map(|q| spline.value(*q)).collect();
        spline.breaks = spline.breaks.with_values(values);
        Ok(spline)
    }

    /// Returns the degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Returns the breaks with the values there.
    pub fn breaks(&self) -> &Knots {
        &self.breaks
    }

    /// Returns the coefficients, each once.
    pub fn coefficients(&self) -> &[f64] {
        let count = Self::count(self.degree, self.breaks.positions().len(), self.breaks.period().is_some());
        &self.coefficients[..count]
    }

    /// Returns the same with other coefficients; missing ones are 0.
    pub fn with_coefficients(&self, coefficients: impl IntoIterator<Item = f64>) -> Self {
        let mut list: Vec<f64> = coefficients.into_iter().collect();
        list.resize(self.coefficients().len(), 0.0);
        Self::new(self.degree, self.breaks.positions(), &list, self.breaks.period()).unwrap_or_else(|_| self.clone())
    }

    /// `sign` times the curve of the mirrored position.
    pub fn mirrored(&self, sign: f64) -> Option<Self> {
        let breaks: Vec<f64> = self.breaks.positions().iter().rev().map(|q| -q).collect();
        let (own, degree, periodic) = (self.coefficients(), self.degree, self.breaks.period().is_some());
        // Function i of a periodic spline ends `degree` intervals after it begins.
        let shift = if periodic { degree } else { 0 };
        let at = |i: usize| own[(2 * own.len() - 1 - i + shift) % own.len()] * sign;
        Self::new(degree, &breaks, &(0..own.len()).map(at).collect::<Vec<f64>>(), self.breaks.period()).ok()
    }

    /// Value at a position, held at the ends or wrapped: de Boor's algorithm.
    pub fn value(&self, position: f64) -> f64 {
        let (i, x) = self.breaks.locate(position);
        let d = self.degree;
        let mut sum = [0.0; DEGREE + 1];
        sum[..=d].copy_from_slice(&self.coefficients[i..=i + d]);
        for r in 1..=d {
            for j in (r..=d).rev() {
                let (low, high) = (self.knots[i + j], self.knots[i + j + d + 1 - r]);
                let fraction = (x - low) / (high - low);
                sum[j] = (1.0 - fraction) * sum[j - 1] + fraction * sum[j];
            }
        }
        sum[d]
    }

    /// Returns the sites of the coefficients: the mean of the inner knots of each function (Greville's abscissae). A
    /// spline of the same breaks is determined by its values there.
    pub fn sites(&self) -> Vec<f64> {
        let mean = |i: usize| self.knots[i + 1..=i + self.degree].iter().sum::<f64>() / self.degree as f64;
        (0..self.coefficients().len()).map(mean).collect()
    }

    /// Second derivatives at the breaks, between which they are straight; `None` if they jump (degree 2).
    pub fn second_derivatives(&self) -> Option<Vec<f64>> {
        match self.degree {
            1 => Some(vec![0.0; self.breaks.positions().len()]),
            2 => None,
            _ => {
                let mut second = self.second();
                // The seam is one place; computed from both sides it differs by rounding.
                if let (Some(_), [first, .., last]) = (self.breaks.period(), &mut second[..]) {
                    *last = *first;
                }
                Some(second)
            }
        }
    }

    /// Returns the second derivative as a spline two degrees lower: at every break, or in degree 2 in every interval.
    fn second(&self) -> Vec<f64> {
        derivative(&derivative(&self.coefficients, &self.knots, self.degree, 1), &self.knots, self.degree - 1, 2)
    }

    /// Returns the cubic pieces: positions, then values, then second derivatives. Where these jump the position occurs
    /// twice.
    pub fn pieces(&self) -> Vec<f64> {
        let (positions, values) = (self.breaks.positions(), self.breaks.values());
        match self.second_derivatives() {
            Some(second) => [positions, values, &second].concat(),
            None => {
                let twice = |list: &[f64]| -> Vec<f64> { list.windows(2).flat_map(|w| [w[0], w[1]]).collect() };
                let second = self.second().into_iter().flat_map(|s| [s, s]).collect();
                [twice(positions), twice(values), second].concat()
            }
        }
    }
}

/// Coefficients of the derivative of a spline of this degree, the first `skipped` knots not being its.
fn derivative(coefficients: &[f64], knots: &[f64], degree: usize, skipped: usize) -> Vec<f64> {
    let slope = |(i, pair): (usize, &[f64])| {
        degree as f64 * (pair[1] - pair[0]) / (knots[i + skipped + degree] - knots[i + skipped])
    };
    coefficients.windows(2).enumerate().map(slope).collect()
}

/// Returns the breaks with `degree` more knots on either side.
fn extend_breaks(breaks: &[f64], degree: usize, period: Option<f64>) -> Vec<f64> {
    let last = breaks.len() - 1;
    let at = |i: usize| match period {
        // Counted from `degree` intervals before the first break.
        Some(period) => {
            let place = i as i64 - degree as i64;
            breaks[place.rem_euclid(last as i64) as usize] + place.div_euclid(last as i64) as f64 * period
        }
        None => breaks[i.saturating_sub(degree).min(last)],
    };
    (0..=last + 2 * degree).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BREAKS: [f64; 5] = [-2.0, 0.0, 1.5, 2.0, 5.0];

    /// Returns the recursion of Cox and de Boor, as books print it; 0/0 counts as 0, the last interval is closed.
    fn recursion(knots: &[f64], i: usize, d: usize, x: f64) -> f64 {
        if d == 0 {
            let last = knots[knots.len() - 1];
            let closes = x == last && knots[i] < last && knots[i + 1] == last;
            return f64::from(u8::from((knots[i] <= x && x < knots[i + 1]) || closes));
        }
        let part = |top: f64, bottom: f64, i: usize| {
            if bottom == 0.0 { 0.0 } else { top / bottom * recursion(knots, i, d - 1, x) }
        };
        part(x - knots[i], knots[i + d] - knots[i], i)
            + part(knots[i + d + 1] - x, knots[i + d + 1] - knots[i + 1], i + 1)
    }

    fn unit(degree: usize, k: usize, period: Option<f64>) -> BSpline {
        let count = BSpline::count(degree, BREAKS.len(), period.is_some());
        let one: Vec<f64> = (0..count).map(|i| f64::from(u8::from(i == k))).collect();
        BSpline::new(degree, &BREAKS, &one, period).unwrap()
    }

    fn places() -> impl Iterator<Item = f64> {
        (0..=140).map(|i| -2.0 + f64::from(i) * 0.05)
    }

    #[test]
    fn every_function_is_that_of_the_recursion() {
        for degree in 1..=DEGREE {
            let repeated = |q: f64| vec![q; degree];
            let knots = [repeated(-2.0), BREAKS.to_vec(), repeated(5.0)].concat();
            for k in 0..BSpline::count(degree, BREAKS.len(), false) {
                let spline = unit(degree, k, None);
                for x in places() {
                    let (ours, theirs) = (spline.value(x), recursion(&knots, k, degree, x.min(5.0)));
                    assert!((ours - theirs).abs() < 4e-15, "degree {degree}, function {k} at {x}: {ours}, {theirs}");
                }
            }
        }
    }

    #[test]
    fn functions_of_a_period_are_those_of_an_endless_row_of_knots() {
        // Knot 24 + j is break j, or what it is some turns away.
        let knots: Vec<f64> =
            (-24_i32..=24).map(|j| BREAKS[j.rem_euclid(4) as usize] + 7.0 * f64::from(j.div_euclid(4))).collect();
        for degree in 1..=DEGREE {
            for k in 0..4 {
                let spline = unit(degree, k, Some(7.0));
                for x in places().filter(|x| *x < 5.0) {
                    let theirs: f64 = (0..5).map(|turn| recursion(&knots, 16 + k + 4 * turn - degree, degree, x)).sum();
                    for away in [0.0, 7.0, -14.0] {
                        let ours = spline.value(x + away);
                        assert!((ours - theirs).abs() < 2e-14, "degree {degree}, {k} at {x}: {ours}, {theirs}");
                    }
                }
            }
        }
    }

    #[test]
    fn they_add_up_to_one() {
        for (degree, period) in (1..=DEGREE).flat_map(|d| [(d, None), (d, Some(7.0))]) {
            let count = BSpline::count(degree, BREAKS.len(), period.is_some());
            let all = BSpline::new(degree, &BREAKS, &vec![1.0; count], period).unwrap();
            assert!(places().all(|x| (all.value(x) - 1.0).abs() < 4e-16));
        }
    }

    /// Marsden's identity: with the products of the inner knots for coefficients it is a power.
    #[test]
    fn cubics_are_among_them() {
        let blank = unit(3, 0, None);
        let t = &blank.knots;
        let cube = blank.with_coefficients((0..7).map(|i| t[i + 1] * t[i + 2] * t[i + 3]));
        assert!(places().all(|x| (cube.value(x) - x * x * x).abs() < 6e-14));
        let second = cube.second_derivatives().unwrap();
        assert!(second.iter().zip(BREAKS).all(|(s, x)| (s - 6.0 * x).abs() < 4e-14), "{second:?}");
    }

    /// Values of scipy.interpolate.BSpline, SciPy 1.17.1.
    #[test]
    fn scipy_says_the_same() {
        let coefficients = [1.0, -2.0, 0.5, 3.0, -1.0, 2.5, 0.25];
        let places = [-2.0, -1.25, 0.7, 1.9, 4.0, 5.0];
        let theirs = [
            (2, 6, [1.0, -0.627232142857143, 0.6035714285714284, 2.6092857142857144, 0.9365079365079365, 2.5]),
            (3, 7, [1.0, -0.7456154336734695, 1.9533675170068028, 1.3044035714285718, 1.115873015873016, 0.25]),
        ];
        for (degree, count, values) in theirs {
            let spline = BSpline::new(degree, &BREAKS, &coefficients[..count], None).unwrap();
            let off = |(x, v): (&f64, &f64)| (spline.value(*x) - v).abs();
            assert!(places.iter().zip(&values).map(off).all(|off| off < 2e-15), "degree {degree}");
        }
        let spline = BSpline::new(3, &BREAKS, &coefficients, None).unwrap();
        let second = [6.642857142857142, -0.1530612244897959, -4.275, 3.085714285714286, -3.5];
        assert!(spline.second_derivatives().unwrap().iter().zip(second).all(|(a, b)| (a - b).abs() < 2e-14));
    }

    #[test]
    fn a_cubic_one_is_its_values_and_second_derivatives() {
        for period in [None, Some(7.0)] {
            let spline = unit(3, 1, period);
            let (knots, second) = (spline.breaks(), spline.second_derivatives().unwrap());
            let curve = crate::machine::Curve::Cubic(knots.clone(), second);
            assert!(places().all(|x| (curve.value(x) - spline.value(x)).abs() < 4e-16));
        }
    }

    #[test]
    fn pieces_are_cubics_between_positions() {
        for (degree, period) in (1..=DEGREE).flat_map(|d| [(d, None), (d, Some(7.0))]) {
            let spline = unit(degree, 2, period);
            let numbers = spline.pieces();
            let (at, rest) = numbers.split_at(numbers.len() / 3);
            let (values, second) = rest.split_at(at.len());
            for x in places().filter(|x| *x < 5.0) {
                let i = at.iter().rposition(|q| *q <= x).unwrap();
                let (h, b) = (at[i + 1] - at[i], (x - at[i]) / (at[i + 1] - at[i]));
                let bend = |s: f64| (s * s * s - s) * h * h / 6.0;
                let ours =
                    (1.0 - b) * values[i] + b * values[i + 1] + bend(1.0 - b) * second[i] + bend(b) * second[i + 1];
                assert!((ours - spline.value(x)).abs() < 1e-15, "degree {degree} at {x}");
            }
        }
    }

    #[test]
    fn mirrors_and_sites_are_where_they_belong() {
        for (degree, period) in (1..=DEGREE).flat_map(|d| [(d, None), (d, Some(7.0))]) {
            for k in 0..4 {
                let (one, other) = (unit(degree, k, period), unit(degree, k, period).mirrored(-1.0).unwrap());
                assert!(places().all(|x| (one.value(x) + other.value(-x)).abs() < 2e-14), "degree {degree}, {k}");
            }
        }
        let sites = unit(3, 0, None).sites();
        assert_eq!((sites[0], sites[6]), (-2.0, 5.0));
        assert!(sites.windows(2).all(|w| w[0] < w[1]) && (sites[3] - 3.5 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_none_is_refused() {
        let failure = |degree, count: usize| BSpline::new(degree, &BREAKS, &vec![0.0; count], None).unwrap_err();
        assert_eq!((failure(0, 4), failure(4, 8)), (BSplineFailure::Degree, BSplineFailure::Degree));
        assert_eq!(failure(3, 6), BSplineFailure::Count(7));
        assert_eq!(
            BSpline::new(1, &[0.0, 0.0], &[0.0, 1.0], None),
            Err(BSplineFailure::Breaks(KnotsFailure::NotIncreasing(1)))
        );
        assert_eq!(BSpline::new(2, &[1.0], &[0.0, 1.0], None), Err(BSplineFailure::Count(3)));
    }
}
