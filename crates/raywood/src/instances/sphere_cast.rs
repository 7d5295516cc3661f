//! What a moving sphere touches first in scenes of instances.
//!
//! In an object's space the sphere is an ellipsoid that moves along a straight line. Boxes are looked at there, each larger by the ellipsoid's extent along each axis; triangles where they stand, in the
//! scene's space, where it is a sphere. `docs/numerics.md`, "Instances", has the errors.

use std::ops::ControlFlow;

use super::closest_point::closest_of;
use super::place::Placement;
use super::space::Affine;
use super::transform::USUAL_LENGTHS;
use super::{Built, Searchable, Tlas};
use crate::double::{Double3, double, largest_magnitude, single};
use crate::query::First;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::structures::wide::search::SearchStack;
use crate::structures::wide::sweep::Sweep;
use crate::{Bvh, Geometry, PreparedRay, Ray, SphereHit, parallel};

impl<B: Searchable> Tlas<B> {
    /// What a sphere first touches whose centre moves along a ray: the least `t` of the ray's interval at which something is no further than `radius` from the
    /// centre; `t_min` where it overlaps something already. `None` if it touches nothing, and for invalid rays and a radius that is
    /// negative, infinite or NaN. At exactly equal `t` the lowest instance is told, of it the lowest primitive. Instances that no [mask](crate::Instance::mask) sees are not there.
    ///
    /// It is a sphere in the scene's space, however instances are scaled and sheared. Triangles are solved exactly, as by [`Bvh::sphere_cast`](crate::Bvh::sphere_cast), by corners that are not rounded on their way. Other
    /// primitives are approached in steps where transforms only turn, mirror, move and scale by the same in all directions; elsewhere such primitives are not seen.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, Ray, Tlas, Transform, TriangleMesh};
    /// use std::sync::Arc;
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let leaf = Arc::new(Bvh::build(mesh)?);
    /// let wide = Transform::scaling([8.0, 8.0, 0.5]).then(&Transform::translation([0.0, 0.0, 2.0]));
    /// let scene = Tlas::build(vec![Instance::new(Arc::clone(&leaf), Transform::IDENTITY), Instance::new(leaf, wide)])?;
    ///
    /// let ball = scene.sphere_cast(&Ray::new([2.0, 2.0, 5.0], [0.0, 0.0, -1.0]), 0.5).expect("it lands");
    /// assert_eq!((ball.instance, ball.t, ball.point), (1, 2.5, [2.0, 2.0, 2.0].into()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sphere_cast(&self, ray: &Ray, radius: f32) -> Option<SphereHit> {
        let prepared = PreparedRay::new(ray)?;
        if !(radius >= 0.0 && radius.is_finite()) {
            return None;
        }
        let unit = |axis: usize| [0, 1, 2].map(|i| f64::from(u8::from(i == axis)));
        let mut search = SweptSearch {
            radius: f64::from(radius),
            t_min: ray.t_min,
            origin: double(ray.origin),
            direction: double(ray.direction),
            columns: [unit(0), unit(1), unit(2)],
            error: 0.0,
            placed: Affine::IDENTITY,
            number: 0,
            first: First::new(&prepared, radius),
        };
        search.through_scene(self);
        search.first.hit
    }

    /// [`sphere_cast`](Self::sphere_cast) for many spheres of the same radius, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn sphere_cast_batch(&self, rays: &[Ray], radius: f32, hits: &mut [Option<SphereHit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill(rays, hits, |ray| self.sphere_cast(ray, radius));
    }
}

/// A search for what a moving sphere touches first: what [`Searchable`]s hand on to each other.
pub struct SweptSearch<'a> {
    /// In the scene's space.
    radius: f64,
    t_min: f32,
    /// Where the centre starts and how it moves in the space of the object that is searched.
    origin: Double3,
    direction: Double3,
    /// What becomes of the scene's axes there.
    columns: [Double3; 3],
    /// By how much positions may be off there.
    error: f64,
    /// The way back into the scene's space.
    placed: Affine,
    /// The number of the object's first instance.
    number: u32,
    first: First<'a>,
}

/// What rounding of inverses takes away from coordinates at most, by the worst condition that they may have.
const INVERSE_ERROR: f64 = 1.0 / (1u64 << 28) as f64;

/// What rounding of rays in an object's space moves the centre by, of the sum of the largest coordinates: one rounding each of origin and direction, and as much to spare.
const RAY_ERROR: f64 = 2.0 * f32::EPSILON as f64;

/// The centre's way as an object's boxes see it.
struct Seen {
    ray: PreparedRay,
    /// How much larger boxes are along each axis.
    radii: [f32; 3],
    /// Distances are so many times longer in the scene.
    unit: f64,
}

