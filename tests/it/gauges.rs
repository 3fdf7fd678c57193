//! Gauges between balls: what a known distance is worth, in closed form.

use super::fits::{identify, said};
use super::identify::{json, run};
use super::oracle::program::Folder;
use serde_json::Value;

/// A gantry of three axes without errors.
const MACHINE: &str = "abbe: 1\nmachine: Gauge\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [-100 mm, 400 mm] }\n  \
                       Y: { travel: [-100 mm, 400 mm] }\n  Z: { travel: [-200 mm, 200 mm] }\n";

/// Readings of two balls at nominally 0 and `far`, found `count` times each at `first` and `second` (mm, along X) with
/// residuals of +- `scatter` (mm).
fn balls(run: &str, far: f64, found: [f64; 2], count: usize, scatter: f64) -> String {
    let row = |ball: usize, i: usize| {
        let off = if i.is_multiple_of(2) { scatter } else { -scatter };
        let [x, y] = [found[ball] + off, if i % 4 < 2 { scatter } else { -scatter }];
        let z = if (i + i / 2).is_multiple_of(2) { scatter } else { -scatter };
        format!("{x},{y},{z},b{},{run},{},0,0\n", ball + 1, far * ball as f64)
    };
    (0..2).flat_map(|ball| (0..count).map(move |i| row(ball, i))).collect()
}

const HEADER: &str = "X,Y,Z,ball,run,ball.x [mm],ball.y [mm],ball.z [mm]\n";
const FIT: [&str; 6] = ["--fit", "EXX:poly1", "--fixed", "EXX:x^0", "--format", "json"];

fn slope(report: &Value) -> (f64, f64) {
    let list = report["parameters"].as_array().unwrap();
    let found = list.iter().find(|p| p["name"] == "EXX:x^1").unwrap();
    (found["value"].as_f64().unwrap(), found["type_a"].as_f64().unwrap())
}

/// Balls of unknown place hold no length. With a gauge L of uncertainty u between them the scale of X is what the axes
/// show less the gauge, and its uncertainty that of the gauge and of both balls: all by closed form.
#[test]
fn a_gauge_holds_the_scale_with_its_own_uncertainty() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", MACHINE);
    let (far, count) = (300.0, 16);
    // The table of positions runs 30 um short: 299.97 are read where there are 300.
    let data = folder.write("balls.csv", &format!("{HEADER}{}", balls("", far, [0.0, 299.97], count, 1e-3)));
    let report = |prior: &str| json(&identify(&machine, &data, &[&FIT[..], &["--prior", prior]].concat()));
    for (words, length, u_um) in [
        ("distance b1 b2 = 300 mm +- 20 um", 300.0, 20.0),
        ("distance ball b2 ball b1 = 300.03 mm 2 um", 300.03, 2.0),
        ("distance b1 b2 = 29.998 cm \u{b1} 0.5 um", 299.98, 0.5),
    ] {
        let report = report(words);
        let (value, sigma) = slope(&report);
        let expected = (length - 299.97) / 299.97 * 1e6;
        let of_balls = report["sigma_um"].as_f64().unwrap() / (count as f64).sqrt();
        let u = (u_um * u_um + 2.0 * of_balls * of_balls).sqrt() / 299.97 * 1e3;
        // An error of three times the RMS of the readings is plausible, which pulls by the square of u over it.
        assert!((value - expected).abs() < 6e-3 * u + 1e-3 * expected.abs(), "{words}: {value} {expected} {u}");
        assert!((sigma / u - 1.0).abs() < 0.01, "{words}: {sigma} {u}");
        let known = report["known"].as_array().unwrap();
        assert_eq!(known.len(), 1);
        assert!((known[0]["value"].as_f64().unwrap() - length).abs() < 1e-9, "{known:?}");
        // The name that the report prints is a word of the option.
        let name = known[0]["name"].as_str().unwrap();
        let again = self::json(&identify(
            &machine,
            &data,
            &[&FIT[..], &["--prior", &format!("{name} = {length} mm {u_um} um")]].concat(),
        ));
        assert_eq!(slope(&again), (value, sigma), "{name}");
    }
}

