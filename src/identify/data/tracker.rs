//! Exports of instruments with a frame of their own, laser trackers above all: points by name and coordinates. Their
//! poses stand in a table of their own.

use super::failure::RowFailure;
use crate::algebra::linear::Svd;
use crate::diagnostic::{Place, shown};
use crate::identify::thresholds::{COLLINEAR_SHARE, MAX_FRAME_MISFIT_SHARE};
use crate::syntax::sheet::{self, Decimals, SheetLine};
use crate::units::{self, Dimension, FARTHEST, significant};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Number of lines before the header that may be metadata.
const MAX_PREAMBLE_LINES: usize = 40;
/// Titles of the names of points, in lower case, with a stroke between.
const NAMES: &str = "point|name|point name|pointname|point id|pointid|point no|id|label|target|punkt|punktname|\
                     punkt-nr|punktnr|messpunkt";
const GROUPS: [&str; 5] = ["group", "collection", "job", "gruppe", "sammlung"];
/// Words beside the letter of a coordinate.
const WORDS: [&str; 7] = ["coordinate", "coord", "koordinate", "actual", "measured", "ist", "gemessen"];

/// Columns of an export: indices of the cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PointColumns {
    name: usize,
    groups: Vec<usize>,
    coordinates: [usize; 3],
    /// Factor of the coordinates, to mm.
    factors: [f64; 3],
    /// Number of cells; `None` without a header.
    width: Option<usize>,
    /// Index of the first line of points.
    first: usize,
    separator: char,
    /// Titles that are not used.
    pub left_out: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct TrackedPoint {
    pub name: String,
    /// mm, instrument's frame.
    pub at: Vector3<f64>,
    pub place: Place,
}

/// Returns the columns of an export of points; `None` if it is none.
pub(super) fn recognise(lines: &[SheetLine]) -> Option<PointColumns> {
    let header =
        lines.iter().take(MAX_PREAMBLE_LINES).enumerate().find_map(|(index, line)| columns_by_title(index, &line.text));
    header.or_else(|| columns_without_header(&lines.first()?.text))
}

/// True if a title is the coordinate of a letter: `x`, `x [mm]`, `X-Koordinate`, `measured x`.
fn is_coordinate(title: &str, letter: &str) -> bool {
    let words: Vec<&str> = title.split([' ', '-', '_']).filter(|word| !word.is_empty()).collect();
    match words[..] {
        [one] => one == letter,
        [a, b] => (a == letter && WORDS.contains(&b)) || (b == letter && WORDS.contains(&a)),
        _ => false,
    }
}

fn columns_by_title(index: usize, line: &str) -> Option<PointColumns> {
    let separator = sheet::separator(line);
    let mut cells = sheet::cells(line, separator);
    sheet::drop_empty(&mut cells, 0);
    let titles: Vec<(String, Option<String>)> = cells.iter().map(|cell| sheet::title(cell)).collect();
    let lower: Vec<String> = titles.iter().map(|(name, _)| name.to_lowercase()).collect();
    let name = lower.iter().position(|title| NAMES.split('|').any(|name| name == title))?;
    let coordinate = |letter: &str| {
        let mut found = (0..lower.len()).filter(|k| is_coordinate(&lower[*k], letter));
        found.next().filter(|_| found.next().is_none())
    };
    let coordinates = [coordinate("x")?, coordinate("y")?, coordinate("z")?];
    let factor = |k: usize| match titles[k].1.as_deref().map(units::unit) {
        None => Some(1.0),
        Some(Ok((factor, Dimension::LENGTH))) => Some(factor),
        Some(_) => None,
    };
    let [x, y, z] = coordinates.map(factor);
    let groups: Vec<usize> = (0..lower.len()).filter(|k| GROUPS.contains(&lower[*k].as_str())).collect();
    let used = |k: &usize| *k == name || coordinates.contains(k) || groups.contains(k);
    let left_out = (0..cells.len()).filter(|k| !used(k)).map(|k| cells[k].clone()).collect();
    let (width, first) = (Some(cells.len()), index + 1);
    Some(PointColumns { name, groups, coordinates, factors: [x?, y?, z?], width, first, separator, left_out })
}

/// Returns a file without a header: groups and a name, then three numbers.
fn columns_without_header(line: &str) -> Option<PointColumns> {
    let separator = sheet::separator(line);
    let mut cells = sheet::cells(line, separator);
    sheet::drop_empty(&mut cells, 0);
    let first = cells.len().checked_sub(3).filter(|first| (1..=3).contains(first))?;
    let is_number = |cell: &String| sheet::number(cell, separator).is_ok();
    let fits = cells[..first].iter().all(|cell| !is_number(cell)) && cells[first..].iter().all(is_number);
    fits.then(|| PointColumns {
        name: first - 1,
        groups: (0..first - 1).collect(),
        coordinates: [first, first + 1, first + 2],
        factors: [1.0; 3],
        width: None,
        first: 0,
        separator,
        left_out: Vec::new(),
    })
}

