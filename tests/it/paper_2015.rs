//! The three-axis machine of Holub, Hrdina, Vasik and Vetiska (2015), section 5 of the theory: its closed
//! forms over dual numbers of order 2, at random coefficients and positions.

use std::path::Path;

use crate::identify::{measured, solve, wanted};
use crate::language::silent;
use crate::oracle::matrix::{V3, minus, norm, plus};
use crate::oracle::program::{Ask, DEFAULT, Folder, eval};
use crate::oracle::random::Random;
use abbe::algebra::Dual;
use abbe::algebra::linear::Triangle;
use abbe::lower::{Chain, OrderN, values};
use abbe::machine::Approach;
use nalgebra::DMatrix;

/// The linear parametrisation, in mm and rad: angles grow by f, g, h per mm of X, Y, Z, lengths by a, b, c.
#[derive(Clone, Copy, Debug, Default)]
struct Coefficients {
    abc: V3,
    f: V3,
    g: V3,
    h: V3,
    sxy: f64,
    sxz: f64,
    syz: f64,
    l: f64,
}

impl Coefficients {
    fn random(random: &mut Random) -> Self {
        // A few hundred urad per metre: the second order is then some hundredths of a um.
        let mut three = || random.vector(3e-7);
        let (abc, f, g, h) = (three(), three(), three(), three());
        let [sxy, sxz, syz] = random.vector(1e-3);
        Self { abc, f, g, h, sxy, sxz, syz, l: -random.between(50.0, 300.0) }
    }

    /// All but the squareness and the tool, as one list of twelve.
    fn list(&self) -> [f64; 12] {
        std::array::from_fn(|i| [self.abc, self.f, self.g, self.h][i / 3][i % 3])
    }

    fn with_list(&self, list: [f64; 12]) -> Self {
        let three = |i: usize| [list[i], list[i + 1], list[i + 2]];
        Self { abc: three(0), f: three(3), g: three(6), h: three(9), ..*self }
    }

    /// The machine file. `printed` is the paper to the letter: every straightness with +, and Z's second
    /// horizontal one from its roll; otherwise each straightness is the integral of its angle.
    fn yaml(&self, printed: bool) -> String {
        let (Self { abc: [a, b, c], f, g, h, .. }, per_m) = (*self, |v: f64| v * 1e9);
        let straight = |letter: &str, axis: &str, v: f64| {
            format!("  E{letter}{axis}: {{ polynomial: [0 um, 0 um/m, {} um/m^2] }}\n", per_m(v) / 2.0)
        };
        let angle = |letter: &str, axis: &str, v: f64| {
            format!("  E{letter}{axis}: {{ polynomial: [0 urad, {} urad/m] }}\n", per_m(v))
        };
        let scale = |axis: &str, v: f64| format!("  E{axis}{axis}: {{ polynomial: [0 um, {} um/m] }}\n", v * 1e6);
        let sign = if printed { 1.0 } else { -1.0 };
        let straightness = [
            straight("Y", "X", if printed { f[0] } else { f[1] }),
            straight("Z", "X", if printed { f[1] } else { -f[0] }),
            straight("Z", "Y", g[0]),
            straight("X", "Y", sign * g[1]),
            straight("Y", "Z", sign * h[0]),
            straight("X", "Z", if printed { h[1] } else { h[2] }),
        ];
        let angles = [
            [angle("B", "X", f[0]), angle("C", "X", f[1]), angle("A", "X", f[2])],
            [angle("A", "Y", g[0]), angle("C", "Y", g[1]), angle("B", "Y", g[2])],
            [angle("A", "Z", h[0]), angle("C", "Z", h[1]), angle("B", "Z", h[2])],
        ];
        let lengths = [scale("X", a), scale("Y", b), scale("Z", c)];
        let square = format!(
            "  EC0Y: {} urad\n  EB0Z: {} urad\n  EA0Z: {} urad\n",
            self.sxy * 1e6,
            -self.sxz * 1e6,
            self.syz * 1e6
        );
        let tool = if printed { [1.0, 1.0, self.l] } else { [0.0, 0.0, self.l] };
        format!(
            "abbe: 1\nmachine: MCV 754\nchain: \"w b X Y Z t\"\nconventions: holub-2015\naxes:\n  X: {{ travel: [-600 mm, 600 mm], origin: [0, 0, 0] }}\n  \
             Y: {{ travel: [-600 mm, 600 mm], origin: [0, 0, 0] }}\n  Z: {{ travel: [-600 mm, 600 mm], origin: [0, 0, 0] }}\ntool: {{ offset: {tool:?} }}\nerrors:\n{square}{}{}{}",
            lengths.concat(),
            straightness.concat(),
            angles.concat().concat()
        )
    }

