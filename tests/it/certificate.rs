//! The certificate of `compile` and `verify`: its contract, and the truth of its numbers.

use serde_json::Value;
use std::path::Path;

use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::norm;
use crate::oracle::program::Folder;
use crate::support::lattice::Lattice;
use crate::support::{Run, abbe, compile, config, left, number, p95_bracket, verify, writes_tables};

/// The trunnion machine in a folder of its own.
fn trunnion(folder: &Folder, errors: &str, volume: &str) -> std::path::PathBuf {
    let text = std::fs::read_to_string(config("trunnion.yaml")).unwrap();
    let head = text.split("\n# Complete").next().unwrap();
    folder.write("machine.yaml", &format!("{head}\nerrors:\n  {errors}\nvolume: {{ {volume} }}\n"))
}

/// 3 x 3 x 3 x 11 x 25 poses.
const COARSE: &str = "step: 250 mm, A: { step: 15 deg }, C: { step: 15 deg }";

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Every key of the contract is there, with a number of the right kind.
fn contract(json: &Value, target: &str, poses: u64) {
    assert_eq!(json["target"], target);
    assert_eq!(json["poses"], poses);
    assert!(!json["files"].as_array().unwrap().is_empty() && json["files"][0].is_string());
    for state in ["uncompensated", "compensated"] {
        for kind in ["position_um", "rotation_urad"] {
            let of = |key: &str| number(json, &format!("/{state}/{kind}/{key}"));
            let (mean, rms, p95, max) = (of("mean"), of("rms"), of("p95"), of("max"));
            assert!(0.0 <= mean && mean <= rms && rms <= max && p95 <= max, "{json}");
            let range = json[state][kind]["range"].as_array().unwrap();
            assert!(range.len() == 3 && range.iter().all(|r| (0.0..=2.0 * max + 1e-9).contains(&r.as_f64().unwrap())));
        }
    }
    for (name, error) in json["errors"].as_object().unwrap() {
        assert!(name.starts_with('E'), "{name}");
        assert!(["fully", "partly", "no"].contains(&error["handled"].as_str().unwrap()), "{error}");
        assert!(error["left_um"].as_f64().unwrap() >= 0.0, "{error}");
    }
}

#[test]
fn the_json_of_compile_and_verify_is_the_contract() {
    for target in ["linuxcnc", "grid-csv"] {
        let folder = Folder::new();
        let machine = config("hmc-4ax.yaml");
        let more = ["--poses", "300", "--seed", "7"];
        let written = compile(&machine, target, &folder.path("out"), &more);
        let json = written.json();
        contract(&json, target, 300);
        assert_eq!(json["errors"].as_object().unwrap().len(), 9 + 4 * 6, "{:?}", keys(&json["errors"]));
        // The files suffice: read back another day they give the same certificate.
        let mut again = verify(&machine, &folder.path("out"), &more).json();
        again["files"] = json["files"].clone();
        assert_eq!(again, json, "{target}");
        // Own-axis tables raise a figure here by half a percent.
        assert_eq!(written.err.contains("W0602"), target == "linuxcnc", "{}", written.err);
    }
}

/// Uniform along one axis, a deviation is known in closed form: every figure of the certificate with it.
#[test]
fn the_figures_are_what_their_names_say() {
    let folder = Folder::new();
    let machine = trunnion(&folder, "EC0Y: 20 urad", COARSE);
    let json = compile(&machine, "linuxcnc", &folder.path("out"), &["--poses", "2000"]).json();
    let of = |key: &str| number(&json, &format!("/uncompensated/position_um/{key}"));
    // 20 urad of up to 450 mm: 9 um. Four standard deviations of a uniform sample of 2000.
    let (top, root) = (9.0, 2000.0_f64.sqrt());
    assert!((of("mean") - top / 2.0).abs() < 4.0 * top / 12.0_f64.sqrt() / root);
    assert!((of("rms") - top / 3.0_f64.sqrt()).abs() < 4.0 * top * (1.0 / 5.0 - 1.0 / 9.0_f64).sqrt() / root);
    assert!((of("p95") - 0.95 * top).abs() < 4.0 * top * (0.95 * 0.05_f64).sqrt() / root);
    assert!(of("max") <= top + 1e-6 && of("max") > top * (1.0 - 10.0 / 2000.0));
    // In the workpiece the direction turns with C, so x and y both see it with either sign.
    let range = |i: usize| number(&json, &format!("/uncompensated/position_um/range/{i}"));
    assert!(range(0) > 1.8 * top && range(0) <= 2.0 * top && range(1) > 1.6 * top, "{json}");
    // A straight slide that stands askew does not turn the tool.
    assert!(number(&json, "/uncompensated/rotation_urad/max") < 1e-9);
}

