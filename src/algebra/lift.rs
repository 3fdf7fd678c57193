//! Taylor coefficients f^(k)(x)/k! of the functions that the models need: each function fills
//! `c[k]` for k = 0..c.len().

/// Sine.
#[inline]
pub fn sin(x: f64, c: &mut [f64]) {
    let (s, co) = libm::sincos(x);
    cycle([s, co, -s, -co], c);
}

/// Derivatives that repeat with period four, over k!: sine and cosine.
#[inline]
pub fn cycle(derivatives: [f64; 4], c: &mut [f64]) {
    let mut factorial = 1.0;
    for (k, c) in c.iter_mut().enumerate() {
        factorial *= k.max(1) as f64;
        *c = derivatives[k % 4] / factorial;
    }
}

/// Exponential.
pub fn exp(x: f64, c: &mut [f64]) {
    recurrence(libm::exp(x), c, |k| 1.0 / k);
}

/// Square root, x > 0.
pub fn sqrt(x: f64, c: &mut [f64]) {
    recurrence(libm::sqrt(x), c, |k| (1.5 - k) / (k * x));
}

/// Reciprocal, x != 0.
pub fn recip(x: f64, c: &mut [f64]) {
    recurrence(1.0 / x, c, |_| -1.0 / x);
}

/// Returns the first, then each coefficient from the one before: `c[k] = c[k-1] * ratio(k)`.
fn recurrence(first: f64, c: &mut [f64], ratio: impl Fn(f64) -> f64) {
    let mut value = first;
    for (k, c) in c.iter_mut().enumerate() {
        value *= if k == 0 { 1.0 } else { ratio(k as f64) };
        *c = value;
    }
}

/// sin(t)/t as a function of x = t^2: entire, so it needs no case for small angles.
pub fn sinc(x: f64, c: &mut [f64]) {
    power_series(x, c, 1.0, |i| -1.0 / ((2.0 * i) * (2.0 * i + 1.0)));
}

/// (1 - cos t)/t^2 as a function of x = t^2.
pub fn cosc(x: f64, c: &mut [f64]) {
    power_series(x, c, 0.5, |i| -1.0 / ((2.0 * i + 1.0) * (2.0 * i + 2.0)));
}

/// (t - sin t)/t^3 as a function of x = t^2.
pub fn sincc(x: f64, c: &mut [f64]) {
    power_series(x, c, 1.0 / 6.0, |i| -1.0 / ((2.0 * i + 2.0) * (2.0 * i + 3.0)));
}

/// asin(s)/s as a function of x = s^2, |x| < 1.
pub fn asinc(x: f64, c: &mut [f64]) {
    power_series(x, c, 1.0, |i| (2.0 * i - 1.0) * (2.0 * i - 1.0) / ((2.0 * i) * (2.0 * i + 1.0)));
}

/// Far more terms than any argument below 1 needs.
const LONGEST: usize = 400;

/// Returns the value alone, which the exact model asks for millions of times.
fn power_sum(x: f64, first: f64, ratio: impl Fn(f64) -> f64) -> f64 {
    let (mut term, mut sum) = (first, first);
    for i in 1..LONGEST {
        term *= ratio(i as f64) * x;
        sum += term;
        if term.abs() <= 1e-18 * sum.abs() {
            break;
        }
    }
    sum
}

/// Re-expands `sum a[i] x^i` (`a[i] = a[i-1] * ratio(i)`) about `x`:
/// `c[m] = sum over i >= m of binomial(i, m) a[i] x^(i-m)`.
fn power_series(x: f64, c: &mut [f64], first: f64, ratio: impl Fn(f64) -> f64) {
    if let [value] = c {
        *value = power_sum(x, first, ratio);
        return;
    }
    c.fill(0.0);
    let (mut a, mut smallest_power) = (first, 1.0);
    for i in 0..LONGEST {
        if i > 0 {
            a *= ratio(i as f64);
        }
        if i >= c.len() {
            smallest_power *= x;
        }
        if add_degree(i, a, smallest_power, x, c) < 1e-18 && i >= c.len() {
            break;
        }
    }
}

/// Adds the terms of `a x^i`; returns how much the largest of them changed its coefficient.
fn add_degree(i: usize, a: f64, smallest_power: f64, x: f64, c: &mut [f64]) -> f64 {
    let top = i.min(c.len() - 1);
    let mut term = a * smallest_power * binomial(i, top);
    let mut largest = 0.0_f64;
    for m in (0..=top).rev() {
        c[m] += term;
        largest = largest.max((term / c[m]).abs());
        // From binomial(i, m) x^(i-m) to binomial(i, m-1) x^(i-m+1).
        term *= x * m as f64 / (i - m + 1) as f64;
    }
    largest
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).map(|j| (n - j) as f64 / (j + 1) as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coefficients<const N: usize>(f: impl Fn(f64, &mut [f64]), x: f64) -> [f64; N] {
        let mut c = [0.0; N];
        f(x, &mut c);
        c
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 4e-16 * b.abs().max(1.0), "{a} {b}");
    }

    #[test]
    fn entire_functions_agree_with_their_closed_forms() {
        for t in [1e-8, 0.1, 0.7, 2.0_f64] {
            close(coefficients::<1>(sinc, t * t)[0], libm::sin(t) / t);
            close(coefficients::<1>(cosc, t * t)[0], 2.0 * libm::pow(libm::sin(t / 2.0) / t, 2.0));
        }
        close(coefficients::<1>(asinc, 0.09)[0], libm::asin(0.3) / 0.3);
    }

    #[test]
    fn coefficients_are_derivatives_over_factorials() {
        // d/dx sin(sqrt x)/sqrt x = (cos t - sin t / t) / (2 t^2)
        let t = 0.6_f64;
        close(coefficients::<2>(sinc, t * t)[1], (libm::cos(t) - libm::sin(t) / t) / (2.0 * t * t));
        assert_eq!(coefficients(sqrt, 4.0), [2.0, 0.25, -0.015_625]);
        assert_eq!(coefficients(recip, 2.0), [0.5, -0.25, 0.125]);
        assert_eq!(coefficients(exp, 0.0), [1.0, 1.0, 0.5, 1.0 / 6.0]);
        assert_eq!(coefficients(sin, 0.0), [0.0, 1.0, -0.0, -1.0 / 6.0]);
    }
}
