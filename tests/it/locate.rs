//! Location errors from what a control's own calibration found: parameters made from known errors say these errors,
//! lines in tables say what ISO 230-1 defines.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use crate::kinematic_parameters::{OF_HEADS, OF_TABLES, compiled, head_head, head_table, table_table, with_spindle};
use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile};

fn locate(machine: &Path, found: &Path, more: &[&str]) -> Run {
    Run::of(abbe().args(["locate", "--format", "json"]).arg(machine).arg(found).args(more))
}

/// A figure of every error by name.
fn figures(json: &Value, figure: &str) -> BTreeMap<String, f64> {
    let errors = json["errors"].as_array().unwrap().iter();
    errors.map(|error| (error["name"].as_str().unwrap().to_owned(), error[figure].as_f64().unwrap())).collect()
}

/// Errors as a machine file states them: um and urad by name.
fn stated(lines: &str) -> BTreeMap<String, f64> {
    let line = |line: &str| {
        let (name, value) = line.trim().split_once(": ")?;
        Some((name.to_owned(), value.split(' ').next()?.parse().ok()?))
    };
    lines.lines().filter_map(line).collect()
}

fn near(found: &BTreeMap<String, f64>, expected: &BTreeMap<String, f64>, within: f64) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, value) in expected {
        assert!((found[name] - value).abs() <= within, "{name}: {} for {value}", found[name]);
    }
}

#[test]
fn parameters_say_the_errors_from_which_they_were_made() {
    for (text, errors) in
        [(table_table as fn(&str) -> String, with_spindle(OF_TABLES)), (head_table, with_spindle(OF_HEADS))]
    {
        let folder = Folder::new();
        let (machine, out, _) = compiled(&folder, &text(&errors), "sinumerik-traori");
        let json = locate(&machine, &out, &[]).json();
        // Offsets have steps of 1 nm, two of them in a point; vectors of 1e-9.
        near(&figures(&json, "found"), &stated(&errors), 0.002);
        near(&figures(&json, "in_file"), &stated(&errors), 1e-12);
        assert!(json["target"] == "sinumerik-traori" && json["errors"][0]["agrees"].is_null(), "{json}");
    }
}

/// About (0, 1, 1) a point or a vector has three components, two of them across the axis: the errors that are found
/// place the axis where the written ones did.
#[test]
fn an_inclined_axis_lies_where_it_lay() {
    let folder = Folder::new();
    let (machine, out, _) = compiled(&folder, &head_head(&with_spindle(OF_HEADS)), "sinumerik-traori");
    let fitted = folder.path("located.yaml");
    let _ = locate(&machine, &out, &["--out", fitted.to_str().unwrap()]).json();
    let json = compile(&fitted, "sinumerik-traori", &folder.path("again"), &["--accept-unverified", "--poses", "5"]);
    let _ = json.json();
    let [first, second] =
        [&out, &folder.path("again")].map(|out| std::fs::read_to_string(out.join("TRAORI.INI")).unwrap());
    let numbers = |text: &str| -> Vec<f64> {
        let value = |line: &str| line.split(';').next()?.split_once('=')?.1.trim().parse().ok();
        text.lines().filter_map(value).collect()
    };
    let (first, second) = (numbers(&first), numbers(&second));
    assert!(first.len() > 12 && first.len() == second.len());
    assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() <= 2.1e-6), "{first:?} {second:?}");
}

#[test]
fn a_control_without_directions_tells_no_tilts() {
    let folder = Folder::new();
    let (machine, out, _) = compiled(&folder, &table_table(OF_TABLES), "fanuc-5axis");
    let found = figures(&locate(&machine, &out, &[]).json(), "found");
    let expected = [("EX0C", 26.0), ("EY0A", -8.0), ("EY0C", -9.0), ("EZ0A", 17.0)];
    near(&found, &expected.map(|(name, value)| (name.to_owned(), value)).into(), 1.01);
}

