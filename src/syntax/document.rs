//! The content of a machine file, section by section, before anything is judged.

use super::entry::entry;
use super::forms::{Forms, deserialize_by_forms};
use super::geometry::{Branches, PositionEntry, SideEntry, TravelEntry, WrittenChains};
use super::job_text::{JobText, TOOL_POSES};
use super::layer::Layer;
use super::places::{Keys, Places, below, keys};
use super::scalar::Scalar;
use super::term::TermEntry;
use super::tolerance::{BoundEntry, ClassEntry};
use crate::diagnostic::{Diagnostic, Diagnostics, codes, did_you_mean, shown};
use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, MapAccess};
use serde_yaml::{Mapping, Value};

/// Named entries in the order of the file; `None` where the entry as a whole was refused.
pub type Entries<T> = IndexMap<String, Option<T>>;

/// A machine file with what it extends, merged. Entries that did not fit are reported and absent.
#[derive(Debug, Clone, Default)]
pub struct Document {
    /// Version of the language.
    pub abbe: Option<Scalar>,
    /// The machine's name.
    pub machine: Option<String>,
    /// The walk from workpiece to tool.
    pub chain: Option<String>,
    /// The same as two lists from the bed outwards.
    pub branches: Option<Branches>,
    /// Axes by name.
    pub axes: Entries<AxisEntry>,
    /// The only tool.
    pub tool: Option<ToolEntry>,
    /// Tools by name.
    pub tools: Entries<ToolEntry>,
    /// The workpiece.
    pub workpiece: Option<WorkpieceEntry>,
    /// Conventions that differ from the defaults.
    pub conventions: Option<ConventionsEntry>,
    /// Error terms by name as written.
    pub errors: Entries<TermEntry>,
    /// Bounds of errors, of axes and of squareness.
    pub tolerances: Entries<BoundEntry>,
    /// The class that bounds everything else.
    pub class: Option<ClassEntry>,
    /// Joint covariance of the errors' values, a column of a factor for each entry.
    pub covariance: Vec<CovarianceEntry>,
    /// Tables of which every error column counts.
    pub measured: Vec<String>,
    /// Intervals and steps of maps and tables.
    pub volume: IndexMap<String, VolumeAxis>,
    /// The origin of the numbers.
    pub provenance: IndexMap<String, Scalar>,
    /// Errors of clamping.
    pub setup: Option<SetUpEntry>,
    /// The algebra that symbolic stages work in.
    pub algebra: Option<AlgebraEntry>,
    /// The parameters that `identify` fits.
    pub identify: Option<IdentifyEntry>,
    /// The job that the machine is judged on, before its form is judged: see [`JobText`].
    pub job: Option<JobText>,
    /// Upwards in the picture, in machine coordinates.
    pub up: Option<Vec<Scalar>>,
    /// Meshes by the body that they are drawn for.
    pub look: Entries<MeshEntry>,
    /// The places of all entries.
    pub places: Places,
    /// The chains under which the geometry of axes was written.
    pub chains: WrittenChains,
    /// Gauge points of bases that variants displace, by the entry that has another one.
    pub moved_gauges: Vec<(Keys, [Scalar; 3])>,
}

/// An axis.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AxisEntry {
    /// `linear` or `rotary`; follows from the letter.
    #[schemars(schema_with = "super::schema_forms::kind")]
    pub kind: Option<String>,
    /// The direction of positive motion; follows from the letter.
    #[schemars(schema_with = "super::schema_forms::direction")]
    pub direction: Option<Vec<Scalar>>,
    /// A point of the axis (mm).
    #[schemars(schema_with = "super::schema_forms::position_entry")]
    pub origin: Option<PositionEntry>,
    /// Its travel.
    #[schemars(schema_with = "super::schema_forms::travel")]
    pub travel: Option<TravelEntry>,
    /// `iso841` or `direct`.
    #[schemars(schema_with = "super::schema_forms::sense")]
    pub sense: Option<String>,
    /// Its letter or number in the controller, or both.
    #[schemars(schema_with = "super::schema_forms::controller_axis")]
    pub controller: Option<ControllerEntry>,
    /// The position at which the control homes it.
    #[schemars(schema_with = "super::schema_forms::home")]
    pub home: Option<Scalar>,
    /// Beyond the points of its curves, where they stop short of the travel: `hold` (default), `slope` or `refuse`.
    #[schemars(schema_with = "super::schema_forms::beyond")]
    pub beyond: Option<String>,
    /// Geometry and errors when it carries the tool, over the plain keys.
    pub on_tool: Option<SideEntry>,
    /// Geometry and errors when it carries the workpiece, over the plain keys.
    pub on_workpiece: Option<SideEntry>,
}

