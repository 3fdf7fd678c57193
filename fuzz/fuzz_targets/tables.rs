//! See `abbe_fuzz::targets`.
#![no_main]

libfuzzer_sys::fuzz_target!(
    init: abbe_fuzz::seeds::begin("tables"),
    |bytes: &[u8]| abbe_fuzz::targets::tables(bytes)
);
