//! The report page as text: it holds the numbers of the other verbs, loads nothing else, and a refusal leaves no file.
//! The page in a browser is in `tests/browser`.

use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use crate::support::packed::{self, data};
use crate::support::sha256;
use serde_json::{Value, json as object};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

fn page(folder: &Folder, arguments: &[&str]) -> String {
    let out = folder.file("page.html");
    abbe(&[&["report"], arguments, &["--out", text(&out), "--quiet"]].concat());
    std::fs::read_to_string(out).unwrap()
}

/// Returns the text between two marks.
fn between<'a>(page: &'a str, from: &str, to: &str) -> &'a str {
    page.split_once(from).unwrap().1.split_once(to).unwrap().0
}

/// Equal but for rounding: `map` goes through the compiled plan, the page does not (1e-12 mm, 1e-15 rad).
fn near(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            (a - b).abs() <= 1e-12 * b.abs() + 1e-9
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(a, b)),
        (Value::Object(a), Value::Object(b)) => a.len() == b.len() && a.iter().all(|(k, v)| near(v, &b[k])),
        _ => a == b,
    }
}

#[test]
fn the_page_loads_nothing_and_its_policy_names_its_own_style_and_scripts() {
    use base64::Engine;
    let folder = Folder::new("report-alone");
    let page = page(&folder, &["vmc-cframe-754.yaml", "--poses", "50"]);
    let policy = between(&page, "http-equiv=\"Content-Security-Policy\" content=\"", "\"");
    assert!(policy.starts_with("default-src 'none';") && policy.contains("connect-src 'none'"), "{policy}");
    let scripts: Vec<&str> =
        page.split("<script>").skip(1).map(|rest| rest.split("</script>").next().unwrap()).collect();
    assert_eq!(scripts.len(), 2, "the workbench's, and that of the appendices");
    for script in &scripts {
        let hex = sha256::sha256(script.as_bytes());
        let bytes: Vec<u8> = (0..32).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()).collect();
        let hash = base64::engine::general_purpose::STANDARD.encode(bytes);
        assert!(policy.contains(&hash), "{hash}: {policy}");
    }
    let nonce = between(policy, "style-src 'nonce-", "'");
    assert_eq!(page.matches("<style").count(), page.matches(&format!("<style nonce=\"{nonce}\"")).count());
    // What the program writes: all but the bundle of the workbench with its licences, and the machine files.
    let own = page.replacen(scripts[0], "", 1);
    let (body, licences) = own.split_once("<!-- The script above contains").unwrap();
    assert!(licences.trim_end().ends_with("</html>"));
    let own = body.replacen(packed::element(body, "start"), "", 1).replacen(packed::element(body, "data"), "", 1);
    let addresses: Vec<&str> =
        own.split("http").skip(1).filter(|rest| !rest.starts_with("://www.w3.org/2000/svg\"")).collect();
    // The policy's own header is named; no address is.
    assert!(addresses.iter().all(|rest| rest.starts_with("-equiv=")), "{addresses:?}");
    for word in ["<link", "src=", "@import", "url("] {
        assert_eq!(own.matches(word).count(), usize::from(word == "<link"), "{word}");
    }
    assert!(!own.contains(" style=") && !own.contains(" onclick="), "the policy would not let these through");
}

/// Without a package there is no engine; with one beside the program the page carries it, and says so.
#[test]
fn a_packaged_program_puts_its_engine_into_the_page() {
    let folder = Folder::new("report-engine");
    let out = folder.file("page.html");
    let report = |program: &Path| {
        let arguments = ["report", "vmc-cframe-754.yaml", "--poses", "20", "--format", "json", "--out", text(&out)];
        let output = Command::new(program).current_dir(crate::configs::folder()).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
        (printed["engines"].clone(), std::fs::read_to_string(&out).unwrap())
    };
    let (engines, page) = report(Path::new(env!("CARGO_BIN_EXE_abbe")));
    assert_eq!(engines, object!([]));
    assert!(!page.contains("'wasm-unsafe-eval'; worker-src") && !page.contains("id=\"engine-"));
    for name in ["bin", "share/abbe"] {
        std::fs::create_dir_all(folder.file(name)).unwrap();
    }
    let program = folder.file("bin/abbe");
    let _ = std::fs::copy(env!("CARGO_BIN_EXE_abbe"), &program).unwrap();
    std::fs::write(folder.file("share/abbe/engine-plain.wasm.gz"), [1, 2, 3]).unwrap();
    let (engines, page) = report(&program);
    assert_eq!(engines, object!(["plain"]));
    assert!(page.contains("'wasm-unsafe-eval'; worker-src blob:;"));
    assert_eq!(between(&page, "id=\"engine-plain\">", "<"), "AQID");
}

