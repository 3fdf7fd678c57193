//! Bounds as the language writes them: along and across, words of data sheets, squareness, and the class of a file.

use crate::language::{read, silent};
use crate::oracle::random::Random;
use crate::program::{Folder, abbe, json, refused, text};
use abbe::analysis::budget::bounds;
use abbe::machine::{Machine, machine_file};
use serde_json::Value;

const HEAD: &str = "abbe: 1\nmachine: M\nchain: \"w C' b X Y Z B (S) t\"\naxes:\n  X: { travel: [0, 400], origin: [0, \
                    0, 0] }\n  Y: { travel: [0, 300], origin: [0, 0, 0] }\n  Z: { travel: [-200, 0], origin: [0, 0, \
                    0] }\n  B: { travel: [0, 180], direction: [0, 1, 1], origin: [0, 0, 60] }\n  C: { travel: \
                    continuous, origin: [200, 150, -300] }\ntool: { gauge: [0, 0, 0], length: 150 }\n";

fn machine(rest: &str) -> Machine {
    silent(&[("m.yaml", &format!("{HEAD}{rest}"))])
}

/// Names and bounds in um or urad.
fn list(machine: &Machine) -> Vec<(String, f64)> {
    let size =
        |b: &abbe::analysis::budget::Bound| b.tolerance * if b.error.direction.is_rotation() { 1e6 } else { 1e3 };
    bounds(machine, None).iter().map(|b| (b.to_string(), (size(b) * 1e6).round() / 1e6)).collect()
}

fn pairs(list: &[(&str, f64)]) -> Vec<(String, f64)> {
    list.iter().map(|(name, size)| ((*name).to_owned(), *size)).collect()
}

const FRAMED: &str = "tolerances:\n  B: { along: 2 um, across: 3 um, about_along: 50 urad, about_across: 10 urad, \
                      location: { across: 25 um } }\n  C: { across: 4 um }\n  X: { about_across: 7 urad }\n  S: { \
                      location: { about_across: 40 urad } }\n  X-Y: 0.02/500\n  Z-Y: 30 urad\n  EXX: { E: 6 um, R: 2 um \
                      }\n  EYX: 5 um\n";

#[test]
fn bounds_are_read_along_and_across_and_written_again() {
    let expected = pairs(&[
        ("EXC", 4.0),
        ("EYC", 4.0),
        ("EXX", 4.0),
        ("EYX", 5.0),
        ("EBX", 7.0),
        ("ECX", 7.0),
        ("EC0Y", 40.0),
        ("EA0Z", 30.0),
        ("EX0B", 25.0),
        ("B location across 2", 25.0),
        ("EXB", 3.0),
        ("B along", 2.0),
        ("B across 2", 3.0),
        ("EAB", 10.0),
        ("B about along", 50.0),
        ("B about across 2", 10.0),
        ("EA0S", 40.0),
        ("EB0S", 40.0),
    ]);
    let first = machine(FRAMED);
    assert_eq!(list(&first), expected);
    let again = silent(&[("m.yaml", &machine_file(&first.to_parts(), &[]))]);
    assert_eq!(list(&again), expected);
    assert_eq!(again.tolerances().count(), first.tolerances().count());
    // A variant replaces the bounds of an axis as a whole.
    let base = format!("{HEAD}{FRAMED}");
    let variant = "abbe: 1\nextends: m.yaml\ntolerances: { C: { along: 1 um }, B: null, EXX: { A: 9 um } }\n";
    let varied = list(&silent(&[("v.yaml", variant), ("m.yaml", &base)]));
    assert_eq!(
        varied.iter().filter(|(name, _)| name.ends_with(['B', 'C']) || name.starts_with("B ")).count(),
        1,
        "{varied:?}"
    );
    assert!(varied.contains(&("EZC".to_owned(), 1.0)) && varied.contains(&("EXX".to_owned(), 4.5)), "{varied:?}");
}

