//! Trees with leaves: stems that branch again and again (after Weber and Penn, "Creation and Rendering of Realistic Trees", SIGGRAPH 1995).

use raywood::Vec3;

use super::materials::{BARK, LEAVES};
use super::plant::{Joint, Leaf, Plant};
use super::random::Rng;
use crate::Rgb;
use crate::noise::fractal3;

/// How often stems branch: the trunk is of order 0, leaves grow on the last order and the one before.
const ORDERS: usize = 4;

/// The golden angle, in radians: by which each branch is turned against the one below it.
const GOLDEN_ANGLE: f32 = 2.399_963;

/// What makes a kind of tree. Lengths in metres.
pub(super) struct Kind {
    pub(super) height: f32,
    pub(super) trunk_radius: f32,
    /// At which share of the height the lowest branches grow.
    pub(super) crown_from: f32,
    /// The length of the longest branches, as a share of the height.
    pub(super) spread: f32,
    /// How many stems grow from one of each order.
    pub(super) branches: [usize; ORDERS - 1],
    /// The angle between a stem and its branches, in degrees.
    pub(super) angles: [f32; ORDERS - 1],
    /// How much stems of each order turn upwards as they grow, or down.
    pub(super) rise: [f32; ORDERS],
    /// How crooked they are.
    pub(super) wobble: [f32; ORDERS],
    /// How many leaves grow on a twig.
    pub(super) leaves: usize,
    /// Length and width of a leaf.
    pub(super) leaf: [f32; 2],
    /// Between these the colours of leaves lie.
    pub(super) green: [Rgb; 2],
    pub(super) bark: Bark,
}

/// What bark looks like.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Bark {
    /// Smooth and silver-grey, with moss at the foot.
    Beech,
    /// White with dark bands.
    Birch,
}

impl Bark {
    fn color(self, point: Vec3, radius: f32) -> Rgb {
        match self {
            Self::Beech => {
                let grain = fractal3(Vec3::new(6.0 * point.x, 1.5 * point.y, 6.0 * point.z), 3, 5);
                let grey = Rgb::new(0.21, 0.185, 0.155) * (1.0 + 0.5 * grain);
                let moss = ((1.6 - point.y) * 0.5 + 0.6 * grain).clamp(0.0, 0.7);
                (1.0 - moss) * grey + moss * Rgb::new(0.085, 0.11, 0.03)
            }
            Self::Birch => {
                // Bands around the stem, torn at their ends; twigs are brown.
                let torn = fractal3(Vec3::new(3.0 * point.x, 1.2 * point.y, 3.0 * point.z), 2, 9);
                let bands = fractal3(Vec3::new(1.3 * point.x, 3.2 * point.y, 1.3 * point.z), 3, 3);
                let rough = ((0.9 - point.y) * 0.9).clamp(0.0, 0.8);
                let dark = ((bands + 0.3 * torn - 0.16) * 7.0).clamp(0.0, 1.0).max(rough);
                let white = Rgb::new(0.66, 0.63, 0.57) * (1.0 + 0.2 * torn);
                let stem = (1.0 - dark) * white + dark * Rgb::new(0.055, 0.048, 0.042);
                let twig = ((0.035 - radius) / 0.025).clamp(0.0, 1.0);
                (1.0 - twig) * stem + twig * Rgb::new(0.10, 0.065, 0.045)
            }
        }
    }
}

/// A wide tree of old forests.
pub(super) const BEECH: Kind = Kind {
    height: 19.0,
    trunk_radius: 0.36,
    crown_from: 0.2,
    spread: 0.40,
    branches: [26, 9, 6],
    angles: [62.0, 48.0, 45.0],
    rise: [0.005, 0.035, 0.01, -0.03],
    wobble: [0.018, 0.10, 0.16, 0.2],
    leaves: 13,
    leaf: [0.24, 0.15],
    green: [Rgb::new(0.085, 0.190, 0.028), Rgb::new(0.20, 0.33, 0.055)],
    bark: Bark::Beech,
};

/// The same in autumn.
pub(super) const RUSTY_BEECH: Kind =
    Kind { green: [Rgb::new(0.34, 0.12, 0.030), Rgb::new(0.50, 0.27, 0.055)], ..BEECH };

/// A slender tree that stands in the light.
pub(super) const BIRCH: Kind = Kind {
    height: 16.0,
    trunk_radius: 0.17,
    crown_from: 0.3,
    spread: 0.27,
    branches: [30, 7, 5],
    angles: [46.0, 42.0, 38.0],
    rise: [0.004, 0.0, -0.10, -0.22],
    wobble: [0.024, 0.09, 0.12, 0.12],
    leaves: 11,
    leaf: [0.15, 0.11],
    green: [Rgb::new(0.17, 0.26, 0.035), Rgb::new(0.31, 0.37, 0.060)],
    bark: Bark::Birch,
};

/// The same in autumn.
pub(super) const GOLDEN_BIRCH: Kind =
    Kind { green: [Rgb::new(0.52, 0.33, 0.035), Rgb::new(0.72, 0.52, 0.075)], ..BIRCH };

impl Kind {
    /// A tree of this kind, its foot at the origin.
    pub(super) fn grow(&self, seed: u64) -> Plant {
        let mut growth = Growth { kind: self, plant: Plant::default(), rng: Rng::new(seed) };
        let lean = 0.05 * growth.rng.vector();
        let trunk = Stem {
            from: Vec3::new(0.0, -0.3, 0.0),
            direction: (Vec3::Y + lean).normalize_or_zero(),
            length: self.height,
            radius: self.trunk_radius,
            order: 0,
        };
        growth.add(&trunk);
        growth.plant
    }

