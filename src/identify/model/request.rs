//! The request of a fit in words: groups (`location`, `tool`, `tools`, `workpiece`, `linear` ...), error names,
//! component errors with a basis (`EXX:poly3`, `ECC:fourier2`, `EYX:spline8`, `EYX:bspline8`, `EBY:blocks4`), each
//! direction of approach for itself if wanted (`EXX+-:poly3`), and parameters of one's own.

use super::curves::{self, MAX_POWER};
use super::parameter::{BasisFunction, Clamping, Parameter, ParameterTerm, SlopeBound, source};
use super::refusal::{Refusal, refusal};
use crate::algebra::linear::Svd;
use crate::analysis::LocationSet;
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::identify::data::{ToolUse, split_direction};
use crate::identify::lists::index_of;
use crate::identify::thresholds::DESIGN_RANK_TOLERANCE;
use crate::lower::{ErrorSite, Source};
use crate::machine::{
    Approach, AxisKind, ComponentError, Curve, Direction, ErrorFamily, ErrorId, ErrorTerm, FITTED_GROUPS, Machine,
    basis_of_term, error_name_in_capitals, parse_error_name,
};
use crate::syntax::{IdentifyEntry, Scalar};
use indexmap::{IndexMap, IndexSet};
use nalgebra::{DMatrix, DVector};

/// The smallest complete set of location errors of the chain.
pub const NEEDED: &str = "needed";
/// Every tool by itself.
const TOOLS: &str = "tools";
/// Every tool by itself in each run.
const TOOLS_BY_RUN: &str = "tools-by-run";
/// Group of the displacements and rotations of the workpiece in every run.
const WORKPIECE_BY_RUN: &str = "workpiece-by-run";

/// Returns the parameters of a request for a machine with all its tools, in its order, each once.
pub fn parameters(machine: &Machine, request: &IdentifyEntry) -> Result<Vec<Parameter>, Refusal> {
    let uses: Vec<ToolUse> = (0..machine.tools().len()).map(|tool| ToolUse { tool, run: None }).collect();
    parameters_for(machine, request, &uses)
}

/// Returns the same for readings with these tools in these runs.
pub fn parameters_for(machine: &Machine, request: &IdentifyEntry, uses: &[ToolUse]) -> Result<Vec<Parameter>, Refusal> {
    let mut list: Vec<Parameter> = Vec::new();
    // A faulty parameter of one's own is refused whether it is fitted or not.
    for (name, errors) in &request.parameters {
        own_parameter(machine, name, errors)?;
    }
    for word in &request.fit {
        for mut parameter in parameters_of_word(machine, word.trim(), request, uses)? {
            if word.trim() == "linear" {
                free_straightness(machine, request, &mut parameter);
            }
            add_unique(&mut list, parameter)?;
        }
    }
    for word in &request.fixed {
        let fixed = fixed_names(machine, word.trim(), &list, uses)?;
        list.retain(|parameter| !fixed.contains(&parameter.name));
    }
    for (follower, leaders) in &request.tied {
        tie(machine, follower, leaders, &mut list)?;
    }
    start_from_file(machine, &mut list);
    if list.is_empty() {
        let help =
            "name errors or groups: `--fit location,tool`, or `identify: { fit: [location] }` in the machine file";
        return Err(Box::new(Diagnostic::new(codes::E0502, "there is nothing to fit").help(help)));
    }
    Ok(list)
}

/// Takes those errors out of a slope of `linear` that follow it and have a curve of their own.
fn free_straightness(machine: &Machine, request: &IdentifyEntry, slope: &mut Parameter) {
    let own = request.fit.iter().filter_map(|word| split_form(word.trim()));
    let own: Vec<Source> = own.map(|(error, _)| source(machine, &error)).collect();
    let main = slope.terms.first().map(|term| term.source);
    slope.terms.retain(|term| Some(term.source) == main || !own.contains(&term.source));
}

