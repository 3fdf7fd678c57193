//! Axes: kind, direction, origin, travel, and what holds of them on one side of the bed.

use super::beyond::Beyond;
use super::context::{Context, dotted_path};
use super::positions::{PositionDraft, block_key, position};
use super::quantities::slip_in_list;
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::{AxisKind, AxisName, Branch, ControllerAxis, Sense, Travel};
use crate::syntax::{AxisEntry, ControllerEntry, Keys, Scalar, SideEntry, TravelEntry, below, keys};

/// Shortest travel, mm or deg: controls have increments of a micrometre or a thousandth of a degree.
const SHORTEST: f64 = 1e-3;

/// Maximum number of axes of a file: those of the chain, and those that variants leave out.
const MAX_DECLARED: usize = 64;

/// An axis as far as its entry could be understood; it may be outside the chain.
#[derive(Debug, Clone)]
pub struct AxisDraft {
    pub name: AxisName,
    pub kind: Option<AxisKind>,
    pub sense: Option<Sense>,
    pub controller: ControllerAxis,
    pub home: Option<f64>,
    /// The course of its curves beyond their points, unless a curve says otherwise.
    pub beyond: Option<Beyond>,
    /// The plain keys.
    pub plain: SideDraft,
    /// The blocks `on_tool` and `on_workpiece`.
    pub on_tool: SideDraft,
    pub on_workpiece: SideDraft,
    /// The side on which the axis stands.
    pub side: Branch,
    /// The travel there.
    pub travel: Option<Travel>,
}

/// Geometry of an axis that an entry gives.
#[derive(Debug, Clone, Default)]
pub struct SideDraft {
    pub direction: Option<[f64; 3]>,
    pub origin: Option<PositionDraft>,
    pub travel: Option<Travel>,
}

impl AxisDraft {
    /// Geometry on a side: its block, else the plain keys, else the block of the other side.
    pub fn on(&self, branch: Branch) -> SideDraft {
        let (own, other) = match branch {
            Branch::Tool => (&self.on_tool, &self.on_workpiece),
            Branch::Workpiece => (&self.on_workpiece, &self.on_tool),
        };
        SideDraft {
            direction: own.direction.or(self.plain.direction).or(other.direction),
            origin: own.origin.clone().or(self.plain.origin.clone()).or(other.origin.clone()),
            travel: own.travel.or(self.plain.travel).or(other.travel),
        }
    }

    /// Returns the block of a side.
    pub fn block(&self, branch: Branch) -> &SideDraft {
        if branch == Branch::Tool { &self.on_tool } else { &self.on_workpiece }
    }

    /// Returns the same axis as it is on a side.
    pub fn standing_on(&self, branch: Branch) -> Self {
        Self { side: branch, travel: self.on(branch).travel, ..self.clone() }
    }

    /// Returns the entry of its travel.
    pub fn travel_entry(&self) -> Keys {
        let axis = keys(["axes", self.name.as_str()]);
        let sides = [self.side, self.side.opposite()];
        match sides.into_iter().find(|side| self.block(*side).travel.is_some()) {
            Some(side) if side == self.side || self.plain.travel.is_none() => {
                below(&below(&axis, block_key(side)), "travel")
            }
            _ => below(&axis, "travel"),
        }
    }
}

/// Returns the block of a side as written.
pub fn block_entry(entry: &AxisEntry, branch: Branch) -> Option<&SideEntry> {
    if branch == Branch::Tool { entry.on_tool.as_ref() } else { entry.on_workpiece.as_ref() }
}

/// Refuses a file with more axes than any machine and its variants have.
pub fn refuse_many(context: &mut Context) -> Option<()> {
    let count = context.document.axes.len();
    if count <= MAX_DECLARED {
        return Some(());
    }
    let message = format!("the file declares {count} axes, the limit is {MAX_DECLARED}");
    context.at_key(codes::E0307, &keys(["axes"]), message, "declare those of the chain and of its variants");
    None
}

/// Returns all axes that are declared.
pub fn axes(context: &mut Context) -> Vec<AxisDraft> {
    let document = context.document;
    document.axes.iter().filter_map(|(name, entry)| axis(context, name, entry.as_ref())).collect()
}

