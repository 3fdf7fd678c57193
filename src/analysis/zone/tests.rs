//! Characteristics against closed forms.

use super::{Characteristic, CharacteristicKind as Kind, CharacteristicRequest, SurfacePoint, Unfit, ZoneFit};
use nalgebra::{Rotation3, Unit, Vector3};

type V = Vector3<f64>;

fn request(kind: Kind, points: &[SurfacePoint]) -> CharacteristicRequest<'_> {
    CharacteristicRequest { kind, points, datum: None, axis: None, free: false, fit: ZoneFit::MinimumZone }
}

fn made(kind: Kind, points: &[SurfacePoint]) -> Characteristic {
    Characteristic::new(request(kind, points)).unwrap()
}

/// A turn of no special place.
fn turn() -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Unit::new_normalize(V::new(0.3, -0.8, 0.5)), 0.7)
}

fn place(p: V) -> V {
    turn() * p + V::new(120.0, -40.0, 33.0)
}

fn point(p: V, n: V) -> SurfacePoint {
    SurfacePoint { place: place(p), normal: Some(turn() * n.normalize()) }
}

fn bare(points: &[SurfacePoint]) -> Vec<SurfacePoint> {
    points.iter().map(|p| SurfacePoint { normal: None, ..*p }).collect()
}

/// Points of a plane of 100 x 60 mm with its own coordinates, -1 to 1.
fn plane() -> Vec<([f64; 2], SurfacePoint)> {
    let steps = || (-4..=4).map(|i| f64::from(i) / 4.0);
    let at = |x: f64, y: f64| ([x, y], point(V::new(50.0 * x, 30.0 * y, 0.0), V::z()));
    steps().flat_map(|x| steps().map(move |y| at(x, y))).collect()
}

/// Points of a cone about Z by angle and height, the normal with a part `axial` along the axis.
fn cone(heights: &[f64], slope: f64) -> Vec<(f64, f64, SurfacePoint)> {
    let angles = || (0..72).map(|i| f64::from(i) * std::f64::consts::TAU / 72.0);
    let at = |z: f64, t: f64| {
        let (sine, cosine) = libm::sincos(t);
        let radius = 40.0 - slope * z;
        (t, z, point(V::new(radius * cosine, radius * sine, z), V::new(cosine, sine, slope)))
    };
    heights.iter().flat_map(|z| angles().map(move |t| at(*z, t))).collect()
}

/// The first-order effect of a rigid motion of the part.
fn rigid(points: &[SurfacePoint], t: V, w: V) -> Vec<V> {
    points.iter().map(|p| t + w.cross(&p.place)).collect()
}

fn added(a: &[V], b: &[V]) -> Vec<V> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn value(of: &Characteristic, deviations: &[V]) -> f64 {
    of.widths(deviations, &[]).value
}

fn motion(points: &[SurfacePoint]) -> Vec<V> {
    rigid(points, V::new(0.02, -0.05, 0.07), V::new(2e-4, -3e-4, 1e-4))
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}");
}

