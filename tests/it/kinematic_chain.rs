//! The kinematic chain of `sinumerik-chain`: its elements, walked from the root as the manual has them, place tip and tool
//! axis where the oracle's machine has them; another chain is refused.

use std::collections::BTreeMap;
use std::path::Path;

use crate::kinematic_parameters::{
    OF_HEADS, OF_TABLES, compiled, head_head, head_table, longer, moved, table_table, with_spindle,
};
use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample};
use crate::oracle::matrix::{M4, ONE, V3, apply, exp, inverse, minus, mul, norm, plus, translation, turn, twist};
use crate::oracle::program::Folder;
use crate::support::config::sample;
use crate::support::{compile, config, left, number, verify};

/// An element of the control's chain.
#[derive(Debug, Default, Clone)]
struct Element {
    name: String,
    kind: String,
    next: String,
    parallel: String,
    vector: V3,
    axis: String,
}

/// The chain as the control has it after the program.
struct Chain {
    elements: Vec<Element>,
    /// `$NT_` by name and last index.
    transformation: BTreeMap<String, String>,
    orientation: V3,
}

/// The indices between the brackets of a variable.
fn indices(variable: &str) -> Vec<usize> {
    let inside = variable.split(['[', ']']).nth(1).unwrap();
    inside.split(',').map(|index| index.parse().unwrap()).collect()
}

impl Chain {
    fn of(file: &Path) -> Self {
        let text = std::fs::read_to_string(file).unwrap();
        let mut chain = Self { elements: vec![], transformation: BTreeMap::new(), orientation: [0.0; 3] };
        for line in text.lines().map(|line| line.split(';').next().unwrap().trim()) {
            let Some((variable, value)) = line.split_once('=') else {
                assert!(line.is_empty() || line == "M17", "{line}");
                continue;
            };
            chain.set(variable.split('[').next().unwrap(), &indices(variable), value);
        }
        chain
    }

    fn set(&mut self, variable: &str, at: &[usize], value: &str) {
        let word = value.trim_matches('"').to_owned();
        if let Some(name) = variable.strip_prefix("$NT_") {
            match name {
                "BASE_ORIENT" => self.orientation[at[1]] = value.parse().unwrap(),
                _ => {
                    let key = format!("{name}{}", at.get(1).map_or_else(String::new, usize::to_string));
                    assert!(self.transformation.insert(key, word).is_none(), "{variable} twice");
                }
            }
            return;
        }
        self.elements.resize(self.elements.len().max(at[0] + 1), Element::default());
        let element = &mut self.elements[at[0]];
        match variable {
            "$NK_NAME" => element.name = word,
            "$NK_TYPE" => element.kind = word,
            "$NK_NEXT" => element.next = word,
            "$NK_PARALLEL" => element.parallel = word,
            "$NK_OFF_DIR" => element.vector[at[1]] = value.parse().unwrap(),
            "$NK_AXIS" => element.axis = word,
            "$NK_A_OFF" => assert_eq!(word, "0"),
            other => panic!("{other}"),
        }
    }

    fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|element| !name.is_empty() && element.name == name)
    }

    /// The elements from one to another; a parallel element branches off before its own.
    fn path(&self, from: &str, to: &str) -> Option<Vec<&Element>> {
        let element = self.element(from)?;
        if from == to {
            return Some(vec![element]);
        }
        let behind = self.path(&element.next, to).map(|rest| [vec![element], rest].concat());
        behind.or_else(|| self.path(&element.parallel, to))
    }

    /// The output system of the last element of a partial chain.
    fn end(&self, last: &str, sample: &Sample, pose: &Pose) -> M4 {
        let path = self.path("ROOT", &self.transformation[last]).unwrap();
        path.iter().fold(ONE, |walk, element| mul(&walk, &element.motion(sample, pose)))
    }

    /// Tip (mm from the workpiece origin) and tool axis with the axes at a position.
    fn forward(&self, sample: &Sample, pose: &Pose) -> (V3, V3) {
        let part = self.end("P_CHAIN_LAST_ELEM", sample, pose);
        let walk = mul(&inverse(&part), &self.end("T_CHAIN_LAST_ELEM", sample, pose));
        let tool = self.orientation.map(|c| c / norm(self.orientation));
        let tip = apply(&walk, tool.map(|c| c * sample.rigid.offset[2]));
        (minus(plus(tip, sample.rigid.gauge), sample.rigid.workpiece_origin), turn(&walk, tool))
    }
}

