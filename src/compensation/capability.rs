//! The mechanisms of a controller's compensation: the `mechanism:` of a target's manifest.

use super::increment::{Increment, round};
use super::parameters::ParameterRules;
use super::scale::DriveScale;
use super::tables::{CorrectionTable, CorrectionTables};
use crate::machine::Machine;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The mechanisms of a target. A correction that several of them could hold goes into one only: rotary axes into their
/// own tables, then own and cross tables, planes for their residual.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mechanisms {
    /// One table per axis, correcting that axis as a function of its own position.
    pub own_axis: Option<OwnAxisRules>,
    /// Tables that correct an axis as a function of another one's position.
    pub cross_axis: Option<CrossAxisRules>,
    /// Tables that correct an axis as a function of two positions.
    pub plane: Option<PlaneRules>,
    /// Tables that correct an axis by the product of a function of one position and one of another.
    pub product: Option<TableRules>,
    /// One lattice, correcting several axes.
    pub lattice: Option<LatticeRules>,
    /// Curves of the errors by their ISO names: the controller has the model.
    pub error_curves: Option<TableRules>,
    /// The controller's kinematics are replaced. Own-axis tables beside them hold the reversal, which depends on the
    /// direction of approach and is not the kinematics' to know.
    pub kinematics: Option<KinematicsMechanism>,
    /// Maximum number of tables of all mechanisms together.
    pub tables: Option<usize>,
}

/// The kinematics are replaced.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KinematicsMechanism {
    /// The content of the module.
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
    /// The kinds of machines that the controller has a transformation for; only of kinematic parameters.
    #[serde(default)]
    pub machines: Vec<ParameterRules>,
    /// True if the controller's chain has the linear axes next to the bed, and each rotary axis beyond them on the side
    /// that the file states. Only of kinematic parameters.
    #[serde(default)]
    pub linear_first: bool,
    /// Largest component of an offset that the controller takes, mm; none where no limit is known. Only of kinematic
    /// parameters.
    pub max_offset_mm: Option<f64>,
    /// Decimals of constants; numbers of a full model are written exactly. Of kinematic parameters those of positions
    /// are for offsets (mm), those of corrections for components of directions.
    pub increment: Increment,
}

/// The content of a kinematics module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModuleContent {
    /// The chain with every error.
    FullModel,
    /// A 3x3 matrix from the axes X, Y, Z to their joints; constants row by row.
    LinearMap,
    /// The lines of the rotary axes, and the tool axis, of the controller's five-axis transformation.
    KinematicParameters,
}

/// The spacing of the points of a table.
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

/// The meaning of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Stored {
    /// Added to the command.
    Correction,
    /// Actual minus nominal; the controller subtracts it.
    Error,
    /// The command to be sent: position plus correction.
    #[cfg_attr(feature = "cli", value(skip))]
    Command,
}

/// The position at which tables must be zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// Nowhere.
    #[default]
    Any,
    /// At position 0, or at the end of the travel nearest to it: there the axis is referenced.
    Zero,
}

/// The error that tables are fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Fit {
    /// The axis's own error at its origin: the change of its scale's reading against it.
    #[default]
    Axis,
    /// The deviation of the functional point over the volume.
    FunctionalPoint,
}

/// The part of the corrections that tables hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OwnAxisContent {
    /// All of it.
    #[default]
    All,
    /// The difference of forward and reverse from their mean: something else corrects the mean.
    Reversal,
}

/// The values of a table for the directions of approach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// The mean of forward and reverse.
    #[default]
    Mean,
    /// One value for each direction.
    Both,
    /// Forward and reverse are two of the controller's tables.
    TwoTables,
    /// One value for each direction, and the lost motion at the reference position is a number of its own that cannot
    /// be negative.
    Backlash,
}

/// The encoding of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// The number itself.
    #[default]
    Plain,
    /// The difference to the point before, a whole number.
    Difference,
    /// Divided by a whole number up to this one: a parameter of the controller multiplies all numbers of the table.
    Magnified(u32),
}

/// The grid of a plane over its two axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlaneGrid {
    /// Each axis has a step and a number of points of its own.
    #[default]
    Independent,
    /// One step for both axes.
    SameStep,
    /// The same number of points over both axes, at multiples of their steps, for tables that roll over.
    SameCount,
}

