//! `forest`: a lake in the hills with a forest of some hundred million triangles around it, which are few: each tree stands there hundreds of times.

mod broadleaf;
mod conifer;
mod jetty;
mod land;
mod materials;
mod plant;
mod random;
mod spacing;
mod undergrowth;

use rayon::prelude::*;
use raywood::{Transform, TriangleMesh, Vec3};

use super::{Builtin, Parameter, Values};
use crate::{Background, Camera, Instance, Instances, Light, LightKind, Mesh, Rgb, Scene};
use broadleaf::{BEECH, BIRCH, GOLDEN_BIRCH, RUSTY_BEECH};
use land::{CLEARING, Land, smooth_step};
use plant::Plant;
use random::Rng;
use spacing::spots;

pub(super) const ENTRY: Builtin = Builtin {
    name: "forest",
    description: "a lake among wooded hills, instances of a few trees: some hundred million triangles",
    parameters: &[
        Parameter {
            name: "n",
            description: "trees at most, those nearest to the lake: the default ones show some 500 million triangles",
            default: 8000,
            min: 0,
            max: 40_000,
        },
        Parameter {
            name: "seed",
            description: "which forest",
            default: 3,
            min: 0,
            max: u32::MAX as u64,
        },
    ],
    build,
};

/// What stands in the forest: the number of an object is its place here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sort {
    Beech,
    RustyBeech,
    Birch,
    GoldenBirch,
    Spruce,
    Fern,
    Grass,
    Flowers,
    Reeds,
    Lilies,
    Stone,
}

/// Of each sort how many differ.
const SORTS: &[(Sort, usize)] = &[
    (Sort::Beech, 3),
    (Sort::RustyBeech, 1),
    (Sort::Birch, 3),
    (Sort::GoldenBirch, 2),
    (Sort::Spruce, 3),
    (Sort::Fern, 3),
    (Sort::Grass, 4),
    (Sort::Flowers, 2),
    (Sort::Reeds, 3),
    (Sort::Lilies, 2),
    (Sort::Stone, 4),
];

impl Sort {
    fn make(self, seed: u64) -> Plant {
        match self {
            Self::Beech => BEECH.grow(seed),
            Self::RustyBeech => RUSTY_BEECH.grow(seed + 7),
            Self::Birch => BIRCH.grow(seed),
            Self::GoldenBirch => GOLDEN_BIRCH.grow(seed + 7),
            Self::Spruce => conifer::spruce(seed, 0.85 + 0.1 * (seed % 3) as f32),
            Self::Fern => undergrowth::fern(seed),
            Self::Grass => undergrowth::grass(seed, 0),
            Self::Flowers => undergrowth::grass(seed, 9),
            Self::Reeds => undergrowth::reeds(seed),
            Self::Lilies => undergrowth::lilies(seed),
            Self::Stone => undergrowth::stone(seed),
        }
    }

    /// One of its objects.
    fn any(self, rng: &mut Rng) -> u32 {
        let before: usize =
            SORTS.iter().take_while(|(sort, _)| *sort != self).map(|(_, count)| count).sum();
        let count = SORTS.iter().find(|(sort, _)| *sort == self).map_or(1, |(_, count)| *count);
        (before + rng.below(count)) as u32
    }
}

fn build(values: &Values) -> Scene {
    let (trees, seed) = (values.get("n") as usize, values.get("seed"));
    let land = Land::new(seed as u32);

    // What stands in the world once, then the objects, each grown by itself.
    let mut all = land.ground();
    all.append(land.water());
    all.append(placed_jetty(&land, seed));
    let seeds: Vec<_> = SORTS
        .iter()
        .flat_map(|&(sort, count)| (0..count as u64).map(move |one| (sort, 10 * seed + one)))
        .collect();
    let objects: Vec<_> = seeds.into_par_iter().map(|(sort, seed)| sort.make(seed)).collect();
    let mut starts = Vec::new();
    for object in objects {
        starts.push(all.triangles.len() as u32);
        all.append(object);
    }

    let mut placed = Planting {
        land: &land,
        jetty: jetty_foot(&land),
        rng: Rng::new(seed ^ 0x5eed),
        placed: Vec::new(),
    };
    placed.trees(trees);
    placed.undergrowth(if trees == 0 { 0.0 } else { 1.0 });
    let end = all.triangles.len() as u32;
    let instances = Instances::new(starts, end, placed.placed)
        .expect("objects stand in order, and instances are turned and scaled");
    let Plant { positions, normals, colors, triangles, materials } = all;
    let triangles =
        TriangleMesh::new(positions, triangles).expect("plants are finite, indices in range");
    Scene {
        mesh: Mesh { triangles, normals, colors, materials, ..Mesh::default() },
        instances,
        materials: materials::materials(),
        lights: lights(),
        cameras: vec![camera(&land)],
        background: Background {
            zenith: Rgb::new(0.11, 0.33, 0.80),
            horizon: Rgb::new(1.0, 0.92, 0.78),
            nadir: Rgb::new(0.10, 0.12, 0.08),
        },
        ..Scene::default()
    }
}

