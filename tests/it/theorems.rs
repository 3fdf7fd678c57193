//! The theorems and lemmas of the papers of 2014 and 2015 in their corrected form, at random matrices.
//! Where the print is wrong, its form is shown to fail (docs/misprints.md).

use crate::oracle::random::Random;
use abbe::algebra::{Algebra, Dual};
use nalgebra::DMatrix;

type M = DMatrix<f64>;

/// Returns the largest coefficient of each degree of C^T C - 1 of a matrix over D_n.
/// It is a member of O(n, D_n) if all of them are 0, to rounding.
fn orthogonality_defect<const N: usize>(c: &DMatrix<Dual<N>>) -> [f64; N] {
    let product = c.transpose() * c;
    let of_degree = |k: usize| {
        let coefficient = |(index, entry): (usize, &Dual<N>)| {
            let diagonal = k == 0 && index % (c.ncols() + 1) == 0;
            (entry.0[k] - f64::from(u8::from(diagonal))).abs()
        };
        product.iter().enumerate().map(coefficient).fold(0.0, f64::max)
    };
    std::array::from_fn(of_degree)
}

/// True if a matrix of O(n, D_n) is in SO(n, D_n): the real part decides.
fn is_special<const N: usize>(c: &DMatrix<Dual<N>>) -> bool {
    c.map(|entry| entry.real()).determinant() > 0.0
}

/// A^T B + B^T A: zero exactly if B is in the error class I^A of an orthogonal A.
fn admissibility(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let product = a.transpose() * b;
    &product + product.transpose()
}

fn random_matrix(random: &mut Random, n: usize) -> M {
    M::from_fn(n, n, |_, _| random.around(1.0))
}

fn skew(random: &mut Random, n: usize) -> M {
    let m = random_matrix(random, n);
    &m - m.transpose()
}

/// Orthogonal: a product of Householder reflections.
fn orthogonal(random: &mut Random, n: usize) -> M {
    (0..n).fold(M::identity(n, n), |product, _| {
        let v = nalgebra::DVector::from_fn(n, |_, _| random.around(1.0)).normalize();
        product * (M::identity(n, n) - &v * v.transpose() * 2.0)
    })
}

fn dual(a: &M, b: &M) -> DMatrix<Dual<2>> {
    a.zip_map(b, |a, b| Dual([a, b]))
}

fn small(m: &M) -> bool {
    m.amax() < 1e-12
}

fn in_class(a: &M, b: &M) -> bool {
    small(&admissibility(a, b))
}

fn two(phi: f64) -> M {
    let (s, c) = libm::sincos(phi);
    M::from_row_slice(2, 2, &[c, -s, s, c])
}

/// The rotation about x (0), y (1) or z (2).
fn about(axis: usize, phi: f64) -> M {
    let (s, c) = libm::sincos(phi);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = M::identity(3, 3);
    (m[(i, i)], m[(j, j)], m[(i, j)], m[(j, i)]) = (c, c, -s, s);
    m
}

fn hat(w: [f64; 3]) -> M {
    let [x, y, z] = w;
    M::from_row_slice(3, 3, &[0.0, -z, y, z, 0.0, -x, -y, x, 0.0])
}

fn each(test: impl Fn(&mut Random)) {
    let mut random = Random::new(77);
    (0..50).for_each(|_| test(&mut random));
}

#[test]
fn theorem_1_of_2014_members_are_orthogonal_with_skew_product() {
    each(|random| {
        for n in 2..=5 {
            let a = orthogonal(random, n);
            let member = dual(&a, &(&a * skew(random, n)));
            assert!(orthogonality_defect(&member).iter().all(|d| *d < 1e-12));
            let b = random_matrix(random, n);
            let [real, first] = orthogonality_defect(&dual(&a, &b));
            assert!(real < 1e-12 && (first - admissibility(&a, &b).amax()).abs() < 1e-12 && first > 1e-3);
            let [real, _] = orthogonality_defect(&dual(&b, &a));
            assert!(real > 1e-3);
        }
    });
}

#[test]
fn the_group_is_closed_and_special_members_have_a_proper_real_part() {
    each(|random| {
        let member = |random: &mut Random| {
            let a = orthogonal(random, 3);
            let b = &a * skew(random, 3);
            (a.determinant() > 0.0, dual(&a, &b))
        };
        let ((proper_a, a), (proper_b, b)) = (member(random), member(random));
        let product = &a * &b;
        assert!(orthogonality_defect(&product).iter().all(|d| *d < 1e-12));
        assert!(orthogonality_defect(&a.transpose()).iter().all(|d| *d < 1e-12));
        assert_eq!((is_special(&a), is_special(&product)), (proper_a, proper_a == proper_b));
    });
}

