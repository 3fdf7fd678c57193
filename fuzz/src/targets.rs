//! One function for each target of libFuzzer. All of them take any bytes, and return true for an input that was not
//! refused.

use super::case::Case;
use super::generated::generated;
use super::oracles::{self, CERTIFIED_POSES, answered, compile_options};
use super::seeds;
use abbe::options::{CompensationOptions, MapPoses};
use abbe::sets::LOCK_NAME;
use abbe::{
    EvalOptions, Files, IdentifyOptions, ImportOptions, LoadOptions, MachineFile, MapOptions, MemoryFiles, Run,
    VerifyOptions,
};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// One of so many generated machines is compiled.
const COMPILED: u64 = 16;

/// Machine files, with the files that they name.
pub fn machine_files(bytes: &[u8]) -> bool {
    let case = Case::of(bytes);
    let files = case.files_in(Path::new("")).with("machine.yaml", case.main);
    examined(Path::new("machine.yaml"), &files, oracles::turn(bytes))
}

fn examined(path: &Path, files: &dyn Files, turn: u64) -> bool {
    let run = Run::with(files);
    let Some(file) = answered(abbe::load(path, &LoadOptions::default(), run)) else { return false };
    oracles::machine(&file, turn);
    oracles::map(&file, run);
    true
}

/// Machines of numbers from a dictionary, compiled.
pub fn generated_machines(bytes: &[u8]) -> bool {
    let machine = generated(bytes);
    let run = Run::with(&machine.files);
    let Some(file) = answered(abbe::loads(&machine.text, &LoadOptions::default(), run)) else { return false };
    let turn = oracles::turn(bytes);
    oracles::machine(&file, turn);
    oracles::map(&file, run);
    // Filling, certificate and reading take as long as a hundred other inputs.
    !turn.is_multiple_of(COMPILED) || oracles::compiled(&file, &machine.options, &machine.files)
}

/// Tables of error curves: `measured: [t.csv]` of machines with short, long, and endless axes.
pub fn tables(bytes: &[u8]) -> bool {
    let text = "abbe: 1\nmachine: m\nchain: \"w C' A' Y' b X Z t\"\naxes:\n  X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }\n  \
                Y: { travel: [0, 400], origin: [0, 0, 0] }\n  Z: { travel: [-300, 0], origin: [0, 0, 0] }\n  \
                A: { travel: [-90, 90], origin: [0, 0, 10] }\n  C: { travel: continuous, origin: [1, 2, 3] }\n\
                measured: [t.csv]\n";
    let files = MemoryFiles::new().with("machine.yaml", text).with("t.csv", bytes);
    examined(Path::new("machine.yaml"), &files, oracles::turn(bytes))
}

/// Sets of files, as a controller has them: a first line `CONTROLLER MACHINE`, or `- MACHINE` to recognise them.
pub fn readers(bytes: &[u8]) -> bool {
    let case = Case::of(bytes);
    let (target, machine) = case.head().0.split_once(' ').unwrap_or_default();
    let target = (target != "-").then(|| target.to_owned());
    verified(seeds::machine(machine), target, &case.files_in(Path::new("set")))
}

fn verified(file: &MachineFile, target: Option<String>, files: &MemoryFiles) -> bool {
    let options = VerifyOptions { target, poses: CERTIFIED_POSES, ..VerifyOptions::default() };
    let _ = abbe::sets::set_manifest(Path::new("set"), Run::with(files));
    answered(abbe::verify(file, Path::new("set"), &options, Run::with(files))).is_some()
}

/// Manifests of sets: the text is the lock of a set of `linuxcnc`.
pub fn locks(bytes: &[u8]) -> bool {
    static SET: OnceLock<MemoryFiles> = OnceLock::new();
    let machine = seeds::machine("short");
    let set = SET.get_or_init(|| seeds::set(machine, "linuxcnc"));
    verified(machine, None, &set.clone().with(Path::new("set").join(LOCK_NAME), bytes))
}

/// Manifests of controllers: the text is the `target.yaml` of a folder with the templates of the controller that its
/// first line names, `# linuxcnc`.
pub fn manifests(bytes: &[u8]) -> bool {
    let case = Case::of(bytes);
    let name = case.head().0.trim_start_matches("# ");
    let files = seeds::templates(name).clone().with("templates/own/target.yaml", case.main);
    let templates = Some(PathBuf::from("templates"));
    let compensation = CompensationOptions { templates, ..CompensationOptions::default() };
    let options = abbe::CompileOptions { compensation, ..compile_options("own") };
    // Few manifests are of mechanisms that need a rotary axis.
    let machine = if oracles::turn(bytes).is_multiple_of(4) { "turning" } else { "short" };
    oracles::compiled(seeds::machine(machine), &options, &files)
}

/// Files of instruments: a first line `AXIS ERROR UNIT CONTENTS`, `-` for what the file states.
pub fn imports(bytes: &[u8]) -> bool {
    let case = Case::of(bytes);
    let (head, text) = case.head();
    let mut words = head.split(' ').map(|word| Some(word.to_owned()).filter(|word| word != "-"));
    let mut word = || words.next().flatten();
    let (axis, error, unit, contents) = (word(), word(), word(), word());
    let options = ImportOptions {
        axis,
        error,
        unit,
        contents: contents.map(|_| abbe::options::FileContents::Errors),
        columns: case.files.first().map(|(name, _)| PathBuf::from(name)),
        ..ImportOptions::default()
    };
    let files = case.files_in(Path::new("")).with("runs.csv", text);
    answered(abbe::import("runs.csv", &options, Run::with(&files))).is_some_and(|import| {
        let text = format!(
            "abbe: 1\nmachine: m\nchain: w b {0} t\naxes: {{ {0}: {{ travel: [0, 1] }} }}\nmeasured: [t.csv]\n",
            import.axis
        );
        let files = MemoryFiles::new().with("machine.yaml", text).with("t.csv", import.table.as_str());
        answered(abbe::load("machine.yaml", &LoadOptions::default(), Run::with(&files))).is_some()
    })
}

/// Files of measurements.
pub fn measurements(bytes: &[u8]) -> bool {
    let case = Case::of(bytes);
    let files = case.files_in(Path::new("")).with("data.csv", case.main);
    let mut data = vec![PathBuf::from("data.csv")];
    data.extend(case.files.iter().map(|(name, _)| PathBuf::from(name)));
    let options = IdentifyOptions {
        data,
        fit: ["EXX:poly2", "EYX:poly1", "EC0Y", "tool"].map(str::to_owned).to_vec(),
        machine_file: true,
        accept_undetermined: true,
        ..IdentifyOptions::default()
    };
    let run = Run::with(&files);
    answered(abbe::identify(seeds::machine("linear"), &options, run)).is_some_and(|fit| {
        assert!(fit.parameters.iter().all(|parameter| parameter.value.is_finite()));
        true
    })
}

/// Tool poses and poses of axes.
pub fn tool_poses(bytes: &[u8]) -> bool {
    let files = MemoryFiles::new().with("poses.csv", bytes);
    let run = Run::with(&files);
    let poses = MapPoses::ToolPoses("poses.csv".into());
    let options = MapOptions { poses, samples: 4, ..MapOptions::default() };
    let mapped = answered(abbe::map(seeds::machine(""), &options, run)).is_some();
    let options = EvalOptions { pose_file: Some("poses.csv".into()), ..EvalOptions::default() };
    answered(abbe::eval(seeds::machine(""), &options, run)).is_some() || mapped
}
