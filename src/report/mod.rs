//! Pictures for people: SVG and Graphviz as text, without outside resources, the same bytes every time.
//!
//! - [`PlanePicture`]: the deviation over a plane of two linear axes.
//! - [`ParetoPicture`], [`WaterfallPicture`]: a budget.
//! - [`PolarPicture`]: a ball bar.
//! - [`equations`]: the closed forms as text and as LaTeX.
//! - [`chain_svg`], [`chain_dot`]: the kinematic chain.

mod bars;
mod chain;
mod dot;
pub mod equations;
mod frame;
mod plane;
mod polar;
mod scale;
mod svg;

pub use bars::{Bar, ParetoPicture, WaterfallPicture};
pub use chain::chain_svg;
pub use dot::chain_dot;
pub use plane::{PlanePicture, Shown};
pub use polar::PolarPicture;
