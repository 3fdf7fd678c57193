//! Kinematic parameters: the numbers by which a controller's own five-axis transformation knows its rotary axes, as
//! the `machines:` of a manifest's `kinematics`.

use serde::Deserialize;

/// Side of the linear axes on which the rotary axes stand, in the walk from the workpiece to the tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RotaryPlacement {
    /// One axis carries the workpiece.
    Table,
    /// One axis carries the tool.
    Head,
    /// Two axes carry the workpiece.
    TableTable,
    /// Two axes carry the tool.
    HeadHead,
    /// One axis carries the tool, one the workpiece.
    HeadTable,
}

impl RotaryPlacement {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Table, Self::Head, Self::TableTable, Self::HeadHead, Self::HeadTable];

    /// Returns the numbers of rotary axes that carry the workpiece and the tool.
    pub fn counts(self) -> (usize, usize) {
        match self {
            Self::Table => (1, 0),
            Self::Head => (0, 1),
            Self::TableTable => (2, 0),
            Self::HeadHead => (0, 2),
            Self::HeadTable => (1, 1),
        }
    }

    /// Returns the placement in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Table => "one rotary axis that carries the workpiece",
            Self::Head => "one rotary axis that carries the tool",
            Self::TableTable => "two rotary axes that carry the workpiece",
            Self::HeadHead => "two rotary axes that carry the tool",
            Self::HeadTable => "one rotary axis that carries the tool and one that carries the workpiece",
        }
    }
}

/// A part of the machine that parameters place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MachinePart {
    /// The gauge point with all axes at 0.
    Gauge,
    /// The rotary axis of the workpiece's side next to the linear axes.
    TableFirst,
    /// The rotary axis on it, which carries the workpiece.
    TableSecond,
    /// The rotary axis of the tool's side next to the linear axes.
    HeadFirst,
    /// The rotary axis on it, which carries the tool.
    HeadSecond,
    /// The tool axis, from the tip to the spindle.
    Tool,
}

/// Three parameters: the components X, Y, Z of a vector in machine directions, all rotary axes at 0. A component
/// without a name is none of the controller's: there it takes the nominal one.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "is", rename_all = "snake_case", deny_unknown_fields)]
pub enum ParameterVector {
    /// The vector from a point of one part to a point of another, mm.
    Offset {
        /// Start.
        from: MachinePart,
        /// End.
        to: MachinePart,
        /// The controller's names.
        names: [Option<String>; 3],
    },
    /// The unit vector about which a positive command turns the tool right-handed relative to the workpiece; of the
    /// tool its axis.
    Direction {
        /// The axis.
        of: MachinePart,
        /// True if the controller has the opposite vector.
        #[serde(default)]
        reversed: bool,
        /// The controller's names.
        names: [Option<String>; 3],
    },
}

impl ParameterVector {
    /// Returns the controller's names of the components.
    pub fn names(&self) -> &[Option<String>; 3] {
        match self {
            Self::Offset { names, .. } | Self::Direction { names, .. } => names,
        }
    }
}

/// The nominal place that a controller assumes of an axis.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AssumedAxis {
    /// The axis.
    pub of: MachinePart,
    /// The unit vector about which a positive command turns the tool right-handed relative to the workpiece; of the
    /// tool its axis.
    pub direction: Option<[f64; 3]>,
    /// The same in either sense.
    pub line: Option<[f64; 3]>,
    /// Components of the vector from the gauge point to a point of the axis, mm, where they are assumed; of the tool
    /// none.
    #[serde(default)]
    pub offset: [Option<f64>; 3],
}

/// The parameters of one kind of machine.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterRules {
    /// The kind.
    pub rotary: RotaryPlacement,
    /// Places that the controller assumes.
    #[serde(default)]
    pub assumes: Vec<AssumedAxis>,
    /// The parameters, in the order of the file.
    pub parameters: Vec<ParameterVector>,
}

impl ParameterRules {
    /// Returns the controller's names in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.parameters.iter().flat_map(|vector| vector.names().iter().flatten())
    }

    /// Returns the reason why the rules cannot be used, if there is one.
    pub fn fault(&self) -> Option<String> {
        let names: Vec<&String> = self.names().collect();
        let plain = |name: &str| {
            !name.is_empty() && name.len() <= 60 && name.chars().all(|c| c.is_ascii_graphic() && c != '<' && c != '>')
        };
        let twice = (1..names.len()).any(|i| names[..i].contains(&names[i]));
        if names.is_empty() || twice || !names.iter().all(|name| plain(name)) {
            return Some("parameters: at least one, with different names of printable ASCII letters".to_owned());
        }
        let (tables, heads) = self.rotary.counts();
        let known = |part: &MachinePart| match part {
            MachinePart::Gauge | MachinePart::Tool => true,
            MachinePart::TableFirst => tables > 0,
            MachinePart::TableSecond => tables > 1,
            MachinePart::HeadFirst => heads > 0,
            MachinePart::HeadSecond => heads > 1,
        };
        let fits = |vector: &ParameterVector| match vector {
            ParameterVector::Offset { from, to, .. } => {
                from != to && [from, to].into_iter().all(|part| known(part) && *part != MachinePart::Tool)
            }
            ParameterVector::Direction { of, .. } => known(of) && *of != MachinePart::Gauge,
        };
        let free = |axis: &AssumedAxis| axis.offset.iter().all(Option::is_none);
        let assumed = |axis: &AssumedAxis| match axis.of {
            MachinePart::Gauge => false,
            MachinePart::Tool => free(axis),
            _ => known(&axis.of),
        };
        let all = self.parameters.iter().all(fits) && self.assumes.iter().all(assumed);
        (!all).then(|| {
            "parameters: offsets between different axes or the gauge point, directions of axes or the tool, \
                        of this kind of machine"
                .to_owned()
        })
    }
}
