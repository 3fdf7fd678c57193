//! `abbe import` judges readings: good tests of a ball screw pass, and each kind of trouble is named with its line. The
//! campaigns are drawn by formulas of this file.

use super::identify::run;
use super::oracle::program::Folder;
use super::oracle::random::Random;
use abbe::options::Acceptance;
use abbe::results::ImportResult;
use abbe::syntax::{Files, ReadFailure};
use abbe::{Diagnostics, ImportOptions, Run, import};
use serde_json::Value;
use std::path::Path;

/// One file in memory.
struct One(String);

impl Files for One {
    fn read(&self, _: &Path) -> Result<Vec<u8>, ReadFailure> {
        Ok(self.0.clone().into_bytes())
    }
}

fn normal(random: &mut Random) -> f64 {
    (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (std::f64::consts::TAU * random.unit()).cos()
}

/// A test after ISO 230-2: targets (mm) and readings (um) by run, direction and target.
struct Campaign {
    targets: Vec<f64>,
    readings: Vec<[Vec<f64>; 2]>,
    /// Scatter of a reading, um.
    sigma: f64,
    /// Lost motion, um.
    lost: f64,
}

impl Campaign {
    /// A good one: lead error, a period of the screw, lost motion that changes over the travel, scatter that grows with
    /// it, and runs that differ a little, in level and in slope.
    fn draw(random: &mut Random) -> Self {
        let (targets, runs) = (5 + random.below(11), 1 + random.below(6));
        let length = random.between(200.0, 3000.0);
        let pitch = length / (targets as f64 - 1.0);
        let at = |i: usize, random: &mut Random| {
            i as f64 * pitch + random.around(0.3 * pitch) * 0.9 * f64::from(u8::from(i > 0))
        };
        let targets: Vec<f64> = (0..targets).map(|i| (at(i, random) * 10.0).round() / 10.0).collect();
        let sigma = random.between(0.1, 1.5);
        let (lead, sine, phase) = (random.around(60.0), random.between(0.5, 4.0), random.between(0.0, 6.0));
        let (lost, wind, grows) = (random.between(0.0, 8.0), random.around(0.4), random.between(0.0, 0.8));
        let step = [0.01, 0.1][random.below(2)];
        let readings = (0..runs).map(|_| {
            let (level, slope) = (0.4 * sigma * normal(random), 0.5 * sigma * normal(random));
            [-0.5, 0.5].map(|way| {
                let reading = |x: &f64| {
                    let part = x / length;
                    let screw = lead * x * 1e-3 + sine * (5.0 * part + phase).sin();
                    let noise = sigma * (1.0 + grows * part) * normal(random);
                    let reversal = way * lost * (1.0 + wind * (2.0 * part - 1.0));
                    ((screw + reversal + level + slope * part + noise) / step).round() * step
                };
                targets.iter().map(reading).collect()
            })
        });
        let readings = readings.collect();
        Self { targets, readings, sigma, lost }
    }

    /// A good one of at least so many runs.
    fn with_runs(random: &mut Random, runs: usize) -> Self {
        loop {
            let campaign = Self::draw(random);
            if campaign.readings.len() >= runs {
                return campaign;
            }
        }
    }

    fn header(&self) -> String {
        let runs = 1..=self.readings.len();
        let titles: String = runs.map(|run| format!(";{run}+ [um];{run}- [um]")).collect();
        format!("position [mm]{titles}\n")
    }

    fn rows(&self) -> Vec<String> {
        let row = |(i, target): (usize, &f64)| {
            let cells: String = self.readings.iter().flatten().map(|pass| format!(";{:.5}", pass[i])).collect();
            format!("{target}{cells}\n")
        };
        self.targets.iter().enumerate().map(row).collect()
    }

    fn text(&self) -> String {
        self.header() + &self.rows().concat()
    }

    fn each(&mut self, change: impl Fn(usize, usize, f64) -> f64) {
        for (run, ways) in self.readings.iter_mut().enumerate() {
            for pass in ways {
                pass.iter_mut().enumerate().for_each(|(i, value)| *value = change(run, i, *value));
            }
        }
    }
}

fn options(error: &str) -> ImportOptions {
    ImportOptions { error: Some(error.to_owned()), ..ImportOptions::default() }
}

fn judge(text: &str, options: &ImportOptions) -> Result<ImportResult, Diagnostics> {
    let file = One(text.to_owned());
    import("laser.csv", options, Run::with(&file)).map(|answer| answer.value)
}

/// The kinds of the findings, as the JSON names them; of a refusal its messages.
fn kinds(text: &str) -> Vec<String> {
    match judge(text, &options("EXX")) {
        Ok(result) => {
            let report = serde_json::to_value(&result).unwrap();
            let findings = report["findings"].as_array().unwrap();
            findings.iter().map(|finding| finding["kind"].as_str().unwrap().to_owned()).collect()
        }
        Err(refused) => refused.iter().map(ToString::to_string).collect(),
    }
}

/// At most 1 % of good files are suspected of anything.
#[test]
fn good_campaigns_pass() {
    let mut random = Random::new(41);
    let mut alarms = Vec::new();
    for _ in 0..500 {
        let text = Campaign::draw(&mut random).text();
        let found = kinds(&text);
        if !found.is_empty() {
            alarms.push(format!("{found:?}\n{text}"));
        }
    }
    assert!(alarms.len() <= 5, "{} of 500\n{}", alarms.len(), alarms.join("\n"));
}

/// Of a hundred campaigns with a trouble at least `share` are named by the words.
fn named(seed: u64, words: &str, share: usize, runs: usize, trouble: impl Fn(&mut Campaign, &mut Random) -> String) {
    let mut random = Random::new(seed);
    let mut missed = Vec::new();
    for _ in 0..100 {
        let mut campaign = Campaign::with_runs(&mut random, runs);
        let text = trouble(&mut campaign, &mut random);
        let found = kinds(&text);
        if !found.iter().any(|found| found.contains(words)) {
            missed.push(format!("{found:?} {} {}\n{text}", campaign.sigma, campaign.lost));
        }
    }
    assert!(missed.len() <= 100 - share, "{words}: {} missed\n{}", missed.len(), missed.join("\n"));
}

#[test]
fn troubles_of_single_readings_and_of_trends_are_named() {
    named(1, "outlier", 98, 2, |campaign, random| {
        let (run, way) = (random.below(campaign.readings.len()), random.below(2));
        let target = random.below(campaign.targets.len());
        campaign.readings[run][way][target] += if random.chance(0.5) { 40.0 } else { -40.0 };
        campaign.text()
    });
    named(2, "drift", 95, 4, |campaign, _| {
        let step = 4.0 * campaign.sigma;
        campaign.each(|run, _, value| value + step.max(1.0) * run as f64);
        campaign.text()
    });
    named(3, "twice", 100, 1, |campaign, random| {
        let mut rows = campaign.rows();
        let (again, at) = (random.below(rows.len()), random.below(rows.len()));
        rows.insert(at, rows[again].clone());
        campaign.header() + &rows.concat()
    });
}

#[test]
fn exchanged_directions_are_named() {
    let steady = |campaign: &Campaign| campaign.lost > 4.0 * campaign.sigma && campaign.lost > 1.5;
    named(4, "directions-exchanged", 95, 1, |campaign, random| {
        while !steady(campaign) {
            *campaign = Campaign::draw(random);
        }
        campaign.readings.iter_mut().for_each(|ways| ways.swap(0, 1));
        campaign.text()
    });
    named(5, "with its directions exchanged, the reversal of run", 95, 2, |campaign, random| {
        while !steady(campaign) || campaign.readings.len() < 2 {
            *campaign = Campaign::draw(random);
        }
        let run = random.below(campaign.readings.len());
        campaign.readings[run].swap(0, 1);
        campaign.text()
    });
}

#[test]
fn other_units_are_named() {
    let curve = |campaign: &Campaign| {
        let pass = &campaign.readings[0][0];
        let ends = pass.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
        (ends[1] - ends[0]) / campaign.sigma
    };
    let (high, low) = (30.0..f64::INFINITY, 12.0..30.0);
    for (seed, factor, words, curves, share) in [
        (6, 1e-3, "mm taken for um", &high, 95),
        (7, 1.0 / 25.4, "thousandths of an inch", &high, 95),
        (8, -1.0, "the other sign", &high, 95),
        (12, 1e-3, "mm taken for um", &low, 90),
        (13, 1e3, "E05", &low, 90),
        (14, 10.0, "a decimal place too many", &low, 90),
        (15, -1.0, "the other sign", &low, 85),
    ] {
        named(seed, words, share, 2, |campaign, random| {
            // Readings above 10 mm are refused before.
            let large =
                |campaign: &Campaign| campaign.readings.iter().flatten().flatten().any(|x| (x * factor).abs() > 9e3);
            while !curves.contains(&curve(campaign)) || campaign.readings.len() < 2 || large(campaign) {
                *campaign = Campaign::draw(random);
            }
            let (run, way) = (random.below(campaign.readings.len()), random.below(2));
            campaign.readings[run][way].iter_mut().for_each(|value| *value *= factor);
            campaign.text()
        });
    }
    named(9, "E0543", 100, 1, |campaign, _| {
        campaign.each(|_, _, value| value * 1e-3);
        campaign.text()
    });
    named(10, "E05", 98, 1, |campaign, _| campaign.text().replace("[um]", "[mm]"));
    // Positions in m, too, and columns exchanged.
    named(11, "E0543", 98, 1, |campaign, _| {
        let header = campaign.header().replacen("position [mm];1+ [um]", "1+ [um];position [mm]", 1);
        header + &campaign.rows().concat()
    });
}

const HEADER: &str = "position [mm];1+ [um];1- [um];2+ [um];2- [um];3+ [um];3- [um]\n";

/// Ten targets, three runs: a curve, lost motion of 2.5 um, and digits that scatter by 0.3 um.
fn small() -> Vec<String> {
    let digits = [3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3, 2, 3, 8, 4, 6, 2, 6, 4, 3, 3, 8, 3, 2, 7];
    let row = |i: usize| {
        let x = i as f64 * 98.7 + 12.3;
        let value = |pass: usize| {
            let noise = (f64::from(digits[(i * 7 + pass * 11) % 30]) - 4.5) * 0.1;
            0.013 * x + 2.0 * (x / 150.0).sin() + [0.0, 2.5][pass % 2] + noise
        };
        let cells: String = (0..6).map(|pass| format!(";{:.2}", value(pass))).collect();
        format!("{x:.1}{cells}\n")
    };
    (0..10).map(row).collect()
}

/// What the program prints: exit, report or diagnostics as JSON, text, and the table.
struct Printed {
    code: Option<i32>,
    report: Value,
    stderr: String,
    table: Option<String>,
}

fn program(text: &str, arguments: &[&str]) -> Printed {
    let folder = Folder::new();
    let (file, out) = (folder.write("laser.csv", text), folder.path("x.csv"));
    let all = [&["import", file.to_str().unwrap(), "--out", out.to_str().unwrap()], arguments].concat();
    let output = run(&all);
    let json = run(&[&["import", file.to_str().unwrap(), "--format", "json"], arguments].concat());
    Printed {
        code: output.status.code(),
        report: serde_json::from_slice(&json.stdout).unwrap_or_default(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        table: std::fs::read_to_string(out).ok(),
    }
}

#[test]
fn an_outlier_is_left_out_of_table_and_figures_unless_it_is_accepted() {
    let rows = small();
    let good = program(&(HEADER.to_owned() + &rows.concat()), &["--error", "EXX"]);
    assert_eq!((good.code, &good.report["findings"]), (Some(0), &Value::Array(Vec::new())), "{}", good.stderr);
    // Line 5, run 2 forward.
    let mut cells: Vec<String> = rows[3].trim().split(';').map(str::to_owned).collect();
    let means = |cells: &[String], from: usize| {
        let of = |k: &usize| cells[*k].parse::<f64>().unwrap();
        [1, 3, 5].iter().filter(|k| **k != from).map(of).sum::<f64>() / if from == 0 { 3.0 } else { 2.0 }
    };
    let without = means(&cells, 3);
    cells[3] = "148.20".to_owned();
    let with = means(&cells, 0);
    let text = HEADER.to_owned() + &rows[..3].concat() + &cells.join(";") + "\n" + &rows[4..].concat();
    let at = |printed: &Printed| {
        let table = printed.table.as_deref().unwrap();
        let row = table.lines().find(|line| line.starts_with("308.4,")).unwrap_or_else(|| panic!("{table}"));
        row.split(", ").nth(1).unwrap().parse::<f64>().unwrap()
    };
    let found = program(&text, &["--error", "EXX"]);
    assert!(
        found.code == Some(0) && found.stderr.contains("W0520") && found.stderr.contains("laser.csv:5"),
        "{}",
        found.stderr
    );
    for word in ["run 2 forward of `EXX` reads 148.2 um at 308.4 mm", "exclude", "--accept suspect"] {
        assert!(found.stderr.contains(word), "{word}: {}", found.stderr);
    }
    assert!((at(&found) - without).abs() < 1e-5, "{:?}", found.table);
    assert!(found.table.as_deref().unwrap().contains("# left out: run 2 forward"), "{:?}", found.table);
    let finding = &found.report["findings"][0];
    assert_eq!((&finding["kind"], &finding["effect"]), (&"outlier".into(), &"left-out".into()), "{finding}");
    assert_eq!((&finding["lines"], &finding["error"]), (&serde_json::json!([5]), &"EXX".into()), "{finding}");
    assert_eq!(found.report["readings"], 59);
    let taken = program(&text, &["--error", "EXX", "--accept", "suspect"]);
    assert!((at(&taken) - with).abs() < 1e-5, "{:?}", taken.table);
    assert_eq!((&taken.report["findings"][0]["effect"], &taken.report["readings"]), (&"accepted".into(), &60.into()));
    assert!(taken.table.as_deref().unwrap().contains("# accepted: run 2 forward"), "{:?}", taken.table);
    // Words of acceptance are known.
    assert_eq!(program(&text, &["--error", "EXX", "--accept", "anything"]).code, Some(2));
    // In a row for each reading the line is that of the reading.
    let mut tidy = "run,direction,position [mm],EXX [um]\n".to_owned();
    for (k, way) in [(1_usize, "+"), (2, "-"), (3, "+"), (4, "-"), (5, "+"), (6, "-")] {
        for line in text.lines().skip(1) {
            let cells: Vec<&str> = line.split(';').collect();
            tidy += &format!("{},{way},{},{}\n", k.div_ceil(2), cells[0], cells[k]);
        }
    }
    let line = 2 + tidy.lines().skip(1).position(|line| line.ends_with("148.20")).unwrap();
    assert_eq!(program(&tidy, &[]).report["findings"][0]["lines"][0], line, "{tidy}");
}

/// The refusals name line and remedy, nothing is written, and the caller's word takes the file.
#[test]
fn what_cannot_be_right_is_refused_until_it_is_accepted() {
    let rows = small();
    let each = |change: &dyn Fn(usize, &str) -> String| {
        let row = |row: &String| {
            let cells: Vec<String> = row.trim().split(';').enumerate().map(|(k, cell)| change(k, cell)).collect();
            cells.join(";") + "\n"
        };
        HEADER.to_owned() + &rows.iter().map(row).collect::<String>()
    };
    let times = |cell: &str, factor: f64| format!("{:.5}", cell.parse::<f64>().unwrap() * factor);
    let one_in_mm = each(&|k, cell| if k == 5 { times(cell, 1e-3) } else { cell.to_owned() });
    let all_in_mm = each(&|k, cell| if k > 0 { times(cell, 1e-3) } else { cell.to_owned() });
    let exchanged = one_in_mm.replacen("position [mm];1+ [um]", "1+ [um];position [mm]", 1);
    let unreadable =
        each(&|k, cell| if k == 0 && cell.len() > 4 && cell < "5" { format!("{cell} mm") } else { cell.to_owned() });
    let swapped: String = rows
        .iter()
        .map(|row| {
            let mut cells: Vec<&str> = row.trim().split(';').collect();
            cells.swap(3, 4);
            cells.join(";") + "\n"
        })
        .collect();
    for (text, words, line) in [
        (one_in_mm, "run 3 forward of `EXX` times 1000 agrees with the other runs", 2),
        (all_in_mm, "no instrument is that exact", 2),
        (exchanged, "the column of positions and this one are exchanged", 2),
        (unreadable, "rows cannot be read, the first one", 3),
        (HEADER.to_owned() + &swapped, "with its directions exchanged, the reversal of run 2 of `EXX` agrees", 2),
        (HEADER.replace("[um]", "[mm]") + "0;0;0;0;0;0;0\n300;1;1;1;1;1;1\n600;2;2;2;2;2;2\n", "no screw has more", 2),
    ] {
        let found = program(&text, &["--error", "EXX"]);
        assert!(found.code == Some(1) && found.table.is_none(), "{text}\n{}", found.stderr);
        for word in ["E0543", words, &format!("laser.csv:{line}"), "--accept suspect"] {
            assert!(found.stderr.contains(word), "{word}\n{text}\n{}", found.stderr);
        }
        let taken = program(&text, &["--error", "EXX", "--accept", "suspect"]);
        assert!(
            taken.code == Some(0) && taken.table.is_some() && taken.stderr.contains("W0520"),
            "{text}\n{}",
            taken.stderr
        );
        let effects: Vec<&Value> = taken.report["findings"].as_array().unwrap().iter().map(|f| &f["effect"]).collect();
        assert!(effects.contains(&&"accepted".into()), "{effects:?}");
    }
}

#[test]
fn runs_and_positions_of_a_log_are_told_apart() {
    let rows = |order: [usize; 2]| {
        let mut text = ["target,cycle", "cycle,target"][order[0]].to_owned() + ",direction,reading [um]\n";
        for run in 1..4 {
            for (k, way) in (0..6).chain((0..6).rev()).zip([["+"; 6], ["-"; 6]].concat()) {
                text += &format!("{},{run},{way},{}\n", k * 50, k * 2 + run % 2 + i32::from(way == "-"));
            }
        }
        text
    };
    assert_eq!(program(&rows([0, 1]), &["--error", "EXX"]).code, Some(0));
    let found = program(&rows([1, 0]), &["--error", "EXX"]);
    assert!(
        found.code == Some(1) && found.stderr.contains("the runs 0 to 250: the two columns are exchanged"),
        "{}",
        found.stderr
    );
}

#[test]
fn numbers_of_other_notations_are_refused_with_the_remedy() {
    let table = |cells: [&str; 4]| {
        format!(
            "position [mm];1+ [um];1- [um]\n0;1.5;2.5\n{};2.5;3.5\n{};3.5;4.5\n{};{};5.5\n",
            cells[0], cells[1], cells[2], cells[3]
        )
    };
    for (text, line, words) in [
        (table(["1 234.5", "2 500.1", "3 800.2", "4.5"]), 3, "digits in groups"),
        (table(["1'234.5", "2'500.1", "3'800.2", "4.5"]), 3, "digits in groups"),
        (table(["500", "900", "1\u{2019}800.2", "4.5"]), 5, "digits in groups"),
        (table(["1\u{a0}234.5", "2\u{202f}500.1", "3\u{a0}800.2", "4.5"]), 3, "digits in groups"),
        (
            "position [mm],1+ [um],1- [um]\n0,1.5,2.5\n\"1,234.5\",2.5,3.5\n\"2,500.1\",3.5,4.5\n".to_owned(),
            3,
            "digits in groups",
        ),
        ("position [mm],1+ [um],1- [um]\n0,1.5,2.5\n500,1,2\n\"1,000\",2.5,3.5\n".to_owned(), 4, "digits in groups"),
        ("position [mm];1+ [um];1- [um]\n0;1;2\n500;1;2\n1,000;2;3\n1,500;2;4\n".to_owned(), 4, "in order only so"),
    ] {
        let found = program(&text, &["--error", "EXX"]);
        assert!(found.code == Some(1) && found.table.is_none(), "{text}");
        for word in ["E0509", words, &format!("laser.csv:{line}"), "without marks between thousands"] {
            assert!(found.stderr.contains(word), "{word}\n{text}\n{}", found.stderr);
        }
    }
    for cell in ["30°00'00\"", "30° 0\u{2032} 0\u{2033}", "30:00:00", "30 00 00"] {
        let text = format!("C [deg];1+ [arcsec];1- [arcsec]\n0;0;1\n{cell};1;2\n60;2;3\n90;2;3\n");
        let found = program(&text, &["--error", "ECC"]);
        assert!(found.code == Some(1) && found.table.is_none(), "{text}");
        for word in ["degrees, minutes and seconds", "laser.csv:3", "decimal degrees"] {
            assert!(found.stderr.contains(word), "{word}\n{text}\n{}", found.stderr);
        }
    }
}

#[test]
fn reports_of_means_are_refused_with_what_to_do() {
    let text = "position [mm];Mean + [um];Mean - [um];s + [um]\n0;1;2;0.1\n100;2;3;0.1\n200;4;5;0.1\n";
    let found = program(text, &["--error", "EXX"]);
    assert!(found.code == Some(1) && found.table.is_none());
    for word in ["means over the runs (`Mean + [um]`)", "export the runs", "--columns"] {
        assert!(found.stderr.contains(word), "{word}\n{}", found.stderr);
    }
    // As it says.
    let folder = Folder::new();
    let map = "position: position\ncolumns:\n  Mean +: { error: EXX, unit: um, direction: forward }\n  \
               Mean -: { error: EXX, unit: um, direction: reverse }\n";
    let map = folder.write("map.yaml", map);
    let found = program(text, &["--columns", map.to_str().unwrap()]);
    assert_eq!(
        found.table.as_deref(),
        Some("X [mm], EXX+ [um], EXX- [um]\n0, 1, 2\n100, 2, 3\n200, 4, 5\n"),
        "{}",
        found.stderr
    );
}

#[test]
fn titles_in_two_rows_and_lone_carriage_returns_are_read() {
    let rows = "0;0.5;1.5;-0.5;0.5\n100;2.5;3.5;1.5;2.5\n200;4.5;5.5;3.5;4.5\n";
    let table = "X [mm], EXX+ [um], EXX- [um]\n0, 0, 1\n100, 2, 3\n200, 4, 5\n";
    for titles in [
        "position [mm];1+ [um];1- [um];2+ [um];2- [um]\n",
        "position [mm];Run 1 [um];;Run 2 [um];\n;+;-;+;-\n",
        "Position;Run 1;;Run 2;\n;fwd;rev;fwd;rev\n[mm];[um];[um];[um];[um]\n",
        "position [mm];Run 1 [um];Run 1 [um];Run 2 [um];Run 2 [um]\n;up;down;up;down\n",
        ";Run 1;;Run 2;\nposition [mm];+ [um];- [um];+ [um];- [um]\n",
        ";1;1;2;2\nposition [mm];+ [um];- [um];+ [um];- [um]\n",
        "Machine: M\n\nPosition;Lauf 1;;Lauf 2;\nmm;vor;zurück;vor;zurück\n;um;um;um;um\n",
    ] {
        for text in [format!("{titles}{rows}"), format!("{titles}{rows}").replace('\n', "\r")] {
            let found = program(&text, &["--error", "EXX"]);
            let bare: String = found
                .table
                .iter()
                .flat_map(|table| table.lines())
                .filter(|line| !line.starts_with('#'))
                .map(|line| format!("{line}\n"))
                .collect();
            assert!(found.code == Some(0) && bare == table, "{text}\n{bare}{}", found.stderr);
        }
    }
    // Directions above, numbers of the runs below.
    let text = "Position [mm];Forward [um];;Reverse [um];\n;1;2;1;2\n\
                0;0.5;-0.5;1.5;0.5\n100;2.5;1.5;3.5;2.5\n200;4.5;3.5;5.5;4.5\n";
    let found = program(text, &["--error", "EXX"]);
    assert_eq!(found.table.as_deref(), Some(table), "{}", found.stderr);
    // The line of a fault is the one that a spreadsheet counts.
    let found = program("X [mm];EXX [um]\r0;1\r1'000;2\r", &[]);
    assert!(found.stderr.contains("laser.csv:3"), "{}", found.stderr);
}

#[test]
fn faults_of_a_mapping_are_in_words() {
    let folder = Folder::new();
    let text = "Kanal 0;Kanal 1\n0;1\n100;2\n";
    for (columns, words) in [
        ("Kanal 1: { error: EXX, unit: um, direction: up }", "`direction` is `forward` or `reverse`, not `up`"),
        ("Kanal 1: { errors: EXX }", "`errors` is no entry of a column; they are `error`, `unit`"),
        ("Kanal 1: excluded", "`excluded` is none of `run`, `direction`, `exclude`, `ignore`"),
        ("Kanal 1: { unit: um }", "`error` is missing"),
        ("Kanal 1: { error: EXX, run: [1] }", "`run` is a word or a number"),
        ("Kanal 1: { error: EXX, flip: yes please }", "`flip` is `true` or `false`"),
    ] {
        let map = format!("position: Kanal 0\ncolumns:\n  {columns}\n");
        let words = [&format!("column `Kanal 1`: {words}"), "map.yaml:3"];
        let map = folder.write("map.yaml", &map);
        let found = program(text, &["--columns", map.to_str().unwrap()]);
        assert!(found.code == Some(1) && found.stderr.contains("E0512"), "{}", found.stderr);
        words.iter().for_each(|word| assert!(found.stderr.contains(word), "{word}\n{}", found.stderr));
    }
    for (map, words) in [
        ("position: { colum: Kanal 0 }\ncolumns: {}\n", "`{ column: TITLE, unit: mm }` with these two keys only"),
        (
            "position: a\ncolumns: { a: ignore }\nholds: error\n",
            "unknown word `error`, expected `errors` or `corrections`",
        ),
        ("columns: {}\n", "missing entry `position`"),
    ] {
        let map = folder.write("map.yaml", map);
        let found = program(text, &["--columns", map.to_str().unwrap()]);
        assert!(found.code == Some(1) && found.stderr.contains("E0512"), "{}", found.stderr);
        assert!(found.stderr.contains(words) && !found.stderr.contains("untagged"), "{words}\n{}", found.stderr);
    }
}

/// The caller's word is an option of the library as well.
#[test]
fn the_library_accepts_too() {
    let text = HEADER.replace("[um]", "[mm]") + "0;0;0;0;0;0;0\n300;1;1;1;1;1;1\n600;2;2;2;2;2;2\n";
    assert!(judge(&text, &options("EXX")).is_err());
    let taken = judge(&text, &ImportOptions { accept: vec![Acceptance::Suspect], ..options("EXX") }).unwrap();
    assert_eq!(taken.findings.len(), 1);
}