fn camera(land: &Land) -> Camera {
    let (x, z) = (-4.5, 36.0);
    Camera {
        name: "camera".into(),
        eye: Vec3::new(x, land.height(x, z) + 2.5, z),
        target: Vec3::new(0.5, 5.6, -12.0),
        up: Vec3::Y,
        fov_y: 44.0,
    }
}

fn lights() -> Vec<Light> {
    let light = |name: &str, kind, intensity| Light { name: name.into(), kind, intensity };
    let sun = Vec3::new(0.66, -0.60, -0.46).normalize_or_zero();
    vec![
        light("sky", LightKind::Ambient, Rgb::new(0.29, 0.35, 0.45)),
        light("sun", LightKind::directional(sun), Rgb::new(3.6, 2.95, 1.95)),
    ]
}

/// By how much the jetty is turned to the left of the lake's axis, in degrees.
const JETTY_TURN: f32 = 13.0;

/// Where the jetty begins: where the clearing comes down to the water.
fn jetty_foot(land: &Land) -> [f32; 2] {
    let x = 2.2;
    let mut z = CLEARING[1];
    while land.height(x, z) > 0.35 && z > 0.0 {
        z -= 0.1;
    }
    [x, z + 1.2]
}

/// The jetty at the shore before the eye.
fn placed_jetty(land: &Land, seed: u64) -> Plant {
    let mut jetty = jetty::jetty(seed);
    // A little to the left.
    let turn = Transform::rotation(Vec3::Y, JETTY_TURN);
    let [x, z] = jetty_foot(land);
    let to_world = turn.then(&Transform::translation([x, 0.0, z]));
    jetty.positions.iter_mut().for_each(|position| *position = to_world.point(*position));
    jetty.normals.iter_mut().for_each(|normal| *normal = turn.vector(*normal).normalize_or_zero());
    jetty
}

/// Puts plants in their places.
struct Planting<'a> {
    land: &'a Land,
    /// Where the jetty begins.
    jetty: [f32; 2],
    rng: Rng,
    placed: Vec<Instance>,
}

