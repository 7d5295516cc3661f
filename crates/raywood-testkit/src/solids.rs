//! Balls, capsules, cylinders, boxes and discs by their distance functions in double precision, and what a ray meets of them by marching along it: nothing is
//! solved, so no mistake of a solution is made twice.

use raywood::{Aabb, Capsule, Cylinder, Disc, Hit, Ray, Vec3};

use crate::Rng;
use crate::oracle::{Point, cross, dot, double, length, sub};

/// A shape of one of the kinds that the library has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// Centre and radius.
    Ball(Vec3, f32),
    /// A segment with thickness.
    Capsule(Capsule),
    /// One with flat ends.
    Cylinder(Cylinder),
    /// An axis-aligned box.
    Box(Aabb),
    /// A disc, which has no inside.
    Disc(Disc),
}

fn along(p: Point, t: f64, d: Point) -> Point {
    [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]]
}

impl Solid {
    /// The distance of a point from the surface, negative inside.
    pub fn distance(&self, p: Point) -> f64 {
        match *self {
            Self::Ball(center, radius) => length(sub(p, double(center))) - f64::from(radius),
            Self::Capsule(Capsule { start, end, radius }) => {
                let (from, axis) = (double(start), sub(double(end), double(start)));
                let square = dot(axis, axis);
                let share = if square > 0.0 { dot(sub(p, from), axis) / square } else { 0.0 };
                length(sub(p, along(from, share.clamp(0.0, 1.0), axis))) - f64::from(radius)
            }
            Self::Cylinder(Cylinder { start, end, radius }) => {
                // In the plane of the axis and the point: a rectangle.
                let (from, axis) = (double(start), sub(double(end), double(start)));
                let tall = length(axis);
                let height = dot(sub(p, from), axis) / tall;
                let aside = length(cross(sub(p, from), axis)) / tall;
                let (x, y) = (aside - f64::from(radius), (height - 0.5 * tall).abs() - 0.5 * tall);
                x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0)
            }
            Self::Box(Aabb { min, max }) => {
                let (min, max) = (double(min), double(max));
                let beyond = [0, 1, 2].map(|i| (min[i] - p[i]).max(p[i] - max[i]));
                length(beyond.map(|x| x.max(0.0)))
                    + beyond.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
            }
            Self::Disc(Disc { center, normal, radius }) => {
                let (offset, normal) = (sub(p, double(center)), double(normal));
                let height = dot(offset, normal) / length(normal);
                let aside = length(cross(offset, normal)) / length(normal);
                height.hypot((aside - f64::from(radius)).max(0.0))
            }
        }
    }

    /// Whether it has an inside.
    pub fn is_closed(&self) -> bool {
        !matches!(self, Self::Disc(_))
    }

    /// Its middle, how far it reaches from there, and how thick it is at least.
    pub fn extent(&self) -> (Vec3, f32, f32) {
        match *self {
            Self::Ball(center, radius) => (center, radius, 2.0 * radius),
            Self::Capsule(Capsule { start, end, radius }) => {
                (0.5 * start + 0.5 * end, 0.5 * (end - start).length() + radius, 2.0 * radius)
            }
            Self::Cylinder(Cylinder { start, end, radius }) => {
                let tall = (end - start).length();
                (0.5 * start + 0.5 * end, 0.5 * tall + radius, tall.min(2.0 * radius))
            }
            Self::Box(corners) => {
                let Vec3 { x, y, z } = corners.extent();
                (corners.center(), 0.5 * corners.diagonal(), x.min(y).min(z))
            }
            Self::Disc(Disc { center, radius, .. }) => (center, radius, radius),
        }
    }

    /// The corners of a box around it, the least first, the greatest last.
    pub fn bounds(&self) -> [Point; 8] {
        let around = |ends: [Vec3; 2], beside: [f64; 3]| {
            let [a, b] = ends.map(double);
            let min = [0, 1, 2].map(|i| a[i].min(b[i]) - beside[i]);
            let max = [0, 1, 2].map(|i| a[i].max(b[i]) + beside[i]);
            let side = |corner: usize, i: usize| if corner >> i & 1 == 0 { min[i] } else { max[i] };
            [0, 1, 2, 3, 4, 5, 6, 7].map(|corner| [0, 1, 2].map(|i| side(corner, i)))
        };
        // A circle across an axis reaches as far along others as that leaves it.
        let across = |axis: Vec3, radius: f32| {
            let axis = double(axis);
            let square = dot(axis, axis);
            axis.map(|x| f64::from(radius) * (1.0 - x * x / square).max(0.0).sqrt())
        };
        match *self {
            Self::Ball(center, radius) => around([center; 2], [f64::from(radius); 3]),
            Self::Capsule(Capsule { start, end, radius }) => {
                around([start, end], [f64::from(radius); 3])
            }
            Self::Cylinder(Cylinder { start, end, radius }) => {
                around([start, end], across(end - start, radius))
            }
            Self::Box(Aabb { min, max }) => around([min, max], [0.0; 3]),
            Self::Disc(Disc { center, normal, radius }) => {
                around([center; 2], across(normal, radius))
            }
        }
    }

    /// The largest coordinate that it has.
    pub fn largest(&self) -> f32 {
        let (center, reach, _) = self.extent();
        center.abs().max_element() + reach
    }

    /// The nearest point of the surface, by going down the slope of the distance.
    pub fn onto_surface(&self, mut p: Point) -> Point {
        let (_, reach, _) = self.extent();
        let step = 1e-6 * f64::from(reach);
        for _ in 0..8 {
            let here = self.distance(p);
            let slope = [0, 1, 2].map(|axis| {
                let mut beside = p;
                beside[axis] += step;
                (self.distance(beside) - here) / step
            });
            p = along(p, -here, slope);
        }
        p
    }

    /// A ray that looks for trouble: at random, from inside, grazing, along axes, in the planes of ends, of any length and over limited intervals.
    pub fn ray(&self, rng: &mut Rng) -> Ray {
        let (center, reach, thickness) = self.extent();
        let distance = reach * 10f32.powf(rng.range(0.2, 3.0));
        let from = match rng.below(4) {
            0 => center + 0.5 * thickness * rng.in_cube(),
            1 => center + reach * rng.in_cube(),
            _ => center + distance * rng.direction(),
        };
        let surface = self.onto_surface(double(center + 1.5 * reach * rng.in_cube()));
        let surface = Vec3::new(surface[0] as f32, surface[1] as f32, surface[2] as f32);
        let aside = 10f32.powf(rng.range(-7.0, 0.0)) * thickness * rng.in_cube();
        let (ends, axis) = match *self {
            Self::Capsule(Capsule { start, end, .. })
            | Self::Cylinder(Cylinder { start, end, .. }) => ([start, end], end - start),
            Self::Disc(Disc { center, normal, .. }) => ([center; 2], normal),
            Self::Box(Aabb { min, max }) => ([min, max], Vec3::X),
            Self::Ball(center, _) => ([center; 2], Vec3::Y),
        };
        let ray = match rng.below(8) {
            0 => Ray::new(from, center + reach * rng.in_cube() - from),
            // Along the shape's own axis, and across it at an end.
            1 => Ray::new(surface + aside - 2.0 * axis, axis),
            2 => Ray::new(from, ends[rng.below(2)] - from),
            3 => {
                let (s, t) = axis.normalize_or_zero().orthonormal_basis();
                let across = rng.range(-1.0, 1.0) * s + rng.range(-1.0, 1.0) * t;
                let end = ends[rng.below(2)] + 0.3 * thickness * rng.in_cube();
                Ray::new(end - 3.0 * reach * across, across)
            }
            4 => {
                let mut direction = [0.0; 3];
                direction[rng.below(3)] = if rng.below(2) == 0 { 1.0 } else { -1.0 };
                let direction = Vec3::from(direction);
                Ray::new(surface + aside - 3.0 * reach * direction, direction)
            }
            _ => Ray::new(from, surface + aside - from),
        };
        match rng.below(6) {
            0 => Ray { direction: 1e-3 * ray.direction, ..ray },
            1 => Ray { direction: 1e3 * ray.direction, ..ray },
            2 => ray.with_interval(0.3, 1.1),
            3 => ray.with_interval(-1.0, f32::INFINITY),
            _ => ray,
        }
    }

    /// On which side of the surface a point lies, and of a disc's plane: the distance, negative inside.
    fn height(&self, p: Point) -> f64 {
        match *self {
            Self::Disc(Disc { center, normal, .. }) => {
                dot(sub(p, double(center)), double(normal)) / length(double(normal))
            }
            _ => self.distance(p),
        }
    }

    /// What a ray meets.
    pub fn march(&self, ray: &Ray) -> Passage {
        let (o, d) = (double(ray.origin), double(ray.direction));
        let (speed, (center, reach, thickness)) = (length(d), self.extent());
        let (t_min, t_max) = (f64::from(ray.t_min), f64::from(ray.t_max));
        // What lies this near counts as on the surface.
        let largest = f64::from(ray.origin.abs().max_element() + self.largest());
        let shell = (1e-5 * f64::from(thickness)).max(1e-13 * largest);
        let side = |t: f64| {
            let height = self.height(along(o, t, d));
            if height.abs() > shell { height.signum() } else { 0.0 }
        };

        let mut passage =
            Passage { crossings: Vec::new(), fronts: Vec::new(), touches: side(t_min) == 0.0 };
        let (mut last, mut in_shell) = ((t_min, side(t_min)), false);
        let mut t = t_min;
        for _ in 0..50_000 {
            let p = along(o, t, d);
            let is_leaving = dot(sub(p, double(center)), d) > 0.0
                && length(sub(p, double(center))) > 2.0 * f64::from(reach);
            if t >= t_max || is_leaving {
                passage.touches |= in_shell;
                return passage;
            }
            t = (t + self.distance(p).abs().max(0.5 * shell) / speed).min(t_max);
            match side(t) {
                0.0 => in_shell = true,
                now => {
                    if last.1 != 0.0 && now != last.1 {
                        self.cross(last.0, t, &mut passage, shell, |t| along(o, t, d));
                    } else {
                        passage.touches |= in_shell;
                    }
                    (last, in_shell) = ((t, now), false);
                }
            }
        }
        // Too near to the surface for too long.
        passage.touches = true;
        passage
    }

    /// Notes the crossing between two distances.
    fn cross(
        &self,
        mut low: f64,
        mut high: f64,
        passage: &mut Passage,
        shell: f64,
        at: impl Fn(f64) -> Point,
    ) {
        let before = self.height(at(low)).signum();
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.height(at(middle)).signum() == before { low = middle } else { high = middle }
        }
        if let Self::Disc(Disc { center, radius, .. }) = *self {
            // The plane was crossed; within the disc?
            let inside = f64::from(radius) - length(sub(at(high), double(center)));
            passage.touches |= inside.abs() <= shell;
            if inside <= shell {
                return;
            }
        }
        passage.crossings.push(high);
        passage.fronts.push(before > 0.0);
    }

    /// By how much a distance along a ray may be off: its rounding.
    pub fn tolerance(&self, ray: &Ray, t: f64) -> f64 {
        let largest = f64::from(ray.origin.abs().max_element() + self.largest());
        t.abs() * f64::from(f32::EPSILON) + 1e-13 * largest / length(double(ray.direction))
    }

    /// How far a hit lies off the surface, as a multiple of what is allowed.
    pub fn off_surface(&self, ray: &Ray, t: f64) -> f64 {
        let direction = double(ray.direction);
        let off = self.distance(along(double(ray.origin), t, direction)).abs();
        off / (self.tolerance(ray, t) * length(direction))
    }

    /// Checks all hits of a ray with this shape alone, sorted; an error says what is wrong with them.
    pub fn check_all(&self, ray: &Ray, hits: &[f32]) -> Result<(), String> {
        let wrong = |what: &str, passage: &Passage| {
            Err(format!("{what}: {hits:?}, {passage:?}, {self:?}, {ray:?}"))
        };
        let passage = self.march(ray);
        for &t in hits {
            if !(ray.t_min <= t && t < ray.t_max) {
                return wrong("outside of the interval", &passage);
            }
            let off = self.off_surface(ray, f64::from(t));
            if off > 1.0 {
                return wrong(&format!("{off} times too far off the surface"), &passage);
            }
        }
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * (a.abs() + b.abs());
        if passage.touches {
            return Ok(());
        }
        if hits.len() != passage.crossings.len() {
            // Crossings at the very ends may be seen on the other side of them.
            let at_end =
                |&t: &f64| [ray.t_min, ray.t_max].iter().any(|&end| near(t, f64::from(end)));
            if !passage.crossings.iter().any(at_end) {
                return wrong("another number of crossings", &passage);
            }
        }
        Ok(())
    }

    /// Checks the closest hit of a ray with this shape alone; an error says what is wrong with it.
    pub fn check_closest(&self, ray: &Ray, hit: Option<Hit>) -> Result<(), String> {
        let passage = self.march(ray);
        let first = passage.crossings.first().copied();
        let t = hit.map(|hit| f64::from(hit.t));
        let agree = match (t, first) {
            // Before it there may only be what is touched, and that must lie on the surface.
            (Some(t), Some(first)) => {
                let tolerance = self.tolerance(ray, first);
                t <= first + tolerance && (passage.touches || t >= first - tolerance)
            }
            (Some(_), None) => passage.touches,
            (None, Some(first)) => {
                let tolerance = self.tolerance(ray, first);
                let end = f64::from(ray.t_max);
                first < f64::from(ray.t_min) + tolerance || first > end - tolerance
            }
            (None, None) => true,
        };
        let off = hit.map_or(0.0, |hit| self.off_surface(ray, f64::from(hit.t)));
        if agree && off <= 1.0 {
            Ok(())
        } else {
            Err(format!("{hit:?}, {off} times too far off, {passage:?}, {self:?}, {ray:?}"))
        }
    }
}

/// What a ray meets of one shape.
#[derive(Clone, Debug)]
pub struct Passage {
    /// Where it certainly goes through the surface.
    pub crossings: Vec<f64>,
    /// Whether each of them comes from outside, or from the side that a disc's normal points to.
    pub fronts: Vec<bool>,
    /// Whether it also comes so near to the surface, or starts or ends there, that nobody can tell.
    pub touches: bool,
}
