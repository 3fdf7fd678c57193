//! What newcomers type: files without a verb, lists for mappings, one text for one mistake, lines that can be copied.

use super::defaults::FIVE;
use super::first_hour::typed;
use super::program::{Folder, abbe, available, json, refused, text};
use std::collections::BTreeMap;

#[test]
fn errors_as_a_list_are_named_as_a_list() {
    let folder = Folder::new("lists");
    for list in ["\n  - EC0Y: 12 arcsec\n", "\n- EC0Y: 12 arcsec\n  EXX: 2 um\n", " [EC0Y: 12 arcsec]\n"] {
        for section in ["errors", "tolerances"] {
            let machine = format!("abbe: 1\nmachine: m\nchain: w b X t\naxes:\n  X: {{}}\n{section}:{list}");
            let file = folder.with("m.yaml", &machine);
            let (code, message) = refused(&["check", text(&file)]);
            let cause = format!("`{section}` is a list: it must be a mapping of names to entries");
            assert!(code == 1 && message.contains(&cause) && message.contains("omit the `-`"), "{message}");
        }
    }
    let file = folder.with("m.yaml", "abbe: 1\nmachine: m\nchain: w b X t\naxes:\n  X: {}\nerrors: 12 um\n");
    assert!(refused(&["check", text(&file)]).1.contains("one indented `NAME: ...` a line"));
}

#[test]
fn a_machine_file_in_place_of_a_verb_is_answered_by_verbs() {
    for file in ["m.yaml", "folder/m.yml"] {
        let (code, message) = refused(&[file]);
        let verbs = format!("`abbe check {file}`, `abbe workbench {file}`");
        assert!(code == 2 && message.contains(&verbs), "{message}");
    }
    let (code, message) = refused(&["chekc", "m.yaml"]);
    assert!(code == 2 && message.contains("'check'") && !message.contains("abbe check"), "{message}");
}

#[test]
fn an_unknown_target_has_one_text() {
    let folder = Folder::new("no-target");
    for (name, help) in [("linuxnc", "did you mean `linuxcnc`?"), ("foo", "known here: `linuxcnc`")] {
        let (code, listed) = refused(&["targets", name]);
        let out = folder.file("never");
        let compiled = refused(&["compile", "trunnion.yaml", "--target", name, "--out", text(&out)]).1;
        assert!(code == 1 && listed.contains(&format!("there is no target `{name}`")), "{listed}");
        assert!(listed.contains(help) && compiled.contains(listed.trim()), "{listed}\n{compiled}");
    }
}

#[test]
fn answers_make_one_file_on_the_terminal_and_on_the_page() {
    if !available("python3", "questions on a terminal") {
        return;
    }
    let folder = Folder::new("one-file");
    let (code, shown) = typed(&folder, "5\n0 620\n\n\n\n\n95.5\n2\n8\n\n\n6\n\npremium\nm.yaml\n");
    assert_eq!(code, 0, "{shown}");
    let answers = [
        ("kind", "5"),
        ("travel X", " 0, 620 "),
        ("tool", "95.5"),
        ("known", "2"),
        ("accuracy X", "8"),
        ("accuracy B", "6"),
        ("class", "premium"),
        ("no question", "no answer"),
    ];
    let answers: BTreeMap<String, String> = answers.map(|(key, answer)| (key.to_owned(), answer.to_owned())).into();
    let made = abbe::machine_dialogue(&answers);
    assert_eq!(made.file.as_deref(), Some(std::fs::read_to_string(folder.file("m.yaml")).unwrap().as_str()));
    // Every question of the page was asked on the terminal.
    let one_line = shown.replace("\r\n", " ");
    assert!(made.questions.iter().all(|of| one_line.contains(&of.asked)), "{shown}");
    let (code, shown) = typed(&folder, "1\n\n\n\n\n3\nnowhere.csv\n\u{4}");
    assert!(code == 1 && shown.contains("Wanted: names of files that are there."), "{shown}");
}

