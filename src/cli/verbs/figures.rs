//! `abbe figures`: figures of a standard from readings of a test.

use crate::cli::Outcome;
use crate::cli::arguments::{PictureFile, help, svg};
use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use abbe::options::{CirclePlane, StandardTest};
use abbe::results::{
    CauseTest, CircleTest, DiagonalsTest, DriftTest, RotationTest, TestFigures, TurningTest, UncertainValue,
};
use abbe::text::{NOT_VERIFIED, significant, with_sigma};
use abbe::{FiguresOptions, figures};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The test.
    #[arg(value_enum)]
    test: StandardTest,
    /// The readings: a table with a title and a unit over each column.
    file: PathBuf,
    #[arg(long, value_enum, value_name = "AXES", help = help::PLANE,
        long_help = "Circle: its plane; angles run from the first direction to the second [default: xy]")]
    plane: Option<CirclePlane>,
    #[arg(long, value_name = "MM", default_value_t = 100.0, help = help::RADIUS,
        long_help = "Circle: its nominal radius, mm (above 0)")]
    radius: f64,
    /// Circle: its feed, mm/min, to state servo mismatch as a difference of delays (above 0) [default: no delays].
    #[arg(long, value_name = "MM/MIN")]
    feed: Option<f64>,
    /// Rotation and drift: distance from the first plane of probes (`x1`) to the second (`x2`, towards the holder), mm
    /// (above 0) [default: no tilts].
    #[arg(long, value_name = "MM")]
    distance: Option<f64>,
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG,
        long_help = "Draw the readings, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
}

