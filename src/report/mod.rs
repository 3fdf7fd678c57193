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

pub mod page;
mod pictures;
mod rows;
mod text;

pub use page::positions;
pub use pictures::bars::{Bar, ParetoPicture, WaterfallPicture};
pub use pictures::chain::chain_picture;
pub use pictures::curves::{all_curves, axis_curves};
pub use pictures::dot::chain_dot;
pub use pictures::fit::{FitPicture, FitPoint};
pub use pictures::plane::{Drawn, PlanePicture, Shown, before_after};
pub use pictures::polar::PolarPicture;
pub use pictures::readings::{DiagonalPicture, RTestPicture};
pub use pictures::svg::Picture;
pub use rows::{Form, Prepared, Rows, Sink, Stream};
pub use text::budget::{BudgetReport, Drawing, budgets_json, tolerance, tolerance_unit};
pub use text::equations;
pub use text::instruments::{circle_json, line_json, turn_json};
