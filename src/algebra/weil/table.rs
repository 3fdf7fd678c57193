//! The product of two elements: which coefficients are multiplied for which monomial.
//!
//! Every kernel adds the products of a monomial one after the other, by rising index of the left factor, each in the
//! arithmetic of one double: the result is the same to the last bit for any kernel, vector width and processor.

/// How elements are multiplied.
#[derive(Debug, PartialEq)]
pub enum Table {
    /// All monomials to degree 2 in so many generators: nothing to look up.
    Quadratic(usize),
    /// At most 256 monomials: an index is a byte, and cannot miss.
    Small(Rows<u8>),
    /// More of them.
    Large(Rows<u32>),
}

/// Monomials that are made at once: their sums do not wait for each other.
const LANES: usize = 4;

/// The pairs of factors of each monomial, monomials of as many pairs side by side.
#[derive(Debug, PartialEq)]
pub struct Rows<I> {
    groups: Vec<Group>,
    steps: Vec<[[I; 2]; LANES]>,
    products: usize,
}

/// Monomials that are made at once; the last may stand several times.
#[derive(Debug, PartialEq)]
struct Group {
    monomials: [u32; LANES],
    /// How many pairs each has.
    length: u32,
}

impl Table {
    /// From the pairs of factors of each monomial, by rising left factor.
    pub fn new(rows: impl Iterator<Item = Vec<[u32; 2]>>) -> Self {
        let rows: Vec<Vec<[u32; 2]>> = rows.collect();
        if rows.len() <= 256 {
            Self::Small(Rows::new(&rows, |i| i as u8))
        } else {
            Self::Large(Rows::new(&rows, |i| i))
        }
    }

    /// Multiplications in one product.
    pub fn products(&self) -> usize {
        match self {
            Self::Quadratic(k) => 1 + 2 * k + 3 * k + 4 * (k * k - k) / 2,
            Self::Small(rows) => rows.products,
            Self::Large(rows) => rows.products,
        }
    }

    /// The product of two lists of coefficients into a third.
    pub fn multiply(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        match self {
            Self::Quadratic(k) => quadratic(*k, a, b, out),
            Self::Small(rows) => {
                let (mut x, mut y) = ([0.0; 256], [0.0; 256]);
                x[..a.len()].copy_from_slice(a);
                y[..b.len()].copy_from_slice(b);
                rows.each(out, |[i, j]| x[usize::from(i)] * y[usize::from(j)]);
            }
            Self::Large(rows) => rows.each(out, |[i, j]| a[i as usize] * b[j as usize]),
        }
    }
}

impl<I: Copy> Rows<I> {
    fn new(rows: &[Vec<[u32; 2]>], index: impl Fn(u32) -> I) -> Self {
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|k| rows[*k].len());
        let (mut groups, mut steps) = (Vec::new(), Vec::new());
        for alike in order.chunk_by(|a, b| rows[*a].len() == rows[*b].len()) {
            for some in alike.chunks(LANES) {
                let lanes: [usize; LANES] = std::array::from_fn(|l| some[l.min(some.len() - 1)]);
                let length = rows[lanes[0]].len();
                steps.extend((0..length).map(|t| lanes.map(|k| rows[k][t].map(&index))));
                groups.push(Group { monomials: lanes.map(|k| k as u32), length: length as u32 });
            }
        }
        Self { groups, steps, products: rows.iter().map(Vec::len).sum() }
    }

    #[inline(always)]
    fn each(&self, out: &mut [f64], product: impl Fn([I; 2]) -> f64) {
        let mut rest = &self.steps[..];
        for group in &self.groups {
            let (steps, after) = rest.split_at(group.length as usize);
            rest = after;
            let mut sums = [0.0; LANES];
            for step in steps {
                for (sum, pair) in sums.iter_mut().zip(step) {
                    *sum += product(*pair);
                }
            }
            for (k, sum) in group.monomials.iter().zip(sums) {
                out[*k as usize] = sum;
            }
        }
    }
}

/// 1, then k generators, then the upper triangle of their products row by row.
fn quadratic(k: usize, a: &[f64], b: &[f64], out: &mut [f64]) {
    let (a0, b0) = (a[0], b[0]);
    out[0] = a0 * b0;
    let (a1, mut a2) = a[1..].split_at(k);
    let (b1, mut b2) = b[1..].split_at(k);
    let (o1, mut o2) = out[1..].split_at_mut(k);
    for ((o, a), b) in o1.iter_mut().zip(a1).zip(b1) {
        *o = a0 * b + a * b0;
    }
    for i in 0..k {
        let length = k - i;
        let (row, rest) = o2.split_at_mut(length);
        let ((left, a_rest), (right, b_rest)) = (a2.split_at(length), b2.split_at(length));
        (o2, a2, b2) = (rest, a_rest, b_rest);
        let (ai, bi) = (a1[i], b1[i]);
        row[0] = a0 * right[0] + ai * bi + left[0] * b0;
        let factors = left[1..].iter().zip(&right[1..]).zip(a1[i + 1..].iter().zip(&b1[i + 1..]));
        for (o, ((aij, bij), (aj, bj))) in row[1..].iter_mut().zip(factors) {
            *o = a0 * bij + ai * bj + aj * bi + aij * b0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Basis, Ideal, Monomial};

    /// The definition: every pair of monomials by rising left index.
    fn plainly(basis: &Basis, a: &[f64], b: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; a.len()];
        for (i, left) in basis.monomials().iter().enumerate() {
            for (j, right) in basis.monomials().iter().enumerate() {
                if let Some(k) = basis.position(&left.times(right)) {
                    out[k] += a[i] * b[j];
                }
            }
        }
        out
    }

    #[test]
    fn every_kernel_is_the_definition_to_the_last_bit() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let some = Ideal { degree: 2, vanish: vec![Monomial::new([(1, 2)]), Monomial::new([(0, 1), (3, 1)])] };
        let all = [(1, 1), (1, 6), (2, 2), (6, 2), (21, 2), (6, 4), (7, 4), (3, 9), (40, 1)];
        for (generators, ideal) in all.map(|(k, degree)| (k, Ideal::above(degree))).into_iter().chain([(5, some)]) {
            let basis = Basis::new(generators, ideal).unwrap();
            let n = basis.monomials().len();
            let [a, b]: [Vec<f64>; 2] = std::array::from_fn(|_| (0..n).map(|_| next()).collect());
            let mut out = vec![f64::NAN; n];
            basis.multiply(&a, &b, &mut out);
            assert_eq!(out, plainly(&basis, &a, &b), "{generators} {n}");
        }
    }
}
