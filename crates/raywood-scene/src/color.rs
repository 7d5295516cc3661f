//! Colours.

use raywood::Vec3;

/// Linear light, red, green and blue with the primaries of sRGB (Rec. 709); 1 is the white of a picture.
pub type Rgb = Vec3;

/// One sRGB-encoded channel, 0 to 1, as linear light.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear light as one sRGB-encoded channel, clamped to 0 to 1.
pub fn linear_to_srgb(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// The brightness that the eye sees in a colour.
#[inline]
pub fn luminance(color: Rgb) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
