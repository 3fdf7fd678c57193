//! Arrangements against brute force, and results that do not hang on how a run is cut.

use crate::configs::machine;
use crate::oracle::curves::Travel;
use crate::oracle::machines::{Sample, combinations};
use crate::oracle::matrix::norm;
use crate::oracle::random::Random;
use crate::oracle::rigid::Frame;
use crate::oracle::{program::Folder as Workshop, yaml};
use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use crate::support::sha256::sha256;
use abbe::analysis::Work;
use abbe::analysis::budget::{Distribution, Draws, NODES, Statistic, bounds, classes};
use abbe::analysis::enumerate::{Judge, Rule, Standing, Study, TooMany, buildable, walks};
use abbe::analysis::{ToolPose, inverse, rest};
use abbe::lower::sensitivities_to;
use abbe::machine::{AxisKind, AxisName, Branch, ErrorId, Machine, Pose, Travel as Way};
use serde_json::Value;
use std::io::BufRead;
use std::path::Path;

fn count(machine: &Machine, rotary: Option<usize>, rules: &[&str]) -> usize {
    let names: Vec<&AxisName> = machine.axes().iter().map(|axis| &axis.name).collect();
    let rules: Vec<Rule> = rules.iter().map(|text| Rule::parse(text, &names).unwrap()).collect();
    walks(machine, rotary, &rules).unwrap().iter().map(|walk| walk.tables.len()).sum()
}

