//! The minimum zone as reference against a solver of its own (Lawson's weights) on the rigid body of the oracle, closed
//! forms, and what it is refused for.

use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::{V3, cross, minus, norm, plus};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Conventions, Frame};
use crate::oracle::{program, yaml};
use crate::program::{Folder, abbe, json, refused, text};
use abbe::options::{MapPoses, Order, Reference};
use abbe::{LoadOptions, MapOptions, Run};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn solve(mut a: [[f64; 6]; 6], mut b: [f64; 6]) -> [f64; 6] {
    for k in 0..6 {
        let pivot = (k..6).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        let (row, value) = (a[k], b[k]);
        for i in k + 1..6 {
            let factor = if row[k] == 0.0 { 0.0 } else { a[i][k] / row[k] };
            a[i].iter_mut().zip(row).for_each(|(x, of)| *x -= factor * of);
            b[i] -= factor * value;
        }
    }
    for k in (0..6).rev() {
        let known: f64 = (k + 1..6).map(|j| a[k][j] * b[j]).sum();
        b[k] = if a[k][k] == 0.0 { 0.0 } else { (b[k] - known) / a[k][k] };
    }
    b
}

/// Lower and upper bound of the least largest |d - t - w x p|, by Lawson's iteration: least squares whose weights grow
/// with what they leave. Any weights of sum 1 bound the square from below.
fn zone(points: &[(V3, V3)]) -> [f64; 2] {
    let count = points.len() as f64;
    // From the centre, in units of the size: the system is well conditioned.
    let centre = points.iter().fold([0.0; 3], |sum, (p, _)| plus(sum, p.map(|x| x / count)));
    let size = points.iter().map(|(p, _)| norm(minus(*p, centre))).fold(0.0, f64::max);
    let points: Vec<(V3, V3)> = points.iter().map(|(p, d)| (minus(*p, centre).map(|x| x / size), *d)).collect();
    let mut weights = vec![1.0 / count; points.len()];
    let [mut lower, mut upper] = [0.0_f64, f64::INFINITY];
    for _ in 0..20_000 {
        let (mut a, mut b) = ([[0.0; 6]; 6], [0.0; 6]);
        for ((p, d), weight) in points.iter().zip(&weights) {
            let unit = |k: usize| std::array::from_fn::<f64, 3, _>(|i| f64::from(u8::from(i == k)));
            let columns: [V3; 6] = std::array::from_fn(|k| if k < 3 { unit(k) } else { cross(unit(k - 3), *p) });
            let dot = |u: &V3, v: &V3| u.iter().zip(v).map(|(x, y)| x * y).sum::<f64>();
            for i in 0..6 {
                (0..6).for_each(|k| a[i][k] += weight * dot(&columns[i], &columns[k]));
                b[i] += weight * dot(&columns[i], d);
            }
        }
        let [x, y, z, i, j, k] = solve(a, b);
        let left: Vec<f64> =
            points.iter().map(|(p, d)| norm(minus(*d, plus([x, y, z], cross([i, j, k], *p))))).collect();
        lower = lower.max(left.iter().zip(&weights).map(|(r, w)| w * r * r).sum::<f64>().sqrt());
        upper = upper.min(left.iter().copied().fold(0.0, f64::max));
        if upper - lower < 1e-6 * upper {
            break;
        }
        let total: f64 = left.iter().zip(&weights).map(|(r, w)| r * w).sum();
        weights.iter_mut().zip(&left).for_each(|(w, r)| *w *= r / total);
    }
    [lower, upper]
}

