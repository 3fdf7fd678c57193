//! The table of codes. Stable: a code is never used again for something else.
//!
//! E01xx reading, E02xx language, E03xx chain, E04xx joints and errors, E05xx numerical, E06xx
//! capability and quantisation, E07xx rendering and read-back, E08xx command line; W.... warnings
//! likewise. The long texts are in `explain/`.

/// One code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CodeInfo {
    /// Such as `E0203`.
    pub code: &'static str,
    /// A few words.
    pub title: &'static str,
    /// What `abbe explain CODE` prints: Markdown with an example of wrong and right.
    pub explanation: &'static str,
}

/// A line of the table; the text is in `explain/CODE.md`.
macro_rules! code {
    ($code:literal, $title:literal) => {
        CodeInfo { code: $code, title: $title, explanation: include_str!(concat!("explain/", $code, ".md")) }
    };
}

/// All codes, by stage.
pub const CODES: &[CodeInfo] = &[
    code!("E0101", "a file cannot be read"),
    code!("E0102", "not a file"),
    code!("E0103", "a file is too large"),
    code!("E0104", "a file is not UTF-8"),
    code!("E0105", "the file is not YAML"),
    code!("E0106", "the file is beyond all measure"),
    code!("E0107", "a key stands twice"),
    code!("E0108", "YAML that is not part of the language"),
    code!("E0109", "the file holds no machine"),
    code!("E0110", "the header of a table is not understood"),
    code!("E0111", "a cell is not a number"),
    code!("E0112", "a row has too many or too few cells"),
    code!("E0113", "positions do not rise"),
    code!("E0114", "a column is missing"),
    code!("E0201", "unknown key"),
    code!("E0202", "a value does not have the right form"),
    code!("E0203", "something is missing"),
    code!("E0204", "a unit is missing"),
    code!("E0205", "the unit is of the wrong kind"),
    code!("E0206", "not a quantity"),
    code!("E0207", "a point has three coordinates"),
    code!("E0208", "`extends` does not end"),
    code!("E0209", "entries exclude each other"),
    code!("E0210", "not one of the choices"),
    code!("E0211", "another version of the language"),
    code!("E0212", "a name is refused"),
    code!("E0213", "a length or position is not plausible"),
    code!("E0214", "the volume is refused"),
    code!("E0215", "a word of `algebra` or `identify` is refused"),
    code!("E0301", "the chain is not understood"),
    code!("E0302", "the chain does not run from workpiece to tool"),
    code!("E0303", "an axis of the chain is not declared"),
    code!("E0304", "an axis stands twice"),
    code!("E0305", "a prime on the wrong side"),
    code!("E0306", "not the name of an axis"),
    code!("E0401", "an axis needs its kind or direction"),
    code!("E0402", "a direction is refused"),
    code!("E0403", "a travel or interval is refused"),
    code!("E0405", "not the name of an error"),
    code!("E0406", "an error of an axis that is not declared"),
    code!("E0407", "an error is given twice"),
    code!("E0408", "this form does not fit this error"),
    code!("E0409", "a table does not cover the travel"),
    code!("E0410", "points are not a curve"),
    code!("E0411", "a tolerance is negative"),
    code!("E0412", "an error is not plausible"),
    code!("E0501", "measurements are not understood"),
    code!("E0502", "what is to be fitted is not understood"),
    code!("E0503", "fewer readings than parameters"),
    code!("E0504", "the fitted machine is not plausible"),
    code!("E0521", "unknown generator"),
    code!("E0522", "an ideal that contains 1"),
    code!("E0523", "an algebra that is too large"),
    code!("E0524", "a singular division"),
    code!("E0525", "no polynomial"),
    code!("E0526", "no exact conversion"),
    code!("E0527", "a tolerance that would have to be split"),
    code!("E0528", "conventions are not understood"),
    code!("E0529", "the converted machine is refused"),
    code!("E0541", "a table too long to be printed"),
    code!("W0501", "a fit has not settled"),
    code!("W0502", "the fit does not explain the data"),
    code!("E0601", "no letter for an axis"),
    code!("E0602", "a correction is above the limit"),
    code!("E0603", "a lattice that cannot be"),
    code!("E0604", "no error is bounded"),
    code!("E0605", "a class of machines is refused"),
    code!("E0606", "too many drawn poses"),
    code!("E0607", "too many arrangements"),
    code!("E0608", "a rule of arrangements is not understood"),
    code!("E0609", "no arrangement is left"),
    code!("E0610", "a state file is refused"),
    code!("E0611", "parts do not make a whole"),
    code!("E0612", "an instrument's path cannot be driven"),
    code!("E0701", "unknown target"),
    code!("E0702", "a template failed"),
    code!("E0703", "a manifest is not understood"),
    code!("E0704", "a compensation file is not what the controller would read"),
    code!("E0705", "a compensation file is missing"),
    code!("E0706", "a file is not ours to replace"),
    code!("E0707", "files do not read back"),
    code!("E0708", "a target has nothing for this machine"),
    code!("E0709", "a number the controller does not take"),
    code!("E0710", "a target known from memory only"),
    code!("E0711", "two sets that do not belong together"),
    code!("E0750", "kinematics that cannot hold the tip"),
    code!("E0751", "a machine that the controller's module is not for"),
    code!("E0810", "a file cannot be written"),
    code!("E0811", "a file is there already"),
    code!("E0812", "too many poses for a map"),
    code!("E0813", "no tool pose in common"),
    code!("E0814", "not an algebra"),
    code!("E0815", "not a matrix over the dual numbers"),
    code!("W0201", "no version of the language"),
    code!("W0401", "an axis is left out"),
    code!("W0402", "a location error cannot act"),
    code!("W0403", "a curve repeats a location error"),
    code!("W0601", "an axis is written under another letter"),
    code!("W0602", "tables that make it worse, or do nothing"),
    code!("W0603", "the orientation gets worse"),
    code!("W0604", "a curve is resampled"),
    code!("W0605", "a lattice covers less than the travel"),
    code!("W0701", "a file has been edited"),
    code!("W0702", "tables of another machine file"),
    code!("W0703", "no manifest to compare with"),
    code!("E0801", "the machine has no such tool"),
    code!("E0802", "poses are not understood"),
    code!("E0803", "an error is not known at a pose"),
    code!("W0801", "poses beyond the travel"),
];

/// What is known of a code.
pub fn info(code: &str) -> Option<&'static CodeInfo> {
    CODES.iter().find(|c| c.code.eq_ignore_ascii_case(code))
}