/// A reason for which points cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum PointFailure {
    #[error("{1}")]
    Row(Place, RowFailure),
    /// Names of two groups.
    #[error("the file has the groups `{}` and `{}`: export one", shown(.1), shown(.2))]
    Groups(Place, String, String),
    /// Numbers of points, and of poses without names.
    #[error("{0} points for {1} poses, which have no names")]
    Count(usize, usize),
    /// No point has the name of a pose.
    #[error("none of the points has a pose of its name")]
    NoPose,
}

impl PointFailure {
    /// Returns the row, if it is one of a row.
    pub fn place(&self) -> Option<Place> {
        match self {
            Self::Row(place, _) | Self::Groups(place, ..) => Some(place.clone()),
            Self::Count(..) | Self::NoPose => None,
        }
    }
}

impl PointColumns {
    /// Returns the points; the first row that is none refuses the file.
    pub fn points(&self, lines: &[SheetLine]) -> Result<Vec<TrackedPoint>, PointFailure> {
        let mut decimals = Decimals::default();
        let mut group: Option<String> = None;
        let mut points = Vec::new();
        for line in lines.iter().skip(self.first) {
            let at = |failure| PointFailure::Row(line.place.clone(), failure);
            let mut cells = sheet::cells(&line.text, self.separator);
            let width = self.width.unwrap_or(self.coordinates[2] + 1);
            sheet::drop_empty(&mut cells, width);
            if cells.len() != width {
                return Err(at(RowFailure::Cells(cells.len(), width)));
            }
            let mut number = |k: usize| {
                let cell = &cells[self.coordinates[k]];
                decimals.note(cell, self.separator).map_err(RowFailure::Decimals)?;
                let value = sheet::number(cell, self.separator).map_err(RowFailure::Number)? * self.factors[k];
                if value.abs() <= FARTHEST { Ok(value) } else { Err(RowFailure::Far(cell.clone())) }
            };
            let coordinates = [number(0), number(1), number(2)];
            let [x, y, z] = coordinates.map(|found| found.map_err(at));
            let own = self.groups.iter().map(|k| cells[*k].as_str()).collect::<Vec<_>>().join(" ");
            match &group {
                Some(known) if *known != own => {
                    return Err(PointFailure::Groups(line.place.clone(), known.clone(), own));
                }
                _ => group = Some(own),
            }
            let name = cells[self.name].clone();
            points.push(TrackedPoint { name, at: Vector3::new(x?, y?, z?), place: line.place.clone() });
        }
        Ok(points)
    }
}

/// The frame of an instrument in the workpiece frame: the best fit of the nominal points to the measured ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InstrumentFrame {
    /// Rotation from the workpiece frame to that of the instrument.
    rotation: Matrix3<f64>,
    /// Mean of the nominal points, workpiece frame.
    pub about: Vector3<f64>,
    /// Mean of the measured points, instrument's frame.
    origin: Vector3<f64>,
}

/// A reason for which measured points have no place in the workpiece frame.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub(super) enum FrameFailure {
    /// Fewer than three points, or points on a line.
    #[error("fewer than three points, or points on one line, do not show how the frame is turned")]
    Line,
    /// Sizes of the measured points over those of the nominal ones.
    #[error("the points are {} times as far apart as their poses put them", significant(*.0, 4))]
    Size(f64),
    /// Root mean square of what the best fit leaves (mm).
    #[error("the points are {} mm off their poses (RMS) after the best fit", significant(*.0, 3))]
    Misfit(f64),
}

impl InstrumentFrame {
    /// Fits a rigid motion (Kabsch 1976) and refuses one that leaves more than errors of a machine.
    pub fn fit(nominal: &[Vector3<f64>], measured: &[Vector3<f64>]) -> Result<Self, FrameFailure> {
        let count = nominal.len().max(1) as f64;
        let (frame, rest) = Self::best(nominal, measured);
        let size = |points: &[Vector3<f64>], from: &Vector3<f64>| {
            libm::sqrt(points.iter().map(|p| (p - from).norm_squared()).sum::<f64>() / count)
        };
        let spread = DMatrix::from_fn(nominal.len(), 3, |i, k| (nominal[i] - frame.about)[k]);
        if Svd::new(&spread).rank(COLLINEAR_SHARE) < 2 {
            return Err(FrameFailure::Line);
        }
        let (wanted, found) = (size(nominal, &frame.about), size(measured, &frame.origin));
        if (found / wanted - 1.0).abs() > MAX_FRAME_MISFIT_SHARE {
            return Err(FrameFailure::Size(found / wanted));
        }
        if rest > MAX_FRAME_MISFIT_SHARE * wanted { Err(FrameFailure::Misfit(rest)) } else { Ok(frame) }
    }

