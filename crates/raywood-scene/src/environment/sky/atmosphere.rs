//! The air over the ground: how much light it scatters and absorbs, of which parts, for red, green and blue.
//!
//! Numbers after Bruneton and Neyret, "Precomputed Atmospheric Scattering", 2008, with the ozone of Bruneton 2017; lengths are kilometres.

use crate::Rgb;

/// The radius of the ground, and of where the air ends.
const GROUND: f32 = 6360.0;
pub(super) const TOP: f32 = 6460.0;

/// Scattering by molecules at the ground, and how fast it falls with height (Rayleigh).
const MOLECULES: Rgb = Rgb::new(5.802e-3, 13.558e-3, 33.1e-3);
const MOLECULES_HEIGHT: f32 = 8.0;
/// The height at which haze has fallen to a share of `1 / e`, and the share of light that it scatters of what it takes (Mie).
const HAZE_HEIGHT: f32 = 1.2;
const HAZE_ALBEDO: f32 = 0.9;
/// How much it takes of each colour, of green 1: as the power -1.3 of the wavelength (Angstrom 1929).
const HAZE: Rgb = Rgb::new(0.76, 1.0, 1.34);
/// How much of the light that haze scatters goes on ahead (Henyey and Greenstein 1941).
const HAZE_AHEAD: f32 = 0.8;
/// What ozone absorbs where it is densest.
const OZONE: Rgb = Rgb::new(0.650e-3, 1.881e-3, 0.085e-3);
/// What the ground sends back.
pub(super) const GROUND_ALBEDO: f32 = 0.2;

/// Air with some haze in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Atmosphere {
    /// What haze takes of green light at the ground.
    haze: f32,
}

/// What air does at a height, per kilometre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Air {
    pub(super) molecules: Rgb,
    pub(super) haze: Rgb,
    /// All that is taken from light that goes straight on.
    pub(super) taken: Rgb,
}

impl Air {
    /// All that is scattered.
    pub(super) fn scattered(&self) -> Rgb {
        self.molecules + self.haze
    }
}

/// A place by its distance from the middle of the earth, and a direction by its cosine with straight up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aimed {
    pub(super) radius: f32,
    pub(super) rise: f32,
}

impl Atmosphere {
    /// Air that takes `turbidity` times as much green light from the zenith as its molecules alone.
    pub(super) fn new(turbidity: f32) -> Self {
        Self { haze: (turbidity - 1.0) * MOLECULES.y * MOLECULES_HEIGHT / HAZE_HEIGHT }
    }

    /// The air at a distance from the middle of the earth.
    pub(super) fn air(&self, radius: f32) -> Air {
        let height = (radius - GROUND).max(0.0);
        let molecules = (-height / MOLECULES_HEIGHT).exp() * MOLECULES;
        let haze = ((-height / HAZE_HEIGHT).exp() * self.haze) * HAZE;
        let ozone = (1.0 - (height - 25.0).abs() / 15.0).max(0.0) * OZONE;
        let taken = molecules + haze + ozone;
        Air { molecules, haze: HAZE_ALBEDO * haze, taken }
    }

    /// The light that is left on the way to where the air ends; none behind the ground.
    pub(super) fn left_of_sun(&self, from: Aimed) -> Rgb {
        const STEPS: usize = 48;
        if from.meets_ground().is_some() {
            return Rgb::ZERO;
        }
        let end = from.to_sphere(TOP).unwrap_or(0.0);
        let sum = steps(end, STEPS).fold(Rgb::ZERO, |sum, (along, length)| {
            sum + length * self.air(from.at(along).radius).taken
        });
        left(sum)
    }
}

/// Parts of a way: their middles and lengths, shorter where it begins, where air is dense.
pub(super) fn steps(end: f32, count: usize) -> impl Iterator<Item = (f32, f32)> {
    let place = move |step: f32| end * (step / count as f32).powi(2);
    (0..count).map(move |step| {
        let (a, b) = (place(step as f32), place(step as f32 + 1.0));
        (0.5 * (a + b), b - a)
    })
}

/// What is left of light by Beer's law.
pub(super) fn left(depth: Rgb) -> Rgb {
    Rgb::from(depth.to_array().map(|x| (-x).exp()))
}

impl Aimed {
    /// At a height over the ground.
    pub(super) fn above_ground(height: f32, rise: f32) -> Self {
        Self { radius: GROUND + height, rise }
    }

    /// Its height over the ground as a share of that of the air.
    pub(super) fn height_share(self) -> f32 {
        ((self.radius - GROUND) / (TOP - GROUND)).clamp(0.0, 1.0)
    }

    /// How far it is to a sphere around the earth, from inside.
    pub(super) fn to_sphere(self, sphere: f32) -> Option<f32> {
        // In double precision: squares of radii differ little.
        let (radius, rise, sphere) =
            (f64::from(self.radius), f64::from(self.rise), f64::from(sphere));
        let square = sphere * sphere - radius * radius * (1.0 - rise * rise);
        let far = -radius * rise + square.max(0.0).sqrt();
        (square >= 0.0 && far > 0.0).then_some(far as f32)
    }

    /// How far it is to the ground, if the way meets it.
    pub(super) fn meets_ground(self) -> Option<f32> {
        let (radius, rise, ground) =
            (f64::from(self.radius), f64::from(self.rise), f64::from(GROUND));
        let square = ground * ground - radius * radius * (1.0 - rise * rise);
        let near = -radius * rise - square.max(0.0).sqrt();
        (square > 0.0 && near > 0.0).then_some(near as f32)
    }

    /// Where it is after a way, and how the direction rises there.
    pub(super) fn at(self, along: f32) -> Self {
        let (radius, rise, along) =
            (f64::from(self.radius), f64::from(self.rise), f64::from(along));
        let there = (radius * radius + along * along + 2.0 * radius * rise * along).sqrt();
        let rise = (radius * rise + along) / there;
        Self { radius: there as f32, rise: rise as f32 }
    }
}

/// The share of light that molecules scatter into a direction, by the cosine of the angle between.
pub(super) fn molecules_phase(cosine: f32) -> f32 {
    3.0 / (16.0 * std::f32::consts::PI) * (1.0 + cosine * cosine)
}

/// The same of haze, in the form of Cornette and Shanks 1992.
pub(super) fn haze_phase(cosine: f32) -> f32 {
    let g2 = HAZE_AHEAD * HAZE_AHEAD;
    let around = (1.0 + g2 - 2.0 * HAZE_AHEAD * cosine).powf(1.5);
    3.0 / (8.0 * std::f32::consts::PI) * (1.0 - g2) * (1.0 + cosine * cosine)
        / ((2.0 + g2) * around)
}
