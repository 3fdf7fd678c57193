//! Machines of which different errors are bounded: what is covered is stated, and a verdict that the missing errors
//! could turn is withheld.

use crate::program::{Folder, abbe, json, text};
use crate::support::packed::data;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

const HEAD: &str = "abbe: 1\nmachine: M\nchain: \"w Y' b X Z t\"\naxes:\n  X: { travel: [0, 400], origin: [0, 0, 0] }\n  \
                    Y: { travel: [0, 300], origin: [0, 0, 0] }\n  Z: { travel: [-200, 0], origin: [0, 0, 0] }\n";

fn compare(first: &str, second: &str) -> Value {
    let folder = Folder::new("equal-bounds");
    let [a, b] =
        [("a.yaml", first), ("b.yaml", second)].map(|(name, rest)| folder.with(name, &format!("{HEAD}{rest}")));
    json(&[
        "compare",
        text(&a),
        text(&b),
        "--poses",
        "40",
        "--samples",
        "300",
        "--max-samples",
        "300",
        "--format",
        "json",
    ])
}

#[test]
fn the_errors_that_act_are_counted() {
    let folder = Folder::new("coverage");
    let coverage = |rest: &str| {
        let path = folder.with("m.yaml", &format!("{HEAD}{rest}"));
        json(&["check", text(&path), "--quiet", "--format", "json"])["coverage"].clone()
    };
    // Six of each of three axes, and three squarenesses: ISO 230-1.
    let none = coverage("");
    assert_eq!((&none["valued"], &none["bounded"]), (&0.into(), &0.into()));
    assert_eq!(none["missing"].as_array().unwrap().len(), 21);
    let some = coverage("tolerances: { EXX: 5 um, X: { about_across: 9 urad }, X-Y: 20 urad, EZZ: 0 um }\n");
    assert_eq!((&some["valued"], &some["bounded"]), (&0.into(), &4.into()));
    let missing: Vec<&str> = some["missing"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    // A bound of zero says that there is none of it.
    assert_eq!(missing.len(), 16);
    assert!(["EYX", "EAX", "EA0Z", "EB0Z"].iter().all(|name| missing.contains(name)), "{missing:?}");
    assert!(["EXX", "EBX", "ECX", "EC0Y", "EZZ"].iter().all(|name| !missing.contains(name)), "{missing:?}");
    assert_eq!(coverage("class: production\n")["missing"], serde_json::json!([]));
    // Of a measured machine, what is not stated is zero.
    assert_eq!(coverage("errors: { EXX: { polynomial: [0 um, 3 um/m] } }\n")["missing"], serde_json::json!([]));
}

#[test]
fn a_verdict_that_missing_errors_could_turn_is_withheld() {
    // The first lacks EYY: with the second's bound for it both are one machine, and the difference is exactly zero.
    let found = compare("tolerances: { EXX: 5 um, EYY: 5 um }\n", "tolerances: { EXX: 5 um }\n");
    let versus = &found["budgets"]["versus_first_p95_um"][0];
    assert_eq!(versus["verdict"], Value::Null);
    assert!(versus["minus_first"]["value"].as_f64().unwrap() < -0.5);
    let withheld = &versus["withheld"];
    assert_eq!(withheld["as_bounded"], "better");
    assert_eq!(withheld["minus_first_if_filled"][0]["value"], 0.0);
    assert!(withheld["reason"].as_str().unwrap().contains("--class production"));
    let lacks = |key: &str| withheld[key].as_array().unwrap().contains(&"EYY".into());
    assert!(lacks("missing") && !lacks("missing_first"));
    // A value beside does not make known what neither value nor bound is stated of.
    let value = "errors: { EZZ: { polynomial: [0 um, 3 um/m] } }\n";
    let found = compare(
        &format!("tolerances: {{ EXX: 5 um, EYY: 5 um }}\n{value}"),
        &format!("tolerances: {{ EXX: 5 um }}\n{value}"),
    );
    let versus = &found["budgets"]["versus_first_p95_um"][0];
    assert_eq!((&versus["verdict"], &versus["withheld"]["as_bounded"]), (&Value::Null, &"better".into()));
    assert!(!versus["withheld"]["missing"].as_array().unwrap().contains(&"EZZ".into()));
    // Like bounds, or a difference that nothing missing makes up for, have their verdict.
    for (first, second) in [
        ("tolerances: { EXX: 5 um }\nclass: production\n", "tolerances: { EXX: 90 um }\nclass: production\n"),
        ("tolerances: { EXX: 5 um }\n", "tolerances: { EXX: 900 um }\n"),
        ("tolerances: { EXX: 5 um, EYY: 5 um }\n", "tolerances: { EXX: 900 um }\n"),
    ] {
        let found = compare(first, second);
        let versus = &found["budgets"]["versus_first_p95_um"][0];
        assert_eq!(versus["verdict"], "worse", "{first}");
        assert_eq!(versus.get("withheld"), None);
    }
}

#[test]
fn a_verdict_that_stands_is_stated_of_like_bounds() {
    let [wide, narrow] = ["tolerances: { EXX: 20 um, EYY: 10 um }\n", "tolerances: { EXX: 5 um }\n"];
    let versus = |found: &Value| found["budgets"]["versus_first_p95_um"][0].clone();
    let found = compare(wide, narrow);
    let own = versus(&found);
    // The same two machines, both bounds written down by hand.
    let by_hand = versus(&compare(wide, "tolerances: { EXX: 5 um, EYY: 10 um }\n"));
    assert_eq!(own["verdict"], by_hand["verdict"]);
    assert_eq!(own["minus_first_alike"]["value"], by_hand["minus_first"]["value"]);
    assert_ne!(own["minus_first"]["value"], by_hand["minus_first"]["value"]);
    assert_eq!(by_hand["minus_first_alike"], Value::Null);
    let judged = &found["verdicts"][0]["by"];
    assert_eq!((&judged["um"], &judged["alike"]), (&by_hand["minus_first"]["value"], &true.into()));
    let unbounded = |i: usize| found["budgets"]["machines"][i]["unbounded"].as_u64().unwrap();
    assert_eq!(unbounded(0).abs_diff(unbounded(1)), 1);
}

#[test]
fn a_ranking_withholds_what_missing_errors_turn() {
    let folder = Folder::new("ranking-coverage");
    let (mut turned, mut kept) = (0, 0);
    for tolerance in ["EXX: 5 um", "EAY: 30 urad", "ECX: 20 urad", "X-Y: 40 urad", "EBX: 2000 urad"] {
        let machine = folder.with("m.yaml", &format!("{HEAD}tolerances: {{ {tolerance} }}\n"));
        let of = |more: &[&str]| {
            let fixed = ["enumerate", text(&machine), "--poses", "40", "--samples", "300", "--max-samples", "300"];
            json(&[&fixed[..], &["--reference", "machine", "--format", "json"], more].concat())
        };
        let [found, whole] = [of(&[]), of(&["--class", "production"])];
        let coverage = &found["coverage"];
        assert_eq!(
            (&coverage["bounded"], coverage["missing"].as_array().unwrap().len()),
            (&1.into(), 20),
            "{coverage}"
        );
        assert_eq!((whole["coverage"]["missing"].as_array().unwrap().len(), whole.get("turned")), (0, None));
        // The bounds of the class in the file would give the difference the sign that counts.
        let value = |chain: &Value| {
            // With a class the geometry of other sides matters, so some come apart; their figures are the same.
            let of = |group: &str| whole[group].as_array().unwrap().clone();
            let rows = [of("ranked"), of("geometry_not_stated")].concat();
            number(&rows.iter().find(|row| row["chain"] == *chain).unwrap()["um"])
        };
        let rows = found["ranked"].as_array().unwrap();
        for row in &rows[1..] {
            let versus = &row["versus_first"];
            let is_worse = number(&versus["minus_first"]["low"]) > 0.0;
            let flips = value(&row["chain"]) <= value(&rows[0]["chain"]);
            assert_eq!(row.get("withheld").is_some(), is_worse && flips, "{tolerance}: {row}");
            assert_eq!(versus["verdict"] == "worse", is_worse && !flips, "{tolerance}: {row}");
            if let Some(reason) = row.get("withheld") {
                assert!(reason.as_str().unwrap().contains("lacks 20 of 21; `--class production` bounds them"));
                turned += 1;
            } else if is_worse {
                kept += 1;
            }
        }
        let count = rows.iter().filter(|row| row.get("withheld").is_some()).count();
        assert_eq!(found["turned"]["arrangements"].as_u64().unwrap_or(0), count as u64);
        let said = abbe(&["enumerate", text(&machine), "--poses", "40", "--reference", "machine"]);
        assert!(said.contains("1 of 21 errors that act are bounded; 20 have neither value nor bound"), "{said}");
    }
    assert!(turned > 0 && kept > 0, "{turned} {kept}");
}

#[test]
fn a_report_names_what_is_missing_and_why_there_is_no_verdict() {
    let folder = Folder::new("report-coverage");
    let file = |name: &str, rest: &str| folder.with(name, &format!("{HEAD}{rest}"));
    let [first, second] =
        [file("a.yaml", "tolerances: { EXX: 5 um, EYY: 5 um }\n"), file("b.yaml", "tolerances: { EXX: 5 um }\n")];
    let out = folder.file("report.html");
    let files = ["report", text(&first), text(&second), "--poses", "40", "--samples", "300", "--out", text(&out)];
    let _ = abbe(&[&files[..], &["--quiet"]].concat());
    let html = std::fs::read_to_string(&out).unwrap();
    let found = data(&html);
    assert_eq!(found["machines"][1]["coverage"]["acting"], 21);
    assert_eq!(found["comparison"]["budgets"]["versus_first_p95_um"][0]["verdict"], Value::Null);
    assert!(html.contains("<b>no verdict</b>") && html.contains("errors with neither value nor bound could turn it"));
    assert!(html.contains("20 have neither value nor bound: ") && html.contains("they count as zero."));
    let _ = file("b.yaml", "class: premium\n");
    let _ = file("a.yaml", "class: commodity\n");
    let _ = abbe(&[&files[..], &["--quiet"]].concat());
    let html = std::fs::read_to_string(&out).unwrap();
    assert!(html.contains("<b>better</b> than machine 1") && !html.contains("<b>no verdict</b>"));
    assert!(!html.contains("they count as zero."));
}

#[test]
fn designs_differ_by_their_budgets() {
    let folder = Folder::new("diff-bounds");
    let file = |name: &str, rest: &str| folder.with(name, &format!("{HEAD}{rest}"));
    let diff = |first: &str, second: &str| {
        let [a, b] = [file("a.yaml", first), file("b.yaml", second)];
        json(&["diff", text(&a), text(&b), "--poses", "60", "--format", "json"])
    };
    // One error alone, twice as wide: to first order every machine drawn errs twice as much.
    let found = diff("tolerances: { EXX: 5 um }\n", "tolerances: { EXX: 10 um }\n");
    let p95: Vec<f64> = found["p95_um"].as_array().unwrap().iter().map(|um| um.as_f64().unwrap()).collect();
    assert!(p95[0] > 1.0 && (p95[1] - 2.0 * p95[0]).abs() < 1e-9, "{p95:?}");
    let difference = &found["differences"][0];
    assert_eq!((&difference["name"], &found["from"]), (&"EXX".into(), &"bounds".into()));
    assert!((difference["minus_first_um"].as_f64().unwrap() - p95[0]).abs() < 1e-9);
    // Bounds along axes, squareness and a class have their effect, too.
    let found = diff("tolerances: { EXX: 5 um }\n", "tolerances: { EXX: 5 um, X-Y: 50 urad }\nclass: premium\n");
    let names: Vec<&str> =
        found["differences"].as_array().unwrap().iter().map(|d| d["kind"].as_str().unwrap()).collect();
    assert_eq!(names, ["class", "tolerances"]);
    assert!(found["differences"].as_array().unwrap().iter().all(|d| d["minus_first_um"].as_f64().unwrap() > 0.0));
}

#[test]
fn a_mixture_that_reaches_nothing_is_no_refusal() {
    let folder = Folder::new("diff-mixture");
    let first = folder.with("a.yaml", &format!("{HEAD}errors: {{ EC0Y: 20 urad }}\n"));
    let moved = "tool: { gauge: [5000, 0, 0] }\nworkpiece: { origin: [5000, 0, 0] }\nerrors: { EC0Y: 30 urad }\n";
    let second = folder.with("b.yaml", &format!("{HEAD}{moved}"));
    let found = json(&["diff", text(&first), text(&second), "--poses", "50", "--format", "json"]);
    assert_eq!(found["poses"], 50);
    let effects: Vec<(&str, bool)> = found["differences"]
        .as_array()
        .unwrap()
        .iter()
        .map(|d| (d["kind"].as_str().unwrap(), d["minus_first_um"].is_null()))
        .collect();
    assert_eq!(effects, [("tool", true), ("workpiece", true), ("error", false)]);
}