/// Starts slopes of `linear` and parameters of one's own at the curves of the file, if these are such sums.
fn start_from_file(machine: &Machine, list: &mut [Parameter]) {
    let joint: Vec<usize> =
        (0..list.len()).filter(|j| [SLOPE, OWN].contains(&curve_form(&list[*j]).as_str())).collect();
    if joint.is_empty() {
        return;
    }
    let mut powers: Vec<(Source, u8)> = Vec::new();
    let power = |t: &ParameterTerm| if let BasisFunction::Power(k) = t.basis { (t.source, k) } else { (t.source, 0) };
    for term in joint.iter().flat_map(|j| &list[*j].terms) {
        let _ = index_of(&mut powers, power(term));
    }
    let factor =
        |j: usize, key: (Source, u8)| list[j].terms.iter().filter(|t| power(t) == key).map(|t| t.factor).sum::<f64>();
    let sums = DMatrix::from_fn(powers.len(), joint.len(), |i, j| factor(joint[j], powers[i]));
    let given = DVector::from_iterator(
        powers.len(),
        powers.iter().map(|(source, power)| coefficient(machine, *source, *power)),
    );
    let svd = Svd::new(&sums);
    let starts = svd.solve(&given, svd.rank(DESIGN_RANK_TOLERANCE));
    // Each power against its own size: they differ by the reach of the axis.
    let off = &sums * &starts - &given;
    if off.iter().zip(given.iter()).all(|(off, given)| off.abs() <= 1e-6 * given.abs()) {
        joint.into_iter().zip(starts.iter()).for_each(|(j, start)| list[j].start = *start);
    }
}

/// Returns a coefficient of the polynomial that the file has for an error in both directions; 0 without one.
fn coefficient(machine: &Machine, source: Source, power: u8) -> f64 {
    let given = machine.errors().find(|(id, _)| self::source(machine, id) == source).map(|(_, term)| term);
    match given {
        Some(ErrorTerm::Component(ComponentError::Single(Curve::Polynomial(list)))) => {
            list.get(usize::from(power)).copied().unwrap_or(0.0)
        }
        _ => 0.0,
    }
}

/// Splits a word of `fit` into error and form: `EXX+-:poly3`.
fn split_form(word: &str) -> Option<(ErrorId, &str)> {
    let (name, form) = word.split_once(':')?;
    let name = name.trim();
    let bare = name.strip_suffix("+-").map_or_else(|| split_direction(name).0, str::trim);
    Some((parse_error_name(bare)?, form.trim()))
}

/// Replaces the list and the forms of a request by those of the command line. Ties and bounds of errors that are then
/// not fitted are left out.
pub fn with_command_line(
    machine: &Machine,
    mut request: IdentifyEntry,
    fit: &[String],
    fixed: &[String],
) -> IdentifyEntry {
    request.fixed.extend(fixed.iter().cloned());
    if fit.is_empty() && fixed.is_empty() {
        return request;
    }
    if !fit.is_empty() {
        replace_fit(&mut request, fit);
    }
    let mut alone = IdentifyEntry { tied: IndexMap::new(), slopes: IndexMap::new(), ..request.clone() };
    // Tools of single runs, which the readings know, follow no error.
    let _ = [&mut alone.fit, &mut alone.fixed].map(|list| list.retain(|word| !word.trim().starts_with("tool ")));
    let Ok(list) = parameters(machine, &alone) else { return request };
    let fitted = |key: &String| {
        let source = parse_error_name(key).map(|error| source(machine, &error));
        list.iter().flat_map(|p| &p.terms).any(|t| Some(t.source) == source)
    };
    let followed = |leaders: &IndexMap<String, Scalar>| leaders.keys().any(&fitted);
    let tied = |key: &String, tied: &IndexMap<String, IndexMap<String, Scalar>>| tied.get(key).is_some_and(followed);
    let known = request.tied.clone();
    request.tied.retain(|key, _| tied(key, &known));
    request.slopes.retain(|key, _| fitted(key) || tied(key, &known));
    request
}

/// Replaces the list of a request and the forms of its errors.
fn replace_fit(request: &mut IdentifyEntry, fit: &[String]) {
    request.fit = fit.to_vec();
    for (error, form) in fit.iter().filter_map(|word| split_form(word.trim())) {
        let other = |key: &String| parse_error_name(key).as_ref() != Some(&error);
        request.basis.retain(|key, _| other(key));
        if form.contains(|c: char| c.is_ascii_digit()) {
            request.knots.retain(|key, _| other(key));
        }
    }
}

