//! Targets that set constants of LinuxCNC's own kinematics modules: the numbers by hand, their residual, and the
//! machines that they are for.

use std::path::{Path, PathBuf};

use crate::oracle::program::Folder;
use crate::support::{compile, config, number, verify};

/// `setp` lines by the name of the pin.
fn constants(file: &Path) -> Vec<(String, f64)> {
    let text = std::fs::read_to_string(file).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with(['#', 'n']));
    let constant = |line: &str| {
        let [set, pin, value] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        assert_eq!(set, "setp");
        (pin.to_owned(), value.parse().unwrap())
    };
    lines.map(constant).collect()
}

fn expect(file: &Path, wanted: &[(&str, f64)], tolerance: f64) {
    let found = constants(file);
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for ((pin, value), (name, number)) in found.iter().zip(wanted) {
        assert!(pin == name && (value - number).abs() <= tolerance, "{pin} {value}, wanted {name} {number}");
    }
}

fn three_axis(folder: &Folder, errors: &str) -> PathBuf {
    let axes = "X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }\n  Y: { travel: [-100 mm, 300 mm], origin: [0, 0, 0] }\n  Z: { travel: [-400 mm, 0 mm], origin: [0, 0, 0] }";
    let text = format!(
        "abbe: 1\nmachine: three\nchain: \"w Y' b X Z t\"\naxes:\n  {axes}\ntool: {{ length: 100 mm }}\nerrors:\n{errors}"
    );
    folder.write("machine.yaml", &text)
}

#[test]
fn squareness_and_scale_in_the_matrix() {
    let folder = Folder::new();
    let errors = "  EC0Y: 10 urad\n  EB0Z: 20 urad\n  EA0Z: 30 urad\n  EXX: { polynomial: [0 um, 40 um/m] }\n";
    let out = folder.path("out");
    let json = compile(&three_axis(&folder, errors), "linuxcnc-matrixkins", &out, &[]).json();
    // The golden signs: +10 urad of EC0Y moves the tool by -5 um in X at Y = 500, so the joint goes +10 um per m;
    // EB0Z moves it by + in X with Z, EA0Z by - in Y. A scale that is 40 um/m long is driven shorter.
    let wanted = [
        ("matrixkins.C_xx", 1.0 - 40e-6),
        ("matrixkins.C_xy", 10e-6),
        ("matrixkins.C_xz", -20e-6),
        ("matrixkins.C_yx", 0.0),
        ("matrixkins.C_yy", 1.0),
        ("matrixkins.C_yz", 30e-6),
        ("matrixkins.C_zx", 0.0),
        ("matrixkins.C_zy", 0.0),
        ("matrixkins.C_zz", 1.0),
    ];
    // Second order: products of two of these numbers.
    expect(&out.join("matrixkins.hal"), &wanted, 3e-9);
    assert!(number(&json, "/uncompensated/position_um/p95") > 10.0);
    assert!(number(&json, "/compensated/position_um/max") < 1e-3);
    assert!(json["errors"].as_object().unwrap().values().all(|error| error["handled"] == "fully"), "{json}");
}

/// A table C on a tilting table, turning right-handed.
fn trt(folder: &Folder, tilt: &str, errors: &str, sense: &str) -> PathBuf {
    let text = format!(
        "abbe: 1\nmachine: trt\nchain: \"w C' {tilt}' Y' b X Z t\"\naxes:\n  X: {{ travel: [-250 mm, 250 mm], origin: [0, 0, 0] }}\n  \
         Y: {{ travel: [-200 mm, 200 mm], origin: [0, 0, 0] }}\n  Z: {{ travel: [-400 mm, 0 mm], origin: [0, 0, 0] }}\n  \
         {tilt}: {{ travel: [-100 deg, 30 deg], sense: {sense}, origin: [1, 2, -350] }}\n  \
         C: {{ travel: continuous, sense: {sense}, origin: [3, 5, -380] }}\n\
         tool: {{ gauge: [0.5, 0, 10], length: 120 mm }}\nworkpiece: {{ origin: [0, 0, -380] }}\nerrors:\n{errors}"
    );
    folder.write("machine.yaml", &text)
}

