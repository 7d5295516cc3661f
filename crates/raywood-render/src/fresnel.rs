//! What a smooth surface mirrors and lets through: mirror direction, Snell's law, Fresnel's equations, Schlick's form.

use raywood::Vec3;
use raywood_scene::Rgb;

/// The direction `d` mirrored at a surface with unit normal `n` (either side).
#[inline(always)]
pub fn reflect(d: Vec3, n: Vec3) -> Vec3 {
    d - (2.0 * d.dot(n)) * n
}

/// What happens to light at the boundary of two dielectrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// The share of unpolarised light that is mirrored, 0 to 1; 1 is total internal reflection.
    pub reflectance: f32,
    /// Cosine between the refracted ray and the normal, 0 to 1; 0 at total internal reflection.
    pub cos_transmitted: f32,
}

/// Fresnel's equations for unpolarised light (Born and Wolf, Principles of Optics, section 1.5).
///
/// `cos_incident` is the cosine between the incoming ray and the normal, 0 to 1; `eta` is the index of refraction on
/// the side that the ray comes from divided by the one on the other side.
#[inline(always)]
pub fn dielectric(cos_incident: f32, eta: f32) -> Interface {
    let cos_i = cos_incident.clamp(0.0, 1.0);

    // Equal indices never mirror; rounding must not make a total reflection of a grazing ray.
    if eta == 1.0 {
        return Interface { reflectance: 0.0, cos_transmitted: cos_i };
    }

    // Snell: sin_t = eta * sin_i. Where that exceeds one, no light gets through.
    let sin2_t = eta * eta * ((1.0 - cos_i) * (1.0 + cos_i));
    if sin2_t >= 1.0 {
        return Interface { reflectance: 1.0, cos_transmitted: 0.0 };
    }
    let cos_t = (1.0 - sin2_t).sqrt();

    let perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let reflectance = 0.5 * (perpendicular * perpendicular + parallel * parallel);
    Interface { reflectance, cos_transmitted: cos_t }
}

/// The direction into which Snell's law bends `d`, both of unit length.
///
/// `n` is the unit normal on the side that `d` comes from, `eta` as in [`dielectric`], and `cos_transmitted` what it
/// answered.
#[inline(always)]
pub fn refract(d: Vec3, n: Vec3, eta: f32, cos_transmitted: f32) -> Vec3 {
    let cos_incident = -d.dot(n);
    eta * d + (eta * cos_incident - cos_transmitted) * n
}

/// Schlick's approximation (1994) of a mirror that rises to one towards grazing angles, from what it mirrors head-on.
#[inline(always)]
pub fn schlick(head_on: Rgb, cos_incident: f32) -> Rgb {
    schlick_to(head_on, 1.0, cos_incident)
}

/// As [`schlick`], of a mirror that rises to `grazing`.
#[inline(always)]
pub fn schlick_to(head_on: Rgb, grazing: f32, cos_incident: f32) -> Rgb {
    let x = (1.0 - cos_incident).clamp(0.0, 1.0);
    let x2 = x * x;
    head_on + (x2 * x2 * x) * (Rgb::splat(grazing) - head_on)
}
