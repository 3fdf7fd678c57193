//! Imports inside the stages that are sorted into rooms: no circle of files, rooms in one direction, and no room that
//! imports its own stage's door.

use crate::tidy::{code_lines, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The rooms of `controller`: each may import those before it.
const ROOMS: [&str; 7] = ["manifest", "replay", "emit", "read", "kinematics", "certificate", "single_errors"];

/// A module: its path below `crate` and the imports of its file.
struct Module {
    path: Vec<String>,
    /// Paths of `use` declarations and paths within the code, as they are written.
    used: Vec<Vec<String>>,
    /// True if it has items of its own, false if only modules and imports.
    has_items: bool,
}

/// Splits at commas outside braces.
fn branches(list: &str) -> Vec<&str> {
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                found.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    found.push(&list[start..]);
    found.into_iter().map(str::trim).filter(|branch| !branch.is_empty()).collect()
}

/// Every path of a tree such as `crate::{a::B, c::{D, E as F}}`.
fn paths(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.split(" as ").next().unwrap().trim();
    let segments = |text: &str| text.split("::").map(|s| s.trim().to_owned()).filter(|s| !s.is_empty()).collect();
    let Some((head, rest)) = tree.split_once('{') else { return vec![segments(tree)] };
    let head: Vec<String> = segments(head);
    let list = rest.rsplit_once('}').map_or(rest, |(list, _)| list);
    branches(list).into_iter().flat_map(paths).map(|tail| [head.clone(), tail].concat()).collect()
}

/// Paths after `crate::`, `super::` and `abbe::` in code that is no `use`.
fn inline_paths(code: &str) -> Vec<Vec<String>> {
    let inner = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = code
        .split(|c: char| !inner(c))
        .filter(|w| ["crate::", "super::", "abbe::"].iter().any(|root| w.starts_with(root)));
    words.flat_map(paths).collect()
}

impl Module {
    fn of(file: &Path, text: &str) -> Self {
        let code: String = code_lines(text).map(|(_, line)| line.to_owned() + "\n").collect();
        let path = file.with_extension("");
        let mut path: Vec<String> =
            path.components().skip(1).map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        path.retain(|part| part != "mod");
        let (mut used, mut rest) = (Vec::new(), String::new());
        let mut lines = code.lines();
        while let Some(line) = lines.next() {
            let head = line.trim_start();
            let visible = head.strip_prefix("pub").map_or(head, |h| h.trim_start_matches(|c: char| c != ' ').trim());
            let Some(mut tree) = visible.strip_prefix("use ").map(str::to_owned) else {
                rest.push_str(line);
                rest.push('\n');
                continue;
            };
            while !tree.contains(';') {
                tree.push_str(lines.next().unwrap());
            }
            used.extend(paths(tree.split(';').next().unwrap()));
        }
        used.extend(inline_paths(&rest));
        let is_item = |line: &str| {
            let head = line.split(['(', '<', ' ']).find(|w| !w.is_empty() && !w.starts_with("pub")).unwrap_or("");
            ["fn", "struct", "enum", "impl", "trait", "type", "const", "static"].contains(&head)
        };
        Self { path, used, has_items: rest.lines().any(is_item) }
    }
}

type Modules = BTreeMap<PathBuf, Module>;

fn modules() -> Modules {
    sources().into_iter().map(|(file, text)| (file.clone(), Module::of(&file, &text))).collect()
}

/// The file of a module.
fn file_of<'a>(modules: &'a Modules, path: &[String]) -> Option<&'a PathBuf> {
    modules.iter().find(|(_, module)| module.path == path).map(|(file, _)| file)
}

/// Returns a path from the root of the crate; none for a path in another crate.
fn absolute(modules: &Modules, module: &Module, path: &[String]) -> Option<Vec<String>> {
    let ups = path.iter().take_while(|part| *part == "super").count();
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([&module.path[..], &path[1..]].concat()),
        "super" => Some([&module.path[..module.path.len().checked_sub(ups)?], &path[ups..]].concat()),
        child => {
            let own = [&module.path[..], &[child.to_owned()]].concat();
            file_of(modules, &own).map(|_| [&module.path[..], path].concat())
        }
    }
}

/// The file in which the thing at a path is defined, through the doors that hand it on.
fn defined(modules: &Modules, path: &[String]) -> Option<PathBuf> {
    let length = (1..=path.len()).rev().find(|length| file_of(modules, &path[..*length]).is_some())?;
    let file = file_of(modules, &path[..length])?;
    let Some(name) = path.get(length) else { return Some(file.clone()) };
    let module = &modules[file];
    let handed_on = module.used.iter().find(|used| used.last() == Some(name) && used.len() > 1);
    let handed_on = handed_on.and_then(|used| absolute(modules, module, used)).filter(|onward| onward != path);
    handed_on.map_or_else(|| Some(file.clone()), |onward| defined(modules, &onward))
}

/// Returns for each file of a stage the others of it that it imports.
fn edges(modules: &Modules, stage: &str) -> BTreeMap<PathBuf, BTreeSet<PathBuf>> {
    let of_stage = |file: &Path| file.starts_with(Path::new("src").join(stage));
    let imports = |module: &Module| -> BTreeSet<PathBuf> {
        let absolute = module.used.iter().filter_map(|path| absolute(modules, module, path));
        absolute.filter_map(|path| defined(modules, &path)).filter(|file| of_stage(file)).collect()
    };
    let with_items = modules.iter().filter(|(file, module)| of_stage(file) && module.has_items);
    with_items.map(|(file, module)| (file.clone(), imports(module))).collect()
}

