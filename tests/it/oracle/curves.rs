//! Error curves: the forms of the machine language, evaluated at a position by textbook means.
//!
//! Positions are in mm or deg as in the file, values in mm or rad.

/// Choice between the two curves of a reversing axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Travel {
    /// The mean of both.
    Mean,
    /// Moving to larger positions.
    Forward,
    /// Moving to smaller ones.
    Reverse,
}

/// Dependence of one column of values on the position.
#[derive(Clone, Debug)]
pub enum Curve {
    /// The same everywhere.
    Constant(f64),
    /// Coefficients by power of the position.
    Polynomial(Vec<f64>),
    /// Values at positions.
    Points(Points),
    /// Order, cosine and sine part; the angle is the position in deg.
    Harmonics(Vec<(u32, f64, f64)>),
}

/// A table of values and how to look between them.
#[derive(Clone, Debug)]
pub struct Points {
    /// Increasing positions.
    pub at: Vec<f64>,
    /// Values there.
    pub values: Vec<f64>,
    /// Cubic spline instead of straight lines.
    pub cubic: bool,
    /// The table covers one turn and goes on for ever.
    pub periodic: bool,
    /// Written as a CSV file instead of a list.
    pub file: bool,
}

/// An error that may differ with the direction of travel.
#[derive(Clone, Debug)]
pub struct Error {
    /// The curve, or the forward one.
    pub forward: Curve,
    /// The reverse curve if there is one.
    pub reverse: Option<Curve>,
}

impl Error {
    /// The value at a position.
    pub fn at(&self, position: f64, travel: Travel) -> f64 {
        let forward = self.forward.at(position);
        let reverse = self.reverse.as_ref().map_or(forward, |curve| curve.at(position));
        match travel {
            Travel::Mean => (forward + reverse) / 2.0,
            Travel::Forward => forward,
            Travel::Reverse => reverse,
        }
    }

    /// The same error `factor` times as large.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { forward: self.forward.scaled(factor), reverse: self.reverse.as_ref().map(|c| c.scaled(factor)) }
    }
}

impl Curve {
    /// The value at a position.
    pub fn at(&self, position: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Polynomial(c) => c.iter().enumerate().map(|(k, c)| c * position.powi(k as i32)).sum(),
            Self::Points(points) => points.at(position),
            Self::Harmonics(terms) => {
                let wave = |&(k, c, s): &(u32, f64, f64)| {
                    let angle = (f64::from(k) * position).to_radians();
                    c * angle.cos() + s * angle.sin()
                };
                terms.iter().map(wave).sum()
            }
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value * factor),
            Self::Polynomial(c) => Self::Polynomial(c.iter().map(|c| c * factor).collect()),
            Self::Points(p) => {
                Self::Points(Points { values: p.values.iter().map(|v| v * factor).collect(), ..p.clone() })
            }
            Self::Harmonics(h) => Self::Harmonics(h.iter().map(|&(k, c, s)| (k, c * factor, s * factor)).collect()),
        }
    }
}

impl Points {
    fn at(&self, position: f64) -> f64 {
        let position = if self.periodic { position.rem_euclid(360.0) } else { position };
        let last = self.at.len() - 2;
        let i = (0..=last).rev().find(|&i| self.at[i] <= position).unwrap_or(0);
        let width = self.at[i + 1] - self.at[i];
        let (right, left) = ((position - self.at[i]) / width, (self.at[i + 1] - position) / width);
        let straight = left * self.values[i] + right * self.values[i + 1];
        if !self.cubic {
            return straight;
        }
        let bend = self.second_derivatives();
        straight + ((left.powi(3) - left) * bend[i] + (right.powi(3) - right) * bend[i + 1]) * width * width / 6.0
    }

    /// The second derivatives of the spline at the points, from its dense system of equations.
    fn second_derivatives(&self) -> Vec<f64> {
        let count = self.at.len();
        let width = |i: usize| self.at[i + 1] - self.at[i];
        let slope = |i: usize| (self.values[i + 1] - self.values[i]) / width(i);
        let mut rows = vec![vec![0.0; count + 1]; count];
        for i in 1..count - 1 {
            rows[i][i - 1] = width(i - 1);
            rows[i][i] = 2.0 * (width(i - 1) + width(i));
            rows[i][i + 1] = width(i);
            rows[i][count] = 6.0 * (slope(i) - slope(i - 1));
        }
        rows[0][0] = 1.0;
        let end = count - 1;
        if self.periodic {
            // Equal bend at both ends, and equal slope.
            rows[0][end] = -1.0;
            rows[end][0] += 2.0 * width(0);
            rows[end][1] += width(0);
            rows[end][end - 1] += width(end - 1);
            rows[end][end] += 2.0 * width(end - 1);
            rows[end][count] = 6.0 * (slope(0) - slope(end - 1));
        } else {
            rows[end][end] = 1.0;
        }
        solve(rows)
    }
}

/// Gauss-Jordan with pivoting; the last column is the right-hand side.
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let count = rows.len();
    for column in 0..count {
        let pivot = (column..count).max_by(|&i, &j| rows[i][column].abs().total_cmp(&rows[j][column].abs())).unwrap();
        rows.swap(column, pivot);
        let scale = rows[column][column];
        let pivot_row: Vec<f64> = rows[column].iter().map(|v| v / scale).collect();
        for (index, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            for (v, p) in row.iter_mut().zip(&pivot_row) {
                *v = if index == column { *p } else { *v - factor * p };
            }
        }
    }
    rows.iter().map(|row| row[count]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spline(at: &[f64], value: impl Fn(f64) -> f64, periodic: bool) -> Points {
        Points { at: at.to_vec(), values: at.iter().map(|&x| value(x)).collect(), cubic: true, periodic, file: false }
    }

    #[test]
    fn a_natural_spline_through_three_points_is_the_one_by_hand() {
        // Through (0, 0), (1, 1), (2, 0): bends 0, -3, 0, so at 1/2 it is 1/2 + (1/8 - 1/2)(-3)/6.
        let points = spline(&[0.0, 1.0, 2.0], |x| if x == 1.0 { 1.0 } else { 0.0 }, false);
        assert!((points.at(0.5) - 0.6875).abs() < 1e-15);
        assert!((points.at(1.5) - 0.6875).abs() < 1e-15);
    }

    #[test]
    fn a_periodic_spline_is_smooth_over_the_seam() {
        let wave = |x: f64| x.to_radians().sin() + (2.0 * x).to_radians().cos();
        let points = spline(&[0.0, 50.0, 110.0, 200.0, 290.0, 360.0], wave, true);
        let step = 0.01;
        let slope = |x: f64| (points.at(x + step) - points.at(x - step)) / (2.0 * step);
        let bend = |x: f64| (slope(x + step) - slope(x - step)) / (2.0 * step);
        // Over four steps the slope changes by them times the bend, the bend by them times the third derivative.
        let (before, after) = (-2.0 * step, 2.0 * step);
        assert!((slope(after) - slope(before) - 4.0 * step * bend(0.0)).abs() < 1e-7);
        assert!((bend(after) - bend(before)).abs() < 1e-5);
        assert!(bend(0.0).abs() > 1e-4, "nothing to compare");
        assert!((points.at(730.0) - points.at(10.0)).abs() < 1e-15);
    }
}
