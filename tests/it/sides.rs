//! Geometry that goes with the side of the bed: against files with every number written out by hand.

use crate::configs;
use crate::language::{read, silent};
use crate::program::{Folder, abbe, abbe_on, json, text};
use abbe::analysis::Work;
use abbe::analysis::budget::{Distribution, Draws, NODES, Statistic, bounds};
use abbe::analysis::enumerate::{Judge, Standing, Study, walks};
use abbe::analysis::{inverse, rest};
use abbe::diagnostic::{Rendering, render};
use abbe::lower::sensitivities_to;
use abbe::machine::{AxisName, Branch, ErrorId, Machine, Travel, machine_file};

const HEAD: &str = "abbe: 1\nmachine: M\n";

/// Five axes; `axes` are their entries.
fn five(chain: &str, axes: &str, rest: &str) -> String {
    format!("{HEAD}chain: \"{chain}\"\naxes:\n{axes}{rest}")
}

const LINEAR: &str = "  X: { travel: [0, 500], origin: [1, 2, 3] }\n  Y: { travel: [0, 450], origin: [4, 5, 6] }\n  \
                      Z: { travel: [-400, 0], origin: [7, 8, 9] }\n";
const TOOLS: &str = "tools:\n  short: { gauge: [250, 225, 10], length: 100 }\n  long: { gauge: [250, 225, 30], length: \
                     200 }\nworkpiece: { origin: [200, 190, -380] }\n";

fn origin(machine: &Machine, axis: &str) -> [f64; 3] {
    machine.axes()[machine.axis_index(axis).unwrap()].origin
}

fn codes(files: &[(&str, &str)]) -> Vec<&'static str> {
    read(files).1.iter().map(|d| d.code.id).collect()
}

#[test]
fn positions_are_relative_to_the_points_they_name() {
    for (from, expected) in [
        ("gauge", [251.0, 227.0, 13.0]),
        ("tip", [251.0, 227.0, -87.0]),
        ("workpiece", [201.0, 192.0, -377.0]),
        ("bed", [1.0, 2.0, 3.0]),
        ("Z", [8.0, 10.0, 12.0]),
        ("C", [301.0, 302.0, -297.0]),
    ] {
        let a = format!(
            "  A: {{ travel: [-90, 90], origin: {{ from: {from}, at: [1, 2, 3 mm] }} }}\n  C: {{ travel: continuous, \
             origin: [300, 300, -300] }}\n"
        );
        let chain = if from == "Z" { "w C' Y' b X Z A t" } else { "w C' A' Y' b X Z t" };
        let machine = silent(&[("m.yaml", &five(chain, &format!("{LINEAR}{a}"), TOOLS))]);
        assert_eq!(origin(&machine, "A"), expected, "{from}");
        // The default tool counts, whichever is in use.
        assert_eq!(origin(&machine.with_tool("long").unwrap(), "A"), expected);
    }
    // Without `at` it is the point itself, and references may follow each other.
    let chained = "  A: { travel: [-90, 90], origin: { from: C } }\n  C: { travel: continuous, origin: { from: workpiece, \
                   at: [0, 0, -5] } }\n";
    let machine = silent(&[("m.yaml", &five("w C' A' Y' b X Z t", &format!("{LINEAR}{chained}"), TOOLS))]);
    assert_eq!((origin(&machine, "A"), origin(&machine, "C")), ([200.0, 190.0, -385.0], [200.0, 190.0, -385.0]));
    // The workpiece on the table.
    let on_table = TOOLS.replace("[200, 190, -380]", "{ from: C, at: [0, 0, 40] }");
    let table = "  A: { travel: [-90, 90] }\n  C: { travel: continuous, origin: { from: A, at: [0, 0, -30] } }\n";
    let machine = silent(&[("m.yaml", &five("w C' A' Y' b X Z t", &format!("{LINEAR}{table}"), &on_table))]);
    assert_eq!(machine.workpiece(), [0.0, 0.0, 10.0]);
}