#[test]
fn lines_for_a_terminal_keep_commands_and_labels_whole() {
    let folder = Folder::new("lines");
    let part = folder.with("part.csv", "X,Y,Z,feature\n9000,0,100,a_feature_with_a_name\n0,0,100,top\n");
    let map = std::process::Command::new(env!("CARGO_BIN_EXE_abbe"))
        .args(["map", "vmc-cframe-754.yaml", "--tool-poses", text(&part)])
        .current_dir(crate::configs::folder())
        .env_remove("COLUMNS")
        .output()
        .unwrap();
    let told = String::from_utf8(map.stderr).unwrap();
    assert!(
        told.contains("note: the first of them: ") && told.lines().all(|line| line.chars().count() <= 80),
        "{told}"
    );
}

/// A machine file of three axes, with a chain and sections of its own.
fn three_axes(chain: &str, sections: &str) -> String {
    format!(
        "abbe: 1\nmachine: m\nchain: {chain}\naxes:\n  X: {{ travel: [0 mm, 500 mm] }}\n  \
         Y: {{ travel: [0 mm, 400 mm] }}\n  Z: {{ travel: [-400 mm, 0 mm] }}\n\
         tool: {{ gauge: [0, 0, 0], length: 100 mm }}\nworkpiece: {{ origin: [250, 200, -450] }}\n{sections}"
    )
}

#[test]
fn a_slip_in_a_machine_file_is_answered_by_what_to_write() {
    let folder = Folder::new("slips");
    let plain = "\"w X' Y' b Z t\"";
    for (chain, sections, remedy) in [
        ("'w X' Y' b Z t'", "", "double quotes keep the primes: `chain: \"w X' Y' b Z t\"`"),
        (plain, "errors: { X-Y: 0.02/500 }\n", "as an error it is `EC0Y`, with its sign"),
        (plain, "errors: { EC0Y: 2 min }\n", "minutes of arc are `arcmin`"),
        (plain, "errors: { EC0Y: 2' }\n", "minutes of arc are `arcmin`"),
        (plain, "errors:\n  EC0Y: 2\"\n", "seconds of arc are `arcsec`"),
        (plain, "tolerances: { X-Y: 0.02/500, Y-X: 0.02/500 }\n", "squareness of X and Y is given twice"),
        (plain, "tool_poses: part.csv\n", "a job: give its file by `--job`"),
        (plain, "bounds: { EXX: 5 um }\n", "did you mean `tolerances`?"),
        (plain, "errors: { ec0y: 5 urad }\n", "did you mean `EC0Y`?"),
        (plain, "errors: { XY: 5 urad }\n", "a squareness has a dash, `X-Y`"),
        (plain, "\u{a0}volume: {}\n", "a no-break space stands in it"),
        (plain, "errors: { EXX: { constant: 5 um } }\n", "did you mean `value`?"),
    ] {
        let file = folder.with("m.yaml", &three_axes(chain, sections));
        let (code, message) = refused(&["check", text(&file)]);
        let one_line = message.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(code == 1 && one_line.contains(remedy), "{message}");
    }
    // As data sheets write it.
    let figure = |written: &str| {
        let file = folder.with("m.yaml", &three_axes(plain, &format!("errors: {{ EC0Y: {written} }}\n")));
        json(&["map", text(&file), "--format", "json"])["position_um"]["max"].as_f64().unwrap()
    };
    // 40 urad over the 400 mm of Y, to rounding.
    for written in ["0.02 mm/500 mm", "20 um / 0.5 m", "40 urad"] {
        assert!((figure(written) - 16.0).abs() < 1e-6, "{written}");
    }
}

#[test]
fn a_file_of_another_kind_is_answered_by_its_option() {
    let folder = Folder::new("other-kind");
    let machine = folder.with("m.yaml", &three_axes("\"w X' Y' b Z t\"", ""));
    let job = folder.with("job.yaml", "tool_poses: part.csv\n");
    let (code, message) = refused(&["map", text(&machine), "--tool-poses", text(&job)]);
    assert!(code == 1 && message.contains("is a YAML file, not a table") && message.contains("`--job`"), "{message}");
}

