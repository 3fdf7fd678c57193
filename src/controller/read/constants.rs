//! The numbers of a kinematics module: constant arrays of C, or lines `setp MODULE.NAME VALUE`.

use super::{Arrays, Fault, ParameterLines};
use crate::compensation::ModuleContent;
use crate::controller::manifest::{ControllerTarget, FileLayout};
use crate::units;

impl ControllerTarget {
    /// Accepts a text that holds the numbers of this module, for any machine.
    pub(super) fn accept_kinematics(&self, text: &str) -> Result<(), Fault> {
        let Some(mechanism) = self.manifest.kinematics() else { return Ok(()) };
        let pins = Pins { modules: &mechanism.components, names: &mechanism.constants };
        match mechanism.carries {
            ModuleContent::FullModel => Arrays::read(text)?.take("abbe_options", 3).map(|_| ()),
            ModuleContent::LinearMap => pins.set::<9>(text).map(|_| ()),
            ModuleContent::KinematicParameters => self.accept_parameters(text),
        }
    }
}

impl ControllerTarget {
    /// The numbers of kinematic parameters in a text, in the order of these names.
    pub fn parameters(&self, names: &[&str], text: &str) -> Result<Vec<f64>, Fault> {
        self.parameter_lines()?.read(names, text)
    }

    /// The lines of its file of kinematic parameters.
    pub fn parameter_lines(&self) -> Result<ParameterLines<'_>, Fault> {
        let lines = self.manifest.files.iter().find_map(|file| match &file.layout {
            Some(FileLayout::Parameters {
                comment,
                line,
                structure,
                others,
                optional,
                builder,
                end,
                frame,
                archive,
            }) => {
                let frame = frame.as_deref();
                let (archive, vocabulary) = (archive.as_deref(), self.parameter_names());
                let all = [structure, others, optional, builder, end].map(Vec::as_slice);
                let [structure, others, optional, builder, end] = all;
                Some(ParameterLines {
                    comment,
                    line,
                    structure,
                    others,
                    optional,
                    builder,
                    end,
                    frame,
                    archive,
                    vocabulary,
                })
            }
            _ => None,
        });
        lines.ok_or_else(|| Fault::new(0, "the target has no file of parameters"))
    }

    /// The names of its kinematic parameters, of all kinds of machines.
    fn parameter_names(&self) -> Vec<&str> {
        let machines = self.manifest.kinematics().map_or(&[][..], |mechanism| &mechanism.machines);
        machines.iter().flat_map(|rules| rules.names().map(String::as_str)).collect()
    }

    /// Accepts the parameters of any kind of machine.
    fn accept_parameters(&self, text: &str) -> Result<(), Fault> {
        let machines = self.manifest.kinematics().map_or(&[][..], |mechanism| &mechanism.machines);
        let tried = machines.iter().map(|rules| {
            let names: Vec<&str> = rules.names().map(String::as_str).collect();
            self.parameters(&names, text).map(|_| ())
        });
        // The fault of the longest reading.
        let furthest = |a: Result<(), Fault>, b: Result<(), Fault>| match (a, b) {
            (Err(a), Err(b)) => Err(if b.line > a.line { b } else { a }),
            _ => Ok(()),
        };
        tried.reduce(furthest).unwrap_or(Ok(()))
    }
}

/// The pins of a module of the controller's own.
pub struct Pins<'a> {
    /// Names of the modules that it can be.
    pub modules: &'a [String],
    /// Names of the constants.
    pub names: &'a [String],
}

impl Pins<'_> {
    /// Reads `setp MODULE.NAME VALUE` lines, each name once; comments and blank lines are skipped.
    pub fn set<const N: usize>(&self, text: &str) -> Result<[f64; N], Fault> {
        let mut found = [None; N];
        for (line, words) in text.lines().enumerate().map(|(n, line)| (n, line.split('#').next().unwrap_or(""))) {
            let fault = |message: String| Fault { line, message };
            let words: Vec<&str> = words.split_ascii_whitespace().collect();
            let (pin, value) = match words[..] {
                [] => continue,
                ["setp", pin, value] => (pin, value),
                _ => return Err(fault("this is no `setp PIN VALUE`".to_owned())),
            };
            let slot = self.slot(pin, line)?;
            let number = units::number(value).map_err(|why| fault(why.to_string()))?;
            if number.abs() > 1e6 {
                return Err(fault(format!("{value} is no constant of a machine")));
            }
            let free = found.get_mut(slot).ok_or_else(|| fault(format!("the module has no `{pin}`")))?;
            if free.replace(number).is_some() {
                return Err(fault(format!("`{pin}` is set twice: the controller takes the last")));
            }
        }
        for (name, value) in self.names.iter().zip(&found) {
            if value.is_none() {
                return Err(Fault {
                    line: 0,
                    message: format!("`{name}` is not set: the controller keeps its default"),
                });
            }
        }
        Ok(found.map(Option::unwrap_or_default))
    }

    fn slot(&self, pin: &str, line: usize) -> Result<usize, Fault> {
        let (module, name) = pin.rsplit_once('.').unwrap_or(("", pin));
        if !self.modules.iter().any(|known| known == module) {
            let known = self.modules.join("`, `");
            let message = format!("`{pin}` is no pin of `{known}`: the controller would not start");
            return Err(Fault::new(line, message));
        }
        let slot = self.names.iter().position(|known| known == name);
        slot.ok_or_else(|| Fault::new(line, format!("the module has no `{name}`")))
    }
}
