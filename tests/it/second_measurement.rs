//! `verify --data`: a set judged by a second measurement, against closed forms of one axis and campaigns of a model of
//! its own: linear errors of three axes, to first order.

use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::support::{Run, abbe, compile, number, verify};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Slopes of EXX, EYY and EZZ (um/m), the squareness C0Y (urad), and one standard uncertainty of each.
const VALUES: [f64; 4] = [100.0, -60.0, 80.0, 90.0];
const SIGMAS: [f64; 4] = [5.0, 4.0, 3.0, 6.0];

fn machine(folder: &Folder, covariance: bool) -> PathBuf {
    let [x, y, z, c] = VALUES;
    let [u, v, w, s] = SIGMAS;
    let slope = |error: &str, slope: f64| format!("{error}: {{ polynomial: [0 um, {slope} um/m] }}");
    let part = |part: String| format!("  - {{ errors: {{ {part} }} }}\n");
    let parts = [slope("EXX", u), slope("EYY", v), slope("EZZ", w), format!("EC0Y: {s} urad")].map(part).concat();
    let covariance = if covariance { format!("covariance:\n{parts}") } else { String::new() };
    let errors = [slope("EXX", x), slope("EYY", y), slope("EZZ", z), format!("EC0Y: {c} urad")].join(", ");
    folder.write(
        "machine.yaml",
        &format!(
            "abbe: 1\nmachine: Second\nchain: w b X Y Z t\naxes: {{ X: {{ travel: [0, 400] }}, Y: {{ travel: [0, 300] }}, \
             Z: {{ travel: [0, 200] }} }}\ntool: {{ gauge: [0, 0, 0], length: 0 mm }}\nerrors: {{ {errors} }}\n{covariance}\
             volume: {{ step: 100 mm }}\nidentify: {{ type_b: [laser 2 um/m] }}\n"
        ),
    )
}

/// A set for the machine, whose lattice holds linear errors exactly.
fn set(folder: &Folder, machine: &Path) -> PathBuf {
    let out = folder.path("set");
    let _ = compile(machine, "grid-csv", &out, &["--poses", "3", "--quiet"]).json();
    out
}

fn second(machine: &Path, set: &Path, data: &Path, more: &[&str]) -> Value {
    let data = data.to_str().unwrap();
    let answer = verify(machine, set, &[&["--poses", "3", "--quiet", "--data", data], more].concat()).json();
    answer["second"].clone()
}

/// Normally distributed, by the sum of twelve.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// A machine as it is, and the share of the set's correction that each axis has.
struct Driven {
    /// Slopes (um/m) and squareness (urad).
    truth: [f64; 4],
    shares: [f64; 3],
}

impl Driven {
    /// Deviation (um) at a point (mm).
    fn deviation(&self, p: [f64; 3]) -> [f64; 3] {
        let [x, y, z, c] = self.truth;
        let [a, b, d, e] = VALUES;
        let [i, j, k] = self.shares;
        let along = (x - a * i) * p[0] - (c - e * i) * p[1];
        [along, (y - b * j) * p[1], (z - d * k) * p[2]].map(|nm| nm / 1e3)
    }
}

const PLACES: usize = 24;

/// Places over the volume, mm.
fn places() -> Vec<[f64; 3]> {
    let at =
        |i: usize| [80.0 + 80.0 * (i % 4) as f64, 50.0 + 100.0 * (i / 4 % 3) as f64, 30.0 + 120.0 * (i / 12) as f64];
    (0..PLACES).map(at).collect()
}

