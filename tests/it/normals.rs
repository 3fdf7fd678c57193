//! The deviation along the normal of the surface, and the polar picture of round features, against closed forms.

use crate::program::{Folder, abbe, json, text, well_formed};
use crate::support::packed::data;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A five-axis machine with these lines.
fn five(folder: &Folder, lines: &str) -> PathBuf {
    let text = format!(
        "abbe: 1\nmachine: M\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  \
         Y: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  Z: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  \
         A: {{ travel: [-60 deg, 60 deg], origin: [0, 0, -40] }}\n  C: {{ travel: continuous, origin: [0, 0, -50] }}\n\
         {lines}\n"
    );
    folder.with("m.yaml", &text)
}

/// The columns of a CSV by their names in the header.
fn columns<const N: usize>(csv: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let mut lines = csv.lines().filter(|line| !line.is_empty());
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at =
        names.map(|name| header.iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name}: {header:?}")));
    lines.map(|line| at.map(|k| line.split(',').nth(k).unwrap().parse().unwrap())).collect()
}

#[test]
fn the_deviation_along_the_normal_is_the_same_in_every_frame() {
    let folder = Folder::new("normal-columns");
    let machine = five(
        &folder,
        "workpiece: { origin: [10, 20, 0], rotation: { B: 30 deg } }\nerrors: { EC0Y: 300 urad, EA0Z: 200 urad, EX0C: \
         50 um, EZZ: { points: [[-300 mm, -90 um], [300 mm, 110 um]] } }",
    );
    let rows = [
        ([10.0, 20.0, 5.0], [0.0, 0.2, 0.9], [0.6, 0.0, 0.8]),
        ([-30.0, 15.0, -5.0], [0.3, 0.0, 0.9], [0.0, -2.0, 0.0]),
        ([25.0, -40.0, 12.0], [0.0, 0.0, 1.0], [1.0, 2.0, 2.0]),
    ];
    let line = |(p, a, n): &([f64; 3], [f64; 3], [f64; 3])| {
        p.iter().chain(a).chain(n).map(f64::to_string).collect::<Vec<_>>().join(",") + "\n"
    };
    let table = rows.iter().map(line).collect::<String>();
    let _ = folder.with("part.csv", &format!("X,Y,Z,I,J,K,NX,NY,NZ\n{table}"));
    // A quarter of a turn about Z: x of the part is y of the workpiece.
    let job = folder.with("job.yaml", "tool_poses: part.csv\nplace: { rotation: [0, 0, 90] }\nreference: machine\n");
    let truth = |[dx, dy, dz]: [f64; 3], [nx, ny, nz]: [f64; 3]| {
        // The frame of the workpiece is turned on its seat with the part.
        (dz * nz + dy * nx - dx * ny) / (nx * nx + ny * ny + nz * nz).sqrt()
    };
    let map = |frame: &str| abbe(&["map", text(&machine), "--job", text(&job), "--frame", frame, "--format", "csv"]);
    let unturned = columns(&map("workpiece"), ["dx [um]", "dy [um]", "dz [um]", "dn [um]"]);
    let along: Vec<f64> = unturned.iter().map(|row| row[3]).collect();
    for ([dx, dy, dz, dn], (.., normal)) in unturned.into_iter().zip(rows) {
        assert!((dn - truth([dx, dy, dz], normal)).abs() < 1e-9 && dn.abs() > 1.0, "{dn} {dx} {dy} {dz}");
    }
    for frame in ["machine", "tool"] {
        let turned = columns(&map(frame), ["dn [um]", "dx [um]"]);
        assert!(turned.iter().zip(&along).all(|([dn, _], truth)| (dn - truth).abs() < 1e-9), "{frame}");
    }
    let eval = ["eval", text(&machine), "--job", text(&job)];
    for frame in ["workpiece", "tool"] {
        let frame = ["--frame", frame, "--format"];
        let csv = abbe(&[&eval[..], &frame, &["csv"]].concat());
        let found = json(&[&eval[..], &frame, &["json"]].concat());
        for ((row, pose), truth) in
            columns(&csv, ["dn [mm]"]).iter().zip(found["poses"].as_array().unwrap()).zip(&along)
        {
            let [mm, um] = [row[0], number(&pose["along_normal"]) * 1e3];
            assert!((mm * 1e3 - truth).abs() < 1e-9 && (um - truth).abs() < 1e-9, "{mm} {um} {truth}");
        }
    }
    assert!(abbe(&eval).contains("along normal um"));
    let out = folder.file("rows.json");
    let _ = abbe(&["map", text(&machine), "--job", text(&job), "--json", text(&out), "--quiet"]);
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
    assert!((number(&rows["poses"][1]["along_normal_um"]) - along[1]).abs() < 1e-9, "{}", rows["poses"][1]);
    assert!(rows["poses"][1]["rotation_urad"].as_array().unwrap().len() == 3);
    let _ = folder.with("part.csv", "X,Y,Z\n0,0,0\n");
    assert!(!map("workpiece").contains("dn [um]") && !abbe(&eval).contains("along normal"));
}

