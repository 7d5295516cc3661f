//! What every structure is asked: rays, points and regions that look for trouble, and the scenes that they are about.

use std::ops::Range;

use raywood::{Aabb, Geometry, Ray, Ray64, TriangleMesh, Vec3};
use raywood_testkit::Rng;
use raywood_testkit::placement::Placement;
use raywood_testkit::reference::{Entry, Met, Reference, Region, Shape, in_double};

use super::axes::Query;
use super::geometries::{Primitive, on_lattice};

/// An instance: where, and in which groups.
pub(crate) type Placed = (Placement, u32);

/// One instance in its place: no instance at all.
pub(crate) const ALONE: &[Placed] = &[(Placement::IDENTITY, u32::MAX)];

/// Instances that are moved, turned, mirrored, scaled, sheared; two in the same place, one that nobody sees.
pub(crate) fn places() -> Vec<Placed> {
    let here = Placement::IDENTITY;
    let turned = here.turned().moved([2.0, -1.5, 0.25]);
    vec![
        (here, u32::MAX),
        (turned, 0b011),
        (here.scaled([-1.0, 1.0, 1.0]).moved([-2.0, 0.5, 1.0]), 0b010),
        (here.scaled([2.0, 0.5, 1.0]).turned().moved([0.0, 2.0, -2.0]), 0b101),
        (here.moved([0.5; 3]), 0),
        (here.sheared(0.5).moved([1.5, 2.0, 1.0]), u32::MAX),
        (here.turned().scaled([-2.0, 2.0, 2.0]).moved([-3.0, -3.0, -3.0]), u32::MAX),
        (turned, 0b110),
    ]
}

/// Where scenes of such instances stand.
pub(crate) fn outer_places() -> Vec<Placed> {
    let here = Placement::IDENTITY;
    vec![
        (here.turned().scaled([1.0, -2.0, 1.0]).moved([4.0, 0.0, -1.0]), u32::MAX),
        (here, 0b010),
        (here.sheared(-0.25).moved([-8.0, 4.0, 0.0]), 0b111),
    ]
}

/// The primitives of all instances of all instances, in the order of their numbers; without those that nobody sees.
pub(crate) fn reference(primitives: &[Primitive], inner: &[Placed], outer: &[Placed]) -> Reference {
    let mut entries: Vec<Entry> = Vec::new();
    let mut instance = 0;
    for &(outside, outer_mask) in outer {
        for &(inside, inner_mask) in inner {
            let placement = inside.then(outside);
            for (primitive, own) in primitives.iter().enumerate() {
                let Primitive { shape, mask, tells_points } = *own;
                let entry = Entry {
                    instance,
                    primitive: primitive as u32,
                    masks: [mask, inner_mask, outer_mask],
                    shape,
                    placement,
                    tells_points,
                    twin: None,
                };
                let is_twin = |other: &Entry| other.shape == shape && other.placement == placement;
                let twin = entries.iter().position(is_twin);
                if inner_mask != 0 && outer_mask != 0 {
                    entries.push(Entry { twin, ..entry });
                }
            }
            instance += 1;
        }
    }
    Reference { entries, epsilon: f64::from(f32::EPSILON), size: 16.0 }
}

/// Where and how large the space is that questions are about, and whether they must be the same in single precision.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) origin: [f64; 3],
    /// A power of two.
    pub(crate) scale: f64,
    pub(crate) is_single: bool,
}

impl Frame {
    /// Around zero.
    pub(crate) const SINGLE: Self = Self { origin: [0.0; 3], scale: 1.0, is_single: true };
}

/// Everything that is asked about a scene.
pub(crate) struct Questions {
    pub(crate) reference: Reference,
    /// Rays of all kinds, then such from one point, then such to one point, then such that are none.
    pub(crate) met: Vec<Met>,
    from_point: Range<usize>,
    to_point: Range<usize>,
    /// What each ray is to skip.
    pub(crate) skips: Vec<(u32, u32)>,
    pub(crate) points: Vec<[f64; 3]>,
    /// Up to which distance each point looks.
    pub(crate) limits: Vec<f64>,
    /// Half the size of the box around each point, and the radius of the ball there.
    pub(crate) halves: Vec<[f64; 3]>,
    pub(crate) radii: Vec<f64>,
    /// Triangles that are in the way.
    pub(crate) others: Vec<[[f64; 3]; 3]>,
    /// Of a view along each axis, from a point: the eye, and half of its width.
    pub(crate) views: Vec<([f64; 3], f64)>,
    /// The radius of spheres that move.
    pub(crate) radius: f64,
    /// What is one in the frame.
    unit: f64,
}