#[test]
fn its_statistics_are_those_of_map_compare_and_compile() {
    let folder = Folder::new("report-numbers");
    let page =
        page(&folder, &["trunnion.yaml", "ht-b-c.yaml", "--target", "linuxcnc", "--poses", "400", "--seed", "7"]);
    let data = data(&page);
    for (i, file) in ["trunnion.yaml", "ht-b-c.yaml"].into_iter().enumerate() {
        let machine = &data["machines"][i];
        let map = json(&["map", file, "--random", "400", "--seed", "7", "--format", "json"]);
        for key in ["position_um", "rotation_urad"] {
            assert!(near(&machine["statistics"][key], &map[key]), "{file} {key}");
        }
        assert_eq!(machine["worst"][0]["axes"], map["worst"][0]["axes"]);
        assert!(near(&machine["diagonals"][1]["deviations_um"], &map["diagonals"][1]["deviations_um"]));
        let out = folder.file(&format!("set{i}"));
        let certificate = json(&[
            "compile",
            file,
            "--target",
            "linuxcnc",
            "--out",
            text(&out),
            "--poses",
            "400",
            "--seed",
            "7",
            "--format",
            "json",
            "--quiet",
        ]);
        let shown = &machine["certificates"][0];
        for state in ["uncompensated", "compensated"] {
            assert!(near(&shown[state], &certificate[state]), "{file} {state}");
        }
        for error in shown["errors"].as_array().unwrap() {
            let other = &certificate["errors"][error["error"].as_str().unwrap()];
            assert!(near(&error["left_um"], &other["left_um"]) && error["handled"] == other["handled"], "{error}");
        }
    }
    let compare =
        json(&["compare", "trunnion.yaml", "ht-b-c.yaml", "--poses", "400", "--seed", "7", "--format", "json"]);
    for i in 0..2 {
        for key in ["position_um", "rotation_urad", "unreachable"] {
            assert!(near(&data["comparison"]["machines"][i][key], &compare["machines"][i][key]), "{i} {key}");
        }
    }
    assert_eq!(data["comparison"]["poses"], compare["poses"]);
}

/// The nodes of the 3D view with their positions: the first axis runs fastest.
fn nodes(field: &Value) -> Vec<Vec<(String, f64)>> {
    let grid = field["grid"].as_array().unwrap();
    let mut list: Vec<Vec<(String, f64)>> = vec![Vec::new()];
    for axis in grid.iter().rev() {
        let name = axis["name"].as_str().unwrap();
        let positions = axis["positions"].as_array().unwrap();
        let with = |rest: &Vec<(String, f64)>| {
            positions
                .iter()
                .map(|q| [&[(name.to_owned(), q.as_f64().unwrap())], &rest[..]].concat())
                .collect::<Vec<_>>()
        };
        list = list.iter().flat_map(with).collect();
    }
    list
}

/// Positions of the other axes, from a station's words.
fn station(label: &str) -> Vec<(String, f64)> {
    let one = |part: &str| {
        let (name, value) = part.split_once(" = ").unwrap();
        (name.to_owned(), value.trim_end_matches(['°', 'm', ' ']).parse().unwrap())
    };
    label.split(", ").filter(|part| !part.is_empty()).map(one).collect()
}

