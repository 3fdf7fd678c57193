//! What a hostile week found, each reproduced with the program: files that cost time or memory out of all proportion,
//! systems that have nothing left to give, numbers that are none, and the ordinary case half a year later.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile, config, number, packed, verify};

const FEW: [&str; 2] = ["--poses", "20"];

/// Alone each takes well under a second, unoptimised; the machine may be busy with other tests.
const SOON: Duration = Duration::from_secs(15);

const SMALL: &str =
    "abbe: 1\nmachine: example\nchain: w b X t\naxes: { X: { travel: [0 mm, 100 mm], origin: [0, 0, 0] } }\n";

fn run(folder: &Folder, arguments: &[&str]) -> Run {
    Run::of(abbe().args(arguments).current_dir(folder.path("")))
}

fn soon(folder: &Folder, arguments: &[&str]) -> Run {
    let begin = Instant::now();
    let run = run(folder, arguments);
    assert!(begin.elapsed() < SOON, "{:?} took {:?}", &arguments[..2], begin.elapsed());
    run
}

/// libyaml takes quadratic time on nesting: 20 s for 80000 brackets. Every reader of YAML and JSON has the guard.
#[test]
fn deep_nesting_is_refused_at_once_wherever_yaml_is_read() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    for (open, count) in [("[", 80_000), ("{a: ", 30_000)] {
        let deep = open.repeat(count);
        std::fs::create_dir_all(folder.path("own")).unwrap();
        let _ = folder.write("own/target.yaml", &format!("target: {deep}"));
        let _ = folder.write("deep.yaml", &format!("matrix: {deep}"));
        let inline = open.repeat(20_000);
        let (algebra, conventions) = (format!("degree: {inline}"), format!("linear: {inline}"));
        // By depth, or by what the parser itself takes.
        let run = soon(&folder, &["check", "deep.yaml"]);
        assert!(run.code == Some(1) && (run.err.contains("E0105") || run.err.contains("E0106")), "{}", run.err);
        soon(&folder, &["compile", "m.yaml", "--target", "own", "--templates", ".", "--out", "o"]).refused("E0703");
        soon(&folder, &["classify", "deep.yaml"]).refused("E0815");
        soon(&folder, &["budget", "m.yaml", "--class", "production", "--cost", "deep.yaml", "--goal", "9 um"])
            .refused("E0615");
        soon(&folder, &["equations", "m.yaml", "--algebra", &algebra]).refused("E0814");
        soon(&folder, &["convert", "m.yaml", "--to", &conventions, "--out", "c.yaml"]).refused("E0528");
    }
    std::fs::create_dir_all(folder.path("set")).unwrap();
    for name in ["abbe.lock.json", ".abbe-set.json"] {
        let _ = folder.write(&format!("set/{name}"), &"[".repeat(1_000_000));
        assert_eq!(soon(&folder, &["verify", "m.yaml", "set"]).code, Some(1));
    }
}

