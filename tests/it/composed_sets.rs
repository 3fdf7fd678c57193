//! Kinematic parameters and tables for what they leave, certified together: by the manual's transformation and the
//! manual's sum of tables, both read from the files.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::kinematic_parameters::{Control, OF_TABLES, numbers, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample};
use crate::oracle::matrix::norm;
use crate::oracle::program::Folder;
use crate::support::cec::CorrectionTables;
use crate::support::config::sample;
use crate::support::{Run, abbe, compile, left, names, number, p95_bracket, tree, verify};

const POSES: usize = 400;

/// Location errors of the table, which parameters take; a squareness and curves, which they leave.
fn machine(folder: &Folder) -> PathBuf {
    let squareness = "  EC0Y: 31 urad\n  EB0Z: -22 urad\n";
    let text = table_table(&format!("{OF_TABLES}{squareness}measured: [x.csv, y.csv]\n"));
    let _ = folder.write("x.csv", "X [mm],EXX [um]\n0,0\n500,19\n");
    let _ = folder.write("y.csv", "Y [mm],EZY [um]\n0,0\n200,9\n450,-6\n");
    let origins = ["X", "Y", "Z"]
        .into_iter()
        .fold(text, |text, name| text.replace(&format!("  {name}: {{ "), &format!("  {name}: {{ origin: [0, 0, 0], ")));
    folder.write(
        "machine.yaml",
        &format!("{origins}volume: {{ step: 100 mm, A: {{ step: 30 deg }}, C: {{ step: 30 deg }} }}\n"),
    )
}

fn both(folder: &Folder, targets: &[&str]) -> Run {
    over(folder, targets, &[])
}

fn over(folder: &Folder, targets: &[&str], options: &[&str]) -> Run {
    let mut command = abbe();
    command.args(["compile", "--format", "json", "--accept-unverified", "--poses", &POSES.to_string()]);
    for target in targets {
        let _ = command.args(["--target", target]);
    }
    Run::of(command.args(options).arg(folder.path("machine.yaml")).arg("--out").arg(folder.path("out")))
}

/// Commands of the motors with the set in a folder, by the manuals alone.
fn sent<'a>(out: &Path, sample: &'a Sample) -> impl Fn(&Pose) -> Pose + 'a {
    let control = Control::traori("table-table", &numbers(&out.join("sinumerik-traori/TRAORI.INI")));
    let text = std::fs::read_to_string(out.join("sinumerik-cec/_N_NC_CEC_INI")).unwrap();
    let tables = CorrectionTables::read(&text).unwrap();
    // AX1 to AX5 are X Y Z A C; a stored number is an error.
    let order = ["X", "Y", "Z", "A", "C"];
    let index = order.map(|name| sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap());
    move |pose| {
        let mut command = control.inverse(sample, pose, left::ideal(sample, pose));
        let position = index.map(|axis| command[axis]);
        for (number, axis) in index.iter().enumerate() {
            command[*axis] -= tables.sum(number + 1, &position, false, [true, true]);
        }
        command
    }
}

/// A run that was killed in a subfolder, or while it replaced both: no verb takes the set for whole.
#[test]
fn a_half_replaced_part_is_refused_wherever_it_is_read() {
    let folder = Folder::new();
    let path = machine(&folder);
    let _ = both(&folder, &["sinumerik-traori", "sinumerik-cec"]).json();
    let out = folder.path("out");
    for part in [".", "sinumerik-traori", "sinumerik-cec"] {
        let list = out.join(part).join(".abbe-set.json");
        std::fs::write(&list, "{}").unwrap();
        verify(&path, &out, &["--poses", "3"]).refused("E0733");
        Run::of(abbe().arg("diff").arg(&path).arg(&out).arg(&out)).refused("E0733");
        if part == "sinumerik-traori" {
            Run::of(abbe().arg("locate").arg(&path).arg(out.join(part))).refused("E0733");
        }
        std::fs::remove_file(list).unwrap();
    }
    assert_eq!(verify(&path, &out, &["--poses", "3"]).code, Some(0));
}

