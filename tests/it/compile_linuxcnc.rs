//! `compile --target linuxcnc`: tables as the measured loader takes them, trims solved against the curves by
//! other means, and the controller's arithmetic bit for bit.

use std::path::{Path, PathBuf};

use crate::oracle::curves::{Curve, Error, Points, Travel};
use crate::oracle::machines::{Extra, Sample, combinations};
use crate::oracle::matrix::norm;
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::rigid::{Axis, Conventions, Machine};
use crate::oracle::yaml;
use crate::support::comp::CorrectionTable;
use crate::support::config::sample;
use crate::support::{Run, compile, config, left, names, verify};

/// A set of tables with the axis that each is for.
struct Set {
    /// Name of the axis in the machine file, and its table, in the order of the joints.
    joints: Vec<(String, CorrectionTable)>,
}

impl Set {
    /// Reads a folder; `axes` are those of the machine.
    fn read(folder: &Path, axes: &[String]) -> Self {
        let files: Vec<String> = names(folder).into_iter().filter(|name| name.ends_with(".comp")).collect();
        let letter = |name: &String| name.trim_end_matches(".comp").rsplit('_').next().unwrap().to_owned();
        let letters: Vec<String> = files.iter().map(letter).collect();
        // At most one axis of a machine here has no letter of its own.
        let strange = || axes.iter().find(|axis| !letters.contains(axis)).unwrap();
        let read = |(joint, (name, letter)): (usize, (&String, &String))| {
            assert_eq!(name, &format!("joint_{joint}_{letter}.comp"));
            let table = CorrectionTable::read(&std::fs::read_to_string(folder.join(name)).unwrap());
            let axis = if axes.contains(letter) { letter } else { strange() };
            (axis.clone(), table.unwrap_or_else(|fault| panic!("{name}: {fault}")))
        };
        let joints: Vec<_> = files.iter().zip(&letters).enumerate().map(read).collect();
        assert_eq!(joints.len(), axes.len());
        let order = "XYZABCUVW";
        assert!(letters.is_sorted_by_key(|letter| order.find(letter.as_str())), "{letters:?}");
        Self { joints }
    }
}

/// Every machine file in `configs/`.
fn all_configs() -> Vec<PathBuf> {
    let mut all = Vec::new();
    for folder in [config(""), config("papers"), config("variants")] {
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        all.extend(files.filter(|path| path.extension().is_some_and(|e| e == "yaml")));
    }
    all.sort();
    assert!(all.len() >= 23, "{all:?}");
    all
}

/// Forms of curves that the reader of these tests does not know; the random machines below have them.
const OTHER_FORMS: [&str; 3] = ["holub-2015", "holub-2015-as-printed", "hrdina-vasik-2014"];

fn name(path: &Path) -> &str {
    path.file_stem().unwrap().to_str().unwrap()
}

/// Axis names of a machine file, from its chain line.
fn axes(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("chain: "));
    let base = text.lines().find_map(|line| line.strip_prefix("extends: "));
    match (line, base) {
        (Some(chain), _) => {
            let words =
                chain.trim_matches('"').split(' ').filter(|w| !["w", "b", "t"].contains(w) && !w.starts_with('('));
            words.map(|word| word.trim_end_matches('\'').to_owned()).collect()
        }
        (None, Some(base)) => axes(&path.parent().unwrap().join(base)),
        (None, None) => panic!("{path:?} has no chain"),
    }
}

#[test]
fn every_config_gives_tables_that_the_controller_takes() {
    for path in all_configs() {
        let folder = Folder::new();
        let out = folder.path("out");
        let run = compile(&path, "linuxcnc", &out, &["--poses", "10"]);
        run.json();
        let axes = axes(&path);
        let without_letter = axes.iter().any(|axis| !"XYZABCUVW".contains(axis.as_str()));
        assert_eq!(run.err.contains("W0601"), without_letter, "{path:?}: {}", run.err);
        let set = Set::read(&out, &axes);
        if OTHER_FORMS.contains(&name(&path)) {
            continue;
        }
        let machine = sample(&path);
        for (axis, table) in &set.joints {
            let index = machine.rigid.walk.iter().position(|known| known.name == *axis).unwrap();
            covers(&machine.axes[index], table);
            trims(&machine, index, table);
        }
        limits(&std::fs::read_to_string(out.join("compensation.inc")).unwrap(), &set, &machine);
    }
}

