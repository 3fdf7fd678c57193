use super::*;
use crate::algebra::weil::Ideal;
use crate::algebra::{Dual, Htm, exp_hat, rotation_about};
use nalgebra::Vector3;

/// Symbols: 0, 1, 2 errors; 3 a position; 4, 5 sine and cosine.
fn rules(degree: u8) -> Arc<Rules> {
    let error = |generator| SymbolKind::Nilpotent { generator };
    let symbols =
        vec![error(0), error(1), error(2), SymbolKind::Real, SymbolKind::Sine { cosine: 5 }, SymbolKind::Real];
    Arc::new(Rules::new(symbols, Ideal::above(degree)))
}

fn all(rules: &Arc<Rules>) -> [Symbolic; 6] {
    std::array::from_fn(|k| Symbolic::symbol(rules, k as u16))
}

fn chain<S: Algebra>([a, b, c, x, sine, cosine]: [S; 6]) -> Htm<S> {
    let rotation = rotation_about(&[0.6, 0.0, 0.8], (sine, cosine));
    let first = Htm { linear: exp_hat(&[a.clone(), b, c.clone()]), translation: Vector3::new(c, a, x.clone()) };
    let second = Htm { linear: rotation, translation: Vector3::new(x, S::from_real(7.0), S::zero()) };
    first.compose(&second).compose(&first.inverse().unwrap_or_else(Htm::identity))
}

impl Symbolic {
    /// Returns the number of terms.
    fn len(&self) -> usize {
        self.terms.len()
    }
}

#[test]
fn sine_and_cosine_lie_on_the_circle() {
    let [.., s, c] = all(&rules(1));
    assert_eq!(s.clone() * s.clone() + c.clone() * c.clone(), Symbolic::one());
    let cube = s.clone() * s.clone() * s.clone();
    assert_eq!(cube, s.clone() - s * c.clone() * c);
}

#[test]
fn the_inverse_of_a_rotation_needs_no_division() {
    let rules = rules(2);
    let [.., s, c] = all(&rules);
    let r = rotation_about(&[0.0, 0.6, 0.8], (s, c));
    let inverse = Htm { linear: r.clone(), ..Htm::identity() }.inverse().unwrap();
    for (ours, transposed) in inverse.linear.iter().zip(r.transpose().iter()) {
        let gap = ours.clone() - transposed.clone();
        assert!(gap.terms().all(|(_, c)| c.abs() < 1e-15), "{gap:?}");
    }
}

#[test]
fn symbols_that_are_not_small_cannot_be_lifted() {
    let [a, _, _, x, ..] = all(&rules(2));
    assert!(x.real().is_nan() && (x.clone() + a).recip().is_none());
    assert!(!x.exp().is_polynomial());
}

#[test]
fn degrees_are_kept_and_taken_apart() {
    let [a, b, _, x, ..] = all(&rules(2));
    let p = (a.clone() + x.clone()) * (b.clone() + x) * (a + b);
    assert_eq!((p.len(), p.part(0).len(), p.part(1).len(), p.part(2).len()), (5, 0, 2, 3));
}

#[test]
fn products_beyond_the_limit_are_no_numbers() {
    let limited = |max| {
        let symbols =
            vec![SymbolKind::Nilpotent { generator: 0 }, SymbolKind::Real, SymbolKind::Nilpotent { generator: 1 }];
        let rules = Arc::new(Rules::new(symbols, Ideal::above(2)).within(max));
        let [a, x, b] = [0, 1, 2].map(|k| Symbolic::symbol(&rules, k));
        let product = (a.clone() * b.clone() + a.clone() + x.clone()) * (a + b + x + Symbolic::one());
        (product.is_polynomial(), product.len(), rules.is_exhausted())
    };
    // One of `a b`, ten of the twelve: `a b a` and `a b b` are above degree 2. a x and a b come twice.
    assert_eq!((limited(11), limited(10).0, limited(10).2), ((true, 8, false), false, true));
}

#[test]
fn the_ideal_is_one_of_the_generators() {
    let one = SymbolKind::Nilpotent { generator: 0 };
    let ideal = Ideal { degree: 3, vanish: vec![Monomial::new([(0, 2)])] };
    let rules = Arc::new(Rules::new(vec![one, one, SymbolKind::Nilpotent { generator: 1 }], ideal));
    let [a, b, c] = [0, 1, 2].map(|k| Symbolic::symbol(&rules, k));
    assert!((a.clone() * b).is_empty());
    assert_eq!((a * c).len(), 1);
}

#[test]
fn a_chain_evaluates_to_the_dual_numbers() {
    let symbolic = chain(all(&rules(3)));
    let (s, c) = libm::sincos(0.7);
    let small = [0.3, -0.2, 0.5];
    let number = |k: u16| match k {
        0..=2 => Dual::<4>::first_order(small[usize::from(k)]),
        _ => Dual::from_real([31.0, s, c][usize::from(k) - 3]),
    };
    let dual = chain(std::array::from_fn(|k| number(k as u16)));
    for (ours, theirs) in symbolic.to_matrix().iter().zip(dual.to_matrix().iter()) {
        let ours = ours.evaluate(number);
        assert!(
            ours.0.iter().zip(theirs.0).all(|(a, b)| (a - b).abs() < 1e-12 * b.abs().max(1.0)),
            "{ours:?} {theirs:?}"
        );
    }
}
