//! Light that comes straight from lights: which ones the surfaces of a wave ask, and how much they bring if nothing is in the way, in columns.

use std::f32::consts::PI;

use raywood::{Vec3, Vectorized};
use raywood_scene::{Light, LightKind, Rgb, luminance};

use super::dice::{Decision, Dice, Pairs};
use super::picture::Picture;
use super::shadow_rays::{Extent, ShadowRays};
use super::vertices::Vertices;
use crate::bsdf::Answers;
use crate::light_sampling::{AreaLights, Cone, EnvironmentLight, LightSample, SpherePart};
use crate::lights::{Illumination, OverPoints, shine};
use crate::shadows::Aim;
use crate::wave::WAVE;
use crate::wave::columns::{Column, Columns, ZERO, get, set, whole_vectors};
use crate::wave::surfaces::Surfaces;

/// What surfaces ask of one kind of light, and memory for that.
pub(super) struct Asked {
    /// Random numbers: which light, and which part of it.
    choices: Pairs,
    u: Pairs,
    /// Towards the light, in the world and in the frames of the surfaces.
    directions: Columns,
    wis: Columns,
    /// The points on lights with extent, or the parts of the surroundings.
    targets: Columns,
    parts: [SpherePart; WAVE],
    /// How bright it is there.
    light: Columns,
    /// How likely the direction was, by solid angle; zero where there is no light to ask.
    densities: Column,
    /// Of lights without extent: what they bring in all, what the one that is chosen brings, and which it is.
    totals: Column,
    weights: Column,
    numbers: [u32; WAVE],
    answers: Answers,
}

impl Default for Asked {
    fn default() -> Self {
        let (zero, none) = ([0.0; WAVE], [[0.0; WAVE]; 2]);
        Self {
            choices: none,
            u: none,
            directions: ZERO,
            wis: ZERO,
            targets: ZERO,
            parts: [SpherePart::default(); WAVE],
            light: ZERO,
            densities: zero,
            totals: zero,
            weights: zero,
            numbers: [0; WAVE],
            answers: Answers::default(),
        }
    }
}

/// Has each surface of a wave ask one of the lights without extent, a shining surface and the surroundings, and sends shadow rays to what would bring light.
pub(super) struct AskLights<'a> {
    pub(super) picture: &'a Picture<'a>,
    pub(super) surfaces: &'a Surfaces,
    pub(super) vertices: &'a mut Vertices,
    pub(super) dice: &'a Dice,
    pub(super) asked: &'a mut Asked,
    pub(super) shadows: &'a mut ShadowRays,
}

impl Vectorized for AskLights<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let picture = self.picture;
        if !picture.frame.lights.directed.is_empty() {
            self.ask_points();
        }
        if picture.area.is_some() || picture.environment.is_some() {
            self.dice.roll(Decision::Light, self.surfaces.count(), &mut self.asked.choices);
        }
        if let Some(area) = &picture.area {
            self.ask_area(area);
        }
        if let Some(environment) = &picture.environment {
            self.ask_surroundings(environment);
        }
    }
}

