//! The page of the workbench, built from `web/` (docs/workbench.md): served by the program, or in a file with a report.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest, Sha256};

const PAGE: &str = include_str!("workbench.html");

/// The library as WebAssembly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EngineFile {
    /// The variant: `plain`, or `relaxed` with relaxed SIMD.
    pub variant: String,
    /// The module, compressed by gzip.
    pub gzip: Vec<u8>,
}

/// Size of a page, bytes, that further variants of the engine may not exceed: it goes by mail.
const LARGE_PAGE: usize = 5_000_000;

/// Content of the page. The default has none.
#[derive(Debug, Clone, Default)]
pub struct BenchPage<'a> {
    /// JSON that its script starts with; no markup is in it.
    pub start: &'a str,
    /// The nonce of its style, without markup.
    pub nonce: &'a str,
    /// True if it may ask the server that it comes from.
    pub is_served: bool,
    /// The library for a page that answers by itself.
    pub engines: &'a [EngineFile],
    /// Markup below the workbench.
    pub appendices: &'a str,
    /// Script of this markup.
    pub script: &'a str,
}

impl BenchPage<'_> {
    /// Returns the page.
    pub fn html(&self) -> String {
        let policy = self.policy();
        let tail = self.tail();
        let parts = [
            ("@POLICY@", policy.as_str()),
            ("@NONCE@", self.nonce),
            ("@APPENDICES@", self.appendices),
            ("@START@", self.start),
            ("@TAIL@", tail.as_str()),
        ];
        let mut page = String::with_capacity(PAGE.len() + self.appendices.len() + self.start.len() + tail.len());
        let mut rest = PAGE;
        // In the order of the page: what is put in is not looked at again.
        for (mark, content) in parts {
            let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
            page.push_str(before);
            page.push_str(content);
            rest = after;
        }
        page.push_str(rest);
        page
    }

    /// Returns the number of the first engines that a page holds: one at least, and more while the page stays small.
    pub fn fitting(&self) -> usize {
        let own = PAGE.len() + self.appendices.len() + self.start.len() + self.script.len();
        let sizes = self.engines.iter().scan(own, |size, engine| {
            *size += engine.gzip.len().div_ceil(3) * 4 + 100;
            Some(*size)
        });
        sizes.enumerate().take_while(|(i, size)| *i == 0 || *size < LARGE_PAGE).count()
    }

    /// Scripts by hash, styles by nonce, WebAssembly in a worker where the page has an engine, and nothing else.
    fn policy(&self) -> String {
        let bundle = PAGE.split_once("<script>").and_then(|(_, rest)| rest.split_once("</script>"));
        let mut scripts = source_hash(bundle.map_or("", |(script, _)| script));
        if !self.script.is_empty() {
            scripts = format!("{scripts} {}", source_hash(self.script));
        }
        let engine = if self.engines.is_empty() { "" } else { " 'wasm-unsafe-eval'; worker-src blob:" };
        let connect = if self.is_served { "'self'" } else { "'none'" };
        format!(
            "default-src 'none'; script-src {scripts}{engine}; style-src 'nonce-{}'; connect-src {connect}; \
             img-src data:; base-uri 'none'; form-action 'none'",
            self.nonce
        )
    }

    /// The script of the appendices, and the engines last: the page is seen before they are read.
    fn tail(&self) -> String {
        let script = if self.script.is_empty() { String::new() } else { format!("<script>{}</script>\n", self.script) };
        let engine = |file: &EngineFile| {
            let (variant, text) = (&file.variant, BASE64.encode(&file.gzip));
            format!("<script type=\"application/gzip;base64\" id=\"engine-{variant}\">{text}</script>\n")
        };
        script + &self.engines.iter().map(engine).collect::<String>()
    }
}

/// Returns the source of a style or script in a content security policy.
pub(crate) fn source_hash(text: &str) -> String {
    format!("'sha256-{}'", BASE64.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_each_mark_once_in_order_and_its_script_none() {
        let marks = ["@POLICY@", "@NONCE@", "@APPENDICES@", "@START@", "@TAIL@"];
        let places: Vec<usize> = marks.iter().map(|mark| PAGE.find(mark).unwrap()).collect();
        assert!(places.is_sorted(), "{places:?}");
        assert!(marks.iter().all(|mark| PAGE.matches(mark).count() == 1));
        assert!(PAGE.split("<style").nth(1).unwrap().starts_with(" nonce=\"@NONCE@\">"));
        let page = BenchPage { start: "@TAIL@", appendices: "@START@", nonce: "n", ..BenchPage::default() }.html();
        assert!(page.contains("id=\"start\">@TAIL@</script>") && page.contains("@START@"), "content is not filled in");
    }

    #[test]
    fn webassembly_runs_only_in_a_page_with_an_engine() {
        let page = |engines| BenchPage { engines, nonce: "n", ..BenchPage::default() }.html();
        let engine = EngineFile { variant: "plain".to_owned(), gzip: vec![1, 2, 3] };
        let policy = |engines| BenchPage { engines, nonce: "n", ..BenchPage::default() }.policy();
        assert!(!policy(&[]).contains("wasm") && page(&[]).contains(&policy(&[])));
        let with = page(std::slice::from_ref(&engine));
        assert!(with.contains("'wasm-unsafe-eval'; worker-src blob:") && with.contains("id=\"engine-plain\">AQID<"));
        assert!(with.contains("connect-src 'none'"));
        let sizes = |sizes: &[usize]| {
            let of = |size: &usize| EngineFile { variant: String::new(), gzip: vec![0; *size] };
            let engines: Vec<EngineFile> = sizes.iter().map(of).collect();
            BenchPage { engines: &engines, ..BenchPage::default() }.fitting()
        };
        assert_eq!([sizes(&[]), sizes(&[9_000_000]), sizes(&[900_000, 900_000])], [0, 1, 2]);
        assert_eq!(sizes(&[900_000, 9_000_000, 10]), 1);
    }
}
