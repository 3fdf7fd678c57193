//! `compile`: lattices and own-axis tables, judged by the independent rigid-body model, by hand, and by
//! readers and a replay of our own.

use std::path::Path;
use std::sync::OnceLock;

use serde_json::Value;

use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample, combinations};
use crate::oracle::matrix::norm;
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::rigid::Frame;
use crate::oracle::yaml;
use crate::support::lattice::Lattice;
use crate::support::{self, Run, compile, config, left, names, number, p95, p95_bracket, sha256::sha256, verify};

/// The trunnion machine, its lattice and its certificate.
struct Grid {
    machine: Sample,
    lattice: Lattice,
    certificate: Value,
}

impl Grid {
    fn compile(scope: &str) -> Self {
        let folder = Folder::new();
        let certificate =
            compile(&config("trunnion.yaml"), "grid-csv", &folder.path("out"), &["--correct", scope]).json();
        let lattice = Lattice::read(&std::fs::read_to_string(folder.path("out/corrections.csv")).unwrap());
        Self { machine: support::config::sample(&config("trunnion.yaml")), lattice, certificate }
    }

    /// `--correct position`, compiled once for all tests.
    fn position() -> &'static Self {
        static GRID: OnceLock<Grid> = OnceLock::new();
        GRID.get_or_init(|| Self::compile("position"))
    }

    /// `--correct pose`.
    fn pose() -> &'static Self {
        static GRID: OnceLock<Grid> = OnceLock::new();
        GRID.get_or_init(|| Self::compile("pose"))
    }

    fn command(&self, pose: &Pose) -> Pose {
        left::corrected(pose, &self.lattice.at(pose))
    }

    /// Position deviations (um) at poses, without and with the corrections.
    fn deviations(&self, poses: &[Pose], travel: Travel) -> [Vec<f64>; 2] {
        let um = |pose: &Pose, command: &Pose| norm(left::position(&self.machine, pose, command, travel)) * 1000.0;
        [
            poses.iter().map(|pose| um(pose, pose)).collect(),
            poses.iter().map(|pose| um(pose, &self.command(pose))).collect(),
        ]
    }
}

const POSES: usize = 2000;
const SEED: u64 = 2026;

#[test]
fn the_lattice_of_the_trunnion_is_whole() {
    for (grid, corrected) in [(Grid::position(), "Y X Z"), (Grid::pose(), "C A Y X Z")] {
        let lattice = &grid.lattice;
        assert_eq!(lattice.axes.join(" "), "C A Y X Z");
        assert_eq!(lattice.units.join(" "), "deg deg mm mm mm");
        assert_eq!(lattice.corrected.join(" "), corrected);
        assert!((2..=200_000).contains(&lattice.len()), "{}", lattice.len());
        for (extra, nodes) in grid.machine.axes.iter().zip(&lattice.nodes) {
            let [low, high] = extra.travel.unwrap_or([0.0, 360.0]);
            assert_eq!([nodes[0], nodes[nodes.len() - 1]], [low, high]);
        }
    }
}

/// The reduction and the certificate, on poses of our own that are no nodes.
fn reduction(grid: &Grid, factor: f64) {
    let poses = left::poses(&grid.machine, SEED, POSES);
    let mut worse = (0.0, [(0.0, 0.0); 2], "");
    for (travel, word) in [(Travel::Forward, "forward"), (Travel::Reverse, "reverse")] {
        let [before, after] = grid.deviations(&poses, travel);
        let (before95, after95) = (p95(&before), p95(&after));
        assert!(before95 / after95 >= factor, "{word}: from {before95} to {after95} um");
        if after95 > worse.0 {
            worse = (after95, [p95_bracket(&before, POSES), p95_bracket(&after, POSES)], word);
        }
        println!("{word}: 95 % from {before95:.4} to {after95:.4} um, factor {:.2}", before95 / after95);
    }
    let (_, brackets, _) = worse;
    for ((low, high), which) in brackets.into_iter().zip(["uncompensated", "compensated"]) {
        let theirs = number(&grid.certificate, &format!("/{which}/position_um/p95"));
        assert!((low..=high).contains(&theirs), "{which}: {theirs} is not within {low} to {high}");
        println!("{which}: certificate {theirs:.4} um, own 95 % of two samples within {low:.4} to {high:.4}");
    }
}

