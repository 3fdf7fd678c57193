//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::generated_machines};

libfuzzer_sys::fuzz_target!(init: begin("generated_machines", generated_machines), |bytes: &[u8]| {
    let _ = generated_machines(bytes);
});