#[test]
fn bounds_without_letters_count_as_bounds() {
    let folder = Folder::new("bound-words");
    let path = folder.with("m.yaml", &format!("{HEAD}tolerances: {{ B: {{ across: 3 um }} }}\n"));
    let budget = json(&["budget", text(&path), "--samples", "50", "--poses", "20", "--format", "json"]);
    assert_eq!(budget["tighten"].as_array().unwrap().len(), 2);
    assert_eq!((&budget["tighten"][0]["of_class"], &budget["tighten"][0]["by_letter"]), (&false.into(), &false.into()));
    let said = abbe(&["budget", text(&path), "--samples", "10", "--poses", "5"]);
    assert!(said.contains("B across 2") && said.contains("directions of the axis itself"), "{said}");
    assert!(!said.contains("boxes in machine coordinates"));
    let letters = folder.with("l.yaml", &format!("{HEAD}errors: {{ EXB: {{ tolerance: 3 um }} }}\n"));
    let said = abbe(&["budget", text(&letters), "--samples", "10", "--poses", "5"]);
    assert!(said.contains("boxes in machine coordinates") && !said.contains("directions of the axis"), "{said}");
    // An angle that is bounded turns about an origin.
    let bare = HEAD.replacen(", origin: [0, 0, 0]", "", 1);
    let bounded = format!("{bare}tolerances: {{ X: {{ about_across: 7 urad }} }}\n");
    let (_, diagnostics) = read(&[("m.yaml", &bounded)]);
    assert!(diagnostics.iter().any(|d| d.code == "W0405"));
}

#[test]
fn words_of_data_sheets_become_half_their_sum() {
    let of = |words: &str| {
        let found = list(&machine(&format!("tolerances: {{ EXX: {words} }}\n")));
        assert_eq!(found.len(), 1);
        found[0].1
    };
    for (words, bound) in [
        ("8 um", 8.0),
        ("{ A: 8 um }", 4.0),
        ("{ E: 6 um }", 3.0),
        ("{ E: 6 um, R: 3 um }", 4.5),
        ("{ M: 5 um, B: 2 um, R: 3 um }", 5.0),
        ("{ P: 10 um }", 5.0),
        ("{ Pa: 5 um, U: 1 um, Ps: 3 um }", 4.5),
        ("{ width: 0.010 mm }", 5.0),
    ] {
        assert_eq!(of(words), bound, "{words}");
    }
    let angles = list(&machine("tolerances: { ECC: { A: 12 arcsec }, EXB: { width: 6 um } }\n"));
    assert!((angles[0].1 - 6.0 * std::f64::consts::PI / 648_000.0 * 1e6).abs() < 1e-5, "{angles:?}");
}

#[test]
fn words_stand_beside_the_axis_itself() {
    let found = list(&machine(
        "tolerances:\n  B: { about_along: { P: 9 arcsec }, about_across: { width: 40 urad }, along: +-3 um }\n  X: { \
         along: { A: +-4 um } }\n  Y: { along: { E: 6 um, R: \u{b1}1 um } }\n  EZZ: +-4 um\n  C: { about_along: { \
         Tp: 20 urad } }\n  X-Y: { width: 40 urad }\n",
    ));
    let of = |name: &str| found.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("{found:?}")).1;
    let half = 4.5 * std::f64::consts::PI / 648_000.0 * 1e6;
    assert!((of("B about along") - half).abs() < 1e-5, "{found:?}");
    for (name, bound) in [
        ("EAB", 20.0),
        ("B about across 2", 20.0),
        ("B along", 3.0),
        ("EXX", 4.0),
        ("EYY", 4.0),
        ("EZZ", 4.0),
        ("ECC", 10.0),
        ("EC0Y", 20.0),
    ] {
        assert_eq!(of(name), bound, "{name}");
    }
    let codes = |rest: &str| {
        let (_, diagnostics) = read(&[("m.yaml", &format!("{HEAD}tolerances: {{ {rest} }}\n"))]);
        diagnostics.iter().map(|d| d.code.id).collect::<Vec<_>>()
    };
    // Positioning of a swivel axis is about it; a repeatability alone bounds nothing; a width is no location error.
    for rest in [
        "B: { along: { P: 9 um } }",
        "X: { along: { R: 2 um } }",
        "C: { location: { across: { width: 9 um } } }",
        "X-Y: { A: 9 arcsec }",
        "X: { along: { } }",
    ] {
        assert_eq!(codes(rest), ["E0416"], "{rest}");
    }
    assert_eq!(codes("B: { about_along: { Q: 9 urad } }"), ["E0201"]);
    assert_eq!(codes("EXX: +--4 um"), ["E0411"]);
    // A letter that is neither along the axis nor across it.
    assert_eq!(codes("EBB: { P: 9 arcsec }"), ["W0407"]);
    assert!(codes("EXB: 3 um, ECC: 9 urad").is_empty());
}

