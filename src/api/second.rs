//! Options of a second measurement, by which a set is judged.

use crate::evaluate::Frame;
use crate::identify::ReadingContext;
use crate::identify::second::{Additions, SecondInputs, SecondMeasurement, second_measurement};
use crate::job::machine_file::MachineFile;
use crate::run::{Call, Refused};
use std::path::PathBuf;

/// A second measurement, by which [`verify`](super::verify()) judges a set.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct SecondOptions {
    /// Files of measurements, as [`identify`](super::identify()) takes them; none: there is no second measurement.
    pub data: Vec<PathBuf>,
    /// Frame in which the deviations were measured.
    pub frame: Frame,
    /// The poses of points that a laser tracker's export has by name.
    pub axis_poses: Option<PathBuf>,
    /// Standard uncertainties that all readings share, in words; one that the machine file names too counts once.
    pub type_b: Vec<String>,
    /// Standard deviation (mm) of readings that do not state theirs; by default that of repeated readings.
    pub noise_mm: Option<f64>,
}

impl SecondOptions {
    /// Returns the verdict by the readings; `added` are the motions that the set adds.
    pub(crate) fn judge(
        &self,
        call: &mut Call,
        file: &MachineFile,
        seed: u64,
        added: Additions<'_>,
    ) -> Result<Option<Box<SecondMeasurement>>, Refused> {
        if self.data.is_empty() {
            return Ok(None);
        }
        let context = ReadingContext { frame: self.frame, axis_poses: self.axis_poses.clone(), is_plan: false };
        let (paths, type_b) = (&self.data[..], &self.type_b[..]);
        let inputs = SecondInputs { paths, texts: &[], context, type_b, noise_mm: self.noise_mm, seed };
        second_measurement(call, file, &inputs, added).map(|second| Some(Box::new(second)))
    }
}
