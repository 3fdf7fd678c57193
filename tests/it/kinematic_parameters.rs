//! Kinematic parameters: the written numbers, put into the transformations as the manuals state them, place tip and tool
//! axis where the oracle's machine has them; numbers by hand; displaced lines; refusals.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use abbe::controller::{ControllerTarget, KinematicsModule, ModuleField, ReadBack};
use abbe::diagnostic::Diagnostics;

use crate::loaded;
use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample};
use crate::oracle::matrix::{
    M4, ONE, V3, apply, cross, exp, inverse, minus, mul, norm, plus, translation, turn, twist,
};
use crate::oracle::program::Folder;
use crate::support::config::sample;
use crate::support::{PARAMETER_TARGETS, Run, abbe, compile, config, left, number, p95_bracket, set_files, verify};

const ACCEPT: [&str; 3] = ["--accept-unverified", "--poses", "300"];

/// Location errors of the spindle.
const OF_SPINDLE: &str = "  EA0S: 15 urad\n  EB0S: -31 urad\n";

/// A trunnion; the axes do not meet.
pub fn table_table(errors: &str) -> String {
    format!(
        "abbe: 1\nmachine: table-table\nchain: \"w C' A' Y' b X Z (S) t\"\naxes:\n  X: {{ controller: 1, travel: [0 mm, 500 mm] }}\n  \
         Y: {{ controller: 2, travel: [0 mm, 450 mm] }}\n  Z: {{ controller: 3, travel: [-400 mm, 0 mm] }}\n  \
         A: {{ controller: 4, travel: [-120 deg, 30 deg], origin: [250, 225, -350] }}\n  \
         C: {{ controller: 5, travel: continuous, origin: [250, 225, -380] }}\ntool: {{ gauge: [10, 20, 30], length: 120 mm }}\n\
         workpiece: {{ origin: [250, 225, -360] }}\nerrors:\n{errors}"
    )
}

/// Their location errors.
pub const OF_TABLES: &str = "  EY0A: -8 um\n  EZ0A: 17 um\n  EB0A: 54 urad\n  EC0A: -40 urad\n  EX0C: 26 um\n  EY0C: -9 um\n  \
                         EA0C: -62 urad\n  EB0C: 44 urad\n";

/// A fork head; B is inclined and does not meet C.
pub fn head_head(errors: &str) -> String {
    format!(
        "abbe: 1\nmachine: head-head\nchain: \"w Y' b X Z C B (S) t\"\naxes:\n  X: {{ controller: 1, travel: [0 mm, 900 mm] }}\n  \
         Y: {{ controller: 2, travel: [0 mm, 450 mm] }}\n  Z: {{ controller: 3, travel: [-400 mm, 0 mm] }}\n  \
         C: {{ controller: 5, travel: [-200 deg, 200 deg], origin: [5, 3, 0] }}\n  \
         B: {{ controller: 4, travel: [-100 deg, 100 deg], direction: [0, 1, 1], origin: [12, 0, 260] }}\n\
         tool: {{ gauge: [0, 0, 40], length: 150 mm }}\nworkpiece: {{ origin: [100, 50, -300] }}\nerrors:\n{errors}"
    )
}

pub const OF_HEADS: &str = "  EX0C: 26 um\n  EY0C: -9 um\n  EA0C: -62 urad\n  EB0C: 44 urad\n  EX0B: 13 um\n  EZ0B: -21 um\n  \
                        EA0B: 33 urad\n  EC0B: -47 urad\n";

/// The table turns right-handed.
pub fn head_table(errors: &str) -> String {
    format!(
        "abbe: 1\nmachine: head-table\nchain: \"w C' X' b Y Z B (S) t\"\naxes:\n  X: {{ controller: 1, travel: [0 mm, 500 mm] }}\n  \
         Y: {{ controller: 2, travel: [0 mm, 450 mm] }}\n  Z: {{ controller: 3, travel: [-400 mm, 0 mm] }}\n  \
         C: {{ controller: 5, travel: continuous, sense: direct, origin: [250, 225, -380] }}\n  \
         B: {{ controller: 4, travel: [-100 deg, 100 deg], origin: [1, 2, 220] }}\ntool: {{ gauge: [0, 0, 0], length: 90 mm }}\n\
         workpiece: {{ origin: [250, 225, -300] }}\nerrors:\n{errors}"
    )
}

pub fn with_spindle(of_axes: &str) -> String {
    format!("{of_axes}{OF_SPINDLE}")
}

/// `NAME = VALUE` in any of the formats, by name; a remark is cut off.
pub fn numbers(file: &Path) -> BTreeMap<String, f64> {
    numbers_of(&std::fs::read_to_string(file).unwrap())
}

/// The numbers of a file without the kind of a swivel data record.
fn numbers_of(text: &str) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    let text: String =
        text.lines().filter(|line| !line.contains("CARR23")).map(|line| line.to_owned() + "\n").collect();
    for line in text.lines().map(|line| line.split([';', '#']).next().unwrap().trim()).filter(|line| !line.is_empty()) {
        let parts = line.split_once('=').or_else(|| line.split_once("Q1M")).or_else(|| line.rsplit_once(' '));
        let Some((name, value)) = parts else { continue };
        let name = name.trim().trim_start_matches("$MC_TRAFO5_").trim_start_matches("SETTING ");
        let value: f64 = value.trim().parse().unwrap();
        assert!(found.insert(name.trim_start_matches('N').to_owned(), value).is_none(), "{name} twice");
    }
    found
}

/// Three numbers of a vector.
fn vector(numbers: &BTreeMap<String, f64>, name: impl Fn(usize) -> String) -> V3 {
    [0, 1, 2].map(|k| numbers[&name(k)])
}

/// A rotary axis of a controller: its name, the vector about which a positive command turns the tool right-handed
/// against the workpiece, and a point of its line from the gauge point.
pub struct Line {
    pub axis: &'static str,
    pub direction: V3,
    pub point: V3,
}

