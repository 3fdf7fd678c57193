//! Formats distinguished by content: the target that reads a folder's files, whatever their names.
//!
//! 1. Every file is tried against every place that a target's set has ([`TargetFit`]);
//! 2. the target that reads all that any target reads is the one; if there are several, nothing is guessed (E0730);
//! 3. a file whose content does not name its axis gets it from files that assign it, from its first lines, or
//!    from its positions (W0710), or is refused (E0731); no place is filled twice (E0732).
//!
//! A file that fits no place is ignored, with a warning (W0711).

use super::activation::Activation;
use super::in_force::{self, activation};
use super::place::{by_frame, spans};
use super::{Fault, ReadBack, ReadContext};
use crate::controller::manifest::{AssignedAxis, ControllerTarget, FileLayout, FileSpec, Per, axis_letters};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::Machine;

/// Files that a target reads.
#[derive(Debug)]
pub struct RecognisedSet {
    /// The target.
    pub target: ControllerTarget,
    /// Its files, in their places of the set.
    pub files: Vec<ReadBack>,
}

/// A text found under a name.
pub type NamedText = (String, String);

/// The texts of a folder, and those of them that put others in force.
#[derive(Clone, Copy)]
struct FolderTexts<'a> {
    files: &'a [NamedText],
    indices: &'a [IndexFile],
}

/// A file that puts others in force.
#[derive(Debug, Clone)]
pub struct IndexFile {
    /// The file, in its place of the set.
    pub file: ReadBack,
    puts: Activation,
}

impl IndexFile {
    /// True if it puts a file of this name in force.
    fn names(&self, name: &str) -> bool {
        self.puts.files.iter().any(|named| named.file == name)
    }
}

