//! The table of codes. Stable: a code is never used again for something else.
//!
//! E01xx reading, E02xx language, E03xx chain, E04xx joints and errors, E05xx numerical, E06xx
//! capability and quantisation, E07xx rendering and read-back, E08xx command line; W.... warnings
//! likewise. The long texts are in `explain/`. The constants bear the codes themselves: that is the name by which users
//! and the documentation know them.

/// A code: `E....` refuses an input, `W....` warns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Code(&'static CodeText);

/// The texts of a code.
#[derive(Debug, PartialEq, Eq)]
pub struct CodeText {
    /// Such as `E0203`.
    pub id: &'static str,
    /// A few words.
    pub title: &'static str,
    /// The text of `abbe explain CODE`: Markdown with an example of wrong and right.
    pub explanation: &'static str,
}

impl std::ops::Deref for Code {
    type Target = CodeText;

    fn deref(&self) -> &CodeText {
        self.0
    }
}

impl Code {
    /// True if the code is that of a warning.
    pub fn is_warning(self) -> bool {
        self.id.starts_with('W')
    }
}

impl PartialEq<&str> for Code {
    fn eq(&self, id: &&str) -> bool {
        self.id == *id
    }
}

impl PartialEq<str> for Code {
    fn eq(&self, id: &str) -> bool {
        self.id == id
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.id)
    }
}

impl schemars::JsonSchema for Code {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Code".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        String::json_schema(generator)
    }
}

impl serde::Serialize for Code {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id)
    }
}

/// One constant a line, and the list of all; the text is in `explain/CODE.md`.
macro_rules! codes {
    ($($id:ident $title:literal,)*) => {
        $(
            #[doc = $title]
            pub const $id: Code = Code(&CodeText {
                id: stringify!($id),
                title: $title,
                explanation: include_str!(concat!("explain/", stringify!($id), ".md")),
            });
        )*

        /// All codes, by stage.
        pub const CODES: &[Code] = &[$($id),*];
    };
}

