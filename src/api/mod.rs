//! The façade: one function for each job, from a machine file to certified tables.
//!
//! Every function takes a [`MachineFile`] (or several), a plain struct of options with defaults, and a [`Run`], which
//! gives access to files and receives progress. It returns an [`Answer`]: the value, which serde can write in the shape
//! that docs/formats/json.md describes, and the warnings; or the [`Diagnostics`] that refuse the input.
//!
//! Nothing here prints, writes a file, reads the clock or the environment. A job hands its files over as bytes or
//! writes into the sinks that the caller gave it.

pub(crate) mod algebra;
pub(crate) mod bounded;
pub(crate) mod budget;
pub(crate) mod budgets;
pub(crate) mod certificate;
pub(crate) mod check;
pub(crate) mod classify;
pub(crate) mod compare;
pub(crate) mod compare_figures;
pub(crate) mod compare_targets;
pub(crate) mod compile;
pub(crate) mod compiled_model;
pub(crate) mod compose;
pub(crate) mod convert;
mod diff;
pub(crate) mod diff_machines;
pub(crate) mod effects;
pub(crate) mod enumerate;
pub(crate) mod equations;
pub(crate) mod eval;
pub(crate) mod explain;
pub(crate) mod figures;
pub(crate) mod goal;
pub(crate) mod identify;
pub(crate) mod import;
pub(crate) mod instrument;
pub(crate) mod locate;
pub(crate) mod look;
pub(crate) mod map;
pub(crate) mod map_bounds;
pub(crate) mod map_result;
pub(crate) mod map_tables;
pub(crate) mod measure;
pub mod options;
pub(crate) mod place;
pub(crate) mod pose_arrays;
pub(crate) mod reach;
pub(crate) mod record;
pub(crate) mod replay;
mod restore_check;
pub mod results;
mod second;
mod set_part;
pub mod sets;
pub(crate) mod show;
pub(crate) mod sources;
pub(crate) mod starter;
pub(crate) mod summary;
pub(crate) mod targets;
pub(crate) mod terms;
pub(crate) mod testpiece;
pub mod text;
pub(crate) mod tolerances;
pub(crate) mod touches;
pub(crate) mod uncertainty;
pub(crate) mod verify;
mod withheld;

pub use crate::job::machine_file::{LoadOptions, MachineFile, load, loads};
pub use crate::job::test_piece::TestPieceOptions;
pub use crate::run::{Answer, Cancellation, Cancelled, Monitor, Reply, Run};
pub use budget::{BudgetOptions, budget, budget_part};
pub use check::check;
pub use classify::{ClassifyOptions, classify};
pub use compare::{CompareOptions, compare};
pub use compare_targets::{CompareTargetsOptions, compare_targets};
pub use compile::{CompileOptions, compile};
pub use compiled_model::compile_model;
pub use compose::compile_composed;
pub use convert::{ConvertOptions, convert};
pub use diff::{DiffOptions, diff};
pub use diff_machines::{DiffMachinesOptions, diff_machines};
pub use enumerate::{EnumerateOptions, enumerate};
pub use equations::{EquationsOptions, equations};
pub use eval::{EvalOptions, eval};
pub use explain::explain;
pub use figures::{FiguresOptions, figures};
pub use identify::{IdentifyOptions, PlanOptions, PredictOptions, fit_monomials, identify, plan_measurements, predict};
pub use import::{ImportOptions, import};
pub use instrument::{InstrumentOptions, instrument};
pub use locate::{LocateOptions, locate};
pub use map::{map, map_tables};
pub use map_result::MapOptions;
pub use measure::{MeasureOptions, measure};
pub use place::{PlacementOptions, place};
pub use pose_arrays::{DrawnConditions, DrawnValues, PoseRows, error_values};
pub use reach::{ReachOptions, reach};
pub use record::{RecordOptions, check_record, record, record_trend};
pub use replay::replay;
pub use show::show;
pub use sources::{SourcesOptions, sources};
pub use starter::{NAMED_MACHINES, VARIANTS, machine_dialogue, machines_text, named_machine, schema, starter};
pub use summary::summary;
pub use targets::{target, targets};
pub use testpiece::testpiece;
pub use touches::{TouchOptions, import_touches};
pub use verify::{VerifyOptions, verify};

pub use crate::diagnostic::{Diagnostic, Diagnostics, codes};
pub use crate::machine::CLASS_NAMES;
pub use crate::syntax::{Disk, Files, MemoryFiles, dialogue};
