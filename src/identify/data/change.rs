//! Changes of the data that are tried: what shops mix up, in words and with the remedy.

use super::measurement::{DistanceEnd, Measurement, Reading};
use crate::diagnostic::shown;
use crate::evaluate::Frame;
use crate::identify::thresholds::{MAX_BEYOND_TRAVEL, MAX_SUSPECT_GROUPS};
use crate::machine::{AxisKind, Machine};
use crate::units::significant;

/// Factors between units of length that are taken for each other, of readings and of positions.
pub(in crate::identify) const LENGTHS: [(f64, &str); 6] = [
    (1e3, "mm taken for um, or um for nm"),
    (1e-3, "um taken for mm, or nm for um"),
    (25.4, "inches taken for mm, or thousandths of an inch for um"),
    (1.0 / 25.4, "mm taken for inches, or um for thousandths of an inch"),
    (0.0254, "microinches taken for um"),
    (1.0 / 0.0254, "um taken for microinches"),
];

/// Returns -1 and the factors of some units.
pub(in crate::identify) fn signs_and_units(units: &[(f64, &str)]) -> impl Iterator<Item = f64> {
    std::iter::once(-1.0).chain(units.iter().map(|(factor, _)| *factor))
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const ANGLES: [(f64, &str); 2] = [(DEGREES, "radians taken for degrees"), (1.0 / DEGREES, "degrees taken for radians")];
/// Titles of the components of a deviation.
pub(crate) const COMPONENTS: [&str; 3] = ["dx", "dy", "dz"];
/// Every component in its own place.
pub(in crate::identify) const SAME: [usize; 3] = [0, 1, 2];

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
    pub fn words(&self, names: &ChangeNames<'_>) -> String {
        match self {
            Self::All => String::new(),
            Self::Run(run) => format!("run {}", shown(run)),
            Self::Tool(tool) => format!("tool {}", tool_name(names.machine, *tool)),
            Self::Station(first) => {
                let name = (names.instrument)(*first);
                name.strip_suffix(".x").unwrap_or(&name).to_owned()
            }
        }
    }
}

/// Between two changes in words.
pub(crate) const AND: &str = " and with ";

/// Names that changes have in words.
pub struct ChangeNames<'a> {
    /// The machine, of which axes and tools are named.
    pub machine: &'a Machine,
    /// Name of an unknown of the instruments, by its index.
    pub instrument: &'a dyn Fn(usize) -> String,
    /// File and line of a row, by its index.
    pub row: &'a dyn Fn(usize) -> String,
    /// Titles of the three components of a reading.
    pub components: [&'a str; 3],
}

/// A change of the data.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Reading k is the component `from[k]` times `factor[k]`; of readings of one number the first factor, if all are
    /// the same.
    Values { from: [usize; 3], factor: [f64; 3], scope: Scope },
    /// The coordinates of an instrument of the other hand.
    Hand,
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

    /// True if it exchanges or turns round what is there: of good data it makes nothing better.
    pub fn is_exchange(&self) -> bool {
        match self {
            Self::Axes(..) | Self::Hand | Self::Frame(_) | Self::Tools(..) | Self::Rows(_) => true,
            Self::Positions(_, factor) => *factor == -1.0,
            Self::Values { factor, .. } => factor.iter().all(|f| f.abs() == 1.0),
            _ => false,
        }
    }

    /// Returns it in words that follow `with`.
    pub fn words(&self, names: &ChangeNames<'_>) -> String {
        let machine = names.machine;
        let name = |i: &usize| machine.axes()[*i].name.to_string();
        let of = |scope: &Scope| scope.words(names);
        match self {
            Self::Values { from, factor, scope } => values_words(*from, *factor, &of(scope), &names.components),
            Self::Hand => "the coordinates of the other hand (one of the other sign, or two exchanged)".to_owned(),
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
                let list: Vec<String> = rows.iter().map(|row| (names.row)(*row)).collect();
                format!("{} left out", list.join(", "))
            }
        }
    }

    /// Returns what to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Values { factor, .. } if factor.iter().any(|f| f.abs() != 1.0) => "correct the unit in the title",
            Self::Values { from, .. } if *from != SAME => "exchange the titles of the columns",
            Self::Values { .. } => "turn the sign (readings are actual minus nominal)",
            Self::Hand => "turn the sign of one coordinate, or exchange the titles of two",
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

fn values_words(from: [usize; 3], factor: [f64; 3], scope: &str, components: &[&str; 3]) -> String {
    let names = |list: &mut dyn Iterator<Item = usize>| list.map(|k| components[k]).collect::<Vec<_>>();
    let moved = names(&mut (0..3).filter(|k| from[*k] != *k));
    let scaled = names(&mut (0..3).filter(|k| factor[*k] != 1.0));
    let what = if scaled.len() == 3 { "the readings".to_owned() } else { scaled.join(", ") };
    let of = if scope.is_empty() { String::new() } else { format!(" of {scope}") };
    match factor.into_iter().find(|f| *f != 1.0) {
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

/// Exchanges and signs of positions, and `units`.
pub(in crate::identify) fn axes(list: &mut Vec<Change>, machine: &Machine, units: bool) {
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

/// True if all positions are within the travels.
pub(in crate::identify) fn is_reachable(machine: &Machine, m: &Measurement) -> bool {
    machine.axes().iter().zip(&m.pose).all(|(axis, q)| {
        let (low, high) = axis.travel.interval();
        let slack = MAX_BEYOND_TRAVEL * (high - low);
        axis.travel.contains(*q) || (low - slack..=high + slack).contains(q)
    })
}

/// Exchanges of two tools in each of these scopes.
pub(in crate::identify) fn tools(list: &mut Vec<Change>, count: usize, scopes: &[Scope], data: &[Measurement]) {
    for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))) {
        let meets = |scope: &&Scope| data.iter().any(|m| scope.holds(m) && (m.tool == a || m.tool == b));
        list.extend(scopes.iter().filter(meets).map(|scope| Change::Tools(a, b, scope.clone())));
    }
}

/// Exchanges of readings and poses by some rows.
pub(in crate::identify) fn lags() -> impl Iterator<Item = Change> {
    [-2, -1, 1, 2].into_iter().map(Change::Rows)
}

/// Returns a row at its changed pose, with its readings as they are; `None` where there is no such row.
pub(in crate::identify) fn reposed(changes: &[Change], data: &[Measurement], row: usize) -> Option<Measurement> {
    let mut m = data[row].clone();
    // Positions are exchanged in the row whose pose it is.
    for change in changes {
        let Change::Rows(lag) = change else { continue };
        let other = data.get(row.checked_add_signed(*lag)?)?;
        if other.run != m.run || other.kind() != m.kind() {
            return None;
        }
        (m.pose, m.tool, m.approach) = (other.pose.clone(), other.tool, other.approach);
    }
    for change in changes {
        match change {
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
    Some(m)
}
