//! Test pieces: the geometry of their tables by itself, and tolerances of their features against closed forms and a
//! search over all vertices.

use crate::program::{Folder, abbe, json, refused, text};
use serde_json::Value;
use std::path::{Path, PathBuf};

type V3 = [f64; 3];

/// A row of a table: tip, tool axis, normal, feature.
struct Row {
    tip: V3,
    axis: V3,
    normal: V3,
    feature: String,
}

fn dot(a: V3, b: V3) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: V3, b: V3) -> V3 {
    std::array::from_fn(|k| a[k] - b[k])
}

fn length(a: V3) -> f64 {
    dot(a, a).sqrt()
}

fn rows(path: &Path) -> Vec<Row> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let three = |first: usize| -> V3 { std::array::from_fn(|k| cells[first + k].parse().unwrap()) };
        Row { tip: three(0), axis: three(3), normal: three(6), feature: cells[9].to_owned() }
    };
    let table = std::fs::read_to_string(path).unwrap();
    assert!(table.starts_with("X [mm],Y [mm],Z [mm],I,J,K,NX,NY,NZ,feature\n"));
    table.lines().skip(1).map(row).collect()
}

/// Writes a piece and returns its job file.
fn piece(folder: &Folder, kind: &str, more: &[&str]) -> PathBuf {
    let name = format!("{kind}{}", more.join(""));
    let out = folder.file(&name);
    let _ = abbe(&[&["testpiece", kind, "--out", text(&out)], more].concat());
    out.join(format!("{kind}.yaml"))
}

fn table(job: &Path) -> Vec<Row> {
    let rows = rows(&job.with_extension("csv"));
    for row in &rows {
        assert!((length(row.axis) - 1.0).abs() < 1e-11 && (length(row.normal) - 1.0).abs() < 1e-11);
        // Flank milling: the tool lies in the surface.
        assert!(dot(row.axis, row.normal).abs() < 1e-11);
    }
    // Normals are across the path, within what the chord of a step is off.
    for three in rows.windows(3).filter(|three| three[0].feature == three[2].feature) {
        let chord = minus(three[2].tip, three[0].tip);
        assert!(dot(chord, three[1].normal).abs() < 1e-3 * length(chord), "{}", three[1].feature);
    }
    rows
}

#[test]
fn the_tool_lies_in_the_cone() {
    let folder = Folder::new("pieces-cone");
    for (more, half, tilt, motion) in [
        (&[][..], 15.0, 10.0, "turn"),
        (&["--half-apex", "45", "--tilt", "30"], 45.0, 30.0, "turn"),
        (&["--c-motion", "pole"], 15.0, 15.0, "pole"),
        (&["--c-motion", "swing"], 15.0, 30.0, "swing"),
    ] {
        let list = table(&piece(&folder, "cone", more));
        assert_eq!(list.len(), 361);
        let (half, tilt) = (f64::to_radians(half), f64::to_radians(tilt));
        let axis = [tilt.sin(), 0.0, tilt.cos()];
        let apex: V3 = std::array::from_fn(|k| [0.0, 0.0, 120.0][k] + 40.0 / half.tan() * axis[k]);
        let mut steepest = 0.0_f64;
        for row in &list {
            let line = minus(apex, row.tip);
            // The line from the tip along the tool meets the apex, at half of its angle to the axis.
            assert!(
                (dot(line, row.axis) - length(line)).abs() < 1e-9 && (dot(row.axis, axis) - half.cos()).abs() < 1e-9
            );
            assert!((length(line) - 40.0 / half.sin()).abs() < 1e-5);
            // The normal leans outwards by the same angle.
            assert!((dot(row.normal, axis) - half.sin()).abs() < 1e-9);
            steepest = steepest.max(row.axis[2].acos());
        }
        // C follows the azimuth of the tool: a whole turn only where the axis leans less than the half apex.
        let azimuth = |row: &Row| row.axis[1].atan2(row.axis[0]);
        let turned: f64 = list
            .windows(2)
            .map(|two| (azimuth(&two[1]) - azimuth(&two[0])).sin())
            .filter(|step| step.abs() < 0.5)
            .sum::<f64>()
            .to_degrees();
        assert!(if motion == "turn" { (turned.abs() - 360.0).abs() < 2.0 } else { turned.abs() < 200.0 }, "{turned}");
        let out = folder.file("again");
        let found = json(&[&["testpiece", "cone", "--out", text(&out), "--format", "json"], more].concat());
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(found["c_motion"], motion);
        assert!((found["largest_tilt_deg"].as_f64().unwrap() - steepest.to_degrees()).abs() < 1e-6);
    }
    // The row of the cone that is inspected elsewhere: base of 80 mm at 120, half apex 15, tilt 10.
    let first = &table(&piece(&folder, "cone", &["--steps", "8"]))[0];
    assert_eq!((first.tip, first.feature.as_str()), ([39.392310, 0.0, 113.054073], "cone"));
    assert!((first.axis[0] + 5_f64.to_radians().sin()).abs() < 1e-11);
}

