//! The rows of a work as the page plays them: the deviation across and along the surface, and the axes that make it,
//! against a closed form.

use serde_json::{Value, json};

/// Y leans by 20 urad towards -X, Z by 5 urad towards +X; the zero of the part is its origin.
const MACHINE: &str = "abbe: 1
machine: M
chain: w b X Y Z t
axes:
  X: { travel: [0, 400], origin: [0, 0, 0] }
  Y: { travel: [0, 400], origin: [0, 0, 0] }
  Z: { travel: [0, 400], origin: [0, 0, 0] }
job: { tool_poses: w.csv }
";

fn played(errors: &str, rows: &str) -> Value {
    let texts = json!({"m.yaml": format!("{MACHINE}{errors}"), "w.csv": rows});
    let request = json!({"machine": "m.yaml", "texts": texts, "questions": [{"work": {}}]});
    let found = abbe::workbench(&request.to_string(), abbe::Run::default());
    assert!(found["answers"][0]["map"].is_object(), "{found}");
    found["answers"][0]["played"].clone()
}

fn near(value: &Value, truth: f64) {
    let value = value.as_f64().unwrap();
    // The closed form is of first order: 100 mm times half the square of 20 urad are 2e-5 um.
    assert!((value - truth).abs() < 3e-5, "{value} for {truth}");
}

#[test]
fn a_row_says_how_it_misses_the_surface_and_by_which_axes() {
    let errors = "errors: { EC0Y: 20 urad, EB0Z: 5 urad }\n";
    let stated = "X,Y,Z,nx,ny,nz\n0,0,0,0,0,1\n0,100,100,0.6,0.8,0\n0,100,100,-1,0,0\n";
    let rows = played(errors, stated);
    let lines: Vec<_> = rows.as_array().unwrap().iter().map(|row| row["line"].as_u64().unwrap()).collect();
    assert_eq!(lines, [2, 3, 4]);
    // Y makes -2 um of X, Z +0.5: together -1.5, and along that 2 and -0.5.
    for (row, across, along) in [(1, -0.9, 1.2), (2, 1.5, 0.0)] {
        let row = &rows[row];
        near(&row["across_um"], across);
        near(&row["along_um"], along);
        assert_eq!(row["has_normal"], true);
        let axes: Vec<_> = row["axes"].as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(axes, ["Y", "Z"]);
        near(&row["axes"]["Y"], 2.0);
        near(&row["axes"]["Z"], -0.5);
    }
    near(&rows[0]["along_um"], 0.0);
    // Without normals the tool, which stands along Z, is one.
    let plain = played(errors, "X,Y,Z\n0,0,0\n0,100,100\n");
    assert_eq!(plain[1]["has_normal"], false);
    near(&plain[1]["across_um"], 0.0);
    near(&plain[1]["along_um"], 1.5);
}

#[test]
fn bounds_have_no_direction() {
    assert_eq!(played("tolerances: { EC0Y: 20 urad }\n", "X,Y,Z\n0,0,0\n0,100,0\n"), json!([]));
}
