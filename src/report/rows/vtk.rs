//! VTK: an unstructured grid (`.vtu`) for ParaView: the nominal tool tip of each pose in mm, with the
//! deviation as a vector field and the rotation, or with what bounds lead to, and the position of every axis.
//!
//! Nodes of a grid are joined along the linear axes to hexahedra (quads, lines), a block for each position of
//! the other axes: a threshold on these picks one. Other poses are single vertices. Arrays are appended raw,
//! little-endian, as the format's specification calls it (VTK XML file format, version 1.0). They follow one another
//! and their sizes are known beforehand, so rows are written in their places in each of them as they come.

use super::table::{RowBlock, Rows, Sink, Stream};
use crate::analysis::space_axes;
use crate::evaluate::Poses;
use std::io::{self, SeekFrom, Write};

/// Cell types of VTK by dimension: vertex, line, quad, hexahedron.
const CELLS: [u8; 4] = [1, 3, 9, 12];

/// Corners of a cell as offsets along its axes, in VTK's order.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// Arrays before those of the poses' values: points, then the three of the cells.
const VALUES: usize = 4;

/// Arrays of a deviation with their numbers of components.
const DEVIATION: [(&str, u64); 3] = [("deviation_um", 3), ("rotation_urad", 3), ("length_um", 1)];

/// Arrays of what bounds lead to, in the order of the columns.
const BOUNDED: [&str; 4] = ["position_rss_um", "position_p95_um", "rotation_rss_urad", "rotation_p95_urad"];

struct Array {
    /// Attributes of its element.
    attributes: String,
    /// Bytes of an item.
    width: u64,
    items: u64,
}

pub(super) struct Vtk<W> {
    out: W,
    /// Offsets of the numbers of each array, and the bytes of an item.
    places: Vec<(u64, u64)>,
    end: u64,
    /// True if the values are what bounds lead to.
    bounded: bool,
}

impl<W: Sink> Vtk<W> {
    pub(super) fn new(rows: &Rows<'_>, mut out: W) -> io::Result<Self> {
        let cells = Cells::of(rows);
        let arrays = arrays(rows, &cells);
        let head = head(rows, &arrays, cells.count);
        out.write_all(head.as_bytes())?;
        let mut next = head.len() as u64;
        let mut places = Vec::new();
        for array in &arrays {
            let _ = out.seek(SeekFrom::Start(next))?;
            out.write_all(&(array.width * array.items).to_le_bytes())?;
            places.push((next + 8, array.width));
            next += 8 + array.width * array.items;
        }
        let mut vtk = Self { out, places, end: next, bounded: rows.drawn.is_some() };
        vtk.cells(&cells)?;
        Ok(vtk)
    }

    fn cells(&mut self, cells: &Cells) -> io::Result<()> {
        let size = cells.size() as i64;
        self.within(1, 0, |out| {
            let mut put = |node: usize| out.write_all(&(node as i64).to_le_bytes());
            cells.origins().try_for_each(|origin| cells.corners(origin, &mut put))
        })?;
        self.within(2, 0, |out| (1..=cells.count as i64).try_for_each(|i| out.write_all(&(i * size).to_le_bytes())))?;
        let kind = CELLS[cells.strides.len().min(3)];
        self.within(3, 0, |out| (0..cells.count).try_for_each(|_| out.write_all(&[kind])))
    }

    /// Writes from the item `first` of an array on.
    fn within(
        &mut self,
        array: usize,
        first: usize,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let (start, width) = self.places[array];
        let _ = self.out.seek(SeekFrom::Start(start + first as u64 * width))?;
        fill(&mut self.out)
    }

    fn put_array<const N: usize>(
        &mut self,
        array: usize,
        rows: &RowBlock,
        of: impl Fn(usize) -> [f64; N],
    ) -> io::Result<()> {
        self.within(array, rows.first, |out| {
            let mut numbers = (0..rows.rows.len()).flat_map(&of);
            numbers.try_for_each(|x| out.write_all(&(x + 0.0).to_le_bytes()))
        })
    }
}

impl<W: Sink> Stream for Vtk<W> {
    fn put(&mut self, rows: &RowBlock) -> io::Result<()> {
        let of_values = if self.bounded { BOUNDED.len() } else { 3 };
        let axes = self.places.len() - VALUES - of_values;
        let three = |i: usize, from: usize| -> [f64; 3] { std::array::from_fn(|k| rows.rows[i][axes + from + k]) };
        self.put_array(0, rows, |i| rows.tips[i])?;
        if self.bounded {
            (0..of_values).try_for_each(|k| self.put_array(VALUES + k, rows, |i| [rows.rows[i][axes + k]]))?;
        } else {
            self.put_array(VALUES, rows, |i| three(i, 0))?;
            self.put_array(VALUES + 1, rows, |i| three(i, 3))?;
            self.put_array(VALUES + 2, rows, |i| [nalgebra::Vector3::from(three(i, 0)).norm()])?;
        }
        (0..axes).try_for_each(|axis| self.put_array(VALUES + of_values + axis, rows, |i| [rows.rows[i][axis]]))
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        let _ = self.out.seek(SeekFrom::Start(self.end))?;
        self.out.write_all(b"\n </AppendedData>\n</VTKFile>\n")?;
        self.out.flush()
    }
}

