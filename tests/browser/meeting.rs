//! What a design review does at `abbe workbench`: reads the eight answers, brushes a curve, picks in the field, puts
//! pictures side by side, writes over what another file gives, and reads all of it on a phone.

use crate::driver::Browser;
use crate::watch::wait;
use crate::workbench::Bench;
use crate::{abbe, kept};
use serde_json::{Value, json};
use std::path::Path;

const RIGHT: &str = "\u{e014}";
const DELETE: &str = "\u{e017}";

fn trunnion() -> String {
    std::fs::read_to_string("configs/trunnion.yaml").unwrap()
}

/// Puts a value into a field, as typing and choosing do.
fn fill(bench: &Bench, id: &str, value: &str) {
    let _ = bench.browser.run(&format!(
        "const field = document.getElementById('{id}'); field.value = '{value}'; \
         for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind));"
    ));
}

fn number(bench: &Bench, script: &str) -> f64 {
    let found = bench.browser.run(script);
    found.as_f64().or_else(|| found.as_str()?.parse().ok()).unwrap_or_else(|| panic!("{script}: {found}"))
}

fn hover(browser: &Browser, (x, y): (f64, f64)) {
    let event = json!({"type": "mouseMoved", "x": x, "y": y, "button": "none"});
    let _ = browser.devtools("Input.dispatchMouseEvent", &event);
    let _ = browser.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));");
}

/// Left, top, width and height of an element.
fn frame(bench: &Bench, selector: &str) -> [f64; 4] {
    let script = format!(
        "const r = document.querySelector('{selector}').getBoundingClientRect(); return [r.x, r.y, r.width, r.height];"
    );
    let found = bench.browser.run(&script);
    [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap())
}

/// Length of the deviation that the command line prints for a pose, um.
fn printed(bench: &Bench, pose: &str) -> f64 {
    let printed = bench.command("eval", &["--at", pose]);
    (0..3).map(|k| printed["poses"][0]["deviation"][k].as_f64().unwrap().powi(2)).sum::<f64>().sqrt() * 1e3
}

