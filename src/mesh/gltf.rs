//! glTF 2.0, as JSON and as one binary file: triangles of all nodes, with the colours of their materials.

use super::{Mesh, MeshFailure, Surface, damaged, failure, within};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::{Matrix4, Point3, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::{BTreeMap, BTreeSet};

/// Deepest nesting of nodes.
const DEPTH: usize = 64;
/// Maximum number of nodes that are visited.
const MAX_VISITS: usize = 100_000;

const PLAIN: &str = "export without compression, with positions as floating-point numbers";

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Root {
    scene: Option<usize>,
    scenes: Vec<Scene>,
    nodes: Vec<Node>,
    meshes: Vec<Primitives>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    materials: Vec<Material>,
    extensions_required: Vec<String>,
    textures: Vec<IgnoredAny>,
    animations: Vec<IgnoredAny>,
    skins: Vec<IgnoredAny>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Scene {
    nodes: Vec<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Node {
    mesh: Option<usize>,
    children: Vec<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Primitives {
    primitives: Vec<Primitive>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Primitive {
    attributes: BTreeMap<String, usize>,
    indices: Option<usize>,
    material: Option<usize>,
    mode: Option<u32>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    byte_offset: u64,
    component_type: u32,
    count: u64,
    sparse: Option<IgnoredAny>,
    r#type: String,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    byte_offset: u64,
    byte_length: u64,
    byte_stride: Option<u64>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Buffer {
    uri: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Material {
    pbr_metallic_roughness: Finish,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Finish {
    base_color_factor: Option<[f64; 4]>,
}

/// A file with the bytes that it refers to.
struct Reader {
    root: Root,
    buffers: Vec<Vec<u8>>,
    surfaces: Vec<Surface>,
    count: usize,
    visits: usize,
    ignored: BTreeSet<&'static str>,
}

/// Reads a mesh; `beside` reads a file of its folder.
pub fn read(bytes: &[u8], beside: impl Fn(&str) -> Result<Vec<u8>, MeshFailure>) -> Result<Mesh, MeshFailure> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let root: Root = serde_json::from_slice(json).or_else(|fault| damaged(format!("the JSON of glTF: {fault}")))?;
    if let Some(extension) = root.extensions_required.iter().find(|name| !name.starts_with("KHR_materials")) {
        let words = crate::diagnostic::shown(extension);
        return failure(format!("it needs `{words}`: its data are compressed or packed"), PLAIN);
    }
    let buffers = root.buffers.iter().enumerate().map(|(k, of)| match (&of.uri, k, binary) {
        (Some(uri), ..) => buffer(uri, &beside),
        (None, 0, Some(chunk)) => Ok(chunk.to_vec()),
        (None, ..) => damaged(format!("buffer {k} has no data")),
    });
    let buffers = buffers.collect::<Result<Vec<_>, _>>()?;
    let mut reader = Reader { root, buffers, surfaces: Vec::new(), count: 0, visits: 0, ignored: BTreeSet::new() };
    reader.all()?;
    Ok(Mesh { surfaces: reader.surfaces, unit_mm: 1000.0, ignored: reader.ignored })
}

/// Returns the JSON of a binary file, and the bytes behind it.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), MeshFailure> {
    let chunk = |at: usize, kind: &[u8]| {
        let size = bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes)? as usize;
        let start = at + 8;
        (bytes.get(at + 4..start)? == kind).then(|| bytes.get(start..start.checked_add(size)?)).flatten()
    };
    let Some(json) = chunk(12, b"JSON") else { return damaged("the file ends before its JSON does") };
    let behind = 20 + json.len();
    let binary = chunk(behind, b"BIN\0");
    if binary.is_none() && bytes.len() > behind {
        return damaged("the file ends before its data do");
    }
    Ok((json, binary))
}

/// Returns the bytes of a buffer in the file, or of a file beside it.
fn buffer(uri: &str, beside: &impl Fn(&str) -> Result<Vec<u8>, MeshFailure>) -> Result<Vec<u8>, MeshFailure> {
    if let Some(data) = uri.strip_prefix("data:") {
        let base64 = data.split_once(";base64,").map(|(_, text)| text);
        let bytes = base64.and_then(|text| BASE64_STANDARD.decode(text).ok());
        return bytes.map_or_else(|| damaged("the data of a buffer are not base64"), Ok);
    }
    if uri.contains("://") || uri.starts_with("//") {
        return failure("a buffer is an address: nothing is fetched", "put the file of the buffer beside the mesh");
    }
    beside(uri)
}

impl Reader {
    fn all(&mut self) -> Result<(), MeshFailure> {
        let Root { textures, animations, skins, .. } = &self.root;
        let left =
            [(!textures.is_empty(), "textures"), (!animations.is_empty(), "animations"), (!skins.is_empty(), "skins")];
        self.ignored.extend(left.iter().filter(|(is, _)| *is).map(|(_, what)| *what));
        let scene = self.root.scenes.get(self.root.scene.unwrap_or(0)).map(|scene| scene.nodes.clone());
        let nodes = scene.unwrap_or_else(|| (0..self.root.nodes.len()).collect());
        // Y upwards to Z upwards.
        let upright = Matrix4::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        nodes.into_iter().try_for_each(|node| self.node(node, &upright, 0))
    }

    fn node(&mut self, number: usize, carrier: &Matrix4<f64>, depth: usize) -> Result<(), MeshFailure> {
        self.visits += 1;
        if depth > DEPTH || self.visits > MAX_VISITS {
            return damaged("its nodes form a loop, or are too many");
        }
        let node = self.root.nodes.get(number).map_or_else(|| missing("node", number), Ok)?;
        let (placed, mesh, children) = (carrier * placement(node), node.mesh, node.children.clone());
        if let Some(mesh) = mesh {
            self.mesh(mesh, &placed)?;
        }
        children.into_iter().try_for_each(|child| self.node(child, &placed, depth + 1))
    }

    fn mesh(&mut self, number: usize, placed: &Matrix4<f64>) -> Result<(), MeshFailure> {
        let mesh = self.root.meshes.get(number).map_or_else(|| missing("mesh", number), Ok)?;
        let surfaces: Vec<_> = mesh.primitives.iter().map(|of| self.surface(of, placed)).collect::<Result<_, _>>()?;
        for surface in surfaces {
            match surface {
                Some(surface) => {
                    self.count += surface.triangles.len();
                    within(self.count)?;
                    self.surfaces.push(surface);
                }
                None => {
                    let _ = self.ignored.insert("points and lines");
                }
            }
        }
        Ok(())
    }

    fn surface(&self, of: &Primitive, placed: &Matrix4<f64>) -> Result<Option<Surface>, MeshFailure> {
        let mode = of.mode.unwrap_or(4);
        let Some(position) = of.attributes.get("POSITION").filter(|_| (4..=6).contains(&mode)) else { return Ok(None) };
        let vertices = self.positions(*position)?;
        let corners: Vec<u32> = match of.indices {
            Some(indices) => self.indices(indices)?,
            None => (0..vertices.len() as u32).collect(),
        };
        if let Some(beyond) = corners.iter().find(|corner| **corner as usize >= vertices.len()) {
            return damaged(format!("a triangle names vertex {beyond} of {}", vertices.len()));
        }
        let count = if mode == 4 { corners.len() / 3 } else { corners.len().saturating_sub(2) };
        within(count)?;
        let triangle = |k: usize| match mode {
            4 => [corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]],
            5 if k % 2 == 1 => [corners[k + 1], corners[k], corners[k + 2]],
            5 => [corners[k], corners[k + 1], corners[k + 2]],
            _ => [corners[0], corners[k + 1], corners[k + 2]],
        };
        let material = of.material.and_then(|number| self.root.materials.get(number));
        let color = material.and_then(|of| of.pbr_metallic_roughness.base_color_factor);
        let place = |vertex: [f64; 3]| placed.transform_point(&Point3::from(vertex)).coords.into();
        Ok(Some(Surface {
            color: color.map(|[r, g, b, _]| [r, g, b].map(|part| part.clamp(0.0, 1.0))),
            vertices: vertices.into_iter().map(place).collect(),
            triangles: (0..count).map(triangle).collect(),
        }))
    }

    fn positions(&self, number: usize) -> Result<Vec<[f64; 3]>, MeshFailure> {
        let accessor = self.accessor(number, "VEC3")?;
        if accessor.component_type != 5126 {
            return failure("positions are whole numbers", PLAIN);
        }
        let items = self.items(accessor, 12)?;
        let number = |item: &[u8], i: usize| {
            f64::from(f32::from_le_bytes([item[4 * i], item[4 * i + 1], item[4 * i + 2], item[4 * i + 3]]))
        };
        Ok(items.into_iter().map(|item| [0, 1, 2].map(|i| number(item, i))).collect())
    }

    fn indices(&self, number: usize) -> Result<Vec<u32>, MeshFailure> {
        let accessor = self.accessor(number, "SCALAR")?;
        let size = match accessor.component_type {
            5121 => 1,
            5123 => 2,
            5125 => 4,
            other => return damaged(format!("numbers of vertices have type {other}")),
        };
        let whole = |item: &[u8]| item.iter().rev().fold(0_u32, |sum, byte| sum << 8 | u32::from(*byte));
        Ok(self.items(accessor, size)?.into_iter().map(whole).collect())
    }

    fn accessor(&self, number: usize, form: &str) -> Result<&Accessor, MeshFailure> {
        let accessor = self.root.accessors.get(number).map_or_else(|| missing("accessor", number), Ok)?;
        if accessor.sparse.is_some() {
            return failure("an accessor is sparse", PLAIN);
        }
        if accessor.r#type != form {
            return damaged(format!("an accessor is not {form}"));
        }
        Ok(accessor)
    }

    /// Returns the bytes of each item of an accessor; nothing is reserved before they are known to be there.
    fn items(&self, of: &Accessor, size: u64) -> Result<Vec<&[u8]>, MeshFailure> {
        let view = of.buffer_view.and_then(|number| self.root.buffer_views.get(number));
        let Some(view) = view else { return damaged("an accessor has no data") };
        let buffer = self.buffers.get(view.buffer).map_or_else(|| missing("buffer", view.buffer), Ok)?;
        let stride = view.byte_stride.unwrap_or(size).max(size);
        let span = of.count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        let start = view.byte_offset.checked_add(of.byte_offset);
        let end = start.zip(span).and_then(|(start, span)| start.checked_add(span));
        let inside = of.byte_offset.checked_add(span.unwrap_or(u64::MAX)).is_some_and(|end| end <= view.byte_length);
        match start.zip(end).filter(|(_, end)| inside && *end <= buffer.len() as u64) {
            Some((start, end)) => {
                let bytes = &buffer[start as usize..end as usize];
                Ok((0..of.count as usize).map(|k| &bytes[k * stride as usize..][..size as usize]).collect())
            }
            None => damaged("an accessor reaches outside its buffer"),
        }
    }
}

fn missing<T>(what: &str, number: usize) -> Result<T, MeshFailure> {
    damaged(format!("there is no {what} {number}"))
}

fn placement(node: &Node) -> Matrix4<f64> {
    if let Some(matrix) = &node.matrix {
        return Matrix4::from_column_slice(matrix);
    }
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_homogeneous();
    let shift = Matrix4::new_translation(&Vector3::from(node.translation.unwrap_or_default()));
    shift * turn * Matrix4::new_nonuniform_scaling(&Vector3::from(node.scale.unwrap_or([1.0; 3])))
}
