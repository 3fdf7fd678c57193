//! A VTK structured grid (`.vts`): points with numbers, the arrays appended raw, little-endian (VTK XML file format,
//! version 1.0).

/// Returns the file of a grid of points (mm), x running fastest, with named arrays of a number for each; `note` stands
/// in a comment.
pub fn structured_grid(
    note: &str,
    counts: [usize; 3],
    points: &[[f64; 3]],
    arrays: &[(&'static str, &[f64])],
) -> Vec<u8> {
    let extent = counts.map(|count| format!("0 {}", count.saturating_sub(1))).join(" ");
    let mut offset = 8 + 24 * points.len();
    let mut elements = String::new();
    for (name, values) in arrays {
        elements += &format!(
            "    <DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"1\" format=\"appended\" \
             offset=\"{offset}\"/>\n"
        );
        offset += 8 + 8 * values.len();
    }
    let first = arrays.first().map_or("", |(name, _)| name);
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n <!-- {note} -->\n <StructuredGrid WholeExtent=\"{extent}\">\n  \
         <Piece Extent=\"{extent}\">\n   <Points>\n    <DataArray type=\"Float64\" Name=\"Points\" \
         NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>\n   </Points>\n   \
         <PointData Scalars=\"{first}\">\n{elements}   </PointData>\n  </Piece>\n </StructuredGrid>\n \
         <AppendedData encoding=\"raw\">\n_"
    );
    let mut file = head.into_bytes();
    let mut append = |count: usize, numbers: &mut dyn Iterator<Item = f64>| {
        file.extend((8 * count as u64).to_le_bytes());
        numbers.for_each(|x| file.extend((x + 0.0).to_le_bytes()));
    };
    append(3 * points.len(), &mut points.iter().flatten().copied());
    arrays.iter().for_each(|(_, values)| append(values.len(), &mut values.iter().copied()));
    file.extend(b"\n </AppendedData>\n</VTKFile>\n");
    file
}
