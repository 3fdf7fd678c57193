//! Inputs to begin with, from what the repository has: configurations, wrong files, blocks of the documentation, a set of
//! every controller.

use super::ROOT;
use super::case::joined;
use super::oracles::{compile_options, stored};
use abbe::controller::NAMES;
use abbe::sets::LOCK_NAME;
use abbe::{LoadOptions, MachineFile, MemoryFiles, Run};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Machines with few knots: every execution reads a set of theirs back.
const MACHINES: [(&str, &str); 3] = [
    (
        "turning",
        "abbe: 1\nmachine: turning\nchain: w C' b X Y Z t\naxes:\n  X: { travel: [0, 100], origin: [0, 0, 0] }\n  \
         Y: { travel: [0, 80], origin: [0, 0, 0] }\n  Z: { travel: [-50, 0], origin: [0, 0, 0] }\n  \
         C: { travel: continuous, origin: [50, 40, 0] }\ntool: { gauge: [0, 0, 0], length: 60 mm }\nerrors:\n  \
         EXX: { points: [[0, 0 um], [50, 3 um], [100, 1 um]] }\n  EYX: { points: [[0, 1 um], [100, 4 um]] }\n  \
         ECX: { points: [[0, 0 urad], [100, 30 urad]] }\n  ECC: { harmonics: { 1: [20 urad, 5 urad] } }\n  \
         EX0C: 5 um\n  EC0Y: 12 urad\n  \
         EZZ: { forward: { points: [[-50, 2 um], [0, 0 um]] }, reverse: { points: [[-50, 4 um], [0, 1 um]] } }\n\
         volume: { step: 50 mm, C: { step: 90 deg } }\n",
    ),
    (
        "linear",
        "abbe: 1\nmachine: linear\nchain: w X' b Y Z t\naxes:\n  X: { travel: [0, 100], origin: [0, 0, 0] }\n  \
         Y: { travel: [0, 80], origin: [0, 0, 0] }\n  Z: { travel: [-50, 0], origin: [0, 0, 0] }\nerrors:\n  \
         EXX: { points: [[0, 0 um], [50, 3 um], [100, 1 um]] }\n  EAY: { points: [[0, 0 urad], [80, 9 urad]] }\n  \
         EZZ: { forward: { points: [[-50, 2 um], [0, 0 um]] }, reverse: { points: [[-50, 4 um], [0, 1 um]] } }\n\
         volume: { step: 50 mm }\n",
    ),
    (
        "short",
        "abbe: 1\nmachine: short\nchain: w X' b Y t\naxes:\n  X: { travel: [0, 100], origin: [0, 0, 0] }\n  \
         Y: { travel: [0, 80], origin: [0, 0, 0] }\nerrors:\n  EXX: { points: [[0, 0 um], [50, 3 um], [100, 1 um]] }\n\
         volume: { step: 100 mm }\n",
    ),
];

/// Readings of each kind, of the machine `linear`.
const READINGS: [&str; 5] = [
    "X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um]\n0,0,0,0,1,0\n50,40,-10,3,1,0\n100,80,-20,1,0,2\n20,10,-50,1,2,3\n",
    "X,EXX [um],EYX [um]\n0,0,1\n25,1,1\n50,3,0\n75,2,1\n100,1,2\n",
    "X,Y,Z,rel.dx [um],rel.dy [um],run\n0,0,0,0,0,1\n50,0,0,2,1,1\n100,40,0,3,1,1\n0,80,0,0,2,2\n90,10,0,1,2,2\n",
    "X,along [um],run\n0,0,1\n40,2,1\n100,1,1\n0,0,2\n60,3,2\n100,2,2\n",
    "X,Y,Z,to.X,to.Y,to.Z,dl [um]\n0,0,0,100,80,0,3\n0,80,0,100,0,0,1\n0,0,-50,100,0,0,2\n0,0,0,0,80,-50,1\n50,0,0,50,80,0,1\n",
];

/// Tool poses and poses of axes, of the machine `turning`.
const POSES: [&str; 4] = [
    "X,Y,Z\n10,20,-10\n-20,5,-30\n",
    "X,Y,Z,I,J,K,feature\n10,20,-70,0,0,1,a\n20,10,-80,0,0,1,b\n",
    "UNITS/MM\nGOTO/10,20,-70,0,0,1\nRAPID\nGODLTA/1,2,3\n",
    "X, C\n50,90\n100,180\n",
];

/// Maximum size of a seed: larger ones slow every mutation down.
const MAX_BYTES: usize = 24_000;

/// Number of seeds of bytes.
const BYTE_SEEDS: u64 = 200;

/// Returns one of the machines that sets, readings and tool poses are about; the first one for another name.
pub fn machine(name: &str) -> &'static MachineFile {
    static KNOWN: OnceLock<Vec<MachineFile>> = OnceLock::new();
    let known = KNOWN.get_or_init(|| MACHINES.iter().map(|(_, text)| loaded(text)).collect());
    let index = MACHINES.iter().position(|(known, _)| *known == name).unwrap_or(0);
    &known[index]
}

fn loaded(text: &str) -> MachineFile {
    match abbe::loads(text, &LoadOptions::default(), Run::default()) {
        Ok(answer) => answer.value,
        Err(refusal) => panic!("{text}: {:?}", refusal.records()),
    }
}

/// Returns the set of a target in the folder `set`; an empty one where the target has nothing for the machine.
pub fn set(file: &MachineFile, target: &str) -> MemoryFiles {
    match abbe::compile(file, &compile_options(target), Run::default()) {
        Ok(set) => stored(Path::new("set"), &set.files, &set.lock.to_text()),
        Err(_) => MemoryFiles::new(),
    }
}

