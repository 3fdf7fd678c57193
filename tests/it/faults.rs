//! Tables with a fault in their filling: their certificates must show it. Single errors rest on the number of poses
//! that they state.

use abbe::compensation::{CorrectionTable, CorrectionTables, LatticeRequest, Scope};
use abbe::controller::{Certificate, ControllerTarget, TablesUnderTest, certify};
use abbe::machine::{Approach, Machine};
use std::path::{Path, PathBuf};

use crate::oracle::program::Folder;
use crate::support::{compile, config, number};

fn filled(machine: &Machine, target: &ControllerTarget) -> CorrectionTables {
    let axes = (0..machine.axes().len()).collect();
    target.tables(machine, &LatticeRequest { axes, max_nodes: 4000, scope: Scope::POSITION })
}

fn certified(machine: &Machine, target: &ControllerTarget, tables: &CorrectionTables) -> Certificate {
    certify(machine, TablesUnderTest { target, tables, installed: None }, Scope::POSITION, 300, 1)
}

/// Three linear axes and an endless table.
fn with_table(folder: &Folder, name: &str, errors: &str) -> PathBuf {
    let axes = [("X", 1), ("Y", 2), ("Z", 3)]
        .map(|(name, number)| format!("  {name}: {{ controller: {number}, travel: [0 mm, 200 mm] }}\n"))
        .concat();
    let text = format!(
        "abbe: 1\nmachine: example\nchain: \"w C' b X Y Z t\"\naxes:\n{axes}  C: {{ controller: 4, travel: continuous }}\nerrors:\n  {errors}\n\
         volume: {{ step: 50 mm, C: {{ step: 15 deg }} }}\n"
    );
    folder.write(name, &text)
}

/// The compiled evaluator once took cubic B-splines of continuous axes for straight pieces, and the certificate with
/// it.
#[test]
fn straight_pieces_in_place_of_a_spline() {
    const KNOTS: [f64; 6] = [0.0, 40.0, 100.0, 210.0, 280.0, 360.0];
    let folder = Folder::new();
    let spline = "ECC: { bspline: { knots: [0 deg, 40 deg, 100 deg, 210 deg, 280 deg, 360 deg], \
                  coefficients: [0 urad, 60 urad, -40 urad, 50 urad, -60 urad] } }";
    let machine = crate::loaded::machine(&with_table(&folder, "spline.yaml", spline));
    let c = machine.axis_index("C").unwrap();
    let at = |q: f64| machine.component_values(c, &Approach::Mean.at_position(q))[5];
    let points = KNOTS.map(|q| format!("[{q} deg, {:.12} urad]", at(q) * 1e6)).join(", ");
    let straight =
        crate::loaded::machine(&with_table(&folder, "straight.yaml", &format!("ECC: {{ points: [{points}] }}")));
    for name in ["linuxcnc", "grid-csv"] {
        let target = ControllerTarget::builtin(name).unwrap();
        let good = certified(&machine, &target, &filled(&machine, &target)).compensated.position_um;
        let bad = certified(&machine, &target, &filled(&straight, &target)).compensated.position_um;
        assert!(bad.rms > 2.0 * good.rms && bad.max > 1.0, "{name}: {} um, {} um with the fault", good.rms, bad.rms);
    }
}

/// Every kind of table, halved: each certificate is the worse for it.
#[test]
fn a_fault_in_each_kind_of_table_shows() {
    let machine = crate::loaded::machine(&config("vmc-cframe-754.yaml"));
    type Kind = (&'static str, &'static str, fn(&CorrectionTable) -> bool);
    let kinds: [Kind; 6] = [
        ("linuxcnc", "own axis", CorrectionTable::is_own_axis),
        ("sinumerik-cec", "own axis", CorrectionTable::is_own_axis),
        ("sinumerik-cec", "cross axis", |table| table.axes.len() == 1 && !table.is_own_axis()),
        ("sinumerik-cec", "product", |table| table.axes.len() == 2),
        ("twincat-axis", "plane", |table| table.axes.len() == 2),
        ("grid-csv", "lattice", |table| table.axes.len() == 3),
    ];
    for (name, kind, is_kind) in kinds {
        let target = ControllerTarget::builtin(name).unwrap();
        let tables = filled(&machine, &target);
        assert!(tables.tables.iter().any(is_kind), "{name} has no {kind}");
        let mut faulty = tables.clone();
        for table in faulty.tables.iter_mut().filter(|table| is_kind(table)) {
            let columns = std::iter::once(&mut table.values).chain(&mut table.reverse);
            columns.flatten().for_each(|value| *value *= 0.5);
        }
        let rms = |tables: &CorrectionTables| certified(&machine, &target, tables).compensated.position_um.rms;
        let (good, bad) = (rms(&tables), rms(&faulty));
        assert!(bad > 1.02 * good, "{name}, {kind}: {good} um, {bad} um with the fault");
    }
    let target = ControllerTarget::builtin("isg-volcomp").unwrap();
    let mut tables = filled(&machine, &target);
    let good = certified(&machine, &target, &tables).compensated.position_um.rms;
    tables.errors.iter_mut().flat_map(|curve| &mut curve.values).for_each(|value| *value *= 0.5);
    let bad = certified(&machine, &target, &tables).compensated.position_um.rms;
    assert!(bad > 1.5 * good, "isg-volcomp: {good} um, {bad} um with the fault");
}