/// A letter or a number, or both.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerEntry {
    /// One of them.
    One(Scalar),
    /// Both.
    Both(Vec<Scalar>),
}

/// A tool: `gauge` and either `length` or `offset`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ToolEntry {
    /// Gauge point in machine coordinates at the zero pose.
    #[schemars(schema_with = "super::schema_forms::point")]
    pub gauge: Option<Vec<Scalar>>,
    /// The tip is this far from it, against the tool axis.
    #[schemars(schema_with = "super::schema_forms::length")]
    pub length: Option<Scalar>,
    /// Or the tip's coordinates relative to it.
    #[schemars(schema_with = "super::schema_forms::point")]
    pub offset: Option<Vec<Scalar>>,
    /// The tool axis, from the tip towards the spindle; default [0, 0, 1].
    #[schemars(schema_with = "super::schema_forms::direction")]
    pub direction: Option<Vec<Scalar>>,
}

/// The workpiece.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WorkpieceEntry {
    /// Its origin in machine coordinates at the zero pose.
    #[schemars(schema_with = "super::schema_forms::position_entry")]
    pub origin: Option<PositionEntry>,
    /// Rotation of its coordinates, deg: by A, then B, then C about X, Y, Z of the machine.
    #[schemars(schema_with = "super::schema_forms::workpiece_rotation")]
    pub rotation: IndexMap<String, Scalar>,
}

/// The mesh of a body: its file, or that with what places it.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MeshFields {
    /// Path of an STL, OBJ or glTF file, from the folder of this file.
    #[schemars(schema_with = "super::schema_forms::path")]
    pub mesh: Option<String>,
    /// Unit of its coordinates; mm for STL and OBJ, m for glTF by default.
    #[schemars(schema_with = "super::schema_forms::unit_of_length")]
    pub unit: Option<String>,
    /// Place of its origin in machine coordinates at the zero pose; of `workpiece` in the workpiece frame.
    #[schemars(schema_with = "super::schema_forms::point")]
    pub origin: Option<Vec<Scalar>>,
    /// Its rotation, deg: by A, then B, then C about X, Y, Z.
    #[schemars(schema_with = "super::schema_forms::workpiece_rotation")]
    pub rotation: IndexMap<String, Scalar>,
}

/// `ram.stl` is short for `{ mesh: ram.stl }`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshEntry(MeshFields);

impl std::ops::Deref for MeshEntry {
    type Target = MeshFields;

    fn deref(&self) -> &MeshFields {
        &self.0
    }
}

/// Conventions: the name of a preset, single choices, or both.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ConventionsEntry {
    /// Name of a preset.
    #[schemars(schema_with = "super::schema_forms::preset")]
    pub preset: Option<String>,
    /// The action of location errors.
    #[schemars(schema_with = "super::schema_forms::location")]
    pub location: Option<String>,
    /// Component errors of linear axes.
    #[schemars(schema_with = "super::schema_forms::linear_order")]
    pub linear: Option<String>,
    /// Component errors of rotary axes.
    #[schemars(schema_with = "super::schema_forms::rotary_order")]
    pub rotary: Option<String>,
    /// Sense of workpiece-side axes.
    #[schemars(schema_with = "super::schema_forms::sense")]
    pub workpiece_axes: Option<String>,
    /// Whose errors those of workpiece-side axes are.
    #[schemars(schema_with = "super::schema_forms::errors_are")]
    pub errors_are: Option<String>,
    /// Order of location errors.
    #[schemars(schema_with = "super::schema_forms::location_order")]
    pub location_order: Option<String>,
    /// Shape of error matrices.
    #[schemars(schema_with = "super::schema_forms::joints")]
    pub joints: Option<String>,
}

