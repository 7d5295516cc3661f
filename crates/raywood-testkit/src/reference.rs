//! What scenes must answer to every query that the library has, instances and options included, found primitive by primitive in double precision.
//!
//! Every primitive says of a ray where it is certainly crossed, and whether it may be hit elsewhere, too, where rounding decides. An answer is wrong if it names what is not there or does not
//! count, leaves out what is certain, or of two equals names the higher number.

use raywood::{Face, Ray, Ray64, Vec3};

use crate::oracle::{Point, cross, crossing_from_zero, dot, double, length, sub};
use crate::placement::Placement;
use crate::solids::Solid;
use crate::{distance, overlap};

/// A primitive by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A triangle by its corners.
    Triangle([Point; 3]),
    /// Anything else.
    Solid(Solid),
}

/// A primitive of a scene, by the numbers that answers call it.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The number of its instance.
    pub instance: u32,
    /// Its own.
    pub primitive: u32,
    /// Its groups, and those of the instances that it stands in.
    pub masks: [u32; 3],
    /// What it is, in the object's space.
    pub shape: Shape,
    /// Where that stands.
    pub placement: Placement,
    /// Whether its geometry tells of closest points, and of what is inside.
    pub tells_points: bool,
    /// The place among all entries of another one that is the same in all but its numbers, which are lower.
    pub twin: Option<usize>,
}

/// A place where a ray goes through a surface beyond doubt.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    t: f64,
    tolerance: f64,
    /// Whether it comes from the side that the normal points to; `None` where that cannot be told.
    front: Option<bool>,
}

/// What a ray meets of a primitive.
#[derive(Clone, Debug, Default)]
struct Meeting {
    crossings: Vec<Crossing>,
    /// Whether there may be other hits, or fewer, where rounding decides.
    doubtful: bool,
}

/// A ray, and what it meets of every entry.
#[derive(Clone, Debug)]
pub struct Met {
    /// The ray.
    pub ray: Ray64,
    /// Whether it is one.
    pub is_valid: bool,
    meetings: Vec<Meeting>,
}

/// A hit as any query tells of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Distance along the ray.
    pub t: f64,
    /// The numbers of what is hit.
    pub instance: u32,
    /// The primitive's own.
    pub primitive: u32,
}

/// The closest point as any query tells of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundPoint {
    /// Where it lies.
    pub point: Point,
    /// How far away that is.
    pub distance: f64,
    /// The numbers of what it lies on.
    pub instance: u32,
    /// The primitive's own.
    pub primitive: u32,
}

/// A region of space.
#[derive(Clone, Debug)]
pub enum Region {
    /// Where `normal . p + offset >= 0` for all planes, which are off by no more than a margin, around a centre.
    Planes(Vec<(Point, f64)>, f64, Point),
    /// All points up to a distance from a centre.
    Ball(Point, f64),
    /// A triangle of sound shape.
    Triangle([Point; 3]),
}

/// Which hits count.
pub struct Rule<'a> {
    /// Of which primitives.
    pub counts: &'a dyn Fn(&Entry) -> bool,
    /// And which side's do not.
    pub culled: Option<Face>,
}

impl Rule<'_> {
    /// Whether a crossing counts for certain, and whether it certainly does not.
    fn judge(&self, front: Option<bool>) -> (bool, bool) {
        match (self.culled, front) {
            (None, _) => (true, false),
            (Some(_), None) => (false, false),
            (Some(culled), Some(front)) => {
                let is_culled = front == (culled == Face::Front);
                (!is_culled, is_culled)
            }
        }
    }
}

/// How many times the rounding of a number distances with solids may be off: in trees they are brought into the boxes of these, in instances scaled.
const ROUNDINGS: f64 = 4.0;

/// A ray in single precision.
fn single(ray: &Ray64) -> Ray {
    let vec = |p: Point| Vec3::from(p.map(|x| x as f32));
    let ray = Ray64 { ..*ray };
    Ray::new(vec(ray.origin), vec(ray.direction)).with_interval(ray.t_min as f32, ray.t_max as f32)
}

impl Entry {
    /// The corners of a triangle where it stands.
    fn corners(&self) -> Option<[Point; 3]> {
        match self.shape {
            Shape::Triangle(corners) => Some(corners.map(|p| self.placement.point(p))),
            Shape::Solid(_) => None,
        }
    }

