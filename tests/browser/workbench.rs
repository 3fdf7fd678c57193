//! `abbe workbench`.

use crate::driver::Browser;
use crate::watch::{Serving, wait};
use crate::{Folder, abbe, kept};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// A machine of which nothing is measured.
pub const BOUNDED: &str = "abbe: 1\nmachine: \"<b>Bounded</b> & <script>alert(1)</script>\"\nchain: \"w b X Y Z t\"\naxes:\n  \
    X: { travel: [0, 500], origin: [0, 0, 0] }\n  Y: { travel: [0, 400], origin: [0, 0, 0] }\n  \
    Z: { travel: [0, 300], origin: [0, 0, 0] }\ntolerances:\n  EXX: 4 um\n  EBX: 10 urad\n  X-Y: 20 urad\n";

/// A workbench with a browser before it.
pub struct Bench {
    pub browser: Browser,
    pub file: PathBuf,
    pub address: String,
    serving: Option<Serving>,
    _folder: Folder,
}

impl Bench {
    /// Opens a copy of a machine file with its tables.
    pub fn of_config(name: &str, machine: &str) -> Self {
        let text = std::fs::read_to_string(Path::new("configs").join(machine)).unwrap();
        Self::new(name, &text, (1400, 900))
    }

    pub fn new(name: &str, text: &str, size: (u32, u32)) -> Self {
        Self::with(name, text, size, &[])
    }

    /// Opens a machine file with more arguments.
    pub fn with(name: &str, text: &str, (width, height): (u32, u32), more: &[&str]) -> Self {
        let folder = Folder::new(name);
        let file = folder.0.join("m.yaml");
        std::fs::write(&file, text).unwrap();
        copy(Path::new("configs/errors"), &folder.0.join("errors"));
        let mut child =
            abbe().arg("workbench").arg(&file).args(more).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.split(' ').next().unwrap().to_owned();
        assert!(address.starts_with("http://127.0.0.1:"), "{line}");
        let browser = Browser::new(width, height);
        browser.open(&address);
        let bench = Self { browser, file, address, serving: Some(Serving(child)), _folder: folder };
        bench.settled();
        bench
    }

    /// Opens the page of a report, with a copy of its machine file for the command line.
    pub fn mailed(name: &str, page: &Path, machine: &str) -> Self {
        let folder = Folder::new(name);
        let file = folder.0.join("m.yaml");
        let _ = std::fs::copy(Path::new("configs").join(machine), &file).unwrap();
        copy(Path::new("configs/errors"), &folder.0.join("errors"));
        let browser = Browser::new(1400, 900);
        browser.open_file(page);
        let bench = Self { browser, file, address: String::new(), serving: None, _folder: folder };
        bench.settled();
        bench
    }

    /// Ends the program that serves the page, and returns its port.
    pub fn end(&mut self) -> String {
        self.serving = None;
        let rest = self.address.trim_start_matches("http://127.0.0.1:");
        rest.split('/').next().unwrap().to_owned()
    }

    /// Starts another one on the same port.
    pub fn begin_anew(&mut self, port: &str) {
        let mut child = abbe()
            .arg("workbench")
            .arg(&self.file)
            .args(["--port", port])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        self.address = line.split(' ').next().unwrap().to_owned();
        self.serving = Some(Serving(child));
    }

    /// Waits until all is computed for the text as it is.
    pub fn settled(&self) {
        wait(&self.browser, "return document.body.dataset.state === 'full' && !document.body.dataset.busy;");
    }

    /// The whole number behind a figure.
    pub fn figure(&self, at: &str) -> f64 {
        let value = self.browser.run(&format!("return document.querySelector('[data-at=\"{at}\"]').dataset.value;"));
        value.as_str().unwrap().parse().unwrap()
    }

    pub fn click(&self, id: &str) {
        let _ = self.browser.run(&format!("document.getElementById('{id}').click();"));
    }

    pub fn save(&self) -> String {
        self.click("save");
        wait(&self.browser, "return document.getElementById('save').disabled;");
        self.settled();
        self.on_disk()
    }

    pub fn on_disk(&self) -> String {
        std::fs::read_to_string(&self.file).unwrap()
    }

