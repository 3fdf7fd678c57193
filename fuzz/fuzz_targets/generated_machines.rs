//! See `abbe_fuzz::targets`.
#![no_main]

libfuzzer_sys::fuzz_target!(
    init: abbe_fuzz::seeds::begin("generated_machines"),
    |bytes: &[u8]| abbe_fuzz::targets::generated_machines(bytes)
);