/// A box whose tool comes from inside: every normal against the tool axis, and without normals the top from below.
#[test]
fn a_tool_axis_into_the_material_is_asked_about() {
    let folder = Folder::new("reversed");
    let says = |table: &str| {
        let part = folder.with("part.csv", table);
        refused(&["map", text(&crate::configs::folder().join("trunnion.yaml")), "--tool-poses", text(&part)]).1
    };
    for (table, is_asked) in [
        ("X,Y,Z,I,J,K\n0,0,50,0,0,-1\n0,0,50,0,1,0\n", true),
        ("X,Y,Z,I,J,K\n0,0,50,0,0,1\n0,0,50,0,1,0\n", false),
        ("X,Y,Z,I,J,K\n0,0,50,0,0,-1\n0,0,50,0,0,1\n", false),
        ("X,Y,Z,I,J,K,NX,NY,NZ\n0,0,50,0,0,1,0,0,-1\n", true),
        // A flank says nothing.
        ("X,Y,Z,I,J,K,NX,NY,NZ\n0,0,50,0,0,1,0,1,0\n", false),
    ] {
        let said = says(table);
        assert_eq!(said.contains("W0855"), is_asked, "{table}{said}");
    }
}

#[test]
fn a_module_for_other_directions_names_the_axis_and_what_to_write() {
    let folder = Folder::new("other-way");
    let trunnion = crate::configs::folder().join("trunnion.yaml");
    let head = folder.with(
        "head.yaml",
        "abbe: 1\nmachine: m\nchain: \"w C' Y' b X Z B t\"\naxes:\n  X: { travel: [0 mm, 500 mm] }\n  \
         Y: { travel: [0 mm, 400 mm] }\n  Z: { travel: [-400 mm, 0 mm] }\n  \
         B: { travel: [-90 deg, 90 deg], origin: [0, 0, 200] }\n  \
         C: { travel: continuous, sense: direct, origin: [0, 0, -300] }\n\
         tool: { gauge: [0, 0, 0], length: 100 mm }\nworkpiece: { origin: [0, 0, -300] }\nerrors: { EX0C: 5 um }\n",
    );
    for (file, target, remedy) in [
        (
            &trunnion,
            "linuxcnc-trt",
            "`C` turns the other way round there: if it does so on your machine, write `sense: direct`",
        ),
        (&head, "linuxcnc-maxkins", "write `direction: [0, -1, 0]`"),
        (&trunnion, "linuxcnc-maxkins", "this target is for one rotary axis that carries the tool"),
    ] {
        let out = folder.file("never");
        let (code, message) = refused(&["compile", text(file), "--target", target, "--out", text(&out)]);
        let one_line = message.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(code == 1 && one_line.contains(remedy), "{message}");
    }
}

