//! Runs against each other: single readings far off, a trend, a run in another unit, with another sign, or with its
//! directions exchanged.

use super::finding::{ACCEPT, Finding, FindingEffect, FindingKind};
use super::repeats::{Deviations, MeasuredPass, Repeats, least, median, robust_sigma};
use crate::diagnostic::Place;
use crate::identify::data::import::sample::Import;
use crate::identify::thresholds::{
    MAX_JUDGED_PASSES, MAX_OUTLIER_SHARE, MAX_OUTLIER_SIGMA, MIN_DRIFT_DETERMINATION, MIN_DRIFT_MM, MIN_DRIFT_SIGMA,
    MIN_EXCHANGE_SHARE, MIN_EXCHANGE_SIGMA, MIN_HARM_MM, MIN_JUDGED_TARGETS, MIN_OTHER_RUN_RATIO,
    MIN_REPEATED_READINGS, MIN_UNIT_RATIO, MIN_UNIT_SLOPE,
};
use crate::standards::Coverage;
use crate::syntax::ColumnDirection::{Forward, Reverse};
use crate::units::{counted, significant};

/// Searches for outliers: as long as one is found, it may hide others.
const OUTLIER_ROUNDS: usize = 8;

/// Factors between units that instruments and spreadsheets take for each other.
const LENGTHS: [(f64, &str); 6] = [
    (1e3, "mm taken for um, or um for nm"),
    (1e-3, "um taken for mm, or nm for um"),
    (25.4, "thousandths of an inch taken for um, or inches for mm"),
    (1.0 / 25.4, "um taken for thousandths of an inch, or mm for inches"),
    (10.0, "a decimal place too few"),
    (0.1, "a decimal place too many"),
];
const ARCSEC: f64 = 4.848_136_811;
const ANGLES: [(f64, &str); 6] = [
    (1e3, "mrad taken for urad"),
    (1e-3, "urad taken for mrad"),
    (ARCSEC, "arcsec taken for urad"),
    (1.0 / ARCSEC, "urad taken for arcsec"),
    (10.0, "a decimal place too few"),
    (0.1, "a decimal place too many"),
];

/// The readings of one error.
pub(super) struct Runs<'a> {
    import: &'a Import,
    error: usize,
    repeats: Repeats,
    /// Factor and name of the unit in which they are printed.
    factor: f64,
    unit: &'static str,
}

impl<'a> Runs<'a> {
    pub fn of(import: &'a Import, error: usize) -> Self {
        let (factor, unit) = import.errors[error].direction.micro();
        Self { import, error, repeats: Repeats::of(&import.samples, error), factor, unit }
    }

    fn least(&self, limit_mm: f64) -> f64 {
        least(&self.import.errors[self.error], limit_mm)
    }

    fn print(&self, value: f64) -> String {
        format!("{} {}", significant(value * self.factor, 4), self.unit)
    }

    fn place(&self, sample: usize) -> Place {
        self.import.samples[sample].place.clone()
    }

    fn finding(&self, kind: FindingKind, places: Vec<Place>, message: String, help: String) -> Finding {
        let refuses =
            matches!(kind, FindingKind::UnitOfRun | FindingKind::SignOfRun | FindingKind::DirectionsExchanged);
        let effect = if refuses { FindingEffect::Refused } else { FindingEffect::Used };
        Finding { kind, error: Some(self.error), places, message, help, effect }
    }

    fn name(&self) -> String {
        self.import.errors[self.error].to_string()
    }

    /// Returns runs that are another quantity, or that have their directions exchanged.
    pub fn wrong_runs(&self) -> Vec<Finding> {
        let (passes, targets) = (self.repeats.passes.len(), self.repeats.targets.len());
        if !(2..=MAX_JUDGED_PASSES).contains(&passes) || targets < MIN_JUDGED_TARGETS {
            return Vec::new();
        }
        let all = vec![true; self.repeats.readings.len()];
        let levels = self.repeats.deviations(&all).levels;
        let scaled: Vec<Finding> = (0..passes).filter_map(|pass| self.scaled_run(pass, &levels)).collect();
        // Of two runs each explains the other: the one that is too small is named, as spreadsheets lose the factor.
        let scaled = if passes == 2 { scaled.into_iter().take(1).collect() } else { scaled };
        if scaled.is_empty() { self.exchanged_runs(&levels) } else { scaled }
    }