#[test]
fn axes_and_diagnostics_are_counted() {
    let folder = Folder::new();
    let axes = |count: usize| (0..count).map(|i| format!("X{i}")).collect::<Vec<_>>();
    let declared = |names: &[String]| {
        let axis = |name: &String| format!("  {name}: {{ kind: linear, direction: [1, 0, 0], travel: [0, 100] }}\n");
        names.iter().map(axis).collect::<String>()
    };
    for count in [17, 1000] {
        let names = axes(count);
        let text = format!("abbe: 1\nmachine: m\nchain: \"w b {} t\"\naxes:\n{}", names.join(" "), declared(&names));
        let _ = folder.write("many.yaml", &text);
        soon(&folder, &["check", "many.yaml"]).refused("E0307");
        soon(&folder, &["compile", "many.yaml", "--target", "pmac", "--out", "o"]).refused("E0307");
    }
    // Letters are asked for before tables are filled.
    let names = axes(16);
    let text = format!("abbe: 1\nmachine: m\nchain: \"w b {} t\"\naxes:\n{}", names.join(" "), declared(&names));
    let _ = folder.write("many.yaml", &(text + "errors: { EAX0: { points: [[0 mm, 1 urad], [100 mm, 3 urad]] } }\n"));
    soon(&folder, &["compile", "many.yaml", "--target", "linuxcnc", "--out", "o"]).refused("E0601");
    // 60000 mistakes are counted, and 100 of them kept.
    let errors: String = (0..60_000).map(|i| format!("  EXX{i}: 3 um\n")).collect();
    let _ = folder.write("wrong.yaml", &format!("{SMALL}errors:\n{errors}"));
    let run = run(&folder, &["check", "wrong.yaml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let (kept, more) = (json["diagnostics"].as_array().unwrap().len(), json["more"].as_u64().unwrap());
    assert!(kept <= 200 && more + kept as u64 >= 60_000, "{kept} and {more}");
    run.says("more");
}

/// A part of a budget that somebody else wrote: its hash of machine and options is right, its counts are not.
#[test]
fn parts_of_a_budget_have_no_more_machines_than_it() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", &format!("{SMALL}errors: {{ EXX: {{ tolerance: 9 um }} }}\n"));
    let budget = ["budget", "m.yaml", "--samples", "9", "--poses", "3", "--quiet"];
    let drawn = [&budget[..], &["--shard", "1/1", "--state", "part"]].concat();
    assert_eq!(run(&folder, &drawn).code, Some(0));
    let text = std::fs::read_to_string(folder.path("part")).unwrap();
    assert!(text.contains("\"first\":0"), "{text}");
    for first in ["1", "18446744073709551615", "18446744073709551616", "-1", "1e300", "null", "[[[["] {
        let _ = folder.write("part", &text.replace("\"first\":0", &format!("\"first\":{first}")));
        run(&folder, &drawn).refused("E0610");
        run(&folder, &[&budget[..], &["--merge", "part"]].concat()).refused("E0610");
    }
    let _ = folder.write("part", &text.replacen("[{", "[{\"x\":1e999,", 1));
    run(&folder, &drawn).refused("E0610");
}

/// Four files of 50 MB: 36 s and 1.26 GB once. They are refused by their size.
#[test]
fn sets_beyond_all_measure_are_refused_unread() {
    let folder = Folder::new();
    let chain = "abbe: 1\nmachine: m\nchain: w b X Y t\naxes: { X: { travel: [0, 100] }, Y: { travel: [0, 100] } }\n";
    let _ = folder.write("m.yaml", chain);
    std::fs::create_dir(folder.path("set")).unwrap();
    for name in ["joint_0_X.comp", "joint_1_Y.comp"] {
        let file = File::create(folder.path("set").join(name)).unwrap();
        file.set_len(50 << 20).unwrap();
    }
    soon(&folder, &["verify", "m.yaml", "set", "--target", "linuxcnc"]).refused("E0704").says("64 MB together");
}

/// A run with all threads and one that is given none: the same bytes.
#[test]
fn without_threads_the_run_has_one() {
    let folder = Folder::new();
    let arguments = ["map", "--random", "500", "--quiet", "--format", "json"];
    let machine = config("trunnion.yaml");
    let plain = Run::of(abbe().args(arguments).arg(&machine)).json();
    for (kilobytes, threads) in [(200_000, 64), (120_000, 2), (60_000, 8)] {
        let script = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
        let mut shell = Command::new("sh");
        shell.args(["-c", &script, env!("CARGO_BIN_EXE_abbe")]).args(arguments).arg(&machine);
        let run = Run::of(shell.env("RAYON_NUM_THREADS", threads.to_string()).current_dir(folder.path("")));
        assert_eq!(run.json(), plain, "{kilobytes} kB, {threads} threads");
    }
}

/// A server that is given no descriptor for a connection waits for one, and does not turn on the spot.
#[test]
fn a_server_without_descriptors_waits_for_one() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    let script = "ulimit -n 20; exec \"$0\" workbench m.yaml";
    let mut shell = Command::new("sh");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_abbe")]).current_dir(folder.path(""));
    let mut server = shell.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut line = String::new();
    let _ = BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let port: u16 = line.split("127.0.0.1:").nth(1).unwrap().split('/').next().unwrap().parse().unwrap();
    let open = || TcpStream::connect(("127.0.0.1", port)).unwrap();
    let spent = || -> u64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", server.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
        // Clock ticks of 10 ms, in user and system mode.
        fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
    };
    let idle: Vec<TcpStream> = (0..40).map(|_| open()).collect();
    let before = spent();
    std::thread::sleep(Duration::from_secs(1));
    assert!(spent() - before < 50, "{} ticks in a second", spent() - before);
    drop(idle);
    let mut one = open();
    one.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    one.write_all(format!("GET / HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n\r\n").as_bytes()).unwrap();
    let mut answer = Vec::new();
    let _ = one.read_to_end(&mut answer);
    let _ = server.kill();
    let _ = server.wait();
    assert!(answer.starts_with(b"HTTP/1.1 200"), "{:?}", String::from_utf8_lossy(&answer[..answer.len().min(80)]));
}

