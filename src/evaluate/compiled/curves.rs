//! The six error curves of an axis, compiled into one table: one interval and one fraction serve all six.
//!
//! All tables of the axis are brought onto the union of their knots, which changes nothing: a piecewise linear function
//! stays one, a cubic piece cut in two is two cubic pieces, and beyond its ends a table is constant. A row holds the
//! six values at a knot (two columns are spare); a cubic table has a second row per knot with the six second
//! derivatives. A look-up reads adjacent rows and gathers no single numbers. Polynomials and harmonics are sums of rows
//! too. Constants, means of the two directions, and any linear map of the six errors are folded into the rows.

use super::intervals::{IntervalPoint, KnotIntervals, find_by_bucket, find_by_search};
use super::lanes::RowOffsets;
use super::simd::{Lanes, MAX_LANES, RowVector, TableRow};
use super::trigonometry::nearest;
use crate::machine::{Approach, BSpline, ComponentError, Curve, ErrorTerm, JointErrors, Knots, OperatingConditions};

/// Six errors: translations along x, y, z (mm), then rotations about them (rad).
pub type Six = [f64; 6];

/// Six compiled curves. Their values are the sums of the constant, the table, the polynomial and the harmonics.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CompiledCurves {
    constant: Six,
    table: Option<CurveTable>,
    /// Coefficients of the powers 1, 2, ... of the position (mm or deg).
    powers: Vec<Six>,
    /// Cosine and sine coefficients of the orders 1, 2, ...
    harmonics: Vec<[Six; 2]>,
}

#[derive(Debug, Clone, PartialEq)]
struct CurveTable {
    rows: Vec<TableRow>,
    /// Second derivatives at the knots; empty unless the table is cubic.
    seconds: Vec<TableRow>,
    first: f64,
    last: f64,
    /// The period of a continuous axis, and its inverse.
    period: Option<(f64, f64)>,
    intervals: KnotIntervals,
}

/// N positions within a table. Aligned, so that no vector of 64 bytes lies in two cache lines.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
pub struct TablePositions<const N: usize> {
    rows: RowOffsets<N>,
    /// Distance from the lower knot, divided by the length of the interval.
    fraction: [f64; N],
    /// Weights of the second derivatives at the lower and the upper knot; used by cubic tables only.
    second_weights: [[f64; N]; 2],
}

/// The vector of positions that begins at index `at`.
#[derive(Debug, Clone, Copy)]
pub struct TableVector<'a, const N: usize> {
    /// The positions.
    pub positions: &'a TablePositions<N>,
    /// Index of the first position of the vector.
    pub at: usize,
}

impl<const N: usize> TablePositions<N> {
    /// Positions before they are located.
    pub const NONE: Self = Self { rows: RowOffsets::NONE, fraction: [0.0; N], second_weights: [[0.0; N]; 2] };
}

