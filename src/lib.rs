//! # abbe: from a machine configuration to volumetric compensation
//!
//! A YAML file describes a machine tool: its kinematic chain and its geometric errors (ISO 230-1). abbe computes error
//! maps, budgets and comparisons, identifies errors from measurements, and compiles the files that a CNC controller
//! loads, each set with a certificate of what it leaves.
//!
//! Every job is one function: a [`MachineFile`], a struct of options with defaults, a [`Run`] that says where files are
//! read; an [`Answer`] with the value and the warnings comes back, or the [`Diagnostics`] that refuse the input.
//!
//! Deviations are actual minus nominal, tool relative to workpiece, in ISO 841 directions. Lengths are in mm and angles
//! in rad unless a name ends in another unit; positions of rotary axes are in deg as programmed.
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
//! 9. `controller` writes the files from templates, reads them back, replays them as the controller would, and certifies
//!    what is left.
//! 10. `report` draws pictures and pages.
//! 11. `api` is this façade, `cli` the program over it.
//!
//! `docs/architecture.md` states the invariants, `docs/theory.md` the mathematics. The stages are public for the tests
//! and the benchmarks of this repository; they are hidden here, and no part of the interface.

pub use api::*;

#[doc(hidden)]
pub mod algebra;
#[doc(hidden)]
pub mod analysis;
#[doc(hidden)]
pub mod api;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
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
pub mod identify;
#[doc(hidden)]
pub mod lower;
#[doc(hidden)]
pub mod machine;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod syntax;
#[doc(hidden)]
pub mod units;
