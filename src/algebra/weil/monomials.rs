//! Monomials in nilpotent generators, and the monomial ideal of those that vanish.

/// Memory that no algebra may need.
pub(super) const MAX_BYTES: f64 = 1e9;

/// A product of powers of generators: (generator, power) with rising generators and powers above 0.
/// The empty list is 1.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Monomial(Vec<(u16, u8)>);

impl Monomial {
    /// Collects factors in any order; a generator may come more than once.
    pub fn new(factors: impl IntoIterator<Item = (u16, u8)>) -> Self {
        let mut list: Vec<(u16, u8)> = factors.into_iter().filter(|(_, power)| *power > 0).collect();
        list.sort_unstable();
        list.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 = kept.1.saturating_add(next.1);
            }
            same
        });
        Self(list)
    }

    /// Returns the generators with their powers.
    pub fn factors(&self) -> &[(u16, u8)] {
        &self.0
    }

    /// Total degree.
    pub fn degree(&self) -> usize {
        self.0.iter().map(|(_, power)| usize::from(*power)).sum()
    }

    /// Returns the power of a generator.
    pub fn power(&self, generator: u16) -> u8 {
        self.0.iter().find(|(g, _)| *g == generator).map_or(0, |(_, power)| *power)
    }

    /// True if it divides the other one.
    pub fn divides(&self, other: &Self) -> bool {
        self.0.iter().all(|(generator, power)| *power <= other.power(*generator))
    }

    /// Returns the product with another one.
    pub fn times(&self, other: &Self) -> Self {
        if self.0.is_empty() || other.0.is_empty() {
            return if self.0.is_empty() { other.clone() } else { self.clone() };
        }
        Self::new(self.0.iter().chain(&other.0).copied())
    }

    /// Returns the quotient by a divisor; powers that are missing count as 0.
    pub fn over(&self, divisor: &Self) -> Self {
        let lowered = |(generator, power): &(u16, u8)| (*generator, power.saturating_sub(divisor.power(*generator)));
        Self::new(self.0.iter().map(lowered))
    }

    /// Returns the least common multiple with another one.
    pub fn lcm(&self, other: &Self) -> Self {
        let missing = other.0.iter().filter(|(generator, _)| self.power(*generator) == 0).copied();
        let higher = self.0.iter().map(|(generator, power)| (*generator, *power.max(&other.power(*generator))));
        Self::new(higher.chain(missing))
    }

    /// Times a generator that is not below its last one.
    fn times_generator(&self, generator: u16) -> Self {
        let mut list = self.0.clone();
        match list.last_mut() {
            Some((last, power)) if *last == generator => *power += 1,
            _ => list.push((generator, 1)),
        }
        Self(list)
    }

    /// Returns the number of monomials that divide it.
    fn divisor_count(&self) -> f64 {
        self.0.iter().map(|(_, power)| f64::from(*power) + 1.0).product()
    }

    pub(super) fn divisors(&self) -> Vec<(Self, Self)> {
        let mut pairs = vec![(Self::default(), Self::default())];
        for (generator, power) in &self.0 {
            let with = |(left, right): &(Self, Self), p: u8| {
                let add = |monomial: &Self, p: u8| {
                    let mut list = monomial.0.clone();
                    list.extend((p > 0).then_some((*generator, p)));
                    Self(list)
                };
                (add(left, p), add(right, power - p))
            };
            pairs = pairs.iter().flat_map(|pair| (0..=*power).map(move |p| with(pair, p))).collect();
        }
        pairs
    }
}

/// The zero monomials: all above a total degree, and every multiple of the listed ones.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Ideal {
    /// Highest total degree that is kept.
    pub degree: u8,
    /// Further monomials that vanish.
    pub vanish: Vec<Monomial>,
}

impl Ideal {
    /// Returns all monomials above a degree.
    pub fn above(degree: u8) -> Self {
        Self { degree, vanish: Vec::new() }
    }

    /// True if the monomial is other than zero.
    pub fn keeps(&self, monomial: &Monomial) -> bool {
        monomial.degree() <= usize::from(self.degree) && !self.vanish.iter().any(|v| v.divides(monomial))
    }

    /// Surviving products of a surviving monomial with generators from its last one on: every
    /// survivor but 1 comes from exactly one other, for a divisor of a survivor survives.
    fn next(&self, monomial: &Monomial, generators: u16) -> impl Iterator<Item = Monomial> {
        let first = monomial.0.last().map_or(0, |(last, _)| *last);
        let last = if monomial.degree() < usize::from(self.degree) { generators } else { first };
        (first..last).map(|g| monomial.times_generator(g)).filter(|m| self.keeps(m))
    }

    /// Survivors, lowest degree first.
    pub(super) fn survivors(&self, generators: u16) -> Vec<Monomial> {
        let mut all = vec![Monomial::default()];
        let mut done = 0;
        while done < all.len() {
            let next: Vec<Monomial> = self.next(&all[done], generators).collect();
            all.extend(next);
            done += 1;
        }
        all
    }

    /// Counts the size of the algebra; where that is beyond the limit of memory, returns a bound of it.
    pub fn size(&self, generators: u16) -> Size {
        let mut size = Size::default();
        let mut stack = vec![Monomial::default()];
        while let Some(monomial) = stack.pop() {
            size.monomials += 1.0;
            size.products += monomial.divisor_count();
            if size.bytes() > MAX_BYTES {
                return Size::bound(f64::from(generators), self.degree);
            }
            stack.extend(self.next(&monomial, generators));
        }
        size
    }
}

/// The size of an algebra.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Size {
    /// Surviving monomials: numbers in one element.
    pub monomials: f64,
    /// Entries of the product table: multiplications in one product.
    pub products: f64,
}

impl Size {
    /// Returns all monomials up to the degree: a bound for any ideal.
    fn bound(generators: f64, degree: u8) -> Self {
        let choose = |n: f64| (1..=degree).map(f64::from).map(|i| (n + i) / i).product();
        Self { monomials: choose(generators), products: choose(2.0 * generators) }
    }

    /// Returns the bound where relations hold: every pair of monomials has a product, with a factor.
    pub(super) fn with_relations(self) -> Self {
        Self { products: 3.0 * self.monomials * self.monomials, ..self }
    }

    /// Memory of basis and table.
    pub fn bytes(&self) -> f64 {
        128.0 * self.monomials + 8.0 * self.products
    }
}