    /// Looks for a factor by which a run agrees with the others, where it does not without.
    fn scaled_run(&self, pass: usize, levels: &[f64]) -> Option<Finding> {
        let same = |other: usize| self.repeats.passes[other].direction == self.repeats.passes[pass].direction;
        let of_way = (0..self.repeats.passes.len()).filter(|other| *other != pass && same(*other)).count();
        let others = self.repeats.profile(levels, |other| other != pass && (of_way < 2 || same(other)));
        let pairs: Vec<(f64, f64)> = self.pairs(pass, &others, 0.0).collect();
        if pairs.len() < MIN_JUDGED_TARGETS {
            return None;
        }
        let left = |factor: f64| {
            let mut off: Vec<f64> = pairs.iter().map(|(own, other)| own * factor - other).collect();
            let level = median(&mut off);
            robust_sigma(off.into_iter().map(|off| off - level))
        };
        let mut profile: Vec<f64> = pairs.iter().map(|(_, other)| *other).collect();
        let level = median(&mut profile);
        let profile = robust_sigma(profile.into_iter().map(|value| value - level));
        let units = if self.import.errors[self.error].direction.is_rotation() { ANGLES } else { LENGTHS };
        let unscaled = left(1.0);
        let tried =
            units.into_iter().chain([(-1.0, "the other sign")]).map(|(factor, why)| (left(factor), factor, why));
        let (best, factor, why) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
        // The run must follow the curve of the others: the slope of one on the other in its standard deviations.
        let followed = profile * libm::sqrt(pairs.len() as f64);
        // One that is off beyond all scatter is refused in either case.
        let is_other = unscaled > MIN_OTHER_RUN_RATIO * best;
        let by_chance =
            if is_other { 1.0 } else { MIN_UNIT_SLOPE } * Coverage::default().reach(pairs.len() as f64 - 2.0) * best;
        if unscaled < self.least(MIN_HARM_MM).max(MIN_UNIT_RATIO * best) || followed < by_chance {
            return None;
        }
        let run = self.repeats.passes[pass].words();
        let (name, best, unscaled) = (self.name(), self.print(best), self.print(unscaled));
        let kind = if factor < 0.0 { FindingKind::SignOfRun } else { FindingKind::UnitOfRun };
        let message = format!(
            "{run} of `{name}` times {} agrees with the other runs to {best} instead of {unscaled}: {why}",
            significant(factor, 4)
        );
        let help = format!("correct the unit or the sign of this run in its title or by `--columns FILE`; {ACCEPT}");
        Some(self.finding(kind, vec![self.place(self.repeats.passes[pass].first)], message, help))
    }

