//! The reach of machines: closed forms, and a search by the independent model.

use crate::configs;
use crate::oracle::matrix::{V3, minus, norm, turn};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Held, State};
use crate::program::{Folder, abbe, abbe_on, json, refused, text, well_formed};
use crate::support::config;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn machine(folder: &Folder, chain: &str, axes: &str, rest: &str) -> PathBuf {
    folder.with("m.yaml", &format!("abbe: 1\nmachine: M\nchain: \"{chain}\"\naxes: {{ {axes} }}\n{rest}"))
}

fn reach(machine: &Path, more: &[&str]) -> Value {
    json(&[&["reach", text(machine)], more, &["--format", "json"]].concat())
}

/// Tips and shares.
fn tips(machine: &Path, more: &[&str]) -> Vec<[f64; 4]> {
    let csv = abbe(&[&["reach", text(machine)], more, &["--format", "csv"]].concat());
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        <[f64; 4]>::try_from(cells).unwrap()
    };
    csv.lines().skip(1).map(row).collect()
}

const XYZ: &str = "X: { travel: [0, 400], origin: [0, 0, 0] }, Y: { travel: [0, 300], origin: [0, 0, 0] }, \
                   Z: { travel: [-200, 0], origin: [0, 0, 0] }";

#[test]
fn a_gantry_reaches_the_box_of_its_travels() {
    let folder = Folder::new("reach-gantry");
    let path = machine(&folder, "w b X Y Z t", XYZ, "workpiece: { origin: [100, 50, -150] }\n");
    let all = reach(&path, &[]);
    assert_eq!(all["box_mm"], serde_json::json!([[-100.0, 300.0], [-50.0, 250.0], [-50.0, 150.0]]));
    assert_eq!((&all["counts"], &all["share"]), (&serde_json::json!([9, 7, 5]), &1.0.into()));
    assert_eq!(all["directions"]["kind"], "one");
    // Beyond the travel in X, both sides, and above in Z.
    let more = ["--box", "X=-200..400,Y=0..0 mm,Z=0..0.3 m", "--step", "50 mm"];
    let wide = reach(&path, &more);
    assert_eq!(wide["counts"], serde_json::json!([13, 1, 7]));
    assert_eq!((&wide["reached"], &wide["tool_poses"]), (&(9 * 4).into(), &(13 * 7).into()));
    for [x, _, z, share] in tips(&path, &more) {
        let within = (-100.0..=300.0).contains(&x) && z <= 150.0;
        assert_eq!(share, f64::from(u8::from(within)), "{x} {z}");
    }
    let words = abbe(&[&["reach", text(&path)][..], &more].concat());
    // Four of thirteen columns are beyond X, three of seven rows above Z.
    assert!(words.contains("Z short by up to 150 mm above 0 mm (39 tool poses)"), "{words}");
    assert!(words.contains("X short by up to 100 mm below 0 mm (14 tool poses)"), "{words}");
    assert!(words.contains("X short by up to 100 mm above 400 mm (14 tool poses)"), "{words}");
    assert_eq!(wide["lacks"][0]["axis"], "Z");
    assert_eq!((&wide["lacks"][0]["end"], &wide["lacks"][0]["above"]), (&0.0.into(), &true.into()));
    // The part turned: its Z is Y of the machine, its Y against Z.
    let turned =
        machine(&folder, "w b X Y Z t", XYZ, "workpiece: { origin: [100, 50, -150], rotation: { A: -90 deg } }\n");
    let all = reach(&turned, &[]);
    assert_eq!(all["box_mm"], serde_json::json!([[-100.0, 300.0], [-150.0, 50.0], [-50.0, 250.0]]));
    assert_eq!((&all["share"], &all["directions"]["about"]), (&1.0.into(), &serde_json::json!([0.0, -1.0, 0.0])));
}

