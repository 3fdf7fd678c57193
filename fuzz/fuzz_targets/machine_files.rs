//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::machine_files};

libfuzzer_sys::fuzz_target!(init: begin("machine_files", machine_files), |bytes: &[u8]| {
    let _ = machine_files(bytes);
});