#[test]
fn references_in_a_circle_are_refused_with_every_place() {
    let circle = |a: &str, c: &str| {
        let axes = format!("{LINEAR}  A: {{ travel: [-90, 90], {a} }}\n  C: {{ travel: continuous, {c} }}\n");
        let (machine, diagnostics) = read(&[("m.yaml", &five("w C' A' Y' b X Z t", &axes, TOOLS))]);
        assert_eq!(machine.is_none(), diagnostics.is_refused());
        diagnostics.iter().find(|d| d.code == "E0413").map(|d| d.labels.len())
    };
    assert_eq!(circle("origin: { from: A }", "origin: [0, 0, 0]"), Some(1));
    assert_eq!(circle("origin: { from: C }", "origin: { from: A }"), Some(2));
    // Each in a block, so that no file by itself would notice.
    assert_eq!(circle("on_tool: { origin: { from: C } }", "on_workpiece: { origin: { from: A } }"), Some(2));
    assert_eq!(
        circle("on_tool: { origin: { from: C } }", "origin: [0, 0, 0], on_tool: { origin: { from: A } }"),
        Some(2)
    );
    assert_eq!(
        circle(
            "on_tool: { origin: { from: C } }",
            "on_tool: { origin: [0, 0, 1] }, on_workpiece: { origin: [0, 0, 2] }, origin: { from: A }"
        ),
        None
    );
    assert_eq!(circle("origin: { from: C }", "origin: [0, 0, 0]"), None);
}

const SIDED: &str = "  A:\n    travel: [-120, 30]\n    origin: [250, 225, -350]\n    on_tool:\n      origin: { from: \
                     gauge, at: [0, 0, 200] }\n      travel: [-100, 20]\n      direction: [1, 0, 1]\n      errors: { EXA: 7 um, \
                     EB0A: 1 urad, EYA: { polynomial: [1 um, 0.1 um/deg] } }\n  C: { travel: continuous, origin: [250, \
                     225, -380] }\n";
const ERRORS: &str = "errors: { EXA: 3 um, EZA: { points: [[-120, 1 um], [30, 2 um]] }, EXX: 2 um }\n";

#[test]
fn the_block_of_a_side_goes_over_the_plain_keys() {
    let sided = |chain: &str| format!("{}{ERRORS}", five(chain, &format!("{LINEAR}{SIDED}"), TOOLS));
    let table = silent(&[("m.yaml", &sided("w C' A' Y' b X Z t"))]);
    let head = silent(&[("m.yaml", &sided("w C' Y' b X Z A t"))]);
    let by_hand = |chain: &str, a: &str, errors: &str| {
        let c = "  C: { travel: continuous, origin: [250, 225, -380] }\n";
        silent(&[("m.yaml", &format!("{}errors: {{ {errors} }}\n", five(chain, &format!("{LINEAR}{a}{c}"), TOOLS)))])
    };
    let (plain, block) = (
        "  A: { travel: [-120, 30], origin: [250, 225, -350] }\n",
        "  A: { travel: [-100, 20], direction: [1, 0, 1], origin: [250, 225, 210] }\n",
    );
    let on_table = by_hand("w C' A' Y' b X Z t", plain, &ERRORS[10..ERRORS.len() - 3]);
    let more = "EXA: 7 um, EB0A: 1 urad, EYA: { polynomial: [1 um, 0.1 um/deg] }, EZA: { points: [[-120, 1 um], [30, 2 um]] }, EXX: 2 um";
    let in_head = by_hand("w C' Y' b X Z A t", block, more);
    let same = |a: &Machine, b: &Machine| {
        assert_eq!(a.axes(), b.axes());
        assert_eq!(a.volume(), b.volume());
        (0..5).for_each(|axis| assert_eq!(a.axis_errors(axis), b.axis_errors(axis), "{axis}"));
    };
    same(&table, &on_table);
    same(&head, &in_head);
    // Placed anew, and back.
    let sides = |machine: &Machine| machine.axes().iter().map(|a| (a.name.clone(), a.branch)).collect::<Vec<_>>();
    same(&table.rearranged(&sides(&head)).unwrap(), &in_head);
    same(&head.rearranged(&sides(&table)).unwrap(), &on_table);
    same(&table.rearranged(&sides(&head)).unwrap().rearranged(&sides(&table)).unwrap(), &on_table);
    // Written, read, and placed anew.
    for machine in [&table, &head] {
        let again = silent(&[("m.yaml", &machine_file(&machine.to_parts(), &[]))]);
        same(&again, machine);
        let other = if machine.axes() == table.axes() { &head } else { &table };
        let moved = again.rearranged(&sides(other)).unwrap();
        assert_eq!(moved.axes(), other.axes());
        let of = |machine: &Machine| {
            let a = machine.axis_index("A").unwrap();
            (-10..=2).map(|q| machine.component_values(a, &(f64::from(q) * 10.0).into())).collect::<Vec<_>>()
        };
        assert_eq!(of(&moved), of(other));
    }
}

