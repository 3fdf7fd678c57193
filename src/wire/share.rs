//! A map that engines without common memory share: each computes a part of its deviations, one puts them together.

use crate::analysis::View;
use crate::api::map::{MapParts, computed};
use crate::evaluate::{Deviation, Field, Poses};
use crate::run::{Call, Refused};
use nalgebra::Vector3;
use std::cell::RefCell;
use std::ops::Range;

/// The deviations of the first map of a request.
pub(crate) enum MapShare<'a> {
    /// One part is computed, after which the call ends without an answer.
    Part(&'a MapPart),
    /// The bytes of all parts, one behind the other, of the same request. All are computed if they do not fit.
    Given(RefCell<Vec<u8>>),
}

#[derive(Debug, Clone)]
pub(crate) struct MapPart {
    /// Index of the part, from 0.
    pub index: usize,
    /// Number of parts; 0 counts as 1.
    pub count: usize,
    /// Position (mm) and rotation (rad) of each of its poses, little-endian doubles.
    pub bytes: RefCell<Vec<u8>>,
}

const BYTES: usize = 6 * size_of::<f64>();

impl MapPart {
    /// Returns a part that is not computed yet.
    pub(crate) fn new(index: usize, count: usize) -> Self {
        Self { index, count, bytes: RefCell::default() }
    }

    fn range(&self, poses: usize) -> Range<usize> {
        let count = self.count.max(1);
        let end = |part: usize| (poses as u128 * part.min(count) as u128 / count as u128) as usize;
        end(self.index)..end(self.index.saturating_add(1))
    }
}

impl MapParts for MapShare<'_> {
    fn refuse_other(&self) -> Result<(), Refused> {
        if let Self::Part(_) = self { Err(Refused) } else { Ok(()) }
    }

    fn deviations(
        &self,
        call: &mut Call,
        field: &dyn Field,
        poses: &Poses,
        view: View,
    ) -> Result<Vec<Deviation>, Refused> {
        match self {
            Self::Part(part) => {
                let computed = computed(call, field, poses, part.range(poses.len()), view)?;
                let _ = part.bytes.replace(write(&computed));
                Err(Refused)
            }
            Self::Given(bytes) => {
                let bytes = bytes.take();
                let fits = bytes.len() == poses.len() * BYTES;
                if fits { Ok(read(&bytes)) } else { computed(call, field, poses, 0..poses.len(), view) }
            }
        }
    }
}

fn write(deviations: &[Deviation]) -> Vec<u8> {
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
