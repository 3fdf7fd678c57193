//! Tolerances for a goal, against closed forms, a search by brute force and drawn machines of their own.

use crate::oracle::random::Random;
use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use abbe::analysis::budget::{Distribution, Draws, NODES, budget_poses};
use abbe::lower::sensitivities_to;
use abbe::machine::ErrorId;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// X and Z of 400 mm, Y of 500 mm, with these errors.
fn with_errors(folder: &Folder, errors: &str) -> PathBuf {
    let axis = |name: &str, travel: f64| format!("{name}: {{ travel: [0, {travel}], origin: [0, 0, 0] }}");
    let axes = [axis("X", 400.0), axis("Y", 500.0), axis("Z", 400.0)].join(", ");
    let yaml = format!("abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: {{ {axes} }}\nerrors: {{ {errors} }}\n");
    folder.with("m.yaml", &yaml)
}

fn goal(path: &Path, goal: &str, more: &[&str]) -> Value {
    let arguments = ["budget", text(path), "--goal", goal, "--samples", "1000", "--format", "json"];
    json(&[&arguments[..], more].concat())["goal"].clone()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The entry of an error.
fn of<'a>(goal: &'a Value, error: &str) -> &'a Value {
    let list = goal["tolerances"].as_array().unwrap();
    list.iter().find(|entry| entry["error"] == error).unwrap_or_else(|| panic!("{error}: {goal}"))
}

fn percentile_95(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() * 95).div_ceil(100) - 1]
}

#[test]
fn one_squareness_has_the_closed_form() {
    let folder = Folder::new("goal-one");
    let path = with_errors(&folder, "EC0Y: { tolerance: 20 urad }");
    // |U| of a rectangle of half width 500 mm * t: its 95 % value is 0.95 of that, 0.475 um per urad. A default run of
    // 1000 machines has 0.95 +- 1.96 sqrt(0.95 * 0.05 / 1000) = 0.95 +- 0.0135 of them below, which |U| repeats.
    let found = goal(&path, "4.75 um", &["--poses", "20"]);
    let new = of(&found, "EC0Y");
    let tolerance = 10.0 * 0.95 / 0.9635;
    assert!((number(&new["new"]) - tolerance).abs() < 0.15, "{new}");
    assert_eq!((&new["old"], &new["unit"], &new["binds"]), (&20.0.into(), &"urad".into(), &"goal".into()));
    let proof = &found["proof_um"];
    assert!((number(&proof["value"]) - 0.475 * number(&new["new"])).abs() < 0.005 * 4.75, "{proof}");
    assert!(number(&proof["high"]) < 4.75 && found["proof_samples"] == 100_000, "{found}");
    // Cost 20 / t - 1 with t = p95 / 0.475: a micrometre less of p95 costs 20 * 0.475 / p95^2.
    let (cost, p95) = (&found["cost"], number(&proof["value"]));
    assert!(number(&cost["before"]) == 0.0 && (number(&cost["after"]) - (20.0 * 0.475 / p95 - 1.0)).abs() < 0.02);
    assert!((number(&cost["per_um"]) - 20.0 * 0.475 / p95 / p95).abs() < 0.02, "{cost}");
    assert_eq!((&cost["unit"], &cost["power"]), (&"tolerances halved".into(), &Value::Null));
    assert_eq!(found["staying_um"], 0.0);
}

