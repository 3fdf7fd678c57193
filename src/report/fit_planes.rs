//! Prediction against data over the planes of the linear axes.

use crate::diagnostic::{Diagnostic, codes};
use crate::identify::verdict::result::NamedSvg;
use crate::identify::{COMPONENTS, FitModel, Measurement, MonomialComponent, ReadingKind};
use crate::machine::AxisKind;
use crate::report::{FitPicture, FitPoint};
use crate::units::significant;
use indexmap::IndexMap;
use nalgebra::Vector3;

/// An axis by its index, with the component of the deviation that goes along it.
type PlaneAxis = (usize, usize);

/// Draws `fit-xy.svg` and so on, one for each pair of linear axes.
pub(crate) fn draw(model: &FitModel<'_>, data: &[Measurement], theta: &[f64]) -> Result<Vec<NamedSvg>, Diagnostic> {
    draw_fitted(model, data, &|row| model.prediction(&data[row], theta))
}

/// Draws the same of a fit of monomials, component by component.
pub(crate) fn draw_monomials(
    model: &FitModel<'_>,
    data: &[Measurement],
    components: &[MonomialComponent],
) -> Result<Vec<NamedSvg>, Diagnostic> {
    let mut fitted = vec![Vector3::zeros(); data.len()];
    for component in components {
        let k = COMPONENTS.iter().position(|name| *name == component.component).unwrap_or_default();
        component.fitted.iter().for_each(|(row, value)| fitted[*row][k] = *value);
    }
    draw_fitted(model, data, &|row| fitted[row])
}

/// Draws rows beside what a fit says of them (mm).
fn draw_fitted(
    model: &FitModel<'_>,
    data: &[Measurement],
    fitted: &dyn Fn(usize) -> Vector3<f64>,
) -> Result<Vec<NamedSvg>, Diagnostic> {
    let Some(machine) = model.machines().first() else { return Ok(Vec::new()) };
    let is_whole = |m: &Measurement| m.kind() == ReadingKind::Deviation && m.readings() == 3;
    let whole: Vec<(usize, &Measurement)> = data.iter().enumerate().filter(|(_, m)| is_whole(m)).collect();
    let planes = planes(model);
    if whole.is_empty() || planes.is_empty() {
        let help = "pictures need rows with dx, dy and dz, and two linear axes along x, y, z";
        return Err(Diagnostic::new(codes::E0511, "there is no plane to draw").help(help));
    }
    let one = |plane: [PlaneAxis; 2]| {
        let axes = plane.map(|(i, _)| machine.axes()[i].name.to_string());
        let (slice, points) = slice(model, &whole, fitted, plane);
        let picture = FitPicture { machine: machine.name(), axes: [&axes[0], &axes[1]], slice, points };
        let name = format!("fit-{}{}.svg", axes[0].to_lowercase(), axes[1].to_lowercase());
        NamedSvg { name, svg: picture.svg() }
    };
    Ok(planes.into_iter().map(one).collect())
}

/// Pairs of linear axes along two of the letters x, y, z.
fn planes(model: &FitModel<'_>) -> Vec<[PlaneAxis; 2]> {
    let axes = model.machines().first().map_or(&[][..], |machine| machine.axes());
    let along = |i: usize| (0..3).find(|k| axes[i].direction[*k].abs() > 0.999);
    let linear: Vec<PlaneAxis> = (0..axes.len())
        .filter(|i| axes[*i].kind == AxisKind::Linear)
        .filter_map(|i| along(i).map(|k| (i, k)))
        .collect();
    let pairs = linear.iter().flat_map(|a| linear.iter().filter(|b| a.1 < b.1).map(|b| [*a, *b]));
    pairs.collect()
}

/// Points of the slice across the third direction that is best filled and nearest to the middle, and its words.
fn slice(
    model: &FitModel<'_>,
    data: &[(usize, &Measurement)],
    fitted: &dyn Fn(usize) -> Vector3<f64>,
    plane: [PlaneAxis; 2],
) -> (String, Vec<FitPoint>) {
    let (words, rows) = fullest(model, data, plane);
    let point = |(row, m): &(usize, &Measurement)| {
        let (measured, predicted) = (m.values(), fitted(*row));
        let within = |v: &Vector3<f64>| (v[plane[0].1], v[plane[1].1]);
        FitPoint {
            nominal: (m.pose[plane[0].0], m.pose[plane[1].0]),
            measured: within(&measured),
            predicted: within(&predicted),
        }
    };
    (words, rows.iter().map(point).collect())
}

fn fullest<'a>(
    model: &FitModel<'_>,
    data: &[(usize, &'a Measurement)],
    plane: [PlaneAxis; 2],
) -> (String, Vec<(usize, &'a Measurement)>) {
    let axes = model.machines().first().map_or(&[][..], |machine| machine.axes());
    let others: Vec<usize> = (0..axes.len()).filter(|i| *i != plane[0].0 && *i != plane[1].0).collect();
    let key = |m: &Measurement| others.iter().map(|i| m.pose[*i].to_bits()).collect::<Vec<u64>>();
    let mut groups: IndexMap<Vec<u64>, Vec<(usize, &Measurement)>> = IndexMap::new();
    data.iter().for_each(|row| groups.entry(key(row.1)).or_default().push(*row));
    let largest = groups.values().map(Vec::len).max().unwrap_or(0);
    // Scattered poses have no slices: all of them are drawn.
    let mut full: Vec<&Vec<(usize, &Measurement)>> =
        groups.values().filter(|g| g.len() == largest && largest >= 4).collect();
    let place = |g: &Vec<(usize, &Measurement)>| others.iter().map(|i| g[0].1.pose[*i]).collect::<Vec<f64>>();
    full.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
    let Some(group) = full.get(full.len() / 2) else { return ("all poses".to_owned(), data.to_vec()) };
    let at = others
        .iter()
        .zip(place(group))
        .map(|(i, q)| format!("{} = {} {}", axes[*i].name, significant(q, 6), axes[*i].unit()));
    (at.collect::<Vec<_>>().join(", "), (*group).clone())
}
