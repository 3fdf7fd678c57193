//! Statistics against sums of our own over the poses that `eval` gives, pictures, and refusals.

use crate::program::{Folder, abbe, abbe_on, json, refused, text, well_formed};
use serde_json::Value;

/// Vectors of one key of `eval --format json`.
fn vectors(evaluation: &Value, key: &str, factor: f64) -> Vec<[f64; 3]> {
    let of = |pose: &Value| std::array::from_fn(|i| pose[key][i].as_f64().unwrap() * factor);
    evaluation["poses"].as_array().unwrap().iter().map(of).collect()
}

/// The five numbers of the contract, each by the plainest way to compute it.
fn statistics(vectors: &[[f64; 3]]) -> [f64; 7] {
    let n = vectors.len();
    let mut lengths: Vec<f64> = vectors.iter().map(|[x, y, z]| (x * x + y * y + z * z).sqrt()).collect();
    lengths.sort_by(f64::total_cmp);
    let mean = lengths.iter().sum::<f64>() / n as f64;
    let rms = (lengths.iter().map(|l| l * l).sum::<f64>() / n as f64).sqrt();
    // ceil(0.95 n)-th smallest, in whole numbers.
    let rank = (95 * n).div_ceil(100);
    let range = |i: usize| {
        let mut column: Vec<f64> = vectors.iter().map(|v| v[i]).collect();
        column.sort_by(f64::total_cmp);
        column[n - 1] - column[0]
    };
    [lengths[n - 1], mean, rms, lengths[rank - 1], range(0), range(1), range(2)]
}

fn printed(summary: &Value) -> [f64; 7] {
    let number = |v: &Value| v.as_f64().unwrap();
    let r = &summary["range"];
    [&summary["max"], &summary["mean"], &summary["rms"], &summary["p95"], &r[0], &r[1], &r[2]].map(number)
}

#[test]
fn statistics_are_those_of_the_deviations_eval_gives() {
    let folder = Folder::new("statistics");
    for (machine, options) in [
        ("trunnion.yaml", ["--frame", "machine", "--direction", "forward"]),
        ("hh-bd-ram.yaml", ["--frame", "tool", "--order", "2"]),
        ("vmc-cframe-754.yaml", ["--frame", "workpiece", "--tool", "long"]),
    ] {
        let csv = folder.file("map.csv");
        let map = json(
            &[&["map", machine, "--random", "333", "--format", "json", "--csv", text(&csv)], &options[..]].concat(),
        );
        let lines = std::fs::read_to_string(&csv).unwrap();
        let axes = lines.lines().next().unwrap().split(',').take_while(|cell| !cell.starts_with("dx")).count();
        let poses: Vec<String> =
            lines.lines().map(|line| line.split(',').take(axes).collect::<Vec<_>>().join(",")).collect();
        let poses = folder.with("poses.csv", &poses.join("\n"));
        let eval = json(&[&["eval", machine, "--poses", text(&poses), "--format", "json"], &options[..]].concat());
        assert_eq!(map["poses"], 333);
        for (key, in_eval, factor) in [("position_um", "deviation", 1e3), ("rotation_urad", "rotation", 1e6)] {
            let expected = statistics(&vectors(&eval, in_eval, factor));
            for (a, b) in printed(&map[key]).into_iter().zip(expected) {
                // `eval` subtracts positions of a metre and rotations of one, `map` does not: 1e-12 mm, 1e-15 rad.
                assert!((a - b).abs() <= 1e-12 * b.abs() + 1e-9, "{machine} {key}: {a} instead of {b}");
            }
        }
    }
}

