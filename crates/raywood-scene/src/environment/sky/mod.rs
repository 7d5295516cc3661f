//! A clear sky by day or dusk, by formula: sunlight that air scatters, once along the way that is seen (Nishita et al., "Display of the Earth Taking into Account Atmospheric
//! Scattering", 1993), and before that any number of times (Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", 2020).

mod atmosphere;
mod name;

use std::f32::consts::{PI, TAU};
use std::ops::RangeInclusive;

use rayon::prelude::*;
use raywood::Vec3;

use self::atmosphere::{
    Aimed, Atmosphere, GROUND_ALBEDO, TOP, haze_phase, left, molecules_phase, steps,
};
pub use self::name::SkyError;
use super::Environment;
use crate::{Axes, Light, LightKind, Rgb};

/// Where the sun is, and how hazy the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// How high the sun stands, in degrees: 90 in the zenith, less than 0 below the horizon.
    pub elevation: f32,
    /// In which direction, in degrees clockwise as seen from above: 0 ahead of a camera that looks against [`Axes::along`], 90 on its right.
    pub azimuth: f32,
    /// How much more light is taken on its way down from the zenith than clean air takes: 1 is clean, 2 to 3 a fine day, 6 haze.
    pub turbidity: f32,
}

impl Default for Sky {
    /// A fine day, the sun behind the right shoulder.
    fn default() -> Self {
        Self { elevation: 35.0, azimuth: 130.0, turbidity: 2.2 }
    }
}

/// What the sun brings above the air: then in clear noon a white surface that faces it is about as bright as white.
const SUNLIGHT: f32 = 1.5 * PI;

/// Half the angle that the sun takes up, in radians.
const SUN_RADIUS: f32 = 0.004_65;

/// Columns and rows of the panorama. The sun itself is not in it.
const WIDTH: u32 = 1024;
const HEIGHT: u32 = 512;

/// How high the eye is, in kilometres.
const EYE: f32 = 0.01;

impl Sky {
    /// From dusk, when the last light goes, to the zenith.
    pub const ELEVATIONS: RangeInclusive<f32> = -12.0..=90.0;
    /// Once around, either way.
    pub const AZIMUTHS: RangeInclusive<f32> = -360.0..=360.0;
    /// From clean air to fog.
    pub const TURBIDITIES: RangeInclusive<f32> = 1.0..=10.0;

    /// The sky around a scene and the ground below the horizon, without the sun, whose light [`sun`](Self::sun) tells. Takes two seconds of one thread, which all share.
    ///
    /// `None` if a number is out of its range: [`ELEVATIONS`](Self::ELEVATIONS), [`AZIMUTHS`](Self::AZIMUTHS), [`TURBIDITIES`](Self::TURBIDITIES).
    pub fn panorama(&self) -> Option<Environment> {
        self.is_sound().then(|| self.render()).flatten()
    }

    /// The light of the sun, in a scene with these axes; black where it is below the horizon.
    pub fn sun(&self, axes: &Axes) -> Light {
        let towards = self.to_sun();
        let left = Atmosphere::new(self.turbidity).left_of_sun(Aimed::above_ground(EYE, towards.z));
        Light {
            name: "sun".to_owned(),
            kind: LightKind::Directional {
                direction: -axes.to_world(towards),
                angular_radius: SUN_RADIUS,
            },
            intensity: (SUNLIGHT / PI) * left,
        }
    }

    /// All its light in a scene with these axes, `panorama` around it: the [sun](Self::sun) and, for methods that do not ask the surroundings, ambient light as bright as these are in the
    /// mean.
    pub fn lights(&self, panorama: &Environment, axes: &Axes) -> [Light; 2] {
        let from_all_sides = Light {
            name: "sky".to_owned(),
            kind: LightKind::Ambient,
            intensity: panorama.mean_light(),
        };
        [self.sun(axes), from_all_sides]
    }

