//! Tests: an option means the same in every verb, states its range and default, and stands in docs/options.md.

use super::arguments::{EFFORT, png, svg};
use super::global::GLOBAL;
use super::program::Cli;
use super::store::write::PictureKind;
use clap::builder::ValueParser;
use clap::{Arg, Command, CommandFactory};
use std::any::TypeId;
use std::collections::BTreeMap;

/// Names that are not the same in all verbs: the name, what differs, and why.
const APART: [(&str, &str, &str); 2] = [
    ("plane", "type", "a ball bar knows three planes of the workpiece frame"),
    ("accept", "type", "a fit asks for more than an import"),
];

/// Numbers that do nothing unless they are given.
const OPT_IN: [&str; 2] = ["folds", "goal"];

fn program() -> Command {
    let mut program = Cli::command();
    program.build();
    program
}

/// Options of all verbs that are listed, by name.
fn options(program: &Command) -> BTreeMap<String, Vec<(String, Arg)>> {
    let mut all: BTreeMap<String, Vec<(String, Arg)>> = BTreeMap::new();
    for verb in program.get_subcommands().filter(|verb| !verb.is_hide_set()) {
        for arg in verb.get_arguments().filter(|arg| !arg.is_hide_set() && !arg.is_global_set()) {
            let Some(name) = arg.get_long().filter(|name| *name != "help") else { continue };
            all.entry(name.to_owned()).or_default().push((verb.get_name().to_owned(), arg.clone()));
        }
    }
    for arg in program.get_arguments().filter(|arg| arg.is_global_set() && !arg.is_hide_set()) {
        if let Some(name) = arg.get_long() {
            all.entry(name.to_owned()).or_default().push(("all".to_owned(), arg.clone()));
        }
    }
    all
}

fn help(arg: &Arg) -> String {
    arg.get_help().map(ToString::to_string).unwrap_or_default()
}

fn values(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let possible: Vec<String> = arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    match (arg.get_action().takes_values(), possible.is_empty()) {
        (false, _) => String::new(),
        (_, true) => names.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(" "),
        (..) => possible.join("|"),
    }
}

fn is_number(arg: &Arg) -> bool {
    let own = arg.get_value_parser().type_id();
    let numbers = [
        TypeId::of::<u8>(),
        TypeId::of::<u16>(),
        TypeId::of::<u32>(),
        TypeId::of::<u64>(),
        TypeId::of::<usize>(),
        TypeId::of::<f64>(),
    ];
    arg.get_action().takes_values() && numbers.iter().any(|number| own == *number)
}

#[test]
fn a_name_means_the_same_in_every_verb() {
    let mut shared = 0;
    for (name, list) in options(&program()) {
        let (first_verb, first) = &list[0];
        shared += usize::from(list.len() > 1);
        assert!(!help(first).is_empty(), "--{name} of {first_verb} has no help");
        for (verb, arg) in &list[1..] {
            let apart = |what: &str| APART.iter().any(|(known, differs, _)| *known == name && *differs == what);
            let place = format!("--{name} of {first_verb} and {verb}");
            assert_eq!(help(arg), help(first), "{place}");
            assert_eq!(arg.get_value_names(), first.get_value_names(), "{place}");
            assert!(apart("type") || arg.get_value_parser().type_id() == first.get_value_parser().type_id(), "{place}");
            assert!(apart("type") || values(arg) == values(first), "{place}");
            let same = arg.get_default_values() == first.get_default_values();
            assert!(same || EFFORT.contains(&name.as_str()), "{place}: another default");
        }
    }
    assert!(shared > 20, "{shared}");
}

/// The range that a help states: `(1 to 1000)`.
fn range(help: &str) -> Option<(f64, f64)> {
    let inside = help.split('(').skip(1).filter_map(|rest| rest.split_once(')')).map(|(inside, _)| inside);
    inside.filter_map(|text| text.split_once(" to ")).find_map(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)))
}

