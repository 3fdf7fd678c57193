//! For who reads: units of a choice everywhere on the page and below it, and the first page on paper and in a slide.

use crate::driver::Browser;
use crate::files::read_svg;
use crate::review::fill;
use crate::watch::wait;
use crate::workbench::Bench;
use crate::{Folder, kept, report};
use serde_json::{Value, json};
use std::path::Path;

/// Figures of the page in um: each with its words.
const FIGURES: &str = "return [...document.querySelectorAll('.number[data-at], strong[data-at]')]
    .filter((of) => / (µm|µin)$/.test(of.textContent)).map((of) => [of.dataset.at, of.dataset.value, of.textContent]);";

/// Words, titles and labels with a unit of the program, but for the file's own text.
const PROGRAM_UNITS: &str = r"
    const unit = /µm|µrad|(^|[\s\d])u(m|rad)\b/, found = [];
    const walk = document.createTreeWalker(document.getElementById('bench'), NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
    for (let node = walk.currentNode; node; node = walk.nextNode()) {
        const of = node.nodeType === 3 ? node.parentElement : node;
        if (of.closest('#file, #units')) continue;
        const texts = node.nodeType === 3 ? [node.data] : ['title', 'aria-label', 'aria-valuetext', 'placeholder'].map((name) => of.getAttribute(name) ?? '');
        for (const text of texts) if (unit.test(text)) found.push([of.id || of.className, text]);
    }
    return found;";

fn each_figure_is_read(bench: &Bench) -> usize {
    let list: Vec<(String, String, String)> = serde_json::from_value(bench.browser.run(FIGURES)).unwrap();
    for (at, um, words) in &list {
        let shown = words.strip_suffix(" µin").unwrap_or_else(|| panic!("{at}: {words}")).replace('\u{2212}', "-");
        let Ok(number) = shown.parse::<f64>() else { continue };
        let decimals = shown.split_once('.').map_or(0, |(_, part)| part.len());
        let half = 0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap()) * (1.0 + 1e-9);
        let uin = um.parse::<f64>().unwrap() / 0.0254;
        assert!((number - uin).abs() <= half, "{at}: {um} um is {uin} uin, not {words}");
    }
    list.len()
}

/// Micro-inch and arcsec wherever the page has a figure, kept in the address; the data stay those of the program.
pub fn units() {
    // Of the location errors one is measured; a class bounds the others.
    let text = std::fs::read_to_string("configs/trunnion.yaml").unwrap();
    let is_kept = |line: &&str| !line.starts_with("  E") || line.starts_with("  EY0A");
    let text = text.lines().filter(is_kept).collect::<Vec<_>>().join("\n");
    let bench = Bench::new(
        "bench-units",
        &format!("{text}\nclass: production\njob: {{ tool_poses: work.csv, limit: 25.4 um }}\n"),
        (1400, 900),
    );
    std::fs::copy("docs/examples/work.csv", bench.file.with_file_name("work.csv")).unwrap();
    wait(&bench.browser, "return document.querySelector('[data-at=job]') !== null;");
    let before = bench.figure("job");
    bench.click("keep-a");
    fill(&bench, "field", "all");
    wait(&bench.browser, "return document.querySelector('[data-at=here]') !== null;");
    fill(&bench, "units", "uin-arcsec");
    wait(&bench.browser, "return document.querySelector('[data-at=job]').textContent.endsWith('µin');");
    wait(&bench.browser, "return document.getElementById('limit').placeholder === '1000';");
    fill(&bench, "limit", "600");
    assert!(bench.browser.run("return location.hash;").as_str().unwrap().contains("limit=15.24"));
    fill(&bench, "goal", "2000");
    bench.click("find-tolerances");
    wait(&bench.browser, "return document.querySelector('[data-at=goal-proof]') !== null;");
    for tab in ["answers", "errors", "curve", "tighten", "variants", "part", "control", "acceptance"] {
        bench.click(&format!("tab-{tab}"));
        std::thread::sleep(std::time::Duration::from_millis(1500));
        let left = bench.browser.run(PROGRAM_UNITS);
        assert_eq!(left, json!([]), "{tab}");
        if tab == "errors" {
            bench.browser.screenshot(&kept().join("workbench-units.png"), false);
        }
    }
    assert_eq!(bench.figure("job"), before);
    assert!(each_figure_is_read(&bench) > 20);
    bench.browser.open(&format!("{}&units=uin-arcsec", bench.address));
    let _ = bench.browser.run("location.reload();");
    wait(&bench.browser, "return document.querySelector('[data-at=job]')?.textContent.endsWith('µin') ?? false;");
    fill(&bench, "units", "");
    wait(&bench.browser, "return document.querySelector('[data-at=job]').textContent.endsWith('µm');");
    bench.quiet();
}

