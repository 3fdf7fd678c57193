use super::*;
use crate::algebra::{Dual, Htm, exp_hat, rotation_about};
use nalgebra::Vector3;
use proptest::prelude::*;

fn basis(generators: u16, degree: u8) -> Arc<Basis> {
    Basis::new(generators, Ideal::above(degree)).unwrap()
}

/// Returns the 2014 paper's example (40): generators x1..x4 are 0..3.
fn paper_40() -> Arc<Basis> {
    let square = |g| Monomial::new([(g, 2)]);
    let product = |a, b| Monomial::new([(a, 1), (b, 1)]);
    let vanish = (0..4).map(square).chain([product(2, 1), product(2, 3), product(2, 0)]).collect();
    Basis::new(4, Ideal { degree: 3, vanish }).unwrap()
}

fn element(basis: &Arc<Basis>, coefficients: &[f64]) -> Weil {
    Weil::Element(Arc::clone(basis), coefficients[..basis.monomials().len()].to_vec())
}

fn near(a: &Weil, b: &Weil) -> bool {
    let (Weil::Element(_, a), Weil::Element(_, b)) = (a, b) else { return a == b };
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-11 * b.abs().max(1.0))
}

#[test]
fn the_example_of_2014_has_nine_monomials() {
    let names: Vec<String> = paper_40()
        .monomials()
        .iter()
        .map(|m| m.factors().iter().map(|(g, _)| format!("x{}", g + 1)).collect::<String>())
        .collect();
    assert_eq!(names, ["", "x1", "x2", "x3", "x4", "x1x2", "x1x4", "x2x4", "x1x2x4"]);
}

#[test]
fn dimensions_are_the_binomials() {
    for (generators, degree, dimension, products) in [(6, 2, 28, 91), (21, 2, 253, 946), (6, 4, 210, 1820)] {
        let basis = basis(generators, degree);
        assert_eq!((basis.monomials().len(), basis.products()), (dimension, products));
        let size = Ideal::above(degree).size(generators);
        assert_eq!((size.monomials, size.products), (dimension as f64, products as f64));
    }
}

#[test]
fn what_is_no_algebra_is_refused() {
    assert_eq!(Basis::new(2, Ideal::above(0)), Err(BasisFailure::Degree(0)));
    assert_eq!(Basis::new(2, Ideal::above(16)), Err(BasisFailure::Degree(16)));
    let one = Ideal { degree: 2, vanish: vec![Monomial::new([(0, 0)])] };
    assert_eq!(Basis::new(2, one), Err(BasisFailure::KillsOne));
    let unknown = Ideal { degree: 2, vanish: vec![Monomial::new([(2, 2)])] };
    assert_eq!(Basis::new(2, unknown), Err(BasisFailure::Generator(2)));
    let Err(BasisFailure::Size(size)) = Basis::new(41, Ideal::above(12)) else { panic!("there is no such memory") };
    // C(53, 12) = 266e9 monomials.
    assert!((size.monomials / 266e9 - 1.0).abs() < 0.01 && size.bytes() > 1e13, "{size:?}");
}

#[test]
fn an_ideal_can_make_a_large_algebra_small() {
    let vanish = (0..100).flat_map(|a| (0..=a).map(move |b| Monomial::new([(a, 1), (b, 1)]))).collect();
    assert_eq!(Basis::new(100, Ideal { degree: 12, vanish }).unwrap().monomials().len(), 101);
}

#[test]
fn elements_of_different_algebras_have_no_product() {
    let (a, b) = (Weil::generator(&basis(2, 2), 0, 1.0), Weil::generator(&basis(3, 2), 0, 1.0));
    assert!((a.clone() * b.clone()).real().is_nan() && (a.clone() + b).real().is_nan());
    assert_eq!(a.clone() * Weil::generator(&basis(2, 2), 1, 2.0) * a, Weil::zero());
}

#[test]
fn generators_have_no_reciprocal_and_a_vanishing_one_is_zero() {
    let basis = Basis::new(2, Ideal { degree: 3, vanish: vec![Monomial::new([(1, 1)])] }).unwrap();
    assert!(Weil::generator(&basis, 0, 1.0).recip().is_none());
    assert!(Weil::generator(&basis, 1, 1.0).is_zero());
}