fn axis(context: &mut Context, name: &str, entry: Option<&AxisEntry>) -> Option<AxisDraft> {
    let at = keys(["axes", name]);
    let Some(name) = AxisName::new(name) else {
        let help = "a name is a capital letter, then up to seven capitals or digits: X, C1, J6";
        context.at_key(codes::E0306, &at, format!("`{}` is not the name of an axis", shown(name)), help);
        return None;
    };
    let none = SideDraft::default;
    let (plain, on_tool, on_workpiece) = (none(), none(), none());
    let (side, travel) = (Branch::Workpiece, None);
    let unknown = AxisDraft {
        name: name.clone(),
        kind: None,
        sense: None,
        controller: ControllerAxis::default(),
        home: None,
        beyond: None,
        plain,
        on_tool,
        on_workpiece,
        side,
        travel,
    };
    let Some(entry) = entry else { return Some(unknown) };
    let kind = kind(context, &name, entry, &at);
    let travel = kind.and_then(|kind| plain_travel(context, &name, kind, entry, &at));
    let sense = match &entry.sense {
        Some(word) => context.choice::<Sense>(word, &below(&at, "sense"), &["iso841", "direct"]),
        None => None,
    };
    let origin = entry.origin.as_ref().and_then(|written| position(context, written, &below(&at, "origin")));
    let direction = plain_direction(context, &name, entry, &at);
    let plain = SideDraft { direction, origin, travel };
    let [on_tool, on_workpiece] = [Branch::Tool, Branch::Workpiece].map(|branch| {
        let side = block_entry(entry, branch).zip(kind);
        side.map(|(side, kind)| block(context, &name, kind, side, &below(&at, block_key(branch)))).unwrap_or_default()
    });
    let controller = controller(context, &name, entry, &at);
    let home = kind.zip(entry.home.as_ref()).and_then(|(kind, written)| home(context, kind, written, travel, &at));
    let beyond = context.beyond(entry.beyond.as_ref(), &at);
    Some(AxisDraft { kind, sense, controller, home, beyond, plain, on_tool, on_workpiece, ..unknown })
}

/// Returns the position at which an axis is homed; one beyond the travel is refused.
fn home(context: &mut Context, kind: AxisKind, written: &Scalar, travel: Option<Travel>, at: &Keys) -> Option<f64> {
    let here = below(at, "home");
    let home = context.position(written, kind, &here)?;
    let Some(Travel::Range(min, max)) = travel.filter(|travel| !travel.contains(home)) else { return Some(home) };
    let unit = kind.unit();
    let message = format!("`{}` is {home} {unit}, beyond the travel from {min} to {max} {unit}", dotted_path(&here));
    let help = "write the position that the control shows after homing";
    context.at_value(codes::E0403, &here, message, help);
    None
}

/// Returns the letter and the number that an entry gives the axis in the controller.
fn controller(context: &mut Context, name: &AxisName, entry: &AxisEntry, at: &Keys) -> ControllerAxis {
    let words = match &entry.controller {
        Some(ControllerEntry::One(word)) => std::slice::from_ref(word),
        Some(ControllerEntry::Both(words)) => words,
        None => &[],
    };
    let read = |all: ControllerAxis, word: &Scalar| all.and(ControllerAxis::parse(&word.to_string())?);
    words.iter().try_fold(ControllerAxis::default(), read).unwrap_or_else(|| {
        let words: Vec<String> = words.iter().map(Scalar::to_string).collect();
        let message = format!("`{}` is not what a controller calls axis `{name}`", shown(&words.join(", ")));
        let help = format!("write {}, or both: [A, 6]", ControllerAxis::EXPECTED);
        context.at_value(codes::E0712, &below(at, "controller"), message, help);
        ControllerAxis::default()
    })
}

/// Geometry that the block of a side gives.
fn block(context: &mut Context, name: &AxisName, kind: AxisKind, side: &SideEntry, at: &Keys) -> SideDraft {
    let written = side.direction.as_ref();
    SideDraft {
        direction: written.and_then(|list| direction(context, &of_axis(name), list, &below(at, "direction"))),
        origin: side.origin.as_ref().and_then(|written| position(context, written, &below(at, "origin"))),
        travel: side.travel.as_ref().and_then(|entry| travel(context, name, kind, entry, &below(at, "travel"))),
    }
}