/// Printed: A^T B + A B^T = 0.
#[test]
fn definition_2_of_2014_needs_b_transposed_a() {
    each(|random| {
        let a = orthogonal(random, 3);
        let b = &a * skew(random, 3);
        assert!(in_class(&a, &b));
        assert!(!small(&(a.transpose() * &b + &a * b.transpose())));
    });
}

#[test]
fn lemma_3_of_2014_holds_from_three_dimensions_on() {
    each(|random| {
        for n in 2..=4 {
            let commutator = |a: &M, random: &mut Random| {
                let (f, g) = (a * skew(random, n), a * skew(random, n));
                &f * &g - &g * &f
            };
            let q = orthogonal(random, n);
            let signs = M::from_diagonal(&nalgebra::DVector::from_fn(n, |i, _| if i % 2 == 0 { 1.0 } else { -1.0 }));
            let symmetric = q.transpose() * signs * &q;
            assert!(in_class(&symmetric, &commutator(&symmetric, random)));
            let turned = orthogonal(random, n);
            if (&turned - turned.transpose()).amax() < 0.1 {
                continue;
            }
            // In the plane the class is a line: commutators vanish whatever A is.
            let c = commutator(&turned, random);
            assert_eq!(in_class(&turned, &c), n == 2, "{n} {turned} {c}");
        }
    });
}

#[test]
fn lemma_4_of_2014_is_singular_at_a_quarter_turn_and_the_form_of_2015_is_not() {
    each(|random| {
        let (phi, k) = (random.around(3.0), random.around(1.0));
        let t = libm::tan(phi);
        let printed = M::from_row_slice(2, 2, &[-k * t, -k, k, -k * t]);
        let scale = 1.0 + printed.amax();
        assert!(in_class(&two(phi), &(printed / scale)));
        let derivative = |phi: f64| two(phi + std::f64::consts::FRAC_PI_2) * k;
        assert!(in_class(&two(phi), &derivative(phi)));
        // k of 2014 is the angular error times cos phi.
        let same = M::from_row_slice(2, 2, &[-t, -1.0, 1.0, -t]) * (k * libm::cos(phi));
        assert!((same - derivative(phi)).amax() < 1e-12);
    });
    // At 90 deg the class is spanned by a diagonal matrix: -k and k beside it are not admissible.
    let quarter = M::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0]);
    assert!(in_class(&quarter, &M::from_row_slice(2, 2, &[-1.0, 0.0, 0.0, -1.0])));
    assert!(!in_class(&quarter, &M::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0])));
}

#[test]
fn the_error_class_of_the_block_exchange_of_2014() {
    each(|random| {
        let n = 3;
        let mut exchange = M::zeros(2 * n, 2 * n);
        (0..n).for_each(|i| (exchange[(i, i + n)], exchange[(i + n, i)]) = (1.0, 1.0));
        let (m, s, o) = (random_matrix(random, n), skew(random, n), skew(random, n));
        let block = |a: &M, b: &M, c: &M, d: &M| {
            M::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
                (true, true) => a[(i, j)],
                (true, false) => b[(i, j - n)],
                (false, true) => c[(i - n, j)],
                (false, false) => d[(i - n, j - n)],
            })
        };
        assert!(in_class(&exchange, &block(&m, &s, &o, &-m.transpose())));
        let zero = M::zeros(n, n);
        // Printed: diag(M, -M); only for symmetric M.
        assert!(!in_class(&exchange, &block(&m, &zero, &zero, &-&m)));
        let symmetric = &m + m.transpose();
        assert!(in_class(&exchange, &block(&symmetric, &zero, &zero, &-&symmetric)));
    });
}

#[test]
fn lemma_5_of_2014_classes_multiply_and_every_member_is_such_a_product() {
    each(|random| {
        let (a, b) = (orthogonal(random, 3), orthogonal(random, 3));
        let (of_a, of_b) = (&a * skew(random, 3), &b * skew(random, 3));
        assert!(in_class(&(&a * &b), &(&a * &of_b + &of_a * &b)));
        let c = &a * &b * skew(random, 3);
        let rest = a.transpose() * (&c - &of_a * &b);
        assert!(in_class(&b, &rest));
        assert!(small(&(&a * rest + of_a * b - c)));
    });
}