/// The rules that the tables of every mechanism have.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct TableRules {
    /// Maximum number of points of one table.
    #[serde(alias = "max_nodes")]
    pub max_points: usize,
    /// Maximum number of tables.
    #[serde(default = "no_limit")]
    pub max_tables: usize,
    /// Maximum number of tables that correct the same axis.
    #[serde(default = "no_limit")]
    pub max_tables_per_output: usize,
    /// Maximum number of points on one axis of a table.
    #[serde(default = "no_limit")]
    pub max_points_per_axis: usize,
    /// The spacing of the points.
    #[serde(default, with = "serde_yaml::with::singleton_map")]
    pub spacing: Spacing,
    /// Their values for the directions of approach.
    #[serde(default)]
    pub directions: Directions,
    /// Range of positions that tables of continuous axes cover, deg.
    #[serde(default = "one_turn")]
    pub continuous: (f64, f64),
    /// True if positions of a continuous axis are taken into the range by whole turns.
    #[serde(default)]
    pub modulo: bool,
    /// The meaning of a stored number.
    pub stored: Stored,
    /// Its encoding.
    #[serde(default, with = "serde_yaml::with::singleton_map")]
    pub encoding: Encoding,
    /// The position at which they must be zero.
    #[serde(default)]
    pub reference: Reference,
    /// The error that they are made for.
    #[serde(default)]
    pub fit: Fit,
    /// Largest stored number.
    pub largest: Option<f64>,
    /// Largest change of the correction per change of the position between two points.
    pub max_slope: Option<f64>,
    /// Increments of the stored numbers.
    pub increment: Increment,
}

/// The rules of tables that correct an axis as a function of its own position.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnAxisRules {
    /// Those of every mechanism.
    #[serde(flatten)]
    pub table: TableRules,
    /// True if there is one for every axis, of zeros where there is nothing.
    #[serde(default)]
    pub every_axis: bool,
    /// The part of the corrections that they hold.
    #[serde(default)]
    pub holds: OwnAxisContent,
    /// The scale of the drive as which the controller has lines over the axis itself.
    pub scale: Option<DriveScale>,
    /// Scales in force by name of axis, from the options of a run; others are not written.
    #[serde(skip)]
    pub in_force: Vec<(String, f64)>,
}

/// The rules of tables that correct an axis as a function of another one's position.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossAxisRules {
    /// Those of every mechanism.
    #[serde(flatten)]
    pub table: TableRules,
    /// True if an axis may correct itself too.
    #[serde(default)]
    pub own: bool,
    /// The only pairs of input and corrected axis; any if there are none.
    #[serde(default)]
    pub pairs: Vec<[String; 2]>,
}

/// The rules of tables that correct an axis as a function of two positions.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneRules {
    /// Those of every mechanism.
    #[serde(flatten)]
    pub table: TableRules,
    /// The grid over the two axes.
    #[serde(default)]
    pub grid: PlaneGrid,
    /// True if rotary axes may be inputs.
    #[serde(default = "yes")]
    pub rotary_inputs: bool,
    /// Names of the axes that span them; any if there are none.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// Names of the axes that they correct; all linear axes if there are none.
    #[serde(default)]
    pub outputs: Vec<String>,
}

/// The rules of a table that corrects several axes as a function of several positions.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatticeRules {
    /// Those of every mechanism.
    #[serde(flatten)]
    pub table: TableRules,
    /// Names of the axes that span it; all axes, or those asked for, if there are none.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// Names of the axes that it corrects; all that can be if there are none.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// True if rotary axes can be corrected.
    #[serde(default)]
    pub corrects_rotary: bool,
}

fn no_limit() -> usize {
    usize::MAX
}

fn one_turn() -> (f64, f64) {
    (0.0, 360.0)
}

fn yes() -> bool {
    true
}

impl Directions {
    /// True if tables hold a value for each direction.
    pub fn is_bidirectional(self) -> bool {
        self != Self::Mean
    }
}

impl TableRules {
    fn max_magnification(&self) -> u32 {
        if let Encoding::Magnified(max) = self.encoding { max } else { 1 }
    }

