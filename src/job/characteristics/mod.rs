//! Tolerances of features, as a drawing has them, over the tool poses of a job.
//!
//! - `entry`: the tolerances that a job file states;
//! - `resolved`: those tolerances on the points that a machine reaches;
//! - `result`: the values of the characteristics, as results have them;
//! - `values`: what deviations, bounds and uncertainties lead to.

mod entry;
mod resolved;
mod result;
mod values;

pub(crate) use entry::{FeatureEntries, FeatureTolerances};
pub(crate) use resolved::JobCharacteristics;
pub use result::{CharacteristicPart, CharacteristicResult, DrawnCharacteristic};
pub(crate) use values::{DrawnRequest, ValuedField};
