//! SVG, PNG and Graphviz: chains, curves, planes, budgets, fits and readings.

pub(super) mod bars;
pub(super) mod chain;
pub(super) mod curves;
pub(super) mod dot;
pub(super) mod fit;
pub(super) mod frame;
#[cfg(feature = "png")]
pub(super) mod outlines;
pub(super) mod plane;
pub(super) mod png;
pub(super) mod polar;
pub(super) mod readings;
pub(super) mod scale;
pub(super) mod svg;