/// Returns the entries of a request without effect, whose curves or parameters are not fitted: `knots of EXX`.
pub fn unused_entries(machine: &Machine, request: &IdentifyEntry, list: &[Parameter]) -> Vec<String> {
    let fitted = |key: &String, knots: bool| {
        let Some(source) = parse_error_name(key).map(|error| source(machine, &error)) else { return false };
        let mut terms = list.iter().flat_map(|p| &p.terms);
        terms.any(|t| t.source == source && (!knots || t.basis.knots().is_some()))
    };
    let entry = |word: &str, key: &String| format!("{word} of {}", shown(key));
    let basis = request.basis.keys().filter(|key| !fitted(key, false)).map(|key| entry("basis", key));
    let knots = request.knots.keys().filter(|key| !fitted(key, true)).map(|key| entry("knots", key));
    let own = request.parameters.keys().filter(|name| !list.iter().any(|p| p.name == **name));
    basis.chain(knots).chain(own.map(|name| format!("parameter {}", shown(name)))).collect()
}

/// Returns the bounds on slopes of fitted curves.
pub fn slope_bounds(
    machine: &Machine,
    request: &IdentifyEntry,
    list: &[Parameter],
) -> Result<Vec<SlopeBound>, Refusal> {
    let one = |(word, bound): (&String, &Scalar)| {
        let error = error(machine, word)?;
        let source = source(machine, &error);
        let axis = machine.axis_index(error.axis.as_str()).filter(|_| !error.is_location()).map(|i| &machine.axes()[i]);
        let help = "write a slope such as `EXX: 20 um/m` or `ECC: 1 urad/deg` of a fitted curve";
        let Some(axis) = axis.filter(|_| list.iter().any(|p| p.terms.iter().any(|t| t.source == source))) else {
            return Err(refusal(format!("`{error}` is not a fitted curve: it has no slope to bound"), help));
        };
        let quantity = crate::units::quantity(&bound.to_string()).ok();
        let per_axis = if axis.kind == AxisKind::Linear { (1, 0) } else { (0, 1) };
        let value = if error.direction.is_rotation() { (0, 1) } else { (1, 0) };
        let wanted = (value.0 - per_axis.0, value.1 - per_axis.1);
        let slope = quantity.filter(|q| (q.dimension.length, q.dimension.angle) == wanted && q.value > 0.0);
        let Some(slope) = slope else {
            return Err(refusal(format!("`{bound}` is not a slope of `{error}`"), help));
        };
        // Positions of rotary axes are in degrees.
        let per = if axis.kind == AxisKind::Linear { 1.0 } else { std::f64::consts::PI / 180.0 };
        Ok(SlopeBound { source, interval: axis.travel.interval(), slope: slope.value * per })
    };
    request.slopes.iter().map(one).collect()
}

/// Adds a parameter unless it is there; refuses two forms of curve for the same error.
fn add_unique(list: &mut Vec<Parameter>, parameter: Parameter) -> Result<(), Refusal> {
    if list.iter().any(|known| known.name == parameter.name) {
        return Ok(());
    }
    let meet = |a: Approach, b: Approach| a == b || a == Approach::Mean || b == Approach::Mean;
    let clash = |known: &&Parameter| {
        let unlike = curve_form(known) != curve_form(&parameter);
        let at_odds = |a: &ParameterTerm, b: &ParameterTerm| {
            let run = |t: &ParameterTerm| t.only.as_ref().map(|of| of.run.is_some());
            let unlike = unlike || a.basis.knots() != b.basis.knots() || a.approach != b.approach || run(a) != run(b);
            a.source == b.source && meet(a.approach, b.approach) && unlike
        };
        known.terms.iter().any(|a| parameter.terms.iter().any(|b| at_odds(a, b)))
    };
    if let Some(known) = list.iter().find(clash) {
        let message = format!("`{}` and `{}` fit the same error in two forms", known.name, parameter.name);
        return Err(refusal(message, "fit every error once, in one form"));
    }
    list.push(parameter);
    Ok(())
}

