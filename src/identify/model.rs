//! The measurement model: what the machine with given parameters would have been measured as, exactly, and the
//! derivatives by the parameters. Rows are streamed into a triangle; the Jacobian as a whole never exists.

use super::measurement::Measurement;
use super::parameter::Parameter;
use crate::algebra::linear::{Reduced, Triangle};
use crate::evaluate::Frame;
use crate::lower::{Ideal, Place, Source, Values, actual_point, tangents, values};
use crate::machine::{Approach, Machine};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Machine, parameters and the frame in which deviations were measured.
pub struct Model<'a> {
    machines: Vec<Machine>,
    parameters: &'a [Parameter],
    /// Every error that a parameter moves, each once.
    sources: Vec<Source>,
    /// Terms of each parameter as (index in `sources`, index of the term).
    links: Vec<Vec<(usize, usize)>>,
    frame: Frame,
}

impl<'a> Model<'a> {
    /// A model of a machine; deviations are given in `frame`.
    pub fn new(machine: &Machine, parameters: &'a [Parameter], frame: Frame) -> Self {
        let mut sources: Vec<Source> = Vec::new();
        let mut index = |source: Source| {
            sources.iter().position(|known| *known == source).unwrap_or_else(|| {
                sources.push(source);
                sources.len() - 1
            })
        };
        let links = parameters
            .iter()
            .map(|p| p.terms.iter().enumerate().map(|(k, term)| (index(term.source), k)).collect())
            .collect();
        let with = |name: &str| machine.with_tool(name).unwrap_or_else(|| machine.clone());
        let machines = machine.tools().iter().map(|tool| with(&tool.name)).collect();
        Self { machines, parameters, sources, links, frame }
    }

    /// The parameters.
    pub fn parameters(&self) -> &[Parameter] {
        self.parameters
    }

    /// The machine with each of its tools.
    pub fn machines(&self) -> &[Machine] {
        &self.machines
    }

    /// The machine with the tool of a measurement.
    pub fn machine(&self, measurement: &Measurement) -> &Machine {
        &self.machines[measurement.tool]
    }

    /// The errors at a measurement's pose: fitted sources by the parameters, the others as the machine file says.
    pub fn errors(&self, measurement: &Measurement, theta: &[f64]) -> Values {
        let pose = &measurement.pose;
        let mut errors = values(self.machine(measurement), pose, Approach::Mean);
        for source in &self.sources {
            *slot(&mut errors, *source) = 0.0;
        }
        for (parameter, value) in self.parameters.iter().zip(theta) {
            for term in &parameter.terms {
                *slot(&mut errors, term.source) += value * term.factor * term.basis.value(position(pose, term.source));
            }
        }
        errors
    }

    /// Rotation from the workpiece frame to that of the measurement, and the nominal point from the workpiece origin.
    fn nominal(&self, measurement: &Measurement) -> (Matrix3<f64>, Vector3<f64>) {
        let ideal = Ideal::at(self.machine(measurement), &measurement.pose);
        let rotation = match self.frame {
            Frame::Workpiece => Matrix3::identity(),
            Frame::Machine => ideal.r_work,
            Frame::Tool => ideal.pose.linear.transpose(),
        };
        (rotation, ideal.pose.translation)
    }

    /// Rotation from the workpiece frame to the frame in which a measurement's deviation is given.
    pub fn to_frame(&self, measurement: &Measurement) -> Matrix3<f64> {
        self.nominal(measurement).0
    }

    /// The deviation (mm, in the frame of the measurement) that the machine with these parameters has.
    pub fn predicted(&self, measurement: &Measurement, theta: &[f64]) -> Vector3<f64> {
        let errors = self.errors(measurement, theta);
        let (rotation, nominal) = self.nominal(measurement);
        rotation * (actual_point(self.machine(measurement), &measurement.pose, &errors) - nominal)
    }

    /// Measured minus predicted (mm); 0 where nothing was measured.
    pub fn residual(&self, measurement: &Measurement, theta: &[f64]) -> Vector3<f64> {
        let predicted = self.predicted(measurement, theta);
        Vector3::from_fn(|i, _| measurement.deviation[i].map_or(0.0, |measured| measured - predicted[i]))
    }

    /// Residuals of all measurements.
    pub fn residuals(&self, data: &[Measurement], theta: &[f64]) -> Vec<Vector3<f64>> {
        data.par_iter().map(|m| self.residual(m, theta)).collect()
    }

    /// The linear problem at these parameters: `min |J step - residual|`, rows times the root of their weights.
    pub fn linearised(&self, data: &[Measurement], weights: &[f64], theta: &[f64]) -> Reduced {
        // The pieces do not depend on the number of threads, nor does the order in which they are joined.
        let piece = data.len().div_ceil(16).clamp(32, 4096);
        let pieces: Vec<Triangle> = data
            .par_chunks(piece)
            .zip(weights.par_chunks(piece))
            .map(|(data, weights)| self.piece(data, weights, theta))
            .collect();
        let mut whole = Triangle::new(self.parameters.len());
        pieces.into_iter().for_each(|piece| whole.merge(piece));
        whole.finish()
    }

    fn piece(&self, data: &[Measurement], weights: &[f64], theta: &[f64]) -> Triangle {
        let mut triangle = Triangle::new(self.parameters.len());
        for (measurement, weight) in data.iter().zip(weights) {
            let (columns, residual) = self.rows(measurement, theta);
            let root = weight.sqrt();
            for i in (0..3).filter(|i| measurement.deviation[*i].is_some()) {
                triangle.push(columns.iter().map(|column| column[i] * root), residual[i] * root);
            }
        }
        triangle
    }

    /// Derivative of the predicted deviation by each parameter, and the residual.
    pub(super) fn rows(&self, measurement: &Measurement, theta: &[f64]) -> (Vec<Vector3<f64>>, Vector3<f64>) {
        let pose = &measurement.pose;
        let errors = self.errors(measurement, theta);
        let at = tangents(self.machine(measurement), pose, &errors, &self.sources);
        let (rotation, nominal) = self.nominal(measurement);
        let predicted = rotation * (at.point - nominal);
        let residual = Vector3::from_fn(|i, _| measurement.deviation[i].map_or(0.0, |d| d - predicted[i]));
        let column = |(parameter, links): (&Parameter, &Vec<(usize, usize)>)| {
            let moved = |(source, k): &(usize, usize)| {
                let term = &parameter.terms[*k];
                at.derivatives[*source] * (term.factor * term.basis.value(position(pose, term.source)))
            };
            rotation * links.iter().map(moved).sum::<Vector3<f64>>()
        };
        (self.parameters.iter().zip(&self.links).map(column).collect(), residual)
    }
}

/// The position on which a source's curve depends (mm or deg).
fn position(pose: &[f64], source: Source) -> f64 {
    if let Place::Component(axis) = source.place { pose[axis] } else { 0.0 }
}

/// The number of a source among the errors.
fn slot(errors: &mut Values, source: Source) -> &mut f64 {
    let k = source.direction.index();
    match source.place {
        Place::Location(i) if i < errors.axes.len() => &mut errors.axes[i].0[k],
        Place::Location(_) => &mut errors.spindle.get_or_insert([0.0; 6])[k],
        Place::Component(i) => &mut errors.axes[i].1[k],
        Place::Tool => &mut errors.tool[k % 3],
        Place::Workpiece => &mut errors.workpiece[k],
    }
}