    /// The real part: squareness.
    fn real(&self, [_, y, z]: V3) -> V3 {
        [-self.sxy * y - self.sxz * z, -self.syz * z, 0.0]
    }

    /// The i-part with tool (0, 0, L) and the straightness of the Abbe principle.
    fn first(&self, [x, y, z]: V3) -> V3 {
        let Self { abc: [a, b, c], f: [f1, f2, f3], g: [g1, g2, g3], h: [h1, _, h3], sxy, sxz, syz, l } = *self;
        [
            a * x + l * (f1 * x + g3 * y + h3 * z) + z * (f1 * x + g3 * y) + syz * z * (f2 * x + g2 * y)
                - f2 * x * y
                - g2 * y * y / 2.0
                + h3 * z * z / 2.0,
            b * y + f2 * x * x / 2.0
                - sxz * z * (f2 * x + g2 * y)
                - f2 * sxy * x * y
                - l * (f3 * x + g1 * y + h1 * z)
                - z * (f3 * x + g1 * y)
                - h1 * z * z / 2.0,
            c * z + sxz * z * (f1 * x + g3 * y) + f1 * sxy * x * y - f1 * x * x / 2.0 - syz * z * (f3 * x + g1 * y)
                + f3 * x * y
                + g1 * y * y / 2.0,
        ]
    }

    /// The i^2-part of the same.
    fn second(&self, [x, y, z]: V3) -> V3 {
        let Self { abc: [_, b, c], f: [f1, f2, f3], g: [g1, g2, g3], h: [h1, _, h3], sxz, syz, l, .. } = *self;
        let (xy, xz, yz, zz) = (x * y, x * z, y * z, z * z / 2.0);
        [
            l * (f2 * g1 * xy + f2 * h1 * xz + g2 * h1 * yz) - b * f2 * xy
                + f1 * g1 * xy * y / 2.0
                + zz * (f2 * h1 * x + g2 * h1 * y)
                + z * (sxz * f1 * g3 * xy + sxz * f2 * g2 * xy - syz * f1 * g1 * xy
                    + c * f1 * x
                    + c * g3 * y
                    + f2 * g1 * xy),
            l * (f2 * g3 * xy + f2 * h3 * xz + g2 * h3 * yz)
                - c * z * (f3 * x + g1 * y)
                - (f2 * g2 + f3 * g1) * xy * y / 2.0
                + zz * (f2 * h3 * x + g2 * h3 * y)
                + z * (syz * f2 * g2 * xy + syz * f3 * g1 * xy - sxz * f3 * g3 * xy + f2 * g3 * xy),
            -l * (f1 * g3 * xy + f3 * g1 * xy + f1 * h3 * xz + f3 * h1 * xz + g3 * h3 * yz + g1 * h1 * yz)
                + b * f3 * xy
                + f1 * g2 * xy * y / 2.0
                - zz * (f1 * h3 * x + f3 * h1 * x + g3 * h3 * y + g1 * h1 * y)
                - z * (sxz * f3 * g2 * xy + syz * f1 * g2 * xy + f1 * g3 * xy + f3 * g1 * xy),
        ]
    }