#[test]
fn it_is_the_least_largest_of_the_rigid_body() {
    let mut random = Random::new(41);
    for round in 0..6 {
        // Of a micrometre, so that squares of errors do not count.
        let sample = Sample::random(&mut random, Conventions::default(), 1e-6);
        let (folder, poses) = (program::Folder::new(), sample.poses(&mut random, 40));
        let file = folder.write("m.yaml", &yaml::write(&sample, &folder));
        let answers: Vec<_> = poses.iter().map(|pose| sample.evaluate(pose, Travel::Mean, Frame::Workpiece)).collect();
        let points: Vec<(V3, V3)> = answers.iter().map(|of| (of.nominal, of.deviation)).collect();
        let [lower, upper] = zone(&points).map(|mm| mm * 1e3);
        assert!(upper - lower < 1e-3 * upper, "the oracle: {lower} {upper}");
        let machine = abbe::load(&file, &LoadOptions::default(), Run::on_disk()).unwrap().value;
        let of = |reference: Reference, order: Option<Order>| {
            let (poses, reference) = (MapPoses::Listed(poses.clone()), Some(reference));
            let options = MapOptions { poses, reference, order, ..MapOptions::default() };
            abbe::map(&machine, &options, Run::on_disk()).unwrap().value.position_um
        };
        for order in [None, Some(Order::Degree(1))] {
            let found = of(Reference::minimum_zone(), order).max;
            let slack = 1e-5 * upper;
            assert!(found > lower - slack && found < upper + slack, "{round}: {found}, {lower} to {upper}");
        }
        let squares = of(Reference::best_fit(), None);
        assert!(squares.max > upper * 1.01 && squares.rms < of(Reference::minimum_zone(), None).rms);
    }
}

/// A three-axis machine with these lines.
fn three(folder: &Folder, name: &str, lines: &str) -> std::path::PathBuf {
    let text = format!(
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: {{ X: {{ travel: [0, 640], origin: [0, 0, 0] }}, Y: {{ travel: \
         [0, 400], origin: [0, 0, 0] }}, Z: {{ travel: [0, 400], origin: [0, 0, 0] }} }}\n{lines}\n"
    );
    folder.with(name, &text)
}

#[test]
fn a_bump_on_a_line_is_halved_in_every_verb() {
    let folder = Folder::new("zone-line");
    let machine = three(
        &folder,
        "m.yaml",
        "errors: { EXX: { points: [[0, 0 um], [200, 0 um], [300, 12 um], [400, 0 um], [640, 0 um]] } }",
    );
    let flat = three(&folder, "flat.yaml", "errors: { EXX: 5 um }");
    let work = folder.with("line.csv", "X,Y,Z\n0,0,0\n100,0,0\n200,0,0\n300,0,0\n");
    let job = folder.with("job.yaml", "tool_poses: line.csv\nreference: best-fit:minimum-zone\n");
    let max = |found: &Value| number(&found["position_um"]["max"]);
    let map = |reference: &str| {
        json(&["map", text(&machine), "--tool-poses", text(&work), "--reference", reference, "--format", "json"])
    };
    // The mean of the four is 3.
    assert!((max(&map("best-fit")) - 9.0).abs() < 1e-6 && (max(&map("best-fit:minimum-zone")) - 6.0).abs() < 1e-6);
    let over = &map("best-fit:minimum-zone")["over"];
    assert_eq!((&over["reference"], &over["minimum_zone"]), (&"best-fit".into(), &true.into()));
    assert!(map("best-fit")["over"].get("minimum_zone").is_none());
    let eval = json(&["eval", text(&machine), "--job", text(&job), "--format", "json"]);
    let x: Vec<f64> = eval["poses"].as_array().unwrap().iter().map(|of| number(&of["deviation"][0]) * 1e3).collect();
    assert!(x.iter().zip([-6.0, -6.0, -6.0, 6.0]).all(|(x, truth)| (x - truth).abs() < 1e-6), "{x:?}");
    let said = abbe(&["eval", text(&machine), "--job", text(&job)]);
    let words: Vec<&str> = said.split_whitespace().collect();
    assert!(words.join(" ").contains("minimum zone (no intervals, no parts of errors)"), "{said}");
    let compared = json(&["compare", text(&flat), text(&machine), "--job", text(&job), "--format", "json"]);
    assert!(max(&compared["machines"][0]).abs() < 1e-6 && (max(&compared["machines"][1]) - 6.0).abs() < 1e-6);
    assert_eq!(
        (&compared["verdicts"][0]["verdict"], compared["contributions"].as_array().unwrap().len()),
        (&"worse".into(), 0)
    );
    let diff = json(&["diff", text(&flat), text(&machine), "--job", text(&job), "--format", "json"]);
    assert!((number(&diff["minus_first_um"]) - 6.0).abs() < 1e-6, "{diff}");
}