#[test]
fn a_fork_head_reaches_the_cap_within_its_tilt() {
    let folder = Folder::new("reach-fork");
    let wide = "X: { travel: [-900, 900], origin: [0, 0, 0] }, Y: { travel: [-900, 900], origin: [0, 0, 0] }, \
                Z: { travel: [-900, 900], origin: [0, 0, 0] }";
    for (tilt, count) in [(40.0_f64, 250_usize), (75.0, 100), (90.0, 60)] {
        let axes = format!(
            "{wide}, C: {{ travel: continuous, origin: [0, 0, 0] }}, \
             A: {{ travel: [-{tilt}, {tilt}], origin: [0, 0, 0] }}"
        );
        let path = machine(&folder, "w b X Y Z C A t", &axes, "tool: { length: 200 mm }\n");
        let count_text = count.to_string();
        let more = ["--box", "X=-100..100,Y=-100..100,Z=-50..50", "--step", "100 mm", "--directions", &count_text];
        let found = reach(&path, &more);
        assert_eq!(found["directions"]["kind"], "hemisphere");
        let share = found["share"].as_f64().unwrap();
        let cap = 1.0 - tilt.to_radians().cos();
        assert!((share - cap).abs() <= 0.51 / count as f64, "{tilt}: {share} {cap}");
        // The same at every tip: none of them is far.
        let all = if tilt == 90.0 { 18 } else { 0 };
        assert_eq!(found["tips_in_all_directions"], all);
        assert_eq!(found["tips_in_any_direction"], 18);
        if tilt < 90.0 {
            assert_eq!(found["lacks"][0]["axis"], "A", "{found}");
        }
    }
}

/// The directions as docs/formats/maps.md states them, about a unit vector.
fn hemisphere(about: V3, count: usize) -> Vec<V3> {
    let dot = |a: V3, b: V3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let letter = if about[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let along = dot(about, letter);
    let first: V3 = std::array::from_fn(|k| letter[k] - along * about[k]);
    let first = first.map(|x| x / norm(first));
    let second = crate::oracle::matrix::cross(about, first);
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count)
        .map(|k| {
            let height = 1.0 - (k as f64 + 0.5) / count as f64;
            let (s, c) = (k as f64 * golden).sin_cos();
            let side = (1.0 - height * height).sqrt();
            std::array::from_fn(|i| height * about[i] + side * (c * first[i] + s * second[i]))
        })
        .collect()
}

/// A five-axis machine of the configurations with one axis that tilts and one that turns about Z at rest.
struct Searched {
    sample: crate::oracle::machines::Sample,
    tilt: usize,
    turns: usize,
    linear: Vec<usize>,
}

impl Searched {
    fn new(path: &Path, tilt: &str, turns: &str) -> Self {
        let sample = crate::support::config::sample(path);
        let walk = &sample.rigid.walk;
        let at = |name: &str| walk.iter().position(|axis| axis.name == name).unwrap();
        let linear = (0..walk.len()).filter(|i| !walk[*i].rotary).collect();
        Self { tilt: at(tilt), turns: at(turns), linear, sample }
    }

    fn holds(&self, pose: &[f64]) -> Held {
        let state = |(axis, position): (usize, &f64)| State {
            position: if self.sample.rigid.walk[axis].rotary { position.to_radians() } else { *position },
            errors: [0.0; 6],
        };
        self.sample.rigid.holds(&pose.iter().enumerate().map(state).collect::<Vec<_>>())[1]
    }

    /// True if some position of the rotary axes holds the direction and the linear axes then bring the tip there.
    fn reaches(&self, tip: V3, direction: V3) -> bool {
        let dot = |a: V3, b: V3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut pose = vec![0.0; self.sample.axes.len()];
        let angle = direction[2].clamp(-1.0, 1.0).acos().to_degrees();
        for tilt in [angle, -angle] {
            let [low, high] = self.sample.axes[self.tilt].travel.unwrap();
            if !(low..=high).contains(&tilt) {
                continue;
            }
            (pose[self.tilt], pose[self.turns]) = (tilt, 0.0);
            let axis = self.holds(&pose).axis();
            let between = (direction[1].atan2(direction[0]) - axis[1].atan2(axis[0])).to_degrees();
            for turn in [between, -between] {
                pose[self.turns] = turn;
                if dot(self.holds(&pose).axis(), direction) > 1.0 - 1e-12 && self.carries(tip, &pose) {
                    return true;
                }
            }
        }
        false
    }

