//! `abbe identify --svg DIR`: prediction against data over the planes of the linear axes, one file each.

use super::session::Session;
use crate::cli::Outcome;
use crate::cli::store::write;
use crate::diagnostic::{Diagnostic, codes};
use crate::identify::{Measurement, Model, ReadingKind};
use crate::machine::AxisKind;
use crate::report::{FitPicture, FitPoint};
use std::path::Path;

/// Writes `fit-xy.svg` and so on, as many as there are pairs of linear axes with data.
pub(crate) fn write(
    session: &mut Session,
    model: &Model<'_>,
    data: &[Measurement],
    theta: &[f64],
    folder: &Path,
) -> Outcome {
    let Some(machine) = model.machines().first() else { return Ok(()) };
    let whole: Vec<&Measurement> =
        data.iter().filter(|m| m.kind() == ReadingKind::Deviation && m.readings() == 3).collect();
    // Axes along one of the letters x, y, z, with the component of the deviation that goes along them.
    let along = |i: usize| (0..3).find(|k| machine.axes()[i].direction[*k].abs() > 0.999);
    let linear: Vec<(usize, usize)> = (0..machine.axes().len())
        .filter(|i| machine.axes()[*i].kind == AxisKind::Linear)
        .filter_map(|i| along(i).map(|k| (i, k)))
        .collect();
    let mut planes: Vec<[(usize, usize); 2]> = Vec::new();
    for a in &linear {
        planes.extend(linear.iter().filter(|b| a.1 < b.1).map(|b| [*a, *b]));
    }
    if whole.is_empty() || planes.is_empty() {
        let help = "pictures need rows with dx, dy and dz, and two linear axes along x, y, z";
        return session.refuse(Diagnostic::new(codes::E0511, "there is no plane to draw").help(help));
    }
    write::make_folder(folder).or_else(|refusal| session.refuse(refusal))?;
    for plane in planes {
        let axes = plane.map(|(i, _)| machine.axes()[i].name.to_string());
        let (slice, points) = slice(model, &whole, theta, plane);
        let picture = FitPicture { machine: machine.name(), axes: [&axes[0], &axes[1]], slice, points };
        let path = folder.join(format!("fit-{}{}.svg", axes[0].to_lowercase(), axes[1].to_lowercase()));
        let written = write::refuse_input(&path, &session.diagnostics.sources)
            .and_then(|()| write::write_whole(&path, picture.svg().as_bytes()));
        if let Err(refusal) = written {
            return session.refuse(refusal);
        }
    }
    Ok(())
}

/// Points of the slice across the third direction that is best filled and nearest to the middle, and its words.
fn slice(
    model: &Model<'_>,
    data: &[&Measurement],
    theta: &[f64],
    plane: [(usize, usize); 2],
) -> (String, Vec<FitPoint>) {
    let Some(machine) = model.machines().first() else { return (String::new(), Vec::new()) };
    let others: Vec<usize> = (0..machine.axes().len()).filter(|i| *i != plane[0].0 && *i != plane[1].0).collect();
    let key = |m: &Measurement| others.iter().map(|i| m.pose[*i].to_bits()).collect::<Vec<u64>>();
    let mut groups: indexmap::IndexMap<Vec<u64>, Vec<&Measurement>> = indexmap::IndexMap::new();
    data.iter().for_each(|m| groups.entry(key(m)).or_default().push(m));
    let most = groups.values().map(Vec::len).max().unwrap_or(0);
    // Scattered poses have no slices: all of them are drawn.
    let full: Vec<&Vec<&Measurement>> = groups.values().filter(|g| g.len() == most && most >= 4).collect();
    let mut sorted = full.clone();
    let place = |g: &Vec<&Measurement>| others.iter().map(|i| g[0].pose[*i]).collect::<Vec<f64>>();
    sorted.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
    let (words, rows): (String, Vec<&Measurement>) = match sorted.get(sorted.len() / 2) {
        Some(group) => {
            let at = others.iter().zip(place(group)).map(|(i, q)| {
                let axis = &machine.axes()[*i];
                format!("{} = {} {}", axis.name, crate::units::significant(q, 6), axis.unit())
            });
            (at.collect::<Vec<_>>().join(", "), (*group).clone())
        }
        None => ("all poses".to_owned(), data.to_vec()),
    };
    let point = |m: &&Measurement| {
        let (read, said) = (m.values(), model.predicted(m, theta));
        let of = |v: &nalgebra::Vector3<f64>| (v[plane[0].1], v[plane[1].1]);
        FitPoint { nominal: (m.pose[plane[0].0], m.pose[plane[1].0]), measured: of(&read), predicted: of(&said) }
    };
    (words, rows.iter().map(point).collect())
}
