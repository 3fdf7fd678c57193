//! Touches of balls: from the log of a measuring program to readings, and to centres with their covariance.
//!
//! 1. `log`: lines to positions of the axes at contact; spoiled logs are refused.
//! 2. `sphere`: a centre for each ball and pose, one effective radius and lobing for all.
//! 3. `judge`: touches that stand out, and logs in other coordinates or of another tool.
//! 4. here: the table of touches, with the direction of each, which `identify` fits together with the machine. That
//!    keeps what centres share, the radius and the lobing, without a covariance between rows.

mod coordinates;
mod judge;
mod log;
mod sphere;

pub use coordinates::TouchCoordinates;
pub(super) use log::TOUCH_LOG;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::identify::thresholds::{MAX_LOBING_SHARE, MIN_LOBING_CHI_SQUARE, MIN_WRITTEN_SIGMA, TOUCH_LOBE_MM};
use crate::machine::{AxisKind, Machine};
use crate::syntax::Files;
use crate::syntax::sheet::{SheetLine, read_sheet};
use indexmap::IndexMap;
use log::{LogReader, TouchLog, TouchSet, refusal};
use nalgebra::Vector3;
use serde::Serialize;
use sphere::SphereFit;
use std::path::Path;

/// Particulars that a log of touches may leave open.
#[derive(Debug, Clone, Copy)]
pub struct TouchRequest {
    /// Touches of a ball in a pose, of a log that does not name them.
    pub touches: usize,
    /// Coordinates; by default those that the log states, else positions of the axes.
    pub coordinates: Option<TouchCoordinates>,
    /// The caller takes touches that accuse themselves.
    pub accepts_suspect: bool,
}

/// Balls by touch.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TouchImport {
    /// Name of the machine.
    pub machine: String,
    /// Number of balls.
    pub balls: usize,
    /// Number of touches.
    pub touches: usize,
    /// Standard deviation of a touch.
    pub sigma_um: f64,
    /// Residual degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Radius of ball and stylus less the pre-travel, one for all touches.
    pub effective_radius_mm: f64,
    /// Its standard uncertainty.
    pub effective_radius_u_um: f64,
    /// Threefold lobing of the probe.
    pub lobing: ProbeLobing,
    /// The centres, in the order of the log.
    pub centres: Vec<BallCentre>,
    /// Touches that stand out.
    pub outliers: Vec<OutlierTouch>,
    /// The table of touches that `identify` reads, CSV.
    #[serde(skip)]
    pub table: String,
}

/// Threefold lobing of a probe: what its effective radius changes by with the angle t of the touch about its axis,
/// `cos` cos 3t + `sin` sin 3t, in the frame of the tool.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ProbeLobing {
    /// Its amplitude.
    pub amplitude_um: f64,
    /// Part with the cosine.
    pub cos_um: f64,
    /// Part with the sine.
    pub sin_um: f64,
    /// The larger standard uncertainty of the two.
    pub u_um: f64,
    /// True if chance would show as much once in a thousand.
    pub is_significant: bool,
    /// True if the touches tell it from the places of the balls.
    pub is_determined: bool,
}

/// Centre of a ball in a pose, by the nominal machine: how the centres of a ball differ is its error.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BallCentre {
    /// Name of the ball.
    pub ball: String,
    /// Name of the pose.
    pub pose: String,
    /// Positions of the rotary axes, deg.
    pub rotary: IndexMap<String, f64>,
    /// The centre from the workpiece origin, workpiece frame.
    pub centre_mm: [f64; 3],
    /// Covariance of its coordinates, radius and lobing unknown.
    pub covariance_um2: [[f64; 3]; 3],
    /// Number of touches.
    pub touches: usize,
}

/// A touch that stands out.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OutlierTouch {
    /// Name of the ball.
    pub ball: String,
    /// Name of the pose.
    pub pose: String,
    /// Number of the touch in its set.
    pub touch: usize,
    /// Its line.
    pub line: usize,
    /// Distance outside the ball by the other touches; below 0 inside.
    pub off_um: f64,
}