#[test]
fn curves_cover_the_travel_of_their_side() {
    let with = |block: &str, chain: &str| {
        let axes = format!("{LINEAR}  A: {{ travel: [-30, 30], origin: [0, 0, 0], on_tool: {{ {block} }} }}\n");
        let errors = "errors: { EXA: { points: [[-30, 1 um], [30, 2 um]] } }\n";
        codes(&[("m.yaml", &format!("{}{errors}", five(chain, &axes, TOOLS)))])
    };
    for chain in ["w A' Y' b X Z t", "w Y' b X Z A t"] {
        let quiet = [""; 0];
        assert_eq!(with("origin: [0, 0, 0], travel: [-20, 10]", chain), quiet);
        assert_eq!(with("origin: [0, 0, 0], travel: [-40, 10]", chain), ["E0409"], "{chain}");
        assert_eq!(with("origin: [0, 0, 0], travel: [-40, 10], errors: { EXA: 5 um }", chain), quiet);
        assert_eq!(with("origin: [0, 0, 0], errors: { EXA: 5 }", chain), ["E0204"], "{chain}");
    }
}

#[test]
fn plain_keys_of_a_variant_displace_the_blocks_of_its_base() {
    let base = format!("{}{ERRORS}", five("w C' Y' b X Z A t", &format!("{LINEAR}{SIDED}"), TOOLS));
    let variant = |text: &str| {
        let text = format!("abbe: 1\nextends: base.yaml\n{text}");
        silent(&[("m.yaml", &text), ("base.yaml", &base)])
    };
    let a = |machine: &Machine| machine.axes()[machine.axis_index("A").unwrap()].clone();
    let error = |machine: &Machine| machine.component_values(machine.axis_index("A").unwrap(), &0.0.into())[0] * 1e3;
    let unchanged = variant("machine: V\n");
    assert_eq!((a(&unchanged).origin, a(&unchanged).travel), ([250.0, 225.0, 210.0], Travel::Range(-100.0, 20.0)));
    assert!((error(&unchanged) - 7.0).abs() < 1e-12);
    let moved = variant("axes: { A: { origin: [1, 2, 3] } }\n");
    assert_eq!((a(&moved).origin, a(&moved).travel), ([1.0, 2.0, 3.0], Travel::Range(-100.0, 20.0)));
    let shorter = variant("axes: { A: { travel: [-10, 10] } }\n");
    assert_eq!((a(&shorter).origin, a(&shorter).travel), ([250.0, 225.0, 210.0], Travel::Range(-10.0, 10.0)));
    let upright = variant("axes: { A: { direction: [1, 0, 0] } }\n");
    assert_eq!(a(&upright).direction, [1.0, 0.0, 0.0]);
    // Its own block holds over its own plain key; a position is replaced whole.
    let both = variant("axes: { A: { origin: [1, 2, 3], on_tool: { origin: { from: tip } } } }\n");
    assert_eq!(a(&both).origin, [250.0, 225.0, -90.0]);
    assert!((error(&variant("errors: { EXA: 11 um }\n")) - 11.0).abs() < 1e-12);
    assert!(
        (error(&variant("errors: { EXA: 11 um }\naxes: { A: { on_tool: { errors: { EXA: 13 um } } } }\n")) - 13.0)
            .abs()
            < 1e-12
    );
    assert_eq!(error(&variant("errors: { EXA: null }\n")), 0.0);
    // Another spelling would leave open which of them holds.
    let text = "abbe: 1\nextends: base.yaml\nerrors: { \"E_{XA}\": 11 um }\n";
    assert_eq!(codes(&[("m.yaml", text), ("base.yaml", &base)]), ["E0407", "E0407"]);
}