    /// What the command line says of the file as it is on the disk.
    pub fn command(&self, verb: &str, more: &[&str]) -> Value {
        let output =
            abbe().arg(verb).arg(&self.file).args(more).args(["--format", "json", "--quiet"]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Compares the figures of a measured machine with the command line's.
    pub fn agrees(&self) {
        self.agrees_with(&[]);
    }

    /// The same with further options of the command line.
    pub fn agrees_with(&self, more: &[&str]) {
        self.agrees_at(2000, more);
    }

    /// The same at another number of poses.
    pub fn agrees_at(&self, poses: usize, more: &[&str]) {
        let map = self.command("map", &[&["--random", &poses.to_string()], more].concat());
        let pairs = [("p95", "p95"), ("max", "max"), ("rms", "rms"), ("mean", "mean")];
        for (at, name) in pairs {
            assert_eq!(Some(self.figure(at)), map["position_um"][name].as_f64(), "{at}");
        }
        assert_eq!(Some(self.figure("rotation")), map["rotation_urad"]["p95"].as_f64());
    }

    /// Puts the cursor before the number of an error.
    pub fn at_error(&self, error: &str) {
        let all = "const all = [...document.querySelectorAll('#panel-errors button')].find((b) => b.textContent.includes('all'));";
        let find = "[...document.querySelectorAll('.error-name')].find((b) => b.textContent === ";
        let _ = self.browser.run(&format!("{all} if (all) all.click(); {find}'{error}').click();"));
        wait(&self.browser, "return document.activeElement.classList.contains('cm-content');");
    }

    /// Presses keys where the cursor is.
    pub fn types(&self, text: &str) {
        let keys: Vec<String> = text.chars().map(String::from).collect();
        self.browser.press(&keys.iter().map(String::as_str).collect::<Vec<_>>());
    }

    pub fn quiet(&self) {
        assert!(self.browser.complaints().is_empty(), "{:?}", self.browser.complaints());
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
        let target = to.join(entry.file_name().unwrap());
        if entry.is_dir() {
            copy(&entry, &target);
        } else {
            let _ = std::fs::copy(&entry, &target).unwrap();
        }
    }
}

/// Lines in which two texts differ.
fn changed(before: &str, after: &str) -> Vec<(String, String)> {
    assert_eq!(before.lines().count(), after.lines().count());
    let pairs = before.lines().zip(after.lines()).filter(|(a, b)| a != b);
    pairs.map(|(a, b)| (a.to_owned(), b.to_owned())).collect()
}

const DELETE: &str = "\u{e017}";
const RIGHT: &str = "\u{e014}";
const LEFT: &str = "\u{e012}";

pub fn numbers() {
    let bench = Bench::of_config("bench-numbers", "trunnion.yaml");
    bench.agrees();
    let worst = bench.command("map", &["--random", "2000"])["position_um"]["max"].as_f64().unwrap();
    bench.click("worst");
    wait(
        &bench.browser,
        &format!(
            "const at = document.querySelector('[data-at=here]'); return at && Math.abs(at.dataset.value - {worst}) < 1e-9;"
        ),
    );
    for (error, digits, value) in [("EY0C", 2, "3.25"), ("EB0A", 2, "-41"), ("EC0Y", 2, "0.5")] {
        bench.at_error(error);
        bench.browser.press(&vec![DELETE; digits]);
        bench.types(value);
        let text = bench.save();
        assert!(text.contains(&format!("{error}: {value} u")), "{text}");
        bench.agrees();
    }
    bench.quiet();
    let bench = Bench::of_config("bench-tools", "vmc-cframe-754.yaml");
    bench.agrees_with(&["--tool", "short"]);
    let short = bench.figure("p95");
    let choose =
        "const tool = document.getElementById('tool'); tool.value = 'long'; tool.dispatchEvent(new Event('change'));";
    let _ = bench.browser.run(choose);
    bench.settled();
    assert_ne!(bench.figure("p95"), short);
    bench.agrees_with(&["--tool", "long"]);
}

pub fn edits() {
    let bench = Bench::of_config("bench-edits", "trunnion.yaml");
    let (original, figure) = (bench.on_disk(), bench.figure("p95"));
    bench.at_error("EY0C");
    bench.browser.press(&[DELETE, DELETE]);
    bench.types("-2");
    wait(&bench.browser, "return document.querySelector('.headline .better') !== null;");
    bench.settled();
    assert!(bench.figure("p95") < figure);
    assert_eq!(bench.on_disk(), original, "written before it was saved");
    // The arrow key on the slider is a drag of one step; its undo takes the step back, and nothing else.
    let _ = bench.browser.run("document.getElementById('number').focus();");
    bench.browser.press(&[RIGHT, RIGHT]);
    let saved = bench.save();
    let lines = changed(&original, &saved);
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].1.starts_with("  EY0C: -1.") && lines[0].1.ends_with(" um"), "{lines:?}");
    bench.agrees();
    assert_eq!(bench.browser.run("return document.querySelector('.headline .difference');"), Value::Null);
    let undo = "[...document.querySelectorAll('#actions button')].find((b) => b.textContent === 'Undo')";
    wait(&bench.browser, &format!("const undo = {undo}; if (!undo.disabled) undo.click(); return undo.disabled;"));
    assert_eq!(bench.save(), original);
    assert_eq!(bench.figure("p95"), figure);
    // Somebody else writes the file: the page does not write over it.
    bench.at_error("EY0C");
    bench.types("1");
    wait(&bench.browser, "return !document.getElementById('save').disabled;");
    std::fs::write(&bench.file, format!("{original}# by hand\n")).unwrap();
    bench.click("save");
    wait(&bench.browser, "return document.getElementById('problem').textContent.includes('has changed');");
    assert_eq!(bench.on_disk(), format!("{original}# by hand\n"));
}

