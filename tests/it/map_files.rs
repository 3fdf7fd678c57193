//! Files of `map` for other programs, and maps of a compensated machine.

use crate::program::{Folder, abbe, json, refused, text};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Header and numbers of a CSV file.
fn csv(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().split(',').map(str::to_owned).collect();
    (header, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
}

/// An appended array of a `.vtu` file, by its name: its raw bytes.
pub fn array<'a>(file: &'a [u8], name: &str) -> &'a [u8] {
    let start = file.windows(4).position(|w| w == b"\n _" || w == b">\n_").map(|i| i + 3);
    let start = start.unwrap_or_else(|| file.windows(3).position(|w| w == b">\n_").unwrap() + 3);
    let head = String::from_utf8_lossy(&file[..start]).into_owned();
    let element = head.split("<DataArray ").find(|e| e.contains(&format!("Name=\"{name}\""))).unwrap().to_owned();
    let offset: usize = element.split("offset=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
    let at = start + offset;
    let length = u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
    &file[at + 8..at + 8 + length]
}

pub fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

fn integers(bytes: &[u8]) -> Vec<usize> {
    bytes.chunks(8).map(|b| i64::from_le_bytes(b.try_into().unwrap()) as usize).collect()
}

#[test]
fn all_forms_hold_the_same_numbers_to_the_last_bit() {
    let folder = Folder::new("forms");
    let [c, j, p, v] = ["m.csv", "m.json", "m.parquet", "m.vtu"].map(|name| folder.file(name));
    abbe(&[
        "map",
        "ht-b-c.yaml",
        "--random",
        "70",
        "--frame",
        "machine",
        "--csv",
        text(&c),
        "--json",
        text(&j),
        "--parquet",
        text(&p),
        "--vtk",
        text(&v),
    ]);
    let (header, rows) = csv(&c);
    assert_eq!(rows.len(), 70);
    let parsed: Value = serde_json::from_str(&std::fs::read_to_string(&j).unwrap()).unwrap();
    assert_eq!((parsed["frame"].as_str(), parsed["order"].as_str()), (Some("machine"), Some("exact")));
    let reader = SerializedFileReader::new(std::fs::File::open(&p).unwrap()).unwrap();
    let facts = reader.metadata().file_metadata().key_value_metadata().unwrap();
    assert!(
        facts.iter().any(|kv| kv.key == "sign" && kv.value.as_deref().unwrap().starts_with("actual minus nominal"))
    );
    let names: Vec<String> =
        reader.metadata().file_metadata().schema().get_fields().iter().map(|f| f.name().to_owned()).collect();
    assert_eq!(names, header);
    for ((row, object), record) in
        rows.iter().zip(parsed["poses"].as_array().unwrap()).zip(reader.get_row_iter(None).unwrap())
    {
        let numbers = |v: &Value| v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
        let axes: Vec<f64> = object["axes"].as_object().unwrap().values().map(|x| x.as_f64().unwrap()).collect();
        assert_eq!([axes, numbers(&object["deviation_um"]), numbers(&object["rotation_urad"])].concat(), *row);
        let record = record.unwrap();
        assert_eq!((0..row.len()).map(|k| record.get_double(k).unwrap()).collect::<Vec<_>>(), *row);
    }
    let file = std::fs::read(&v).unwrap();
    let deviations: Vec<f64> = rows.iter().flat_map(|row| row[row.len() - 6..row.len() - 3].to_vec()).collect();
    assert_eq!(doubles(array(&file, "deviation_um")), deviations);
    let first = header[0].replace(" [", "_").replace(']', "");
    assert_eq!(doubles(array(&file, &first)), rows.iter().map(|row| row[0]).collect::<Vec<_>>());
    assert!(array(&file, "types").iter().all(|kind| *kind == 1), "random poses are vertices");
}

