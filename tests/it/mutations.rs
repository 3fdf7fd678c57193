//! Every byte of a set, altered: without the set's manifest it changes what the files do, or is refused, or has no effect
//! by a rule that the readers state. The rules stand here once more ([`plain`]): comments, blanks, the way a number is
//! written, and labels ([`LABELS`]). What is left and read as before is a hole.

use std::path::{Path, PathBuf};

use abbe::compensation::CorrectionTables;
use abbe::controller::{ControllerTarget, KinematicsModule, ReadBack};
use abbe::diagnostic::Diagnostics;
use abbe::machine::Machine;

use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::support::controllers::Files;
use crate::support::{PARAMETER_TARGETS, compile};
use crate::{loaded, replays};

/// Content of a set as the program reads it.
#[derive(PartialEq)]
struct Content {
    module: Option<KinematicsModule>,
    tables: CorrectionTables,
}

/// Returns the content; none if the files are refused. Files of no table go along as they do from a folder.
fn content(target: &ControllerTarget, machine: &Machine, files: &Files) -> Option<Content> {
    let mut diagnostics = Diagnostics::default();
    let wanted = [target.table_files(machine), target.index_files(), target.code_files()].concat();
    let found = files.iter().filter(|(name, _)| wanted.contains(name));
    let texts: Vec<ReadBack> = found.map(|(name, text)| ReadBack::new(&**name, &**text)).collect();
    let module = match KinematicsModule::of(machine, target, false) {
        _ if !is_module(target) => None,
        Err(_) => return None,
        Ok(meant) => Some(target.read_kinematics(machine, &meant, &texts, &mut diagnostics)?),
    };
    let tables = match module {
        Some(_) => target.read_beside(machine, &texts, &mut diagnostics),
        None => target.read(machine, &texts, &mut diagnostics)?,
    };
    (!diagnostics.is_refused()).then_some(Content { module, tables })
}

fn is_module(target: &ControllerTarget) -> bool {
    let name = target.manifest.target.as_str();
    PARAMETER_TARGETS.contains(&name) || name.starts_with("linuxcnc-")
}

/// Lines of a target's file from whose beginning on they say nothing to the controller, or nothing about corrections.
const LABELS: [(&str, &str, &[&str]); 16] = [
    ("heidenhain-com", ".COM", &["BEGIN ", "NR_CELL"]),
    // The name of the table (that of another one is refused), and the numbers of rows.
    ("heidenhain-com", ".CMA", &["BEGIN ", "NR_CELL"]),
    // Travels, names of axes, and keys that LinuxCNC does not know.
    ("linuxcnc", ".inc", &["INI"]),
    ("isg-volcomp", "volcomp0.lis", &["enable_splicing "]),
    ("isg-volcomp", "hochlauf_part.lis", &["vol_comp[0].max_records "]),
    ("twincat-axis", ".lis", &["kopf.log_achs_name ", "kw.crosscomp.n_cycles ", "kw.crosscomp2.n_cycles "]),
    ("pmac", ".pmc", &["PMAC"]),
    ("reprapfirmware", "heightmap.csv", &["RepRapFirmware height map file v2 "]),
    ("sinumerik-cec", "_INI", &["CHANDATA("]),
    ("sinumerik-enc", "_INI", &["CHANDATA("]),
    ("sinumerik-tcarr", ".MPF", &["CHANDATA("]),
    // The name of the transformation; names of machine axes are said (W0717).
    ("sinumerik-chain", ".MPF", &["$NT_NAME[1]=\"", "$NK_AXIS["]),
    // For people, and for the bench.
    ("fanuc-pitch", "README.TXT", &[""]),
    ("fanuc-5axis", "README.TXT", &[""]),
    ("kmotion-geo", "README.txt", &[""]),
    ("linuxcnc-kins", "sim.", &[""]),
];

