//! The façade: one function for each job, from a machine file to certified tables.
//!
//! Every function takes a [`MachineFile`] (or several), a plain struct of options with defaults, and a [`Run`], which
//! gives access to files and receives progress. It returns an [`Answer`]: the value, which serde can write in the shape
//! that docs/formats/json.md describes, and the warnings; or the [`Diagnostics`] that refuse the input.
//!
//! Nothing here prints, writes a file, reads the clock or the environment. A job hands its files over as bytes or
//! writes into the sinks that the caller gave it.

mod algebra;
mod bounded;
mod budget;
mod budget_parts;
mod budgets;
mod certificate;
mod check;
mod classify;
mod compare;
mod compensation;
mod compile;
mod compiled_model;
mod compose;
mod convert;
mod diff;
mod diff_machines;
mod effects;
mod enumerate;
mod equations;
mod eval;
mod explain;
mod features;
mod figures;
mod finite;
mod goal;
mod identify;
mod import;
mod instrument;
mod locate;
mod machine_file;
mod mailed;
mod map;
mod map_bounds;
mod map_tables;
pub mod options;
mod plane_picture;
mod poses;
mod positioning;
mod reach;
mod record;
mod replay;
mod report;
pub mod results;
mod run;
pub mod sets;
#[allow(dead_code, reason = "only the schema of these structures is taken")]
mod shapes;
mod share;
mod show;
mod sources;
mod starter;
mod study;
mod summary;
mod targets;
pub mod text;
mod tolerances;
mod tool_poses;
mod uncertainty;
mod verify;
mod workbench;

use crate::evaluate::Order;
use crate::machine::Machine;

pub use budget::{BudgetOptions, budget, budget_part};
pub use check::check;
pub use classify::{ClassifyOptions, classify};
pub use compare::{CompareOptions, compare};
pub use compile::{CompileOptions, compile};
pub use compiled_model::{CompiledModel, compile_model};
pub use compose::compile_composed;
pub use convert::{ConvertOptions, convert};
pub use diff::{DiffOptions, diff};
pub use diff_machines::{DiffMachinesOptions, diff_machines};
pub use enumerate::{EnumerateOptions, enumerate};
pub use equations::{EquationsOptions, equations};
pub use eval::{EvalOptions, eval};
pub use explain::explain;
pub use figures::{FiguresOptions, figures};
pub use identify::{IdentifyOptions, PlanOptions, fit_monomials, identify, plan_measurements};
pub use import::{ImportOptions, import};
pub use instrument::{InstrumentOptions, instrument};
pub use locate::{LocateOptions, locate};
pub use machine_file::{LoadOptions, MachineFile, load, loads};
pub use map::{MapOptions, map, map_tables};
pub use reach::{ReachOptions, reach};
pub use record::{RecordOptions, check_record, record, record_trend};
pub use replay::replay;
pub use report::{ReportOptions, report};
pub use run::{Answer, Cancellation, Cancelled, Monitor, Run};
pub use share::{MapPart, MapShare};
pub use show::show;
pub use sources::{SourcesOptions, sources};
pub use starter::{schema, starter};
pub use summary::summary;
pub use targets::targets;
pub use verify::{VerifyOptions, verify};
pub use workbench::{workbench, workbench_part};

pub use crate::diagnostic::{Diagnostic, Diagnostics, codes};
pub use crate::syntax::{Disk, Files, MemoryFiles};

/// The order asked for, or the one that the conventions of the machine name.
fn order_of(machine: &Machine, order: Option<Order>) -> Order {
    order.unwrap_or_else(|| machine.conventions().default_order.map_or(Order::Exact, Order::Degree))
}
