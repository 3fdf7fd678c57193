//! Every form the machine language has, read and resolved.

use abbe::diagnostic::{Diagnostics, Rendering, render};
use abbe::machine::{self, Approach, AxisKind, Branch, Conventions, Joints, Machine, Travel, parse_error_name};
use abbe::syntax::{self, Files, ReadFailure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files in memory.
#[derive(Default)]
pub struct Memory(pub BTreeMap<PathBuf, Vec<u8>>);

impl Files for Memory {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        self.0.get(path).cloned().ok_or(ReadFailure::NotFound)
    }
}

/// Reads `machine.yaml` beside the other files.
pub fn read(files: &[(&str, &str)]) -> (Option<Machine>, Diagnostics) {
    let memory = Memory(files.iter().map(|(n, t)| (PathBuf::from(n), t.as_bytes().to_vec())).collect());
    let mut diagnostics = Diagnostics::default();
    let document = syntax::load(Path::new(files[0].0), &memory, &mut diagnostics);
    let machine = document.and_then(|d| machine::resolve(&d, &memory, &mut diagnostics));
    (machine, diagnostics)
}

/// A machine that must be read without a word.
pub fn silent(files: &[(&str, &str)]) -> Machine {
    let (machine, diagnostics) = read(files);
    let text = render(&diagnostics, Rendering::default());
    assert!(text.is_empty(), "{text}");
    machine.unwrap()
}

pub const TRUNNION: &str = r#"
abbe: 1
machine: Trunnion five-axis machining centre
chain: "w C' A' Y' b X Z (S) t"
axes:
  X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }
  Y: { travel: [0 mm, 450 mm], origin: [0, 0, 0] }
  Z: { travel: [-400 mm, 0 mm], origin: [0, 0, 0] }
  A: { travel: [-120 deg, 30 deg], origin: [250, 225, -350] }
  C: { travel: continuous, origin: [250, 225, -380] }
tool: { gauge: [250, 225, 0], length: 120 mm }
workpiece: { origin: [250, 225, -380] }
conventions: { location: axis_only, linear: after, rotary: stationary, workpiece_axes: iso841, errors_are: tool_relative, location_order: nilpotent, joints: orthogonal }
errors:
  EC0Y: 12 urad
  EX0C: 6 um
  EXX: { table: errors/x.csv }
  EYX: { points: [[0 mm, 0 um], [250 mm, 1.2 um], [500 mm, -0.4 um]], interpolation: cubic }
  EBX: { polynomial: [0 urad, 5 urad/m, -2 urad/m^2] }
  ECC: { harmonics: { 0: [1 urad, 0 urad], 1: [2 urad, -1 urad], 2: [0.5 urad, 0 urad] } }
  EZZ: { forward: { polynomial: [1 um] }, reverse: { points: [[-400, 2 um], [0, 4 um]] } }
  EAY: { tolerance: 20 urad }
  EA0S: { value: 4 urad, provenance: { source: by hand } }
measured: [errors/c.csv]
volume: { X: [0, 500], step: 20 mm, C: { step: 10 deg } }
provenance: { class: production, source: class-typical, date: 2026-11-01 }
setup: { tool: { X: 0 um }, workpiece: { X: 3 um, A: 5 urad } }
algebra: { degree: 2, generators: per-error, vanish: [] }
identify: { fit: [location, tool], fixed: [EC0Y], basis: { EYX: poly3 } }
"#;

