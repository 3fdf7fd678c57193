//! The picture of the machine is there: for each kind of machine, with a part and without, after a resize, a drag and a
//! reload, in a mailed page and on the workbench (`web/test/castings.test.ts` has every machine of `configs/`). And
//! what is not current says so at once.

use crate::driver::Browser;
use crate::watch::wait;
use crate::workbench::Bench;
use crate::{Folder, report};
use serde_json::json;
use std::path::Path;

/// Waits for two frames, and returns the share of the picture that is not background.
const INK: &str = "return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
    const canvas = document.querySelector('#stage canvas'), copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const brush = copy.getContext('2d');
    brush.drawImage(canvas, 0, 0);
    const {data} = brush.getImageData(0, 0, copy.width, copy.height);
    let drawn = 0;
    for (let i = 3; i < data.length; i += 4) drawn += data[i] > 0;
    done(drawn / (copy.width * copy.height));
})));";

/// The least share that a machine takes of its picture.
const LEAST: f64 = 0.05;

fn drawn(browser: &Browser, of: &str) {
    let ink = browser.run(INK).as_f64().unwrap();
    assert!(ink > LEAST && ink < 0.95, "{of}: {:.1} % of the picture is drawn", 100.0 * ink);
}

fn resize(browser: &Browser, (width, height): (u32, u32)) {
    let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
    let _ = browser.devtools("Emulation.setDeviceMetricsOverride", &size);
}

/// Turns the view: from the corner of the picture, where no body is.
fn turn(browser: &Browser) {
    let corner = "const r = document.querySelector('#stage canvas').getBoundingClientRect(); return [r.x, r.y];";
    let found = browser.run(corner);
    let [x, y] = [0, 1].map(|i| found[i].as_f64().unwrap() + 5.0);
    browser.drag((x, y), (x + 90.0, y + 40.0));
}

/// Of each kind of machine one: a table that turns, a head, both, a horizontal spindle, a gantry, a lathe.
const KINDS: [&str; 7] = [
    "vmc-cframe-754.yaml",
    "hmc-4ax.yaml",
    "hh-ca-gantry.yaml",
    "ht-b-c.yaml",
    "boring-w.yaml",
    "tt-ac-800.yaml",
    "lathes/lathe-xzc.yaml",
];

/// A mailed page of each kind, and one with a part whose tool poses are all reached; resized, turned, and loaded anew.
pub fn mailed() {
    let folder = Folder::new("blank-mailed");
    let work = folder.0.join("work.csv");
    std::fs::write(&work, "X,Y,Z\n0,0,60\n40,0,60\n").unwrap();
    let part = ["trunnion.yaml", "--tool-poses", work.to_str().unwrap()];
    let browser = Browser::new(1400, 900);
    let all = KINDS[2..4].iter().map(std::slice::from_ref).chain([&part[..]]);
    for arguments in all {
        let page = report(&folder.0, "page.html", arguments);
        browser.open_file(&page);
        let shown = "return document.body.dataset.state === 'full' && !document.body.dataset.busy;";
        wait(&browser, shown);
        drawn(&browser, &format!("{arguments:?}"));
        for size in [(1000, 600), (390, 844), (1400, 900)] {
            resize(&browser, size);
            drawn(&browser, &format!("{arguments:?} at {size:?}"));
        }
        turn(&browser);
        drawn(&browser, &format!("{arguments:?}, turned"));
        let _ = browser.run("delete document.body.dataset.state; location.reload();");
        wait(&browser, shown);
        drawn(&browser, &format!("{arguments:?}, loaded anew"));
        assert_eq!(browser.run("return document.getElementById('problem').textContent;"), "", "{arguments:?}");
    }
    // A tool that the page was not written with.
    let _ = browser.run("delete document.body.dataset.state; location.hash += '&tool=gone'; location.reload();");
    says(&browser, "There is no tool `gone` here", false);
    drawn(&browser, "with a tool that is not there");
    assert!(browser.complaints().is_empty());
}

/// Whether it is said that figures and picture are of before.
const IS_OLD: &str = "document.body.hasAttribute('data-stale') && !document.getElementById('old').hidden";

fn says(browser: &Browser, words: &str, is_old: bool) {
    let said = "document.getElementById('problem').textContent";
    wait(browser, &format!("return {said}.includes('{words}') && ({IS_OLD}) === {is_old};"));
}