#[test]
fn keys_without_a_value_are_keys_too() {
    let folder = Folder::new();
    for (line, key) in [("toool: ~", "toool"), ("volume: { X: { stp: ~ } }", "stp"), ("root:*:19000:", "root:*:19000")]
    {
        let _ = folder.write("m.yaml", &format!("{SMALL}{line}\n"));
        run(&folder, &["check", "m.yaml"]).refused("E0201").says(&format!("unknown key `{key}`"));
        let _ = folder.write("base.yaml", &format!("{line}\n"));
        let _ = folder.write("m.yaml", &format!("extends: base.yaml\n{SMALL}"));
        run(&folder, &["check", "m.yaml"]).refused("E0201").says("base.yaml");
    }
    // Known keys without a value remove what is inherited.
    let _ = folder
        .write("base.yaml", "tool: { length: 80 mm }\nerrors: { EXX: { points: [[0 mm, 0 um], [100 mm, 3 um]] } }\n");
    let _ = folder.write("m.yaml", &format!("extends: base.yaml\n{SMALL}tool: ~\nerrors: {{ EXX: ~ }}\nclass: ~\n"));
    let json = run(&folder, &["check", "m.yaml", "--format", "json"]).json();
    assert_eq!(json["errors"]["component"], 0);
}

#[test]
fn help_into_a_full_disk_and_files_at_their_limit_are_told() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    for arguments in [&["--help"][..], &["--version"], &["map", "--help"], &["schema"]] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = abbe().args(arguments).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let err = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(3) && err.contains("standard output"), "{arguments:?}: {err}");
    }
    // Nobody would know where to find the page.
    let full = File::options().write(true).open("/dev/full").unwrap();
    let served = abbe().args(["workbench", "m.yaml"]).current_dir(folder.path("")).stdout(full).output().unwrap();
    assert_eq!(served.status.code(), Some(3), "{}", String::from_utf8_lossy(&served.stderr));
    // The signal of the limit is not ignored here: the program has to stop before it.
    let limited = |command: &str| {
        let script = format!("ulimit -f 8; exec \"$0\" {command}");
        let mut shell = Command::new("sh");
        Run::of(shell.args(["-c", &script, env!("CARGO_BIN_EXE_abbe")]).current_dir(folder.path("")))
    };
    for option in ["--csv a.csv", "--json a.json", "--parquet a.parquet", "--vtk a.vtu"] {
        limited(&format!("map m.yaml --random 5000 --quiet --wide {option}"))
            .refused("E0810")
            .says("limit on the size of files");
    }
    let run = limited("schema > schema.json");
    assert!(run.code == Some(3) && run.err.contains("too large"), "{:?} {}", run.code, run.err);
    assert_eq!(crate::support::names(&folder.path("")), ["m.yaml", "schema.json"]);
}

/// A run that was killed between naming its file and renaming it leaves a hidden one; the next clears it, and that alone.
#[test]
fn what_a_killed_run_left_goes_with_the_next() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    let others = [".a.csv.tmp", ".a.csv.x1.tmp", ".b.csv.12.tmp"];
    for name in [".a.csv.123.tmp", ".a.csv.99999999.tmp"].iter().chain(&others) {
        let _ = folder.write(name, "half");
    }
    // One that a run is still writing.
    let _ = folder.write(".a.csv.7.tmp", "half");
    let held = File::open(folder.path(".a.csv.7.tmp")).unwrap();
    held.lock().unwrap();
    assert_eq!(run(&folder, &["map", "m.yaml", "--random", "3", "--csv", "a.csv"]).code, Some(0));
    assert_eq!(
        crate::support::names(&folder.path("")),
        [".a.csv.7.tmp", others[0], others[1], others[2], "a.csv", "m.yaml"]
    );
}