/// While a slider is held the figures are those of the command line where errors have values, and no draft; from bounds
/// they are of fewer machines, and the page says so.
pub fn drafts() {
    let hold = "const slider = document.getElementById('number'); slider.value = Number(slider.value) + Number(slider.step); \
        slider.dispatchEvent(new Event('input'));";
    let words = "return document.getElementById('verdict').textContent;";
    let slanted = "return getComputedStyle(document.querySelector('[data-at=p95]')).fontStyle === 'italic';";
    let measured = std::fs::read_to_string("configs/trunnion.yaml").unwrap();
    for (text, is_draft) in [(measured.as_str(), false), (BOUNDED, true)] {
        let bench = Bench::new("bench-drafts", text, (1400, 900));
        let before = bench.figure("p95");
        let _ = bench.browser.run(hold);
        wait(&bench.browser, "return document.body.dataset.state === 'draft' && !document.body.dataset.busy;");
        let said = bench.browser.run(words);
        assert_eq!(said.as_str().unwrap().contains("Draft: 100 drawn machines."), is_draft, "{said}");
        assert_eq!(said.as_str().unwrap().contains("Draft"), is_draft, "{said}");
        assert_eq!(bench.browser.run(slanted), is_draft);
        let held = bench.figure("p95");
        let _ = bench.browser.run("document.getElementById('number').dispatchEvent(new Event('change'));");
        bench.settled();
        assert_eq!(bench.figure("p95") == held, !is_draft, "{before} {held}");
        assert!(!bench.browser.run(words).as_str().unwrap().contains("Draft"));
        bench.quiet();
    }
}

