//! The machines in configs/ could be built: what their tables and heads are for is in reach.
//!
//! The linear axes are solved from the exact rigid-body model of the tests; the program's inverse kinematics takes no
//! part. Machines of `papers/` and `robots/` stay as they were published.

use crate::configs::folder;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::{V3, minus, norm, plus};
use crate::oracle::rigid::{Held, State};
use crate::support::config;

/// Machines with rotary axes, the work that they are for, and the place of a ball on their tables.
const MACHINES: [Work; 13] = [
    Work { config: "boring-w", up: [0.0, 1.0, 0.0], size: None, ball: [200.0, 300.0] },
    Work { config: "hh-bd-ram", up: Z, size: None, ball: [200.0, 100.0] },
    Work { config: "hh-ca-gantry", up: Z, size: Some(800.0), ball: [400.0, 200.0] },
    Work { config: "hh-cb-a-nut", up: Z, size: None, ball: [100.0, 50.0] },
    Work { config: "hmc-4ax", up: [0.0, 1.0, 0.0], size: None, ball: [70.0, 100.0] },
    Work { config: "ht-b-c", up: Z, size: Some(300.0), ball: [150.0, 75.0] },
    Work { config: "ht-nut45-c", up: Z, size: Some(300.0), ball: [150.0, 75.0] },
    Work { config: "millturn-bc", up: Z, size: Some(200.0), ball: [20.0, 300.0] },
    Work { config: "trunnion", up: Z, size: Some(200.0), ball: [100.0, 50.0] },
    Work { config: "tt-ab-desktop", up: [0.0, -1.0, 0.0], size: Some(40.0), ball: [20.0, 10.0] },
    Work { config: "tt-ac-800", up: Z, size: Some(300.0), ball: [150.0, 75.0] },
    Work { config: "tt-bc", up: Z, size: Some(200.0), ball: [100.0, 50.0] },
    Work { config: "tt-nut45", up: Z, size: Some(200.0), ball: [100.0, 50.0] },
];

const Z: V3 = [0.0, 0.0, 1.0];

/// Work of a machine, in its workpiece frame, mm.
struct Work {
    config: &'static str,
    /// The direction from the table to the part.
    up: V3,
    /// Diameter of a hemisphere on the workpiece origin, for machines with two rotary axes.
    size: Option<f64>,
    /// Distance of a ball from the workpiece origin along X, and its height.
    ball: [f64; 2],
}

impl Work {
    /// A point at a distance along X, one across, and a height.
    fn point(&self, along: f64, across: f64, height: f64) -> V3 {
        let [ux, uy, uz] = self.up;
        assert_eq!(ux, 0.0);
        // X, the direction across and `up` are a right-handed frame.
        [along, across * uz + height * uy, height * uz - across * uy]
    }
}

/// A machine and the axes that carry its tip to a place: the first three linear ones.
struct Machine {
    sample: Sample,
    linear: Vec<usize>,
    rotary: Vec<usize>,
}

impl Machine {
    fn new(config: &str) -> Self {
        let sample = config::sample(&folder().join(format!("{config}.yaml")));
        let (rotary, linear): (Vec<usize>, Vec<usize>) =
            (0..sample.rigid.walk.len()).partition(|axis| sample.rigid.walk[*axis].rotary);
        Self { linear: linear.into_iter().take(3).collect(), rotary, sample }
    }

    /// The range of an axis; all around for a continuous one.
    fn travel(&self, axis: usize) -> [f64; 2] {
        self.sample.axes[axis].travel.unwrap_or([0.0, 360.0])
    }

    /// All axes at zero, but a quill out all the way.
    fn start(&self) -> Vec<f64> {
        let walk = self.sample.rigid.walk.iter().enumerate();
        walk.map(|(i, axis)| if axis.name == "W" { self.travel(i)[0] } else { 0.0 }).collect()
    }

    /// The nominal tool at positions, mm and deg.
    fn holds(&self, at: &[f64]) -> Held {
        let state = |(axis, position): (usize, &f64)| State {
            position: if self.sample.rigid.walk[axis].rotary { position.to_radians() } else { *position },
            errors: [0.0; 6],
        };
        self.sample.rigid.holds(&at.iter().enumerate().map(state).collect::<Vec<_>>())[1]
    }

