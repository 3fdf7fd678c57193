//! Changes of the data that are tried: what shops mix up, in words and with the remedy.

use crate::diagnostic::{Sources, shown};
use crate::evaluate::Frame;
use crate::identify::data::{DistanceEnd, Measurement, Reading, ReadingKind};
use crate::identify::model::{FitModel, Parameter};
use crate::identify::thresholds::{MAX_BEYOND_TRAVEL, MAX_SUSPECT_GROUPS};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine};
use crate::units::significant;
use nalgebra::Vector3;

/// Factors between units of length that are taken for each other, of readings and of positions.
const LENGTHS: [(f64, &str); 6] = [
    (1e3, "mm taken for um, or um for nm"),
    (1e-3, "um taken for mm, or nm for um"),
    (25.4, "inches taken for mm, or thousandths of an inch for um"),
    (1.0 / 25.4, "mm taken for inches, or um for thousandths of an inch"),
    (0.0254, "microinches taken for um"),
    (1.0 / 0.0254, "um taken for microinches"),
];

/// Returns -1 and the factors of some units.
fn signs_and_units(units: &[(f64, &str)]) -> impl Iterator<Item = f64> {
    std::iter::once(-1.0).chain(units.iter().map(|(factor, _)| *factor))
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const ANGLES: [(f64, &str); 2] = [(DEGREES, "radians taken for degrees"), (1.0 / DEGREES, "degrees taken for radians")];
const COMPONENTS: [&str; 3] = ["dx", "dy", "dz"];
const SAME: [usize; 3] = [0, 1, 2];

/// Rows that a change concerns.
#[derive(Debug, Clone, PartialEq)]
pub enum Scope {
    /// All.
    All,
    /// Those of a run.
    Run(String),
    /// Those of a tool, by its index.
    Tool(usize),
    /// Those of a station, by its first unknown among those of the instruments.
    Station(usize),
}

impl Scope {
    /// True if a row belongs to it.
    pub fn holds(&self, m: &Measurement) -> bool {
        match self {
            Self::All => true,
            Self::Run(run) => m.run.as_ref() == Some(run),
            Self::Tool(tool) => m.tool == *tool,
            Self::Station(station) => of_station(m) == Some(*station),
        }
    }

    /// Returns it in words: `run 3`, `tool ball`, `station S1`; empty of all rows.
    pub fn words(&self, machine: &Machine, unknowns: &[Parameter], own: usize) -> String {
        match self {
            Self::All => String::new(),
            Self::Run(run) => format!("run {}", shown(run)),
            Self::Tool(tool) => format!("tool {}", tool_name(machine, *tool)),
            Self::Station(first) => {
                let name = unknowns.get(own + first).map_or("", |p| p.name.as_str());
                name.strip_suffix(".x").unwrap_or(name).to_owned()
            }
        }
    }
}

/// A change of the data.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Reading k is the component `from[k]` times `factor[k]`; of readings of one number the first factor, if all are
    /// the same.
    Values { from: [usize; 3], factor: [f64; 3], scope: Scope },
    /// Positions of two axes exchanged.
    Axes(usize, usize),
    /// Positions of axes times a factor.
    Positions(Vec<usize>, f64),
    /// Deviations are in another frame.
    Frame(Frame),
    /// Two tools exchanged in some rows.
    Tools(usize, usize, Scope),
    /// The pose is that of the row this many rows on.
    Rows(isize),
    /// Readings drift with the order of the rows: the tool in its frame if true, else every component.
    Drift(bool),
    /// A tool, by its index, whose length and offset are not those of the file.
    OtherTool(usize),
    /// Readings of these rows are shifted.
    Shifted(Scope),
    /// Rows left out.
    LeftOut(Scope),
    /// Single rows left out.
    RowsLeftOut(Vec<usize>),
}

impl Change {
    /// True if it changes the poses.
    pub fn is_of_poses(&self) -> bool {
        matches!(self, Self::Axes(..) | Self::Positions(..) | Self::Frame(_) | Self::Tools(..) | Self::Rows(_))
    }

    /// True if it changes nothing, but frees what the fit holds.
    pub fn is_free(&self) -> bool {
        self.adds_unknowns() || matches!(self, Self::LeftOut(_) | Self::RowsLeftOut(_))
    }

    /// True if it frees amounts that the model of the fit does not have.
    pub fn adds_unknowns(&self) -> bool {
        matches!(self, Self::Drift(_) | Self::Shifted(_) | Self::OtherTool(_))
    }

    /// True if it is a factor other than -1 of readings: what is left has another unit then.
    pub fn rescales(&self) -> bool {
        matches!(self, Self::Values { factor, .. } if factor.iter().any(|f| f.abs() != 1.0))
    }

