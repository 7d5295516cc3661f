//! What must hold of every surface: nothing is lost or gained, light may run either way, directions are chosen as their density says.

use raywood::Vec3;
use raywood_scene::Rgb;

use super::frame::cosine_hemisphere;
use super::layer::{Coat, Sheen};
use super::opaque::OpaqueSurface;
use super::*;
use crate::path_samples::PathSamples;
use crate::wave::WAVE;
use crate::wave::columns::{ZERO, get, set};

/// An opaque surface that scatters and mirrors all, and glass that lets all through.
fn white() -> Substance {
    Substance {
        opaque: OpaqueSurface {
            base: Rgb::ONE,
            metallic: 0.0,
            reflectance: None,
            alpha: 0.0,
            coat: None,
            sheen: None,
        },
        glass_share: 0.0,
        tint: Rgb::ONE,
        ior: 1.5,
        glass_alpha: 0.0,
    }
}

fn coated(reflectance: f32, roughness: f32) -> Substance {
    let reflectance = Some(Rgb::splat(reflectance));
    let alpha = roughness * roughness;
    Substance { opaque: OpaqueSurface { reflectance, alpha, ..white().opaque }, ..white() }
}

fn metal(roughness: f32) -> Substance {
    let mut metal = coated(0.04, roughness);
    metal.opaque.metallic = 1.0;
    metal
}

fn glass(ior: f32, roughness: f32) -> Substance {
    Substance { glass_share: 1.0, ior, glass_alpha: roughness * roughness, ..white() }
}

/// A clear coat over a share of something.
fn under_coat(share: f32, roughness: f32, mut below: Substance) -> Substance {
    below.opaque.coat = Some(Coat { share, alpha: roughness * roughness });
    below
}

/// Fibres on something.
fn under_sheen(strength: f32, roughness: f32, mut below: Substance) -> Substance {
    let color = Rgb::splat(strength);
    below.opaque.sheen = Some(Sheen { color, alpha: roughness * roughness });
    below
}

/// From smooth to chalk.
const ROUGHNESSES: [f32; 8] = [0.0, 0.05, 0.15, 0.3, 0.45, 0.62, 0.8, 1.0];

/// White surfaces of every kind, with their names.
fn white_surfaces() -> Vec<(String, Substance)> {
    let mut all = vec![("Lambert".to_owned(), white())];
    for roughness in ROUGHNESSES {
        let half_metal = {
            let mut half = metal(roughness);
            half.opaque.metallic = 0.5;
            half
        };
        let half_glass = Substance { glass_share: 0.6, ..coated(0.04, roughness) };
        let half_glass = Substance { glass_alpha: roughness * roughness, ..half_glass };
        all.extend([
            (format!("metal of roughness {roughness}"), metal(roughness)),
            (format!("coated of roughness {roughness}"), coated(0.04, roughness)),
            (format!("shiny of roughness {roughness}"), coated(0.5, roughness)),
            (format!("half metal of roughness {roughness}"), half_metal),
            (format!("glass of roughness {roughness}"), glass(1.5, roughness)),
            (format!("diamond of roughness {roughness}"), glass(2.4, roughness)),
            (format!("half glass of roughness {roughness}"), half_glass),
            (
                format!("coat on chalk of roughness {roughness}"),
                under_coat(1.0, roughness, white()),
            ),
            (
                format!("smooth coat on metal of roughness {roughness}"),
                under_coat(1.0, 0.0, metal(roughness)),
            ),
            (
                format!("coat on metal, both of roughness {roughness}"),
                under_coat(1.0, roughness, metal(roughness)),
            ),
            (
                format!("smooth coat on paint of roughness {roughness}"),
                under_coat(1.0, 0.0, half_metal),
            ),
            (
                format!("half a rough coat on metal of roughness {roughness}"),
                under_coat(0.5, 0.4, metal(roughness)),
            ),
            (
                format!("coat on smooth metal of roughness {roughness}"),
                under_coat(1.0, roughness, metal(0.0)),
            ),
            (format!("velvet of roughness {roughness}"), under_sheen(1.0, roughness, white())),
            (
                format!("sheen on paint, both of roughness {roughness}"),
                under_sheen(0.6, roughness, half_metal),
            ),
            (
                format!("sheen beside a coat, both of roughness {roughness}"),
                under_coat(0.4, roughness, under_sheen(1.0, roughness, coated(0.04, 0.3))),
            ),
        ]);
    }
    all
}

fn tables() -> Vec<GlassTable> {
    [1.5, 2.4].map(GlassTable::new).into()
}

