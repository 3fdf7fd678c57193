//! An INI whose sections put the tables of joints in force.

use super::activation::{Activation, ActiveFile, base};
use super::{Fault, ReadContext};
use crate::controller::manifest::{AssignedAxis, FileSpec, Index, JointOrder, KindSetting, UnitSetting};
use crate::machine::AxisKind;

/// A setting: its line, its key, its value.
type Setting<'t> = (usize, &'t str, &'t str);

/// The sections of an INI, the first of each name.
struct Ini<'t>(Vec<(&'t str, Vec<Setting<'t>>)>);

impl<'t> Ini<'t> {
    fn of(text: &'t str) -> Result<Self, Fault> {
        let mut all: Vec<(&str, Vec<Setting>)> = Vec::new();
        for (number, line) in text.lines().map(str::trim).enumerate() {
            if line.starts_with(['#', ';']) {
                continue;
            }
            if let Some(name) = line.strip_prefix('[') {
                let name = name.split_once(']').ok_or_else(|| Fault::new(number, "a section without `]`"))?;
                all.push((name.0, Vec::new()));
            } else if let (Some((key, value)), Some((_, settings))) = (line.split_once('='), all.last_mut()) {
                settings.push((number, key.trim(), value.trim()));
            }
        }
        let first = |i: &usize| all[..*i].iter().all(|(name, _)| *name != all[*i].0);
        let kept: Vec<usize> = (0..all.len()).filter(first).collect();
        Ok(Self(kept.into_iter().map(|i| std::mem::take(&mut all[i])).collect()))
    }

    /// Refuses a key that stands in other sections only, where the controller does not look for it.
    fn check_section(&self, section: &str, key: &str) -> Result<(), Fault> {
        let found = self.0.iter().find_map(|(name, settings)| Some((*name, first(settings, key)?.0)));
        match (first(self.section(section), key), found) {
            (None, Some((name, line))) => {
                Err(Fault::new(line, format!("`{key}` stands in [{name}]: the controller reads that of [{section}]")))
            }
            _ => Ok(()),
        }
    }

    fn section(&self, name: &str) -> &[Setting<'t>] {
        self.0.iter().find(|(known, _)| *known == name).map_or(&[], |(_, settings)| settings)
    }
}

/// Returns the first setting of a key.
fn first<'t>(settings: &[Setting<'t>], key: &str) -> Option<(usize, &'t str)> {
    settings.iter().find(|(_, known, _)| *known == key).map(|(line, _, value)| (*line, *value))
}

pub(super) fn activation(reading: &ReadContext, spec: &FileSpec, text: &str) -> Result<Option<Activation>, Fault> {
    let Some(Index::Sections { prefix, key, with, joints, units, kinds }) = &spec.index else { return Ok(None) };
    let has_section = |line: &str| line.trim().strip_prefix('[').is_some_and(|name| name.starts_with(prefix.as_str()));
    if !text.lines().any(has_section) {
        return Ok(None);
    }
    let ini = Ini::of(text)?;
    let number = |name: &str| {
        let digits = name.strip_prefix(prefix.as_str())?;
        digits.parse::<usize>().ok().filter(|n| n.to_string() == digits)
    };
    if !ini.0.iter().any(|(name, _)| number(name).is_some()) {
        return Ok(None);
    }
    let order = match joints {
        Some(joints) => joint_order(joints, &ini, &reading.letters)?,
        None => reading.letters.iter().map(|known| Some(known.axis)).collect(),
    };
    let mut files: Vec<ActiveFile> = Vec::new();
    for (joint, settings) in ini.0.iter().filter_map(|(name, settings)| Some((number(name)?, settings))) {
        let Some((line, file)) = first(settings, key) else { continue };
        let axis = order.get(joint).copied().flatten();
        let axis = axis.ok_or_else(|| Fault::new(line, format!("the machine has no axis for joint {joint}")))?;
        for (name, wanted) in with {
            let value = first(settings, name);
            if value.is_none_or(|(_, value)| value != wanted) {
                let (line, value) = value.unwrap_or((line, "not there"));
                let message = format!("`{name}` is {value}: only tables under `{name} = {wanted}` are read here");
                return Err(Fault::new(line, message));
            }
        }
        if let Some(kinds) = kinds {
            check_kind(kinds, reading.machine.axes()[axis].kind, settings)?;
        }
        let file = ActiveFile { file: base(file).to_owned(), axis: Some(axis), line };
        match files.iter().find(|known| known.axis == file.axis) {
            // Two motors of one axis have one table.
            Some(known) if known.file == file.file => {}
            Some(_) => return Err(Fault::new(line, "two joints of one axis have different tables")),
            None => files.push(file),
        }
    }
    let units = [false, true].map(|rotary| unit(units.iter().filter(|unit| unit.rotary == rotary), &ini));
    let [length, angle] = units;
    Ok(Some(Activation { files, units: [length?, angle?], senses: Vec::new(), room: None }))
}

