//! `up` and `look`: what the picture of a machine takes from its file.

use super::axes::direction;
use super::context::Context;
use super::parts::rotation;
use crate::diagnostic::{Diagnostics, codes, did_you_mean, shown};
use crate::machine::{BodyMesh, Look};
use crate::syntax::{Document, Files, MeshEntry, below, keys};
use crate::units::{self, Dimension};

/// Bodies beside those of axes.
const BODIES: [&str; 3] = ["bed", "workpiece", "tool"];

/// Returns what a document says of the picture.
pub fn look(document: &Document, files: &dyn Files, diagnostics: &mut Diagnostics) -> Look {
    let context = &mut Context::new(document, files, diagnostics);
    let up = document.up.as_ref().and_then(|list| direction(context, "`up`", list, &keys(["up"])));
    let meshes = document.look.iter().filter_map(|(body, entry)| mesh(context, body, entry.as_ref()?)).collect();
    Look { up, meshes }
}

fn mesh(context: &mut Context, body: &str, entry: &MeshEntry) -> Option<BodyMesh> {
    let at = keys(["look", body]);
    let document = context.document;
    if !BODIES.contains(&body) && !document.axes.contains_key(body) {
        let known: Vec<&str> = BODIES.into_iter().chain(document.axes.keys().map(String::as_str)).collect();
        let message = format!("`{}` is no body of this machine", shown(body));
        context.at_key(codes::E0201, &at, message, did_you_mean(body, &known));
        return None;
    }
    let Some(file) = entry.mesh.as_ref().filter(|file| !file.trim().is_empty()) else {
        context.at_key(
            codes::E0203,
            &at,
            format!("`look.{}` names no mesh", shown(body)),
            "write `look: { X: ram.stl }`, or `{ mesh: ram.stl, unit: m, origin: [0, 0, 0], rotation: { A: 90 } }`",
        );
        return None;
    };
    let origin = entry.origin.as_ref().map_or(Some([0.0; 3]), |list| context.vector(list, &below(&at, "origin")));
    let rotation = rotation(context, &entry.rotation, &below(&at, "rotation"));
    let unit_mm = match &entry.unit {
        Some(unit) => Some(unit_of(context, unit, &below(&at, "unit"))?),
        None => None,
    };
    let named = below(&at, "mesh");
    let named = if document.places.has(&named) { named } else { at };
    let (path, place) = (document.places.resolve_path(&named, file), document.places.value(&named));
    Some(BodyMesh { body: body.to_owned(), path, unit_mm, origin: origin?, rotation, place })
}

/// Returns a unit of length, mm.
fn unit_of(context: &mut Context, unit: &str, at: &crate::syntax::Keys) -> Option<f64> {
    let length = units::quantity(&format!("1 {unit}")).ok().filter(|of| of.dimension == Dimension::LENGTH);
    if length.is_none() {
        let message = format!("`{}` is no unit of length", shown(unit));
        context.at_value(codes::E0206, at, message, "write nm, um, mm, cm, m or in");
    }
    length.map(|of| of.value)
}
