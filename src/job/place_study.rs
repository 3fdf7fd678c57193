//! A part tried at many places: what the machine reaches there, and how far it deviates.
//!
//! Like is compared with like. Ranked are the places that reach the point of the reference and the most tool poses; if
//! these are not the same ones everywhere, those that most places share. First come the fewest rewinds of a path, then
//! the least figure, by which the limit of the job is judged, then the largest margin to the ends of the linear
//! travels, then the place of the job. All others have no rank. Of machines drawn a place has a verdict against the
//! first on the same machines.

use super::job_file::{Job, UnplacedJob};
use super::limit::{JobLimit, LimitVerdict, MissingInLimit, widened};
use super::placement::Placement;
use super::poses::known;
use super::reference::{Reference, SetUp, unzeroed};
use crate::analysis::budget::{
    ActingErrors, Bound, Draws, PairedTest, Percentile, PosesRequest, Request, Statistic, Verdict, VersusFirst,
    draw_samples, pose_by_pose,
};
use crate::analysis::figure_bands::field_bands;
use crate::analysis::reference::PartReference;
use crate::analysis::{SummaryBand, View, deviations, figure_of};
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
    /// The 95 % value of the position deviation over the tool poses that are reached, um; from bounds of what 95 % of
    /// the machines do not exceed at each. None for reach alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p95_um: Option<f64>,
    /// The largest of these, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_um: Option<f64>,
    /// The figure by which places are ranked and the limit of the job is judged, um: the statistic of the position
    /// deviation over the tool poses that are reached; of machines drawn the value that 95 % of them do not exceed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub um: Option<f64>,
    /// The interval that holds it with 95 % confidence, um: of machines drawn, or of values with a stated uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_um: Option<[f64; 2]>,
    /// A ranked place against the first, on the same machines; none where no machines are drawn, and where the path has
    /// more rewinds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub versus_first: Option<VersusFirst>,
    /// The figure against the limit of the job, if it states one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<LimitVerdict>,
    /// Rank from 1; none of a place that cannot be compared with the best.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
}

impl TriedPlace {
    /// True if the machines drawn do not tell it apart from the best place, which it is not itself.
    pub fn is_open(&self) -> bool {
        self.versus_first.is_some_and(|of| matches!(of.verdict, Verdict::Equal | Verdict::NotToldApart))
    }
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
    /// Figure of the ranking at the place of the job, um.
    pub own_um: f64,
    /// The same at the best place.
    pub best_um: f64,
    /// The best place against that of the job, on the same machines; none where no machines are drawn, and where the
    /// path has other rewinds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub versus_own: Option<VersusFirst>,
}

impl CommonFigures {
    /// Returns those on a number of tool poses: of the place of the job, then of the best.
    fn new(poses: usize, [own, best]: [&PlaceFigures; 2], test: Option<&PairedTest>) -> Self {
        Self {
            poses,
            own_p95_um: own.over_poses.p95,
            best_p95_um: best.over_poses.p95,
            p95_um: own.over_poses.p95 - best.over_poses.p95,
            own_max_um: own.over_poses.max,
            best_max_um: best.over_poses.max,
            own_um: own.um,
            best_um: best.um,
            versus_own: test.map(|test| test.versus(&best.drawn, &own.drawn)),
        }
    }
}

/// The figure of a place.
pub(crate) enum PlaceFigure<'a> {
    /// None: reach alone.
    Reach,
    /// The deviations of a machine with values, alone or with what bounds of errors without a value add.
    Values { field: &'a dyn Field, order: Order, conditions: OperatingConditions, adding: Option<PlaceDraws<'a>> },
    /// From bounds alone.
    Bounds(PlaceDraws<'a>),
}

/// The machines that are drawn at every place.
#[derive(Clone, Copy)]
pub(crate) struct PlaceDraws<'a> {
    pub bounds: &'a [Bound],
    pub draws: &'a Draws,
    pub samples: usize,
}