#[test]
fn forms_have_the_width_of_their_lobes_whatever_the_motion() {
    let normal = turn() * V::z();
    // x y on a rectangle: no plane is nearer than 0, the corners deviate by 1.
    let (own, points): (Vec<[f64; 2]>, Vec<SurfacePoint>) = plane().into_iter().unzip();
    let saddle: Vec<V> = own.iter().map(|[x, y]| normal * (0.01 * x * y)).collect();
    for points in [points.clone(), bare(&points)] {
        let flatness = made(Kind::Flatness, &points);
        close(value(&flatness, &saddle), 0.02);
        close(value(&flatness, &added(&saddle, &motion(&points))), 0.02);
    }
    // A parabola along a line.
    let line: Vec<SurfacePoint> = points[..].iter().skip(4).step_by(9).copied().collect();
    let bow: Vec<V> = (-4..=4).map(|i| normal * (0.01 * f64::from(i * i) / 16.0)).collect();
    close(value(&made(Kind::Straightness, &line), &added(&bow, &motion(&line))), 0.01);
    // Three lobes of a circle, with and without normals, and of a cone whose normals lean.
    for slope in [0.0, 0.27] {
        let (angles, points): (Vec<f64>, Vec<SurfacePoint>) =
            cone(&[5.0], slope).into_iter().map(|(t, _, p)| (t, p)).unzip();
        let radial = |t: &f64| turn() * V::new(libm::cos(*t), libm::sin(*t), 0.0);
        let lobes: Vec<V> = angles.iter().map(|t| radial(t) * (0.01 * libm::cos(3.0 * t) + 0.004)).collect();
        // Across the cone counts the part along its normal.
        let (of, part) = (made(Kind::Roundness, &points), 1.0 / f64::hypot(1.0, slope));
        close(value(&of, &lobes), 0.02 * part);
        let widths = of.widths(&added(&lobes, &rigid(&points, V::new(0.02, 0.01, -0.3), V::zeros())), &[]);
        close(widths.value, 0.02 * part);
        close(widths.least_squares.unwrap(), 0.02 * part);
        close(value(&made(Kind::Roundness, &bare(&points)), &lobes), 0.02);
    }
}