impl CompiledCurves {
    /// Compiles the component errors of an axis. Returns `None` if periodic tables are combined with others, or if a
    /// B-spline is not piecewise cubic.
    pub fn new(errors: &JointErrors, conditions: OperatingConditions) -> Option<Self> {
        let (mut curves, mut parts, mut tables) = (Self::default(), Vec::new(), Vec::new());
        for (column, term) in errors.component.iter().enumerate() {
            match term {
                Some(ErrorTerm::Component(component)) => {
                    parts.extend(weighted_curves(column, component, conditions.approach))
                }
                Some(ErrorTerm::Constant(value)) => curves.constant[column] += value,
                Some(ErrorTerm::Tolerance(_)) | None => {}
            }
        }
        for WeightedCurve { column, weight, curve } in parts {
            match curve {
                Curve::Polynomial(c) => curves.add_polynomial(column, weight, c),
                Curve::Harmonics(orders) => curves.add_harmonics(column, weight, orders),
                Curve::Linear(_) | Curve::Cubic(..) => {
                    tables.push(WeightedCurve { column, weight, curve: curve.clone() })
                }
                Curve::BSpline(spline) => tables.push(WeightedCurve { column, weight, curve: as_cubic(spline)? }),
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
                    self.harmonics.resize(self.harmonics.len().max(order), [[0.0; 6]; 2]);
                    self.harmonics[k][0][column] += weight * cosine;
                    self.harmonics[k][1][column] += weight * sine;
                }
            }
        }
    }

    /// True if all six errors are zero everywhere.
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the curves of the errors that a linear map makes of these six.
    pub fn map_errors(mut self, map: impl Fn(&Six) -> Six) -> Self {
        self.constant = map(&self.constant);
        self.powers.iter_mut().for_each(|row| *row = map(row));
        self.harmonics.iter_mut().flatten().for_each(|row| *row = map(row));
        for TableRow(row) in self.table.iter_mut().flat_map(|table| table.rows.iter_mut().chain(&mut table.seconds)) {
            let [a, b, c, d, e, f, ..] = *row;
            row[..6].copy_from_slice(&map(&[a, b, c, d, e, f]));
        }
        self
    }

    /// Returns the curves with a constant added: to the rows of values if there is a table.
    pub fn plus(mut self, constant: &Six) -> Self {
        self.constant.iter_mut().zip(constant).for_each(|(sum, c)| *sum += c);
        if let Some(table) = &mut self.table {
            for TableRow(row) in &mut table.rows {
                row.iter_mut().zip(&self.constant).for_each(|(value, c)| *value += c);
            }
            self.constant = [0.0; 6];
        }
        self
    }

    /// True if evaluation takes the sine and cosine of the position.
    pub fn has_harmonics(&self) -> bool {
        !self.harmonics.is_empty()
    }

    /// Locates positions (mm or deg) in the table; their number is a multiple of the width of the vector.
    #[inline(always)]
    pub fn locate<V: Lanes, const N: usize>(&self, positions: &[f64], to: &mut TablePositions<N>) {
        if let Some(table) = &self.table {
            table.locate::<V, N>(positions, to);
        }
    }

    /// Returns the six errors at located positions. `turn` holds sine and cosine of the positions; only harmonics read
    /// it.
    #[inline(always)]
    pub fn at<V: Lanes, const N: usize>(&self, position: V, turn: (V, V), vector: TableVector<'_, N>) -> [V; 6] {
        let mut six = match &self.table {
            Some(table) => {
                let rows = if table.is_cubic() { table.cubic::<V, N>(vector) } else { table.linear::<V, N>(vector) };
                let [a, b, c, d, e, f, ..] = V::transpose(&rows);
                [a, b, c, d, e, f]
            }
            None => splat_six(&self.constant),
        };
        if self.powers.is_empty() && self.harmonics.is_empty() {
            return six;
        }
        if !self.powers.is_empty() {
            self.add_powers(&mut six, position);
        }
        if !self.harmonics.is_empty() {
            self.add_harmonic_terms(&mut six, turn);
        }
        six
    }

    /// True if the curves are a piecewise linear table and nothing else.
    pub fn is_linear_table(&self) -> bool {
        let straight = self.table.as_ref().is_some_and(|table| !table.is_cubic());
        straight && self.powers.is_empty() && self.harmonics.is_empty()
    }

    /// Writes two linear combinations of the six errors into the spare columns of every row.
    pub fn set_auxiliary(&mut self, auxiliary: impl Fn(&Six) -> [f64; 2]) {
        for TableRow([a, b, c, d, e, f, aside @ ..]) in self.table.iter_mut().flat_map(|table| &mut table.rows) {
            *aside = auxiliary(&[*a, *b, *c, *d, *e, *f]);
        }
    }

    /// Returns interpolated rows at located positions of a [linear table](Self::is_linear_table): the six errors and
    /// the two spare columns.
    #[inline(always)]
    pub fn rows<V: Lanes, const N: usize>(&self, vector: TableVector<'_, N>) -> [V::Row; MAX_LANES] {
        match &self.table {
            Some(table) => table.linear::<V, N>(vector),
            None => [V::Row::of(&TableRow([0.0; 8])); MAX_LANES],
        }
    }

    /// Adds the interpolated rows to those of another axis.
    #[inline(always)]
    pub fn add_rows<V: Lanes, const N: usize>(&self, rows: &mut [V::Row; MAX_LANES], vector: TableVector<'_, N>) {
        if let Some(table) = &self.table {
            table.add_linear::<V, N>(rows, vector);
        }
    }

    /// Returns the six errors at one position (mm or deg); `turn` holds its sine and cosine.
    pub fn at_position(&self, position: f64, turn: (f64, f64)) -> Six {
        let mut located = TablePositions::<1>::NONE;
        self.locate::<f64, 1>(&[position], &mut located);
        self.at(position, turn, TableVector { positions: &located, at: 0 })
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
    fn add_harmonic_terms<V: Lanes>(&self, six: &mut [V; 6], (s1, c1): (V, V)) {
        let (mut s, mut c) = (s1, c1);
        for [cosines, sines] in &self.harmonics {
            for k in 0..6 {
                six[k] = six[k].plus_times(V::splat(cosines[k]), c).plus_times(V::splat(sines[k]), s);
            }
            (s, c) = ((s * c1).plus_times(c, s1), (c * c1).minus_times(s, s1));
        }
    }
}

