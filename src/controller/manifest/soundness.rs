//! Checks of a manifest: the reasons why it cannot be used.

use super::{FileLayout, Manifest, Per, TableColumn};
use crate::compensation::{
    Encoding, Fit, Increment, KinematicsMechanism, ModuleContent, OwnAxisContent, OwnAxisRules, ParameterRules,
    Spacing, Stored, TableRules,
};

impl Manifest {
    /// Returns the reason why the manifest cannot be used, if there is one.
    pub fn fault(&self) -> Option<String> {
        let tables = self.mechanism.iter().count();
        match &self.mechanism.kinematics {
            Some(kinematics) if tables == self.reversal().iter().count() => {
                return decimals_fault(kinematics.increment)
                    .or_else(|| kinematics.fault())
                    .or_else(|| self.unfit_files(kinematics))
                    .or_else(|| self.without_frame(kinematics))
                    .or_else(|| self.table_fault());
            }
            Some(_) => {
                return Some(
                    "mechanism: kinematics come alone, or with own_axis tables with both directions that hold the \
                     reversal"
                        .to_owned(),
                );
            }
            None if self.mechanism.own_axis.as_ref().is_some_and(|own| own.holds == OwnAxisContent::Reversal) => {
                return Some("holds: reversal is for own_axis tables beside kinematics".to_owned());
            }
            None if tables == 0 => return Some("mechanism: there is none".to_owned()),
            None => {}
        }
        self.table_fault()
    }

    /// Parameters count from somewhere in some directions.
    fn without_frame(&self, kinematics: &KinematicsMechanism) -> Option<String> {
        let parameters = kinematics.carries == ModuleContent::KinematicParameters;
        (parameters && self.certainty.frame.is_none()).then(|| {
            "certainty: frame: kinematic parameters say from where and in which directions they count".to_owned()
        })
    }

    fn table_fault(&self) -> Option<String> {
        if self.mechanism.plane.is_some() && self.mechanism.product.is_some() {
            return Some("mechanism: planes or products, not both".to_owned());
        }
        let layouts = || self.files.iter().filter_map(|f| f.layout.as_ref());
        let columns = || {
            let rules = self.mechanism.own_axis.as_ref()?;
            layouts().find_map(|l| l.fault(rules.table.directions.is_bidirectional()))
        };
        let scale = || self.mechanism.own_axis.as_ref().and_then(unfit_scale);
        self.mechanism.iter().find_map(|(name, rules)| fault(name, rules)).or_else(scale).or_else(columns)
    }
}

/// A scale is a line, of what the functional point sees.
fn unfit_scale(own: &OwnAxisRules) -> Option<String> {
    let TableRules { spacing, fit, stored, directions, .. } = &own.table;
    let line = (*spacing, *fit, *stored) == (Spacing::Line, Fit::FunctionalPoint, Stored::Correction);
    let fits = line && !directions.is_bidirectional() && !own.every_axis;
    (own.scale.is_some() && !fits)
        .then(|| "scale: with spacing: line, fit: functional_point, stored: correction, and nothing else".to_owned())
}

fn decimals_fault(increment: Increment) -> Option<String> {
    let decimals = increment.position_decimals.max(increment.correction_decimals);
    (decimals > MAX_DECIMALS)
        .then(|| format!("{decimals} decimals are more than the {MAX_DECIMALS} that a double has to give"))
}

fn encoding_fault(name: &str, rules: &TableRules) -> Option<String> {
    match rules.encoding {
        Encoding::Difference if rules.increment.correction_decimals > 0 => Some(
            "encoding: differences are whole numbers of the correction_scale's unit, correction_decimals: 0".to_owned(),
        ),
        Encoding::Magnified(max)
            if name != "lattice" || rules.stored == Stored::Command || !(1..=1000).contains(&max) =>
        {
            Some("encoding: magnified, of a lattice of corrections or errors, from 1 to 1000".to_owned())
        }
        _ => None,
    }
}

fn fault(name: &str, rules: &TableRules) -> Option<String> {
    let increment = rules.increment;
    let scales = [increment.position_scale, increment.correction_scale].map(|s| [s.mm, s.deg]).concat();
    let points = rules.max_points.min(rules.max_points_per_axis);
    let max = if name == "lattice" { MAX_NODES } else { MAX_POINTS };
    if let Some(fault) = decimals_fault(increment) {
        Some(fault)
    } else if !scales.iter().all(|s| (1e-9..=1e9).contains(s)) {
        Some("increment: a scale is stored units in one mm or deg, from 1e-9 to 1e9".to_owned())
    } else if points < 2 || rules.max_points > max {
        Some(format!("{name}: max_points: a table has from 2 to {max} points"))
    } else if !(rules.continuous.1 > rules.continuous.0 && rules.continuous.1 - rules.continuous.0 <= 36_000.0) {
        Some("continuous: write [from, to] in deg, rising, at most a hundred turns".to_owned())
    } else if matches!(rules.spacing, Spacing::PowerOfTwo(unit) if !(1e-6..=1e3).contains(&unit)) {
        Some("power_of_two: the length that the power multiplies, from 1e-6 to 1000".to_owned())
    } else {
        encoding_fault(name, rules)
    }
}