#[test]
fn correcting_positions_takes_nineteen_twentieths_away() {
    reduction(Grid::position(), 20.0);
}

#[test]
fn correcting_poses_takes_nine_tenths_of_the_position_away() {
    reduction(Grid::pose(), 10.0);
}

/// Within a cell the certificate counts; on a node only rounding remains.
#[test]
fn nodes_are_solved_to_rounding() {
    let mut random = Random::new(SEED);
    // Half a last place of three axes, taken as the corner of a cube; and as much of two rotary axes, in deg, at
    // an arm: the tip is nowhere further than 800 mm from A and C.
    let linear = 3.0_f64.sqrt() * 0.5e-7;
    let rotary = 2.0 * 0.5e-7_f64.to_radians();
    for (grid, mm, rad) in [(Grid::position(), linear, None), (Grid::pose(), linear + 800.0 * rotary, Some(rotary))] {
        for _ in 0..400 {
            let node = random.below(grid.lattice.len());
            let pose = grid.lattice.node(node);
            let command = left::corrected(&pose, &grid.lattice.at_node(node));
            let position = norm(left::position(&grid.machine, &pose, &command, Travel::Mean));
            // 1e-11: rounding of coordinates of half a metre in the model.
            assert!(position <= mm + 1e-11, "{position:e} mm left at {pose:?}");
            // Near A = 0 (and -180) the tool stands along C and the rotary correction is bounded.
            let regular = pose[1].to_radians().sin().abs() > 0.2;
            if let Some(rad) = rad.filter(|_| regular) {
                let tilt = left::tilt(&grid.machine, &pose, &command, Travel::Mean);
                // Two tips 100 mm apart.
                assert!(tilt <= rad + 1e-12, "{tilt:e} rad left at {pose:?}");
            }
        }
    }
}

/// Away from the singular poses the tool axis is put right too; without `--correct pose` it is not.
#[test]
fn correcting_poses_puts_the_tool_axis_right() {
    let grid = Grid::pose();
    let away = |pose: &Pose| pose[1].to_radians().sin().abs() > 0.5;
    let poses: Vec<_> = left::poses(&grid.machine, SEED + 1, 800).into_iter().filter(away).collect();
    assert!(poses.len() > 300);
    let tilts = |command: &dyn Fn(&Pose) -> Pose| {
        p95(&poses.iter().map(|p| left::tilt(&grid.machine, p, &command(p), Travel::Mean) * 1e6).collect::<Vec<_>>())
    };
    let [before, after] = [tilts(&Pose::clone), tilts(&|pose| grid.command(pose))];
    let position_only = tilts(&|pose| Grid::position().command(pose));
    println!(
        "tilt of the tool axis: {before:.2} urad, {after:.2} with, {position_only:.2} correcting the position only"
    );
    assert!(after < 0.1 * before, "{before} urad before, {after} after");
    assert!((position_only / before - 1.0).abs() < 0.01, "{position_only} is not {before}");
}

/// A machine in a file of its own, compiled to a lattice.
fn grid_of(yaml: &str) -> Lattice {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", yaml);
    compile(&machine, "grid-csv", &folder.path("out"), &[]).json();
    Lattice::read(&std::fs::read_to_string(folder.path("out/corrections.csv")).unwrap())
}

