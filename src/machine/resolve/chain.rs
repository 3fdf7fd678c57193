//! The chain: a walk `w C' A' Y' b X Z (S) t` or two lists of branches.

use super::context::Context;
use crate::diagnostic::{Diagnostic, Place, codes, did_you_mean, shown};
use crate::machine::{Axis, AxisKind, AxisName, Branch, KinematicChain, Machine, RepeatedJoints};
use crate::syntax::{Keys, WrittenChain, below, keys};
use std::collections::BTreeSet;

/// Maximum number of axes in the chain.
const MAX_AXES: usize = 16;

/// One less the cosine of the angle below which two directions are one: half a millirad.
const PARALLEL: f64 = 1e-7;

/// An axis or the spindle in the chain and where it stands there.
struct ChainLink {
    name: AxisName,
    branch: Branch,
    place: Option<Place>,
}

/// The chain as written; the axes of both branches from the bed outwards.
#[derive(Default)]
struct ChainLinks {
    axes: Vec<ChainLink>,
    spindle: Option<ChainLink>,
}

impl ChainLinks {
    fn graph(&self) -> Result<KinematicChain, RepeatedJoints> {
        let branch = |side| self.axes.iter().filter(|l| l.branch == side).map(|l| l.name.clone()).collect::<Vec<_>>();
        let spindle = self.spindle.as_ref().map(|spindle| &spindle.name);
        KinematicChain::new(&branch(Branch::Workpiece), &branch(Branch::Tool), spindle)
    }
}

/// A word of the chain and where it stands.
struct ChainWord {
    text: String,
    place: Option<Place>,
}

/// Returns the chain of the machine; every name in it is an axis that the file declares.
pub fn chain(context: &mut Context) -> Option<KinematicChain> {
    let document = context.document;
    let links = match (&document.chain, &document.branches) {
        (Some(_), Some(_)) => {
            let (chain, branches) = (keys(["chain"]), keys(["branches"]));
            let refusal = Diagnostic::new(codes::E0209, "`chain` and `branches` both define the chain");
            let places = (document.places.key(&chain), document.places.key(&branches));
            context.diagnostics.push(refusal.at(places.1, "").at(places.0, "also given here").help("keep one of them"));
            return None;
        }
        (Some(text), None) => walk(context, text)?,
        (None, Some(branches)) => from_lists(context, &branches.workpiece, &branches.tool)?,
        (None, None) => {
            if !document.places.is_marred(&keys(["chain"])) && !document.places.is_marred(&keys(["branches"])) {
                let help = "add the walk from workpiece to tool, such as `chain: \"w C' A' Y' b X Z t\"`";
                context.at_key(codes::E0203, &Keys::new(), "the machine has no `chain`", help);
            }
            return None;
        }
    };
    check(context, &links)
}

/// Axes declared, no joint on two paths, at least one.
fn check(context: &mut Context, links: &ChainLinks) -> Option<KinematicChain> {
    let before = context.diagnostics.count();
    if links.axes.len() > MAX_AXES {
        let message = format!("the chain has {} axes, at most {MAX_AXES} are computed", links.axes.len());
        let help = "each axis more doubles the poses of a proof, and multiplies tables; leave out what does not move \
                    tool or workpiece";
        let place = links.axes.get(MAX_AXES).and_then(|link| link.place.clone());
        context.diagnostics.push(Diagnostic::new(codes::E0307, message).at(place, "").help(help));
        return None;
    }
    let graph = links.graph();
    for name in graph.as_ref().err().iter().flat_map(|RepeatedJoints(names)| names) {
        let mut joints = links.axes.iter().chain(&links.spindle).filter(|link| link.name == *name);
        let first = joints.next().and_then(|link| link.place.clone());
        joints.for_each(|again| twice(context, name, &again.place, &first));
    }
    let declared: Vec<&str> = context.document.axes.keys().map(String::as_str).collect();
    let mut names = BTreeSet::new();
    for link in links.axes.iter().filter(|link| names.insert(&link.name)) {
        if !declared.contains(&link.name.as_str()) && !context.document.places.is_lost(&keys(["axes"])) {
            let near = did_you_mean(link.name.as_str(), &declared);
            let message = format!("axis `{}` of the chain is not declared under `axes`", link.name);
            let letters: Vec<String> = link.name.as_str().chars().map(String::from).collect();
            let glued = letters.len() > 1 && letters.iter().all(|letter| declared.contains(&letter.as_str()));
            let help = match glued {
                true => format!("write blanks between the names: `{}`", letters.join(" ")),
                false => format!("declare it, `{}: {{ travel: [...] }}`; {near}", link.name),
            };
            context.diagnostics.push(Diagnostic::new(codes::E0303, message).at(link.place.clone(), "").help(help));
        }
    }
    let in_chain = |name: &AxisName| links.axes.iter().any(|link| link.name == *name);
    if let Some(ChainLink { name, place, .. }) = links.spindle.as_ref().filter(|spindle| !in_chain(&spindle.name))
        && declared.contains(&name.as_str())
    {
        let declared = context.document.places.key(&keys(["axes", name.as_str()]));
        twice(context, name, place, &declared);
    }
    if links.axes.is_empty() && !context.document.places.is_marred(&keys(["branches"])) {
        context.at_value(
            codes::E0302,
            &keys(["chain"]),
            "the chain has no axis",
            "name at least one axis between w and t",
        );
    }
    graph.ok().filter(|_| context.diagnostics.count() == before && !links.axes.is_empty())
}

