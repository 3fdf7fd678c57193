//! A part tried at many places: what the machine reaches there, and how far it deviates.
//!
//! Like is compared with like. Ranked are the places that reach the point of the reference and the most tool poses; if
//! these are not the same ones everywhere, those that most places share. First come the fewest rewinds of a path, then
//! the least 95 % value of the position deviation, then the largest margin to the ends of the linear travels, then the
//! place of the job. All others have no rank.

use super::job_file::{Job, UnplacedJob};
use super::placement::Placement;
use super::poses::known;
use super::reference::{Reference, SetUp, unzeroed};
use crate::analysis::budget::{Bound, Draws, PosesRequest, pose_by_pose};
use crate::analysis::{View, deviations};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Field, Frame, Order, Poses, Statistics, Summary};
use crate::machine::{AxisKind, Machine, OperatingConditions, Pose, Travel};
use crate::run::{Advance, Call, Cancelled, Refused};
use indexmap::IndexMap;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Figures count as equal below this, um.
const FIGURE_UM: f64 = 1e-4;

/// Margins count as equal below this, mm.
const MARGIN_MM: f64 = 1e-6;

/// A part tried at a place.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct TriedPlace {
    /// The place.
    pub place: Placement,
    /// True for the place that the job states.
    pub own: bool,
    /// Number of tool poses that are reached.
    pub reached: usize,
    /// Their fraction.
    pub share: f64,
    /// Number of rewinds of a path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rewinds: Option<usize>,
    /// Least distance of a linear axis from an end of its travel, mm; none without such an axis or a tool pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_mm: Option<f64>,
    /// True if the machine reaches the points at which the part is probed.
    pub reaches_reference: bool,
    /// The 95 % value of the position deviation over the tool poses that are reached, um; none for reach alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p95_um: Option<f64>,
    /// The largest position deviation over them, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_um: Option<f64>,
    /// Rank from 1; none of a place that cannot be compared with the best.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
}

/// Gain of the best place over that of the job.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PlacementGain {
    /// Number of tool poses that it reaches more.
    pub poses: i64,
    /// Number of rewinds that it has less.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rewinds: Option<i64>,
    /// Margin that it has more, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_mm: Option<f64>,
    /// The figures of both on the tool poses that both reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub common: Option<CommonFigures>,
}

/// Figures of two places on the tool poses that both reach.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct CommonFigures {
    /// Number of these tool poses.
    pub poses: usize,
    /// 95 % value at the place of the job, um.
    pub own_p95_um: f64,
    /// The same at the best place.
    pub best_p95_um: f64,
    /// The first less the second.
    pub p95_um: f64,
    /// Largest deviation at the place of the job, um.
    pub own_max_um: f64,
    /// The same at the best place.
    pub best_max_um: f64,
}

impl CommonFigures {
    /// Returns those on a number of tool poses; 95 % value and largest deviation (um) of the place of the job, then of
    /// the best.
    fn new(poses: usize, [[own_p95_um, own_max_um], [best_p95_um, best_max_um]]: [[f64; 2]; 2]) -> Self {
        let p95_um = own_p95_um - best_p95_um;
        Self { poses, own_p95_um, best_p95_um, p95_um, own_max_um, best_max_um }
    }
}

/// The figure of a place.
pub(crate) enum PlaceFigure<'a> {
    /// None: reach alone.
    Reach,
    /// The deviations of a machine with values.
    Values { field: &'a dyn Field, order: Order, conditions: OperatingConditions },
    /// From bounds: the length that 95 % of the machines drawn do not exceed at each pose.
    Bounds { bounds: &'a [Bound], draws: &'a Draws, samples: usize },
}

/// The request to try a part at places.
pub(crate) struct PlaceStudy<'a> {
    pub machine: &'a Machine,
    pub job: &'a UnplacedJob,
    /// The places; that of the job is among them.
    pub places: &'a [Placement],
    /// The reference that the options state.
    pub asked: Option<&'a Reference>,
    pub figure: PlaceFigure<'a>,
}

/// The places that were tried, and the best of them.
pub(crate) struct StudiedPlaces {
    /// The places in their order.
    pub tried: Vec<TriedPlace>,
    /// Index of the place of the job.
    pub own: usize,
    /// Index of the best place; none if no tool pose is reached anywhere.
    pub best: Option<usize>,
    /// Its gain.
    pub gain: Option<PlacementGain>,
    /// The reference, part coordinates.
    pub reference: Reference,
}

/// A place with the rows that are out of reach there.
struct Attempt {
    tried: TriedPlace,
    missed: Vec<usize>,
    /// The reason why the part cannot be set up, if it cannot.
    unset: Option<Diagnostic>,
}