/// The marks that begin a comment in a file.
fn comments(target: &str, file: &str) -> &'static [&'static str] {
    match target {
        "sinumerik-cec"
        | "sinumerik-enc"
        | "sinumerik-traori"
        | "sinumerik-tcarr"
        | "sinumerik-chain"
        | "marlin"
        | "grbl"
        | "heidenhain-com"
        | "heidenhain-kinematics"
        | "haas-mrzp"
        | "pmac"
        | "fanuc-3d" => &[";"],
        "isg-volcomp" if file.ends_with(".csv") => &["//"],
        "etalon-exchange" => &["//"],
        "isg-volcomp" | "klipper" | "twincat-axis" => &["#"],
        "reprapfirmware" if file.ends_with(".g") => &[";"],
        "linuxcnc" if file.ends_with(".inc") => &["#", ";"],
        "fanuc-5axis" => &["("],
        "linuxcnc-kins" if file.ends_with(".hal") => &["# "],
        _ if target.starts_with("linuxcnc-") => &["#"],
        _ => &[],
    }
}

/// Settings of a volumetric compensation that the control has by itself.
const DEFAULTS: [&str; 5] =
    ["chain XYZ", "workpiece_axes 0", "alternative_model 0", "interpolation GRID", "file_format[0] ISG_CSV"];

/// What a text says: lines without comments and labels, numbers as they are, blanks as one.
fn plain(target: &str, file: &str, text: &str) -> Vec<String> {
    let labels: Vec<&str> = LABELS
        .iter()
        .filter(|(name, part, _)| *name == target && file.contains(part))
        .flat_map(|(.., labels)| *labels)
        .copied()
        .collect();
    // Other keys than these are the writer's.
    let grid = (target == "grid-json").then(|| serde_json::from_str::<serde_json::Value>(text).ok()).flatten();
    if let Some(grid) = grid {
        return vec![grid["columns"].to_string(), grid["rows"].to_string()];
    }
    let text =
        if target == "linuxcnc-kins" && !file.ends_with(".hal") { without_c_comments(text) } else { text.into() };
    let marks = comments(target, file);
    let c_code = target == "linuxcnc-kins" && file.ends_with(['h', 'p']);
    let mut all = Vec::new();
    let mut geometry = false;
    for line in text.lines() {
        let cut = marks.iter().filter(|_| !c_code).filter_map(|mark| line.find(mark)).min().unwrap_or(line.len());
        let mut line = line[..cut].trim();
        let written;
        if labels.contains(&"INI") {
            let known = ["COMP_FILE", "COMP_FILE_TYPE", "KINEMATICS", "JOINTS", "LINEAR_UNITS", "ANGULAR_UNITS"];
            let key = line.split('=').next().unwrap_or_default().trim();
            // A section without a key that is read, as [TRAJ] is here, says nothing either.
            let section = line.starts_with("[JOINT_") || line.starts_with("[KINS");
            if !section && !known.contains(&key) {
                continue;
            }
        }
        if labels.contains(&"NR_CELL") && line.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c)) {
            written = line.split_once(char::is_whitespace).map_or("", |(_, rest)| rest).to_owned();
            line = &written;
        }
        if let Some(label) = labels.iter().find(|label| line.starts_with(**label)) {
            line = label;
        }
        // A setting that is absent has its default.
        if target == "isg-volcomp" && file.contains("volcomp0.lis") && DEFAULTS.contains(&line) {
            continue;
        }
        // The length of the tool may be connected elsewhere.
        if target == "linuxcnc-trt" && line.starts_with("net tool-length ") {
            continue;
        }
        let mut line = numbers(line);
        if geometry {
            // What has an effect below 0.01 um is not compared: here, of errors below 100 urad, tenths of a millimetre.
            let rounded =
                |word: &str| word.parse().map_or_else(|_| word.to_owned(), |x: f64| format!("{:.0}", x.round() + 0.0));
            line = line.split(' ').map(rounded).collect::<Vec<_>>().join(" ");
        }
        geometry = line.starts_with("P0X");
        if labels.contains(&"PMAC") {
            // Who owns a table, and what is deleted before all of them.
            line = line.split_once(" DEFINE COMP").map_or(line.clone(), |(_, of)| format!(" DEFINE COMP{of}"));
            if line.contains(" DELETE ") {
                continue;
            }
        }
        if !line.is_empty() && !line.to_lowercase().contains("written by abbe") {
            all.push(line);
        }
    }
    if labels.contains(&"PMAC") {
        // Entries stand between blanks, commas or in lines of their own.
        return all.join(" ").replace(',', " ").split_whitespace().map(str::to_owned).collect();
    }
    all
}

