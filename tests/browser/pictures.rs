//! Screenshots, for people to look at.

use crate::driver::Browser;
use crate::page::open;
use crate::{Folder, five_axes, kept, report};
use serde_json::json;
use std::process::Command;

/// Colour of the page's ground.
fn ground(browser: &Browser) -> String {
    browser.run("return getComputedStyle(document.body).backgroundColor;").as_str().unwrap().to_owned()
}

fn scheme(browser: &Browser, value: &str) {
    let _ = browser.devtools(
        "Emulation.setEmulatedMedia",
        &json!({"features": [{"name": "prefers-color-scheme", "value": value}]}),
    );
}

pub fn screenshots() {
    let folder = Folder::new("pictures");
    let page = five_axes();
    let both =
        report(&folder.0, "both.html", &["trunnion.yaml", "ht-b-c.yaml", "--class", "production", "--samples", "60"]);
    let kept = kept();
    let mut shots = Vec::new();
    for (name, width, height, colours, file) in [
        ("light", 1366, 900, "light", &page),
        ("dark", 1366, 900, "dark", &page),
        ("projector", 1920, 1080, "light", &page),
        ("mobile", 390, 844, "light", &page),
        ("comparison", 1366, 900, "light", &both),
    ] {
        let browser = Browser::new(width, height);
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500});
        let _ = browser.devtools("Emulation.setDeviceMetricsOverride", &size);
        scheme(&browser, colours);
        open(&browser, file);
        let dark = ground(&browser) != "rgb(255, 255, 255)";
        assert_eq!(dark, colours == "dark", "{name}: {}", ground(&browser));
        // Nothing sticks out to the right: tables scroll in themselves.
        let wide = browser.run("return document.documentElement.scrollWidth;").as_f64().unwrap();
        assert!(wide <= f64::from(width) + 1.0, "{name}: the page is {wide} wide");
        let path = kept.join(format!("{name}.png"));
        browser.screenshot(&path, true);
        shots.push(path);
    }
    let browser = Browser::new(1366, 900);
    scheme(&browser, "dark");
    open(&browser, &page);
    let pdf = browser.print();
    assert!(pdf.starts_with(b"%PDF-") && pdf.len() > 50_000);
    std::fs::write(kept.join("print.pdf"), &pdf).unwrap();
    shots.push(kept.join("print.pdf"));
    // For looking at without a reader of PDF.
    let _ = Command::new("pdftoppm")
        .args(["-png", "-r", "60"])
        .arg(kept.join("print.pdf"))
        .arg(kept.join("print"))
        .status();
    for shot in &shots {
        println!("  {}", shot.display());
        assert!(std::fs::metadata(shot).unwrap().len() > 20_000);
    }
}