/// Two runs at the same time into one folder leave both parts of one of them.
#[test]
fn runs_at_the_same_time_leave_the_sets_of_one() {
    let folder = Folder::new();
    let first = std::fs::read_to_string(machine(&folder)).unwrap();
    let files = [("a.yaml", first.clone()), ("b.yaml", first.replace("EX0C: 26 um", "EX0C: 7 um"))];
    let paths = files.map(|(name, text)| folder.write(name, &text));
    let run = |path: &Path, out: &str| {
        let mut command = abbe();
        command.args(["compile", "--accept-unverified", "--poses", "3", "--quiet"]).arg(path);
        command.args(["--target", "sinumerik-traori", "--target", "sinumerik-cec", "--out"]).arg(folder.path(out));
        command
    };
    for (path, out) in paths.iter().zip(["a", "b"]) {
        assert_eq!(Run::of(&mut run(path, out)).code, Some(0));
    }
    let started: Vec<_> = (0..12).map(|i| run(&paths[i % 2], "out").stdout(Stdio::null()).spawn().unwrap()).collect();
    for mut child in started {
        assert!(child.wait().unwrap().success());
    }
    let files = |out: &str| {
        let all = tree(&folder.path(out)).into_iter();
        all.map(|(path, entry)| (path.strip_prefix(folder.path(out)).unwrap().to_owned(), entry)).collect::<Vec<_>>()
    };
    assert!(files("out") == files("a") || files("out") == files("b"));
}

/// Half a year later: the machine is measured with both in force. Parameters are added to parameters and tables to
/// tables; what is left is of the new motions less the old ones.
#[test]
fn new_sets_stand_on_those_in_force() {
    let folder = Folder::new();
    let path = machine(&folder);
    let targets = ["sinumerik-traori", "sinumerik-cec"];
    let _ = both(&folder, &targets).json();
    std::fs::rename(folder.path("out"), folder.path("old")).unwrap();
    let moved = [("EX0C: 26 um", "EX0C: 7 um"), ("EZ0A: 17 um", "EZ0A: -11 um"), ("EB0A: 54 urad", "EB0A: 20 urad")];
    let text = moved.into_iter().fold(std::fs::read_to_string(&path).unwrap(), |text, (from, to)| {
        assert!(text.contains(from));
        text.replace(from, to)
    });
    let _ = folder.write("machine.yaml", &text);
    let _ = folder.write("x.csv", "X [mm],EXX [um]\n0,0\n500,-8\n");
    let installed = folder.path("old").display().to_string();
    let json = over(&folder, &targets, &["--installed", &installed]).json();
    let (old, new) = (folder.path("old"), folder.path("out"));
    let number_of = |out: &Path, name: &str| numbers(&out.join("sinumerik-traori/TRAORI.INI"))[name];
    // Both point of C and gauge count from the machine: X of C is that of A plus the offset between them.
    let x_of_c = |out: &Path| number_of(out, "BASE_TOOL_1[0]") + number_of(out, "JOINT_OFFSET_1[0]");
    assert!((x_of_c(&new) - x_of_c(&old) - 0.007).abs() < 3e-6, "{} {}", x_of_c(&new), x_of_c(&old));

    let sample = sample(&path);
    let (before, now) = (sent(&old, &sample), sent(&new, &sample));
    let remaining: Vec<f64> = left::poses(&sample, 8, 2000)
        .iter()
        .map(|pose| {
            let motion = now(pose).into_iter().zip(before(pose)).map(|(new, old)| new - old);
            let command = pose.iter().zip(motion).map(|(q, motion)| q + motion).collect();
            1e3 * norm(left::position(&sample, pose, &command, Travel::Mean))
        })
        .collect();
    let (low, high) = p95_bracket(&remaining, POSES);
    let by_rotary_axes = number(&json["programming"][0], "/compensated/position_um/p95");
    // The certificate moves the lines of the errors, not by the difference of two motions: 1e-2 um of second order.
    assert!(low - 0.02 <= by_rotary_axes && by_rotary_axes <= high + 0.02, "{low} {by_rotary_axes} {high}");
    assert!(high < 0.3 * number(&json, "/uncompensated/position_um/p95"), "{high} {json}");
    let poses = POSES.to_string();
    let again = verify(&path, &new, &["--poses", &poses, "--installed", &installed]).json();
    for key in ["compensated", "steps", "programming", "errors"] {
        assert_eq!(again[key], json[key], "{key}");
    }
    let part = folder.path("old").join("sinumerik-cec").display().to_string();
    let _ = over(&folder, &targets, &["--installed", &part]).refused("E0711").says("holds no set of two targets");
    let _ = over(&folder, &["sinumerik-traori", "sinumerik-enc"], &["--installed", &installed])
        .refused("E0711")
        .says("are of `sinumerik-traori+sinumerik-cec`, not of `sinumerik-traori+sinumerik-enc`");
}

