//! Readings that are far off their poses name what was mixed up: points of a tracker, distances from stations and balls
//! of the independent rigid body, with the exchanges, signs and units of a shop. Good ones are not accused.

use crate::accused::{Built, Campaign, TOOLS, blank, builds, file, good, outcome};
use crate::identify::normal;
use crate::oracle::curves::Travel;
use crate::oracle::random::Random;
use abbe::IdentifyOptions;

/// Poses and tools of a campaign, and the actual place of the tip in the workpiece frame (mm, noise of 2 um).
struct Session {
    build: Vec<Built>,
    rows: Vec<(Vec<f64>, usize, [f64; 3])>,
}

fn session(seed: u64, build: usize) -> Session {
    let mut random = Random::new(seed);
    let Campaign { build, rows, .. } = good(&mut random, build, true);
    let mut machines = [0, 1].map(|tool| blank(&build, tool));
    for i in 0..build.len() {
        let location: [f64; 6] = std::array::from_fn(|k| if k < 3 { 2e-2 } else { 6e-5 } * normal(&mut random));
        machines.iter_mut().for_each(|machine| machine.rigid.walk[i].location = location);
    }
    let place = |(i, (pose, ..)): (usize, (Vec<f64>, usize, usize, [f64; 3]))| {
        let tool = i % 2;
        let [real, _] = machines[tool].holds(&pose, Travel::Mean);
        (pose, tool, real.tip.map(|x| x + 2e-3 * normal(&mut random)))
    };
    let rows = rows.into_iter().take(90).enumerate().map(place).collect();
    Session { build, rows }
}

impl Session {
    fn axis(&self, name: &str) -> usize {
        self.build.iter().position(|axis| axis.0 == name).unwrap()
    }

    fn poses(&mut self, change: impl Fn(&mut Vec<f64>)) {
        self.rows.iter_mut().for_each(|row| change(&mut row.0));
    }

    /// A quarter turn and a shift: the frame of an instrument.
    fn seen(&mut self, change: impl Fn([f64; 3]) -> [f64; 3]) {
        self.rows.iter_mut().for_each(|row| row.2 = change([row.2[1] + 1200.0, -row.2[0] + 40.0, row.2[2] - 300.0]));
    }

    fn table(&self, columns: &str, cells: impl Fn(&[f64; 3]) -> Vec<String>) -> String {
        let names: Vec<&str> = self.build.iter().map(|axis| axis.0).collect();
        let mut text = format!("{},tool,{columns}\n", names.join(","));
        for (pose, tool, at) in &self.rows {
            let pose: Vec<String> = pose.iter().map(|q| format!("{q:.5}")).collect();
            for cell in cells(at) {
                text += &format!("{},{},{cell}\n", pose.join(","), TOOLS[*tool].0);
            }
        }
        text
    }

    fn tracker(&self) -> String {
        let row = |at: &[f64; 3]| vec![format!("{:.5},{:.5},{:.5}", at[0], at[1], at[2])];
        self.table("tracker.x [mm],tracker.y [mm],tracker.z [mm]", row)
    }

    fn lengths(&self) -> String {
        let stations = [[900.0, -700.0, 500.0], [-800.0, 600.0, 400.0], [700.0, 900.0, 600.0]];
        let row = |(i, s): (usize, &[f64; 3]), at: &[f64; 3]| {
            let length = (0..3).map(|k| (at[k] - s[k]).powi(2)).sum::<f64>().sqrt();
            format!("S{i},{length:.6}")
        };
        self.table("station,length [mm]", |at| stations.iter().enumerate().map(|station| row(station, at)).collect())
    }

    fn said(&self, text: String) -> String {
        let options = IdentifyOptions {
            texts: vec![("readings.csv".to_owned(), text)],
            fit: vec!["location".to_owned()],
            ..IdentifyOptions::default()
        };
        outcome(&self.build, &options).0
    }
}

/// All builds but the three axes, of which one set of lengths has two sides.
#[test]
fn good_sessions_are_not_accused() {
    for (seed, build) in (1..builds().len()).enumerate() {
        let mut session = session(100 + seed as u64, build);
        let said = session.said(session.lengths());
        assert!(!said.contains("off their poses"), "{said}");
        session.seen(|at| at);
        let said = session.said(session.tracker());
        assert!(!said.contains("off their poses"), "{said}");
    }
}

