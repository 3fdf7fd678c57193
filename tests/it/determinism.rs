//! The same bytes on any number of threads, in any locale and any surroundings; runs at the same time into one folder.

use crate::oracle::program::Folder;
use crate::support::{Entry, abbe, tree, verify};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;

fn files(at: &Path) -> BTreeMap<PathBuf, Entry> {
    tree(at).into_iter().map(|(path, entry)| (path.strip_prefix(at).unwrap().to_owned(), entry)).collect()
}

fn machine(um: f64) -> String {
    let axes = [("X", 1), ("Y", 2), ("Z", 3)]
        .map(|(axis, n)| format!("  {axis}: {{ controller: {n}, travel: [0, 300], origin: [0, 0, 0] }}\n"))
        .concat();
    format!(
        "abbe: 1\nmachine: Fräse\nchain: w C' b X Y Z t\naxes:\n{axes}  C: {{ controller: 4, travel: continuous, origin: [9, 8, 7] }}\nerrors:\n  \
         EXX: {{ points: [[0 mm, 0 um], [120 mm, {um} um], [300 mm, 1 um]] }}\n  EBX: {{ points: [[0 mm, 3 urad], \
         [300 mm, {um} urad]] }}\n  ECC: {{ harmonics: {{ 2: [{um} urad, 1 urad] }} }}\n  EYY: {{ tolerance: 7 um }}\n\
         volume: {{ step: 100 mm, C: {{ step: 45 deg }} }}\n"
    )
}

const VERBS: [&[&str]; 14] = [
    &["compile", "m.yaml", "--target", "linuxcnc", "--poses", "200", "--out", "set"],
    &["compile", "m.yaml", "--target", "sinumerik-cec", "--poses", "200", "--accept-unverified", "--out", "cec"],
    &[
        "map",
        "m.yaml",
        "--random",
        "9000",
        "--csv",
        "m.csv",
        "--parquet",
        "m.parquet",
        "--plane",
        "XY",
        "--png",
        "m.png",
    ],
    &["budget", "m.yaml", "--samples", "300", "--poses", "50", "--format", "json"],
    &["identify", "m.yaml", "--data", "r.csv", "--fit", "EXX:poly2", "--accept-undetermined", "--out", "f.yaml"],
    &["report", "m.yaml", "--poses", "60", "--out", "page.html"],
    &["equations", "m.yaml", "--order", "2"],
    &["figures", "circle", "c.csv", "--svg", "c.svg"],
    &["reach", "m.yaml", "--step", "60 mm", "--svg", "r.svg", "--vtk", "r.vts"],
    &["instrument", "m.yaml", "ball-bar", "--svg", "i.svg"],
    &["locate", "m.yaml", "lines.csv", "--out", "l.yaml"],
    &["record", "r.yaml", "--out", "record"],
    &["budget", "m.yaml", "--samples", "40", "--poses", "9", "--shard", "1/2", "--state", "part"],
    &["enumerate", "m.yaml", "--samples", "3", "--max-samples", "6", "--poses", "5", "--state", "study"],
];

const DESCRIPTION: &str = "record: 1\nid: R\ndates: { begin: 2026-11-02, end: 2026-11-02 }\ncountry: DE\nplace: other\n\
    laboratory: { name: L, city: C }\ncustomer: { name: L, city: C }\npersons: [{ name: P }]\nmachine: { serial: S }\n\
    as_found: m.yaml\ndata: [r.csv]\n\
    instruments: [{ name: I, serial: S, certificate: C, calibrated: 2026-01-01, uncertainty: 1 um }]\n";