/// A mailed page with a job, from a folder of its own.
fn page(folder: &Folder) -> std::path::PathBuf {
    let work = folder.0.join("work.csv");
    std::fs::copy("docs/examples/work.csv", &work).unwrap();
    let of = ["trunnion.yaml", "--class", "production", "--target", "linuxcnc", "--tool-poses", work.to_str().unwrap()];
    report(&folder.0, "page.html", &of)
}

fn opened(page: &Path, hash: &str) -> Browser {
    let browser = Browser::new(1400, 900);
    browser.open(&format!("file://{}{hash}", page.display()));
    wait(&browser, "return document.body.dataset.state === 'full' && !document.body.dataset.busy && views.length > 0;");
    browser
}

/// The report below: every figure in um is read in micro-inch, and no words say um but those of its pictures.
pub fn report_units() {
    let folder = Folder::new("report-units");
    let page = page(&folder);
    let figures = "return [...root.querySelectorAll('.n')].map((of) => [of.dataset.at, of.textContent]);";
    let own = opened(&page, "").run(figures);
    let browser = opened(&page, "#units=uin-arcsec");
    let read = browser.run(figures);
    let number = |of: &Value| of.as_str().unwrap().replace('\u{2212}', "-").parse::<f64>().unwrap_or(0.0);
    let mut counts = [0, 0, 0];
    for (own, read) in own.as_array().unwrap().iter().zip(read.as_array().unwrap()) {
        let at = own[0].as_str().unwrap();
        let (um, urad) = (
            at.contains("_um/") || at.ends_with("_um") || at.contains("um_of_"),
            at.contains("urad/") || at.ends_with("urad"),
        );
        let size = if um && !at.contains("um_per") {
            0.0254
        } else if urad {
            std::f64::consts::PI / 0.648
        } else {
            1.0
        };
        if at.contains("tolerance")
            || at.contains("um_per")
            || at.contains("/locations/")
            || at.contains("/work/features/")
            || number(&own[1]).abs() < 1.0
        {
            continue;
        }
        counts[usize::from(um) + 2 * usize::from(urad && !um)] += 1;
        let (before, after) = (number(&own[1]), number(&read[1]));
        assert!((after * size / before - 1.0).abs() < 2e-2, "{at}: {own} is read {read}");
    }
    assert!(counts.iter().all(|count| *count > 20), "{counts:?}");
    let words = browser.run(
        "const found = [], walk = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
         for (let node = walk.nextNode(); node; node = walk.nextNode())
             if (/µm|µrad/.test(node.data) && !node.parentElement?.closest('svg, .pictures-in, style, #conventions')) found.push(node.data);
         return found;",
    );
    assert_eq!(words, json!([]));
    assert!(browser.complaints().is_empty());
}

/// On paper: a first page with machine, verdict and answers, letters of 8 pt or more, no page that is nearly empty.
pub fn paper() {
    let folder = Folder::new("paper");
    let browser = opened(&page(&folder), "");
    let _ = browser.devtools("Emulation.setEmulatedMedia", &json!({"media": "print"}));
    let _ = browser.devtools(
        "Emulation.setDeviceMetricsOverride",
        &json!({"width": 688, "height": 1016, "deviceScaleFactor": 1, "mobile": false}),
    );
    let _ = browser.run("dispatchEvent(new Event('beforeprint'));");
    let first = browser.run(
        "const seen = (of) => document.querySelector(of)?.checkVisibility() ?? false;
         const copy = document.querySelector('#stage .paper'), {data} = copy.getContext('2d').getImageData(0, 0, copy.width, copy.height);
         let drawn = 0;
         for (let i = 3; i < data.length; i += 4) drawn += data[i] > 0;
         return [drawn / (copy.width * copy.height) > 0.03, seen('.headline'), document.querySelectorAll('.answers tr').length,
                 seen('.answers'), seen('#editor'), seen('#tab-errors'), document.getElementById('bench').getBoundingClientRect().height < 1016];",
    );
    assert_eq!(
        first,
        json!([true, true, 8, true, false, false, true]),
        "picture, headline, rows, answers, editor, tabs, one page"
    );
    // Points of letters: CSS pixels times the scale of a picture.
    let small = browser.run(
        "const found = [], size = (of) => parseFloat(getComputedStyle(of).fontSize) * (of.ownerSVGElement ? Math.hypot(of.getScreenCTM().a, of.getScreenCTM().b) : 1) * 0.75;
         for (const from of [document.getElementById('bench'), root]) for (const of of from.querySelectorAll('*')) {
             if (![...of.childNodes].some((node) => node.nodeType === 3 && node.data.trim()) || !of.checkVisibility() || of.matches('style, script, title, option')) continue;
             if (size(of) < 7.95) found.push([of.tagName, size(of), of.textContent.slice(0, 30)]);
         }
         return found;",
    );
    assert_eq!(small, json!([]), "letters below 8 pt");
    let _ = browser.run("dispatchEvent(new Event('afterprint'));");
    assert_eq!(browser.run("return document.querySelector('.paper');"), Value::Null);
    let pdf = browser.print();
    std::fs::write(kept().join("paper.pdf"), &pdf).unwrap();
    assert!(browser.complaints().is_empty());
}