#[test]
fn a_grid_is_joined_to_cells_that_fill_the_volume() {
    let folder = Folder::new("cells");
    let file = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: m\nchain: \"w C' X' b Y Z t\"\naxes:\n  X: { travel: [0, 300], origin: [0, 0, 0] }\n  Y: { travel: [0, 200], origin: [0, 0, 0] }\n  Z: { travel: [-100, 0], origin: [0, 0, 0] }\n  C: { travel: continuous }\nworkpiece: { origin: [10, 20, 30] }\nerrors:\n  EC0Y: 20 urad\nvolume: { step: 100 mm, C: { step: 120 deg } }\n",
    );
    let out = folder.file("m.vtu");
    abbe(&["map", text(&file), "--vtk", text(&out)]);
    let bytes = std::fs::read(&out).unwrap();
    let points = doubles(array(&bytes, "Points"));
    let corners = integers(array(&bytes, "connectivity"));
    let kinds = array(&bytes, "types");
    // 4 x 3 x 2 nodes at 4 positions of C; 3 x 2 x 1 cells at each.
    assert_eq!((points.len() / 3, kinds.len(), corners.len()), (96, 24, 24 * 8));
    assert!(kinds.iter().all(|kind| *kind == 12));
    assert_eq!(integers(array(&bytes, "offsets")), (1..=24).map(|i| 8 * i).collect::<Vec<_>>());
    let point = |i: usize| [points[3 * i], points[3 * i + 1], points[3 * i + 2]];
    for cell in corners.chunks(8) {
        let [o, a, b, c] = [0, 1, 3, 4].map(|k| point(cell[k]));
        let edge = |p: [f64; 3]| [p[0] - o[0], p[1] - o[1], p[2] - o[2]];
        let [u, v, w] = [edge(a), edge(b), edge(c)];
        let volume = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0]);
        assert!((volume - 1e6).abs() < 1e-3, "{volume}");
        // VTK's order: the corner opposite to the first is the seventh.
        let far = point(cell[6]);
        for k in 0..3 {
            assert!((far[k] - (o[k] + u[k] + v[k] + w[k])).abs() < 1e-9);
        }
    }
}

#[test]
fn a_map_after_compensation_is_the_certificates() {
    let folder = Folder::new("after");
    let out = folder.file("set");
    let certificate = json(&[
        "compile",
        "ht-b-c.yaml",
        "--target",
        "grid-csv",
        "--out",
        text(&out),
        "--poses",
        "300",
        "--format",
        "json",
        "--quiet",
    ]);
    let direction = certificate["direction"].as_str().unwrap();
    let map = json(&[
        "map",
        "ht-b-c.yaml",
        "--target",
        "grid-csv",
        "--random",
        "300",
        "--direction",
        direction,
        "--format",
        "json",
    ]);
    assert_eq!(map["target"], "grid-csv");
    for key in ["position_um", "rotation_urad"] {
        // The compiled plan and the general model round differently: 1e-12 mm, 1e-15 rad.
        for (ours, certified) in [
            (&map[key], &certificate["compensated"][key]),
            (&map["uncompensated"][key], &certificate["uncompensated"][key]),
        ] {
            for name in ["max", "mean", "rms", "p95"] {
                let (a, b) = (ours[name].as_f64().unwrap(), certified[name].as_f64().unwrap());
                assert!((a - b).abs() <= 1e-9 + 1e-12 * b, "{key} {name}: {a} {b}");
            }
        }
    }
    let (code, message) = refused(&["map", "trunnion.yaml", "--target", "grid-csv", "--order", "1"]);
    assert!(code == 2 && message.contains("exact"), "{message}");
    assert_eq!(refused(&["map", "trunnion.yaml", "--random", "9", "--drawing", "before-after", "--svg", "x.svg"]).0, 2);
}

#[test]
fn low_discrepancy_poses_come_nearer_to_the_mean() {
    let mean = |options: &[&str]| {
        json(&[&["map", "trunnion.yaml", "--format", "json"], options].concat())["position_um"]["mean"]
            .as_f64()
            .unwrap()
    };
    // A grid puts weight on its ends, so the truth is a long random run.
    let truth = mean(&["--random", "60000", "--seed", "99"]);
    let off = |kind: &str| {
        let one = |seed: u32| mean(&[kind, "500", "--seed", &seed.to_string()]) - truth;
        ((1..=6).map(|seed| one(seed).powi(2)).sum::<f64>() / 6.0).sqrt()
    };
    let (random, spread) = (off("--random"), off("--low-discrepancy"));
    assert!(spread < 0.6 * random, "{spread} against {random}");
    assert_eq!(refused(&["map", "trunnion.yaml", "--random", "5", "--low-discrepancy", "5"]).0, 2);
}

