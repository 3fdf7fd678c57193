//! Tables of the panels as files, looked into.

use crate::driver::Browser;
use crate::kept;
use crate::review::fill;
use crate::watch::wait;
use crate::workbench::Bench;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use std::path::Path;

/// Control and test: the CSV has the whole figures of the panel, the SVG its words and figures within its frame, and
/// the PNG is that picture in twice the size.
pub fn tables() {
    let bench = Bench::of_config("bench-tables", "trunnion.yaml");
    let folder = bench.file.parent().unwrap().join("downloads");
    std::fs::create_dir_all(&folder).unwrap();
    let allow = json!({"behavior": "allow", "downloadPath": folder});
    let _ = bench.browser.devtools("Browser.setDownloadBehavior", &allow);
    wait(&bench.browser, "return document.querySelectorAll('#target option').length > 5;");
    fill(&bench, "target", "linuxcnc-kins");
    for (panel, name, count) in [("control", "control-linuxcnc-kins", 6), ("acceptance", "acceptance", 20)] {
        bench.click(&format!("tab-{panel}"));
        wait(&bench.browser, &format!("return document.querySelector('#panel-{panel} .files') !== null;"));
        let figures = bench.browser.run(&format!(
            "return [...document.querySelectorAll('#panel-{panel} table .number')].map((of) => [of.dataset.value, of.textContent]);"
        ));
        let figures: Vec<(f64, String)> = serde_json::from_value::<Vec<(String, String)>>(figures)
            .unwrap()
            .into_iter()
            .map(|(value, text)| (value.parse().unwrap(), text))
            .collect();
        assert!(figures.len() >= count, "{panel}: {figures:?}");
        let heads = bench.browser.run(&format!(
            "return [...document.querySelectorAll('#panel-{panel} tbody th')].map((of) => of.textContent);"
        ));
        let heads: Vec<String> = serde_json::from_value(heads).unwrap();
        let [csv, svg, png] = ["csv", "svg", "png"].map(|ending| downloaded(&bench, panel, &folder, name, ending));
        // Row, column, value, unit: one line a figure.
        let written: Vec<f64> = String::from_utf8(csv)
            .unwrap()
            .lines()
            .skip(1)
            .map(|line| line.rsplit(',').nth(1).unwrap().parse().unwrap())
            .collect();
        assert_eq!(written, figures.iter().map(|(value, _)| *value).collect::<Vec<_>>(), "{panel}");
        let (texts, size) = read_svg(&bench.browser, &String::from_utf8(svg).unwrap());
        for words in figures.iter().map(|(_, text)| text).chain(&heads) {
            assert!(texts.iter().any(|text| text.contains(words.as_str())), "{panel}: {words} is not in {texts:?}");
        }
        std::fs::write(kept().join(format!("{name}.png")), &png).unwrap();
        assert_eq!(size_of_png(&png), size.map(|length| 2 * length), "{panel}");
        let ink = ink(&bench.browser, &png);
        assert!((0.005..0.3).contains(&ink), "{panel}: {ink} of the picture is ink");
    }
    bench.quiet();
}

fn downloaded(bench: &Bench, panel: &str, folder: &Path, name: &str, ending: &str) -> Vec<u8> {
    let label = ending.to_uppercase();
    let _ = bench.browser.run(&format!(
        "[...document.querySelectorAll('#panel-{panel} button')].find((of) => of.textContent === '{label}').click();"
    ));
    let file = folder.join(format!("{name}.{ending}"));
    for _ in 0..200 {
        // The browser first takes the name with an empty file.
        if let Some(bytes) = std::fs::read(&file).ok().filter(|bytes| !bytes.is_empty()) {
            return bytes;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    panic!("{} does not come", file.display());
}

/// Returns the texts of a picture, which are all within its frame and none on another, and its width and height.
pub fn read_svg(browser: &Browser, svg: &str) -> (Vec<String>, [u32; 2]) {
    let script = format!(
        "const holder = document.createElement('div'); holder.innerHTML = {}; document.body.append(holder); \
         const svg = holder.querySelector('svg'), frame = svg.getBoundingClientRect(); \
         const boxes = [...svg.querySelectorAll('text')].filter((of) => of.textContent).map((of) => of.getBoundingClientRect()); \
         const cut = boxes.filter((b) => b.left < frame.left || b.right > frame.right || b.bottom > frame.bottom).length; \
         const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top + 4 || b.bottom <= a.top + 4; \
         const over = boxes.filter((a, i) => boxes.some((b, k) => k < i && !apart(a, b))).length; \
         const texts = [...svg.querySelectorAll('text')].map((of) => of.textContent); \
         const found = [texts, [svg.width.baseVal.value, svg.height.baseVal.value], cut, over]; \
         holder.remove(); return found;",
        json!(svg)
    );
    let found = browser.run(&script);
    assert_eq!([&found[2], &found[3]], [0, 0], "texts that are cut, and that lie on others: {svg}");
    let number = |value: &Value| serde_json::from_value(value.clone()).unwrap();
    (serde_json::from_value(found[0].clone()).unwrap(), number(&found[1]))
}

/// Width and height, from the header of the format.
fn size_of_png(bytes: &[u8]) -> [u32; 2] {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

/// Share of the pixels that are dark.
fn ink(browser: &Browser, png: &[u8]) -> f64 {
    let script = format!(
        "const image = new Image(); image.src = 'data:image/png;base64,{}'; return image.decode().then(() => {{ \
         const copy = document.createElement('canvas'); [copy.width, copy.height] = [image.width, image.height]; \
         const brush = copy.getContext('2d'); brush.drawImage(image, 0, 0); \
         const {{data}} = brush.getImageData(0, 0, copy.width, copy.height); let dark = 0; \
         for (let i = 0; i < data.length; i += 4) if (data[i] < 128 && data[i + 3] === 255) dark++; \
         return dark / (data.length / 4); }});",
        BASE64.encode(png)
    );
    browser.run(&script).as_f64().unwrap()
}