#[test]
fn cylinders_are_followed_along_their_axis() {
    let points: Vec<SurfacePoint> = cone(&[-20.0, 0.0, 20.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let cylindricity = made(Kind::Cylindricity, &points);
    assert!(value(&cylindricity, &motion(&points)) < 1e-15);
    // A barrel: the radius grows by 0.01 in the middle.
    let barrel: Vec<V> = cone(&[-20.0, 0.0, 20.0], 0.0)
        .into_iter()
        .map(|(t, z, _)| turn() * V::new(libm::cos(t), libm::sin(t), 0.0) * if z == 0.0 { 0.01 } else { 0.0 })
        .collect();
    close(value(&cylindricity, &added(&barrel, &motion(&points))), 0.01);
    close(value(&made(Kind::Roundness, &points), &barrel), 0.0);
    // The axis at the ends of the cylinder: the part of its shift across the axis.
    let deviations = motion(&points);
    let [t, w] = [V::new(0.02, -0.05, 0.07), V::new(2e-4, -3e-4, 1e-4)];
    let axis = turn() * V::z();
    let shift = |z: f64| {
        let d = t + w.cross(&place(V::new(0.0, 0.0, z)));
        (d - axis * axis.dot(&d)).norm()
    };
    close(value(&made(Kind::Position, &points), &deviations), 2.0 * shift(-20.0).max(shift(20.0)));
    // To the axis of a datum that moves alike nothing is left; of one that stays, the shift.
    let datum: Vec<SurfacePoint> = cone(&[-40.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let circle: Vec<SurfacePoint> = cone(&[15.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let to_datum =
        Characteristic::new(CharacteristicRequest { datum: Some(&datum), ..request(Kind::Position, &circle) });
    let (to_datum, still) = (to_datum.unwrap(), vec![V::zeros(); datum.len()]);
    let moved = rigid(&circle, t, V::zeros());
    assert!(to_datum.widths(&moved, &rigid(&datum, t, V::zeros())).value < 1e-12);
    close(to_datum.widths(&moved, &still).value, 2.0 * (t - axis * axis.dot(&t)).norm());
    let cone: Vec<SurfacePoint> = cone(&[0.0, 30.0], 0.2).into_iter().map(|(.., p)| p).collect();
    assert_eq!(Characteristic::new(request(Kind::Cylindricity, &cone)), Err(Unfit::Cone));
}

#[test]
fn angles_are_to_the_datum_and_not_to_the_machine() {
    let (own, base): (Vec<[f64; 2]>, Vec<SurfacePoint>) = plane().into_iter().unzip();
    let side: Vec<SurfacePoint> = own.iter().map(|[x, y]| point(V::new(50.0 * x, 30.0, 20.0 * y), V::y())).collect();
    let of = |kind, points: &[SurfacePoint], datum: &[SurfacePoint]| {
        Characteristic::new(CharacteristicRequest { datum: Some(datum), ..request(kind, points) })
    };
    let square = of(Kind::Perpendicularity, &side, &base).unwrap();
    assert!(square.widths(&motion(&side), &motion(&base)).value < 1e-12);
    // The datum tilts by 1e-4 about X: the side, 40 mm high, is off by 4 um; its own turn about Z does not count.
    let [x, z] = [turn() * V::x(), turn() * V::z()];
    let tilted = rigid(&base, V::zeros(), x * 1e-4);
    close(square.widths(&rigid(&side, V::zeros(), z * 5e-4), &tilted).value, 4e-3);
    close(of(Kind::Parallelism, &base, &base).unwrap().widths(&tilted, &vec![V::zeros(); base.len()]).value, 6e-3);
    let Err(Unfit::Angle { deg }) = of(Kind::Parallelism, &side, &base) else { panic!("an angle") };
    close(deg, 90.0);
    // To a cylinder counts its axis.
    let bore: Vec<SurfacePoint> = cone(&[-10.0, 10.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let across = of(Kind::Perpendicularity, &base, &bore).unwrap();
    close(across.widths(&tilted, &vec![V::zeros(); bore.len()]).value, 6e-3);
    assert!(across.widths(&motion(&base), &motion(&bore)).value < 1e-12);
    // One line by another: two sides of a square at one height.
    let along = |from: V, to: V, n: V| -> Vec<SurfacePoint> {
        (0..=10).map(|i| point(from + (to - from) * (f64::from(i) / 10.0), n)).collect()
    };
    let first = along(V::new(-50.0, -30.0, 5.0), V::new(50.0, -30.0, 5.0), -V::y());
    let second = along(V::new(50.0, -30.0, 5.0), V::new(50.0, 30.0, 5.0), V::x());
    let lines = of(Kind::Perpendicularity, &second, &first).unwrap();
    let motions = [rigid(&second, V::zeros(), V::zeros()), rigid(&first, V::zeros(), z * 1e-4)];
    close(lines.widths(&motions[0], &motions[1]).value, 6e-3);
    assert!(lines.widths(&motion(&second), &motion(&first)).value < 1e-12);
}

#[test]
fn profiles_and_places_are_about_the_nominal_form() {
    let (own, points): (Vec<[f64; 2]>, Vec<SurfacePoint>) = plane().into_iter().unzip();
    let normal = turn() * V::z();
    let ramp: Vec<V> = own.iter().map(|[x, _]| normal * (0.003 + 0.01 * x)).collect();
    for kind in [Kind::Profile, Kind::Position] {
        close(value(&made(kind, &points), &ramp), 0.026);
    }
    let free = CharacteristicRequest { free: true, ..request(Kind::Profile, &points) };
    assert!(value(&Characteristic::new(free).unwrap(), &ramp) < 1e-12);
}

/// A bore and a hole above it that lean together have their places to each other; to a circle the lean counts.
#[test]
fn a_hole_leans_with_the_axis_of_its_datum() {
    let of = |heights: &[f64]| -> Vec<SurfacePoint> { cone(heights, 0.0).into_iter().map(|(.., p)| p).collect() };
    let (bore, circle, hole) = (of(&[-10.0, 10.0]), of(&[0.0]), of(&[40.0, 60.0]));
    let (shift, lean) = (turn() * V::new(0.002, -0.003, 0.001), turn() * V::new(1e-4, 0.0, 0.0));
    let to = |datum: &[SurfacePoint]| {
        let request = CharacteristicRequest { datum: Some(datum), ..request(Kind::Position, &hole) };
        Characteristic::new(request).unwrap().widths(&rigid(&hole, shift, lean), &rigid(datum, shift, lean)).value
    };
    assert!(to(&bore) < 1e-12, "{}", to(&bore));
    // 100 urad over 60 mm, on either side.
    close(to(&circle), 2.0 * 6e-3);
}

/// The value is the sum of the parts, and the weights are its derivatives.
#[test]
fn weights_are_the_derivatives() {
    let (_, base): (Vec<[f64; 2]>, Vec<SurfacePoint>) = plane().into_iter().unzip();
    let bore: Vec<SurfacePoint> = cone(&[-10.0, 10.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let circle: Vec<SurfacePoint> = cone(&[3.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let mut state = 9_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut random = |n: usize| -> Vec<V> { (0..n).map(|_| V::new(next(), next(), next())).collect() };
    type Points<'a> = &'a [SurfacePoint];
    let cases: [(Kind, Points<'_>, Option<Points<'_>>); 6] = [
        (Kind::Flatness, &base, None),
        (Kind::Roundness, &bore, None),
        (Kind::Cylindricity, &bore, None),
        (Kind::Position, &circle, Some(&bore)),
        (Kind::Perpendicularity, &base, Some(&bore)),
        (Kind::Profile, &bore, None),
    ];
    for (kind, points, datum) in cases {
        for fit in [ZoneFit::MinimumZone, ZoneFit::LeastSquares] {
            let of = Characteristic::new(CharacteristicRequest { datum, fit, ..request(kind, points) }).unwrap();
            let at_datum = datum.map_or(0, <[SurfacePoint]>::len);
            let (a, b) = (random(points.len()), random(at_datum));
            let (da, db) = (random(points.len()), random(at_datum));
            let at = |h: f64| {
                let step = |a: &[V], d: &[V]| a.iter().zip(d).map(|(a, d)| a + d * h).collect::<Vec<V>>();
                of.widths(&step(&a, &da), &step(&b, &db)).value
            };
            let weights = of.weights(&a, &b);
            let sum = |a: &[V], b: &[V]| -> f64 {
                weights.iter().map(|w| w.weight.dot(if w.of_datum { &b[w.point] } else { &a[w.point] })).sum()
            };
            assert!((sum(&a, &b) - at(0.0)).abs() < 1e-9, "{kind:?} {fit:?}: {} {}", sum(&a, &b), at(0.0));
            let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((sum(&da, &db) - slope).abs() < 1e-5, "{kind:?} {fit:?}: {} {slope}", sum(&da, &db));
        }
    }
}

#[test]
fn what_points_do_not_carry_is_refused_in_words() {
    let (_, base): (Vec<[f64; 2]>, Vec<SurfacePoint>) = plane().into_iter().unzip();
    let bore: Vec<SurfacePoint> = cone(&[-10.0, 10.0], 0.0).into_iter().map(|(.., p)| p).collect();
    let of = |kind, points: &[SurfacePoint]| Characteristic::new(request(kind, points)).unwrap_err();
    let line = bare(&base[..9]);
    assert_eq!(of(Kind::Straightness, &line), Unfit::Normals);
    assert_eq!(of(Kind::Straightness, &base), Unfit::Line);
    assert_eq!(of(Kind::Flatness, &base[..9]), Unfit::Plane);
    assert_eq!(of(Kind::Flatness, &bore), Unfit::Turning);
    assert_eq!(of(Kind::Roundness, &base), Unfit::Round);
    assert_eq!(of(Kind::Cylindricity, &bare(&bore)), Unfit::Axis);
    assert_eq!(of(Kind::Perpendicularity, &base), Unfit::NoDatum);
    assert_eq!(of(Kind::Flatness, &base[..3]), Unfit::Few { count: 3, needed: 4 });
    let axis = turn() * V::z();
    let stated = CharacteristicRequest { axis: Some(&axis), ..request(Kind::Cylindricity, &bore) };
    assert!(Characteristic::new(stated).is_ok());
    // Sums of Unfit are sentences for the user.
    assert!(of(Kind::Straightness, &line).to_string().contains("NX, NY, NZ"));
}