/// An entry of `volume`: the global step, an interval, or both for one axis.
#[derive(Debug, Clone, PartialEq)]
pub enum VolumeAxis {
    /// Under the key `step`.
    Step(Scalar),
    /// Interval and step of an axis.
    Axis {
        /// Lower and upper end.
        range: Option<Vec<Scalar>>,
        /// Largest distance of two nodes.
        step: Option<Scalar>,
    },
}

/// Errors of clamping by direction.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SetUpEntry {
    /// Displacement of the tip: X, Y, Z.
    #[schemars(schema_with = "super::schema_forms::tool_setup")]
    pub tool: IndexMap<String, Scalar>,
    /// Displacement of the workpiece: X, Y, Z, A, B, C.
    #[schemars(schema_with = "super::schema_forms::workpiece_setup")]
    pub workpiece: IndexMap<String, Scalar>,
}

/// Errors that vary together: one standard uncertainty of an independent part, written like the errors themselves.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CovarianceEntry {
    /// Parts of errors by name.
    #[schemars(schema_with = "super::schema_errors::errors_entry")]
    pub errors: IndexMap<String, TermEntry>,
    /// Parts of set-up errors.
    pub setup: Option<SetUpEntry>,
    /// The form of an axis that its error curves leave; stands by itself.
    pub form: Option<FormEntry>,
    /// A rigid motion of the workpiece frame that the data do not hold, of any length; stands by itself.
    #[schemars(schema_with = "super::schema_forms::workpiece_setup")]
    pub unheld: IndexMap<String, Scalar>,
    /// Ranges of axes in which fitted curves were measured, where these are less than the travel; stands by itself.
    #[schemars(schema_with = "super::schema_forms::intervals")]
    pub measured: IndexMap<String, Vec<Scalar>>,
}

/// A random form of an axis beside its error curves.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FormEntry {
    /// The axis.
    pub axis: Option<String>,
    /// Standard deviation of its displacement in each direction.
    pub size: Option<Scalar>,
    /// Standard deviation of its rotation about each direction.
    pub rotation: Option<Scalar>,
    /// Standard deviations of single errors instead, such as `EXX: 1 um`; those left out have no form.
    pub errors: IndexMap<String, Scalar>,
    /// Correlation length: a length or, of a rotary axis, an angle.
    pub length: Option<Scalar>,
}

/// The algebra of symbolic stages.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AlgebraEntry {
    /// Highest total degree that is kept.
    #[schemars(schema_with = "super::schema_forms::degree")]
    pub degree: Option<u8>,
    /// One generator for what.
    #[schemars(schema_with = "super::schema_forms::generators")]
    pub generators: Option<GeneratorsEntry>,
    /// Monomials set to zero, such as `EXX*EYX` or `EXX^2`.
    pub vanish: Vec<String>,
}

/// The errors or groups that have a nilpotent generator of their own.
#[derive(Debug, Clone, PartialEq)]
pub enum GeneratorsEntry {
    /// `per-error`, `per-axis` or `single`.
    Word(String),
    /// Groups of error names by generator name.
    Groups(IndexMap<String, Vec<String>>),
}

