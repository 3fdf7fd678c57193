//! The data sheet of a rotary table: its positioning by letter, with the words of the sheet, beside bounds across it.

use super::language::read;
use super::program::{Folder, json, text};
use serde_json::Value;

fn machine(axes: &str, tolerances: &str) -> String {
    let head = "abbe: 1\nmachine: Table\nchain: \"w C' b X Y Z t\"\naxes:\n";
    let linear = [("X", "[0, 500]"), ("Y", "[0, 400]"), ("Z", "[-300, 0]")];
    let linear = linear.map(|(name, travel)| format!("  {name}: {{ travel: {travel}, origin: [0, 0, 0] }}\n")).concat();
    let rest = "tool: { gauge: [250, 200, 0], length: 100 mm }\nworkpiece: { origin: [250, 200, -300] }\n";
    format!("{head}{linear}{axes}\n{rest}tolerances:\n{tolerances}\n")
}

const UPRIGHT: &str = "  C: { travel: continuous, origin: [250, 200, -300] }";
const ACROSS: &str = "across: 3 um, about_across: 10 urad";

fn budget(folder: &Folder, tolerances: &str, more: &[&str]) -> Value {
    let file = folder.with("m.yaml", &machine(UPRIGHT, tolerances));
    json(&[&["budget", text(&file), "--format", "json", "--quiet", "--samples", "200"], more].concat())
}

fn without_letter(mut of: Value) -> Value {
    let _ = of.as_object_mut().unwrap().remove("inputs");
    for one in of["tighten"].as_array_mut().unwrap() {
        let _ = one.as_object_mut().unwrap().remove("by_letter");
    }
    of
}

/// The angle about C is one angle, whether it is named by its letter or as along the axis.
#[test]
fn the_letter_along_an_axis_stands_beside_what_is_across() {
    let folder = Folder::new("rotary-sheet");
    for more in [&[][..], &["--class", "production"]] {
        let letter = budget(&folder, &format!("  ECC: {{ A: 12 arcsec }}\n  C: {{ {ACROSS} }}"), more);
        let along = budget(&folder, &format!("  C: {{ {ACROSS}, about_along: {{ A: 12 arcsec }} }}"), more);
        assert!(letter["contributions"].as_array().is_some_and(|list| list.len() >= 5), "{letter}");
        assert_eq!(without_letter(letter), without_letter(along), "{more:?}");
    }
}

#[test]
fn other_letters_exclude_what_is_across() {
    let codes = |axes: &str, tolerances: &str| -> Vec<&'static str> {
        read(&[("m.yaml", &machine(axes, tolerances))]).1.iter().map(|d| d.code.id).collect()
    };
    let quiet: [&str; 0] = [];
    let oblique = "  C: { travel: continuous, direction: [0, 1, 1], origin: [250, 200, -300] }";
    let carried =
        "  C: { travel: continuous, origin: [250, 200, -300], on_tool: { direction: [0, 1, 0], origin: [0, 0, 0] } }";
    assert_eq!(codes(UPRIGHT, &format!("  ECC: {{ P: 12 arcsec }}\n  C: {{ {ACROSS} }}")), quiet);
    assert_eq!(codes(UPRIGHT, "  EXX: { A: 8 um }\n  X: { across: 3 um }"), quiet);
    assert_eq!(codes(UPRIGHT, "  ECC: 9 urad\n  C: { about_along: 10 urad }"), ["E0407"]);
    assert_eq!(codes(UPRIGHT, "  EAC: 9 urad\n  C: { about_across: 10 urad }"), ["E0407"]);
    assert_eq!(codes(UPRIGHT, "  EAC: 9 urad\n  C: { about_along: 10 urad }"), ["E0407"]);
    for axes in [oblique, carried] {
        assert!(codes(axes, "  ECC: 9 urad\n  C: { about_across: 10 urad }").contains(&"E0407"), "{axes}");
    }
}