#[test]
fn the_whole_language_resolves() {
    let x = "\u{feff}# measured\r\nX [mm], EXX+ [um], EXX- [um], EYX [um]\r\n\r\n0, 0, 1, 9\r\n500, 10, 12, 9\r\n";
    let c = "C [deg];EXC [um];EAC [arcsec]\n0;0;1\n90;3;2\n360;0;1\n";
    let machine = silent(&[("m/t.yaml", TRUNNION), ("m/errors/x.csv", x), ("m/errors/c.csv", c)]);
    assert_eq!(machine.chain().to_string(), "w C' A' Y' b X Z (S) t");
    let names: Vec<&str> = machine.axes().iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["C", "A", "Y", "X", "Z"]);
    assert_eq!(machine.axes()[0].branch, Branch::Workpiece);
    assert_eq!(machine.tool().tip, [250.0, 225.0, -120.0]);
    let exx = |approach: Approach| machine.component_values(3, &approach.at_position(250.0))[0];
    assert_eq!((exx(Approach::Forward), exx(Approach::Reverse)), (5.0 * 1e-3, 6.5 * 1e-3));
    assert!((machine.component_values(3, &Approach::Mean.at_position(500.0))[4] - 2e-6).abs() < 1e-18);
    assert_eq!(machine.component_values(0, &Approach::Mean.at_position(450.0))[0], 3.0 * 1e-3);
    assert!((machine.axis_errors(2).location_values()[5] - 12e-6).abs() < 1e-18);
    assert!((machine.spindle_errors().unwrap().location_values()[3] - 4e-6).abs() < 1e-18);
    assert_eq!(machine.setup().workpiece[0], 3.0 * 1e-3);
    let steps: Vec<f64> = machine.volume().iter().map(|g| g.step).collect();
    assert_eq!(steps, [10.0, 15.0, 20.0, 20.0, 20.0]);
}

#[test]
fn the_machines_of_the_test_data_resolve() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/msl-three-axis");
    let mut seen = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|e| e == "yaml") {
            let mut diagnostics = Diagnostics::default();
            let document = syntax::load(&path, &abbe::syntax::Disk, &mut diagnostics).unwrap();
            let machine = machine::resolve(&document, &abbe::syntax::Disk, &mut diagnostics);
            assert!(machine.is_some(), "{}", render(&diagnostics, Rendering::default()));
            seen += 1;
        }
    }
    assert!(seen > 5);
}

/// A machine of X, Z, and C as table, with more lines.
fn small(lines: &str) -> String {
    format!(
        "abbe: 1\nmachine: Small\nchain: w C' b X Z t\naxes:\n  X: {{ travel: [0, 500], origin: [0, 0, 0] }}\n  Z: {{ travel: [-400, 0], origin: [0, 0, 0] }}\n  \
         C: {{ travel: continuous, origin: [0, 0, 0] }}\n{lines}\n"
    )
}

fn resolved(lines: &str) -> Machine {
    silent(&[("m.yaml", &small(lines))])
}

/// Component errors of an axis at a position.
fn component(machine: &Machine, axis: &str, position: f64) -> [f64; 6] {
    machine.component_values(machine.axis_index(axis).unwrap(), &Approach::Mean.at_position(position))
}