fn signs(chain: &str, error: &str) -> String {
    format!(
        "abbe: 1\nmachine: signs\nchain: \"{chain}\"\naxes:\n  X: {{ travel: [0 mm, 600 mm], origin: [0, 0, 0] }}\n  Y: {{ travel: [0 mm, 600 mm], origin: [0, 0, 0] }}\n  \
         Z: {{ travel: [0 mm, 600 mm], origin: [0, 0, 0] }}\ntool: {{ gauge: [250, 225, 0], length: 120 mm }}\nworkpiece: {{ origin: [30, 20, -380] }}\n\
         errors:\n  {error}\nvolume: {{ step: 150 mm }}\n"
    )
}

/// Asserts the corrections (um) of named axes at a pose of named axes, all other axes at 0.
fn corrects(yaml: &str, at: &[(&str, f64)], expected_um: [f64; 3]) {
    let lattice = grid_of(yaml);
    let position = |axis: &String| at.iter().find(|(name, _)| name == axis).map_or(0.0, |(_, q)| *q);
    let pose: Vec<_> = lattice.axes.iter().map(position).collect();
    let found = lattice.at(&pose);
    for (axis, expected) in ["X", "Y", "Z"].iter().zip(expected_um) {
        let index = lattice.axes.iter().position(|known| known == axis).unwrap();
        // Half a last place, and the cosine of 10 urad over 500 mm: 2.5e-5 um.
        assert!(
            (found[index] * 1000.0 - expected).abs() <= 5e-5 + 2.5e-5,
            "{axis}: {found:?}, not {expected_um:?}\n{yaml}"
        );
    }
}

#[test]
fn golden_signs_of_corrections() {
    for chain in ["w b X Y Z t", "w b Z Y X t", "w X' Y' Z' b t", "w Z' X' b Y t"] {
        let case = |error: &str, at, expected| corrects(&signs(chain, error), &[at], expected);
        case("EXX: 10 um", ("X", 100.0), [-10.0, 0.0, 0.0]);
        case("EC0Y: 10 urad", ("Y", 500.0), [5.0, 0.0, 0.0]);
        case("EB0Z: 10 urad", ("Z", 300.0), [-3.0, 0.0, 0.0]);
        case("EA0Z: 10 urad", ("Z", 300.0), [0.0, 3.0, 0.0]);
    }
    // A table that moves itself in + takes the tool to -: to bring the tool back by 10 um it moves 10 um on.
    let direct = signs("w X' Y' Z' b t", "EXX: 10 um").replace("] }\n  Y", "], sense: direct }\n  Y");
    corrects(&direct, &[("X", 100.0)], [10.0, 0.0, 0.0]);
    let body = signs("w X' Y' Z' b t", "EXX: 10 um") + "conventions: { errors_are: body }\n";
    corrects(&body, &[("X", 100.0)], [10.0, 0.0, 0.0]);
}

#[test]
fn golden_signs_of_an_eccentric_rotary_axis() {
    let with_c = |chain| {
        let axis = "axes:\n  C: { travel: continuous, origin: [100, 50, -300] }\n";
        signs(chain, "EX0C: 10 um").replace("axes:\n", axis).replace("150 mm }", "300 mm, C: { step: 90 deg } }")
    };
    // Below the table the slides do not turn: -20 um in X of the machine at 180 deg, (-10, -10) um at 90 deg.
    let table = with_c("w C' b X Y Z t");
    corrects(&table, &[], [0.0; 3]);
    corrects(&table, &[("C", 180.0)], [20.0, 0.0, 0.0]);
    corrects(&table, &[("C", 90.0)], [10.0, 10.0, 0.0]);
    // Before the head they stand as the workpiece does: (20, 0) and (10, -10) um.
    let head = with_c("w b X Y Z C t");
    corrects(&head, &[("C", 180.0)], [-20.0, 0.0, 0.0]);
    corrects(&head, &[("C", 90.0)], [-10.0, 10.0, 0.0]);
    // A slide on the table turns with the workpiece.
    corrects(&with_c("w X' C' b Y Z t"), &[("C", 180.0)], [-20.0, 0.0, 0.0]);
}

