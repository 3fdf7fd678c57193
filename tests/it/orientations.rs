//! Readings of orientations: six-degree probes, levels, autocollimators, telescopes. Oracle: the rigid-body model
//! turns the tool, a frame of the instrument and a mount of the target are put about it as whole rotations, and the
//! reading is the logarithm; levels in closed form. Tools as they were clamped, in closed form.

use crate::kinematic_parameters::{OF_HEADS, OF_TABLES, head_head, table_table, with_spindle};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::M4;
use crate::oracle::random::Random;
use crate::oracle::rigid::Frame;
use crate::program::{Folder, json, refused, text};
use crate::support::config::sample;
use crate::support::{compile, verify};
use nalgebra::{Matrix3, Rotation3, Vector3};
use serde_json::Value;
use std::path::Path;

/// Normally distributed, by the sum of twelve.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

fn rotation(of: &M4) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::from_fn(|i, j| of[i][j]))
}

/// Actual and nominal orientation of the tool, workpiece frame.
fn held(machine: &Sample, pose: &Vec<f64>) -> [Rotation3<f64>; 2] {
    machine.holds(pose, Travel::Mean).map(|held| rotation(&held.rotation))
}

/// The header of the axes of a walk, and poses in which each moves between its ends.
fn poses(machine: &Sample, random: &mut Random, count: usize) -> (String, Vec<Vec<f64>>) {
    let names: Vec<&str> = machine.rigid.walk.iter().map(|axis| axis.name.as_str()).collect();
    let position = |random: &mut Random, travel: Option<[f64; 2]>| {
        let [low, high] = travel.unwrap_or([-180.0, 180.0]);
        (random.between(low, high) * 1e3).round() / 1e3
    };
    let pose = |random: &mut Random| machine.axes.iter().map(|axis| position(random, axis.travel)).collect();
    (names.join(","), (0..count).map(|_| pose(random)).collect())
}

fn cells(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|x| format!("{x:.9}")).collect::<Vec<_>>().join(",")
}

fn found<'v>(fit: &'v Value, list: &str, name: &str) -> &'v Value {
    fit[list].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap_or_else(|| panic!("{name}: {fit}"))
}

