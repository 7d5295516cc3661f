//! The sets of rays, from the most coherent to the least, made so that anybody can make them again.

use raywood::{Geometry, Hit, Ray, SurfacePoint, TriangleMesh, Vec3};
use raywood_testkit::Rng;

use crate::pinhole::Pinhole;
use crate::pixel_order::{PictureSize, tiled_pixels};
use crate::reference::Reference;

/// The kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SetKind {
    /// From the eye through the centres of pixels: the closest hit.
    Primary,
    /// From what primary rays hit to the light: any hit.
    Shadow,
    /// Mirrored by what primary rays hit: the closest hit.
    Mirror,
    /// The diffuse rays, a tenth of the scene's diagonal long: any hit.
    AmbientOcclusion,
    /// From what primary rays hit in random directions by Lambert's law: the closest hit.
    Diffuse,
    /// The diffuse rays in random order.
    Shuffled,
}

impl SetKind {
    /// All kinds.
    pub(crate) const ALL: &[Self] = &[
        Self::Primary,
        Self::Shadow,
        Self::Mirror,
        Self::AmbientOcclusion,
        Self::Diffuse,
        Self::Shuffled,
    ];

    /// Its name on the command line and in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Mirror => "mirror",
            Self::AmbientOcclusion => "ao",
            Self::Diffuse => "diffuse",
            Self::Shuffled => "shuffled",
        }
    }

    /// Whether any hit answers the ray, rather than the closest.
    pub(crate) fn any_hit(self) -> bool {
        matches!(self, Self::Shadow | Self::AmbientOcclusion)
    }
}

/// Rays of one kind.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RaySet {
    pub(crate) kind: SetKind,
    pub(crate) rays: Vec<Ray>,
    /// The point that all rays start from, or go to if any hit ends them.
    pub(crate) common: Option<Vec3>,
}

/// How far off the surface secondary rays start, as a share of the scene's diagonal: the same for all, whatever each offers to avoid hitting
/// the surface again.
const OFFSET: f32 = 1e-5;

/// The length of ambient occlusion rays as a share of the scene's diagonal.
const OCCLUSION_LENGTH: f32 = 0.1;

/// Where the random numbers start.
const DIFFUSE_SEED: u64 = 1;
const SHUFFLE_SEED: u64 = 2;

/// From where rays start and whereto shadow rays go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewpoint {
    pub(crate) camera: Pinhole,
    pub(crate) light: Vec3,
    /// The scene's diagonal, by which offsets and lengths of rays go.
    pub(crate) diagonal: f32,
}

/// A set of each of the kinds. Secondary rays come in the order of the primary rays whose hits they start from; they are fewer where the eye
/// sees less than a full picture.
pub(crate) fn ray_sets(
    kinds: &[SetKind],
    reference: &Reference<'_>,
    viewpoint: &Viewpoint,
    size: PictureSize,
) -> Vec<RaySet> {
    let primary: Vec<_> =
        tiled_pixels(size).map(|pixel| viewpoint.camera.ray(pixel, size)).collect();
    let hits = reference.closest(&primary);
    let mesh = reference.mesh();
    let diagonal = viewpoint.diagonal;
    let starts: Vec<Start> = primary
        .iter()
        .zip(&hits)
        .filter_map(|(ray, hit)| Start::new(mesh, OFFSET * diagonal, ray, hit.as_ref()?))
        .collect();

    let make = |&kind: &SetKind| {
        let rays = match kind {
            SetKind::Primary => primary.clone(),
            SetKind::Shadow => starts.iter().map(|s| s.shadow(viewpoint.light)).collect(),
            SetKind::Mirror => starts.iter().map(Start::mirror).collect(),
            SetKind::Diffuse => diffuse(&starts),
            SetKind::AmbientOcclusion => {
                let length = OCCLUSION_LENGTH * diagonal;
                let rays = diffuse(&starts).into_iter();
                rays.map(|ray| ray.with_interval(0.0, length)).collect()
            }
            SetKind::Shuffled => shuffled(diffuse(&starts)),
        };
        let common = match kind {
            SetKind::Primary => Some(viewpoint.camera.eye),
            SetKind::Shadow => Some(viewpoint.light),
            _ => None,
        };
        RaySet { kind, rays, common }
    };
    kinds.iter().map(make).collect()
}

/// Where a primary ray hit something.
struct Start {
    /// Slightly off the surface.
    origin: Vec3,
    /// The geometric normal on the side that the ray came from.
    normal: Vec3,
    /// The ray's direction.
    incoming: Vec3,
}

impl Start {
    /// None where a triangle has no area, thus no normal.
    fn new(mesh: &TriangleMesh, offset: f32, ray: &Ray, hit: &Hit) -> Option<Self> {
        let SurfacePoint { position, normal, .. } = mesh.surface_point(ray, hit);
        if normal == Vec3::ZERO {
            return None;
        }
        let normal = if ray.direction.dot(normal) > 0.0 { -normal } else { normal };
        Some(Self { origin: position + offset * normal, normal, incoming: ray.direction })
    }

    /// To the light; `t` is a distance.
    fn shadow(&self, light: Vec3) -> Ray {
        let way = light - self.origin;
        Ray::new(self.origin, way.normalize_or_zero()).with_interval(0.0, way.length())
    }