/// The eight questions stand answered on one screen, with the numbers of the command line.
pub fn questions() {
    // Of the location errors one is measured; a class bounds the others.
    let is_kept = |line: &&str| !line.starts_with("  E") || line.starts_with("  EY0A");
    let machine = trunnion();
    let lines: Vec<&str> = machine.lines().filter(is_kept).collect();
    let text = format!("{}\nclass: production\n", lines.join("\n"));
    let bench = Bench::new("bench-questions", &text, (1400, 900));
    let [work, first] = ["work.csv", "a.yaml"].map(|name| bench.file.with_file_name(name));
    std::fs::copy("docs/examples/work.csv", &work).unwrap();
    std::fs::copy(&bench.file, &first).unwrap();
    fill(&bench, "work", work.to_str().unwrap());
    wait(&bench.browser, "return document.querySelectorAll('#target option').length > 5;");
    fill(&bench, "target", "linuxcnc-kins");
    let path = work.to_str().unwrap();
    let bound =
        &bench.command("budget", &["--tool-poses", path])["position_um"]["monte_carlo"]["percentiles"]["p95"]["value"];
    fill(&bench, "goal", &format!("{:.1}", 0.8 * bound.as_f64().unwrap()));
    bench.click("keep-a");
    // Bounds rank over the job; the error with a value stands below them, and leads to its line.
    bench.at_error("EY0A");
    bench.browser.press(&[DELETE, DELETE]);
    bench.types("-2");
    bench.settled();
    let find = "const find = document.querySelector('#answer-tighten button'); find?.click(); return find !== null;";
    wait(&bench.browser, find);
    wait(&bench.browser, "return document.getElementById('answer-tighten').textContent.includes('cost');");
    let all = "[...document.querySelectorAll('.answers td')]";
    wait(&bench.browser, &format!("return {all}.length === 8 && {all}.every((of) => !of.matches('.none'));"));
    wait(&bench.browser, "return document.querySelector('[data-at=answer-by]') !== null;");
    std::thread::sleep(std::time::Duration::from_secs(2));
    let last = number(&bench, &format!("return Math.max(...{all}.map((of) => of.getBoundingClientRect().bottom));"));
    assert!(last <= 900.0, "the last answer ends at {last}");
    bench.browser.screenshot(&kept().join("workbench-questions.png"), false);
    let _ = bench.save();
    let output = abbe()
        .args(["compare", "--format", "json", "--quiet"])
        .args([&first, &bench.file])
        .args(["--tool-poses", path])
        .output()
        .unwrap();
    let compared: Value = serde_json::from_slice(&output.stdout).unwrap();
    let by = compared["verdicts"][0]["by"]["um"].as_f64();
    assert_eq!(Some(bench.figure("answer-by")), by, "{compared}");
    let answer = |of: &str| {
        let found = bench.browser.run(&format!("return document.getElementById('answer-{of}').textContent;"));
        found.as_str().unwrap().to_owned()
    };
    assert!(answer("better").starts_with("✓ The present state") && by.unwrap() < 0.0, "{}", answer("better"));
    assert!(answer("fits").starts_with("✗ No, travel: 7 of 8 poses"), "{}", answer("fits"));
    // What has a value acts in the machines drawn, so that the bounds rank.
    let most = bench.command("budget", &["--tool-poses", path])["tighten"][0]["error"].as_str().unwrap().to_owned();
    assert!(answer("dominates").contains(&most), "{most} {}", answer("dominates"));
    let corrected = bench.command("map", &["--tool-poses", path, "--target", "linuxcnc-kins"]);
    assert_eq!(Some(bench.figure("answer-after")), corrected["position_um"]["max"].as_f64());
    let bar = bench.command("instrument", &["ball-bar"]);
    let planes = bar["planes"].as_array().unwrap().iter().map(|of| of["bidirectional_um"].as_f64().unwrap());
    assert_eq!(bench.figure("answer-bar"), planes.fold(0.0, f64::max));
    assert!(answer("tighten").contains("cost"), "{}", answer("tighten"));
    // A question leads to its panel.
    let _ = bench.browser.run("document.querySelectorAll('.answers button')[4].click();");
    assert_eq!(bench.browser.run("return document.getElementById('panel-part').hidden;"), false);
    bench.quiet();
}

/// The curve along an axis is read under the pointer, and the machine goes where it is dragged.
pub fn curve() {
    let bench = Bench::of_config("bench-curve", "trunnion.yaml");
    bench.click("tab-curve");
    fill(&bench, "curve-axis", "X");
    wait(&bench.browser, "return document.querySelector('#curve[aria-label*=\"along X\"] svg') !== null;");
    let [left, top, width, height] = frame(&bench, "#curve");
    // The axes of the chart begin at 46 and end at 396 of 420.
    let at = |share: f64| (left + width * (46.0 + 350.0 * share) / 420.0, top + height / 2.0);
    for share in [0.1, 0.5, 0.93] {
        hover(&bench.browser, at(share));
        let x = number(&bench, "return document.querySelector('[data-at=curve]').dataset.axisAt;");
        assert!((x - 500.0 * share).abs() <= 500.0 / 80.0, "{x} at {share}");
        assert!((bench.figure("curve") - printed(&bench, &format!("X={x}"))).abs() < 1e-9);
    }
    bench.browser.drag(at(0.2), at(0.5));
    let x = number(&bench, "return document.getElementById('axis-X').value;");
    assert!((x - 250.0).abs() < 2.0, "dragged to {x}");
    wait(&bench.browser, "return location.hash.includes('pose=X');");
    let um = printed(&bench, &format!("X={x}"));
    let here = "const at = document.querySelector('[data-at=here]');";
    wait(&bench.browser, &format!("{here} return Math.abs(at?.dataset.value - {um}) < 1e-2;"));
    bench.browser.drag(at(0.5), (left + 4.0 * width, top + height / 2.0));
    assert_eq!(bench.browser.run("return document.getElementById('axis-X').value;"), "500", "the end of the travel");
    let _ = bench.browser.run("document.getElementById('curve').focus();");
    bench.browser.press(&["\u{e012}"]);
    assert_eq!(number(&bench, "return document.getElementById('axis-X').value;"), 493.75);
    // Where the machine stands each error has its part in the deviation there.
    bench.click("tab-errors");
    bench.click("here");
    let um = printed(&bench, "X=493.75");
    let sum = "[...document.querySelectorAll('#panel-errors .bars [data-value]')].reduce((sum, of) => sum + Number(of.dataset.value), 0)";
    let all = "[...document.querySelectorAll('#panel-errors button')].find((of) => of.textContent.startsWith('Show all'))?.click();";
    wait(&bench.browser, &format!("{all} return Math.abs({sum} - {um}) < {};", 1e-3 * um));
    bench.quiet();
}

