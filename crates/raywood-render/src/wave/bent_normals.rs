//! Normal maps: what bends the normals of the surfaces of a wave (glTF 2.0, section 3.9.3).

use raywood::Vec3;
use raywood_scene::Texture;

use super::WAVE;
use super::columns::{Columns, ZERO, get, set, whole_vectors};
use super::footprints::Footprints;
use super::surfaces::Surfaces;
use crate::PreparedScene;
use crate::prepared::Which;
use crate::textured::{Shown, Slot};

/// The least cosine between a normal for shading and the surface's own: there is nothing to see from behind.
const LEAST_COSINE: f32 = 1e-2;

/// Bends the normals of surfaces of these numbers as `shown` says. Tangents are the mesh's, else those of the triangles' texture coordinates.
#[inline(always)]
pub(crate) fn bend_normals(
    scene: &PreparedScene<'_>,
    surfaces: &mut Surfaces,
    (texture, scale): (&Texture, f32),
    footprints: &Footprints,
    numbers: &[u8],
    shown: &[Shown],
) {
    let count = whole_vectors(numbers.len());
    let (mut given, mut signs) = (ZERO, [0.0; WAVE]);
    gather_tangents(scene, surfaces, numbers, &mut given, &mut signs);
    let mut edges = [ZERO; 2];
    let mut steps = [[[0.0; WAVE]; 2]; 2];
    let (mut normals, mut geometric, mut fronts, mut bent) = (ZERO, ZERO, ZERO, ZERO);
    for (place, (&number, shown)) in numbers.iter().zip(shown).enumerate() {
        let number = usize::from(number);
        let first = get(&surfaces.corners[0], number);
        set(&mut edges[0], place, get(&surfaces.corners[1], number) - first);
        set(&mut edges[1], place, get(&surfaces.corners[2], number) - first);
        for (steps, all) in steps.iter_mut().flatten().zip(footprints.steps.iter().flatten()) {
            steps[place] = all[number];
        }
        set(&mut normals, place, get(&surfaces.normals, number));
        set(&mut geometric, place, get(&surfaces.geometric_normals, number));
        set(&mut fronts, place, get(&surfaces.own_normals, number));
        let [x, y, z, _] = shown[Slot::Normal as usize];
        set(&mut bent, place, Vec3::new(x, y, z));
    }

    let mut found = ZERO;
    for place in 0..count {
        // A byte of 128 is zero.
        let colors = get(&bent, place);
        let signed = |byte: f32| (255.0 * byte - 128.0) * (1.0 / 127.0);
        let bent = [scale * signed(colors.x), scale * signed(colors.y), signed(colors.z)];

        // The tangent space belongs to the front; the back shows it from behind.
        let (e1, e2) = (get(&edges[0], place), get(&edges[1], place));
        let outwards = get(&geometric, place);
        let side = if get(&fronts, place).dot(outwards) < 0.0 { -1.0 } else { 1.0 };
        let shaded = get(&normals, place);
        let normal = side * shaded;

        // Along u; the bitangent runs against v, for images count their rows from the top.
        let step =
            |edge: usize| texture.transform.step([steps[edge][0][place], steps[edge][1][place]]);
        let ([u1, v1], [u2, v2]) = (step(0), step(1));
        let turn = if u1 * v2 - u2 * v1 < 0.0 { -1.0 } else { 1.0 };
        let along_u = turn * (v2 * e1 - v1 * e2);
        let along_v = turn * (u1 * e2 - u2 * e1);
        let derived_sign = if normal.cross(along_u).dot(along_v) > 0.0 { -1.0 } else { 1.0 };
        let is_given = signs[place] != 0.0;
        let tangent = if is_given { get(&given, place) } else { along_u };
        let sign = if is_given { signs[place] } else { derived_sign };

        let tangent = unit(tangent - tangent.dot(normal) * normal);
        let bitangent = sign * normal.cross(tangent);
        let front = bent[0] * tangent + bent[1] * bitangent + bent[2] * normal;
        let turned = unit(side * front);
        let lack = LEAST_COSINE - turned.dot(outwards);
        let lifted = unit(turned + if lack > 0.0 { lack } else { 0.0 } * outwards);
        // Without a tangent or a direction the normal stays as it is.
        let is_sound = (tangent.dot(tangent) > 0.0) & (lifted.dot(lifted) > 0.0);
        set(&mut found, place, if is_sound { lifted } else { shaded });
    }
    for (place, &number) in numbers.iter().enumerate() {
        set(&mut surfaces.normals, usize::from(number), get(&found, place));
    }
}

/// A vector of unit length in the same direction; zero if it has none. Without branches.
#[inline(always)]
fn unit(v: Vec3) -> Vec3 {
    let squared = v.dot(v);
    let reciprocal = 1.0 / squared.sqrt();
    // Neither tiny nor huge ones, whose squares are not numbers.
    let is_sound = (squared > 1e-30) & (squared < 1e30);
    (if is_sound { reciprocal } else { 0.0 }) * v
}

/// Gathers the mesh's tangents at surfaces, and the signs of their bitangents: 0 where there is none.
#[inline(always)]
fn gather_tangents(
    scene: &PreparedScene<'_>,
    surfaces: &Surfaces,
    numbers: &[u8],
    given: &mut Columns,
    signs: &mut [f32; WAVE],
) {
    let mesh = &scene.scene().mesh;
    if mesh.tangents.is_empty() {
        return;
    }
    for (place, &number) in numbers.iter().enumerate() {
        let number = usize::from(number);
        let Which::Triangle(triangle) = scene.which(surfaces.primitive(number)) else { continue };
        let corners = mesh.triangles.triangles()[triangle as usize];
        let corner = |i: usize| mesh.tangents.get(corners[i] as usize).copied().unwrap_or([0.0; 4]);
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let (u, v) = (surfaces.weights[0][number], surfaces.weights[1][number]);
        let along = |i: usize| (1.0 - u - v) * a[i] + u * b[i] + v * c[i];
        let mut tangent = Vec3::new(along(0), along(1), along(2));
        let mut sign = a[3];
        if let Some(placed) = scene.placed(surfaces.element(number).instance) {
            let way = placed.way(surfaces.time(number));
            tangent = way.to_world.vector(tangent);
            sign = if way.mirrored { -sign } else { sign };
        }
        set(given, place, tangent);
        signs[place] = if tangent == Vec3::ZERO { 0.0 } else { sign };
    }
}