#[test]
fn numbers_that_are_none_leave_in_no_form() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    let run_plan = |noise: &str| run(&folder, &["identify", "m.yaml", "--plan", "5", "--noise", noise]);
    for noise in ["1e308 um", "1e300 m", "2 m"] {
        let refused = run_plan(noise);
        assert!(refused.code == Some(2) && !refused.out.contains("inf"), "{noise}: {}{}", refused.out, refused.err);
    }
    // A travel that a table of the target would write as one position.
    let short =
        SMALL.replace("100 mm]", "0.001 mm]") + "errors: { EXX: { points: [[0 mm, 1 um], [0.001 mm, 2 um]] } }\n";
    let _ = folder.write("short.yaml", &short);
    for target in ["pmac", "linuxcnc", "fanuc-pitch", "grid-csv", "twincat-axis"] {
        let more = ["--accept-unverified", "--poses", "5"];
        let run = compile(&folder.path("short.yaml"), target, &folder.path(target), &more);
        assert!(matches!(run.code, Some(0 | 1)) && !run.err.contains("panicked"), "{target}: {}", run.err);
    }
}

/// The same length in two units closes a turn.
#[test]
fn a_curve_closes_whatever_its_units() {
    let folder = Folder::new();
    let curve = |last: &str| {
        format!(
            "abbe: 1\nmachine: m\nchain: \"w C' b X t\"\naxes: {{ X: {{ travel: [0, 100] }}, C: {{ travel: continuous, origin: [0, 0, 0] }} }}\n\
             errors: {{ EXC: {{ points: [[0 deg, 0.969 um], [180 deg, 2 um], [360 deg, {last}]] }} }}\n"
        )
    };
    for (last, code) in [("969 nm", 0), ("0.000969 mm", 0), ("970 nm", 1)] {
        let _ = folder.write("m.yaml", &curve(last));
        let run = run(&folder, &["check", "m.yaml", "--quiet"]);
        assert_eq!(run.code, Some(code), "{last}: {}", run.err);
        if code == 1 {
            run.refused("E0410");
        }
    }
}

fn three(folder: &Folder, name: &str, errors: &str) -> std::path::PathBuf {
    let axes = [("X", 1), ("Y", 2), ("Z", 3)]
        .map(|(axis, n)| format!("  {axis}: {{ controller: {n}, travel: [0 mm, 400 mm], origin: [0, 0, 0] }}\n"))
        .concat();
    let text = format!(
        "abbe: 1\nmachine: Fräse\nchain: w b X Y Z t\naxes:\n{axes}errors:\n  {errors}: {{ points: [[0 mm, 0 urad], \
         [100 mm, 30 urad], [250 mm, -40 urad], [400 mm, 60 urad]] }}\nvolume: {{ step: 200 mm }}\n"
    );
    folder.write(name, &text)
}

/// Half a year later the error is another, and its plane another than the one that is installed: one plane for an axis
/// is all that the controller has.
#[test]
fn new_tables_keep_within_the_room_beside_the_installed_ones() {
    let folder = Folder::new();
    let (first, later) = (three(&folder, "first.yaml", "ECX"), three(&folder, "later.yaml", "EBX"));
    let old = folder.path("old");
    compile(&first, "twincat-axis", &old, &FEW).json();
    let new = folder.path("new");
    let over = [&FEW[..], &["--installed", old.to_str().unwrap()]].concat();
    let run = compile(&later, "twincat-axis", &new, &over);
    run.says("W0708").says("X and Z");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_eq!(verify(&later, &new, &over).code, Some(0));
    // Without new products, on top of a file that has some.
    let old = folder.path("cec");
    compile(&first, "sinumerik-cec", &old, &FEW).json();
    let without = [&FEW[..], &["--installed", old.to_str().unwrap(), "--without", "product"]].concat();
    let new = folder.path("cec-new");
    compile(&later, "sinumerik-cec", &new, &without).json();
    // The installed products are in the new file still: as many factors, or more.
    let factors =
        |out: &Path| std::fs::read_to_string(out.join("_N_NC_CEC_INI")).unwrap().matches("CEC_MULT_BY_TABLE").count();
    assert!(factors(&old) > 0 && factors(&new) >= factors(&old), "{} {}", factors(&old), factors(&new));
}