/// Ties an error to another: the parameters of that one move this one, too.
fn tie(
    machine: &Machine,
    follower: &str,
    leaders: &IndexMap<String, Scalar>,
    list: &mut [Parameter],
) -> Result<(), Refusal> {
    let help = "write one error and a factor: `tied: { EBY: { EBX: -1 } }` is EBY = -EBX; EBX is fitted, EBY is not";
    let own = error(machine, follower)?;
    let Some((leader, factor)) = leaders.first().filter(|_| leaders.len() == 1) else {
        return Err(refusal(format!("`{own}` follows {} errors", leaders.len()), help));
    };
    let factor = curves::plain(factor).ok_or_else(|| refusal(format!("`{factor}` is not a factor"), help))?;
    let leader = error(machine, leader)?;
    let (from, to) = (source(machine, &leader), source(machine, &own));
    if own.family != leader.family || own.direction.is_rotation() != leader.direction.is_rotation() {
        return Err(refusal(format!("`{own}` and `{leader}` are not of one kind: neither follows the other"), help));
    }
    if list.iter().any(|p| p.terms.iter().any(|t| t.source == to)) {
        return Err(refusal(format!("`{own}` follows `{leader}` and is fitted itself"), help));
    }
    let mut followed = false;
    for parameter in list {
        let copies: Vec<ParameterTerm> = parameter.terms.iter().filter(|t| t.source == from).cloned().collect();
        followed |= !copies.is_empty();
        parameter.terms.extend(copies.into_iter().map(|t| ParameterTerm {
            source: to,
            factor: t.factor * factor,
            ..t
        }));
    }
    if followed { Ok(()) } else { Err(refusal(format!("`{own}` follows `{leader}`, which is not fitted"), help)) }
}

/// Returns the form of curve to which a parameter belongs, in the words of a request.
fn curve_form(parameter: &Parameter) -> String {
    let has_power = || parameter.terms.iter().any(|t| matches!(t.basis, BasisFunction::Power(_)));
    match parameter.terms.first().map(|t| &t.basis) {
        _ if parameter.name.ends_with(":slope") => SLOPE.to_owned(),
        _ if !parameter.name.contains(':') && has_power() => OWN.to_owned(),
        Some(BasisFunction::Power(_)) => "poly".to_owned(),
        Some(BasisFunction::Cosine(_) | BasisFunction::Sine(_)) => "fourier".to_owned(),
        Some(BasisFunction::Spline(Curve::Linear(_))) => "blocks".to_owned(),
        Some(BasisFunction::Spline(Curve::BSpline(spline))) => format!("bspline/{}", spline.degree()),
        Some(BasisFunction::Spline(_)) => "spline".to_owned(),
        _ => "constant".to_owned(),
    }
}

/// Forms of slopes of `linear`, and of parameters of one's own.
const SLOPE: &str = "linear";
const OWN: &str = "own";

/// Returns the names of the parameters that a word of `fixed` removes.
fn fixed_names(machine: &Machine, word: &str, list: &[Parameter], uses: &[ToolUse]) -> Result<Vec<String>, Refusal> {
    let request = IdentifyEntry::default();
    refuse_unread(machine, word, uses)?;
    if FITTED_GROUPS.contains(&word) {
        return Ok(parameters_of_word(machine, word, &request, uses)?.into_iter().map(|p| p.name).collect());
    }
    if list.iter().any(|p| p.name == word) {
        return Ok(vec![word.to_owned()]);
    }
    // A known name that is not fitted removes nothing.
    if split_form(word).is_some() || named_parameter(machine, word, &request, uses).is_some() {
        return Ok(Vec::new());
    }
    let error = error(machine, word)?;
    let moves_error = |p: &&Parameter| p.terms.first().is_some_and(|t| t.source == source(machine, &error));
    Ok(list.iter().filter(moves_error).map(|p| p.name.clone()).collect())
}