    /// Whether rays in single precision are the same in the object's space.
    pub fn takes(&self, ray: &Ray64) -> bool {
        let seen = self.placement.ray_back(ray);
        let is_exact = |p: Point| p.iter().all(|&x| f64::from(x as f32) == x);
        is_exact(seen.origin) && is_exact(seen.direction)
    }

    fn meeting(&self, ray: &Ray64, epsilon: f64) -> Meeting {
        let seen = self.placement.ray_back(ray);
        let mut meeting = Meeting::default();
        match self.shape {
            Shape::Triangle(corners) => {
                let from_zero = corners.map(|p| sub(p, seen.origin));
                let crossing =
                    crossing_from_zero(self.primitive, from_zero, seen.direction, epsilon);
                let [a, b, c] = corners;
                let normal = cross(sub(b, a), sub(c, a));
                let rise = dot(normal, seen.direction);
                let is_clear = rise.abs() > 1e-9 * length(normal) * length(seen.direction);
                let front = is_clear.then_some(rise < 0.0);
                let (t, tolerance) = (crossing.t, crossing.t_tolerance);
                if crossing.inside > crossing.inside_tolerance {
                    meeting.add(ray, Crossing { t, tolerance, front });
                } else {
                    meeting.doubtful = crossing.inside >= -crossing.inside_tolerance;
                }
            }
            Shape::Solid(solid) => {
                let seen = single(&seen);
                let passage = solid.march(&seen);
                meeting.doubtful = passage.touches;
                for (t, front) in passage.crossings.into_iter().zip(passage.fronts) {
                    let tolerance = ROUNDINGS * solid.tolerance(&seen, t);
                    meeting.add(ray, Crossing { t, tolerance, front: Some(front) });
                }
            }
        }
        meeting
    }

    /// By how much a hit at `t` may be off; `None` if there can be none.
    fn tolerance_at(&self, ray: &Ray64, t: f64, epsilon: f64) -> Option<f64> {
        let seen = self.placement.ray_back(ray);
        match self.shape {
            Shape::Triangle(corners) => {
                let from_zero = corners.map(|p| sub(p, seen.origin));
                let crossing =
                    crossing_from_zero(self.primitive, from_zero, seen.direction, epsilon);
                let is_hit = crossing.inside >= -crossing.inside_tolerance
                    && (t - crossing.t).abs() <= crossing.t_tolerance;
                is_hit.then_some(crossing.t_tolerance)
            }
            Shape::Solid(solid) => {
                let seen = single(&seen);
                let is_hit = solid.off_surface(&seen, t) <= ROUNDINGS;
                is_hit.then(|| ROUNDINGS * solid.tolerance(&seen, t))
            }
        }
    }

    /// How far a point is; `None` where queries do not see the primitive.
    fn distance(&self, p: Point) -> Option<f64> {
        if !self.tells_points {
            return None;
        }
        match self.shape {
            Shape::Triangle(_) => {
                let corners = self.corners()?;
                Some(distance::of_triangle(corners.map(|corner| sub(corner, p))))
            }
            Shape::Solid(solid) => {
                let scale = self.placement.similarity()?;
                Some(scale * solid.distance(self.placement.point_back(p)).abs())
            }
        }
    }

    /// How often it goes around a point, as the object sees it: there normals point outwards, of mirrored ones too.
    fn winding(&self, p: Point) -> f64 {
        let p = self.placement.point_back(p);
        match self.shape {
            Shape::Triangle(corners) => distance::winding_of_triangle(corners.map(|c| sub(c, p))),
            Shape::Solid(solid) if self.tells_points && solid.is_closed() => {
                f64::from(u8::from(solid.distance(p) < 0.0))
            }
            Shape::Solid(_) => 0.0,
        }
    }

    /// Whether a point is next to its surface as the object sees it, where nobody knows on which side.
    fn is_beside(&self, p: Point) -> bool {
        match self.shape {
            Shape::Triangle(_) => false,
            Shape::Solid(solid) => solid.distance(self.placement.point_back(p)).abs() < 1e-5,
        }
    }

    /// The least and the largest coordinates in the object's space.
    fn bounds(&self) -> [Point; 2] {
        let corners = match self.shape {
            Shape::Triangle(corners) => corners.to_vec(),
            Shape::Solid(solid) => solid.bounds().to_vec(),
        };
        box_around(corners.into_iter())
    }

