//! House rules that are facts about the tree: direction of imports, sizes, no printing, clock or file
//! access in the library, codes of one table.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Imports of each module besides itself; `units`, `diagnostic` and `algebra` are open to all, `run` to all above
/// `syntax`. The program has the library as a package: `rooms.rs` holds it to the façade.
const MAY_IMPORT: [(&str, &[&str]); 23] = [
    ("units", &[]),
    ("diagnostic", &["units"]),
    ("algebra", &[]),
    ("syntax", &["units", "diagnostic"]),
    ("run", &["syntax"]),
    ("machine", &["syntax"]),
    ("mesh", &["syntax"]),
    ("lower", &["machine"]),
    ("evaluate", &["lower", "machine"]),
    ("standards", &["machine", "syntax"]),
    ("analysis", &["evaluate", "lower", "machine", "standards"]),
    ("convert", &["evaluate", "lower", "machine"]),
    ("job", &["analysis", "evaluate", "lower", "machine", "syntax"]),
    ("identify", &["analysis", "evaluate", "job", "lower", "machine", "standards", "syntax"]),
    ("compensation", &["evaluate", "lower", "machine"]),
    ("controller", &["compensation", "evaluate", "lower", "machine", "syntax"]),
    ("file_set", &["compensation", "controller", "evaluate", "job", "machine", "syntax"]),
    (
        "report",
        &["analysis", "compensation", "controller", "evaluate", "identify", "job", "machine", "standards", "syntax"],
    ),
    ("shards", &["analysis", "syntax"]),
    ("record", &["controller", "file_set", "job", "machine", "report", "standards", "syntax"]),
    (
        "api",
        &[
            "analysis",
            "compensation",
            "controller",
            "convert",
            "evaluate",
            "file_set",
            "identify",
            "job",
            "lower",
            "machine",
            "mesh",
            "record",
            "report",
            "shards",
            "standards",
            "syntax",
        ],
    ),
    ("wire", &["*"]),
    ("cli", &[]),
];

const OPEN_TO_ALL: [&str; 4] = ["units", "diagnostic", "algebra", "run"];

/// Stages below `run`.
const BELOW_RUN: [&str; 4] = ["units", "diagnostic", "algebra", "syntax"];

const MAX_FILE_LINES: usize = 800;
const MAX_COLUMNS: usize = 120;
const MAX_FUNCTION_LINES: usize = 100;

/// All files with an ending below a folder.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            found.extend(files(&entry, ending));
        } else if entry.extension().is_some_and(|e| e == ending) {
            found.push(entry);
        }
    }
    found.sort();
    found
}

/// Source files with their text, tests at the foot cut off.
pub fn sources() -> Vec<(PathBuf, String)> {
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap().to_owned();
        (path, code)
    };
    files(Path::new("src"), "rs").into_iter().map(read).filter(|(path, _)| !path.ends_with("tests.rs")).collect()
}

/// The top-level module a file belongs to.
fn module(path: &Path) -> String {
    path.components().nth(1).unwrap().as_os_str().to_string_lossy().trim_end_matches(".rs").to_owned()
}

/// Code without comments and attributes' strings: the part after `//` on a line is dropped.
pub fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(n, line)| (n + 1, line.split("//").next().unwrap_or("")))
}

/// Names after `crate::` in a piece of code, also within `use crate::{a, b}`.
fn imported(text: &str) -> Vec<String> {
    let code: String = code_lines(text).map(|(_, line)| line.to_owned() + "\n").collect();
    let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = Vec::new();
    for piece in code.split("crate::").skip(1) {
        match piece.strip_prefix('{') {
            Some(list) => names.extend(list.split('}').next().unwrap().split(',').map(|s| word(s.trim()))),
            None => names.push(word(piece)),
        }
    }
    names
}