impl PlaceStudy<'_> {
    /// Tries all places. Refuses a stated reference that is reached from none of them; of the default it says so, and
    /// takes machine coordinates. Refuses figures where an error curve is not defined at a pose.
    pub(crate) fn run(&self, call: &mut Call<'_>) -> Result<StudiedPlaces, Refused> {
        let own = self.places.iter().position(|place| *place == self.job.place()).unwrap_or_default();
        let job = self.job.at(self.job.place());
        let stated = Job::stated(Some(&job), self.asked);
        let mut reference = stated.clone().unwrap_or_else(|| job.zero());
        let mut attempts = self.attempts(call, self.asked)?;
        let mut reached = attempts.iter().filter(|of| of.tried.reached > 0);
        let is_set_up = reached.clone().any(|of| of.tried.reaches_reference);
        let first = reached.next().map(|of| of.unset.clone());
        let figure = !matches!(self.figure, PlaceFigure::Reach);
        if figure && first.is_none() {
            // Nothing to compare: the refusal says what is missing at the place of the job.
            job.poses.reached(call, self.machine)?;
        }
        if let Some(reason) = first.flatten().filter(|_| !is_set_up) {
            match (figure, stated) {
                (true, Some(_)) => return call.refuse(Job::located(Some(&job), self.asked, reason)),
                (true, None) => call.warn(unzeroed(&reason)),
                (false, _) => call.warn(Diagnostic::new(codes::W0850, reason.message)),
            }
            call.check()?;
            reference = Reference::default();
            attempts = self.attempts(call, Some(&reference))?;
        }
        let ranked = ranking(&attempts, own);
        ranked.iter().enumerate().for_each(|(k, index)| attempts[*index].tried.rank = Some(k + 1));
        let best = ranked.first().copied();
        let asked = if reference == Reference::default() { Some(&reference) } else { self.asked };
        let gain = best.map(|best| self.gain(call, asked, &attempts, own, best)).transpose()?;
        let mut tried: Vec<TriedPlace> = attempts.into_iter().map(|of| of.tried).collect();
        tried[own].own = true;
        Ok(StudiedPlaces { tried, own, best, gain, reference })
    }

    fn attempts(&self, call: &mut Call<'_>, asked: Option<&Reference>) -> Result<Vec<Attempt>, Refused> {
        let found = call.stage(self.places.len(), |progress| {
            let one = |place: &Placement| {
                let attempt = self.attempt(place, asked, progress)?;
                progress(1)?;
                Ok(attempt)
            };
            self.places.par_iter().map(one).collect::<Result<Vec<_>, Cancelled>>()
        })?;
        // Of several refusals that of the first place counts, on any number of threads.
        let attempts: Result<Vec<Attempt>, Diagnostic> = found.into_iter().collect();
        attempts.or_else(|refusal| call.refuse(refusal))
    }

    fn attempt(
        &self,
        place: &Placement,
        asked: Option<&Reference>,
        progress: Advance<'_>,
    ) -> Result<Result<Attempt, Diagnostic>, Cancelled> {
        let job = self.job.at(*place);
        let (found, rewinds) = job.poses.solved(self.machine);
        let missed: Vec<usize> = (0..found.len()).filter(|row| found[*row].is_none()).collect();
        let rows = found.len();
        let poses: Vec<Pose> = found.into_iter().flatten().collect();
        let (reached, share) = (poses.len(), poses.len() as f64 / rows as f64);
        let margin_mm = margin(self.machine, &poses);
        let set_up = self.set_up(&job, asked, &poses);
        let reaches_reference = set_up.is_ok();
        let (figure, unset) = match set_up {
            Ok(set_up) => match self.figure(&set_up, poses, progress)? {
                Ok(figure) => (figure, None),
                Err(refusal) => return Ok(Err(refusal)),
            },
            Err(reason) => (None, Some(reason)),
        };
        let [p95_um, max_um] = [figure.map(|of| of.p95), figure.map(|of| of.max)];
        let (place, own, rank) = (*place, false, None);
        let tried =
            TriedPlace { place, own, reached, share, rewinds, margin_mm, reaches_reference, p95_um, max_um, rank };
        Ok(Ok(Attempt { tried, missed, unset }))
    }

    fn set_up(&self, job: &Job, asked: Option<&Reference>, poses: &[Pose]) -> Result<SetUp, Diagnostic> {
        let reference = Job::stated(Some(job), asked).unwrap_or_else(|| job.zero());
        SetUp::new(self.machine, &reference, poses)
    }

    /// Returns the statistics of the position deviation at poses (um); `None` for reach alone and without a pose.
    fn figure(
        &self,
        set_up: &SetUp,
        poses: Vec<Pose>,
        progress: Advance<'_>,
    ) -> Result<Result<Option<Summary>, Diagnostic>, Cancelled> {
        let machine = self.machine;
        if poses.is_empty() || matches!(self.figure, PlaceFigure::Reach) {
            return Ok(Ok(None));
        }
        if let Some(refusal) = poses.iter().find_map(|pose| known(machine, pose).err()) {
            return Ok(Err(refusal));
        }
        let (count, poses) = (poses.len(), Poses::Listed(poses));
        // A place is one step.
        let go_on: Advance<'_> = &|_| progress(0);
        Ok(Ok(Some(match self.figure {
            PlaceFigure::Reach => return Ok(Ok(None)),
            PlaceFigure::Values { field, order, conditions } => {
                let referenced = set_up.field(field, order, conditions);
                let field = referenced.as_ref().map_or(field, |field| field as &dyn Field);
                let view = View { conditions, frame: Frame::default() };
                Statistics::of(&deviations(field, &poses, 0..count, view, go_on)?).position_um
            }
            PlaceFigure::Bounds { bounds, draws, samples } => {
                let (reference, frame) = (set_up.removed(), Frame::default());
                let poses = &poses;
                let request = PosesRequest { machine, bounds, poses, reference, frame, draws, samples };
                let found = pose_by_pose(request, go_on)?;
                Summary::of_lengths(&mut found.poses.iter().map(|of| of.position.p95 * 1e3).collect::<Vec<_>>())
            }
        })))
    }

    fn gain(
        &self,
        call: &mut Call<'_>,
        asked: Option<&Reference>,
        attempts: &[Attempt],
        own: usize,
        best: usize,
    ) -> Result<PlacementGain, Refused> {
        let [at_own, at_best] = [own, best].map(|index| &attempts[index].tried);
        let minus = |a: usize, b: usize| a as i64 - b as i64;
        let figures = |of: &TriedPlace| Some([of.p95_um?, of.max_um?]);
        let common = match (figures(at_own), figures(at_best)) {
            (Some(a), Some(b)) if attempts[own].missed == attempts[best].missed => {
                Some(CommonFigures::new(at_own.reached, [a, b]))
            }
            (Some(_), Some(_)) => self.on_common(call, asked, [&at_own.place, &at_best.place])?,
            _ => None,
        };
        Ok(PlacementGain {
            poses: minus(at_best.reached, at_own.reached),
            rewinds: at_own.rewinds.zip(at_best.rewinds).map(|(own, best)| minus(own, best)),
            margin_mm: at_own.margin_mm.zip(at_best.margin_mm).map(|(own, best)| best - own),
            common,
        })
    }

    /// Returns the figures of two places, that of the job first, on the tool poses that both reach.
    fn on_common(
        &self,
        call: &mut Call<'_>,
        asked: Option<&Reference>,
        places: [&Placement; 2],
    ) -> Result<Option<CommonFigures>, Refused> {
        let jobs = places.map(|place| self.job.at(*place));
        let [a, b] = [&jobs[0], &jobs[1]].map(|job| job.poses.solved(self.machine).0);
        let (a, b): (Vec<Pose>, Vec<Pose>) = a.into_iter().zip(b).filter_map(|(a, b)| a.zip(b)).unzip();
        let count = a.len();
        let mut figures = Vec::new();
        for (job, poses) in jobs.iter().zip([a, b]) {
            let Ok(set_up) = self.set_up(job, asked, &poses) else { return Ok(None) };
            let figure = call.stage(1, |progress| self.figure(&set_up, poses, progress))?;
            figures.extend(figure.or_else(|refusal| call.refuse(refusal))?.map(|of| [of.p95, of.max]));
        }
        Ok(<[_; 2]>::try_from(figures).ok().map(|figures| CommonFigures::new(count, figures)))
    }
}

