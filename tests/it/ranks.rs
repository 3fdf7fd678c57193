//! Ranks that know ties: `enumerate` and `compare` against machines drawn by the test.

use crate::program::{Folder, abbe, abbe_on, json, text};
use abbe::analysis::budget::{Bound, Distribution, Draws, NODES, bounds, classes};
use abbe::analysis::{Work, inverse, rest};
use abbe::lower::sensitivities_to;
use abbe::machine::{AxisName, Branch, ErrorId, Machine, Travel};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Axes and sides of a chain as it is printed.
fn sides(chain: &str) -> Vec<(AxisName, Branch)> {
    let mut side = Branch::Workpiece;
    let mut list = Vec::new();
    for word in chain.split(' ').filter(|word| !["w", "t"].contains(word) && !word.starts_with('(')) {
        match word {
            "b" => side = Branch::Tool,
            name => list.push((AxisName::new(name.trim_end_matches('\'')).unwrap(), side)),
        }
    }
    list
}

/// Fractions of the tolerances at the nodes, by error and sample.
fn drawn(machine: &Machine, bounds: &[Bound], draws: &Draws, samples: usize) -> Vec<Vec<Vec<f64>>> {
    let one = |error: &ErrorId, sample: usize| match machine.axis_index(error.axis.as_str()) {
        Some(axis) if !error.is_location() => {
            draws.curve(error, sample, machine.axes()[axis].travel == Travel::Continuous).to_vec()
        }
        _ => vec![draws.constant(error, sample); NODES],
    };
    bounds.iter().map(|bound| (0..samples).map(|sample| one(&bound.error, sample)).collect()).collect()
}

