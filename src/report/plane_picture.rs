//! Pictures of a map: the deviation over a plane of two linear axes.

use super::{DrawSettings, Picture, PlanePicture, PlaneQuantity, PlaneStyle, before_after};
use crate::analysis::{Plane, View, rest};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Field, Order};
use crate::job::poses::{check, pose_option};
use crate::machine::{AxisKind, Machine, Pose};
use crate::run::{Call, Refused};

/// A picture of the deviation over a plane of two linear axes.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct PlaneOptions {
    /// Style of the drawing.
    pub drawing: PlaneDrawing,
    /// The two linear axes, such as `XY` or `X,Z`; by default the first two.
    pub plane: Option<String>,
    /// Positions of the other axes, `Z=-100,A=30`: mm and deg; by default at 0, or at the end of the travel nearest to
    /// it.
    pub at: Option<String>,
    /// Quantity that the colours show.
    pub component: PlaneComponent,
}

/// Style of the drawing of a deviation over a plane.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum PlaneDrawing {
    /// A map of colours with arrows.
    #[default]
    Colours,
    /// The deformed grid.
    Grid,
    /// Maps of the error without compensation, with it, and of the residual; for a map with compensation.
    BeforeAfter,
}

/// Quantity that the colours of a map show.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum PlaneComponent {
    /// Length of the deviation.
    #[default]
    Length,
    /// Its component along x.
    Dx,
    /// Its component along y.
    Dy,
    /// Its component along z.
    Dz,
}

impl From<PlaneComponent> for PlaneQuantity {
    fn from(component: PlaneComponent) -> Self {
        match component {
            PlaneComponent::Length => Self::Length,
            PlaneComponent::Dx => Self::Component(0),
            PlaneComponent::Dy => Self::Component(1),
            PlaneComponent::Dz => Self::Component(2),
        }
    }
}

/// A plane that can be drawn, and where the other axes are.
pub(crate) struct PlanePlace {
    axes: [usize; 2],
    at: Vec<f64>,
}

/// A field, and its state in words.
pub(crate) struct Subject<'a> {
    pub field: &'a dyn Field,
    /// The compensation; empty without.
    pub state: &'a str,
    /// The machine without compensation, if the field is one with.
    pub before: Option<&'a dyn Field>,
}

/// A machine of which nothing is measured.
pub(crate) struct BoundedSubject<'a> {
    pub machine: &'a Machine,
    pub view: View,
    /// Drawing of machines from their bounds.
    pub drawing: &'a DrawSettings,
    /// Returns the 95 % value of the deviation at each pose, mm.
    pub p95: &'a dyn Fn(Vec<Pose>) -> Result<Vec<f64>, Refused>,
}

impl PlaneOptions {
    /// As [`Self::place`], for a picture of what bounds lead to.
    pub(crate) fn bounded_place(&self, call: &mut Call, machine: &Machine) -> Result<PlanePlace, Refused> {
        if self.drawing != PlaneDrawing::Colours || self.component != PlaneComponent::Length {
            return call.usage(
                "nothing of the machine is measured, and bounds have no direction: a picture shows the length in \
                 colours; omit `--drawing` and `--component`",
            );
        }
        self.place(call, machine, false)
    }

    /// Returns the picture of the 95 % value of the deviation that bounds lead to.
    pub(crate) fn bounded_picture(&self, place: &PlanePlace, subject: &BoundedSubject<'_>) -> Result<Picture, Refused> {
        let BoundedSubject { machine, view, drawing, p95 } = *subject;
        let plane = Plane::of_lengths(machine, place.axes, &place.at, bounded_nodes(machine, place.axes), p95)?;
        let picture = PlanePicture {
            machine,
            plane: &plane,
            view,
            order: Order::Degree(1),
            shown: PlaneQuantity::Length,
            drawn: PlaneStyle::Colours,
            state: "",
            like: None,
            drawing: Some(drawing),
        };
        Ok(picture.picture())
    }

