//! Light from infinitely far away, all around: the scene's background, or a picture of surroundings.
//!
//! The sphere is divided in rows and columns of equal angles; each part is chosen by how bright it is times how large, a direction within it evenly (Pharr, Jakob and Humphreys,
//! "Physically Based Rendering", 4th edition, section 12.5).

use std::f32::consts::{PI, TAU};

use rayon::prelude::*;
use raywood::Vec3;
use raywood_scene::{Axes, Environment, luminance};

use super::AliasTable;
use crate::PreparedScene;
use crate::sines::sin_cos_of_turn;

/// Light from all around.
pub(crate) struct EnvironmentLight {
    columns: usize,
    rows: usize,
    table: AliasTable,
    /// The heights of the upper edges of the rows, and of the lower edge of the last.
    heights: Vec<f32>,
    /// Of each part, row after row from the top, the density of its directions by solid angle.
    densities: Vec<f32>,
}

impl EnvironmentLight {
    /// That of the scene; `None` if it is black. O(parts).
    pub(crate) fn new(scene: &PreparedScene<'_>) -> Option<Self> {
        let ([columns, rows], brightness) = match scene.environment() {
            Some(panorama) => brightness_of_panorama(panorama),
            None => brightness_of_background(scene),
        };
        let mean = brightness.iter().sum::<f32>() / brightness.len() as f32;
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }

        // What looks black may have something between: it is chosen too, but seldom.
        let weight = |i: usize| {
            f64::from(brightness[i].max(0.01 * mean)) * solid_angle(i / columns, rows, columns)
        };
        let weights: Vec<f64> = (0..brightness.len()).map(weight).collect();
        let table = AliasTable::new(&weights)?;
        let density =
            |i: usize| weights[i] / (table.total() * solid_angle(i / columns, rows, columns));
        let densities = (0..weights.len()).map(|i| density(i) as f32).collect();
        let height = |row: usize| (PI * row as f32 / rows as f32).cos();
        let heights = (0..=rows).map(height).collect();
        Some(Self { columns, rows, table, heights, densities })
    }

    /// Chooses a part of the sphere; `choice` is a random number.
    #[inline(always)]
    pub(crate) fn choose(&self, choice: f32) -> SpherePart {
        let part = self.table.choose(choice);
        // Most backgrounds have one column, and a division is slow.
        let (row, column) = match self.columns {
            1 => (part, 0),
            columns => (part / columns, part % columns),
        };
        SpherePart {
            top: self.heights[row],
            bottom: self.heights[row + 1],
            column: column as f32,
            density: self.densities[part],
        }
    }

    /// A direction within a part; `u` are random numbers. Without branches and calls, so that a loop over many becomes vectors.
    #[inline(always)]
    pub(crate) fn direction(&self, axes: &Axes, part: SpherePart, [u, v]: [f32; 2]) -> Vec3 {
        // Evenly by solid angle: the height is, not the angle.
        let z = part.top + u * (part.bottom - part.top);
        let turn = (part.column + v) / self.columns as f32;
        axes.to_world(from_height(z, turn))
    }

    /// The density with which a direction is chosen.
    pub(crate) fn density(&self, scene: &PreparedScene<'_>, direction: Vec3) -> f32 {
        let direction = scene.axes().to_local(direction);
        let row = ((way_down(direction) * self.rows as f32) as usize).min(self.rows - 1);
        if self.columns == 1 {
            return self.densities[row];
        }
        let [_, u] = to_angles(direction);
        let column = ((u * self.columns as f32) as usize).min(self.columns - 1);
        self.densities[row * self.columns + column]
    }
}

/// A part of the sphere between two heights.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SpherePart {
    pub(crate) top: f32,
    pub(crate) bottom: f32,
    /// Which of those in its row.
    pub(crate) column: f32,
    /// The density of its directions by solid angle; above zero.
    pub(crate) density: f32,
}

/// The solid angle of a part.
fn solid_angle(row: usize, rows: usize, columns: usize) -> f64 {
    let height = |row: usize| (std::f64::consts::PI * row as f64 / rows as f64).cos();
    std::f64::consts::TAU / columns as f64 * (height(row) - height(row + 1))
}

/// How bright parts of the background are, which differs by height alone, and how many there are.
fn brightness_of_background(scene: &PreparedScene<'_>) -> ([usize; 2], Vec<f32>) {
    const ROWS: usize = 256;
    let part = |row: usize| {
        let direction = from_height((PI * (row as f32 + 0.5) / ROWS as f32).cos(), 0.5);
        luminance(scene.background(scene.axes().to_world(direction)))
    };
    ([1, ROWS], (0..ROWS).map(part).collect())
}