#[test]
fn an_axis_on_a_side_of_which_nothing_is_said_is_a_warning_with_the_line_to_write() {
    let base = crate::language::TRUNNION;
    let base = &base[..base.find("errors:").unwrap()];
    let base = base.replace("volume:", "#").replace("(S) ", "");
    let moved = |more: &str| format!("abbe: 1\nextends: base.yaml\nchain: \"w C' Y' b X Z A t\"\n{more}");
    let (machine, diagnostics) = read(&[("m.yaml", &moved("")), ("base.yaml", &base)]);
    assert!(machine.is_some());
    let shown = render(&diagnostics, Rendering::default());
    assert_eq!(diagnostics.iter().map(|d| d.code.id).collect::<Vec<_>>(), ["W0404"], "{shown}");
    assert!(shown.contains("230 mm from the tip") && shown.contains("base.yaml"), "{shown}");
    let help = diagnostics.iter().next().unwrap().help.clone().unwrap();
    let line = help.split('`').nth(3).unwrap();
    assert_eq!(line, "A: { on_tool: { origin: { from: gauge, at: [0, 0, -350] } } }");
    // The line changes no number and silences the warning; so does a plain origin in the variant.
    let said = silent(&[("m.yaml", &moved(&format!("axes: {{ {line} }}\n"))), ("base.yaml", &base)]);
    assert_eq!(said.axes(), machine.unwrap().axes());
    silent(&[("m.yaml", &moved("axes: { A: { origin: [0, 0, 7] } }\n")), ("base.yaml", &base)]);
    // In a file by itself the plain keys are of the side on which it has the axis.
    silent(&[("m.yaml", &base.replace("w C' A' Y' b X Z t", "w C' Y' b X Z A t"))]);
    // The plain travel is no statement of where the axis lies.
    assert_eq!(codes(&[("m.yaml", &moved("axes: { A: { travel: [-9, 9] } }\n")), ("base.yaml", &base)]), ["W0404"]);
    // A base without a chain is completed by its variant.
    let bare = base.replace("chain: \"w C' A' Y' b X Z t\"\n", "");
    silent(&[("m.yaml", &moved("")), ("base.yaml", &bare)]);
    // A reference to an axis on the other side.
    let hung = base.replace(
        "travel: continuous, origin: [250, 225, -380]",
        "travel: continuous, origin: { from: A, at: [0, 0, -30] }",
    );
    let text = moved("axes: { A: { on_tool: { origin: [0, 0, 0] } } }\n");
    let (_, diagnostics) = read(&[("m.yaml", &text), ("base.yaml", &hung)]);
    let shown = render(&diagnostics, Rendering::default());
    assert!(shown.contains("relative to axis `A`") && shown.matches("W0404").count() == 1, "{shown}");
}

#[test]
fn a_linear_axis_counts_only_if_something_turns_it() {
    let base = |errors: &str| format!("{}errors: {{ {errors} }}\n", five("w Y' b X Z t", LINEAR, TOOLS));
    let text = "abbe: 1\nextends: base.yaml\nchain: \"w X' Y' b Z t\"\n";
    for (errors, expected) in [
        ("EXX: 3 um, EB0X: 3 urad", &[][..]),
        ("EBX: 3 urad", &["W0404"]),
        ("EBX: { tolerance: 3 urad }", &["W0404"]),
        ("EBZ: 3 urad", &[]),
    ] {
        assert_eq!(codes(&[("m.yaml", text), ("base.yaml", &base(errors))]), expected, "{errors}");
    }
}

#[test]
fn every_machine_with_rotary_axes_says_both_sides() {
    let mut seen = 0;
    for (name, machine) in configs::all() {
        let rotary = machine.axes().iter().any(|axis| axis.unit() == "deg");
        if !rotary || name.starts_with("papers/") {
            continue;
        }
        seen += 1;
        for axis in machine.axes() {
            let both = &machine.geometry().axes[&axis.name];
            assert!(both.tool.stated && both.workpiece.stated, "{name}: {}", axis.name);
        }
        assert!(machine.unstated(|_| true).is_empty(), "{name}");
    }
    assert!(seen >= 14, "{seen}");
    // The swivel head pivots 200 mm above its gauge line, 320 mm above the tip.
    let head = configs::machine("variants/trunnion-swivel-head.yaml");
    assert_eq!((origin(&head, "A"), head.tool().tip), ([0.0, 0.0, 200.0], [0.0, 0.0, -120.0]));
}

