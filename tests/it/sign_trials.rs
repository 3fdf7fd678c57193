//! Sign tests of kinematic parameters, carried out: chains of vectors as the manifests state them, with each vector
//! reversed and with two of them exchanged. Only the stated hypothesis gives the readings that the certificate prints.

use crate::kinematic_parameters::{head_head, head_table, table_table};
use crate::oracle::matrix::{M4, ONE, V3, apply, exp, inverse, minus, mul, norm, plus, translation, twist};
use crate::oracle::program::Folder;
use crate::support::{Run, abbe};

/// Vectors of a control, by the names of their components.
#[derive(Clone, Debug)]
struct Vector {
    names: [String; 3],
    value: V3,
    direction: bool,
}

/// A rotary axis in the walk from the linear axes: indices of its offset and direction, name, nominal direction.
struct Turn(usize, Option<usize>, &'static str, V3);

/// One side: offsets lead from the gauge point over its axes and back by `closing`; or, `inward`, from the gauge point
/// over the axis of the tool to those before it, and back.
#[derive(Default)]
struct Side {
    turns: Vec<Turn>,
    closing: Option<usize>,
    inward: bool,
}

struct Control {
    vectors: Vec<Vector>,
    table: Side,
    head: Side,
    tool: Option<usize>,
    /// True if vectors of directions of the table's side are those about which the moved body turns.
    reversed: bool,
    /// Length of the tool, mm.
    length: f64,
    /// Vectors that act alike whatever the pose: both lead from the linear axes to a first rotary axis.
    alike: Option<[usize; 2]>,
}

fn rotation(u: V3, degrees: f64) -> M4 {
    let scaled = u.map(|c| c / norm(u) * degrees.to_radians());
    exp(&twist([0.0, 0.0, 0.0, scaled[0], scaled[1], scaled[2]]))
}

fn negative(v: V3) -> V3 {
    v.map(|c| -c)
}

impl Control {
    /// The walk of one side with these vectors: `off1 R1 off2 R2 ... closing`, angles by name.
    fn walk(&self, side: &Side, of_table: bool, vectors: &[V3], angle: &dyn Fn(&str) -> f64) -> M4 {
        let sum = side.turns.iter().fold([0.0; 3], |sum, turn| plus(sum, vectors[turn.0]));
        let back = side.closing.map_or(negative(sum), |index| vectors[index]);
        let mut walk = if side.inward { translation(negative(back)) } else { ONE };
        for Turn(offset, direction, axis, nominal) in &side.turns {
            let stored = if of_table && self.reversed { -1.0 } else { 1.0 };
            let u = direction.map_or(*nominal, |index| vectors[index].map(|c| c * stored));
            let turned = rotation(u, if of_table { -angle(axis) } else { angle(axis) });
            let offset = vectors[*offset];
            walk = match side.inward {
                true => mul(&mul(&walk, &turned), &translation(negative(offset))),
                false => mul(&mul(&walk, &translation(offset)), &turned),
            };
        }
        if side.inward { walk } else { mul(&walk, &translation(back)) }
    }

    /// Position of X, Y and Z for a point of the workpiece.
    fn linear(&self, vectors: &[V3], point: V3, angle: &dyn Fn(&str) -> f64, length: f64) -> V3 {
        let axis = self.tool.map_or([0.0, 0.0, 1.0], |index| vectors[index]);
        let tip = axis.map(|c| -c * length / norm(axis));
        let on_table = apply(&self.walk(&self.table, true, vectors, angle), point);
        minus(on_table, apply(&self.walk(&self.head, false, vectors, angle), tip))
    }

    /// The point of the workpiece at which the tool stands at a pose of the nominal machine.
    fn point(&self, place: V3, angle: &dyn Fn(&str) -> f64, length: f64) -> V3 {
        let own: Vec<V3> = self.vectors.iter().map(|vector| vector.value).collect();
        let tip = apply(&self.walk(&self.head, false, &own, angle), [0.0, 0.0, -length]);
        apply(&inverse(&self.walk(&self.table, true, &own, angle)), plus(place, tip))
    }
}

/// A step as it is printed.
#[derive(Debug)]
struct Step {
    changes: Vec<(String, f64)>,
    pose: Vec<(String, f64)>,
    tool: Option<f64>,
    axis: usize,
    reading: f64,
    unturned: Option<f64>,
}

fn first_number(text: &str) -> f64 {
    text.split_whitespace().next().unwrap().trim_end_matches(['.', ',']).parse().unwrap_or_else(|_| panic!("{text}"))
}

fn step(line: &str) -> Option<Step> {
    let (number, rest) = line.trim_start().split_once(". ")?;
    let _: usize = number.parse().ok()?;
    let (changes, rest) = rest.split_once(". At ")?;
    let changes = changes.split(", ").map(|change| {
        let words: Vec<&str> = change.split(' ').collect();
        let by: f64 = words[3].parse().unwrap();
        (words[1].to_owned(), if words[0] == "lower" { -by } else { by })
    });
    let (place, rest) = rest.split_once(": ")?;
    let (place, tool) =
        place.split_once(", with a tool length of ").map_or((place, None), |(p, t)| (p, Some(first_number(t))));
    let words: Vec<&str> = place.split(' ').collect();
    let pose = words.chunks(2).map(|pair| (pair[0].to_owned(), pair[1].parse().unwrap())).collect();
    let axis = "XYZ".find(&rest[..1])?;
    let reading = first_number(rest.split_once("must change by ")?.1);
    let unturned = rest.split_once("With the rotary axes at 0: ").map(|(_, text)| first_number(text));
    Some(Step { changes: changes.collect(), pose, tool, axis, reading, unturned })
}

impl Control {
    /// What a step reads, turned and with the rotary axes at 0, when vector `i` has the sense `signs[i]` and takes what
    /// is entered for vector `place[i]`.
    fn reading(&self, step: &Step, signs: &[f64], place: &[usize]) -> [f64; 2] {
        let length = step.tool.unwrap_or(self.length);
        let own: Vec<V3> = self.vectors.iter().map(|vector| vector.value).collect();
        let by = |i: usize| -> V3 {
            self.vectors[place[i]].names.clone().map(|name| {
                step.changes.iter().find(|(changed, _)| *changed == name).map_or(0.0, |(_, by)| by * signs[i])
            })
        };
        let after: Vec<V3> = own.iter().enumerate().map(|(i, vector)| plus(*vector, by(i))).collect();
        let at = |name: &str| step.pose.iter().find(|(axis, _)| axis == name).unwrap().1;
        let place = [at("X"), at("Y"), at("Z")];
        [1.0, 0.0].map(|turned| {
            let angle = |name: &str| turned * at(name);
            let point = self.point(place, &angle, length);
            let [before, after] = [&own, &after].map(|vectors| self.linear(vectors, point, &angle, length));
            after[step.axis] - before[step.axis]
        })
    }

    /// Carries all steps out: the stated readings come, and none of the other hypotheses gives them all.
    fn judge(&self, steps: &[Step], what: &str) {
        let count = self.vectors.len();
        let (right, order) = (vec![1.0; count], (0..count).collect::<Vec<usize>>());
        for step in steps {
            let [turned, unturned] = self.reading(step, &right, &order);
            assert!((turned - step.reading).abs() < 1e-3, "{what}: {turned} {step:?}");
            assert!((unturned - step.unturned.unwrap_or(step.reading)).abs() < 1e-3, "{what}: {unturned} {step:?}");
            assert!(step.reading.abs() >= 0.02, "{what}: {step:?}");
        }
        let told = |signs: &[f64], order: &[usize]| {
            let off = |step: &Step| {
                let found = self.reading(step, signs, order);
                (found[0] - step.reading).abs().max((found[1] - step.unturned.unwrap_or(step.reading)).abs())
            };
            steps.iter().map(off).fold(0.0, f64::max)
        };
        for i in 0..count {
            let mut signs = right.clone();
            signs[i] = -1.0;
            let seen = told(&signs, &order);
            assert!(seen >= 0.019, "{what}: reversed {:?} shows {seen}", self.vectors[i].names);
            for j in 0..i {
                let differ = self.alike.is_none_or(|pair| pair != [j, i]);
                if differ && self.vectors[i].direction == self.vectors[j].direction {
                    let mut exchanged = order.clone();
                    exchanged.swap(i, j);
                    let seen = told(&right, &exchanged);
                    let names = [i, j].map(|k| &self.vectors[k].names);
                    assert!(seen >= 0.019, "{what}: exchanged {names:?} shows {seen}");
                }
            }
        }
    }
}

fn steps(text: &str, target: &str) -> Vec<Step> {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", text);
    let mut run = abbe();
    run.arg("compile").arg(machine).args([
        "--target",
        target,
        "--accept-unverified",
        "--nothing-else",
        "--poses",
        "20",
    ]);
    let run = Run::of(run.arg("--out").arg(folder.path("out")));
    let found: Vec<Step> = run.out.lines().filter_map(step).collect();
    assert!(!found.is_empty(), "{target}: {}{}", run.out, run.err);
    found
}

/// The nominal places of the axes of the machines of `kinematic_parameters`, from the gauge point.
const TRUNNION: [V3; 2] = [[240.0, 205.0, -380.0], [240.0, 205.0, -410.0]];
const FORK: [V3; 2] = [[5.0, 3.0, -40.0], [12.0, 0.0, 220.0]];
const MIXED: [V3; 2] = [[250.0, 225.0, -380.0], [1.0, 2.0, 220.0]];

/// What a control has.
#[derive(Clone, Copy)]
struct Layout {
    target: &'static str,
    /// Of two axes on one side to the first, to the second, back; of mixed machines to the head, back, to the table,
    /// back.
    offsets: [&'static str; 4],
    directions: [&'static str; 2],
    tool: &'static str,
    /// The name of a component: `#` is its letter or place.
    marks: [&'static str; 3],
    inward: bool,
}

struct Vectors(Layout, Vec<Vector>);

impl Vectors {
    fn add(&mut self, name: &str, value: V3, direction: bool) -> Option<usize> {
        if name.is_empty() {
            return None;
        }
        let number = name.parse::<u32>().ok();
        let component = |k: usize| match number {
            Some(first) => (first + k as u32).to_string(),
            None => name.replace('#', self.0.marks[k]),
        };
        self.1.push(Vector { names: [0, 1, 2].map(component), value, direction });
        Some(self.1.len() - 1)
    }
}

const A: V3 = [1.0, 0.0, 0.0];
const B: V3 = [0.0, 1.0, 0.0];
const C: V3 = [0.0, 0.0, 1.0];

impl Layout {
    fn of_tables(self) -> Control {
        let mut all = Vectors(self, Vec::new());
        let [first, second] = TRUNNION;
        let one = all.add(self.offsets[0], first, false).unwrap();
        let two = all.add(self.offsets[1], minus(second, first), false).unwrap();
        let closing = all.add(self.offsets[2], negative(second), false);
        let a = all.add(self.directions[0], negative(A), true);
        let c = all.add(self.directions[1], negative(C), true);
        let tool = all.add(self.tool, C, true);
        let table = Side { turns: vec![Turn(one, a, "A", A), Turn(two, c, "C", C)], closing, inward: false };
        Control { vectors: all.1, table, head: Side::default(), tool, reversed: true, length: 120.0, alike: None }
    }

    fn of_heads(self) -> Control {
        let mut all = Vectors(self, Vec::new());
        let [ram, carried] = FORK;
        let b = [0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()];
        let points = if self.inward { [carried, ram] } else { [ram, carried] };
        let one = all.add(self.offsets[0], points[0], false).unwrap();
        let two = all.add(self.offsets[1], minus(points[1], points[0]), false).unwrap();
        let closing = all.add(self.offsets[2], negative(points[1]), false);
        let [of_c, of_b] = [(0, C), (1, b)].map(|(i, u)| all.add(self.directions[i], u, true));
        let tool = all.add(self.tool, C, true);
        let offsets = if self.inward { [two, one] } else { [one, two] };
        let turns = vec![Turn(offsets[0], of_c, "C", C), Turn(offsets[1], of_b, "B", b)];
        let head = Side { turns, closing, inward: self.inward };
        Control { vectors: all.1, table: Side::default(), head, tool, reversed: true, length: 150.0, alike: None }
    }

    /// The table of this machine turns right-handed.
    fn of_both(self) -> Control {
        let mut all = Vectors(self, Vec::new());
        let [table, head] = MIXED;
        let one = all.add(self.offsets[0], head, false).unwrap();
        let head_back = all.add(self.offsets[1], negative(head), false);
        let two = all.add(self.offsets[2], table, false).unwrap();
        let closing = all.add(self.offsets[3], negative(table), false);
        let of_head = all.add(self.directions[0], B, true);
        let of_table = all.add(self.directions[1], C, true);
        let tool = all.add(self.tool, C, true);
        let head = Side { turns: vec![Turn(one, of_head, "B", B)], closing: head_back, inward: self.inward };
        let table = Side { turns: vec![Turn(two, of_table, "C", negative(C))], closing, inward: false };
        let alike = head_back.filter(|_| self.inward).map(|back| [back, two]);
        Control { vectors: all.1, table, head, tool, reversed: true, length: 90.0, alike }
    }
}

const DIGITS: [&str; 3] = ["0", "1", "2"];
const LETTERS: [&str; 3] = ["X", "Y", "Z"];

#[test]
fn trials_of_two_axes_in_the_table() {
    let trafo = ["TRAFO5_AXIS1_1[#]", "TRAFO5_AXIS2_1[#]"];
    let none = ["", ""];
    for (target, offsets, directions, tool, marks) in [
        (
            "sinumerik-traori",
            ["TRAFO5_BASE_TOOL_1[#]", "TRAFO5_JOINT_OFFSET_1[#]", "TRAFO5_PART_OFFSET_1[#]", ""],
            trafo,
            "TRAFO5_BASE_ORIENT_1[#]",
            DIGITS,
        ),
        (
            "sinumerik-chain",
            ["NK_OFF_DIR[4,#]", "NK_OFF_DIR[6,#]", "NK_OFF_DIR[8,#]", ""],
            ["NK_OFF_DIR[5,#]", "NK_OFF_DIR[7,#]"],
            "NT_BASE_ORIENT[1,#]",
            DIGITS,
        ),
        ("fanuc-5axis", ["19700", "19703", "", ""], none, "", DIGITS),
        ("heidenhain-kinematics", ["Trans.1.#", "Trans.2.#", "", ""], none, "", LETTERS),
        ("haas-mrzp", ["25#", "25# ", "", ""], none, "", ["-", "6", "7"]),
    ] {
        let layout = Layout { target, offsets, directions, tool, marks, inward: false };
        let mut control = layout.of_tables();
        if target == "haas-mrzp" {
            control.vectors[1].names = ["", "254", ""].map(str::to_owned);
        }
        control.judge(&steps(&table_table(""), target), target);
    }
    let layout = Layout {
        target: "sinumerik-tcarr",
        offsets: ["", "", "", ""],
        directions: ["", ""],
        tool: "",
        marks: DIGITS,
        inward: false,
    };
    let carr = |first: usize| [0, 1, 2].map(|k| format!("TC_CARR{}[1]", first + k));
    let mut control = Layout { offsets: ["a", "b", "c", ""], directions: ["d", "e"], ..layout }.of_tables();
    control.vectors.iter_mut().zip([4, 15, 18, 7, 10]).for_each(|(vector, first)| vector.names = carr(first));
    control.judge(&steps(&table_table(""), layout.target), layout.target);
    let mut control =
        Layout { offsets: ["a", "b", "c", ""], directions: ["d", "e"], inward: true, ..layout }.of_heads();
    control.vectors.iter_mut().zip([15, 4, 1, 7, 10]).for_each(|(vector, first)| vector.names = carr(first));
    control.judge(&steps(&head_head(""), layout.target), "tcarr, heads");
    let both = Layout { offsets: ["a", "b", "c", "d"], directions: ["e", "f"], inward: true, ..layout };
    let mut control = both.of_both();
    control.vectors.iter_mut().zip([4, 1, 15, 18, 7, 10]).for_each(|(vector, first)| vector.names = carr(first));
    control.judge(&steps(&head_table(""), layout.target), "tcarr, mixed");
}

#[test]
fn trials_of_heads() {
    for (target, offsets, directions, tool, marks, inward) in [
        (
            "sinumerik-traori",
            ["TRAFO5_BASE_TOOL_1[#]", "TRAFO5_JOINT_OFFSET_1[#]", "TRAFO5_PART_OFFSET_1[#]", ""],
            ["TRAFO5_AXIS1_1[#]", "TRAFO5_AXIS2_1[#]"],
            "TRAFO5_BASE_ORIENT_1[#]",
            DIGITS,
            true,
        ),
        (
            "sinumerik-chain",
            ["NK_OFF_DIR[4,#]", "NK_OFF_DIR[6,#]", "NK_OFF_DIR[8,#]", ""],
            ["NK_OFF_DIR[5,#]", "NK_OFF_DIR[7,#]"],
            "NT_BASE_ORIENT[1,#]",
            DIGITS,
            false,
        ),
        ("fanuc-5axis", ["19709", "19712", "", ""], ["", ""], "", DIGITS, true),
        ("heidenhain-kinematics", ["Trans.1.#", "Trans.2.#", "", ""], ["", ""], "", LETTERS, true),
    ] {
        let layout = Layout { target, offsets, directions, tool, marks, inward };
        // A chain has the linear axes next to the bed.
        layout.of_heads().judge(&steps(&head_head(""), target), target);
    }
}

#[test]
fn trials_of_a_head_over_a_table() {
    for (target, offsets, directions, tool, marks, inward) in [
        (
            "sinumerik-traori",
            [
                "TRAFO5_BASE_TOOL_1[#]",
                "TRAFO5_JOINT_OFFSET_1[#]",
                "TRAFO5_JOINT_OFFSET_PART_1[#]",
                "TRAFO5_PART_OFFSET_1[#]",
            ],
            ["TRAFO5_AXIS1_1[#]", "TRAFO5_AXIS2_1[#]"],
            "TRAFO5_BASE_ORIENT_1[#]",
            DIGITS,
            true,
        ),
        ("fanuc-5axis", ["19709", "", "19700", ""], ["", ""], "", DIGITS, false),
        ("heidenhain-kinematics", ["Trans.1.#", "", "Trans.2.#", ""], ["", ""], "", LETTERS, false),
    ] {
        let layout = Layout { target, offsets, directions, tool, marks, inward };
        layout.of_both().judge(&steps(&head_table(""), target), target);
    }
}