/// How many of the nearest hits each ray asks for.
pub(crate) fn nearest(ray: usize) -> usize {
    [1, 2, 3, 0, 7, usize::MAX][ray % 6]
}

/// After how many hits each ray has enough.
pub(crate) fn enough(ray: usize) -> usize {
    1 + ray % 3
}

/// How many of the nearest hits rays of a batch ask for.
pub(crate) const NEAREST: usize = 3;

/// A point of a shape that is worth aiming at: vertices, edges, faces.
fn aim(shape: &Shape, rng: &mut Rng) -> [f64; 3] {
    let p = match shape {
        Shape::Triangle([a, b, c]) => match rng.below(4) {
            0 => *a,
            1 => [0, 1, 2].map(|i| 0.5 * (b[i] + c[i])),
            2 => [0, 1, 2].map(|i| 0.25 * a[i] + 0.75 * b[i]),
            _ => [0, 1, 2].map(|i| 0.25 * a[i] + 0.25 * b[i] + 0.5 * c[i]),
        },
        Shape::Solid(solid) => {
            let (center, reach, _) = solid.extent();
            let near = center + reach * rng.in_cube();
            return in_double(on_lattice(if rng.below(3) == 0 { center } else { near }));
        }
    };
    p.map(|x| (1024.0 * x).round() / 1024.0)
}