fn parameters_of_word(
    machine: &Machine,
    word: &str,
    request: &IdentifyEntry,
    uses: &[ToolUse],
) -> Result<Vec<Parameter>, Refusal> {
    refuse_unread(machine, word, uses)?;
    match word {
        "location" => Ok(machine.axes().iter().enumerate().flat_map(|(i, _)| six(machine, i)).collect()),
        NEEDED => Ok(LocationSet::of(machine).members.iter().map(|(error, _)| location(machine, error)).collect()),
        "spindle" if machine.spindle_errors().is_none() => {
            Err(refusal("this chain has no spindle".to_owned(), "write `(S)` before `t` in the chain"))
        }
        "spindle" => Ok(six(machine, machine.axes().len()).collect()),
        "tool" => Ok(setup(machine, ErrorSite::Tool, "tool", &machine.setup().tool)),
        "workpiece" => Ok(setup(machine, ErrorSite::Workpiece, "workpiece", &machine.setup().workpiece)),
        WORKPIECE_BY_RUN => Ok(clamped_workpieces(machine, uses)),
        "linear" => Ok(linear(machine)),
        TOOLS | TOOLS_BY_RUN => Ok(clamped_tools(machine, uses, word == TOOLS_BY_RUN)),
        _ => match named_parameter(machine, word, request, uses) {
            Some(parameter) => Ok(vec![parameter]),
            None => parameters_of_error(machine, word, request),
        },
    }
}

/// Returns the one parameter that reports call so: `tool.X`, `tool long.X`, `EXX:slope`, `EXX:x^2`, `ECC:cos1`.
fn named_parameter(machine: &Machine, word: &str, request: &IdentifyEntry, uses: &[ToolUse]) -> Option<Parameter> {
    if is_of_clamping(word) {
        return each_clamping(machine, uses).find(|parameter| parameter.name == word);
    }
    let whole = match word.split_once(':') {
        Some((error, term)) => match basis_of_term(term)?.as_str() {
            "slope" => "linear".to_owned(),
            basis => format!("{error}:{basis}"),
        },
        None => word.split_once('.').map(|(set_up, _)| set_up).filter(|word| FITTED_GROUPS.contains(word))?.to_owned(),
    };
    parameters_of_word(machine, &whole, request, uses).ok()?.into_iter().find(|parameter| parameter.name == word)
}

fn six(machine: &Machine, joint: usize) -> impl Iterator<Item = Parameter> + '_ {
    let name = match machine.axes().get(joint) {
        Some(axis) => Some(&axis.name),
        None => machine.chain().spindle(),
    };
    name.into_iter().flat_map(move |axis| {
        let one = move |direction| {
            let error = ErrorId { axis: axis.clone(), family: ErrorFamily::Location, direction };
            location(machine, &error)
        };
        Direction::ALL.into_iter().map(one)
    })
}

fn location(machine: &Machine, error: &ErrorId) -> Parameter {
    let term = |id: &ErrorId| machine.errors().find(|(known, _)| known == id).map(|(_, term)| term.clone());
    let start = term(error).map_or(0.0, |term| term.value(&0.0.into()));
    Parameter::single(machine, error.to_string(), source(machine, error), BasisFunction::Constant, start)
}

fn setup(machine: &Machine, place: ErrorSite, word: &str, starts: &[f64]) -> Vec<Parameter> {
    let one = |(start, direction): (&f64, Direction)| {
        let source = Source { place, direction };
        Parameter::single(machine, format!("{word}.{}", direction.letter()), source, BasisFunction::Constant, *start)
    };
    starts.iter().zip(Direction::ALL).map(one).collect()
}

fn is_of_clamping(word: &str) -> bool {
    word.starts_with("tool ") || word.starts_with("workpiece ")
}

/// Returns the offsets of every tool in use, then those in each run, and those of the workpiece in each run.
fn each_clamping(machine: &Machine, uses: &[ToolUse]) -> impl Iterator<Item = Parameter> {
    let tools = [false, true].map(|by_run| clamped_tools(machine, uses, by_run));
    tools.into_iter().flatten().chain(clamped_workpieces(machine, uses))
}

