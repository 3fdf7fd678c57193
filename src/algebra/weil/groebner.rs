//! Ideals with homogeneous binomial relations, such as x1 x2 = x3^2: their reduced Groebner basis up to a degree.
//!
//! The order of monomials is the graded reverse lexicographic one with x1 > x2 > ...: higher degree first, then the
//! one with the lower power of the last generator in which two differ. The relations are homogeneous, so that
//! products of a degree stay there, and Buchberger's algorithm up to degree n is exact in the algebra of degree n.
//! Elements are monomials or binomials, and so are their S-polynomials; coefficients are fractions.

use super::monomials::{Ideal, Monomial};
use std::cmp::Ordering;
use std::collections::VecDeque;

/// A fraction in lowest terms with a positive denominator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fraction {
    numerator: i128,
    denominator: i128,
}

impl Fraction {
    /// 1.
    pub const ONE: Self = Self { numerator: 1, denominator: 1 };

    /// Returns the quotient of two integers; `None` for a zero divisor.
    pub fn new(numerator: i128, denominator: i128) -> Option<Self> {
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs());
        let common = i128::try_from(common).ok().filter(|c| *c > 0 && denominator != 0)?;
        let sign = denominator.signum();
        Some(Self { numerator: sign * (numerator / common), denominator: (denominator / common).checked_abs()? })
    }

    /// Reads an integer, a decimal, or a quotient of these: `2`, `-0.5`, `1/3`.
    pub fn parse(text: &str) -> Option<Self> {
        if let Some((above, below)) = text.split_once('/') {
            return Self::parse(above)?.over(Self::parse(below)?);
        }
        let text = text.trim();
        let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
        let digits = u32::try_from(decimals.len()).ok().filter(|n| *n <= 18)?;
        if !decimals.bytes().all(|b| b.is_ascii_digit()) {
            return None;
        }
        Self::new(format!("{whole}{decimals}").parse().ok()?, 10_i128.checked_pow(digits)?)
    }

    /// The product; `None` beyond the range.
    pub fn times(self, other: Self) -> Option<Self> {
        Self::new(self.numerator.checked_mul(other.numerator)?, self.denominator.checked_mul(other.denominator)?)
    }

    /// The quotient; `None` beyond the range, and by 0.
    pub fn over(self, other: Self) -> Option<Self> {
        self.times(Self::new(other.denominator, other.numerator)?)
    }

    /// Returns the nearest number.
    pub fn value(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// True of 0.
    pub fn is_zero(self) -> bool {
        self.numerator == 0
    }
}

impl std::fmt::Display for Fraction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            below => write!(f, "{}/{below}", self.numerator),
        }
    }
}

fn gcd(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A relation `left = factor right`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binomial {
    /// Left side.
    pub left: Monomial,
    /// Factor of the right side.
    pub factor: Fraction,
    /// Monomial of the right side.
    pub right: Monomial,
}

/// The reason for which an ideal has no basis here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum IdealFailure {
    /// The sides of a relation have different degrees; its index.
    Inhomogeneous(usize),
    /// More elements than [`MAX_ELEMENTS`].
    TooMany,
    /// A coefficient beyond the range of fractions.
    Coefficient,
}

/// Maximum number of elements of a basis.
pub const MAX_ELEMENTS: usize = 2_000;

/// The reduced Groebner basis of a homogeneous ideal of monomials and binomials, up to a degree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GroebnerBasis {
    degree: u8,
    /// Monomials that vanish.
    monomials: Vec<Monomial>,
    /// Binomials, solved for their leading monomial.
    binomials: Vec<Binomial>,
}

impl GroebnerBasis {
    /// Computes the basis of the ideal that an ideal of monomials and relations generate.
    pub fn new(ideal: &Ideal, relations: &[Binomial]) -> Result<Self, IdealFailure> {
        if let Some(k) = relations.iter().position(|r| !r.factor.is_zero() && r.left.degree() != r.right.degree()) {
            return Err(IdealFailure::Inhomogeneous(k));
        }
        let mut basis = Self { degree: ideal.degree, monomials: Vec::new(), binomials: Vec::new() };
        let vanishing = ideal.vanish.iter().map(|m| Element::Monomial(m.clone()));
        let mut queue: VecDeque<Element> = vanishing.chain(relations.iter().cloned().map(Element::Binomial)).collect();
        while let Some(element) = queue.pop_front() {
            let Some(reduced) = basis.reduced_element(element)? else { continue };
            basis.pairs_with(&reduced, &mut queue)?;
            match reduced {
                Element::Monomial(monomial) => basis.monomials.push(monomial),
                Element::Binomial(binomial) => basis.binomials.push(binomial),
            }
            if basis.monomials.len() + basis.binomials.len() + queue.len() > 64 * MAX_ELEMENTS
                || basis.monomials.len() + basis.binomials.len() > MAX_ELEMENTS
            {
                return Err(IdealFailure::TooMany);
            }
        }
        basis.minimal()
    }