codes! {
    E0101 "a file cannot be read",
    E0102 "not a file",
    E0103 "a file is too large",
    E0104 "a file is not text in UTF-8",
    E0105 "the file is not YAML",
    E0106 "the file exceeds the parser's limits",
    E0107 "a key occurs twice",
    E0108 "YAML that is not part of the language",
    E0109 "the file holds no machine",
    E0110 "the header of a table is not understood",
    E0111 "a cell is not a number",
    E0112 "a row has too many or too few cells",
    E0113 "positions do not rise",
    E0114 "a column is missing",
    E0201 "unknown key",
    E0202 "a value does not have the right form",
    E0203 "something is missing",
    E0204 "a unit is missing",
    E0205 "the unit is of the wrong kind",
    E0206 "not a quantity",
    E0207 "a point needs three coordinates",
    E0208 "`extends` is circular or too deep",
    E0209 "entries exclude each other",
    E0210 "not one of the choices",
    E0211 "another version of the language",
    E0212 "a name is refused",
    E0213 "a length or position is not plausible",
    E0214 "the volume is refused",
    E0215 "a word of `algebra` or `identify` is refused",
    E0301 "the chain cannot be read",
    E0302 "the chain does not run from workpiece to tool",
    E0303 "an axis of the chain is not declared",
    E0304 "an axis occurs twice in the chain",
    E0305 "a primed axis on the tool side",
    E0306 "not the name of an axis",
    E0307 "too many axes",
    E0401 "an axis needs its kind or direction",
    E0402 "a direction is refused",
    E0403 "a travel or interval is refused",
    E0405 "not the name of an error",
    E0406 "an error of an axis that is not declared",
    E0407 "an error is given twice",
    E0408 "this form does not fit this error",
    E0409 "a table does not cover the travel",
    E0410 "points are not a curve",
    E0411 "a tolerance is negative",
    E0412 "an error is not plausible",
    E0413 "positions refer to each other in a circle",
    E0414 "not a point to be relative to",
    E0415 "an error of another axis in the block of a side",
    E0416 "a bound does not fit its name",
    E0417 "the class of the file is refused",
    E0501 "measurements cannot be read",
    E0502 "the list of fitted errors cannot be read",
    E0503 "fewer readings than parameters",
    E0504 "the fitted machine is not plausible",
    E0505 "the position of a station is missing",
    E0506 "a length without a direction",
    E0507 "a line without a direction",
    E0508 "too many unknowns",
    E0509 "an export cannot be read",
    E0510 "readings that `--method moore-penrose` cannot use",
    E0511 "no plane to draw",
    E0512 "a mapping of columns cannot be read",
    E0513 "a fitted value is undetermined",
    E0514 "no reading holds the size of the machine",
    E0515 "the data do not hold the prediction",
    E0516 "a prior cannot be read",
    E0517 "a type B uncertainty cannot be read",
    E0519 "readings of a test cannot be used",
    E0521 "unknown generator",
    E0522 "the ideal contains 1",
    E0523 "an algebra that is too large",
    E0524 "a singular division",
    E0525 "the closed form is no polynomial",
    E0526 "no exact conversion",
    E0527 "a tolerance cannot be split",
    E0528 "conventions cannot be read",
    E0529 "the converted machine is refused",
    E0541 "a table too long to be printed",
    E0542 "a result is not finite",
    E0543 "readings accuse themselves",
    W0501 "the fit did not converge",
    W0502 "the fit does not explain the data",
    W0503 "the residuals are not random",
    W0504 "rows are left out",
    W0505 "readings of an unlikely size",
    W0506 "a direction without readings",
    W0507 "readings contradict each other",
    W0508 "the data do not determine any fitted parameter",
    W0509 "an entry of `identify` has no effect",
    W0510 "parameters below the noise are written",
    W0511 "columns are left out",
    W0512 "the values of a fit are no machine's",
    W0520 "readings are suspect",
    W0521 "no reading is left to tell the noise",
    E0601 "no letter for an axis",
    E0602 "a correction is above the limit",
    E0603 "the lattice is impossible",
    E0604 "no error is bounded",
    E0605 "a class of machines is refused",
    E0606 "too many drawn poses",
    E0607 "too many arrangements",
    E0608 "a rule of arrangements cannot be read",
    E0609 "the rules exclude every arrangement",
    E0610 "a state file is refused",
    E0611 "the merged parts are incomplete",
    E0612 "an instrument's path cannot be driven",
    E0613 "no tool pose is reached",
    E0614 "a goal is out of reach",
    E0615 "a cost model is refused",
    E0630 "an output is an input",
    E0631 "a port cannot be opened",
    E0632 "a picture or page cannot be drawn",
    E0701 "unknown target",
    E0702 "a template failed",
    E0703 "a manifest cannot be read",
    E0704 "the controller would misread a compensation file",
    E0705 "a compensation file is missing",
    E0706 "a foreign or edited file would be replaced",
    E0707 "files do not read back",
    E0708 "the target cannot correct this machine",
    E0709 "a number beyond the controller's limits",
    E0710 "a target known from memory only",
    E0711 "two sets do not belong together",
    E0712 "the number of an axis in the controller is not stated",
    E0730 "files of several possible targets",
    E0731 "the axis of a file is unknown",
    E0732 "two files for the same part of a set",
    E0733 "a set is partly replaced",
    E0734 "a manifest lists files outside its folder",
    E0740 "templates that need too much memory",
    E0750 "a letter is no coordinate of the controller",
    E0751 "the controller's module does not support the machine",
    E0752 "the controller has no free letter",
    E0753 "numbers in force that are not of this machine",
    E0754 "tables in a folder of which nothing was said",
    E0755 "an INI file without the limits of the drives",
    E0810 "a file cannot be written",
    E0811 "a file is there already",
    E0812 "too many poses for a map",
    E0813 "no tool pose in common",
    E0814 "not an algebra",
    E0815 "not a matrix over the dual numbers",
    E0817 "tool poses cannot be read",
    E0818 "options that do not fit",
    E0819 "a file outside the folder of --confined",
    E0820 "the description of a record does not fit",
    E0821 "a record has changed",
    E0822 "records that do not line up",
    E0823 "a key or a signature that is not the one asked for",
    E0850 "a reference does not fit",
    E0851 "a job cannot be read",
    E0860 "a tolerance does not fit its feature",
    W0201 "no version of the language",
    W0401 "an axis is left out",
    W0402 "a location error cannot act",
    W0403 "a curve repeats a location error",
    W0404 "the geometry of an axis is not stated",
    W0405 "an axis without an origin",
    W0406 "two linear axes along one line",
    W0407 "a bound by letter of an oblique axis",
    W0408 "errors carried to the other side of the bed",
    W0409 "the tool of a robot without a direction",
    W0410 "six linear axes in one chain",
    W0411 "a bound of an error that has a value",
    W0412 "a curve stops short of the travel",
    W0413 "geometry that is seldom meant",
    W0601 "an axis is written under another letter",
    W0602 "tables increase the error or have no effect",
    W0603 "the orientation gets worse",
    W0604 "a curve is resampled",
    W0605 "a lattice covers less than the travel",
    W0607 "budgets are not compared",
    W0608 "a tool pose is out of reach",
    W0609 "a name is written in ASCII",
    W0701 "a file has been edited",
    W0702 "tables of another machine file",
    W0703 "no manifest to compare with",
    W0704 "points of installed tables are lost",
    W0705 "a table ends before the axis",
    W0706 "tables judged with another tool",
    W0707 "a file of an earlier set is still there",
    W0708 "a table has no room beside the installed ones",
    W0710 "the axis of a file is inferred from its positions",
    W0711 "a file is ignored",
    W0712 "a set was half replaced",
    W0713 "a run was killed before it changed anything",
    W0714 "a table is not in force",
    W0715 "no file says which tables are in force",
    W0716 "check words are not verified",
    W0717 "a name of the machine's builder is taken as it is",
    W0718 "the scale of a drive is not known, or seldom",
    W0719 "a machine in inches gets files in mm",
    W0720 "the restore set is not that of the set",
    W0760 "words of the program are axes, not the tip",
    W0761 "a rotary axis with the letter of a linear one",
    W0762 "numbers in force away from the machine file",
    W0763 "an axis that turns faster than the drives follow",
    E0801 "the machine has no such tool",
    E0802 "poses cannot be read",
    E0803 "an error is undefined at a pose",
    W0801 "poses beyond the travel",
    W0802 "errors that are only bounded",
    W0803 "parts of monomials are left out",
    W0804 "positions that look like radians or metres",
    W0820 "the certificate of an instrument has ended",
    W0850 "the part is not zeroed",
    W0851 "a path that needs rewinds",
    W0852 "the job of a machine file gives way",
    W0853 "a mesh is not drawn",
    W0854 "parts of a mesh are not drawn",
    W0855 "the tool axis of a job points into the material",
}

/// Finds a code by its name, in any case.
pub fn info(id: &str) -> Option<&'static Code> {
    CODES.iter().find(|code| code.id.eq_ignore_ascii_case(id))
}