/// A file of readings of a kind with 1 um noise, in a set-up of its own, and its text.
fn file(kind: &str, machine: &Driven, random: &mut Random) -> String {
    let shift = [300.0, -150.0, 80.0].map(|size| size * normal(random));
    let turn = [1e-4, 2e-4, -1e-4].map(|size| size * normal(random));
    let mut body = String::new();
    let mut noise = || normal(random);
    let actual = |p: [f64; 3]| -> [f64; 3] {
        let d = machine.deviation(p);
        std::array::from_fn(|k| p[k] + d[k] / 1e3)
    };
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let header = match kind {
        "deviations" => "X,Y,Z,dx [um],dy [um],dz [um],u [um]",
        "relative" => "X,Y,Z,rel.dx [um],rel.dy [um],rel.dz [um],u [um]",
        "tracker" => "X,Y,Z,tracker.x [mm],tracker.y [mm],tracker.z [mm],u [um]",
        "station" => "X,Y,Z,displacement [mm],station,run,u [um]",
        "pairs" => "X,Y,Z,to.X,to.Y,to.Z,length [mm],u [um]",
        "lines" => "X,Y,Z,along [um],run,u [um]",
        _ => "X,EXX [um],u [um]",
    };
    for (i, p) in places().into_iter().enumerate() {
        let at = format!("{},{},{}", p[0], p[1], p[2]);
        let d = machine.deviation(p);
        let row = match kind {
            "deviations" | "relative" => {
                let [w, v, u] = [turn[2], turn[1], turn[0]];
                let turned = [v * p[2] - w * p[1], w * p[0] - u * p[2], u * p[1] - v * p[0]];
                let read: [f64; 3] = std::array::from_fn(|k| d[k] + shift[k] + 1e3 * turned[k] + noise());
                format!("{at},{},{},{},1", read[0], read[1], read[2])
            }
            "tracker" => {
                // Turned about Z by 30 deg, and far away.
                let q = actual(p).map(|x| x + noise() / 1e3);
                let (s, c) = (0.5_f64, 0.75_f64.sqrt());
                format!("{at},{},{},{},1", 900.0 + c * q[0] - s * q[1], s * q[0] + c * q[1] - 700.0, q[2] + 55.0)
            }
            "station" => {
                let stations =
                    [[-150.0, -90.0, 20.0], [550.0, -80.0, 30.0], [200.0, 450.0, -120.0], [220.0, 160.0, 500.0]];
                let row = |(k, s): (usize, &[f64; 3])| {
                    format!("{at},{},s{k},r{k},1", distance(actual(p), *s) - 77.0 + noise() / 1e3)
                };
                stations.iter().enumerate().map(row).collect::<Vec<_>>().join("\n")
            }
            "pairs" => {
                let to = places()[(i * 7 + 5) % PLACES];
                let length = distance(actual(p), actual(to)) + noise() / 1e3;
                format!("{at},{},{},{},{length},1", to[0], to[1], to[2])
            }
            "lines" => {
                let (run, k) = (i / 8, i % 8);
                let ends = [
                    [[0.0; 3], [400.0, 300.0, 200.0]],
                    [[400.0, 0.0, 0.0], [0.0, 300.0, 200.0]],
                    [[0.0, 300.0, 0.0], [400.0, 0.0, 200.0]],
                ];
                let [from, to] = ends[run];
                let p: [f64; 3] = std::array::from_fn(|j| from[j] + (to[j] - from[j]) * k as f64 / 7.0);
                let (d, long) = (machine.deviation(p), distance(from, to));
                let along = (0..3).map(|j| d[j] * (to[j] - from[j]) / long).sum::<f64>() + 40.0 + noise();
                format!("{},{},{},{along},{run},1", p[0], p[1], p[2])
            }
            _ => {
                format!("{},{},1", 16.0 * i as f64, machine.deviation([16.0 * i as f64, 0.0, 0.0])[0] + 12.0 + noise())
            }
        };
        body += &format!("{row}\n");
    }
    format!("{header}\n{body}")
}

/// A machine drawn from what its file knows.
fn drawn(random: &mut Random, shares: [f64; 3]) -> Driven {
    Driven { truth: std::array::from_fn(|k| VALUES[k] + SIGMAS[k] * normal(random)), shares }
}

const KINDS: [&str; 7] = ["deviations", "relative", "tracker", "station", "pairs", "lines", "single"];