    /// Returns the monomial ideal of the leading monomials: what it keeps is a basis of the quotient.
    pub fn initial(&self) -> Ideal {
        let leads = self.binomials.iter().map(|b| &b.left);
        Ideal { degree: self.degree, vanish: self.monomials.iter().chain(leads).cloned().collect() }
    }

    /// Returns the monomials that vanish.
    pub fn monomials(&self) -> &[Monomial] {
        &self.monomials
    }

    /// Returns the binomials, each solved for its leading monomial.
    pub fn binomials(&self) -> &[Binomial] {
        &self.binomials
    }

    /// Returns the normal form of a monomial: a factor and a monomial of the quotient's basis; `None` of what vanishes.
    pub fn normal_form(&self, monomial: &Monomial) -> Option<(f64, Monomial)> {
        self.reduced(monomial.clone()).ok().flatten().map(|term| (term.factor.value(), term.monomial))
    }

    fn reduced(&self, monomial: Monomial) -> Result<Option<Term>, IdealFailure> {
        let mut term = Term { factor: Fraction::ONE, monomial };
        while term.monomial.degree() <= usize::from(self.degree) {
            if self.monomials.iter().any(|m| m.divides(&term.monomial)) {
                return Ok(None);
            }
            let Some(rule) = self.binomials.iter().find(|b| b.left.divides(&term.monomial)) else {
                return Ok(Some(term));
            };
            let factor = term.factor.times(rule.factor).ok_or(IdealFailure::Coefficient)?;
            term = Term { factor, monomial: term.monomial.over(&rule.left).times(&rule.right) };
        }
        Ok(None)
    }

    /// Returns an element in normal form, solved for its leading monomial; `None` if it is 0.
    fn reduced_element(&self, element: Element) -> Result<Option<Element>, IdealFailure> {
        let (left, right) = match element {
            Element::Monomial(monomial) => (self.reduced(monomial)?, None),
            Element::Binomial(b) if b.factor.is_zero() => (self.reduced(b.left)?, None),
            Element::Binomial(b) => {
                let right = self.reduced(b.right)?;
                let scaled = |term: Term| {
                    let factor = term.factor.times(b.factor).ok_or(IdealFailure::Coefficient)?;
                    Ok(Term { factor, ..term })
                };
                (self.reduced(b.left)?, right.map(scaled).transpose()?)
            }
        };
        Ok(match (left, right) {
            (None, None) => None,
            (Some(term), None) | (None, Some(term)) => Some(Element::Monomial(term.monomial)),
            (Some(a), Some(b)) => match compare(&a.monomial, &b.monomial) {
                Ordering::Equal if a.factor == b.factor => None,
                Ordering::Equal => Some(Element::Monomial(a.monomial)),
                Ordering::Greater => Some(Element::Binomial(b.solved_for(a)?)),
                Ordering::Less => Some(Element::Binomial(a.solved_for(b)?)),
            },
        })
    }

    /// Adds the S-polynomials of a new element with all earlier ones.
    fn pairs_with(&self, new: &Element, queue: &mut VecDeque<Element>) -> Result<(), IdealFailure> {
        let fits = |a: &Monomial, b: &Monomial| {
            let lcm = a.lcm(b);
            (lcm.degree() <= usize::from(self.degree) && lcm.degree() < a.degree() + b.degree()).then_some(lcm)
        };
        for old in &self.binomials {
            let Some(lcm) = fits(&old.left, new.lead()) else { continue };
            let of_old = lcm.over(&old.left).times(&old.right);
            queue.push_back(match new {
                Element::Monomial(_) => Element::Monomial(of_old),
                Element::Binomial(new) => Element::Binomial(Binomial {
                    left: of_old,
                    factor: new.factor.over(old.factor).ok_or(IdealFailure::Coefficient)?,
                    right: lcm.over(&new.left).times(&new.right),
                }),
            });
        }
        if let Element::Binomial(new) = new {
            let lcms = self.monomials.iter().filter_map(|old| fits(old, &new.left));
            queue.extend(lcms.map(|lcm| Element::Monomial(lcm.over(&new.left).times(&new.right))));
        }
        Ok(())
    }

