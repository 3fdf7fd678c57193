//! `report --watch`.

use crate::driver::Browser;
use crate::{Folder, abbe};
use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Patience of these tests, far beyond what a refresh takes: a loaded machine is no failure.
const PATIENCE: Duration = Duration::from_secs(60);

/// The program while it serves; it ends with this value.
pub struct Serving(pub Child);

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

const MACHINE: &str = "abbe: 1\nmachine: Watched\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0, 500] }\n  Y: { travel: [0, 400] }\n  Z: { travel: [0, 300] }\nerrors:\n  EC0Y: 20 urad\n";

/// The page in words, for whoever reads of a failed check.
const PAGE: &str = "return [document.body.dataset.state, document.activeElement.outerHTML.slice(0, 200), \
    document.getElementById('problem')?.textContent, document.querySelector('.cm-content')?.innerText];";

/// Waits until a script returns true.
pub fn wait(browser: &Browser, script: &str) {
    let start = Instant::now();
    while browser.run(script) != true {
        assert!(start.elapsed() < PATIENCE, "never: {script}\n{}\n{:?}", browser.run(PAGE), browser.complaints());
        std::thread::sleep(Duration::from_millis(50));
    }
    println!("  {:.2} s until {script}", start.elapsed().as_secs_f64());
}

pub fn refreshes() {
    let folder = Folder::new("watch");
    let file = folder.0.join("m.yaml");
    let base = folder.0.join("base.yaml");
    std::fs::write(&file, format!("{MACHINE}extends: base.yaml\n")).unwrap();
    std::fs::write(&base, "provenance: { source: one }\n").unwrap();
    let mut child =
        abbe().arg("report").arg(&file).arg("--watch").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let _serving = Serving(child);
    let address = line.split(' ').next().unwrap();
    assert!(address.starts_with("http://127.0.0.1:"), "{line}");
    let browser = Browser::new(1200, 800);
    browser.open(address);
    let settled = "document.body.dataset.state === 'full' && !document.body.dataset.busy";
    wait(&browser, &format!("return {settled};"));
    let _ = browser.run("window.mine = true;");
    let figure = || browser.run("return document.querySelector('[data-at=p95]').dataset.value;");
    let first = figure();
    let changed = MACHINE.replace("Watched", "Changed").replace("20 urad", "40 urad");
    std::fs::write(&file, format!("{changed}extends: base.yaml\n")).unwrap();
    let named = |name: &str| format!("return document.getElementById('name').textContent === '{name}' && {settled};");
    wait(&browser, &named("Changed"));
    // Not loaded anew, and the file is as kept: no difference is shown.
    assert_eq!(browser.run("return window.mine;"), true);
    let twice = figure();
    assert_ne!(twice, first);
    // A file that is extended is followed too.
    std::fs::write(&base, "errors: { EXX: { polynomial: [0 um, 50 um/m] } }\n").unwrap();
    wait(&browser, &format!("return document.querySelector('[data-at=p95]').dataset.value !== {twice} && {settled};"));
    let more = figure();
    std::fs::write(&file, MACHINE.replace("20 urad", "20 furlongs")).unwrap();
    wait(&browser, "return document.querySelector('#diagnostics .refusal') !== null;");
    assert_eq!(figure(), more);
    std::fs::write(&file, MACHINE).unwrap();
    wait(&browser, &named("Watched"));
    assert_eq!(figure(), first);
    // What is changed in the page is not written over.
    let _ = browser.run("document.querySelector('.cm-content').focus();");
    browser.press(&["#"]);
    std::fs::write(&file, changed).unwrap();
    wait(&browser, "return document.getElementById('problem').textContent.includes('has changed');");
    assert_eq!(browser.run("return document.querySelector('.cm-line').textContent;"), "#abbe: 1");
    assert!(browser.complaints().is_empty(), "{:?}", browser.complaints());
}
