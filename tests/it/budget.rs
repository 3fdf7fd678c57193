//! Budgets against closed forms, and the kernel against the model.

use crate::configs::all;
use crate::interactions::unit_response;
use crate::oracle::random::Random;
use crate::program::{Folder, abbe, abbe_on, json, refused, text, well_formed};
use abbe::analysis::budget::{ActingErrors, Distribution, Draws, Request, Statistic, bounds, budget, longest, mean};
use abbe::evaluate::random_poses;
use abbe::lower::{Quantity, SideWeights, sensitivities_to, twists};
use abbe::machine::{Direction, ErrorFamily, ErrorId, Machine};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A machine with these errors; X, Y and Z of 400 mm, Y 500 mm.
fn with_errors(folder: &Folder, errors: &str) -> std::path::PathBuf {
    let lines = [
        "abbe: 1",
        "machine: M",
        "chain: w b X Y Z t",
        "axes: { X: { travel: [0, 400], origin: [0, 0, 0] }, Y: { travel: [0, 500], origin: [0, 0, 0] }, Z: { travel: [0, 400], origin: [0, 0, 0] } }",
        &format!("errors: {{ {errors} }}"),
    ];
    folder.with("m.yaml", &lines.join("\n"))
}

/// Every error that any joint can have.
fn every_error(machine: &Machine) -> Vec<ErrorId> {
    let names = machine.axes().iter().map(|axis| &axis.name).chain(machine.chain().spindle());
    let mut ids = Vec::new();
    for (i, name) in names.enumerate() {
        for family in ErrorFamily::ALL {
            if family == ErrorFamily::Location || i < machine.axes().len() {
                ids.extend(Direction::ALL.map(|direction| ErrorId { axis: name.clone(), family, direction }));
            }
        }
    }
    ids
}

#[test]
fn twists_are_the_sensitivities_of_the_model() {
    // The papers' machines bring the conventions of carried bodies, `body`, `before` and `direct`.
    for (name, machine) in all() {
        let ids = every_error(&machine);
        for pose in random_poses(&machine, 5, 2) {
            let maps = [Quantity::Position, Quantity::Rotation].map(|q| twists(&machine, &pose, q));
            for s in sensitivities_to(&machine, &pose, &ids) {
                let joint = machine.axis_index(s.error.axis.as_str()).unwrap_or(pose.len());
                let weights = match machine.axes().get(joint) {
                    Some(axis) if s.error.is_location() => SideWeights::location(axis, machine.conventions()),
                    Some(axis) => SideWeights::component(axis, machine.conventions()),
                    None => SideWeights::SPINDLE,
                };
                let column = |q: usize| -> [f64; 3] {
                    std::array::from_fn(|i| weights.map(&maps[q][joint])[i][s.error.direction.index()])
                };
                let near = |a: [f64; 3], b: nalgebra::Vector3<f64>| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9);
                let [deviation, rotation] = unit_response(&machine, &pose, &s.error);
                assert!(near(column(0), deviation), "{name}: {} at {pose:?}", s.error);
                assert!(near(column(1), rotation), "{name}: {} at {pose:?}", s.error);
                assert!(near(column(0), s.deviation) && near(column(1), s.rotation), "{name}: {}", s.error);
            }
        }
    }
}

