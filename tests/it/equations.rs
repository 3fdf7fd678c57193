//! The printed equations: equal to `eval` at numbers, and to the papers where those are right.

use crate::configs;
use crate::oracle::machines::{Sample, combinations};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::{rigid, yaml};
use abbe::algebra::symbolic::Symbolic;
use abbe::analysis::{Equations, Naming, Options, SymbolMeaning, equations};
use abbe::evaluate::{Frame, Order, evaluate, random_poses};
use abbe::lower::{DeclaredAlgebra, values};
use abbe::machine::{AlgebraChoice, Approach, Machine, sin_cos_degrees};
use abbe::report::equations::polynomial_text;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

fn of_order(machine: &Machine, order: u8, options: Options) -> Equations {
    let declared = DeclaredAlgebra::new(machine, &AlgebraChoice::per_error(order)).unwrap();
    equations(machine, &declared, options).unwrap()
}

/// Values of the symbols at a pose.
fn symbols_at(machine: &Machine, found: &Equations, pose: &[f64]) -> Vec<f64> {
    let errors = values(machine, &Approach::Mean.at_pose(pose));
    let value = |meaning: SymbolMeaning| match meaning {
        SymbolMeaning::Error(source, sign) => f64::from(sign) * errors.of(source),
        SymbolMeaning::Position(i) => pose[i],
        SymbolMeaning::Sine(i) => sin_cos_degrees(pose[i]).0,
        SymbolMeaning::Cosine(i) => sin_cos_degrees(pose[i]).1,
        SymbolMeaning::ToolLength => machine.tool().tip[2] - machine.tool().gauge[2],
        SymbolMeaning::Parameter(_) => f64::NAN,
    };
    found.symbols.iter().map(|s| value(s.meaning)).collect()
}

/// Largest differences of position (mm), rotation and E_VE.
type Tolerance = [f64; 3];

/// Terms of a metre times 100 urad are 0.1 mm: their rounding, some hundred times.
const ROUNDING: Tolerance = [1e-13, 1e-17, 1e-12];

/// The polynomials at numbers agree with `eval` at the same order, to rounding.
fn agrees(machine: &Machine, order: u8, options: Options, tolerance: Tolerance) {
    let name = machine.name();
    let found = of_order(machine, order, options);
    for pose in random_poses(machine, 3, 11) {
        let at = symbols_at(machine, &found, &pose);
        let number = |p: &Symbolic| p.evaluate(|k| at[usize::from(k)]);
        let expected = evaluate(machine, &Approach::Mean.at_pose(&pose), Order::Degree(order), Frame::Workpiece);
        let position = (found.position.map(|p| number(&p)) - expected.deviation.position).amax();
        let rotation = (found.rotation.map(|p| number(&p)) - expected.deviation.rotation).amax();
        assert!(position < tolerance[0] && rotation < tolerance[1], "{name}: {position:e} {rotation:e}");
        for (ours, theirs) in found.e_ve.iter().zip(expected.e_ve.iter()) {
            let gap = (number(ours) - theirs).abs();
            assert!(gap < tolerance[2], "{name}: {gap:e}");
        }
    }
}

/// Random machines of every topology in every convention: skew directions, spindles, errors of clamping.
#[test]
fn random_machines_agree() {
    let mut random = Random::new(41);
    for (index, conventions) in combinations().enumerate() {
        let conventions = rigid::Conventions { linearised: index % 2 == 0, ..conventions };
        let mut sample = Sample::random(&mut random, conventions, 1e-4);
        if index % 3 == 1 {
            sample.rigid.workpiece_rotation = [-90.0, 0.0, 35.0];
        }
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let machine = load(&folder.path("machine.yaml"));
        agrees(&machine, if index % 8 < 2 { 2 } else { 1 }, Options::default(), [1e-11, 1e-15, 1e-11]);
    }
}

#[test]
fn first_order_is_eval_on_every_machine() {
    configs::all().iter().for_each(|(_, machine)| agrees(machine, 1, Options::default(), ROUNDING));
}

