//! A compiled module and its promises.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3, Vector6};

use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample};
use crate::oracle::matrix::{M4, V3, cross, minus, mul, norm, transposed};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;

/// Answer of the module about a pose.
pub struct Answer {
    pub joints: [f64; 9],
    pub back: [f64; 9],
    pub failures: i32,
}

/// A compiled module.
pub struct Module {
    folder: Folder,
}

/// Values of its pins, and a pose of the world.
#[derive(Clone, Copy)]
pub struct Ask {
    pub share: f64,
    pub orientation: bool,
    pub tool: V3,
    pub world: [f64; 9],
    /// Positions of the joints before.
    pub start: [f64; 9],
}

impl Module {
    /// Builds the module of a compiled set, any warning being an error.
    pub fn build(set: &Path) -> Self {
        Self::build_with(set, &[])
    }

    /// The same with flags of the compiler.
    pub fn build_with(set: &Path, flags: &[&str]) -> Self {
        let folder = Folder::new();
        let component = std::fs::read_to_string(set.join("abbekins.comp")).unwrap();
        let (declarations, wiring) = component.split_once("\n;;\n").unwrap();
        assert!(declarations.contains("include \"abbekins_solve.h\";"));
        let shim = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/linuxcnc");
        let main = std::fs::read_to_string(shim.join("kins_main.c")).unwrap();
        let _ = folder.write("all.c", &format!("#include \"shim.h\"\n{wiring}\n{main}"));
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-D_POSIX_C_SOURCE=199309L", "-Wall", "-Wextra", "-Werror", "-O0"])
            .args(flags)
            .arg("-I")
            .arg(&shim);
        let done =
            cc.arg("-I").arg(set).arg("-o").arg(folder.path("all")).arg(folder.path("all.c")).arg("-lm").output();
        let done = done.unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        Self { folder }
    }

    /// Runs the servo cycles of 1 ms of a module that stands at the first pose while its pins are given one tool after
    /// the other, as long each: joints, then the pins tool-ramping, tool-refused, pole-zone and pole-angle.
    pub fn ramped(&self, asked: &[Ask]) -> Vec<[f64; 13]> {
        let mut run = Command::new(self.folder.path("all"));
        let mut run = run.arg("ramp").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let input: String = asked.iter().map(Ask::text).collect();
        run.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        let output = run.wait_with_output().unwrap();
        assert!(output.status.success());
        let row = |line: &str| {
            let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
            std::array::from_fn(|i| numbers[i])
        };
        String::from_utf8(output.stdout).unwrap().lines().map(row).collect()
    }

    pub fn answers(&self, asked: &[Ask]) -> Vec<Answer> {
        let mut run =
            Command::new(self.folder.path("all")).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let input: String = asked.iter().map(Ask::text).collect();
        let mut stdin = run.stdin.take().unwrap();
        let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
        let output = run.wait_with_output().unwrap();
        writer.join().unwrap().unwrap();
        assert!(output.status.success());
        let answer = |line: &str| {
            let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
            let nine = |from: usize| std::array::from_fn(|i| numbers[from + i]);
            Answer { joints: nine(0), back: nine(9), failures: numbers[19] as i32 }
        };
        let answers: Vec<Answer> = String::from_utf8(output.stdout).unwrap().lines().map(answer).collect();
        assert_eq!(answers.len(), asked.len());
        answers
    }
}

impl Ask {
    fn text(&self) -> String {
        let numbers: Vec<String> = self.tool.iter().chain(&self.world).chain(&self.start).map(f64::to_string).collect();
        format!("1 {} {} {}\n", self.share, u8::from(self.orientation), numbers.join(" "))
    }
}

/// Kinds of the program's words, by their number in the files.
const TIP: f64 = 0.0;
const POSE: f64 = 1.0;
const AXES: f64 = 2.0;

/// The numbers of an array of the files.
fn array(set: &Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(set.join("abbekins_data.h")).unwrap();
    let (_, values) = text.split_once(&format!(" {name}[")).unwrap().1.split_once("= {").unwrap();
    values.split_once('}').unwrap().0.split(',').map(|x| x.trim().parse().unwrap()).collect()
}