#[test]
fn ruled_and_flat_pieces_have_their_geometry() {
    let folder = Folder::new("pieces-flat");
    let leans: Vec<f64> =
        table(&piece(&folder, "s-shape", &[])).iter().map(|row| row.axis[2].acos().to_degrees()).collect();
    let steepest = leans.iter().copied().fold(0.0, f64::max);
    assert!((steepest - 20.0).abs() < 1e-6 && leans.iter().any(|lean| *lean < 0.5), "{steepest}");
    // The sides of square and diamond, by their distance from the axis; the diamond fits into the square.
    for (kind, angle, side) in [("square", 0.0, 160.0), ("diamond", 30.0, 160.0 / 1.366_025_403_784_438_6)] {
        let list = table(&piece(&folder, kind, &["--steps", "10"]));
        assert_eq!(list.len(), 44);
        for row in &list {
            assert!((dot(row.tip, row.normal) - 0.5 * side).abs() < 1e-6 && row.tip[2] == 20.0);
            let k: f64 = row.feature.rsplit('-').next().unwrap().parse().unwrap();
            let out = f64::to_radians(angle - 90.0 + 90.0 * (k - 1.0));
            assert!((row.normal[0] - out.cos()).abs() < 1e-11 && (row.normal[1] - out.sin()).abs() < 1e-11);
        }
    }
    let list = table(&piece(&folder, "nas-979", &["--piece-size", "320", "--steps", "12"]));
    let heights =
        |name: &str| list.iter().filter(|row| row.feature.starts_with(name)).map(|row| row.tip[2]).sum::<f64>();
    assert_eq!((heights("square"), heights("diamond"), heights("circle")), (52.0 * 20.0, 52.0 * 40.0, 13.0 * 60.0));
    // Each file says what rests on memory.
    for kind in ["square", "diamond", "circle", "cone", "s-shape", "nas-979"] {
        let out = folder.file(&format!("memory-{kind}"));
        let _ = abbe(&["testpiece", kind, "--out", text(&out)]);
        let job = std::fs::read_to_string(out.join(format!("{kind}.yaml"))).unwrap();
        assert!(job.contains("memory") && job.lines().all(|line| line.len() <= 100), "{job}");
        let (code, complaint) = refused(&["testpiece", kind, "--steps", "9", "--out", text(&out)]);
        assert!(code == 1 && complaint.contains("E0811"), "{complaint}");
    }
    let (code, complaint) = refused(&["testpiece", "cone", "--half-apex", "85", "--out", text(&folder.file("x"))]);
    assert!(code == 2 && complaint.contains("below 80 deg"), "{complaint}");
}