impl Planting<'_> {
    /// Puts a plant on the ground, turned any way, of about its usual size.
    fn put(&mut self, sort: Sort, [x, z]: [f32; 2], size: f32, tint: Rgb) {
        let rng = &mut self.rng;
        let tall = size * rng.between(0.92, 1.08);
        let turn = 360.0 * rng.unit();
        let lean = Transform::rotation(rng.vector(), rng.between(0.0, 3.0));
        let y = match sort {
            Sort::Lilies => 0.0,
            _ => self.land.height(x, z),
        };
        let transform = Transform::scaling([size, tall, size])
            .then(&Transform::rotation(Vec3::Y, turn))
            .then(&if sort == Sort::Lilies { Transform::IDENTITY } else { lean })
            .then(&Transform::translation([x, y, z]));
        let object = sort.any(rng);
        self.placed.push(Instance { tint, ..Instance::new(object, transform) });
    }

    /// Whether a place lies under the jetty or beside it.
    fn is_at_jetty(&self, x: f32, z: f32) -> bool {
        let (sin, cos) = JETTY_TURN.to_radians().sin_cos();
        let [dx, dz] = [x - self.jetty[0], z - self.jetty[1]];
        let (across, along) = (cos * dx - sin * dz, -sin * dx - cos * dz);
        across.abs() < 1.5 && (-1.0..11.0).contains(&along)
    }

    /// Plants trees: birches in the light, beeches in the valley, spruces on the heights.
    fn trees(&mut self, most: usize) {
        let land = self.land;
        let room = |x: f32, z: f32, rng: &mut Rng| {
            let shore = land.shore(x, z);
            let in_sight = smooth_step(9.0, 5.0, (x + 1.5).abs() - 0.28 * (36.0 - z).max(0.0));
            let before = z > 12.0 && z < 46.0 && in_sight > 0.0;
            if shore < 1.13 || land.clearing(x, z) > 0.05 || before {
                return None;
            }
            // Glades.
            if land.noise(x, z, 42.0, 2, 20) > 0.42 && shore > 1.6 {
                return None;
            }
            Some(rng.between(3.6, 6.2))
        };
        // As far as the ground is seen from the lake.
        let reach = (5.2 * (most as f32 + 60.0).sqrt()).clamp(90.0, 560.0);
        let spots = spots([0.0, -60.0 * (reach / 560.0)], reach, 6.2, &mut self.rng, room);
        // Two that frame the view.
        if most > 2 {
            self.put(Sort::Birch, [-9.4, 23.6], 0.92, Rgb::splat(1.05));
            self.put(Sort::GoldenBirch, [-11.6, 22.2], 0.75, Rgb::ONE);
        }
        for spot in spots.into_iter().take(most.saturating_sub(2)) {
            let (x, z) = (spot.x, spot.z);
            let height = land.height(x, z);
            let shore = land.shore(x, z);
            let wood = land.noise(x, z, 70.0, 2, 21);
            let choice = self.rng.unit();
            let spruces = smooth_step(4.0, 40.0, height + 28.0 * wood);
            let birches = 0.75 * smooth_step(1.75, 1.2, shore) + 0.10;
            let sort = if choice < birches {
                Sort::Birch
            } else if choice < birches + (1.0 - birches) * (0.12 + 0.8 * spruces) {
                Sort::Spruce
            } else {
                Sort::Beech
            };
            let size = self.rng.between(0.68, 1.18) * (0.7 + 0.06 * spot.room);
            let tint = self.tree_tint(x, z);
            let sort = self.in_autumn(sort, x, z);
            self.put(sort, [x, z], size, tint);
        }
    }

    /// Some trees turn early, here more of them and there fewer.
    fn in_autumn(&mut self, sort: Sort, x: f32, z: f32) -> Sort {
        let turned = self.rng.unit() + 0.45 * self.land.noise(x, z, 45.0, 2, 22);
        match sort {
            Sort::Birch if turned > 0.62 => Sort::GoldenBirch,
            Sort::Beech if turned > 0.88 => Sort::RustyBeech,
            other => other,
        }
    }

    /// No two trees are of the same colour, and what is far away is bluish.
    fn tree_tint(&mut self, x: f32, z: f32) -> Rgb {
        let rng = &mut self.rng;
        let warm = rng.between(-0.10, 0.10);
        let shade = rng.between(0.8, 1.2) * Rgb::new(1.0 + warm, 1.0, 1.0 - warm);
        let away = smooth_step(60.0, 480.0, (x * x + (z - 36.0) * (z - 36.0)).sqrt());
        shade * Rgb::new(1.0 + 0.25 * away, 1.0 + 0.35 * away, 1.0 + 2.6 * away)
    }

    /// Plants what is small, where it can be seen: around the clearing and along the shore.
    fn undergrowth(&mut self, density: f32) {
        if density == 0.0 {
            return;
        }
        let land = self.land;
        let near = spots(CLEARING, 26.0, 0.75, &mut self.rng, |x, z, rng| {
            let open = land.shore(x, z) > 1.015;
            open.then(|| rng.between(0.42, 0.75))
        });
        let far = spots([0.0, 0.0], 78.0, 2.2, &mut self.rng, |x, z, rng| {
            let shore = land.shore(x, z);
            (shore > 1.02 && shore < 2.6).then(|| rng.between(1.2, 2.2))
        });
        for spot in near.into_iter().chain(far) {
            let (x, z) = (spot.x, spot.z);
            if self.is_at_jetty(x, z) {
                continue;
            }
            let light = land.clearing(x, z).max(smooth_step(1.5, 1.15, land.shore(x, z)));
            let patch = land.noise(x, z, 6.0, 2, 23);
            let choice = self.rng.unit();
            let sort = if choice < 0.012 {
                Sort::Stone
            } else if self.rng.unit() > light + 0.3 * patch {
                Sort::Fern
            } else if patch > 0.18 && choice < 0.5 {
                Sort::Flowers
            } else {
                Sort::Grass
            };
            let size = match sort {
                Sort::Stone => 0.25 + 1.3 * self.rng.unit() * self.rng.unit(),
                Sort::Fern => self.rng.between(0.7, 1.35),
                _ => self.rng.between(0.75, 1.3) * spot.room.max(0.7),
            };
            let shade = self.rng.between(0.8, 1.2);
            let dry = 0.35 * smooth_step(0.0, 0.5, land.noise(x, z, 12.0, 2, 24));
            let tint = shade * Rgb::new(1.0 + dry, 1.0 + 0.5 * dry, 1.0);
            self.put(sort, [x, z], size, tint);
        }

        // Along the water's edge, and on the water.
        let wet = spots([0.0, 0.0], 70.0, 1.6, &mut self.rng, |x, z, rng| {
            let shore = land.shore(x, z);
            (shore > 0.8 && shore < 1.04).then(|| rng.between(0.7, 1.6))
        });
        for spot in wet {
            let (x, z) = (spot.x, spot.z);
            let shore = land.shore(x, z);
            let bed = land.noise(x, z, 13.0, 2, 25);
            if self.is_at_jetty(x, z) {
                continue;
            }
            let before_eye = z > 8.0 && (-13.0..7.0).contains(&x);
            if shore > 0.93 && bed > 0.05 && !before_eye {
                let size = self.rng.between(0.8, 1.2);
                self.put(Sort::Reeds, [x, z], size, Rgb::ONE);
            } else if shore < 0.95 && bed < -0.16 && z > -20.0 {
                self.put(Sort::Lilies, [x, z], 1.0, Rgb::ONE);
            } else if shore > 0.97 && self.rng.unit() < 0.14 {
                let size = 0.3 + 1.1 * self.rng.unit() * self.rng.unit();
                self.put(Sort::Stone, [x, z], size, Rgb::splat(0.9));
            }
        }
    }
}