    /// Whether it must, and whether it may be told to touch a region.
    fn must_and_may(&self, region: &Region, scene: &Reference) -> (bool, bool) {
        let corners = self.corners();
        match region {
            Region::Planes(planes, margin, center) => {
                let inside = |by: f64, polygon: [Point; 3]| {
                    let planes: Vec<_> = planes.iter().map(|&(n, d)| (n, d + by)).collect();
                    overlap::polygon_in_planes(&polygon, &planes)
                };
                if let Some(corners) = corners {
                    return (inside(-margin, corners), inside(*margin, corners));
                }
                // A point of the surface inside, and nothing but a box otherwise.
                let Shape::Solid(solid) = self.shape else { return (false, false) };
                let on = solid.onto_surface(self.placement.point_back(*center));
                let is_on = solid.distance(on).abs() < 1e-6;
                let around = solid.bounds().map(|p| self.placement.point(p));
                let beyond = |&(n, d): &(Point, f64)| {
                    around.iter().all(|&corner| dot(n, corner) + d + 1e-5 < 0.0)
                };
                let slack = margin.max(1e-5);
                let on = self.placement.point(on);
                let must = is_on && planes.iter().all(|&(n, d)| dot(n, on) + d > slack);
                (must, must || !planes.iter().any(beyond))
            }
            &Region::Ball(center, radius) => {
                let Some(distance) = self.distance(center) else { return (false, false) };
                let tolerance = scene.tolerance_of_distance(self, center, distance);
                (distance < radius - tolerance, distance <= radius + tolerance)
            }
            Region::Triangle(region) => {
                if let Some(corners) = corners {
                    // From one of its corners, in a unit in which everything is about one.
                    let unit = 16.0 / scene.size;
                    let near = |p: Point| sub(p, region[0]).map(|x| unit * x);
                    let (region, corners) = (region.map(near), corners.map(near));
                    let around = |across, beside| {
                        let planes = overlap::planes_around_triangle(region, across, beside);
                        overlap::polygon_in_planes(&corners, &planes)
                    };
                    return (around(1e-13, -1e-9), around(1e-9, 1e-9));
                }
                let Shape::Solid(solid) = self.shape else { return (false, false) };
                let seen = region.map(|p| self.placement.point_back(p));
                // Corners on both sides of the surface; and boxes that meet.
                let heights = seen.map(|p| solid.distance(p));
                let has = |is: fn(f64) -> bool| heights.iter().any(|&height| is(height));
                let must = solid.is_closed() && has(|h| h < -1e-4) && has(|h| h > 1e-4);
                let bounds = solid.bounds();
                let (min, max) = (bounds[0], bounds[7]);
                let is_beside = |axis: usize| {
                    seen.iter().all(|p| p[axis] < min[axis] - 1e-5)
                        || seen.iter().all(|p| p[axis] > max[axis] + 1e-5)
                };
                (must, !(0..3).any(is_beside))
            }
        }
    }
}

impl Meeting {
    /// Adds a crossing if it lies in the ray's interval; at the very ends of that nobody knows.
    fn add(&mut self, ray: &Ray64, crossing: Crossing) {
        let Crossing { t, tolerance, .. } = crossing;
        if t - tolerance > ray.t_min && t + tolerance < ray.t_max {
            self.crossings.push(crossing);
        } else if t + tolerance >= ray.t_min && t - tolerance < ray.t_max {
            self.doubtful = true;
        }
    }
}

/// The least and the largest coordinates of some points.
fn box_around(points: impl Iterator<Item = Point>) -> [Point; 2] {
    points.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[min, max], p| {
        [[0, 1, 2].map(|i| min[i].min(p[i])), [0, 1, 2].map(|i| max[i].max(p[i]))]
    })
}

/// All primitives of a scene.
pub struct Reference {
    /// In the order of their numbers.
    pub entries: Vec<Entry>,
    /// The unit in the last place of one in the numbers of queries.
    pub epsilon: f64,
    /// How large everything is.
    pub size: f64,
}

type Checked = Result<(), String>;

impl Reference {
    /// What a ray meets, if it is one.
    pub fn meet(&self, ray: &Ray64, is_valid: bool) -> Met {
        let mut meetings: Vec<Meeting> = Vec::with_capacity(self.entries.len());
        for entry in &self.entries {
            meetings.push(match entry.twin {
                _ if !is_valid => Meeting::default(),
                Some(twin) => meetings[twin].clone(),
                None => entry.meeting(ray, self.epsilon),
            });
        }
        Met { ray: *ray, is_valid, meetings }
    }

