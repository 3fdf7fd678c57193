//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::imports};

libfuzzer_sys::fuzz_target!(init: begin("imports", imports), |bytes: &[u8]| {
    let _ = imports(bytes);
});
