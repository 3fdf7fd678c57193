//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::manifests};

libfuzzer_sys::fuzz_target!(init: begin("manifests", manifests), |bytes: &[u8]| {
    let _ = manifests(bytes);
});