/// Letters of axes that are parallel by ISO 841.
const FAMILIES: [&str; 3] = ["XUP", "YVQ", "ZWR"];

/// Warns of two linear axes along one line, but for those whose letters say so: W0406.
pub fn warn_parallel(context: &mut Context, machine: &Machine) {
    let linear: Vec<&Axis> = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear).collect();
    for (i, axis) in linear.iter().enumerate() {
        let across = |other: &Axis| {
            let dot: f64 = axis.direction.iter().zip(other.direction).map(|(a, b)| a * b).sum();
            1.0 - dot.abs()
        };
        let Some(other) = linear[..i].iter().find(|other| across(other) < PARALLEL) else { continue };
        let [first, second] = [other, axis].map(|axis| axis.name.as_str().chars().next());
        let in_family = |letter: Option<char>, family: &str| letter.is_some_and(|letter| family.contains(letter));
        if first != second && FAMILIES.iter().any(|family| in_family(first, family) && in_family(second, family)) {
            continue;
        }
        let message = format!("`{}` and `{}` move along one line", other.name, axis.name);
        let help = "right for a quill or a second slide, whose errors then act alike and are told apart by moving one \
                    at a time only; else correct `direction`";
        context.at_key(codes::W0406, &keys(["axes", axis.name.as_str()]), message, help);
    }
}

/// Linear axes from which on a chain looks like a hexapod.
const HEXAPOD: usize = 6;

/// Warns of six linear axes one upon the other: the legs of a hexapod stand side by side, which no chain says.
pub fn warn_many_linear(context: &mut Context, machine: &Machine) {
    let linear = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear).count();
    if linear >= HEXAPOD {
        let written = if context.document.chain.is_some() { "chain" } else { "branches" };
        let message = format!("the chain has {linear} linear axes, each carrying the next");
        let help = "parallel kinematics (hexapods, deltas, scissor tables) are not modelled: their legs act side by \
                    side, and every result would be of another machine";
        context.at_value(codes::W0410, &keys([written]), message, help);
    }
}

fn twice(context: &mut Context, name: &AxisName, again: &Option<Place>, first: &Option<Place>) {
    let refusal = Diagnostic::new(codes::E0304, format!("axis `{name}` occurs twice"))
        .at(again.clone(), "again here")
        .at(first.clone(), "first here")
        .help("an axis stands in the chain once; a second one needs a name of its own, such as `Y2`");
    context.diagnostics.push(refusal);
}

fn from_lists(context: &mut Context, workpiece: &[String], tool: &[String]) -> Option<ChainLinks> {
    let before = context.diagnostics.count();
    let mut links = ChainLinks::default();
    for (branch, key, list) in [(Branch::Workpiece, "workpiece", workpiece), (Branch::Tool, "tool", tool)] {
        for (i, text) in list.iter().enumerate() {
            let at = below(&keys(["branches", key]), i);
            let token = ChainWord { text: text.trim().to_owned(), place: context.document.places.value(&at) };
            let last = branch == Branch::Tool && i + 1 == list.len();
            link(context, &token, Some(branch), last, &mut links);
        }
    }
    (context.diagnostics.count() == before).then_some(links)
}

