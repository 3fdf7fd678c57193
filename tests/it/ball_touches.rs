//! Touches of balls, from the log of a measuring program to errors. Oracle: the rigid-body model moves the linear axes
//! until the actual stylus meets the actual ball.

use crate::kinematic_parameters::{OF_HEADS, OF_TABLES, head_head, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::V3;
use crate::oracle::random::Random;
use crate::program::{Folder, abbe, json, refused, text};
use crate::support::config::sample;
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Radius of ball and stylus less the pre-travel, mm.
const RADIUS: f64 = 14.987;
/// Threefold lobing: with the cosine and the sine, mm.
const LOBE: [f64; 2] = [0.0016, -0.0012];
/// Standard deviation of a touch, mm.
const NOISE: f64 = 0.0005;

/// A touch: positions of the axes at contact by name, and where the nominal tip is.
#[derive(Clone)]
struct Touch {
    axes: Vec<(String, f64)>,
    nominal: V3,
}

/// A ball in a pose.
#[derive(Clone)]
struct Set {
    ball: usize,
    pose: usize,
    touches: Vec<Touch>,
    /// Its centre as the nominal machine sees it.
    centre: Vector3<f64>,
}

struct Plant {
    machine: Sample,
    balls: &'static [V3],
    /// Names and positions of the rotary axes.
    rotary: [&'static str; 2],
    poses: &'static [[f64; 2]],
}

impl Plant {
    fn walk(&self, at: &[(String, f64)]) -> Vec<f64> {
        let of = |name: &str| at.iter().find(|(axis, _)| axis == name).unwrap().1;
        self.machine.rigid.walk.iter().map(|axis| of(&axis.name)).collect()
    }

    /// Actual and nominal tip, and the actual rotation of the tool, workpiece frame.
    fn held(&self, at: &[(String, f64)]) -> ([Vector3<f64>; 2], Matrix3<f64>) {
        let held = self.machine.holds(&self.walk(at), Travel::Mean);
        let rotation = Matrix3::from_fn(|i, j| held[0].rotation[i][j]);
        (held.map(|held| Vector3::from(held.tip)), rotation)
    }

    /// Moves the linear axes until the actual tip is there.
    fn reach(&self, start: &[(String, f64)], there: Vector3<f64>) -> Vec<(String, f64)> {
        let mut at = start.to_vec();
        for _ in 0..4 {
            let here = self.held(&at).0[0];
            let column = |k: usize| {
                let mut other = at.clone();
                other[k].1 += 1.0;
                self.held(&other).0[0] - here
            };
            let step =
                Matrix3::from_columns(&[column(0), column(1), column(2)]).try_inverse().unwrap() * (there - here);
            (0..3).for_each(|k| at[k].1 += step[k]);
        }
        at
    }

    /// Touches every ball in every pose, at the pole and around, turned from set to set.
    fn campaign(&self, around: usize, turn: f64, seed: u64) -> Vec<Set> {
        let mut random = Random::new(seed);
        let mut sets = Vec::new();
        for (pose, turns) in self.poses.iter().enumerate() {
            for (ball, centre) in self.balls.iter().enumerate() {
                let centre = Vector3::from(*centre);
                let linear = ["X", "Y", "Z"].map(|name| (name.to_owned(), 0.0));
                let rotary = self.rotary.iter().zip(turns).map(|(name, q)| ((*name).to_owned(), *q));
                let middle = self.reach(&linear.into_iter().chain(rotary).collect::<Vec<_>>(), centre);
                let (tips, rotation) = self.held(&middle);
                let touch = |number: usize| {
                    let angle = number as f64 * std::f64::consts::TAU / around as f64 + sets.len() as f64 * turn;
                    let in_tool = match number {
                        0 => Vector3::z(),
                        _ => Vector3::new(angle.cos(), angle.sin(), 0.0),
                    };
                    let share = in_tool.xy().norm();
                    let lobe = share * (LOBE[0] * (3.0 * angle).cos() + LOBE[1] * (3.0 * angle).sin());
                    let noise = NOISE * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0);
                    let axes = self.reach(&middle, centre + rotation * in_tool * (RADIUS + lobe + noise));
                    let nominal = self.held(&axes).0[1].into();
                    Touch { axes, nominal }
                };
                let touches = (0..=around).map(touch).collect();
                sets.push(Set { ball, pose, touches, centre: tips[1] });
            }
        }
        sets
    }
}

fn table(test: &str) -> (Folder, PathBuf, Plant) {
    let folder = Folder::new(&format!("ball-touches-{test}"));
    let machine = sample(&folder.with("real.yaml", &table_table(OF_TABLES)));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    let balls = &[[62.0, 31.0, 45.0], [-74.0, 22.0, 80.0], [11.0, -85.0, 60.0]];
    let poses = &[
        [0.0, 0.0],
        [0.0, 97.0],
        [0.0, 200.0],
        [-40.0, 30.0],
        [-40.0, 150.0],
        [-40.0, 290.0],
        [-80.0, 60.0],
        [25.0, 250.0],
    ];
    (folder, plain, Plant { machine, balls, rotary: ["A", "C"], poses })
}

fn head() -> (Folder, PathBuf, Plant) {
    let folder = Folder::new("ball-touches-head");
    let machine = sample(&folder.with("real.yaml", &head_head(OF_HEADS)));
    let plain = folder.with("plain.yaml", &head_head("  EX0C: 0 um\n"));
    let balls = &[[220.0, 100.0, 45.0], [390.0, 180.0, 80.0], [300.0, 240.0, 60.0]];
    let poses = &[
        [0.0, 0.0],
        [97.0, 0.0],
        [190.0, 0.0],
        [30.0, 50.0],
        [-120.0, 50.0],
        [150.0, -50.0],
        [-60.0, -50.0],
        [10.0, 80.0],
    ];
    (folder, plain, Plant { machine, balls, rotary: ["C", "B"], poses })
}

/// A line of a touch: its own words and the positions of the axes.
fn numbers(touch: &Touch) -> String {
    touch.axes.iter().map(|(_, q)| format!(" {q:.9}")).collect()
}

fn log_of(sets: &[Set], positions: impl Fn(&Touch) -> String, coordinates: &str) -> String {
    let names: Vec<&str> = sets[0].touches[0].axes.iter().map(|(name, _)| name.as_str()).collect();
    let mut text =
        format!("abbe touches 1\naxes {}\ncoordinates {coordinates}\nsets {}\n", names.join(" "), sets.len());
    for set in sets {
        let name = format!("b{} p{}", set.ball + 1, set.pose + 1);
        text += &format!("begin {name}\n");
        for (touch, number) in set.touches.iter().zip(1..) {
            text += &format!("touch {name} {number}{} 1\n", positions(touch));
        }
        text += &format!("end {name}\n");
    }
    text
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn import(plain: &Path, log: &Path, more: &[&str]) -> Value {
    json(&[&["import", text(log), "--machine", text(plain), "--format", "json"][..], more].concat())
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|k, _| number(&value[k]))
}

/// Largest distance (mm) of centres from where they are.
fn farthest(found: &Value, sets: &[Set]) -> f64 {
    let centres = found["centres"].as_array().unwrap();
    assert_eq!(centres.len(), sets.len());
    let off = |(set, found): (&Set, &Value)| (vector(&found["centre_mm"]) - set.centre).norm();
    sets.iter().zip(centres).map(off).fold(0.0, f64::max)
}

#[test]
fn touches_tell_centres_the_probe_and_the_errors() {
    for (kind, (folder, plain, plant), errors) in [("table", table("errors"), OF_TABLES), ("head", head(), OF_HEADS)] {
        let sets = plant.campaign(7, std::f64::consts::FRAC_PI_6, 3);
        let log = folder.with("touches.log", &log_of(&sets, numbers, "joints"));
        let out = folder.file("touches.csv");
        let found = import(&plain, &log, &["--out", text(&out)]);
        let sigma = number(&found["sigma_um"]);
        assert!((sigma / (NOISE * 1e3) - 1.0).abs() < 0.2, "{kind}: {sigma}");
        let radius = number(&found["effective_radius_mm"]) - RADIUS;
        assert!(radius.abs() * 1e3 < 4.0 * number(&found["effective_radius_u_um"]), "{kind}: {radius}");
        let lobing = &found["lobing"];
        assert!(lobing["is_significant"] == true && lobing["is_determined"] == true, "{lobing}");
        for (part, wanted) in [("cos_um", LOBE[0]), ("sin_um", LOBE[1])] {
            assert!((number(&lobing[part]) - wanted * 1e3).abs() < 4.0 * number(&lobing["u_um"]), "{kind}: {lobing}");
        }
        // Centres against their covariance.
        let mut chi = 0.0;
        for (set, centre) in sets.iter().zip(found["centres"].as_array().unwrap()) {
            let off = (vector(&centre["centre_mm"]) - set.centre) * 1e3;
            let covariance = Matrix3::from_fn(|i, j| number(&centre["covariance_um2"][i][j]));
            chi += off.dot(&(covariance.try_inverse().unwrap() * off)) / (3 * sets.len()) as f64;
        }
        assert!((0.6..1.5).contains(&chi), "{kind}: {chi}");
        let names: Vec<&str> = errors.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
        let fit =
            ["identify", text(&plain), "--fit", &names.join(","), "--data", text(&out), "--format", "json", "--quiet"];
        let fit = json(&fit);
        let unknowns = fit["instruments"].as_array().unwrap();
        assert_eq!(unknowns.len(), 3 * plant.balls.len() + 3, "{unknowns:?}");
        assert!((0.8..1.2).contains(&number(&fit["sigma_um"])), "{}", fit["sigma_um"]);
        let mut chi = 0.0;
        let mut told = 0;
        for line in errors.lines() {
            let (name, wanted) = line.trim().split_once(": ").unwrap();
            let wanted: f64 = wanted.split(' ').next().unwrap().parse().unwrap();
            let own = fit["parameters"].as_array().unwrap().iter().find(|of| of["name"] == name).unwrap();
            // A head that is displaced as a whole is the place of the balls.
            if own["sigma"].is_null() {
                continue;
            }
            told += 1;
            let off = (number(&own["value"]) - wanted) / number(&own["sigma"]);
            assert!(off.abs() < 4.0, "{kind} {name}: {own}");
            chi += off * off / names.len() as f64;
        }
        assert!(chi < 2.5 && told >= 4 && (kind == "head" || told == 8), "{kind}: {chi} {told}");
        // A known distance of two balls counts from where their touches have them.
        let apart = (Vector3::from(plant.balls[0]) - Vector3::from(plant.balls[1])).norm();
        let known = format!("distance b1 b2 = {apart:.6} mm 1 um");
        let gauge = ["identify", text(&plain), "--fit", &names.join(","), "--prior", &known, "--data", text(&out)];
        let gauge = json(&[&gauge[..], &["--format", "json", "--quiet"]].concat());
        let known = gauge["known"].as_array().unwrap().iter();
        let known = known.filter(|of| of["name"] == "distance ball b1 ball b2").collect::<Vec<_>>();
        assert!(known.len() == 1 && number(&known[0]["deviations"]).abs() < 4.0, "{kind}: {known:?}");
    }
}

/// The same contacts as a probe file, and as places of the tip through a nominal module.
#[test]
fn other_logs_of_the_same_contacts_give_the_same_joints() {
    let (folder, plain, plant) = table("logs");
    let sets = plant.campaign(7, std::f64::consts::FRAC_PI_6, 5);
    let joints = folder.with("joints.log", &log_of(&sets, numbers, "joints"));
    let out = folder.file("joints.csv");
    let reference = import(&plain, &joints, &["--out", text(&out)]);
    assert!(farthest(&reference, &sets) < 0.003, "{reference}");
    // A module counts from where the gauge point is with all axes at 0.
    let tip = |touch: &Touch| -> String {
        let off: V3 = std::array::from_fn(|k| plant.machine.rigid.workpiece_origin[k] - plant.machine.rigid.gauge[k]);
        let place: String = (0..3).map(|k| format!(" {:.9}", touch.nominal[k] + off[k])).collect();
        place + &touch.axes[3..].iter().map(|(_, q)| format!(" {q:.9}")).collect::<String>()
    };
    let by_tip = folder.file("tip.csv");
    let tips = folder.with("tip.log", &log_of(&sets, tip, "tip"));
    import(&plain, &tips, &["--out", text(&by_tip)]);
    let rows = |file: &PathBuf| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(file).unwrap();
        let row = |line: &str| line.split(',').filter_map(|cell| cell.parse().ok()).collect();
        text.lines().skip(2).map(row).collect()
    };
    let (rows, by_tip) = (rows(&out), rows(&by_tip));
    assert_eq!(rows.len(), sets.len() * 8);
    for (a, b) in rows.iter().zip(&by_tip) {
        assert!(a.iter().zip(b).take(5).all(|(a, b)| (a - b).abs() < 1e-8), "{a:?} {b:?}");
    }
    let of = |touch: &Touch, name: &str| touch.axes.iter().find(|(axis, _)| axis == name).map_or(0.0, |(_, q)| *q);
    let line =
        |touch: &Touch| ["X", "Y", "Z", "A", "B", "C", "U", "V", "W"].map(|name| format!("{:.6}", of(touch, name)));
    let lines: Vec<String> = sets.iter().flat_map(|set| &set.touches).map(|touch| line(touch).join(" ")).collect();
    let probe = import(&plain, &folder.with("probe.txt", &lines.join("\n")), &[]);
    assert_eq!(probe["balls"], 3);
    assert!(farthest(&probe, &sets) < 0.003, "{probe}");
    assert_eq!(probe["centres"][4]["ball"], "2");
    // Text names the balls and the probe.
    let said = abbe(&["import", text(&joints), "--machine", text(&plain)]);
    assert!(said.contains("3 balls, 24 ball poses, 192 contacts") && said.contains("lobing of the probe "), "{said}");
    // Without the machine the log says what to do.
    let (code, said) = refused(&["import", text(&joints)]);
    assert!(code == 1 && said.contains("--machine MACHINE"), "{said}");
}