    /// True if the linear axes bring the tip to a point within their travels.
    fn carries(&self, tip: V3, pose: &[f64]) -> bool {
        let mut pose = pose.to_vec();
        self.linear.iter().for_each(|axis| pose[*axis] = 0.0);
        let start = self.holds(&pose).tip;
        let mut columns = nalgebra::Matrix3::zeros();
        for (k, axis) in self.linear.iter().enumerate() {
            pose[*axis] = 1.0;
            let way = minus(self.holds(&pose).tip, start);
            pose[*axis] = 0.0;
            columns.set_column(k, &way.into());
        }
        let way = nalgebra::Vector3::from(minus(tip, start));
        let motion = columns.lu().solve(&way).unwrap();
        self.linear.iter().zip(motion.iter()).all(|(axis, q)| {
            let [low, high] = self.sample.axes[*axis].travel.unwrap();
            low - 1e-9 <= *q && *q <= high + 1e-9
        })
    }
}

#[test]
fn the_shares_are_those_of_a_search_by_the_independent_model() {
    // Sides that no end of a travel falls on.
    let cases = [
        ("trunnion.yaml", "A", "C", "X=-307..293,Y=-251..249,Z=-13..137"),
        ("ht-b-c.yaml", "B", "C", "X=-411..389,Y=-299..301,Z=-17..383"),
        ("tt-ac-800.yaml", "A", "C", "X=-503..497,Y=-401..399,Z=7..207"),
    ];
    for (name, tilt, turns, region) in cases {
        let path = configs::folder().join(name);
        let searched = Searched::new(&path, tilt, turns);
        let directions = hemisphere([0.0, 0.0, 1.0], 40);
        let found = tips(&path, &["--box", region, "--step", "150 mm", "--directions", "40"]);
        let mut between = 0;
        for [x, y, z, share] in &found {
            let wanted = directions.iter().filter(|d| searched.reaches([*x, *y, *z], **d)).count();
            assert_eq!((share * 40.0).round() as usize, wanted, "{name} {x} {y} {z}");
            between += usize::from(wanted > 0 && wanted < 40);
        }
        assert!(between > 5, "{name}: {between} of {}", found.len());
    }
}

#[test]
fn one_axis_that_turns_the_tool_gives_a_circle() {
    let found = reach(&config("hmc-4ax.yaml"), &["--step", "200 mm", "--directions", "36"]);
    // Nineteen of thirty-six are within the hemisphere, its rim included.
    assert_eq!((&found["directions"]["kind"], &found["directions"]["count"]), (&"circle".into(), &19.into()));
    assert!(found["reached"].as_u64().unwrap() > 0 && found["share"].as_f64().unwrap() < 1.0);
    // The tool lies along Z of the machine: -Y of the part.
    let about = turn(&crate::oracle::matrix::elementary(0, 90_f64.to_radians()), [0.0, 0.0, 1.0]);
    assert!((0..3).all(|k| (found["directions"]["about"][k].as_f64().unwrap() - about[k]).abs() < 1e-12));
    let lathe = reach(&config("lathes/lathe-xzc.yaml"), &[]);
    assert_eq!((&lathe["directions"]["kind"], &lathe["counts"][1]), (&"one".into(), &1.into()));
    assert_eq!(lathe["share"], 1.0);
}