    /// The i-part as the paper prints it, functional point (1, 1, L).
    fn first_as_printed(&self, [x, y, z]: V3) -> V3 {
        let Self { abc: [a, b, c], f: [f1, f2, f3], g: [g1, g2, g3], h: [h1, h2, h3], sxy, sxz, syz, l } = *self;
        [
            a * x + l * (f1 * x + g3 * y + h3 * z) + z * (f1 * x + g3 * y) + syz * z * (f2 * x + g2 * y)
                - f2 * x * y
                - f2 * x
                + g2 * y * y / 2.0
                - g2 * y
                + h2 * z * z / 2.0
                - h2 * z,
            b * y + f1 * x * x / 2.0 - sxz * z * (f2 * x + g2 * y) - f2 * sxy * x * y + f2 * x
                - l * (f3 * x + g1 * y + h1 * z)
                - z * (f3 * x + g1 * y)
                + g2 * y
                + h1 * z * z / 2.0
                + h2 * z,
            c * z + sxz * z * (f1 * x + g3 * y) + f1 * sxy * x * y - f1 * x + f2 * x * x / 2.0
                - syz * z * (f3 * x + g1 * y)
                + f3 * x * y
                + f3 * x
                + g1 * y * y / 2.0
                + g1 * y
                - g3 * y
                + h1 * z
                - h3 * z,
        ]
    }
}

/// The deviations at positions, at some order.
fn deviations(coefficients: &Coefficients, printed: bool, order: &str, positions: &[V3]) -> Vec<V3> {
    let folder = Folder::new();
    of_file(&folder.write("machine.yaml", &coefficients.yaml(printed)), order, positions)
}

/// The deviations of any machine file.
fn of_file(machine: &Path, order: &str, positions: &[V3]) -> Vec<V3> {
    let poses: Vec<_> = positions.iter().map(|p| p.to_vec()).collect();
    let answers = eval(machine, &["X", "Y", "Z"], &poses, Ask { order: Some(order), ..DEFAULT });
    answers.into_iter().map(|answer| answer.deviation).collect()
}

fn positions(random: &mut Random) -> Vec<V3> {
    (0..20).map(|_| random.vector(600.0)).collect()
}

fn same(found: V3, expected: V3, position: V3, coefficients: &Coefficients) {
    let gap = norm(minus(found, expected));
    // The rounding of positions of 600 mm; the smallest terms of order 2 are a thousand times as large.
    assert!(gap < 1e-12, "{gap:e} at {position:?}: {found:?}, {expected:?}\n{coefficients:?}");
}

#[test]
fn done_right_it_is_the_closed_form_to_second_order() {
    let mut random = Random::new(31);
    for _ in 0..10 {
        let (coefficients, at) = (Coefficients::random(&mut random), positions(&mut random));
        let [one, two] = ["1", "2"].map(|order| deviations(&coefficients, false, order, &at));
        for (i, &p) in at.iter().enumerate() {
            let first = plus(coefficients.real(p), coefficients.first(p));
            same(one[i], first, p, &coefficients);
            same(two[i], plus(first, coefficients.second(p)), p, &coefficients);
        }
    }
}

#[test]
fn as_printed_it_has_the_printed_first_order() {
    let mut random = Random::new(32);
    for _ in 0..10 {
        let (coefficients, at) = (Coefficients::random(&mut random), positions(&mut random));
        for (found, &p) in deviations(&coefficients, true, "1", &at).into_iter().zip(&at) {
            same(found, plus(coefficients.real(p), coefficients.first_as_printed(p)), p, &coefficients);
        }
    }
}

/// The i^2-part of the printed machine with only some of the twelve coefficients, picked by their indices.
fn printed_second(coefficients: &Coefficients, picked: [usize; 2], at: &[V3]) -> Vec<V3> {
    let all = coefficients.list();
    let only = coefficients.with_list(std::array::from_fn(|i| if picked.contains(&i) { all[i] } else { 0.0 }));
    let [one, two] = ["1", "2"].map(|order| deviations(&only, true, order, at));
    two.into_iter().zip(one).map(|(two, one)| minus(two, one)).collect()
}

/// The indices of f1, g1, ... in the list of twelve.
const F: usize = 3;
const G: usize = 6;