/// Returns a chain of joints with everything the lowering does, one generator for all.
fn chain<S: Algebra>(generator: impl Fn(f64) -> S) -> Vec<S> {
    let joint = |k: f64| {
        let w = [0.3 * k, -0.2, 0.1 * k].map(|x| generator(1e-2 * x));
        let (s, c) = (S::from_real(0.4 * k) + generator(0.01)).sin_cos();
        let linear = exp_hat(&w) * rotation_about(&[0.6, 0.0, 0.8], (s, c));
        Htm { linear, translation: Vector3::new(generator(0.7 * k), S::from_real(300.0 * k), generator(-0.1)) }
    };
    let product = joint(1.0).compose(&joint(2.0)).compose(&joint(-1.5).inverse().unwrap());
    let root = (product.translation[1].clone() * product.translation[1].clone()).sqrt().unwrap();
    let e = product.linear[(0, 1)].clone().exp();
    product.to_matrix().iter().cloned().chain([root, e]).collect()
}

fn agrees_with_the_dual_numbers<const M: usize>() {
    let one = basis(1, (M - 1) as u8);
    let ours = chain(|value| Weil::generator(&one, 0, value));
    let theirs = chain(Dual::<M>::first_order);
    for (ours, theirs) in ours.iter().zip(&theirs) {
        for (k, theirs) in theirs.0.iter().enumerate() {
            let ours = ours.coefficient(&Monomial::new([(0, k as u8)]));
            assert_eq!(ours, *theirs, "degree {k} of order {}", M - 1);
        }
        assert_eq!(ours.nilpotent_sum(), theirs.nilpotent_sum());
    }
}

#[test]
fn one_generator_is_the_dual_numbers_to_the_last_bit() {
    agrees_with_the_dual_numbers::<2>();
    agrees_with_the_dual_numbers::<3>();
    agrees_with_the_dual_numbers::<4>();
    agrees_with_the_dual_numbers::<7>();
}

#[test]
fn mixed_coefficients_are_partial_derivatives() {
    // sin(x + 2 y) at 0.3: coefficient of x y is -sin(0.3) * 2.
    let basis = basis(2, 3);
    let argument = Weil::from_real(0.3) + Weil::generator(&basis, 0, 1.0) + Weil::generator(&basis, 1, 2.0);
    let (sine, _) = argument.sin_cos();
    let mixed = sine.coefficient(&Monomial::new([(0, 1), (1, 1)]));
    assert!((mixed + 2.0 * libm::sin(0.3)).abs() < 1e-15);
    let cubic = sine.coefficient(&Monomial::new([(0, 2), (1, 1)]));
    assert!((cubic + libm::cos(0.3)).abs() < 1e-15);
}

proptest! {
    #[test]
    fn products_obey_the_laws(a in prop::collection::vec(-2.0..2.0_f64, 35),
                               b in prop::collection::vec(-2.0..2.0_f64, 35),
                              c in prop::collection::vec(-2.0..2.0_f64, 35)) {
        for basis in [basis(4, 3), paper_40()] {
            let [a, b, c] = [&a, &b, &c].map(|list| element(&basis, list));
            prop_assert!(near(&(a.clone() * b.clone()), &(b.clone() * a.clone())));
            prop_assert!(near(&((a.clone() * b.clone()) * c.clone()), &(a.clone() * (b.clone() * c.clone()))));
            prop_assert!(near(&(a.clone() * (b.clone() + c.clone())), &(a.clone() * b + a * c)));
        }
    }

    #[test]
    fn reciprocals_and_roots_undo(a in prop::collection::vec(-2.0..2.0_f64, 35)) {
        for basis in [basis(4, 3), paper_40()] {
            let a = element(&basis, &a);
            prop_assume!(a.real() > 0.5);
            let inverse = a.recip().ok_or_else(|| TestCaseError::fail("no inverse"))?;
            let one = Weil::from_real(1.0) + Weil::generator(&basis, 0, 0.0);
            prop_assert!(near(&(a.clone() * inverse), &one));
            let root = a.sqrt().ok_or_else(|| TestCaseError::fail("no root"))?;
            prop_assert!(near(&(root.clone() * root), &a));
        }
    }
}