#[test]
fn robots_take_fewer_tool_poses() {
    let ur5 = config("robots/ur5.yaml");
    let found = reach(&ur5, &["--box", "X=200..400,Y=-100..100,Z=100..100", "--step", "200 mm", "--directions", "3"]);
    assert_eq!((&found["tool_poses"], &found["directions"]["count"]), (&12.into(), &3.into()));
    assert!(found["reached"].as_u64().unwrap() > 6, "{found}");
    let (code, said) = refused(&["reach", text(&ur5), "--step", "40 mm"]);
    assert!(code == 1 && said.contains("E0812") && said.contains("10000 tool poses"), "{said}");
}

#[test]
fn nonsense_and_too_much_are_refused() {
    let trunnion = config("trunnion.yaml");
    let run = |more: &[&str]| refused(&[&["reach", text(&trunnion)], more].concat());
    for bad in ["Q=0..1", "X=0", "X=5..-5", "X=0..inf", "X=0..9e9", "X=0 deg..1 deg", "", "X=1..2;Y=0..1"] {
        let (code, said) = run(&["--box", bad]);
        assert!(code == 2 && said.contains("is no side of a box"), "{bad}: {code} {said}");
    }
    let (code, said) = run(&["--step", "1 mm"]);
    assert!(code == 1 && said.contains("refused[E0812]") && said.contains("more than 1000000 tool poses"), "{said}");
    for step in ["0 mm", "-5 mm", "3 deg"] {
        assert_eq!(run(&["--step", step]).0, 2, "{step}");
    }
    assert_eq!(run(&["--directions", "0"]).0, 2);
}

#[test]
fn files_hold_the_same_and_do_not_depend_on_threads() {
    let folder = Folder::new("reach-files");
    let (svg, png, vtk) = (folder.file("r.svg"), folder.file("r.png"), folder.file("r.vts"));
    let trunnion = config("trunnion.yaml");
    let more = ["reach", text(&trunnion), "--step", "100 mm", "--directions", "12", "--format", "csv"];
    let files = ["--svg", text(&svg), "--png", text(&png), "--vtk", text(&vtk)];
    let one = abbe_on(1, &[&more[..], &files].concat());
    assert!(one.status.success(), "{one:?}");
    let bytes = |path: &Path| std::fs::read(path).unwrap();
    let before = [&svg, &png, &vtk].map(|path| bytes(path));
    let two = abbe_on(2, &[&more[..], &files].concat());
    assert_eq!(one.stdout, two.stdout);
    assert_eq!(before, [&svg, &png, &vtk].map(|path| bytes(path)));
    let drawing = String::from_utf8(before[0].clone()).unwrap();
    assert!(well_formed(&drawing).is_ok() && drawing.contains("all directions at"), "{drawing}");
    assert_eq!(&before[1][1..4], b"PNG");
    // Points, then shares, then counts, each behind its size in bytes.
    let rows = tips(&trunnion, &["--step", "100 mm", "--directions", "12"]);
    let start = before[2].windows(3).position(|w| w == b">\n_").unwrap() + 3;
    let head = String::from_utf8_lossy(&before[2][..start]).into_owned();
    assert!(head.contains("type=\"StructuredGrid\"") && head.contains("Name=\"share\""), "{head}");
    let mut at = start;
    let mut next = |count: usize| -> Vec<f64> {
        let size = u64::from_le_bytes(before[2][at..at + 8].try_into().unwrap());
        assert_eq!(size as usize, 8 * count);
        let numbers = before[2][at + 8..at + 8 + 8 * count].chunks(8);
        at += 8 + 8 * count;
        numbers.map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    };
    let (points, shares, reached) = (next(3 * rows.len()), next(rows.len()), next(rows.len()));
    for (i, [x, y, z, share]) in rows.iter().enumerate() {
        assert_eq!((&points[3 * i..3 * i + 3], shares[i]), (&[*x, *y, *z][..], *share));
        assert_eq!(reached[i], (share * 12.0).round());
    }
    assert!(before[2].ends_with(b"\n </AppendedData>\n</VTKFile>\n"));
    // The numbers of docs/formats/maps.md add up.
    let found = reach(&trunnion, &["--step", "100 mm", "--directions", "12"]);
    let number = |key: &str| found[key].as_u64().unwrap();
    assert_eq!(number("tool_poses"), 12 * number("tips"));
    assert_eq!(number("tool_poses"), number("reached") + found["unreachable"]["total"].as_u64().unwrap());
    assert_eq!(number("reached") as f64, reached.iter().sum::<f64>());
    let all = reached.iter().filter(|n| **n == 12.0).count() as u64;
    let any = reached.iter().filter(|n| **n > 0.0).count() as u64;
    assert_eq!((number("tips_in_all_directions"), number("tips_in_any_direction")), (all, any));
}

