//! Every form the machine language has, read and resolved.

use abbe::diagnostic::{Diagnostics, Rendering, render};
use abbe::machine::{self, Approach, Branch, Machine};
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
  X: { travel: [0 mm, 500 mm] }
  Y: { travel: [0 mm, 450 mm] }
  Z: { travel: [-400 mm, 0 mm] }
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
    let exx = |approach| machine.component_values(3, 250.0, approach)[0];
    assert_eq!((exx(Approach::Forward), exx(Approach::Reverse)), (5.0 * 1e-3, 6.5 * 1e-3));
    assert!((machine.component_values(3, 500.0, Approach::Mean)[4] - 2e-6).abs() < 1e-18);
    assert_eq!(machine.component_values(0, 450.0, Approach::Mean)[0], 3.0 * 1e-3);
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
            let document = syntax::load(&path, &abbe::cli::files::Disk, &mut diagnostics).unwrap();
            let machine = machine::resolve(&document, &abbe::cli::files::Disk, &mut diagnostics);
            assert!(machine.is_some(), "{}", render(&diagnostics, Rendering::default()));
            seen += 1;
        }
    }
    assert!(seen > 5);
}