#[test]
fn threads_and_locales_change_no_byte() {
    let folder = Folder::new();
    let readings: String = (0..40).map(|i| format!("{},{},{}\n", 7 * i, 37 * i % 300, i % 5)).collect();
    let all = |name: &str, jobs: &str, variables: &[(&str, &str)]| {
        let at = folder.path(name);
        std::fs::create_dir(&at).unwrap();
        std::fs::write(at.join("m.yaml"), machine(5.0)).unwrap();
        std::fs::write(at.join("r.csv"), format!("X [mm],Y [mm],dx [um]\n{readings}")).unwrap();
        std::fs::write(at.join("c.csv"), "angle [deg],ccw [um],cw [um]\n0,1,2\n90,2,3\n180,1,1\n270,2,0\n").unwrap();
        std::fs::write(at.join("lines.csv"), "axis,dx [um],dy [um]\nC,4,-3\n").unwrap();
        std::fs::write(at.join("r.yaml"), DESCRIPTION).unwrap();
        for (number, verb) in VERBS.iter().enumerate() {
            let mut run = abbe();
            run.args(*verb).args(["--jobs", jobs]).current_dir(&at).envs(variables.iter().copied());
            let run = run.output().unwrap();
            assert!(run.status.success(), "{verb:?}: {}", String::from_utf8_lossy(&run.stderr));
            std::fs::write(at.join(format!("{number}.out")), run.stdout).unwrap();
            std::fs::write(at.join(format!("{number}.err")), run.stderr).unwrap();
        }
        files(&at)
    };
    let one = all("one", "1", &[]);
    let german = [("LC_ALL", "de_DE.UTF-8"), ("TZ", "Asia/Kathmandu")];
    let plain = [("LC_ALL", "C"), ("LANG", "C"), ("COLUMNS", "40"), ("TERM", "dumb")];
    let turkish = [("LC_ALL", "tr_TR.UTF-8"), ("LANGUAGE", "tr"), ("HOME", "/nowhere")];
    for (name, jobs, variables) in [("two", "2", &german[..]), ("seven", "7", &plain), ("again", "1", &turkish)] {
        let other = all(name, jobs, variables);
        assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
        one.iter().for_each(|(path, entry)| assert!(other[path] == *entry, "{name}: {}", path.display()));
    }
}

/// Fifty runs of two machines into one folder, and into one file.
#[test]
fn runs_at_the_same_time_leave_one_whole_set() {
    let folder = Folder::new();
    let paths = [5.0, 9.0].map(|um| folder.write(&format!("{um}.yaml"), &machine(um)));
    let [out, csv] = ["out", "map.csv"].map(|name| folder.path(name));
    let arguments = |i: usize| {
        let machine = paths[i / 2 % 2].to_str().unwrap().to_owned();
        let more: &[&str] = match i % 2 {
            0 => &["--target", "linuxcnc", "--poses", "1", "--out"],
            _ => &["--random", "2000", "--quiet", "--csv"],
        };
        let verb = ["compile", "map"][i % 2].to_owned();
        let target = [&out, &csv][i % 2].to_str().unwrap().to_owned();
        let more = more.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        [vec![verb, machine], more, vec![target]].concat()
    };
    let known: Vec<_> = (0..4)
        .map(|i| {
            assert!(abbe().args(arguments(i)).output().unwrap().status.success(), "{:?}", arguments(i));
            if i % 2 == 0 {
                Some(files(&out))
            } else {
                Some([(csv.clone(), Entry::File(std::fs::read(&csv).unwrap()))].into())
            }
        })
        .collect();
    let runs: Vec<_> = (0..50)
        .map(|i| abbe().args(arguments(i)).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap())
        .collect();
    for (i, run) in runs.into_iter().enumerate() {
        let run = run.wait_with_output().unwrap();
        assert!(run.status.success(), "{:?}: {}", arguments(i), String::from_utf8_lossy(&run.stderr));
    }
    let set = Some(files(&out));
    let winner = [0, 2].into_iter().find(|i| known[*i] == set).expect("one of the two sets, and nothing beside it");
    assert_eq!(verify(&paths[winner / 2], &out, &["--poses", "1"]).code, Some(0));
    let map = Some([(csv.clone(), Entry::File(std::fs::read(&csv).unwrap()))].into());
    assert!(known[1] == map || known[3] == map, "neither map");
    assert_eq!(crate::support::names(&folder.path("")).len(), 4, "temporary files are left");
}
