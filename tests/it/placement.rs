//! Places of a part: reach, rewinds and deviations at every place against own arithmetic of a machine with three linear
//! axes and of one with a tilting rotary table.

use crate::program::{Folder, abbe, abbe_on, json, refused, text, well_formed};
use serde_json::Value;
use std::path::{Path, PathBuf};

type V3 = [f64; 3];

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn numbers(value: &Value) -> V3 {
    std::array::from_fn(|k| number(&value[k]))
}

fn plus(a: V3, b: V3) -> V3 {
    std::array::from_fn(|k| a[k] + b[k])
}

fn minus(a: V3, b: V3) -> V3 {
    std::array::from_fn(|k| a[k] - b[k])
}

fn norm(a: V3) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The vector turned about X, Y or Z (0, 1, 2).
fn turned(v: V3, about: usize, deg: f64) -> V3 {
    let (sine, cosine) = deg.to_radians().sin_cos();
    let (i, j) = ((about + 1) % 3, (about + 2) % 3);
    let mut out = v;
    (out[i], out[j]) = (cosine * v[i] - sine * v[j], sine * v[i] + cosine * v[j]);
    out
}

/// A place as the results state it.
struct Place {
    origin: V3,
    rotation: V3,
}

impl Place {
    fn of(tried: &Value) -> Self {
        Self { origin: numbers(&tried["place"]["origin"]), rotation: numbers(&tried["place"]["rotation"]) }
    }

    fn direction(&self, v: V3) -> V3 {
        (0..3).fold(v, |v, about| turned(v, about, self.rotation[about]))
    }

    fn point(&self, p: V3) -> V3 {
        plus(self.origin, self.direction(p))
    }
}

/// The ceil(0.95 n)-th smallest, and the largest.
fn p95_and_max(mut lengths: Vec<f64>) -> [f64; 2] {
    lengths.sort_by(f64::total_cmp);
    [lengths[(lengths.len() * 95).div_ceil(100) - 1], lengths[lengths.len() - 1]]
}

fn close(found: &Value, truth: f64, within: f64, what: &str) {
    assert!((number(found) - truth).abs() < within, "{what}: {found} {truth}");
}

/// Checks that ranks run from 1 over the places that reach the same and the most, by rewinds and then by the figure, and
/// that the best place is the first of them.
fn check_ranks(found: &Value, missed: &[Vec<usize>]) {
    let tried = found["tried"].as_array().unwrap();
    let mut ranked: Vec<(usize, usize)> = Vec::new();
    for (index, of) in tried.iter().enumerate() {
        ranked.extend(of["rank"].as_u64().map(|rank| (usize::try_from(rank).unwrap(), index)));
    }
    ranked.sort_unstable();
    assert!(ranked.iter().enumerate().all(|(k, (rank, _))| *rank == k + 1), "{ranked:?}");
    assert_eq!(found["ranked"], ranked.len());
    let best = ranked[0].1;
    assert_eq!(found["best"], tried[best]);
    let fewest = missed.iter().map(Vec::len).min().unwrap();
    for (index, missed_here) in missed.iter().enumerate() {
        let is_ranked = ranked.iter().any(|(_, of)| *of == index);
        assert_eq!(is_ranked, missed_here.len() == fewest && *missed_here == missed[best], "{index}");
    }
    let key = |index: usize| (tried[index]["rewinds"].as_u64().unwrap_or(0), tried[index]["um"].as_f64());
    for pair in ranked.windows(2) {
        let [(a, p), (b, q)] = [key(pair[0].1), key(pair[1].1)];
        assert!(a < b || a == b && p.unwrap_or(0.0) <= q.unwrap_or(0.0) + 2e-4, "{pair:?}");
    }
}