/// Returns the least distance of a linear axis from an end of its travel at poses, mm.
fn margin(machine: &Machine, poses: &[Pose]) -> Option<f64> {
    let linear = machine.axes().iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Linear);
    let bounded = linear.filter_map(|(index, axis)| match axis.travel {
        Travel::Range(min, max) => Some((index, min, max)),
        Travel::Continuous => None,
    });
    let of = |(index, min, max): (usize, f64, f64)| poses.iter().map(move |q| (q[index] - min).min(max - q[index]));
    // Rounding may leave a pose at an end by less than nothing.
    bounded.flat_map(of).reduce(f64::min).map(|margin| margin.max(0.0))
}

/// Returns the places that are compared, by index, the best first.
fn ranking(attempts: &[Attempt], own: usize) -> Vec<usize> {
    let fits = |index: &usize| attempts[*index].tried.reaches_reference && attempts[*index].tried.reached > 0;
    let fitting: Vec<usize> = (0..attempts.len()).filter(fits).collect();
    let most = fitting.iter().map(|index| attempts[*index].tried.reached).max();
    let mut alike: IndexMap<&[usize], Vec<usize>> = IndexMap::new();
    for index in fitting.into_iter().filter(|index| Some(attempts[*index].tried.reached) == most) {
        alike.entry(&attempts[index].missed).or_default().push(index);
    }
    // Of equally many the group with the place of the job, then the first.
    let size = |group: &Vec<usize>| (group.len(), group.contains(&own), Reverse(group[0]));
    let mut ranked = alike.into_values().max_by_key(size).unwrap_or_default();
    let whole = |value: f64, unit: f64| (value / unit).round() as i64;
    ranked.sort_by_key(|index| {
        let of = &attempts[*index].tried;
        let figure = of.p95_um.map_or(0, |um| whole(um, FIGURE_UM));
        let margin = of.margin_mm.map(|mm| whole(mm, MARGIN_MM));
        (of.rewinds, figure, Reverse(margin), *index != own, *index)
    });
    ranked
}