/// Theorem 6 prints one phi for three factors: a curve, which misses the turn by 0.7 about x alone.
#[test]
fn theorem_6_of_2014_needs_an_angle_for_each_factor() {
    let turn = about(0, 0.7);
    let gap = |[a, b, c]: [f64; 3]| (about(0, a) * about(1, b) * about(2, c) - &turn).amax();
    let nearest = (0..3600).map(|i| gap([f64::from(i).to_radians() / 10.0; 3])).fold(f64::INFINITY, f64::min);
    assert!(nearest > 0.1 && gap([0.7, 0.0, 0.0]) < 1e-15, "{nearest}");
}

/// I^{R_i} as printed in (27), with the parameters of one factor.
fn printed_27(axis: usize, phi: f64, [k, alpha, beta]: [f64; 3]) -> M {
    let (s, c) = libm::sincos(phi);
    let t = k * s / c;
    let (p, q) = (-alpha * c - beta * s, alpha * s - beta * c);
    let rows: [[f64; 9]; 3] = [
        [0.0, p, q, alpha, -t, -k, beta, k, -t],
        [-t, alpha, -k, p, 0.0, q, k, beta, -t],
        [-t, -k, alpha, k, -t, beta, p, q, 0.0],
    ];
    M::from_row_slice(3, 3, &rows[axis])
}

#[test]
fn theorem_6_of_2014_with_hat_w_times_r_for_each_factor() {
    each(|random| {
        let phi = [0, 1, 2].map(|_| random.around(1.2));
        let r = [0, 1, 2].map(|axis| about(axis, phi[axis]));
        let class = |axis: usize, random: &mut Random| hat(random.vector(1.0)) * &r[axis];
        let i = [0, 1, 2].map(|axis| class(axis, random));
        let a = &r[0] * &r[1] * &r[2];
        let b = &r[0] * &r[1] * &i[2] + &r[0] * &i[1] * &r[2] + &i[0] * &r[1] * &r[2];
        assert!(in_class(&a, &b) && is_special(&dual(&a, &b)));
        // Every element of the class is reached, already with the first factor.
        let wanted = &a * skew(random, 3);
        let first = &wanted * (&r[1] * &r[2]).transpose();
        assert!(in_class(&r[0], &first) && small(&(first * &r[1] * &r[2] - wanted)));
    });
}

#[test]
fn of_27_of_2014_the_second_matrix_is_for_the_opposite_sense() {
    each(|random| {
        let (phi, parameters) = (0.3 + random.unit(), random.vector(1.0));
        assert!(in_class(&about(0, phi), &printed_27(0, phi, parameters)));
        assert!(!in_class(&about(1, phi), &printed_27(1, phi, parameters)));
        assert!(in_class(&about(1, -phi), &printed_27(1, phi, parameters)));
        // In I^{R1} beta = -eps_y and k = eps_x cos phi.
        let [k, alpha, beta] = parameters;
        let w = [k / libm::cos(phi), -beta, alpha];
        assert!((hat(w) * about(0, phi) - printed_27(0, phi, parameters)).amax() < 1e-12);
    });
}

/// (27), third matrix: rows and columns in the order of the print.
#[test]
fn of_27_of_2014_the_third_matrix_is_admissible() {
    each(|random| {
        let phi = 0.3 + random.unit();
        assert!(in_class(&about(2, phi), &printed_27(2, phi, random.vector(1.0))));
    });
}

/// A rotation of the plane by an angle over D_2.
fn plane(angle: Dual<3>) -> DMatrix<Dual<3>> {
    let (s, c) = angle.sin_cos();
    DMatrix::from_row_slice(2, 2, &[c, -s, s, c])
}

#[test]
fn the_theorems_of_2015_on_the_plane() {
    each(|random| {
        let (phi, k, m) = (random.around(3.0), random.around(1.0), random.around(1.0));
        let (s, c) = libm::sincos(phi);
        // SO(2, D): B = k dR/dphi.
        let first = dual(&two(phi), &M::from_row_slice(2, 2, &[-k * s, -k * c, k * c, -k * s]));
        assert!(orthogonality_defect(&first).iter().all(|d| *d < 1e-12));
        // SO(2, D_2): the printed C belongs to the angle phi + k i, ...
        let member = plane(Dual([phi, k, 0.0]));
        assert!(orthogonality_defect(&member).iter().all(|d| *d < 1e-12));
        assert!((member[(0, 0)].0[2] + k * k / 2.0 * c).abs() < 1e-12);
        assert!((member[(0, 1)].0[2] - k * k / 2.0 * s).abs() < 1e-12);
        // ... and a further m dR/dphi is possible: the angle phi + k i + m i^2.
        let general = plane(Dual([phi, k, m]));
        assert!(orthogonality_defect(&general).iter().all(|d| *d < 1e-12));
        assert!((general[(1, 0)].0[2] - (member[(1, 0)].0[2] + m * c)).abs() < 1e-12);
    });
}