/// Colours of the scale of deviations on a light ground.
const SCALE: &str = "['#f3e3a8', '#f0a95b', '#d9623b', '#9b2d4d', '#4a1247']";

/// Colours of the scale in steps: mixed in linear light, as three.js does. And the pixels of the picture.
const PIXELS: &str = "
    const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    const display = (c) => 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
    const stops = SCALE.map((hex) => [1, 3, 5].map((k) => linear(parseInt(hex.slice(k, k + 2), 16) / 255)));
    const colour = (share) => {
        const at = Math.min(Math.max(share, 0), 1) * 4, low = Math.min(Math.floor(at), 3);
        return [0, 1, 2].map((k) => display(stops[low][k] + (stops[low + 1][k] - stops[low][k]) * (at - low)));
    };
    const canvas = document.querySelector('#stage canvas'), copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const brush = copy.getContext('2d');
    brush.drawImage(canvas, 0, 0);
    const {data, width, height} = brush.getImageData(0, 0, copy.width, copy.height);
    const pixel = (x, y) => [0, 1, 2, 3].map((k) => data[4 * (y * width + x) + k]);
    const near = (a, b, by) => [0, 1, 2].every((k) => Math.abs(a[k] - b[k]) <= by);
";

fn pixels(rest: &str) -> String {
    format!("{}{rest}", PIXELS.replace("SCALE", SCALE))
}

/// 64 tries in the field and 64 beside it: the readout is of the node whose colour the eye sees, or of none.
pub fn picks() {
    let bench = Bench::of_config("bench-picks", "trunnion.yaml");
    fill(&bench, "field", "all");
    wait(&bench.browser, "return document.getElementById('scale') !== null;");
    std::thread::sleep(std::time::Duration::from_secs(1));
    // Places amid one colour: of the scale, or of castings (which are opaque and lit).
    let script = pixels(
        "const steps = Array.from({length: 401}, (_, i) => colour(i / 400)), found = {node: [], body: []};
         const around = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => [x, y]));
         for (let y = 3; y < height - 3; y++) for (let x = 3; x < width - 3; x++) {
             const here = pixel(x, y);
             if (here[3] !== 255 || !around.every(([i, k]) => near(pixel(x + i, y + k), here, 0))) continue;
             if (steps.some((of) => near(of, here, 2))) found.node.push([x, y]);
             else if (!steps.some((of) => near(of, here, 25))) found.body.push([x, y]);
         }
         const box = canvas.getBoundingClientRect(), k = canvas.width / box.width;
         const some = (list) => list.length < 64 ? [] : Array.from({length: 64}, (_, i) => list[Math.floor((i + 0.5) * list.length / 64)]);
         const place = ([x, y]) => [box.left + (x + 0.5) / k, box.top + (y + 0.5) / k, x, y];
         return {node: some(found.node).map(place), body: some(found.body).map(place),
                 counts: [found.node.length, found.body.length]};",
    );
    let found = bench.browser.run(&script);
    assert!(found["counts"][0].as_u64() >= Some(64) && found["counts"][1].as_u64() >= Some(64), "{}", found["counts"]);
    let coordinate = |place: &Value, i: usize| place[i].as_f64().unwrap();
    let mut told = std::collections::BTreeSet::new();
    for place in found["node"].as_array().unwrap() {
        hover(&bench.browser, (coordinate(place, 0), coordinate(place, 1)));
        let right = pixels(&format!(
            "const note = document.getElementById('readout'), most = Number(document.getElementById('scale').dataset.most);
             const um = parseFloat(note.textContent);
             return [!note.hidden && near(colour(um / most), pixel({0}, {1}), 6), note.textContent, pixel({0}, {1})];",
            place[2], place[3]
        ));
        let seen = bench.browser.run(&right);
        assert_eq!(seen[0], true, "{place}: {seen}");
        let _ = told.insert(seen[1].to_string());
    }
    assert!(told.len() > 10, "one node only: {told:?}");
    for place in found["body"].as_array().unwrap() {
        hover(&bench.browser, (coordinate(place, 0), coordinate(place, 1)));
        let note = bench
            .browser
            .run("const note = document.getElementById('readout'); return note.hidden ? '' : note.textContent;");
        assert_eq!(note, "", "a hidden node is read out at {place}");
    }
    bench.quiet();
}