#[test]
fn one_squareness_has_the_distribution_of_a_rectangle() {
    let folder = Folder::new("budget-one");
    let path = with_errors(&folder, "EC0Y: { tolerance: 20 urad }");
    let b = json(&["budget", text(&path), "--samples", "4000", "--format", "json"]);
    let p = &b["position_um"];
    // 20 urad at 500 mm are 10 um, at a corner of the volume, so exactly there.
    for key in ["worst_case", "rss", "mean_of_both"] {
        assert!((number(&p[key]) - 10.0).abs() < 1e-9, "{key}: {}", p[key]);
    }
    // |U| of a rectangle of half width 10: mean 5, percentiles in proportion.
    let mc = &p["monte_carlo"];
    let four_sigma = 4.0 * 10.0 / 12.0_f64.sqrt() / 4000.0_f64.sqrt();
    assert!((number(&mc["mean"]) - 5.0).abs() < four_sigma, "{mc}");
    for (key, truth) in [("p50", 5.0), ("p90", 9.0), ("p95", 9.5), ("p99", 9.9)] {
        let share: f64 = truth / 10.0;
        let spread = 4.0 * (share * (1.0 - share) / 4000.0).sqrt() * 10.0;
        assert!((number(&mc["percentiles"][key]["value"]) - truth).abs() < spread, "{key}: {mc}");
    }
    assert_eq!(mc["p95"], mc["percentiles"]["p95"]["value"]);
    // The error grows in proportion to its only tolerance.
    let t = &b["tighten"][0];
    assert!((number(&t["um_per_unit"]) - number(&mc["p95"]) / 20.0).abs() < 0.01, "{t}");
    assert_eq!(b["contributions"][0]["share"], 1.0);
}

#[test]
fn a_curve_of_position_errors_reaches_further_than_any_of_its_points_but_not_its_bound() {
    let folder = Folder::new("budget-curve");
    let path = with_errors(&folder, "EXX: { tolerance: 10 um }");
    let b = json(&["budget", text(&path), "--samples", "2000", "--poses", "400", "--format", "json"]);
    let mc = &b["position_um"]["monte_carlo"];
    assert!((number(&b["position_um"]["worst_case"]) - 10.0).abs() < 1e-9);
    // A constant would have the mean 5; the largest of a curve is more, and never above the bound.
    assert!(number(&mc["mean"]) > 6.0 && number(&mc["percentiles"]["p99"]["value"]) <= 10.0, "{mc}");
    // At one pose it is a rectangle again.
    let one = folder.with(
        "one.yaml",
        "abbe: 1\nmachine: M\nchain: w b X Y t\naxes: { X: { travel: [0, 400], origin: [0, 0, 0] }, Y: { travel: [0, 1], origin: [0, 0, 0] } }\n\
         errors: { EXX: { tolerance: 10 um } }\nvolume: { X: [123, 123.000001] }\n",
    );
    let b = json(&["budget", text(&one), "--samples", "4000", "--poses", "1", "--format", "json"]);
    let mean = number(&b["position_um"]["monte_carlo"]["mean"]);
    assert!((mean - 5.0).abs() < 4.0 * 10.0 / 12.0_f64.sqrt() / 4000.0_f64.sqrt(), "{mean}");
}

#[test]
fn three_equal_errors_at_one_place_have_the_moments_of_their_sum() {
    // EXX, EYY, EZZ alone at a fixed pose: |d|^2 is a sum of three squares of rectangles, whose mean is t^2.
    let folder = Folder::new("budget-three");
    let path = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\n\
         axes: { X: { travel: [0, 400], origin: [0, 0, 0] }, Y: { travel: [0, 400], origin: [0, 0, 0] }, Z: { travel: [0, 400], origin: [0, 0, 0] } }\n\
         errors: { EXX: { tolerance: 10 um }, EYY: { tolerance: 10 um }, EZZ: { tolerance: 10 um } }\n\
         volume: { step: 50 mm }\n",
    );
    for (word, distribution) in [("uniform", Distribution::Uniform), ("triangular", Distribution::Triangular)] {
        let machine = crate::loaded::machine(&path);
        let bounds = bounds(&machine, None);
        let poses = [vec![100.0, 200.0, 300.0]];
        let draws = Draws::new(5, distribution);
        let request = Request {
            acting: ActingErrors::None,
            machine: &machine,
            bounds: &bounds,
            poses: &poses,
            reference: None,
            searched: false,
            at: None,
            draws: &draws,
            samples: 8000,
            statistic: Statistic::Max,
        };
        let b = budget(request, &|_| Ok(())).unwrap();
        let squares: Vec<f64> = b.position.sorted.iter().map(|x| x * x).collect();
        let (mean, sigma) = mean(&squares);
        // The variance of each is the square of tolerance times `deviation`: 100/3 or 100/6.
        let truth = 3.0 * 100.0 * distribution.deviation() * distribution.deviation();
        assert!((mean - truth).abs() < 4.0 * sigma, "{word}: {mean} ± {sigma} instead of {truth}");
        assert!(
            (b.position.rss - 300.0_f64.sqrt()).abs() < 1e-9 && (b.position.worst_case - 300.0_f64.sqrt()).abs() < 1e-9
        );
    }
}

