//! Sets of rays as renderings have them: from the eye, and from what the eye sees towards the lights, mirrored, and in random directions.

use raywood::{Hit, Ray, SurfacePoint, Vec3};
use raywood_render::fresnel::reflect;
use raywood_render::{CameraError, CameraRays, PreparedScene, View, shadow_ray};

use crate::answers::Answer;
use crate::flat::structure_of;
use crate::rng::Rng;

/// The kinds of rays, from the most coherent to the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RayKind {
    /// From the eye through the centres of pixels.
    Primary,
    /// From what primary rays hit towards the lights that face it, in turn: any blocker will do.
    Shadow,
    /// Mirrored by what primary rays hit, as if everything were a mirror.
    Reflection,
    /// From what primary rays hit in random directions by Lambert's law.
    Diffuse,
}

impl RayKind {
    /// All kinds.
    pub const ALL: &[Self] = &[Self::Primary, Self::Shadow, Self::Reflection, Self::Diffuse];

    /// Its name, as tables have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Reflection => "reflection",
            Self::Diffuse => "diffuse",
        }
    }

    /// What the rays are, in one line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Primary => "from the eye through the centres of pixels: the closest hit",
            Self::Shadow => "from what the eye sees towards the lights: any hit",
            Self::Reflection => "mirrored by what the eye sees: the closest hit",
            Self::Diffuse => "from what the eye sees in random directions: the closest hit",
        }
    }

    /// Whether any hit answers the ray, rather than the closest.
    pub fn any_hit(self) -> bool {
        self == Self::Shadow
    }
}

/// Rays of one kind. Neighbours start near each other: pixels come in blocks of 8 x 8.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// What rays they are.
    pub kind: RayKind,
    /// The rays.
    pub rays: Vec<Ray>,
}

impl RaySet {
    /// The numbers of so many of the rays, or of all if they are fewer, spread evenly over the set.
    pub fn sample(&self, count: usize) -> Vec<usize> {
        let count = count.min(self.rays.len());
        (0..count).map(|i| i * self.rays.len() / count).collect()
    }

    /// Keeps at most so many whole runs of so many neighbours, spread evenly over the set.
    pub(crate) fn keep_runs(&mut self, most: usize, neighbours: usize) {
        let all = self.rays.len() / neighbours;
        let some = most.min(all);
        let run = |i: usize| &self.rays[i * all / some * neighbours..][..neighbours];
        self.rays = (0..some).flat_map(run).copied().collect();
    }
}

/// A set of rays in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RaySetSummary {
    /// What rays they are.
    pub kind: RayKind,
    /// How many.
    pub rays: usize,
    /// How many of them hit something.
    pub hits: usize,
}

impl RaySetSummary {
    /// Of a set and the answers to its rays.
    pub(crate) fn new(set: &RaySet, answers: &[Answer]) -> Self {
        let hits = answers.iter().filter(|answer| answer.hits()).count();
        Self { kind: set.kind, rays: set.rays.len(), hits }
    }
}

/// One set of each kind for what the view shows, of at most `most` rays each: fewer where the eye sees less than that, and none where it sees
/// nothing. The same rays for the same scene and view, whatever the structure and the number of threads.
///
/// `aspect` is the picture's width over its height.
///
/// # Errors
///
/// Nothing can be seen through the camera.
pub fn ray_sets(
    scene: &PreparedScene<'_>,
    view: &View,
    aspect: f32,
    most: usize,
) -> Result<Vec<RaySet>, CameraError> {
    ray_sets_in(PixelOrder::Rows, scene, view, aspect, most)
}

/// The order of the pixels that rays go through, and so of all rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PixelOrder {
    /// Blocks of 8 x 8 pixels, each row by row.
    Rows,
    /// Blocks of 16 x 16 pixels in Morton order (Morton 1966), so that each 16 rays from a multiple of 16 on are a square of 4 x 4 pixels,
    /// and each 64 from a multiple of 64 on one of 8 x 8.
    Morton,
}

impl PixelOrder {
    /// The edge of its blocks.
    fn block(self) -> u32 {
        match self {
            Self::Rows => 8,
            Self::Morton => 16,
        }
    }

    /// So many points that are seen ask for the same light, before it is the turn of the next: packets of shadow rays go to one light.
    fn points_per_light(self) -> usize {
        match self {
            Self::Rows => 1,
            Self::Morton => 256,
        }
    }

    /// Column and row of a pixel in its block.
    fn place(self, pixel: u32) -> (u32, u32) {
        match self {
            Self::Rows => (pixel % 8, pixel / 8),
            // Even bits count columns, odd bits rows.
            Self::Morton => {
                let every_other = |bits: u32| (0..4).map(|i| (bits >> (2 * i) & 1) << i).sum();
                (every_other(pixel), every_other(pixel >> 1))
            }
        }
    }
}