/// Two pictures on one scale, looked at together: variant A, and what a control leaves.
pub fn beside() {
    let bench = Bench::of_config("bench-beside", "trunnion.yaml");
    bench.click("keep-a");
    fill(&bench, "field", "Z");
    fill(&bench, "beside-choice", "a");
    let same =
        "const [a, b] = [...document.querySelectorAll('#stages canvas')]; return b && a.toDataURL() === b.toDataURL();";
    let differ =
        "const [a, b] = [...document.querySelectorAll('#stages canvas')]; return a.toDataURL() !== b.toDataURL();";
    wait(&bench.browser, "return document.querySelector('[data-at=beside]') !== null;");
    wait(&bench.browser, same);
    assert_eq!(bench.figure("beside"), bench.figure("here"));
    // One is turned, beside the machine: both are.
    let before = bench.browser.run("return document.querySelector('#stage canvas').toDataURL();");
    let [left, top, width, height] = frame(&bench, "#beside canvas");
    bench.browser.drag((left + 0.9 * width, top + 0.05 * height), (left + 0.6 * width, top + 0.2 * height));
    wait(&bench.browser, same);
    assert_ne!(bench.browser.run("return document.querySelector('#stage canvas').toDataURL();"), before);
    bench.click("worst");
    std::thread::sleep(std::time::Duration::from_secs(2));
    wait(&bench.browser, same);
    let was = bench.figure("here");
    bench.at_error("EY0C");
    bench.browser.press(&[DELETE, DELETE]);
    bench.types("-2");
    wait(&bench.browser, differ);
    bench.settled();
    wait(
        &bench.browser,
        &format!("return Math.abs(document.querySelector('[data-at=beside]').dataset.value - {was}) < 1e-9;"),
    );
    assert_ne!(bench.figure("here"), was);
    bench.browser.screenshot(&kept().join("workbench-beside.png"), false);
    // The control: what its files leave at a pose, as `map` has it.
    bench.click("tab-control");
    wait(&bench.browser, "return document.querySelectorAll('#target option').length > 5;");
    fill(&bench, "target", "linuxcnc-kins");
    wait(&bench.browser, "return document.querySelector('[data-at=\"with-p95\"]') !== null;");
    let _ = bench.save();
    fill(&bench, "beside-choice", "control");
    bench.click("zero");
    std::thread::sleep(std::time::Duration::from_secs(3));
    let poses = bench.file.with_file_name("tip.csv");
    let nominal = bench.command("eval", &[]);
    let tip: Vec<String> = (0..3).map(|k| nominal["poses"][0]["nominal"][k].to_string()).collect();
    std::fs::write(&poses, format!("X, Y, Z, A, C\n{}, 0, 0\n", tip.join(", "))).unwrap();
    let map = bench.command(
        "map",
        &["--reference", "machine", "--tool-poses", poses.to_str().unwrap(), "--target", "linuxcnc-kins"],
    );
    let left_um = map["position_um"]["max"].as_f64().unwrap();
    wait(
        &bench.browser,
        &format!("return Math.abs(document.querySelector('[data-at=beside]')?.dataset.value - {left_um}) < 1e-6;"),
    );
    assert!(bench.figure("here") > left_um);
    bench.quiet();
}