/// Returns vectors with the same six numbers in all lanes.
#[inline(always)]
pub fn splat_six<V: Lanes>(six: &Six) -> [V; 6] {
    let [a, b, c, d, e, f] = *six;
    [V::splat(a), V::splat(b), V::splat(c), V::splat(d), V::splat(e), V::splat(f)]
}

/// A curve with the column of its error and its weight in the sum.
struct WeightedCurve<C> {
    column: usize,
    weight: f64,
    curve: C,
}

/// Returns the curves that make up a component error approached from a side: two halves for the mean.
fn weighted_curves(column: usize, component: &ComponentError, approach: Approach) -> Vec<WeightedCurve<&Curve>> {
    let one = |weight, curve| WeightedCurve { column, weight, curve };
    match (component, approach) {
        (ComponentError::Single(curve), _) => vec![one(1.0, curve)],
        (ComponentError::Bidirectional { forward, .. }, Approach::Forward) => vec![one(1.0, forward)],
        (ComponentError::Bidirectional { reverse, .. }, Approach::Reverse) => vec![one(1.0, reverse)],
        (ComponentError::Bidirectional { forward, reverse }, Approach::Mean) => {
            vec![one(0.5, forward), one(0.5, reverse)]
        }
    }
}

/// Returns a B-spline as values and second derivatives at its knots; `None` if those jump, or if its degree is above 3.
fn as_cubic(spline: &BSpline) -> Option<Curve> {
    let second = spline.second_derivatives()?;
    Some(Curve::Cubic(spline.breaks().clone(), second))
}

/// A column of the table: a curve, and its second derivative, which is piecewise linear.
struct CurveColumn<'a> {
    column: usize,
    weight: f64,
    curve: &'a Curve,
    second: Option<Curve>,
}

impl<'a> CurveColumn<'a> {
    /// Returns `None` if the second derivatives do not fit the knots.
    fn new(WeightedCurve { column, weight, curve }: &'a WeightedCurve<Curve>) -> Option<Self> {
        let second = match curve {
            Curve::Cubic(knots, values) => {
                let points: Vec<(f64, f64)> = knots.positions().iter().copied().zip(values.iter().copied()).collect();
                Some(Curve::Linear(Knots::new(&points, knots.period()).ok()?))
            }
            _ => None,
        };
        Some(Self { column: *column, weight: *weight, curve, second })
    }