impl Args {
    fn options(&self) -> FiguresOptions {
        FiguresOptions {
            test: self.test,
            plane: self.plane.unwrap_or(CirclePlane::XY),
            radius_mm: self.radius,
            feed: self.feed,
            distance_mm: self.distance,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    PictureFile::refuse(session, args.svg.iter())?;
    let result = session.take(figures(&args.file, &args.options(), session.run()))?;
    if let Some(file) = &args.svg {
        file.write(&result.picture(), session)?;
    }
    session.show(&result, || csv(&rows(&result)), || text(&result))
}

/// Header and rows of the figures.
type FigureRows = (Vec<&'static str>, Vec<Vec<String>>);

fn rows(result: &TestFigures) -> FigureRows {
    match result {
        TestFigures::Circle(test) => circle(test),
        TestFigures::Rotation(test) => rotation(test),
        TestFigures::Drift(test) => drift(test),
        TestFigures::Diagonals(test) => diagonals(test),
    }
}

fn n(x: f64) -> String {
    significant(x, 4)
}

fn maybe(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), n)
}

/// The value and its standard uncertainty.
fn cells(of: UncertainValue) -> [String; 2] {
    of.sigma.map_or_else(|| [n(of.value), "-".to_owned()], |sigma| with_sigma(of.value, sigma))
}

fn circle(test: &CircleTest) -> FigureRows {
    let line =
        |name: &str, value: String, sigma: String, unit: &str| vec![name.to_owned(), value, sigma, unit.to_owned()];
    let of_scatter = test.uncertainty.as_ref().map(|u| [u.deviation, u.mean, u.extreme].map(|u| n(u / 2.0)));
    let [of_g, of_d, of_f] = of_scatter.unwrap_or_default();
    let (g, f) = (test.circular_deviation_um, test.radial_max_min_um);
    let ends = |ends: Option<[f64; 2]>| ends.map_or_else(|| "-".to_owned(), |[a, b]| format!("{} / {}", n(a), n(b)));
    let mut rows = vec![
        line("G counter-clockwise", maybe(g.counter_clockwise), of_g.clone(), "um"),
        line("G clockwise", maybe(g.clockwise), of_g.clone(), "um"),
        line("G(b)", maybe(test.bidirectional_um), of_g, "um"),
        line("D", maybe(test.mean_radial_um), of_d, "um"),
        line("F counter-clockwise", ends(f.counter_clockwise), of_f.clone(), "um"),
        line("F clockwise", ends(f.clockwise), of_f, "um"),
    ];
    let [u, v] = test.plane.directions().map(|i| ["X", "Y", "Z"][i]);
    rows.extend(test.causes.iter().flat_map(|causes| cause_rows(causes, [u, v])));
    (vec!["figure", "value", "u", "unit"], rows)
}

/// The causes of a circle in a plane of two directions.
fn cause_rows(causes: &CauseTest, [u, v]: [&str; 2]) -> Vec<Vec<String>> {
    let line = |name: String, of: UncertainValue, unit: &str| {
        let [value, sigma] = cells(of);
        vec![name, value, sigma, unit.to_owned()]
    };
    let [first, second] = causes.reversal_um;
    let mut rows = vec![
        line("squareness".to_owned(), causes.squareness_urad, "urad"),
        line(format!("scale {u} minus {v}"), causes.scale_mismatch_um_per_m, "um/m"),
        line(format!("reversal {u}"), first, "um"),
        line(format!("reversal {v}"), second, "um"),
    ];
    rows.extend(causes.servo_um.map(|servo| line("servo mismatch".to_owned(), servo, "um")));
    rows.extend(causes.servo_ms.map(|servo| line(format!("delay {u} minus {v}"), servo, "ms")));
    rows.extend(causes.turning_points.iter().flat_map(spike));
    rows.push(vec!["rest, rms".to_owned(), n(causes.rest_um), String::new(), "um".to_owned()]);
    rows
}

/// The reversal spike at a turning point: height, length and chance.
fn spike(at: &TurningTest) -> Vec<Vec<String>> {
    let name = format!("spike {}{}", at.axis, at.end);
    let Some(spike) = at.spike else {
        let none = at.limit_um.map_or_else(|| "-".to_owned(), |limit| format!("none above {}", n(limit)));
        return vec![vec![name, none, String::new(), "um".to_owned()]];
    };
    let line =
        |what: &str, value: String, unit: &str| vec![format!("{name}, {what}"), value, String::new(), unit.to_owned()];
    let chance = if spike.chance < 1e-9 { "below 1e-9".to_owned() } else { format!("{:.1e}", spike.chance) };
    let [value, sigma] = cells(spike.height_um);
    let mut rows = vec![
        vec![name.clone(), value, sigma, "um".to_owned()],
        line("begins", n(spike.start_deg), "deg"),
        line("length", n(spike.width_deg), "deg"),
        line("length", n(spike.width_mm), "mm"),
    ];
    rows.extend(spike.width_ms.map(|ms| line("length", n(ms), "ms")));
    rows.push(line("chance", chance, ""));
    rows
}

fn rotation(test: &RotationTest) -> FigureRows {
    let header = vec!["motion", "unit", "total", "synchronous", "asynchronous", "once a turn", "synchronous with it"];
    let row = |m: &abbe::results::MotionTest| {
        let figures = [n(m.total), n(m.synchronous), maybe(m.asynchronous), n(m.once), n(m.synchronous_with_once)];
        [m.motion.clone(), m.unit.to_owned()].into_iter().chain(figures).collect()
    };
    (header, test.motions.iter().map(row).collect())
}

fn drift(test: &DriftTest) -> FigureRows {
    let header = vec!["drift", "unit", "range", "first 60 min", "largest in 60 min", "change"];
    let row = |d: &abbe::results::DriftOf| {
        let figures = [d.range, d.first_hour, d.largest_in_an_hour, d.change].map(n);
        [d.drift.clone(), d.unit.to_owned()].into_iter().chain(figures).collect()
    };
    let warm = test.temperatures.iter().map(|of| {
        let [low, high] = of.deg_c;
        let dash = || "-".to_owned();
        vec![of.sensor.clone(), "degC".to_owned(), format!("{} to {}", n(low), n(high)), dash(), dash(), dash()]
    });
    (header, test.drifts.iter().map(row).chain(warm).collect())
}

fn diagonals(test: &DiagonalsTest) -> FigureRows {
    let header =
        vec!["diagonal", "length, mm", "targets", "runs", "E, um", "B, um", "mean B, um", "M, um", "R, um", "A, um"];
    let row = |d: &abbe::results::DiagonalTest| {
        let figures = [n(d.e_um), maybe(d.b_um), maybe(d.mean_b_um), n(d.m_um), maybe(d.r_um), maybe(d.a_um)];
        let head = [d.diagonal.clone(), n(d.length_mm), d.targets.to_string(), d.runs.to_string()];
        head.into_iter().chain(figures).collect()
    };
    (header, test.diagonals.iter().map(row).collect())
}

fn csv((header, rows): &FigureRows) -> String {
    let lines = rows.iter().map(|row| row.iter().map(|cell| cell.replace(',', ";")).collect::<Vec<_>>().join(","));
    [header.join(",")].into_iter().chain(lines).map(|line| line + "\n").collect()
}

fn text(result: &TestFigures) -> String {
    let head = match result {
        TestFigures::Circle(test) => {
            let [u, v] = test.centre_um;
            let causes = if test.causes.is_none() { "\nthe readings do not tell the causes apart" } else { "" };
            format!(
                "circle of {} mm in {}: {} readings over {} deg, ISO 230-4\ncentre of least squares at {}, {} um from \
                 the nominal one{causes}",
                n(test.radius_mm),
                test.plane.name(),
                test.readings,
                n(test.arc_deg),
                n(u),
                n(v)
            )
        }
        TestFigures::Rotation(test) => {
            let places = test.motions.first().map_or((0, 0), |motion| (motion.places, motion.turns));
            format!(
                "axis of rotation: {} readings, {} places, {} turns, about the centre of least squares, ISO 230-7\n\
                 once a turn: of a radial probe the set-up of the artefact, of an axial one the fundamental, which is \
                 an error motion",
                test.readings, places.0, places.1
            )
        }
        TestFigures::Drift(test) => format!("drift over {} min, ISO 230-3", n(test.minutes)),
        TestFigures::Diagonals(test) => {
            format!("diagonals: E_d {} um, B_d {} um, ISO 230-6", n(test.e_d_um), maybe(test.b_d_um))
        }
    };
    let (header, rows) = rows(result);
    let mut list = table(&header);
    rows.into_iter().for_each(|row| {
        let _ = list.add_row(row);
    });
    format!("{head}\n{list}\n{NOT_VERIFIED}\n")
}
