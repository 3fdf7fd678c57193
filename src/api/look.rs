//! The meshes that a machine is drawn by.

use super::show::drawn_meshes;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::job::machine_file::MachineFile;
use crate::machine::{BodyMesh, rotation_of};
use crate::mesh::{self, Mesh, Surface};
use crate::run::{Call, Reply, Run};
use crate::units::{FARTHEST, counted};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::Vector3;

/// Options of the meshes that a machine is drawn by.
#[derive(Debug, Clone, PartialEq, Eq, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LookOptions {
    /// Maximum number of triangles of all bodies; meshes of more are simplified.
    pub max_triangles: usize,
}

impl LookOptions {
    /// Maximum number of triangles that may be asked for.
    pub const MAX: usize = 200_000;
}

impl Default for LookOptions {
    fn default() -> Self {
        Self { max_triangles: 100_000 }
    }
}

/// Bodies of a machine as triangles.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct LookResult {
    /// Surfaces of bodies; a body has one for each of its colours.
    pub bodies: Vec<BodySurface>,
    /// Number of triangles in the files that are drawn.
    pub triangles: usize,
    /// Number of triangles of `bodies`.
    pub drawn: usize,
}

/// A surface of a body: in the workpiece frame for `workpiece`, else in machine coordinates at the zero pose.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BodySurface {
    /// `bed`, `workpiece`, `tool`, or the name of an axis.
    pub body: String,
    /// Red, green and blue in linear light, 0 to 1; null where the file states no colour.
    pub color: Option<[f64; 3]>,
    /// X, Y and Z of each vertex, mm: little-endian numbers of 32 bits in base64.
    pub positions: String,
    /// Numbers of the three vertices of each triangle: little-endian whole numbers of 32 bits in base64.
    pub indices: String,
}

/// Returns the meshes that the file of a machine names, at most `max_triangles` triangles in all. A mesh that cannot be
/// drawn is a warning.
pub(crate) fn look(machine: &MachineFile, options: &LookOptions, run: Run) -> Reply<LookResult> {
    Call::answer(run, machine.sources(), |call| {
        let read: Vec<(&BodyMesh, Mesh)> =
            drawn_meshes(machine).filter_map(|of| Some((of, placed(of, call)?))).collect();
        let triangles: usize = read.iter().map(|(_, mesh)| mesh.count()).sum();
        let max = options.max_triangles.min(LookOptions::MAX);
        let surfaces = read.into_iter().flat_map(|(of, mesh)| {
            // As many of each mesh as its part of all.
            let own = max as u128 * mesh.count() as u128 / triangles.max(1) as u128;
            let welded = mesh.surfaces.iter().map(|surface| mesh::clustered(surface, [0.0; 3], 0.0)).collect();
            let own = if triangles <= max { usize::MAX } else { own as usize };
            mesh::simplified(welded, own).into_iter().map(|surface| (of.body.clone(), surface))
        });
        let bodies: Vec<(String, Surface)> = surfaces.collect();
        let drawn = bodies.iter().map(|(_, surface)| surface.triangles.len()).sum();
        Ok(LookResult {
            bodies: bodies.into_iter().map(|(body, surface)| packed(body, &surface)).collect(),
            triangles,
            drawn,
        })
    })
}

/// Returns a mesh where it stands; warns if it cannot be drawn, and of parts that are not.
fn placed(of: &BodyMesh, call: &mut Call<'_>) -> Option<Mesh> {
    let file = shown(&of.path.display().to_string());
    let warning = |code, message: String| Diagnostic::new(code, message).at(of.place.clone(), "");
    let mut mesh = match mesh::read(&of.path, call.run.files) {
        Ok(mesh) => mesh,
        Err(failure) => {
            let message = format!("`{file}` is not drawn: {}", shown(&failure.message));
            call.warn(warning(codes::W0853, message).help(failure.help));
            return None;
        }
    };
    let (unit, turn) = (of.unit_mm.unwrap_or(mesh.unit_mm), rotation_of(of.rotation));
    let vertices = mesh.surfaces.iter_mut().flat_map(|surface| &mut surface.vertices);
    let mut far = 0.0_f64;
    for vertex in vertices {
        let at = turn * Vector3::from(*vertex) * unit + Vector3::from(of.origin);
        far = far.max(at.amax());
        *vertex = at.into();
    }
    if far > FARTHEST {
        let message = format!("`{file}` is not drawn: it reaches {far:.1e} mm from the origin");
        call.warn(warning(codes::W0853, message).help("state its unit, such as `{ mesh: ram.stl, unit: um }`"));
        return None;
    }
    if !mesh.ignored.is_empty() {
        let parts = mesh.ignored.iter().copied().collect::<Vec<_>>().join(", ");
        let help = "geometry and colours are drawn; nothing else is needed";
        call.warn(warning(codes::W0854, format!("of `{file}` are left out: {parts}")).help(help));
    }
    Some(mesh)
}

fn packed(body: String, surface: &Surface) -> BodySurface {
    let positions: Vec<u8> = surface.vertices.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    let indices: Vec<u8> = surface.triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect();
    let [positions, indices] = [positions, indices].map(|bytes| BASE64_STANDARD.encode(bytes));
    BodySurface { body, color: surface.color, positions, indices }
}

impl LookResult {
    /// Returns a sentence on the triangles; none without meshes.
    pub fn words(&self) -> Option<String> {
        let Self { triangles, drawn, .. } = self;
        let simplified = if drawn < triangles { format!(", simplified from {triangles}") } else { String::new() };
        (*drawn > 0).then(|| format!("meshes of {}{simplified}", counted(*drawn, "triangle")))
    }
}
