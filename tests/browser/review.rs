//! The panels of `abbe workbench` that a review asks: reach, names, goal, variants, part; completion and downloads.

use crate::watch::wait;
use crate::workbench::{BOUNDED, Bench};
use crate::{Folder, abbe, kept};
use serde_json::{Value, json};
use std::path::Path;

const ENTER: &str = "\u{e007}";
const ESCAPE: &str = "\u{e00c}";
const DELETE: &str = "\u{e017}";

/// Waits for a figure.
fn awaits(bench: &Bench, at: &str) -> f64 {
    wait(&bench.browser, &format!("return document.querySelector('[data-at=\"{at}\"]') !== null;"));
    bench.figure(at)
}

fn text(bench: &Bench, selector: &str) -> String {
    let found = bench.browser.run(&format!("return document.querySelector('{selector}').textContent;"));
    found.as_str().unwrap().to_owned()
}

/// Puts a value into a field, as typing does.
pub fn fill(bench: &Bench, id: &str, value: &str) {
    let _ = bench.browser.run(&format!(
        "const field = document.getElementById('{id}'); field.focus(); field.value = '{value}'; \
         for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind));"
    ));
}

fn picture(bench: &Bench, name: &str) {
    bench.browser.screenshot(&kept().join(format!("workbench-{name}.png")), false);
    let fits = bench.browser.run("return document.documentElement.scrollWidth <= innerWidth;");
    assert_eq!(fits, true, "{name} is cut");
}

pub fn reach() {
    let bench = Bench::of_config("bench-reach", "vmc-cframe-754.yaml");
    let share = awaits(&bench, "reach");
    let printed = bench.command("reach", &["--tool", "short"]);
    assert_eq!(Some(share), printed["share"].as_f64());
    let bench = Bench::of_config("bench-names", "trunnion.yaml");
    assert_eq!(Some(awaits(&bench, "reach")), bench.command("reach", &[])["share"].as_f64());
    let reasons = text(&bench, "#out-of-reach");
    assert!(reasons.contains("Z short by up to 206 mm below −400 mm"), "{reasons}");
    // The keyboard reaches what a name is.
    let _ = bench.browser.run("document.querySelector('[data-error=EY0C]').focus();");
    wait(&bench.browser, "return !document.getElementById('card').hidden;");
    let card = text(&bench, "#card");
    assert!(card.contains("Position of the line of C in Y.") && card.contains("0C: where axis C lies"), "{card}");
    assert_eq!(bench.browser.run("return document.querySelectorAll('#card svg.sketch path').length > 5;"), true);
    bench.browser.screenshot(&kept().join("workbench-name.png"), false);
    bench.browser.press(&[ESCAPE]);
    assert_eq!(bench.browser.run("return document.getElementById('card').hidden;"), true);
    bench.quiet();
}

pub fn goal() {
    let bench = Bench::new("bench-goal", BOUNDED, (1400, 900));
    bench.click("tab-tighten");
    let before = bench.figure("p95");
    fill(&bench, "goal", &format!("{:.1}", 0.7 * before));
    bench.browser.press(&[ENTER]);
    let proof = awaits(&bench, "goal-proof");
    let goal = format!("{:.1} um", 0.7 * before);
    let printed = &bench.command("budget", &["--goal", &goal])["goal"];
    assert_eq!(Some(proof), printed["proof_um"]["value"].as_f64());
    let changes = |of: &&Value| of["new"] != of["old"];
    for of in printed["tolerances"].as_array().unwrap().iter().filter(changes) {
        let error = of["error"].as_str().unwrap();
        assert_eq!(Some(bench.figure(&format!("goal-{error}"))), of["new"].as_f64(), "{error}");
    }
    picture(&bench, "goal");
    bench.click("write-tolerances");
    bench.settled();
    let saved = bench.save();
    assert_eq!(saved.lines().count(), BOUNDED.lines().count(), "{saved}");
    let others = |text: &str| text.lines().filter(|line| !line.contains(" um") && !line.contains("urad")).count();
    assert_eq!(others(&saved), others(BOUNDED));
    let after = bench.command("budget", &["--samples", "8000"]);
    let p95 = after["position_um"]["monte_carlo"]["percentiles"]["p95"]["value"].as_f64().unwrap();
    assert!(p95 / before < 0.7 && p95 / before > 0.65, "{p95} {before}");
    // The file that was written passes the limit on the page, too.
    fill(&bench, "limit", &format!("{:.1}", 0.7 * before));
    wait(&bench.browser, "return document.querySelector('.limit .verdict-passes') !== null;");
    // A goal that no tolerance reaches is refused in the program's words.
    fill(&bench, "goal", "0.000001");
    bench.click("find-tolerances");
    wait(&bench.browser, "return document.querySelector('#panel-tighten .refused') !== null;");
    bench.quiet();
}