/// A machine and its module. The files give the joint and the word of an axis; the oracle gives the place of the tool
/// and the possible corrections of the axes.
pub struct Bench<'a> {
    sample: &'a Sample,
    words: f64,
    arm: f64,
    /// Coordinate of its own, or -1.
    coordinates: Vec<f64>,
    joints: Vec<usize>,
    solved: Vec<bool>,
}

/// The tool at a pose, and its motion by each axis: displacement of the tip and rotation, per mm or rad.
struct Motions {
    tip: Vec<Vector3<f64>>,
    turn: Vec<Vector3<f64>>,
    axis: Vector3<f64>,
}

impl<'a> Bench<'a> {
    pub fn new(sample: &'a Sample, set: &Path) -> Self {
        let flags = |name| array(set, name).into_iter().map(|x| x == 1.0).collect();
        Self {
            sample,
            words: array(set, "abbe_words")[0],
            arm: array(set, "abbe_arm")[0],
            coordinates: array(set, "abbe_coordinate"),
            joints: array(set, "abbe_joint").into_iter().map(|x| x as usize).collect(),
            solved: flags("abbe_solved"),
        }
    }

    /// Returns the kind of the program's words: `tip`, `pose` or `axes`.
    pub fn words(&self) -> &'static str {
        ["tip", "pose", "axes"][self.words as usize]
    }

    /// Returns the largest difference (mm, deg) between two solutions for the same command: the pose of a robot is
    /// found to 1e-12 rad, its joints to that over the damping.
    pub fn rounded(&self) -> f64 {
        if self.words == POSE { 1e-8 } else { 1e-9 }
    }

    pub fn ask(&self, pose: &Pose, share: f64) -> Ask {
        let rigid = &self.sample.rigid;
        let [_, nominal] = self.sample.holds(pose, Travel::Mean);
        let [_, zero] = self.sample.holds(&vec![0.0; pose.len()], Travel::Mean);
        let (mut world, mut start) = ([0.0; 9], [0.0; 9]);
        if self.words != AXES {
            world[..3].copy_from_slice(&minus(nominal.tip, zero.tip));
        }
        if self.words == POSE {
            world[3..6].copy_from_slice(&angles(&nominal.rotation));
        }
        for (i, q) in pose.iter().enumerate() {
            start[self.joints[i]] = q + 0.2 * f64::from(i as u32).cos();
            if self.coordinates[i] >= 0.0 {
                world[self.coordinates[i] as usize] = *q;
            }
        }
        Ask { share, orientation: true, tool: rigid.offset.map(|x| -x), world, start }
    }

    /// Returns the same with the word of an axis moved, the tip where it is on the part.
    pub fn turned(&self, pose: &Pose, axis: usize, by: f64) -> Ask {
        let mut ask = self.ask(pose, 1.0);
        ask.world[self.coordinates[axis] as usize] += by;
        ask
    }

    /// Returns the command in the order of the walk.
    pub fn command(&self, answer: &Answer) -> Pose {
        self.joints.iter().map(|joint| answer.joints[*joint]).collect()
    }

    /// Returns the motions by central differences of the nominal machine.
    fn motions(&self, pose: &Pose) -> Motions {
        const STEP: f64 = 1e-2;
        let held = |axis: usize, by: f64| {
            let mut pose = pose.clone();
            pose[axis] += by;
            self.sample.holds(&pose, Travel::Mean)[1]
        };
        let (mut tip, mut turn) = (Vec::new(), Vec::new());
        for axis in 0..pose.len() {
            let unit = 2.0 * if self.sample.rigid.walk[axis].rotary { STEP.to_radians() } else { STEP };
            let [ahead, behind] = [STEP, -STEP].map(|by| held(axis, by));
            tip.push(Vector3::from(minus(ahead.tip, behind.tip)) / unit);
            // The sine of a hundredth of a degree is its angle to 5e-9.
            turn.push(skew(&mul(&ahead.rotation, &transposed(&behind.rotation))) / unit);
        }
        let axis = self.sample.holds(pose, Travel::Mean)[1].axis();
        Motions { tip, turn, axis: Vector3::from(axis) }
    }

    /// Returns the weakest of the six motions that the solved axes give the tool (arms, rad).
    fn whole(&self, motions: &Motions) -> f64 {
        let solved = (0..self.solved.len()).filter(|i| self.solved[*i]);
        let column = |i: usize| {
            let (p, t) = (motions.tip[i], motions.turn[i]);
            let p = if self.sample.rigid.walk[i].rotary { p / self.arm } else { p };
            Vector6::new(p[0], p[1], p[2], t[0], t[1], t[2])
        };
        let columns: Vec<_> = solved.map(column).collect();
        Matrix6::from_columns(&columns).try_inverse().map_or(0.0, |inverse| inverse.norm().recip())
    }

    /// Returns the tilt of the tool axis by each rotary axis, per rad. By differences of the oracle.
    fn tilts(&self, pose: &Pose) -> Vec<V3> {
        const STEP: f64 = 1e-3;
        let axis_at = |axis: usize, by: f64| {
            let mut pose = pose.clone();
            pose[axis] += by;
            self.sample.holds(&pose, Travel::Mean)[1].axis()
        };
        let rotary = (0..pose.len()).filter(|i| self.sample.rigid.walk[*i].rotary);
        rotary.map(|i| minus(axis_at(i, STEP), axis_at(i, -STEP)).map(|x| x / (2.0 * STEP.to_radians()))).collect()
    }

    /// The last rotary axis of the walk.
    pub fn last(&self) -> usize {
        self.sample.rigid.walk.iter().rposition(|axis| axis.rotary).unwrap()
    }

    /// The pose with the last of two rotary axes where both tilt the tool in one direction, so that they hold none of the
    /// other; none if no turn of it does that.
    pub fn singular(&self, pose: &Pose) -> Option<Pose> {
        let at = |q: f64| {
            let mut pose = pose.clone();
            pose[self.last()] = q;
            pose
        };
        let area = |q: f64| {
            let tilts = self.tilts(&at(q));
            let axis = self.sample.holds(&at(q), Travel::Mean)[1].axis();
            cross(tilts[0], tilts[1]).iter().zip(axis).map(|(a, b)| a * b).sum::<f64>()
        };
        let [low, high] = self.sample.axes[self.last()].travel.unwrap_or([-180.0, 180.0]);
        let places: Vec<f64> = (2..=34).map(|k| low + (high - low) * f64::from(k) / 36.0).collect();
        let pair = places.windows(2).find(|pair| area(pair[0]) * area(pair[1]) < 0.0)?;
        let (mut from, mut to) = (pair[0], pair[1]);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if area(from) * area(middle) <= 0.0 { to = middle } else { from = middle }
        }
        Some(at(from))
    }

    /// At poses beside a singular one: error of the tip and of the inverse solution (mm, deg), number of refused
    /// inverse solutions, and the corrected commands with the largest motion of a rotary axis as a fraction of the
    /// damping's bound.
    pub fn beside_singular(&self, module: &Module, poses: &[Pose]) -> ([f64; 2], usize, Vec<(Pose, f64)>) {
        let asked: Vec<Ask> = poses.iter().map(|pose| self.ask(pose, 1.0)).collect();
        let (mut worst, mut refused, mut commands) = ([0.0_f64; 2], 0, Vec::new());
        for ((pose, ask), answer) in poses.iter().zip(&asked).zip(module.answers(&asked)) {
            assert_eq!(answer.failures, 0, "{pose:?}");
            let command = self.command(&answer);
            worst[0] = worst[0].max(self.missed(pose, &command)[0].unwrap());
            if answer.back[0].is_nan() {
                refused += 1;
            } else {
                worst[1] = answer.back.iter().zip(ask.world).map(|(a, b)| (a - b).abs()).fold(worst[1], f64::max);
            }
            let [real, wanted] = self.sample.holds(pose, Travel::Mean);
            let unit = |v: V3| v.map(|x| x / norm(v));
            let tilt = norm(cross(unit(wanted.axis()), unit(real.axis())));
            let rotary = (0..pose.len()).filter(|i| self.sample.rigid.walk[*i].rotary);
            let moved = rotary.map(|i| (command[i] - pose[i]).abs().to_radians()).fold(0.0, f64::max);
            commands.push((command, moved / (tilt / 1.0_f64.to_radians().sin())));
        }
        (worst, refused, commands)
    }

    /// The weaker of the two tilts of the tool axis that a turn of rotary axes by 1 makes: the sine of the
    /// angle from a singular pose of two orthogonal axes.
    fn agility(&self, pose: &Pose) -> f64 {
        let ways = self.tilts(pose);
        // Sum of squares of the areas, over the larger eigenvalue: the smaller one.
        let trace: f64 = ways.iter().map(|w| norm(*w).powi(2)).sum();
        let pairs =
            ways.iter().enumerate().flat_map(|(i, a)| ways[..i].iter().map(move |b| norm(cross(*a, *b)).powi(2)));
        let determinant: f64 = pairs.sum();
        let spread = (0.25 * trace * trace - determinant).max(0.0).sqrt();
        (determinant / (0.5 * trace + spread).max(1e-12)).sqrt()
    }

    /// The residual that the axes can reach of a deviation of tip and tool axis: linear axes first, then rotary ones of
    /// the tip, then of the tool axis. `None` where a direction is so weak that corrections are bounded.
    fn reachable(&self, motions: &Motions, tip: Vector3<f64>, tilt: Vector3<f64>) -> Option<[f64; 2]> {
        let walk = &self.sample.rigid.walk;
        let chosen = |rotary: bool| (0..walk.len()).filter(move |i| walk[*i].rotary == rotary);
        let linear: Vec<_> = chosen(false).filter(|i| self.solved[*i]).map(|i| motions.tip[i]).collect();
        let base = span(&linear, 1e-2)?;
        let across = |v: Vector3<f64>, base: &[Vector3<f64>]| base.iter().fold(v, |v, u| v - u * u.dot(&v));
        let rotary: Vec<usize> = chosen(true).collect();
        let levers: Vec<_> = rotary.iter().map(|i| across(motions.tip[*i], &base) / self.arm).collect();
        let more = span(&levers, DAMPED)?;
        let whole = [base, more.clone()].concat();
        // Turns that leave the tip in place: the null space of the rows of the levers.
        let rows = DMatrix::from_fn(more.len(), levers.len(), |r, c| more[r].dot(&levers[c]));
        let gram = &rows * rows.transpose();
        let inverse = gram.try_inverse().unwrap_or_else(|| DMatrix::zeros(0, 0));
        let free = DMatrix::identity(levers.len(), levers.len()) - rows.transpose() * inverse * &rows;
        let tilts = DMatrix::from_fn(3, rotary.len(), |r, c| across(motions.turn[rotary[c]], &[motions.axis])[r]);
        let tilts = tilts * free;
        let tilts: Vec<_> =
            (0..rotary.len()).map(|c| Vector3::new(tilts[(0, c)], tilts[(1, c)], tilts[(2, c)])).collect();
        let ways = span(&tilts, DAMPED)?;
        let within = |v: Vector3<f64>, base: &[Vector3<f64>]| (v - across(v, base)).norm();
        Some([within(tip, &whole), within(tilt, &ways)])
    }

    /// Distance of tip (mm) and tool (rad) from the best that the machine could do; `None` where corrections are
    /// bounded.
    fn missed(&self, pose: &Pose, command: &Pose) -> [Option<f64>; 2] {
        let [real, _] = self.sample.holds(command, Travel::Mean);
        let [_, wanted] = self.sample.holds(pose, Travel::Mean);
        let unit = |v: V3| v.map(|x| x / norm(v));
        let tip = minus(real.tip, wanted.tip);
        let tilt = cross(unit(wanted.axis()), unit(real.axis()));
        if self.words == TIP {
            let far = self.agility(pose) > 1.0_f64.to_radians().sin();
            return [Some(norm(tip)), far.then(|| norm(tilt))];
        }
        let motions = self.motions(pose);
        if self.words == POSE {
            let turned = skew(&mul(&real.rotation, &transposed(&wanted.rotation))).norm();
            let regular = self.whole(&motions) > DAMPED;
            return [regular.then(|| norm(tip)), regular.then_some(turned)];
        }
        match self.reachable(&motions, Vector3::from(tip), Vector3::from(tilt)) {
            Some([tip, tilt]) => [Some(tip), Some(tilt)],
            None => [None; 2],
        }
    }

    /// Checks all promises of a module at poses: the tip, the tool, the inverse, the switch. Where corrections are
    /// bounded a robot may refuse a pose. Returns the largest of each, and the number of poses at which the tip was
    /// held.
    pub fn promises(&self, module: &Module, poses: &[Pose]) -> ([f64; 3], usize) {
        let asked = |share: f64| poses.iter().map(move |pose| self.ask(pose, share));
        let all = module.answers(&asked(1.0).chain(asked(0.0)).chain(asked(0.5)).collect::<Vec<_>>());
        let (mut worst, mut held, mut failures, mut refused) = ([0.0_f64; 3], 0, 0, 0);
        for (k, pose) in poses.iter().enumerate() {
            let [on, off, half] = [0, 1, 2].map(|part| &all[part * poses.len() + k]);
            let failed = on.failures > failures;
            failures = on.failures;
            if failed {
                // Near a singular pose the iteration may not settle; then the controller stops with a message.
                refused += 1;
                let weak = self.words == POSE && self.whole(&self.motions(pose)) < 2.0 * DAMPED;
                assert!(weak || self.words == AXES, "{pose:?}");
                continue;
            }
            let command = self.command(on);
            let missed = self.missed(pose, &command);
            held += usize::from(missed[0].is_some());
            (0..2).for_each(|i| worst[i] = worst[i].max(missed[i].unwrap_or(0.0)));
            if self.words == POSE && missed[0].is_none() {
                continue;
            }
            let world = self.ask(pose, 1.0).world;
            for answer in [on, off, half] {
                if answer.back[0].is_nan() {
                    // Next to a singular pose corrections may change faster than the axes that they correct; a part
                    // of them is found back by a plainer iteration than all of them.
                    let part = std::ptr::eq(answer, half);
                    assert!((part || missed[0].is_none()) && self.words != TIP, "{pose:?}");
                    continue;
                }
                let gap = |i: usize| (answer.back[i] - world[i]).abs();
                worst[2] = (0..9).map(gap).fold(worst[2], f64::max);
            }
            let (nominal, middle) = (self.command(off), self.command(half));
            for axis in 0..pose.len() {
                assert!((nominal[axis] - pose[axis]).abs() < self.rounded(), "{nominal:?} {pose:?}");
                assert!((middle[axis] - 0.5 * (pose[axis] + command[axis])).abs() < self.rounded());
            }
        }
        assert!(self.words == POSE || refused * 10 <= poses.len(), "{refused} of {}", poses.len());
        (worst, held)
    }
}