    fn is_sound(&self) -> bool {
        Self::ELEVATIONS.contains(&self.elevation)
            && Self::AZIMUTHS.contains(&self.azimuth)
            && Self::TURBIDITIES.contains(&self.turbidity)
    }

    /// The direction to the sun: across, along and up.
    fn to_sun(self) -> Vec3 {
        let (sin, cos) = self.elevation.to_radians().sin_cos();
        let (across, ahead) = self.azimuth.to_radians().sin_cos();
        Vec3::new(cos * across, -cos * ahead, sin)
    }

    fn render(&self) -> Option<Environment> {
        let air = ScatteringAir::new(Atmosphere::new(self.turbidity));
        let sun = self.to_sun();
        let row = |row: u32| {
            let down = PI * (row as f32 + 0.5) / HEIGHT as f32;
            let (radius, rise) = down.sin_cos();
            (0..WIDTH).map(move |column| {
                let turn = TAU * ((column as f32 + 0.5) / WIDTH as f32 - 0.5);
                let (sin, cos) = turn.sin_cos();
                Vec3::new(radius * sin, -radius * cos, rise)
            })
        };
        let rows: Vec<Vec<Rgb>> = (0..HEIGHT)
            .into_par_iter()
            .map(|r| row(r).map(|direction| SUNLIGHT * air.seen(direction, sun)).collect())
            .collect();
        Environment::new(WIDTH, HEIGHT, rows.concat())
    }
}

/// Heights and cosines of the sun in tables.
const HEIGHTS: usize = 48;
const RISES: usize = 96;

/// A table over heights, closer near the ground, and over how the sun rises, closer near the horizon.
struct Table(Vec<Rgb>);

impl Table {
    fn new(of: impl Fn(Aimed) -> Rgb + Sync) -> Self {
        let entry = |number: usize| {
            let share = (number / RISES) as f32 / (HEIGHTS - 1) as f32;
            let root = 2.0 * (number % RISES) as f32 / (RISES - 1) as f32 - 1.0;
            let height = share * share * (TOP - Aimed::above_ground(0.0, 0.0).radius);
            of(Aimed::above_ground(height, root * root.abs()))
        };
        Self((0..HEIGHTS * RISES).into_par_iter().map(entry).collect())
    }

    fn at(&self, place: Aimed) -> Rgb {
        let root = place.rise.clamp(-1.0, 1.0);
        let root = root.signum() * root.abs().sqrt();
        let cell = |share: f32, count: usize| {
            let place = share.clamp(0.0, 1.0) * (count - 1) as f32;
            let below = (place as usize).min(count - 2);
            (below, place - below as f32)
        };
        let (row, row_share) = cell(place.height_share().sqrt(), HEIGHTS);
        let (column, share) = cell(0.5 * (root + 1.0), RISES);
        let line = |row: usize| {
            let entries = &self.0[row * RISES + column..];
            (1.0 - share) * entries[0] + share * entries[1]
        };
        (1.0 - row_share) * line(row) + row_share * line(row + 1)
    }
}

/// Air of which it is known how the sun lights it.
struct ScatteringAir {
    atmosphere: Atmosphere,
    /// What is left of the sun's light.
    sunlight: Table,
    /// Light that was scattered more than once, from all sides alike, per what air scatters.
    many_times: Table,
}

impl ScatteringAir {
    fn new(atmosphere: Atmosphere) -> Self {
        let sunlight = Table::new(|place| atmosphere.left_of_sun(place));
        let many_times = Table::new(|place| many_times(&atmosphere, &sunlight, place));
        Self { atmosphere, sunlight, many_times }
    }

