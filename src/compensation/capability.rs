//! What a controller's compensation can hold: the `mechanism:` of a target's manifest.

use super::increment::{Increment, round};
use super::tables::{CorrectionTable, CorrectionTables};
use crate::machine::Machine;
use serde::Deserialize;

/// The mechanisms of a target. What several of them could hold goes into one only: rotary axes into
/// their own tables, then own and cross tables, planes for what those leave.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mechanisms {
    /// One table per axis, correcting that axis as a function of its own position.
    #[serde(default)]
    pub own_axis: Option<TableRules>,
    /// Tables that correct an axis as a function of another one's position.
    #[serde(default)]
    pub cross_axis: Option<TableRules>,
    /// Tables that correct an axis as a function of two positions.
    #[serde(default)]
    pub plane: Option<TableRules>,
    /// Tables that correct an axis by the product of a function of one position and one of another.
    #[serde(default)]
    pub product: Option<TableRules>,
    /// One lattice, correcting several axes.
    #[serde(default)]
    pub lattice: Option<TableRules>,
    /// Curves of the errors by their ISO names: the controller has the model.
    #[serde(default)]
    pub error_curves: Option<TableRules>,
    /// The controller's kinematics are replaced. Own-axis tables beside them hold the reversal, which depends on the
    /// direction of approach and is not the kinematics' to know.
    #[serde(default)]
    pub kinematics: Option<KinematicsMechanism>,
    /// So many tables of all mechanisms together.
    #[serde(default)]
    pub tables: Option<usize>,
}

/// The kinematics are replaced.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KinematicsMechanism {
    /// What the module carries.
    pub carries: ModuleContent,
    /// Sine of the angle from a singular pose below which corrections of rotary axes are bounded.
    #[serde(default)]
    pub damping: f64,
    /// The controller's names of the constants, in the order of [`ModuleContent`]; none for a full model.
    #[serde(default)]
    pub constants: Vec<String>,
    /// The controller's names of the modules that have them: one, or of rotary centres that for A and that for B.
    #[serde(default)]
    pub components: Vec<String>,
    /// Decimals of constants; numbers of a full model are written exactly.
    pub increment: Increment,
}

/// What a kinematics module can carry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModuleContent {
    /// The chain with every error.
    FullModel,
    /// A 3x3 matrix from the axes X, Y, Z to their joints; constants row by row.
    LinearMap,
    /// The lines of a tilting table: A or B, and C on it, tables turning right-handed. Constants: a point of
    /// C's line (X, Y, Z), the way from it to the tilting line (X, Y, Z), the length of the tool.
    RotaryCentres,
}

/// How the points of a table may lie.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// Anywhere, rising.
    Free,
    /// All at the same distance, up to the rounding of the positions.
    #[default]
    Equal,
    /// At a start plus whole multiples of a step: start and step are rounded, not the points.
    Stepped,
    /// At whole multiples of a step from 0.
    Anchored,
    /// Stepped, the step being this length (mm or deg) times a power of two.
    PowerOfTwo(f64),
    /// A straight line through position 0: two points, at 0 and at 1000.
    Line,
}

/// What a stored number means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stored {
    /// It is added to the command.
    Correction,
    /// It is the error, actual minus nominal; the controller subtracts it.
    Error,
    /// It is the command to be sent: position plus correction.
    Command,
}

/// Where the tables must be zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// Nowhere.
    #[default]
    Any,
    /// At position 0, or at the end of the travel nearest to it: there the axis is referenced.
    Zero,
}

/// What tables are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fit {
    /// The axis's own error at its origin: what its scale would have to read differently.
    #[default]
    Axis,
    /// The deviation of the functional point over the volume.
    FunctionalPoint,
}

/// Which part of the corrections tables hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Holds {
    /// All of it.
    #[default]
    All,
    /// What forward and reverse differ from their mean: the mean is held by something else.
    Reversal,
}

