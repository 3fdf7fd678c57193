//! See `abbe_fuzz::targets`.
#![no_main]

use abbe_fuzz::{begin::begin, targets::tool_poses};

libfuzzer_sys::fuzz_target!(init: begin("tool_poses", tool_poses), |bytes: &[u8]| {
    let _ = tool_poses(bytes);
});