/// The figures of a place.
#[derive(Debug, Clone)]
struct PlaceFigures {
    /// Of the position deviation over the tool poses, um; from bounds of the 95 % value at each.
    over_poses: Summary,
    /// The figure of the ranking, um.
    um: f64,
    interval_um: Option<[f64; 2]>,
    /// Intervals of values whose uncertainty is stated.
    band: Option<SummaryBand>,
    /// The statistic over the poses of each machine drawn, um; empty where none is.
    drawn: Vec<f64>,
}

impl PlaceFigures {
    fn of_values(over_poses: Summary, band: Option<SummaryBand>, statistic: Statistic) -> Self {
        let (um, interval_um) = figure_of(statistic, &over_poses, band.as_ref());
        Self { over_poses, um, interval_um, band, drawn: Vec::new() }
    }

    /// Returns those of machines drawn, by their values (mm).
    fn of_machines(over_poses: Summary, drawn_mm: impl IntoIterator<Item = f64>) -> Self {
        let drawn: Vec<f64> = drawn_mm.into_iter().map(|mm| mm * 1e3).collect();
        let mut sorted = drawn.clone();
        sorted.sort_by(f64::total_cmp);
        let Percentile { value: um, low, high, .. } = Percentile::of(&sorted, 95);
        Self { over_poses, um, interval_um: low.zip(high).map(|(low, high)| [low, high]), band: None, drawn }
    }

