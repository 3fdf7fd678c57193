//! Pictures for people: SVG and Graphviz as text, without outside resources, the same bytes every time.
//!
//! - [`PlanePicture`]: the deviation over a plane of two linear axes.
//! - [`FitPicture`]: prediction against data over such a plane.
//! - [`equations`]: the closed forms as text and as LaTeX.
//! - [`chain_svg`], [`chain_dot`]: the kinematic chain.

mod chain;
mod dot;
pub mod equations;
mod fit;
mod plane;
mod scale;
mod svg;

pub use chain::chain_svg;
pub use dot::chain_dot;
pub use fit::{FitPicture, FitPoint};
pub use plane::{PlanePicture, Shown};
