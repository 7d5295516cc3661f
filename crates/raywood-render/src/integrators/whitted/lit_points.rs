//! The points of a wave that lights may reach, in columns: what one light brings to all of them is computed with vectors.

use raywood::{Vec3, Vectorized};
use raywood_scene::{Light, Rgb};

use crate::lights::{Illumination, OverPoints, shine};
use crate::power::power;
use crate::shading::light_cosine;
use crate::wave::WAVE;
use crate::wave::columns::{Column, Columns, ZERO, get, set};
use crate::wave::surfaces::Surfaces;

/// What a point does with light that reaches it.
pub(super) struct LitPoint {
    /// The pixel of the tile that it is seen in.
    pub(super) pixel: u32,
    /// What light scattered in all directions, and in the highlight, counts in the pixel.
    pub(super) diffuse: Rgb,
    pub(super) specular: Rgb,
    /// The exponent of the highlight, if there is one.
    pub(super) shininess: Option<f32>,
}

/// What the surfaces of one wave do with light that reaches them, number for number.
pub(super) struct LitPoints {
    /// Whether some have a highlight.
    shiny: bool,
    pixels: [u32; WAVE],
    /// One where light does anything at all, else zero.
    answering: Column,
    diffuse: Columns,
    specular: Columns,
    shininess: Column,
}

/// The shadow rays of one light: all go to one point, or in one direction, so that only where they start is written down.
#[derive(Default)]
pub(super) struct ShadowRays {
    pub(super) origins: Vec<Vec3>,
    /// When they look at the scene; none if nothing moves there.
    pub(super) times: Vec<f32>,
    /// The primitives that they start beside.
    pub(super) primitives: Vec<u32>,
    /// To which pixel the light adds how much if nothing is in the way.
    pub(super) light: Vec<(u32, Rgb)>,
}

impl Default for LitPoints {
    fn default() -> Self {
        Self {
            shiny: false,
            pixels: [0; WAVE],
            answering: [0.0; WAVE],
            diffuse: ZERO,
            specular: ZERO,
            shininess: [0.0; WAVE],
        }
    }
}

impl LitPoints {
    /// Forgets all points: light does nothing anywhere.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.shiny = false;
        self.answering = [0.0; WAVE];
    }

    /// Tells what a surface does with light.
    #[inline(always)]
    pub(super) fn set(&mut self, number: usize, point: LitPoint) {
        self.pixels[number] = point.pixel;
        self.answering[number] = 1.0;
        set(&mut self.diffuse, number, point.diffuse);
        self.shiny |= point.shininess.is_some();
        // Without a highlight any exponent will do.
        let specular = if point.shininess.is_some() { point.specular } else { Rgb::ZERO };
        set(&mut self.specular, number, specular);
        self.shininess[number] = point.shininess.unwrap_or(1.0);
    }
}

/// Sends rays from all points to a light that may reach them.
pub(super) struct SendShadowRays<'a> {
    pub(super) light: &'a Light,
    pub(super) surfaces: &'a Surfaces,
    pub(super) points: &'a LitPoints,
    /// Whether anything moves.
    pub(super) moves: bool,
    pub(super) shadows: &'a mut ShadowRays,
}

impl Vectorized for SendShadowRays<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        shine(self.light, self);
    }
}

impl OverPoints for SendShadowRays<'_> {
    #[inline(always)]
    fn run(self, illuminate: impl Fn(Vec3) -> Illumination) {
        let Self { surfaces, points, moves, shadows, .. } = self;
        let count = surfaces.count();

        // What the light brings to each point: Lambert's law.
        let mut cosines = [0.0; WAVE];
        let mut brought = ZERO;
        for (number, cosine_there) in cosines[..count].iter_mut().enumerate() {
            let at_point = illuminate(get(&surfaces.positions, number));
            let normal = get(&surfaces.normals, number);
            let geometric_normal = get(&surfaces.geometric_normals, number);
            let cosine = light_cosine(at_point.direction, normal, geometric_normal);
            *cosine_there = points.answering[number] * if at_point.shines { cosine } else { 0.0 };
            let light = get(&points.diffuse, number) * at_point.intensity;
            set(&mut brought, number, cosine * light);
        }

        // Blinn's highlight (1977) around the direction halfway to the eye.
        if points.shiny {
            for (number, cosine) in cosines[..count].iter().enumerate() {
                let at_point = illuminate(get(&surfaces.positions, number));
                let halfway = at_point.direction - get(&surfaces.directions, number);
                let length = halfway.length();
                let aligned = halfway.dot(get(&surfaces.normals, number)) / length;
                let aligned = if aligned > 0.0 { aligned } else { 0.0 };
                let factor = *cosine * power(aligned, points.shininess[number]);
                let light = get(&points.specular, number) * at_point.intensity;
                let sum = get(&brought, number) + factor * light;
                set(&mut brought, number, sum);
            }
        }

        // Which points see the light, found without branches.
        let mut lit = [0; WAVE];
        let mut lit_count = 0;
        for (number, cosine) in cosines[..count].iter().enumerate() {
            lit[lit_count] = number as u8;
            lit_count += usize::from(*cosine > 0.0);
        }
        let lit = lit[..lit_count].iter().map(|&number| usize::from(number));
        shadows.origins.extend(lit.clone().map(|number| get(&surfaces.origins, number)));
        if moves {
            shadows.times.extend(lit.clone().map(|number| surfaces.time(number)));
        }
        shadows.primitives.extend(lit.clone().map(|number| surfaces.primitive(number)));
        shadows.light.extend(lit.map(|number| (points.pixels[number], get(&brought, number))));
    }
}
