//! Files in the forms that a control's own archive has them: the same numbers, found by their content, with what is not
//! verified said.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::oracle::program::Folder;
use crate::replays;
use crate::support::{Run, abbe, compile, verify};

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "20"];

/// A tilting table: the machine of kinematic parameters.
fn tilting(folder: &Folder) -> PathBuf {
    folder.write(
        "tilting.yaml",
        "abbe: 1\nmachine: tilting\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: { controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }\n  Y: { controller: 2, travel: [-150 mm, 150 mm], origin: [0, 0, 0] }\n  \
         Z: { controller: 3, travel: [-300 mm, 0 mm], origin: [0, 0, 0] }\n  A: { controller: 4, travel: [-90 deg, 30 deg], sense: direct, origin: [1, 2, -50] }\n  C: { controller: 5, travel: continuous, sense: direct, origin: [3, 4, -80] }\nerrors:\n  EX0C: 20 um\n  EY0A: -15 um\n",
    )
}

/// A set, and the folder for an archive of it.
fn set(folder: &Folder, target: &str) -> (PathBuf, PathBuf, PathBuf, Value) {
    let tables = ["sinumerik-cec", "sinumerik-enc", "fanuc-pitch"].contains(&target);
    let machine = if tables { replays::machine(folder, true) } else { tilting(folder) };
    let (out, found) = (folder.path(&format!("{target}-out")), folder.path(&format!("{target}-found")));
    compile(&machine, target, &out, &FEW).json();
    std::fs::create_dir_all(&found).unwrap();
    let sound = verify(&machine, &out, &["--poses", "20"]).json();
    (machine, out, found, sound)
}

fn read(machine: &Path, found: &Path, sound: &Value) -> Run {
    let run = verify(machine, found, &["--poses", "20"]);
    let json = run.json();
    assert_eq!((&json["target"], &json["compensated"]), (&sound["target"], &sound["compensated"]), "{}", run.err);
    run
}

/// Any check word: nobody knows how they are computed.
fn checked(line: &str) -> String {
    let sum = line.bytes().fold(7_u32, |sum, byte| (sum * 31 + u32::from(byte)) % 65_536);
    if line.starts_with('$') { format!("{line} '{sum:04x}") } else { line.to_owned() }
}

fn without_comment(line: &str) -> &str {
    line.split(';').next().unwrap().trim_end()
}

#[test]
fn sinumerik_archives_with_check_words() {
    let folder = Folder::new();
    for (target, file, name) in [
        ("sinumerik-cec", "_N_NC_CEC_INI", "nc_cec.ini"),
        ("sinumerik-chain", "CHAIN.MPF", "kin.ini"),
        ("sinumerik-tcarr", "TCARR.MPF", "to_ini.ini"),
        ("sinumerik-traori", "TRAORI.INI", "ch1_tea.ini"),
    ] {
        let (machine, out, found, sound) = set(&folder, target);
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        let lines: Vec<String> = text.lines().map(without_comment).map(checked).collect();
        std::fs::write(found.join(name), lines.join("\n")).unwrap();
        read(&machine, &found, &sound).says("W0716").says("not verified");
        // A word that is none is no check word.
        std::fs::write(found.join(name), lines.join("\n").replacen(" '", " '0", 1)).unwrap();
        assert_ne!(verify(&machine, &found, &["--target", target]).code, Some(0), "{target}");
    }
}

