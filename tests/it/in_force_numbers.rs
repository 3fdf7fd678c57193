//! Numbers in force are judged before anything is added to them: signs, unit vectors, lines of another machine; tables
//! of which nothing was said; factors by the motion that they make. Expected distances are shifts put in by hand.

use std::path::{Path, PathBuf};

use crate::kinematic_parameters::{compiled, numbers, table_table};
use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile};

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "20"];
const ERRORS: &str = "  EX0C: 20 um\n  EA0C: 30 urad\n";

/// A machine, and the numbers that are in force on it.
struct InForce {
    folder: Folder,
    machine: PathBuf,
    installed: PathBuf,
}

impl InForce {
    fn new() -> Self {
        let folder = Folder::new();
        let (machine, installed, _) = compiled(&folder, &table_table(ERRORS), "sinumerik-traori");
        std::fs::remove_file(installed.join("abbe.lock.json")).unwrap();
        Self { folder, machine, installed }
    }

    /// Changes the numbers in force by name.
    fn change(self, change: impl Fn(&str, f64) -> f64) -> Self {
        let file = self.installed.join("TRAORI.INI");
        let line = |line: &str| match line.split(';').next().unwrap().trim().split_once('=') {
            Some((name, value)) => {
                let short = name.trim_start_matches("$MC_TRAFO5_");
                format!("{name}={:.9}\n", change(short, value.parse().unwrap()))
            }
            None => format!("{line}\n"),
        };
        let text: String = std::fs::read_to_string(&file).unwrap().lines().map(line).collect();
        std::fs::write(file, text).unwrap();
        self
    }

    fn added(&self, more: &[&str]) -> Run {
        let over = ["--installed", self.installed.to_str().unwrap()];
        compile(&self.machine, "sinumerik-traori", &self.folder.path("new"), &[&FEW[..], &over, more].concat())
    }

    fn number(&self, of: &Path, name: &str) -> f64 {
        numbers(&of.join("TRAORI.INI"))[name]
    }
}

