//! The result of `abbe identify --method moore-penrose` as text and CSV.

use super::view::table;
use abbe::results::{MonomialCoefficient, MonomialComponent, MonomialFit};
use abbe::text::significant;

pub(crate) fn csv(fit: &MonomialFit) -> String {
    let row = |c: &MonomialComponent, k: &MonomialCoefficient| {
        let sigma = k.sigma.map_or_else(String::new, |sigma| sigma.to_string());
        format!("{},{},{},{sigma},{},{}", c.component, k.monomial, k.value, k.unit, k.determined)
    };
    let rows = fit.components.iter().flat_map(|c| c.coefficients.iter().map(move |k| row(c, k)));
    std::iter::once("component,monomial,value,sigma,unit,determined".to_owned())
        .chain(rows)
        .collect::<Vec<_>>()
        .join("\n")
}

pub(crate) fn text(fit: &MonomialFit) -> String {
    let mut text = format!("{}: monomials of order {}, each component for itself\n", fit.machine, fit.order);
    fit.components.iter().for_each(|component| text += &one(component));
    text
}

fn one(c: &MonomialComponent) -> String {
    let [before, after] = [c.rms_um.before, c.rms_um.after].map(|rms| significant(rms, 4));
    let mut text = format!(
        "{}: rank {} of {} monomials from {} readings, {before} um before, {after} um after\n",
        c.component, c.rank, c.columns, c.readings,
    );
    if c.rank < c.columns {
        let free = c.columns - c.rank;
        text +=
            &format!("    {free} combinations of them change nothing: of all answers this is the shortest (mm, rad)\n");
    }
    let mut rows = table(&["monomial", "coefficient", "sigma", "unit", "told from others"]);
    for k in &c.coefficients {
        let determined = if k.determined { "yes" } else { "no" };
        let sigma = k.sigma.map_or_else(|| "-".to_owned(), |sigma| significant(sigma, 2));
        let cells = [k.monomial.clone(), significant(k.value, 4), sigma, k.unit.clone(), determined.to_owned()];
        let _ = rows.add_row(cells);
    }
    text + &format!("{rows}\n")
}