#[test]
fn the_field_of_the_view_is_the_one_eval_gives() {
    let folder = Folder::new("report-field");
    let page = page(&folder, &["trunnion.yaml", "--target", "linuxcnc", "--poses", "50"]);
    let field = &data(&page)["machines"][0]["field"];
    let nodes = nodes(field);
    let layer = |id: &str| field["layers"].as_array().unwrap().iter().find(|l| l["id"] == id).unwrap();
    let vector = |id: &str, at: usize, node: usize| -> [f64; 3] {
        std::array::from_fn(|k| layer(id)["at"][at]["deviation_nm"][3 * node + k].as_f64().unwrap() * 1e-3)
    };
    for (s, of) in field["stations"].as_array().unwrap().iter().enumerate() {
        let others = station(of["label"].as_str().unwrap());
        // Every 17th node: all corners of the grid's cube are not needed to find a wrong order.
        for node in (0..nodes.len()).step_by(17) {
            let at =
                nodes[node].iter().chain(&others).map(|(name, q)| format!("{name}={q}")).collect::<Vec<_>>().join(",");
            let eval = json(&["eval", "trunnion.yaml", "--frame", "machine", "--at", &at, "--format", "json"]);
            for k in 0..3 {
                let exact = eval["poses"][0]["deviation"][k].as_f64().unwrap() * 1e3;
                assert!((vector("total", s, node)[k] - exact).abs() <= 0.0005 + 1e-9, "{at}: {k}");
                let nominal = eval["poses"][0]["nominal"][k].as_f64().unwrap();
                assert!(
                    (of["nominal_mm"][3 * node + k].as_f64().unwrap() - nominal).abs() <= 0.0005 + 1e-9,
                    "{at}: {k}"
                );
            }
            if s > 1 {
                break; // One node of the later stations: each `eval` is a process.
            }
        }
        for node in 0..nodes.len() {
            let total = vector("total", s, node);
            let after: [f64; 3] =
                std::array::from_fn(|k| vector("after-linuxcnc", s, node)[k] + vector("removed-linuxcnc", s, node)[k]);
            let kinds: [f64; 3] =
                std::array::from_fn(|k| vector("location", s, node)[k] + vector("component", s, node)[k]);
            for k in 0..3 {
                // Three numbers of whole nanometres; first order neglects some nm on this machine.
                assert!((after[k] - total[k]).abs() <= 0.0016, "after and removed do not add up");
                assert!((kinds[k] - total[k]).abs() <= 0.03, "{kinds:?} {total:?}");
            }
        }
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new("report-threads");
    let run = |threads: usize| {
        let out = folder.file("page.html");
        let output = abbe_on(
            threads,
            &["report", "trunnion.yaml", "--target", "linuxcnc", "--poses", "60", "--out", text(&out), "--quiet"],
        );
        assert!(output.status.success());
        std::fs::read(out).unwrap()
    };
    assert!(run(1) == run(3));
}

/// Pages of machines: each is whole, and has a field.
fn have_pages(files: &[&str]) {
    let folder = Folder::new("report-all");
    for file in files {
        let out = folder.file("page.html");
        let output = abbe_on(2, &["report", file, "--poses", "20", "--out", text(&out), "--quiet"]);
        assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
        let page = std::fs::read_to_string(&out).unwrap();
        assert!(page.len() < 5_000_000 && page.trim_end().ends_with("</html>"), "{file}: {}", page.len());
        assert!(!data(&page)["machines"][0]["field"]["layers"].as_array().unwrap().is_empty(), "{file}");
    }
}

#[test]
fn every_kind_of_machine_has_a_page() {
    have_pages(&["millturn-bc.yaml", "robots/ur5.yaml", "lathes/lathe-xzc.yaml"]);
}

#[test]
#[ignore = "soak: more machines of kinds that a test of every change has"]
fn more_machines_have_a_page() {
    have_pages(&["gantry-3ax.yaml", "boring-w.yaml", "papers/hrdina-vasik-2014.yaml", "hh-bd-ram.yaml"]);
}

#[test]
fn what_is_refused_leaves_nothing() {
    let folder = Folder::new("report-refused");
    let own = folder.with(
        "m.yaml",
        &std::fs::read_to_string(crate::configs::folder().join("gantry-3ax.yaml"))
            .unwrap()
            .replace("errors/", &format!("{}/errors/", crate::configs::folder().display())),
    );
    let before = std::fs::read(&own).unwrap();
    let (code, message) = refused(&["report", text(&own), "--poses", "5", "--out", text(&own)]);
    assert!(code == 1 && message.contains("E0630"), "{message}");
    assert_eq!(std::fs::read(&own).unwrap(), before);
    assert_eq!(refused(&["report", text(&own), "--out", text(&own), "--watch"]).0, 2);
    for more in [&["trunnion.yaml"][..], &["--poses", "5"], &["--tool", "t"], &["--target", "linuxcnc"]] {
        assert_eq!(refused(&[&["report", text(&own), "--watch"], more].concat()).0, 2, "{more:?}");
    }
    assert!(std::fs::read(&own).unwrap() == before);
    let out = folder.file("p.html");
    assert_eq!(refused(&["report", "trunnion.yaml"]).0, 2);
    let (code, message) = refused(&["report", "none.yaml", "--out", text(&out)]);
    assert!(code == 1 && message.contains("E0101"), "{message}");
    let (code, message) = refused(&["report", "trunnion.yaml", "--target", "nobody", "--out", text(&out)]);
    assert!(code == 1 && message.contains("E0701"), "{message}");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let (code, message) = refused(&["report", "trunnion.yaml", "--watch", "--port", &port]);
    assert!(code == 1 && message.contains("E0631"), "{message}");
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 1);
}