/// Returns the meaning of a letter (with digits after it): X, Y, Z, U, V, W, P, Q, R are linear, A, B, C rotary.
fn by_letter(name: &AxisName) -> Option<(AxisKind, [f64; 3])> {
    let mut chars = name.as_str().chars();
    let letter = chars.next()?;
    if !chars.all(|c| c.is_ascii_digit()) {
        return None;
    }
    let unit = |i: usize| std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
    let linear = ["XUP", "YVQ", "ZWR"].iter().position(|group| group.contains(letter));
    let rotary = ['A', 'B', 'C'].iter().position(|l| *l == letter);
    linear.map(|i| (AxisKind::Linear, unit(i))).or(rotary.map(|i| (AxisKind::Rotary, unit(i))))
}

fn kind(context: &mut Context, name: &AxisName, entry: &AxisEntry, at: &Keys) -> Option<AxisKind> {
    if let Some(word) = &entry.kind {
        let here = below(at, "kind");
        return match word.as_str() {
            "linear" => Some(AxisKind::Linear),
            "rotary" => Some(AxisKind::Rotary),
            _ => {
                let help = did_you_mean(word, &["linear", "rotary"]);
                context.at_value(codes::E0210, &here, format!("`{}` is not a kind of axis", shown(word)), help);
                None
            }
        };
    }
    let kind = by_letter(name).map(|d| d.0);
    if kind.is_none() && !context.document.places.is_marred(&below(at, "kind")) {
        let help = "add `kind: linear` or `kind: rotary`, and a `direction`";
        context.at_key(codes::E0401, at, format!("axis `{name}` has no default kind and direction"), help);
    }
    kind
}

fn in_a_block(entry: &AxisEntry, given: impl Fn(&SideEntry) -> bool) -> bool {
    [Branch::Tool, Branch::Workpiece].into_iter().filter_map(|branch| block_entry(entry, branch)).any(given)
}

/// Returns the plain direction, or that of the letter; a name without either needs one in a block.
fn plain_direction(context: &mut Context, name: &AxisName, entry: &AxisEntry, at: &Keys) -> Option<[f64; 3]> {
    let here = below(at, "direction");
    if let Some(list) = &entry.direction {
        return direction(context, &of_axis(name), list, &here);
    }
    let word = entry.kind.as_deref().unwrap_or("");
    let agrees = |kind: AxisKind| word.is_empty() || (kind == AxisKind::Linear) == (word == "linear");
    let default = by_letter(name).filter(|(kind, _)| agrees(*kind)).map(|d| d.1);
    let elsewhere = in_a_block(entry, |side| side.direction.is_some()) || context.document.places.is_marred(&here);
    if default.is_none() && entry.kind.is_some() && !elsewhere {
        let help = "add its unit vector in machine coordinates, such as `direction: [0, 0, 1]`";
        context.at_key(codes::E0401, at, format!("axis `{name}` has no `direction`"), help);
    }
    default
}

fn of_axis(name: &AxisName) -> String {
    format!("axis `{name}`")
}

/// Three plain numbers as a unit vector.
pub fn direction(context: &mut Context, of: &str, list: &[Scalar], here: &Keys) -> Option<[f64; 3]> {
    let numbers: Vec<f64> =
        list.iter().filter_map(|s| if let Scalar::Number(n) = s { Some(*n) } else { None }).collect();
    let help = "write three plain numbers, not all zero: [0, 1, 1] is 45 deg between Y and Z";
    if list.len() != 3 || numbers.len() != 3 || !numbers.iter().all(|n| n.is_finite()) {
        let message = format!("the direction of {of} is not three plain numbers");
        context.at_value(codes::E0402, here, message, help);
        return None;
    }
    let largest = numbers.iter().fold(0.0_f64, |m, n| m.max(n.abs()));
    if largest == 0.0 {
        context.at_value(codes::E0402, here, format!("the direction of {of} is zero"), help);
        return None;
    }
    // Scaled first: squares of 1e200 overflow, of 1e-200 vanish.
    let scaled = [numbers[0] / largest, numbers[1] / largest, numbers[2] / largest];
    let norm = scaled.iter().map(|n| n * n).sum::<f64>().sqrt();
    Some(scaled.map(|n| n / norm))
}

