//! A lattice of corrections in CSV: own reader, own interpolation.

use super::comp::plain;

/// A lattice.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// Names of the axes that span it.
    pub axes: Vec<String>,
    /// Units of these.
    pub units: Vec<String>,
    /// Rising nodes of each.
    pub nodes: Vec<Vec<f64>>,
    /// Names of the axes that are corrected.
    pub corrected: Vec<String>,
    /// Corrections, node after node, the last axis fastest.
    pub values: Vec<f64>,
}

impl Lattice {
    /// Reads a file, and insists that it is a whole lattice in order and plain decimals.
    pub fn read(text: &str) -> Self {
        assert!(text.is_ascii() && text.ends_with('\n') && !text.contains('\r'));
        let mut lines = text.lines();
        let mut lattice = Self::header(lines.next().unwrap());
        let rows: Vec<Vec<f64>> = lines.map(row).collect();
        let width = lattice.axes.len();
        for (axis, nodes) in lattice.nodes.iter_mut().enumerate() {
            *nodes = rows.iter().map(|row| row[axis]).collect();
            nodes.sort_by(f64::total_cmp);
            nodes.dedup();
        }
        assert_eq!(rows.len(), lattice.len());
        for (number, row) in rows.iter().enumerate() {
            assert_eq!(row.len(), width + lattice.corrected.len(), "row {number}");
            assert_eq!(row[..width], lattice.node(number), "row {number}");
            lattice.values.extend(&row[width..]);
        }
        lattice
    }

    fn header(line: &str) -> Self {
        let mut lattice = Self { axes: vec![], units: vec![], nodes: vec![], corrected: vec![], values: vec![] };
        for cell in line.split(',') {
            let (name, unit) = cell.strip_suffix(']').and_then(|c| c.split_once(" [")).unwrap();
            match name.strip_prefix('d') {
                Some(axis) => {
                    let known = lattice.axes.iter().position(|a| a == axis).unwrap();
                    assert_eq!(lattice.units[known], unit, "{line}");
                    lattice.corrected.push(axis.into());
                }
                None => {
                    assert!(lattice.corrected.is_empty() && (unit == "mm" || unit == "deg"), "{line}");
                    lattice.axes.push(name.into());
                    lattice.units.push(unit.into());
                    lattice.nodes.push(vec![]);
                }
            }
        }
        lattice
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.iter().map(Vec::len).product()
    }

    /// The pose at a node.
    pub fn node(&self, number: usize) -> Vec<f64> {
        let mut rest = number;
        let mut pose = vec![0.0; self.nodes.len()];
        for axis in (0..pose.len()).rev() {
            pose[axis] = self.nodes[axis][rest % self.nodes[axis].len()];
            rest /= self.nodes[axis].len();
        }
        pose
    }

    /// The corrections at a node, for every axis; zero where an axis is not corrected.
    pub fn at_node(&self, number: usize) -> Vec<f64> {
        let row = &self.values[number * self.corrected.len()..][..self.corrected.len()];
        let of = |axis: &String| self.corrected.iter().position(|c| c == axis).map_or(0.0, |column| row[column]);
        self.axes.iter().map(of).collect()
    }

    /// The corrections between nodes: axis by axis, from both neighbours.
    pub fn at(&self, pose: &[f64]) -> Vec<f64> {
        self.between(pose, 0, 0)
    }

    fn between(&self, pose: &[f64], axis: usize, number: usize) -> Vec<f64> {
        let Some(nodes) = self.nodes.get(axis) else { return self.at_node(number) };
        let number = number * nodes.len();
        let upper = nodes.partition_point(|node| *node <= pose[axis]);
        if upper == 0 || upper == nodes.len() {
            return self.between(pose, axis + 1, number + upper.min(nodes.len() - 1));
        }
        let share = (pose[axis] - nodes[upper - 1]) / (nodes[upper] - nodes[upper - 1]);
        let [low, high] = [upper - 1, upper].map(|i| self.between(pose, axis + 1, number + i));
        low.iter().zip(&high).map(|(a, b)| (1.0 - share) * a + share * b).collect()
    }
}

fn row(line: &str) -> Vec<f64> {
    line.split(',').map(|cell| plain(cell).unwrap_or_else(|| panic!("not a plain decimal: {line}"))).collect()
}

#[test]
fn a_bilinear_function_is_interpolated_exactly_and_held_outside() {
    let f = |x: f64, c: f64| 1.0 + 2.0 * x - 0.5 * c + 0.25 * x * c;
    let mut text = String::from("X [mm],C [deg],dX [mm]\n");
    for (x, c) in [(0.0, 0.0), (0.0, 8.0), (4.0, 0.0), (4.0, 8.0), (16.0, 0.0), (16.0, 8.0)] {
        text += &format!("{x:.1},{c:.1},{:.3}\n", f(x, c));
    }
    let lattice = Lattice::read(&text);
    for (x, c) in [(0.0, 0.0), (1.0, 2.0), (7.0, 8.0), (16.0, 4.0)] {
        assert_eq!(lattice.at(&[x, c]), [f(x, c), 0.0]);
    }
    assert_eq!(lattice.at(&[99.0, -3.0]), [f(16.0, 0.0), 0.0]);
}
