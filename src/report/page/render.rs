//! Template, data and pictures to the appendices of a report.

use super::bench::{BenchPage, EngineFile};
use super::data::PageData;
use crate::report::pictures::escape;
use crate::run::sha256;
use crate::units::significant;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use minijinja::value::{Kwargs, Serde as ViaSerde};
use minijinja::{AutoEscape, Environment, UndefinedBehavior, Value, context};
use miniz_oxide::deflate::compress_to_vec_zlib;
use serde::Serialize;
use serde_json::json;

const TEMPLATE: &str = include_str!("appendices.html.j2");
const STYLE: &str = include_str!("appendices.css");
const VIEW: &str = include_str!("view.js");
const SCRIPT: &str = include_str!("appendices.js");

/// A machine's pictures, as SVG text.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Pictures {
    /// The kinematic chain.
    pub chain: String,
    /// Curves of the component errors, an axis each.
    pub curves: Vec<(String, String)>,
    /// Planes: a heading, and pictures side by side.
    pub planes: Vec<(String, Vec<String>)>,
    /// The errors with the largest effect, largest first; empty without errors.
    pub pareto: String,
    /// Profiles of round features; empty without.
    pub round: String,
    /// Ball bar, R-test and diagonals; empty where there are none.
    pub instruments: [String; 3],
    /// Pareto chart and waterfall of the budget, if there is one.
    pub budget: Vec<String>,
}

/// Content to be rendered.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// All numbers of the appendices.
    pub data: &'a PageData,
    /// The same for each machine.
    pub pictures: &'a [Pictures],
    /// Content with which the workbench starts.
    pub start: &'a serde_json::Value,
    /// The library as WebAssembly; none for a page that only shows.
    pub engines: &'a [EngineFile],
}

impl Page<'_> {
    /// Returns the page; fails if the data cannot be written as JSON or the template does not render.
    pub fn html(&self) -> Result<RenderedPage, PageFailure> {
        let data = pack(self.data).map_err(PageFailure::Data)?;
        let start = pack(self.start).map_err(PageFailure::Data)?;
        let start = json!({"evaluator": "report", "zlib": start}).to_string();
        // Another one for other content; it only tells the page's style from that of its text, which is escaped.
        let nonce = sha256(format!("{data}{start}").as_bytes());
        let appendices = self.appendices(&data, &nonce).map_err(PageFailure::Template)?;
        let script = format!("{VIEW}{SCRIPT}");
        let (start, nonce, appendices, script) = (&start, &nonce, &appendices, &script);
        let page = BenchPage { start, nonce, is_served: false, engines: self.engines, appendices, script };
        let engines = &self.engines[..page.fitting()];
        let variants = engines.iter().map(|engine| engine.variant.clone()).collect();
        Ok(RenderedPage { text: BenchPage { engines, ..page }.html(), variants })
    }

    fn appendices(&self, packed: &str, nonce: &str) -> Result<String, minijinja::Error> {
        let page = context! {
            data => Value::from(ViaSerde(self.data)), pictures => Value::from(ViaSerde(self.pictures)), packed,
            style => STYLE, nonce,
        };
        let mut environment = environment()?;
        environment.add_function("number", number);
        environment.template_from_str(TEMPLATE)?.render(page)
    }
}

/// A rendered page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RenderedPage {
    /// All of it.
    pub text: String,
    /// Variants of the engine in it.
    pub variants: Vec<String>,
}

/// Reason why a page cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum PageFailure {
    /// The data have no JSON.
    #[error(transparent)]
    Data(serde_json::Error),
    /// The template does not render.
    #[error("{0:#}")]
    Template(minijinja::Error),
}

/// Compression of the data: a level above takes longer and saves nothing.
const LEVEL: u8 = 9;

/// Returns JSON as the page holds it, compressed by zlib in base64: no markup is in it.
fn pack(data: &impl Serialize) -> serde_json::Result<String> {
    let json = serde_json::to_vec(data)?;
    Ok(BASE64.encode(compress_to_vec_zlib(&json, LEVEL)))
}

/// Returns an environment of templates in which text is escaped for HTML and XML.
pub(crate) fn environment() -> Result<Environment<'static>, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let syntax = minijinja::syntax::SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?;
    environment.set_syntax(syntax);
    environment.add_filter("digits", digits);
    Ok(environment)
}

/// A number with at most so many significant digits and a real minus; a dash if there is none.
fn digits(value: Value, digits: usize) -> Result<String, minijinja::Error> {
    if value.is_undefined() || value.is_none() {
        return Ok("–".to_owned());
    }
    Ok(significant(f64::try_from(value)?, digits).replace('-', "−"))
}

/// A number of the data with the JSON pointer to it: `number(data, "/machines/0/poses", digits=4)`; with two decimals
/// by default. The pointer stays in the page, so that the shown number can be compared with the data. A dash if there
/// is nothing.
fn number(data: Value, pointer: String, options: Kwargs) -> Result<Value, minijinja::Error> {
    let digits: Option<usize> = options.get("digits")?;
    let sign: Option<bool> = options.get("sign")?;
    options.assert_all_used()?;
    let mut value = data;
    for part in pointer.split('/').skip(1) {
        value = match part.parse::<usize>() {
            Ok(index) => value.get_item_by_index(index)?,
            Err(_) => value.get_attr(part)?,
        };
    }
    if value.is_undefined() || value.is_none() {
        return Ok(Value::from_safe_string("–".to_owned()));
    }
    let number = f64::try_from(value)?;
    let text = number_text(number, digits);
    let zero = !text.contains(|c: char| ('1'..='9').contains(&c));
    let plus = if sign == Some(true) && number > 0.0 && !zero { "+" } else { "" };
    let kept = digits.map_or(String::new(), |digits| format!(r#" data-digits="{digits}""#));
    Ok(Value::from_safe_string(format!(r#"<span class="n" data-at="{}"{kept}>{plus}{text}</span>"#, escape(&pointer))))
}

/// Formats a value with `digits` significant digits, or two decimals; with a real minus, and without noise far below
/// any measurement.
fn number_text(value: f64, digits: Option<usize>) -> String {
    let value = if value.abs() < 5e-10 { 0.0 } else { value };
    let text = digits.map_or_else(|| format!("{value:.2}"), |digits| significant(value, digits));
    if text == "-0.00" { "0.00".to_owned() } else { text.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_data_hold_no_markup_and_come_back_whole() {
        let data = serde_json::json!({"name": "</script><!--\u{2028}&", "value": -0.1});
        let text = pack(&data).unwrap();
        assert!(text.chars().all(|c| c.is_ascii_alphanumeric() || "+/=".contains(c)), "{text}");
        let bytes = miniz_oxide::inflate::decompress_to_vec_zlib(&BASE64.decode(text).unwrap()).unwrap();
        assert_eq!(serde_json::from_slice::<serde_json::Value>(&bytes).unwrap(), data);
    }

    #[test]
    fn numbers_carry_the_place_they_come_from() {
        let data = Value::from(ViaSerde(serde_json::json!({"list": [{"x": -12.3456}]})));
        let options = Kwargs::from_iter([("digits", Value::from(3))]);
        let text = number(data, "/list/0/x".to_owned(), options).unwrap().to_string();
        assert_eq!(text, r#"<span class="n" data-at="/list/0/x" data-digits="3">−12.3</span>"#);
    }
}
