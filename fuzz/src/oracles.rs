//! What holds of every answer, whatever the input.

use abbe::compensation::{CorrectionTables, LatticeRequest, Scope};
use abbe::controller::{ControllerTarget, NAMES};
use abbe::evaluate::{Evaluation, Frame, Order, Random, evaluate};
use abbe::machine::{Approach, Machine};
use abbe::sets::{LOCK_NAME, RenderedFile};
use abbe::text::{Rendering, render};
use abbe::{Answer, CompileOptions, Diagnostics, Files, MachineFile, MemoryFiles, Run, VerifyOptions};
use std::path::Path;

/// Maximum number of nodes of a lattice.
pub const MAX_NODES: usize = 400;

/// Poses of a certificate.
pub const CERTIFIED_POSES: usize = 1;

/// Random poses at which a machine is evaluated, beside two corners of its volume.
const POSES: usize = 2;

/// Deviation of the compiled evaluator from the general algebra, as a fraction of the largest deviation.
const FRACTION: f64 = 1e-9;

/// The same, as a fraction of the largest coordinate: rounding of positions in the general algebra.
const ROUNDING: f64 = 1e-13;

/// Returns the value; a refusal has a diagnostic, and every diagnostic can be shown.
pub fn answered<T>(result: Result<Answer<T>, Diagnostics>) -> Option<T> {
    match result {
        Ok(Answer { value, warnings }) => {
            assert!(!warnings.is_refused(), "an answer with a refusal: {}", shown(&warnings));
            let _ = shown(&warnings);
            Some(value)
        }
        Err(refusal) => {
            assert!(refusal.is_refused(), "a refusal without a reason: {}", shown(&refusal));
            assert!(!shown(&refusal).is_empty());
            None
        }
    }
}

/// The value of a job that must not be refused.
fn accepted<T>(what: &str, result: Result<Answer<T>, Diagnostics>) -> T {
    result.unwrap_or_else(|refusal| panic!("{what}: {}", shown(&refusal))).value
}

fn shown(diagnostics: &Diagnostics) -> String {
    render(diagnostics, Rendering::default())
}

/// The model of a machine is finite and that of the general algebra, for every order, from a side and at poses that the
/// turn of the input chooses.
pub fn machine(file: &MachineFile, turn: u64) {
    let _ = abbe::summary(file);
    let random = Random::of(file, POSES, turn);
    let poses: Vec<Vec<f64>> = (0..POSES).map(|index| random.get(index)).chain(corners(file)).collect();
    let sides = [Approach::Mean, Approach::Forward, Approach::Reverse];
    for (order, k) in [Order::Exact, Order::Degree(1), Order::Degree(2)].into_iter().zip(turn % 3..) {
        model(file, order, sides[k as usize % sides.len()], &poses);
    }
}

/// A number that hangs on all bytes of an input (FNV-1a): by it an input takes its turn at checks of which each takes as
/// long as many others.
pub fn turn(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step) >> 16
}

/// The two opposite corners of the volume.
fn corners(machine: &Machine) -> [Vec<f64>; 2] {
    let volume = machine.volume();
    [volume.iter().map(|grid| grid.min).collect(), volume.iter().map(|grid| grid.max).collect()]
}

fn model(file: &MachineFile, order: Order, approach: Approach, poses: &[Vec<f64>]) {
    let model = abbe::compile_model(file, order, approach);
    let columns: Vec<Vec<f64>> = (0..file.axes().len()).map(|k| poses.iter().map(|pose| pose[k]).collect()).collect();
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let Ok(found) = model.deviations(&columns) else { return };
    let general: Vec<Evaluation> =
        poses.iter().map(|pose| evaluate(file, &approach.at_pose(pose), order, Frame::Workpiece)).collect();
    let largest = |of: fn(&Evaluation) -> f64| general.iter().map(of).fold(0.0, f64::max);
    let mm = FRACTION * largest(|at| at.deviation.position.amax()) + ROUNDING * size(file, &general);
    let rad = FRACTION * largest(|at| at.deviation.rotation.amax()) + ROUNDING;
    for (k, at) in general.iter().enumerate() {
        let pairs = [
            ([found.dx[k], found.dy[k], found.dz[k]], at.deviation.position, mm),
            ([found.wx[k], found.wy[k], found.wz[k]], at.deviation.rotation, rad),
        ];
        for (found, general, tolerance) in pairs {
            let near = (0..3).all(|i| found[i].is_finite() && (found[i] - general[i]).abs() <= tolerance);
            assert!(near, "{order} {approach:?} {:?}: {found:?} {general:?} {tolerance:e}", poses[k]);
        }
    }
}