/// The ceil(0.95 n)-th smallest: of up to 19 the largest, of 20 no more.
#[test]
fn the_quantile_is_the_named_rank() {
    let folder = Folder::new();
    let figure = |poses: &str, key: &str| {
        let json = compile(&config("vmc-cframe-754.yaml"), "linuxcnc", &folder.path("out"), &["--poses", poses]).json();
        number(&json, &format!("/uncompensated/position_um/{key}"))
    };
    for key in ["max", "mean", "rms"] {
        assert_eq!(figure("1", "p95"), figure("1", key));
    }
    assert_eq!(figure("19", "p95"), figure("19", "max"));
    assert!(figure("20", "p95") < figure("20", "max"));
}

#[test]
fn own_axis_tables_do_not_claim_what_they_cannot_do() {
    let folder = Folder::new();
    let json = compile(&config("trunnion.yaml"), "linuxcnc", &folder.path("out"), &[]).json();
    let errors = json["errors"].as_object().unwrap();
    assert_eq!(errors.len(), 11 + 30);
    for (name, error) in errors {
        // Positioning errors, each along its own axis.
        let own = ["EXX", "EYY", "EZZ", "EAA", "ECC"].contains(&name.as_str());
        // The tip is level with the origins of X and Z: it has no arm about Z.
        let harmless = ["ECX", "ECZ"].contains(&name.as_str());
        assert_eq!(harmless, error["alone_um"] == 0.0, "{name}: {error}");
        assert_eq!(error["handled"], if own || harmless { "fully" } else { "no" }, "{name}: {error}");
    }
    // The whole: hardly anything, and the certificate states it.
    let [before, after] = ["uncompensated", "compensated"].map(|w| number(&json, &format!("/{w}/position_um/p95")));
    assert!(after > 0.85 * before, "from {before} to {after}");
}

/// Deviations (um) over own poses in the worse direction, after a lattice's or no correction.
fn alone(machine: &Sample, lattice: Option<&Lattice>, theirs: usize) -> (f64, f64) {
    let poses = left::poses(machine, 3, 2000);
    let command = |pose: &Vec<f64>| lattice.map_or_else(|| pose.clone(), |l| left::corrected(pose, &l.at(pose)));
    let um = |travel| {
        let all = poses.iter().map(|pose| norm(left::position(machine, pose, &command(pose), travel)) * 1000.0);
        p95_bracket(&all.collect::<Vec<_>>(), theirs)
    };
    let [forward, reverse] = [um(Travel::Forward), um(Travel::Reverse)];
    (forward.0.max(reverse.0), forward.1.max(reverse.1))
}

/// Number of poses of the figures of single errors.
const SINGLE_POSES: usize = 2000;

const DIRECTIONS: &str = "XYZABC";

/// The machine with one error alone, as the model of these tests has it.
fn with_only(machine: &Sample, name: &str) -> Sample {
    let (direction, location) = (DIRECTIONS.find(&name[1..2]).unwrap(), &name[2..3] == "0");
    let axis = &name[if location { 3 } else { 2 }..];
    left::only(machine, |joint, k, at| joint == axis && k == direction && at == location)
}

/// Errors out of reach of own-axis tables remain whole: by the model, error by error.
#[test]
fn left_of_single_errors_under_own_axis_tables() {
    let folder = Folder::new();
    let json = compile(&config("trunnion.yaml"), "linuxcnc", &folder.path("out"), &[]).json();
    let machine = crate::support::config::sample(&config("trunnion.yaml"));
    for name in ["EC0Y", "EB0C", "EY0A", "EBX", "EXC", "ECA"] {
        let left = number(&json, &format!("/errors/{name}/left_um"));
        let (low, high) = alone(&with_only(&machine, name), None, SINGLE_POSES);
        assert!((low..=high).contains(&left), "{name}: {left} is not within {low} to {high} um");
    }
}