/// How bright parts of a panorama are, and how many columns and rows of them there are: one for each texel, or for several of a large picture.
fn brightness_of_panorama(panorama: &Environment) -> ([usize; 2], Vec<f32>) {
    const MOST: usize = 1 << 22;
    let [width, height] = [panorama.width(), panorama.height()].map(|size| size as usize);
    let step = (1..).find(|step| width.div_ceil(*step) * height.div_ceil(*step) <= MOST);
    let step = step.unwrap_or(width.max(height));
    let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
    let part = |number: usize| {
        // Between texels light is blended, so that half of the next one counts.
        let (row, column) = (number / columns, number % columns);
        let share = |place: usize, part: usize, count: usize, of: f32| {
            (part as f32 + place as f32 / of) / count as f32
        };
        let last = 2 * step;
        let mut sum = 0.0;
        for y in 0..=last {
            for x in 0..=last {
                let turn = share(x, column, columns, last as f32);
                let down = share(y, row, rows, last as f32);
                sum += luminance(panorama.light(turn, down));
            }
        }
        sum / ((last + 1) * (last + 1)) as f32
    };
    ([columns, rows], (0..rows * columns).into_par_iter().map(part).collect())
}

/// The direction of a height, and a share of the way around, from the left edge of a panorama to the right.
#[inline(always)]
fn from_height(z: f32, turn: f32) -> Vec3 {
    let squared = 1.0 - z * z;
    let radius = if squared > 0.0 { squared.sqrt() } else { 0.0 };
    let (sin, cos) = sin_cos_of_turn(turn - 0.5);
    Vec3::new(radius * sin, -radius * cos, z)
}

/// The shares of the ways down and around at which a direction is.
#[inline]
pub(crate) fn to_angles(direction: Vec3) -> [f32; 2] {
    [way_down(direction), 0.5 + direction.x.atan2(-direction.y) / TAU]
}

/// The share of the way down at which a direction is.
#[inline]
fn way_down(direction: Vec3) -> f32 {
    direction.z.clamp(-1.0, 1.0).acos() / PI
}

#[cfg(test)]
mod tests {
    use raywood_scene::{Background, Rgb, Scene};

    use super::*;
    use crate::path_samples::PathSamples;

    /// A black sky with a bright patch, and the default background.
    fn scenes() -> [(Scene, Option<Environment>); 2] {
        let mut texels = vec![Rgb::splat(0.01); 32 * 16];
        texels[5 * 32 + 20] = Rgb::splat(500.0);
        texels[12 * 32] = Rgb::splat(90.0);
        let panorama = Environment::new(32, 16, texels).expect("a panorama");
        let scene = Scene { background: Background::default(), ..Scene::default() };
        [(scene.clone(), Some(panorama)), (scene, None)]
    }

    #[test]
    fn heights_and_turns_are_found_again() {
        for (z, turn) in [(0.9, 0.1), (-0.3, 0.5), (0.0, 0.77), (-0.99, 0.999)] {
            let [down, around] = to_angles(from_height(z, turn));
            assert!((down - z.acos() / PI).abs() < 1e-5 && (around - turn).abs() < 1e-5);
        }
        // The middle of a panorama is where a camera looks that nobody turned.
        assert!((from_height(0.0, 0.5) - Vec3::new(0.0, -1.0, 0.0)).length() < 1e-6);
    }

    /// Densities add up to one, and are those with which directions are chosen; light over density is the light in all.
    #[test]
    fn directions_are_chosen_as_their_density_says() {
        for (scene, panorama) in scenes() {
            let mut prepared = PreparedScene::new(&scene).expect("a tree");
            prepared.set_environment(panorama);
            let light = EnvironmentLight::new(&prepared).expect("a light");
            let (count, mut others) = (1 << 17, 0);
            let (mut sum, mut in_all, mut evenly) = (0.0f64, 0.0f64, 0.0f64);
            for index in 0..count {
                let path = PathSamples::new([0, 0], index);
                let part = light.choose(path.pair(0)[0]);
                let direction = light.direction(prepared.axes(), part, path.pair(1));
                let density = light.density(&prepared, direction);
                // On the border of two parts it may count as one of the other.
                others += u32::from((density / part.density - 1.0).abs() > 1e-3);
                let radiance = prepared.background(direction);
                sum += f64::from(luminance(radiance) / part.density);
                let [u, v] = path.pair(2);
                let even = prepared.axes().to_world(from_height(1.0 - 2.0 * u, v));
                evenly += f64::from(luminance(prepared.background(even)));
                in_all += f64::from(light.density(&prepared, even));
            }
            assert!(others < 128, "{others} of {count}");
            let (count, sphere) = (f64::from(count), 4.0 * std::f64::consts::PI);
            let in_all = sphere * in_all / count;
            assert!((in_all - 1.0).abs() < 0.02, "densities of {in_all} in all");
            let (asked, by_chance) = (sum / count, sphere * evenly / count);
            assert!((asked / by_chance - 1.0).abs() < 0.03, "{asked} is not {by_chance}");
        }
    }
}
