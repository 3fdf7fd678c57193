//! Pictures and pages for people: SVG, PNG, HTML and Graphviz, without outside resources, the same bytes
//! every time.
//!
//! - [`page`]: the report, one self-contained HTML page.
//! - [`PlanePicture`]: the deviation over a plane of two linear axes; [`before_after`]: in two states.
//! - [`FitPicture`]: prediction against data over such a plane.
//! - [`axis_curves`], [`all_curves`]: curves of the component errors as small multiples.
//! - [`BudgetReport`]: a budget as JSON and as [`ParetoPicture`] and [`WaterfallPicture`]; [`PolarPicture`], [`RTestPicture`],
//!   [`DiagonalPicture`]: what instruments read.
//! - [`chain_picture`], [`chain_dot`]: the kinematic chain.
//! - [`Rows`]: a map pose by pose as CSV, JSON, Parquet and VTK, streamed.
//! - [`equations`]: the closed forms as text and as LaTeX.

mod bars;
mod budget;
mod chain;
mod curves;
mod dot;
pub mod equations;
mod fit;
mod frame;
mod instruments;
mod outlines;
pub mod page;
mod plane;
mod polar;
mod readings;
mod rows;
mod scale;
mod svg;

pub use bars::{Bar, ParetoPicture, WaterfallPicture};
pub use budget::{BudgetReport, Drawing, budgets_json, tolerance, tolerance_unit};
pub use chain::chain_picture;
pub use curves::{all_curves, axis_curves};
pub use dot::chain_dot;
pub use fit::{FitPicture, FitPoint};
pub use instruments::{circle_json, line_json, turn_json};
pub use page::positions;
pub use plane::{Drawn, PlanePicture, Shown, before_after};
pub use polar::PolarPicture;
pub use readings::{DiagonalPicture, RTestPicture};
pub use rows::{Form, Prepared, Rows, Stream};
pub use svg::Picture;
