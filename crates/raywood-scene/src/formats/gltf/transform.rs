//! Affine transforms of nodes, in double precision so that deep trees do not add up rounding.

use gltf_json::Node;
use raywood::Vec3;

/// An affine transform: the images of the axes, and of the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Transform {
    /// The transform that changes nothing.
    pub(super) const IDENTITY: Self =
        Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] };

    /// From a node's space to its parent's.
    pub(super) fn of_node(node: &Node) -> Self {
        if let Some(matrix) = node.matrix {
            let column = |i: usize| [0, 1, 2].map(|row| f64::from(matrix[4 * i + row]));
            return Self { axes: [column(0), column(1), column(2)], origin: column(3) };
        }
        let translation = node.translation.unwrap_or_default();
        let rotation = node.rotation.unwrap_or_default().0;
        Self::of_parts(translation, rotation, node.scale.unwrap_or([1.0; 3]))
    }

    /// First scaled, then turned by a quaternion of any length, then moved.
    pub(super) fn of_parts(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Self {
        let (scale, origin) = (scale.map(f64::from), translation.map(f64::from));
        let [x, y, z, w] = rotation.map(f64::from);
        let norm = x * x + y * y + z * z + w * w;
        let s = if norm > 0.0 { 2.0 / norm } else { 0.0 };
        let mut axes = [
            [1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)],
            [s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)],
            [s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)],
        ];
        for (axis, scale) in axes.iter_mut().zip(scale) {
            *axis = axis.map(|x| x * scale);
        }
        Self { axes, origin }
    }

    /// In single precision.
    pub(super) fn rounded(&self) -> raywood::Transform {
        let [a, b, c] = self.axes;
        raywood::Transform::from_rows(
            [0, 1, 2].map(|i| [a[i], b[i], c[i], self.origin[i]].map(|number| number as f32)),
        )
    }

    /// First `inner`, then this.
    pub(super) fn after(&self, inner: &Self) -> Self {
        let origin = self.linear(inner.origin);
        Self {
            axes: inner.axes.map(|axis| self.linear(axis)),
            origin: [0, 1, 2].map(|i| origin[i] + self.origin[i]),
        }
    }

    /// Without the shift of the origin.
    fn linear(&self, v: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.axes;
        [0, 1, 2].map(|i| a[i] * v[0] + b[i] * v[1] + c[i] * v[2])
    }

    /// Where a point goes.
    #[inline]
    pub(super) fn point(&self, p: [f32; 3]) -> Vec3 {
        let moved = self.linear(p.map(f64::from));
        Vec3::from([0, 1, 2].map(|i| (moved[i] + self.origin[i]) as f32))
    }

    /// The direction of unit length that a direction goes to, zero if it vanishes.
    pub(super) fn direction(&self, d: [f32; 3]) -> Vec3 {
        Vec3::from(self.linear(d.map(f64::from)).map(|x| x as f32)).normalize_or_zero()
    }

    /// What moves normals: the inverse transposed, scaled to keep clear of division by zero.
    pub(super) fn for_normals(&self) -> Self {
        let [a, b, c] = self.axes;
        let sign = if self.mirrors() { -1.0 } else { 1.0 };
        let axes = [cross(b, c), cross(c, a), cross(a, b)].map(|axis| axis.map(|x| sign * x));
        Self { axes, origin: [0.0; 3] }
    }

    /// Whether it turns left hands into right hands, and so the order of a triangle's corners.
    pub(super) fn mirrors(&self) -> bool {
        let [a, b, c] = self.axes;
        let n = cross(a, b);
        n[0] * c[0] + n[1] * c[1] + n[2] * c[2] < 0.0
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
