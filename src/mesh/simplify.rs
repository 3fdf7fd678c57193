//! Fewer triangles: vertices in one cell of a grid become their mean, and triangles without area are left out.

use super::surface::{Surface, count};
use std::collections::{BTreeSet, HashMap};

/// Cells along the longest extent: the finest grid is 2 to this power.
const FINEST: u32 = 10;

/// Returns surfaces of at most `max` triangles; a mesh keeps some dozen whatever `max` is.
pub fn simplified(surfaces: Vec<Surface>, max: usize) -> Vec<Surface> {
    if count(&surfaces) <= max {
        return surfaces;
    }
    let vertices = || surfaces.iter().flat_map(|surface| &surface.vertices);
    let low = vertices().fold([f64::INFINITY; 3], |low, at| [0, 1, 2].map(|i| low[i].min(at[i])));
    let high = vertices().fold([f64::NEG_INFINITY; 3], |high, at| [0, 1, 2].map(|i| high[i].max(at[i])));
    let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let of = |cells: u32| -> Vec<Surface> {
        surfaces.iter().map(|surface| clustered(surface, low, extent / f64::from(cells))).collect()
    };
    let (mut coarse, mut fine) = (1_u32, 1 << FINEST);
    let mut best = of(coarse);
    while fine - coarse > coarse / 16 + 1 {
        let cells = libm::sqrt(f64::from(coarse) * f64::from(fine)) as u32;
        let cells = cells.clamp(coarse + 1, fine - 1);
        let found = of(cells);
        if count(&found) <= max {
            (coarse, best) = (cells, found);
        } else {
            fine = cells;
        }
    }
    best.retain(|surface| !surface.triangles.is_empty());
    best
}

/// Returns a surface with one vertex for each cell of a grid from `low`; `cell` 0 joins equal vertices only.
pub fn clustered(surface: &Surface, low: [f64; 3], cell: f64) -> Surface {
    let key = |vertex: &[f64; 3]| {
        [0, 1, 2].map(|i| match cell > 0.0 {
            // Half a cell is added: rounding does not tear a plane at the lower end.
            true => ((vertex[i] - low[i]) / cell + 0.5) as u64,
            // Adding zero turns -0 into 0.
            false => (vertex[i] + 0.0).to_bits(),
        })
    };
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let (mut sums, mut counts): (Vec<[f64; 3]>, Vec<f64>) = (Vec::new(), Vec::new());
    let numbers: Vec<u32> = surface
        .vertices
        .iter()
        .map(|vertex| {
            let number = *known.entry(key(vertex)).or_insert(sums.len() as u32);
            let at = number as usize;
            if at == sums.len() {
                sums.push([0.0; 3]);
                counts.push(0.0);
            }
            // The mean of equal vertices is that vertex, to the bit.
            counts[at] += 1.0;
            sums[at] = [0, 1, 2].map(|i| sums[at][i] + (vertex[i] - sums[at][i]) / counts[at]);
            number
        })
        .collect();
    let mut seen = BTreeSet::new();
    let corners = surface.triangles.iter().map(|triangle| triangle.map(|corner| numbers[corner as usize]));
    let has_area = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let triangles = corners.filter(has_area).filter(|triangle| {
        let mut sorted = *triangle;
        sorted.sort_unstable();
        cell == 0.0 || seen.insert(sorted)
    });
    Surface { color: surface.color, triangles: triangles.collect(), vertices: sums }
}
