//! Weil algebras on whole machines: special cases, vanishing monomials, the inverse problem, refusals.

use crate::configs;
use crate::oracle::program::Folder;
use abbe::algebra::weil::{Coefficients, Monomial, Weil};
use abbe::algebra::{Algebra, Dual, newton_steps};
use abbe::analysis::Inverse;
use abbe::evaluate::{Frame, Order, evaluate, expand_over, random_poses};
use abbe::lower::{DeclaredAlgebra, ErrorLift, Source, WeilLift, values};
use abbe::machine::{AlgebraChoice, Approach, Generators, Machine};
use std::process::Command;

fn lift(machine: &Machine, choice: &AlgebraChoice) -> WeilLift {
    DeclaredAlgebra::new(machine, choice).unwrap().build().unwrap()
}

fn choice(degree: u8, generators: Generators) -> AlgebraChoice {
    AlgebraChoice { degree, generators, vanish: Vec::new(), relations: Vec::new() }
}

#[test]
fn one_generator_is_order_n_to_the_last_bit() {
    for (name, machine) in configs::all() {
        let poses = random_poses(&machine, 2, 5);
        for degree in 1..=4 {
            let lift = lift(&machine, &choice(degree, Generators::Single));
            for pose in &poses {
                let ours = expand_over(&machine, &Approach::Mean.at_pose(pose), &lift, Frame::Workpiece).sum;
                let theirs = evaluate(&machine, &Approach::Mean.at_pose(pose), Order::Degree(degree), Frame::Workpiece);
                assert_eq!(ours, theirs, "{name} {pose:?}");
            }
        }
    }
}

#[test]
fn many_generators_sum_to_order_n() {
    for name in ["trunnion.yaml", "hh-cb-a-nut.yaml", "papers/holub-2015.yaml", "papers/bui-kimm.yaml"] {
        let machine = configs::machine(name);
        for (degree, generators) in [(2, Generators::PerError), (4, Generators::PerAxis)] {
            let lift = lift(&machine, &choice(degree, generators));
            for pose in random_poses(&machine, 2, 6) {
                let ours = expand_over(&machine, &Approach::Mean.at_pose(&pose), &lift, Frame::Machine).sum.deviation;
                let theirs =
                    evaluate(&machine, &Approach::Mean.at_pose(&pose), Order::Degree(degree), Frame::Machine).deviation;
                let gap = (ours.position - theirs.position).amax();
                assert!(gap < 1e-13 && (ours.rotation - theirs.rotation).amax() < 1e-16, "{name} {gap:e}");
            }
        }
    }
}

/// The vanishing products are the difference of the orders.
#[test]
fn an_ideal_of_all_products_is_order_one() {
    let machine = configs::machine("trunnion.yaml");
    let generators = machine.axes().len();
    let pair = |a: usize, b: usize| vec![(format!("x{a}"), 1), (format!("x{b}"), 1)];
    let vanish = (1..=generators).flat_map(|a| (1..=a).map(move |b| pair(a, b))).collect();
    let none = lift(&machine, &AlgebraChoice { vanish, ..choice(5, Generators::PerAxis) });
    assert!(none.basis().monomials().len() <= generators + 4);
    let squares = (1..=generators).map(|a| pair(a, a)).collect();
    let mixed = lift(&machine, &AlgebraChoice { vanish: squares, ..choice(2, Generators::PerAxis) });
    let all = lift(&machine, &choice(2, Generators::PerAxis));
    for pose in random_poses(&machine, 3, 7) {
        let position = |lift: &WeilLift| {
            expand_over(&machine, &Approach::Mean.at_pose(&pose), lift, Frame::Workpiece).sum.deviation.position
        };
        let order = |n| {
            evaluate(&machine, &Approach::Mean.at_pose(&pose), Order::Degree(n), Frame::Workpiece).deviation.position
        };
        assert!((position(&none) - order(1)).amax() < 1e-14);
        assert!((position(&all) - order(2)).amax() < 1e-14);
        let gap = (position(&mixed) - order(2)).amax();
        assert!(gap > 1e-10, "the squares do nothing: {gap:e}");
    }
}

/// Errors a thousand times as large: every degree can then be distinguished from rounding.
struct Large<L>(L);

impl<S: Algebra, L: ErrorLift<S>> ErrorLift<S> for Large<L> {
    fn lift(&self, source: Source, value: f64) -> S {
        self.0.lift(source, 1e3 * value)
    }
}

