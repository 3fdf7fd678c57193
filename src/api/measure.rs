//! A measuring program: balls on the workpiece, touched in poses of the rotary axes.

use crate::analysis::touch_route::{ProbeSizes, RouteFailure, TouchScene};
use crate::diagnostic::{Diagnostic, codes};
use crate::identify::{Measurement, MeasurementSet, Reading, ReadingContext, read_measurements};
use crate::job::machine_file::MachineFile;
use crate::job::tool_poses::MissedToolPose;
use crate::machine::Pose;
use crate::report::measuring_program::{MeasuringProgram, ProgramRequest};
use crate::run::{Call, Reply, Run};
use crate::units::significant;
use nalgebra::Vector3;
use std::path::Path;

/// Options of [`measure`]; lengths in mm.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct MeasureOptions {
    /// Sizes of the probe and of the balls.
    #[serde(flatten)]
    pub sizes: ProbeSizes,
    /// Standard deviation of a touch; above 0.
    #[serde(rename = "noise")]
    pub noise_mm: f64,
    /// Time between two looks of the controller at the probe, s; above 0.
    pub servo_period_s: f64,
}

/// 1 um, 1 ms.
impl Default for MeasureOptions {
    fn default() -> Self {
        Self { sizes: ProbeSizes::default(), noise_mm: 1e-3, servo_period_s: 1e-3 }
    }
}

/// Writes a program for LinuxCNC that touches balls: a file of measurements names the ball of each row, its place, and
/// the positions of the rotary axes; the linear axes follow.
///
/// Fails if a ball is out of reach, if a move would come too near to a ball, its stem or the end of a travel, and for
/// axes that the controller has no letters for.
pub fn measure(
    file: &MachineFile,
    sets: impl AsRef<Path>,
    options: &MeasureOptions,
    run: Run,
) -> Reply<MeasuringProgram> {
    Call::answer(run, file.sources(), |call| {
        let MeasureOptions { sizes, noise_mm: noise, servo_period_s: servo_period } = *options;
        if !sizes.are_possible() || ![noise, servo_period].iter().all(|x| *x > 0.0 && x.is_finite()) {
            return call.usage("lengths and times are above 0, and the shaft of the stylus is thinner than its ball");
        }
        let read =
            read_measurements(&[sets.as_ref()], file, &ReadingContext::default(), run.files, &mut call.diagnostics);
        call.check()?;
        let (names, centres, poses) = balls(&read).or_else(|refusal| call.refuse(refusal))?;
        let balls = sizes.balls(centres);
        let route = TouchScene::of(file, &balls, sizes.stylus).and_then(|scene| scene.route(&poses));
        let route = route.or_else(|failure| call.refuse(blocked(file, &read, &names, &poses, failure)))?;
        let request = ProgramRequest { names: &names, balls: &balls, stylus: sizes.stylus, noise, servo_period };
        MeasuringProgram::linuxcnc(file, &route, &request).or_else(|refusal| call.refuse(refusal))
    })
}

/// Names and places of balls, and the ball and pose of each set.
type Sets = (Vec<String>, Vec<Vector3<f64>>, Vec<(usize, Pose)>);

fn balls(read: &MeasurementSet) -> Result<Sets, Diagnostic> {
    let (mut names, mut centres, mut poses) = (Vec::new(), Vec::new(), Vec::new());
    for row in in_file_order(read) {
        let ball = match &row.reading {
            Reading::Deviation { zero: [Some(x), ..], .. } => read.nuisances[*x].name.strip_suffix(".x"),
            _ => None,
        };
        let name = ball.and_then(|name| name.strip_prefix("ball ")).filter(|name| !name.contains(' '));
        let (Some(name), Reading::Deviation { zero: [Some(x), ..], .. }) = (name, &row.reading) else {
            let help = "a table with the columns `ball` (a word), `ball.x [mm]`, `ball.y [mm]`, `ball.z [mm]`, and one \
                        for each rotary axis";
            let message = "a measuring program takes balls and poses, and no other readings";
            return Err(Diagnostic::new(codes::E0501, message).at(Some(row.place.clone()), "").help(help));
        };
        let known = names.iter().position(|known| known == name).unwrap_or(names.len());
        if known == names.len() {
            names.push(name.to_owned());
            centres.push(Vector3::from_fn(|k, _| read.nuisances[x + k].base));
        }
        poses.push((known, row.pose.clone()));
    }
    Ok((names, centres, poses))
}

/// The rows as they stand in the file, which is read ball by ball.
fn in_file_order(read: &MeasurementSet) -> Vec<&Measurement> {
    let mut rows: Vec<&Measurement> = read.rows.iter().collect();
    rows.sort_by_key(|row| row.place.range.start);
    rows
}

/// The diagnostic of a set that cannot be measured.
fn blocked(
    file: &MachineFile,
    read: &MeasurementSet,
    names: &[String],
    poses: &[(usize, Pose)],
    failure: RouteFailure,
) -> Diagnostic {
    let (set, why) = match failure {
        RouteFailure::OutOfReach(set, miss) => {
            let missed = MissedToolPose::new(file, (set, None), &miss, None);
            (set, format!("the axes do not reach a point of its touches: {}", missed.words()))
        }
        RouteFailure::Blocked(set, what, left) => {
            (set, format!("a move comes too near to {what}, by {} mm", significant(-left, 3)))
        }
        RouteFailure::Way(set) => (set, "the way to it from above all balls comes too near to one".to_owned()),
        RouteFailure::Rest => {
            (0, "there is no clear place above all balls within the travel, rotary axes at 0".to_owned())
        }
    };
    let ball = poses.get(set).and_then(|(ball, _)| names.get(*ball)).map_or("", String::as_str);
    let place = in_file_order(read).get(set).map(|row| row.place.clone());
    let help = "leave the row out, put balls farther apart, or take a longer stylus";
    Diagnostic::new(codes::E0612, format!("ball {ball} cannot be measured in this pose: {why}"))
        .at(place, "")
        .help(help)
}
