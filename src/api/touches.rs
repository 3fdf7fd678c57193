//! The log of a touch probe to a table of touches, and to the centres of balls.

use crate::identify::import::Acceptance;
use crate::identify::{TouchCoordinates, TouchImport, TouchRequest};
use crate::job::machine_file::MachineFile;
use crate::run::{Call, Refused, Reply, Run};
use std::path::Path;

/// Options of [`import_touches`].
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct TouchOptions {
    /// Touches of a ball in a pose, 4 or more, of a log that does not name them.
    pub touches: usize,
    /// The meaning of X, Y, Z, if the log does not state it; positions of the axes by default.
    pub coordinates: Option<TouchCoordinates>,
    /// Suspicions that the caller accepts: `suspect` takes touches that stand out, and places that do not agree.
    pub accept: Vec<Acceptance>,
}

/// Eight touches: the pole and seven around.
impl Default for TouchOptions {
    fn default() -> Self {
        Self { touches: 8, coordinates: None, accept: Vec::new() }
    }
}

/// Reads the log of a program that touches balls, or a probe file of LinuxCNC, with the nominal geometry of a machine.
///
/// Fails if the log is not whole, if touches stand out from their ball, and if a ball is in different places.
pub fn import_touches(
    file: &MachineFile,
    path: impl AsRef<Path>,
    options: &TouchOptions,
    run: Run,
) -> Reply<TouchImport> {
    Call::answer(run, file.sources(), |call| {
        if options.touches < 4 {
            return call.usage("a ball takes four touches or more");
        }
        let request = TouchRequest {
            touches: options.touches,
            coordinates: options.coordinates,
            accepts_suspect: options.accept.contains(&Acceptance::Suspect),
        };
        let found = crate::identify::import_touches(file, path.as_ref(), &request, run.files, &mut call.diagnostics);
        call.check()?;
        found.ok_or(Refused)
    })
}