impl ControllerTarget {
    /// Finds the texts that put others in force, whatever their names. Diagnostics: one that the controller would not
    /// start with (E0704), two that differ (E0732).
    pub fn find_indices(
        &self,
        machine: &Machine,
        files: &[NamedText],
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<IndexFile>> {
        let letters = axis_letters(machine, self.manifest.axis_letters.as_ref(), None)?;
        let reading = ReadContext { target: self, machine, letters, axis: None, units: [1.0; 2] };
        let mut found: Vec<IndexFile> = Vec::new();
        for spec in self.manifest.files.iter().filter(|spec| spec.index.is_some()) {
            for (name, text) in files {
                let file = ReadBack { name: spec.path.clone(), found: name.clone(), text: text.clone() };
                let puts = match activation(&reading, spec, text) {
                    Ok(Some(puts)) => puts,
                    Ok(None) => continue,
                    Err(fault) => {
                        fault.report(&file, diagnostics);
                        return None;
                    }
                };
                match found.iter().find(|other| other.file.name == spec.path) {
                    None => found.push(IndexFile { file, puts }),
                    Some(other) if other.puts.same(&puts) => {}
                    Some(other) => {
                        let message = format!("`{}` and `{name}` put different tables in force", other.file.found);
                        let help = "leave the one that is on the machine";
                        diagnostics.push(Diagnostic::new(codes::E0732, message).help(help));
                        return None;
                    }
                }
            }
        }
        Some(found)
    }
}

struct FilePlace {
    file: usize,
    spec: usize,
    /// The axes whose place it can be; none if the place is the machine's.
    axes: Vec<usize>,
    /// First and last position of its only curve.
    positions: Vec<f64>,
}

struct TargetFit {
    target: ControllerTarget,
    placed: Vec<FilePlace>,
    /// Files that fit no place, with the fault at which their reading ended.
    failed: Vec<(usize, Fault)>,
}

/// Returns the target among these that reads the files. None if no target knows any of the files; if one came past the
/// first line of a file, its fault there is reported (E0704).
pub fn recognise(
    machine: &Machine,
    targets: Vec<ControllerTarget>,
    files: &[NamedText],
    diagnostics: &mut Diagnostics,
) -> Option<RecognisedSet> {
    let fitted: Vec<TargetFit> =
        targets.into_iter().filter_map(|target| TargetFit::of(target, machine, files)).collect();
    let Some(best) = fitted.iter().max_by_key(|fitted| fitted.placed.len()).filter(|best| !best.placed.is_empty())
    else {
        report_furthest(fitted.into_iter().flat_map(|fitted| fitted.failed), files, diagnostics);
        return None;
    };
    let rivals: Vec<&TargetFit> = fitted
        .iter()
        .filter(|other| !std::ptr::eq(*other, best) && other.placed.iter().any(|p| other.rivals(p, best)))
        .collect();
    if !rivals.is_empty() {
        diagnostics.push(ambiguous(best, &rivals, files));
        return None;
    }
    best.settle(machine, files, diagnostics)
}

fn report_furthest(failed: impl Iterator<Item = (usize, Fault)>, files: &[NamedText], diagnostics: &mut Diagnostics) {
    // Past the first line a reader has met something that it knows. Files of this program are none of a control.
    let is_own = |file: usize| [".yaml", ".yml", ".json", ".md"].iter().any(|end| files[file].0.ends_with(end));
    let past = failed.filter(|(file, fault)| fault.line > 0 && !is_own(*file));
    if let Some((file, fault)) = past.reduce(|a, b| if b.1.line > a.1.line { b } else { a }) {
        let (name, text) = &files[file];
        let source = diagnostics.sources.add(&**name, &**text);
        diagnostics.push(fault.diagnostic(name, text, source));
    }
}

fn ambiguous(best: &TargetFit, rivals: &[&TargetFit], files: &[NamedText]) -> Diagnostic {
    let said = |fitted: &TargetFit| {
        let names: Vec<String> = fitted.placed.iter().map(|p| format!("`{}`", files[p.file].0)).collect();
        format!("`{}` ({})", fitted.target.manifest.target, names.join(", "))
    };
    let all: Vec<String> = std::iter::once(best).chain(rivals.iter().copied()).map(said).collect();
    Diagnostic::new(codes::E0730, format!("by their content the files are of several targets: {}", all.join(", ")))
        .help("name the target with --target, or put each set into a folder of its own")
}

impl TargetFit {
    /// None if the machine is none for this target.
    fn of(target: ControllerTarget, machine: &Machine, files: &[NamedText]) -> Option<Self> {
        let letters = axis_letters(machine, target.manifest.axis_letters.as_ref(), None)?;
        let (mut placed, mut failed) = (Vec::new(), Vec::new());
        for (file, (_, text)) in files.iter().enumerate() {
            let mut trial = Trial { target: &target, machine, letters: &letters, text, furthest: None };
            let places = trial.places(file);
            if places.is_empty() {
                failed.extend(trial.furthest.map(|fault| (file, fault)));
            }
            placed.extend(places);
        }
        // Tables beside a kinematics module do not count without the module.
        let of_module = |placed: &FilePlace| {
            let layout = target.manifest.files[placed.spec].layout.as_ref();
            matches!(layout, Some(FileLayout::CArrays | FileLayout::HalConstants | FileLayout::Parameters { .. }))
        };
        if target.manifest.kinematics().is_some() && !placed.iter().any(of_module) {
            placed.clear();
        }
        Some(Self { target, placed, failed })
    }

    /// True if one of our files contradicts another target's reading.
    fn rivals(&self, placed: &FilePlace, best: &Self) -> bool {
        let same = best.placed.iter().any(|other| other.file == placed.file);
        !same || self.placed.len() == best.placed.len()
    }

    fn settle(&self, machine: &Machine, files: &[NamedText], diagnostics: &mut Diagnostics) -> Option<RecognisedSet> {
        let target = &self.target;
        let indices = target.find_indices(machine, files, diagnostics)?;
        let mut placed: Vec<&FilePlace> = self.placed.iter().collect();
        let axes = self.axes(&mut placed, machine, FolderTexts { files, indices: &indices }, diagnostics)?;
        let mut found: Vec<ReadBack> = Vec::new();
        for (placed, axis) in placed.into_iter().zip(axes) {
            let names = target.names(machine, &target.manifest.files[placed.spec]);
            let (_, name) = names.into_iter().find(|(a, _)| *a == axis)?;
            let (own, text) = &files[placed.file];
            if let Some(other) = found.iter().find(|other| other.name == name) {
                if !indices.is_empty() && !indices.iter().any(|index| index.names(own)) {
                    diagnostics.push(in_force::idle_warning(own));
                    continue;
                }
                let message = format!(
                    "`{}` and `{own}` are both the `{name}` of target `{}`",
                    other.found, target.manifest.target
                );
                let help = "leave the one that is on the machine";
                diagnostics.push(Diagnostic::new(codes::E0732, message).help(help));
                return None;
            }
            found.push(ReadBack { name, found: own.clone(), text: text.clone() });
        }
        self.report_unread(files, &indices, diagnostics);
        found.extend(indices.into_iter().map(|index| index.file));
        Some(RecognisedSet { target: target.clone(), files: found })
    }

