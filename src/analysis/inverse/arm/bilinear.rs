//! Two equations, each linear in the cosine and sine of two angles:
//! `sum_ij k_ij f_i(a) f_j(b) = 0` with `f = (1, cos, sin)`.
//!
//! The first angle is eliminated; what is left is a trigonometric polynomial of degree 4 in the second, whose roots are
//! eigenvalues of a companion matrix. Solutions are candidates: they are refined and checked on the whole chain.

use nalgebra::{Complex, DMatrix, Schur, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Coefficients of an equation, rows by the first angle.
type Coefficients = [Vector3<f64>; 3];

const DEGREE: usize = 4;

/// Samples of the polynomial: more than its coefficients.
const SAMPLES: usize = 16;

/// Distance from the unit circle below which a root may be a real angle: multiple roots are known to a few digits only.
const NEAR_CIRCLE: f64 = 0.02;

/// Determinant, of equations scaled to 1, below which each of them is also solved by itself.
const DEPENDENT: f64 = 1e-3;

/// Returns the candidates (a, b), rad, for the zeros of two functions of that kind; `free` is taken for a first angle
/// that nothing depends on.
pub fn candidates(of: impl Fn(f64, f64) -> [f64; 2], free: f64) -> Vec<(f64, f64)> {
    let pair = [0, 1].map(|k| scale(coefficients(|a, b| of(a, b)[k])));
    let angles: Vec<f64> = match flat(&pair) {
        Some(k) => trigonometric_roots(&pair[k][0]),
        None => roots(|b| resultant(&pair, b)),
    };
    angles.into_iter().flat_map(|b| first_angles(&pair, b, free).into_iter().map(move |a| (a, b))).collect()
}

/// Returns the equation that does not depend on the first angle, if one does not.
fn flat(pair: &[Coefficients; 2]) -> Option<usize> {
    (0..2).find(|k| pair[*k][1].amax() < 1e-12 && pair[*k][2].amax() < 1e-12 && pair[*k][0].amax() > 0.0)
}

/// Returns the coefficients of a function, from its values at nine places.
fn coefficients(of: impl Fn(f64, f64) -> f64) -> Coefficients {
    let split = |f: &dyn Fn(f64) -> f64| {
        let (zero, half, quarter) = (f(0.0), f(PI), f(FRAC_PI_2));
        let mean = (zero + half) / 2.0;
        Vector3::new(mean, (zero - half) / 2.0, quarter - mean)
    };
    let columns = [0.0, PI, FRAC_PI_2].map(|a| split(&|b| of(a, b)));
    let mean = (columns[0] + columns[1]) / 2.0;
    [mean, (columns[0] - columns[1]) / 2.0, columns[2] - mean]
}

fn scale(equation: Coefficients) -> Coefficients {
    let largest = equation.iter().map(|row| row.amax()).fold(0.0, f64::max);
    if largest > 0.0 { equation.map(|row| row / largest) } else { equation }
}

/// Returns constant, cosine and sine coefficients in the first angle at a second one.
fn at(equation: &Coefficients, b: f64) -> [f64; 3] {
    let f = Vector3::new(1.0, libm::cos(b), libm::sin(b));
    equation.map(|row| row.dot(&f))
}

/// Returns the resultant by the first angle: zero where both equations have a common solution.
fn resultant(pair: &[Coefficients; 2], b: f64) -> f64 {
    let ([c1, a1, b1], [c2, a2, b2]) = (at(&pair[0], b), at(&pair[1], b));
    let (cosine, sine, det) = (b1 * c2 - b2 * c1, a2 * c1 - a1 * c2, a1 * b2 - a2 * b1);
    cosine * cosine + sine * sine - det * det
}

fn first_angles(pair: &[Coefficients; 2], b: f64, free: f64) -> Vec<f64> {
    let equations = [at(&pair[0], b), at(&pair[1], b)];
    let [[c1, a1, b1], [c2, a2, b2]] = equations;
    let det = a1 * b2 - a2 * b1;
    let mut found = Vec::new();
    if det.abs() > 1e-9 {
        found.push(libm::atan2((a2 * c1 - a1 * c2) / det, (b1 * c2 - b2 * c1) / det));
    }
    if det.abs() < DEPENDENT {
        let size = |e: &[f64; 3]| libm::hypot(e[1], e[2]);
        let larger = if size(&equations[0]) >= size(&equations[1]) { &equations[0] } else { &equations[1] };
        if size(larger) < 1e-9 {
            found.push(free);
        } else {
            found.extend(trigonometric_roots(&Vector3::from(*larger)));
        }
    }
    found
}

/// Returns the angles at which `c + a cos + b sin` is zero, or touches it up to rounding.
pub fn trigonometric_roots(coefficients: &Vector3<f64>) -> Vec<f64> {
    let (c, a, b) = (coefficients[0], coefficients[1], coefficients[2]);
    let size = libm::hypot(a, b);
    if size < 1e-12 || c.abs() > size * (1.0 + 1e-4) {
        return Vec::new();
    }
    let (middle, half) = (libm::atan2(b, a), libm::acos((-c / size).clamp(-1.0, 1.0)));
    vec![middle + half, middle - half]
}

/// Returns the angles (rad) at which a trigonometric polynomial of degree 4 is zero, or nearly touches it.
fn roots(of: impl Fn(f64) -> f64) -> Vec<f64> {
    let values: Vec<f64> = (0..SAMPLES).map(|k| of(TAU * k as f64 / SAMPLES as f64)).collect();
    let fourier = |n: i64| {
        let term = |(k, value): (usize, &f64)| {
            let angle = -TAU * (n * k as i64) as f64 / SAMPLES as f64;
            Complex::new(libm::cos(angle), libm::sin(angle)) * (*value / SAMPLES as f64)
        };
        values.iter().enumerate().map(term).sum::<Complex<f64>>()
    };
    let degree = DEGREE as i64;
    let mut list: Vec<Complex<f64>> = (-degree..=degree).map(fourier).collect();
    let size = |c: &Complex<f64>| libm::hypot(c.re, c.im);
    let largest = list.iter().map(size).fold(0.0, f64::max);
    // The outer coefficients are conjugate: they vanish together.
    while list.len() > 1 && list.last().is_some_and(|c| size(c) <= 1e-13 * largest) {
        list.pop();
        list.remove(0);
    }
    let Some((lead, rest)) = list.split_last().filter(|(_, rest)| !rest.is_empty()) else { return Vec::new() };
    let n = rest.len();
    let companion = DMatrix::from_fn(n, n, |i, j| match (i, j) {
        (i, j) if j == n - 1 => -rest[i] / *lead,
        (i, j) if i == j + 1 => Complex::new(1.0, 0.0),
        _ => Complex::new(0.0, 0.0),
    });
    let Some(schur) = Schur::try_new(companion, 1e-14, 1000) else { return Vec::new() };
    let Some(eigenvalues) = schur.eigenvalues() else { return Vec::new() };
    let real = |z: &&Complex<f64>| (size(z) - 1.0).abs() < NEAR_CIRCLE;
    eigenvalues.iter().filter(real).map(|z| libm::atan2(z.im, z.re)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: &[f64], wanted: f64, tolerance: f64) -> bool {
        found.iter().any(|x| (libm::remainder(x - wanted, TAU)).abs() < tolerance)
    }

    #[test]
    fn all_roots_of_a_polynomial_are_found() {
        // sin((b - r) / 2) for eight roots, the last of them double.
        let places = [-2.5, -1.7, -0.2, 0.1, 0.9, 1.4, 2.8, 2.8];
        let found = roots(|b| places.iter().map(|r| libm::sin((b - r) / 2.0)).product());
        assert!(places[..6].iter().all(|r| near(&found, *r, 1e-9)) && near(&found, 2.8, 1e-4), "{found:?}");
    }

    #[test]
    fn the_solution_of_a_pair_is_among_the_candidates() {
        for n in 0..40_u32 {
            let k = |i: u32| libm::sin(f64::from(17 * n + 5 * i + 3));
            let (a0, b0) = (3.0 * k(90), 3.0 * k(91));
            let f = |x: f64| [1.0, libm::cos(x), libm::sin(x)];
            let value = |e: u32, a: f64, b: f64| -> f64 {
                (0..9).map(|i| k(10 * e + i) * f(a)[i as usize / 3] * f(b)[i as usize % 3]).sum()
            };
            let of = |a: f64, b: f64| [0, 1].map(|e| value(e, a, b) - value(e, a0, b0));
            let found = candidates(of, 0.0);
            let hit = |(a, b): &(f64, f64)| near(&[*a], a0, 1e-6) && near(&[*b], b0, 1e-6);
            assert!(found.iter().any(hit), "{n}: {found:?} without {a0} {b0}");
        }
    }
}