#[test]
fn body_diagonals_are_the_closed_form() {
    let folder = Folder::new("diagonals");
    let file = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: m\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0, 300], origin: [0, 0, 0] }\n  Y: { travel: [0, 200], origin: [0, 0, 0] }\n  Z: { travel: [0, 100], origin: [0, 0, 0] }\nerrors:\n  EXX: { polynomial: [0 um, 40 um/m] }\n  EC0Y: 50 urad\n",
    );
    let map = json(&["map", text(&file), "--random", "1", "--format", "json"]);
    let (x, y, z) = (300.0_f64, 200.0, 100.0);
    let length = (x * x + y * y + z * z).sqrt();
    for (name, sign) in [("ppp", 1.0), ("npp", -1.0), ("pnp", 1.0), ("nnp", -1.0)] {
        let d = map["diagonals"].as_array().unwrap().iter().find(|d| d["name"] == name).unwrap();
        let sy = if name == "pnp" || name == "nnp" { -1.0 } else { 1.0 };
        // Displacement error in X: 40 um/m of its travel, and minus 50 urad of Y's travel.
        let dx = 0.04 * sign * x - 0.05 * sy * y;
        let expected = dx * sign * x / length;
        let got = d["deviations_um"].as_array().unwrap().last().unwrap().as_f64().unwrap();
        // The exact model turns by cosine and sine: second order, far below a picometre here.
        assert!(
            (got - expected).abs() < 1e-3 && (d["length_mm"].as_f64().unwrap() - length).abs() < 1e-9,
            "{name}: {got} {expected}"
        );
        assert!((d["range_um"].as_f64().unwrap() - expected.abs()).abs() < 1e-3);
    }
}

#[test]
fn files_read_on_the_way_are_inputs_too() {
    let folder = Folder::new("late-inputs");
    let work = "X,Y,Z\n100,200,300\n";
    let outputs = ["--csv", "--json", "--parquet", "--vtk", "--svg", "--png"];
    for output in outputs {
        // Pictures are not written to files of other endings, whatever is in them.
        let poses = folder.with(if ["--svg", "--png"].contains(&output) { "p.svg" } else { "p.csv" }, work);
        let (code, message) = refused(&["map", "gantry-3ax.yaml", "--tool-poses", text(&poses), output, text(&poses)]);
        assert!(code == 1 && message.contains("E0630"), "{output}: {message}");
        assert_eq!(std::fs::read_to_string(&poses).unwrap(), work, "{output}");
    }
    // A target of one's own: its manifest and templates are read when the map is computed.
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates/grid-csv");
    std::fs::create_dir(folder.file("mine")).unwrap();
    let copied: Vec<(std::path::PathBuf, String)> = std::fs::read_dir(own)
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            let text = std::fs::read_to_string(entry.path()).unwrap().replace("grid-csv", "mine");
            (folder.with(&format!("mine/{}", entry.file_name().to_string_lossy()), &text), text)
        })
        .collect();
    let templates = folder.file("");
    let asked = |output: &Path| {
        let more = ["--target", "mine", "--templates", text(&templates), "--random", "3", "--csv", text(output)];
        [&["map", "gantry-3ax.yaml"][..], &more].concat().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let run = |output: &Path| refused(&asked(output).iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(run(&folder.file("out.csv")).0, 0);
    for (file, text) in &copied {
        let (code, message) = run(file);
        assert!(code == 1 && message.contains("E0630"), "{}: {message}", file.display());
        assert_eq!(&std::fs::read_to_string(file).unwrap(), text);
    }
}

#[test]
fn inputs_are_never_overwritten_and_a_full_disk_leaves_nothing() {
    let folder = Folder::new("whole");
    let machine = folder.with("m.yaml", "abbe: 1\nmachine: m\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0, 500], origin: [0, 0, 0] }\n  Y: { travel: [0, 500], origin: [0, 0, 0] }\n  Z: { travel: [0, 500], origin: [0, 0, 0] }\nmeasured: [x.csv]\n");
    let table = folder.with("x.csv", "X [mm],EXX [um]\n0,0\n500,3\n");
    let link = folder.file("link.csv");
    std::os::unix::fs::symlink(&table, &link).unwrap();
    for (option, path) in [
        ("--csv", &machine),
        ("--json", &table),
        ("--parquet", &link),
        ("--vtk", &machine),
        ("--svg", &machine),
        ("--png", &table),
    ] {
        let (code, message) = refused(&["map", text(&machine), "--random", "3", option, text(path)]);
        assert!(code == 1 && message.contains("E0630"), "{option}: {message}");
    }
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "X [mm],EXX [um]\n0,0\n500,3\n");
    // The shell's limit on the size of files stands for a disk that fills up.
    for (option, name) in [("--csv", "a.csv"), ("--json", "a.json"), ("--parquet", "a.parquet"), ("--vtk", "a.vtu")] {
        let script =
            format!("trap '' XFSZ; ulimit -f 16; exec \"$0\" map m.yaml --random 5000 --quiet {option} {name}");
        let output = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_abbe")])
            .current_dir(&folder.0)
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && message.contains("E0810"), "{option}: {message}");
    }
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 3);
}