#[test]
fn arrangements_have_the_geometry_that_a_variant_would_have() {
    let machine = configs::machine("trunnion.yaml");
    let folder = Folder::new("sides-arranged");
    for (step, walk) in walks(&machine, None, &[]).unwrap().iter().enumerate().step_by(19) {
        let table = step % 6;
        let moved = machine.rearranged(&walk.sides(&machine, table)).unwrap();
        let base = configs::folder().join("trunnion.yaml");
        let text_of = format!("abbe: 1\nextends: {}\nchain: \"{}\"\n", base.display(), moved.chain());
        let by_file = crate::loaded::machine(&folder.with("v.yaml", &text_of));
        assert_eq!((moved.axes(), moved.volume()), (by_file.axes(), by_file.volume()));
        assert_eq!((moved.workpiece(), moved.sides()), (by_file.workpiece(), by_file.sides()));
    }
}

/// Two linear and two rotary axes; errors of A depend on its side.
const SMALL: &str = "abbe: 1\nmachine: Small\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: { travel: [-400, 400], origin: [0, \
                     0, 0], on_workpiece: { origin: [0, 0, -50] } }\n  Y: { travel: [-400, 400], origin: [0, 0, 0], \
                     on_workpiece: { origin: [0, 0, -60] } }\n  Z: { travel: [-400, 400], origin: [0, 0, 0] , on_workpiece: \
                     { origin: [0, 0, -70] } }\n  A: { travel: [-90, 90], origin: [0, 0, -40], on_tool: { origin: { from: \
                     gauge, at: [0, 0, 150] }, travel: [-80, 85], errors: { EYA: { tolerance: 9 um }, EXA: { tolerance: \
                     1 um }, EY0A: 2 um } } }\n  C: { travel: continuous, origin: [0, 0, -60], on_tool: { origin: { from: \
                     A, at: [0, 0, 30] } } }\ntool: { gauge: [0, 0, 0], length: 120 }\nvolume: { X: [-50, 50], Y: [-50, \
                     50], Z: [-50, 50], A: [-40, 40] }\nerrors: { EYA: { tolerance: 3 um }, EY0A: { tolerance: 6 um }, EBX: \
                     { tolerance: 20 urad }, EX0C: { tolerance: 5 um }, EAC: { tolerance: 10 urad } }\n";

fn share(curve: &[f64], axis: &abbe::machine::Axis, position: f64) -> f64 {
    let (min, max) = axis.travel.interval();
    let along = if axis.travel == Travel::Continuous { (position - min).rem_euclid(360.0) } else { position - min };
    let x = along / (max - min) * (NODES - 1) as f64;
    let i = (x.floor() as usize).min(NODES - 2);
    curve[i] + (x - i as f64) * (curve[i + 1] - curve[i])
}

#[test]
fn budgets_of_arrangements_take_the_tolerances_of_the_side() {
    let machine = silent(&[("m.yaml", SMALL)]);
    let draws = Draws::new(9, Distribution::Uniform);
    let list = walks(&machine, None, &[]).unwrap();
    let judge = Judge::Budget { bounds: bounds(&machine, None), draws: draws.clone() };
    let study = Study::new(&machine, list.clone(), judge, Statistic::Max, &Work::random(&machine, 15, 4));
    let (mut judged, mut heads) = (0, 0);
    let round = study.round(0..3);
    for (step, walk) in list.iter().enumerate().step_by(5) {
        for (record, table) in round.step(step, None).iter().zip(&walk.tables) {
            let row = &record.row;
            if row.standing != Standing::Judged {
                continue;
            }
            let chain = machine.rearranged(&walk.sides(&machine, *table)).unwrap().chain().to_string();
            let base = SMALL.replace("w C' A' b X Y Z t", &chain);
            let by_file = read(&[("m.yaml", &base)]).0.unwrap();
            let limits = bounds(&by_file, None);
            let ids: Vec<ErrorId> = limits.iter().map(|bound| bound.error.clone()).collect();
            let mut values = [0.0_f64; 3];
            for pose in study.work().iter().filter_map(|t| inverse(&by_file, t, &rest(&by_file)).ok()) {
                let effects = sensitivities_to(&by_file, &pose, &ids);
                for (sample, value) in values.iter_mut().enumerate() {
                    let mut sum = nalgebra::Vector3::zeros();
                    for (s, bound) in effects.iter().zip(&limits) {
                        let axis = by_file.axis_index(s.error.axis.as_str()).unwrap();
                        let of = &by_file.axes()[axis];
                        let curve = || draws.curve(&s.error, sample, of.travel == Travel::Continuous);
                        let drawn = if s.error.is_location() {
                            draws.constant(&s.error, sample)
                        } else {
                            share(&curve(), of, pose[axis])
                        };
                        sum += s.deviation * (drawn * bound.tolerance);
                    }
                    *value = value.max(sum.norm() * 1e3);
                }
            }
            let largest = values.iter().copied().fold(0.0, f64::max);
            let um = record.values.iter().copied().fold(0.0, f64::max);
            assert!((um - largest).abs() < 1e-9 * largest, "{chain}: {um} {largest}");
            judged += 1;
            heads += usize::from(by_file.axes().iter().any(|a| a.name.as_str() == "A" && a.branch == Branch::Tool));
        }
    }
    println!("{judged} arrangements, A in the head in {heads}");
    assert!(judged > 20 && heads > 8, "{judged} {heads}");
}