#[test]
fn tables_take_what_the_parameters_leave() {
    let folder = Folder::new();
    let path = machine(&folder);
    // In any order: parameters come first.
    let json = both(&folder, &["sinumerik-cec", "sinumerik-traori"]).json();
    let out = folder.path("out");
    assert_eq!(names(&out), ["abbe.lock.json", "restore", "sinumerik-cec", "sinumerik-traori"]);
    let sample = sample(&path);
    let sent = sent(&out, &sample);
    let remaining: Vec<f64> = left::poses(&sample, 8, 2000)
        .iter()
        .map(|pose| 1e3 * norm(left::position(&sample, pose, &sent(pose), Travel::Mean)))
        .collect();
    let (low, high) = p95_bracket(&remaining, POSES);
    let by_rotary_axes = number(&json["programming"][0], "/compensated/position_um/p95");
    assert!(low <= by_rotary_axes && by_rotary_axes <= high, "{low} {by_rotary_axes} {high}");

    let steps = json["steps"].as_array().unwrap();
    let p95 = |step: usize| number(&steps[step], "/compensated/position_um/p95");
    assert_eq!(steps[0]["target"], "sinumerik-traori");
    assert_eq!(steps[1]["target"], json["target"]);
    assert!(p95(1) < 0.2 * p95(0) && p95(0) < 0.8 * number(&json, "/uncompensated/position_um/p95"), "{steps:?}");
    assert!(
        ["EX0C", "EA0C", "EXX", "EC0Y"].into_iter().all(|name| json["errors"][name]["handled"] == "fully"),
        "{json}"
    );
    let again = verify(&path, &out, &["--poses", &POSES.to_string()]).json();
    for key in ["compensated", "steps", "programming", "errors", "files", "target"] {
        assert_eq!(again[key], json[key], "{key}");
    }
    let diff = Run::of(abbe().args(["diff", "--format", "json", "--poses", "20"]).arg(&path).args([&out, &out]));
    assert_eq!(number(&diff.json(), "/position_um/max"), 0.0);
    refusals(&folder, &path);
}

/// Nothing is corrected twice in silence.
fn refusals(folder: &Folder, path: &Path) {
    let out = folder.path("out");
    let tables = out.join("sinumerik-cec");
    let _ =
        verify(path, &tables, &["--poses", "5"]).refused("E0711").says("what kinematic parameters beside them leave");
    // The same again replaces the set.
    assert_eq!(both(folder, &["sinumerik-traori", "sinumerik-cec"]).code, Some(0));
    let single = |folder: &Path| {
        let mut command = abbe();
        command.args(["compile", "--format", "json", "--target", "sinumerik-cec", "--poses", "5"]);
        Run::of(command.arg(path).arg("--out").arg(folder))
    };
    let _ = single(&out).refused("E0706").says("in subfolders");
    let file = tables.join("_N_NC_CEC_INI");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, format!("; edited\n{text}")).unwrap();
    let _ = verify(path, &out, &["--poses", "5"]).says("W0701");
    std::fs::write(&file, text).unwrap();
    let one = single(&tables);
    assert_eq!(one.code, Some(0), "{}", one.err);
    let _ = verify(path, &out, &["--poses", "5"]).refused("E0711").says("corrected twice");
    for two in [
        ["sinumerik-cec", "sinumerik-enc"],
        ["sinumerik-traori", "fanuc-5axis"],
        ["sinumerik-traori", "sinumerik-traori"],
    ] {
        let _ = both(folder, &two).refused("E0711").says("would correct the same errors twice");
    }
    let _ = both(folder, &["sinumerik-traori", "linuxcnc-kins"]).refused("E0711").says("compiled alone");
}

/// Tables that name the lines of the rotary axes, round after round: each set is read, alone and under the next one.
#[test]
fn rounds_of_parameters_and_error_curves_follow_one_another() {
    let (folder, machine) = (Folder::new(), crate::support::config("trunnion.yaml"));
    let more = ["--accept-unverified", "--poses", "20"];
    let mut installed: Vec<String> = Vec::new();
    for round in 0..3 {
        let out = folder.path(&format!("set-{round}"));
        let over = installed.last().map(|old| ["--installed", old.as_str()]);
        let options = [&more[..], over.as_ref().map_or(&[][..], |over| &over[..])].concat();
        compile(&machine, "sinumerik-chain+isg-volcomp", &out, &options).json();
        verify(&machine, &out, &options[1..]).json();
        installed.push(out.to_str().unwrap().to_owned());
    }
    let diff = Run::of(abbe().args(["diff", "--poses", "20"]).arg(&machine).args(&installed[1..]));
    assert_eq!(diff.code, Some(0), "{}", diff.err);
}
