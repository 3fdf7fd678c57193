//! Tool poses as one path, against own inverse kinematics in closed form and exhaustive search over all sequences.

use crate::oracle::curves::Travel;
use crate::oracle::random::Random;
use crate::oracle::rigid::Frame;
use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use crate::support::config;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

type V3 = [f64; 3];

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn minus(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: V3, b: V3) -> f64 {
    a.iter().zip(&b).map(|(a, b)| a * b).sum()
}

fn norm(a: V3) -> f64 {
    dot(a, a).sqrt()
}

fn mixed(a: V3, b: V3, t: f64) -> V3 {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Turns a vector about X, Y or Z (0, 1, 2) by an angle, deg.
fn turned(axis: usize, degrees: f64, v: V3) -> V3 {
    let (s, c) = degrees.to_radians().sin_cos();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut out = v;
    (out[i], out[j]) = (c * v[i] - s * v[j], s * v[i] + c * v[j]);
    out
}

/// A row of a path: tip and direction.
type Row = (V3, V3);

/// A machine of two rotary axes about letters, and three linear ones, all in one walk from workpiece to tool.
struct Own {
    /// Letter (0 to 2), true for rotary, origin, travel (None for endless); in the order of the walk.
    axes: Vec<(usize, bool, V3, Option<[f64; 2]>)>,
    on_table: usize,
    gauge: V3,
    length: f64,
    workpiece: V3,
}

impl Own {
    fn rotary(&self) -> [usize; 2] {
        let list: Vec<usize> = (0..5).filter(|i| self.axes[*i].1).collect();
        [list[0], list[1]]
    }

    fn text(&self) -> String {
        let name = |(letter, rotary, ..): &(usize, bool, V3, Option<[f64; 2]>)| {
            ["X", "Y", "Z", "A", "B", "C"][letter + if *rotary { 3 } else { 0 }]
        };
        let mut walk = String::from("w ");
        let mut axes = String::new();
        for (i, axis) in self.axes.iter().enumerate() {
            if i == self.on_table {
                walk += "b ";
            }
            walk += &format!("{}{} ", name(axis), if i < self.on_table { "'" } else { "" });
            let travel = axis.3.map_or("continuous".to_owned(), |[a, b]| format!("[{a}, {b}]"));
            writeln!(axes, "  {}: {{ travel: {travel}, origin: {:?} }}", name(axis), axis.2).unwrap();
        }
        if self.on_table == 5 {
            walk += "b ";
        }
        let (gauge, length, workpiece) = (self.gauge, self.length, self.workpiece);
        format!(
            "abbe: 1\nmachine: M\nchain: \"{walk}t\"\naxes:\n{axes}tool: {{ gauge: {gauge:?}, length: {length} mm }}\n\
             workpiece: {{ origin: {workpiece:?} }}\nerrors: {{ EC0Y: 10 urad }}\n"
        )
    }

    /// Direction of the tool at rotary positions.
    fn direction(&self, pose: &[f64]) -> V3 {
        self.axes.iter().zip(pose).rev().fold(
            [0.0, 0.0, 1.0],
            |d, (axis, q)| {
                if axis.1 { turned(axis.0, *q, d) } else { d }
            },
        )
    }

    /// Tip from the workpiece origin.
    fn tip(&self, pose: &[f64]) -> V3 {
        let mut p = self.gauge;
        p[2] -= self.length;
        for ((letter, rotary, origin, _), q) in self.axes.iter().zip(pose).rev() {
            if *rotary {
                let about = turned(*letter, *q, minus(p, *origin));
                p = std::array::from_fn(|i| origin[i] + about[i]);
            } else {
                p[*letter] += q;
            }
        }
        minus(p, self.workpiece)
    }

    fn within(&self, axis: usize, q: f64) -> bool {
        self.axes[axis].3.is_none_or(|[a, b]| q >= a - 1e-9 && q <= b + 1e-9)
    }

    /// The pose with linear axes for a tip; None beyond their travel.
    fn placed(&self, tip: V3, rotary: [f64; 2]) -> Option<Vec<f64>> {
        let mut pose = vec![0.0; 5];
        self.rotary().iter().zip(rotary).for_each(|(axis, q)| pose[*axis] = q);
        let linear: Vec<usize> = (0..5).filter(|i| !self.axes[*i].1).collect();
        let start = self.tip(&pose);
        let columns: Vec<V3> = linear
            .iter()
            .map(|axis| {
                let mut moved = pose.clone();
                moved[*axis] = 1.0;
                minus(self.tip(&moved), start)
            })
            .collect();
        let way = minus(tip, start);
        let whole = dot(columns[0], cross(columns[1], columns[2]));
        for k in 0..3 {
            let mut with = columns.clone();
            with[k] = way;
            pose[linear[k]] = dot(with[0], cross(with[1], with[2])) / whole;
        }
        linear.iter().all(|axis| self.within(*axis, pose[*axis])).then_some(pose)
    }

    /// The two solutions of the rotary axes, deg, by the formulas of each pair.
    fn solutions(&self, d: V3) -> [[f64; 2]; 2] {
        let [first, second] = self.rotary().map(|axis| self.axes[axis].0);
        [1.0, -1.0].map(|sign: f64| match (first, second) {
            // d = Rz(c) Rx(a) z = (sin c sin a, -cos c sin a, cos a)
            (2, 0) => [(d[0] * sign).atan2(-d[1] * sign).to_degrees(), sign * d[2].acos().to_degrees()],
            // d = Rz(c) Ry(b) z = (cos c sin b, sin c sin b, cos b)
            (2, 1) => [(d[1] * sign).atan2(d[0] * sign).to_degrees(), sign * d[2].acos().to_degrees()],
            // d = Rx(a) Ry(b) z = (sin b, -sin a cos b, cos a cos b)
            (0, 1) => {
                let b = d[0].asin();
                let b = if sign > 0.0 { b } else { std::f64::consts::PI - b };
                [(-d[1] * sign).atan2(d[2] * sign).to_degrees(), b.to_degrees()]
            }
            other => panic!("{other:?}"),
        })
    }

    /// All poses for a row; endless axes over `turns` to either side.
    fn candidates(&self, (tip, d): &Row, turns: i32) -> Vec<Vec<f64>> {
        let mut list = Vec::new();
        let rotary = self.rotary();
        for solution in self.solutions(*d) {
            let shifted = |k: usize| -> Vec<f64> {
                let range = if self.axes[rotary[k]].3.is_none() { turns } else { 4 };
                let all = (-range..=range).map(|turn| solution[k] + 360.0 * f64::from(turn));
                all.filter(|q| self.within(rotary[k], *q)).collect()
            };
            for p in shifted(0) {
                for q in shifted(1) {
                    list.extend(self.placed(*tip, [p, q]));
                }
            }
        }
        list
    }

    /// True if the tool leaves the path between two rows: the rule of docs/formats/jobs.md.
    fn is_rewind(&self, (from, a): (&Row, &[f64]), (to, b): (&Row, &[f64])) -> bool {
        let rotary = self.rotary();
        let most = rotary.iter().map(|i| (b[*i] - a[*i]).abs()).fold(0.0, f64::max);
        let pieces = (most / 30.0).ceil().max(2.0) as i32;
        let far = norm(minus(from.1, to.1)) + 1e-5;
        (1..pieces).any(|k| {
            let t = f64::from(k) / f64::from(pieces);
            let at = rotary.map(|i| a[i] + (b[i] - a[i]) * t);
            let mut pose = vec![0.0; 5];
            rotary.iter().zip(at).for_each(|(i, q)| pose[*i] = q);
            let d = self.direction(&pose);
            let left = norm(minus(d, from.1)) > far || norm(minus(d, to.1)) > far;
            left || (most > 30.0 && self.placed(mixed(from.0, to.0, t), at).is_none())
        })
    }

    fn cost(&self, rows: &[Row], poses: &[Vec<f64>]) -> (usize, f64) {
        let mut cost = (0, 0.0);
        for k in 1..rows.len() {
            let (a, b) = (&poses[k - 1], &poses[k]);
            cost.0 += usize::from(self.is_rewind((&rows[k - 1], a), (&rows[k], b)));
            cost.1 += a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
        }
        cost
    }

    /// The least cost over all sequences, each of them tried.
    fn least(&self, rows: &[Row]) -> (usize, f64) {
        let candidates: Vec<Vec<Vec<f64>>> = rows.iter().map(|row| self.candidates(row, 1)).collect();
        let steps: Vec<Vec<Vec<(usize, f64)>>> = (1..rows.len())
            .map(|k| {
                let to = |a: &Vec<f64>| {
                    let one = |b: &Vec<f64>| self.cost(&rows[k - 1..=k], &[a.clone(), b.clone()]);
                    candidates[k].iter().map(one).collect()
                };
                candidates[k - 1].iter().map(to).collect()
            })
            .collect();
        let mut best = (usize::MAX, f64::MAX);
        let mut open: Vec<(usize, usize, usize, f64)> = (0..candidates[0].len()).map(|i| (0, i, 0, 0.0)).collect();
        while let Some((k, i, rewinds, motion)) = open.pop() {
            if k + 1 == rows.len() {
                if rewinds < best.0 || (rewinds == best.0 && motion < best.1) {
                    best = (rewinds, motion);
                }
                continue;
            }
            for (j, step) in steps[k][i].iter().enumerate() {
                open.push((k + 1, j, rewinds + step.0, motion + step.1));
            }
        }
        best
    }
}

/// A random machine: head, table or both, with random pivots and travels.
fn random_machine(random: &mut Random) -> Own {
    let pair = [(2, 0), (2, 1), (0, 1)][random.below(3)];
    let travel = |random: &mut Random, endless: bool| {
        if endless && random.chance(0.3) {
            return None;
        }
        Some([-random.between(30.0, 380.0).round(), random.between(30.0, 380.0).round()])
    };
    let first = (pair.0, true, random.vector(100.0), travel(random, true));
    let second = (pair.1, true, random.vector(100.0), travel(random, false));
    let mut linear: Vec<usize> = vec![0, 1, 2];
    random.shuffle(&mut linear);
    let slides: Vec<_> = linear
        .into_iter()
        .map(|letter| {
            let half = if random.chance(0.2) { 150.0 } else { 2000.0 };
            (letter, false, [0.0; 3], Some([-half, half]))
        })
        .collect();
    let (mut axes, on_table) = match random.below(3) {
        0 => (vec![], random.below(4)),
        1 => (vec![first, second], 2),
        _ => (vec![first], 1),
    };
    let done = axes.len();
    axes.extend(slides);
    axes.extend([first, second].into_iter().skip(done));
    Own { axes, on_table, gauge: random.vector(50.0), length: 80.0, workpiece: random.vector(50.0) }
}

/// A part of a circle of directions about Z, in large steps: too much for short travels.
fn random_circle(random: &mut Random, count: usize) -> Vec<Row> {
    let (tilt, start) = (random.between(10.0, 40.0), random.between(0.0, 360.0));
    let (step, sense) = (random.between(20.0, 80.0), if random.chance(0.5) { 1.0 } else { -1.0 });
    let row = |k: usize| {
        let at = |v: V3| turned(2, start + sense * step * k as f64, v);
        (at([50.0, 0.0, 20.0]), at(turned(1, tilt, [0.0, 0.0, 1.0])))
    };
    (0..count).map(row).collect()
}

/// A random path: sizes of steps over three decades, sometimes across a pole.
fn random_path(random: &mut Random, count: usize) -> Vec<Row> {
    let size = 10.0_f64.powf(random.between(-2.0, 0.0));
    let tilt = if random.chance(0.4) { 0.1 } else { 1.0 };
    let (mut tip, mut d) = (random.vector(60.0), random.vector(tilt));
    d[2] = 1.0;
    (0..count)
        .map(|_| {
            tip = std::array::from_fn(|i| tip[i] + random.around(10.0) + 0.0 * i as f64);
            d = std::array::from_fn(|i| d[i] + random.around(size) * if i == 2 { 0.1 } else { 1.0 });
            let length = norm(d);
            (tip, d.map(|x| x / length))
        })
        .collect()
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from("X [mm],Y [mm],Z [mm],I,J,K\n");
    for (tip, d) in rows {
        writeln!(text, "{:?},{:?},{:?},{:?},{:?},{:?}", tip[0], tip[1], tip[2], d[0], d[1], d[2]).unwrap();
    }
    text
}

/// `eval` of a table as one path: the poses in the order of the axes, and the events.
fn along(folder: &Folder, machine: &Path, rows: &[Row]) -> (Vec<Vec<f64>>, Value) {
    let _ = folder.with("rows.csv", &table(rows));
    let job = folder.with("job.yaml", "tool_poses: rows.csv\npath: true\nreference: machine\n");
    let found = json(&["eval", text(machine), "--job", text(&job), "--format", "json", "--quiet"]);
    assert_eq!(found["over"]["path"], true);
    let axes = |pose: &Value| pose["axes"].as_object().unwrap().values().map(number).collect();
    (found["poses"].as_array().unwrap().iter().map(axes).collect(), found["path"].clone())
}

#[test]
fn no_sequence_of_branches_has_fewer_rewinds_or_less_motion() {
    let folder = Folder::new("paths-brute-force");
    let mut random = Random::new(403);
    let (mut compared, mut with_rewinds) = (0, 0);
    for _ in 0..240 {
        let own = random_machine(&mut random);
        let path = if random.chance(0.5) { random_circle(&mut random, 6) } else { random_path(&mut random, 5) };
        let rows: Vec<Row> = path.into_iter().filter(|row| !own.candidates(row, 0).is_empty()).collect();
        let sequences: usize = rows.iter().map(|row| own.candidates(row, 1).len()).product();
        if rows.len() < 3 || sequences > 3_000_000 {
            continue;
        }
        let machine = folder.with("machine.yaml", &own.text());
        let (poses, path) = along(&folder, &machine, &rows);
        assert_eq!(poses.len(), rows.len(), "{}", own.text());
        for (pose, (tip, d)) in poses.iter().zip(&rows) {
            let off = norm(minus(own.tip(pose), *tip)).max(norm(minus(own.direction(pose), *d)));
            assert!(off < 1e-8 && (0..5).all(|axis| own.within(axis, pose[axis])), "{off} {pose:?}");
        }
        let least = own.least(&rows);
        let cost = own.cost(&rows, &poses);
        let near = (cost.1 - least.1).abs() < 1e-4;
        assert!(cost.0 == least.0 && near, "{cost:?} for {least:?}\n{}{}{poses:?}", own.text(), table(&rows));
        assert_eq!(path["rewinds"].as_array().unwrap().len(), cost.0);
        let motion: f64 = path["axes"].as_array().unwrap().iter().map(|axis| number(&axis["motion"])).sum();
        assert!((motion - cost.1).abs() < 1e-6);
        compared += 1;
        with_rewinds += usize::from(cost.0 > 0);
    }
    assert!(compared > 150 && with_rewinds > 10, "{compared} {with_rewinds}");
}

/// A path as verbs without deviations state it.
fn without_step(path: &Value) -> Value {
    let mut path = path.clone();
    assert!(path.as_object_mut().unwrap().remove("deviation_step").is_some());
    path
}

/// A circle of a cone frustum: half apex 15 deg, axis tilted by 10 deg, in steps of `step` deg.
fn cone(count: usize, step: f64) -> Vec<Row> {
    let (s, c) = 15.0_f64.to_radians().sin_cos();
    let row = |k: usize| {
        let (sine, cosine) = (k as f64 * step).to_radians().sin_cos();
        let tip = turned(1, 10.0, [40.0 * cosine, 40.0 * sine, 0.0]);
        ([tip[0], tip[1], tip[2] + 120.0], turned(1, 10.0, [-s * cosine, -s * sine, c]))
    };
    (0..count).map(row).collect()
}

/// The gantry of `configs` with another travel of C.
fn gantry(folder: &Folder, travel: &str) -> PathBuf {
    let base = config("hh-ca-gantry.yaml");
    let text = format!("extends: {}\naxes: {{ C: {{ travel: {travel} }} }}\n", base.display());
    folder.with("gantry.yaml", &text)
}

/// Own positions of C and A for a direction: C nearest to `before`, A positive or negative.
fn fork(d: V3, sign: f64, before: f64) -> [f64; 2] {
    let c = (d[0] * sign).atan2(-d[1] * sign).to_degrees();
    [c + 360.0 * ((before - c) / 360.0).round(), sign * d[2].acos().to_degrees()]
}

#[test]
fn a_cone_frustum_is_cut_on_one_branch() {
    let folder = Folder::new("paths-cone");
    let rows = cone(361, 1.0);
    let sample = crate::support::config::sample(&config("hh-ca-gantry.yaml"));
    // Largest deviation and largest step of it, um, of an independent model on both continuous branches.
    let figures = [("[-360 deg, 360 deg]", 1.0, -90.0, 71.7, 2.0), ("[-360 deg, 180 deg]", -1.0, -270.0, 72.8, 2.7)];
    for (travel, sign, start, largest, step) in figures {
        let machine = gantry(&folder, travel);
        let (poses, path) = along(&folder, &machine, &rows);
        assert_eq!((poses.len(), path["rewinds"].as_array().unwrap().len()), (361, 0));
        assert!(path["pole_crossings"].as_array().unwrap().is_empty());
        let mut before = start;
        for (pose, (_, d)) in poses.iter().zip(&rows) {
            let [c, a] = fork(*d, sign, before);
            assert!((pose[3] - c).abs() < 1e-7 && (pose[4] - a).abs() < 1e-7, "{pose:?} {c} {a}");
            before = c;
        }
        assert!((before - start - 360.0).abs() < 1e-6);
        let deviations: Vec<V3> = poses
            .iter()
            .map(|pose| sample.evaluate(pose, Travel::Mean, Frame::Workpiece).deviation.map(|x| x * 1e3))
            .collect();
        let max = deviations.iter().map(|d| norm(*d)).fold(0.0, f64::max);
        let jump = deviations.windows(2).map(|pair| norm(minus(pair[1], pair[0]))).fold(0.0, f64::max);
        assert!((max - largest).abs() < 0.05 && (jump - step).abs() < 0.05, "{max} {jump}");
        let map = json(&[
            "map",
            text(&machine),
            "--tool-poses",
            text(&folder.file("rows.csv")),
            "--path",
            "yes",
            "--reference",
            "machine",
            "--format",
            "json",
            "--quiet",
        ]);
        assert!((number(&map["position_um"]["max"]) - max).abs() < 1e-6);
        assert_eq!((&map["over"]["path"], without_step(&map["path"])), (&true.into(), path));
        // A turns from 5 to 25 deg and back; so does X, in the middle of the circle.
        let reversals = |axis: usize| map["path"]["axes"][axis]["reversals"].clone();
        assert_eq!(
            (reversals(0), reversals(3), reversals(4)),
            (182.into_list(), Value::Array(Vec::new()), 182.into_list())
        );
    }
}

trait IntoList {
    fn into_list(self) -> Value;
}

impl IntoList for i32 {
    fn into_list(self) -> Value {
        Value::Array(vec![self.into()])
    }
}

#[test]
fn too_short_a_travel_is_a_rewind_and_no_silence() {
    let folder = Folder::new("paths-rewind");
    let machine = gantry(&folder, "[-95 deg, 95 deg]");
    let (poses, path) = along(&folder, &machine, &cone(361, 1.0));
    let rewinds = path["rewinds"].as_array().unwrap();
    // Each of two branches lasts for 190 deg of C; a whole turn is needed.
    assert_eq!((poses.len(), rewinds.len()), (361, 1));
    let line = number(&rewinds[0]["lines"][1]) as usize;
    let jump = poses[line - 2][3] - poses[line - 3][3];
    assert!((number(&rewinds[0]["turns_deg"]["C"]) - jump).abs() < 1e-9 && (jump + 180.0).abs() < 4.0, "{jump}");
    let steps = poses.windows(2).map(|pair| (pair[1][3] - pair[0][3]).abs()).filter(|step| *step > 3.0).count();
    assert_eq!(steps, 1);
    let rows = folder.file("rows.csv");
    let as_path = ["map", text(&machine), "--tool-poses", text(&rows), "--path", "yes"];
    let said = String::from_utf8(abbe_on(1, &as_path).stderr).unwrap();
    assert!(said.contains("W0851") && said.contains("1 rewind"), "{said}");
    let shown = abbe(&[&as_path[..], &["--quiet"]].concat());
    assert!(shown.contains("One path: 1 rewind, 0 pole crossings") && shown.contains("one path; reference"), "{shown}");
    let table = shown.lines().skip_while(|line| !line.starts_with("One path")).take_while(|line| !line.is_empty());
    assert!(table.filter(|line| !line.starts_with("Body")).all(|line| line.chars().count() <= 80), "{shown}");
    let csv = abbe(&[&as_path[..], &["--format", "csv", "--quiet"]].concat());
    assert!(csv.starts_with("line,event,X [mm]"), "{csv}");
    let event = csv.lines().find(|row| row.starts_with(&format!("{line},"))).unwrap();
    assert!(event.starts_with(&format!("{line},rewind")), "{event}");
    // A machine that leaves the path does not do the same work as one that does not.
    let whole = config("hh-ca-gantry.yaml");
    let poses = ["--tool-poses", text(&rows), "--path", "yes", "--format", "json", "--quiet"];
    let found = json(&[&["compare", text(&whole), text(&machine)], &poses[..]].concat());
    let verdict = &found["verdicts"][0];
    assert_eq!((&verdict["verdict"], verdict.get("by")), (&Value::Null, None));
    let reason = verdict["reason"].as_str().unwrap();
    assert_eq!(reason, "machine 1 leaves the path for 0 rewinds, machine 2 leaves the path for 1 rewind");
}

/// The cells of a column of a CSV table by its name.
fn column(csv: &str, name: &str) -> Vec<String> {
    let index = csv.lines().next().unwrap().split(',').position(|head| head == name).unwrap();
    csv.lines().skip(1).map(|line| line.split(',').nth(index).unwrap().to_owned()).collect()
}

#[test]
fn events_of_a_path_stand_in_all_outputs() {
    let folder = Folder::new("paths-events");
    let rows = cone(361, 1.0);
    let _ = folder.with("rows.csv", &table(&rows));
    let job = folder.with("job.yaml", "tool_poses: rows.csv\npath: true\nreference: machine\n");
    let machine = gantry(&folder, "[-95 deg, 95 deg]");
    let base = config("hh-ca-gantry.yaml");
    let arguments = ["reach", text(&machine), "--job", text(&job)];
    let output = abbe_on(1, &arguments);
    let (said, shown) = (String::from_utf8(output.stderr).unwrap(), String::from_utf8(output.stdout).unwrap());
    assert!(said.contains("W0851") && said.contains("1 rewind"), "{said}");
    assert!(shown.contains("One path: 1 rewind, 0 pole crossings") && shown.contains("rewind, C by"), "{shown}");
    let reach = json(&[&arguments[..], &["--format", "json", "--quiet"]].concat());
    let map = json(&["map", text(&machine), "--job", text(&job), "--format", "json", "--quiet"]);
    assert_eq!((&reach["path"], &reach["reached"]), (&without_step(&map["path"]), &361.into()));
    // Own positions of C: the direction of the tool turns once, and a branch of C ends after 190 deg.
    let poses = along(&folder, &machine, &rows).0;
    let jumps: Vec<usize> = (1..poses.len()).filter(|k| (poses[*k][3] - poses[*k - 1][3]).abs() > 3.0).collect();
    let is_positive = |k: usize| (fork(rows[k].1, 1.0, poses[k][3])[0] - poses[k][3]).abs() < 1e-6;
    assert!(jumps.len() == 1 && is_positive(jumps[0] - 1) != is_positive(jumps[0]), "{jumps:?}");
    let csv = |arguments: &[&str]| abbe(&[arguments, &["--job", text(&job), "--format", "csv", "--quiet"]].concat());
    let rewinds = |cells: &[String]| -> Vec<usize> {
        (0..cells.len()).filter(|k| cells[*k].split("; ").any(|word| word == "rewind")).collect()
    };
    for verb in ["reach", "eval", "map"] {
        let found = csv(&[verb, text(&machine)]);
        assert_eq!(rewinds(&column(&found, "event")), jumps, "{verb}");
        let reversals = column(&found, "event").iter().filter(|cell| cell.contains("reversal of")).count();
        let lines: std::collections::BTreeSet<u64> = reach["path"]["axes"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|axis| axis["reversals"].as_array().unwrap().iter().map(|line| line.as_u64().unwrap()))
            .collect();
        assert_eq!(reversals, lines.len(), "{verb}");
    }
    assert!(csv(&["reach", text(&machine)]).starts_with("X [mm],Y [mm],Z [mm],share,event\n"));
    // Side by side: the first machine has none, the second that one.
    let cells = column(&csv(&["compare", text(&base), text(&machine)]), "event");
    let of = |machine: usize| cells.iter().skip(machine).step_by(2).cloned().collect::<Vec<_>>();
    assert_eq!((cells.len(), rewinds(&of(0)), rewinds(&of(1))), (2 * 361, Vec::new(), jumps));
    // Single tool poses have no events and no column.
    for verb in ["reach", "eval", "map"] {
        let single = csv(&[verb, text(&machine), "--path", "no"]);
        assert!(!single.lines().next().unwrap().contains("event"), "{verb}");
    }
}

#[test]
fn a_travel_that_changes_the_branches_has_its_effect() {
    let folder = Folder::new("paths-diff");
    let rows = cone(361, 1.0);
    let _ = folder.with("rows.csv", &table(&rows));
    let job = folder.with("job.yaml", "tool_poses: rows.csv\npath: true\nreference: machine\n");
    let (short, base) = (gantry(&folder, "[-95 deg, 95 deg]"), config("hh-ca-gantry.yaml"));
    let diff = |more: &[&str]| {
        let arguments = ["diff", text(&short), text(&base), "--job", text(&job), "--format", "json", "--quiet"];
        json(&[&arguments[..], more].concat())
    };
    let found = diff(&[]);
    // The ceil(0.95 n)-th smallest deviation, um, of an independent model at the poses of each machine.
    let sample = crate::support::config::sample(&base);
    let p95 = |machine: &Path| {
        let um = |pose: &Vec<f64>| norm(sample.evaluate(pose, Travel::Mean, Frame::Workpiece).deviation) * 1e3;
        let mut list: Vec<f64> = along(&folder, machine, &rows).0.iter().map(um).collect();
        list.sort_by(f64::total_cmp);
        list[(list.len() * 95).div_ceil(100) - 1]
    };
    let truth = p95(&base) - p95(&short);
    let travel = found["differences"].as_array().unwrap().iter().find(|of| of["kind"] == "travel").unwrap();
    assert!(truth.abs() > 5.0 && travel["name"] == "C", "{truth} {travel}");
    assert!((number(&travel["minus_first_um"]) - truth).abs() < 1e-6, "{travel} {truth}");
    assert!((number(&found["minus_first_um"]) - truth).abs() < 1e-6, "{found}");
    // Of few rows both take the same poses, and the travel has no effect to state.
    let short = gantry(&folder, "[-300 deg, 300 deg]");
    let _ = folder.with("few.csv", &table(&rows[..20]));
    let few = folder.with("few.yaml", "tool_poses: few.csv\npath: true\nreference: machine\n");
    let found = json(&["diff", text(&short), text(&base), "--job", text(&few), "--format", "json", "--quiet"]);
    let travel = found["differences"].as_array().unwrap().iter().find(|of| of["kind"] == "travel").unwrap();
    assert!(travel["minus_first_um"].is_null() && number(&found["minus_first_um"]) == 0.0, "{found}");
}

/// A head with C about Z and A about X, both through the gauge point, and a tool of 100 mm.
fn head(folder: &Folder, c: &str, a: &str) -> PathBuf {
    let text = format!(
        "abbe: 1\nmachine: H\nchain: w b X Y Z C A t\naxes:\n  X: {{ travel: [-500, 500], origin: [0, 0, 0] }}\n  \
         Y: {{ travel: [-500, 500], origin: [0, 0, 0] }}\n  Z: {{ travel: [-500, 500], origin: [0, 0, 0] }}\n  \
         C: {{ travel: {c}, origin: [0, 0, 0] }}\n  A: {{ travel: {a}, origin: [0, 0, 0] }}\n\
         tool: {{ gauge: [0, 0, 0], length: 100 mm }}\nerrors: {{ EC0Y: 10 urad }}\n"
    );
    folder.with("head.yaml", &text)
}

/// Tilts (deg) about X, then about Y, one row per 2 mm of X.
fn tilted(tilts: &[[f64; 2]]) -> Vec<Row> {
    let row = |(k, [a, b]): (usize, &[f64; 2])| {
        let d = turned(1, *b, turned(0, *a, [0.0, 0.0, 1.0]));
        ([2.0 * k as f64, 0.0, 0.0], d)
    };
    tilts.iter().enumerate().map(row).collect()
}

#[test]
fn a_pole_is_crossed_by_the_other_side_of_the_head_or_by_a_turn() {
    let folder = Folder::new("paths-pole");
    // Through the pole: A changes its sign, C stays.
    let through: Vec<[f64; 2]> = (-10..=10).map(|k| [0.0, f64::from(k)]).collect();
    let both = head(&folder, "[-200, 200]", "[-110, 110]");
    let (poses, path) = along(&folder, &both, &tilted(&through));
    assert!(poses.iter().all(|pose| (pose[3] - poses[0][3]).abs() < 1e-9), "{poses:?}");
    let crossing = &path["pole_crossings"][0];
    assert_eq!((crossing["axis"].as_str(), path["pole_crossings"].as_array().unwrap().len()), (Some("C"), 1));
    assert!(number(&crossing["nearest_deg"]) < 1e-9 && number(&crossing["turn_deg"]) < 1e-9);
    assert_eq!((&crossing["deg_per_mm"], path["rewinds"].as_array().unwrap().len()), (&0.0.into(), 0));
    // A head that tilts to one side turns by half a turn: over five rows at the pole, six equal steps.
    let rest: Vec<[f64; 2]> = (1..=10)
        .map(|k| f64::from(k) - 11.0)
        .chain([0.0; 5])
        .chain((1..=10).map(f64::from))
        .map(|b| [0.0, b])
        .collect();
    let one = head(&folder, "[-200, 200]", "[0, 110]");
    let (poses, path) = along(&folder, &one, &tilted(&rest));
    let turns: Vec<f64> = poses.windows(2).map(|pair| (pair[1][3] - pair[0][3]).abs()).collect();
    assert!((0..24).all(|k| (turns[k] - if (9..15).contains(&k) { 30.0 } else { 0.0 }).abs() < 1e-9), "{turns:?}");
    let crossing = &path["pole_crossings"][0];
    assert_eq!(path["rewinds"].as_array().unwrap().len(), 0);
    assert!((number(&crossing["turn_deg"]) - 180.0).abs() < 1e-9);
    assert!((number(&crossing["deg_per_mm"]) - 15.0).abs() < 1e-9, "{crossing}");
    // From a pole the axis begins where it is needed first.
    let (poses, _) = along(&folder, &one, &tilted(&rest[10..]));
    assert!(poses.iter().all(|pose| (pose[3] - 90.0).abs() < 1e-9), "{poses:?}");
}

#[test]
fn the_rate_near_a_pole_is_that_of_its_closed_form() {
    let folder = Folder::new("paths-rate");
    let one = head(&folder, "[-200, 200]", "[0, 110]");
    let rows = tilted(&(-40..=40).map(|k| [0.5, 0.25 * f64::from(k)]).collect::<Vec<_>>());
    let (_, path) = along(&folder, &one, &rows);
    let turn = |d: V3| d[0].atan2(-d[1]).to_degrees();
    let tilt = |d: V3| d[0].hypot(d[1]).asin().to_degrees();
    let steps = rows.windows(2).filter(|pair| tilt(pair[0].1).min(tilt(pair[1].1)) < 2.0);
    let steps: Vec<f64> = steps
        .map(|pair| {
            let by = turn(pair[1].1) - turn(pair[0].1);
            (by - 360.0 * (by / 360.0).round()).abs()
        })
        .collect();
    let crossing = &path["pole_crossings"][0];
    let fastest = steps.iter().fold(0.0_f64, |most, step| most.max(*step)) / 2.0;
    assert!((number(&crossing["nearest_deg"]) - 0.5).abs() < 1e-9, "{crossing}");
    assert!((number(&crossing["turn_deg"]) - steps.iter().sum::<f64>()).abs() < 1e-6, "{crossing}");
    assert!((number(&crossing["deg_per_mm"]) - fastest).abs() < 1e-6 && fastest > 10.0, "{crossing} {fastest}");
    // The row without tilt about Y: the header is line 1.
    assert_eq!(crossing["nearest_line"], 42);
}

#[test]
fn a_free_axis_follows_the_part_where_a_slide_is_short() {
    let folder = Folder::new("paths-free");
    let machine = |c: &str| {
        let text = format!(
            "abbe: 1\nmachine: S\nchain: \"w C' b X Y Z t\"\naxes:\n  X: {{ travel: [-100, 100], origin: [0, 0, 0] }}\n  \
             Y: {{ travel: [-2, 2], origin: [0, 0, 0] }}\n  Z: {{ travel: [-50, 50], origin: [0, 0, 0] }}\n  \
             C: {{ travel: {c}, origin: [0, 0, 0] }}\nerrors: {{ EC0Y: 10 urad }}\n"
        );
        folder.with("lathe.yaml", &text)
    };
    let rows: Vec<Row> = (0..90)
        .map(|k| {
            let (s, c) = (4.0 * f64::from(k)).to_radians().sin_cos();
            ([80.0 * c, 80.0 * s, 0.0], [0.0, 0.0, 1.0])
        })
        .collect();
    let (poses, path) = along(&folder, &machine("continuous"), &rows);
    assert_eq!((poses.len(), path["rewinds"].as_array().unwrap().len()), (90, 0));
    // Y reaches 2 mm of 80 to either side: 1.43 deg.
    let slack = (2.0_f64 / 80.0).asin().to_degrees();
    let turn = (poses[89][0] - poses[0][0]).abs();
    assert!((turn - 356.0).abs() <= 2.0 * slack + 1e-6, "{turn}");
    for (pair, k) in poses.windows(2).zip(0..) {
        let by = (pair[1][0] - pair[0][0]).abs();
        assert!(by <= 4.0 + 2.0 * slack + 1e-6, "{k}: {by}");
    }
    for (pose, (tip, _)) in poses.iter().zip(&rows) {
        // The table turns with the part: Rz(c) (x, y) = tip.
        let at = turned(2, pose[0], [pose[1], pose[2], pose[3]]);
        assert!(norm(minus(at, *tip)) < 1e-8 && pose[2].abs() <= 2.0 + 1e-9, "{pose:?}");
    }
    let (poses, path) = along(&folder, &machine("[-95, 95]"), &rows);
    // C begins at 0, for at 180 deg it is beyond its travel: 96 deg, then 193 deg, then the rest.
    assert_eq!((poses.len(), path["rewinds"].as_array().unwrap().len()), (90, 2));
    assert!(path["pole_crossings"].as_array().unwrap().is_empty());
}

#[test]
fn a_long_path_is_wound_within_travels_on_any_number_of_threads() {
    let folder = Folder::new("paths-long");
    // 25 turns in 9001 rows: more than two blocks.
    let rows = cone(9001, 1.0);
    let turns = |poses: &[Vec<f64>]| poses[9000][3] - poses[0][3];
    let (poses, path) = along(&folder, &head(&folder, "continuous", "[-110, 110]"), &rows);
    assert_eq!((poses.len(), path["rewinds"].as_array().unwrap().len()), (9001, 0));
    assert!((turns(&poses) - 9000.0).abs() < 1e-6);
    assert!(poses.windows(2).all(|pair| pair[1][3] > pair[0][3] && pair[1][3] - pair[0][3] < 3.0));
    let (poses, path) = along(&folder, &head(&folder, "[-99999, 99999]", "[-110, 110]"), &rows);
    assert_eq!((turns(&poses).round(), path["rewinds"].as_array().unwrap().len()), (9000.0, 0));
    // 22 turns of travel: 25 turns in two parts.
    let machine = head(&folder, "[-3960, 3960]", "[-110, 110]");
    let (poses, path) = along(&folder, &machine, &rows);
    assert!(poses.iter().all(|pose| pose[3].abs() <= 3960.0));
    assert_eq!(path["rewinds"].as_array().unwrap().len(), 1);
    // Two turns of travel: 25 turns take 12.5 parts: 13 from an end of the travel.
    let (_, path) = along(&folder, &head(&folder, "[-360, 360]", "[-110, 110]"), &rows);
    assert_eq!(path["rewinds"].as_array().unwrap().len(), 12);
    let (machine, rows) = (text(&machine).to_owned(), folder.file("rows.csv"));
    let run = ["map", &machine, "--tool-poses", text(&rows), "--path", "yes", "--format", "csv", "--quiet"];
    assert!(abbe_on(1, &run).stdout == abbe_on(4, &run).stdout);
}

#[test]
fn cl_data_are_a_path_and_tables_are_not_unless_they_say_so() {
    let folder = Folder::new("paths-default");
    let machine = gantry(&folder, "[-360 deg, 360 deg]");
    let rows = cone(37, 10.0);
    let csv = folder.with("part.csv", &table(&rows));
    let goto =
        |(tip, d): &Row| format!("GOTO/{:?},{:?},{:?},{:?},{:?},{:?}\n", tip[0], tip[1], tip[2], d[0], d[1], d[2]);
    let cl = folder.with("part.cls", &rows.iter().map(goto).collect::<String>());
    let job = folder.with("part.yaml", "tool_poses: part.csv\npath: true\n");
    let cl_job = folder.with("cl.yaml", "tool_poses: part.cls\n");
    let map = |options: &[&str]| {
        let found = json(&[&["map", text(&machine), "--format", "json", "--quiet"], options].concat());
        assert_eq!(found["path"].is_object(), found["over"]["path"] == true, "{options:?}");
        (found["over"]["path"].as_bool().unwrap(), number(&found["position_um"]["max"]))
    };
    let (path, single) = (map(&["--tool-poses", text(&csv), "--path", "yes"]), map(&["--tool-poses", text(&csv)]));
    assert!(path.0 && !single.0 && (path.1 - single.1).abs() > 1.0, "{path:?} {single:?}");
    for (options, is_path) in [
        (vec!["--tool-poses", text(&cl)], true),
        (vec!["--tool-poses", text(&cl), "--path", "no"], false),
        (vec!["--job", text(&cl_job)], true),
        (vec!["--job", text(&job)], true),
        (vec!["--job", text(&job), "--path", "no"], false),
    ] {
        assert_eq!(map(&options), if is_path { path } else { single }, "{options:?}");
    }
    assert_eq!(refused(&["map", text(&machine), "--path", "yes"]).0, 2);
    assert_eq!(refused(&["map", text(&machine), "--tool-poses", text(&csv), "--path", "maybe"]).0, 2);
    // Machines side by side each have their own path, and eval the same.
    let short = folder.with(
        "short.yaml",
        &format!("extends: {}\naxes: {{ C: {{ travel: [-95 deg, 95 deg] }} }}\n", text(&config("hh-ca-gantry.yaml"))),
    );
    let sides = json(&["compare", text(&machine), text(&short), "--job", text(&job), "--format", "json", "--quiet"]);
    let rewinds = |i: usize| sides["machines"][i]["path"]["rewinds"].as_array().unwrap().len();
    assert_eq!((&sides["over"]["path"], rewinds(0), rewinds(1)), (&true.into(), 0, 1));
}

#[test]
fn positions_of_rotary_axes_in_a_table_are_a_path_as_they_are() {
    let folder = Folder::new("paths-rotary");
    let machine = head(&folder, "[-200, 200]", "[-110, 110]");
    let rows =
        folder.with("rows.csv", "X,Y,Z,C,A\n0,0,0,0,20\n1,0,0,10,20\n2,0,0,-170,-20\n3,0,0,-160,-20\n4,0,0,-165,-20\n");
    let found =
        json(&["map", text(&machine), "--tool-poses", text(&rows), "--path", "yes", "--format", "json", "--quiet"]);
    // The same branch on the other side: the tool leaves the path between the lines 3 and 4.
    assert_eq!(found["path"]["rewinds"].as_array().unwrap().len(), 1);
    assert_eq!(found["path"]["rewinds"][0]["lines"], serde_json::json!([3, 4]));
    assert_eq!(found["path"]["axes"][3]["reversals"], serde_json::json!([5]));
    assert_eq!(number(&found["path"]["axes"][3]["motion"]), 205.0);
}
