//! The loop closed in the running controller (tests/linuxcnc/loop.py): a machine whose errors nobody tells the program.

use crate::script_json;

/// One seed, one topology; `tests/soak closed_loop` runs the others.
pub fn table_table() {
    let result = script_json("loop.py", &[env!("CARGO_BIN_EXE_abbe"), "--machine", "table-table", "--seed", "1"]);
    let judged = &result["judged"];
    println!(
        "  other balls, ideal probe: {} um before, {} um after, {} um foretold; seconds {}",
        judged["rms_before_um"], judged["rms_um"], result["foretold_centre_um"], result["seconds"]
    );
}