fn location(machine: &Machine, axis: &str) -> [f64; 6] {
    machine.axis_errors(machine.axis_index(axis).unwrap()).location_values()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[test]
fn chains_are_read_in_every_spelling() {
    let spellings = [
        "\"w C' b X Z t\"",
        "w C' b X Z t",
        "\"[w C' b X Z t]\"",
        "[w C' b X Z t]",
        "\"V [w C' b X Z t]\"",
        "\"w-C'-b-X-Z-t\"",
        "\"w, C', b, X, Z, t\"",
        "\"  w  C’  b\\tX Z t \"",
        "w C′ b X Z t",
        "[w, \"C'\", b, X, Z, t]",
    ];
    for chain in spellings {
        let text = small("").replace("chain: w C' b X Z t", &format!("chain: {chain}"));
        assert_eq!(silent(&[("m.yaml", &text)]).chain().to_string(), "w C' b X Z t", "{chain}");
    }
    let cases = [
        ("branches: { workpiece: [C], tool: [X, Z] }", "w C' b X Z t"),
        ("branches: { workpiece: [\"C'\"], tool: [X, Z, (S)] }", "w C' b X Z (S) t"),
        ("branches: { workpiece: [X, C], tool: [Z] }", "w C' X' b Z t"),
        ("branches: { tool: [X, Z, C] }", "w b X Z C t"),
        ("branches: { workpiece: [Z, X, C] }", "w C' X' Z' b t"),
        ("chain: w C' b X Z (C1) t", "w C' b X Z (C1) t"),
        ("chain: w b X Z C t", "w b X Z C t"),
    ];
    for (line, printed) in cases {
        let text = small("").replace("chain: w C' b X Z t", line);
        assert_eq!(silent(&[("m.yaml", &text)]).chain().to_string(), printed, "{line}");
    }
}

#[test]
fn axes_follow_their_letter_or_say_what_they_are() {
    let text = "abbe: 1\nmachine: Free\nchain: w C2' V' b X1 W R D J1 (S) t\naxes:\n  \
        X1: { travel: [0 in, 20 in], origin: [0, 0, 0] }\n  V: { travel: [0 m, 0.5 m], sense: direct }\n  W: { travel: [-1 cm, 0 mm], origin: [0, 0, 0] }\n  \
        R: { travel: [0, 1] }\n  C2: { travel: [-1 rad, 90 deg], origin: [1 m, 2, 3 mm] }\n  \
        D: { kind: rotary, direction: [0, 1, 1], travel: [-180 deg, 180°] }\n  \
        J1: { kind: linear, direction: [3e200, 0, -4e200], travel: [0, 10] }\n";
    let machine = silent(&[("m.yaml", text)]);
    let axis = |name: &str| machine.axes()[machine.axis_index(name).unwrap()].clone();
    assert_eq!((axis("X1").kind, axis("X1").direction), (AxisKind::Linear, [1.0, 0.0, 0.0]));
    assert_eq!(axis("X1").travel, Travel::Range(0.0, 508.0));
    assert_eq!(
        (axis("V").direction, axis("V").travel, axis("V").sign()),
        ([0.0, 1.0, 0.0], Travel::Range(0.0, 500.0), -1.0)
    );
    assert_eq!((axis("W").direction, axis("W").travel), ([0.0, 0.0, 1.0], Travel::Range(-10.0, 0.0)));
    assert_eq!(axis("R").direction, [0.0, 0.0, 1.0]);
    assert_eq!((axis("C2").kind, axis("C2").origin), (AxisKind::Rotary, [1000.0, 2.0, 3.0]));
    assert!(matches!(axis("C2").travel, Travel::Range(min, max) if near(min, -1f64.to_degrees()) && max == 90.0));
    assert!(near(axis("D").direction[1], 0.5f64.sqrt()) && axis("D").direction[0] == 0.0);
    assert_eq!(axis("D").travel, Travel::Range(-180.0, 180.0));
    assert!(near(axis("J1").direction[0], 0.6) && near(axis("J1").direction[2], -0.8));
}

#[test]
fn conventions_are_a_preset_single_words_or_both() {
    assert_eq!(*resolved("").conventions(), Conventions::default());
    for preset in Conventions::PRESETS {
        let expected = Conventions::preset(preset).unwrap();
        assert_eq!(*resolved(&format!("conventions: {preset}")).conventions(), expected);
        let amended = resolved(&format!("conventions: {{ preset: {preset}, joints: orthogonal }}"));
        assert_eq!(*amended.conventions(), Conventions { joints: Joints::Orthogonal, ..expected });
    }
    let direct = resolved("conventions: { workpiece_axes: direct }");
    assert_eq!(direct.axes().iter().map(|a| a.sign()).collect::<Vec<_>>(), [-1.0, 1.0, 1.0]);
}

#[test]
fn errors_are_read_in_every_spelling_and_sign() {
    let spellings = [
        ("EXX", "EXX"),
        ("E_{XX}", "EXX"),
        ("E_XX", "EXX"),
        ("dxx", "EXX"),
        ("dyx", "EYX"),
        ("dxz", "EXZ"),
        ("exx", "EAX"),
        ("eyx", "EBX"),
        ("ezz", "ECZ"),
        ("EC0Y", "EC0Y"),
        ("E_{C0Y}", "EC0Y"),
        ("E_C0Y", "EC0Y"),
        ("C0Y", "EC0Y"),
        ("COY", "EC0Y"),
        ("ECOY", "EC0Y"),
        ("EC(0X)Y", "EC0Y"),
        ("E_{C(0X)Y}", "EC0Y"),
        ("Sxy", "EC0Y"),
        ("Sxz", "EB0Z"),
        ("Syz", "EA0Z"),
        ("E_X0C", "EX0C"),
        ("X0C", "EX0C"),
        ("EA0S", "EA0S"),
        ("EA0C1", "EA0C1"),
        ("EXJ6", "EXJ6"),
        ("EXX1", "EXX1"),
    ];
    for (written, name) in spellings {
        assert_eq!(parse_error_name(written).unwrap().to_string(), name, "{written}");
    }
    for wrong in
        ["", "E", "EX", "XX", "EQX", "EX0", "EXx", "dxw", "Szx", "EX-Y", "E0XC", "EXABCDEFGHI", "dyX", "exX", "É"]
    {
        assert_eq!(parse_error_name(wrong), None, "{wrong}");
    }
    let text = small("errors: { Syz: 1 urad, Sxz: 2 urad, \"E_{X0C}\": 3 um, dzx: 4 um, eyx: 0.5 urad }");
    let machine = silent(&[("m.yaml", &text)]);
    assert!(near(location(&machine, "Z")[3], 1e-6) && near(location(&machine, "Z")[4], -2e-6));
    assert!(near(location(&machine, "C")[0], 3e-3) && near(component(&machine, "X", 9.0)[2], 4e-3));
    assert!(near(component(&machine, "X", 9.0)[4], 0.5e-6));
}

#[test]
fn an_axis_called_oy_keeps_its_errors() {
    let text = "abbe: 1\nmachine: M\nchain: w b OY t\naxes: { OY: { kind: linear, direction: [0, 1, 0], travel: [0, 1], origin: [0, 0, 0] } }\nerrors: { ECOY: 1 urad }\n";
    assert!(near(component(&silent(&[("m.yaml", text)]), "OY", 0.5)[5], 1e-6));
}

#[test]
fn every_unit_of_an_error_value() {
    let values = [
        ("12 um", 12e-3),
        ("12um", 12e-3),
        ("12 µm", 12e-3),
        ("0.5 mm", 0.5),
        ("900 nm", 9e-4),
        ("1e-3 in", 0.0254),
        ("+.5 um", 5e-4),
    ];
    for (written, value) in values {
        assert!(near(component(&resolved(&format!("errors: {{ EXX: {written} }}")), "X", 0.0)[0], value), "{written}");
    }
    let angle = |seconds: f64| (seconds / 3600.0).to_radians();
    let values = [
        ("12 urad", 12e-6),
        ("0.01 mrad", 1e-5),
        ("5 arcsec", angle(5.0)),
        ("1 arcmin", angle(60.0)),
        ("0.001 deg", angle(3.6)),
        ("3 um/m", 3e-6),
        ("0.02/500", 4e-5),
    ];
    for (written, value) in values {
        assert!(near(location(&resolved(&format!("errors: {{ EA0Z: {written} }}")), "Z")[3], value), "{written}");
    }
}

#[test]
fn every_form_of_a_curve() {
    let machine = resolved(
        "errors:\n  EXX: { polynomial: [1 um, 2 um/m, 3e-6 um/mm^2] }\n  EAX: { polynomial: [1 urad, 2 urad/m, 3 um/m/m^2] }\n  \
         EYX: { points: [[0, 0 um], [10 cm, 1 um], [500 mm, 3 um]] }\n  EZX: { value: 2 um, provenance: { by: hand } }\n  \
         EXC: { points: [[0, 1 um], [3.141592653589793 rad, 3 um], [360 deg, 1 um]] }\n  EYC: 4 um\n  \
         EZC: { harmonics: { 2: [1 um, 2 um] } }\n  EZZ: { forward: 1 um, reverse: { points: [[-400, 3 um], [0, 5 um]] } }\n  \
         EXZ: { tolerance: 9 um }",
    );
    let x = component(&machine, "X", 200.0);
    assert!(near(x[0], (1.0 + 0.4 + 0.12) * 1e-3) && near(x[3], (1.0 + 0.4 + 0.12) * 1e-6), "{x:?}");
    assert!(near(x[1], 1.5e-3) && near(x[2], 2e-3));
    let c = component(&machine, "C", 450.0);
    assert!(near(c[0], 2e-3) && near(c[1], 4e-3) && near(c[2], -1e-3), "{c:?}");
    let z = machine.axis_index("Z").unwrap();
    assert!(near(machine.component_values(z, &Approach::Forward.at_position(-200.0))[2], 1e-3));
    assert!(near(machine.component_values(z, &Approach::Reverse.at_position(-200.0))[2], 4e-3));
    assert!(near(component(&machine, "Z", -200.0)[2], 2.5e-3) && component(&machine, "Z", -200.0)[0] == 0.0);
}

#[test]
fn polynomials_on_rotary_axes_are_per_degree() {
    let text = small(
        "errors: { EXC: { polynomial: [0 um, 0.1 um/deg, 1 um/rad^2] }, ECC: { polynomial: [0 urad, 2 urad/deg] } }",
    );
    let machine = silent(&[("m.yaml", &text.replace("continuous", "[-90, 90]"))]);
    let c = component(&machine, "C", 90.0);
    let quarter = std::f64::consts::FRAC_PI_2;
    assert!(near(c[0], (9.0 + quarter * quarter) * 1e-3) && near(c[5], 180e-6), "{c:?}");
}

#[test]
fn tables_come_with_any_separator_unit_and_direction() {
    let tables = [
        "X [mm], EXX [um], EAX [arcsec]\n0, 1, 0\n500, 3, 0\n",
        "# comment\nX [m];EXX [mm]\n\n0;0.001\n  # another\n0.5;0.003\n",
        "X [mm]\tdxx [um]\n0\t1\n500\t3",
        "\"X [mm]\",\"EXX [um]\"\n\"0\",\"1\"\n500,3\n",
        "X [mm], EXX+ [um], EXX- [um]\n0, 0, 2\n500, 2, 4\n",
        "X [mm], EXX forward [um], EXX reverse [um]\r\n0, 0, 2\r\n500, 2, 4\r\n",
        "X [in], EXX [um]\n-1, 1\n0, 1\n20, 3.032\n",
    ];
    for table in tables {
        for line in ["measured: [x.csv]", "errors: { EXX: { table: x.csv } }"] {
            let machine = silent(&[("a/m.yaml", &small(line)), ("a/x.csv", table)]);
            let value = component(&machine, "X", 250.0)[0];
            assert!((value - 2e-3).abs() < 1e-12, "{value} {table}");
        }
    }
    let cubic = "X [mm], EXX [um]\n0, 0\n250, 1\n500, 0\n";
    let machine =
        silent(&[("m.yaml", &small("errors: { EXX: { table: x.csv, interpolation: cubic } }")), ("x.csv", cubic)]);
    assert!(near(component(&machine, "X", 125.0)[0], 0.6875e-3));
    let one_way = small("errors: { EXX: { forward: { table: x.csv }, reverse: { table: x.csv } } }");
    let machine = silent(&[("m.yaml", &one_way), ("x.csv", tables[4])]);
    assert!(near(machine.component_values(1, &Approach::Forward.at_position(250.0))[0], 1e-3));
    let turn = "C [rad], EXC [um]\n0, 1\n6.283185307179586, 1\n";
    assert!(near(component(&silent(&[("m.yaml", &small("measured: [c.csv]")), ("c.csv", turn)]), "C", 500.0)[0], 1e-3));
}

#[test]
fn tools_workpiece_volume_and_names() {
    let machine = resolved(
        "tools:\n  short: { gauge: [1, 2, 3], length: 1 in }\n  long-2.5: { offset: [1 mm, 0, -0.2 m] }\nworkpiece: { origin: [1, 2, 3 cm] }\n\
         volume: { step: 20, X: { range: [100, 200] }, C: [-180, 180] }",
    );
    assert_eq!((machine.tool().name.as_str(), machine.tool().tip), ("short", [1.0, 2.0, -22.4]));
    assert_eq!(machine.with_tool("long-2.5").unwrap().tool().tip, [1.0, 0.0, -200.0]);
    assert_eq!(machine.workpiece(), [1.0, 2.0, 30.0]);
    let grid: Vec<(f64, f64, f64)> = machine.volume().iter().map(|g| (g.min, g.max, g.step)).collect();
    assert_eq!(grid, [(-180.0, 180.0, 15.0), (100.0, 200.0, 20.0), (-400.0, 0.0, 20.0)]);
    let machine = resolved("volume: { step: 10 deg }");
    assert_eq!(
        machine.volume().iter().map(|g| (g.max, g.step)).collect::<Vec<_>>(),
        [(360.0, 10.0), (500.0, 25.0), (0.0, 25.0)]
    );
    assert_eq!((machine.tools().len(), machine.tool().tip, machine.workpiece()), (1, [0.0; 3], [0.0; 3]));
}

#[test]
fn variants_merge_replace_and_remove() {
    let base = small(
        "tool: { gauge: [1, 2, 3], length: 100 mm }\nconventions: bui-kimm\nmeasured: [tables/x.csv]\n\
         errors: { EX0C: 1 um, EXC: { points: [[0, 1 um], [360, 1 um]] }, EYC: 5 um }\nvolume: { X: { step: 10 }, Z: { step: 5 } }\nsetup: { tool: { X: 1 um } }",
    )
    .replace("C: { travel: continuous, origin: [0, 0, 0] }", "C: { travel: continuous, origin: [7, 8, 9], on_tool: { origin: { from: bed, at: [7, 8, 9] } } }",);
    let variant = "extends: ../base/b.yaml\nmachine: Variant\nchain: null\nbranches: { tool: [X, Z, C] }\n\
        axes: { X: { travel: [0, 300], origin: [0, 0, 0] }, C: { sense: direct } }\ntool: { offset: [0, 0, -5] }\nconventions: { joints: orthogonal }\n\
        errors: { EX0C: 2 um, EXC: { harmonics: { 1: [0 um, 0.1 um] } }, EYC: null, EZC: { table: c.csv } }\nvolume: { Z: { step: 8 } }\nsetup: { tool: { X: null, Y: 2 um } }\n";
    let x = "X [mm], EXX [um]\n0, 0\n500, 5\n";
    let c = "C [deg], EZC [um]\n0, 1\n360, 1\n";
    let files = [("v/m.yaml", variant), ("v/../base/b.yaml", &base), ("v/../base/tables/x.csv", x), ("v/c.csv", c)];
    let machine = silent(&files);
    assert_eq!((machine.name(), machine.chain().to_string().as_str()), ("Variant", "w b X Z C t"));
    assert_eq!(machine.axes()[0].travel, Travel::Range(0.0, 300.0));
    assert_eq!((machine.axes()[2].origin, machine.axes()[2].travel), ([7.0, 8.0, 9.0], Travel::Continuous));
    assert_eq!((machine.tool().gauge, machine.tool().tip), ([1.0, 2.0, 3.0], [1.0, 2.0, -2.0]));
    let preset = Conventions::preset("bui-kimm").unwrap();
    assert_eq!(*machine.conventions(), Conventions { joints: Joints::Orthogonal, ..preset });
    let errors = component(&machine, "C", 90.0);
    assert!(
        near(errors[0], 1e-4) && errors[1] == 0.0 && near(errors[2], 1e-3) && near(location(&machine, "C")[0], 2e-3)
    );
    assert!(near(component(&machine, "X", 300.0)[0], 3e-3));
    assert_eq!(machine.volume().iter().map(|g| g.step).collect::<Vec<_>>(), [10.0, 8.0, 15.0]);
    assert_eq!(machine.setup().tool, [0.0, 2e-3, 0.0]);
}

#[test]
fn the_order_of_the_sections_does_not_matter() {
    let sections: Vec<&str> = TRUNNION.trim().split_inclusive('\n').collect();
    let mut blocks: Vec<String> = Vec::new();
    for line in sections {
        match blocks.last_mut().filter(|_| line.starts_with(' ')) {
            Some(block) => block.push_str(line),
            None => blocks.push(line.to_owned()),
        }
        if !line.ends_with('\n') {
            blocks.last_mut().unwrap().push('\n');
        }
    }
    blocks.reverse();
    let x = "X [mm], EXX [um]\n0, 0\n500, 10\n";
    let c = "C [deg], EXC [um]\n0, 0\n360, 0\n";
    let machine = silent(&[("t.yaml", &blocks.concat()), ("errors/x.csv", x), ("errors/c.csv", c)]);
    assert_eq!(machine.chain().to_string(), "w C' A' Y' b X Z (S) t");
}

/// Codes of the warnings of a machine that is accepted.
fn warnings(lines: &str) -> Vec<&'static str> {
    let (machine, diagnostics) = read(&[("m.yaml", &small(lines))]);
    assert!(machine.is_some(), "{}", render(&diagnostics, Rendering::default()));
    diagnostics.iter().map(|d| d.code.id).collect()
}