/// Slips of the third walk, each with what is to be written.
#[test]
fn a_slip_of_units_lists_and_curves_is_answered_by_its_cause() {
    let folder = Folder::new("slips-3");
    let sound = three_axes("\"w X' Y' b Z t\"", "");
    let changed = |from: &str, to: &str| {
        let text = sound.replace(from, to);
        assert_ne!(text, sound, "{from}");
        text
    };
    let with = |sections: &str| three_axes("\"w X' Y' b Z t\"", sections);
    for (written, remedy) in [
        (changed("length: 100 mm", "length = 100 mm"), "write `length: 100 mm`, with a colon in place of `=`"),
        (with("tolerances: { EXX: 6 UM }\n"), "units are in small letters"),
        (with("tolerances: { EXX: 6 micron }\n"), "micrometres are `um`"),
        (with("tolerances: { EXX: 2 thou }\n"), "a thousandth of an inch is `0.001 in`"),
        (with("tolerances: { X-Y: 0.0005/12 in }\n"), "`0.0005` has no unit"),
        (with("tolerances: { EXX: { Tp: 12 um, U: 2 um } }\n"), "`Tp`, `U` do not go together for `EXX`"),
        (with("errors: { EXX: { points: [0 um, 2 um] } }\n"), "write each point as [position, value]"),
        (
            with("errors: { EXX: { points: [[0 mm, 0 um], [400 mm, 3 um]] } }\n"),
            "that is the travel of `Y`: is it `EXY`?",
        ),
        (
            with("errors: { EXX: { points: [[0 um, 0 mm], [5 um, 500 mm]] } }\n"),
            "each point is [position, value]: are the two exchanged",
        ),
        (changed("[0 mm, 500 mm]", "[0 mm, 500,5 mm]"), "write decimals with a point, `500.5 mm`"),
        (changed("[0 mm, 500 mm]", "[0 mm - 500 mm]"), "part the ends by a comma"),
        (changed("[250, 200, -450]", "[250; 200; -450]"), "part the numbers by commas"),
        (changed("\"w X' Y' b Z t\"", "\u{201c}w X' Y' b Z t\u{201d}"), "the chain stands in typographic quotes"),
        (changed("X: { travel", "X: { direction: Y, travel"), "write it as `direction: [0, 1, 0]`"),
    ] {
        let file = folder.with("m.yaml", &written);
        let (code, message) = refused(&["check", text(&file)]);
        let one_line = message.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(code == 1 && one_line.contains(remedy), "{remedy}: {message}");
    }
    // A column in the wrong unit is named, in its file.
    folder.with("x.csv", "X [mm],EXX [mm],EYX [um]\n0,0,0\n500,60,2\n");
    let (_, message) = refused(&["check", text(&folder.with("m.yaml", &with("measured: [x.csv]\n")))]);
    assert!(message.contains("`EXX` reaches 60 mm") && message.contains("x.csv:1:8"), "{message}");
    // The minus of typography is one.
    let file = folder.with("m.yaml", &with("errors: { EC0Y: \u{2212}40 urad }\n"));
    let found = json(&["map", text(&file), "--format", "json"])["position_um"]["max"].as_f64().unwrap();
    assert!((found - 16.0).abs() < 1e-6, "{found}");
}

#[test]
fn a_workbook_a_report_as_pdf_and_a_maker_are_answered() {
    let folder = Folder::new("slips-4");
    let book = folder.with("m.xlsx", "PK\u{3}\u{4}rest");
    let (code, message) = refused(&["check", text(&book)]);
    assert!(code == 1 && message.contains("E0104") && message.contains("a workbook of a spreadsheet"), "{message}");
    let machine = folder.with("m.yaml", &three_axes("\"w X' Y' b Z t\"", "errors: { EC0Y: 40 urad }\n"));
    let page = folder.file("review.pdf");
    let (code, message) = refused(&["report", text(&machine), "--out", text(&page)]);
    assert!(code == 2 && message.contains("name it .html") && !page.exists(), "{message}");
    let (code, message) = refused(&["targets", "siemens"]);
    assert!(code == 1 && message.contains("`sinumerik-cec`") && !message.contains("`klipper`"), "{message}");
    let machine = folder.with("c.yaml", &format!("{FIVE}class: commodity\n"));
    let (_, message) = refused(&["check", text(&machine)]);
    assert!(message.contains("W0413") && message.contains("has no tolerances of rotary axes"), "{message}");
}

/// Metres, radians, and sides of a part without directions of the tool.
#[test]
fn tool_poses_of_another_unit_or_without_directions_are_asked_about() {
    let folder = Folder::new("slips-5");
    let trunnion = crate::configs::folder().join("trunnion.yaml");
    let says = |table: &str| {
        let part = folder.with("part.csv", table);
        refused(&["map", text(&trunnion), "--tool-poses", text(&part)]).1
    };
    for (table, words) in [
        ("X,Y,Z\n0.05,0.02,0.05\n0.01,0.02,0.06\n", "are these metres?"),
        ("X [mm],Y [mm],Z [mm]\n0.05,0.02,0.05\n0.01,0.02,0.06\n", ""),
        ("X,Y,Z,A,C\n0,0,50,-1.57,3.14\n10,0,50,0,1.57\n", "are these radians?"),
        ("X,Y,Z,A,C\n0,0,50,-90,3\n10,0,50,0,2\n", ""),
        ("X,Y,Z,NX,NY,NZ\n0,0,50,0,0,1\n10,0,50,0,0,-1\n", "no row a direction of the tool"),
        // A bore, milled by its flank.
        ("X,Y,Z,NX,NY,NZ\n0,0,50,0,0,1\n10,0,50,1,0,0\n", ""),
    ] {
        let said = says(table).split_whitespace().collect::<Vec<_>>().join(" ");
        match words {
            "" => assert!(!said.contains("W0804") && !said.contains("W0855"), "{table}{said}"),
            words => assert!(said.contains(words), "{table}{said}"),
        }
    }
}

