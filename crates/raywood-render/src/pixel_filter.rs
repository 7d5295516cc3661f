//! Reconstruction filters: how far around a pixel its rays are spread. By filter importance sampling (Ernst, Stamminger and Greiner 2006) all rays of a pixel
//! weigh the same, and pixels stay independent.

use std::f64::consts::TAU;
use std::sync::LazyLock;

/// How the rays of a pixel are spread around its centre; each axis by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelFilter {
    /// Like a tent of two pixels' width: smooth edges.
    #[default]
    Tent,
    /// Evenly over the pixel: sharp, with steps in edges.
    Box,
    /// Like a Blackman-Harris window of three pixels' width (Harris, "On the Use of Windows for Harmonic Analysis", 1978), close to a Gaussian: as smooth as a
    /// tent, with less of the far and more of the near.
    BlackmanHarris,
}

impl PixelFilter {
    /// All filters; the first is the default.
    pub const ALL: [Self; 3] = [Self::Tent, Self::Box, Self::BlackmanHarris];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tent => "tent",
            Self::Box => "box",
            Self::BlackmanHarris => "blackman-harris",
        }
    }

    /// The filter of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|filter| filter.name() == name)
    }

    /// How far from the centre rays go at most, in pixels.
    pub fn radius(self) -> f32 {
        match self {
            Self::Tent => 1.0,
            Self::Box => 0.5,
            Self::BlackmanHarris => BLACKMAN_HARRIS_RADIUS,
        }
    }

    /// A uniform number from 0 to 1 as an offset in pixels that is distributed like the filter: the inverse of its cumulative distribution.
    #[inline(always)]
    pub fn offset(self, u: f32) -> f32 {
        match self {
            Self::Tent => tent(u),
            Self::Box => u - 0.5,
            Self::BlackmanHarris => blackman_harris(u),
        }
    }
}

#[inline(always)]
fn tent(u: f32) -> f32 {
    // One root for both sides, so that no branch is needed.
    let root = (2.0 * if u < 0.5 { u } else { 1.0 - u }).sqrt();
    if u < 0.5 { root - 1.0 } else { 1.0 - root }
}

const BLACKMAN_HARRIS_RADIUS: f32 = 1.5;

/// Steps of the table of quantiles; between them lines are close enough.
const STEPS: usize = 1024;

fn blackman_harris(u: f32) -> f32 {
    static QUANTILES: LazyLock<Vec<f32>> = LazyLock::new(blackman_harris_quantiles);
    let place = u.clamp(0.0, 1.0) * STEPS as f32;
    let step = (place as usize).min(STEPS - 1);
    let share = place - step as f32;
    (1.0 - share) * QUANTILES[step] + share * QUANTILES[step + 1]
}

/// The offsets below which 0, 1, 2, ... of [`STEPS`] parts of the window lie.
fn blackman_harris_quantiles() -> Vec<f32> {
    // The integral of the window with four terms, from 0 to t of its width, as a share of the whole.
    let [a0, a1, a2, a3] = [0.35875, 0.48829, 0.14128, 0.01168];
    let cumulative = |t: f64| {
        let wave = |amplitude: f64, n: f64| amplitude / (n * TAU) * (n * TAU * t).sin();
        t + (wave(a2, 2.0) - wave(a1, 1.0) - wave(a3, 3.0)) / a0
    };
    let quantile = |step: usize| {
        let share = step as f64 / STEPS as f64;
        // By halving: the integral grows all the way.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if cumulative(middle) < share { low = middle } else { high = middle }
        }
        BLACKMAN_HARRIS_RADIUS * (low + high - 1.0) as f32
    };
    (0..=STEPS).map(quantile).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far the filter's rays that are below a place are the share of the filter that is: its density integrated by small steps.
    #[test]
    fn offsets_are_distributed_like_the_filters() {
        const COUNT: u32 = 1 << 16;
        let window = |x: f64| {
            let t = x / 3.0 + 0.5;
            let cos = |n: f64| (n * TAU * t).cos();
            0.35875 - 0.48829 * cos(1.0) + 0.14128 * cos(2.0) - 0.01168 * cos(3.0)
        };
        for filter in PixelFilter::ALL {
            let density = |x: f64| match filter {
                PixelFilter::Tent => 1.0 - x.abs(),
                PixelFilter::Box => 1.0,
                PixelFilter::BlackmanHarris => window(x) / (3.0 * 0.35875),
            };
            let radius = f64::from(filter.radius());
            let offset = |i: u32| filter.offset((i as f32 + 0.5) / COUNT as f32);
            assert!((0..COUNT).all(|i| f64::from(offset(i).abs()) <= radius));
            assert!((1..COUNT).all(|i| offset(i) >= offset(i - 1)), "{filter:?} goes back");

            let steps = 3000;
            let width = 2.0 * radius / f64::from(steps);
            let mut below = 0.0;
            for step in 0..steps {
                let x = -radius + (f64::from(step) + 0.5) * width;
                let share = (0..COUNT).take_while(|&i| f64::from(offset(i)) < x);
                if step % 100 == 50 {
                    let share = share.count() as f64 / f64::from(COUNT);
                    let expected = below + 0.5 * width * density(x);
                    assert!((share - expected).abs() < 1e-3, "{filter:?} at {x}: {share}");
                }
                below += width * density(x);
            }
            assert!((below - 1.0).abs() < 1e-4, "{filter:?} integrates to {below}");
        }
    }

    #[test]
    fn names_are_known() {
        for filter in PixelFilter::ALL {
            assert_eq!(PixelFilter::from_name(filter.name()), Some(filter));
        }
        assert_eq!(PixelFilter::from_name("gauss"), None);
    }
}