#[test]
fn what_repeats_a_location_error_is_told_and_what_does_not_is_not() {
    // A displaced axis: its run-out turns with it, on the workpiece side against the position.
    let run_out = |sine: &str| {
        format!("EXC: {{ harmonics: {{ 1: [5 um, 0 um] }} }}, EYC: {{ harmonics: {{ 1: [0 um, {sine}] }} }}")
    };
    let errors = |list: &str| format!("errors: {{ {list} }}");
    assert_eq!(warnings(&errors(&format!("EX0C: 3 um, {}", run_out("-5 um")))), ["W0403"]);
    assert_eq!(warnings(&errors(&format!("EX0C: 3 um, {}", run_out("5 um")))), [""; 0]);
    assert_eq!(warnings(&errors(&run_out("-5 um"))), [""; 0]);
    let turned = errors(&format!("EX0C: 3 um, {}", run_out("5 um")));
    assert_eq!(warnings(&format!("{turned}\nconventions: {{ rotary: rotating }}")), ["W0403"]);
    assert_eq!(warnings(&format!("{turned}\nconventions: {{ workpiece_axes: direct }}")), ["W0403"]);
    // A straight line is squareness; without its mean slope, or tangent at home, it is not.
    let straightness = |points: &str| errors(&format!("EB0Z: 3 urad, EZX: {{ points: [{points}] }}"));
    assert_eq!(warnings(&straightness("[0, 0 um], [500, 5 um]")), ["W0403"]);
    assert_eq!(warnings(&straightness("[0, 0 um], [250, 5 um], [500, 0 um]")), [""; 0]);
    assert_eq!(warnings(&errors("EB0Z: 3 urad, EZX: { polynomial: [0 um, 0 um/m, 40 um/m^2] }")), [""; 0]);
    assert_eq!(warnings(&straightness("[0, 0 um], [500, 0.9 um]")), [""; 0]);
    // Large ones are reported even if no location error is given.
    assert_eq!(warnings(&errors("EZX: { polynomial: [0 um, 500 um/m] }")), ["W0403"]);
    // A constant; the datum of a scale is none.
    assert_eq!(warnings(&errors("EA0Z: 3 urad, EAX: 20 urad")), ["W0403"]);
    // The table's axis is on the other side of the bed: X does not tilt it.
    assert_eq!(warnings(&errors("EA0C: 3 urad, EAX: 20 urad")), [""; 0]);
    assert_eq!(warnings(&errors("EX0C: 3 um, EXX: 20 um, ECC: 20 urad")), [""; 0]);
}