pub fn variants() {
    let bench = Bench::of_config("bench-variants", "trunnion.yaml");
    let first = bench.file.with_file_name("a.yaml");
    std::fs::copy(&bench.file, &first).unwrap();
    let original = bench.on_disk();
    bench.at_error("EY0C");
    bench.click("tab-variants");
    bench.click("keep-a");
    wait(&bench.browser, "return document.getElementById('told-apart')?.textContent === 'Equal.';");
    let _ = bench.browser.run("document.querySelector('.cm-content').focus();");
    bench.browser.press(&[DELETE, DELETE]);
    bench.types("-2");
    wait(&bench.browser, "return document.getElementById('told-apart').textContent.startsWith('Better than A');");
    let _ = bench.save();
    let output = abbe()
        .args(["compare", "--format", "json", "--quiet"])
        .args([&first, &bench.file])
        .args(["--poses", "1000"])
        .output()
        .unwrap();
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (i, side) in ["a", "b"].iter().enumerate() {
        for at in ["p95", "max", "rms"] {
            let expected = printed["machines"][i]["position_um"][at].as_f64();
            assert_eq!(Some(bench.figure(&format!("{side}-{at}"))), expected, "{side} {at}");
        }
    }
    assert_eq!(Some(bench.figure("b-a-p95")), printed["machines"][1]["minus_first"]["position_um"]["p95"].as_f64());
    assert!(text(&bench, "#panel-variants .inline").contains("EY0C"));
    picture(&bench, "variants");
    bench.click("back-to-a");
    wait(&bench.browser, "return document.getElementById('told-apart').textContent === 'Equal.';");
    assert_eq!(bench.save(), original);
    bench.quiet();
}

const READOUT: &str = "document.getElementById('readout').textContent";

/// Moves the pointer onto the pixels of a colour in the picture, and clicks there, until a script returns true: the
/// picture follows when the browser draws.
fn point(bench: &Bench, colour: [u8; 3], click: bool, until: &str) {
    let start = std::time::Instant::now();
    while bench.browser.run(until) != true {
        assert!(start.elapsed().as_secs() < 60, "never, pointing at {colour:?}: {until}");
        point_once(bench, colour, click);
        std::thread::sleep(std::time::Duration::from_millis(1500));
    }
}

fn point_once(bench: &Bench, colour: [u8; 3], click: bool) {
    let script = format!(
        "const canvas = document.querySelector('#stage canvas'), copy = document.createElement('canvas'); \
         [copy.width, copy.height] = [canvas.width, canvas.height]; const brush = copy.getContext('2d'); \
         brush.drawImage(canvas, 0, 0); const {{data}} = brush.getImageData(0, 0, copy.width, copy.height); \
         const found = []; for (let i = 0; i < data.length / 4; i++) \
         if ({colour:?}.every((c, k) => Math.abs(data[4 * i + k] - c) < 3)) found.push(i); \
         const at = found[Math.floor(found.length / 2)], box = canvas.getBoundingClientRect(); \
         return [box.left + at % copy.width + 0.5, box.top + Math.floor(at / copy.width) + 0.5, found.length];"
    );
    let found = bench.browser.run(&script);
    if found[2] == 0 {
        return;
    }
    let kinds: &[&str] =
        if click { &["mouseMoved", "mousePressed", "mouseReleased", "mouseMoved"] } else { &["mouseMoved"] };
    for kind in kinds {
        let button = if *kind == "mouseMoved" { "none" } else { "left" };
        let event = json!({"type": kind, "x": found[0], "y": found[1], "button": button, "clickCount": 1});
        let _ = bench.browser.devtools("Input.dispatchMouseEvent", &event);
    }
}

