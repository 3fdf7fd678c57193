//! Every output option of every verb against every input: whatever the output is called, no input changes.

use crate::oracle::program::Folder;
use crate::support::{Run, abbe};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A verb with all its inputs, and the options that name an output.
struct Verb {
    name: &'static str,
    /// Arguments of a run that succeeds; `END` stands for the ending of the inputs.
    arguments: &'static [&'static str],
    /// Names of the files that it reads, without their ending; `templates` for those of a target.
    inputs: &'static [&'static str],
    outputs: &'static [&'static str],
}

/// Options that name a file or a folder that is read.
const INPUTS: [&str; 16] = [
    "--axis-poses",
    "--check",
    "--columns",
    "--confined",
    "--cost",
    "--data",
    "--ini",
    "--installed",
    "--job",
    "--key",
    "--predict",
    "--replay",
    "--sign",
    "--templates",
    "--tool-poses",
    "--trend",
];

/// Inputs that are outputs too, or the outputs of other runs of the same verb.
const STATES: [&str; 2] = ["--merge", "--state"];

const MACHINE: &[&str] = &["machine", "base", "table"];

const VERBS: [Verb; 27] = [
    Verb {
        name: "show",
        arguments: &["show", "machine.END"],
        inputs: MACHINE,
        outputs: &["--svg", "--png", "--curves", "--zero-pose"],
    },
    Verb {
        name: "map",
        arguments: &["map", "machine.END", "--tool-poses", "poses.END", "--target", "own", "--templates", "templates"],
        inputs: &["machine", "base", "table", "poses", "templates"],
        outputs: &["--csv", "--json", "--parquet", "--vtk", "--svg", "--png"],
    },
    Verb {
        name: "map of poses of the axes",
        arguments: &["map", "machine.END", "--axis-poses", "axes.END"],
        inputs: &["machine", "base", "table", "axes"],
        outputs: &["--csv", "--svg"],
    },
    Verb {
        name: "budget",
        arguments: &["budget", "bounded.END", "--samples", "2", "--job", "job.END"],
        inputs: &["bounded", "base", "job", "poses"],
        outputs: &["--pareto", "--waterfall"],
    },
    // Apart, for the proof of a goal draws 100,000 machines.
    Verb {
        name: "budget with a goal",
        arguments: &["budget", "bounded.END", "--samples", "2", "--poses", "1", "--goal", "1 mm", "--cost", "cost.END"],
        inputs: &["cost"],
        outputs: &["--pareto", "--waterfall"],
    },
    Verb {
        name: "budget in parts",
        arguments: &["budget", "bounded.END", "--samples", "2", "--shard", "1/1"],
        inputs: &["bounded", "base"],
        outputs: &["--state"],
    },
    Verb {
        name: "enumerate",
        arguments: &["enumerate", "bounded.END", "--samples", "2", "--max-samples", "2", "--tool-poses", "poses.END"],
        inputs: &["bounded", "base", "poses"],
        outputs: &["--state"],
    },
    Verb {
        name: "identify",
        arguments: &["identify", "machine.END", "--data", "data.END", "--fit", "EXX:poly1"],
        inputs: &["machine", "base", "table", "data"],
        outputs: &["--out", "--pictures"],
    },
    Verb {
        name: "identify with points",
        arguments: &[
            "identify",
            "machine.END",
            "--data",
            "points.END",
            "--axis-poses",
            "where.END",
            "--fit",
            "EXX:poly1",
            "--accept-undetermined",
        ],
        inputs: &["machine", "base", "table", "points", "where"],
        outputs: &["--out"],
    },
    Verb {
        name: "import",
        arguments: &["import", "runs.END", "--columns", "columns.END"],
        inputs: &["runs", "columns"],
        outputs: &["--out", "--svg"],
    },
    Verb {
        name: "import of touches",
        arguments: &["import", "touches.END", "--machine", "turning.END"],
        inputs: &["turning", "touches"],
        outputs: &["--out"],
    },
    Verb { name: "figures", arguments: &["figures", "circle", "circle.END"], inputs: &["circle"], outputs: &["--svg"] },
    Verb {
        name: "convert",
        arguments: &["convert", "machine.END", "--to", "linearised"],
        inputs: MACHINE,
        outputs: &["--out"],
    },
    Verb {
        name: "compile",
        arguments: &["compile", "machine.END", "--poses", "3", "--target", "own", "--templates", "templates"],
        inputs: &["machine", "base", "table", "templates"],
        outputs: &["--out"],
    },
    Verb {
        name: "compile with an archive",
        arguments: &[
            "compile",
            "machine.END",
            "--poses",
            "3",
            "--target",
            "own",
            "--templates",
            "templates",
            "--out",
            "compiled",
        ],
        inputs: &["machine", "base", "table", "templates"],
        outputs: &["--record"],
    },
    Verb {
        name: "record",
        arguments: &["record", "record.END"],
        inputs: &["record", "machine", "base", "table", "data"],
        outputs: &["--out"],
    },
    Verb {
        name: "records in a line",
        arguments: &["record", "--trend", "records/a", "records/b"],
        inputs: &["records"],
        outputs: &["--svg"],
    },
    Verb {
        name: "locate",
        arguments: &["locate", "turning.END", "lines.END"],
        inputs: &["turning", "lines"],
        outputs: &["--out"],
    },
    Verb {
        name: "compile on top of a set",
        arguments: &["compile", "machine.END", "--poses", "3", "--target", "grid-csv", "--installed", "installed"],
        inputs: &["machine", "base", "table", "installed"],
        outputs: &["--out"],
    },
    Verb {
        name: "compile for drives",
        arguments: &["compile", "turning.END", "--poses", "3", "--target", "linuxcnc-kins", "--ini", "drives.END"],
        inputs: &["turning", "drives"],
        outputs: &["--out"],
    },
    Verb {
        name: "budget put together",
        arguments: &["budget", "bounded.END", "--samples", "2", "--merge", "part.END"],
        inputs: &["bounded", "base", "part"],
        outputs: &["--pareto", "--waterfall"],
    },
    Verb {
        name: "report",
        arguments: &[
            "report",
            "machine.END",
            "--poses",
            "3",
            "--tool-poses",
            "poses.END",
            "--target",
            "own",
            "--templates",
            "templates",
        ],
        inputs: &["machine", "base", "table", "poses", "templates"],
        outputs: &["--out"],
    },
    Verb {
        name: "reach",
        arguments: &["reach", "machine.END"],
        inputs: MACHINE,
        outputs: &["--svg", "--png", "--vtk"],
    },
    Verb {
        name: "reach at places",
        arguments: &["reach", "machine.END", "--job", "job.END", "--place", "X=0..1:2"],
        inputs: &["machine", "base", "table", "job", "poses"],
        outputs: &["--svg", "--png"],
    },
    Verb {
        name: "map at places",
        arguments: &["map", "machine.END", "--tool-poses", "poses.END", "--place", "X=0..1:2"],
        inputs: &["machine", "base", "table", "poses"],
        outputs: &["--svg", "--png"],
    },
    Verb {
        name: "instrument",
        arguments: &["instrument", "machine.END", "ball-bar"],
        inputs: MACHINE,
        outputs: &["--svg"],
    },
    Verb {
        name: "instrument with a sequence",
        arguments: &["instrument", "turning.END", "r-test", "--points", "5"],
        inputs: &["turning"],
        outputs: &["--sequence"],
    },
];

