//! A client for chromedriver (W3C WebDriver over HTTP on 127.0.0.1), as far as these tests need one.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use base64::Engine;
use serde_json::{Value, json};

/// Checks that Chromium and its driver are there.
pub fn available() -> Result<(), String> {
    for program in ["chromium", "chromedriver"] {
        let found = Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !found.is_ok_and(|status| status.success()) {
            return Err(format!("{program} is not installed"));
        }
    }
    Ok(())
}

/// A browser of its own.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
}

impl Browser {
    /// Starts one with a window of this size, whose names all resolve to nothing.
    pub fn new(width: u32, height: u32) -> Self {
        let mut driver =
            Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut lines = BufReader::new(driver.stdout.take().unwrap()).lines();
        let port = lines
            .find_map(|line| {
                line.unwrap().split("on port ").nth(1)?.trim_end_matches('.').parse().ok().filter(|port| *port > 0)
            })
            .unwrap();
        // Unread output must not stop it.
        let _ = std::thread::spawn(move || lines.for_each(drop));
        let mut browser = Self { driver, port, session: String::new() };
        let arguments = [
            "--headless=new",
            "--no-sandbox",
            // The workbench draws in three dimensions: by software where there is no graphics card.
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--disable-dev-shm-usage",
            "--hide-scrollbars",
            "--force-device-scale-factor=1",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
            &format!("--window-size={width},{height}"),
        ];
        let capabilities = json!({"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": {"args": arguments, "perfLoggingPrefs": {"enableNetwork": true}},
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
        }}});
        let started = browser.call("POST", "/session", &capabilities);
        browser.session = started["sessionId"].as_str().unwrap().to_owned();
        browser
    }

    fn call(&self, method: &str, path: &str, body: &Value) -> Value {
        let body = if method == "POST" { body.to_string() } else { String::new() };
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
            self.port,
            body.len()
        );
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(body.as_bytes()).unwrap();
        let mut answer = BufReader::new(stream);
        let mut length = 0;
        loop {
            let mut line = String::new();
            answer.read_line(&mut line).unwrap();
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse().unwrap();
            }
            if line.trim().is_empty() {
                break;
            }
        }
        let mut bytes = vec![0; length];
        answer.read_exact(&mut bytes).unwrap();
        let answer: Value = serde_json::from_slice(&bytes).unwrap();
        let value = answer["value"].clone();
        assert!(value.get("error").is_none(), "{path}: {}", value["message"]);
        value
    }

    fn ask(&self, what: &str, body: &Value) -> Value {
        self.call("POST", &format!("/session/{}/{what}", self.session), body)
    }

    /// Opens an address.
    pub fn open(&self, address: &str) {
        let _ = self.ask("url", &json!({"url": address}));
    }

    /// Opens a file.
    pub fn open_file(&self, path: &Path) {
        self.open(&format!("file://{}", path.display()));
    }

    /// Runs a script and returns what it returns.
    pub fn run(&self, script: &str) -> Value {
        self.ask("execute/sync", &json!({"script": script, "args": []}))
    }

    /// Presses keys one after the other, where the focus is.
    pub fn press(&self, keys: &[&str]) {
        let stroke = |key: &&str| [json!({"type": "keyDown", "value": key}), json!({"type": "keyUp", "value": key})];
        self.act(&keys.iter().flat_map(stroke).collect());
    }

    /// Presses and lets go of keys, as WebDriver has them.
    pub fn act(&self, strokes: &Value) {
        let _ = self.ask("actions", &json!({"actions": [{"type": "key", "id": "keys", "actions": strokes}]}));
    }

    /// Drags from one point of the window to another.
    pub fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        let event = |kind: &str, (x, y): (f64, f64)| {
            let parameters = json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1});
            let _ = self.devtools("Input.dispatchMouseEvent", &parameters);
        };
        event("mousePressed", from);
        for step in 1..=8 {
            let share = f64::from(step) / 8.0;
            event("mouseMoved", (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
        }
        event("mouseReleased", to);
    }

    /// A command of the DevTools protocol.
    pub fn devtools(&self, command: &str, parameters: &Value) -> Value {
        self.ask("goog/cdp/execute", &json!({"cmd": command, "params": parameters}))
    }

    /// Returns the messages of the browser's console since the last call: (level, message).
    pub fn complaints(&self) -> Vec<(String, String)> {
        let log = self.ask("se/log", &json!({"type": "browser"}));
        let word = |v: &Value| v.as_str().unwrap().to_owned();
        log.as_array().unwrap().iter().map(|entry| (word(&entry["level"]), word(&entry["message"]))).collect()
    }

    /// Addresses that were asked for since last asked.
    pub fn requests(&self) -> Vec<String> {
        let log = self.ask("se/log", &json!({"type": "performance"}));
        let url = |entry: &Value| {
            let message: Value = serde_json::from_str(entry["message"].as_str()?).ok()?;
            let request = &message["message"];
            (request["method"] == "Network.requestWillBeSent")
                .then(|| request["params"]["request"]["url"].as_str().unwrap().to_owned())
        };
        log.as_array().unwrap().iter().filter_map(url).collect()
    }

    /// The window as PNG, into a file.
    pub fn screenshot(&self, path: &Path, whole: bool) {
        let picture =
            self.devtools("Page.captureScreenshot", &json!({"format": "png", "captureBeyondViewport": whole}));
        std::fs::write(path, decoded(&picture["data"])).unwrap();
    }

    /// The page as it prints, as PDF.
    pub fn print(&self) -> Vec<u8> {
        let paper = json!({"background": true, "page": {"width": 21.0, "height": 29.7}, "margin": {"top": 1.2, "bottom": 1.2, "left": 1.2, "right": 1.2}});
        decoded(&self.ask("print", &paper))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() && !std::thread::panicking() {
            let _ = self.call("DELETE", &format!("/session/{}", self.session), &Value::Null);
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

fn decoded(base64: &Value) -> Vec<u8> {
    base64::engine::general_purpose::STANDARD.decode(base64.as_str().unwrap()).unwrap()
}
