//! # abbe: from a machine configuration to volumetric compensation
//!
//! A YAML file describes a machine tool: its kinematic chain and its geometric errors (ISO 230-1). abbe computes error
//! maps, budgets and comparisons, identifies errors from measurements, and compiles the files that a CNC controller
//! loads, each set with a certificate of what it leaves.
//!
//! Every job is one function: a [`MachineFile`], a struct of options with defaults, a [`Run`] that gives access to
//! files; an [`Answer`] with the value and the warnings comes back, or the [`Diagnostics`] that refuse the input.
//!
//! The functions and their options are here; the types of options' fields in [`options`], of results in [`results`],
//! numbers and diagnostics as text in [`text`], sets of files in a folder in [`sets`], the verbs as data in [`verbs`].
//!
//! Deviations are actual minus nominal, tool relative to workpiece, in ISO 841 directions. Lengths are in mm and angles
//! in rad unless a name ends in another unit; positions of rotary axes are in deg as programmed.
//!
//! ## Examples
//!
//! A map of a machine from text:
//!
//! ```
//! use abbe::{LoadOptions, MapOptions, Run};
//!
//! let text = "
//! abbe: 1
//! machine: Gantry
//! chain: w b X Y t
//! axes: { X: { travel: [0, 400] }, Y: { travel: [0, 300] } }
//! errors: { EC0Y: 10 urad }";
//! let machine = abbe::loads(text, &LoadOptions::default(), Run::default())?;
//! let map = abbe::map(&machine, &MapOptions::default(), Run::default())?;
//! // The squareness moves the tool by -10 urad times Y.
//! assert!((map.position_um.max - 3.0).abs() < 1e-6);
//! # Ok::<(), abbe::Diagnostics>(())
//! ```
//!
//! Compensation for a controller, compiled to memory, with its certificate:
//!
//! ```
//! use abbe::{CompileOptions, LoadOptions, Run};
//!
//! let machine = abbe::load("configs/trunnion.yaml", &LoadOptions::default(), Run::on_disk())?;
//! let options = CompileOptions { target: "linuxcnc".to_owned(), poses: 200, ..CompileOptions::default() };
//! let set = abbe::compile(&machine, &options, Run::default())?;
//! assert!(set.files.iter().any(|file| file.name == "compensation.inc"));
//! let certificate = &set.certificate;
//! assert!(certificate.compensated.position_um.p95 < certificate.uncompensated.position_um.p95);
//! # Ok::<(), abbe::Diagnostics>(())
//! ```
//!
//! Errors from measurements:
//!
//! ```
//! use abbe::{IdentifyOptions, LoadOptions, Run};
//!
//! let text = "
//! abbe: 1
//! machine: Gantry
//! chain: w b X Y t
//! axes: { X: { travel: [0, 400] }, Y: { travel: [0, 300] } }";
//! let readings = "X [mm],Y [mm],dx [um],dy [um],dz [um]\n0,0,0,0,0\n0,300,-3,0,0\n400,150,-1.5,0,0\n";
//! let machine = abbe::loads(text, &LoadOptions::default(), Run::default())?;
//! let options = IdentifyOptions {
//!     texts: vec![("readings.csv".to_owned(), readings.to_owned())],
//!     fit: vec!["EC0Y".to_owned()],
//!     ..IdentifyOptions::default()
//! };
//! let fit = abbe::identify(&machine, &options, Run::default())?;
//! assert!((fit.parameters[0].value - 10.0).abs() < 1e-3);
//! # Ok::<(), abbe::Diagnostics>(())
//! ```
//!
//! ## The pipeline
//!
//! 1. `syntax` turns text into the content of the file, with the place of every entry. It judges nothing.
//! 2. `machine` turns that into a resolved machine: a kinematic chain from workpiece to tool, axes, errors as constants
//!    and curves, conventions. It can only be built valid.
//! 3. `lower` turns a machine at a pose into matrices over an `algebra`, joint by joint, in one documented order.
//! 4. `evaluate` subtracts the nominal machine: deviation of the functional point, orientation, E_VE. For many poses a
//!    machine is compiled; the general algebra defines the result.
//! 5. `analysis` maps and compares over a volume, budgets tolerances, ranks arrangements of the axes.
//! 6. `convert` writes a machine under other conventions, and proves that it is the same machine.
//! 7. `identify` fits errors to measured deviations and writes a machine file again.
//! 8. `compensation` solves for the corrected command and fills the tables of a controller's mechanism.
//! 9. `controller` writes the files from templates, reads them back, replays them as the controller would, and
//!    certifies the residual.
//! 10. `report` draws pictures and pages; `mesh` reads what a customer's machine looks like, for the page alone.
//! 11. `api` is this façade; the program `abbe` is a face over it.
//!
//! `docs/architecture.md` states the invariants, `docs/theory.md` the mathematics. The stages are public for the tests
//! and the benchmarks of this repository; they are hidden here, and no part of the interface.

#![cfg_attr(small_engine, feature(optimize_attribute))]

pub use api::*;
pub use wire::report::report;
pub use wire::report_options::ReportOptions;
pub use wire::workbench::workbench;

/// Types of the fields of options.
pub mod options {
    pub use crate::api::options::*;
    pub use crate::wire::workbench::{CompareWith, Question, WorkOptions, WorkbenchRequest};
}

pub mod results {
    #![doc = include_str!("api/results.md")]

    pub use crate::api::results::*;
    pub use crate::wire::report::Report;
}

/// The first lines of results as text: the figure that a verb is asked for.
pub mod headlines {
    pub use crate::wire::headline::*;
}

/// The verbs as data, for whoever speaks JSON; the page's requests in parts.
pub mod verbs {
    pub use crate::wire::verbs::{
        ResultSchema, VERBS, Verb, VerbAnswer, VerbCall, VerbRequest, answers, options, results,
    };
    pub use crate::wire::workbench::{workbench_of_parts, workbench_part};
}

#[doc(hidden)]
pub mod algebra;
#[doc(hidden)]
pub mod analysis;
#[doc(hidden)]
pub mod api;
#[doc(hidden)]
pub mod compensation;
#[doc(hidden)]
pub mod controller;
#[doc(hidden)]
pub mod convert;
#[doc(hidden)]
pub mod diagnostic;
#[doc(hidden)]
pub mod evaluate;
#[doc(hidden)]
pub mod file_set;
#[doc(hidden)]
pub mod identify;
#[doc(hidden)]
pub mod job;
#[doc(hidden)]
pub mod lower;
#[doc(hidden)]
pub mod machine;
#[doc(hidden)]
pub mod mesh;
#[doc(hidden)]
pub mod record;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod run;
#[doc(hidden)]
pub mod shards;
#[doc(hidden)]
pub mod standards;
#[doc(hidden)]
pub mod syntax;
#[doc(hidden)]
pub mod units;
#[doc(hidden)]
pub mod wire;
