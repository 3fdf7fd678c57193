//! The page as a file.

use crate::driver::Browser;
use crate::watch::wait;
use crate::{Folder, five_axes, packed, report};
use std::path::{Path, PathBuf};

/// The picture of the first view, as text.
const PICTURE: &str = "return root.querySelector('canvas').toDataURL();";

fn opened(page: &Path) -> Browser {
    let browser = Browser::new(1366, 900);
    open(&browser, page);
    browser
}

/// Opens a page and waits for the pictures of its appendices, whose data are compressed.
pub fn open(browser: &Browser, page: &Path) {
    browser.open_file(page);
    wait(browser, "return views.length > 0;");
}

pub fn loads() {
    let folder = Folder::new("loads");
    let of = |(i, arguments): (usize, &&[&str])| report(&folder.0, &format!("{i}.html"), arguments);
    let others: [&[&str]; 3] = [&["vmc-cframe-754.yaml"], &["trunnion.yaml", "ht-b-c.yaml"], &["robots/ur5.yaml"]];
    let pages: Vec<PathBuf> = others.iter().enumerate().map(of).chain([five_axes()]).collect();
    for page in &pages {
        let browser = opened(page);
        let complaints = browser.complaints();
        assert!(complaints.is_empty(), "{page:?}: {complaints:?}");
        let strangers: Vec<String> = browser
            .requests()
            .into_iter()
            .filter(|url| !url.starts_with("file://") && !url.starts_with("data:"))
            .collect();
        assert!(strangers.is_empty(), "{strangers:?}");
        let drawn = browser.run("return views.length > 0 && views.every((view) => view.canvas.width > 100 && new Set(view.canvas.getContext('2d').getImageData(0, 0, view.canvas.width, view.canvas.height).data).size > 20);");
        assert_eq!(drawn, true, "{page:?}: an empty picture");
        // The policy holds: a fetch of a script is refused.
        let fetched = browser.run("return fetch('http://127.0.0.1:1/').then(() => 'reached', () => 'refused');");
        assert_eq!(fetched, "refused");
        assert!(browser.complaints().iter().any(|(_, text)| text.contains("Content Security Policy")));
    }
    let size = std::fs::metadata(five_axes()).unwrap().len();
    assert!(size < 5_000_000, "{size} bytes");
}

pub fn numbers() {
    let folder = Folder::new("numbers");
    let page = report(
        &folder.0,
        "page.html",
        &["trunnion.yaml", "vmc-cframe-754.yaml", "--target", "linuxcnc", "--class", "production", "--samples", "60"],
    );
    let browser = opened(&page);
    let data = packed::data(&std::fs::read_to_string(&page).unwrap());
    let shown =
        browser.run("return [...root.querySelectorAll('[data-at]')].map((n) => [n.dataset.at, n.textContent]);");
    let shown = shown.as_array().unwrap();
    assert!(shown.len() > 1400, "{}", shown.len());
    for pair in shown {
        let (at, text) = (pair[0].as_str().unwrap(), pair[1].as_str().unwrap());
        let value = data.pointer(at).unwrap_or_else(|| panic!("{at} is not in the data")).as_f64().unwrap();
        let plain = text.replace('\u{2212}', "-").replace('+', "");
        let printed: f64 = plain.parse().unwrap_or_else(|_| panic!("{at}: {text}"));
        // Half a unit of the last digit: of the fourth significant one, or of the last decimal that is shown.
        let decimals = plain.split_once('.').map_or(0, |(_, part)| part.len());
        let half = 0.5 * 10_f64.powi(-(i32::try_from(decimals).unwrap())).max(value.abs() * 1e-3);
        assert!((printed - value).abs() <= half * (1.0 + 1e-9), "{at}: {text} for {value}");
    }
    // Text of the view.
    let said = browser.run("return root.querySelector('.said').textContent;");
    let at = &data["machines"][0]["field"]["layers"][0]["at"][0];
    let number =
        said.as_str().unwrap().split("Largest ").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
    assert!((number / at["max_um"].as_f64().unwrap() - 1.0).abs() < 1e-3, "{said}");
}

/// Changes a control as a reader would, and returns the script that reverts it.
fn set(name: &str, value: &str) -> String {
    format!(
        "const c = root.querySelector('[data-set=\"{name}\"]'); const old = c.type === 'checkbox' ? c.checked : c.value; \
         if (c.type === 'checkbox') c.checked = {value} === 1; else c.value = {value}; \
         c.dispatchEvent(new Event(c.type === 'range' ? 'input' : 'change')); return String(old);"
    )
}

