//! Options that several verbs have, each defined once: name, meaning, range and, but for `EFFORT`, default.
//!
//! The short help of a name is the same in every verb; what differs between verbs is in the long help. The test in
//! `option_table` walks all verbs.

use super::Outcome;
use super::output::session::Session;
use super::output::view::order;
use super::store::write::{PictureKind, refuse_outputs, write_picture};
use abbe::options::{Approach, Frame, Order, ProbeSizes, Reference, Stylus};
use abbe::results::Picture;
use abbe::text::{Reason, parse_length, shown};
use clap::builder::RangedI64ValueParser;
use std::convert::Infallible;
use std::ops::RangeBounds;
use std::path::PathBuf;

/// Help of the options whose type or default is not the same in all verbs.
pub(super) mod help {
    pub(in crate::cli) const AT: &str = "A pose, such as X=100,C=90, mm and deg";
    pub(in crate::cli) const AXIS: &str = "An axis, by its name";
    pub(in crate::cli) const AXIS_POSES: &str =
        "Poses of the axes from a CSV file: header of axis names, one pose a line, mm and deg";
    pub(in crate::cli) const DATA: &str = "Measurements: CSV with a column per axis and `dx [um]`, `dy [um]`, \
         `dz [um]`, or lengths, ball readings, lines, single errors (docs/identify/measure.md); of `verify` taken with \
         the set in force";
    pub(in crate::cli) const TYPE_B: &str = "A standard uncertainty that all readings share: `laser 0.4 um/m`, \
         `set-up 2 um`, `material 0.5 K x 11.7 um/m/K`. May be repeated";
    pub(in crate::cli) const OUT: &str =
        "Write the result here: a file, of `compile`, `measure`, `record` and `testpiece` a folder";
    pub(in crate::cli) const ACCEPT: &str = "Take on your word what is refused or left out: `suspect` takes readings \
                                             that accuse themselves; of `identify` `undetermined` what the data do not \
                                             determine";
    pub(in crate::cli) const PLANE: &str = "A plane of two axes, such as XY";
    pub(in crate::cli) const RADIUS: &str = "Radius of a circle, mm (above 0)";
    pub(in crate::cli) const VTK: &str = "Write a grid of VTK, which ParaView opens";
    pub(in crate::cli) const PNG: &str = "Draw a picture, as PNG unless the file ends in .svg";
    pub(in crate::cli) const SVG: &str = "Draw a picture, as SVG unless the file ends in .png";
    pub(in crate::cli) const TARGET: &str = "The controller; `abbe targets` lists them";
}

/// Options whose default is a matter of the verb's effort.
#[cfg(test)]
pub(super) const EFFORT: [&str; 2] = ["poses", "samples"];

/// A length in mm that fits; `remedy` is the message for another.
pub(super) fn length(text: &str, fits: impl Fn(f64) -> bool, remedy: &str) -> Result<f64, Reason> {
    let length = parse_length(text).map_err(Reason::new)?;
    length.filter(|mm| fits(*mm)).ok_or_else(|| Reason::new(remedy))
}

