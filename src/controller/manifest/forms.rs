//! The forms of lines, of files that put tables in force, and of a control's own archives.

use serde::Deserialize;
use std::collections::BTreeMap;

/// The lines around columns.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextFrame {
    /// The mark that begins a comment.
    pub comment: String,
    /// The first line: one of these patterns.
    pub begin: Vec<String>,
    /// The last line; nothing comes after it.
    pub end: String,
}

/// A line of a file: text with fields in angle brackets.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineSpec {
    /// The pattern, such as `$AN_CEC[<table>,<index>]=<value>`.
    pub line: String,
    /// Number of the only line that it may be on, from 1.
    pub at: Option<usize>,
    /// True if a file without such a line is refused.
    #[serde(default)]
    pub required: bool,
    /// True if a table without such a line is refused.
    #[serde(default)]
    pub each: bool,
    /// True if it comes before all tables.
    #[serde(default)]
    pub first: bool,
    /// True if the controller stops reading there.
    #[serde(default)]
    pub end: bool,
    /// The end of a block that it marks.
    pub block: Option<Edge>,
    /// The reason why a file with such a line is refused.
    pub refuse: Option<String>,
    /// Fields that it sets besides those in angle brackets.
    #[serde(default)]
    pub set: BTreeMap<String, String>,
}

/// An end of a block of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Edge {
    /// Its first line.
    Begin,
    /// Its last line.
    End,
}

/// The form in which a file puts other files in force.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "form", rename_all = "snake_case", deny_unknown_fields)]
pub enum Index {
    /// Sections of an INI: `[PREFIXn]`, n the number of the joint from 0, then `KEY = FILE`. The controller reads the
    /// first section of a name only.
    Sections {
        /// The text before the number.
        prefix: String,
        /// The key of the line that names the file.
        key: String,
        /// Settings of the section without which the controller reads the file differently.
        #[serde(default)]
        with: BTreeMap<String, String>,
        /// The setting that says which axis a joint is; without it the joints are the axes in the controller's order.
        joints: Option<JointOrder>,
        /// Settings of the file that say the units of the tables.
        #[serde(default)]
        units: Vec<UnitSetting>,
        /// The setting of a section that says the kind of its axis.
        kinds: Option<KindSetting>,
    },
    /// A line of words, then letters of axes; below it a file, or `-`, under each letter.
    Columns {
        /// The words before the letters.
        header: String,
        /// The mark, in the last column before the letters, of the only row in force; without it all rows are.
        active: Option<String>,
        /// The lines around the columns.
        frame: Option<TextFrame>,
    },
    /// Lines of settings: those that the template writes for the machine, and these.
    Settings {
        /// The mark that begins a comment.
        comment: String,
        /// The line that names the file in force, with `<file>`.
        file: String,
        /// The path of the file of the set that it is to name.
        names: String,
        /// The line with the number of rows, `<count>`, for which the controller has room.
        room: Option<String>,
        /// The line with `<letters>` of axes whose corrections the controller turns round.
        turned: Option<String>,
        /// The line with `<letters>` of axes that the controller does not correct.
        stopped: Option<String>,
        /// Lines that the controller takes for granted where they are left out.
        #[serde(default)]
        defaults: Vec<String>,
        /// Lines without effect on a correction.
        #[serde(default)]
        free: Vec<String>,
    },
}

/// The setting that names the kinematics, and with it the axes of the joints.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointOrder {
    /// The section of both settings.
    pub section: String,
    /// The key whose value begins with a module.
    pub key: String,
    /// The word before the letters of the joints, if the value has them: `coordinates` in `coordinates=XYZ`.
    pub word: String,
    /// Other words that the value may have, before an equals sign.
    #[serde(default)]
    pub others: Vec<String>,
    /// The key of the number of joints.
    pub count: String,
    /// The known modules with the letters of their joints; without letters the axes in the controller's order.
    pub modules: BTreeMap<String, String>,
}

/// A setting of units.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnitSetting {
    /// Its section.
    pub section: String,
    /// Its key.
    pub key: String,
    /// The values that are understood, with the mm or deg of a unit.
    pub values: BTreeMap<String, f64>,
    /// True if it is the unit of rotary axes.
    #[serde(default)]
    pub rotary: bool,
}

/// A setting of the kind of an axis.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KindSetting {
    /// Its key.
    pub key: String,
    /// Its value for a linear axis.
    pub linear: String,
    /// Its value for a rotary axis.
    pub rotary: String,
}

/// The forms that lines have in a control's own archive.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArchiveForm {
    /// True if lines may end with a check word: a blank, `'` and four hexadecimal digits.
    pub check_words: bool,
    /// True if lines may begin with `N`, a number and a blank.
    pub numbered: bool,
    /// True if lines are words of a letter and a number, blanks between them or not, for several axes.
    pub punch: bool,
    /// Texts before lines, such as those of a log.
    pub prefixes: Vec<String>,
    /// Commands with several words, which become a line for each; a word that begins with `S` stays in all.
    pub split: Vec<String>,
    /// Words that stand in such lines and say nothing, such as the path `L1`.
    pub silent: Vec<String>,
    /// The word after the number where a punch leaves it out, from which number on.
    pub without: BTreeMap<String, u32>,
    /// Lines by one of which a text is known as an archive. Lines with check words are of one too.
    pub header: Vec<String>,
    /// Lines of an archive besides those of a set.
    pub lines: Vec<LineSpec>,
    /// Lines of an archive with other data.
    pub skip: Vec<String>,
}