fn campaigns(kinds: &[&str]) {
    let folder = Folder::new();
    let machine = machine(&folder, true);
    let set = set(&folder, &machine);
    let mut random = Random::new(11);
    for kind in kinds {
        let mut judge = |of: &Driven| {
            let data = folder.write("second.csv", &file(kind, of, &mut random));
            second(&machine, &set, &data, &[])
        };
        let draw = |shares| drawn(&mut Random::new(5), shares);
        let good = judge(&draw([1.0; 3]));
        assert_eq!(good["verdict"], "within", "{kind}: {}", good["words"]);
        assert!(number(&good, "/within") > 0.8 && good["instead"].is_null(), "{kind}: {}", good["words"]);
        let amount = number(&good, "/correction/amount");
        assert!((amount - 1.0).abs() < 1.5 * number(&good, "/correction/expanded_uncertainty"), "{kind}: {amount}");
        for (share, word) in [(0.0, "not-in-force"), (-1.0, "reversed"), (0.5, "half")] {
            let bad = judge(&draw([share; 3]));
            assert_eq!(bad["verdict"], "not-within", "{kind} {share}: {}", bad["words"]);
            assert_eq!(bad["instead"], word, "{kind} {share}: {}", bad["words"]);
        }
        // Another machine.
        let other = judge(&Driven { truth: [-40.0, 120.0, -90.0, -50.0], shares: [1.0; 3] });
        assert_eq!(other["verdict"], "not-within", "{kind}: {}", other["words"]);
        // The tables of X alone; on diagonals what is left of Y and Z nearly cancels.
        let half = judge(&draw([1.0, 0.0, 0.0]));
        assert_eq!(half["verdict"] == "not-within", !["lines", "single"].contains(kind), "{kind}: {}", half["words"]);
        assert!(half["instead"].is_null(), "{kind}: {}", half["words"]);
    }
}

#[test]
fn good_and_bad_campaigns_of_deviations_are_told_apart() {
    campaigns(&KINDS[..2]);
}

#[test]
fn good_and_bad_campaigns_of_positions_and_distances_are_told_apart() {
    campaigns(&KINDS[2..4]);
}

#[test]
fn good_and_bad_campaigns_of_lengths_lines_and_single_errors_are_told_apart() {
    campaigns(&KINDS[4..]);
}

/// One axis, one slope b known to u, readings of scatter s: the closed form of everything.
#[test]
fn one_axis_is_its_closed_form() {
    let folder = Folder::new();
    let machine = machine(&folder, true);
    let set = set(&folder, &machine);
    let x: Vec<f64> = (0..9).map(|i| 40.0 * f64::from(i)).collect();
    let read: Vec<f64> =
        x.iter().zip([0.4, -1.1, 0.7, 1.3, -0.6, 0.2, -0.9, 1.0, -0.3]).map(|(x, e)| 0.008 * x + e + 31.0).collect();
    let (mean, reads) = (x.iter().sum::<f64>() / 9.0, read.iter().sum::<f64>() / 9.0);
    let square: f64 = x.iter().map(|x| (x - mean).powi(2)).sum();
    let (b, u, s) = (0.1, 0.005, 1.5);
    let seen: f64 = x.iter().zip(&read).map(|(x, r)| (x - mean) * (r - reads)).sum::<f64>() / square;
    let rows = |unit: &str, line: &dyn Fn(f64, f64) -> String| {
        let rows: String = x.iter().zip(&read).map(|(x, r)| line(*x, *r)).collect();
        format!("{unit}\n{rows}")
    };
    let files = [
        rows("X,EXX [um]", &|x, r| format!("{x},{r}\n")),
        rows("X,dx [um]", &|x, r| format!("{x},{r}\n")),
        rows("X,along [um]", &|x, r| format!("{x},{r}\n")),
        rows("X,rel.dx [um]", &|x, r| format!("{x},{}\n", r - read[0])),
    ];
    for text in files {
        let data = folder.write("one.csv", &text);
        let of = second(&machine, &set, &data, &["--noise", "1.5 um"]);
        let near = |path: &str, expected: f64| {
            let found = number(&of, path);
            assert!(
                (found - expected).abs() < 2e-4 * (1.0 + expected.abs()),
                "{path}: {found}, not {expected}: {text}"
            );
        };
        near("/correction/amount", 1.0 - seen / b);
        near("/correction/expanded_uncertainty", 2.0 * (s * s / square + u * u).sqrt() / b);
        for (i, (x, r)) in x.iter().zip(&read).enumerate() {
            let of_readings = 2.0 * s * (8.0_f64 / 9.0).sqrt();
            near(&format!("/readings/{i}/predicted"), 0.0);
            near(&format!("/readings/{i}/measured"), r - reads);
            near(&format!("/readings/{i}/predicted_u"), 2.0 * u * (x - mean).abs());
            near(&format!("/readings/{i}/measured_u"), of_readings);
            near(&format!("/readings/{i}/e_n"), (r - reads) / of_readings.hypot(2.0 * u * (x - mean)));
        }
        let left: f64 = read.iter().map(|r| (r - reads).powi(2)).sum::<f64>() - 8.0 * s * s;
        near("/kinds/0/measured/rms", (left.max(0.0) / 9.0).sqrt());
        near("/kinds/0/predicted/rms", u * (square / 9.0).sqrt());
    }
}

