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

/// Waits until a script returns true.
pub fn wait(browser: &Browser, script: &str) {
    let start = Instant::now();
    while browser.run(script) != true {
        assert!(start.elapsed() < PATIENCE, "never: {script}");
        std::thread::sleep(Duration::from_millis(50));
    }
    println!("  {:.2} s until {script}", start.elapsed().as_secs_f64());
}

pub fn refreshes() {
    let folder = Folder::new("watch");
    let file = folder.0.join("m.yaml");
    std::fs::write(&file, MACHINE).unwrap();
    let mut child = abbe()
        .arg("report")
        .arg(&file)
        .args(["--watch", "--poses", "100"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let _serving = Serving(child);
    let address = line.split(' ').next().unwrap();
    assert!(address.starts_with("http://127.0.0.1:"), "{line}");
    let browser = Browser::new(1200, 800);
    browser.open(address);
    let _ = browser.run("document.querySelector('[data-look=Z]').click(); window.mine = true;");
    let turned = browser.run("return camera.pitch;");
    std::fs::write(&file, MACHINE.replace("Watched", "Changed").replace("20 urad", "40 urad")).unwrap();
    wait(&browser, "return document.querySelector('h1').textContent === 'Changed';");
    // Not loaded anew: the reader's changes are still there.
    assert_eq!(browser.run("return window.mine;"), true);
    assert_eq!(browser.run("return camera.pitch;"), turned);
    let before = browser.run("return document.querySelector('.tile b').textContent;");
    std::fs::write(&file, MACHINE.replace("20 urad", "20 furlongs")).unwrap();
    wait(&browser, "return !document.getElementById('problem').hidden;");
    let problem = browser.run("return document.querySelector('#problem pre').textContent;");
    assert!(
        problem.as_str().unwrap().contains("furlongs") && problem.as_str().unwrap().contains("m.yaml"),
        "{problem}"
    );
    assert_eq!(browser.run("return document.querySelector('.tile b').textContent;"), before);
    std::fs::write(&file, MACHINE).unwrap();
    wait(
        &browser,
        "return document.getElementById('problem').hidden && document.querySelector('h1').textContent === 'Watched';",
    );
    assert!(browser.complaints().is_empty(), "{:?}", browser.complaints());
}