/// Parser of a count within a range.
pub(super) fn counts(range: impl RangeBounds<i64>) -> RangedI64ValueParser<usize> {
    RangedI64ValueParser::new().range(range)
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct ToolArg {
    /// Tool of the machine, by name [default: the first].
    #[arg(long, value_name = "NAME")]
    tool: Option<String>,
}

impl ToolArg {
    pub(super) fn name(&self) -> Option<&str> {
        self.tool.as_deref()
    }
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct SeedArg {
    /// Seed of all that is drawn at random, poses and errors (0 or more).
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct PosesArg {
    /// Number of poses (1 to 1000000).
    #[arg(long, value_name = "N", default_value_t = 1000,
        value_parser = counts(1..=1_000_000))]
    pub(super) poses: usize,
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct ToolPosesArg {
    /// Take the poses from the tool poses of a file: APT CL data, or a table with columns X, Y, Z and I, J, K or rotary
    /// axes, workpiece frame.
    #[arg(long, value_name = "FILE")]
    pub(super) tool_poses: Option<PathBuf>,
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct AxisPosesArg {
    #[arg(long, value_name = "FILE", help = help::AXIS_POSES)]
    pub(super) axis_poses: Option<PathBuf>,
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct JobArg {
    /// Take poses and reference from a job: a YAML file with `tool_poses`, `place`, `reference`.
    #[arg(long, value_name = "FILE")]
    pub(super) job: Option<PathBuf>,
    /// Take the tool poses as one continuous path, with what it asks of the axes [default: what the job says, or else
    /// yes for CL data, no for tables].
    #[arg(long, value_name = "yes|no", value_parser = yes_or_no)]
    pub(super) path: Option<bool>,
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct PlaceArg {
    /// Try the part of the job at places: ranges of its origin X, Y, Z (mm) and its rotation A, B, C (deg), with the
    /// number of values.
    #[arg(long, value_name = "X=-200..200:9,C=0..90:4", allow_hyphen_values = true)]
    pub(super) place: Option<String>,
}

fn yes_or_no(text: &str) -> Result<bool, Reason> {
    match text {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err(Reason::new("the answer is `yes` or `no`")),
    }
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct ReferenceArg {
    /// What the set-up of the part takes out: machine (nothing), zero, zero:X,Y,Z (mm), best-fit,
    /// best-fit:minimum-zone, machine-less-unheld, or a datum. A datum has six points and normals,
    /// datum:X,Y,Z,I,J,K:... [default: zero for tool poses, machine-less-unheld otherwise].
    #[arg(long, value_name = "REFERENCE", allow_hyphen_values = true)]
    pub(super) reference: Option<Reference>,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct SamplesArg {
    /// Number of machines to draw where errors are bounded (2 to 100000).
    #[arg(long, value_name = "N", default_value_t = 1000,
        value_parser = counts(2..=100_000))]
    pub(super) samples: usize,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct MaxSamplesArg {
    /// Maximum number of machines to draw, until they are told apart (2 to 800000) [default: 8 times --samples].
    #[arg(long, value_name = "N", value_parser = counts(2..=800_000))]
    pub(super) max_samples: Option<usize>,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct TopArg {
    /// Number of rows to list as text (0 to 100000).
    #[arg(long, value_name = "K", default_value_t = 12,
        value_parser = counts(0..=100_000))]
    pub(super) top: usize,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct OrderArg {
    /// Order of the model in the errors, 1 to 6 or `exact` [default: exact, unless the conventions' preset names an
    /// order; of `equations` 1].
    #[arg(long, value_name = "N|exact", value_parser = order)]
    pub(super) order: Option<Order>,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct DirectionArg {
    /// Direction of approach where forward and reverse curves were given.
    #[arg(long, value_enum, default_value = "mean")]
    pub(super) direction: Approach,
}

#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct FrameOption {
    /// Frame of the vectors.
    #[arg(long, value_enum, default_value = "workpiece")]
    pub(super) frame: Frame,
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct AlgebraArg {
    /// Take the errors over a Weil algebra: the machine file's, or one in the words of its section `algebra`, such as
    /// `degree: 3, generators: per-axis, vanish: [x1^2, x3*x4]`.
    #[arg(long, value_name = "ALGEBRA", num_args = 0..=1, default_missing_value = "", conflicts_with = "order")]
    pub(super) algebra: Option<String>,
}

#[derive(Debug, Clone, clap::Args)]
pub(super) struct InstalledArg {
    /// The compensation files that were in force when the machine was measured.
    #[arg(long, value_name = "DIR")]
    pub(super) installed: Option<PathBuf>,
    /// Largest distance of an axis in force from that of the machine file (above 0) [default: 1 mm].
    #[arg(long, value_name = "LENGTH", requires = "installed", value_parser = max_change)]
    pub(super) max_change: Option<f64>,
}

fn max_change(text: &str) -> Result<f64, Reason> {
    length(text, |mm| mm > 0.0 && mm <= MAX_NOISE_MM, "write a length above zero and up to 1 m, such as `5 mm`")
}

/// Scatter of readings.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct NoiseArg {
    /// Standard deviation of a reading that does not state its own (above 0) [default: 1 um to plan with, otherwise
    /// that of repeated readings].
    #[arg(long, value_name = "LENGTH", value_parser = noise)]
    pub(super) noise: Option<f64>,
}

/// Largest noise of a reading that is believed, mm.
const MAX_NOISE_MM: f64 = 1000.0;

/// A length above zero, such as `2 um`.
fn noise(text: &str) -> Result<f64, Reason> {
    length(text, |mm| mm > 0.0 && mm <= MAX_NOISE_MM, "write a length above zero and up to 1 m, such as `2 um`")
}

/// Work in parts.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct PartsArgs {
    /// Keep results here; what is there already is not computed again.
    #[arg(long, value_name = "FILE")]
    pub(super) state: Option<PathBuf>,
    /// Compute only this part of the work, into the state file.
    #[arg(long, value_name = "I/N", requires = "state", value_parser = part)]
    pub(super) shard: Option<(usize, usize)>,
    /// Put the work together from state files.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub(super) merge: Vec<PathBuf>,
}

/// `2/3`: the second of three parts.
fn part(text: &str) -> Result<(usize, usize), Reason> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    numbers.filter(|(i, n)| (1..=*n).contains(i)).ok_or_else(|| Reason::new("this is not a part such as `2/3`"))
}

/// A file for a picture, in the form that its ending names.
#[derive(Debug, Clone)]
pub(super) struct PictureFile {
    path: PathBuf,
    /// None for an ending that is no picture's.
    kind: Option<PictureKind>,
}

impl PictureFile {
    fn new(text: &str, without_ending: PictureKind) -> Self {
        let path = PathBuf::from(text);
        let kind = PictureKind::of(&path).or_else(|| path.extension().is_none().then_some(without_ending));
        Self { path, kind }
    }

    pub(super) fn path(&self) -> &PathBuf {
        &self.path
    }

    #[cfg(test)]
    pub(super) fn kind(&self) -> Option<PictureKind> {
        self.kind
    }

    /// Refuses outputs over inputs, and files whose ending is no picture's: before any work.
    pub(super) fn refuse<'a>(session: &mut Session, files: impl Iterator<Item = &'a Self> + Clone) -> Outcome {
        refuse_outputs(files.clone().map(Self::path), &session.files).or_else(|d| session.refuse(d))?;
        Self::refuse_unknown(session, files)
    }

    /// Refuses files whose ending is no picture's.
    pub(super) fn refuse_unknown<'a>(session: &Session, mut files: impl Iterator<Item = &'a Self>) -> Outcome {
        let Some(unknown) = files.find(|file| file.kind.is_none()) else { return Ok(()) };
        session.usage(&format!(
            "`{}` is no picture: pictures are SVG or PNG, name a file that ends in .svg or .png",
            shown(&unknown.path.display().to_string())
        ))
    }

    /// Writes the picture.
    pub(super) fn write(&self, picture: &Picture, session: &mut Session) -> Outcome {
        let kind = self.kind.unwrap_or(PictureKind::Svg);
        write_picture(&self.path, picture, kind, &session.files).or_else(|d| session.refuse(d))
    }
}

/// A picture that is SVG, unless the file's ending says otherwise.
pub(super) fn svg(text: &str) -> Result<PictureFile, Infallible> {
    Ok(PictureFile::new(text, PictureKind::Svg))
}

/// A picture that is PNG, unless the file's ending says otherwise.
pub(super) fn png(text: &str) -> Result<PictureFile, Infallible> {
    Ok(PictureFile::new(text, PictureKind::Png))
}

/// A share in percent.
pub(super) fn percent(text: &str) -> Result<f64, Reason> {
    let share = text.parse::<f64>().ok().filter(|share| (0.0..=100.0).contains(share));
    share.ok_or_else(|| Reason::new("a share is a number from 0 to 100, in percent"))
}

/// Options of the evaluation and of its tool.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(super) order: OrderArg,
    #[command(flatten)]
    pub(super) direction: DirectionArg,
    #[command(flatten)]
    pub(super) tool: ToolArg,
}

/// Sizes of a touch probe and of the balls that it touches.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ProbeArgs {
    /// Radius of the balls (above 0).
    #[arg(long, value_name = "LENGTH", value_parser = size, default_value = "12.5 mm")]
    ball_radius: f64,
    /// The stylus: radius of its ball, length from there to the body of the probe, radius of the shaft, and of the
    /// body.
    #[arg(long, value_name = "LENGTHS", value_parser = stylus, default_value = "3 mm, 50 mm, 2 mm, 20 mm")]
    stylus: Stylus,
    /// Radius of the stems of the balls, along -Z of the workpiece (above 0) [default: half that of the balls].
    #[arg(long, value_name = "LENGTH", value_parser = size)]
    stem: Option<f64>,
    /// Distance that a ball may be away from its place (above 0).
    #[arg(long, value_name = "LENGTH", value_parser = size, default_value = "1 mm")]
    ball_within: f64,
}

impl ProbeArgs {
    pub(super) fn sizes(&self) -> ProbeSizes {
        let Self { ball_radius, stylus, stem, ball_within } = *self;
        ProbeSizes { ball_radius_mm: ball_radius, stylus, stem_mm: stem, within_mm: ball_within }
    }
}

fn size(text: &str) -> Result<f64, Reason> {
    length(text, |mm| mm > 0.0 && mm <= 1000.0, "write a length above zero and up to 1 m, such as `12.5 mm`")
}

fn stylus(text: &str) -> Result<Stylus, Reason> {
    let lengths = text.split(',').map(|part| size(part.trim())).collect::<Result<Vec<_>, _>>()?;
    let [radius, length, shaft, body] = lengths[..] else {
        return Err(Reason::new("write four lengths, such as `3 mm, 50 mm, 2 mm, 20 mm`"));
    };
    Ok(Stylus { radius, length, shaft, body })
}
