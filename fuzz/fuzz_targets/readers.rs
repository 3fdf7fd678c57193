//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::readers};

libfuzzer_sys::fuzz_target!(init: begin("readers", readers), |bytes: &[u8]| {
    let _ = readers(bytes);
});