/// The same error in a machine file of its own, compiled, and its file replayed by us.
#[test]
fn left_of_single_errors_on_a_lattice() {
    let errors = [
        ("EB0C", "EB0C: 24 urad"),
        ("EXC", "EXC: { points: [[0 deg, 0 um], [100 deg, 4 um], [190 deg, -3 um], [360 deg, 0 um]] }"),
        ("EBX", "EBX: { points: [[0 mm, 9 urad], [130 mm, -7 urad], [320 mm, 8 urad], [500 mm, -9 urad]] }"),
        // A lattice cannot hold reversal: half of it remains in either direction.
        (
            "EXX",
            "EXX: { forward: { points: [[0 mm, 0 um], [500 mm, 0 um]] }, reverse: { points: [[0 mm, 8 um], [500 mm, 8 um]] } }",
        ),
    ];
    let folder = Folder::new();
    let all = errors.map(|(_, text)| text).join("\n  ");
    let together = compile(&trunnion(&folder, &all, COARSE), "grid-csv", &folder.path("all"), &[]).json();
    let said = |name: &str, key: &str| number(&together, &format!("/errors/{name}/{key}"));
    // The lattice has so few nodes that all poses count.
    assert_eq!(together["single_error_poses"], SINGLE_POSES);
    for (name, text) in errors {
        let machine = trunnion(&folder, text, COARSE);
        let out = folder.path(name);
        let json = compile(&machine, "grid-csv", &out, &[]).json();
        let theirs = number(&json, "/compensated/position_um/p95");
        // The same poses: first order and the last place of the file are all that can differ.
        let tolerance = 1e-3 * theirs + 2e-4;
        assert!(
            (said(name, "left_um") - theirs).abs() < tolerance,
            "{name}: {} beside {theirs}",
            said(name, "left_um")
        );
        println!("{name}: left {} um, alone in a file {theirs} um", said(name, "left_um"));
    }
    // By the model, with our own interpolation between the nodes of its file.
    let (low, high) = {
        let machine = crate::support::config::sample(&trunnion(&folder, "EB0C: 24 urad", COARSE));
        let lattice = Lattice::read(&std::fs::read_to_string(folder.path("EB0C/corrections.csv")).unwrap());
        alone(&machine, Some(&lattice), SINGLE_POSES)
    };
    assert!(
        (low..=high).contains(&said("EB0C", "left_um")),
        "{} is not within {low} to {high}",
        said("EB0C", "left_um")
    );
    // By hand.
    assert!((said("EXX", "left_um") - 4.0).abs() < 1e-3);
    assert_eq!(together["errors"]["EXX"]["handled"], "partly");
}

/// Of two directions the certificate is that of the worse, and names it.
#[test]
fn the_worse_direction_counts() {
    let folder = Folder::new();
    for (forward, reverse, worse) in [(1.0, 6.0, "reverse"), (-7.0, 3.0, "forward")] {
        let curve = |um: f64| format!("{{ points: [[0 mm, {um} um], [500 mm, {um} um]] }}");
        let both = |name: &str| format!("{name}: {{ forward: {}, reverse: {} }}", curve(forward), curve(reverse));
        let of = |name: &str, target: &str| {
            let out = folder.path(&format!("{name}{target}{worse}"));
            compile(&trunnion(&folder, &both(name), COARSE), target, &out, &["--poses", "50"]).json()
        };
        // Straightness is out of reach of own-axis tables: the larger of both remains.
        let json = of("EYX", "linuxcnc");
        assert_eq!(json["direction"], worse);
        for state in ["uncompensated", "compensated"] {
            let max = number(&json, &format!("/{state}/position_um/max"));
            assert!((max - f64::max(forward.abs(), reverse.abs())).abs() < 1e-5, "{state}: {json}");
        }
        // The figure of the error alone agrees.
        let left = number(&json, "/errors/EYX/left_um");
        assert!((left - f64::max(forward.abs(), reverse.abs())).abs() < 1e-5, "{left}");
        assert_eq!(json["errors"]["EYX"]["handled"], "no");
        // They have a column for each direction of positioning, a lattice holds the mean of both.
        assert!(number(&of("EXX", "linuxcnc"), "/compensated/position_um/max") < 1e-5);
        let half = (reverse - forward) / 2.0;
        // Half a last place of the file.
        assert!((number(&of("EXX", "grid-csv"), "/compensated/position_um/max") - half).abs() < 1e-4);
    }
}

