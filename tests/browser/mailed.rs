//! `abbe report`: the page in one file, read only and with its engine.

use crate::driver::Browser;
use crate::watch::wait;
use crate::workbench::{BOUNDED, Bench};
use crate::{Folder, abbe, kept, packed, report};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use miniz_oxide::deflate::compress_to_vec_zlib;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Folder with the engines: `ABBE_ENGINES`, or that of `web/engine/build --quick`.
fn engines() -> PathBuf {
    let named = std::env::var_os("ABBE_ENGINES").map(PathBuf::from);
    named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("target/engine/quick"))
}

/// The engines that were built: both for a release, the plain one for a change.
fn variants() -> Vec<&'static str> {
    let built = |variant: &&str| engines().join(format!("engine-{variant}.wasm.gz")).exists();
    ["plain", "relaxed"].into_iter().filter(built).collect()
}

/// True if the engines are those of a release, whose sizes are held.
fn are_shipped() -> bool {
    variants().len() == 2
}

/// Checks that an engine is there.
pub fn available() -> Result<(), String> {
    if variants().contains(&"plain") {
        return Ok(());
    }
    Err(format!("there is no engine in {}: run web/engine/build --quick", engines().display()))
}

/// Lays the program out as a package does, and writes a report with it.
fn packaged(folder: &Folder, variants: &[&str], arguments: &[&str]) -> PathBuf {
    for name in ["bin", "share/abbe"] {
        std::fs::create_dir_all(folder.0.join(name)).unwrap();
    }
    let program = folder.0.join("bin/abbe");
    let _ = std::fs::copy(abbe().get_program(), &program).unwrap();
    for name in variants.iter().map(|variant| format!("engine-{variant}.wasm.gz")) {
        let _ = std::fs::copy(engines().join(&name), folder.0.join("share/abbe").join(&name)).unwrap();
    }
    let page = folder.0.join("page.html");
    let output = std::process::Command::new(program)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("configs"))
        .args([&["report"], arguments, &["--quiet", "--out"]].concat())
        .arg(&page)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    page
}

fn note(browser: &Browser) -> String {
    browser.run("return document.getElementById('note').textContent;").as_str().unwrap().to_owned()
}

/// Opens every panel and returns their text.
fn panels(bench: &Bench, names: &[&str]) -> String {
    let mut text = String::new();
    for name in names {
        bench.click(&format!("tab-{name}"));
        std::thread::sleep(std::time::Duration::from_millis(300));
        text +=
            bench.browser.run(&format!("return document.getElementById('panel-{name}').innerText;")).as_str().unwrap();
    }
    text
}

