//! The measurement model: what the machine with given parameters would have been measured as, exactly or to an order
//! of the dual numbers, and the derivatives by the unknowns. Rows are streamed; the Jacobian as a whole never exists.

use super::gauge::Gauge;
use super::known::PriorValue;
use super::observation::{Observation, ReadingSubject, observe, rotate, single};
use super::parameter::{BasisFunction, Clamping, Parameter, ParameterTerm, SlopeBound, approach_weight};
use crate::algebra::linear::{ReducedSystem, Triangle};
use crate::algebra::{Algebra, Dual, hat};
use crate::evaluate::Order;
use crate::identify::data::{Measurement, tool_axis};
use crate::identify::lists::index_of;
use crate::lower::{
    ErrorLift, ErrorSite, ErrorValues, Exact, NominalPose, OrderN, PositionJacobian, Source, direction_jacobian, point,
    position_jacobian, values,
};
use crate::machine::{Approach, LocationOrder, Machine};
use crate::run::Advance;
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use rayon::prelude::*;

/// Number of triangles that are there at a time.
const MAX_TRIANGLES: usize = 16;

/// Machine and unknowns: parameters of the machine first, then those of the instruments.
#[derive(Clone)]
pub struct FitModel<'a> {
    machines: Vec<Machine>,
    parameters: &'a [Parameter],
    /// Number of the machine's parameters, which come first.
    own: usize,
    /// Every error that a parameter moves, each once.
    sources: Vec<Source>,
    /// The functions of the pose by which they do, with their axis, each once; the first is 1.
    functions: Vec<(usize, BasisFunction)>,
    /// The terms of the machine's parameters.
    links: Vec<TermLink>,
    order: Order,
    /// Slopes of fitted curves over the standard deviations allowed: rows, one coefficient for each unknown.
    slopes: DMatrix<f64>,
    /// Values that are known before the data, with their uncertainty.
    known: Vec<PriorValue>,
    /// Distances between points of the set-up that are known before the data.
    gauges: Vec<Gauge>,
    /// True if location errors count in the real part.
    real_locations: bool,
    /// The motion of the workpiece from its place in the machine; `None` without one.
    stand: Option<RigidMotion>,
    /// Receives the number of measurements evaluated.
    progress: Advance<'a>,
}

/// A rigid motion of points in the workpiece frame: rotation about its origin, then translation (mm).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// Rotation about the origin.
    pub rotation: Rotation3<f64>,
    /// Translation, mm.
    pub translation: Vector3<f64>,
}

/// Effect of a parameter on a source: factor times function. Indices are those of the model's lists.
#[derive(Debug, Clone)]
struct TermLink {
    parameter: usize,
    source: usize,
    function: usize,
    factor: f64,
    approach: Approach,
    only: Option<Clamping>,
}

impl TermLink {
    fn acts_on(&self, m: &Measurement) -> bool {
        self.only.as_ref().is_none_or(|clamped| clamped.holds(m))
    }
}

/// A predicted reading and its derivatives; the first [`Measurement::reading_mask`] components count.
struct Linearisation {
    predicted: Vector3<f64>,
    by_parameter: Vec<Vector3<f64>>,
    /// By unknowns of instruments: index and derivative.
    by_nuisance: Vec<(usize, Vector3<f64>)>,
}

/// An algebra in which the model is computed.
trait Scheme: Algebra {
    type Lift: ErrorLift<Self>;
    const LIFT: Self::Lift;
    /// Returns the sum of all degrees.
    fn total(&self) -> f64 {
        self.real() + self.nilpotent_sum()
    }
    /// Returns the sum of those degrees of a derivative that belong to the truncated model.
    fn slope(&self, real: bool) -> f64;
}

impl Scheme for f64 {
    type Lift = Exact;
    const LIFT: Exact = Exact;
    fn slope(&self, _: bool) -> f64 {
        *self
    }
}

