//! What the next basis of an error would take off the residuals: which error is bent.

use super::form::{FormBlock, FormedAxis};
use crate::algebra::linear::Svd;
use crate::identify::model::{BasisFunction, FitModel, Parameter, ParameterTerm};
use crate::identify::thresholds::*;
use crate::machine::{AxisKind, ErrorId, Travel};
use nalgebra::{DMatrix, DVector};

/// What a richer curve of an error would take off the residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct Bend {
    /// The error.
    pub error: ErrorId,
    /// Largest less smallest value (mm, rad) of what the curve would add to it, over the positions measured.
    pub size: f64,
    /// Share of the residual sum of squares that it would take off.
    pub share: f64,
    /// The curve, such as `poly3`.
    pub basis: String,
    /// True if the fit takes the curve for this error in place of what it has, or beside it.
    pub is_free: bool,
}

/// Returns the errors that the next basis bends beyond chance (F test), the one first that takes most off; `left` are
/// the sums over knots and residual (last) without the part that the unknowns follow.
pub(super) fn bends(
    model: &FitModel<'_>,
    axes: &[FormedAxis],
    left: &DMatrix<f64>,
    degrees_of_freedom: f64,
) -> Vec<Bend> {
    let blocks = axes.iter().flat_map(|axis| axis.blocks.iter().map(move |block| (axis.kind, block)));
    let one = |(kind, block): (AxisKind, &FormBlock)| bend(model, kind, block, left, degrees_of_freedom);
    let mut found: Vec<Bend> = blocks.filter_map(one).collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found.truncate(MAX_BENDS);
    found
}

fn bend(
    model: &FitModel<'_>,
    kind: AxisKind,
    block: &FormBlock,
    left: &DMatrix<f64>,
    degrees_of_freedom: f64,
) -> Option<Bend> {
    let machine = model.machines().first()?;
    let parameters = model.parameters();
    let terms: Vec<&ParameterTerm> =
        parameters.iter().flat_map(|p| &p.terms).filter(|term| term.source == block.source).collect();
    let error = block.source.error(machine)?;
    let turns = machine.axes()[machine.axis_index(error.axis.as_str())?].travel == Travel::Continuous;
    let (basis, functions) = next_basis(kind, turns, block, &terms)?;
    let functions = block.beside_curve(&functions);
    let normal = functions.tr_mul(&block.own(left)) * &functions;
    let last = left.ncols() - 1;
    let along = functions.tr_mul(&left.view((block.first, last), (functions.nrows(), 1)).column(0));
    let svd = Svd::new(&normal);
    let rank = svd.rank(BEND_RANK_TOLERANCE);
    let amounts: DVector<f64> = svd.solve(&along, rank);
    let (all, removed) = (left[(last, last)], amounts.dot(&along));
    let rest = (all - removed).max(f64::MIN_POSITIVE) / (degrees_of_freedom - rank as f64).max(1.0);
    if rank == 0 || removed <= MIN_BEND_RATIO * rank as f64 * rest || removed < MIN_BEND_SHARE * all {
        return None;
    }
    let curve = functions * amounts;
    // Of a sum such as those of `linear` an error is one part: the first leads, and is held to its curve.
    let leads = |p: &Parameter| p.terms.len() > 1 && p.terms.first().is_some_and(|t| t.source == block.source);
    let is_free = !parameters.iter().any(leads) && !parameters.iter().any(|p| is_slope(p, block));
    Some(Bend { error, size: curve.max() - curve.min(), share: removed / all, basis, is_free })
}

/// True if an error is held to a slope by `linear`.
fn is_slope(parameter: &Parameter, block: &FormBlock) -> bool {
    let main = parameter.terms.first().is_some_and(|term| term.source == block.source);
    main && parameter.name.ends_with(":slope")
}

/// Returns the next basis of an error with the values of its functions at the knots (columns); `None` beyond curves
/// that follow everything, such as splines.
fn next_basis(
    kind: AxisKind,
    turns: bool,
    block: &FormBlock,
    terms: &[&ParameterTerm],
) -> Option<(String, DMatrix<f64>)> {
    let interval = block.interval;
    let order = |term: &&ParameterTerm| match term.basis {
        BasisFunction::Constant => Some(0),
        BasisFunction::Power(k) | BasisFunction::Cosine(k) | BasisFunction::Sine(k) => Some(k),
        BasisFunction::Spline(_) => None,
    };
    let orders: Option<Vec<u8>> = terms.iter().map(order).collect();
    let highest = orders?.into_iter().max();
    let by_harmonics = kind == AxisKind::Rotary
        && (turns || terms.iter().any(|t| matches!(t.basis, BasisFunction::Cosine(_) | BasisFunction::Sine(_))));
    if by_harmonics {
        let next = highest.map_or(2, |k| k + 2);
        let value = |i: usize, j: usize| {
            let order = (j / 2 + 1) as u8;
            let basis = if j.is_multiple_of(2) { BasisFunction::Cosine(order) } else { BasisFunction::Sine(order) };
            basis.value(interval.knot(i))
        };
        return Some((format!("fourier{next}"), DMatrix::from_fn(interval.count, 2 * usize::from(next), value)));
    }
    let next = highest.map_or(3, |k| if k < 3 { 3 } else { k + 2 });
    // Chebyshev's polynomials: powers of the position are almost the same.
    let value = |i: usize, j: usize| libm::cos(j as f64 * libm::acos(interval.relative(i).clamp(-1.0, 1.0)));
    Some((format!("poly{next}"), DMatrix::from_fn(interval.count, usize::from(next) + 1, value)))
}