/// The largest deviation (um) of every sample over the tool poses that the machine reaches.
fn values(machine: &Machine, work: &Work, file: &Machine, bounds: &[Bound], drawn: &[Vec<Vec<f64>>]) -> Vec<f64> {
    let ids: Vec<ErrorId> = bounds.iter().map(|bound| bound.error.clone()).collect();
    let mut values = vec![0.0_f64; drawn[0].len()];
    for pose in (0..work.len()).filter_map(|i| inverse(machine, &work.get(file, i), &rest(machine)).ok()) {
        let effects = sensitivities_to(machine, &pose, &ids);
        let mut sums = vec![[0.0; 3]; values.len()];
        for ((effect, bound), drawn) in effects.iter().zip(bounds).zip(drawn) {
            let (mut node, mut share) = (0, 0.0);
            if let Some(axis) = machine.axis_index(bound.error.axis.as_str()) {
                let travel = machine.axes()[axis].travel;
                let (min, max) = travel.interval();
                let along = pose[axis] - min;
                let along = if travel == Travel::Continuous { along.rem_euclid(360.0) } else { along };
                let x = along / (max - min) * (NODES - 1) as f64;
                node = (x as usize).min(NODES - 2);
                share = x - node as f64;
            }
            let d = effect.deviation * bound.tolerance * 1e3;
            for (sum, curve) in sums.iter_mut().zip(drawn) {
                let fraction = curve[node] + share * (curve[node + 1] - curve[node]);
                (0..3).for_each(|i| sum[i] += d[i] * fraction);
            }
        }
        for (value, sum) in values.iter_mut().zip(&sums) {
            *value = value.max((sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt());
        }
    }
    values
}

fn percentile_95(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[(values.len() * 95).div_ceil(100) - 1]
}

/// The paired difference of two 95 % values, with three standard errors from ten batches.
fn difference(a: &[f64], b: &[f64]) -> (f64, f64) {
    const BATCHES: usize = 10;
    let size = a.len() / BATCHES;
    let batch = |i: usize| {
        let range = i * size..(i + 1) * size;
        percentile_95(&a[range.clone()]) - percentile_95(&b[range])
    };
    let list: Vec<f64> = (0..BATCHES).map(batch).collect();
    let mean = list.iter().sum::<f64>() / BATCHES as f64;
    let square = list.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (BATCHES - 1) as f64;
    (percentile_95(a) - percentile_95(b), 3.0 * (square / BATCHES as f64).sqrt())
}

#[test]
fn verdicts_are_those_of_machines_drawn_by_the_test() {
    const POSES: usize = 12;
    const SAMPLES: usize = 1500;
    let result = json(&[
        "enumerate",
        "hmc-4ax.yaml",
        "--class",
        "production",
        "--max-table",
        "2",
        "--buildable",
        "no",
        "--reference",
        "machine",
        "--poses",
        "12",
        "--samples",
        "200",
        "--format",
        "json",
    ]);
    let machine = crate::loaded::machine(&crate::configs::folder().join("hmc-4ax.yaml"));
    let bounds = bounds(&machine, Some(&classes()["production"]));
    // Other machines than the program's, of which only the law is the same.
    let drawn = drawn(&machine, &bounds, &Draws::new(4711, Distribution::Uniform), SAMPLES);
    let work = Work::random(&machine, POSES, 1);
    let rows = result["ranked"].as_array().unwrap();
    let truth = |row: &Value| {
        let other = machine.rearranged(&sides(row["chain"].as_str().unwrap())).unwrap();
        values(&other, &work, &machine, &bounds, &drawn)
    };
    let first = truth(&rows[0]);
    let mut counts = std::collections::BTreeMap::new();
    for row in rows {
        let own = truth(row);
        let (value, noise) = difference(&own, &first);
        let versus = &row["versus_first"];
        let verdict = versus["verdict"].as_str().unwrap();
        *counts.entry(verdict.to_owned()).or_insert(0) += 1;
        let (low, high) = (versus["minus_first"]["low"].as_f64(), versus["minus_first"]["high"].as_f64());
        let said = format!("{row}: {value} within {noise}");
        assert!(low.is_none_or(|low| low <= value + noise) && high.is_none_or(|high| value - noise <= high), "{said}");
        match verdict {
            "first" => assert_eq!(row["rank"], 1),
            "equal" => assert!(own.iter().zip(&first).all(|(a, b)| (a - b).abs() < 1e-8 * b), "{said}"),
            "worse" => assert!(value + noise > 0.0 && low.unwrap() > 0.0, "{said}"),
            _ => assert!(low.is_none_or(|low| low <= 0.0), "{said}"),
        }
    }
    println!("{counts:?} {}", result["rounds"]);
    assert!(counts.get("worse").copied().unwrap_or(0) > 0 && counts["first"] == 1, "{counts:?}");
    let rounds = &result["rounds"];
    let done = rounds["done"].as_array().unwrap();
    assert_eq!((&done[0]["samples"], &done[0]["arrangements"]), (&200.into(), &rows.len().into()));
    let counts: Vec<u64> = done.iter().map(|round| round["arrangements"].as_u64().unwrap()).collect();
    assert!(counts.windows(2).all(|two| two[1] <= two[0]) && *counts.last().unwrap() < counts[0], "{rounds}");
    assert!(number(&rounds["drawn"]) < number(&rounds["drawn_without_elimination"]));
}

#[test]
fn arrangements_that_err_alike_are_ties() {
    // An error of position along its own axis moves the tip by itself, wherever the axis stands.
    let folder = Folder::new("ranks-ties");
    let axis = |name: &str| format!("{name}: {{ travel: [-200, 200], origin: [0, 0, 0] }}");
    let yaml = format!(
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: {{ {}, {}, {} }}\n\
         errors: {{ EXX: {{ tolerance: 10 um }}, EYY: {{ tolerance: 6 um }} }}\n",
        axis("X"),
        axis("Y"),
        axis("Z")
    );
    let path = folder.with("m.yaml", &yaml);
    let arguments = ["enumerate", text(&path), "--poses", "30", "--samples", "50"];
    let result = json(&[&arguments[..], &["--format", "json"]].concat());
    let rows = result["ranked"].as_array().unwrap();
    assert_eq!(rows.len(), 24);
    assert!(rows[1..].iter().all(|row| row["versus_first"]["verdict"] == "equal"), "{result}");
    assert_eq!(
        (&result["rounds"]["told_apart"], result["rounds"]["done"].as_array().unwrap().len()),
        (&true.into(), 1)
    );
    let said = abbe(&arguments);
    assert!(said.contains("Against rank 1: 23 equal to it, 0 not told apart from it, 0 worse"), "{said}");
    let csv = abbe(&[&arguments[..], &["--format", "csv"]].concat());
    assert_eq!(csv.lines().filter(|line| line.contains(",equal,")).count(), 23, "{csv}");
}

#[test]
fn machines_side_by_side_are_told_apart_or_not() {
    let folder = Folder::new("ranks-compare");
    let machine = |name: &str, errors: &str| {
        let axis = |name: &str| format!("{name}: {{ travel: [0, 400], origin: [0, 0, 0] }}");
        let axes = [axis("X"), axis("Y"), axis("Z")].join(", ");
        let yaml =
            format!("abbe: 1\nmachine: {name}\nchain: w b X Y Z t\naxes: {{ {axes} }}\nerrors: {{ {errors} }}\n");
        folder.with(name, &yaml)
    };
    let one = machine("one.yaml", "EXX: { tolerance: 10 um }, EZZ: { tolerance: 5 um }");
    let same = machine("same.yaml", "EXX: { tolerance: 10 um }, EZZ: { tolerance: 5 um }");
    // Another error of the same size: the same in law, drawn apart.
    let alike = machine("alike.yaml", "EXX: { tolerance: 10 um }, EYY: { tolerance: 5 um }");
    let worse = machine("worse.yaml", "EXX: { tolerance: 13 um }, EYY: { tolerance: 5 um }");
    let better = machine("better.yaml", "EXX: { tolerance: 7 um }, EZZ: { tolerance: 5 um }");
    let files = [&one, &same, &worse, &better].map(|path| text(path));
    let settings = ["--poses", "30", "--samples", "200", "--format", "json"];
    let budgets = json(&[&["compare"], &files[..], &settings].concat())["budgets"].clone();
    let verdicts: Vec<&str> =
        budgets["versus_first_p95_um"].as_array().unwrap().iter().map(|v| v["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["equal", "worse", "better"], "{budgets}");
    let pair = |limit: &str| {
        let more = [&settings[..], &["--max-samples", limit]].concat();
        json(&[&["compare", text(&one), text(&alike)], &more[..]].concat())["budgets"].clone()
    };
    let (few, many) = (pair("200"), pair("1600"));
    for (budgets, samples) in [(&few, 200), (&many, 1600)] {
        let versus = &budgets["versus_first_p95_um"][0];
        assert_eq!((&versus["verdict"], &budgets["samples"]), (&"not_told_apart".into(), &samples.into()), "{versus}");
    }
    let width = |budgets: &Value| {
        let difference = &budgets["versus_first_p95_um"][0]["minus_first"];
        let (low, high) = (number(&difference["low"]), number(&difference["high"]));
        assert!(low <= 0.0 && 0.0 <= high, "{difference}");
        high - low
    };
    assert!(width(&many) < 10.0);
    let said =
        abbe_on(2, &["compare", text(&one), text(&alike), "--poses", "30", "--samples", "200", "--max-samples", "200"]);
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains("not told apart with 200 machines (`--max-samples`)"), "{said}");
}
