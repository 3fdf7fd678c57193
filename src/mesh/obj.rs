//! Wavefront OBJ, with the colours of its MTL.

use super::{Mesh, MeshFailure, Surface, damaged, within};
use std::collections::{BTreeMap, BTreeSet};

/// Light of a screen to linear light, nearly.
const GAMMA: f64 = 2.2;

/// Triangles under construction.
#[derive(Default)]
struct Reader {
    vertices: Vec<[f64; 3]>,
    /// Colours by the name of a material.
    colors: BTreeMap<String, [f64; 3]>,
    material: String,
    /// Triangles by material, in the order of the materials' first faces.
    faces: Vec<(String, Vec<[usize; 3]>)>,
    count: usize,
    ignored: BTreeSet<&'static str>,
}

/// Reads a mesh; `beside` reads a file of its folder.
pub fn read(bytes: &[u8], beside: impl Fn(&str) -> Result<Vec<u8>, MeshFailure>) -> Result<Mesh, MeshFailure> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader::default();
    for (line, words) in text.lines().enumerate().map(|(n, line)| (n + 1, line.trim())) {
        let (key, rest) = words.split_once(char::is_whitespace).unwrap_or((words, ""));
        match key {
            "v" => reader.vertex(line, rest)?,
            "f" => reader.face(line, rest)?,
            "usemtl" => rest.trim().clone_into(&mut reader.material),
            // Without it the mesh has no colours.
            "mtllib" => match beside(rest.trim()) {
                Ok(bytes) => reader.materials(&String::from_utf8_lossy(&bytes)),
                Err(_) => reader.ignore("colours of an MTL file that cannot be read"),
            },
            "p" | "l" => reader.ignore("points and lines"),
            "curv" | "surf" => reader.ignore("free-form surfaces"),
            _ => (),
        }
    }
    Ok(reader.mesh())
}

impl Reader {
    fn ignore(&mut self, what: &'static str) {
        let _ = self.ignored.insert(what);
    }

    fn vertex(&mut self, line: usize, rest: &str) -> Result<(), MeshFailure> {
        match numbers(rest) {
            Some(vertex) => {
                self.vertices.push(vertex);
                Ok(())
            }
            None => damaged(format!("line {line}: a vertex is not three numbers")),
        }
    }

    /// Reads a polygon as a fan of triangles.
    fn face(&mut self, line: usize, rest: &str) -> Result<(), MeshFailure> {
        let count = self.vertices.len();
        let number = |word: &str| -> Result<usize, MeshFailure> {
            let written = word.split('/').next().unwrap_or_default();
            let found = written.parse::<i64>().ok().and_then(|number| match number {
                1.. => usize::try_from(number).ok().filter(|number| *number <= count).map(|number| number - 1),
                _ => usize::try_from(number.unsigned_abs())
                    .ok()
                    .filter(|back| (1..=count).contains(back))
                    .map(|back| count - back),
            });
            found.map_or_else(|| damaged(format!("line {line}: a face names vertex {written} of {count}")), Ok)
        };
        let corners = rest.split_ascii_whitespace().map(number).collect::<Result<Vec<_>, _>>()?;
        let fan = (1..corners.len().saturating_sub(1)).map(|k| [corners[0], corners[k], corners[k + 1]]);
        self.count += fan.len();
        within(self.count)?;
        let known = self.faces.iter().position(|(name, _)| *name == self.material);
        let at = known.unwrap_or_else(|| {
            self.faces.push((self.material.clone(), Vec::new()));
            self.faces.len() - 1
        });
        self.faces[at].1.extend(fan);
        Ok(())
    }

    fn materials(&mut self, text: &str) {
        let mut name = String::new();
        for line in text.lines().map(str::trim) {
            let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            match key {
                "newmtl" => rest.trim().clone_into(&mut name),
                "Kd" => {
                    let color = numbers(rest).filter(|color| color.iter().all(|part| (0.0..=1.0).contains(part)));
                    self.colors.extend(color.map(|color| (name.clone(), color.map(|part| libm::pow(part, GAMMA)))));
                }
                key if key.starts_with("map_") => self.ignore("textures"),
                _ => (),
            }
        }
    }

    fn mesh(self) -> Mesh {
        let Self { vertices, colors, faces, ignored, .. } = self;
        let surfaces = faces.into_iter().filter(|(_, faces)| !faces.is_empty());
        let surfaces = surfaces.map(|(name, faces)| surface(&vertices, &faces, colors.get(&name).copied()));
        Mesh { surfaces: surfaces.collect(), unit_mm: 1.0, ignored }
    }
}

/// Returns triangles with the vertices that they use.
fn surface(all: &[[f64; 3]], faces: &[[usize; 3]], color: Option<[f64; 3]>) -> Surface {
    let (mut number, mut vertices) = (vec![u32::MAX; all.len()], Vec::new());
    let mut of = |corner: usize| {
        if number[corner] == u32::MAX {
            number[corner] = vertices.len() as u32;
            vertices.push(all[corner]);
        }
        number[corner]
    };
    let triangles = faces.iter().map(|face| face.map(&mut of)).collect();
    Surface { color, vertices, triangles }
}

fn numbers(words: &str) -> Option<[f64; 3]> {
    let mut numbers = words.split_ascii_whitespace().map(str::parse::<f64>);
    let mut next = || numbers.next()?.ok();
    Some([next()?, next()?, next()?])
}
