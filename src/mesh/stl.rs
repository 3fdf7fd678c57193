//! STL, as text and as bytes.

use super::{Mesh, MeshFailure, Surface, damaged, within};
use std::collections::BTreeSet;

/// Bytes before the first triangle of the binary form, and of each triangle.
const HEAD: usize = 84;
const FACET: usize = 50;

pub fn read(bytes: &[u8]) -> Result<Mesh, MeshFailure> {
    let promised = bytes.get(80..HEAD).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let size = promised.map(|count| HEAD as u64 + u64::from(count) * FACET as u64);
    // Binary files may begin with `solid`, too.
    let is_text = bytes.starts_with(b"solid") && size != Some(bytes.len() as u64);
    let corners = match (is_text, promised) {
        (true, _) => text(&String::from_utf8_lossy(bytes))?,
        (false, Some(count)) => binary(bytes, count)?,
        (false, None) => return damaged(format!("{} bytes are no STL", bytes.len())),
    };
    let triangles = (0..corners.len() / 3).map(|k| [0, 1, 2].map(|i| (3 * k + i) as u32)).collect();
    let surfaces = vec![Surface { color: None, vertices: corners, triangles }];
    Ok(Mesh { surfaces, unit_mm: 1.0, ignored: BTreeSet::new() })
}

fn binary(bytes: &[u8], count: u32) -> Result<Vec<[f64; 3]>, MeshFailure> {
    let (facets, _) = bytes.get(HEAD..).unwrap_or_default().as_chunks::<FACET>();
    if (facets.len() as u64) < u64::from(count) {
        return damaged(format!("its head promises {count} triangles, the file holds {}", facets.len()));
    }
    within(count as usize)?;
    let corner = |facet: &[u8; FACET], k: usize| {
        [0, 1, 2].map(|i| {
            let at = 12 * (k + 1) + 4 * i;
            f64::from(f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]))
        })
    };
    Ok(facets.iter().take(count as usize).flat_map(|facet| [0, 1, 2].map(|k| corner(facet, k))).collect())
}

fn text(text: &str) -> Result<Vec<[f64; 3]>, MeshFailure> {
    let mut words = text.split_ascii_whitespace();
    let (mut corners, mut facets, mut ended) = (Vec::new(), 0_usize, false);
    while let Some(word) = words.next() {
        match word {
            "vertex" => {
                let mut next = || {
                    let word = words.next().unwrap_or("the end of the file");
                    word.parse::<f64>()
                        .or_else(|_| damaged(format!("vertex {}: a coordinate is not a number", corners.len() + 1)))
                };
                let corner = [next()?, next()?, next()?];
                corners.push(corner);
            }
            "endfacet" => {
                facets += 1;
                within(facets)?;
                if corners.len() != 3 * facets {
                    return damaged(format!("facet {facets} has other than three corners"));
                }
            }
            "endsolid" => ended = true,
            _ => (),
        }
    }
    match ended && corners.len() == 3 * facets {
        true => Ok(corners),
        false => damaged("the file ends before its `endsolid`"),
    }
}