/// The certificate states what is added with all axes at 0, where no home is stated.
#[test]
fn what_happens_at_the_reference_position_is_said() {
    let folder = Folder::new();
    let curve = |um: f64| format!("{{ points: [[0 mm, {um} um], [500 mm, 0 um]] }}");
    let errors = format!("EXX: {{ forward: {}, reverse: {} }}", curve(-3.0), curve(5.0));
    let machine = trunnion(&folder, &errors, COARSE);
    let json = compile(&machine, "linuxcnc", &folder.path("out"), &[]).json();
    // The trim meets the curve at the corrected command: 3 um on a slope of 6e-6.
    assert!((number(&json, "/at_reference/forward/X") - 0.003).abs() < 3e-3 * 6e-6 + 1e-9);
    assert!((number(&json, "/at_reference/reverse/X") + 0.005).abs() < 5e-3 * 1e-5 + 1e-9);
    let text = Run::of(abbe().args(["verify"]).arg(&machine).arg(folder.path("out")));
    assert_eq!(text.code, Some(0), "{}", text.err);
    assert!(
        text.out.contains("With all axes at 0 the controller adds") && text.out.contains("0.003 / -0.005 mm"),
        "{}",
        text.out
    );
}

#[test]
fn a_machine_without_errors_has_a_certificate_of_zeros() {
    let folder = Folder::new();
    let machine = trunnion(&folder, "EC0Y: 0 urad", COARSE);
    for target in ["linuxcnc", "grid-csv"] {
        let json = compile(&machine, target, &folder.path(target), &["--poses", "20"]).json();
        contract(&json, target, 20);
        assert!(number(&json, "/compensated/position_um/max") < 1e-9, "{json}");
    }
}

/// EXX rises by 40 um over X = -200 .. 200 and is 20 at X = 0. Tables that vanish there leave 20 um everywhere, which a shift of X
/// takes away; a shift alone leaves between -20 and 20, evenly spread, whose 95 % is 19.
#[test]
fn a_shift_of_the_zero_is_compared_with_a_shift_alone() {
    let folder = Folder::new();
    let machine = folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: example\nchain: \"w b X Y Z t\"\naxes:\n  X: { controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }\n  Y: { controller: 2, travel: [0 mm, 100 mm], origin: [0, 0, 0] }\n  \
         Z: { controller: 3, travel: [0 mm, 100 mm], origin: [0, 0, 0] }\nerrors:\n  EXX: { points: [[-200 mm, 0 um], [200 mm, 40 um]] }\nvolume: { step: 50 mm }\n",
    );
    for target in ["sinumerik-enc", "fanuc-pitch"] {
        let run = compile(&machine, target, &folder.path(target), &["--accept-unverified", "--poses", "2000"]);
        let json = run.json();
        let of = |key: &str| number(&json, &format!("/{key}"));
        assert!((of("compensated/position_um/rms") - 20.0).abs() < 0.6, "{target}: {json}");
        assert!((of("reference_shift/shift_um/X") + 20.0).abs() < 0.6, "{target}: {json}");
        // Half a detection unit of FANUC's.
        assert!(of("reference_shift/position_um/p95") < 0.6, "{target}: {json}");
        // Four standard deviations of the quantile and of the mean of 2000.
        assert!((of("reference_shift/without_tables_um/p95") - 19.0).abs() < 1.5, "{target}: {json}");
    }
}

/// The tables of the two-axis machine leave a constant and are worse for it: reported, with the reason, and with the
/// effect of moving the machine zero.
#[test]
fn what_gets_worse_is_said() {
    let folder = Folder::new();
    let run = compile(
        &config("papers/hrdina-vasik-2014.yaml"),
        "fanuc-pitch",
        &folder.path("out"),
        &["--accept-unverified", "--poses", "500"],
    );
    let json = run.json();
    let p95 = |path: &str| number(&json, &format!("/{path}/p95"));
    assert!(p95("compensated/position_um") > 1.1 * p95("uncompensated/position_um"), "{json}");
    assert!(p95("reference_shift/position_um") < p95("compensated/position_um"));
    run.says("W0602").says("raise the position deviation: 95 %").says("move the machine zero");
}