/// A value that the base gives becomes an entry of the open file; the base stays.
pub fn overrides() {
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/trunnion.yaml");
    let text = format!("abbe: 1\nextends: {}\nmachine: Variant  # of the trunnion\n", base.display());
    let bench = Bench::new("bench-overrides", &text, (1400, 900));
    bench.agrees();
    let before = bench.figure("p95");
    let choose = "const list = document.querySelector('#whatif select'); list.value = 'override EY0C'; \
                  list.dispatchEvent(new Event('change')); return list.value;";
    assert_eq!(bench.browser.run(choose), "errors › EY0C");
    bench.settled();
    assert_eq!(bench.figure("p95"), before, "the same value");
    let _ = bench.browser.run("document.getElementById('number').focus();");
    bench.browser.press(&[RIGHT, RIGHT]);
    let saved = bench.save();
    assert_eq!(saved.strip_prefix(&text), Some("errors:\n  EY0C: -8.8 um\n"), "{saved}");
    assert_ne!(bench.figure("p95"), before);
    bench.agrees();
    assert_eq!(std::fs::read_to_string(&base).unwrap(), trunnion());
    bench.quiet();
}

/// On a phone no panel is cut.
pub fn narrow() {
    let bench = Bench::of_config("bench-phone", "trunnion.yaml");
    let work = bench.file.with_file_name("work.csv");
    std::fs::copy("docs/examples/work.csv", &work).unwrap();
    fill(&bench, "work", work.to_str().unwrap());
    bench.click("keep-a");
    let size = json!({"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": true});
    let _ = bench.browser.devtools("Emulation.setDeviceMetricsOverride", &size);
    fill(&bench, "field", "all");
    fill(&bench, "beside-choice", "a");
    for tab in ["answers", "errors", "curve", "tighten", "variants", "part", "control", "acceptance"] {
        bench.click(&format!("tab-{tab}"));
        std::thread::sleep(std::time::Duration::from_millis(900));
        let cut = bench.browser.run(
            "const wide = [...document.querySelectorAll('main *, header *')].filter((of) => \
             !of.closest('.cm-editor, svg, .scroll') && of.getBoundingClientRect().right > 391); \
             return [document.documentElement.scrollWidth, ...wide.map((of) => of.outerHTML.slice(0, 120))];",
        );
        assert_eq!(cut, json!([390]), "{tab} is cut");
        bench.browser.screenshot(&kept().join(format!("workbench-390-{tab}.png")), true);
    }
    bench.quiet();
}

/// What an acceptance test reads and what a control could repair is answered of bounds, too.
fn answers_of_bounds(bench: &Bench) {
    wait(&bench.browser, "return document.querySelector('[data-at=answer-bar]') !== null;");
    let bar = bench.command("instrument", &["ball-bar"]);
    let planes = bar["bounds"]["readings"].as_array().unwrap().iter().map(|of| of["p95_um"]["value"].as_f64().unwrap());
    assert_eq!(bench.figure("answer-bar"), planes.fold(0.0, f64::max));
    wait(&bench.browser, "return document.querySelectorAll('#target option').length > 5;");
    fill(bench, "target", "linuxcnc-kins");
    wait(&bench.browser, "return document.querySelector('#answer-repair [data-at=answer-after]') !== null;");
    let [before, after] = ["before", "after"].map(|of| bench.figure(&format!("answer-{of}")));
    let said = bench.browser.run("return document.getElementById('answer-repair').textContent;");
    let said = said.as_str().unwrap();
    assert!(after < 0.5 * before && said.contains("of 11 machines drawn between the bounds"), "{said}");
    let tests = bench.browser.run("return document.querySelectorAll('#panel-acceptance tbody tr').length;");
    assert_eq!(tests, 3 + 6 + 4, "rows of the tests");
}