/// The largest coordinate of a machine, mm.
fn size(machine: &Machine, at: &[Evaluation]) -> f64 {
    let origins = machine.axes().iter().flat_map(|axis| axis.origin);
    let volume = machine.volume().iter().flat_map(|grid| [grid.min, grid.max]);
    let nominal = at.iter().flat_map(|at| [at.nominal.x, at.nominal.y, at.nominal.z]);
    let all = origins.chain(machine.workpiece()).chain(volume).chain(nominal);
    all.fold(1.0, |size: f64, x| size.max(x.abs()))
}

/// A map of few poses is finite.
pub fn map(file: &MachineFile, run: Run) {
    let poses = abbe::options::MapPoses::Random(2);
    let options = abbe::MapOptions { poses, samples: 2, ..abbe::MapOptions::default() };
    if let Some(map) = answered(abbe::map(file, &options, run)) {
        let summary = [map.position_um.max, map.position_um.rms, map.position_um.p95];
        assert!(summary.iter().all(|x| x.is_finite()), "{summary:?}");
    }
}

/// Options of a compilation that is over soon.
pub fn compile_options(target: &str) -> CompileOptions {
    CompileOptions {
        target: target.to_owned(),
        poses: CERTIFIED_POSES,
        accept_unverified: true,
        max_nodes: MAX_NODES,
        ..CompileOptions::default()
    }
}

/// The nodes of the tables that a target takes are finite and rise, and its own files are accepted. True if there are
/// any.
pub fn compiled(file: &MachineFile, options: &CompileOptions, files: &dyn Files) -> bool {
    let run = Run::with(files);
    if NAMES.contains(&options.target.as_str()) {
        nodes(file, &options.target);
    }
    let Some(set) = answered(abbe::compile(file, options, run)) else { return false };
    let (folder, compensation) = (Path::new("out"), options.compensation.clone());
    let stored = stored(folder, &set.files, &set.lock.to_text());
    let verify = VerifyOptions { compensation, poses: options.poses, ..VerifyOptions::default() };
    let both = Both(&stored, files);
    let found = accepted("the own set", abbe::verify(file, folder, &verify, Run::with(&both)));
    let figures = |certificate: &abbe::results::CertificateReport| {
        let all = &certificate.compensated;
        [all.position_um.max, all.position_um.rms, all.position_um.p95]
    };
    let (written, found) = (figures(&set.certificate), figures(&found));
    assert!(written.iter().chain(&found).all(|x| x.is_finite()), "{written:?} {found:?}");
    assert_eq!(written, found, "the certificates of compile and verify");
    true
}

fn nodes(file: &MachineFile, name: &str) {
    let Some(target) = ControllerTarget::builtin(name) else { return };
    if target.manifest.kinematics().is_some() || target.refusal(file).is_some() {
        return;
    }
    let axes = (0..file.axes().len()).collect();
    let tables = target.tables(file, &LatticeRequest { axes, max_nodes: MAX_NODES, scope: Scope::POSITION });
    rising(&tables);
}

fn rising(tables: &CorrectionTables) {
    let lists = tables.tables.iter().flat_map(|table| &table.nodes);
    for nodes in lists.chain(tables.errors.iter().map(|curve| &curve.positions)) {
        assert!(nodes.is_sorted_by(|a, b| a < b), "nodes do not rise: {nodes:?}");
    }
}

/// A set in a folder in memory.
pub fn stored(folder: &Path, files: &[RenderedFile], lock: &str) -> MemoryFiles {
    let with = |all: MemoryFiles, file: &RenderedFile| all.with(folder.join(&file.name), file.bytes.clone());
    files.iter().fold(MemoryFiles::new(), with).with(folder.join(LOCK_NAME), lock)
}

/// Files in front of other files.
struct Both<'a>(&'a MemoryFiles, &'a dyn Files);

impl Files for Both<'_> {
    fn read(&self, path: &Path) -> Result<Vec<u8>, abbe::syntax::ReadFailure> {
        self.0.read(path).or_else(|_| self.1.read(path))
    }

    fn entries(&self, folder: &Path) -> Vec<abbe::syntax::FolderEntry> {
        let own = self.0.entries(folder);
        if own.is_empty() { self.1.entries(folder) } else { own }
    }
}
