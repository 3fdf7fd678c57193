//! Geometrical characteristics of features (ISO 1101) by the deviations of their points, linearised about the nominal
//! feature: straightness, flatness, roundness, cylindricity, profile, position, and angles to a datum.
//!
//! - `minimax`: linear fits with the least largest residual, by which minimum zones are found;
//! - `nominal`: lines, planes and surfaces of revolution through nominal points;
//! - `characteristic`: a characteristic as a function of the deviations, its derivatives.

mod characteristic;
mod minimax;
mod nominal;
mod profile;
#[cfg(test)]
mod tests;

pub use characteristic::{Characteristic, CharacteristicKind, CharacteristicRequest, PointWeight, ZoneFit, ZoneWidths};
pub use minimax::{Minimax, MinimaxFit};
pub use nominal::{SurfacePoint, Unfit};
pub use profile::{ProfilePoint, RoundProfile, RoundSurface};