#[test]
fn as_printed_second_order_has_the_three_coefficients_quoted_in_part() {
    let mut random = Random::new(33);
    let (c, at) = (Coefficients::random(&mut random), positions(&mut random));
    let ([f1, f2, _], [g1, g2, g3]) = (c.f, c.g);
    let quoted = |[x, y, z]: V3| {
        let shared = c.sxz * x * y * z - x * y;
        [
            ([F, G], f1 * g1 * (x * y * y / 2.0 + x * y - c.syz * x * y * z)),
            ([F, G + 2], f1 * g3 * shared),
            ([F + 1, G + 1], f2 * g2 * shared),
        ]
    };
    for (k, (pair, _)) in quoted([0.0; 3]).into_iter().enumerate() {
        for (found, &p) in printed_second(&c, pair, &at).iter().zip(&at) {
            let (_, expected) = quoted(p)[k];
            assert!((found[0] - expected).abs() < 1e-12, "{pair:?} at {p:?}: {found:?}, {expected}");
        }
    }
}

/// Products of two coefficients in the i^2-part of Dx: 4 fg, 4 fh, 4 gh, and cg, cf, bf.
#[test]
fn as_printed_second_order_has_fifteen_products() {
    let mut random = Random::new(34);
    // Coefficients as large as the program takes them, so that a product is far above the rounding.
    let coefficients = Coefficients::random(&mut random);
    let coefficients = coefficients.with_list(coefficients.list().map(|c| c * 100.0));
    let at = positions(&mut random);
    let mut products = Vec::new();
    for i in 0..12 {
        for j in i..12 {
            let dx = printed_second(&coefficients, [i, j], &at).iter().map(|d| d[0].abs()).fold(0.0, f64::max);
            if dx > 1e-9 {
                products
                    .push(["abcfffggghhh"; 2].iter().zip([i, j]).map(|(names, k)| &names[k..=k]).collect::<String>());
            }
        }
    }
    products.sort();
    let expected = ["bf", "cf", "cg", "fg", "fg", "fg", "fg", "fh", "fh", "fh", "fh", "gh", "gh", "gh", "gh"];
    assert_eq!(products, expected);
}

/// The configuration files of this machine carry the numbers that their comments state.
#[test]
fn the_configured_machines_are_the_closed_forms() {
    let per_m = |v: V3| v.map(|v| v * 1e-9);
    let coefficients = Coefficients {
        abc: [14e-6, -11e-6, 16e-6],
        f: per_m([22.0, -16.0, 26.0]),
        g: per_m([30.0, 18.0, -24.0]),
        h: per_m([-20.0, 12.0, 28.0]),
        sxy: 28e-6,
        sxz: -34e-6,
        syz: -23e-6,
        l: -150.0,
    };
    let mut random = Random::new(35);
    let mut within = || [random.between(0.0, 754.0), random.between(0.0, 500.0), random.between(-550.0, 0.0)];
    let at: Vec<V3> = (0..20).map(|_| within()).collect();
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/papers");
    let [one, two] = ["1", "2"].map(|order| of_file(&configs.join("holub-2015.yaml"), order, &at));
    let printed = of_file(&configs.join("holub-2015-as-printed.yaml"), "1", &at);
    for (i, &p) in at.iter().enumerate() {
        let first = plus(coefficients.real(p), coefficients.first(p));
        same(one[i], first, p, &coefficients);
        same(two[i], plus(first, coefficients.second(p)), p, &coefficients);
        same(printed[i], plus(coefficients.real(p), coefficients.first_as_printed(p)), p, &coefficients);
    }
}

/// Taylor coefficients of Dx at positions, over D_2: real, i, i^2.
fn taylor(coefficients: &Coefficients, at: &[V3]) -> Vec<[f64; 3]> {
    let machine = silent(&[("machine.yaml", &coefficients.yaml(true))]);
    let one = |p: &V3| {
        let errors = values(&machine, &Approach::Mean.at_pose(p));
        let chain = Chain::<Dual<3>>::actual(&machine, p, &errors, &OrderN);
        chain.tool_in_workpiece(&machine.workpiece()).translation.x.0
    };
    at.iter().map(one).collect()
}