/// A five-axis transformation as the manuals have it: lines of the table from the workpiece, lines of the head from
/// the ram, and the tool along its vector.
pub struct Control {
    pub table: Vec<Line>,
    pub head: Vec<Line>,
    pub tool: V3,
}

fn negative(v: V3) -> V3 {
    v.map(|c| -c)
}

impl Control {
    /// TRAORI by the hypothesis of the manifest: offsets chain from the adapter over both axes back to it, vectors are
    /// those about which the moved body turns.
    pub fn traori(kind: &str, numbers: &BTreeMap<String, f64>) -> Self {
        let of = |name: &str| vector(numbers, |k| format!("{name}_1[{k}]"));
        let (base, joint, part) = (of("BASE_TOOL"), of("JOINT_OFFSET"), of("PART_OFFSET"));
        let (first, second) = (of("AXIS1"), of("AXIS2"));
        let (table, head) = match kind {
            "table-table" => {
                assert!(norm(plus(plus(base, joint), part)) < 1e-9, "the chain is open");
                let carries = Line { axis: "C", direction: negative(second), point: plus(base, joint) };
                (vec![carries, Line { axis: "A", direction: negative(first), point: base }], vec![])
            }
            "head-head" => {
                assert!(norm(plus(plus(base, joint), part)) < 1e-9, "the chain is open");
                let ram = Line { axis: "C", direction: first, point: plus(base, joint) };
                (vec![], vec![ram, Line { axis: "B", direction: second, point: base }])
            }
            _ => {
                let of_part = of("JOINT_OFFSET_PART");
                assert!(norm(plus(base, joint)) < 1e-9 && norm(plus(of_part, part)) < 1e-9, "a chain is open");
                let table = Line { axis: "C", direction: negative(second), point: of_part };
                (vec![table], vec![Line { axis: "B", direction: first, point: base }])
            }
        };
        Self { table, head, tool: of("BASE_ORIENT") }
    }

    fn turned(line: &Line, sample: &Sample, pose: &Pose) -> M4 {
        let at = sample.rigid.walk.iter().position(|axis| axis.name == line.axis).unwrap();
        let u = line.direction.map(|c| c / norm(line.direction));
        let v = cross(line.point, u);
        exp(&twist([v[0], v[1], v[2], u[0], u[1], u[2]].map(|c| c * pose[at].to_radians())))
    }

    fn side(lines: &[Line], sample: &Sample, pose: &Pose) -> M4 {
        lines.iter().fold(ONE, |walk, line| mul(&walk, &Self::turned(line, sample, pose)))
    }

    fn linear(sample: &Sample, pose: &Pose) -> V3 {
        ["X", "Y", "Z"].map(|name| pose[sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap()])
    }

    /// Tip (mm from the workpiece origin) and tool axis with the axes at a position.
    fn forward(&self, sample: &Sample, pose: &Pose) -> (V3, V3) {
        let tables = Self::side(&self.table, sample, pose);
        let moved = mul(&tables, &translation(Self::linear(sample, pose)));
        let walk = mul(&moved, &Self::side(&self.head, sample, pose));
        let tool = self.tool.map(|c| c / norm(self.tool));
        let tip = apply(&walk, tool.map(|c| c * sample.rigid.offset[2]));
        (minus(plus(tip, sample.rigid.gauge), sample.rigid.workpiece_origin), turn(&walk, tool))
    }

    /// A swivel data record, as the commissioning manual has its vectors: adapter or machine reference over the axes and
    /// back; the vector of an axis that moves the workpiece is reversed.
    fn swivel_data(kind: &str, numbers: &BTreeMap<String, f64>) -> Self {
        let of = |first: usize| vector(numbers, |k| format!("$TC_CARR{}[1]", first + k));
        let (second, third, first_axis, second_axis) = (of(4), of(15), of(7), of(10));
        let closed = |sum: V3| assert!(norm(sum) < 1e-9, "the chain is open");
        let (table, head) = match kind {
            "table-table" => {
                closed(plus(plus(second, third), of(18)));
                let carries = Line { axis: "C", direction: negative(second_axis), point: plus(second, third) };
                (vec![carries, Line { axis: "A", direction: negative(first_axis), point: second }], vec![])
            }
            "head-head" => {
                closed(plus(plus(third, second), of(1)));
                let ram = Line { axis: "C", direction: first_axis, point: plus(third, second) };
                (vec![], vec![ram, Line { axis: "B", direction: second_axis, point: third }])
            }
            _ => {
                closed(plus(of(1), second));
                closed(plus(third, of(18)));
                let table = Line { axis: "C", direction: negative(second_axis), point: third };
                (vec![table], vec![Line { axis: "B", direction: first_axis, point: second }])
            }
        };
        Self { table, head, tool: [0.0, 0.0, 1.0] }
    }

    /// The command for a tip with the rotary axes as they are in the pose.
    pub fn inverse(&self, sample: &Sample, pose: &Pose, tip: V3) -> Pose {
        let point = minus(plus(tip, sample.rigid.workpiece_origin), sample.rigid.gauge);
        let before = apply(&inverse(&Self::side(&self.table, sample, pose)), point);
        let tool = self.tool.map(|c| c / norm(self.tool) * sample.rigid.offset[2]);
        let at = minus(before, apply(&Self::side(&self.head, sample, pose), tool));
        let mut command = pose.clone();
        for (k, name) in ["X", "Y", "Z"].iter().enumerate() {
            command[sample.rigid.walk.iter().position(|axis| axis.name == *name).unwrap()] = at[k];
        }
        command
    }
}

/// Largest distances (mm, rad) of the control's tool from the real one over poses.
fn apart(control: &Control, sample: &Sample) -> (f64, f64) {
    left::poses(sample, 3, 200).iter().fold((0.0, 0.0), |(position, axis), pose| {
        let ([real, _], (tip, tool)) = (sample.holds(pose, Travel::Mean), control.forward(sample, pose));
        (position.max(norm(minus(real.tip, tip))), axis.max(norm(minus(real.axis(), tool))))
    })
}

