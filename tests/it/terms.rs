//! Parts of a deviation by monomial and by degree, against polynomials through the exact rigid body with its errors
//! scaled: what is left of the exact model beyond the degrees of the polynomial is below a double.

use super::oracle::curves::Travel;
use super::oracle::machines::{Pose, Sample};
use super::oracle::program::Folder;
use super::oracle::random::Random;
use super::oracle::rigid::{Conventions, Frame};
use super::oracle::yaml;
use super::support::{abbe, config};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

/// Twenty-two numbers: deviation (mm), rotation (rad), E_VE by rows.
fn numbers(sample: &Sample, pose: &Pose) -> DVector<f64> {
    let answer = sample.evaluate(pose, Travel::Mean, Frame::Workpiece);
    DVector::from_iterator(22, answer.deviation.into_iter().chain(answer.rotation).chain(answer.e_ve.concat()))
}

fn stated(part: &Value) -> DVector<f64> {
    let list = |key: &str| part[key].as_array().unwrap().clone();
    let rows = list("e_ve").into_iter().flat_map(|row| row.as_array().unwrap().clone());
    let all = list("deviation").into_iter().chain(list("rotation")).chain(rows);
    DVector::from_iterator(22, all.map(|x| x.as_f64().unwrap()))
}

/// Lengths are hundreds of mm, angles of E_VE of the order of one: the same tolerance relative to both, a few hundred
/// times the rounding of the values that the polynomials go through.
fn same(part: &DVector<f64>, polynomial: &DVector<f64>, what: &str) {
    for k in 0..22 {
        let is_length = k < 3 || [9, 13, 17].contains(&k);
        let tolerance = if is_length { 1e-10 } else { 1e-13 };
        let gap = (part[k] - polynomial[k]).abs();
        assert!(gap < tolerance, "{what}, number {k}: {} {} {gap:e}", part[k], polynomial[k]);
    }
}

fn eval(machine: &std::path::Path, names: &[String], pose: &Pose, more: &[&str]) -> Value {
    let at: Vec<String> = names.iter().zip(pose).map(|(name, q)| format!("{name}={q}")).collect();
    let at = at.join(",");
    let output = abbe().arg("eval").arg(machine).args(["--at", &at, "--format", "json"]).args(more).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<Value>(&output.stdout).unwrap()["poses"][0].clone()
}

/// Maps values at `nodes` to the coefficients of the polynomial through them.
fn interpolation(nodes: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(nodes.len(), nodes.len(), |i, j| nodes[i].powi(j as i32)).try_inverse().unwrap()
}

fn machines(seed: u64, size: f64) -> impl Iterator<Item = (Folder, Sample, Pose, Vec<String>)> {
    let mut random = Random::new(seed);
    (0..4).map(move |_| {
        let sample = Sample::random(&mut random, Conventions::default(), size);
        let pose = sample.poses(&mut random, 1).remove(0);
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let names = sample.rigid.walk.iter().map(|axis| axis.name.clone()).collect();
        (folder, sample, pose, names)
    })
}

#[test]
fn degrees_are_the_powers_of_all_errors_together() {
    let nodes: Vec<f64> = (-3..=3).map(f64::from).collect();
    let coefficients = interpolation(&nodes);
    for (folder, sample, pose, names) in machines(61, 4e-3) {
        let values: Vec<DVector<f64>> = nodes.iter().map(|t| numbers(&sample.scaled(*t, *t), &pose)).collect();
        let found = eval(&folder.path("machine.yaml"), &names, &pose, &["--order", "4"]);
        let degrees = found["degrees"].as_array().unwrap();
        let monomials: Vec<&str> =
            found["coefficients"].as_array().unwrap().iter().map(|part| part["monomial"].as_str().unwrap()).collect();
        assert_eq!(monomials, ["i", "i^2", "i^3", "i^4"]);
        let mut sum = DVector::zeros(22);
        for (part, degree) in degrees.iter().zip(1..) {
            assert_eq!(part["degree"], degree);
            let ours = (0..7).map(|n| &values[n] * coefficients[(degree, n)]).sum::<DVector<f64>>();
            same(&stated(part), &ours, &format!("degree {degree}"));
            sum += stated(part);
        }
        same(&sum, &stated(&found), "sum");
    }
}