/// One axis or spindle. `side` is the branch it stands in, if that is settled.
fn link(context: &mut Context, token: &ChainWord, side: Option<Branch>, may_be_spindle: bool, links: &mut ChainLinks) {
    let inner = token.text.strip_prefix('(').and_then(|t| t.strip_suffix(')'));
    let bare = inner.unwrap_or(&token.text);
    let unprimed = bare.trim_end_matches(['\'', '’', '′']);
    let Some(name) = AxisName::new(unprimed) else {
        return refuse_name(context, token);
    };
    if inner.is_some() {
        if !may_be_spindle || links.spindle.is_some() || unprimed != bare {
            let message = format!("the spindle `{}` is not the last before the tool", token.text);
            let help = "write the spindle once, directly before `t`: `... Z (S) t`";
            context.diagnostics.push(Diagnostic::new(codes::E0301, message).at(token.place.clone(), "").help(help));
            return;
        }
        links.spindle = Some(ChainLink { name, branch: Branch::Tool, place: token.place.clone() });
        return;
    }
    let primed = unprimed != bare;
    let branch = side.unwrap_or(if primed { Branch::Workpiece } else { Branch::Tool });
    if primed && branch == Branch::Tool {
        let message = format!("primed axis `{}` stands on the tool side of the bed", token.text);
        let help =
            format!("write `{name}`, or move it between `w` and `b`: a prime marks axes that carry the workpiece");
        context.diagnostics.push(Diagnostic::new(codes::E0305, message).at(token.place.clone(), "").help(help));
        return;
    }
    links.axes.push(ChainLink { name, branch, place: token.place.clone() });
}

fn refuse_name(context: &mut Context, token: &ChainWord) {
    let message = format!("`{}` is not the name of an axis", shown(&token.text));
    let in_front = token.text.strip_prefix(['\'', '’', '′']).filter(|name| AxisName::new(name).is_some());
    let help = match apart(&token.text) {
        _ if in_front.is_some() => format!("the prime stands behind the name: `{}'`", in_front.unwrap_or_default()),
        Some(names) => format!("write blanks between the names: `{names}`"),
        None => "a name is a capital letter, then up to seven capitals or digits: X, C1, J6".to_owned(),
    };
    context.diagnostics.push(Diagnostic::new(codes::E0301, message).at(token.place.clone(), "").help(help));
}

/// Returns the names of a word that were written without blanks, with blanks; `None` if it is no such word.
fn apart(word: &str) -> Option<String> {
    let mut spaced = String::new();
    for c in word.chars().filter(|c| !c.is_whitespace()) {
        let begins = c.is_ascii_uppercase() && !spaced.ends_with('(') || matches!(c, 'w' | 'b' | 't' | '(');
        if !begins && !c.is_ascii_uppercase() && !c.is_ascii_digit() && !matches!(c, '\'' | '’' | '′' | ')') {
            return None;
        }
        spaced.extend(begins.then_some(' ').into_iter().chain([c]));
    }
    let names = spaced.trim_start();
    names.contains(' ').then(|| names.to_owned())
}

/// Returns the string as ISO prints it.
fn walk(context: &mut Context, text: &str) -> Option<ChainLinks> {
    let before = context.diagnostics.count();
    let tokens = tokens(context, text);
    let find = |word: &str| tokens.iter().position(|t| t.text == word);
    let (w, b, t) = (find("w"), find("b"), find("t"));
    let complete = |names: &String| names.starts_with("w ") && names.contains(" b ") && names.ends_with(" t");
    if let Some(names) = apart(text).filter(|names| [w, b, t].contains(&None) && complete(names)) {
        let help = format!("write blanks between the names: `{names}`");
        context.at_value(codes::E0302, &keys(["chain"]), "the names of the chain are not apart", help);
        return None;
    }
    if [w, b, t].contains(&None) && text.contains(['\u{201c}', '\u{201d}', '\u{201e}']) {
        let help = "take the plain quotes of the keyboard, \"w C' A' Y' b X Z t\": an editor made others of them";
        context.at_value(codes::E0302, &keys(["chain"]), "the chain stands in typographic quotes", help);
        return None;
    }
    for (found, word, what) in [(w, "w", "workpiece"), (b, "b", "bed"), (t, "t", "tool")] {
        if found.is_none() {
            let help = "a chain is a walk from workpiece to tool over the bed: `w C' A' Y' b X Z t`";
            context.at_value(codes::E0302, &keys(["chain"]), format!("the chain has no `{word}` ({what})"), help);
        }
    }
    let (w, b, t) = (w?, b?, t?);
    if w != 0 || t + 1 != tokens.len() || b < w || b > t {
        let help = "start with `w`, end with `t`, with `b` in between: `w C' A' Y' b X Z t`";
        context.at_value(codes::E0302, &keys(["chain"]), "the chain does not run from `w` over `b` to `t`", help);
        return None;
    }
    let mut links = ChainLinks::default();
    for token in tokens[w + 1..b].iter().rev() {
        left_of_bed(context, token, &mut links);
    }
    for (i, token) in tokens[b + 1..t].iter().enumerate() {
        link(context, token, Some(Branch::Tool), b + 2 + i == t, &mut links);
    }
    (context.diagnostics.count() == before).then_some(links)
}