impl Element {
    fn motion(&self, sample: &Sample, pose: &Pose) -> M4 {
        let by = |factor: f64| self.vector.map(|c| c * factor / norm(self.vector));
        let at = || {
            let name = self.axis.strip_suffix('1').unwrap();
            pose[sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap()]
        };
        match self.kind.as_str() {
            "OFFSET" => translation(self.vector),
            "AXIS_LIN" => translation(by(at())),
            "AXIS_ROT" => {
                let turn = by(at().to_radians());
                exp(&twist([0.0, 0.0, 0.0, turn[0], turn[1], turn[2]]))
            }
            other => panic!("{other}"),
        }
    }
}

/// Largest distances (mm, rad) of the control's tool from the real one over poses.
fn apart(chain: &Chain, sample: &Sample) -> (f64, f64) {
    left::poses(sample, 3, 200).iter().fold((0.0, 0.0), |(position, axis), pose| {
        let ([real, _], (tip, tool)) = (sample.holds(pose, Travel::Mean), chain.forward(sample, pose));
        (position.max(norm(minus(real.tip, tip))), axis.max(norm(minus(real.axis(), tool))))
    })
}

/// A table C alone; every linear axis carries the workpiece.
fn one_table(errors: &str) -> String {
    table_table(errors)
        .replace("w C' A' Y' b X Z (S) t", "w C' X' Y' Z' b (S) t")
        .replace("  A: { controller: 4, travel: [-120 deg, 30 deg], origin: [250, 225, -350] }\n", "")
}

#[test]
fn the_chain_is_the_real_machine() {
    let of_c = "  EX0C: 26 um\n  EY0C: -9 um\n  EA0C: -62 urad\n  EB0C: 44 urad\n";
    for (kind, text) in [
        ("table-table", table_table(&with_spindle(OF_TABLES))),
        ("head-head", head_head(&with_spindle(OF_HEADS))),
        ("head-table", head_table(&with_spindle(OF_HEADS))),
        ("table", one_table(&with_spindle(of_c))),
        (
            "head",
            head_head(&with_spindle(of_c)).replace("w Y' b X Z C B (S) t", "w b X Y Z C (S) t").replace(
                "  B: { controller: 4, travel: [-100 deg, 100 deg], direction: [0, 1, 1], origin: [12, 0, 260] }\n",
                "",
            ),
        ),
    ] {
        let folder = Folder::new();
        let (machine, out, json) = compiled(&folder, &text, "sinumerik-chain");
        let chain = Chain::of(&out.join("CHAIN.MPF"));
        let sample = sample(&machine);
        for sample in [&sample, &longer(&sample)] {
            let (position, axis) = apart(&chain, sample);
            // As of TRAORI: three offsets of six decimals, twice at half a turn; directions of nine decimals at a metre.
            assert!(position < 8e-6 && axis < 4e-9, "{kind}: {position:e} mm, {axis:e} rad");
        }
        assert!(json["errors"].as_object().unwrap().values().all(|error| error["handled"] == "fully"), "{json}");
        for way in json["programming"].as_array().unwrap().iter().filter(|way| way["tool_direction"] == "vector") {
            assert!(number(way, "/uncompensated/position_um/max") > 20.0, "{kind}: {way}");
            assert!(number(way, "/compensated/position_um/max") < 0.01, "{kind}: {way}");
        }
        for (key, axis) in [("GEO_AX_NAME0", "X"), ("GEO_AX_NAME1", "Y"), ("GEO_AX_NAME2", "Z")] {
            assert_eq!(chain.transformation[key], axis);
        }
        assert_eq!(chain.transformation["TRAFO_TYPE"], "TRAORI_DYN");
        assert_eq!(verify(&machine, &out, &["--poses", "300"]).json()["compensated"], json["compensated"]);
    }
}