/// A machine with a free C and two slides in its plane, by hand: X and Y beside the spindle, or X below it.
struct Plane {
    x_below_c: bool,
    /// Half of the travels of X and Y, mm.
    half: [f64; 2],
    /// Position of C in the plane, mm.
    at: [f64; 2],
}

impl Plane {
    /// Motions (mm) of X and Y that bring a tip to the tool at an angle (rad) of C.
    fn motions(&self, [x, y]: [f64; 2], angle: f64) -> [f64; 2] {
        let (s, c) = angle.sin_cos();
        let (x, y) = (x - self.at[0], y - self.at[1]);
        if !self.x_below_c {
            return [c * x - s * y + self.at[0], s * x + c * y + self.at[1]];
        }
        // The slide carries the part on the table: its motion must bring the tip under the tool across X.
        let slid = (s * y - self.at[0]) / c - x;
        [slid, s * (x + slid) + c * y + self.at[1]]
    }

    fn lack(&self, tip: [f64; 2], angle: f64) -> f64 {
        let of = |(q, half): (f64, f64)| (q.abs() - half).max(0.0);
        self.motions(tip, angle).into_iter().zip(self.half).map(of).sum()
    }

    /// The least lack over 100,000 angles, then over hundredths of a step about the best of them.
    fn least(&self, tip: [f64; 2]) -> f64 {
        let step = std::f64::consts::TAU / 1e5;
        let lack = |angle: f64| (self.lack(tip, angle), angle);
        let best = |a: (f64, f64), b: (f64, f64)| if b.0 < a.0 { b } else { a };
        let coarse = (0..100_000).map(|k| lack(f64::from(k) * step)).fold((f64::INFINITY, 0.0), best);
        (-100..=100).map(|k| lack(coarse.1 + f64::from(k) * step / 100.0)).fold(coarse, best).0
    }
}

#[test]
fn no_tool_pose_is_lost_along_a_free_axis() {
    let folder = Folder::new("reach-free");
    let mut random = Random::new(40);
    let (mut narrow, mut missed) = (0, 0);
    for round in 0..16 {
        let x_below_c = round % 2 == 1;
        let half = [random.between(40.0, 120.0), random.between(0.5, 6.0)];
        let plane = Plane { x_below_c, half, at: [random.around(30.0), random.around(3.0)] };
        let chain = if x_below_c { "w X' C' b Y Z t" } else { "w C' b X Y Z t" };
        let axes = format!(
            "X: {{ travel: [-{0}, {0}], origin: [0, 0, 0] }}, Y: {{ travel: [-{1}, {1}], origin: [0, 0, 0] }}, \
             Z: {{ travel: [-50, 50], origin: [0, 0, 0] }}, C: {{ travel: continuous, origin: [{2}, {3}, 0] }}",
            half[0], half[1], plane.at[0], plane.at[1]
        );
        let machine = machine(&folder, chain, &axes, "");
        let tips: Vec<[f64; 2]> = (0..24).map(|_| [random.around(140.0), random.around(140.0)]).collect();
        // One is in reach by construction, so that the file is never refused as a whole.
        let near = if x_below_c { [0.0, plane.at[1]] } else { plane.at };
        let rows = tips.iter().chain([&near]).map(|[x, y]| format!("{x},{y},0\n")).collect::<String>();
        let work = folder.with("work.csv", &format!("X,Y,Z\n{rows}"));
        let map = json(&["map", text(&machine), "--tool-poses", text(&work), "--format", "json", "--quiet"]);
        let rows = map["tool_poses"]["rows"].as_array().unwrap();
        for (i, tip) in tips.iter().enumerate() {
            let least = plane.least(*tip);
            let row = rows.iter().find(|row| row["line"] == i + 2);
            let by = |row: &Value| -> f64 {
                row["beyond"].as_array().unwrap().iter().map(|b| b["by"].as_f64().unwrap().abs()).sum()
            };
            let lack = row.map_or(0.0, by);
            // Not more than brute force finds, and not less by more than its step can hide.
            assert!(lack <= least + 1e-8, "{chain} {tip:?}: {lack}, by brute force {least}");
            // Below C the motions are steep where the tip is almost across X.
            let hidden = if x_below_c { 0.2 } else { 0.02 };
            assert!(lack >= least - hidden, "{chain} {tip:?}: {lack}, by brute force {least}");
            narrow += usize::from(row.is_none());
            missed += usize::from(row.is_some());
        }
    }
    assert!(narrow > 60 && missed > 60, "{narrow} {missed}");
}