#[test]
fn an_unknown_option_is_answered_by_those_of_the_verb() {
    let (code, said) = refused(&["map", "--pose", "3", "m.yaml"]);
    assert!(code == 2 && said.contains("`map` has --random") && !said.contains("as a value"), "{said}");
    assert!(said.lines().all(|line| line.chars().count() <= 80), "{said}");
    let (code, said) = refused(&["map", "--randm", "3", "m.yaml"]);
    assert!(code == 2 && said.contains("'--random'") && !said.contains("`map` has"), "{said}");
}

#[test]
fn a_long_line_of_a_file_is_cut_about_the_mistake() {
    let folder = Folder::new("long-line");
    let points: Vec<String> = (0..40).map(|i| format!("[{i} mm, {i} um]")).collect();
    let curve = format!("errors: {{ EXX: {{ points: [{}, [500 mm, nan um]] }} }}\n", points.join(", "));
    let other = format!("errors: {{ EXX: {{ points: [{}], bogus: 1 }} }}\n", points.join(", "));
    for (sections, mark) in [(curve, "nan um"), (other, "bogus")] {
        let file = folder.with("m.yaml", &three_axes("\"w X' Y' b Z t\"", &sections));
        let check =
            std::process::Command::new(env!("CARGO_BIN_EXE_abbe")).args(["check", text(&file)]).output().unwrap();
        let said = String::from_utf8(check.stderr).unwrap();
        let quoted = said.lines().any(|line| line.starts_with(char::is_numeric) && line.contains(mark));
        assert!(!check.status.success() && quoted && said.contains("^^^^^"), "{said}");
        assert!(said.lines().all(|line| line.chars().count() <= 80), "{said}");
    }
}

#[test]
fn errors_in_inches_beside_bare_travels_are_asked_about() {
    let folder = Folder::new("bare-inches");
    let bare = FIVE.replace("[0, 500]", "[0, 20]");
    let with_units = FIVE.replace("[0, 500]", "[0 mm, 500 mm]").replace("[0, 400]", "[0 mm, 400 mm]");
    let with_units = with_units.replace("[-300, 0]", "[-300 mm, 0 mm]");
    for (machine, errors, asks) in [
        (&bare, "errors: { EXX: 0.0005 in }", true),
        (&bare, "tolerances: { EXX: { A: 0.0005 in } }", true),
        (&bare, "tolerances: { EXX: { A: 12 um } }", false),
    ] {
        let file = folder.with("m.yaml", &format!("{machine}{errors}\n"));
        let said = refused(&["check", text(&file)]).1;
        assert_eq!(said.contains("which is mm; errors of this file are in inches"), asks, "{errors}: {said}");
    }
    let file = folder.with("m.yaml", &format!("{with_units}tolerances: {{ EXX: 0.0005 in }}\n"));
    assert!(!refused(&["check", text(&file)]).1.contains("`axes.X.travel` has"));
}

#[test]
fn files_of_zeros_say_what_they_take_away() {
    let folder = Folder::new("zeros");
    let file = folder.with("m.yaml", &format!("{FIVE}tolerances: {{ EXX: 5 um }}\n"));
    let (_, said) = refused(&["compile", text(&file), "--target", "linuxcnc", "--out", text(&folder.file("set"))]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("no error of the machine has a value: loaded, these zeros take away what is in force"),
        "{said}"
    );
}

