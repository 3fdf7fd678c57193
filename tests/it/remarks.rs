//! Remarks of `identify` beside its numbers, and the origin of these in the fitted file.

use super::identify::{FIVE, deviation, five, five_poses, json, normal, run};
use super::measurements::identified;
use super::oracle::program::Folder;
use super::oracle::random::Random;

/// Warnings of a fit, by code.
fn codes(data: &str, fit: &str) -> Vec<String> {
    let report = json(&identified(data.as_bytes(), &["--fit", fit, "--format", "json"]).0);
    let warnings = report["warnings"].as_array().cloned().unwrap_or_default();
    warnings.iter().map(|w| w["code"].as_str().unwrap().to_owned()).collect()
}

/// A file of deviations of a machine, each reading turned into a cell by `shown` from micrometres with noise.
fn file(columns: &str, count: usize, mut shown: impl FnMut(usize, f64) -> f64) -> String {
    let truth = five("errors: { EC0Y: 12 urad, EX0C: 6 um }\n");
    let mut random = Random::new(701);
    let mut text = format!("C,A,Y,X,Z,{columns}\n");
    for (i, pose) in five_poses(&mut random, count).iter().enumerate() {
        let d = deviation(&truth, pose).map(|d| shown(i, d * 1e3 + normal(&mut random)));
        let cells: Vec<String> = pose.iter().chain(&d).map(f64::to_string).collect();
        text += &format!("{}\n", cells.join(","));
    }
    text
}

const UM: &str = "dx [um],dy [um],dz [um]";

#[test]
fn data_without_fault_are_not_warned_of() {
    assert_eq!(codes(&file(UM, 40, |_, d| d), "EC0Y,EX0C"), [""; 0]);
}

#[test]
fn sizes_that_no_machine_has_are_warned_of() {
    assert_eq!(codes(&file("dx [mm],dy [mm],dz [mm]", 40, |_, d| d), "EC0Y,EX0C"), ["W0505"]);
    assert_eq!(codes(&file(UM, 40, |_, d| d * 1e-3), "EC0Y,EX0C"), ["W0505"]);
}