/// The same with a tool 100 mm longer.
pub fn longer(sample: &Sample) -> Sample {
    let mut longer = sample.clone();
    longer.rigid.offset[2] -= 100.0;
    longer
}

pub fn compiled(folder: &Folder, text: &str, target: &str) -> (PathBuf, PathBuf, serde_json::Value) {
    let machine = folder.write("machine.yaml", text);
    let out = folder.path(target);
    let json = compile(&machine, target, &out, &[&ACCEPT[..], &["--replace"]].concat()).json();
    (machine, out, json)
}

#[test]
fn traori_knows_the_real_machine() {
    for (kind, text) in [
        ("table-table", table_table(&with_spindle(OF_TABLES))),
        ("head-head", head_head(&with_spindle(OF_HEADS))),
        ("head-table", head_table(&with_spindle(OF_HEADS))),
    ] {
        let folder = Folder::new();
        let (machine, out, json) = compiled(&folder, &text, "sinumerik-traori");
        let control = Control::traori(kind, &numbers(&out.join("TRAORI.INI")));
        let sample = sample(&machine);
        for sample in [&sample, &longer(&sample)] {
            let (position, axis) = apart(&control, sample);
            // Up to three offsets of six decimals, twice at half a turn; directions of nine decimals at a metre.
            assert!(position < 8e-6 && axis < 4e-9, "{kind}: {position:e} mm, {axis:e} rad");
        }
        let ways = json["programming"].as_array().unwrap();
        assert_eq!(ways.len(), 4);
        for way in ways {
            assert!(number(way, "/uncompensated/position_um/max") > 20.0, "{kind}: {way}");
            assert!(number(way, "/compensated/position_um/max") < 0.01, "{kind}: {way}");
            let (before, after) =
                (number(way, "/uncompensated/tool_axis_urad/p95"), number(way, "/compensated/tool_axis_urad/p95"));
            let with = if way["away_from_poles"].is_null() { "compensated" } else { "away_from_poles" };
            let most = number(way, &format!("/{with}/tool_axis_urad/max"));
            match way["tool_direction"].as_str() {
                Some("vector") => assert!(before > 30.0 && most < 0.01, "{kind}: {way}"),
                _ => assert!((before - after).abs() < 1e-6, "{kind}: {way}"),
            }
        }
        assert!(json["errors"].as_object().unwrap().values().all(|error| error["handled"] == "fully"), "{json}");
        let again = verify(&machine, &out, &["--poses", "300"]).json();
        assert_eq!(again["programming"], json["programming"]);
    }
}

/// A tilt t of the line of C about Y tilts the tool by t (1 - cos C) about Y of the table A, for which C has to turn by
/// t (1 - cos C) / tan(A). It stays where that is more than 5 deg.
#[test]
fn poles_are_counted_and_judged_apart() {
    let folder = Folder::new();
    let text = table_table("  EB0C: 1000 urad\n").replace("[-120 deg, 30 deg]", "[-10 deg, 10 deg]");
    let machine = folder.write("machine.yaml", &text);
    let out = folder.path("out");
    let json = compile(&machine, "sinumerik-chain", &out, &["--accept-unverified", "--poses", "2000"]).json();
    let zone = |c: f64| (1e-3 * (1.0 - c.to_radians().cos()) / 5_f64.to_radians().tan()).atan().to_degrees() / 10.0;
    let share = (0..360).map(|c| zone(f64::from(c))).sum::<f64>() / 360.0;
    for way in json["programming"].as_array().unwrap() {
        if way["tool_direction"] != "vector" {
            assert!(way["at_poles"] == 0 && way["away_from_poles"].is_null(), "{way}");
            continue;
        }
        // Four standard deviations of a random sample.
        let expected = 2000.0 * share;
        assert!((number(way, "/at_poles") - expected).abs() < 4.0 * (expected * (1.0 - share)).sqrt(), "{way}");
        assert!((1900.0..2001.0).contains(&number(way, "/compensated/tool_axis_urad/max")), "{way}");
        assert!(number(way, "/away_from_poles/tool_axis_urad/max") < 0.01, "{way}");
    }
    let shown = Run::of(abbe().arg("verify").arg(&machine).arg(&out).args(["--poses", "500"]));
    let said =
        ["|   away from poles | of the file ", " of 500 poses are at a pole: the tool stands along a rotary axis"];
    assert!(said.iter().all(|said| shown.out.contains(said)), "{}", shown.out);
    let close = table_table("  EB0C: 2 urad\n").replace("[-120 deg, 30 deg]", "[5 deg, 10 deg]");
    let (_, _, json) = compiled(&folder, &close, "sinumerik-chain");
    assert!(json["programming"].as_array().unwrap().iter().all(|way| way["at_poles"] == 0), "{json}");
}

/// The spindle is straight: a swivel data record has no direction of the tool.
#[test]
fn swivel_data_know_the_real_machine() {
    for (kind, letter, text) in [
        ("table-table", 'P', table_table(OF_TABLES)),
        ("head-head", 'T', head_head(OF_HEADS)),
        ("head-table", 'M', head_table(OF_HEADS)),
    ] {
        let folder = Folder::new();
        let machine = folder.write("machine.yaml", &text);
        let out = folder.path("out");
        // Documented and inferred: no word of the user's is asked for.
        let json = compile(&machine, "sinumerik-tcarr", &out, &["--poses", "300"]).json();
        let file = out.join("TCARR.MPF");
        let written = std::fs::read_to_string(&file).unwrap();
        let kind_of = format!("$TC_CARR23[1]=\"{letter}\"");
        assert!(written.contains(&kind_of), "{written}");
        let only_numbers: String =
            written.lines().filter(|line| !line.starts_with(&kind_of)).map(|line| format!("{line}\n")).collect();
        let control = Control::swivel_data(kind, &numbers(&folder.write("numbers", &only_numbers)));
        let sample = sample(&machine);
        for sample in [&sample, &longer(&sample)] {
            let (position, axis) = apart(&control, sample);
            // As of TRAORI.
            assert!(position < 8e-6 && axis < 4e-9, "{kind}: {position:e} mm, {axis:e} rad");
        }
        assert!(json["errors"].as_object().unwrap().values().all(|error| error["handled"] == "fully"), "{json}");
        // A record of the control's own has more lines; they place nothing, or they are 0.
        let more = "CHANDATA(1)\n$TC_CARR21[1]=A\n$TC_CARR24[1]=0\n$TC_CARR34[1]=\"TABLE\"\n$TC_CARR41[1]=0\n";
        std::fs::write(&file, format!("{more}{written}")).unwrap();
        assert_eq!(verify(&machine, &out, &["--poses", "300"]).json()["compensated"], json["compensated"]);
        for (line, says) in [
            ("$TC_CARR24[1]=5\n", "only `$TC_CARR24[1]=0` is read here"),
            ("$TC_CARR41[1]=0.01\n", "only `$TC_CARR41[1]=0` is read here"),
            ("$TC_CARR23[1]=\"X\"\n", "this machine has"),
            ("$TC_CARR4[2]=0\n", "no parameter of this machine"),
        ] {
            std::fs::write(&file, format!("{line}{written}")).unwrap();
            let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704").says(says);
        }
        std::fs::write(&file, written.replace(&kind_of, "")).unwrap();
        let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704").says("is missing");
    }
}