#[test]
fn a_square_whose_signs_were_not_turned_is_asked_about() {
    let folder = Folder::new("square-turned");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", ""));
    let run = |name: &str, of: &dyn Fn(f64) -> f64| -> String {
        [0.0, 100.0, 200.0, 300.0].map(|y| format!("{name},{y},{}\n", of(y))).concat()
    };
    // 0.2 um/mm of the machine, 0.02 of the square, readings to the micrometre.
    let (face, turned) = (|y: f64| (0.22 * y).round(), |y: f64| (0.18 * y).round());
    for (second, words) in [
        (run("turned", &turned), None),
        (run("turned", &|y| -turned(y)), Some("is the opposite of that of run `face`")),
        (run("turned", &|y| 2.0 * turned(y)), Some("is about twice that of run `face`")),
    ] {
        let rows = format!("run,Y [mm],rel.dx [um]\n{}{second}", run("face", &face));
        let data = folder.with("square.csv", &rows);
        let (_, said) = refused(&["identify", text(&machine), "--data", text(&data), "--fit", "EC0Y"]);
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(said.contains("W0520"), words.is_some(), "{said}");
        assert!(words.is_none_or(|words| said.contains(words)), "{said}");
    }
}

#[test]
fn relative_readings_in_columns_of_whole_ones_are_asked_about() {
    let folder = Folder::new("whole-or-relative");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", ""));
    let rows = |first: f64| -> String {
        let run =
            |name: &str| [0.0, 100.0, 200.0, 300.0].map(|y: f64| format!("{name},{y},{}\n", first + (0.2 * y).round()));
        run("a").concat() + &run("b").concat()
    };
    for (column, first, asks) in [("dx [um]", 0.0, true), ("dx [um]", 3.0, false), ("rel.dx [um]", 0.0, false)] {
        let data = folder.with("square.csv", &format!("run,Y [mm],{column}\n{}", rows(first)));
        let (_, said) = refused(&["identify", text(&machine), "--data", text(&data), "--fit", "EC0Y"]);
        assert_eq!(said.contains("every run begins with zeros"), asks, "{column} {first}: {said}");
    }
}

#[test]
fn a_scale_of_another_control_is_asked_about() {
    let folder = Folder::new("other-scale");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", "errors: { EC0Y: 200 urad }\n"));
    for (number, (target, scale, asks)) in [
        ("klipper", "X=80,Y=80,Z=400", true),
        ("klipper", "X=40,Y=40,Z=8", false),
        ("marlin", "X=40,Y=40,Z=8", true),
        ("marlin", "X=80,Y=80,Z=400", false),
    ]
    .into_iter()
    .enumerate()
    {
        let out = folder.file(&number.to_string());
        let said = refused(&["compile", text(&machine), "--target", target, "--scale", scale, "--out", text(&out)]).1;
        assert_eq!(said.contains("is seldom: this control counts"), asks, "{target} {scale}: {said}");
    }
}

#[test]
fn a_wrong_row_of_few_and_a_machine_seen_by_eye_are_warned_of() {
    let folder = Folder::new("few-rows");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", ""));
    let rows = |run: &str, wrong: f64, unit: f64| -> String {
        let value = |i: f64| if i == 3.0 { wrong * 60.0 * i } else { 60.0 * i + 0.5 * noise(i) };
        [0.0, 1.0, 2.0, 3.0, 4.0].map(|i| format!("{run},{},{:.1}\n", (50.0 + 100.0 * i) / unit, value(i))).concat()
    };
    for (wrong, unit, code) in [(1.0, 1.0, None), (10.0, 1.0, Some("W0507")), (1.0, 25.4, Some("W0512"))] {
        let table = format!("run,Y [mm],rel.dx [um]\n{}{}", rows("face", wrong, unit), rows("turned", 1.0, unit));
        let data = folder.with("square.csv", &table);
        let (_, said) = refused(&["identify", text(&machine), "--data", text(&data), "--fit", "EC0Y"]);
        for known in ["W0507", "W0512"] {
            assert_eq!(said.contains(known), code == Some(known), "{wrong} {unit}: {said}");
        }
    }
}

/// Half a micrometre of noise, the same in every run.
fn noise(i: f64) -> f64 {
    [0.0, 0.4, -0.7, 0.9, -0.3][i as usize]
}