/// Refuses a tool, or a run, of which there is no reading.
fn refuse_unread(machine: &Machine, word: &str, uses: &[ToolUse]) -> Result<(), Refusal> {
    if !is_of_clamping(word) {
        return Ok(());
    }
    let names: Vec<String> = each_clamping(machine, uses).map(|parameter| parameter.name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    if names.contains(&word) {
        return Ok(());
    }
    Err(refusal(format!("`{}` is of no reading", shown(word)), did_you_mean(word, &names)))
}

/// Returns the three offsets of the tip for every tool in use, of each of its runs if these are clampings of their own.
fn clamped_tools(machine: &Machine, uses: &[ToolUse], by_run: bool) -> Vec<Parameter> {
    let mut list: Vec<Parameter> = Vec::new();
    for ToolUse { tool, run } in uses {
        let only = Clamping { tool: Some(*tool), run: by_run.then(|| run.clone()) };
        if list.iter().any(|p| p.terms.iter().any(|term| term.only.as_ref() == Some(&only))) {
            continue;
        }
        let of_run = if by_run { of_run(run) } else { String::new() };
        // The only tool of a machine may be without a name.
        let label = Some(shown(&machine.tools()[*tool].name)).filter(|name| !name.is_empty());
        let label = label.unwrap_or_else(|| (tool + 1).to_string());
        let three = setup(machine, ErrorSite::Tool, &format!("tool {label}{of_run}"), &machine.setup().tool);
        list.extend(clamped(three, &only));
    }
    list
}

/// Returns the displacements and rotations of the workpiece in every run.
fn clamped_workpieces(machine: &Machine, uses: &[ToolUse]) -> Vec<Parameter> {
    let runs: IndexSet<&Option<String>> = uses.iter().map(|of| &of.run).collect();
    let six = |run: &Option<String>| {
        let name = format!("workpiece{}", of_run(run));
        let six = setup(machine, ErrorSite::Workpiece, &name, &machine.setup().workpiece);
        clamped(six, &Clamping { tool: None, run: Some(run.clone()) }).collect::<Vec<_>>()
    };
    runs.into_iter().flat_map(six).collect()
}

fn of_run(run: &Option<String>) -> String {
    run.iter().map(|run| format!(" run {}", shown(run))).collect()
}

fn clamped(list: Vec<Parameter>, only: &Clamping) -> impl Iterator<Item = Parameter> {
    list.into_iter().map(|mut parameter| {
        parameter.terms.iter_mut().for_each(|term| term.only = Some(only.clone()));
        parameter
    })
}

fn error(machine: &Machine, word: &str) -> Result<ErrorId, Refusal> {
    let Some(error) = parse_error_name(word) else {
        let message = format!("`{}` is neither an error nor a group", shown(word));
        let help = match error_name_in_capitals(word) {
            Some(near) => format!("did you mean `{near}`?"),
            None if word.trim().contains(' ') => "part them by commas: `EC0Y,EXX:poly3`".to_owned(),
            None => {
                format!("errors such as `EC0Y` or `EXX:poly3`, or a group; {}", did_you_mean(word, &FITTED_GROUPS))
            }
        };
        return Err(refusal(message, help));
    };
    let spindle = machine.chain().spindle().is_some_and(|name| *name == error.axis);
    if machine.axis_index(error.axis.as_str()).is_none() && !(spindle && error.is_location()) {
        let message = format!("`{error}`: the chain has no axis `{}`", error.axis);
        let known: Vec<&str> = machine.axes().iter().map(|axis| axis.name.as_str()).collect();
        return Err(refusal(message, format!("its axes are {}", known.join(", "))));
    }
    Ok(error)
}

/// Returns the parameters of one error, with the basis behind its name, in `identify.basis`, or usual for the axis; or
/// a parameter of one's own.
fn parameters_of_error(machine: &Machine, word: &str, request: &IdentifyEntry) -> Result<Vec<Parameter>, Refusal> {
    if let Some(errors) = request.parameters.get(word) {
        return Ok(vec![own_parameter(machine, word, errors)?]);
    }
    let (name, form) = word.split_once(':').map_or((word, None), |(name, form)| (name.trim(), Some(form.trim())));
    let both = name.strip_suffix("+-").map(str::trim);
    let (bare, approach) = both.map_or_else(|| split_direction(name), |bare| (bare, None));
    let error = error(machine, bare)?;
    let is_key = |key: &String| parse_error_name(key).as_ref() == Some(&error);
    let listed = request.basis.iter().find(|(key, _)| is_key(key)).map(|(_, form)| form.as_str());
    if let Some((own, listed)) = form.zip(listed).filter(|(own, listed)| own != listed) {
        let message = format!("`{error}` is fitted as `{}`, and its basis is `{}`", shown(own), shown(listed));
        return Err(refusal(message, "give the form once: in `fit`, or in `basis`"));
    }
    let form = form.or(listed);
    if error.is_location() {
        return match form {
            None if bare == name => Ok(vec![location(machine, &error)]),
            _ => Err(refusal(
                format!("`{error}` is a constant: it has neither basis nor direction"),
                format!("write `{error}`"),
            )),
        };
    }
    let knots = request.knots.iter().find(|(key, _)| is_key(key)).map(|(_, knots)| knots.as_slice());
    if both.is_none() {
        return curves::parameters(machine, &error, form, knots, approach.unwrap_or_default());
    }
    let mut list = curves::parameters(machine, &error, form, knots, Approach::Forward)?;
    list.extend(curves::parameters(machine, &error, form, knots, Approach::Reverse)?);
    Ok(list)
}

/// Returns a parameter of one's own: `f1: { EBX: [0, 1], EYX: [0, 0, 0.5] }`.
fn own_parameter(machine: &Machine, name: &str, errors: &IndexMap<String, Vec<Scalar>>) -> Result<Parameter, Refusal> {
    let help =
        "write coefficients by rising power of the position, in mm and rad: `f1: { EBX: [0, 1], EYX: [0, 0, 0.5] }`";
    if FITTED_GROUPS.contains(&name) || parse_error_name(name).is_some() || name.contains(':') {
        return Err(refusal(
            format!("`{}` cannot be the name of a parameter: it has another meaning", shown(name)),
            help,
        ));
    }
    let mut terms: Vec<ParameterTerm> = Vec::new();
    for (key, coefficients) in errors {
        let error = error(machine, key)?;
        for (power, coefficient) in coefficients.iter().enumerate() {
            let refuse =
                || refusal(format!("`{}`: `{coefficient}` is not a coefficient of `{error}`", shown(name)), help);
            let factor = curves::plain(coefficient).ok_or_else(refuse)?;
            let basis = match u8::try_from(power) {
                Ok(0) if error.is_location() => BasisFunction::Constant,
                Ok(power) if power <= MAX_POWER && !error.is_location() => BasisFunction::Power(power),
                _ => return Err(refuse()),
            };
            if factor != 0.0 {
                terms.push(ParameterTerm::new(source(machine, &error), basis, factor));
            }
        }
    }
    let Some(main) = terms.first().cloned() else {
        return Err(refusal(format!("`{}` moves no error", shown(name)), help));
    };
    let power = if let BasisFunction::Power(k) = main.basis { k } else { 0 };
    Ok(Parameter::of_terms(machine, name.to_owned(), main.source, power, terms, 0.0))
}

/// Returns the 2015 paper's parametrisation of every linear axis: positioning and the three angles grow with the
/// position, and straightness is the integral of the angles (the Abbe principle): `(e x u) q^2 / 2`.
fn linear(machine: &Machine) -> Vec<Parameter> {
    let slides = machine.axes().iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Linear);
    slides.flat_map(|(i, axis)| slopes(machine, i, axis.direction)).collect()
}