/// The axis of each joint; none where the machine has no such axis.
fn joint_order(of: &JointOrder, ini: &Ini, letters: &[AssignedAxis]) -> Result<Vec<Option<usize>>, Fault> {
    let own = || letters.iter().map(|known| Some(known.axis)).collect::<Vec<_>>();
    let settings = ini.section(&of.section);
    ini.check_section(&of.section, &of.key)?;
    ini.check_section(&of.section, &of.count)?;
    if first(settings, &of.key).is_some() != first(settings, &of.count).is_some() {
        let line = settings.first().map_or(0, |(line, ..)| *line);
        let message = format!("[{}] has one of `{}` and `{}`: the controller needs both", of.section, of.key, of.count);
        return Err(Fault::new(line, message));
    }
    let (mut order, mut stated) = (own(), false);
    if let Some((line, value)) = first(settings, &of.key) {
        let mut words = value.split_whitespace();
        let module = words.next().unwrap_or_default();
        let known = |word: &str| {
            word.split_once('=').is_some_and(|(key, _)| key == of.word || of.others.iter().any(|o| o == key))
        };
        if let Some(strange) = words.clone().find(|word| !known(word)) {
            return Err(Fault::new(line, format!("`{strange}`: what it does to the joints is not known here")));
        }
        let known = of.modules.get(module);
        let default = known
            .ok_or_else(|| Fault::new(line, format!("the order of the joints of `{module}` is not known here")))?;
        let word = words.find_map(|word| word.strip_prefix(of.word.as_str())?.strip_prefix('='));
        let by_letter = |letter: char| {
            let letter = letter.to_uppercase().to_string();
            letters.iter().find(|known| known.letter == letter).map(|known| known.axis)
        };
        stated = word.is_some();
        match (word, default.as_str()) {
            (None, "") => {}
            (word, default) => order = word.unwrap_or(default).chars().map(by_letter).collect(),
        }
    }
    let Some((line, count)) = first(settings, &of.count) else { return Ok(order) };
    let number: usize = count.parse().map_err(|_| Fault::new(line, format!("`{count}` is no number of joints")))?;
    if number < letters.len() || stated && number != order.len() {
        return Err(Fault::new(line, format!("{number} joints: the kinematics and the machine have others")));
    }
    order.truncate(number);
    Ok(order)
}

fn check_kind(of: &KindSetting, kind: AxisKind, settings: &[Setting]) -> Result<(), Fault> {
    let wanted = if kind == AxisKind::Linear { &of.linear } else { &of.rotary };
    match first(settings, &of.key) {
        Some((line, value)) if value != wanted => {
            Err(Fault::new(line, format!("`{} = {value}`: the axis of this joint is {wanted}", of.key)))
        }
        _ => Ok(()),
    }
}

/// The mm or deg of the unit that a setting states; 1 if none does.
fn unit<'u>(of: impl Iterator<Item = &'u UnitSetting>, ini: &Ini) -> Result<f64, Fault> {
    for setting in of {
        ini.check_section(&setting.section, &setting.key)?;
        let Some((line, value)) = first(ini.section(&setting.section), &setting.key) else { continue };
        let known = setting.values.get(value).copied();
        return known.ok_or_else(|| Fault::new(line, format!("`{value}` is no unit that is known here")));
    }
    Ok(1.0)
}