#[test]
fn dual_numbers_have_zero_divisors_and_divide_where_the_real_part_is_not_zero() {
    let i = Dual::<2>::first_order(1.0);
    assert_eq!(i * i, Dual([0.0, 0.0]));
    assert!(i.recip().is_none() && (i + Dual::from_real(2.0)).recip().is_some());
    // Over P = R x R: (1 + j)(1 - j) = 0 with j^2 = 1, and neither is nilpotent: P is not local.
    let product = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] + a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
    assert_eq!(product([1.0, 1.0], [1.0, -1.0]), [0.0, 0.0]);
    assert_eq!(product([1.0, 1.0], [1.0, 1.0]), [2.0, 2.0]);
}

/// The 3x3 blocks of (2): printed and corrected, at theta with errors as large as i.
#[test]
fn the_matrices_2_of_2014() {
    each(|random| {
        let ([alpha, beta, gamma], theta) = (random.vector(1.0), random.around(1.2));
        let (s, c) = libm::sincos(theta);
        // Left: the printed signs of gamma are those of the opposite rotation about x.
        let printed = hat([-gamma, beta, alpha]);
        assert!(in_class(&M::identity(3, 3), &printed) && printed[(2, 1)] == -gamma);
        assert_eq!(hat([gamma, beta, alpha])[(2, 1)], gamma);
        // Right: (3,1) must be +beta for the row above.
        let with = |corner: f64| {
            let rows = [
                [0.0, -alpha * c - beta * s, alpha * s - beta * c],
                [alpha, -gamma * s, -gamma * c],
                [corner, gamma * c, -gamma * s],
            ];
            M::from_row_slice(3, 3, &rows.concat())
        };
        assert!(in_class(&about(0, theta), &with(beta)));
        assert!(!in_class(&about(0, theta), &with(-beta)));
    });
}

/// (35): T_2's (2,3) is printed sin(phi) - k i; (39): a must be 0.
#[test]
fn the_matrices_35_and_39_of_2014() {
    each(|random| {
        let (phi, k) = (0.2 + random.unit(), random.around(1.0));
        let (s, c) = libm::sincos(phi);
        let t = k * s / c;
        let with = |sine: f64, a: f64| {
            let real = M::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, c, sine, 0.0, s, c]);
            let part = M::from_row_slice(3, 3, &[a, 0.0, 0.0, 0.0, -t, -k, 0.0, k, -t]);
            orthogonality_defect(&dual(&real, &part))
        };
        assert!(with(-s, 0.0).iter().all(|d| *d < 1e-12));
        assert!(with(s, 0.0)[0] > 1e-3);
        assert!(with(-s, 0.5)[1] > 0.9);
    });
}

/// Over the dual numbers, 4 by 4: a real motion and its errors.
fn affine(linear: [[Dual<2>; 3]; 3], column: [Dual<2>; 3]) -> DMatrix<Dual<2>> {
    DMatrix::from_fn(4, 4, |i, j| match (i, j) {
        (3, 3) => Dual([1.0, 0.0]),
        (3, _) => Dual([0.0, 0.0]),
        (_, 3) => column[i],
        _ => linear[i][j],
    })
}

fn i(value: f64) -> Dual<2> {
    Dual([0.0, value])
}

fn real(value: f64) -> Dual<2> {
    Dual([value, 0.0])
}

/// Entries in which two matrices differ, as (row, column) from 1.
fn unlike(a: &DMatrix<Dual<2>>, b: &DMatrix<Dual<2>>) -> Vec<(usize, usize)> {
    let far = |(k, l): &(usize, usize)| (0..2).any(|d| (a[(*k, *l)].0[d] - b[(*k, *l)].0[d]).abs() > 1e-9);
    let all = (0..4).flat_map(|k| (0..4).map(move |l| (k, l)));
    all.filter(far).map(|(k, l)| (k + 1, l + 1)).collect()
}