#[test]
fn the_derivatives_sum_up_to_the_95_percent_value_and_agree_with_finite_differences() {
    let folder = Folder::new("budget-derivative");
    let at = |squareness: f64| {
        let errors = format!(
            "EC0Y: {{ tolerance: {squareness} urad }}, EB0Z: {{ tolerance: 15 urad }}, EXX: {{ tolerance: 4 um }}, ECX: {{ tolerance: 12 urad }}"
        );
        let path = with_errors(&folder, &errors);
        json(&["budget", text(&path), "--samples", "20000", "--poses", "40", "--format", "json"])
    };
    let (middle, above, below) = (at(20.0), at(20.5), at(19.5));
    let p95 = |b: &Value| number(&b["position_um"]["monte_carlo"]["p95"]);
    let sum: f64 = middle["tighten"].as_array().unwrap().iter().map(|t| number(&t["um_of_p95"])).sum();
    // The window reaches from 92.5 to 97.5 %: its mean is not exactly the 95 % value.
    assert!((sum - p95(&middle)).abs() < 0.02 * p95(&middle), "{sum} {}", p95(&middle));
    let t = middle["tighten"].as_array().unwrap().iter().find(|t| t["error"] == "EC0Y").unwrap();
    let (derivative, sigma) = (number(&t["um_per_unit"]), number(&t["sigma"]));
    let finite = p95(&above) - p95(&below);
    assert!((derivative - finite).abs() < 4.0 * sigma + 0.03 * derivative, "{derivative} ± {sigma}, {finite}");
    assert!(derivative > 0.1);
}

#[test]
fn the_worst_case_is_that_of_the_worst_signs() {
    let mut random = Random::new(4);
    for count in 1..=12 {
        let vectors: Vec<[f64; 3]> = (0..count).map(|_| random.vector(1.0)).collect();
        let mut best = 0.0_f64;
        for signs in 0..1_u32 << count {
            let sum = vectors.iter().enumerate().fold([0.0; 3], |sum: [f64; 3], (k, v)| {
                let sign = if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
                std::array::from_fn(|i| sum[i] + sign * v[i])
            });
            best = best.max(sum.iter().map(|x| x * x).sum::<f64>().sqrt());
        }
        assert!((longest(&vectors) - best).abs() < 1e-12, "{count}");
    }
}

#[test]
fn totals_stand_in_their_order_on_every_config() {
    for (name, machine) in all() {
        // A class without rotary axes does not do for machines that have some.
        let b =
            json(&["budget", &name, "--class", "production", "--samples", "80", "--poses", "40", "--format", "json"]);
        for key in ["position_um", "rotation_urad"] {
            let t = &b[key];
            let (worst, rss, mc) = (number(&t["worst_case"]), number(&t["rss"]), &t["monte_carlo"]);
            assert!(rss > 0.0 && rss <= worst * (1.0 + 1e-12), "{name}: {t}");
            assert!((number(&t["mean_of_both"]) - 0.5 * (rss + worst)).abs() < 1e-9);
            let p = |p: &str| number(&mc["percentiles"][p]["value"]);
            assert!(p("p50") <= p("p95") && p("p95") <= p("p99") && p("p99") <= worst, "{name}: {t}");
        }
        let shares: f64 = b["contributions"].as_array().unwrap().iter().map(|c| number(&c["share"])).sum();
        assert!((shares - 1.0).abs() < 1e-9);
        let squares: f64 = b["contributions"].as_array().unwrap().iter().map(|c| number(&c["um"]).powi(2)).sum();
        // Where some errors have values these act beside the bounds.
        let (rss, values) = (number(&b["position_um"]["rss"]), b["with_values"]["errors"].as_u64().unwrap_or(0));
        let is_whole = (squares.sqrt() - rss).abs() < 1e-9;
        assert!(if values == 0 { is_whole } else { squares.sqrt() < rss }, "{name}");
        let bounded = b["contributions"].as_array().unwrap().len();
        assert!(bounded + values as usize >= 6 * machine.axes().len(), "{name}");
    }
}