/// The parameters that `identify` fits.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, serde::Serialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct IdentifyEntry {
    /// Error names and groups.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fit: Vec<String>,
    /// Names that keep their value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fixed: Vec<String>,
    /// Basis by error name: `poly3`, `fourier2`, `spline8`, `bspline8`, `blocks4`; `spline`, `bspline` and `blocks`
    /// with given knots.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    #[schemars(schema_with = "super::schema_forms::bases")]
    pub basis: IndexMap<String, String>,
    /// Positions of knots by error name, for `spline`, `bspline` and `blocks`; the ends of the travel are added.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    #[schemars(schema_with = "super::schema_forms::knots")]
    pub knots: IndexMap<String, Vec<Scalar>>,
    /// Parameters of one's own: for every error that moves with it, the coefficients by rising power of its axis's
    /// position (mm, rad; mm or deg).
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    #[schemars(schema_with = "super::schema_forms::own_parameters")]
    pub parameters: IndexMap<String, IndexMap<String, Vec<Scalar>>>,
    /// Errors that follow others: `EBY: { EBX: -1 }` is EBY = -EBX.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    #[schemars(schema_with = "super::schema_forms::tie_schema")]
    pub tied: IndexMap<String, IndexMap<String, Scalar>>,
    /// Standard deviation of the slope of a fitted curve: `EXX: 20 um/m`.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    #[schemars(schema_with = "super::schema_forms::slopes")]
    pub slopes: IndexMap<String, Scalar>,
    /// Values that are known before the data: `EC0Y 5 urad`, `ball b1 50 um`, `file`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub priors: Vec<String>,
    /// Standard uncertainties that all readings share: `laser 0.4 um/m`, `material 0.5 K x 11.7 um/m/K`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub type_b: Vec<String>,
    /// Sizes up to which errors are plausible, where the readings show larger ones than 10 mm or 100 mrad: a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plausible: Option<PlausibleEntry>,
    /// Reference of the errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub datum: Option<DatumEntry>,
}

/// Largest plausible errors.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, serde::Serialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlausibleEntry {
    /// Of lengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<Scalar>,
    /// Of angles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Scalar>,
}

/// The datum of the errors.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, serde::Serialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DatumEntry {
    /// Reference straight line of the straightness errors of linear axes.
    pub line: DatumLine,
    /// Position at which positioning and angular errors are zero.
    pub zero: DatumZero,
    /// Place of the squareness of the axes.
    pub squareness: SquarenessSite,
}

/// The reference straight line of straightness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DatumLine {
    /// The least-squares line over the travel.
    #[default]
    LeastSquares,
    /// The line through both ends of the travel.
    EndPoints,
    /// None: constants and slopes stay as the data have them.
    Free,
}

/// The position at which errors are zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DatumZero {
    /// The lower end of the travel; 0 deg of an axis without ends.
    #[default]
    Start,
    /// The middle of the travel.
    Middle,
    /// The zero of the axis, or the end of the travel next to it.
    Machine,
    /// None: constants stay as the data have them.
    Free,
}

/// Place of the squareness of the axes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, serde::Serialize, schemars::JsonSchema)]
pub enum SquarenessSite {
    /// In location errors; straightness curves have no slope.
    #[default]
    #[serde(rename = "in location")]
    Location,
    /// In the slopes of straightness curves, read against an artefact of the machine.
    #[serde(rename = "in straightness")]
    Straightness,
}

/// Top-level keys.
pub const SECTIONS: [&str; 23] = [
    "abbe",
    "machine",
    "chain",
    "branches",
    "axes",
    "tool",
    "tools",
    "workpiece",
    "conventions",
    "errors",
    "tolerances",
    "class",
    "covariance",
    "measured",
    "volume",
    "extends",
    "provenance",
    "setup",
    "algebra",
    "identify",
    "job",
    "up",
    "look",
];

/// Takes sections out of the merged tree.
struct SectionReader<'a> {
    map: Mapping,
    places: Places,
    diagnostics: &'a mut Diagnostics,
}

