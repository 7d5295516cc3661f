//! The shutter: the time during which light comes in. What moves meanwhile is blurred (Cook, Porter and Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984).

use crate::path_samples::PathSamples;

/// When the shutter is open: a part of the time from 0 to 1 in which [instances move](raywood_scene::Instance::later).
///
/// Each ray from the eye has its own time, and all rays that follow from it have the same. The times of a pixel's rays are well spread over the interval. Pictures in which nothing moves do not
/// depend on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    /// When it opens, from 0 to 1.
    pub open: f32,
    /// When it closes: not before it opens, and at most 1. If it does so at once, everything stands still.
    pub close: f32,
}

impl Default for Shutter {
    /// Open for all of the time.
    fn default() -> Self {
        Self { open: 0.0, close: 1.0 }
    }
}

impl Shutter {
    /// Whether it closes after it opens, both in time.
    pub(crate) fn is_sound(self) -> bool {
        let Self { open, close } = self;
        0.0 <= open && open <= close && close <= 1.0
    }

    /// The time of a sample of a pixel.
    #[inline]
    pub(crate) fn time(self, samples: PathSamples) -> f32 {
        let [share, _] = samples.pair(PathSamples::SHUTTER);
        // Rounding does not leave the interval.
        (self.open + share * (self.close - self.open)).min(self.close)
    }

    /// The time in its middle.
    pub(crate) fn middle(self) -> f32 {
        0.5 * (self.open + self.close)
    }
}