/// What the page shows of a part that the command line names is what `map` prints.
pub fn named_part() {
    let machine = std::fs::read_to_string("configs/trunnion.yaml").unwrap();
    let folder = Folder::new("bench-named-part");
    let job = folder.0.join("part.yaml");
    std::fs::copy(Path::new("docs/examples/work.csv"), folder.0.join("work.csv")).unwrap();
    std::fs::write(&job, "tool_poses: work.csv\nreference: zero\n").unwrap();
    let given = ["--job", job.to_str().unwrap(), "--reference", "best-fit", "--path", "yes"];
    let bench = Bench::with("bench-named", &machine, (1400, 900), &given);
    bench.click("tab-part");
    let max = awaits(&bench, "part-max");
    let printed = bench.command("map", &given);
    assert!((max - printed["position_um"]["max"].as_f64().unwrap()).abs() < 1e-9, "{max} {printed}");
    let over = text(&bench, "#part-over");
    assert!(over.contains("best fit") && over.contains("one path"), "{over}");
    assert_eq!(bench.browser.run("return document.getElementById('work').value;"), job.to_str().unwrap());
}

pub fn part() {
    let bench = Bench::of_config("bench-part", "trunnion.yaml");
    let work = bench.file.with_file_name("work.csv");
    std::fs::copy(Path::new("docs/examples/work.csv"), &work).unwrap();
    bench.click("tab-part");
    fill(&bench, "work", work.to_str().unwrap());
    let zero = awaits(&bench, "part-max");
    let printed = bench.command("map", &["--tool-poses", work.to_str().unwrap()]);
    assert!((zero - printed["position_um"]["max"].as_f64().unwrap()).abs() < 1e-9, "{zero} {printed}");
    assert!(text(&bench, "#part-over").contains("zero at (0, 0, 0)"));
    fill(&bench, "reference", "machine");
    wait(&bench.browser, "return document.getElementById('part-over').textContent.includes('machine coordinates');");
    let max = bench.figure("part-max");
    let printed = bench.command("map", &["--reference", "machine", "--tool-poses", work.to_str().unwrap()]);
    assert!((max - printed["position_um"]["max"].as_f64().unwrap()).abs() < 1e-9, "{max} {printed}");
    assert!(text(&bench, "#part-over").contains("reference: machine coordinates"));
    // Another reference is another figure, and says so.
    for (reference, words) in [("best-fit:minimum-zone", "minimum zone"), ("zero", "zero at (0, 0, 0)")] {
        fill(&bench, "reference", reference);
        let said = format!("return document.getElementById('part-over').textContent.includes('{words}');");
        wait(&bench.browser, &said);
        let fitted = bench.command("map", &["--reference", reference, "--tool-poses", work.to_str().unwrap()]);
        let shown = bench.figure("part-max");
        assert!((shown - fitted["position_um"]["max"].as_f64().unwrap()).abs() < 1e-9, "{reference}: {shown}");
        assert!((shown - max).abs() > 1e-3, "{reference} takes nothing out");
    }
    picture(&bench, "part-reference");
    // As one path, with what it asks of the machine.
    fill(&bench, "path", "yes");
    wait(&bench.browser, "return document.getElementById('part-path') !== null;");
    let along = bench.command("map", &["--path", "yes", "--tool-poses", work.to_str().unwrap()]);
    let rewinds = bench.browser.run("return Number(document.getElementById('part-path').dataset.rewinds);");
    assert_eq!(rewinds.as_f64(), Some(along["path"]["rewinds"].as_array().unwrap().len() as f64));
    assert!(text(&bench, "#part-over").contains("one path"));
    picture(&bench, "part-path");
    fill(&bench, "path", "");
    wait(&bench.browser, "return document.getElementById('part-path') === null;");
    // At other places of the table.
    let ranges = "X=-60..60:3,Y=-60..60:3";
    fill(&bench, "places", ranges);
    bench.click("try-places");
    wait(&bench.browser, "return document.querySelectorAll('#places-table tbody tr').length === 2;");
    let given = ["--tool-poses", work.to_str().unwrap(), "--reference", "zero", "--place", ranges];
    let places = bench.command("map", &given);
    for (row, of) in ["best", "own"].iter().enumerate() {
        let cell = format!("return Number(document.querySelectorAll('#places-table tbody tr')[{row}].dataset.p95);");
        let shown = bench.browser.run(&cell).as_f64().unwrap();
        assert!((shown - places[of]["p95_um"].as_f64().unwrap()).abs() < 1e-9, "{of}: {shown} {places}");
    }
    let drawn =
        "const drawn = document.querySelector('#panel-part img'); return drawn.complete && drawn.naturalWidth > 100;";
    wait(&bench.browser, drawn);
    picture(&bench, "part-places");
    // A job file has its own reference.
    let job = bench.file.with_file_name("part.yaml");
    std::fs::write(
        &job,
        "tool_poses: work.csv\nplace: { origin: [0, 0, 0], rotation: [0, 0, 0] }\nreference: best-fit\n",
    )
    .unwrap();
    fill(&bench, "reference", "");
    fill(&bench, "work", job.to_str().unwrap());
    wait(&bench.browser, "return document.getElementById('part-over')?.textContent.includes('best fit');");
    let fitted = bench.command("map", &["--job", job.to_str().unwrap()]);
    assert!((bench.figure("part-max") - fitted["position_um"]["max"].as_f64().unwrap()).abs() < 1e-9);
    fill(&bench, "work", work.to_str().unwrap());
    wait(&bench.browser, "return document.getElementById('part-over')?.textContent.includes('zero at');");
    fill(&bench, "reference", "machine");
    wait(&bench.browser, "return document.getElementById('part-over').textContent.includes('machine coordinates');");
    let reached = printed["tool_poses"]["reached"].as_u64().unwrap();
    assert!(text(&bench, "#panel-part strong").starts_with(&format!("{reached} of 8")));
    let axis = printed["tool_poses"]["rows"][0]["beyond"][0]["axis"].as_str().unwrap();
    assert!(text(&bench, "#panel-part .inline").contains(&format!("stopped by {axis}")));
    bench.click("worst-of-part");
    let here = format!(
        "const at = document.querySelector('[data-at=here]'); return at && Math.abs(at.dataset.value - {max}) < 1e-6;"
    );
    wait(&bench.browser, &here);
    picture(&bench, "part");
    // In the picture too: the pointer reads out what stands before it, and a click goes there.
    bench.click("zero");
    wait(&bench.browser, "return document.getElementById('axis-Y').value === '0';");
    point(&bench, [0, 119, 187], false, &format!("return {READOUT}.includes('stopped by {axis}');"));
    // Lines 8 and 9 have nearly the same deviation, and colour.
    point(&bench, [74, 18, 71], true, &here.replace("1e-6", "0.01"));
    // The same rows, dropped; then a file that is none.
    let drop = |name: &str, content: &str| {
        let file = json!([content, name]).to_string();
        let _ = bench.browser.run(&format!(
            "const [text, name] = {file}; const data = new DataTransfer(); data.items.add(new File([text], name)); \
             document.getElementById('panel-part').dispatchEvent(new DragEvent('drop', {{dataTransfer: data}}));"
        ));
    };
    drop("other.csv", "X, Y, Z, I, J, K\n0, 0, 60, 0, 0, 1\n40, 0, 60, 0, 0, 1\n");
    wait(&bench.browser, "return document.querySelector('#panel-part strong').textContent === '2 of 2';");
    drop("<b>.csv", "no columns\n");
    wait(&bench.browser, "return document.querySelector('#panel-part .refused') !== null;");
    bench.quiet();
}