#[test]
fn points_of_a_tracker_name_what_was_mixed_up() {
    type Trouble = (&'static str, fn(&mut Session));
    let troubles: [Trouble; 8] = [
        ("with the positions of X and Y exchanged", |s| {
            let [x, y] = ["X", "Y"].map(|name| s.axis(name));
            s.poses(|pose| pose.swap(x, y));
        }),
        ("with B turning the other way", |s| {
            let b = s.axis("B");
            s.poses(|pose| pose[b] *= -1.0);
        }),
        ("with the positions of B times 57.3 (radians taken for degrees)", |s| {
            let b = s.axis("B");
            s.poses(|pose| pose[b] = pose[b].to_radians());
        }),
        ("with the tools short and long exchanged", |s| s.rows.iter_mut().for_each(|row| row.1 = 1 - row.1)),
        ("with the coordinates of the other hand", |s| s.rows.iter_mut().for_each(|row| row.2.swap(1, 2))),
        ("with tracker.y times 25.4", |s| s.rows.iter_mut().for_each(|row| row.2[1] /= 25.4)),
        ("at the pose 1 row before its own", |s| {
            let read: Vec<[f64; 3]> = s.rows.iter().map(|row| row.2).collect();
            let count = read.len();
            s.rows.iter_mut().enumerate().for_each(|(i, row)| row.2 = read[(i + count - 1) % count]);
            let _ = s.rows.remove(0);
        }),
        ("with B turning the other way and with the tools short and long exchanged", |s| {
            let b = s.axis("B");
            s.poses(|pose| pose[b] *= -1.0);
            s.rows.iter_mut().for_each(|row| row.1 = 1 - row.1);
        }),
    ];
    for (seed, (words, make)) in troubles.iter().enumerate() {
        let mut session = session(200 + seed as u64, 1);
        session.seen(|at| at);
        make(&mut session);
        let said = session.said(session.tracker());
        assert!(said.contains("E0543") && said.contains(words), "{words}: {said}");
    }
}

#[test]
fn lengths_name_what_was_mixed_up() {
    let mut axes = session(300, 2);
    let [x, y] = ["X", "Y"].map(|name| axes.axis(name));
    axes.poses(|pose| pose.swap(x, y));
    let said = axes.said(axes.lengths());
    assert!(said.contains("with the positions of Y and X exchanged they are"), "{said}");
    let mut tools = session(301, 1);
    tools.rows.iter_mut().for_each(|row| row.1 = 1 - row.1);
    let said = tools.said(tools.lengths());
    assert!(said.contains("with the tools short and long exchanged"), "{said}");
    // Three stations a pose.
    let mut late = session(303, 1);
    let read: Vec<[f64; 3]> = late.rows.iter().map(|row| row.2).collect();
    late.rows.iter_mut().zip(&read[1..]).for_each(|(row, next)| row.2 = *next);
    let _ = late.rows.pop();
    let said = late.said(late.lengths());
    assert!(said.contains("every reading at the pose 3 rows after its own"), "{said}");
    // A unit of all lengths.
    let inches = session(302, 3);
    let said = inches.said(inches.lengths().replace("length [mm]", "length [in]"));
    assert!(said.contains("times 0.03937 (mm taken for inches"), "{said}");
}

/// A ball that stays where it is while the table turns, its row of places mixed up.
#[test]
fn balls_name_an_axis_that_turns_the_other_way() {
    let mut build = builds()[1].clone();
    build[2..].iter_mut().for_each(|axis| axis.3 = Some([-500.0, 500.0]));
    let machine = blank(&build, 0);
    let mut random = Random::new(17);
    let [c, b] = ["C", "B"].map(|name| build.iter().position(|axis| axis.0 == name).unwrap());
    let mut text = "C,B,X,Y,Z,tool,ball\n".to_owned();
    for (i, place) in [[60.0, 40.0, 30.0], [-80.0, 70.0, 25.0]].iter().enumerate() {
        for _ in 0..14 {
            let mut pose = vec![0.0; 5];
            (pose[c], pose[b]) = (random.between(0.0, 360.0), random.between(-80.0, 80.0));
            // The linear axes follow the ball: their directions are those of the workpiece frame turned.
            let [_, at] = machine.holds(&pose, Travel::Mean);
            let mut moved = pose.clone();
            let columns: Vec<[f64; 3]> = (2..5)
                .map(|axis| {
                    moved[axis] = 1.0;
                    let [_, one] = machine.holds(&moved, Travel::Mean);
                    moved[axis] = 0.0;
                    std::array::from_fn(|k| one.tip[k] - at.tip[k])
                })
                .collect();
            // Orthonormal: the inverse is the transpose.
            for (k, column) in columns.iter().enumerate() {
                pose[2 + k] = (0..3).map(|j| column[j] * (place[j] - at.tip[j])).sum();
            }
            pose[b] *= -1.0;
            let cells: Vec<String> = pose.iter().map(|q| format!("{q:.5}")).collect();
            text += &format!("{},short,b{i}\n", cells.join(","));
        }
    }
    let options = IdentifyOptions {
        texts: vec![("balls.csv".to_owned(), text)],
        fit: vec!["location".to_owned()],
        ..IdentifyOptions::default()
    };
    let said = outcome(&build, &options).0;
    assert!(said.contains("with B turning the other way they are") && said.contains("E0543"), "{said}");
    let machine = file(&build);
    assert!(machine.contains("B'"), "{machine}");
}
