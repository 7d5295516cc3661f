//! Brute force in double precision, and what it lets single precision get away with.
//!
//! The oracle tests every triangle and knows, for each crossing, how far the ray passes from the nearest edge and how much of
//! that rounding may hide. An answer is wrong if it names a triangle that the ray clearly misses, or overlooks one that it
//! clearly hits.

use raywood::{Hit, Ray, TriangleMesh, Vec3};

/// How many units in the last place (of the largest distance involved) single precision may be off.
const ULPS: f64 = 16.0;

/// Where a ray crosses the plane of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The triangle.
    pub primitive: u32,
    /// Distance along the ray.
    pub t: f64,
    /// How far `t` may be off.
    pub t_tolerance: f64,
    /// How far inside the triangle the ray passes, seen along the ray: the distance to the nearest edge, negative outside.
    pub inside: f64,
    /// How far that may be off.
    pub inside_tolerance: f64,
}

impl Crossing {
    /// Whether the ray hits beyond doubt, within the interval from `t_min` to `t_max`.
    fn is_certain(&self, ray: &Ray) -> bool {
        self.inside > self.inside_tolerance
            && self.t - self.t_tolerance > f64::from(ray.t_min)
            && self.t + self.t_tolerance < f64::from(ray.t_max)
    }

    /// Whether rounding may see a hit at `t`.
    fn allows(&self, t: f32) -> bool {
        self.inside >= -self.inside_tolerance && (f64::from(t) - self.t).abs() <= self.t_tolerance
    }
}

pub(crate) type Point = [f64; 3];

pub(crate) fn double(v: Vec3) -> Point {
    v.to_array().map(f64::from)
}

pub(crate) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// A triangle that is seen longer than this in relation to its height has no inside that rounding leaves intact.
const SLIVER: f64 = 1e5;

/// The point where a ray comes nearest to a triangle without area: its distance along the ray and from it.
fn nearest_to_edges(corners: [Point; 3], d: Point) -> (f64, f64) {
    let at = |p: Point, s: f64| [p[0] + s * d[0], p[1] + s * d[1], p[2] + s * d[2]];
    let candidates = (0..3).flat_map(|i| {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        // Seen along the ray, the origin's nearest point of the segment.
        let flat = |v: Point| at(v, -dot(v, d) / dot(d, d));
        let (p2, e2) = (flat(p), flat(sub(q, p)));
        let s = if dot(e2, e2) > 0.0 { (-dot(p2, e2) / dot(e2, e2)).clamp(0.0, 1.0) } else { 0.0 };
        let e = sub(q, p);
        let nearest = [p[0] + s * e[0], p[1] + s * e[1], p[2] + s * e[2]];
        [(dot(nearest, d) / dot(d, d), length(flat(nearest)))]
    });
    candidates.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, f64::INFINITY))
}

/// Where the ray crosses a triangle's plane, or where it passes the triangle if that is seen edge-on.
fn crossing(mesh: &TriangleMesh, primitive: u32, ray: &Ray) -> Crossing {
    let (o, d) = (double(ray.origin), double(ray.direction));
    let corners = mesh.corners(primitive).map(|p| sub(double(p), o));
    crossing_from_zero(primitive, corners, d, f64::from(f32::EPSILON))
}

/// The same of a ray from zero, for queries whose numbers have so large units in the last place.
pub(crate) fn crossing_from_zero(
    primitive: u32,
    corners: [Point; 3],
    d: Point,
    epsilon: f64,
) -> Crossing {
    let [a, b, c] = corners;
    let normal = cross(sub(b, a), sub(c, a));
    let (area2, d_length) = (length(normal), length(d));
    let toward = dot(normal, d);
    let edges = [(a, b), (b, c), (c, a)];
    let longest = edges.map(|(p, q)| length(sub(p, q))).into_iter().fold(0.0, f64::max);
    let reach = corners.iter().map(|&p| length(p)).fold(0.0, f64::max);
    let tolerance = ULPS * epsilon * reach;
    if longest * longest * d_length > SLIVER * toward.abs() {
        // Seen from the ray a line: never certainly hit, possibly anywhere along it.
        let (t, distance) = nearest_to_edges(corners, d);
        let t_tolerance = (longest + tolerance) / d_length;
        let inside_tolerance = tolerance + area2 / longest.max(f64::MIN_POSITIVE);
        return Crossing { primitive, t, t_tolerance, inside: -distance, inside_tolerance };
    }
    let t = dot(normal, a) / toward;

    // The signed distance of the ray from each edge's line, by the volume that the edge and the direction span.
    let inside = edges
        .map(|(p, q)| {
            let across = cross(sub(q, p), d);
            dot(p, across) / length(across) * toward.signum()
        })
        .into_iter()
        .fold(f64::INFINITY, f64::min);

    // Rounding moves each vertex by about one unit in the last place of its distance, and `t` by as much, more at grazing
    // angles and in slivers.
    let aspect = longest * longest / area2;
    let cosine = toward.abs() / (area2 * d_length);
    Crossing {
        primitive,
        t,
        t_tolerance: tolerance * aspect.max(1.0) / cosine / d_length,
        inside,
        inside_tolerance: tolerance,
    }
}