#[test]
fn readings_of_what_is_not_fitted_are_left_out() {
    let rows = "0,1,70\n100,2,-50\n200,3,60\n300,4.5,-90\n";
    let with = format!("X,EXX [um],EYX [um]\n{rows}");
    assert_eq!(codes(&with, "EXX:poly1"), ["W0504"]);
    let report = json(&identified(with.as_bytes(), &["--fit", "EXX:poly1", "--format", "json"]).0);
    assert_eq!(report["rows"], 4);
    assert!(report["sigma_um"].as_f64().unwrap() < 0.3, "{report}");
    let (output, _) = identified(with.as_bytes(), &["--fit", "EBX:poly1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("0 readings"), "{said}");
}

#[test]
fn a_direction_without_readings_is_named() {
    let data = "X,EXX+ [um]\n0,1\n100,2\n200,3\n300,4.5\n400,5\n500,6\n";
    let (output, _) = identified(data.as_bytes(), &["--fit", "EXX+-:poly1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("nothing was read in the direction of approach of EXX-: kept as the file says"), "{said}");
    assert_eq!(codes(data, "EXX+:poly1"), [""; 0]);
    // Reverse readings of another axis do not count.
    let both = "X,EXX+ [um],EXX- [um]\n0,1,2\n100,2,3\n200,3,4\n";
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let files = [folder.write("x.csv", both), folder.write("y.csv", "Y,EYY+ [um]\n0,1\n100,2\n200,4\n300,5\n")];
    let [x, y] = files.each_ref().map(|path| path.to_str().unwrap());
    let output = run(&["identify", machine.to_str().unwrap(), "--data", x, y, "--fit", "EXX+-:poly1,EYY+-:poly1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("of EYY-:") && !said.contains("EXX-"), "{said}");
    let output = run(&["identify", machine.to_str().unwrap(), "--data", x, x, "--fit", "EXX+-:poly1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("would count twice"), "{said}");
    let output = run(&["identify", machine.to_str().unwrap(), "--data", "no-a.csv", "no-b.csv", "--fit", "EXX:poly1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("no-a.csv") && said.contains("no-b.csv") && !said.contains("twice"), "{said}");
}

#[test]
fn poses_whose_readings_contradict_each_other_are_named() {
    let good = file(UM, 40, |_, d| d);
    let rows: Vec<&str> = good.lines().collect();
    // Four poses again with next to the same readings, and one with another sign.
    let again = |text: &str, by: f64, sign: f64| {
        let cells: Vec<f64> = text.split(',').map(|cell| cell.parse().unwrap()).collect();
        let one = |(i, x): (usize, &f64)| if i < 5 { *x } else { sign * (x + by) };
        cells.iter().enumerate().map(one).map(|x| x.to_string()).collect::<Vec<_>>().join(",")
    };
    let repeated: Vec<String> = (1..5).map(|i| again(rows[i], 1.5, 1.0)).collect();
    let steady = format!("{good}{}\n", repeated.join("\n"));
    assert_eq!(codes(&steady, "EC0Y,EX0C"), [""; 0]);
    let (output, _) =
        identified(format!("{steady}{}\n", again(rows[9], 0.0, -20.0)).as_bytes(), &["--fit", "EC0Y,EX0C"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("W0507") && said.contains("data.csv:10 and ") && said.contains("data.csv:46"), "{said}");
    // Everything twice with opposite signs: nothing remains to fit.
    let opposed: Vec<String> = rows[1..].iter().map(|row| again(row, 0.0, -1.0)).collect();
    let both = format!("{good}{}\n", opposed.join("\n"));
    let (output, _) = identified(both.as_bytes(), &["--fit", "EC0Y,EX0C"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("W0507") && said.contains("opposite sign"), "{said}");
    // Noise about a machine without errors contradicts nothing.
    let mut random = Random::new(702);
    let rows = (0..90).map(|i| format!("{},{},{}\n", (i % 30) * 10, normal(&mut random), normal(&mut random)));
    let quiet = format!("X,dx [um],dy [um]\n{}", rows.collect::<String>());
    assert_eq!(codes(&quiet, "EXX:poly1,EYX:poly1"), [""; 0]);
}

#[test]
fn quantities_that_repeat_unlike_are_compared_each_with_its_own() {
    let mut random = Random::new(703);
    let mut rows = |size: f64, columns: &str| {
        let mut text = format!("X,{columns}\n");
        for i in 0..40 {
            text += &format!("{},{}\n", (i % 20) * 25, 5.0 + size * normal(&mut random));
        }
        text
    };
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let files = [folder.write("a.csv", &rows(3.0, "dx [um]")), folder.write("b.csv", &rows(0.3, "rel.dx [um]"))];
    let [a, b] = files.each_ref().map(|path| path.to_str().unwrap());
    let fit = "EXX:poly2";
    let report = json(&run(&["identify", machine.to_str().unwrap(), "--data", a, b, "--fit", fit, "--format", "json"]));
    assert!(report["warnings"].as_array().is_none_or(Vec::is_empty), "{report}");
    let repeated: Vec<f64> =
        report["repeats"].as_array().unwrap().iter().map(|r| r["sigma_um"].as_f64().unwrap()).collect();
    assert!((2.0..4.0).contains(&repeated[0]) && (0.2..0.4).contains(&repeated[1]), "{repeated:?}");
}

#[test]
fn combinations_that_cannot_be_separated_are_no_silence() {
    let data = file(UM, 40, |_, d| d);
    assert_eq!(codes(&data, "location,tool,workpiece"), [""; 0]);
}

#[test]
fn a_fit_that_hears_nothing_says_so() {
    let still = "Z,dx [um],dy [um],dz [um]\n0,1,2,3\n-10,1,2,2\n-20,1,3,3\n-30,2,2,3\n";
    let (output, _) =
        identified(still.as_bytes(), &["--fit", "ECC:fourier1,EAC:fourier1", "--fixed", "ECC:cos0,EAC:cos0,EAC:cos1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("W0508"), "{said}\n{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn what_the_section_says_for_nothing_is_named_and_what_it_says_twice_refused() {
    let data = "X,EXX [um]\n0,1\n100,2\n200,3\n300,4.5\n400,5\n500,6\n";
    let said = |section: &str, options: &[&str]| {
        let folder = Folder::new();
        let machine = folder.write("machine.yaml", &format!("{FIVE}identify: {{ {section} }}\n"));
        let file = folder.write("data.csv", data);
        let mut arguments = vec!["identify", machine.to_str().unwrap(), "--data", file.to_str().unwrap()];
        arguments.extend(options);
        let output = run(&arguments);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, words) = said("fit: [EXX:poly1], basis: { EYX: poly2 }, parameters: { f1: { EBX: [0, 1] } }", &[]);
    assert!(code == Some(0) && words.contains("basis of EYX, parameter f1"), "{words}");
    let (code, words) = said("fit: [EXX:poly1], knots: { EXX: [0 mm, 100 mm] }", &[]);
    assert!(code == Some(0) && words.contains("knots of EXX"), "{words}");
    let (code, words) = said("fit: [EXX:poly1], basis: { EXX: poly2 }", &[]);
    assert!(code == Some(1) && words.contains("`EXX` is fitted as `poly1`, and its basis is `poly2`"), "{words}");
    // The command line goes before the section.
    let (code, words) = said("fit: [EXX], basis: { EXX: poly2 }", &["--fit", "EXX:poly1"]);
    assert!(code == Some(0) && words.is_empty(), "{words}");
    let (code, words) = said(
        "fit: [EYX:poly1, EXX:poly1], slopes: { EYX: 1 um/m }, tied: { EZX: { EYX: 1 } }",
        &["--fit", "EXX:poly1"],
    );
    assert!(code == Some(0) && words.is_empty(), "{words}");
    let (code, words) = said("fit: [EXX:poly1], fixed: [\"EXX:x^0\", workpiece.X, tool.Z]", &[]);
    assert!(code == Some(0) && words.is_empty(), "{words}");
    let (code, words) = said("fit: [EXX:spline4], knots: { EXX: [0 mm, 100 mm] }", &[]);
    assert!(code == Some(1) && words.contains("has even knots, and `knots` are given"), "{words}");
    let (code, words) = said("fit: [EXX:poly21]", &[]);
    assert!(code == Some(1) && words.contains("at most 20"), "{words}");
}

#[test]
fn the_fitted_file_says_how_sure_it_is_where_it_comes_from_and_what_was_fitted() {
    let folder = Folder::new();
    let section =
        "identify: { fit: [EC0Y, EXX:spline], knots: { EXX: [0 mm, 100 mm, 300 mm] }, slopes: { EXX: 20 um/m } }\n";
    let machine = folder.write("machine.yaml", &format!("{FIVE}{section}"));
    let data = folder.write("data.csv", &file(UM, 40, |_, d| d));
    let fit = |machine: &std::path::Path, out: &str| {
        let out = folder.path(out);
        let arguments = [machine, data.as_path(), out.as_path()].map(|p| p.to_str().unwrap());
        let [machine, data, out] = arguments;
        let report = json(&run(&["identify", machine, "--data", data, "--out", out, "--format", "json"]));
        (report, std::fs::read_to_string(out).unwrap())
    };
    let (report, text) = fit(&machine, "once.yaml");
    // Twice the standard uncertainty of a constant, to three digits.
    let sigma = report["parameters"][0]["sigma"].as_f64().unwrap();
    let line = text.lines().find(|line| line.trim().starts_with("EC0Y:")).unwrap();
    let half: f64 = line.split("uncertainty: ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((half / (2.0 * sigma) - 1.0).abs() < 0.005, "{line} {sigma}");
    assert!(text.lines().any(|line| line.contains("EXX:") && line.contains("uncertainty: ")), "{text}");
    let hash = |path: &std::path::Path| {
        use sha2::Digest;
        let digest = sha2::Sha256::digest(std::fs::read(path).unwrap());
        digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>()[..16].to_owned()
    };
    for wanted in [
        format!("data.csv (sha256 {}...)", hash(&data)),
        format!("machine.yaml (sha256 {}...)", hash(&machine)),
        "least squares on the exact model, readings in the workpiece frame; fit EC0Y, EXX:spline".to_owned(),
    ] {
        assert!(text.contains(&wanted), "{wanted}\n{text}");
    }
    // The section is kept: the file is fitted again as it is, and both fits are reported.
    let (_, again) = fit(&folder.path("once.yaml"), "twice.yaml");
    assert!(again.contains("\"identified-by\"") && again.contains("\"identified-from-2\""), "{again}");
    assert_eq!(again.lines().filter(|line| line.starts_with("identify:")).count(), 1);
}
