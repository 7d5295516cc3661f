//! The profile: a plane curve with smooth runs and sharp corners, which `revolve` and `sweep` move through space.

use std::f32::consts::TAU;

/// A plane curve in runs: smooth inside a run, a sharp corner between one run and the next.
///
/// A surface made from it has its front on the right of the direction of travel: going up along a line, the front is
/// towards positive `x`. A closed outline therefore goes counter-clockwise to have its front outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    runs: Vec<Vec<[f32; 2]>>,
    end: [f32; 2],
    closed: bool,
}

impl Profile {
    /// A curve that starts at a point.
    pub const fn start(x: f32, y: f32) -> Self {
        Self { runs: Vec::new(), end: [x, y], closed: false }
    }

    /// Goes on along a straight line.
    #[must_use]
    pub fn line_to(mut self, x: f32, y: f32) -> Self {
        self.runs.push(vec![self.end, [x, y]]);
        self.end = [x, y];
        self
    }

    /// Goes on along a smooth cubic curve (Bezier), cut into `segments`, drawn by its two control points.
    #[must_use]
    pub fn curve_to(mut self, control: [[f32; 2]; 2], x: f32, y: f32, segments: usize) -> Self {
        let [p0, p1, p2, p3] = [self.end, control[0], control[1], [x, y]];
        let point = |t: f32| {
            let s = 1.0 - t;
            let [a, b, c, d] = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
            [0, 1].map(|k| a * p0[k] + b * p1[k] + c * p2[k] + d * p3[k])
        };
        let mut run: Vec<_> = (0..=segments).map(|i| point(i as f32 / segments as f32)).collect();
        // The ends exactly, whatever the rounding, so that neighbouring runs meet.
        run[0] = p0;
        run[segments] = p3;
        self.runs.push(run);
        self.end = p3;
        self
    }

    /// Goes on along an arc of an ellipse around `center`, cut into `segments`, that turns by `degrees` (positive is
    /// counter-clockwise) as an ellipse with the given ratio of height to width.
    #[must_use]
    pub fn arc(mut self, center: [f32; 2], ratio: f32, degrees: f32, segments: usize) -> Self {
        let (dx, dy) = (self.end[0] - center[0], (self.end[1] - center[1]) / ratio);
        let point = |i: usize| {
            let (sin, cos) = (degrees.to_radians() * i as f32 / segments as f32).sin_cos();
            [center[0] + cos * dx - sin * dy, center[1] + ratio * (sin * dx + cos * dy)]
        };
        let mut run: Vec<_> = (0..=segments).map(point).collect();
        run[0] = self.end;
        // A surface of revolution must end on its axis exactly to be closed.
        if run[segments][0].abs() < 1e-6 {
            run[segments][0] = 0.0;
        }
        self.end = run[segments];
        self.runs.push(run);
        self
    }

    /// Joins the last run smoothly to the one before it.
    #[must_use]
    pub fn smooth(mut self) -> Self {
        if self.runs.len() >= 2
            && let Some(last) = self.runs.pop()
            && let Some(previous) = self.runs.last_mut()
        {
            previous.extend_from_slice(&last[1..]);
        }
        self
    }

    /// A smooth closed outline around the origin: a circle.
    pub fn circle(radius: f32, segments: usize) -> Self {
        Self::outline(segments, |angle| {
            let (sin, cos) = angle.sin_cos();
            [radius * cos, radius * sin]
        })
    }

    /// A smooth closed outline, from its points at angles that go counter-clockwise from 0 to a full turn.
    pub fn outline(segments: usize, point: impl Fn(f32) -> [f32; 2]) -> Self {
        let run: Vec<_> = (0..segments).map(|i| point(TAU * i as f32 / segments as f32)).collect();
        Self { end: run[0], runs: vec![run], closed: true }
    }

    /// The smooth runs, each of at least two points.
    pub fn runs(&self) -> &[Vec<[f32; 2]>] {
        &self.runs
    }

    /// Whether the profile is one smooth ring, whose last point joins its first.
    pub fn is_ring(&self) -> bool {
        self.closed
    }

    /// The same curve with every point moved by a function.
    #[must_use]
    pub fn map(mut self, change: impl Fn([f32; 2]) -> [f32; 2]) -> Self {
        for point in self.runs.iter_mut().flatten() {
            *point = change(*point);
        }
        self.end = change(self.end);
        self
    }
}