    /// Returns these of machines drawn, in each of which values act, with the interval that the uncertainty of these
    /// leaves.
    fn widened(mut self, values: &Self) -> Self {
        if let (Some(ends), Some(own)) = (values.interval_um, self.interval_um) {
            self.interval_um = Some(widened(own, ends.map(|end| end - values.um)));
        }
        self
    }
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
    /// The errors with neither value nor bound, if there are any.
    pub missing: Option<MissingInLimit>,
    /// The statistic of a machine over the tool poses.
    pub statistic: Statistic,
    /// The seed of random numbers.
    pub seed: u64,
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
    figures: Option<PlaceFigures>,
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
        let test = self.compare_with_first(&mut attempts, &ranked, own);
        let best = ranked.first().copied();
        let asked = if reference == Reference::default() { Some(&reference) } else { self.asked };
        let gain = best.map(|best| self.gain(call, asked, &attempts, [own, best], test.as_ref())).transpose()?;
        let mut tried: Vec<TriedPlace> = attempts.into_iter().map(|of| of.tried).collect();
        tried[own].own = true;
        Ok(StudiedPlaces { tried, own, best, gain, reference })
    }

    fn attempts(&self, call: &mut Call<'_>, asked: Option<&Reference>) -> Result<Vec<Attempt>, Refused> {
        let found = call.stage("places", self.places.len(), |progress| {
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
        let of = |value: fn(&PlaceFigures) -> f64| figure.as_ref().map(value);
        let limit = |mm: f64| JobLimit { mm, statistic: self.statistic, missed: missed.len(), is_partial: false };
        let tried = TriedPlace {
            place: *place,
            own: false,
            reached,
            share,
            rewinds,
            margin_mm,
            reaches_reference,
            p95_um: of(|of| of.over_poses.p95),
            max_um: of(|of| of.over_poses.max),
            um: of(|of| of.um),
            interval_um: figure.as_ref().and_then(|of| of.interval_um),
            versus_first: None,
            limit: job.limit_mm.map(limit).zip(figure.as_ref()).map(|(limit, of)| self.judge(limit, of)),
            rank: None,
        };
        Ok(Ok(Attempt { tried, missed, figures: figure, unset }))
    }

    /// Returns the verdict of a limit on the figure of a place; none that is held while errors are missing, for it is
    /// not asked place by place whether these could turn it.
    fn judge(&self, limit: JobLimit, of: &PlaceFigures) -> LimitVerdict {
        let verdict = match of.drawn.is_empty() {
            true => limit.on_values(&of.over_poses, of.band.as_ref()),
            false => limit.on_machines(of.um, of.interval_um, None),
        };
        match &self.missing {
            Some(missing) if verdict.held == Some(true) => verdict.left_open(missing.clone()),
            _ => verdict,
        }
    }

    /// Gives ranked places their ranks and verdicts against the first; returns the test of a pair, if machines are
    /// drawn.
    fn compare_with_first(&self, attempts: &mut [Attempt], ranked: &[usize], own: usize) -> Option<PairedTest> {
        let drawn = |attempt: &Attempt| attempt.figures.as_ref().map(|of| of.drawn.clone()).unwrap_or_default();
        let first = ranked.first().map(|best| drawn(&attempts[*best])).filter(|drawn| !drawn.is_empty());
        let fewest = ranked.first().and_then(|best| attempts[*best].tried.rewinds);
        let rivals = ranked.len() + usize::from(!ranked.contains(&own));
        let test = first.as_ref().map(|first| PairedTest::of_round(first.len(), rivals, 1));
        let versus = |index: &usize| {
            let attempt = Some(&attempts[*index]).filter(|of| of.tried.rewinds == fewest)?;
            let (figures, first) = (attempt.figures.as_ref()?, first.as_ref()?);
            let versus = test.as_ref()?.versus(&figures.drawn, first);
            let is_first = Some(index) == ranked.first();
            Some(VersusFirst { verdict: if is_first { Verdict::First } else { versus.verdict }, ..versus })
        };
        let verdicts: Vec<Option<VersusFirst>> = ranked.par_iter().map(versus).collect();
        for (k, (index, versus)) in ranked.iter().zip(verdicts).enumerate() {
            let tried = &mut attempts[*index].tried;
            (tried.rank, tried.versus_first) = (Some(k + 1), versus);
        }
        test
    }

    fn set_up(&self, job: &Job, asked: Option<&Reference>, poses: &[Pose]) -> Result<SetUp, Diagnostic> {
        let reference = Job::stated(Some(job), asked).unwrap_or_else(|| job.zero());
        SetUp::new(self.machine, &reference, poses)
    }

    /// Returns the figures at poses; `None` for reach alone and without a pose.
    fn figure(
        &self,
        set_up: &SetUp,
        poses: Vec<Pose>,
        progress: Advance<'_>,
    ) -> Result<Result<Option<PlaceFigures>, Diagnostic>, Cancelled> {
        let machine = self.machine;
        if poses.is_empty() || matches!(self.figure, PlaceFigure::Reach) {
            return Ok(Ok(None));
        }
        if let Some(refusal) = poses.iter().find_map(|pose| known(machine, pose).err()) {
            return Ok(Err(refusal));
        }
        // A place is one step.
        let go_on: Advance<'_> = &|_| progress(0);
        Ok(Ok(match self.figure {
            PlaceFigure::Reach => None,
            PlaceFigure::Values { field, order, conditions, adding } => {
                let referenced = set_up.field(field, order, conditions);
                let field = referenced.as_ref().map_or(field, |field| field as &dyn Field);
                let view = View { conditions, frame: Frame::default() };
                let (count, listed) = (poses.len(), Poses::Listed(poses.clone()));
                let statistics = Statistics::of(&deviations(field, &listed, 0..count, view, go_on)?);
                let over_poses = statistics.position_um;
                let linear = set_up.removed().is_none_or(PartReference::is_linear);
                let (seed, removed) = (self.seed, set_up.removed());
                let bands = field_bands(field, &listed, statistics, &[], conditions, seed, removed);
                let values = PlaceFigures::of_values(over_poses, bands.map(|bands| bands.position_um), self.statistic);
                Some(match adding.filter(|_| linear) {
                    Some(of) => {
                        let drawn = self.machine_values(of, ActingErrors::OfField(field), (set_up, &poses), go_on)?;
                        PlaceFigures::of_machines(over_poses, drawn).widened(&values)
                    }
                    None => values,
                })
            }
            PlaceFigure::Bounds(of) => {
                let PlaceDraws { bounds, draws, samples } = of;
                let (reference, frame, listed) = (set_up.removed(), Frame::default(), Poses::Listed(poses.clone()));
                let request = PosesRequest { machine, bounds, poses: &listed, reference, frame, draws, samples };
                let found = pose_by_pose(request, go_on)?;
                let p95 = found.poses.iter().map(|of| of.position.p95 * 1e3);
                let over_poses = Summary::of_lengths(&mut p95.collect::<Vec<_>>());
                let [largest, _] = found.largest;
                Some(match self.statistic {
                    Statistic::Max => PlaceFigures::of_machines(over_poses, largest),
                    Statistic::P95 => {
                        let drawn = self.machine_values(of, ActingErrors::None, (set_up, &poses), go_on)?;
                        PlaceFigures::of_machines(over_poses, drawn)
                    }
                })
            }
        }))
    }

    /// Returns the statistic of machines drawn over poses, mm, without what a set-up takes out.
    fn machine_values(
        &self,
        of: PlaceDraws<'_>,
        acting: ActingErrors<'_>,
        (set_up, poses): (&SetUp, &[Pose]),
        progress: Advance<'_>,
    ) -> Result<impl Iterator<Item = f64> + use<>, Cancelled> {
        let PlaceDraws { bounds, draws, samples } = of;
        let (machine, statistic, reference) = (self.machine, self.statistic, set_up.removed());
        let (searched, at) = (false, None);
        let request = Request { machine, acting, bounds, poses, reference, searched, at, draws, samples, statistic };
        Ok(draw_samples(request, 0..samples, progress)?.position.into_iter().map(|machine| machine.value))
    }

    fn gain(
        &self,
        call: &mut Call<'_>,
        asked: Option<&Reference>,
        attempts: &[Attempt],
        [own, best]: [usize; 2],
        test: Option<&PairedTest>,
    ) -> Result<PlacementGain, Refused> {
        let [at_own, at_best] = [own, best].map(|index| &attempts[index].tried);
        let test = test.filter(|_| at_own.rewinds == at_best.rewinds);
        let minus = |a: usize, b: usize| a as i64 - b as i64;
        let common = match (&attempts[own].figures, &attempts[best].figures) {
            (Some(a), Some(b)) if attempts[own].missed == attempts[best].missed => {
                Some(CommonFigures::new(at_own.reached, [a, b], test))
            }
            (Some(_), Some(_)) => self.on_common(call, asked, [&at_own.place, &at_best.place], test)?,
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
        test: Option<&PairedTest>,
    ) -> Result<Option<CommonFigures>, Refused> {
        let jobs = places.map(|place| self.job.at(*place));
        let [a, b] = [&jobs[0], &jobs[1]].map(|job| job.poses.solved(self.machine).0);
        let (a, b): (Vec<Pose>, Vec<Pose>) = a.into_iter().zip(b).filter_map(|(a, b)| a.zip(b)).unzip();
        let count = a.len();
        let mut figures = Vec::new();
        for (job, poses) in jobs.iter().zip([a, b]) {
            let Ok(set_up) = self.set_up(job, asked, &poses) else { return Ok(None) };
            let figure = call.stage("places", 1, |progress| self.figure(&set_up, poses, progress))?;
            figures.extend(figure.or_else(|refusal| call.refuse(refusal))?);
        }
        Ok(match figures.as_slice() {
            [own, best] => Some(CommonFigures::new(count, [own, best], test)),
            _ => None,
        })
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
        let figure = of.um.map_or(0, |um| whole(um, FIGURE_UM));
        let margin = of.margin_mm.map(|mm| whole(mm, MARGIN_MM));
        (of.rewinds, figure, Reverse(margin), *index != own, *index)
    });
    ranked
}