fn left_of_bed(context: &mut Context, token: &ChainWord, links: &mut ChainLinks) {
    let primed = token.text.ends_with(['\'', '’', '′']);
    if !primed && AxisName::new(&token.text).is_some() {
        let message = format!("axis `{}` stands on the workpiece side of the bed without a prime", token.text);
        let help = format!("write `{}'`, or move it between `b` and `t`", token.text);
        context.diagnostics.push(Diagnostic::new(codes::E0305, message).at(token.place.clone(), "").help(help));
        return;
    }
    link(context, token, Some(Branch::Workpiece), false, links);
}

/// Words between spaces, dashes and the outer brackets; a letter before the bracket (V, H) says how
/// the spindle stands and is not part of the walk.
fn tokens(context: &Context, text: &str) -> Vec<ChainWord> {
    let body = match text.find('[') {
        Some(open) if matches!(text[..open].trim(), "" | "V" | "H") => open + 1..text.rfind(']').unwrap_or(text.len()),
        _ => 0..text.len(),
    };
    let whole = inside(context, &keys(["chain"]), text, 0, text.len());
    // Once for all words: there may be many.
    let written =
        |place: &&Place| context.diagnostics.sources.text(place.source).get(place.range.clone()) == Some(text);
    let as_written = whole.as_ref().filter(written);
    let mut tokens = Vec::new();
    let mut start = body.start;
    let separates = |c: char| c.is_whitespace() || matches!(c, '-' | '–' | ',');
    for piece in text[body].split_inclusive(separates) {
        let word = piece.trim_end_matches(separates);
        if !word.is_empty() {
            let part = |place: &Place| {
                let start = place.range.start + start;
                Place { source: place.source, range: start..start + word.len() }
            };
            let place = as_written.map(part).or_else(|| whole.clone());
            tokens.push(ChainWord { text: word.to_owned(), place });
        }
        start += piece.len();
    }
    tokens
}

/// Returns the side on which a chain as some file writes it has an axis; nothing is reported.
pub fn side_in(chain: &WrittenChain, axis: &str) -> Option<Branch> {
    let bare = |word: &str| word.trim().trim_end_matches(['\'', '’', '′']) == axis;
    match chain {
        WrittenChain::Walk(text) => {
            let separates = |c: char| c.is_whitespace() || matches!(c, '-' | '–' | ',' | '[' | ']');
            let words: Vec<&str> = text.split(separates).filter(|word| !word.is_empty()).collect();
            let bed = words.iter().position(|word| *word == "b")?;
            let place = words.iter().position(|word| bare(word))?;
            Some(if place < bed { Branch::Workpiece } else { Branch::Tool })
        }
        WrittenChain::Branches(lists) => {
            let on = |list: &[String]| list.iter().any(|word| bare(word));
            let tool = || on(&lists.tool).then_some(Branch::Tool);
            on(&lists.workpiece).then_some(Branch::Workpiece).or_else(tool)
        }
    }
}

/// Returns the place of a piece of a text value, if the value stands in the file as it is.
pub fn inside(context: &Context, at: &Keys, value: &str, start: usize, length: usize) -> Option<Place> {
    let whole = context.document.places.value(at)?;
    let written = context.diagnostics.sources.text(whole.source).get(whole.range.clone())?;
    match written.find(value) {
        Some(offset) => {
            let start = whole.range.start + offset + start;
            Some(Place { source: whole.source, range: start..start + length })
        }
        None => Some(whole),
    }
}