/// One gauge seen in two set-ups holds in both, and what the option says goes before the section.
#[test]
fn a_gauge_holds_in_every_set_up() {
    let folder = Folder::new();
    let section =
        format!("{MACHINE}identify: {{ priors: [distance b1 b2 = 300.2 mm 1 um, distance b1 b9 = 1 mm 1 um] }}\n");
    let (machine, section) = (folder.write("machine.yaml", MACHINE), folder.write("section.yaml", &section));
    let rows = [balls("am", 300.0, [0.0, 299.97], 16, 1e-3), balls("pm", 300.0, [0.01, 299.99], 16, 1e-3)].concat();
    let data = folder.write("balls.csv", &format!("{HEADER}{rows}"));
    let words = ["--prior", "distance b1 b2 = 300 mm 20 um"];
    let both = json(&identify(&machine, &data, &[&FIT[..], &words].concat()));
    assert_eq!(both["known"].as_array().unwrap().len(), 2);
    let alone =
        json(&identify(&machine, &data, &[&FIT[..], &["--prior", "distance am b1 am b2 = 300 mm 20 um"]].concat()));
    assert_eq!(alone["known"].as_array().unwrap().len(), 1);
    // 299.97 and 299.98 are read: the mean is the scale.
    let ((value, sigma), expected) = (slope(&both), 25.0 / 299.975 * 1e3);
    assert!((value - expected).abs() < 0.01 * expected, "{value} {expected}");
    assert!((slope(&alone).1 / sigma - 2f64.sqrt()).abs() < 0.02, "{sigma} {:?}", slope(&alone));
    let output = identify(&section, &data, &[&FIT[..], &words].concat());
    assert!(said(&output).contains("W0509") && said(&output).contains("b9"), "{}", said(&output));
    assert_eq!(slope(&json(&output)), slope(&both));
}

/// The distance is one along the line of the balls as they are found, not as they were said to be: 2 mm to the side are
/// 6.7 um of 300 mm.
#[test]
fn a_gauge_lies_where_its_balls_are_found() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", MACHINE);
    let aside = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let y = cells[1].parse::<f64>().unwrap() + if cells[3] == "b2" { 2.0 } else { 0.0 };
        format!("{},{y},{}\n", cells[0], cells[2..].join(","))
    };
    let rows: String = balls("", 300.0, [0.0, 299.97], 16, 1e-3).lines().map(aside).collect();
    let data = folder.write("balls.csv", &format!("{HEADER}{rows}"));
    let words = ["--prior", "distance b1 b2 = 300 mm 0.5 um"];
    let (value, sigma) = slope(&json(&identify(&machine, &data, &[&FIT[..], &words].concat())));
    let expected = ((300f64 * 300.0 - 4.0).sqrt() / 299.97 - 1.0) * 1e6;
    assert!((value - expected).abs() < 0.1 * sigma && sigma < 2.2, "{value} {expected} {sigma}");
}

/// What a plan expects: the gauge, and the middle of four readings of each ball.
#[test]
fn a_plan_counts_on_a_gauge() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", MACHINE);
    let data = folder.write("balls.csv", &format!("{HEADER}{}", balls("", 300.0, [0.0, 299.97], 16, 1e-3)));
    let more = ["--plan", "8", "--noise", "1um", "--prior", "distance b1 b2 = 300 mm 2 um"];
    let plan = json(&identify(&machine, &data, &[&FIT[..], &more].concat()));
    let noise = plan["noise_um"].as_f64().unwrap();
    let expected = (4.0 + 2.0 * noise * noise / 4.0).sqrt() / 299.97 * 1e3;
    let sigma = plan["parameters"][0]["sigma"].as_f64().unwrap();
    assert!((sigma / expected - 1.0).abs() < 0.002, "{sigma} {expected}");
    // Without it no reading to choose from holds a length: the fit would be refused, and so is its plan.
    let output = identify(&machine, &data, &[&FIT[..], &more[..4]].concat());
    assert!(output.status.code() == Some(1) && said(&output).contains("E0514"), "{}", said(&output));
}