impl<const M: usize> Scheme for Dual<M> {
    type Lift = OrderN;
    const LIFT: OrderN = OrderN;
    fn slope(&self, real: bool) -> f64 {
        // The derivative by a first-order error has one degree less; the real part does not count among degrees.
        if real { self.total() } else { self.0[..M - 1].iter().rev().sum() }
    }
}

impl<'a> FitModel<'a> {
    /// Returns the exact model of a machine.
    pub fn new(machine: &Machine, parameters: &'a [Parameter]) -> Self {
        let (mut sources, mut functions) = (Vec::new(), vec![(0, BasisFunction::Constant)]);
        let mut link = |parameter: usize, term: &ParameterTerm| {
            let axis = if let ErrorSite::Component(axis) = term.source.place { axis } else { 0 };
            let function = match &term.basis {
                BasisFunction::Constant => 0,
                basis => index_of(&mut functions, (axis, basis.clone())),
            };
            let source = index_of(&mut sources, term.source);
            let (factor, approach, only) = (term.factor, term.approach, term.only.clone());
            TermLink { parameter, source, function, factor, approach, only }
        };
        let terms = parameters.iter().enumerate().flat_map(|(j, p)| p.terms.iter().map(move |term| (j, term)));
        let links = terms.map(|(j, term)| link(j, term)).collect();
        let with = |name: &str| machine.with_tool(name).unwrap_or_else(|| machine.clone());
        let machines = machine.tools().iter().map(|tool| with(&tool.name)).collect();
        let own = parameters.iter().position(Parameter::is_nuisance).unwrap_or(parameters.len());
        let slopes = DMatrix::zeros(0, parameters.len());
        let real_locations = machine.conventions().location_order == LocationOrder::Real;
        let (order, known) = (Order::Exact, Vec::new());
        let progress = &|_| Ok(());
        let stand = None;
        Self {
            machines,
            parameters,
            own,
            sources,
            functions,
            links,
            order,
            slopes,
            known,
            gauges: Vec::new(),
            real_locations,
            stand,
            progress,
        }
    }