impl SweptSearch<'_> {
    /// The centre's way in an object's space, where nothing reaches further from zero; `None` where there are no numbers for it.
    fn seen(&self, reach: f32) -> Option<Seen> {
        // Of the ellipsoid that the sphere is.
        let extent = |axis: usize| {
            let [x, y, z] = self.columns.map(|column| column[axis]);
            self.radius * (x * x + y * y + z * z).sqrt()
        };
        let extents = [extent(0), extent(1), extent(2)];
        let farthest =
            largest_magnitude(self.origin) + f64::from(reach) + largest_magnitude(extents);
        let margin = self.error + RAY_ERROR * farthest + f64::from(f32::MIN_POSITIVE);
        let radii = extents.map(|extent| ((extent + margin) as f32).next_up().min(f32::MAX));

        let length = largest_magnitude(self.direction);
        let unit = match USUAL_LENGTHS.contains(&length) {
            true => 1.0,
            false => (-length.log2().round().clamp(-1000.0, 1000.0)).exp2(),
        };
        let direction = self.direction.map(|x| x * unit);
        // Not behind what was touched already.
        let [t_min, t_max] = [self.t_min, self.first.limit()].map(|t| f64::from(t) / unit);
        let ray = Ray::new(single(self.origin), single(direction))
            .with_interval((t_min as f32).next_down(), (t_max as f32).next_up());
        Some(Seen { ray: PreparedRay::new(&ray)?, radii, unit })
    }

    /// Goes through a scene.
    pub(super) fn through_scene<B: Searchable>(&mut self, scene: &Tlas<B>) {
        let Built { placements, tree, .. } = &scene.built;
        let Some(seen) = self.seen(tree.reach()) else { return self.through_all(placements) };
        let [x, y, z] = seen.radii;
        let _ = tree.walk(scene.level, &seen.ray, x.max(y).max(z), f32::INFINITY, |entry, _| {
            self.through_instance(&placements[entry as usize]);
            ControlFlow::Continue(seen.limit(self.first.limit()))
        });
    }

    /// Goes through all instances, where no boxes can be asked.
    #[cold]
    fn through_all<B: Searchable>(&mut self, placements: &[Placement<B>]) {
        placements.iter().for_each(|place| self.through_instance(place));
    }

    /// Goes through an instance.
    fn through_instance<B: Searchable>(&mut self, place: &Placement<B>) {
        // What nobody sees is not there.
        if place.mask == 0 {
            return;
        }
        let inverse = &place.inverse;
        let outside =
            (self.origin, self.direction, self.columns, self.error, self.placed, self.number);
        let stretch = inverse.stretch();
        let terms = stretch * (largest_magnitude(self.origin) + inverse.distance());
        self.error = stretch * self.error + INVERSE_ERROR * terms;
        self.origin = inverse.point(self.origin);
        self.direction = inverse.vector(self.direction);
        self.columns = self.columns.map(|column| inverse.vector(column));
        self.placed = self.placed.after(&place.transform);
        self.number += place.first;
        place.object.search_swept(self);
        (self.origin, self.direction, self.columns, self.error, self.placed, self.number) = outside;
    }

    /// Goes through a tree.
    pub(super) fn through_tree<G: Geometry>(&mut self, bvh: &Bvh<G>) {
        match self.seen(bvh.tree.reach()) {
            Some(seen) => {
                dispatch_on(bvh.tree.level(), ThroughTree { bvh, seen: &seen, search: self });
            }
            None => (0..bvh.geometry.len() as u32).for_each(|primitive| {
                self.look_at(
                    &bvh.geometry,
                    primitive,
                    bvh.geometry.triangle(primitive).map(|c| c.map(double)),
                );
            }),
        }
    }

    /// Looks at a primitive, by its corners in the object's space if it is a triangle.
    fn look_at(&mut self, geometry: &dyn Geometry, primitive: u32, corners: Option<[Double3; 3]>) {
        let (placed, numbers) = (&self.placed, (self.number, primitive));
        match corners {
            Some([a, b, c]) => {
                self.first.test(numbers, [placed.point(a), placed.point(b), placed.point(c)]);
            }
            None => {
                // Coordinates are rounded where they are largest, here or there.
                let bounds = geometry.bounds(primitive);
                let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
                let sum = |[x, y, z, w]: [f64; 4]| {
                    (x.abs() + y.abs() + z.abs()) * f64::from(reach) + w.abs()
                };
                let largest = placed.rows.map(sum).into_iter().fold(0.0, f64::max);
                self.first.approach_placed(numbers, largest, |center| {
                    Some(closest_of(geometry, primitive, placed, center)?.0)
                });
            }
        }
    }
}

impl Seen {
    /// A distance in the scene as one here, rounded upwards.
    fn limit(&self, t: f32) -> f32 {
        if self.unit == 1.0 { t } else { ((f64::from(t) / self.unit) as f32).next_up() }
    }
}

/// A search through a tree.
struct ThroughTree<'s, 'a, G> {
    bvh: &'s Bvh<G>,
    seen: &'s Seen,
    search: &'s mut SweptSearch<'a>,
}

impl<G: Geometry> Kernel for ThroughTree<'_, '_, G> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { bvh: Bvh { tree, geometry }, seen, search } = self;
        let mut sweep = Sweep::new(&seen.ray, seen.radii, tree.reach(), |leaf, lane| {
            let primitive = leaf.block.primitives[lane];
            let is_other = leaf.others >> lane & 1 == 1;
            let corners = (!is_other).then(|| leaf.block.corners(lane).map(double));
            search.look_at(geometry, primitive, corners);
            seen.limit(search.first.limit())
        });
        // It goes on to the end: what comes later may be touched earlier.
        let _ = tree.search(simd, &mut SearchStack::new(tree), &mut sweep);
    }
}
