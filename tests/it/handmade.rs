//! Files with the defects that hands and programs make, one by one for every target: each is refused with its place, or
//! read as the controller would read it, with a warning where that is not the intended meaning. Random damage is in
//! `defects`.

use std::path::Path;

use abbe::controller::ControllerTarget;
use abbe::machine::Machine;

use crate::loaded;
use crate::oracle::program::Folder;
use crate::replays;
use crate::support::controllers::Files;
use crate::support::{compile, config, names, verify, writes_tables};

/// Outcome of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Refused,
    /// Read, with the same effect.
    Same,
    /// Read, with another effect, and a warning that the table ends before the axis.
    Short,
}

use Outcome::{Refused, Same, Short};

fn lines(text: &str) -> Vec<&str> {
    text.split_inclusive('\n').collect()
}

/// The middle one of the lines that hold numbers and are no comments.
fn middle(text: &str) -> usize {
    let numbers = |line: &str| {
        line.contains(|c: char| c.is_ascii_digit()) && !line.trim_start().starts_with([';', '#', '/', '%'])
    };
    let all: Vec<usize> = lines(text).iter().enumerate().filter(|(_, line)| numbers(line)).map(|(i, _)| i).collect();
    all[all.len() / 2]
}

/// The text with its middle line changed.
fn with_middle(text: &str, change: impl Fn(&str) -> String) -> String {
    let at = middle(text);
    let changed = |(i, line): (usize, &&str)| if i == at { change(line) } else { (*line).to_owned() };
    lines(text).iter().enumerate().map(changed).collect()
}

/// The last run of letters, digits and points of a line, and the text before it.
fn last_cell(line: &str) -> (&str, &str) {
    let line = line.trim_end_matches(['\n', ',', ']', ';', '}']);
    let start = line.rfind(|c: char| !(c.is_ascii_alphanumeric() || c == '.')).map_or(0, |i| i + 1);
    line.split_at(start)
}

/// The text with the number at the end of its middle line exchanged for a word.
fn number_to(text: &str, word: &str) -> String {
    with_middle(text, |line| {
        let (before, cell) = last_cell(line);
        format!("{before}{word}{}", &line[before.len() + cell.len()..])
    })
}