#[test]
fn two_errors_at_one_place_are_those_of_a_search_by_brute_force() {
    let folder = Folder::new("goal-two");
    let path = with_errors(&folder, "EXX: { tolerance: 10 um }, EYY: { tolerance: 10 um }");
    let work = folder.with("work.csv", "X,Y,Z\n100,200,300\n");
    let cost = folder.with("cost.yaml", "weights: { EXX: 8, positioning: 1 }\n");
    let found = goal(&path, "6 um", &["--reference", "machine", "--tool-poses", text(&work), "--cost", text(&cost)]);
    let (x, y) = (number(&of(&found, "EXX")["new"]), number(&of(&found, "EYY")["new"]));
    // Machines of our own: (x U, y V) with U and V even in -1..1.
    let mut random = Random::new(3);
    let drawn: Vec<(f64, f64)> = (0..40_000).map(|_| (random.around(1.0), random.around(1.0))).collect();
    let value = |x: f64, y: f64| percentile_95(drawn.iter().map(|(u, v)| (x * u).hypot(y * v)).collect());
    // Below the goal by the sampling error of a default run.
    let own = value(x, y);
    assert!(own < 6.0 * 1.005 && own > 0.94 * 6.0, "{x} {y}: {own}");
    // Of all ratios, each scaled to the goal, none is cheaper by more than the noise.
    let cost = |ratio: f64| (8.0 / ratio + 1.0) * value(ratio, 1.0) / own;
    let best = (1..80).map(|i| cost(0.05 * f64::from(i))).fold(f64::INFINITY, f64::min);
    assert!(8.0 / x + 1.0 / y < 1.02 * best, "{x} {y}: {} {best}", 8.0 / x + 1.0 / y);
    assert_eq!((&of(&found, "EXX")["weight"], &of(&found, "EXX")["kind"]), (&8.0.into(), &"positioning".into()));
}

const SIX: &str = "EXX: { tolerance: 8 um }, EYX: { tolerance: 6 um }, ECX: { tolerance: 20 urad }, \
                   EC0Y: { tolerance: 20 urad }, EB0Z: { tolerance: 30 urad }, EAY: { tolerance: 15 urad }, EYY: 2 um";

