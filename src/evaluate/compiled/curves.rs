//! The six error curves of an axis, compiled: one interval and one fraction for all of them.
//!
//! All tables of the axis are brought onto the union of their knots, which changes nothing: a piecewise linear
//! function stays one, a cubic piece cut in two is two cubic pieces, and beyond its end a table is constant. A
//! row holds the six values at a knot (two places are padding), of cubic tables another one the six second
//! derivatives; a look-up reads neighbouring rows and no gathered numbers. Polynomials and harmonics are sums of
//! rows too. Constants, means of two directions, and any linear map of the six are folded in.

use super::intervals::{Found, Intervals, apart, search};
use super::lanes::Places;
use super::simd::{Lanes, MOST, Pieces, Row};
use super::trigonometry::nearest;
use crate::machine::{Approach, BSpline, ComponentError, Curve, ErrorTerm, JointErrors, Knots};

/// Six errors: translations, then rotations.
pub type Six = [f64; 6];

/// Compiled curves. Their values are sums of all parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curves {
    /// Added everywhere.
    constant: Six,
    table: Option<CurveTable>,
    /// Coefficients of the powers of the position from the first on.
    powers: Vec<Six>,
    /// Cosine and sine parts of the orders from the first on.
    waves: Vec<[Six; 2]>,
}

#[derive(Debug, Clone, PartialEq)]
struct CurveTable {
    rows: Vec<Row>,
    /// Second derivatives, if cubic.
    seconds: Vec<Row>,
    first: f64,
    last: f64,
    /// The period of a continuous axis, and its inverse.
    period: Option<(f64, f64)>,
    intervals: Intervals,
}

/// Where positions lie in a table. Aligned, so that no vector of 64 bytes lies in two cache lines.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
pub struct Spots<const N: usize> {
    interval: Places<N>,
    /// Share of the interval's upper end.
    share: [f64; N],
    /// Weights of the second derivatives at both ends, of cubic tables.
    bends: [[f64; N]; 2],
}

impl<const N: usize> Spots<N> {
    /// Before anything is located.
    pub const NONE: Self = Self { interval: Places::NONE, share: [0.0; N], bends: [[0.0; N]; 2] };
}

impl Curves {
    /// The component errors of an axis. `None` if periodic tables stand beside others, or a piece is no cubic.
    pub fn new(errors: &JointErrors, approach: Approach) -> Option<Self> {
        let (mut curves, mut parts, mut tables) = (Self::default(), Vec::new(), Vec::new());
        for (column, term) in errors.component.iter().enumerate() {
            match term {
                Some(ErrorTerm::Component(component)) => parts
                    .extend(weighted(component, approach).into_iter().map(|(weight, curve)| (column, weight, curve))),
                Some(ErrorTerm::Constant(value)) => curves.constant[column] += value,
                Some(ErrorTerm::Tolerance(_)) | None => {}
            }
        }
        for (column, weight, curve) in parts {
            match curve {
                Curve::Polynomial(c) => curves.add_polynomial(column, weight, c),
                Curve::Harmonics(orders) => curves.add_harmonics(column, weight, orders),
                Curve::Linear(_) | Curve::Cubic(..) => tables.push((column, weight, curve.clone())),
                Curve::BSpline(spline) => tables.push((column, weight, piecewise(spline)?)),
            }
        }
        curves.table = if tables.is_empty() { None } else { Some(CurveTable::union(&tables)?) };
        Some(curves.plus(&[0.0; 6]))
    }

    fn add_polynomial(&mut self, column: usize, weight: f64, coefficients: &[f64]) {
        for (power, c) in coefficients.iter().enumerate() {
            match power.checked_sub(1) {
                None => self.constant[column] += weight * c,
                Some(k) => {
                    self.powers.resize(self.powers.len().max(power), [0.0; 6]);
                    self.powers[k][column] += weight * c;
                }
            }
        }
    }

    fn add_harmonics(&mut self, column: usize, weight: f64, orders: &[(f64, f64)]) {
        for (order, (cosine, sine)) in orders.iter().enumerate() {
            match order.checked_sub(1) {
                None => self.constant[column] += weight * cosine,
                Some(k) => {
                    self.waves.resize(self.waves.len().max(order), [[0.0; 6]; 2]);
                    self.waves[k][0][column] += weight * cosine;
                    self.waves[k][1][column] += weight * sine;
                }
            }
        }
    }

