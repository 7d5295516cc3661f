//! Weights for what may be found in more than one way.

/// Which ways of finding light with extent are taken. Pictures take both; each by itself finds the same, with more noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Strategy {
    /// Lights are asked, and what scattered rays happen to meet counts too, each weighted by the power heuristic.
    Both,
    /// Only lights are asked; what scattered rays meet counts behind perfect mirrors alone.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it"))]
    Lights,
    /// Only what scattered rays meet counts.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it"))]
    Scattering,
}

impl Strategy {
    /// The weight of light that was asked, where the density of that is `light`, and that of a scattered ray into the same direction is `scattering`.
    #[inline(always)]
    pub(super) fn weight_of_light(self, light: f32, scattering: f32) -> f32 {
        match self {
            Self::Both => power(light, scattering),
            Self::Lights => 1.0,
            Self::Scattering => 0.0,
        }
    }

    /// The weight of light that a scattered ray met.
    #[inline]
    pub(super) fn weight_of_scattering(self, scattering: f32, light: f32) -> f32 {
        match self {
            Self::Both => power(scattering, light),
            Self::Lights if light > 0.0 => 0.0,
            Self::Lights | Self::Scattering => 1.0,
        }
    }
}

/// The power heuristic with exponent two (Veach 1997, section 9.2.4).
#[inline(always)]
fn power(own: f32, other: f32) -> f32 {
    // By the ratio, whose square cannot overflow where that matters.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