/// Returns the largest coefficient of each degree of the residual of the conditions.
fn left<const M: usize>(problem: &Inverse<'_>, steps: usize) -> [f64; M] {
    let lift = Large(abbe::lower::OrderN);
    let by = problem.after::<Dual<M>, _>(&lift, steps).unwrap();
    let rest = problem.residual(&by, &lift);
    std::array::from_fn(|k| rest.iter().map(|r| r.0[k].abs()).fold(0.0, f64::max))
}

/// Exact to the degree 2^steps - 1, and not beyond; where only linear axes move, the equations are
/// linear and one step is enough.
fn doubles<const M: usize>(problem: &Inverse<'_>) {
    let linear = problem.moving_axes().len() == 3;
    for steps in 0..=newton_steps(M - 1) {
        let exact = if linear && steps > 0 { M } else { 1_usize << steps };
        for (degree, rest) in left::<M>(problem, steps).into_iter().enumerate() {
            // The rounding of arms of 500 mm; an unsolved part is at least the fifth power of 1 %.
            assert!(degree >= exact || rest < 1e-11, "degree {degree} after {steps} steps: {rest:e}");
            assert!(degree != exact || rest > 1e-9, "degree {degree} after {steps} steps is exact too soon: {rest:e}");
        }
    }
}

#[test]
fn newton_is_exact_after_as_many_steps_as_the_order_needs() {
    for (name, pose) in [
        ("trunnion.yaml", vec![("X", 100.0), ("Y", 50.0), ("Z", -80.0), ("A", -40.0), ("C", 30.0)]),
        ("ht-b-c.yaml", vec![("X", 100.0), ("Y", 50.0), ("Z", -80.0), ("B", 35.0), ("C", 130.0)]),
        ("papers/holub-2015.yaml", vec![("X", 400.0), ("Y", 250.0), ("Z", -100.0)]),
    ] {
        let machine = configs::machine(name);
        let mut at = vec![0.0; machine.axes().len()];
        pose.into_iter().for_each(|(axis, q)| at[machine.axis_index(axis).unwrap()] = q);
        let errors = values(&machine, &Approach::Mean.at_pose(&at));
        let problem = Inverse::new(&machine, &at, &errors);
        doubles::<2>(&problem);
        doubles::<3>(&problem);
        doubles::<4>(&problem);
        doubles::<5>(&problem);
    }
}

#[test]
fn newton_over_a_weil_algebra_is_exact() {
    let machine = configs::machine("trunnion.yaml");
    let lift = Large(lift(&machine, &choice(3, Generators::PerAxis)));
    let pose: Vec<f64> = machine.axes().iter().map(|a| if a.name.as_str() == "A" { -50.0 } else { -20.0 }).collect();
    let errors = values(&machine, &Approach::Mean.at_pose(&pose));
    let problem = Inverse::new(&machine, &pose, &errors);
    let largest = |by: &[Weil]| {
        let rest = problem.residual(by, &lift);
        rest.iter().flat_map(Weil::terms).map(|(_, c)| c.abs()).fold(0.0, f64::max)
    };
    assert!(largest(&problem.after(&lift, newton_steps(3)).unwrap()) < 1e-11);
    assert!(largest(&problem.after(&lift, newton_steps(3) - 1).unwrap()) > 1e-7);
    // First degree: the structured Jacobian's correction, generator by generator, sums to order 1.
    let by: Vec<Weil> = problem.solve(&lift, 3).unwrap();
    assert!(by.iter().any(|b| b.coefficient(&Monomial::new([(0, 1)])) != 0.0));
}

/// Runs the program; stderr and exit code.
fn abbe(arguments: &[&str]) -> (String, String, i32) {
    let output = Command::new(env!("CARGO_BIN_EXE_abbe")).arg("--wide").args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr), output.status.code().unwrap())
}

#[test]
fn what_is_no_algebra_is_refused_with_its_reason() {
    let machine = configs::folder().join("trunnion.yaml");
    let machine = machine.to_str().unwrap();
    for (algebra, code, words) in [
        ("degree: 2, generators: per-axis, vanish: [x9^2]", "E0521", "x1 to x"),
        ("degree: 2, vanish: [EXQ^2]", "E0521", "EXQ"),
        ("degree: 2, vanish: [EXX^0]", "E0522", "contains 1"),
        ("degree: 2, vanish: ['1']", "E0522", "contains 1"),
        ("degree: 6", "E0523", "GB"),
        ("degree: 7", "E0215", "1 to 6"),
        ("generators: per-eror", "E0210", "per-error"),
        ("generators: {tilt: [EXX, nonsense]}", "E0405", "nonsense"),
        ("generators: per-axis, vanish: ['X*Y = Z']", "E0215", "degrees 2 and 1"),
        ("generators: per-axis, vanish: ['X*Y = 1/0 Z^2']", "E0215", "not a relation"),
        ("generators: per-axis, vanish: ['X*Y = Q^2']", "E0521", "Q"),
        ("degree=3", "E0814", "--algebra"),
        ("", "E0814", "names no algebra"),
    ] {
        let (_, complaint, exit) = abbe(&["eval", machine, "--algebra", algebra]);
        assert!(exit == 1 && complaint.contains(code) && complaint.contains(words), "{algebra}: {exit} {complaint}");
    }
}

