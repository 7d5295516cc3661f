//! Sets of rays as renderings have them: from the eye, and from what the eye sees towards the lights, mirrored, and in random directions.

use raywood::{Hit, Ray, SurfacePoint, Vec3};
use raywood_render::fresnel::reflect;
use raywood_render::{CameraError, CameraRays, PreparedScene, View, shadow_ray};

use crate::answers::Answer;
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

/// The edge of the blocks that pixels come in.
const BLOCK: u32 = 8;

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
    // A picture of whole blocks with as many pixels as rays are wanted.
    let blocks = most as f32 / (BLOCK * BLOCK) as f32;
    let columns = ((blocks * aspect).sqrt() as u32).max(1);
    let rows = ((blocks / columns as f32) as u32).max(1);
    let camera = CameraRays::new(&view.camera, columns * BLOCK, rows * BLOCK)?;
    let mut primary = Vec::with_capacity((columns * rows * BLOCK * BLOCK) as usize);
    for block in 0..columns * rows {
        let (left, top) = (block % columns * BLOCK, block / columns * BLOCK);
        for pixel in 0..BLOCK * BLOCK {
            let (x, y) = (left + pixel % BLOCK, top + pixel / BLOCK);
            primary.push(camera.ray(x as f32 + 0.5, y as f32 + 0.5));
        }
    }
    primary.truncate(most);

    // What they hit.
    let mut hits = vec![None; primary.len()];
    scene.structure().intersect_batch(&primary, &mut hits);
    let surface = |(ray, hit): (&Ray, &Option<Hit>)| {
        hit.map(|hit| (*ray, facing(ray, scene.structure().surface_point(ray, &hit))))
    };
    let seen: Vec<(Ray, SurfacePoint)> = primary.iter().zip(&hits).filter_map(surface).collect();

    // Each point takes the lights in turn, as if it were the only one that asked.
    let shadow = seen.iter().enumerate().filter_map(|(number, (_, point))| {
        let lights = (0..view.lights.len()).map(|i| &view.lights[(number + i) % view.lights.len()]);
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