#[test]
fn what_cannot_be_told_is_said_and_what_is_common_counts_once() {
    let folder = Folder::new();
    let machine = machine(&folder, true);
    let set = set(&folder, &machine);
    let text = file("deviations", &drawn(&mut Random::new(5), [1.0; 3]), &mut Random::new(3));
    let coarse = folder.write("coarse.csv", &text.replace(",1\n", ",90\n"));
    let of = second(&machine, &set, &coarse, &[]);
    assert_eq!(of["verdict"], "cannot-tell", "{of}");
    assert!(of["words"].as_str().unwrap().contains("cannot tell"), "{of}");
    // The set does nothing to a straightness, nor to a rotation.
    let flat = folder.write("flat.csv", "X,EZX [um],EBX [urad],u [um],u [urad]\n0,1,2,1,1\n200,2,1,1,1\n400,0,3,1,1\n");
    let of = second(&machine, &set, &flat, &[]);
    assert!(of["verdict"] == "cannot-tell" && of["correction"].is_null(), "{of}");
    let names: Vec<&str> = of["set_up"].as_array().unwrap().iter().map(|of| of["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["zero EZX", "zero EBX", "slope EZX"]);
    let units: Vec<&str> = of["kinds"].as_array().unwrap().iter().map(|of| of["unit"].as_str().unwrap()).collect();
    assert_eq!(units, ["um", "urad"]);
    // The laser of the first campaign is in the machine file, and its uncertainty in the covariance.
    let data = folder.write("second.csv", &text);
    let of = |words: &[&str]| second(&machine, &set, &data, words);
    let (plain, same) = (of(&[]), of(&["--type-b", "laser 2 um/m"]));
    assert_eq!(same["counted_once"][0], "laser");
    assert_eq!(plain["readings"], same["readings"]);
    let other = of(&["--type-b", "tracker 20 um/m"]);
    let largest =
        |of: &Value| (0..3 * PLACES).map(|i| number(of, &format!("/readings/{i}/measured_u"))).fold(0.0, f64::max);
    assert!(other["counted_once"] == serde_json::json!([]) && largest(&other) > 2.0 * largest(&plain));
}

#[test]
fn the_text_says_the_verdict_and_what_is_not_known() {
    let folder = Folder::new();
    let machine = machine(&folder, false);
    let set = set(&folder, &machine);
    let exact = Driven { truth: VALUES, shares: [1.0; 3] };
    let once = file("deviations", &exact, &mut Random::new(3)).replace(",u [um]", "").replace(",1\n", "\n");
    // Repeated readings say how they scatter, and two files are two set-ups.
    let again = file("deviations", &exact, &mut Random::new(4)).replace(",u [um]", "").replace(",1\n", "\n");
    let rows = once.lines().skip(1).map(|row| format!("{row}\n")).collect::<String>();
    let near = rows.lines().map(|row| {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{},{},{},{},{},{}\n", cells[0], cells[1], cells[2], cells[3] + 2.0, cells[4] - 2.0, cells[5] + 2.0)
    });
    let repeated = folder.write("repeated.csv", &format!("{once}{}", near.collect::<String>()));
    let beside = folder.write("beside.csv", &again);
    let run = |data: &[&Path]| {
        Run::of(abbe().arg("verify").arg(&machine).arg(&set).args(["--quiet", "--poses", "3", "--data"]).args(data))
    };
    let both = run(&[&repeated, &beside]);
    assert_eq!(both.code, Some(0), "{}", both.err);
    for words in
        ["Second measurement, 216 readings: ", ": within.\n", "states no uncertainty", "Of the correction they see "]
    {
        assert!(both.out.contains(words), "{words}: {}", both.out);
    }
    // Nothing says how sure these are.
    let unsure = run(&[&beside]);
    assert!(unsure.code == Some(2) || unsure.code == Some(1), "{}", unsure.err);
    assert!(
        unsure.err.contains("nothing says how sure the readings") && unsure.err.contains("--noise"),
        "{}",
        unsure.err
    );
    let many =
        "X,EXX [um],u [um]\n".to_owned() + &(0..20_001).map(|i| format!("{},0,1\n", i % 400)).collect::<String>();
    let many = run(&[&folder.write("many.csv", &many)]);
    assert!(many.err.contains("20000 readings at most"), "{}", many.err);
}

#[test]
fn a_record_has_the_verdict_and_the_readings() {
    let folder = Folder::new();
    let machine = machine(&folder, true);
    let _ = set(&folder, &machine);
    let text = file("deviations", &drawn(&mut Random::new(5), [1.0; 3]), &mut Random::new(3));
    let _ = folder.write("raw.csv", "X,dx [um]\n0,0\n");
    let _ = folder.write("second.csv", &text);
    let description = folder.write(
        "record.yaml",
        "record: 1\nid: R-2\ndates: { begin: 2026-11-02, end: 2026-11-03 }\ncountry: DE\nplace: customer\n\
         laboratory: { name: Lab, city: Hamburg }\ncustomer: { name: Works, city: Bremen }\npersons: [{ name: A. Engineer }]\n\
         machine: { serial: \"4711\" }\nas_found: machine.yaml\n\
         instruments: [{ name: Laser, serial: L-7, certificate: C-12, calibrated: 2026-03-01, uncertainty: 2 um/m }]\n\
         data: [raw.csv]\nsets: [{ folder: set, second: { data: [second.csv], type_b: [laser 2 um/m] } }]\n",
    );
    let out = folder.path("out");
    let run = Run::of(
        abbe().arg("record").arg(&description).args(["--quiet", "--poses", "3", "--format", "json", "--out"]).arg(&out),
    );
    let record = run.json();
    let second = &record["sets"][0]["verify"]["second"];
    assert!(second["verdict"] == "within" && second["counted_once"][0] == "laser", "{second}");
    let copied: Vec<&str> =
        record["data"].as_array().unwrap().iter().map(|of| of["source"].as_str().unwrap()).collect();
    assert_eq!(copied, ["raw.csv", "second.csv"]);
    let page = std::fs::read_to_string(out.join("record.html")).unwrap();
    assert!(
        page.contains("Second measurement with the set in force, 72 readings") && page.contains("um: within."),
        "{page}"
    );
    let check = Run::of(abbe().args(["record", "--quiet", "--check"]).arg(&out));
    assert_eq!(check.code, Some(0), "{}", check.err);
}

/// A set that takes everything out leaves readings of zero, whatever the mechanism is.
#[test]
fn modules_and_composed_sets_are_judged_too() {
    let folder = Folder::new();
    let mut random = Random::new(9);
    let mut rows = "X,Y,Z,A,C,dx [um],dy [um],dz [um],u [um]\n".to_owned();
    for _ in 0..20 {
        let pose = [(50.0, 450.0), (50.0, 400.0), (-300.0, -50.0), (-60.0, 20.0), (0.0, 360.0)];
        let pose = pose.map(|(low, high)| random.between(low, high).to_string());
        rows += &format!("{},0,0,0,3\n", pose.join(","));
    }
    let data = folder.write("second.csv", &rows);
    let machine = crate::support::config("trunnion.yaml");
    let out = folder.path("kins");
    let _ = compile(&machine, "linuxcnc-kins", &out, &["--poses", "3", "--quiet"]).json();
    let of = second(&machine, &out, &data, &[]);
    assert_eq!(of["verdict"], "within", "{}", of["words"]);
    assert!(number(&of, "/kinds/0/predicted/rms") < 1e-3 && number(&of, "/kinds/0/measured/rms") < 1e-3, "{of}");
    let out = folder.path("both");
    let more = ["--target", "sinumerik-cec", "--poses", "3", "--quiet", "--accept-unverified"];
    let _ = compile(&machine, "sinumerik-traori", &out, &more).json();
    let of = second(&machine, &out, &data, &[]);
    assert_eq!(of["verdict"], "within", "{}", of["words"]);
    assert!((number(&of, "/correction/amount") - 1.0).abs() < 0.1, "{of}");
}

#[test]
fn single_errors_of_a_rotary_axis_are_less_the_place_of_the_artefact() {
    let folder = Folder::new();
    let machine = folder.write(
        "rotary.yaml",
        "abbe: 1\nmachine: Rotary\nchain: \"w C' b X Y Z t\"\naxes: { X: { travel: [0, 400] }, Y: { travel: [0, 300] }, \
         Z: { travel: [0, 200] }, C: { travel: [0, 360], origin: [200, 150, 0] } }\ntool: { gauge: [0, 0, 0], length: 0 mm }\n\
         errors:\n  ECC: { harmonics: { 2: [60 urad, -20 urad] } }\n  EXX: { polynomial: [0 um, 100 um/m] }\n\
         volume: { step: 100 mm, C: { step: 5 deg } }\n",
    );
    let out = folder.path("set");
    let _ = compile(&machine, "linuxcnc", &out, &["--poses", "3", "--quiet"]).json();
    let read = |amount: f64| {
        let mut rows = "C,ECC [urad],EXC [um],EAC [urad],u [um],u [urad]\n".to_owned();
        for i in 0..24 {
            let q = 15.0 * f64::from(i);
            let turn = q.to_radians();
            let own = 60.0 * (2.0 * turn).cos() - 20.0 * (2.0 * turn).sin();
            let (off, tilt) = (5.0 * turn.cos() - 7.0 * turn.sin(), 9.0 * turn.sin());
            rows += &format!("{q},{},{off},{tilt},1,1\n", amount * own + 3.0);
        }
        second(&machine, &out, &folder.write("second.csv", &rows), &[])
    };
    let (with, without) = (read(0.0), read(1.0));
    assert!(with["verdict"] == "within" && number(&with, "/within") == 1.0, "{}", with["words"]);
    assert!(without["verdict"] == "not-within" && without["instead"] == "not-in-force", "{}", without["words"]);
    let names: Vec<&str> = with["set_up"].as_array().unwrap().iter().map(|of| of["name"].as_str().unwrap()).collect();
    let all = [
        "zero ECC",
        "zero EXC",
        "artefact cos EXC",
        "zero EAC",
        "artefact cos EAC",
        "artefact sin EXC",
        "artefact sin EAC",
    ];
    assert_eq!(names, all);
}