    /// Whether the linear axes carry the tip to a point while the others stay.
    fn reaches(&self, point: V3, at: &[f64]) -> bool {
        let mut pose = at.to_vec();
        self.linear.iter().for_each(|axis| pose[*axis] = 0.0);
        let start = self.holds(&pose).tip;
        let columns: Vec<V3> = self
            .linear
            .iter()
            .map(|axis| {
                pose[*axis] = 1.0;
                let moved = self.holds(&pose).tip;
                pose[*axis] = 0.0;
                minus(moved, start)
            })
            .collect();
        let wanted = minus(point, start);
        let whole = determinant([columns[0], columns[1], columns[2]]);
        assert!(whole.abs() > 0.1, "the linear axes do not span space");
        (0..3).all(|k| {
            let mut replaced = [columns[0], columns[1], columns[2]];
            replaced[k] = wanted;
            let [low, high] = self.travel(self.linear[k]);
            let position = determinant(replaced) / whole;
            low - 1e-9 <= position && position <= high + 1e-9
        })
    }
}

fn determinant([a, b, c]: [V3; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) + c[0] * (a[1] * b[2] - a[2] * b[1])
}

fn between([low, high]: [f64; 2], part: f64) -> f64 {
    low + (high - low) * part
}

/// Share of a turn of each rotary axis in which the tip stays at a ball on the table.
#[test]
fn rotary_axes_can_be_calibrated() {
    for work in MACHINES {
        let machine = Machine::new(work.config);
        let ball = work.point(work.ball[0], 0.0, work.ball[1]);
        for &axis in &machine.rotary {
            let reached = (0..37).filter(|i| {
                let mut pose = machine.start();
                pose[axis] = between(machine.travel(axis), f64::from(*i) / 36.0);
                machine.reaches(ball, &pose)
            });
            let (name, count) = (&machine.sample.rigid.walk[axis].name, reached.count());
            assert!(count >= 30, "{}: {count} of 37 positions of {name} are in reach", work.config);
        }
    }
}

/// Normals every 15 degrees of latitude and 30 of longitude.
fn normals(work: &Work) -> Vec<V3> {
    let ring = |latitude: i32| (0..if latitude == 0 { 1 } else { 12 }).map(move |i| (latitude, 30 * i));
    let angles = (0..7).flat_map(|i| ring(15 * i));
    angles
        .map(|(latitude, longitude)| {
            let ((s, c), (sl, cl)) =
                (f64::from(latitude).to_radians().sin_cos(), f64::from(longitude).to_radians().sin_cos());
            work.point(s * cl, s * sl, c)
        })
        .collect()
}

/// Share of the normals of a hemisphere on the workpiece origin along which the tool reaches its surface.
#[test]
fn hemispherical_work_is_in_reach() {
    const STEPS: usize = 45;
    for work in MACHINES {
        let Some(size) = work.size else { continue };
        let machine = Machine::new(work.config);
        let &[first, second] = machine.rotary.as_slice() else { panic!("{}: two rotary axes", work.config) };
        let pairs = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| [i, j].map(|k| k as f64 / STEPS as f64)));
        let turned: Vec<(V3, Vec<f64>)> = pairs
            .map(|[i, j]| {
                let mut pose = vec![0.0; machine.sample.axes.len()];
                pose[first] = between(machine.travel(first), i);
                pose[second] = between(machine.travel(second), j);
                (machine.holds(&pose).axis(), pose)
            })
            .collect();
        let normals = normals(&work);
        let reached = normals.iter().filter(|normal| {
            let point = normal.map(|c| c * size / 2.0);
            // The grid of directions is 8 deg apart at most.
            let near = |axis: &V3| norm(minus(*axis, **normal)) < 0.12;
            turned.iter().any(|(axis, pose)| near(axis) && machine.reaches(point, pose))
        });
        let count = reached.count();
        assert!(5 * count >= 3 * normals.len(), "{}: {count} of {} normals", work.config, normals.len());
    }
}

/// Lever arms of heads, from the pivot to the tip, and of tables, from the axis to the workpiece: no longer than half
/// of the longest travel, and heads at least a tool's length.
#[test]
fn pivots_have_plausible_places() {
    for work in MACHINES {
        let machine = Machine::new(work.config);
        let longest =
            machine.linear.iter().map(|axis| machine.travel(*axis)).map(|[low, high]| high - low).fold(0.0, f64::max);
        let rigid = &machine.sample.rigid;
        let tip = plus(rigid.gauge, rigid.offset);
        for &axis in &machine.rotary {
            let own = &rigid.walk[axis];
            let end = if own.workpiece { rigid.workpiece_origin } else { tip };
            let arm = norm(minus(end, own.origin));
            assert!(arm <= 0.5 * longest, "{}: {} is {arm} mm away", work.config, own.name);
            assert!(own.workpiece || arm >= norm(rigid.offset), "{}: {} pivots below the gauge", work.config, own.name);
        }
    }
}