    /// Returns the best rigid motion, and what it leaves (mm, RMS).
    pub fn best(nominal: &[Vector3<f64>], measured: &[Vector3<f64>]) -> (Self, f64) {
        let count = nominal.len().max(1) as f64;
        let mean = |points: &[Vector3<f64>]| points.iter().sum::<Vector3<f64>>() / count;
        let (about, origin) = (mean(nominal), mean(measured));
        let products = nominal.iter().zip(measured).map(|(p, m)| (p - about) * (m - origin).transpose());
        let products = products.sum::<Matrix3<f64>>();
        let svd = Svd::new(&DMatrix::from_fn(3, 3, |i, j| products[(i, j)]));
        // The third directions follow from the others, so that planes have them and nothing is mirrored.
        let directions = |of: &DMatrix<f64>| {
            let [a, b] = [0, 1].map(|k| Vector3::from_fn(|i, _| of[(i, k)]));
            Matrix3::from_columns(&[a, b, a.cross(&b)])
        };
        let frame = Self { rotation: directions(&svd.v) * directions(&svd.u).transpose(), about, origin };
        let squares = nominal.iter().zip(measured).map(|(p, m)| (frame.in_workpiece(m) - p).norm_squared());
        let rest = libm::sqrt(squares.sum::<f64>() / count);
        (frame, rest)
    }

    /// Returns a measured point in the workpiece frame.
    pub fn in_workpiece(&self, measured: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transpose() * (measured - self.origin) + self.about
    }
}

impl FrameFailure {
    /// Returns the remedy.
    pub fn help(self) -> &'static str {
        match self {
            Self::Line => "measure points in a plane or in space, all of one set-up in one file",
            Self::Size(_) => "compare the unit: coordinates without one are mm, `X [m]` says another",
            Self::Misfit(_) => {
                "compare names and order of points and poses, the tool, and the hand of the instrument's frame"
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceId;

    fn lines(text: &str) -> Vec<SheetLine> {
        let place = Place { source: SourceId(0), range: 0..0 };
        text.lines()
            .enumerate()
            .map(|(i, l)| SheetLine { place: place.clone(), number: i + 1, text: l.to_owned() })
            .collect()
    }

    #[test]
    fn points_are_recognised() {
        let german = lines("Punktname;X [mm];Y [mm];Z [mm];Zeitstempel\nP1;1000,5;-2,25;3;10:00\n");
        let found = recognise(&german).unwrap();
        let points = found.points(&german).unwrap();
        assert_eq!((points[0].name.as_str(), points[0].at), ("P1", Vector3::new(1000.5, -2.25, 3.0)));
        assert_eq!(found.left_out, ["Zeitstempel"]);
        let bare = lines("A, main, p1, 1.0, 2.0, 3.0\nA, main, p2, 1.5, 2, 3\n");
        let points = recognise(&bare).unwrap().points(&bare).unwrap();
        assert_eq!((points[1].name.as_str(), points[1].at[0]), ("p2", 1.5));
        let raw = lines("exported by x\nName,Measured X (m),Measured Y (m),Measured Z (m)\na,0.001,0,0\n");
        let points = recognise(&raw).unwrap().points(&raw).unwrap();
        assert_eq!((points.len(), points[0].at[0]), (1, 1.0));
        let groups = lines("before, p1, 1, 2, 3\nafter, p1, 1, 2, 3\n");
        assert!(matches!(recognise(&groups).unwrap().points(&groups), Err(PointFailure::Groups(..))));
        for other in ["X,Y,Z\n1,2,3", "1,2,3,4", "name,X,Y\np,1,2", "name,X [deg],Y,Z\np,1,2,3", "X [mm],EXX [um]\n0,1"]
        {
            assert_eq!(recognise(&lines(other)), None, "{other}");
        }
    }

    #[test]
    fn frames_are_fitted() {
        let nominal: Vec<Vector3<f64>> =
            [[0.0, 0.0, 0.0], [400.0, 0.0, 0.0], [0.0, 300.0, 0.0], [400.0, 300.0, 0.0]].map(Vector3::from).to_vec();
        // The quarter turn about (1, 1, 1) / sqrt 3 by 120 deg: x to y to z.
        let measured: Vec<Vector3<f64>> =
            nominal.iter().map(|p| Vector3::new(p.z + 5000.0, p.x - 20.0, p.y + 7.0)).collect();
        let frame = InstrumentFrame::fit(&nominal, &measured).unwrap();
        for (p, m) in nominal.iter().zip(&measured) {
            assert!((frame.in_workpiece(m) - p).norm() < 1e-9);
        }
        let metres: Vec<Vector3<f64>> = measured.iter().map(|m| m * 1e-3).collect();
        assert!(matches!(InstrumentFrame::fit(&nominal, &metres), Err(FrameFailure::Size(_))));
        assert_eq!(InstrumentFrame::fit(&nominal[..2], &measured[..2]), Err(FrameFailure::Line));
        let swapped = [measured[1], measured[0], measured[2], measured[3]];
        assert!(matches!(InstrumentFrame::fit(&nominal, &swapped), Err(FrameFailure::Misfit(_))));
    }
}