/// A rotary axis replaces slides that cannot reach: a lathe's C for its missing Y.
#[test]
fn rotary_axes_reach_where_slides_cannot() {
    let folder = Folder::new();
    let machine = folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: lathe\nchain: \"w C' b Z X t\"\naxes: { X: { travel: [100 mm, 300 mm], origin: [0, 0, 0] }, Z: { travel: [0 mm, 200 mm], origin: [0, 0, 0] }, \
         C: { travel: [-10 deg, 10 deg] } }\nerrors: { EYX: { points: [[100 mm, 10 um], [300 mm, 10 um]] } }\n\
         volume: { step: 50 mm, C: { step: 10 deg } }\n",
    );
    let lattice = |more: &[&str]| {
        let out = folder.path("out");
        let json = compile(&machine, "grid-csv", &out, more).json();
        let lattice = Lattice::read(&std::fs::read_to_string(out.join("corrections.csv")).unwrap());
        (lattice, number(&json, "/compensated/position_um/p95"))
    };
    let (alone, left) = lattice(&[]);
    assert_eq!(alone.corrected.join(" "), "Z X");
    assert!((left - 10.0).abs() < 1e-3, "{left} um left");
    let (with_c, left) = lattice(&["--with", "all"]);
    // 10 um at 200 mm are 50 urad, against the deviation; turning back makes the radius y^2 / 2x too long.
    let expected = [-(0.010_f64 / 200.0).to_degrees(), 0.0, -0.010 * 0.010 / 400.0];
    assert_eq!(with_c.axes.join(" "), "C Z X");
    let found = with_c.at(&[0.0, 100.0, 200.0]);
    // Half a last place; the damping of an arm of 200 mm is (0.1 / 200)^2, taken away by the next step of Newton's.
    assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() <= 0.6e-7), "{found:?}, not {expected:?}");
    // Between 50 mm apart nodes 1/x is off by an eighth of its second difference, at most 0.5 um at 125 mm.
    assert!(left < 0.6, "{left} um left");
}

/// A lattice over some axes holds at position 0 of the others, and is as small as requested.
#[test]
fn smaller_lattices() {
    let folder = Folder::new();
    let out = folder.path("out");
    let machine = support::config::sample(&config("hmc-4ax.yaml"));
    let grid = |more: &[&str]| {
        compile(&config("hmc-4ax.yaml"), "grid-csv", &out, &[&["--poses", "20"], more].concat()).json();
        Lattice::read(&std::fs::read_to_string(out.join("corrections.csv")).unwrap())
    };
    for nodes in ["16", "100", "999"] {
        assert!((16..=nodes.parse().unwrap()).contains(&grid(&["--nodes", nodes]).len()), "{nodes}");
    }
    let lattice = grid(&["--lattice", "Y,Z,X"]);
    assert_eq!((lattice.axes.join(" "), lattice.corrected.join(" ")), ("Z X Y".to_owned(), "Z X Y".to_owned()));
    for node in (0..lattice.len()).step_by(1 + lattice.len() / 50) {
        let [z, x, y] = lattice.node(node)[..] else { panic!("{node}") };
        let [cz, cx, cy] = lattice.at_node(node)[..] else { panic!("{node}") };
        let (pose, command) = (vec![0.0, z, x, y], vec![0.0, z + cz, x + cx, y + cy]);
        let left = norm(left::position(&machine, &pose, &command, Travel::Mean));
        assert!(left <= 3.0_f64.sqrt() * 0.5e-7 + 1e-11, "{left:e} mm left at {pose:?}");
    }
}

