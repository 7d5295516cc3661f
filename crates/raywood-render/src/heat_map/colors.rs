//! The colours of heat maps: viridis, in which equal steps look equal, in grey and to the colour-blind too.

use super::HeatMap;
use super::scale::usable;
use crate::rgb_image::RgbImage;

/// The colour of a share of the scale, which is clamped to 0 to 1.
pub(super) fn color(share: f32) -> [u8; 3] {
    colorous::VIRIDIS.eval_continuous(f64::from(share)).as_array()
}

impl HeatMap {
    /// The map in colours, as large as the map, without a legend. The scale runs from 0 to `maximum`, and larger values have the last colour; a
    /// maximum that is not above zero counts as 1.
    pub fn picture(&self, maximum: f32) -> RgbImage {
        // More steps than a channel has; a polynomial for each pixel would take longer than the rays of a small scene.
        const STEPS: u16 = 1023;
        let steps = f32::from(STEPS);
        let colors: Vec<_> = (0..=STEPS).map(|step| color(f32::from(step) / steps)).collect();
        let scale = f64::from(steps) / f64::from(usable(maximum));
        // The conversion to an integer saturates.
        let step = |value: f32| (f64::from(value) * scale + 0.5) as usize;
        let bytes =
            self.values.iter().flat_map(|&value| colors[step(value).min(usize::from(STEPS))]);
        RgbImage::from_bytes(self.width, self.height, bytes.collect())
    }
}

#[cfg(test)]
mod tests {
    use raywood::StructureKind;
    use raywood_scene::{Rgb, luminance, srgb_to_linear};

    use super::*;
    use crate::HeatQuantity;

    #[test]
    fn larger_values_are_brighter_up_to_the_maximum() {
        let values: Vec<f32> = (0..=100).map(|i| i as f32).collect();
        let (quantity, structure) = (HeatQuantity::Boxes, StructureKind::Octree);
        let map = HeatMap { width: 101, height: 1, quantity, structure, values, rays: 0 };
        let picture = map.picture(50.0);
        let brightness = |x: u32| {
            let bytes = picture.pixel(x, 0).expect("a pixel");
            luminance(Rgb::from(bytes.map(|byte| srgb_to_linear(f32::from(byte) / 255.0))))
        };
        for x in 0..50 {
            assert!(brightness(x) < brightness(x + 1), "at {x}");
        }
        assert!((51..=100).all(|x| picture.pixel(x, 0) == picture.pixel(50, 0)));
        // The ends of viridis, as published.
        assert_eq!(picture.pixel(0, 0), Some([0x44, 0x01, 0x54]));
        assert_eq!(picture.pixel(50, 0), Some([0xfd, 0xe7, 0x25]));
        // Nonsense is a scale to 1.
        assert_eq!(map.picture(f32::NAN), map.picture(1.0));
        assert_eq!(map.picture(-3.0), map.picture(1.0));
    }
}