    /// Pairs the readings of a pass, less a level, with a profile.
    fn pairs<'p>(
        &'p self,
        pass: usize,
        profile: &'p [Option<f64>],
        level: f64,
    ) -> impl Iterator<Item = (f64, f64)> + 'p {
        let of_pass = self.repeats.readings.iter().filter(move |r| r.pass == pass);
        of_pass.filter_map(move |r| Some((r.value - level, profile[r.target]?)))
    }

    /// Looks for runs that agree with the others if their directions are exchanged.
    fn exchanged_runs(&self, levels: &[f64]) -> Vec<Finding> {
        let passes = &self.repeats.passes;
        let of = |run: usize, way| passes.iter().position(|pass| pass.run == run && pass.direction == Some(way));
        let pair = |run: usize| Some((of(run, Forward)?, of(run, Reverse)?));
        let runs: Vec<(usize, usize)> = (0..self.repeats.runs).filter_map(pair).collect();
        if runs.len() < 2 {
            return Vec::new();
        }
        // The level of a run is common to both ways: an exchange leaves it.
        let mut common = vec![0.0; passes.len()];
        for (forward, reverse) in &runs {
            let level = (levels[*forward] + levels[*reverse]) / 2.0;
            (common[*forward], common[*reverse]) = (level, level);
        }
        let mut found = Vec::new();
        for (forward, reverse) in &runs {
            let others = |way| {
                let of_others =
                    |pass: usize| passes[pass].direction == Some(way) && passes[pass].run != passes[*forward].run;
                self.repeats.profile(&common, of_others)
            };
            let (up, down) = (others(Forward), others(Reverse));
            let own = |pass: usize| self.repeats.profile(&common, |other| other == pass);
            let reversal = |up: &[Option<f64>], down: &[Option<f64>]| -> Vec<Option<f64>> {
                up.iter().zip(down).map(|(up, down)| Some((*up)? - (*down)?)).collect()
            };
            let pairs = reversal(&own(*forward), &own(*reverse)).into_iter().zip(reversal(&up, &down));
            let pairs: Vec<(f64, f64)> = pairs.filter_map(|(own, others)| Some((own?, others?))).collect();
            // With the sign of the others, which may change along the axis.
            let mut along: Vec<f64> = pairs.iter().map(|(own, others)| own * others.signum()).collect();
            let mut size: Vec<f64> = pairs.iter().map(|(_, others)| others.abs()).collect();
            let (along, size) = (median(&mut along), median(&mut size));
            let exchanged = robust_sigma(pairs.iter().map(|(own, others)| own + others));
            let seen = size * libm::sqrt(pairs.len() as f64) > MIN_EXCHANGE_SIGMA * exchanged;
            let harms = size > self.least(MIN_HARM_MM) && pairs.len() >= MIN_JUDGED_TARGETS;
            if harms && seen && along < -MIN_EXCHANGE_SHARE * size {
                let as_it_is = robust_sigma(pairs.iter().map(|(own, others)| own - others));
                let mut own: Vec<f64> = pairs.iter().map(|(own, _)| *own).collect();
                found.push((*forward, as_it_is, exchanged, median(&mut own)));
            }
        }
        // Of two runs each explains the other: lost motion reads less from below.
        if runs.len() == 2 && found.len() == 2 {
            found.sort_by(|a, b| b.3.total_cmp(&a.3));
            found.truncate(1);
        }
        let finding = |(pass, as_it_is, exchanged, _): (usize, f64, f64, f64)| {
            let of: &MeasuredPass = &passes[pass];
            let message = format!(
                "with its directions exchanged, the reversal of run {} of `{}` agrees with the others to {} instead of \
                 {}",
                crate::diagnostic::shown(&of.name),
                self.name(),
                self.print(exchanged),
                self.print(as_it_is)
            );
            let help = format!("exchange the titles of forward and reverse of this run; {ACCEPT}");
            self.finding(FindingKind::DirectionsExchanged, vec![self.place(of.first)], message, help)
        };
        found.into_iter().map(finding).collect()
    }

    /// Returns single readings far off their repeats, with their samples, and what is left without them.
    pub fn outliers(&self) -> (Vec<(usize, Finding)>, Deviations) {
        let repeats = &self.repeats;
        let mut used = vec![true; repeats.readings.len()];
        let mut found: Vec<(usize, f64, f64)> = Vec::new();
        for _ in 0..OUTLIER_ROUNDS {
            let deviations = repeats.deviations(&used);
            let compared = deviations.off.iter().flatten().count();
            if compared < MIN_REPEATED_READINGS || repeats.targets.len() < MIN_JUDGED_TARGETS {
                break;
            }
            let limit = (MAX_OUTLIER_SIGMA * deviations.scatter).max(self.least(MIN_HARM_MM));
            let largest = self.largest(&deviations, limit);
            if largest.is_empty() {
                break;
            }
            for (reading, off) in largest {
                used[reading] = false;
                found.push((reading, off, deviations.sigma));
            }
        }
        let deviations = repeats.deviations(&used);
        let share = found.len() as f64 / repeats.readings.len().max(1) as f64;
        if share > MAX_OUTLIER_SHARE && found.len() > 1 {
            let places = found.iter().map(|(k, ..)| self.place(repeats.readings[*k].sample)).collect();
            let message = format!(
                "{} of `{}` are far off their repeats, where the others scatter by {}: the test does not repeat",
                counted(found.len(), "reading"),
                self.name(),
                self.print(deviations.sigma)
            );
            let help = "look for a loose mount, an interrupted beam or a wrong column, and measure again".to_owned();
            let all = vec![true; repeats.readings.len()];
            let finding = self.finding(FindingKind::Scatter, places, message, help);
            return (vec![(usize::MAX, finding)], repeats.deviations(&all));
        }
        found.sort_by_key(|(reading, ..)| repeats.readings[*reading].sample);
        let findings = found.into_iter().map(|(k, off, sigma)| self.outlier(k, off, sigma.min(deviations.sigma)));
        (findings.collect(), deviations)
    }

    /// Returns of every group of repeats the reading that is farthest off, if it is beyond a limit.
    fn largest(&self, deviations: &Deviations, limit: f64) -> Vec<(usize, f64)> {
        let repeats = &self.repeats;
        let mut largest: indexmap::IndexMap<usize, Vec<(usize, f64)>> = indexmap::IndexMap::new();
        for (k, off) in deviations.off.iter().enumerate() {
            if let Some(off) = off.filter(|off| off.abs() > limit) {
                largest.entry(repeats.readings[k].group).or_default().push((k, off));
            }
        }
        // Of two readings alone either may be wrong: the one that its neighbours do not bear out.
        let from_neighbours = |k: usize| {
            let reading = &repeats.readings[k];
            repeats.neighbours(reading).map_or(0.0, |beside| (reading.value - beside).abs())
        };
        let farther = |a: (usize, f64), b: (usize, f64)| {
            let (of_a, of_b) = (a.1.abs(), b.1.abs());
            let equal = (of_a - of_b).abs() <= 1e-9 * of_a;
            let second = if equal { from_neighbours(b.0) > from_neighbours(a.0) } else { of_b > of_a };
            if second { b } else { a }
        };
        largest.into_values().filter_map(|group| group.into_iter().reduce(farther)).collect()
    }

    fn outlier(&self, reading: usize, off: f64, sigma: f64) -> (usize, Finding) {
        let of = &self.repeats.readings[reading];
        let unit = if self.import.rotary { "deg" } else { "mm" };
        let message = format!(
            "{} of `{}` reads {} at {} {unit}, {} off its repeats, which scatter by {}",
            self.repeats.passes[of.pass].words(),
            self.name(),
            self.print(of.value),
            self.repeats.targets[of.target] + 0.0,
            self.print(off),
            self.print(sigma)
        );
        let help = "the reading is left out of figures and table; measure it again, mark its row in a column `exclude` \
                    or take it with `--accept suspect`";
        let finding = self.finding(FindingKind::Outlier, vec![self.place(of.sample)], message, help.to_owned());
        (of.sample, Finding { effect: FindingEffect::LeftOut, ..finding })
    }

    /// Returns a trend from run to run that is larger than what repeats scatter by.
    pub fn drift(&self, deviations: &Deviations) -> Option<Finding> {
        let passes = &self.repeats.passes;
        let runs = self.repeats.runs;
        if !(2..=MAX_JUDGED_PASSES).contains(&runs) || self.repeats.targets.len() < MIN_JUDGED_TARGETS {
            return None;
        }
        let (mut sums, mut counts) = (vec![0.0; runs], vec![0.0; runs]);
        for (pass, level) in passes.iter().zip(&deviations.levels) {
            sums[pass.run] += level;
            counts[pass.run] += 1.0;
        }
        let means: Vec<f64> = sums.iter().zip(counts).map(|(sum, count): (&f64, f64)| sum / count).collect();
        let n = runs as f64;
        let (middle, mean) = ((n - 1.0) / 2.0, means.iter().sum::<f64>() / n);
        let steps = || means.iter().enumerate().map(|(k, level)| (k as f64 - middle, level - mean));
        let (sxx, sxy, syy) = steps().fold((0.0, 0.0, 0.0), |s, (x, y)| (s.0 + x * x, s.1 + x * y, s.2 + y * y));
        let total = sxy / sxx * (n - 1.0);
        let determination = if syy > 0.0 { sxy * sxy / (sxx * syy) } else { 0.0 };
        let one_way = means.windows(2).all(|w| w[1] > w[0]) || means.windows(2).all(|w| w[1] < w[0]);
        // Two runs are no trend, but one step.
        let sigmas = if runs == 2 { 2.0 * MIN_DRIFT_SIGMA } else { MIN_DRIFT_SIGMA };
        let large = total.abs() > (sigmas * deviations.sigma).max(self.least(MIN_DRIFT_MM));
        if !large || !(one_way || determination >= MIN_DRIFT_DETERMINATION) {
            return None;
        }
        let ends = [0, runs - 1].map(|run| passes.iter().find(|pass| pass.run == run));
        let [first, last] = ends.map(|pass| pass.map_or("", |pass| &pass.name));
        let (name, total, sigma) = (self.name(), self.print(total), self.print(deviations.sigma));
        let message = format!(
            "`{name}` drifts by {total} from run {first} to run {last}, where readings scatter by {sigma} within runs"
        );
        let help = format!(
            "warm up and measure again, or state it: `--uncertainty \"drift {}\"`; the table has the mean of all runs",
            total.trim_start_matches('-')
        );
        let places = ends.into_iter().flatten().map(|pass| self.place(pass.first)).collect();
        Some(self.finding(FindingKind::Drift, places, message, help))
    }
}