pub fn controls() {
    let browser = opened(&five_axes());
    let picture = || browser.run(PICTURE);
    let first = picture();
    for (name, value) in [
        ("layer", "'EB0C'"),
        ("layer", "'axis-Y'"),
        ("layer", "'location'"),
        ("layer", "'after-grid-csv'"),
        ("layer", "'removed-linuxcnc'"),
        ("station", "'2'"),
        ("part", "'0'"),
        ("part", "'2'"),
        ("exaggeration", "'3'"),
        ("colour", "0"),
        ("arrows", "1"),
    ] {
        let old = browser.run(&set(name, value));
        assert_ne!(picture(), first, "{name} = {value} changes nothing");
        let old = old.as_str().unwrap();
        let back =
            if ["true", "false"].contains(&old) { u8::from(old == "true").to_string() } else { format!("'{old}'") };
        let _ = browser.run(&set(name, &back));
        assert_eq!(picture(), first, "{name} back to {old} is not the first picture");
    }
    // The slice moves only when there is one; colours of one error differ on its own scale.
    let _ = browser.run(&set("part", "'1'"));
    let slice = picture();
    let _ = browser.run(&set("slice", "'3'"));
    assert_ne!(picture(), slice);
    let _ = browser.run(&set("part", "'surface'"));
    let _ = browser.run(&set("layer", "'EXX'"));
    let shared = picture();
    let _ = browser.run(&set("fixed", "0"));
    assert_ne!(picture(), shared);
    let _ = browser.run("root.querySelector('[name=state][value=\"after-grid-csv\"]').click();");
    assert_eq!(browser.run("return root.querySelector('[data-set=layer]').value;"), "after-grid-csv");
    for look in ["X", "Y", "Z", "worst"] {
        let before = picture();
        let _ = browser.run(&format!("root.querySelector('[data-look={look}]').click();"));
        assert_ne!(picture(), before, "{look}");
    }
    assert!(browser.complaints().is_empty());
}

const TAB: &str = "\u{e004}";
const RIGHT: &str = "\u{e014}";

pub fn keyboard() {
    let browser = opened(&five_axes());
    let mut reached = false;
    let _ = browser.run("root.querySelector('.top a').focus();");
    for _ in 0..40 {
        browser.press(&[TAB]);
        reached = browser.run("return root.activeElement?.tagName === 'CANVAS';") == true;
        if reached {
            break;
        }
    }
    assert!(reached, "the tabulator never comes to the picture");
    let outline = browser.run("return getComputedStyle(root.activeElement).outlineStyle;");
    assert_eq!(outline, "solid", "the focus cannot be seen");
    let first = browser.run(PICTURE);
    for keys in [&[RIGHT, RIGHT][..], &["\u{e013}"], &["+"], &["-", "-"]] {
        browser.press(keys);
        assert_ne!(browser.run(PICTURE), first, "{keys:?}");
        browser.press(&["0"]);
        assert_eq!(browser.run(PICTURE), first, "0 after {keys:?}");
    }
    browser.press(&["w"]);
    let said = browser.run("return root.querySelector('.said').textContent;");
    assert!(said.as_str().unwrap().contains("Node X = "), "{said}");
    browser.press(&["."]);
    assert_ne!(browser.run("return root.querySelector('.said').textContent;"), said);
}

pub fn names() {
    let browser = opened(&five_axes());
    let nameless = browser.run(
        "const named = (e) => (e.labels && [...e.labels].some((l) => l.textContent.trim())) || e.getAttribute('aria-label') || e.textContent.trim(); \
         return [...root.querySelectorAll('input, select, button, canvas, a, form')].filter((e) => !named(e)).map((e) => e.outerHTML.slice(0, 80)) \
         .concat([...root.querySelectorAll('figure svg')].filter((s) => s.getAttribute('role') !== 'img' || !s.querySelector('title')).map((s) => s.outerHTML.slice(0, 80))) \
         .concat([...root.querySelectorAll('th:not([scope])')].map((t) => t.outerHTML));",
    );
    assert_eq!(nameless, serde_json::json!([]));
    let heads = browser.run("return [...root.querySelectorAll('h1, h2, h3')].map((h) => Number(h.tagName[1]));");
    let heads: Vec<i64> = heads.as_array().unwrap().iter().map(|h| h.as_i64().unwrap()).collect();
    assert!(heads.windows(2).all(|w| w[1] <= w[0] + 1), "headings leave out a level: {heads:?}");
}

pub fn hostile() {
    let folder = Folder::new("hostile");
    let name = "</script><script>document.title=\"taken\"</script><img src=x onerror=document.title=\"taken\">";
    let machine = format!(
        "abbe: 1\nmachine: '{name}'\nchain: \"w b X Y Z t\"\naxes:\n  X: {{ travel: [0, 500] }}\n  Y: {{ travel: [0, 400] }}\n  Z: {{ travel: [0, 300] }}\nerrors:\n  EC0Y: 20 urad\nprovenance: {{ source: '<b>{{{{ 7*7 }}}}</b>' }}\n"
    );
    let file = folder.0.join("hostile.yaml");
    std::fs::write(&file, machine).unwrap();
    let browser = opened(&report(&folder.0, "page.html", &[file.to_str().unwrap()]));
    assert!(browser.complaints().is_empty());
    assert_ne!(browser.run("return document.title;"), "taken");
    assert_eq!(browser.run("return root.querySelector('h1').textContent;"), name);
    assert_eq!(browser.run("return root.querySelectorAll('img, b:not(.tile b)').length;"), 0);
    assert_eq!(browser.run("return data.machines[0].name;"), name);
}