/// The name of a machine in a file for a controller that reads ASCII.
#[test]
fn names_are_ascii_where_the_controller_reads_nothing_else() {
    let folder = Folder::new();
    let machine = three(&folder, "m.yaml", "EXX");
    let text = std::fs::read_to_string(&machine).unwrap().replace("urad", "um");
    std::fs::write(&machine, text).unwrap();
    for (target, ascii) in [("sinumerik-cec", true), ("heidenhain-com", true), ("pmac", true), ("linuxcnc", false)] {
        let out = folder.path(target);
        let run = compile(&machine, target, &out, &[&FEW[..], &["--accept-unverified"]].concat());
        assert_eq!(run.code, Some(0), "{target}: {}", run.err);
        assert_eq!(run.err.contains("W0609"), ascii, "{target}: {}", run.err);
        let files = crate::support::set_files(&out).into_iter().filter(|name| name != "abbe.lock.json");
        for name in files {
            let bytes = std::fs::read(out.join(&name)).unwrap();
            assert!(!ascii || bytes.is_ascii(), "{target}: {name}");
        }
    }
}

/// Letters, names and numbers are the same joints.
#[test]
fn replay_takes_letters() {
    let folder = Folder::new();
    let machine = three(&folder, "m.yaml", "ECX");
    let out = folder.path("out");
    compile(&machine, "sinumerik-cec", &out, &FEW).json();
    let added = |joint: &str| {
        let file =
            folder.write("at.csv", &format!("axis,direction,position\n{joint},forward,0\n{joint},reverse,400\n"));
        let run = Run::of(abbe().arg("verify").arg(&machine).arg(&out).arg("--replay").arg(file).args(FEW));
        assert_eq!(run.code, Some(0), "{}", run.err);
        run.out.lines().skip(1).map(|line| line.split(',').nth(3).unwrap().to_owned()).collect::<Vec<_>>()
    };
    for (letter, number) in [("X", "0"), ("Y", "1"), ("Z", "2")] {
        assert_eq!(added(letter), added(number));
    }
    let file = folder.write("at.csv", "axis,direction,position\nQ,forward,0\n");
    Run::of(abbe().arg("verify").arg(&machine).arg(&out).arg("--replay").arg(file)).refused("E0802").says("X (0)");
}

/// The budget of a page is that of `budget` at as many poses.
#[test]
fn a_report_draws_its_budget_at_the_poses_asked_for() {
    let folder = Folder::new();
    let machine = folder
        .write("m.yaml", &format!("{SMALL}errors: {{ EXX: {{ tolerance: 9 um }}, EYX: {{ tolerance: 5 um }} }}\n"));
    let of = |poses: &str| {
        let more = ["--poses", poses, "--samples", "50"];
        let page = folder.path("page.html");
        let run = Run::of(abbe().arg("report").arg(&machine).args(more).arg("--out").arg(&page));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let data = packed::data(&std::fs::read_to_string(page).unwrap());
        let budget = Run::of(abbe().arg("budget").arg(&machine).args(more).args(["--format", "json"])).json();
        (data["machines"][0]["budget"].clone(), budget)
    };
    for poses in ["40", "700"] {
        let (page, budget) = of(poses);
        assert!(number(&page, "/position_um/rss") > 0.0);
        assert_eq!((&page["poses"], &page["position_um"]), (&budget["poses"], &budget["position_um"]), "{poses}");
        // The worst poses are searched besides.
        assert!((0.0..10.0).contains(&(number(&page, "/poses") - poses.parse::<f64>().unwrap())), "{poses}");
    }
}