#[test]
fn a_short_cross_slide_reaches_the_whole_circle() {
    let folder = Folder::new("reach-short-y");
    let axes = "X: { travel: [-100, 100], origin: [0, 0, 0] }, Y: { travel: [-2, 2], origin: [0, 0, 0] }, \
                Z: { travel: [-50, 50], origin: [0, 0, 0] }, C: { travel: continuous, origin: [0, 0, 0] }";
    let machine = machine(&folder, "w C' b X Y Z t", axes, "");
    let row = |k: u32| {
        let (s, c) = (f64::from(4 * k)).to_radians().sin_cos();
        format!("{},{},0,0,0,1\n", 80.0 * c, 80.0 * s)
    };
    let work = folder.with("work.csv", &format!("X,Y,Z,I,J,K\n{}", (0..90).map(row).collect::<String>()));
    let map = json(&["map", text(&machine), "--tool-poses", text(&work), "--format", "json", "--quiet"]);
    assert_eq!((&map["tool_poses"]["asked"], &map["tool_poses"]["reached"]), (&90.into(), &90.into()));
    // At a radius of 101 mm what lacks is least with the tip in X, or on the edge of Y: a length of 101 either way.
    let far = folder.with("far.csv", "X,Y,Z\n80,0,0\n60.6,80.8,0\n");
    let map = json(&["map", text(&machine), "--tool-poses", text(&far), "--format", "json", "--quiet"]);
    let by = map["tool_poses"]["rows"][0]["beyond"][0]["by"].as_f64().unwrap();
    assert!((by.abs() - ((101.0_f64.powi(2) - 4.0).sqrt() - 100.0)).abs() < 1e-9, "{by}");
}

/// A turning table below a head of two rotary axes, by hand: three axes for a direction.
struct TableAndHead {
    /// Half of the travels of X, Y and Z, mm, and of C, B and A, deg.
    half: [f64; 6],
    /// Height of the head's pivot above the tip, mm.
    pivot: f64,
}

impl TableAndHead {
    /// Sum of what X, Y and Z lack (mm) at an angle (rad) of C; `None` if the head cannot point there.
    fn lack(&self, tip: [f64; 3], direction: [f64; 3], c: f64) -> Option<f64> {
        let turned = |[x, y, z]: [f64; 3]| {
            let (sine, cosine) = c.sin_cos();
            [cosine * x - sine * y, sine * x + cosine * y, z]
        };
        let (tip, d) = (turned(tip), turned(direction));
        let (b, a) = (d[0].atan2(d[2]).to_degrees(), d[1].asin().to_degrees());
        let pivot = [0.0, 0.0, self.pivot];
        let lack = |k: usize| (tip[k] + self.pivot * d[k] - pivot[k]).abs() - self.half[k];
        (b.abs() <= self.half[4] && a.abs() <= self.half[5]).then(|| (0..3).map(|k| lack(k).max(0.0)).sum())
    }

