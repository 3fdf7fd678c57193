//! What a report holds compressed: the data of its appendices, and what the workbench starts with.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::Value;

/// Returns the content of an element of a page.
pub fn element<'a>(page: &'a str, id: &str) -> &'a str {
    page.split_once(&format!("id=\"{id}\">")).unwrap().1.split_once("</script>").unwrap().0
}

/// Returns the data of the appendices.
pub fn data(page: &str) -> Value {
    serde_json::from_str(&unpacked(element(page, "data"))).unwrap()
}

/// Returns text that was compressed by zlib, from base64.
pub fn unpacked(base64: &str) -> String {
    let bytes = miniz_oxide::inflate::decompress_to_vec_zlib(&BASE64.decode(base64).unwrap()).unwrap();
    String::from_utf8(bytes).unwrap()
}