    /// Returns the model of the same machine with other unknowns.
    pub(crate) fn with_parameters<'b>(&self, parameters: &'b [Parameter]) -> FitModel<'b> {
        let mut other = FitModel::new(&self.machines[0], parameters);
        (other.machines, other.order) = (self.machines.clone(), self.order);
        other
    }

    /// Returns the same to an order of the dual numbers (1 or 2; others count as exact).
    pub fn to_order(mut self, order: Order) -> Self {
        self.order = order;
        self
    }

    /// Returns the same with all points of the machine moved in the workpiece frame.
    pub(crate) fn moved(mut self, stand: RigidMotion) -> Self {
        self.stand = Some(stand);
        self
    }

    /// Returns the same with curves that are held flat by these bounds.
    pub fn with_slope_bounds(mut self, bounds: &[SlopeBound]) -> Self {
        let rows: Vec<Vec<f64>> = bounds.iter().flat_map(|bound| bound.rows(self.parameters)).collect();
        self.slopes = DMatrix::from_fn(rows.len(), self.parameters.len(), |i, j| rows[i][j]);
        self
    }

    /// Returns the same, which reports how many measurements were evaluated.
    pub fn with_progress(mut self, progress: Advance<'a>) -> Self {
        self.progress = progress;
        self
    }

    /// True if the job is cancelled.
    pub fn is_cancelled(&self) -> bool {
        (self.progress)(0).is_err()
    }

    /// Returns the same with unknowns of which values are known before the data.
    pub fn with_known(mut self, known: &[PriorValue]) -> Self {
        self.known = known.to_vec();
        self
    }

    /// Returns the same with distances between points of the set-up that are known before the data.
    pub fn with_gauges(mut self, gauges: &[Gauge]) -> Self {
        self.gauges = gauges.to_vec();
        self
    }

    /// Returns the distances known before the data.
    pub(crate) fn gauges(&self) -> &[Gauge] {
        &self.gauges
    }

    /// Returns the values known before the data.
    pub(crate) fn known(&self) -> &[PriorValue] {
        &self.known
    }

    /// Returns the values and distances known before the data as equations that are linear about these unknowns: rows
    /// over their standard uncertainty, and the right sides.
    pub(crate) fn known_rows(&self, theta: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.known.len() + self.gauges.len();
        let (mut rows, mut values) = (DMatrix::zeros(count, self.parameters.len()), DVector::zeros(count));
        for (i, known) in self.known.iter().enumerate() {
            (rows[(i, known.unknown)], values[i]) = (1.0 / known.sigma, known.value / known.sigma);
        }
        for (i, gauge) in (self.known.len()..).zip(&self.gauges) {
            let (row, value) = gauge.row(theta);
            row.into_iter().for_each(|(j, share)| rows[(i, j)] = share);
            values[i] = value;
        }
        (rows, values)
    }

    /// Returns the slopes over their standard deviations: rows, linear in the unknowns.
    pub(crate) fn slope_rows(&self) -> &DMatrix<f64> {
        &self.slopes
    }

    /// Returns the unknowns, the machine's first.
    pub fn parameters(&self) -> &[Parameter] {
        self.parameters
    }

    /// Returns the values of the unknowns from which a fit starts.
    pub fn start(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.start).collect()
    }

    /// Returns the number of unknowns that are the machine's.
    pub fn own(&self) -> usize {
        self.own
    }

    /// Returns the machine with each of its tools.
    pub fn machines(&self) -> &[Machine] {
        &self.machines
    }

    /// Returns the machine with the tool of a measurement.
    pub fn machine(&self, measurement: &Measurement) -> &Machine {
        &self.machines[measurement.tool]
    }

    /// Returns for each link the effect of a unit of its parameter on its source: `weight factor basis(q)`.
    fn shares(&self, m: &Measurement, pose: &[f64]) -> Vec<f64> {
        let functions: Vec<f64> = self.functions.iter().map(|(axis, basis)| basis.value(pose[*axis])).collect();
        let share = |l: &TermLink| match l.acts_on(m) {
            true => approach_weight(l.approach, m.approach) * l.factor * functions[l.function],
            false => 0.0,
        };
        self.links.iter().map(share).collect()
    }

    /// Returns the errors at a pose: fitted sources by the parameters, the others as the machine file says.
    fn errors(&self, measurement: &Measurement, pose: &[f64], theta: &[f64], shares: &[f64]) -> ErrorValues {
        let mut errors = values(self.machine(measurement), &measurement.approach.at_pose(pose));
        let mut sums = vec![None; self.sources.len()];
        for (link, share) in self.links.iter().zip(shares).filter(|(link, _)| link.acts_on(measurement)) {
            *sums[link.source].get_or_insert(0.0) += theta[link.parameter] * share;
        }
        for (source, sum) in self.sources.iter().zip(sums) {
            sum.into_iter().for_each(|sum| *slot(&mut errors, *source) = sum);
        }
        errors
    }

    /// Returns derivatives by the parameters of the machine from those by the sources (chain rule).
    fn by_parameter(&self, by_source: &[Vector3<f64>], shares: &[f64]) -> Vec<Vector3<f64>> {
        let mut by = vec![Vector3::zeros(); self.own];
        for (link, share) in self.links.iter().zip(shares) {
            by[link.parameter] += by_source[link.source] * *share;
        }
        by
    }

    /// Returns the reading (mm, its own frame) where `at` gives its subjects.
    fn observe<S: Algebra>(
        &self,
        m: &Measurement,
        theta: &[f64],
        at: impl FnMut(ReadingSubject<'_>) -> Vector3<S>,
    ) -> Observation<S> {
        observe(self.machine(m), m, &theta[self.own..], at)
    }

    /// Returns a point of the machine where the workpiece stands.
    fn placed<S: Scheme>(&self, point: Vector3<S>) -> Vector3<S> {
        let Some(stand) = &self.stand else { return point };
        self.turned(point).zip_map(&stand.translation, |x, t| x + S::from_real(t))
    }

    /// Returns a displacement of such a point.
    fn turned<S: Scheme>(&self, displacement: Vector3<S>) -> Vector3<S> {
        let Some(stand) = &self.stand else { return displacement };
        rotate(stand.rotation.matrix(), &displacement)
    }

    /// Returns the deviation of the orientation at a pose, or the axis of the tool, where the workpiece stands, and the
    /// derivatives by `sources`.
    fn orientation<S: Scheme>(
        &self,
        m: &Measurement,
        pose: &[f64],
        errors: &ErrorValues,
        sources: &[Source],
        of_axis: bool,
    ) -> PositionJacobian<S> {
        let machine = self.machine(m);
        let zero = || Vector3::from_fn(|_, _| S::zero());
        let mut sum = PositionJacobian { point: zero(), derivatives: vec![zero(); sources.len()] };
        let nominal = NominalPose::in_part(machine, pose).pose.linear;
        for k in if of_axis { 0..1 } else { 0..3 } {
            let direction = if of_axis { Vector3::from(machine.tool().direction) } else { Vector3::ith(k, 1.0) };
            let image = direction_jacobian(machine, pose, errors, &S::LIFT, sources, &direction);
            // Of the matrix with columns r where the nominal one has n, 1/2 sum n x r is the vector of the skew part.
            let map = hat(&nominal.column(k).into_owned().into()) * 0.5;
            let part = |x: Vector3<S>| if of_axis { self.turned(x) } else { rotate(&map, &self.turned(x)) };
            sum.point += part(image.point);
            sum.derivatives.iter_mut().zip(image.derivatives).for_each(|(sum, d)| *sum += part(d));
        }
        sum
    }

    /// Returns the predicted reading over an algebra.
    fn reading<S: Scheme>(&self, m: &Measurement, theta: &[f64]) -> Vector3<S> {
        let errors = |pose: &[f64]| self.errors(m, pose, theta, &self.shares(m, pose));
        let at = |subject: ReadingSubject<'_>| match subject {
            ReadingSubject::Point(pose) => self.placed(point(self.machine(m), pose, &errors(pose), &S::LIFT)),
            ReadingSubject::Turn(pose) => self.orientation(m, pose, &errors(pose), &[], false).point,
            ReadingSubject::Axis(pose) => self.orientation(m, pose, &errors(pose), &[], true).point,
            ReadingSubject::Error(source) => single(S::LIFT.lift(source, errors(&m.pose).of(source))),
        };
        self.observe(m, theta, at).value
    }

    /// Returns the reading of the machine with these unknowns (mm, in the frame of the reading).
    pub fn prediction(&self, m: &Measurement, theta: &[f64]) -> Vector3<f64> {
        match self.order {
            Order::Degree(1) => self.reading::<Dual<2>>(m, theta).map(|x| x.total()),
            Order::Degree(2) => self.reading::<Dual<3>>(m, theta).map(|x| x.total()),
            _ => self.reading::<f64>(m, theta),
        }
    }

    /// Returns the part that errors add to the nominal machine's reading: the first- and second-order part, and all
    /// higher ones together where the exact reading is `exact`.
    pub fn orders(&self, m: &Measurement, theta: &[f64], exact: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let parts = self.reading::<Dual<3>>(m, theta);
        let nominal = self.nominal_reading(m, theta);
        // With location errors of order 0 the real part differs from the nominal one: it counts as first order.
        let first = parts.zip_map(&nominal, |x, nominal| x.0[1] + (x.0[0] - nominal));
        let second = parts.map(|x| x.0[2]);
        [first, second, exact - nominal - first - second]
    }

    /// Returns the first degree (with what location errors of order 0 do) and the second degree of what would be read.
    pub(crate) fn first_two_orders(&self, m: &Measurement, theta: &[f64]) -> [Vector3<f64>; 2] {
        let [first, second, _] = self.orders(m, theta, &Vector3::zeros());
        [first, second]
    }

    fn nominal_reading(&self, m: &Measurement, theta: &[f64]) -> Vector3<f64> {
        let at = |subject: ReadingSubject<'_>| match subject {
            ReadingSubject::Point(pose) => NominalPose::in_part(self.machine(m), pose).pose.translation,
            ReadingSubject::Axis(pose) => tool_axis(self.machine(m), &NominalPose::in_part(self.machine(m), pose)),
            ReadingSubject::Turn(_) | ReadingSubject::Error(_) => Vector3::zeros(),
        };
        self.observe(m, theta, at).value
    }

    /// Returns measured minus predicted reading (mm); 0 for components that were not read.
    pub fn residual(&self, measurement: &Measurement, theta: &[f64]) -> Vector3<f64> {
        zero_unread(measurement, measurement.values() - self.prediction(measurement, theta))
    }

    /// Returns the residuals of all measurements.
    pub fn residuals(&self, data: &[Measurement], theta: &[f64]) -> Vec<Vector3<f64>> {
        data.par_iter().map(|m| self.residual(m, theta)).collect()
    }

    /// Returns the linear problem at these unknowns, `min |J step - residual|`, rows times the root of their weights:
    /// the triangle of all rows, whose singular values are good to the last digits. Rows are folded piece by piece;
    /// neither the pieces
    /// nor their order depend on the number of threads.
    pub fn triangle(&self, data: &[Measurement], weights: &[f64], theta: &[f64]) -> ReducedSystem {
        let piece = data.len().div_ceil(16).clamp(32, 4096);
        let one = |(data, weights): (&[Measurement], &[f64])| {
            let mut sum = Triangle::new(self.parameters.len());
            // A cancelled job has no result: what is left of this one is skipped.
            if self.is_cancelled() {
                return sum;
            }
            for (measurement, weight) in data.iter().zip(weights) {
                self.fill(measurement, libm::sqrt(*weight), theta, sum.extend(measurement.readings()));
            }
            let _ = (self.progress)(data.len());
            sum
        };
        let mut whole = Triangle::new(self.parameters.len());
        // A triangle of many unknowns is large: few of them are there at a time.
        let together = MAX_TRIANGLES * piece;
        for (data, weights) in data.chunks(together).zip(weights.chunks(together)) {
            let pieces: Vec<Triangle> = data.par_chunks(piece).zip(weights.par_chunks(piece)).map(one).collect();
            pieces.into_iter().for_each(|piece| whole.merge(piece));
        }
        whole.finish()
    }

    /// Writes the rows of a measurement, times `root`: coefficients, then the residual.
    fn fill(&self, m: &Measurement, root: f64, theta: &[f64], rows: &mut [f64]) {
        let linear = match self.order {
            Order::Degree(1) => self.linearise::<Dual<2>>(m, theta),
            Order::Degree(2) => self.linearise::<Dual<3>>(m, theta),
            _ => self.linearise::<f64>(m, theta),
        };
        let width = self.parameters.len() + 1;
        let residual = m.values() - linear.predicted;
        let seen = m.reading_mask();
        for (row, k) in rows.chunks_mut(width).zip((0..3).filter(|k| seen[*k])) {
            row.iter_mut().zip(&linear.by_parameter).for_each(|(place, derivative)| *place = derivative[k] * root);
            for (index, derivative) in &linear.by_nuisance {
                row[self.own + index] = derivative[k] * root;
            }
            row[width - 1] = residual[k] * root;
        }
    }

    /// Returns the derivative of the predicted reading by each unknown, and the residual.
    pub(crate) fn rows(&self, m: &Measurement, theta: &[f64]) -> (Vec<Vector3<f64>>, Vector3<f64>) {
        let width = self.parameters.len() + 1;
        let mut rows = vec![0.0; m.readings() * width];
        self.fill(m, 1.0, theta, &mut rows);
        let seen: Vec<usize> = (0..3).filter(|k| m.reading_mask()[*k]).collect();
        let column = |j: usize| {
            let mut column = Vector3::zeros();
            seen.iter().enumerate().for_each(|(i, k)| column[*k] = rows[i * width + j]);
            column
        };
        ((0..width - 1).map(column).collect(), column(width - 1))
    }

    /// Returns the part of a derivative by a source that counts.
    fn slope<S: Scheme>(&self, source: Source, x: &S) -> f64 {
        x.slope(self.real_locations && matches!(source.place, ErrorSite::Location(_)))
    }

    /// Returns the predicted reading and its derivatives. A length between two poses has two subjects, near and far
    /// end; its derivative is that of the near one minus that of the far one.
    fn linearise<S: Scheme>(&self, m: &Measurement, theta: &[f64]) -> Linearisation {
        // For each subject: derivatives by the sources, and the effects of the parameters on the sources there.
        let mut derivatives: Vec<(Vec<Vector3<S>>, Vec<f64>)> = Vec::new();
        let observed = self.observe(m, theta, |subject| {
            let pose = subject.pose().unwrap_or(&m.pose);
            let shares = self.shares(m, pose);
            let errors = self.errors(m, pose, theta, &shares);
            let (point, by_source) = match subject {
                ReadingSubject::Point(pose) => {
                    let jacobian = position_jacobian(self.machine(m), pose, &errors, &S::LIFT, &self.sources);
                    let turned = jacobian.derivatives.into_iter().map(|d| self.turned(d)).collect();
                    (self.placed(jacobian.point), turned)
                }
                ReadingSubject::Turn(_) | ReadingSubject::Axis(_) => {
                    let of_axis = matches!(subject, ReadingSubject::Axis(_));
                    let PositionJacobian { point, derivatives } =
                        self.orientation(m, pose, &errors, &self.sources, of_axis);
                    (point, derivatives)
                }
                ReadingSubject::Error(source) => {
                    let by = |s: &Source| single(if *s == source { S::one() } else { S::zero() });
                    (single(S::LIFT.lift(source, errors.of(source))), self.sources.iter().map(by).collect())
                }
            };
            derivatives.push((by_source, shares));
            point
        });
        let by_subject = |(by_source, shares): &(Vec<Vector3<S>>, Vec<f64>)| {
            let by = |(s, d): (&Source, &Vector3<S>)| observed.slope.of(d, |x| self.slope(*s, x));
            self.by_parameter(&self.sources.iter().zip(by_source).map(by).collect::<Vec<_>>(), shares)
        };
        let minus =
            |near: Vec<Vector3<f64>>, far: Vec<Vector3<f64>>| near.iter().zip(&far).map(|(a, b)| a - b).collect();
        Linearisation {
            predicted: observed.value.map(|x| x.total()),
            by_parameter: derivatives.iter().map(by_subject).reduce(minus).unwrap_or_default(),
            by_nuisance: observed.by_unknown,
        }
    }
}

/// Sets components that were not read to 0.
pub(crate) fn zero_unread(m: &Measurement, v: Vector3<f64>) -> Vector3<f64> {
    let seen = m.reading_mask();
    Vector3::from_fn(|k, _| if seen[k] { v[k] } else { 0.0 })
}

/// Returns the number of a source among the errors.
fn slot(errors: &mut ErrorValues, source: Source) -> &mut f64 {
    let k = source.direction.index();
    match source.place {
        ErrorSite::Location(i) if i < errors.axes.len() => &mut errors.axes[i].location[k],
        ErrorSite::Location(_) => &mut errors.spindle.get_or_insert([0.0; 6])[k],
        ErrorSite::Component(i) => &mut errors.axes[i].component[k],
        ErrorSite::Tool => &mut errors.tool[k % 3],
        ErrorSite::Workpiece => &mut errors.workpiece[k],
    }
}
