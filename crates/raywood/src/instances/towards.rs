//! Rays of many points towards one, such as a small light, in scenes of instances.

use super::{Tlas, Traceable, many};
use crate::{Ray, Vec3, parallel};

impl<B: Traceable> Tlas<B> {
    /// Whether anything lies between each point and `target`, such as a small light, over all cores of the caller's rayon pool: the same as of
    /// [`occluded_batch`](Self::occluded_batch) for `Ray::between(point, target)` that ends at the share `end` of its way. Rays that meet the same instance go through it together.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_towards(&self, target: Vec3, end: f32, points: &[Vec3], occluded: &mut [bool]) {
        assert_eq!(points.len(), occluded.len(), "as many answers as points");
        parallel::fill_chunks(points, occluded, many::MOST, |points, occluded| {
            let ray = |&point: &Vec3| Ray::between(point, target).with_interval(0.0, end);
            let rays: Vec<_> = points.iter().map(ray).collect();
            self.any_of_many(&rays, u32::MAX, occluded);
        });
    }
}
