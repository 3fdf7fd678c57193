//! Points of a laser tracker: a machine of the oracle, seen from stations that stand anywhere.

use crate::kinematic_parameters::{OF_TABLES, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::V3;
use crate::oracle::random::Random;
use crate::program::{Folder, abbe_on, json, refused, text};
use crate::support::config::sample;
use crate::support::sha256::sha256;
use serde_json::Value;
use std::path::PathBuf;

/// The place of a station: a rotation by three angles (rad), one after the other, and a translation (mm).
type Station = ([f64; 3], V3);

/// A point of the workpiece frame as the station sees it.
fn seen((angles, at): &Station, p: V3) -> V3 {
    let mut p = p;
    for (k, angle) in angles.iter().enumerate() {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (sine, cosine) = angle.sin_cos();
        (p[i], p[j]) = (cosine * p[i] - sine * p[j], sine * p[i] + cosine * p[j]);
    }
    std::array::from_fn(|k| p[k] + at[k])
}

const STATIONS: [Station; 2] =
    [([0.3, -1.2, 2.9], [3120.0, -870.5, 412.25]), ([-2.0, 0.7, 0.1], [-1500.0, 2200.0, -90.0])];

/// The poses of a session: a table by name.
fn poses(count: usize) -> (String, Vec<Vec<f64>>) {
    let mut random = Random::new(7);
    let mut table = "point,X,Y,Z,A [deg],C [deg]\n".to_owned();
    let mut list = Vec::new();
    for i in 0..count {
        let mut between = |low: f64, high: f64| ((low + (high - low) * random.unit()) * 1e3).round() / 1e3;
        let pose = [
            between(0.0, 500.0),
            between(0.0, 450.0),
            between(-400.0, 0.0),
            between(-110.0, 25.0),
            between(0.0, 350.0),
        ];
        table += &format!("P{i},{},{},{},{},{}\n", pose[0], pose[1], pose[2], pose[3], pose[4]);
        list.push(pose.to_vec());
    }
    (table, list)
}

/// The positions of a pose in the order of the oracle's chain.
fn walked(sample: &Sample, pose: &[f64]) -> Vec<f64> {
    let letters = ["X", "Y", "Z", "A", "C"];
    let at = |name: &str| pose[letters.iter().position(|letter| *letter == name).unwrap()];
    sample.rigid.walk.iter().map(|axis| at(&axis.name)).collect()
}

/// What a station writes: names, millimetres with a decimal comma, a time, and a nest that belongs to no pose.
fn export(sample: &Sample, list: &[Vec<f64>], station: &Station) -> String {
    let german = |x: f64| format!("{x:.7}").replace('.', ",");
    let mut table = "Punktname;X [mm];Y [mm];Z [mm];Zeitstempel\nREF1;1,5;2;3;10:00:00\n".to_owned();
    for (i, pose) in list.iter().enumerate() {
        let [real, _] = sample.holds(&walked(sample, pose), Travel::Mean);
        let [x, y, z] = seen(station, real.tip).map(german);
        table += &format!("P{i};{x};{y};{z};10:00:{:02}\n", i % 60);
    }
    table
}

struct Session {
    _folder: Folder,
    plain: PathBuf,
    poses: PathBuf,
    stations: [PathBuf; 2],
}

fn session(name: &str) -> Session {
    let folder = Folder::new(name);
    let (table, list) = poses(40);
    let real = sample(&folder.with("real.yaml", &table_table(OF_TABLES)));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    let stations = [0, 1].map(|k| folder.with(&format!("s{k}.csv"), &export(&real, &list, &STATIONS[k])));
    Session { plain, poses: folder.with("poses.csv", &table), stations, _folder: folder }
}

fn value(fit: &Value, list: &str, name: &str) -> f64 {
    let found = fit[list].as_array().unwrap().iter().find(|p| p["name"] == name);
    found.unwrap_or_else(|| panic!("{name}"))["value"].as_f64().unwrap()
}

/// Two stations whose places nothing says: the location errors come back, and so do differences of the poses.
#[test]
fn points_of_two_stations_tell_the_location_errors() {
    let of = session("tracker");
    let names: Vec<&str> = OF_TABLES.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
    // Points at one length of the tool do not tell all from where the stations stand: the rest keep their true values.
    let data = [text(&of.stations[0]), text(&of.stations[1])];
    let list = names.join(",");
    let arguments = ["identify", text(&of.plain), "--fit", &list, "--axis-poses", text(&of.poses), "--data"];
    let run = abbe_on(2, &[&arguments[..], &data, &["--format", "json"]].concat());
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(said.contains("1 point left out: `REF1`") && said.contains("1 column left out: `Zeitstempel`"), "{said}");
    let fit: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!((&fit["points"], &fit["rows"]), (&80.into(), &240.into()));
    for line in OF_TABLES.lines() {
        let (name, wanted) = line.trim().split_once(": ").unwrap();
        let wanted: f64 = wanted.split(' ').next().unwrap().parse().unwrap();
        // Coordinates are written to 1e-4 um, and the arms of the angles are 100 mm and more.
        assert!((value(&fit, "parameters", name) - wanted).abs() < 2e-3, "{name}: {fit}");
    }
    let after = fit["rms_um"]["after"].as_f64().unwrap();
    assert!(after < 2e-4, "{after}");
    // Each station has six unknowns, a displacement and a rotation.
    let units: Vec<&str> = fit["instruments"].as_array().unwrap().iter().map(|p| p["unit"].as_str().unwrap()).collect();
    assert_eq!(units, [["mm"; 3], ["urad"; 3], ["mm"; 3], ["urad"; 3]].concat());
    assert_eq!(fit["instruments"][3]["name"], "s0/tracker.A");
    // The fitted file names the poses as it names the readings.
    let fitted = of.plain.with_file_name("fitted.yaml");
    let more = ["--accept-undetermined", "--out", text(&fitted)];
    let _ = abbe_on(2, &[&arguments[..], &data, &more].concat());
    let (file, poses) = (std::fs::read_to_string(&fitted).unwrap(), std::fs::read(&of.poses).unwrap());
    let named = format!("\"identified-axis-poses\": \"poses.csv (sha256 {}...)\"", &sha256(&poses)[..16]);
    assert!(file.replace('\'', "\"").contains(&named), "{named}: {file}");
}

#[test]
fn points_without_names_of_poses_go_by_order_and_mistakes_are_refused() {
    let of = session("tracker-refused");
    let folder = Folder::new("tracker-files");
    let identify = |data: &PathBuf, poses: &PathBuf| {
        let arguments =
            ["identify", text(&of.plain), "--fit", "EX0C", "--axis-poses", text(poses), "--data", text(data)];
        let (exit, said) = refused(&arguments);
        (exit, said)
    };
    let points = std::fs::read_to_string(&of.stations[0]).unwrap();
    let table = std::fs::read_to_string(&of.poses).unwrap();
    let cut = |text: &str| text.lines().map(|l| l.split_once(',').unwrap().1.to_owned() + "\n").collect::<String>();
    let nameless = folder.with("nameless.csv", &cut(&table));
    let bare: String =
        points.lines().filter(|line| !line.starts_with("REF")).map(|line| line.to_owned() + "\n").collect();
    let all = folder.with("all.csv", &bare);
    assert_eq!(identify(&all, &nameless).0, 0);
    // Errors of 3 % of the size are those of a robot that nobody has calibrated.
    let mut random = Random::new(8);
    let mut shaken = String::new();
    for (i, line) in bare.lines().enumerate() {
        let mut cells: Vec<String> = line.split(';').map(str::to_owned).collect();
        for cell in cells[1..4].iter_mut().filter(|_| i > 0) {
            let x: f64 = cell.replace(',', ".").parse().unwrap();
            *cell = format!("{:.4}", x + 18.0 * (random.unit() - 0.5)).replace('.', ",");
        }
        shaken += &(cells.join(";") + "\n");
    }
    assert_eq!(identify(&folder.with("robot.csv", &shaken), &of.poses).0, 0);
    let fails = |data: &PathBuf, poses: &PathBuf, words: &str| {
        let (exit, said) = identify(data, poses);
        assert!(exit == 1 && said.contains(words), "{words}: {exit} {said}");
    };
    fails(&of.stations[0], &nameless, "41 points for 40 poses");
    let micrometres = folder.with("micrometres.csv", &bare.replace("[mm]", "[um]"));
    fails(&micrometres, &of.poses, "with the readings times 1000 (mm taken for um");
    let mut lines: Vec<&str> = bare.lines().collect();
    lines[1..].reverse();
    let reversed = lines.join("\n");
    fails(&folder.with("reversed.csv", &reversed), &nameless, "mm off their poses");
    let mirrored = bare.replace(";X [mm];Y [mm];", ";Y [mm];X [mm];");
    fails(&folder.with("mirrored.csv", &mirrored), &of.poses, "with the coordinates of the other hand");
    let two: String = bare.lines().take(3).map(|l| l.to_owned() + "\n").collect();
    fails(&folder.with("two.csv", &two), &of.poses, "fewer than three points");
    fails(&folder.with("other.csv", &bare.replace("\nP", "\nQ")), &of.poses, "none of the points");
    let grouped = bare.replace("Punktname;", "Gruppe;Punktname;").replace("\nP", "\nA;P").replacen("\nA;", "\nB;", 1);
    fails(&folder.with("grouped.csv", &grouped), &of.poses, "the groups `B` and `A`");
    fails(&all, &folder.with("twice.csv", &table.replace("P1,", "P0,")), "the point `P0` has two poses");
    fails(&all, &folder.with("empty.csv", "point,X\n"), "is empty");
    fails(&all, &folder.with("none.csv", "point,run\nP1,a\n"), "a column for each axis");
    fails(&all, &folder.with("balls.csv", "X,ball\n1,b\n"), "a table of poses has no readings");
    fails(&all, &folder.with("read.csv", "point,X,dx [um]\nP1,1,2\n"), "a table of poses has no readings");
    let deviations = folder.with("dx.csv", "X,dx [um]\n0,1\n10,2\n");
    fails(&deviations, &of.poses, "no file of measurements has points by name");
    let (exit, said) = refused(&["identify", text(&of.plain), "--fit", "EX0C", "--data", text(&all)]);
    assert!(exit == 1 && said.contains("without the poses") && said.contains("--axis-poses"), "{said}");
    let (exit, said) = refused(&["import", text(&all), "--out", text(&folder.file("t.csv"))]);
    assert!(exit == 1 && said.contains("abbe identify") && said.contains("--axis-poses"), "{said}");
}

/// The columns of one's own say the same; their derivatives by the frame are those of differences.
#[test]
fn coordinates_beside_their_poses_say_the_same() {
    let of = session("tracker-columns");
    let folder = Folder::new("tracker-own");
    let table = std::fs::read_to_string(&of.poses).unwrap();
    let points = std::fs::read_to_string(&of.stations[1]).unwrap();
    let mut own = "X,Y,Z,A [deg],C [deg],tracker.x [mm],tracker.y [mm],tracker.z [mm]\n".to_owned();
    for (pose, point) in table.lines().skip(1).zip(points.lines().skip(2)) {
        let cells: Vec<String> = point.split(';').skip(1).take(3).map(|cell| cell.replace(',', ".")).collect();
        own += &format!("{},{}\n", pose.split_once(',').unwrap().1, cells.join(","));
    }
    let own = folder.with("own.csv", &own);
    let common = ["identify", text(&of.plain), "--fit", "EX0C,EY0C,EA0C,EB0C", "--format", "json", "--data"];
    let direct = json(&[&common[..], &[text(&own)]].concat());
    let export = abbe_on(2, &[&common[..], &[text(&of.stations[1]), "--axis-poses", text(&of.poses)]].concat());
    let export: Value = serde_json::from_slice(&export.stdout).unwrap();
    for key in ["parameters", "instruments", "rms_um"] {
        assert_eq!(direct[key], export[key], "{key}");
    }
}
