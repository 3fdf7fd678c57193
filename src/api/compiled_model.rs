//! A machine compiled for many poses.

use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{self, Batch, Columns, Frame, Order, Output, frame_rotation};
use crate::job::machine_file::MachineFile;
use crate::job::poses::known;
use crate::machine::{Approach, Machine};

/// A machine compiled for an order and a side of approach. Deviations are actual minus nominal, in the workpiece frame.
///
/// The numbers depend neither on the vector width of the processor nor on the number of threads.
#[derive(Debug, Clone)]
pub struct CompiledModel(evaluate::CompiledModel);

/// Deviation at one pose: actual minus nominal, workpiece frame.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PoseDeviation {
    /// Displacement of the functional point, mm.
    pub position_mm: [f64; 3],
    /// Rotation of the tool, rad.
    pub rotation_rad: [f64; 3],
}

/// Deviations at many poses by columns, each as long as the columns of positions.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct DeviationColumns {
    /// Along x, mm.
    pub dx: Vec<f64>,
    /// Along y, mm.
    pub dy: Vec<f64>,
    /// Along z, mm.
    pub dz: Vec<f64>,
    /// About x, rad.
    pub wx: Vec<f64>,
    /// About y, rad.
    pub wy: Vec<f64>,
    /// About z, rad.
    pub wz: Vec<f64>,
}

/// The caller's slices for deviations at many poses, each as long as the columns of positions.
#[derive(Debug)]
pub struct DeviationSlices<'a> {
    /// Along x, y, z, mm.
    pub position_mm: [&'a mut [f64]; 3],
    /// About x, y, z, rad.
    pub rotation_rad: [&'a mut [f64]; 3],
}

/// Compiles a machine that no file states.
pub(super) fn compile_model_of(machine: &Machine, order: Order, approach: Approach) -> CompiledModel {
    CompiledModel(evaluate::CompiledModel::new(machine, order, approach))
}

/// Compiles a machine. The model owns its data: it does not borrow the machine.
pub fn compile_model(file: &MachineFile, order: Order, approach: Approach) -> CompiledModel {
    compile_model_of(file, order, approach)
}

impl CompiledModel {
    /// True if poses run on vectors rather than one by one through the general algebra, which takes a hundred times as
    /// long.
    pub fn is_compiled(&self) -> bool {
        self.0.is_compiled()
    }

    /// Returns the names of the axes in the order of the positions.
    pub fn axes(&self) -> impl Iterator<Item = &str> {
        self.0.machine().axes().iter().map(|axis| axis.name.as_str())
    }

    /// Returns the deviation at a pose: one position for each axis, mm or deg.
    ///
    /// Fails if the number of positions is not that of the axes, and where an error curve is not known.
    pub fn deviation(&self, pose: &[f64]) -> Result<PoseDeviation, Diagnostic> {
        self.check_count(pose.len())?;
        known(self.0.machine(), pose)?;
        let unturned = self.0.deviation(pose);
        let part = frame_rotation(self.0.machine(), pose, Frame::Workpiece);
        let deviation = part.map_or(unturned, |rotation| unturned.rotated(&rotation));
        Ok(PoseDeviation { position_mm: deviation.position.into(), rotation_rad: deviation.rotation.into() })
    }

    /// Returns the deviations at many poses, computed on all threads: one column of positions for each axis, mm or deg,
    /// all of one length.
    ///
    /// Fails if the number or the lengths of the columns do not fit, and where an error curve is not known.
    pub fn deviations(&self, columns: &[&[f64]]) -> Result<DeviationColumns, Diagnostic> {
        let len = columns.first().map_or(0, |column| column.len());
        let mut out = Columns::new(len);
        let Output { position, rotation } = out.output(len);
        let slices = DeviationSlices { position_mm: position, rotation_rad: rotation };
        self.deviations_into(columns, Frame::Workpiece, slices)?;
        let Columns { position: [dx, dy, dz], rotation: [wx, wy, wz] } = out;
        Ok(DeviationColumns { dx, dy, dz, wx, wy, wz })
    }

    /// Writes the deviations at many poses into the caller's slices, vectors in `frame`; the same as
    /// [`Self::deviations`] otherwise.
    ///
    /// Fails if the number or the lengths of the columns or slices do not fit, and where an error curve is not known.
    pub fn deviations_into(
        &self,
        columns: &[&[f64]],
        frame: Frame,
        out: DeviationSlices<'_>,
    ) -> Result<(), Diagnostic> {
        let len = columns.first().map_or(0, |column| column.len());
        self.piece_into(columns, frame, len, out)
    }

    /// Writes the deviations at a piece of a batch of `batch_len` poses; the same as [`Self::deviations_into`]
    /// otherwise. A large batch that is handed over piece by piece, so that it can be stopped in between, takes no
    /// longer than at once.
    ///
    /// Fails as [`Self::deviations_into`] does.
    pub fn piece_into(
        &self,
        columns: &[&[f64]],
        frame: Frame,
        batch_len: usize,
        out: DeviationSlices<'_>,
    ) -> Result<(), Diagnostic> {
        self.check_count(columns.len())?;
        let len = columns.first().map_or(0, |column| column.len());
        let unfit = |what| Diagnostic::new(codes::E0818, format!("the columns of {what} are not of one length"));
        let batch = Batch::new(columns.to_vec(), len).ok_or_else(|| unfit("positions"))?;
        let mut out = Output { position: out.position_mm, rotation: out.rotation_rad };
        if out.position.iter().chain(&out.rotation).any(|column| column.len() != len) {
            return Err(unfit("positions and deviations"));
        }
        self.check_known(columns)?;
        // Vectors that are turned are read again at once: these must not be stored past the caches.
        let are_turned = frame != Frame::Workpiece || self.0.machine().workpiece_rotation().is_some();
        self.0.piece_parallel(&batch, out.reborrow(), if are_turned { len } else { batch_len });
        self.0.to_frame(frame, &batch, out);
        Ok(())
    }

    fn check_count(&self, positions: usize) -> Result<(), Diagnostic> {
        let axes = self.0.machine().axes().len();
        if positions == axes {
            return Ok(());
        }
        let message = format!("there are positions of {positions} axes; the machine has {axes}");
        let names = self.axes().collect::<Vec<_>>().join(", ");
        Err(Diagnostic::new(codes::E0818, message).help(format!("its axes are {names}, in this order")))
    }

    /// Error curves are known on intervals: their ends decide.
    fn check_known(&self, columns: &[&[f64]]) -> Result<(), Diagnostic> {
        let machine = self.0.machine();
        if columns.iter().all(|column| column.is_empty()) {
            return Ok(());
        }
        let Some(ends) = columns.iter().map(|column| self.0.ends(column)).collect::<Option<Vec<_>>>() else {
            return known(machine, &vec![f64::INFINITY; columns.len()]);
        };
        [0, 1].into_iter().try_for_each(|end| known(machine, &ends.iter().map(|of| of[end]).collect::<Vec<_>>()))
    }
}