/// Without an engine every figure is there that the page leads to, and nothing can be changed.
pub fn read_only() {
    let folder = Folder::new("mailed");
    let work = folder.0.join("work.csv");
    std::fs::write(&work, "X,Y,Z,I,J,K,feature\n0,0,20,0,0,1,top\n40,10,20,0,0,1,top\n10,0,20,0,0.5,0.8660254,side\n")
        .unwrap();
    let arguments = ["trunnion.yaml", "--target", "grid-csv", "--tool-poses", work.to_str().unwrap()];
    let page = report(&folder.0, "page.html", &arguments);
    let bench = Bench::mailed("mailed-only", &page, "trunnion.yaml");
    // It begins over the part, and holds the figures over the volume, too.
    let part = bench.command("map", &["--tool-poses", work.to_str().unwrap()]);
    assert_eq!(Some(bench.figure("job")), part["position_um"]["max"].as_f64());
    bench.click("over-volume");
    wait(&bench.browser, "return document.querySelector('[data-at=p95]') !== null;");
    bench.agrees_at(300, &[]);
    assert!(note(&bench.browser).contains("read only"), "{}", note(&bench.browser));
    let text = panels(&bench, &["errors", "part", "control", "acceptance"]);
    assert!(!text.contains("holds no answer"), "{text}");
    for words in ["3 of 3", "corrected", "bidirectional circular deviation"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let worst = bench.command("map", &["--random", "300"])["position_um"]["max"].as_f64().unwrap();
    bench.click("worst");
    wait(
        &bench.browser,
        &format!(
            "const at = document.querySelector('[data-at=here]'); return at && Math.abs(at.dataset.value - {worst}) < 1e-9;"
        ),
    );
    bench.at_error("EY0C");
    bench.types("77");
    std::thread::sleep(std::time::Duration::from_millis(500));
    bench.agrees_at(300, &[]);
    assert!(
        !bench.browser.run("return document.querySelector('.cm-content').innerText;").as_str().unwrap().contains("77")
    );
    assert_eq!(bench.browser.run("return document.getElementById('save');"), Value::Null);
    bench.quiet();
}

/// Without an engine a machine that is only bounded has its values at the poses that the page leads to; elsewhere the
/// page says that it has none.
pub fn bounded() {
    let folder = Folder::new("mailed-bounded");
    let [machine, work] = ["m.yaml", "zero.csv"].map(|name| folder.0.join(name));
    std::fs::write(&machine, BOUNDED).unwrap();
    std::fs::write(&work, "X,Y,Z\n0,0,0\n").unwrap();
    let page = report(&folder.0, "page.html", &[machine.to_str().unwrap()]);
    let bench = Bench::mailed("mailed-bounds", &page, "trunnion.yaml");
    std::fs::write(&bench.file, BOUNDED).unwrap();
    let zero =
        bench.command("map", &["--reference", "machine", "--tool-poses", work.to_str().unwrap(), "--samples", "300"]);
    let here = "return document.querySelector('[data-at=here]')?.dataset.value ?? '';";
    bench.click("zero");
    let expected = zero["position_um"]["max"].as_f64().unwrap();
    wait(&bench.browser, &format!("return Math.abs((() => {{ {here} }})() - {expected}) < 1e-9;"));
    let slide = "const axis = document.querySelector('#axes input'); axis.value = '123'; \
        for (const kind of ['input', 'change']) axis.dispatchEvent(new Event(kind));";
    let _ = bench.browser.run(slide);
    let says = "document.getElementById('legend').textContent.includes('No value at this pose.')";
    wait(&bench.browser, &format!("return {says} && document.querySelector('[data-at=here]') === null;"));
    bench.click("worst");
    wait(&bench.browser, &format!("return !{says} && document.querySelector('[data-at=here]') !== null;"));
    bench.quiet();
}

/// With an engine the page answers by itself what the command line answers, on 50 random edits.
pub fn edits() {
    let folder = Folder::new("mailed-engine");
    let page = packaged(&folder, &variants(), &["trunnion.yaml", "--poses", "200"]);
    let size = std::fs::metadata(&page).unwrap().len();
    println!("  the page has {size} bytes");
    assert!(!are_shipped() || size < 5_000_000, "{size} bytes");
    let bench = Bench::mailed("mailed-edits", &page, "trunnion.yaml");
    let paint =
        "return performance.getEntriesByType('paint').map((of) => `${of.name} ${Math.round(of.startTime)} ms`);";
    println!("  {}", bench.browser.run(paint));
    let mut text = bench.on_disk();
    let mut state = 7_u64;
    let mut next = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let names = ["EA0Z", "EB0Z", "EC0Y", "EX0A", "EY0C", "EB0A", "EC0A", "EA0C", "EB0C"];
    let names: Vec<&str> = names.into_iter().filter(|name| text.contains(&format!("  {name}: "))).collect();
    assert!(names.len() > 4, "{names:?}");
    for _ in 0..50 {
        let error = names[usize::try_from(next(names.len() as u64)).unwrap()];
        let (before, rest) = text.split_once(&format!("  {error}: ")).unwrap();
        let (digits, after) = rest.split_once(" u").unwrap();
        let value = format!("{}.{}", next(60), next(10));
        bench.at_error(error);
        bench.browser.press(&vec!["\u{e017}"; digits.len()]);
        bench.types(&value);
        text = format!("{before}  {error}: {value} u{after}");
        std::fs::write(&bench.file, &text).unwrap();
        bench.settled();
        bench.agrees_at(200, &[]);
    }
    let kind = if are_shipped() { "relaxed SIMD" } else { "plain WebAssembly" };
    assert!(note(&bench.browser).ends_with(kind), "{}", note(&bench.browser));
    bench.click("save");
    bench.quiet();
}

/// An engine that answers otherwise, or does not run, is not used, and the page says so.
pub fn refused() {
    let folder = Folder::new("mailed-refused");
    let page = packaged(&folder, &["plain"], &["trunnion.yaml", "--poses", "100"]);
    let text = std::fs::read_to_string(&page).unwrap();
    let start: Value = serde_json::from_str(packed::element(&text, "start")).unwrap();
    let packed = start["zlib"].as_str().unwrap();
    let mut known: Value = serde_json::from_str(&packed::unpacked(packed)).unwrap();
    // A component of the deviation at the zero pose, as the program computed it.
    let deviation = &mut known["machines"][0]["eval"]["answer"]["poses"][0]["deviation"][0];
    assert!(deviation.is_f64(), "{deviation}");
    *deviation = 1.0.into();
    let other = BASE64.encode(compress_to_vec_zlib(known.to_string().as_bytes(), 6));
    std::fs::write(&page, text.replace(packed, &other)).unwrap();
    let bench = Bench::mailed("mailed-refused", &page, "trunnion.yaml");
    bench.at_error("EY0C");
    bench.types("1");
    wait(&bench.browser, "return document.getElementById('note').textContent.includes('answers otherwise');");
    wait(&bench.browser, "return !document.getElementById('problem').hidden;");
}

/// Moves the slider each time that the browser draws, and returns the 95 % values that were shown, and the drawings.
const HOLD: &str = "return new Promise((done) => { const slider = document.getElementById('number'), seen = []; \
    const look = new MutationObserver(() => { const of = document.querySelector('[data-at=p95]')?.dataset.value; \
    if (of && of !== seen.at(-1)) seen.push(of); }); \
    look.observe(document.getElementById('verdict'), { childList: true, subtree: true }); \
    const start = performance.now(), [low, step] = [Number(slider.min), Number(slider.step)]; let drawn = 0; \
    const move = () => { drawn += 1; slider.value = low + step * (1 + drawn % 40); \
    slider.dispatchEvent(new Event('input')); \
    if (performance.now() - start < 3000) return requestAnimationFrame(move); look.disconnect(); \
    done([seen, drawn, slider.value]); }; \
    requestAnimationFrame(move); });";

/// While a slider is held figures at 2000 poses follow it, and those shown last are the command line's.
pub fn held() {
    let folder = Folder::new("mailed-held");
    let page = packaged(&folder, &variants(), &["trunnion.yaml"]);
    let bench = Bench::mailed("mailed-drag", &page, "trunnion.yaml");
    bench.at_error("EY0C");
    // The engine starts with the first change.
    let step = "const slider = document.getElementById('number'); slider.value = Number(slider.value) + Number(slider.step); \
        for (const kind of ['input', 'change']) slider.dispatchEvent(new Event(kind));";
    let _ = bench.browser.run(step);
    wait(
        &bench.browser,
        "return document.getElementById('note').textContent.includes('WebAssembly') || document.getElementById('note').textContent.includes('SIMD');",
    );
    bench.settled();
    let found = bench.browser.run(HOLD);
    let (shown, drawn) = (found[0].as_array().unwrap().len(), found[1].as_u64().unwrap());
    println!("  in 3 s the page drew {drawn} times, with new figures {shown} times");
    assert!(shown >= 2, "{found}");
    let value: f64 = found[2].as_str().unwrap().parse().unwrap();
    let text = bench.on_disk().replace("EY0C: -9 um", &format!("EY0C: {value} um"));
    assert_ne!(text, bench.on_disk());
    std::fs::write(&bench.file, text).unwrap();
    let printed = bench.command("map", &["--random", "2000"])["position_um"]["p95"].as_f64().unwrap();
    wait(
        &bench.browser,
        &format!("return Number(document.querySelector('[data-at=p95]').dataset.value) === {printed};"),
    );
    assert_eq!(bench.browser.run("return document.body.dataset.state;"), "draft");
    let _ = bench.browser.run("document.getElementById('number').dispatchEvent(new Event('change'));");
    bench.settled();
    bench.agrees();
    bench.quiet();
}

/// A report of a five-axis machine with two controllers holds its engines, those of a release below 5 MB.
pub fn small() {
    let folder = Folder::new("mailed-small");
    for machine in ["trunnion.yaml", "tt-ac-800.yaml"] {
        let targets = [machine, "--target", "linuxcnc", "--target", "grid-csv"];
        let page = packaged(&folder, &variants(), &targets);
        let text = std::fs::read_to_string(&page).unwrap();
        println!("  {machine}: {} bytes", text.len());
        assert!(!are_shipped() || text.len() < 5_000_000, "{machine}: {} bytes", text.len());
        assert!(variants().iter().all(|variant| text.contains(&format!("id=\"engine-{variant}\""))), "{machine}");
    }
}

/// The report on paper: a page for the machine, then appendices.
pub fn screenshots() {
    let folder = Folder::new("mailed-screens");
    let page = report(&folder.0, "page.html", &["trunnion.yaml", "--target", "linuxcnc"]);
    let bench = Bench::mailed("mailed-shot", &page, "trunnion.yaml");
    bench.browser.screenshot(&kept().join("mailed.png"), false);
    bench.browser.screenshot(&kept().join("mailed-whole.png"), true);
    let wide = bench.browser.run("return document.documentElement.scrollWidth <= innerWidth;");
    assert_eq!(wide, true, "the page is cut");
}

/// The page of three machines says on its first screen which is better, by how much, and whether that is known, as
/// `compare` does.
pub fn three() {
    let folder = Folder::new("mailed-three");
    let text = std::fs::read_to_string("configs/vmc-cframe-754.yaml").unwrap();
    let own = |line: &&str| !["  E", "  - errors", "measured:", "errors:"].iter().any(|of| line.starts_with(of));
    let bounded = text.lines().filter(own).collect::<Vec<_>>().join("\n");
    let files = ["premium", "production", "commodity"].map(|class| {
        let file = folder.0.join(format!("{class}.yaml"));
        std::fs::write(&file, format!("{bounded}\nclass: {class}\n")).unwrap();
        file.to_str().unwrap().to_owned()
    });
    let [premium, production, commodity] = files.each_ref().map(String::as_str);
    let page = report(&folder.0, "page.html", &[production, premium, commodity, "--samples", "200"]);
    let bench = Bench::mailed("mailed-three-page", &page, "vmc-cframe-754.yaml");
    wait(&bench.browser, "return document.querySelector('[data-at=answer-by]') !== null;");
    let answer = |of: &str| {
        let found = bench.browser.run(&format!("return document.getElementById('answer-{of}').textContent;"));
        found.as_str().unwrap().to_owned()
    };
    // The first of the others is the one that the rest is compared with.
    let output = abbe()
        .args(["compare", premium, commodity, production, "--format", "json", "--quiet", "--reference", "machine"])
        .args(["--poses", "300", "--samples", "200", "--max-samples", "200"])
        .output()
        .unwrap();
    let compared: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(compared["verdicts"][1]["verdict"], "worse", "{compared}");
    assert_eq!(Some(bench.figure("answer-by")), compared["verdicts"][1]["by"]["um"].as_f64());
    assert!(answer("better").starts_with("✓ A: premium.yaml"), "{}", answer("better"));
    assert!(answer("sure").starts_with("✓ Yes"), "{}", answer("sure"));
    // Of the third machine it says the same, and so does the page of the best one itself.
    let beside = ["answer-by-1", "answer-by"];
    for (i, at) in beside.into_iter().enumerate() {
        assert_eq!(Some(bench.figure(at)), compared["verdicts"][i]["by"]["um"].as_f64());
    }
    let _ = bench.browser.run(
        "const list = document.getElementById('example');
         list.value = [...list.options].find((of) => of.value.endsWith('premium.yaml')).value;
         list.dispatchEvent(new Event('change'));",
    );
    wait(&bench.browser, "return document.getElementById('answer-better').textContent.startsWith('✓ premium.yaml');");
    for (i, at) in beside.into_iter().enumerate() {
        assert_eq!(Some(bench.figure(at)), compared["verdicts"][i]["by"]["um"].as_f64());
    }
    columns(&bench, [premium, commodity, production]);
    bench.quiet();
}

/// The eight answers of each machine stand beside each other, with the headline that `budget` gives.
fn columns(bench: &Bench, files: [&str; 3]) {
    bench.click("tab-variants");
    wait(&bench.browser, "return document.querySelectorAll('#columns tbody tr').length === 9;");
    for (i, file) in files.into_iter().enumerate() {
        let output = abbe()
            .args(["budget", file, "--format", "json", "--quiet", "--poses", "300", "--samples", "200"])
            .output()
            .unwrap();
        let budget: Value = serde_json::from_slice(&output.stdout).unwrap();
        let own = budget["position_um"]["monte_carlo"]["percentiles"]["p95"]["value"].as_f64();
        assert_eq!(Some(bench.figure(&format!("column-{i}-decides"))), own, "{file}");
        let first = budget["tighten"][0]["um_of_p95"].as_f64();
        assert_eq!(Some(bench.figure(&format!("column-{i}-answer-tighten-first"))), first, "{file}");
        let test = format!("[data-at='column-{i}-answer-bar']");
        assert_eq!(bench.browser.run(&format!("return document.querySelector(\"{test}\") !== null;")), true, "{file}");
    }
}