#[test]
fn arrangements_whose_geometry_is_not_stated_are_ranked_apart_and_never_first() {
    let folder = Folder::new("sides-unstated");
    let silent_of_heads = SMALL.replace(", on_tool: { origin: { from: A, at: [0, 0, 30] } }", "");
    let path = folder.with("m.yaml", &silent_of_heads);
    let arguments = ["enumerate", text(&path), "--buildable", "no", "--poses", "15", "--samples", "20"];
    let result = json(&[&arguments[..], &["--format", "json"]].concat());
    let rows = |key: &str| result[key].as_array().unwrap().clone();
    let on_tool = |chain: &str| !chain.contains("C'");
    assert!(!rows("ranked").is_empty() && !rows("geometry_not_stated").is_empty());
    for row in rows("ranked").iter().chain(&rows("reach_less")) {
        assert!(!on_tool(row["chain"].as_str().unwrap()) && row["not_stated"].is_null(), "{row}");
    }
    for row in rows("geometry_not_stated") {
        assert!(on_tool(row["chain"].as_str().unwrap()) && row["rank"].is_null(), "{row}");
        assert_eq!(row["not_stated"], serde_json::json!(["C"]));
    }
    let groups = ["ranked", "reach_less", "geometry_not_stated", "cannot_turn_the_tool"];
    let total: usize = groups.iter().map(|group| rows(group).len()).sum();
    assert_eq!((total, &result["arrangements"]), (720, &720.into()));
    let shown = abbe(&arguments);
    assert!(shown.contains("geometry is not stated") && shown.contains("| C "), "{shown}");
    let csv = abbe(&[&arguments[..], &["--format", "csv"]].concat());
    assert_eq!(
        csv.lines().filter(|line| line.contains("geometry not stated")).count(),
        rows("geometry_not_stated").len()
    );
    // A class bounds the angles of linear axes, so that it matters where they lie.
    let linear = SMALL.replace(", on_workpiece: { origin: [0, 0, -60] }", "");
    let linear = &linear[..linear.rfind("errors: {").unwrap()];
    let path = folder.with("n.yaml", linear);
    let bare =
        ["enumerate", text(&path), "--poses", "15", "--samples", "20", "--format", "json", "--class", "production"];
    let result = json(&bare);
    for row in result["geometry_not_stated"].as_array().unwrap() {
        assert!(
            row["chain"].as_str().unwrap().contains("Y'") && row["not_stated"] == serde_json::json!(["Y"]),
            "{row}"
        );
    }
    assert!(result["ranked"].as_array().unwrap().iter().all(|row| !row["chain"].as_str().unwrap().contains("Y'")));
}

