//! What one unusual ray does to the packet that it comes with: nothing but that it is traced on its own.

use super::kind::Blocked;
use super::{GROUP, Packet, RAYS};
use crate::simd::{Kernel, Simd, SimdLevel, dispatch_on};
use crate::{BuildOptions, Ray, TriangleMesh, Vec3, WideBvh};

/// Makes a packet of rays. Which of them must be traced otherwise, which groups have rays, and the slopes between which these lie.
struct Gather<'a> {
    rays: &'a [Ray],
    any: bool,
}

impl Kernel for Gather<'_> {
    type Output = (Vec<usize>, u32, [[f32; 2]; 2]);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let mut packet = Packet::empty();
        packet.begin(self.rays.len());
        if self.any {
            packet.gather::<S, &[Ray], true>(simd, &self.rays, &tree());
        } else {
            packet.gather::<S, &[Ray], false>(simd, &self.rays, &tree());
        }
        let mut rest = Vec::new();
        packet.waiting.append_to(&mut rest, 0);
        (rest, packet.groups.live, packet.groups.whole)
    }
}

/// A tree that reaches as far as the rays do.
fn tree() -> WideBvh {
    let corners = vec![[-10.0, -10.0, 5.0], [10.0, -10.0, 5.0], [0.0, 10.0, 5.0]];
    let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]]).expect("a triangle");
    WideBvh::build(&mesh, &BuildOptions::default()).expect("it builds")
}

/// Sixteen times sixteen rays from a point.
fn camera_rays() -> Vec<Ray> {
    let direction = |number: usize| {
        let (x, y) = ((number % GROUP) as f32 / 64.0, (number / GROUP) as f32 / 64.0);
        Vec3::new(x - 0.1, y - 0.1, 1.0)
    };
    (0..RAYS).map(|number| Ray::new([1.0, 2.0, 3.0], direction(number))).collect()
}

/// The same from their other ends to the point.
fn shadow_rays() -> Vec<Ray> {
    camera_rays().iter().map(|ray| Ray::between(ray.at(5.0), ray.origin)).collect()
}

/// And rays in one direction from there.
fn parallel_rays() -> Vec<Ray> {
    let direction = Vec3::new(0.3, -1.0, 0.2);
    camera_rays().iter().map(|ray| Ray::new(ray.at(5.0), direction)).collect()
}

/// And those of a pinhole behind a mirror, from where they leave it.
fn reflected_rays() -> Vec<Ray> {
    let from_mirror = |ray: &Ray| Ray::new(ray.at(5.0 / ray.direction.z), ray.direction);
    camera_rays().iter().map(from_mirror).collect()
}

/// How many rays of a piece no packet takes, however often one is made.
struct GatherAll<'a> {
    rays: &'a [Ray],
    any: bool,
}

impl Kernel for GatherAll<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u32 {
        let (tree, mut packet) = (tree(), Packet::empty());
        packet.begin(self.rays.len());
        while match self.any {
            true => packet.gather::<S, &[Ray], true>(simd, &self.rays, &tree).is_some(),
            false => packet.gather::<S, &[Ray], false>(simd, &self.rays, &tree).is_some(),
        } {}
        packet.waiting.count()
    }
}

#[test]
fn rays_of_several_packets_in_turn_all_find_theirs() {
    let lights = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-3.0, 2.0, 3.0), Vec3::new(1.0, 9.0, -3.0)];
    let to_lights: Vec<_> = camera_rays()
        .iter()
        .enumerate()
        .map(|(number, ray)| Ray::between(ray.at(5.0), lights[number % 3]))
        .collect();
    let parallel = parallel_rays();
    let mut with_sun = to_lights.clone();
    (0..RAYS).step_by(4).for_each(|number| with_sun[number] = parallel[number]);
    let from_eyes: Vec<_> = camera_rays()
        .iter()
        .enumerate()
        .map(|(number, ray)| Ray { origin: ray.origin + Vec3::splat((number / 64) as f32), ..*ray })
        .collect();
    // Three facets of a mirror, with an image each.
    let mut facets = reflected_rays();
    facets[100..].iter_mut().for_each(|ray| ray.origin.x += 0.3);
    facets[180..].iter_mut().for_each(|ray| ray.direction.y += 0.4);
    for (rays, any) in [(to_lights, true), (with_sun, true), (from_eyes, false), (facets, false)] {
        let left = dispatch_on(SimdLevel::active(), GatherAll { rays: &rays, any });
        assert!(left < 32, "{left} rays are left: {:?}", rays[0]);
    }
}

