//! Pictures and pages for people: SVG, PNG, HTML and Graphviz, without outside resources, the same bytes
//! every time.
//!
//! - [`page`]: the report, one self-contained HTML page.
//! - [`PlanePicture`]: the deviation over a plane of two linear axes; [`before_after`]: in two states.
//! - [`FitPicture`]: prediction against data over such a plane.
//! - [`all_curves`]: curves of the component errors as small multiples.
//! - [`BudgetFigures`]: a budget as it stands in JSON, as a Pareto chart and as a waterfall; [`PolarPicture`],
//!   [`RTestPicture`],
//!   [`DiagonalPicture`]: what instruments read.
//! - [`chain_picture`], [`chain_dot`], [`zero_pose_picture`]: the kinematic chain.
//! - [`Rows`]: a map pose by pose as CSV, JSON, Parquet and VTK, streamed.
//! - [`measuring_program`]: the program of a touch probe, from templates.
//! - [`equations`]: the closed forms as text and as LaTeX.

pub(crate) mod fit_planes;
pub mod imported;
pub mod measuring_program;
pub mod page;
mod pictures;
pub mod plane_picture;
pub(crate) mod positioning;
mod rows;
pub mod standard_tests;
mod text;

pub(crate) use pictures::axis_curves;
pub use pictures::{
    DiagonalPicture, DialMark, DialPanel, FitPicture, FitPoint, LinePanel, LinePicture, Picture, PictureFailure,
    PlacementPicture, PlanePicture, PlaneQuantity, PlaneStyle, PolarPicture, RTestPicture, ReachPicture, RunCurves,
    RunPanel, RunPicture, all_curves, before_after, chain_dot, chain_picture, zero_pose_picture,
};
pub use rows::{
    RowBlock, RowFormat, RowValues, Rows, Sink, Stream, UnreachedRow, WorkRow, WorkRows, cell, structured_grid,
};
pub use text::{
    ActingValues, BoundedContribution, BoundedFigures, BoundedLengths, BudgetFigures, DeviationBudget, DrawSettings,
    DrawnMachineFigures, LengthStatistics, MachineDifference, PercentileInterval, PropertyDifference, RssDifference,
    Tightening, contributions, equations, tolerance, tolerance_unit,
};
pub(crate) use text::{describe, rotation_words};