/// Reads a log of touches. Whatever spoils it is refused.
pub fn import_touches(
    machine: &Machine,
    path: &Path,
    request: &TouchRequest,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<TouchImport> {
    let lines = read_sheet(path, files, diagnostics)?.lines();
    let found = read(machine, &lines, request, diagnostics);
    found.map_err(|refused| diagnostics.push(*refused)).ok().flatten()
}

fn read(
    machine: &Machine,
    lines: &[SheetLine],
    request: &TouchRequest,
    diagnostics: &mut Diagnostics,
) -> Result<Option<TouchImport>, Box<Diagnostic>> {
    let TouchLog { mut sets, broken } = LogReader::read(machine, lines, request.touches, request.coordinates)?;
    judge::broken(&broken).into_iter().for_each(|warning| diagnostics.push(warning));
    let mut used: Vec<Vec<bool>> = sets.iter().map(|set| vec![true; set.contacts.len()]).collect();
    let no_ball = || {
        let thin = sets.iter().find(|set| set.contacts.len() < 4).or(sets.first());
        let of = thin.map_or_else(|| "the log".to_owned(), TouchSet::name);
        let place = thin.and_then(|set| set.contacts.first()).map(|contact| &contact.place);
        let help =
            "a ball takes four touches or more all around it, and all balls together one more than their centres";
        refusal(format!("{of}: its touches are no ball"), place, help)
    };
    let whole = SphereFit::of(&sets, &used).ok_or_else(no_ball)?;
    let (mut fit, outliers) = judge::outliers(&sets, &mut used, whole.clone());
    judge::say_outliers(&sets, &outliers, &fit, request.accepts_suspect)
        .into_iter()
        .for_each(|of| diagnostics.push(of));
    if request.accepts_suspect {
        fit = whole;
    }
    let is_named = sets.iter().all(|set| !set.ball.is_empty());
    judge::name_balls(&mut sets, &fit);
    let elsewhere = judge::elsewhere(machine, &sets, &fit, is_named, request.accepts_suspect);
    elsewhere.into_iter().for_each(|of| diagnostics.push(of));
    if diagnostics.is_refused() {
        return Ok(None);
    }
    let line = |set: usize, touch: usize| {
        let place = sets.get(set).and_then(|set| set.contacts.get(touch)).map(|contact| &contact.place);
        place.map_or(0, |place| diagnostics.sources.line_column(place).0)
    };
    let outliers = outliers
        .iter()
        .map(|of| OutlierTouch {
            ball: sets[of.set].ball.clone(),
            pose: sets[of.set].pose.clone(),
            touch: sets[of.set].contacts[of.touch].number,
            line: line(of.set, of.touch),
            off_um: of.off * 1e3,
        })
        .collect();
    Ok(Some(TouchImport::of(machine, &sets, &fit, outliers)))
}

impl TouchImport {
    fn of(machine: &Machine, sets: &[TouchSet], fit: &SphereFit, outliers: Vec<OutlierTouch>) -> Self {
        let variance = fit.variance();
        let lobing = fit.lobing_cofactor() * variance;
        let parts = fit.probe.yz();
        let seen = lobing.try_inverse().map_or(0.0, |inverse| parts.dot(&(inverse * parts)));
        let u = libm::sqrt(lobing.diagonal().max());
        let mut balls: Vec<&str> = sets.iter().map(|set| set.ball.as_str()).collect();
        balls.sort_unstable();
        balls.dedup();
        Self {
            machine: machine.name().to_owned(),
            balls: balls.len(),
            touches: sets.iter().map(|set| set.contacts.len()).sum(),
            sigma_um: libm::sqrt(variance) * 1e3,
            degrees_of_freedom: fit.freedom,
            effective_radius_mm: fit.probe.x,
            effective_radius_u_um: libm::sqrt(variance * fit.probe_cofactor[(0, 0)]) * 1e3,
            lobing: ProbeLobing {
                amplitude_um: parts.norm() * 1e3,
                cos_um: parts.x * 1e3,
                sin_um: parts.y * 1e3,
                u_um: u * 1e3,
                is_significant: seen > MIN_LOBING_CHI_SQUARE,
                is_determined: u < MAX_LOBING_SHARE * TOUCH_LOBE_MM,
            },
            centres: sets
                .iter()
                .zip(&fit.centres)
                .zip(&fit.cofactors)
                .map(|((set, centre), cofactor)| {
                    let at = set.contacts.first().map(|contact| &contact.axes);
                    let rotary = machine.axes().iter().zip(at.into_iter().flatten());
                    let rotary = rotary.filter(|(axis, _)| axis.kind == AxisKind::Rotary);
                    BallCentre {
                        ball: set.ball.clone(),
                        pose: set.pose.clone(),
                        rotary: rotary.map(|(axis, q)| (axis.name.to_string(), *q)).collect(),
                        centre_mm: (*centre).into(),
                        covariance_um2: (cofactor * variance * 1e6).into(),
                        touches: set.contacts.len(),
                    }
                })
                .collect(),
            outliers,
            table: table(machine, sets, fit),
        }
    }
}

/// Returns the table of touches.
fn table(machine: &Machine, sets: &[TouchSet], fit: &SphereFit) -> String {
    let titles: Vec<String> = machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit())).collect();
    let has_tools = machine.tools().len() > 1;
    let tool = if has_tools { ",tool" } else { "" };
    let u = libm::sqrt(fit.variance()).max(MIN_WRITTEN_SIGMA) * 1e3;
    let mut text = format!(
        "# touches of balls: `identify --data` reads them\n{},ball,n.x,n.y,n.z,u [um]{tool}\n",
        titles.join(",")
    );
    for (set, centre) in sets.iter().zip(&fit.centres) {
        for contact in &set.contacts {
            let normal: Vector3<f64> = (contact.tip - centre).normalize();
            let axes: Vec<String> = contact.axes.iter().map(|q| format!("{:.9}", q + 0.0)).collect();
            let normal: Vec<String> = normal.iter().map(|n| format!("{:.9}", n + 0.0)).collect();
            text += &format!("{},{},{},{u:.6}", axes.join(","), set.ball, normal.join(","));
            if has_tools {
                text += &format!(",{}", machine.tool().name);
            }
            text += "\n";
        }
    }
    text
}