#[test]
fn gauges_that_mislead_are_refused() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", MACHINE);
    let data = folder.write("balls.csv", &format!("{HEADER}{}", balls("", 300.0, [0.0, 299.97], 4, 1e-3)));
    for (words, said_of_it) in [
        ("distance b1 b9 = 300 mm 20 um", "`ball b1`, `ball b2`"),
        ("distance b1 = 300 mm 20 um", "does not name two points"),
        ("distance b1 b1 = 300 mm 20 um", "names one point twice"),
        ("distance b1 b2 300 mm 20 um", "has no distance"),
        ("distance b1 b2 = 300 mm", "no uncertainty"),
        ("distance b1 b2 = -300 mm 20 um", "not above zero"),
        ("distance b1 b2 = 300 mm 0 um", "not above zero"),
        ("distance b1 b2 = 300 mm -1 um", "not above zero"),
        ("distance b1 b2 = 300 mm 20 urad", "units of length"),
        ("distance b1 b2 = 300 20", "no uncertainty"),
        ("distance b1 b2 = 300 in 20 um", "not near the 300 mm"),
    ] {
        let output = identify(&machine, &data, &["--fit", "EXX:poly1", "--prior", words]);
        let text = said(&output).replace("\n", " ");
        assert!(output.status.code() == Some(1) && text.contains("E0516"), "{words}: {text}");
        assert!(text.contains(said_of_it), "{words}: {text}");
    }
    let far = ["--fit", "EXX:poly1", "--prior", "distance b1 b2 = 340 mm 20 um"];
    let text = said(&identify(&machine, &data, &far));
    assert!(text.contains("not near the 300 mm") && text.contains("plausible"), "{text}");
    let worn = folder.write("worn.yaml", &format!("{MACHINE}identify: {{ plausible: {{ length: 40 mm }} }}\n"));
    let text = said(&identify(&worn, &data, &far));
    assert!(!text.contains("E0516"), "{text}");
    let twice = ["--prior", "distance b1 b2 = 300 mm 20 um", "--prior", "distance b2 b1 = 300 mm 20 um"];
    let output = identify(&machine, &data, &[&FIT[..], &twice].concat());
    assert!(said(&output).contains("given twice"), "{}", said(&output));
    let text = run(&["explain", "E0516"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("distance b1 b2"));
}

/// Three balls on a line: the second gauge is measured by the first. Its residual is 30 um, known to the uncertainties
/// of both and of the balls.
#[test]
fn a_gauge_that_contradicts_the_readings_is_named() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", MACHINE);
    let third = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let y = cells[1].parse::<f64>().unwrap() + 200.0;
        format!("{},{y},{},b3,{},0,200,0\n", cells[0], cells[2], cells[4])
    };
    let two = balls("", 300.0, [0.0, 300.0], 16, 1e-3);
    let rows = format!("{two}{}", two.lines().filter(|line| line.contains(",b1,")).map(third).collect::<String>());
    let data = folder.write("balls.csv", &format!("{HEADER}{rows}"));
    let gauges = |length: &str| {
        let words = ["--prior", "distance b1 b2 = 300 mm 5 um", "--prior", length];
        identify(&machine, &data, &[&FIT[..], &words].concat())
    };
    let output = gauges("distance b1 b3 = 200.03 mm 5 um");
    let known = json(&output)["known"].as_array().unwrap().clone();
    let [scale, far] = [0, 1].map(|i| known[i]["deviations"].as_f64());
    assert!(scale.is_none(), "nothing else holds the scale: {known:?}");
    let of_balls = json(&output)["sigma_um"].as_f64().unwrap() / 4.0;
    let expected = -30.0 / (25.0 + 2.0 * of_balls * of_balls).sqrt();
    assert!((far.unwrap() / expected - 1.0).abs() < 0.02, "{far:?} {expected}");
    assert!((known[1]["found"].as_f64().unwrap() - 200.0).abs() < 2e-3, "{known:?}");
    assert!(said(&output).contains("W0502") && said(&output).contains("ball b3` is 200"), "{}", said(&output));
    let output = gauges("distance b1 b3 = 200.01 mm 5 um");
    assert!(!said(&output).contains("contradict"), "{}", said(&output));
}
