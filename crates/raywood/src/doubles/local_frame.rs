//! The frame in which a mesh of double precision is seen in single precision: its middle at zero, its size about one.

use super::{Ray64, TriangleMesh64};
use crate::double::{Double3, largest_magnitude, single, sub};
use crate::{Aabb, Ray, TriangleMesh, Vec3};

/// Where the middle of a mesh is, and by which power of two it is scaled so that no coordinate is larger than one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalFrame {
    center: Double3,
    scale: f64,
    /// Rays that start farther from the middle are unusual.
    far: f64,
    /// So are directions whose largest coordinate is shorter or longer than these.
    lengths: [f64; 2],
}

/// A ray as it is seen in the frame, rounded, and how wrong that is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    /// Where and what it is. Its interval is rounded outwards.
    pub(crate) ray: Ray,
    /// How far beside each other a point of the ray and one of the mesh may lie, along each axis, that are the same in truth.
    pub(crate) displacement: f32,
    /// Distances are so many times those of the true ray.
    unit: f64,
    /// And less by so much.
    shift: f64,
}

/// Rays that start farther away than so many times the frame's size are looked at from near by.
const FAR: f64 = 32.0;

/// Directions whose largest coordinate lies between these, seen in the frame, are taken as they are.
const USUAL_LENGTHS: [f64; 2] = [1e-15, 1e15];

/// What rounding moves points of rays and meshes by, per largest coordinate: two roundings, and a quarter of that to spare.
const DISPLACEMENT: f64 = f32::EPSILON as f64 * 1.25;

/// The same of what was moved in double precision.
const MOVED_DISPLACEMENT: f64 = f64::EPSILON * 8.0;

impl LocalFrame {
    /// The frame of a mesh.
    pub(super) fn of(mesh: &TriangleMesh64) -> Self {
        let [min, max] = mesh.total_bounds().unwrap_or_default();
        let center = [0, 1, 2].map(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
        let half = largest_magnitude(sub(max, center)).max(largest_magnitude(sub(center, min)));
        let size = if half > 0.0 { half } else { largest_magnitude(center) };
        // The logarithm may be off where a power of two is near.
        let exponent = if size > 0.0 { size.log2().ceil() } else { 0.0 };
        let scale = (-exponent).exp2();
        let scale = if size * scale > 1.0 { 0.5 * scale } else { scale };
        let [short, long] = USUAL_LENGTHS;
        Self {
            center,
            scale,
            // What is not valid is never usual.
            far: FAR.min((Ray64::GREATEST - largest_magnitude(center)) * scale),
            lengths: [short.max(scale / Ray64::GREATEST), long.min(scale * Ray64::GREATEST)],
        }
    }

    /// The mesh in this frame.
    pub(super) fn mesh(&self, mesh: &TriangleMesh64) -> TriangleMesh {
        let place = |p: &Double3| {
            let p = single(self.point(*p));
            // Vertices that no triangle uses may lie anywhere.
            if p.is_finite() { p } else { Vec3::ZERO }
        };
        let positions: Vec<Vec3> = mesh.positions().iter().map(place).collect();
        TriangleMesh::of_sound(positions, mesh.triangles().to_vec())
    }

    /// Where a point lies in it.
    #[inline(always)]
    pub(super) fn point(&self, p: Double3) -> Double3 {
        let [x, y, z] = sub(p, self.center);
        [x * self.scale, y * self.scale, z * self.scale]
    }

    /// A length in it.
    #[inline(always)]
    pub(super) fn length(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// Takes boxes that stand in another frame into this one: larger by what both meshes were displaced by when they were rounded, and by what counts as touching, and rounded outwards.
    pub(super) fn place_of(&self, other: &Self) -> impl Fn(&Aabb) -> Aabb {
        let (ratio, moved) = (self.scale / other.scale, self.point(other.center));
        let margin = DISPLACEMENT * (1.0 + ratio) + MOVED_DISPLACEMENT * largest_magnitude(moved);
        move |bounds| {
            let [mut min, mut max] = [[0.0; 3]; 2];
            for axis in 0..3 {
                let place = |x: f32| f64::from(x) * ratio + moved[axis];
                // Finite, so that no child that is not there touches it.
                min[axis] = rounded_down(place(bounds.min[axis]) - margin).max(f32::MIN);
                max[axis] = rounded_up(place(bounds.max[axis]) + margin).min(f32::MAX);
            }
            Aabb { min: min.into(), max: max.into() }
        }
    }

    /// A ray as it is seen in it. One that is not valid is none there either.
    #[inline(always)]
    pub(crate) fn ray(&self, ray: &Ray64) -> LocalRay {
        let origin = self.point(ray.origin);
        let [x, y, z] = ray.direction;
        let direction = [x * self.scale, y * self.scale, z * self.scale];
        let distance = largest_magnitude(origin);
        let length = largest_magnitude(direction);
        let [short, long] = self.lengths;
        if !(short <= length && length <= long && distance <= self.far) {
            return unusual(ray, origin, direction);
        }
        let ray = Ray {
            origin: single(origin),
            t_min: rounded_down(ray.t_min),
            direction: single(direction),
            t_max: rounded_up(ray.t_max),
        };
        LocalRay { ray, displacement: displacement(distance), unit: 1.0, shift: 0.0 }
    }
}

impl LocalRay {
    /// Whether it is the ray itself, only rounded: not looked at from nearer by, nor in another unit.
    #[inline(always)]
    pub(crate) fn is_usual(&self) -> bool {
        self.unit == 1.0 && self.shift == 0.0
    }

    /// A distance along the true ray as one along this, rounded upwards.
    #[inline(always)]
    pub(crate) fn limit(&self, t: f64) -> f32 {
        rounded_up(t * self.unit - self.shift)
    }
}

/// What rays are displaced by that start so far away.
#[inline(always)]
fn displacement(distance: f64) -> f32 {
    (DISPLACEMENT * (distance + 1.0)) as f32
}

/// A ray from far away, or of an unusually long or short direction; or one that is not valid.
#[cold]
#[inline(never)]
fn unusual(ray: &Ray64, origin: Double3, direction: Double3) -> LocalRay {
    if !ray.is_valid() {
        return LocalRay { ray: Ray::NONE, displacement: 0.0, unit: 1.0, shift: 0.0 };
    }
    // A power of two in which the direction is about one.
    let exponent = largest_magnitude(direction).log2().round();
    let [factor, unit] = [(-exponent).exp2(), exponent.exp2()];
    let direction = direction.map(|coordinate| coordinate * factor);

    // Where the ray is nearest to the frame's middle, and back a few times the frame's size.
    let distance = largest_magnitude(origin);
    let shift = if distance > FAR {
        let square = direction.iter().map(|d| d * d).sum::<f64>();
        let along = origin.iter().zip(direction).map(|(o, d)| o * d).sum::<f64>();
        -along / square - 4.0
    } else {
        0.0
    };
    let near = [0, 1, 2].map(|axis| origin[axis] + shift * direction[axis]);
    let place = |t: f64| t * unit - shift;
    // What rounding of the shifted interval's ends does is a shift, too.
    LocalRay {
        ray: Ray {
            origin: single(near),
            t_min: rounded_down(place(ray.t_min)),
            direction: single(direction),
            t_max: rounded_up(place(ray.t_max)),
        },
        displacement: displacement(largest_magnitude(near))
            + rounded_up(MOVED_DISPLACEMENT * distance),
        unit,
        shift,
    }
}

/// The greatest number in single precision that is not larger. NaN stays NaN.
#[inline(always)]
fn rounded_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

/// The least number in single precision that is not smaller.
#[inline(always)]
fn rounded_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}
