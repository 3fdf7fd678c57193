//! The product of two elements: the pairs of coefficients that are multiplied for each monomial.
//!
//! Each kernel adds the products of a monomial in one fixed order, each in the arithmetic of one double: the result is
//! the same to the last bit for any vector width and processor. With one generator, the order is that of the dual
//! numbers: by rising index of the left factor.

/// The table by which elements are multiplied.
#[derive(Debug, PartialEq)]
pub enum ProductTable {
    /// All monomials to degree 2 in this number of generators: nothing to look up.
    Quadratic(usize),
    /// At most 256 monomials: an index is a byte, and cannot miss.
    Small(Pairs),
    /// Any.
    Rows(Rows),
    /// With relations between monomials: products have factors.
    Scaled(Vec<ScaledProduct>),
}

/// A product of two monomials that is a multiple of a third.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaledProduct {
    /// Indices of the factors.
    pub factors: [u32; 2],
    /// Index of the product.
    pub into: u32,
    /// The multiple.
    pub factor: f64,
}

impl ProductTable {
    /// Builds the table from the pairs of factors of each monomial, by rising left factor.
    pub fn new(rows: impl Iterator<Item = Vec<[u32; 2]>>, generators: u16) -> Self {
        let rows: Vec<Vec<[u32; 2]>> = rows.collect();
        if generators > 1 && rows.len() <= 256 { Self::Small(Pairs::new(&rows)) } else { Self::Rows(Rows::new(&rows)) }
    }

    /// Multiplications in one product.
    pub fn products(&self) -> usize {
        match self {
            Self::Quadratic(k) => 1 + 2 * k + 3 * k + 4 * (k * k - k) / 2,
            Self::Small(pairs) => pairs.products,
            Self::Rows(rows) => rows.pairs.len(),
            Self::Scaled(list) => list.len(),
        }
    }

    /// The product of two lists of coefficients into a third.
    pub fn multiply(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        match self {
            Self::Quadratic(k) => quadratic(*k, a, b, out),
            Self::Small(pairs) => pairs.multiply(a, b, out),
            Self::Rows(rows) => rows.multiply(a, b, out),
            Self::Scaled(list) => {
                out.fill(0.0);
                for ScaledProduct { factors: [i, j], into, factor } in list {
                    out[*into as usize] += factor * (a[*i as usize] * b[*j as usize]);
                }
            }
        }
    }
}

/// The pairs of factors of each monomial, one monomial after the other.
#[derive(Debug, PartialEq)]
pub struct Rows {
    ends: Vec<u32>,
    pairs: Vec<[u32; 2]>,
}

impl Rows {
    fn new(rows: &[Vec<[u32; 2]>]) -> Self {
        let mut end = 0;
        let ends = rows.iter().map(|row| {
            end += row.len() as u32;
            end
        });
        Self { ends: ends.collect(), pairs: rows.concat() }
    }

    fn multiply(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        let mut start = 0;
        for (out, end) in out.iter_mut().zip(&self.ends) {
            let term = |[i, j]: &[u32; 2]| a[*i as usize] * b[*j as usize];
            *out = self.pairs[start..*end as usize].iter().map(term).sum();
            start = *end as usize;
        }
    }
}

/// The unordered pairs {i, j} of each monomial without 1, for a_i b_j + a_j b_i; monomials of as many pairs follow each
/// other, so that the loop over them has a length that the compiler knows.
#[derive(Debug, PartialEq)]
pub struct Pairs {
    runs: Vec<ProductRun>,
    products: usize,
}

/// Monomials of as many pairs.
#[derive(Debug, PartialEq)]
struct ProductRun {
    /// The number of pairs of each.
    length: usize,
    monomials: Vec<u8>,
    pairs: Vec<[u8; 2]>,
    /// The root of each if they are squares, or none.
    roots: Vec<u8>,
}