fn from(cosine: f32) -> Vec3 {
    Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

const COSINES: [f32; 5] = [0.08, 0.25, 0.5, 0.8, 1.0];

/// The share of light from all around that comes back, and its coordinates' least.
fn furnace(bsdf: &Bsdf, samples: u32) -> f32 {
    let mut sum = 0.0f64;
    for index in 0..samples {
        let path = PathSamples::new([7, 3], index);
        if let Some(scattered) = bsdf.sample(path.pair(0)[0], path.pair(1)) {
            sum += f64::from(scattered.weight.x);
        }
    }
    (sum / f64::from(samples)) as f32
}

/// In light of one from everywhere, white surfaces cannot be seen.
#[test]
fn white_furnace() {
    let tables = tables();
    let mut seen = Vec::new();
    for (name, substance) in white_surfaces() {
        for cosine in COSINES {
            for outside in [true, false] {
                let bsdf = Bsdf::new(&substance, from(cosine), outside, &tables);
                let back = furnace(&bsdf, 1 << 14);
                if back.is_nan() || (back - 1.0).abs() >= 0.01 {
                    seen.push(format!("{name} at {cosine}: {back} of 1"));
                }
            }
        }
    }
    assert!(seen.is_empty(), "{seen:#?}");
}

/// Layers of any roughness on metal of any other, where tables must know most: all of the light comes back.
#[test]
fn layers_on_mirrors_lose_nothing() {
    const ROUGHNESSES: [f32; 8] = [0.0, 0.04, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];
    let mut seen = Vec::new();
    for layer in ROUGHNESSES {
        for below in ROUGHNESSES {
            let coat = under_coat(1.0, layer, metal(below));
            let sheen = under_sheen(1.0, layer, metal(below));
            for (name, substance) in [("coat", coat), ("sheen", sheen)] {
                for cosine in [0.04, 0.1, 0.18, 0.35, 0.65, 0.95] {
                    let bsdf = Bsdf::new(&substance, from(cosine), true, &[]);
                    // Fibres are chosen evenly, which takes many samples.
                    let back = furnace(&bsdf, 1 << 16);
                    if back.is_nan() || (back - 1.0).abs() >= 0.01 {
                        seen.push(format!("{name} {layer} on {below} at {cosine}: {back}"));
                    }
                }
            }
        }
    }
    assert!(seen.is_empty(), "{seen:#?}");
}

/// Coloured surfaces send back at most what they get, below layers too.
#[test]
fn nothing_is_gained() {
    let color = Rgb::new(0.9, 0.5, 0.02);
    let bare = |substance| substance;
    let coat = |substance| under_coat(1.0, 0.2, substance);
    let sheen = |substance| under_sheen(0.7, 0.5, substance);
    let over: [&dyn Fn(Substance) -> Substance; 3] = [&bare, &coat, &sheen];
    for (roughness, layered) in ROUGHNESSES.iter().flat_map(|r| over.iter().map(move |l| (*r, l))) {
        for metallic in [0.0, 0.5, 1.0] {
            let mut substance = coated(0.2, roughness);
            substance.opaque.base = color;
            substance.opaque.metallic = metallic;
            let substance = layered(substance);
            for cosine in COSINES {
                let bsdf = Bsdf::new(&substance, from(cosine), true, &[]);
                let mut sum = Rgb::ZERO;
                for index in 0..4096 {
                    let path = PathSamples::new([7, 3], index);
                    if let Some(scattered) = bsdf.sample(path.pair(0)[0], path.pair(1)) {
                        sum += (1.0 / 4096.0) * scattered.weight;
                    }
                }
                let (brightest, least) = (sum.max_element(), sum.x.min(sum.y).min(sum.z));
                assert!(brightest < 1.01 && least > 0.0, "{roughness} {metallic}: {sum:?}");
            }
        }
    }
}

/// Light may run either way: `f` is the same with `wo` and `wi` exchanged; between media of different density times the square of the index.
#[test]
fn reciprocity() {
    let tables = tables();
    for (name, substance) in white_surfaces() {
        for index in 0..400 {
            let path = PathSamples::new([1, 2], index);
            let (wo, wi) = (sphere(path.pair(0)), sphere(path.pair(1)));
            if wo.z.abs() < 0.05 || wi.z.abs() < 0.05 {
                continue;
            }
            // Each in the frame of the side that it is on.
            let answer = |wo: Vec3, wi: Vec3| {
                let (wo, wi, outside) = if wo.z > 0.0 { (wo, wi, true) } else { (-wo, -wi, false) };
                Bsdf::new(&substance, wo, outside, &tables).eval(wi) / wi.z.abs()
            };
            let index_there = |w: Vec3| if w.z > 0.0 { 1.0 } else { substance.ior };
            let (there, back) = (answer(wo, wi), answer(wi, wo));
            let scale = (index_there(wo) / index_there(wi)).powi(2);
            let scale = if substance.glass_share > 0.0 { scale } else { 1.0 };
            let off = (scale * there - back).abs().max_element();
            assert!(off <= 2e-3 * back.max_element() + 1e-5, "{name}: {there:?} {back:?} {scale}");
        }
    }
}

/// Chosen directions fall into each part of the sphere as often as the density says: Pearson's chi-squared test.
#[test]
fn directions_are_chosen_as_their_density_says() {
    const ROWS: usize = 24;
    const COLUMNS: usize = 24;
    const SAMPLES: u32 = 1 << 17;
    let tables = tables();
    for (name, substance) in white_surfaces() {
        // What is nearly smooth has its light in fewer parts than there are.
        if name.ends_with("0.05") || name.ends_with("roughness 0") && name.starts_with("glass") {
            continue;
        }
        for (cosine, outside) in [(0.25, true), (0.8, true), (0.8, false)] {
            let bsdf = Bsdf::new(&substance, from(cosine), outside, &tables);
            let mut found = [0.0f64; ROWS * COLUMNS];
            let place = |w: Vec3| {
                let row = (0.5 * (1.0 - w.z) * ROWS as f32) as usize;
                let turn = 0.5 + w.y.atan2(w.x) / std::f32::consts::TAU;
                let column = (turn * COLUMNS as f32) as usize;
                row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
            };
            // Plain random numbers, which the test is for: better ones vary less.
            let mut rng = Random(0x9e37_79b9_7f4a_7c15);
            let mut mirrors = 0u32;
            for _ in 0..SAMPLES {
                match bsdf.sample(rng.next(), [rng.next(), rng.next()]) {
                    Some(Scattered { density: Density::Mirror, .. }) => mirrors += 1,
                    Some(scattered) => found[place(scattered.wi)] += 1.0,
                    None => {}
                }
            }
            if mirrors == SAMPLES {
                continue;
            }

            // What the density says, by its mean over many directions of each part.
            let mut expected = [0.0f64; ROWS * COLUMNS];
            let fine = 32;
            for row in 0..ROWS * fine {
                for column in 0..COLUMNS * fine {
                    let z = 1.0 - 2.0 * (row as f32 + 0.5) / (ROWS * fine) as f32;
                    let turn = (column as f32 + 0.5) / (COLUMNS * fine) as f32 - 0.5;
                    let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
                    let radius = (1.0 - z * z).sqrt();
                    let w = Vec3::new(radius * cos, radius * sin, z);
                    expected[(row / fine) * COLUMNS + column / fine] += f64::from(bsdf.density(w));
                }
            }
            let part = 4.0 * std::f64::consts::PI / (ROWS * COLUMNS * fine * fine) as f64;
            let (mut chi2, mut parts) = (0.0, 0.0);
            let (mut rest_found, mut rest_expected) = (0.0, 0.0);
            for (found, expected) in found.iter().zip(&expected) {
                let expected = expected * part * f64::from(SAMPLES);
                if expected < 20.0 {
                    rest_found += found;
                    rest_expected += expected;
                    continue;
                }
                chi2 += (found - expected).powi(2) / expected;
                parts += 1.0;
            }
            // Five standard deviations above the mean of chi-squared, and the few that fell elsewhere.
            let limit = parts + 5.0 * (2.0f64 * parts).sqrt() + 5.0;
            assert!(chi2 < limit, "{name} at {cosine}: chi2 of {chi2:.0} in {parts} parts");
            let rest = (rest_found - rest_expected).abs();
            assert!(rest < 6.0 * rest_expected.sqrt() + 10.0, "{name}: {rest} elsewhere");
        }
    }
}

/// A direction of the whole sphere, evenly distributed.
fn sphere([u, v]: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
    Vec3::new(radius * cos, radius * sin, z)
}

/// Marsaglia's xorshift.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 * (1.0 / 16_777_216.0)
    }
}