#[test]
fn options_of_another_kind_and_sizes_of_no_piece_are_refused() {
    let folder = Folder::new("pieces-options");
    // Which of half apex, tilt and motion of C a kind has.
    let kinds = [
        ("square", [false; 3]),
        ("diamond", [false, true, false]),
        ("circle", [false; 3]),
        ("cone", [true; 3]),
        ("s-shape", [false, true, false]),
        ("nas-979", [false, true, false]),
    ];
    for (kind, has) in kinds {
        for (i, option) in [["--half-apex", "15"], ["--tilt", "20"], ["--c-motion", "turn"]].iter().enumerate() {
            let out = folder.file(&format!("{kind}-{i}"));
            let (code, said) = refused(&[&["testpiece", kind, "--out", text(&out)], &option[..]].concat());
            let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
            assert_eq!((code, out.exists()), if has[i] { (0, true) } else { (2, false) }, "{kind} {option:?}: {said}");
            let others = kinds.iter().filter(|(_, has)| has[i]).map(|(kind, _)| *kind).collect::<Vec<_>>().join(", ");
            let named = words.contains(&format!("is no option of `{kind}`: it is one of {others}"));
            assert!(has[i] || named, "{said}");
        }
        for option in [["--piece-size", "1e-300"], ["--height", "0.09"], ["--piece-size", "100001"]] {
            let out = folder.file("no-piece");
            let (code, said) = refused(&[&["testpiece", kind, "--out", text(&out)], &option[..]].concat());
            assert!(code == 2 && said.contains("0.1 to 100000") && !out.exists(), "{said}");
        }
        // The least piece with the most steps has no two rows alike.
        let least = piece(&folder, kind, &["--piece-size", "0.1", "--height", "0.1", "--steps", "1000"]);
        let rows = rows(&least.with_extension("csv"));
        assert!(rows.windows(2).all(|two| two[0].tip != two[1].tip), "{kind}");
    }
    // What the user states is not from memory.
    let note = |more: &[&str]| {
        let job = std::fs::read_to_string(piece(&folder, "cone", more)).unwrap();
        job.lines().filter_map(|line| line.strip_prefix("# ")).collect::<Vec<_>>().join(" ")
    };
    let all = note(&[]);
    assert!(
        ["base of 80 mm", "half apex of 15 deg", "tilt of 10 deg"].iter().all(|words| all.contains(words)),
        "{all}"
    );
    let own = note(&["--half-apex", "60", "--tilt", "60", "--piece-size", "90"]);
    assert!(!own.contains(" of 15 deg") && !own.contains(" of 10 deg") && !own.contains("80 mm"), "{own}");
    assert!(own.contains("roundness of 80 um") && own.contains("half apex 60 deg"), "{own}");
}

/// A table of three axes whose X and Y are out of square.
fn plane(folder: &Folder, error: &str) -> PathBuf {
    let machine = format!(
        "abbe: 1\nmachine: Plane\nchain: w b X Y Z t\naxes:\n  X: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  Y: \
         {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  Z: {{ travel: [-300, 300], origin: [0, 0, 0] }}\nerrors: {{ \
         EC0Y: {error} }}\n"
    );
    folder.with("plane.yaml", &machine)
}

fn found<'a>(result: &'a Value, feature: &str, kind: &str) -> &'a Value {
    let all = result["characteristics"].as_array().unwrap();
    all.iter().find(|of| of["feature"] == feature && of["kind"] == kind).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A squareness of 20 urad tilts two sides of the square, makes the circle an ellipse, and is all of both.