/// Figures of random measurements by their definitions: half the sum of the widths holds every reading, about the middle.
#[test]
fn the_bounds_hold_what_the_figures_were_made_of() {
    let mut random = Random::new(8);
    let range = |list: &[f64]| {
        let (low, high) = list.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
        high - low
    };
    let largest = |list: &[f64]| list.iter().copied().fold(f64::MIN, f64::max);
    for _ in 0..2000 {
        let n = 2 + random.below(9);
        let mut column = |size: f64| (0..n).map(|_| random.around(size)).collect::<Vec<_>>();
        let (up, down) = (column(5.0), column(5.0));
        let (su, sd) = (column(1.0), column(1.0));
        let (su, sd): (Vec<f64>, Vec<f64>) =
            (su.iter().map(|x| x.abs()).collect(), sd.iter().map(|x| x.abs()).collect());
        let with = |k: f64| -> Vec<f64> {
            let ends = |(x, s): (&f64, &f64)| [x - k * s, x + k * s];
            up.iter().zip(&su).chain(down.iter().zip(&sd)).flat_map(ends).collect()
        };
        // ISO 230-2.
        let a = range(&with(2.0));
        let e = range(&[&up[..], &down[..]].concat());
        let mean: Vec<f64> = up.iter().zip(&down).map(|(u, d)| (u + d) / 2.0).collect();
        let b: Vec<f64> = up.iter().zip(&down).map(|(u, d)| (u - d).abs()).collect();
        let r: Vec<f64> =
            (0..n).map(|i| (2.0 * su[i] + 2.0 * sd[i] + b[i]).max(4.0 * su[i]).max(4.0 * sd[i])).collect();
        let (m, b_max, r_max) = (range(&mean), largest(&b), largest(&r));
        assert!(e <= a + 1e-12 && a <= e + r_max + 1e-12 && e <= m + b_max + 1e-12);
        assert!(a <= m + b_max + r_max + 1e-12);
        // VDI/DGQ 3441: about the mean of both directions, six mean standard deviations.
        let ps: Vec<f64> = su.iter().zip(&sd).map(|(u, d)| 3.0 * (u + d)).collect();
        let ends = (0..n).flat_map(|i| [-1.0, 1.0].map(|sign| mean[i] + sign * (b[i] + ps[i]) / 2.0));
        let p = range(&ends.collect::<Vec<_>>());
        assert!(p <= m + b_max + largest(&ps) + 1e-12);
    }
}