/// Width, height and how many pixels are darker than the ground's white.
fn drawn(path: &Path) -> (u32, u32, usize) {
    let pixels = resvg::tiny_skia::Pixmap::load_png(path).unwrap();
    let dark = pixels.pixels().iter().filter(|p| p.red() < 100 && p.green() < 100 && p.blue() < 110).count();
    (pixels.width(), pixels.height(), dark)
}

#[test]
fn png_pictures_are_the_svg_ones_at_twice_the_size_with_their_text() {
    let folder = Folder::new("png");
    let size = |svg: &Path| {
        let text = std::fs::read_to_string(svg).unwrap();
        crate::program::well_formed(&text).unwrap();
        let of = |name: &str| {
            text.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse::<f64>().unwrap()
        };
        (of("width"), of("height"))
    };
    let pairs: [(&str, &[&str]); 4] = [
        ("colours", &["map", "trunnion.yaml", "--random", "9", "--quiet"]),
        (
            "grid",
            &["map", "trunnion.yaml", "--random", "9", "--drawing", "grid", "--plane", "YZ", "--at", "A=30", "--quiet"],
        ),
        (
            "sides",
            &[
                "map",
                "vmc-cframe-754.yaml",
                "--target",
                "linuxcnc",
                "--random",
                "9",
                "--drawing",
                "before-after",
                "--quiet",
            ],
        ),
        ("chain", &["show", "trunnion.yaml", "--quiet"]),
    ];
    for (name, arguments) in pairs {
        let [svg, png] = ["svg", "png"].map(|ending| folder.file(&format!("{name}.{ending}")));
        abbe(&[arguments, &["--svg", text(&svg), "--png", text(&png)]].concat());
        let ((w, h), (width, height, dark)) = (size(&svg), drawn(&png));
        assert!((f64::from(width) - 2.0 * w).abs() <= 2.0 && (f64::from(height) - 2.0 * h).abs() <= 2.0, "{name}");
        // Text alone makes thousands of dark pixels.
        assert!(dark > 5000, "{name}: {dark}");
    }
    for ending in ["svg", "png"] {
        let file = folder.file(&format!("curves.{ending}"));
        abbe(&["show", "trunnion.yaml", "--quiet", "--curves", text(&file)]);
        assert!(std::fs::metadata(&file).unwrap().len() > 20_000);
    }
    let curves = std::fs::read_to_string(folder.file("curves.svg")).unwrap();
    // Six panels an axis, each named once; a dot for each of the 26 points that x.csv gives EXX, forward and reverse.
    assert_eq!(curves.matches(">EXX, µm<").count(), 1);
    let given = std::fs::read_to_string(crate::configs::folder().join("errors/trunnion/x.csv")).unwrap();
    assert!(
        curves.matches("<circle").count() >= 6 * (given.lines().filter(|l| !l.starts_with(['#', 'X'])).count() - 1)
    );
    assert_eq!(refused(&["show", "trunnion.yaml", "--curves", "curves.jpg"]).0, 2);
}