/// The 95 % value (um) of machines of our own with the new tolerances, with EYY = 2 um that stays.
fn own_p95(path: &Path, found: &Value, poses: usize) -> f64 {
    const SAMPLES: usize = 3000;
    let machine = crate::loaded::machine(path);
    let draws = Draws::new(77, Distribution::Uniform);
    let errors: Vec<ErrorId> = machine.errors().map(|(error, _)| error).filter(|e| e.to_string() != "EYY").collect();
    let tolerance = |error: &ErrorId| {
        let entry = of(found, &error.to_string());
        number(&entry["new"]) * if entry["unit"] == "um" { 1e-3 } else { 1e-6 }
    };
    let tolerances: Vec<f64> = errors.iter().map(tolerance).collect();
    let curve = |error: &ErrorId, sample: usize| {
        if error.is_location() {
            vec![draws.constant(error, sample); NODES]
        } else {
            draws.curve(error, sample, false).to_vec()
        }
    };
    let drawn: Vec<Vec<Vec<f64>>> =
        (0..SAMPLES).map(|sample| errors.iter().map(|error| curve(error, sample)).collect()).collect();
    let mut values = vec![0.0_f64; SAMPLES];
    for pose in budget_poses(&machine, poses, 1) {
        let effects = sensitivities_to(&machine, &pose, &errors);
        let at = |k: usize| {
            let axis = machine.axis_index(errors[k].axis.as_str()).unwrap();
            let (min, max) = machine.axes()[axis].travel.interval();
            let x = (pose[axis] - min) / (max - min) * (NODES - 1) as f64;
            let node = (x as usize).min(NODES - 2);
            (node, x - node as f64)
        };
        let places: Vec<(usize, f64)> = (0..errors.len()).map(at).collect();
        for (value, curves) in values.iter_mut().zip(&drawn) {
            let mut sum = [0.0, 2e-3, 0.0];
            for (k, curve) in curves.iter().enumerate() {
                let (node, share) = places[k];
                let fraction = curve[node] + share * (curve[node + 1] - curve[node]);
                (0..3).for_each(|i| sum[i] += effects[k].deviation[i] * fraction * tolerances[k]);
            }
            *value = value.max((sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt() * 1e3);
        }
    }
    percentile_95(values)
}

#[test]
fn machines_of_our_own_keep_the_goal_and_limits_bind() {
    let folder = Folder::new("goal-six");
    let path = with_errors(&folder, SIX);
    let found = goal(&path, "12 um", &["--poses", "20"]);
    assert!((number(&found["staying_um"]) - 2.0).abs() < 1e-9);
    // Below the goal by the sampling error of a default run.
    let within = |own: f64| assert!(own < 12.0 * 1.005 && own > 0.94 * 12.0, "{own}");
    within(own_p95(&path, &found, 20));
    // Weight times present / new is in proportion to the part of the 95 % value.
    let list = found["tolerances"].as_array().unwrap();
    let price = number(&found["cost"]["per_um"]);
    for entry in list.iter().filter(|entry| entry["binds"] == "goal" && number(&entry["um_of_p95"]) > 1.0) {
        let ratio = (number(&entry["cost_after"]) + 1.0) / number(&entry["um_of_p95"]) / price;
        assert!((ratio - 1.0).abs() < 0.25, "{ratio} {entry}");
    }
    // No single tolerance can be given up for another at less cost: a limit that binds makes the whole dearer.
    let limits = folder.with("cost.yaml", "finest: { EC0Y: 18 urad }\ncoarsest: { EXX: 1.5 um, EYX: 1.5 um }\n");
    let bound = goal(&path, "12 um", &["--poses", "20", "--cost", text(&limits)]);
    for (error, binds, new) in [("EC0Y", "finest", 18.0), ("EXX", "coarsest", 1.5), ("EYX", "coarsest", 1.5)] {
        let entry = of(&bound, error);
        assert!(entry["binds"] == binds && (number(&entry["new"]) - new).abs() < 1e-9, "{entry}");
    }
    assert!(number(&bound["cost"]["after"]) > number(&found["cost"]["after"]));
    within(own_p95(&path, &bound, 20));
    // The same on any number of threads.
    let on = |threads: usize| {
        let goal = ["--goal", "12 um", "--samples", "200", "--poses", "4", "--format", "json"];
        abbe_on(threads, &[&["budget", text(&path)], &goal[..]].concat()).stdout
    };
    assert_eq!(on(1), on(3));
    let said = abbe(&["budget", text(&path), "--goal", "12 um", "--samples", "200", "--poses", "4"]);
    for words in ["Cheapest tolerances for a 95 % value of 12 um", "the next micrometre less costs", "stay: 2 um"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let csv = abbe(&["budget", text(&path), "--goal", "12 um", "--samples", "200", "--poses", "4", "--format", "csv"]);
    assert!(csv.lines().next().unwrap().ends_with(",new tolerance,binds") && csv.contains(",goal\n"), "{csv}");
}

/// The file with the new tolerances passes: in a default run, the upper end of the interval is within the goal.
#[test]
fn the_written_file_is_within_the_goal_by_a_default_run() {
    let folder = Folder::new("goal-written");
    for (errors, limit) in [(SIX, 12.0), ("EC0Y: { tolerance: 20 urad }, EXX: { tolerance: 9 um }", 8.0)] {
        let path = with_errors(&folder, errors);
        let found =
            json(&["budget", text(&path), "--goal", &format!("{limit} um"), "--format", "json"])["goal"].clone();
        let mut lines = Vec::new();
        for entry in found["tolerances"].as_array().unwrap() {
            let (error, unit) = (entry["error"].as_str().unwrap(), entry["unit"].as_str().unwrap());
            assert!(number(&entry["new"]) <= number(&entry["old"]), "{entry}");
            lines.push(format!("{error}: {{ tolerance: {} {unit} }}", number(&entry["new"])));
        }
        // Measured errors are left out of the figures of a budget, and count for a goal.
        let written = with_errors(&folder, &lines.join(", "));
        for seed in ["1", "2", "3"] {
            let p95 = &json(&["budget", text(&written), "--seed", seed, "--format", "json"])["position_um"]["monte_carlo"]
                ["percentiles"]["p95"];
            let of_interval = if seed == "1" { "high" } else { "value" };
            assert!(number(&p95[of_interval]) <= limit, "{errors}, seed {seed}: {p95}");
        }
    }
}

#[test]
fn what_is_held_stays_and_nothing_is_loosened_unasked() {
    let folder = Folder::new("goal-held");
    let path = with_errors(&folder, &format!("{SIX}, EZZ: {{ tolerance: 0.5 um }}"));
    let held = folder.with("held.yaml", "held: { positioning: true, squareness: true, EB0Z: false }\nunit: EUR\n");
    let found = goal(&path, "19 um", &["--poses", "20", "--cost", text(&held)]);
    for entry in found["tolerances"].as_array().unwrap() {
        let (error, old, new) = (entry["error"].as_str().unwrap(), number(&entry["old"]), number(&entry["new"]));
        let is_held = ["EXX", "EZZ", "EC0Y"].contains(&error);
        assert_eq!((entry["binds"] == "held", new == old || !is_held), (is_held, true), "{entry}");
        let cost = number(&entry["cost_after"]);
        assert!(new <= old && (cost - (old / new - 1.0)).abs() < 1e-9, "{entry}");
    }
    assert_eq!(found["cost"]["unit"], "EUR");
    let own = own_p95(&path, &found, 20);
    assert!(own < 19.0 && own > 0.93 * 19.0, "{own}");
    // With fewer to be tightened the same goal costs more.
    let free = goal(&path, "19 um", &["--poses", "20"]);
    assert!(number(&free["cost"]["after"]) < number(&found["cost"]["after"]));
    // What hardly counts is loosened where that is allowed, which pays for the rest.
    let loose = goal(&path, "19 um", &["--poses", "20", "--loosen"]);
    let coarser = |of: &Value| {
        of["tolerances"].as_array().unwrap().iter().filter(|e| e["new"].as_f64() > e["old"].as_f64()).count()
    };
    assert!(coarser(&loose) > 0 && coarser(&free) == 0, "{loose}");
    assert!(number(&loose["cost"]["after"]) < number(&free["cost"]["after"]));
    let said = abbe(&["budget", text(&path), "--goal", "19 um", "--poses", "20", "--loosen"]);
    assert!(said.contains("Coarser than now:") && said.contains("tolerances halved"), "{said}");
    let said = abbe(&["budget", text(&path), "--goal", "19 um", "--poses", "20", "--cost", text(&held)]);
    assert!(said.contains("3 of them held") && said.contains(" EUR"), "{said}");
    // Held ones alone are above the goal.
    let all = folder.with("all.yaml", "held: { squareness: true }\n");
    let arguments = ["budget", text(&path), "--goal", "4 um", "--poses", "20", "--cost", text(&all)];
    let (code, message) = refused(&arguments);
    assert!(code == 1 && message.contains("by tightening what is not held (2 are)"), "{message}");
    // A goal that is met asks for nothing.
    let met = goal(&path, "60 um", &["--poses", "20"]);
    assert!(number(&met["cost"]["after"]) == 0.0 && coarser(&met) == 0, "{met}");
}

#[test]
fn a_goal_out_of_reach_says_what_is_left() {
    let folder = Folder::new("goal-none");
    let path = with_errors(&folder, "EC0Y: { tolerance: 20 urad }, EYY: 40 um");
    let says = |more: &[&str], words: &[&str]| {
        let arguments = [&["budget", text(&path), "--samples", "100", "--poses", "4"], more].concat();
        let (code, message) = refused(&arguments);
        assert!(code == 1 && words.iter().all(|word| message.contains(word)), "{message}");
    };
    says(&["--goal", "30 um"], &["E0614", "the goal of 30 um", "40 um by themselves"]);
    let limits = folder.with("limits.yaml", "finest: { squareness: 15 urad }\n");
    let path = with_errors(&folder, "EC0Y: { tolerance: 20 urad }");
    let says = |more: &[&str], words: &[&str]| {
        let arguments = [&["budget", text(&path), "--samples", "100", "--poses", "4"], more].concat();
        let (code, message) = refused(&arguments);
        assert!(code == 1 && words.iter().all(|word| message.contains(word)), "{message}");
    };
    says(&["--goal", "5 um", "--cost", text(&limits)], &["E0614", "7.", "finest"]);
    for (yaml, words) in [
        ("wieghts: {}", "wieghts"),
        ("weights: { squarness: 1 }", "no kind of error"),
        ("finest: { squareness: 1 um }", "not an angle"),
        ("finest: { EC0Y: 1 urad }\ncoarsest: { EC0Y: 0.5 urad }", "larger than the coarsest"),
        ("power: .inf", "power"),
    ] {
        let cost = folder.with("cost.yaml", yaml);
        says(&["--goal", "5 um", "--cost", text(&cost)], &["E0615", words, "docs/budget.md"]);
    }
    says(&["--goal", "5 um", "--cost", "none.yaml"], &["E0101"]);
    for usage in [&["--goal", "5 urad"][..], &["--goal", "-5 um"], &["--cost", text(&limits)], &["--loosen"]] {
        assert_eq!(refused(&[&["budget", text(&path)], usage].concat()).0, 2, "{usage:?}");
    }
}
