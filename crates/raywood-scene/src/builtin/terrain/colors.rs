//! What grows, lies or shows on the land: grass, forest, scree, rock and snow by height and slope.

use raywood::Vec3;

use super::heights::smoothstep;
use crate::Rgb;
use crate::noise::gradient2;

const SAND: Rgb = Rgb::new(0.56, 0.47, 0.32);
const FOREST: Rgb = Rgb::new(0.045, 0.085, 0.030);
const GRASS: Rgb = Rgb::new(0.135, 0.170, 0.040);
const ROCK: Rgb = Rgb::new(0.250, 0.215, 0.185);
const DARK_ROCK: Rgb = Rgb::new(0.125, 0.112, 0.105);
const SNOW: Rgb = Rgb::new(0.86, 0.89, 0.94);
const HAZE: Rgb = Rgb::new(0.52, 0.56, 0.66);

/// The colour of the ground at a point with a normal, as seen from `eye`.
pub(super) fn ground_color(p: Vec3, normal: Vec3, eye: Vec3) -> Rgb {
    let mix = |a: Rgb, b: Rgb, t: f32| a + t * (b - a);
    let noise = |scale: f32, seed| gradient2(p.x / scale, p.z / scale, seed).0;
    let patches = 0.6 * noise(400.0, 91) + 0.4 * noise(90.0, 92);
    let height = p.y + 90.0 * patches;
    let flat = normal.y + 0.05 * patches;

    // Bedrock in two tones, and on it what holds at this slope and height.
    let mut color = mix(DARK_ROCK, ROCK, smoothstep(-0.6, 0.7, patches + 0.5 * noise(35.0, 93)));
    let grass = smoothstep(0.70, 0.84, flat) * smoothstep(850.0, 520.0, height);
    color = mix(color, GRASS, grass);
    let forest = smoothstep(0.74, 0.88, flat) * smoothstep(640.0, 380.0, height);
    color = mix(color, FOREST, forest * smoothstep(-0.45, 0.05, patches));
    let snow = smoothstep(0.38, 0.56, flat) * smoothstep(760.0, 1100.0, height);
    color = mix(color, SNOW, snow);
    color = mix(color, SAND, smoothstep(12.0, 4.0, p.y + 5.0 * patches));

    // Air between eye and ground takes contrast away.
    let air = 1.0 - (-(p - eye).length() / 75_000.0).exp();
    mix(color, HAZE, air)
}
