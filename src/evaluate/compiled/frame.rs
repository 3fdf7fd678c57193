//! Deviations in other frames: rotated by the nominal motions of the joints passed.

use super::batch::{Batch, Output, Slices};
use super::chain::{NominalMotion, RotationAxis};
use super::lanes::run;
use super::model::CompiledModel;
use super::simd::{Kernel, Lanes};
use super::trigonometry::sin_cos;
use crate::evaluate::deviation::{Frame, frame_rotation};
use crate::machine::Branch;

struct FrameRotation<'a, 'o> {
    joints: &'a [(usize, RotationAxis)],
    poses: Slices<'a>,
    out: Output<'o>,
}

impl Kernel for FrameRotation<'_, '_> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let (count, mut at) = (self.out.len(), 0);
        while at + V::COUNT <= count {
            self.step::<V>(at);
            at += V::COUNT;
        }
        while at < count {
            self.step::<f64>(at);
            at += 1;
        }
    }
}

impl FrameRotation<'_, '_> {
    #[inline(always)]
    fn step<V: Lanes>(&mut self, at: usize) {
        let (p, r) = (&self.out.position, &self.out.rotation);
        let mut d = [V::load(&p[0][at..]), V::load(&p[1][at..]), V::load(&p[2][at..])];
        let mut w = [V::load(&r[0][at..]), V::load(&r[1][at..]), V::load(&r[2][at..])];
        for (axis, about) in self.joints {
            let (s, c) = sin_cos(V::load(&self.poses.axes[*axis][at..]));
            let back = (V::splat(0.0) - s, c);
            (d, w) = (about.rotate(back, d), about.rotate(back, w));
        }
        for k in 0..3 {
            d[k].store(&mut self.out.position[k][at..]);
            w[k].store(&mut self.out.rotation[k][at..]);
        }
    }
}

impl CompiledModel {
    /// Rotates deviations at these poses (mm, deg) from the unturned workpiece frame into a frame, in place.
    pub fn to_frame(&self, frame: Frame, poses: &Batch<'_>, mut out: Output<'_>) {
        let chain = self.chain.as_ref().filter(|_| frame != Frame::Workpiece);
        let Some(chain) = chain else { return self.to_frame_one_by_one(frame, poses, &mut out) };
        let passed = |axis: usize| frame == Frame::Tool || self.machine.axes()[axis].branch == Branch::Workpiece;
        let turns = chain.joints.iter().enumerate().filter(|(axis, _)| passed(*axis));
        let joints: Vec<(usize, RotationAxis)> = turns
            .filter_map(
                |(axis, link)| if let NominalMotion::Turn(about) = link.motion { Some((axis, about)) } else { None },
            )
            .collect();
        let poses = Slices { axes: poses.axes(), added: &[], whole: poses.len() };
        run(self.width, FrameRotation { joints: &joints, poses, out });
    }

    fn to_frame_one_by_one(&self, frame: Frame, poses: &Batch<'_>, out: &mut Output<'_>) {
        let constant = self.machine.workpiece_rotation().map(|rotation| rotation.transpose());
        for i in 0..out.len() {
            let rotation = match frame {
                Frame::Workpiece => constant,
                frame => frame_rotation(&self.machine, &poses.pose(i), frame),
            };
            let Some(rotation) = rotation else { return };
            for columns in [&mut out.position, &mut out.rotation] {
                let turned = rotation * nalgebra::Vector3::from_fn(|k, _| columns[k][i]);
                (0..3).for_each(|k| columns[k][i] = turned[k]);
            }
        }
    }
}