#[test]
fn more_poses_than_are_held_are_streamed_in_every_form() {
    let folder = Folder::new("streamed");
    // 101 x 100 x 101 nodes, more than a million; C turns the table.
    let machine = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: m\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0, 500], origin: [0, 0, 0] }\n  Y: { travel: [0, 495], origin: [0, 0, 0] }\n  Z: { travel: [0, 500], origin: [0, 0, 0] }\nworkpiece: { origin: [1, 2, 3] }\nerrors:\n  EC0Y: 20 urad\n  EB0Z: -9 urad\nvolume: { step: 5 mm }\n",
    );
    let [j, p, v] = ["m.json", "m.parquet", "m.vtu"].map(|name| folder.file(name));
    let run = |threads: usize, more: &[&str]| {
        let forms = ["--parquet", text(&p), "--vtk", text(&v)];
        let output = crate::program::abbe_on(
            threads,
            &[&["map", text(&machine), "--order", "1", "--quiet"], forms.as_slice(), more].concat(),
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        [&p, &v].map(|path| std::fs::read(path).unwrap())
    };
    let [parquet, vtk] = run(2, &["--json", text(&j)]);
    assert!(run(3, &[]) == [parquet, vtk.clone()], "bytes hang on the number of threads");
    let (count, dx) = (101 * 100 * 101, |y: f64, z: f64| -20e-3 * y - 9e-3 * z);
    let node = |i: usize| [i / 10_100, i / 101 % 100, i % 101].map(|k| 5.0 * k as f64);
    let reader = SerializedFileReader::new(std::fs::File::open(&p).unwrap()).unwrap();
    let groups = reader.metadata().row_groups();
    assert_eq!(groups.iter().map(|g| g.num_rows()).sum::<i64>(), count as i64);
    assert!(groups[..groups.len() - 1].iter().all(|g| g.num_rows() == 1 << 16));
    for (i, record) in reader.get_row_iter(None).unwrap().enumerate().step_by(997) {
        let record = record.unwrap();
        let [x, y, z] = node(i);
        assert_eq!([0, 1, 2].map(|k| record.get_double(k).unwrap()), [x, y, z], "{i}");
        assert!((record.get_double(3).unwrap() - dx(y, z)).abs() < 1e-9, "{i}");
    }
    let (points, deviations) = (doubles(array(&vtk, "Points")), doubles(array(&vtk, "deviation_um")));
    assert_eq!((points.len(), deviations.len()), (3 * count, 3 * count));
    for i in 0..count {
        let [x, y, z] = node(i);
        let at = [x - 1.0, y - 2.0, z - 3.0];
        assert!((0..3).all(|k| (points[3 * i + k] - at[k]).abs() < 1e-9), "{i}");
        assert!((deviations[3 * i] - dx(y, z)).abs() < 1e-9, "{i}");
    }
    let cells = integers(array(&vtk, "connectivity"));
    assert_eq!(cells.len(), 8 * 100 * 99 * 100);
    assert_eq!(cells[cells.len() - 8..][6], count - 1, "the last cell ends at the last node");
    assert!(vtk.ends_with(b"\n </AppendedData>\n</VTKFile>\n"));
    let text = std::fs::read_to_string(&j).unwrap();
    let mut lines = text.lines();
    assert!(lines.next().unwrap().ends_with("\"poses\":["));
    let mut seen = 0;
    for (i, line) in lines.by_ref().take(count).enumerate() {
        seen += 1;
        if i % 997 == 0 || i + 1 == count {
            let pose: Value = serde_json::from_str(line.trim_end_matches(',')).unwrap();
            let [_, y, z] = node(i);
            assert!((pose["deviation_um"][0].as_f64().unwrap() - dx(y, z)).abs() < 1e-9);
            assert_eq!(pose["axes"]["Z"].as_f64().unwrap(), z);
        }
        assert_eq!(line.ends_with(','), i + 1 < count);
    }
    assert_eq!((seen, lines.collect::<Vec<_>>()), (count, vec!["]}"]));
}

#[test]
fn outputs_that_cannot_all_be_written_are_refused_before_any_is() {
    let folder = crate::oracle::program::Folder::new();
    let machine = crate::support::config("trunnion.yaml");
    for (command, code) in [
        (vec!["map", "--csv", "a.csv", "--svg", "nowhere/a.svg"], "E0810"),
        (vec!["map", "--csv", "same", "--svg", "same"], "E0630"),
        (vec!["map", "--csv", "same", "--json", "same"], "E0630"),
        (vec!["show", "--svg", "a.svg", "--curves", "nowhere/b.svg"], "E0810"),
        (vec!["budget", "--pareto", "a.svg", "--waterfall", "a.svg"], "E0630"),
    ] {
        let mut run = crate::support::abbe();
        run.arg(command[0]).arg(&machine);
        for pair in command[1..].chunks(2) {
            run.arg(pair[0]).arg(folder.path(pair[1]));
        }
        let _ = crate::support::Run::of(&mut run).refused(code);
        let left: Vec<_> = ["a.csv", "a.svg", "same"].into_iter().filter(|name| folder.path(name).exists()).collect();
        assert!(left.is_empty(), "{command:?}: {left:?}");
    }
}
