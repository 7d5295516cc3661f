//! Textures: images laid over surfaces, and how they are read (glTF 2.0, sections 3.8 and 5.26).

/// The number of an image in its scene.
pub type ImageId = u32;

/// An image laid over a surface by the mesh's texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// Which image of the scene.
    pub image: ImageId,
    /// Which of the mesh's [sets of texture coordinates](crate::Mesh::texture_coordinates): 0 or 1.
    pub set: u8,
    /// From the mesh's texture coordinates to those of the image.
    pub transform: TextureTransform,
    /// What lies beyond the image's edges, along u and along v.
    pub wrap: [Wrap; 2],
    /// How it looks close up. From afar it is always filtered: see [`TextureImage`](crate::TextureImage).
    pub magnification: Magnification,
}

impl Texture {
    /// An image over the first set of texture coordinates, repeated and smooth.
    pub fn new(image: ImageId) -> Self {
        Self {
            image,
            set: 0,
            transform: TextureTransform::IDENTITY,
            wrap: [Wrap::Repeat; 2],
            magnification: Magnification::Linear,
        }
    }

    /// Where on the image a point of a triangle lies, with `weights` of its second and third corner. `coordinates` are the mesh's texture coordinates; zero where there
    /// are none.
    #[inline]
    pub fn point_on(
        &self,
        coordinates: &[[f32; 2]],
        corners: [u32; 3],
        weights: [f32; 2],
    ) -> [f32; 2] {
        let at = |i: usize| coordinates.get(corners[i] as usize).copied().unwrap_or([0.0; 2]);
        let (a, b, c) = (at(0), at(1), at(2));
        let along = |i: usize| a[i] + weights[0] * (b[i] - a[i]) + weights[1] * (c[i] - a[i]);
        self.transform.point([along(0), along(1)])
    }
}

/// What lies beyond an image's edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, every second one mirrored.
    Mirror,
    /// The texels of the edge.
    Clamp,
}

/// How an image looks close up, where a texel is larger than a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Magnification {
    /// Texels are squares of one colour.
    Nearest,
    /// Colours blend from the middle of a texel to that of the next.
    #[default]
    Linear,
}

/// An affine map of texture coordinates (`KHR_texture_transform`): `u' = r0 . (u, v, 1)`, `v' = r1 . (u, v, 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureTransform {
    /// The rows `r0` and `r1`.
    pub rows: [[f32; 3]; 2],
}

impl TextureTransform {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };

    /// First scaled, then turned counter-clockwise by an angle in radians, then moved.
    pub fn new(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> Self {
        let (sin, cos) = rotation.sin_cos();
        let rows = [
            [cos * scale[0], sin * scale[1], offset[0]],
            [-sin * scale[0], cos * scale[1], offset[1]],
        ];
        let finite = rows.as_flattened().iter().all(|number| number.is_finite());
        if finite { Self { rows } } else { Self::IDENTITY }
    }

    /// Where a point goes.
    #[inline(always)]
    pub fn point(&self, uv: [f32; 2]) -> [f32; 2] {
        let [x, y] = self.step(uv);
        [x + self.rows[0][2], y + self.rows[1][2]]
    }

    /// What becomes of the way from a point to another.
    #[inline(always)]
    pub fn step(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let [[a, b, _], [c, d, _]] = self.rows;
        [a * u + b * v, c * u + d * v]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_scales_then_turns_then_moves() {
        let quarter = std::f32::consts::FRAC_PI_2;
        let transform = TextureTransform::new([0.5, 0.0], quarter, [2.0, 3.0]);
        // (1, 1) becomes (2, 3), turned as the extension's matrix turns it (3, -2), moved (3.5, -2).
        let [u, v] = transform.point([1.0, 1.0]);
        assert!((u - 3.5).abs() < 1e-5 && (v + 2.0).abs() < 1e-5, "{u} {v}");
        let broken = TextureTransform::new([f32::NAN, 0.0], 0.0, [1.0, 1.0]);
        assert_eq!(broken, TextureTransform::IDENTITY);
    }
}