/// The first screen and the machine as files.
pub fn slide() {
    let bench = Bench::of_config("bench-slide", "trunnion.yaml");
    let folder = bench.file.parent().unwrap().join("downloads");
    std::fs::create_dir_all(&folder).unwrap();
    let _ =
        bench.browser.devtools("Browser.setDownloadBehavior", &json!({"behavior": "allow", "downloadPath": folder}));
    wait(&bench.browser, "return document.querySelector('[data-at=answer-bar]') !== null;");
    let click = |label: &str| {
        let _ = bench.browser.run(&format!(
            "[...document.querySelectorAll('#slide button, #gltf')].find((of) => of.textContent === '{label}').click();"
        ));
    };
    let file = |name: &str| {
        let path = folder.join(name);
        (0..100).find(|_| {
            path.exists() || {
                std::thread::sleep(std::time::Duration::from_millis(50));
                false
            }
        });
        std::fs::read(path).unwrap()
    };
    click("SVG");
    let svg = String::from_utf8(file("review.svg")).unwrap();
    let (texts, [width, _]) = read_svg(&bench.browser, &svg);
    assert_eq!(width, 1280);
    let all = texts.join(" ");
    for words in
        ["Trunnion five-axis machining centre", "Which error dominates, and where?", "The axis of C", "Ball bar"]
    {
        assert!(all.contains(words), "{words}: {all}");
    }
    assert!(svg.contains("<image href=\"data:image/png"));
    click("PNG");
    let png = file("review.png");
    std::fs::write(kept().join("review.png"), &png).unwrap();
    assert!(png.starts_with(b"\x89PNG") && png.len() > 50_000, "{}", png.len());
    click("glTF");
    let glb = file("machine.glb");
    assert!(glb.starts_with(b"glTF"));
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let scene: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let bodies: Vec<&str> = scene["nodes"].as_array().unwrap().iter().filter_map(|of| of["name"].as_str()).collect();
    assert!(["bed", "X", "Y", "Z", "A", "C", "machine"].iter().all(|name| bodies.contains(name)), "{bodies:?}");
    // Metres by the scale of the last node, and the bytes that the parts of the file name.
    assert_eq!(scene["nodes"].as_array().unwrap().last().unwrap()["scale"], json!([1e-3, 1e-3, 1e-3]));
    let bytes = scene["buffers"][0]["byteLength"].as_u64().unwrap();
    assert_eq!(glb.len() as u64, 28 + length as u64 + bytes);
    for of in scene["accessors"].as_array().unwrap() {
        let view = &scene["bufferViews"][of["bufferView"].as_u64().unwrap() as usize];
        let lanes = if of["type"] == "VEC3" { 3 } else { 1 };
        assert_eq!(view["byteLength"].as_u64().unwrap(), 4 * lanes * of["count"].as_u64().unwrap(), "{of}");
    }
    bench.quiet();
}