    /// The light that is seen near the ground in a direction, of a sun that brings one.
    fn seen(&self, direction: Vec3, sun: Vec3) -> Rgb {
        const STEPS: usize = 40;
        let eye = Aimed::above_ground(EYE, direction.z);
        let ground = eye.meets_ground();
        let end = ground.or_else(|| eye.to_sphere(TOP)).unwrap_or(0.0);
        let cosine = direction.dot(sun);
        let (by_molecules, by_haze) = (molecules_phase(cosine), haze_phase(cosine));
        let follow = Follow { atmosphere: &self.atmosphere, eye, sun_rise: sun.z, cosine };
        let (mut seen, through) = follow.gather(end, STEPS, |air, place| {
            let once = by_molecules * air.molecules + by_haze * air.haze;
            self.sunlight.at(place) * once + self.many_times.at(place) * air.scattered()
        });
        if ground.is_some() {
            let place = follow.sun_from(end);
            let from_sky = PI * self.many_times.at(place);
            let lit = place.rise.max(0.0) * self.sunlight.at(place) + from_sky;
            seen += through * (GROUND_ALBEDO / PI * lit);
        }
        seen
    }
}

/// A way through the air, and where the sun is.
struct Follow<'a> {
    atmosphere: &'a Atmosphere,
    eye: Aimed,
    sun_rise: f32,
    /// Of the angle between the way and the sun.
    cosine: f32,
}

impl Follow<'_> {
    /// The place after a way, and how the sun rises there.
    fn sun_from(&self, along: f32) -> Aimed {
        let radius = self.eye.at(along).radius;
        let rise = (self.eye.radius * self.sun_rise + along * self.cosine) / radius;
        Aimed { radius, rise }
    }

    /// Adds up the light that air sends back along the way, and tells what is left of light from its end.
    fn gather(
        &self,
        end: f32,
        count: usize,
        sent: impl Fn(&atmosphere::Air, Aimed) -> Rgb,
    ) -> (Rgb, Rgb) {
        let (mut sum, mut through) = (Rgb::ZERO, Rgb::ONE);
        for (along, length) in steps(end, count) {
            let place = self.sun_from(along);
            let air = self.atmosphere.air(place.radius);
            let after = left(length * air.taken);
            // All of a step alike, taken on the way through it.
            let (taken, share) = (air.taken.to_array(), (Rgb::ONE - after).to_array());
            let seen = Rgb::from([0, 1, 2].map(|i| share[i] / taken[i].max(1e-12)));
            sum += through * (seen * sent(&air, place));
            through = through * after;
        }
        (sum, through)
    }
}