/// Returns the four slopes of a linear axis along the unit vector `u`: positioning, and the three angles with the
/// straightness that they cause.
fn slopes(machine: &Machine, axis: usize, u: [f64; 3]) -> Vec<Parameter> {
    let name = &machine.axes()[axis].name;
    let at = |direction| Source { place: ErrorSite::Component(axis), direction };
    let term =
        |k: usize, power, factor: f64| ParameterTerm::new(at(Direction::ALL[k]), BasisFunction::Power(power), factor);
    let parameter = |main: Direction, terms: Vec<ParameterTerm>| {
        let error = ErrorId { axis: name.clone(), family: ErrorFamily::Component, direction: main };
        let terms = terms.into_iter().filter(|t| t.factor != 0.0).collect();
        Parameter::of_terms(machine, format!("{error}:slope"), at(main), 1, terms, 0.0)
    };
    let own = (0..3).fold(0, |most, k| if u[k].abs() > u[most].abs() { k } else { most });
    let along = parameter(Direction::ALL[own], (0..3).map(|k| term(k, 1, u[k])).collect());
    let angle = |k: usize| {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        // The unit vector k times u: its component `next` is -u[last], its component `last` is u[next].
        let terms = vec![term(3 + k, 1, 1.0), term(next, 2, -u[last] / 2.0), term(last, 2, u[next] / 2.0)];
        parameter(Direction::ALL[3 + k], terms)
    };
    std::iter::once(along).chain((0..3).map(angle)).collect()
}
