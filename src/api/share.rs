//! A map that engines without common memory share: each computes a part of its deviations, one puts them together.

use super::run::{Call, Refused};
use crate::analysis::{View, deviations};
use crate::evaluate::{Deviation, Field, Poses};
use nalgebra::Vector3;
use std::cell::RefCell;
use std::ops::Range;

/// The share of a call in the deviations of its first map.
#[derive(Debug, Clone, Copy, Default)]
pub enum MapShare<'a> {
    /// All of them.
    #[default]
    All,
    /// One part, after which the call ends without an answer.
    Part(&'a MapPart),
    /// None: the bytes of all parts, one behind the other, of the same call. It computes them all if they do not fit.
    Given(&'a RefCell<Vec<u8>>),
}

impl MapShare<'_> {
    /// Ends a call that is to compute a part of a map that has none.
    pub(super) fn not_a_part(self) -> Result<(), Refused> {
        if let Self::Part(_) = self { Err(Refused) } else { Ok(()) }
    }
}

/// Part of the deviations of a map.
#[derive(Debug, Clone)]
pub struct MapPart {
    /// Index of the part, from 0.
    pub index: usize,
    /// Number of parts; 0 counts as 1.
    pub count: usize,
    /// Position (mm) and rotation (rad) of each of its poses, little-endian doubles.
    pub bytes: RefCell<Vec<u8>>,
}

/// Bytes of a deviation.
const BYTES: usize = 6 * size_of::<f64>();

impl MapPart {
    /// Returns a part that is not computed yet.
    pub fn new(index: usize, count: usize) -> Self {
        Self { index, count, bytes: RefCell::default() }
    }

    fn range(&self, poses: usize) -> Range<usize> {
        let count = self.count.max(1);
        let end = |part: usize| (poses as u128 * part.min(count) as u128 / count as u128) as usize;
        end(self.index)..end(self.index.saturating_add(1))
    }
}

/// Returns the deviations of a field at all poses (mm, rad).
pub(super) fn shared_deviations(
    call: &mut Call<'_>,
    field: &dyn Field,
    poses: &Poses,
    view: View,
) -> Result<Vec<Deviation>, Refused> {
    let computed =
        |range: Range<usize>| call.stage(range.len(), |advance| deviations(field, poses, range.clone(), view, advance));
    match call.run.share {
        MapShare::All => Ok(computed(0..poses.len())),
        MapShare::Part(part) => {
            let _ = part.bytes.replace(written(&computed(part.range(poses.len()))));
            Err(Refused)
        }
        MapShare::Given(bytes) => {
            let bytes = bytes.take();
            Ok(if bytes.len() == poses.len() * BYTES { read(&bytes) } else { computed(0..poses.len()) })
        }
    }
}

fn written(deviations: &[Deviation]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(deviations.len() * BYTES);
    for deviation in deviations {
        let numbers = deviation.position.iter().chain(&deviation.rotation);
        numbers.for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
    }
    bytes
}

fn read(bytes: &[u8]) -> Vec<Deviation> {
    let one = |numbers: &[[u8; 8]; 6]| {
        let [x, y, z, a, b, c] = numbers.map(f64::from_le_bytes);
        Deviation { position: Vector3::new(x, y, z), rotation: Vector3::new(a, b, c) }
    };
    bytes.as_chunks().0.as_chunks().0.iter().map(one).collect()
}
