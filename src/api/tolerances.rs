//! Bounds of errors: those of the machine file, and those of a class of machines.

use crate::analysis::budget::{
    Bound, Class, Distribution, Draws, Statistic, adding, bounds, classes, known, lacks_rotary,
};
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::{AxisName, CLASS_ANGLES, Machine, no_origin};
use crate::report::DrawSettings;
use crate::run::{Call, Refused};

/// Draws of errors between their bounds, and the statistic of their effect.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ToleranceOptions {
    /// Class of machines whose typical tolerances are taken where the file has none, in place of the class that the
    /// file names: `ultra-precision`, `premium`, `production`, `commodity`, `large-gantry` or `desktop`. Values stay
    /// as they are, but in a ranking of arrangements, and on a machine whose errors all have one: there it takes their
    /// place.
    pub class: Option<String>,
    /// Distribution of an error between its bounds.
    pub distribution: Distribution,
    /// Statistic of a machine over the poses.
    pub statistic: Statistic,
}

pub(crate) type ClassSource = (String, String);

impl ToleranceOptions {
    pub(crate) fn drawing(&self, class: Option<ClassSource>, samples: usize, seed: u64) -> DrawSettings {
        let (class, class_source) = class.unzip();
        let (distribution, statistic) = (self.distribution, self.statistic);
        DrawSettings { class, class_source, samples, seed, distribution, statistic }
    }

    pub(crate) fn draws(&self, seed: u64) -> Draws {
        Draws::new(seed, self.distribution)
    }

    /// Returns the bounds of the file and of the class, with the class; refuses a machine without any.
    pub(crate) fn bounds(
        &self,
        call: &mut Call<'_>,
        machine: &Machine,
    ) -> Result<(Vec<Bound>, Option<ClassSource>), Refused> {
        let (list, source) = self.bounds_if_any(call, machine)?;
        if list.is_empty() { call.refuse(nothing_bounded(machine)) } else { Ok((list, source)) }
    }

    /// Returns the same where a machine may have none.
    pub(crate) fn bounds_if_any(
        &self,
        call: &mut Call<'_>,
        machine: &Machine,
    ) -> Result<(Vec<Bound>, Option<ClassSource>), Refused> {
        self.in_force(call, machine, |all| {
            let open = adding(machine, &all);
            // What a class would do is asked of a wholly measured machine, too.
            if open.is_empty() && self.class.is_some() { all } else { open }
        })
    }

    /// Returns the bounds of a design, in which no value acts: they stand for errors with values, too. Refuses a
    /// machine without any.
    pub(crate) fn bounds_of_design(
        &self,
        call: &mut Call<'_>,
        machine: &Machine,
    ) -> Result<(Vec<Bound>, Option<ClassSource>), Refused> {
        let (list, source) = self.in_force(call, machine, |all| all)?;
        if list.is_empty() { call.refuse(nothing_bounded(machine)) } else { Ok((list, source)) }
    }

    /// Returns those of the bounds of the file and of the class that are chosen, with the class.
    fn in_force(
        &self,
        call: &mut Call<'_>,
        machine: &Machine,
        choose: impl Fn(Vec<Bound>) -> Vec<Bound>,
    ) -> Result<(Vec<Bound>, Option<ClassSource>), Refused> {
        let class = self.class_of(call, machine)?;
        let list = choose(bounds(machine, class.as_ref().map(|(_, class)| class)));
        warn_of_arms(call, machine, &list);
        Ok((list, class.map(|(name, class)| (name, class.source))))
    }

    /// Returns the name of the class in force, if there is one.
    pub(crate) fn class_name<'a>(&'a self, machine: &'a Machine) -> Option<&'a str> {
        self.class.as_deref().or_else(|| machine.class().map(|named| named.name.as_str()))
    }

    /// Returns the class by name, or else that of the file, and refuses one without the axes of the machine.
    fn class_of(&self, call: &mut Call<'_>, machine: &Machine) -> Result<Option<(String, Class)>, Refused> {
        let class = match (&self.class, machine.class()) {
            (Some(name), _) => Some((name.clone(), find(name).or_else(|refusal| call.refuse(refusal))?)),
            (None, of_file) => of_file.map(|named| (named.name.clone(), named.class.clone())),
        };
        if let Some(refusal) = class.as_ref().and_then(|(name, class)| short_of_rotary(machine, name, class)) {
            return call.refuse(refusal);
        }
        Ok(class)
    }
}

/// Warns of axes without an origin whose angles the class bounds; those that the file bounds are known from its
/// reading.
fn warn_of_arms(call: &mut Call<'_>, machine: &Machine, bounds: &[Bound]) {
    let turns = |bound: &Bound| bound.of_class && bound.error.direction.is_rotation() && !bound.error.is_location();
    let bounded = |axis: &AxisName| bounds.iter().any(|bound| bound.error.axis == *axis && turns(bound));
    let known = machine.without_origin_in_file();
    for index in machine.without_origin(bounded).into_iter().filter(|index| !known.contains(index)) {
        let warning = no_origin(machine, index, CLASS_ANGLES);
        if !call.diagnostics.iter().any(|other| *other == warning) {
            call.diagnostics.push(warning);
        }
    }
}

fn find(name: &str) -> Result<Class, Diagnostic> {
    let mut classes = classes();
    classes.remove(name).ok_or_else(|| {
        let known: Vec<&str> = classes.keys().map(String::as_str).collect();
        let message = format!("there is no class of machines `{}`", shown(name));
        Diagnostic::new(codes::E0605, message).help(did_you_mean(name, &known))
    })
}

/// Returns what to say of a file whose class has no bounds for its rotary axes, which other verbs refuse.
pub(super) fn class_without_rotary(machine: &Machine) -> Option<Diagnostic> {
    let named = machine.class()?;
    let refusal = short_of_rotary(machine, &named.name, &named.class)?;
    let warning = Diagnostic::new(codes::W0413, refusal.message);
    Some(warning.help(format!("other verbs refuse it (E0605): {}", refusal.help.unwrap_or_default())))
}

/// The refusal of a class without rotary axes for a machine with some.
fn short_of_rotary(machine: &Machine, name: &str, class: &Class) -> Option<Diagnostic> {
    lacks_rotary(machine, class).then(|| {
        let message = format!("the class `{name}` has no tolerances of rotary axes, and the machine has such axes");
        let help = "take another class, or write the tolerances of the rotary axes into a variant of the file and \
         omit the class";
        Diagnostic::new(codes::E0605, message).help(help)
    })
}

/// Returns the refusal of a machine without bounds.
pub(super) fn nothing_bounded(machine: &Machine) -> Diagnostic {
    let given = known(machine);
    let message = format!("`{}` has no error that is only bounded", shown(machine.name()));
    let values = if given > 0 {
        format!("its {given} errors have values, which a budget takes for bounds only with `--axis-poses`; ")
    } else {
        String::new()
    };
    Diagnostic::new(codes::E0604, message).help(format!(
        "{values}write bounds, `EAY: {{ tolerance: 20 urad }}`, or take those of a class: `--class production`"
    ))
}
