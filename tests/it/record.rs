//! `record`: the folder of a calibration, its check, records in a line, and sets that `compile --record` archives.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::oracle::program::Folder;
use crate::support::sha256::sha256;
use crate::support::{Entry, Run, abbe, compile, names, number, set_files, tree, verify};

const MACHINE: &str = "abbe: 1
machine: Mill <7> & \"Co\"
chain: w Y' X' b Z t
axes: { X: { travel: [0, 400] }, Y: { travel: [0, 300] }, Z: { travel: [-200, 0] } }
tool: { gauge: [0, 0, 0], length: 100 mm }
errors:
  EC0Y: { value: 30 urad, uncertainty: 4 urad }
  EXX: { table: x.csv }
  EYY: { points: [[0 mm, 1 um], [300 mm, -3 um]], uncertainty: 1 um }
";
const TABLE: &str = "X [mm],EXX+ [um],EXX- [um]\n0,0,1\n200,2,3\n400,-7,-6\n";
const RAW: &str = "# raw\nX [mm],EXX [um]\n0,0\n400,-6.5\n";

const DESCRIPTION: &str = "record: 1
id: R-1
dates: { begin: 2026-11-02, end: 2026-11-03 }
country: DE
place: customer
laboratory: { name: Lab <b>&</b>, city: Hamburg, country: DE, code: D-K-1 }
customer: { name: \"Works ]]> <script>alert(1)</script>\", street: Weg 1, city: Bremen, email: a@b.example }
persons: [{ name: A. Engineer, role: engineer }, { name: \"O'Brien\" }]
machine: { serial: \"4711\", manufacturer: Maker, model: M <1> }
as_found: machine/found.yaml
instruments:
  - { name: Laser, serial: L-7, certificate: C-12, calibrated: 2026-03-01, uncertainty: 0.5 um/m, file: laser.pdf }
temperatures: [{ name: table, deg_c: 21.5, expanded_uncertainty_k: 0.2 }, { name: air, deg_c: -3 }]
standards: [ISO 230-2]
data: [raw/x laser.csv, other/x laser.csv]
figures: [figures.json]
sets: [{ folder: tables, compile: compile.json }]
remarks: [Synthetic.]
";

/// Figures as `import` writes them, and some that nobody can print.
const FIGURES: &str = r#"{"errors": [{"error": "EXX", "unit": "um", "A": 10, "mean_B": -2.5, "U": {"A": 2, "E": 1},
  "one_way": {"reverse": {"E": 4}}}, {"error": "EYX", "unit": "furlong", "A": 1}, {"error": "E\u0001X", "unit": "um", "A": 1}]}"#;

/// A campaign: machine, raw data, figures, a compiled set with its certificate, and a description.
fn campaign(more: &str) -> (Folder, PathBuf) {
    let folder = Folder::new();
    for name in ["machine", "raw", "other"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    folder.write("machine/found.yaml", MACHINE);
    folder.write("machine/x.csv", TABLE);
    folder.write("raw/x laser.csv", RAW);
    folder.write("other/x laser.csv", "other\n");
    folder.write("laser.pdf", "a certificate\n");
    folder.write("figures.json", FIGURES);
    let compiled = compile(&folder.path("machine/found.yaml"), "linuxcnc", &folder.path("tables"), &[]);
    compiled.json();
    folder.write("compile.json", &compiled.out);
    let description = folder.write("record.yaml", &format!("{DESCRIPTION}{more}"));
    (folder, description)
}

fn record(description: &Path, out: &Path, more: &[&str]) -> Run {
    Run::of(abbe().arg("record").arg(description).args(["--format", "json", "--out"]).arg(out).args(more))
}

fn check(folder: &Path) -> Run {
    Run::of(abbe().args(["record", "--format", "json", "--check"]).arg(folder))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&read(path)).unwrap()
}

#[test]
fn a_record_holds_its_sources_and_the_numbers_of_the_other_verbs() {
    let (folder, description) = campaign("");
    let out = folder.path("made");
    let printed = record(&description, &out, &[]).json();
    let data = json(&out.join("record.json"));
    for key in data.as_object().unwrap().keys() {
        assert_eq!(printed[key], data[key], "{key}");
    }
    // Sources are copied, with hashes of an implementation of the test's own.
    let copies = [
        ("data/x_laser.csv", "raw/x laser.csv"),
        ("data/2-x_laser.csv", "other/x laser.csv"),
        ("instruments/laser.pdf", "laser.pdf"),
        ("figures/figures.json", "figures.json"),
        ("as-found/found.yaml", "machine/found.yaml"),
        ("as-found/x.csv", "machine/x.csv"),
        ("certificates/compile.json", "compile.json"),
    ];
    for (copy, source) in copies {
        assert_eq!(read(&out.join(copy)), read(&folder.path(source)), "{copy}");
    }
    assert_eq!(data["data"][0]["sha256"], sha256(RAW.as_bytes()));
    assert_eq!(data["data"][1]["file"], "data/2-x_laser.csv");
    for name in set_files(&folder.path("tables")) {
        let [copy, source] = [out.join("sets/1").join(&name), folder.path("tables").join(&name)];
        assert_eq!(std::fs::read(copy).unwrap(), std::fs::read(source).unwrap(), "{name}");
    }
    // The certificate is that of `verify`, and the copy of the machine is the machine.
    let mut verified = verify(&folder.path("machine/found.yaml"), &folder.path("tables"), &[]).json();
    verified.as_object_mut().unwrap().remove("warnings");
    assert_eq!(data["sets"][0]["verify"], verified);
    let again = verify(&out.join("as-found/found.yaml"), &out.join("sets/1"), &[]).json();
    assert_eq!(again["compensated"], verified["compensated"]);
    let compiled = number(&data, "/sets/0/compile/compensated/position_um/p95");
    assert!((compiled - number(&data, "/sets/0/verify/compensated/position_um/p95")).abs() < 1e-12);
    // Errors: the value of the largest size, with its sign, as the file has it.
    let row = |name: &str| data["errors"].as_array().unwrap().iter().find(|row| row["error"] == name).unwrap().clone();
    for (name, value, u) in [("EC0Y", 30.0, Some(4.0)), ("EXX", -7.0, None), ("EYY", -3.0, Some(1.0))] {
        assert!((number(&row(name), "/found/value") - value).abs() < 1e-9, "{name}");
        assert_eq!(row(name)["found"]["expanded_uncertainty"].as_f64().map(|u| (u * 1e6).round() / 1e6), u, "{name}");
        assert!(row(name)["left"].is_null());
    }
    // Figures of a known unit and a printable name, each with its uncertainty.
    let figure = |name: &str, value: f64, u: Option<f64>| serde_json::json!({"figure": format!("EXX: {name}"), "value": value, "expanded_uncertainty": u, "unit": "um"});
    let wanted = [
        figure("mean reversal", -2.5, None),
        figure("accuracy A", 10.0, Some(2.0)),
        figure("E reverse", 4.0, Some(1.0)),
    ];
    assert_eq!(data["figures"][0]["values"], serde_json::json!(wanted));
    let page = read(&out.join("record.html"));
    assert!(
        page.contains("<td>EXX: accuracy A</td><td class=\"n\">10</td><td class=\"n\">2</td><td>µm</td>"),
        "{page}"
    );
    let certificate = read(&out.join("certificate.xml"));
    let accuracy = certificate.split_once("EXX: accuracy A, figures").unwrap().1;
    assert!(
        accuracy.contains("<si:valueXMLList>10</si:valueXMLList>\n<si:unitXMLList>\\micro\\metre</si:unitXMLList>")
    );
    // Joint by joint from the workpiece: Y before X.
    let curve = &data["curves"][1];
    assert_eq!((&curve["error"], &curve["positions"]), (&"EXX".into(), &serde_json::json!([0.0, 200.0, 400.0])));
    assert!((number(curve, "/reverse/1") - 3.0).abs() < 1e-9 && (number(curve, "/forward/1") - 2.0).abs() < 1e-9);
}

#[test]
fn another_program_agrees_with_the_hashes() {
    let (folder, description) = campaign("");
    let out = folder.path("made");
    let printed = record(&description, &out, &[]);
    printed.json();
    let judged =
        Command::new("sha256sum").args(["--check", "--strict", "SHA256SUMS"]).current_dir(&out).output().unwrap();
    assert!(judged.status.success(), "{}", String::from_utf8_lossy(&judged.stderr));
    let files = tree(&out).into_iter().filter(|(_, entry)| matches!(entry, Entry::File(_))).count();
    let listed = String::from_utf8(judged.stdout).unwrap().lines().count();
    assert_eq!(listed + 1, files);
    let found = check(&out).json();
    assert_eq!(found["files"], listed);
    assert_eq!(found["sha256"], sha256(read(&out.join("SHA256SUMS")).as_bytes()));
}

#[test]
fn the_same_description_makes_the_same_bytes() {
    let (folder, description) = campaign("");
    let [a, b] = ["a", "b"].map(|name| folder.path(name));
    record(&description, &a, &["--jobs", "1"]).json();
    record(&description, &b, &["--jobs", "3"]).json();
    let relative = |top: &Path| {
        let all = tree(top).into_iter();
        all.map(|(path, entry)| (path.strip_prefix(top).unwrap().to_owned(), entry)).collect::<Vec<_>>()
    };
    assert_eq!(relative(&a), relative(&b));
}

#[test]
fn decisions_keep_the_guard_on_both_sides() {
    // u = 2 urad: the guard of 1.65 u is 3.3 urad about 30 urad; of A it is 1.65 um about 10 um.
    let cases = [
        ("error: EC0Y, limit: 33.4 urad", "conform"),
        ("error: EC0Y, limit: 33.2 urad", "undecided"),
        ("error: EC0Y, limit: 26.8 urad", "undecided"),
        ("error: EC0Y, limit: 26.6 urad", "not_conform"),
        ("error: EXX, limit: 1 mm", "undecided"),
        ("error: EYY, limit: 3.83 um", "conform"),
        ("error: EYY, limit: 3.82 um", "undecided"),
        (
            "name: A, figures: figures.json, value: /errors/0/A, uncertainty: /errors/0/U/A, unit: um, limit: 11.66 um",
            "conform",
        ),
        (
            "name: A, figures: figures.json, value: /errors/0/A, uncertainty: /errors/0/U/A, unit: um, limit: 11.64 um",
            "undecided",
        ),
        (
            "name: A, figures: figures.json, value: /errors/0/A, uncertainty: /errors/0/U/A, unit: um, limit: 8.34 um",
            "not_conform",
        ),
        ("name: A, figures: figures.json, value: /errors/0/A, unit: um, limit: 1 mm", "undecided"),
    ];
    let limits: String = cases.iter().map(|(limit, _)| format!("  - {{ {limit} }}\n")).collect();
    let (folder, description) = campaign(&format!("limits:\n{limits}"));
    let made = record(&description, &folder.path("made"), &[]).json();
    let decisions = made["decisions"].as_array().unwrap();
    assert_eq!(decisions.len(), cases.len());
    for ((limit, wanted), decision) in cases.iter().zip(decisions) {
        assert_eq!(decision["decision"], *wanted, "{limit}: {decision}");
    }
    assert!((number(&decisions[0], "/guard") - 3.3).abs() < 1e-9);
    assert!(decisions[4]["guard"].is_null());
    // The page and the certificate say the same.
    let page = read(&folder.path("made/record.html"));
    let counts = [("conforms<", "conform"), ("does not conform<", "not_conform"), ("not proven<", "undecided")];
    for (words, decision) in counts {
        let wanted = decisions.iter().filter(|of| of["decision"] == decision).count();
        assert_eq!(page.matches(&format!(">{words}")).count(), wanted, "{words}");
    }
    let xml = read(&folder.path("made/certificate.xml"));
    assert_eq!(xml.matches("<dcc:conformity>pass<").count(), 3);
    assert_eq!(xml.matches("<dcc:conformity>fail<").count(), 2);
}

#[test]
fn text_of_the_description_is_text_in_the_page_and_the_certificate() {
    let (folder, description) = campaign("");
    record(&description, &folder.path("made"), &[]).json();
    for name in ["record.html", "certificate.xml"] {
        let text = read(&folder.path("made").join(name));
        assert!(!text.contains("<script") && !text.contains("<b>&") && !text.contains("M <1>"), "{name}");
        assert!(
            text.contains("&lt;script&gt;alert(1)&lt;") && text.contains("Mill &lt;7&gt; &amp; &quot;Co&quot;"),
            "{name}"
        );
    }
    let page = read(&folder.path("made/record.html"));
    assert!(!page.contains("http://") || page.contains("http://www.w3.org/2000/svg"));
    assert!(page.contains("default-src &#x27;none&#x27;") || page.contains("default-src 'none'"));
}

#[test]
fn descriptions_that_do_not_fit_are_refused_and_nothing_is_written() {
    let cases = [
        ("id: R-1\n", ""),
        ("id: R-1\n", "id: R-1\nid: R-2\n"),
        ("id: R-1\n", "id: R-1\ncolour: red\n"),
        ("id: R-1\n", "id: \"a\\u0000b\"\n"),
        ("id: R-1\n", "id: \"  \"\n"),
        ("id: R-1\n", "id: \"R\\u202e-1\"\n"),
        ("id: R-1\n", "id: \"R\\u2028-1\"\n"),
        ("end: 2026-11-03", "end: 2026-11-03, issued: 2026-11-02"),
        ("record: 1\n", "record: 2\n"),
        ("2026-11-03", "2026-11-31"),
        ("2026-11-03", "2026-11-01"),
        ("country: DE\nplace", "country: de\nplace"),
        ("place: customer", "place: moon"),
        ("data: [raw/x laser.csv, other/x laser.csv]", "data: []"),
        ("deg_c: 21.5", "deg_c: .nan"),
        ("deg_c: 21.5", "deg_c: 1e300"),
        ("deg_c: 21.5", "deg_c: 215"),
        ("deg_c: 21.5, expanded_uncertainty_k: 0.2", "deg_c: 21.5, expanded_uncertainty_k: 200"),
        // A room in degF.
        (
            "deg_c: 21.5, expanded_uncertainty_k: 0.2 }, { name: air, deg_c: -3 }",
            "deg_c: 68 }, { name: air, deg_c: 70 }",
        ),
        (
            "remarks: [Synthetic.]",
            "limits: [{ name: A of X, figures: figures.json, value: /errors/0/mean_B, unit: um, limit: 9 um }]",
        ),
        ("remarks: [Synthetic.]", "limits: [{ error: EXX }]"),
        ("remarks: [Synthetic.]", "limits: [{ error: EXX, limit: 10 urad }]"),
        ("remarks: [Synthetic.]", "limits: [{ error: EXX, limit: -1 um }]"),
        ("remarks: [Synthetic.]", "limits: [{ error: EBB, limit: 1 um }]"),
        ("remarks: [Synthetic.]", "limits: [{ limit: 1 um }]"),
        ("remarks: [Synthetic.]", "limits: [{ error: EXX, limit: 1 um, value: /a }]"),
        ("remarks: [Synthetic.]", "limits: [{ name: A, figures: figures.json, value: /none, unit: um, limit: 1 um }]"),
        ("remarks: [Synthetic.]", "limits: [{ name: A, figures: none.json, value: /a, unit: um, limit: 1 um }]"),
        ("figures: [figures.json]", "figures: [record.yaml]"),
        ("compile: compile.json", "compile: figures.json"),
        ("compile: compile.json", "compile: other.json"),
        ("compile: compile.json", "compile: grid.json"),
        ("folder: tables", "folder: raw"),
    ];
    let (folder, description) = campaign("");
    // Certificates of another machine, and of another target.
    folder.write("machine/other.yaml", &MACHINE.replace("-3 um", "-9 um"));
    let other = [("other", "machine/other.yaml", "linuxcnc"), ("grid", "machine/found.yaml", "grid-csv")];
    for (name, machine, target) in other {
        let compiled = compile(&folder.path(machine), target, &folder.path(&format!("tables-{name}")), &[]);
        compiled.json();
        folder.write(&format!("{name}.json"), &compiled.out);
    }
    for (old, new) in cases {
        assert!(DESCRIPTION.contains(old), "{old}");
        folder.write("record.yaml", &DESCRIPTION.replacen(old, new, 1));
        record(&description, &folder.path("made"), &[]).refused("E0820");
        assert!(!folder.path("made").exists(), "{new}");
    }
    for (old, new, code) in [
        ("raw/x laser.csv", "raw/none.csv", "E0101"),
        ("raw/x laser.csv", "raw", "E0102"),
        ("machine/found.yaml", "machine/none.yaml", "E0101"),
        ("laser.pdf", "/dev/zero", "E0102"),
    ] {
        folder.write("record.yaml", &DESCRIPTION.replacen(old, new, 1));
        record(&description, &folder.path("made"), &[]).refused(code);
    }
    let outside = Folder::new();
    let data = outside.write("far.csv", "1\n").display().to_string();
    folder.write("record.yaml", &DESCRIPTION.replacen("raw/x laser.csv", &data, 1));
    let confined = folder.path("").display().to_string();
    record(&description, &folder.path("made"), &["--confined", &confined]).refused("E0819");
    // An instrument that was calibrated later.
    folder.write("record.yaml", &DESCRIPTION.replacen("calibrated: 2026-03-01", "calibrated: 2026-11-03", 1));
    record(&description, &folder.path("late"), &[]).says("W0820").says("does not cover the first day");
    folder.write("record.yaml", DESCRIPTION);
    record(&description, &folder.path("made"), &[]).json();
    let before = tree(&folder.path("made"));
    // A record that may not be read is one all the same.
    let elsewhere = outside.path("").display().to_string();
    let made = folder.path("made").display().to_string();
    let checked = |more: &[&str]| Run::of(abbe().args(["record", "--check", &made]).args(more));
    checked(&["--confined", &elsewhere]).refused("E0819");
    checked(&["--confined", &confined, "--format", "json"]).json();
    // The same record again is there already; another one is not put over it.
    record(&description, &folder.path("made"), &[]).json();
    assert_eq!(tree(&folder.path("made")), before);
    folder.write("record.yaml", &DESCRIPTION.replace("Synthetic.", "Another."));
    record(&description, &folder.path("made"), &[]).refused("E0811");
    assert_eq!(tree(&folder.path("made")), before);
}

#[test]
fn sets_and_machines_that_changed_are_refused() {
    let (folder, description) = campaign("");
    let table = folder.path("tables").join("compensation.inc");
    let bytes = std::fs::read(&table).unwrap();
    std::fs::write(&table, [&bytes[..], b"\n"].concat()).unwrap();
    record(&description, &folder.path("made"), &[]).refused("E0820").says("was edited");
    std::fs::write(&table, &bytes).unwrap();
    let absolute = folder.path("machine/x.csv").display().to_string();
    folder.write("machine/found.yaml", &MACHINE.replace("x.csv", &absolute));
    record(&description, &folder.path("made"), &[]).refused("E0820").says("does not read back");
    folder.write("machine/found.yaml", "abbe: 1\nmachine: m\nchain: w b X t\naxes: { X: { travel: [0, 1] } }\n");
    record(&description, &folder.path("made"), &[]).refused("E0820").says("no error a value");
}

#[test]
fn a_changed_record_is_noticed() {
    let (folder, description) = campaign("");
    let made = folder.path("made");
    record(&description, &made, &[]).json();
    let (raw, sums) = (made.join("data/x_laser.csv"), made.join("SHA256SUMS"));
    std::fs::write(&raw, RAW.replace("-6.5", "-6.4")).unwrap();
    check(&made).refused("E0821").says("`data/x_laser.csv`");
    Run::of(abbe().args(["record", "--trend"]).arg(&made).arg(&made)).refused("E0821");
    std::fs::remove_file(&raw).unwrap();
    check(&made).refused("E0821").says("missing");
    std::fs::write(&raw, RAW).unwrap();
    check(&made).json();
    std::fs::write(made.join("data/stranger.csv"), "1").unwrap();
    let found = check(&made);
    assert_eq!(found.json()["unlisted"], serde_json::json!(["data/stranger.csv"]));
    found.says("W0711");
    // A link is a stranger and is not followed.
    #[cfg(unix)]
    std::os::unix::fs::symlink(&made, made.join("data/loop")).unwrap();
    let strangers = if cfg!(unix) { vec!["data/loop", "data/stranger.csv"] } else { vec!["data/stranger.csv"] };
    assert_eq!(check(&made).json()["unlisted"], serde_json::json!(strangers));
    let list = read(&sums);
    let secret = folder.write("secret", "1");
    for line in ["../secret", &secret.display().to_string(), "data/../../secret", ""] {
        std::fs::write(&sums, format!("{list}{}  {line}\n", sha256(b"1"))).unwrap();
        check(&made).refused("E0821").says("no record");
    }
    std::fs::remove_file(&sums).unwrap();
    check(&made).refused("E0821");
    check(&folder.path("none")).refused("E0821");
}

/// Writes the list of the hashes anew, as somebody does who altered a file.
fn relist(made: &Path) {
    let sums = made.join("SHA256SUMS");
    let line = |line: &str| {
        let name = line.split_once("  ").unwrap().1;
        format!("{}  {name}\n", sha256(&std::fs::read(made.join(name)).unwrap()))
    };
    let text: String = read(&sums).lines().map(line).collect();
    std::fs::write(sums, text).unwrap();
}

/// Every file is in `record.json` too: who alters one and writes the list anew is noticed.
#[test]
fn the_hashes_of_the_document_bind_every_file() {
    let (folder, description) = campaign("");
    let made = folder.path("made");
    record(&description, &made, &[]).json();
    let second = later(&folder, "R-2", "2027-11-02", MACHINE, "");
    let trend = || Run::of(abbe().args(["record", "--trend"]).args([&made, &second]));
    assert_eq!(trend().code, Some(0));
    for name in ["data/x_laser.csv", "as-found/x.csv", "sets/1/abbe.lock.json", "instruments/laser.pdf", "record.html"]
    {
        let whole = std::fs::read(made.join(name)).unwrap();
        std::fs::write(made.join(name), "0\n").unwrap();
        relist(&made);
        for run in [check(&made), trend()] {
            run.refused("E0821").says(&format!("`{name}`")).says("record.json");
        }
        std::fs::write(made.join(name), whole).unwrap();
        relist(&made);
    }
    // A file that nothing names, and one that only the list names.
    let sums = made.join("SHA256SUMS");
    let list = read(&sums);
    std::fs::write(made.join("data/stray.csv"), "1").unwrap();
    trend().refused("E0821").says("`data/stray.csv`");
    std::fs::write(&sums, format!("{list}{}  data/stray.csv\n", sha256(b"1"))).unwrap();
    check(&made).refused("E0821").says("`data/stray.csv`");
    std::fs::remove_file(made.join("data/stray.csv")).unwrap();
    std::fs::write(&sums, list).unwrap();
    // A record of an earlier version does not state them all.
    let mut data = json(&made.join("record.json"));
    for key in ["files", "signature"] {
        data.as_object_mut().unwrap().remove(key);
    }
    std::fs::write(made.join("record.json"), data.to_string()).unwrap();
    relist(&made);
    assert!(check(&made).json()["signature"].is_null());
    // A machine file that reads another file than those that the record states for it.
    data["as_found"]["inputs"].as_array_mut().unwrap().retain(|input| input["name"] != "as-found/x.csv");
    std::fs::write(made.join("record.json"), data.to_string()).unwrap();
    relist(&made);
    check(&made).json();
    trend().refused("E0101").says("x.csv");
    std::fs::write(made.join("record.json"), "{}").unwrap();
    relist(&made);
    check(&made).refused("E0821").says("no record of version 1");
}

fn openssl(arguments: &[&str], folder: &Path) -> bool {
    Command::new("openssl").args(arguments).current_dir(folder).output().unwrap().status.success()
}

/// openssl makes the keys and judges the signature.
#[test]
fn a_signed_record_is_that_of_its_key() {
    let (folder, description) = campaign("");
    let top = folder.path("");
    keys(&top);
    let key = |name: &str| folder.path(name).display().to_string();
    let made = folder.path("made");
    let printed = record(&description, &made, &["--sign", &key("mine")]).json();
    let judge = ["pkeyutl", "-verify", "-pubin", "-inkey", "mine.pub", "-rawin"];
    let files = ["-in", "made/record.json", "-sigfile", "made/record.json.sig"];
    assert!(openssl(&[&judge[..], &files].concat(), &top));
    let found = with_key(&made, &key("mine.pub")).json();
    assert_eq!((&found["signature"], &found["of_given_key"]), (&printed["signature"], &true.into()));
    assert_eq!(check(&made).json()["of_given_key"], false);
    let public = printed["signature"]["public_key"].as_str().unwrap();
    assert!(read(&made.join("record.html")).contains(public));
    let said = |arguments: &[&str]| Run::of(abbe().args(["record", "--check"]).arg(&made).args(arguments)).out;
    assert!(said(&[]).contains(&format!("signed by {public}; whose key")));
    assert!(said(&["--key", &key("mine.pub")]).contains(&format!("signed by the given key {public}")));
    // The same key makes the same bytes.
    record(&description, &folder.path("again"), &["--sign", &key("mine")]).json();
    let signatures = ["made", "again"].map(|name| std::fs::read(folder.path(name).join("record.json.sig")).unwrap());
    assert_eq!(signatures[0], signatures[1]);
    // Another key, a record that is not signed, and one that was signed anew by somebody else.
    with_key(&made, &key("theirs.pub")).refused("E0823").says("signed by another key");
    let plain = folder.path("plain");
    record(&description, &plain, &[]).json();
    with_key(&plain, &key("mine.pub")).refused("E0823").says("is not signed");
    assert!(read(&plain.join("record.html")).contains("This record is not signed."));
    let said = Run::of(abbe().args(["record", "--check"]).arg(&plain)).out;
    assert!(said.contains("\nnot signed: "), "{said}");
    record(&description, &folder.path("forged"), &["--sign", &key("theirs")]).json();
    with_key(&folder.path("forged"), &key("mine.pub")).refused("E0823").says("signed by another key");
    // Altered: the document, the signature, or both, with a list that agrees.
    let (document, signature) = (made.join("record.json"), made.join("record.json.sig"));
    let (text, bytes) = (read(&document), std::fs::read(&signature).unwrap());
    let mut broken = bytes.clone();
    broken[0] ^= 1;
    for (document_now, signature_now) in [
        (text.replace("Synthetic.", "Real."), bytes.clone()),
        (text.clone(), broken),
        (text.clone(), std::fs::read(folder.path("forged/record.json.sig")).unwrap()),
        (text.clone(), Vec::new()),
        (text.replace("\"ed25519\"", "\"none\""), bytes.clone()),
        (text.replace(public, &"0".repeat(64)), bytes.clone()),
        (text.replace(public, "abc"), bytes.clone()),
        (text.replace(public, &"\u{e4}".repeat(32)), bytes.clone()),
    ] {
        std::fs::write(&document, document_now).unwrap();
        std::fs::write(&signature, signature_now).unwrap();
        relist(&made);
        check(&made).refused("E0821").says("signature");
    }
}

/// Two private keys `mine` and `theirs` with their public ones.
fn keys(folder: &Path) {
    for name in ["mine", "theirs"] {
        assert!(openssl(&["genpkey", "-algorithm", "ed25519", "-out", name], folder));
        assert!(openssl(&["pkey", "-in", name, "-pubout", "-out", &format!("{name}.pub")], folder));
    }
}

fn with_key(made: &Path, key: &str) -> Run {
    Run::of(abbe().args(["record", "--format", "json", "--key", key, "--check"]).arg(made))
}

/// Files that are no keys: nothing of them is printed, and nothing is written.
#[test]
fn keys_that_are_none_are_refused() {
    let (folder, description) = campaign("");
    let top = folder.path("");
    keys(&top);
    let [made, hostile] = ["made", "hostile"].map(|name| folder.path(name));
    let key = hostile.display().to_string();
    let (private, shared) = (read(&folder.path("mine")), read(&folder.path("mine.pub")));
    let body = private.lines().nth(1).unwrap();
    let texts = [
        shared.clone(),
        private.replace(body, &body[..40]),
        private.replace(body, "!!!!"),
        private.replace("-----END", "-----FIN"),
        String::new(),
        "\u{0}".repeat(100),
        body.to_owned(),
    ];
    for text in texts {
        std::fs::write(&hostile, &text).unwrap();
        let run = record(&description, &made, &["--sign", &key]);
        run.refused("E0823").says("no private key");
        assert!(!run.err.contains(body) && !made.exists());
    }
    assert!(openssl(&["genpkey", "-algorithm", "x25519", "-out", "hostile"], &top));
    record(&description, &made, &["--sign", &key]).refused("E0823");
    std::fs::write(&hostile, "x".repeat(2 << 20)).unwrap();
    record(&description, &made, &["--sign", &key]).refused("E0823");
    record(&description, &made, &["--sign", &folder.path("absent").display().to_string()]).refused("E0101");
    record(&description, &made, &["--sign", &folder.path("mine").display().to_string()]).json();
    std::fs::write(&hostile, &private).unwrap();
    with_key(&made, &key).refused("E0823").says("no public key");
}

/// A record with another name, day and machine in the campaign's folder.
fn later(folder: &Folder, id: &str, day: &str, machine: &str, limits: &str) -> PathBuf {
    folder.write("machine/next.yaml", machine);
    let text = DESCRIPTION
        .replace("id: R-1", &format!("id: {id}"))
        .replace("begin: 2026-11-02, end: 2026-11-03", &format!("begin: {day}, end: {day}"))
        .replace("as_found: machine/found.yaml", "as_found: machine/next.yaml")
        .replace("sets: [{ folder: tables, compile: compile.json }]\n", "");
    let description = folder.write("next.yaml", &format!("{text}{limits}"));
    let made = folder.path(id);
    record(&description, &made, &[]).json();
    made
}

#[test]
fn records_line_up_over_the_dates() {
    let (folder, description) = campaign("");
    let first = folder.path("first");
    record(&description, &first, &[]).json();
    let limits =
        "limits: [{ error: EC0Y, limit: 90 urad, alarm: 40 urad }, { error: EYY, limit: 9 um, alarm: 5 um }]\n";
    let worse = MACHINE.replace("value: 30 urad", "value: -44 urad");
    let second = later(&folder, "R-2", "2027-11-02", &worse, limits);
    let svg = folder.path("trend.svg");
    let trend = |folders: [&Path; 2]| {
        Run::of(abbe().args(["record", "--format", "json", "--trend"]).args(folders).arg("--svg").arg(&svg))
    };
    let line = trend([&second, &first]).json();
    let ids: Vec<&str> = line["records"].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["R-1", "R-2"]);
    let of = |name: &str| line["errors"].as_array().unwrap().iter().find(|e| e["error"] == name).unwrap().clone();
    let (squareness, positioning) = (of("EC0Y"), of("EYY"));
    assert!((number(&squareness, "/change") + 74.0).abs() < 1e-9);
    assert_eq!((&squareness["alarm"], &positioning["alarm"]), (&"alarm".into(), &"below".into()));
    assert_eq!(of("EXX")["alarm"], "none");
    assert_eq!(squareness["points"][1]["day"], "2027-11-02");
    // What changed is what `diff` says of the two machine files.
    let files = [first.join("as-found/found.yaml"), second.join("as-found/next.yaml")];
    let options = ["--format", "json", "--poses", "2000"];
    let difference = Run::of(abbe().arg("diff").args(&files).args(options)).json();
    let stated = &line["steps"][0]["difference"];
    assert_eq!(stated["p95_um"], difference["p95_um"]);
    assert_eq!(stated["differences"], difference["differences"]);
    assert_eq!(stated["differences"][0]["name"], "EC0Y");
    assert!(read(&svg).contains("alarm limit") && read(&svg).contains("EC0Y"));
    let csv = Run::of(abbe().args(["record", "--format", "csv", "--trend"]).args([&first, &second])).out;
    assert!(csv.contains("EC0Y,urad,R-2,2027-11-02,found,-44,4,40\n"), "{csv}");
    // One machine, every record once.
    trend([&first, &first]).refused("E0822");
    let text = read(&description).replace("serial: \"4711\"", "serial: \"4712\"").replace("id: R-1", "id: R-3");
    record(&folder.write("other.yaml", &text), &folder.path("other-machine"), &[]).json();
    trend([&first, &folder.path("other-machine")]).refused("E0822");
    assert_eq!(Run::of(abbe().args(["record", "--trend"]).arg(&first)).code, Some(2));
}