/// Surfaces in columns answer and choose as each does by itself.
#[test]
fn many_surfaces_do_as_each_does() {
    let bare: Vec<_> = white_surfaces()
        .into_iter()
        .filter(|(_, substance)| substance.glass_share == 0.0 && substance.opaque.is_bare())
        .collect();
    let (mut bodies, mut answers) = (MirroredBodies::default(), Answers::default());
    let (mut wos, mut wis, mut chosen) = (ZERO, ZERO, ZERO);
    let (mut choices, mut u) = ([[0.0; WAVE]; 2], [[0.0; WAVE]; 2]);
    for index in 0..32 {
        let path = PathSamples::new([3, 4], index);
        for (number, (_, substance)) in bare.iter().enumerate() {
            let numbers = |decision: u32| path.pair(16 * number as u32 + decision);
            bodies.set(number, &substance.opaque);
            set(&mut wos, number, cosine_hemisphere(numbers(0)));
            // Some come from below.
            let wi = cosine_hemisphere(numbers(1));
            set(&mut wis, number, if index % 8 == 0 { -wi } else { wi });
            choices[0][number] = numbers(2)[0];
            [u[0][number], u[1][number]] = numbers(3);
        }
        bodies.look_from(&wos, bare.len());
        bodies.answer(&wis, bare.len(), &mut answers);
        bodies.choose(&choices, &u, bare.len(), &mut chosen);
        for (number, (name, substance)) in bare.iter().enumerate() {
            let bsdf = Bsdf::new(substance, get(&wos, number), true, &[]);
            let wi = get(&wis, number);
            assert_eq!(get(&answers.light, number), bsdf.eval(wi), "{name}");
            assert_eq!(answers.densities[number], bsdf.density(wi), "{name}");
            let scattered = bsdf.sample(choices[0][number], [u[0][number], u[1][number]]);
            let direction = get(&chosen, number);
            match scattered {
                Some(scattered) => assert_eq!(direction, scattered.wi, "{name}"),
                None => assert!(direction.z <= 0.0, "{name}: {direction:?}"),
            }
        }
    }
}