fn accepts(parser: &ValueParser, text: &str) -> bool {
    let arg = Arg::new("n").long("n").allow_hyphen_values(true).value_parser(parser.clone());
    Command::new("x").arg(arg).try_get_matches_from(["x", &format!("--n={text}")]).is_ok()
}

#[test]
fn numbers_state_range_and_default_and_keep_the_range() {
    let mut checked = 0;
    for (name, list) in options(&program()) {
        for (verb, arg) in list.iter().filter(|(_, arg)| is_number(arg)) {
            let (help, parser) = (help(arg), arg.get_value_parser());
            let open = ["(above 0)", "(0 or more)", "(1 or more)"].iter().any(|words| help.contains(words));
            let shows_default = !arg.get_default_values().is_empty() && !arg.is_hide_default_value_set();
            assert!(
                shows_default || help.contains("[default: ") || OPT_IN.contains(&name.as_str()),
                "--{name} of {verb} has no default in: {help}"
            );
            let Some((low, high)) = range(&help) else {
                assert!(open, "--{name} of {verb} has no range in: {help}");
                continue;
            };
            checked += 1;
            assert!(accepts(parser, &low.to_string()) && accepts(parser, &high.to_string()), "--{name} of {verb}");
            assert!(!accepts(parser, &(high + 1.0).to_string()) && !accepts(parser, "-1"), "--{name} of {verb}");
            assert!(low == 0.0 || !accepts(parser, &(low - 1.0).to_string()), "--{name} of {verb}");
        }
    }
    assert!(checked > 15, "{checked}");
}

#[test]
fn global_options_stand_under_their_heading_in_every_verb() {
    let program = program();
    for verb in program.get_subcommands().filter(|verb| !verb.is_hide_set()) {
        for arg in verb.get_arguments().filter(|arg| !arg.is_hide_set()) {
            assert_eq!(arg.is_global_set(), arg.get_help_heading() == Some(GLOBAL), "{} {arg}", verb.get_name());
        }
    }
}

#[test]
fn a_picture_has_the_form_of_its_ending() {
    let kind = |picture: &super::arguments::PictureFile| picture.kind();
    for (text, of_svg, of_png) in [
        ("x.svg", Some(PictureKind::Svg), Some(PictureKind::Svg)),
        ("x.PNG", Some(PictureKind::Png), Some(PictureKind::Png)),
        ("folder.old/x", Some(PictureKind::Svg), Some(PictureKind::Png)),
        ("x.jpg", None, None),
        ("x.svg.txt", None, None),
        ("x.", None, None),
    ] {
        assert_eq!((kind(&svg(text).unwrap()), kind(&png(text).unwrap())), (of_svg, of_png), "{text}");
    }
}

/// The rows of docs/options.md.
fn rows() -> String {
    let row = |(name, list): (&String, &Vec<(String, Arg)>)| {
        let (_, first) = &list[0];
        let value = values(first);
        let value = if value.is_empty() { value } else { format!(" {value}") };
        let default = |arg: &Arg| {
            let values: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
            if arg.get_action().takes_values() && !arg.is_hide_default_value_set() {
                values.join(" ")
            } else {
                String::new()
            }
        };
        let mut by_default: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        list.iter().for_each(|(verb, arg)| by_default.entry(default(arg)).or_default().push(verb));
        let verbs = match by_default.len() {
            1 => list.iter().map(|(verb, _)| verb.clone()).collect::<Vec<_>>().join(", "),
            _ => list.iter().map(|(verb, arg)| format!("{verb} ({})", default(arg))).collect::<Vec<_>>().join(", "),
        };
        let default = if by_default.len() == 1 { default(first) } else { "by verb".to_owned() };
        let cells = [format!("`--{name}{value}`"), help(first), default, verbs].map(|cell| cell.replace('|', "\\|"));
        format!("| {} |\n", cells.join(" | "))
    };
    options(&program()).iter().map(row).collect()
}

#[test]
fn the_table_of_the_documents_is_that_of_the_program() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/options.md")).unwrap();
    let rows = rows();
    assert!(page.contains(&rows), "docs/options.md lacks the table:\n{rows}");
}