#[test]
fn the_seed_decides_and_the_threads_do_not() {
    let arguments =
        ["budget", "tt-bc.yaml", "--class", "premium", "--samples", "130", "--poses", "50", "--format", "json"];
    let bytes = [1, 2, 5].map(|threads| abbe_on(threads, &arguments).stdout);
    assert!(!bytes[0].is_empty() && bytes[0] == bytes[1] && bytes[0] == bytes[2]);
    let other = abbe_on(2, &[&arguments[..], &["--seed", "2"]].concat()).stdout;
    assert_ne!(other, bytes[0]);
}

#[test]
fn a_tolerance_of_the_file_takes_the_place_of_the_class() {
    let folder = Folder::new("budget-own");
    let path = with_errors(&folder, "EXX: { tolerance: 1.5 um }, EYX: 3 um, EC0Y: { tolerance: 0 urad }");
    let b = json(&["budget", text(&path), "--class", "production", "--samples", "50", "--format", "json"]);
    let of = |name: &str| b["tighten"].as_array().unwrap().iter().find(|t| t["error"] == name).cloned();
    let own = of("EXX").unwrap();
    assert_eq!((number(&own["tolerance"]), &own["of_class"]), (1.5, &Value::Bool(false)));
    // What has a value keeps it.
    assert!(of("EYX").is_none());
    assert_eq!(of("EZX").unwrap()["of_class"], true);
    // 10 um/m over 400 mm.
    assert_eq!(number(&of("EZZ").unwrap()["tolerance"]), 4.0);
    assert!(of("EC0Y").is_none(), "a bound of zero leaves nothing");
    assert_eq!((&b["left_out"], &b["with_values"]["errors"]), (&0.into(), &1.into()));
}

#[test]
fn what_cannot_be_budgeted_is_refused() {
    let folder = Folder::new("budget-refused");
    let values = with_errors(&folder, "EXX: 3 um");
    let says = |arguments: &[&str], code: &str| {
        let (exit, message) = refused(arguments);
        assert!(exit == 1 && message.contains(code) && message.contains("help"), "{arguments:?}: {message}");
    };
    says(&["budget", text(&values)], "E0604");
    says(&["budget", text(&values), "--class", "producton"], "did you mean `production`");
    says(&["budget", "trunnion.yaml", "--class", "commodity"], "E0605");
    let still = folder.with(
        "still.yaml",
        "abbe: 1\nmachine: M\nchain: w b X t\naxes: { X: { travel: [0, 50], origin: [0, 0, 0] } }\nvolume: { X: [7, 7] }\nerrors: { EXX: { tolerance: 1 um } }\n",
    );
    says(&["budget", text(&still)], "E0403");
    let negative = with_errors(&folder, "EXX: { tolerance: -3 um }");
    says(&["budget", text(&negative)], "E0411");
    says(&["budget", "trunnion.yaml", "--class", "production", "--pareto", "none/p.svg", "--samples", "10"], "E0810");
    for counts in [["--samples", "1"], ["--samples", "1000000000000"], ["--poses", "0"], ["--poses", "200000"]] {
        assert_eq!(refused(&[&["budget", "trunnion.yaml", "--class", "production"], &counts[..]].concat()).0, 2);
    }
}

