//! What `abbe identify --method moore-penrose` prints.

use crate::identify::{Coefficient, Component};
use crate::units::significant;
use serde_json::json;

fn name(component: &Component) -> &'static str {
    ["dx", "dy", "dz"][component.index.min(2)]
}

pub(crate) fn json(components: &[Component]) -> serde_json::Value {
    let coefficient =
        |c: &Coefficient| json!({"monomial": c.name, "value": c.value, "unit": c.unit, "determined": c.determined});
    let one = |c: &Component| {
        json!({
            "component": name(c), "readings": c.readings, "columns": c.coefficients.len(), "rank": c.rank,
            "rms_um": {"before": c.rms[0] * 1e3, "after": c.rms[1] * 1e3},
            "coefficients": c.coefficients.iter().map(coefficient).collect::<Vec<_>>(),
        })
    };
    json!({"method": "moore-penrose", "order": 2, "components": components.iter().map(one).collect::<Vec<_>>()})
}

pub(crate) fn csv(components: &[Component]) -> String {
    let row =
        |c: &Component, k: &Coefficient| format!("{},{},{},{},{}", name(c), k.name, k.value, k.unit, k.determined);
    let rows = components.iter().flat_map(|c| c.coefficients.iter().map(move |k| row(c, k)));
    std::iter::once("component,monomial,value,unit,determined".to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
}

pub(crate) fn text(machine: &str, components: &[Component]) -> String {
    let mut text = format!("{machine}: monomials of order 2, each component for itself\n");
    for c in components {
        let columns = c.coefficients.len();
        text += &format!(
            "{}: rank {} of {columns} monomials from {} readings, {} um before, {} um after\n",
            name(c),
            c.rank,
            c.readings,
            significant(c.rms[0] * 1e3, 4),
            significant(c.rms[1] * 1e3, 4)
        );
        if c.rank < columns {
            let free = columns - c.rank;
            text += &format!(
                "    {free} combinations of them change nothing: of all answers this is the shortest (mm, rad)\n"
            );
        }
        let mut table = comfy_table::Table::new();
        let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
        let _ = table.set_header(["monomial", "coefficient", "unit", "told from others"]);
        for k in &c.coefficients {
            let told = if k.determined { "yes" } else { "no" };
            let _ = table.add_row([k.name.clone(), significant(k.value, 4), k.unit.clone(), told.to_owned()]);
        }
        text += &format!("{table}\n");
    }
    text
}