    fn least(&self, tip: [f64; 3], direction: [f64; 3]) -> f64 {
        let angle = |k: i32| f64::from(k) / 5e4 * self.half[3].to_radians();
        (-50_000..=50_000).filter_map(|k| self.lack(tip, direction, angle(k))).fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn what_is_proved_out_of_reach_of_three_rotary_axes_is() {
    let folder = Folder::new("reach-three");
    let mut random = Random::new(41);
    let (mut found, mut proved, mut open, mut lost) = (0, 0, 0, 0);
    for _ in 0..8 {
        let half = [
            random.between(40.0, 120.0),
            random.between(2.0, 40.0),
            random.between(30.0, 90.0),
            random.between(60.0, 175.0),
            random.between(15.0, 80.0),
            random.between(15.0, 80.0),
        ];
        let by_hand = TableAndHead { half, pivot: random.between(50.0, 200.0) };
        let linear = ["X", "Y", "Z"].iter().zip(half);
        let mut axes: Vec<String> =
            linear.map(|(axis, half)| format!("{axis}: {{ travel: [-{half}, {half}], origin: [0, 0, 0] }}")).collect();
        let rotary = ["C", "B", "A"].iter().zip(&half[3..]).zip([0.0, by_hand.pivot, by_hand.pivot]);
        axes.extend(
            rotary.map(|((axis, half), z)| {
                format!("{axis}: {{ travel: [-{half} deg, {half} deg], origin: [0, 0, {z}] }}")
            }),
        );
        let machine = machine(&folder, "w C' b X Y Z B A t", &axes.join(", "), "");
        let mut targets = vec![([0.0; 3], [0.0, 0.0, 1.0])];
        for _ in 0..24 {
            let (tilt, about) = (random.between(0.0, 1.4), random.between(0.0, std::f64::consts::TAU));
            let direction = [tilt.sin() * about.cos(), tilt.sin() * about.sin(), tilt.cos()];
            targets.push(([random.around(120.0), random.around(120.0), random.around(60.0)], direction));
        }
        let row = |(t, d): &([f64; 3], [f64; 3])| format!("{},{},{},{},{},{}\n", t[0], t[1], t[2], d[0], d[1], d[2]);
        let rows: String = targets.iter().map(row).collect();
        let work = folder.with("work.csv", &format!("X,Y,Z,I,J,K\n{rows}"));
        let reach = json(&["reach", text(&machine), "--tool-poses", text(&work), "--format", "json", "--quiet"]);
        let rows = reach["job"]["rows"].as_array().unwrap();
        for (i, (tip, direction)) in targets.iter().enumerate() {
            let least = by_hand.least(*tip, *direction);
            let Some(row) = rows.iter().find(|row| row["line"] == i + 2) else {
                // The step of the brute force hides that much.
                assert!(least < 0.02, "{tip:?} {direction:?}: reached, by brute force {least}");
                found += 1;
                continue;
            };
            if row["not_proved"] == true {
                open += 1;
                lost += usize::from(least == 0.0);
            } else {
                assert!(least > 0.0, "{tip:?} {direction:?}: proved out of reach, and reached by brute force");
                proved += 1;
            }
        }
        let missed = &reach["unreachable"];
        let of_rows = rows.iter().filter(|row| row["not_proved"] == true).count();
        assert_eq!(missed["not_proved"].as_u64().unwrap_or(0) as usize, of_rows);
    }
    println!("{found} found, {proved} proved, {open} open, {lost} lost");
    assert!(found > 30 && proved > 60 && open <= 12 && lost == 0, "{found} {proved} {open} {lost}");
}