/// Attributes of every element of a kind in an SVG.
fn elements<'a>(svg: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!("<{name} ");
    svg.split(start.as_str()).skip(1).map(|rest| &rest[..rest.find('>').unwrap()]).collect()
}

fn attribute<'a>(of: &'a str, name: &str) -> &'a str {
    let from = of.find(&format!("{name}=\"")).unwrap() + name.len() + 2;
    &of[from..from + of[from..].find('"').unwrap()]
}

fn picture(html: &str) -> &str {
    let title = html.find("<title>Roundness").unwrap_or_else(|| panic!("no picture of roundness"));
    let from = html[..title].rfind("<svg").unwrap();
    &html[from..from + html[from..].find("</svg>").unwrap() + 6]
}

fn report(folder: &Folder, machine: &Path, job: &Path) -> String {
    let out = folder.file("report.html");
    let _ = abbe(&["report", text(machine), "--job", text(job), "--poses", "20", "--out", text(&out), "--quiet"]);
    std::fs::read_to_string(&out).unwrap()
}

/// Places of the path of a colour about the centre, px.
fn curve(svg: &str, dashed: bool) -> Vec<[f64; 2]> {
    let first = elements(svg, "circle")[0];
    let centre = ["cx", "cy"].map(|name| attribute(first, name).parse::<f64>().unwrap());
    let path = elements(svg, "path").into_iter().find(|path| path.contains("stroke-dasharray") == dashed).unwrap();
    let data = attribute(path, "d").trim_start_matches('M').trim_end_matches('Z');
    let point = |of: &str| {
        let (x, y) = of.split_once(' ').unwrap();
        [x.parse::<f64>().unwrap() - centre[0], centre[1] - y.parse::<f64>().unwrap()]
    };
    data.split('L').map(point).collect()
}

#[test]
fn a_circle_on_a_machine_out_of_square_is_drawn_as_an_ellipse() {
    let folder = Folder::new("normal-polar");
    let machine = five(&folder, "errors: { EC0Y: 200 urad }\nsetup: { workpiece: { X: 30 um } }");
    let radius = 50.0;
    let row = |i: i32| {
        let (sine, cosine) = f64::from(i * 5).to_radians().sin_cos();
        format!("{},{},0,{cosine},{sine},0,bore{}\n", radius * cosine, radius * sine, 1)
    };
    let rows: String = (0..72).map(row).collect();
    let _ = folder.with("circle.csv", &format!("X,Y,Z,NX,NY,NZ,feature\n{rows}"));
    let job = folder.with("job.yaml", "tool_poses: circle.csv\nreference: machine\n");
    let html = report(&folder, &machine, &job);
    let svg = picture(&html);
    well_formed(svg).unwrap();
    // What is made: d = (-c y, 0) and a shift, along the normal.
    let map = abbe(&["map", text(&machine), "--job", text(&job), "--format", "csv"]);
    let along: Vec<f64> = columns(&map, ["dn [um]"]).iter().map(|row| row[0]).collect();
    let shear = |k: usize| 0.5 * (along[k] + along[(k + 36) % 72]).abs();
    let largest = (0..72).map(shear).fold(0.0, f64::max);
    assert!((largest - 200e-6 * radius * 0.5 * 1e3).abs() < 1e-3, "{largest}");
    let rings: Vec<f64> = elements(svg, "circle").iter().map(|of| attribute(of, "r").parse().unwrap()).collect();
    let (pitch, nominal) = (rings[1] - rings[0], rings[2]);
    let note = &svg[svg.find("One ring is ").unwrap() + 12..];
    let ring: f64 = note[..note.find(' ').unwrap()].parse().unwrap();
    let drawn = curve(svg, false);
    assert_eq!(drawn.len(), 72);
    for [x, y] in &drawn {
        let angle = y.atan2(*x).to_degrees().rem_euclid(360.0);
        let k = (angle / 5.0).round() as usize % 72;
        let truth = nominal + pitch * along[k] / ring;
        assert!((x.hypot(*y) - truth).abs() < 0.02, "{angle}: {} {truth}", x.hypot(*y));
    }
    // The least-squares circle is that of the shift: 30 um to one side, and no growth.
    let shift = curve(svg, true).iter().fold([0.0; 2], |[a, b], [x, y]| [a + x / 36.0, b + y / 36.0]);
    let mean = curve(svg, true).iter().map(|[x, y]| x.hypot(*y) - nominal).sum::<f64>() / 72.0;
    assert!(mean.abs() < 0.02, "{mean}");
    let moved = curve(svg, true).iter().map(|[x, y]| x.hypot(*y) - nominal).fold(0.0, f64::max) * ring / pitch;
    assert!((moved - 30.0).abs() < 0.1 && shift[0].hypot(shift[1]) > 1.0, "{moved}");
    let work = &data(&html)["machines"][0]["work"]["round"][0];
    for name in ["minimum_zone_um", "least_squares_um"] {
        assert!((number(&work[name]) - 200e-6 * radius * 1e3).abs() < 2e-2, "{work}");
    }
    assert!((number(&work["radius_mm"]) - radius).abs() < 1e-6 && work["points"] == 72);
    // Scale and magnification stand in the picture and in its text for screen readers.
    let times = (pitch / (ring * 1e-3)) / (nominal / radius);
    let title = &svg[svg.find("<title>").unwrap()..svg.find("</title>").unwrap()];
    assert!(title.contains("bore1: roundness 10 ") && title.contains("R 50 mm"), "{title}");
    let stated = &title[title.find("; ").unwrap()..title.find('\u{d7}').unwrap()];
    let stated: f64 = stated.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((stated / times - 1.0).abs() < 0.05, "{stated} {times}");
}