/// The design matrix of Dx as the paper prints it: 7 columns of the i-part, 15 products of the i^2-part.
fn design(coefficients: &Coefficients, at: &[V3]) -> DMatrix<f64> {
    let probe = [[311.0, 217.0, -83.0]];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for i in 0..12 {
        for j in i..12 {
            let only = coefficients.with_list(std::array::from_fn(|k| if k == i || k == j { 1e-6 } else { 0.0 }));
            let order = if i == j { 1 } else { 2 };
            if taylor(&only, &probe)[0][order].abs() > 1e-18 {
                columns.push(taylor(&only, at).iter().map(|t| t[order]).collect());
            }
        }
    }
    let length = |column: &Vec<f64>| column.iter().map(|x| x * x).sum::<f64>().sqrt();
    DMatrix::from_fn(at.len(), columns.len(), |i, j| columns[j][i] / length(&columns[j]))
}

fn design_rank(coefficients: &Coefficients, at: &[V3]) -> (usize, usize) {
    let design = design(coefficients, at);
    let mut triangle = Triangle::new(design.ncols());
    design.row_iter().for_each(|row| triangle.push(row.iter().copied(), 0.0));
    (triangle.finish().rank(1e-10), design.ncols())
}

/// Points of the paper's measuring space: x 300..450, y 200..300, z -200..-50 mm.
fn measuring_space(nodes: usize) -> Vec<V3> {
    let at = |low: f64, high: f64, i: usize| low + (high - low) * i as f64 / (nodes - 1) as f64;
    let node = |i: usize| {
        let (x, y, z) = (i / (nodes * nodes), i / nodes % nodes, i % nodes);
        [at(300.0, 450.0, x), at(200.0, 300.0, y), at(-200.0, -50.0, z)]
    };
    (0..nodes.pow(3)).map(node).collect()
}

#[test]
fn the_design_of_the_paper_has_rank_2_along_a_line_and_12_of_22_on_a_grid() {
    let coefficients = Coefficients::random(&mut Random::new(36));
    let line: Vec<V3> = (0..31).map(|i| [300.0 + 5.0 * f64::from(i), 250.0, -125.0]).collect();
    assert_eq!(design_rank(&coefficients, &line), (2, 22));
    assert_eq!(design_rank(&coefficients, &measuring_space(7)), (12, 22));
}

/// Data by the closed form to second order, noise of 0.3 um, squareness and tool length known.
#[test]
fn its_linear_parametrisation_is_found_again_from_noisy_data() {
    let mut random = Random::new(37);
    let truth = Coefficients::random(&mut random);
    let at = measuring_space(7);
    let noise = |random: &mut Random| (0..12).map(|_| random.unit()).sum::<f64>() * 3e-4 - 6.0 * 3e-4;
    let data: Vec<_> = at
        .iter()
        .map(|&p| {
            let d = plus(truth.real(p), plus(truth.first(p), truth.second(p)));
            measured(&p, d.map(|d| d + noise(&mut random)))
        })
        .collect();
    let known = truth.with_list([0.0; 12]);
    let machine = silent(&[("machine.yaml", &known.yaml(false))]);
    let parameters = wanted(&machine, &["linear"]);
    let (_, solution) = solve(&machine, &parameters, &data);
    // h2, the yaw of Z, turns about the tool: no lever, no effect.
    assert_eq!((solution.rank, parameters.len()), (11, 12));
    assert_eq!(solution.null_space, ["ECZ:slope has no effect on these data"]);
    assert!((solution.sigma - 3e-4).abs() < 3e-5, "{}", solution.sigma);
    let Coefficients { abc, f, g, h, .. } = truth;
    // Coefficients of each axis: positioning, then the slopes of its angles A, B, C.
    let expected = [[abc[0], f[2], f[0], f[1]], [abc[1], g[0], g[2], g[1]], [abc[2], h[0], h[2], h[1]]].concat();
    for ((estimate, parameter), expected) in solution.estimates.iter().zip(&parameters).zip(expected) {
        let Some(sigma) = estimate.sigma else { continue };
        assert!((estimate.value - expected).abs() < 4.0 * sigma, "{}: {estimate:?}, {expected}", parameter.name);
    }
}