/// Adds to one number.
fn shift<'a>(by: &'a [(&'a str, f64)]) -> impl Fn(&str, f64) -> f64 + 'a {
    move |name, value| value + by.iter().filter(|(shifted, _)| *shifted == name).map(|(_, by)| by).sum::<f64>()
}

#[test]
fn signs_that_the_manifest_does_not_have_are_refused_with_its_hypothesis() {
    let all = InForce::new().change(|_, value| -value);
    let run = all.added(&[]);
    run.refused("E0753").says("have the other sign").says("TRAFO5_AXIS2_1[2]").says("this refutes, for this control");
    run.says("AXIS1 V1, AXIS2 V2");
    // Only one vector: no other is named.
    let one = InForce::new().change(|name, value| if name.starts_with("AXIS2") { -value } else { value });
    let run = one.added(&[]);
    run.refused("E0753").says("the other sign: `TRAFO5_AXIS2_1[1]`, `TRAFO5_AXIS2_1[2]`\n");
}

#[test]
fn a_direction_is_a_unit_vector() {
    let long = InForce::new().change(|name, value| if name.starts_with("AXIS1") { 1.2 * value } else { value });
    long.added(&["--max-change", "1 m"]).refused("E0753").says("`TRAFO5_AXIS1_1[0]` on has the length 1.2, not 1");
}

/// 50 mm beside, as from the file of another machine; the limit is raised by its option alone.
#[test]
fn lines_of_another_machine_are_refused() {
    let far = InForce::new().change(shift(&[("JOINT_OFFSET_1[0]", 50.0), ("PART_OFFSET_1[0]", -50.0)]));
    far.added(&[]).refused("E0753").says("the line of `C` is 50.").says("above the limit of 1 mm");
    far.added(&["--max-change", "49 mm"]).refused("E0753").says("above the limit of 49 mm");
    let run = far.added(&["--max-change", "51 mm"]);
    assert!(run.code == Some(0) && run.err.contains("warning[W0762]"), "{}", run.err);
    // C turned by 10 mrad about X: 2 mm at 200 mm.
    let tilted = InForce::new().change(|name, value| match name {
        "AXIS2_1[1]" => value + 0.01,
        "AXIS2_1[2]" => value * (1.0_f64 - 1e-4).sqrt(),
        _ => value,
    });
    tilted.added(&[]).refused("E0753").says("the line of `C` is 2.0");
}

/// A point may stand anywhere on its line, and a line 0.3 mm beside is taken: new is old plus 20 um, as the errors say.
#[test]
fn points_slide_along_their_axes_and_small_shifts_are_said() {
    let slid = InForce::new().change(shift(&[("BASE_TOOL_1[0]", 50.0), ("JOINT_OFFSET_1[0]", -50.0)]));
    let run = slid.added(&[]);
    assert!(run.code == Some(0) && !run.err.contains("W0762"), "{}", run.err);
    let beside = InForce::new().change(shift(&[("JOINT_OFFSET_1[0]", 0.3), ("PART_OFFSET_1[0]", -0.3)]));
    let run = beside.added(&[]);
    run.json();
    assert!(run.err.contains("warning[W0762]: in force, the line of `C` is 0.32 mm"), "{}", run.err);
    let [old, new] = [&beside.installed, &beside.folder.path("new")]
        .map(|of| beside.number(of, "JOINT_OFFSET_1[0]") + beside.number(of, "BASE_TOOL_1[0]"));
    assert!((new - old - 0.02).abs() < 2e-6, "{old} {new}");
}

/// The same in a set of two targets, for `verify` and for `locate`.
#[test]
fn every_verb_judges_what_is_in_force() {
    let of = InForce::new();
    let new = of.folder.path("new");
    of.added(&[]).json();
    let far = of.change(shift(&[("JOINT_OFFSET_1[0]", 50.0), ("PART_OFFSET_1[0]", -50.0)]));
    let over = ["--installed", far.installed.to_str().unwrap()];
    for verb in [&["verify", "--poses", "20"][..], &["locate"]] {
        let _ = Run::of(abbe().args(verb).arg(&far.machine).arg(&new).args(over)).refused("E0753").says("`C` is 50.");
    }
    let both = ["--target", "sinumerik-cec"];
    let out = far.folder.path("both");
    compile(&far.machine, "sinumerik-traori", &out, &[&FEW[..], &both].concat()).json();
    std::fs::remove_file(out.join("sinumerik-traori/abbe.lock.json")).unwrap();
    std::fs::copy(far.installed.join("TRAORI.INI"), out.join("sinumerik-traori/TRAORI.INI")).unwrap();
    let over = ["--installed", out.to_str().unwrap()];
    let run = compile(&far.machine, "sinumerik-traori", &far.folder.path("sum"), &[&FEW[..], &both, &over].concat());
    run.refused("E0753").says("`C` is 50.");
}

/// Tables may be in force: with a manifest or without one they are to be named, or said not to be.
#[test]
fn parameters_are_not_put_beside_tables_of_which_nothing_was_said() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", &table_table(&format!("{ERRORS}  EC0Y: 31 urad\n")));
    let out = folder.path("out");
    compile(&machine, "sinumerik-cec", &out, &FEW).json();
    // It holds the set that takes the tables back, which another target does not replace.
    std::fs::remove_dir_all(out.join("restore")).unwrap();
    let parameters = |more: &[&str]| compile(&machine, "sinumerik-traori", &out, &[&FEW[..], more].concat());
    let before = crate::support::tree(&out);
    parameters(&[]).refused("E0754").says("tables of `sinumerik-cec`").says("--nothing-else");
    std::fs::remove_file(out.join("abbe.lock.json")).unwrap();
    parameters(&[]).refused("E0754").says("tables of `sinumerik-cec`");
    assert!(before.len() == crate::support::tree(&out).len() + 1);
    parameters(&["--nothing-else"]).json();
    // Its own set is none of tables, and is replaced.
    std::fs::remove_file(out.join("_N_NC_CEC_INI")).unwrap();
    parameters(&[]).json();
}

/// A factor of 1.2 mm/m moves a stage of 10 mm by 12 um, and one of 900 mm by 1.08 mm.
#[test]
fn a_factor_is_judged_by_the_motion_that_it_makes() {
    let folder = Folder::new();
    let machine = |y: &str| {
        folder.write(
            &format!("{y}.yaml"),
            &format!(
                "abbe: 1\nmachine: printer\nchain: \"w Y' b X Z (S) t\"\naxes:\n  X: {{ travel: [0 mm, 10 mm] }}\n  \
                 Y: {{ travel: [0 mm, {y} mm] }}\n  Z: {{ travel: [0 mm, 10 mm] }}\nerrors:\n  EC0Y: 1200 urad\n"
            ),
        )
    };
    compile(&machine("10"), "marlin", &folder.path("small"), &["--poses", "20"]).json();
    let text = std::fs::read_to_string(folder.path("small/skew.gcode")).unwrap();
    let factor: f64 =
        text.split_whitespace().find_map(|word| word.strip_prefix('I')).and_then(|number| number.parse().ok()).unwrap();
    assert!((factor.abs() - 0.0012).abs() < 2e-6, "{factor}");
    let large = compile(&machine("900"), "marlin", &folder.path("large"), &["--poses", "20"]);
    large.refused("E0602").says("a correction of 1.08 mm for `X`").says("limit of 1 mm");
}

/// A pitch of X hides its positioning error where Z is low. Tables of the positioning error alone bring the pitch to
/// light: 20 um are left by the parameters at most in the middle, up to 40 um with the tables.
#[test]
fn tables_that_leave_more_than_the_parameters_alone_are_said() {
    let folder = Folder::new();
    let run = |sign: &str| {
        let errors = format!(
            "  EX0C: 40 um\n  EXX: {{ points: [[0 mm, 0 um], [500 mm, 20 um]] }}\n  \
             EBX: {{ points: [[0 mm, 0 urad], [500 mm, {sign}100 urad]] }}\n"
        );
        let text = ["A", "C"].iter().fold(table_table(&errors), |text, axis| {
            text.replace(&format!("  {axis}: {{ "), &format!("  {axis}: {{ sense: direct, "))
        });
        let text = ["X", "Y", "Z"].iter().fold(text, |text, axis| {
            text.replace(&format!("  {axis}: {{ "), &format!("  {axis}: {{ origin: [0, 0, 0], "))
        });
        let machine = folder.write(&format!("machine{sign}.yaml"), &text);
        compile(
            &machine,
            "linuxcnc-trt",
            &folder.path(&format!("out{sign}")),
            &["--target", "linuxcnc", "--poses", "200"],
        )
    };
    let run_of_both = run("");
    let json = run_of_both.json();
    let p95 = |step: usize| json["steps"][step]["compensated"]["position_um"]["p95"].as_f64().unwrap();
    assert!(p95(0) < 22.0 && (36.0..42.0).contains(&p95(1)), "{json}");
    run_of_both.says("warning[W0602]: beside the parameters the tables raise");
    let other = run("-");
    let _ = other.json();
    assert!(!other.err.contains("W0602"), "{}", other.err);
}