/// Both sets hold the same lines: so do the certificates.
#[test]
fn chain_and_machine_data_are_certified_alike() {
    let folder = Folder::new();
    let ways = ["sinumerik-chain", "sinumerik-traori"].map(|target| {
        compile(&config("trunnion.yaml"), target, &folder.path(target), &["--accept-unverified", "--poses", "100"])
            .json()["programming"]
            .clone()
    });
    assert_eq!(ways[0], ways[1]);
}

#[test]
fn another_chain_is_refused() {
    let folder = Folder::new();
    let (machine, out, _) = compiled(&folder, &table_table(OF_TABLES), "sinumerik-chain");
    let file = out.join("CHAIN.MPF");
    let good = std::fs::read_to_string(&file).unwrap();
    for (from, to, says) in [
        ("$NK_NEXT[0]=\"X\"", "$NK_NEXT[0]=\"Y\"", "this machine has `$NK_NEXT[0]=\"X\"` here"),
        ("$NK_TYPE[5]=\"AXIS_ROT\"\n", "", "the line `$NK_TYPE[5]=\"AXIS_ROT\"` is missing"),
        ("$NT_ROT_AX_NAME[1,1]=\"C\"\n", "", "the line `$NT_ROT_AX_NAME[1,1]=\"C\"` is missing"),
        ("$NK_OFF_DIR[3,1]=-1", "$NK_OFF_DIR[3,1]=1", "this machine has `$NK_OFF_DIR[3,1]=-1` here"),
        ("$NK_OFF_DIR[8,0]=-", "$NK_OFF_DIR[8,0]=", "does not close"),
        ("$NK_OFF_DIR[8,0]", "$NK_OFF_DIR[9,0]", "no parameter of this machine"),
        ("M17\n", "M18\n", "there is no line `M17`"),
    ] {
        assert!(good.contains(from), "{from}");
        std::fs::write(&file, good.replacen(from, to, 1)).unwrap();
        let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704").says(says);
    }
    // Names of axes are the control's.
    std::fs::write(&file, good.replace("$NK_AXIS[5]=\"A1\"", "$NK_AXIS[5]=\"TILT\"")).unwrap();
    assert_eq!(verify(&machine, &out, &["--poses", "20"]).code, Some(0));
}

/// The test that the manifest prints, carried out in the replay.
#[test]
fn sign_test_of_the_chain_as_printed() {
    let near = |found: V3, wanted: V3| assert!(norm(minus(found, wanted)) < 2e-4, "{found:?}, wanted {wanted:?}");
    let text = table_table("");
    let half = [("C", 180.0), ("X", 200.0), ("Y", 100.0), ("Z", -100.0)];
    let changes = [("NK_OFF_DIR[6,0]", -0.1), ("NK_OFF_DIR[8,0]", 0.1)];
    near(moved(&text, "sinumerik-chain", "CHAIN.MPF", &changes, &half[1..]), [0.0; 3]);
    near(moved(&text, "sinumerik-chain", "CHAIN.MPF", &changes, &half), [-0.2, 0.0, 0.0]);
    let above = [("C", 180.0), ("X", 240.0), ("Y", 205.0), ("Z", -190.0)];
    near(moved(&text, "sinumerik-chain", "CHAIN.MPF", &[("NK_OFF_DIR[7,0]", 0.001)], &above), [-0.2, 0.0, 0.0]);
}
