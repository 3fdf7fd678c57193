//! Readings against the prediction of a machine file, without a fit.

use crate::evaluate::Frame;
use crate::identify::ReadingContext;
use crate::identify::second::{PredictedReadings, SecondInputs, predicted_readings};
use crate::job::machine_file::MachineFile;
use crate::run::{Call, Reply, Run};
use std::path::PathBuf;

/// Options of [`predict`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct PredictOptions {
    /// Files of measurements, as [`identify`](super::identify()) takes them; several files are several set-ups.
    pub data: Vec<PathBuf>,
    /// Measurements by name and text; names among the files are taken from here.
    pub texts: Vec<(String, String)>,
    /// Frame in which the deviations were measured.
    pub frame: Frame,
    /// The poses of points that a laser tracker's export has by name.
    pub axis_poses: Option<PathBuf>,
    /// Standard uncertainties that all readings share, in words; one that the machine file names too counts once.
    pub type_b: Vec<String>,
    /// Standard deviation (mm) of readings that do not state theirs; by default that of repeated readings.
    pub noise_mm: Option<f64>,
    /// Seed of the draws behind the share that chance explains.
    pub seed: u64,
}

impl Default for PredictOptions {
    fn default() -> Self {
        let (data, texts, type_b) = (Vec::new(), Vec::new(), Vec::new());
        Self { data, texts, frame: Frame::default(), axis_poses: None, type_b, noise_mm: None, seed: 1 }
    }
}

/// Compares readings of a machine with the prediction of its file. Nothing is fitted but the set-up, which no reading
/// shares with the file.
///
/// Fails if the readings cannot be read, and if nothing says how sure they are.
pub fn predict(file: &MachineFile, options: &PredictOptions, run: Run) -> Reply<PredictedReadings> {
    Call::answer(run, file.sources(), |call| {
        let paths: Vec<PathBuf> =
            options.data.iter().cloned().chain(options.texts.iter().map(|(name, _)| PathBuf::from(name))).collect();
        if paths.is_empty() {
            return call.usage("readings to predict are missing");
        }
        let context = ReadingContext { frame: options.frame, axis_poses: options.axis_poses.clone(), is_plan: false };
        let PredictOptions { texts, type_b, noise_mm, seed, .. } = options;
        let of = SecondInputs { paths: &paths, texts, context, type_b, noise_mm: *noise_mm, seed: *seed };
        predicted_readings(call, file, &of)
    })
}