impl AskLights<'_> {
    /// Asks one of the lights without extent, chosen by what it brings if nothing is in the way: by a reservoir of one, so that one pass does (Chao 1982).
    #[inline(always)]
    fn ask_points(&mut self) {
        let Self { picture, surfaces, vertices, dice, asked, .. } = self;
        let (surfaces, vertices, lights) = (*surfaces, &**vertices, &picture.frame.lights.directed);
        let count = surfaces.count();
        dice.roll(Decision::Part, count, &mut asked.choices);
        (asked.totals, asked.numbers) = ([0.0; WAVE], [0; WAVE]);
        for (number, light) in lights.iter().enumerate() {
            let (number, radius) = (number as u32, angular_radius(light));
            shine(light, Weigh { surfaces, vertices, asked, number, radius });
        }

        // A white diffuse surface, which scatters by 1 / pi, would send back the intensity.
        for number in 0..whole_vectors(count) {
            let weight = asked.weights[number];
            let is_lit = asked.totals[number] > 0.0;
            let factor = PI * asked.totals[number] / weight;
            let light = factor * get(&asked.light, number);
            set(&mut asked.light, number, light);
            asked.densities[number] = if is_lit { 1.0 } else { 0.0 };
        }
        if lights.iter().any(|light| angular_radius(light) > 0.0) {
            for number in 0..count {
                let light = &lights[asked.numbers[number] as usize];
                let angle = angular_radius(light);
                if asked.densities[number] > 0.0 && angle > 0.0 {
                    let axis = get(&asked.directions, number);
                    let u = dice.pair(number, Decision::Disc);
                    set(&mut asked.directions, number, Cone::of_half_angle(angle).sample(axis, u));
                }
            }
        }
        self.send(Extent::None, |asked, number| {
            let light = &lights[asked.numbers[number] as usize];
            match light.kind {
                LightKind::Directional { .. } => Aim::Direction(get(&asked.directions, number)),
                _ => Aim::at(light),
            }
        });
    }

    /// Asks for a point on a shining surface.
    #[inline(always)]
    fn ask_area(&mut self, area: &AreaLights) {
        let Self { picture, surfaces, vertices, dice, asked, .. } = self;
        let count = surfaces.count();
        dice.roll(Decision::LightPoint, count, &mut asked.u);
        for number in 0..count {
            asked.densities[number] = 0.0;
            if vertices.scatters[number] == 0.0 {
                continue;
            }
            let u = [asked.u[0][number], asked.u[1][number]];
            let point = get(&surfaces.positions, number);
            let choice = asked.choices[0][number];
            let time = surfaces.time(number);
            let sample = area.sample(picture.frame.scene, (point, time), choice, u);
            let Some(LightSample { direction, target, radiance, density }) = sample else {
                continue;
            };
            set(&mut asked.directions, number, direction);
            set(&mut asked.targets, number, target);
            set(&mut asked.light, number, radiance);
            asked.densities[number] = density;
        }
        self.send(Extent::Some, |asked, number| Aim::Point(get(&asked.targets, number)));
    }

    /// Asks for a direction of the surroundings.
    #[inline(always)]
    fn ask_surroundings(&mut self, environment: &EnvironmentLight) {
        let Self { picture, surfaces, dice, asked, .. } = self;
        let (count, scene) = (surfaces.count(), picture.frame.scene);
        dice.roll(Decision::Surroundings, count, &mut asked.u);
        for number in 0..count {
            asked.parts[number] = environment.choose(asked.choices[1][number]);
        }
        for number in 0..whole_vectors(count) {
            let (part, u) = (asked.parts[number], [asked.u[0][number], asked.u[1][number]]);
            let direction = environment.direction(scene.axes(), part, u);
            set(&mut asked.directions, number, direction);
            asked.densities[number] = part.density;
        }
        match scene.environment() {
            Some(_) => {
                for number in 0..count {
                    let light = scene.background(get(&asked.directions, number));
                    set(&mut asked.light, number, light);
                }
            }
            None => {
                let (background, up) = (&scene.scene().background, scene.axes().up);
                for number in 0..whole_vectors(count) {
                    let light = background.color(get(&asked.directions, number).dot(up));
                    set(&mut asked.light, number, light);
                }
            }
        }
        self.send(Extent::Some, |asked, number| Aim::Direction(get(&asked.directions, number)));
    }

    /// Sends shadow rays to the lights that were asked and would bring anything.
    #[inline(always)]
    fn send(&mut self, extent: Extent, aim: impl Fn(&Asked, usize) -> Aim) {
        let Self { picture, surfaces, vertices, asked, shadows, .. } = self;
        let count = surfaces.count();
        for number in 0..whole_vectors(count) {
            let direction = get(&asked.directions, number);
            set(&mut asked.wis, number, vertices.frame(number).to_local(direction));
        }
        vertices.answer(&asked.wis, count, &mut asked.answers);
        for number in 0..whole_vectors(count) {
            let direction = get(&asked.directions, number);
            let geometric_normal = get(&surfaces.geometric_normals, number);
            let share = vertices.bent_share(number, geometric_normal, direction);
            let density = asked.densities[number];
            let light = match extent {
                Extent::None => get(&asked.light, number),
                Extent::Some => {
                    // The last surface of a path may only ask.
                    let goes_on = vertices.goes_on[number] > 0.0;
                    let scattering = if goes_on { asked.answers.densities[number] } else { 0.0 };
                    let weight = picture.strategy.weight_of_light(density, scattering) / density;
                    weight * get(&asked.light, number)
                }
            };
            let answer = get(&asked.answers.light, number);
            let brought = share * (get(&vertices.weights, number) * answer * light);
            let is_asked = (vertices.scatters[number] > 0.0) & (density > 0.0);
            set(&mut asked.light, number, if is_asked { brought } else { Rgb::ZERO });
        }

        // Which bring anything, found without branches.
        let mut lit = [0u8; WAVE];
        let mut lit_count = 0;
        for number in 0..count {
            lit[lit_count] = number as u8;
            lit_count += usize::from(brings(get(&asked.light, number)));
        }
        for &number in &lit[..lit_count] {
            let number = usize::from(number);
            let origin = surfaces.point(number).origin_towards(get(&asked.directions, number));
            let aim = aim(asked, number);
            let light = get(&asked.light, number);
            shadows.push(aim.ray_from(origin), aim, extent, &vertices.walks[number], light);
        }
    }
}