/// A hundred thousand readings and more are a fair size: no limit of 16 MB.
#[test]
fn readings_of_more_than_16_mb_are_read() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    // Comments count as bytes and cost no time.
    let comment = format!("#{}\n", " ".repeat(1 << 20)).repeat(17);
    let rows: String = (0..=10).map(|i| format!("{},{}\n", 10 * i, 3 * i)).collect();
    let _ = folder.write("readings.csv", &format!("X [mm],dx [um]\n{rows}{comment}"));
    let run = run(&folder, &["identify", "m.yaml", "--data", "readings.csv", "--fit", "EXX", "--out", "f.yaml"]);
    assert!(!run.err.contains("E0103"), "{}", run.err);
    assert!(Path::new(&folder.path("f.yaml")).exists(), "{}", run.err);
}

/// The configuration `hmc-4ax` with every column of its tables times a factor of its own.
fn measured_again(folder: &Folder, round: usize) -> std::path::PathBuf {
    const FACTORS: [f64; 5] = [-1.5, 0.3, 2.0, -0.7, 3.0];
    let (root, own) = (Path::new(env!("CARGO_MANIFEST_DIR")).join("configs"), folder.path(&format!("round-{round}")));
    std::fs::create_dir_all(own.join("errors/hmc-4ax")).unwrap();
    std::fs::copy(root.join("hmc-4ax.yaml"), own.join("m.yaml")).unwrap();
    for entry in std::fs::read_dir(root.join("errors/hmc-4ax")).unwrap().map(Result::unwrap) {
        let scaled = |(k, cell): (usize, &str)| match cell.trim().parse::<f64>() {
            Ok(number) if k > 0 && round > 0 => (number * FACTORS[(k * round + round) % 5]).to_string(),
            _ => cell.to_owned(),
        };
        let text = std::fs::read_to_string(entry.path()).unwrap();
        let line = |line: &str| line.split(',').enumerate().map(scaled).collect::<Vec<_>>().join(",") + "\n";
        std::fs::write(own.join("errors/hmc-4ax").join(entry.file_name()), text.lines().map(line).collect::<String>())
            .unwrap();
    }
    own.join("m.yaml")
}

/// Round after round, each on top of the last one, with and without new products: never more tables than the control has.
#[test]
#[ignore = "soak: half a minute"]
fn rounds_of_sag_tables_stay_within_the_control() {
    let folder = Folder::new();
    let tables = |out: &Path| {
        let text = std::fs::read_to_string(out.join("_N_NC_CEC_INI")).unwrap();
        let numbers = text.split("$AN_CEC[").skip(1).map(|rest| rest.split(',').next().unwrap().to_owned());
        numbers.collect::<std::collections::BTreeSet<_>>().len()
    };
    let mut installed: Option<String> = None;
    let mut warned = false;
    for round in 0..4 {
        let machine = measured_again(&folder, round);
        let mut last = None;
        for without in [&[][..], &["--without", "product"]] {
            let out = folder.path(&format!("set-{round}-{}", without.len()));
            let over = installed.iter().flat_map(|old| ["--installed", old.as_str()]);
            let more: Vec<&str> = FEW.iter().copied().chain(over).chain(without.iter().copied()).collect();
            let run = compile(&machine, "sinumerik-cec", &out, &more);
            assert_eq!(run.code, Some(0), "round {round}: {}", run.err);
            warned |= run.err.contains("W0708");
            let count = tables(&out);
            assert!((1..=62).contains(&count), "round {round}: {count} tables");
            last = last.or(Some(out));
        }
        installed = last.map(|out| out.to_str().unwrap().to_owned());
    }
    assert!(warned, "the rounds never met the limit");
}