/// Four touches around each ball, at the same places, do not tell a lobing.
#[test]
fn four_touches_around_say_that_they_are_blind() {
    let (folder, plain, plant) = table("four");
    let log = folder.with("four.log", &log_of(&plant.campaign(4, 0.0, 7), numbers, "joints"));
    assert_eq!(import(&plain, &log, &[])["lobing"]["is_determined"], false);
    let said = abbe(&["import", text(&log), "--machine", text(&plain)]);
    assert!(said.contains("do not tell a threefold lobing"), "{said}");
}

/// Refused with a code and in these words.
fn is_refused(file: &Path, machine: &str, code: &str, words: &[&str]) {
    let (exit, said) = refused(&["import", text(file), "--machine", machine]);
    let name = file.display();
    assert!(exit == 1 && said.contains(code) && words.iter().all(|word| said.contains(word)), "{name}: {said}");
}

#[test]
fn spoiled_logs_are_refused_by_name() {
    let (folder, plain, plant) = table("spoiled");
    let sets = plant.campaign(7, std::f64::consts::FRAC_PI_6, 9);
    let good = log_of(&sets, numbers, "joints");
    let machine = text(&plain);
    let check = |name: &str, log: &str, code: &str, words: &[&str]| {
        let file = folder.with(&format!("{name}.log"), log);
        is_refused(&file, machine, code, words);
        file
    };
    let lines: Vec<&str> = good.lines().collect();
    let without = |from: usize, count: usize| [&lines[..from], &lines[from + count..]].concat().join("\n");
    // A touch that came out elsewhere, in this direction from its ball.
    let moved = |by: f64| {
        let mut sets = sets.clone();
        let set = &mut sets[5];
        let at: Vec<(String, f64)> = set.touches[3].axes.clone();
        let away = plant.held(&at).0[0] - Vector3::from(plant.balls[set.ball]);
        set.touches[3].axes = plant.reach(&at, Vector3::from(plant.balls[set.ball]) + away * (1.0 + by / away.norm()));
        log_of(&sets, numbers, "joints")
    };
    let shaft =
        check("shaft", &moved(0.035), "E0543", &["touch 4 of ball b3 in pose p2 is 3", "outside the ball: the shaft"]);
    check("miss", &moved(-4.0), "E0543", &["touch 4 of ball b3 in pose p2 is", "inside the ball: a miss"]);
    let taken =
        json(&["import", text(&shaft), "--machine", machine, "--accept", "suspect", "--format", "json", "--quiet"]);
    assert_eq!(taken["outliers"][0]["line"], 4 + 5 * 10 + 5);
    assert!((number(&taken["outliers"][0]["off_um"]) - 35.0).abs() < 4.0, "{}", taken["outliers"]);
    let marked = good.replacen(" 1\ntouch b1 p1 3", " 0\ntouch b1 p1 3", 1);
    check("marked", &marked, "E0509", &["touch 2 of ball b1 in pose p1 is a miss"]);
    check("cut", &lines[..lines.len() - 1].join("\n"), "E0509", &["ends early: 23 sets of 24"]);
    check("short", &lines[..lines.len() - 10].join("\n"), "E0509", &["ends early: 23 sets of 24"]);
    check("half", &(lines[..9].join("\n") + "\ntouch b1 p1 6 23.5"), "E0509", &["cut off"]);
    check(
        "twice",
        &(lines[..8].join("\n") + "\n" + &lines[4..].join("\n")),
        "E0509",
        &["ball b1 in pose p1 is begun twice"],
    );
    check("whole", &(lines[..14].join("\n") + "\n" + &lines[4..].join("\n")), "E0509", &["is measured twice"]);
    check("mingled", &(lines[..8].join("\n") + "\n" + &lines[14..].join("\n")), "E0509", &["is begun before ball b1"]);
    check("open", &without(4, 1), "E0509", &["ball b1 in pose p1 was not begun"]);
    check("closed", &without(4, 9), "E0509", &["ball b1 in pose p1 was not begun"]);
    check("axes", &good.replacen("axes X Y Z A C", "axes X Y Z A B", 1), "E0509", &["the machine"]);
    check("kind", &good.replacen("coordinates joints", "coordinates part", 1), "E0509", &["cut off"]);
    check("thin", &without(6, 5), "E0509", &["ball b1 in pose p1: its touches are no ball"]);
    let fast = lines[5].replacen("touch b1 p1 1", "touch b1 p1 9", 1);
    let mixed = [&lines[..6], &[fast.as_str()], &lines[6..]].concat().join("\n");
    check("mixed", &mixed, "E0509", &["fast and slow touches are mixed"]);
    let number_twice = good.replacen("touch b1 p1 4", "touch b1 p1 2", 1);
    check("number", &number_twice, "E0509", &["touch 2 of ball b1 in pose p1 is there twice"]);
    // What the program repeats after a break is no mistake.
    let again = lines[..8].join("\n") + "\nagain b1 p1\n" + &lines[5..].join("\n");
    let again = folder.with("again.log", &again);
    let (exit, said) = refused(&["import", text(&again), "--machine", machine, "--format", "csv"]);
    assert!(exit == 0 && said.contains("1 attempt that broke off"), "{said}");
}