    /// What a ray would meet first, of what is certain.
    pub fn first(&self, met: &Met) -> Option<(u32, u32)> {
        let all = self.entries.iter().zip(&met.meetings);
        let all = all.flat_map(|(e, m)| m.crossings.iter().map(move |c| (e, c.t)));
        let first = all.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((first.0.instance, first.0.primitive))
    }

    /// The least and the largest coordinates of a primitive where it stands.
    ///
    /// # Panics
    ///
    /// If there is none of these numbers.
    pub fn box_of(&self, instance: u32, primitive: u32) -> [Point; 2] {
        let entry = &self.entries[self.place(instance, primitive).expect("an entry")];
        let corners = match entry.shape {
            Shape::Triangle(corners) => corners.to_vec(),
            Shape::Solid(solid) => solid.bounds().to_vec(),
        };
        box_around(corners.into_iter().map(|p| entry.placement.point(p)))
    }

    /// How much larger or smaller regions may be taken.
    pub fn margin(&self) -> f64 {
        if self.epsilon > 1e-10 { 1e-9 } else { 1e-12 * self.size }
    }

    fn place(&self, instance: u32, primitive: u32) -> Result<usize, String> {
        let key = |entry: &Entry| (entry.instance, entry.primitive);
        let place = self.entries.binary_search_by_key(&(instance, primitive), key);
        place.map_err(|_| format!("there is no primitive {primitive} of instance {instance}"))
    }

