//! Machines: read once, compiled once for each order and side of approach.

use crate::arrays::{self, Evaluation};
use crate::diagnostics::{list, one, refusal};
use crate::interrupt::run_owned;
use crate::request::TextsAndDisk;
use abbe::options::{Approach, Frame, Order};
use abbe::results::CompiledModel;
use abbe::results::ErrorTerm;
use abbe::text::{parse_length, shown};
use abbe::{Diagnostic, Diagnostics, LoadOptions, MachineFile, codes, compile_model};
use pyo3::prelude::*;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as Unknown, StrDeserializer};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// A machine, with the diagnostics of its reading.
pub struct Loaded {
    /// The machine.
    pub file: MachineFile,
    /// The warnings of its reading.
    pub warnings: Diagnostics,
    /// The path of its file.
    pub path: String,
    /// Name and text of every file that it was read from, in the order read.
    pub texts: Vec<(String, String)>,
}

type Models = HashMap<(String, String), Arc<CompiledModel>>;

/// A machine that was read.
#[pyclass(module = "abbe._abbe", frozen)]
pub struct NativeMachine {
    pub(crate) loaded: Arc<Loaded>,
    models: Mutex<Models>,
}

/// Reads a machine from `path`: the texts by name come before files of the disk.
#[pyfunction]
pub fn load(
    py: Python<'_>,
    path: String,
    texts: Vec<(String, String)>,
    tool: Option<String>,
) -> PyResult<NativeMachine> {
    let named = path.clone();
    let (answer, texts) = run_owned(py, 1, None, move |monitor| {
        let files = TextsAndDisk::with(texts);
        let answer = abbe::load(named, &LoadOptions { tool }, files.run(monitor));
        (answer, files.into_read())
    })?;
    let answer = answer.map_err(|diagnostics| refusal(py, &diagnostics))?;
    let loaded = Arc::new(Loaded { file: answer.value, warnings: answer.warnings, path, texts });
    Ok(NativeMachine { loaded, models: Mutex::default() })
}

#[pymethods]
impl NativeMachine {
    /// The machine in short, as `abbe check --format json` prints it.
    fn summary(&self) -> String {
        self.loaded.warnings.document(json!(abbe::summary(&self.loaded.file))).to_string()
    }

    /// The chain, as `abbe show --format json` prints it.
    fn show(&self) -> String {
        self.loaded.warnings.document(json!(abbe::show(&self.loaded.file))).to_string()
    }

    /// The errors by name, each with its kind, its number and the unit of the number.
    fn errors(&self) -> String {
        json!(
            self.loaded
                .file
                .errors()
                .map(|(id, term)| {
                    let unit = if id.direction.is_rotation() { "rad" } else { "mm" };
                    let (kind, number) = match term {
                        ErrorTerm::Constant(number) => ("location", json!(number)),
                        ErrorTerm::Component(_) => ("component", Value::Null),
                        ErrorTerm::Tolerance(number) => ("tolerance", json!(number)),
                    };
                    (id.to_string(), json!({"kind": kind, "value": number, "unit": unit}))
                })
                .collect::<serde_json::Map<_, _>>()
        )
        .to_string()
    }

    /// Names of the axes, in the order of the chain.
    fn axes(&self) -> Vec<String> {
        self.loaded.file.axes().iter().map(|axis| axis.name.to_string()).collect()
    }

    /// Positions of the nodes of the volume's grid, axis by axis, mm and deg.
    fn grid(&self) -> Vec<Vec<f64>> {
        self.loaded.file.grid()
    }

    /// Name of the machine.
    fn name(&self) -> &str {
        self.loaded.file.name()
    }

    /// Name of the tool in use; may be empty.
    fn tool(&self) -> &str {
        &self.loaded.file.tool().name
    }

    /// Name of the machine file.
    fn path(&self) -> &str {
        &self.loaded.path
    }

    /// Name and text of every file that the machine was read from, in the order read.
    fn texts(&self) -> Vec<(String, String)> {
        self.loaded.texts.clone()
    }

    /// The warnings of its reading, as a JSON list of diagnostics.
    fn warnings(&self) -> String {
        list(&self.loaded.warnings)
    }

    /// A picture of the chain, SVG.
    fn chain_svg(&self) -> String {
        self.loaded.file.chain_picture().svg()
    }

    /// A picture of the curves of the component errors, SVG; none without component errors.
    fn curves_svg(&self) -> Option<String> {
        self.loaded.file.error_curves().map(|picture| picture.svg())
    }

    /// Deviations at many poses: two arrays of shape (N, 3) in column order, mm and rad.
    ///
    /// `positions` is an array of shape (N, axes), or a list of columns, each of shape (N,), C-contiguous or
    /// F-contiguous, of doubles. `out` are two such arrays to write into.
    #[pyo3(signature = (positions, order, approach, frame, threads, out))]
    #[allow(clippy::too_many_arguments, reason = "what a Python caller names")]
    fn deviations<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        order: Option<String>,
        approach: &str,
        frame: &str,
        threads: usize,
        out: Option<arrays::Pair<'py>>,
    ) -> PyResult<arrays::Pair<'py>> {
        let frame: Frame = word("frame", frame).map_err(|refusal| one(py, refusal))?;
        let model = self.model(order, approach).map_err(|refusal| one(py, refusal))?;
        arrays::deviations(py, positions, &Evaluation { model: &model, frame, threads }, out)
    }
}

impl NativeMachine {
    /// Returns the compiled model, compiled at the first call.
    fn model(&self, order: Option<String>, approach: &str) -> Result<Arc<CompiledModel>, Diagnostic> {
        let key = (order.unwrap_or_default(), approach.to_owned());
        let mut models = self.models.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(model) = models.get(&key) {
            return Ok(Arc::clone(model));
        }
        let file = &self.loaded.file;
        let order: Order = if key.0.is_empty() { file.default_order() } else { word("order", &key.0)? };
        let approach: Approach = word("approach", approach)?;
        let model = Arc::new(compile_model(file, order, approach));
        models.insert(key, Arc::clone(&model));
        Ok(model)
    }
}

/// Reads an option that is one word.
pub fn word<T: serde::de::DeserializeOwned>(option: &str, word: &str) -> Result<T, Diagnostic> {
    let deserializer: StrDeserializer<'_, Unknown> = word.into_deserializer();
    T::deserialize(deserializer)
        .map_err(|why| Diagnostic::new(codes::E0818, format!("option `{option}`: `{}`: {why}", shown(word))))
}

/// Returns a length with its unit, such as `30 um`, in mm.
#[pyfunction]
pub fn length_mm(py: Python<'_>, text: &str) -> PyResult<f64> {
    let help = "write a length with its unit, such as `30 um`";
    let refused = |why: String| one(py, Diagnostic::new(codes::E0818, why).help(help));
    let length = parse_length(text).map_err(|why| refused(why.to_string()))?;
    length.ok_or_else(|| refused(format!("`{}` is no length", shown(text))))
}
