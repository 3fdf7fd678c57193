//! A fit with all that is known of it, and its datum.

use crate::identify::thresholds::MIN_TOLD;
use crate::identify::{
    Estimate, FormUncertainty, Gauge, Measurement, Parameter, ParameterFit, Prediction, PriorValue, Repeats,
    ResidualTest, Residuals, RigidMotionRemoved, Solution, Suspicion, TypeB,
};
use crate::machine::{Axis, Machine, UnheldMotion};
use crate::syntax::DatumEntry;
use serde::Serialize;
use std::collections::BTreeMap;

/// The datum of the fitted errors.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct FittedDatum {
    /// Reference line, zero and place of the squareness.
    #[serde(flatten)]
    pub entry: DatumEntry,
    /// Number of conditions: each fixes a combination of errors that changes nothing but where the workpiece stands.
    pub conditions: usize,
    /// Translation of the whole that was taken out of the errors, um.
    pub translation_um: [f64; 3],
    /// Rotation of the whole that was taken out, about the middle of the volume, urad.
    pub rotation_urad: [f64; 3],
    /// Measured range of each axis (mm, deg) that was measured over less than its travel: the datum is formed there.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub measured: BTreeMap<String, [f64; 2]>,
}

impl FittedDatum {
    pub(crate) fn of(
        machine: &Machine,
        entry: DatumEntry,
        removed: &RigidMotionRemoved,
        measured: &[Option<(f64, f64)>],
    ) -> Self {
        let of_axis = |(axis, range): (&Axis, &Option<(f64, f64)>)| Some((axis.name.to_string(), (*range)?.into()));
        let measured = machine.axes().iter().zip(measured).filter_map(of_axis).collect();
        let RigidMotionRemoved { conditions, translation, rotation, .. } = *removed;
        let (translation_um, rotation_urad) = (translation.map(|x| x * 1e3), rotation.map(|x| x * 1e6));
        Self { entry, conditions, translation_um, rotation_urad, measured }
    }
}

pub(crate) struct FitDiagnosis<'a> {
    pub(crate) machine: &'a Machine,
    /// The machine's parameters first.
    pub(crate) unknowns: &'a [Parameter],
    /// Number of the machine's parameters.
    pub(crate) own: usize,
    pub(crate) data: &'a [Measurement],
    pub(crate) solution: Solution,
    pub(crate) residuals: Residuals,
    pub(crate) residual_tests: Vec<ResidualTest>,
    pub(crate) held_out: Option<f64>,
    pub(crate) prediction: Prediction,
    /// Rigid motions of the whole machine that no reading notices.
    pub(crate) motions: Vec<String>,
    pub(crate) repeats: Vec<Repeats>,
    /// Values known before the data.
    pub(crate) known: &'a [PriorValue],
    /// Distances known before the data.
    pub(crate) gauges: &'a [Gauge],
    pub(crate) type_b: &'a [TypeB],
    /// The form of the axes beside the curves; `None` if the readings cannot show it.
    pub(crate) form: Option<FormUncertainty>,
    pub(crate) datum: Option<FittedDatum>,
    /// Range (mm, deg) in which the fitted curves of each axis were measured, if that is less than its travel.
    pub(crate) measured: Vec<Option<(f64, f64)>>,
    /// Rigid motions of the workpiece frame that the readings do not hold, or that the datum has decided.
    pub(crate) unheld: Vec<UnheldMotion>,
    pub(crate) fit: ParameterFit,
    /// Standard deviation of a reading as stated (mm).
    pub(crate) noise: Option<f64>,
    /// Changes of the data that explain what is left.
    pub(crate) suspicion: Option<Suspicion>,
}

impl FitDiagnosis<'_> {
    pub(crate) fn rows(&self) -> usize {
        self.fit.reduced.rows
    }

    /// True if noise hides a value of the machine: one that is neither large beside its standard uncertainty, nor known
    /// about as well as a single reading. What is free is said apart.
    pub(crate) fn noise_hides_values(&self) -> bool {
        let own = self.solution.estimates.iter().zip(self.unknowns).take(self.own);
        let mut own = own.filter(|(_, parameter)| !parameter.is_nuisance()).peekable();
        let is_told = |(of, parameter): (&Estimate, &Parameter)| {
            of.sigma.is_none_or(|sigma| {
                of.value.abs() >= MIN_TOLD * sigma || sigma * parameter.size <= MIN_TOLD * self.solution.sigma
            })
        };
        !self.solution.below_noise.is_empty() && (own.peek().is_none() || !own.all(is_told))
    }
}