#[test]
fn a_squareness_makes_the_features_that_it_should() {
    let folder = Folder::new("pieces-square");
    let machine = plane(&folder, "{ value: 20 urad, uncertainty: 4 urad }");
    let job = piece(&folder, "nas-979", &["--steps", "72"]);
    let map = json(&["map", text(&machine), "--job", text(&job), "--format", "json"]);
    let (alpha, side) = (20e-3, 0.9 * 160.0);
    for (feature, kind, um) in [
        ("square-1", "straightness", 0.0),
        ("square-2", "perpendicularity", alpha * side),
        ("square-3", "parallelism", 0.0),
        ("square-4", "perpendicularity", alpha * side),
        // The sides of the diamond turn by alpha sin^2 of their angle to X.
        ("diamond-1", "angularity", alpha * 0.25 * 0.9 * 160.0 / 1.366_025_403_784_438_6),
        ("diamond-2", "angularity", alpha * 0.75 * 0.9 * 160.0 / 1.366_025_403_784_438_6),
        ("circle", "roundness", alpha * 0.5 * 160.0 / 1.366_025_403_784_438_6),
    ] {
        let of = found(&map, feature, kind);
        assert!((number(&of["value_um"]) - um).abs() < 2e-3 * um + 1e-6, "{feature} {kind}: {of} {um}");
        assert_eq!(of["holds"], true);
        if um > 0.0 {
            let part = &of["errors"][0];
            assert_eq!(part["error"], "EC0Y");
            assert!((number(&part["share"]) - 1.0).abs() < 1e-3, "{of}");
            // The expanded uncertainty of 4 urad: a fifth, of which the middle 95 % are 1.96 of 2.
            let [low, high] = [0, 1].map(|k| number(&of["interval_um"][k]));
            assert!((low / um - 1.0 + 0.196).abs() < 0.02 && (high / um - 1.0 - 0.196).abs() < 0.02, "{of}");
        }
    }
    // A part that is turned on the table has the same sides out of square; as text it stays within 80 columns.
    let turned = std::fs::read_to_string(&job).unwrap().replace("rotation: [0, 0, 0]", "rotation: [0, 0, 90]");
    let turned = folder.with("nas-979--steps72/turned.yaml", &turned);
    let map = json(&["map", text(&machine), "--job", text(&turned), "--format", "json"]);
    let of = found(&map, "square-2", "perpendicularity");
    assert!((number(&of["value_um"]) - alpha * side).abs() < 1e-6, "{of}");
    let printed = abbe(&["map", text(&machine), "--job", text(&job)]);
    let lines = printed.lines().skip_while(|line| !line.starts_with("Features by"));
    let lines: Vec<&str> = lines.take_while(|line| !line.starts_with("Travel")).collect();
    assert!(lines.len() > 20 && lines.iter().all(|line| line.len() <= 80), "{printed}");
}

/// From a bound of 20 urad, evenly distributed, the perpendicularity is evenly distributed up to 2.88 um.
#[test]
fn a_bound_makes_a_distribution() {
    let folder = Folder::new("pieces-bounds");
    let job = piece(&folder, "square", &["--steps", "9"]);
    let text_of_job = std::fs::read_to_string(&job)
        .unwrap()
        .replace("tolerance: 15 um, datum: square-1", "tolerance: 1.44 um, datum: square-1");
    let job = folder.with("square--steps9/tight.yaml", &text_of_job);
    let machine = plane(&folder, "{ tolerance: 20 urad }");
    let run = |verb: &str| json(&[verb, text(&machine), "--job", text(&job), "--samples", "2000", "--format", "json"]);
    let (budget, map) = (run("budget"), run("map"));
    for result in [&budget, &map] {
        let of = found(result, "square-2", "perpendicularity");
        let (drawn, full) = (&of["drawn"], 2.88);
        assert!((number(&drawn["median_um"]) / full - 0.5).abs() < 0.04, "{of}");
        assert!((number(&drawn["p95_um"]["value"]) / full - 0.95).abs() < 0.02, "{of}");
        let [value, low, high] = ["value", "low", "high"].map(|key| number(&drawn["holds"][key]));
        assert!(low < 0.5 && 0.5 < high && low < value && value < high && (high - low - 0.0437).abs() < 2e-3, "{of}");
        assert_eq!(of["errors"][0]["error"], "EC0Y");
        assert!((number(&of["errors"][0]["share"]) - 1.0).abs() < 1e-9 && of["value_um"].is_null(), "{of}");
    }
    assert_eq!(found(&budget, "square-2", "perpendicularity"), found(&map, "square-2", "perpendicularity"));
    let printed = abbe(&["budget", text(&machine), "--job", text(&job)]);
    assert!(printed.contains("| square-2 | perpendicularity to square-1 | 1.44 |"), "{printed}");
}

/// A value beside a bound counts in every machine drawn.
#[test]
fn values_count_beside_bounds() {
    let folder = Folder::new("pieces-both");
    let job = piece(&folder, "square", &["--steps", "9"]);
    let machine = plane(&folder, "20 urad");
    let with_bound = std::fs::read_to_string(&machine)
        .unwrap()
        .replace("EC0Y: 20 urad", "EC0Y: 20 urad, EC0X: { tolerance: 1 urad }");
    let both = folder.with("both.yaml", &with_bound.replace("chain: w b X Y Z t", "chain: w X' b Y Z t"));
    let budget = json(&["budget", text(&both), "--job", text(&job), "--samples", "200", "--format", "json"]);
    let of = found(&budget, "square-2", "perpendicularity");
    let drawn = &of["drawn"];
    assert!(
        (number(&drawn["median_um"]) - 2.88).abs() < 0.15 && number(&drawn["p95_um"]["value"]) >= 2.88 - 0.15,
        "{of}"
    );
    assert_eq!(of["errors"][0]["error"], "values");
}

