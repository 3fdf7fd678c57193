//! Fuzzing of the library in process: files in memory, and oracles that hold for any input.
//!
//! `targets` has one function for each target of libFuzzer, `oracles` what must hold of an answer, `case` the files of an
//! input, `generated` machines from a dictionary of numbers, `seeds` the inputs to begin with. A broken oracle is a panic.
//!
//! `begin` starts a process of libFuzzer. All other modules are also compiled by `tests/it/corpora.rs`, which replays seeds
//! and corpus without a fuzzer.

pub mod begin;
mod case;
mod generated;
mod oracles;
mod seeds;
pub mod targets;

/// The repository.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Half of the time of short inputs is the allocation of small pieces, which this one does faster than the C library.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;