/// A machine of three linear axes of 600 mm whose scales are bent: no error below 0, 0.2 um/mm in X and 0.1 um/mm in Y
/// above it.
fn three(folder: &Folder, errors: &str) -> PathBuf {
    let axis = |name: &str| format!("  {name}: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(axis).concat();
    folder.with("three.yaml", &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}{errors}\n"))
}

const BENT: &str = "errors:\n  EXX: { points: [[-300 mm, 0 um], [0 mm, 0 um], [300 mm, 60 um]] }\n  \
                    EYY: { points: [[-300 mm, 0 um], [0 mm, 0 um], [300 mm, 30 um]] }\n";

fn bent(p: V3) -> V3 {
    [0.2 * p[0].max(0.0), 0.1 * p[1].max(0.0), 0.0]
}

/// A plate of 7 times 5 points.
fn plate() -> Vec<V3> {
    (0..35).map(|i| [f64::from(i % 7) * 41.3 - 93.7, f64::from(i / 7) * 27.1 - 31.9, f64::from(i % 3) * 10.0]).collect()
}

fn table(folder: &Folder, name: &str, points: &[V3]) -> PathBuf {
    let row = |p: &V3| format!("{},{},{}\n", p[0], p[1], p[2]);
    folder.with(name, &format!("X,Y,Z\n{}", points.iter().map(row).collect::<String>()))
}

#[test]
fn a_plate_is_tried_on_three_linear_axes() {
    let folder = Folder::new("placement-three");
    let machine = three(&folder, BENT);
    let _ = table(&folder, "plate.csv", &plate());
    let job = folder.with("job.yaml", "tool_poses: plate.csv\nplace: { origin: [35, 15, 5], rotation: [0, 0, 10] }\n");
    let ranges = "X=-250..250:11,Y=-240..240:7,C=0..150:6";
    let arguments = [text(&machine), "--job", text(&job), "--place", ranges, "--format", "json"];
    let found = json(&[&["map"], &arguments[..]].concat());
    let reach = json(&[&["reach"], &arguments[..]].concat());
    let tried = found["tried"].as_array().unwrap();
    assert_eq!(tried.len(), 11 * 7 * 6 + 1);
    let mut all_missed = Vec::new();
    for (k, of) in tried.iter().enumerate() {
        let place = Place::of(of);
        if k < 11 * 7 * 6 {
            let expected = [-250.0 + 50.0 * (k % 11) as f64, -240.0 + 80.0 * (k / 11 % 7) as f64, 5.0];
            assert!(
                norm(minus(place.origin, expected)) < 1e-9 && (place.rotation[2] - 30.0 * (k / 77) as f64).abs() < 1e-9
            );
        }
        let inside = |p: &V3| p.iter().all(|x| x.abs() <= 300.0);
        let at: Vec<V3> = plate().into_iter().map(|p| place.point(p)).collect();
        let missed: Vec<usize> = (0..at.len()).filter(|i| !inside(&at[*i])).collect();
        assert_eq!(of["reached"], at.len() - missed.len(), "{k}");
        let zero = bent(place.origin);
        let held = || at.iter().filter(|p| inside(p));
        let lengths: Vec<f64> = held().map(|p| norm(minus(bent(*p), zero))).collect();
        let [p95, max] = p95_and_max(lengths);
        close(&of["p95_um"], p95, 1e-9, "95 %");
        close(&of["max_um"], max, 1e-9, "largest");
        close(&of["um"], max, 1e-9, "figure");
        assert!(of.get("versus_first").is_none() && of.get("limit").is_none());
        let margin = held().flatten().map(|x| 300.0 - x.abs()).fold(f64::INFINITY, f64::min);
        close(&of["margin_mm"], margin, 1e-9, "margin");
        let of_reach = &reach["tried"][k];
        assert_eq!(
            (&of["place"], &of["reached"], &of["share"]),
            (&of_reach["place"], &of_reach["reached"], &of_reach["share"])
        );
        assert!(of_reach.get("p95_um").is_none());
        all_missed.push(missed);
    }
    check_ranks(&found, &all_missed);
    check_ranks(&reach, &all_missed);
    // By reach alone the place with the most room is the best.
    let room = |of: &Value| if of["rank"].is_null() { f64::NEG_INFINITY } else { number(&of["margin_mm"]) };
    let widest = reach["tried"].as_array().unwrap().iter().map(room).fold(f64::NEG_INFINITY, f64::max);
    close(&reach["best"]["margin_mm"], widest, 1e-6, "room");
    // Where the scales are without error the part is without error.
    assert!(number(&found["best"]["p95_um"]) < 1e-9 && number(&found["own"]["p95_um"]) > 10.0, "{}", found["own"]);
    assert_eq!(found["over"]["reference"], "zero");
    let gain = &found["gain"];
    close(&gain["common"]["p95_um"], number(&found["own"]["p95_um"]), 1e-9, "gain");
    assert_eq!((&gain["common"]["poses"], &gain["poses"]), (&35.into(), &0.into()));
}

#[test]
fn figures_are_those_of_the_map_of_the_job_there() {
    let folder = Folder::new("placement-map");
    let machine = three(&folder, BENT);
    let _ = table(&folder, "plate.csv", &plate());
    let job = folder.with("job.yaml", "tool_poses: plate.csv\nplace: { origin: [35, 15, 5] }\n");
    for reference in ["zero", "zero:10,20,0", "best-fit", "machine"] {
        let arguments =
            ["map", text(&machine), "--job", text(&job), "--reference", reference, "--place", "X=-80..90:3,C=0..60:3"];
        let found = json(&[&arguments[..], &["--format", "json"]].concat());
        let said = abbe(&arguments);
        let line = said.lines().find(|line| line.trim_start().starts_with("place: ")).unwrap().trim();
        for (place, of) in [("place: { origin: [35, 15, 5] }", &found["own"]), (line, &found["best"])] {
            let there = folder.with("there.yaml", &format!("tool_poses: plate.csv\n{place}\n"));
            let map =
                json(&["map", text(&machine), "--job", text(&there), "--reference", reference, "--format", "json"]);
            assert_eq!(
                (&map["position_um"]["p95"], &map["position_um"]["max"]),
                (&of["p95_um"], &of["max_um"]),
                "{reference}"
            );
            assert_eq!(map["over"], found["over"]);
        }
    }
}

/// A rotary table on a tilting one: C may turn by 380 deg, A tilts to one side.
fn tilting(folder: &Folder) -> PathBuf {
    let linear = |name: &str| format!("  {name}: {{ travel: [-170, 190], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(linear).concat();
    let rotary = "  A: { travel: [0, 110], origin: [0, 0, 0] }\n  C: { travel: [-190, 190], origin: [0, 0, 0] }\n";
    let errors = "errors:\n  EXX: { points: [[-170 mm, -85 um], [190 mm, 95 um]] }\n  EC0Y: 200 urad\n";
    folder.with(
        "tilting.yaml",
        &format!("abbe: 1\nmachine: T\nchain: \"w C' A' b X Y Z t\"\naxes:\n{axes}{rotary}{errors}"),
    )
}

/// The positions X, Y, Z, A, C for a tip and a direction that is not the vertical, and whether they are in reach.
fn tilted(tip: V3, direction: V3) -> ([f64; 5], bool) {
    let a = direction[2].acos().to_degrees();
    let c = direction[0].atan2(-direction[1]).to_degrees();
    let [x, y, z] = turned(turned(tip, 2, -c), 0, -a);
    let inside = (0.0..=110.0).contains(&a) && [x, y, z].iter().all(|q| (-170.0..=190.0).contains(q));
    ([x, y, z, a, c], inside)
}

/// The deviation on the part at a pose, um: 0.5 um/mm along X, and -200 urad of Y.
fn tilted_deviation([x, y, _, a, c]: [f64; 5]) -> V3 {
    turned(turned([0.5 * x - 0.2 * y, 0.0, 0.0], 0, a), 2, c)
}

/// Five sides of a block, each with its tool direction.
fn block() -> Vec<(V3, V3)> {
    let sides = [(0.0, 35.0), (72.0, 81.0), (141.0, 90.0), (219.0, 64.0), (288.0, 17.0)];
    let row = |(k, (azimuth, tilt)): (usize, (f64, f64))| {
        let direction = turned(turned([0.0, 0.0, 1.0], 0, tilt), 2, azimuth);
        (0..7).map(move |i| {
            let along = f64::from(i) * 13.7 - 41.0;
            (turned([along, -62.0 - 3.0 * k as f64, 21.3 + f64::from(i % 2) * 9.1], 2, azimuth), direction)
        })
    };
    sides.into_iter().enumerate().flat_map(row).collect()
}

fn directed(folder: &Folder, name: &str, rows: &[(V3, V3)]) -> PathBuf {
    let row = |(p, d): &(V3, V3)| format!("{},{},{},{},{},{}\n", p[0], p[1], p[2], d[0], d[1], d[2]);
    folder.with(name, &format!("X,Y,Z,I,J,K\n{}", rows.iter().map(row).collect::<String>()))
}

#[test]
fn a_block_is_tried_on_a_tilting_table() {
    let folder = Folder::new("placement-tilting");
    let machine = tilting(&folder);
    let _ = directed(&folder, "block.csv", &block());
    let job = folder.with("job.yaml", "tool_poses: block.csv\nplace: { origin: [133, 97, 3] }\n");
    let ranges = "X=-91..95:8,Y=-83..77:7,C=0..300:6";
    let found = json(&["map", text(&machine), "--job", text(&job), "--place", ranges, "--format", "json"]);
    let mut all_missed = Vec::new();
    let mut own = None;
    for of in found["tried"].as_array().unwrap() {
        let place = Place::of(of);
        let at: Vec<([f64; 5], bool)> =
            block().into_iter().map(|(p, d)| tilted(place.point(p), place.direction(d))).collect();
        let missed: Vec<usize> = (0..at.len()).filter(|i| !at[*i].1).collect();
        assert_eq!(of["reached"], at.len() - missed.len(), "{of}");
        // The zero is probed at the part's origin along its +Z: the vertical, with C at zero.
        let [x, y, z] = place.origin;
        let zero = tilted_deviation([x, y, z, 0.0, 0.0]);
        let lengths: Vec<f64> =
            at.iter().filter(|of| of.1).map(|of| norm(minus(tilted_deviation(of.0), zero))).collect();
        let [p95, max] = p95_and_max(lengths);
        // The squareness turns by an angle whose cosine is 2e-8 from one.
        close(&of["p95_um"], p95, 1e-2, "95 %");
        close(&of["max_um"], max, 1e-2, "largest");
        if of["own"] == true {
            own = Some((at, zero));
        }
        all_missed.push(missed);
    }
    check_ranks(&found, &all_missed);
    let counts: std::collections::BTreeSet<usize> = all_missed.iter().map(Vec::len).collect();
    assert!(counts.len() > 3 && counts.contains(&0), "{counts:?}");
    // The place of the job misses some: both are compared on what both reach.
    let (own, own_zero) = own.unwrap();
    let best = Place::of(&found["best"]);
    let [x, y, z] = best.origin;
    let best_zero = tilted_deviation([x, y, z, 0.0, 0.0]);
    let both: Vec<(usize, [f64; 5])> = (0..own.len())
        .map(|i| (i, tilted(best.point(block()[i].0), best.direction(block()[i].1))))
        .filter(|(i, of)| own[*i].1 && of.1)
        .map(|(i, of)| (i, of.0))
        .collect();
    let common = &found["gain"]["common"];
    assert_eq!(common["poses"], both.len());
    assert!(
        both.len() < 35 && found["gain"]["poses"] == 35 - number(&found["own"]["reached"]) as i64,
        "{}",
        found["gain"]
    );
    let at_own = both.iter().map(|(i, _)| norm(minus(tilted_deviation(own[*i].0), own_zero))).collect();
    let at_best = both.iter().map(|(_, pose)| norm(minus(tilted_deviation(*pose), best_zero))).collect();
    let ([own, _], [best, _]) = (p95_and_max(at_own), p95_and_max(at_best));
    close(&common["own_p95_um"], own, 1e-2, "own");
    close(&common["best_p95_um"], best, 1e-2, "best");
    close(&common["p95_um"], own - best, 2e-2, "gain");
}

#[test]
fn a_path_is_placed_where_it_has_no_rewind() {
    let folder = Folder::new("placement-path");
    let machine = tilting(&folder);
    // C turns by 300 deg along the path, of 380 that it has.
    let rows: Vec<(V3, V3)> = (0..21)
        .map(|k| {
            let azimuth = 15.0 * f64::from(k);
            (turned([0.0, -40.0, 10.0], 2, azimuth), turned(turned([0.0, 0.0, 1.0], 0, 30.0), 2, azimuth))
        })
        .collect();
    let _ = directed(&folder, "path.csv", &rows);
    let job = folder.with("job.yaml", "tool_poses: path.csv\npath: true\n");
    let arguments = ["map", text(&machine), "--job", text(&job), "--place", "C=5..350:24,X=0..20:2"];
    let found = json(&[&arguments[..], &["--format", "json"]].concat());
    let mut seen = [0, 0];
    for of in found["tried"].as_array().unwrap() {
        let start = Place::of(of).rotation[2];
        let fits = (-2..=1).map(f64::from).any(|k| {
            let from = start + 360.0 * k;
            from >= -190.0 && from + 300.0 <= 190.0
        });
        assert_eq!((&of["rewinds"], &of["reached"]), (&usize::from(!fits).into(), &21.into()), "{of}");
        seen[usize::from(fits)] += 1;
    }
    assert!(seen[0] > 5 && seen[1] > 5, "{seen:?}");
    check_ranks(&found, &vec![Vec::new(); found["tried"].as_array().unwrap().len()]);
    assert_eq!((&found["best"]["rewinds"], &found["own"]["rewinds"]), (&0.into(), &1.into()));
    assert_eq!((&found["gain"]["rewinds"], &found["over"]["path"]), (&1.into(), &true.into()));
    let said = abbe(&arguments);
    assert!(said.contains("1 rewind fewer") && said.contains("rewinds |"), "{said}");
}

#[test]
fn bounds_scale_with_the_extent_of_the_part() {
    let folder = Folder::new("placement-bounds");
    let machine = three(&folder, "errors: { EC0Y: { tolerance: 100 urad } }");
    let points = plate();
    let tools = table(&folder, "plate.csv", &points);
    let arguments =
        ["map", text(&machine), "--tool-poses", text(&tools), "--place", "C=0..150:6,X=0..40:2", "--samples", "400"];
    let found = json(&[&arguments[..], &["--format", "json"]].concat());
    assert_eq!((&found["from"], &found["drawing"]["samples"]), (&"bounds".into(), &400.into()));
    // A drawn squareness s moves a tip by s y, the zero by nothing: all figures hang on one quantile of s.
    let across = |of: &Value| {
        let place = Place::of(of);
        p95_and_max(points.iter().map(|p| (place.point(*p)[1] - place.origin[1]).abs()).collect())
    };
    let tried = found["tried"].as_array().unwrap();
    let quantile = number(&tried[0]["p95_um"]) / across(&tried[0])[0];
    assert!(quantile > 0.08 && quantile < 0.1, "{quantile}");
    for of in tried {
        let [p95, max] = across(of);
        close(&of["p95_um"], quantile * p95, 1e-9, "95 %");
        close(&of["max_um"], quantile * max, 1e-9, "largest");
        // The same machines at every place: a difference is one of extents, and as certain.
        close(&of["um"], quantile * max, 1e-9, "figure");
        let (versus, first) = (&of["versus_first"], across(&found["best"])[1]);
        close(&versus["minus_first"]["value"], quantile * (max - first), 1e-9, "against the first");
        let verdict = match max - first {
            _ if of["rank"] == 1 => "first",
            apart if apart < 1e-9 => "equal",
            _ => "worse",
        };
        assert_eq!(versus["verdict"], verdict, "{of}");
    }
    let is_equal = |of: &&Value| of["versus_first"]["verdict"] == "equal";
    assert_eq!(found["not_told_apart"], tried.iter().filter(is_equal).count());
    check_ranks(&found, &vec![Vec::new(); tried.len()]);
    let (code, said) = refused(&[&arguments[..], &["--order", "2"]].concat());
    assert!(code == 2 && said.contains("first order"), "{said}");
}

/// A rod of 100 mm along Y; turned about Z by 90 deg it lies along X.
fn rod(folder: &Folder) {
    let points: Vec<V3> = (0..11).map(|i| [0.0, 10.0 * f64::from(i), 0.0]).collect();
    let _ = table(folder, "rod.csv", &points);
}

#[test]
fn places_that_differ_by_chance_are_not_told_apart() {
    let folder = Folder::new("placement-chance");
    rod(&folder);
    let job = folder.with("job.yaml", "tool_poses: rod.csv\nlimit: 9 um\n");
    let picture = folder.file("p.svg");
    // Along Y the turn of Y moves the end by 100 mm of it, along X that of X: alike in law, and independent.
    let of = |turn_of_x: &str, seed: &str| {
        let errors = format!("errors: {{ EC0Y: {{ tolerance: 100 urad }}, EC0X: {{ tolerance: {turn_of_x} }} }}");
        let machine = three(&folder, &errors);
        let arguments = ["map", text(&machine), "--job", text(&job), "--place", "C=0..90:2", "--seed", seed];
        let found = json(&[&arguments[..], &["--format", "json", "--svg", text(&picture)]].concat());
        let map = json(&["map", text(&machine), "--job", text(&job), "--seed", seed, "--format", "json"]);
        // At the place of the job figure and verdict on the limit are those of the map.
        assert_eq!((&found["own"]["limit"], &found["own"]["um"]), (&map["limit"], &map["limit"]["um"]));
        (found, abbe(&arguments), abbe(&[&arguments[..], &["--format", "csv"]].concat()))
    };
    let mut firsts = std::collections::BTreeSet::new();
    for seed in ["1", "2", "3", "4", "5", "6"] {
        let (found, said, csv) = of("100 urad", seed);
        let tried = found["tried"].as_array().unwrap();
        let second = tried.iter().find(|of| of["rank"] == 2).unwrap();
        let versus = &second["versus_first"];
        assert_eq!((&versus["verdict"], &found["not_told_apart"]), (&"not_told_apart".into(), &1.into()), "{found}");
        let minus = &versus["minus_first"];
        // The truth is 0.
        assert!(number(&minus["low"]) <= 0.0 && number(&minus["high"]) >= 0.0 && number(&minus["value"]) >= 0.0);
        let _ = firsts.insert(numbers(&found["best"]["place"]["rotation"])[2] as i64);
        assert!(said.contains("Not told apart from the first by the machines drawn: 1 of 1"), "{said}");
        assert!(said.contains("Job, file's own: limit 9 um: exceeded"), "{said}");
        assert!(csv.lines().any(|line| line.contains(",not told apart,")), "{csv}");
        let svg = std::fs::read_to_string(&picture).unwrap();
        assert!(svg.contains("Dots: places that the machines drawn do not tell apart from the best."));
    }
    assert_eq!(firsts.len(), 2, "chance decides which is the first");
    // Three times the bound: 95 % of uniform squarenesses are within 95 urad and 285 urad, times 100 mm.
    let (found, said, _) = of("300 urad", "1");
    let along_x = found["tried"].as_array().unwrap().iter().find(|of| of["rank"] == 2).unwrap();
    let minus = &along_x["versus_first"]["minus_first"];
    assert_eq!((&along_x["versus_first"]["verdict"], &found["not_told_apart"]), (&"worse".into(), &0.into()));
    assert!(number(&minus["low"]) <= 19.0 && number(&minus["high"]) >= 19.0 && number(&minus["low"]) > 10.0, "{minus}");
    let [low, high] = [0, 1].map(|k| number(&along_x["interval_um"][k]));
    assert!(low <= 28.5 && high >= 28.5, "{low} {high}");
    assert!(said.contains("0 of 1; the others are"), "{said}");
    assert!(!std::fs::read_to_string(&picture).unwrap().contains("Dots:"));
}

#[test]
fn values_and_bounds_act_together_at_every_place() {
    let folder = Folder::new("placement-both");
    rod(&folder);
    let job = folder.with("job.yaml", "tool_poses: rod.csv\nplace: { origin: [0, 50, 0] }\nlimit: 14 um\n");
    let machine = three(&folder, &BENT.replace("errors:\n", "errors:\n  EC0Y: { tolerance: 100 urad }\n"));
    let arguments = ["map", text(&machine), "--job", text(&job)];
    let found = json(&[&arguments[..], &["--place", "Y=-150..50:3", "--format", "json"]].concat());
    for of in found["tried"].as_array().unwrap() {
        let y = Place::of(of).origin[1];
        // Of 2001 squarenesses in equal steps: 0.1 um/mm along Y above 0, and s times the length across.
        let largest = |k: i32| {
            let s = 0.1 * (f64::from(k) + 0.5) / 2001.0;
            let at = |l: f64| norm([s * l, 0.1 * ((y + l).max(0.0) - y.max(0.0)), 0.0]);
            (0..11).map(|i| at(10.0 * f64::from(i))).fold(0.0, f64::max)
        };
        let [truth, _] = p95_and_max((0..2001).map(largest).collect());
        let [low, high] = [0, 1].map(|k| number(&of["interval_um"][k]));
        assert!(low <= truth && truth <= high && (number(&of["um"]) - truth).abs() < 0.5, "{of} {truth}");
    }
    let mut map = json(&[&arguments[..], &["--format", "json"]].concat());
    // What the missing errors could do is not asked place by place.
    assert!(map["limit"]["missing"].as_object_mut().unwrap().remove("um").is_some());
    assert_eq!((&found["own"]["limit"], &found["from"]), (&map["limit"], &"values".into()));
}

#[test]
fn the_reference_moves_with_the_part_and_counts() {
    let folder = Folder::new("placement-reference");
    let machine = three(&folder, BENT);
    let _ = table(&folder, "row.csv", &[[0.0, 0.0, 0.0], [-50.0, 0.0, 0.0], [-100.0, 0.0, 0.0]]);
    // The point of the zero is 150 mm beside the part: out of reach where X is above 150.
    let far = folder.with("far.yaml", "tool_poses: row.csv\nreference: zero:150,0,0\n");
    let ranges = ["--place", "X=-150..250:5", "--format", "json"];
    for verb in ["map", "reach"] {
        let found = json(&[&[verb, text(&machine), "--job", text(&far)], &ranges[..]].concat());
        for of in found["tried"].as_array().unwrap() {
            let x = Place::of(of).origin[0];
            let holds = x <= 150.0;
            assert_eq!((&of["reaches_reference"], of["rank"].is_null()), (&holds.into(), !holds), "{of}");
            let span = 0.2 * (((x + 150.0).max(0.0) - (x - 100.0).max(0.0)).max(0.0));
            if holds && verb == "map" {
                close(&of["max_um"], span, 1e-9, "largest");
            }
        }
        assert_eq!(found["reach_all"], 6);
    }
    // From no place: a stated reference is refused, the default gives way with a warning.
    let never = folder.with("never.yaml", "tool_poses: row.csv\nreference: zero:900,0,0\n");
    let (code, said) = refused(&[&["map", text(&machine), "--job", text(&never)], &ranges[..]].concat());
    assert!(code == 1 && said.contains("E0850"), "{said}");
    let (code, said) = refused(&[&["reach", text(&machine), "--job", text(&never)], &ranges[..]].concat());
    assert!(code == 0 && said.contains("W0850"), "{said}");
    let high = table(&folder, "high.csv", &[[0.0, 0.0, 450.0], [30.0, 0.0, 450.0]]);
    let arguments = ["map", text(&machine), "--tool-poses", text(&high), "--place", "X=-50..50:3,Z=-310"];
    let output = abbe_on(2, &[&arguments[..], &["--format", "json"]].concat());
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("W0850"), "{said}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&found["over"]["reference"], &found["ranked"]), (&"machine".into(), &3.into()));
    close(&found["tried"][2]["max_um"], 0.2 * 80.0, 1e-9, "machine coordinates");
    // Nothing in reach is an answer of `reach`, and no map.
    let none = ["--tool-poses", text(&high), "--place", "Z=200..300:3"];
    let found = json(&[&["reach", text(&machine)], &none[..], &["--format", "json"]].concat());
    assert!(found.get("best").is_none() && found["ranked"] == 0 && found["reach_all"] == 0, "{found}");
    assert!(abbe(&[&["reach", text(&machine)], &none[..]].concat()).contains("None of them reaches a tool pose."));
    let (code, said) = refused(&[&["map", text(&machine)], &none[..]].concat());
    assert!(code == 1 && said.contains("E0613"), "{said}");
}

/// Arguments of a run, and the files beside it.
fn forms(folder: &Folder, threads: usize, arguments: &[&str]) -> Vec<Vec<u8>> {
    let picture = folder.file(&format!("{threads}.svg"));
    let mut all = Vec::new();
    for format in ["text", "json", "csv"] {
        let output = abbe_on(threads, &[arguments, &["--format", format, "--svg", text(&picture)]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        all.push(output.stdout);
    }
    all.push(std::fs::read(&picture).unwrap());
    all
}

#[test]
fn threads_do_not_change_a_byte_and_lines_fit_a_terminal() {
    let folder = Folder::new("placement-threads");
    let machine = tilting(&folder);
    let _ = directed(&folder, "block.csv", &block());
    let job = folder.with("job.yaml", "tool_poses: block.csv\npath: true\nplace: { origin: [70, 52, 3] }\n");
    let every = "X=-91.5..95.25:3,Y=-83..77:3,Z=-3..4:2,A=-12.5..10:2,B=0..7.125:2,C=0..300:2";
    for (verb, ranges) in [("map", "X=-91..95:4,Y=-83..77:4,C=0..300:3"), ("reach", "C=0..300:4"), ("map", every)] {
        let arguments = [verb, text(&machine), "--job", text(&job), "--place", ranges];
        let first = forms(&folder, 1, &arguments);
        assert_eq!(first, forms(&folder, 3, &arguments), "{verb}");
        let said = String::from_utf8(first[0].clone()).unwrap();
        let longest = said.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(longest <= 80, "{longest}: {said}");
        let found: Value = serde_json::from_slice(&first[1]).unwrap();
        let csv = String::from_utf8(first[2].clone()).unwrap();
        let head = "X [mm],Y [mm],Z [mm],A [deg],B [deg],C [deg],own,reached,share,rewinds,margin [mm],reference,p95 [um],max [um],rank";
        let figure =
            ",um,low [um],high [um],minus first [um],minus first low [um],minus first high [um],versus first,limit";
        let (head, columns) = if verb == "map" { (head.to_owned() + figure, 23) } else { (head.to_owned(), 15) };
        assert_eq!(csv.lines().next(), Some(head.as_str()));
        assert_eq!(csv.lines().count() - 1, found["tried"].as_array().unwrap().len());
        assert!(csv.lines().all(|line| line.split(',').count() == columns));
        let svg = String::from_utf8(first[3].clone()).unwrap();
        assert_eq!(well_formed(&svg), Ok(()));
        assert!(svg.contains("Ring: the best place") && svg.contains("<circle"), "{verb}");
        assert_eq!(svg.contains("Each cell is the best place over"), ranges.matches("..").count() > 2);
    }
}

#[test]
fn pictures_are_of_places_or_of_a_box() {
    let folder = Folder::new("placement-picture");
    let machine = three(&folder, BENT);
    let tools = table(&folder, "plate.csv", &plate());
    let picture = folder.file("p.svg");
    let drawn = |verb: &str| {
        let arguments = [verb, text(&machine), "--tool-poses", text(&tools), "--place", "X=-250..250:6,Y=-240..240:4"];
        let found = json(&[&arguments[..], &["--format", "json", "--svg", text(&picture)]].concat());
        let svg = std::fs::read_to_string(&picture).unwrap();
        (found, svg)
    };
    let (found, svg) = drawn("map");
    // A cell that cannot be compared is grey.
    let grey = found["tried"].as_array().unwrap()[..24].iter().filter(|of| of["rank"].is_null()).count();
    assert!(grey > 3, "{found}");
    assert_eq!(svg.matches("fill=\"#cfd3d7\"").count(), grey);
    let (found, svg) = drawn("reach");
    assert!(!svg.contains("#cfd3d7") && svg.contains("share of the tool poses in reach"));
    // Cells that reach all have an outline where a neighbour does not: 6 by 4 cells, the first range running fastest.
    let whole: Vec<bool> = found["tried"].as_array().unwrap()[..24].iter().map(|of| of["share"] == 1.0).collect();
    let at = |i: i64, j: i64| (0..6).contains(&i) && (0..4).contains(&j) && whole[usize::try_from(j * 6 + i).unwrap()];
    let cells = (0..24).map(|k| (k % 6, k / 6)).filter(|(i, j)| at(*i, *j));
    let sides = cells.flat_map(|(i, j)| [at(i - 1, j), at(i + 1, j), at(i, j - 1), at(i, j + 1)]);
    let edges = sides.filter(|inside| !inside).count();
    assert!(edges > 4 && whole.contains(&false), "{whole:?}");
    assert_eq!(svg.matches("stroke-linecap=\"square\"").count(), 2 * edges, "a line with its halo");
    assert!(svg.contains("outlined: all tool poses are reached") && svg.contains("all tool poses reached"));
    let none = json(&[
        "reach",
        text(&machine),
        "--tool-poses",
        text(&tools),
        "--place",
        "X=250..299:3",
        "--format",
        "json",
        "--svg",
        text(&picture),
    ]);
    let svg = std::fs::read_to_string(&picture).unwrap();
    assert!(none["tried"].as_array().unwrap()[..3].iter().all(|of| of["share"] != 1.0), "{none}");
    assert_eq!(svg.contains("no place reaches all tool poses"), none["reach_all"] == 0, "{none}");
    let (code, said) = refused(&["reach", text(&machine), "--tool-poses", text(&tools), "--svg", text(&picture)]);
    assert!(code == 2 && said.contains("add `--place`"), "{said}");
    let one =
        abbe(&["reach", text(&machine), "--tool-poses", text(&tools), "--place", "X=10", "--svg", text(&picture)]);
    assert!(one.contains("1 places and the file's own: X 10 mm") && picture.exists(), "{one}");
}

#[test]
fn ranges_that_make_no_sense_are_refused() {
    let folder = Folder::new("placement-hostile");
    let machine = three(&folder, BENT);
    let tools = table(&folder, "plate.csv", &plate());
    let with = |ranges: &str| {
        let place = format!("--place={ranges}");
        refused(&["reach", text(&machine), "--tool-poses", text(&tools), &place])
    };
    for ranges in [
        "",
        "X",
        "X=",
        "=1",
        "Q=0..1",
        "X=nan..1",
        "X=0..inf",
        "X=0..1e7",
        "X=5..1:3",
        "X=1..1:3",
        "X=0..1:1",
        "X=0..1:0",
        "X=0..1:-4",
        "X=0..1:1001",
        "X=0..1:99999999999999999999999",
        "X=0..1:2.5",
        "X=0..1..2",
        "X=..",
        "X=0..5 deg",
        "C=0..5 mm",
        "A=0..400",
        "X=0..1,X=2",
        "X=0..1,,Y=1",
        "X=1,5..2",
        "C=0..\u{1b}[31m",
    ] {
        let (code, said) = with(ranges);
        let why = said.contains("is no range of places") || said.contains("is given twice");
        assert!(code == 2 && why && !said.contains('\u{1b}'), "{ranges}: {code} {said}");
    }
    for ranges in [
        "X=0..1:1000,Y=0..1:1000",
        "X=0..1:1000,Y=0..1:1000,Z=0..1:1000,A=0..1:1000,B=0..1:1000,C=0..1:1000,",
        "X=0..1:101,Y=0..1:100",
    ] {
        let (code, said) = with(ranges.trim_end_matches(','));
        assert!(code == 1 && said.contains("E0812") && said.contains("--place"), "{ranges}: {code} {said}");
    }
    let many: Vec<V3> = (0..300).map(|i| [f64::from(i) * 0.1, 0.0, 0.0]).collect();
    let many = table(&folder, "many.csv", &many);
    let (code, said) =
        refused(&["reach", text(&machine), "--tool-poses", text(&many), "--place", "X=0..1:100,Y=0..1:70"]);
    assert!(code == 1 && said.contains("E0812") && said.contains("2000000 tool poses"), "{said}");
    let (code, said) = with("x = -1 cm .. 10 mm : 2, c=0..0.5 rad:2");
    assert_eq!(code, 0, "{said}");
    // Without a job there is nothing to place.
    for more in [&[][..], &["--job", "none"]] {
        let (code, said) = refused(&[&["map", text(&machine), "--place", "X=0..1:2"], more].concat());
        assert!(code == 2 && said.contains("give `--job`"), "{said}");
    }
    let apart =
        ["--random=5", "--low-discrepancy=5", "--target=linuxcnc", "--plane=XY", "--csv=x.csv", "--drawing=grid"];
    for option in apart {
        let (code, _) = refused(&["map", text(&machine), "--tool-poses", text(&tools), "--place", "X=0..1:2", option]);
        assert_eq!(code, 2, "{option}");
    }
    for option in ["--box=X=0..1", "--step=1 mm", "--directions=3", "--vtk=x.vts"] {
        let (code, _) =
            refused(&["reach", text(&machine), "--tool-poses", text(&tools), "--place", "X=0..1:2", option]);
        assert_eq!(code, 2, "{option}");
    }
}

#[test]
fn positions_of_rotary_axes_do_not_turn_with_the_part() {
    let folder = Folder::new("placement-rotary");
    let machine = tilting(&folder);
    let tools = folder.with("given.csv", "X,Y,Z,A,C\n10,20,5,30,40\n10,-20,5,30,80\n");
    let arguments = ["reach", text(&machine), "--tool-poses", text(&tools), "--place"];
    let found = json(&[&arguments[..], &["X=0..150:3", "--format", "json"]].concat());
    for of in found["tried"].as_array().unwrap() {
        let place = Place::of(of);
        let at = |p: V3, c: f64| turned(turned(place.point(p), 2, -c), 0, -30.0);
        let reached = [at([10.0, 20.0, 5.0], 40.0), at([10.0, -20.0, 5.0], 80.0)];
        let reached = reached.iter().filter(|q| q.iter().all(|q| (-170.0..=190.0).contains(q))).count();
        assert_eq!(of["reached"], reached, "{of}");
    }
    let (code, said) = refused(&[&arguments[..], &["X=0..150:3,C=0..90:2"]].concat());
    assert!(code == 2 && said.contains("do not turn with the part"), "{said}");
    let (code, _) = refused(&[&arguments[..], &["X=0..150:3,C=0"]].concat());
    assert_eq!(code, 0, "a rotation that is that of the job turns nothing");
}

#[test]
fn a_robot_takes_a_part_at_places() {
    let folder = Folder::new("placement-robot");
    let _ = directed(&folder, "few.csv", &block()[..3]);
    let job = folder.with("job.yaml", "tool_poses: few.csv\n");
    let robot = Path::new("robots/ur5.yaml");
    let found = json(&["reach", text(robot), "--job", text(&job), "--place", "X=0..900:3", "--format", "json"]);
    for of in found["tried"].as_array().unwrap() {
        let there = folder
            .with("there.yaml", &format!("tool_poses: few.csv\nplace: {{ origin: {} }}\n", of["place"]["origin"]));
        let output = abbe_on(2, &["reach", text(robot), "--job", text(&there), "--format", "json"]);
        let alone: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&of["reached"], &of["margin_mm"]), (&alone["reached"], &Value::Null));
    }
    let (code, said) = refused(&["reach", text(robot), "--job", text(&job), "--place", "X=0..1:90,Y=0..1:90"]);
    assert!(code == 1 && said.contains("20000 tool poses"), "{said}");
}