/// (5) is the product of two factors E N as in (4); the signs of gamma as in (4) or the usual ones.
#[test]
fn the_product_5_of_2014_as_printed_and_corrected() {
    each(|random| {
        let [[a1, b1, g1], [a2, b2, g2], [x1, y1, z1], [x2, y2, z2]] = [0; 4].map(|_| random.vector(1.0));
        let [x, y, _] = random.vector(300.0);
        let factor = |[a, b, g]: [f64; 3], d: [f64; 3], way: [f64; 3], sign: f64| {
            let one = real(1.0);
            let error = affine([[one, i(-a), i(b)], [i(a), one, i(-sign * g)], [i(-b), i(sign * g), one]], d.map(i));
            let none = real(0.0);
            error * affine([[one, none, none], [none, one, none], [none, none, one]], way.map(real))
        };
        let product = |sign| {
            factor([a1, b1, g1], [x1, y1, z1], [x, 0.0, 0.0], sign)
                * factor([a2, b2, g2], [x2, y2, z2], [0.0, y, 0.0], sign)
        };
        let with = |sign: f64, first: f64, third: f64| {
            let (a, b, g) = (i(a1 + a2), i(b1 + b2), i(sign * (g1 + g2)));
            let block = [[real(1.0), -a, b], [a, real(1.0), -g], [-b, g, real(1.0)]];
            affine(block, [Dual([x, first]), Dual([y, y1 + y2 + a1 * x]), i(third)])
        };
        let corrected = with(1.0, x1 + x2 - (a1 + a2) * y, z1 + z2 - b1 * x + (g1 + g2) * y);
        assert!(unlike(&product(1.0), &corrected).is_empty());
        // Printed: the block with gamma reversed, and terms missing in the last column.
        let printed = with(-1.0, x1 - a2 * y, z1 + z2 - b1 * x + g2 * y);
        assert_eq!(unlike(&product(1.0), &printed), [(1, 4), (2, 3), (3, 2), (3, 4)]);
        // Its block is that of (4), its last column is not: no one sign of gamma makes both right.
        assert_eq!(unlike(&product(-1.0), &printed), [(1, 4), (3, 4)]);
    });
}

/// (36) is the product of the factors of (35), T_1 with its travel y.
#[test]
fn the_product_36_of_2014_as_printed_and_corrected() {
    each(|random| {
        let [[a1, b1, g1], [a2, b2, k], [x1, y1, z1], [x2, y2, z2]] = [0; 4].map(|_| random.vector(1.0));
        let (phi, y) = (0.3 + random.unit(), random.around(300.0));
        let (s, c) = libm::sincos(phi);
        let t = s / c;
        let one = real(1.0);
        let linear =
            affine([[one, i(-a1), i(-b1)], [i(a1), one, i(-g1)], [i(b1), i(g1), one]], [i(x1), Dual([y, y1]), i(z1)]);
        let turn = [
            [one, i(-a2 * c - b2 * s), i(a2 * s - b2 * c)],
            [i(a2), Dual([c, -k * t]), Dual([-s, -k])],
            [i(b2), Dual([s, k]), Dual([c, -k * t])],
        ];
        let product = linear * affine(turn, [i(x2), i(y2), i(z2)]);
        let (a, b, column) = (a1 + a2, b1 + b2, [i(x1 + x2), Dual([y, y1 + y2]), i(z1 + z2)]);
        let corrected = [
            [one, i(-(a * c + b * s)), i(a * s - b * c)],
            [i(a), Dual([c, -(k * t + g1 * s)]), Dual([-s, -(k + g1 * c)])],
            [i(b), Dual([s, k + g1 * c]), Dual([c, -(k * t + g1 * s)])],
        ];
        assert!(unlike(&product, &affine(corrected, column)).is_empty());
        let printed = [
            [i(0.0), i(-(a * c + b * s)), i(-s * (a1 - a2) - c * b)],
            [i(a), Dual([c, -k * t + g1 * s]), Dual([s, -k - g1 * c])],
            [i(b), Dual([s, k + g1 * s]), Dual([c, k * t + g1 * c])],
        ];
        let wrong = unlike(&product, &affine(printed, column));
        assert_eq!(wrong, [(1, 1), (1, 3), (2, 2), (2, 3), (3, 2), (3, 3)]);
    });
}

