//! What an hour of hostile use found in conclusions: columns of one run, cells of one number, remedies that must work.

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile, config, verify};

fn run(folder: &Folder, arguments: &[&str]) -> Run {
    Run::of(abbe().args(arguments).current_dir(folder.path("")))
}

/// The mean of two columns of one run would be no reading of any.
#[test]
fn a_run_has_one_column() {
    let folder = Folder::new();
    let rows = "0;1;100;2;1\n10;2;100;3;2\n20;1;100;1;1\n";
    let _ = folder.write("i.csv", &format!("X [mm];1+ [um];1+ [um];1- [um];2+ [um]\n{rows}"));
    let import = ["import", "i.csv", "--error", "EXX", "--out", "t.csv"];
    run(&folder, &import).refused("E0509").says("second column of its run");
    assert!(!folder.path("t.csv").exists());
    let _ = folder.write("i.csv", &format!("X [mm];1+ [um];2+ [um];1- [um];2- [um]\n{rows}"));
    assert_eq!(run(&folder, &import).code, Some(0));
}

/// `100,5` under one column is two cells; a position has the limit that it has everywhere.
#[test]
fn positions_to_replay_are_positions() {
    let folder = Folder::new();
    let errors = "errors: { EXX: { points: [[0 mm, 0 um], [100 mm, 3 um]] } }\n";
    let machine = folder.write(
        "m.yaml",
        &format!("abbe: 1\nmachine: m\nchain: w b X t\naxes: {{ X: {{ travel: [0 mm, 100 mm], origin: [0, 0, 0] }} }}\n{errors}"),
    );
    compile(&machine, "linuxcnc", &folder.path("set"), &["--poses", "20"]).json();
    let replayed = |rows: &str| {
        let list = folder.write("rp.csv", rows);
        verify(&machine, &folder.path("set"), &["--replay", list.to_str().unwrap()])
    };
    for (row, place) in [("X,forward,100,5", "line 3"), ("X,forward,1e308", "line 3"), ("X,forward,nan", "line 3")] {
        replayed(&format!("joint,direction,position\nX,forward,50\n{row}\n")).refused("E0802").says(place);
    }
    assert_eq!(replayed("joint,direction,position,remark\nX,forward,50,far\n").code, Some(0));
}

/// The controller's chain has the linear axes next to the bed. Other transformations know no bed.
#[test]
fn chains_with_rotary_axes_next_to_the_bed_are_refused_in_words() {
    let folder = Folder::new();
    let axes = "{ A: { travel: [-110 deg, 100 deg] }, X: { travel: [0, 300] }, Y: { travel: [0, 300] }, Z: { travel: [-300, 0] }, \
                B: { travel: [-90 deg, 40 deg] } }";
    for (chain, fits) in [
        ("w b A X Y Z B t", false),
        ("w A' X' Y' Z' B' b t", false),
        ("w B' X' Y' Z' A' b t", false),
        ("w A' b X Y Z B t", true),
        ("w A' B' b X Y Z t", true),
        ("w A' X' b Y Z B t", true),
    ] {
        let text = format!("abbe: 1\nmachine: s\nchain: \"{chain}\"\naxes: {axes}\nerrors: {{ EY0A: 10 um }}\n");
        let machine = folder.write("m.yaml", &text);
        let more = ["--accept-unverified", "--poses", "20"];
        let run = compile(&machine, "sinumerik-chain", &folder.path(&chain.replace([' ', '\''], "")), &more);
        if fits {
            run.json();
        } else {
            run.refused("E0751").says("between the bed and a linear axis");
            compile(&machine, "sinumerik-traori", &folder.path(&chain.replace([' ', '\''], "")), &more).json();
        }
    }
}

/// The steps that the warning names are those of the installed lattice: with them nothing of it is lost.
#[test]
fn the_remedy_for_lost_points_of_a_lattice_is_one() {
    let folder = Folder::new();
    let base = config("trunnion.yaml").display().to_string();
    let plain = format!("abbe: 1\nextends: '{base}'\nmachine: plain\nvolume: ~\n");
    let first = folder.write("first.yaml", &plain);
    let old = folder.path("old");
    let few = ["--poses", "100"];
    compile(&first, "grid-csv", &old, &few).json();
    let none: Vec<String> = ["EC0Y", "EB0Z", "EA0Z", "EY0A", "EZ0A", "EB0A", "EC0A", "EY0C", "EA0C", "EB0C"]
        .map(|error| format!("{error}: ~"))
        .into();
    let later = format!("{plain}measured: []\nerrors: {{ EX0C: 0.1 um, {} }}\n", none.join(", "));
    let machine = folder.write("later.yaml", &later);
    let over = [&few[..], &["--installed", old.to_str().unwrap()]].concat();
    let run = compile(&machine, "grid-csv", &folder.path("new"), &over);
    run.says("W0704").says("lack points of installed tables");
    let help = run.err.split("take their nodes: `").nth(1).unwrap_or_else(|| panic!("{}", run.err));
    let volume = help.split('`').next().unwrap();
    let machine = folder.write("later.yaml", &later.replace("volume: ~", volume));
    let json = compile(&machine, "grid-csv", &folder.path("kept"), &over).json();
    let p95 = |state: &str| json[state]["position_um"]["p95"].as_f64().unwrap();
    assert!(p95("compensated") < 0.02 && p95("uncompensated") > 0.1, "{}", p95("compensated"));
}
