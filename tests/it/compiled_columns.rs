//! A compiled model through the façade: columns in, columns out, the same numbers as `eval` gives pose by pose.

use crate::support::config;
use abbe::api::options::{Approach, Frame, Order};
use abbe::api::results::DeviationSlices;
use abbe::api::{EvalOptions, LoadOptions, Run, compile_model, eval, load};

const POSES: [[f64; 3]; 3] = [[100.0, 50.0, -20.0], [377.0, 250.0, -500.0], [754.0, 0.0, -1.5]];

#[test]
fn columns_hold_what_eval_says_of_each_pose() {
    let machine = load(config("vmc-cframe-754.yaml"), &LoadOptions::default(), Run::on_disk()).unwrap().value;
    let columns: [Vec<f64>; 3] = std::array::from_fn(|axis| POSES.map(|pose| pose[axis]).to_vec());
    let columns = [&columns[0][..], &columns[1], &columns[2]];
    for order in [Order::Exact, Order::Degree(1)] {
        let model = compile_model(&machine, order, Approach::Forward);
        assert_eq!(model.axes().collect::<Vec<_>>(), ["X", "Y", "Z"]);
        let found = model.deviations(&columns).unwrap();
        let poses = POSES.map(|pose| pose.to_vec()).to_vec();
        let options = EvalOptions { poses, order: Some(order), approach: Approach::Forward, ..EvalOptions::default() };
        let result = eval(&machine, &options, Run::on_disk()).unwrap().value;
        for (i, pose) in result.poses.iter().enumerate() {
            let one = model.deviation(&POSES[i]).unwrap();
            let position = [found.dx[i], found.dy[i], found.dz[i]];
            let rotation = [found.wx[i], found.wy[i], found.wz[i]];
            assert_eq!((position, rotation), (one.position_mm, one.rotation_rad));
            let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-11);
            assert!(near(position, pose.deviation) && near(rotation, pose.rotation), "{position:?} {pose:?}");
            assert!(position.iter().any(|x| x.abs() > 1e-4), "{position:?}");
        }
    }
}

#[test]
fn columns_that_do_not_fit_are_refused() {
    let machine = load(config("vmc-cframe-754.yaml"), &LoadOptions::default(), Run::on_disk()).unwrap().value;
    let model = compile_model(&machine, Order::Exact, Approach::Mean);
    let code = |columns: &[&[f64]]| model.deviations(columns).unwrap_err().code.to_string();
    let (one, two) = ([1.0], [1.0, 2.0]);
    assert_eq!(code(&[&one, &one]), "E0818");
    assert_eq!(code(&[&one, &two, &one]), "E0818");
    assert_eq!(code(&[&one, &one, &[f64::NAN]]), "E0802");
    assert_eq!(code(&[&[1.0, 5000.0], &two, &two]), "E0803");
    assert_eq!(model.deviation(&one).unwrap_err().code.to_string(), "E0818");
    assert_eq!(model.deviations(&[&[], &[], &[]]).unwrap().dx.len(), 0);
}

#[test]
fn slices_of_the_caller_hold_vectors_in_the_frame_asked_for() {
    let machine = load(config("trunnion.yaml"), &LoadOptions::default(), Run::on_disk()).unwrap().value;
    let model = compile_model(&machine, Order::Exact, Approach::Mean);
    let pose = [70.0, -35.0, 80.0, 120.0, -40.0];
    let columns = pose.each_ref().map(std::slice::from_ref);
    for frame in [Frame::Workpiece, Frame::Machine, Frame::Tool] {
        let mut six = [0.0; 6];
        let [dx, dy, dz, wx, wy, wz] = six.each_mut().map(std::slice::from_mut);
        let out = DeviationSlices { position_mm: [dx, dy, dz], rotation_rad: [wx, wy, wz] };
        model.deviations_into(&columns, frame, out).unwrap();
        let options = EvalOptions { poses: vec![pose.to_vec()], frame, ..EvalOptions::default() };
        let result = eval(&machine, &options, Run::on_disk()).unwrap().value;
        let expected = [result.poses[0].deviation, result.poses[0].rotation].concat();
        assert!(six.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{frame:?}: {six:?} {expected:?}");
    }
    let mut short = [0.0; 1];
    let out =
        DeviationSlices { position_mm: [&mut short, &mut [], &mut []], rotation_rad: [&mut [], &mut [], &mut []] };
    assert_eq!(model.deviations_into(&columns, Frame::Tool, out).unwrap_err().code.to_string(), "E0818");
}