    fn mirror(&self) -> Ray {
        let direction = self.incoming - 2.0 * self.incoming.dot(self.normal) * self.normal;
        Ray::new(self.origin, direction.normalize_or_zero())
    }
}

/// Rays in random directions, as likely as the cosine of the angle to the normal: the normal and a point of the unit sphere, added.
fn diffuse(starts: &[Start]) -> Vec<Ray> {
    let mut rng = Rng::new(DIFFUSE_SEED);
    let ray = |start: &Start| {
        let direction = (start.normal + rng.direction()).normalize_or_zero();
        let direction = if direction == Vec3::ZERO { start.normal } else { direction };
        Ray::new(start.origin, direction)
    };
    starts.iter().map(ray).collect()
}

/// The rays in random order (Fisher and Yates).
fn shuffled(mut rays: Vec<Ray>) -> Vec<Ray> {
    let mut rng = Rng::new(SHUFFLE_SEED);
    for last in (1..rays.len()).rev() {
        rays.swap(last, rng.below(last + 1));
    }
    rays
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIAGONAL: f32 = 12.0;

    /// A floor at y = 0 with a wall at x = 1, seen from above.
    fn sets() -> Vec<RaySet> {
        let positions = [
            [-4.0, 0.0, -4.0],
            [4.0, 0.0, -4.0],
            [4.0, 0.0, 4.0],
            [-4.0, 0.0, 4.0],
            [1.0, 0.0, -4.0],
            [1.0, 8.0, -4.0],
            [1.0, 8.0, 4.0],
            [1.0, 0.0, 4.0],
        ];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let mesh = TriangleMesh::new(positions.to_vec(), triangles).expect("a mesh");
        let reference = Reference::build(&mesh).expect("a tree");
        let camera = Pinhole::new(Vec3::new(-1.0, 5.0, 0.5), Vec3::new(-1.5, 0.0, 0.0), 2.0);
        let viewpoint = Viewpoint {
            camera: camera.expect("a camera"),
            light: Vec3::new(3.0, 2.0, 0.0),
            diagonal: DIAGONAL,
        };
        let size = PictureSize { width: 32, height: 32 };
        ray_sets(SetKind::ALL, &reference, &viewpoint, size)
    }

    #[test]
    fn secondary_rays_start_off_what_is_seen() {
        let sets = sets();
        let [primary, shadow, mirror, ao, diffuse, shuffled] = &sets[..] else {
            panic!("a set of each kind")
        };
        assert_eq!(primary.rays.len(), 32 * 32);
        let seen = shadow.rays.len();
        assert!((200..1000).contains(&seen), "{seen} seen");
        for set in [mirror, ao, diffuse, shuffled] {
            assert_eq!(set.rays.len(), seen);
        }
        for ((shadow, ao), diffuse) in shadow.rays.iter().zip(&ao.rays).zip(&diffuse.rays) {
            // Over the floor or before the wall, on the eye's side.
            let o = shadow.origin;
            let (height, distance) = (o.y / (OFFSET * DIAGONAL), (1.0 - o.x) / (OFFSET * DIAGONAL));
            assert!((height - 1.0).abs() < 0.1 || (distance - 1.0).abs() < 0.1, "{o:?}");
            let end = shadow.at(shadow.t_max) - Vec3::new(3.0, 2.0, 0.0);
            assert!(end.length() < 1e-5, "{end:?}");
            assert!((diffuse.direction.length() - 1.0).abs() < 1e-6);
            assert_eq!((ao.origin, ao.direction), (diffuse.origin, diffuse.direction));
            assert_eq!((ao.t_max, diffuse.t_max), (0.1 * DIAGONAL, f32::INFINITY));
        }
    }

    #[test]
    fn mirrored_rays_leave_as_steeply_as_they_came() {
        let sets = sets();
        let (primary, mirror) = (&sets[0].rays, &sets[2].rays);
        let from_floor = mirror.iter().find(|ray| ray.direction.y > 0.0).expect("a floor is seen");
        let same = |ray: &&Ray| {
            let (a, b) = (ray.direction, from_floor.direction);
            (a - Vec3::new(b.x, -b.y, b.z)).length() < 1e-6
        };
        assert!(primary.iter().any(|ray| same(&ray)));
    }

    #[test]
    fn shuffled_rays_are_the_diffuse_rays_in_another_order() {
        let sets = sets();
        let key = |ray: &Ray| [ray.origin, ray.direction].map(|v| v.to_array().map(f32::to_bits));
        let [mut diffuse, mut shuffled] =
            [&sets[4], &sets[5]].map(|set| set.rays.iter().map(key).collect::<Vec<_>>());
        let in_place = diffuse.iter().zip(&shuffled).filter(|(a, b)| a == b).count();
        assert!(in_place < diffuse.len() / 10, "{in_place} of {} stayed", diffuse.len());
        diffuse.sort_unstable();
        shuffled.sort_unstable();
        assert_eq!(diffuse, shuffled);
    }

    #[test]
    fn sets_are_the_same_every_time() {
        assert_eq!(sets(), sets());
    }
}
