//! Fits the squareness of Y to X to measured deviations, all from text.

#![allow(clippy::print_stdout, reason = "an example prints")]

use abbe::results::IdentifyResult;
use abbe::{Diagnostics, IdentifyOptions, LoadOptions, Run};

const MACHINE: &str = r#"
abbe: 1
machine: Gantry
chain: "w b X Y Z t"
axes:
  X: { travel: [0 mm, 400 mm] }
  Y: { travel: [0 mm, 400 mm] }
  Z: { travel: [-300 mm, 0 mm] }
tool: { length: 100 mm }
"#;

const MEASURED: &str = "\
X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um]
0,0,0,0.1,0.0,-0.1
400,200,0,-9.9,0.1,0.1
0,400,0,-20.1,-0.1,0.0
";

/// Returns the fit, with the fitted machine file.
pub fn fit() -> Result<IdentifyResult, Diagnostics> {
    let machine = abbe::loads(MACHINE, &LoadOptions::default(), Run::default())?;
    let options = IdentifyOptions {
        texts: vec![("measured.csv".to_owned(), MEASURED.to_owned())],
        fit: vec!["EC0Y".to_owned()],
        machine_file: true,
        ..IdentifyOptions::default()
    };
    Ok(abbe::identify(&machine, &options, Run::default())?.value)
}

/// Prints the parameters with their standard uncertainty, then the fitted machine file.
pub fn main() -> Result<(), Diagnostics> {
    let fit = fit()?;
    for parameter in &fit.parameters {
        println!("{} = {:.2} {}, sigma {:.2?}", parameter.name, parameter.value, parameter.unit, parameter.sigma);
    }
    println!("{}", fit.machine_file.unwrap_or_default());
    Ok(())
}
