//! A machine file by questions, on the page.

use crate::kept;
use crate::watch::wait;
use crate::workbench::Bench;
use serde_json::json;

/// Answers a question by its key; a choice among several by its number.
fn answer(bench: &Bench, key: &str, value: &str) {
    let script = format!(
        "const field = document.querySelector('#questions [data-key=\"{key}\"]'); \
         const radio = field.querySelector('input[value=\"{value}\"]'); if (radio) {{ radio.click(); return true; }} \
         const input = field.querySelector('input, select'); input.value = '{value}'; \
         input.dispatchEvent(new Event('input')); return true;"
    );
    wait(&bench.browser, &format!("return !!document.querySelector('#questions [data-key=\"{key}\"]');"));
    assert_eq!(bench.browser.run(&script), true, "{key}");
}

fn shot(bench: &Bench, name: &str, scheme: &str, [width, height]: [u32; 2]) {
    let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500});
    let _ = bench.browser.devtools("Emulation.setDeviceMetricsOverride", &size);
    let features = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
    let _ = bench.browser.devtools("Emulation.setEmulatedMedia", &features);
    std::thread::sleep(std::time::Duration::from_millis(300));
    let cut = bench.browser.run(&format!(
        "return [...document.querySelectorAll('#questions *')].filter((of) => \
         of.getBoundingClientRect().right > {width} + 1).map((of) => of.outerHTML.slice(0, 120));"
    ));
    assert_eq!(cut, json!([]), "cut at {width} px");
    bench.browser.screenshot(&kept().join(format!("questions-{name}.png")), false);
}

/// The questions of `abbe init` make a file on the page, too, whatever stands in the editor before.
pub fn form() {
    let bench = Bench::new("questions", "abbe: 1\n", (1400, 900));
    bench.click("new-machine");
    wait(&bench.browser, "return document.querySelectorAll('#questions [data-key=kind] pre').length === 6;");
    for (name, scheme, size) in
        [("light", "light", [1400, 900]), ("dark", "dark", [1400, 900]), ("narrow", "light", [390, 844])]
    {
        shot(&bench, name, scheme, size);
    }
    // Code is set as such, and a chain stays on one line.
    let raw = "return document.getElementById('questions').textContent.includes('`');";
    assert_eq!(bench.browser.run(raw), false, "backticks are shown");
    let lines = "return [...document.querySelectorAll('#questions code')].map((of) => of.getClientRects().length);";
    let lines = bench.browser.run(lines);
    assert!(lines.as_array().unwrap().iter().all(|count| *count == 1), "{lines}");
    answer(&bench, "kind", "1");
    wait(&bench.browser, "return !document.querySelector('#questions [data-key=\"travel A\"]');");
    answer(&bench, "travel X", "600 0");
    wait(&bench.browser, "return document.getElementById('take-machine').disabled;");
    let words = "document.querySelector('#questions [data-key=\"travel X\"] em').textContent";
    wait(&bench.browser, &format!("return {words} === 'Wanted: two numbers, the lower end first, such as 0 500.';"));
    answer(&bench, "travel X", "0 620");
    answer(&bench, "known", "2");
    answer(&bench, "accuracy Y", "8");
    answer(&bench, "class", "commodity");
    wait(&bench.browser, "return !document.getElementById('take-machine').disabled;");
    shot(&bench, "answered", "light", [390, 844]);
    bench.click("take-machine");
    bench.settled();
    let file = bench.save();
    for line in ["chain: \"w X' Y' b Z t\"", "  X: { travel: [0 mm, 620 mm]", "class: commodity", "  EYY: { A: 8 um }"]
    {
        assert!(file.contains(line), "{line}: {file}");
    }
    assert_eq!(bench.command("show", &[])["axes"].as_array().unwrap().len(), 3);
    assert_eq!(bench.browser.run("return document.getElementById('questions');"), json!(null));
    bench.quiet();
}