impl Pairs {
    fn new(rows: &[Vec<[u32; 2]>]) -> Self {
        let bytes = |pair: &[u32; 2]| pair.map(|i| i as u8);
        let halves = |row: &Vec<[u32; 2]>| row.iter().filter(|[i, j]| 0 < *i && i < j).map(bytes).collect::<Vec<_>>();
        let half: Vec<Vec<[u8; 2]>> = rows.iter().map(halves).collect();
        let root = |k: usize| rows[k].iter().find(|[i, j]| i == j).map(|[i, _]| *i as u8);
        let kind = |k: usize| (half[k].len(), root(k).is_some());
        // 1, and the monomials that only 1 divides, are made without a table.
        let mut order: Vec<usize> = (1..rows.len()).filter(|k| rows[*k].len() > 2).collect();
        order.sort_by_key(|k| kind(*k));
        let run = |alike: &[usize]| ProductRun {
            length: half[alike[0]].len(),
            monomials: alike.iter().map(|k| *k as u8).collect(),
            pairs: alike.iter().flat_map(|k| half[*k].iter().copied()).collect(),
            roots: alike.iter().filter_map(|k| root(*k)).collect(),
        };
        let runs = order.chunk_by(|a, b| kind(*a) == kind(*b)).map(run).collect();
        Self { runs, products: rows.iter().map(Vec::len).sum() }
    }

    fn multiply(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        let mut both = [[0.0; 2]; 256];
        for ((both, a), b) in both.iter_mut().zip(a).zip(b) {
            *both = [*a, *b];
        }
        let (a0, b0) = (a[0], b[0]);
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out = a0 * b + a * b0;
        }
        out[0] = a0 * b0;
        for run in &self.runs {
            match run.length {
                0 => {}
                1 => run.add::<1>(&both, out),
                2 => run.add::<2>(&both, out),
                3 => run.add::<3>(&both, out),
                5 => run.add::<5>(&both, out),
                7 => run.add::<7>(&both, out),
                length => run.add_any(length, &both, out),
            }
            for (k, root) in run.monomials.iter().zip(&run.roots) {
                let [x, y] = both[usize::from(*root)];
                out[usize::from(*k)] += x * y;
            }
        }
    }
}

impl ProductRun {
    #[inline(always)]
    fn add<const N: usize>(&self, both: &[[f64; 2]; 256], out: &mut [f64]) {
        for (k, pairs) in self.monomials.iter().zip(self.pairs.as_chunks::<N>().0) {
            out[usize::from(*k)] += sum(pairs, both);
        }
    }

    fn add_any(&self, length: usize, both: &[[f64; 2]; 256], out: &mut [f64]) {
        for (k, pairs) in self.monomials.iter().zip(self.pairs.chunks_exact(length)) {
            out[usize::from(*k)] += sum(pairs, both);
        }
    }
}

/// Sum of the `a_i b_j`, plus sum of the `b_i a_j`.
#[inline(always)]
fn sum(pairs: &[[u8; 2]], both: &[[f64; 2]; 256]) -> f64 {
    let mut sum = [0.0; 2];
    for [i, j] in pairs {
        let ([x, y], [u, v]) = (both[usize::from(*i)], both[usize::from(*j)]);
        sum[0] += x * v;
        sum[1] += y * u;
    }
    sum[0] + sum[1]
}

/// Generators whose triangle of products is written out without loops: short rows cost more than they hold.
const TAIL: usize = 6;

/// 1, then k generators, then the upper triangle of their products row by row.
fn quadratic(k: usize, a: &[f64], b: &[f64], out: &mut [f64]) {
    let (a0, b0) = (a[0], b[0]);
    out[0] = a0 * b0;
    let (a1, a2) = a[1..].split_at(k);
    let (b1, b2) = b[1..].split_at(k);
    let (o1, o2) = out[1..].split_at_mut(k);
    for ((o, a), b) in o1.iter_mut().zip(a1).zip(b1) {
        *o = a0 * b + a * b0;
    }
    let long = k.checked_sub(TAIL);
    let mut start = 0;
    for i in 0..long.unwrap_or(k) {
        let end = start + k - i;
        let (left, right, row) = (&a2[start..end], &b2[start..end], &mut o2[start..end]);
        row_of_products([a0, a1[i], b1[i], b0], [left, right, &a1[i..], &b1[i..]], row);
        row[0] = a0 * right[0] + a1[i] * b1[i] + left[0] * b0;
        start = end;
    }
    if let Some(i) = long {
        triangle::<TAIL>([a0, b0], [&a1[i..], &b1[i..], &a2[start..], &b2[start..]], &mut o2[start..]);
    }
}

