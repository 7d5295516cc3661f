//! Sines and cosines without branches and calls, so that the compiler can compute many at once with vectors.

use std::f32::consts::TAU;

/// The sine and the cosine of a share of a full turn, from -1 to 1: good to `1.2e-7`.
#[inline(always)]
pub(crate) fn sin_cos_of_turn(turn: f32) -> (f32, f32) {
    // The nearest of the four axes, and the rest, at most an eighth of a turn.
    let quarters = (4.0 * turn + 8.5) as i32;
    let rest = turn - 0.25 * quarters.wrapping_sub(8) as f32;
    let (sin, cos) = sin_cos_of_eighth(TAU * rest);
    let is_upright = quarters & 1 != 0;
    let (y, x) = if is_upright { (cos, sin) } else { (sin, cos) };
    let y = if quarters & 2 != 0 { -y } else { y };
    let x = if quarters.wrapping_add(1) & 2 != 0 { -x } else { x };
    (y, x)
}

/// The sine and the cosine of an angle of at most an eighth of a turn either way: their power series, good to `1e-7`.
#[inline(always)]
pub(crate) fn sin_cos_of_eighth(angle: f32) -> (f32, f32) {
    let a2 = angle * angle;
    let sin = 1.0 / 120.0 + a2 * (-1.0 / 5040.0 + a2 * (1.0 / 362_880.0));
    let sin = angle + angle * a2 * (-1.0 / 6.0 + a2 * sin);
    let cos = -1.0 / 720.0 + a2 * (1.0 / 40_320.0);
    let cos = 1.0 + a2 * (-0.5 + a2 * (1.0 / 24.0 + a2 * cos));
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_are_right() {
        for step in -4096..=4096 {
            let turn = step as f32 / 4096.0;
            let (sin, cos) = sin_cos_of_turn(turn);
            let (right_sin, right_cos) = (std::f64::consts::TAU * f64::from(turn)).sin_cos();
            let error = (f64::from(sin) - right_sin).abs().max((f64::from(cos) - right_cos).abs());
            assert!(error < 1.2e-7, "{turn}: off by {error}");
        }
        assert_eq!(sin_cos_of_turn(0.25), (1.0, 0.0));
        assert_eq!(sin_cos_of_turn(-0.5), (0.0, -1.0));
    }

    #[test]
    fn strange_turns_give_numbers_or_nan() {
        for turn in [1e30, -1e30, f32::INFINITY, f32::NAN] {
            let _ = sin_cos_of_turn(turn);
        }
    }
}
