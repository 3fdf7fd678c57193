//! The program that touches balls, as LinuxCNC's interpreter reads it. Oracle: the rigid-body model of the tests, and
//! distances of its own, say where stylus and shaft are on every move.

use crate::kinematic_parameters::{head_head, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::V3;
use crate::planned::at_place;
use crate::program::{Folder, abbe, available, json, refused, text};
use crate::support::config::sample;
use nalgebra::Vector3;
use std::path::{Path, PathBuf};
use std::process::Command;

const BALL: f64 = 12.5;
const STYLUS: f64 = 3.0;
const SHAFT: f64 = 2.0;
const LENGTH: f64 = 50.0;
const WITHIN: f64 = 1.0;

struct Shop {
    folder: Folder,
    plain: PathBuf,
    machine: Sample,
    balls: [V3; 3],
    rotary: [&'static str; 2],
    poses: Vec<[f64; 2]>,
    travels: Vec<(&'static str, f64, f64)>,
}

fn table(test: &str) -> Shop {
    let folder = Folder::new(&format!("measure-table-{test}"));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    Shop {
        machine: sample(&plain),
        plain,
        folder,
        balls: [[62.0, 31.0, 45.0], [-74.0, 22.0, 80.0], [11.0, -85.0, 60.0]],
        rotary: ["A", "C"],
        poses: vec![[0.0, 0.0], [0.0, 120.0], [-30.0, 120.0], [-30.0, 250.0], [25.0, 300.0]],
        travels: vec![("X", 0.0, 500.0), ("Y", 0.0, 450.0), ("Z", -400.0, 0.0), ("A", -120.0, 30.0)],
    }
}

fn head(test: &str) -> Shop {
    let folder = Folder::new(&format!("measure-head-{test}"));
    let plain = folder.with("plain.yaml", &head_head("  EX0C: 0 um\n"));
    Shop {
        machine: sample(&plain),
        plain,
        folder,
        balls: [[220.0, 100.0, 45.0], [390.0, 180.0, 80.0], [300.0, 150.0, 60.0]],
        rotary: ["C", "B"],
        poses: vec![[0.0, 0.0], [90.0, 0.0], [90.0, 30.0], [-60.0, 30.0], [-60.0, -40.0]],
        travels: vec![
            ("X", 0.0, 900.0),
            ("Y", 0.0, 450.0),
            ("Z", -400.0, 0.0),
            ("C", -200.0, 200.0),
            ("B", -100.0, 100.0),
        ],
    }
}

/// A move as the interpreter says it: traverse, feed or probe, to positions X Y Z A B C.
#[derive(Debug, Clone)]
struct Move {
    kind: String,
    to: [f64; 6],
}

/// Where the middle of the stylus is, and the direction to the spindle.
type Held = (Vector3<f64>, Vector3<f64>);

impl Shop {
    fn sets(&self, poses: &[[f64; 2]]) -> String {
        let mut text = format!("ball,ball.x [mm],ball.y [mm],ball.z [mm],{},{}\n", self.rotary[0], self.rotary[1]);
        for [a, b] in poses {
            for (number, [x, y, z]) in (1..).zip(self.balls) {
                text += &format!("b{number},{x},{y},{z},{a},{b}\n");
            }
        }
        text
    }

    /// Writes the program into a folder.
    fn program(&self, name: &str, poses: &[[f64; 2]]) -> (PathBuf, serde_json::Value) {
        let out = self.folder.file(name);
        let sets = self.folder.with("sets.csv", &self.sets(poses));
        let made =
            ["measure", text(&self.plain), text(&sets), "--out", text(&out), "--noise", "0.5 um", "--format", "json"];
        (out.clone(), json(&made))
    }

    /// Has the interpreter read these calls, and returns moves and logged lines.
    fn read(&self, out: &Path, calls: &str) -> (Vec<Move>, Vec<String>) {
        std::fs::write(out.join("main.ngc"), format!("{calls}\nM2\n")).unwrap();
        std::fs::write(out.join("i.ini"), "[RS274NGC]\nSUBROUTINE_PATH = .\n[TRAJ]\nLINEAR_UNITS = mm\n").unwrap();
        let mut interpreter = Command::new("rs274");
        let output =
            interpreter.args(["-g", "-i", "i.ini", "main.ngc"]).current_dir(out).env("HOME", out).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
        let (mut moves, mut logged) = (Vec::new(), Vec::new());
        for line in said.lines() {
            if let Some(line) = line.split_once("LOG(\"").and_then(|(_, rest)| rest.strip_suffix("\")")) {
                logged.push(line.to_owned());
            }
            let Some((_, call)) = line.split_once("STRAIGHT_") else { continue };
            let (kind, numbers) = call.trim_end_matches(')').split_once('(').unwrap();
            let numbers: Vec<f64> = numbers.split(',').map(|number| number.trim().parse().unwrap()).collect();
            moves.push(Move { kind: kind.to_owned(), to: numbers.try_into().unwrap() });
        }
        (moves, logged)
    }

    fn held(&self, at: &[f64; 6]) -> Held {
        let of = |name: &str| at[["X", "Y", "Z", "A", "B", "C"].iter().position(|axis| *axis == name).unwrap()];
        let walk: Vec<f64> = self.machine.rigid.walk.iter().map(|axis| of(&axis.name)).collect();
        let held = self.machine.holds(&walk, Travel::Mean)[1];
        (Vector3::from(held.tip), Vector3::from(held.axis()))
    }

    /// Distance that a move leaves to balls and stems, less what the balls may be away; `but` is not met.
    fn room(&self, from: &[f64; 6], to: &[f64; 6], but: Option<usize>) -> f64 {
        let mut room = f64::MAX;
        for step in 0..=60 {
            let share = f64::from(step) / 60.0;
            let (tip, axis) = self.held(&std::array::from_fn(|k| from[k] + share * (to[k] - from[k])));
            for (ball, centre) in self.balls.iter().enumerate() {
                // Points of the shaft, and of the ball with its stem.
                for height in (0..=50).map(f64::from) {
                    let (point, thick) =
                        (tip + axis * (height * LENGTH / 50.0), if height == 0.0 { STYLUS } else { SHAFT });
                    let off = point - Vector3::from(*centre);
                    let from_stem = if off.z < 0.0 { off.xy().norm() } else { off.norm() };
                    if but != Some(ball) {
                        room = room.min(off.norm() - BALL - thick - WITHIN);
                    }
                    room = room.min(from_stem - BALL / 2.0 - thick);
                }
            }
        }
        room
    }
}

#[test]
fn every_move_keeps_clear_and_every_touch_meets_its_ball() {
    if !available("rs274", "the measuring program") {
        return;
    }
    for shop in [table("moves"), head("moves")] {
        let (out, made) = shop.program("program", &shop.poses);
        let count = shop.poses.len() * 3;
        assert_eq!(made["sets"].as_array().unwrap().len(), count);
        assert_eq!(made["touches"], 8 * count);
        // A cycle of 1 ms at F34 is 0.57 um, an even scatter of 0.16 um: a third of 0.5 um.
        assert_eq!(made["slow_mm_per_min"], 34.0);
        let found = "#<_abbe_1_found> = 1\n#<_abbe_2_found> = 1\n#<_abbe_3_found> = 1\n";
        let sets: String = (1..=count).map(|set| format!("o<abbe_set_{set}> call\n")).collect();
        let (moves, logged) = shop.read(&out, &format!("o<abbe_start> call [1] [0]\n{found}{sets}"));
        let centres: Vec<Vector3<f64>> = shop.balls.iter().map(|ball| Vector3::from(*ball)).collect();
        let (mut at, mut touches, mut set) = (moves[0].to, 0, 0);
        let (reach, mut index) = (BALL + STYLUS, 1);
        while index < moves.len() {
            let step = &moves[index];
            for (axis, low, high) in &shop.travels {
                let q = step.to[["X", "Y", "Z", "A", "B", "C"].iter().position(|of| of == axis).unwrap()];
                assert!((low..=high).contains(&&q), "{axis} {q}");
            }
            if step.kind != "PROBE" {
                let room = shop.room(&at, &step.to, None);
                assert!(room > 0.5, "set {set}: {room} mm left from {at:?} to {step:?}");
                at = step.to;
                index += 1;
                continue;
            }
            // Fast, back, slowly, back to the start.
            let kinds: Vec<&str> = moves[index..index + 4].iter().map(|of| of.kind.as_str()).collect();
            assert_eq!(kinds, ["PROBE", "TRAVERSE", "PROBE", "TRAVERSE"]);
            assert_eq!(moves[index + 3].to, at);
            let ball = touches / 8 % 3;
            let ((start, axis), (end, _)) = (shop.held(&at), shop.held(&step.to));
            let (out_of, deep) = (start - centres[ball], end - centres[ball]);
            assert!(out_of.norm() > reach + WITHIN + 1.0 && deep.norm() < reach - WITHIN - 1.0, "{out_of} {deep}");
            assert!(out_of.cross(&deep).norm() < 1e-2 && out_of.dot(&deep) > 0.0, "not towards the ball");
            let along = out_of.normalize().dot(&axis);
            let wanted = if touches % 8 == 0 { 1.0 } else { 0.0 };
            assert!((along - wanted).abs() < 1e-4, "touch {touches}: {along}");
            // It stops half way.
            let contact = std::array::from_fn(|k| (at[k] + step.to[k]) / 2.0);
            assert!(shop.room(&at, &contact, Some(ball)) > 0.5, "touch {touches}");
            for between in &moves[index + 1..index + 3] {
                let off = shop.held(&between.to).0 - centres[ball];
                assert!(off.cross(&out_of).norm() < 2e-2 && off.norm() > 5.0, "{off}");
            }
            touches += 1;
            set += usize::from(touches % 8 == 0);
            index += 4;
        }
        assert_eq!(touches, 8 * count);
        // What it logs is read back: the interpreter ends each touch at its target, 0.3 mm deeper than the fast one.
        let log: String = logged
            .iter()
            .map(|line| {
                let is_touch = line.starts_with("touch ");
                let line = if is_touch { line.rsplit_once(' ').unwrap().0 } else { line };
                format!("{line}{}\n", if is_touch { " 1" } else { "" })
            })
            .collect();
        let log = shop.folder.with("interpreted.log", &log);
        let read = json(&["import", text(&log), "--machine", text(&shop.plain), "--format", "json"]);
        let radius = read["effective_radius_mm"].as_f64().unwrap();
        assert!((radius - (reach - WITHIN - 2.0 - 0.3)).abs() < 1e-3, "{radius}");
        for (number, centre) in read["centres"].as_array().unwrap().iter().enumerate() {
            let found = Vector3::from_fn(|k, _| centre["centre_mm"][k].as_f64().unwrap());
            assert!((found - centres[number % 3]).norm() < 1e-3, "{centre}");
            assert_eq!(centre["ball"], format!("b{}", number % 3 + 1));
            assert_eq!(centre["pose"], format!("p{}", number / 3 + 1));
        }
        assert_eq!(
            std::fs::read_to_string(out.join("abbe_measure.py")).unwrap().matches("(\"abbe_").count(),
            count + 3
        );
    }
}

/// What the plan chooses `measure` takes, of every ball, in its order; no move between the sets meets any ball.
#[test]
fn a_plan_is_a_program_that_keeps_clear() {
    if !available("rs274", "the measuring program") {
        return;
    }
    for (shop, start) in [(table("plan"), 0.0), (head("plan"), 100.0)] {
        let walk = &shop.machine.rigid.walk;
        let start: Vec<f64> = walk.iter().map(|axis| if axis.rotary { 0.0 } else { start }).collect();
        let balls: Vec<String> = shop
            .balls
            .iter()
            .map(|ball| {
                let at = at_place(&shop.machine, &start, *ball, 1);
                let linear = walk.iter().zip(&at).filter(|(axis, _)| !axis.rotary);
                linear.map(|(axis, q)| format!("{}={q:.4}", axis.name)).collect::<Vec<_>>().join(",")
            })
            .collect();
        let asked: Vec<&str> = ["identify", text(&shop.plain), "--plan", "24", "--instrument", "touch"]
            .into_iter()
            .chain(balls.iter().flat_map(|ball| ["--ball", ball]))
            .chain(["--fit", "needed", "--format", "csv", "--quiet"])
            .collect();
        let csv = abbe(&asked);
        assert!((1..=3).all(|ball| csv.contains(&format!("\nb{ball},"))), "{csv}");
        let (sets, out) = (shop.folder.with("planned.csv", &csv), shop.folder.file("planned"));
        let made = json(&["measure", text(&shop.plain), text(&sets), "--out", text(&out), "--format", "json"]);
        assert_eq!(made["sets"].as_array().unwrap().len(), 24);
        let sets: String = (1..=24).map(|set| format!("o<abbe_set_{set}> call\n")).collect();
        let found = "#<_abbe_1_found> = 1\n#<_abbe_2_found> = 1\n#<_abbe_3_found> = 1\n";
        let (moves, _) = shop.read(&out, &format!("o<abbe_start> call [1] [0]\n{found}{sets}"));
        let mut at: [f64; 6] = ["X", "Y", "Z", "A", "B", "C"].map(|axis| made["start"][axis].as_f64().unwrap_or(0.0));
        let mut index = 0;
        while index < moves.len() {
            let step = &moves[index];
            if step.kind == "PROBE" {
                index += 4;
                continue;
            }
            let room = shop.room(&at, &step.to, None);
            assert!(room > 0.5, "{room} mm left from {at:?} to {step:?}");
            at = step.to;
            index += 1;
        }
    }
}

/// The dry run goes the same way out along the tool axis; a set that broke off leaves along it; the order is kept.
#[test]
fn it_runs_dry_and_goes_on_where_it_broke_off() {
    if !available("rs274", "the measuring program") {
        return;
    }
    let shop = head("head");
    let (out, _) = shop.program("program", &shop.poses[2..3]);
    let calls = "o<abbe_find_1> call\no<abbe_set_1> call";
    let (wet, _) = shop.read(&out, "o<abbe_start> call [1] [0]\n#<_abbe_1_found> = 1\no<abbe_set_1> call");
    let (dry, logged) = shop.read(&out, &format!("o<abbe_start> call [1] [50]\n{calls}"));
    assert!(dry.iter().all(|step| step.kind != "PROBE"), "{dry:?}");
    assert!(logged.iter().any(|line| line.starts_with("begin b1 p1")));
    // The set ends above all balls: lifted by 50 mm along the tool axis.
    let (top, axis) = shop.held(&wet.last().unwrap().to);
    let lifted = shop.held(&dry.last().unwrap().to).0 - top;
    assert!((lifted - axis * 50.0).norm() < 1e-3, "{lifted}");
    // Where the interpreter lets the probe end, the pole is 3 mm too deep and the sides are even.
    let (_, found) = shop.read(
        &out,
        "o<abbe_start> call [1] [0]\no<abbe_find_1> call\n(LOG,%.9f#<_abbe_1_x> #<_abbe_1_y> #<_abbe_1_z>)",
    );
    let off: Vec<f64> = found.last().unwrap().split(' ').map(|number| number.parse().unwrap()).collect();
    assert!((Vector3::from_column_slice(&off) + axis * 3.3).norm() < 1e-3, "{off:?}");
    // It broke off in the first set, on its way there, and then at the ball.
    let again = "o<abbe_start> call [1] [0]\n#<_abbe_1_found> = 1\n#<_abbe_open> = 1\n";
    let places = std::fs::read_to_string(out.join("abbe_set_1.ngc")).unwrap().matches("M66 E0 L0").count();
    for (passed, place) in wet.iter().enumerate().take(places) {
        let (moves, logged) = shop.read(&out, &format!("{again}#<_abbe_at> = {passed}\no<abbe_set_1> call"));
        assert!(logged.iter().any(|line| line == "again b1 p1"), "{logged:?}");
        assert!(moves[0].kind == "TRAVERSE" && moves[0].to == place.to, "{moves:?}");
    }
    let (moves, logged) = shop.read(&out, &format!("{again}#<_abbe_at> = {places}\no<abbe_set_1> call"));
    assert!(logged.iter().any(|line| line == "again b1 p1"), "{logged:?}");
    assert_eq!(moves[0].kind, "FEED");
    let step = shop.held(&std::array::from_fn(|k| wet.last().unwrap().to[k] + moves[0].to[k])).0 - top;
    assert!(step.dot(&axis) > BALL && step.cross(&axis).norm() < 1e-3, "{step}");
    // Out of order, and a ball that was not found.
    for (calls, word) in [
        ("o<abbe_set_2> call", "_abbe_a_ball_is_found"),
        ("#<_abbe_2_found> = 1\no<abbe_set_2> call", "_abbe_sets_are_measured"),
    ] {
        std::fs::write(out.join("wrong.ngc"), format!("o<abbe_start> call [1] [0]\n{calls}\nM2\n")).unwrap();
        let mut interpreter = Command::new("rs274");
        let output =
            interpreter.args(["-g", "-i", "i.ini", "wrong.ngc"]).current_dir(&out).env("HOME", &out).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(word), "{said}");
    }
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    let shop = table("table");
    let machine = text(&shop.plain).to_owned();
    let ask = |sets: &str, more: &[&str]| {
        let sets = shop.folder.with("ask.csv", sets);
        let asked = [&["measure", &machine, text(&sets)][..], more].concat();
        refused(&asked)
    };
    let good = shop.sets(&shop.poses[..1]);
    let said = abbe(&["measure", &machine, text(&shop.folder.with("good.csv", &good))]);
    assert!(said.contains("3 sets, 24 logged contacts at 69 mm/min") && said.contains("--out"), "{said}");
    let (code, said) = ask(&good, &["--format", "csv"]);
    assert!(code == 0 && said.is_empty());
    let near = "ball,ball.x [mm],ball.y [mm],ball.z [mm],A,C\nb1,0,0,50,0,0\nb2,0,30,50,0,0\n";
    let (code, said) = ask(near, &[]);
    assert!(code == 1 && said.contains("E0612") && said.contains("ball b1") && said.contains("too near to"), "{said}");
    let far = "ball,ball.x [mm],ball.y [mm],ball.z [mm],A,C\nb1,0,0,50,0,0\nb2,480,30,50,0,0\n";
    let (code, said) = ask(far, &[]);
    assert!(code == 1 && said.contains("ball b2") && said.contains("its travel"), "{said}");
    let steep = "ball,ball.x [mm],ball.y [mm],ball.z [mm],A,C\nb1,0,0,50,-90,0\n";
    let (code, said) = ask(steep, &[]);
    assert!(code == 1 && said.contains("the stem of a ball"), "{said}");
    let (code, said) = ask("X,Y,Z,dx [um]\n0,0,0,1\n", &[]);
    assert!(code == 1 && said.contains("takes balls and poses"), "{said}");
    let (code, said) = ask(&good, &["--stylus", "3 mm, 50 mm, 4 mm, 20 mm"]);
    assert!(code == 2 && said.contains("thinner than its ball"), "{said}");
    for (option, value, word) in [
        ("--stylus", "3 mm, 50 mm", "four lengths"),
        ("--servo-period", "0", "0.01 to 100 ms"),
        ("--ball-radius", "-1 mm", "above zero"),
    ] {
        let (code, said) = ask(&good, &[&format!("{option}={value}")]);
        assert!(code == 2 && said.contains(word), "{said}");
    }
    let renamed = shop.folder.with(
        "renamed.yaml",
        &table_table("  EX0C: 0 um\n").replace("C'", "C2'").replace("  C: {", "  C2: {").replace("EX0C", "EX0C2"),
    );
    let sets = shop.folder.with("renamed.csv", &good.replace("A,C\n", "A,C2\n"));
    let (code, said) = refused(&["measure", text(&renamed), text(&sets)]);
    assert!(code == 1 && said.contains("no letter for the axis C2"), "{said}");
}