#[test]
fn an_unusual_ray_leaves_the_others_in_their_packet() {
    let levels = SimdLevel::ALL.iter().copied().filter(|level| level.is_available());
    for level in levels {
        for (any, usual) in [
            (false, camera_rays()),
            (true, camera_rays()),
            (true, shadow_rays()),
            (true, parallel_rays()),
            (false, reflected_rays()),
        ] {
            let is_parallel = usual[0].direction == usual[1].direction;
            let gather = |rays: &[Ray]| dispatch_on(level, Gather { rays, any });
            let (rest, live, whole) = gather(&usual);
            assert!(rest.is_empty() && live == 0xffff, "{}: {rest:?}", level.name());

            for (place, ray) in usual.iter().enumerate().step_by(32) {
                let unusual = [
                    Ray { direction: Vec3::ZERO, ..*ray },
                    Ray { direction: Vec3::splat(f32::NAN), ..*ray },
                    Ray { direction: Vec3::new(f32::INFINITY, 0.0, 0.0), ..*ray },
                    Ray { direction: -ray.direction, ..*ray },
                    Ray { direction: Vec3::X, ..*ray },
                    Ray { origin: Vec3::splat(f32::NAN), ..*ray },
                    match is_parallel {
                        true => Ray { direction: 2.0 * ray.direction, ..*ray },
                        false => Ray { origin: ray.origin + Vec3::X, ..*ray },
                    },
                    ray.with_interval(f32::NAN, ray.t_max),
                    ray.with_interval(0.0, f32::NAN),
                    ray.with_interval(0.25, ray.t_max),
                    ray.with_interval(0.0, -1.0),
                ];
                for odd in unusual {
                    let mut rays = usual.clone();
                    rays[place] = odd;
                    let (rest, live, new_whole) = gather(&rays);
                    assert_eq!(rest, [place], "{}: {odd:?}", level.name());
                    assert_eq!(live, 0xffff);
                    for axis in 0..2 {
                        let ([low, high], [least, most]) = (new_whole[axis], whole[axis]);
                        let is_within = match is_parallel {
                            // Where zero is depends on which rays are looked at first.
                            true => high - low <= (most - least) * (1.0 + 1e-6),
                            false => least <= low && high <= most,
                        };
                        assert!(is_within, "{odd:?} makes the packet wider");
                    }
                }
            }
        }
    }
}

/// Makes a packet of rays, has one group take much work, some rays of which have found what they look for, and makes it narrow. Which of its rays stay
/// in the packet, which are traced alone, and how wide it is.
struct Narrow<'a> {
    rays: &'a [Ray],
    group: usize,
    blocked: u32,
}

impl Kernel for Narrow<'_> {
    type Output = (u32, u32, f32);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let mut packet = Packet::empty();
        packet.begin(self.rays.len());
        packet.gather::<S, &[Ray], true>(simd, &self.rays, &tree());
        packet.begin_work();
        packet.work[self.group] = 100.0;
        for lane in (0..GROUP).filter(|lane| self.blocked >> lane & 1 == 1) {
            packet.nearest[self.group][lane] = f32::INFINITY;
        }
        packet.narrow::<S, Blocked>(simd);
        let [low, high] = packet.groups.slopes[0];
        let width = high[self.group] - low[self.group];
        (packet.members[self.group], packet.alone[self.group], width)
    }
}

#[test]
fn groups_of_two_bunches_keep_the_larger() {
    const GROUP_OF_TWO: usize = 5;
    const FAR: u32 = 0b1000_0100_0010_0010;
    let mut bunches = camera_rays();
    let mut spread = bunches.clone();
    for lane in 0..GROUP {
        let number = GROUP_OF_TWO * GROUP + lane;
        bunches[number].direction.x = 1e-3 * lane as f32;
        if FAR >> lane & 1 == 1 {
            bunches[number].direction.x += 2.0;
        }
        spread[number].direction.x = 0.1 * lane as f32;
    }
    for level in SimdLevel::ALL.iter().copied().filter(|level| level.is_available()) {
        let narrow = |rays: &[Ray], blocked| {
            dispatch_on(level, Narrow { rays, group: GROUP_OF_TWO, blocked })
        };
        let (members, alone, width) = narrow(&bunches, 0);
        assert_eq!((members, alone), (0xffff & !FAR, FAR), "{}", level.name());
        assert!(width < 0.02, "{width}");
        // Without rays that are blocked already there is but one bunch.
        let (members, alone, width) = narrow(&bunches, FAR);
        assert_eq!((members, alone), (0xffff, 0), "{}", level.name());
        assert!(width < 0.02, "{width}");
        // Half of what lies evenly is not worth the other half.
        let (members, alone, width) = narrow(&spread, 0);
        assert_eq!((members, alone), (0xffff, 0), "{}", level.name());
        assert!(width > 1.4, "{width}");
    }
}