#[test]
fn travels_and_letters_that_are_seldom_meant_are_asked_about() {
    let folder = Folder::new("seldom");
    let [x, a] = ["X: { travel: [0, 500]", "A: { travel: [-90, 90]"];
    for (from, to, asks) in [
        (x, "X: { travel: [0 mm, 500 m]", "axis `X` travels from 0 to 500000 mm"),
        (a, "A: { travel: [-110 rad, 110 rad]", "axis `A` travels from -6302.54 to 6302.54 deg"),
        (a, "A: { direction: [0, 0, 1], travel: [-90, 90]", "axis `A` turns about Z: by ISO 841 such an axis is `C`"),
    ] {
        let file = folder.with("m.yaml", &FIVE.replace(from, to));
        let (code, said) = refused(&["check", text(&file)]);
        assert!(code == 0 && said.contains(asks), "{to}: {said}");
    }
    let file = folder.with("m.yaml", FIVE);
    assert_eq!(refused(&["check", text(&file)]).1, "");
}

#[test]
fn readings_of_few_rows_that_lost_something_are_asked_about() {
    let folder = Folder::new("lost-rows");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", ""));
    let run = |name: &str, by: f64, count: usize| -> String {
        let one = |i: usize| format!("{name},{},{:.3}\n", 100 * i, by * (20.0 * i as f64 + 2.0 * noise(i as f64)));
        (0..count).map(one).collect()
    };
    let whole = run("face", 1.0, 5) + &run("turned", 0.9, 5);
    for (rows, words) in [
        (whole.clone(), None),
        (run("face", 1.0, 5) + &run("turned", 0.9, 3), Some("ends after 3 of the 5 places of run `face`")),
        (run("face", 1.0, 5) + &run("turned", 0.9, 1), Some("a single rel.dx of run `turned` is left")),
        (run("face", 1.0, 2), Some("2 readings determine as many unknowns")),
        (whole.clone() + &whole, Some("10 readings of poses measured before are the same to the last digit")),
        (run("face", 1e-3, 5) + &run("turned", 0.9e-3, 5), Some("half of the readings are 0.0")),
    ] {
        let data = folder.with("square.csv", &format!("run,Y [mm],rel.dx [um]\n{rows}"));
        let (_, said) = refused(&["identify", text(&machine), "--data", text(&data), "--fit", "EC0Y"]);
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.map_or(said.is_empty(), |words| said.contains(words)), "{rows}{said}");
    }
    // A square known to a thirtieth: nothing is in doubt.
    let few = "face,100,0\nface,200,22\nface,300,43\nface,400,66\n\
               turned,100,0\nturned,200,19\nturned,300,37\nturned,400,57\n";
    let data = folder.with("square.csv", &format!("run,Y [mm],rel.dx [um]\n{few}"));
    let arguments = ["identify", text(&machine), "--data", text(&data), "--fit", "EC0Y"];
    let said = abbe(&arguments);
    assert!(said.contains("EC0Y") && !said.contains("below noise"), "{said}");
    assert!(!json(&[&arguments[..], &["--format", "json"]].concat())["drowned"].as_array().unwrap().is_empty());
}

#[test]
fn a_scale_that_cannot_be_read_is_answered_by_its_cause() {
    let folder = Folder::new("scale-words");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", "errors: { EC0Y: 200 urad }\n"));
    for (scale, cause) in [
        ("x=80", "`x` is no name of an axis; did you mean `X`?"),
        ("X=80,5", "`5` has no `=`: decimals have a point"),
        ("80", "`80` has no `=`: name its axis"),
        ("X=eighty", "`X=eighty` is not a number from"),
        ("X=80,X=80", "`X` is there twice"),
    ] {
        let out = folder.file("never");
        let arguments = ["compile", text(&machine), "--target", "marlin", "--scale", scale, "--out", text(&out)];
        let (code, said) = refused(&arguments);
        assert!(code == 2 && said.contains(cause), "{said}");
    }
}

#[test]
fn a_folder_without_files_of_a_control_is_called_that() {
    let folder = Folder::new("no-set");
    let machine = folder.with("m.yaml", &three_axes("w b Y X Z t", "identify: { fit: [EC0Y] }\n"));
    let (code, said) = refused(&["verify", text(&machine), text(machine.parent().unwrap())]);
    assert!(code == 1 && said.contains("E0705") && !said.contains("M17"), "{said}");
}
