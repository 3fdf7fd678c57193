//! M428 and M429 with the generated module: no joint moves at the switch, and words mean what they say.

use crate::kins::Bench;
use crate::oracle::curves::Travel;
use crate::oracle::matrix::{minus, norm};
use crate::{Folder, abbe, script_json};
use serde_json::Value;

/// Largest way of a joint at a switch, mm or deg: what the forward kinematics leave.
const STILL: f64 = 1e-8;

/// Both orders of the types.
pub fn switching() {
    for first in [false, true] {
        judge(first);
    }
}

fn numbers(row: &Value) -> Vec<f64> {
    row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn judge(first: bool) {
    let bench = Bench::new("configs/trunnion.yaml", Some("A"));
    let folder = Folder::new("switching");
    let out = folder.0.join("out").display().to_string();
    let _ = abbe(&["--quiet", "compile", "configs/trunnion.yaml", "--target", "linuxcnc-kins", "--out", &out]);
    let arguments: Vec<&str> = if first { vec![&out, "--identity-first"] } else { vec![&out] };
    let result = script_json("switch.py", &arguments);
    let jumps = numbers(&result["jumps"]);
    let largest = jumps.iter().copied().fold(0.0, f64::max);
    println!("  identity first: {first}; {} switches move no joint by more than {largest:.1e}", jumps.len());
    assert!(jumps.len() == 2 + usize::from(first) && largest < STILL, "{jumps:?}");
    let states = result["states"].as_array().unwrap();
    let state = |what: &str| states.iter().find(|state| state["what"] == what).unwrap();
    let joints = |what: &str| numbers(&state(what)["joints"]);
    let tcp: Vec<bool> = states.iter().map(|state| state["tcp"].as_bool().unwrap()).collect();
    assert_eq!(tcp, [!first, true, false, false, true, true]);
    // Under identity the words are the joints, X Y Z A C.
    let position = numbers(&state("identity")["position"]);
    for (word, joint) in [0, 1, 2, 3, 5].into_iter().zip(joints("identity")) {
        assert!((position[word] - joint).abs() < 1e-9, "{position:?} {joint}");
    }
    let moved: Vec<f64> = joints("joint moved").iter().zip(joints("identity")).map(|(a, b)| a - b).collect();
    assert!(moved.iter().zip([-3.0, 0.0, 0.0, 0.0, 0.0]).all(|(m, wanted)| (m - wanted).abs() < 1e-8), "{moved:?}");
    // The real tip is at the pose before and after.
    for what in ["pose", "pose again"] {
        let [real, _] = bench.sample.holds(&bench.command(&state(what)["joints"]), Travel::Mean);
        assert!(norm(minus(real.tip, [100.0, 150.0, 100.0])) < crate::kins::TIP, "{what}: {real:?}");
    }
    assert!(result["refused"].as_f64().unwrap() < STILL && result["still_tcp"] == true, "{result}");
}