    /// How long branches are at a share of the crown's height, of the longest: a dome.
    fn crown(&self, height: f32) -> f32 {
        let widest = 0.3;
        let away = if height < widest {
            (widest - height) / widest * 0.65
        } else {
            (height - widest) / (1.0 - widest)
        };
        (1.0 - away * away).max(0.0).sqrt().max(0.12)
    }
}

/// A stem that is to grow.
struct Stem {
    from: Vec3,
    direction: Vec3,
    length: f32,
    radius: f32,
    order: usize,
}

struct Growth<'a> {
    kind: &'a Kind,
    plant: Plant,
    rng: Rng,
}

impl Growth<'_> {
    /// Adds a stem and all that grows on it.
    fn add(&mut self, stem: &Stem) {
        let (kind, order) = (self.kind, stem.order);
        let (pieces, sides) = ([64, 7, 4, 2][order], [14, 6, 4, 3][order]);
        let step = stem.length / pieces as f32;

        // Let it grow piece by piece, crooked and towards the light.
        let (mut position, mut direction) = (stem.from, stem.direction);
        let mut joints = Vec::with_capacity(pieces + 1);
        for piece in 0..=pieces {
            let share = piece as f32 / pieces as f32;
            // The foot of the trunk is wider.
            let flare = if order == 0 { 0.9 * (-14.0 * share).exp() } else { 0.0 };
            let radius = stem.radius * (1.0 + flare - 0.88 * share);
            joints.push(Joint { position, radius });
            let turn = kind.wobble[order] * self.rng.vector() + kind.rise[order] * Vec3::Y;
            direction = (direction + turn).normalize_or_zero();
            position += step * direction;
        }
        let radius = stem.radius;
        self.plant.stem(&joints, sides, BARK, |point| kind.bark.color(point, radius));

        if order + 1 < ORDERS {
            self.add_branches(stem, &joints);
        }
        if order + 2 >= ORDERS {
            let most = if order + 1 == ORDERS { kind.leaves } else { kind.leaves / 3 };
            self.add_leaves(&joints, most);
        }
    }

    /// Where a stem is at a share of its length, its direction and its radius there.
    fn along(joints: &[Joint], share: f32) -> (Vec3, Vec3, f32) {
        let place = share.clamp(0.0, 0.999) * (joints.len() - 1) as f32;
        let (first, part) = (place as usize, place.fract());
        let (a, b) = (joints[first], joints[first + 1]);
        let position = (1.0 - part) * a.position + part * b.position;
        let direction = (b.position - a.position).normalize_or_zero();
        (position, direction, (1.0 - part) * a.radius + part * b.radius)
    }

    fn add_branches(&mut self, stem: &Stem, joints: &[Joint]) {
        let (kind, order) = (self.kind, stem.order);
        let from = if order == 0 { kind.crown_from } else { 0.22 };
        let mut turn = self.rng.angle();
        let count = kind.branches[order];
        for number in 0..count {
            let height = (number as f32 + self.rng.unit()) / count as f32;
            let (position, direction, radius) = Self::along(joints, from + (0.985 - from) * height);
            turn += GOLDEN_ANGLE + self.rng.between(-0.35, 0.35);

            // Away from the stem; high up in the crown more steeply.
            let steeper = if order == 0 { 1.15 - 0.6 * height } else { 1.0 };
            let angle = (kind.angles[order] * steeper + self.rng.between(-9.0, 9.0)).to_radians();
            let (side, other) = direction.orthonormal_basis();
            let away = turn.cos() * side + turn.sin() * other;
            let direction = (angle.cos() * direction + angle.sin() * away).normalize_or_zero();
            let longest = match order {
                0 => kind.spread * kind.height * kind.crown(height),
                _ => stem.length * (0.55 - 0.3 * height),
            };
            let length = longest * self.rng.between(0.75, 1.15);
            let radius = (0.62 * radius).min(0.022 * length + 0.004);
            self.add(&Stem { from: position, direction, length, radius, order: order + 1 });
        }
    }

    fn add_leaves(&mut self, joints: &[Joint], count: usize) {
        let [length, width] = self.kind.leaf;
        for _ in 0..count {
            let share = self.rng.between(0.15, 1.0);
            let (base, direction, _) = Self::along(joints, share);
            let wild = self.rng.vector();
            let along = (0.7 * direction + wild - 0.25 * Vec3::Y).normalize_or_zero();
            let across = (along.cross(Vec3::Y) + 0.7 * self.rng.vector()).cross(along);
            let across = across.normalize_or_zero().cross(along).normalize_or_zero();
            let size = self.rng.between(0.7, 1.15);
            let [dark, light] = self.kind.green;
            let mix = self.rng.unit();
            let color = (1.0 - mix) * dark + mix * light;
            let leaf = Leaf { base, along, across, length: size * length, width: size * width };
            let outwards = self.outwards(base);
            self.plant.leaf(&leaf, outwards, color, LEAVES);
        }
    }

    /// Away from the middle of the crown.
    fn outwards(&self, point: Vec3) -> Vec3 {
        let Kind { height, crown_from, .. } = *self.kind;
        let middle = Vec3::new(0.0, (crown_from + 0.35 * (1.0 - crown_from)) * height, 0.0);
        (point - middle).normalize_or_zero()
    }
}
