//! The replay of every target against the controllers of `support::controllers`, written again from the manuals: on the
//! files of one machine, within the tables, at their points, and far outside, in both directions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use abbe::controller::{ControllerTarget, ReadBack, Replay};
use abbe::diagnostic::{Diagnostics, Rendering, render};
use abbe::machine::{Approach, Machine};

use crate::loaded;
use crate::oracle::machines::Sample;
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::support::controllers::{Files, loaded as controller};
use crate::support::{Entry, compile, config, tree, writes_tables};

/// The files of a set by name, without those of the set that takes it back.
pub fn files(out: &Path) -> Files {
    let own = tree(out).into_iter().filter(|(path, _)| !path.starts_with(out.join("restore")));
    let text = |(path, entry): (PathBuf, Entry)| {
        let Entry::File(bytes) = entry else { panic!("{path:?}") };
        (path.file_name().unwrap().to_str().unwrap().to_owned(), String::from_utf8(bytes).unwrap())
    };
    own.map(text).collect()
}

/// Returns the content of a set as the program reads it.
pub fn read(
    target: &ControllerTarget,
    machine: &Machine,
    files: &Files,
) -> Result<abbe::compensation::CorrectionTables, Diagnostics> {
    let mut diagnostics = Diagnostics::default();
    let wanted = [target.table_files(machine), target.index_files()].concat();
    let found = files.iter().filter(|(name, _)| wanted.contains(name));
    let texts: Vec<ReadBack> = found.map(|(name, text)| ReadBack::new(&**name, &**text)).collect();
    let tables = target.read(machine, &texts, &mut diagnostics);
    tables.filter(|_| !diagnostics.is_refused()).ok_or(diagnostics)
}

/// Controller order: letter and whether it turns without end, with the index in the machine.
pub fn order(machine: &Machine, target: &ControllerTarget) -> (Vec<(char, bool)>, Vec<usize>) {
    let letters = abbe::controller::axis_letters(machine, target.manifest.axis_letters.as_ref(), None).unwrap();
    let axes = letters.iter().map(|known| (known.letter.chars().next().unwrap(), machine.is_continuous(known.axis)));
    (axes.collect(), letters.iter().map(|known| known.axis).collect())
}

/// Positions within the travels and outside, many of them at whole steps.
fn positions(machine: &Machine, random: &mut Random) -> Vec<f64> {
    let mut position = |axis: &abbe::machine::Axis| {
        let (min, max) = axis.travel.interval();
        let way = max - min;
        let q = random.between(min - 0.3 * way, max + 0.3 * way);
        if random.chance(0.3) { (q / 25.0).round() * 25.0 } else { q }
    };
    machine.axes().iter().map(&mut position).collect()
}

/// The largest difference between the program's replay and the controller's.
fn difference(path: &Path, sample: &Sample, name: &str, out: &Path, rounds: usize) -> (f64, f64) {
    let machine = loaded::machine(path);
    let target = ControllerTarget::builtin(name).unwrap();
    let files = files(out);
    let tables = read(&target, &machine, &files)
        .unwrap_or_else(|diagnostics| panic!("{name}: {}", render(&diagnostics, Rendering::default())));
    let replay = Replay::new(&machine, &target, &tables);
    let (axes, indices) = order(&machine, &target);
    let theirs = controller(name, &files, &axes, sample).unwrap_or_else(|| panic!("{name}: not read"));
    let mut random = Random::new(77);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..rounds {
        let pose = positions(&machine, &mut random);
        let ordered: Vec<f64> = indices.iter().map(|axis| pose[*axis]).collect();
        for (approach, reverse) in [(Approach::Forward, false), (Approach::Reverse, true)] {
            let ours = replay.addition(&approach.at_pose(&pose));
            let theirs = theirs(&ordered, reverse);
            for (axis, value) in indices.iter().zip(theirs) {
                worst = worst.max((ours[*axis] - value).abs());
                largest = largest.max(value.abs());
            }
        }
    }
    (worst, largest)
}

/// Three axes and a table, curves that bend, forward and reverse.
const ERRORS: &str = "EXX: { forward: { points: [[-200 mm, 5 um], [-60 mm, -2 um], [40 mm, 3 um], [200 mm, -4 um]] }, \
     reverse: { points: [[-200 mm, 8 um], [200 mm, -1 um]] } }\n  EYX: { points: [[-200 mm, 2 um], [0 mm, 6 um], [200 mm, -3 um]] }\n  \
     EZX: { points: [[-200 mm, -5 um], [100 mm, 5 um], [200 mm, 0 um]] }\n  EYY: { polynomial: [0 um, 60 um/m] }\n  \
     EBX: { points: [[-200 mm, 12 urad], [200 mm, -9 urad]] }\n  EXZ: { points: [[0 mm, 1 um], [100 mm, 7 um]] }\n  EC0Y: 40 urad\n  EB0Z: -25 urad\n  EA0Z: 15 urad";

const TABLE: &str = "\n  ECC: { harmonics: { 1: [30 urad, 20 urad], 3: [7 urad, -9 urad] } }\n  EXC: { harmonics: { 1: [3 um, 2 um] } }\n  \
     EX0C: 6 um\n  EB0C: 20 urad";