/// Three axes whose slides turn about points of their own.
fn with_points(folder: &Folder) -> PathBuf {
    let text = "abbe: 1\nmachine: example\nchain: \"w X' b Y Z t\"\naxes:\n  X: { controller: 1, travel: [0 mm, 500 mm], origin: [100, 0, 200] }\n  \
         Y: { controller: 2, travel: [0 mm, 400 mm], origin: [0, 300, -500] }\n  Z: { controller: 3, travel: [-300 mm, 0 mm], origin: [0, 0, 0] }\nerrors:\n  \
         EAX: { points: [[0 mm, 10 urad], [500 mm, 30 urad]] }\n  ECX: { points: [[0 mm, -20 urad], [500 mm, 20 urad]] }\n  \
         EBY: { points: [[0 mm, 0 urad], [400 mm, 40 urad]] }\n";
    folder.write("machine.yaml", text)
}

/// EAX about z = 200 is one about 0 and -(10e-6, 0, 0) x (100, 0, 200) = +2 um in Y; ECX of -20 urad about x = 100
/// brings +2 um more. EBY about z = -500 is one about 0 and +20 um in X at its end, and nothing in Z.
#[test]
fn files_without_points_of_linear_axes_hold_all_of_their_errors() {
    let folder = Folder::new();
    let machine = with_points(&folder);
    for target in ["isg-volcomp", "etalon-exchange"] {
        let json = compile(&machine, target, &folder.path(target), &["--poses", "300"]).json();
        assert!(number(&json, "/uncompensated/position_um/max") > 10.0, "{json}");
        // Second order is below a nanometre.
        assert!(number(&json, "/compensated/position_um/max") < 1e-2, "{target}: {json}");
        for error in ["EAX", "ECX", "EBY"] {
            assert_eq!(json["errors"][error]["handled"], "fully", "{target}: {json}");
        }
    }
    let csv = std::fs::read_to_string(folder.path("isg-volcomp/volcomp.csv")).unwrap();
    let row = |header: &str, position: &str| -> Vec<f64> {
        let mut lines = csv.lines().skip_while(|line| *line != header);
        let line = lines.find(|line| line.starts_with(position)).unwrap_or_else(|| panic!("{header}: {csv}"));
        line.split_whitespace().map(|cell| cell.parse().unwrap()).collect()
    };
    let first = row("X EYX EAX ECX", "0.000000 ");
    let expected = [0.0, 0.004, 10e-6, -20e-6];
    assert!(first.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{first:?}");
    let last = row("Y EXY EBY", "400.000000 ");
    let expected = [400.0, 0.02, 40e-6];
    assert!(last.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{last:?}");
}

#[test]
fn the_poses_of_single_errors_are_stated() {
    let folder = Folder::new();
    let poses = |machine: &Path, target: &str, count: &str| {
        let json = compile(machine, target, &folder.path(target), &["--poses", count, "--replace"]).json();
        json["single_error_poses"].as_u64().unwrap()
    };
    let machine = with_points(&folder);
    assert_eq!(poses(&machine, "linuxcnc", "300"), 300);
    assert_eq!(poses(&machine, "linuxcnc", "2100"), 2000);
    assert_eq!(poses(&machine, "grid-csv", "300"), 300);
    // Cells of five axes have 32 nodes each.
    let share = poses(&config("trunnion.yaml"), "grid-csv", "700");
    assert!((512..700).contains(&share), "{share}");
}
