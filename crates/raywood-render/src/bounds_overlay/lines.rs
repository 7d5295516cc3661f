//! Anti-aliased lines: for each pixel how much of it they cover.
//!
//! Of all lines over a pixel the strongest counts. So edges that many boxes share are drawn as one, and neither the order nor the threads
//! show.

use rayon::prelude::*;
use std::ops::Range;

use raywood::{Aabb, Vec3};

use super::projection::{Homogeneous, Projection, Segment, clip, inside};
use crate::options::{RenderError, RenderOptions};

/// How strong a line is that a surface hides.
const HIDDEN: f32 = 0.16;

/// Boxes that appear smaller than this many lines side by side are fainter, down to a least strength: else a fine level would hide
/// the picture under one colour.
const SMALL: f32 = 12.0;
const FAINTEST: f32 = 0.12;

/// Segments that wait to be drawn, together, by all threads.
const BATCH: usize = 1 << 16;

/// Rows that a thread draws at a time.
const BAND: usize = 32;

/// The coverage of a line and of the seam around it, in 255ths.
type Coverage = [u8; 2];

/// Lines that are being drawn.
pub(super) struct Lines {
    width: usize,
    height: usize,
    coverage: Vec<Coverage>,
    /// Beyond these depths lines are hidden.
    depths: Vec<f32>,
    projection: Projection,
    /// Half the width of a line, and of a line with its seams, in pixels.
    radius: f32,
    seam_radius: f32,
    /// Segments to be drawn, and how strongly.
    waiting: Vec<(Segment, f32)>,
}

/// How much of each pixel lines cover.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Covered {
    width: usize,
    coverage: Vec<Coverage>,
}

/// The edges of a box between its corners, whose numbers have a bit for each axis: set at the maximum.
const EDGES: [(usize, usize); 12] = [
    (0, 1),
    (2, 3),
    (4, 5),
    (6, 7),
    (0, 2),
    (1, 3),
    (4, 6),
    (5, 7),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
];

impl Lines {
    /// No lines yet.
    pub(super) fn new(
        projection: Projection,
        depths: Vec<f32>,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        let (width, height) = (options.width as usize, options.height as usize);
        let mut coverage = Vec::new();
        coverage
            .try_reserve_exact(width * height)
            .map_err(|_| RenderError::OutOfMemory { bytes: options.memory_bytes() })?;
        coverage.resize(width * height, [0; 2]);
        // As thick as looks the same in pictures of all sizes, but never so thin that between two pixels it pales.
        let radius = (width.min(height) as f32 / 1000.0).clamp(0.7, 4.0);
        let seam_radius = 1.5 * radius + 0.6;
        let waiting = Vec::new();
        Ok(Self { width, height, coverage, depths, projection, radius, seam_radius, waiting })
    }

    /// Adds the edges of a box.
    pub(super) fn add_box(&mut self, bounds: &Aabb) {
        let size = [self.width as f64, self.height as f64];
        let margin = f64::from(self.seam_radius) + 1.0;
        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
            let pick = |axis: usize| [bounds.min, bounds.max][corner >> axis & 1][axis];
            self.projection.project(Vec3::new(pick(0), pick(1), pick(2)))
        });
        let places = corners.map(|corner| inside(corner, size, margin));
        let outside = (0..5).any(|side| places.iter().all(|place| place[side] < 0.0));
        if outside {
            return;
        }
        let edges = EDGES.map(|(a, b)| clip(corners[a], corners[b], size, margin));
        let appears = extent(&corners) / (2.0 * self.radius);
        let strength = (appears / SMALL).clamp(FAINTEST, 1.0);
        self.waiting.extend(edges.into_iter().flatten().map(|edge| (edge, strength)));
        if self.waiting.len() >= BATCH {
            self.draw_waiting();
        }
    }

    /// Draws the last of the lines.
    pub(super) fn finish(mut self) -> Covered {
        self.draw_waiting();
        Covered { width: self.width, coverage: self.coverage }
    }

    fn draw_waiting(&mut self) {
        let Self { width, coverage, depths, waiting, radius, seam_radius, .. } = self;
        let pen = Pen { radius: *radius, seam_radius: *seam_radius };
        let bands = coverage.par_chunks_mut(BAND * *width).zip(depths.par_chunks(BAND * *width));
        bands.enumerate().for_each(|(band, (coverage, depths))| {
            let rows = coverage.chunks_exact_mut(*width).zip(depths.chunks_exact(*width));
            let mut rows: Vec<_> = rows.collect();
            for (segment, strength) in waiting.iter() {
                pen.draw(segment, *strength, band * BAND, &mut rows);
            }
        });
        waiting.clear();
    }
}