/// With a job everything is over it and its reference, as the command line has it, and a switch shows the volume.
pub fn scope() {
    const P95: &str = "/position_um/monte_carlo/percentiles/p95/value";
    let without = |text: &str, kept: &str| -> String {
        let is_error = |line: &&str| ["  E", "  - errors", "measured:"].iter().any(|of| line.starts_with(of));
        let lines = text.lines().filter(|line| !is_error(line) || line.starts_with(&format!("  {kept}:")));
        lines.collect::<Vec<_>>().join("\n")
    };
    let bounded = without(&trunnion(), "-").replace("errors:", "");
    for (name, text, is_bounded) in
        [("bench-scope", trunnion(), false), ("bench-scope-bounds", format!("{bounded}\nclass: production\n"), true)]
    {
        let text = format!("{text}\njob: {{ tool_poses: work.csv, limit: 15 um }}\n");
        let bench = Bench::new(name, &text, (1400, 900));
        std::fs::copy("docs/examples/work.csv", bench.file.with_file_name("work.csv")).unwrap();
        wait(&bench.browser, "return document.querySelector('[data-at=job]') !== null;");
        let map = bench.command("map", &[]);
        let headline = bench.figure("job");
        assert!((headline - map["limit"]["um"].as_f64().unwrap()).abs() < 1e-9, "{headline} {map}");
        let said = |selector: &str| {
            let found = bench.browser.run(&format!("return document.querySelector('{selector}').textContent;"));
            found.as_str().unwrap().to_owned()
        };
        assert_eq!(said("#scope"), "Error over the job: 7 of 8 tool poses, zero");
        // The limit is the job's, and judges the headline beside it: out of reach is not done.
        let verdict = said(".limit strong");
        assert_eq!(map["limit"]["held"].is_null(), verdict.starts_with("Open"), "{verdict} {}", map["limit"]);
        assert_eq!(map["limit"]["held"] == false, verdict.starts_with("Fails"), "{verdict} {}", map["limit"]);
        if is_bounded {
            assert_eq!(Some(headline), bench.command("budget", &[]).pointer(P95).and_then(Value::as_f64));
            answers_of_bounds(&bench);
        } else {
            assert_eq!(Some(headline), map["position_um"]["max"].as_f64());
            // The errors alone, as deviations of machines that have no other.
            let first = bench.browser.run("return document.querySelector('.bars .error-name').textContent;");
            let alone = without(&text, first.as_str().unwrap());
            std::fs::write(bench.file.with_file_name("alone.yaml"), alone).unwrap();
            let bar = bench.figure(&format!("source-{}", first.as_str().unwrap()));
            let output = abbe()
                .args(["map", "--format", "json", "--quiet", "--order", "1"])
                .arg(bench.file.with_file_name("alone.yaml"))
                .output()
                .unwrap();
            let alone: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert!((bar - alone["position_um"]["max"].as_f64().unwrap()).abs() < 1e-6 * bar, "{first}: {bar} {alone}");
        }
        assert_eq!(Some(bench.figure("reach")), bench.command("reach", &[])["share"].as_f64());
        bench.browser.screenshot(&kept().join(format!("workbench-{name}.png")), false);
        bench.click("over-volume");
        wait(&bench.browser, "return document.querySelector('[data-at=p95]') !== null;");
        assert_eq!(said("#scope"), "Error over the volume");
        let volume = match is_bounded {
            true => bench.command("budget", &["--job", "none"]).pointer(P95).cloned().unwrap(),
            false => bench.command("map", &["--random", "2000"])["position_um"]["p95"].clone(),
        };
        assert_eq!(Some(bench.figure("p95")), volume.as_f64());
        // The pane of the editor wraps, widens by the keys, folds, and stays so.
        bench.click("wrap-editor");
        assert_eq!(bench.browser.run("return document.querySelectorAll('.cm-lineWrapping').length;"), 1);
        let [.., width, _] = frame(&bench, "#file");
        let _ = bench.browser.run("document.getElementById('editor-edge').focus();");
        bench.browser.press(&[RIGHT, RIGHT]);
        assert_eq!(frame(&bench, "#file")[2], width + 80.0);
        bench.click("fold-editor");
        assert!(frame(&bench, "#file")[2] < 60.0);
        assert_eq!(bench.browser.run("return document.getElementById('editor').checkVisibility();"), false);
        let kept = bench.browser.run("return location.hash;");
        assert!(kept.as_str().unwrap().contains("pane=folded%2Cwrapped%2C"), "{kept}");
        bench.quiet();
    }
}
