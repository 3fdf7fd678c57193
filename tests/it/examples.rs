//! The programs in examples/ run, and do as their heads state.

#[path = "../../examples/compile.rs"]
mod compile;
#[path = "../../examples/identify.rs"]
mod identify;
#[path = "../../examples/map.rs"]
mod map;
#[path = "../../examples/own_target.rs"]
mod own_target;

#[test]
fn identify_finds_the_squareness_and_writes_a_machine() {
    identify::main().unwrap();
    let fit = identify::fit().unwrap();
    let squareness = &fit.parameters[0];
    // -10 um at Y = 200 mm and -20 um at 400 mm.
    assert_eq!((squareness.name.as_str(), squareness.unit.as_str()), ("EC0Y", "urad"));
    assert!((squareness.value - 50.0).abs() < 3.0 * squareness.sigma.unwrap(), "{squareness:?}");
    let text = fit.machine_file.unwrap();
    let again = abbe::loads(&text, &abbe::LoadOptions::default(), abbe::Run::default()).unwrap();
    assert_eq!(abbe::summary(&again).errors.location, 1);
    assert!(text.contains("measured.csv (sha256 "), "{text}");
}

#[test]
fn map_writes_every_pose_with_its_deviation() {
    map::main().unwrap();
    let table = map::table().unwrap();
    assert_eq!(table.lines().count(), 1001);
    for row in table.lines().skip(1) {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        // A squareness of 10 urad moves the functional point along X by -10 urad times Y.
        assert!((cells[3] + 1e-2 * cells[1]).abs() < 1e-4, "{row}");
    }
}

#[test]
fn compile_and_a_target_of_ones_own_run() {
    compile::main().unwrap();
    own_target::main().unwrap();
}