    /// The axis of every file; none for a file of the machine's.
    fn axes(
        &self,
        all: &mut Vec<&FilePlace>,
        machine: &Machine,
        texts: FolderTexts,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Option<usize>>> {
        let FolderTexts { files, indices } = texts;
        let stated = |placed: &&FilePlace| match placed.axes[..] {
            [axis] => Some(axis),
            _ => self.axis_of_file(placed, machine, texts),
        };
        let mut known: Vec<Option<usize>> = all.iter().map(stated).collect();
        // One file may leave only one axis for the next.
        loop {
            let free = |placed: &FilePlace| {
                let spanned = |axis: &&usize| {
                    !known.contains(&Some(**axis)) && spans(&self.target, machine, **axis, &placed.positions)
                };
                placed.axes.iter().filter(spanned).copied().collect::<Vec<_>>()
            };
            let open = |i: &usize| known[*i].is_none() && !all[*i].axes.is_empty();
            let next = (0..known.len()).filter(open).find_map(|i| match free(all[i])[..] {
                [axis] => Some((i, axis)),
                _ => None,
            });
            let Some((i, axis)) = next else { break };
            known[i] = Some(axis);
            let (name, axis) = (&files[all[i].file].0, &machine.axes()[axis]);
            let message =
                format!("`{name}` does not name its axis: read as the table of `{}`, whose travel it spans", axis.name);
            let help = "name it as `compile` does, or put the controller's configuration that assigns it beside it";
            diagnostics.push(Diagnostic::new(codes::W0710, message).help(help));
        }
        while let Some(i) = (0..known.len()).find(|i| known[*i].is_none() && !all[*i].axes.is_empty()) {
            if indices.is_empty() {
                diagnostics.push(self.unknown_place(all[i], machine, files));
                return None;
            }
            diagnostics.push(in_force::idle_warning(&files[all.remove(i).file].0));
            known.remove(i);
        }
        Some(known)
    }

    /// Returns the axis of a file by a file that assigns it, or by its own first lines.
    fn axis_of_file(&self, placed: &FilePlace, machine: &Machine, texts: FolderTexts) -> Option<usize> {
        let (own, text) = &texts.files[placed.file];
        let assigned = texts.indices.iter().flat_map(|index| &index.puts.files).find(|named| named.file == *own);
        if let Some(axis) = assigned.and_then(|named| named.axis).filter(|axis| placed.axes.contains(axis)) {
            return Some(axis);
        }
        let spec = &self.target.manifest.files[placed.spec];
        let layout = spec.layout.as_ref();
        let framed =
            layout.and_then(|layout| by_frame(layout, &self.target.names(machine, spec), text)).map(|(_, axis)| axis);
        framed.filter(|axis| placed.axes.contains(axis))
    }

    fn unknown_place(&self, placed: &FilePlace, machine: &Machine, files: &[NamedText]) -> Diagnostic {
        let spec = &self.target.manifest.files[placed.spec];
        let candidates: Vec<String> = self
            .target
            .names(machine, spec)
            .into_iter()
            .filter_map(|(axis, name)| Some((axis?, name)))
            .filter(|(axis, _)| placed.axes.contains(axis))
            .map(|(axis, name)| format!("{} (`{name}`)", machine.axes()[axis].name))
            .collect();
        let message = format!(
            "`{}` is a table of target `{}` and does not name its axis: {}",
            files[placed.file].0,
            self.target.manifest.target,
            candidates.join(", ")
        );
        Diagnostic::new(codes::E0731, message)
            .help("give it the name in brackets, or put the controller's configuration that assigns it into the folder")
    }

    /// Reports the files that were not read.
    fn report_unread(&self, files: &[NamedText], indices: &[IndexFile], diagnostics: &mut Diagnostics) {
        let known = |name: &str| {
            let plain = |spec: &FileSpec| spec.layout.is_none() && spec.path == name;
            self.target.manifest.files.iter().any(plain)
        };
        for (file, (name, _)) in files.iter().enumerate().filter(|(_, (name, _))| !known(name)) {
            if self.placed.iter().any(|placed| placed.file == file)
                || indices.iter().any(|index| index.file.found == *name)
            {
                continue;
            }
            let fault = self.failed.iter().find(|(failed, _)| *failed == file).map(|(_, fault)| fault);
            let why = fault.map_or_else(String::new, |f| format!(": line {}: {}", f.line + 1, f.message));
            let message =
                format!("`{name}` is ignored: it is no table of target `{}`{why}", self.target.manifest.target);
            let help = "the certificate is of the set without this file";
            diagnostics.push(Diagnostic::new(codes::W0711, message).help(help));
        }
    }
}

/// One file against the places of one target.
struct Trial<'a> {
    target: &'a ControllerTarget,
    machine: &'a Machine,
    letters: &'a [AssignedAxis],
    text: &'a str,
    /// The fault at which the longest reading ended.
    furthest: Option<Fault>,
}

impl Trial<'_> {
    /// The place of a file; those of several axes of a control's archive.
    fn places(&mut self, file: usize) -> Vec<FilePlace> {
        for (i, spec) in self.target.manifest.files.iter().enumerate() {
            let Some(layout) = &spec.layout else { continue };
            if spec.per != Per::Machine && layout.is_archive(self.text) {
                let axes: Vec<usize> = self.letters.iter().map(|known| known.axis).collect();
                let axes = axes.into_iter().filter(|axis| self.read(layout, Some(*axis)).is_some());
                let place = |axis| FilePlace { file, spec: i, axes: vec![axis], positions: Vec::new() };
                let all: Vec<FilePlace> = axes.map(place).collect();
                if !all.is_empty() {
                    return all;
                }
            } else if let Some((axes, positions)) = self.fits(spec, layout) {
                return vec![FilePlace { file, spec: i, axes, positions }];
            }
        }
        Vec::new()
    }