/// The rules of one mechanism.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableRules {
    /// At most so many points in one table.
    #[serde(alias = "max_nodes")]
    pub max_points: usize,
    /// At most so many tables.
    #[serde(default = "unlimited")]
    pub max_tables: usize,
    /// At most so many points on one axis of a table.
    #[serde(default = "unlimited")]
    pub max_points_per_axis: usize,
    /// How the points may lie.
    #[serde(default, with = "serde_yaml::with::singleton_map")]
    pub spacing: Spacing,
    /// One value for each direction of approach?
    #[serde(default)]
    pub bidirectional: bool,
    /// Range of positions that tables of continuous axes cover, deg.
    #[serde(default = "one_turn")]
    pub continuous: (f64, f64),
    /// Are positions of a continuous axis taken into the range by whole turns?
    #[serde(default)]
    pub modulo: bool,
    /// What the stored number means.
    pub stored: Stored,
    /// Is each stored number the difference to the point before?
    #[serde(default)]
    pub incremental: bool,
    /// Where the tables must be zero.
    #[serde(default)]
    pub reference: Reference,
    /// What they are made for.
    #[serde(default)]
    pub fit: Fit,
    /// Own-axis tables: one for every axis, of zeros where there is nothing?
    #[serde(default)]
    pub every_axis: bool,
    /// Are forward and reverse two of the controller's tables?
    #[serde(default)]
    pub apart: bool,
    /// Is the lost motion at the reference position a number of its own that cannot be negative?
    #[serde(default)]
    pub positive_backlash: bool,
    /// Which part of the corrections they hold.
    #[serde(default)]
    pub holds: Holds,
    /// At most one table for each corrected axis?
    #[serde(default)]
    pub one_per_output: bool,
    /// Cross tables: may an axis correct itself?
    #[serde(default)]
    pub own: bool,
    /// May rotary axes be inputs?
    #[serde(default = "yes")]
    pub rotary_inputs: bool,
    /// Can rotary axes be corrected by a lattice?
    #[serde(default)]
    pub corrects_rotary: bool,
    /// Cross tables: only these pairs of input and corrected axis; any if there are none.
    #[serde(default)]
    pub pairs: Vec<[String; 2]>,
    /// Planes: one step for both axes?
    #[serde(default)]
    pub square: bool,
    /// Planes: as many points over the one axis as over the other?
    #[serde(default)]
    pub as_many: bool,
    /// Names of the axes that span the lattice; all axes, or those asked for, if there are none.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// Names of the axes that it corrects; all that can be if there are none.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// Largest stored number.
    #[serde(default)]
    pub largest: Option<f64>,
    /// Lattices: a parameter of the controller multiplies all stored numbers, by at most so much.
    #[serde(default = "once")]
    pub magnification: u32,
    /// Largest change of the correction per change of the position between two points.
    #[serde(default)]
    pub max_slope: Option<f64>,
    /// Least increments.
    pub increment: Increment,
}

fn unlimited() -> usize {
    usize::MAX
}

fn once() -> u32 {
    1
}

fn one_turn() -> (f64, f64) {
    (0.0, 360.0)
}

fn yes() -> bool {
    true
}

impl TableRules {
    /// The least magnification that does, or else the largest there is.
    fn magnified(&self, does: impl Fn(f64) -> bool) -> f64 {
        let most = self.magnification;
        if most <= 1 {
            return 1.0;
        }
        (1..=most).map(f64::from).find(|times| does(*times)).unwrap_or(f64::from(most))
    }

    /// Rounds a lattice to what the controller stores of it with the least magnification that brings all within its
    /// range.
    fn magnify(&self, machine: &Machine, table: &mut CorrectionTable) {
        let decimals = self.increment.correction_decimals;
        let (scales, width) = (self.scales(machine, table), table.corrected.len());
        let within = |number: f64| self.largest.is_none_or(|most| number.abs() <= most);
        let stored = |i: usize, c: f64, times: f64| round(c * scales[i % width] / times, decimals);
        let all = |times: f64| table.values.iter().enumerate().all(|(i, c)| within(stored(i, *c, times)));
        let times = self.magnified(all);
        let rounded = table.values.iter().enumerate().map(|(i, c)| stored(i, *c, times) * times / scales[i % width]);
        table.values = rounded.collect();
    }

    /// The magnification of a rounded lattice: the least with which every number is stored as it is.
    pub fn magnification_of(&self, machine: &Machine, table: &CorrectionTable) -> f64 {
        /// Of the last place: what division and multiplication leave.
        const ROUNDING: f64 = 1e-6;
        let last = libm::pow(10.0, f64::from(self.increment.correction_decimals));
        let (scales, width) = (self.scales(machine, table), table.corrected.len());
        let kept = |number: f64, times: f64| {
            let places = number / times * last;
            let within = self.largest.is_none_or(|most| places.abs() <= most * last + ROUNDING);
            within && (places - libm::round(places)).abs() < ROUNDING
        };
        self.magnified(|times| table.values.iter().enumerate().all(|(i, c)| kept(c * scales[i % width], times)))
    }