/// Checks that a table goes from end to end of the travel; two turns about zero of a continuous axis.
fn covers(extra: &Extra, table: &CorrectionTable) {
    let [low, high] = extra.travel.unwrap_or([-360.0, 360.0]);
    assert_eq!([table.nominal[0], table.nominal[table.nominal.len() - 1]], [low, high]);
}

/// Checks the lines that load the tables, and that limits are no wider than the tables.
fn limits(fragment: &str, set: &Set, machine: &Sample) {
    for (joint, (axis, table)) in set.joints.iter().enumerate() {
        let section = fragment.split(&format!("[JOINT_{joint}]")).nth(1).unwrap().split("[JOINT").next().unwrap();
        let value = |key: &str| {
            let line = section.lines().find_map(|line| line.strip_prefix(&format!("{key} = ")));
            line.unwrap_or_else(|| panic!("{key} of joint {joint} in {fragment}"))
        };
        let rotary = machine.rigid.walk.iter().any(|known| known.name == *axis && known.rotary);
        assert_eq!(value("TYPE"), if rotary { "ANGULAR" } else { "LINEAR" });
        let ends = [table.nominal[0], table.nominal[table.nominal.len() - 1]];
        assert_eq!([value("MIN_LIMIT"), value("MAX_LIMIT")].map(|v| v.parse::<f64>().unwrap()), ends);
        assert!(value("COMP_FILE").starts_with(&format!("joint_{joint}_")));
        assert_eq!(value("COMP_FILE_TYPE"), "1");
    }
}

/// Trims against the curves themselves: the error along the axis at the corrected command, by a fixed point.
fn trims(machine: &Sample, index: usize, table: &CorrectionTable) {
    let axis = &machine.rigid.walk[index];
    let extra = &machine.axes[index];
    let c = machine.rigid.conventions;
    let first = if axis.rotary { 3 } else { 0 };
    let value = |k: usize, at: f64, travel| extra.errors[k].as_ref().map_or(0.0, |e: &Error| e.at(at, travel));
    let along = |at: f64, travel| {
        let sum: f64 = (0..3).map(|k| axis.direction[k] * value(first + k, at, travel)).sum();
        sum / norm(axis.direction) * if axis.rotary { 1.0_f64.to_degrees() } else { 1.0 }
    };
    // A body's error is seen from the tool the other way round; so is a motion in its own sense.
    let seen = if axis.workpiece && c.body { -1.0 } else { 1.0 };
    let sense = if axis.workpiece && axis.direct.unwrap_or(c.direct) { -1.0 } else { 1.0 };
    for (travel, trims) in [Travel::Forward, Travel::Reverse].into_iter().zip(&table.trims) {
        for (nominal, trim) in table.nominal.iter().zip(trims) {
            let mut solved = 0.0;
            for _ in 0..20 {
                solved = -sense * seen * along(nominal + solved, travel);
            }
            // Half a last place. On the workpiece side the angular errors turn the whole travel, which loses
            // its cosine: q e^2 / 2, and q e^2 where joints are linearised.
            let tilt: f64 = (3..6).map(|k| value(k, *nominal, travel).powi(2)).sum();
            let share = if c.linearised { 1.0 } else { 0.5 };
            let mut second_order = if axis.workpiece { share * tilt * nominal.abs() } else { 0.0 };
            if axis.rotary {
                // Three rotations of this size do not quite add up as vectors.
                second_order = tilt.sqrt().powi(3).to_degrees();
            } else if c.body {
                // The inverse of a body's error turns its translations: straightness shows by its angle.
                let shift: f64 = (0..3).map(|k| value(k, *nominal, travel).powi(2)).sum();
                second_order += (tilt * shift).sqrt();
            }
            let apart = (trim - solved).abs();
            assert!(
                apart <= 0.5e-9 + 1e-15 + second_order,
                "{} at {nominal}: {trim}, not {solved}: {apart:e} ({c:?})",
                axis.name
            );
        }
    }
}