/// Parameters hold for every tool of the file that stands in the spindle as the one in use does.
#[test]
fn every_tool_of_the_file_is_certified() {
    let folder = Folder::new();
    let tools = "tools:\n  short: { gauge: [10, 20, 30], length: 120 mm }\n  long: { gauge: [10, 20, 30], length: 310 mm }\n  \
                 elsewhere: { gauge: [10, 20, 70], length: 90 mm }\n";
    let single = table_table(&with_spindle(OF_TABLES));
    let text = single.replace("tool: { gauge: [10, 20, 30], length: 120 mm }\n", tools);
    assert_ne!(text, single);
    let (machine, out, json) = compiled(&folder, &text, "fanuc-5axis");
    let ways: Vec<(&str, f64, &str)> = json["programming"]
        .as_array()
        .unwrap()
        .iter()
        .map(|way| {
            let word = |key: &str| way[key].as_str().unwrap();
            (word("tool"), number(way, "/longer_mm"), word("tool_direction"))
        })
        .collect();
    let both = |tool, longer| [(tool, longer, "rotary axes"), (tool, longer, "vector")];
    assert_eq!(ways, [both("short", 0.0), both("long", 0.0), both("short", 100.0)].concat());
    let shown = Run::of(abbe().arg("verify").arg(&machine).arg(&out).args(["--poses", "20"]));
    assert!(shown.out.contains("| long ") && shown.out.contains("| short, 100 mm longer "), "{}", shown.out);
    // What is left of the long tool is what a file with that tool alone has.
    let (_, _, alone) = compiled(&folder, &single.replace("length: 120 mm", "length: 310 mm"), "fanuc-5axis");
    assert_eq!(json["programming"][2]["compensated"], alone["programming"][0]["compensated"]);
}

/// Location errors of carried bodies move the zero pose too. The lines are those of the motion all the same, in the
/// directions of the linear axes; the place of the workpiece at the zero pose is the datum, which is set on the machine.
#[test]
fn lines_are_those_of_the_motion_in_any_convention() {
    let folder = Folder::new();
    let plain = sample(&folder.write("plain.yaml", &table_table(OF_TABLES)));
    let text = table_table(OF_TABLES)
        .replace(
            "machine: table-table\n",
            "machine: table-table\nconventions: { location: carried_body, errors_are: body, workpiece_axes: direct }\n",
        )
        .replace("  Y: { controller: 2, travel", "  Y: { controller: 2, sense: iso841, travel");
    let (_, out, _) = compiled(&folder, &text, "sinumerik-traori");
    let control = Control::traori("table-table", &numbers(&out.join("TRAORI.INI")));
    let mut carried = plain.clone();
    (carried.rigid.conventions.carried_body, carried.rigid.conventions.body) = (true, true);
    carried.rigid.walk.iter_mut().filter(|axis| axis.workpiece).for_each(|axis| axis.direct = Some(axis.rotary));
    // The table is carried: at the zero pose the workpiece is displaced and turned against the machine, and stays so.
    let [real, nominal] = carried.holds(&vec![0.0; 5], Travel::Mean);
    assert!(norm(minus(real.tip, nominal.tip)) > 1e-3);
    for pose in left::poses(&carried, 5, 50) {
        let from_zero = turn(&real.rotation, minus(control.forward(&carried, &pose).0, nominal.tip));
        let apart = minus(carried.holds(&pose, Travel::Mean)[0].tip, plus(real.tip, from_zero));
        assert!(norm(apart) < 8e-6, "{apart:?} at {pose:?}");
    }
    // Errors of linear axes displace carried bodies too, and are no business of the parameters.
    let squared = text.replace("errors:\n", "errors:\n  EC0Y: 80 urad\n  EB0Z: 50 urad\n");
    let other = Folder::new();
    let (_, with, _) = compiled(&other, &squared, "sinumerik-traori");
    assert_eq!(numbers(&with.join("TRAORI.INI")), numbers(&out.join("TRAORI.INI")));
}