    /// The axes for which the file reads as this part of the set.
    fn fits(&mut self, spec: &FileSpec, layout: &FileLayout) -> Option<(Vec<usize>, Vec<f64>)> {
        if let FileLayout::CArrays | FileLayout::HalConstants | FileLayout::Parameters { .. } = layout {
            let told = self.target.accept_kinematics(self.text);
            return self.keep(told).map(|()| Default::default());
        }
        if spec.per == Per::Machine {
            return self.read(layout, None).map(|_| Default::default());
        }
        let says_axis = !matches!(layout, FileLayout::Columns { .. } | FileLayout::AxisColumns { .. });
        if let Some((Some(axis), positions)) =
            says_axis.then(|| self.read(layout, None).map(|r| of(spec.per, r))).flatten()
        {
            return Some((vec![axis], positions));
        }
        // The first axis serves as well as any: axes differ in their unit.
        let first = self.letters.first()?.axis;
        let (_, positions) = of(spec.per, self.read(layout, Some(first))?);
        let axes: Vec<usize> = self.letters.iter().map(|known| known.axis).collect();
        let fitting = |axis: &usize| self.read(layout, Some(*axis)).is_some();
        let axes: Vec<usize> = axes.into_iter().filter(fitting).collect();
        (!axes.is_empty()).then_some((axes, positions))
    }

    fn read(&mut self, layout: &FileLayout, axis: Option<usize>) -> Option<crate::compensation::CorrectionTables> {
        let (target, letters) = (self.target, self.letters.to_vec());
        let reading = ReadContext { target, machine: self.machine, letters, axis, units: [1.0; 2] };
        let read = reading.file(layout, self.text).and_then(|tables| {
            let empty = tables.tables.is_empty() && tables.errors.is_empty();
            if empty && !reading.is_of_layout(layout, self.text)? {
                Err(Fault::new(0, "there is nothing in it"))
            } else {
                Ok(tables)
            }
        });
        self.keep(read)
    }

    fn keep<T>(&mut self, read: Result<T, Fault>) -> Option<T> {
        match read {
            Ok(read) => Some(read),
            Err(fault) => {
                if self.furthest.as_ref().is_none_or(|f| fault.line > f.line) {
                    self.furthest = Some(fault);
                }
                None
            }
        }
    }
}

/// The axis that the tables of a file are for, and the ends of the only one.
fn of(per: Per, read: crate::compensation::CorrectionTables) -> (Option<usize>, Vec<f64>) {
    let Some(table) = read.tables.first() else { return (None, Vec::new()) };
    let axis = if per == Per::Input { table.axes[0] } else { table.corrected[0] };
    let ends = table.nodes[0].first().into_iter().chain(table.nodes[0].last()).copied().collect();
    (Some(axis), ends)
}
