//! The files of a test piece: a job with its table of tool poses.

use super::path::{PathPoint, Piece, PieceTolerance};
use nalgebra::Vector3;
use std::fmt::Write as _;

/// Returns the job file and the table.
pub(super) fn files(name: &str, piece: &Piece) -> Vec<(String, Vec<u8>)> {
    let table = format!("{name}.csv");
    vec![(format!("{name}.yaml"), job(&table, piece).into_bytes()), (table, poses(piece).into_bytes())]
}

fn job(table: &str, piece: &Piece) -> String {
    let mut text = commented(&piece.title);
    piece.notes.iter().for_each(|note| text.push_str(&commented(note)));
    let place = "# Where the part lies on the workpiece frame, mm and deg about X, Y, Z: state it.\n\
                 place: { origin: [0, 0, 0], rotation: [0, 0, 0] }";
    // Writing to a string cannot fail.
    let path = !piece.are_single;
    let reference = match piece.zero {
        Some(at) => format!("{{ kind: zero, point: [{}, {}, {}] }}", at.x, at.y, at.z),
        None => "zero".to_owned(),
    };
    let _ = write!(text, "tool_poses: {table}\npath: {path}\n{place}\nreference: {reference}\n");
    text.push_str(if piece.features.is_empty() { "" } else { "features:\n" });
    for (i, of) in piece.features.iter().enumerate() {
        if i == 0 || piece.features[i - 1].name != of.name {
            let _ = writeln!(text, "  {}:", of.name);
        }
        text.push_str(&tolerance(of));
    }
    text
}

/// A note as comments of at most 100 columns.
fn commented(note: &str) -> String {
    let mut lines = vec![String::from("#")];
    for word in note.split_whitespace() {
        if lines.last().is_some_and(|line| line.len() + word.len() > 98) {
            lines.push(String::from("#"));
        }
        if let Some(line) = lines.last_mut() {
            line.push(' ');
            line.push_str(word);
        }
    }
    let mut text = lines.join("\n");
    text.push_str(".\n");
    text
}

fn tolerance(of: &PieceTolerance) -> String {
    let datum = of.datum.as_ref().map_or(String::new(), |datum| format!(", datum: {datum}"));
    format!("    - {{ kind: {}, tolerance: {} um{datum} }}\n", of.kind.name(), of.um)
}

/// The letters of a vector with a number of decimals.
fn cells(of: &Vector3<f64>, decimals: i32) -> String {
    let scale = libm::exp10(f64::from(decimals));
    // Adding zero turns -0 into 0.
    let letters = of.map(|x| (x * scale).round() / scale + 0.0);
    let digits = decimals.unsigned_abs() as usize;
    format!("{:.digits$},{:.digits$},{:.digits$}", letters.x, letters.y, letters.z)
}

fn poses(piece: &Piece) -> String {
    let mut text = "X [mm],Y [mm],Z [mm],I,J,K,NX,NY,NZ,feature\n".to_owned();
    for PathPoint { tip, axis, normal, feature } in &piece.points {
        let [tip, axis, normal] = [cells(tip, 6), cells(axis, 12), cells(normal, 12)];
        let _ = writeln!(text, "{tip},{axis},{normal},{}", piece.names[*feature]);
    }
    text
}
