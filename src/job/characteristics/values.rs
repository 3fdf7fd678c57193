//! Characteristics as deviations, uncertainties and bounds lead to them.

use super::resolved::{JobCharacteristic, JobCharacteristics};
use super::result::{CharacteristicPart, CharacteristicResult, DrawnCharacteristic};
use crate::analysis::budget::{Bound, DrawnFigure, Draws, FiguresRequest, Percentile, Proportion, draw_figures};
use crate::analysis::reference::{ErrorEffects, PartReference};
use crate::analysis::zone::{Characteristic, PointWeight};
use crate::analysis::{UncertainDeviations, uncertain_parts};
use crate::evaluate::{Deviation, Field, Statistics};
use crate::machine::{ErrorTerm, Machine, OperatingConditions};
use crate::run::{Call, Refused};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Number of errors named for a characteristic.
const NAMED: usize = 5;

/// A field whose deviations make the characteristics.
#[derive(Clone, Copy)]
pub(crate) struct ValuedField<'a> {
    /// The field, without what the set-up of the part takes out.
    pub field: &'a dyn Field,
    /// The conditions.
    pub conditions: OperatingConditions,
    /// The reference of the part, which its set-up takes out of the effects of single errors too.
    pub removed: Option<&'a PartReference>,
    /// True if it is the machine without compensation, whose errors can be named.
    pub bare: bool,
    /// Seed of the draws of uncertainties.
    pub seed: u64,
}

/// Machines drawn between bounds.
#[derive(Clone, Copy)]
pub(crate) struct DrawnRequest<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Its bounds, at least one.
    pub bounds: &'a [Bound],
    /// The reference of the part, which its set-up takes out.
    pub removed: Option<&'a PartReference>,
    /// The generator.
    pub draws: &'a Draws,
    /// Number of machines.
    pub samples: usize,
    /// The deviations of errors with values, which every machine has besides; `None` without such errors.
    pub values: Option<&'a dyn Field>,
}

impl JobCharacteristics {
    /// Returns the characteristics by the deviations of a field.
    pub(crate) fn values(&self, of: ValuedField<'_>) -> Vec<CharacteristicResult> {
        let machine = of.field.machine();
        let at = |pose: &Vec<f64>| of.field.deviation(&of.conditions.at_pose(pose));
        let deviations: Vec<Deviation> = self.poses.par_iter().map(at).collect();
        let positions: Vec<Vector3<f64>> = deviations.iter().map(|d| d.position).collect();
        let effects = of.bare.then(|| ErrorEffects::new(machine, of.conditions, of.removed)).flatten();
        let intervals = self.intervals(of, &deviations);
        let one = |(i, job): (usize, &JobCharacteristic)| {
            let mut result = job.empty();
            let Ok(characteristic) = &job.of else { return result };
            let [feature, datum] = job.part(&positions);
            let um = |mm: f64| mm * 1e3;
            let widths = characteristic.widths(&feature, &datum);
            result.value_um = Some(um(widths.value));
            result.minimum_zone_um = widths.minimum_zone.map(um);
            result.least_squares_um = widths.least_squares.map(um);
            let holds = job.stated.tolerance_mm.map(|tolerance| widths.value <= tolerance);
            // The points out of reach may exceed it.
            result.holds = holds.filter(|holds| !holds || job.unreached == 0);
            result.interval_um = intervals.as_ref().and_then(|list| list[i]);
            if let Some(effects) = &effects {
                let weights = characteristic.weights(&feature, &datum);
                result.errors = self.parts(machine, effects, job, &weights, widths.value);
            }
            result
        };
        self.list.iter().enumerate().map(one).collect()
    }

    /// Returns the parts of errors with values in a characteristic (mm), largest first.
    fn parts(
        &self,
        machine: &Machine,
        effects: &ErrorEffects<'_>,
        job: &JobCharacteristic,
        weights: &[PointWeight],
        value: f64,
    ) -> Vec<CharacteristicPart> {
        let at = |of: &PointWeight| -> Vec<f64> {
            let pose = &self.poses[job.rows[usize::from(of.of_datum)][of.point]];
            effects.at(pose).iter().map(|(_, d)| of.weight.dot(&d.position)).collect()
        };
        let rows: Vec<Vec<f64>> = weights.par_iter().map(at).collect();
        let sum = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>();
        let valued = machine.errors().enumerate().filter(|(_, (_, term))| !matches!(term, ErrorTerm::Tolerance(_)));
        largest(valued.map(|(i, (error, _))| (error.to_string(), if rows.is_empty() { 0.0 } else { sum(i) })), value)
    }

    /// Returns the intervals of the values (um) by the uncertainties of a machine; `None` where it states none, and
    /// with a minimum zone.
    fn intervals(&self, of: ValuedField<'_>, deviations: &[Deviation]) -> Option<Vec<Option<[f64; 2]>>> {
        let machine = of.field.machine();
        let parts = uncertain_parts([machine]);
        if parts.is_empty() || of.removed.is_some_and(|of| !of.is_linear()) {
            return None;
        }
        let whole = Statistics::of(deviations);
        let uncertain = UncertainDeviations::with_principal_parts(vec![UncertainDeviations::of(
            machine,
            &parts,
            &self.poses,
            deviations.to_vec(),
            whole,
            of.conditions,
            of.removed,
        )]);
        let drawn = uncertain
            .first()?
            .draws(of.seed, &|moved: &[Deviation]| self.figures(&moved.iter().map(|d| d.position).collect::<Vec<_>>()));
        let interval = |(i, job): (usize, &JobCharacteristic)| {
            job.of.as_ref().ok().map(|_| {
                let mut values: Vec<f64> = drawn.iter().map(|figures| figures[i] * 1e3).collect();
                UncertainDeviations::interval(&mut values)
            })
        };
        Some(self.list.iter().enumerate().map(interval).collect())
    }