#[test]
fn there_are_as_many_arrangements_as_there_should_be() {
    let (three, five) = (machine("gantry-3ax.yaml"), machine("trunnion.yaml"));
    assert_eq!((count(&three, None, &[]), count(&five, None, &[])), (24, 720));
    let study = crate::loaded::machine(&Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/examples/study.yaml"));
    assert_eq!((count(&study, Some(2), &[]), count(&study, Some(0), &[]), count(&study, None, &[])), (2160, 24, 5040));
    // Half of all walks have C before A; with at most one axis on the table there are 2 beds of 6.
    assert_eq!(count(&five, None, &["C before A"]), 360);
    assert_eq!(count(&five, None, &["at most 1 on table"]), 240);
    assert_eq!(count(&five, None, &["not at most 4 on table"]), 120);
    // Both on one side, A nearer to the bed: of 5 places for each pair of positions.
    let carries = count(&five, None, &["A carries C"]);
    let counted = (0..=5).map(|table| {
        let pairs = |n: usize| n * n.saturating_sub(1) / 2;
        (pairs(table) + pairs(5 - table)) * 6
    });
    assert_eq!(carries, counted.sum::<usize>());
    let robot = machine("hh-bd-ram.yaml");
    assert_eq!(count(&robot, Some(2), &[]), 3 * 720);
    assert_eq!(walks(&study, None, &[]).map(|w| w.len()), Ok(720));
}

/// The oracle's machine with its axes placed anew.
fn rearranged(sample: &Sample, sides: &[(AxisName, Branch)]) -> Sample {
    let index = |name: &AxisName| sample.rigid.walk.iter().position(|axis| axis.name == name.as_str()).unwrap();
    let mut other = sample.clone();
    other.rigid.walk = sides.iter().map(|(name, _)| sample.rigid.walk[index(name)].clone()).collect();
    other.rigid.walk.iter_mut().zip(sides).for_each(|(axis, (_, side))| axis.workpiece = *side == Branch::Workpiece);
    other.axes = sides.iter().map(|(name, _)| sample.axes[index(name)].clone()).collect();
    other
}

/// Poses that reach the work, of those that can.
fn reached(machine: &Machine, work: &[ToolPose]) -> Vec<Pose> {
    work.iter().filter_map(|target| inverse(machine, target, &rest(machine)).ok()).collect()
}

#[test]
fn given_errors_are_those_of_an_independent_model_placed_anew() {
    let mut random = Random::new(23);
    let mut judged = 0;
    for conventions in combinations().step_by(3) {
        let sample = Sample::random(&mut random, conventions, 1e-5);
        if sample.rigid.walk.len() > 4 {
            continue;
        }
        let folder = Workshop::new();
        let _ = yaml::write(&sample, &folder);
        let machine = crate::loaded::machine(&folder.path("machine.yaml"));
        let list = walks(&machine, None, &[]).unwrap();
        let study = Study::new(&machine, list.clone(), Judge::Errors, Statistic::Max, &Work::random(&machine, 12, 1));
        let round = study.round(0..1);
        for (step, walk) in list.iter().enumerate().step_by(5) {
            for (record, table) in round.step(step, None).iter().zip(&walk.tables) {
                let row = &record.row;
                if row.standing != Standing::Judged {
                    continue;
                }
                let sides = walk.sides(&machine, *table);
                let other = machine.rearranged(&sides).unwrap();
                assert_eq!(row.chain, other.chain().to_string());
                let model = rearranged(&sample, &sides);
                let poses = reached(&other, study.work());
                let length = |pose: &Pose| norm(model.evaluate(pose, Travel::Mean, Frame::Workpiece).deviation);
                let largest = poses.iter().map(length).fold(0.0, f64::max) * 1e3;
                // Rounding of both models, as in the tests of `eval`: 2e-11 mm.
                assert!((record.values[0] - largest).abs() < 2e-8, "{}: {row:?} {largest}", row.chain);
                assert_eq!(row.reached, poses.len());
                judged += 1;
            }
        }
    }
    println!("{judged} arrangements");
    assert!(judged > 40, "{judged}");
}

/// A drawn component error at a position, by hand: straight lines between the nodes.
fn at(curve: &[f64], axis: &abbe::machine::Axis, position: f64) -> f64 {
    let (min, max) = axis.travel.interval();
    let turn = if axis.travel == Way::Continuous { (position - min).rem_euclid(360.0) } else { position - min };
    let x = turn / (max - min) * (NODES - 1) as f64;
    let i = (x.floor() as usize).min(NODES - 2);
    curve[i] + (x - i as f64) * (curve[i + 1] - curve[i])
}

#[test]
fn budgets_are_those_of_one_machine_after_the_other() {
    // `direct` makes another ideal machine of every side; the KIMM preset has carried bodies and `body`.
    for (name, few) in [("trunnion.yaml", 40), ("papers/bui-kimm.yaml", 40), ("hmc-4ax.yaml", 40)] {
        let machine = machine(name);
        let class = classes().remove("production").unwrap();
        let bounds = bounds(&machine, Some(&class));
        let draws = Draws::new(9, Distribution::Uniform);
        let list = walks(&machine, None, &[]).unwrap();
        let judge = Judge::Budget { bounds: bounds.clone(), draws: draws.clone() };
        let study = Study::new(&machine, list.clone(), judge, Statistic::Max, &Work::random(&machine, few, 4));
        let mut judged = 0;
        // A round that begins and ends between the samples that are computed side by side.
        let (first, second) = (study.round(0..2), study.round(2..3));
        for (step, walk) in list.iter().enumerate().step_by(17) {
            let (begun, rest) = (first.step(step, None), second.step(step, None));
            for ((record, last), table) in begun.iter().zip(&rest).zip(&walk.tables).step_by(2) {
                let row = &record.row;
                assert_eq!(
                    (row, second.step(step, Some(&[*table])).as_slice()),
                    (&last.row, std::slice::from_ref(last))
                );
                if row.standing != Standing::Judged {
                    continue;
                }
                let other = machine.rearranged(&walk.sides(&machine, *table)).unwrap();
                let ids: Vec<ErrorId> = bounds.iter().map(|bound| bound.error.clone()).collect();
                let mut values = [0.0_f64; 3];
                for pose in reached(&other, study.work()) {
                    let effects = sensitivities_to(&other, &pose, &ids);
                    for (sample, value) in values.iter_mut().enumerate() {
                        let sum = effects.iter().zip(&bounds).fold(nalgebra::Vector3::zeros(), |sum, (s, bound)| {
                            let share = match other.axis_index(s.error.axis.as_str()) {
                                Some(i) if !s.error.is_location() => {
                                    let axis = &other.axes()[i];
                                    at(&draws.curve(&s.error, sample, axis.travel == Way::Continuous), axis, pose[i])
                                }
                                _ => draws.constant(&s.error, sample),
                            };
                            sum + s.deviation * (share * bound.tolerance)
                        });
                        *value = value.max(sum.norm() * 1e3);
                    }
                }
                let drawn: Vec<f64> = record.values.iter().chain(&last.values).copied().collect();
                assert_eq!(drawn.len(), 3);
                for (value, um) in values.iter().zip(&drawn) {
                    assert!((um - value).abs() < 1e-9 * value, "{name} {}: {drawn:?} {values:?}", row.chain);
                }
                judged += 1;
            }
        }
        println!("{name}: {judged}");
        assert!(judged >= 4, "{name}: {judged}");
    }
}

#[test]
fn the_arrangement_of_the_file_is_there_and_compares_with_itself() {
    for by in [&["--class", "production", "--samples", "40"][..], &[]] {
        let arguments = [&["enumerate", "gantry-3ax.yaml", "--poses", "60", "--format", "json"], by].concat();
        let result = json(&arguments);
        let rows = |key: &str| result[key].as_array().unwrap().clone();
        assert_eq!(result["arrangements"], 24);
        // The file states one side only: all others are apart.
        let groups = ["ranked", "reach_less", "geometry_not_stated", "cannot_turn_the_tool"];
        assert_eq!(groups.iter().map(|group| rows(group).len()).sum::<usize>(), 24);
        assert_eq!((rows("ranked").len(), rows("geometry_not_stated").len()), (6, 18));
        let own = rows("ranked").into_iter().find(|row| row["chain"] == result["chain"]).unwrap();
        assert_eq!((&own["minus_file"], &own["reached"]), (&Value::from(0.0), &Value::from(60)));
        let um: Vec<f64> = rows("ranked").iter().map(|row| row["um"].as_f64().unwrap()).collect();
        assert!(um.windows(2).all(|two| two[0] <= two[1]) && um[0] > 0.0);
    }
}

#[test]
fn what_cannot_turn_the_tool_is_listed_apart() {
    let result = json(&["enumerate", "trunnion.yaml", "--poses", "20", "--buildable", "no", "--format", "json"]);
    let apart: Vec<&str> =
        result["cannot_turn_the_tool"].as_array().unwrap().iter().map(|chain| chain.as_str().unwrap()).collect();
    // C turns about the tool axis at any place after A on the walk: half of all walks.
    assert_eq!(apart.len(), 360);
    assert!(apart.iter().all(|chain| chain.find('A') < chain.find('C')), "{apart:?}");
    assert!(apart.contains(&"w A' Y' b X Z C t"));
    let few = json(&[
        "enumerate",
        "trunnion.yaml",
        "--poses",
        "20",
        "--require",
        "C before A",
        "--max-table",
        "2",
        "--buildable",
        "no",
        "--format",
        "json",
    ]);
    assert_eq!((&few["arrangements"], few["cannot_turn_the_tool"].as_array().unwrap().len()), (&180.into(), 0));
    for row in few["ranked"].as_array().unwrap() {
        let chain = row["chain"].as_str().unwrap();
        assert!(row["on_table"].as_u64().unwrap() <= 2 && chain.matches('\'').count() <= 2, "{chain}");
    }
}

const STUDY: [&str; 9] =
    ["enumerate", "hmc-4ax.yaml", "--class", "production", "--poses", "30", "--samples", "50", "--format"];

/// The study with more arguments, as bytes.
fn study(threads: usize, more: &[&str]) -> Vec<u8> {
    let output = abbe_on(threads, &[&STUDY[..], &["json"], more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

#[test]
fn results_are_the_same_however_the_run_is_cut() {
    let folder = Folder::new("enumerate-cut");
    let whole = study(1, &[]);
    assert_eq!(whole, study(3, &[]), "threads");
    let parts: Vec<_> = (1..=3).map(|i| folder.file(&format!("part{i}.json"))).collect();
    for (i, path) in parts.iter().enumerate() {
        let said: Value =
            serde_json::from_slice(&study(2, &["--shard", &format!("{}/3", i + 1), "--state", text(path)])).unwrap();
        assert_eq!((&said["walks"], &said["walks_done"], &said["round"]), (&24.into(), &8.into(), &1.into()));
    }
    let paths: Vec<&str> = parts.iter().map(|path| text(path)).collect();
    assert_eq!(whole, study(2, &[&["--merge"], &paths[..]].concat()), "merged");
    assert_eq!(whole, study(2, &["--merge", paths[2], paths[0], paths[1]]), "in another order");
    // Parts that are not all there.
    let (code, message) = refused(&[&STUDY[..], &["json", "--merge", paths[0], paths[2]]].concat());
    assert!(code == 1 && message.contains("E0611") && message.contains("8 of 24"), "{message}");
    // Shards of every round, each from the parts of the round before.
    let mut last = 1;
    for _ in 0..4 {
        let mut rounds = Vec::new();
        for (i, path) in paths.iter().enumerate() {
            let part = format!("{}/3", i + 1);
            let merge = [&["--shard", &part, "--state", path, "--merge"], &paths[..]].concat();
            let said: Value = serde_json::from_slice(&study(2, &merge)).unwrap();
            rounds.push(said["round"].as_u64());
        }
        let Some(round) = rounds[2] else { break };
        assert!(round >= last, "{rounds:?}");
        last = round;
    }
    assert!(last >= 2, "{last}");
    assert_eq!(whole, study(2, &[&["--merge"], &paths[..]].concat()), "all rounds in parts");
    // A part is taken up again, and finished.
    assert_eq!(whole, study(2, &["--state", paths[1]]), "resumed");
    let lines = std::fs::read_to_string(&parts[1]).unwrap();
    assert!(lines.lines().count() > 25, "later rounds are kept too");
    assert_eq!(whole, study(1, &["--state", paths[1]]), "nothing left to do");
}

#[test]
fn an_interrupted_run_leaves_a_whole_file_and_goes_on() {
    let folder = Folder::new("enumerate-kill");
    let state = folder.file("state.json");
    let more = ["--poses", "400", "--samples", "120"];
    let arguments = [&STUDY[..4], &more, &["--format", "json"]].concat();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_abbe"))
        .args(&arguments)
        .args(["--state", text(&state)])
        .current_dir(crate::configs::folder())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    // Ends as soon as the first results are kept; if the run was faster, there is nothing to resume.
    while !state.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let _ = child.kill();
    child.wait().unwrap();
    let kept = std::fs::read_to_string(&state).unwrap();
    assert!(kept.ends_with('\n') && kept.lines().all(|line| serde_json::from_str::<Value>(line).is_ok()));
    let whole = abbe(&arguments);
    assert_eq!(whole, abbe(&[&arguments[..], &["--state", text(&state)]].concat()));
}

/// The first record of a line of a state file that has values.
fn judged(line: &mut serde_json::Value) -> &mut serde_json::Value {
    let mut records = line["records"].as_array_mut().unwrap().iter_mut();
    records.find(|record| record["row"]["standing"] == "judged").unwrap()
}

/// The records of a state file.
fn state_of(text: &str) -> Vec<serde_json::Value> {
    text.lines().skip(1).map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn foreign_and_damaged_state_is_refused_and_left_alone() {
    let folder = Folder::new("enumerate-state");
    let state = folder.file("state.json");
    let _ = study(2, &["--shard", "1/4", "--state", text(&state)]);
    let kept = std::fs::read_to_string(&state).unwrap();
    let says = |content: &str, more: &[&str], words: &str| {
        std::fs::write(&state, content).unwrap();
        let (code, message) = refused(&[&STUDY[..], &["json", "--state", text(&state)], more].concat());
        assert!(code == 1 && message.contains("E0610") && message.contains(words), "{message}");
        assert_eq!(std::fs::read_to_string(&state).unwrap(), content);
    };
    says(&kept, &["--seed", "2"], "another study");
    says(&kept, &["--statistic", "p95"], "another study");
    says("", &[], "empty");
    says("no json\n", &[], "line 1");
    says(&kept[..kept.len() - 9], &[], "line 7");
    says(&kept.replacen("\"step\":0", "\"step\":999", 1), &[], "walk 999");
    says(&kept, &["--max-samples", "70"], "another study");
    says(&kept, &["--first", "2"], "another study");
    let second = kept.lines().nth(1).unwrap();
    says(&format!("{kept}{second}\n"), &[], "twice");
    // Altered, impossible and missing records.
    let (at, end) = (kept.find("\"values\":[").unwrap() + 10, kept.len());
    let digit = at + kept[at..end].find(|c: char| c.is_ascii_digit()).unwrap();
    says(&format!("{}9{}", &kept[..digit], &kept[digit..]), &[], "checksum");
    says(&format!("{}-{}", &kept[..digit], &kept[digit..]), &[], "below zero");
    says(&kept.replacen(&format!("{second}\n"), "", 1), &[], "checksum");
    // Impossible records with the checksum of themselves.
    let forged = |change: &dyn Fn(&mut serde_json::Value)| {
        let (head, lines) = kept.split_once('\n').unwrap();
        let (line, others) = lines.split_once('\n').unwrap();
        let mut record: serde_json::Value = serde_json::from_str(line).unwrap();
        change(&mut record);
        let lines = format!("{record}\n{others}");
        let mut head: serde_json::Value = serde_json::from_str(head).unwrap();
        head["sha256"] = sha256(lines.as_bytes()).into();
        format!("{head}\n{lines}")
    };
    assert_eq!(state_of(&forged(&|_| {})), state_of(&kept), "an honest record is one");
    let row = |name: &'static str, value: serde_json::Value| forged(&|of| judged(of)["row"][name] = value.clone());
    says(&row("reached", 9999.into()), &[], "tool poses");
    says(&row("chain", "w b C X Y Q t".into()), &[], "it has no arrangement `w b C X Y Q t`");
    says(&row("table", 77.into()), &[], "its arrangements are not those of the walk");
    says(&row("standing", "reaches_nothing".into()), &[], "reaches another number");
    says(&row("rewinds", 3.into()), &[], "has rewinds that no path has");
    says(&row("not_stated", serde_json::json!(["X"])), &[], "only the end of a study");
    says(&row("travel", serde_json::json!([{"axis": "X", "min": 0, "max": 1}])), &[], "travels that it does not need");
    let first = |change: &dyn Fn(&mut Vec<serde_json::Value>)| {
        forged(&|of| change(judged(of)["values"].as_array_mut().unwrap()))
    };
    says(&first(&|values| drop(values.pop())), &[], "has 49 values of 50 machines");
    says(&first(&|values| values.push(1.into())), &[], "has 51 values of 50 machines");
    says(&first(&|values| values.clear()), &[], "has 0 values of 50 machines");
    says(&forged(&|of| drop(of["records"].as_array_mut().unwrap().pop())), &[], "not those of the walk");
    says(&forged(&|of| of["records"].as_array_mut().unwrap().reverse()), &[], "not those of the walk");
    says(&forged(&|of| of["round"] = 77.into()), &[], "walk 0 of round 77");
    let merged = row("reached", 9999.into());
    let part = folder.with("part.json", &merged);
    let fresh = folder.file("fresh.json");
    let (code, message) = refused(&[&STUDY[..], &["json", "--state", text(&fresh), "--merge", text(&part)]].concat());
    assert!(code == 1 && message.contains("E0610"), "{message}");
}

#[test]
fn what_makes_no_study_is_refused() {
    let says = |arguments: &[&str], words: &[&str]| {
        let (code, message) = refused(&[&["enumerate"], arguments].concat());
        assert!(code == 1 && words.iter().all(|word| message.contains(word)) && message.contains("help"), "{message}");
    };
    let none = [&STUDY[..], &["json", "--state", "none/state.json"]].concat();
    let (code, message) = refused(&none);
    assert!(code == 1 && message.contains("E0810"), "{message}");
    says(&["trunnion.yaml", "--require", "C under A"], &["E0608", "C under A"]);
    says(&["trunnion.yaml", "--require", "Q before A"], &["E0608", "`Q` is no axis"]);
    says(&["trunnion.yaml", "--require", "C on table", "--max-table", "0"], &["E0609"]);
    says(&["trunnion.yaml", "--by", "budget"], &["E0604"]);
    let folder = Folder::new("enumerate-nothing");
    let nowhere = folder.with("nowhere.csv", "X,Y,Z\n9000,0,0\n");
    says(&["trunnion.yaml", "--class", "production", "--tool-poses", text(&nowhere)], &["E0613", "X short by"]);
    says(&["trunnion.yaml", "--poses", "100000", "--samples", "10000"], &["E0606", "1000000000"]);
    for usage in [
        &["--shard", "4/3", "--state", "x"][..],
        &["--shard", "1/2"],
        &["--reach", "120"],
        &["--poses", "0"],
        &["--rotary", "3"],
    ] {
        assert_eq!(refused(&[&["enumerate", "trunnion.yaml"], usage].concat()).0, 2, "{usage:?}");
    }
    let folder = Folder::new("enumerate-many");
    let names: Vec<String> = (0..9).map(|i| format!("X{i}")).collect();
    let axes: Vec<String> = names.iter().map(|name| format!("{name}: {{ travel: [0, 9] }}")).collect();
    let many = folder.with(
        "many.yaml",
        &format!(
            "abbe: 1\nmachine: M\nchain: w b {} t\naxes: {{ {} }}\nerrors: {{ EX0X1: 1 um, EXX2: 1 um }}\n",
            names.join(" "),
            axes.join(", ")
        ),
    );
    // 9! * 10.
    says(&[text(&many)], &["E0607", "3628800"]);
    let machine = crate::loaded::machine(&many);
    assert_eq!(walks(&machine, None, &[]), Err(TooMany::Before(3_628_800)));
    let still = folder.with(
        "still.yaml",
        "abbe: 1\nmachine: M\nchain: w b X t\naxes: { X: { travel: [0, 50], origin: [0, 0, 0] } }\nvolume: { X: [7, 7] }\nerrors: { EXX: 1 um }\n",
    );
    says(&[text(&still)], &["E0403"]);
}

#[test]
fn machines_are_rearranged_as_a_file_would_say() {
    let machine = machine("trunnion.yaml");
    let folder = crate::configs::folder();
    let workshop = Workshop::new();
    // The same arrangement by `extends` and a chain of its own.
    let variant = workshop.write(
        "variant.yaml",
        &format!("abbe: 1\nextends: {}\nchain: \"w A' C' b Z Y X t\"\n", folder.join("trunnion.yaml").display()),
    );
    let by_file = crate::loaded::machine(&variant);
    let side = |name: &str, branch| (AxisName::new(name).unwrap(), branch);
    let (w, t) = (Branch::Workpiece, Branch::Tool);
    let by_hand = machine.rearranged(&[side("A", w), side("C", w), side("Z", t), side("Y", t), side("X", t)]).unwrap();
    assert_eq!(by_hand.chain().to_string(), by_file.chain().to_string());
    assert_eq!(by_hand.axes(), by_file.axes());
    assert_eq!(by_hand.volume(), by_file.volume());
    for axis in 0..5 {
        assert_eq!(by_hand.axis_errors(axis), by_file.axis_errors(axis));
    }
    assert!(machine.rearranged(&[side("X", t), side("X", t)]).is_none());
    assert!(machine.rearranged(&[side("X", t), side("Y", w)]).is_none());
    assert!(machine.rearranged(&[side("Q", t)]).is_none() && machine.rearranged(&[]).is_none());
    // Removed with its errors.
    let fewer = machine.rearranged(&[side("Z", t), side("Y", t), side("X", t)]).unwrap();
    assert!(fewer.axes().iter().all(|axis| axis.kind == AxisKind::Linear));
    assert!(fewer.errors().all(|(error, _)| error.axis.as_str().len() == 1 && !"AC".contains(error.axis.as_str())));
}

/// Rules of what can be built, by brute force over all arrangements of a machine of three linear and two rotary axes.
#[test]
fn what_is_hardly_built_is_counted_and_left_out() {
    let machine = machine("trunnion.yaml");
    let all = walks(&machine, None, &[]).unwrap();
    let is_rotary = |axis: usize| ["A", "C"].contains(&machine.axes()[axis].name.as_str());
    // Listed from the workpiece on; the file has no linear axis above a rotary one.
    let broken = |axes: &[usize], table: usize| {
        let above = (0..table).any(|i| !is_rotary(axes[i]) && (i + 1..table).any(|j| is_rotary(axes[j])));
        if above {
            Some(0)
        } else if table > 4 {
            Some(1)
        } else {
            None
        }
    };
    let mut counts = [0; 3];
    let mut left = Vec::new();
    for walk in &all {
        for table in &walk.tables {
            match broken(&walk.axes, *table) {
                Some(rule) => counts[rule] += 1,
                None => left.push((walk.axes.clone(), *table)),
            }
        }
    }
    let (found, excluded) = buildable(&machine, all);
    assert_eq!(excluded, counts);
    let found: Vec<(Vec<usize>, usize)> =
        found.iter().flat_map(|walk| walk.tables.iter().map(|table| (walk.axes.clone(), *table))).collect();
    assert_eq!(found, left);
    let own: Vec<usize> = (0..machine.axes().len()).collect();
    let on_table = machine.axes().iter().filter(|axis| axis.branch == Branch::Workpiece).count();
    assert!(found.contains(&(own, on_table)));
}

/// 720 orders of six axes at 20 tool poses, said before the first of them is sought.
#[test]
fn the_study_of_a_robot_says_what_it_costs_before_it_begins() {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.args(["enumerate", "configs/robots/ur5.yaml", "--poses", "20", "--samples", "20"]);
    command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped());
    let mut study = command.spawn().unwrap();
    let mut said = String::new();
    std::io::BufReader::new(study.stderr.take().unwrap()).read_line(&mut said).unwrap();
    study.kill().unwrap();
    study.wait().unwrap();
    assert!(said.starts_with("14400 searches for poses of arms, some 9.6 min on one core"), "{said}");
}
