//! Meshes that bodies of a machine are drawn by: the bytes of STL, OBJ and glTF to triangles with colours.
//!
//! They are for the eye alone: no figure depends on one. Textures are left out, and named. What comes from outside is
//! bounded: bytes, triangles, nesting, coordinates. [`simplified`] makes fewer triangles of many.

mod gltf;
mod obj;
mod simplify;
mod stl;
mod surface;

pub use simplify::{clustered, simplified};
pub use surface::{Surface, count};

use crate::syntax::{Files, ReadFailure};
use std::collections::BTreeSet;
use std::path::Path;

/// Largest file of a mesh, bytes.
pub const MAX_BYTES: u64 = 64 << 20;
/// Maximum number of triangles of a file.
pub const MAX_TRIANGLES: usize = 1_000_000;

/// The content of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Surfaces, each with its colour.
    pub surfaces: Vec<Surface>,
    /// Unit of the coordinates, mm.
    pub unit_mm: f64,
    /// Parts of the file that are not drawn, such as `textures`.
    pub ignored: BTreeSet<&'static str>,
}

impl Mesh {
    /// Returns the number of triangles.
    pub fn count(&self) -> usize {
        count(&self.surfaces)
    }
}

/// The reason for which a file is not drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct MeshFailure {
    /// The reason.
    pub message: String,
    /// The remedy.
    pub help: &'static str,
}

const FORMATS: &str = "export STL, OBJ or glTF (.stl, .obj, .gltf, .glb) from the CAD system";
const DAMAGED: &str = "export the mesh again";
const FEWER: &str = "export with a coarser tolerance: a picture needs some thousand triangles";

fn failure<T>(message: impl Into<String>, help: &'static str) -> Result<T, MeshFailure> {
    Err(MeshFailure { message: message.into(), help })
}

fn damaged<T>(message: impl Into<String>) -> Result<T, MeshFailure> {
    failure(message, DAMAGED)
}

/// Reads the mesh of a file, whose format its ending names.
pub fn read(path: &Path, files: &dyn Files) -> Result<Mesh, MeshFailure> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "stl" => checked(stl::read(&bytes(path, files)?)?),
        "obj" => checked(obj::read(&bytes(path, files)?, |name| bytes(&path.with_file_name(name), files))?),
        "gltf" | "glb" => checked(gltf::read(&bytes(path, files)?, |name| bytes(&path.with_file_name(name), files))?),
        "step" | "stp" | "iges" | "igs" => failure(
            "models of STEP and IGES are surfaces, not meshes",
            "convert it: open it in a CAD system (FreeCAD, for one) and export STL or glTF",
        ),
        _ => failure(format!("`.{ending}` is no format of meshes that is read"), FORMATS),
    }
}

fn bytes(path: &Path, files: &dyn Files) -> Result<Vec<u8>, MeshFailure> {
    files.read_at_most(path, MAX_BYTES).or_else(|reason| match reason {
        ReadFailure::NotFound => failure("there is no such file", "paths are relative to the file that names them"),
        ReadFailure::TooLarge(size, limit) => {
            failure(format!("the file has {} MB; the limit is {} MB", size.div_ceil(1 << 20), limit >> 20), FEWER)
        }
        ReadFailure::Outside(_) => failure("the file is outside the folder of --confined", "copy it into the folder"),
        ReadFailure::NotAFile(word) => failure(format!("it is {word}, not a file"), "name a regular file"),
        ReadFailure::Denied => failure("the file may not be read", "change its permissions"),
        ReadFailure::Other(words) => failure(words, "see whether the file can be read"),
    })
}

/// Returns a mesh that is drawable: some triangles, not too many, of finite points.
fn checked(mesh: Mesh) -> Result<Mesh, MeshFailure> {
    if mesh.count() == 0 {
        return failure("the file holds no triangle", FORMATS);
    }
    within(mesh.count())?;
    for (k, vertex) in mesh.surfaces.iter().flat_map(|surface| &surface.vertices).enumerate() {
        if !vertex.iter().all(|x| x.is_finite()) {
            return damaged(format!("a coordinate of vertex {} is not a finite number", k + 1));
        }
    }
    Ok(mesh)
}