#[test]
fn centres_of_a_tilting_table() {
    for (tilt, errors, offset) in [
        // The tilting line is at 2 + 0.007 in Y, the centre of C at 5 - 0.004; and -350 + 0.009 in Z.
        ("A", "  EX0C: 6 um\n  EY0C: -4 um\n  EY0A: 7 um\n  EZ0A: 9 um\n", ("y-offset", 2.007 - 4.996)),
        ("B", "  EX0C: 6 um\n  EY0C: -4 um\n  EX0B: 7 um\n  EZ0B: 9 um\n", ("x-offset", 1.007 - 3.006)),
    ] {
        let folder = Folder::new();
        let out = folder.path("out");
        let machine = trt(&folder, tilt, errors, "direct");
        let json = compile(&machine, "linuxcnc-trt", &out, &[]).json();
        let module = format!("xyz{}c-trt-kins", tilt.to_lowercase());
        let names = ["x-rot-point", "y-rot-point", "z-rot-point", offset.0, "z-offset"];
        let values = [3.006 - 0.5, 5.0 - 0.004, -380.0 - 10.0, offset.1, 30.009];
        let names = names.map(|name| format!("{module}.{name}"));
        let wanted: Vec<(&str, f64)> = names.iter().map(String::as_str).zip(values).collect();
        expect(&out.join("trt.hal"), &wanted, 1e-6 + 1e-12);
        assert!(number(&json, "/uncompensated/position_um/p95") > 10.0);
        assert!(number(&json, "/compensated/position_um/max") < 5e-3, "{json}");
        let hal = std::fs::read_to_string(out.join("trt.hal")).unwrap();
        assert!(hal.contains(&format!("net tool-length motion.tooloffset.z => {module}.tool-offset\n")));
        let again = verify(&machine, &out, &[]).json();
        assert_eq!(again["compensated"], json["compensated"]);
    }
}

#[test]
fn other_machines_are_refused() {
    let folder = Folder::new();
    let out = folder.path("out");
    for (machine, target) in [
        (config("trunnion.yaml"), "linuxcnc-matrixkins"),
        (config("boring-w.yaml"), "linuxcnc-matrixkins"),
        (config("trunnion.yaml"), "linuxcnc-trt"),
        (config("vmc-cframe-754.yaml"), "linuxcnc-trt"),
        (trt(&folder, "A", "  EX0C: 6 um\n", "iso841"), "linuxcnc-trt"),
    ] {
        let _ = compile(&machine, target, &out, &[]).refused("E0751");
        assert!(!out.exists());
    }
}

#[test]
fn lines_that_the_controller_would_misread_are_refused() {
    let folder = Folder::new();
    let out = folder.path("out");
    let machine = three_axis(&folder, "  EC0Y: 10 urad\n");
    assert_eq!(compile(&machine, "linuxcnc-matrixkins", &out, &[]).code, Some(0));
    let file = out.join("matrixkins.hal");
    let good = std::fs::read_to_string(&file).unwrap();
    for (from, to) in [
        ("setp matrixkins.C_xx", "net matrixkins.C_xx"),
        ("setp matrixkins.C_xx 1", "setp matrixkins.C_xx x1"),
        ("setp matrixkins.C_xx 1", "setp matrixkins.C_xx 1e9"),
        ("matrixkins.C_xy", "matrixkins.C_xx"),
        ("matrixkins.C_zz", "matrixkins.C_qq"),
        ("setp matrixkins.C_zz", "# setp matrixkins.C_zz"),
        ("setp matrixkins.C_xx 1", "setp matrixkins.C_xx 1 2"),
    ] {
        assert!(good.contains(from));
        std::fs::write(&file, good.replacen(from, to, 1)).unwrap();
        let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704");
    }
}

/// A copy of a target of the binary under another name.
fn copied(folder: &Folder, from: &str, change: impl Fn(String) -> String) {
    let (source, own) = (Path::new(env!("CARGO_MANIFEST_DIR")).join("templates").join(from), folder.path("mine"));
    std::fs::create_dir_all(&own).unwrap();
    for file in std::fs::read_dir(source).unwrap().map(|entry| entry.unwrap().path()) {
        let text = std::fs::read_to_string(&file).unwrap();
        let manifest = file.ends_with("target.yaml");
        let text = if manifest { change(text.replace(&format!("target: {from}"), "target: mine")) } else { text };
        std::fs::write(own.join(file.file_name().unwrap()), text).unwrap();
    }
}