    /// Returns it in words that follow `with`.
    pub fn words(
        &self,
        machine: &Machine,
        unknowns: &[Parameter],
        own: usize,
        data: &[Measurement],
        sources: &Sources,
    ) -> String {
        let name = |i: &usize| machine.axes()[*i].name.to_string();
        let of = |scope: &Scope| scope.words(machine, unknowns, own);
        match self {
            Self::Values { from, factor, scope } => values_words(*from, *factor, &of(scope)),
            Self::Axes(i, j) => format!("the positions of {} and {} exchanged", name(i), name(j)),
            Self::Positions(axes, factor) => {
                let names: Vec<String> = axes.iter().map(name).collect();
                let rotary = axes.iter().all(|i| machine.axes()[*i].kind == AxisKind::Rotary);
                match (*factor == -1.0, rotary) {
                    (true, true) => format!("{} turning the other way", names.join(", ")),
                    (true, false) => format!("the positions of {} of the other sign", names.join(", ")),
                    _ => format!("the positions of {} {}", names.join(", "), times(*factor)),
                }
            }
            Self::Frame(frame) => format!("the readings in the {} frame", frame_word(*frame)),
            Self::Tools(a, b, scope) => {
                let of = of(scope);
                let of = if of.is_empty() { of } else { format!(" in {of}") };
                format!("the tools {} and {} exchanged{of}", tool_name(machine, *a), tool_name(machine, *b))
            }
            Self::Rows(lag) => {
                let (count, way) = (lag.unsigned_abs(), if *lag < 0 { "before" } else { "after" });
                let rows = if count == 1 { "row" } else { "rows" };
                format!("every reading at the pose {count} {rows} {way} its own")
            }
            Self::Drift(true) => "a drift of the tool with the order of the rows".to_owned(),
            Self::Drift(false) => "a drift of the readings with the order of the rows".to_owned(),
            Self::OtherTool(tool) => format!("tool {} of another length or offset", tool_name(machine, *tool)),
            Self::Shifted(scope) => format!("the readings of {} shifted", of(scope)),
            Self::LeftOut(scope) => format!("{} left out", of(scope)),
            Self::RowsLeftOut(rows) => {
                let place = |row: &usize| {
                    let place = &data[*row].place;
                    format!("{}:{}", sources.name(place.source), sources.line_column(place).0)
                };
                format!("{} left out", rows.iter().map(place).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// Returns what to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Values { factor, .. } if factor.iter().any(|f| f.abs() != 1.0) => "correct the unit in the title",
            Self::Values { from, .. } if *from != SAME => "exchange the titles of the columns",
            Self::Values { .. } => "turn the sign (readings are actual minus nominal)",
            Self::Axes(..) => "exchange the titles of the axes",
            Self::Positions(_, factor) if *factor == -1.0 => "turn the sign of the positions",
            Self::Positions(..) => "correct the unit of the positions in the title",
            Self::Frame(Frame::Workpiece) => "state the frame: `--frame workpiece`",
            Self::Frame(Frame::Machine) => "state the frame: `--frame machine`",
            Self::Frame(Frame::Tool) => "state the frame: `--frame tool`",
            Self::Tools(..) => "correct the column `tool`",
            Self::Rows(_) => "let readings and poses settle, and join them anew",
            Self::Drift(_) => "measure warm and in mixed order, or repeat the first poses at the end",
            Self::OtherTool(_) => "measure the tool, or fit it (`--fit ...,tools`)",
            Self::Shifted(_) => "make it a run or set-up of its own, or measure it again",
            Self::LeftOut(_) => "leave it out, or measure it again",
            Self::RowsLeftOut(_) => "leave out these rows, or measure them again (`--robust` gives them less weight)",
        }
    }
}

fn frame_word(frame: Frame) -> &'static str {
    match frame {
        Frame::Workpiece => "workpiece",
        Frame::Machine => "machine",
        Frame::Tool => "tool",
    }
}

fn tool_name(machine: &Machine, tool: usize) -> String {
    machine.tools().get(tool).map_or_else(String::new, |tool| shown(&tool.name))
}

fn times(factor: f64) -> String {
    let known = LENGTHS.iter().chain(&ANGLES).find(|(known, _)| *known == factor);
    format!("times {} ({})", significant(factor, 4), known.map_or("another unit", |(_, words)| words))
}

fn values_words(from: [usize; 3], factor: [f64; 3], scope: &str) -> String {
    let names = |list: &mut dyn Iterator<Item = usize>| list.map(|k| COMPONENTS[k]).collect::<Vec<_>>();
    let moved = names(&mut (0..3).filter(|k| from[*k] != *k));
    let scaled = names(&mut (0..3).filter(|k| factor[*k] != 1.0));
    let what = if scaled.len() == 3 { "the readings".to_owned() } else { scaled.join(", ") };
    let of = if scope.is_empty() { String::new() } else { format!(" of {scope}") };
    match scaled.first().map(|name| factor[COMPONENTS.iter().position(|n| n == name).unwrap_or(0)]) {
        None => format!("{} exchanged{}", moved.join(" and "), of.replacen(" of", " in", 1)),
        Some(-1.0) => format!("{what}{of} of the other sign"),
        Some(factor) => format!("{what}{of} {}", times(factor)),
    }
}

fn of_station(m: &Measurement) -> Option<usize> {
    match m.reading {
        Reading::Distance { from: DistanceEnd::Station(first), .. } => Some(first),
        _ => None,
    }
}

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
    let tools = model.machines().len();
    for (a, b) in (0..tools).flat_map(|a| (a + 1..tools).map(move |b| (a, b))) {
        let meets = |scope: &&Scope| data.iter().any(|m| scope.holds(m) && (m.tool == a || m.tool == b));
        list.extend(scopes.iter().filter(meets).map(|scope| Change::Tools(a, b, scope.clone())));
    }
    let used = (0..tools).filter(|tool| tools > 1 && data.iter().any(|m| m.tool == *tool));
    list.extend(used.map(Change::OtherTool));
    list.extend([-2, -1, 1, 2].map(Change::Rows));
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

/// Exchanges and signs of positions, and `units`.
fn axes(list: &mut Vec<Change>, machine: &Machine, units: bool) {
    let axes = machine.axes();
    for (i, j) in (0..axes.len()).flat_map(|i| (i + 1..axes.len()).map(move |j| (i, j))) {
        list.extend((axes[i].kind == axes[j].kind).then_some(Change::Axes(i, j)));
    }
    for kind in [AxisKind::Linear, AxisKind::Rotary] {
        let own: Vec<usize> = (0..axes.len()).filter(|i| axes[*i].kind == kind).collect();
        let units = match kind {
            _ if !units => &[][..],
            AxisKind::Linear => &LENGTHS[..4],
            AxisKind::Rotary => &ANGLES,
        };
        for factor in signs_and_units(units) {
            list.extend(own.iter().map(|i| Change::Positions(vec![*i], factor)));
            list.extend((own.len() > 1).then(|| Change::Positions(own.clone(), factor)));
        }
    }
}

/// Returns the change of all readings from nm to um, and its factor.
pub(super) fn nanometres() -> (Change, f64) {
    (Change::Values { from: SAME, factor: [1e-3; 3], scope: Scope::All }, 1e-3)
}

/// Returns runs, tools and stations, where there are several.
pub fn groups(data: &[Measurement]) -> Vec<Scope> {
    let mut found: [Vec<Scope>; 3] = Default::default();
    for m in data {
        let of = [m.run.clone().map(Scope::Run), Some(Scope::Tool(m.tool)), of_station(m).map(Scope::Station)];
        for (list, scope) in found.iter_mut().zip(of) {
            list.extend(scope.filter(|scope| list.len() <= MAX_SUSPECT_GROUPS && !list.contains(scope)));
        }
    }
    found.into_iter().filter(|list| (2..=MAX_SUSPECT_GROUPS).contains(&list.len())).flatten().collect()
}

/// Returns a row with changed pose; `None` where there is no such row, or where an axis does not travel.
pub(super) fn posed(changes: &[Change], model: &FitModel<'_>, data: &[Measurement], row: usize) -> Option<Measurement> {
    let mut m = data[row].clone();
    for change in changes {
        match change {
            Change::Rows(lag) => {
                let other = data.get(row.checked_add_signed(*lag)?)?;
                if other.run != m.run || other.kind() != m.kind() {
                    return None;
                }
                (m.pose, m.tool, m.approach) = (other.pose.clone(), other.tool, other.approach);
            }
            Change::Axes(i, j) => m.pose.swap(*i, *j),
            Change::Positions(axes, factor) => axes.iter().for_each(|i| m.pose[*i] *= factor),
            Change::Frame(frame) => {
                if let Reading::Deviation { frame: own, .. } = &mut m.reading {
                    *own = *frame;
                }
            }
            Change::Tools(a, b, scope) if scope.holds(&m) => {
                m.tool = if m.tool == *a {
                    *b
                } else if m.tool == *b {
                    *a
                } else {
                    m.tool
                }
            }
            _ => {}
        }
    }
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

/// True if all positions are within the travels.
pub(super) fn is_reachable(machine: &Machine, m: &Measurement) -> bool {
    machine.axes().iter().zip(&m.pose).all(|(axis, q)| {
        let (low, high) = axis.travel.interval();
        let slack = MAX_BEYOND_TRAVEL * (high - low);
        axis.travel.contains(*q) || (low - slack..=high + slack).contains(q)
    })
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
