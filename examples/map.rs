//! Maps a machine written as text, every pose as a row of CSV in memory, and prints the worst pose.

#![allow(clippy::print_stdout, reason = "an example prints")]

use abbe::options::{MapPoses, MapTable, TableForm};
use abbe::{Diagnostics, LoadOptions, MapOptions, Run};

const MACHINE: &str = r#"
abbe: 1
machine: Gantry
chain: "w b X Y Z t"
axes:
  X: { travel: [0 mm, 400 mm] }
  Y: { travel: [0 mm, 300 mm] }
  Z: { travel: [-200 mm, 0 mm] }
tool: { length: 100 mm }
errors:
  EC0Y: 10 urad
  EA0Z: -20 urad
"#;

/// Returns the table.
pub fn table() -> Result<String, Diagnostics> {
    let machine = abbe::loads(MACHINE, &LoadOptions::default(), Run::default())?;
    let options = MapOptions { poses: MapPoses::LowDiscrepancy(1000), ..MapOptions::default() };
    let mut rows = Vec::new();
    let csv =
        MapTable { name: "rows".to_owned(), form: TableForm::Csv, sink: Box::new(std::io::Cursor::new(&mut rows)) };
    let map = abbe::map_tables(&machine, &options, vec![csv], Run::default())?;
    let worst = &map.worst[0];
    let pose: Vec<String> = worst.axes.iter().map(|(axis, at)| format!("{axis} {at:.0} mm")).collect();
    let (pose, length, p95) = (pose.join(", "), worst.length_um, map.position_um.p95);
    println!("worst: {length:.2} um at {pose}; 95 % lie below {p95:.2} um");
    Ok(String::from_utf8_lossy(&rows).into_owned())
}

/// Prints the first rows.
pub fn main() -> Result<(), Diagnostics> {
    table()?.lines().take(4).for_each(|row| println!("{row}"));
    Ok(())
}