/// Names of all axes in the picture, X Y Z, a scale, views, and lever arms whose lengths are those of the geometry.
pub fn views() {
    let bench = Bench::of_config("bench-views", "trunnion.yaml");
    let notes = "return [...document.querySelectorAll('#stage .notes span')].map((of) => of.textContent).sort();";
    let wait_notes = |count: usize| {
        wait(&bench.browser, &format!("return document.querySelectorAll('#stage .notes span').length === {count};"));
        bench.browser.run(notes)
    };
    assert_eq!(wait_notes(5), json!(["A", "C", "X", "Y", "Z"]));
    assert_eq!(bench.browser.run("return document.querySelector('#stage .triad').textContent;"), "XYZ");
    bench.click("arms");
    // At the zero pose the tip is at (0, 0, -120); C stands at (250, 225), A lies at Y = 225, Z = -350, and they meet.
    let [c, a] = [250_f64.hypot(225.0), 225_f64.hypot(230.0)];
    let found = wait_notes(8);
    for words in [format!("C arm {c:.2} mm"), format!("A arm {a:.2} mm"), "A to C 0 mm".to_owned()] {
        assert!(found.as_array().unwrap().contains(&json!(words)), "{words}: {found}");
    }
    let picture = || bench.browser.run("return document.querySelector('#stage canvas').toDataURL();");
    let mut seen = vec![];
    for view in ["front", "right", "top", "fit"] {
        bench.click(&format!("view-{view}"));
        std::thread::sleep(std::time::Duration::from_millis(300));
        let drawn = picture();
        assert!(!seen.contains(&drawn), "{view} is another picture");
        seen.push(drawn);
        bench.browser.screenshot(&kept().join(format!("workbench-view-{view}.png")), false);
    }
    // Of a scale of so many mm the width is that on the screen: from the front an axis is as long as it is.
    let bar = bench.browser.run("const bar = document.querySelector('.scale-bar'); return [parseFloat(bar.textContent), bar.getBoundingClientRect().width];");
    assert!(bar[0].as_f64().unwrap() > 0.0 && (20.0..300.0).contains(&bar[1].as_f64().unwrap()), "{bar}");
    let _ = bench.browser.run("location.reload();");
    wait(&bench.browser, "return document.getElementById('arms')?.getAttribute('aria-pressed') === 'true';");
    bench.quiet();
}

/// A binary STL of a box between two corners.
fn block(low: [f32; 3], high: [f32; 3]) -> Vec<u8> {
    let corner = |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { high[i] } else { low[i] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let mut bytes = [vec![0; 80], 12_u32.to_le_bytes().to_vec()].concat();
    for half in halves {
        bytes.extend([0.0_f32; 3].into_iter().chain(half.into_iter().flat_map(corner)).flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Share of the picture that is plainly red.
const RED: &str = "return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
    const canvas = document.querySelector('#stage canvas'), copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const brush = copy.getContext('2d');
    brush.drawImage(canvas, 0, 0);
    const {data} = brush.getImageData(0, 0, copy.width, copy.height);
    let red = 0;
    for (let i = 0; i < data.length; i += 4) red += data[i + 3] > 200 && data[i] > 60 && data[i] > 3 * data[i + 1];
    done(red / (copy.width * copy.height));
})));";