#[test]
fn a_bore_points_inwards_and_flat_features_have_no_picture() {
    let folder = Folder::new("normal-bore");
    let machine = five(&folder, "errors: { EXX: { points: [[-300 mm, -30 um], [300 mm, 30 um]] } }");
    let row = |i: i32| {
        let (sine, cosine) = f64::from(i * 10).to_radians().sin_cos();
        format!("{},{},0,{},{},0,bore\n", 60.0 * cosine, 60.0 * sine, -cosine, -sine)
    };
    let rows: String = (0..36).map(row).collect();
    let flat = (0..9).map(|i| format!("{},{},0,0,0,1,top\n", i % 3 * 10, i / 3 * 10)).collect::<String>();
    let _ = folder.with("part.csv", &format!("X,Y,Z,NX,NY,NZ,feature\n{rows}{flat}"));
    let job = folder.with("job.yaml", "tool_poses: part.csv\nreference: machine\n");
    let html = report(&folder, &machine, &job);
    // 100 um/m along X: the bore is larger there, by 6 um at 0 deg, whatever its normal says.
    let svg = picture(&html);
    let rings: Vec<f64> = elements(svg, "circle").iter().map(|of| attribute(of, "r").parse().unwrap()).collect();
    let outermost = curve(svg, false).into_iter().max_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1]))).unwrap();
    assert!(outermost[0].hypot(outermost[1]) > rings[2] + 1.0 && outermost[1].abs() < 1e-6, "{outermost:?}");
    let round = data(&html)["machines"][0]["work"]["round"].clone();
    assert_eq!((round.as_array().unwrap().len(), &round[0]["feature"]), (1, &"bore".into()));
    let _ = folder.with("part.csv", &format!("X,Y,Z,NX,NY,NZ,feature\n{flat}"));
    assert!(!report(&folder, &machine, &job).contains("<title>Roundness"));
}

#[test]
fn a_circle_between_bounds_is_drawn_as_the_machine_at_the_95_percent_value() {
    let folder = Folder::new("normal-drawn");
    let machine = five(&folder, "tolerances: { EC0Y: 200 urad }");
    let row = |i: i32| {
        let (sine, cosine) = f64::from(i * 5).to_radians().sin_cos();
        format!("{},{},0,{cosine},{sine},0,bore\n", 50.0 * cosine, 50.0 * sine)
    };
    let rows: String = (0..72).map(row).collect();
    let _ = folder.with("circle.csv", &format!("X,Y,Z,NX,NY,NZ,feature\n{rows}"));
    let features = "features: { bore: { kind: roundness, tolerance: 8 um } }\n";
    let job = folder.with("job.yaml", &format!("tool_poses: circle.csv\nreference: machine\n{features}"));
    let html = report(&folder, &machine, &job);
    let svg = picture(&html);
    well_formed(svg).unwrap();
    // Out of square by an angle the circle is an ellipse, 50 mm times the angle out of round: at most 10 um.
    let work = &data(&html)["machines"][0]["work"];
    let (round, of) = (&work["round"][0], &work["characteristics"][0]["drawn"]);
    let um = number(&round["minimum_zone_um"]);
    assert!((9.0..10.0).contains(&um) && svg.contains(", 95 % value"), "{um}");
    assert!((um - number(&of["p95_um"]["value"])).abs() < 1e-6, "{um} {of}");
    // A uniform angle holds 8 of 10 um in 80 of 100 machines.
    let holds = ["low", "high"].map(|end| number(&of["holds"][end]));
    assert!(holds[0] < 0.8 && holds[1] > 0.8 && html.contains("bore</th><td class=\"word\">roundness"), "{holds:?}");
}
