//! Logs of touches: lines to positions of the axes at contact, set by set. A set is a ball in one pose of the rotary
//! axes.

use super::coordinates::TouchCoordinates;
use crate::analysis::place;
use crate::diagnostic::{Diagnostic, Place, codes, shown};
use crate::identify::thresholds::SAME_TOUCH_MM;
use crate::machine::{AxisKind, Machine, Pose};
use crate::syntax::sheet::SheetLine;
use crate::units::counted;
use nalgebra::{Matrix3, Vector3};

/// First line of a log by a program of abbe's.
pub(in crate::identify) const TOUCH_LOG: &str = "abbe touches 1";
/// Letters of the numbers of a probe file, `(PROBEOPEN)`.
const PROBE_LETTERS: [&str; 9] = ["X", "Y", "Z", "A", "B", "C", "U", "V", "W"];

/// A touch.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    /// Number in its set, from 1.
    pub number: usize,
    /// Coordinates X, Y, Z as logged (mm).
    pub logged: Vector3<f64>,
    /// Positions of the axes (mm, deg).
    pub axes: Pose,
    /// Nominal functional point, workpiece frame (mm).
    pub tip: Vector3<f64>,
    /// Nominal rotation from the tool into the workpiece frame.
    pub rotation: Matrix3<f64>,
    pub place: Place,
}

/// The touches of a ball in one pose of the rotary axes.
#[derive(Debug, Clone)]
pub(super) struct TouchSet {
    /// Empty if the log names no balls.
    pub ball: String,
    pub pose: String,
    pub contacts: Vec<Contact>,
}

/// A log.
#[derive(Debug, Default)]
pub(super) struct TouchLog {
    pub sets: Vec<TouchSet>,
    /// Sets that broke off and were begun again.
    pub broken: Vec<Place>,
}

type Found<T> = Result<T, Box<Diagnostic>>;

pub(super) fn refusal(message: impl Into<String>, place: Option<&Place>, help: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new(codes::E0509, message).at(place.cloned(), "").help(help))
}

/// Reads logs, of which the machine has the nominal geometry.
pub(super) struct LogReader<'m> {
    machine: &'m Machine,
    /// The axis of each number of a touch.
    axes: Vec<usize>,
    coordinates: TouchCoordinates,
}

impl<'m> LogReader<'m> {
    /// Reads a log that names its touches, or a probe file with so many touches a set.
    pub fn read(
        machine: &'m Machine,
        lines: &[SheetLine],
        touches: usize,
        coordinates: Option<TouchCoordinates>,
    ) -> Found<TouchLog> {
        let mut reader = Self { machine, axes: Vec::new(), coordinates: coordinates.unwrap_or_default() };
        match lines.split_first() {
            Some((first, rest)) if first.text.trim() == TOUCH_LOG => reader.named(rest, &first.place, coordinates),
            _ => reader.unnamed(lines, touches),
        }
    }

