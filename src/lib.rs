//! # abbe: from a machine configuration to volumetric compensation
//!
//! A YAML file says how a machine tool is built and how it errs. Out come error maps, comparisons, and
//! the tables that a CNC controller loads, each set with a certificate of what it leaves. This page is
//! the architecture; `docs/theory.md` holds the mathematics and its conventions.
//!
//! ## The pipeline
//!
//! 1. [`syntax`] turns text into what the file says, with the place of every entry. It judges nothing.
//! 2. [`machine`] turns that into a resolved [`machine::Machine`]: a kinematic chain from workpiece to
//!    tool, axes, ISO 230-1 errors as constants and curves, conventions. It can only be built valid.
//! 3. [`lower`] turns a machine at a pose into matrices over an [`algebra`], joint by joint, in one
//!    documented order, and multiplies them along the chain.
//! 4. [`evaluate`] subtracts the nominal machine: deviation of the functional point, orientation, E_VE.
//!    Whatever has a deviation at a pose is an [`evaluate::Field`]. For many poses a machine is compiled into an
//!    [`evaluate::CompiledModel`], which gives the same numbers on the vector unit.
//! 5. [`analysis`] maps and compares fields over a volume, budgets tolerances, ranks arrangements of the axes.
//! 6. [`convert`] writes a machine under other conventions, and proves that it is the same machine.
//! 7. [`identify`] fits errors to measured deviations and writes a machine file again.
//! 8. [`compensation`] solves for the corrected command and fills what a controller's mechanism can hold.
//! 9. [`controller`] writes the controller's files from templates, reads them back, replays them as the
//!    controller would, and certifies what is left.
//! 10. [`report`] draws pictures.
//! 11. [`cli`] is the program: one file per verb.
//!
//! [`units`], [`diagnostic`] and [`algebra`] are open to every stage after them; otherwise a module
//! imports only what stands above it in this list.
//!
//! ## Invariants
//!
//! - Inside, lengths are in mm and angles in rad; positions of rotary axes are in deg as programmed.
//! - A deviation is actual minus nominal, tool relative to workpiece, in the workpiece frame unless said
//!   otherwise. A correction is what is added to a command. They are different types, and the sign
//!   changes in one function.
//! - The exact model and the model of order n are the same lowering over different algebras.
//! - Only [`cli`] touches files, prints or exits. Other stages read through [`syntax::Files`] and hand
//!   bytes over; files are written whole or not at all.
//! - A stage reports all it finds wrong to [`diagnostic::Diagnostics`] and goes on. "Error" always means
//!   a geometric error; failures are diagnostics.
//! - Same input, same bytes, on any number of threads.
//! - The general algebra defines every result; a compiled plan is tested against it, and what a plan does not
//!   cover goes through it. No bit depends on the vector width.
//! - Lints refuse `unwrap`, `expect` and `panic` outside tests: whatever the input, the answer is meant to be a
//!   diagnostic. Unsafe code stands in one file, `evaluate/compiled/lanes.rs`, with its reasons.
//!
//! ## What is absent
//!
//! Network (but for the page that `report --watch` serves on 127.0.0.1), clock, global state, settings other than the arguments (`NO_COLOR` is honoured). No controller is described in Rust:
//! it is a folder in `templates/`, and only the arithmetic of its replay has a name here.

pub mod algebra;
pub mod analysis;
pub mod api;
pub mod cli;
pub mod compensation;
pub mod controller;
pub mod convert;
pub mod diagnostic;
pub mod evaluate;
pub mod identify;
pub mod lower;
pub mod machine;
pub mod report;
pub mod syntax;
pub mod units;