#[test]
fn a_file_names_its_class_and_the_command_line_goes_over_it() {
    let folder = Folder::new("bound-class");
    let plain = folder.with("plain.yaml", HEAD);
    // On a few tool poses no worst pose is searched.
    let work = folder.with("work.csv", "X,Y,Z,B,C\n100,100,-200,0,0\n200,150,-250,20,0\n150,100,-200,0,40\n");
    let premium = folder.with("premium.yaml", &format!("{HEAD}class: premium\n"));
    let run = |path: &std::path::Path, more: &[&str]| {
        let fixed = [
            "budget",
            text(path),
            "--samples",
            "60",
            "--reference",
            "machine",
            "--tool-poses",
            text(&work),
            "--format",
            "json",
        ];
        json(&[&fixed[..], more].concat())
    };
    let by_file = run(&premium, &[]);
    assert_eq!((&by_file["class"], by_file["class_source"].is_string()), (&Value::from("premium"), true));
    assert_eq!(by_file, run(&plain, &["--class", "premium"]));
    assert_eq!(run(&premium, &["--class", "production"]), run(&plain, &["--class", "production"]));
    // What `explain` prints is what a file takes.
    let said = abbe(&["explain", "production"]);
    let block = &said[said.find("class:\n").unwrap()..said.find("\nA number left out").unwrap()];
    let pasted = folder.with("pasted.yaml", &format!("{HEAD}{block}"));
    let (mut a, mut b) = (run(&pasted, &[]), run(&plain, &["--class", "production"]));
    for budget in [&mut a, &mut b] {
        budget["class"] = Value::Null;
    }
    assert_eq!(a, b);
    let like =
        folder.with("like.yaml", &format!("{HEAD}class: {{ like: premium, linear: {{ squareness: 3 urad }} }}\n"));
    let tighten = run(&like, &[])["tighten"].as_array().unwrap().clone();
    let of = |name: &str| tighten.iter().find(|t| t["error"] == name).unwrap()["tolerance"].as_f64().unwrap();
    assert!((of("EC0Y") - 3.0).abs() < 1e-9 && (of("EA0C") - 20.0).abs() < 1e-9, "{tighten:?}");
    // Each machine of a comparison has its own.
    let portal = folder.with("portal.yaml", &format!("{HEAD}class: large-gantry\n"));
    let compare = |more: &[&str]| {
        let fixed = ["compare", text(&premium), text(&portal), "--poses", "20", "--samples", "40"];
        [&fixed[..], more].concat().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let arguments = compare(&["--format", "json"]);
    let budgets = json(&arguments.iter().map(String::as_str).collect::<Vec<_>>())["budgets"].clone();
    let names: Vec<&Value> = budgets["machines"].as_array().unwrap().iter().map(|m| &m["class"]).collect();
    assert_eq!(names, ["premium", "large-gantry"]);
    assert!(budgets["class"].is_null());
    let p95 = |i: usize| budgets["machines"][i]["position_um"]["monte_carlo"]["p95"].as_f64().unwrap();
    assert!(p95(1) > 2.0 * p95(0));
    let arguments = compare(&[]);
    let said = abbe(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(said.contains("classes premium and large-gantry"), "{said}");
    // A class without rotary axes.
    let commodity = folder.with("commodity.yaml", &format!("{HEAD}class: commodity\n"));
    let (exit, said) = refused(&["budget", text(&commodity)]);
    assert!(exit == 1 && said.contains("E0605"), "{said}");
}

#[test]
fn the_axis_of_the_tool_is_any_direction() {
    let with = |tool: &str| silent(&[("m.yaml", &HEAD.replace("tool: { gauge: [0, 0, 0], length: 150 }", tool))]);
    let slanted = with("tool: { gauge: [10, 20, 30], length: 50, direction: [0, 3, 4] }");
    assert_eq!(slanted.tool().tip, [10.0, -10.0, -10.0]);
    assert_eq!(slanted.tool().direction, [0.0, 0.6, 0.8]);
    let again = silent(&[("m.yaml", &machine_file(&slanted.to_parts(), &[]))]);
    let same = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
    assert!(same(again.tool().tip, slanted.tool().tip) && same(again.tool().direction, slanted.tool().direction));
    // At B = 180 deg about (0, 1, 1) the axis (0, 0.6, 0.8) goes to (0, 0.8, 0.6); C turns the table under it.
    let pose = |b: f64, c: f64| {
        let at = |axis: &abbe::machine::Axis| match axis.name.as_str() {
            "B" => b,
            "C" => c,
            _ => 0.0,
        };
        slanted.axes().iter().map(at).collect::<Vec<_>>()
    };
    let near = |d: nalgebra::Vector3<f64>, wanted: [f64; 3]| (d - nalgebra::Vector3::from(wanted)).norm() < 1e-12;
    let reached = abbe::analysis::tool_pose(&slanted, &pose(180.0, 0.0));
    assert!(near(reached.direction, [0.0, 0.8, 0.6]), "{reached:?}");
    for target in [pose(70.0, 200.0), pose(20.0, 35.0)] {
        let wanted = abbe::analysis::tool_pose(&slanted, &target);
        if let Ok(found) = abbe::analysis::inverse(&slanted, &wanted, &target) {
            let again = abbe::analysis::tool_pose(&slanted, &found);
            assert!((again.direction - wanted.direction).norm() < 1e-9 && (again.tip - wanted.tip).norm() < 1e-6);
        } else {
            panic!("{target:?} is out of reach");
        }
    }
}