/// What a fit makes: rounding of what cannot act, curves that are zero where its datum says, and curves whose sum with
/// the location errors is what the data say.
#[test]
fn what_a_fit_makes_is_no_mistake() {
    let rounding = "errors: { EX0X: 0.000000000000000007 um, EA0X: -0.00002 urad, EZ0C: 0.0000078 um }";
    assert_eq!(warnings(rounding), [""; 0]);
    // Nor is such a residue a location error that a curve would repeat.
    assert_eq!(warnings("errors: { EA0Z: 0.00002 urad, EAX: 20 urad }"), [""; 0]);
    let curve = "errors: { EB0Z: 3 urad, EBZ: { points: [[-400 mm, 0 urad], [0 mm, 20 urad]] } }";
    let with = |zero: &str| warnings(&format!("{curve}\nidentify: {{ datum: {{ zero: {zero} }} }}"));
    assert_eq!((warnings(curve), with("start")), (Vec::new(), Vec::new()));
    assert_eq!((with("machine"), with("middle"), with("free")), (vec!["W0403"], vec!["W0403"], vec!["W0403"]));
    let line = "errors: { EB0Z: 3 urad, EZX: { points: [[0 mm, 0 um], [500 mm, 9 um]] } }";
    let part = |error: &str| format!("{line}\ncovariance:\n  - {{ errors: {{ {error} }} }}");
    assert_eq!(warnings(&part("EZX: { polynomial: [0 um, 1 um/m] }")), [""; 0]);
    assert_eq!(warnings(&part("EZZ: { polynomial: [0 um, 1 um/m] }")), ["W0403"]);
    // Without a covariance the request of the fit names its curves, in a file that a fit wrote.
    let asked = |curve: &str| format!("{line}\nidentify: {{ fit: [\"{curve}\"] }}");
    let made = |curve: &str| asked(curve) + "\nprovenance: { identified-by: abbe }";
    assert_eq!(warnings(&made("EZX:poly1")), [""; 0]);
    assert_eq!((warnings(&made("EZZ:poly1")), warnings(&asked("EZX:poly1"))), (vec!["W0403"], vec!["W0403"]));
}

