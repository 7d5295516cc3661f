//! Mirror law, Snell, Fresnel and Schlick against values known from elsewhere.

use raywood::Vec3;
use raywood_render::fresnel::{dielectric, reflect, refract, schlick};
use raywood_scene::Rgb;

fn near(actual: f32, expected: f32, tolerance: f32) {
    assert!((actual - expected).abs() <= tolerance, "{actual} is not {expected}");
}

#[test]
fn glass_mirrors_four_percent_head_on_from_either_side() {
    near(dielectric(1.0, 1.0 / 1.5).reflectance, 0.04, 1e-7);
    near(dielectric(1.0, 1.5).reflectance, 0.04, 1e-7);
    // Water and diamond: ((n - 1) / (n + 1))^2.
    near(dielectric(1.0, 1.0 / 1.33).reflectance, 0.020_06, 1e-5);
    near(dielectric(1.0, 1.0 / 2.42).reflectance, 0.172_4, 1e-4);
}

/// At Brewster's angle, tan = n, light polarised in the plane is not mirrored at all, so the mean of both is half of
/// the other, which is ((n^2 - 1) / (n^2 + 1))^2.
#[test]
fn brewsters_angle() {
    let n = 1.5f32;
    let cosine = n.atan().cos();
    let perpendicular = ((n * n - 1.0) / (n * n + 1.0)).powi(2);
    near(dielectric(cosine, 1.0 / n).reflectance, 0.5 * perpendicular, 1e-6);
}

/// At 45 degrees onto glass of 1.5: 9.2013 % perpendicular, its square parallel (a known property of 45 degrees).
#[test]
fn forty_five_degrees() {
    let perpendicular = 0.092_013;
    let expected = 0.5 * (perpendicular + perpendicular * perpendicular);
    near(dielectric(0.5f32.sqrt(), 1.0 / 1.5).reflectance, expected, 1e-5);
}

#[test]
fn grazing_light_is_mirrored_whole() {
    near(dielectric(0.0, 1.0 / 1.5).reflectance, 1.0, 0.0);
    assert!(dielectric(1e-3, 1.0 / 1.5).reflectance > 0.99);
}

#[test]
fn total_internal_reflection_begins_at_the_critical_angle() {
    for n in [1.1f64, 1.33, 1.5, 2.42] {
        let critical = (1.0 / n).asin();
        let at = |angle: f64| dielectric(angle.cos() as f32, n as f32);
        let before = at(critical - 1e-4);
        assert!(before.reflectance < 1.0 && before.cos_transmitted > 0.0, "n = {n}");
        let after = at(critical + 1e-4);
        assert_eq!((after.reflectance, after.cos_transmitted), (1.0, 0.0), "n = {n}");
        // Just before, nearly everything is mirrored already, and from outside nothing ever totally.
        assert!(before.reflectance > 0.8);
        for angle in 0..90 {
            let cosine = f64::from(angle).to_radians().cos() as f32;
            assert!(dielectric(cosine, (1.0 / n) as f32).reflectance < 1.0);
        }
    }
}

#[test]
fn equal_indices_mirror_nothing_at_any_angle() {
    for cosine in [0.0, 1e-4, 0.5, 1.0] {
        assert_eq!(dielectric(cosine, 1.0).reflectance, 0.0);
    }
}

/// The share is the same for the ray and for the ray that runs back.
#[test]
fn fresnel_is_reciprocal() {
    for step in 1..=20 {
        let cosine = step as f32 / 20.0;
        let inward = dielectric(cosine, 1.0 / 1.5);
        let outward = dielectric(inward.cos_transmitted, 1.5);
        near(outward.reflectance, inward.reflectance, 2e-5);
        near(outward.cos_transmitted, cosine, 1e-5);
    }
}

#[test]
fn mirrored_directions_keep_the_tangent_and_turn_the_normal_part() {
    let n = Vec3::new(0.0, 0.6, 0.8);
    let d = Vec3::new(2.0, -3.0, 0.5);
    let r = reflect(d, n);
    near(r.dot(n), -d.dot(n), 1e-6);
    assert!(((r - r.dot(n) * n) - (d - d.dot(n) * n)).length() < 1e-6);
    assert!((reflect(d, -n) - r).length() < 1e-6);
}

#[test]
fn refracted_directions_follow_snell() {
    // 30 degrees into glass of 1.5: sin = 1/3.
    let d = Vec3::new(0.5, -(0.75f32.sqrt()), 0.0);
    let into = dielectric(0.75f32.sqrt(), 1.0 / 1.5);
    let t = refract(d, Vec3::Y, 1.0 / 1.5, into.cos_transmitted);
    near(t.x, 1.0 / 3.0, 1e-6);
    near(t.y, -(8.0f32 / 9.0).sqrt(), 1e-6);
    near(t.length(), 1.0, 1e-6);

    // And back out again, at the other face of a slab: parallel to where it came from.
    let out = dielectric(into.cos_transmitted, 1.5);
    let back = refract(t, Vec3::Y, 1.5, out.cos_transmitted);
    assert!((back - d).length() < 1e-6);
}

#[test]
fn schlick_goes_from_head_on_to_white() {
    let gold = Rgb::new(1.0, 0.8, 0.3);
    assert_eq!(schlick(gold, 1.0), gold);
    assert_eq!(schlick(gold, 0.0), Rgb::ONE);
    near(schlick(Rgb::splat(0.04), 0.5).x, 0.04 + 0.96 / 32.0, 1e-6);
}
