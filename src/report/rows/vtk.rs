//! VTK: an unstructured grid (`.vtu`) for ParaView: the nominal tool tip of each pose in mm, with the
//! deviation as a vector field, the rotation, and the position of every axis.
//!
//! Nodes of a grid are joined along the linear axes to hexahedra (quads, lines), a block for each position of
//! the other axes: a threshold on these picks one. Other poses are single vertices. Arrays are appended raw,
//! little-endian, as the format's specification calls it (VTK XML file format, version 1.0).

use super::{Rows, six};
use crate::analysis::{frame_rotation, space_axes, tool_pose};
use crate::evaluate::Poses;
use std::io::{self, Write};

/// Cell types of VTK by dimension: vertex, line, quad, hexahedron.
const CELLS: [u8; 4] = [1, 3, 9, 12];

/// Corners of a cell as offsets along its axes, in VTK's order.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// An array of the file.
struct Array {
    /// Attributes of its element.
    attributes: String,
    bytes: u64,
}

impl Rows<'_> {
    /// Writes VTK.
    pub fn vtk(&self, out: &mut dyn Write) -> io::Result<()> {
        let cells = Cells::of(self);
        let points = self.deviations.len() as u64;
        let size = 1 << cells.strides.len().min(3);
        let (count, corners) = (cells.origins.len() as u64, cells.origins.len() as u64 * size as u64);
        let arrays = self.arrays(points, count, corners);
        self.head(out, &arrays, points, count)?;
        let mut next = arrays.iter().map(|array| array.bytes);
        let mut begin = |out: &mut dyn Write| out.write_all(&next.next().unwrap_or(0).to_le_bytes());
        begin(out)?;
        (0..self.deviations.len()).try_for_each(|i| doubles(out, &self.tip(i)))?;
        begin(out)?;
        cells.write_corners(out)?;
        begin(out)?;
        (1..=cells.origins.len()).try_for_each(|i| out.write_all(&((i * size) as i64).to_le_bytes()))?;
        begin(out)?;
        cells.origins.iter().try_for_each(|_| out.write_all(&[CELLS[cells.strides.len().min(3)]]))?;
        for range in [0..3, 3..6] {
            begin(out)?;
            self.deviations.iter().try_for_each(|d| doubles(out, &six(d)[range.clone()]))?;
        }
        begin(out)?;
        self.deviations.iter().try_for_each(|d| doubles(out, &[d.position.norm() * 1e3]))?;
        for axis in 0..self.machine.axes().len() {
            begin(out)?;
            (0..self.deviations.len()).try_for_each(|i| doubles(out, &[self.poses.get(i)[axis] + 0.0]))?;
        }
        out.write_all(b"\n </AppendedData>\n</VTKFile>\n")
    }

    /// Nominal tip from the workpiece origin, mm, in the frame of the vectors.
    fn tip(&self, index: usize) -> [f64; 3] {
        let pose = self.poses.get(index);
        let tip = tool_pose(self.machine, &pose).tip;
        match frame_rotation(self.machine, &pose, self.view.frame) {
            Some(turn) => (turn * tip).map(|x| x + 0.0).into(),
            None => tip.map(|x| x + 0.0).into(),
        }
    }

    /// The arrays in the order they are appended: points, cells, then those of the points.
    fn arrays(&self, points: u64, cells: u64, corners: u64) -> Vec<Array> {
        let array = |kind: &str, name: &str, components: u64, items: u64, width: u64| Array {
            attributes: format!(r#"type="{kind}" Name="{name}" NumberOfComponents="{components}""#),
            bytes: components * items * width,
        };
        let mut list = vec![
            array("Float64", "Points", 3, points, 8),
            array("Int64", "connectivity", 1, corners, 8),
            array("Int64", "offsets", 1, cells, 8),
            array("UInt8", "types", 1, cells, 1),
            array("Float64", "deviation_um", 3, points, 8),
            array("Float64", "rotation_urad", 3, points, 8),
            array("Float64", "length_um", 1, points, 8),
        ];
        // Names of axes are letters and digits.
        let axes = self.machine.axes().iter().map(|axis| format!("{}_{}", axis.name, axis.unit()));
        list.extend(axes.map(|name| array("Float64", &name, 1, points, 8)));
        list
    }

    fn head(&self, out: &mut dyn Write, arrays: &[Array], points: u64, cells: u64) -> io::Result<()> {
        let mut offset = 0;
        let mut place = |array: &Array| {
            let text = format!("    <DataArray {} format=\"appended\" offset=\"{offset}\"/>\n", array.attributes);
            offset += 8 + array.bytes;
            text
        };
        let texts: Vec<String> = arrays.iter().map(&mut place).collect();
        write!(
            out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n \
             <!-- Nominal tool tip from the workpiece origin in mm; deviation in um, rotation in urad: actual minus nominal, tool relative to workpiece. -->\n \
             <UnstructuredGrid>\n  <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n   <Points>\n{}   </Points>\n   <Cells>\n{}   </Cells>\n   \
             <PointData Vectors=\"deviation_um\" Scalars=\"length_um\">\n{}   </PointData>\n  </Piece>\n </UnstructuredGrid>\n <AppendedData encoding=\"raw\">\n_",
            texts[0],
            texts[1..4].concat(),
            texts[4..].concat()
        )
    }
}

fn doubles(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|x| out.write_all(&(x + 0.0).to_le_bytes()))
}

/// Cells that join the poses: the node at the origin of each, and how far its neighbours are.
struct Cells {
    origins: Vec<usize>,
    strides: Vec<usize>,
}

impl Cells {
    fn of(rows: &Rows<'_>) -> Self {
        let all = 0..rows.deviations.len();
        let Poses::Nodes(nodes) = rows.poses else { return Self { origins: all.collect(), strides: Vec::new() } };
        let counts: Vec<usize> = nodes.counts().collect();
        let stride = |axis: usize| counts[axis + 1..].iter().product::<usize>();
        let joined: Vec<usize> = space_axes(rows.machine).into_iter().filter(|axis| counts[*axis] > 1).collect();
        let inside = |node: &usize| joined.iter().all(|axis| node / stride(*axis) % counts[*axis] + 1 < counts[*axis]);
        Self { origins: all.filter(inside).collect(), strides: joined.iter().map(|axis| stride(*axis)).collect() }
    }

    fn write_corners(&self, out: &mut dyn Write) -> io::Result<()> {
        for origin in &self.origins {
            for corner in &CORNERS[..1 << self.strides.len().min(3)] {
                let node = origin + self.strides.iter().zip(corner).map(|(stride, step)| stride * step).sum::<usize>();
                out.write_all(&(node as i64).to_le_bytes())?;
            }
        }
        Ok(())
    }
}