/// A controller with the model takes the errors away, and its certificate has an entry to test the sign with.
#[test]
fn a_controller_with_the_model_is_not_said_to_do_nothing() {
    let folder = Folder::new();
    let mut run = abbe();
    run.arg("compile").arg(config("hmc-4ax.yaml")).args(["--target", "isg-volcomp", "--poses", "100", "--out"]);
    let run = Run::of(run.arg(folder.path("out")));
    assert!(!run.err.contains("W0602") && run.out.contains("Then measure: at "), "{}{}", run.err, run.out);
}

/// A table whose tilt shows only where it is turned moves nothing at C = 0, where signs are tested by preference.
#[test]
fn what_acts_on_a_turned_table_only_is_not_nothing() {
    let folder = Folder::new();
    let machine = with_table(&folder, "EA0C: 20 urad");
    for target in ["isg-volcomp", "linuxcnc-kins"] {
        let run = compiled_text(&machine, target, &folder.path(target));
        assert!(!run.err.contains("W0602") && run.out.contains("Then measure: at "), "{}{}", run.err, run.out);
    }
}

/// A module that has nothing to correct adds only rounding, which counts as nothing.
#[test]
fn a_module_without_errors_corrects_nothing() {
    let folder = Folder::new();
    let machine = with_table(&folder, "EXX: { points: [[0, 0 um], [200, 0 um]] }");
    let run = compiled_text(&machine, "linuxcnc-kins", &folder.path("out"));
    assert!(run.err.contains("W0602") && run.err.contains("correct nothing"), "{}{}", run.err, run.out);
    assert!(!run.out.contains("Then measure"), "{}", run.out);
}

/// Text output of `compile`.
fn compiled_text(machine: &Path, target: &str, out: &Path) -> Run {
    let mut run = abbe();
    run.arg("compile").arg(machine).args(["--target", target, "--poses", "50", "--out"]);
    Run::of(run.arg(out))
}

/// The sign is tested with all that the files add at a pose, not with one table's entry.
#[test]
fn the_sign_test_names_the_sum_of_all_tables() {
    let folder = Folder::new();
    let text = "abbe: 1\nmachine: m\nchain: \"w X' b Y Z t\"\naxes:\n  X: { controller: 1, travel: [0, 500], origin: [0, 0, 0] }\n  Y: { controller: 2, travel: [0, 400], origin: [0, 0, 0] }\n  Z: { controller: 3, travel: [-300, 0], origin: [0, 0, 0] }\nerrors:\n  EXX: { points: [[0, 0 um], [500, 10 um]] }\n  EXY: { points: [[0, 4 um], [200, 1 um], [400, 4 um]] }\n";
    let machine = folder.write("machine.yaml", text);
    for target in ["sinumerik-cec", "twincat-axis", "grid-csv"] {
        let run = compiled_text(&machine, target, &folder.path(target));
        let said = run.out.lines().find(|line| line.starts_with("Then measure")).unwrap_or_default();
        // 10 um at X = 500 and 4 um at Y = 0 or 400, both of X.
        assert!(
            said.contains("X = 500 mm, Y = ") && said.contains("the files add -0.014 mm to X"),
            "{target}: {}",
            run.out
        );
        assert!(said.contains("by -0.014 mm; by 0.014 mm means a wrong sign"), "{target}: {said}");
    }
}

/// Where nothing is added forward the test is one in reverse, and such files correct something.
#[test]
fn the_sign_test_comes_in_reverse_where_only_that_is_corrected() {
    let folder = Folder::new();
    let table = folder.write("x.csv", "X [mm], EXX+ [um], EXX- [um], EYX [um]\n0, 0, 0, 0\n500, 0, 2, 9\n");
    assert!(table.exists());
    let text = "abbe: 1\nmachine: m\nchain: \"w X' b Y Z t\"\naxes:\n  X: { controller: 1, travel: [0, 500], origin: [0, 0, 0] }\n  Y: { controller: 2, travel: [0, 400], origin: [0, 0, 0] }\n  Z: { controller: 3, travel: [-300, 0], origin: [0, 0, 0] }\nmeasured: [x.csv]\n";
    let machine = folder.write("machine.yaml", text);
    let run = compiled_text(&machine, "linuxcnc", &folder.path("out"));
    let said = run.out.lines().find(|line| line.starts_with("Then measure")).unwrap_or_default();
    assert!(said.contains("X = 500 mm,") && said.contains("coming in reverse, the files add -0.002 mm to X"), "{said}");
    assert!(!run.err.contains("W0602"), "{}", run.err);
}