/// Numbers by hand: the nominal offsets from the gauge point plus the location errors, rounded.
#[test]
fn numbers_by_hand() {
    let offsets = "  EY0A: -8 um\n  EZ0A: 17.4 um\n  EX0C: 26 um\n  EY0C: -9 um\n";
    for (target, file, wanted) in [
        (
            "fanuc-5axis",
            "TCP.PRM",
            &[
                ("19700", 240.0),
                ("19701", 204.992),
                ("19702", -379.983),
                ("19703", 0.026),
                ("19704", -0.001),
                ("19705", -30.017),
            ][..],
        ),
        (
            "heidenhain-kinematics",
            "kinematics.txt",
            &[
                ("Trans.1.X", 240.0),
                ("Trans.1.Y", 204.992),
                ("Trans.1.Z", -379.9826),
                ("Trans.2.X", 0.026),
                ("Trans.2.Y", -0.001),
                ("Trans.2.Z", -30.0174),
            ][..],
        ),
        ("haas-mrzp", "settings.txt", &[("254", -0.001), ("256", 204.992), ("257", -379.983)][..]),
    ] {
        let folder = Folder::new();
        let (machine, out, json) = compiled(&folder, &table_table(offsets), target);
        let found = numbers(&out.join(file));
        assert_eq!(found, wanted.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(), "{target}");
        // Half a thousandth in each offset, twice at half a turn; haas has no number for X of C on a table A.
        let rest = if target == "haas-mrzp" { 60.0 } else { 3.0 };
        for way in json["programming"].as_array().unwrap() {
            assert!(number(way, "/compensated/position_um/max") < rest, "{target}: {way}");
        }
        let handled = |name: &str| json["errors"][name]["handled"].clone();
        assert_eq!(handled("EX0C"), if target == "haas-mrzp" { "no" } else { "fully" });
        assert!(["EY0C", "EY0A"].into_iter().all(|name| handled(name) == "fully"), "{json}");
        assert_eq!(verify(&machine, &out, &["--poses", "300"]).json()["compensated"], json["compensated"]);
    }
}

/// The centre of C moves by its location error from where it was: a datum that stays on the machine is that much nearer.
#[test]
fn presets_stay_where_they_were() {
    let folder = Folder::new();
    let ended = |text: &str| {
        let (_, out, _) = compiled(&folder, text, "heidenhain-kinematics");
        let list = std::fs::read_to_string(out.join("kinematics.txt")).unwrap();
        let from = list.find("; Presets").unwrap_or(list.len());
        list[from..].lines().filter_map(|line| line.strip_prefix(";   ")).map(str::to_owned).collect::<Vec<_>>()
    };
    let offsets = "  EY0A: -8 um\n  EZ0A: 17.4 um\n  EX0C: 26 um\n  EY0C: -9 um\n";
    // Y and Z as they are written: A at 204.992 and -379.9826, C from it at -0.001 and -30.0174.
    assert_eq!(ended(&table_table(offsets)), ["X -0.026", "Y 0.009", "Z 0.0"]);
    assert_eq!(ended(&head_table("  EX0C: 12 um\n  EX0B: 5 um\n")), ["X -0.012", "Y 0.0", "Z 0.0"]);
    assert!(ended(&head_head("  EX0C: 12 um\n")).is_empty());
}

/// A control without directions of axes: what tilts leave is what the manual's transformation leaves.
#[test]
fn offsets_alone_leave_what_geometry_says() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", &head_table(&with_spindle(OF_HEADS)));
    let out = folder.path("out");
    let json = compile(&machine, "fanuc-5axis", &out, &["--accept-unverified", "--poses", "2000"]).json();
    let found = numbers(&out.join("TCP.PRM"));
    let of = |first: usize| vector(&found, |k| (first + k).to_string());
    let table = Line { axis: "C", direction: [0.0, 0.0, -1.0], point: of(19700) };
    let control = Control {
        table: vec![table],
        head: vec![Line { axis: "B", direction: [0.0, 1.0, 0.0], point: of(19709) }],
        tool: [0.0, 0.0, 1.0],
    };
    let sample = sample(&machine);
    for (sample, way) in [(sample.clone(), 0), (longer(&sample), 2)] {
        let left: Vec<f64> = left::poses(&sample, 8, 2000)
            .iter()
            .map(|pose| {
                let command = control.inverse(&sample, pose, left::ideal(&sample, pose));
                1e3 * norm(left::position(&sample, pose, &command, Travel::Mean))
            })
            .collect();
        let (low, high) = p95_bracket(&left, 2000);
        let figure = number(&json["programming"][way], "/compensated/position_um/p95");
        assert_eq!(json["programming"][way]["tool_direction"], "rotary axes");
        assert!(low <= figure && figure <= high && low > 1.0, "{low} {figure} {high}");
    }
    let (position, _) = apart(&control, &sample);
    assert!(position > 1e-3, "{position}");
}

#[test]
fn parameters_do_not_know_the_tool() {
    for target in PARAMETER_TARGETS.into_iter().filter(|target| !target.starts_with("linuxcnc")) {
        let text = table_table(&with_spindle(OF_TABLES));
        let files = [text.clone(), text.replace("length: 120 mm", "offset: [3, -2, -260]")].map(|text| {
            let folder = Folder::new();
            let (_, out, _) = compiled(&folder, &text, target);
            let read = |name: &String| std::fs::read(out.join(name)).unwrap();
            set_files(&out).iter().filter(|name| *name != "abbe.lock.json").map(read).collect::<Vec<_>>()
        });
        assert_eq!(files[0], files[1], "{target}");
    }
}

/// The change of the command for X Y Z at a pose when numbers of a file change.
pub fn moved(text: &str, target: &str, file: &str, changes: &[(&str, f64)], pose: &[(&str, f64)]) -> V3 {
    let folder = Folder::new();
    let (path, out, _) = compiled(&folder, text, target);
    let machine = loaded::machine(&path);
    let target = ControllerTarget::builtin(target).unwrap();
    let meant = KinematicsModule::of(&machine, &target, false).unwrap();
    let sound = std::fs::read_to_string(out.join(file)).unwrap();
    let change = |line: &str| {
        let found = changes.iter().find(|(name, _)| line.contains(name));
        let Some((_, by)) = found else { return line.to_owned() };
        let bare = line.split(';').next().unwrap().trim();
        let start = bare.rfind(['=', 'M', ' ']).unwrap() + 1;
        format!("{}{:.9}", &bare[..start], bare[start..].trim().parse::<f64>().unwrap() + by)
    };
    let changed: String = sound.lines().map(|line| change(line) + "\n").collect();
    assert_ne!(sound, changed);
    let commands = [sound, changed].map(|text| {
        let mut diagnostics = Diagnostics::default();
        let read = target.read_kinematics(&machine, &meant, &[ReadBack::new(file, text)], &mut diagnostics);
        let module = read.unwrap_or_else(|| panic!("{:?}", diagnostics.iter().collect::<Vec<_>>()));
        let at = |name: &str| pose.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, q)| *q);
        let pose: Vec<f64> = machine.axes().iter().map(|axis| at(axis.name.as_str())).collect();
        let command = ModuleField::new(&machine, &module).command(&pose).unwrap();
        ["X", "Y", "Z"].map(|name| command[machine.axis_index(name).unwrap()])
    });
    minus(commands[1], commands[0])
}

