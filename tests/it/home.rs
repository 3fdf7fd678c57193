//! Where the control homes the axes, and machine files in inches.

use abbe::controller::{ControllerTarget, Replay};
use abbe::machine::Approach;
use serde_json::Value;

use crate::oracle::program::Folder;
use crate::support::controllers::Files;
use crate::support::{Run, abbe, compile};
use crate::{loaded, replays};

/// A machine whose X is 10 um short at 0 and right at 500 mm.
fn machine(axes: [&str; 3]) -> String {
    let [x, y, z] = axes;
    format!(
        "abbe: 1\nmachine: homed\nchain: \"w Y' b X Z t\"\naxes:\n  X: {{ travel: [0 mm, 500 mm]{x} }}\n  Y: {{ travel: [0 mm, 400 mm]{y} }}\n  \
         Z: {{ travel: [-300 mm, 0 mm]{z} }}\nerrors:\n  EXX: {{ points: [[0 mm, -10 um], [500 mm, 0 um]] }}\nvolume: {{ step: 100 mm }}\n"
    )
}

const HOMED: [&str; 3] = [", home: 500 mm", ", home: 20 cm", ", home: 0"];
const FEW: [&str; 2] = ["--poses", "50"];

#[test]
fn the_step_is_said_where_the_axes_are_homed() {
    let folder = Folder::new();
    let text = |path, out| {
        Run::of(abbe().arg("compile").arg(path).args(["--target", "linuxcnc"]).args(FEW).arg("--out").arg(out)).out
    };
    let unstated = folder.write("unstated.yaml", &machine([HOMED[0], "", HOMED[2]]));
    let found = text(unstated.clone(), folder.path("unstated"));
    assert!(
        found.contains("With all axes at 0 the controller adds") && found.contains("state `home` of each axis"),
        "{found}"
    );
    assert!(!found.contains("step at the first motion"), "{found}");
    let homed = folder.write("homed.yaml", &machine(HOMED));
    let found = text(homed.clone(), folder.path("homed"));
    assert!(found.contains("At home (") && found.contains("X = 500 mm") && found.contains("Y = 200 mm"), "{found}");
    assert!(found.contains("This is also the step at the first motion"), "{found}");
    // 10 um at 0, nothing at 500 mm.
    let added = |path, out: &str| {
        let json = compile(path, "linuxcnc", &folder.path(out), &FEW).json();
        json.pointer("/at_reference/forward/X").and_then(Value::as_f64).unwrap()
    };
    assert!((added(&unstated, "unstated") - 0.01).abs() < 1e-6);
    assert!(added(&homed, "homed").abs() < 1e-9);
}

#[test]
fn a_home_is_a_position_of_its_axis() {
    let folder = Folder::new();
    let check = |home: &str| Run::of(abbe().arg("check").arg(folder.write("m.yaml", &machine([home, "", ""]))));
    check(", home: 501 mm").refused("E0403").says("beyond the travel from 0 to 500 mm").says("m.yaml:5");
    check(", home: 20 deg").refused("E0205");
    assert_eq!(check(", home: 0.5 m").code, Some(0));
}

/// A home goes where its axis goes: it is written, mirrored with a sense, and is a difference of two machines.
#[test]
fn a_home_stays_with_its_axis() {
    let folder = Folder::new();
    let homed = folder.write("homed.yaml", &machine(HOMED));
    let other = folder.write("other.yaml", &machine([", home: 250 mm", HOMED[1], ""]));
    let diff = Run::of(abbe().arg("diff").arg(&homed).arg(&other).args(["--format", "json"])).json();
    let homes: Vec<[&str; 3]> = diff["differences"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|d| d["kind"] == "home")
        .map(|d| ["name", "first", "second"].map(|key| d[key].as_str().unwrap()))
        .collect();
    assert_eq!(homes, [["X", "500 mm", "250 mm"], ["Z", "0 mm", "none"]]);
    let out = folder.path("direct.yaml");
    let run = Run::of(abbe().arg("convert").arg(&homed).args(["--to", "direct", "--out"]).arg(&out));
    assert_eq!(run.code, Some(0), "{}", run.err);
    let written = std::fs::read_to_string(&out).unwrap();
    let line = |axis: &str| written.lines().find(|line| line.starts_with(&format!("  {axis}: {{ kind"))).unwrap();
    assert!(line("X").contains("home: 500 mm") && line("Z").contains("home: 0 mm"), "{written}");
    assert!(line("Y").contains("travel: [-400 mm, 0 mm]") && line("Y").contains("home: -200 mm"), "{written}");
}

/// Steps count from where the switch was met: there a new number of them moves nothing, and 100 mm away 0.1 mm.
#[test]
fn scales_count_from_home() {
    let folder = Folder::new();
    let machine = loaded::machine(&folder.write("homed.yaml", &machine(HOMED)));
    let grbl = ControllerTarget::builtin("grbl").unwrap();
    let files: Files = [("settings.nc".to_owned(), "; $100=80\n$100=80.08\n".to_owned())].into();
    let tables = replays::read(&grbl, &machine, &files).unwrap_or_else(|_| panic!());
    let axis = machine.axis_index("X").unwrap();
    for (x, expected) in [(500.0, 0.0), (400.0, -0.1), (0.0, -0.5)] {
        let mut pose = [0.0; 3];
        pose[axis] = x;
        let added = Replay::new(&machine, &grbl, &tables).addition(&Approach::Forward.at_pose(&pose));
        assert!((added[axis] - expected).abs() < 1e-12, "{x}: {added:?}");
    }
}

#[test]
fn a_machine_in_inches_is_told_of_tables_in_mm() {
    let folder = Folder::new();
    let inches = folder.write("inches.yaml", &machine(["", "", ""]).replace("[0 mm, 400 mm]", "[0 in, 16 in]"));
    let metric = folder.write("metric.yaml", &machine(["", "", ""]));
    let says = |path, target: &str| compile(path, target, &folder.path(target), &FEW).err.contains("W0719");
    assert!(says(&inches, "linuxcnc") && says(&inches, "sinumerik-cec"));
    assert!(!says(&inches, "grid-csv") && !says(&metric, "linuxcnc"));
}