pub fn chain() {
    let bench = Bench::of_config("bench-chain", "trunnion.yaml");
    let original = bench.on_disk();
    let _ = bench.browser.run("document.querySelector('[data-axis=Y]').focus();");
    bench.browser.press(&[RIGHT]);
    wait(&bench.browser, "return document.querySelector('[data-axis=Y]').textContent === 'Y';");
    bench.settled();
    // The chip keeps the focus: further keys move it on.
    for (key, chain) in [(RIGHT, "w C' A' b X Y Z t"), (LEFT, "w C' A' b Y X Z t")] {
        bench.browser.press(&[key]);
        let is_moved = format!("return document.querySelector('.cm-content').innerText.includes(\"{chain}\");");
        wait(&bench.browser, &is_moved);
        bench.settled();
        assert_eq!(bench.browser.run("return document.activeElement.dataset.axis;"), "Y");
    }
    let saved = bench.save();
    assert_eq!(changed(&original, &saved), [line("w C' A' Y' b X Z t", "w C' A' b Y X Z t")]);
    bench.agrees();
    // Dragged back across the bed, in front of A.
    let middle = |axis: &str| {
        let script = format!(
            "const r = document.querySelector('[data-axis={axis}]').getBoundingClientRect(); return [r.x, r.y + r.height / 2, r.width];"
        );
        let found = bench.browser.run(&script);
        [0, 1, 2].map(|i| found[i].as_f64().unwrap())
    };
    let ([x, y, width], [to, ..]) = (middle("Y"), middle("A"));
    bench.browser.drag((x + width / 2.0, y), (to + 2.0, y));
    wait(&bench.browser, "return document.querySelector('[data-axis=Y]').textContent === \"Y'\";");
    assert_eq!(changed(&original, &bench.save()), [line("w C' A' Y' b X Z t", "w C' Y' A' b X Z t")]);
    bench.agrees();
    bench.quiet();
}

/// Axes join and leave by the list behind the chips, with their entries and errors.
pub fn axes() {
    let bench = Bench::of_config("bench-axes", "trunnion.yaml");
    let original = bench.on_disk();
    let choose = |wish: &str| {
        let script = format!(
            "const list = document.querySelector('.axes-choice'); list.value = '{wish}'; \
             list.dispatchEvent(new Event('change'));"
        );
        let _ = bench.browser.run(&script);
    };
    choose("+B");
    wait(&bench.browser, "return document.querySelector('[data-axis=B]') !== null;");
    let saved = bench.save();
    assert!(saved.contains("chain: \"w C' A' Y' b X Z B t\""), "{saved}");
    assert!(saved.contains("  B: { travel: [-90 deg, 90 deg] }\n"), "{saved}");
    assert_eq!(saved.lines().count(), original.lines().count() + 1);
    bench.agrees();
    choose("-B");
    wait(&bench.browser, "return document.querySelector('[data-axis=B]') === null;");
    assert_eq!(bench.save(), original);
    choose("-A");
    wait(&bench.browser, "return document.querySelector('[data-axis=A]') === null;");
    let saved = bench.save();
    assert!(original.contains("EC0A:") && !saved.contains("EC0A:") && !saved.contains("\n  A:"), "{saved}");
    assert!(saved.contains("EC0C:") || saved.contains("EX0C:"), "{saved}");
    bench.agrees();
    form(&bench);
    bench.quiet();
}

/// A field of the form writes into its own line, and shows what the text says afterwards.
fn form(bench: &Bench) {
    let before = bench.on_disk();
    let field = "const field = document.getElementById('form-axes-X-travel');";
    let _ = bench.browser.run("document.getElementById('forms').open = true;");
    wait(&bench.browser, &format!("{field} return field?.value === '[0 mm, 500 mm]';"));
    let write = "field.value = '[0 mm, 400 mm]'; field.dispatchEvent(new Event('change'));";
    let _ = bench.browser.run(&format!("{field} {write}"));
    bench.settled();
    let saved = bench.save();
    let (line, new) = changed(&before, &saved).remove(0);
    assert_eq!((changed(&before, &saved).len(), line.replace("500", "400")), (1, new));
    bench.agrees();
    let undo = "[...document.querySelectorAll('#actions button')].find((b) => b.textContent === 'Undo').click();";
    let _ = bench.browser.run(undo);
    wait(&bench.browser, &format!("{field} return field.value === '[0 mm, 500 mm]';"));
}