fn without_c_comments(text: &str) -> String {
    let mut all = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        all.push_str(before);
        let Some((comment, behind)) = after.split_once("*/") else { return all + "unclosed" };
        all.extend(comment.chars().filter(|c| *c == '\n'));
        all.push(' ');
        rest = behind;
    }
    all + rest
}

/// A line with its numbers written in one way.
fn numbers(line: &str) -> String {
    let mut all = String::new();
    for word in line.split_whitespace() {
        let mut rest = word;
        while !rest.is_empty() {
            let is_part = |c: char| c.is_ascii_digit() || ".+-eE".contains(c);
            let end = rest.find(|c: char| !is_part(c)).unwrap_or(rest.len());
            match rest[..end].parse::<f64>() {
                Ok(number) if end > 0 => all.push_str(&format!("{:e}", number + 0.0)),
                _ if end > 0 => all.push_str(&rest[..end]),
                _ => {}
            }
            let other = rest[end..].chars().next().map_or(0, char::len_utf8);
            all.push_str(&rest[end..end + other]);
            rest = &rest[end + other..];
        }
        all.push(' ');
    }
    // Blanks beside a comma separate nothing.
    all.trim().replace(" ,", ",").replace(", ", ",")
}

/// Bytes that take the place of others.
const BYTES: &[u8] = b"0159-+.,; #X=%\n'\"";

/// An altered text; none if it is the same or no text.
fn altered(text: &str, at: usize, with: Option<u8>) -> Option<String> {
    let mut bytes = text.as_bytes().to_vec();
    match with {
        Some(byte) if bytes[at] == byte => return None,
        Some(byte) => bytes[at] = byte,
        None => drop(bytes.remove(at)),
    }
    String::from_utf8(bytes).ok()
}

fn machines(folder: &Folder) -> [PathBuf; 4] {
    let pivoting = "abbe: 1\nmachine: pivoting\nchain: \"w b X Y Z C B t\"\naxes:\n  X: { controller: 1, travel: [-300 mm, 300 mm] }\n  Y: { controller: 2, travel: [-200 mm, 200 mm] }\n  \
        Z: { controller: 3, travel: [0 mm, 300 mm] }\n  B: { controller: 4, travel: [-90 deg, 90 deg], direction: [0, -1, 0], origin: [0, 0, 250] }\n  C: { controller: 5, travel: continuous, origin: [0, 0, 250] }\n\
        errors:\n  EZ0B: 40 um\nvolume: { step: 300 mm, B: { step: 90 deg }, C: { step: 90 deg } }\n";
    let tilting = "abbe: 1\nmachine: tilting\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: { controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }\n  Y: { controller: 2, travel: [-150 mm, 150 mm], origin: [0, 0, 0] }\n  \
        Z: { controller: 3, travel: [-300 mm, 0 mm], origin: [0, 0, 0] }\n  A: { controller: 4, travel: [-90 deg, 30 deg], sense: direct, origin: [1, 2, -50] }\n  C: { controller: 5, travel: continuous, sense: direct, origin: [3, 4, -80] }\nerrors:\n  EX0C: 20 um\n  EY0A: -15 um\n";
    let max = "abbe: 1\nmachine: max\nchain: \"w C' b X Y Z B t\"\naxes:\n  X: { controller: 1, travel: [-300 mm, 300 mm] }\n  Y: { controller: 2, travel: [-200 mm, 200 mm] }\n  \
        Z: { controller: 3, travel: [0 mm, 300 mm] }\n  B: { controller: 4, travel: [-90 deg, 90 deg], direction: [0, -1, 0], origin: [0, 0, 250] }\n  C: { controller: 5, travel: continuous, origin: [0, 0, 0] }\n\
        errors:\n  EZ0B: 40 um\n";
    [
        replays::machine(folder, false),
        folder.write("tilting.yaml", tilting),
        folder.write("pivoting.yaml", pivoting),
        folder.write("max.yaml", max),
    ]
}