/// Installed curves of an error that the later machine does not have stand in one block with its own.
#[test]
fn curves_of_two_rounds_share_the_points_of_their_axis() {
    let folder = Folder::new();
    let machine = |name: &str, errors: &str| {
        let text = format!(
            "abbe: 1\nmachine: m\nchain: w b X Y Z t\naxes: {{ X: {{ travel: [0 mm, 400 mm], origin: [0, 0, 0] }}, \
             Y: {{ travel: [0, 300], origin: [0, 0, 0] }}, Z: {{ travel: [-200, 0], origin: [0, 0, 0] }} }}\n\
             tool: {{ gauge: [0, 0, 0], length: 80 mm }}\nerrors: {{ {errors} }}\n"
        );
        folder.write(name, &text)
    };
    let first = machine("1.yaml", "EBX: { points: [[0 mm, 0 urad], [200 mm, 12 urad], [400 mm, -8 urad]] }");
    let later = machine("2.yaml", "EXX: { points: [[0 mm, 0 um], [150 mm, 2.1 um], [400 mm, 3.4 um]] }");
    for (target, file) in [("isg-volcomp", "volcomp.csv"), ("etalon-exchange", "")] {
        let (old, new) = (folder.path(&format!("{target}-1")), folder.path(&format!("{target}-2")));
        compile(&first, target, &old, &FEW).json();
        let over = [&FEW[..], &["--installed", old.to_str().unwrap()]].concat();
        compile(&later, target, &new, &over).json();
        let found = verify(&later, &new, &over).json();
        let left = number(&found, "/compensated/position_um/max");
        assert!(number(&found, "/uncompensated/position_um/max") > 3.0 && left < 0.01, "{target}: {left}");
        if file.is_empty() {
            continue;
        }
        let text = std::fs::read_to_string(new.join(file)).unwrap();
        let mut lines = text.lines().skip_while(|line| !line.starts_with("X "));
        let names: Vec<&str> = lines.next().unwrap().split_whitespace().collect();
        let rows: Vec<Vec<f64>> = lines
            .map_while(|line| line.split_whitespace().map(|cell| cell.parse().ok()).collect())
            .take_while(|row: &Vec<f64>| row.len() == names.len())
            .collect();
        let column = |name: &str| names.iter().position(|known| *known == name).unwrap();
        let (exx, ebx) = (column("EXX"), column("EBX"));
        // Both curves at the points of either: EBX at 150 mm is three quarters of its value at 200 mm.
        let at = |q: f64| rows.iter().find(|row| row[0] == q).unwrap();
        assert!((at(150.0)[ebx] / at(200.0)[ebx] - 0.75).abs() < 1e-3, "{rows:?}");
        assert!((at(200.0)[exx] / at(150.0)[exx] - (2.1 + 1.3 / 5.0) / 2.1).abs() < 1e-3, "{rows:?}");
    }
}

/// A long chain is refused in the time of a short one.
#[test]
fn long_chains_are_refused_at_once() {
    let folder = Folder::new();
    for (word, count) in [("X ", 100_000), ("t ", 150_000), ("(S) ", 100_000)] {
        let chain = format!("w b {}t", word.repeat(count));
        let _ = folder.write("m.yaml", &SMALL.replace("w b X t", &format!("\"{chain}\"")));
        assert_eq!(soon(&folder, &["check", "m.yaml"]).code, Some(1));
    }
    let names: String = (0..60_000).map(|i| format!("X{i} ")).collect();
    let _ = folder.write("m.yaml", &SMALL.replace("w b X t", &format!("\"w b {names}t\"")));
    assert_eq!(soon(&folder, &["check", "m.yaml"]).code, Some(1));
}

