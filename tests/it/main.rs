//! Integration tests.

// A test that panics is a test that fails: nothing to be careful about.
// The platform's sine is another oracle than ours.
#![allow(clippy::disallowed_methods)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr, clippy::print_stdout)]

mod annotations;
mod axis_numbers;
mod bad_input;
mod bound_words;
mod bounded;
mod budget;
mod buildable;
mod certificate;
mod classify;
mod compare;
mod compile;
mod compile_linuxcnc;
mod compile_refusals;
mod compiled_columns;
mod composed_sets;
mod configs;
mod convert;
mod corpora;
mod coverage;
mod datum;
mod defects;
mod determinism;
mod diagnostics;
mod diff_machines;
mod enumerate;
mod equal_bounds;
mod equations;
mod eval_exact;
mod eval_order;
mod every_target;
mod examples;
mod faults;
mod figures;
mod fits;
#[cfg(target_os = "linux")]
mod foreign_folders;
mod forms;
mod frames;
mod goal;
mod golden_signs;
mod handmade;
#[cfg(target_os = "linux")]
mod hostile;
mod identify;
mod import;
mod import_layouts;
#[cfg(target_os = "linux")]
mod inputs_kept;
mod instrument;
mod interactions;
mod job_files;
mod job_verbs;
#[cfg(target_os = "linux")]
mod killed;
mod kinematic_chain;
mod kinematic_parameters;
mod kinematics_views;
mod language;
mod linuxcnc_constants;
mod linuxcnc_kinematics;
mod linuxcnc_kins;
mod loaded;
mod locate;
mod map;
mod map_files;
mod measurements;
mod mechanisms;
mod minimum_zone;
mod normals;
mod options;
mod oracle;
mod paper_2015;
mod papers_way;
mod parameter_pages;
mod parametrisation;
mod part_rotation;
mod paths;
mod placement;
mod plan;
mod prior;
mod priors;
mod program;
mod progress;
mod published;
mod rank;
mod ranks;
mod reach;
mod readme;
mod recognise;
mod reconfigure;
mod record;
mod reference;
mod release;
mod remarks;
mod replays;
mod report;
mod repository;
mod robots;
mod rooms;
mod schema;
mod second_hour;
mod show;
mod sides;
mod spikes;
mod straightness;
mod support;
mod suspect;
#[cfg(target_os = "linux")]
mod system_faults;
mod targets;
mod test_pieces;
mod theorems;
mod tidy;
mod tool_poses;
mod tracker;
mod uncertainty;
mod values_and_bounds;
mod vectors;
mod weighing;
mod weil;