#[test]
fn second_order_is_eval() {
    for name in ["papers/holub-2015.yaml", "papers/holub-2015-as-printed.yaml", "papers/hrdina-vasik-2014.yaml"] {
        agrees(&configs::machine(name), 2, Options { naming: Naming::Paper, tool_length: true }, ROUNDING);
    }
    for name in ["trunnion.yaml", "gantry-3ax.yaml", "papers/bui-kimm.yaml"] {
        agrees(&configs::machine(name), 2, Options::default(), ROUNDING);
    }
}

/// Products of terms are counted: the limit comes before the memory is full. The program refuses with exit code 1.
#[test]
#[ignore = "soak: half a minute"]
fn equations_without_end_are_refused() {
    let mut run = Command::new(env!("CARGO_BIN_EXE_abbe"));
    let output =
        run.args(["equations", "--order", "6"]).arg(configs::folder().join("hh-bd-ram.yaml")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("E0523") && said.contains("products of terms"), "{said}");
    assert!(output.stdout.is_empty());
}

/// A polynomial as its terms: powers by symbol, coefficient.
type Terms = BTreeMap<BTreeMap<String, u64>, f64>;

fn terms(polynomial: &Symbolic, found: &Equations) -> Terms {
    let name = |(index, power): &(u16, u8)| (found.symbols[usize::from(*index)].text.clone(), u64::from(*power));
    polynomial.terms().map(|(m, c)| (m.factors().iter().map(name).collect(), c)).collect()
}

fn expected(json: &Value) -> Terms {
    let powers = |p: &Value| p.as_object().unwrap().iter().map(|(s, p)| (s.clone(), p.as_u64().unwrap())).collect();
    json.as_array().unwrap().iter().map(|term| (powers(&term[1]), term[0].as_f64().unwrap())).collect()
}

fn same(ours: &Terms, theirs: &Terms, what: &str) {
    let missing: Vec<_> = theirs.keys().filter(|k| !ours.contains_key(*k)).collect();
    let more: Vec<_> = ours.keys().filter(|k| !theirs.contains_key(*k)).collect();
    assert!(missing.is_empty() && more.is_empty(), "{what}: missing {missing:?}, too many {more:?}");
    for (monomial, value) in ours {
        assert!((value - theirs[monomial]).abs() < 1e-15, "{what}: {monomial:?} {value} {}", theirs[monomial]);
    }
}

/// Output of SymPy (tests/oracles/equations.py).
fn sympy() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracles/equations.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A machine from its chain and errors; every axis has a long travel.
fn machine(chain: &str, conventions: &str, errors: &[String], rest: &str) -> Machine {
    let names = chain.split([' ', '\'']).filter(|n| n.len() == 1 && n.chars().all(char::is_uppercase));
    let axes: Vec<String> = names
        .map(|n| format!("{n}: {{ travel: {} }}", if "ABC".contains(n) { "[-90, 90]" } else { "[-500, 500]" }))
        .collect();
    let term = |name: &String| {
        format!("  {name}: {{ tolerance: {} }}\n", if "XYZ".contains(&name[1..2]) { "1 um" } else { "1 urad" })
    };
    let yaml = format!(
        "abbe: 1\nmachine: M\nchain: \"{chain}\"\nconventions: {conventions}\naxes: {{ {} }}\n{rest}errors:\n{}",
        axes.join(", "),
        errors.iter().map(term).collect::<String>()
    );
    let folder = Folder::new();
    let path = folder.write("machine.yaml", &yaml);
    load(&path)
}

fn load(path: &Path) -> Machine {
    let mut diagnostics = abbe::diagnostic::Diagnostics::default();
    let files = abbe::syntax::Disk;
    let document = abbe::syntax::load(path, &files, &mut diagnostics);
    let machine = document.and_then(|d| abbe::machine::resolve(&d, &files, &mut diagnostics));
    machine.unwrap_or_else(|| panic!("{}", abbe::diagnostic::render(&diagnostics, Default::default())))
}

/// All six errors of axes: component errors, or with a zero.
fn six(axes: &str, zero: &str) -> Vec<String> {
    axes.chars().flat_map(|axis| "XYZABC".chars().map(move |d| format!("E{d}{zero}{axis}"))).collect()
}

fn same_matrix(ours: &nalgebra::Matrix4<Symbolic>, theirs: &Value, found: &Equations, what: &str) {
    for (i, j) in (0..3).flat_map(|i| (0..4).map(move |j| (i, j))) {
        same(&terms(&ours[(i, j)], found), &expected(&theirs[i][j]), &format!("{what} [{},{}]", i + 1, j + 1));
    }
}

