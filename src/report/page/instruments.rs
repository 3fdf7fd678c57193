//! Readings of virtual instruments on a machine, on the page: ball bar, R-tests, a laser along the diagonals.

use crate::analysis::instrument::{BallBar, CirclePlane, Diagonal, RTest, ball_bar, diagonals, r_test, within};
use crate::machine::{AxisKind, Machine, Pose, axis_positions};
use crate::report::pictures::{DiagonalPicture, DialPanel, PolarPicture, RTestPicture};
use serde_json::{Value, json};

/// Radii that ball bars have, mm, the one tried first in front.
const RADII: [f64; 5] = [150.0, 100.0, 50.0, 25.0, 10.0];

/// Fractions of the volume at which a ball is tried, the usual one in front.
const PLACES: [f64; 4] = [0.75, 0.6, 0.5, 0.25];

/// Readings on a circle, on a turn and on a diagonal: those of `instrument`.
const POINTS: [usize; 3] = [360, 37, 11];

/// Readings of one machine, without tests that cannot be driven.
#[derive(Debug, Clone)]
pub struct Instruments {
    centre: Pose,
    radius: f64,
    circles: Vec<BallBar>,
    /// R-tests with the place of the ball for each.
    turns: Vec<(Pose, RTest)>,
    lines: Vec<Diagonal>,
}

impl Instruments {
    /// Returns no readings: of a machine of which nothing is measured.
    pub fn none(machine: &Machine) -> Self {
        let centre = within(machine, 0.5);
        Self { centre, radius: RADII[0], circles: Vec::new(), turns: Vec::new(), lines: Vec::new() }
    }

    /// Computes circles about the middle of the volume, as large as all planes (else any) allow; every rotary axis
    /// about a ball at the place with the largest number of readable positions; the diagonals.
    pub fn new(machine: &Machine) -> Self {
        let centre = within(machine, 0.5);
        let circles = |radius: &f64| -> (f64, Vec<BallBar>) {
            let planes = CirclePlane::ALL.into_iter();
            (*radius, planes.filter_map(|plane| ball_bar(machine, &centre, plane, *radius, POINTS[0]).ok()).collect())
        };
        // Among equal numbers of planes the first, which has the largest radius.
        let (radius, circles) = RADII
            .iter()
            .map(circles)
            .reduce(|best, next| if next.1.len() > best.1.len() { next } else { best })
            .unwrap_or_default();
        let rotary = (0..machine.axes().len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary);
        let turns = rotary.filter_map(|axis| turn(machine, axis)).collect();
        let lines = diagonals(machine, &centre, POINTS[2], false);
        Self { radius, circles, turns, lines, centre }
    }

    /// Returns the JSON of `instrument --format json`.
    pub fn json(&self, machine: &Machine) -> Value {
        let circles = json!({
            "centre": axis_positions(machine, &self.centre), "radius_mm": self.radius,
            "planes": self.circles,
        });
        let turn = |(ball, turn): &(Pose, RTest)| {
            let mut json = json!(turn);
            json["ball_at"] = json!(axis_positions(machine, ball));
            json
        };
        let turns = json!({"axes": self.turns.iter().map(turn).collect::<Vec<_>>()});
        let lines = json!({
            "at": axis_positions(machine, &self.centre),
            "diagonals": self.lines,
        });
        json!({"ball_bar": circles, "r_test": turns, "diagonals": lines})
    }

    /// The diagrams of ball bar, R-test and diagonals; empty where there is nothing to draw.
    pub fn pictures(&self, machine: &Machine) -> [String; 3] {
        let title = machine.name();
        let svg = |there: bool, picture: &dyn Fn() -> String| if there { picture() } else { String::new() };
        let tests: Vec<RTest> = self.turns.iter().map(|(_, turn)| turn.clone()).collect();
        let bar = format!("Ball bar of {} mm about the middle of the volume", self.radius);
        [
            svg(!self.circles.is_empty(), &|| {
                let panels: Vec<DialPanel> = self.circles.iter().map(DialPanel::of).collect();
                PolarPicture::senses(title, &bar, &panels).picture().svg()
            }),
            svg(!tests.is_empty(), &|| {
                let subtitle = "R-test, each axis about a ball within its reach";
                RTestPicture { title, subtitle, tests: &tests }.picture().svg()
            }),
            svg(!self.lines.is_empty(), &|| {
                let subtitle = "Laser along the diagonals of the volume, other axes at rest";
                DiagonalPicture { title, subtitle, diagonals: &self.lines }.picture().svg()
            }),
        ]
    }
}

/// The test of an axis with the ball where fewest positions are out of reach; of equals the first place.
fn turn(machine: &Machine, axis: usize) -> Option<(Pose, RTest)> {
    let at = |fraction: &f64| {
        let ball = within(machine, *fraction);
        let test = r_test(machine, &ball, &[axis], POINTS[1]).ok()?;
        Some((ball, test))
    };
    PLACES.iter().filter_map(at).reduce(|best, next| if next.1.skipped < best.1.skipped { next } else { best })
}