#[test]
fn the_grid_is_the_volume_and_the_worst_pose_is_the_worst() {
    let map = json(&["map", "trunnion.yaml", "--format", "json", "--worst", "3"]);
    assert_eq!(map["poses"], 9 * 7 * 9 * 11 * 25);
    let worst = &map["worst"].as_array().unwrap()[0];
    let at: Vec<String> = worst["axes"].as_object().unwrap().iter().map(|(k, v)| format!("{k}={v}")).collect();
    let eval = json(&["eval", "trunnion.yaml", "--at", &at.join(","), "--format", "json"]);
    let length = statistics(&vectors(&eval, "deviation", 1e3))[0];
    assert!((length - map["position_um"]["max"].as_f64().unwrap()).abs() < 1e-9);
    assert_eq!(map["worst"].as_array().unwrap().len(), 3);
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new("threads");
    let run = |threads: usize| {
        let svg = folder.file(&format!("{threads}.svg"));
        let csv = folder.file(&format!("{threads}.csv"));
        let map = abbe_on(
            threads,
            &["map", "trunnion.yaml", "--random", "5000", "--format", "json", "--svg", text(&svg), "--csv", text(&csv)],
        );
        let compare =
            abbe_on(threads, &["compare", "trunnion.yaml", "hh-bd-ram.yaml", "--poses", "200", "--format", "csv"]);
        assert!(map.status.success() && compare.status.success());
        [map.stdout, compare.stdout, std::fs::read(svg).unwrap(), std::fs::read(csv).unwrap()]
    };
    let one = run(1);
    assert!(one.iter().all(|bytes| !bytes.is_empty()));
    for threads in [2, 3] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

#[test]
fn more_than_a_million_poses_are_surveyed_and_streamed() {
    let folder = Folder::new("survey");
    // 101 x 101 x 99 nodes.
    let machine = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: m\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0, 500], origin: [0, 0, 0] }\n  Y: { travel: [0, 500], origin: [0, 0, 0] }\n  Z: { travel: [0, 490], origin: [0, 0, 0] }\nerrors:\n  EC0Y: 20 urad\n  EB0Z: -9 urad\n  EXX: { polynomial: [0 um, 5 um/m] }\nvolume: { step: 5 mm }\n",
    );
    let csv = folder.file("map.csv");
    let run = |threads: usize, more: &[&str]| {
        let output = abbe_on(threads, &[&["map", text(&machine), "--order", "1", "--format", "json"], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let map: Value = serde_json::from_slice(&run(2, &[])).unwrap();
    assert_eq!(map["poses"], 101 * 101 * 99);
    // dx = -y EC0Y + z EB0Z + 5e-6 x um, so the extremes are at corners of the volume.
    let [max, .., range_x, range_y, _] = printed(&map["position_um"]);
    assert!((max - (500.0 * 20e-3 + 490.0 * 9e-3)).abs() < 1e-9, "{max}");
    assert!((range_x - (10.0 + 4.41 + 2.5)).abs() < 1e-9 && range_y.abs() < 1e-12, "{range_x} {range_y}");
    let lines = |text: &str| text.lines().count();
    for threads in [1, 3] {
        assert_eq!(run(threads, &["--csv", text(&csv)]), run(2, &[]), "{threads} threads");
        let table = std::fs::read_to_string(&csv).unwrap();
        assert_eq!(lines(&table), 1 + 101 * 101 * 99);
        assert_eq!(
            table.lines().next(),
            Some("X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um],wx [urad],wy [urad],wz [urad]")
        );
        assert!(table.ends_with('\n') && table.lines().last().unwrap().starts_with("500,500,490,"));
    }
    let (code, message) = refused(&["map", text(&machine), "--format", "csv"]);
    assert!(code == 1 && message.contains("E0541") && message.contains("--csv"), "{message}");
}

#[test]
fn pictures_are_well_formed_for_every_config() {
    let folder = Folder::new("planes");
    for name in crate::configs::names() {
        let svg = folder.file("plane.svg");
        let output = abbe_on(2, &["map", &name, "--random", "10", "--svg", text(&svg), "--component", "dx", "--quiet"]);
        if output.status.code() == Some(2) {
            assert!(String::from_utf8_lossy(&output.stderr).contains("no two linear axes"), "{name}");
            continue;
        }
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let picture = std::fs::read_to_string(&svg).unwrap();
        well_formed(&picture).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert!(picture.contains("Sign: actual minus nominal") && picture.contains("Frame: workpiece"), "{name}");
    }
}

#[test]
fn a_plane_without_errors_and_a_hostile_name_are_drawn() {
    let folder = Folder::new("hostile");
    let machine = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: '</script><b>&\"x''y'\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0 mm, 6000 mm], origin: [0, 0, 0] }\n  Y: { travel: [0 mm, 30 mm], origin: [0, 0, 0] }\n  Z: { travel: [0 mm, 100 mm], origin: [0, 0, 0] }\n",
    );
    let svg = folder.file("p.svg");
    abbe(&["map", text(&machine), "--random", "5", "--svg", text(&svg)]);
    let picture = std::fs::read_to_string(&svg).unwrap();
    well_formed(&picture).unwrap();
    assert!(
        picture.contains("&lt;/script&gt;&lt;b&gt;&amp;") && !picture.contains("<b>") && !picture.contains("</script")
    );
    assert!(picture.contains("No deviation within the plane"));
    abbe(&["show", text(&machine), "--svg", text(&svg)]);
    well_formed(&std::fs::read_to_string(&svg).unwrap()).unwrap();
}