#[test]
fn imports_follow_the_pipeline() {
    let allowed: BTreeMap<&str, &[&str]> = MAY_IMPORT.into_iter().collect();
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let own = module(&path);
        if own == "lib" || own == "main" {
            continue;
        }
        let may = allowed.get(own.as_str()).unwrap_or_else(|| panic!("the module `{own}` is not in the table"));
        for name in imported(&text) {
            let known = allowed.contains_key(name.as_str());
            let below = if name == "run" { &BELOW_RUN[..] } else { &OPEN_TO_ALL[..3] };
            let open = OPEN_TO_ALL.contains(&name.as_str()) && !below.contains(&own.as_str());
            if known && name != own && !open && !may.contains(&name.as_str()) && !may.contains(&"*") {
                wrong.push(format!("{}: imports `{name}`", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "against the direction of the pipeline:\n{}", wrong.join("\n"));
}

#[test]
fn lines_are_short() {
    let mut long = Vec::new();
    for path in files(Path::new("src"), "rs") {
        let text = std::fs::read_to_string(&path).unwrap();
        let lines = text.lines().enumerate().filter(|(_, line)| line.chars().count() > MAX_COLUMNS);
        long.extend(lines.map(|(n, _)| format!("{}:{}", path.display(), n + 1)));
    }
    assert!(long.is_empty(), "over {MAX_COLUMNS} columns:\n{}", long.join("\n"));
}

#[test]
fn files_and_functions_are_short() {
    let mut long = Vec::new();
    for folder in ["src", "tests", "benches"].into_iter().filter(|folder| Path::new(folder).is_dir()) {
        for ending in ["rs", "py", "sh"] {
            for path in files(Path::new(folder), ending) {
                let text = std::fs::read_to_string(&path).unwrap();
                let lines = text.lines().count();
                if lines > MAX_FILE_LINES {
                    long.push(format!("{}: {lines} lines", path.display()));
                }
                let functions = if ending == "rs" { functions(&text) } else { Vec::new() };
                let too_long = functions.into_iter().filter(|(_, lines)| *lines > MAX_FUNCTION_LINES);
                long.extend(
                    too_long.map(|(line, lines)| format!("{}:{line}: {lines} lines in one function", path.display())),
                );
            }
        }
    }
    assert!(long.is_empty(), "too long:\n{}", long.join("\n"));
}

/// Functions as (first line, lines): rustfmt closes a function with a brace at its own indentation.
fn functions(text: &str) -> Vec<(usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let is_function = |line: &str| {
        let head = line.trim_start().split('(').next().unwrap_or("");
        head.split_whitespace().any(|word| word == "fn") && !line.trim_start().starts_with("//")
    };
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate().filter(|(_, line)| is_function(line)) {
        let indent = line.len() - line.trim_start().len();
        let closes = |l: &str| l.len() - l.trim_start().len() == indent && l.trim_start().starts_with('}');
        let end = lines[start..].iter().position(|l| closes(l)).unwrap_or(0);
        found.push((start + 1, end + 1));
    }
    found
}

/// Names that belong to the program and not to the library. Rayon's threads are its own.
const OF_THE_PROGRAM: [&str; 13] = [
    "println!",
    "eprintln!",
    "print!(",
    "std::fs",
    "std::net",
    "std::process",
    "std::env::",
    "std::thread",
    "std::time",
    "Instant::now",
    "File::open",
    "io::stdout",
    "io::stderr",
];

/// The one file of the library that touches the file system: it implements `syntax::Files`.
const DISK: &str = "src/syntax/disk.rs";

/// Failures have types: a text alone is no error that a caller can match.
#[test]
fn no_failure_is_a_text() {
    let untyped = |line: &str| line.contains(", String>") && line.contains("Result<") && !line.contains("Map<");
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let lines = code_lines(&text).filter(|(_, line)| untyped(line));
        wrong.extend(lines.map(|(number, line)| format!("{}:{number}: {}", path.display(), line.trim())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(untyped("fn x() -> Result<f64, String> {") && !untyped("-> Result<(), Diagnostic> {"));
}

#[test]
fn the_library_has_no_clock_thread_or_file_but_what_it_is_handed() {
    let mut wrong = Vec::new();
    let of_program = |path: &Path| ["cli", "main"].contains(&module(path).as_str());
    for (path, text) in sources().into_iter().filter(|(path, _)| !of_program(path) && path != Path::new(DISK)) {
        for (number, line) in code_lines(&text) {
            let used = OF_THE_PROGRAM.iter().filter(|word| line.contains(**word));
            wrong.extend(used.map(|word| format!("{}:{number}: {word}", path.display())));
        }
    }
    assert!(wrong.is_empty(), "outside cli:\n{}", wrong.join("\n"));
}

/// The one file whose head states why its unsafe code is sound.
const UNSAFE: &str = "src/evaluate/compiled/lanes.rs";

#[test]
fn unsafe_code_is_in_one_file_with_its_reasons() {
    let word = |line: &str| {
        // A keyword of content security policies.
        let line = line.replace("wasm-unsafe-eval", "");
        line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|w| w == "unsafe" || w == "unsafe_code")
    };
    let mut wrong = Vec::new();
    for (path, text) in sources().into_iter().filter(|(path, _)| path != Path::new(UNSAFE)) {
        wrong.extend(
            code_lines(&text).filter(|(_, line)| word(line)).map(|(number, _)| format!("{}:{number}", path.display())),
        );
    }
    assert!(wrong.is_empty(), "unsafe code outside {UNSAFE}:\n{}", wrong.join("\n"));
    let text = std::fs::read_to_string(UNSAFE).unwrap();
    assert!(text.contains("Why the unsafe code is sound") && text.contains("// SAFETY:"));
    assert!(text.lines().count() < 500, "no longer a small file");
}

/// Text of a piece of code that looks like the name of a diagnostic.
fn looks_like_a_code(text: &str) -> bool {
    text.len() == 5 && text.starts_with(['E', 'W']) && text[1..].chars().all(|c| c.is_ascii_digit())
}

#[test]
fn codes_are_constants_of_one_table_and_explained() {
    let mut wrong = Vec::new();
    for (path, text) in sources().into_iter().filter(|(path, _)| path != Path::new("src/diagnostic/codes.rs")) {
        for (number, line) in code_lines(&text) {
            let literal = line.split('"').skip(1).step_by(2).find(|piece| looks_like_a_code(piece));
            wrong.extend(literal.map(|code| format!("{}:{number}: \"{code}\"", path.display())));
        }
    }
    assert!(wrong.is_empty(), "codes as text:\n{}", wrong.join("\n"));
    assert!(abbe::diagnostic::CODES.iter().all(|code| code.explanation.len() > 40));
}

/// Folders in which files are replayed and judged. Fields of the controller do so too, wherever they are.
const JUDGES: [&str; 2] = ["src/controller/replay", "src/controller/certificate"];

/// Folders in which tables are filled, with their means of filling.
const FILLERS: [&str; 3] = ["src/compensation", "src/evaluate/compiled", "src/controller/emit"];

/// Names that judges may use of modules that fillers use too: the general algebra, statistics, and types of tables.
const JUDGES_MAY_IMPORT: [(&str, &[&str]); 3] = [
    (
        "evaluate",
        &[
            "Bare",
            "Deviation",
            "Field",
            "Order",
            "Statistics",
            "Summary",
            "command_deviation",
            "commanded_deviation",
            "random_poses",
            "tool_axis_tilt",
        ],
    ),
    (
        "compensation",
        &[
            "AxisErrorCurve",
            "CorrectionTable",
            "CorrectionTables",
            "LatticeCells",
            "Reference",
            "SingleErrorTables",
            "SingleErrors",
            "Spacing",
            "TableRules",
        ],
    ),
    ("lower", &["NominalPose", "sensitivities_to"]),
];

/// Methods that judges may call although a filler has one of the same name: their own, those of a field at one pose, views
/// of tables and rules, and names of the machine, of nalgebra and of the standard library.
const JUDGES_MAY_CALL: [&str; 16] = [
    "any",
    "axes",
    "chain",
    "count",
    "cross",
    "curve",
    "deviation",
    "dot",
    "is_bidirectional",
    "is_empty",
    "iter",
    "len",
    "machine",
    "node",
    "rules",
    "turned",
];

/// Functions that make the judged objects and are called by a path.
const MAKERS: [&str; 2] = ["KinematicsModule::of(", "reversal_tables("];

/// Names that follow a pattern in a piece of code.
fn words_after<'a>(code: &'a str, pattern: &str) -> Vec<&'a str> {
    let name = |rest: &'a str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("");
    code.split(pattern).skip(1).map(name).collect()
}

/// Names of a module, one by one or in braces.
fn named_of<'a>(code: &'a str, module: &str) -> Vec<&'a str> {
    let of = |rest: &'a str| match rest.strip_prefix('{') {
        Some(list) => list.split('}').next().unwrap().split(',').map(str::trim).filter(|n| !n.is_empty()).collect(),
        None => vec![rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap()],
    };
    code.split(&*format!("crate::{module}"))
        .skip(1)
        .flat_map(|rest| rest.strip_prefix("::").map_or(vec!["*"], of))
        .collect()
}

