//! `diff`: how far two sets of compensation files are apart.

use crate::compensation::{Correction, Jacobian};
use crate::controller::micro;
use crate::evaluate::{Summary, random_poses};
use crate::file_set::effect::effect_in;
use crate::file_set::options::CompensationOptions;
use crate::job::machine_file::MachineFile;
use crate::machine::Approach;
use crate::run::{Call, Count, Reply, Run};
use serde::ser::SerializeMap;
use std::path::Path;

/// Options of [`diff`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct DiffOptions {
    /// Compensation of the machine.
    pub compensation: CompensationOptions,
    /// Number of poses over the volume, each approached from both sides.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
}

impl Default for DiffOptions {
    fn default() -> Self {
        Self { compensation: CompensationOptions::default(), poses: 2000, seed: 1 }
    }
}

/// Second set less the first.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct SetDifference {
    /// By axis, in the order of the chain.
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "indexmap::IndexMap<String, indexmap::IndexMap<String, f64>>")]
    pub axes: Vec<AxisDifference>,
    /// Displacement of the functional point, um.
    pub position_um: Summary,
}

/// Difference of two sets for an axis, second less first.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisDifference {
    /// Name of the axis.
    pub name: String,
    /// Largest absolute difference, in `unit`.
    pub max: f64,
    /// Root of the mean square, in `unit`.
    pub rms: f64,
    /// `um` or `urad`.
    pub unit: &'static str,
}

fn by_name<S: serde::Serializer>(axes: &[AxisDifference], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(axes.len()))?;
    for axis in axes {
        let entry = [(format!("max_{}", axis.unit), axis.max), (format!("rms_{}", axis.unit), axis.rms)];
        map.serialize_entry(&axis.name, &indexmap::IndexMap::from(entry))?;
    }
    map.end()
}

/// Compares what the sets in two folders add to commands, over random poses of the volume approached from both sides.
///
/// Fails if a folder holds no set of a known target, or one that the controller would misread.
pub fn diff(file: &MachineFile, old: &Path, new: &Path, options: &DiffOptions, run: Run) -> Reply<SetDifference> {
    Call::answer(run, file.sources(), |call| {
        call.check_counts(&[Count::Poses(options.poses)])?;
        let mut found = |folder: &Path| {
            call.about(&folder.display().to_string(), |call| effect_in(call, file, folder, &options.compensation))
        };
        let ((old, of_old), (new, of_new)) = (found(old)?, found(new)?);
        call.check()?;
        let added = [of_old.addition(file, &old), of_new.addition(file, &new)];
        let mut axes: Vec<Vec<f64>> = vec![Vec::new(); file.axes().len()];
        let mut moved = Vec::new();
        for pose in random_poses(file, options.poses, options.seed) {
            let jacobian = Jacobian::at(file, &pose);
            for approach in [Approach::Forward, Approach::Reverse] {
                let [a, b] = [0, 1].map(|i: usize| added[i](&approach.at_pose(&pose)));
                let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| b - a).collect();
                axes.iter_mut().zip(&difference).for_each(|(all, d)| all.push(*d));
                moved.push(jacobian.displacement(&Correction(difference)) * 1000.0);
            }
        }
        let axis = |(axis, values): (&crate::machine::Axis, &Vec<f64>)| {
            let (scale, unit) = micro(axis.kind);
            let (max, rms) = figures(values);
            AxisDifference { name: axis.name.to_string(), max: max * scale, rms: rms * scale, unit }
        };
        Ok(SetDifference { axes: file.axes().iter().zip(&axes).map(axis).collect(), position_um: Summary::of(&moved) })
    })
}

/// Largest absolute value, and the root of the mean square.
fn figures(values: &[f64]) -> (f64, f64) {
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let square = values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64;
    (largest, libm::sqrt(square))
}