#[test]
fn machines_are_drawn_with_it_and_nothing_else_is_stated() {
    let folder = Folder::new("zone-drawn");
    let machine = three(&folder, "m.yaml", "errors: { EC0Y: { tolerance: 10 urad } }");
    let mut random = Random::new(3);
    let places: Vec<V3> = (0..12).map(|_| random.vector(150.0).map(|x| x + 200.0)).collect();
    let rows = places.iter().map(|[x, y, z]| format!("{x},{y},{z}\n")).collect::<String>();
    let work = folder.with("work.csv", &format!("X,Y,Z\n{rows}"));
    let arguments = ["budget", text(&machine), "--tool-poses", text(&work), "--format", "json", "--reference"];
    let of = |reference: &str| json(&[&arguments[..], &[reference]].concat());
    let [whole, squares, found] = ["machine", "best-fit", "best-fit:minimum-zone"].map(of);
    // Every machine drawn is one shear, of which the zone keeps a part that a solver of its own finds.
    let shear: Vec<(V3, V3)> = places.iter().map(|p| (*p, [p[1], 0.0, 0.0])).collect();
    let [lower, upper] = zone(&shear);
    let largest = places.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
    assert!((number(&whole["position_um"]["rss"]) - 0.01 * largest).abs() < 1e-6, "{}", whole["position_um"]);
    let drawn = |found: &Value, name: &str| number(&found["percentiles"][name]["value"]);
    for name in ["p50", "p90", "p95", "p99"] {
        let ratio =
            drawn(&found["minimum_zone"]["position_um"], name) / drawn(&whole["position_um"]["monte_carlo"], name);
        assert!(ratio > lower / largest - 1e-5 && ratio < upper / largest + 1e-5, "{name}: {ratio} {lower} {upper}");
    }
    assert!(upper < 0.95 * largest && (upper - lower) < 1e-4 * upper, "{lower} {upper} {largest}");
    assert_eq!(found["minimum_zone"]["over"]["minimum_zone"], true);
    assert!(found["minimum_zone"]["position_um"].get("worst_case").is_none());
    // All the rest is that of the least squares, and says so.
    let rest = |of: &Value| {
        let mut of = of.clone();
        let _ = of.as_object_mut().unwrap().remove("minimum_zone");
        of
    };
    assert_eq!(rest(&found), squares);
    let said = abbe(&[&arguments[..4], &["--reference", "best-fit:minimum-zone"]].concat());
    assert!(said.contains("It has no worst case, RSS, shares"), "{said}");
    let volume = json(&[
        "budget",
        text(&machine),
        "--reference",
        "best-fit:minimum-zone",
        "--samples",
        "40",
        "--poses",
        "60",
        "--format",
        "json",
    ]);
    let both =
        [&volume["minimum_zone"]["position_um"]["p95"], &volume["position_um"]["monte_carlo"]["p95"]].map(number);
    assert!(both[0] > 0.1 * both[1] && both[0] < both[1] * (1.0 + 1e-9), "{both:?}");
}

#[test]
fn it_is_refused_where_effects_of_single_errors_are_needed() {
    let folder = Folder::new("zone-refused");
    let bounded = three(&folder, "m.yaml", "class: production");
    let work = folder.with("work.csv", "X,Y,Z\n0,0,0\n300,0,0\n0,300,0\n");
    let zone = ["--tool-poses", text(&work), "--reference", "best-fit:minimum-zone"];
    let out = folder.file("report.html");
    for (verb, what) in [
        (&["budget", text(&bounded), "--goal", "30 um"][..], "a goal"),
        (&["map", text(&bounded)], "a map of bounds"),
        (&["compare", text(&bounded), text(&bounded)], "a comparison of bounds"),
        (&["enumerate", text(&bounded)], "a ranking"),
        (&["report", text(&bounded), "--out", text(&out)], "a report"),
    ] {
        let (code, said) = refused(&[verb, &zone[..]].concat());
        assert!(code == 1 && said.contains("E0850") && said.contains(&format!("not for {what}")), "{said}");
    }
    // With measured errors budgets alone are withheld, with a warning.
    let valued = three(&folder, "v.yaml", "class: production\nerrors: { EXX: { points: [[0, 0 um], [640, 12 um]] } }");
    let (code, said) = refused(&[&["compare", text(&valued), text(&valued)][..], &zone[..]].concat());
    assert!(code == 0 && said.contains("W0607") && said.contains("a minimum zone has no worst case"), "{said}");
}