/// Tables that are given at 1000 mm, or an increment beyond the end, are tested where the machine can go.
#[test]
fn the_sign_test_is_within_the_travel() {
    let folder = Folder::new();
    for target in ["marlin", "klipper", "reprapfirmware", "sinumerik-cec"] {
        let out = folder.path(target);
        let mut run = abbe();
        run.arg("compile").arg(config("trunnion.yaml")).args(["--accept-unverified", "--target", target, "--out"]);
        let run = Run::of(run.arg(&out).args(["--poses", "50"]));
        let said = run.out.lines().find_map(|line| line.strip_prefix("Then measure: at ")).unwrap_or(&run.err);
        let at = |axis: &str| {
            let words = said.split_once(&format!("{axis} = ")).unwrap_or_else(|| panic!("{target}: {said}")).1;
            words.split_whitespace().next().unwrap().parse::<f64>().unwrap()
        };
        let (x, y, z) = (at("X"), at("Y"), at("Z"));
        assert!((0.0..=500.0).contains(&x) && (0.0..=450.0).contains(&y) && (-400.0..=0.0).contains(&z), "{said}");
    }
}

/// Options that would be without effect are refused.
#[test]
fn what_has_no_effect_is_no_option() {
    let folder = Folder::new();
    let (machine, out) = (config("vmc-cframe-754.yaml"), folder.path("out"));
    compile(&machine, "linuxcnc-kins", &out, &["--poses", "1"]).json();
    let installed = ["--poses", "1", "--installed", out.to_str().unwrap()];
    assert_eq!(compile(&machine, "linuxcnc-kins", &folder.path("other"), &installed).code, Some(2));
    assert_eq!(verify(&machine, &out, &installed).code, Some(2));
    assert_eq!(compile(&machine, "grid-csv", &folder.path("grid"), &["--lattice", "X,X"]).code, Some(2));
}

/// The number is the sum of the files' corrections, not the correction that the machine needs: the matrix by hand, at
/// the pose that is named.
#[test]
fn the_sign_test_of_a_matrix_is_the_matrix() {
    let folder = Folder::new();
    let out = folder.path("out");
    let run = compiled_text(&config("vmc-cframe-754.yaml"), "linuxcnc-matrixkins", &out);
    let said = run.out.lines().find(|line| line.starts_with("Then measure")).unwrap_or_default();
    let after = |key: &str| {
        let words = said.split_once(key).unwrap_or_else(|| panic!("{key}: {said}")).1;
        words.split_whitespace().next().unwrap().parse::<f64>().unwrap()
    };
    let hal = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path());
    let hal = hal.filter(|path| path.extension().is_some_and(|e| e == "hal"));
    let hal: String = hal.map(|path| std::fs::read_to_string(path).unwrap()).collect();
    let of = |name: &str| {
        let line = hal.lines().find(|line| line.contains(&format!("matrixkins.C_{name} "))).unwrap();
        line.rsplit(' ').next().unwrap().parse::<f64>().unwrap()
    };
    let moved = said.split_once(" mm to ").unwrap().1.chars().next().unwrap().to_ascii_lowercase();
    let added = |axis: char| {
        let unit = f64::from(u8::from(axis == moved));
        (of(&format!("{moved}{axis}")) - unit) * after(&format!("{} = ", axis.to_ascii_uppercase()))
    };
    let sum: f64 = "xyz".chars().map(added).sum();
    // Four digits are printed.
    assert!((sum - after("the module adds ")).abs() < 1e-3 * sum.abs(), "{sum} {said}");
}