impl Verb {
    fn reads(&self, path: &Path) -> bool {
        let within =
            |folder: &str| path.parent().is_some_and(|at| at.components().any(|part| part.as_os_str() == folder));
        let folder = ["templates", "records", "installed"].into_iter().find(|folder| within(folder));
        self.inputs.contains(&folder.unwrap_or_else(|| path.file_stem().unwrap().to_str().unwrap()))
    }
}

/// Endings with which all options together are tried: pictures take no other.
const ENDINGS: [&str; 3] = ["yaml", "svg", "png"];

/// Writes every input of every verb with this ending.
fn inputs(folder: &Folder, ending: &str) {
    sources(folder, ending);
    // What other verbs write.
    let machine = format!("machine.{ending}");
    let made = |arguments: &[&str]| {
        let run = Run::of(abbe().args(arguments).arg("--quiet").current_dir(folder.path("")));
        assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.err);
    };
    made(&["compile", &machine, "--poses", "3", "--target", "grid-csv", "--out", "installed"]);
    let (bounded, part) = (format!("bounded.{ending}"), format!("part.{ending}"));
    made(&["budget", &bounded, "--samples", "2", "--shard", "1/1", "--state", &part]);
    let description = folder.path(&format!("record.{ending}"));
    let text = std::fs::read_to_string(&description).unwrap();
    made(&["record", description.to_str().unwrap(), "--out", "records/a"]);
    std::fs::write(&description, text.replace("id: R\n", "id: S\n").replace("-11-02", "-11-20")).unwrap();
    made(&["record", description.to_str().unwrap(), "--out", "records/b"]);
}