/// A body of the picture is taken and drawn: its axis moves, and the readout is that of the pose.
pub fn drag() {
    let bench = Bench::of_config("bench-drag", "trunnion.yaml");
    let place = "const r = document.querySelector('#stage canvas').getBoundingClientRect(); \
                 return [r.left, r.top, r.width, r.height];";
    let found = bench.browser.run(place);
    let [left, top, width, height] = [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap());
    let axes = || bench.browser.run("return [...document.querySelectorAll('#axes output')].map((o) => o.textContent);");
    let before = axes();
    let taken = (1..20).flat_map(|i| (1..20).map(move |k| (i, k))).find(|(i, k)| {
        let at = (left + width * f64::from(*i) / 20.0, top + height * f64::from(*k) / 20.0);
        let hover = serde_json::json!({"type": "mouseMoved", "x": at.0, "y": at.1});
        let _ = bench.browser.devtools("Input.dispatchMouseEvent", &hover);
        let cursor = bench.browser.run("return document.querySelector('#stage canvas').style.cursor;");
        if cursor != "grab" {
            return false;
        }
        bench.browser.drag(at, (at.0 + 60.0, at.1 + 40.0));
        axes() != before
    });
    assert!(taken.is_some(), "no body of the machine can be taken");
    let moved = axes();
    let changed = (0..5).filter(|i| moved[*i] != before[*i]).count();
    assert_eq!(changed, 1, "one axis moves: {before} {moved}");
    bench.settled();
    let pose = bench.browser.run("return new URLSearchParams(location.hash.slice(1)).get('pose');");
    let printed = bench.command("eval", &["--at", pose.as_str().unwrap()]);
    let component = |k: usize| printed["poses"][0]["deviation"][k].as_f64().unwrap() * 1e3;
    let um = (0..3).map(|k| component(k).powi(2)).sum::<f64>().sqrt();
    // The address rounds the pose.
    let near = format!(
        "const at = document.querySelector('[data-at=here]'); return Math.abs(at?.dataset.value - {um}) < 1e-2;"
    );
    wait(&bench.browser, &near);
    bench.quiet();
}

fn line(before: &str, after: &str) -> (String, String) {
    (format!("chain: \"{before}\""), format!("chain: \"{after}\""))
}

pub fn refusals() {
    let bench = Bench::of_config("bench-refusals", "trunnion.yaml");
    let figure = bench.figure("p95");
    bench.at_error("EB0Z");
    bench.types("x");
    wait(&bench.browser, "return document.querySelector('#diagnostics .refusal') !== null;");
    let said = bench.browser.run("return document.querySelector('#diagnostics .refusal').textContent;");
    assert!(said.as_str().unwrap().starts_with("line 26:") && said.as_str().unwrap().contains("x-22"), "{said}");
    assert_eq!(bench.browser.run("return document.querySelectorAll('.cm-lintRange-error').length;"), 1);
    assert_eq!(bench.browser.run("return document.querySelectorAll('#verdict.stale').length;"), 1);
    assert_eq!(bench.figure("p95"), figure);
    bench.quiet();
}

pub fn bounds() {
    let bench = Bench::new("bench-bounds", BOUNDED, (1400, 900));
    let budget = bench.command("budget", &[]);
    let p95 = &budget["position_um"]["monte_carlo"]["percentiles"]["p95"];
    assert_eq!(Some(bench.figure("p95")), p95["value"].as_f64());
    assert_eq!(Some(bench.figure("rss")), budget["position_um"]["rss"].as_f64());
    assert!(bench.figure("p95") > 0.0);
    let words = bench.browser.run("return document.getElementById('verdict').textContent;");
    assert!(words.as_str().unwrap().contains("Nothing of this machine is measured"), "{words}");
    // The worst of the poses may not be the worst of the volume.
    let poses = format!("at the worst of {} poses in the volume", budget["poses"]);
    assert!(words.as_str().unwrap().contains(&poses), "{words}");
    let limit = "const limit = document.getElementById('limit'); limit.value = '1e6'; \
                 limit.dispatchEvent(new Event('input')); return document.querySelector('.verdict-passes').textContent;";
    let judged = bench.browser.run(limit);
    assert!(judged.as_str().unwrap().ends_with("others may be worse"), "{judged}");
    // What the bounds lead to at the zero pose, whose tip is the workpiece origin.
    let tip = bench.file.with_file_name("tip.csv");
    std::fs::write(&tip, "X, Y, Z\n0, 0, 0\n").unwrap();
    let map =
        bench.command("map", &["--reference", "machine", "--tool-poses", tip.to_str().unwrap(), "--samples", "300"]);
    assert_eq!(Some(bench.figure("here")), map["position_um"]["max"].as_f64(), "{map}");
    let name = bench.browser.run("return document.getElementById('name').textContent;");
    assert_eq!(name, "<b>Bounded</b> & <script>alert(1)</script>");
    bench.quiet();
}

