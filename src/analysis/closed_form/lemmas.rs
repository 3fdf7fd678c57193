//! The lemmas and theorems of the papers of 2014 and 2015 on matrices over the dual numbers, at one matrix A + iB.

use crate::algebra::{commutator_defect, error_class};
use crate::units::significant;
use nalgebra::DMatrix;

/// A statement of a paper at one matrix.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct Lemma {
    /// The statement, with its number in the paper.
    pub statement: String,
    /// True if it holds for this matrix.
    pub holds: bool,
    /// The reason, with what was computed.
    pub reason: String,
}

/// Differences below this are rounding.
const ROUNDING: f64 = 1e-9;

/// Returns the statements that speak of an orthogonal A with the parts of degree 1, 2, ... of its extension.
pub fn lemmas(a: &DMatrix<f64>, higher: &[DMatrix<f64>]) -> Vec<Lemma> {
    let basis = error_class(a);
    let none = DMatrix::zeros(a.nrows(), a.ncols());
    let b = higher.first().unwrap_or(&none);
    let special = a.determinant() > 0.0;
    let (plane, space) = (special && a.nrows() == 2, special && a.nrows() == 3);
    let mut all = vec![theorem_1(a, b), definition_2(a, &basis), lie_algebra(a)];
    all.extend(plane.then(|| lemma_4(a, b)));
    all.extend(higher.get(1).filter(|_| plane).map(|c| theorem_2015(a, b, c)));
    all.extend(is_exchange(a).then(|| equation_15(&basis)));
    all.extend(space.then(|| theorem_6(a)));
    all.extend(turn_about_y(a).filter(|_| space).map(|sine_cosine| equation_27(a, sine_cosine)));
    all
}

fn lemma(statement: &str, holds: bool, reason: String) -> Lemma {
    Lemma { statement: statement.to_owned(), holds, reason }
}

/// A^T B + B^T A.
fn defect(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    let product = a.transpose() * b;
    (&product + product.transpose()).amax()
}

fn theorem_1(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Lemma {
    let size = defect(a, b);
    let holds = size <= ROUNDING * b.amax().max(f64::MIN_POSITIVE);
    lemma("2014, Theorem 1: A^T B + B^T A = 0", holds, format!("largest entry {}", shown(size, b.amax())))
}

/// A number, or 0 where it is rounding beside another.
fn shown(size: f64, beside: f64) -> String {
    if size <= ROUNDING * beside { "0".to_owned() } else { format!("{size:.3e}") }
}

fn definition_2(a: &DMatrix<f64>, basis: &[DMatrix<f64>]) -> Lemma {
    let size = basis.iter().map(|b| (a.transpose() * b + a * b.transpose()).amax()).fold(0.0, f64::max);
    let reason = format!("largest entry {} over a basis of I^A", shown(size, 1.0));
    lemma("2014, Definition 2 as printed: A^T B + A B^T = 0", size <= ROUNDING, reason)
}

/// Returns the lemma on commutators.
pub fn lie_algebra(a: &DMatrix<f64>) -> Lemma {
    let (size, skew) = (commutator_defect(a), (a - a.transpose()).amax());
    let reason = match (a.nrows(), skew <= ROUNDING) {
        (_, true) => "A is symmetric".to_owned(),
        (2, false) => "A is not symmetric, but I^A is a line: commutators vanish".to_owned(),
        _ => format!("A is not symmetric: a commutator leaves I^A by {}", shown(size, 1.0)),
    };
    lemma("2014, Lemma 3: I^A is a Lie algebra", size <= ROUNDING, reason)
}

fn lemma_4(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Lemma {
    let (cosine, sine) = (a[(0, 0)], a[(1, 0)]);
    let gamma = cosine * b[(1, 0)] - sine * b[(0, 0)];
    let statement = "2014, Lemma 4: B = k (-tan(phi), -1; 1, -tan(phi))";
    if cosine.abs() <= ROUNDING {
        let reason = format!("tan(phi) has no value; as in 2015, -k sin(phi) and k cos(phi), k = {gamma:.6e}");
        return lemma(statement, false, reason);
    }
    lemma(statement, true, format!("k = {:.6e}, an error of the angle of {gamma:.6e} rad", gamma * cosine))
}

/// C of degree 2 is that of the angle phi + k i + m i^2; the print has m = 0.
fn theorem_2015(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>) -> Lemma {
    let (cosine, sine) = (a[(0, 0)], a[(1, 0)]);
    let along = |m: &DMatrix<f64>| cosine * m[(1, 0)] - sine * m[(0, 0)];
    let (k, m) = (along(b), along(c));
    let holds = m.abs() <= ROUNDING * c.amax().max(f64::MIN_POSITIVE);
    lemma("2015, SO(2, D_2) as printed: the angle phi + k i", holds, format!("k = {k:.6e}, and m = {m:.6e} of i^2"))
}

/// True of E-bar of equation (13): two unit blocks beside the diagonal.
fn is_exchange(a: &DMatrix<f64>) -> bool {
    let (n, half) = (a.nrows(), a.nrows() / 2);
    let wanted = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from((i + half) % n == j)));
    n.is_multiple_of(2) && (a - wanted).amax() <= ROUNDING
}

