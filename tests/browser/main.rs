//! The pages in a real Chromium, driven over WebDriver: they load without the network and without complaint, show the
//! numbers of the program, and their controls, keys, following and saving do as labelled.
//!
//! Without Chromium every check is left out and named; with `ABBE_REQUIRE_BROWSER=1` (as in `tests/run`) that
//! is a failure. Screenshots are kept in `target/debug/screenshots/`.

// A test that panics is a test that fails: nothing to be careful about.
#![allow(clippy::disallowed_methods, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod blank;
#[path = "../it/support/checks.rs"]
mod checks;
mod driver;
mod files;
mod frames;
mod mailed;
mod meeting;
#[path = "../it/support/packed.rs"]
mod packed;
mod page;
mod pictures;
mod questions;
mod reader;
mod review;
mod watch;
mod workbench;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const CHECKS: [checks::Check; 51] = [
    ("the page loads with the network off and without a complaint", page::loads),
    ("every number shown is the one in the data", page::numbers),
    ("every control changes the picture, and taking it back restores it", page::controls),
    ("the keyboard alone reaches and turns the picture", page::keyboard),
    ("controls and pictures have names", page::names),
    ("text from the machine file is text", page::hostile),
    ("a report without an engine shows its figures and changes nothing", mailed::read_only),
    ("a report of bounds says where it has no value", mailed::bounded),
    ("the page of three machines says which is better, and by how much", mailed::three),
    ("screenshots of a report", mailed::screenshots),
    ("a mailed page is never blank, with a part and without", blank::mailed),
    ("the workbench is never blank, and what is not current says so", blank::workbench),
    ("where two write one file, the page shows both and takes what is chosen", blank::conflict),
    ("the workbench follows the files on the disk, and writes over nothing", watch::refreshes),
    ("the workbench shows the numbers of the command line, before and after edits", workbench::numbers),
    ("what is typed, dragged and undone reaches the file only when it is saved", workbench::edits),
    ("figures of a held slider are a draft where they are of fewer poses or machines", workbench::drafts),
    ("the workbench moves an axis across the bed by keys and by dragging", workbench::chain),
    ("axes join and leave with their entries and errors", workbench::axes),
    ("a body of the picture is dragged, and one axis moves", workbench::drag),
    ("the workbench shows refusals at their place and keeps the last figures", workbench::refusals),
    ("the workbench shows bounds of a machine of which nothing is measured", workbench::bounds),
    ("the work in reach is the command line's, and names explain themselves", review::reach),
    ("a goal gives the command line's tolerances, and writes them into the file", review::goal),
    ("variants stand side by side with the numbers of `compare`", review::variants),
    ("the part is coloured, stopped and reached as `map --tool-poses` says", review::part),
    ("a part that the command line names is there at once", review::named_part),
    ("what a control repairs and a test reads are the command line's", review::control),
    ("keys and names of errors are completed", review::completion),
    ("charts are downloaded as CSV, SVG and PNG", review::downloads),
    ("tables of control and test as files hold what the panels show", files::tables),
    ("the eight questions of a review are answered on one screen", meeting::questions),
    ("with a job all is over it, as the command line says, and a switch shows the volume", meeting::scope),
    ("a curve is read under the pointer, and a drag along it moves the machine", meeting::curve),
    ("64 tries in the field read out the node that is seen, 64 beside it none", meeting::picks),
    ("two pictures are looked at together, on one scale", meeting::beside),
    ("a value of the base becomes an entry of the open file", meeting::overrides),
    ("nothing is cut at 390 px, panel by panel", meeting::narrow),
    ("only the page of the workbench may ask and save", workbench::tokens),
    ("a frame of the picture is few draw calls, whatever is dragged", frames::draw_calls),
    ("an idle page draws nothing, and a figure of a held slider takes few questions", frames::idle),
    ("views, names and arms stand over the picture, and the address keeps them", reader::views),
    ("meshes that the file names stand for the castings, and what is spoiled is named", reader::meshes),
    ("the path is played, and each row says its deviation and the axes that make it", reader::played),
    ("figures are read in micro-inch and arcsec everywhere, and kept so", reader::units),
    ("the report below is read in the same units", reader::report_units),
    ("a first page has machine, verdict and answers, in letters of 8 pt", reader::paper),
    ("first screen and machine are downloaded as SVG, PNG and glTF", reader::slide),
    ("questions make a machine file on the page, as on a terminal", questions::form),
    ("screenshots of the workbench", workbench::screenshots),
    ("screenshots: light, dark, print, projector, mobile, comparison", pictures::screenshots),
];

/// Checks that need the engines, too.
const ENGINE_CHECKS: [checks::Check; 4] = [
    ("a report with its engine answers 50 edits as the command line does", mailed::edits),
    ("an engine that answers otherwise is not used", mailed::refused),
    ("figures follow a slider that is held in a report", mailed::held),
    ("a report with two controllers carries its engines, those of a release below 5 MB", mailed::small),
];

fn main() -> ExitCode {
    const REQUIRED: &str = "ABBE_REQUIRE_BROWSER";
    let pages = checks::run(&CHECKS, driver::available, REQUIRED, 1);
    let engines = checks::run(&ENGINE_CHECKS, || driver::available().and_then(|()| mailed::available()), REQUIRED, 1);
    if pages == ExitCode::SUCCESS { engines } else { pages }
}

/// A folder of its own, removed at the end.
pub struct Folder(pub PathBuf);

impl Folder {
    /// Makes it, empty.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("abbe-browser-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The program, in `configs/`.
pub fn abbe() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("configs"));
    command
}

/// Folder of screenshots and of the five-axis page: beside the program, under `target`.
pub fn kept() -> PathBuf {
    let folder = Path::new(env!("CARGO_BIN_EXE_abbe")).parent().unwrap().join("screenshots");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The page of a five-axis machine with two targets, written once.
pub fn five_axes() -> PathBuf {
    static PAGE: std::sync::OnceLock<PathBuf> = std::sync::OnceLock::new();
    let write = || {
        report(
            &kept(),
            "five-axes.html",
            &[
                "trunnion.yaml",
                "--target",
                "linuxcnc",
                "--target",
                "grid-csv",
                "--class",
                "production",
                "--samples",
                "100",
            ],
        )
    };
    PAGE.get_or_init(write).clone()
}

/// Writes a report with these arguments and returns where it is.
pub fn report(folder: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let output = abbe()
        .arg("report")
        .args(arguments)
        .arg("--out")
        .arg(&path)
        .args(["--poses", "300", "--quiet"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    path
}