/// A continuous axis whose volume does not begin at 0 is looked up in its own turn.
#[test]
fn a_turn_may_begin_anywhere() {
    let yaml = signs("w C' b X Y Z t", "EX0C: 10 um")
        .replace("axes:\n", "axes:\n  C: { travel: continuous, origin: [100, 50, -300] }\n");
    for range in ["[0, 360]", "[-180, 180]", "[-360, 0]", "[90, 450]"] {
        let folder = Folder::new();
        let volume = format!("step: 600 mm, C: {{ range: {range}, step: 15 deg }} }}");
        let machine = folder.write("machine.yaml", &yaml.replace("step: 150 mm }", &volume));
        let certificate = compile(&machine, "grid-csv", &folder.path("out"), &[]).json();
        let [before, after] =
            ["uncompensated", "compensated"].map(|w| number(&certificate, &format!("/{w}/position_um/p95")));
        // Between nodes 15 deg apart a turning vector is short by 1 - cos 7.5 deg = 0.0086.
        assert!(before > 19.0 && after < 0.0086 * 10.0 * 1.01, "{range}: from {before} to {after} um");
    }
}

/// Random machines: the written text is plain, is read back as it was written, and removes the deviation of the mean
/// direction at the nodes as far as the linear axes reach.
#[test]
fn lattices_of_random_machines() {
    let mut random = Random::new(11);
    for (number, conventions) in combinations().enumerate().filter(|(n, _)| n % 2 == 0) {
        let sample = Sample::random(&mut random, conventions, 1e-5);
        let folder = Folder::new();
        let text = coarse(&sample, yaml::write(&sample, &folder));
        let machine = folder.write("machine.yaml", &text);
        let scope = ["position", "pose"][number / 2 % 2];
        let more = ["--poses", "20", "--correct", scope];
        let written = compile(&machine, "grid-csv", &folder.path("out"), &more).json();
        assert_eq!(verify(&machine, &folder.path("out"), &more).json(), written, "{text}");
        let lattice = Lattice::read(&std::fs::read_to_string(folder.path("out/corrections.csv")).unwrap());
        let rotary = sample.rigid.walk.iter().filter(|axis| axis.rotary).count();
        let correcting = if scope == "pose" { sample.rigid.walk.len() } else { sample.rigid.walk.len() - rotary };
        assert_eq!(lattice.corrected.len(), correcting, "{text}");
        for _ in 0..10 {
            let node = random.below(lattice.len());
            nothing_worse(&sample, &lattice, node, scope, &text);
        }
    }
}

/// Steps that keep the lattices of random machines small.
fn coarse(sample: &Sample, text: String) -> String {
    let rotary = sample.rigid.walk.iter().filter(|axis| axis.rotary);
    let steps: String = rotary.map(|axis| format!(", {}: {{ step: 120 deg }}", axis.name)).collect();
    format!("{text}volume: {{ step: 500 mm{steps} }}\n")
}

fn nothing_worse(sample: &Sample, lattice: &Lattice, node: usize, scope: &str, text: &str) {
    let pose = lattice.node(node);
    let command = left::corrected(&pose, &lattice.at_node(node));
    let [before, after] = [&pose, &command].map(|c| norm(left::position(sample, &pose, c, Travel::Mean)));
    if scope == "position" {
        // Rounding of six axes, and the first order of a least-squares solution where slides are too few.
        assert!(after <= before * (1.0 + 1e-3) + 1e-6, "{before:e} mm before, {after:e} after at {pose:?}\n{text}");
    }
    // Slides that span space well reach everywhere, whatever the rotary axes do for the tool's direction.
    if reach(sample, &pose) > 0.05 {
        // Rounding of six axes at arms of 2 m.
        assert!(after <= 2e-5 * before + 2e-6, "{before:e} mm before, {after:e} after at {pose:?}\n{text}");
    }
}

/// Reach of the linear axes at a pose: the largest volume of three of their unit motions.
fn reach(sample: &Sample, pose: &Pose) -> f64 {
    let tip = |pose: &Pose| sample.evaluate(pose, Travel::Mean, Frame::Workpiece).nominal;
    let here = tip(pose);
    let slides = (0..pose.len()).filter(|i| !sample.rigid.walk[*i].rotary);
    let motions: Vec<[f64; 3]> = slides
        .map(|i| {
            let mut moved = pose.clone();
            moved[i] += 1.0;
            crate::oracle::matrix::minus(tip(&moved), here)
        })
        .collect();
    let volume = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        let n = crate::oracle::matrix::cross(a, b);
        (n[0] * c[0] + n[1] * c[1] + n[2] * c[2]).abs()
    };
    let n = motions.len();
    let triples = (0..n).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k))));
    triples.map(|(i, j, k)| volume(motions[i], motions[j], motions[k])).fold(0.0, f64::max)
}

