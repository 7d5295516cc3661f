//! Powers of numbers from 0 to about 1, without branches and calls, so that the compiler can compute many at once with vectors.

/// `x` to the power of `exponent`, both at least zero: good to some 1e-6 of the result where that is above 1e-6, and to less than 1e-10 below.
#[inline(always)]
pub(crate) fn power(x: f32, exponent: f32) -> f32 {
    let result = exp2(exponent * log2(x));
    // Zero has no logarithm, but zero to the power of zero is one.
    let of_zero = if exponent == 0.0 { 1.0 } else { 0.0 };
    if x < f32::MIN_POSITIVE { of_zero } else { result }
}

/// The binary logarithm of a normal number: with `x = 2^e m`, `m` about one and `z = (m - 1) / (m + 1)`, `ln m = 2 artanh z`.
#[inline(always)]
fn log2(x: f32) -> f32 {
    /// The bits of the square root of 1/2: `m` lies between this and twice this.
    const LEAST: i32 = 0x3f35_04f3;
    let exponent = (x.to_bits() as i32 - LEAST) >> 23;
    let m = f32::from_bits((x.to_bits() as i32 - (exponent << 23)) as u32);
    let z = (m - 1.0) / (m + 1.0);
    let z2 = z * z;
    let series = 1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0))));
    exponent as f32 + (2.0 * std::f32::consts::LOG2_E) * z * series
}

/// Two to the power of a number: its whole part becomes the exponent, the rest, at most 1/2, goes into the exponential series.
#[inline(always)]
fn exp2(x: f32) -> f32 {
    /// Adding it rounds to whole numbers, which are then its lowest bits.
    const ROUND: f32 = 12_582_912.0;
    let clamped = if x > -126.0 { x } else { -126.0 };
    let clamped = if clamped < 127.0 { clamped } else { 127.0 };
    let shifted = clamped + ROUND;
    let rest = (clamped - (shifted - ROUND)) * std::f32::consts::LN_2;
    let series = 1.0 / 24.0 + rest * (1.0 / 120.0 + rest * (1.0 / 720.0 + rest * (1.0 / 5040.0)));
    let series = 1.0 + rest * (1.0 + rest * (0.5 + rest * (1.0 / 6.0 + rest * series)));
    let whole = shifted.to_bits().wrapping_sub(ROUND.to_bits());
    f32::from_bits(whole.wrapping_add(127) << 23) * series
}

#[cfg(test)]
mod tests {
    use super::power;

    #[test]
    fn powers_are_right() {
        for step in 0..=4096 {
            let x = step as f32 / 4096.0 * 1.000_000_2;
            for exponent in [0.0, 0.5, 1.0, 2.0, 7.3, 50.0, 400.0, 1000.0, 20_000.0] {
                let right = f64::from(x).powf(f64::from(exponent));
                let error = (f64::from(power(x, exponent)) - right).abs();
                assert!(error <= 4e-6 * right + 1e-10, "{x}^{exponent}: off by {error}");
            }
        }
    }

    #[test]
    fn strange_numbers_give_numbers() {
        for (x, exponent) in [(0.0, 0.0), (0.0, 50.0), (1e-45, 3.0), (1.0, f32::MAX), (0.5, 1e30)] {
            let power = power(x, exponent);
            assert!((0.0..=1.0).contains(&power), "{x}^{exponent} = {power}");
        }
    }
}
