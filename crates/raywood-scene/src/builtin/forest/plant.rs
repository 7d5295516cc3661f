//! What plants are made of: stems that taper, leaves and blades, with a colour at every vertex.

use std::f32::consts::TAU;

use raywood::Vec3;

use super::super::modelling::{Part, Placement};
use crate::{MaterialId, Rgb};

/// A piece of mesh in the making, each vertex with a normal and a colour.
#[derive(Clone, Debug, Default)]
pub(super) struct Plant {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) colors: Vec<Rgb>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) materials: Vec<MaterialId>,
}

/// A point in the middle of a stem, and how thick it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub(super) position: Vec3,
    pub(super) radius: f32,
}

/// A leaf: where it is attached, along which unit vectors it is long and wide, and how much.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub(super) base: Vec3,
    pub(super) along: Vec3,
    pub(super) across: Vec3,
    pub(super) length: f32,
    pub(super) width: f32,
}

impl Plant {
    fn vertex(&mut self, position: Vec3, normal: Vec3, color: Rgb) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.colors.push(color);
        self.positions.len() as u32 - 1
    }

    fn triangle(&mut self, corners: [u32; 3], material: MaterialId) {
        self.triangles.push(corners);
        self.materials.push(material);
    }

    /// A stem through its joints, of so many sides, its ends open. `color` is asked for points of the surface.
    pub(super) fn stem(
        &mut self,
        joints: &[Joint],
        sides: usize,
        material: MaterialId,
        color: impl Fn(Vec3) -> Rgb,
    ) {
        let direction = |from: usize, to: usize| {
            (joints[to].position - joints[from].position).normalize_or_zero()
        };
        let first = self.positions.len() as u32;
        let mut side = direction(0, 1).orthonormal_basis().0;
        for (number, joint) in joints.iter().enumerate() {
            // Turn the frame no more than the stem bends.
            let along = direction(number.saturating_sub(1), (number + 1).min(joints.len() - 1));
            side = (side - side.dot(along) * along).normalize_or_zero();
            let other = along.cross(side);
            for step in 0..sides {
                let (sin, cos) = (TAU * step as f32 / sides as f32).sin_cos();
                let outwards = cos * side + sin * other;
                let position = joint.position + joint.radius * outwards;
                self.vertex(position, outwards, color(position));
            }
        }
        let sides = sides as u32;
        for ring in 0..joints.len() as u32 - 1 {
            for step in 0..sides {
                let at = |ring: u32, step: u32| first + ring * sides + step % sides;
                let (a, b) = (at(ring, step), at(ring, step + 1));
                let (c, d) = (at(ring + 1, step + 1), at(ring + 1, step));
                self.triangle([a, b, c], material);
                self.triangle([a, c, d], material);
            }
        }
    }

    /// A leaf of two triangles, folded along its middle. It shows its front to where `outwards` points, and is shaded as if it were half of a surface there: crowns look round.
    pub(super) fn leaf(&mut self, leaf: &Leaf, outwards: Vec3, color: Rgb, material: MaterialId) {
        let Leaf { base, along, across, length, width } = *leaf;
        let facing = across.cross(along);
        let across = if facing.dot(outwards) < 0.0 { -across } else { across };
        let normal = across.cross(along).normalize_or_zero();
        let shaded = (normal + 0.8 * outwards).normalize_or_zero();
        let middle = base + 0.45 * length * along + 0.12 * length * normal;
        let tip = self.vertex(base + length * along, shaded, 1.08 * color);
        let right = self.vertex(middle + 0.5 * width * across, shaded, color);
        let left = self.vertex(middle - 0.5 * width * across, shaded, color);
        let base = self.vertex(base, shaded, 0.8 * color);
        self.triangle([base, right, tip], material);
        self.triangle([base, tip, left], material);
    }

    /// A blade of grass: it rises from its foot and bends over, three triangles.
    pub(super) fn blade(
        &mut self,
        foot: Vec3,
        lean: Vec3,
        (height, width): (f32, f32),
        [low, high]: [Rgb; 2],
        material: MaterialId,
    ) {
        let across = (0.5 * width) * lean.cross(Vec3::Y).normalize_or_zero();
        let middle = foot + 0.55 * height * Vec3::Y + 0.25 * height * lean;
        let end = foot + 0.92 * height * Vec3::Y + 0.75 * height * lean;
        let normal = (Vec3::Y - 0.4 * lean).normalize_or_zero();
        let mix = 0.5 * (low + high);
        let a = self.vertex(foot - across, normal, low);
        let b = self.vertex(foot + across, normal, low);
        let c = self.vertex(middle + 0.8 * across, normal, mix);
        let d = self.vertex(middle - 0.8 * across, normal, mix);
        let e = self.vertex(end, normal, high);
        // The side that faces up is the front.
        for [p, q, r] in [[a, b, c], [a, c, d], [d, c, e]] {
            let [x, y, z] = [p, q, r].map(|vertex| self.positions[vertex as usize]);
            let is_front = (y - x).cross(z - x).dot(normal) > 0.0;
            self.triangle(if is_front { [p, q, r] } else { [p, r, q] }, material);
        }
    }

    /// A part where it is placed. `color` is asked for points in their places.
    pub(super) fn part(
        &mut self,
        part: &Part,
        placement: &Placement,
        material: MaterialId,
        color: impl Fn(Vec3) -> Rgb,
    ) {
        let first = self.positions.len() as u32;
        for (&position, &normal) in part.positions.iter().zip(&part.normals) {
            let position = placement.point(position);
            self.vertex(position, placement.direction(normal), color(position));
        }
        for corners in &part.triangles {
            self.triangle(corners.map(|corner| first + corner), material);
        }
    }

    /// All of another one.
    pub(super) fn append(&mut self, mut other: Self) {
        let first = self.positions.len() as u32;
        self.positions.append(&mut other.positions);
        self.normals.append(&mut other.normals);
        self.colors.append(&mut other.colors);
        self.materials.append(&mut other.materials);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|corner| first + corner)));
    }
}