/// Refuses more triangles than are drawn.
fn within(triangles: usize) -> Result<(), MeshFailure> {
    match triangles > MAX_TRIANGLES {
        true => failure(format!("more than {MAX_TRIANGLES} triangles"), FEWER),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::MemoryFiles;

    fn of(name: &str, bytes: impl Into<Vec<u8>>) -> Result<Mesh, MeshFailure> {
        read(Path::new(name), &MemoryFiles::new().with(name, bytes))
    }

    /// A binary STL of triangles.
    pub fn stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = [vec![0; 80], u32::try_from(triangles.len()).unwrap().to_le_bytes().to_vec()].concat();
        for triangle in triangles {
            let numbers = [0.0_f32; 3].iter().chain(triangle.iter().flatten()).flat_map(|x| x.to_le_bytes());
            bytes.extend(numbers.chain([0, 0]));
        }
        bytes
    }

    const CORNER: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

    #[test]
    fn stl_is_read_in_both_forms_and_refused_where_it_is_cut() {
        let binary = stl(&[CORNER, CORNER.map(|[x, y, _]| [x, y, 3.0])]);
        let mesh = of("a.STL", binary.clone()).unwrap();
        assert_eq!((mesh.count(), mesh.unit_mm, mesh.surfaces[0].vertices.len()), (2, 1.0, 6));
        assert_eq!(mesh.surfaces[0].vertices[2], [0.0, 2.0, 0.0]);
        let cut = of("a.stl", &binary[..150]).unwrap_err().message;
        assert!(cut.contains("promises 2 triangles") && cut.contains("holds 1"), "{cut}");
        let text =
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\n";
        assert_eq!(of("a.stl", format!("{text}endsolid a\n")).unwrap().count(), 1);
        assert!(of("a.stl", text).unwrap_err().message.contains("ends before"));
        let wrong = text.replace("1 0 0", "1 x 0") + "endsolid";
        assert!(of("a.stl", wrong).unwrap_err().message.contains("not a number"));
        // A head that promises four thousand million triangles takes no memory.
        let mut huge = stl(&[]);
        huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(of("a.stl", huge).unwrap_err().message.contains("promises"));
        for bad in [f32::NAN, f32::INFINITY] {
            assert!(of("a.stl", stl(&[[[bad; 3]; 3]])).unwrap_err().message.contains("not a finite number"));
        }
        assert!(of("a.stl", stl(&[])).unwrap_err().message.contains("no triangle"));
    }

    #[test]
    fn obj_fans_polygons_counts_from_the_end_and_takes_colours() {
        let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1/1/1 2//2 3 4\nusemtl none\n\
                    f -4 -3 -2\nl 1 2\n";
        let files = MemoryFiles::new().with("m/a.obj", text).with("m/a.mtl", "newmtl red\nKd 1 0 0\nmap_Kd a.png\n");
        let mesh = read(Path::new("m/a.obj"), &files).unwrap();
        assert_eq!(
            mesh.surfaces.iter().map(|of| (of.color, of.triangles.len())).collect::<Vec<_>>(),
            [(Some([1.0, 0.0, 0.0]), 2), (None, 1)]
        );
        assert_eq!(mesh.surfaces[1].vertices, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
        assert_eq!(mesh.ignored.iter().copied().collect::<Vec<_>>(), ["points and lines", "textures"]);
        for (wrong, words) in
            [("v 0 0\nf 1 1 1", "three numbers"), ("v 0 0 0\nf 1 1 2", "vertex 2 of 1"), ("f 0 0 0", "vertex 0")]
        {
            let message = of("a.obj", wrong).unwrap_err().message;
            assert!(message.contains(words), "{message}");
        }
        assert!(of("a.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap_err().message.contains("finite"));
    }

    /// A glTF of one triangle, its buffer in the file.
    fn gltf(change: impl Fn(&mut serde_json::Value)) -> Vec<u8> {
        use base64::Engine;
        let points: Vec<u8> = CORNER.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let uri = format!("data:application/octet-stream;base64,{}", base64::prelude::BASE64_STANDARD.encode(points));
        let mut root = serde_json::json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"children": [1], "translation": [10, 0, 0]}, {"mesh": 0, "scale": [2, 2, 2]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0, 1]}}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": uri}]
        });
        change(&mut root);
        root.to_string().into_bytes()
    }

    #[test]
    fn gltf_is_placed_by_its_nodes_in_metres_with_y_upwards() {
        let mesh = of("a.gltf", gltf(|_| ())).unwrap();
        assert_eq!((mesh.unit_mm, mesh.surfaces[0].color), (1000.0, Some([0.5, 0.25, 0.0])));
        // Twice as large, 10 aside, and turned so that its Y is Z.
        assert_eq!(mesh.surfaces[0].vertices, [[10.0, 0.0, 0.0], [12.0, 0.0, 0.0], [10.0, 0.0, 4.0]]);
        let json = gltf(|root| root["buffers"][0]["uri"] = serde_json::Value::Null);
        let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        let points: Vec<u8> = CORNER.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &points)] {
            glb.extend(u32::try_from(chunk.len()).unwrap().to_le_bytes());
            glb.extend(kind.iter().chain(chunk));
        }
        assert_eq!(of("a.glb", glb.clone()).unwrap().surfaces, mesh.surfaces);
        assert!(of("a.glb", &glb[..glb.len() - 8]).unwrap_err().message.contains("ends before"));
    }

    #[test]
    fn gltf_from_a_stranger_is_refused_by_name() {
        type Change = fn(&mut serde_json::Value);
        let cases: [(&str, Change); 9] = [
            ("loop", |root| root["nodes"][1]["children"] = serde_json::json!([0])),
            ("outside", |root| root["accessors"][0]["count"] = serde_json::json!(4_000_000_000_u64)),
            ("outside", |root| root["bufferViews"][0]["byteOffset"] = serde_json::json!(u64::MAX)),
            ("there is no", |root| root["nodes"][1]["mesh"] = serde_json::json!(7)),
            ("compressed", |root| root["extensionsRequired"] = serde_json::json!(["KHR_draco_mesh_compression"])),
            ("address", |root| root["buffers"][0]["uri"] = serde_json::json!("https://example.org/a.bin")),
            ("base64", |root| root["buffers"][0]["uri"] = serde_json::json!("data:;base64,****")),
            ("sparse", |root| root["accessors"][0]["sparse"] = serde_json::json!({})),
            ("whole numbers", |root| root["accessors"][0]["componentType"] = serde_json::json!(5122)),
        ];
        for (words, change) in cases {
            let message = of("a.gltf", gltf(change)).unwrap_err().message;
            assert!(message.contains(words), "{words}: {message}");
        }
        // Each of 40 nodes names the next one ten times: 10^40 triangles.
        let many = |root: &mut serde_json::Value| {
            let node = |k: usize| serde_json::json!({"children": vec![k + 1; 10]});
            let mut nodes: Vec<_> = (0..40).map(node).collect();
            nodes.push(serde_json::json!({"mesh": 0}));
            root["nodes"] = serde_json::json!(nodes);
        };
        assert!(of("a.gltf", gltf(many)).is_err());
        assert!(of("a.gltf", "{").unwrap_err().message.contains("glTF"));
        assert!(of("a.step", "ISO-10303-21;").unwrap_err().help.contains("convert"));
        assert!(of("a.png", "").is_err());
    }

    #[test]
    fn fewer_triangles_keep_the_extent() {
        let n = 60_usize;
        let point = |i: usize| {
            let angle = 2.0 * std::f64::consts::PI * i as f64 / n as f64;
            [libm::cos(angle), libm::sin(angle)]
        };
        let mut ball = Surface::default();
        for k in 0..=n {
            let [z, r] = point(k).map(|x| x.abs());
            for i in 0..n {
                let [x, y] = point(i);
                ball.vertices.push([100.0 * r * x, 100.0 * r * y, 100.0 * z]);
            }
        }
        for k in 0..n {
            for i in 0..n {
                let at = |k: usize, i: usize| u32::try_from(k * n + i % n).unwrap();
                ball.triangles
                    .extend([[at(k, i), at(k, i + 1), at(k + 1, i)], [at(k, i + 1), at(k + 1, i + 1), at(k + 1, i)]]);
            }
        }
        let all = vec![ball];
        assert_eq!(simplified(all.clone(), count(&all)), all);
        let few = simplified(all, 800);
        assert!(count(&few) <= 800 && count(&few) > 200, "{}", count(&few));
        let reach = few[0].vertices.iter().fold(0.0_f64, |reach, [x, _, _]| reach.max(x.abs()));
        assert!(reach > 85.0 && reach <= 100.0, "{reach}");
        assert!(count(&simplified(few, 0)) <= 12, "no mesh vanishes, and none keeps much");
    }
}
