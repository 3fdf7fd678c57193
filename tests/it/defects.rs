//! Files with defects that nobody wrote by hand: every kind of damage to every file of every target. Each is refused
//! with its place and a remedy, or read; a changed reading is that of the controller, by the readers of
//! `support::controllers` where they take the file.

use std::path::{Path, PathBuf};

use abbe::controller::{ControllerTarget, Replay};
use abbe::diagnostic::Diagnostics;
use abbe::machine::Machine;

use crate::loaded;
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::replays;
use crate::support::controllers::{Files, loaded as controller};
use crate::support::{PARAMETER_TARGETS, compile, verify, writes_tables};

/// A damage: its name, and the damaged bytes of a file, if it applies to it.
type Damage = (&'static str, fn(&[u8], &mut Random) -> Option<Vec<u8>>);

fn lines(bytes: &[u8]) -> Vec<Vec<u8>> {
    bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
}

/// Places of whole numbers with a sign, a point, and digits.
fn numbers(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        let length = bytes[i..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        if length > 0 && bytes[i].is_ascii_digit() {
            found.push(i..i + length);
        }
        i += length.max(1);
    }
    found
}

fn number_to(bytes: &[u8], random: &mut Random, word: &str) -> Option<Vec<u8>> {
    let all = numbers(bytes);
    let range = all.get(random.below(all.len().max(1)))?.clone();
    Some([&bytes[..range.start], word.as_bytes(), &bytes[range.end..]].concat())
}

const DAMAGES: [Damage; 19] = [
    ("truncated", |b, r| Some(b[..r.below(b.len())].to_vec())),
    ("last line cut", |b, r| Some(b[..b.len() - 1 - r.below(b.len().min(6))].to_vec())),
    ("line twice", |b, r| {
        let mut all = lines(b);
        let i = r.below(all.len());
        all.insert(i, all[i].clone());
        Some(all.concat())
    }),
    ("line gone", |b, r| {
        let mut all = lines(b);
        all.remove(r.below(all.len()));
        Some(all.concat())
    }),
    ("end gone", |b, _| {
        let mut all = lines(b);
        all.pop();
        Some(all.concat())
    }),
    ("two lines exchanged", |b, r| {
        let mut all = lines(b);
        let (i, j) = (r.below(all.len()), r.below(all.len()));
        all.swap(i, j);
        Some(all.concat())
    }),
    ("a letter for a digit", |b, r| {
        let digits: Vec<usize> = (0..b.len()).filter(|i| b[*i].is_ascii_digit()).collect();
        let mut bytes = b.to_vec();
        *bytes.get_mut(*digits.get(r.below(digits.len().max(1)))?)? = b'O';
        Some(bytes)
    }),
    ("another digit", |b, r| {
        let digits: Vec<usize> = (0..b.len()).filter(|i| b[*i].is_ascii_digit()).collect();
        let mut bytes = b.to_vec();
        *bytes.get_mut(*digits.get(r.below(digits.len().max(1)))?)? = b'0' + r.below(10) as u8;
        Some(bytes)
    }),
    ("NUL", |b, r| {
        let mut bytes = b.to_vec();
        bytes.insert(r.below(b.len()), 0);
        Some(bytes)
    }),
    ("CRLF", |b, _| Some(String::from_utf8_lossy(b).replace('\n', "\r\n").into_bytes())),
    ("byte order mark", |b, _| Some([&[0xef, 0xbb, 0xbf], b].concat())),
    ("not UTF-8", |b, r| {
        let mut bytes = b.to_vec();
        bytes.insert(r.below(b.len()), 0xff);
        Some(bytes)
    }),
    ("1e309", |b, r| number_to(b, r, "1e309")),
    ("NaN", |b, r| number_to(b, r, "NaN")),
    ("huge number", |b, r| number_to(b, r, "99999999999999999999")),
    ("minus", |b, r| number_to(b, r, "-7")),
    ("decimal comma", |b, r| {
        let points: Vec<usize> = (1..b.len()).filter(|i| b[*i] == b'.' && b[*i - 1].is_ascii_digit()).collect();
        let mut bytes = b.to_vec();
        *bytes.get_mut(*points.get(r.below(points.len().max(1)))?)? = b',';
        Some(bytes)
    }),
    ("twice over", |b, _| Some([b, b].concat())),
    ("empty", |_, _| Some(Vec::new())),
];

/// Counts of the outcomes of damaged files.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    refused: usize,
    same: usize,
    other: usize,
    /// Number of those read differently that are confirmed by the controller's own reader.
    confirmed: usize,
}

struct Case<'a> {
    name: &'static str,
    machine: &'a Machine,
    sample: crate::oracle::machines::Sample,
    target: ControllerTarget,
    files: Files,
}