/// C(k + 6, 6) monomials of 128 bytes, C(2 k + 6, 6) products of 8.
#[test]
fn what_is_too_large_is_told_with_its_size() {
    let machine = configs::folder().join("trunnion.yaml");
    let (_, complaint, exit) = abbe(&["eval", machine.to_str().unwrap(), "--algebra", "degree: 6"]);
    let after = |word: &str| complaint.split(word).nth(1).unwrap().split_whitespace().next().unwrap();
    let k: f64 = after("an algebra of ").parse().unwrap();
    let choose = |n: f64| (n + 1.0) * (n + 2.0) * (n + 3.0) * (n + 4.0) * (n + 5.0) * (n + 6.0) / 720.0;
    let said: f64 = after("monomials and ").parse().unwrap();
    let bytes = 128.0 * choose(k) + 8.0 * choose(2.0 * k);
    // Three digits are printed.
    assert!(exit == 1 && k >= 30.0 && (said * 1e9 / bytes - 1.0).abs() < 5e-3, "{k} {said} {bytes:e}\n{complaint}");
}

#[test]
fn the_inverse_undoes_the_errors() {
    let machine = configs::folder().join("trunnion.yaml");
    let machine = machine.to_str().unwrap();
    let at = ["--at", "X=100,Y=60,Z=-90,A=-40,C=25"];
    let arguments =
        [&["eval", machine, "--algebra", "degree: 3, generators: single", "--inverse", "--format", "json"][..], &at]
            .concat();
    let (out, complaint, exit) = abbe(&arguments);
    assert_eq!(exit, 0, "{complaint}");
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let by = &json["poses"][0]["inverse"];
    let loaded = configs::machine("trunnion.yaml");
    let pose: Vec<f64> =
        loaded.axes().iter().map(|a| json["poses"][0]["axes"][a.name.as_str()].as_f64().unwrap()).collect();
    let moved: Vec<f64> =
        loaded.axes().iter().zip(&pose).map(|(a, q)| q + by[a.name.as_str()].as_f64().unwrap()).collect();
    let before =
        evaluate(&loaded, &Approach::Mean.at_pose(&pose), Order::Exact, Frame::Workpiece).deviation.position.norm();
    let left = abbe::evaluate::commanded_deviation(&loaded, &pose, &Approach::Mean.at_pose(&moved)).position.norm();
    // The residual is the change of the error curves along the displacement.
    assert!(before > 1e-3 && left < 2e-3 * before, "{before} {left}");
}

#[test]
fn groups_and_the_file_s_own_algebra_are_taken() {
    let folder = Folder::new();
    let yaml = "abbe: 1\nmachine: M\nchain: \"w b X Y t\"\naxes: { X: { travel: [0, 1], origin: [0, 0, 0] }, Y: { travel: [0, 1], origin: [0, 0, 0] } }\nerrors:\n  \
                EXX: { polynomial: [1 um] }\n  EAX: { polynomial: [1 urad] }\n  EYY: { polynomial: [1 um] }\n\
                algebra: { degree: 3, generators: { tilt: [EAX] }, vanish: [tilt^2, x2*x3] }\n";
    let path = folder.write("machine.yaml", yaml);
    let (out, complaint, exit) = abbe(&["eval", path.to_str().unwrap(), "--algebra", "--format", "json"]);
    assert_eq!(exit, 0, "{complaint}");
    // tilt, EXX, EYY to degree 3 without tilt^2 and EXX*EYY: 1, 3, 2 squares and 2 mixed, x2^3 x3^3 t x2^2 t x3^2.
    assert!(out.contains("3 in 3 generators, 12 monomials"), "{out}");
}

/// Monomials of a degree in so many generators, as powers.
fn powers(generators: usize, degree: u8) -> Vec<Vec<u8>> {
    match generators {
        0 => {
            if degree == 0 {
                vec![Vec::new()]
            } else {
                Vec::new()
            }
        }
        _ => (0..=degree)
            .flat_map(|p| powers(generators - 1, degree - p).into_iter().map(move |rest| [vec![p], rest].concat()))
            .collect(),
    }
}

