//! The minimal set of location errors, and the output of `show`.

use crate::configs::{all, machine};
use crate::program::{Folder, abbe, abbe_on, available, json, refused, text, well_formed};
use abbe::analysis::{LocationSet, Status};
use abbe::machine::AxisKind;
use std::process::Command;

fn names(set: &LocationSet) -> Vec<String> {
    set.members.iter().map(|(id, _)| id.to_string()).collect()
}

#[test]
fn the_sets_are_those_of_the_field() {
    let set = |name: &str| names(&LocationSet::of(&machine(name))).join(" ");
    assert_eq!(set("vmc-cframe-754.yaml"), "EC0Y EB0Z EA0Z EA0S EB0S");
    assert_eq!(set("trunnion.yaml"), "EC0Y EB0Z EA0Z EX0C EY0C EA0C EB0C EY0A EZ0A EB0A EC0A");
    assert_eq!(set("ht-b-c.yaml"), "EC0Y EB0Z EA0Z EX0C EY0C EA0C EB0C EX0B EZ0B EA0B EC0B EA0S EB0S");
}

#[test]
fn their_size_is_the_rule_of_the_field() {
    for (name, machine) in all() {
        if name.starts_with("papers") {
            continue; // Other conventions, and a chain of one axis.
        }
        let of = |kind| machine.axes().iter().filter(|axis| axis.kind == kind).count();
        let spindle = 2 * usize::from(machine.chain().spindle().is_some());
        let linear = of(AxisKind::Linear);
        let expected = 3 + 2 * linear.saturating_sub(3) + 4 * of(AxisKind::Rotary) + spindle;
        let set = LocationSet::of(&machine);
        println!(
            "{name}: {:?} besides {:?}",
            set.members.iter().map(|(id, s)| format!("{id} {s:?}")).collect::<Vec<_>>(),
            set.besides
        );
        assert_eq!(set.members.len(), expected, "{name}: {:?}", names(&set));
    }
}

#[test]
fn what_the_file_gives_is_told_from_what_it_lacks() {
    let set = LocationSet::of(&machine("trunnion.yaml"));
    assert!(set.members.iter().all(|(_, status)| *status == Status::Given), "{set:?}");
    let bare = LocationSet::of(&machine("trunnion.yaml").filtered(|id| id.to_string() != "EX0C"));
    let missing: Vec<_> =
        bare.members.iter().filter(|(_, s)| *s == Status::Missing).map(|(id, _)| id.to_string()).collect();
    assert_eq!(missing, ["EX0C"]);
}

#[test]
fn the_chain_is_drawn_for_every_config() {
    let folder = Folder::new("chains");
    for name in crate::configs::names() {
        let svg = folder.file("chain.svg");
        let output = abbe_on(1, &["show", &name, "--svg", text(&svg), "--quiet"]);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let picture = std::fs::read_to_string(&svg).unwrap();
        well_formed(&picture).unwrap_or_else(|why| panic!("{name}: {why}"));
        let machine = machine(&name);
        for axis in machine.axes() {
            let prime = if axis.branch == abbe::machine::Branch::Workpiece { "′" } else { "" };
            assert!(picture.contains(&format!(">{}{prime}</text>", axis.name)), "{name}: {}", axis.name);
        }
    }
}

#[test]
fn graphviz_takes_the_dot_of_every_config() {
    let present = available("dot", "DOT of every config against Graphviz");
    let folder = Folder::new("dot");
    for name in crate::configs::names() {
        let output = abbe_on(1, &["show", &name, "--dot", "--quiet"]);
        let dot = String::from_utf8(output.stdout).unwrap();
        assert!(dot.starts_with("digraph chain {") && dot.ends_with("}\n"), "{name}");
        let machine = machine(&name);
        assert_eq!(dot.matches(" -> ").count(), machine.chain().graph().edge_count(), "{name}");
        if present {
            let file = folder.with("chain.dot", &dot);
            let run = Command::new("dot").args(["-Tplain", text(&file)]).output().unwrap();
            let plain = String::from_utf8_lossy(&run.stdout).into_owned();
            assert!(run.status.success() && run.stderr.is_empty(), "{name}: {}", String::from_utf8_lossy(&run.stderr));
            let nodes = plain.lines().filter(|line| line.starts_with("node ")).count();
            assert_eq!(nodes, machine.chain().graph().node_count(), "{name}");
        }
    }
}