/// The roundness of the cone by the deviations of the map and a search over all sets of four rows.
#[test]
fn roundness_is_that_of_all_vertices() {
    let folder = Folder::new("pieces-vertices");
    let job = piece(&folder, "cone", &["--steps", "12"]);
    let csv = folder.file("map.csv");
    let arguments = ["map", "hh-ca-gantry.yaml", "--job", text(&job), "--reference", "machine"];
    let map = json(&[&arguments[..], &["--csv", text(&csv), "--format", "json"]].concat());
    let list = table(&job);
    let map_rows = std::fs::read_to_string(&csv).unwrap();
    let header: Vec<&str> = map_rows.lines().next().unwrap().split(',').collect();
    let dx = header.iter().position(|name| *name == "dx [um]").unwrap();
    let deviation = |line: &str| -> V3 {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        [cells[dx], cells[dx + 1], cells[dx + 2]]
    };
    let e: Vec<f64> = map_rows.lines().skip(1).zip(&list).map(|(line, row)| dot(deviation(line), row.normal)).collect();
    assert_eq!(e.len(), 13);
    let basis = |i: usize| {
        let angle = std::f64::consts::TAU * i as f64 / 12.0;
        [1.0, angle.cos(), angle.sin()]
    };
    let mut best = f64::INFINITY;
    for set in (0_u32..1 << 13).filter(|set| set.count_ones() == 4) {
        let four: Vec<usize> = (0..13).filter(|i| set >> i & 1 == 1).collect();
        for signs in 0..16 {
            let system: [[f64; 5]; 4] = std::array::from_fn(|k| {
                let [a, b, c] = basis(four[k]);
                [a, b, c, if signs >> k & 1 == 1 { 1.0 } else { -1.0 }, e[four[k]]]
            });
            let Some([a, b, c, _]) = solve(system) else { continue };
            let residual = |i: usize| e[i] - a * basis(i)[0] - b * basis(i)[1] - c * basis(i)[2];
            best = best.min((0..13).map(|i| residual(i).abs()).fold(0.0, f64::max));
        }
    }
    let of = found(&map, "cone", "roundness");
    assert!((number(&of["minimum_zone_um"]) - 2.0 * best).abs() < 1e-6, "{of} {best}");
    assert!(number(&of["least_squares_um"]) >= number(&of["minimum_zone_um"]));
    // Parts of first order add up to the value, but for the second order of the errors.
    let whole = json(&[&arguments[..], &["--order", "1", "--format", "json"]].concat());
    let of = found(&whole, "cone", "roundness");
    let parts: f64 = of["errors"].as_array().unwrap().iter().map(|part| number(&part["um"])).sum();
    assert!(parts > 0.3 * number(&of["value_um"]), "{of}");
}

fn solve(mut a: [[f64; 5]; 4]) -> Option<[f64; 4]> {
    for k in 0..4 {
        let pivot = (k..4).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs()))?;
        a.swap(k, pivot);
        if a[k][k].abs() < 1e-9 {
            return None;
        }
        for i in (0..4).filter(|i| *i != k) {
            let factor = a[i][k] / a[k][k];
            (0..5).for_each(|j| a[i][j] -= factor * a[k][j]);
        }
    }
    Some(std::array::from_fn(|k| a[k][4] / a[k][k]))
}