    /// No errors at all?
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }

    /// A linear map of the six, folded into every row.
    pub fn mapped(mut self, map: impl Fn(&Six) -> Six) -> Self {
        self.constant = map(&self.constant);
        self.powers.iter_mut().for_each(|row| *row = map(row));
        self.waves.iter_mut().flatten().for_each(|row| *row = map(row));
        for Row(row) in self.table.iter_mut().flat_map(|table| table.rows.iter_mut().chain(&mut table.seconds)) {
            let [a, b, c, d, e, f, ..] = *row;
            row[..6].copy_from_slice(&map(&[a, b, c, d, e, f]));
        }
        self
    }

    /// A constant, folded in: into the rows of values where there are any.
    pub fn plus(mut self, constant: &Six) -> Self {
        self.constant.iter_mut().zip(constant).for_each(|(sum, c)| *sum += c);
        if let Some(table) = &mut self.table {
            for Row(row) in &mut table.rows {
                row.iter_mut().zip(&self.constant).for_each(|(value, c)| *value += c);
            }
            self.constant = [0.0; 6];
        }
        self
    }

    /// Do they need the sine and cosine of the position?
    pub fn has_waves(&self) -> bool {
        !self.waves.is_empty()
    }

    /// Where positions (mm or deg), whole vectors, lie in the table.
    #[inline(always)]
    pub fn locate<V: Lanes, const N: usize>(&self, positions: &[f64], spots: &mut Spots<N>) {
        if let Some(table) = &self.table {
            table.locate::<V, N>(positions, spots);
        }
    }

    /// The six errors at positions that have been located, whose sine and cosine are given where harmonics need them.
    #[inline(always)]
    pub fn at<V: Lanes, const N: usize>(&self, position: V, turn: (V, V), spots: (&Spots<N>, usize)) -> [V; 6] {
        let mut six = match &self.table {
            Some(table) => {
                let rows = if table.is_cubic() { table.cubic::<V, N>(spots) } else { table.linear::<V, N>(spots) };
                let [a, b, c, d, e, f, ..] = V::columns(&rows);
                [a, b, c, d, e, f]
            }
            None => splat_six(&self.constant),
        };
        if self.powers.is_empty() && self.waves.is_empty() {
            return six;
        }
        if !self.powers.is_empty() {
            self.add_powers(&mut six, position);
        }
        if !self.waves.is_empty() {
            self.add_waves(&mut six, turn);
        }
        six
    }

    /// Are they a table of straight pieces and nothing else?
    pub fn are_rows(&self) -> bool {
        let straight = self.table.as_ref().is_some_and(|table| !table.is_cubic());
        straight && self.powers.is_empty() && self.waves.is_empty()
    }

    /// Two linear combinations of the six, in the columns that are otherwise padding.
    pub fn set_asides(&mut self, asides: impl Fn(&Six) -> [f64; 2]) {
        for Row([a, b, c, d, e, f, aside @ ..]) in self.table.iter_mut().flat_map(|table| &mut table.rows) {
            *aside = asides(&[*a, *b, *c, *d, *e, *f]);
        }
    }

    /// Rows at positions that have been located, of curves that [are rows](Self::are_rows): the six errors and two asides.
    #[inline(always)]
    pub fn rows<V: Lanes, const N: usize>(&self, spots: (&Spots<N>, usize)) -> [V::Eight; MOST] {
        match &self.table {
            Some(table) => table.linear::<V, N>(spots),
            None => [V::Eight::of(&Row([0.0; 8])); MOST],
        }
    }

    /// The same, added to those of another axis.
    #[inline(always)]
    pub fn add_rows<V: Lanes, const N: usize>(&self, rows: &mut [V::Eight; MOST], spots: (&Spots<N>, usize)) {
        if let Some(table) = &self.table {
            table.add_linear::<V, N>(rows, spots);
        }
    }

    /// The six errors at one position.
    pub fn alone(&self, position: f64, turn: (f64, f64)) -> Six {
        let mut spots = Spots::<1>::NONE;
        self.locate::<f64, 1>(&[position], &mut spots);
        self.at(position, turn, (&spots, 0))
    }

    #[inline(always)]
    fn add_powers<V: Lanes>(&self, six: &mut [V; 6], position: V) {
        let mut sum = [V::splat(0.0); 6];
        for row in self.powers.iter().rev() {
            for k in 0..6 {
                sum[k] = (sum[k] + V::splat(row[k])) * position;
            }
        }
        for k in 0..6 {
            six[k] = six[k] + sum[k];
        }
    }

    #[inline(always)]
    fn add_waves<V: Lanes>(&self, six: &mut [V; 6], (s1, c1): (V, V)) {
        let (mut s, mut c) = (s1, c1);
        for [cosines, sines] in &self.waves {
            for k in 0..6 {
                six[k] = six[k].plus_times(V::splat(cosines[k]), c).plus_times(V::splat(sines[k]), s);
            }
            (s, c) = ((s * c1).plus_times(c, s1), (c * c1).minus_times(s, s1));
        }
    }
}

