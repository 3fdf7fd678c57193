//! The pages of the controls (docs/controls/*.md): each of their tables says which numbers a location error changes,
//! and by how much. Every error alone, compiled, changes these and no others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::kinematic_parameters::{head_head, head_table, table_table};
use crate::oracle::program::Folder;
use crate::support::compile;

/// Size of every error: 10 um, 10 urad.
const SIZE: f64 = 0.01;
const TILT: f64 = 1e-5;

/// A machine of a column: its text with errors, and those that it has.
type Kind = (fn(&str) -> String, &'static [&'static str]);

const OF_C: [&str; 4] = ["EX0C", "EY0C", "EA0C", "EB0C"];

fn kind(column: &str) -> Kind {
    match column {
        "table on table (A carries C)" => {
            (table_table, &["EX0C", "EY0C", "EA0C", "EB0C", "EY0A", "EZ0A", "EB0A", "EC0A", "EA0S", "EB0S"])
        }
        "table on table (B carries C)" => (
            |errors| table_table(errors).replace(" A' ", " B' ").replace("  A: {", "  B: {"),
            &["EX0C", "EY0C", "EA0C", "EB0C", "EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "head on head (C carries B)" => (
            |errors| head_head(errors).replace("direction: [0, 1, 1], ", ""),
            &["EX0C", "EY0C", "EA0C", "EB0C", "EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "head (B) and table (C)" => (
            |errors| head_table(errors).replace("sense: direct, ", ""),
            &["EX0C", "EY0C", "EA0C", "EB0C", "EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "table B" => (
            |errors| without_c(&table_table(errors)).replace("w C' A' Y'", "w B' Y'").replace("  A: {", "  B: {"),
            &["EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "head B" => (
            |errors| without_c(&head_head(errors)).replace("X Z C B", "X Z B").replace("direction: [0, 1, 1], ", ""),
            &["EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "`xyzac-trt-kins`" => {
            (trt_a, &["EX0C", "EY0C", "EA0C", "EB0C", "EY0A", "EZ0A", "EB0A", "EC0A", "EA0S", "EB0S"])
        }
        "`xyzbc-trt-kins`" => (
            |errors| trt_a(errors).replace(" A' ", " B' ").replace("  A: {", "  B: {"),
            &["EX0C", "EY0C", "EA0C", "EB0C", "EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "`5axiskins`" => (
            |errors| left_handed("w b X Y Z C B (S) t", errors),
            &["EX0C", "EY0C", "EA0C", "EB0C", "EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        "`maxkins`" => (
            |errors| left_handed("w C' b X Y Z B (S) t", errors),
            &["EX0C", "EY0C", "EA0C", "EB0C", "EX0B", "EZ0B", "EA0B", "EC0B", "EA0S", "EB0S"],
        ),
        other => panic!("no machine for the column {other}"),
    }
}

fn without_c(text: &str) -> String {
    let kept = text.lines().filter(|line| !line.starts_with("  C: {"));
    kept.map(|line| format!("{line}\n")).collect()
}

fn trt_a(errors: &str) -> String {
    let turned = table_table(errors).replace("w C' A' Y' b X Z", "w C' A' b X Y Z");
    ["  A: {", "  C: {"].into_iter().fold(turned, |text, axis| text.replace(axis, &format!("{axis} sense: direct,")))
}

fn left_handed(chain: &str, errors: &str) -> String {
    format!(
        "abbe: 1\nmachine: pivot\nchain: \"{chain}\"\naxes:\n  X: {{ travel: [-300 mm, 300 mm] }}\n  Y: {{ travel: [-300 mm, 300 mm] }}\n  \
         Z: {{ travel: [-300 mm, 0 mm] }}\n  C: {{ travel: [-200 deg, 200 deg] }}\n  \
         B: {{ travel: [-100 deg, 100 deg], direction: [0, -1, 0], origin: [0, 0, 250] }}\ntool: {{ length: 100 mm }}\nerrors:\n{errors}"
    )
}

/// A table of a page: its columns, and its cells by error.
struct Changes {
    columns: Vec<String>,
    rows: Vec<(Vec<String>, Vec<String>)>,
}

fn cells(line: &str) -> Vec<String> {
    line.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// Words between backticks.
fn quoted(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn tables(page: &str) -> Vec<Changes> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/controls").join(page)).unwrap();
    let mut found: Vec<Changes> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        if line.starts_with("| error |") {
            found.push(Changes { columns: cells(line)[1..].to_vec(), rows: Vec::new() });
            inside = true;
        } else if inside && line.starts_with("| `E") {
            let cells = cells(line);
            found.last_mut().unwrap().rows.push((quoted(&cells[0]), cells[1..].to_vec()));
        } else if !line.starts_with('|') {
            inside = false;
        }
    }
    found
}

/// The changes that a cell states: `24550[1]` +, `24560[1]` -.
fn stated(cell: &str, full: &dyn Fn(&str) -> String, size: f64) -> BTreeMap<String, f64> {
    if cell == "none" {
        return BTreeMap::new();
    }
    let one = |part: &str| {
        let (name, sign) = part.trim().rsplit_once(' ').unwrap_or_else(|| panic!("{cell}"));
        let sign = match sign {
            "+" => 1.0,
            "-" => -1.0,
            other => panic!("{other} in {cell}"),
        };
        (full(name.trim_matches('`')), sign * size)
    };
    // Commas stand in indices too.
    cell.replace("+, ", "+; ").replace("-, ", "-; ").split("; ").map(one).collect()
}

/// The numbers of a file by the control's names.
fn values(file: &Path) -> BTreeMap<String, f64> {
    let text = std::fs::read_to_string(file).unwrap();
    let bare = text.lines().map(|line| line.split([';', '#']).next().unwrap().trim());
    let pairs = bare
        .filter_map(|line| line.split_once('=').or_else(|| line.split_once("Q1M")).or_else(|| line.rsplit_once(' ')));
    let prefixes = ["$MC_TRAFO5_", "SETTING ", "N1"];
    let named = pairs.filter_map(|(name, value)| {
        let name = name.trim();
        let name = match prefixes.into_iter().find_map(|prefix| name.strip_prefix(prefix).map(|rest| (prefix, rest))) {
            Some(("N1", rest)) => format!("1{rest}"),
            Some((_, rest)) => rest.to_owned(),
            None => name.to_owned(),
        };
        Some((name, value.trim().parse().ok()?))
    });
    named.collect()
}

/// Checks the table of a page for a target. `full` makes the file's name of a number from the page's.
fn check(page: &str, which: usize, (target, file): (&str, &str), full: &dyn Fn(&str, &str) -> String) {
    let table = &tables(page)[which];
    let mut checked = 0;
    for (k, column) in table.columns.iter().enumerate() {
        let (text, errors) = kind(column);
        let folder = Folder::new();
        let target = if target == "linuxcnc" {
            match column.as_str() {
                "`5axiskins`" => "linuxcnc-5axiskins",
                "`maxkins`" => "linuxcnc-maxkins",
                _ => "linuxcnc-trt",
            }
        } else {
            target
        };
        let run = |errors: &str| {
            let (machine, out) = (folder.write("machine.yaml", &text(errors)), folder.path("out"));
            let _ = compile(&machine, target, &out, &["--accept-unverified", "--poses", "2"]).json();
            let file = if file.is_empty() { format!("{}.hal", &target["linuxcnc-".len()..]) } else { file.to_owned() };
            values(&out.join(file))
        };
        let nominal = run(&format!("  {}: 0 um\n", errors.iter().find(|name| &name[1..2] > "W").unwrap()));
        let mut met = BTreeSet::new();
        for (names, cells) in &table.rows {
            for name in names {
                let Some(own) = errors.iter().find(|own| *own == name) else {
                    assert_eq!(cells[k], "", "{page}: {column} has no {name}");
                    continue;
                };
                let (unit, size) = if &own[1..2] > "W" { ("um", SIZE) } else { ("urad", TILT) };
                let with = run(&format!("  {own}: 10 {unit}\n"));
                assert_eq!(with.keys().collect::<Vec<_>>(), nominal.keys().collect::<Vec<_>>());
                let moved = with.iter().map(|(name, value)| (name.clone(), value - nominal[name]));
                let moved: BTreeMap<String, f64> = moved.filter(|(_, by)| by.abs() > 1e-9).collect();
                let wanted = stated(&cells[k], &|name| full(name, column), size);
                assert_eq!(
                    moved.keys().collect::<Vec<_>>(),
                    wanted.keys().collect::<Vec<_>>(),
                    "{page}: {column}: {own}"
                );
                assert!(
                    wanted.iter().all(|(name, by)| (moved[name] - by).abs() < 2e-9),
                    "{page}: {column}: {own} {moved:?}"
                );
                assert!(met.insert(*own), "{page}: {column}: {own} twice");
                checked += 1;
            }
        }
        assert_eq!(met, errors.iter().copied().collect(), "{page}: {column}");
    }
    assert!(checked >= 20, "{page}: {checked}");
}

#[test]
fn sinumerik() {
    let page = "sinumerik.md";
    assert!(tables(page).iter().all(|table| table.rows.iter().take(4).map(|row| row.0[0].as_str()).eq(OF_C)));
    let data = |name: &str, _: &str| {
        let names = [
            ("24500", "PART_OFFSET"),
            ("24550", "BASE_TOOL"),
            ("24558", "JOINT_OFFSET_PART"),
            ("24560", "JOINT_OFFSET"),
            ("24570", "AXIS1"),
            ("24572", "AXIS2"),
            ("24574", "BASE_ORIENT"),
        ];
        let (number, index) = name.split_once('[').unwrap();
        format!("{}_1[{index}", names.iter().find(|(known, _)| *known == number).unwrap().1)
    };
    check(page, 0, ("sinumerik-traori", "TRAORI.INI"), &data);
    check(page, 1, ("sinumerik-tcarr", "TCARR.MPF"), &|name, _| format!("$TC_CARR{name}[1]"));
    let element = |name: &str, _: &str| match name.strip_prefix("BASE_ORIENT[") {
        Some(index) => format!("$NT_BASE_ORIENT[1,{index}"),
        None => format!("$NK_OFF_DIR{name}"),
    };
    check(page, 2, ("sinumerik-chain", "CHAIN.MPF"), &element);
}

#[test]
fn fanuc_and_heidenhain_and_haas() {
    let same = |name: &str, _: &str| name.to_owned();
    check("fanuc.md", 0, ("fanuc-5axis", "TCP.PRM"), &same);
    check("heidenhain.md", 0, ("heidenhain-kinematics", "kinematics.txt"), &same);
    check("haas.md", 0, ("haas-mrzp", "settings.txt"), &same);
}

#[test]
fn linuxcnc() {
    let pin = |name: &str, column: &str| format!("setp {}.{name}", column.trim_matches('`'));
    check("linuxcnc.md", 0, ("linuxcnc", ""), &pin);
}