/// The numbers before a calibration are those from which its change counts.
#[test]
fn changes_count_from_the_numbers_before() {
    let folder = Folder::new();
    let (_, first, _) = compiled(&folder, &table_table("  EX0C: 20 um\n  EA0C: 30 urad\n"), "sinumerik-traori");
    let change = folder.write("change.yaml", &table_table("  EX0C: 7 um\n  EA0C: -10 urad\n"));
    let (second, before) = (folder.path("second"), ["--installed", first.to_str().unwrap()]);
    let more = [&["--accept-unverified", "--poses", "5"], &before[..]].concat();
    let _ = compile(&change, "sinumerik-traori", &second, &more).json();
    let nominal = folder.write("nominal.yaml", &table_table("  EX0C: 0 um\n"));
    for (more, [x, a]) in [(&before[..], [7.0, -10.0]), (&[], [27.0, 20.0])] {
        let found = figures(&locate(&nominal, &second, more).json(), "found");
        let off = [found["EX0C"] - x, found["EA0C"] - a];
        assert!(off.iter().all(|off| off.abs() < 0.005), "{found:?}");
        assert!(found.iter().all(|(name, x)| ["EX0C", "EA0C"].contains(&name.as_str()) || x.abs() < 0.005));
    }
}

/// C through (250, 225): a line that leans towards X turns about Y by +B, one that leans towards Y about X by -A.
const LINES: &str = "axis; x [mm]; y [mm]; z [mm]; i; j; k; u [um]; u angle [urad]; remark\n\
                     C; 250,026; 224,991; ; -0,000044; -0,000062; -1; 4; 10; second run\n\
                     A; ; 224,992; -349,983; 1; -0,00004; -0,000054; 3; 8;\n";

#[test]
fn lines_by_hand() {
    let folder = Folder::new();
    let machine =
        folder.write("machine.yaml", &table_table("  EX0C: { value: 22 um, uncertainty: 3 um }\n  EB0C: 9 urad\n"));
    let found = folder.write("lines.csv", LINES);
    let (out, run) = (folder.path("located.yaml"), |more: &[&str]| locate(&machine, &found, more));
    let first = run(&["--out", out.to_str().unwrap()]);
    let json = first.says("`remark`").json();
    near(&figures(&json, "found"), &stated(OF_TABLES), 1e-3);
    let error =
        |name: &str| json["errors"].as_array().unwrap().iter().find(|error| error["name"] == name).unwrap().clone();
    // 4 um of difference, 5 um by both uncertainties; 35 urad, 10 urad.
    let (shift, tilt) = (error("EX0C"), error("EB0C"));
    assert!((shift["uncertainty"].as_f64().unwrap() - 4.0).abs() < 1e-9 && shift["agrees"] == true, "{shift}");
    assert!((tilt["difference"].as_f64().unwrap() - 35.0).abs() < 1e-3 && tilt["agrees"] == false, "{tilt}");
    // The file written holds them with their uncertainties: nothing differs any more.
    let again = locate(&out, &found, &[]).json();
    assert!(figures(&again, "difference").values().all(|off| off.abs() < 1e-6), "{again}");
    let u = again["errors"].as_array().unwrap().iter().find(|e| e["name"] == "EZ0A").unwrap()["in_file_uncertainty"]
        .clone();
    assert!((u.as_f64().unwrap() - 3.0).abs() < 1e-9, "{u}");
}

/// Largest difference of three numbers from others.
fn triple(found: &Value, wanted: [f64; 3]) -> f64 {
    (0..3).map(|k| (found[k].as_f64().unwrap() - wanted[k]).abs()).fold(0.0, f64::max)
}