#[test]
fn a_machine_left_otherwise_has_both_states() {
    let (folder, description) = campaign("limits: [{ error: EC0Y, limit: 20 urad }]\n");
    folder.write("machine/left.yaml", &MACHINE.replace("value: 30 urad", "value: 6 urad"));
    let text = read(&description)
        .replace("as_found: machine/found.yaml", "as_found: machine/found.yaml\nas_left: machine/left.yaml");
    folder.write("record.yaml", &text);
    let made = record(&description, &folder.path("made"), &[]).json();
    let of: Vec<(&str, &str)> = made["decisions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|d| (d["of"].as_str().unwrap(), d["decision"].as_str().unwrap()))
        .collect();
    assert_eq!(of, [("found", "not_conform"), ("left", "conform")]);
    assert!((number(&made, "/errors/0/left/value") - 6.0).abs() < 1e-9 || made["errors"][0]["error"] != "EC0Y");
    let page = read(&folder.path("made/record.html"));
    assert!(page.contains("As left") && page.contains("Component errors of X, as left"));
    assert!(folder.path("made/as-left/left.yaml").exists() && folder.path("made/as-left/x.csv").exists());
}

#[test]
fn the_set_that_compile_replaces_is_archived() {
    let (folder, _) = campaign("");
    let (machine, out, archive) = (folder.path("machine/found.yaml"), folder.path("tables"), folder.path("archive"));
    let record = archive.display().to_string();
    let old = tree(&out);
    folder.write("machine/x.csv", &TABLE.replace("-7", "-9"));
    compile(&machine, "linuxcnc", &out, &["--record", &record]).json();
    assert_ne!(tree(&out), old);
    let [kept] = &names(&archive.join("replaced"))[..] else { panic!("one set is archived") };
    let kept = archive.join("replaced").join(kept);
    // The set that takes it back goes with it.
    assert!(kept.join("restore/abbe.lock.json").exists());
    for (path, entry) in old.iter().filter(|(_, entry)| matches!(entry, Entry::File(_))) {
        let copy = kept.join(path.strip_prefix(&out).unwrap());
        assert_eq!(Entry::File(std::fs::read(&copy).unwrap()), *entry, "{}", copy.display());
    }
    let lock = std::fs::read(kept.join("abbe.lock.json")).unwrap();
    assert!(sha256(&lock).starts_with(kept.file_name().unwrap().to_str().unwrap()));
    // The new set as it is: the same compile archives it once, however often it runs.
    for _ in 0..2 {
        compile(&machine, "linuxcnc", &out, &["--record", &record]).json();
    }
    assert_eq!(names(&archive.join("replaced")).len(), 2);
    // A first set replaces nothing.
    compile(&machine, "linuxcnc", &folder.path("fresh"), &["--record", &folder.path("none").display().to_string()])
        .json();
    assert!(!folder.path("none").exists());
}

#[test]
fn an_archive_is_never_among_the_files_of_the_controller() {
    let (folder, _) = campaign("");
    let (machine, out) = (folder.path("machine/found.yaml"), folder.path("tables"));
    let before = tree(&out);
    #[cfg(unix)]
    std::os::unix::fs::symlink(&out, folder.path("link")).unwrap();
    for inside in ["tables", "tables/record", "other/../tables/deep/er", "link/record"] {
        let inside = folder.path(inside).display().to_string();
        let refused = compile(&machine, "linuxcnc", &out, &["--record", &inside]);
        assert_eq!(refused.code, Some(2), "{inside}: {}", refused.err);
        assert_eq!(tree(&out), before);
    }
    // A set that was edited is no set that can be put back.
    std::fs::write(out.join("compensation.inc"), "edited").unwrap();
    let archive = folder.path("archive").display().to_string();
    compile(&machine, "linuxcnc", &out, &["--record", &archive]).refused("E0706");
    // A manifest that leads to itself, or outside, or names more than a set has.
    let lock = json(&out.join("abbe.lock.json"));
    #[cfg(unix)]
    std::os::unix::fs::symlink(".", out.join("self")).unwrap();
    let odd = |key: &str, list: Value| {
        let mut lock = lock.clone();
        lock[key] = list;
        std::fs::write(out.join("abbe.lock.json"), lock.to_string()).unwrap();
        compile(&machine, "linuxcnc", &out, &["--record", &archive]).refused("E0706");
    };
    let entry = |name: &str, sha256: &str| serde_json::json!({ "name": name, "sha256": sha256 });
    odd("parts", serde_json::json!([entry("self", "0")]));
    odd("parts", serde_json::json!([entry("../machine", "0")]));
    odd("files", serde_json::json!([entry("../machine/x.csv", &sha256(TABLE.as_bytes()))]));
    let large = vec![b'x'; 40 << 20];
    std::fs::write(out.join("large"), &large).unwrap();
    // Hashed by another program: that of the tests takes seconds for so much.
    let hash = Command::new("sha256sum").arg(out.join("large")).output().unwrap();
    let hash = String::from_utf8(hash.stdout).unwrap()[..64].to_owned();
    odd("files", Value::Array(vec![entry("large", &hash); 1000]));
    assert!(!folder.path("archive").exists());
}

/// The schema of PTB, by `xmllint`: the judge refuses what is wrong, and takes the certificate.
#[test]
#[ignore = "needs xmllint; tests/run installs it"]
fn the_schema_takes_the_certificate() {
    let schemas = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dcc");
    let valid = |xml: &Path| {
        let mut judge = Command::new("xmllint");
        judge.args(["--nonet", "--noout", "--schema"]).arg(schemas.join("dcc.xsd")).arg(xml);
        let judged = judge.env("XML_CATALOG_FILES", schemas.join("catalog.xml")).output().unwrap();
        (judged.status.success(), String::from_utf8_lossy(&judged.stderr).into_owned())
    };
    let (folder, description) = campaign("limits: [{ error: EC0Y, limit: 20 urad }, { error: EXX, limit: 20 um }]\n");
    let text = read(&description)
        .replace("as_found: machine/found.yaml", "as_found: machine/found.yaml\nas_left: machine/left.yaml");
    folder.write("machine/left.yaml", &MACHINE.replace("value: 30 urad", "value: 6 urad"));
    let smallest: String = ["temperatures:", "standards:", "figures:", "sets:", "remarks:", "limits:"]
        .iter()
        .fold(read(&description), |text, key| {
            text.lines().filter(|l| !l.starts_with(key)).map(|l| format!("{l}\n")).collect()
        });
    for (name, text) in [("whole", text), ("smallest", smallest)] {
        let description = folder.write(&format!("{name}.yaml"), &text);
        let made = folder.path(name);
        record(&description, &made, &[]).json();
        let (accepted, words) = valid(&made.join("certificate.xml"));
        assert!(accepted, "{name}: {words}");
        let xml = read(&made.join("certificate.xml"));
        for (old, new) in [
            ("schemaVersion=\"3.2.1\"", "schemaVersion=\"3.3.0\""),
            ("<dcc:city>Hamburg</dcc:city>", "<dcc:town>Hamburg</dcc:town>"),
            ("<si:coverageFactorXMLList>2", "<si:coverageFactorXMLList>two"),
            ("<dcc:uniqueIdentifier>R-1</dcc:uniqueIdentifier>", ""),
        ] {
            assert!(xml.contains(old), "{old}");
            let broken = folder.write("broken.xml", &xml.replacen(old, new, 1));
            assert!(!valid(&broken).0, "{name} {new}");
        }
    }
}

/// Folders of somebody else's that call themselves records: with hashes that agree, and words that lead elsewhere.
#[test]
fn a_record_leads_nowhere_but_to_its_own_files() {
    let (folder, description) = campaign("limits: [{ error: EC0Y, limit: 90 urad, alarm: 40 urad }]\n");
    let first = folder.path("first");
    record(&description, &first, &[]).json();
    let second = later(&folder, "R-2", "2027-11-02", MACHINE, "");
    let trend = || Run::of(abbe().args(["record", "--trend"]).args([&first, &second]));
    assert_eq!(trend().code, Some(0));
    let (path, sums) = (first.join("record.json"), first.join("SHA256SUMS"));
    let (whole, list) = (read(&path), read(&sums));
    let forged = [
        ("\"as-found/found.yaml\"", "\"/etc/passwd\""),
        ("\"as-found/found.yaml\"", "\"../../../../../../../../etc/passwd\""),
        ("\"as-found/found.yaml\"", "\"as-found/../../machine/found.yaml\""),
        ("\"EC0Y\"", "\"\\u001b[2J\""),
        ("\"urad\"", "\"urad\\n1,2\""),
        ("\"Mill <7> & \\\"Co\\\"\"", "\"\\u001b]0;title\\u0007\""),
        ("\"record\": 1", "\"record\": 1e400"),
        ("2026-11-02", "2026-13-02"),
    ];
    for (from, to) in forged {
        assert!(whole.contains(from), "{from} in {whole}");
        let text = whole.replace(from, to);
        std::fs::write(&path, &text).unwrap();
        std::fs::write(&sums, list.replace(&sha256(whole.as_bytes()), &sha256(text.as_bytes()))).unwrap();
        let run = trend();
        run.refused("E0821");
        assert!(!run.err.contains("root:") && !run.err.contains('\u{1b}'), "{to}: {}", run.err);
    }
}

/// The runs are drawn as `import --svg` draws them, from its document alone.
#[test]
fn the_page_draws_the_runs_of_import() {
    let runs = "X [mm],1+ [um],1- [um],2+ [um],2- [um],3+ [um],3- [um]\n0,0,2,0.5,2.5,-0.4,2.2\n200,3,5,3.5,4,2.2,5.5\n400,-6,-4,-7,-3,-6.5,-4.4\n";
    let (folder, description) = campaign("");
    folder.write("raw/x laser.csv", runs);
    let [raw, svg] = [folder.path("raw/x laser.csv"), folder.path("runs.svg")];
    let arguments = ["import", raw.to_str().unwrap(), "--error", "EXX", "--format", "json"];
    let imported = Run::of(abbe().args(arguments).args(["--svg", svg.to_str().unwrap()]));
    folder.write("figures.json", &imported.out);
    let out = folder.path("made");
    let made = record(&description, &out, &[]);
    assert_eq!(made.code, Some(0), "{}", made.err);
    let (page, picture) = (read(&out.join("record.html")), read(&svg));
    assert!(page.contains("<h3>Runs, figures.json</h3>"), "{page}");
    // Means and bands of two directions: six lines. Readings are within the bands, so that the scale is the same.
    let lines: Vec<&str> = picture.split("<path ").skip(1).map(|rest| rest.split("/>").next().unwrap()).collect();
    let drawn = lines.iter().filter(|line| line.contains('L') && page.contains(*line)).count();
    assert!(drawn >= 6, "{drawn} of {lines:?}");
    // A document that cannot be drawn is a document like any other.
    for odd in [r#""axis": "X""#, r#""axis": "X", "at_targets": 3"#, r#""axis": 1"#] {
        let (folder, description) = campaign("");
        let target = r#"{"position": 1e300, "forward": null, "reverse": null, "unknown": null, "B": null}"#;
        let error = format!(r#"{{"error": "EXX", "unit": "um", "A": 1, "at_targets": [{target}, {target}]}}"#);
        folder.write("figures.json", &format!(r#"{{{odd}, "errors": [{error}]}}"#));
        let out = folder.path("made");
        assert_eq!(record(&description, &out, &[]).code, Some(0), "{odd}");
        assert!(!read(&out.join("record.html")).contains("<h3>Runs"), "{odd}");
    }
}