#[test]
fn pictures_and_tables_are_written() {
    let folder = Folder::new("budget-pictures");
    let (pareto, waterfall) = (folder.file("p.svg"), folder.file("w.svg"));
    let csv = abbe(&[
        "budget",
        "hmc-4ax.yaml",
        "--class",
        "production",
        "--samples",
        "60",
        "--poses",
        "30",
        "--format",
        "csv",
        "--pareto",
        text(&pareto),
        "--waterfall",
        text(&waterfall),
        "--at",
        "B=90",
    ]);
    assert!(csv.lines().next().unwrap().starts_with("error,tolerance,unit"));
    assert_eq!(csv.lines().nth(1).unwrap().split(',').count(), csv.lines().next().unwrap().split(',').count());
    for path in [pareto, waterfall] {
        let svg = std::fs::read_to_string(path).unwrap();
        assert_eq!(well_formed(&svg), Ok(()));
        assert!(svg.contains("µm") && !svg.contains("NaN"));
    }
}

/// Worst case and RSS of a machine file by class, um, with the poses where they are.
fn extremes_of(machine: &Machine) -> [(f64, Vec<f64>); 2] {
    let class = abbe::analysis::budget::classes().remove("production").unwrap();
    let (bounds, draws) = (bounds(machine, Some(&class)), Draws::new(1, Distribution::Uniform));
    let poses = abbe::analysis::budget::budget_poses(machine, 20, 1);
    let (statistic, samples) = (Statistic::Max, 2);
    let request = Request {
        acting: ActingErrors::None,
        machine,
        bounds: &bounds,
        poses: &poses,
        reference: None,
        searched: true,
        at: None,
        draws: &draws,
        samples,
        statistic,
    };
    let p = budget(request, &|_| Ok(())).unwrap().position;
    [(p.worst_case, p.worst_pose), (p.rss, p.rss_pose)]
}

#[test]
fn a_part_of_the_volume_is_no_worse_than_the_whole() {
    let folder = Folder::new("budget-parts");
    let mut random = Random::new(5);
    let mut largest = 0.0_f64;
    for name in ["trunnion.yaml", "tt-bc.yaml", "ht-b-c.yaml", "tt-nut45.yaml"] {
        let base = crate::configs::folder().join(name);
        let with = |volume: &str| {
            let text = format!("abbe: 1\nextends: {}\nvolume: {{ {volume} }}\n", base.display());
            crate::loaded::machine(&folder.with("part.yaml", &text))
        };
        let whole_machine = with("step: 25 mm");
        let whole = extremes_of(&whole_machine);
        for (value, pose) in &whole {
            let inside = pose.iter().zip(whole_machine.volume()).all(|(q, grid)| (grid.min..=grid.max).contains(q));
            assert!(inside && *value > 0.0, "{name}: {pose:?}");
        }
        for round in 0..2 {
            let part = |(axis, grid): (&abbe::machine::Axis, &abbe::machine::Grid)| {
                let (a, b) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
                let (a, b) = if round == 0 { (0.0, if axis.unit() == "deg" { 0.5 } else { 1.0 }) } else { (a, b) };
                let at = |x: f64| grid.min + x * (grid.max - grid.min);
                format!("{}: {{ range: [{}, {}] }}", axis.name, at(a.min(b)), at(a.max(b)))
            };
            let ranges: Vec<String> = whole_machine.axes().iter().zip(whole_machine.volume()).map(part).collect();
            let of_part = extremes_of(&with(&ranges.join(", ")));
            for ((whole, _), (part, pose)) in whole.iter().zip(&of_part) {
                largest = largest.max(part / whole);
                assert!(*part <= whole * 1.001, "{name} {ranges:?}: {part} at {pose:?}, the whole {whole}");
            }
        }
        // The RSS by the sensitivities of the model, at many poses.
        let class = abbe::analysis::budget::classes().remove("production").unwrap();
        let limits = bounds(&whole_machine, Some(&class));
        let ids: Vec<ErrorId> = limits.iter().map(|bound| bound.error.clone()).collect();
        for pose in random_poses(&whole_machine, 400, 3) {
            let effects = sensitivities_to(&whole_machine, &pose, &ids);
            let squares = effects.iter().zip(&limits).map(|(s, b)| (s.deviation.norm() * b.tolerance * 1e3).powi(2));
            assert!(squares.sum::<f64>().sqrt() <= whole[1].0 * (1.0 + 1e-9), "{name} {pose:?}");
        }
    }
    println!("largest ratio of a part to the whole: {largest}");
}