impl Case<'_> {
    /// Reads a set of which one file is damaged.
    fn judge(&self, file: &str, what: &str, text: &str, count: &mut Count) {
        let mut files = self.files.clone();
        files.insert(file.to_owned(), text.to_owned());
        let before = replays::read(&self.target, self.machine, &self.files).unwrap_or_else(|_| panic!("{}", self.name));
        match replays::read(&self.target, self.machine, &files) {
            Err(diagnostics) => {
                self.has_place_and_remedy(&diagnostics, what);
                count.refused += 1;
            }
            Ok(tables) if tables.same_effect(&before) => count.same += 1,
            Ok(tables) => {
                count.other += 1;
                let (axes, indices) = replays::order(self.machine, &self.target);
                let Some(theirs) = controller(self.name, &files, &axes, &self.sample) else { return };
                let replay = Replay::new(self.machine, &self.target, &tables);
                let mut random = Random::new(3);
                for _ in 0..20 {
                    let pose: Vec<f64> = self.machine.axes().iter().map(|_| random.between(-300.0, 400.0)).collect();
                    let ordered: Vec<f64> = indices.iter().map(|axis| pose[*axis]).collect();
                    let ours = replay.addition(&abbe::machine::Approach::Forward.at_pose(&pose));
                    for (axis, value) in indices.iter().zip(theirs(&ordered, false)) {
                        let size = ours[*axis].abs().max(1.0);
                        let near = (ours[*axis] - value).abs() <= 1e-9 * size;
                        assert!(
                            near,
                            "{} {file} {what}: {} and not {value} at {pose:?}\n{text}",
                            self.name, ours[*axis]
                        );
                    }
                }
                count.confirmed += 1;
            }
        }
    }

    fn has_place_and_remedy(&self, diagnostics: &Diagnostics, what: &str) {
        for diagnostic in diagnostics.iter() {
            let placed = !diagnostic.labels.is_empty() || diagnostic.code == "E0705";
            assert!(placed && diagnostic.help.is_some(), "{} {what}: {diagnostic:?}", self.name);
        }
    }
}

/// In the library: some of each kind in each file; more are soak.
#[test]
fn damaged_files_are_refused_or_read_as_the_controller_would() {
    damaged_files(4);
}

#[test]
#[ignore = "soak: minutes"]
fn many_damaged_files_are_refused_or_read_as_the_controller_would() {
    damaged_files(40);
}

fn damaged_files(rounds: usize) {
    let folder = Folder::new();
    let path = replays::machine(&folder, true);
    let three = replays::machine(&folder, false);
    let mut total = Count::default();
    for name in abbe::controller::NAMES.into_iter().filter(|name| writes_tables(name)) {
        let path = if matches!(name, "klipper" | "marlin") { &three } else { &path };
        let machine = loaded::machine(path);
        let out = folder.path(name);
        compile(path, name, &out, &["--accept-unverified", "--poses", "1", "--nodes", "300"]).json();
        let target = ControllerTarget::builtin(name).unwrap();
        let mut files = replays::files(&out);
        files.remove("abbe.lock.json");
        let tables: Vec<String> =
            target.table_files(&machine).into_iter().filter(|file| files.contains_key(file)).collect();
        let sample = replays::geometry(path != &three);
        let case = Case { name, machine: &machine, sample, target, files };
        let mut count = Count::default();
        let mut random = Random::new(2024);
        for file in &tables {
            for (what, damage) in DAMAGES {
                for _ in 0..rounds {
                    let Some(bytes) = damage(case.files[file].as_bytes(), &mut random) else { continue };
                    // Bytes that are no text do not come so far.
                    if let Ok(text) = String::from_utf8(bytes) {
                        case.judge(file, what, &text, &mut count);
                    }
                }
            }
        }
        println!("{name}: {count:?}");
        assert!(count.refused > 0, "{name}: {count:?}");
        total.refused += count.refused;
        total.same += count.same;
        total.other += count.other;
        total.confirmed += count.confirmed;
    }
    println!("all: {total:?}");
    assert!(total.refused > 84 * rounds && total.confirmed > 9 * rounds, "{total:?}");
}

/// By the program: exit codes, places, and that a changed file is never passed off as the one that was written.
#[test]
fn the_program_says_what_became_of_a_damaged_file() {
    let folder = Folder::new();
    let (table, three) = (replays::machine(&folder, true), replays::machine(&folder, false));
    let work: Vec<(&str, &PathBuf, u64)> = abbe::controller::NAMES
        .into_iter()
        .filter(|name| !PARAMETER_TARGETS.contains(name))
        .enumerate()
        .map(|(i, name)| {
            let only_three = matches!(name, "klipper" | "marlin" | "linuxcnc-matrixkins");
            (name, if only_three { &three } else { &table }, i as u64)
        })
        .collect();
    std::thread::scope(|scope| {
        for half in work.chunks(work.len().div_ceil(2)) {
            let folder = &folder;
            scope
                .spawn(move || half.iter().for_each(|(name, machine, seed)| damaged_set(folder, name, machine, *seed)));
        }
    });
}

fn damaged_set(folder: &Folder, name: &str, machine: &Path, seed: u64) {
    let out = folder.path(&format!("set-{name}"));
    compile(machine, name, &out, &["--accept-unverified", "--poses", "1", "--nodes", "100"]).json();
    let loaded = loaded::machine(machine);
    let target = ControllerTarget::builtin(name).unwrap();
    let tables = target.table_files(&loaded);
    let file = tables.iter().map(|file| out.join(file)).find(|path| path.exists()).unwrap();
    let sound = std::fs::read(&file).unwrap();
    let mut random = Random::new(seed);
    for (what, damage) in DAMAGES {
        let Some(bytes) = damage(&sound, &mut random).filter(|bytes| *bytes != sound) else { continue };
        std::fs::write(&file, &bytes).unwrap();
        let run = verify(machine, &out, &["--poses", "1"]);
        match run.code {
            Some(0) => drop(run.says("W0701")),
            Some(1) => {
                assert!(run.err.contains("refused[E07") && run.err.contains("help: "), "{name} {what}: {}", run.err);
                // Nothing on standard output but the refusal as JSON.
                assert!(run.out.starts_with("{\"refused\":true,"), "{}", run.out);
            }
            code => panic!("{name} {what}: {code:?} {}", run.err),
        }
    }
    std::fs::write(&file, &sound).unwrap();
    if seed == 0 {
        // A file of more than any set has, which takes no room on the disk.
        std::fs::OpenOptions::new().write(true).open(&file).unwrap().set_len(80 << 20).unwrap();
        verify(machine, &out, &["--poses", "1"]).refused("E0704").says("more than 64 MB together");
    }
}