    /// True if value and second derivative agree at two positions up to rounding.
    fn same(&self, a: f64, b: f64) -> bool {
        std::iter::once(self.curve).chain(&self.second).all(|curve| {
            let values = curve.knots().map_or(&[][..], Knots::values);
            let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            (curve.value(a) - curve.value(b)).abs() <= 16.0 * f64::EPSILON * largest
        })
    }
}

impl CurveTable {
    /// Returns the table of all curves on the union of their knots; `None` if their periods differ.
    fn union(curves: &[WeightedCurve<Curve>]) -> Option<Self> {
        let all: Vec<&Knots> = curves.iter().filter_map(|weighted| weighted.curve.knots()).collect();
        let period = all.first()?.period();
        if all.iter().any(|knots| knots.period() != period) {
            return None;
        }
        let columns: Vec<CurveColumn<'_>> = curves.iter().map(CurveColumn::new).collect::<Option<_>>()?;
        let knots = union_of_knots(&all, period, &columns)?;
        let cubic = columns.iter().any(|column| column.second.is_some());
        let (mut rows, mut seconds) = (Vec::new(), Vec::new());
        for knot in &knots {
            let (mut row, mut second_row) = ([0.0; 8], [0.0; 8]);
            for CurveColumn { column, weight, curve, second } in &columns {
                row[*column] += weight * curve.value(*knot);
                second_row[*column] += weight * second.as_ref().map_or(0.0, |second| second.value(*knot));
            }
            rows.push(TableRow(row));
            if cubic {
                seconds.push(TableRow(second_row));
            }
        }
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        let period = period.map(|period| (period, 1.0 / period));
        Some(Self { rows, seconds, first, last, period, intervals: KnotIntervals::new(&knots) })
    }

    fn is_cubic(&self) -> bool {
        !self.seconds.is_empty()
    }

    /// Returns positions moved into the range of the table: by whole periods, else to the nearer end.
    #[inline(always)]
    fn within<V: Lanes>(&self, position: V) -> V {
        let (first, last) = (V::splat(self.first), V::splat(self.last));
        let x = match self.period {
            Some((period, inverse)) => {
                let distance = position - first;
                position.minus_times(nearest(V::splat(-0.5).plus_times(distance, V::splat(inverse))), V::splat(period))
            }
            None => position,
        };
        x.larger(first).smaller(last)
    }

    #[inline(always)]
    fn locate<V: Lanes, const N: usize>(&self, positions: &[f64], to: &mut TablePositions<N>) {
        to.rows.cover(self.rows.len());
        let (first, mut i) = (V::splat(self.first), 0);
        match &self.intervals {
            KnotIntervals::Uniform { per_unit, last, width } => {
                while i < positions.len() {
                    let along = (self.within(V::load(&positions[i..])) - first) * V::splat(*per_unit);
                    let (whole, interval) = along.smaller(V::splat(*last)).truncate();
                    let fraction = along - whole;
                    self.put(to, i, IntervalPoint { interval, fraction, width: V::splat(*width) });
                    i += V::COUNT;
                }
            }
            KnotIntervals::Bucketed { buckets, rows } => {
                while i < positions.len() {
                    let x = self.within(V::load(&positions[i..]));
                    self.put(to, i, find_by_bucket(rows, &buckets.indices(x - first), x));
                    i += V::COUNT;
                }
            }
            KnotIntervals::Searched { buckets, starts, knots } => {
                while i < positions.len() {
                    let x = self.within(V::load(&positions[i..]));
                    let indices = buckets.indices(x - first);
                    let IntervalPoint { interval, fraction, width } =
                        find_by_search(starts, knots, &indices, &x.to_array(), V::COUNT);
                    let (fraction, width) = (V::load(&fraction), V::load(&width));
                    self.put(to, i, IntervalPoint { interval, fraction, width });
                    i += V::COUNT;
                }
            }
        }
    }