/// An element of an ideal: coefficients by powers.
type Polynomial = Vec<(f64, Vec<u8>)>;

/// The dimension of a degree of the quotient, by the rank of all multiples of the generators of the ideal.
fn dimension(ideal: &[Polynomial], generators: usize, degree: u8) -> usize {
    let all = powers(generators, degree);
    let mut columns = Vec::new();
    for element in ideal {
        let own: u8 = element[0].1.iter().sum();
        let Some(room) = degree.checked_sub(own) else { continue };
        for by in powers(generators, room) {
            let mut column = vec![0.0; all.len()];
            for (c, m) in element {
                let product: Vec<u8> = m.iter().zip(&by).map(|(a, b)| a + b).collect();
                column[all.iter().position(|m| *m == product).unwrap()] += c;
            }
            columns.push(column);
        }
    }
    let matrix =
        nalgebra::DMatrix::from_fn(all.len(), columns.len().max(1), |i, j| columns.get(j).map_or(0.0, |c| c[i]));
    all.len() - matrix.rank(1e-9)
}

/// Quotients by relations have the dimensions of linear algebra degree by degree, and evaluate to the coefficients of
/// the free algebra with one monomial for the other.
#[test]
fn relations_are_linear_algebra_degree_by_degree() {
    let machine = configs::folder().join("gantry-3ax.yaml");
    let run = |algebra: &str| -> serde_json::Value {
        let arguments =
            ["eval", machine.to_str().unwrap(), "--at", "X=300,Y=200,Z=-100", "--algebra", algebra, "--format", "json"];
        let (out, complaint, exit) = abbe(&arguments);
        assert_eq!(exit, 0, "{algebra}: {complaint}");
        serde_json::from_str(&out).unwrap()
    };
    let cases: [(&str, Vec<Polynomial>); 4] = [
        ("x1*x2 = x3^2", vec![vec![(1.0, vec![1, 1, 0]), (-1.0, vec![0, 0, 2])]]),
        (
            "x1*x2 = 0.5 x3^2', 'x1*x3 = x2^2",
            vec![vec![(1.0, vec![1, 1, 0]), (-0.5, vec![0, 0, 2])], vec![(1.0, vec![1, 0, 1]), (-1.0, vec![0, 2, 0])]],
        ),
        (
            "x1^2 = x2^2', 'x1^2 = -x2^2",
            vec![vec![(1.0, vec![2, 0, 0]), (-1.0, vec![0, 2, 0])], vec![(1.0, vec![2, 0, 0]), (1.0, vec![0, 2, 0])]],
        ),
        (
            "x1*x2*x3 = x3^3', 'x2^2",
            vec![vec![(1.0, vec![1, 1, 1]), (-1.0, vec![0, 0, 3])], vec![(1.0, vec![0, 2, 0])]],
        ),
    ];
    for (text, ideal) in cases {
        let json = run(&format!("degree: 4, generators: per-axis, vanish: ['{text}']"));
        let names: Vec<&str> =
            json["algebra"]["monomials"].as_array().unwrap().iter().map(|m| m.as_str().unwrap()).collect();
        let degree = |name: &str| match name {
            "1" => 0,
            name => name.split('*').map(|f| f.split_once('^').map_or(1, |(_, p)| p.parse::<u8>().unwrap())).sum::<u8>(),
        };
        for d in 0..=4 {
            let ours = names.iter().filter(|name| degree(name) == d).count();
            assert_eq!(ours, dimension(&ideal, 3, d), "{text}, degree {d}: {names:?}");
        }
    }
    let coefficient = |json: &serde_json::Value, name: &str| -> [f64; 3] {
        let list = json["poses"][0]["coefficients"].as_array().unwrap();
        let found = list.iter().find(|c| c["monomial"] == name);
        std::array::from_fn(|k| found.map_or(0.0, |c| c["deviation"][k].as_f64().unwrap()))
    };
    let (free, tied) =
        (run("degree: 2, generators: per-axis"), run("degree: 2, generators: per-axis, vanish: ['X*Y = 3 Y*Z']"));
    let [product, other, both] =
        [(&free, "X*Y"), (&free, "Y*Z"), (&tied, "Y*Z")].map(|(json, name)| coefficient(json, name));
    for k in 0..3 {
        assert!((3.0 * product[k] + other[k] - both[k]).abs() < 1e-15, "{product:?} {other:?} {both:?}");
    }
    assert!(product.iter().any(|x| *x != 0.0), "the product acts here: {product:?}");
}