    /// Returns the smallest magnification that `does` accepts, or else the largest there is.
    fn min_magnification(&self, does: impl Fn(f64) -> bool) -> f64 {
        let max = self.max_magnification();
        if max <= 1 {
            return 1.0;
        }
        (1..=max).map(f64::from).find(|times| does(*times)).unwrap_or(f64::from(max))
    }

    /// Rounds a lattice to its stored numbers, with the smallest magnification that brings all within the range.
    fn magnify(&self, machine: &Machine, table: &mut CorrectionTable) {
        let decimals = self.increment.correction_decimals;
        let (scales, width) = (self.scales(machine, table), table.corrected.len());
        let within = |number: f64| self.largest.is_none_or(|max| number.abs() <= max);
        let stored = |i: usize, c: f64, times: f64| round(c * scales[i % width] / times, decimals);
        let all = |times: f64| table.values.iter().enumerate().all(|(i, c)| within(stored(i, *c, times)));
        let times = self.min_magnification(all);
        let rounded = table.values.iter().enumerate().map(|(i, c)| stored(i, *c, times) * times / scales[i % width]);
        table.values = rounded.collect();
    }

    /// Returns the magnification of a rounded lattice: the smallest with which every number is stored as it is.
    pub fn magnification_of(&self, machine: &Machine, table: &CorrectionTable) -> f64 {
        /// Rounding of a division and a multiplication, in last places.
        const ROUNDING: f64 = 1e-6;
        let last = libm::pow(10.0, f64::from(self.increment.correction_decimals));
        let (scales, width) = (self.scales(machine, table), table.corrected.len());
        let kept = |number: f64, times: f64| {
            let places = number / times * last;
            let within = self.largest.is_none_or(|max| places.abs() <= max * last + ROUNDING);
            within && (places - libm::round(places)).abs() < ROUNDING
        };
        self.min_magnification(|times| table.values.iter().enumerate().all(|(i, c)| kept(c * scales[i % width], times)))
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
            ("own_axis", self.own_axis.as_ref().map(|own| &own.table)),
            ("cross_axis", self.cross_axis.as_ref().map(|cross| &cross.table)),
            ("plane", self.plane.as_ref().map(|plane| &plane.table)),
            ("product", self.product.as_ref()),
            ("lattice", self.lattice.as_ref().map(|lattice| &lattice.table)),
            ("error_curves", self.error_curves.as_ref()),
        ];
        named.into_iter().filter_map(|(name, rules)| rules.map(|rules| (name, rules)))
    }

    fn tables_mut(&mut self) -> impl Iterator<Item = &mut TableRules> {
        let own = self.own_axis.as_mut().map(|own| &mut own.table);
        let cross = self.cross_axis.as_mut().map(|cross| &mut cross.table);
        let plane = self.plane.as_mut().map(|plane| &mut plane.table);
        let lattice = self.lattice.as_mut().map(|lattice| &mut lattice.table);
        [own, cross, plane, self.product.as_mut(), lattice].into_iter().flatten()
    }

    /// Gives stored numbers another sign; commands stay commands, and tables beside a module keep their own.
    pub fn store(&mut self, stored: Stored) {
        if self.kinematics.is_some() {
            return;
        }
        for rules in self.tables_mut().filter(|rules| rules.stored != Stored::Command) {
            rules.stored = stored;
        }
    }

    /// Removes the tables of one mechanism. Returns false if there are none of this name, or nothing would remain.
    pub fn leave_out(&mut self, name: &str) -> bool {
        let there = match name {
            "own_axis" => self.own_axis.take().is_some(),
            "cross_axis" => self.cross_axis.take().is_some(),
            "plane" => self.plane.take().is_some(),
            "product" => self.product.take().is_some(),
            _ => false,
        };
        there && (self.iter().next().is_some() || self.kinematics.is_some())
    }

    /// Makes own-axis tables for another purpose.
    pub fn fit(&mut self, fit: Fit) {
        self.own_axis.iter_mut().for_each(|own| own.table.fit = fit);
        self.cross_axis.iter_mut().for_each(|cross| cross.table.fit = fit);
    }

    /// The scale of drives that own-axis lines are stored as, if they are.
    pub fn scale(&self) -> Option<DriveScale> {
        self.own_axis.as_ref().and_then(|own| own.scale)
    }

    /// True for the scale of a drive.
    pub fn is_scale(&self, table: &CorrectionTable) -> bool {
        self.scale().is_some() && table.is_own_axis()
    }

    /// The scale in force of an axis, if it is known.
    pub(super) fn scale_in_force(&self, machine: &Machine, axis: usize) -> Option<f64> {
        let known = &self.own_axis.as_ref()?.in_force;
        known.iter().find(|(name, _)| *name == machine.axes()[axis].name.as_str()).map(|(_, value)| *value)
    }

    /// The mechanism by which an axis corrects itself: own-axis tables, or cross tables that may do so.
    fn own(&self) -> Option<(&'static str, &TableRules)> {
        let cross = || self.cross_axis.as_ref().filter(|cross| cross.own).map(|cross| ("cross_axis", &cross.table));
        self.own_axis.as_ref().map(|own| ("own_axis", &own.table)).or_else(cross)
    }

    /// Rules of the tables by which an axis corrects itself.
    pub fn own_rules(&self) -> Option<&TableRules> {
        self.own().map(|(_, rules)| rules)
    }

    fn mechanism(&self, table: &CorrectionTable) -> Option<(&'static str, &TableRules)> {
        let plane = || self.plane.as_ref().map(|plane| ("plane", &plane.table));
        let narrow = match (table.axes.len(), table.corrected.len()) {
            (1, 1) if table.is_own_axis() => self.own(),
            (1, 1) => self.cross_axis.as_ref().map(|cross| ("cross_axis", &cross.table)),
            (2, 1) => plane().or_else(|| self.product.as_ref().map(|product| ("product", product))),
            _ => None,
        };
        narrow.or_else(|| self.lattice.as_ref().map(|lattice| ("lattice", &lattice.table)))
    }

    /// Returns the name of the mechanism whose table this is.
    pub fn name_of(&self, table: &CorrectionTable) -> Option<&'static str> {
        self.mechanism(table).map(|(name, _)| name)
    }

    /// Returns the rules of the mechanism that a table belongs to.
    pub fn rules(&self, table: &CorrectionTable) -> Option<&TableRules> {
        self.mechanism(table).map(|(_, rules)| rules)
    }

    /// Returns the lattice of a set that is one over whatever axes were asked for.
    pub fn free_lattice<'a>(&self, tables: &'a CorrectionTables) -> Option<&'a CorrectionTable> {
        let free = self.lattice.as_ref().is_some_and(|rules| rules.inputs.is_empty());
        match &tables.tables[..] {
            [lattice] if free => Some(lattice),
            _ => None,
        }
    }

    /// True if a table is written as products.
    pub fn is_product(&self, table: &CorrectionTable) -> bool {
        self.plane.is_none() && self.product.is_some() && (table.axes.len(), table.corrected.len()) == (2, 1)
    }

    /// Returns the number of the controller's tables that a table takes.
    pub fn count(&self, table: &CorrectionTable) -> usize {
        table.count(self.rules(table).is_some_and(|rules| rules.directions == Directions::TwoTables))
    }

    /// Rounds every stored number. Where the controller multiplies tables these are the factors.
    pub fn round(&self, machine: &Machine, tables: &mut CorrectionTables) {
        for table in &mut tables.tables {
            if let Some(rules) = self.rules(table).filter(|rules| rules.max_magnification() > 1) {
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
            let factors = self.is_product(table) || self.is_scale(table);
            self.rules(table).filter(|_| !factors).map(|rules| &rules.increment)
        });
        let in_force: BTreeMap<usize, f64> = tables.scales.iter().copied().collect();
        for table in tables.tables.iter_mut().filter(|table| self.is_scale(table)) {
            let (Some(own), Some(was)) = (&self.own_axis, in_force.get(&table.axes[0])) else { continue };
            let Some(scale) = own.scale else { continue };
            let decimals = own.table.increment.correction_decimals;
            let stored = round(scale.stored(*was, table.slope_of_line()), decimals);
            table.set_slope_of_line(scale.slope(*was, stored));
        }
        let Some(rules) = &self.error_curves else { return };
        for curve in &mut tables.errors {
            let direction = curve.error.direction;
            curve.values.iter_mut().for_each(|value| *value = rules.increment.error(*value, direction));
        }
    }
}