fn sources(folder: &Folder, ending: &str) {
    let axes = ["X", "Y", "Z"].map(|axis| format!("  {axis}: {{ travel: [0, 400], origin: [0, 0, 0] }}\n")).concat();
    let base = format!("abbe: 1\nmachine: m\nchain: w b X Y Z t\naxes:\n{axes}volume: {{ step: 200 mm }}\n");
    let write = |name: &str, text: &str| drop(folder.write(&format!("{name}.{ending}"), text));
    write("base", &base);
    write("machine", &format!("abbe: 1\nextends: base.{ending}\nmeasured: [table.{ending}]\n"));
    write("bounded", &format!("abbe: 1\nextends: base.{ending}\nerrors: {{ EXX: {{ tolerance: 9 um }} }}\n"));
    write("table", "X [mm],EXX [um]\n0,0\n200,5\n400,3\n");
    write("poses", "X,Y,Z\n100,200,300\n");
    write("axes", "X,Y,Z\n100,200,300\n200,100,50\n");
    write("cost", "power: 1\n");
    write("job", &format!("tool_poses: poses.{ending}\n"));
    write("lines", "axis,dx [um],dy [um]\nC,4,-3\n");
    write(
        "data",
        "X [mm],Y [mm],dx [um],dy [um],dz [um]\n0,0,0,0,0\n100,50,1,0,0\n200,300,3,0,0\n300,90,3,0,0\n400,200,2,0,0\n",
    );
    write(
        "turning",
        &base
            .replace("b X Y Z t", "C' b X Y Z t")
            .replace("volume", "  C: { travel: continuous, origin: [200, 200, 0] }\nvolume"),
    );
    let drive = |of: String| format!("[{of}]\nMAX_VELOCITY = 50\nMAX_ACCELERATION = 800\n");
    let joints = (0..4).map(|joint| format!("JOINT_{joint}"));
    let drives: String = joints.chain(["X", "Y", "Z", "C"].map(|axis| format!("AXIS_{axis}"))).map(drive).collect();
    write("drives", &drives);
    write("points", "point;X;Y;Z\nP1;0;0;0\nP2;200;0;0\nP3;400;10;0\nP4;200;100;0\nP5;300;100;50\nP6;50;20;90\n");
    write("where", "point,X,Y,Z\nP1,0,0,0\nP2,200,0,0\nP3,400,10,0\nP4,200,100,0\nP5,300,100,50\nP6,50,20,90\n");
    let contact = |(n, [x, y, z]): (usize, [i32; 3])| format!("touch b p {n} {} {} {z} 0 1\n", 200 + x, 200 + y);
    let around = [[0, 0, 9], [9, 0, 0], [0, 9, 0], [-9, 0, 0], [0, -9, 0]];
    let contacts: String = (1..).zip(around).map(contact).collect();
    write("touches", &format!("abbe touches 1\naxes X Y Z C\nsets 1\nbegin b p\n{contacts}end b p\n"));
    write("circle", "angle [deg],ccw [um]\n0,1\n90,2\n180,1\n270,2\n");
    write("runs", "Kanal 0;Kanal 1\n0;0\n100;2\n200;4\n");
    write(
        "columns",
        "position: { column: Kanal 0, unit: mm }\ncolumns: { Kanal 1: { error: EXX, unit: um, direction: forward } }\n",
    );
    let contact = "{ name: L, city: C }";
    write(
        "record",
        &format!(
            "record: 1\nid: R\ndates: {{ begin: 2026-11-02, end: 2026-11-02 }}\ncountry: DE\nplace: other\n\
            laboratory: {contact}\ncustomer: {contact}\npersons: [{{ name: P }}]\nmachine: {{ serial: S }}\n\
            as_found: machine.{ending}\ndata: [data.{ending}]\ninstruments: [{{ name: I, serial: S, certificate: C, \
            calibrated: 2026-01-01, uncertainty: 1 um }}]\n"
        ),
    );
    let own = folder.path("templates/own");
    std::fs::create_dir_all(&own).unwrap();
    let grid = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates/grid-csv");
    for entry in std::fs::read_dir(grid).unwrap().map(Result::unwrap) {
        let text = std::fs::read_to_string(entry.path()).unwrap().replace("grid-csv", "own");
        std::fs::write(own.join(entry.file_name()), text).unwrap();
    }
}

