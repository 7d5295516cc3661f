//! Which material and which primitive each pixel sees.

use raywood_scene::Rgb;

use super::first_hits::{FirstHits, OfEach};
use super::{Frame, Integrator};
use crate::sampling::mix;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "ids",
    help: "a colour for each material, a shade of it for each triangle",
    shows_light: false,
    shows_all_materials: false,
    start: |frame| Box::new(FirstHits { frame, shown: OfEach(id) }),
};

/// A colour made of the number of the material, a shade of it by that of the primitive.
fn id(frame: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    let element = surfaces.element(number);
    let hue = material_color(frame.scene.material_index(element) as u32);
    // Instances are counted on, so that their triangles differ, too.
    let own = element.primitive ^ element.instance.wrapping_mul(0x9e37_79b9);
    let shade = 0.75 + 0.25 * unit(mix(own ^ 0x51ed_270b));
    shade * hue
}

/// A bright colour for each number, those of the first ones far apart: the hue turns by the golden ratio.
fn material_color(number: u32) -> Rgb {
    const TURN: f32 = 0.618_034;
    let hue = (number as f32 * TURN).fract();
    let value = if number.is_multiple_of(2) { 1.0 } else { 0.75 };
    let channel = |shift: f32| {
        let distance = ((hue + shift).fract() - 0.5).abs();
        value * (0.25 + 0.75 * (6.0 * distance - 1.0).clamp(0.0, 1.0))
    };
    Rgb::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

/// A hash as a number from 0 to 1.
fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 16_777_216.0)
}