/// The same six numbers in all lanes.
#[inline(always)]
pub fn splat_six<V: Lanes>(six: &Six) -> [V; 6] {
    let [a, b, c, d, e, f] = *six;
    [V::splat(a), V::splat(b), V::splat(c), V::splat(d), V::splat(e), V::splat(f)]
}

/// The one or two curves that count, with their shares.
fn weighted(component: &ComponentError, approach: Approach) -> Vec<(f64, &Curve)> {
    match (component, approach) {
        (ComponentError::Single(curve), _) => vec![(1.0, curve)],
        (ComponentError::Bidirectional { forward, .. }, Approach::Forward) => vec![(1.0, forward)],
        (ComponentError::Bidirectional { reverse, .. }, Approach::Reverse) => vec![(1.0, reverse)],
        (ComponentError::Bidirectional { forward, reverse }, Approach::Mean) => vec![(0.5, forward), (0.5, reverse)],
    }
}

/// A B-spline by values and second derivatives at its knots. `None` if it has jumps in them, or a higher degree.
fn piecewise(spline: &BSpline) -> Option<Curve> {
    let second = spline.second_derivatives()?;
    Some(Curve::Cubic(spline.breaks().clone(), second))
}

/// A curve of a table, with its second derivative, which is linear between the knots of a spline.
struct Piece<'a> {
    column: usize,
    weight: f64,
    curve: &'a Curve,
    bend: Option<Curve>,
}

impl<'a> Piece<'a> {
    /// `None` if the second derivatives do not fit the knots.
    fn new((column, weight, curve): &'a (usize, f64, Curve)) -> Option<Self> {
        let bend = match curve {
            Curve::Cubic(knots, second) => {
                let points: Vec<(f64, f64)> = knots.positions().iter().copied().zip(second.iter().copied()).collect();
                Some(Curve::Linear(Knots::new(&points, knots.period()).ok()?))
            }
            _ => None,
        };
        Some(Self { column: *column, weight: *weight, curve, bend })
    }

    /// Are value and second derivative the same at two places, but for rounding?
    fn same(&self, a: f64, b: f64) -> bool {
        std::iter::once(self.curve).chain(&self.bend).all(|curve| {
            let values = curve.knots().map_or(&[][..], Knots::values);
            let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            (curve.value(a) - curve.value(b)).abs() <= 16.0 * f64::EPSILON * largest
        })
    }
}

impl CurveTable {
    fn union(curves: &[(usize, f64, Curve)]) -> Option<Self> {
        let all: Vec<&Knots> = curves.iter().filter_map(|(_, _, curve)| curve.knots()).collect();
        let period = all.first()?.period();
        if all.iter().any(|knots| knots.period() != period) {
            return None;
        }
        let pieces: Vec<Piece<'_>> = curves.iter().map(Piece::new).collect::<Option<_>>()?;
        let knots = union_of_knots(&all, period, &pieces)?;
        let cubic = pieces.iter().any(|piece| piece.bend.is_some());
        let (mut rows, mut seconds) = (Vec::new(), Vec::new());
        for knot in &knots {
            let (mut value, mut second) = ([0.0; 8], [0.0; 8]);
            for Piece { column, weight, curve, bend } in &pieces {
                value[*column] += weight * curve.value(*knot);
                second[*column] += weight * bend.as_ref().map_or(0.0, |bend| bend.value(*knot));
            }
            rows.push(Row(value));
            if cubic {
                seconds.push(Row(second));
            }
        }
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        let period = period.map(|period| (period, 1.0 / period));
        Some(Self { rows, seconds, first, last, period, intervals: Intervals::new(&knots) })
    }

    fn is_cubic(&self) -> bool {
        !self.seconds.is_empty()
    }

    /// A position in the table's range.
    #[inline(always)]
    fn within<V: Lanes>(&self, position: V) -> V {
        let (first, last) = (V::splat(self.first), V::splat(self.last));
        let x = match self.period {
            Some((period, inverse)) => {
                let way = position - first;
                position.minus_times(nearest(V::splat(-0.5).plus_times(way, V::splat(inverse))), V::splat(period))
            }
            None => position,
        };
        x.larger(first).smaller(last)
    }

