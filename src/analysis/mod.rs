//! Analysis: the errors of a machine over its volume, its design, and its closed forms, for any
//! [`Field`](crate::evaluate::Field).
//!
//! - `inverse`: the axes' positions for a pose of the tool, of the nominal machine ([`inverse()`]) and of the actual
//!   one over an algebra ([`Inverse`]).
//! - `volume`: maps ([`map()`]), surveys that keep no pose ([`survey()`]), planes, body diagonals, lever arms, the
//!   tool poses on which machines are compared ([`Work`]), and those of a grid within reach ([`reach()`]).
//! - `path`: tool poses as one continuous path ([`solve()`]), and its events ([`path_events()`]).
//! - `design`: machines side by side ([`compare()`]), tolerances to the volumetric error ([`mod@budget`]), arrangements
//!   of the axes ([`enumerate`]), and the effect of each error alone ([`error_statistics()`], [`contributions()`]).
//! - `closed_form`: equations over polynomials in symbols ([`equations()`]), interactions of errors
//!   ([`interactions()`]), first-order effects joint by joint ([`twists`](crate::lower::twists)), and the minimal
//!   set of location errors ([`LocationSet`]).
//! - `uncertainty`: intervals of the figures of a map by the uncertainty of the errors ([`bands()`]); [`figure_bands`]:
//!   those of a field, of machines side by side, and of single poses.
//! - [`mod@reference`]: the rigid motion of the part that its set-up takes out of deviations; `minimum_zone`: the one
//!   that leaves the smallest largest deviation.
//! - [`zone`]: geometrical characteristics of features, as functions of the deviations at their points.
//! - [`mod@touch_route`]: the way of a touch probe around balls, and what it keeps clear of.
//! - [`instrument`]: the readings of a ball bar, an R-test, or a laser along the diagonals.

mod closed_form;
mod design;
pub mod figure_bands;
pub mod instrument;
mod inverse;
mod minimum_zone;
mod path;
pub mod reference;
pub mod touch_route;
mod uncertainty;
mod volume;
pub mod zone;

pub use closed_form::{
    Equations, FactorsOfJoint, Interactions, Lemma, LocationSet, Naming, Options, OwnParameter, ParameterShare,
    ProductEffect, Status, Symbol, SymbolMeaning, equations, equations_in, interactions, lemmas, lie_algebra,
};
pub use design::{
    Comparison, ErrorContribution, ErrorStatistics, MachineResult, UnreachableCount, budget, compare, contributions,
    enumerate, error_statistics,
};
pub use inverse::{
    DirectionKind, Inverse, Miss, Needs, Pole, ToolDirections, ToolPose, TravelExcess, Unreachable, attitude, branches,
    direction_gap, excess, inverse, inverse_all, place, rest, rotary_axes_place_tip, tool_pose, unturned_tool_pose,
};
pub use path::{AxisMotion, PathEvents, PoleCrossing, Rewind, path_events, solve};
pub(crate) use uncertainty::figure_of;
pub use uncertainty::{
    Bands, SummaryBand, UncertainDeviations, band_places, bands, part_models, spread_places, uncertain_parts,
};
pub(crate) use volume::deviations;
pub use volume::{
    DiagonalRun, Lever, MAX_POSES, MAX_SURVEYED, Map, MapFailure, Plane, PlaneNodes, ReachGrid, Survey, SurveyBlock,
    SurveyTask, View, Work, arm_shares, body_diagonals, deviation_in, levers, map, reach, space_axes, survey,
    survey_with_rows,
};