/// The workbench behind `report --watch`, ended with this value.
struct Serving(Child, u16);

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Serving {
    fn new(file: &Path) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_abbe"))
            .args(["report", text(file), "--watch"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let port = between(&line, "http://127.0.0.1:", "/").parse().unwrap();
        Self(child, port)
    }

    /// Sends a request and returns status line and headers, and the body.
    fn ask(&self, request: &str) -> (String, String) {
        let mut stream = std::net::TcpStream::connect(("127.0.0.1", self.1)).unwrap();
        // A server that has read enough closes, which the system may report as a failure.
        let _ = stream.write_all(request.replace("PORT", &self.1.to_string()).replace('\n', "\r\n").as_bytes());
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
        let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
        (head.to_owned(), body.to_owned())
    }
}

#[test]
fn the_watching_page_is_the_workbench_and_answers_this_computer_only() {
    let folder = Folder::new("report-watch");
    let file = folder.with("m.yaml", "abbe: 1\nmachine: M\nchain: w b X t\naxes: { X: { travel: [0, 500] } }\n");
    let serving = Serving::new(&file);
    let (head, body) = serving.ask("GET / HTTP/1.1\nHost: localhost:PORT\n\n");
    assert!(head.starts_with("HTTP/1.1 200") && body.contains("\"evaluator\":\"program\""), "{head}");
    for (request, status) in [
        ("GET / HTTP/1.1\nHost: evil.example\n\n", "421"),
        ("GET / HTTP/1.1\n\n", "421"),
        ("GET /m.yaml HTTP/1.1\nHost: 127.0.0.1:PORT\n\n", "404"),
        ("POST / HTTP/1.1\nHost: 127.0.0.1:PORT\nContent-Length: 0\n\n", "403"),
        ("PUT / HTTP/1.1\nHost: 127.0.0.1:PORT\nContent-Length: 0\n\n", "405"),
        ("nonsense\n\n", "400"),
    ] {
        let (head, body) = serving.ask(request);
        assert!(head.starts_with(&format!("HTTP/1.1 {status}")) && body.is_empty(), "{request}: {head}");
    }
    let (head, body) = serving.ask(&format!("GET / HTTP/1.1\nX: {}\n\n", "x".repeat(20_000)));
    assert!((head.is_empty() || head.starts_with("HTTP/1.1 431")) && body.is_empty(), "a request without end: {head}");
}

#[test]
fn its_budgets_and_instruments_are_those_of_their_verbs() {
    let folder = Folder::new("report-budget");
    let class = ["--class", "production", "--samples", "60"];
    let files = ["trunnion.yaml", "ht-b-c.yaml"];
    let page = page(&folder, &[&files[..], &class, &["--poses", "90", "--seed", "5"]].concat());
    let data = data(&page);
    for (i, file) in files.into_iter().enumerate() {
        let machine = &data["machines"][i];
        let budget =
            json(&[&["budget", file, "--poses", "90", "--seed", "5", "--format", "json"], &class[..]].concat());
        for (key, value) in machine["budget"].as_object().unwrap() {
            assert_eq!(value, &budget[key], "{file}: {key}");
        }
        assert!(machine["budget"]["tighten"].as_array().unwrap().len() > 30);
        let bar = json(&["instrument", file, "ball-bar", "--radius", "150", "--format", "json"]);
        assert_eq!(machine["instruments"]["ball_bar"]["planes"], bar["planes"], "{file}");
        assert_eq!(machine["instruments"]["ball_bar"]["centre"], bar["centre"], "{file}");
        let lines = json(&["instrument", file, "diagonals", "--format", "json"]);
        assert_eq!(machine["instruments"]["diagonals"]["diagonals"], lines["diagonals"], "{file}");
        for turn in machine["instruments"]["r_test"]["axes"].as_array().unwrap() {
            let at: Vec<String> =
                turn["ball_at"].as_object().unwrap().iter().map(|(axis, q)| format!("{axis}={q}")).collect();
            let name = turn["axis"].as_str().unwrap();
            let own = json(&["instrument", file, "r-test", "--axis", name, "--at", &at.join(","), "--format", "json"]);
            for key in ["readings", "range_um", "skipped"] {
                assert_eq!(turn[key], own["axes"][0][key], "{file} {name} {key}");
            }
        }
    }
    let compare =
        json(&[&["compare"], &files[..], &class, &["--poses", "90", "--seed", "5", "--format", "json"]].concat());
    assert_eq!(data["comparison"]["budgets"], compare["budgets"]);
    for id in ["m1-budget", "m2-budget", "m1-instruments", "comparison-budgets"] {
        assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
    }
}

#[test]
fn without_tolerances_there_is_no_budget_and_without_linear_axes_no_path() {
    let folder = Folder::new("report-none");
    let three = page(&folder, &["vmc-cframe-754.yaml", "--poses", "20"]);
    assert!(data(&three)["machines"][0]["budget"].is_null() && !three.contains("m1-budget"));
    let robot = page(&folder, &["robots/ur5.yaml", "--poses", "20"]);
    assert!(robot.contains("The machine can follow none of the paths"));
    let out = folder.file("page2.html");
    let (code, message) = refused(&["report", "trunnion.yaml", "--class", "commodity", "--out", text(&out)]);
    assert!(code == 1 && message.contains("E0605") && !out.exists(), "{message}");
}

/// The intervals of `map`, the form of an axis and what a fit calls type B stand on the page.
#[test]
fn the_page_has_the_uncertainty_of_a_fitted_file() {
    let folder = Folder::new("report-uncertainty");
    let file = folder.with(
        "fitted.yaml",
        "abbe: 1\nmachine: m\nchain: \"w Y' b X Z t\"\naxes:\n  X: { travel: [0, 500], origin: [0, 0, 0] }\n  \
         Y: { travel: [0, 400], origin: [0, 0, 0] }\n  Z: { travel: [-300, 0], origin: [0, 0, 0] }\n\
         errors:\n  EXX: { value: 10 um, uncertainty: 2 um }\n\
         covariance:\n  - { form: { axis: X, size: 0.8 um, rotation: 2 urad, length: 60 mm } }\n\
         identify: { fit: [EXX], type_b: [\"laser 0.4 um/m\"] }\n",
    );
    let page = page(&folder, &[text(&file), "--poses", "60", "--seed", "3"]);
    let found = &data(&page)["machines"][0]["uncertainty"];
    let map = json(&["map", text(&file), "--random", "60", "--seed", "3", "--format", "json"]);
    assert!(near(&found["intervals"], &map["uncertainty"]), "{found} {}", map["uncertainty"]);
    let form = object!([{"axis": "X", "size_um": 0.8, "rotation_urad": 2.0, "length": 60.0, "unit": "mm"}]);
    assert!(near(&found["forms"], &form), "{}", found["forms"]);
    assert_eq!(found["type_b"], object!(["laser 0.4 um/m"]));
    assert!(page.contains("type B, one standard deviation each") && page.contains("laser 0.4 um"));
    // A file that states none has no such part.
    let sure = folder.with(
        "sure.yaml",
        &std::fs::read_to_string(&file).unwrap().split("covariance").next().unwrap().replace(", uncertainty: 2 um", ""),
    );
    let bare = abbe(&["report", text(&sure), "--poses", "20", "--out", text(&folder.file("sure.html")), "--quiet"]);
    assert!(bare.is_empty() || !bare.contains("Intervals"));
    let bare = std::fs::read_to_string(folder.file("sure.html")).unwrap();
    assert!(data(&bare)["machines"][0]["uncertainty"].is_null() && !bare.contains("Form of the axes"));
}
