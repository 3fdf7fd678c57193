//! Surfaces of triangles.

/// Triangles of one colour.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Red, green and blue in linear light, 0 to 1; none where the file states no colour.
    pub color: Option<[f64; 3]>,
    /// Points in the unit of the file.
    pub vertices: Vec<[f64; 3]>,
    /// Numbers of three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

/// Returns the number of triangles of surfaces.
pub fn count(surfaces: &[Surface]) -> usize {
    surfaces.iter().map(|surface| surface.triangles.len()).sum()
}