pub fn machine(folder: &Folder, table: bool) -> PathBuf {
    let (chain, axis, errors) = if table {
        (
            "w C' b X Y Z t",
            "\n  C: { controller: 4, travel: continuous, origin: [10, 50, -20] }",
            format!("{ERRORS}{TABLE}"),
        )
    } else {
        ("w b X Y Z t", "", ERRORS.to_owned())
    };
    let turn = if table { ", C: { step: 45 deg }" } else { "" };
    folder.write(
        if table { "table.yaml" } else { "three.yaml" },
        &format!(
            "abbe: 1\nmachine: example\nchain: \"{chain}\"\naxes:\n  X: {{ controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }}\n  \
             Y: {{ controller: 2, travel: [0 mm, 120 mm], origin: [0, 0, 0] }}\n  Z: {{ controller: 3, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}{axis}\ntool: {{ gauge: [0, 60, 50], length: 80 mm }}\n\
             errors:\n  {errors}\nvolume: {{ step: 50 mm{turn} }}\n"
        ),
    )
}

/// Geometry only: the errors are the files'.
pub fn geometry(table: bool) -> Sample {
    use crate::oracle::machines::Extra;
    use crate::oracle::rigid::{self, Axis};
    let linear = |name: &str, k: usize| Axis {
        name: name.into(),
        rotary: false,
        workpiece: false,
        direct: None,
        direction: std::array::from_fn(|i| f64::from(i == k)),
        origin: [0.0; 3],
        location: [0.0; 6],
    };
    let mut walk = vec![linear("X", 0), linear("Y", 1), linear("Z", 2)];
    if table {
        let c = Axis { rotary: true, workpiece: true, origin: [10.0, 50.0, -20.0], ..linear("C", 2) };
        walk.insert(0, c);
    }
    let axes =
        walk.iter().map(|a| Extra { travel: (!a.rotary).then_some([0.0, 1.0]), errors: Default::default() }).collect();
    let rigid = rigid::Machine { walk, gauge: [0.0, 60.0, 50.0], offset: [0.0, 0.0, -80.0], ..Default::default() };
    Sample { rigid, axes, branches: false }
}

/// Formats whose files another interpreter reads, and the source of the tolerance: the last place of a double in the
/// sums.
fn targets() -> impl Iterator<Item = &'static str> {
    abbe::controller::NAMES.into_iter().filter(|name| writes_tables(name) && *name != "grid-csv")
}

#[test]
fn every_replay_does_what_the_controller_does() {
    let folder = Folder::new();
    let mut seen = BTreeMap::new();
    for table in [false, true] {
        let (path, sample) = (machine(&folder, table), geometry(table));
        for name in targets() {
            let out = folder.path(&format!("{name}-{table}"));
            let more = ["--accept-unverified", "--poses", "1", "--nodes", "600"];
            let scale: &[&str] = if name == "grbl" { &["--scale", "X=80,Y=80,Z=400"] } else { &[] };
            compile(&path, name, &out, &[&more, scale].concat()).json();
            let rounds = if name == "grid-json" { 60 } else { 400 };
            let (worst, largest) = difference(&path, &sample, name, &out, rounds);
            assert!(largest > 0.002, "{name}: nothing is corrected");
            seen.insert((name, table), worst);
            // Doubles of some hundred mm or deg lose this much; KMotion stores whole positions.
            assert!(worst < 2e-12, "{name}, table {table}: {worst} mm or deg");
        }
    }
    let worst = seen.iter().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
    println!("largest difference {:.1e} mm or deg, {:?}", worst.1, worst.0);
}

/// The plain sum of displacements on machines of every kind: table-table, head-table, head-head, four axes.
#[test]
fn volumetric_curves_act_as_the_plain_sum() {
    let folder = Folder::new();
    let mut done = 0;
    for name in
        ["trunnion", "tt-bc", "ht-b-c", "hh-ca-gantry", "hmc-4ax", "gantry-3ax", "tt-ab-desktop", "vmc-cframe-754"]
    {
        let path = config(&format!("{name}.yaml"));
        for target in ["isg-volcomp", "etalon-exchange"] {
            let out = folder.path(&format!("{name}-{target}"));
            let run = compile(&path, target, &out, &["--poses", "1", "--max-correction", "20 mm, 50 mrad, 0.5"]);
            if run.code == Some(1) && ["E0708", "E0601"].iter().any(|code| run.err.contains(code)) {
                continue;
            }
            run.json();
            let mut sample = crate::support::config::sample(&path);
            // The files have no points of linear axes: their errors turn about the zero of the machine.
            sample.rigid.walk.iter_mut().filter(|axis| !axis.rotary).for_each(|axis| axis.origin = [0.0; 3]);
            let (worst, largest) = difference(&path, &sample, target, &out, 200);
            println!("{name} {target}: {worst:.1e} of {largest:.1e} mm");
            assert!(largest > 0.005 && worst < 1e-10, "{name} {target}: {worst} of {largest} mm");
            done += 1;
        }
    }
    assert!(done >= 10, "{done}");
}