/// Logs of another machine, of other coordinates and of another tool.
#[test]
fn logs_of_something_else_are_refused_by_name() {
    let (folder, plain, plant) = table("else");
    let sets = plant.campaign(7, std::f64::consts::FRAC_PI_6, 9);
    let good = log_of(&sets, numbers, "joints");
    let machine = text(&plain);
    let check = |name: &str, log: &str, code: &str, words: &[&str]| {
        is_refused(&folder.with(&format!("{name}.log"), log), machine, code, words);
    };
    let joints = folder.with("joints.log", &good);
    // Places of the tip for positions of the axes, and the other way round.
    let tip = |touch: &Touch| -> String {
        let place: String = (0..3).map(|k| format!(" {:.9}", touch.nominal[k])).collect();
        place + &touch.axes[3..].iter().map(|(_, q)| format!(" {q:.9}")).collect::<String>()
    };
    check("world", &log_of(&sets, tip, "joints"), "E0543", &["coordinates of the tip, not of the axes"]);
    let (exit, said) = refused(&["import", text(&joints), "--machine", machine, "--coordinates", "tip"]);
    assert!(exit == 1 && said.contains("not those of `--coordinates`"), "{said}");
    let probe: Vec<String> = sets
        .iter()
        .flat_map(|set| &set.touches)
        .map(|of| {
            let [x, y, z] = of.nominal;
            format!("{x:.6} {y:.6} {z:.6} {:.6} 0 {:.6} 0 0 0", of.axes[3].1, of.axes[4].1)
        })
        .collect();
    check("world-probe", &probe.join("\n"), "E0543", &["coordinates of the tip, not of the axes"]);
    let other = |of: &Touch, name: &str| of.axes.iter().find(|(axis, _)| axis == name).map_or(0.0, |(_, q)| *q);
    let row =
        |of: &Touch| ["X", "Y", "Z", "A", "B", "C"].map(|name| format!("{:.6}", other(of, name))).join(" ") + " 0 0 0";
    let rows: Vec<String> = sets.iter().flat_map(|set| &set.touches).map(row).collect();
    let lines_off =
        folder.with("off.yaml", &table_table("  EX0C: 0 um\n").replace("[250, 225, -380]", "[230, 225, -380]"));
    let (exit, said) =
        refused(&["import", text(&folder.with("off.txt", &rows.join("\n"))), "--machine", text(&lines_off)]);
    assert!(exit == 1 && said.contains("of 24 sets are at balls of their own"), "{said}");
    check("odd-probe", &probe[1..].join("\n"), "E0509", &["23 contacts in one pose, of sets of 8"]);
    check("no-probe", "1 2 3\n", "E0509", &["cut off"]);
    // A tool that is another one.
    let other = folder.with("other.yaml", &table_table("  EX0C: 0 um\n").replace("length: 120 mm", "length: 108 mm"));
    let file = folder.with("length.log", &good);
    let (exit, said) = refused(&["import", text(&file), "--machine", text(&other)]);
    assert!(
        exit == 1
            && said.contains("with a stylus 1")
            && said.contains("longer than the tool")
            && said.contains("length reference"),
        "{said}"
    );
    let other =
        folder.with("lines.yaml", &table_table("  EX0C: 0 um\n").replace("[250, 225, -380]", "[230, 225, -380]"));
    let (exit, said) = refused(&["import", text(&file), "--machine", text(&other)]);
    assert!(exit == 1 && said.contains("a ball is in one place to") && said.contains(" only"), "{said}");
    // Probe files have letters, and balls have four touches.
    let (exit, said) = refused(&["import", text(&file), "--machine", machine, "--touches", "3"]);
    assert!(exit == 2 && said.contains("4..=1000"), "{said}");
}
