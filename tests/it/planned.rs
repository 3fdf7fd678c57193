//! Plans of measurements ask for what an instrument can read, and foretell what the fit of such readings then has.
//! Oracle: the rigid-body model, which moves the poses of the plan and makes their readings.

use crate::identify::normal;
use crate::kinematic_parameters::{OF_TABLES, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::random::Random;
use crate::program::{Folder, abbe, json, refused, text};
use crate::support::config::sample;
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Titles and rows of a table.
fn table(csv: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut lines = csv.lines().filter(|line| !line.starts_with('#'));
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    (cells(lines.next().unwrap()), lines.map(cells).collect())
}

/// The positions of a row by axis.
fn positions(titles: &[String], row: &[String]) -> BTreeMap<String, f64> {
    let axes = titles.iter().zip(row).filter(|(title, _)| title.ends_with(" [mm]") || title.ends_with(" [deg]"));
    axes.filter_map(|(title, cell)| Some((title.split(' ').next()?.to_owned(), cell.parse().ok()?))).collect()
}

/// The actual and the nominal tip at a row, workpiece frame.
fn tips(sample: &Sample, titles: &[String], row: &[String]) -> [[f64; 3]; 2] {
    let at = positions(titles, row);
    let pose: Vec<f64> = sample.rigid.walk.iter().map(|axis| at[&axis.name]).collect();
    sample.holds(&pose, Travel::Mean).map(|held| held.tip)
}

/// The plan as JSON and as a table.
fn plan(machine: &Path, fit: &str, asked: &[&str]) -> (Value, String) {
    let arguments = [&["identify", text(machine), "--fit", fit, "--quiet"], asked].concat();
    (json(&[&arguments[..], &["--format", "json"]].concat()), abbe(&[&arguments[..], &["--format", "csv"]].concat()))
}

/// What identify makes of a filled table.
fn fitted(machine: &Path, fit: &str, data: &Path) -> Value {
    json(&["identify", text(machine), "--fit", fit, "--data", text(data), "--format", "json", "--quiet"])
}

fn filled(csv: &str, reading: &dyn Fn(usize) -> String) -> String {
    let mut row = 0;
    let mut text = String::new();
    for line in csv.lines() {
        let empty = line.trim_end_matches(',');
        if line.ends_with(',') {
            text += &format!("{empty},{}\n", reading(row));
            row += 1;
        } else {
            text += &format!("{line}\n");
        }
    }
    text
}

fn machines(folder: &Folder) -> (PathBuf, Sample) {
    let real = sample(&folder.with("real.yaml", &table_table(OF_TABLES)));
    (folder.with("plain.yaml", &table_table("  EX0C: 0 um\n")), real)
}

#[test]
fn balls_are_held_within_the_ranges_and_the_foretold_uncertainty_is_met() {
    let folder = Folder::new("planned-balls");
    let (plain, real) = machines(&folder);
    let names: Vec<&str> = OF_TABLES.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
    let fit = names.join(",");
    let asked = ["--plan", "16", "--instrument", "r-test", "--ball", "X=300,Y=260", "--ball", "X=200,Y=200,Z=-150"];
    let (report, csv) = plan(&plain, &fit, &[&asked[..], &["--ranges", "A=-60..30"]].concat());
    let (titles, rows) = table(&csv);
    assert_eq!((rows.len(), &report["readings"], &report["rank"]), (16, &16.into(), &report["unknowns"]));
    let tips: Vec<[[f64; 3]; 2]> = rows.iter().map(|row| tips(&real, &titles, row)).collect();
    let mut balls: BTreeMap<&str, [f64; 3]> = BTreeMap::new();
    for (row, [_, nominal]) in rows.iter().zip(&tips) {
        let ball = balls.entry(&row[0]).or_insert(*nominal);
        // Positions are written to 1e-4.
        assert!((0..3).all(|k| (nominal[k] - ball[k]).abs() < 5e-4), "{row:?}: {nominal:?} {ball:?}");
        assert!((-60.0..=30.0).contains(&positions(&titles, row)["A"]), "{row:?}");
    }
    assert!((1..rows.len()).all(|i| !rows[..i].contains(&rows[i])), "no pose twice: {csv}");
    // Measured with that noise, the fit scatters about the truth as foretold.
    let first = |row: usize| rows.iter().position(|other| other[0] == rows[row][0]).unwrap();
    let d = |row: usize, k: usize| (tips[row][0][k] - tips[row][1][k]) * 1e3;
    let (mut random, mut squares, draws) = (Random::new(31), 0.0, 12);
    for _ in 0..draws {
        let noise: Vec<[f64; 3]> = rows.iter().map(|_| [0; 3].map(|_| normal(&mut random))).collect();
        let reading = |row: usize| {
            let less = |k: usize| d(row, k) + noise[row][k] - d(first(row), k) - noise[first(row)][k];
            (0..3).map(|k| format!("{:.9}", less(k))).collect::<Vec<_>>().join(",")
        };
        let found = fitted(&plain, &fit, &folder.with("filled.csv", &filled(&csv, &reading)));
        assert_eq!((&found["rank"], &found["unknowns"]), (&report["rank"], &report["unknowns"]));
        for (line, (found, foretold)) in OF_TABLES
            .lines()
            .zip(found["parameters"].as_array().unwrap().iter().zip(report["parameters"].as_array().unwrap()))
        {
            let (name, truth) = line.trim().split_once(": ").unwrap();
            let truth: f64 = truth.split(' ').next().unwrap().parse().unwrap();
            assert!(found["name"] == name && foretold["name"] == name && found["unit"] == foretold["unit"]);
            squares += ((found["value"].as_f64().unwrap() - truth) / foretold["sigma"].as_f64().unwrap()).powi(2);
        }
    }
    let mean = squares / (draws * names.len()) as f64;
    assert!((0.55..1.6).contains(&mean), "{mean}");
}

/// A ball that rests says which point of the file is not that of the machine on which it was read: an origin with the
/// wrong sign, a length with two digits exchanged. With the right file nothing is asked.
#[test]
fn a_ball_that_would_wander_names_the_point_of_the_file() {
    let folder = Folder::new("planned-wander");
    let (plain, real) = machines(&folder);
    let asked = ["--plan", "16", "--instrument", "r-test", "--ball", "X=300,Y=260", "--ball", "X=200,Y=200,Z=-150"];
    let (_, csv) = plan(&plain, "EX0C,EY0C,EZ0A,EY0A", &asked);
    let (titles, rows) = table(&csv);
    let tips: Vec<[[f64; 3]; 2]> = rows.iter().map(|row| tips(&real, &titles, row)).collect();
    let first = |row: usize| rows.iter().position(|other| other[0] == rows[row][0]).unwrap();
    let d = |row: usize, k: usize| (tips[row][0][k] - tips[row][1][k]) * 1e3;
    let reading =
        |row: usize| (0..3).map(|k| format!("{:.6}", d(row, k) - d(first(row), k))).collect::<Vec<_>>().join(",");
    let data = folder.with("filled.csv", &filled(&csv, &reading));
    let said = |machine: &Path| {
        let fit = "EX0C,EY0C,EZ0A,EY0A,EB0A,EC0A,EA0C,EB0C";
        refused(&["identify", text(machine), "--fit", fit, "--data", text(&data)]).1
    };
    assert!(!said(&plain).contains("wanders"), "{}", said(&plain));
    let written = std::fs::read_to_string(&plain).unwrap();
    for (right, wrong, point, by) in [
        (
            "origin: [250, 225, -350]",
            "origin: [250, 225, 350]",
            "the origin of A moved by [0, 0, -700]",
            "or with the tip",
        ),
        ("length: 120 mm", "length: 102 mm", "the tip of the tool moved by [0, 0, -18]", "would rest"),
    ] {
        assert!(written.contains(right), "{right}: {written}");
        let words = said(&folder.with("wrong.yaml", &written.replace(right, wrong)));
        assert!(words.contains("W0520") && words.contains(point) && words.contains(by), "{wrong}: {words}");
    }
}

/// Positions of the axes of a walk with the linear ones moved so that the tip (actual 0, nominal 1) is at a place.
pub fn at_place(sample: &Sample, start: &[f64], place: [f64; 3], which: usize) -> Vec<f64> {
    let tip = |pose: &Vec<f64>| Vector3::from(sample.holds(pose, Travel::Mean)[which].tip);
    let linear: Vec<usize> = (0..start.len()).filter(|i| !sample.rigid.walk[*i].rotary).collect();
    let mut pose = start.to_vec();
    for _ in 0..4 {
        let here = tip(&pose);
        let column = |k: usize| {
            let mut other = pose.clone();
            other[linear[k]] += 1.0;
            tip(&other) - here
        };
        let columns = Matrix3::from_columns(&[column(0), column(1), column(2)]);
        let step = columns.try_inverse().unwrap() * (Vector3::from(place) - here);
        (0..3).for_each(|k| pose[linear[k]] += step[k]);
    }
    pose
}

/// The plan of a touch probe is what `measure` takes, and `identify` after it: positions of the axes with the stylus in
/// balls whose places nobody knows.
#[test]
fn touches_are_in_reach_and_their_foretold_uncertainty_is_met() {
    let folder = Folder::new("planned-touches");
    let (plain, real) = machines(&folder);
    let names: Vec<&str> = OF_TABLES.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
    let fit = names.join(",");
    let walk = &real.rigid.walk;
    let balls = [[62.0, 31.0, 45.0], [-74.0, 22.0, 80.0], [11.0, -85.0, 60.0]];
    let words = balls.map(|ball| {
        let start: Vec<f64> = walk.iter().map(|axis| if axis.rotary { 0.0 } else { 100.0 }).collect();
        let at = at_place(&real, &start, ball, 1);
        let linear = walk.iter().zip(&at).filter(|(axis, _)| !axis.rotary);
        linear.map(|(axis, q)| format!("{}={q:.4}", axis.name)).collect::<Vec<_>>().join(",")
    });
    let asked: Vec<&str> = ["--plan", "20", "--instrument", "touch", "--ball-radius", "10 mm"]
        .into_iter()
        .chain(words.iter().flat_map(|word| ["--ball", word]))
        .collect();
    let (report, csv) = plan(&plain, &fit, &asked);
    let (titles, rows) = table(&csv);
    assert_eq!((rows.len(), &report["readings"], &report["rank"]), (20, &20.into(), &report["unknowns"]));
    let used: std::collections::BTreeSet<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    assert_eq!(used.len(), 3, "a ball that is not touched is one that the program does not know of");
    assert_eq!(report["unknowns"], 8 + 3 * used.len(), "eight errors and the balls in use");
    assert!((1..rows.len()).all(|i| !rows[..i].contains(&rows[i])), "no set twice: {csv}");
    let index = |row: usize| rows[row][0].trim_start_matches('b').parse::<usize>().unwrap() - 1;
    for (row, cells) in rows.iter().enumerate() {
        let [_, nominal] = tips(&real, &titles, cells);
        // Places and positions are written to 1e-4.
        assert!((0..3).all(|k| (nominal[k] - balls[index(row)][k]).abs() < 5e-4), "{cells:?}: {nominal:?}");
    }
    let out = folder.file("program");
    let sets = folder.with("sets.csv", &csv);
    let _ = abbe(&["measure", text(&plain), text(&sets), "--ball-radius", "10 mm", "--out", text(&out), "--quiet"]);
    assert!(out.join("abbe_set_20.ngc").exists());
    let off = [[0.21, -0.1, 0.05], [-0.3, 0.2, 0.1], [0.0, 0.15, -0.2]];
    let (mut random, mut squares, draws) = (Random::new(5), 0.0, 24);
    for _ in 0..draws {
        let mut log = csv.lines().next().unwrap().to_owned() + "\n";
        for (row, cells) in rows.iter().enumerate() {
            let at = positions(&titles, cells);
            let start: Vec<f64> = walk.iter().map(|axis| at[&axis.name]).collect();
            let (ball, off) = (balls[index(row)], off[index(row)]);
            let place = [0, 1, 2].map(|k| ball[k] + off[k] + 1e-3 * normal(&mut random));
            let pose = at_place(&real, &start, place, 0);
            let is_axis = |title: &String| walk.iter().position(|axis| title.split(' ').next() == Some(&*axis.name));
            let cell = |(title, cell): (&String, &String)| {
                is_axis(title).map_or_else(|| cell.clone(), |axis| format!("{:.9}", pose[axis]))
            };
            log += &(titles.iter().zip(cells).map(cell).collect::<Vec<_>>().join(",") + "\n");
        }
        let found = fitted(&plain, &fit, &folder.with("log.csv", &log));
        let pairs = found["parameters"].as_array().unwrap().iter().zip(report["parameters"].as_array().unwrap());
        for (line, (found, foretold)) in OF_TABLES.lines().zip(pairs) {
            let (name, truth) = line.trim().split_once(": ").unwrap();
            let truth: f64 = truth.split(' ').next().unwrap().parse().unwrap();
            assert!(found["name"] == name && foretold["name"] == name && found["unit"] == foretold["unit"]);
            squares += ((found["value"].as_f64().unwrap() - truth) / foretold["sigma"].as_f64().unwrap()).powi(2);
        }
    }
    // The errors of one draw are correlated: the mean of 24 draws scatters by 0.16.
    let mean = squares / f64::from(draws * 8);
    assert!((0.6..1.45).contains(&mean), "{mean}");
    let few = [&["identify", text(&plain), "--fit", &fit, "--plan", "2"], &asked[2..]].concat();
    let (code, said) = refused(&few);
    assert!(code == 2 && said.contains("a plan for 3 balls touches each"), "{said}");
    let (code, said) = refused(&["identify", text(&plain), "--plan", "4", "--ball-radius", "10 mm"]);
    assert!(code == 2 && said.contains("of the instrument `touch`"), "{said}");
}

#[test]
fn a_laser_measures_whole_lines_and_a_tracker_points() {
    let folder = Folder::new("planned-lines");
    let (plain, real) = machines(&folder);
    let (report, csv) = plan(&plain, "linear", &["--plan", "7", "--instrument", "laser"]);
    let (titles, rows) = table(&csv);
    let mut runs: BTreeMap<&str, Vec<[f64; 3]>> = BTreeMap::new();
    rows.iter().for_each(|row| runs.entry(&row[0]).or_default().push(tips(&real, &titles, row)[1]));
    assert_eq!((runs.len(), &report["readings"]), (7, &7.into()));
    for (name, points) in &runs {
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!(points.len() == 11 && (0..3).any(|k| (last[k] - first[k]).abs() > 300.0), "{name}: {points:?}");
        for (step, point) in points.iter().enumerate() {
            let on = |k: usize| first[k] + (last[k] - first[k]) * step as f64 / 10.0 - point[k];
            assert!((0..3).all(|k| on(k).abs() < 5e-4), "{name}: {point:?}");
        }
    }
    let found = fitted(&plain, "linear", &folder.with("lines.csv", &filled(&csv, &|_| "0".to_owned())));
    assert_eq!((&found["rank"], &found["unknowns"]), (&report["rank"], &report["unknowns"]));
    let (report, csv) = plan(&plain, "EX0C,EB0C,EZ0A", &["--plan", "9", "--instrument", "tracker"]);
    let (titles, rows) = table(&csv);
    let seen = |row: usize| tips(&real, &titles, &rows[row])[1].map(|x| format!("{:.6}", x + 1000.0)).join(",");
    let found = fitted(&plain, "EX0C,EB0C,EZ0A", &folder.with("points.csv", &filled(&csv, &seen)));
    assert_eq!((&found["rank"], &found["unknowns"], &report["unknowns"]), (&report["rank"], &9.into(), &9.into()));
}

/// Three readings of a run tell a slope: sigma over the root of the squares of their distances from their mean, which is
/// largest for 0, 100 and 500 mm.
#[test]
fn the_readings_of_a_file_are_chosen_from_and_none_is_taken_twice() {
    let folder = Folder::new("planned-file");
    let (plain, _) = machines(&folder);
    let steps: String = [0, 100, 200, 500, 300].map(|x| format!("{x},225,\n")).concat();
    let file = folder.with("steps.csv", &format!("# mine\nX,Y,rel.dx [um]\n{steps}"));
    let slope = ["--fixed", "EXX:x^0", "--noise", "10 nm"];
    let (report, csv) = plan(&plain, "EXX:poly1", &[&["--plan", "3", "--data", text(&file)], &slope[..]].concat());
    assert_eq!(csv, "# mine\nX,Y,rel.dx [um]\n0,225,\n100,225,\n500,225,\n");
    let sigma = &report["parameters"][0]["sigma"];
    assert!((sigma.as_f64().unwrap() / (1e-2 / 0.14_f64.sqrt()) - 1.0).abs() < 1e-6, "{report}");
    let (report, csv) = plan(&plain, "EXX:poly1", &["--plan", "5", "--data", text(&file)]);
    assert_eq!((table(&csv).1.len(), &report["candidates"]), (5, &5.into()));
    let asked = |more: &[&str]| refused(&[&["identify", text(&plain), "--fit", "EXX:poly1"], more].concat());
    let (code, said) = asked(&["--plan", "6", "--data", text(&file)]);
    assert!(code == 2 && said.contains("5 readings to choose 6 from"), "{said}");
    let measured = folder.with("measured.csv", "X,Y,rel.dx [um]\n0,225,0\n100,225,4\n");
    let (code, said) = asked(&["--plan", "2", "--data", text(&measured)]);
    assert!(code == 1 && said.contains("E0501") && said.contains("leave the cell empty"), "{said}");
    let station = folder.with("station.csv", "X,Y,length [mm],station\n0,225,,S\n100,225,,S\n");
    let (code, said) = asked(&["--plan", "2", "--data", text(&station)]);
    assert!(code == 1 && said.contains("E0505"), "{said}");
    for more in [
        &["--plan", "2", "--ranges", "A=-200..0"][..],
        &["--plan", "2", "--ball", "X=1"],
        &["--plan", "2", "--instrument", "r-test", "--ball", "X=9000"],
        &["--plan", "2", "--instrument", "laser", "--data", text(&file)],
        &["--instrument", "laser", "--data", text(&file)],
    ] {
        assert_ne!(asked(more).0, 0, "{more:?}");
    }
}

/// What a report calls a parameter is a word of `--fit` and of the machine file; a knot alone is no curve.
#[test]
fn names_of_the_report_are_words_of_the_fit() {
    let folder = Folder::new("planned-names");
    let (plain, _) = machines(&folder);
    let names = ["tool.X", "workpiece.B", "EYY:slope", "EXX:x^2", "EYX+:x^1", "ECC:cos1", "ECC:sin2", "EAZ:x^0"];
    let list = |report: &Value| -> Vec<String> {
        let all = report["parameters"].as_array().unwrap().iter();
        all.map(|parameter| parameter["name"].as_str().unwrap().to_owned()).collect()
    };
    let (report, _) = plan(&plain, &names.join(","), &["--plan", "9"]);
    assert_eq!(list(&report), names);
    let words: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let section = format!("{}identify: {{ fit: [{}] }}\n", std::fs::read_to_string(&plain).unwrap(), words.join(", "));
    let file = folder.with("section.yaml", &section);
    assert_eq!(list(&json(&["identify", text(&file), "--plan", "9", "--format", "json", "--quiet"])), names);
    let (report, _) = plan(&plain, "EYX:spline3,EXX:poly2", &["--plan", "9", "--fixed", "EYX:250mm,EXX:x^1"]);
    assert_eq!(list(&report), ["EYX:0mm", "EYX:500mm", "EXX:x^0", "EXX:x^2"]);
    for (word, said) in [("EYX:250mm", "a knot is fitted with its curve"), ("EXX:x^02", "is not a basis")] {
        let (code, found) = refused(&["identify", text(&plain), "--fit", word, "--plan", "9"]);
        assert!(code == 1 && found.contains(said), "{found}");
    }
}