/// Meshes that the file names stand for the castings, on the workbench and in a mailed page; what cannot be drawn is
/// named, and the machine stays.
pub fn meshes() {
    let folder = Folder::new("meshes");
    let at = |name: &str| folder.0.join(name).display().to_string();
    let write = |name: &str, bytes: &[u8]| std::fs::write(at(name), bytes).unwrap();
    write("ram.stl", &block([150.0, 100.0, -20.0], [350.0, 350.0, 500.0]));
    write(
        "part.obj",
        b"mtllib part.mtl\nusemtl red\nv 0 0 0\nv 150 0 0\nv 0 150 0\nv 0 0 120\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
    );
    write("part.mtl", b"newmtl red\nKd 0.9 0.02 0.02\nmap_Kd photo.png\n");
    let text = std::fs::read_to_string("configs/trunnion.yaml").unwrap();
    let look =
        format!("look:\n  Z: {}\n  workpiece: {{ mesh: {}, origin: [-60, -60, 0] }}\n", at("ram.stl"), at("part.obj"));
    let bench = Bench::new("bench-meshes", &format!("{text}{look}"), (1400, 900));
    wait(&bench.browser, "return document.getElementById('look').textContent === 'meshes of 16 triangles';");
    let red = |bench: &Bench| bench.browser.run(RED).as_f64().unwrap();
    assert!(red(&bench) > 0.001, "{}", red(&bench));
    let told = "return document.getElementById('problem').innerText;";
    let said = bench.browser.run(told);
    assert!(said.as_str().unwrap().contains("are left out: textures"), "{said}");
    bench.browser.screenshot(&kept().join("workbench-meshes.png"), false);
    // Another file on the disk is another picture; one that cannot be read gives way to the castings.
    write("part.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    wait(&bench.browser, "return document.getElementById('look').textContent === 'meshes of 12 triangles';");
    let said = bench.browser.run(told);
    assert!(said.as_str().unwrap().contains("not a finite number"), "{said}");
    assert!(red(&bench) < 1e-4, "{}", red(&bench));
    let triangles = bench.browser.run("return Number(document.querySelector('#stage canvas').dataset.triangles);");
    assert!(triangles.as_f64().unwrap() > 100.0, "{triangles}");
    bench.agrees();
    write(
        "part.obj",
        b"mtllib part.mtl\nusemtl red\nv 0 0 0\nv 150 0 0\nv 0 150 0\nv 0 0 120\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
    );
    let page = folder.0.join("page.html");
    let made =
        crate::abbe().args(["report", "--quiet", "--samples", "20", "--out"]).arg(&page).arg(&bench.file).status();
    assert!(made.unwrap().success());
    drop(bench);
    for name in ["part.obj", "ram.stl"] {
        std::fs::remove_file(at(name)).unwrap();
    }
    let browser = Browser::new(1400, 900);
    browser.open_file(&page);
    wait(&browser, "return document.getElementById('look')?.textContent === 'meshes of 16 triangles';");
    assert!(browser.run(RED).as_f64().unwrap() > 0.001);
    browser.screenshot(&kept().join("mailed-meshes.png"), false);
    assert_eq!(browser.complaints(), []);
}

/// The path is played, paused, stepped and dragged: the machine follows, and a row says what the library says of it.
pub fn played() {
    let bench = Bench::of_config("bench-played", "trunnion.yaml");
    let work = bench.file.with_file_name("work.csv");
    // Round a pole of C, and over a corner.
    let mut rows = "X,Y,Z,I,J,K\n".to_owned();
    for k in 0..=20 {
        let lean = f64::from(k - 10) * 0.04;
        rows += &format!("{},{},30,{},0.001,1\n", 2 * k, k, lean);
    }
    std::fs::write(&work, rows).unwrap();
    bench.click("tab-part");
    fill(&bench, "path", "yes");
    fill(&bench, "work", work.to_str().unwrap());
    wait(&bench.browser, "return document.getElementById('play-words') !== null;");
    let words = |bench: &Bench| {
        bench.browser.run("return document.getElementById('play-words').textContent;").as_str().unwrap().to_owned()
    };
    assert!(words(&bench).starts_with("Line 2: "), "{}", words(&bench));
    let note = bench.browser.run("return document.getElementById('player').textContent;");
    assert!(note.as_str().unwrap().contains("No collision test"), "{note}");
    let texts = json!({"machine": bench.file, "questions": [{"work": {"tool_poses": work, "path": true}}]});
    let found = abbe::workbench(&texts.to_string(), abbe::Run::on_disk())["answers"][0].clone();
    let path = &found["map"]["path"];
    let events = path["rewinds"].as_array().unwrap().len() + path["pole_crossings"].as_array().unwrap().len();
    let drawn = bench.browser.run("return document.querySelectorAll('#player .marks button').length;");
    assert!(events > 0 && drawn == events, "{drawn} {path}");
    bench.click("play-next");
    let row = &found["played"][1];
    let said = words(&bench);
    let number = |text: &str| text.trim().replace('−', "-").parse::<f64>().unwrap();
    let (line, rest) = said.split_once(": ").unwrap();
    let (across, rest) = rest.split_once(" µm across the surface, ").unwrap();
    let along = rest.split(" µm along it").next().unwrap();
    assert_eq!(line, "Line 3");
    for (shown, truth) in [(across, &row["across_um"]), (along, &row["along_um"])] {
        assert!((number(shown) - truth.as_f64().unwrap()).abs() < 0.06, "{shown} for {truth}");
    }
    let (axis, _) = row["axes"].as_object().unwrap().iter().next().unwrap();
    assert!(rest.contains(&format!("by axis, along it: {axis} ")), "{said}");
    let position = "return Number(document.getElementById('axis-X').value);";
    let x = found["rows"]["poses"][1]["axes"]["X"].as_f64().unwrap();
    wait(&bench.browser, &format!("return Math.abs(Number(document.getElementById('axis-X').value) - {x}) < 0.01;"));
    // It plays, and stands where it is paused.
    bench.click("play");
    wait(&bench.browser, "return Number(document.getElementById('play-at').value) > 8;");
    assert_eq!(bench.browser.run("return document.getElementById('play').textContent;"), "Pause");
    bench.click("play");
    let paused = bench.browser.run("return Number(document.getElementById('play-at').value);").as_f64().unwrap();
    let there = bench.browser.run(position);
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert_eq!(bench.browser.run("return Number(document.getElementById('play-at').value);").as_f64(), Some(paused));
    assert_eq!(bench.browser.run(position), there);
    bench.browser.screenshot(&kept().join("workbench-played.png"), false);
    fill(&bench, "play-speed", "30");
    bench.click("play");
    wait(&bench.browser, "const at = document.getElementById('play-at'); return at.value === at.max;");
    wait(&bench.browser, "return document.getElementById('play').textContent === 'Play';");
    assert!(words(&bench).starts_with("Line 22: "), "{}", words(&bench));
    bench.quiet();
}