#[test]
fn tolerances_that_do_not_fit_are_refused_in_words() {
    let folder = Folder::new("pieces-refused");
    let machine = plane(&folder, "20 urad");
    let _ = folder.with("bare.csv", "X,Y,Z,feature\n0,0,0,line\n10,0,0,line\n20,0,0,line\n0,10,0,other\n");
    let _ = folder.with("half.csv", "X,Y,Z,NX,feature\n0,0,0,1,line\n");
    let _ = folder.with("zero.csv", "X,Y,Z,NX,NY,NZ,feature\n0,0,0,0,0,0,line\n");
    for (code, said, table, features) in [
        ("E0860", "add the columns NX, NY, NZ", "bare.csv", "line: { kind: straightness, tolerance: 1 um }"),
        ("E0860", "no feature `lime`", "bare.csv", "lime: { kind: straightness }"),
        ("E0860", "no feature `base`", "bare.csv", "line: { kind: parallelism, datum: base }"),
        ("E0860", "1 of its tool poses are reached, and 2 are needed", "bare.csv", "other: { kind: profile }"),
        ("E0851", "no tolerance", "bare.csv", "line: { kind: straightness, tolerance: 1 urad }"),
        ("E0210", "`flat` is not a choice for `kind`", "bare.csv", "line: { kind: flat }"),
        ("E0851", "`datum` has no effect on flatness", "bare.csv", "line: { kind: flatness, datum: other }"),
        ("E0851", "`free` has no effect on flatness", "bare.csv", "line: [{ kind: flatness, free: true }]"),
        ("E0817", "NX, NY and NZ all are needed", "half.csv", "line: { kind: straightness }"),
        ("E0817", "the normal NX, NY, NZ has no direction", "zero.csv", "line: { kind: straightness }"),
    ] {
        let job = folder.with("job.yaml", &format!("tool_poses: {table}\nfeatures:\n  {features}\n"));
        let (exit, complaint) = refused(&["map", text(&machine), "--job", text(&job)]);
        let words = complaint.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(exit == 1 && words.contains(code) && words.contains(said), "{features}: {complaint}");
    }
}

#[test]
fn a_box_has_five_faces_with_the_tool_across_each() {
    let folder = Folder::new("pieces-box");
    let job = piece(&folder, "box", &["--piece-size", "100", "--height", "60", "--steps", "8"]);
    let list = rows(&job.with_extension("csv"));
    let faces = [("top", 2, 60.0), ("front", 1, -50.0), ("right", 0, 50.0), ("back", 1, 50.0), ("left", 0, -50.0)];
    assert_eq!(list.len(), 45);
    for (name, along, at) in faces {
        let face: Vec<&Row> = list.iter().filter(|row| row.feature == name).collect();
        let mut places: Vec<V3> = face.iter().map(|row| row.tip).collect();
        places.sort_by(|a, b| a.partial_cmp(b).unwrap());
        places.dedup();
        assert_eq!(places.len(), 9, "{name}");
        for row in face {
            let outward: V3 = std::array::from_fn(|k| if k == along { f64::signum(at) } else { 0.0 });
            assert_eq!((row.tip[along], row.axis, row.normal), (at, outward, outward), "{name}");
        }
        for k in (0..3).filter(|k| *k != along) {
            let middle = if k == 2 { [0.0, 30.0, 60.0] } else { [-50.0, 0.0, 50.0] };
            assert!(places.iter().all(|tip| middle.contains(&tip[k])), "{name}");
        }
    }
    let map = json(&["map", "trunnion.yaml", "--job", text(&job), "--quiet", "--format", "json"]);
    assert_eq!((&map["over"]["kind"], &map["over"]["path"]), (&serde_json::json!("job"), &serde_json::json!(false)));
    assert!(std::fs::read_to_string(&job).unwrap().contains("reference: { kind: zero, point: [0, 0, 60] }"));
    assert_eq!(map["poses"].as_u64().unwrap() + map["unreached"]["count"].as_u64().unwrap_or(0), 45, "{map}");
    // The height is that of a cube if nobody states it; a few more poses make the rows equal.
    let cube = rows(&piece(&folder, "box", &["--steps", "10"]).with_extension("csv"));
    assert_eq!(cube.len(), 5 * 16);
    assert_eq!(cube.iter().map(|row| row.tip[2]).fold(0.0, f64::max), 160.0);
    assert!(refused(&["testpiece", "box", "--tilt", "3", "--out", text(&folder.file("t"))]).1.contains("the tilt"));
}