/// All files below a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            let bytes = std::fs::read(&path).unwrap();
            all.insert(path, bytes);
        }
    }
    all
}

fn run(folder: &Folder, verb: &Verb, ending: &str, more: &[&str]) -> Run {
    let arguments = verb.arguments.iter().map(|argument| argument.replace("END", ending));
    Run::of(abbe().args(arguments).args(more).arg("--quiet").current_dir(folder.path("")))
}

/// Links are followed for one ending; for every one it is soak.
#[test]
fn no_output_replaces_an_input() {
    outputs_and_inputs(&ENDINGS[..1]);
}

#[test]
#[ignore = "soak: half a minute"]
fn no_output_replaces_what_a_link_of_any_ending_names() {
    outputs_and_inputs(&ENDINGS);
}

fn outputs_and_inputs(links: &[&str]) {
    let mut pairs = 0;
    for ending in ENDINGS {
        // All of them leave the folder as it was.
        let folder = Folder::new();
        inputs(&folder, ending);
        for verb in &VERBS {
            let before = files(&folder.path(""));
            for option in verb.outputs {
                for input in before.keys().filter(|path| verb.reads(path)) {
                    let link = folder.path(&format!("link.{ending}"));
                    std::os::unix::fs::symlink(input, &link).unwrap();
                    let outputs = [input, &link].into_iter().take(1 + usize::from(links.contains(&ending)));
                    for output in outputs {
                        pairs += 1;
                        let run = run(&folder, verb, ending, &[option, output.to_str().unwrap()]);
                        let what = format!("{} {option} {}: {}", verb.name, output.display(), run.err);
                        assert_ne!(run.code, Some(0), "{what}");
                        let mut after = files(&folder.path(""));
                        after.remove(&link);
                        assert!(after == before, "{what}");
                    }
                    std::fs::remove_file(&link).unwrap();
                }
                // The same run, with a name that is free.
                let free = folder.path("free").join(format!("out.{ending}"));
                std::fs::create_dir_all(free.parent().unwrap()).unwrap();
                let run = run(&folder, verb, ending, &[option, free.to_str().unwrap()]);
                let pictures =
                    ["--svg", "--png", "--curves", "--zero-pose", "--pareto", "--waterfall"].contains(option);
                assert!(run.code == Some(0) || pictures && ending == "yaml", "{} {option}: {}", verb.name, run.err);
                std::fs::remove_dir_all(folder.path("free")).unwrap();
            }
            let _ = std::fs::remove_dir_all(folder.path("compiled"));
        }
    }
    println!("{pairs} pairs");
    assert!(pairs > 300, "{pairs}");
}

/// An option that names a path is an input or an output of the table above.
#[test]
fn every_option_that_names_a_path_is_tried() {
    let page = std::fs::read_to_string("docs/options.md").unwrap();
    let option = |line: &str| {
        let words = line.strip_prefix("| `")?.split_once('`')?.0;
        let (option, value) = words.split_once(' ')?;
        ["FILE", "DIR", "PATH"].contains(&value).then(|| option.to_owned())
    };
    let known: BTreeSet<String> = page.lines().filter_map(option).collect();
    let outputs = VERBS.iter().flat_map(|verb| verb.outputs);
    let tried: BTreeSet<String> =
        INPUTS.iter().chain(&STATES).chain(outputs).map(|&option| option.to_owned()).collect();
    assert_eq!(known, tried);
}
