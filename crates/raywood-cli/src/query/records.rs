//! Columns made of the library's answers.

use rayon::prelude::*;
use raywood::{ClosestPoint, Geometry, Hit, Ray, SurfacePoint, Vec3};
use raywood_scene::Scene;

use super::field::Field;
use super::questioner::SceneTree;
use super::table::{Column, Values};

/// How many rows a task takes at least.
const GRAIN: usize = 1024;

/// What one row of the output can tell: of a hit or of a closest point.
#[derive(Clone, Copy)]
pub(super) struct Record {
    distance: f32,
    primitive: i32,
    u: f32,
    v: f32,
    position: Vec3,
    normal: Vec3,
}

impl Record {
    /// Where nothing is hit or found.
    const MISS: Self = Self {
        distance: f32::INFINITY,
        primitive: -1,
        u: f32::NAN,
        v: f32::NAN,
        position: Vec3::new(f32::NAN, f32::NAN, f32::NAN),
        normal: Vec3::new(f32::NAN, f32::NAN, f32::NAN),
    };

    /// A hit of a ray.
    pub(super) fn of_hit(tree: &SceneTree<'_>, ray: &Ray, hit: Option<&Hit>) -> Self {
        let Some(hit) = hit else { return Self::MISS };
        let SurfacePoint { position, normal, .. } = tree.surface_point(ray, hit);
        let &Hit { t, u, v, primitive, .. } = hit;
        // There are at most 2^31 primitives.
        Self { distance: t, primitive: primitive as i32, u, v, position, normal }
    }

    /// A closest point.
    pub(super) fn of_closest(closest: Option<&ClosestPoint>) -> Self {
        closest.map_or(Self::MISS, |&ClosestPoint { point, distance, primitive, u, v, .. }| Self {
            distance,
            primitive: primitive as i32,
            u,
            v,
            position: point,
            ..Self::MISS
        })
    }

    /// Whether something was hit or found.
    pub(super) fn is_miss(&self) -> bool {
        self.primitive < 0
    }
}

/// The columns of `rows` records, in parallel.
pub(super) fn columns(
    fields: &[Field],
    scene: &Scene,
    rows: usize,
    record: impl Fn(usize) -> Record + Send + Sync,
) -> (Vec<Column>, u64) {
    let records: Vec<_> = (0..rows).into_par_iter().with_min_len(GRAIN).map(record).collect();
    let successes = records.iter().filter(|record| !record.is_miss()).count() as u64;
    let column = |&field: &Field| Column { field, values: values(field, scene, &records) };
    (fields.par_iter().map(column).collect(), successes)
}

/// One column.
fn values(field: Field, scene: &Scene, records: &[Record]) -> Values {
    let floats = |f: fn(&Record) -> f32| Values::F32(records.iter().map(f).collect());
    let vectors = |f: fn(&Record) -> Vec3| {
        Values::F32(records.iter().flat_map(|record| f(record).to_array()).collect())
    };
    match field {
        Field::T | Field::Distance => floats(|record| record.distance),
        Field::U => floats(|record| record.u),
        Field::V => floats(|record| record.v),
        Field::Position => vectors(|record| record.position),
        Field::Normal => vectors(|record| record.normal),
        Field::Primitive => Values::I32(records.iter().map(|record| record.primitive).collect()),
        Field::Material => {
            let material = |record: &Record| material_of(scene, record.primitive);
            Values::I32(records.iter().map(material).collect())
        }
        // Other questions have other answers than records.
        Field::Hit
        | Field::Count
        | Field::Inside
        | Field::WindingNumber
        | Field::SignedDistance => Values::empty(field.element()),
    }
}

/// The number of a primitive's material, -1 of a miss or if it has none.
fn material_of(scene: &Scene, primitive: i32) -> i32 {
    let Ok(primitive) = usize::try_from(primitive) else { return -1 };
    let material = match primitive.checked_sub(scene.mesh.triangles.len()) {
        None => scene.mesh.materials.get(primitive),
        Some(sphere) => scene.sphere_materials.get(sphere),
    };
    material.filter(|&&id| (id as usize) < scene.materials.len()).map_or(-1, |&id| id as i32)
}