fn instruments(fit: &Value) -> Vec<&str> {
    fit["instruments"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect()
}

/// Names and values of the errors of a machine file.
fn truth(errors: &str) -> Vec<(&str, f64)> {
    let of =
        |line: &str| line.trim().split_once(": ").map(|(_, value)| value.split(' ').next().unwrap().parse().unwrap());
    errors.lines().map(|line| (line.trim().split(':').next().unwrap(), of(line).unwrap())).collect()
}

fn fit(machine: &Path, names: &str, data: &[&Path], more: &[&str]) -> Value {
    let mut words = vec!["identify", text(machine), "--fit", names, "--format", "json", "--quiet"];
    words.extend(data.iter().flat_map(|path| ["--data", text(path)]));
    json(&[&words[..], more].concat())
}

/// Six components at random poses: deviations (um), then rotations (urad), the target askew on the spindle by `mount`.
fn six_components(machine: &Sample, mount: Vector3<f64>, noise: [f64; 2], seed: u64) -> String {
    let mut random = Random::new(seed);
    let (axes, poses) = poses(machine, &mut random, 60);
    let mut table = format!("{axes},dx [um],dy [um],dz [um],da [urad],db [urad],dc [urad],u [um],u [urad]\n");
    for pose in &poses {
        let moved = machine.evaluate(pose, Travel::Mean, Frame::Workpiece).deviation;
        let [actual, nominal] = held(machine, pose);
        let turned = (actual * Rotation3::new(mount) * nominal.inverse()).scaled_axis();
        let read = moved.map(|x| x * 1e3 + noise[0] * normal(&mut random));
        let turned: Vec<f64> = turned.iter().map(|x| x * 1e6 + noise[1] * normal(&mut random)).collect();
        table +=
            &format!("{},{},{},{},{}\n", cells(pose.iter().copied()), cells(read), cells(turned), noise[0], noise[1]);
    }
    table
}

/// Location errors of tables and spindle from six components: what positions leave free with one tool length is known
/// once the target is.
#[test]
fn six_components_tell_the_tilts_of_the_spindle_with_one_tool() {
    let folder = Folder::new("six");
    let errors = with_spindle(OF_TABLES);
    let real = sample(&folder.with("real.yaml", &table_table(&errors)));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    let mount = Vector3::new(120e-6, -80e-6, 40e-6);
    let data = folder.with("six.csv", &six_components(&real, mount, [1.0, 2.0], 5));
    let names: Vec<&str> = truth(&errors).iter().map(|(name, _)| *name).collect();
    let names = names.join(",");
    // Positions alone: the tilts of the spindle are offsets of its tool.
    let alone: String = (six_components(&real, mount, [1.0, 2.0], 5).lines())
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            [&cells[..8], &cells[11..12]].concat().join(",") + "\n"
        })
        .collect();
    let alone = folder.with("alone.csv", &alone);
    let with_tool = format!("{names},tool");
    let free = fit(&plain, &with_tool, &[&alone], &[]);
    assert!(found(&free, "parameters", "EA0S")["sigma"].is_null(), "{free}");
    let unknown = fit(&plain, &with_tool, &[&data], &[]);
    assert_eq!(instruments(&unknown), ["rotation mount.A", "rotation mount.B", "rotation mount.C"]);
    assert!(found(&unknown, "parameters", "EA0S")["sigma"].is_null(), "a target askew is a tilt: {unknown}");
    let known = ["A", "B", "C"]
        .map(|letter| format!("rotation mount.{letter} = {} urad 3 urad", mount["ABC".find(letter).unwrap()] * 1e6));
    let priors: Vec<&str> = known.iter().flat_map(|prior| ["--prior", prior.as_str()]).collect();
    let fitted = fit(&plain, &with_tool, &[&data], &priors);
    for (name, wanted) in truth(&errors) {
        let of = found(&fitted, "parameters", name);
        let (value, sigma) = (of["value"].as_f64().unwrap(), of["sigma"].as_f64().unwrap());
        assert!((value - wanted).abs() < 3.5 * sigma, "{name}: {value} +- {sigma}, {wanted}");
        let most = if name.ends_with('S') { 3.5 } else { 1.5 };
        assert!(sigma < most, "{name}: {sigma}");
    }
    // The same mount held where it starts leaves what it is in the tilt.
    let held = ["A", "B", "C"].map(|letter| format!("rotation mount.{letter}")).join(",");
    let names_and_mount = format!("{with_tool},rotation mount.A");
    let fixed = fit(&plain, &names_and_mount, &[&data], &["--fixed", &held]);
    let tilt = found(&fixed, "parameters", "EA0S");
    let wanted = 15.0 + 120.0;
    assert!((tilt["value"].as_f64().unwrap() - wanted).abs() < 3.5 * tilt["sigma"].as_f64().unwrap(), "{tilt}");
    assert!(found(&fixed, "instruments", "rotation mount.A")["value"].as_f64().unwrap().abs() < 1e-2, "{fixed}");
    let kinds: Vec<&str> = fitted["kinds"].as_array().unwrap().iter().map(|k| k["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["deviations", "rotations"]);
    assert!((fitted["sigma_um"].as_f64().unwrap() - 1.0).abs() < 0.15, "{fitted}");
    // To first and second order of the dual numbers the values are the same to the products of errors.
    for order in ["1", "2"] {
        let to_order = fit(&plain, &with_tool, &[&data], &[&priors[..], &["--order", order]].concat());
        let [a, b] = [&to_order, &fitted].map(|fit| found(fit, "parameters", "EB0A")["value"].as_f64().unwrap());
        assert!((a - b).abs() < 0.05, "{order}: {a} {b}");
    }
}

/// Without noise the model is exact, products of errors of 6 mrad included, in every frame.
#[test]
fn rotations_are_the_logarithm_of_the_actual_orientation() {
    let folder = Folder::new("exact");
    let large: String = OF_HEADS.replace("urad", "00 urad").replace(" 00", "00");
    let real = sample(&folder.with("real.yaml", &head_head(&large)));
    let plain = folder.with("plain.yaml", &head_head("  EX0C: 0 um\n"));
    let angles: Vec<(&str, f64)> = truth(&large).into_iter().filter(|(name, _)| "ABC".contains(&name[1..2])).collect();
    let names: Vec<&str> = angles.iter().map(|(name, _)| *name).collect();
    let mut random = Random::new(3);
    let (axes, poses) = poses(&real, &mut random, 40);
    for (word, frame) in [("workpiece", Frame::Workpiece), ("machine", Frame::Machine), ("tool", Frame::Tool)] {
        let row = |pose: &Vec<f64>| {
            let [actual, nominal] = held(&real, pose);
            let w = (actual * nominal.inverse()).scaled_axis();
            // Of the machine only the workpiece side turns between the frames: here none does.
            let w = if frame == Frame::Tool { nominal.inverse() * w } else { w };
            format!("{},{}\n", cells(pose.iter().copied()), cells(w.iter().map(|x| x * 1e3)))
        };
        let table: String = poses.iter().map(row).collect();
        let data = folder.with("data.csv", &format!("{axes},da [mrad],db [mrad],dc [mrad]\n{table}"));
        let fitted = fit(&plain, &names.join(","), &[&data], &["--frame", word]);
        // The head turns about two axes: the readings tell frame and mount apart.
        let unknowns = instruments(&fitted);
        assert_eq!(unknowns.len(), 6, "{unknowns:?}");
        for (name, wanted) in &angles {
            let value = found(&fitted, "parameters", name)["value"].as_f64().unwrap();
            assert!((value - wanted).abs() < 1e-3, "{word} {name}: {value} {wanted}");
        }
        assert!(fitted["rms_um"]["after"].as_f64().unwrap() < 1e-5, "{fitted}");
    }
}

/// A telescope on the head: only the direction of the tool, in two runs whose frame lies otherwise, askew on the
/// spindle.
#[test]
fn a_telescope_reads_the_direction_of_the_tool() {
    let folder = Folder::new("telescope");
    let real = sample(&folder.with("real.yaml", &head_head(OF_HEADS)));
    let plain = folder.with("plain.yaml", &head_head("  EX0C: 0 um\n"));
    let mut random = Random::new(8);
    let (axes, poses) = poses(&real, &mut random, 60);
    let mount = Rotation3::new(Vector3::new(30e-6, -50e-6, 0.0));
    let mut table = format!("{axes},run,axis.x [arcsec],axis.y [arcsec]\n");
    for (i, pose) in poses.iter().enumerate() {
        let frame = Rotation3::new(Vector3::from([[20e-6, 0.0, -70e-6], [-90e-6, 10e-6, 50e-6]][i % 2]));
        let [actual, nominal] = held(&real, pose);
        let off = nominal.inverse() * (frame * actual * mount * Vector3::z() - nominal * Vector3::z());
        let arcsec = |x: f64| x.to_degrees() * 3600.0;
        table += &format!("{},{},{}\n", cells(pose.iter().copied()), i % 2 + 1, cells([arcsec(off.x), arcsec(off.y)]));
    }
    let data = folder.with("telescope.csv", &table);
    let fitted = fit(&plain, "EA0B", &[&data], &[]);
    let of_runs = ["1.A", "1.B", "1.C", "2.A", "2.B", "2.C"].map(|of| format!("axis {of}"));
    let of_mount = ["axis mount.A", "axis mount.B"].map(str::to_owned);
    assert_eq!(instruments(&fitted), [&of_runs[..], &of_mount].concat());
    // How B is tilted against C: what the others do frames and mount do as well, to the products of these with errors.
    let value = found(&fitted, "parameters", "EA0B")["value"].as_f64().unwrap();
    assert!((value - (33.0 + 62.0)).abs() < 0.05, "{value}");
    assert!(fitted["rms_um"]["after"].as_f64().unwrap() < 0.02, "{fitted}");
    assert_eq!(fitted["kinds"][0]["kind"], "axis directions");
}

/// Three linear axes, at which angles show in levels as they are.
const THREE: &str = "abbe: 1\nmachine: Three\nchain: \"w b X Y Z t\"\naxes:\n  \
                     X: { travel: [0, 500], origin: [0, 0, 0] }\n  \
                     Y: { travel: [0, 400], origin: [0, 0, 0] }\n  \
                     Z: { travel: [-300, 0], origin: [0, 0, 0] }\n";

/// A level and an autocollimator along X: slope of the angle, whatever the zero of each run is.
#[test]
fn levels_and_autocollimators_read_angles_of_a_slide() {
    let folder = Folder::new("level");
    let machine = folder.with("m.yaml", THREE);
    for (of, unit, factor) in
        [("level", "um/m", 1.0), ("collimator", "arcsec", 648_000.0 / std::f64::consts::PI * 1e-6)]
    {
        let mut table = format!("run,X,{of}.a [{unit}],{of}.b [{unit}]\n");
        for (run, x) in (1..=2).flat_map(|run| (0..11).map(move |i| (run, 50.0 * f64::from(i)))) {
            let (a, b) = (20e-3 * x + 300.0 * f64::from(run), -35e-3 * x - 70.0);
            table += &format!("{run},{x},{},{}\n", a * factor, b * factor);
        }
        let data = folder.with("level.csv", &table);
        let fitted = fit(&machine, "EAX:poly1,EBX:poly1", &[&data], &["--fixed", "EAX:x^0,EBX:x^0"]);
        let of_runs = ["1.A", "1.B", "2.A", "2.B"].map(|name| format!("{of} {name}"));
        assert_eq!(instruments(&fitted), of_runs, "frame and mount are one where nothing turns");
        for (name, wanted) in [("EAX:x^1", 20.0), ("EBX:x^1", -35.0)] {
            let value = found(&fitted, "parameters", name)["value"].as_f64().unwrap();
            assert!((value - wanted).abs() < 1e-6, "{name}: {value}");
        }
        let zero = found(&fitted, "instruments", &format!("{of} 2.A"));
        assert!(zero["unit"] == "urad" && (zero["value"].as_f64().unwrap() - 600.0).abs() < 1e-6, "{zero}");
    }
    // Units that no slide can be of.
    for (rows, said) in
        [("0,0\n100,4\n200,8\n300,12\n400,16\n", true), ("0,0\n100,0.004\n200,0.008\n300,0.012\n", false)]
    {
        let data = folder.with("unit.csv", &format!("X,level.b [deg]\n{rows}"));
        let words = ["identify", text(&machine), "--fit", "EBX:poly1", "--fixed", "EBX:x^0", "--data", text(&data)];
        let (_, warnings) = refused(&words);
        assert_eq!(warnings.contains("half of the rotations are"), said, "{warnings}");
    }
    let single = folder.with("single.csv", "X,level.b [mm/m]\n0,0\n100,0.01\n200,0.02\n300,0.03\n");
    let fitted = fit(&machine, "EBX:poly1", &[&single], &["--fixed", "EBX:x^0"]);
    assert!((found(&fitted, "parameters", "EBX:x^1")["value"].as_f64().unwrap() - 100.0).abs() < 1e-6, "{fitted}");
    let plan = folder.with("plan.csv", &format!("X,level.b [um/m]\n{}", "0,\n100,\n250,\n400,\n500,\n"));
    let words = ["identify", text(&machine), "--fit", "EBX:poly1", "--fixed", "EBX:x^0", "--plan", "2", "--data"];
    let planned = json(&[&words[..], &[text(&plan), "--format", "json", "--quiet"]].concat());
    let chosen: Vec<f64> =
        planned["poses"].as_array().unwrap().iter().map(|pose| pose["axes"]["X"].as_f64().unwrap()).collect();
    assert!(chosen.contains(&0.0) && chosen.contains(&500.0), "{planned}");
}

/// Angles of the slide that carries the tool are displacements with one tool length; rotations beside tell them.
#[test]
fn rotations_tell_angles_that_one_tool_length_hides() {
    let folder = Folder::new("hides");
    let row = |i: u32, rotations: bool| {
        let z = -30.0 * f64::from(i);
        let noise = [0.4, -0.3, 0.2, -0.4, 0.1][i as usize % 5];
        let turned =
            if rotations { format!(",{},{}", 400e-6 * z * z + 77.0 + noise, 3.0 * noise) } else { String::new() };
        format!("{z},{},{}{turned}\n", noise, 0.7 * noise)
    };
    let rows = |rotations: bool| (0..11).map(|i| row(i, rotations)).collect::<String>();
    let fixed = ["--fixed", "EBZ:x^0,EXZ:x^0,EBZ:x^1,EXZ:x^1"];
    // The datum, which is formed over positions, would take such an angle for zero.
    let tool = "tool: { gauge: [0, 0, 0], length: 150 mm }\nidentify: { datum: { line: free, zero: free } }\n";
    let machine_with_tool = folder.with("tool.yaml", &format!("{THREE}{tool}"));
    let positions = folder.with("p.csv", &format!("Z,dx [um],dy [um]\n{}", rows(false)));
    let free = fit(&machine_with_tool, "EXZ:poly2,EBZ:poly2", &[&positions], &fixed);
    assert!(free["singular_values"][1].as_f64().unwrap() < 1e-9, "{free}");
    // The run begins with a row of rotations alone.
    let both = format!("Z,dx [um],dy [um],db [urad],da [urad]\n0,,,77,0\n{}", rows(true));
    let both = folder.with("both.csv", &both);
    let told = fit(&machine_with_tool, "EXZ:poly2,EBZ:poly2", &[&both], &fixed);
    let of = found(&told, "parameters", "EBZ:x^2");
    let (value, sigma) = (of["value"].as_f64().unwrap(), of["sigma"].as_f64().unwrap());
    assert!((value - 400.0).abs() < 3.5 * sigma && sigma < 10.0, "{of}");
    assert_eq!((told["rows"].as_u64(), told["points"].as_u64()), (Some(46), Some(23)));
    assert_eq!(instruments(&told), ["rotation mount.A", "rotation mount.B"]);
    // Relative deviations and positions of a tracker take them, too; these know nothing of the frame.
    let relative = folder
        .with("rel.csv", &std::fs::read_to_string(&both).unwrap().replace("dx", "rel.dx").replace("dy", "rel.dy"));
    let told = fit(&machine_with_tool, "EXZ:poly2,EBZ:poly2", &[&relative], &fixed);
    assert_eq!(instruments(&told), ["rotation.A", "rotation.B", "first.x", "first.y"]);
    let places =
        [[0.0, 0.0, 0.0], [500.0, 0.0, -100.0], [0.0, 400.0, -200.0], [250.0, 200.0, -300.0], [500.0, 400.0, -50.0]];
    let row = |[x, y, z]: [f64; 3]| format!("{x},{y},{z},{},{y},{z},{}\n", 1000.0 + x, 0.02 * z);
    let header = "X,Y,Z,tracker.x [mm],tracker.y [mm],tracker.z [mm],dc [urad]\n";
    let seen = folder.with("seen.csv", &format!("{header}{}", places.map(row).concat()));
    let told = fit(&machine_with_tool, "ECZ:poly1", &[&seen], &["--fixed", "ECZ:x^0"]);
    assert_eq!(instruments(&told)[..2], ["rotation.C", "tracker.x"]);
    assert!((found(&told, "parameters", "ECZ:x^1")["value"].as_f64().unwrap() - 20.0).abs() < 1e-3, "{told}");
}

#[test]
fn orientations_that_mislead_are_refused() {
    let folder = Folder::new("misled");
    let machine = folder.with("m.yaml", THREE);
    for (titles, row, said) in [
        ("X,da", "0,1", "no unit of angle"),
        ("X,da [um]", "0,1", "no unit of angle"),
        ("X,level.a [deg]", "0,40", "more than 0.5 rad"),
        ("X,da [urad]", "0,90000000", "more than 0.5 rad"),
        ("X,da [urad]", "0,NaN", "E0501"),
        ("X,da [urad]", "0,", "has no reading"),
        ("X,level.a [um/m],level.b [um/m],level.c [um/m]", "0,1,1,1", "about two axes"),
        ("X,level.a [um/m],tracker.x [mm],tracker.y [mm],tracker.z [mm]", "0,1,1,1,1", "mixes kinds"),
        ("X,level.a [um/m],da [urad]", "0,1,1", "mixes kinds"),
        ("X,ball,da [urad]", "0,b,1", "mixes kinds"),
        ("X,dx [um],da [urad],u [um]", "0,1,1,1", "give `u [um]` and `u [urad]`"),
        ("X,da [urad],u [um]", "0,1,1", "angles are read: give `u [urad]`"),
        ("X,db [urad],to.X", "0,1,3", "belong to a length"),
    ] {
        let file = folder.with("bad.csv", &format!("{titles}\n{row}\n{row}\n"));
        let (code, found) = refused(&["identify", text(&machine), "--fit", "EAX:poly1", "--data", text(&file)]);
        let found = found.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(code == 1 && found.contains("E0501") && found.contains(said), "{titles}: {found}");
    }
}

/// The second measurement: rotations that a set does not touch are as the machine file predicts them, whatever the
/// frame of the instrument is; beside deviations the whole set-up turns.
#[test]
fn a_second_measurement_takes_orientations() {
    let folder = Folder::new("second");
    let angles = "EAX: { polynomial: [0 urad, 40 urad/m] }, EBX: { polynomial: [0 urad, -60 urad/m] }";
    let part = "covariance:\n  - { errors: { EBX: { polynomial: [0 urad, 4 urad/m] } } }\n";
    let more = "tool: { gauge: [0, 0, 0], length: 0 mm }\nvolume: { step: 100 mm }\n";
    let machine = folder.with("m.yaml", &format!("{THREE}{more}errors: {{ {angles} }}\n{part}"));
    let set = folder.file("set");
    let _ = compile(&machine, "grid-csv", &set, &["--poses", "3", "--quiet"]).json();
    let rows = |read: &dyn Fn(f64) -> String| -> String {
        (0..11).map(|i| 50.0 * f64::from(i)).map(|x| format!("{x},{}\n", read(x))).collect()
    };
    let (a, b) = (|x: f64| 40e-3 * x, |x: f64| -60e-3 * x);
    let pair = |x: f64| format!("{},{},1", a(x) + 70.0, b(x) - 20.0);
    // The axis of the tool, Z, leans to X by a turn about Y, and to -Y by one about X.
    let axis = |x: f64| format!("{},{},1", b(x) - 20.0, -a(x) - 70.0);
    for (titles, read, kind, names) in [
        ("da [urad],db [urad]", &pair as &dyn Fn(f64) -> String, "rotations", ["rotation.A", "rotation.B"]),
        ("level.a [um/m],level.b [um/m]", &pair, "levels", ["level.A", "level.B"]),
        ("collimator.a [urad],collimator.b [urad]", &pair, "collimator readings", ["collimator.A", "collimator.B"]),
        ("axis.x [urad],axis.y [urad]", &axis, "axis directions", ["axis.A", "axis.B"]),
    ] {
        let data = folder.with("second.csv", &format!("X,{titles},u [urad]\n{}", rows(read)));
        let of = verify(&machine, &set, &["--poses", "3", "--quiet", "--data", text(&data)]).json()["second"].clone();
        let one = &of["kinds"][0];
        assert!(one["kind"] == kind && one["unit"] == "urad" && of["within"] == 1.0, "{kind}: {of}");
        let set_up: Vec<&str> =
            of["set_up"].as_array().unwrap().iter().map(|of| of["name"].as_str().unwrap()).collect();
        assert_eq!(set_up, names);
        for reading in of["readings"].as_array().unwrap() {
            let [predicted, measured] = ["predicted", "measured"].map(|of| reading[of].as_f64().unwrap());
            assert!((predicted - measured).abs() < 1e-3 && predicted.abs() > -1.0, "{kind}: {reading}");
        }
        // 4 urad/m over half a metre, less its mean.
        let largest = of["readings"].as_array().unwrap().iter().map(|of| of["predicted_u"].as_f64().unwrap());
        assert!((largest.fold(0.0, f64::max) - 2.0).abs() < 1e-2, "{kind}: {of}");
    }
    let beside = |x: f64| format!("0,0,0,{},{},1,1", a(x), b(x));
    let titles = "X,dx [um],dy [um],dz [um],da [urad],db [urad],u [um],u [urad]";
    let data = folder.with("beside.csv", &format!("{titles}\n{}", rows(&beside)));
    let of = verify(&machine, &set, &["--poses", "3", "--quiet", "--data", text(&data)]).json()["second"].clone();
    let set_up: Vec<&str> = of["set_up"].as_array().unwrap().iter().map(|of| of["name"].as_str().unwrap()).collect();
    assert!(set_up.contains(&"turn A") && set_up.contains(&"rotation mount.B"), "{set_up:?}");
}

/// Offsets (um) of two tools in two runs.
const CLAMPED: [[f64; 3]; 4] = [[10.0, -20.0, 30.0], [-40.0, 5.0, 12.0], [7.0, 8.0, -9.0], [55.0, -6.0, 1.0]];

/// Every tool, or every tool in each session, has an offset of its own: reported, and no part of the fitted machine.
#[test]
fn tools_are_offset_by_themselves_and_in_each_session() {
    let folder = Folder::new("tools");
    let tools = "tools:\n  short: { gauge: [0, 0, 0], length: 80 mm }\n  long: { gauge: [0, 0, 0], length: 200 mm }\n";
    let machine = folder.with("m.yaml", &format!("{THREE}{tools}setup: {{ tool: {{ X: 3 um }} }}\n"));
    let table = |sessions: usize| {
        let mut table = "session,tool,X,Y,dx [um],dy [um],dz [um]\n".to_owned();
        for (k, offset) in CLAMPED.iter().enumerate().take(2 * sessions) {
            let (session, tool) = (["am", "pm"][k / 2], ["short", "long"][k % 2]);
            for (i, y) in [0.0, 100.0, 250.0, 400.0].into_iter().enumerate() {
                let noise = [0.1, -0.2, 0.15, -0.05][i];
                let read = [offset[0] - 20e-3 * y + noise, offset[1] - noise, offset[2] + noise];
                table += &format!("{session},{tool},{},{y},{}\n", 90 * i, cells(read));
            }
        }
        table
    };
    let value = |fit: &Value, name: &str| found(fit, "parameters", name)["value"].as_f64().unwrap();
    let names = |fit: &Value| -> Vec<String> {
        fit["parameters"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap().to_owned()).collect()
    };
    let one = folder.with("one.csv", &table(1));
    let by_tool = fit(&machine, "EC0Y,tools", &[&one], &[]);
    assert_eq!(
        names(&by_tool)[1..],
        ["X", "Y", "Z"]
            .map(|of| format!("tool short.{of}"))
            .into_iter()
            .chain(["X", "Y", "Z"].map(|of| format!("tool long.{of}")))
            .collect::<Vec<_>>()
    );
    for (k, tool) in ["short", "long"].into_iter().enumerate() {
        for (i, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            let found = value(&by_tool, &format!("tool {tool}.{letter}"));
            assert!((found - CLAMPED[k][i]).abs() < 0.2, "{tool}.{letter}: {found}");
        }
    }
    assert!((value(&by_tool, "EC0Y") - 20.0).abs() < 1.0);
    let both = folder.with("both.csv", &table(2));
    let file = folder.file("fitted.yaml");
    let by_run = fit(&machine, "EC0Y,tools-by-run", &[&both], &["--out", text(&file)]);
    for (k, clamped) in ["short run am", "long run am", "short run pm", "long run pm"].into_iter().enumerate() {
        let found = value(&by_run, &format!("tool {clamped}.X"));
        assert!((found - CLAMPED[k][0]).abs() < 0.2, "{clamped}: {found}");
    }
    let left = |fit: &Value| fit["rms_um"]["after"].as_f64().unwrap();
    let together = fit(&machine, "EC0Y,tools", &[&both], &[]);
    assert!(left(&by_run) < 0.3 && left(&together) > 10.0, "{} {}", left(&by_run), left(&together));
    // The fitted machine has the tool of its file, and is fitted again by the same words.
    let text_of = std::fs::read_to_string(&file).unwrap();
    let held: serde_yaml::Value = serde_yaml::from_str(&text_of).unwrap();
    assert!(
        held["setup"]["tool"].as_mapping().unwrap().len() == 1 && !held["setup"]["tool"]["X"].is_null(),
        "{text_of}"
    );
    assert!(text_of.contains("tools-by-run"), "{text_of}");
    let again = json(&["identify", text(&file), "--data", text(&both), "--format", "json", "--quiet"]);
    assert!((value(&again, "tool long run pm.X") - 55.0).abs() < 0.2 && (value(&again, "EC0Y") - 20.0).abs() < 1.0);
    // Names of the report are words of `--fit`, `--fixed` and `--prior`.
    let single = fit(&machine, "EC0Y,tool long run pm.X", &[&both], &[]);
    assert_eq!(names(&single), ["EC0Y", "tool long run pm.X"]);
    let words = [
        "--fixed",
        "tool long run pm.X,tool short run am.Z,tool short.X",
        "--prior",
        "tool short run am.X = 10 um 0.001 um",
    ];
    let fixed = fit(&machine, "EC0Y,tools-by-run", &[&both], &words);
    assert_eq!(names(&fixed).len(), 11);
    assert!((value(&fixed, "tool short run am.X") - 10.0).abs() < 0.01, "{fixed}");
    let all = fit(&machine, "EC0Y,tools-by-run", &[&both], &["--fixed", "tools-by-run"]);
    assert_eq!(names(&all), ["EC0Y"]);
    for (list, said) in
        [("tool,tools", "in two forms"), ("tools,tools-by-run", "in two forms"), ("tool wide.X", "is of no reading")]
    {
        let (code, words) = refused(&["identify", text(&machine), "--fit", list, "--data", text(&both)]);
        assert!(code == 1 && words.contains("E0502") && words.contains(said), "{list}: {words}");
    }
    let twice = folder.with("twice.csv", "session,run,X,dx [um]\na,b,0,1\n");
    let (_, words) = refused(&["identify", text(&machine), "--fit", "EC0Y", "--data", text(&twice)]);
    assert!(words.contains("E0501") && words.contains("`run` occurs twice"), "{words}");
}