    /// Leaves out what others generate, and reduces the right sides: the basis is unique.
    fn minimal(mut self) -> Result<Self, IdealFailure> {
        let leads: Vec<Monomial> = self.initial().vanish;
        let fits = |m: &Monomial| m.degree() <= usize::from(self.degree);
        let is_minimal = |m: &Monomial| fits(m) && !leads.iter().any(|lead| lead != m && lead.divides(m));
        self.monomials.retain(is_minimal);
        self.binomials.retain(|b| is_minimal(&b.left));
        let mut binomials = Vec::new();
        for b in &self.binomials {
            let Some(right) = self.reduced(b.right.clone())? else {
                self.monomials.push(b.left.clone());
                continue;
            };
            let factor = right.factor.times(b.factor).ok_or(IdealFailure::Coefficient)?;
            binomials.push(Binomial { left: b.left.clone(), factor, right: right.monomial });
        }
        self.binomials = binomials;
        self.monomials.sort_by(|a, b| compare(b, a));
        self.binomials.sort_by(|a, b| compare(&b.left, &a.left));
        Ok(self)
    }
}

/// An element of a basis.
enum Element {
    Monomial(Monomial),
    Binomial(Binomial),
}

impl Element {
    fn lead(&self) -> &Monomial {
        match self {
            Self::Monomial(monomial) => monomial,
            Self::Binomial(binomial) => &binomial.left,
        }
    }
}

/// A factor times a monomial.
struct Term {
    factor: Fraction,
    monomial: Monomial,
}

impl Term {
    /// `lead - self` as a relation for the monomial of `lead`.
    fn solved_for(self, lead: Self) -> Result<Binomial, IdealFailure> {
        let factor = self.factor.over(lead.factor).ok_or(IdealFailure::Coefficient)?;
        Ok(Binomial { left: lead.monomial, factor, right: self.monomial })
    }
}

/// The graded reverse lexicographic order with x1 > x2 > ...
fn compare(a: &Monomial, b: &Monomial) -> Ordering {
    let by_degree = a.degree().cmp(&b.degree());
    let generators = a.factors().iter().chain(b.factors()).map(|(generator, _)| *generator);
    let last = generators.filter(|g| a.power(*g) != b.power(*g)).max();
    by_degree.then_with(|| last.map_or(Ordering::Equal, |g| b.power(g).cmp(&a.power(g))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `x1^2 x3` from powers of x1, x2, ...
    fn m(powers: &[u8]) -> Monomial {
        Monomial::new((0..).zip(powers.iter().copied()))
    }

    fn relation(left: &[u8], factor: &str, right: &[u8]) -> Binomial {
        Binomial { left: m(left), factor: Fraction::parse(factor).unwrap(), right: m(right) }
    }

    fn basis(degree: u8, relations: &[Binomial]) -> GroebnerBasis {
        GroebnerBasis::new(&Ideal::above(degree), relations).unwrap()
    }

    #[test]
    fn fractions_are_read_in_lowest_terms() {
        let text = |t: &str| Fraction::parse(t).map(|f| f.to_string());
        assert_eq!(text("0.50").as_deref(), Some("1/2"));
        assert_eq!(text("-2/6").as_deref(), Some("-1/3"));
        assert_eq!((text("1/0"), text("x"), text("1.-5"), text("")), (None, None, None, None));
    }

    /// SymPy 1.14: `groebner([x1*x2 - x3**2, x1*x3 - x2**2], x1, x2, x3, order='grevlex')` is
    /// `[x1**2*x3 - x2*x3**2, x1*x2 - x3**2, x2**2 - x1*x3]`.
    #[test]
    fn the_basis_is_sympys() {
        let found = basis(4, &[relation(&[1, 1, 0], "1", &[0, 0, 2]), relation(&[1, 0, 1], "1", &[0, 2, 0])]);
        let text: Vec<(Monomial, String, Monomial)> =
            found.binomials().iter().map(|b| (b.left.clone(), b.factor.to_string(), b.right.clone())).collect();
        let one = |l: &[u8], r: &[u8]| (m(l), "1".to_owned(), m(r));
        // x2^2 is above x1 x3: the last generator decides.
        assert!(text.contains(&one(&[0, 2, 0], &[1, 0, 1])) && text.contains(&one(&[1, 1, 0], &[0, 0, 2])), "{text:?}");
        assert!(text.contains(&one(&[2, 0, 1], &[0, 1, 2])), "{text:?}");
        assert_eq!(text.len(), 3, "{text:?}");
    }

    #[test]
    fn relations_that_contradict_leave_monomials() {
        let found = basis(3, &[relation(&[2], "1", &[1, 1]), relation(&[2], "2", &[1, 1])]);
        assert_eq!(found.monomials(), [m(&[2]), m(&[1, 1])]);
        assert!(found.binomials().is_empty() && found.normal_form(&m(&[1, 1])).is_none());
    }

    #[test]
    fn sides_of_different_degree_are_refused() {
        let mixed = [relation(&[1], "1", &[0, 2])];
        assert_eq!(GroebnerBasis::new(&Ideal::above(3), &mixed), Err(IdealFailure::Inhomogeneous(0)));
    }
}
