//! A ray with everything that many box and primitive tests would otherwise compute again.

use super::orientation::{Axes, Orientation, Sides};
use crate::simd::{Float, Portable, Simd, as_row};
use crate::{Ray, Vec3};

/// A valid [`Ray`] together with what depends on it alone.
///
/// Traversals make one per ray and do not change it: what a ray hits of one primitive never depends on the others.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct PreparedRay {
    /// Where the ray starts.
    pub origin: Vec3,
    /// The smallest distance that counts.
    pub t_min: f32,
    /// Where it goes.
    pub direction: Vec3,
    /// The distance from which on hits no longer count.
    pub t_max: f32,
    /// One over each coordinate of the direction; infinite where that is zero.
    pub reciprocal: Vec3,
    /// On which side of boxes the ray's entry planes lie, per axis.
    pub(crate) entry_sides: Sides,
    /// The axes in an order in which the last is the direction's largest and the triangle's orientation is kept.
    pub(super) axes: Axes,
    /// The origin with its coordinates in that order.
    pub(super) permuted_origin: [f32; 3],
    /// The shear that takes the direction to `(0, 0, 1)`: slopes along the first two axes, scale along the last.
    pub(super) shear: [f32; 3],
}

impl PreparedRay {
    /// Prepares a ray, or tells by `None` that it is not [valid](Ray::is_valid) and so hits nothing.
    #[inline]
    pub fn new(ray: &Ray) -> Option<Self> {
        Self::with(Portable, ray)
    }

    /// The same by vectors.
    #[inline(always)]
    pub(crate) fn with<S: Simd>(simd: S, ray: &Ray) -> Option<Self> {
        Self::is_valid(simd, ray).then(|| Self::of_valid(simd, ray))
    }

    /// Whether a ray is [valid](Ray::is_valid).
    #[inline(always)]
    pub(crate) fn is_valid<S: Simd>(simd: S, ray: &Ray) -> bool {
        let row = simd.load8(as_row(ray));
        let sizes = row.abs();
        let finite = sizes.less_or_equal(simd.splat8(f32::MAX)) & 0x77 == 0x77;
        let long = simd.splat8(Ray::SHORTEST_DIRECTION).less_or_equal(sizes) & 0x70 != 0;
        finite && long && ray.t_min < ray.t_max
    }

    /// Prepares a ray that is valid, as a row of eight numbers and without branches on the direction.
    #[inline(always)]
    pub(crate) fn of_valid<S: Simd>(simd: S, ray: &Ray) -> Self {
        let row = simd.load8(as_row(ray));
        let one = simd.splat8(1.0);
        let [.., rx, ry, rz, _] = (one / row).to_array();

        let orientation = Orientation::of(simd, row);
        let permuted = orientation.permuted(simd, row);
        let main = simd.permuted8(permuted, &[6; 8]);
        let [.., shear_x, shear_y, scale, _] = (permuted.replaced(1 << 6, one) / main).to_array();
        let [x, y, z, ..] = permuted.to_array();
        Self {
            origin: ray.origin,
            t_min: ray.t_min,
            direction: ray.direction,
            t_max: ray.t_max,
            reciprocal: Vec3::new(rx, ry, rz),
            entry_sides: orientation.entry_sides,
            axes: orientation.axes,
            permuted_origin: [x, y, z],
            shear: [shear_x, shear_y, scale],
        }
    }

    /// Which corner of a box the ray's entry plane along an axis belongs to: 0 the one of smallest coordinates, 1 the other.
    #[inline(always)]
    pub(crate) fn entry_corner(&self, axis: usize) -> usize {
        self.entry_sides.0[axis] as usize
    }

    /// Whether a distance lies in the ray's interval. NaN does not.
    #[inline]
    pub fn accepts(&self, t: f32) -> bool {
        self.t_min <= t && t < self.t_max
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Kernel, SimdLevel, dispatch_on};

    /// Rays along all axes, planes and diagonals, with zeros of both signs, coordinates that are equal, tiny or large, and some that are not valid.
    fn rays() -> impl Iterator<Item = Ray> {
        const COORDINATES: [f32; 11] =
            [0.0, -0.0, 1.0, -1.0, 0.3, -2.5, 1e-40, -1e-31, 3e37, f32::INFINITY, f32::NAN];
        let directions = COORDINATES.into_iter().flat_map(|x| {
            COORDINATES.into_iter().flat_map(move |y| COORDINATES.map(|z| Vec3::new(x, y, z)))
        });
        let origins = [[1.5, -2.0, 7.0], [0.0, -0.0, 1e30], [f32::NAN, 0.0, 0.0]];
        let ends = [(0.0, f32::INFINITY), (-1.0, 2.0), (1.0, 1.0), (f32::NAN, 1.0)];
        directions.flat_map(move |direction| {
            origins.into_iter().flat_map(move |origin| {
                ends.map(|(t_min, t_max)| Ray { origin: origin.into(), t_min, direction, t_max })
            })
        })
    }

    struct Prepare(Ray);

    impl Kernel for Prepare {
        type Output = Option<PreparedRay>;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Option<PreparedRay> {
            PreparedRay::with(simd, &self.0)
        }
    }

    #[test]
    fn every_level_prepares_all_rays_as_their_coordinates_say() {
        let levels = SimdLevel::ALL.iter().copied().filter(|level| level.is_available());
        for (level, ray) in levels.flat_map(|level| rays().map(move |ray| (level, ray))) {
            let prepared = dispatch_on(level, Prepare(ray));
            assert_eq!(prepared.is_some(), ray.is_valid(), "{}, {ray:?}", level.name());
            let Some(prepared) = prepared else { continue };

            // The last axis is the direction's largest, and the three are in an order that keeps orientation seen along the ray.
            let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
            let [x, y, z] = prepared.axes.numbers();
            assert!(d.iter().all(|c| c.abs() <= d[z].abs()), "{ray:?}");
            let turns =
                if d[z] < 0.0 { [(z + 2) % 3, (z + 1) % 3] } else { [(z + 1) % 3, (z + 2) % 3] };
            assert_eq!([x, y], turns, "{ray:?}");

            let bits = |numbers: [f32; 3]| numbers.map(f32::to_bits);
            assert_eq!(bits(prepared.permuted_origin), bits([o[x], o[y], o[z]]));
            assert_eq!(bits(prepared.shear), bits([d[x] / d[z], d[y] / d[z], 1.0 / d[z]]));
            assert_eq!(bits(prepared.reciprocal.to_array()), bits(d.map(|c| 1.0 / c)));
            let corners = [0, 1, 2].map(|axis| prepared.entry_corner(axis));
            assert_eq!(corners, d.map(|c| usize::from(1.0 / c < 0.0)));
            let same = Ray {
                origin: prepared.origin,
                t_min: prepared.t_min,
                direction: prepared.direction,
                t_max: prepared.t_max,
            };
            assert_eq!(same, ray);
        }
    }
}