/// Errors of two axes are scaled apart from those of the others, of which the machine has none.
#[test]
fn monomials_are_the_mixed_powers_of_the_errors_of_axes() {
    let nodes: Vec<f64> = (-2..=2).map(f64::from).collect();
    let coefficients = interpolation(&nodes);
    for (_, mut sample, pose, names) in machines(62, 1e-3) {
        let last = names.len() - 1;
        let scaled = |sample: &Sample, s: f64, t: f64| {
            let mut other = sample.clone();
            for (axis, factor) in [(0, s), (last, t)] {
                other.rigid.walk[axis].location = other.rigid.walk[axis].location.map(|e| e * factor);
                other.axes[axis].errors.iter_mut().flatten().for_each(|error| *error = error.scaled(factor));
            }
            other
        };
        for axis in 1..last {
            sample.rigid.walk[axis].location = [0.0; 6];
            sample.axes[axis].errors = Default::default();
        }
        sample.rigid.spindle = None;
        (sample.rigid.tool_setup, sample.rigid.workpiece_setup) = Default::default();
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let algebra = ["--algebra", "degree: 3, generators: per-axis"];
        let found = eval(&folder.path("machine.yaml"), &names, &pose, &algebra);
        let value = |i: usize, j: usize| numbers(&scaled(&sample, nodes[i], nodes[j]), &pose);
        let grid: Vec<Vec<DVector<f64>>> = (0..5).map(|i| (0..5).map(|j| value(i, j)).collect()).collect();
        let (a, b) = (&names[0], &names[last]);
        let mut met = 0;
        for part in found["coefficients"].as_array().unwrap() {
            let name = part["monomial"].as_str().unwrap();
            let power = |axis: &str| {
                let factor = name.split('*').find(|factor| factor.split('^').next() == Some(axis))?;
                Some(factor.split_once('^').map_or(1, |(_, power)| power.parse().unwrap()))
            };
            let [p, q] = [a, b].map(|axis| power(axis).unwrap_or(0));
            let weights = (0..5).flat_map(|i| (0..5).map(move |j| (i, j)));
            let ours = weights.map(|(i, j)| &grid[i][j] * (coefficients[(p, i)] * coefficients[(q, j)]));
            same(&stated(part), &ours.sum::<DVector<f64>>(), name);
            met += usize::from(p > 0 && q > 0);
        }
        assert!(met >= 2, "{found}");
    }
}

#[test]
fn parts_that_are_too_many_are_said_and_long_calculations_refused() {
    let folder = Folder::new();
    let rows: String = (0..300).map(|i| format!("{i}\n")).collect();
    let poses = folder.write("poses.csv", &format!("X\n{rows}"));
    let machine = config("trunnion.yaml");
    let run = |more: &[&str]| abbe().arg("eval").arg(&machine).args(["--format", "json"]).args(more).output().unwrap();
    let poses = poses.to_str().unwrap();
    let many = run(&["--axis-poses", poses, "--algebra", "degree: 2"]);
    let said = String::from_utf8_lossy(&many.stderr);
    let found: Value = serde_json::from_slice(&many.stdout).unwrap();
    assert!(said.contains("W0803") && found["poses"][0]["coefficients"].is_null(), "{said}");
    assert_eq!(found["poses"][299]["degrees"].as_array().unwrap().len(), 2);
    let long = run(&["--axis-poses", poses, "--algebra", "degree: 4"]);
    let said = String::from_utf8_lossy(&long.stderr);
    assert!(long.status.code() == Some(1) && said.contains("E0523") && said.contains("fewer poses"), "{said}");
    let exact: Value = serde_json::from_slice(&run(&["--at", "X=1"]).stdout).unwrap();
    assert!(exact["poses"][0].get("degrees").is_none());
}
