//! Rigid motions of the workpiece frame that the data behind the errors do not hold.

/// A small rigid motion of the workpiece frame that the readings behind the errors do not notice, or that the datum of
/// the errors has decided: deviations of two machines that differ by it are equally good. Of any length but 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnheldMotion {
    /// Translation of the workpiece origin (mm), in machine directions at the zero pose.
    pub translation: [f64; 3],
    /// Rotation about the workpiece origin (rad).
    pub rotation: [f64; 3],
}

impl UnheldMotion {
    /// Returns the motion of six amounts: translations (mm), then rotations (rad).
    pub fn of([x, y, z, a, b, c]: [f64; 6]) -> Self {
        Self { translation: [x, y, z], rotation: [a, b, c] }
    }

    /// Returns the six amounts: translations (mm), then rotations (rad).
    pub fn amounts(&self) -> [f64; 6] {
        let ([x, y, z], [a, b, c]) = (self.translation, self.rotation);
        [x, y, z, a, b, c]
    }
}