/// With a tool that the tables were not made for: reported, and the corrections of a kinematics module are right all
/// the same.
#[test]
fn sets_are_judged_with_another_tool() {
    let (folder, machine) = (Folder::new(), config("ht-b-c.yaml"));
    for target in ["linuxcnc-kins", "grid-csv"] {
        let out = folder.path(target);
        let _ = compile(&machine, target, &out, &["--tool", "short", "--poses", "50"]).json();
        let run = verify(&machine, &out, &["--tool", "long", "--poses", "50"]);
        let left = number(&run.json(), "/compensated/position_um/max");
        if target == "grid-csv" {
            run.says("W0706").says("made for the tool `short` and are judged with `long`");
            assert!(left > 0.5, "{left}");
        } else {
            assert!(!run.err.contains("W0706") && left < 1e-3, "{left} {}", run.err);
        }
    }
}

/// Three linear axes and an endless table.
fn with_table(folder: &Folder, errors: &str) -> std::path::PathBuf {
    let axes = [("X", 1), ("Y", 2), ("Z", 3)]
        .map(|(name, number)| format!("  {name}: {{ controller: {number}, travel: [0 mm, 200 mm] }}\n"))
        .concat();
    let text = format!(
        "abbe: 1\nmachine: example\nchain: \"w C' b X Y Z t\"\naxes:\n{axes}  C: {{ controller: 4, travel: continuous }}\nerrors: {{ {errors} }}\n\
         volume: {{ step: 50 mm, C: {{ step: 45 deg }} }}\n"
    );
    folder.write("machine.yaml", &text)
}

/// Nothing to compensate is no failure: old tables are removed, and `verify`, `diff` and `--installed` accept the rest.
#[test]
fn sets_without_tables() {
    for target in abbe::controller::NAMES.into_iter().filter(|name| writes_tables(name)) {
        let folder = Folder::new();
        let out = folder.path("out");
        let more = ["--accept-unverified", "--poses", "20", "--nodes", "300"];
        let bent = "EXX: { points: [[0 mm, 0 um], [100 mm, 9 um], [200 mm, 0 um]] }, EC0Y: 30 urad";
        let machine = with_table(&folder, bent);
        compile(&machine, target, &out, &more).json();
        let machine = with_table(&folder, "");
        let run = compile(&machine, target, &out, &more);
        run.says("W0602").says("the tables correct nothing");
        let json = run.json();
        assert!(number(&json, "/compensated/position_um/max") < 1e-9, "{target}: {json}");
        let again = verify(&machine, &out, &["--poses", "20"]).json();
        assert_eq!(again["compensated"], json["compensated"], "{target}");
        let mut diff = abbe();
        diff.arg("diff").arg(&machine).args([&out, &out]).args(["--format", "json", "--poses", "3"]);
        assert_eq!(number(&Run::of(&mut diff).json(), "/position_um/max"), 0.0, "{target}");
        let (machine, old) = (with_table(&folder, bent), out.to_str().unwrap());
        let first = compile(&machine, target, &folder.path("first"), &more).json();
        let sum = compile(&machine, target, &folder.path("sum"), &[&more[..], &["--installed", old]].concat()).json();
        assert_eq!(sum["compensated"], first["compensated"], "{target}");
        // Another target's name finds nothing there.
        let other = if target == "pmac" { "sinumerik-enc" } else { "pmac" };
        assert_eq!(verify(&machine, &out, &["--target", other, "--poses", "5"]).code, Some(1), "{target}");
    }
}

/// Tables that vanish at C = 0 cannot hold ECC of 10 urad everywhere: all of it remains, as the constant of a linear
/// axis would.
#[test]
fn a_constant_is_left_of_a_single_rotary_error_too() {
    let folder = Folder::new();
    let errors = "ECC: { points: [[0 deg, 10 urad], [180 deg, 12 urad], [360 deg, 10 urad]] }, EXX: { points: [[0 mm, 0 um], [200 mm, 5 um]] }";
    let json = compile(&with_table(&folder, errors), "sinumerik-enc", &folder.path("out"), &["--poses", "400"]).json();
    let of = |key: &str| number(&json, &format!("/errors/ECC/{key}"));
    // From 10 to 12 urad alone, 10 urad afterwards, at the same radii: within their ratio.
    assert!(of("left_um") > of("alone_um") * 10.0 / 12.0 - 1e-3 && of("left_um") < of("alone_um"), "{json}");
    assert_eq!(json["errors"]["ECC"]["handled"], "partly");
}