/// The lines of the machine file are those by hand, in the table that is read: a nominal machine finds the errors in it.
#[test]
fn lines_that_a_calibration_should_find() {
    let folder = Folder::new();
    let errors = OF_TABLES
        .replace("EX0C: 26 um", "EX0C: { value: 26 um, uncertainty: 4 um }")
        .replace("EY0C: -9 um", "EY0C: { value: -9 um, uncertainty: 3 um }")
        .replace("EA0C: -62 urad", "EA0C: { value: -62 urad, uncertainty: 10 urad }");
    let machine = folder.write("machine.yaml", &table_table(&errors));
    let run = |more: &[&str]| Run::of(abbe().args(["locate", "--quiet"]).args(more).arg(&machine));
    let json = run(&["--format", "json"]).json();
    assert!(json["errors"] == serde_json::json!([]) && json["target"].is_null(), "{json}");
    let axes = json["lines"].as_array().unwrap();
    for (axis, name, point, direction, u) in [
        (&axes[0], "C", [250.026, 224.991, -380.0], [44e-6, 62e-6, 1.0], [Some(4.0), Some(10.0)]),
        (&axes[1], "A", [250.0, 224.992, -349.983], [1.0, -40e-6, -54e-6], [None, None]),
    ] {
        assert!(axis["axis"] == name && axis["found"].is_null(), "{axis}");
        // The foot of the perpendicular: a shift of 26 um on a lean of 76 urad. Directions to second order.
        for (key, wanted, within) in [("point_mm", point, 2e-6), ("direction", direction, 5e-9)] {
            assert!(triple(&axis["in_file"][key], wanted) < within, "{axis}");
        }
        let stated = ["uncertainty_um", "uncertainty_urad"].map(|key| axis[key].as_f64());
        let same = stated.iter().zip(u).all(|(a, b)| a.zip(b).map_or(*a == b, |(a, b)| (a - b).abs() < 1e-9));
        assert!(same, "{axis}");
    }
    let table = folder.write("lines.csv", &run(&["--format", "csv"]).out);
    let nominal = folder.write("nominal.yaml", &table_table("  EX0C: 0 um\n"));
    let found = locate(&nominal, &table, &[]).json();
    near(&figures(&found, "found"), &stated(OF_TABLES), 1e-5);
    for (key, within) in [("point_mm", 1e-9), ("direction", 1e-12)] {
        let written = [0, 1, 2].map(|k| json["lines"][0]["in_file"][key][k].as_f64().unwrap());
        assert!(triple(&found["lines"][0]["found"][key], written) < within, "{found}");
    }
    assert!(run(&[]).out.contains("coordinates of `origin`"));
    let out = folder.path("out.yaml").display().to_string();
    assert_eq!(run(&["--out", &out]).code, Some(2));
    assert_eq!(run(&["--installed", &out]).code, Some(2));
}

/// What CYCLE996 leaves in a swivel data record, before and after.
#[test]
fn a_swivel_data_record_tells_what_the_cycle_found() {
    let folder = Folder::new();
    let record = |name: &str, a: [f64; 3], c: [f64; 3], v: &str| {
        let out = folder.path(name);
        std::fs::create_dir_all(&out).unwrap();
        let back: Vec<f64> = (0..3).map(|k| -a[k] - c[k]).collect();
        let mut lines = vec!["$TC_CARR23[1]=\"P\"".to_owned(), "$TC_CARR21[1]=A".to_owned()];
        for (first, vector) in [(4, &a[..]), (15, &c[..]), (18, &back[..])] {
            lines.extend(vector.iter().enumerate().map(|(k, x)| format!("$TC_CARR{}[1]={x:.4}", first + k)));
        }
        lines.push(v.to_owned());
        std::fs::write(out.join("TCARR.MPF"), lines.join("\n") + "\nM17\n").unwrap();
        out
    };
    // V1 and V2 of a table are reversed: C leans by +20 urad to +X, so EB0C = 20 urad and V2 has -20e-6.
    let v = |lean: &str| {
        format!(
            "$TC_CARR7[1]=-1\n$TC_CARR8[1]=0\n$TC_CARR9[1]=0\n$TC_CARR10[1]={lean}\n$TC_CARR11[1]=0\n$TC_CARR12[1]=-1"
        )
    };
    let before = record("before", [240.1, 205.2, -380.3], [0.0, 0.0, -30.0], &v("0"));
    let after = record("after", [240.1, 205.205, -380.3], [0.012, -0.005, -30.0], &v("-0.00002"));
    let machine = folder.write("machine.yaml", &table_table("  EX0C: 0 um\n"));
    let json = locate(&machine, &after, &["--installed", before.to_str().unwrap()]).json();
    let found = figures(&json, "found");
    let wanted = [("EX0C", 12.0), ("EY0C", 0.0), ("EA0C", 0.0), ("EB0C", 20.0)];
    let of_a = [("EY0A", 5.0), ("EZ0A", 0.0), ("EB0A", 0.0), ("EC0A", 0.0)];
    let all: BTreeMap<String, f64> = wanted.into_iter().chain(of_a).map(|(name, x)| (name.to_owned(), x)).collect();
    near(&found, &all, 1e-3);
    assert_eq!(json["target"], "sinumerik-tcarr");
}

