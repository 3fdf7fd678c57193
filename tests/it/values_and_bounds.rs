//! Machines of which some errors have values and others bounds: both act in every figure that is judged. Closed forms
//! of a value along X and a bound along Y, which meet at a right angle.

use crate::program::{Folder, abbe, json, refused, text};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn near(found: f64, truth: f64) {
    assert!((found - truth).abs() < 1e-9 * truth.abs().max(1.0), "{found} {truth}");
}

/// A machine with a constant value of EXX (um) and a bound of EYY (um).
fn machine(folder: &Folder, name: &str, value: f64, bound: f64) -> PathBuf {
    let axis = |name: &str| format!("  {name}: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(axis).concat();
    let value = match value {
        0.0 => String::new(),
        _ => format!("  EXX: {{ points: [[-300 mm, {value} um], [300 mm, {value} um]] }}\n"),
    };
    let errors = format!("errors:\n{value}  EYY: {{ tolerance: {bound} um }}\n");
    folder.with(name, &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}{errors}"))
}

/// A job of one tool pose with a limit (um).
fn job(folder: &Folder, limit: f64) -> PathBuf {
    let _ = folder.with("one.csv", "X,Y,Z\n0,0,0\n");
    folder.with(&format!("job{limit}.yaml"), &format!("tool_poses: one.csv\nreference: machine\nlimit: {limit} um\n"))
}

fn of(verb: &str, machine: &[&PathBuf], job: &Path) -> Value {
    let machines: Vec<&str> = machine.iter().map(|path| text(path)).collect();
    json(&[&[verb], &machines[..], &["--job", text(job), "--format", "json", "--quiet"]].concat())
}

#[test]
fn values_act_in_every_machine_drawn() {
    let folder = Folder::new("values-and-bounds");
    let (both, bound) = (machine(&folder, "both.yaml", 30.0, 40.0), machine(&folder, "bound.yaml", 0.0, 40.0));
    let job = job(&folder, 35.0);
    let [both, bound] = [&both, &bound].map(|machine| of("budget", &[machine], &job));
    let p95 = |of: &Value| number(&of["position_um"]["monte_carlo"]["p95"]);
    near(p95(&both), p95(&bound).hypot(30.0));
    for figure in ["worst_case", "rss"] {
        near(number(&both["position_um"][figure]), number(&bound["position_um"][figure]).hypot(30.0));
    }
    near(number(&bound["position_um"]["worst_case"]), 40.0);
    assert_eq!((&both["with_values"]["errors"], &both["left_out"]), (&1.into(), &0.into()));
    assert_eq!(bound.get("with_values"), None);
    // Euler: parts of the bounds and of the values add up to the mean of the machines about the 95 % value.
    let parts: f64 = both["tighten"].as_array().unwrap().iter().map(|bound| number(&bound["um_of_p95"])).sum();
    let sum = parts + number(&both["with_values"]["um_of_p95"]);
    assert!((sum / p95(&both) - 1.0).abs() < 0.01, "{sum}");
    // A class bounds what has neither value nor bound, be it named by the file or by an option.
    let path = machine(&folder, "both.yaml", 300.0, 40.0);
    let named = folder.with("class.yaml", &(std::fs::read_to_string(&path).unwrap() + "class: premium\n"));
    for asked in [vec![text(&path), "--class", "premium"], vec![text(&named)]] {
        let with = |verb: &str| {
            let more = ["--job", text(&job), "--samples", "200", "--format", "json", "--quiet"];
            json(&[&[verb], &asked[..], &more].concat())
        };
        let (budget, map) = (with("budget"), with("map"));
        assert_eq!((&budget["left_out"], &budget["with_values"]["errors"]), (&0.into(), &1.into()));
        assert!(p95(&budget) > 300.0 && budget["limit"]["held"] == false, "{budget}");
        assert_eq!(map["limit"], budget["limit"]);
    }
    // Where every error has a value a class takes the place of all; that decides no limit.
    let job = folder.with("any.yaml", "tool_poses: one.csv\nreference: machine\nlimit: 1 mm\n");
    let whole = ["budget", "trunnion.yaml", "--class", "production", "--samples", "20", "--format", "json"];
    let whole = json(&[&whole[..], &["--job", text(&job), "--quiet"]].concat());
    assert_eq!((&whole["left_out"], &whole["limit"]["held"]), (&41.into(), &Value::Null));
}

#[test]
fn a_limit_is_judged_by_values_and_bounds_and_by_the_whole_job() {
    let folder = Folder::new("limit-of-both");
    let both = machine(&folder, "both.yaml", 30.0, 40.0);
    let strict = job(&folder, 35.0);
    let [budget, map] = ["budget", "map"].map(|verb| of(verb, &[&both], &strict)["limit"].clone());
    // Values alone are 30 um, and the bound alone is within 35 um in most machines.
    assert_eq!((&budget["held"], &budget["drawn"], &budget["statistic"]), (&false.into(), &true.into(), &"max".into()));
    assert_eq!(map, budget);
    let compared = of("compare", &[&both, &both], &strict);
    assert_eq!(compared["machines"][1]["limit"]["held"], false);
    // The largest deviation is judged, of values too: 30 um at 20 of 21 poses, 30.1 um at one.
    let points = "EXX: { points: [[-300 mm, 30 um], [0 mm, 30 um], [300 mm, 32 um]] }";
    let head = "abbe: 1\nmachine: M\nchain: \"w b X t\"\naxes: { X: { travel: [-300, 300] } }\nerrors:\n  ";
    let measured = folder.with("measured.yaml", &format!("{head}{points}\n"));
    let rows: String = (0..20).map(|i| format!("{},0,0\n", -10 * i)).collect();
    let _ = folder.with("rows.csv", &format!("X,Y,Z\n{rows}300,0,0\n"));
    let whole = folder.with("whole.yaml", "tool_poses: rows.csv\nreference: machine\nlimit: 31 um\n");
    let limit = of("map", &[&measured], &whole)["limit"].clone();
    assert_eq!((&limit["held"], &limit["um"], &limit["missed"]), (&false.into(), &32.0.into(), &0.into()));
    let by = |statistic: &str| {
        let machines = ["compare", text(&measured), text(&measured), "--job", text(&whole), "--format", "json"];
        json(&[&machines[..], &["--statistic", statistic]].concat())["machines"][1]["limit"]["held"].clone()
    };
    assert_eq!([by("max"), by("p95")], [Value::from(false), true.into()]);
    // A job that is not done holds no limit.
    let _ = folder.with("far.csv", "X,Y,Z\n0,0,0\n900,0,0\n");
    let far = folder.with("far.yaml", "tool_poses: far.csv\nreference: machine\nlimit: 31 um\n");
    let found = of("map", &[&measured], &far);
    assert_eq!((&found["limit"]["held"], &found["limit"]["missed"]), (&Value::Null, &1.into()));
    let (_, said) = refused(&["map", text(&measured), "--job", text(&far)]);
    assert!(said.contains("W0608"), "{said}");
}

#[test]
fn machines_are_compared_by_values_and_bounds_together() {
    let folder = Folder::new("compare-both");
    let job = job(&folder, 60.0);
    let of_machine = |name: &str, value: f64, bound: f64| {
        let path = machine(&folder, name, value, bound);
        let p95 = number(&of("budget", &[&path], &job)["position_um"]["monte_carlo"]["p95"]);
        (path, p95)
    };
    // The bounds alone say worse.
    let (first, second) = (of_machine("a.yaml", 50.0, 10.0), of_machine("b.yaml", 5.0, 20.0));
    let found = of("compare", &[&first.0, &second.0], &job);
    let verdict = &found["verdicts"][0];
    assert_eq!(verdict["verdict"], "better");
    near(number(&verdict["by"]["um"]), second.1 - first.1);
    assert!(number(&verdict["by"]["high"]) < 0.0 && verdict["by"]["drawn"] == true);
    // A measured machine without bounds is the same in every draw.
    let head = std::fs::read_to_string(&first.0).unwrap();
    let whole =
        folder.with("whole.yaml", &head.lines().filter(|line| !line.contains("EYY")).collect::<Vec<_>>().join("\n"));
    let found = of("compare", &[&first.0, &whole], &job);
    near(number(&found["verdicts"][0]["by"]["um"]), 50.0 - first.1);
    // `diff` judges as `compare` does, and each difference by itself.
    let differ = of("diff", &[&first.0, &second.0], &job);
    let p95: Vec<f64> = differ["p95_um"].as_array().unwrap().iter().map(number).collect();
    assert_eq!(differ["from"], "bounds");
    p95.iter().zip([first.1, second.1]).for_each(|(found, truth)| near(*found, truth));
    let alone = of_machine("alone.yaml", 5.0, 10.0);
    let value = differ["differences"].as_array().unwrap().iter().find(|of| of["name"] == "EXX").unwrap();
    near(number(&value["minus_first_um"]), alone.1 - first.1);
    // Arrangements are ranked by bounds: values act in none, so that there is no verdict.
    let ranked =
        json(&["enumerate", text(&first.0), "--tool-poses", text(&folder.file("one.csv")), "--format", "json"]);
    let rows = ranked["ranked"].as_array().unwrap();
    let withheld = |row: &Value| row["withheld"].as_str().is_some_and(|why| why.contains("1 error with a value"));
    assert!(rows.len() > 1 && rows[1..].iter().all(withheld), "{rows:?}");
    // A class bounds what has a value on the one machine that was built, so that the value changes no rank.
    let bare = machine(&folder, "bare.yaml", 0.0, 10.0);
    let [valued, bare] = [&first.0, &bare].map(|machine| {
        let options = ["--class", "premium", "--samples", "100", "--format", "json"];
        json(&[&["enumerate", text(machine), "--job", text(&job)], &options[..]].concat())
    });
    assert_eq!([&valued["left_out"], &bare["left_out"]], [&Value::from(1), &0.into()]);
    assert_eq!((&valued["ranked"], &valued["errors"]), (&bare["ranked"], &bare["errors"]));
    let second = &valued["ranked"][1];
    assert!(second["versus_first"]["verdict"].is_string() && second.get("withheld").is_none(), "{second}");
}

/// What a machine is judged by is in force on both, or is said.
#[test]
fn unlike_machines_are_told() {
    let folder = Folder::new("unlike-machines");
    let job = job(&folder, 60.0);
    let whole = |name: &str, value: f64| {
        let both = machine(&folder, name, value, 10.0);
        let kept = std::fs::read_to_string(both).unwrap();
        folder.with(name, &kept.lines().filter(|line| !line.contains("EYY")).collect::<Vec<_>>().join("\n"))
    };
    let measured = whole("measured.yaml", 30.0);
    let (designed, both) = (machine(&folder, "designed.yaml", 0.0, 10.0), machine(&folder, "both.yaml", 30.0, 10.0));
    let of_job = ["--job", text(&job)];
    let (code, said) = refused(&[&["diff", text(&measured), text(&designed)], &of_job[..]].concat());
    assert!(code == 0 && said.contains("W0607") && said.contains("only bounded"), "{said}");
    let (code, said) = refused(&[&["diff", text(&measured), text(&both)], &of_job[..]].concat());
    assert!(code == 0 && !said.contains("W0607"), "{said}");
    let zone = ["--job", text(&job), "--reference", "best-fit:minimum-zone"];
    let (_, said) = refused(&[&["diff", text(&measured), text(&both)], &zone[..]].concat());
    assert!(said.contains("E0850"), "{said}");
    // A class takes the place of values that are all there are: that is said of each machine, and decides no limit.
    let with_class = ["--class", "premium", "--samples", "100", "--quiet"];
    let said = abbe(&[&["compare", "trunnion.yaml", "trunnion.yaml"], &of_job[..], &with_class].concat());
    assert_eq!(said.matches(": 41 errors with a value left out: bounds stand for them").count(), 2, "{said}");
    let joined = said.replace("\n  ", " ");
    assert!(joined.contains("not decided, for values or bounds of the machine are left out"), "{said}");
    let compared = ["compare", "trunnion.yaml", "trunnion.yaml", "--format", "json"];
    let compared = json(&[&compared[..], &of_job, &with_class].concat());
    assert_eq!(compared["verdicts"][0]["by"]["class"], "premium");
    let budget = of("budget", &[&both], &job);
    assert_eq!(budget["limit"].get("partial"), None);
    // So the advice beside such a machine is to name the class in the file that needs it.
    let bounds = "errors:\n  EXX: { points: [[-300 mm, 29.8 um], [300 mm, 29.8 um]] }\n  EYY: { tolerance: 1 um }\n";
    let head = std::fs::read_to_string(&both).unwrap();
    let small = folder.with("small.yaml", &format!("{}{bounds}", head.split("errors:").next().unwrap()));
    let said = abbe(&[&["compare", text(&small), text(&measured)], &of_job[..], &["--quiet"]].concat());
    assert!(said.contains("`class: production` in the file bounds them"), "{said}");
    // Nothing is kept of a goal.
    let (code, _) = refused(&["budget", text(&designed), "--goal", "9 um", "--state", text(&folder.file("s.json"))]);
    assert_eq!((code, folder.file("s.json").exists()), (2, false));
}

#[test]
fn features_of_a_map_are_those_of_machines_drawn() {
    let folder = Folder::new("features-of-both");
    let both = machine(&folder, "both.yaml", 30.0, 40.0);
    let _ = folder.with("wall.csv", "feature,X,Y,Z,NX,NY,NZ\nw,0,0,0,0,1,0\nw,100,0,0,0,1,0\nw,200,0,50,0,1,0\n");
    // The value lies in the wall, whose profile is twice what the bound draws.
    let job = "tool_poses: wall.csv\nreference: machine\nfeatures: { w: { kind: profile, tolerance: 52 um } }\n";
    let job = folder.with("wall.yaml", job);
    let [budget, map] = ["budget", "map"].map(|verb| of(verb, &[&both], &job)["characteristics"][0].clone());
    assert_eq!(map, budget);
    let share = number(&map["drawn"]["holds"]["value"]);
    // Twice a number between -40 and 40 um.
    assert!((share - 26.0 / 40.0).abs() < 0.06, "{map}");
}

#[test]
fn uncertain_values_leave_a_limit_open_beside_bounds() {
    let folder = Folder::new("uncertain-and-bounds");
    let both = machine(&folder, "both.yaml", 30.0, 1.0);
    let both = folder.with("both.yaml", &(std::fs::read_to_string(both).unwrap() + "class: ultra-precision\n"));
    let strict = job(&folder, 35.0);
    for verb in ["map", "budget"] {
        assert_eq!(of(verb, &[&both], &strict)["limit"]["held"], true, "{verb}");
    }
    // An expanded uncertainty of 10 um of a value of 30 um, beside a bound of 1 um.
    let known = std::fs::read_to_string(&both).unwrap();
    let uncertain = folder.with("u.yaml", &known.replace("30 um]] }", "30 um]], uncertainty: 10 um }"));
    for verb in ["map", "budget"] {
        let limit = of(verb, &[&uncertain], &strict)["limit"].clone();
        assert_eq!(limit["held"], Value::Null, "{verb}: {limit}");
        let [low, high] = [0, 1].map(|end| number(&limit["interval_um"][end]));
        let um = number(&limit["um"]);
        assert!((um - 30.5).abs() < 0.5 && (um - low - 10.0).abs() < 0.7 && (high - um - 10.0).abs() < 0.7, "{limit}");
    }
    // Nor is it held at a place of the part, which has the interval of the uncertainty, too.
    let places = ["--place", "X=-10..10:2", "--format", "json", "--quiet"];
    let placed = json(&[&["map", text(&uncertain), "--job", text(&strict)], &places[..]].concat());
    assert_eq!(placed["own"]["limit"]["held"], Value::Null, "{}", placed["own"]);
    let [low, high] = [0, 1].map(|end| number(&placed["own"]["interval_um"][end]));
    assert!((high - low - 20.0).abs() < 1.0 && (low..high).contains(&30.0), "{placed}");
    // A ranking by values counts no uncertainty, so that it has no verdict.
    let kept = std::fs::read_to_string(&uncertain).unwrap();
    let is_value = |line: &&str| !line.contains("EYY") && !line.contains("class");
    let whole = folder.with("w.yaml", &kept.lines().filter(is_value).collect::<Vec<_>>().join("\n"));
    let ranked = json(&["enumerate", text(&whole), "--tool-poses", text(&folder.file("one.csv")), "--format", "json"]);
    let second = &ranked["ranked"][1];
    let why = second["withheld"].as_str().unwrap_or_default();
    assert!(why.contains("uncertainty") && second["versus_first"]["verdict"].is_null(), "{second}");
    let other = machine(&folder, "other.yaml", 33.0, 1.0);
    let compared = of("compare", &[&uncertain, &other], &strict);
    assert_eq!(compared["verdicts"][0]["verdict"], "not_told_apart", "{}", compared["verdicts"]);
    // A minimum zone has no machines drawn beside values: bounds are left out, and nothing is decided.
    let rows = folder.with("zone.csv", "X,Y,Z\n0,0,0\n100,0,0\n200,50,0\n200,0,70\n");
    let zone = folder.with("zone.yaml", "tool_poses: zone.csv\nreference: best-fit:minimum-zone\nlimit: 35 um\n");
    assert!(rows.exists());
    assert_eq!(of("map", &[&both], &zone)["limit"]["held"], Value::Null);
    let placed = ["map", text(&both), "--job", text(&zone), "--place", "X=-10..10:2"];
    assert!(refused(&placed).1.contains("E0850"));
    let compared = of("compare", &[&both, &other], &zone);
    assert_eq!(compared["verdicts"][0]["verdict"], Value::Null);
    assert_eq!(compared["machines"][0]["limit"]["held"], Value::Null);
}

/// A value by letter on an oblique axis stands for its letter alone: along Z there are 0.8 of the bound left.
#[test]
fn a_value_by_letter_leaves_the_rest_of_an_oblique_bound() {
    let folder = Folder::new("oblique-value");
    let axis = "axes: { Y: { travel: [-300, 300], origin: [0, 0, 0], direction: [0, 0.6, 0.8] } }";
    let bound = "tolerances: { Y: { along: 10 um } }";
    let value = "errors: { EYY: { points: [[-300 mm, 3 um], [300 mm, 3 um]] } }";
    let head = "abbe: 1\nmachine: M\nchain: \"w b Y t\"";
    let machine = folder.with("oblique.yaml", &format!("{head}\n{axis}\n{bound}\n{value}\n"));
    let job = job(&folder, 35.0);
    let found = of("budget", &[&machine], &job);
    near(number(&found["position_um"]["worst_case"]), 8_f64.hypot(3.0));
    near(number(&found["position_um"]["rss"]), 8_f64.hypot(3.0));
    // A class bounds both directions across, less their parts along Y.
    let whole = json(&["budget", text(&machine), "--class", "production", "--format", "json", "--quiet"]);
    assert_eq!(whole["coverage"]["missing"].as_array().map(Vec::len), Some(0), "{}", whole["coverage"]);
}

/// Of location errors a shift along the axis is none: the two values of a table at 45 degrees say all there is across.
#[test]
fn values_of_the_minimal_set_leave_no_location_error_of_an_oblique_axis_open() {
    let folder = Folder::new("oblique-location");
    let head = "abbe: 1\nmachine: M\nchain: \"w B' b X Y Z t\"\nclass: production\n";
    let linear = |name: &str| format!("  {name}: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(linear).concat();
    let axes = format!("axes:\n{axes}  B: {{ travel: [-90, 90], origin: [0, 0, 0], direction: [0, 1, 1] }}\n");
    let open = |name: &str, errors: &str| -> Vec<String> {
        let machine = folder.with(name, &format!("{head}{axes}errors:\n{errors}"));
        let options = ["--samples", "20", "--poses", "20", "--format", "json", "--quiet"];
        let found = json(&[&["budget", text(&machine)], &options[..]].concat());
        let names =
            found["tighten"].as_array().unwrap().iter().map(|bound| bound["error"].as_str().unwrap().to_owned());
        names.filter(|name| name.contains("0B") || name.starts_with("B location")).collect()
    };
    let all = "  EX0B: 5 um\n  EZ0B: 5 um\n  EA0B: 9 urad\n  EC0B: 9 urad\n";
    assert_eq!(open("all.yaml", all), [""; 0]);
    // One of the two directions across is known, whichever letter says it.
    for letter in ["Y", "Z"] {
        let one = open("one.yaml", &format!("  E{letter}0B: 5 um\n  EA0B: 9 urad\n  EC0B: 9 urad\n"));
        assert_eq!(one, ["EX0B"], "{letter}");
    }
    let none = open("none.yaml", "  EXX: { points: [[-300 mm, 1 um], [300 mm, 1 um]] }\n");
    assert_eq!(none.len(), 4, "{none:?}");
}

/// What is held by two of the errors alone is not held by a machine: the rest could turn it.
#[test]
fn a_limit_is_not_held_while_missing_errors_could_turn_it() {
    let folder = Folder::new("missing-in-limit");
    let (both, bound) = (machine(&folder, "both.yaml", 3.0, 1.0), machine(&folder, "bound.yaml", 0.0, 1.0));
    let (near, wide) = (job(&folder, 4.0), job(&folder, 500.0));
    let with_class = ["--class", "production", "--format", "json", "--quiet"];
    for file in [&both, &bound] {
        let filled = json(&[&["budget", text(file), "--job", text(&near)], &with_class[..]].concat());
        assert_eq!((&filled["limit"]["held"], filled["limit"].get("missing")), (&false.into(), None));
        for verb in ["map", "budget"] {
            let limit = of(verb, &[file], &near)["limit"].clone();
            assert_eq!(limit["held"], Value::Null, "{verb}: {limit}");
            assert_eq!(limit["missing"]["class"], "production");
            // The same machines as with the class, bar the order of its bounds: sampling only.
            let [um, known] = [&limit["missing"]["um"], &filled["limit"]["um"]].map(number);
            assert!((um / known - 1.0).abs() < 0.1, "{um} {known}");
            let said = abbe(&[verb, text(file), "--job", text(&near), "--quiet"]);
            assert!(said.contains("with neither value nor bound could turn it (class production"), "{said}");
            // A limit that they do not turn is held.
            assert_eq!(of(verb, &[file], &wide)["limit"]["held"], true, "{verb}");
        }
        let compared = of("compare", &[file, file], &near);
        assert_eq!(compared["machines"][1]["limit"]["missing"], of("budget", &[file], &near)["limit"]["missing"]);
        let places = ["--place", "X=-10..10:2", "--format", "json", "--quiet"];
        let placed = json(&[&["map", text(file), "--job", text(&near)], &places[..]].concat());
        assert_eq!(
            (&placed["own"]["limit"]["held"], &placed["own"]["limit"]["missing"]["errors"]),
            (&Value::Null, &of("budget", &[file], &near)["limit"]["missing"]["errors"])
        );
    }
    // Nor by a machine of which nothing is known.
    let unknown = folder.with("unknown.yaml", std::fs::read_to_string(&both).unwrap().split_once("errors:").unwrap().0);
    let [limit, compared] = [of("map", &[&unknown], &near), of("compare", &[&unknown, &unknown], &near)];
    let (limit, compared) = (&limit["limit"], &compared["machines"][0]["limit"]);
    assert_eq!((&limit["held"], &limit["missing"]), (&Value::Null, &compared["missing"]), "{limit}");
    assert!(number(&limit["missing"]["um"]) > 4.0, "{limit}");
    // What exceeds a limit exceeds it with them, too.
    assert_eq!(of("budget", &[&both], &job(&folder, 2.0))["limit"]["held"], false);
}

/// A machine that is the same in every draw is told apart only by what the draws of the other show.
#[test]
fn a_measured_machine_at_the_figure_of_a_design_is_not_told_apart() {
    let folder = Folder::new("at-the-figure");
    let job = job(&folder, 500.0);
    let head = |name: &str, errors: &str| {
        let axis = |name: &str| format!("  {name}: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n");
        let axes: String = ["X", "Y", "Z"].map(axis).concat();
        folder.with(name, &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}errors:\n{errors}"))
    };
    // 95 % of numbers between -20 and 20 are within 19: hypot(30, 19) = 35.51 um.
    let constant = |um: f64| format!("EXX: {{ points: [[-300 mm, {um} um], [300 mm, {um} um]] }}\n");
    let drawn = head("drawn.yaml", &format!("  {}  EYY: {{ tolerance: 20 um }}\n", constant(30.0)));
    let mut told = 0;
    for (name, um) in [("at.yaml", 30.0_f64.hypot(19.0)), ("above.yaml", 36.0), ("below.yaml", 34.6)] {
        let same = head(name, &format!("  {}", constant(um)));
        for seed in 1..=10 {
            let seed = seed.to_string();
            let options = ["--seed", &seed, "--max-samples", "1000", "--format", "json", "--quiet"];
            let found = json(&[&["compare", text(&drawn), text(&same), "--job", text(&job)], &options[..]].concat());
            let by = &found["budgets"]["versus_first_p95_um"][0]["minus_first"];
            let [low, high] = ["low", "high"].map(|end| number(&by[end]));
            let truth = um - 30.0_f64.hypot(19.0);
            told += usize::from(!(low..=high).contains(&truth));
        }
    }
    // At 95 % for all pairs 1.5 of 30 are expected at most; five would be one chance in sixty.
    assert!(told <= 4, "{told}");
}

#[test]
fn a_squareness_beside_a_value_of_the_same_error_is_said_to_be_without_effect() {
    let folder = Folder::new("pair-beside-value");
    let path = machine(&folder, "m.yaml", 0.0, 10.0);
    let kept = std::fs::read_to_string(&path).unwrap();
    let pair = |name: &str, value: &str, pair: &str| {
        let text = format!(
            "{}  {value}: 12 urad\ntolerances: {{ {pair}: {{ width: 20 urad }} }}\n",
            kept.trim_end().to_owned() + "\n"
        );
        let path = folder.with(name, &text);
        let (code, said) = refused(&["check", self::text(&path)]);
        assert_eq!(code, 0, "{said}");
        said
    };
    let said = pair("a.yaml", "EC0Y", "X-Y");
    assert!(said.contains("W0411") && said.contains("bounds `EC0Y`, which has a value"), "{said}");
    // Another plane of the same two axes' carrier.
    assert!(!pair("b.yaml", "EC0Y", "X-Z").contains("W0411"));
}