    /// Returns the values of all characteristics (mm) by deviations at the poses; 0 where points do not carry one.
    fn figures(&self, positions: &[Vector3<f64>]) -> Vec<f64> {
        let one = |job: &JobCharacteristic| {
            let [feature, datum] = job.part(positions);
            job.of.as_ref().map_or(0.0, |of| of.value(&feature, &datum))
        };
        self.list.iter().map(one).collect()
    }

    /// Returns the characteristics over machines drawn between bounds.
    pub(crate) fn drawn(&self, call: &Call<'_>, of: DrawnRequest<'_>) -> Result<Vec<CharacteristicResult>, Refused> {
        let DrawnRequest { machine, bounds, removed, draws, samples, values } = of;
        let conditions = OperatingConditions::default();
        let at = |field: &dyn Field| -> Vec<Vector3<f64>> {
            self.poses.par_iter().map(|pose| field.deviation(&conditions.at_pose(pose)).position).collect()
        };
        let constant = values.map_or_else(Vec::new, at);
        let figures = |positions: &[Vector3<f64>]| self.figures(positions);
        let weights = |figure: usize, positions: &[Vector3<f64>]| self.pose_weights(figure, positions);
        let request = FiguresRequest {
            machine,
            bounds,
            poses: &self.poses,
            constant: &constant,
            reference: removed,
            draws,
            samples,
            figures: &figures,
            weights: &weights,
        };
        let all = call.stage("machines drawn", 2 * samples, |advance| draw_figures(request, advance))?;
        let one = |(job, drawn): (&JobCharacteristic, DrawnFigure)| job.of_draws(bounds, drawn);
        Ok(self.list.iter().zip(all).map(one).collect())
    }

    /// Returns the derivatives of a characteristic by the deviations at the poses.
    fn pose_weights(&self, figure: usize, positions: &[Vector3<f64>]) -> Vec<(usize, Vector3<f64>)> {
        let job = &self.list[figure];
        let [feature, datum] = job.part(positions);
        let of = |of: &Characteristic| of.weights(&feature, &datum);
        let weights = job.of.as_ref().map_or_else(|_| Vec::new(), of);
        weights.iter().map(|of| (job.rows[usize::from(of.of_datum)][of.point], of.weight)).collect()
    }
}

impl JobCharacteristic {
    /// Returns the result without values.
    fn empty(&self) -> CharacteristicResult {
        let stated = &self.stated;
        CharacteristicResult {
            feature: stated.feature.clone(),
            kind: stated.kind,
            datum: stated.datum.clone(),
            fit: stated.fit,
            tolerance_um: stated.tolerance_mm.map(|mm| mm * 1e3),
            poses: self.rows[0].len(),
            unreached: self.unreached,
            lacks: self.of.as_ref().err().map(ToString::to_string),
            value_um: None,
            minimum_zone_um: None,
            least_squares_um: None,
            interval_um: None,
            holds: None,
            drawn: None,
            errors: Vec::new(),
        }
    }

    fn of_draws(&self, bounds: &[Bound], drawn: DrawnFigure) -> CharacteristicResult {
        let mut result = self.empty();
        if self.of.is_err() {
            return result;
        }
        let DrawnFigure { mut values, parts, constant } = drawn;
        values.sort_by(f64::total_cmp);
        let within = |tolerance: f64| values.partition_point(|value| *value <= tolerance);
        let sorted_um: Vec<f64> = values.iter().map(|mm| mm * 1e3).collect();
        result.drawn = Some(DrawnCharacteristic {
            samples: values.len(),
            median_um: Percentile::of(&sorted_um, 50).value,
            p95_um: Percentile::of(&sorted_um, 95),
            holds: self.stated.tolerance_mm.map(|mm| Proportion::of(within(mm), values.len())),
        });
        let total = parts.iter().sum::<f64>() + constant;
        let names = bounds.iter().map(ToString::to_string).chain(["values".to_owned()]);
        result.errors = largest(names.zip(parts.into_iter().chain([constant])), total);
        result
    }
}

/// Returns the parts (mm) that are largest, in um and as fractions of a value.
fn largest(parts: impl Iterator<Item = (String, f64)>, value: f64) -> Vec<CharacteristicPart> {
    let share = |mm: f64| if value > 0.0 { mm / value } else { 0.0 };
    let part = |(error, mm): (String, f64)| CharacteristicPart { error, um: mm * 1e3, share: share(mm) };
    let mut list: Vec<CharacteristicPart> = parts.filter(|(_, mm)| *mm != 0.0).map(part).collect();
    list.sort_by(|a, b| b.um.abs().total_cmp(&a.um.abs()));
    list.truncate(NAMED);
    list
}