/// Checks an answer to a closest-hit query; an error says what is wrong with it.
pub fn check_closest(mesh: &TriangleMesh, ray: &Ray, answer: Option<Hit>) -> Result<(), String> {
    let count = mesh.triangles().len() as u32;
    let valid = ray.is_valid();
    let nearest_certain = (0..count)
        .filter(|_| valid)
        .map(|primitive| crossing(mesh, primitive, ray))
        .filter(|crossing| crossing.is_certain(ray))
        .min_by(|a, b| (a.t + a.t_tolerance).total_cmp(&(b.t + b.t_tolerance)));
    let Some(hit) = answer else {
        return nearest_certain
            .map_or(Ok(()), |missed| Err(format!("missed {missed:?} with {ray:?}")));
    };

    if !valid || hit.primitive >= count {
        return Err(format!("{hit:?} of {count} triangles with {ray:?}"));
    }
    if !(ray.t_min <= hit.t && hit.t < ray.t_max) {
        return Err(format!("{hit:?} outside of the interval of {ray:?}"));
    }
    let own = crossing(mesh, hit.primitive, ray);
    if !own.allows(hit.t) {
        return Err(format!("{hit:?} where the triangle is crossed at {own:?} by {ray:?}"));
    }
    match nearest_certain {
        Some(nearer) if f64::from(hit.t) > nearer.t + nearer.t_tolerance + own.t_tolerance => {
            Err(format!("{hit:?} behind {nearer:?} with {ray:?}"))
        }
        _ => Ok(()),
    }
}

/// Checks an answer to an any-hit query; an error says what is wrong with it.
pub fn check_occluded(mesh: &TriangleMesh, ray: &Ray, answer: bool) -> Result<(), String> {
    let valid = ray.is_valid();
    let mut crossings = (0..mesh.triangles().len() as u32)
        .filter(|_| valid)
        .map(|primitive| crossing(mesh, primitive, ray));
    if answer {
        let possible = crossings.any(|crossing| {
            crossing.inside >= -crossing.inside_tolerance
                && crossing.t + crossing.t_tolerance >= f64::from(ray.t_min)
                && crossing.t - crossing.t_tolerance < f64::from(ray.t_max)
        });
        if possible { Ok(()) } else { Err(format!("blocked by nothing: {ray:?}")) }
    } else {
        match crossings.find(|crossing| crossing.is_certain(ray)) {
            Some(blocker) => Err(format!("not blocked by {blocker:?}: {ray:?}")),
            None => Ok(()),
        }
    }
}

/// Checks an answer to an all-hits query, or with `k` to one for the nearest `k` hits; an error says what is wrong with it.
pub fn check_all(mesh: &TriangleMesh, ray: &Ray, hits: &[Hit], k: usize) -> Result<(), String> {
    let count = mesh.triangles().len() as u32;
    if hits.len() > k || !ray.is_valid() && !hits.is_empty() {
        return Err(format!("{} hits of at most {k} with {ray:?}", hits.len()));
    }
    let is_sorted = |pair: &[Hit]| (pair[0].t, pair[0].primitive) < (pair[1].t, pair[1].primitive);
    if let Some(pair) = hits.windows(2).find(|pair| !is_sorted(pair)) {
        return Err(format!("not in order: {pair:?} with {ray:?}"));
    }
    let mut answered = vec![false; count as usize];
    let mut farthest = f64::NEG_INFINITY;
    for hit in hits {
        if hit.primitive >= count || std::mem::replace(&mut answered[hit.primitive as usize], true)
        {
            return Err(format!("{hit:?} of {count} triangles, or twice, with {ray:?}"));
        }
        if !(ray.t_min <= hit.t && hit.t < ray.t_max) {
            return Err(format!("{hit:?} outside of the interval of {ray:?}"));
        }
        let own = crossing(mesh, hit.primitive, ray);
        if !own.allows(hit.t) {
            return Err(format!("{hit:?} where the triangle is crossed at {own:?} by {ray:?}"));
        }
        farthest = f64::from(hit.t) - own.t_tolerance;
    }

    // What is not there must not be certain, or else not certainly nearer than the farthest.
    let limit = if hits.len() < k { f64::INFINITY } else { farthest };
    let missed = (0..count)
        .filter(|&primitive| ray.is_valid() && !answered[primitive as usize])
        .map(|primitive| crossing(mesh, primitive, ray))
        .find(|crossing| crossing.is_certain(ray) && crossing.t + crossing.t_tolerance < limit);
    missed.map_or(Ok(()), |missed| Err(format!("missed {missed:?} with {ray:?}")))
}