/// A factor and powers by letter.
type Scaled = (f64, Vec<(&'static str, u64)>);

/// Every symbol of the 2015 chain in its linear parametrisation: a factor and powers.
fn parameters(printed: bool) -> BTreeMap<&'static str, Scaled> {
    let scales = [("dxx", "a", "x"), ("dyy", "b", "y"), ("dzz", "c", "z")];
    let angles = [
        ("eyx", "f1", "x"),
        ("ezx", "f2", "x"),
        ("exx", "f3", "x"),
        ("exy", "g1", "y"),
        ("ezy", "g2", "y"),
        ("eyy", "g3", "y"),
        ("exz", "h1", "z"),
        ("ezz", "h2", "z"),
        ("eyz", "h3", "z"),
    ];
    let sign = if printed { 0.5 } else { -0.5 };
    let straight = [
        ("dyx", 0.5, if printed { "f1" } else { "f2" }, "x"),
        ("dzx", sign, if printed { "f2" } else { "f1" }, "x"),
        ("dzy", 0.5, "g1", "y"),
        ("dxy", sign, "g2", "y"),
        ("dyz", sign, "h1", "z"),
        ("dxz", 0.5, if printed { "h2" } else { "h3" }, "z"),
    ];
    let linear = scales.into_iter().chain(angles).map(|(e, p, q)| (e, (1.0, vec![(p, 1), (q, 1)])));
    linear.chain(straight.into_iter().map(|(e, k, p, q)| (e, (k, vec![(p, 1), (q, 2)])))).collect()
}

fn parametrised(polynomial: &Terms, printed: bool) -> Terms {
    let table = parameters(printed);
    let mut all = Terms::new();
    for (monomial, value) in polynomial {
        let (mut factor, mut powers) = (*value, BTreeMap::new());
        for (symbol, power) in monomial {
            let Some((k, by)) = table.get(symbol.as_str()) else {
                *powers.entry(symbol.clone()).or_default() += power;
                continue;
            };
            factor *= num_traits::pow(*k, *power as usize);
            by.iter().for_each(|(s, p)| *powers.entry((*s).to_owned()).or_default() += p * power);
        }
        *all.entry(powers).or_default() += factor;
    }
    all.retain(|_, c| c.abs() > 1e-15);
    all
}

#[test]
fn the_chain_of_2015_is_sympys_as_printed_and_done_right() {
    let sympy = sympy();
    let errors = [six("XYZ", ""), ["EC0Y", "EB0Z", "EA0Z"].map(str::to_owned).to_vec()].concat();
    for (printed, key, tool) in [(true, "holub_printed", "[1, 1, -150]"), (false, "holub_right", "[0, 0, -150]")] {
        let rest = format!("tool: {{ offset: {tool} }}\n");
        let machine = machine("w b X Y Z t", "holub-2015", &errors, &rest);
        let found = of_order(&machine, 2, Options { naming: Naming::Paper, tool_length: true });
        for (axis, polynomial) in ["Dx", "Dy", "Dz"].iter().zip(found.position.iter()) {
            for order in 0..=2 {
                let ours = parametrised(&terms(&polynomial.part(order), &found), printed);
                same(&ours, &expected(&sympy[key][axis][order]), &format!("{key} {axis} order {order}"));
            }
        }
    }
}

/// The Abbe principle: a carriage turns by the slope of its straightness. The print of 2015 breaks it, and its T_L
/// takes the tool for (1, 1, L).
#[test]
fn straightness_of_2015_is_the_integral_of_its_angle() {
    // Slope of the straightness, angle, sign: +e_z turns x towards y.
    let slopes = [
        ("dyx", "ezx", 1.0),
        ("dzx", "eyx", -1.0),
        ("dzy", "exy", 1.0),
        ("dxy", "ezy", -1.0),
        ("dxz", "eyz", 1.0),
        ("dyz", "exz", -1.0),
    ];
    let broken = |printed: bool| -> Vec<&str> {
        let table = parameters(printed);
        let breaks = |(straight, angle, sign): &(&str, &str, f64)| {
            let ((k, by), (one, of)) = (&table[straight], &table[angle]);
            // k p q^2 has the slope 2 k p q, which must be sign * p q.
            by[0].0 != of[0].0 || 2.0 * k != sign * one
        };
        slopes.iter().filter(|slope| breaks(slope)).map(|(straight, _, _)| *straight).collect()
    };
    assert!(broken(false).is_empty());
    assert_eq!(broken(true), ["dyx", "dzx", "dxy", "dxz", "dyz"]);
    let point = |t: [f64; 3], p: [f64; 3]| [0, 1, 2].map(|k| t[k] * p[k]);
    assert_eq!(point([1.0, 1.0, -150.0], [1.0; 3]), [1.0, 1.0, -150.0], "diag(1, 1, L, 1) on (1, 1, 1, 1)");
    assert_eq!(point([1.0, 1.0, -150.0], [0.0, 0.0, 1.0]), [0.0, 0.0, -150.0], "on the tool");
}

/// Table 1 of 2015 names Sxy by BZ and Sxz by CY: ISO has EC0Y (X-Y), EB0Z (X-Z), EA0Z (Y-Z).
#[test]
fn the_squareness_of_table_1_of_2015() {
    let dx = |error: &str| {
        let machine = machine("w b X Y Z t", "holub-2015", &[error.to_owned()], "");
        let found = of_order(&machine, 1, Options { naming: Naming::Paper, tool_length: false });
        found.position.map(|p| polynomial_text(&p, &found.symbols))
    };
    assert_eq!(dx("EC0Y").as_slice(), ["-Sxy*y", "0", "0"]);
    assert_eq!(dx("EB0Z").as_slice(), ["-Sxz*z", "0", "0"]);
    assert_eq!(dx("EA0Z").as_slice(), ["0", "-Syz*z", "0"]);
    // What the table calls Sxy, BZ, moves nothing along y; CY, listed twice for Sxz, moves nothing along z.
    assert!(!dx("EB0Z")[0].contains("*y") && !dx("EC0Y")[0].contains("*z"));
}

/// The columns of the paper's design matrix for Dx: products of its parameters, as printed.
#[test]
fn dx_of_2015_has_22_unknown_columns() {
    let sympy = sympy();
    let parameters = |order: usize| -> std::collections::BTreeSet<String> {
        let of = |m: &BTreeMap<String, u64>| {
            let letters = m.keys().filter(|s| s.starts_with(['a', 'b', 'c', 'f', 'g', 'h']));
            letters.cloned().collect::<Vec<_>>().join(" ")
        };
        expected(&sympy["holub_printed"]["Dx"][order]).keys().map(of).collect()
    };
    let (first, second) = (parameters(1), parameters(2));
    assert_eq!((first.len(), second.len()), (7, 15), "{first:?} {second:?}");
    let count = |a: char, b: char| second.iter().filter(|p| p.starts_with(a) && p.contains(&format!(" {b}"))).count();
    let kinds = [('f', 'g'), ('f', 'h'), ('g', 'h'), ('c', 'g'), ('c', 'f'), ('b', 'f')];
    assert_eq!(kinds.map(|(a, b)| count(a, b)), [4, 4, 4, 1, 1, 1]);
}

#[test]
fn the_matrices_of_the_five_axis_paper_are_sympys() {
    let sympy = sympy();
    for (zero, key) in [("", "motion"), ("0", "placed")] {
        let machine = machine("w b X Y Z A B C t", "bui-kimm", &six("XYZABC", zero), "");
        let found = of_order(&machine, 1, Options::default());
        for (name, joint) in &found.joints {
            same_matrix(&joint.to_matrix(), &sympy["kimm"][key][name], &found, name);
        }
    }
}

#[test]
fn e_ve_of_the_five_axis_paper_is_sympys() {
    let errors = [six("XZYAC", ""), six("XZYAC", "0")].concat();
    let machine = machine("w C' A' Y' b X Z t", "bui-kimm", &errors, "");
    let found = of_order(&machine, 1, Options::default());
    same_matrix(&found.e_ve, &sympy()["kimm"]["e_ve"], &found, "E_VE");
}

#[test]
fn the_matrices_of_2014_are_the_corrected_ones() {
    let hrdina = &sympy()["hrdina"];
    let of = |chain: &str, conventions: &str, errors: Vec<String>| {
        let machine = machine(chain, conventions, &errors, "");
        of_order(&machine, 1, Options::default())
    };
    let after = "{ preset: hrdina-vasik-2014, linear: after }";
    let squareness = ["EC0Y", "EB0Z", "EA0Z"].map(str::to_owned).to_vec();
    let one = of("w b X Y Z t", after, [six("XYZ", ""), squareness].concat());
    one.joints.iter().for_each(|(name, joint)| same_matrix(&joint.to_matrix(), &hrdina["1"][name], &one, "(1)"));
    let two = of("w b A t", after, six("A", ""));
    same_matrix(&two.t_tool.to_matrix(), &hrdina["2"], &two, "(2)");
    let five = of("w b X Y t", "hrdina-vasik-2014", six("XY", ""));
    same_matrix(&five.t_tool.to_matrix(), &hrdina["5"], &five, "(5)");
    let thirty_six = of("w b Y A t", after, six("YA", ""));
    same_matrix(&thirty_six.t_tool.to_matrix(), &hrdina["36"], &thirty_six, "(36)");
}

/// (40) keeps nine monomials; over it the rotation of the error matrix shows which products stay.
#[test]
fn the_ideal_of_2014_is_kept_in_the_equations() {
    let machine = machine("w b Y A t", "{ joints: orthogonal }", &["EAY", "EBY", "ECY", "EAA"].map(str::to_owned), "");
    let squares = (1..=4).map(|k| vec![(format!("x{k}"), 2)]);
    let pairs = [(3, 2), (3, 4), (3, 1)].map(|(a, b)| vec![(format!("x{a}"), 1), (format!("x{b}"), 1)]);
    let choice = AlgebraChoice { vanish: squares.chain(pairs).collect(), ..AlgebraChoice::per_error(3) };
    let declared = DeclaredAlgebra::new(&machine, &choice).unwrap();
    let found = equations(&machine, &declared, Options::default()).unwrap();
    let lift = declared.build().unwrap();
    let names: Vec<String> = lift.basis().monomials().iter().map(|m| lift.declared().monomial_name(m)).collect();
    assert_eq!(names.len(), 9);
    let errors = |m: &BTreeMap<String, u64>| -> Vec<String> {
        m.iter().filter(|(s, _)| s.starts_with('E')).flat_map(|(s, p)| vec![s.clone(); *p as usize]).collect()
    };
    for entry in found.e_ve.iter() {
        for product in terms(entry, &found).keys().map(errors) {
            let known = names.iter().any(|n| {
                let mut factors: Vec<&str> = n.split('*').filter(|f| !f.is_empty()).collect();
                factors.sort_unstable();
                factors == product
            });
            assert!(known, "{product:?} is none of {names:?}");
        }
    }
}

#[test]
fn text_is_what_a_person_would_write() {
    let errors = [six("XYZ", ""), ["EC0Y", "EB0Z", "EA0Z"].map(str::to_owned).to_vec()].concat();
    let machine = machine("w b X Y Z t", "holub-2015", &errors, "tool: { offset: [0, 0, -150] }\n");
    let found = of_order(&machine, 1, Options { naming: Naming::Paper, tool_length: true });
    let dx = &found.position[0];
    assert_eq!(polynomial_text(&dx.part(0), &found.symbols), "-Sxy*y - Sxz*z");
    let first = "dxx + eyx*L + eyx*z + ezx*Syz*z - ezx*y + dxy + eyy*L + eyy*z + ezy*Syz*z + dxz + eyz*L";
    assert_eq!(polynomial_text(&dx.part(1), &found.symbols), first);
}

fn abbe(arguments: &[&str]) -> (String, String, i32) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_abbe")).args(["--wide", "equations"]).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr), output.status.code().unwrap())
}