impl SectionReader<'_> {
    fn section<T: DeserializeOwned>(&mut self, key: &str) -> Option<T> {
        let value = self.map.remove(key)?;
        entry(value, &keys([key]), &mut self.places, self.diagnostics)
    }

    /// A section whose entries stand for themselves.
    fn entries<T: DeserializeOwned>(&mut self, key: &str) -> Entries<T> {
        let at = keys([key]);
        match self.map.remove(key) {
            Some(Value::Mapping(map)) => {
                map.into_iter().map(|(name, value)| self.parse_named(&at, name, value)).collect()
            }
            Some(other) => {
                self.places.mar(&at);
                let (is, help) = match other.is_sequence() {
                    true => {
                        (" is a list: it", "omit the `-` in front of each name, or the `[ ]` around them".to_owned())
                    }
                    false => ("", format!("write `{key}:` and below it one indented `NAME: ...` a line")),
                };
                let message = format!("`{key}`{is} must be a mapping of names to entries");
                let refusal = Diagnostic::new(codes::E0202, message);
                self.diagnostics.push(refusal.at(self.places.value(&at), "").help(help));
                Entries::new()
            }
            None => Entries::new(),
        }
    }

    fn parse_named<T: DeserializeOwned>(&mut self, at: &Keys, name: Value, value: Value) -> (String, Option<T>) {
        let name = name.as_str().unwrap_or_default().to_owned();
        let at = below(at, &name);
        let entry = entry(value, &at, &mut self.places, self.diagnostics);
        (name, entry)
    }

    fn unknown(&mut self) {
        for key in self.map.keys().filter_map(Value::as_str) {
            let refusal = Diagnostic::new(codes::E0201, format!("unknown key `{}`", shown(key)));
            let help = match key {
                TOOL_POSES | "place" | "reference" => {
                    "a job: give its file by `--job`, beside a machine file; or indent it below `job:`".to_owned()
                }
                _ => did_you_mean(key, &SECTIONS),
            };
            self.diagnostics.push(refusal.at(self.places.key(&keys([key])), "").help(help));
        }
    }
}

impl Document {
    /// True if an end of a travel is written in inches.
    pub fn is_in_inches(&self) -> bool {
        let travels = self.axes.values().flatten().filter_map(|axis| axis.travel.as_ref());
        travels.into_iter().any(TravelEntry::is_in_inches)
    }

    /// True if an error or its bound is written in inches.
    pub fn has_errors_in_inches(&self) -> bool {
        let values = self.errors.values().flatten().flat_map(|term| [&term.value, &term.tolerance]);
        let figures = self.tolerances.values().flatten().map(BoundEntry::figure);
        let figures = figures.flat_map(|of| of.value.into_iter().chain(of.words.into_iter().map(|(_, value)| value)));
        values.flatten().any(Scalar::is_in_inches) || figures.into_iter().any(|of| of.is_in_inches())
    }

    /// Types every section; what does not fit is reported and left out.
    pub(super) fn from_layer(layer: Layer, diagnostics: &mut Diagnostics) -> Self {
        let mut reader = SectionReader { map: layer.map, places: layer.places, diagnostics };
        let document = Self {
            abbe: reader.section("abbe"),
            machine: reader.section("machine"),
            chain: reader.section::<WalkText>("chain").map(|c| c.0),
            branches: reader.section("branches"),
            axes: reader.entries("axes"),
            tool: reader.section("tool"),
            tools: reader.entries("tools"),
            workpiece: reader.section("workpiece"),
            conventions: reader.section::<PresetOr>("conventions").map(|c| c.0),
            errors: reader.entries("errors"),
            tolerances: reader.entries("tolerances"),
            class: reader.section("class"),
            covariance: reader.section("covariance").unwrap_or_default(),
            measured: reader.section("measured").unwrap_or_default(),
            volume: reader.volume(),
            provenance: reader.section("provenance").unwrap_or_default(),
            setup: reader.section("setup"),
            algebra: reader.section("algebra"),
            identify: reader.section("identify"),
            job: reader.map.remove("job").map(|value| JobText::of_machine(value, reader.places.clone())),
            up: reader.section("up"),
            look: reader.entries("look"),
            places: Places::default(),
            chains: layer.chains,
            moved_gauges: layer.moved_gauges,
        };
        reader.unknown();
        Self { places: reader.places, ..document }
    }
}