type Defect = (&'static str, fn(&str) -> String);

const DEFECTS: [Defect; 11] = [
    ("half of the lines", |text| lines(text)[..lines(text).len() / 2].concat()),
    ("end gone", |text| lines(text)[..lines(text).len() - 1].concat()),
    ("cell missing", |text| {
        with_middle(text, |line| format!("{}\n", last_cell(line).0.trim_end_matches([' ', ',', '=', '-', '+', 'P'])))
    }),
    ("point twice", |text| with_middle(text, |line| line.repeat(2))),
    ("NaN", |text| number_to(text, "NaN")),
    ("decimal comma", |text| number_to(text, "0,125")),
    ("byte order mark", |text| format!("\u{feff}{text}")),
    ("CRLF", |text| text.replace('\n', "\r\n")),
    ("text behind the end", |text| format!("{text}and that was all\n")),
    ("empty", |_| String::new()),
    ("twice over", |text| text.repeat(2)),
];

/// Defects that are not refused. CRLF is a line's end to every controller here. A line of a key again, with the same
/// value, changes nothing (RepRapFirmware, Marlin and Grbl set it twice; Klipper's parser takes the last one). A file cut at
/// a line's end is whole to LinuxCNC and to ISG's reader, which have no end mark.
const READ: [(&str, &str, Outcome); 12] = [
    ("linuxcnc", "half of the lines", Short),
    ("linuxcnc", "end gone", Short),
    ("isg-volcomp", "half of the lines", Short),
    ("marlin", "point twice", Same),
    ("marlin", "twice over", Same),
    ("marlin", "end gone", Same),
    ("klipper", "point twice", Same),
    ("klipper", "twice over", Same),
    ("reprapfirmware", "point twice", Same),
    ("reprapfirmware", "twice over", Same),
    ("grbl", "point twice", Same),
    ("grbl", "twice over", Same),
];

fn outcome(name: &str, defect: &str) -> Outcome {
    let listed = READ.iter().find(|(target, read, _)| (*target, *read) == (name, defect));
    listed.map_or(if defect == "CRLF" { Same } else { Refused }, |(.., outcome)| *outcome)
}

fn found(
    target: &ControllerTarget,
    machine: &Machine,
    files: &Files,
    sound: &abbe::compensation::CorrectionTables,
) -> Option<Outcome> {
    match replays::read(target, machine, files) {
        Err(diagnostics) => {
            let placed =
                |d: &abbe::diagnostic::Diagnostic| !d.labels.is_empty() && d.help.is_some() && d.code == "E0704";
            diagnostics.iter().all(placed).then_some(Refused)
        }
        Ok(tables) if tables.same_effect(sound) => Some(Same),
        Ok(tables) => {
            let said = target.coverage_warnings(machine, &tables);
            (!said.is_empty() && said.iter().all(|d| d.code == "W0705" && d.help.is_some())).then_some(Short)
        }
    }
}

#[test]
fn every_defect_of_every_target_is_refused_or_read_and_said() {
    let folder = Folder::new();
    let (table, three) = (replays::machine(&folder, true), replays::machine(&folder, false));
    let mut wrong = Vec::new();
    for name in abbe::controller::NAMES.into_iter().filter(|name| writes_tables(name)) {
        let path = if matches!(name, "klipper" | "marlin") { &three } else { &table };
        let machine = loaded::machine(path);
        let out = folder.path(name);
        let scale: &[&str] = if name == "grbl" { &["--scale", "X=80,Y=80,Z=400"] } else { &[] };
        compile(path, name, &out, &[&["--accept-unverified", "--poses", "1", "--nodes", "300"], scale].concat()).json();
        let target = ControllerTarget::builtin(name).unwrap();
        let files = replays::files(&out);
        let sound = replays::read(&target, &machine, &files).ok().unwrap();
        assert!(target.coverage_warnings(&machine, &sound).is_empty(), "{name}");
        let file = target.table_files(&machine).into_iter().find(|file| files.contains_key(file)).unwrap();
        for (defect, damage) in DEFECTS {
            let mut damaged = files.clone();
            damaged.insert(file.clone(), damage(&files[&file]));
            let (found, meant) = (found(&target, &machine, &damaged, &sound), outcome(name, defect));
            if found != Some(meant) {
                wrong.push(format!("{name} {file} {defect}: {found:?} and not {meant:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A sound set, a file of it changed, and `verify` of that without the manifest.
fn changed(machine: &Path, target: &str, file: &str, change: (&str, &str)) -> crate::support::Run {
    let folder = Folder::new();
    let out = folder.path("out");
    compile(machine, target, &out, &["--accept-unverified", "--poses", "1"]).json();
    std::fs::remove_file(out.join("abbe.lock.json")).unwrap();
    let text = std::fs::read_to_string(out.join(file)).unwrap();
    assert!(text.contains(change.0), "{target}: no {} in {file}", change.0);
    std::fs::write(out.join(file), text.replacen(change.0, change.1, 1)).unwrap();
    verify(machine, &out, &["--target", target, "--poses", "1"])
}

/// Axes that are others than the file is for, or that the machine does not have; counts and steps that do not fit.
#[test]
fn wrong_axes_counts_and_switches_are_refused() {
    let folder = Folder::new();
    let (table, three) = (replays::machine(&folder, true), replays::machine(&folder, false));
    for (target, file, from, to, words) in [
        ("sinumerik-cec", "_N_NC_CEC_INI", "INPUT_AXIS[0]=(AX", "INPUT_AXIS[0]=(AX9", "no axis `9"),
        ("sinumerik-cec", "_N_NC_CEC_INI", "$AN_CEC_MAX[0]=", "$AN_CEC_MAX[0]=1", "do not fit together"),
        ("sinumerik-enc", "_N_AX1_EEC_INI", "AX1]", "AX2]", "`axis_number` is given twice"),
        ("fanuc-pitch", "PITCH_X.TXT", "N03605Q1A1", "N03605Q1A2", "`axis_number` is given twice"),
        // 3605#0 is off: the controller would not look at the points for the negative direction.
        ("fanuc-pitch", "PITCH_X.TXT", "N03605Q1A1P00000001", "N03605Q1A1P00000000", "the negative direction"),
        ("fanuc-pitch", "PITCH_X.TXT", "N03627Q1A1P", "N03625Q1A1M", "the negative direction"),
        ("heidenhain-com", "X_AXIS.COM", "BEGIN X_AXIS", "BEGIN Y_AXIS", "another axis"),
        ("heidenhain-com", "X_AXIS.COM", ".COM MM", ".COM INCH", "the first line"),
        ("heidenhain-com", "X_AXIS.COM", "AXISPOS X", "AXISPOS Q", "no axis `Q`"),
        ("twincat-axis", "achskw_X.lis", "kopf.achs_nr 1", "kopf.achs_nr 2", "not that of the axis"),
        ("twincat-axis", "achskw_X.lis", "master_ax_nr 4", "master_ax_nr 9", "no axis `9`"),
        ("pmac", "compensation.pmc", "#2D,#3", "#9D,#3", "no axis `9`"),
        ("isg-volcomp", "volcomp.csv", "X0C", "X0W", "70468"),
        ("etalon-exchange", "etalon.txt", "[EXX]", "[EXW]", "no error of this machine"),
        ("grid-csv", "corrections.csv", "dX [mm]", "dQ [mm]", "`corrections.csv`"),
    ] {
        changed(&table, target, file, (from, to)).refused("E0704").says(words);
    }
    let other = changed(&three, "linuxcnc-matrixkins", "matrixkins.hal", ("setp matrixkins.", "setp matrixkin."));
    other.refused("E0704").says("no pin of `matrixkins`");
    let tilt = "abbe: 1\nmachine: tilt\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: { controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }\n  \
                Y: { controller: 2, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }\n  Z: { controller: 3, travel: [0 mm, 200 mm], origin: [0, 0, 0] }\n  A: { controller: 4, travel: [-90 deg, 90 deg], sense: direct }\n  \
                C: { controller: 5, travel: continuous, sense: direct }\nerrors:\n  EX0C: 5 um\nvolume: { step: 100 mm, A: { step: 45 deg }, C: { step: 45 deg } }\n";
    let tilt = folder.write("tilt.yaml", tilt);
    let other = changed(&tilt, "linuxcnc-trt", "trt.hal", ("setp xyzac-trt-kins.", "setp xyzbc-trt-kins."));
    other.refused("E0704").says("is no parameter of this machine");
}

/// Beckhoff 296429067: errors of X that depend on Z too. The block is refused with the line of its names.
#[test]
fn isg_blocks_over_two_axes_are_refused_with_a_remedy() {
    let folder = Folder::new();
    let machine = replays::machine(&folder, false);
    let single = "X EXX EYX\n-200 0.005 0.002\n200 -0.003 -0.001\n";
    let set = |text: &str| {
        let folder = Folder::new();
        let _ = folder.write("volcomp.csv", text);
        verify(&machine, &folder.path(""), &["--target", "isg-volcomp", "--poses", "1"])
    };
    set(single).json();
    for (names, argument) in [("Z X EXX EYX", "0"), ("X Z EXX EYX", "0"), ("A X EXX EYX", "0")] {
        let rows: String = single.lines().skip(1).map(|row| format!("{argument} {row}\n")).collect();
        let run = set(&format!("C0Y\n0.00004\n#\n{names}\n{rows}"));
        run.refused("E0704").says("volcomp.csv:4").says("a block over two axes").says("at one position of the other");
    }
    set("B EXB\n0 0.001\n90 0.002\n").refused("E0704").says("the machine has no axis `B`");
}

/// The controller turns about the lines that the file gives: those of the machine file, at any of their points.
#[test]
fn isg_lines_of_turns_are_those_of_the_machine_file() {
    let (folder, machine) = (Folder::new(), config("trunnion.yaml"));
    let out = folder.path("out");
    compile(&machine, "isg-volcomp", &out, &["--poses", "1"]).json();
    let text = std::fs::read_to_string(out.join("volcomp.csv")).unwrap();
    let (head, last) = text.trim_end().rsplit_once('\n').unwrap();
    let set = |changes: &[(usize, &str)]| {
        let mut cells: Vec<&str> = last.split(' ').collect();
        changes.iter().for_each(|(column, value)| cells[*column] = value);
        let folder = Folder::new();
        let _ = folder.write("volcomp.csv", &format!("{head}\n{}\n", cells.join(" ")));
        verify(&machine, &folder.path(""), &["--target", "isg-volcomp", "--poses", "1"])
    };
    // P0, N0, then P and V of C and of A: C runs along Z, A along X.
    // A line off by hundredths of a millimetre counts as its product with the angles: nothing.
    for same in [&[][..], &[(0, "0.01")], &[(8, "12.5")], &[(12, "-3")], &[(6, "250.012")]] {
        set(same).json();
    }
    for (other, words) in [
        (&[(0, "7")][..], "the point of the tool"),
        (&[(5, "1")], "the direction of the tool"),
        (&[(6, "251.1")], "the point of `C`"),
        (&[(14, "-349")], "the point of `A`"),
        (&[(11, "-1")], "the direction of `C`"),
        (&[(11, "0")], "the direction of `C`"),
        (&[(11, "2")], "the direction of `C`"),
        (&[(16, "0.001")], "the direction of `A`"),
    ] {
        set(other).refused("E0704").says(words);
    }
    let names = "P0X P0Y P0Z N0X N0Y N0Z PXC PYC PZC VXC VYC VZC PXA PYA PZA VXA VYA VZA";
    assert!(head.ends_with(names));
    for part in [0..5, 0..6, 3..6] {
        let left = |text: &str| {
            let cells = text.split(' ').enumerate().filter(|(i, _)| !part.contains(&(i.wrapping_sub(12))));
            cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(" ")
        };
        let text = format!("{}{}\n{}\n", head.strip_suffix(names).unwrap(), left(names), left(last));
        let folder = Folder::new();
        let _ = folder.write("volcomp.csv", &text);
        let run = verify(&machine, &folder.path(""), &["--target", "isg-volcomp", "--poses", "1"]);
        // Without any line of A the controller has one of its own.
        if part == (0..6) {
            let _ = run.json();
        } else {
            run.refused("E0704").says("the line of `A` is not whole");
        }
    }
}

/// The table of an axis that the machine does not have is reported as ignored.
#[test]
fn a_table_without_an_axis_is_said() {
    let folder = Folder::new();
    let machine = replays::machine(&folder, false);
    let out = folder.path("out");
    compile(&machine, "twincat-axis", &out, &["--poses", "1"]).json();
    let sound = verify(&machine, &out, &["--poses", "1"]);
    assert!(!sound.err.contains("W0711"), "{}", sound.err);
    std::fs::copy(
        out.join(names(&out).into_iter().find(|n| n.starts_with("achskw")).unwrap()),
        out.join("achskw_B.lis"),
    )
    .unwrap();
    verify(&machine, &out, &["--poses", "1"]).says("W0711").says("achskw_B.lis");
}

/// `diff` of a module with itself, and with one of another machine: a shift of EXX by 3 um moves the tip by that.
#[test]
fn modules_are_compared_too() {
    let folder = Folder::new();
    let sets = ["0 um", "3 um"].map(|error| {
        let text = std::fs::read_to_string(replays::machine(&folder, false)).unwrap();
        let with = text.replace(
            "  EC0Y: 40 urad",
            &format!("  EC0Y: 40 urad\n  EXZ: {{ points: [[0 mm, {error}], [100 mm, {error}]] }}"),
        );
        let with = with.replace("  EXZ: { points: [[0 mm, 1 um], [100 mm, 7 um]] }\n", "");
        let machine = folder.write(&format!("{}.yaml", &error[..1]), &with);
        let out = folder.path(&error[..1]);
        compile(&machine, "linuxcnc-kins", &out, &["--poses", "1"]).json();
        (machine, out)
    });
    let diff = |a: usize, b: usize| {
        let mut run = crate::support::abbe();
        run.arg("diff").arg(&sets[0].0).args([&sets[a].1, &sets[b].1]).args(["--format", "json", "--poses", "50"]);
        crate::support::number(&crate::support::Run::of(&mut run).json(), "/position_um/max")
    };
    assert_eq!(diff(0, 0), 0.0);
    assert!((diff(0, 1) - 3.0).abs() < 1e-3, "{}", diff(0, 1));
}
