//! How far away what the camera sees is: a few rays of a picture, before it is begun.

use raywood::HitColumns;

use super::Frame;

/// Distances from the eye to what it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewDepths {
    pub(super) nearest: f32,
    pub(super) median: f32,
    pub(super) farthest: f32,
}

impl ViewDepths {
    /// Looks through the middles of so many columns and rows. Of a view of nothing all is one. What moves is where it is at time 0.
    pub(super) fn of(frame: &Frame<'_>) -> Self {
        const COLUMNS: u32 = 64;
        let Frame { scene, camera, options, .. } = frame;
        let middle = |number: u32, size: u32| (number as f32 + 0.5) / COLUMNS as f32 * size as f32;
        let pixels = (0..COLUMNS).flat_map(|row| (0..COLUMNS).map(move |column| [column, row]));
        let directions: Vec<_> = pixels
            .map(|[x, y]| camera.direction(middle(x, options.width), middle(y, options.height)))
            .collect();
        let mut hits = HitColumns::default();
        scene.tracer().intersect_from(camera.eye(), &directions, &mut hits);

        let mut distances: Vec<f32> = hits.t.iter().copied().filter(|t| t.is_finite()).collect();
        distances.sort_unstable_by(f32::total_cmp);
        let [Some(&nearest), Some(&farthest)] = [distances.first(), distances.last()] else {
            return Self { nearest: 1.0, median: 1.0, farthest: 1.0 };
        };
        Self { nearest, median: distances[distances.len() / 2], farthest }
    }
}