fn equation_15(basis: &[DMatrix<f64>]) -> Lemma {
    let outside = |b: &DMatrix<f64>| {
        let half = b.nrows() / 2;
        let block = |i: usize, j: usize| b.view((i * half, j * half), (half, half)).into_owned();
        block(0, 1).amax().max(block(1, 0).amax()).max((block(0, 0) + block(1, 1)).amax())
    };
    let size = basis.iter().map(outside).fold(0.0, f64::max);
    let reason = match size <= ROUNDING {
        true => "M is a number".to_owned(),
        false => "(M, N; O, -M^T) with N and O skew".to_owned(),
    };
    lemma("2014, (15): I^A = {diag(M, -M)}", size <= ROUNDING, reason)
}

/// Angles of A = R1 R2 R3 about x, y, z.
fn theorem_6(a: &DMatrix<f64>) -> Lemma {
    let across = libm::hypot(a[(0, 0)], a[(0, 1)]);
    let second = libm::atan2(a[(0, 2)], across);
    let (first, third) = if across > ROUNDING {
        (libm::atan2(-a[(1, 2)], a[(2, 2)]), libm::atan2(-a[(0, 1)], a[(0, 0)]))
    } else {
        (libm::atan2(a[(2, 1)], a[(1, 1)]), 0.0)
    };
    let angles = [first, second, third].map(|angle| significant(angle.to_degrees() + 0.0, 7)).join(", ");
    let reason = format!("R1 R2 R3 with {angles} deg; each factor has its own phi, k, alpha and beta");
    lemma("2014, Theorem 6: A = R1 R2 R3 about x, y, z", true, reason)
}

/// Sine and cosine of a rotation about y with both different from 0.
fn turn_about_y(a: &DMatrix<f64>) -> Option<[f64; 2]> {
    let about = a.nrows() == 3 && (a[(1, 1)] - 1.0).abs() <= ROUNDING;
    about.then(|| [a[(0, 2)], a[(0, 0)]]).filter(|both| both.iter().all(|x| x.abs() > ROUNDING))
}

/// The second matrix of (27), at alpha = 1, beta = 2, k = 3.
fn equation_27(a: &DMatrix<f64>, [sine, cosine]: [f64; 2]) -> Lemma {
    let (alpha, beta, k) = (1.0, 2.0, 3.0);
    let middle = [-alpha * cosine - beta * sine, alpha * sine - beta * cosine];
    let tangent = sine / cosine;
    let rows = [-k * tangent, alpha, -k, middle[0], 0.0, middle[1], k, beta, -k * tangent];
    let printed = DMatrix::from_row_slice(3, 3, &rows);
    let (own, opposite) = (defect(a, &printed), defect(&a.transpose(), &printed));
    let reason = format!(
        "A^T B + B^T A has an entry {}, for the rotation of the opposite sense {}",
        shown(own, 1.0),
        shown(opposite, 1.0)
    );
    lemma("2014, (27): the second matrix is in I^A", own <= ROUNDING, reason)
}