    /// Stored units in one mm or deg of each corrected axis.
    fn scales(&self, machine: &Machine, table: &CorrectionTable) -> Vec<f64> {
        table.corrected.iter().map(|axis| self.increment.correction_scale.of(machine.axes()[*axis].kind)).collect()
    }
}

impl Mechanisms {
    /// Those with tables or curves that there are, with their names.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &TableRules)> {
        let named = [
            ("own_axis", &self.own_axis),
            ("cross_axis", &self.cross_axis),
            ("plane", &self.plane),
            ("product", &self.product),
            ("lattice", &self.lattice),
            ("error_curves", &self.error_curves),
        ];
        named.into_iter().filter_map(|(name, rules)| rules.as_ref().map(|rules| (name, rules)))
    }

    /// Gives stored numbers another sign; commands stay commands, and what stands beside a module keeps its own.
    pub fn store(&mut self, stored: Stored) {
        if self.kinematics.is_some() {
            return;
        }
        let all = [&mut self.own_axis, &mut self.cross_axis, &mut self.plane, &mut self.product, &mut self.lattice];
        for rules in all.into_iter().flatten().filter(|rules| rules.stored != Stored::Command) {
            rules.stored = stored;
        }
    }

    /// Does without tables of one kind. False if there are none of this name, or nothing would be left.
    pub fn leave_out(&mut self, name: &str) -> bool {
        let slot = match name {
            "own_axis" => &mut self.own_axis,
            "cross_axis" => &mut self.cross_axis,
            "plane" => &mut self.plane,
            "product" => &mut self.product,
            _ => return false,
        };
        slot.take().is_some() && (self.iter().next().is_some() || self.kinematics.is_some())
    }

    /// Makes own-axis tables for another purpose.
    pub fn fit(&mut self, fit: Fit) {
        self.own_axis.iter_mut().chain(&mut self.cross_axis).for_each(|rules| rules.fit = fit);
    }

    /// The rules under which a table stands.
    pub fn rules(&self, table: &CorrectionTable) -> Option<&TableRules> {
        let narrow = match (table.axes.len(), table.corrected.len()) {
            (1, 1) if table.is_own_axis() => self.own_axis.as_ref().or(self.cross_axis.as_ref().filter(|c| c.own)),
            (1, 1) => self.cross_axis.as_ref(),
            (2, 1) => self.plane.as_ref().or(self.product.as_ref()),
            _ => None,
        };
        narrow.or(self.lattice.as_ref())
    }

    /// Returns the lattice of a set that is one over whatever axes were asked for.
    pub fn free_lattice<'a>(&self, tables: &'a CorrectionTables) -> Option<&'a CorrectionTable> {
        let free = self.lattice.as_ref().is_some_and(|rules| rules.inputs.is_empty());
        match &tables.tables[..] {
            [lattice] if free => Some(lattice),
            _ => None,
        }
    }

    /// Is a table written as products?
    pub fn is_product(&self, table: &CorrectionTable) -> bool {
        self.plane.is_none() && self.product.is_some() && (table.axes.len(), table.corrected.len()) == (2, 1)
    }

    /// How many of the controller's tables a table takes.
    pub fn count(&self, table: &CorrectionTable) -> usize {
        table.count(self.rules(table).is_some_and(|rules| rules.apart))
    }

    /// Rounds every stored number. Where the controller multiplies tables these are the factors.
    pub fn round(&self, machine: &Machine, tables: &mut CorrectionTables) {
        for table in &mut tables.tables {
            if let Some(rules) = self.rules(table).filter(|rules| rules.magnification > 1) {
                rules.magnify(machine, table);
            }
        }
        self.round_sums(machine, tables);
        for table in tables.tables.iter_mut().filter(|table| self.is_product(table)) {
            let Some(rules) = &self.product else { continue };
            let closed = [0, 1].map(|place| rules.modulo && machine.is_continuous(table.axes[place]));
            table.factorise(rules.increment, machine.axes()[table.corrected[0]].kind, closed);
        }
    }

    /// Rounds every stored number but those of products, whose factors are stored.
    pub fn round_sums(&self, machine: &Machine, tables: &mut CorrectionTables) {
        tables.quantise(machine, |table| {
            self.rules(table).filter(|_| !self.is_product(table)).map(|rules| &rules.increment)
        });
        let Some(rules) = &self.error_curves else { return };
        for curve in &mut tables.errors {
            let direction = curve.error.direction;
            curve.values.iter_mut().for_each(|value| *value = rules.increment.error(*value, direction));
        }
    }
}