#[test]
fn shifts_count_from_the_nominal_axis() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", &table_table("  EX0C: 0 um\n"));
    let found = folder.write("lines.csv", "axis,dx [um],dy [mm]\nC,12.5,-0.004\n");
    let found = figures(&locate(&machine, &found, &[]).json(), "found");
    near(&found, &[("EX0C".to_owned(), 12.5), ("EY0C".to_owned(), -4.0)].into(), 1e-6);
}

#[test]
fn tables_that_say_nothing_are_refused() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", &table_table("  EX0C: 0 um\n"));
    for (text, says) in [
        ("", "empty"),
        ("axis,x [mm]\n", "no axis below"),
        ("x [mm]\n3\n", "no column `axis`"),
        ("axis,x\nC,250\n", "has no unit"),
        ("axis,x [urad]\nC,250\n", "no unit for the column"),
        ("axis,i [mm],j,k\nC,0,0,1\n", "a direction has no unit"),
        ("axis,x [mm],x [um]\nC,250,1\n", "twice"),
        ("axis,x [mm],dx [um]\nC,250,1\n", "one too many"),
        ("axis,x [mm]\nX,250\n", "no rotary axis `X`"),
        ("axis,x [mm]\nC,250\nC,250\n", "axis `C` is there twice"),
        ("axis,x [mm]\nC,\n", "nothing is stated"),
        ("axis,x [mm]\nC,250,9\n", "3 cells under 2"),
        ("axis,x [mm]\nC,1e9\n", "beyond 1000000"),
        ("axis,x [mm]\nC,nan\n", "nan"),
        ("axis,z [mm]\nC,-300\n", "no coordinate across"),
        ("axis,i,j,k\nC,0,0,0\n", "no length"),
        ("axis,i,j\nC,0,0\n", "needs i, j and k"),
        ("axis,x [mm],u [um]\nC,250,-1\n", "below 0"),
        ("axis,x [um]\nC,250\n", "mm from the nominal axis"),
        ("axis,i,j,k\nC,1,0,0\n", "more than 5 deg off"),
    ] {
        let found = folder.write("lines.csv", text);
        locate(&machine, &found, &[]).refused("E0519").says(says);
    }
    let found = folder.write("lines.csv", "axis,x [mm]\nC,250\n");
    let tables = folder.path("tables");
    let _ = compile(&machine, "grid-csv", &tables, &["--poses", "5"]);
    assert_eq!(locate(&machine, &tables, &[]).code, Some(2));
    let three = crate::support::config("vmc-cframe-754.yaml");
    locate(&three, &found, &[]).refused("E0751");
}

#[test]
fn the_table_is_no_output() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", &table_table("  EX0C: 0 um\n"));
    let found = folder.write("lines.csv", LINES);
    for input in [&machine, &found] {
        let before = std::fs::read(input).unwrap();
        locate(&machine, &found, &["--out", input.to_str().unwrap()]).refused("E0630");
        assert_eq!(std::fs::read(input).unwrap(), before);
    }
}