#[test]
fn location_errors_that_cannot_act_are_told() {
    let inert = "errors: { EX0X: 1 um, EA0X: 1 urad, EZ0C: 1 um, EC0C: { tolerance: 1 urad }, EB0X: 1 urad, EX0C: 1 um, EY0Z: 0 um }";
    assert_eq!(warnings(inert), ["W0402"; 4]);
    assert_eq!(warnings(&format!("{inert}\nconventions: {{ location: carried_body }}")), [""; 0]);
}

#[test]
fn a_b_spline_that_is_none_is_refused_in_words() {
    let with = |spline: &str| {
        let text = small(&format!("errors: {{ EXX: {{ bspline: {{ {spline} }} }} }}"));
        let (machine, diagnostics) = read(&[("m.yaml", &text)]);
        assert!(machine.is_none());
        render(&diagnostics, Rendering::default())
    };
    for (spline, code, words) in [
        ("knots: [0, 500], coefficients: [1 um, 2 um, 3 um]", "E0410", "2 knots and degree 3 take 4"),
        ("degree: 4, knots: [0, 500], coefficients: [1 um]", "E0410", "a B-spline of degree 4"),
        ("degree: 1, knots: [0, 0, 500], coefficients: [1 um, 2 um, 3 um]", "E0410", "do not rise here"),
        ("degree: 1, knots: [0, 400], coefficients: [1 um, 2 um]", "E0409", "is given from 0 to 400 mm"),
        ("degree: 1, knots: [], coefficients: []", "E0410", "has no points"),
        ("degree: 1, knots: [0], coefficients: [1 um]", "E0410", "1 knots and degree 1 take 2"),
        ("degree: 1, knots: [0, 500], coefficients: [1, 2]", "E0204", ""),
        ("degree: 1, knots: [0, 500], coefficients: [90 mm, 2 mm]", "E0412", "which no machine has"),
        ("knot: [0, 500]", "E0201", "knot"),
    ] {
        let said = with(spline);
        assert!(said.contains(code) && said.contains(words), "{spline}: {said}");
    }
}