    /// Writes a vector of located positions from index i on.
    #[inline(always)]
    fn put<V: Lanes, const N: usize>(&self, to: &mut TablePositions<N>, i: usize, point: IntervalPoint<V>) {
        // The mask changes nothing; it shows the compiler that the vector lies within the array.
        let i = i & (N - V::COUNT);
        let IntervalPoint { interval, fraction, width } = point;
        to.rows.put::<V>(i, &interval);
        fraction.store(&mut to.fraction[i..]);
        if self.is_cubic() {
            let (scale, rest) = (width * width * V::splat(1.0 / 6.0), V::splat(1.0) - fraction);
            ((rest * rest * rest - rest) * scale).store(&mut to.second_weights[0][i..]);
            ((fraction * fraction * fraction - fraction) * scale).store(&mut to.second_weights[1][i..]);
        }
    }

    /// Returns the rows interpolated linearly.
    #[inline(always)]
    fn linear<V: Lanes, const N: usize>(
        &self,
        TableVector { positions, at }: TableVector<'_, N>,
    ) -> [V::Row; MAX_LANES] {
        let fraction = &positions.fraction[at..at + V::COUNT];
        let mut rows = [V::Row::of(&self.rows[0]); MAX_LANES];
        for lane in 0..V::COUNT {
            let (low, high) = positions.rows.row_pair(&self.rows, at + lane);
            let (low, high) = (V::Row::of(low), V::Row::of(high));
            rows[lane] = low.plus_times(high.minus(low), fraction[lane]);
        }
        rows
    }

    /// Adds the rows interpolated linearly.
    #[inline(always)]
    fn add_linear<V: Lanes, const N: usize>(
        &self,
        rows: &mut [V::Row; MAX_LANES],
        TableVector { positions, at }: TableVector<'_, N>,
    ) {
        let fraction = &positions.fraction[at..at + V::COUNT];
        for lane in 0..V::COUNT {
            let (low, high) = positions.rows.row_pair(&self.rows, at + lane);
            let (low, high) = (V::Row::of(low), V::Row::of(high));
            rows[lane] = rows[lane].plus(low).plus_times(high.minus(low), fraction[lane]);
        }
    }

    /// Returns the rows interpolated by cubic pieces, from values and second derivatives at both knots.
    #[inline(always)]
    fn cubic<V: Lanes, const N: usize>(
        &self,
        TableVector { positions, at }: TableVector<'_, N>,
    ) -> [V::Row; MAX_LANES] {
        let fraction = &positions.fraction[at..at + V::COUNT];
        let [low_weight, high_weight] = positions.second_weights.each_ref().map(|weights| &weights[at..at + V::COUNT]);
        let mut rows = [V::Row::of(&self.rows[0]); MAX_LANES];
        for lane in 0..V::COUNT {
            let (low, high) = positions.rows.row_pair(&self.rows, at + lane);
            let (low_second, high_second) = positions.rows.row_pair(&self.seconds, at + lane);
            let (low, high) = (V::Row::of(low), V::Row::of(high));
            let with_low =
                low.plus_times(high.minus(low), fraction[lane]).plus_times(V::Row::of(low_second), low_weight[lane]);
            rows[lane] = with_low.plus_times(V::Row::of(high_second), high_weight[lane]);
        }
        rows
    }
}

/// Returns all knots in rising order, at least two; of a periodic axis those of one period from the start of the first
/// table.
fn union_of_knots(all: &[&Knots], period: Option<f64>, columns: &[CurveColumn<'_>]) -> Option<Vec<f64>> {
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
    // Knots that differ by rounding alone are one; a step between two is none.
    let near = |a: f64, b: f64| b - a <= 4.0 * f64::EPSILON * largest;
    knots.dedup_by(|b, a| a == b || near(*a, *b) && columns.iter().all(|column| column.same(*a, *b)));
    if let [single] = knots[..] {
        knots.push(single + 1.0);
    }
    Some(knots)
}
