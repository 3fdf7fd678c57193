//! Pictures as SVG, PNG and Graphviz.
//!
//! - `chain`, `dot`: the kinematic chain; `curves`: curves of the component errors.
//! - `plane`: the deviation over a plane, before and after; `fit`: prediction against data over a plane.
//! - `bars`: a budget; `reach`: sections of a box by the share of directions; `placement`: places of a part; `polar`,
//!   `readings`: the readings of instruments.
//! - `svg` writes the drawing, `lettering` its text, `png` the pixels, `outlines` the text of a PNG; `scale` and
//!   `frame` are ticks, colours and axes.

mod bars;
mod chain;
mod curves;
mod dot;
mod fit;
mod frame;
mod lettering;
#[cfg(feature = "png")]
mod outlines;
mod placement;
mod plane;
mod png;
mod point;
mod polar;
mod reach;
mod readings;
mod runs;
mod scale;
mod svg;
mod zero_pose;

pub use bars::{Bar, ParetoPicture, WaterfallPicture};
pub use chain::chain_picture;
pub use curves::{all_curves, axis_curves};
pub use dot::chain_dot;
pub use fit::{FitPicture, FitPoint};
pub use placement::PlacementPicture;
pub use plane::{PlanePicture, PlaneQuantity, PlaneStyle, before_after};
pub use png::PictureFailure;
pub use polar::{DialMark, DialPanel, PolarPicture};
pub use reach::ReachPicture;
pub use readings::{DiagonalPicture, RTestPicture};
pub use runs::{LinePanel, LinePicture, RunCurves, RunPanel, RunPicture};
pub(super) use scale::{rising, round_step};
pub use svg::Picture;
pub(super) use svg::escape;
pub use zero_pose::zero_pose_picture;