/// Below this sine, and a little above it, corrections are bounded.
const DAMPED: f64 = 0.018;

/// Orthonormal directions of a set of vectors; `None` if one of them is weaker than a threshold, but there.
fn span(vectors: &[Vector3<f64>], weak: f64) -> Option<Vec<Vector3<f64>>> {
    let gram: Matrix3<f64> = vectors.iter().map(|v| v * v.transpose()).sum();
    let parts = gram.symmetric_eigen();
    let mut found = Vec::new();
    for (k, square) in parts.eigenvalues.iter().enumerate() {
        let size = square.max(0.0).sqrt();
        if size > weak {
            found.push(parts.eigenvectors.column(k).into_owned());
        } else if size > 1e-6 {
            return None;
        }
    }
    Some(found)
}

/// The vector of the skew part.
fn skew(m: &M4) -> Vector3<f64> {
    Vector3::new(m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]) * 0.5
}

/// Roll, pitch and yaw in deg.
fn angles(m: &M4) -> V3 {
    let pitch = (-m[2][0]).atan2(m[0][0].hypot(m[1][0]));
    [m[2][1].atan2(m[2][2]), pitch, m[1][0].atan2(m[0][0])].map(f64::to_degrees)
}

/// Poses a little inside the travels, so that corrected commands are still on the oracle's curves; every
/// fifth near one where all rotary axes are at 0.
pub fn poses(sample: &Sample, random: &mut Random, count: usize) -> Vec<Pose> {
    let pose = |k: usize| {
        let position = |i: usize| {
            let [low, high] = sample.axes[i].travel.unwrap_or([-500.0, 800.0]);
            let (middle, half) = (0.5 * (low + high), 0.45 * (high - low));
            let near = if k.is_multiple_of(10) { 1e-9 } else { 1.0 };
            let small = sample.rigid.walk[i].rotary && k.is_multiple_of(5) && low < -1.0 && high > 1.0;
            if small { random.around(near) } else { middle + random.around(half) }
        };
        (0..sample.axes.len()).map(position).collect()
    };
    (0..count).map(pose).collect()
}