/// Displaced lines, carried out in the replay, with readings by hand.
#[test]
fn displaced_lines_by_hand() {
    let near = |found: V3, wanted: V3| assert!(norm(minus(found, wanted)) < 2e-4, "{found:?}, wanted {wanted:?}");
    let text = table_table("");
    let half = [("C", 180.0), ("X", 200.0), ("Y", 100.0), ("Z", -100.0)];
    let at_zero = [("X", 200.0), ("Y", 100.0), ("Z", -100.0)];
    for (target, file, changes) in [
        ("sinumerik-traori", "TRAORI.INI", &[("JOINT_OFFSET_1[0]", -0.1), ("PART_OFFSET_1[0]", 0.1)][..]),
        ("fanuc-5axis", "TCP.PRM", &[("N19703", -0.1)][..]),
        ("heidenhain-kinematics", "kinematics.txt", &[("Trans.2.X", -0.1)][..]),
        ("sinumerik-tcarr", "TCARR.MPF", &[("TC_CARR15[1]", -0.1), ("TC_CARR18[1]", 0.1)][..]),
    ] {
        near(moved(&text, target, file, changes, &at_zero), [0.0; 3]);
        near(moved(&text, target, file, changes, &half), [-0.2, 0.0, 0.0]);
    }
    let changes = [("SETTING 254", -0.1)];
    near(moved(&text, "haas-mrzp", "settings.txt", &changes, &half), [0.0, -0.2, 0.0]);
    // The end of JOINT_OFFSET is at (250, 225, -380); the tip 100 mm above it is at Z = -280, gauge 30, tool 120.
    let above = [("C", 180.0), ("X", 240.0), ("Y", 205.0), ("Z", -190.0)];
    near(moved(&text, "sinumerik-traori", "TRAORI.INI", &[("AXIS2_1[0]", 0.001)], &above), [-0.2, 0.0, 0.0]);
    near(moved(&text, "sinumerik-tcarr", "TCARR.MPF", &[("TC_CARR10[1]", 0.001)], &above), [-0.2, 0.0, 0.0]);
    let head = head_table("")
        .replace("B: { travel: [-100 deg, 100 deg]", "B: { direction: [0, 0, 1], travel: [-200 deg, 200 deg]");
    near(moved(&head, "fanuc-5axis", "TCP.PRM", &[("N19709", 0.1)], &[("B", 180.0)]), [-0.2, 0.0, 0.0]);
    near(moved(&head, "fanuc-5axis", "TCP.PRM", &[("N19709", 0.1)], &[("B", 0.0)]), [0.0; 3]);
}

fn pivoting(errors: &str) -> String {
    format!(
        "abbe: 1\nmachine: pivot\nchain: \"w b X Y Z C B t\"\naxes:\n  X: {{ controller: 1, travel: [-300 mm, 300 mm] }}\n  \
         Y: {{ controller: 2, travel: [-300 mm, 300 mm] }}\n  Z: {{ controller: 3, travel: [-300 mm, 0 mm] }}\n  C: {{ controller: 5, travel: [-200 deg, 200 deg] }}\n  \
         B: {{ controller: 4, travel: [-100 deg, 100 deg], direction: [0, -1, 0], origin: [0, 0, 250] }}\n\
         tool: {{ length: 100 mm }}\nerrors:\n{errors}"
    )
}

/// 5axiskins.c: x = X + r sin B cos C, y = Y + r sin B sin C, z = Z + p - r cos B with r = p + W.
#[test]
fn pivot_length_of_5axiskins() {
    let folder = Folder::new();
    let (machine, out, json) = compiled(&folder, &pivoting("  EZ0B: 40 um\n  EX0B: 15 um\n"), "linuxcnc-5axiskins");
    let found = numbers(&out.join("5axiskins.hal"));
    assert_eq!(found, BTreeMap::from([("setp 5axiskins.pivot-length".to_owned(), 250.04)]));
    assert_eq!(json["errors"]["EZ0B"]["handled"], "fully");
    assert_eq!(json["errors"]["EX0B"]["handled"], "no");
    let exact = folder.write("exact.yaml", &pivoting("  EZ0B: 40 um\n"));
    let sample = sample(&exact);
    for pose in left::poses(&sample, 4, 100) {
        let at = |name: &str| pose[sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap()];
        let (b, c, p) = (at("B").to_radians(), at("C").to_radians(), found["setp 5axiskins.pivot-length"]);
        let r = p + 100.0;
        let module = [at("X") + r * b.sin() * c.cos(), at("Y") + r * b.sin() * c.sin(), at("Z") + p - r * b.cos()];
        assert!(norm(minus(sample.holds(&pose, Travel::Mean)[0].tip, module)) < 1e-9);
    }
    let other = pivoting("  EZ0B: 40 um\n").replace("[0, -1, 0]", "[0, 1, 0]");
    let other = folder.write("other.yaml", &other);
    let _ = compile(&other, "linuxcnc-5axiskins", &folder.path("no"), &ACCEPT)
        .refused("E0751")
        .says("assumes other directions or places");
    assert!(verify(&machine, &out, &["--poses", "20"]).code == Some(0));
}