    fn named(&mut self, lines: &[SheetLine], start: &Place, stated: Option<TouchCoordinates>) -> Found<TouchLog> {
        let (mut log, mut planned) = (TouchLog::default(), None);
        let mut open: Option<TouchSet> = None;
        let again = "the program says `again` where it repeats a ball that broke off; of two attempts delete the lines \
                     of one";
        for line in lines {
            let refuse = |message: String, help: &str| refusal(message, Some(&line.place), help);
            let words: Vec<&str> = line.text.split_whitespace().collect();
            match words[..] {
                ["axes", ref names @ ..] => self.axes = self.axes_of(names, line)?,
                ["coordinates", word] => {
                    let found = TouchCoordinates::ALL.into_iter().find(|of| of.word() == word);
                    let found = found.ok_or_else(|| cut(line))?;
                    if stated.is_some_and(|stated| stated != found) {
                        let message = format!("the log holds coordinates `{word}`, not those of `--coordinates`");
                        return Err(refuse(message, "leave out `--coordinates`: a log says what it holds"));
                    }
                    self.coordinates = found;
                }
                ["sets", count] => planned = Some(count.parse::<usize>().map_err(|_| cut(line))?),
                [word @ ("begin" | "again"), ball, pose] => {
                    let name = set_name(ball, pose);
                    if let Some(before) = open.take() {
                        let same = before.ball == ball && before.pose == pose;
                        if word == "begin" || !same {
                            let message = match same {
                                true => format!("{name} is begun twice"),
                                false => format!("{name} is begun before {} has ended", before.name()),
                            };
                            return Err(refuse(message, again));
                        }
                        log.broken.extend(before.contacts.first().map(|contact| contact.place.clone()));
                    }
                    if log.sets.iter().any(|set| set.ball == ball && set.pose == pose) {
                        return Err(refuse(format!("{name} is measured twice"), again));
                    }
                    open = Some(TouchSet { ball: ball.into(), pose: pose.into(), contacts: Vec::new() });
                }
                ["touch", ball, pose, number, ref numbers @ ..] => {
                    let set = open.as_mut().filter(|set| set.ball == ball && set.pose == pose);
                    let set = set.ok_or_else(|| refuse(format!("{} was not begun", set_name(ball, pose)), again))?;
                    let number: usize = number.parse().map_err(|_| cut(line))?;
                    let values = self.values(numbers, line)?;
                    let Some((success, values)) = values.split_last() else { return Err(cut(line)) };
                    if *success != 1.0 {
                        let message = format!("touch {number} of {} is a miss", set_name(ball, pose));
                        return Err(refuse(message, "measure the ball again"));
                    }
                    self.add(set, number, values, line)?;
                }
                ["end", ball, pose] => match open.take().filter(|set| set.ball == ball && set.pose == pose) {
                    Some(set) => log.sets.push(set),
                    None => return Err(refuse(format!("{} was not begun", set_name(ball, pose)), again)),
                },
                _ => return Err(cut(line)),
            }
        }
        let short = planned.is_none_or(|planned| log.sets.len() < planned);
        if open.is_some() || short {
            let of = planned.map_or_else(String::new, |planned| format!(" of {planned}"));
            let message = format!("the log ends early: {}{of} are complete", counted(log.sets.len(), "set"));
            let help = "a set is a ball in a pose: run the program for those that are missing, which goes on in the \
                        same log";
            return Err(refusal(message, Some(lines.last().map_or(start, |line| &line.place)), help));
        }
        Ok(log)
    }

    /// Reads nine numbers a line.
    fn unnamed(&mut self, lines: &[SheetLine], touches: usize) -> Found<TouchLog> {
        let help = "a probe file has X Y Z A B C U V W of one touch a line, without names: the slow touches alone, as \
                    many for each ball and pose as `--touches` says";
        for axis in self.machine.axes() {
            let letter = PROBE_LETTERS.iter().position(|letter| *letter == axis.name.as_str());
            let Some(_) = letter else {
                let message = format!("a probe file has no letter for the axis {}", axis.name);
                return Err(refusal(message, None, "log the axes by name: docs/formats/touches.md"));
            };
        }
        let mut log = TouchLog::default();
        let mut all = TouchSet { ball: String::new(), pose: String::new(), contacts: Vec::new() };
        self.axes = PROBE_LETTERS.iter().map(|name| self.machine.axis_index(name).unwrap_or(usize::MAX)).collect();
        for line in lines {
            let words: Vec<&str> = line.text.split_whitespace().collect();
            let values = self.values(&words, line)?;
            if values.len() != PROBE_LETTERS.len() {
                return Err(refusal("this is no line of a probe file", Some(&line.place), help));
            }
            self.add(&mut all, 1, &values, line)?;
        }
        let rotary = |contact: &Contact| -> Vec<f64> {
            let turns = self.machine.axes().iter().zip(&contact.axes);
            turns.filter(|(axis, _)| axis.kind == AxisKind::Rotary).map(|(_, q)| *q).collect()
        };
        for group in all.contacts.chunk_by(|a, b| rotary(a) == rotary(b)) {
            if group.len() % touches != 0 {
                let message = format!("{} in one pose, of sets of {touches}", counted(group.len(), "contact"));
                return Err(refusal(message, group.first().map(|contact| &contact.place), help));
            }
            for contacts in group.chunks(touches) {
                let numbered = contacts.iter().zip(1..).map(|(of, number)| Contact { number, ..of.clone() });
                let pose = (log.sets.len() + 1).to_string();
                log.sets.push(TouchSet { contacts: numbered.collect(), pose, ..all.empty() });
            }
        }
        Ok(log)
    }

