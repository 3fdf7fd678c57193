//! Another laboratory's numbers for three-axis machines, within half a nanometre.

use std::path::PathBuf;

use crate::oracle::matrix::V3;
use crate::oracle::program::{Ask, DEFAULT, eval};

/// Half a nanometre, in um: the tolerance of the laboratory's own regression tests.
const TOLERANCE: f64 = 5e-4;

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/msl-three-axis").join(name)
}

/// One line of either file.
struct Row {
    machine: String,
    order: String,
    tool: String,
    pose: Vec<f64>,
    deviation_um: V3,
}

/// The rows of `expected.csv` (their first column is a set) or `expected-program.csv` (their second an order).
fn rows(name: &str) -> Vec<Row> {
    let text = std::fs::read_to_string(data(name)).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let (machine, order) = if header.starts_with("set,machine,tool") { (1, None) } else { (0, Some(1)) };
    assert!(header.ends_with("tool,X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um]"), "{header}");
    let row = |line: &str| {
        let cells: Vec<_> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        assert_eq!(cells.len(), 9, "{line}");
        Row {
            machine: cells[machine].into(),
            order: order.map_or("exact", |i| cells[i]).into(),
            tool: cells[2].into(),
            pose: (3..6).map(number).collect(),
            deviation_um: std::array::from_fn(|i| number(6 + i)),
        }
    };
    lines.map(row).collect()
}

/// Asserts one row on a machine file; `sense` is -1 where X counts as the table moves.
fn holds(row: &Row, machine: &str, sense: f64) {
    let ask = Ask { order: Some(&row.order), tool: Some(&row.tool), ..DEFAULT };
    let pose = vec![sense * row.pose[0], row.pose[1], row.pose[2]];
    let found = eval(&data(machine), &["X", "Y", "Z"], &[pose], ask)[0].deviation.map(|c| c * 1000.0);
    for (found, expected) in found.iter().zip(row.deviation_um) {
        let gap = (found - expected).abs();
        assert!(gap < TOLERANCE, "{machine}, {}, {:?}: {found} um, published {expected} um", row.tool, row.pose);
    }
}

#[test]
fn every_published_number() {
    let rows = rows("expected.csv");
    assert_eq!(rows.len(), 40);
    rows.iter().for_each(|row| holds(row, &row.machine, 1.0));
}

#[test]
fn every_number_of_the_running_program() {
    let rows = rows("expected-program.csv");
    assert_eq!(rows.len(), 42);
    rows.iter().for_each(|row| holds(row, &row.machine, 1.0));
}

/// The same machine in other words: bodies' errors, another sense of X, squareness, tables.
#[test]
fn equivalent_machine_files() {
    let rows: Vec<_> = rows("expected.csv").into_iter().filter(|row| row.machine == "machine-pmm866.yaml").collect();
    assert_eq!(rows.len(), 32);
    for variant in ["body", "squareness", "tables"] {
        rows.iter().for_each(|row| holds(row, &format!("machine-pmm866-{variant}.yaml"), 1.0));
    }
    rows.iter().for_each(|row| holds(row, "machine-pmm866-direct.yaml", -1.0));
}