impl Covered {
    /// The pixels that lines or their seams cover: column, row, and both shares, 0 to 1.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, u32, f32, f32)> {
        let covered = self.coverage.iter().enumerate().filter(|(_, [_, seam])| *seam > 0);
        covered.map(|(index, coverage)| {
            let (x, y) = (index % self.width, index / self.width);
            let [line, seam] = coverage.map(|share| f32::from(share) / 255.0);
            (x as u32, y as u32, line, seam)
        })
    }
}

/// How wide or high some points appear, whichever is more, in pixels; infinite if one is not in front of the eye.
fn extent(points: &[Homogeneous; 8]) -> f32 {
    if !points.iter().all(|[.., w]| *w > 0.0) {
        return f32::INFINITY;
    }
    let along = |axis: usize| {
        let places = points.map(|point| point[axis] / point[2]);
        let least = places.into_iter().fold(f64::INFINITY, f64::min);
        places.into_iter().fold(f64::NEG_INFINITY, f64::max) - least
    };
    along(0).max(along(1)) as f32
}

/// How thick lines are.
struct Pen {
    radius: f32,
    seam_radius: f32,
}

impl Pen {
    /// Draws a segment into some rows, the first of which is row `first`: coverages and depths.
    fn draw(
        &self,
        segment: &Segment,
        strength: f32,
        first: usize,
        rows: &mut [(&mut [Coverage], &[f32])],
    ) {
        let &Segment { from: [x0, y0], to: [x1, y1], inverse_depth: [q0, q1] } = segment;
        let reach = self.seam_radius + 0.5;
        let (left, right) = (x0.min(x1) - reach, x0.max(x1) + reach);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let squared = dx * dx + dy * dy;

        let ys = pixels(y0.min(y1) - reach, y0.max(y1) + reach);
        for y in ys.start.max(first)..ys.end.min(first + rows.len()) {
            let (coverage, depths) = &mut rows[y - first];
            let py = y as f32 + 0.5 - y0;

            // Where the row crosses the line's stripe: anywhere if it runs along the row.
            let (middle, half) = (x0 + py * dx / dy, (reach * squared.sqrt() / dy).abs());
            let (mut low, mut high) = (left, right);
            if middle.is_finite() && half.is_finite() {
                (low, high) = (low.max(middle - half), high.min(middle + half));
            }
            let xs = pixels(low, high);
            for x in xs.start..xs.end.min(coverage.len()) {
                let px = x as f32 + 0.5 - x0;
                let along = if squared > 0.0 { (px * dx + py * dy) / squared } else { 0.0 };
                let along = along.clamp(0.0, 1.0);
                let (off_x, off_y) = (px - along * dx, py - along * dy);
                let distance = (off_x * off_x + off_y * off_y).sqrt();

                let hidden = (q0 + along * (q1 - q0)) * depths[x] < 1.0;
                let strength = if hidden { HIDDEN * strength } else { strength };
                let share = |radius: f32| (radius + 0.5 - distance).clamp(0.0, 1.0) * strength;
                let shares = [share(self.radius), share(self.seam_radius)];
                for (old, share) in coverage[x].iter_mut().zip(shares) {
                    *old = (*old).max((255.0 * share + 0.5) as u8);
                }
            }
        }
    }
}

/// The pixels whose centres lie between two places on an axis, those below 0 left out.
fn pixels(low: f32, high: f32) -> Range<usize> {
    // Conversions to integers saturate.
    (low - 0.5).ceil() as usize..(high + 0.5).floor() as usize
}
