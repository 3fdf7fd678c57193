//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::measurements};

libfuzzer_sys::fuzz_target!(init: begin("measurements", measurements), |bytes: &[u8]| {
    let _ = measurements(bytes);
});
