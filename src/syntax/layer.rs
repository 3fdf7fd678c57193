//! A file merged over what it extends.

use super::geometry::WrittenChains;
use super::places::Places;
use serde_yaml::Mapping;

/// The merged tree and where its entries stand.
pub struct Layer {
    pub map: Mapping,
    pub places: Places,
    pub chains: WrittenChains,
}