impl SectionReader<'_> {
    fn volume(&mut self) -> IndexMap<String, VolumeAxis> {
        let step = match self.map.get_mut("volume") {
            Some(Value::Mapping(map)) => map.remove("step"),
            _ => None,
        };
        let at = keys(["volume", "step"]);
        let step: Option<Scalar> = step.and_then(|value| entry(value, &at, &mut self.places, self.diagnostics));
        let axes = self.entries::<VolumeEntry>("volume");
        let axes = axes.into_iter().filter_map(|(name, axis)| Some((name, axis?.0)));
        axes.chain(step.map(|step| ("step".to_owned(), VolumeAxis::Step(step)))).collect()
    }
}

/// `holub-2015` is short for `{ preset: holub-2015 }`.
struct PresetOr(ConventionsEntry);

/// `[w C' b X Z t]` without quotes is a list to YAML.
struct WalkText(String);

/// `[0, 500]` is short for `{ range: [0, 500] }`.
struct VolumeEntry(VolumeAxis);

#[derive(Default, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct VolumeFields {
    /// Lower and upper end.
    #[schemars(schema_with = "super::schema_forms::interval")]
    range: Option<Vec<Scalar>>,
    /// Largest distance of two nodes.
    #[schemars(schema_with = "super::schema_forms::step")]
    step: Option<Scalar>,
}

impl Forms for VolumeEntry {
    const EXPECTING: &'static str = "[min, max], or a mapping such as { range: [0, 500], step: 10 mm }";

    fn list(range: Vec<Scalar>) -> Option<Self> {
        Some(Self(VolumeAxis::Axis { range: Some(range), step: None }))
    }

    fn map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        let VolumeFields { range, step } = VolumeFields::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Self(VolumeAxis::Axis { range, step }))
    }
}

impl Forms for WalkText {
    const EXPECTING: &'static str = "the walk from workpiece to tool, in quotes";

    fn scalar(walk: Scalar) -> Option<Self> {
        if let Scalar::Text(walk) = walk { Some(Self(walk)) } else { None }
    }

    fn list(words: Vec<Scalar>) -> Option<Self> {
        Some(Self(words.iter().map(Scalar::to_string).collect::<Vec<_>>().join(" ")))
    }
}

impl Forms for PresetOr {
    const EXPECTING: &'static str = "the name of a preset, or a mapping such as { joints: linearised }";

    fn scalar(preset: Scalar) -> Option<Self> {
        Some(Self(ConventionsEntry { preset: Some(preset.to_string()), ..ConventionsEntry::default() }))
    }

    fn map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        ConventionsEntry::deserialize(MapAccessDeserializer::new(map)).map(Self)
    }
}

impl Forms for MeshEntry {
    const EXPECTING: &'static str = "the path of a mesh, or a mapping such as { mesh: ram.stl, unit: m }";

    fn scalar(file: Scalar) -> Option<Self> {
        Some(Self(MeshFields { mesh: Some(file.to_string()), ..MeshFields::default() }))
    }

    fn map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        MeshFields::deserialize(MapAccessDeserializer::new(map)).map(Self)
    }
}

impl Forms for ControllerEntry {
    const EXPECTING: &'static str = "a letter or a number, or both: [A, 6]";

    fn scalar(word: Scalar) -> Option<Self> {
        Some(Self::One(word))
    }

    fn list(words: Vec<Scalar>) -> Option<Self> {
        Some(Self::Both(words))
    }
}

impl Forms for GeneratorsEntry {
    const EXPECTING: &'static str = "per-error, per-axis, single, or a mapping of generators to lists of error names";

    fn scalar(word: Scalar) -> Option<Self> {
        if let Scalar::Text(word) = word { Some(Self::Word(word)) } else { None }
    }

    fn map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        IndexMap::deserialize(MapAccessDeserializer::new(map)).map(Self::Groups)
    }
}

deserialize_by_forms!(VolumeEntry, MeshEntry, PresetOr, WalkText, ControllerEntry, GeneratorsEntry);