/// The inverse of maxkins in LinuxCNC 2.9: the table turned back, then X = x - r sin B, Z = z + r cos B - p with
/// r = p + W; what is left at its joints is what the other errors do.
#[test]
fn pivot_length_of_maxkins() {
    let folder = Folder::new();
    let text = |errors: &str| {
        pivoting(errors)
            .replace("w b X Y Z C B t", "w C' b X Y Z B t")
            .replace("C: { controller: 5, travel", "C: { controller: 5, origin: [0, 0, -300], travel")
    };
    let (machine, out, json) = compiled(&folder, &text("  EZ0B: 40 um\n  EX0B: 15 um\n"), "linuxcnc-maxkins");
    let found = numbers(&out.join("maxkins.hal"));
    assert_eq!(found, BTreeMap::from([("setp maxkins.pivot-length".to_owned(), 250.04)]));
    assert_eq!(json["errors"]["EZ0B"]["handled"], "fully");
    assert_eq!(json["errors"]["EX0B"]["handled"], "no");
    let sample = sample(&folder.write("exact.yaml", &text("  EZ0B: 40 um\n")));
    let index = |name: &str| sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap();
    for pose in left::poses(&sample, 4, 100) {
        let tip = left::ideal(&sample, &pose);
        let (b, c, p) =
            (pose[index("B")].to_radians(), pose[index("C")].to_radians(), found["setp maxkins.pivot-length"]);
        let r = p + 100.0;
        let turned = [tip[0] * c.cos() + tip[1] * c.sin(), tip[1] * c.cos() - tip[0] * c.sin()];
        let joints = [turned[0] - r * b.sin(), turned[1], tip[2] + r * b.cos() - p];
        let mut command = pose.clone();
        ["X", "Y", "Z"].iter().zip(joints).for_each(|(name, joint)| command[index(name)] = joint);
        assert!(norm(left::position(&sample, &pose, &command, Travel::Mean)) < 1e-9);
    }
    let other = folder.write("other.yaml", &text("").replace("origin: [0, 0, -300]", "origin: [1, 0, -300]"));
    let _ = compile(&other, "linuxcnc-maxkins", &folder.path("no"), &ACCEPT).refused("E0751");
    let inclined =
        folder.write("tool.yaml", &text("").replace("length: 100 mm", "length: 100 mm, direction: [1, 0, 0]"));
    let _ = compile(&inclined, "linuxcnc-maxkins", &folder.path("no"), &ACCEPT).refused("E0751");
    assert!(verify(&machine, &out, &["--poses", "20"]).code == Some(0));
}

/// The second rotary axis is hypothetical: the line of the one that is there, from the gauge point (0, 50, 150), with
/// EX0B = 9 um and EZ0B = -12 um; 0 - 50 + along the axis in Y.
#[test]
fn one_rotary_axis_in_fanucs_numbers() {
    let folder = Folder::new();
    let out = folder.path("out");
    let json = compile(&config("hmc-4ax.yaml"), "fanuc-5axis", &out, &ACCEPT).json();
    let wanted = BTreeMap::from([("19700", 0.009), ("19701", -50.0), ("19702", -150.012)]);
    assert_eq!(numbers(&out.join("TCP.PRM")), wanted.into_iter().map(|(k, v)| (k.to_owned(), v)).collect());
    assert_eq!(json["errors"]["EX0B"]["handled"], "fully");
    assert_eq!(json["errors"]["EA0B"]["handled"], "no");
}

/// One rotary axis is axis 1 of the record, and the vector of axis 2 is zero.
#[test]
fn swivel_data_of_one_rotary_axis() {
    const OF_C: &str = "  EX0C: 26 um\n  EY0C: -9 um\n  EA0C: -62 urad\n  EB0C: 44 urad\n";
    let table = table_table(OF_C).replace("w C' A' Y'", "w C' Y'");
    let a = table.find("A: { controller: 4").unwrap();
    let table = table.replacen(&table[a..a + table[a..].find("C: {").unwrap()], "", 1);
    let head = head_head(OF_C).replace("X Z C B (S)", "X Z C (S)");
    let b = head.find("B: { controller: 4").unwrap();
    let head = head.replacen(&head[b - 2..b + head[b..].find("tool:").unwrap()], "", 1);
    for (kind, text) in [("P", table), ("T", head)] {
        let folder = Folder::new();
        let (machine, out, json) = compiled(&folder, &text, "sinumerik-tcarr");
        let file = std::fs::read_to_string(out.join("TCARR.MPF")).unwrap();
        assert!(file.contains(&format!("$TC_CARR23[1]=\"{kind}\"\n")), "{file}");
        let found = numbers_of(&file);
        let of = |first: usize| vector(&found, |k| format!("$TC_CARR{}[1]", first + k));
        assert!(norm(of(10)) == 0.0 && norm(of(15)) == 0.0, "{file}");
        let (point, direction) = (of(4), of(7));
        let back = of(if kind == "P" { 18 } else { 1 });
        assert!(norm(plus(point, back)) < 1e-9, "{file}");
        let control = match kind {
            "P" => Control {
                table: vec![Line { axis: "C", direction: negative(direction), point }],
                head: vec![],
                tool: [0.0, 0.0, 1.0],
            },
            _ => Control { table: vec![], head: vec![Line { axis: "C", direction, point }], tool: [0.0, 0.0, 1.0] },
        };
        let (position, axis) = apart(&control, &sample(&machine));
        assert!(position < 3e-6 && axis < 3e-9, "{kind}: {position:e} mm {axis:e} rad");
        assert_eq!(json["errors"]["EX0C"]["handled"], "fully", "{kind}: {json}");
        // A record of another second axis is another machine's.
        let other = file.replace("$TC_CARR10[1]=0", "$TC_CARR10[1]=1");
        assert_ne!(other, file);
        std::fs::write(out.join("TCARR.MPF"), other).unwrap();
        let _ = verify(&machine, &out, &["--poses", "5"]).refused("E0704");
    }
}