/// Whether light is worth a ray: not black, and a number.
#[inline(always)]
pub(super) fn brings(light: Rgb) -> bool {
    let is_finite = |x: f32| x.abs() < f32::INFINITY;
    let finite = is_finite(light.x) & is_finite(light.y) & is_finite(light.z);
    finite & ((light.x > 0.0) | (light.y > 0.0) | (light.z > 0.0))
}

/// Weighs a light without extent against those before, and chooses it by chance where it brings much.
struct Weigh<'a> {
    surfaces: &'a Surfaces,
    vertices: &'a Vertices,
    asked: &'a mut Asked,
    /// Its number.
    number: u32,
    /// Half the angle that it takes up.
    radius: f32,
}

impl OverPoints for Weigh<'_> {
    #[inline(always)]
    fn run(self, illuminate: impl Fn(Vec3) -> Illumination) {
        let Self { surfaces, vertices, asked, number: light, radius } = self;
        for number in 0..whole_vectors(surfaces.count()) {
            let Illumination { direction, intensity, shines } =
                illuminate(get(&surfaces.positions, number));
            // What is round may still be half above a horizon below which its middle is.
            let facing = direction.dot(get(&surfaces.geometric_normals, number)) + radius;
            let facing = if facing > 0.0 { facing } else { 0.0 };
            // Glass lets light from behind through.
            let facing = if vertices.lets_through[number] > 0.0 { 1.0 } else { facing };
            let weight = facing * luminance(intensity);
            let counts = shines & (weight > 0.0);
            let total = asked.totals[number] + if counts { weight } else { 0.0 };
            let probability = weight / total;
            let choice = asked.choices[1][number];
            let is_chosen = counts & (choice < probability);
            let left = (choice - probability) / (1.0 - probability);
            let next = if is_chosen { choice / probability } else { left };
            asked.choices[1][number] = if counts { next } else { choice };
            asked.totals[number] = total;
            asked.weights[number] = if is_chosen { weight } else { asked.weights[number] };
            asked.numbers[number] = if is_chosen { light } else { asked.numbers[number] };
            let (before, there) = (get(&asked.directions, number), get(&asked.light, number));
            set(&mut asked.directions, number, if is_chosen { direction } else { before });
            set(&mut asked.light, number, if is_chosen { intensity } else { there });
        }
    }
}

/// Half the angle that a light takes up, which paths never meet by themselves: at most a quarter of a circle.
fn angular_radius(light: &Light) -> f32 {
    match light.kind {
        LightKind::Directional { angular_radius, .. } if angular_radius > 0.0 => {
            angular_radius.min(0.5 * PI)
        }
        _ => 0.0,
    }
}