/// (37): the ideal must name all k generators. (38) and Definition 7: the constant is missing, and y^2 is printed x^2.
#[test]
fn the_algebras_37_and_38_of_2014() {
    use abbe::algebra::weil::{Basis, Ideal, Monomial, Weil};
    // <x1>^3 leaves every power of x2: of infinite dimension, no Weil algebra. <x1, x2>^3 does not.
    let power = |generator, power| Monomial::new([(generator, power)]);
    let printed = Ideal { degree: u8::MAX, vanish: vec![power(0, 3)] };
    assert!((1..=200).all(|p| printed.keeps(&power(1, p))) && !Ideal::above(2).keeps(&power(1, 3)));
    // D_2^2 has 1 and y^2; its quotient by xy is 1, x, y, x^2, y^2.
    let (x, y) = (Monomial::new([(0, 1)]), Monomial::new([(1, 1)]));
    let all = Basis::new(2, Ideal::above(2)).unwrap();
    let expected = [Monomial::default(), x.clone(), y.clone(), x.times(&x), x.times(&y), y.times(&y)];
    assert_eq!(all.monomials(), expected);
    let quotient = Basis::new(2, Ideal { degree: 2, vanish: vec![x.times(&y)] }).unwrap();
    assert_eq!(quotient.monomials(), [Monomial::default(), x.clone(), y.clone(), x.times(&x), y.times(&y)]);
    // Without the constant there is no unit: e x = x fails for every printed e.
    each(|random| {
        let of = |list: [f64; 5]| Weil::Element(quotient.clone(), list.to_vec());
        let e = of([0.0, random.around(9.0), random.around(9.0), random.around(9.0), random.around(9.0)]);
        let x1 = Weil::generator(&quotient, 0, 1.0);
        assert_eq!((e * x1.clone()).coefficient(&x), 0.0);
        assert_eq!((of([1.0, 0.0, 0.0, 0.0, 0.0]) * x1).coefficient(&x), 1.0);
        // y^2 is there, and is not x^2.
        let y1 = Weil::generator(&quotient, 1, 1.0);
        assert_eq!((y1.clone() * y1).coefficient(&y.times(&y)), 1.0);
    });
}

/// KIMM (2): gamma about r of an axis along d bears the letter of the third direction; the labels of T_Cr do not.
#[test]
fn the_labels_of_the_five_axis_paper() {
    // (matrix, direction of the axis, entry above the diagonal, letter of its label), as printed.
    let printed = [
        ("X", 0, (0, 1), 'y'),
        ("X", 0, (0, 2), 'z'),
        ("A", 0, (0, 1), 'y'),
        ("A", 0, (0, 2), 'z'),
        ("Y", 1, (0, 1), 'x'),
        ("Y", 1, (1, 2), 'z'),
        ("B", 1, (0, 1), 'x'),
        ("B", 1, (1, 2), 'z'),
        ("Z", 2, (0, 2), 'x'),
        ("Z", 2, (1, 2), 'y'),
        ("C", 2, (0, 2), 'y'),
        ("C", 2, (1, 2), 'z'),
    ];
    // The rotation that moves an entry: found from the matrices themselves.
    let about =
        |entry: (usize, usize)| (0..3).find(|r| hat([0, 1, 2].map(|k| f64::from(u8::from(k == *r))))[entry] != 0.0);
    let right = |d: usize, entry: (usize, usize)| (0..3).find(|k| *k != d && Some(*k) != about(entry));
    let pattern = |d, entry| right(d, entry).map(|k| ['x', 'y', 'z'][k]);
    let wrong: Vec<_> = printed.iter().filter(|(_, d, entry, label)| pattern(*d, *entry) != Some(*label)).collect();
    assert_eq!(
        wrong.iter().map(|(name, _, entry, _)| (*name, *entry)).collect::<Vec<_>>(),
        [("C", (0, 2)), ("C", (1, 2))]
    );
    // Corrected: gamma_xC about y, gamma_yC about x.
    assert_eq!((pattern(2, (0, 2)), pattern(2, (1, 2))), (Some('x'), Some('y')));
    assert_eq!((about((0, 2)), about((1, 2))), (Some(1), Some(0)));
}

/// "The actual interference of three errors for the term to be neglected" after (39) is one of four.
#[test]
fn in_d_4_3_products_of_four_vanish_and_of_three_do_not() {
    use abbe::algebra::weil::{Basis, Ideal, Monomial};
    let basis = Basis::new(4, Ideal::above(3)).unwrap();
    let product = |count: u16| Monomial::new((0..count).map(|k| (k, 1)));
    assert!(basis.position(&product(3)).is_some() && basis.position(&product(4)).is_none());
}