#[test]
fn other_machines_and_memory_are_refused() {
    let folder = Folder::new();
    let out = folder.path("out");
    let five = folder.write("five.yaml", &table_table(OF_TABLES));
    for target in ["sinumerik-traori", "sinumerik-chain", "fanuc-5axis", "heidenhain-kinematics", "haas-mrzp"] {
        let _ = compile(&five, target, &out, &[]).refused("E0710");
        let _ = compile(&config("gantry-3ax.yaml"), target, &out, &ACCEPT).refused("E0751");
        let _ = compile(&config("boring-w.yaml"), target, &out, &ACCEPT).refused("E0751");
    }
    let _ = compile(&config("hmc-4ax.yaml"), "haas-mrzp", &out, &ACCEPT).refused("E0751").says("one rotary axis");
    let head = folder.write("head.yaml", &head_head(OF_HEADS));
    let _ = compile(&head, "haas-mrzp", &out, &ACCEPT).refused("E0751").says("two rotary axes that carry the tool");
    assert!(!out.exists());
}

/// The manifest says what the controller takes: a limit below the machine's coordinates refuses them, read or written;
/// without a frame it says nothing.
#[test]
fn numbers_beyond_the_controllers_are_refused() {
    let folder = Folder::new();
    let (machine, out, _) = compiled(&folder, &table_table(OF_TABLES), "fanuc-5axis");
    let own = folder.path("targets/narrow");
    std::fs::create_dir_all(&own).unwrap();
    for entry in std::fs::read_dir("templates/fanuc-5axis").unwrap().map(Result::unwrap) {
        let text = std::fs::read_to_string(entry.path()).unwrap();
        let narrow = text
            .replace("target: fanuc-5axis", "target: narrow")
            .replace("max_offset_mm: 999999.999", "max_offset_mm: 300");
        std::fs::write(own.join(entry.file_name()), narrow).unwrap();
    }
    let templates = ["--templates", folder.path("targets").to_str().unwrap()].map(str::to_owned);
    let templates = templates.each_ref().map(String::as_str);
    // 19702 is -379.983.
    let again = compile(&machine, "narrow", &folder.path("again"), &[&ACCEPT[..], &templates].concat());
    again.refused("E0751").says("`19702` is -379.983 mm, above the controller's limit of 300 mm");
    let manifest = std::fs::read_to_string(own.join("target.yaml")).unwrap();
    let frameless: String =
        manifest.lines().filter(|line| !line.contains("  frame: ")).map(|l| format!("{l}\n")).collect();
    std::fs::write(own.join("target.yaml"), frameless).unwrap();
    let again = compile(&machine, "narrow", &folder.path("again"), &[&ACCEPT[..], &templates].concat());
    let _ = again.says("from where and in which directions they count");
    let file = out.join("TCP.PRM");
    let written = std::fs::read_to_string(&file).unwrap();
    assert_eq!(written.matches("-379.983").count(), 1, "{written}");
    std::fs::write(&file, written.replace("-379.983", "-1379983.0")).unwrap();
    let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704").says("`19702`");
}

#[test]
fn lines_that_the_controller_would_misread_are_refused() {
    let folder = Folder::new();
    let (machine, out, _) = compiled(&folder, &table_table(OF_TABLES), "sinumerik-traori");
    let file = out.join("TRAORI.INI");
    let good = std::fs::read_to_string(&file).unwrap();
    for (from, to, says) in [
        ("$MC_TRAFO5_PART_OFFSET_1[0]=-", "$MC_TRAFO5_PART_OFFSET_1[0]=", "does not close"),
        ("$MC_TRAFO5_PART_OFFSET_1[0]", "$MC_TRAFO5_PART_OFFSET_1[7]", "no parameter of this machine"),
        ("$MC_TRAFO5_PART_OFFSET_1[0]", "$MC_TRAFO5_PART_OFFSET_1[1]", "set twice"),
        ("$MC_TRAFO5_PART_OFFSET_1[0]", ";$MC_TRAFO5_PART_OFFSET_1[0]", "is not set"),
        ("$MC_TRAFO5_PART_OFFSET_1[0]=", "$MC_TRAFO5_PART_OFFSET_1[0]=1e12 ;", "no parameter"),
        ("$MC_TRAFO5_PART_OFFSET_1[0]=", "$MC_TRAFO5_PART_OFFSET_1[0]=x", "number"),
        ("CHANDATA(1)", "CHANDATA 1", "would not understand"),
    ] {
        assert!(good.contains(from));
        std::fs::write(&file, good.replacen(from, to, 1)).unwrap();
        let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704").says(says);
    }
}

/// Old numbers plus what the errors change; the new set is judged against the old one.
#[test]
fn new_numbers_on_top_of_installed_ones() {
    let folder = Folder::new();
    let (_, first, _) = compiled(&folder, &table_table("  EX0C: 20 um\n  EA0C: 30 urad\n"), "sinumerik-traori");
    let left = folder.write("left.yaml", &table_table("  EX0C: 7 um\n  EA0C: -10 urad\n"));
    let second = folder.path("second");
    let on_top = ["--installed", first.to_str().unwrap()];
    let json = compile(&left, "sinumerik-traori", &second, &[&ACCEPT[..], &on_top].concat()).json();
    assert!(number(&json, "/compensated/position_um/max") < 0.01, "{json}");
    let [old, new] = [&first, &second].map(|out| numbers(&out.join("TRAORI.INI")));
    let change = |name: &str| new[name] - old[name];
    // The vector of a table is reversed: EA0C tilts C's line to -Y, and the stored vector to +Y.
    for (name, by) in [("JOINT_OFFSET_1[0]", 7e-3), ("PART_OFFSET_1[0]", -7e-3), ("AXIS2_1[1]", -10e-6)] {
        assert!((change(name) - by).abs() < 2e-9, "{name}: {}", change(name));
    }
    let again = verify(&left, &second, &[&["--poses", "300"][..], &on_top].concat()).json();
    assert_eq!(again["compensated"], json["compensated"]);
    // Without the old set the new numbers are judged as absolute ones: old and new together are too much.
    let alone = verify(&left, &second, &["--poses", "300"]).json();
    assert!(number(&alone, "/compensated/position_um/max") > 5.0);
    let moved = Run::of(abbe().args(["diff", "--format", "json", "--poses", "40"]).arg(&left).arg(&first).arg(&second));
    assert!(number(&moved.json(), "/position_um/max") > 5.0);
}
