//! Pictures of `abbe map`: a plane of two linear axes.

use super::session::Session;
use crate::analysis::{Plane, View, rest};
use crate::cli::poses::{check, pose_at};
use crate::cli::store::write::{PictureKind, write_picture};
use crate::cli::{Exit, Outcome};
use crate::evaluate::{Field, Order};
use crate::machine::{AxisKind, Machine};
use crate::report::{Picture, PlanePicture, PlaneQuantity, PlaneStyle, before_after};
use std::path::PathBuf;

/// What to draw.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Pictures {
    /// Draw the error over a plane of two linear axes.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// The same as PNG.
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// How: a map of colours with arrows, or the deformed grid; `before-after` is a map of both states and of
    /// what is left (with `--target`).
    #[arg(long, value_enum, default_value = "colours")]
    drawing: DrawingArg,
    /// The two linear axes of the picture, such as XY or X,Z [default: the first two].
    #[arg(long, value_name = "AXES")]
    plane: Option<String>,
    /// Where the other axes are for the picture [default: 0, or the end of the travel nearest to it].
    #[arg(long, value_name = "Z=-100,A=30", allow_hyphen_values = true)]
    at: Option<String>,
    /// What the colours of the picture show.
    #[arg(long, value_enum, default_value = "length")]
    component: ComponentArg,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum DrawingArg {
    Colours,
    Grid,
    BeforeAfter,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum ComponentArg {
    Length,
    Dx,
    Dy,
    Dz,
}

impl From<ComponentArg> for PlaneQuantity {
    fn from(arg: ComponentArg) -> Self {
        match arg {
            ComponentArg::Length => Self::Length,
            ComponentArg::Dx => Self::Component(0),
            ComponentArg::Dy => Self::Component(1),
            ComponentArg::Dz => Self::Component(2),
        }
    }
}

/// A plane that can be drawn, and where the other axes are.
pub(crate) struct Place {
    axes: [usize; 2],
    at: Vec<f64>,
}

/// A field, and what its picture says of it.
pub(crate) struct Subject<'a> {
    /// The field.
    pub field: &'a dyn Field,
    /// After which compensation; empty without.
    pub state: &'a str,
}

impl Pictures {
    /// Where they go.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.svg.iter().chain(&self.png)
    }

    /// Refuses what cannot be drawn, before any work; `None` if nothing is asked for.
    pub(crate) fn place(
        &self,
        session: &mut Session,
        machine: &Machine,
        compensated: bool,
    ) -> Result<Option<Place>, Exit> {
        if self.svg.is_none() && self.png.is_none() {
            let asked = self.plane.is_some() || self.at.is_some() || self.drawing != DrawingArg::Colours;
            return if asked {
                session.usage("`--plane`, `--at` and `--drawing` are for a picture: add `--svg FILE` or `--png FILE`")
            } else {
                Ok(None)
            };
        }
        if self.drawing == DrawingArg::BeforeAfter && !compensated {
            return session
                .usage("`--drawing before-after` needs the compensation of a controller: add `--target NAME`");
        }
        let axes = plane_axes(machine, self.plane.as_deref()).or_else(|message| session.usage(&message))?;
        let at = match &self.at {
            Some(text) => pose_at(machine, text).or_else(|message| session.usage(&message))?,
            None => rest(machine),
        };
        let mut shown = at.clone();
        // The two axes of the plane run over the volume, wherever `--at` puts them.
        axes.iter().for_each(|i| shown[*i] = machine.volume()[*i].min);
        check(session, machine, std::slice::from_ref(&shown))?;
        Ok(Some(Place { axes, at }))
    }

    /// Draws and writes; `before` is the machine without compensation, if `subject` is one with.
    pub(crate) fn write(
        &self,
        session: &mut Session,
        place: &Place,
        (subject, before): (&Subject<'_>, Option<&dyn Field>),
        (view, order): (View, Order),
    ) -> Outcome {
        let machine = subject.field.machine();
        let of = |field| Plane::of(field, place.axes, &place.at, nodes(machine, place.axes), view);
        let plane = of(subject.field);
        let drawn = if self.drawing == DrawingArg::Grid { PlaneStyle::Grid } else { PlaneStyle::Colours };
        let shown = self.component.into();
        let one = PlanePicture { machine, plane: &plane, view, order, shown, drawn, state: subject.state, like: None };
        let picture = match before.filter(|_| self.drawing == DrawingArg::BeforeAfter).map(of) {
            Some(before) => before_after(&PlanePicture { plane: &before, state: "uncompensated", ..one }, &one),
            None => one.picture(),
        };
        self.files(session, &picture)
    }

    fn files(&self, session: &mut Session, picture: &Picture) -> Outcome {
        for (path, kind) in [(&self.svg, PictureKind::Svg), (&self.png, PictureKind::Png)] {
            if let Some(path) = path {
                write_picture(path, picture, kind, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
            }
        }
        Ok(())
    }
}

/// `XY`, or `X,Y2` where names are longer; two different linear axes with room to move.
fn plane_axes(machine: &Machine, text: Option<&str>) -> Result<[usize; 2], String> {
    let moves =
        |i: &usize| machine.axes()[*i].kind == AxisKind::Linear && machine.volume()[*i].max > machine.volume()[*i].min;
    let mut linear: Vec<usize> = (0..machine.axes().len()).filter(moves).collect();
    linear.sort_by(|a, b| machine.axes()[*a].name.cmp(&machine.axes()[*b].name));
    let known: Vec<&str> = linear.iter().map(|i| machine.axes()[*i].name.as_str()).collect();
    let known = known.join(", ");
    let Some(text) = text else {
        return if let [a, b, ..] = linear[..] {
            Ok([a, b])
        } else {
            Err("the machine has no two linear axes to draw a plane of".to_owned())
        };
    };
    let names: Vec<String> = match text.split_once(',') {
        Some((a, b)) => vec![a.trim().to_owned(), b.trim().to_owned()],
        None => text.chars().map(String::from).collect(),
    };
    let index = |name: &String| linear.iter().copied().find(|i| machine.axes()[*i].name.as_str() == name);
    match names.iter().map(index).collect::<Option<Vec<_>>>().as_deref() {
        Some([a, b]) if a != b => Ok([*a, *b]),
        _ => Err(format!("`--plane {text}` is not two different linear axes of {known}, such as `XY` or `X,Z`")),
    }
}

/// About square cells, 72 along the longer side.
fn nodes(machine: &Machine, axes: [usize; 2]) -> [usize; 2] {
    let spans = axes.map(|i| machine.volume()[i].max - machine.volume()[i].min);
    let longest = spans[0].max(spans[1]);
    spans.map(|span| 1 + (72.0 * span / longest).round().max(2.0) as usize)
}