    fn axes_of(&self, names: &[&str], line: &SheetLine) -> Found<Vec<usize>> {
        let index = |name: &&str| self.machine.axis_index(name);
        let found: Vec<usize> = names.iter().filter_map(index).collect();
        let missing = (0..self.machine.axes().len()).find(|axis| !found.contains(axis));
        match missing {
            None if found.len() == names.len() => Ok(found),
            _ => {
                let own: Vec<String> = self.machine.axes().iter().map(|axis| axis.name.to_string()).collect();
                let message =
                    format!("the log has the axes {}, the machine {}", shown(&names.join(" ")), own.join(" "));
                Err(refusal(message, Some(&line.place), "take the machine file of the program that logged"))
            }
        }
    }

    fn values(&self, words: &[&str], line: &SheetLine) -> Found<Vec<f64>> {
        let number = |word: &&str| word.parse::<f64>().ok().filter(|value| value.is_finite());
        let values: Vec<f64> = words.iter().filter_map(number).collect();
        let wanted = self.axes.len() + usize::from(line.text.starts_with("touch"));
        if values.len() == words.len() && values.len() == wanted { Ok(values) } else { Err(cut(line)) }
    }

    /// Adds a touch to a set.
    fn add(&self, set: &mut TouchSet, number: usize, values: &[f64], line: &SheetLine) -> Found<()> {
        let mut axes = vec![0.0; self.machine.axes().len()];
        let mut logged = Vector3::zeros();
        for (value, axis) in values.iter().zip(&self.axes) {
            let Some(of) = self.machine.axes().get(*axis) else { continue };
            axes[*axis] = *value;
            let letter = ["X", "Y", "Z"].iter().position(|letter| *letter == of.name.as_str());
            letter.into_iter().for_each(|k| logged[k] = *value);
        }
        if self.coordinates == TouchCoordinates::Tip {
            axes = self.inverse(&logged, axes).ok_or_else(|| {
                let message = "the axes do not reach this place of the tip within their travel";
                refusal(message, Some(&line.place), "take the machine file with the tool of the measurement")
            })?;
        }
        let nominal = crate::lower::NominalPose::in_part(self.machine, &axes).pose;
        let contact = Contact {
            number,
            logged,
            axes,
            tip: nominal.translation,
            rotation: nominal.linear,
            place: line.place.clone(),
        };
        if let Some(before) = set.contacts.last() {
            let same = (before.tip - contact.tip).norm() < SAME_TOUCH_MM;
            if same && (before.rotation - contact.rotation).norm() < SAME_TOUCH_MM {
                let message = "this touch is that of the line before: fast and slow touches are mixed";
                let help = "log the second, slow touch of each place alone";
                return Err(refusal(message, Some(&contact.place), help));
            }
        }
        if set.contacts.iter().any(|of| of.number == number && !set.ball.is_empty()) {
            let message = format!("touch {number} of {} is there twice", set_name(&set.ball, &set.pose));
            return Err(refusal(message, Some(&contact.place), "log the second, slow touch of each place alone"));
        }
        set.contacts.push(contact);
        Ok(())
    }

    /// Returns the positions of the axes that nominally bring the tip to a place of the module's coordinates, which
    /// count from where the gauge point is with all axes at 0.
    fn inverse(&self, logged: &Vector3<f64>, pose: Pose) -> Option<Pose> {
        let off = Vector3::from(self.machine.workpiece()) - Vector3::from(self.machine.tool().gauge);
        let unturned = logged - off;
        let tip = self.machine.workpiece_rotation().map_or(unturned, |rotation| rotation.transpose() * unturned);
        place(self.machine, &tip, &pose).ok()
    }
}

impl TouchSet {
    fn empty(&self) -> Self {
        Self { contacts: Vec::new(), ..self.clone() }
    }

    /// Returns its name for people.
    pub fn name(&self) -> String {
        set_name(&self.ball, &self.pose)
    }
}

fn set_name(ball: &str, pose: &str) -> String {
    format!("ball {} in pose {}", shown(ball), shown(pose))
}

/// Refuses a line that is not whole.
fn cut(line: &SheetLine) -> Box<Diagnostic> {
    let message = format!("the line `{}` is none of a log of touches, or cut off", shown(&line.text));
    refusal(message, Some(&line.place), "docs/formats/touches.md has the lines of a log")
}