/// Light from all sides that was scattered at least twice, at a place and for a sun (Hillaire 2020, section 5.5): what comes after one scattering, times the geometric series of what goes on being scattered.
fn many_times(atmosphere: &Atmosphere, sunlight: &Table, place: Aimed) -> Rgb {
    const DIRECTIONS: usize = 8;
    const STEPS: usize = 20;
    let place = Aimed { radius: place.radius.max(Aimed::above_ground(EYE, 0.0).radius), ..place };
    let flat = (1.0 - place.rise * place.rise).max(0.0).sqrt();
    let (mut twice, mut again) = (Rgb::ZERO, Rgb::ZERO);
    for number in 0..DIRECTIONS * DIRECTIONS {
        let share = |i: usize| (i as f32 + 0.5) / DIRECTIONS as f32;
        let rise = 1.0 - 2.0 * share(number / DIRECTIONS);
        let turn = TAU * share(number % DIRECTIONS);
        let cosine = rise * place.rise + (1.0 - rise * rise).sqrt() * flat * turn.cos();
        let eye = Aimed { radius: place.radius, rise };
        let ground = eye.meets_ground();
        let end = ground.or_else(|| eye.to_sphere(TOP)).unwrap_or(0.0);
        let follow = Follow { atmosphere, eye, sun_rise: place.rise, cosine };
        let even = 1.0 / (4.0 * PI);
        let (once, through) =
            follow.gather(end, STEPS, |air, place| even * (sunlight.at(place) * air.scattered()));
        twice += once;
        if ground.is_some() {
            let there = follow.sun_from(end);
            let lit = there.rise.max(0.0) * sunlight.at(there);
            twice += through * (GROUND_ALBEDO / PI * lit);
        }
        again += follow.gather(end, STEPS, |air, _| air.scattered()).0;
    }
    let count = (DIRECTIONS * DIRECTIONS) as f32;
    let series = |twice: f32, again: f32| twice / count / (1.0 - (again / count).min(0.99));
    let (twice, again) = (twice.to_array(), again.to_array());
    Rgb::from([0, 1, 2].map(|i| series(twice[i], again[i])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(sky: Sky, turn: f32, rise: f32) -> Rgb {
        let down = rise.acos() / PI;
        sky.panorama().expect("it is sound").light(turn, down)
    }

    /// By day it is blue above, whiter at the horizon, brightest about the sun; all is positive.
    #[test]
    fn the_sky_is_blue() {
        let sky = Sky { elevation: 40.0, azimuth: 0.0, turbidity: 2.5 };
        let (zenith, horizon) = (light(sky, 0.0, 0.999), light(sky, 0.0, 0.05));
        assert!(zenith.z > 1.5 * zenith.x && zenith.y > zenith.x, "{zenith:?}");
        assert!(horizon.x / horizon.z > 1.2 * zenith.x / zenith.z, "{horizon:?}");
        let sun = light(sky, 0.5, 40f32.to_radians().sin());
        assert!(sun.y > 3.0 * zenith.y, "{sun:?}");
        let all = sky.panorama().expect("it is sound");
        assert!(all.texels.iter().all(|texel| texel.x.min(texel.y).min(texel.z) > 0.0));
    }

    /// A low sun is red, its sky too; below the horizon it brings nothing, but the sky is not black.
    #[test]
    fn sunsets_are_red() {
        let axes = Axes::new(Vec3::Y);
        let at = |elevation: f32| Sky { elevation, azimuth: 0.0, turbidity: 2.5 };
        let (noon, evening) = (at(80.0).sun(&axes).intensity, at(2.0).sun(&axes).intensity);
        assert!(noon.z > 0.6 * noon.x && evening.x > 4.0 * evening.z, "{noon:?} {evening:?}");
        let glow = light(at(1.0), 0.5, 0.05);
        assert!(glow.x > 1.5 * glow.z, "{glow:?}");
        assert_eq!(at(-3.0).sun(&axes).intensity, Rgb::ZERO);
        let dusk = light(at(-3.0), 0.5, 0.1);
        assert!(dusk.y > 1e-4 && dusk.y < 0.2 * glow.y, "{dusk:?}");
    }

    /// Sky and panorama agree on where the sun is.
    #[test]
    fn the_sky_is_brightest_where_the_sun_is() {
        let sky = Sky { elevation: 30.0, azimuth: 100.0, turbidity: 3.0 };
        let panorama = sky.panorama().expect("it is sound");
        let brightest = (0..panorama.texels.len())
            .max_by(|&a, &b| panorama.texels[a].y.total_cmp(&panorama.texels[b].y))
            .expect("texels");
        let (row, column) = (brightest as u32 / WIDTH, brightest as u32 % WIDTH);
        let turn = (column as f32 + 0.5) / WIDTH as f32;
        assert!((turn - (0.5 + 100.0 / 360.0)).abs() < 0.005, "{turn}");
        let height = 90.0 - 180.0 * (row as f32 + 0.5) / HEIGHT as f32;
        assert!((height - 30.0).abs() < 3.0, "{height}");
        let LightKind::Directional { direction, .. } = sky.sun(&Axes::new(Vec3::Y)).kind else {
            panic!("a sun far away");
        };
        let (x, z) = (100f32.to_radians().sin(), -100f32.to_radians().cos());
        let towards = Vec3::new(0.75f32.sqrt() * x, 0.5, 0.75f32.sqrt() * z);
        assert!((direction + towards).length() < 1e-5, "{direction:?}");
    }

    #[test]
    fn absurd_skies_are_none() {
        for (elevation, turbidity) in [(91.0, 2.0), (-13.0, 2.0), (f32::NAN, 2.0), (9.0, 0.5)] {
            let sky = Sky { elevation, turbidity, ..Sky::default() };
            assert!(sky.panorama().is_none(), "{sky:?}");
        }
    }
}