fn plain_travel(
    context: &mut Context,
    name: &AxisName,
    kind: AxisKind,
    entry: &AxisEntry,
    at: &Keys,
) -> Option<Travel> {
    if let Some(written) = &entry.travel {
        return travel(context, name, kind, written, &below(at, "travel"));
    }
    if !context.document.places.is_marred(at) && !in_a_block(entry, |side| side.travel.is_some()) {
        let help = match kind {
            AxisKind::Linear => "add `travel: [0 mm, 500 mm]`",
            AxisKind::Rotary => "add `travel: [-120 deg, 30 deg]` or `travel: continuous`",
        };
        context.at_key(codes::E0203, at, format!("axis `{name}` has no `travel`"), help);
    }
    None
}

fn travel(context: &mut Context, name: &AxisName, kind: AxisKind, entry: &TravelEntry, here: &Keys) -> Option<Travel> {
    match entry {
        TravelEntry::Word(word) if word == "continuous" && kind == AxisKind::Rotary => Some(Travel::Continuous),
        TravelEntry::Word(word) => {
            let one_number = word.starts_with(|c: char| c.is_ascii_digit() || "+-.±".contains(c));
            let help = match kind {
                AxisKind::Linear if word == "continuous" => "a linear axis has two ends: [0 mm, 500 mm]",
                AxisKind::Rotary if one_number => {
                    "write `continuous` for an axis that turns without end, or both ends: [-120 deg, 30 deg]"
                }
                AxisKind::Linear if one_number => "write both ends: [0 mm, 500 mm]",
                _ => "write [min, max] or continuous",
            };
            let message = format!("`{}` is not a travel of axis `{name}`", shown(word));
            context.at_value(codes::E0403, here, message, help);
            None
        }
        TravelEntry::Range(list) => {
            let (min, max) = context.interval(list, kind, here)?;
            if max - min < SHORTEST {
                let unit = kind.unit();
                let length = max - min;
                let message =
                    format!("`{}` is {length:e} {unit} long, less than a step of any control", dotted_path(here));
                context.at_value(codes::E0403, here, message, format!("a travel has {SHORTEST} {unit} at least"));
                return None;
            }
            Some(Travel::Range(min, max))
        }
    }
}

impl Context<'_> {
    /// `[min, max]`, rising.
    pub fn interval(&mut self, list: &[Scalar], kind: AxisKind, at: &Keys) -> Option<(f64, f64)> {
        let unit = kind.unit();
        let [min, max] = list else {
            let message = format!("`{}` has {} numbers, an interval has two", dotted_path(at), list.len());
            let help = slip_in_list(list).unwrap_or_else(|| format!("write [min, max] in {unit}"));
            self.at_value(codes::E0403, at, message, help);
            return None;
        };
        let (min, max) = (self.position(min, kind, &below(at, 0)), self.position(max, kind, &below(at, 1)));
        let (min, max) = (min?, max?);
        if min >= max {
            let (what, help) = if min == max {
                ("is empty", format!("write [min, max] with max above min, in {unit}"))
            } else {
                ("runs backwards", format!("write the smaller end first: [{max} {unit}, {min} {unit}]"))
            };
            let message = format!("`{}` {what}: from {min} {unit} to {max} {unit}", dotted_path(at));
            self.at_value(codes::E0403, at, message, help);
            return None;
        }
        Some((min, max))
    }

    /// Reads the key `beyond` of the entry at `at`.
    pub fn beyond(&mut self, word: Option<&String>, at: &Keys) -> Option<Beyond> {
        self.choice(word?, &below(at, "beyond"), &Beyond::WORDS)
    }

    /// Returns a word that stands for a choice.
    pub fn choice<T: serde::de::DeserializeOwned>(&mut self, word: &str, at: &Keys, words: &[&str]) -> Option<T> {
        let name = at.last().map_or("", String::as_str);
        let value = words.contains(&word).then(|| T::deserialize(serde_yaml::Value::from(word)).ok()).flatten();
        if value.is_none() {
            let help = did_you_mean(word, words);
            self.at_value(codes::E0210, at, format!("`{}` is not a choice for `{name}`", shown(word)), help);
        }
        value
    }
}
