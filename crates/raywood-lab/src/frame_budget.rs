//! The lecture's budget of a frame: what pictures in real time would take.

/// The rays of a picture: 10 for each of 1280 x 800 pixels.
pub const RAYS_PER_FRAME: f64 = 1280.0 * 800.0 * 10.0;
/// Pictures a second.
pub const FRAMES_PER_SECOND: f64 = 30.0;
/// Rays a second: 300 million.
pub const RAYS_PER_SECOND: f64 = FRAMES_PER_SECOND * RAYS_PER_FRAME;
/// What eight cores of 3 GHz have for each of these rays: core cycles.
pub const CYCLES_PER_RAY: f64 = 80.0;
