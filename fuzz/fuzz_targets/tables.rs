//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::tables};

libfuzzer_sys::fuzz_target!(init: begin("tables", tables), |bytes: &[u8]| {
    let _ = tables(bytes);
});