    /// All crossings that certainly count.
    fn certain<'a>(
        &'a self,
        met: &'a Met,
        rule: &'a Rule<'_>,
    ) -> impl Iterator<Item = (&'a Entry, &'a Crossing)> {
        let pairs = self.entries.iter().zip(&met.meetings);
        let counting = pairs.filter(|(entry, _)| (rule.counts)(entry));
        counting
            .flat_map(|(entry, meeting)| meeting.crossings.iter().map(move |c| (entry, c)))
            .filter(|(_, crossing)| rule.judge(crossing.front).0)
    }

    /// Checks one hit by itself, and tells by how much it may be off.
    fn check_hit(&self, met: &Met, hit: &Found, rule: &Rule<'_>) -> Result<f64, String> {
        let place = self.place(hit.instance, hit.primitive)?;
        let (entry, ray) = (&self.entries[place], &met.ray);
        if !(rule.counts)(entry) {
            return Err(format!("{hit:?} does not count"));
        }
        if !(ray.t_min <= hit.t && hit.t < ray.t_max) {
            return Err(format!("{hit:?} outside of the interval"));
        }
        let Some(tolerance) = entry.tolerance_at(ray, hit.t, self.epsilon) else {
            return Err(format!("{hit:?} is not on {entry:?}"));
        };
        let own = met.meetings[place].crossings.iter();
        let mut here = own.filter(|c| (c.t - hit.t).abs() <= c.tolerance).peekable();
        if here.peek().is_some() && here.all(|crossing| rule.judge(crossing.front).1) {
            return Err(format!("{hit:?} is on the side that does not count"));
        }
        Ok(tolerance)
    }

    /// Checks a closest hit. With `ties` of equals the lowest must be named.
    pub fn check_closest(
        &self,
        met: &Met,
        hit: Option<&Found>,
        rule: &Rule<'_>,
        ties: bool,
    ) -> Checked {
        let far = |c: &Crossing| c.t + c.tolerance;
        let nearest = self.certain(met, rule).min_by(|a, b| far(a.1).total_cmp(&far(b.1)));
        let Some(hit) = hit else {
            return match nearest {
                Some(missed) => Err(format!("missed {missed:?}")),
                None => Ok(()),
            };
        };
        let tolerance = self.check_hit(met, hit, rule)?;
        if let Some((entry, crossing)) = nearest
            && hit.t > far(crossing) + tolerance
        {
            return Err(format!("{hit:?} behind {crossing:?} of {entry:?}"));
        }
        let place = self.place(hit.instance, hit.primitive)?;
        match self.entries[place].twin {
            Some(twin) if ties && (rule.counts)(&self.entries[twin]) => {
                Err(format!("{hit:?} where {} is as near", self.entries[twin].primitive))
            }
            _ => Ok(()),
        }
    }

    /// Checks whether there is any hit.
    pub fn check_any(&self, met: &Met, answer: bool, rule: &Rule<'_>) -> Checked {
        let mut certain = self.certain(met, rule);
        if !answer {
            return certain.next().map_or(Ok(()), |missed| Err(format!("missed {missed:?}")));
        }
        let mut pairs = self.entries.iter().zip(&met.meetings);
        let may = pairs.any(|(entry, meeting)| {
            let seen = meeting.crossings.iter().any(|c| !rule.judge(c.front).1);
            (rule.counts)(entry) && (meeting.doubtful || seen)
        });
        if may { Ok(()) } else { Err("blocked by nothing".into()) }
    }

    /// Checks all hits, or the nearest `k`, in order.
    pub fn check_all(&self, met: &Met, hits: &[Found], rule: &Rule<'_>, k: usize) -> Checked {
        let order = |hit: &Found| (hit.t, hit.instance, hit.primitive);
        if let Some(pair) = hits.windows(2).find(|pair| order(&pair[0]) > order(&pair[1])) {
            return Err(format!("not in order: {pair:?}"));
        }
        let farthest = self.check_some(met, hits, rule, k)?;
        if hits.len() < k {
            self.check_complete(met, hits, rule, f64::INFINITY)
        } else {
            self.check_complete(met, hits, rule, farthest)
        }
    }

    /// Checks some of all hits, at most `k`, in any order; all, if there are fewer. Tells from where on there may be others.
    pub fn check_some(
        &self,
        met: &Met,
        hits: &[Found],
        rule: &Rule<'_>,
        k: usize,
    ) -> Result<f64, String> {
        if hits.len() > k {
            return Err(format!("{} hits of at most {k}", hits.len()));
        }
        let mut farthest = f64::NEG_INFINITY;
        for hit in hits {
            farthest = farthest.max(hit.t - self.check_hit(met, hit, rule)?);
        }
        let mut counts = vec![0; self.entries.len()];
        for hit in hits {
            counts[self.place(hit.instance, hit.primitive)?] += 1;
        }
        for (entry, (meeting, count)) in self.entries.iter().zip(met.meetings.iter().zip(counts)) {
            let most = match entry.shape {
                Shape::Triangle(_) => 1,
                Shape::Solid(_) if meeting.doubtful => usize::MAX,
                Shape::Solid(_) => meeting.crossings.len(),
            };
            if count > most {
                return Err(format!("{count} hits of at most {most} with {entry:?}"));
            }
        }
        Ok(farthest)
    }

    /// Checks that nothing certain is left out that is nearer than a limit, and that equals are both there.
    pub fn check_complete(
        &self,
        met: &Met,
        hits: &[Found],
        rule: &Rule<'_>,
        limit: f64,
    ) -> Checked {
        for (entry, crossing) in self.certain(met, rule) {
            let near = |hit: &Found| (hit.t - crossing.t).abs() <= crossing.tolerance;
            let is_own =
                |hit: &Found| (hit.instance, hit.primitive) == (entry.instance, entry.primitive);
            let is_there = hits.iter().any(|hit| is_own(hit) && near(hit));
            if !is_there && crossing.t + crossing.tolerance < limit {
                return Err(format!("missed {crossing:?} of {entry:?}"));
            }
        }
        for hit in hits {
            let Some(twin) = self.entries[self.place(hit.instance, hit.primitive)?].twin else {
                continue;
            };
            let twin = &self.entries[twin];
            let same = Found { t: hit.t, instance: twin.instance, primitive: twin.primitive };
            if (rule.counts)(twin) && !hits.contains(&same) {
                return Err(format!("{hit:?} without {same:?}, which is as near"));
            }
        }
        Ok(())
    }

    /// Checks a number of hits.
    pub fn check_count(&self, met: &Met, count: usize, rule: &Rule<'_>) -> Checked {
        let (mut least, mut most) = (0, 0);
        for (entry, meeting) in self.entries.iter().zip(&met.meetings) {
            if (rule.counts)(entry) {
                let certain = meeting.crossings.len();
                match entry.shape {
                    Shape::Triangle(_) => {
                        least += certain;
                        most += certain.max(usize::from(meeting.doubtful));
                    }
                    Shape::Solid(_) if meeting.doubtful => most = usize::MAX / 2,
                    Shape::Solid(_) => (least, most) = (least + certain, most + certain),
                }
            }
        }
        let is_right = least <= count && count <= most;
        if is_right { Ok(()) } else { Err(format!("{count} hits of {least} to {most}")) }
    }

    /// By how much a distance from a point may be off.
    fn tolerance_of_distance(&self, entry: &Entry, from: Point, distance: f64) -> f64 {
        let largest = from.iter().fold(self.size, |largest, x| largest.max(x.abs()));
        let is_single = self.epsilon > 1e-10;
        let share = match entry.shape {
            // In an object's space, in single precision.
            Shape::Solid(_) => 1e-6,
            Shape::Triangle(_) if is_single => 2f64.powi(-40),
            Shape::Triangle(_) => return 1e-12 * (distance + self.size),
        };
        2.0 * self.epsilon * distance + share * largest
    }

    /// Checks a closest point up to a distance.
    pub fn check_closest_point(
        &self,
        from: Point,
        limit: f64,
        answer: Option<&FoundPoint>,
        counts: &dyn Fn(&Entry) -> bool,
    ) -> Checked {
        let counting = self.entries.iter().filter(|entry| counts(entry));
        let all = counting.filter_map(|entry| Some((entry, entry.distance(from)?)));
        let least = all.min_by(|a, b| a.1.total_cmp(&b.1));
        let Some(found) = answer else {
            return match least {
                Some((entry, distance)) => {
                    let tolerance = self.tolerance_of_distance(entry, from, distance);
                    let is_beyond = distance >= limit - tolerance;
                    if is_beyond { Ok(()) } else { Err(format!("missed {entry:?} at {distance}")) }
                }
                None => Ok(()),
            };
        };
        let Some((nearest, least)) = least else { return Err(format!("{found:?} of nothing")) };
        let entry = &self.entries[self.place(found.instance, found.primitive)?];
        let Some(own) = entry.distance(from) else { return Err(format!("{found:?} of {entry:?}")) };
        let tolerance = self.tolerance_of_distance(entry, from, own)
            + self.tolerance_of_distance(nearest, from, least);
        let is_right = counts(entry)
            && found.distance <= limit
            && (found.distance - own).abs() <= tolerance
            && own - least <= tolerance;
        if !is_right {
            return Err(format!("{found:?} instead of {own}, where {nearest:?} is {least} away"));
        }
        // It lies there.
        let largest = from.iter().fold(self.size, |largest, x| largest.max(x.abs()));
        let rounding = 16.0 * self.epsilon * largest + tolerance;
        let way = (length(sub(found.point, from)) - found.distance).abs();
        let off = entry.distance(found.point).unwrap_or(f64::INFINITY);
        if way > rounding || off > rounding {
            return Err(format!("{found:?}: {way:e} in the wrong place, {off:e} off {entry:?}"));
        }
        match entry.twin {
            Some(twin) if counts(&self.entries[twin]) => {
                Err(format!("{found:?} where {} is as near", self.entries[twin].primitive))
            }
            _ => Ok(()),
        }
    }

    /// Checks what is told to touch a region, in order.
    pub fn check_touching(
        &self,
        region: &Region,
        answer: &[(u32, u32)],
        counts: &dyn Fn(&Entry) -> bool,
    ) -> Checked {
        if let Some(pair) = answer.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(format!("the same twice: {pair:?}"));
        }
        for &(instance, primitive) in answer {
            self.place(instance, primitive)?;
        }
        for entry in &self.entries {
            let told = answer.binary_search(&(entry.instance, entry.primitive)).is_ok();
            let (must, may) = match counts(entry) {
                true => entry.must_and_may(region, self),
                false => (false, false),
            };
            if told && !may || !told && must {
                return Err(format!("told {told}: {region:?} and {entry:?}"));
            }
        }
        Ok(())
    }

    /// Whether a region must, and whether it may be told to touch anything.
    pub fn check_touches(&self, region: &Region, answer: bool) -> Checked {
        let all = self.entries.iter().map(|entry| entry.must_and_may(region, self));
        let (must, may) = all.fold((false, false), |(m, n), (must, may)| (m | must, n | may));
        let is_right = if answer { may } else { !must };
        if is_right { Ok(()) } else { Err(format!("told {answer}: {region:?}")) }
    }

    /// Checks the first contact of a sphere whose centre moves along a ray, as the distance, and what is touched.
    pub fn check_cast(&self, ray: &Ray64, radius: f64, answer: Option<&FoundPoint>) -> Checked {
        let at = |t: f64| [0, 1, 2].map(|i| ray.origin[i] + t * ray.direction[i]);
        let gap = |t: f64| {
            let all = self.entries.iter().filter_map(|entry| entry.distance(at(t)));
            all.fold(f64::INFINITY, f64::min)
        };
        let speed = length(ray.direction);
        let largest = ray.origin.iter().fold(self.size, |largest, x| largest.max(x.abs()));
        let is_single = self.epsilon > 1e-10;
        let reach = if is_single { largest } else { self.size };
        let tolerance = match is_single {
            true => 1e-5 * (radius + reach),
            false => 1e-8 * (radius + reach) + 2f64.powi(-50) * largest,
        };
        let end = answer.map_or(ray.t_max.min(4.0 * reach / speed), |found| found.distance);
        for step in 0..16 {
            let t = ray.t_min + (end - ray.t_min) * f64::from(step) / 16.0;
            if t < end && gap(t) < radius - tolerance {
                return Err(format!("{answer:?}, but something is {} away at {t}", gap(t)));
            }
        }
        let Some(found) = answer else { return Ok(()) };
        let t = found.distance;
        let place = self.place(found.instance, found.primitive)?;
        let entry = &self.entries[place];
        let own = entry.distance(at(t)).unwrap_or(f64::INFINITY);
        let apart = length(sub(at(t), found.point));
        let is_right = ray.t_min <= t
            && t < ray.t_max
            && own <= radius + tolerance
            && (t == ray.t_min || own >= radius - tolerance)
            && (apart - own).abs() <= tolerance;
        if !is_right {
            return Err(format!("{found:?}, {own} away from {entry:?}"));
        }
        match entry.twin {
            Some(twin) => {
                Err(format!("{found:?} where {} is as near", self.entries[twin].primitive))
            }
            None => Ok(()),
        }
    }

    /// Checks a signed distance: its size, and its side where that is clear.
    pub fn check_signed_distance(&self, from: Point, answer: Option<f64>) -> Checked {
        let all = self.entries.iter().filter_map(|entry| Some((entry, entry.distance(from)?)));
        let least = all.min_by(|a, b| a.1.total_cmp(&b.1));
        let (Some(answer), Some((entry, least))) = (answer, least) else {
            let is_right = answer.is_none() && least.is_none();
            return if is_right { Ok(()) } else { Err(format!("{answer:?}, {least:?}")) };
        };
        let tolerance = self.tolerance_of_distance(entry, from, least);
        let inside = if least > tolerance { self.is_inside(from) } else { None };
        let is_side_right = inside.is_none_or(|inside| (answer < 0.0) == inside);
        if (answer.abs() - least).abs() <= tolerance && is_side_right {
            Ok(())
        } else {
            Err(format!("{answer} instead of {least}, inside: {inside:?}"))
        }
    }

    /// Whether any instance has a point inside; `None` where that is not clear.
    fn is_inside(&self, p: Point) -> Option<bool> {
        let mut is_clear = true;
        for instance in self.entries.chunk_by(|a, b| a.instance == b.instance) {
            let winding: f64 = instance.iter().map(|entry| entry.winding(p)).sum();
            let seen = instance[0].placement.point_back(p);
            let is_within = (0..3).all(|i| {
                let bounds = || instance.iter().map(|entry| entry.bounds().map(|p| p[i]));
                let min = bounds().map(|[min, _]| min).fold(f64::INFINITY, f64::min);
                let max = bounds().map(|[_, max]| max).fold(f64::NEG_INFINITY, f64::max);
                min + 1e-5 < seen[i] && seen[i] < max - 1e-5
            });
            // Several open surfaces may go around what is in no instance's box.
            let is_outside = winding < 0.4;
            let is_beside = instance.iter().any(|entry| entry.is_beside(p));
            if winding > 0.6 && is_within && !is_beside {
                return Some(true);
            }
            is_clear &= is_outside && !is_beside;
        }
        is_clear.then_some(false)
    }
}

/// A point in double precision.
pub fn in_double(p: Vec3) -> Point {
    double(p)
}