#[test]
fn machine_data_of_a_channel() {
    let folder = Folder::new();
    let (machine, out, found, sound) = set(&folder, "sinumerik-traori");
    let text = std::fs::read_to_string(out.join("TRAORI.INI")).unwrap();
    let own: Vec<String> =
        text.lines().map(without_comment).filter(|line| line.starts_with('$')).map(|l| format!("N24550 {l}")).collect();
    let tea = |more: &str| {
        let text = format!(
            "%_N_CH1_TEA_INI\nCHANDATA(1)\nN20050 $MC_AXCONF_GEOAX_ASSIGN_TAB[0]=1\nN24100 $MC_TRAFO_TYPE_1=24\n{}\n\
             N24558 $MC_TRAFO5_JOINT_OFFSET_PART_1[0]=0\n{more}\nM17\n",
            own.join("\n")
        );
        std::fs::write(found.join("ch1.tea"), text).unwrap();
    };
    tea("N24510 $MC_TRAFO5_ROT_AX_OFFSET_1[0]=0\nN24520 $MC_TRAFO5_ROT_SIGN_IS_PLUS_1[0]=TRUE");
    read(&machine, &found, &sound);
    // The archive is a door for `locate` and `--installed` too.
    let located = Run::of(abbe().args(["locate", "--format", "json"]).arg(&machine).arg(&found)).json();
    let error = |name: &str| {
        let all = located["errors"].as_array().unwrap();
        all.iter().find(|e| e["name"] == name).unwrap()["found"].as_f64().unwrap()
    };
    assert!((error("EX0C") - 20.0).abs() < 1e-2 && (error("EY0A") + 15.0).abs() < 1e-2, "{located}");
    let more = [&FEW[..], &["--installed", found.to_str().unwrap()]].concat();
    compile(&machine, "sinumerik-traori", &folder.path("new"), &more).json();
    for (more, words) in [
        ("N24520 $MC_TRAFO5_ROT_SIGN_IS_PLUS_1[0]=0", "would mean something else"),
        ("N24510 $MC_TRAFO5_ROT_AX_OFFSET_1[1]=90", "would mean something else"),
        ("N24558 $MC_TRAFO5_JOINT_OFFSET_PART_1[1]=3", "is no parameter of this machine"),
    ] {
        tea(more);
        verify(&machine, &found, &["--target", "sinumerik-traori"]).refused("E0704").says(words);
    }
}

/// K3 p. 242: one file of all axes.
#[test]
fn encoder_errors_of_all_axes_in_one_file() {
    let folder = Folder::new();
    let (machine, out, found, sound) = set(&folder, "sinumerik-enc");
    let mut all = vec!["%_N_AX_EEC_INI".to_owned(), "CHANDATA(1)".to_owned()];
    for n in 1..=4 {
        let Ok(text) = std::fs::read_to_string(out.join(format!("_N_AX{n}_EEC_INI"))) else { continue };
        all.extend(text.lines().filter(|line| line.starts_with('$')).map(str::to_owned));
    }
    all.push("M17".to_owned());
    std::fs::write(found.join("eec.ini"), all.join("\n")).unwrap();
    read(&machine, &found, &sound);
}

/// One punch of all parameters and axes, with the path `L1` and without; without `Q`, with blanks.
#[test]
fn fanuc_punches() {
    let folder = Folder::new();
    let (machine, out, found, sound) = set(&folder, "fanuc-pitch");
    let mut parameters: std::collections::BTreeMap<String, Vec<String>> = Default::default();
    let mut data = Vec::new();
    for letter in ["X", "Y", "Z", "C"] {
        let Ok(text) = std::fs::read_to_string(out.join(format!("PITCH_{letter}.TXT"))) else { continue };
        for line in text.lines().filter(|line| line.starts_with('N')) {
            match line.split_once("Q1") {
                Some((number, words)) => parameters.entry(number.to_owned()).or_default().push(words.to_owned()),
                None => data.push(line.to_owned()),
            }
        }
    }
    let lines: Vec<String> = parameters.iter().map(|(n, axes)| format!("{n}Q1{}", axes.concat())).collect();
    let punch = |path: &str| {
        format!("%\nN00000Q1{path}P00000010\nN01825Q1A1P3000A2P3000\n{}\n{}\n%\n", lines.join("\n"), data.join("\n"))
    };
    let spaced = punch("L1").replace("Q1", " ").replace("Q0", " ").replace('P', "P ").replace("L1", "");
    for text in [punch("L1"), punch(""), spaced, punch("L1").replace('\n', "\n\r\r")] {
        std::fs::write(found.join("CNC-PARA.TXT"), &text).unwrap();
        read(&machine, &found, &sound);
    }
    let (machine, out, found, sound) = set(&folder, "fanuc-5axis");
    let text = std::fs::read_to_string(out.join("TCP.PRM")).unwrap();
    for path in ["", "L1"] {
        let own =
            text.replace("Q1M", &format!("Q1{path}M")).replacen('%', "%\nN00000Q1L1P00000010\nN01825Q1A1P3000", 1);
        std::fs::write(found.join("CNC-PARA.TXT"), own).unwrap();
        read(&machine, &found, &sound);
    }
}
