//! 4x4 matrices: products, numeric inverses and exponentials, with no knowledge of rotations.

/// A vector of three components.
pub type V3 = [f64; 3];
/// Six components: a translation, then a rotation vector (X Y Z A B C).
pub type V6 = [f64; 6];
/// A square matrix of four rows.
pub type M4 = [[f64; 4]; 4];

/// The identity.
pub const ONE: M4 = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// The product of two matrices.
pub fn mul(a: &M4, b: &M4) -> M4 {
    std::array::from_fn(|r| std::array::from_fn(|c| (0..4).map(|k| a[r][k] * b[k][c]).sum()))
}

/// The product of a chain of matrices, from left to right.
pub fn product(factors: &[M4]) -> M4 {
    factors.iter().fold(ONE, |done, factor| mul(&done, factor))
}

/// `a + s b`.
pub fn combine(a: &M4, s: f64, b: &M4) -> M4 {
    std::array::from_fn(|r| std::array::from_fn(|c| a[r][c] + s * b[r][c]))
}

/// A point moved by a matrix.
pub fn apply(a: &M4, point: V3) -> V3 {
    std::array::from_fn(|r| a[r][3] + turn(a, point)[r])
}

/// A vector turned by the upper left block of a matrix.
pub fn turn(a: &M4, vector: V3) -> V3 {
    std::array::from_fn(|r| (0..3).map(|c| a[r][c] * vector[c]).sum())
}

/// The transpose of the upper left block.
pub fn transposed(a: &M4) -> M4 {
    std::array::from_fn(|r| std::array::from_fn(|c| if r < 3 && c < 3 { a[c][r] } else { ONE[r][c] }))
}

/// The translation by a vector.
pub fn translation(v: V3) -> M4 {
    combine(&ONE, 1.0, &twist([v[0], v[1], v[2], 0.0, 0.0, 0.0]))
}

/// The generator of a screw: `hat(w)` beside the translation.
pub fn twist([x, y, z, a, b, c]: V6) -> M4 {
    [[0.0, -c, b, x], [c, 0.0, -a, y], [-b, a, 0.0, z], [0.0; 4]]
}

/// The exponential of a generator: a Taylor series of the halved generator, squared as often as it was halved.
pub fn exp(generator: &M4) -> M4 {
    // Only the rotation decides how fast the series converges, for the translation enters linearly.
    let size = (0..3).map(|r| (0..3).map(|c| generator[r][c].abs()).sum::<f64>()).fold(0.0, f64::max);
    let halvings = if size > 1.0 { size.log2().ceil() as i32 } else { 0 };
    let small = combine(&[[0.0; 4]; 4], 0.5_f64.powi(halvings), generator);
    let (mut sum, mut term) = (ONE, ONE);
    for k in 1..=24 {
        term = combine(&[[0.0; 4]; 4], 1.0 / f64::from(k), &mul(&term, &small));
        sum = combine(&sum, 1.0, &term);
    }
    (0..halvings).fold(sum, |root, _| mul(&root, &root))
}

/// The inverse, by Gauss-Jordan elimination with row pivoting.
pub fn inverse(a: &M4) -> M4 {
    let (mut left, mut right) = (*a, ONE);
    for column in 0..4 {
        let pivot = (column..4).max_by(|&i, &j| left[i][column].abs().total_cmp(&left[j][column].abs())).unwrap();
        left.swap(column, pivot);
        right.swap(column, pivot);
        let scale = left[column][column];
        assert!(scale != 0.0, "singular matrix {a:?}");
        left[column] = left[column].map(|v| v / scale);
        right[column] = right[column].map(|v| v / scale);
        for row in (0..4).filter(|&row| row != column) {
            let factor = left[row][column];
            for k in 0..4 {
                left[row][k] -= factor * left[column][k];
                right[row][k] -= factor * right[column][k];
            }
        }
    }
    right
}

/// The length of a vector.
pub fn norm(v: V3) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The cross product.
pub fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - b`.
pub fn minus(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] - b[i])
}

/// `a + b`.
pub fn plus(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Rotation about X, Y or Z (0, 1, 2) as the textbooks print it.
pub fn elementary(axis: usize, angle: f64) -> M4 {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = ONE;
    m[i][i] = angle.cos();
    m[j][j] = angle.cos();
    m[i][j] = -angle.sin();
    m[j][i] = angle.sin();
    m
}

/// The largest difference between two matrices.
#[cfg(test)]
fn distance(a: &M4, b: &M4) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn the_exponential_is_the_textbook_rotation() {
    for (axis, angle) in [(0, 0.3), (1, -2.9), (2, 6.1), (2, std::f64::consts::PI)] {
        let mut screw = [0.0; 6];
        screw[3 + axis] = angle;
        // Three squarings of an error of one rounding.
        assert!(distance(&exp(&twist(screw)), &elementary(axis, angle)) < 8.0 * 2.0 * f64::EPSILON);
    }
}

#[test]
fn the_exponential_turns_about_a_line() {
    // About the line along Z through (100, 0, 0): the origin goes to (100, -100, 0) by -270 and to (200, 0, 0) by 180 deg.
    let screw = [0.0, -100.0, 0.0, 0.0, 0.0, 1.0].map(|c| c * std::f64::consts::PI);
    let moved = apply(&exp(&twist(screw)), [0.0; 3]);
    assert!(norm(minus(moved, [200.0, 0.0, 0.0])) < 1e-12, "{moved:?}");
}

#[test]
fn the_inverse_undoes_any_regular_matrix() {
    let a = [[0.0, 2.0, -1.0, 5.0], [1.0, 0.1, 3.0, -7.0], [4.0, 1.0, 0.0, 2.0], [0.0, 0.0, 0.0, 1.0]];
    assert!(distance(&mul(&a, &inverse(&a)), &ONE) < 8.0 * f64::EPSILON);
    assert!(distance(&mul(&inverse(&a), &a), &ONE) < 8.0 * f64::EPSILON);
}