    #[inline(always)]
    fn locate<V: Lanes, const N: usize>(&self, positions: &[f64], spots: &mut Spots<N>) {
        spots.interval.reach(self.rows.len());
        let (first, mut i) = (V::splat(self.first), 0);
        match &self.intervals {
            Intervals::Even { per_unit, last, width } => {
                while i < positions.len() {
                    let along = (self.within(V::load(&positions[i..])) - first) * V::splat(*per_unit);
                    let (whole, interval) = along.smaller(V::splat(*last)).whole();
                    self.put(spots, i, (interval, along - whole, V::splat(*width)));
                    i += V::COUNT;
                }
            }
            Intervals::Apart { cells, rows } => {
                while i < positions.len() {
                    let x = self.within(V::load(&positions[i..]));
                    self.put(spots, i, apart(rows, &cells.of(x - first), x));
                    i += V::COUNT;
                }
            }
            Intervals::Crowded { cells, starts, knots } => {
                while i < positions.len() {
                    let x = self.within(V::load(&positions[i..]));
                    let (interval, share, width) = search(starts, knots, &cells.of(x - first), &x.spread(), V::COUNT);
                    self.put(spots, i, (interval, V::load(&share), V::load(&width)));
                    i += V::COUNT;
                }
            }
        }
    }

    #[inline(always)]
    fn put<V: Lanes, const N: usize>(&self, spots: &mut Spots<N>, i: usize, (interval, share, width): Found<V>) {
        // The mask changes nothing, and shows the compiler that the vector lies within the room.
        let i = i & (N - V::COUNT);
        spots.interval.put::<V>(i, &interval);
        share.store(&mut spots.share[i..]);
        if self.is_cubic() {
            let (scale, rest) = (width * width * V::splat(1.0 / 6.0), V::splat(1.0) - share);
            ((rest * rest * rest - rest) * scale).store(&mut spots.bends[0][i..]);
            ((share * share * share - share) * scale).store(&mut spots.bends[1][i..]);
        }
    }

    #[inline(always)]
    fn linear<V: Lanes, const N: usize>(&self, (spots, i): (&Spots<N>, usize)) -> [V::Eight; MOST] {
        let share = &spots.share[i..i + V::COUNT];
        let mut rows = [V::Eight::of(&self.rows[0]); MOST];
        for lane in 0..V::COUNT {
            let (low, high) = spots.interval.pair(&self.rows, i + lane);
            let (low, high) = (V::Eight::of(low), V::Eight::of(high));
            rows[lane] = low.plus_times(high.minus(low), share[lane]);
        }
        rows
    }

    /// The same, added to rows.
    #[inline(always)]
    fn add_linear<V: Lanes, const N: usize>(&self, rows: &mut [V::Eight; MOST], (spots, i): (&Spots<N>, usize)) {
        let share = &spots.share[i..i + V::COUNT];
        for lane in 0..V::COUNT {
            let (low, high) = spots.interval.pair(&self.rows, i + lane);
            let (low, high) = (V::Eight::of(low), V::Eight::of(high));
            rows[lane] = rows[lane].plus(low).plus_times(high.minus(low), share[lane]);
        }
    }

    /// Natural form of a cubic piece: values and second derivatives at both ends.
    #[inline(always)]
    fn cubic<V: Lanes, const N: usize>(&self, (spots, i): (&Spots<N>, usize)) -> [V::Eight; MOST] {
        let share = &spots.share[i..i + V::COUNT];
        let [low_bend, high_bend] = [&spots.bends[0][i..i + V::COUNT], &spots.bends[1][i..i + V::COUNT]];
        let mut rows = [V::Eight::of(&self.rows[0]); MOST];
        for lane in 0..V::COUNT {
            let (low, high) = spots.interval.pair(&self.rows, i + lane);
            let (low_second, high_second) = spots.interval.pair(&self.seconds, i + lane);
            let (low, high) = (V::Eight::of(low), V::Eight::of(high));
            let bent =
                low.plus_times(high.minus(low), share[lane]).plus_times(V::Eight::of(low_second), low_bend[lane]);
            rows[lane] = bent.plus_times(V::Eight::of(high_second), high_bend[lane]);
        }
        rows
    }
}

/// All knots, rising, at least two; of a periodic axis those of one turn from the first table's start.
fn union_of_knots(all: &[&Knots], period: Option<f64>, pieces: &[Piece<'_>]) -> Option<Vec<f64>> {
    let start = *all.first()?.positions().first()?;
    let mut knots: Vec<f64> = match period {
        Some(period) => {
            let wrapped = |q: &f64| start + (q - start).rem_euclid(period);
            all.iter().flat_map(|knots| knots.positions()).map(wrapped).chain([start, start + period]).collect()
        }
        None => all.iter().flat_map(|knots| knots.positions()).copied().collect(),
    };
    knots.sort_by(f64::total_cmp);
    let largest = knots.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
    // Knots that rounding alone tells apart are one; a step between two is none.
    let near = |a: f64, b: f64| b - a <= 4.0 * f64::EPSILON * largest;
    knots.dedup_by(|b, a| a == b || near(*a, *b) && pieces.iter().all(|piece| piece.same(*a, *b)));
    if let [single] = knots[..] {
        knots.push(single + 1.0);
    }
    Some(knots)
}
