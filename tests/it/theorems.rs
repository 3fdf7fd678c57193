//! The theorems and lemmas of the papers of 2014 and 2015 in their corrected form, at random matrices.
//! Where the print is wrong, its form is shown to fail (docs/misprints.md).

use crate::oracle::random::Random;
use abbe::algebra::{Algebra, Dual, admissibility, is_special, orthogonality_defect};
use nalgebra::DMatrix;

type M = DMatrix<f64>;

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

/// KIMM (2), T_Cr: the entry beside y is a rotation about y.
#[test]
fn the_labels_of_the_five_axis_paper() {
    let about_y = hat([0.0, 1.0, 0.0]);
    let about_x = hat([1.0, 0.0, 0.0]);
    assert_eq!((about_y[(0, 2)], about_y[(2, 0)]), (1.0, -1.0));
    assert_eq!((about_x[(1, 2)], about_x[(2, 1)]), (-1.0, 1.0));
}
