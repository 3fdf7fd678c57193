//! A file merged over what it extends.

use super::geometry::WrittenChains;
use super::places::{Keys, Places};
use super::scalar::Scalar;
use serde_yaml::Mapping;

/// The merged tree and where its entries stand.
pub struct Layer {
    pub map: Mapping,
    pub places: Places,
    pub chains: WrittenChains,
    /// Gauge points that the file displaces.
    pub moved_gauges: Vec<(Keys, [Scalar; 3])>,
}