#[test]
fn what_cannot_be_done_is_refused_with_nothing_written() {
    let folder = Folder::new("refused");
    let fine = folder.with(
        "fine.yaml",
        "abbe: 1\nmachine: m\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0, 500], origin: [0, 0, 0] }\n  Y: { travel: [0, 500], origin: [0, 0, 0] }\n  Z: { travel: [0, 500], origin: [0, 0, 0] }\nvolume: { step: 0.5 mm }\n",
    );
    let (code, message) = refused(&["map", text(&fine)]);
    assert!(
        code == 1 && message.contains("E0812") && message.contains("1003003001") && message.contains("--random"),
        "{message}"
    );
    let nowhere = folder.file("none/map.csv");
    let (code, message) = refused(&["map", "trunnion.yaml", "--random", "10", "--csv", text(&nowhere)]);
    assert!(code == 1 && message.contains("E0810"), "{message}");
    let (code, _) = refused(&["map", "trunnion.yaml", "--random", "10", "--svg", "/dev/full"]);
    assert_eq!(code, 1);
    for plane in ["XX", "XA", "X", "XYZ", "", "X,,Y"] {
        let svg = folder.file("p.svg");
        let (code, message) =
            refused(&["map", "trunnion.yaml", "--random", "10", "--svg", text(&svg), "--plane", plane]);
        assert!(code == 2 && message.contains("linear axes"), "{plane}: {message}");
    }
    assert_eq!(refused(&["map", "trunnion.yaml", "--random", "0"]).0, 2);
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 1);
}

/// An arm that turns by 10 mrad too far: the tip moves by r (cos - 1, sin), of which each degree has one term.
#[test]
fn one_degree_of_an_arm_is_its_taylor_term() {
    let folder = Folder::new("one-degree");
    let machine = "abbe: 1\nmachine: Arm\nchain: \"w b C X t\"\naxes:\n  C: { travel: [-180 deg, 180 deg], origin: [0, 0, 0] }\n  X: { travel: [50 mm, 200 mm] }\nerrors: { ECC: 10 mrad }\n";
    let machine = folder.with("arm.yaml", machine);
    let csv = folder.file("arm.csv");
    // Along the arm and across it, um.
    for (degree, wanted) in [("1", [0.0, 1e-2]), ("2", [-5e-5, 0.0]), ("3", [0.0, -1e-6 / 6.0])] {
        let arguments = ["map", text(&machine), "--quiet", "--random", "40", "--degree", degree, "--csv", text(&csv)];
        let said = abbe(&arguments);
        assert!(said.contains(&format!("degree {degree} in the errors alone")), "{said}");
        for line in std::fs::read_to_string(&csv).unwrap().lines().skip(1) {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let (sine, cosine) = cells[0].to_radians().sin_cos();
            let found = [cosine * cells[2] + sine * cells[3], cosine * cells[3] - sine * cells[2]];
            for k in 0..2 {
                assert!((found[k] - wanted[k] * cells[1] * 1e3).abs() < 1e-9, "{degree}: {line}");
            }
        }
    }
    for more in [&["--order", "2"][..], &["--target", "linuxcnc"], &["--reference", "best-fit"]] {
        let (code, said) = refused(&[&["map", text(&machine), "--degree", "2"], more].concat());
        assert!(code == 2 && said.contains("--degree"), "{said}");
    }
}