pub fn workbench() {
    let folder = Folder::new("blank-bench");
    let work = folder.0.join("work.csv");
    std::fs::write(&work, "X,Y,Z\n0,0,60\n40,0,60\n").unwrap();
    let trunnion = std::fs::read_to_string("configs/trunnion.yaml").unwrap();
    let mut bench = Bench::with("blank", &trunnion, (1400, 900), &["--tool-poses", work.to_str().unwrap()]);
    let is_there = |of: &str| drawn(&bench.browser, of);
    is_there("with a part");
    let _ = bench.browser.run("document.querySelector('[data-axis=Y]').focus();");
    bench.browser.press(&["\u{e014}"]);
    wait(&bench.browser, "return document.querySelector('[data-axis=Y]').textContent === 'Y';");
    bench.settled();
    is_there("after a chip moved");
    // Each kind of machine, as it comes from the disk.
    let own = bench.save();
    for (i, machine) in KINDS.iter().enumerate() {
        let text = std::fs::read_to_string(Path::new("configs").join(machine)).unwrap().replace("../", "");
        let named = text.lines().find_map(|line| line.strip_prefix("machine: ")).unwrap().trim_matches('"').to_owned();
        std::fs::write(&bench.file, text).unwrap();
        let is_named = format!("return document.getElementById('name').textContent === '{named}';");
        wait(&bench.browser, &is_named);
        is_there(machine);
        resize(&bench.browser, [(1100, 700), (390, 844), (1400, 900)][i % 3]);
        is_there(&format!("{machine}, resized"));
    }
    std::fs::write(&bench.file, own).unwrap();
    wait(&bench.browser, "return document.getElementById('name').textContent.startsWith('Trunnion');");
    bench.settled();
    resize(&bench.browser, (1100, 700));
    turn(&bench.browser);
    is_there("turned");
    // However far the wheel goes, something of the machine is left.
    for by in [3000, -6000] {
        let wheel = json!({"type": "mouseWheel", "x": 500, "y": 400, "deltaX": 0, "deltaY": by});
        (0..12).for_each(|_| drop(bench.browser.devtools("Input.dispatchMouseEvent", &wheel)));
        let ink = bench.browser.run(INK).as_f64().unwrap();
        assert!(ink > 0.002, "{ink} after the wheel");
    }
    let _ = bench.browser.run("document.body.dataset.state = ''; location.hash += '&tool=gone'; location.reload();");
    says(&bench.browser, "There is no tool `gone` here", false);
    bench.settled();
    is_there("with a tool that is not there");
    assert_eq!(bench.browser.run("return location.hash.includes('tool');"), false);
    let _ = bench.browser.run("document.querySelector('#problem [aria-label=Close]').click();");
    // A refused text.
    let before = bench.on_disk();
    resize(&bench.browser, (1400, 900));
    bench.at_error("EB0Z");
    bench.types("x");
    says(&bench.browser, "The file is refused, line 26:", true);
    is_there("before a refused text");
    save(&bench);
    says(&bench.browser, "No machine can be read from this text", true);
    assert_eq!(bench.on_disk(), before);
    bench.browser.press(&["\u{e007}"]);
    says(&bench.browser, "The file is refused", true);
    bench.browser.press(&["\u{e003}"]);
    bench.settled();
    wait(&bench.browser, &format!("return !({IS_OLD}) && document.getElementById('problem').hidden;"));
    // An empty one.
    keys(&bench, "\u{e009}", "a");
    bench.browser.press(&["\u{e003}"]);
    save(&bench);
    says(&bench.browser, "No machine can be read from this text: it is empty", true);
    assert_eq!(bench.on_disk(), before);
    bench.click("save-anyway");
    wait(&bench.browser, "return document.getElementById('save').disabled;");
    assert_eq!(bench.on_disk(), "");
    keys(&bench, "\u{e009}", "z");
    bench.settled();
    // The program ends, and another one has its port.
    let port = bench.end();
    says(&bench.browser, "The program does not answer", true);
    drawn(&bench.browser, "without a program");
    let _ = bench.browser.complaints();
    bench.begin_anew(&port);
    says(&bench.browser, "does not know this page", true);
    // Its address in the same tab: what is changed in the page stays.
    let fragment = bench.address.split_once('#').unwrap().1;
    let _ = bench.browser.run(&format!("window.mine = true; location.hash = '{fragment}';"));
    wait(&bench.browser, &format!("return window.mine && !({IS_OLD}) && document.getElementById('problem').hidden;"));
    bench.settled();
}

/// Two tabs on one file: the second is shown the difference, and takes the other's text or keeps its own.
pub fn conflict() {
    let bench = Bench::of_config("blank-conflict", "trunnion.yaml");
    let original = bench.on_disk();
    let theirs = format!("{original}# theirs\n");
    bench.at_error("EY0C");
    bench.browser.press(&["\u{e017}"]);
    std::fs::write(&bench.file, &theirs).unwrap();
    says(&bench.browser, "has changed", false);
    bench.click("difference");
    let shown = "const all = document.querySelectorAll('#differences .mine, #differences .theirs'); \
                 return [...all].map((of) => of.textContent);";
    let lines = bench.browser.run(shown);
    let word = |i: usize| lines[i].as_str().unwrap_or_default().to_owned();
    assert!(lines.as_array().unwrap().len() == 3, "{lines}");
    assert!(word(0).starts_with("\u{2212}   EY0C: -9") && word(1).starts_with("+   EY0C: 9"), "{lines}");
    assert_eq!(word(2), "\u{2212} # theirs");
    let _ = bench.browser.run("document.querySelector('#differences button').click();");
    bench.click("theirs");
    wait(
        &bench.browser,
        "return document.getElementById('save').disabled && document.getElementById('problem').hidden;",
    );
    bench.settled();
    // Saved over a text that others wrote first: asked, and then by will.
    bench.at_error("EY0C");
    bench.browser.press(&["\u{e017}"]);
    std::fs::write(&bench.file, &original).unwrap();
    says(&bench.browser, "has changed", false);
    bench.click("mine");
    assert_eq!(bench.on_disk(), original);
    let saved = bench.save();
    assert!(saved.contains("EY0C: 9 um") && saved.ends_with("# theirs\n"), "{saved}");
}

fn keys(bench: &Bench, held: &str, key: &str) {
    let stroke = |kind: &str, value: &str| json!({"type": kind, "value": value});
    let actions = [stroke("keyDown", held), stroke("keyDown", key), stroke("keyUp", key), stroke("keyUp", held)];
    bench.browser.act(&json!(actions));
}

/// Presses Ctrl-S in the editor.
fn save(bench: &Bench) {
    let _ = bench.browser.run("document.querySelector('.cm-content').focus();");
    keys(bench, "\u{e009}", "s");
}
