//! A fit of error parameters to measurements.

use crate::evaluate::{Frame, Order};
use crate::identify::verdict::inputs::{FitAcceptance, FitInputs, FitRange};
use crate::identify::verdict::passes::{FitOutputs, solve_problem};
use crate::identify::verdict::problem::{Problem, enough};
use crate::identify::verdict::result::IdentifyResult;
use crate::job::machine_file::MachineFile;
use crate::report::fit_planes::draw;
use crate::run::{Call, Reply, Run};
use std::path::PathBuf;

/// Options of [`identify`] and [`fit_monomials`](super::fit_monomials).
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct IdentifyOptions {
    /// Files of measurements, read through `run.files`: CSV with a column for each axis and `dx [um]`, `dy [um]`,
    /// `dz [um]`, or lengths, ball readings, lines, single errors (docs/identify/measure.md).
    pub data: Vec<PathBuf>,
    /// Files of measurements by name and text; they come after `data`.
    pub texts: Vec<(String, String)>,
    /// Parameters to fit: `location`, `tool`, `tools`, `tools-by-run`, `workpiece`, `workpiece-by-run`, `spindle`,
    /// `linear`, error names, `EXX:poly3`; if empty, the section `identify` of the machine file.
    pub fit: Vec<String>,
    /// Parameters that keep their value although a group names them.
    pub fixed: Vec<String>,
    /// Values known before the data, with a standard uncertainty: `ball b1 50 um`, `EC0Y 5 urad`, `constant S = 150
    /// mm 1 um`; `file`: what the machine file states. They come after those of the section `identify`.
    pub priors: Vec<String>,
    /// Standard uncertainties that all readings share: `laser 0.4 um/m` (a scale), `set-up 2 um` (an offset),
    /// `material 0.5 K x 11.7 um/m/K`. They come after those of the section `identify`.
    pub type_b: Vec<String>,
    /// Frame in which the deviations were measured.
    pub frame: Frame,
    /// The poses of points that a laser tracker's export has by name: a table with a column for each axis, and `point`.
    pub axis_poses: Option<PathBuf>,
    /// Model to fit: exact by default, or of order 1 or 2. Monomials are those of order 2 by default.
    pub order: Option<Order>,
    /// Gives readings that stand out less weight (Huber).
    pub robust: bool,
    /// Checks the prediction: leaves out every measurement once, in this many parts.
    pub folds: Option<usize>,
    /// Part of the volume over which the fit is judged, and which the machine file states as `volume`.
    pub range: FitRange,
    /// Also writes the fitted machine file; fails if it is one that would be refused.
    pub machine_file: bool,
    /// Standard deviation of a reading (mm) that is expected: more is remarked, and troubles are looked for.
    pub noise_mm: Option<f64>,
    /// Refusals that the caller takes on their word; the machine file states them.
    pub accept: Vec<FitAcceptance>,
    /// An older word for `accept: undetermined`.
    pub accept_undetermined: bool,
    /// Also draws prediction and data over the planes of the linear axes.
    pub pictures: bool,
}

impl IdentifyOptions {
    pub(super) fn inputs(&self) -> FitInputs<'_> {
        FitInputs {
            fit: &self.fit,
            fixed: &self.fixed,
            priors: &self.priors,
            type_b: &self.type_b,
            paths: self.paths(),
            texts: &self.texts,
            is_plan: false,
            frame: self.frame,
            axis_poses: self.axis_poses.as_deref(),
            order: self.order.unwrap_or(Order::Exact),
            robust: self.robust,
            folds: self.folds,
            range: self.range,
            noise: self.noise_mm,
            accept: self.accepted(),
        }
    }

    /// Returns those of the options, as the program spells them, that coefficients of monomials know nothing of.
    pub(super) fn without_effect_on_monomials(&self) -> Vec<&'static str> {
        let list = [
            (self.machine_file, "--out"),
            (self.robust, "--robust"),
            (self.folds.is_some(), "--folds"),
            (self.range != FitRange::Travel, "--range"),
            (!self.accepted().is_empty(), "--accept"),
            (!self.priors.is_empty(), "--prior"),
            (!self.type_b.is_empty(), "--type-b"),
            (self.noise_mm.is_some(), "--noise"),
        ];
        list.into_iter().filter(|(is_given, _)| *is_given).map(|(_, option)| option).collect()
    }

    fn accepted(&self) -> Vec<FitAcceptance> {
        let older =
            Some(FitAcceptance::Undetermined).filter(|word| self.accept_undetermined && !self.accept.contains(word));
        self.accept.iter().copied().chain(older).collect()
    }

    /// All files of measurements, in their order.
    fn paths(&self) -> Vec<PathBuf> {
        self.data.iter().cloned().chain(self.texts.iter().map(|(name, _)| PathBuf::from(name))).collect()
    }
}

/// Fits error parameters of a machine to measurements.
///
/// Fails if the data cannot be read, contradict the machine's axes, or hold fewer readings than there are unknowns, and
/// if the parameters asked for are not those of the machine.
pub fn identify(file: &MachineFile, options: &IdentifyOptions, run: Run) -> Reply<IdentifyResult> {
    Call::answer(run, file.sources(), |call| {
        let inputs = options.inputs();
        let problem = Problem::read(call, file, &inputs)?;
        enough(call, file, &problem)?;
        let draw = if options.pictures { Some(&draw as _) } else { None };
        let outputs = FitOutputs { machine_file: options.machine_file, draw };
        solve_problem(call, file, &inputs, &problem, &outputs)
    })
}
