//! Tables whose values change in steps: the oracle is a staircase written here, and the machine's own straight error.

use std::path::Path;

use serde_json::Value;

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile};

/// X is 24 um too far at 800 mm, straight.
const LONG: &str = "abbe: 1\nmachine: long\nchain: \"w b X Y Z t\"\naxes:\n  X: { controller: 1, travel: [0 mm, 800 mm] }\n  \
    Y: { controller: 2, travel: [0 mm, 10 mm] }\n  Z: { controller: 3, travel: [0 mm, 10 mm] }\nerrors:\n  \
    EXX: { points: [[0 mm, 0 um], [800 mm, 24 um]] }\nvolume: { step: 10 mm }\n";
const FEW: [&str; 3] = ["--accept-unverified", "--poses", "2000"];

fn max(json: &Value, which: &str) -> f64 {
    json.pointer(&format!("/{which}/position_um/max")).unwrap().as_f64().unwrap()
}

/// Parameter, or none.
fn parameter(text: &str, begin: &str) -> f64 {
    text.lines().find_map(|line| line.strip_prefix(begin)).unwrap().parse().unwrap()
}

fn verify(machine: &Path, folder: &Path) -> Run {
    Run::of(abbe().arg("verify").arg(machine).arg(folder).args(["--target", "fanuc-pitch", "--format", "json"]))
}

/// 24 pulses of 1 um need sections of 33.3 mm; the next length in thousandths that meets both ends is 32 mm.
#[test]
fn pulses_are_a_unit_and_certified_at_the_worse_end() {
    let folder = Folder::new();
    let machine = folder.write("long.yaml", LONG);
    let run = compile(&machine, "fanuc-pitch", &folder.path("out"), &FEW);
    let json = run.json();
    let text = std::fs::read_to_string(folder.path("out/PITCH_X.TXT")).unwrap();
    assert_eq!(parameter(&text, "N03624Q1A1M"), 32.0, "{text}");
    let increments: Vec<f64> = (1..=25).map(|n| parameter(&text, &format!("N{}Q0P", 10_000 + n))).collect();
    // The staircase at both ends of its sections against the error, every 0.1 mm; a mm of X moves the table by 3e-5 mm.
    let sums: Vec<f64> = (0..=25).map(|n| increments[..n].iter().sum::<f64>()).collect();
    let worst = |end: usize| {
        let left = |i: u32| {
            let x = f64::from(i) / 10.0;
            let section = (x / 32.0) as usize;
            let upper = usize::from(x > section as f64 * 32.0);
            (0.03 * x + sums[(section + if end == 0 { upper } else { 0 }).min(25)]).abs()
        };
        (0..=8000).map(left).fold(0.0, f64::max)
    };
    let expected = f64::max(worst(0), worst(1));
    let found = max(&json, "compensated");
    assert!(found <= expected + 1e-3 && found > expected - 0.15, "{found}, not {expected}");
    assert!(expected < 1.51 && max(&json, "straight") < 0.51, "{json}");
    let again = verify(&machine, &folder.path("out")).json();
    assert!(max(&again, "compensated") > 0.9 && max(&again, "straight") < 0.51, "{again}");
}

/// One pulse of 24 um in a section of 800 mm: at its worse end 24 um are left, of a straight line nothing.
#[test]
fn one_pulse_over_the_travel_is_no_straight_line() {
    let folder = Folder::new();
    let machine = folder.write("long.yaml", LONG);
    let set = folder.path("set");
    std::fs::create_dir(&set).unwrap();
    let text = "%\nN03620Q1A1P0\nN03621Q1A1P1\nN03622Q1A1P1\nN03623Q1A1P1\nN03624Q1A1M800.000\nN10001Q0P-24\n%\n";
    std::fs::write(set.join("PITCH_X.TXT"), text).unwrap();
    let run = verify(&machine, &set);
    let json = run.json();
    assert!((23.5..24.01).contains(&max(&json, "compensated")), "{json}");
    assert!(max(&json, "straight") < 1e-2, "{json}");
    let text = Run::of(abbe().arg("verify").arg(&machine).arg(&set).args(["--target", "fanuc-pitch"])).out;
    assert!(text.contains("With straight lines, an option of the control: position 95 %"), "{text}");
}

/// A manifest may say that its control has no straight lines.
#[test]
fn a_control_with_steps_alone() {
    let folder = Folder::new();
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/templates/fanuc-pitch");
    std::fs::create_dir(folder.path("pulses")).unwrap();
    for name in ["target.yaml", "pitch.j2", "readme.j2"] {
        let text = std::fs::read_to_string(format!("{source}/{name}")).unwrap();
        let text = text.replace("target: fanuc-pitch", "target: pulses").replace("step_or_linear", "step");
        std::fs::write(folder.path("pulses").join(name), text).unwrap();
    }
    let machine = folder.write("long.yaml", LONG);
    let templates = folder.path(".");
    let more = [&FEW[..], &["--templates", templates.to_str().unwrap()]].concat();
    let json = compile(&machine, "pulses", &folder.path("out"), &more).json();
    assert!(json.get("straight").is_none() && max(&json, "compensated") > 0.9, "{json}");
    // The replay has the pulse at the far end of its section.
    let places = folder.write("places.csv", "axis,direction,position\nX,forward,31.9\nX,forward,96.1\n");
    let run = Run::of(
        abbe()
            .arg("verify")
            .arg(&machine)
            .arg(folder.path("out"))
            .arg("--templates")
            .arg(&templates)
            .arg("--replay")
            .arg(places),
    );
    let added: Vec<f64> = run.out.lines().skip(1).map(|l| l.rsplit(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!(added, [0.0, -0.003], "{}", run.out);
}