/// Returns the names that a judge must not use, given the methods of the fillers.
fn shared_with_fillers(code: &str, fillers: &[String]) -> Vec<String> {
    let mut wrong: Vec<String> = Vec::new();
    for (module, allowed) in JUDGES_MAY_IMPORT {
        let odd = named_of(code, module).into_iter().filter(|name| !allowed.contains(name));
        wrong.extend(odd.map(|name| format!("{module}::{name}")));
    }
    // A list of modules could hide one.
    wrong.extend(code.contains("crate::{").then(|| "use crate::{...}".to_owned()));
    let calls = code.split('(').filter_map(|before| before.rsplit_once('.').map(|(_, name)| name));
    let odd = calls.filter(|name| fillers.iter().any(|f| f == name) && !JUDGES_MAY_CALL.contains(name));
    wrong.extend(odd.map(|name| format!(".{name}()")));
    wrong.extend(MAKERS.into_iter().filter(|maker| code.contains(maker)).map(str::to_owned));
    wrong
}

#[test]
fn certificates_share_nothing_with_the_tables() {
    let all = sources();
    let code = |text: &str| code_lines(text).map(|(_, line)| line.to_owned() + "\n").collect::<String>();
    let within = |path: &Path, folders: &[&str]| folders.iter().any(|folder| path.starts_with(folder));
    let filling = all.iter().filter(|(path, _)| within(path, &FILLERS));
    let fillers: Vec<String> = filling
        .flat_map(|(_, text)| words_after(&code(text), "pub fn ").into_iter().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    assert!(["commanded", "deviations", "quantise", "tables"].iter().all(|name| fillers.iter().any(|f| f == name)));
    let judge = |path: &Path, text: &str| {
        within(path, &JUDGES) || path.starts_with("src/controller") && text.contains("impl Field for")
    };
    let judges: Vec<_> =
        all.iter().filter(|(path, text)| judge(path, text)).map(|(path, text)| (path, code(text))).collect();
    assert!(judges.len() > 10, "{judges:?}");
    let wrong: Vec<String> = judges
        .iter()
        .flat_map(|(path, code)| {
            shared_with_fillers(code, &fillers).into_iter().map(move |name| format!("{}: {name}", path.display()))
        })
        .collect();
    assert!(wrong.is_empty(), "certificates share code with the tables:\n{}", wrong.join("\n"));
    // An unused name is no longer allowed.
    for (module, allowed) in JUDGES_MAY_IMPORT {
        let used: Vec<&str> = judges.iter().flat_map(|(_, code)| named_of(code, module)).collect();
        allowed.iter().for_each(|name| assert!(used.contains(name), "no judge uses {module}::{name}"));
    }
}

#[test]
fn the_checks_themselves_notice() {
    let fillers = ["commanded", "len", "value"].map(str::to_owned);
    let allowed = "use crate::evaluate::{Bare, Order};\nuse crate::lower::NominalPose;\nlet n = tables.len();";
    assert_eq!(shared_with_fillers(allowed, &fillers), [""; 0]);
    let faults = [
        ("use crate::evaluate::{Bare, CompiledModel};", "evaluate::CompiledModel"),
        ("let x = crate::evaluate::compiled::Batch::new();", "evaluate::compiled"),
        ("use crate::compensation::*;", "compensation::"),
        ("use crate::compensation as c;", "compensation::*"),
        ("use crate::{compensation::tables, machine};", "use crate::{...}"),
        ("let y = plan.commanded(a);", ".commanded()"),
        ("let y = curve\n    .value(a);", ".value()"),
        ("let m = KinematicsModule::of(machine);", "KinematicsModule::of("),
    ];
    for (code, fault) in faults {
        assert_eq!(shared_with_fillers(code, &fillers), [fault], "{code}");
    }

    assert_eq!(
        imported("use crate::{cli::x, machine};\nlet a = crate::lower::B; // crate::report"),
        ["cli", "machine", "lower"]
    );
    let long = format!("    fn long() {{\n{}    }}\n", "        x();\n".repeat(150));
    assert_eq!(functions(&long), [(1, 152)]);
    assert!(looks_like_a_code("E0101") && !looks_like_a_code("EX0C") && !looks_like_a_code("E010"));
}