pub fn control() {
    let bench = Bench::of_config("bench-control", "trunnion.yaml");
    bench.click("tab-control");
    wait(&bench.browser, "return document.querySelectorAll('#target option').length > 5;");
    fill(&bench, "target", "linuxcnc-kins");
    let after = awaits(&bench, "with-p95");
    let printed = bench.command("map", &["--random", "2000", "--target", "linuxcnc-kins"]);
    assert_eq!(Some(after), printed["position_um"]["p95"].as_f64());
    assert_eq!(Some(bench.figure("without-p95")), printed["uncompensated"]["position_um"]["p95"].as_f64());
    assert_eq!(Some(bench.figure("with-rotation-left")), printed["rotation_urad"]["p95"].as_f64());
    assert_eq!(Some(bench.figure("without-p95")), Some(bench.figure("p95")));
    let heads = "[...document.querySelectorAll('#panel-control thead button')]";
    let order = || {
        bench
            .browser
            .run("return [...document.querySelectorAll('#panel-control tbody th')].map((th) => th.textContent[0]);")
    };
    assert_eq!(order(), json!(["9", "L", "R"]));
    let _ = bench.browser.run(&format!("{heads}[1].click();"));
    assert_eq!(order(), json!(["R", "L", "9"]), "largest first: urad, then um");
    let _ = bench.browser.run(&format!("{heads}[1].click();"));
    assert_eq!(order(), json!(["9", "L", "R"]));
    picture(&bench, "control");
    bench.click("tab-acceptance");
    let bar = awaits(&bench, "ball-bar-XY");
    assert_eq!(Some(bar), bench.command("instrument", &["ball-bar"])["planes"][0]["bidirectional_um"].as_f64());
    let turns = bench.command("instrument", &["r-test"]);
    assert_eq!(Some(bench.figure("r-test-C-Y")), turns["axes"][0]["range_um"][1].as_f64());
    let lines = bench.command("instrument", &["diagonals"]);
    assert_eq!(Some(bench.figure("e-d-ppp")), lines["diagonals"][0]["e_d_um"].as_f64());
    picture(&bench, "acceptance");
    bench.quiet();
}