#[test]
fn show_prints_what_the_machine_is() {
    let shown = abbe(&["show", "trunnion.yaml"]);
    for part in [
        "w C' A' Y' b X Z t",
        "workpiece origin   250, 225, -380 mm",
        "functional point 0, 0, -120 mm",
        "axis_only",
        "(11)",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    let shown = json(&["show", "trunnion.yaml", "--format", "json"]);
    // The tip at the zero pose is 230 mm above A and 260 mm above C, 250 mm and 225 mm beside them.
    let arm = |name: &str| {
        let axes = shown["axes"].as_array().unwrap().iter().find(|axis| axis["name"] == name).unwrap();
        axes["arm_mm"]["at_zero"].as_f64().unwrap()
    };
    let away = |above: f64| 250_f64.hypot(225.0).hypot(above);
    assert!((arm("A") - away(230.0)).abs() < 1e-9 && (arm("C") - away(260.0)).abs() < 1e-9);
    assert_eq!(refused(&["show", "trunnion.yaml", "--dot", "--format", "json"]).0, 2);
    assert_eq!(abbe(&["show", "trunnion.yaml", "--format", "csv"]).lines().count(), 6);
}

#[test]
fn init_writes_a_machine_that_is_fine_and_never_overwrites() {
    let folder = Folder::new("init");
    for kind in ["three-axis", "vertical-rotary", "trunnion", "head-table", "head-head"] {
        let file = folder.file(&format!("{kind}.yaml"));
        abbe(&["init", "--from", kind, text(&file), "--quiet"]);
        let written = std::fs::read(&file).unwrap();
        assert!(written.starts_with(b"# yaml-language-server: $schema="));
        abbe(&["check", text(&file)]);
        let map = json(&["map", text(&file), "--format", "json"]);
        assert!(map["position_um"]["max"].as_f64().unwrap() > 1.0, "{kind}");
        let shown = json(&["show", text(&file), "--format", "json"]);
        let missing =
            shown["location_errors"]["set"].as_array().unwrap().iter().filter(|m| m["status"] != "given").count();
        assert_eq!(missing, 0, "{kind}");
        let (code, message) = refused(&["init", text(&file)]);
        assert!(code == 1 && message.contains("E0811"), "{message}");
        assert_eq!(std::fs::read(&file).unwrap(), written);
    }
}

#[test]
fn a_stated_uncertainty_is_a_band_about_the_curve_and_changes_no_result() {
    let folder = Folder::new("uncertainty");
    let machine = |name: &str, more: &str, location: &str| {
        folder.with(
            name,
            &format!(
                "abbe: 1\nmachine: m\nchain: w b X Y Z t\naxes: {{ X: {{ travel: [0, 400], origin: [0, 0, 0] }}, Y: {{ travel: [0, 400], origin: [0, 0, 0] }}, Z: {{ travel: [0, 400], origin: [0, 0, 0] }} }}\nerrors:\n  EXX: {{ points: [[0 mm, 1 um], [400 mm, 1 um]]{more} }}\n  EC0Y: {location}\n"
            ),
        )
    };
    let sure = machine("sure.yaml", ", uncertainty: 0.5 um", "{ value: 12 urad, uncertainty: 2 urad }");
    let plain = machine("plain.yaml", "", "12 urad");
    let curves = |machine: &std::path::Path| {
        let svg = folder.file("c.svg");
        abbe(&["show", text(machine), "--curves", text(&svg)]);
        std::fs::read_to_string(svg).unwrap()
    };
    let drawn = curves(&sure);
    assert!(!curves(&plain).contains("class=\"band\"") && drawn.contains("positioning, U = 0.5"));
    // The band of a constant curve is a rectangle: 1 um from edge to edge where the curve itself is 1 um from zero.
    let ys = |path: &str| -> Vec<f64> {
        let data = path.split('"').next().unwrap();
        data.split(['M', 'L', 'Z'])
            .filter(|p| !p.is_empty())
            .map(|p| p.split(' ').nth(1).unwrap().parse().unwrap())
            .collect()
    };
    let band = drawn.split("<path d=\"").find(|path| path.contains("class=\"band\"")).unwrap();
    let line = drawn.split("<path d=\"").skip(1).find(|path| !path.contains("class=\"band\"")).unwrap();
    let (low, high) = ys(band).iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
    let middle = ys(line)[0];
    assert!(((high - middle) - (middle - low)).abs() < 0.02 && high - low > 20.0, "{low} {middle} {high}");
    let result = |machine: &std::path::Path| {
        json(&["eval", text(machine), "--at", "X=100,Y=200", "--format", "json"])["poses"].clone()
    };
    let (mut stated, without) = (result(&sure), result(&plain));
    // 0.5 um along X, and 2 urad of squareness over 200 mm.
    let reach = stated[0]["uncertainty"]["deviation"][0].as_f64().unwrap();
    assert!((reach - (0.5e-3_f64.powi(2) + 0.4e-3_f64.powi(2)).sqrt()).abs() < 1e-15, "{reach}");
    assert!(stated[0].as_object_mut().unwrap().remove("uncertainty").is_some());
    assert_eq!(stated, without);
    let page = folder.file("page.html");
    abbe(&["report", text(&sure), "--poses", "10", "--out", text(&page)]);
    let page = std::fs::read_to_string(page).unwrap();
    let data = crate::support::packed::data(&page).to_string();
    assert!(data.contains("\"uncertainty\":2.0") && page.contains("class=\"band\""), "{data}");
    let wrong = machine("negative.yaml", ", uncertainty: -0.5 um", "12 urad");
    let (code, message) = refused(&["check", text(&wrong)]);
    assert!(code == 1 && message.contains("E0411") && message.contains("uncertainty"), "{message}");
    let wrong = machine("both.yaml", "", "{ tolerance: 12 urad, uncertainty: 1 urad }");
    let (code, message) = refused(&["check", text(&wrong)]);
    assert!(code == 1 && message.contains("E0209"), "{message}");
    let wrong = machine("unit.yaml", ", uncertainty: 0.5 urad", "12 urad");
    assert_eq!(refused(&["check", text(&wrong)]).0, 1);
}
