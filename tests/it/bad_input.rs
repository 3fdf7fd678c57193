//! Hostile and broken input: always a diagnostic with a remedy, soon, and never a panic.

use super::language::{Memory, TRUNNION, read};
use abbe::diagnostic::{Diagnostics, Rendering, render};
use abbe::machine;
use abbe::syntax::Disk;
use abbe::syntax::{self, Files, ReadFailure};
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Alone each takes well under a second; the machine may be busy with other tests.
const SOON: Duration = Duration::from_secs(10);

/// A folder of its own for each test, removed afterwards.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("bad-input-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn file(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The text shown for a file on disk, which must be refused soon.
fn refused_on_disk(path: &Path) -> String {
    let start = Instant::now();
    let mut diagnostics = Diagnostics::default();
    let document = syntax::load(path, &Disk, &mut diagnostics);
    let machine = document.and_then(|d| machine::resolve(&d, &Disk, &mut diagnostics));
    assert!(machine.is_none() && start.elapsed() < SOON, "{:?}", start.elapsed());
    assert!(diagnostics.iter().all(|d| d.help.is_some()));
    render(&diagnostics, Rendering::default())
}

/// The codes of a file in memory, which must be refused soon.
fn codes(text: &str) -> Vec<&'static str> {
    let start = Instant::now();
    let (machine, diagnostics) = read(&[("machine.yaml", text)]);
    assert!(machine.is_none() && start.elapsed() < SOON, "{:?}", start.elapsed());
    diagnostics.iter().map(|d| d.code.id).collect()
}

/// A small machine with one more line.
fn small(line: &str) -> String {
    format!(
        "abbe: 1\nmachine: Small\nchain: w b X t\naxes: {{ X: {{ travel: [0, 500], origin: [0, 0, 0] }} }}\n{line}\n"
    )
}

#[test]
fn bombs_are_refused_at_once() {
    let levels = "abcdefghij".chars().zip("bcdefghijk".chars());
    let bomb: String =
        levels.map(|(p, c)| format!("  {c}: &{c} [{}]\n", vec![format!("*{p}"); 10].join(", "))).collect();
    assert_eq!(codes(&small(&format!("provenance:\n  a: &a [x, x]\n{bomb}"))), ["E0106"]);
    assert_eq!(codes(&small("provenance: &a { b: *a }")), ["E0106"]);
    for open in ["[", "{a: ", "- ", "{\"\":["] {
        assert_eq!(codes(&small(&format!("provenance: {}", open.repeat(100_000))))[0][..3], *"E01", "{open}");
    }
    let many: String = (0..300_000).map(|i| format!("  a{i}: 1\n")).collect();
    assert_eq!(codes(&small(&format!("provenance:\n{many}"))), ["E0106"]);
    assert_eq!(codes(&small(&format!("provenance: {{ a: &a 1, {} }}", "b: *a, ".repeat(2_000))))[0][..3], *"E01");
}

#[test]
fn a_file_of_100_mb_is_refused_unread() {
    let scratch = Scratch::new("large");
    for name in ["machine.yaml", "x.csv"] {
        std::fs::File::create(scratch.0.join(name)).unwrap().set_len(100 << 20).unwrap();
    }
    let text = refused_on_disk(&scratch.0.join("machine.yaml"));
    assert!(text.contains("E0103") && text.contains("100 MB; the limit is 16 MB"), "{text}");
    let text = refused_on_disk(&scratch.file("m.yaml", small("measured: [x.csv]")));
    assert!(text.contains("E0103") && text.contains("m.yaml:5:12"), "{text}");
}

#[test]
fn a_table_of_too_many_rows_is_refused() {
    let rows: String = (0..=100_000).map(|i| format!("{i}, 0\n")).collect();
    let table = format!("X [mm], EXX [um]\n{rows}");
    let (machine, diagnostics) = read(&[("machine.yaml", &small("measured: [x.csv]")), ("x.csv", &table)]);
    assert!(machine.is_none());
    assert_eq!(diagnostics.iter().map(|d| d.code.id).collect::<Vec<_>>(), ["E0103"]);
}

#[cfg(unix)]
#[test]
fn fifos_devices_sockets_and_directories_are_refused_unopened() {
    let scratch = Scratch::new("irregular");
    let fifo = scratch.0.join("fifo");
    assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    let socket = scratch.0.join("socket");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let link = scratch.0.join("link");
    std::os::unix::fs::symlink(&fifo, &link).unwrap();
    let cases = [
        (fifo, "a FIFO"),
        (link, "a FIFO"),
        (socket, "a socket"),
        ("/dev/zero".into(), "a device"),
        (scratch.0.clone(), "a directory"),
    ];
    for (path, word) in cases {
        let text = refused_on_disk(&path);
        assert!(text.contains("E0102") && text.contains(word), "{text}");
        let path = path.display();
        for line in [
            format!("measured: [\"{path}\"]"),
            format!("errors: {{ EXX: {{ table: \"{path}\" }} }}"),
            format!("extends: \"{path}\""),
        ] {
            let text = refused_on_disk(&scratch.file("machine.yaml", small(&line)));
            assert!(text.contains("E0102") && text.contains(word), "{text}");
        }
    }
    assert!(refused_on_disk(&scratch.0.join("nothing.yaml")).contains("E0101"));
}

