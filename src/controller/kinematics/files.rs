//! The files of a kinematics module, written and read back.

use super::context::context;
use super::{CurveData, Form, KinematicsModule, ModuleJoint, ModuleModel, ModuleWords, Parameters};
use crate::compensation::{CorrectionTables, reversal_tables};
use crate::controller::emit::RenderedFile;
use crate::controller::manifest::{ControllerTarget, FileLayout, FileSpec, axis_letters};
use crate::controller::read::{Arrays, Fault, Pins, ReadBack, without_c_comments};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::Machine;
use std::sync::Arc;

/// Maximum number of joints of the controller.
const MAX_AXES: usize = 16;

impl ControllerTarget {
    /// Writes the files of a kinematics module. Diagnostics: a template that fails (E0702).
    pub fn render_kinematics(
        &self,
        machine: &Machine,
        carried: &KinematicsModule,
        reversal: &Arc<CorrectionTables>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<RenderedFile>> {
        // The words of a full model are its own.
        if !matches!(carried, KinematicsModule::FullModel(_)) {
            let _ = axis_letters(machine, self.manifest.axis_letters.as_ref(), Some(diagnostics))?;
        }
        let context = context(machine, carried, self.manifest.kinematics()?);
        self.render_once(machine, &context, reversal, diagnostics)
    }

    /// The tables beside a module: additions to its joints when they are approached from one side.
    pub fn reversal_tables(&self, machine: &Machine) -> CorrectionTables {
        self.manifest.reversal().map_or_else(CorrectionTables::default, |rules| reversal_tables(machine, rules))
    }

    /// Reads kinematic parameters, mm and components of unit vectors, whatever they mean for the machine. Diagnostics:
    /// E0704.
    pub fn read_parameters(
        &self,
        machine: &Machine,
        meant: &KinematicsModule,
        file: &ReadBack,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<f64>> {
        let parameters = meant.parameters()?;
        match self.parameters_of(machine, meant, parameters, file, diagnostics) {
            Ok(stored) => Some(parameters.decode(&stored)),
            Err(fault) => {
                fault.report(file, diagnostics);
                None
            }
        }
    }

    /// The file that holds the numbers.
    fn read_file(&self) -> Option<&FileSpec> {
        self.manifest.files.iter().find(|spec| spec.layout.is_some())
    }

    /// The numbers of parameters in a text whose structure is the machine's.
    fn parameters_of(
        &self,
        machine: &Machine,
        module: &KinematicsModule,
        parameters: &Parameters,
        file: &ReadBack,
        diagnostics: &mut Diagnostics,
    ) -> Result<Vec<f64>, Fault> {
        let lines = self.parameter_lines()?;
        let stored = lines.read(&parameters.names(), &file.text)?;
        self.read_file().and_then(|spec| spec.layout.as_ref()).iter().for_each(|layout| {
            layout.report_check_words(file, diagnostics);
        });
        if lines.has_structure() {
            let written = self.render_kinematics(machine, module, &Arc::default(), &mut Diagnostics::default());
            let own = written.iter().flatten().find(|file| Some(&file.name) == self.read_file().map(|spec| &spec.path));
            let own = own.map_or_else(String::new, |file| String::from_utf8_lossy(&file.bytes).into());
            for remark in lines.same_structure(&file.text, &own)? {
                let message = format!("`{}`: {remark}", file.found);
                let help = "look up which axis of the machine has this name in the control";
                diagnostics.push(Diagnostic::new(codes::W0717, message).help(help));
            }
        }
        Ok(stored)
    }

    /// Refuses code that is not what is written for the machine: the certificate is of that code. Comments are free.
    fn same_code(
        &self,
        machine: &Machine,
        module: &KinematicsModule,
        files: &[ReadBack],
        diagnostics: &mut Diagnostics,
    ) -> Option<()> {
        let code = self.manifest.files.iter().filter(|spec| spec.code);
        let code: Vec<&ReadBack> = code.filter_map(|spec| files.iter().find(|file| file.name == spec.path)).collect();
        if code.is_empty() {
            return Some(());
        }
        let reversal = Arc::new(self.reversal_tables(machine));
        let written = self.render_kinematics(machine, module, &reversal, &mut Diagnostics::default())?;
        for file in code {
            let own = written.iter().find(|own| own.name == file.name);
            let own = own.map_or_else(String::new, |own| String::from_utf8_lossy(&own.bytes).into_owned());
            if let Err(fault) = same_code(&file.text, &own) {
                fault.report(file, diagnostics);
                return None;
            }
        }
        Some(())
    }

    /// Reads the numbers of a module back. `meant` holds the axes of the machine that they are for. Diagnostics: E0704,
    /// E0705.
    pub fn read_kinematics(
        &self,
        machine: &Machine,
        meant: &KinematicsModule,
        files: &[ReadBack],
        diagnostics: &mut Diagnostics,
    ) -> Option<KinematicsModule> {
        let spec = self.read_file()?;
        let Some(file) = files.iter().find(|file| file.name == spec.path) else {
            diagnostics.push(
                Diagnostic::new(codes::E0705, format!("the file `{}` is missing", spec.path))
                    .help("a set of compensation files is only whole with all of them"),
            );
            return None;
        };
        let mechanism = self.manifest.kinematics()?;
        let pins = Pins { modules: &mechanism.components, names: &mechanism.constants };
        let read = match (&spec.layout, meant) {
            (Some(FileLayout::CArrays), KinematicsModule::FullModel(meant)) => Arrays::read(&file.text)
                .and_then(|arrays| model(&arrays, machine, meant))
                .map(KinematicsModule::FullModel),
            (Some(FileLayout::HalConstants), KinematicsModule::LinearMap(meant)) => {
                pins.set(&file.text).map(|matrix| {
                    let mut map = meant.clone();
                    map.matrix = matrix;
                    KinematicsModule::LinearMap(map)
                })
            }
            (Some(FileLayout::Parameters { .. }), of @ KinematicsModule::KinematicParameters(meant)) => {
                let read = self.parameters_of(machine, of, meant, file, diagnostics).and_then(|stored| {
                    let values = meant.decode(&stored);
                    meant.fault(&values).map_or(Ok(values), |why| Err(Fault::new(0, why)))
                });
                read.map(|values| KinematicsModule::KinematicParameters(meant.clone().with_values(values)))
            }
            _ => Err(Fault { line: 0, message: "the manifest's layout is none of its mechanism".to_owned() }),
        };
        match read {
            Ok(carried) => self.same_code(machine, &carried, files, diagnostics).map(|()| carried),
            Err(fault) => {
                fault.report(file, diagnostics);
                None
            }
        }
    }
}

/// Compares the lines of code, comments and remarks on the writer aside.
fn same_code(text: &str, written: &str) -> Result<(), Fault> {
    let (found, wanted) = (code(text)?, code(written)?);
    for (i, (line, bare)) in found.iter().enumerate() {
        if wanted.get(i).is_none_or(|(_, wanted)| wanted != bare) {
            return Err(Fault::new(*line, "this is not the code that abbe writes here: what it computes is not known"));
        }
    }
    let end = found.last().map_or(0, |(line, _)| *line);
    if found.len() == wanted.len() { Ok(()) } else { Err(Fault::new(end, "the code was cut off behind this line")) }
}

/// A line with single blanks, and its numbers written in one way.
fn uniform(line: &str) -> String {
    let mut all = String::new();
    let is_part = |c: char| c.is_ascii_digit() || ".+-eE".contains(c);
    for word in line.split_whitespace() {
        let mut rest = word;
        while let Some(first) = rest.chars().next() {
            let length = match is_part(first) {
                true => rest.find(|c| !is_part(c)).unwrap_or(rest.len()),
                false => rest.find(is_part).unwrap_or(rest.len()),
            };
            match rest[..length].parse::<f64>() {
                Ok(number) if is_part(first) => all.push_str(&format!("{:?}", number + 0.0)),
                _ => all.push_str(&rest[..length]),
            }
            rest = &rest[length..];
        }
        all.push(' ');
    }
    all.trim_end().to_owned()
}

/// The lines of code with their numbers.
fn code(text: &str) -> Result<Vec<(usize, String)>, Fault> {
    let clean = without_c_comments(text)?;
    let all = clean.split('\n').map(uniform).enumerate();
    let of_writer = |line: &str| line.to_lowercase().contains("written by abbe");
    Ok(all.filter(|(_, line)| !line.is_empty() && !line.starts_with("# ") && !of_writer(line)).collect())
}

/// A full model for the same axes as `meant`.
fn model(arrays: &Arrays, machine: &Machine, meant: &ModuleModel) -> Result<ModuleModel, Fault> {
    let axes = machine.axes().len().min(MAX_AXES);
    let curves = curves(arrays)?;
    let flags = |name: &str| Ok(arrays.whole(name, axes, 2)?.into_iter().map(|x| x == 1).collect::<Vec<_>>());
    let (letters, numbers) =
        (arrays.indices("abbe_coordinate", axes, true, 9)?, arrays.whole("abbe_joint", axes, axes)?);
    let (rotary, solved) = (flags("abbe_rotary")?, flags("abbe_solved")?);
    let (workpiece_side, outside) = (flags("abbe_workpiece_side")?, flags("abbe_outside")?);
    let (inverted, location_inverted) = (flags("abbe_inverted")?, flags("abbe_location_inverted")?);
    let directions = arrays.take("abbe_direction", 3 * axes)?;
    let origins = arrays.take("abbe_origin", 3 * axes)?;
    let locations = arrays.take("abbe_location", 6 * axes)?;
    let of_curves = arrays.indices("abbe_curve", 12 * axes, true, curves.len())?;
    let joint = |i: usize| ModuleJoint {
        letter: letters[i],
        number: numbers[i],
        rotary: rotary[i],
        solved: solved[i],
        workpiece_side: workpiece_side[i],
        outside: outside[i],
        inverted: inverted[i],
        location_inverted: location_inverted[i],
        direction: std::array::from_fn(|k| directions[3 * i + k]),
        origin: std::array::from_fn(|k| origins[3 * i + k]),
        location: std::array::from_fn(|k| locations[6 * i + k]),
        curves: std::array::from_fn(|k| [of_curves[12 * i + 2 * k], of_curves[12 * i + 2 * k + 1]]),
    };
    let joints: Vec<ModuleJoint> = (0..axes).map(joint).collect();
    let part = |j: &ModuleJoint| (j.letter, j.number, j.rotary, j.solved);
    let same = |a: &ModuleJoint, b: &ModuleJoint| part(a) == part(b);
    if joints.len() != meant.joints.len() || !joints.iter().zip(&meant.joints).all(|(a, b)| same(a, b)) {
        return Err(
            arrays.fault("abbe_coordinate", "these are not the axes of this machine, in the order of its chain")
        );
    }
    let options = arrays.whole("abbe_options", 3, 2)?;
    let words = ModuleWords::ALL[arrays.whole("abbe_words", 1, ModuleWords::ALL.len())?[0]];
    if words != meant.words {
        return Err(arrays.fault("abbe_words", "the words of the program mean something else on this machine"));
    }
    let model = ModuleModel {
        words,
        joints,
        curves,
        carried_body: options[0] == 1,
        linearised: options[1] == 1,
        orientation: options[2] == 1,
        gauge: three(arrays, "abbe_gauge")?,
        tool: three(arrays, "abbe_tool")?,
        tool_clamping: three(arrays, "abbe_tool_clamping")?,
        workpiece: three(arrays, "abbe_workpiece")?,
        spindle: six(arrays, "abbe_spindle")?,
        clamping: six(arrays, "abbe_clamping")?,
        damping: arrays.take("abbe_damping", 1)?[0],
        arm: arrays.take("abbe_arm", 1)?[0],
    };
    match (model.damping > 0.0, model.arm > 0.0) {
        (true, true) => Ok(model),
        (false, _) => Err(arrays.fault("abbe_damping", "the damping must be above 0")),
        (_, false) => Err(arrays.fault("abbe_arm", "the arm must be above 0")),
    }
}

fn three(arrays: &Arrays, name: &str) -> Result<[f64; 3], Fault> {
    let numbers = arrays.take(name, 3)?;
    Ok(std::array::from_fn(|i| numbers[i]))
}

fn six(arrays: &Arrays, name: &str) -> Result<[f64; 6], Fault> {
    let numbers = arrays.take(name, 6)?;
    Ok(std::array::from_fn(|i| numbers[i]))
}

/// Every curve, with all that its evaluation takes for granted.
fn curves(arrays: &Arrays) -> Result<Vec<CurveData>, Fault> {
    let count = arrays.count("abbe_form");
    let total = arrays.count("abbe_number");
    let forms = arrays.whole("abbe_form", count, Form::ALL.len())?;
    let starts = arrays.whole("abbe_start", count, total.max(1))?;
    let points = arrays.whole("abbe_points", count, total + 1)?;
    let periods = arrays.take("abbe_period", count)?;
    let numbers = arrays.take("abbe_number", total)?;
    let curve = |i: usize| {
        let form = Form::ALL[forms[i]];
        let range = starts[i]..starts[i] + points[i] * form.width();
        let own = numbers.get(range).filter(|own| !own.is_empty());
        let own =
            own.ok_or_else(|| arrays.fault("abbe_points", &format!("curve {i} has numbers that are not there")))?;
        let tabled = matches!(form, Form::Linear | Form::Cubic);
        if tabled && own[..points[i]].windows(2).any(|w| w[1] <= w[0]) {
            return Err(arrays.fault("abbe_number", &format!("the positions of curve {i} do not rise")));
        }
        if periods[i] < 0.0 || (tabled && periods[i] > 0.0 && points[i] < 2) {
            return Err(arrays.fault("abbe_period", &format!("curve {i} has no such period")));
        }
        Ok(CurveData { form, period: periods[i], numbers: own.to_vec() })
    };
    if count == 0 {
        return Err(Fault { line: 0, message: "the array `abbe_form` is missing".to_owned() });
    }
    (0..count).map(curve).collect()
}