#[test]
fn a_kinematics_target_of_ones_own_needs_no_rust() {
    for (from, machine) in [("linuxcnc-kins", "ht-b-c.yaml"), ("linuxcnc-matrixkins", "gantry-3ax.yaml")] {
        let folder = Folder::new();
        copied(&folder, from, |text| text);
        let templates = folder.path("").display().to_string();
        let (theirs, ours) = (folder.path("theirs"), folder.path("ours"));
        let first = compile(&config(machine), from, &theirs, &["--poses", "20"]).json();
        let second = compile(&config(machine), "mine", &ours, &["--poses", "20", "--templates", &templates]).json();
        assert_eq!(first["compensated"], second["compensated"]);
        for name in first["files"].as_array().unwrap() {
            let name = name.as_str().unwrap();
            assert_eq!(std::fs::read(theirs.join(name)).unwrap(), std::fs::read(ours.join(name)).unwrap(), "{name}");
        }
    }
}

#[test]
fn manifests_that_cannot_be_are_refused() {
    for (from, to) in [
        ("layout: { format: c_arrays }", "layout: { format: hal_constants }"),
        ("    layout: { format: c_arrays }\n", ""),
        ("damping: 0.017", "damping: 0"),
        ("damping: 0.017", "damping: .nan"),
        ("per: machine", "per: axis"),
        ("carries: full_model", "carries: half_model"),
    ] {
        let folder = Folder::new();
        copied(&folder, "linuxcnc-kins", |text| {
            assert!(text.contains(from));
            text.replacen(from, to, 1)
        });
        let out = folder.path("out");
        let templates = folder.path("").display().to_string();
        let run = compile(&config("gantry-3ax.yaml"), "mine", &out, &["--templates", &templates]);
        let _ = run.refused("E0703");
        assert!(!out.exists());
    }
}

#[test]
fn names_of_constants_must_fit() {
    for (from, to) in [("C_xx, C_xy", "C_xx"), ("C_xx, C_xy", "C_xx, C_xx"), ("C_xx, C_xy", "C_xx, 'C xy'")] {
        let folder = Folder::new();
        copied(&folder, "linuxcnc-matrixkins", |text| text.replacen(from, to, 1));
        let (out, templates) = (folder.path("out"), folder.path("").display().to_string());
        let _ = compile(&config("gantry-3ax.yaml"), "mine", &out, &["--templates", &templates]).refused("E0703");
    }
}

#[test]
fn what_is_too_large_to_be_an_error_is_refused() {
    let folder = Folder::new();
    let out = folder.path("out");
    for (errors, words) in [
        ("  EXX: { polynomial: [5 mm] }\n", "a deviation of 5 mm is above the limit of 1 mm"),
        ("  EAZ: { polynomial: [9 mrad] }\n", "a tilt of the tool by 9 mrad is above the limit of 5 mrad"),
    ] {
        let machine = three_axis(&folder, errors);
        let _ = compile(&machine, "linuxcnc-kins", &out, &[]).refused("E0602").says(words);
        assert!(!out.exists());
        let run = compile(&machine, "linuxcnc-kins", &out, &["--max-correction", "20 mm, 10 mrad"]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        std::fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn templates_that_write_something_else_are_noticed() {
    let folder = Folder::new();
    copied(&folder, "linuxcnc-kins", |text| text);
    let data = folder.path("mine").join("data.h.j2");
    let text = std::fs::read_to_string(&data).unwrap();
    let gauge = "{ {{ gauge | join(\", \") }} }";
    assert!(text.contains(gauge));
    std::fs::write(&data, text.replace(gauge, "{ 1, 2, 3 }")).unwrap();
    let templates = folder.path("").display().to_string();
    let out = folder.path("out");
    let _ = compile(&config("gantry-3ax.yaml"), "mine", &out, &["--templates", &templates]).refused("E0707");
    assert!(!out.exists());
}