/// The JSON as another program reads it: evaluated there, it is `eval`.
#[test]
fn the_json_carries_the_polynomials() {
    let path = configs::folder().join("ht-b-c.yaml");
    let (out, complaint, exit) = abbe(&[path.to_str().unwrap(), "--order", "2", "--format", "json"]);
    assert_eq!(exit, 0, "{complaint}");
    let json: Value = serde_json::from_str(&out).unwrap();
    let machine = configs::machine("ht-b-c.yaml");
    let found = of_order(&machine, 2, Options::default());
    let pose = random_poses(&machine, 1, 3).remove(0);
    let at = symbols_at(&machine, &found, &pose);
    let value = |name: &str| at[found.symbols.iter().position(|s| s.text == name).unwrap()];
    let term = |term: &Value| {
        let powers = term["powers"].as_object().unwrap().iter();
        powers.fold(term["coefficient"].as_f64().unwrap(), |x, (s, p)| {
            x * num_traits::pow(value(s), p.as_u64().unwrap() as usize)
        })
    };
    let number = |p: &Value| p["terms"].as_array().unwrap().iter().map(term).sum::<f64>();
    let expected = evaluate(&machine, &Approach::Mean.at_pose(&pose), Order::Degree(2), Frame::Workpiece);
    for i in 0..3 {
        assert!((number(&json["deviation"][i]) - expected.deviation.position[i]).abs() < 1e-13);
        assert!((number(&json["e_ve"][i][3]) - expected.e_ve[(i, 3)]).abs() < 1e-12);
    }
}