/// One file in two spellings, before it is there.
#[test]
fn two_outputs_are_not_one_file() {
    let folder = Folder::new();
    let _ = folder.write("m.yaml", SMALL);
    std::fs::create_dir_all(folder.path("sub")).unwrap();
    let absolute = folder.path("out.dat");
    for other in ["./out.dat", "sub/../out.dat", absolute.to_str().unwrap()] {
        run(&folder, &["map", "m.yaml", "--random", "3", "--csv", "out.dat", "--json", other]).refused("E0630");
        assert!(!absolute.exists(), "{other}");
    }
    let run = run(&folder, &["map", "m.yaml", "--random", "3", "--csv", "out.dat", "--json", "sub/out.dat"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
}

/// In a mapping on one line a decimal comma begins another key, which has no value.
#[test]
fn decimal_commas_make_no_other_numbers() {
    let folder = Folder::new();
    let turned = SMALL.replace("travel: [0 mm, 100 mm]", "travel: continuous").replace(['X'], "C");
    for (base, line, word) in [
        (SMALL, "volume: { step: 10,5 mm }", "`5 mm` stands here"),
        (SMALL, "tolerances: { X: 1,5 um }", "`5 um` stands here"),
        (SMALL, "volume: { foo: ~ }", "unknown key `foo`"),
        (SMALL, "tools: { a: { length: 80,5 mm } }", "`5 mm` stands here"),
        (turned.as_str(), "errors: { EXC: { harmonics: { 1,5: [2 um, 1 um] } } }", "`1` stands here"),
    ] {
        let _ = folder.write("m.yaml", &format!("{base}{line}\n"));
        let run = run(&folder, &["check", "m.yaml"]);
        assert!(run.code == Some(1) && run.err.contains(word), "{line}: {}", run.err);
    }
    // What is written to remove something has a colon.
    let _ = folder.write("base.yaml", &format!("{SMALL}errors: {{ EXX: 1 um, EYX: 2 um }}\n"));
    let _ = folder.write("m.yaml", "extends: base.yaml\nerrors: { EXX: ~, EYX: null, EZX: }\n");
    assert_eq!(run(&folder, &["check", "m.yaml"]).code, Some(0));
}

/// A replacement goes through a file of a fixed name.
#[test]
fn a_machine_file_of_any_name_stays() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("out")).unwrap();
    let text = format!("{SMALL}errors: {{ EXX: {{ points: [[0 mm, 0 um], [100 mm, 3 um]] }} }}\n");
    let machine = folder.write("out/.abbe-set.json", &text);
    compile(&machine, "linuxcnc", &folder.path("out"), &FEW).refused("E0630");
    assert_eq!(std::fs::read_to_string(&machine).unwrap(), text);
}

/// A changed copy of a target is not passed over in silence.
#[test]
fn a_copied_target_takes_another_name() {
    let folder = Folder::new();
    let machine = folder.write("m.yaml", &format!("{SMALL}errors: {{ EXX: 3 um }}\n"));
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates/pmac");
    std::fs::create_dir_all(folder.path("mine/pmac")).unwrap();
    for entry in std::fs::read_dir(&own).unwrap().map(Result::unwrap) {
        std::fs::copy(entry.path(), folder.path("mine/pmac").join(entry.file_name())).unwrap();
    }
    let mine = folder.path("mine");
    let more = ["--templates", mine.to_str().unwrap(), "--map", "X=#1"];
    compile(&machine, "pmac", &folder.path("same"), &more).json();
    let manifest = std::fs::read_to_string(own.join("target.yaml")).unwrap();
    assert!(manifest.contains("mm: 160000"));
    let _ = folder.write("mine/pmac/target.yaml", &manifest.replace("mm: 160000", "mm: 320000"));
    compile(&machine, "pmac", &folder.path("other"), &more).refused("E0703").says("a name of its own");
}

/// The effects of errors and pairs are held: not of any number of poses.
#[test]
fn effects_are_bounded_in_number() {
    let folder = Folder::new();
    let rows: String = (0..4000).map(|i| format!("{},0,0,0,0\n", i % 400)).collect();
    let _ = folder.write("poses.csv", &format!("X,Y,Z,C,A\n{rows}"));
    let machine = config("trunnion.yaml");
    let more = ["--axis-poses", "poses.csv", "--sensitivity", "--interactions"];
    let run = soon(&folder, &[&["eval", machine.to_str().unwrap()][..], &more].concat());
    assert!(run.code == Some(2) && run.err.contains("at most 250000 effects"), "{}", run.err);
}

/// Bounds on slopes are judged with the rest of the file, not only by a fit.
#[test]
fn slopes_of_a_file_are_slopes() {
    let folder = Folder::new();
    for (slope, code) in [
        (".nan", "E0206"),
        ("-1 um/m", "E0213"),
        ("0 um/m", "E0213"),
        ("3 um", "E0205"),
        ("5", "E0204"),
        ("1e400 um/m", "E0206"),
    ] {
        let _ =
            folder.write("m.yaml", &format!("{SMALL}identify: {{ fit: [EXX:poly2], slopes: {{ EXX: {slope} }} }}\n"));
        run(&folder, &["check", "m.yaml"]).refused(code);
    }
    let _ = folder.write("m.yaml", &format!("{SMALL}identify: {{ fit: [EXX:poly2], slopes: {{ EXX: 20 um/m }} }}\n"));
    assert_eq!(run(&folder, &["check", "m.yaml"]).code, Some(0));
}
