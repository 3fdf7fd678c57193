//! Names for controllers that read ASCII only.

use crate::controller::manifest::ControllerTarget;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;

impl ControllerTarget {
    pub(super) fn file_name(&self, machine: &Machine) -> String {
        if self.manifest.ascii { transliterate(machine.name()) } else { machine.name().to_owned() }
    }

    /// Warns of a name that the files hold in other letters: W0609.
    pub fn name_warning(&self, machine: &Machine) -> Option<Diagnostic> {
        let (name, written) = (machine.name(), self.file_name(machine));
        let message = format!("the name `{name}` is written as `{written}`: the controller reads ASCII only");
        let help = "give the machine a name in ASCII to have it the same everywhere";
        (name != written).then(|| Diagnostic::new(codes::W0609, message).help(help))
    }
}

/// Returns a text in ASCII: German and Nordic letters as they are spelt without, others as `_`.
fn transliterate(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            c if c.is_ascii() => written.push(c),
            'ä' | 'æ' => written.push_str("ae"),
            'ö' | 'ø' => written.push_str("oe"),
            'ü' => written.push_str("ue"),
            'Ä' | 'Æ' => written.push_str("Ae"),
            'Ö' | 'Ø' => written.push_str("Oe"),
            'Ü' => written.push_str("Ue"),
            'ß' => written.push_str("ss"),
            'å' => written.push_str("aa"),
            'Å' => written.push_str("Aa"),
            'à' | 'á' | 'â' | 'ã' => written.push('a'),
            'ç' | 'č' => written.push('c'),
            'è' | 'é' | 'ê' | 'ë' => written.push('e'),
            'ì' | 'í' | 'î' | 'ï' => written.push('i'),
            'ñ' => written.push('n'),
            'ò' | 'ó' | 'ô' | 'õ' => written.push('o'),
            'ù' | 'ú' | 'û' => written.push('u'),
            _ => written.push('_'),
        }
    }
    written
}