impl Manifest {
    /// A kinematics module is one set of files, and one of them is read back; tables beside it have files of their own.
    fn unfit_files(&self, mechanism: &KinematicsMechanism) -> Option<String> {
        let module = || self.files.iter().filter(|file| !file.is_of_tables());
        let layouts: Vec<&FileLayout> = module().filter_map(|file| file.layout.as_ref()).collect();
        let one = matches!(layouts[..], [layout] if layout_fits(mechanism.carries, layout));
        let once = module().all(|file| file.per == Per::Machine);
        let tables = self.files.iter().filter(|file| file.is_of_tables());
        let read = tables
            .clone()
            .all(|file| matches!(file.layout, Some(FileLayout::Columns { .. } | FileLayout::Lines { .. })));
        let known = tables.clone().count() == 0 || self.reversal().is_some();
        (!one || !once || !read || !known).then(|| {
            "files: all `per: machine`, and one of them with the layout c_arrays (full_model), parameters \
             (kinematic_parameters) or hal_constants; besides, `of: own_axis` with a layout of tables"
                .to_owned()
        })
    }
}

fn layout_fits(carries: ModuleContent, layout: &FileLayout) -> bool {
    match carries {
        ModuleContent::FullModel => *layout == FileLayout::CArrays,
        ModuleContent::LinearMap => *layout == FileLayout::HalConstants,
        ModuleContent::KinematicParameters => matches!(layout, FileLayout::Parameters { comment, line, .. }
            if !comment.is_empty() && line.contains("<name>") && line.contains("<value>")),
    }
}

/// Digits behind the point that still mean something at 1000 mm.
const MAX_DECIMALS: u8 = 12;

/// More points than any controller's table.
const MAX_POINTS: usize = 100_000;

/// Maximum number of nodes: a lattice of this size of six axes is half a gigabyte of text.
const MAX_NODES: usize = 5_000_000;

impl FileLayout {
    fn fault(&self, bidirectional: bool) -> Option<String> {
        let Self::Columns { columns } = self else { return None };
        let count = |column| columns.iter().filter(|c| **c == column).count();
        let (position, forward, reverse) =
            (count(TableColumn::Position), count(TableColumn::Forward), count(TableColumn::Reverse));
        let fits = position == 1 && forward == 1 && reverse == usize::from(bidirectional);
        (!fits)
            .then(|| "columns: position, forward, and reverse if the mechanism is bidirectional, each once".to_owned())
    }
}

impl KinematicsMechanism {
    /// Returns the reason why the mechanism cannot be used, if there is one.
    pub fn fault(&self) -> Option<String> {
        let damped = self.damping > 0.0 && self.damping <= 0.5;
        if self.carries == ModuleContent::FullModel && !damped {
            return Some("damping: the sine of an angle, above 0 and at most 0.5".to_owned());
        }
        let parameters = self.carries == ModuleContent::KinematicParameters;
        if parameters == self.machines.is_empty() {
            return Some("machines: the kinds of machines of kinematic_parameters, at least one".to_owned());
        }
        if let Some(fault) = self.machines.iter().find_map(ParameterRules::fault) {
            return Some(fault);
        }
        if self.max_offset_mm.is_some_and(|limit| !parameters || !limit.is_finite() || limit <= 0.0) {
            return Some("max_offset_mm: a length above 0, of kinematic_parameters".to_owned());
        }
        if self.linear_first && !parameters {
            return Some("linear_first: only of kinematic_parameters".to_owned());
        }
        let wanted = self.carries.constants();
        let plain = |name: &String| {
            !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
        };
        let twice = (1..self.constants.len()).any(|i| self.constants[..i].contains(&self.constants[i]));
        let fits = self.constants.len() == wanted && self.constants.iter().all(plain) && !twice;
        let modules = self.carries.components();
        let named = self.components.len() == modules && self.components.iter().all(plain);
        if !fits {
            return Some(format!("constants: {wanted} different names of letters, digits, - and _"));
        }
        (!named).then(|| format!("components: {modules} names of modules, of letters, digits, - and _"))
    }
}

impl ModuleContent {
    /// Number of the controller's modules that have the constants.
    fn components(self) -> usize {
        match self {
            Self::FullModel | Self::KinematicParameters => 0,
            Self::LinearMap => 1,
        }
    }

    fn constants(self) -> usize {
        match self {
            Self::FullModel | Self::KinematicParameters => 0,
            Self::LinearMap => 9,
        }
    }
}