#[test]
fn latex_is_a_balanced_document() {
    for name in ["trunnion.yaml", "papers/holub-2015.yaml", "papers/bui-kimm.yaml"] {
        for symbols in ["iso", "paper"] {
            let path = configs::folder().join(name);
            let (out, _, exit) = abbe(&[path.to_str().unwrap(), "--order", "2", "--latex", "--symbols", symbols]);
            assert_eq!(exit, 0);
            let body = out.lines().filter(|l| l.starts_with('$'));
            let depth = |l: &str| l.chars().map(|c| i32::from(c == '{') - i32::from(c == '}')).sum::<i32>();
            assert!(
                body.clone().count() > 20 && body.clone().all(|l| depth(l) == 0 && l.matches('$').count() == 2),
                "{name}"
            );
            assert!(out.starts_with("\\documentclass") && out.ends_with("\\end{document}\n"));
        }
    }
}

/// A real TeX (Debian's texlive-latex-base) sets the documents without an error and without a line too long.
#[test]
#[ignore = "needs pdflatex: tests/run"]
fn latex_compiles() {
    let folder = Folder::new();
    let hostile = std::fs::read_to_string(configs::folder().join("papers/holub-2015.yaml")).unwrap();
    let name = hostile.lines().find(|l| l.starts_with("machine:")).unwrap();
    let odd = hostile.replace(name, r#"machine: "50% {A_1} \\x & ~^#$ Fräse Ø µ° 中 \"q\"""#);
    let cases = [
        (folder.write("odd.yaml", &odd), "2"),
        (configs::folder().join("papers/holub-2015.yaml"), "2"),
        (configs::folder().join("papers/bui-kimm.yaml"), "1"),
        (configs::folder().join("trunnion.yaml"), "1"),
        (configs::folder().join("hh-cb-a-nut.yaml"), "1"),
    ];
    for ((path, order), symbols) in cases.iter().flat_map(|case| ["iso", "paper"].map(|s| (case, s))) {
        let (out, complaint, exit) =
            abbe(&[path.to_str().unwrap(), "--order", order, "--latex", "--symbols", symbols, "--quiet"]);
        assert_eq!(exit, 0, "{complaint}");
        folder.write("x.tex", &out);
        let run = Command::new("pdflatex")
            .args(["-interaction=batchmode", "-halt-on-error", "x.tex"])
            .current_dir(folder.path(""))
            .output()
            .expect("pdflatex is installed by tests/run");
        let log = String::from_utf8_lossy(&std::fs::read(folder.path("x.log")).unwrap()).into_owned();
        assert!(run.status.success() && log.contains("Output written on x.pdf"), "{path:?} {symbols}\n{log}");
        assert!(!log.contains("Overfull"), "{path:?} {symbols}\n{log}");
    }
}

#[test]
fn what_is_no_polynomial_is_refused() {
    let folder = Folder::new();
    let yaml = "abbe: 1\nmachine: M\nchain: \"w C' b X t\"\nconventions: { location_order: real }\n\
                axes: { X: { travel: [0, 1], origin: [0, 0, 0] }, C: { travel: continuous } }\nerrors: { EA0C: 3 urad }\n";
    let path = folder.write("machine.yaml", yaml);
    let (_, complaint, exit) = abbe(&[path.to_str().unwrap()]);
    assert!(exit == 1 && complaint.contains("E0525") && complaint.contains("EA0C"), "{complaint}");
    let (_, _, exit) = abbe(&[path.to_str().unwrap(), "--order", "1", "--algebra", "degree: 2"]);
    assert_eq!(exit, 2);
    let (_, _, exit) = abbe(&[path.to_str().unwrap(), "--format", "csv"]);
    assert_eq!(exit, 2);
}

/// The terms of a polynomial of the program's JSON.
fn program_terms(polynomial: &Value, order: u64) -> Terms {
    let terms = polynomial["terms"].as_array().unwrap().iter().filter(|term| term["order"] == order);
    let powers = |p: &Value| p.as_object().unwrap().iter().map(|(s, p)| (s.clone(), p.as_u64().unwrap())).collect();
    terms.map(|term| (powers(&term["powers"]), term["coefficient"].as_f64().unwrap())).collect()
}

/// The 2015 Dx, Dy, Dz in a, b, c, f1 to h3, as printed: those that SymPy multiplied out.
#[test]
fn the_program_prints_2015_in_the_papers_own_parameters() {
    let file = configs::folder().join("../docs/examples/paper-2015/as-printed.yaml");
    let file = file.to_str().unwrap();
    let asked = ["--order", "2", "--symbols", "parameters", "--tool-length", "--factors"];
    let (out, complaint, exit) = abbe(&[&[file, "--format", "json"][..], &asked].concat());
    assert_eq!(exit, 0, "{complaint}");
    let json: Value = serde_json::from_str(&out).unwrap();
    let sympy = sympy();
    for (k, axis) in ["Dx", "Dy", "Dz"].iter().enumerate() {
        for order in 0..=2 {
            let theirs = expected(&sympy["holub_printed"][axis][order]);
            same(&program_terms(&json["deviation"][k], order as u64), &theirs, &format!("{axis} order {order}"));
        }
    }
    // T_x E_x as printed: N is a translation along x, E the matrix of its six errors.
    let factors = &json["factors"]["X"];
    assert_eq!([&factors[0]["name"], &factors[1]["name"]], ["N", "E"]);
    let text = |f: usize, i: usize, j: usize| factors[f]["matrix"][i][j]["text"].as_str().unwrap().to_owned();
    assert_eq!([text(0, 0, 3), text(0, 1, 3), text(1, 0, 3)], ["x", "0", "x*a"]);
    assert_eq!([text(1, 0, 1), text(1, 1, 0), text(1, 1, 2), text(1, 1, 3)], ["-x*f2", "x*f2", "-x*f3", "1/2*x^2*f1"]);
    let (out, _, _) = abbe(&[&[file, "--latex"][..], &asked].concat());
    assert!(out.contains("f_{2}") && out.contains("$G_{X} = N\\;E$") && out.contains("\\subsection*{Chain}"), "{out}");
    let (_, complaint, exit) =
        abbe(&[configs::folder().join("trunnion.yaml").to_str().unwrap(), "--symbols", "parameters"]);
    assert!(exit == 1 && complaint.contains("E0525") && complaint.contains("no parameters of its own"), "{complaint}");
}

/// The factors of every joint multiply to its matrix, in every convention.
#[test]
fn factors_multiply_to_joints() {
    let mut random = Random::new(43);
    for conventions in combinations() {
        let sample = Sample::random(&mut random, conventions, 1e-4);
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let machine = load(&folder.path("machine.yaml"));
        let found = of_order(&machine, 1, Options::default());
        for (joint, (name, whole)) in found.factors.iter().zip(&found.joints) {
            let product = joint.factors.iter().fold(abbe::algebra::Htm::identity(), |p, f| p.compose(&f.matrix));
            assert_eq!(&joint.name, name);
            let gap =
                (product.to_matrix() - whole.to_matrix()).map(|p| p.terms().map(|(_, c)| c.abs()).fold(0.0, f64::max));
            assert!(gap.iter().all(|x| *x < 1e-9), "{name}: {gap:?}");
        }
    }
}
