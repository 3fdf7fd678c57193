//! See `abbe_fuzz::targets`.
#![no_main]

libfuzzer_sys::fuzz_target!(
    init: abbe_fuzz::seeds::begin("machine_files"),
    |bytes: &[u8]| abbe_fuzz::targets::machine_files(bytes)
);