#[test]
fn show_says_what_holds_on_the_other_side() {
    let folder = Folder::new("sides-show");
    let path = folder.with("m.yaml", &SMALL.replace(" , on_workpiece: { origin: [0, 0, -70] }", ""));
    let chain = json(&["show", text(&path), "--format", "json"]);
    let axis = |name: &str| chain["axes"].as_array().unwrap().iter().find(|a| a["name"] == name).unwrap().clone();
    assert_eq!(axis("A")["other_side"]["origin_mm"], serde_json::json!([0.0, 0.0, 150.0]));
    assert_eq!(axis("A")["other_side"]["travel"], serde_json::json!([-80.0, 85.0]));
    // C alone in the head would hang on A, which is not there.
    assert!(axis("C")["other_side"].is_null() && axis("Z")["other_side"].is_null());
    assert!(chain["axes"].as_array().unwrap().iter().all(|a| a["geometry_stated"] == true));
    let shown = abbe(&["show", text(&path)]);
    assert!(shown.contains("A with the tool: origin 0, 0, 150 mm") && shown.contains("not stated: C, Z"), "{shown}");
    let moved = folder.with("v.yaml", "abbe: 1\nextends: m.yaml\nchain: \"w A' b X Y Z C t\"\n");
    let output = abbe_on(2, &["show", text(&moved)]);
    let (shown, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(shown.contains("on which it stands: C") && said.contains("W0404"), "{shown}{said}");
    assert!(AxisName::new("C").is_some());
}

#[test]
fn a_linear_axis_without_origin_is_a_warning_if_something_turns_it() {
    let with = |x: &str, errors: &str| {
        let axes = format!(
            "  X: {{ travel: [0, 500]{x} }}\n  Z: {{ travel: [-400, 0] }}\n  C: {{ travel: continuous, \
             origin: [0, 0, 0] }}\n"
        );
        let text = five("w C' b X Z t", &axes, &format!("tool: {{ length: 120 }}\nerrors: {{ {errors} }}\n"));
        let (_, diagnostics) = read(&[("m.yaml", &text)]);
        diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect::<Vec<_>>()
    };
    let silent = Vec::<String>::new();
    assert_eq!(with("", "EXX: 1 um, ECC: 3 urad, EB0Z: 3 urad"), silent);
    for errors in ["EBX: { polynomial: [0 urad, 9 urad/m] }", "EBX: { tolerance: 9 urad }"] {
        let said = with("", errors);
        assert!(said.len() == 1 && said[0].starts_with("W0405") && said[0].contains("120 mm from the tip"), "{said:?}");
        assert_eq!(with(", origin: [0, 0, 0]", errors), silent);
        assert_eq!(with(", on_tool: { origin: { from: tip } }", errors), silent);
    }
    let said = with(", on_workpiece: { origin: [0, 0, 0] }", "EBX: { tolerance: 9 urad }");
    assert!(said.len() == 1 && said[0].starts_with("W0404"), "{said:?}");
}

#[test]
fn a_class_that_bounds_the_angles_of_an_axis_without_origin_says_so() {
    let folder = Folder::new("sides-class");
    let text_of = "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: { X: { travel: [0, 9], origin: [0, 0, 0] }, Y: { travel: [0, \
                   9] }, Z: { travel: [0, 9] } }\n";
    let path = folder.with("m.yaml", text_of);
    let output = abbe_on(2, &["budget", text(&path), "--class", "production", "--samples", "4", "--poses", "4"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && said.matches("W0405").count() == 2 && !said.contains("axis `X`"), "{said}");
    let asked = String::from_utf8(abbe_on(2, &["check", text(&path)]).stderr).unwrap();
    assert!(asked.contains("no `tool`") && !asked.contains("W0405"), "{asked}");
}

#[test]
fn arms_bear_the_share_that_hangs_on_them() {
    let folder = Folder::new("sides-share");
    // One squareness of 20 urad at Y = 0..300 (mean of squares 300^2 / 3) and a pitch of 10 urad at an arm of 200 mm.
    let text_of = "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: { X: { travel: [0, 9], origin: [0, 0, 200] }, Y: { travel: [0, \
                   300] }, Z: { travel: [0, 0.001] } }\nerrors: { EC0Y: { tolerance: 20 urad }, EBX: { tolerance: 10 urad } }\n";
    let path = folder.with("m.yaml", text_of);
    let chain = json(&["show", text(&path), "--format", "json"]);
    let share = |i: usize| chain["axes"][i]["arm_mm"]["share"].as_f64().unwrap();
    let (square, pitch) = (20.0_f64.powi(2) * 300.0_f64.powi(2) / 3.0, 10.0_f64.powi(2) * 200.0_f64.powi(2));
    // 500 random poses.
    assert!((share(0) - pitch / (pitch + square)).abs() < 0.03, "{}", share(0));
    assert_eq!((share(1), share(2)), (0.0, 0.0));
    let shown = abbe(&["check", text(&path), "--quiet"]);
    assert!(shown.contains("  arms    X ") && shown.contains(" %)"), "{shown}");
}