/// Files that can be reached from one.
fn reached(edges: &BTreeMap<PathBuf, BTreeSet<PathBuf>>, from: &Path) -> BTreeSet<PathBuf> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
    while let Some(file) = open.pop() {
        open.extend(edges.get(&file).into_iter().flatten().filter(|next| found.insert((*next).clone())).cloned());
    }
    found
}

/// Sets of files each of which imports itself through the others, as paths below `src`.
fn circles(edges: &BTreeMap<PathBuf, BTreeSet<PathBuf>>) -> BTreeSet<Vec<String>> {
    let closure: BTreeMap<_, _> = edges.keys().map(|file| (file, reached(edges, file))).collect();
    let circle = |file: &PathBuf| -> Vec<String> {
        let both = closure[file].iter().filter(|other| closure.get(other).is_some_and(|back| back.contains(file)));
        both.map(|other| other.strip_prefix("src").unwrap().display().to_string()).collect()
    };
    edges.keys().map(circle).filter(|circle| circle.len() > 1).collect()
}

#[test]
fn no_stage_has_a_circle_of_files() {
    let modules = modules();
    let stages: BTreeSet<&str> = modules.values().map(|module| module.path[0].as_str()).collect();
    assert!(stages.len() > 20, "{stages:?}");
    let found: BTreeSet<Vec<String>> = stages.iter().flat_map(|stage| circles(&edges(&modules, stage))).collect();
    assert!(found.is_empty(), "files import one another in a circle: {found:#?}");
}

#[test]
fn rooms_of_the_controller_import_earlier_rooms_and_not_the_door() {
    let modules = modules();
    let room_of = |path: &[String]| ROOMS.iter().position(|room| path.get(1).is_some_and(|part| part == room));
    let mut wrong = Vec::new();
    for (file, module) in modules.iter().filter(|(_, module)| module.path[0] == "controller" && module.path.len() > 1) {
        let own = room_of(&module.path).unwrap_or_else(|| panic!("{}: no room of this name", file.display()));
        let absolute = module.used.iter().filter_map(|path| absolute(&modules, module, path));
        for path in absolute.filter(|path| path.len() > 1 && path[0] == "controller") {
            match room_of(&path) {
                Some(room) if room <= own => {}
                Some(_) => wrong.push(format!("{}: imports the later room `{}`", file.display(), path[1])),
                None => wrong.push(format!("{}: imports `{}` from the door", file.display(), path.join("::"))),
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the names of the library's stages that a module uses.
fn behind_the_facade(module: &Module) -> Vec<String> {
    let stage = |name: &str| Path::new("src").join(name).is_dir();
    let hidden = |path: &&Vec<String>| path[0] == "abbe" && path.len() > 2 && stage(&path[1]);
    module.used.iter().filter(hidden).map(|path| path.join("::")).collect()
}

#[test]
fn the_program_sees_nothing_of_the_library_but_its_facade() {
    let modules = modules();
    let program = |module: &Module| ["cli", "main"].contains(&module.path[0].as_str());
    let faces: Vec<_> = modules.iter().filter(|(_, module)| program(module)).collect();
    assert!(faces.iter().filter(|(_, module)| module.used.iter().any(|path| path[0] == "abbe")).count() > 20);
    let wrong: Vec<_> = faces
        .iter()
        .flat_map(|(file, module)| behind_the_facade(module).into_iter().map(move |path| (file, path)))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");

    let noticed = |text: &str| behind_the_facade(&Module::of(Path::new("src/cli/x.rs"), text)).len();
    assert_eq!(noticed("use abbe::{convert, text::{angle}};\nuse abbe::machine::Axis;\n"), 1);
    assert_eq!(noticed("use abbe::{Run, report::{Picture, page}};\nfn x(a: abbe::lower::Chain) {}\n"), 3);
    assert_eq!(noticed("fn x() { abbe::convert(a); abbe::results::Axis::y(); }\n"), 0);
}

#[test]
fn the_search_for_circles_notices() {
    let module = |file: &str, text: &str| (PathBuf::from(file), Module::of(Path::new(file), text));
    let with = |ring: &str| -> Modules {
        [
            module("src/s/mod.rs", "mod a;\nmod b;\nmod c;\npub use a::A;\npub(crate) use b::{B, Other as Renamed};\n"),
            module("src/s/a.rs", "use super::{\n    B,\n};\npub struct A(B);\n"),
            module("src/s/b.rs", "pub fn b() -> crate::s::c::C {}\n"),
            module("src/s/c.rs", ring),
        ]
        .into_iter()
        .collect()
    };
    assert!(circles(&edges(&with("pub struct C;\n"), "s")).is_empty());
    let ring = circles(&edges(&with("// use super::X;\nuse crate::s::A;\npub struct C(A);\n"), "s"));
    assert_eq!(ring.into_iter().collect::<Vec<_>>(), [["s/a.rs", "s/b.rs", "s/c.rs"].map(str::to_owned).to_vec()]);
    let nested = paths("crate::{a::B, c::{D, e::*}}").into_iter().map(|path| path.join("::")).collect::<Vec<_>>();
    assert_eq!(nested, ["crate::a::B", "crate::c::D", "crate::c::e::*"]);
}