/// The arrays in the order they are appended: points, cells, then those of the points.
fn arrays(rows: &Rows<'_>, cells: &Cells) -> Vec<Array> {
    let array = |kind: &str, name: &str, components: u64, items: usize, width: u64| Array {
        attributes: format!(r#"type="{kind}" Name="{name}" NumberOfComponents="{components}""#),
        width: components * width,
        items: items as u64,
    };
    let points = rows.poses.len();
    let mut list = vec![
        array("Float64", "Points", 3, points, 8),
        array("Int64", "connectivity", 1, cells.count * cells.size(), 8),
        array("Int64", "offsets", 1, cells.count, 8),
        array("UInt8", "types", 1, cells.count, 1),
    ];
    let values = if rows.drawn.is_some() { &BOUNDED.map(|name| (name, 1))[..] } else { &DEVIATION };
    list.extend(values.iter().map(|(name, components)| array("Float64", name, *components, points, 8)));
    // Names of axes are letters and digits.
    let axes = rows.machine.axes().iter().map(|axis| format!("{}_{}", axis.name, axis.unit()));
    list.extend(axes.map(|name| array("Float64", &name, 1, points, 8)));
    list
}

fn head(rows: &Rows<'_>, arrays: &[Array], cells: usize) -> String {
    let points = rows.poses.len();
    let values = match rows.drawn {
        Some(drawn) => format!(
            "from bounds, nothing is measured: RSS of the bounds, and the length that 95 % of {} machines drawn (seed \
             {}, {} distribution) do not exceed, in um and urad",
            drawn.samples,
            drawn.seed,
            drawn.distribution.name()
        ),
        None => "deviation in um, rotation in urad: actual minus nominal, tool relative to workpiece".to_owned(),
    };
    let shown = match rows.drawn {
        Some(_) => r#"Scalars="position_p95_um""#,
        None => r#"Vectors="deviation_um" Scalars="length_um""#,
    };
    let mut offset = 0;
    let mut place = |array: &Array| {
        let text = format!("    <DataArray {} format=\"appended\" offset=\"{offset}\"/>\n", array.attributes);
        offset += 8 + array.width * array.items;
        text
    };
    let texts: Vec<String> = arrays.iter().map(&mut place).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n \
         <!-- Nominal tool tip from the workpiece origin in mm; {values}. -->\n \
         <UnstructuredGrid>\n  <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n   <Points>\n{}   \
         </Points>\n   <Cells>\n{}   </Cells>\n   \
         <PointData {shown}>\n{}   </PointData>\n  </Piece>\n \
         </UnstructuredGrid>\n <AppendedData encoding=\"raw\">\n_",
        texts[0],
        texts[1..VALUES].concat(),
        texts[VALUES..].concat()
    )
}

/// Cells that join the poses: the node at the origin of each, and how far its neighbours are.
struct Cells {
    points: usize,
    count: usize,
    /// For each joined axis, the distance from a node to the next along it, and the number of its nodes.
    strides: Vec<(usize, usize)>,
}

impl Cells {
    fn of(rows: &Rows<'_>) -> Self {
        let points = rows.poses.len();
        let Poses::Nodes(nodes) = rows.poses else { return Self { points, count: points, strides: Vec::new() } };
        let counts: Vec<usize> = nodes.counts().collect();
        let stride = |axis: usize| counts[axis + 1..].iter().product::<usize>();
        let joined = space_axes(rows.machine).into_iter().filter(|axis| counts[*axis] > 1);
        let strides: Vec<(usize, usize)> = joined.map(|axis| (stride(axis), counts[axis])).collect();
        let count = strides.iter().fold(points, |count, (_, nodes)| count / nodes * (nodes - 1));
        Self { points, count, strides }
    }

    /// Corners of a cell.
    fn size(&self) -> usize {
        1 << self.strides.len().min(3)
    }

    fn origins(&self) -> impl Iterator<Item = usize> {
        (0..self.points).filter(|node| self.strides.iter().all(|(stride, count)| node / stride % count + 1 < *count))
    }

    fn corners(&self, origin: usize, mut put: impl FnMut(usize) -> io::Result<()>) -> io::Result<()> {
        CORNERS[..self.size()].iter().try_for_each(|corner| {
            put(origin + self.strides.iter().zip(corner).map(|((stride, _), step)| stride * step).sum::<usize>())
        })
    }
}
