//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::locks};

libfuzzer_sys::fuzz_target!(init: begin("locks", locks), |bytes: &[u8]| {
    let _ = locks(bytes);
});
