//! Changes that the readings of a fit allow, and what they make of a row.

use crate::evaluate::Frame;
use crate::identify::data::change::{
    Change, LENGTHS, SAME, Scope, axes, groups, lags, reposed, signs_and_units, tools,
};
use crate::identify::data::{Measurement, Reading, ReadingKind};
use crate::identify::model::FitModel;
use crate::lower::NominalPose;
use nalgebra::Vector3;

/// True if a row reads three components of an instrument; a ball that the tool is brought to reads its own pose.
fn reads_components(model: &FitModel<'_>, m: &Measurement) -> bool {
    matches!(m.reading, Reading::Deviation { .. }) && !is_ball(model, m)
}

fn is_ball(model: &FitModel<'_>, m: &Measurement) -> bool {
    let Reading::Deviation { zero: [Some(first), ..], .. } = m.reading else { return false };
    let name = model.parameters().get(model.own() + first).map_or("", |p| p.name.as_str());
    name.rsplit('/').next().unwrap_or(name).starts_with("ball")
}

/// Returns the changes that these data allow.
pub(super) fn all(model: &FitModel<'_>, data: &[Measurement]) -> Vec<Change> {
    let mut list = Vec::new();
    let groups = groups(data);
    components(&mut list, &Scope::All, model, data);
    // Consistent by themselves, but not with what the machine file knows.
    if data.iter().any(|m| reads_components(model, m) && m.readings() > 1) {
        list.push(Change::Values { from: SAME, factor: [-1.0; 3], scope: Scope::All });
    }
    if data.iter().any(|m| reads_components(model, m)) {
        let frames = [Frame::Workpiece, Frame::Machine, Frame::Tool];
        list.extend(frames.into_iter().filter(|frame| has_other_frame(data, *frame)).map(Change::Frame));
    }
    for scope in &groups {
        components(&mut list, scope, model, data);
        let whole = |factor| Change::Values { from: SAME, factor: [factor; 3], scope: scope.clone() };
        list.extend(signs_and_units(&LENGTHS).map(whole));
        list.extend([Change::Shifted(scope.clone()), Change::LeftOut(scope.clone())]);
    }
    // Where the poses are what is read, smaller ones agree the better the smaller they are.
    let poses_are_read = data.iter().any(|m| is_ball(model, m) || m.kind() == ReadingKind::Touch);
    axes(&mut list, &model.machines()[0], !poses_are_read);
    let scopes: Vec<Scope> =
        groups.into_iter().filter(|scope| matches!(scope, Scope::Run(_))).chain([Scope::All]).collect();
    let count = model.machines().len();
    tools(&mut list, count, &scopes, data);
    let used = (0..count).filter(|tool| count > 1 && data.iter().any(|m| m.tool == *tool));
    list.extend(used.map(Change::OtherTool));
    list.extend(lags());
    list.extend([Change::Drift(false), Change::Drift(true)]);
    list
}

fn has_other_frame(data: &[Measurement], frame: Frame) -> bool {
    data.iter().any(|m| matches!(m.reading, Reading::Deviation { frame: own, .. } if own != frame))
}

/// Exchanges, signs and units of components of some rows.
fn components(list: &mut Vec<Change>, scope: &Scope, model: &FitModel<'_>, data: &[Measurement]) {
    let rows: Vec<[bool; 3]> =
        data.iter().filter(|m| scope.holds(m) && reads_components(model, m)).map(Measurement::reading_mask).collect();
    let read = |k: usize| rows.iter().any(|mask| mask[k]);
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        if read(i) && rows.iter().all(|mask| mask[i] == mask[j]) {
            let mut from = SAME;
            from.swap(i, j);
            list.push(Change::Values { from, factor: [1.0; 3], scope: scope.clone() });
        }
    }
    for k in (0..3).filter(|k| read(*k)) {
        for factor in signs_and_units(&LENGTHS) {
            let mut all = [1.0; 3];
            all[k] = factor;
            list.push(Change::Values { from: SAME, factor: all, scope: scope.clone() });
        }
    }
}

/// Returns the change of all readings by a factor, and the factor.
pub(super) fn of_all(factor: f64) -> (Change, f64) {
    (Change::Values { from: SAME, factor: [factor; 3], scope: Scope::All }, factor)
}

/// Returns the root mean square of what is read (mm); `None` where not all are deviations.
pub(super) fn read_size(model: &FitModel<'_>, data: &[Measurement]) -> Option<f64> {
    let squares: f64 = data.iter().map(|m| m.values().norm_squared()).sum();
    let count: usize = data.iter().map(Measurement::readings).sum();
    data.iter().all(|m| reads_components(model, m)).then(|| libm::sqrt(squares / count.max(1) as f64))
}

/// Returns a row with changed pose; `None` where there is no such row, or where an axis does not travel.
pub(super) fn posed(changes: &[Change], model: &FitModel<'_>, data: &[Measurement], row: usize) -> Option<Measurement> {
    let mut m = reposed(changes, data, row)?;
    // The value of a tracker, a ball or a touch is what is read less the nominal place of the pose.
    let nominal = |m: &Measurement| NominalPose::in_part(model.machine(m), &m.pose).pose.translation;
    let moved = || nominal(&data[row]) - nominal(&m);
    let values = match &m.reading {
        Reading::Along { direction, is_touch: true, .. } => {
            Some(m.values() + Vector3::new(direction.dot(&moved()), 0.0, 0.0))
        }
        Reading::Position { .. } => Some(m.values() + moved()),
        _ => is_ball(model, &m).then(|| m.values() + moved()),
    };
    if let Some(values) = values {
        m = with_values(m, values);
    }
    Some(m)
}

/// Returns the values of a row with its readings changed, and the sum of the logarithms of the factors; `base` is what
/// a length would be without errors.
pub(super) fn revalued(changes: &[Change], model: &FitModel<'_>, m: &Measurement, base: f64) -> (Vector3<f64>, f64) {
    let (mut values, mut logs) = (m.values(), 0.0);
    let mask = m.reading_mask();
    let vector = reads_components(model, m);
    for change in changes {
        let Change::Values { from, factor, scope } = change else { continue };
        let whole = *from == SAME && factor[0] == factor[1] && factor[1] == factor[2];
        if !scope.holds(m) || !(vector || (whole && !matches!(m.kind(), ReadingKind::Position | ReadingKind::Turn(_))))
        {
            continue;
        }
        if vector {
            values = Vector3::from_fn(|k, _| factor[k] * values[from[k]]);
        } else if m.kind() == ReadingKind::Length {
            values.x = base + factor[0] * (values.x - base);
        } else {
            values *= factor[0];
        }
        logs += (0..3).filter(|k| mask[*k]).map(|k| libm::log(factor[k].abs())).sum::<f64>();
    }
    (values, logs)
}

/// Returns the row with other values.
pub(super) fn with_values(mut m: Measurement, to: Vector3<f64>) -> Measurement {
    match &mut m.reading {
        Reading::Deviation { values, .. } | Reading::Turn { values, .. } => {
            values.iter_mut().enumerate().for_each(|(k, value)| *value = value.map(|_| to[k]));
        }
        Reading::Position { value, .. } => *value = to,
        Reading::Distance { value, .. } | Reading::Along { value, .. } | Reading::Error { value, .. } => *value = to.x,
    }
    m
}