/// `a0 b_ij + a_i b_j + a_j b_i + a_ij b0` along j.
#[inline(always)]
fn row_of_products([a0, ai, bi, b0]: [f64; 4], [left, right, x, y]: [&[f64]; 4], row: &mut [f64]) {
    let n = row.len();
    let (left, right, x, y) = (&left[..n], &right[..n], &x[..n], &y[..n]);
    for j in 0..n {
        row[j] = a0 * right[j] + ai * y[j] + x[j] * bi + left[j] * b0;
    }
}

/// The same for all rows of K generators.
#[inline(always)]
fn triangle<const K: usize>([a0, b0]: [f64; 2], [x, y, left, right]: [&[f64]; 4], out: &mut [f64]) {
    let length = K * (K + 1) / 2;
    let (left, right, out) = (&left[..length], &right[..length], &mut out[..length]);
    let (Some(x), Some(y)) = (x.first_chunk::<K>(), y.first_chunk::<K>()) else { return };
    let mut start = 0;
    for i in 0..K {
        out[start] = a0 * right[start] + x[i] * y[i] + left[start] * b0;
        for j in i + 1..K {
            let at = start + j - i;
            out[at] = a0 * right[at] + x[i] * y[j] + x[j] * y[i] + left[at] * b0;
        }
        start += K - i;
    }
}

#[cfg(test)]
mod tests {
    use crate::algebra::weil::{Basis, Ideal, Monomial};

    /// The definition: every pair of monomials by rising left index; if `mirrored`, first the pairs with a factor 1,
    /// then the pairs with rising factors and their mirror images, each summed, then the squares.
    fn plainly(basis: &Basis, a: &[f64], b: &[f64], mirrored: bool) -> Vec<f64> {
        let mut out = vec![0.0; a.len()];
        if mirrored {
            let n = a.len();
            let product = |i: usize, j: usize| basis.position(&basis.monomials()[i].times(&basis.monomials()[j]));
            let [mut rest, mut mirrored, mut squares] = [(); 3].map(|()| vec![0.0; n]);
            for (i, j) in (1..n).flat_map(|i| (i..n).map(move |j| (i, j))) {
                match product(i, j) {
                    Some(k) if i == j => squares[k] += a[i] * b[i],
                    Some(k) => {
                        rest[k] += a[i] * b[j];
                        mirrored[k] += b[i] * a[j];
                    }
                    None => {}
                }
            }
            let one = |k: usize| if k == 0 { a[0] * b[0] } else { a[0] * b[k] + a[k] * b[0] };
            return (0..n).map(|k| (one(k) + (rest[k] + mirrored[k])) + squares[k]).collect();
        }
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
        let mut kinds = std::collections::HashSet::new();
        for (generators, ideal) in all.map(|(k, degree)| (k, Ideal::above(degree))).into_iter().chain([(5, some)]) {
            let basis = Basis::new(generators, ideal).unwrap();
            let n = basis.monomials().len();
            let [a, b]: [Vec<f64>; 2] = std::array::from_fn(|_| (0..n).map(|_| next()).collect());
            let mut out = vec![f64::NAN; n];
            basis.multiply(&a, &b, &mut out);
            let mirrored = matches!(basis.table(), super::ProductTable::Small(_));
            assert_eq!(out, plainly(&basis, &a, &b, mirrored), "{generators} {n}");
            kinds.insert(std::mem::discriminant(basis.table()));
        }
        assert_eq!(kinds.len(), 3, "every kernel is met");
    }
}
