//! All arrangements of a machine's axes on the two sides of the bed, on the same work.
//!
//! 1. [`walks`] lists them, walk by walk, without those that a [`Rule`] excludes.
//! 2. The [`Work`](crate::analysis::Work) is a list of tool poses in the workpiece frame, drawn from the volume of
//!    the machine as its file has it, or given. Every walk reaches them by its nominal inverse kinematics, or does not.
//! 3. A walk that cannot turn the tool as the work requires is set apart.
//! 4. The others are judged by a budget (the same drawn errors for all) or by the errors given. Those that could be
//!    among the first have more machines drawn, in [`Rounds`].
//! 5. [`rank`] puts them in order, and apart those whose geometry the file does not state; [`Journal`] keeps results
//!    walk by walk, so that a run can be interrupted, cut into parts and put together again. A walk's result depends on
//!    nothing else.
//!
//! Every axis has the geometry, travel and errors that the file states for the side on which it stands.

mod arrangement;
mod buildable;
mod journal;
mod ranking;
mod records;
mod rounds;
mod rule;
mod side_draws;
mod study;
mod values_by_chain;
mod walk_budget;

pub use arrangement::{MAX_ARRANGEMENTS, TooMany, Walk, walks};
pub use buildable::{BUILDABLE_RULES, buildable};
pub use journal::{Journal, RoundRecord, RoundStep};
pub use ranking::{ArrangementRow, FittedArrangement, NeededRange, Ranking, Reach, Standing, rank};
pub use rounds::{MissingSteps, RoundCount, Rounds, Standings, StudyEnd, standings};
pub use rule::{Rule, RuleFailure};
pub use study::{Judge, MachineCoordinates, PartSetUps, Study, StudyRound};
pub use values_by_chain::ChainValues;
