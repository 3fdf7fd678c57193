//! `record`: one calibration as a folder, its check, and records in a line.

use super::diff_machines::{DiffMachinesOptions, diff_machines};
use super::second::SecondOptions;
use super::verify::{VerifyOptions, verify};
use crate::diagnostic::Sources;
use crate::file_set::options::CompensationOptions;
use crate::job::machine_file::LoadOptions;
use crate::record::make::{Record, SetUnderTest, make};
use crate::record::trend::{RecordTrend, trend};
use crate::run::{Call, Reply, Run};
use serde_json::json;
use std::path::{Path, PathBuf};

pub use crate::record::check::check_record;

/// Options of [`record`] and [`record_trend`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct RecordOptions {
    /// Tool of the machine; the first by default.
    pub tool: Option<String>,
    /// Options of the compensation, with which the sets are verified.
    pub compensation: CompensationOptions,
    /// Number of poses of certificates and comparisons.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// File of the private key that signs a record: ed25519, PKCS #8 in PEM.
    pub sign: Option<PathBuf>,
}

impl Default for RecordOptions {
    fn default() -> Self {
        Self { tool: None, compensation: CompensationOptions::default(), poses: 2000, seed: 1, sign: None }
    }
}

/// Makes the record of a calibration from its description; nothing is written.
///
/// Fails if the description does not fit, if a file that it names or the key cannot be read, and if an installed set
/// does not replay.
pub fn record(path: &Path, options: &RecordOptions, run: Run) -> Reply<Record> {
    Call::answer(run, &Sources::default(), |call| {
        let tool = LoadOptions { tool: options.tool.clone() };
        let sign = options.sign.as_deref();
        make(call, path, &tool, sign, &|call, machine, SetUnderTest { folder, installed, second }| {
            let RecordOptions { compensation, poses, seed, .. } = options.clone();
            let second = second.map_or_else(SecondOptions::default, |of| SecondOptions {
                data: of.data,
                axis_poses: of.axis_poses,
                type_b: of.type_b,
                ..SecondOptions::default()
            });
            let options = VerifyOptions { compensation, poses, seed, installed, second, ..VerifyOptions::default() };
            let answer = verify(machine, &folder, &options, call.run);
            call.take(answer).map(|report| json!(report))
        })
    })
}

/// Puts records of one machine in a line.
///
/// Fails if a folder is no record or has changed, and if the records are of several machines, or one is given twice.
pub fn record_trend(folders: &[PathBuf], options: &RecordOptions, run: Run) -> Reply<RecordTrend> {
    Call::answer(run, &Sources::default(), |call| {
        let tool = LoadOptions { tool: options.tool.clone() };
        trend(call, folders, &tool, &|call, machines| {
            let RecordOptions { poses, seed, .. } = *options;
            let compared = DiffMachinesOptions { poses, seed, ..DiffMachinesOptions::default() };
            let answer = diff_machines(&machines, &compared, call.run);
            call.take(answer)
        })
    })
}