/// Returns the templates of a built-in target, of the first one for another name, in the folder `templates/own`.
pub fn templates(target: &str) -> &'static MemoryFiles {
    static KNOWN: OnceLock<Vec<(&str, MemoryFiles)>> = OnceLock::new();
    let known = KNOWN.get_or_init(|| NAMES.map(|name| (name, templates_in(name, Path::new("templates/own")))).into());
    &known.iter().find(|(name, _)| *name == target).unwrap_or(&known[0]).1
}

fn templates_in(target: &str, folder: &Path) -> MemoryFiles {
    let template = |all: MemoryFiles, path: PathBuf| {
        let name = path.file_name().unwrap_or_default();
        all.with(folder.join(name), read(&path))
    };
    files(&format!("templates/{target}"), "j2").into_iter().fold(MemoryFiles::new(), template)
}

/// Returns the seeds of a target by name.
pub fn seeds(target: &str) -> Vec<Vec<u8>> {
    let mut seeds = match target {
        "generated_machines" => (0..BYTE_SEEDS).map(bytes).collect(),
        "imports" => measured().into_iter().map(|text| [b"- - um errors\n", text.as_slice()].concat()).collect(),
        "locks" => NAMES.iter().filter_map(|name| lock(name)).collect(),
        "machine_files" => machine_files(),
        "manifests" => manifests(),
        "measurements" => own(&READINGS).chain(measured()).collect(),
        "tool_poses" => own(&POSES).chain(measured()).collect(),
        "readers" => MACHINES.iter().flat_map(|(machine, _)| NAMES.map(|name| reader(machine, name))).collect(),
        "tables" => [files("configs/errors", "csv"), files("tests/diagnostics", "csv")]
            .concat()
            .iter()
            .map(|path| read(path))
            .collect(),
        _ => Vec::new(),
    };
    seeds.retain(|seed| !seed.is_empty() && seed.len() <= MAX_BYTES);
    seeds
}

fn own<'a>(texts: &'a [&str]) -> impl Iterator<Item = Vec<u8>> + 'a {
    texts.iter().map(|text| text.as_bytes().to_vec())
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

/// All files with an ending below a folder of the repository.
fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(ROOT).join(folder)];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn machine_files() -> Vec<Vec<u8>> {
    let configs = files("configs", "yaml").into_iter().map(|path| whole(&path));
    let wrong = files("tests/diagnostics", "yaml").into_iter().map(|path| {
        let beside = files(&path.parent().unwrap_or(&path).to_string_lossy(), "csv");
        let named: Vec<_> = beside.iter().map(|csv| (name_of(csv), read(csv))).collect();
        let main = String::from_utf8_lossy(&read(&path)).into_owned();
        joined(&main, named.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())))
    });
    configs.chain(wrong).chain(blocks("yaml")).collect()
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A machine file with the files that it is read from, by their paths from its folder.
fn whole(path: &Path) -> Vec<u8> {
    let Ok(file) = abbe::load(path, &LoadOptions::default(), Run::on_disk()) else { return read(path) };
    let folder = path.parent().unwrap_or(path).to_string_lossy().into_owned() + "/";
    let mut sources =
        file.sources().iter().map(|(name, text)| (name.strip_prefix(&folder).unwrap_or(name), text.as_bytes()));
    let main = sources.next().map_or_else(String::new, |(_, text)| String::from_utf8_lossy(text).into_owned());
    joined(&main, sources)
}

/// Fenced blocks of the documentation.
fn blocks(kind: &str) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    for page in files("docs", "md") {
        let text = String::from_utf8_lossy(&read(&page)).into_owned();
        let fence = format!("```{kind}\n");
        found.extend(
            text.split(&fence).skip(1).filter_map(|rest| Some(rest.split_once("\n```")?.0.as_bytes().to_vec())),
        );
    }
    found
}

/// Readings, runs and tool poses: the tables of the documentation and of the tests.
fn measured() -> Vec<Vec<u8>> {
    let listed = [files("docs/examples", "csv"), files("tests/data", "csv")].concat();
    blocks("csv").into_iter().chain(blocks("text")).chain(listed.iter().map(|path| read(path))).collect()
}

fn manifests() -> Vec<Vec<u8>> {
    let manifest = |name: &&str| {
        let path = Path::new(ROOT).join("templates").join(name).join("target.yaml");
        let text = String::from_utf8_lossy(&read(&path)).replace(&format!("target: {name}\n"), "target: own\n");
        format!("# {name}\n{text}").into_bytes()
    };
    NAMES.iter().map(manifest).collect()
}

fn lock(target: &str) -> Option<Vec<u8>> {
    let set = abbe::compile(machine("short"), &compile_options(target), Run::default()).ok()?;
    Some(set.lock.to_text().into_bytes())
}

fn reader(name: &str, target: &str) -> Vec<u8> {
    let Ok(set) = abbe::compile(machine(name), &compile_options(target), Run::default()) else { return Vec::new() };
    let lock = set.lock.to_text();
    let files = set.files.iter().map(|file| (file.name.as_str(), file.bytes.as_slice()));
    joined(&format!("{target} {name}\n"), files.chain([(LOCK_NAME, lock.as_bytes())]))
}

/// Bytes of a sequence that a number begins.
fn bytes(number: u64) -> Vec<u8> {
    let mut state = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    (0..160).map(|_| next()).collect()
}