    /// Refuses a picture that cannot be drawn, before any work.
    pub(crate) fn place(&self, call: &mut Call, machine: &Machine, compensated: bool) -> Result<PlanePlace, Refused> {
        if self.drawing == PlaneDrawing::BeforeAfter && !compensated {
            return call.usage("`--drawing before-after` needs the compensation of a controller: add `--target NAME`");
        }
        let axes = plane_axes(machine, self.plane.as_deref()).or_else(|refusal| call.refuse(refusal))?;
        let at = pose_option(call, machine, self.at.as_ref())?.unwrap_or_else(|| rest(machine));
        let mut shown = at.clone();
        // The two axes of the plane run over the volume, wherever the option puts them.
        axes.iter().for_each(|i| shown[*i] = machine.volume()[*i].min);
        check(call, machine, std::slice::from_ref(&shown))?;
        Ok(PlanePlace { axes, at })
    }

    pub(crate) fn picture(&self, place: &PlanePlace, subject: &Subject<'_>, view: View, order: Order) -> Picture {
        let machine = subject.field.machine();
        let of = |field| Plane::of(field, place.axes, &place.at, nodes(machine, place.axes), view);
        let plane = of(subject.field);
        let drawn = if self.drawing == PlaneDrawing::Grid { PlaneStyle::Grid } else { PlaneStyle::Colours };
        let shown = self.component.into();
        let one = PlanePicture {
            machine,
            plane: &plane,
            view,
            order,
            shown,
            drawn,
            state: subject.state,
            like: None,
            drawing: None,
        };
        match subject.before.filter(|_| self.drawing == PlaneDrawing::BeforeAfter).map(of) {
            Some(before) => before_after(&PlanePicture { plane: &before, state: "uncompensated", ..one }, &one),
            None => one.picture(),
        }
    }
}

/// Returns two different linear axes with room to move, of `XY`, or of `X,Y2` where names are longer.
fn plane_axes(machine: &Machine, text: Option<&str>) -> Result<[usize; 2], Diagnostic> {
    let moves =
        |i: &usize| machine.axes()[*i].kind == AxisKind::Linear && machine.volume()[*i].max > machine.volume()[*i].min;
    let mut linear: Vec<usize> = (0..machine.axes().len()).filter(moves).collect();
    linear.sort_by(|a, b| machine.axes()[*a].name.cmp(&machine.axes()[*b].name));
    let Some(text) = text else {
        return if let [a, b, ..] = linear[..] {
            Ok([a, b])
        } else {
            Err(Diagnostic::new(codes::E0818, "the machine has no two linear axes to draw a plane of"))
        };
    };
    let names: Vec<String> = match text.split_once(',') {
        Some((a, b)) => vec![a.trim().to_owned(), b.trim().to_owned()],
        None => text.chars().map(String::from).collect(),
    };
    let index = |name: &String| linear.iter().copied().find(|i| machine.axes()[*i].name.as_str() == name);
    match names.iter().map(index).collect::<Option<Vec<_>>>().as_deref() {
        Some([a, b]) if a != b => Ok([*a, *b]),
        _ => {
            let known: Vec<&str> = linear.iter().map(|i| machine.axes()[*i].name.as_str()).collect();
            let known = known.join(", ");
            let message =
                format!("`--plane {text}` is not two different linear axes of {known}, such as `XY` or `X,Z`");
            Err(Diagnostic::new(codes::E0818, message))
        }
    }
}

/// About square cells, 72 along the longer side.
fn nodes(machine: &Machine, axes: [usize; 2]) -> [usize; 2] {
    cells(machine, axes, 72.0)
}

/// About square cells, 36 along the longer side: each node takes as long as all machines drawn.
fn bounded_nodes(machine: &Machine, axes: [usize; 2]) -> [usize; 2] {
    cells(machine, axes, 36.0)
}

/// About square cells of the plane of two axes.
pub(super) fn cells(machine: &Machine, axes: [usize; 2], longer: f64) -> [usize; 2] {
    let spans = axes.map(|i| machine.volume()[i].max - machine.volume()[i].min);
    let longest = spans[0].max(spans[1]);
    spans.map(|span| 1 + (longer * span / longest).round().max(2.0) as usize)
}