/// Holes of a target among altered files: all alterations, or so many of each file.
fn holes(folder: &Folder, name: &str, of_each: Option<usize>) -> Vec<String> {
    let [three, tilting, pivoting, max] = machines(folder);
    let path: &Path = match name {
        "linuxcnc-5axiskins" => &pivoting,
        "linuxcnc-maxkins" => &max,
        _ if PARAMETER_TARGETS.contains(&name) => &tilting,
        _ => &three,
    };
    let out = folder.path(name);
    let mut options = vec!["--accept-unverified", "--poses", "1", "--nodes", "64"];
    if matches!(name, "marlin" | "grbl" | "klipper" | "reprapfirmware") {
        options.extend(["--scale", "X=80,Y=80,Z=400"]);
    }
    compile(path, name, &out, &options).json();
    let machine = loaded::machine(path);
    let target = ControllerTarget::builtin(name).unwrap();
    let mut files = replays::files(&out);
    files.remove("abbe.lock.json");
    let sound = content(&target, &machine, &files).unwrap();
    let mut random = Random::new(20_261_126);
    let mut found = Vec::new();
    for file in files.keys() {
        let text = &files[file];
        let meant = plain(name, file, text);
        let step = |i: usize| (i / (BYTES.len() + 1), BYTES.get(i % (BYTES.len() + 1)).copied());
        let all = text.len() * (BYTES.len() + 1);
        let number = of_each.unwrap_or(all);
        for i in 0..number {
            let (at, with) = step(if of_each.is_some() { random.between(0.0, all as f64) as usize } else { i });
            let Some(changed) = altered(text, at, with) else { continue };
            let altered: Files =
                files.iter().map(|(n, t)| (n.clone(), if n == file { changed.clone() } else { t.clone() })).collect();
            let same = content(&target, &machine, &altered).is_some_and(|read| read == sound);
            if same && plain(name, file, &changed) != meant {
                let line = text[..at].matches('\n').count();
                let (old, new) = (text.lines().nth(line), changed.lines().nth(line));
                found.push(format!("{name} {file}:{}: {old:?} and {new:?} are the same", line + 1));
            }
        }
    }
    found
}

/// A sample of every file of every target.
#[test]
fn altered_bytes_change_something_or_are_refused() {
    let folder = Folder::new();
    let all: Vec<String> = abbe::controller::NAMES.iter().flat_map(|name| holes(&folder, name, Some(60))).collect();
    assert!(all.is_empty(), "{} holes:\n{}", all.len(), all.join("\n"));
}

/// Every byte of every file of every target; `ABBE_TARGET` chooses one.
#[test]
#[ignore = "soak: minutes"]
fn every_altered_byte_changes_something_or_is_refused() {
    let chosen = std::env::var("ABBE_TARGET").ok();
    let names = abbe::controller::NAMES.into_iter().filter(|name| chosen.as_deref().is_none_or(|one| one == *name));
    let folder = Folder::new();
    let all: Vec<String> = names.flat_map(|name| holes(&folder, name, None)).collect();
    assert!(all.is_empty(), "{} holes:\n{}", all.len(), all.join("\n"));
}