/// Parts drawn apart are the budget: the same bytes, whatever their number, their order and the number of threads.
#[test]
fn a_budget_is_the_same_in_parts() {
    let folder = Folder::new("budget-shards");
    let machine = with_errors(&folder, "EXX: { tolerance: 9 um }, EC0Y: { tolerance: 20 urad }");
    let study = ["budget", text(&machine), "--samples", "203", "--poses", "40", "--format", "json"];
    let whole = abbe(&study);
    for parts in [1, 2, 7] {
        let files: Vec<_> = (1..=parts).map(|i| folder.file(&format!("part-{i}-of-{parts}"))).collect();
        let mut drawn = 0;
        for (i, file) in files.iter().enumerate() {
            let part = format!("{}/{parts}", i + 1);
            let draw = [&study[..], &["--shard", &part, "--state", text(file)]].concat();
            let said: Value = serde_json::from_slice(&abbe_on(1 + i % 3, &draw).stdout).unwrap();
            drawn += said["drawn"].as_u64().unwrap();
            let bytes = std::fs::read(file).unwrap();
            // What is there already is taken as it is.
            assert_eq!(abbe_on(2, &draw).status.code(), Some(0));
            assert_eq!(std::fs::read(file).unwrap(), bytes);
        }
        assert_eq!(drawn, 203);
        let named: Vec<&str> = files.iter().rev().map(|file| text(file)).collect();
        assert_eq!(abbe(&[&study[..], &["--merge"], &named].concat()), whole, "{parts}");
    }
    let part = |i: usize| folder.file(&format!("part-{i}-of-7"));
    let says = |more: &[&str], known: &str, words: &str| {
        let (code, message) = refused(&[&study[..], more].concat());
        assert!(code == 1 && message.contains(known) && message.contains(words), "{more:?}: {message}");
    };
    says(&["--merge", text(&part(1)), text(&part(3))], "E0611", "whole up to");
    let (third, before) = (part(3), std::fs::read(part(3)).unwrap());
    says(&["--shard", "2/7", "--state", text(&third)], "E0610", "holds the machines");
    says(&["--shard", "3/7", "--state", text(&third), "--seed", "2"], "E0610", "another budget");
    says(&["--shard", "1/1", "--state", text(&machine)], "E0630", "");
    let altered = folder.file("altered");
    std::fs::write(&altered, String::from_utf8(before.clone()).unwrap().replacen("\"value\":0.0", "\"value\":0.1", 1))
        .unwrap();
    says(&["--shard", "3/7", "--state", text(&altered)], "E0610", "checksum");
    // The same machine, spelled otherwise, has the same parts.
    let same = std::fs::read_to_string(&machine).unwrap().replace("9 um", "'9.0 um'") + "\n# as bought\n";
    let respelled = folder.with("respelled.yaml", &same);
    let draw =
        ["budget", text(&respelled), "--samples", "203", "--poses", "40", "--shard", "3/7", "--state", text(&third)];
    assert_eq!(abbe_on(2, &draw).status.code(), Some(0));
    assert_eq!(std::fs::read(&third).unwrap(), before);
    for usage in [
        &["--shard", "0/7", "--state", "s"][..],
        &["--shard", "1/7"],
        &["--state", "s"],
        &["--shard", "x", "--state", "s"],
        &["--shard", "1/7", "--state", "s", "--goal", "1 mm"],
    ] {
        assert_eq!(refused(&[&study[..], usage].concat()).0, 2, "{usage:?}");
    }
}