/// The bytes of a set in a folder, by name.
fn bytes(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let back = names(&folder.join("restore")).into_iter().map(|name| format!("restore/{name}"));
    let all = names(folder).into_iter().filter(|name| name != "restore").chain(back);
    all.map(|name| (name.clone(), std::fs::read(folder.join(name)).unwrap())).collect()
}

#[test]
fn same_bytes_on_any_number_of_threads_and_from_anywhere() {
    let folder = Folder::new();
    let machine = config("hmc-4ax.yaml");
    for target in ["linuxcnc", "grid-csv"] {
        let mut first = None;
        for threads in ["1", "2", "3", "elsewhere"] {
            let out = folder.path(&format!("{target}-{threads}"));
            let mut command = support::abbe();
            let file = if threads == "elsewhere" {
                command.current_dir(machine.parent().unwrap());
                Path::new("hmc-4ax.yaml")
            } else {
                command.env("RAYON_NUM_THREADS", threads);
                &machine
            };
            let options = ["--poses", "100", "--target", target, "--format", "json", "--out"];
            let run = Run::of(command.arg("compile").arg(file).args(options).arg(&out));
            run.json();
            let found = (bytes(&out), run.out);
            match &first {
                None => first = Some(found),
                Some(first) => assert!(found == *first, "{target}, {threads}: other bytes"),
            }
        }
    }
}

/// The manifest names the files read and written, with hashes of other code than ours.
#[test]
fn the_manifest_of_a_set_is_right() {
    let folder = Folder::new();
    let out = folder.path("out");
    let certificate = compile(&config("trunnion.yaml"), "linuxcnc", &out, &[]).json();
    let lock: Value = serde_json::from_slice(&std::fs::read(out.join("abbe.lock.json")).unwrap()).unwrap();
    assert_eq!(lock["abbe"], env!("CARGO_PKG_VERSION"));
    assert_eq!(lock["target"], "linuxcnc");
    assert_eq!(lock["machine"], "Trunnion five-axis machining centre");
    assert_eq!(lock["conventions"]["location"], "axis_only");
    let hashes = |list: &Value| -> Vec<(String, String)> {
        let text = |v: &Value| v.as_str().unwrap().to_owned();
        list.as_array().unwrap().iter().map(|file| (text(&file["name"]), text(&file["sha256"]))).collect()
    };
    let written = hashes(&lock["files"]);
    for (name, hash) in &written {
        assert_eq!(&sha256(&std::fs::read(out.join(name)).unwrap()), hash, "{name}");
    }
    let mut listed: Vec<_> = written.into_iter().map(|(name, _)| name).collect();
    let mut said: Vec<_> =
        certificate["files"].as_array().unwrap().iter().map(|n| n.as_str().unwrap().to_owned()).collect();
    let mut present = names(&out);
    present.retain(|name| name != "abbe.lock.json" && name != "restore");
    listed.sort();
    said.sort();
    assert_eq!((&listed, &said), (&present, &present));
    let read = ["trunnion.yaml", "a.csv", "c.csv", "x.csv", "y.csv", "z.csv"];
    let mut inputs = hashes(&lock["inputs"]);
    inputs.sort();
    let mut expected = read.map(|name| {
        let path = if name.ends_with("csv") { format!("errors/trunnion/{name}") } else { name.to_owned() };
        (name.to_owned(), sha256(&std::fs::read(config(&path)).unwrap()))
    });
    expected.sort();
    assert_eq!(inputs, expected);
}