pub fn completion() {
    let bench = Bench::of_config("bench-completion", "trunnion.yaml");
    bench.at_error("EB0C");
    // A line below, the name: the list offers what each is.
    bench.browser.press(&["\u{e010}", ENTER]);
    bench.types("EX");
    wait(&bench.browser, "return document.querySelector('.cm-tooltip-autocomplete') !== null;");
    let offered = text(&bench, ".cm-tooltip-autocomplete");
    assert!(offered.contains("EXX") && offered.contains("Positioning error of X"), "{offered}");
    picture(&bench, "completion");
    bench.types("0A");
    wait(
        &bench.browser,
        "return document.querySelector('.cm-tooltip-autocomplete li')?.textContent.startsWith('EX0A');",
    );
    std::thread::sleep(std::time::Duration::from_millis(200));
    bench.browser.press(&[ENTER]);
    bench.types("3 um");
    bench.settled();
    let saved = bench.save();
    assert!(saved.contains("EX0A: 3 um"), "{saved}");
    bench.agrees();
    bench.quiet();
}

pub fn downloads() {
    let bench = Bench::of_config("bench-downloads", "trunnion.yaml");
    let folder = bench.file.parent().unwrap().join("downloads");
    std::fs::create_dir_all(&folder).unwrap();
    let allow = json!({"behavior": "allow", "downloadPath": folder});
    let _ = bench.browser.devtools("Browser.setDownloadBehavior", &allow);
    bench.click("tab-acceptance");
    wait(&bench.browser, "return document.querySelector('#panel-acceptance .files') !== null;");
    const ERRORS: &str = "error,words,um\nEY0C,Position of the line of C in Y.,17.9";
    const TEST: &str = "row,column,value,unit\n\"XY, 100 mm\",";
    let panels = [("errors", ERRORS, "EY0C"), ("acceptance", TEST, "Ball")];
    let files = panels.iter().flat_map(|panel| ["CSV", "SVG", "PNG"].map(|label| (panel, label)));
    for ((panel, csv, word), label) in files {
        let find = format!(
            "[...document.querySelectorAll('#panel-{panel} button')].find((b) => b.textContent === '{label}').click();"
        );
        let _ = bench.browser.run(&find);
        let name = format!("{panel}.{}", label.to_lowercase());
        let file = folder.join(&name);
        // The browser makes the file before it writes it.
        let mut bytes = Vec::new();
        for _ in 0..100 {
            bytes = std::fs::read(&file).unwrap_or_default();
            if !bytes.is_empty() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        let begins = match label {
            "CSV" => csv.as_bytes(),
            "SVG" => b"<svg xmlns=",
            _ => b"\x89PNG",
        };
        let text = String::from_utf8_lossy(&bytes);
        assert!(bytes.starts_with(begins), "{name}: {}", &text[..text.len().min(80)]);
        assert!(label != "SVG" || text.contains(word), "{name} names {word}");
    }
    bench.quiet();
}
