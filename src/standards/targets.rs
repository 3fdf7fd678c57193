//! The targets of a measurement of positioning, judged as ISO 230-2:2014 wants them (from general knowledge, not
//! verified against the text).

use super::positioning::AccuracyFigures;
use super::range;

const RUNS: usize = 5;
/// Travel (mm) up to which a linear axis has five targets to a metre and five runs.
const SHORT: f64 = 2000.0;
/// Largest pitch (mm) beyond it.
const PITCH: f64 = 250.0;
/// Pitches that differ by less than this share of their mean are even.
const EVEN: f64 = 1e-3;

/// Returns in sentences what the standard wants otherwise.
pub fn remarks(figures: &AccuracyFigures, rotary: bool) -> Vec<String> {
    let positions: Vec<f64> = figures.targets.iter().map(|t| t.position).collect();
    let span = range(positions.iter().copied());
    let pitches: Vec<f64> = positions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (count, wanted) = (positions.len(), min_targets(span, rotary));
    let (unit, long) = (if rotary { "deg" } else { "mm" }, !rotary && span > SHORT);
    let mut remarks = Vec::new();
    if count < wanted {
        remarks.push(format!("{count} targets over {span} {unit}: the standard has {wanted}"));
    }
    let widest = pitches.iter().copied().fold(0.0, f64::max);
    if long && widest > PITCH {
        remarks.push(format!("targets {widest} mm apart: the standard has at most {PITCH} mm"));
    }
    let mean = span / pitches.len().max(1) as f64;
    if pitches.len() > 1 && range(pitches.iter().copied()) < EVEN * mean {
        remarks.push(format!(
            "targets at an even pitch of {mean} {unit}: an error that repeats with it, or with a whole part of it, is \
             not seen"
        ));
    }
    if !figures.bidirectional() {
        remarks.push("one direction only: no reversal, and nothing of both directions".to_owned());
    }
    if !long && figures.runs < RUNS {
        let runs = figures.runs;
        remarks.push(format!("{runs} of {RUNS} runs in each direction: s, R and A of so few are mostly chance"));
    }
    remarks
}

/// The least number of targets over a span (mm or deg).
fn min_targets(span: f64, rotary: bool) -> usize {
    match rotary {
        true if span <= 90.0 => 3,
        true if span <= 180.0 => 5,
        true => 8,
        false if span > SHORT => 0,
        false => ((span / 1000.0 * 5.0).ceil() as usize).max(5),
    }
}

#[cfg(test)]
mod tests {
    use super::super::TargetReading;
    use super::*;
    use crate::syntax::ColumnDirection;

    fn judged(positions: &[f64], runs: usize, rotary: bool) -> Vec<String> {
        let ways = [ColumnDirection::Forward, ColumnDirection::Reverse];
        let at = |position: f64| {
            ways.into_iter().map(move |way| TargetReading { position, direction: Some(way), value: 0.0 })
        };
        let readings: Vec<TargetReading> =
            (0..runs).flat_map(|_| positions.iter().flat_map(|p| at(*p)).collect::<Vec<_>>()).collect();
        remarks(&AccuracyFigures::of(&readings).unwrap(), rotary)
    }

    #[test]
    fn targets_are_judged() {
        assert_eq!(judged(&[3.0, 101.0, 212.0, 287.0, 399.0], 5, false), Vec::<String>::new());
        let even = judged(&[0.0, 100.0, 200.0, 300.0, 400.0], 5, false);
        assert!(even.len() == 1 && even[0].contains("even pitch of 100 mm"), "{even:?}");
        let few = judged(&[0.0, 700.0, 1501.0], 3, false);
        assert!(
            few.len() == 2 && few[0].starts_with("3 targets over 1501 mm") && few[1].starts_with("3 of 5"),
            "{few:?}"
        );
        let long = judged(&[0.0, 1100.0, 2400.0], 1, false);
        assert!(long.len() == 1 && long[0].contains("at most 250 mm"), "{long:?}");
        let turn = judged(&[0.0, 91.0, 179.0, 270.0, 360.0], 5, true);
        assert!(turn.len() == 1 && turn[0].contains("the standard has 8"), "{turn:?}");
    }
}