/// Every joint of a five-axis and of a six-axis machine, at nodes, between and beyond them, in both directions.
#[test]
fn the_replay_is_the_controllers_arithmetic_bit_for_bit() {
    for file in ["trunnion.yaml", "hh-bd-ram.yaml", "papers/holub-2015.yaml"] {
        let folder = Folder::new();
        let (machine, out) = (config(file), folder.path("out"));
        compile(&machine, "linuxcnc", &out, &["--poses", "10"]).json();
        let set = Set::read(&out, &axes(&machine));
        let mut random = Random::new(5);
        let mut asked = Vec::new();
        for (joint, (_, table)) in set.joints.iter().enumerate() {
            let (low, high) = (table.nominal[0], table.nominal[table.nominal.len() - 1]);
            let between = (0..300).map(|_| random.between(low - 50.0, high + 50.0));
            let positions: Vec<f64> = table.nominal.iter().copied().chain(between).collect();
            asked.extend(positions.into_iter().flat_map(|q| [(joint, q, false), (joint, q, true)]));
        }
        let word = |reverse| if reverse { "reverse" } else { "forward" };
        let rows: String =
            asked.iter().map(|(joint, q, reverse)| format!("{joint},{},{q}\n", word(*reverse))).collect();
        let positions = folder.write("positions.csv", &format!("joint,direction,position\n{rows}"));
        let run = verify(&machine, &out, &["--replay", positions.to_str().unwrap()]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        let mut lines = run.out.lines();
        assert_eq!(lines.next(), Some("joint,direction,position,correction"));
        for (joint, position, reverse) in asked {
            let cells: Vec<&str> = lines.next().unwrap().split(',').collect();
            assert_eq!(cells[..2], [joint.to_string().as_str(), word(reverse)]);
            assert_eq!(cells[2].parse::<f64>().unwrap(), position);
            let ours = set.joints[joint].1.added(position, reverse);
            assert_eq!(
                cells[3].parse::<f64>().unwrap().to_bits(),
                (ours + 0.0).to_bits(),
                "{file}, joint {joint} at {position}"
            );
        }
        assert_eq!(lines.next(), None);
    }
}

/// One axis with an error along itself, in every sense: the trim is the one that takes the tool where it belongs.
#[test]
fn signs_of_trims() {
    for rotary in [false, true] {
        // Seen from the workpiece the tool is 10 um (urad) too far in +, or in - with the signs of a body.
        for (workpiece, direct, body, sign) in [
            (false, false, false, -1.0),
            (false, true, true, -1.0),
            (true, false, false, -1.0),
            (true, false, true, 1.0),
            (true, true, false, 1.0),
            (true, true, true, -1.0),
        ] {
            for own_sense in [false, true] {
                let machine = one_axis(rotary, workpiece, direct, body, own_sense);
                let table = table_of(&machine);
                let expected = sign * if rotary { 10e-6_f64.to_degrees() } else { 0.010 };
                for trim in table.trims.iter().flatten() {
                    assert!((trim - expected).abs() <= 0.5e-9, "{trim}, not {expected}: {machine:?}");
                }
                arrives(&machine, &table);
            }
        }
    }
}

/// A machine of one axis with EXX or ECC of 10 um or urad, given by points.
fn one_axis(rotary: bool, workpiece: bool, direct: bool, body: bool, own_sense: bool) -> Sample {
    let k = if rotary { 5 } else { 0 };
    let (value, name) = if rotary { (10e-6, "C") } else { (0.010, "X") };
    let points = Points { at: vec![-200.0, 200.0], values: vec![value; 2], cubic: false, periodic: false, file: false };
    let mut errors: [Option<Error>; 6] = Default::default();
    errors[k] = Some(Error { forward: Curve::Points(points), reverse: None });
    let direction = if rotary { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    // The sense may be given for the axis or for the whole machine.
    let sense = (workpiece && own_sense).then_some(direct);
    let conventions = Conventions { direct: direct && !own_sense, body, ..Conventions::default() };
    let axis = Axis {
        name: name.into(),
        rotary,
        workpiece,
        direct: sense,
        direction,
        origin: [70.0, 20.0, 5.0],
        location: [0.0; 6],
    };
    let rigid = Machine {
        conventions,
        walk: vec![axis],
        gauge: [300.0, 40.0, 0.0],
        offset: [0.0, 0.0, -80.0],
        ..Machine::default()
    };
    Sample { rigid, axes: vec![Extra { travel: Some([-200.0, 200.0]), errors }], branches: false }
}

/// Compiles a machine of one axis.
fn table_of(machine: &Sample) -> CorrectionTable {
    let folder = Folder::new();
    yaml::write(machine, &folder);
    compile(&folder.path("machine.yaml"), "linuxcnc", &folder.path("out"), &["--poses", "10"]).json();
    Set::read(&folder.path("out"), &[machine.rigid.walk[0].name.clone()]).joints.remove(0).1
}

/// The tip of the corrected command is where the ideal tip of the nominal one is.
fn arrives(machine: &Sample, table: &CorrectionTable) {
    for position in [-180.0, -10.0, 0.0, 33.0, 150.0] {
        for (reverse, travel) in [(false, Travel::Forward), (true, Travel::Reverse)] {
            let pose = vec![position];
            let command = left::corrected(&pose, &[table.added(position, reverse)]);
            let [bare, after] = [&pose, &command].map(|c| norm(left::position(machine, &pose, c, travel)));
            assert!(bare > 1e-3, "nothing to correct: {bare} at {pose:?}");
            // Half a last place and the single precision of a trim of 0.01 mm, or of 6e-4 deg at 240 mm.
            assert!(after < 2e-9, "{after:e} of {bare:e} mm left at {pose:?}: {machine:?}");
        }
    }
}

/// Every form of curve, every convention, any direction: at the points of the tables the error of the axis alone
/// vanishes.
#[test]
fn trims_of_random_machines() {
    let mut random = Random::new(12);
    let mut tables = 0;
    for conventions in combinations() {
        let sample = Sample::random(&mut random, conventions, 1e-5);
        let folder = Folder::new();
        let text = yaml::write(&sample, &folder);
        let run = compile(&folder.path("machine.yaml"), "linuxcnc", &folder.path("out"), &["--poses", "10"]);
        let rotary = sample.rigid.walk.iter().filter(|axis| axis.rotary).count();
        if rotary > 3 {
            run.refused("E0601");
            continue;
        }
        run.json();
        tables += solved(&sample, &folder.path("out"), &run, &text);
    }
    assert!(tables > 60, "{tables} tables");
}

fn solved(sample: &Sample, out: &Path, run: &Run, text: &str) -> usize {
    let files: Vec<String> = names(out).into_iter().filter(|name| name.ends_with(".comp")).collect();
    assert_eq!(files.len(), sample.rigid.walk.len(), "{text}");
    for file in &files {
        let letter = file.trim_end_matches(".comp").rsplit('_').next().unwrap();
        let table = CorrectionTable::read(&std::fs::read_to_string(out.join(file)).unwrap()).unwrap();
        let index = sample.rigid.walk.iter().position(|axis| axis.name == letter || renamed(run, &axis.name, letter));
        let index = index.unwrap_or_else(|| panic!("{file} is nobody's: {}\n{text}", run.err));
        let rotary = sample.rigid.walk[index].rotary;
        for (travel, trims) in [Travel::Forward, Travel::Reverse].into_iter().zip(&table.trims) {
            for (position, trim) in table.nominal.iter().zip(trims) {
                let left = left::along(sample, index, *position, *trim, travel).abs();
                // Half a last place in mm or deg, and the rounding of half a metre in the model.
                let rounding = if rotary { 0.5e-9_f64.to_radians() + 1e-14 } else { 0.5e-9 + 1e-12 };
                assert!(left <= rounding, "{file} at {position}: {left:e} left with {trim}\n{text}");
            }
        }
    }
    files.len()
}

/// True if a warning states that this axis is written under this letter.
fn renamed(run: &Run, axis: &str, letter: &str) -> bool {
    run.err.contains(&format!("W0601]: axis `{axis}` is written as `{letter}`"))
}

/// Points of a curve closer than the increment of the file are one line, not two equal ones.
#[test]
fn knots_that_the_file_cannot_tell_apart() {
    let folder = Folder::new();
    let machine = folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: close\nchain: w b X t\naxes: { X: { travel: [0 mm, 600 mm], origin: [0, 0, 0] } }\n\
         errors: { EXX: { points: [[0 mm, 0 um], [100 mm, 1 um], [100.0000004 mm, 1 um], [600 mm, 0 um]] } }\n",
    );
    compile(&machine, "linuxcnc", &folder.path("out"), &[]).json();
    let table = Set::read(&folder.path("out"), &["X".into()]).joints.remove(0).1;
    assert_eq!(table.nominal, [0.0, 100.0, 600.0]);
}
