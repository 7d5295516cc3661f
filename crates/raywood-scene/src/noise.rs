//! Coherent noise: smooth pseudo-random functions of space (Perlin 1985), the same on every machine.

use raywood::Vec3;

/// Scrambled bits of a lattice point and a seed.
#[inline(always)]
fn hash(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77)
        ^ (z as u32).wrapping_mul(0xC2B2_AE3D)
        ^ seed.wrapping_mul(0x27D4_EB2F);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    h ^ (h >> 15)
}

/// A pseudo-random number from 0 to 1 that belongs to a lattice cell.
#[inline(always)]
pub(crate) fn cell_value(x: i32, y: i32, z: i32, seed: u32) -> f32 {
    cell_bits(x, y, z, seed) / MOST_BITS
}

/// The same from 0 to [`MOST_BITS`], a whole number.
#[inline(always)]
fn cell_bits(x: i32, y: i32, z: i32, seed: u32) -> f32 {
    // By way of a signed number: not all processors have vectors of the other conversion.
    (hash(x, y, z, seed) >> 8) as i32 as f32
}

/// The largest number of 24 bits.
const MOST_BITS: f32 = 16_777_215.0;

/// Perlin's fade curve: first and second derivatives vanish at 0 and 1, so that cells join without a crease.
#[inline(always)]
fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The derivative of [`fade`].
#[inline]
fn fade_slope(t: f32) -> f32 {
    30.0 * t * t * (t * (t - 2.0) + 1.0)
}

#[inline(always)]
fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// The cell that holds a coordinate, and the place in it, 0 to 1. Far out, where cells can no longer be told apart,
/// the cell number saturates.
#[inline(always)]
fn split(x: f32) -> (i32, f32) {
    let floor = x.floor();
    (floor as i32, x - floor)
}

/// Value noise in space, -1 to 1: random values on the unit lattice, blended smoothly. Written out corner by corner, without loops, so that a
/// loop over many points becomes vectors.
#[inline(always)]
pub(crate) fn value3(p: Vec3, seed: u32) -> f32 {
    let ((xi, xf), (yi, yf), (zi, zf)) = (split(p.x), split(p.y), split(p.z));
    let (u, v, w) = (fade(xf), fade(yf), fade(zf));
    let corner =
        |x, y, z| cell_bits(xi.wrapping_add(x), yi.wrapping_add(y), zi.wrapping_add(z), seed);
    let near =
        mix(mix(corner(0, 0, 0), corner(1, 0, 0), u), mix(corner(0, 1, 0), corner(1, 1, 0), u), v);
    let far =
        mix(mix(corner(0, 0, 1), corner(1, 0, 1), u), mix(corner(0, 1, 1), corner(1, 1, 1), u), v);
    mix(near, far, w) * (2.0 / MOST_BITS) - 1.0
}

/// How many points noise is computed for at once.
pub(crate) const LANES: usize = 16;

/// Fractal noise in space, about -1 to 1: octaves of [`value3`], each at twice the frequency and half the height.
#[inline(always)]
pub(crate) fn fractal3(p: Vec3, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut height, mut q) = (0.0, 0.5, p);
    for octave in 0..octaves {
        sum += height * value3(q, seed.wrapping_add(octave));
        q = next_octave(q);
        height *= 0.5;
    }
    sum
}

/// [`fractal3`] at many points, given by columns.
#[inline(always)]
pub(crate) fn fractal3_lanes(p: &[[f32; LANES]; 3], octaves: u32, seed: u32) -> [f32; LANES] {
    let (mut sums, mut height, mut q) = ([0.0; LANES], 0.5, *p);
    for octave in 0..octaves {
        for lane in 0..LANES {
            let point = Vec3::new(q[0][lane], q[1][lane], q[2][lane]);
            sums[lane] += height * value3(point, seed.wrapping_add(octave));
            [q[0][lane], q[1][lane], q[2][lane]] = next_octave(point).to_array();
        }
        height *= 0.5;
    }
    sums
}

/// Where the next octave of fractal noise is read: a little off twice the frequency, and turned, so that the octaves' lattices never line up.
#[inline(always)]
fn next_octave(q: Vec3) -> Vec3 {
    Vec3::new(1.6 * q.x + 1.2 * q.z, 2.03 * q.y, 1.6 * q.z - 1.2 * q.x)
}

/// Gradient noise in the plane, about -1 to 1, and its two derivatives.
#[inline]
pub(crate) fn gradient2(x: f32, y: f32, seed: u32) -> (f32, [f32; 2]) {
    let ((xi, xf), (yi, yf)) = (split(x), split(y));
    let (u, v) = (fade(xf), fade(yf));
    let (du, dv) = (fade_slope(xf), fade_slope(yf));

    // A slope in a random direction at each corner. Two 16-bit halves of one hash make the direction; it is not of
    // unit length, which only makes the noise livelier.
    let gradient = |dx: i32, dy: i32| {
        let h = hash(xi.wrapping_add(dx), yi.wrapping_add(dy), 0, seed);
        let half = |bits: u32| (bits & 0xFFFF) as f32 * (2.0 / 65_535.0) - 1.0;
        [half(h), half(h >> 16)]
    };
    let (g00, g10, g01, g11) = (gradient(0, 0), gradient(1, 0), gradient(0, 1), gradient(1, 1));
    let a = g00[0] * xf + g00[1] * yf;
    let b = g10[0] * (xf - 1.0) + g10[1] * yf;
    let c = g01[0] * xf + g01[1] * (yf - 1.0);
    let d = g11[0] * (xf - 1.0) + g11[1] * (yf - 1.0);

    // Blend the four planes and differentiate by the product rule.
    let twist = a - b - c + d;
    let value = a + u * (b - a) + v * (c - a) + u * v * twist;
    let slope = |axis: usize| {
        let (p, q, r, s) = (g00[axis], g10[axis], g01[axis], g11[axis]);
        p + u * (q - p) + v * (r - p) + u * v * (p - q - r + s)
    };
    let dx = slope(0) + du * (b - a + v * twist);
    let dy = slope(1) + dv * (c - a + u * twist);
    (1.4 * value, [1.4 * dx, 1.4 * dy])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_stays_in_its_range_and_is_continuous() {
        for i in 0..20_000 {
            let t = i as f32 * 0.0137;
            let p = Vec3::new(t, 0.37 * t - 90.0, 40.0 - 0.71 * t);
            let value = value3(p, 1);
            assert!((-1.0..=1.0).contains(&value), "{value} at {p:?}");
            let near = value3(p + Vec3::splat(1e-3), 1);
            assert!((value - near).abs() < 0.02, "a jump from {value} to {near} at {p:?}");
            assert!(fractal3(p, 5, 2).abs() <= 1.0);
            assert!(gradient2(p.x, p.y, 3).0.abs() <= 1.6);
        }
    }

    #[test]
    fn derivatives_of_gradient_noise_agree_with_differences() {
        for i in 0..1000 {
            let (x, y) = (i as f32 * 0.173, 7.0 - i as f32 * 0.091);
            let (_, [dx, dy]) = gradient2(x, y, 9);
            let h = 1.0 / 128.0;
            let along_x = (gradient2(x + h, y, 9).0 - gradient2(x - h, y, 9).0) / (2.0 * h);
            let along_y = (gradient2(x, y + h, 9).0 - gradient2(x, y - h, 9).0) / (2.0 * h);
            assert!((dx - along_x).abs() < 0.02 && (dy - along_y).abs() < 0.02);
        }
    }
}