/// As [`ray_sets`], with the rays in the order that is wanted.
pub(crate) fn ray_sets_in(
    order: PixelOrder,
    scene: &PreparedScene<'_>,
    view: &View,
    aspect: f32,
    most: usize,
) -> Result<Vec<RaySet>, CameraError> {
    // A picture of whole blocks with as many pixels as rays are wanted.
    let edge = order.block();
    let blocks = most as f32 / (edge * edge) as f32;
    let columns = ((blocks * aspect).sqrt() as u32).max(1);
    let rows = ((blocks / columns as f32) as u32).max(1);
    let camera = CameraRays::new(&view.camera, columns * edge, rows * edge)?;
    let mut primary = Vec::with_capacity((columns * rows * edge * edge) as usize);
    for block in 0..columns * rows {
        let (left, top) = (block % columns * edge, block / columns * edge);
        for pixel in 0..edge * edge {
            let (x, y) = order.place(pixel);
            primary.push(camera.ray((left + x) as f32 + 0.5, (top + y) as f32 + 0.5));
        }
    }
    primary.truncate(most);

    // What they hit.
    let mut hits = vec![None; primary.len()];
    structure_of(scene).intersect_batch(&primary, &mut hits);
    let surface = |(ray, hit): (&Ray, &Option<Hit>)| {
        hit.map(|hit| (*ray, facing(ray, structure_of(scene).surface_point(ray, &hit))))
    };
    let seen: Vec<(Ray, SurfacePoint)> = primary.iter().zip(&hits).filter_map(surface).collect();

    // Each point takes the lights in turn, as if it were the only one that asked; or each block of them.
    let shadow = seen.iter().enumerate().filter_map(|(number, (_, point))| {
        let turn = number / order.points_per_light();
        let lights = (0..view.lights.len()).map(|i| &view.lights[(turn + i) % view.lights.len()]);
        lights
            .filter_map(|light| shadow_ray(light, point))
            .find(|ray| ray.direction.dot(point.normal) > 0.0)
    });
    let reflection =
        seen.iter().map(|(ray, point)| point.spawn(reflect(ray.direction, point.normal)));
    let mut rng = Rng::new(1);
    let diffuse = seen.iter().map(|(_, point)| point.spawn(lambertian(point.normal, &mut rng)));
    let (shadow, reflection, diffuse) = (shadow.collect(), reflection.collect(), diffuse.collect());
    let set = |kind, rays| RaySet { kind, rays };
    Ok(vec![
        set(RayKind::Primary, primary),
        set(RayKind::Shadow, shadow),
        set(RayKind::Reflection, reflection),
        set(RayKind::Diffuse, diffuse),
    ])
}

/// The point with its normal on the side that the ray came from.
fn facing(ray: &Ray, point: SurfacePoint) -> SurfacePoint {
    let normal = if ray.direction.dot(point.normal) > 0.0 { -point.normal } else { point.normal };
    SurfacePoint { normal, ..point }
}

/// A direction on the normal's side, as likely as the cosine of the angle between them: the normal and a random direction, added.
fn lambertian(normal: Vec3, rng: &mut Rng) -> Vec3 {
    let direction = (normal + rng.direction()).normalize_or_zero();
    if direction == Vec3::ZERO { normal } else { direction }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_every_pixel_once_and_squares_lie_together() {
        for order in [PixelOrder::Rows, PixelOrder::Morton] {
            let edge = order.block();
            let mut places: Vec<_> = (0..edge * edge).map(|pixel| order.place(pixel)).collect();
            places.sort_unstable();
            let all = (0..edge).flat_map(|x| (0..edge).map(move |y| (x, y)));
            assert!(all.eq(places), "{order:?}");
        }
        for (rays, edge) in [(16, 4), (64, 8)] {
            for first in (0..256).step_by(rays) {
                let (left, top) = PixelOrder::Morton.place(first);
                for pixel in first..first + rays as u32 {
                    let (x, y) = PixelOrder::Morton.place(pixel);
                    assert_eq!((x / edge, y / edge), (left / edge, top / edge));
                }
            }
        }
    }

    #[test]
    fn whole_runs_are_kept() {
        let ray = |i: u16| Ray::new([f32::from(i), 0.0, 0.0], [0.0, 0.0, 1.0]);
        let kept = |count: u16, most: usize, neighbours: usize| {
            let rays = (0..count).map(ray).collect();
            let mut set = RaySet { kind: RayKind::Primary, rays };
            set.keep_runs(most, neighbours);
            set.rays.iter().map(|ray| ray.origin.x as u16).collect::<Vec<_>>()
        };
        assert_eq!(kept(10, 2, 2), [0, 1, 4, 5]);
        assert_eq!(kept(5, 9, 2), [0, 1, 2, 3]);
        assert!(kept(1, 9, 2).is_empty());
    }
}