/// Files that cannot be read for other reasons.
struct Broken(ReadFailure);

impl Files for Broken {
    fn read(&self, _: &Path) -> Result<Vec<u8>, ReadFailure> {
        Err(self.0.clone())
    }
}

#[test]
fn every_failure_to_read_is_told() {
    let failures = [
        (ReadFailure::Denied, "may not be read"),
        (ReadFailure::Other("bad sector\u{1b}[2J".to_owned()), "bad sector\u{fffd}[2J"),
        (ReadFailure::TooLarge(Disk::MAX_BYTES + 1, Disk::MAX_BYTES), "17 MB"),
    ];
    for (failure, words) in failures {
        let mut diagnostics = Diagnostics::default();
        assert!(syntax::load(Path::new("m.yaml"), &Broken(failure), &mut diagnostics).is_none());
        let text = render(&diagnostics, Rendering::default());
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn other_encodings_are_refused_with_the_remedy() {
    let utf16: Vec<u8> = "\u{feff}abbe: 1".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin: &[u8] = b"abbe: 1\nmachine: Fr\xe4se\n";
    for (bytes, words) in [(&utf16[..], "iconv -f UTF-16"), (latin, "(line 2)")] {
        let memory = Memory([(PathBuf::from("m.yaml"), bytes.to_vec())].into());
        let mut diagnostics = Diagnostics::default();
        assert!(syntax::load(Path::new("m.yaml"), &memory, &mut diagnostics).is_none());
        let text = render(&diagnostics, Rendering::default());
        assert!(text.contains("E0104") && text.contains(words), "{text}");
    }
}

#[test]
fn byte_order_mark_and_crlf_are_accepted_and_places_stay_right() {
    let yaml = format!("\u{feff}{}", small("measured: [x.csv]").replace('\n', "\r\n"));
    let table = "\u{feff}X [mm], EXX [um]\r\n0, 1\r\n\r\n500, 2\r\n";
    let (machine, diagnostics) = read(&[("m.yaml", &yaml), ("x.csv", table)]);
    assert!(machine.is_some(), "{}", render(&diagnostics, Rendering::default()));
    let (_, diagnostics) =
        read(&[("m.yaml", &yaml.replace("500]", "500 deg]")), ("x.csv", &table.replace('2', "2,5"))]);
    let text = render(&diagnostics, Rendering::default());
    assert!(text.contains("m.yaml:4:26") && text.contains("x.csv:4:"), "{text}");
}

#[test]
fn empty_files_say_what_a_machine_is() {
    for text in ["", "\u{feff}", "\n\n", "# only a comment\n", "~", "---\n...\n", "[]", "5", "''"] {
        assert_eq!(codes(text), ["E0109"], "{text:?}");
    }
    assert_eq!(codes("a: 1\n---\nb: 2\n"), ["E0108"]);
    assert_eq!(codes("{}"), ["W0201", "E0203", "E0203"]);
}

#[test]
fn numbers_that_are_none_are_refused() {
    for number in
        ["1e400", ".nan", ".inf", "-.inf", "nan", "inf", "0x1F um", "1_000 um", "1.2.3 um", "--1 um", "1e400 um", "1/0"]
    {
        let found = codes(&small(&format!("errors: {{ EXX: {number} }}")));
        assert!(found == ["E0206"] || found == ["E0204"], "{number}: {found:?}");
        let found = codes(&small(&format!("tool: {{ length: {number} }}")));
        assert!(found.iter().all(|c| ["E0206", "E0205", "E0204"].contains(c)), "{number}: {found:?}");
    }
    assert_eq!(codes(&small("errors: { EXX: true }")), ["E0202"]);
    assert_eq!(codes(&small("volume: { X: { step: 1e-300 } }")), ["E0214"]);
}

#[test]
fn names_cannot_break_out_of_a_line() {
    for name in [r#""a\nb""#, r#""a\rb""#, r#""a\u001b[2Jb""#, r#""a\u2028b""#, r#""a\u202eb""#, r#""""#, r#"" ""#] {
        let text = small("").replace("machine: Small", &format!("machine: {name}"));
        assert_eq!(codes(&text), ["E0212"], "{name}");
    }
    assert_eq!(codes(&small("").replace("machine: Small", &format!("machine: {}", "x".repeat(121)))), ["E0212"]);
    for name in ["</script><b>", "../../etc/passwd", "a; M30 (b) %"] {
        let text = small("").replace("machine: Small", &format!("machine: \"{name}\""));
        let (machine, _) = read(&[("m.yaml", &text)]);
        assert_eq!(machine.unwrap().name(), name);
    }
    for tool in ["..", ".a", "a..b", "a/b", "a b", "</script>", "\"a\\nb\"", "ä"] {
        assert_eq!(codes(&small(&format!("tools: {{ {tool}: {{ length: 1 }} }}"))), ["E0212"], "{tool}");
    }
}

#[test]
fn nothing_of_the_file_reaches_the_terminal_raw() {
    let text = small("\"\\u001b[31mkey\": 1\nerrors: { \"E\\u001bX\": 1 um, EXX: \"\\u001b[2J um\" }");
    let (_, diagnostics) = read(&[("m.yaml", &text)]);
    assert!(!render(&diagnostics, Rendering::default()).contains('\u{1b}'));
    let (_, diagnostics) =
        read(&[("m.yaml", &small("measured: [x.csv]")), ("x.csv", "X [mm], E\u{1b}[2JXX [um]\n0, \u{7}\n")]);
    assert!(!render(&diagnostics, Rendering::default()).contains(['\u{1b}', '\u{7}']));
}

#[test]
fn extends_ends_after_eight_files() {
    let text = |i: usize| if i == 20 { small("") } else { format!("extends: m{}.yaml\n", i + 1) };
    let chain = |from: usize| (from..=20).map(|i| (format!("m{i}.yaml"), text(i))).collect::<Vec<_>>();
    for (from, machine) in [(13, true), (12, false)] {
        let files = chain(from);
        let files: Vec<(&str, &str)> = files.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
        let (found, diagnostics) = read(&files);
        assert_eq!(found.is_some(), machine, "{}", render(&diagnostics, Rendering::default()));
    }
    let (_, diagnostics) = read(&[("a/m.yaml", "extends: ../a/../a/m.yaml")]);
    assert_eq!(diagnostics.iter().map(|d| d.code.id).collect::<Vec<_>>(), ["E0208"]);
}

/// Everything at once on some bytes: read, resolved, rendered in colour.
fn survives(machine: &[u8], table: &[u8]) {
    let files = [("m.yaml", machine), ("errors/x.csv", table), ("errors/c.csv", table)];
    let memory = Memory(files.map(|(n, b)| (PathBuf::from(n), b.to_vec())).into());
    let mut diagnostics = Diagnostics::default();
    let document = syntax::load(Path::new("m.yaml"), &memory, &mut diagnostics);
    let machine = document.and_then(|d| machine::resolve(&d, &memory, &mut diagnostics));
    assert!(machine.is_some() != diagnostics.is_refused());
    let _ = render(&diagnostics, Rendering { color: true, folded: false });
}

/// Changes to a text: (place, number of removed bytes, inserted text).
fn changes() -> impl Strategy<Value = Vec<(prop::sample::Index, usize, String)>> {
    let piece = prop_oneof![
        "[\\[\\]{}:,\"'#&*!|>%@` \n\t0-9a-zA-Zµ°é\u{1}-]{0,4}",
        prop::sample::select(vec![
            "1e308",
            "-1",
            "0",
            "~",
            "[[",
            "um",
            "deg",
            "&a",
            "*a",
            "<<",
            "\u{feff}",
            "continuous",
            "E",
            "0 mm"
        ])
        .prop_map(str::to_owned),
    ];
    prop::collection::vec((any::<prop::sample::Index>(), 0usize..12, piece), 1..6)
}

fn changed(text: &str, changes: &[(prop::sample::Index, usize, String)]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for (at, gone, piece) in changes {
        let start = at.index(bytes.len() + 1).min(bytes.len());
        let end = (start + gone).min(bytes.len());
        bytes.splice(start..end, piece.bytes());
    }
    bytes
}

const TABLE: &str = "# run 3\nC [deg], EXC+ [um], EXC- [um], EAC [urad]\n0, 1, 2, 3\n90.5, 1e0, -2, 3\n360, 1, 2, 3\n";

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_change_to_a_machine_file_makes_it_panic(changes in changes()) {
        survives(&changed(TRUNNION, &changes), TABLE.as_bytes());
    }

    #[test]
    fn no_change_to_a_table_makes_it_panic(changes in changes()) {
        let machine = small("measured: [errors/c.csv]").replace("w b X t", "w C' b X t").replace("{ X:", "{ C: { travel: continuous }, X:");
        survives(machine.as_bytes(), &changed(TABLE, &changes));
    }
}