pub fn tokens() {
    let bench = Bench::new("bench-tokens", BOUNDED, (800, 600));
    let (host, token) = bench.address.trim_start_matches("http://").split_once("/#token=").unwrap();
    let host = host.to_owned();
    // The page that any account may fetch does not hold the token, and the address bar no longer.
    let script = "return fetch('/').then((page) => page.text());";
    assert!(!bench.browser.run(script).as_str().unwrap().contains(token) && token.len() == 32);
    let is_seen =
        format!("return document.documentElement.outerHTML.includes('{token}') || location.href.includes('{token}');");
    assert_eq!(bench.browser.run(&is_seen), false);
    let _ = bench.browser.run("delete document.body.dataset.state; location.reload();");
    bench.settled();
    assert_eq!(bench.browser.run("return document.getElementById('problem').textContent;"), "");
    let ask = |head: &str| {
        let mut stream = TcpStream::connect(&host).unwrap();
        stream.write_all(head.replace('\n', "\r\n").replace("HOST", &host).as_bytes()).unwrap();
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer).unwrap();
        answer.split(' ').nth(1).unwrap().to_owned()
    };
    assert_eq!(ask("GET / HTTP/1.1\nHost: HOST\n\n"), "200");
    assert_eq!(ask("GET / HTTP/1.1\nHost: evil.example\n\n"), "421");
    assert_eq!(ask("GET /m.yaml HTTP/1.1\nHost: HOST\n\n"), "404");
    for path in ["/open", "/ask", "/save"] {
        let body = r#"{"text": "x", "before": "x"}"#;
        let head = format!("POST {path} HTTP/1.1\nHost: HOST\nContent-Length: {}\n\n{body}", body.len());
        assert_eq!(ask(&head), "403", "{path}");
        assert_eq!(ask(&head.replace("Content", "X-Abbe-Token: 00\nContent")), "403", "{path}");
    }
    let known = format!("POST /open HTTP/1.1\nHost: HOST\nX-Abbe-Token: {token}\nMORE\n\n");
    let more = |line: &str| ask(&known.replace("MORE", line));
    for own in ["Origin: http://HOST", "Sec-Fetch-Site: same-origin", "Sec-Fetch-Site: none", "Accept: */*"] {
        assert_eq!(more(own), "200", "{own}");
    }
    for foreign in
        ["Origin: http://evil.example", "Origin: null", "Sec-Fetch-Site: cross-site", "Sec-Fetch-Site: same-site"]
    {
        assert_eq!(more(foreign), "403", "{foreign}");
        assert_eq!(ask(&format!("GET / HTTP/1.1\nHost: HOST\n{foreign}\n\n")), "403", "{foreign}");
    }
    assert_eq!(ask("POST /save HTTP/1.1\nHost: HOST\nContent-Length: 99999999\n\n"), "413");
    assert_eq!(bench.on_disk(), BOUNDED);
}

pub fn screenshots() {
    for machine in ["trunnion", "vmc-cframe-754", "hmc-4ax", "hh-ca-gantry", "ht-nut45-c"] {
        let bench = Bench::of_config(&format!("bench-{machine}"), &format!("{machine}.yaml"));
        bench.click("worst");
        std::thread::sleep(std::time::Duration::from_secs(2));
        bench.browser.screenshot(&kept().join(format!("workbench-{machine}.png")), false);
        let wide = bench.browser.run("return document.documentElement.scrollWidth <= innerWidth;");
        assert_eq!(wide, true, "{machine} is cut");
        bench.quiet();
    }
    let bench = Bench::new("bench-narrow", BOUNDED, (390, 844));
    let size = serde_json::json!({"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": true});
    let _ = bench.browser.devtools("Emulation.setDeviceMetricsOverride", &size);
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert_eq!(bench.browser.run("return document.documentElement.scrollWidth <= 390;"), true, "cut at 390 px");
    bench.browser.screenshot(&kept().join("workbench-narrow.png"), true);
}