impl Questions {
    /// Those about a scene that lies in a frame.
    pub(crate) fn about(reference: Reference, frame: Frame) -> Self {
        let Frame { origin, scale: unit, is_single } = frame;
        let mut rng = Rng::new(1);
        let entries = &reference.entries;
        let target = |rng: &mut Rng| {
            let entry = &entries[rng.below(entries.len())];
            entry.placement.point(aim(&entry.shape, rng))
        };
        let add = |a: [f64; 3], s: f64, b: [f64; 3]| [0, 1, 2].map(|i| a[i] + s * b[i]);
        let ray = |from: [f64; 3], to: [f64; 3], scale: f64| {
            let direction = [0, 1, 2].map(|i| scale * (to[i] - from[i]));
            Ray64::new(from, direction)
        };
        let near = |rng: &mut Rng, reach: f32| {
            in_double(on_lattice(reach * rng.in_cube())).map(|x| unit * x)
        };
        let mut rays: Vec<Ray64> = Vec::new();
        let takes = |ray: &Ray64| {
            let mut places = entries.iter().step_by(7);
            ray.direction != [0.0; 3] && (!is_single || places.all(|entry| entry.takes(ray)))
        };
        while rays.len() < 96 {
            let number = rays.len();
            let to = target(&mut rng);
            let entry = &entries[rng.below(entries.len())];
            let from = add(to, 1.0, near(&mut rng, [0.5, 2.0, 4.0][number % 3]));
            let corners = match entry.shape {
                Shape::Triangle(corners) => Some(corners.map(|p| entry.placement.point(p))),
                Shape::Solid(_) => None,
            };
            let ray = match (number % 8, corners) {
                // Along an edge, and within a face.
                (0, Some([a, b, _])) => ray(add(b, 2.0, add(a, -1.0, b)), a, 0.25),
                (1, Some([a, b, c])) => {
                    ray(add(a, 1.0, add(b, -1.0, c)), add(a, -1.0, add(b, -1.0, c)), 1.0)
                }
                // Along an axis through it.
                (2, _) => {
                    let axis = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]][rng.below(3)];
                    Ray64::new(add(to, -3.0 * unit, axis), axis.map(|x| unit * x))
                }
                (3, _) => ray(from, to, 1.0 / 64.0),
                (4, _) => ray(from, to, 64.0),
                (5, _) => ray(from, to, 1.0).with_interval(0.5, 2.0),
                (6, _) => ray(from, to, 1.0).with_interval(-1.0, 1.0),
                _ => ray(from, to, 1.0),
            };
            if takes(&ray) {
                rays.push(ray);
            }
        }

        // As of a camera, and to a light.
        let eye = add(origin, unit, [0.25, -0.5, 2.0]);
        let start = rays.len();
        while rays.len() < start + 64 {
            rays.extend(Some(ray(eye, target(&mut rng), 1.0)).filter(takes));
        }
        let from_point = start..rays.len();
        while rays.len() < start + 128 {
            let point = add(target(&mut rng), 1.0, near(&mut rng, 0.25));
            rays.extend(Some(ray(point, eye, 1.0).with_interval(0.0, 1.0)).filter(takes));
        }
        let to_point = from_point.end..rays.len();
        let valid = rays.len();
        let good = rays[0];
        let mut broken = [good; 7];
        broken[0].origin[1] = f64::NAN;
        broken[1].direction[0] = f64::INFINITY;
        broken[2].direction = [0.0; 3];
        broken[3] = good.with_interval(f64::NAN, 1.0);
        broken[4] = good.with_interval(0.0, f64::NAN);
        broken[5] = good.with_interval(1.0, 1.0);
        broken[6].origin = [f64::NEG_INFINITY; 3];
        rays.extend(broken);

        let pairs = rays.iter().enumerate();
        let met: Vec<_> = pairs.map(|(i, ray)| reference.meet(ray, i < valid)).collect();
        let skips = met.iter().map(|met| reference.first(met).unwrap_or((0, 0))).collect();

        // On it, near it, inside, far away.
        let mut points: Vec<_> = (0..40)
            .map(|number| match number % 4 {
                0 => target(&mut rng),
                1 => add(target(&mut rng), 1.0 / 16.0, near(&mut rng, 1.0)),
                2 => add(origin, 1.0, near(&mut rng, 1.5)),
                _ => add(origin, 1.0, near(&mut rng, 60.0)),
            })
            .collect();
        points.extend([[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0]]);
        let count = points.len();
        let limits = [f64::INFINITY, 0.25 * unit, 0.0, -1.0];
        let limits = (0..count).map(|i| limits[i * 5 / 3 % 4]).collect();
        let size = |rng: &mut Rng, i: usize| {
            let size = [0.25, 2.0, 0.0][i % 3] * rng.unit();
            unit * f64::from((1024.0 * size).round() / 1024.0)
        };
        let halves = (0..count).map(|i| [0; 3].map(|_| size(&mut rng, i))).collect();
        let radii = (0..count).map(|i| size(&mut rng, i + 1)).collect();
        // Askew to everything, so that nobody asks what touches by next to nothing.
        let others = raywood_testkit::shapes::soup(12, 0.9, 77);
        let others = (0..12).map(|n| others.corners(n).map(|p| add(origin, unit, in_double(p))));
        let others = others.collect();
        let views = (0..6).map(|i| (add(origin, 1.0, near(&mut rng, 2.0)), [0.25, 1.0][i % 2]));
        let views = views.collect();
        Self {
            met,
            from_point,
            to_point,
            skips,
            points,
            limits,
            halves,
            radii,
            others,
            views,
            radius: 0.125 * unit,
            unit,
            reference,
        }
    }

    /// The numbers of the rays that a query is about.
    pub(crate) fn range(&self, query: Query) -> Range<usize> {
        match query {
            Query::ClosestFrom => self.from_point.clone(),
            Query::AnyTowards => self.to_point.clone(),
            _ => 0..self.met.len(),
        }
    }

    /// The rays that a query is about, in single precision.
    pub(crate) fn rays(&self, query: Query) -> Vec<Ray> {
        let single = |p: [f64; 3]| Vec3::from(p.map(|x| x as f32));
        let one = |met: &Met| {
            let Ray64 { origin, direction, t_min, t_max } = met.ray;
            Ray::new(single(origin), single(direction)).with_interval(t_min as f32, t_max as f32)
        };
        self.met[self.range(query)].iter().map(one).collect()
    }

    /// The same in double precision.
    pub(crate) fn rays64(&self, query: Query) -> Vec<Ray64> {
        self.met[self.range(query)].iter().map(|met| met.ray).collect()
    }

    /// A triangle that is in the way, in single precision.
    pub(crate) fn other(&self, number: usize) -> [Vec3; 3] {
        self.others[number].map(|p| Vec3::from(p.map(|x| x as f32)))
    }

    /// All of them as a mesh.
    pub(crate) fn mesh_of_others(&self) -> TriangleMesh {
        let count = self.others.len();
        let corners = (0..count).flat_map(|number| self.other(number)).collect();
        let indices = (0..count as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        TriangleMesh::new(corners, indices).expect("a mesh")
    }

    /// A point in single precision.
    pub(crate) fn point(&self, number: usize) -> Vec3 {
        Vec3::from(self.points[number].map(|x| x as f32))
    }

    /// The corners of the box around a point.
    pub(crate) fn corners(&self, number: usize) -> [[f64; 3]; 2] {
        let (p, half) = (self.points[number], self.halves[number]);
        [-1.0, 1.0].map(|side| [0, 1, 2].map(|i| p[i] + side * half[i]))
    }

    /// The box around a point as a region.
    pub(crate) fn cuboid(&self, number: usize) -> Region {
        let [min, max] = self.corners(number);
        let axis = |i: usize, sign: f64| [0, 1, 2].map(|j| if i == j { sign } else { 0.0 });
        let sides = (0..3).flat_map(|i| [(axis(i, 1.0), -min[i]), (axis(i, -1.0), max[i])]);
        let (planes, center) = (sides.collect(), self.points[number]);
        Region::Planes(planes, self.reference.margin(), center)
    }

    /// The ball around a point as a region.
    pub(crate) fn ball(&self, number: usize) -> Region {
        Region::Ball(self.points[number], self.radii[number])
    }

    /// The planes of a view: a plane before the eye, another behind it, and four sides.
    pub(crate) fn planes(&self, number: usize) -> [([f64; 3], f64); 6] {
        let (eye, width) = self.views[number];
        let unit = |axis: usize, sign: f64| [0, 1, 2].map(|i| if i == axis { sign } else { 0.0 });
        let (forwards, right, up) = (number % 3, (number + 1) % 3, (number + 2) % 3);
        let side = |axis: usize, sign: f64| {
            let (a, b) = (unit(axis, sign), unit(forwards, width));
            [0, 1, 2].map(|i| a[i] + b[i])
        };
        let dot = |n: [f64; 3]| n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2];
        let through = |n: [f64; 3], distance: f64| (n, -dot(n) - distance);
        [
            through(unit(forwards, 1.0), 0.125 * self.unit),
            through(unit(forwards, -1.0), -3.0 * self.unit),
            through(side(right, 1.0), 0.0),
            through(side(right, -1.0), 0.0),
            through(side(up, 1.0), 0.0),
            through(side(up, -1.0), 0.0),
        ]
    }

    /// A view as a region.
    pub(crate) fn view(&self, number: usize) -> Region {
        let mut center = self.views[number].0;
        center[number % 3] += self.unit;
        Region::Planes(self.planes(number).to_vec(), self.reference.margin(), center)
    }

    /// The box around a primitive of a scene where it stands.
    pub(crate) fn box_of(&self, instance: u32, primitive: u32) -> Aabb {
        let [min, max] = self.reference.box_of(instance, primitive).map(|p| p.map(|x| x as f32));
        Aabb::new(min, max)
    }

    /// The least distance of a point from any box of a scene, by asking all.
    pub(crate) fn nearest_of_all(&self, number: usize) -> f32 {
        let boxes = self.reference.entries.iter().map(|e| self.box_of(e.instance, e.primitive));
        let point = self.point(number);
        boxes.map(|b| super::distance_of_box(point, &b)).fold(f32::INFINITY, f32::min)
    }

    /// The least distance of a point from any primitive's box, by asking all.
    pub(crate) fn nearest_box(&self, number: usize, geometry: &dyn Geometry) -> f32 {
        let all = (0..geometry.len() as u32).map(|primitive| geometry.bounds(primitive));
        let point = self.point(number);
        all.map(|bounds| super::distance_of_box(point, &bounds)).fold(f32::INFINITY, f32::min)
    }
}
